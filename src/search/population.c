/* Keeps the designs of two successive generations, with their bounds and their ranking. <hifdm/population.h> describes
 * the interface.
 *
 *     initial design, settings -> bounds, reach -> designs of a generation (optimiser) -> results (batch)
 *     results -> best, mean and worst psi, minimum violation, counts -> stop reason
 *
 * Contents: memory - linked design variables - two generations - ranking */
#include <hifdm/population.h>

#include "base/arena.h"
#include "net/symmetry.h"
#include "net/variables.h"

#include <math.h>
#include <string.h>

const char *const hf_population_stop_word[4] = {"running", "stagnation", "generations", "all_infeasible"};

/* A run without a feasible design ends if the minimum violation falls by less than this part during the window of
 * stagnation. */
#define VIOLATION_GAIN 1e-3

/* ---- memory ---- */

/* The arrays that each of two generations has, for n individuals of k design variables; the others are shared.
 * <hifdm/population.h> describes them. */
#define GENERATION_FIELDS(X)                                                                                           \
    X(double, design, n *k)                                                                                            \
    X(hf_form_result, result, n)                                                                                       \
    X(unsigned char, pending, n)                                                                                       \
    X(double, crossover_rate, n)                                                                                       \
    X(double, mutation_rate, n)                                                                                        \
    X(int, parent, 2 * n)                                                                                              \
    X(hf_status, trial_status, n)                                                                                      \
    X(double, trial_psi_m, n)

/* Allocates the arrays of both generations. */
static hf_status allocate(hf_population *p, hf_population *next)
{
    size_t n = (size_t)p->n_individual, k = (size_t)p->n_variable, limit = (size_t)p->generation_limit;
    hf_population twin;
#define OF_BOTH(type, name, count) HF_ARRAY(p->name, count), HF_ARRAY(twin.name, count),
#define OF_TWIN(type, name, count) next->name = twin.name;
    HF_TRY(HF_ARENA_ARRAYS(&p->block, GENERATION_FIELDS(OF_BOTH) HF_ARRAY(p->initial, k), HF_ARRAY(p->lower, k),
                           HF_ARRAY(p->upper, k), HF_ARRAY(p->reach, k), HF_ARRAY(p->best_merit, limit),
                           HF_ARRAY(p->best_psi_m, limit), HF_ARRAY(p->least_violation, limit)));
    *next = *p;
    GENERATION_FIELDS(OF_TWIN)
#undef OF_BOTH
#undef OF_TWIN
    return HF_OK;
}

/* ---- linked design variables ---- */

/* Restricts the bounds of a class of linked design variables to the steps that all of its members can take. If there is
 * no such step, each member keeps its own bounds, to which hf_population_link clamps it. */
static void link_bounds(const hf_model *m, hf_population *p)
{
    const int *leader_of = m->variable_leader;
    for (int leader = 0; leader < p->n_variable; leader++) {
        double low = -INFINITY, high = INFINITY;
        if (leader_of[leader] != leader) continue;
        for (int k = leader; k < p->n_variable; k++) {
            if (leader_of[k] != leader) continue;
            double weight = hf_symmetry_weight(m, p->initial, k); /* values of a row that scales are above 0 */
            low = fmax(low, (p->lower[k] - p->initial[k]) / weight);
            high = fmin(high, (p->upper[k] - p->initial[k]) / weight);
        }
        for (int k = leader; low < high && k < p->n_variable; k++) {
            if (leader_of[k] != leader) continue;
            double weight = hf_symmetry_weight(m, p->initial, k);
            p->lower[k] = fmax(p->lower[k], p->initial[k] + weight * low);
            p->upper[k] = fmin(p->upper[k], p->initial[k] + weight * high);
        }
    }
}

void hf_population_link(const hf_population *population, const hf_model *m, double *design)
{
    if (m->n_leader == m->n_variable) return;
    hf_symmetry_follow(m, population->initial, design);
    for (int k = 0; k < population->n_variable; k++)
        design[k] = hf_population_clamp(population, k, design[k]);
}

/* ---- two generations ---- */

hf_status hf_population_create(const hf_optimize_settings *s, const hf_model *m, const double *initial,
                               hf_population *p, hf_population *next)
{
    *p = (hf_population){.n_variable = m->n_variable,
                         .has_rows = m->variable,
                         .n_individual = s->population,
                         .n_objective = s->n_front,
                         .generation_limit = s->generations,
                         .best = -1};
    HF_TRY(allocate(p, next));
    memcpy(p->initial, initial, (size_t)p->n_variable * sizeof *initial);
    for (int k = 0; k < p->n_variable; k++)
        hf_variables_bound(s, m, k, initial[k], &p->lower[k], &p->upper[k], &p->reach[k]);
    if (m->n_leader < m->n_variable) link_bounds(m, p);
    return HF_OK;
}

void hf_population_free(hf_population *population)
{
    hf_arena_free_block(population->block);
    *population = (hf_population){0};
}

void hf_population_advance(hf_population *population, hf_population *next)
{
#define EXCHANGE(type, member, count)                                                                                  \
    type *member = population->member;                                                                                 \
    population->member = next->member;                                                                                 \
    next->member = member;
    GENERATION_FIELDS(EXCHANGE)
#undef EXCHANGE
    population->generation++;
}

/* ---- ranking ---- */

double hf_population_violation(const hf_form_result *r)
{
    if (r->status == HF_OK) return 0;
    return hf_status_has_shape(r->status) ? r->violation : INFINITY;
}

double hf_population_merit(const hf_population *p, const hf_form_result *r)
{
    return p->n_objective ? r->objective[0] : r->merit;
}

/* Returns a number below zero if result a is better than b, above zero if it is worse, and 0 if they are equal. */
static int rank_of_two(const hf_population *p, const hf_form_result *a, const hf_form_result *b)
{
    bool are_ok = a->status == HF_OK && b->status == HF_OK;
    double x = are_ok ? hf_population_merit(p, a) : hf_population_violation(a);
    double y = are_ok ? hf_population_merit(p, b) : hf_population_violation(b);
    for (int k = 1; are_ok && x == y && k < p->n_objective; k++) {
        x = a->objective[k];
        y = b->objective[k];
    }
    return (x > y) - (x < y);
}

bool hf_population_is_better(const hf_population *population, int a, int b)
{
    int order = rank_of_two(population, &population->result[a], &population->result[b]);
    return order ? order < 0 : a < b;
}

int hf_population_nearest(const hf_population *p)
{
    int best = p->best;
    for (int i = 0; i < p->n_individual && p->best < 0; i++)
        if (isfinite(hf_population_violation(&p->result[i])) && (best < 0 || hf_population_is_better(p, i, best)))
            best = i;
    return best;
}

/* Returns true if the last evaluation of individual i gave a shape outside the limits. */
static bool was_outside(const hf_population *p, int i)
{
    return p->trial_status[i] != HF_OK && hf_status_has_shape(p->trial_status[i]);
}

bool hf_population_meets_limits(const hf_population *p)
{
    for (int i = 0; i < p->n_individual; i++)
        if (was_outside(p, i)) return false;
    return true;
}

void hf_population_note_trials(hf_population *population)
{
    for (int i = 0; i < population->n_individual; i++) {
        population->trial_status[i] = population->result[i].status;
        population->trial_psi_m[i] = population->result[i].psi_m;
    }
}

void hf_population_take_over(const hf_population *before, int k, hf_population *population, int i)
{
    size_t n = (size_t)population->n_variable;
    memcpy(population->design + (size_t)i * n, before->design + (size_t)k * n, n * sizeof(double));
    population->result[i] = before->result[k];
    population->parent[2 * i] = k;
    population->parent[2 * i + 1] = -1;
}

void hf_population_keep_better(const hf_population *before, hf_population *population)
{
    for (int i = 0; i < population->n_individual; i++)
        if (!population->pending[i] || rank_of_two(population, &before->result[i], &population->result[i]) < 0)
            hf_population_take_over(before, i, population, i);
}

/* Returns the reason for which the run ends after this generation, or HF_POPULATION_RUNNING. Without a feasible design,
 * a run continues as long as the minimum violation falls. A front has no single figure that could stagnate. */
static hf_population_stop judge(const hf_optimize_settings *s, const hf_population *p)
{
    int window = s->stagnation_generations, now = p->generation;
    if (isinf(p->least_violation[now])) return HF_POPULATION_ALL_INFEASIBLE; /* no design has a shape */
    if (now >= window && isnan(p->best_merit[now])) {
        double then = p->least_violation[now - window];
        if (!(then - p->least_violation[now] > VIOLATION_GAIN * then)) return HF_POPULATION_ALL_INFEASIBLE;
    } else if (!p->n_objective && now >= window &&
               p->best_merit[now - window] - p->best_merit[now] < s->stagnation_tolerance_m) {
        return HF_POPULATION_STAGNATION;
    }
    if (now + 1 < p->generation_limit) return HF_POPULATION_RUNNING;
    return isnan(p->best_merit[now]) ? HF_POPULATION_ALL_INFEASIBLE : HF_POPULATION_GENERATIONS;
}

void hf_population_rank(const hf_optimize_settings *s, hf_population *p)
{
    double sum = 0;
    p->n_infeasible = 0;
    p->least_violation[p->generation] = INFINITY;
    p->best = -1;
    p->worst_psi_m = p->mean_psi_m = (double)NAN;
    for (int i = 0; i < p->n_individual; i++) {
        const hf_form_result *r = &p->result[i];
        bool is_infeasible = r->status != HF_OK;
        p->n_evaluation += p->pending[i];
        p->n_evaluation_infeasible += p->pending[i] && p->trial_status[i] != HF_OK;
        p->n_evaluation_above_cap += p->pending[i] && was_outside(p, i);
        p->n_infeasible += is_infeasible;
        p->least_violation[p->generation] = fmin(p->least_violation[p->generation], hf_population_violation(r));
        if (is_infeasible) continue;
        sum += r->psi_m;
        p->worst_psi_m = fmax(p->worst_psi_m, r->psi_m);
        if (p->best < 0 || hf_population_is_better(p, i, p->best)) p->best = i;
    }
    if (p->best >= 0) p->mean_psi_m = sum / (p->n_individual - p->n_infeasible);
    p->best_merit[p->generation] = p->best >= 0 ? hf_population_merit(p, &p->result[p->best]) : (double)NAN;
    p->best_psi_m[p->generation] = p->best >= 0 ? p->result[p->best].psi_m : (double)NAN;
    p->stop_reason = judge(s, p);
}
