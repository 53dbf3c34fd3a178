/* batch - evaluate many designs on all cores.
 * Stability: stable.
 *
 * A program with its own optimiser creates a batch, shares the base design, runs the batch for each set of designs, and
 * frees it; tools/own_optimiser.c is such a program. `hifdm evaluate` does the same with tables in CSV files. */
#ifndef HIFDM_BATCH_H
#define HIFDM_BATCH_H

#include <hifdm/api.h>
#include <hifdm/evaluate.h>
#include <hifdm/optimiser.h>
#include <stdbool.h>

HF_API_BEGIN

typedef struct {
    const hf_evaluator *evaluator; /* borrowed */
    int n_thread;
    hf_workspace *workspace;        /* [n_thread]; inside hf_parallel_for all but the first are created when needed */
    struct hf_batch_engine *engine; /* what hf_batch_share made, or NULL */
    bool lacks_memory;              /* hf_batch_share had too little for what it would share */
    double cpu_s; /* processor time spent in proposals (by hf_batch_next) and evaluations so far, over all threads */
} hf_batch;

/* n_thread 0 means hf_batch_default_threads(). The evaluator is borrowed until hf_batch_free. Returns HF_OK or
 * HF_NO_MEMORY; call hf_batch_free in either case. */
hf_status hf_batch_create(const hf_evaluator *evaluator, int n_thread, hf_batch *batch);

/* Evaluate the designs with pending[i] != 0 (all when pending is NULL). design_N: [n][n_gene] boundary pretensions > 0;
 * result: [n].
 * Each design is one whole form-finding in one thread; the results do not depend on the number of threads, nor on which
 * other designs are evaluated beside it. A design that has no shape, or breaks a cap, has its status in its result and
 * NaN for psi, and without a shape for the ratios. */
void hf_batch_run(hf_batch *batch, int n, const double *design_N, const unsigned char *pending, hf_form_result *result);

/* Propose the next generation and evaluate what is pending in it: hf_optimiser_next and hf_batch_run in one, by all
 * threads. First the calling thread runs beside(context) once (NULL: nothing), while the others, if there are any,
 * begin. `beside` may read the population only from a copy of the struct that was made before the call. Returns false
 * when no generation is left; then only `beside` has run. */
bool hf_batch_next(hf_batch *batch, hf_optimiser *optimiser, void (*beside)(void *context), void *context);

/* Choose the solver of all designs from now on, and prepare what the threads share: one Newton matrix, factored at the
 * base design base_N [n_gene] > 0; or lanes of the paper's iteration; or nothing, when hf_evaluate solves each design
 * by itself. Returns the hf_solver that will be used. When the base is unsuitable or memory runs out, nothing is
 * shared. Another solver ends at other bits: batch->lacks_memory says that memory ran out. */
hf_solver hf_batch_share(hf_batch *batch, const double *base_N);

/* The solver that hf_batch_share returns unless the base is unsuitable or memory runs out. *has_lanes is set to true
 * when this solver works on eight designs at once, in the lanes of vector registers. */
hf_solver hf_batch_solver(const hf_evaluator *evaluator, bool *has_lanes);

int hf_batch_default_threads(void); /* available cores */

/* Makes threads that wait for others sleep after some microseconds. Call it first in main, with the arguments of main:
 * OpenMP reads how its threads wait when it is loaded, which is before main begins, and has no call to change it. So
 * this sets GOMP_SPINCOUNT=2000 and OMP_WAIT_POLICY=passive and starts the program again. It returns, and has done
 * nothing, where one of the two is set already, as it is in the program that was started again.
 *
 * A generation takes less than a millisecond, and by default waiting threads spin for about as long: small batches take
 * three times the processor time, and where other programs keep the cores busy, runs were 30 times slower on two cores.
 * Threads that sleep at once lose 10 to 20 % of a run on an idle machine. A program that loads the library itself, as
 * an interpreter does, sets the two variables before it loads it. */
void hf_batch_wait_quietly(char *const *argv);

/* Evaluate one design in the calling thread, with the same bits as hf_batch_run. Returns the workspace that holds its
 * shape until the next call with this batch. */
hf_workspace *hf_batch_run_one(hf_batch *batch, const double *design_N, hf_form_result *result);

/* Free the workspaces and what the threads share. The evaluator is not freed. */
void hf_batch_free(hf_batch *batch);

HF_API_END
#endif
