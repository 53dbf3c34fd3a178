/* parallel - loops over threads. No other file uses OpenMP.
 *
 * A `room` is the number of a copy of working memory. In one call of hf_parallel_run no two threads have the same room
 * at a time, and the calling thread has room 0. */
#ifndef HIFDM_PARALLEL_H
#define HIFDM_PARALLEL_H

#include <stdbool.h>

int hf_parallel_cores(void);      /* available to this process */
bool hf_parallel_is_inside(void); /* is this a thread of one of the loops below? */

/* The numbers from 0 to n - 1, which any number of threads take in rising order, each number once. */
typedef struct {
    int n, n_taken;
    const unsigned char *wanted; /* [n] a number with 0 is left out; NULL: all are wanted */
} hf_parallel_queue;

/* Returns the next number, or -1 when none is left. `queue` points to an hf_parallel_queue. */
int hf_parallel_take(void *queue);
bool hf_parallel_is_empty(const hf_parallel_queue *queue);

/* *sum += value, from any thread. */
void hf_parallel_add(double *sum, double value);

/* Call work(context, room) for every room from 0 to n_thread - 1, in n_thread threads, and return when all calls have
 * returned. Inside hf_parallel_for the calling thread takes room 0 and then the rooms that are left; threads of that
 * loop without an item take rooms meanwhile. */
void hf_parallel_run(int n_thread, void (*work)(void *context, int room), void *context);

/* Call work(context, room, i) once for i = 0 ... n-1, in hf_parallel_run with n_thread rooms, or in the calling thread
 * alone with room 0 where n_thread is 0 or 1. */
void hf_parallel_each(int n_thread, int n, void (*work)(void *context, int room, int i), void *context);

/* Call work(context, i) for i = 0 ... n-1, handed out in this order to n_thread threads (0: all cores). Calls of
 * hf_parallel_run inside share these threads: a thread that finds no i left helps there, so that all are busy until the
 * last i is done. What work gives to hf_later_do runs in one further thread, and is done when this returns. */
void hf_parallel_for(int n_thread, int n, void (*work)(void *context, int i), void *context);

#endif
