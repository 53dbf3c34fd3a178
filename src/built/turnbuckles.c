/* Chooses adjustments a = step * whole number that minimise |r + J a|^2:
 *
 *     rank all turnbuckles by their gain alone ---> SHORT_LIST candidates
 *       ---> for each: fit the list without steps (linalg/quadratic), round, descend by steps of one or two turnbuckles
 *       ---> add the best candidate, then exchange listed turnbuckles for others while that gains
 *       ---> repeat until the target, the number, or the uncertainty ends it
 *
 * A fit is first made without tension limits. Only when it is better and breaks a limit is it repeated with them.
 * Contents: sums of squares, tensions, without steps, in whole steps, which turnbuckles, all steps together, order of
 * adjustments. */
#include "built/turnbuckles.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "linalg/dot.h"
#include "linalg/quadratic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHORT_LIST 12    /* candidates that are fitted in full for each entry of the list */
#define EXCHANGES_MAX 50 /* rounds of exchanges for each length of the list */
#define ROUNDS_MAX 1000  /* rounds of steps of one or two turnbuckles */
#define RIDGE 1e-12      /* relative addition to the diagonal: columns of J may be linearly dependent */
#define BOUND_ROUNDING 1e-9
#define GAIN_ROUNDING 1e-12 /* fraction of the sum of squares below which a reduction is rounding */

/* ---- sums of squares ---- */

double hf_turnbuckles_square(const hf_turnbuckles_problem *p, const int *steps)
{
    double linear = 0, quadratic = 0;
    size_t n = (size_t)p->n;
    for (size_t i = 0; i < n; i++) {
        double row = 0;
        if (!steps[i]) continue;
        for (size_t j = 0; j < n; j++)
            row += p->gram[i * n + j] * steps[j];
        linear += p->slope[i] * steps[i];
        quadratic += row * steps[i];
    }
    return p->square + p->step_m * (2 * linear + p->step_m * quadratic);
}

/* Returns half the derivative of the sum of squares with respect to adjustment i. */
static double slope_at(const hf_turnbuckles_problem *p, const int *steps, int i)
{
    double sum = 0;
    for (int j = 0; j < p->n; j++)
        if (steps[j]) sum += p->gram[(size_t)i * (size_t)p->n + (size_t)j] * steps[j];
    return p->slope[i] + p->step_m * sum;
}

static double gram_of(const hf_turnbuckles_problem *p, int i, int j)
{
    return p->gram[(size_t)i * (size_t)p->n + (size_t)j];
}

/* ---- tensions ---- */

/* Holds the effects of the listed turnbuckles on tensions. */
typedef struct {
    const hf_turnbuckles_problem *p;
    int n;          /* number of listed turnbuckles */
    int *cable;     /* [maximum length of a list] turnbuckle of each row; -1: none */
    double *rate;   /* [maximum length of a list][n_tension] changes of tension per metre */
    int *row;       /* [n of the problem] row of a listed turnbuckle */
    double *fall_N; /* [n_tension] fall of each tension after the present steps */
} tensions;

static const double *rates_of(const tensions *t, int row)
{
    return t->rate + (size_t)row * (size_t)t->p->n_tension;
}

/* Fills the rows for this list. It computes only rows that differ from the previous list, which are few. */
static void take_list(tensions *t, int n, const int *list)
{
    t->n = n;
    for (int k = 0; k < n; k++) {
        t->row[list[k]] = k;
        if (t->cable[k] == list[k]) continue;
        t->p->rates(t->p->context, list[k], t->rate + (size_t)k * (size_t)t->p->n_tension);
        t->cable[k] = list[k];
    }
}

/* Sets fall_N to the fall of each tension after the adjustments adjustment_m [n] of the list. */
static void fall_by(const tensions *t, const double *adjustment_m)
{
    memset(t->fall_N, 0, (size_t)t->p->n_tension * sizeof *t->fall_N);
    for (int k = 0; k < t->n; k++)
        if (adjustment_m[k] != 0) hf_subtract((size_t)t->p->n_tension, adjustment_m[k], rates_of(t, k), t->fall_N);
}

static void fall_by_steps(const tensions *t, const int *steps, double *adjustment_m)
{
    for (int k = 0; k < t->n; k++)
        adjustment_m[k] = steps[t->cable[k]] * t->p->step_m;
    fall_by(t, adjustment_m);
}

/* Returns how far tension k may fall, including rounding. */
static double room_to_fall(const hf_turnbuckles_problem *p, int k)
{
    return p->room_N[k] + BOUND_ROUNDING * (p->room_N[k] + p->reference_N);
}

/* Returns the tension that falls furthest beyond its room, or -1 when none does. */
static int worst_tension(const tensions *t)
{
    double worst = 0;
    int at = -1;
    for (int i = 0; i < t->p->n_tension; i++) {
        double beyond = t->fall_N[i] - room_to_fall(t->p, i);
        if (beyond <= worst) continue;
        worst = beyond;
        at = i;
    }
    return at;
}

/* Adds a steps of turnbuckle i and b of turnbuckle j to fall_N, if no tension that they lower leaves its room. Returns
 * whether it did. */
static bool take_steps(const tensions *t, int i, int j, int a, int b)
{
    const double *u = rates_of(t, t->row[i]), *v = rates_of(t, t->row[j]), step = t->p->step_m;
    for (int k = 0; k < t->p->n_tension; k++) {
        double by = -step * (a * u[k] + b * v[k]);
        if (by > 0 && t->fall_N[k] + by > room_to_fall(t->p, k)) return false;
    }
    for (int k = 0; k < t->p->n_tension; k++)
        t->fall_N[k] -= step * (a * u[k] + b * v[k]);
    return true;
}

/* ---- without steps ---- */

typedef struct {
    int n;
    double max_m;
    const tensions *t; /* NULL: no limits on tensions */
} box;

/* Writes the limit of the tension that falls furthest beyond its room. Returns false when there is none. */
static bool worst_fall(const box *b, const double *x, hf_quadratic_limit *limit)
{
    fall_by(b->t, x);
    int at = worst_tension(b->t);
    for (int k = 0; k < b->n && at >= 0; k++)
        limit->normal[k] = rates_of(b->t, k)[at];
    limit->kind = 1;
    limit->bound = at >= 0 ? -b->t->p->room_N[at] : 0;
    return at >= 0;
}

/* Writes the bound that x violates most, for hf_quadratic. When x violates none, it writes the worst limit on
 * tensions. */
static bool worst_bound(void *context, const double *x, hf_quadratic_limit *limit)
{
    const box *b = context;
    double worst = b->max_m * (1 + BOUND_ROUNDING);
    int at = -1;
    for (int i = 0; i < b->n; i++) {
        if (fabs(x[i]) <= worst) continue;
        worst = fabs(x[i]);
        at = i;
    }
    if (at < 0 && b->t) return worst_fall(b, x, limit);
    if (at < 0) return false;
    limit->kind = 0;
    limit->only = at;
    limit->normal[at] = x[at] < 0 ? 1 : -1;
    limit->bound = -b->max_m;
    return true;
}

/* Finds the best adjustments adjustment_m [n] of a list without rounding to steps. t is NULL without limits on
 * tensions. */
static hf_status fit_list(const hf_turnbuckles_problem *p, int n, const int *list, const tensions *t,
                          double *adjustment_m)
{
    void *block;
    hf_quadratic q;
    double *hessian, *gradient, *lower, *upper, largest = 0;
    box b = {n, p->steps_max * p->step_m, t};
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(hessian, (size_t)n * (size_t)n), HF_ARRAY(gradient, n), HF_ARRAY(lower, n),
                           HF_ARRAY(upper, n)));
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            hessian[i * n + j] = gram_of(p, list[i], list[j]);
        largest = fmax(largest, hessian[i * n + i]);
        gradient[i] = p->slope[list[i]];
        lower[i] = -b.max_m;
        upper[i] = b.max_m;
        adjustment_m[i] = 0;
    }
    for (int i = 0; i < n; i++)
        hessian[i * n + i] += largest > 0 ? RIDGE * largest : 1; /* all entries of a slack cable are 0 */
    hf_status status = hf_quadratic_create(n, &q);
    if (status == HF_OK) status = hf_quadratic_solve(&q, hessian, gradient, lower, upper, worst_bound, &b);
    for (int i = 0; i < n && status == HF_OK; i++)
        adjustment_m[i] = fmin(fmax(q.x[i], -b.max_m), b.max_m);
    hf_arena_free_block(q.block);
    hf_arena_free_block(block);
    return status == HF_NO_MEMORY ? status : HF_OK; /* other failures are rounding: adjustment_m stays 0 */
}

/* ---- in whole steps ---- */

static int within(const hf_turnbuckles_problem *p, double steps)
{
    return (int)fmin(fmax(round(steps), -p->steps_max), p->steps_max);
}

/* Changes two turnbuckles by a and b steps, if that lowers the sum of squares and tensions allow it. Returns whether it
 * did. */
static bool step_both(const hf_turnbuckles_problem *p, const tensions *t, int *steps, int i, int j, int a, int b)
{
    if (abs(steps[i] + a) > p->steps_max || abs(steps[j] + b) > p->steps_max) return false;
    double by = 2 * (a * slope_at(p, steps, i) + b * slope_at(p, steps, j)) +
                p->step_m * (a * a * gram_of(p, i, i) + 2 * a * b * gram_of(p, i, j) + b * b * gram_of(p, j, j));
    if (!(p->step_m * by < -GAIN_ROUNDING * p->square)) return false;
    if (t && !take_steps(t, i, j, a, b)) return false;
    steps[i] += a;
    steps[j] += b;
    return true;
}

/* Changes one or two turnbuckles of the list at a time until nothing lowers the sum of squares. */
static void descend(const hf_turnbuckles_problem *p, int n, const int *list, const tensions *t, int *steps)
{
    bool changes = true;
    for (int round_ = 0; changes && round_ < ROUNDS_MAX; round_++) {
        changes = false;
        for (int k = 0; k < n; k++) {
            int i = list[k], was = steps[i];
            double curve = gram_of(p, i, i);
            if (!(curve > 0)) continue;
            int target_steps = within(p, was - slope_at(p, steps, i) / (curve * p->step_m));
            if (target_steps != was)
                changes |= step_both(p, t, steps, i, i == list[0] ? list[n - 1] : list[0], target_steps - was, 0);
        }
        for (int k = 0; k < n; k++)
            for (int l = 0; l < k; l++)
                for (int way = 0; way < 4; way++)
                    changes |= step_both(p, t, steps, list[k], list[l], way % 2 ? 1 : -1, way / 2 ? 1 : -1);
    }
}

/* Takes steps back until rounding to whole steps no longer breaks a limit on tensions. Each time it takes back the step
 * that costs least among those that help. After 10 of these for each turnbuckle it sets all steps to 0. */
static void step_back(const hf_turnbuckles_problem *p, const tensions *t, int *steps, double *adjustment_m)
{
    fall_by_steps(t, steps, adjustment_m);
    for (int i = worst_tension(t), left = 10 * t->n; i >= 0; i = worst_tension(t), left--) {
        int best = -1;
        double min_square = (double)INFINITY;
        for (int k = 0; k < t->n; k++) {
            int e = t->cable[k], back = steps[e] > 0 ? -1 : 1;
            if (!steps[e] || !(back * rates_of(t, k)[i] > 0)) continue;
            double cost = 2 * back * slope_at(p, steps, e) + p->step_m * gram_of(p, e, e);
            if (cost < min_square) min_square = cost, best = e;
        }
        if (best >= 0) steps[best] += steps[best] > 0 ? -1 : 1;
        for (int k = 0; k < t->n && (best < 0 || left <= 0); k++)
            steps[t->cable[k]] = 0;
        fall_by_steps(t, steps, adjustment_m);
    }
}

/* ---- which turnbuckles ---- */

typedef struct {
    const hf_turnbuckles_problem *p;
    int n_list, *list;    /* adjusted turnbuckles */
    int *best, *trial;    /* [n] steps */
    double *adjustment_m; /* [n] scratch */
    double *gain;         /* [n] scratch */
    double min_square;    /* sum of squares of `best` */
    tensions tensions;
    bool is_held;     /* a limit on tensions ruled out a better choice */
    hf_status status; /* HF_NO_MEMORY: a fit could not be made, so the choice means nothing */
} choice;

static hf_status allocate_choice(choice *c, void **block)
{
    tensions *t = &c->tensions;
    size_t n = (size_t)c->p->n, n_tension = (size_t)c->p->n_tension, n_list = n_tension ? (size_t)c->p->n_max : 0;
    if (n_list > n) n_list = n;
    HF_TRY(HF_ARENA_ARRAYS(block, HF_ARRAY(t->cable, n_list), HF_ARRAY(t->rate, n_list * n_tension),
                           HF_ARRAY(t->row, n_list ? n : 0), HF_ARRAY(t->fall_N, n_tension), HF_ARRAY(c->list, n),
                           HF_ARRAY(c->best, n), HF_ARRAY(c->trial, n), HF_ARRAY(c->adjustment_m, n),
                           HF_ARRAY(c->gain, n)));
    for (size_t k = 0; k < n_list; k++)
        t->cable[k] = -1;
    return HF_OK;
}

/* Returns the gain of adjusting turnbuckle i alone, beside the present steps of adjusted [n_adjusted]. */
static double gain_alone(const choice *c, int i, int n_adjusted, const int *adjusted)
{
    double curve = gram_of(c->p, i, i), sum = 0, max_m = c->p->steps_max * c->p->step_m;
    if (!(curve > 0)) return 0;
    for (int k = 0; k < n_adjusted; k++)
        sum += gram_of(c->p, i, adjusted[k]) * c->best[adjusted[k]];
    double slope = c->p->slope[i] + c->p->step_m * sum;
    double move = fmin(fmax(-slope / curve, -max_m), max_m);
    return -move * (2 * slope + move * curve);
}

static bool is_on_list(const choice *c, int i)
{
    for (int k = 0; k < c->n_list; k++)
        if (c->list[k] == i) return true;
    return false;
}

/* Lists the turnbuckles off the list that gain most alone, in descending order. Returns their number. */
static int find_candidates(choice *c, int candidate[SHORT_LIST])
{
    int n = 0, n_adjusted = 0, *adjusted = c->trial; /* trial is free at this point */
    for (int i = 0; i < c->p->n; i++)
        if (c->best[i]) adjusted[n_adjusted++] = i;
    for (int i = 0; i < c->p->n; i++) {
        if (is_on_list(c, i)) continue;
        c->gain[i] = gain_alone(c, i, n_adjusted, adjusted);
        n = hf_list_largest(i, c->gain, SHORT_LIST, n, candidate);
    }
    return n;
}

/* Finds the best steps of the list, into c->trial, with all others at 0; t is NULL without limits on tensions. Returns
 * the sum of squares, or INFINITY without memory. */
static double fit_steps(choice *c, const tensions *t)
{
    const hf_turnbuckles_problem *p = c->p;
    memset(c->trial, 0, (size_t)p->n * sizeof *c->trial);
    if (fit_list(p, c->n_list, c->list, t, c->adjustment_m) != HF_OK) {
        c->status = HF_NO_MEMORY;
        return (double)INFINITY;
    }
    for (int i = 0; i < c->n_list; i++)
        c->trial[c->list[i]] = within(p, c->adjustment_m[i] / p->step_m);
    if (t) step_back(p, t, c->trial, c->adjustment_m);
    descend(p, c->n_list, c->list, t, c->trial);
    return hf_turnbuckles_square(p, c->trial);
}

/* Fits the list within the limits on tensions, into c->trial. Returns the sum of squares. */
static double fit_allowed(choice *c)
{
    double square = fit_steps(c, NULL);
    if (c->p->n_tension == 0 || !(square < c->min_square - GAIN_ROUNDING * c->p->square)) return square;
    take_list(&c->tensions, c->n_list, c->list);
    fall_by_steps(&c->tensions, c->trial, c->adjustment_m);
    if (worst_tension(&c->tensions) < 0) return square;
    c->is_held = true;
    return fit_steps(c, &c->tensions);
}

/* Puts the candidate that fits best with the others into entry k of the list. Returns whether `best` improved;
 * otherwise the list is unchanged. */
static bool try_entry(choice *c, int k, int n_candidate, const int *candidate)
{
    int was = c->list[k], better = -1;
    for (int i = 0; i < n_candidate; i++) {
        c->list[k] = candidate[i];
        double square = fit_allowed(c);
        if (!(square < c->min_square - GAIN_ROUNDING * c->p->square)) continue;
        c->min_square = square;
        better = candidate[i];
        memcpy(c->best, c->trial, (size_t)c->p->n * sizeof *c->best);
    }
    c->list[k] = better >= 0 ? better : was;
    return better >= 0;
}

/* Adds one turnbuckle to the list. Returns whether that improved `best`. */
static bool add_cable(choice *c)
{
    int candidate[SHORT_LIST], n = find_candidates(c, candidate);
    if (n == 0) return false;
    c->n_list++;
    if (try_entry(c, c->n_list - 1, n, candidate)) return true;
    c->n_list--;
    return false;
}

/* Exchanges turnbuckles of the list for others while that gains. Candidates are ranked with the steps of the one to be
 * exchanged set to 0. */
static void exchange(choice *c)
{
    bool gains = c->n_list > 1;
    for (int round_ = 0; gains && round_ < EXCHANGES_MAX; round_++) {
        gains = false;
        for (int k = 0; k < c->n_list; k++) {
            int candidate[SHORT_LIST], leaves = c->list[k], kept = c->best[leaves];
            c->best[leaves] = 0;
            int n = find_candidates(c, candidate);
            c->best[leaves] = kept;
            gains |= try_entry(c, k, n, candidate);
        }
    }
}

/* ---- all steps together ---- */

/* Returns whether the gain of `steps` over `before` is below its standard deviation. The gain of a sample differs by 2
 * (J' dr)' da, with the difference dr of its residuals and the difference da of the adjustments. */
static bool is_doubtful(const hf_turnbuckles_problem *p, const int *before, const int *steps)
{
    double gain = hf_turnbuckles_square(p, before) - hf_turnbuckles_square(p, steps), variance = 0;
    for (int s = 0; s < p->n_sample; s++) {
        double change = 0;
        for (int i = 0; i < p->n; i++)
            change += p->sample[(size_t)s * (size_t)p->n + (size_t)i] * (steps[i] - before[i]);
        variance += 4 * p->step_m * p->step_m * change * change / p->n_sample;
    }
    return gain * gain < variance;
}

/* Removes turnbuckles with 0 steps from the list. */
static void drop_idle(choice *c)
{
    int n = 0;
    for (int k = 0; k < c->n_list; k++)
        if (c->best[c->list[k]]) c->list[n++] = c->list[k];
    c->n_list = n;
}

hf_status hf_turnbuckles_choose(const hf_turnbuckles_problem *p, int *steps, hf_turnbuckles_end *end, bool *is_held)
{
    void *block;
    choice c = {.p = p, .min_square = p->square, .tensions.p = p};
    memset(steps, 0, (size_t)p->n * sizeof *steps);
    HF_TRY(allocate_choice(&c, &block));
    for (;;) {
        *end = HF_TURNBUCKLES_TARGET;
        if (c.min_square <= p->target * p->target) break;
        *end = HF_TURNBUCKLES_ALL;
        if (c.n_list >= p->n_max) break;
        *end = HF_TURNBUCKLES_NONE;
        if (!add_cable(&c)) break;
        exchange(&c);
        if (c.status != HF_OK) break;
        *end = HF_TURNBUCKLES_DOUBT;
        if (is_doubtful(p, steps, c.best)) break;
        memcpy(steps, c.best, (size_t)p->n * sizeof *steps);
        drop_idle(&c);
    }
    *is_held = c.is_held;
    hf_arena_free_block(block);
    return c.status;
}

hf_status hf_turnbuckles_best(const hf_turnbuckles_problem *p, double *adjustment_m)
{
    void *block;
    int *list;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(list, p->n)));
    for (int i = 0; i < p->n; i++)
        list[i] = i;
    hf_status status = fit_list(p, p->n, list, NULL, adjustment_m);
    hf_arena_free_block(block);
    return status;
}

/* ---- order of adjustments ---- */

/* Returns whether all tensions stay within their room after a further adjustment. */
static bool keeps_taut(const hf_turnbuckles_problem *p, const double *fall_N, const double *change_N)
{
    for (int k = 0; k < p->n_tension; k++)
        if (change_N[k] < 0 && fall_N[k] - change_N[k] > room_to_fall(p, k)) return false;
    return true;
}

int hf_turnbuckles_next(const hf_turnbuckles_problem *p, const int *steps, const double *change_N, int *done,
                        double *fall_N)
{
    double min_square = (double)INFINITY;
    int next = p->n;
    const double *next_N = change_N;
    bool is_taut = false;
    for (int i = 0; i < p->n; i++) {
        if (!steps[i]) continue;
        const double *this_N = change_N;
        change_N += p->n_tension;
        if (steps[i] == done[i]) continue;
        bool keeps = keeps_taut(p, fall_N, this_N);
        done[i] = steps[i];
        double square = hf_turnbuckles_square(p, done);
        done[i] = 0;
        if (next < p->n && (keeps == is_taut ? !(square < min_square) : is_taut)) continue;
        min_square = square;
        next = i;
        is_taut = keeps;
        next_N = this_N;
    }
    hf_subtract((size_t)p->n_tension, 1, next_N, fall_N);
    done[next] = steps[next];
    return next;
}
