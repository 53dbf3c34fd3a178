/* run - executes one complete run, in the same way as `hifdm run`.
 * Stability: stable.
 *
 * Pipeline:
 *
 *   case -> scene -> model -> form-finding -> search: (generation -> batch -> ranking -> store)* -> refinement
 *        -> load cases -> samples with errors -> result file
 *
 * A run prints nothing and keeps no state outside its arguments. One process may execute any number of runs, one after
 * another or at the same time in different threads. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/problem.h>
#include <hifdm/store.h>
#include <hifdm/summary.h>
#include <signal.h>
#include <stdbool.h>

HF_API_BEGIN

#define HF_OUTPUT_SIZE 4096 /* size in bytes of the path of a result file */

/* A run has the phases form-finding, genetic algorithm, Levenberg-Marquardt and samples of as-built nets. */
typedef enum { HF_RUN_FORM, HF_RUN_SEARCH, HF_RUN_REFINE, HF_RUN_TOLERANCE } hf_run_phase;
extern const char *const hf_run_phase_word[4]; /* "form", "search", "refine", "tolerance" */

/* The progress of a run. If the members best_psi_m and merit do not belong to the phase, they are NaN. All other
 * members that do not belong to the phase are 0. */
typedef struct {
    hf_run_phase phase;          /* phase of the run */
    int generation, generations; /* search: number of finished generations, and maximum number of generations */
    int first_generation;        /* search: first generation that this process evaluates */
    bool is_last;                /* no generation, step or sample will follow */
    long evaluations;            /* evaluations of designs or samples in this phase and process */
    double best_psi_m;           /* psi of the best design; NaN: no feasible design is known, or there is a front */
    double elapsed_s;            /* time in this phase and process */
    long samples, samples_all;   /* tolerance: number of finished samples, and number of all samples */
    /* tolerance, after all samples: scale factor of the errors whose yield is being determined; otherwise 0 */
    double sigma_scale;
    /* During the refinement, step and max_steps are the number of finished steps and the maximum number of steps. The
     * member first_step is the first step of this process. The member `merit` is the merit of the best design. If psi
     * is the merit, the member `merit` is NaN. The member best_psi_m also belongs to the best design. */
    int step, max_steps, first_step;
    double merit;
    /* During the refinement, while no design within the limits and requirements is known: how far the nearest design is
     * outside, as a sum of distances relative to the bounds. Otherwise 0. */
    double violation;
    /* During the refinement of a Pareto front, points and points_all are the numbers of finished points and of all
     * points. The member `steps` is the number of steps of the searches for all points. In all other phases, points,
     * points_all and steps are 0. */
    int points, points_all;
    long steps;
} hf_run_progress;

/* Receives the progress of a run. The run calls the callback at the start of the form-finding, of the refinement and of
 * the samples. The run also calls the callback after each stored generation, after each step of Levenberg-Marquardt,
 * and after each block of samples. Only one thread at a time calls the callback. Different calls may come from
 * different threads. */
typedef void hf_run_observer(void *context, const hf_run_progress *progress);

/* The input of a run. Every member except case_path may be zero. */
typedef struct {
    const char *case_path;           /* path of the case file; with `source`, a name for messages */
    const hf_problem_source *source; /* case and net in memory; NULL: the run reads them from files */
    const char *const *set;          /* [n_set] overrides of the form "key=value" */
    int n_set;                       /* number of overrides */
    const uint64_t *seed;            /* seed of the genetic algorithm; NULL: optimize.seed */
    /* "FILE:N": point N of the Pareto front in this result file is the design, without a search; NULL: none */
    const char *point;
} hf_run_input;

/* Describes the result file of a run. */
typedef struct {
    const char *path;  /* path of the result file; NULL: the name of the case with .h5 in the current folder */
    bool no_file;      /* write no file, because only the summary is needed */
    bool restart;      /* start again even if the file exists; false: resume an unfinished result of this case */
    int argc;          /* number of command line arguments, for the provenance */
    char *const *argv; /* [argc] command line arguments */
    /* If this member is NULL, the result file gets its final name before hf_run_case returns. If the member `unsettled`
     * is not NULL, the function sets *unsettled to a store. The caller must call hf_store_settle for the store
     * *unsettled, in any thread. If no store must be settled, the function sets *unsettled to NULL. */
    hf_store **unsettled;
} hf_run_output;

/* Contains the threads, the stop flag and the observer of a run. */
typedef struct {
    int threads;                                 /* number of threads; 0: all cores */
    const volatile sig_atomic_t *stop_requested; /* flag; *stop_requested != 0 interrupts the run; NULL: none */
    hf_run_observer *observer;                   /* callback that receives the progress; NULL: none */
    void *observer_context;                      /* first argument of the observer */
} hf_run_control;

/* Selects the part of a study or of a set of samples that a run computes. */
typedef struct {
    bool of_sweep;     /* run one point of the sweep of the case; false: reject a case with a section sweep */
    bool of_tolerance; /* reject a case without a section tolerance */
    bool is_strict;    /* reject a case without requirements */
    /* If tasks > 0, the run computes only the samples of this task, 0 to tasks - 1, without a result file. If task is
     * -1, the run combines the samples of all tasks. */
    int task, tasks;
    /* If more_steps > 0, the run continues the refinement of the finished result by this number of steps. It then
     * computes the later stages again. The finished result stays unchanged until it is replaced. */
    int more_steps;
} hf_run_part;

/* Describes a run for the function hf_run_case. All pointers are borrowed until hf_run_case returns. */
typedef struct {
    hf_run_input input;     /* case, overrides, seed */
    hf_run_output output;   /* result file */
    hf_run_control control; /* threads, stop flag, observer */
    hf_run_part part;       /* point of a sweep, task; all zero: the whole case */
} hf_run_request;

/* Runs a case and stores its result. The buffer `output` receives the path of the result file. If the function wrote no
 * file, the buffer receives an empty string. The struct *summary receives the results of the run.
 *
 * Returns HF_OK on success. If the function fails, it returns another status and adds messages. If the status is
 * HF_NOT_CONVERGED or HF_NO_FEASIBLE, the function still writes the file. If the status is HF_INTERRUPTED because
 * *stop_requested was set, the same request resumes the run. If a finished result of this case exists, the function
 * returns the status of this result without a new computation. */
hf_status hf_run_case(const hf_run_request *request, hf_summary *summary, char output[HF_OUTPUT_SIZE],
                      hf_messages *messages);

HF_API_END
