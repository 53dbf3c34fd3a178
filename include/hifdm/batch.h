/* batch - evaluates many designs on all cores.
 * Stability: stable.
 *
 * Pipeline:
 *
 *   hf_batch_create   allocates a workspace for each thread
 *   hf_batch_share    selects the solver and prepares what the threads share
 *   hf_batch_run      designs [n][n_variable] -> results [n], as often as needed
 *   hf_batch_free     frees all of it
 *
 * hf_batch_next does the work of hf_batch_run for the generations of an optimiser. tools/own_optimiser.c is a program
 * with its own optimiser that calls these functions. `hifdm evaluate` does the same with designs in a CSV file. */
#ifndef HIFDM_BATCH_H
#define HIFDM_BATCH_H

#include <hifdm/api.h>
#include <hifdm/evaluate.h>
#include <hifdm/optimiser.h>
#include <stdbool.h>

HF_API_BEGIN

/* The memory with which n_thread threads evaluate designs. A batch belongs to one thread at a time. */
typedef struct {
    const hf_evaluator *evaluator;  /* evaluates one design; borrowed */
    int n_thread;                   /* number of threads */
    hf_workspace *workspace;        /* [n_thread]; inside hf_parallel_for all but the first are created on first use */
    struct hf_batch_engine *engine; /* solver data that hf_batch_share created; NULL: there are none */
    bool lacks_memory;              /* memory was too small for what hf_batch_share would create */
    /* processor time of all proposals (hf_batch_next) and evaluations so far, summed over the threads, s */
    double cpu_s;
} hf_batch;

/* Creates a batch of n_thread threads; 0 stands for hf_batch_default_threads(). The evaluator is borrowed until
 * hf_batch_free. Returns HF_OK or HF_NO_MEMORY. Call hf_batch_free in either case. */
hf_status hf_batch_create(const hf_evaluator *evaluator, int n_thread, hf_batch *batch);

/* Evaluates the designs i = 0 ... n-1 with pending[i] != 0, or all of them if pending is NULL. `design` has the shape
 * [n][n_variable] and holds the values of the design variables, in N for boundary pretensions. The values of cables are
 * above 0. result [n] receives the results of the evaluated designs.
 *
 * Each design is one whole form-finding in one thread. A result depends neither on the number of threads nor on the
 * other designs of the call. If a design has no shape or breaks a constraint, its result contains the status, and psi_m
 * is NaN. Without a shape the tension ratios are NaN, too. */
void hf_batch_run(hf_batch *batch, int n, const double *design, const unsigned char *pending, hf_form_result *result);

/* Proposes the next generation of the optimiser and evaluates its pending designs, both with all threads. The result is
 * the same as that of hf_optimiser_next and hf_batch_run. The calling thread first calls beside(context) once, unless
 * `beside` is NULL; the other threads begin at the same time. `beside` must not read the population itself, only a copy
 * of the struct that was made before the call. Returns false if no generation is left; then only `beside` was
 * called. */
bool hf_batch_next(hf_batch *batch, hf_optimiser *optimiser, void (*beside)(void *context), void *context);

/* Selects the solver of all later evaluations and creates the data that its threads share. `initial` [n_variable] is
 * the design at which the shared Newton matrix is factored; the values of cables are above 0. If the solver is the
 * paper's iteration in vector lanes, the shared data are its plan. If each design is solved alone by hf_evaluate,
 * nothing is shared.
 *
 * Returns the solver that will be used. If no matrix can be factored at `initial` or memory runs out, nothing is
 * shared, and another solver may be returned. Its results differ in the last bits, so batch->lacks_memory is true after
 * a lack of memory. */
hf_solver hf_batch_share(hf_batch *batch, const double *initial);

/* Returns the solver that hf_batch_share selects if `initial` is suitable and memory suffices. Sets *has_lanes to true
 * if this solver works on eight designs at once, one in each lane of the vector registers. @52- */
hf_solver hf_batch_solver(const hf_evaluator *evaluator, bool *has_lanes);

/* Returns the number of cores that are available to this process. */
int hf_batch_default_threads(void); /* available cores */

/* Makes threads that wait for others sleep after some microseconds. Call it first in main, with main's argument argv.
 * It sets GOMP_SPINCOUNT=2000 and OMP_WAIT_POLICY=passive in the environment and starts the program again. OpenMP reads
 * these variables when it is loaded, which is before main begins, and has no call to change them. The function returns
 * without effect if one of the two variables is set, as it is in the restarted program. It also returns if the path of
 * the program cannot be read, or if the dynamic linker was called to run the program.
 *
 * Reason: a generation takes less than a millisecond, and by default waiting threads spin for about as long. Small
 * batches then take three times the processor time. Where other programs kept the cores busy, runs were 30 times slower
 * on two cores. Threads that sleep at once would lose 10 to 20 % of a run on an idle machine. A program that loads the
 * library at run time, such as an interpreter, sets the two variables before it loads the library. */
void hf_batch_wait_quietly(char *const *argv);

/* Evaluates the design [n_variable] in the calling thread; the result has the same bits as that of hf_batch_run.
 * Returns the workspace that holds the shape of the design until the next call with this batch. The batch owns the
 * workspace. */
hf_workspace *hf_batch_run_one(hf_batch *batch, const double *design, hf_form_result *result);

/* Frees the workspaces and the shared data of the solver, but not the evaluator. */
void hf_batch_free(hf_batch *batch);

HF_API_END
#endif
