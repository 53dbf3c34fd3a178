/* Checks files, links and objects before HDF5 opens, follows or reads them:
 *
 *     file        an ordinary file with HDF5 content
 *     each link   a hard link
 *     object      of the expected type
 *     data set    all values in this file, as many as the dimensions say
 *
 * Damaged files can crash HDF5 or make it run forever; hf_hdf5_try reads a file in a child process first. Sections: the
 * file, links, data sets, crashes, objects. */
#include "store/hdf5.h"

#include "base/file_io.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- the file ---- */

bool hf_hdf5_look_at_file(hf_hdf5 *io, const char *name)
{
    struct stat info;
    io->file = -1;
    if (stat(name, &info) != 0) {
        io->is_damaged = hf_file_io_fault(errno, HF_OK) == HF_OK;
        io->status = hf_error(io->messages, HF_IO, "%s: cannot open: %s", io->path, strerror(errno));
    } else if (S_ISDIR(info.st_mode)) {
        io->is_damaged = true;
        io->status = hf_error(io->messages, HF_IO, "%s: this is a folder, not a result file", io->path);
    } else if (!S_ISREG(info.st_mode) || H5Fis_hdf5(name) == 0) {
        io->is_damaged = true;
        io->status = hf_error(io->messages, HF_IO,
                              "%s: this file is not a result of hifdm, because it is not an HDF5 file", io->path);
    }
    return io->status == HF_OK;
}

/* ---- links ---- */

/* Returns true for a hard link; records damage for another link. A soft or external link may lead into another file, to
 * a pipe into which no process writes, or round in a circle. Only merges have such links, to the results of their
 * points. store_series reads these links and never follows them. */
static bool is_hard(hf_hdf5 *io, hid_t place, const char *name)
{
    H5L_info_t info;
    if (H5Lget_info(place, name, &info, H5P_DEFAULT) < 0)
        hf_hdf5_fail(io, "read", place, name);
    else if (info.type != H5L_TYPE_HARD)
        hf_hdf5_damaged(io, place, name, "is a link to another place");
    return io->status == HF_OK;
}

bool hf_hdf5_is(hf_hdf5 *io, hid_t place, const char *name, H5I_type_t type)
{
    hid_t object = H5Oopen(place, name, H5P_DEFAULT);
    bool is = object >= 0 && H5Iget_type(object) == type;
    if (object < 0) hf_hdf5_fail(io, "read", place, name);
    hf_hdf5_close(io, object);
    return is;
}

bool hf_hdf5_has(hf_hdf5 *io, hid_t place, const char *name)
{
    char part[HF_HDF5_NAME_SIZE], found[HF_HDF5_NAME_SIZE];
    if (io->status != HF_OK) return false;
    name = hf_hdf5_name(io, place, name, found);
    if (!strcmp(name, ".") || !strcmp(name, "/")) return true;
    for (const char *end = name; *end;) {
        end += *end == '/';
        end += strcspn(end, "/");
        if ((size_t)(end - name) >= sizeof part) return false;
        snprintf(part, sizeof part, "%.*s", (int)(end - name), name);
        htri_t has = H5Lexists(place, part, H5P_DEFAULT);
        if (has < 0) hf_hdf5_fail(io, "read", place, part);
        if (has <= 0 || !is_hard(io, place, part)) return false;
        /* Below a data set there are no objects, so a path through one does not exist. */
        if (*end && *part && !hf_hdf5_is(io, place, part, H5I_GROUP)) return false;
    }
    return true;
}

/* ---- data sets ---- */

#define DEFLATE_MAX 1100 /* zlib packs at most 1032 bytes into one byte; the other filters of HDF5 pack less */

/* Returns the bytes of all values, SIZE_MAX if they exceed it. */
static size_t size_of_values(hid_t space, hid_t type)
{
    hsize_t dims[H5S_MAX_RANK];
    int rank = H5Sget_simple_extent_dims(space, dims, NULL);
    size_t bytes = H5Tget_size(type);
    if (H5Sget_simple_extent_type(space) == H5S_NULL) return 0;
    for (int i = 0; i < rank; i++)
        if (dims[i] == 0) return 0;
    for (int i = 0; i < rank; i++)
        bytes = dims[i] > SIZE_MAX / bytes ? SIZE_MAX : bytes * (size_t)dims[i];
    return bytes;
}

/* Checks that the values are in this file, and that there are as many as the dimensions say. HDF5 would fill in values
 * that were never written, for days if the dimensions are large. */
static void check_storage(hf_hdf5 *io, hid_t place, const char *name, hid_t data_set)
{
    hid_t space = H5Dget_space(data_set), type = H5Dget_type(data_set), how = H5Dget_create_plist(data_set);
    H5D_layout_t layout = how >= 0 ? H5Pget_layout(how) : H5D_LAYOUT_ERROR;
    if (space < 0 || type < 0 || layout == H5D_LAYOUT_ERROR || H5Tget_size(type) == 0) {
        hf_hdf5_fail(io, "read", place, name);
    } else if (layout == H5D_VIRTUAL || H5Pget_external_count(how) != 0) {
        hf_hdf5_damaged(io, place, name, "has its values in another file");
    } else {
        size_t bytes = size_of_values(space, type), pack = H5Pget_nfilters(how) > 0 ? DEFLATE_MAX : 1;
        if (bytes > 0 && bytes / pack > H5Dget_storage_size(data_set))
            hf_hdf5_damaged(io, place, name, "has larger dimensions than there are values");
    }
    HF_HDF5_CLOSE(io, how, type, space);
}

/* ---- crashes ---- */

char *hf_hdf5_reading;

void hf_hdf5_note(const hf_hdf5 *io)
{
    if (!hf_hdf5_reading) return;
    if (io) snprintf(hf_hdf5_reading, HF_HDF5_READING_SIZE, "%s", io->path);
    hf_child_limit_cpu(io ? HF_HDF5_CPU_S : 0);
}

void hf_hdf5_limit(void)
{
    static char reading[HF_HDF5_READING_SIZE];
    hf_hdf5_reading = reading;
}

/* Runs the command with the path. Returns false if the program could not start or has not done its work. */
static bool try_by_program(const char *const *command, const char *path, hf_child_end *end)
{
    pid_t child = hf_child_spawn(command, path);
    if (child > 0) *end = hf_child_wait(child);
    return child > 0 && end->exit_status <= 0;
}

hf_status hf_hdf5_try(hf_child_work *work, const char *const *command, const char *path, char *how, size_t size,
                      hf_messages *messages)
{
    hf_child_end end = {.is_known = false};
    if (!hf_child_ask(work, path, &end) && !(command && try_by_program(command, path, &end))) {
        hf_hdf5_lock(); /* ensures that no other thread is within HDF5 */
        pid_t child = hf_child_fork();
        hf_hdf5_unlock(HF_OK);
        if (child == 0) {
            work(path);
            _exit(0);
        }
        if (child > 0) end = hf_child_wait(child);
    }
    if (!end.is_known || end.exit_status == 0) return HF_OK;
    hf_child_describe(end, how, size);
    return end.is_sent ? hf_error(messages, HF_IO, "%s: the process that read this file was ended by %s", path, how)
                       : HF_EXISTS;
}

/* ---- objects ---- */

hid_t hf_hdf5_open(hf_hdf5 *io, hid_t place, const char *name, H5I_type_t wanted)
{
    char found[HF_HDF5_NAME_SIZE];
    hf_hdf5_note(io);
    name = hf_hdf5_name(io, place, name, found);
    if (!hf_hdf5_has(io, place, name)) {
        hf_hdf5_missing(io, place, name, NULL);
        return -1;
    }
    hid_t id = H5Oopen(place, name, H5P_DEFAULT);
    if (id < 0)
        hf_hdf5_fail(io, "read", place, name);
    else if (H5Iget_type(id) != wanted)
        hf_hdf5_damaged(io, place, name, wanted == H5I_GROUP ? "is no group" : "is no data set");
    else if (wanted == H5I_DATASET)
        check_storage(io, place, name, id);
    if (io->status == HF_OK) return id;
    hf_hdf5_close(io, id);
    return -1;
}
