/* batch - designs -> results with all cores busy: the only user of OpenMP. */
#ifndef HIFDM_BATCH_H
#define HIFDM_BATCH_H

#include <hifdm/evaluate.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    const hf_evaluator *evaluator; /* borrowed */
    int n_thread;
    hf_workspace *workspace; /* [n_thread], all allocated before the first evaluation */
    double cpu_s;            /* processor time spent inside evaluations so far, over all threads */
} hf_batch;

/* n_thread 0: hf_batch_default_threads(). HF_OK or HF_NO_MEMORY. Free in any case. */
hf_status hf_batch_create(const hf_evaluator *evaluator, int n_thread, hf_batch *batch);

/* Evaluate the designs with pending[i] != 0 (all when pending is NULL). design_N: [n][n_gene]; result: [n].
 * Each design is one whole form-finding in one thread; the results do not depend on the number of threads. */
void hf_batch_run(hf_batch *batch, int n, const double *design_N, const unsigned char *pending, hf_form_result *result);

int hf_batch_default_threads(void); /* available cores */

void hf_batch_free(hf_batch *batch);

#ifdef __cplusplus
}
#endif
#endif
