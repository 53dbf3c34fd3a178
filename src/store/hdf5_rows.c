/* Data sets that grow row by row, strings that are read back, and ids. */
#include "store/hdf5.h"

#include "base/arena.h"

#include <stdlib.h>
#include <string.h>

/* Selects rows row to row + dims[0] - 1 of an open data set: *space is their data space in the file, *memory that of
 * the values. Returns 0, or -1 after a failure. The caller closes both. */
static int select_rows(const hf_hdf5_array *a, hsize_t row, hid_t data_set, hid_t *space, hid_t *memory)
{
    hsize_t start[3] = {row, 0, 0};
    *space = H5Dget_space(data_set);
    *memory = H5Screate_simple(a->rank, a->dims, NULL);
    if (*space < 0 || *memory < 0 || H5Sget_simple_extent_ndims(*space) != a->rank) return -1;
    return H5Sselect_hyperslab(*space, H5S_SELECT_SET, start, NULL, a->dims, NULL) < 0 ? -1 : 0;
}

/* Opens a data set without HDF5's cache of chunks. Many rows come at a time, so the cache would only copy them once
 * more. */
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
    data_set = hf_hdf5_open(io, group, a->name, H5I_DATASET);
    hf_hdf5_check_array(io, group, a, data_set, row, false);
    if (io->status == HF_OK &&
        ((type = hf_hdf5_array_type(a)) < 0 || select_rows(a, row, data_set, &space, &memory) < 0 ||
         H5Dread(data_set, type, memory, space, H5P_DEFAULT, values) < 0))
        hf_hdf5_fail(io, "read", group, a->name);
    hf_hdf5_check_values(io, group, a, values);
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

/* Reads the n strings of a data set side by side, as they are stored: chars[n][*length]. The caller frees the arena. */
static char *read_chars(hf_hdf5 *io, hid_t group, const char *name, int n, size_t *length, hf_arena *arena)
{
    *length = hf_hdf5_chars_length(io, group, name);
    char *chars = NULL;
    if (io->status != HF_OK) return NULL;
    if (HF_ARENA_MAKE(arena, chars = hf_arena_take(arena, (size_t)n, *length)) != HF_OK) {
        hf_hdf5_no_memory(io);
        return NULL;
    }
    hf_hdf5_array array = {.name = name, .kind = HF_KIND_CHARS, .rank = 1, .dims = {(hsize_t)n, *length}};
    hf_hdf5_read_array(io, group, &array, chars);
    return chars;
}

/* Copies the n strings one after the other to `text`, each with a NUL, and points id[n] at them. */
static void place_ids(const char *chars, size_t length, int n, const char **id, char *text)
{
    for (int i = 0; i < n; i++) {
        const char *from = chars + (size_t)i * length, *end = memchr(from, '\0', length);
        size_t used = end ? (size_t)(end - from) : length;
        id[i] = memcpy(text, from, used);
        text += used;
        *text++ = '\0';
    }
}

void hf_hdf5_read_ids(hf_hdf5 *io, hid_t group, const char *name_a, int n, const char **id_a, const char *name_b, int m,
                      const char **id_b, void **text)
{
    size_t length_a, length_b;
    hf_arena a = {0}, b = {0}, all = {0};
    const char *chars_a = read_chars(io, group, name_a, n, &length_a, &a);
    const char *chars_b = read_chars(io, group, name_b, m, &length_b, &b);
    char *text_a = NULL, *text_b = NULL;
    if (io->status == HF_OK && HF_ARENA_MAKE(&all, (text_a = hf_arena_take(&all, (size_t)n, length_a + 1),
                                                    text_b = hf_arena_take(&all, (size_t)m, length_b + 1))) != HF_OK)
        hf_hdf5_no_memory(io);
    if (io->status == HF_OK) {
        *text = all.block;
        place_ids(chars_a, length_a, n, id_a, text_a);
        place_ids(chars_b, length_b, m, id_b, text_b);
    }
    hf_arena_free(&a);
    hf_arena_free(&b);
}
