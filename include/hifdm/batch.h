/* batch - evaluates many designs on all cores.
 * Stability: stable.
 *
 * Pipeline:
 *
 *   hf_batch_create   allocates a workspace for each thread
 *   hf_batch_share    selects the solver and prepares the data that the threads share
 *   hf_batch_run      designs [n][n_variable] -> results [n], as often as needed
 *   hf_batch_free     frees the memory of the batch
 *
 * hf_batch_next does the work of hf_batch_run for the generations of an optimiser. The program tools/own_optimiser.c
 * calls the functions of this header from its own optimiser. The command `hifdm evaluate` calls the functions of this
 * header for designs in a CSV file. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/evaluate.h>
#include <hifdm/optimiser.h>
#include <stdbool.h>

HF_API_BEGIN

/* A batch contains the memory that its threads need to evaluate designs. Only one thread at a time may use a batch. */
typedef struct {
    const hf_evaluator *evaluator; /* evaluates one design; borrowed */
    int n_thread;                  /* number of threads */
    /* [n_thread] workspaces; hf_parallel_for creates all but the first when they are first used */
    hf_workspace *workspace;
    hf_objectives_point *point;     /* [n_thread] memory of each thread for the objectives */
    struct hf_batch_engine *engine; /* solver data that hf_batch_share created; NULL: there are none */
    bool lacks_memory;              /* true: memory did not suffice for the shared solver data */
    /* processor time that proposals (hf_batch_next) and evaluations took so far, summed over the threads, s */
    double cpu_s;
} hf_batch;

/* Creates a batch of n_thread threads. If n_thread is 0, the batch has one thread for each available core. The batch
 * borrows the evaluator until hf_batch_free is called. Returns HF_OK or HF_NO_MEMORY. Call hf_batch_free even if
 * hf_batch_create fails. */
hf_status hf_batch_create(const hf_evaluator *evaluator, int n_thread, hf_batch *batch);

/* Evaluates each of the n designs whose entry in pending [n] is not 0. If `pending` is NULL, the function evaluates all
 * n designs. The array design [n][n_variable] contains the values of the design variables. Boundary pretensions are in
 * N. Design variables of cables must have values above 0. The array result [n] receives the results of the evaluated
 * designs.
 *
 * One thread computes the complete form-finding of a design. The result of a design depends neither on the number of
 * threads nor on the other designs of the call. If a design has no shape or violates a constraint, its result contains
 * the reason as a status and NaN as psi_m. If a design has no shape, its tension ratios are NaN. */
void hf_batch_run(hf_batch *batch, int n, const double *design, const unsigned char *pending, hf_form_result *result);

/* Proposes the next generation of the optimiser and evaluates its pending designs. All threads share both tasks. The
 * results are the same as after a call of hf_optimiser_next and a call of hf_batch_run. The calling thread first calls
 * beside(context) once, unless `beside` is NULL. The other threads start their work while `beside` runs. The callback
 * `beside` must not read the population of the optimiser. The callback `beside` may read a copy of the population
 * struct that the caller makes before it calls hf_batch_next. Returns false if no generation is left. If no generation
 * is left, the function only calls `beside`. */
bool hf_batch_next(hf_batch *batch, hf_optimiser *optimiser, void (*beside)(void *context), void *context);

/* Selects the solver for all later evaluations and creates the data that its threads share. The function factors the
 * shared Newton matrix at the design initial [n_variable]. The values of `initial` that belong to cables must be above
 * 0. If the solver is the paper's iteration in vector lanes, the threads share the plan of the iteration instead of a
 * matrix. If hf_evaluate solves each design separately, the threads share no data.
 *
 * Returns the solver that later evaluations use. If the matrix cannot be factored at the design `initial`, or if memory
 * runs out, the threads share no data. If the threads share no data, the function may return another solver. Results of
 * different solvers differ in the last bits. If memory runs out, the function sets batch->lacks_memory to true. */
hf_solver hf_batch_share(hf_batch *batch, const double *initial);

/* Returns the solver that hf_batch_share selects if the matrix can be factored and memory suffices. Sets *has_lanes to
 * true if the selected solver computes eight designs at once in the lanes of vector registers. */
hf_solver hf_batch_solver(const hf_evaluator *evaluator, bool *has_lanes);

/* Returns the number of cores that are available to this process. */
int hf_batch_default_threads(void);

/* Makes threads sleep after they have waited a few microseconds for other threads. Call hf_batch_wait_quietly at the
 * beginning of main with the argument argv of main. The function sets GOMP_SPINCOUNT=2000 and OMP_WAIT_POLICY=passive
 * in the environment and restarts the program. The restart is necessary because OpenMP reads its environment variables
 * only once, before main begins. OpenMP has no function that changes the waiting policy at run time. If GOMP_SPINCOUNT
 * or OMP_WAIT_POLICY is already set, as in the restarted program, the function does nothing. If the path of the program
 * cannot be read, or if the dynamic linker was called to run the program, the function does nothing.
 *
 * By default, a waiting OpenMP thread spins for about as long as a generation takes, which is less than a millisecond.
 * The default waiting policy therefore triples the processor time of small batches. In a measurement on two cores that
 * other programs kept busy, the default waiting policy made runs 30 times slower. If waiting threads slept immediately,
 * a run on an idle machine would take 10 to 20 % longer. Interpreters and other programs that load the library at run
 * time must set GOMP_SPINCOUNT and OMP_WAIT_POLICY beforehand. */
void hf_batch_wait_quietly(char *const *argv);

/* Evaluates one design, the array design [n_variable], in the calling thread. The result is bit-for-bit identical to
 * the result of hf_batch_run. Returns the workspace that contains the shape of the design. The shape is valid until the
 * next call with this batch. The batch owns the returned workspace. */
hf_workspace *hf_batch_run_one(hf_batch *batch, const double *design, hf_form_result *result);

/* Frees the workspaces and the shared solver data. This function does not free the evaluator. */
void hf_batch_free(hf_batch *batch);

HF_API_END
