/* run - one whole run as `hifdm run` does it: case -> scene -> model -> form-finding -> (ask -> batch -> tell ->
 * store)* -> file.
 * Stability: stable.
 *
 * A run prints nothing and keeps no state outside its arguments: any number of runs may go on in one process, one after
 * the other or in threads of their own. */
#ifndef HIFDM_RUN_H
#define HIFDM_RUN_H

#include <hifdm/api.h>
#include <hifdm/problem.h>
#include <hifdm/store.h>
#include <hifdm/summary.h>
#include <signal.h>
#include <stdbool.h>

HF_API_BEGIN

#define HF_OUTPUT_SIZE 4096

typedef enum { HF_RUN_FORM, HF_RUN_EVOLVE, HF_RUN_POLISH, HF_RUN_TOLERANCE } hf_run_phase;
extern const char *const hf_run_phase_word[4]; /* "form", "optimize", "polish", "tolerance" */

/* How far a run is. The members after phase describe the genetic algorithm; they are 0 before it. */
typedef struct {
    hf_run_phase phase;
    int generation, generations; /* finished, and at most */
    int first_generation;        /* the first generation that this process evaluates */
    bool is_last;                /* no generation will follow */
    long evaluations;            /* of this process */
    double best_psi_m;           /* NaN while nothing is feasible */
    double elapsed_s;            /* in this phase and process */
    long samples, samples_all;   /* of tolerance: finished, of all; evaluations are those of this process */
    double sigma_scale; /* of tolerance, after all samples: the factor of errors whose yield is found; else 0 */
    /* Of polish: steps done, and at most; the merit of the best design, NaN where psi is all that is wanted. best_psi_m
     * is of that design. */
    int iteration, iterations, first_iteration;
    double merit;
    /* Of polish, of a front (else 0): its points that are done, and are asked for; steps of the searches for them. */
    int points, points_all;
    long steps;
} hf_run_progress;

/* Called at the start of each phase, after each generation when it has been stored, and after each step of
 * Levenberg-Marquardt. Only one thread at a time calls
 * it, but not always the same one. */
typedef void hf_run_observer(void *context, const hf_run_progress *progress);

/* All members are borrowed until hf_run_case returns. Every member but case_path may be zero. */
typedef struct {
    const char *case_path;
    const hf_problem_source *source; /* NULL: the case and its net are read from files; else case_path is a name */
    const char *const *set;          /* [n_set] overrides "key=value" */
    int n_set;
    const char *output; /* NULL: the name of the case with .h5, in the current folder */
    const char *point;  /* "FILE:N": point N of the front in this result is the design, without a search; NULL: none */
    bool no_file;       /* write no file: only the summary is wanted */
    bool of_sweep;      /* true: run one point of the case's sweep; false: refuse a case with a sweep section */
    bool of_tolerance;  /* refuse a case without a section tolerance */
    int task, tasks; /* tasks > 0: only samples of this task, 0 to tasks - 1, and no result file; with task -1 samples
                           of all tasks are put together */
    bool restart;    /* true: begin anew, whatever file exists; false: continue an unfinished result of this case */
    int threads;     /* 0: all cores */
    bool has_seed;   /* `seed` instead of optimize.seed */
    uint64_t seed;
    int argc; /* for the provenance */
    char *const *argv;
    const volatile sig_atomic_t *stop_requested; /* polled between generations; NULL: never */
    /* NULL: the result file gets its name before hf_run_case returns. Otherwise *unsettled is set to the store for
     * which the caller must still call hf_store_settle, in any thread, or to NULL when there is none. */
    hf_store **unsettled;
    hf_run_observer *observer; /* NULL: none */
    void *observer_context;
} hf_run_request;

/* Run the case and store it. `output` receives the path of the result file, "" when none was written. Returns HF_OK, or
 * the status of the failure, with messages. Under HF_NOT_CONVERGED and HF_NO_FEASIBLE the file is still written. Under
 * HF_INTERRUPTED (*stop_requested was set) the same request continues the run. A finished result of this case is not
 * computed again; its status is returned. */
hf_status hf_run_case(const hf_run_request *request, hf_summary *summary, char output[HF_OUTPUT_SIZE],
                      hf_messages *messages);

HF_API_END
#endif
