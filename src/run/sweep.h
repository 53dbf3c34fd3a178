/* sweep - runs the points of a study that are missing, on all cores; each once, whatever other processes do. Prints
 * nothing. */
#ifndef HIFDM_SWEEP_H
#define HIFDM_SWEEP_H

#include "case/study.h"
#include <hifdm/status.h>
#include <signal.h>
#include <stdbool.h>

/* Points of one sweep. */
typedef struct {
    bool has_run;         /* false: it ended before it came to the points */
    int n_todo;           /* points of this task to run */
    int n_done, n_failed; /* of them, by this process */
    int n_elsewhere;      /* of them, run by another process */
    int n_failed_before;  /* points of this task that failed earlier and are left alone */
    double wall_s;        /* since the first point began */
} hf_sweep_count;

/* Called after each point, by one thread at a time, but not always the same. */
typedef void hf_sweep_observer(void *context, const hf_sweep_count *count);

/* All borrowed until hf_sweep_run returns. */
typedef struct {
    const hf_study *study;
    const char *folder; /* of the results; made if it is not there */
    int task, tasks;    /* the points task, task + tasks, task + 2 tasks, ... */
    unsigned retry;     /* states to run, bits 1 << hf_point_state; 0: the missing ones */
    int threads;        /* > 0 */
    int argc;           /* for the provenance of the results */
    char *const *argv;
    const volatile sig_atomic_t *stop_requested;
    hf_sweep_observer *observer; /* NULL: none */
    void *observer_context;
} hf_sweep_request;

/* HF_OK; HF_POINTS_FAILED when some failed, which stops no other; HF_INTERRUPTED when *stop_requested was seen: runs
 * end after a generation, no point begins; HF_EXISTS when points of another base case are in the way; HF_IO or
 * HF_NO_MEMORY when the machine is at fault (no memory, no descriptors, no room, a failing disk): points under way come
 * to their end, no point begins, and none counts as failed for it. */
hf_status hf_sweep_run(const hf_sweep_request *request, hf_sweep_count *count, hf_messages *messages);

#endif
