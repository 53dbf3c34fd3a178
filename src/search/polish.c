/* Contents: the problem - evaluation - limits - one step - the run */
#include "search/polish.h"

#include "base/arena.h"
#include "linalg/band.h"
#include "linalg/quadratic.h"
#include "search/sensitivity.h"

#include <math.h>
#include <string.h>

/* In brackets: the range over which no test of this module and of cli/limits fails, as far as it was tried. */
#define GAIN_CONVERGED 1e-12 /* converged: a step promises less than this part of psi^2 [1e-15 to 1e-8] */
#define DAMPING_FIRST 1e-3   /* relative to the squared columns of J [1e-6 to 1] */
#define DAMPING_LEAST 1e-14  /* [1e-20 to 1e-8] */
#define DAMPING_MOST 1e12    /* with this much a step is too short to change psi [1e4 to 1e24] */
#define CORRECTIONS_MAX 4 /* of a step that breaks a limit on tensions [40 passes; 1 fails: the runs stall at a cap] */
#define LIMIT_INSIDE 1e-9 /* part by which a step stays within the limits on tensions [1e-11; 1e-7 fails] */
#define LIMIT_ROUNDING 1e-12 /* a violation below this part of the tension is rounding [1e-14 to 1e-10] */
#define DENSITY_LEFT 1e-3    /* part of its first value below which no force density falls [1e-6 to 0.3] */

/* For hf_polish_is_cheap: steps that were counted on the cases of configs and METHOD; operations in about 0.1 s. */
#define STEPS_EXPECTED 8
#define STEP_EVALUATIONS 2
#define NEWTON_STEPS 5
#define CHORD_STEPS 4
#define UNNOTICED 2e8

/* ---- the problem ---- */

/* A cable whose tension is limited. */
typedef struct {
    int cable;
    bool is_in_ratio;         /* the cap on the boundary tension ratio counts it */
    double lower_N, upper_N;  /* infinite when only the cap limits it */
    double tension_N, bend_N; /* at the best variables; beyond the linear model at the last trial */
    double predicted_N;       /* by the linear model */
} watched;

/* Shapes of tensions T and of the force densities T/l are the same, but the shape is a far more even function of the
 * force densities: single tensions in a chain drag its nodes along. So the variables always mean force densities, and
 * under rule tension the bounds are limits on the tensions. */
typedef struct {
    hf_evaluator v; /* that of the caller, with rule force_density and without a cap */
    const double *lower_N, *upper_N;
    double cap;
    bool by_tension; /* the caller's rule is tension */
    hf_workspace *w;
    hf_sensitivity slopes;
    hf_quadratic step;
    int n;     /* variables: steps (N) from start_N, one for each class of linked genes */
    int n_row; /* 3 n_inner_node */
    int n_watched;
    watched *watched; /* [n_watched] */
    double *rate;     /* [n_watched][n] of tension_N per variable */
    int evaluations;
    hf_form_result result; /* of the last evaluation */
    double *start_N;       /* [n_gene] pretensions q L* */
    double *low, *high;    /* [n] bounds of the variables */
    double *unit_N;        /* [n] size of the tension: violations are relative to it */
    double *at, *trial;    /* [n] the best variables; those of the last step */
    double *design_N;      /* [n_gene] of the last evaluation, as pretensions q L* */
    double *best_N;        /* [n_gene] the best design in the caller's meaning */
    double *scale;         /* [n] largest norm of each column of J so far */
    double *distance_m;    /* [n_row] residuals f; |f| = psi */
    double *row;           /* [n][n_row] J' */
    double *gram;          /* [n][n] J'J; lower triangle by rows, as `hessian` */
    double *hessian;       /* [n][n] J'J, damped */
    double *gradient;      /* [n] J'f */
} problem;

bool hf_polish_applies(const hf_evaluator *v)
{
    return v->model->has_newton && v->rule != HF_RULE_SEEDED && v->model->n_gene > 0;
}

bool hf_polish_is_cheap(const hf_evaluator *v, long n_evaluation)
{
    const hf_model *m = v->model;
    double n_dof = 3.0 * m->n_free, width = 3.0 * m->half_bandwidth + 3, n = m->n_leader;
    double factor = n_dof * width * width, solve = 4 * n_dof * width, newton = NEWTON_STEPS * (factor + solve);
    double evaluation = v->solver == HF_SOLVER_CHORD ? CHORD_STEPS * solve : newton;
    double step = STEP_EVALUATIONS * newton + factor + n * solve + n * n * (3.0 * m->n_inner_node + 2 * n);
    return STEPS_EXPECTED * step <= fmax(UNNOTICED, (double)n_evaluation * evaluation / 10);
}

static void lay_out(hf_arena *a, problem *p)
{
    const hf_model *m = p->v.model;
    size_t n = (size_t)p->n, n_row = (size_t)p->n_row, n_gene = (size_t)m->n_gene;
    p->watched = hf_arena_take(a, (size_t)p->n_watched, sizeof *p->watched);
    p->rate = hf_arena_take(a, (size_t)p->n_watched * n, sizeof(double));
    p->start_N = hf_arena_take(a, n_gene, sizeof(double));
    p->low = hf_arena_take(a, n, sizeof(double));
    p->high = hf_arena_take(a, n, sizeof(double));
    p->unit_N = hf_arena_take(a, n, sizeof(double));
    p->at = hf_arena_take(a, n, sizeof(double));
    p->trial = hf_arena_take(a, n, sizeof(double));
    p->design_N = hf_arena_take(a, n_gene, sizeof(double));
    p->best_N = hf_arena_take(a, n_gene, sizeof(double));
    p->scale = hf_arena_take(a, n, sizeof(double));
    p->distance_m = hf_arena_take(a, n_row, sizeof(double));
    p->row = hf_arena_take(a, n * n_row, sizeof(double));
    p->gram = hf_arena_take(a, n * n, sizeof(double));
    p->hessian = hf_arena_take(a, n * n, sizeof(double));
    p->gradient = hf_arena_take(a, n, sizeof(double));
}

/* Does any limit concern the tension of cable e? *gene: the cable's, when its bounds do; else -1. */
static bool is_watched(const problem *p, int e, const int *gene_of_cable, int *gene)
{
    *gene = p->by_tension ? gene_of_cable[e] : -1;
    return *gene >= 0 || (isfinite(p->cap) && p->v.model->group[e] == HF_GROUP_BOUNDARY);
}

static void watch(problem *p)
{
    const hf_model *m = p->v.model;
    int gene, i = 0;
    for (int e = 0; e < m->n_cable; e++) {
        if (!is_watched(p, e, p->slopes.gene_of_cable, &gene)) continue;
        watched *t = &p->watched[i++];
        *t = (watched){.cable = e, .lower_N = -INFINITY, .upper_N = INFINITY};
        t->is_in_ratio = isfinite(p->cap) && m->group[e] == HF_GROUP_BOUNDARY;
        if (gene < 0) continue;
        t->lower_N = p->lower_N[gene];
        t->upper_N = p->upper_N[gene];
    }
}

/* Start at the design whose shape is in the workspace. */
static void begin(problem *p, const double *design_N)
{
    const hf_model *m = p->v.model;
    for (int i = 0; i < p->n; i++) {
        p->low[i] = -INFINITY;
        p->high[i] = INFINITY;
    }
    for (int k = 0; k < m->n_gene; k++) {
        int i = p->slopes.variable_of_gene[k], e = m->gene_cable[k];
        double start = design_N[k], lower = p->lower_N[k], upper = p->upper_N[k];
        if (p->by_tension) {
            start = hf_evaluate_design_length_m(m, e) * p->w->tension_N[e] / p->w->length_m[e];
            lower = DENSITY_LEFT * start;
            upper = INFINITY;
        }
        p->start_N[k] = start;
        p->low[i] = fmax(p->low[i], fmin(lower - start, 0));
        p->high[i] = fmin(p->high[i], fmax(upper - start, 0));
        p->unit_N[i] = fmax(p->unit_N[i], start);
    }
    memcpy(p->best_N, design_N, (size_t)m->n_gene * sizeof(double));
    memcpy(p->design_N, p->start_N, (size_t)m->n_gene * sizeof(double));
}

static hf_status create(problem *p, hf_arena *arena)
{
    const hf_model *m = p->v.model;
    int gene;
    p->n = m->n_leader;
    p->n_row = 3 * m->n_inner_node;
    HF_TRY(hf_sensitivity_create(&p->v, &p->slopes));
    for (int e = 0; e < m->n_cable; e++)
        p->n_watched += is_watched(p, e, p->slopes.gene_of_cable, &gene);
    HF_TRY(HF_ARENA_MAKE(arena, lay_out(arena, p)));
    watch(p);
    return hf_quadratic_create(p->n, &p->step);
}

/* ---- evaluation ---- */

/* Find the shape of these variables in the workspace. */
static hf_status evaluate(problem *p, const double *variable)
{
    const hf_model *m = p->v.model;
    for (int k = 0; k < m->n_gene; k++) {
        double T = p->start_N[k] + variable[p->slopes.variable_of_gene[k]];
        p->design_N[k] = p->by_tension ? T : fmax(p->lower_N[k], fmin(p->upper_N[k], T));
    }
    p->evaluations++;
    return hf_evaluate(&p->v, p->design_N, p->w, &p->result);
}

/* Does the shape in the workspace keep the limits on tensions? */
static bool is_within_limits(const problem *p)
{
    double least = INFINITY, largest = -INFINITY;
    for (int i = 0; i < p->n_watched; i++) {
        const watched *t = &p->watched[i];
        double T = p->w->tension_N[t->cable];
        if (T < t->lower_N || T > t->upper_N) return false;
        if (t->is_in_ratio) {
            least = fmin(least, T);
            largest = fmax(largest, T);
        }
    }
    return !(largest > p->cap * least);
}

/* Take the shape in the workspace as the best. */
static void keep(problem *p)
{
    const hf_model *m = p->v.model;
    memcpy(p->at, p->trial, (size_t)p->n * sizeof(double));
    for (int k = 0; k < m->n_gene; k++)
        p->best_N[k] = p->by_tension ? p->w->tension_N[m->gene_cable[k]] : p->design_N[k];
}

/* Write residuals, J', J'J, the gradient and the watched tensions with their rates at the workspace's shape. */
static hf_status linearise(problem *p)
{
    const hf_model *m = p->v.model;
    const hf_sensitivity *s = &p->slopes;
    double part = 1 / sqrt(m->n_inner_node);
    HF_TRY(hf_sensitivity_find(&p->slopes, p->w));
    for (int i = 0; i < m->n_inner_node; i++)
        for (int c = 0; c < 3; c++) {
            int at = c * m->n_node + m->inner_row[i];
            p->distance_m[3 * i + c] = part * (p->w->position_m[at] - m->position_m[at]);
        }
    for (int k = 0; k < p->n; k++) {
        double *row = p->row + (size_t)k * (size_t)p->n_row;
        const double *move = s->move + (size_t)k * s->n_dof;
        p->gradient[k] = 0;
        for (int i = 0; i < p->n_row; i++) {
            row[i] = part * move[3 * m->inner_row[i / 3] + i % 3];
            p->gradient[k] += row[i] * p->distance_m[i];
        }
    }
    hf_band_gram(p->n, p->n_row, p->row, p->n_row, p->gram, p->n);
    for (int k = 0; k < p->n; k++)
        p->scale[k] = fmax(p->scale[k], sqrt(p->gram[k * p->n + k]));
    for (int i = 0; i < p->n_watched; i++) {
        watched *t = &p->watched[i];
        t->tension_N = p->w->tension_N[t->cable];
        hf_sensitivity_tension(s, p->w, t->cable, p->rate + (size_t)i * (size_t)p->n);
    }
    return HF_OK;
}

/* ---- limits ---- */

/* What holds a step: the kinds of its active limits. */
enum { BOUND, CAP };

/* Tensions that the linear model gives for the step x. *high, *low: the largest and the least of those in the ratio. */
static void predict(problem *p, const double *x, const watched **high, const watched **low)
{
    size_t n = (size_t)p->n;
    *high = *low = NULL;
    for (int i = 0; i < p->n_watched; i++) {
        const double *rate = p->rate + (size_t)i * n;
        watched *t = &p->watched[i];
        t->predicted_N = t->tension_N + t->bend_N;
        for (size_t j = 0; j < n; j++)
            t->predicted_N += rate[j] * x[j];
        if (!t->is_in_ratio) continue;
        if (!*high || t->predicted_N > (*high)->predicted_N) *high = t;
        if (!*low || t->predicted_N < (*low)->predicted_N) *low = t;
    }
}

static const double *rate_of(const problem *p, const watched *t)
{
    return p->rate + (size_t)(t - p->watched) * (size_t)p->n;
}

/* The limit that the step x violates most; for hf_quadratic. */
static bool worst_limit(void *context, const double *x, hf_quadratic_limit *limit)
{
    problem *p = context;
    double worst = LIMIT_ROUNDING, cap = p->cap * (1 - LIMIT_INSIDE), sign = 0;
    const watched *high, *low, *held = NULL;
    int variable = -1;
    predict(p, x, &high, &low);
    for (int i = 0; i < p->n; i++) {
        double below = (p->low[i] - p->at[i] - x[i]) / p->unit_N[i],
               above = (p->at[i] + x[i] - p->high[i]) / p->unit_N[i];
        if (!(fmax(below, above) > worst)) continue;
        worst = fmax(below, above);
        sign = below > above ? 1 : -1;
        variable = i;
    }
    for (int i = 0; i < p->n_watched; i++) {
        const watched *t = &p->watched[i];
        double size = LIMIT_INSIDE * fabs(t->tension_N);
        double below = (t->lower_N + size - t->predicted_N) / fabs(t->tension_N);
        double above = (t->predicted_N - t->upper_N + size) / fabs(t->tension_N);
        if (!(fmax(below, above) > worst)) continue;
        worst = fmax(below, above);
        sign = below > above ? 1 : -1;
        held = t;
    }
    limit->kind = BOUND;
    if (high && high->predicted_N - cap * low->predicted_N > worst * fabs(high->predicted_N)) {
        const double *up = rate_of(p, high), *down = rate_of(p, low);
        for (int j = 0; j < p->n; j++)
            limit->normal[j] = cap * down[j] - up[j];
        limit->bound = high->tension_N + high->bend_N - cap * (low->tension_N + low->bend_N);
        limit->kind = CAP;
    } else if (held) {
        double inside = LIMIT_INSIDE * fabs(held->tension_N), limit_N = sign > 0 ? held->lower_N : held->upper_N;
        for (int j = 0; j < p->n; j++)
            limit->normal[j] = sign * rate_of(p, held)[j];
        limit->bound = sign * (limit_N - held->tension_N - held->bend_N) + inside;
    } else if (variable >= 0) {
        limit->normal[variable] = sign;
        limit->bound = sign * ((sign > 0 ? p->low : p->high)[variable] - p->at[variable]);
    }
    return worst > LIMIT_ROUNDING || limit->kind == CAP;
}

/* ---- one step ---- */

/* The least of the model |f + J x|^2/2 + damping |scale x|^2/2 within the limits, as `trial`. *gain: what the model
 * promises of psi^2/2. */
static hf_status solve_step(problem *p, double damping, double *gain)
{
    const double *x = p->step.x;
    int n = p->n;
    for (int r = 0; r < n; r++) {
        memcpy(p->hessian + r * n, p->gram + r * n, (size_t)(r + 1) * sizeof(double));
        p->hessian[r * n + r] += damping * p->scale[r] * p->scale[r];
    }
    HF_TRY(hf_quadratic_solve(&p->step, p->hessian, p->gradient, worst_limit, p));
    *gain = 0;
    for (int r = 0; r < n; r++) {
        double sum = p->gram[r * n + r] * x[r] / 2 + p->gradient[r];
        for (int c = 0; c < r; c++)
            sum += p->gram[r * n + c] * x[c];
        *gain -= sum * x[r];
        p->trial[r] = fmax(p->low[r], fmin(p->high[r], p->at[r] + x[r]));
    }
    return HF_OK;
}

/* Evaluate the step. One that breaks a limit on tensions, because they are not linear in the variables, is solved again
 * with what they really were. HF_RATIO_CAP: a limit is still broken. */
static hf_status try_step(problem *p, double damping, double *gain)
{
    const watched *high, *low;
    for (int i = 0; i < p->n_watched; i++)
        p->watched[i].bend_N = 0;
    for (int again = 0; again <= CORRECTIONS_MAX; again++) {
        HF_TRY(solve_step(p, damping, gain));
        HF_TRY(evaluate(p, p->trial));
        if (is_within_limits(p)) return HF_OK;
        predict(p, p->step.x, &high, &low);
        for (int i = 0; i < p->n_watched; i++)
            p->watched[i].bend_N += p->w->tension_N[p->watched[i].cable] - p->watched[i].predicted_N;
    }
    return HF_RATIO_CAP;
}

/* ---- the run ---- */

static void count_limits(const problem *p, hf_polish_result *r)
{
    const hf_model *m = p->v.model;
    for (int k = 0; k < m->n_gene; k++) {
        double inside = p->by_tension ? 2 * LIMIT_INSIDE * p->best_N[k] : 0;
        r->n_at_lower += p->best_N[k] <= p->lower_N[k] + inside;
        r->n_at_upper += p->best_N[k] >= p->upper_N[k] - inside;
    }
    for (int i = 0; i < p->step.n_active; i++)
        r->is_at_cap |= p->step.active[i] == CAP;
}

/* Steps until one promises nothing more, none lowers psi any more, or the iteration limit is reached. The damping
 * follows Nielsen (Madsen, Nielsen, Tingleff, Methods for non-linear least squares problems, DTU 2004). */
static hf_status minimise(problem *p, int max_iterations, hf_polish_result *r)
{
    double damping = DAMPING_FIRST, growth = 2, gain = 0;
    hf_status status = evaluate(p, p->at);
    if (status == HF_OK) status = linearise(p);
    while (status == HF_OK && r->stop == HF_POLISH_MAX_ITERATIONS && r->iterations < max_iterations) {
        double before = r->psi_m * r->psi_m / 2;
        r->iterations++;
        status = try_step(p, damping, &gain);
        if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
        double after = status == HF_OK ? p->result.psi_m * p->result.psi_m / 2 : (double)INFINITY;
        if ((status == HF_OK || status == HF_RATIO_CAP) && gain <= GAIN_CONVERGED * before)
            r->stop = HF_POLISH_CONVERGED;
        status = HF_OK;
        if (after < before) {
            keep(p);
            r->psi_m = p->result.psi_m;
            double share = 2 * (before - after) / gain - 1;
            damping = fmax(DAMPING_LEAST, damping * fmax(0.1, 1 - share * share * share));
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
    count_limits(p, r);
    return HF_OK;
}

/* The best design, in the caller's meaning, replaces design_N if its own evaluation is not worse than the start. */
static void hand_over(const problem *p, const hf_evaluator *v, double *design_N, hf_polish_result *r)
{
    hf_form_result end;
    if (hf_evaluate(v, p->best_N, p->w, &end) == HF_OK && end.psi_m <= r->start_psi_m) {
        memcpy(design_N, p->best_N, (size_t)v->model->n_gene * sizeof(double));
        r->psi_m = end.psi_m;
    } else {
        r->psi_m = r->start_psi_m;
        r->stop = HF_POLISH_STALLED;
    }
}

hf_status hf_polish_run(const hf_evaluator *evaluator, const double *lower_N, const double *upper_N, int max_iterations,
                        double *design_N, hf_workspace *w, hf_polish_result *result)
{
    problem p = {.v = *evaluator, .lower_N = lower_N, .upper_N = upper_N, .w = w};
    hf_form_result start;
    hf_arena arena = {0};
    *result = (hf_polish_result){.stop = HF_POLISH_MAX_ITERATIONS};
    p.by_tension = evaluator->rule == HF_RULE_TENSION;
    p.cap = evaluator->boundary_ratio_cap;
    p.v.rule = HF_RULE_FORCE_DENSITY;
    p.v.boundary_ratio_cap = INFINITY;
    HF_TRY(hf_evaluate(evaluator, design_N, w, &start));
    result->psi_m = result->start_psi_m = start.psi_m;
    hf_status status = create(&p, &arena);
    if (status == HF_OK) {
        begin(&p, design_N);
        status = minimise(&p, max_iterations, result);
        result->evaluations = p.evaluations;
        hand_over(&p, evaluator, design_N, result);
    }
    hf_quadratic_free(&p.step);
    hf_sensitivity_free(&p.slopes);
    hf_arena_free(&arena);
    return status;
}
