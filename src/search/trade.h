/* trade - the front of two or three objectives by Levenberg-Marquardt (METHOD section 7): the ends, where one of them
 * is least, and points between them at which one is least while the others stay below limits, each begun from a
 * neighbour. The limits are put where the front has its longest gaps, so its points are about evenly far from each
 * other. */
#ifndef HIFDM_TRADE_H
#define HIFDM_TRADE_H

#include <hifdm/evaluate.h>
#include <hifdm/front.h>
#include <signal.h>
#include <stdatomic.h>

/* Tells how far a search is: after each step of each point, by one thread at a time, not always the same one. A thread
 * that would have to wait for another tells nothing. */
typedef struct {
    void (*tell)(void *context, int n_point, long n_step); /* points that are done; steps of all searches */
    void *context;
    atomic_int n_point; /* counted here, 0 on entry, as the next two */
    atomic_long n_step;
    atomic_flag is_telling; /* ATOMIC_FLAG_INIT on entry */
} hf_trade_watcher;

typedef struct {
    const hf_evaluator *evaluator; /* its goals are the objectives */
    const double *lower, *upper;   /* [n_gene] */
    int n_point, max_iterations;   /* the ends included, 3 (of three objectives 4) to HF_FRONT_POINTS_MAX; of each */
    int n_thread;                  /* 0: all cores; the front does not depend on it */
    int n_start;
    const double *start; /* [n_start][n_gene] designs to begin from */
    const volatile sig_atomic_t *stop;
    hf_trade_watcher *watcher; /* NULL: none */
} hf_trade;

/* Can hf_trade_find follow the front of these objectives? Designs must be such that hf_polish_applies to. */
bool hf_trade_applies(const hf_evaluator *evaluator);

/* *front is created here, all of it but `base`; free it in any case. HF_OK, also when points failed, which are marked;
 * HF_NO_MEMORY; HF_INTERRUPTED; the status of the last try where no start leads to a feasible design at an end, whose
 * objective is *failed_end then, else -1. */
hf_status hf_trade_find(const hf_trade *trade, hf_front *front, int *failed_end);

#endif
