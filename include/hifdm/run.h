/* run - one whole run as `hifdm run` does it: case -> scene -> model -> form-finding -> (ask -> batch -> tell ->
 * store)* -> file.
 * Stability: stable.
 *
 * A run prints nothing and keeps no state outside its arguments: any number of runs may go on in one process, one after
 * the other or in threads of their own. */
#ifndef HIFDM_RUN_H
#define HIFDM_RUN_H

#include <hifdm/store.h>
#include <hifdm/summary.h>
#include <signal.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HF_OUTPUT_SIZE 4096

typedef enum { HF_RUN_FORM, HF_RUN_EVOLVE, HF_RUN_POLISH } hf_run_phase;

/* How far a run is. Members after phase: of the genetic algorithm, 0 before it. */
typedef struct {
    hf_run_phase phase;
    int generation, generations; /* finished, and at most */
    int first_generation;        /* that this process evaluates */
    bool is_last;                /* no generation will follow */
    long evaluations;            /* of this process */
    double best_psi_m;           /* NaN while nothing is feasible */
    double elapsed_s;            /* in this phase and process */
} hf_run_progress;

/* Called as each phase begins and after each generation, once that is stored: by one thread at a time, but not always
 * the same. */
typedef void hf_run_observer(void *context, const hf_run_progress *progress);

/* All borrowed until hf_run_case returns. Zero is a usable value of everything but case_path. */
typedef struct {
    const char *case_path;
    const char *const *set; /* [n_set] overrides "key=value" */
    int n_set;
    const char *output; /* NULL: the name of the case with .h5, in the current folder */
    bool no_file;       /* only the summary counts */
    bool of_sweep;      /* one point of the case's sweep section, which is refused otherwise */
    bool restart;       /* begin anew whatever is there; else an unfinished result of this case is gone on with */
    int threads;        /* 0: all cores */
    bool has_seed;      /* `seed` instead of optimize.seed */
    uint64_t seed;
    int argc; /* for the provenance */
    char *const *argv;
    const volatile sig_atomic_t *stop_requested; /* polled between generations; NULL: never */
    /* NULL: the result gets its name before the run comes back. Else *unsettled is its store when hf_store_settle is
     * still to be called (NULL: not), and the caller does so in any thread. */
    hf_store **unsettled;
    hf_run_observer *observer; /* NULL: none */
    void *observer_context;
} hf_run_request;

/* Run the case and store it. `output` is the path of the result file, "" when none was written. HF_OK, or the status of
 * what went wrong with messages: HF_NOT_CONVERGED and HF_NO_FEASIBLE still write the file; HF_INTERRUPTED when
 * *stop_requested was seen: the same request goes on. A finished result of this case is not computed again:
 * its status. */
hf_status hf_run_case(const hf_run_request *request, hf_summary *summary, char output[HF_OUTPUT_SIZE],
                      hf_messages *messages);

#ifdef __cplusplus
}
#endif
#endif
