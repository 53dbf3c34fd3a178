/* Writes and reads the group /front, and the point that a run has taken from another front. In memory a front is an
 * array of points; in the file each member of the points is a data set. The struct rows has these data sets as
 * arrays. */
#include "store/layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define POINTS_MAX 100000 /* maximum number of points in a file, that of optimize.population */
#define VARIABLES_MAX 10000000

static const hf_hdf5_kind kind_of_mark = {HF_HDF5_ENUM, HF_FRONT_N_MARK, hf_front_mark_word, NULL};

/* The data sets with one row per point. */
enum { OBJECTIVE, MULTIPLIER, STATUS, MARK, ITERATIONS, CONVERGED, N_COLUMN };
static hf_hdf5_array column(int i, int n_point, int n_objective)
{
    const hsize_t n = (hsize_t)n_point, k = (hsize_t)n_objective;
    const hf_hdf5_array all[N_COLUMN] = {
        {"objective", HF_KIND_REAL, 2, {n, k}, "", "of each point, each in its own unit; NaN of one that failed"},
        {"multiplier",
         HF_KIND_REAL,
         2,
         {n, k},
         "",
         "what the minimised objective gains for one unit more of each other; NaN where it is not known"},
        {"status", HF_KIND_STATUS, 1, {n}, "", "of each design"},
        {"mark", &kind_of_mark, 1, {n}, "", "is it on the front, dominated by another point, or failed?"},
        {"iterations", HF_KIND_INT, 1, {n}, "", "of Levenberg-Marquardt"},
        {"converged", HF_KIND_FLAG, 1, {n}, "", "is it an optimum of Levenberg-Marquardt, as far as steps show?"},
    };
    return all[i];
}

static hf_hdf5_array names(int n)
{
    return (hf_hdf5_array){"name", HF_KIND_CHARS, 1, {(hsize_t)n, HF_OBJECTIVE_NAME_SIZE}, "", "number, goal and set"};
}

static hf_hdf5_array base_of(int n)
{
    return (hf_hdf5_array){"base", HF_KIND_REAL, 1, {(hsize_t)n}, "", "objectives of the shape after form-finding"};
}

/* The members of all points as arrays, for the file. */
typedef struct {
    double *objective, *multiplier; /* [n][n_objective] */
    signed char *status, *mark;     /* [n] */
    bool *converged;                /* [n] */
    int *iterations;                /* [n] */
} rows;

static bool make_rows(rows *r, int n, int n_objective)
{
    size_t size = (size_t)n * (size_t)n_objective;
    r->objective = malloc(size * sizeof(double));
    r->multiplier = malloc(size * sizeof(double));
    r->status = malloc((size_t)n);
    r->mark = malloc((size_t)n);
    r->iterations = malloc((size_t)n * sizeof(int));
    r->converged = malloc((size_t)n * sizeof(bool));
    return r->objective && r->multiplier && r->status && r->mark && r->iterations && r->converged;
}

static void free_rows(rows *r)
{
    free(r->objective);
    free(r->multiplier);
    free(r->status);
    free(r->mark);
    free(r->iterations);
    free(r->converged);
}

/* pack copies points into rows, and unpack copies rows into points. */
static void pack(rows *r, int n, int n_objective, const hf_front_point *point)
{
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n_objective; k++) {
            r->objective[i * n_objective + k] = point[i].objective[k];
            r->multiplier[i * n_objective + k] = point[i].multiplier[k];
        }
        r->status[i] = (signed char)point[i].status;
        r->mark[i] = (signed char)point[i].mark;
        r->iterations[i] = point[i].iterations;
        r->converged[i] = point[i].is_converged;
    }
}

static void unpack(const rows *r, int n, int n_objective, hf_front_point *point)
{
    for (int i = 0; i < n; i++) {
        point[i] = (hf_front_point){.objective = {NAN, NAN, NAN},
                                    .multiplier = {NAN, NAN, NAN},
                                    .status = (hf_status)r->status[i],
                                    .mark = (hf_front_mark)r->mark[i],
                                    .iterations = r->iterations[i],
                                    .is_converged = r->converged[i]};
        for (int k = 0; k < n_objective; k++) {
            point[i].objective[k] = r->objective[i * n_objective + k];
            point[i].multiplier[k] = r->multiplier[i * n_objective + k];
        }
    }
}

static void *value_of(const rows *r, int i)
{
    void *const value[N_COLUMN] = {r->objective, r->multiplier, r->status, r->mark, r->iterations, r->converged};
    return value[i];
}

/* ---- writing ---- */

static void write_variables(hf_hdf5 *io, hid_t group, const hf_scene *scene, const hf_model *m)
{
    size_t n = (size_t)m->n_variable;
    char *text = malloc(n * HF_VARIABLE_NAME_SIZE);
    const char **name = malloc(n * sizeof *name);
    if (!text || !name) hf_hdf5_no_memory(io);
    for (size_t k = 0; text && name && k < n; k++) {
        name[k] = text + k * HF_VARIABLE_NAME_SIZE;
        hf_model_variable_name(m, scene, (int)k, text + k * HF_VARIABLE_NAME_SIZE, HF_VARIABLE_NAME_SIZE);
    }
    if (text && name) hf_hdf5_write_ids(io, group, "gene", name, m->n_variable, "name of each gene of a design");
    free(name);
    free(text);
}

static void put_attributes(hf_hdf5 *io, hid_t group, const hf_front *front, const hf_front_table *t)
{
    hf_hdf5_put(io, group, ".", "n_on", HF_KIND_INT, 0, &t->n_on);
    hf_hdf5_put(io, group, ".", "n_dominated", HF_KIND_INT, 0, &t->n_dominated);
    hf_hdf5_put(io, group, ".", "n_failed", HF_KIND_INT, 0, &t->n_failed);
    hf_hdf5_put(io, group, ".", "minimised", HF_KIND_INT, 0, &t->minimised);
    hf_hdf5_put(io, group, ".", "knee", HF_KIND_INT, 0, &front->knee);
    hf_hdf5_put(io, group, ".", "wall_s", HF_KIND_REAL, 0, &t->wall_s);
}

void hf_layout_write_front(hf_hdf5 *io, const hf_scene *scene, const hf_model *m, const hf_summary *s,
                           const hf_front *front)
{
    rows r;
    int n = front->n_point, k = front->n_objective;
    const hsize_t dims[2] = {(hsize_t)n, (hsize_t)front->n_variable};
    const hf_hdf5_array name = names(k), base = base_of(k),
                        design = hf_layout_of_variables("design_N", m->variable, 2, dims);
    bool is_made = make_rows(&r, n, k);
    hf_layout_renew(io, "/front");
    hid_t group = hf_hdf5_make_group(io, "/front");
    if (!is_made) hf_hdf5_no_memory(io);
    if (is_made) pack(&r, n, k, front->point);
    hf_hdf5_write_array(io, group, &name, s->objectives.name);
    hf_hdf5_write_array(io, group, &base, front->base);
    for (int i = 0; i < N_COLUMN; i++) {
        const hf_hdf5_array array = column(i, n, k);
        hf_hdf5_write_array(io, group, &array, value_of(&r, i));
    }
    hf_hdf5_write_array(io, group, &design, front->design);
    write_variables(io, group, scene, m);
    put_attributes(io, group, front, &s->front);
    hf_hdf5_close(io, group);
    free_rows(&r);
}

/* ---- reading ---- */

static void read_points(hf_hdf5 *io, hid_t group, int n, int n_objective, hf_front_point *point)
{
    rows r;
    bool is_made = make_rows(&r, n, n_objective);
    if (!is_made) hf_hdf5_no_memory(io);
    for (int i = 0; i < N_COLUMN && is_made; i++) {
        const hf_hdf5_array array = column(i, n, n_objective);
        hf_hdf5_read_rows(io, group, &array, 0, value_of(&r, i));
    }
    if (io->status == HF_OK) unpack(&r, n, n_objective, point);
    free_rows(&r);
}

static bool is_index(int value, int n)
{
    return value >= -1 && value < n;
}

/* Reads a front of n_variable design variables without its designs. The caller frees it. */
static void read_front(hf_hdf5 *io, hid_t group, int n_variable, hf_front *front)
{
    int n_objective = hf_hdf5_length(io, group, "base", HF_FRONT_OBJECTIVES_MAX);
    int n_point = hf_hdf5_length(io, group, "status", POINTS_MAX);
    const hf_hdf5_array base = base_of(n_objective);
    if (io->status == HF_OK && hf_front_create(n_objective, n_variable, n_point, front) != HF_OK) hf_hdf5_no_memory(io);
    hf_hdf5_get(io, group, ".", "minimised", HF_KIND_INT, &front->minimised, 0);
    hf_hdf5_get(io, group, ".", "knee", HF_KIND_INT, &front->knee, 0);
    hf_hdf5_read_array(io, group, &base, front->base);
    if (io->status == HF_OK) read_points(io, group, n_point, n_objective, front->point);
    if (io->status == HF_OK && (!is_index(front->minimised, n_objective) || !is_index(front->knee, n_point)))
        hf_hdf5_damaged(io, group, ".", "has a knee or a minimised objective that is not there");
}

void hf_layout_get_front(hf_hdf5 *io, hf_summary *s)
{
    hf_front front = {.minimised = -1, .knee = -1};
    s->has_front = io->status == HF_OK && hf_hdf5_has(io, io->file, "/front");
    if (!s->has_front) return;
    hid_t group = hf_hdf5_open_group(io, "/front");
    read_front(io, group, 0, &front);
    hf_hdf5_get(io, group, ".", "wall_s", HF_KIND_REAL, &s->front.wall_s, 0);
    if (io->status == HF_OK) hf_front_tabulate(&front, &s->front);
    if (io->status == HF_OK && s->objectives.n != front.n_objective)
        hf_hdf5_damaged(io, group, "base", "has not as many objectives as /goals");
    hf_hdf5_close(io, group);
    hf_front_free(&front);
}

/* Reads the names of n design variables, each of *size bytes. They are printed, so each one ends with a NUL. */
static char *read_variables(hf_hdf5 *io, hid_t group, int n, size_t *size)
{
    size_t length = hf_hdf5_chars_length(io, group, "gene");
    char *stored = malloc((size_t)n * length + 1), *variable = calloc((size_t)n, length + 1);
    const hf_hdf5_array array = {"gene", HF_KIND_CHARS, 1, {(hsize_t)n, length}, "", ""};
    if (!stored || !variable) hf_hdf5_no_memory(io);
    if (stored && variable) hf_hdf5_read_array(io, group, &array, stored);
    for (size_t k = 0; io->status == HF_OK && k < (size_t)n; k++)
        memcpy(variable + k * (length + 1), stored + k * length, length);
    free(stored);
    *size = length + 1;
    return variable;
}

void hf_layout_read_front(hf_hdf5 *io, bool has_rows, hf_front *front, char **variable, size_t *variable_size)
{
    hid_t group = hf_hdf5_open_group(io, "/front");
    int n_variable = hf_hdf5_length(io, group, "gene", VARIABLES_MAX);
    read_front(io, group, n_variable, front);
    const hsize_t dims[2] = {(hsize_t)front->n_point, (hsize_t)n_variable};
    const hf_hdf5_array design = hf_layout_of_variables("design_N", has_rows, 2, dims);
    if (io->status == HF_OK) hf_hdf5_read_array(io, group, &design, front->design);
    if (io->status == HF_OK) *variable = read_variables(io, group, n_variable, variable_size);
    hf_hdf5_close(io, group);
}

/* ---- a point that was taken ---- */

void hf_layout_put_taken(hf_hdf5 *io, const hf_front_origin *taken)
{
    hf_hdf5_put(io, io->file, "/case", "front_point", HF_KIND_INT, 0, &taken->point);
    hf_hdf5_put_chars(io, io->file, "/case", "front_file", taken->path);
    hf_hdf5_put_chars(io, io->file, "/case", "front_design_sha256", taken->sha256);
}

void hf_layout_get_taken(hf_hdf5 *io, hf_front_origin *taken)
{
    if (io->status != HF_OK || !hf_hdf5_has_chars(io, io->file, "/case", "front_file")) return;
    hf_hdf5_get(io, io->file, "/case", "front_point", HF_KIND_INT, &taken->point, sizeof taken->point);
    hf_hdf5_get(io, io->file, "/case", "front_file", HF_KIND_CHARS, taken->path, sizeof taken->path);
    hf_hdf5_get(io, io->file, "/case", "front_design_sha256", HF_KIND_CHARS, taken->sha256, sizeof taken->sha256);
    if (io->status == HF_OK && taken->point < 1)
        hf_hdf5_damaged(io, io->file, "/case", "has taken a point that no front has");
}
