/* A whole run, stage by stage, of a case that only needs the force density method, one that is form-found, and one that
 * is optimised as well: what takes how long, and how much memory each stage has allocated and keeps. What a case does
 * not need has no sample. The order of the calls is that of `hifdm run`.
 *
 * Contents: samples - cases - stages of the optimisation - the run */
#include "bench.h"

#include "polish.h"
#include "symmetry.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HISTORY_MAX 1000000 /* iterations whose history is kept */

/* ---- samples ---- */

enum { READ, SCENE, MODEL, HISTORY, FORM, SETUP, EVALUATE, BREED, POLISH, STORE, N_STAGE };
static const char *const stage_word[N_STAGE] = {
    "read case", "scene",          "model",          "room for the history", "form-finding",
    "GA set-up", "GA evaluations", "GA bookkeeping", "Levenberg-Marquardt",  "storing"};

/* Bytes in use on the heap; 0 where the C library does not tell. */
static double heap_bytes(void)
{
#if defined __GLIBC__ && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
    struct mallinfo2 now = mallinfo2();
    return (double)now.uordblks + (double)now.hblkhd;
#else
    return 0;
#endif
}

typedef struct {
    hf_case settings;
    hf_scene scene;
    hf_model model;
    hf_workspace workspace;
    hf_history history;
    double *start_q_N_per_m, *base_N;
    hf_evaluator evaluator;
    hf_batch batch;
    hf_ga ga;
    hf_store *store;
    hf_summary summary;
    hf_messages messages;
    int ran[N_STAGE];
    double time_s[N_STAGE], kept_bytes[N_STAGE];
    double since_s, before_bytes;
} run;

/* What has passed since the last call belongs to this stage. */
static void charge(run *r, int stage)
{
    double bytes = heap_bytes();
    r->time_s[stage] += bench_clock_s() - r->since_s;
    r->kept_bytes[stage] += bytes - r->before_bytes;
    r->ran[stage] = 1;
    r->before_bytes = bytes;
    r->since_s = bench_clock_s();
}

static void need(run *r, hf_status status)
{
    if (status != HF_OK) bench_fail(r->settings.path, r->messages.text ? r->messages.text : hf_status_text(status));
}

/* ---- stages of the optimisation ---- */

static void set_up(run *r)
{
    const hf_model *m = &r->model;
    const hf_optimize_settings *o = &r->settings.optimize;
    r->start_q_N_per_m = bench_alloc((size_t)m->n_cable, sizeof(double));
    r->base_N = bench_alloc((size_t)m->n_gene, sizeof(double));
    memcpy(r->start_q_N_per_m, r->workspace.q_N_per_m, (size_t)m->n_cable * sizeof(double));
    for (int k = 0; k < m->n_gene; k++)
        r->base_N[k] = r->workspace.tension_N[m->gene_cable[k]];
    hf_symmetry_average(m, r->base_N);
    r->evaluator = (hf_evaluator){m, &r->settings.form, r->start_q_N_per_m, o->rule, o->solver, o->boundary_ratio_cap};
    need(r, hf_batch_create(&r->evaluator, 0, &r->batch));
    need(r, hf_ga_create(o, m, r->base_N, &r->ga));
    hf_batch_share(&r->batch, r->base_N);
    charge(r, SETUP);
}

static void evolve(run *r)
{
    double spent_s[BENCH_N_PART] = {0};
    bench_evolve(&r->model, &r->batch, r->store, &r->ga, spent_s);
    if (r->ga.best < 0) bench_fail(r->settings.path, "no feasible design");
    charge(r, EVALUATE); /* memory: evaluating and bookkeeping allocate nothing, what grows is the store's */
    r->kept_bytes[STORE] += r->kept_bytes[EVALUATE];
    r->kept_bytes[EVALUATE] = 0;
    r->time_s[EVALUATE] = spent_s[BENCH_EVALUATE];
    r->time_s[BREED] = spent_s[BENCH_BREED];
    r->time_s[STORE] += spent_s[BENCH_STORE];
    r->ran[BREED] = 1;
}

static void polish(run *r)
{
    hf_polish_result outcome;
    hf_form_result again;
    double *design = r->ga.design_N + (size_t)r->ga.best * (size_t)r->ga.n_gene;
    hf_workspace *w = hf_batch_run_one(&r->batch, design, &again);
    charge(r, EVALUATE);
    need(r, hf_store_best(r->store, HF_STAGE_OPTIMIZE, &r->model, w, design, &r->messages));
    charge(r, STORE);
    if (!hf_polish_applies(&r->evaluator)) return;
    need(r, hf_polish_run(&r->evaluator, r->ga.lower_N, r->ga.upper_N, r->settings.optimize.polish_iterations, design,
                          &r->workspace, &outcome));
    hf_evaluate(&r->evaluator, design, &r->workspace, &r->summary.polish);
    charge(r, POLISH);
    need(r, hf_store_best(r->store, HF_STAGE_POLISH, &r->model, &r->workspace, design, &r->messages));
    charge(r, STORE);
}

/* ---- the run ---- */

static void find_form(run *r)
{
    const hf_form_settings *form = &r->settings.form;
    hf_history *h = &r->history;
    h->capacity = form->max_iterations < HISTORY_MAX ? form->max_iterations : HISTORY_MAX;
    size_t n = (size_t)h->capacity;
    h->psi_m = bench_alloc(5 * n, sizeof(double));
    h->residual_N = h->psi_m + n;
    h->inner_tension_ratio = h->psi_m + 2 * n;
    h->boundary_tension_ratio = h->psi_m + 3 * n;
    h->length_error = h->psi_m + 4 * n;
    charge(r, HISTORY);
    need(r, hf_workspace_create(&r->model, &r->workspace));
    need(r, hf_evaluate_form(&r->model, form, &r->workspace, h, &r->summary.form));
    charge(r, FORM);
}

static void stages(run *r, const char *path, const char *const *overrides, int n_override, const char *output)
{
    r->since_s = bench_clock_s();
    r->before_bytes = heap_bytes();
    need(r, hf_config_load(path, overrides, n_override, &r->settings, &r->messages));
    charge(r, READ);
    need(r, hf_config_scene(&r->settings, &r->scene, &r->messages));
    charge(r, SCENE);
    need(r, hf_model_build(&r->scene, &r->settings.form, &r->model, &r->messages));
    if (r->settings.has_optimize)
        need(r,
             hf_symmetry_apply(&r->scene, r->settings.optimize.symmetry, &r->model, &r->summary.planes, &r->messages));
    charge(r, MODEL);
    need(r, hf_store_create(output, 1, &r->settings, &r->scene, 0, NULL, &r->store, &r->messages));
    charge(r, STORE);
    find_form(r);
    need(r, hf_store_form(r->store, &r->model, &r->workspace, &r->history, &r->messages));
    charge(r, STORE);
    if (r->settings.has_optimize) {
        set_up(r);
        evolve(r);
        polish(r);
    }
    r->summary.has_optimize = r->settings.has_optimize;
    need(r, hf_store_finish(r->store, &r->summary, &r->messages));
    charge(r, STORE);
}

static void release(run *r)
{
    hf_ga_free(&r->ga);
    hf_batch_free(&r->batch);
    free(r->start_q_N_per_m);
    free(r->base_N);
    free(r->history.psi_m);
    hf_workspace_free(&r->workspace);
    hf_model_free(&r->model);
    hf_scene_free(&r->scene);
    hf_case_free(&r->settings);
    hf_messages_free(&r->messages);
}

void bench_stages(const char *name, const char *folder, const char *path, const char *const *overrides, int n_override)
{
    static run r;
    char output[HF_PATH_SIZE];
    double total_s = 0;
    hf_store_quiet();
    snprintf(output, sizeof output, "%s/stages.h5", folder);
    stages(&r, path, overrides, n_override, output);
    for (int i = 0; i < N_STAGE; i++)
        total_s += r.time_s[i];
    for (int i = 0; i < N_STAGE; i++) {
        if (!r.ran[i]) continue;
        bench_emit("stages", name, stage_word[i], i, "time_s", r.time_s[i]);
        bench_emit("stages", name, stage_word[i], i, "share", r.time_s[i] / total_s);
        bench_emit("stages", name, stage_word[i], i, "kept_bytes", r.kept_bytes[i]);
    }
    release(&r);
}
