/* built_nets - designs of random nets, the as-built nets that are made from them, and samples of these with errors.
 * Header only, like nets.h. */
#pragma once

#include "flexible.h"
#include "laws.h"

#include <hifdm/built_batch.h>

enum { MAX_BUILT_CABLE = 400 };

/* Opens a random saddle net of cables with tensions of about 10 N and EA of 1e3 to 1e5 N, and finds its shape to 1e-11.
 * Every fourth net has no loads, so nodes can be loose. close_design closes it. */
static inline void open_design(struct net *net, int trial, double EA[MAX_BUILT_CABLE], bool on_truss)
{
    struct rng rng = rng_start(900 + (uint64_t)trial);
    *net = (struct net){.form = tight_form(HF_METHOD_NEWTON)};
    random_tension_scene(&rng, &net->scene);
    for (int e = 0; e < net->scene.n_cable; e++)
        EA[e] = rng_uniform(&rng, 1e3, 1e5);
    net->scene.EA_N = EA;
    if (trial % 4 == 3) memset(net->scene.load_N, 0, 3 * (size_t)net->scene.n_node * sizeof(double));
    open_net(net);
    net->form.coupling = (hf_coupling_settings){1e-13, HF_COUPLING_AUTO, 500};
    if (on_truss) attach_all(net, &rng, 1e-5);
    ck_assert_int_eq(hf_evaluate_form(&net->model, &net->form, &net->work, NULL, &net->result), HF_OK);
}

static inline void close_design(struct net *net)
{
    net->scene.EA_N = NULL; /* belongs to the caller */
    close_net(net);
}

static inline void make_built(const struct net *net, hf_built *built, hf_workspace *w)
{
    hf_messages messages = {0};
    ck_assert_msg(hf_built_make("x.yaml", &net->scene, &net->model, &net->form, &net->work, built, &messages) == HF_OK,
                  "%s", messages.text);
    ck_assert_int_eq(hf_workspace_create(&built->model, w), HF_OK);
    poison_workspace(&built->model, w);
}

/* Errors of samples, uniform between minus and plus these values. Each sample has its own stream of random numbers. */
struct errors {
    const hf_model *model;
    uint64_t stream;
    double cut_m, EA_part, support_m;
};

static inline void make_errors(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m)
{
    const struct errors *e = context;
    struct rng rng = rng_start(e->stream + (uint64_t)i);
    for (int k = 0; k < e->model->n_cable; k++) {
        cut_m[k] += rng_uniform(&rng, -e->cut_m, e->cut_m);
        if (EA_N) EA_N[k] *= 1 + rng_uniform(&rng, -e->EA_part, e->EA_part);
    }
    for (int row = e->model->n_free; row < e->model->n_node && support_displacement_m; row++)
        for (int c = 0; c < 3; c++)
            support_displacement_m[c * e->model->n_node + row] += rng_uniform(&rng, -e->support_m, e->support_m);
}
