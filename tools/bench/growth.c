/* Cost growth: the same aperture with more and more modules of 2 x 2 cells, scalloped outer edge (modules of a fixed
 * size with ever finer cells collapse). Times and memory of an FDM step, a Newton step, the form-finding and a chord
 * evaluation. */
#include "bench.h"

#include "linalg/band.h"
#include "search/chord.h"
#include "solve/equilibrium.h"
#include "solve/newton_matrix.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#define ENOUGH_S 0.05
#define ROUNDS 3
#define POPULATION 16 /* two full passes of the lanes */

static double peak_memory_bytes(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * (double)usage.ru_maxrss;
}

typedef struct {
    hf_case settings;
    hf_scene scene;
    hf_model model;
    hf_workspace workspace;
    bench_cholmod *cholmod;
    char name[32];
} net;

static void build(int scale, net *n)
{
    char modules[64];
    snprintf(modules, sizeof modules, "scene.parabolic_cylinder.modules=[%d,%d]", 5 * scale, 6 * scale);
    const char *overrides[] = {modules};
    hf_messages messages = {0};
    memset(n, 0, sizeof *n);
    snprintf(n->name, sizeof n->name, "%dx%d", 10 * scale + 1, 12 * scale + 1);
    if (hf_config_load("configs/reflector.yaml", overrides, 1, &n->settings, &messages) != HF_OK ||
        hf_config_scene(&n->settings, &n->scene, &messages) != HF_OK ||
        hf_model_build(&n->scene, &n->settings.form, &n->model, &messages) != HF_OK)
        bench_fail(n->name, messages.text);
    if (hf_workspace_create(&n->model, &n->workspace) != HF_OK) bench_fail(n->name, "out of memory");
    hf_messages_free(&messages);
}

/* ---- one solve ---- */

static void solve_band(void *context)
{
    net *n = context;
    bench_fdm_step(&n->model, &n->settings.form, &n->workspace);
}

static void solve_cholmod(void *context)
{
    net *n = context;
    bench_cholmod_step(n->cholmod, &n->model, &n->workspace);
    bench_measure(&n->model, &n->settings.form, &n->workspace);
}

static void newton_step(void *context)
{
    net *n = context;
    int n_dof = 3 * n->model.n_free, half_bandwidth = 3 * n->model.half_bandwidth + 2;
    if (hf_newton_matrix_factor(&n->model, &n->workspace, NULL) != HF_OK) bench_fail(n->name, "singular Newton matrix");
    memset(n->workspace.newton_step, 0, (size_t)n_dof * sizeof(double));
    hf_band_back_solve(n_dof, half_bandwidth, 1, n->workspace.newton_band, n->workspace.newton_step, n_dof);
}

static void one_solve(net *n)
{
    double nodes = n->model.n_node, n_free = n->model.n_free;
    hf_form_prepare(&n->model, &n->workspace);
    memcpy(n->workspace.position_m, n->model.position_m, 3 * (size_t)n->model.n_node * sizeof(double));
    n->cholmod = bench_cholmod_create(&n->model);
    for (int round = 0; round < ROUNDS; round++) {
        bench_emit("growth", n->name, "FDM step, band", nodes, "time_s", bench_time_s(solve_band, n, ENOUGH_S));
        if (n->cholmod)
            bench_emit("growth", n->name, "FDM step, CHOLMOD", nodes, "time_s",
                       bench_time_s(solve_cholmod, n, ENOUGH_S));
    }
    bench_emit("growth", n->name, "Newton step, band", nodes, "time_s", bench_time_s(newton_step, n, ENOUGH_S));
    bench_emit("growth", n->name, "FDM step, band", nodes, "bytes", 8.0 * n->model.n_band);
    if (n->cholmod) bench_emit("growth", n->name, "FDM step, CHOLMOD", nodes, "bytes", bench_cholmod_bytes(n->cholmod));
    bench_emit("growth", n->name, "Newton step, band", nodes, "bytes", 72.0 * n_free * (n->model.half_bandwidth + 1));
    bench_emit("growth", n->name, "net", nodes, "n_free", n_free);
    bench_emit("growth", n->name, "net", nodes, "half_bandwidth", n->model.half_bandwidth);
    bench_cholmod_free(n->cholmod);
}

/* ---- form-finding, and evaluations from its shape ---- */

typedef struct {
    hf_batch *batch;
    const double *design;
    hf_form_result result[POPULATION];
} population;

static void evaluate_population(void *context)
{
    population *p = context;
    hf_batch_run(p->batch, POPULATION, p->design, NULL, p->result);
}

static void evaluations(net *n)
{
    const hf_model *m = &n->model;
    hf_batch batch;
    double *initial = bench_alloc((size_t)m->n_variable, sizeof(double));
    double *start_q = bench_alloc((size_t)m->n_cable, sizeof(double));
    double *design = bench_alloc((size_t)m->n_variable * POPULATION, sizeof(double));
    memcpy(start_q, n->workspace.q_N_per_m, (size_t)m->n_cable * sizeof(double));
    for (int k = 0; k < m->n_variable; k++)
        initial[k] = n->workspace.tension_N[m->variable_cable[k]];
    for (int i = 0; i < POPULATION; i++) /* a chain moves together, by up to 1 N */
        for (int k = 0; k < m->n_variable; k++)
            design[i * m->n_variable + k] = initial[k] + (double)((i * 7 + m->variable_group[k] * 5) % 17 - 8) / 8;
    hf_evaluator evaluator = {.model = m,
                              .form = &n->settings.form,
                              .start_q_N_per_m = start_q,
                              .rule = HF_RULE_FORCE_DENSITY,
                              .solver = HF_SOLVER_AUTO,
                              .boundary_ratio_cap = 1e6};
    if (hf_batch_create(&evaluator, 1, &batch) != HF_OK) bench_fail(n->name, "out of memory");
    double start_s = bench_clock_s();
    if (hf_batch_share(&batch, initial) == HF_SOLVER_CHORD) {
        bench_emit("growth", n->name, "chord set-up", m->n_node, "time_s", bench_clock_s() - start_s);
        population p = {.batch = &batch, .design = design};
        double time_s = bench_time_s(evaluate_population, &p, ENOUGH_S) / POPULATION, steps = 0;
        for (int i = 0; i < POPULATION; i++)
            steps += p.result[i].iterations;
        bench_emit("growth", n->name, "chord evaluation", m->n_node, "time_s", time_s);
        bench_emit("growth", n->name, "chord evaluation", m->n_node, "iterations", steps / POPULATION);
        bench_emit("growth", n->name, "chord evaluation", m->n_node, "bytes",
                   2.0 * 8 * 3 * m->n_free * ((3 * m->half_bandwidth + 2 + 3) / 4 * 4));
    }
    hf_batch_free(&batch);
    free(initial);
    free(start_q);
    free(design);
}

void bench_growth(const char *scale, const char *folder)
{
    (void)folder;
    net n;
    hf_form_result r;
    build(atoi(scale), &n);
    one_solve(&n);
    n.settings.form.max_iterations = 2000; /* minutes on the largest net */
    double start_s = bench_clock_s();
    hf_form_prepare(&n.model, &n.workspace);
    hf_equilibrium_find(&n.model, &n.settings.form, &n.workspace, NULL, &r);
    bench_emit("growth", n.name, "form-finding, newton", n.model.n_node, "time_s", bench_clock_s() - start_s);
    bench_emit("growth", n.name, "form-finding, newton", n.model.n_node, "iterations", r.iterations);
    bench_emit("growth", n.name, "form-finding, newton", n.model.n_node, "status", (double)r.status);
    bench_emit("growth", n.name, "form-finding, newton", n.model.n_node, "bytes", (double)hf_workspace_bytes(&n.model));
    if (r.status == HF_OK) evaluations(&n);
    bench_emit("growth", n.name, "process", n.model.n_node, "bytes", peak_memory_bytes());
    hf_workspace_free(&n.workspace);
    hf_model_free(&n.model);
    hf_scene_free(&n.scene);
    hf_case_free(&n.settings);
}
