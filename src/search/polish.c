/* Contents: the problem - evaluation - one step - the run */
#include "search/polish.h"

#include "base/arena.h"
#include "linalg/band.h"
#include "linalg/dot.h"
#include "linalg/quadratic.h"
#include "search/parallel.h"
#include "search/residuals.h"
#include "search/watch.h"
#include "solve/limits.h"

#include <math.h>
#include <string.h>

/* In brackets: the range over which no test of this module and of cli/limits fails, as far as it was tried. */
#define GAIN_CONVERGED 1e-12  /* converged: a step promises less than this part of psi^2 [1e-15 to 1e-8] */
#define TRADE_CONVERGED 1e-20 /* the same of a trade, whose multipliers are wanted */
#define DAMPING_FIRST 1e-3    /* relative to the squared columns of J [1e-6 to 1] */
#define DAMPING_OF_MULTIPLIERS 1e-9
#define SCALE_LEAST 1e-8    /* part of the largest column of J: one below it is damped as the largest */
#define DAMPING_LEAST 1e-14 /* [1e-20 to 1e-8] */
#define DAMPING_MOST 1e12   /* with this much a step is too short to change psi [1e4 to 1e24] */
#define CORRECTIONS_MAX 4  /* of a step that breaks a limit on tensions [40 passes; 1 fails: the runs stall at a cap] */
#define DAMPING_OF_WAY 1e3 /* of a way into limits that steps with less do not find [1e8 passes; 1 fails] */
#define WAY_LEAST 1e-3     /* part of the way into the limits that a step goes [1e-2; 1e-6] */
#define LIMIT_INSIDE 2e-9  /* a tension so near to its bound, relative, is at it: twice what a step stays within */
#define LIMIT_ROUNDING 1e-12 /* a violation below this part of the tension is rounding [1e-14 to 1e-10] */
#define BENDS_MAX 4          /* corrections of a step for the bend of its residuals [2 to 4] */
#define BEND_BELOW 0.65      /* part of the promised gain from which on a step needs none [0.65 to 0.75; 0.5 fails] */
#define BEND_WORTH 0.5       /* a correction that leaves more of the merit than this is the last [0.5 to 0.9] */
#define GRAM_ROWS 32         /* of J'J that one thread works on at a time; the bits do not depend on it */
#define DENSITY_LEFT 1e-3    /* part of its first value below which no force density falls [1e-6 to 0.3] */

/* ---- the problem ---- */

/* Shapes of tensions T and of the force densities T/l are the same, but the shape is a far more even function of the
 * force densities: single tensions in a chain drag its nodes along. So genes that set a tension mean force densities
 * here, and their bounds are limits on the tensions. */
typedef struct {
    hf_evaluator v;             /* that of the caller, by force densities and without limits */
    const hf_evaluator *caller; /* that of the caller */
    const double *lower, *upper;
    hf_workspace *w;
    hf_sensitivity slopes;
    hf_residuals residuals;
    hf_watch watch;
    hf_quadratic step;
    const hf_watch_trade *trade; /* or NULL: the merit is to be least */
    int first_row, n_row;        /* of the residuals that are to be least */
    bool has_corners;            /* the goal to be least: then the level is one more variable of a step */
    int n;                       /* variables: steps from `start`, one for each class of linked genes */
    int evaluations;
    bool is_outside;                     /* no shape within the limits is known yet */
    hf_form_result result;               /* of the last evaluation */
    double *start;                       /* [n_gene] values; of tensions the pretensions q L* */
    double *low, *high;                  /* [n] bounds of the variables */
    double *down, *up;                   /* [n] of a step: how far it may go */
    double *unit;                        /* [n] size of the values: violations are relative to it */
    double *at, *trial;                  /* [n] the best variables; those of the last step */
    double *design;                      /* [n_gene] of the last evaluation, tensions as pretensions q L* */
    double *best;                        /* [n_gene] the best design in the caller's meaning */
    double *step_taken;                  /* [n] that led to `trial`, while it is corrected */
    double *pull;                        /* [n] gradient of a correction */
    double *scale;                       /* [n] largest norm of each column of J so far */
    double largest_scale;                /* of them */
    double *row;                         /* [n][rows of the residuals] J' */
    double *gram;                        /* [n][n] J'J; lower triangle by rows, as `hessian` */
    double *hessian;                     /* [n][n] J'J, damped */
    double *gradient;                    /* [n] J'f */
    double *goal_rate;                   /* [n_goal][n] of a trade: of goals without corners */
    double pressure[HF_DESIGN_ROWS_MAX]; /* of a trade: multipliers of the last step, in units of merit^2/2 */
    double promise;                      /* of a step before it was solved again: what the linear model says */
    double noise;                        /* what the tolerance of the form-finding leaves open in the merit */
} problem;

static void lay_out(hf_arena *a, problem *p)
{
    const hf_model *m = p->v.model;
    size_t n = (size_t)p->n, n_row = (size_t)p->residuals.n_row, n_gene = (size_t)m->n_gene;
    p->start = hf_arena_take(a, n_gene, sizeof(double));
    p->low = hf_arena_take(a, n, sizeof(double));
    p->high = hf_arena_take(a, n, sizeof(double));
    p->down = hf_arena_take(a, n + 1, sizeof(double));
    p->up = hf_arena_take(a, n + 1, sizeof(double));
    p->unit = hf_arena_take(a, n, sizeof(double));
    p->at = hf_arena_take(a, n, sizeof(double));
    p->trial = hf_arena_take(a, n, sizeof(double));
    p->design = hf_arena_take(a, n_gene, sizeof(double));
    p->best = hf_arena_take(a, n_gene, sizeof(double));
    p->step_taken = hf_arena_take(a, n, sizeof(double));
    p->pull = hf_arena_take(a, n, sizeof(double));
    p->scale = hf_arena_take(a, n, sizeof(double));
    p->row = hf_arena_take(a, n * n_row, sizeof(double));
    p->gram = hf_arena_take(a, n * n, sizeof(double));
    p->hessian = hf_arena_take(a, (n + 1) * (n + 1), sizeof(double));
    p->gradient = hf_arena_take(a, n + 1, sizeof(double));
    p->goal_rate = hf_arena_take(a, p->trade ? n * (size_t)p->v.goals->n_goal : 0, sizeof(double));
}

/* Does gene k set a tension for the caller, and a force density here? */
static bool is_tension(const problem *p, int k)
{
    return hf_evaluate_sets(p->caller, k) == HF_SETS_TENSION;
}

/* The size of the values of gene k, which starts at `start`. Of a support, which starts at 0: how far it may move, or
 * the longest cable where that is open, or nothing. */
static double unit_of(const problem *p, int k, double start)
{
    const hf_model *m = p->v.model;
    double unit = p->upper[k] - p->lower[k];
    if (m->gene_cable[k] >= 0) return start;
    if (isfinite(unit) && unit > 0) return unit;
    unit = 0;
    for (int e = 0; e < m->n_cable; e++)
        unit = fmax(unit, m->length_m[e]);
    return unit;
}

/* Start at the design whose shape is in the workspace. */
static void begin(problem *p, const double *design)
{
    const hf_model *m = p->v.model;
    for (int i = 0; i < p->n; i++) {
        p->low[i] = -INFINITY;
        p->high[i] = INFINITY;
    }
    for (int k = 0; k < m->n_gene; k++) {
        int i = p->slopes.variable_of_gene[k], e = m->gene_cable[k];
        double start = design[k], lower = p->lower[k], upper = p->upper[k];
        double unit = unit_of(p, k, start);
        if (is_tension(p, k)) {
            start = hf_evaluate_design_length_m(m, e) * p->w->tension_N[e] / p->w->length_m[e];
            lower = DENSITY_LEFT * start;
            upper = INFINITY;
            unit = start;
        }
        p->start[k] = start;
        p->low[i] = fmax(p->low[i], fmin(lower - start, 0));
        p->high[i] = fmin(p->high[i], fmax(upper - start, 0));
        p->unit[i] = fmax(p->unit[i], unit);
    }
    memcpy(p->best, design, (size_t)m->n_gene * sizeof(double));
    memcpy(p->design, p->start, (size_t)m->n_gene * sizeof(double));
}

/* Which rows are to be least: all, or those of one goal. */
static void aim(problem *p)
{
    p->n_row = p->residuals.n_row;
    if (!p->trade) return;
    const hf_goal *goal = p->v.goals->goal, *least = goal + p->trade->least;
    for (; goal < least; goal++)
        p->first_row += goal->n_row;
    p->n_row = least->n_row;
    p->has_corners = hf_goals_is_largest(least->wanted.goal);
    p->watch.goal = p->result.goal;
    p->watch.goal_rate = p->goal_rate;
}

static hf_status create(problem *p, hf_arena *arena)
{
    const hf_model *m = p->v.model;
    p->n = m->n_leader;
    HF_TRY(hf_sensitivity_create(&p->v, &p->slopes));
    HF_TRY(hf_residuals_create(&p->v, &p->residuals));
    HF_TRY(hf_watch_create(p->caller, &p->slopes, p->lower, p->upper, p->trade, &p->watch));
    HF_TRY(HF_ARENA_MAKE(arena, lay_out(arena, p)));
    aim(p);
    return hf_quadratic_create(p->n + p->has_corners, &p->step);
}

static void destroy(problem *p, hf_arena *arena)
{
    hf_quadratic_free(&p->step);
    hf_watch_free(&p->watch);
    hf_residuals_free(&p->residuals);
    hf_sensitivity_free(&p->slopes);
    hf_arena_free(arena);
}

/* ---- evaluation ---- */

/* What is to be least. */
static double merit_of(const problem *p, const hf_form_result *r)
{
    if (!p->trade) return r->merit;
    double value = r->goal[p->trade->least];
    return p->v.goals->goal[p->trade->least].wanted.goal == HF_GOAL_RATIO ? log(value) : value;
}

/* Find the shape of these variables in the workspace. */
static hf_status evaluate(problem *p, const double *variable)
{
    const hf_model *m = p->v.model;
    for (int k = 0; k < m->n_gene; k++) {
        double value = p->start[k] + variable[p->slopes.variable_of_gene[k]];
        p->design[k] = is_tension(p, k) ? value : fmax(p->lower[k], fmin(p->upper[k], value));
    }
    p->evaluations++;
    return hf_evaluate(&p->v, p->design, p->w, &p->result);
}

/* Take the shape in the workspace as the best. */
static void keep(problem *p)
{
    const hf_model *m = p->v.model;
    memcpy(p->at, p->trial, (size_t)p->n * sizeof(double));
    for (int k = 0; k < m->n_gene; k++)
        p->best[k] = is_tension(p, k) ? p->w->tension_N[m->gene_cable[k]] : p->design[k];
}

/* Forces may be out of balance by residual_tolerance of the tensions, as if each value were off by that part of itself.
 * A merit below what this changes in it is zero as far as shapes are known. */
static double find_noise(const problem *p)
{
    double square = 0;
    for (int k = 0; k < p->n; k++)
        square += p->gram[k * p->n + k] * p->unit[k] * p->unit[k];
    return p->v.form->residual_tolerance * sqrt(square);
}

/* Some rows of J'J. */
static void multiply_rows(void *context, int room, int i_block)
{
    problem *p = context;
    int first = GRAM_ROWS * i_block, end = first + GRAM_ROWS < p->n ? first + GRAM_ROWS : p->n;
    (void)room;
    hf_band_gram(first, end, p->n_row, p->row + p->first_row, p->residuals.n_row, p->gram, p->n);
}

/* The rate of a goal's norm, and what its residuals r bend a limit on it by: pressure (J'J - gg')/|r|, g the rate. */
static void press(problem *p, int i_goal, int first_row, int n_row)
{
    const double *f = p->residuals.value + first_row;
    double *rate = p->goal_rate + (size_t)i_goal * (size_t)p->n, norm = p->result.goal[i_goal];
    double part = norm > 0 ? 1 / norm : 0, pressure = p->pressure[i_goal] * part;
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

/* What a trade changes: goals without corners are limits that bend; one with corners that is to be least has a level
 * instead of residuals. */
static void linearise_trade(problem *p)
{
    const hf_goals *g = p->v.goals;
    size_t n = (size_t)p->n;
    if (p->has_corners) {
        double value = p->result.goal[p->trade->least];
        p->watch.level = merit_of(p, &p->result);
        if (g->goal[p->trade->least].wanted.goal == HF_GOAL_RATIO) p->noise /= value;
        memset(p->gram, 0, n * n * sizeof(double));
        memset(p->gradient, 0, n * sizeof(double));
    }
    for (int k = 0, first = 0; k < g->n_goal; first += g->goal[k++].n_row)
        if (k != p->trade->least && !hf_goals_is_largest(g->goal[k].wanted.goal)) press(p, k, first, g->goal[k].n_row);
}

/* Write residuals, J', J'J, the gradient and what is watched with its rates at the workspace's shape. */
static hf_status linearise(problem *p)
{
    HF_TRY(hf_sensitivity_find(&p->slopes, p->w));
    HF_TRY(hf_residuals_find(&p->residuals, p->w));
    HF_TRY(hf_residuals_rates(&p->residuals, &p->slopes, p->w, p->row, p->gradient));
    if (p->trade) /* that of the residuals which are to be least, not of all */
        hf_dots((size_t)p->n, (size_t)p->n_row, p->row + p->first_row, (size_t)p->residuals.n_row,
                p->residuals.value + p->first_row, p->gradient);
    hf_parallel_each(p->v.n_thread, (p->n + GRAM_ROWS - 1) / GRAM_ROWS, multiply_rows, p);
    for (int k = 0; k < p->n; k++) {
        p->scale[k] = fmax(p->scale[k], sqrt(p->gram[k * p->n + k]));
        p->largest_scale = fmax(p->largest_scale, p->scale[k]);
    }
    p->noise = find_noise(p);
    if (p->trade) linearise_trade(p);
    hf_watch_linearise(&p->watch, &p->slopes, p->w);
    return HF_OK;
}

/* ---- one step ---- */

/* The limit that the step x violates most; for hf_quadratic. */
static bool worst_limit(void *context, const double *x, hf_quadratic_limit *limit)
{
    problem *p = context;
    double worst = LIMIT_ROUNDING, sign = 0;
    int variable = -1;
    for (int i = 0; i < p->n; i++) {
        double below = (p->down[i] - x[i]) / p->unit[i], above = (x[i] - p->up[i]) / p->unit[i];
        if (!(fmax(below, above) > worst)) continue;
        worst = fmax(below, above);
        sign = below > above ? 1 : -1;
        variable = i;
    }
    if (hf_watch_worst(&p->watch, x, worst, limit)) return true;
    if (variable < 0) return false;
    limit->kind = 0;
    limit->only = variable;
    limit->normal[variable] = sign;
    limit->bound = sign * (sign > 0 ? p->down : p->up)[variable];
    return true;
}

/* The level of a goal with corners is the last variable of a step: level^2/2 is to be least. */
static void begin_level(problem *p)
{
    int n = p->n, n_step = p->step.n;
    memset(p->hessian + n * n_step, 0, (size_t)n * sizeof(double));
    p->hessian[n * n_step + n] = 1;
    p->gradient[n] = p->watch.level;
    p->down[n] = -INFINITY;
    p->up[n] = INFINITY;
}

/* Find the shape at the end of the step, which becomes `trial`. */
static hf_status take_step(problem *p)
{
    for (int r = 0; r < p->n; r++)
        p->trial[r] = fmax(p->low[r], fmin(p->high[r], p->at[r] + p->step.x[r]));
    return evaluate(p, p->trial);
}

/* A variable that does not act on what is to be least has no column of J to be damped by, and the model would have no
 * single least. */
static double damped_scale(const problem *p, int r)
{
    if (p->scale[r] > SCALE_LEAST * p->largest_scale) return p->scale[r];
    return p->largest_scale > 0 ? p->largest_scale : 1;
}

/* The least of the model |f + J x|^2/2 + damping |scale x|^2/2 within the limits, as step.x. *gain: what the model
 * promises of psi^2/2. */
static hf_status solve_step(problem *p, double damping, double *gain)
{
    const double *x = p->step.x;
    int n = p->n, n_step = p->step.n;
    for (int r = 0; r < n; r++) {
        memcpy(p->hessian + r * n_step, p->gram + r * n, (size_t)(r + 1) * sizeof(double));
        p->hessian[r * n_step + r] += damping * damped_scale(p, r) * damped_scale(p, r);
        p->down[r] = p->low[r] - p->at[r];
        p->up[r] = p->high[r] - p->at[r];
    }
    if (p->has_corners) begin_level(p);
    HF_TRY(hf_quadratic_solve(&p->step, p->hessian, p->gradient, p->down, p->up, worst_limit, p));
    *gain = p->has_corners ? -(p->watch.level + x[n] / 2) * x[n] : 0;
    for (int r = 0; r < n; r++) {
        double sum = p->gram[r * n + r] * x[r] / 2 + p->gradient[r];
        for (int c = 0; c < r; c++)
            sum += p->gram[r * n + c] * x[c];
        *gain -= sum * x[r];
    }
    return HF_OK;
}

/* Evaluate the step. One that breaks a limit on tensions, because they are not linear in the variables, is solved again
 * with what they really were. HF_RATIO_CAP: a limit is still broken. */
static hf_status try_step(problem *p, double damping, double *gain)
{
    hf_watch_forget(&p->watch);
    for (int again = 0; again <= CORRECTIONS_MAX; again++) {
        HF_TRY(solve_step(p, damping, gain));
        if (again == 0) p->promise = *gain;
        HF_TRY(take_step(p));
        if (hf_watch_keeps(&p->watch, p->w)) return HF_OK;
        hf_watch_learn(&p->watch, p->step.x, p->w);
    }
    return HF_RATIO_CAP;
}

/* The gradient, at a step of zero, of the model that has at x the residuals found there: J'(f(x) - J x). */
static void find_pull(problem *p)
{
    const double *x = p->step_taken;
    size_t n_row = (size_t)p->residuals.n_row;
    hf_dots((size_t)p->n, n_row, p->row, n_row, p->residuals.value, p->pull);
    for (int r = 0; r < p->n; r++)
        p->pull[r] -= p->gram[r * p->n + r] * x[r];
    for (int r = 0, at = 0; r < p->n; r++, at = r * p->n)
        for (int c = 0; c < r; c++, at++) {
            p->pull[r] -= p->gram[at] * x[c];
            p->pull[c] -= p->gram[at] * x[r];
        }
}

/* Where residuals bend, a step along a valley ends up on its flank. The same matrices lead back to the floor with the
 * residuals found there; again while that takes off a good part. `trial` and the workspace's shape become the best. */
static hf_status bend_step(problem *p, double before, double gain)
{
    size_t size = (size_t)p->n * sizeof(double);
    for (int again = 0; again < BENDS_MAX; again++) {
        double merit = p->result.merit;
        if (before - merit * merit / 2 > BEND_BELOW * gain || hf_residuals_find(&p->residuals, p->w) != HF_OK) break;
        memcpy(p->step_taken, p->step.x, size);
        find_pull(p);
        hf_status status = hf_quadratic_solve(&p->step, p->hessian, p->pull, p->down, p->up, worst_limit, p);
        if (status == HF_OK) status = take_step(p);
        if (status == HF_INTERRUPTED || status == HF_NO_MEMORY) return status;
        if (status == HF_OK && hf_watch_keeps(&p->watch, p->w) && p->result.merit < merit) {
            if (p->result.merit > BEND_WORTH * merit) break;
            continue;
        }
        memcpy(p->step.x, p->step_taken, size);
        return take_step(p);
    }
    return HF_OK;
}

/* ---- the run ---- */

/* From outside into the limits: each step goes as much of the way as brings the shape nearer to them. They are not
 * linear, and where the whole way leads elsewhere, a part of it does not. Near a limit that bends, what leads away is
 * what a step does for the merit: with more damping it does less of that. */
static hf_status enter(problem *p, int max_iterations, hf_polish_result *r)
{
    double way = 1, damping = DAMPING_FIRST, gain, before = hf_watch_violation(&p->watch, p->w);
    hf_watch_forget(&p->watch);
    while (p->is_outside && (way > WAY_LEAST || damping < DAMPING_OF_WAY) && r->iterations < max_iterations) {
        if (way <= WAY_LEAST) {
            damping = DAMPING_OF_WAY;
            way = 1;
        }
        r->iterations++;
        hf_watch_aim(&p->watch, way);
        hf_status status = solve_step(p, damping, &gain);
        if (status == HF_OK) status = take_step(p);
        if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
        double after = status == HF_OK ? hf_watch_violation(&p->watch, p->w) : (double)INFINITY;
        bool is_inside = status == HF_OK && hf_watch_keeps(&p->watch, p->w), is_nearer = is_inside || after < before;
        way = is_nearer ? fmin(1, 2 * way) : way / 2;
        if (!is_nearer) continue;
        before = after;
        keep(p);
        p->is_outside = !is_inside;
        r->merit = merit_of(p, &p->result);
        HF_TRY(linearise(p));
    }
    return HF_OK;
}

/* The multipliers of the last step, goal by goal. */
static void learn_pressure(problem *p)
{
    int goal;
    memset(p->pressure, 0, sizeof p->pressure);
    for (int i = 0; i < p->step.n_active; i++) {
        const hf_quadratic_active *a = &p->step.active[i];
        if (a->kind < HF_WATCH_GOAL) continue;
        double relief = hf_watch_relief(&p->watch, a->kind, &goal);
        p->pressure[goal] += relief * a->multiplier;
    }
}

static void forget_multipliers(hf_polish_result *r)
{
    for (int k = 0; k < HF_DESIGN_ROWS_MAX; k++)
        r->multiplier[k] = NAN;
}

/* Those of the linear model at the best design, free of what held the last step back; NaN where it has none. */
static hf_status find_multipliers(problem *p, hf_polish_result *r)
{
    double gain, merit;
    forget_multipliers(r);
    hf_status status = evaluate(p, p->at);
    if (status == HF_OK) status = linearise(p);
    hf_watch_forget(&p->watch);
    if (status == HF_OK) status = solve_step(p, DAMPING_OF_MULTIPLIERS, &gain);
    if (status != HF_OK) return status == HF_NO_MEMORY || status == HF_INTERRUPTED ? status : HF_OK;
    learn_pressure(p);
    merit = merit_of(p, &p->result);
    merit = sqrt(fmax(0, merit * merit - 2 * gain)); /* where the linear model is least: a last small step away */
    for (int k = 0; k < p->v.goals->n_goal; k++) {
        r->multiplier[k] = p->pressure[k] > 0 ? p->pressure[k] / merit : 0;
        if (p->v.goals->goal[p->trade->least].wanted.goal == HF_GOAL_RATIO) r->multiplier[k] *= exp(merit);
    }
    r->multiplier[p->trade->least] = NAN;
    return HF_OK;
}

/* Steps until one promises nothing more, none lowers psi any more, or the iteration limit is reached. The damping
 * follows Nielsen (Madsen, Nielsen, Tingleff, Methods for non-linear least squares problems, DTU 2004). */
static hf_status minimise(problem *p, int max_iterations, hf_polish_result *r)
{
    double damping = DAMPING_FIRST, growth = 2, gain = 0;
    double converged = p->trade ? TRADE_CONVERGED : GAIN_CONVERGED;
    hf_status status = evaluate(p, p->at);
    if (status == HF_OK) status = linearise(p);
    if (status == HF_OK && p->trade) {
        r->merit = merit_of(p, &p->result);
        p->is_outside = !hf_watch_keeps(&p->watch, p->w);
    }
    if (status == HF_OK && p->is_outside) status = enter(p, max_iterations, r);
    while (status == HF_OK && !p->is_outside && r->stop == HF_POLISH_MAX_ITERATIONS && r->iterations < max_iterations) {
        double before = r->merit * r->merit / 2;
        r->iterations++;
        status = try_step(p, damping, &gain);
        if (status == HF_OK && !p->trade) status = bend_step(p, before, gain);
        if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
        double merit = merit_of(p, &p->result), after = status == HF_OK ? merit * merit / 2 : (double)INFINITY;
        double promise =
            p->trade ? p->promise : gain; /* limits of goals may bend so far that a corrected step goes back */
        bool promises = promise > converged * before && 2 * promise > p->noise * p->noise;
        if ((status == HF_OK || status == HF_RATIO_CAP) && !promises) r->stop = HF_POLISH_CONVERGED;
        status = HF_OK;
        if (after < before) {
            keep(p);
            r->merit = merit;
            learn_pressure(p);
            double share = 2 * (before - after) / gain - 1;
            if (gain > 0) damping = fmax(DAMPING_LEAST, damping * fmax(0.1, 1 - share * share * share));
            growth = 2;
            if (r->stop == HF_POLISH_MAX_ITERATIONS) status = linearise(p);
        } else {
            damping *= growth;
            growth *= 2;
            if (damping > DAMPING_MOST) r->stop = HF_POLISH_STALLED;
        }
    }
    if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
    if (status != HF_OK) r->stop = HF_POLISH_STALLED;
    return HF_OK;
}

/* What holds the design, whose shape is in the workspace. */
static void count_limits(const problem *p, const double *design, hf_polish_result *r)
{
    hf_limit_held held[HF_LIMITS_HELD];
    for (int k = 0; k < p->v.model->n_gene; k++) {
        int i = p->slopes.variable_of_gene[k];
        double inside = is_tension(p, k) ? LIMIT_INSIDE * design[k] : LIMIT_ROUNDING * p->unit[i];
        r->n_at_lower += design[k] <= p->lower[k] + inside;
        r->n_at_upper += design[k] >= p->upper[k] - inside;
    }
    for (int i = 0, n = hf_limits_held(p->caller, p->w, held); i < n; i++) {
        r->is_at_cap |= held[i].row == HF_LIMITS_CAP;
        if (held[i].row != HF_LIMITS_CAP) r->n_at_limit += held[i].n;
    }
}

/* The best design, in the caller's meaning, replaces `design` if its own evaluation keeps all limits and is not worse
 * than the start; else the start stays, without multipliers, which are not its own. */
static hf_status hand_over(const problem *p, const hf_form_result *start, double *design, hf_polish_result *r)
{
    hf_form_result end;
    bool is_better = hf_evaluate(p->caller, p->best, p->w, &end) == HF_OK &&
                     !hf_watch_breaks(p->trade, p->v.goals, HF_LIMITS_AT, end.goal) &&
                     (start->status != HF_OK || merit_of(p, &end) <= merit_of(p, start));
    if (!is_better && start->status != HF_OK) return start->status;
    if (is_better) memcpy(design, p->best, (size_t)p->v.model->n_gene * sizeof(double));
    if (!is_better) {
        r->stop = HF_POLISH_STALLED;
        forget_multipliers(r);
        HF_TRY(hf_evaluate(p->caller, design, p->w, &end));
    }
    r->merit = merit_of(p, &end);
    count_limits(p, design, r);
    return HF_OK;
}

hf_status hf_polish_trade(const hf_evaluator *evaluator, const double *lower, const double *upper, int max_iterations,
                          const hf_watch_trade *trade, double *design, hf_workspace *w, hf_polish_result *result)
{
    problem p = {.v = *evaluator, .caller = evaluator, .lower = lower, .upper = upper, .w = w, .trade = trade};
    hf_form_result start;
    hf_arena arena = {0};
    *result = (hf_polish_result){.stop = HF_POLISH_MAX_ITERATIONS};
    p.v.by_density = true;
    p.v.boundary_ratio_cap = INFINITY;
    p.v.limits = NULL;
    hf_evaluate(evaluator, design, w, &start);
    if (!hf_status_has_shape(start.status)) return start.status;
    p.is_outside = start.status != HF_OK;
    result->merit = result->start_merit = merit_of(&p, &start);
    hf_status status = create(&p, &arena);
    if (status == HF_OK) {
        begin(&p, design);
        if (start.status == HF_OK && hf_watch_breaks(trade, evaluator->goals, 0, start.goal))
            start.status = HF_OUT_OF_LIMITS;
        status = minimise(&p, max_iterations, result);
        if (status == HF_OK && p.is_outside) status = start.status == HF_OK ? HF_OUT_OF_LIMITS : start.status;
        if (status == HF_OK && trade) status = find_multipliers(&p, result);
        result->evaluations = p.evaluations;
        if (status == HF_OK) status = hand_over(&p, &start, design, result);
    }
    destroy(&p, &arena);
    return status;
}

hf_status hf_polish_run(const hf_evaluator *evaluator, const double *lower, const double *upper, int max_iterations,
                        double *design, hf_workspace *w, hf_polish_result *result)
{
    return hf_polish_trade(evaluator, lower, upper, max_iterations, NULL, design, w, result);
}
