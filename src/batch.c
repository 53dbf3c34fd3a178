#include <hifdm/batch.h>

#include "band.h"
#include "chord.h"

#include <omp.h>
#include <stdlib.h>
#include <time.h>

static double thread_cpu_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int hf_batch_default_threads(void)
{
    return omp_get_num_procs();
}

hf_status hf_batch_create(const hf_evaluator *evaluator, int n_thread, hf_batch *batch)
{
    if (n_thread <= 0) n_thread = hf_batch_default_threads();
    *batch = (hf_batch){.evaluator = evaluator};
    batch->workspace = calloc((size_t)n_thread, sizeof *batch->workspace);
    if (!batch->workspace) return HF_NO_MEMORY;
    batch->n_thread = n_thread;
    for (int i = 0; i < n_thread; i++)
        HF_TRY(hf_workspace_create(evaluator->model, &batch->workspace[i]));
    hf_band_single_threaded();
    return HF_OK;
}

/* ---- sharing one matrix ---- */

struct hf_batch_chord {
    hf_chord shared;
    hf_chord_lanes *lanes; /* [n_thread] */
};

static void free_chord(hf_batch *batch)
{
    if (!batch->chord) return;
    for (int i = 0; batch->chord->lanes && i < batch->n_thread; i++)
        hf_chord_lanes_free(&batch->chord->lanes[i]);
    free(batch->chord->lanes);
    hf_chord_free(&batch->chord->shared);
    free(batch->chord);
    batch->chord = NULL;
}

static hf_status create_chord(hf_batch *batch, const double *base_N)
{
    batch->chord = calloc(1, sizeof *batch->chord);
    if (!batch->chord) return HF_NO_MEMORY;
    HF_TRY(hf_chord_create(batch->evaluator, base_N, &batch->workspace[0], &batch->chord->shared));
    batch->chord->lanes = calloc((size_t)batch->n_thread, sizeof *batch->chord->lanes);
    if (!batch->chord->lanes) return HF_NO_MEMORY;
    for (int i = 0; i < batch->n_thread; i++)
        HF_TRY(hf_chord_lanes_create(&batch->chord->shared, &batch->chord->lanes[i]));
    return HF_OK;
}

int hf_batch_share(hf_batch *batch, const double *base_N)
{
    const hf_evaluator *v = batch->evaluator;
    int allowed = v->solver == HF_SOLVER_AUTO || v->solver == HF_SOLVER_CHORD;
    if (allowed && hf_chord_applies(v)) {
        if (create_chord(batch, base_N) == HF_OK) return HF_SOLVER_CHORD;
        free_chord(batch);
    }
    int by_newton = v->solver != HF_SOLVER_FIXED_POINT && v->rule != HF_RULE_SEEDED && v->model->has_newton;
    return by_newton ? HF_SOLVER_NEWTON : HF_SOLVER_FIXED_POINT;
}

/* ---- the parallel run ---- */

typedef struct {
    int n, done; /* designs; handed out so far */
    const unsigned char *pending;
} queue;

/* The next design that needs an evaluation, or -1; each is handed out once. */
static int take_next(void *context)
{
    queue *q = context;
    for (;;) {
        int i;
#pragma omp atomic capture
        i = q->done++;
        if (i >= q->n) return -1;
        if (!q->pending || q->pending[i]) return i;
    }
}

void hf_batch_run(hf_batch *batch, int n, const double *design_N, const unsigned char *pending, hf_form_result *result)
{
    size_t n_gene = (size_t)batch->evaluator->model->n_gene;
    queue work = {n, 0, pending};
    double cpu_s = 0;
#pragma omp parallel num_threads(batch->n_thread) reduction(+ : cpu_s)
    {
        int thread = omp_get_thread_num();
        hf_workspace *workspace = &batch->workspace[thread];
        double start_s = thread_cpu_s();
        if (batch->chord) {
            hf_chord_run(&batch->chord->shared, &batch->chord->lanes[thread], workspace, take_next, &work, design_N,
                         result);
        } else {
            for (int i = take_next(&work); i >= 0; i = take_next(&work))
                hf_evaluate(batch->evaluator, design_N + (size_t)i * n_gene, workspace, &result[i]);
        }
        cpu_s += thread_cpu_s() - start_s; /* without the wait for the other threads */
    }
    batch->cpu_s += cpu_s;
}

hf_workspace *hf_batch_run_one(hf_batch *batch, const double *design_N, hf_form_result *result)
{
    queue work = {1, 0, NULL};
    hf_workspace *workspace = &batch->workspace[0];
    if (batch->chord)
        hf_chord_run(&batch->chord->shared, &batch->chord->lanes[0], workspace, take_next, &work, design_N, result);
    else
        hf_evaluate(batch->evaluator, design_N, workspace, result);
    return workspace;
}

void hf_batch_free(hf_batch *batch)
{
    free_chord(batch);
    for (int i = 0; i < batch->n_thread; i++)
        hf_workspace_free(&batch->workspace[i]);
    free(batch->workspace);
    *batch = (hf_batch){0};
}
