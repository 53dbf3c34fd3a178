/* Contents: ways to do a step - files for the peers in Python - the section */
#include "bench.h"

#include "linalg/band.h"
#include "linalg/lapack.h"
#include "search/swarm.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ENOUGH_S 0.05
#define ITERATIONS 200 /* of hf_form_find, to spread what it does once over many */

typedef void dpbsv_routine(const char *uplo, const int *n, const int *kd, const int *nrhs, double *ab, const int *ldab,
                           double *b, const int *ldb, int *info);

/* ---- ways to do a step: assembly, factor, three right-hand sides, lengths and tensions, per individual ---- */

typedef struct {
    bench_scene *scene;
    bench_cholmod *cholmod;
    hf_form_settings settings;
    hf_swarm_plan plan;
    hf_swarm_lanes lanes;
    hf_swarm_measures measures;
} step_context;

static void step_ours(void *context)
{
    bench_scene *b = ((step_context *)context)->scene;
    bench_fdm_step(&b->model, &b->form, &b->workspace);
}

static void step_by_lapack(bench_scene *b, bool at_once)
{
    const hf_model *m = &b->model;
    double *band = b->workspace.band, *x = b->workspace.position_m;
    int three = 3, ldab = m->half_bandwidth + 1, info;
    hf_form_assemble(m, &b->workspace);
    hf_form_assemble_loads(m, &b->workspace);
    if (at_once) {
        ((dpbsv_routine *)hf_lapack_find("dpbsv_"))("L", &m->n_free, &m->half_bandwidth, &three, band, &ldab, x,
                                                    &m->n_node, &info);
    } else {
        hf_lapack()->dpbtrf("L", &m->n_free, &m->half_bandwidth, band, &ldab, &info);
        hf_lapack()->dpbtrs("L", &m->n_free, &m->half_bandwidth, &three, band, &ldab, x, &m->n_node, &info);
    }
    bench_measure(m, &b->form, &b->workspace);
}

static void step_dpbtrf(void *context)
{
    step_by_lapack(((step_context *)context)->scene, false);
}

static void step_dpbsv(void *context)
{
    step_by_lapack(((step_context *)context)->scene, true);
}

static void step_cholmod(void *context)
{
    step_context *c = context;
    bench_cholmod_step(c->cholmod, &c->scene->model, &c->scene->workspace);
    bench_measure(&c->scene->model, &c->scene->form, &c->scene->workspace);
}

/* Eight individuals; the force densities stay, as in the rows above. */
static void step_lanes(void *context)
{
    step_context *c = context;
    c->plan.kernels->solve(&c->plan, &c->lanes);
    c->plan.kernels->measure(&c->plan, &c->lanes, &c->measures);
}

static void create_lanes(step_context *c)
{
    const hf_model *m = &c->scene->model;
    if (hf_swarm_plan_create(m, hf_lane_best_isa(), &c->plan) != HF_OK ||
        hf_swarm_lanes_create(&c->plan, &c->lanes) != HF_OK)
        bench_fail("lanes", "out of memory");
    memcpy(c->scene->workspace.position_m, m->position_m, 3 * (size_t)m->n_node * sizeof(double));
    for (int lane = 0; lane < HF_LANES; lane++)
        hf_swarm_put(&c->plan, &c->scene->workspace, lane, &c->lanes);
    memcpy(c->lanes.law, c->scene->workspace.law, (size_t)m->n_cable);
}

/* The whole of hf_form_find: also the residual, the laws and the stopping rule of every iteration. */
static void step_form_find(void *context)
{
    step_context *c = context;
    hf_form_result r;
    hf_form_prepare(&c->scene->model, &c->scene->workspace);
    hf_form_find(&c->scene->model, &c->settings, HF_STOP_RESIDUAL, &c->scene->workspace, NULL, &r);
}

typedef struct {
    const char *name;
    void (*work)(void *context);
    double individuals; /* that one call steps */
} step_row;

static const step_row step_table[] = {
    {"dpbtrf", step_dpbtrf, 1},
    {"dpbsv", step_dpbsv, 1},
    {"CHOLMOD", step_cholmod, 1},
    {"band", step_ours, 1},
    {"hf_form_find", step_form_find, ITERATIONS},
    {"lanes", step_lanes, HF_LANES},
};

/* ---- files for the peers in Python ---- */

static void write_doubles(FILE *file, const char *name, int n, const double *value)
{
    fprintf(file, "%s %d", name, n);
    for (int i = 0; i < n; i++)
        fprintf(file, " %.17g", value[i]);
    fputc('\n', file);
}

static void write_ints(FILE *file, const char *name, int n, const int *value)
{
    fprintf(file, "%s %d", name, n);
    for (int i = 0; i < n; i++)
        fprintf(file, " %d", value[i]);
    fputc('\n', file);
}

void bench_write_net(const bench_scene *b, const hf_workspace *w, const double *reference_m, const char *folder,
                     const char *name)
{
    const hf_model *m = &b->model;
    char file_name[HF_PATH_SIZE];
    snprintf(file_name, sizeof file_name, "%s.net", name);
    FILE *file = bench_open_file(folder, file_name);
    int size[] = {m->n_node, m->n_free, m->n_cable, m->half_bandwidth};
    write_ints(file, "size", 4, size);
    write_ints(file, "end_row", 2 * m->n_cable, m->end_row);
    write_doubles(file, "position_m", 3 * m->n_node, m->position_m);
    write_doubles(file, "load_N", m->load_N ? 3 * m->n_node : 0, m->load_N);
    write_doubles(file, "q", m->n_cable, w->q_N_per_m);
    write_doubles(file, "target", m->n_cable, w->target);
    fprintf(file, "law %d", m->n_cable);
    for (int e = 0; e < m->n_cable; e++)
        fprintf(file, " %d", w->law[e]);
    fputc('\n', file);
    write_doubles(file, "reference_m", 3 * m->n_node, reference_m ? reference_m : m->position_m);
    fclose(file);
}

/* ---- the section ---- */

void bench_step(const char *what, const char *folder)
{
    (void)what;
    bench_scene b;
    bench_scene_named("21x25 perimeter", folder, &b);
    hf_form_prepare(&b.model, &b.workspace);
    bench_write_net(&b, &b.workspace, NULL, folder, "step");
    step_context c = {.scene = &b, .cholmod = bench_cholmod_create(&b.model), .settings = b.form};
    create_lanes(&c);
    c.settings.residual_tolerance = 0; /* never reached */
    c.settings.max_iterations = ITERATIONS;
    double *first = bench_alloc(3 * (size_t)b.model.n_node, sizeof *first);
    for (int round = 0; round < 5; round++)
        for (size_t i = 0; i < sizeof step_table / sizeof *step_table; i++) {
            const step_row *row = &step_table[i];
            if (row->work == step_cholmod && !c.cholmod) continue;
            hf_form_prepare(&b.model, &b.workspace);
            memcpy(b.workspace.position_m, b.model.position_m, 3 * (size_t)b.model.n_node * sizeof(double));
            bench_emit("step", b.name, row->name, b.model.n_free, "time_s",
                       bench_time_s(row->work, &c, ENOUGH_S) / row->individuals);
            if (i == 0) memcpy(first, b.workspace.position_m, 3 * (size_t)b.model.n_node * sizeof(double));
            if (row->work == step_lanes) hf_swarm_get(&c.plan, &c.lanes, HF_LANES - 1, &b.workspace);
            if (row->work != step_form_find) /* all ways give the same shape */
                bench_emit("step", b.name, row->name, b.model.n_free, "difference_m",
                           bench_distance_m(&b.model, first, b.workspace.position_m));
        }
    bench_emit("step", b.name, "net", b.model.n_free, "half_bandwidth", b.model.half_bandwidth);
    hf_arena_free(&c.lanes.arena);
    hf_arena_free_block(c.plan.block);
    bench_cholmod_free(c.cholmod);
    free(first);
    bench_scene_free(&b);
}
