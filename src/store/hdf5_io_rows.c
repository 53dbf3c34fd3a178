/* Data sets that grow row by row, and texts that are read back. */
#include "store/hdf5_io.h"

#include <stdlib.h>
#include <string.h>

/* The rows [row, row + dims[0]) of an open data set, as spaces of the file and of memory. 0, or -1. */
static int select_rows(const hf_hdf5_array *a, hsize_t row, hid_t data_set, hid_t *space, hid_t *memory)
{
    hsize_t start[3] = {row, 0, 0};
    *space = H5Dget_space(data_set);
    *memory = H5Screate_simple(a->rank, a->dims, NULL);
    if (*space < 0 || *memory < 0 || H5Sget_simple_extent_ndims(*space) != a->rank) return -1;
    return H5Sselect_hyperslab(*space, H5S_SELECT_SET, start, NULL, a->dims, NULL) < 0 ? -1 : 0;
}

/* Rows come many at a time: HDF5's cache of chunks would only copy them once more. */
static hid_t open_uncached(hid_t group, const char *name)
{
    hid_t access = H5Pcreate(H5P_DATASET_ACCESS), data_set = -1;
    if (access >= 0 && H5Pset_chunk_cache(access, 1, 0, 1) >= 0) data_set = H5Dopen2(group, name, access);
    if (access >= 0) H5Pclose(access);
    return data_set;
}

void hf_hdf5_write_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *a, hsize_t row, const void *values)
{
    hid_t data_set = -1, type = -1, space = -1, memory = -1;
    hsize_t extent[3] = {row + a->dims[0], a->dims[1], a->dims[2]};
    if (io->status != HF_OK) return;
    if ((data_set = open_uncached(group, a->name)) < 0 || H5Dset_extent(data_set, extent) < 0 ||
        (type = hf_hdf5_array_type(a)) < 0 || select_rows(a, row, data_set, &space, &memory) < 0 ||
        H5Dwrite(data_set, type, memory, space, H5P_DEFAULT, values) < 0)
        hf_hdf5_fail(io, "write", group, a->name);
    hf_hdf5_close(io, memory);
    hf_hdf5_close(io, space);
    hf_hdf5_close(io, type);
    hf_hdf5_close(io, data_set);
}

void hf_hdf5_read_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *a, hsize_t row, void *values)
{
    hid_t data_set = -1, type = -1, space = -1, memory = -1;
    if (io->status != HF_OK) return;
    if ((data_set = H5Dopen2(group, a->name, H5P_DEFAULT)) < 0 || (type = hf_hdf5_array_type(a)) < 0 ||
        select_rows(a, row, data_set, &space, &memory) < 0 ||
        H5Dread(data_set, type, memory, space, H5P_DEFAULT, values) < 0)
        hf_hdf5_fail(io, "read", group, a->name);
    hf_hdf5_close(io, memory);
    hf_hdf5_close(io, space);
    hf_hdf5_close(io, type);
    hf_hdf5_close(io, data_set);
}

void hf_hdf5_read_text(hf_hdf5 *io, hid_t group, const char *name, char **text)
{
    hf_hdf5_array array = {.name = name, .kind = HF_KIND_CHARS};
    *text = NULL;
    array.dims[0] = hf_hdf5_chars_length(io, group, name);
    if (io->status != HF_OK) return;
    *text = calloc(array.dims[0] + 1, 1);
    if (!*text)
        hf_hdf5_no_memory(io);
    else
        hf_hdf5_read_array(io, group, &array, *text);
}

void hf_hdf5_write_ids(hf_hdf5 *io, hid_t group, const char *name, const char *const *id, int n,
                       const char *description)
{
    size_t length = 1;
    for (int i = 0; i < n; i++)
        length = strlen(id[i]) > length ? strlen(id[i]) : length;
    hf_hdf5_array array = {name, HF_KIND_CHARS, 1, {(hsize_t)n, length}, "", description};
    char *chars = io->status == HF_OK ? calloc((size_t)n, length) : NULL;
    if (!chars) hf_hdf5_no_memory(io);
    for (int i = 0; chars && i < n; i++)
        memcpy(chars + (size_t)i * length, id[i], strlen(id[i]));
    if (chars) hf_hdf5_write_array(io, group, &array, chars);
    free(chars);
}
