/* Compares two HDF5 files:
 *
 *     walk through file a    a data set of both files: compare type and dimensions, then the values in blocks of rows
 *                            a data set of file a alone: report it
 *     walk through file b    a data set of file b alone: report it
 *
 * A result of version 0.2 has other names (renamed.h). Beside one of this version it is the file that is walked through
 * second, and the names under which its data sets were found in the first walk are kept in a list.
 * The comparison of a data set ends at its first difference. Sections: one value, one data set, both files. */
#include "store/compare.h"

#include "base/text.h"
#include "store/hdf5.h"
#include "store/renamed.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK_BYTES (1 << 20) /* bytes read at a time, but at least one row; bounds the memory for files of any size */

typedef struct {
    hf_hdf5 a, b;
    hf_comparison *c;
    hf_compare_tell *tell;
    void *context;
    bool are_results;
    hf_hdf5 *first, *second; /* a and b, in the order of the walks */
    char **found; /* [n_found] names of data sets in `second` that are in `first`, too; of version 0.2 alone */
    int n_found;
} comparing;

/* An open data set of one file, with the type and the block of memory of its values. */
typedef struct {
    hf_hdf5_data_set of;
    hid_t type;
    size_t bytes; /* per value in memory */
    char *block;
} side;

/* ---- one value ---- */

static bool is_real(const side *s)
{
    return H5Tget_class(s->type) == H5T_FLOAT;
}

static bool is_text(const side *s)
{
    return H5Tis_variable_str(s->type) > 0;
}

/* Returns true for a name that version 0.2 has under another name. */
static bool is_renamed(const comparing *q, const side *a, const char *x, const char *y)
{
    char one[256], other[256], one_now[320], other_now[320];
    if (H5Tget_class(a->type) != H5T_STRING || !q->a.alias == !q->b.alias || a->bytes >= sizeof one) return false;
    snprintf(one, sizeof one, "%.*s", (int)a->bytes, x);
    snprintf(other, sizeof other, "%.*s", (int)a->bytes, y);
    return !strcmp(hf_renamed_figure(one, one_now, sizeof one_now),
                   hf_renamed_figure(other, other_now, sizeof other_now));
}

static bool are_equal(const comparing *q, const side *a, const side *b, const char *x, const char *y)
{
    if (is_text(a)) {
        const char *s, *t;
        memcpy(&s, x, sizeof s);
        memcpy(&t, y, sizeof t);
        return !strcmp(s ? s : "", t ? t : "");
    }
    if (!memcmp(x, y, a->bytes)) return true;
    if (!is_real(a)) return is_renamed(q, a, x, y);
    double u, v;
    memcpy(&u, x, sizeof u);
    memcpy(&v, y, sizeof v);
    if (isnan(u) && isnan(v)) return true;
    return (q->c->rtol > 0 || q->c->atol > 0) && b->bytes == sizeof v && isfinite(u) && isfinite(v) &&
           fabs(u - v) <= q->c->atol + q->c->rtol * fabs(v);
}

static void show(const side *s, const char *value, char *text, size_t size)
{
    long long n = 0;
    double x;
    const char *p;
    if (is_text(s)) {
        memcpy(&p, value, sizeof p);
        snprintf(text, size, "'%.60s'", p ? p : "");
    } else if (is_real(s)) {
        memcpy(&x, value, sizeof x);
        snprintf(text, size, "%.17g", x);
    } else if (H5Tget_class(s->type) == H5T_ENUM && H5Tenum_nameof(s->type, value, text, size) >= 0) {
        return;
    } else if (H5Tget_class(s->type) == H5T_INTEGER && s->bytes <= sizeof n) {
        memcpy(&n, value, s->bytes); /* fills the low bytes on a little-endian machine; the sign is extended below */
        int shift = 8 * (int)(sizeof n - s->bytes);
        if (H5Tget_sign(s->type) == H5T_SGN_2)
            snprintf(text, size, "%lld", (long long)((unsigned long long)n << shift) >> shift);
        else
            snprintf(text, size, "%llu", (unsigned long long)n);
    } else if (H5Tget_class(s->type) == H5T_STRING) {
        snprintf(text, size, "'%.*s'", (int)(s->bytes < 60 ? s->bytes : 60), value);
    } else {
        snprintf(text, size, "another value");
    }
}

/* ---- one data set ---- */

static void close_side(hf_hdf5 *io, side *s)
{
    hf_hdf5_close(io, s->type);
    hf_hdf5_close_data_set(io, &s->of);
    free(s->block);
}

static void open_side(hf_hdf5 *io, const char *name, side *s)
{
    *s = (side){.type = -1};
    hf_hdf5_open_data_set(io, io->file, name, &s->of);
    if (io->status != HF_OK) return;
    bool is_float = H5Tget_class(s->of.type) == H5T_FLOAT;
    s->type = is_float ? H5Tcopy(H5T_NATIVE_DOUBLE) : H5Tget_native_type(s->of.type, H5T_DIR_ASCEND);
    if (s->type < 0 || (s->bytes = H5Tget_size(s->type)) == 0) hf_hdf5_fail(io, "read", -1, name);
}

/* Reads rows row to row + n_row - 1 of the first dimension into s->block. Returns the data space of the block, which
 * the caller closes, or -1 if there is none. */
static hid_t read_rows(hf_hdf5 *io, const char *name, side *s, hsize_t row, hsize_t n_row)
{
    hsize_t start[H5S_MAX_RANK] = {row}, count[H5S_MAX_RANK];
    hid_t memory = -1;
    hf_hdf5_note(io);
    memcpy(count, s->of.dims, sizeof count);
    if (s->of.rank > 0) count[0] = n_row;
    if (io->status != HF_OK) return -1;
    if ((memory = H5Screate_simple(s->of.rank, s->of.rank ? count : NULL, NULL)) < 0 ||
        (s->of.rank && H5Sselect_hyperslab(s->of.space, H5S_SELECT_SET, start, NULL, count, NULL) < 0) ||
        H5Dread(s->of.id, s->type, memory, s->of.rank ? s->of.space : H5S_ALL, H5P_DEFAULT, s->block) < 0)
        hf_hdf5_fail(io, "read", -1, name);
    return memory;
}

static void tell_value(comparing *q, const char *name, const side *a, const side *b, hsize_t row, hsize_t i)
{
    char where[256] = "", u[96], v[96], how[600];
    hsize_t index[H5S_MAX_RANK], rest = i;
    for (int d = a->of.rank - 1; d > 0; d--) {
        index[d] = rest % a->of.dims[d];
        rest /= a->of.dims[d];
    }
    index[0] = row + rest;
    for (int d = 0; d < a->of.rank; d++)
        snprintf(where + strlen(where), sizeof where - strlen(where), "%s%llu", d ? ", " : " [",
                 (unsigned long long)index[d]);
    show(a, a->block + i * a->bytes, u, sizeof u);
    show(b, b->block + i * b->bytes, v, sizeof v);
    snprintf(how, sizeof how, "%s%s: %s in %s, %s in %s", where, a->of.rank ? "]" : "", u, q->a.path, v, q->b.path);
    q->tell(q->context, name, how);
}

/* Compares the values of two data sets with the same type and dimensions. Returns true if it has reported a
 * difference. */
static bool compare_values(comparing *q, const char *name, side *a, side *b)
{
    hsize_t per_row = 1, rows = a->of.rank ? a->of.dims[0] : 1;
    for (int d = 1; d < a->of.rank; d++)
        per_row *= a->of.dims[d];
    if (per_row == 0 || rows == 0) return false;
    hsize_t fit = BLOCK_BYTES / (per_row * a->bytes), step = fit < 1 ? 1 : fit < rows ? fit : rows;
    a->block = malloc(step * per_row * a->bytes);
    b->block = malloc(step * per_row * b->bytes);
    if (!a->block || !b->block) {
        q->a.status = hf_error(q->a.messages, HF_NO_MEMORY, "%s: out of memory", q->a.path);
        return false;
    }
    for (hsize_t row = 0; row < rows; row += step) {
        hsize_t n = rows - row < step ? rows - row : step, i = 0;
        hid_t in_a = read_rows(&q->a, name, a, row, n), in_b = read_rows(&q->b, name, b, row, n);
        bool ok = q->a.status == HF_OK && q->b.status == HF_OK;
        while (ok && i < n * per_row && are_equal(q, a, b, a->block + i * a->bytes, b->block + i * b->bytes))
            i++;
        bool differs = ok && i < n * per_row;
        if (differs) tell_value(q, name, a, b, row, i);
        if (in_a >= 0 && is_text(a) && ok) H5Dvlen_reclaim(a->type, in_a, H5P_DEFAULT, a->block);
        if (in_b >= 0 && is_text(b) && ok) H5Dvlen_reclaim(b->type, in_b, H5P_DEFAULT, b->block);
        hf_hdf5_close(&q->a, in_a);
        hf_hdf5_close(&q->b, in_b);
        if (differs || !ok) return differs;
    }
    return false;
}

static bool compare_data_set(comparing *q, const char *name)
{
    side a, b;
    bool differs = false;
    open_side(&q->a, name, &a);
    open_side(&q->b, name, &b);
    if (q->a.status == HF_OK && q->b.status == HF_OK) {
        differs = true;
        if (H5Tget_class(a.type) != H5Tget_class(b.type) || is_text(&a) != is_text(&b))
            q->tell(q->context, name, " is of another type");
        else if (a.of.rank != b.of.rank || memcmp(a.of.dims, b.of.dims, (size_t)a.of.rank * sizeof a.of.dims[0]) != 0)
            q->tell(q->context, name, " has other dimensions");
        else if (a.bytes != b.bytes)
            q->tell(q->context, name, " has values of another length");
        else
            differs = compare_values(q, name, &a, &b);
    }
    close_side(&q->a, &a);
    close_side(&q->b, &b);
    return differs;
}

/* ---- both files ---- */

static bool has_data_set(hf_hdf5 *io, const char *path)
{
    char name[HF_HDF5_NAME_SIZE];
    return hf_hdf5_has(io, io->file, path) &&
           hf_hdf5_is(io, io->file, hf_hdf5_name(io, io->file, path, name), H5I_DATASET);
}

static void tell_absent(comparing *q, const char *path, const hf_hdf5 *io)
{
    char how[600];
    snprintf(how, sizeof how, " is not in %s", io->path);
    q->tell(q->context, path, how);
    q->c->n_different++;
}

/* Returns true for the data sets of /VTKHDF of two results. They follow from the other groups, and earlier versions did
 * not write them. */
static bool is_second(const comparing *q, const char *path)
{
    return q->are_results && !strncmp(path, "/VTKHDF/", 8);
}

/* Returns true for the figures of both feeds of a surface, which earlier versions did not compute. They count only
 * where both files have them. */
static bool is_later(const comparing *q, const char *path)
{
    const char *name = strrchr(path, '/');
    return q->are_results && strstr(path, "/surface") && name &&
           (!strncmp(name, "/refocused_", 11) || !strncmp(name, "/fixed_", 7) || !strcmp(name, "/pointing_deg"));
}

/* Notes the name of a data set in the second file if that has names of version 0.2. */
static void note_found(comparing *q, const char *path)
{
    char name[HF_HDF5_NAME_SIZE];
    if (!q->second->alias || q->first->alias) return;
    char **more = realloc(q->found, ((size_t)q->n_found + 1) * sizeof *more);
    if (more) q->found = more;
    if (!more || !(q->found[q->n_found] = strdup(hf_hdf5_name(q->second, q->second->file, path, name))))
        hf_hdf5_no_memory(q->second);
    else
        q->n_found++;
}

static void visit_first(void *context, const char *path, hid_t object, H5I_type_t type)
{
    comparing *q = context;
    (void)object;
    if (type != H5I_DATASET || is_second(q, path)) return;
    bool is_there = has_data_set(q->second, path);
    if (!is_there && is_later(q, path)) return;
    q->c->n_data_set++;
    if (is_there) {
        note_found(q, path);
        q->c->n_different += compare_data_set(q, path);
    } else if (q->second->status == HF_OK) {
        tell_absent(q, path, q->second);
    }
    if (q->first->status == HF_OK) q->first->status = q->second->status; /* a failure there ends this walk */
}

static void visit_second(void *context, const char *path, hid_t object, H5I_type_t type)
{
    comparing *q = context;
    (void)object;
    if (type != H5I_DATASET || is_second(q, path)) return;
    if (hf_text_index(path, (const char *const *)q->found, q->n_found) >= 0) return;
    bool is_old = q->second->alias && !q->first->alias; /* `first` has links of these names */
    if ((!is_old && has_data_set(q->first, path)) || is_later(q, path)) return;
    q->c->n_data_set++;
    tell_absent(q, path, q->first);
    if (q->second->status == HF_OK) q->second->status = q->first->status;
}

hf_status hf_compare_files(const char *a, const char *b, hf_comparison *comparison, hf_compare_tell *tell,
                           void *context, hf_messages *messages)
{
    comparing q = {{.path = a, .messages = messages, .status = HF_OK, .file = -1},
                   {.path = b, .messages = messages, .status = HF_OK, .file = -1},
                   comparison,
                   tell,
                   context,
                   .first = &q.a,
                   .second = &q.b};
    comparison->n_data_set = comparison->n_different = 0;
    hf_hdf5_lock();
    hf_hdf5_open_file(&q.a, a);
    if (q.a.status == HF_OK) hf_hdf5_open_file(&q.b, b);
    hf_renamed_note(&q.a);
    hf_renamed_note(&q.b);
    if (q.a.alias && !q.b.alias) {
        q.first = &q.b;
        q.second = &q.a;
    }
    q.are_results = hf_hdf5_has(&q.a, q.a.file, "/scene") && hf_hdf5_has(&q.b, q.b.file, "/scene");
    if (q.b.status == HF_OK) hf_hdf5_walk(q.first, visit_first, &q);
    if (q.a.status == HF_OK) hf_hdf5_walk(q.second, visit_second, &q);
    for (int i = 0; i < q.n_found; i++)
        free(q.found[i]);
    free(q.found);
    hf_status status = q.a.status != HF_OK ? q.a.status : q.b.status;
    if (status == HF_OK && comparison->n_different) status = HF_DIFFERENT;
    hf_hdf5_close_file(&q.a);
    hf_hdf5_close_file(&q.b);
    return hf_hdf5_unlock(status);
}
