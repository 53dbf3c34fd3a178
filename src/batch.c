#include <hifdm/batch.h>

#include "band.h"

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

void hf_batch_run(hf_batch *batch, int n, const double *design_N, const unsigned char *pending, hf_form_result *result)
{
    size_t n_gene = (size_t)batch->evaluator->model->n_gene;
    double cpu_s = 0;
#pragma omp parallel num_threads(batch->n_thread) reduction(+ : cpu_s)
    {
        hf_workspace *workspace = &batch->workspace[omp_get_thread_num()];
        double start_s = thread_cpu_s();
        /* evaluations differ in length; without a wait at the end the clock stops when a thread runs out of work */
#pragma omp for schedule(dynamic, 1) nowait
        for (int i = 0; i < n; i++)
            if (!pending || pending[i])
                hf_evaluate(batch->evaluator, design_N + (size_t)i * n_gene, workspace, &result[i]);
        cpu_s += thread_cpu_s() - start_s;
    }
    batch->cpu_s += cpu_s;
}

void hf_batch_free(hf_batch *batch)
{
    for (int i = 0; i < batch->n_thread; i++)
        hf_workspace_free(&batch->workspace[i]);
    free(batch->workspace);
    *batch = (hf_batch){0};
}
