#include "store/store_table.h"

#include "base/arena.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define FILE_MAX 1024 /* bytes of the name that a link leads to; of longer ones nothing is told */

const char *hf_texts_at(const hf_texts *texts, int i)
{
    return texts->text + (size_t)i * texts->length;
}

void hf_texts_free(hf_texts *texts)
{
    hf_arena_free(&(hf_arena){.block = texts->block});
    *texts = (hf_texts){0};
}

/* All zero, so every text ends whatever is copied into length - 1 of its bytes. */
static int allocate(hf_hdf5 *io, int n, size_t length, hf_texts *texts)
{
    hf_arena arena = {0};
    hf_arena_take(&arena, (size_t)n, length);
    if (io->status == HF_OK && hf_arena_allocate(&arena) != HF_OK) hf_hdf5_no_memory(io);
    if (io->status != HF_OK) return 0;
    *texts = (hf_texts){n, length, hf_arena_take(&arena, (size_t)n, length), arena.block};
    return 1;
}

static hf_status finish(hf_hdf5 *io, hf_texts *texts)
{
    hf_hdf5_close_file(io);
    if (io->status != HF_OK) hf_texts_free(texts);
    return hf_hdf5_unlock(io->status);
}

/* ---- texts ---- */

#define DIGITS_SIZE 24 /* of 64 bits in decimal, and the NUL; a multiple of 8 */

/* Decimal digits of n numbers that a double might not hold. */
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
    int is_fixed = stored >= 0 && H5Tget_class(stored) == H5T_STRING && H5Tis_variable_str(stored) == 0;
    int is_uint64 =
        length == sizeof(uint64_t) && H5Tget_class(stored) == H5T_INTEGER && H5Tget_sign(stored) == H5T_SGN_NONE;
    if (rank < 0 || length == 0) {
        hf_hdf5_fail(io, "read", io->file, name);
    } else if (rank == 1 && (is_fixed || is_uint64) && H5Sget_simple_extent_dims(space, &n, NULL) == 1 && n > 0) {
        if (n > HF_STORE_COUNT_MAX)
            hf_hdf5_damaged(io, io->file, name, "is too large");
        else if (is_uint64)
            read_digits(io, name, data_set, (int)n, texts);
        else if (allocate(io, (int)n, length + 1, texts)) {
            type = H5Tcopy(H5T_C_S1); /* one byte longer than stored: room for the NUL */
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
    if (hf_store_is_there(&io, name)) {
        hid_t data_set = H5Dopen2(io.file, name, H5P_DEFAULT);
        if (data_set < 0)
            hf_hdf5_fail(&io, "read", io.file, name);
        else
            read_texts(&io, name, data_set, texts);
        hf_hdf5_close(&io, data_set);
    }
    return finish(&io, texts);
}

/* ---- names ---- */

static void read_names(hf_hdf5 *io, const char *name, hid_t group, hf_texts *names)
{
    H5G_info_t info;
    size_t longest = 0;
    if (H5Gget_info(group, &info) < 0) {
        hf_hdf5_fail(io, "read", io->file, name);
        return;
    }
    if (info.nlinks == 0 || info.nlinks > HF_STORE_COUNT_MAX) return;
    for (hsize_t i = 0; i < info.nlinks; i++) {
        ssize_t used = H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, NULL, 0, H5P_DEFAULT);
        if (used < 0) hf_hdf5_fail(io, "read", io->file, name);
        if (used > 0 && (size_t)used > longest) longest = (size_t)used;
    }
    if (!allocate(io, (int)info.nlinks, longest + 1, names)) return;
    for (hsize_t i = 0; i < info.nlinks; i++)
        H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, names->text + i * names->length, names->length,
                           H5P_DEFAULT);
}

hf_status hf_store_read_names(const char *path, const char *group, hf_texts *names, hf_messages *messages)
{
    hf_hdf5_lock();
    hf_hdf5 io = hf_store_open_result(path, messages);
    *names = (hf_texts){0};
    if (hf_store_is_there(&io, group)) {
        hid_t id = hf_hdf5_open_group(&io, group);
        if (io.status == HF_OK) read_names(&io, group, id, names);
        hf_hdf5_close(&io, id);
    }
    return finish(&io, names);
}

/* ---- links ---- */

/* The file of an external link, into `file` of FILE_MAX bytes; nothing when it is none. */
static void read_link(hf_hdf5 *io, hid_t group, const char *name, char *file)
{
    char value[2 * FILE_MAX];
    const char *target = NULL, *object = NULL;
    H5L_info_t info;
    if (!*name || strchr(name, '/') || !hf_hdf5_has(io, group, name)) return;
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
    if (names->n > 0 && hf_store_is_there(&io, group) && allocate(&io, names->n, FILE_MAX, files)) {
        hid_t id = hf_hdf5_open_group(&io, group);
        for (int i = 0; i < names->n && io.status == HF_OK; i++)
            read_link(&io, id, hf_texts_at(names, i), files->text + (size_t)i * files->length);
        hf_hdf5_close(&io, id);
    }
    return finish(&io, files);
}
