/* Implements the C interface for other languages: one opaque handle, plain arrays, numbers and words (flat.h).
 *
 *     open: case or arrays of a net -> model
 *     form: shape of the case -> initial design and batch, once
 *     evaluate, shape, slopes: designs -> figures, shape, derivatives
 *     residuals, vjp: design -> residuals, derivatives, products
 *     run: the whole run, with its own problem -> result file and summary
 *     text, ints, reals: read what these calls left in the handle */
#include <hifdm/flat.h>

#include "net/variables.h"
#include "run/diagnose.h"
#include "run/problem_parts.h"
#include "store/store_internal.h"
#include <hifdm/run.h>
#include <hifdm/store.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Does what HF_TRY does, for functions that return a status as int. */
#define TRY(expression)                                                                                                \
    do {                                                                                                               \
        hf_status status_ = (expression);                                                                              \
        if (status_ != HF_OK) return (int)status_;                                                                     \
    } while (0)

struct hf_flat {
    hf_messages messages;
    const char *path;
    const char *const *set;
    int n_set, n_thread;
    hf_scene_arrays net;
    hf_problem_source source; /* text is NULL for a case file */
    hf_problem problem;
    bool is_open, is_ready; /* there is a model; there is a batch */
    double *shape;          /* [3 n_node + 3 n_cable] of the last form or shape call (shape_part); NULL before */
    hf_form_result result;  /* result of the same call */
    int n_room;
    hf_form_result *room; /* [n_room] results of designs */
    char text[HF_VARIABLE_NAME_SIZE];
    hf_summary summary;
    char *summary_text;
    volatile sig_atomic_t stop;
};

int hf_flat_interface(void)
{
    return HF_FLAT_INTERFACE;
}

const char *hf_flat_version(void)
{
    return hf_store_version();
}

/* ---- words ---- */

/* Returns word i of a list of n words, or NULL. */
static const char *word_at(const char *const *word, int n, int i)
{
    return i >= 0 && i < n ? word[i] : NULL;
}

#define CODE_MAX 127 /* of a list of words */

static const char *known(const char *word)
{
    return strcmp(word, "unknown") ? word : NULL;
}

const char *hf_flat_word(const char *list, int code)
{
    if (!strcmp(list, "role")) return word_at(hf_role_word, 3, code);
    if (!strcmp(list, "group")) return word_at(hf_group_word, 2, code);
    if (!strcmp(list, "law")) return word_at(hf_law_word, HF_N_LAW, code);
    if (!strcmp(list, "phase")) return word_at(hf_run_phase_word, 4, code);
    if (!strcmp(list, "status")) return known(hf_status_word((hf_status)code));
    if (!strcmp(list, "stop_reason")) return known(hf_stop_reason_word(code));
    if (!strcmp(list, "bound_reason")) return known(hf_bound_reason_word(code));
    if (!strcmp(list, "coupling_stop")) return known(hf_coupling_stop_word(code));
    return NULL;
}

int hf_flat_code(const char *list, const char *word)
{
    for (int code = 0; code <= CODE_MAX; code++) { /* those of statuses have gaps */
        const char *at = hf_flat_word(list, code);
        if (at && !strcmp(at, word)) return code;
    }
    return -1;
}

/* ---- a case ---- */

hf_flat *hf_flat_create(void)
{
    return calloc(1, sizeof(hf_flat));
}

void hf_flat_free(hf_flat *f)
{
    if (!f) return;
    hf_problem_free(&f->problem);
    hf_summary_free(&f->summary);
    hf_messages_free(&f->messages);
    free(f->shape);
    free(f->room);
    free(f->summary_text);
    free(f);
}

const char *hf_flat_messages(const hf_flat *f)
{
    return f->messages.text ? f->messages.text : "";
}

/* Clears the messages. Returns `has`; if that is false, adds the message `what`. */
static bool begins(hf_flat *f, bool has, const char *what)
{
    hf_messages_free(&f->messages);
    if (!has) hf_error(&f->messages, HF_BAD_USAGE, "%s", what);
    return has;
}

int hf_flat_open(hf_flat *f, const char *path, int n_set, const char *const *set, int n_thread)
{
    if (!begins(f, !f->path, "a handle opens one case")) return HF_BAD_USAGE;
    f->path = path;
    f->n_set = n_set;
    f->set = set;
    f->n_thread = n_thread;
    const hf_problem_source *source = f->source.text ? &f->source : NULL;
    hf_status status = hf_problem_load(path, source, set, n_set, NULL, &f->problem, &f->messages);
    f->is_open = status == HF_OK;
    return (int)status;
}

void hf_flat_nodes(hf_flat *f, int n_node, const double *position_m, const unsigned char *role, const double *load_N,
                   const char *const *node_id)
{
    f->net.n_node = n_node;
    f->net.position_m = position_m;
    f->net.role = role;
    f->net.load_N = load_N;
    f->net.node_id = node_id;
}

void hf_flat_cables(hf_flat *f, int n_cable, const int *end, const unsigned char *group, const unsigned char *law,
                    const double *value, const double *EA_N, const char *const *cable_id)
{
    f->net.n_cable = n_cable;
    f->net.end = end;
    f->net.group = group;
    f->net.law = law;
    f->net.value = value;
    f->net.EA_N = EA_N;
    f->net.cable_id = cable_id;
}

void hf_flat_sets(hf_flat *f, int n_set, const char *const *name, const int *start, const int *cable)
{
    f->net.n_set = n_set;
    f->net.set_name = name;
    f->net.set_start = start;
    f->net.set_cable = cable;
}

int hf_flat_open_net(hf_flat *f, const char *name, const char *text, int n_set, const char *const *set, int n_thread)
{
    if (!f->path) f->source = (hf_problem_source){text, &f->net};
    return hf_flat_open(f, name, n_set, set, n_thread);
}

/* ---- texts ---- */

enum { COLUMN_NAME, COLUMN_UNIT, COLUMN_HELP, COLUMN_KIND };

static const char *of_field(const hf_result_field *field, int column)
{
    static const char *const kind_word[] = {
        [HF_RESULT_REAL] = "real",
        [HF_RESULT_INT] = "int",
        [HF_RESULT_STATUS] = "status",
        [HF_RESULT_STOP_REASON] = "stop_reason",
        [HF_RESULT_COUPLING_STOP] = "coupling_stop",
        [HF_RESULT_BOUND_REASON] = "bound_reason",
    };
    if (column == COLUMN_UNIT) return field->units ? field->units : "";
    if (column == COLUMN_HELP) return field->description;
    return column == COLUMN_KIND ? kind_word[field->kind] : field->name;
}

static const char *of_objective(hf_flat *f, int i, int column)
{
    if (i >= f->problem.objectives.n_objective) return NULL;
    if (column == COLUMN_NAME) return hf_objectives_name(&f->problem.objectives, i, f->text);
    if (column == COLUMN_UNIT) return hf_figure_kind_unit[f->problem.objectives.objective[i].settings.figure];
    return column == COLUMN_KIND ? "real" : "value of the objective, without its weight";
}

/* Returns a text about figure i of a design: figures of an individual first, then objectives. NULL beyond the last. */
static const char *figure_text(hf_flat *f, int i, int column)
{
    const hf_result_field *field[HF_RESULT_N_INDIVIDUAL];
    int n = hf_problem_list_figures(&f->problem, field);
    return i < n ? of_field(field[i], column) : of_objective(f, i - n, column);
}

static int n_coupling(const hf_flat *f)
{
    return f->problem.model.n_attachment ? HF_COUPLING_N : 0;
}

/* Returns a text about figure i of a shape: all figures of a result, those of the coupling with a truss, then
 * objectives. NULL beyond the last. */
static const char *result_text(hf_flat *f, int i, int column)
{
    if (i < HF_RESULT_N) return of_field(&hf_result_field_of[i], column);
    i -= HF_RESULT_N;
    if (i >= n_coupling(f)) return of_objective(f, i - n_coupling(f), column);
    if (column != COLUMN_NAME) return of_field(&hf_coupling_field_of[i], column);
    snprintf(f->text, sizeof f->text, "coupling_%s", hf_coupling_field_of[i].name);
    return f->text;
}

static const char *variable_text(hf_flat *f, int i, int column)
{
    const hf_model *m = &f->problem.model;
    if (i >= m->n_variable) return NULL;
    if (column == COLUMN_UNIT) return hf_model_variable_unit(m, i);
    hf_model_variable_name(m, &f->problem.scene, i, f->text, sizeof f->text);
    return f->text;
}

const char *hf_flat_text(hf_flat *f, const char *list, int i)
{
    static const struct {
        const char *list;
        const char *(*text)(hf_flat *, int i, int column);
        int column;
    } made[] = {{"variable", variable_text, COLUMN_NAME},  {"variable_unit", variable_text, COLUMN_UNIT},
                {"objective", of_objective, COLUMN_NAME},  {"figure", figure_text, COLUMN_NAME},
                {"figure_unit", figure_text, COLUMN_UNIT}, {"figure_help", figure_text, COLUMN_HELP},
                {"result", result_text, COLUMN_NAME},      {"result_unit", result_text, COLUMN_UNIT},
                {"result_help", result_text, COLUMN_HELP}, {"result_kind", result_text, COLUMN_KIND}};
    const hf_problem *p = &f->problem;
    if (!strcmp(list, "summary")) return i ? NULL : f->summary_text;
    if (!f->is_open || i < 0) return NULL;
    for (size_t k = 0; k < sizeof made / sizeof *made; k++)
        if (!strcmp(list, made[k].list)) return made[k].text(f, i, made[k].column);
    if (!strcmp(list, "title")) return i ? NULL : p->settings.title;
    if (!strcmp(list, "solver")) return i || !f->is_ready ? NULL : hf_solver_word[p->solver];
    if (!strcmp(list, "node_id")) return word_at(p->scene.node_id, p->scene.n_node, i);
    if (!strcmp(list, "cable_id")) return word_at(p->scene.cable_id, p->scene.n_cable, i);
    if (!strcmp(list, "set_name")) return word_at(p->scene.set_name, p->scene.n_set, i);
    if (!strcmp(list, "block")) return hf_problem_block(p, i, f->text) < 0 ? NULL : f->text;
    if (!strcmp(list, "slope")) return i >= hf_problem_n_slope(p) ? NULL : hf_problem_slope_name(p, i, f->text);
    return NULL;
}

/* ---- numbers ---- */

static int copy_bytes(const unsigned char *from, int n, int *to)
{
    for (int i = 0; to && i < n; i++)
        to[i] = from[i];
    return n;
}

/* Copies n items of `size` bytes. Returns n, or 0 if there are none. */
static int copy(const void *from, int n, size_t size, void *to)
{
    if (!from) return 0;
    if (to && n) memcpy(to, from, (size_t)n * size);
    return n;
}

static int copy_block_rows(const hf_flat *f, int *to)
{
    char name[HF_OBJECTIVE_NAME_SIZE];
    int n = 0;
    for (int rows; (rows = hf_problem_block(&f->problem, n, name)) >= 0; n++)
        if (to) to[n] = rows;
    return n;
}

int hf_flat_ints(const hf_flat *f, const char *name, int *to)
{
    const hf_scene *s = &f->problem.scene;
    const hf_model *m = &f->problem.model;
    if (!f->is_open) return 0;
    if (!strcmp(name, "end")) return copy(s->end, 2 * s->n_cable, sizeof *to, to);
    if (!strcmp(name, "role")) return copy_bytes(s->role, s->n_node, to);
    if (!strcmp(name, "group")) return copy_bytes(s->group, s->n_cable, to);
    if (!strcmp(name, "law")) return copy_bytes(s->law, s->n_cable, to);
    if (!strcmp(name, "variable_cable")) return copy(m->variable_cable, m->n_variable, sizeof *to, to);
    if (!strcmp(name, "block_rows")) return copy_block_rows(f, to);
    if (!strcmp(name, "variable_leader")) return copy(m->variable_leader, m->n_variable, sizeof *to, to);
    if (!strcmp(name, "set_start")) return copy(s->set_start, s->n_set + 1, sizeof *to, to);
    if (!strcmp(name, "set_cable")) return copy(s->set_cable, s->n_set ? s->set_start[s->n_set] : 0, sizeof *to, to);
    return -1;
}

enum { SHAPE_LENGTH, SHAPE_TENSION, SHAPE_Q };

/* Returns one of the arrays [n_cable] of the shape, which follow the positions [n_node][3]; NULL without a shape. */
static double *shape_part(const hf_flat *f, int part)
{
    const hf_scene *s = &f->problem.scene;
    return !f->shape ? NULL : f->shape + 3 * (size_t)s->n_node + (size_t)part * (size_t)s->n_cable;
}

/* Copies the shape from the workspace, because later calls overwrite that. */
static hf_status keep_shape(hf_flat *f, const hf_workspace *w)
{
    const hf_scene *s = &f->problem.scene;
    const hf_model *m = &f->problem.model;
    if (!f->shape) f->shape = malloc(3 * ((size_t)s->n_node + (size_t)s->n_cable) * sizeof *f->shape);
    if (!f->shape) return hf_error(&f->messages, HF_NO_MEMORY, "out of memory for the shape of %d nodes", s->n_node);
    hf_model_positions(m, w->position_m, f->shape);
    memcpy(shape_part(f, SHAPE_LENGTH), w->length_m, (size_t)s->n_cable * sizeof(double));
    memcpy(shape_part(f, SHAPE_TENSION), w->tension_N, (size_t)s->n_cable * sizeof(double));
    memcpy(shape_part(f, SHAPE_Q), w->q_N_per_m, (size_t)s->n_cable * sizeof(double));
    return HF_OK;
}

static double field_value(const hf_result_field *field, const void *owner)
{
    const void *value = (const char *)owner + field->offset;
    return field->kind == HF_RESULT_REAL ? *(const double *)value : *(const int *)value;
}

/* A design that breaks a limit has a shape, and with it values of the objectives. */
static double objective_value(const hf_form_result *r, int i)
{
    return hf_status_has_shape(r->status) ? r->objective[i] : (double)NAN;
}

static int copy_result(const hf_flat *f, double *to)
{
    int n = HF_RESULT_N + n_coupling(f), n_objective = f->problem.objectives.n_objective;
    for (int i = 0; to && i < n; i++)
        to[i] = i < HF_RESULT_N ? field_value(&hf_result_field_of[i], &f->result)
                                : field_value(&hf_coupling_field_of[i - HF_RESULT_N], &f->result.coupling);
    for (int i = 0; to && i < n_objective; i++)
        to[n + i] = objective_value(&f->result, i);
    return n + n_objective;
}

static int copy_bounds(const hf_flat *f, bool is_upper, double *to)
{
    const hf_problem *p = &f->problem;
    for (int k = 0; to && k < p->model.n_variable; k++) {
        double lower, upper, reach;
        hf_variables_bound(&p->settings.optimize, &p->model, k, p->initial[k], &lower, &upper, &reach);
        to[k] = is_upper ? upper : lower;
    }
    return p->model.n_variable;
}

int hf_flat_reals(const hf_flat *f, const char *name, double *to)
{
    const hf_scene *s = &f->problem.scene;
    if (!f->is_open) return 0;
    if (!strcmp(name, "target_position_m")) return copy(s->position_m, 3 * s->n_node, sizeof *to, to);
    if (!strcmp(name, "load_N")) return copy(s->load_N, 3 * s->n_node, sizeof *to, to);
    if (!strcmp(name, "target")) return copy(s->target, s->n_cable, sizeof *to, to);
    if (!strcmp(name, "EA_N")) return copy(s->EA_N, s->n_cable, sizeof *to, to);
    if (!strcmp(name, "initial"))
        return f->is_ready ? copy(f->problem.initial, f->problem.model.n_variable, sizeof *to, to) : 0;
    if (!strcmp(name, "lower")) return f->is_ready ? copy_bounds(f, false, to) : 0;
    if (!strcmp(name, "upper")) return f->is_ready ? copy_bounds(f, true, to) : 0;
    if (!strcmp(name, "position_m")) return copy(f->shape, 3 * s->n_node, sizeof *to, to);
    if (!strcmp(name, "length_m")) return copy(shape_part(f, SHAPE_LENGTH), s->n_cable, sizeof *to, to);
    if (!strcmp(name, "tension_N")) return copy(shape_part(f, SHAPE_TENSION), s->n_cable, sizeof *to, to);
    if (!strcmp(name, "q_N_per_m")) return copy(shape_part(f, SHAPE_Q), s->n_cable, sizeof *to, to);
    if (!strcmp(name, "result")) return f->shape ? copy_result(f, to) : 0;
    return -1;
}

/* ---- work ---- */

#define NEEDS_CASE "open a case first"
#define NEEDS_SHAPE "the case has no shape yet: hf_flat_form finds it"

int hf_flat_form(hf_flat *f)
{
    hf_problem *p = &f->problem;
    hf_form_result *r = &f->result;
    if (!begins(f, f->is_open, NEEDS_CASE)) return HF_BAD_USAGE;
    if (!p->workspace.block) TRY(hf_problem_allocate(p, &f->messages));
    hf_evaluate_form(&p->model, &p->settings.form, &p->workspace, NULL, &p->form);
    TRY(keep_shape(f, &p->workspace));
    *r = p->form;
    TRY(hf_problem_explain(p, &f->messages));
    if (!f->is_ready) TRY(hf_problem_prepare(p, f->n_thread, &f->messages));
    f->is_ready = true;
    if (p->objectives.n_objective &&
        hf_objectives_measure(&p->objectives, &p->workspace, &p->point, r->objective, &r->merit) != HF_OK)
        return (int)hf_error(&f->messages, HF_NO_MEMORY, "out of memory for the objectives");
    return HF_OK;
}

/* Checks that all values are finite and those of cables above zero. Returns HF_OK, or HF_BAD_CASE with a message. */
static hf_status check_designs(hf_flat *f, int n, const double *design)
{
    const hf_model *m = &f->problem.model;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < m->n_variable; k++) {
            double value = design[(size_t)i * (size_t)m->n_variable + (size_t)k];
            bool is_cable = m->variable_cable[k] >= 0;
            if (isfinite(value) && (value > 0 || !is_cable)) continue;
            return hf_error(&f->messages, HF_BAD_CASE, "design %d: %s must be %s, not %g", i,
                            variable_text(f, k, COLUMN_NAME),
                            is_cable ? "a finite number above zero" : "a finite number", value);
        }
    return HF_OK;
}

/* Evaluates n designs and leaves their results in f->room. */
static hf_status evaluate(hf_flat *f, int n, const double *design)
{
    if (!begins(f, f->is_ready, NEEDS_SHAPE)) return HF_BAD_USAGE;
    HF_TRY(check_designs(f, n, design));
    if (n > f->n_room) {
        free(f->room);
        f->room = malloc((size_t)n * sizeof *f->room);
        f->n_room = f->room ? n : 0;
        if (!f->room) return hf_error(&f->messages, HF_NO_MEMORY, "out of memory for %d designs", n);
    }
    hf_batch_run(&f->problem.batch, n, design, NULL, f->room);
    return HF_OK;
}

int hf_flat_evaluate(hf_flat *f, int n, const double *design, double *figure)
{
    const hf_result_field *field[HF_RESULT_N_INDIVIDUAL];
    int n_field = hf_problem_list_figures(&f->problem, field);
    TRY(evaluate(f, n, design));
    for (int k = 0; k < n_field; k++)
        for (int i = 0; i < n; i++)
            *figure++ = field_value(field[k], &f->room[i]);
    for (int k = 0; k < f->problem.objectives.n_objective; k++)
        for (int i = 0; i < n; i++)
            *figure++ = objective_value(&f->room[i], k);
    return HF_OK;
}

int hf_flat_shape(hf_flat *f, const double *design)
{
    if (!begins(f, f->is_ready, NEEDS_SHAPE)) return HF_BAD_USAGE;
    TRY(check_designs(f, 1, design));
    return (int)keep_shape(f, hf_batch_run_one(&f->problem.batch, design, &f->result));
}

int hf_flat_slopes(hf_flat *f, int n, const double *design, double *slope)
{
    hf_problem *p = &f->problem;
    TRY(evaluate(f, n, design));
    TRY(hf_problem_slopes(p, n, design, f->room, slope, &f->messages));
    size_t size = (size_t)hf_problem_n_slope(p) * (size_t)p->model.n_variable, n_feasible = 0;
    for (int i = 0; i < n; i++)
        n_feasible += f->room[i].status == HF_OK;
    for (int i = n - 1; i >= 0; i--) { /* slopes of feasible designs are contiguous; each moves to its design */
        double *to = slope + (size_t)i * size;
        bool is_feasible = f->room[i].status == HF_OK;
        if (is_feasible) memmove(to, slope + --n_feasible * size, size * sizeof *to);
        for (size_t k = 0; !is_feasible && k < size; k++)
            to[k] = (double)NAN;
    }
    return HF_OK;
}

int hf_flat_residuals(hf_flat *f, const double *design, int blocks, double *residual, double *jacobian)
{
    if (!begins(f, f->is_ready, NEEDS_SHAPE)) return HF_BAD_USAGE;
    TRY(check_designs(f, 1, design));
    return (int)hf_problem_residuals(&f->problem, design, (unsigned)blocks, residual, jacobian, &f->messages);
}

int hf_flat_vjp(hf_flat *f, const double *design, int blocks, const double *vector, double *product)
{
    if (!begins(f, f->is_ready, NEEDS_SHAPE)) return HF_BAD_USAGE;
    TRY(check_designs(f, 1, design));
    return (int)hf_problem_vjp(&f->problem, design, (unsigned)blocks, vector, product, &f->messages);
}

/* ---- a run ---- */

typedef struct {
    hf_flat *flat;
    hf_flat_observer *observer;
    void *context;
} watcher;

static void pass_on(void *context, const hf_run_progress *now)
{
    const watcher *w = context;
    bool is_sampling = now->phase == HF_RUN_TOLERANCE;
    bool is_refining = now->phase == HF_RUN_REFINE;
    bool is_front = now->points_all > 0;
    long done = is_sampling ? now->samples : is_front ? now->points : is_refining ? now->step : now->generation;
    long all = is_sampling   ? now->samples_all
               : is_front    ? now->points_all
               : is_refining ? now->max_steps
                             : now->generations;
    if (w->observer &&
        w->observer(w->context, (int)now->phase, done, all, now->evaluations, now->best_psi_m, now->elapsed_s))
        hf_flat_stop(w->flat);
}

/* Writes the summary as the JSON of the program into f->summary_text. Returns `status`, or HF_NO_MEMORY. */
static hf_status write_summary(hf_flat *f, hf_status status, const char *output)
{
    size_t size = 0;
    free(f->summary_text);
    f->summary_text = NULL;
    FILE *file = open_memstream(&f->summary_text, &size);
    if (!file) return hf_error(&f->messages, HF_NO_MEMORY, "out of memory for the summary");
    hf_summary_write_json(&f->summary, status, f->messages.text, *output ? output : NULL, file);
    if (fclose(file)) return hf_error(&f->messages, HF_NO_MEMORY, "out of memory for the summary");
    return status;
}

int hf_flat_run(hf_flat *f, const char *output, int restart, hf_flat_observer *observer, void *context)
{
    char written[HF_OUTPUT_SIZE];
    watcher beside = {f, observer, context};
    if (!begins(f, f->is_open, NEEDS_CASE)) return HF_BAD_USAGE;
    f->stop = 0; /* clears a stop that came at the end of an earlier run */
    hf_run_request request = {
        .input = {.case_path = f->path, .source = f->source.text ? &f->source : NULL, .set = f->set, .n_set = f->n_set},
        .output = {.path = output, .no_file = !output, .restart = restart},
        .control = {f->n_thread, &f->stop, pass_on, &beside}};
    hf_summary_free(&f->summary);
    hf_status status = hf_run_case(&request, &f->summary, written, &f->messages);
    return (int)write_summary(f, status, written);
}

void hf_flat_set_reader(const char *const *command)
{
    hf_store_set_reader(command);
}

void hf_flat_read(const char *path)
{
    hf_store_read_like_a_run(path);
}

void hf_flat_stop(hf_flat *f)
{
    f->stop = 1;
}
