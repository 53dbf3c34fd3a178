/* built_nets - designs of random nets, the as-built nets that are made from them, and samples of these with errors.
 * Also problems whose objectives or constraints are over as-built nets. Header only, like nets.h. */
#pragma once

#include "flexible.h"
#include "laws.h"

#include <hifdm/built_batch.h>
#include <hifdm/problem.h>

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

/* Opens a problem over as-built nets of cables that stretch: a parabolic cylinder of 3 x 3 modules on fixed supports,
 * or the reflector on its truss. The errors of its cables are so small that none goes slack, because derivatives jump
 * there. `more` ends with NULL and contains further settings. */
static inline void open_built_problem(hf_problem *p, bool on_truss, const char *const *more)
{
    static const char *const common[] = {"form.stop=residual",
                                         "form.residual_tolerance=1e-13",
                                         "form.length_tolerance=1e-13",
                                         "coupling.tof_m=1e-13",
                                         "scene.EA_inner_N=1e4",
                                         "scene.EA_boundary_N=2e4",
                                         "cables=[{expansion_per_K: -2e-6, mass_kg_per_m: 0.01}]",
                                         "tolerance.sigma_cut_m=2e-5",
                                         "tolerance.sigma_EA_ratio=0.01",
                                         "tolerance.sampling=random"};
    static const char *const rigid[] = {"scene.parabolic_cylinder.modules=[3, 3]",
                                        "scene.parabolic_cylinder.edge_tie_m=0.25",
                                        "scene.parabolic_cylinder.pattern=triangle"};
    const char *set[32], *path = on_truss ? "configs/chen2022-truss.yaml" : "configs/reflector.yaml";
    size_t n = sizeof common / sizeof *common, n_rigid = on_truss ? 0 : sizeof rigid / sizeof *rigid;
    hf_messages messages = {0};
    memcpy(set, common, sizeof common);
    memcpy(set + n, rigid, n_rigid * sizeof *rigid);
    for (n += n_rigid; *more; more++) {
        ck_assert_uint_lt(n, sizeof set / sizeof *set);
        set[n++] = *more;
    }
    hf_status status = hf_problem_open(source_path(path), set, (int)n, 1, p, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text);
    hf_messages_free(&messages);
}
