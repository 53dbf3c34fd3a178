/* Implements Levenberg-Marquardt with linear limits on each step. refine.h describes the interface, refine_problem.c
 * the variables and derivatives, refine_cost.c counts operations, and watch.c has the limits on tensions, deflections
 * and objectives.
 *
 *     design -> evaluate -> linearise: residuals f, J'J, J'f, limits
 *     step   -> quadratic programme -> trial -> limits broken? -> solve again with the values found there
 *            -> gain below the promised one? -> correct the step for the curvature of f
 *            -> merit lower? -> keep the trial, less damping, linearise
 *            -> merit not lower? -> more damping
 *     end    -> converged, settled, stalled or max_iterations -> best design
 *
 * A start outside the limits is first moved into them (enter).
 * Contents: one step - the run - a maximum of psi - the call */
#include "search/refine.h"

#include "base/elementary.h"
#include "linalg/dot.h"
#include "net/symmetry.h"
#include "search/refine_problem.h"
#include "solve/certificate.h"
#include "solve/limits.h"

#include <math.h>
#include <string.h>

/* Brackets contain the range in which no test of this module and of cli/limits fails, as far as it was tried. */
#define GAIN_CONVERGED 1e-12    /* converged: a step promises less than this part of merit^2 [1e-15 to 1e-8] */
#define UNDAMPED_CONVERGED 1e-6 /* converged: without damping, the model promises less than this part of the merit */
#define DAMPING_TOO_MUCH 1e-3   /* factor of a damping that has hidden what the model promises */
#define FRONT_CONVERGED 1e-20   /* converged, for a point of a front: its multipliers must be accurate */
#define DAMPING_FIRST 1e-3      /* first damping, relative to the squared columns of J [1e-6 to 1] */
/* The multipliers and the gain that the model still predicts are found with this damping, which is nearly none. */
#define DAMPING_NEARLY_NONE 1e-9
/* The damping of steps by the saddle-point system is relative to the merit (saddle_step.h). With less of it first, many
 * bounds become active at once. One step lowers it to no less than the part SPARSE_FALL, because corrected steps hide
 * how curved a valley is. */
#define SPARSE_DAMPING_FIRST 1
#define SPARSE_FALL 0.3
#define SCALE_LEAST 1e-8    /* a column of J below this part of the maximum one is damped like the maximum */
#define DAMPING_LEAST 1e-14 /* minimum damping [1e-20 to 1e-8] */
#define DAMPING_MOST 1e12   /* stalled: with more damping, a step is too short to change psi [1e4 to 1e24] */
#define CORRECTIONS_MAX 4   /* corrections of a step that breaks limits [40 passes; with 1, runs stall at a cap] */
#define DAMPING_OF_WAY 1e3  /* damping on the way into the limits, if less damping fails [1e8 passes; 1 fails] */
#define WAY_GROWTH 10       /* then a step that fails raises the damping by this factor [3 and 100 pass] */
#define WAY_LEAST 1e-3      /* minimum part of the way into the limits that a step takes [1e-2; 1e-6] */
/* The way ends outside if as many steps together come less than WAY_GAIN nearer: what is broken cannot be met. Steps
 * that fail halve the way and raise the damping, so there must be more than about 20. A point of a front may be found
 * only on the long way along a curved limit. */
#define WAY_STEPS 25
#define WAY_GAIN 0.01
/* Factors of the pretension that a start outside the requirements tries before the first step: powers of SCALE_BY. */
#define SCALE_BY 1.25
#define SCALES_MAX 12
#define SCALE_WORSE 2 /* a factor that leads this much farther away is the last one in its direction */
/* A tension within this relative distance of its bound counts as being at it. This is twice the distance that a step
 * keeps. */
#define LIMIT_INSIDE (2 * HF_WATCH_INSIDE)
#define LIMIT_ROUNDING 1e-12 /* a relative violation below this value is rounding [1e-14 to 1e-10] */
#define BENDS_MAX 4          /* corrections of a step for the curvature of its residuals [2 to 4] */
/* A step that gains more than this part of what it promises needs no such correction [0.65 to 0.75; 0.5 fails]. */
#define BEND_BELOW 0.65
/* A run has settled if SETTLED_STEPS successive steps each promise less than SETTLED_GAIN of the merit and together
 * gain less, and if the model without damping promises less, too. At a corner or a jump of an objective, the model
 * always promises more. There, twice as many steps suffice. An objective of little weight may still improve when the
 * merit hardly changes, so no weight x objective may change by more than SETTLED_OBJECTIVE of the merit. METHOD
 * section 7 has the measurements. */
/* A step that promises less than SETTLED_SLOW of the one before does not count: such a run converges soon. */
#define SETTLED_STEPS 5
#define SETTLED_SLOW 0.25
#define SETTLED_GAIN 1e-4
#define SETTLED_OBJECTIVE 1e-3
#define BEAT_PART 10 /* a run may gain as many times what the undamped model promises [measured: up to 3.5] */
/* An objective replaces a maximum of psi. Its weight is adapted until the other objectives could gain less than
 * ROOM_LEFT of their merit by more psi. WEIGHT_STEP is the largest factor of one adaptation while psi has been on
 * one side of the maximum only. A maximum out of reach is given up if psi falls by less than OUT_OF_REACH in such
 * a step. */
#define ROOM_LEFT 1e-6
#define ROOM_LEFT_UNUSED 1e-5 /* the same if psi is below half of the maximum, which then has little effect */
#define OTHERS_ZERO 1e-10     /* a part of the merit of the others at the start that counts as zero */
#define OTHERS_ROUNDING 1e-14 /* their merit, in SI units, below which it is rounding */
#define WEIGHT_STEP 10
#define LOOSEN 0.7        /* factor of the first weight after a step inside the maximum [0.3 to 0.9] */
#define ROUNDING_STEP 1e3 /* factor of a weight with which the merit is rounding */
#define WEIGHTS_MAX 20
/* With a weight below LOW_WEIGHT times one with which psi was above the maximum, psi cannot be below LOW_PSI of it. */
#define LOW_WEIGHT 1.1
#define LOW_PSI 0.9
#define OUT_OF_REACH 1e-3
#define NOISE_MOST 1e-3  /* a weight is too large if rounding may change the merit by this part of the others */
#define ROOM_INSIDE 1e-7 /* the part of the maximum below it at which psi is sought */
/* The maximum is lower by ROOM_CERTIFIED times the certified bound of the error of psi at the start, unless that is
 * more than ROOM_MOST of the maximum. */
#define ROOM_CERTIFIED 4
#define ROOM_MOST 0.1
/* The first weight is that of no smaller part of the largest coordinate, because rounding of positions would hide the
 * merit, or in J'J of dense steps the curvature of the other objectives. */
#define LEAST_ROOM 1e-11
#define LEAST_ROOM_DENSE 1e-6
#define BEND_WORTH 0.5 /* a correction is the last one if it leaves more than this part of the merit [0.5 to 0.9] */
/* The same for steps by the saddle-point system, whose corrections need no derivatives. Such a step may also break
 * limits before it is corrected. A correction that gains less than the part SPARSE_WORTH of the promise is the last
 * one, and so is one that multiplies the merit by SPARSE_DIVERGES. */
#define SPARSE_BENDS_MAX 8
#define SPARSE_BEND_BELOW 0.9
#define SPARSE_WORTH 0.05
#define SPARSE_DIVERGES 2

#define DENSE_MOST 5000 /* variables for which dense steps may continue a run: 0.6 GB */

/* ---- one step ---- */

/* Finds the limit that the step x violates most, for hf_quadratic_solve. Returns false if no violation exceeds
 * rounding. */
static bool worst_limit(void *context, const double *x, hf_quadratic_limit *limit)
{
    hf_refine_problem *p = context;
    double worst = LIMIT_ROUNDING, sign = 0;
    int only = -1;
    for (int i = 0; i < p->n; i++) {
        double below = (p->down[i] - x[i]) / p->unit[i], above = (x[i] - p->up[i]) / p->unit[i];
        if (!(fmax(below, above) > worst)) continue;
        worst = fmax(below, above);
        sign = below > above ? 1 : -1;
        only = i;
    }
    if (hf_watch_worst(&p->watch, x, worst, limit)) return true;
    if (only < 0) return false;
    limit->kind = 0;
    limit->only = only;
    limit->normal[only] = sign;
    limit->bound = sign * (sign > 0 ? p->down : p->up)[only];
    return true;
}

/* Adds the level of an objective with corners (refine.h) as the last variable of a step: level^2/2 is minimised. */
static void begin_level(hf_refine_problem *p)
{
    int n = p->n, n_step = p->step.n;
    memset(p->hessian + n * n_step, 0, (size_t)n * sizeof(double));
    p->hessian[n * n_step + n] = 1;
    p->gradient[n] = p->watch.level;
    p->down[n] = -INFINITY;
    p->up[n] = INFINITY;
}

/* Evaluates the design at the end of the step, which becomes `trial`. Returns the status of hf_evaluate. */
static hf_status take_step(hf_refine_problem *p)
{
    for (int r = 0; r < p->n; r++)
        p->trial[r] = fmax(p->low[r], fmin(p->high[r], p->at[r] + p->step.x[r]));
    return hf_refine_evaluate(p, p->trial);
}

/* Returns the scale by which variable r is damped: the norm of its column of J, or the maximum scale if that norm is
 * nearly 0. Without damping of such a variable, the minimum of the model would not be unique. */
static double damped_scale(const hf_refine_problem *p, int r)
{
    if (p->scale[r] > SCALE_LEAST * p->largest_scale) return p->scale[r];
    return p->largest_scale > 0 ? p->largest_scale : 1;
}

/* Does the same as solve_step by the saddle-point system, for a step between `down` and `up`. f: NULL, or the residuals
 * at the end of the last step, for which the same model is solved again. A step of which the model promises nothing has
 * too much rounding, except on the way into the limits. */
static hf_status solve_sparse(hf_refine_problem *p, double damping, const double *f, double *gain)
{
    hf_saddle_step_bend(&p->saddle, f);
    hf_saddle_step_limit(&p->saddle, &p->watch);
    HF_TRY(hf_saddle_step_solve(&p->saddle, damping, p->down, p->up, p->unit, p->step.side, p->step.x, gain));
    return f || p->is_outside || *gain >= 0 ? HF_OK : HF_DIFFERENT;
}

/* Finds step.x, the minimum of the model |f + J x|^2/2 + damping |scale x|^2/2 within the limits. *gain receives the
 * decrease of merit^2/2 that the model promises. Returns the status of hf_quadratic_solve. */
static hf_status solve_step(hf_refine_problem *p, double damping, double *gain)
{
    const double *x = p->step.x;
    int n = p->n, n_step = p->step.n;
    for (int r = 0; r < n; r++) {
        p->down[r] = p->low[r] - p->at[r];
        p->up[r] = p->high[r] - p->at[r];
    }
    if (p->is_sparse) return solve_sparse(p, damping, NULL, gain);
    for (int r = 0; r < n; r++) {
        memcpy(p->hessian + r * n_step, p->gram + r * n, (size_t)(r + 1) * sizeof(double));
        p->hessian[r * n_step + r] += damping * damped_scale(p, r) * damped_scale(p, r);
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

/* Solves a step and evaluates its end. Tensions are not linear in the variables, so the step may break a limit on them.
 * It is then solved again with the tensions that were found at its end; bend_step does so for a step by the
 * saddle-point system. Returns HF_OK, HF_RATIO_CAP if a limit is still broken after CORRECTIONS_MAX corrections, or the
 * status of the failure. */
static hf_status try_step(hf_refine_problem *p, double damping, double *gain)
{
    hf_watch_forget(&p->watch);
    for (int again = 0; again <= CORRECTIONS_MAX; again++) {
        HF_TRY(solve_step(p, damping, gain));
        if (again == 0) p->promise = *gain;
        HF_TRY(take_step(p));
        if (hf_watch_keeps(&p->watch, p->w)) return HF_OK;
        p->needs_dense = p->is_sparse && hf_watch_breaks_cap(&p->watch);
        if (p->needs_dense) return HF_RATIO_CAP;
        if (p->is_sparse) return HF_OK;
        hf_watch_learn(&p->watch, p->step.x, p->w);
    }
    return HF_RATIO_CAP;
}

/* Computes `pull` = J'(f(x) - J x), where x is the step taken and f(x) are the residuals found at its end. It is the
 * gradient at a step of zero of the linear model that has these residuals at x. */
static void find_pull(hf_refine_problem *p)
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

/* Solves the step again with the residuals found at its end. */
static hf_status solve_bent(hf_refine_problem *p)
{
    double gain;
    if (p->is_sparse) return solve_sparse(p, p->damping, p->residuals.value, &gain);
    find_pull(p);
    return hf_quadratic_solve(&p->step, p->hessian, p->pull, p->down, p->up, worst_limit, p);
}

/* Returns true if a correction from the merit `last` to that of the last evaluation is worth another one. */
static bool is_worth(const hf_refine_problem *p, double last, double gain)
{
    double merit = p->result.merit;
    return p->is_sparse ? (last - merit) * (last + merit) / 2 > SPARSE_WORTH * gain : merit <= BEND_WORTH * last;
}

/* Corrects a step for the curvature of the residuals: along a curved valley, a step ends on its flank. With the
 * residuals found there, the same matrices lead back to the floor. This is repeated as long as it is worth it. `before`
 * is merit^2/2 before the step, `gain` its promised decrease. If the best merit within the limits is below that before,
 * `trial` and the shape in the workspace become the best ones. Returns HF_OK, HF_RATIO_CAP if no step keeps the limits,
 * HF_NO_MEMORY, HF_INTERRUPTED or the status of the last evaluation. */
static hf_status bend_step(hf_refine_problem *p, double before, double gain)
{
    size_t size = (size_t)p->n * sizeof(double);
    bool is_best = !p->is_sparse || hf_watch_keeps(&p->watch, p->w); /* the step in the workspace is the best one */
    double last = p->result.merit, merit = is_best ? last : (double)INFINITY;
    double below = p->is_sparse ? SPARSE_BEND_BELOW : BEND_BELOW;
    hf_status shape = HF_OK; /* of the last evaluation */
    memcpy(p->step_taken, p->step.x, size);
    for (int again = 0; again < (p->is_sparse ? SPARSE_BENDS_MAX : BENDS_MAX); again++) {
        if (is_best && before - merit * merit / 2 > below * gain) break;
        if (hf_residuals_find(&p->residuals, p->w) != HF_OK) break;
        if (p->is_sparse) hf_saddle_step_learn(&p->saddle, &p->watch);
        hf_status status = solve_bent(p);
        if (status == HF_OK) status = shape = take_step(p);
        if (status == HF_INTERRUPTED || status == HF_NO_MEMORY) return status;
        bool keeps = status == HF_OK && hf_watch_keeps(&p->watch, p->w), goes_on = is_worth(p, last, gain);
        is_best = keeps && p->result.merit < merit;
        if (is_best) {
            merit = p->result.merit;
            memcpy(p->step_taken, p->step.x, size);
        } else {
            goes_on = p->is_sparse && status == HF_OK && !keeps && p->result.merit < SPARSE_DIVERGES * last;
        }
        if (!goes_on) break;
        last = p->result.merit;
    }
    if (is_best) return HF_OK;
    if (!isfinite(merit)) return shape == HF_OK ? HF_RATIO_CAP : shape;
    memcpy(p->step.x, p->step_taken, size);
    if (merit * merit / 2 < before) return take_step(p);
    p->result.merit = merit; /* the step fails, so its shape is not needed */
    return HF_OK;
}

/* ---- the run ---- */

/* Calls the watcher between two iterations, if there is one. Returns its status. */
static hf_status tell_watcher(hf_refine_problem *p, const hf_refine_result *r, int max_iterations)
{
    const hf_refine_watcher *watcher = p->watcher;
    if (!watcher || !watcher->after) return HF_OK;
    if (!p->front) hf_refine_pack(p, r);
    double beyond = p->relaxed ? p->best_psi_m / p->psi_most_m - 1 : 0;
    const hf_refine_progress now = {.iterations = r->iterations,
                                    .max_iterations = max_iterations,
                                    .evaluations = p->evaluations,
                                    .is_last = r->stop != HF_REFINE_MAX_ITERATIONS || r->iterations == max_iterations,
                                    .merit = p->relaxed ? p->best_of_others : r->merit,
                                    .psi_m = p->best_psi_m,
                                    .violation = p->is_outside ? p->violation : fmax(0, beyond),
                                    .n_state = p->front ? 0 : p->n_state,
                                    .state = p->front ? NULL : p->state};
    return p->told = watcher->after(watcher->context, &now);
}

/* Counts a step outside the limits: settled_steps becomes the number of steps since the violation last fell noticeably.
 * Inside, the counters begin anew. */
static void count_way(hf_refine_problem *p)
{
    p->settled_steps++;
    if (p->is_outside && !(p->violation < (1 - WAY_GAIN) * p->settled_merit)) return;
    p->settled_steps = 0;
    p->settled_merit = p->is_outside ? p->violation : (double)INFINITY;
}

/* Sets `trial` to the start with all force densities and tensions multiplied by a factor, within the bounds. Returns
 * false if that changes nothing. Variables that change by the same step take the mean of their steps. */
static bool scale_start(hf_refine_problem *p, double factor)
{
    const hf_model *m = p->v.model;
    bool changes = false;
    memset(p->trial, 0, (size_t)p->n * sizeof(double));
    memset(p->pull, 0, (size_t)p->n * sizeof(double)); /* the number of variables of each class */
    for (int k = 0; k < m->n_variable; k++) {
        hf_variable_sets sets = hf_evaluate_sets(p->caller, k);
        int i = p->slopes.class_of_variable[k];
        p->pull[i]++;
        if (sets == HF_SETS_DENSITY || sets == HF_SETS_TENSION)
            p->trial[i] += (factor - 1) * p->start[k] / hf_symmetry_weight(m, p->v.initial, k);
    }
    for (int i = 0; i < p->n; i++) {
        p->trial[i] = fmax(p->low[i], fmin(p->high[i], p->trial[i] / p->pull[i]));
        changes |= fabs(p->trial[i] - p->at[i]) > LIMIT_ROUNDING * p->unit[i];
    }
    return changes;
}

/* Returns the largest relative distance of the shape in the workspace from a requirement, which is minus the smallest
 * margin. Limits that it breaks count by their sum. */
static double distance_outside(hf_refine_problem *p, bool *is_outside)
{
    const hf_constraints *c = p->v.objectives->constraints;
    double most = -INFINITY, of_limits = hf_watch_violation(&p->watch, p->w);
    *is_outside = !hf_watch_keeps(&p->watch, p->w);
    for (int k = 0; c && k < c->n; k++) {
        double distance = p->watch.constraint[k] / c->unit[k];
        if (!hf_objectives_judges(p->v.objectives, k)) continue;
        most = fmax(most, distance);
        of_limits -= fmax(0, distance);
    }
    return *is_outside ? fmax(most, of_limits) : most;
}

/* Returns true if the merit is rounding of positions: a step would only follow the rounding. */
static bool is_zero(const hf_refine_problem *p, const hf_refine_result *r)
{
    return !p->front && !p->is_outside && r->merit <= hf_refine_rounding(p);
}

/* Returns true if the pretension of the start is scaled before the first step. */
static bool is_scaled_first(const hf_refine_problem *p, int max_iterations, const hf_refine_result *r)
{
    return p->is_outside && r->iterations == 0 && max_iterations > 0 && !p->front &&
           (p->relaxed || hf_refine_n_constraint(p) > 0);
}

/* Multiplies the pretension of a start that breaks a requirement by the factor that leads farthest into all of them, or
 * nearest. A slack cable has no derivative that leads out, but a higher pretension does. Counts as one iteration.
 * Returns HF_OK or the status of the failure. */
static hf_status scale_into(hf_refine_problem *p, hf_refine_result *r)
{
    bool is_outside;
    double start = distance_outside(p, &is_outside), nearest = start;
    r->iterations++;
    for (int sign = 1; sign >= -1 && nearest == start; sign -= 2)
        for (int i = 1; i <= SCALES_MAX && scale_start(p, pow(SCALE_BY, sign * i)); i++) {
            hf_status status = hf_refine_evaluate(p, p->trial);
            if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
            double distance = status == HF_OK ? distance_outside(p, &is_outside) : (double)INFINITY;
            if (distance > (nearest > 0 ? SCALE_WORSE * nearest : nearest)) break;
            if (!(distance < nearest)) continue;
            nearest = distance;
            p->is_outside = true; /* the nearest design is kept, whatever its objectives are */
            hf_refine_keep(p);
            p->is_outside = is_outside;
        }
    HF_TRY(hf_refine_evaluate(p, p->at));
    p->violation = hf_watch_violation(&p->watch, p->w);
    r->merit = hf_refine_merit(p, &p->result);
    return is_zero(p, r) ? HF_OK : hf_refine_linearise(p);
}

/* Moves a start from outside into the limits. Each step aims at a part (`way`) of the way to the linear limits. Limits
 * are not linear: if the step does not come nearer to them, the next one takes half of that part, otherwise twice. Near
 * a curved limit, the part of a step that lowers the merit leads away from the limit. If small parts of the way do not
 * succeed, more and more damping therefore reduces that part of the step. Returns HF_OK, also if it stays outside, or
 * the status of the failure. */
static hf_status enter(hf_refine_problem *p, int max_iterations, hf_refine_result *r)
{
    double gain;
    p->needs_dense = p->is_sparse && hf_watch_breaks_cap(&p->watch);
    if (p->needs_dense) return HF_OK;
    hf_watch_forget(&p->watch);
    if (is_scaled_first(p, max_iterations, r)) {
        HF_TRY(scale_into(p, r));
        HF_TRY(tell_watcher(p, r, max_iterations));
    }
    while (p->is_outside && p->damping <= DAMPING_MOST && (p->front || p->settled_steps < WAY_STEPS) &&
           r->iterations < max_iterations) {
        if (p->way <= WAY_LEAST) {
            p->damping = DAMPING_OF_WAY;
            p->way = 1;
        }
        r->iterations++;
        hf_watch_aim(&p->watch, p->way);
        if (p->is_sparse) hf_watch_forget(&p->watch);
        hf_status status = solve_step(p, p->damping, &gain);
        if (status == HF_OK || (p->is_sparse && status == HF_DIFFERENT)) status = take_step(p);
        if (status == HF_OK && p->is_sparse) {
            status = bend_step(p, INFINITY, gain);
            if (status == HF_RATIO_CAP) status = HF_OK; /* it may still be nearer */
        }
        if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
        double after = status == HF_OK ? hf_watch_violation(&p->watch, p->w) : (double)INFINITY;
        bool is_inside = status == HF_OK && hf_watch_keeps(&p->watch, p->w),
             is_nearer = is_inside || after < p->violation;
        if (is_nearer) {
            p->way = fmin(1, 2 * p->way);
            p->violation = after;
            hf_refine_keep(p);
            p->is_outside = !is_inside;
            if (is_inside) p->damping = p->is_sparse ? SPARSE_DAMPING_FIRST : DAMPING_FIRST;
            r->merit = hf_refine_merit(p, &p->result);
            HF_TRY(hf_refine_linearise(p));
        } else if (p->damping < DAMPING_OF_WAY) {
            p->way /= 2;
        } else {
            p->damping *= WAY_GROWTH;
        }
        count_way(p);
        HF_TRY(tell_watcher(p, r, max_iterations));
    }
    return HF_OK;
}

/* Stores the multipliers of the last step for each objective. */
static void learn_pressure(hf_refine_problem *p)
{
    int objective;
    memset(p->pressure, 0, sizeof p->pressure);
    for (int i = 0; i < p->step.n_active; i++) {
        const hf_quadratic_active *a = &p->step.active[i];
        if (a->kind < HF_WATCH_OBJECTIVE) continue;
        double relief = hf_watch_relief(&p->watch, a->kind, &objective);
        p->pressure[objective] += relief * a->multiplier;
    }
}

static void forget_multipliers(hf_refine_result *r)
{
    for (int k = 0; k < HF_DESIGN_ROWS_MAX; k++)
        r->multiplier[k] = NAN;
}

/* Computes the multipliers of the linear model at the best design, nearly without damping. They are NaN if the model
 * has no solution. Returns HF_OK, HF_NO_MEMORY or HF_INTERRUPTED. */
static hf_status find_multipliers(hf_refine_problem *p, hf_refine_result *r)
{
    double gain, merit;
    forget_multipliers(r);
    hf_status status = hf_refine_evaluate(p, p->at);
    if (status == HF_OK) status = hf_refine_linearise(p);
    hf_watch_forget(&p->watch);
    if (status == HF_OK) status = solve_step(p, DAMPING_NEARLY_NONE, &gain);
    if (status != HF_OK) return status == HF_NO_MEMORY || status == HF_INTERRUPTED ? status : HF_OK;
    learn_pressure(p);
    merit = hf_refine_merit(p, &p->result);
    merit = sqrt(fmax(0, merit * merit - 2 * gain)); /* merit at the minimum of the linear model, a small step away */
    for (int k = 0; k < p->v.objectives->n_objective; k++) {
        r->multiplier[k] = p->pressure[k] > 0 ? p->pressure[k] / merit : 0;
        if (p->v.objectives->objective[p->front->least].settings.figure == HF_FIGURE_RATIO)
            r->multiplier[k] *= exp(merit);
    }
    r->multiplier[p->front->least] = NAN;
    return HF_OK;
}

/* Returns the part of the merit by which a decrease `gain` of merit^2/2 lowers it. */
static double part_of(double gain, double merit)
{
    return merit > 0 ? 1 - sqrt(fmax(0, 1 - 2 * gain / (merit * merit))) : 0;
}

/* Returns the part of the merit by which the model, nearly without damping, would lower it from the best design, at
 * which it is linear. Returns NaN if the model has no solution. The next steps keep their bits. */
static double predict(hf_refine_problem *p, double merit)
{
    double gain;
    size_t size = (size_t)p->step.n * sizeof(int);
    memcpy(p->side, p->step.side, size);
    hf_watch_forget(&p->watch);
    hf_status status = solve_step(p, DAMPING_NEARLY_NONE, &gain);
    memcpy(p->step.side, p->side, size);
    return status == HF_OK ? part_of(fmax(0, gain), merit) : (double)NAN;
}

/* Returns true if the model, nearly without damping, promises more than rounding, although a step promises nothing.
 * Such a run has not converged. */
static bool is_hidden(hf_refine_problem *p, double merit)
{
    return !p->front && predict(p, merit) > fmax(UNDAMPED_CONVERGED, part_of(p->noise * p->noise / 2, merit));
}

/* Counts a step: settled_steps becomes the number of steps since one promised more than SETTLED_GAIN of the merit,
 * since the run last converged fast, or since the merit or an objective last changed noticeably. */
static void count_settled(hf_refine_problem *p, double merit, double promised_part, bool is_kept)
{
    const hf_objectives *objectives = p->v.objectives;
    bool is_fast = is_kept && promised_part < SETTLED_SLOW * p->promised_before;
    bool changes = is_fast || promised_part > SETTLED_GAIN || merit < (1 - SETTLED_GAIN) * p->settled_merit;
    for (int k = 0; is_kept && objectives && k < objectives->n_objective; k++)
        changes |= objectives->objective[k].settings.weight * fabs(p->result.objective[k] - p->settled_objective[k]) >
                   SETTLED_OBJECTIVE * merit;
    p->promised_before = is_kept ? promised_part : 0;
    p->settled_steps++;
    if (!changes) return;
    p->settled_steps = 0;
    p->settled_merit = merit;
    if (is_kept) memcpy(p->settled_objective, p->result.objective, sizeof p->settled_objective);
}

/* Returns true if the run has settled. In a flat curved valley, each step promises far more than the next one gains,
 * so the promised gain alone would not end the run. A run that continues a finished one never settles, and one whose
 * predicted merit remains above `beat` settles at its first small step. is_kept: the model has changed since the last
 * call. */
static bool is_settled(hf_refine_problem *p, double merit, bool is_kept)
{
    const hf_refine_watcher *of = p->watcher;
    bool is_flat = p->settled_steps >= SETTLED_STEPS, is_race = of && of->beat > 0 && !p->relaxed;
    if (p->front || (of && of->is_more) || p->settled_steps == 0) return false;
    if (p->settled_steps >= 2 * SETTLED_STEPS) return true;
    if (!is_kept || !(is_flat || is_race)) return false;
    double part = predict(p, merit);
    return part < SETTLED_GAIN && (is_flat || merit * (1 - BEAT_PART * part) > of->beat);
}

/* Returns true if rounding hardly changes the merit of the other objectives. */
static bool is_exact(const hf_refine_problem *p)
{
    return p->noise < NOISE_MOST * p->others;
}

/* Returns the next weight of the objective that replaces a maximum of psi, or 0 if the last one is final. */
static double next_weight(hf_refine_problem *p)
{
    double most = p->psi_most_m, weight = p->psi_weight, ratio = p->psi_m / most, before = p->psi_low_m;
    bool exact = is_exact(p);
    if (p->psi_m <= most) {
        if (p->others <= p->zero) return 0;
        double left = ratio < 0.5 ? ROOM_LEFT_UNUSED : ROOM_LEFT;
        if (exact && weight * weight * p->psi_m * (most - p->psi_m) < left * p->others * p->others) return 0;
        p->weight_high = weight;
        p->psi_high_m = p->psi_m;
        if (ratio < LOW_PSI && weight < LOW_WEIGHT * p->weight_low) p->weight_low = 0; /* its run was not at its end */
    } else {
        if (exact && p->weight_low > 0 && p->weight_high == 0 && p->psi_m > (1 - OUT_OF_REACH) * before) return 0;
        p->weight_low = weight;
        p->psi_low_m = p->psi_m;
    }
    if (++p->n_weight > WEIGHTS_MAX) return 0;
    if (p->weight_high == 0) return weight * (exact ? fmax(2, fmin(ratio * ratio, WEIGHT_STEP)) : ROUNDING_STEP);
    if (p->weight_low == 0) return weight * fmin(sqrt(ratio), 0.5); /* psi grows by at most the square of that */
    double part = log((1 - ROOM_INSIDE) * most / p->psi_low_m) / log(p->psi_high_m / p->psi_low_m);
    return p->weight_low * pow(p->weight_high / p->weight_low, fmax(0.1, fmin(part, 0.9)));
}

/* Continues a run that has ended with the next weight, unless the last one is final. Returns HF_OK or the status of the
 * failure. */
static hf_status reweigh(hf_refine_problem *p, hf_refine_result *r)
{
    double weight = next_weight(p);
    if (p->n_weight > WEIGHTS_MAX && is_exact(p)) r->stop = HF_REFINE_STALLED;
    if (p->psi_m <= p->psi_most_m && p->others <= p->zero) r->stop = HF_REFINE_CONVERGED;
    if (weight == 0) return HF_OK;
    hf_refine_weigh(p, weight);
    p->damping = p->is_sparse ? SPARSE_DAMPING_FIRST : DAMPING_FIRST;
    p->growth = 2;
    p->settled_steps = 0;
    p->settled_merit = INFINITY;
    p->promised_before = p->largest_scale = 0;
    memset(p->scale, 0, (size_t)p->n * sizeof(double));
    r->stop = HF_REFINE_MAX_ITERATIONS;
    HF_TRY(hf_refine_evaluate(p, p->at));
    r->merit = hf_refine_merit(p, &p->result);
    return hf_refine_linearise(p);
}

/* Notes psi and the other objectives at the start of a run or of its resumption. */
static void note_start(hf_refine_problem *p, const hf_refine_result *r)
{
    p->psi_m = p->result.psi_m;
    p->others = hf_refine_others(p, &p->result);
    if (!p->relaxed || r->iterations > 0) return;
    p->best_psi_m = p->psi_m;
    p->best_of_others = p->others;
}

/* Lowers the first weight of psi if psi is below its maximum and a smaller weight lets the merit of the others fall by
 * more than the last step, which promised `promised_part`. With a weight that is too large, steps are short. */
static void loosen(hf_refine_problem *p, double promised_part, hf_refine_result *r)
{
    double w = p->psi_weight, room_m = p->psi_most_m - p->psi_m;
    if (!p->relaxed || p->weight_low > 0 || !(w * w * p->psi_m * room_m > promised_part * p->others * p->others))
        return;
    hf_refine_weigh(p, w * fmin(sqrt(p->psi_m / p->psi_most_m), LOOSEN));
    r->merit = hypot(p->others, p->psi_weight * p->psi_m);
}

/* Moves to the end of a step, which has gained this part of what it promised. Returns HF_OK or the status of the
 * failure. */
static hf_status accept(hf_refine_problem *p, double merit, double part, double promised_part, hf_refine_result *r)
{
    double share = 2 * part - 1;
    hf_refine_keep(p);
    r->merit = merit;
    learn_pressure(p);
    if (r->stop == HF_REFINE_MAX_ITERATIONS) loosen(p, promised_part, r);
    if (part > 0 && isfinite(part))
        p->damping =
            fmax(DAMPING_LEAST, p->damping * fmax(p->is_sparse ? SPARSE_FALL : 0.1, 1 - share * share * share));
    p->growth = 2;
    return r->stop == HF_REFINE_MAX_ITERATIONS ? hf_refine_linearise(p) : HF_OK;
}

/* Takes steps until the run has converged, settled or stalled, or until max_iterations is reached. A point of a front
 * needs accurate multipliers, so its steps must promise far less, and it never settles. The damping follows Nielsen
 * (Madsen, Nielsen, Tingleff, Methods for non-linear least squares problems, DTU 2004). Returns HF_OK, HF_NO_MEMORY,
 * HF_INTERRUPTED or the status of the watcher. */
static hf_status minimise(hf_refine_problem *p, int max_iterations, hf_refine_result *r)
{
    double gain = 0, converged = p->front ? FRONT_CONVERGED : GAIN_CONVERGED;
    hf_status status = hf_refine_evaluate(p, p->at);
    note_start(p, r);
    if (status == HF_OK && !is_zero(p, r) && !is_scaled_first(p, max_iterations, r)) status = hf_refine_linearise(p);
    if (status == HF_OK && p->front) {
        r->merit = hf_refine_merit(p, &p->result);
        p->is_outside = !hf_watch_keeps(&p->watch, p->w);
    }
    if (status == HF_OK && p->is_outside && r->iterations == 0) p->violation = hf_watch_violation(&p->watch, p->w);
    /* A resumed run that has ended already keeps its state. The model at its end is newer than that state. */
    if (status == HF_OK && r->stop == HF_REFINE_MAX_ITERATIONS) HF_TRY(tell_watcher(p, r, max_iterations));
    if (status == HF_OK && p->is_outside) status = enter(p, max_iterations, r);
    while (status == HF_OK && !p->is_outside && r->stop == HF_REFINE_MAX_ITERATIONS && r->iterations < max_iterations) {
        double before = r->merit * r->merit / 2;
        if (is_zero(p, r)) {
            r->stop = HF_REFINE_CONVERGED;
            HF_TRY(tell_watcher(p, r, max_iterations));
            break;
        }
        r->iterations++;
        status = try_step(p, p->damping, &gain);
        if (p->needs_dense) {
            r->iterations--;
            return HF_OK;
        }
        if (status == HF_OK && !p->front) status = bend_step(p, before, gain);
        if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
        double merit = hf_refine_merit(p, &p->result), after = status == HF_OK ? merit * merit / 2 : (double)INFINITY;
        /* Limits may be so curved that a corrected step leads back. The promise is then that of the first solve. */
        double promise = p->front || status == HF_RATIO_CAP ? p->promise : gain;
        bool promises = promise > converged * before && 2 * promise > p->noise * p->noise;
        bool is_last = (status == HF_OK || status == HF_RATIO_CAP) && !promises, is_kept = after < before;
        if (is_last) r->stop = HF_REFINE_CONVERGED;
        if (is_last && is_hidden(p, r->merit)) {
            r->stop = is_kept ? HF_REFINE_MAX_ITERATIONS : HF_REFINE_STALLED;
            p->damping *= DAMPING_TOO_MUCH;
        }
        status = HF_OK;
        double promised_part = part_of(p->front ? promise : gain, r->merit);
        count_settled(p, is_kept ? merit : r->merit, promised_part, is_kept);
        if (is_kept) {
            status = accept(p, merit, (before - after) / gain, promised_part, r);
        } else {
            p->damping *= p->growth;
            p->growth *= 2;
            if (p->damping > DAMPING_MOST) r->stop = HF_REFINE_STALLED;
        }
        if (status == HF_OK && r->stop == HF_REFINE_MAX_ITERATIONS && is_settled(p, r->merit, is_kept))
            r->stop = HF_REFINE_SETTLED;
        r->is_beaten = r->stop == HF_REFINE_SETTLED && p->settled_steps < SETTLED_STEPS;
        if (status == HF_OK && p->relaxed && r->stop != HF_REFINE_MAX_ITERATIONS) status = reweigh(p, r);
        if (status == HF_OK) HF_TRY(tell_watcher(p, r, max_iterations));
    }
    if (status == HF_OK && !p->front && !p->is_outside)
        r->predicted_gain = r->stop == HF_REFINE_CONVERGED ? 0 : predict(p, r->merit);
    if (status == HF_NO_MEMORY || status == HF_INTERRUPTED || status == p->told) return status;
    if (status != HF_OK) r->stop = HF_REFINE_STALLED;
    return HF_OK;
}

/* Counts the bounds and limits that are active at the design, whose shape is in the workspace. */
static void count_limits(const hf_refine_problem *p, const double *design, hf_refine_result *r)
{
    hf_limit_held held[HF_LIMITS_HELD];
    for (int k = 0; k < p->v.model->n_variable; k++) {
        int i = p->slopes.class_of_variable[k];
        double inside = hf_refine_is_tension(p, k) ? LIMIT_INSIDE * design[k] : LIMIT_ROUNDING * p->unit[i];
        r->n_at_lower += design[k] <= p->lower[k] + inside;
        r->n_at_upper += design[k] >= p->upper[k] - inside;
    }
    for (int i = 0, n = hf_limits_held(p->caller, p->w, held); i < n; i++) {
        r->is_at_cap |= held[i].row == HF_LIMITS_CAP;
        if (held[i].row != HF_LIMITS_CAP) r->n_at_limit += held[i].n;
    }
}

/* Returns true if the end of a run is not worse than a start within the limits. If an objective replaces a maximum of
 * psi, a start that keeps the maximum is worse only than ends that keep it, too, by the other objectives. */
static bool is_not_worse(const hf_refine_problem *p, const hf_form_result *end, const hf_form_result *start)
{
    if (!p->relaxed) return hf_refine_merit(p, end) <= hf_refine_merit(p, start);
    double most_m = p->relaxed->constraints->psi_most_m;
    if (start->psi_m > most_m) return end->psi_m <= start->psi_m;
    return end->psi_m <= most_m && hf_refine_others(p, end) <= p->others_at_start;
}

/* Replaces `design` by the best design if the caller's evaluator finds that it keeps all limits and is not worse than
 * the start. Otherwise the start remains, without multipliers, which belong to another design. Returns HF_OK, or the
 * status of a start outside the limits if nothing feasible was found. */
static hf_status hand_over(const hf_refine_problem *p, const hf_form_result *start, double *design, hf_refine_result *r)
{
    hf_form_result end;
    hf_objectives_point *point = hf_residuals_point(&p->residuals);
    bool is_better = hf_evaluate(p->caller, p->best, p->w, point, &end) == HF_OK &&
                     !hf_watch_breaks(p->front, p->v.objectives, HF_LIMITS_AT, end.objective) &&
                     (start->status != HF_OK || is_not_worse(p, &end, start));
    if (!is_better && start->status != HF_OK) return start->status;
    if (is_better) memcpy(design, p->best, (size_t)p->v.model->n_variable * sizeof(double));
    if (!is_better) {
        r->stop = HF_REFINE_STALLED;
        r->predicted_gain = NAN;
        forget_multipliers(r);
        HF_TRY(hf_evaluate(p->caller, design, p->w, point, &end));
    }
    r->merit = hf_refine_merit(p, &end);
    count_limits(p, design, r);
    return HF_OK;
}

/* Returns true if steps by the saddle-point system have led no farther, and dense steps continue from the best design:
 * after the cap, outside the limits, or stalled. There must be memory for them, except that the cap needs them. */
static bool lacks_steps(hf_refine_problem *p, hf_refine_result *r)
{
    bool is_stuck = p->is_outside || (r->stop == HF_REFINE_STALLED && p->damping > DAMPING_MOST && !p->relaxed);
    p->needs_dense |= p->is_sparse && p->n <= DENSE_MOST && is_stuck && r->iterations > 0;
    if (!p->needs_dense) return false;
    r->stop = HF_REFINE_MAX_ITERATIONS;
    p->damping = DAMPING_FIRST;
    p->growth = 2;
    p->way = 1;
    p->settled_steps = 0;
    return true;
}

/* Refines the design whose result is `start` and whose shape is in the workspace. Returns what hf_refine_run does. */
static hf_status refine_from(hf_refine_problem *p, int max_iterations, hf_form_result *start, double *design,
                             hf_refine_result *r)
{
    const hf_refine_watcher *watcher = p->watcher;
    if (!hf_status_has_shape(start->status)) return start->status;
    p->is_outside = start->status != HF_OK;
    p->best_psi_m = start->psi_m;
    r->merit = r->start_merit = hf_refine_merit(p, start);
    p->others_at_start = hf_refine_others(p, start);
    hf_refine_begin(p, design);
    if (watcher && watcher->state) hf_refine_resume(p, watcher->n_state, watcher->state, r);
    if (start->status == HF_OK && hf_watch_breaks(p->front, p->caller->objectives, 0, start->objective))
        start->status = HF_OUT_OF_LIMITS;
    HF_TRY(minimise(p, max_iterations, r));
    if (lacks_steps(p, r)) return HF_OK;
    /* The nearest design shows what cannot be met, unless psi, which had become an objective, is beyond its maximum. */
    if (p->is_outside && !p->front && !(p->relaxed && p->best_psi_m > p->psi_most_m))
        memcpy(design, p->best, (size_t)p->v.model->n_variable * sizeof(double));
    if (p->is_outside) return start->status == HF_OK ? HF_OUT_OF_LIMITS : start->status;
    if (p->front) HF_TRY(find_multipliers(p, r));
    return hand_over(p, start, design, r);
}

/* Runs with the settings of `p`, which hf_refine_destroy frees in any case. */
static hf_status run_once(hf_refine_problem *p, int max_iterations, double *design, hf_refine_result *r)
{
    hf_form_result start;
    *r = (hf_refine_result){.stop = HF_REFINE_MAX_ITERATIONS, .predicted_gain = NAN};
    HF_TRY(hf_refine_create(p));
    hf_evaluate(p->caller, design, p->w, hf_residuals_point(&p->residuals), &start);
    hf_status status = refine_from(p, max_iterations, &start, design, r);
    r->evaluations = p->evaluations;
    return status;
}

/* ---- a maximum of psi ---- */

/* The caller's evaluator in which an objective replaces the maximum of psi. Its first weight is E / maximum, where E is
 * the merit of the other objectives at the start. Then all designs whose merit is at most E keep the maximum. */
typedef struct {
    hf_evaluator v;
    hf_objectives objectives;
    double merit;       /* E; 0: nothing is replaced */
    double start_merit; /* of the caller's evaluator; NaN if the start is infeasible */
    double psi_most_m;  /* the maximum, lower by what makes psi certain to keep it */
} relaxation;

/* Returns the merit of the others below which nothing is left to gain. */
static double zero_of(const relaxation *by)
{
    return fmax(OTHERS_ZERO * by->merit, OTHERS_ROUNDING);
}

/* Sets the first weight of a problem that is relaxed. */
static void weigh_first(const relaxation *by, hf_refine_problem *p)
{
    const hf_model *m = p->v.model;
    double largest_m = hf_max_magnitude(3 * (size_t)m->n_node, m->position_m);
    double least = (p->is_sparse ? LEAST_ROOM : LEAST_ROOM_DENSE) * largest_m;
    p->zero = zero_of(by);
    if (p->relaxed) hf_refine_weigh(p, by->merit / fmax(p->psi_most_m, least));
}

/* Returns the maximum of psi that a run aims at from a start, whose shape is in the workspace. The verdict on a psi
 * just below the required maximum would be undecided. A start that keeps the required one keeps this one, too. */
static double certain_maximum_m(const hf_evaluator *of, hf_workspace *w, hf_form_result *start)
{
    double most_m = of->objectives->constraints->psi_most_m;
    hf_certify(of->model, w, start);
    double room_m = ROOM_CERTIFIED * start->psi_bound_m;
    if (!(room_m < ROOM_MOST * most_m)) return most_m;
    return fmax(most_m - room_m, fmin(start->psi_m, most_m));
}

/* Evaluates a design with its objectives, of which it makes and frees the scratch. */
static hf_status evaluate_alone(const hf_evaluator *v, const double *design, hf_workspace *w, hf_form_result *r)
{
    hf_objectives_point point;
    r->status = HF_NO_MEMORY;
    if (hf_objectives_point_create(v->objectives, &point) == HF_OK) hf_evaluate(v, design, w, &point, r);
    hf_objectives_point_free(&point);
    return r->status;
}

/* Makes the relaxation. Without a merit at the start, nothing is replaced. Returns HF_OK or HF_NO_MEMORY. */
static hf_status relax(const hf_evaluator *of, const double *design, hf_workspace *w, relaxation *to)
{
    hf_form_result start;
    hf_objectives *g = &to->objectives;
    int n_row = 3 * of->model->n_inner_node;
    if (evaluate_alone(of, design, w, &start) == HF_NO_MEMORY) return HF_NO_MEMORY;
    to->start_merit = start.merit;
    to->v = *of;
    to->v.objectives = g;
    *g = *of->objectives;
    g->replaces_psi = true;
    bool has_shape = hf_status_has_shape(start.status);
    double merit = has_shape ? hf_refine_norm(g, g->n_objective, &start) : 0;
    if (has_shape) to->psi_most_m = certain_maximum_m(of, w, &start);
    to->merit = isfinite(merit) ? merit : 0;
    g->objective[g->n_objective++] =
        (hf_objective){.settings = {.figure = HF_FIGURE_PSI, .target = NAN, .weight = 1, .mass_kg_per_m = NAN},
                       .n_shape_row = n_row,
                       .first_row = g->n_row,
                       .n_row = n_row};
    g->n_row += n_row;
    return HF_OK;
}

/* Sets the result of a run on the relaxation to that of its design in terms of `of`. Returns the status of the
 * design. */
static hf_status tighten(const hf_evaluator *of, const relaxation *by, const double *design, hf_workspace *w,
                         hf_refine_result *r)
{
    hf_form_result end;
    HF_TRY(evaluate_alone(of, design, w, &end));
    r->start_merit = by->start_merit;
    r->merit = end.merit;
    if (r->stop == HF_REFINE_STALLED) return HF_OK;
    /* At the minimum, the merit falls by weight^2 psi/merit per metre of psi. */
    double weight = by->objectives.objective[by->objectives.n_objective - 1].settings.weight;
    double room_m = by->psi_most_m - end.psi_m;
    double fall = weight * weight * end.psi_m / end.merit;
    double part = end.merit > zero_of(by) ? fall * room_m / end.merit : 0;
    r->predicted_gain = fmax(r->predicted_gain, fmin(1, part));
    if (part > SETTLED_GAIN && r->stop != HF_REFINE_MAX_ITERATIONS) r->stop = HF_REFINE_STALLED;
    return HF_OK;
}

/* ---- the call ---- */

hf_status hf_refine_run(const hf_evaluator *evaluator, const double *lower, const double *upper, int max_iterations,
                        const hf_watch_front *front, const hf_refine_watcher *watcher, double *design, hf_workspace *w,
                        hf_refine_result *result)
{
    hf_refine_problem p = {.v = *evaluator,
                           .caller = evaluator,
                           .lower = lower,
                           .upper = upper,
                           .w = w,
                           .front = front,
                           .watcher = watcher,
                           .damping = DAMPING_FIRST,
                           .growth = 2,
                           .way = 1,
                           .settled_merit = INFINITY};
    relaxation relaxed = {.merit = 0};
    bool has_maximum = !front && hf_refine_has_maximum(evaluator->objectives);
    if (has_maximum) HF_TRY(relax(evaluator, design, w, &relaxed));
    if (relaxed.merit > 0) {
        p.v = relaxed.v;
        p.caller = &relaxed.v;
        p.relaxed = &relaxed.objectives;
        p.psi_most_m = relaxed.psi_most_m;
    }
    p.v.by_density = true;
    p.v.boundary_ratio_cap = INFINITY;
    p.v.limits = NULL;
    hf_refine_problem sparse = p; /* comes first where it is faster */
    sparse.is_sparse = !front && hf_refine_is_sparse(evaluator) && has_maximum == (relaxed.merit > 0) &&
                       !(watcher && hf_refine_was_dense(watcher->n_state, watcher->state));
    sparse.damping = SPARSE_DAMPING_FIRST;
    hf_refine_watcher from_there = watcher ? *watcher : (hf_refine_watcher){0};
    weigh_first(&relaxed, sparse.is_sparse ? &sparse : &p);
    hf_status status = sparse.is_sparse ? run_once(&sparse, max_iterations, design, result) : HF_OK;
    if (sparse.needs_dense) { /* from its best design on */
        hf_refine_pack(&sparse, result);
        from_there.state = sparse.state;
        from_there.n_state = sparse.n_state;
        p.watcher = &from_there;
        weigh_first(&relaxed, &p); /* its state sets another one */
    }
    if (status == HF_OK && (!sparse.is_sparse || sparse.needs_dense)) {
        status = run_once(&p, max_iterations, design, result);
        hf_refine_destroy(&p);
    }
    hf_refine_destroy(&sparse);
    if (status == HF_OK && relaxed.merit > 0) status = tighten(evaluator, &relaxed, design, w, result);
    return status;
}
