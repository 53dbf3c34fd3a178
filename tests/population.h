/* population - designs around the boundary tensions of a found shape, for tests of code that evaluates many designs. */
#pragma once

#include "nets.h"

#include <hifdm/evaluate.h>

enum { MAX_VARIABLE = 200, MAX_CABLE = 600, N_DESIGN = 29 }; /* N_DESIGN is no multiple of the lanes */
#define TOLERANCE 1e-10

struct run {
    struct net net;
    hf_evaluator evaluator;
    double start_q[MAX_CABLE], initial[MAX_VARIABLE], design[N_DESIGN * MAX_VARIABLE];
};

/* Finds the shape of net->scene, and draws designs up to range_N around its boundary tensions. */
static inline void draw_designs(struct run *r, uint64_t seed, double range_N)
{
    const hf_model *m = &r->net.model;
    struct rng rng = rng_start(seed);
    ck_assert(m->n_variable > 0 && m->n_variable <= MAX_VARIABLE && m->n_cable <= MAX_CABLE);
    ck_assert_int_eq(find_shape(&r->net), HF_OK);
    memcpy(r->start_q, r->net.work.q_N_per_m, (size_t)m->n_cable * sizeof(double));
    for (int k = 0; k < m->n_variable; k++)
        r->initial[k] = r->net.work.tension_N[m->variable_cable[k]];
    for (int i = 0; i < N_DESIGN * m->n_variable; i++)
        r->design[i] = r->initial[i % m->n_variable] + rng_uniform(&rng, -range_N, range_N);
}

static inline void evaluate_by(struct run *r, int rule, hf_solver solver)
{
    r->evaluator = (hf_evaluator){.model = &r->net.model,
                                  .form = &r->net.form,
                                  .start_q_N_per_m = r->start_q,
                                  .rule = (hf_rule)rule,
                                  .solver = solver,
                                  .boundary_ratio_cap = 1e9};
}

/* Finds a shape to TOLERANCE and draws designs for the population solver, up to 0.5 N around the found tensions. Under
 * the rule tension it is 0.01 N, because after larger changes there may be no equilibrium. */
static inline void start_run(struct run *r, int rule)
{
    r->net.form.residual_tolerance = r->net.form.length_tolerance = TOLERANCE;
    r->net.form.max_iterations = 100000;
    draw_designs(r, 31, rule == HF_RULE_TENSION ? 0.01 : 0.5);
    evaluate_by(r, rule, HF_SOLVER_CHORD);
}

static inline void open_run(struct run *r, int rule)
{
    OPEN_CASE(&r->net, SMALL_REFLECTOR);
    start_run(r, rule);
}

static inline double *design(struct run *r, int i)
{
    return r->design + i * r->net.model.n_variable;
}
