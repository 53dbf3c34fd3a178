/* front_refine - finds a Pareto front of two or three objectives by Levenberg-Marquardt (METHOD section 7). At an end
 * of the front, one objective has its minimum. At the points between the ends, one objective is minimised under limits
 * on the others, and the search begins at a neighbour. Each new limit halves one of the longest gaps, so the points are
 * about evenly spaced. */
#pragma once

#include <hifdm/evaluate.h>
#include <hifdm/front.h>
#include <signal.h>
#include <stdatomic.h>

/* Reports the progress of a search after each step of each point. One thread at a time calls `tell`, not always the
 * same one. A thread that would have to wait for another does not report. */
typedef struct {
    void (*tell)(void *context, int n_point, long n_step); /* finished points; steps of all searches */
    void *context;
    atomic_int n_point; /* counted by the search; 0 on entry, like n_step */
    atomic_long n_step;
    atomic_flag is_telling; /* ATOMIC_FLAG_INIT on entry */
} hf_front_refine_watcher;

typedef struct {
    const hf_evaluator *evaluator; /* its objectives span the front */
    const double *lower, *upper;   /* [n_variable], bounds */
    /* The number of points with the ends, from 3 (with three objectives 4) to HF_FRONT_POINTS_MAX, and the maximum
     * number of iterations for each point. */
    int n_point, max_iterations;
    int n_thread; /* 0: all cores; the front does not depend on it */
    int n_start;
    const double *start; /* [n_start][n_variable], designs to begin from */
    const volatile sig_atomic_t *stop;
    hf_front_refine_watcher *watcher; /* NULL: no watcher */
} hf_front_refine;

/* Returns true if hf_front_refine_find can find the front of these objectives: there must be two or three, and
 * hf_refine_applies must be true. */
bool hf_front_refine_applies(const hf_evaluator *evaluator);

/* Finds the front and creates *front, without `base`; free it in any case. Returns HF_OK, also if some points failed,
 * which are then marked. Otherwise returns HF_NO_MEMORY, HF_INTERRUPTED, or the status of the last attempt if no start
 * leads to a feasible design at an end. *failed_end is then the objective of that end, else -1. */
hf_status hf_front_refine_find(const hf_front_refine *task, hf_front *front, int *failed_end);
