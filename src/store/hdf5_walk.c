/* Visits every object of a file in turn. H5Lvisit of HDF5 itself crashes on damaged files and has no limit. */
#include "store/hdf5.h"

#include <stdio.h>
#include <string.h>

/* Limits of a walk. A result has 5 levels and about 200 objects. A merge has as many objects as a run has figures and
 * its study has axes. The limits end the walk through a group that contains itself. */
#define DEPTH_MAX 12
#define OBJECTS_MAX 20000

typedef struct {
    hf_hdf5 *io;
    hf_hdf5_visit *visit;
    void *context;
    int depth, n_object;
    char path[1024]; /* of the current group, ending with a slash */
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

/* Walks the objects of a group. The first pass visits the links in the order in which they are stored, and fails where
 * the second pass would crash. For the second pass HDF5 sorts the links in a table, and it frees entries that it has
 * not filled if one link cannot be read. */
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
