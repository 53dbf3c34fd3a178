/* sweep - runs the missing points of a study on all cores. Each point is run once, whatever other processes do. It
 * prints nothing. */
#pragma once

#include "case/study.h"
#include <hifdm/status.h>
#include <signal.h>
#include <stdbool.h>

/* Numbers of points of one sweep. */
typedef struct {
    bool has_run;         /* false: it ended before the first point */
    int n_todo;           /* points of this task to run */
    int n_done, n_failed; /* of these, by this process */
    int n_elsewhere;      /* of these, run by another process */
    int n_failed_before;  /* points of this task that failed earlier and are not run */
    double wall_s;        /* since the start of the first point */
} hf_sweep_count;

/* Called after each point, by one thread at a time, but not always the same. */
typedef void hf_sweep_observer(void *context, const hf_sweep_count *count);

/* All members are borrowed until hf_sweep_run returns. */
typedef struct {
    const hf_study *study;
    const char *folder; /* of the results; created if missing */
    int task, tasks;    /* selects the points task, task + tasks, task + 2 tasks, ... */
    unsigned retry;     /* states to run, bits 1 << hf_point_state; 0: missing ones */
    int threads;        /* > 0 */
    int argc;           /* for the provenance of the results */
    char *const *argv;
    const volatile sig_atomic_t *stop_requested;
    hf_sweep_observer *observer; /* NULL: none */
    void *observer_context;
} hf_sweep_request;

/* Runs the points. Returns HF_OK; HF_POINTS_FAILED if some failed, which does not stop the others; HF_INTERRUPTED if
 * *stop_requested was set: running points end after a generation, and no further point begins. Returns HF_EXISTS if the
 * folder has points of another base case. Returns HF_IO or HF_NO_MEMORY for a fault of the machine (memory,
 * descriptors, disk): running points end normally, no further point begins, and no point counts as failed for it. */
hf_status hf_sweep_run(const hf_sweep_request *request, hf_sweep_count *count, hf_messages *messages);
