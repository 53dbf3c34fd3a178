/* twins - as-built nets with errors that the test knows, measured with noise. Header only, like nets.h. */
#pragma once

#include "flexible.h"
#include "laws.h"

#include "built/estimate.h"

enum { TWIN_CABLES = 4000, TWIN_DOFS = 6000, TWIN_SPOOLS = 3 };

typedef struct {
    struct net net;
    hf_built built;
    hf_workspace work; /* the last shape; at first the true one */
    double EA[TWIN_CABLES];
    double sigma_m[TWIN_CABLES], cut_m[TWIN_CABLES]; /* prior deviations, true errors */
    double position_m[TWIN_DOFS], weight_per_m2[TWIN_DOFS], rest_m[TWIN_DOFS];
    double shared[TWIN_SPOOLS], shared_m[TWIN_SPOOLS * TWIN_CABLES]; /* true values; their part of the lengths, m */
    hf_saddle_prior prior;
    struct rng rng;
} twin;

static inline void make_twin(twin *t)
{
    hf_messages messages = {0};
    ck_assert_int_eq(hf_evaluate_form(&t->net.model, &t->net.form, &t->net.work, NULL, &t->net.result), HF_OK);
    ck_assert_msg(hf_built_make("x.yaml", &t->net.scene, &t->net.model, &t->net.form, &t->net.work, &t->built,
                                &messages) == HF_OK,
                  "%s", messages.text);
    ck_assert_int_lt(t->net.model.n_cable, TWIN_CABLES);
    ck_assert_int_lt(3 * t->net.model.n_node, TWIN_DOFS);
    ck_assert_int_eq(hf_workspace_create(&t->built.model, &t->work), HF_OK);
    poison_workspace(&t->built.model, &t->work);
    t->prior = (hf_saddle_prior){.sigma_m = t->sigma_m, .weight_per_m2 = t->weight_per_m2};
}

/* Makes a random saddle with tensions of about 10 N and EA of 1e3 to 1e4 N, on a truss that deflects or on rigid
 * supports. */
static inline void open_random_twin(twin *t, int trial, bool on_truss)
{
    *t = (twin){.rng = rng_start(2600 + (uint64_t)trial), .net.form = tight_form(HF_METHOD_NEWTON)};
    random_tension_scene(&t->rng, &t->net.scene);
    for (int e = 0; e < t->net.scene.n_cable; e++)
        t->EA[e] = rng_uniform(&t->rng, 1e3, 1e4);
    t->net.scene.EA_N = t->EA;
    open_net(&t->net);
    t->net.form.coupling = (hf_coupling_settings){1e-13, HF_COUPLING_AUTO, 500};
    if (on_truss) attach_all(&t->net, &t->rng, 1e-3);
    make_twin(t);
    for (int c = 0; c < 3; c++) /* the target positions are those of the design */
        memcpy(t->built.model.position_m + c * t->built.model.n_node, t->built.position_m + c * t->built.model.n_node,
               sizeof(double) * (size_t)t->built.model.n_free);
}

static inline void close_twin(twin *t)
{
    hf_workspace_free(&t->work);
    hf_built_free(&t->built);
    if (t->net.scene.EA_N == t->EA) t->net.scene.EA_N = NULL;
    close_net(&t->net);
}

/* Returns a number that is approximately normally distributed, the sum of twelve uniform ones. */
static inline double rng_normal(struct rng *rng)
{
    double sum = 0;
    for (int k = 0; k < 12; k++)
        sum += rng_uniform(rng, -0.5, 0.5);
    return sum;
}

/* Adds n spools, each with every n-th cable. The lengths of a spool have a common error with the deviation `ratio`
 * times the length. Must be called before measure_twin. */
static inline void spool_twin(twin *t, int n, double ratio)
{
    const hf_model *m = &t->built.model;
    ck_assert_int_le(n, TWIN_SPOOLS);
    for (int k = 0; k < n; k++)
        for (int e = 0; e < m->n_cable; e++)
            t->shared_m[k * m->n_cable + e] = e % n == k ? ratio * m->target[e] : 0;
    t->prior.n_shared = n;
    t->prior.shared_m = t->shared_m;
}

/* Draws errors of cut lengths and of supports (m), finds the shape that they give, and measures the free nodes and
 * attachments with noise (m). About one node of `missing` is left out (0: none). */
static inline void measure_twin(twin *t, double cut_m, double support_m, double noise_m, int missing)
{
    const hf_model *m = &t->built.model;
    static double length[TWIN_CABLES], off[TWIN_DOFS];
    hf_form_result r;
    for (int k = 0; k < t->prior.n_shared; k++)
        t->shared[k] = rng_normal(&t->rng);
    for (int e = 0; e < m->n_cable; e++) {
        t->sigma_m[e] = cut_m;
        t->cut_m[e] = cut_m * rng_normal(&t->rng);
        for (int k = 0; k < t->prior.n_shared; k++)
            t->cut_m[e] += t->shared[k] * t->shared_m[k * m->n_cable + e];
        length[e] = m->target[e] + t->cut_m[e];
    }
    for (int row = 0; row < m->n_node; row++)
        for (int c = 0; c < 3; c++) {
            t->rest_m[3 * row + c] = row < m->n_free ? 0 : support_m * rng_normal(&t->rng);
            off[c * m->n_node + row] = t->rest_m[3 * row + c];
        }
    t->prior.support_sigma_m = support_m;
    hf_built_net net = {.cut_m = length, .support_displacement_m = off};
    ck_assert_int_eq(hf_built_solve(&t->built, &net, &t->work, &r), HF_OK);
    for (int row = 0; row < m->n_node; row++) {
        bool is_there = row < m->n_free + m->n_attachment && (!missing || rng_int(&t->rng, 1, missing) > 1);
        for (int c = 0; c < 3; c++) {
            t->weight_per_m2[3 * row + c] = is_there ? 1 / (noise_m * noise_m) : 0;
            t->position_m[3 * row + c] = t->work.position_m[c * m->n_node + row] + noise_m * rng_normal(&t->rng);
        }
    }
}
