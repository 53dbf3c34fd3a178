/* Implements store_series.h. Sections: numbers, texts, names, links. */
#include "store/store_series.h"

#include "base/arena.h"

#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAMES_MAX 1000 /* names in a group; more than there are keys, and so more than a study has axes */
#define LONGER 16      /* bytes by which a name may be longer than that of version 0.2 */
#define FILE_MAX 1024  /* bytes of the file name of a link; a longer name becomes "", and a page shows no link */

/* ---- numbers ---- */

/* Returns n of a data set of numbers [n] or [n][columns]; columns = 0: any number. Sets series->columns, and *type to
 * the type to read. HDF5 converts every kind of number to double, but not enumerations. */
static int measure_series(hf_hdf5 *io, const char *name, hid_t data_set, int columns, hf_series *series, hid_t *type)
{
    hsize_t dims[H5S_MAX_RANK] = {0};
    hid_t space = H5Dget_space(data_set), stored = H5Dget_type(data_set);
    int rank = space >= 0 ? H5Sget_simple_extent_dims(space, dims, NULL) : -1;
    H5T_class_t class = stored >= 0 ? H5Tget_class(stored) : H5T_NO_CLASS;
    series->columns = rank == 2 && dims[1] < INT_MAX ? (int)dims[1] : 1;
    *type = class == H5T_ENUM ? H5T_NATIVE_SCHAR : H5T_NATIVE_DOUBLE;
    if (rank < 0 || class == H5T_NO_CLASS)
        hf_hdf5_fail(io, "read", io->file, name);
    else if (class != H5T_INTEGER && class != H5T_FLOAT && (class != H5T_ENUM || H5Tget_size(stored) != 1))
        hf_hdf5_damaged(io, io->file, name, "is of another type");
    else if (rank < 1 || rank > 2 || (columns && columns != series->columns) || dims[0] > HF_LAYOUT_COUNT_MAX)
        hf_hdf5_damaged(io, io->file, name, "has other dimensions than a report reads");
    hf_hdf5_close(io, stored);
    hf_hdf5_close(io, space);
    return io->status == HF_OK ? (int)dims[0] : 0;
}

static void read_series(hf_hdf5 *io, const char *name, int columns, hf_series *series)
{
    hid_t data_set = hf_hdf5_open(io, io->file, name, H5I_DATASET), type = -1;
    hf_arena arena = {0};
    if (io->status != HF_OK) return;
    int n = measure_series(io, name, data_set, columns, series, &type);
    size_t count = (size_t)n * (size_t)series->columns;
    double *value = NULL;
    if (n > 0 && HF_ARENA_MAKE(&arena, value = hf_arena_take(&arena, count, sizeof(double))) != HF_OK)
        hf_hdf5_no_memory(io);
    if (n > 0 && io->status == HF_OK) {
        *series = (hf_series){n, series->columns, value, arena.block};
        if (H5Dread(data_set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, series->value) < 0)
            hf_hdf5_fail(io, "read", io->file, name);
        for (size_t i = type == H5T_NATIVE_SCHAR ? count : 0; i-- > 0;) /* in place, from the end */
            series->value[i] = ((const signed char *)series->value)[i];
    }
    hf_hdf5_close(io, data_set);
}

hf_status hf_store_read_series(const char *path, const char *name, int columns, hf_series *series,
                               hf_messages *messages)
{
    hf_hdf5_lock();
    hf_hdf5 io = hf_store_open_result(path, messages);
    *series = (hf_series){0};
    if (hf_hdf5_has(&io, io.file, name)) read_series(&io, name, columns, series);
    hf_hdf5_close_file(&io);
    if (io.status != HF_OK) hf_series_free(series);
    return hf_hdf5_unlock(io.status);
}

void hf_series_free(hf_series *series)
{
    hf_arena_free(&(hf_arena){.block = series->block});
    *series = (hf_series){0};
}

/* ---- texts ---- */

const char *hf_texts_at(const hf_texts *texts, int i)
{
    return texts->text + (size_t)i * texts->length;
}

void hf_texts_free(hf_texts *texts)
{
    hf_arena_free(&(hf_arena){.block = texts->block});
    *texts = (hf_texts){0};
}

/* Allocates n texts of `length` bytes, all zero. A text therefore ends with a NUL if only its first length - 1 bytes
 * are written. */
static bool allocate(hf_hdf5 *io, int n, size_t length, hf_texts *texts)
{
    hf_arena arena = {0};
    char *chars = NULL;
    if (io->status == HF_OK && HF_ARENA_MAKE(&arena, chars = hf_arena_take(&arena, (size_t)n, length)) != HF_OK)
        hf_hdf5_no_memory(io);
    if (io->status != HF_OK) return false;
    *texts = (hf_texts){n, length, chars, arena.block};
    return true;
}

static hf_status finish(hf_hdf5 *io, hf_texts *texts)
{
    hf_hdf5_close_file(io);
    if (io->status != HF_OK) hf_texts_free(texts);
    return hf_hdf5_unlock(io->status);
}

#define DIGITS_SIZE 24 /* bytes for 64 bits in decimal digits and the NUL; a multiple of 8 */

/* Reads n unsigned 64-bit numbers as decimal digits. A double might not hold them exactly. */
static void read_digits(hf_hdf5 *io, const char *name, hid_t data_set, int n, hf_texts *texts)
{
    if (!allocate(io, n, DIGITS_SIZE, texts)) return;
    if (H5Dread(data_set, H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts->text) < 0) {
        hf_hdf5_fail(io, "read", io->file, name);
        return;
    }
    for (int i = n; i-- > 0;) { /* in place, from the end */
        uint64_t value;
        memcpy(&value, texts->text + (size_t)i * sizeof value, sizeof value);
        snprintf(texts->text + (size_t)i * DIGITS_SIZE, DIGITS_SIZE, "%" PRIu64, value);
    }
}

static void read_texts(hf_hdf5 *io, const char *name, hid_t data_set, hf_texts *texts)
{
    hsize_t n = 0;
    hid_t space = H5Dget_space(data_set), stored = H5Dget_type(data_set), type = -1;
    int rank = space >= 0 ? H5Sget_simple_extent_ndims(space) : -1;
    size_t length = stored >= 0 ? H5Tget_size(stored) : 0;
    bool is_fixed = stored >= 0 && H5Tget_class(stored) == H5T_STRING && H5Tis_variable_str(stored) == 0;
    bool is_uint64 =
        length == sizeof(uint64_t) && H5Tget_class(stored) == H5T_INTEGER && H5Tget_sign(stored) == H5T_SGN_NONE;
    if (rank < 0 || length == 0) {
        hf_hdf5_fail(io, "read", io->file, name);
        n = 0;
    } else if (rank == 0 && is_fixed) {
        n = 1;
    } else if (!(rank == 1 && (is_fixed || is_uint64) && H5Sget_simple_extent_dims(space, &n, NULL) == 1)) {
        n = 0;
    }
    if (n > 0) {
        if (n > HF_LAYOUT_COUNT_MAX)
            hf_hdf5_damaged(io, io->file, name, "is too large");
        else if (is_uint64)
            read_digits(io, name, data_set, (int)n, texts);
        else if (allocate(io, (int)n, length + 1, texts)) {
            type = H5Tcopy(H5T_C_S1); /* one byte longer than stored, for the NUL */
            if (type < 0 || H5Tset_size(type, length + 1) < 0 || H5Tset_cset(type, H5Tget_cset(stored)) < 0 ||
                H5Dread(data_set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts->text) < 0)
                hf_hdf5_fail(io, "read", io->file, name);
        }
    }
    hf_hdf5_close(io, type);
    hf_hdf5_close(io, stored);
    hf_hdf5_close(io, space);
}

hf_status hf_store_read_texts(const char *path, const char *name, hf_texts *texts, hf_messages *messages)
{
    hf_hdf5_lock();
    hf_hdf5 io = hf_store_open_result(path, messages);
    *texts = (hf_texts){0};
    if (hf_hdf5_has(&io, io.file, name)) {
        hid_t data_set = hf_hdf5_open(&io, io.file, name, H5I_DATASET);
        if (io.status == HF_OK) read_texts(&io, name, data_set, texts);
        hf_hdf5_close(&io, data_set);
    }
    return finish(&io, texts);
}

/* ---- names ---- */

static int by_text(const void *a, const void *b)
{
    return strcmp(a, b);
}

static void read_names(hf_hdf5 *io, const char *name, hid_t group, hf_texts *names)
{
    H5G_info_t info;
    size_t longest = 0;
    if (H5Gget_info(group, &info) < 0) {
        hf_hdf5_fail(io, "read", io->file, name);
        return;
    }
    if (info.nlinks == 0) return;
    if (info.nlinks > NAMES_MAX) hf_hdf5_damaged(io, io->file, name, "holds too many names");
    for (hsize_t i = 0; i < info.nlinks && io->status == HF_OK; i++) {
        ssize_t used = H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, NULL, 0, H5P_DEFAULT);
        if (used < 0) hf_hdf5_fail(io, "read", io->file, name);
        if (used >= FILE_MAX) hf_hdf5_damaged(io, io->file, name, "holds a name that is too long");
        if (used > 0 && (size_t)used > longest) longest = (size_t)used;
    }
    if (!allocate(io, (int)info.nlinks, longest + LONGER + 1, names)) return;
    names->n = 0;
    for (hsize_t i = 0; i < info.nlinks; i++) {
        char *to = names->text + (size_t)names->n * names->length;
        H5L_info_t link;
        H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, to, names->length, H5P_DEFAULT);
        /* Soft links are old names of other objects. */
        names->n += H5Lget_info_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, &link, H5P_DEFAULT) >= 0 &&
                    link.type != H5L_TYPE_SOFT;
    }
    if (!io->alias) return;
    for (int i = 0; i < names->n; i++) { /* names of version 0.2 */
        char then[FILE_MAX], now[FILE_MAX + 32];
        char *to = names->text + (size_t)i * names->length;
        snprintf(then, sizeof then, "%s", to);
        snprintf(to, names->length, "%s", hf_renamed_point(name, then, now, sizeof now));
    }
    qsort(names->text, (size_t)names->n, names->length, by_text);
}

hf_status hf_store_read_names(const char *path, const char *group, hf_texts *names, hf_messages *messages)
{
    hf_hdf5_lock();
    hf_hdf5 io = hf_store_open_result(path, messages);
    *names = (hf_texts){0};
    if (hf_hdf5_has(&io, io.file, group)) {
        hid_t id = hf_hdf5_open_group(&io, group);
        if (io.status == HF_OK) read_names(&io, group, id, names);
        hf_hdf5_close(&io, id);
    }
    return finish(&io, names);
}

/* ---- links ---- */

/* Writes the file of an external link into file[FILE_MAX]. Writes nothing for another link, or if the name is too
 * long. */
static void read_link(hf_hdf5 *io, hid_t group, const char *name, char *file)
{
    char value[2 * FILE_MAX];
    const char *target = NULL, *object = NULL;
    H5L_info_t info;
    if (!*name || strchr(name, '/') || H5Lexists(group, name, H5P_DEFAULT) <= 0) return;
    if (H5Lget_info(group, name, &info, H5P_DEFAULT) < 0) {
        hf_hdf5_fail(io, "read", group, name);
        return;
    }
    if (info.type != H5L_TYPE_EXTERNAL || info.u.val_size > sizeof value) return;
    if (H5Lget_val(group, name, value, sizeof value, H5P_DEFAULT) < 0 ||
        H5Lunpack_elink_val(value, info.u.val_size, NULL, &target, &object) < 0)
        hf_hdf5_fail(io, "read", group, name);
    else if (strlen(target) < FILE_MAX)
        strcpy(file, target);
}

hf_status hf_store_read_links(const char *path, const char *group, const hf_texts *names, hf_texts *files,
                              hf_messages *messages)
{
    hf_hdf5_lock();
    hf_hdf5 io = hf_store_open_result(path, messages);
    *files = (hf_texts){0};
    if (names->n > 0 && hf_hdf5_has(&io, io.file, group) && allocate(&io, names->n, FILE_MAX, files)) {
        hid_t id = hf_hdf5_open_group(&io, group);
        for (int i = 0; i < names->n && io.status == HF_OK; i++)
            read_link(&io, id, hf_texts_at(names, i), files->text + (size_t)i * files->length);
        hf_hdf5_close(&io, id);
    }
    return finish(&io, files);
}
