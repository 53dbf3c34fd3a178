/* Implements store_series.h. Sections: numbers, texts, names, links. */
#include "store/store_series.h"

#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAMES_MAX 1000 /* names in a group; more than there are keys, and so more than a study has axes */
/* Bytes of the name of a link, and of the file name in it. A longer file name becomes "", and a page shows no link. */
#define FILE_MAX 1024

/* ---- numbers ---- */

/* HDF5 converts every kind of number to double, but not enumerations. */
static void read_series(hf_hdf5 *io, const char *name, int columns, hf_series *series)
{
    hf_hdf5_data_set d;
    hf_hdf5_open_data_set(io, io->file, name, &d);
    H5T_class_t class = d.type >= 0 ? H5Tget_class(d.type) : H5T_NO_CLASS;
    bool is_enum = class == H5T_ENUM;
    int n_column = d.rank == 2 && d.dims[1] < INT_MAX ? (int)d.dims[1] : 1;
    if (io->status == HF_OK && class != H5T_INTEGER && class != H5T_FLOAT && !(is_enum && H5Tget_size(d.type) == 1))
        hf_hdf5_damaged(io, io->file, name, "is of another type");
    if (io->status == HF_OK &&
        (d.rank < 1 || d.rank > 2 || (columns && columns != n_column) || d.dims[0] > HF_LAYOUT_COUNT_MAX))
        hf_hdf5_damaged(io, io->file, name, "has other dimensions than a report reads");
    size_t count = io->status == HF_OK ? (size_t)d.dims[0] * (size_t)n_column : 0;
    series->columns = n_column;
    if (count > 0) series->value = hf_hdf5_take(io, count, sizeof *series->value);
    if (count > 0 && io->status == HF_OK) {
        series->n = (int)d.dims[0];
        if (H5Dread(d.id, is_enum ? H5T_NATIVE_SCHAR : H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                    series->value) < 0)
            hf_hdf5_fail(io, "read", io->file, name);
        for (size_t i = is_enum ? count : 0; i-- > 0;) /* in place, from the end */
            series->value[i] = ((const signed char *)series->value)[i];
    }
    hf_hdf5_close_data_set(io, &d);
}

hf_status hf_store_read_series(const char *path, const char *name, int columns, hf_series *series,
                               hf_messages *messages)
{
    hf_hdf5 io = hf_store_open_result(path, messages);
    *series = (hf_series){0};
    if (hf_hdf5_has(&io, io.file, name)) read_series(&io, name, columns, series);
    if (hf_store_close_result(&io) != HF_OK) hf_series_free(series);
    return io.status;
}

void hf_series_free(hf_series *series)
{
    free(series->value);
    *series = (hf_series){0};
}

/* ---- texts ---- */

const char *hf_texts_at(const hf_texts *texts, int i)
{
    return texts->text + (size_t)i * texts->length;
}

void hf_texts_free(hf_texts *texts)
{
    free(texts->text);
    *texts = (hf_texts){0};
}

/* Allocates n texts of `length` bytes, all zero. A text therefore ends with a NUL if only its first length - 1 bytes
 * are written. */
static bool allocate(hf_hdf5 *io, int n, size_t length, hf_texts *texts)
{
    char *text = hf_hdf5_take(io, (size_t)n, length);
    if (text) *texts = (hf_texts){n, length, text};
    return text != NULL;
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

static void read_texts(hf_hdf5 *io, const char *name, hf_texts *texts)
{
    hf_hdf5_data_set d;
    hf_hdf5_open_data_set(io, io->file, name, &d);
    if (io->status == HF_OK && d.rank <= 1) {
        size_t length = H5Tget_size(d.type);
        bool is_fixed = H5Tget_class(d.type) == H5T_STRING && H5Tis_variable_str(d.type) == 0;
        bool is_uint64 = d.rank == 1 && length == sizeof(uint64_t) && H5Tget_class(d.type) == H5T_INTEGER &&
                         H5Tget_sign(d.type) == H5T_SGN_NONE;
        hsize_t n = !is_fixed && !is_uint64 ? 0 : d.rank == 0 ? 1 : d.dims[0];
        if (n > HF_LAYOUT_COUNT_MAX)
            hf_hdf5_damaged(io, io->file, name, "is too large");
        else if (n > 0 && is_uint64)
            read_digits(io, name, d.id, (int)n, texts);
        else if (n > 0 && allocate(io, (int)n, length + 1, texts))
            hf_hdf5_take_strings(io, io->file, name, &d, length + 1, texts->text);
    }
    hf_hdf5_close_data_set(io, &d);
}

hf_status hf_store_read_texts(const char *path, const char *name, hf_texts *texts, hf_messages *messages)
{
    hf_hdf5 io = hf_store_open_result(path, messages);
    *texts = (hf_texts){0};
    if (hf_hdf5_has(&io, io.file, name)) read_texts(&io, name, texts);
    if (hf_store_close_result(&io) != HF_OK) hf_texts_free(texts);
    return io.status;
}

/* ---- names ---- */

static int by_text(const void *a, const void *b)
{
    return strcmp(a, b);
}

static void read_names(hf_hdf5 *io, const char *name, hid_t group, hf_texts *names)
{
    H5G_info_t info;
    if (H5Gget_info(group, &info) < 0) {
        hf_hdf5_fail(io, "read", io->file, name);
        return;
    }
    if (info.nlinks == 0) return;
    if (info.nlinks > NAMES_MAX) hf_hdf5_damaged(io, io->file, name, "holds too many names");
    if (!allocate(io, (int)info.nlinks, FILE_MAX, names)) return;
    names->n = 0;
    for (hsize_t i = 0; i < info.nlinks && io->status == HF_OK; i++) {
        char *to = names->text + (size_t)names->n * names->length;
        H5L_info_t link;
        ssize_t used = H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, to, FILE_MAX, H5P_DEFAULT);
        if (used < 0) hf_hdf5_fail(io, "read", io->file, name);
        if (used >= FILE_MAX) hf_hdf5_damaged(io, io->file, name, "holds a name that is too long");
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
    hf_hdf5 io = hf_store_open_result(path, messages);
    *names = (hf_texts){0};
    if (hf_hdf5_has(&io, io.file, group)) {
        hid_t id = hf_hdf5_open_group(&io, group);
        if (io.status == HF_OK) read_names(&io, group, id, names);
        hf_hdf5_close(&io, id);
    }
    if (hf_store_close_result(&io) != HF_OK) hf_texts_free(names);
    return io.status;
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
    hf_hdf5 io = hf_store_open_result(path, messages);
    *files = (hf_texts){0};
    if (names->n > 0 && hf_hdf5_has(&io, io.file, group) && allocate(&io, names->n, FILE_MAX, files)) {
        hid_t id = hf_hdf5_open_group(&io, group);
        for (int i = 0; i < names->n && io.status == HF_OK; i++)
            read_link(&io, id, hf_texts_at(names, i), files->text + (size_t)i * files->length);
        hf_hdf5_close(&io, id);
    }
    if (hf_store_close_result(&io) != HF_OK) hf_texts_free(files);
    return io.status;
}
