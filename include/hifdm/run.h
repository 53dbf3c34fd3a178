/* run - one whole run, as `hifdm run` does it.
 * Stability: stable.
 *
 * Pipeline:
 *
 *   case -> scene -> model -> form-finding -> search: (generation -> batch -> ranking -> store)* -> refinement
 *        -> load cases -> samples with errors -> result file
 *
 * A run prints nothing and keeps no state outside its arguments. Any number of runs may be active in one process, one
 * after the other or in threads of their own. */
#ifndef HIFDM_RUN_H
#define HIFDM_RUN_H

#include <hifdm/api.h>
#include <hifdm/problem.h>
#include <hifdm/store.h>
#include <hifdm/summary.h>
#include <signal.h>
#include <stdbool.h>

HF_API_BEGIN

#define HF_OUTPUT_SIZE 4096 /* bytes of the path of a result file */

/* The phases of a run: form-finding, genetic algorithm, Levenberg-Marquardt, samples of as-built nets. */
typedef enum { HF_RUN_FORM, HF_RUN_SEARCH, HF_RUN_REFINE, HF_RUN_TOLERANCE } hf_run_phase;
extern const char *const hf_run_phase_word[4]; /* "form", "optimize", "polish", "tolerance" */

/* The progress of a run. Members that do not belong to the phase are 0; best_psi_m and merit are NaN then. */
typedef struct {
    hf_run_phase phase;          /* phase of the run */
    int generation, generations; /* search: number of finished generations, and maximum */
    int first_generation;        /* search: first generation that this process evaluates */
    bool is_last;                /* no generation, step or sample will follow */
    long evaluations;            /* evaluations of designs or samples in this phase and process */
    double best_psi_m;           /* psi of the best design; NaN: no feasible one is known */
    double elapsed_s;            /* time in this phase and process */
    long samples, samples_all;   /* tolerance: numbers of finished samples, and of all */
    double sigma_scale; /* tolerance, after all samples: factor of the errors whose yield is determined; else 0 */
    /* Refinement: number of steps done, and maximum; first step of this process; merit of the best design, NaN if the
     * merit is psi. best_psi_m is that of the same design. */
    int step, max_steps, first_step;
    double merit;
    /* Refinement of a front, else 0: numbers of its points that are done, and of all; steps of the searches for
     * them. */
    int points, points_all;
    long steps;
} hf_run_progress;

/* Receives the progress of a run. It is called at the start of the form-finding, of the refinement and of the samples.
 * It is also called after each generation once it is stored, each step of Levenberg-Marquardt, and each block of
 * samples. Only one thread at a time calls it, but not always the same one. */
typedef void hf_run_observer(void *context, const hf_run_progress *progress);

/* What a run shall do. All members are borrowed until hf_run_case returns. Every member except case_path may be
 * zero. */
typedef struct {
    const char *case_path;           /* path of the case file; with `source`: a name for messages */
    const hf_problem_source *source; /* case and net in memory; NULL: they are read from files */
    const char *const *set;          /* [n_set] overrides "key=value" */
    int n_set;                       /* number of overrides */
    const char *output; /* path of the result file; NULL: name of the case with .h5, in the current folder */
    const char *point;  /* "FILE:N": point N of the front in this result is the design, without a search; NULL: none */
    bool no_file;       /* write no file; only the summary is needed */
    bool of_sweep;      /* run one point of the sweep of the case; false: a case with a section sweep is refused */
    bool of_tolerance;  /* refuse a case without a section tolerance */
    /* tasks > 0: compute only the samples of this task, 0 to tasks - 1, without a result file; task -1: combine the
     * samples of all tasks */
    int task, tasks;
    bool restart;      /* start anew, even if the file exists; false: resume an unfinished result of this case */
    int threads;       /* number of threads; 0: all cores */
    bool has_seed;     /* use `seed` instead of optimize.seed */
    uint64_t seed;     /* seed of the genetic algorithm */
    int argc;          /* number of arguments of the command line, for the provenance */
    char *const *argv; /* [argc] arguments of the command line */
    const volatile sig_atomic_t *stop_requested; /* a flag: *stop_requested != 0 interrupts the run; NULL: never */
    /* NULL: the result file gets its name before hf_run_case returns. Otherwise *unsettled is set to the store for
     * which the caller must still call hf_store_settle, in any thread, or to NULL if there is none. */
    hf_store **unsettled;
    hf_run_observer *observer; /* receives the progress; NULL: none */
    void *observer_context;    /* first argument of the observer */
} hf_run_request;

/* Runs a case and stores its result. `output` receives the path of the result file, "" if none was written. *summary
 * receives the figures.
 *
 * Returns HF_OK, or the status of a failure with messages. Under HF_NOT_CONVERGED and HF_NO_FEASIBLE the file is still
 * written. Under HF_INTERRUPTED (*stop_requested was set) the same request resumes the run. A finished result of this
 * case is not computed again; its status is returned. */
hf_status hf_run_case(const hf_run_request *request, hf_summary *summary, char output[HF_OUTPUT_SIZE],
                      hf_messages *messages);

HF_API_END
#endif
