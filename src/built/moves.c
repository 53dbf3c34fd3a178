/* Contents: sums of squares - without steps - in whole steps - which cables - together */
#include "built/moves.h"

#include "base/arena.h"
#include "linalg/quadratic.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define SHORT_LIST 12    /* cables that are tried in full for each move */
#define EXCHANGES_MAX 50 /* rounds of exchanges for each number of moves */
#define ROUNDS_MAX 1000  /* of steps of one cable or two */
#define RIDGE 1e-12      /* on the diagonal, relative: columns may depend on each other */
#define BOUND_ROUNDING 1e-9
#define GAIN_ROUNDING 1e-12 /* a smaller part of the sum of squares is no gain */

/* ---- sums of squares ---- */

double hf_moves_square(const hf_moves_problem *p, const int *steps)
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

/* Half the derivative by the move of cable i. */
static double slope_at(const hf_moves_problem *p, const int *steps, int i)
{
    double sum = 0;
    for (int j = 0; j < p->n; j++)
        if (steps[j]) sum += p->gram[(size_t)i * (size_t)p->n + (size_t)j] * steps[j];
    return p->slope[i] + p->step_m * sum;
}

static double gram_of(const hf_moves_problem *p, int i, int j)
{
    return p->gram[(size_t)i * (size_t)p->n + (size_t)j];
}

/* ---- without steps ---- */

typedef struct {
    int n;
    double most_m;
} box;

/* For hf_quadratic: the bound that x breaks most. */
static bool worst_bound(void *context, const double *x, hf_quadratic_limit *limit)
{
    const box *b = context;
    double worst = b->most_m * (1 + BOUND_ROUNDING);
    int at = -1;
    for (int i = 0; i < b->n; i++) {
        if (fabs(x[i]) <= worst) continue;
        worst = fabs(x[i]);
        at = i;
    }
    if (at < 0) return false;
    limit->kind = 0;
    limit->only = at;
    limit->normal[at] = x[at] < 0 ? 1 : -1;
    limit->bound = -b->most_m;
    return true;
}

static void lay_out_box(hf_arena *arena, int n, double **hessian, double **vector)
{
    *hessian = hf_arena_take(arena, (size_t)n * (size_t)n, sizeof(double));
    *vector = hf_arena_take(arena, 3 * (size_t)n, sizeof(double));
}

/* The best moves of the n cables of a list, move_m [n]. */
static hf_status fit_list(const hf_moves_problem *p, int n, const int *list, double *move_m)
{
    hf_arena arena = {0};
    hf_quadratic q;
    double *hessian = NULL, *gradient = NULL, largest = 0;
    box b = {n, p->steps_max * p->step_m};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out_box(&arena, n, &hessian, &gradient)));
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            hessian[i * n + j] = gram_of(p, list[i], list[j]);
        largest = fmax(largest, hessian[i * n + i]);
        gradient[i] = p->slope[list[i]];
        gradient[n + i] = -b.most_m;
        gradient[2 * n + i] = b.most_m;
        move_m[i] = 0;
    }
    for (int i = 0; i < n; i++)
        hessian[i * n + i] += largest > 0 ? RIDGE * largest : 1; /* of a slack cable everything is 0 */
    hf_status status = hf_quadratic_create(n, &q);
    if (status == HF_OK)
        status = hf_quadratic_solve(&q, hessian, gradient, gradient + n, gradient + 2 * n, worst_bound, &b);
    for (int i = 0; i < n && status == HF_OK; i++)
        move_m[i] = fmin(fmax(q.x[i], -b.most_m), b.most_m);
    hf_quadratic_free(&q);
    hf_arena_free(&arena);
    return status == HF_NO_MEMORY ? status : HF_OK; /* else rounding: no move is a move */
}

/* ---- in whole steps ---- */

static int within(const hf_moves_problem *p, double steps)
{
    return (int)fmin(fmax(round(steps), -p->steps_max), p->steps_max);
}

/* Change two cables by (a, b) steps where that gains. */
static bool step_both(const hf_moves_problem *p, int *steps, int i, int j, int a, int b)
{
    if (abs(steps[i] + a) > p->steps_max || abs(steps[j] + b) > p->steps_max) return false;
    double by = 2 * (a * slope_at(p, steps, i) + b * slope_at(p, steps, j)) +
                p->step_m * (a * a * gram_of(p, i, i) + 2 * a * b * gram_of(p, i, j) + b * b * gram_of(p, j, j));
    if (!(p->step_m * by < -GAIN_ROUNDING * p->square)) return false;
    steps[i] += a;
    steps[j] += b;
    return true;
}

/* Step cables of the list, one or two at a time, until nothing gains. */
static void descend(const hf_moves_problem *p, int n, const int *list, int *steps)
{
    bool moves = true;
    for (int round_ = 0; moves && round_ < ROUNDS_MAX; round_++) {
        moves = false;
        for (int k = 0; k < n; k++) {
            int i = list[k], was = steps[i];
            double curve = gram_of(p, i, i);
            if (!(curve > 0)) continue;
            int wanted = within(p, was - slope_at(p, steps, i) / (curve * p->step_m));
            if (wanted != was) moves |= step_both(p, steps, i, i == list[0] ? list[n - 1] : list[0], wanted - was, 0);
        }
        for (int k = 0; k < n; k++)
            for (int l = 0; l < k; l++)
                for (int way = 0; way < 4; way++)
                    moves |= step_both(p, steps, list[k], list[l], way % 2 ? 1 : -1, way / 2 ? 1 : -1);
    }
}

/* The best steps of the cables of a list, all others at 0. move_m: [n] scratch. Returns the sum of squares, INFINITY
 * without memory. */
static double fit_steps(const hf_moves_problem *p, int n, const int *list, int *steps, double *move_m)
{
    memset(steps, 0, (size_t)p->n * sizeof *steps);
    if (fit_list(p, n, list, move_m) != HF_OK) return (double)INFINITY;
    for (int i = 0; i < n; i++)
        steps[list[i]] = within(p, move_m[i] / p->step_m);
    descend(p, n, list, steps);
    return hf_moves_square(p, steps);
}

/* ---- which cables ---- */

typedef struct {
    const hf_moves_problem *p;
    int n_list, *list; /* cables that are turned */
    int *best, *trial; /* [n] steps */
    double *move_m;    /* [n] scratch */
    double *gain;      /* [n] scratch */
    double least;      /* sum of squares of `best` */
    void *block;
} choice;

static void lay_out_choice(hf_arena *arena, size_t n, choice *c)
{
    c->list = hf_arena_take(arena, n, sizeof(int));
    c->best = hf_arena_take(arena, n, sizeof(int));
    c->trial = hf_arena_take(arena, n, sizeof(int));
    c->move_m = hf_arena_take(arena, n, sizeof(double));
    c->gain = hf_arena_take(arena, n, sizeof(double));
}

/* What turning cable i alone gains, beside the moves that are there. */
static double gain_alone(const choice *c, int i)
{
    double curve = gram_of(c->p, i, i), slope = slope_at(c->p, c->best, i), most = c->p->steps_max * c->p->step_m;
    if (!(curve > 0)) return 0;
    double move = fmin(fmax(-slope / curve, -most), most);
    return -move * (2 * slope + move * curve);
}

static bool is_on_list(const choice *c, int i)
{
    for (int k = 0; k < c->n_list; k++)
        if (c->list[k] == i) return true;
    return false;
}

/* The cables off the list that gain most alone, best first. Returns how many. */
static int find_candidates(choice *c, int candidate[SHORT_LIST])
{
    int n = 0;
    for (int i = 0; i < c->p->n; i++) {
        if (is_on_list(c, i)) continue;
        c->gain[i] = gain_alone(c, i);
        int at = n < SHORT_LIST ? n++ : n;
        while (at > 0 && c->gain[i] > c->gain[candidate[at - 1]]) {
            if (at < SHORT_LIST) candidate[at] = candidate[at - 1];
            at--;
        }
        if (at < SHORT_LIST) candidate[at] = i;
    }
    return n;
}

/* Put the candidate that fits best with the others into place k of the list. Whether `best` became better; else the
 * list is as before. */
static bool try_place(choice *c, int k, int n_candidate, const int *candidate)
{
    int was = c->list[k], better = -1;
    for (int i = 0; i < n_candidate; i++) {
        c->list[k] = candidate[i];
        double square = fit_steps(c->p, c->n_list, c->list, c->trial, c->move_m);
        if (!(square < c->least - GAIN_ROUNDING * c->p->square)) continue;
        c->least = square;
        better = candidate[i];
        memcpy(c->best, c->trial, (size_t)c->p->n * sizeof *c->best);
    }
    c->list[k] = better >= 0 ? better : was;
    return better >= 0;
}

/* One cable more. Whether it gained. */
static bool add_cable(choice *c)
{
    int candidate[SHORT_LIST], n = find_candidates(c, candidate);
    if (n == 0) return false;
    c->n_list++;
    if (try_place(c, c->n_list - 1, n, candidate)) return true;
    c->n_list--;
    return false;
}

/* Exchange cables of the list for others while that gains. Those that gain most are looked for without the one that
 * leaves. */
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
            gains |= try_place(c, k, n, candidate);
        }
    }
}

/* ---- together ---- */

/* Is the gain of `steps` over `before` below its standard deviation? */
static bool is_doubtful(const hf_moves_problem *p, const int *before, const int *steps)
{
    double gain = hf_moves_square(p, before) - hf_moves_square(p, steps), variance = 0;
    for (int s = 0; s < p->n_sample; s++) {
        double change = 0;
        for (int i = 0; i < p->n; i++)
            change += p->sample[(size_t)s * (size_t)p->n + (size_t)i] * (steps[i] - before[i]);
        variance += 4 * p->step_m * p->step_m * change * change / p->n_sample;
    }
    return gain * gain < variance;
}

static void drop_idle(choice *c)
{
    int n = 0;
    for (int k = 0; k < c->n_list; k++)
        if (c->best[c->list[k]]) c->list[n++] = c->list[k];
    c->n_list = n;
}

hf_status hf_moves_choose(const hf_moves_problem *p, int *steps, hf_moves_end *end)
{
    hf_arena arena = {0};
    choice c = {.p = p, .least = p->square};
    memset(steps, 0, (size_t)p->n * sizeof *steps);
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out_choice(&arena, (size_t)p->n, &c)));
    for (;;) {
        *end = HF_MOVES_TARGET;
        if (c.least <= p->target * p->target) break;
        *end = HF_MOVES_ALL;
        if (c.n_list >= p->moves_max) break;
        *end = HF_MOVES_NONE;
        if (!add_cable(&c)) break;
        exchange(&c);
        *end = HF_MOVES_DOUBT;
        if (is_doubtful(p, steps, c.best)) break;
        memcpy(steps, c.best, (size_t)p->n * sizeof *steps);
        drop_idle(&c);
    }
    hf_arena_free(&arena);
    return HF_OK;
}

hf_status hf_moves_best(const hf_moves_problem *p, double *move_m)
{
    hf_arena arena = {0};
    int *list = NULL;
    HF_TRY(HF_ARENA_MAKE(&arena, list = hf_arena_take(&arena, (size_t)p->n, sizeof *list)));
    for (int i = 0; i < p->n; i++)
        list[i] = i;
    hf_status status = fit_list(p, p->n, list, move_m);
    hf_arena_free(&arena);
    return status;
}
