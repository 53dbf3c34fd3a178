/* Writes and reads the group /front, and the point that a run has taken from another front. In memory a front is an
 * array of points; in the file each member of the points is a data set. */
#include "store/store_internal.h"
#include "store/store_read.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define POINTS_MAX 100000 /* maximum number of points in a file, that of optimize.population */
#define VARIABLES_MAX 10000000

static const hf_hdf5_kind kind_of_mark = {HF_HDF5_ENUM, HF_FRONT_N_MARK, hf_front_mark_word, NULL};

/* The data sets with one row per point. Those with a value per objective come first. */
#define HF_KIND_MARK (&kind_of_mark)
#define POINT(name, member, kind, description) HF_LAYOUT_MEMBER(hf_front_point, name, member, kind, "", description)
enum { N_BY_OBJECTIVE = 2, N_FIELD = 6 };
static const hf_layout_field point_field[N_FIELD] = {
    POINT("objective", objective[0], REAL, "of each point, each in its own unit; NaN of one that failed")
        POINT("multiplier", multiplier[0], REAL,
              "what the minimised objective gains for one unit more of each other; NaN where it is not known")
            POINT("status", status, STATUS, "status of each design")
                POINT("mark", mark, MARK, "is it on the front, dominated by another point, or failed?")
                    POINT("steps", steps, INT, "steps of Levenberg-Marquardt")
                        POINT("converged", is_converged, FLAG,
                              "is it an optimum of Levenberg-Marquardt, as far as steps show?")};

/* Data sets of the verdicts, in files of runs whose rows of `requirements` were judged. */
static const hf_layout_field judgement_field[] = {
    POINT("requirements", judgement.n_required, INT, "number of rows that were judged")
        POINT("requirements_failed", judgement.n_failed, INT, "number of them that fail")
            POINT("requirements_undecided", judgement.n_undecided, INT, "number of them that are undecided")
                POINT("relative_margin_min", judgement.relative_margin_min, REAL,
                      "smallest relative margin of them; NaN: none has one")};

static void list_fields(int n_objective, hf_layout_field field[N_FIELD])
{
    memcpy(field, point_field, sizeof point_field);
    for (int i = 0; i < N_BY_OBJECTIVE; i++)
        field[i].columns = n_objective;
}

/* ---- writing ---- */

static void write_variables(hf_hdf5 *io, hid_t group, const hf_scene *scene, const hf_model *m)
{
    size_t n = (size_t)m->n_variable;
    char *text = hf_hdf5_take(io, n, HF_VARIABLE_NAME_SIZE);
    const char **name = hf_hdf5_take(io, n, sizeof *name);
    for (size_t k = 0; text && name && k < n; k++) {
        name[k] = text + k * HF_VARIABLE_NAME_SIZE;
        hf_model_variable_name(m, scene, (int)k, text + k * HF_VARIABLE_NAME_SIZE, HF_VARIABLE_NAME_SIZE);
    }
    if (text && name) hf_hdf5_write_ids(io, group, "variable", name, m->n_variable, "name of each design variable");
    free(name);
    free(text);
}

hf_status hf_store_front(hf_store *store, const hf_scene *scene, const hf_model *m, const hf_summary *s,
                         const hf_front *front, hf_messages *messages)
{
    if (!store) return HF_OK;
    hf_hdf5 *io = hf_store_enter(store, messages);
    hf_layout_field field[N_FIELD];
    int n = front->n_point, k = front->n_objective;
    const hsize_t dims[2] = {(hsize_t)n, (hsize_t)front->n_variable};
    const hf_hdf5_array name = {"name", HF_KIND_CHARS,           1, {(hsize_t)k, HF_OBJECTIVE_NAME_SIZE},
                                "",     "number, figure and set"};
    const hf_hdf5_array design = hf_layout_of_variables("design", m->variable, 2, dims);
    list_fields(k, field);
    hf_layout_renew(io, io->file, "/front");
    hid_t group = hf_hdf5_make_group(io, "/front");
    hf_hdf5_write_array(io, group, &name, s->objectives.name);
    hf_hdf5_write_list(io, group, "initial", HF_KIND_REAL, k, 0, "", "objectives of the initial design",
                       front->initial);
    hf_layout_pass_fields(io, true, group, field, N_FIELD, n, 0, front->point);
    if (hf_front_is_judged(s->front))
        hf_layout_pass_fields(io, true, group, HF_LAYOUT_TABLE(judgement_field), n, 0, front->point);
    hf_hdf5_write_array(io, group, &design, front->design);
    write_variables(io, group, scene, m);
    hf_hdf5_put(io, group, ".", "n_on", HF_KIND_INT, 0, &s->front->n_on);
    hf_hdf5_put(io, group, ".", "n_dominated", HF_KIND_INT, 0, &s->front->n_dominated);
    hf_hdf5_put(io, group, ".", "n_failed", HF_KIND_INT, 0, &s->front->n_failed);
    hf_hdf5_put(io, group, ".", "minimised", HF_KIND_INT, 0, &s->front->minimised);
    hf_hdf5_put(io, group, ".", "knee", HF_KIND_INT, 0, &front->knee);
    hf_hdf5_put(io, group, ".", "wall_s", HF_KIND_REAL, 0, &s->front->wall_s);
    hf_hdf5_close(io, group);
    return hf_hdf5_unlock(io->status);
}

/* ---- reading ---- */

static bool is_index(int value, int n)
{
    return value >= -1 && value < n;
}

/* Reads a front of n_variable design variables without its designs. The caller frees it. */
static void read_front(hf_hdf5 *io, hid_t group, int n_variable, hf_front *front)
{
    hf_layout_field field[N_FIELD];
    int n_objective = hf_hdf5_length(io, group, "initial", HF_FRONT_OBJECTIVES_MAX);
    int n_point = hf_hdf5_length(io, group, "status", POINTS_MAX);
    if (io->status == HF_OK && hf_front_create(n_objective, n_variable, n_point, front) != HF_OK) hf_hdf5_no_memory(io);
    hf_hdf5_get(io, group, ".", "minimised", HF_KIND_INT, &front->minimised, 0);
    hf_hdf5_get(io, group, ".", "knee", HF_KIND_INT, &front->knee, 0);
    hf_hdf5_read_list(io, group, "initial", HF_KIND_REAL, n_objective, 0, front->initial);
    list_fields(n_objective, field);
    for (int i = 0; i < n_point && io->status == HF_OK; i++)
        front->point[i] = (hf_front_point){.objective = {NAN, NAN, NAN}, .multiplier = {NAN, NAN, NAN}};
    hf_layout_pass_fields(io, false, group, field, N_FIELD, n_point, 0, front->point);
    if (hf_hdf5_has(io, group, "requirements"))
        hf_layout_pass_fields(io, false, group, HF_LAYOUT_TABLE(judgement_field), n_point, 0, front->point);
    if (io->status == HF_OK && (!is_index(front->minimised, n_objective) || !is_index(front->knee, n_point)))
        hf_hdf5_damaged(io, group, ".", "has a knee or a minimised objective that is not there");
}

void hf_layout_get_front(hf_hdf5 *io, hf_summary *s)
{
    hf_front front = {.minimised = -1, .knee = -1};
    if (!hf_hdf5_has(io, io->file, "/front")) return;
    if (!(s->front = hf_hdf5_take(io, 1, sizeof *s->front))) return;
    hid_t group = hf_hdf5_open_group(io, "/front");
    read_front(io, group, 0, &front);
    hf_hdf5_get(io, group, ".", "wall_s", HF_KIND_REAL, &s->front->wall_s, 0);
    if (io->status == HF_OK) hf_front_tabulate(&front, s->front);
    if (io->status == HF_OK && s->objectives.n != front.n_objective)
        hf_hdf5_damaged(io, group, "initial", "has not as many objectives as /objective");
    hf_hdf5_close(io, group);
    hf_front_free(&front);
}

/* Reads the front with its designs from the open group. */
static void read_designs(hf_hdf5 *io, hid_t group, int n_variable, hf_front *front)
{
    read_front(io, group, n_variable, front);
    hf_hdf5_read_list(io, group, "design", HF_KIND_REAL, front->n_point, n_variable, front->design);
}

hf_status hf_store_restore_front(hf_store *store, int n_variable, hf_front *front, double *wall_s,
                                 hf_messages *messages)
{
    *front = (hf_front){.minimised = -1, .knee = -1};
    if (!store) return HF_OK;
    hf_hdf5 *io = hf_store_enter(store, messages);
    if (!hf_hdf5_has(io, io->file, "/front")) return hf_hdf5_unlock(io->status);
    hid_t group = hf_hdf5_open_group(io, "/front");
    read_designs(io, group, n_variable, front);
    hf_hdf5_get(io, group, ".", "wall_s", HF_KIND_REAL, wall_s, 0);
    hf_hdf5_close(io, group);
    if (io->status != HF_OK) hf_front_free(front);
    return hf_hdf5_unlock(io->status);
}

hf_status hf_store_read_front(const char *path, hf_front *front, char **variable, size_t *variable_size,
                              hf_messages *messages)
{
    *front = (hf_front){.minimised = -1, .knee = -1};
    *variable = NULL;
    hf_hdf5 io = hf_store_open_result(path, messages);
    if (io.status == HF_OK && !hf_hdf5_has(&io, io.file, "/front"))
        io.status = hf_error(messages, HF_IO,
                             "%s: this run has no Pareto front, because the case has no list optimize.front", path);
    hid_t group = hf_hdf5_open_group(&io, "/front");
    int n_variable = hf_hdf5_length(&io, group, "variable", VARIABLES_MAX);
    read_designs(&io, group, n_variable, front);
    if (io.status == HF_OK) *variable = hf_hdf5_read_strings(&io, group, "variable", n_variable, variable_size);
    hf_hdf5_close(&io, group);
    if (hf_store_close_result(&io) != HF_OK) {
        hf_front_free(front);
        free(*variable);
        *variable = NULL;
    }
    return io.status;
}

/* ---- a point that was taken ---- */

void hf_layout_pass_taken(hf_hdf5 *io, bool writes, const hf_front_origin *taken)
{
    static const hf_result_field field[] = {HF_LAYOUT_NAMED(hf_front_origin, "front_point", point, INT) HF_LAYOUT_NAMED(
        hf_front_origin, "front_file", path, CHARS)
                                                HF_LAYOUT_NAMED(hf_front_origin, "front_design_sha256", sha256, CHARS)};
    if (writes ? !taken->point : !hf_hdf5_has_chars(io, io->file, "/case", "front_file")) return;
    hf_layout_pass_members(io, writes, "/case", field, HF_HDF5_COUNT(field), (void *)taken);
    if (io->status == HF_OK && taken->point < 1)
        hf_hdf5_damaged(io, io->file, "/case", "has taken a point that no front has");
}
