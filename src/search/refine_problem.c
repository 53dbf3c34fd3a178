/* Sets up the problem that Levenberg-Marquardt solves. refine_problem.h describes the interface.
 *
 *     variables x [n] -> design [n_variable] -> hf_evaluate -> shape -> sensitivities -> f, J', J'J, J'f, limits
 *
 * Contents: the problem - evaluation - stored state */
#include "search/refine_problem.h"

#include "base/elementary.h"
#include "linalg/band.h"
#include "linalg/dot.h"
#include "net/symmetry.h"
#include "search/parallel.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

/* Brackets contain the range in which no test of this module and of cli/limits fails, as far as it was tried. */
#define GRAM_ROWS 32 /* rows of J'J that a thread computes at a time; the bits do not depend on it */
#define POSITION_ROUNDING (16 * DBL_EPSILON) /* error of a computed position, relative to the largest coordinate */
#define DENSITY_LEFT 1e-3 /* minimum of a force density, as a part of its first value [1e-6 to 0.3] */

/* ---- the problem ---- */

/* The scalars of a stored state, X(name, variable, type). Behind them are settled_objective, and the arrays `at` [n],
 * `scale` [n], the sides of the bounds that held the last step [n], and `best` [n_variable]. */
#define STATE_SCALARS(X)                                                                                               \
    X(ITERATIONS, r->iterations, int)                                                                                  \
    X(EVALUATIONS, p->evaluations, int)                                                                                \
    X(STOP, r->stop, hf_refine_stop)                                                                                   \
    X(IS_SPARSE, p->is_sparse, bool)                                                                                   \
    X(IS_OUTSIDE, p->is_outside, bool)                                                                                 \
    X(MERIT, r->merit, double)                                                                                         \
    X(PSI, p->best_psi_m, double)                                                                                      \
    X(DAMPING, p->damping, double)                                                                                     \
    X(GROWTH, p->growth, double)                                                                                       \
    X(WAY, p->way, double)                                                                                             \
    X(VIOLATION, p->violation, double)                                                                                 \
    X(PROMISED_BEFORE, p->promised_before, double)                                                                     \
    X(SETTLED_STEPS, p->settled_steps, int)                                                                            \
    X(SETTLED_MERIT, p->settled_merit, double)                                                                         \
    X(BEST_OF_OTHERS, p->best_of_others, double)                                                                       \
    X(PSI_WEIGHT, p->psi_weight, double)                                                                               \
    X(WEIGHT_LOW, p->weight_low, double)                                                                               \
    X(PSI_LOW, p->psi_low_m, double)                                                                                   \
    X(WEIGHT_HIGH, p->weight_high, double)                                                                             \
    X(PSI_HIGH, p->psi_high_m, double)                                                                                 \
    X(N_WEIGHT, p->n_weight, int)
#define INDEX(name, ...) STATE_##name,
#define WRITE(name, variable, ...) s[STATE_##name] = variable;
#define READ(name, variable, type) variable = (type)s[STATE_##name];
enum {
    STATE_FORMAT,
    STATE_SCALARS(INDEX) STATE_SETTLED_OBJECTIVE,
    N_SCALAR = STATE_SETTLED_OBJECTIVE + HF_DESIGN_ROWS_MAX
};
#define FORMAT 5

bool hf_refine_is_tension(const hf_refine_problem *p, int k)
{
    return hf_evaluate_sets(p->caller, k) != hf_evaluate_sets(&p->v, k);
}

/* Returns the magnitude of design variable k, which starts at `start`. A support starts at 0: its magnitude is the
 * width of its bounds or, if that is not finite, the maximum length of a cable. */
static double unit_of(const hf_refine_problem *p, int k, double start)
{
    const hf_model *m = p->v.model;
    double unit = p->upper[k] - p->lower[k];
    if (m->variable_cable[k] >= 0) return start;
    if (isfinite(unit) && unit > 0) return unit;
    unit = 0;
    for (int e = 0; e < m->n_cable; e++)
        unit = fmax(unit, m->length_m[e]);
    return unit;
}

void hf_refine_begin(hf_refine_problem *p, const double *design)
{
    const hf_model *m = p->v.model;
    for (int i = 0; i < p->n; i++) {
        p->low[i] = -INFINITY;
        p->high[i] = INFINITY;
    }
    for (int k = 0; k < m->n_variable; k++) {
        int i = p->slopes.class_of_variable[k], e = m->variable_cable[k];
        double start = design[k], lower = p->lower[k], upper = p->upper[k];
        double unit = unit_of(p, k, start);
        if (hf_refine_is_tension(p, k)) {
            start = hf_evaluate_design_length_m(m, e) * p->w->tension_N[e] / p->w->length_m[e];
            lower = DENSITY_LEFT * start;
            upper = INFINITY;
            unit = start;
        }
        double weight = hf_symmetry_weight(m, p->v.initial, k);
        p->start[k] = start;
        p->low[i] = fmax(p->low[i], fmin(lower - start, 0) / weight);
        p->high[i] = fmin(p->high[i], fmax(upper - start, 0) / weight);
        p->unit[i] = fmax(p->unit[i], unit / weight);
    }
    memcpy(p->best, design, (size_t)m->n_variable * sizeof(double));
    memcpy(p->design, p->start, (size_t)m->n_variable * sizeof(double));
}

/* Selects the residuals to minimise: all of them, or those of one objective. */
static void aim(hf_refine_problem *p)
{
    p->n_row = p->residuals.n_row;
    if (!p->front) return;
    const hf_objective *objective = p->v.objectives->objective, *least = objective + p->front->least;
    for (; objective < least; objective++)
        p->first_row += objective->n_row;
    p->n_row = least->n_row;
    p->has_corners = hf_objectives_is_maximum(least->settings.figure);
    p->watch.objective = p->result.objective;
    p->watch.point = hf_residuals_point(&p->residuals);
    p->watch.objective_rate = p->objective_rate;
}

hf_status hf_refine_create(hf_refine_problem *to)
{
    const hf_model *m = to->v.model;
    to->n = m->n_leader;
    HF_TRY((to->is_sparse ? hf_sensitivity_number : hf_sensitivity_create)(&to->v, &to->slopes));
    HF_TRY(hf_residuals_create(&to->v, &to->residuals));
    HF_TRY(hf_watch_create(to->caller, &to->slopes, to->lower, to->upper, to->front, &to->watch));
    size_t n = (size_t)to->n, n_row = (size_t)to->residuals.n_row, n_variable = (size_t)m->n_variable;
    size_t n_dense = to->is_sparse ? 0 : n;
    to->n_state = N_SCALAR + 3 * n + n_variable;
    HF_TRY(HF_ARENA_ARRAYS(&to->block, HF_REFINE_FIELDS(HF_ARENA_ITEM)));
    aim(to);
    if (hf_refine_n_constraint(to) > 0) {
        to->watch.constraint = hf_residuals_point(&to->residuals)->constraint;
        to->watch.constraint_rate = to->constraint_rate;
    }
    if (!to->is_sparse) return hf_quadratic_create(to->n + to->has_corners, &to->step);
    to->step = (hf_quadratic){.n = to->n, .x = to->sparse_x, .side = to->sparse_side};
    return hf_saddle_step_create(&to->v, to->residuals.n_row, &to->saddle);
}

void hf_refine_destroy(hf_refine_problem *p)
{
    hf_saddle_step_free(&p->saddle);
    hf_arena_free_block(p->step.block);
    hf_arena_free_block(p->watch.block);
    hf_residuals_free(&p->residuals);
    hf_sensitivity_free(&p->slopes);
    hf_arena_free_block(p->block);
}

/* ---- evaluation ---- */

double hf_refine_merit(const hf_refine_problem *p, const hf_form_result *r)
{
    if (!p->front) return r->merit;
    double value = r->objective[p->front->least];
    return p->v.objectives->objective[p->front->least].settings.figure == HF_FIGURE_RATIO ? log(value) : value;
}

/* Sets the status of a shape in which a cable that the design gives a tension is too short for the law tension. The
 * caller's evaluator would refuse the design. */
static void refuse_collapsed(hf_refine_problem *p)
{
    const hf_model *m = p->v.model;
    for (int k = 0; k < m->n_variable; k++) {
        int e = m->variable_cable[k];
        if (!hf_refine_is_tension(p, k) || p->w->length_m[e] >= p->v.form->collapse_ratio * m->length_m[e]) continue;
        p->result.status = HF_COLLAPSED;
        p->result.culprit = e;
    }
}

hf_status hf_refine_evaluate(hf_refine_problem *p, const double *step)
{
    const hf_model *m = p->v.model;
    for (int k = 0; k < m->n_variable; k++) {
        double weight = hf_symmetry_weight(m, p->v.initial, k);
        double value = p->start[k] + weight * step[p->slopes.class_of_variable[k]];
        p->design[k] = hf_refine_is_tension(p, k) ? value : fmax(p->lower[k], fmin(p->upper[k], value));
    }
    p->evaluations++;
    hf_evaluate(&p->v, p->design, p->w, hf_residuals_point(&p->residuals), &p->result);
    if (hf_status_has_shape(p->result.status)) refuse_collapsed(p);
    return p->result.status;
}

double hf_refine_norm(const hf_objectives *objectives, int n, const hf_form_result *r)
{
    double square = 0;
    for (int k = 0; k < n; k++) {
        double value = objectives->objective[k].settings.weight * r->objective[k];
        square += value * value;
    }
    return sqrt(square);
}

double hf_refine_others(const hf_refine_problem *p, const hf_form_result *r)
{
    const hf_objectives *g = p->relaxed;
    int n = g ? g->n_objective - 1 : 0;
    bool is_norm = true; /* of the values; a maximum and values over nets are smooth in the merit only */
    for (int k = 0; k < n; k++)
        is_norm &= !hf_objectives_is_maximum(g->objective[k].settings.figure) && g->objective[k].n_net == 0;
    if (n == 0 || is_norm) return hf_refine_norm(g, n, r);
    double of_psi = p->psi_weight * r->objective[n];
    return sqrt(fmax(0, r->merit * r->merit - of_psi * of_psi));
}

void hf_refine_weigh(hf_refine_problem *p, double weight)
{
    p->psi_weight = weight;
    p->relaxed->objective[p->relaxed->n_objective - 1].settings.weight = weight;
}

void hf_refine_keep(hf_refine_problem *p)
{
    const hf_model *m = p->v.model;
    memcpy(p->at, p->trial, (size_t)p->n * sizeof(double));
    p->psi_m = p->result.psi_m;
    p->others = hf_refine_others(p, &p->result);
    if (p->relaxed && !p->is_outside &&
        (p->best_psi_m <= p->psi_most_m ? p->psi_m > p->psi_most_m || p->others > p->best_of_others
                                        : p->psi_m > p->best_psi_m))
        return;
    p->best_psi_m = p->psi_m;
    p->best_of_others = p->others;
    const double *initial = p->v.initial;
    for (int k = 0; k < m->n_variable; k++) {
        int leader = m->variable_leader[k];
        p->best[k] = hf_refine_is_tension(p, k) ? p->w->tension_N[m->variable_cable[k]] : p->design[k];
        if (hf_refine_is_tension(p, k) && initial && leader != k) /* exactly, also on a truss that is not symmetric */
            p->best[k] = initial[k] + (p->best[leader] - initial[leader]);
    }
}

/* Returns the part of the merit that the tolerance of the form-finding leaves open. Forces out of balance by
 * residual_tolerance of the tensions act like an error of this part in each variable. A merit below the resulting
 * change is zero as far as shapes are known. */
static double find_noise(const hf_refine_problem *p)
{
    double square = 0;
    for (int k = 0; k < p->n; k++)
        square += p->gram[k * p->n + k] * p->unit[k] * p->unit[k];
    return p->v.form->residual_tolerance * sqrt(square);
}

double hf_refine_rounding(const hf_refine_problem *p)
{
    const hf_objectives *objectives = p->v.objectives;
    double weight = objectives ? 0 : 1;
    for (int k = 0; objectives && k < objectives->n_objective; k++)
        if (objectives->objective[k].settings.figure <= HF_FIGURE_FACETS)
            weight += objectives->objective[k].settings.weight;
    return weight * POSITION_ROUNDING * hf_max_magnitude(3 * (size_t)p->v.model->n_node, p->w->position_m);
}

/* Computes some rows of J'J. */
static void multiply_rows(void *context, int room, int i_block)
{
    hf_refine_problem *p = context;
    int first = GRAM_ROWS * i_block, end = first + GRAM_ROWS < p->n ? first + GRAM_ROWS : p->n;
    (void)room;
    hf_band_gram(first, end, p->n_row, p->row + p->first_row, p->residuals.n_row, p->gram, p->n);
}

/* Computes the gradient g = J'f/|f| of an objective |f|. Adds the curvature of its limit to the matrix: m (J'J - g
 * g')/|f|, where m is the multiplier of the last step. */
static void press(hf_refine_problem *p, int i_objective, int first_row, int n_row)
{
    const double *f = p->residuals.value + first_row;
    double *rate = p->objective_rate + (size_t)i_objective * (size_t)p->n, norm = p->result.objective[i_objective];
    double part = norm > 0 ? 1 / norm : 0, pressure = p->pressure[i_objective] * part;
    int n_all = p->residuals.n_row;
    hf_dots((size_t)p->n, (size_t)n_row, p->row + first_row, (size_t)n_all, f, rate);
    for (int k = 0; k < p->n; k++)
        rate[k] *= part;
    if (!(pressure > 0)) return;
    hf_band_gram(0, p->n, n_row, p->row + first_row, n_all, p->hessian, p->n);
    for (int r = 0; r < p->n; r++)
        for (int c = 0; c <= r; c++)
            p->gram[r * p->n + c] += pressure * (p->hessian[r * p->n + c] - rate[r] * rate[c]);
}

/* Changes the model for a point of a front. Objectives without corners become curved limits. If the minimised objective
 * has corners, its level is minimised in place of its residuals. */
static void linearise_front(hf_refine_problem *p)
{
    const hf_objectives *g = p->v.objectives;
    size_t n = (size_t)p->n;
    if (p->has_corners) {
        double value = p->result.objective[p->front->least];
        p->watch.level = hf_refine_merit(p, &p->result);
        if (g->objective[p->front->least].settings.figure == HF_FIGURE_RATIO) p->noise /= value;
        memset(p->gram, 0, n * n * sizeof(double));
        memset(p->gradient, 0, n * sizeof(double));
    }
    for (int k = 0, first = 0; k < g->n_objective; first += g->objective[k++].n_row)
        if (k != p->front->least && !hf_objectives_is_maximum(g->objective[k].settings.figure))
            press(p, k, first, g->objective[k].n_row);
}

/* Makes the model of the saddle-point system at the shape in the workspace. */
static hf_status linearise_sparse(hf_refine_problem *p)
{
    HF_TRY(hf_residuals_find(&p->residuals, p->w));
    hf_saddle_step_linearise(&p->saddle, p->w, p->residuals.value);
    p->noise = p->v.form->residual_tolerance * hf_saddle_step_spread(&p->saddle, p->unit);
    hf_watch_linearise(&p->watch, &p->slopes, p->w);
    return HF_OK;
}

hf_status hf_refine_linearise(hf_refine_problem *p)
{
    if (p->is_sparse) return linearise_sparse(p);
    HF_TRY(hf_sensitivity_find(&p->slopes, p->w));
    HF_TRY(hf_residuals_find(&p->residuals, p->w));
    HF_TRY(hf_residuals_rates(&p->residuals, &p->slopes, p->w, p->row, p->gradient));
    if (p->front) /* the gradient of the residuals to minimise, not of all */
        hf_dots((size_t)p->n, (size_t)p->n_row, p->row + p->first_row, (size_t)p->residuals.n_row,
                p->residuals.value + p->first_row, p->gradient);
    hf_parallel_each(p->v.n_thread, (p->n + GRAM_ROWS - 1) / GRAM_ROWS, multiply_rows, p);
    for (int k = 0; k < p->n; k++) {
        p->scale[k] = fmax(p->scale[k], sqrt(p->gram[k * p->n + k]));
        p->largest_scale = fmax(p->largest_scale, p->scale[k]);
    }
    p->noise = find_noise(p);
    if (p->front) linearise_front(p);
    if (hf_refine_n_constraint(p) > 0)
        HF_TRY(p->v.objectives->constraints->linearise(hf_residuals_point(&p->residuals)->constraints, p->n,
                                                       hf_sensitivity_follow, &p->slopes, p->constraint_rate));
    hf_watch_linearise(&p->watch, &p->slopes, p->w);
    return HF_OK;
}

/* ---- stored state ---- */

void hf_refine_pack(hf_refine_problem *p, const hf_refine_result *r)
{
    double *s = p->state, *array = s + N_SCALAR;
    size_t n = (size_t)p->n, n_variable = (size_t)p->v.model->n_variable;
    s[STATE_FORMAT] = FORMAT;
    STATE_SCALARS(WRITE)
    memcpy(s + STATE_SETTLED_OBJECTIVE, p->settled_objective, sizeof p->settled_objective);
    memcpy(array, p->at, n * sizeof(double));
    memcpy(array + n, p->scale, n * sizeof(double));
    for (size_t i = 0; i < n; i++)
        array[2 * n + i] = p->step.side[i];
    memcpy(array + 3 * n, p->best, n_variable * sizeof(double));
}

/* Returns true if s [n_state] is a state of this problem. The file from which it comes may be damaged. */
static bool is_state(const hf_refine_problem *p, size_t n_state, const double *s)
{
    if (n_state != p->n_state || s[STATE_FORMAT] != FORMAT) return false;
    for (size_t i = N_SCALAR; i < n_state; i++)
        if (!isfinite(s[i])) return false;
    return s[STATE_ITERATIONS] >= 0 && s[STATE_ITERATIONS] < INT_MAX && s[STATE_EVALUATIONS] >= 1 &&
           s[STATE_EVALUATIONS] < INT_MAX && s[STATE_STOP] >= 0 && s[STATE_STOP] <= HF_REFINE_SETTLED &&
           s[STATE_DAMPING] > 0 && s[STATE_GROWTH] > 0 && s[STATE_WAY] > 0 && s[STATE_SETTLED_STEPS] >= 0 &&
           s[STATE_SETTLED_STEPS] < INT_MAX && s[STATE_N_WEIGHT] >= 0 && s[STATE_N_WEIGHT] < INT_MAX &&
           (!p->relaxed || s[STATE_PSI_WEIGHT] > 0);
}

bool hf_refine_was_dense(size_t n_state, const double *s)
{
    return s && n_state > N_SCALAR && s[STATE_FORMAT] == FORMAT && s[STATE_IS_SPARSE] == 0;
}

bool hf_refine_resume(hf_refine_problem *p, size_t n_state, const double *s, hf_refine_result *r)
{
    const double *array = s + N_SCALAR;
    size_t n = (size_t)p->n;
    if (!is_state(p, n_state, s)) return false;
    bool is_sparse = p->is_sparse; /* a dense run may continue one by the saddle-point system */
    STATE_SCALARS(READ)
    p->is_sparse = is_sparse;
    p->evaluations--; /* the best design is evaluated once more */
    if (p->watcher->is_more && r->stop == HF_REFINE_SETTLED) r->stop = HF_REFINE_MAX_ITERATIONS;
    memcpy(p->settled_objective, s + STATE_SETTLED_OBJECTIVE, sizeof p->settled_objective);
    memcpy(p->at, array, n * sizeof(double));
    memcpy(p->scale, array + n, n * sizeof(double));
    for (size_t i = 0; i < n; i++) {
        p->largest_scale = fmax(p->largest_scale, p->scale[i]);
        p->step.side[i] = (int)fmax(-2, fmin(2, array[2 * n + i]));
    }
    memcpy(p->best, array + 3 * n, (size_t)p->v.model->n_variable * sizeof(double));
    if (p->relaxed) hf_refine_weigh(p, p->psi_weight);
    return true;
}
