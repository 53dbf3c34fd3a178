/* Every object of a file in turn. HDF5's own H5Lvisit crashes on damaged files and has no bound. */
#include "store/hdf5.h"

#include <stdio.h>
#include <string.h>

/* A result has 5 levels and some 200 objects, a merge as many as the figures of a run and the axes of its study. The
 * bounds end the walk through a group that holds itself. */
#define DEPTH_MAX 12
#define OBJECTS_MAX 20000

typedef struct {
    hf_hdf5 *io;
    hf_hdf5_visit *visit;
    void *context;
    int depth, n_object;
    char path[1024]; /* of the group at hand, with a slash at its end */
} walk;

static void walk_group(walk *w, hid_t group);

static void visit_object(walk *w, hid_t group, const char *name, const char *path)
{
    hf_hdf5 *io = w->io;
    size_t length = strlen(w->path);
    if (++w->n_object > OBJECTS_MAX || w->depth >= DEPTH_MAX) {
        hf_hdf5_damaged(io, io->file, path, "is one object too many, or too deep");
        return;
    }
    hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    if (object < 0) hf_hdf5_fail(io, "read", io->file, path);
    H5I_type_t type = object < 0 ? H5I_BADID : H5Iget_type(object);
    if (io->status == HF_OK) w->visit(w->context, path, object, type);
    if (io->status == HF_OK && type == H5I_GROUP) {
        snprintf(w->path + length, sizeof w->path - length, "%s/", name);
        w->depth++;
        walk_group(w, object);
        w->depth--;
        w->path[length] = '\0';
    }
    hf_hdf5_close(io, object);
}

static herr_t visit_link(hid_t group, const char *name, const H5L_info_t *info, void *context)
{
    walk *w = context;
    hf_hdf5 *io = w->io;
    char path[sizeof w->path];
    if (snprintf(path, sizeof path, "%s%s", w->path, name) >= (int)sizeof path - 1)
        hf_hdf5_damaged(io, io->file, w->path, "holds a name that is too long");
    else if (info->type == H5L_TYPE_HARD)
        visit_object(w, group, name, path);
    else
        w->visit(w->context, path, -1, H5I_BADID);
    return io->status == HF_OK ? 0 : 1;
}

static herr_t pass_link(hid_t group, const char *name, const H5L_info_t *info, void *context)
{
    (void)group, (void)name, (void)info, (void)context;
    return 0;
}

/* The first pass, in the order in which the links are stored, fails where the second one would crash: HDF5 sorts links
 * in a table, and frees what it has not filled when one of them cannot be read. */
static void walk_group(walk *w, hid_t group)
{
    if (H5Literate(group, H5_INDEX_NAME, H5_ITER_NATIVE, NULL, pass_link, NULL) < 0 ||
        H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, NULL, visit_link, w) < 0)
        hf_hdf5_fail(w->io, "read", w->io->file, w->path);
}

void hf_hdf5_walk(hf_hdf5 *io, hf_hdf5_visit *visit, void *context)
{
    walk w = {.io = io, .visit = visit, .context = context, .path = "/"};
    if (io->status != HF_OK) return;
    hid_t root = hf_hdf5_open_group(io, "/");
    if (io->status == HF_OK) walk_group(&w, root);
    hf_hdf5_close(io, root);
}
