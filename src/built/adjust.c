/* Chooses turnbuckle adjustments on a linear model that is renewed at each better shape:
 *
 *     estimate ---> solve the shape with the present adjustments
 *                     |
 *                     v
 *                   linearise: J = d(residuals of the figure) / d(cut lengths), J'J, J'r       <---+
 *                     |                                                                            |
 *                     v                                                                            |
 *                   choose whole steps of few turnbuckles (built/turnbuckles) within the tension limits  |
 *                     |                                                                            |
 *                     v                                                                            |
 *                   solve the adjusted shape: better? ---------------------------------------yes---+
 *                     | no
 *                     v
 *                   order the adjustments, judge each by posterior samples, find the continuous optimum
 *
 * Contents: memory, figure of a shape, linear model, choice, continuous optimum, posterior samples, order of
 * adjustments, all steps together. */
#include "built/adjust.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "linalg/band.h"
#include "linalg/dot.h"
#include "search/parallel.h"
#include <hifdm/built_batch.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDS_MAX 12  /* linear models of a choice, and of the continuous optimum */
#define PANEL 16       /* turnbuckles whose effects are computed together */
#define GRAM_ROWS 32   /* rows of the product matrix that a thread computes at a time; a multiple of 4 */
#define HALVINGS_MAX 6 /* halvings of a step towards the continuous optimum */
#define LITTLE 1e-5    /* relative reduction of the figure that such a step must reach */
#define KEPT 0.9       /* fraction of its minimum tension below which a cable invalidates the linear model */

/* ---- memory ---- */

/* Holds what one thread needs to compute the effects of cables on the figure. */
typedef struct {
    hf_objectives_point point;
    double *lanes; /* scratch for solves with the packed matrix */
    /* [PANEL][...] strains, displacements and scratch of hf_built_linear_apply. */
    double *strain_N, *answer_m, *scratch;
    /* Arguments of hf_objectives_push. The figure depends on positions alone, so the last two stay 0. */
    double *rate_m, *rate_N, *displacement_m;
    void *block;
} adjust_room;

typedef struct {
    hf_estimate *estimate;
    const hf_adjust_task *task;
    int n_room;
    adjust_room *room;      /* [n_room], one for each thread */
    hf_packed_band matrix;  /* factor of the linear model, packed for eight right-hand sides */
    size_t n, n_row, n_dof; /* numbers of turnbuckles, of residuals of the figure, of coordinates */
    hf_workspace work;      /* the shape solved last */
    hf_form_result form;
    double *adjustment_m;    /* [n_cable of the model] adjustments of that shape */
    double *doubt_m;         /* [HF_ESTIMATE_SAMPLES][n_dof] posterior displacements */
    double *doubt_N;         /* [n_cable of the model] standard deviations of the estimated tensions */
    hf_estimate_cause cause; /* posterior errors that cause doubt_m */
    /* [HF_ESTIMATE_SAMPLES][n_dof] linear displacements of the posterior samples, and the solved displacements minus
     * these after all adjustments. */
    double *answer_m, *beyond_m;
    double *residual; /* [n_row] of the shape solved last */
    /* [n][n_row] derivatives of the residuals with respect to each cut length, per metre. The rows of left_open and
     * at_zero follow in the same array. */
    double *column;
    /* [HF_ESTIMATE_SAMPLES][n_row] changes of the residuals by each posterior sample, and [n_row] residuals without
     * adjustments by the linear model. */
    double *left_open, *at_zero;
    double *product; /* products of these n + HF_ESTIMATE_SAMPLES + 1 rows with each other */
    /* [n][n] J'J; [n] J'r; [HF_ESTIMATE_SAMPLES][n] J'dr; [n] continuous adjustments, m. */
    double *gram, *slope, *sample, *continuous_m;
    int *steps, *trial; /* [n] steps of the accepted and of the tried choice */
    double *min_N;      /* [n_cable of the model] tensions that adjustments must keep */
    /* [n_cable of the model] how far each tension may fall below its value without adjustments. */
    double *room_N;
    bool is_current; /* true: the linear model belongs to the shape with `steps` */
    hf_turnbuckles_problem problem;
    void *block, *matrix_block;
} adjustment;

static size_t rows_of(const adjustment *a)
{
    return a->n + HF_ESTIMATE_SAMPLES + 1;
}

static hf_status open_room(const adjustment *a, adjust_room *r)
{
    const hf_model *m = &a->estimate->built->model;
    HF_TRY(HF_ARENA_ARRAYS(&r->block, HF_ARRAY(r->lanes, hf_packed_band_rows(&a->matrix) * HF_LANES),
                           HF_ARRAY(r->strain_N, PANEL * (size_t)m->n_cable), HF_ARRAY(r->answer_m, PANEL * a->n_dof),
                           HF_ARRAY(r->scratch, PANEL * a->estimate->linear.n_scratch), HF_ARRAY(r->rate_m, a->n_dof),
                           HF_ARRAY(r->rate_N, m->n_cable), HF_ARRAY(r->displacement_m, 3 * (size_t)m->n_attachment)));
    return hf_objectives_point_create(a->task->objectives, &r->point);
}

static hf_status allocate(adjustment *a)
{
    size_t n_cable = (size_t)a->estimate->built->model.n_cable, n_all = rows_of(a), n = a->n;
    size_t by_sample = HF_ESTIMATE_SAMPLES * a->n_dof;
    hf_arena arena = {0};
    HF_TRY(HF_ARENA_ARRAYS(
        &a->block, HF_ARRAY(a->room, a->n_room), HF_ARRAY(a->adjustment_m, n_cable), HF_ARRAY(a->doubt_m, by_sample),
        HF_ARRAY(a->doubt_N, n_cable), HF_ARRAY(a->cause.cut_m, HF_ESTIMATE_SAMPLES * n_cable),
        HF_ARRAY(a->cause.rest_m, by_sample), HF_ARRAY(a->answer_m, by_sample), HF_ARRAY(a->beyond_m, by_sample),
        HF_ARRAY(a->residual, a->n_row), HF_ARRAY(a->column, n_all * a->n_row), HF_ARRAY(a->product, n_all * n_all),
        HF_ARRAY(a->gram, n * n), HF_ARRAY(a->slope, n), HF_ARRAY(a->sample, HF_ESTIMATE_SAMPLES * n),
        HF_ARRAY(a->continuous_m, n), HF_ARRAY(a->steps, n), HF_ARRAY(a->trial, n), HF_ARRAY(a->min_N, n_cable),
        HF_ARRAY(a->room_N, n_cable)));
    HF_TRY(HF_ARENA_MAKE(&arena, hf_packed_band_lay_out(&arena, &a->matrix)));
    a->matrix_block = arena.block;
    return HF_OK;
}

/* Computes the changes of tension [n_cable], N, that the strains in the first room cause in the linear model. */
static void find_tensions(const adjustment *a, double *change_N)
{
    adjust_room *r = &a->room[0];
    memset(r->answer_m, 0, a->n_dof * sizeof *r->answer_m);
    hf_built_linear_apply(&a->estimate->linear, NULL, 1, r->strain_N, NULL, r->answer_m, r->scratch);
    hf_built_linear_tension(&a->estimate->linear, r->strain_N, r->answer_m, change_N);
}

/* Computes the changes of tension per metre of turnbuckle i, for hf_turnbuckles_choose. */
static void find_rates(void *context, int i, double *rate_N_per_m)
{
    adjustment *a = context;
    int e = a->task->cable[i];
    memset(a->room[0].strain_N, 0, (size_t)a->problem.n_tension * sizeof *a->room[0].strain_N);
    a->room[0].strain_N[e] = a->estimate->linear.cut_N_per_m[e];
    find_tensions(a, rate_N_per_m);
}

static hf_status create_adjustment(hf_estimate *p, const hf_adjust_task *task, adjustment *a)
{
    *a =
        (adjustment){.estimate = p, .task = task, .n = (size_t)task->n_cable, .n_row = (size_t)task->objectives->n_row};
    a->n_dof = p->linear.n_dof;
    a->n_room = task->n_thread > 0 ? task->n_thread : hf_parallel_cores();
    a->matrix = hf_newton_matrix_packed(&p->built->model);
    HF_TRY(allocate(a));
    a->left_open = a->column + a->n * a->n_row;
    a->at_zero = a->left_open + HF_ESTIMATE_SAMPLES * a->n_row;
    for (int i = 0; i < a->n_room; i++)
        HF_TRY(open_room(a, &a->room[i]));
    const hf_adjust_settings *s = task->settings;
    a->problem = (hf_turnbuckles_problem){.n = task->n_cable,
                                          .gram = a->gram,
                                          .slope = a->slope,
                                          .step_m = s->step_m,
                                          .steps_max = hf_adjust_steps(s),
                                          .n_max = s->max_adjustments,
                                          .target = s->target_m,
                                          .n_sample = HF_ESTIMATE_SAMPLES,
                                          .sample = a->sample,
                                          .n_tension = p->built->model.n_cable,
                                          .room_N = a->room_N,
                                          .rates = find_rates,
                                          .context = a};
    return hf_workspace_create(&p->built->model, &a->work);
}

static void free_adjustment(adjustment *a)
{
    hf_workspace_free(&a->work);
    for (int i = 0; i < a->n_room && a->room; i++) {
        hf_objectives_point_free(&a->room[i].point);
        hf_arena_free_block(a->room[i].block);
    }
    hf_arena_free_block(a->matrix_block);
    hf_arena_free_block(a->block);
}

/* ---- the figure of a shape ---- */

static hf_status measure_work(adjustment *a, double *figure_m)
{
    double merit;
    return hf_objectives_measure(a->task->objectives, &a->work, &a->room[0].point, figure_m, &merit);
}

/* Solves the net with the estimated errors and the adjustments in adjustment_m, and measures its figure. */
static hf_status solve_adjusted(adjustment *a, double *figure_m)
{
    *figure_m = (double)NAN;
    HF_TRY(hf_estimate_shape(a->estimate, a->adjustment_m, &a->work, &a->form));
    return measure_work(a, figure_m);
}

static hf_status solve_steps(adjustment *a, const int *steps, double *figure_m)
{
    for (size_t i = 0; i < a->n; i++)
        a->adjustment_m[a->task->cable[i]] = steps[i] * a->problem.step_m;
    return solve_adjusted(a, figure_m);
}

/* Sets the tension that each cable must keep, from the shape without adjustments in `work`. Counts the cables below
 * their required minimum. */
static void find_min_tensions(adjustment *a, hf_adjustment *found)
{
    const hf_built *b = a->estimate->built;
    for (int e = 0; e < b->model.n_cable; e++) {
        double min_tension_N = HF_ADJUST_TAUT * b->tension_N[e];
        if (a->task->min_N && a->work.tension_N[e] < a->task->min_N[e]) {
            found->n_low++;
            found->low_N = fmax(found->low_N, a->task->min_N[e]);
        }
        if (a->task->min_N) min_tension_N = fmax(min_tension_N, a->task->min_N[e]);
        a->min_N[e] = fmin(min_tension_N, a->work.tension_N[e]);
    }
}

static bool keeps_min_tensions(const adjustment *a)
{
    for (int e = 0; e < a->problem.n_tension; e++)
        if (a->work.tension_N[e] < KEPT * a->min_N[e]) return false;
    return true;
}

/* ---- the linear model ---- */

/* Computes the derivative of the residuals, rate [n_row], along the displacements move_m [n_dof]. */
static void push_displacement(const adjustment *a, adjust_room *r, const double *move_m, double *rate)
{
    const hf_model *m = &a->estimate->built->model;
    for (int row = 0; row < m->n_node; row++)
        for (int c = 0; c < 3; c++)
            r->rate_m[c * m->n_node + row] = move_m[3 * row + c];
    hf_objectives_rate by = {r->rate_m, r->rate_N, r->displacement_m};
    hf_objectives_push(a->task->objectives, &a->work, &r->point, &by, rate);
}

static void find_panel(void *context, int room, int i_panel)
{
    adjustment *a = context;
    adjust_room *r = &a->room[room];
    const hf_built_linear *l = &a->estimate->linear;
    size_t n_cable = (size_t)l->built->model.n_cable, first = PANEL * (size_t)i_panel;
    size_t n = a->n - first < PANEL ? a->n - first : PANEL;
    memset(r->strain_N, 0, n * n_cable * sizeof *r->strain_N);
    memset(r->answer_m, 0, n * a->n_dof * sizeof *r->answer_m);
    for (size_t k = 0; k < n; k++) {
        size_t e = (size_t)a->task->cable[first + k];
        r->strain_N[k * n_cable + e] = l->cut_N_per_m[e];
    }
    const hf_built_lanes by = {&a->matrix, r->lanes};
    hf_built_linear_apply(l, &by, (int)n, r->strain_N, NULL, r->answer_m, r->scratch);
    for (size_t k = 0; k < n; k++)
        push_displacement(a, r, r->answer_m + k * a->n_dof, a->column + (first + k) * a->n_row);
}

static void multiply_rows(void *context, int room, int i_block)
{
    adjustment *a = context;
    int n_all = (int)rows_of(a), first = GRAM_ROWS * i_block;
    int end = first + GRAM_ROWS < n_all ? first + GRAM_ROWS : n_all;
    (void)room;
    hf_band_gram(first, end, (int)a->n_row, a->column, (int)a->n_row, a->product, n_all);
}

/* Multiplies all rows with each other and copies J'J, J'r, r'r and the products with the samples to where
 * hf_turnbuckles_choose reads them. */
static void find_products(adjustment *a)
{
    size_t n = a->n, n_all = rows_of(a), last = n_all - 1;
    hf_parallel_each(a->n_room, (int)((n_all + GRAM_ROWS - 1) / GRAM_ROWS), multiply_rows, a);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++)
            a->gram[i * n + j] = a->gram[j * n + i] = a->product[i * n_all + j];
    for (size_t s = 0; s < HF_ESTIMATE_SAMPLES; s++)
        memcpy(a->sample + s * n, a->product + (n + s) * n_all, n * sizeof(double));
    memcpy(a->slope, a->product + last * n_all, n * sizeof(double));
    a->problem.square = a->product[last * n_all + last];
}

/* Computes how far each tension may fall below its value without adjustments, which the linear model extrapolates from
 * the present shape. */
static void find_room(adjustment *a)
{
    int n_cable = a->problem.n_tension;
    for (int e = 0; e < n_cable; e++)
        a->room[0].strain_N[e] = a->estimate->linear.cut_N_per_m[e] * a->adjustment_m[e];
    find_tensions(a, a->room_N);
    a->problem.reference_N = hf_max_magnitude((size_t)n_cable, a->work.tension_N);
    for (int e = 0; e < n_cable; e++)
        a->room_N[e] = fmax(a->work.tension_N[e] - a->room_N[e] - a->min_N[e], 0);
}

/* Sets at_zero to the residuals without adjustments: r(0) = r(a) - J a. */
static void take_adjustments_off(adjustment *a)
{
    memcpy(a->at_zero, a->residual, a->n_row * sizeof *a->at_zero);
    for (size_t i = 0; i < a->n; i++) {
        double adjustment_m = a->adjustment_m[a->task->cable[i]];
        if (adjustment_m != 0) hf_subtract(a->n_row, adjustment_m, a->column + i * a->n_row, a->at_zero);
    }
}

/* Renews the residuals at a shape near that of the last linear model and keeps the derivatives of that model. */
static hf_status look_again(adjustment *a)
{
    HF_TRY(hf_objectives_linearise(a->task->objectives, true, &a->work, &a->room[0].point, a->residual));
    take_adjustments_off(a);
    for (size_t i = 0; i < a->n; i++)
        a->slope[i] = hf_dot(a->n_row, a->column + i * a->n_row, a->at_zero);
    a->problem.square = hf_dot(a->n_row, a->at_zero, a->at_zero);
    return HF_OK;
}

/* Builds the linear model at the shape in `work`: residuals, their derivatives with respect to each turnbuckle, and
 * their changes by each posterior sample. */
static hf_status linearise(adjustment *a)
{
    size_t n = a->n, n_row = a->n_row;
    for (int i = 0; i < a->n_room; i++)
        HF_TRY(hf_objectives_linearise(a->task->objectives, true, &a->work, &a->room[i].point, a->residual));
    HF_TRY(hf_built_linear_take(&a->estimate->linear, &a->work));
    hf_packed_band_pack(&a->matrix, a->estimate->linear.work.newton_band);
    hf_parallel_each(a->n_room, (int)((n + PANEL - 1) / PANEL), find_panel, a);
    take_adjustments_off(a);
    for (size_t s = 0; s < HF_ESTIMATE_SAMPLES; s++)
        push_displacement(a, &a->room[0], a->doubt_m + s * a->n_dof, a->left_open + s * n_row);
    find_products(a);
    find_room(a);
    return HF_OK;
}

/* ---- the choice ---- */

/* Finds the best steps and writes them to a->steps, which is 0 on entry. Each choice starts from the linear model of
 * the last accepted shape and is accepted when its own solved shape is better.
 *
 * The range is halved when the solved shape fails, when a cable has too little tension in it, or when the first choice
 * is no better. The linear model does not hold that far in these cases. */
static hf_status choose(adjustment *a, hf_adjustment *found)
{
    double figure_m;
    HF_TRY(solve_steps(a, a->steps, &figure_m));
    found->adjusted_m = found->estimated_m = figure_m;
    found->end = HF_TURNBUCKLES_NONE;
    find_min_tensions(a, found);
    while (found->n_round < ROUNDS_MAX && !found->is_settled) {
        hf_turnbuckles_end end;
        bool is_held;
        hf_status status = a->is_current ? HF_OK : linearise(a);
        if (status == HF_SINGULAR) return HF_OK; /* without stiffness there is no linear model to improve on */
        HF_TRY(status);
        found->n_round += !a->is_current;
        a->is_current = true;
        HF_TRY(hf_turnbuckles_choose(&a->problem, a->trial, &end, &is_held));
        found->is_held_taut |= is_held;
        found->is_settled = memcmp(a->trial, a->steps, a->n * sizeof *a->trial) == 0;
        if (found->is_settled) found->end = end;
        if (found->is_settled) return HF_OK;
        status = solve_steps(a, a->trial, &figure_m);
        if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
        bool is_low = status == HF_OK && !keeps_min_tensions(a), is_better = figure_m < found->adjusted_m;
        bool is_first = found->adjusted_m == found->estimated_m;
        found->is_held_taut |= is_low;
        if (status != HF_OK || is_low || (is_first && !is_better)) {
            a->problem.steps_max /= 2;
            found->is_settled = a->problem.steps_max == 0;
            continue;
        }
        found->is_settled = !is_better;
        if (found->is_settled) return HF_OK;
        found->adjusted_m = figure_m;
        found->end = end;
        memcpy(a->steps, a->trial, a->n * sizeof *a->trial);
        a->is_current = false;
    }
    return HF_OK;
}

/* ---- continuous optimum ---- */

/* Takes a step from the present adjustments towards a->continuous_m, without limits on tensions, and halves it until
 * the figure falls by more than LITTLE. *gains is false when no step does; the adjustments and the shape are then as
 * before. */
static hf_status go_on(adjustment *a, double *best_m, bool *gains)
{
    double length = 1, at = 0, figure_m = (double)NAN;
    for (size_t i = 0; i < a->n; i++)
        a->continuous_m[i] -= a->adjustment_m[a->task->cable[i]];
    for (int k = 0; k <= HALVINGS_MAX + 1; k++, length /= 2) {
        double to = k > HALVINGS_MAX ? 0 : length;
        for (size_t i = 0; i < a->n; i++)
            a->adjustment_m[a->task->cable[i]] += (to - at) * a->continuous_m[i];
        at = to;
        hf_status status = solve_adjusted(a, &figure_m);
        if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
        *gains = status == HF_OK && figure_m < *best_m * (1 - LITTLE);
        if (!*gains) continue;
        *best_m = figure_m;
        return HF_OK;
    }
    return HF_OK;
}

/* Returns whether the linear model predicts a figure below figure_m after the adjustments a->continuous_m. */
static bool promises(const adjustment *a, double figure_m)
{
    double square = a->problem.square;
    for (size_t i = 0; i < a->n; i++)
        square += a->continuous_m[i] * (2 * a->slope[i] + hf_dot(a->n, a->gram + i * a->n, a->continuous_m));
    return !(square >= figure_m * figure_m * (1 - LITTLE) * (1 - LITTLE));
}

/* Searches for the continuous optimum from the chosen shape and writes its figure to found->best_m. The derivatives of
 * the last linear model are kept as long as steps with them reduce the figure. */
static hf_status find_best(adjustment *a, hf_adjustment *found)
{
    bool gains = true, is_new = true;
    HF_TRY(solve_steps(a, a->steps, &found->best_m));
    a->problem.steps_max = hf_adjust_steps(a->task->settings);
    for (int round_ = 0; (gains || !is_new) && round_ < ROUNDS_MAX; round_++) {
        is_new = round_ == 0 || !gains;
        hf_status status = !is_new ? look_again(a) : round_ == 0 && a->is_current ? HF_OK : linearise(a);
        if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
        if (status != HF_OK) return HF_OK; /* the shape has no stiffness, perhaps because cables are slack */
        HF_TRY(hf_turnbuckles_best(&a->problem, a->continuous_m));
        if (!promises(a, found->best_m)) return HF_OK;
        HF_TRY(go_on(a, &found->best_m, &gains));
    }
    return HF_OK;
}

/* ---- posterior samples ---- */

/* Computes answer_m, the displacements of the posterior samples by the linear model at the shape in `work`. Where that
 * has no stiffness, they are doubt_m. */
static hf_status answer_samples(adjustment *a)
{
    hf_built_linear *l = &a->estimate->linear;
    adjust_room *r = &a->room[0];
    size_t n_cable = (size_t)l->built->model.n_cable;
    hf_status status = hf_built_linear_take(l, &a->work);
    if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
    memcpy(a->answer_m, status == HF_OK ? a->cause.rest_m : a->doubt_m,
           HF_ESTIMATE_SAMPLES * a->n_dof * sizeof *a->answer_m);
    for (size_t s = 0; s < HF_ESTIMATE_SAMPLES && status == HF_OK; s++) {
        for (size_t e = 0; e < n_cable; e++)
            r->strain_N[e] = l->cut_N_per_m[e] * a->cause.cut_m[s * n_cable + e];
        hf_built_linear_apply(l, NULL, 1, r->strain_N, NULL, a->answer_m + s * a->n_dof, r->scratch);
    }
    return HF_OK;
}

/* Makes sample i: the estimated errors, its posterior errors and the adjustments. */
static void make_sample(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m,
                        double *load_N)
{
    const adjustment *a = context;
    const hf_estimate *p = a->estimate;
    const hf_model *m = &p->built->model;
    const double *own_m = a->cause.cut_m + (size_t)i * (size_t)m->n_cable;
    const double *rest_m = a->cause.rest_m + (size_t)i * a->n_dof;
    (void)EA_N, (void)load_N;
    for (int e = 0; e < m->n_cable; e++)
        cut_m[e] += p->cut_m[e] + own_m[e] + a->adjustment_m[e];
    for (int row = m->n_free; row < m->n_node; row++)
        for (int c = 0; c < 3; c++)
            support_displacement_m[c * m->n_node + row] = p->rest_m[3 * row + c] + rest_m[3 * row + c];
}

/* Stores the displacements of sample i minus the linear ones, 0 for a sample without a shape. */
static void take_sample(void *context, long i, const hf_built_shape *shape, const hf_form_result *result)
{
    const adjustment *a = context;
    const hf_model *m = &a->estimate->built->model;
    const double *answer_m = a->answer_m + (size_t)i * a->n_dof;
    double *beyond_m = a->beyond_m + (size_t)i * a->n_dof;
    bool has_shape = hf_status_has_shape(result->status);
    for (int row = 0; row < m->n_node; row++)
        for (int c = 0; c < 3; c++) {
            int at = c * m->n_node + row;
            double move_m = shape->position_m[at] - a->work.position_m[at];
            beyond_m[3 * row + c] = has_shape ? move_m - answer_m[3 * row + c] : 0;
        }
}

/* Solves each posterior sample after all adjustments and stores its displacements minus the linear ones. They differ
 * when an adjustment makes cables slack or taut, because this is beyond first order. */
static hf_status find_beyond(adjustment *a)
{
    const hf_built *b = a->estimate->built;
    hf_built_batch *batch;
    double figure_m;
    HF_TRY(solve_steps(a, a->steps, &figure_m));
    HF_TRY(answer_samples(a));
    HF_TRY(hf_built_batch_create(b, a->task->n_thread, &batch));
    hf_built_batch_run(batch, HF_BUILT_VARIES_SUPPORTS, 0, HF_ESTIMATE_SAMPLES, make_sample, take_sample, a);
    hf_built_batch_free(batch);
    return hf_built_must_stop(b) ? HF_INTERRUPTED : HF_OK;
}

/* Computes the figure of each posterior sample at the shape in `work`. `part` is the share of all adjustments made so
 * far; it scales the nonlinear correction beyond_m. */
static hf_status sample_figures(adjustment *a, double part, double figure_m[HF_ESTIMATE_SAMPLES])
{
    adjust_room *r = &a->room[0];
    HF_TRY(hf_objectives_linearise(a->task->objectives, true, &a->work, &r->point, a->residual));
    HF_TRY(answer_samples(a));
    for (size_t s = 0; s < HF_ESTIMATE_SAMPLES; s++) {
        double *move_m = a->answer_m + s * a->n_dof;
        if (part > 0) hf_add(a->n_dof, part, a->beyond_m + s * a->n_dof, move_m);
        push_displacement(a, r, move_m, a->at_zero); /* at_zero is free at this point */
        hf_add(a->n_row, 1, a->residual, a->at_zero);
        figure_m[s] = sqrt(hf_dot(a->n_row, a->at_zero, a->at_zero));
    }
    return HF_OK;
}

/* ---- order of adjustments ---- */

/* Computes the changes of tension that each chosen adjustment causes in the linear model. change_N has the shape
 * [n_turnbuckle][n_cable], in the order of a->steps. */
static void find_changes(adjustment *a, double *change_N)
{
    size_t n_cable = (size_t)a->problem.n_tension;
    for (size_t i = 0; i < a->n; i++) {
        if (!a->steps[i]) continue;
        find_rates(a, (int)i, change_N);
        for (size_t e = 0; e < n_cable; e++)
            change_N[e] *= a->steps[i] * a->problem.step_m;
        change_N += n_cable;
    }
}

/* Computes mean and standard deviation of the reduction of the figure over the posterior samples. before_m holds the
 * figures of the samples before this adjustment, and those after it on return. */
static hf_status judge_adjustment(adjustment *a, double part, double before_m[HF_ESTIMATE_SAMPLES],
                                  hf_adjust_turnbuckle *turned)
{
    double gain_m[HF_ESTIMATE_SAMPLES], unused;
    memcpy(gain_m, before_m, sizeof gain_m);
    HF_TRY(sample_figures(a, part, before_m));
    hf_estimate_spread(before_m, &turned->expected_m, &unused);
    for (int s = 0; s < HF_ESTIMATE_SAMPLES; s++) {
        gain_m[s] -= before_m[s];
        turned->gain_m += gain_m[s] / HF_ESTIMATE_SAMPLES;
    }
    hf_estimate_spread(gain_m, &unused, &turned->gain_sigma_m);
    return HF_OK;
}

/* Makes the adjustments one by one and judges each of them. On entry a->trial is 0 and `work` holds the shape without
 * adjustments. change_N is that of find_changes, and fall_N [n_cable], 0 on entry, the fall of each tension after the
 * adjustments in a->trial. sample_m holds the figures of the samples without adjustments; on return, those after all of
 * them. */
static hf_status make_adjustments(adjustment *a, const double *change_N, double *fall_N,
                                  double sample_m[HF_ESTIMATE_SAMPLES], hf_adjustment *found)
{
    double made = 0, all = 0;
    for (size_t i = 0; i < a->n; i++)
        all += abs(a->steps[i]);
    for (int k = 0; k < found->n_turnbuckle; k++) {
        int i = hf_turnbuckles_next(&a->problem, a->steps, change_N, a->trial, fall_N);
        int e = a->task->cable[i];
        hf_adjust_turnbuckle *turned = &found->turnbuckle[k];
        *turned =
            (hf_adjust_turnbuckle){.cable = e, .steps = a->steps[i], .turnbuckle_m = a->steps[i] * a->problem.step_m};
        turned->before_N = a->work.tension_N[e];
        hf_status status = solve_steps(a, a->trial, &turned->figure_m);
        if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
        turned->after_N = status == HF_OK ? a->work.tension_N[e] : (double)NAN;
        turned->n_slack = a->form.n_slack;
        made += abs(turned->steps);
        HF_TRY(judge_adjustment(a, made / all, sample_m, turned));
    }
    return HF_OK;
}

static hf_status list_adjustments(adjustment *a, hf_adjustment *found)
{
    double figure_m, sample_m[HF_ESTIMATE_SAMPLES], *change_N, *fall_N;
    size_t n_cable = (size_t)a->problem.n_tension;
    void *block;
    for (size_t i = 0; i < a->n; i++)
        found->n_turnbuckle += a->steps[i] != 0;
    HF_TRY(HF_ARENA_ARRAYS(&found->block, HF_ARRAY(found->turnbuckle, found->n_turnbuckle)));
    if (!a->is_current) HF_TRY(solve_steps(a, a->steps, &figure_m));
    hf_status status = a->is_current ? HF_OK : linearise(a);
    /* Without stiffness the last linear model orders them. */
    if (status != HF_OK && status != HF_SINGULAR) return status;
    a->is_current = status == HF_OK;
    HF_TRY(
        HF_ARENA_ARRAYS(&block, HF_ARRAY(change_N, (size_t)found->n_turnbuckle * n_cable), HF_ARRAY(fall_N, n_cable)));
    find_changes(a, change_N); /* before answer_samples changes the linear model */
    status = found->n_turnbuckle ? find_beyond(a) : HF_OK;
    memset(a->trial, 0, a->n * sizeof *a->trial);
    if (status == HF_OK) status = solve_steps(a, a->trial, &figure_m);
    if (status == HF_OK) status = sample_figures(a, 0, sample_m);
    if (status == HF_OK) {
        hf_estimate_spread(sample_m, &found->doubt_m[0], &found->spread_m[0]);
        for (int e = 0; e < a->problem.n_tension; e++)
            found->n_maybe_slack += !(a->work.tension_N[e] > a->doubt_N[e]); /* both are 0 for a slack cable */
        status = make_adjustments(a, change_N, fall_N, sample_m, found);
    }
    hf_arena_free_block(block);
    HF_TRY(status);
    hf_estimate_spread(sample_m, &found->doubt_m[1], &found->spread_m[1]); /* sample_m belongs to the last adjustment */
    return HF_OK;
}

/* ---- all steps together ---- */

int hf_adjust_steps(const hf_adjust_settings *s)
{
    double steps = floor(s->range_m / s->step_m * (1 + 1e-12));
    return (int)fmin(steps, HF_ADJUST_STEPS_MAX);
}

static hf_status find_all(adjustment *a, hf_adjustment *found)
{
    HF_TRY(hf_built_solve(a->estimate->built, &(hf_built_net){0}, &a->work, &a->form));
    HF_TRY(measure_work(a, &found->nominal_m));
    HF_TRY(hf_estimate_doubt(a->estimate, a->doubt_m, a->doubt_N, &a->cause));
    HF_TRY(choose(a, found));
    HF_TRY(list_adjustments(a, found));
    return find_best(a, found);
}

hf_status hf_adjust_find(hf_estimate *p, const hf_adjust_task *task, hf_adjustment *found)
{
    adjustment a;
    *found = (hf_adjustment){0};
    hf_status status = create_adjustment(p, task, &a);
    if (status == HF_OK) status = find_all(&a, found);
    free_adjustment(&a);
    return status;
}
