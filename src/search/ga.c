/* Contents: random numbers - memory - linked genes - the first generation - adaptive rates - selection - variation -
 * ranking - the next generation */
#include <hifdm/ga.h>

#include "base/arena.h"
#include "base/random.h"
#include "net/symmetry.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Intermediate recombination, one draw per chain, reaches this far beyond the parents, so that the population's spread
 * does not shrink by recombination alone. */
#define RECOMBINATION_REACH 0.25
/* Mutation steps run from the whole range down to 2^-MUTATION_OCTAVES of it, all scales equally likely. */
#define MUTATION_OCTAVES 16
/* Even the worst individual keeps this share of the best one's fitness. */
#define FITNESS_FLOOR 0.02

const char *const hf_ga_stop_word[4] = {"running", "stagnation", "generations", "all_infeasible"};

/* ---- random numbers: one stream per (seed, generation, individual) ---- */

static hf_random stream_open(uint64_t seed, int generation, int individual)
{
    uint64_t place = (uint64_t)(uint32_t)generation << 32 | (uint32_t)individual;
    return (hf_random){hf_random_mix(hf_random_mix(seed + HF_RANDOM_STEP) ^ hf_random_mix(place + 2 * HF_RANDOM_STEP))};
}

/* ---- memory ---- */

static void lay_out(hf_arena *a, hf_ga *g)
{
    size_t n = (size_t)g->n_individual, k = (size_t)g->n_gene;
    g->lower_N = hf_arena_take(a, k, sizeof(double));
    g->upper_N = hf_arena_take(a, k, sizeof(double));
    g->base_N = hf_arena_take(a, k, sizeof(double));
    g->design_N = hf_arena_take(a, n * k, sizeof(double));
    g->next_design_N = hf_arena_take(a, n * k, sizeof(double));
    g->result = hf_arena_take(a, n, sizeof(hf_form_result));
    g->next_result = hf_arena_take(a, n, sizeof(hf_form_result));
    g->pending = hf_arena_take(a, n, 1);
    g->next_pending = hf_arena_take(a, n, 1);
    g->crossover_rate = hf_arena_take(a, n, sizeof(double));
    g->next_crossover_rate = hf_arena_take(a, n, sizeof(double));
    g->mutation_rate = hf_arena_take(a, n, sizeof(double));
    g->next_mutation_rate = hf_arena_take(a, n, sizeof(double));
    g->parent = hf_arena_take(a, 2 * n, sizeof(int));
    g->next_parent = hf_arena_take(a, 2 * n, sizeof(int));
    g->group_draw = hf_arena_take(a, (size_t)g->n_group, sizeof(double));
    g->fitness = hf_arena_take(a, n, sizeof(double));
    g->best_psi_m = hf_arena_take(a, (size_t)g->settings->generations, sizeof(double));
}

static double clamp(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

/* ---- linked genes ---- */

/* Does the gene decide on its own step? */
static int leads(const hf_ga *g, int k)
{
    return !g->gene_leader || g->gene_leader[k] == k;
}

/* The bounds of a class are those of the step that all its genes can take. Where there is none each gene keeps its own,
 * and clamps to them. */
static void link_bounds(hf_ga *g)
{
    for (int leader = 0; g->gene_leader && leader < g->n_gene; leader++) {
        double low = -INFINITY, high = INFINITY;
        if (!leads(g, leader)) continue;
        for (int k = leader; k < g->n_gene; k++) {
            if (g->gene_leader[k] != leader) continue;
            low = fmax(low, g->lower_N[k] - g->base_N[k]);
            high = fmin(high, g->upper_N[k] - g->base_N[k]);
        }
        for (int k = leader; low < high && k < g->n_gene; k++) {
            if (g->gene_leader[k] != leader) continue;
            g->lower_N[k] = fmax(g->lower_N[k], g->base_N[k] + low);
            g->upper_N[k] = fmin(g->upper_N[k], g->base_N[k] + high);
        }
    }
}

static void follow_leaders(const hf_ga *g, double *design_N)
{
    if (!g->gene_leader) return;
    hf_symmetry_follow(g->n_gene, g->gene_leader, g->base_N, design_N);
    for (int k = 0; k < g->n_gene; k++)
        design_N[k] = clamp(design_N[k], g->lower_N[k], g->upper_N[k]);
}

/* ---- the first generation ---- */

/* Eq. 13 around the base, with one random number per chain (see mutate). Individual 0 is the base itself, so that the
 * result is never worse than it. */
static void first_generation(const double *base_N, hf_ga *g)
{
    const hf_optimize_settings *s = g->settings;
    for (int k = 0; k < g->n_gene; k++) {
        g->lower_N[k] = clamp(base_N[k] - s->range_N, s->min_tension_N, s->max_tension_N);
        g->upper_N[k] = clamp(base_N[k] + s->range_N, s->min_tension_N, s->max_tension_N);
    }
    link_bounds(g);
    for (int i = 0; i < g->n_individual; i++) {
        hf_random random = stream_open(s->seed, 0, i);
        for (int j = 0; j < g->n_group; j++)
            g->group_draw[j] = i == 0 ? 0 : 2 * hf_random_uniform(&random) - 1;
        for (int k = 0; k < g->n_gene; k++) {
            double step = s->range_N * g->group_draw[g->gene_group[k]];
            g->design_N[(size_t)i * (size_t)g->n_gene + (size_t)k] =
                clamp(base_N[k] + step, g->lower_N[k], g->upper_N[k]);
        }
        follow_leaders(g, g->design_N + (size_t)i * (size_t)g->n_gene);
        g->pending[i] = 1;
        g->crossover_rate[i] = g->mutation_rate[i] = (double)NAN;
        g->parent[2 * i] = g->parent[2 * i + 1] = -1;
    }
}

hf_status hf_ga_create(const hf_optimize_settings *settings, const hf_model *model, const double *base_N, hf_ga *ga)
{
    *ga = (hf_ga){.settings = settings, .n_gene = model->n_gene, .n_individual = settings->population, .best = -1};
    ga->gene_group = model->gene_group;
    ga->n_group = model->n_gene_group;
    ga->gene_leader = model->n_leader < model->n_gene ? model->gene_leader : NULL;
    ga->n_leader = ga->gene_leader ? model->n_leader : model->n_gene;
    hf_arena arena = {0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, ga)));
    ga->block = arena.block;
    memcpy(ga->base_N, base_N, (size_t)ga->n_gene * sizeof *base_N);
    first_generation(base_N, ga);
    return HF_OK;
}

void hf_ga_free(hf_ga *ga)
{
    free(ga->block);
    *ga = (hf_ga){0};
}

/* ---- adaptive rates (Srinivas & Patnaik 1994, minimising): the better an individual, the less it is disturbed ---- */

static double adaptive(const hf_ga *g, double high, double low, double psi_m)
{
    double best = g->result[g->best].psi_m, spread = g->mean_psi_m - best;
    if (!(psi_m <= g->mean_psi_m) || !(spread > 0)) return high;
    return high - (high - low) * (g->mean_psi_m - psi_m) / spread;
}

/* ---- selection ---- */

static void set_fitness(hf_ga *g)
{
    double spread = g->best < 0 ? 0 : g->worst_psi_m - g->result[g->best].psi_m;
    for (int i = 0; i < g->n_individual; i++) {
        const hf_form_result *r = &g->result[i];
        if (g->best < 0)
            g->fitness[i] = 1;
        else if (r->status != HF_OK)
            g->fitness[i] = 0;
        else
            g->fitness[i] = spread > 0 ? (g->worst_psi_m - r->psi_m) / spread + FITNESS_FLOOR : 1;
    }
}

static int spin_roulette(const hf_ga *g, hf_random *random)
{
    double total = 0;
    for (int i = 0; i < g->n_individual; i++)
        total += g->fitness[i];
    double left = hf_random_uniform(random) * total;
    int last = 0;
    for (int i = 0; i < g->n_individual; i++) {
        if (!(g->fitness[i] > 0)) continue;
        last = i;
        left -= g->fitness[i];
        if (left < 0) break;
    }
    return last;
}

/* ---- variation ---- */

static void recombine(const hf_ga *g, const double *a, const double *b, double *child, hf_random *random)
{
    for (int j = 0; j < g->n_group; j++)
        g->group_draw[j] = hf_random_uniform(random) * (1 + 2 * RECOMBINATION_REACH) - RECOMBINATION_REACH;
    for (int k = 0; k < g->n_gene; k++) {
        double share = g->group_draw[g->gene_group[k]];
        child[k] = clamp(a[k] + share * (b[k] - a[k]), g->lower_N[k], g->upper_N[k]);
    }
}

/* A step with a random sign and scale, relative to the range; 0 with probability 1 - rate. */
static double mutation_step(double rate, hf_random *random)
{
    if (hf_random_uniform(random) >= rate) return 0;
    double sign = hf_random_uniform(random) < 0.5 ? -1 : 1;
    return sign * exp2(-MUTATION_OCTAVES * hf_random_uniform(random));
}

/* The cables of a chain move together: an unequal change drags the chain's nodes along it, which raises psi steeply, so
 * that independent steps on every gene are nearly always refused (measured: 400 generations then gain 1 um instead of
 * 240 um). Single genes still mutate, `rate` of them per individual. */
static void mutate(const hf_ga *g, double rate, double *child, hf_random *random)
{
    double single = rate / g->n_leader;
    for (int j = 0; j < g->n_group; j++)
        g->group_draw[j] = mutation_step(rate, random);
    for (int k = 0; k < g->n_gene; k++) {
        if (!leads(g, k)) continue;
        double step = g->group_draw[g->gene_group[k]] + mutation_step(single, random);
        child[k] = clamp(child[k] + step * (g->upper_N[k] - g->lower_N[k]), g->lower_N[k], g->upper_N[k]);
    }
}

/* One child from two parents of its own stream; a child equal to its first parent needs no evaluation. */
static void breed(hf_ga *g, int i)
{
    const hf_optimize_settings *s = g->settings;
    size_t n = (size_t)g->n_gene;
    hf_random random = stream_open(s->seed, g->generation + 1, i);
    int a = spin_roulette(g, &random), b = spin_roulette(g, &random);
    const double *mother = g->design_N + (size_t)a * n, *father = g->design_N + (size_t)b * n;
    double *child = g->next_design_N + (size_t)i * n;
    double psi = fmin(g->result[a].psi_m, g->result[b].psi_m); /* fmin ignores the NaN of an infeasible parent */
    double pc = g->best < 0 ? s->crossover_high : adaptive(g, s->crossover_high, s->crossover_low, psi);
    double pm = g->best < 0 ? s->mutation_high : adaptive(g, s->mutation_high, s->mutation_low, psi);
    if (hf_random_uniform(&random) < pc)
        recombine(g, mother, father, child, &random);
    else
        memcpy(child, mother, n * sizeof *child);
    mutate(g, pm, child, &random);
    follow_leaders(g, child);
    g->next_pending[i] = memcmp(child, mother, n * sizeof *child) != 0;
    g->next_result[i] = g->result[a];
    g->next_crossover_rate[i] = pc;
    g->next_mutation_rate[i] = pm;
    g->next_parent[2 * i] = a;
    g->next_parent[2 * i + 1] = b;
}

/* ---- ranking ---- */

/* Is a better than b? Infeasible ones come last, ties go to the lower index. */
static int is_better(const hf_ga *g, int a, int b)
{
    int a_ok = g->result[a].status == HF_OK, b_ok = g->result[b].status == HF_OK;
    if (!a_ok || !b_ok) return a_ok > b_ok || (a_ok == b_ok && a < b);
    if (g->result[a].psi_m != g->result[b].psi_m) return g->result[a].psi_m < g->result[b].psi_m;
    return a < b;
}

static hf_ga_stop judge(const hf_ga *g)
{
    const hf_optimize_settings *s = g->settings;
    int window = s->stagnation_generations, now = g->generation;
    if (now >= window) {
        if (isnan(g->best_psi_m[now])) return HF_GA_ALL_INFEASIBLE;
        if (g->best_psi_m[now - window] - g->best_psi_m[now] < s->stagnation_tolerance_m) return HF_GA_STAGNATION;
    }
    if (now + 1 < s->generations) return HF_GA_RUNNING;
    return isnan(g->best_psi_m[now]) ? HF_GA_ALL_INFEASIBLE : HF_GA_GENERATIONS;
}

void hf_ga_tell(hf_ga *g)
{
    double sum = 0;
    g->n_infeasible = 0;
    g->best = -1;
    g->worst_psi_m = g->mean_psi_m = (double)NAN;
    for (int i = 0; i < g->n_individual; i++) {
        const hf_form_result *r = &g->result[i];
        int infeasible = r->status != HF_OK;
        g->n_evaluation += g->pending[i];
        g->n_evaluation_infeasible += g->pending[i] && infeasible;
        g->n_infeasible += infeasible;
        if (infeasible) continue;
        sum += r->psi_m;
        g->worst_psi_m = fmax(g->worst_psi_m, r->psi_m);
        if (g->best < 0 || is_better(g, i, g->best)) g->best = i;
    }
    if (g->best >= 0) g->mean_psi_m = sum / (g->n_individual - g->n_infeasible);
    g->best_psi_m[g->generation] = g->best >= 0 ? g->result[g->best].psi_m : (double)NAN;
    g->stop_reason = judge(g);
}

/* ---- the next generation ---- */

/* The elite-th best individual, by repeated selection (elites are few). `taken` marks those already chosen. */
static int next_elite(const hf_ga *g, const unsigned char *taken)
{
    int best = -1;
    for (int i = 0; i < g->n_individual; i++)
        if (!taken[i] && (best < 0 || is_better(g, i, best))) best = i;
    return best;
}

static void keep_elites(hf_ga *g)
{
    size_t n = (size_t)g->n_gene;
    unsigned char *taken = g->next_pending; /* what is pending comes with breed() */
    memset(taken, 0, (size_t)g->n_individual);
    for (int e = 0; e < g->settings->elites; e++) {
        int i = next_elite(g, taken);
        taken[i] = 1;
        memcpy(g->next_design_N + (size_t)e * n, g->design_N + (size_t)i * n, n * sizeof(double));
        g->next_result[e] = g->result[i];
        g->next_crossover_rate[e] = g->next_mutation_rate[e] = 0;
        g->next_parent[2 * e] = g->next_parent[2 * e + 1] = i;
    }
    memset(g->next_pending, 0, (size_t)g->n_individual);
}

int hf_ga_next(hf_ga *g)
{
    if (g->stop_reason != HF_GA_RUNNING) return 0;
    set_fitness(g);
    keep_elites(g);
    for (int i = g->settings->elites; i < g->n_individual; i++)
        breed(g, i);
#define EXCHANGE(type, member)                                                                                         \
    do {                                                                                                               \
        type *now = g->member;                                                                                         \
        g->member = g->next_##member;                                                                                  \
        g->next_##member = now;                                                                                        \
    } while (0)
    EXCHANGE(double, design_N);
    EXCHANGE(double, crossover_rate);
    EXCHANGE(double, mutation_rate);
    EXCHANGE(hf_form_result, result);
    EXCHANGE(unsigned char, pending);
    EXCHANGE(int, parent);
#undef EXCHANGE
    g->generation++;
    return 1;
}
