/* parallel - loops over threads: the only user of OpenMP.
 *
 * A `room` is the number of a copy of working memory: in one call of hf_parallel_run no two threads have the same
 * room, and the calling thread has room 0. */
#ifndef HIFDM_PARALLEL_H
#define HIFDM_PARALLEL_H

#include <stdbool.h>

int hf_parallel_cores(void);      /* available to this process */
bool hf_parallel_is_inside(void); /* is this a thread of one of the loops below? */

/* Hands the numbers from 0 to n - 1 out to any number of threads, rising, each once. */
typedef struct {
    int n, n_taken;
    const unsigned char *wanted; /* [n] numbers with a 0 are left out; NULL: all are wanted */
} hf_parallel_queue;

/* The next number, or -1 when none is left. queue: hf_parallel_queue. */
int hf_parallel_take(void *queue);
bool hf_parallel_is_empty(const hf_parallel_queue *queue);

/* *sum += value, from any thread. */
void hf_parallel_add(double *sum, double value);

/* Call work(context, room) for every room from 0 to n_thread - 1, in as many threads, and return when all calls have.
 * Inside hf_parallel_for the calling thread takes room 0, then the rooms that are left; threads of the loop that have
 * no item take rooms from it meanwhile. */
void hf_parallel_run(int n_thread, void (*work)(void *context, int room), void *context);

/* first(context) in one thread and beside(beside_context) in another; then work(context, room) in each of n_thread
 * threads, which begins there when first has returned and, in the other thread, beside has. Not inside another loop.
 * With one thread all three one after the other. */
void hf_parallel_run_after(int n_thread, void (*first)(void *context), void (*work)(void *context, int room),
                           void *context, void (*beside)(void *context), void *beside_context);

/* work(context, i) for i = 0 ... n-1, handed out in this order to n_thread threads (0: all cores). Calls of
 * hf_parallel_run inside share these threads: those that find no i left help, so that all are busy until the last i is
 * done. What work gives to hf_later_do runs in one thread more; all of it is done when this returns. */
void hf_parallel_for(int n_thread, int n, void (*work)(void *context, int i), void *context);

#endif
