/* A truss of about 1000 nodes and 4300 members, as the generator makes them: factor and five load cases; and the truss
 * of the paper's case with its condensation. */
#include "bench.h"

#include <hifdm/config.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define ENOUGH_S 0.2
#define N_CASE 5

typedef struct {
    hf_truss truss;
    hf_frame frame;
    hf_messages messages;
    hf_frame_load load[N_CASE];
    double *force;                                      /* [N_CASE][n_node][6] */
    double *work, *displacement, *reaction, *end_force; /* of a case but for work and displacement */
} frame_context;

static void work_build(void *context)
{
    frame_context *c = context;
    hf_frame_free(&c->frame);
    if (hf_frame_build(&c->truss, &c->frame, &c->messages) != HF_OK) bench_fail("frame", c->messages.text);
}

/* Displacements, reactions and end forces of all cases. */
static void work_cases(void *context)
{
    frame_context *c = context;
    int bad_dof;
    hf_frame_solve(&c->frame, N_CASE, c->load, c->work, c->displacement, &bad_dof);
    for (int k = 0; k < N_CASE; k++) {
        const double *u = c->displacement + (size_t)k * HF_TRUSS_DOF * (size_t)c->truss.n_node;
        hf_frame_reactions(&c->frame, &c->load[k], u, c->reaction, NULL);
        hf_frame_member_forces(&c->frame, &c->load[k], u, c->end_force);
    }
}

static void work_all(void *context)
{
    work_build(context);
    work_cases(context);
}

static void make_loads(frame_context *c)
{
    size_t n = HF_TRUSS_DOF * (size_t)c->truss.n_node;
    c->force = bench_alloc(N_CASE * n, sizeof(double));
    c->displacement = bench_alloc(N_CASE * n, sizeof(double));
    c->reaction = bench_alloc(n, sizeof(double));
    c->end_force = bench_alloc(12 * (size_t)c->truss.n_member, sizeof(double));
    for (size_t k = 0; k < N_CASE; k++) {
        for (size_t i = 0; i < n; i++)
            c->force[k * n + i] = i % HF_TRUSS_DOF == k % 3 ? 10 * cos((double)(i * (k + 1))) : 0;
        c->load[k] = (hf_frame_load){.force = c->force + k * n};
    }
}

static void large_truss(void)
{
    static const hf_cylinder cylinder = {.aperture_m = 42, .length_m = 44, .focal_length_m = 30, .modules = {21, 22}};
    static const hf_truss_settings settings = {.depth_m = 1,
                                               .main_every = 1,
                                               .bud = {0.03, 0.001, 1, HF_DIAGONALS_CROSSED},
                                               .mbug = {0.03, 0.001, 1, HF_DIAGONALS_CROSSED},
                                               .abug = {0.03, 0.001, 1, HF_DIAGONALS_CROSSED},
                                               .E_Pa = 130e9,
                                               .G_Pa = 5e9,
                                               .density_kg_per_m3 = 1600};
    frame_context c = {0};
    char name[64];
    if (hf_truss_generate(&settings, &cylinder, &c.truss, &c.messages) != HF_OK) bench_fail("frame", c.messages.text);
    snprintf(name, sizeof name, "truss of %d nodes and %d members", c.truss.n_node, c.truss.n_member);
    work_build(&c);
    make_loads(&c);
    c.work = bench_alloc(hf_frame_work_size(&c.frame, N_CASE), sizeof(double));
    double n_dof = c.frame.n_dof;
    bench_emit("frame", name, "number; assemble; factor", n_dof, "time_s", bench_time_s(work_build, &c, ENOUGH_S));
    bench_emit("frame", name, "five load cases", n_dof, "time_s", bench_time_s(work_cases, &c, ENOUGH_S));
    bench_emit("frame", name, "factor and five load cases", n_dof, "time_s", bench_time_s(work_all, &c, ENOUGH_S));
    bench_emit("frame", name, "factor and five load cases", n_dof, "half_bandwidth", c.frame.half_bandwidth);
    hf_frame_free(&c.frame);
    hf_truss_free(&c.truss);
    free(c.force);
    free(c.work);
    free(c.displacement);
    free(c.reaction);
    free(c.end_force);
}

typedef struct {
    hf_case settings;
    hf_scene scene;
    hf_carrier carrier;
    hf_messages messages;
} carrier_context;

static void work_carrier(void *context)
{
    carrier_context *c = context;
    hf_carrier_free(&c->carrier);
    if (hf_config_carrier(&c->settings, &c->scene, &c->carrier, &c->messages) != HF_OK)
        bench_fail("frame", c->messages.text);
}

static void truss_of_the_paper(void)
{
    carrier_context c = {0};
    if (hf_config_load("configs/straight-edges-truss.yaml", NULL, 0, &c.settings, &c.messages) != HF_OK ||
        hf_config_scene(&c.settings, &c.scene, &c.messages) != HF_OK)
        bench_fail("frame", c.messages.text);
    work_carrier(&c);
    bench_emit("frame", "straight-edges-truss", "generate; factor; condense to 36 attachments", c.carrier.frame.n_dof,
               "time_s", bench_time_s(work_carrier, &c, ENOUGH_S));
    bench_emit("frame", "straight-edges-truss", "generate; factor; condense to 36 attachments", c.carrier.frame.n_dof,
               "half_bandwidth", c.carrier.frame.half_bandwidth);
    hf_carrier_free(&c.carrier);
    hf_scene_free(&c.scene);
    hf_case_free(&c.settings);
}

void bench_frame(const char *what, const char *folder)
{
    (void)what;
    (void)folder;
    large_truss();
    truss_of_the_paper();
}
