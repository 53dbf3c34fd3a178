/* Implements store_tolerance.h. The samples are read and written block by block. The shares and deviations come from
 * the covariance, to first order. */
#include "store/store_tolerance.h"

#include "base/arena.h"
#include "store/store_internal.h"

#include <math.h>
#include <stdio.h>

#define BLOCK 4096 /* samples that are read and written at a time */

typedef struct {
    hf_hdf5_array array;
    int column; /* index into a row */
    /* If `loaded` is not NULL, the column is an error of a load case, which is drawn anew. */
    const hf_built_loaded *loaded;
    hf_load_error kind;
} sample_column;

static int list_columns(const hf_montecarlo *t, sample_column of[HF_TOLERANCE_COLUMNS])
{
    int n = 0;
    of[n++] = (sample_column){{"status", HF_KIND_INT, 1, {0}, "", "0: has a shape; else a status of the program"},
                              .column = HF_TOLERANCE_STATUS};
    of[n++] = (sample_column){{"first_order_psi_m", HF_KIND_REAL, 1, {0}, "m", "psi of the same errors to first order"},
                              .column = HF_TOLERANCE_LINEAR_PSI};
    for (int k = 0; k < HF_TOLERANCE_N_MEASURE; k++) {
        const char *name = hf_tolerance_measure_word[k], *units = hf_tolerance_measure_unit[k];
        const hf_hdf5_array array = {name, HF_KIND_REAL, 1, {0}, units, hf_tolerance_measure_help[k]};
        if (hf_montecarlo_measures(t->surface, t->facets, (hf_tolerance_measure)k))
            of[n++] = (sample_column){.array = array, .column = HF_TOLERANCE_FIRST + k};
    }
    return n;
}

/* Writes the columns of all samples into a new group. */
static hf_status write_columns(hf_hdf5 *io, const hf_montecarlo *t, const char *path, int n_column,
                               sample_column *column, const hf_statistics_rows *rows)
{
    double *row, *value;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(row, BLOCK * (size_t)rows->n_value), HF_ARRAY(value, BLOCK)));
    const hsize_t chunk[1] = {rows->n < BLOCK ? (hsize_t)rows->n : BLOCK};
    hid_t group = hf_hdf5_make_group(io, path);
    for (int k = 0; k < n_column; k++)
        hf_hdf5_close(io, hf_hdf5_make_array(io, group, &column[k].array, chunk, false));
    hf_status status = io->status;
    for (long first = 0; first < rows->n && status == HF_OK; first += BLOCK) {
        int n = rows->n - first < BLOCK ? (int)(rows->n - first) : BLOCK;
        status = rows->read(rows->context, first, n, row);
        for (int k = 0; k < n_column && status == HF_OK; k++) {
            const sample_column *c = &column[k];
            for (int i = 0; i < n; i++)
                value[i] = c->loaded ? hf_built_loaded_error(c->loaded, &t->errors, first + i, c->kind)
                                     : row[i * rows->n_value + c->column];
            column[k].array.dims[0] = (hsize_t)n;
            column[k].array.kind = HF_KIND_REAL; /* HDF5 converts integers */
            hf_hdf5_write_rows(io, group, &column[k].array, (hsize_t)first, value);
            status = io->status;
        }
    }
    hf_hdf5_close(io, group);
    hf_arena_free_block(block);
    return status;
}

static hf_status write_samples(hf_hdf5 *io, const hf_montecarlo *t, const hf_statistics_rows *rows)
{
    sample_column column[HF_TOLERANCE_COLUMNS];
    int n_column = list_columns(t, column);
    return write_columns(io, t, "/tolerance/sample", n_column, column, rows);
}

/* Lists the errors that samples have of a load case. Returns their number. */
static int list_load_errors(const hf_montecarlo *t, int state, sample_column of[HF_LOAD_ERROR_N])
{
#define ARRAY(name, word, units, description) {word, HF_KIND_REAL, 1, {0}, units, description},
    static const hf_hdf5_array array[HF_LOAD_ERROR_N] = {HF_LOAD_ERRORS(ARRAY)};
#undef ARRAY
    int n = 0;
    for (int k = 0; k < t->n_load_case; k++)
        for (int kind = 0; kind < HF_LOAD_ERROR_N && t->load_case[k].state == state; kind++) {
            const hf_built_loaded *net = &t->load_case[k].net;
            if (hf_built_loaded_errs(net, &t->errors, (hf_load_error)kind))
                of[n++] = (sample_column){.array = array[kind], .loaded = net, .kind = (hf_load_error)kind};
        }
    return n;
}

/* The columns of a load case. */
typedef struct {
    int n;
    sample_column column[2 * HF_REQUIRED_COLUMNS + HF_LOAD_ERROR_N];
    char name[2 * HF_REQUIRED_COLUMNS][HF_REQUIRED_NAME_SIZE + 8];
} required_columns;

/* Lists the values of the figures that samples need in a load case and, of tensions, the cables that have them. */
static void list_required(const hf_required *q, int state, required_columns *to)
{
    char name[HF_REQUIRED_NAME_SIZE];
    to->n = 0;
    for (int k = 0; k < 2 * q->n_column; k++) {
        const hf_required_column *of = &q->column[k / 2];
        bool is_item = k % 2;
        if (!(of->many >> state & 1u) || (is_item && of->figure != HF_REQUIRED_TENSION)) continue;
        snprintf(to->name[to->n], sizeof to->name[0], "%s%s", hf_required_column_name(of, name),
                 is_item ? "_cable" : "");
        hf_hdf5_array array = {to->name[to->n],
                               HF_KIND_REAL,
                               1,
                               {0},
                               hf_required_figure_unit[of->figure],
                               "figure of each sample in this load case"};
        if (is_item)
            array = (hf_hdf5_array){array.name, HF_KIND_INT, 1, {0}, "", "cable with this tension; -1: no shape"};
        to->column[to->n++] =
            (sample_column){.array = array, .column = (int)hf_montecarlo_value_at(q, state, is_item) + k / 2};
    }
}

/* Writes the figures that requirements bound, for each load case in which samples need them. */
static hf_status write_required(hf_hdf5 *io, const hf_montecarlo *t, const hf_statistics_rows *rows)
{
    const hf_required *q = t->required;
    char path[HF_LAYOUT_LOAD_CASE_SIZE];
    if (!q) return HF_OK;
    required_columns *c;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(c, 1)));
    hf_status status = HF_OK;
    hf_hdf5_close(io, hf_hdf5_make_group(io, "/tolerance/load_case"));
    for (int state = 0; state < q->n_state && status == HF_OK; state++) {
        list_required(q, state, c);
        c->n += list_load_errors(t, state, c->column + c->n);
        snprintf(path, sizeof path, "/tolerance/load_case/%s", hf_required_state_name(q, state));
        if (c->n > 0) status = write_columns(io, t, path, c->n, c->column, rows);
    }
    hf_arena_free_block(block);
    return status;
}

static hf_status write_first_order(hf_hdf5 *io, const hf_montecarlo *t)
{
    const hf_covariance *c = &t->covariance;
    const hf_model *m = &t->built->model;
    double *share, *deviation;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(share, m->n_cable), HF_ARRAY(deviation, m->n_node)));
    for (int e = 0; e < m->n_cable; e++)
        share[e] = c->spread_m2 > 0 ? c->cable_m2[e] / c->spread_m2 : 0;
    for (int i = 0; i < m->n_node; i++)
        deviation[i] = (double)NAN;
    for (int k = 0; k < m->n_inner_node; k++)
        deviation[m->node_of_row[m->inner_row[k]]] = c->deviation_m[k];
    hid_t group = hf_hdf5_make_group(io, "/tolerance");
    hf_hdf5_write_list(io, group, "cable_share", HF_KIND_REAL, m->n_cable, 0, "",
                       "of each cable's own errors in what they add to the mean of psi^2, to first order", share);
    hf_hdf5_write_list(io, group, "psi_by_cut", HF_KIND_REAL, m->n_cable, 0, "",
                       "d psi / d l0 of the net without errors: m of psi by m that a cable is let out", c->psi_by_cut);
    hf_hdf5_write_list(io, group, "node_deviation_m", HF_KIND_REAL, m->n_node, 0, "m",
                       "root mean square move of each inner node, to first order; NaN of others", deviation);
    hf_hdf5_close(io, group);
    hf_arena_free_block(block);
    return io->status;
}

hf_status hf_store_tolerance(hf_store *s, const hf_montecarlo *t, const hf_statistics_rows *rows, hf_messages *messages)
{
    if (!s) return HF_OK;
    hf_hdf5 *io = hf_store_enter(s, messages);
    hf_layout_renew(io, io->file, "/tolerance");
    hf_status status = write_first_order(io, t);
    if (status == HF_OK) status = write_samples(io, t, rows);
    if (status == HF_OK) status = write_required(io, t, rows);
    if (status == HF_NO_MEMORY) hf_hdf5_no_memory(io);
    if (io->status == HF_OK) io->status = status; /* rows->read has reported the reason */
    return hf_hdf5_unlock(io->status);
}
