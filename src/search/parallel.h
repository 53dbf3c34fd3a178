/* parallel - loops over threads. No other file uses OpenMP.
 *
 * A room is a copy of working memory, given by its number. In one call of hf_parallel_run, no two threads work in the
 * same room at the same time. The calling thread has room 0. */
#pragma once

#include <stdbool.h>

int hf_parallel_cores(void);      /* Returns the number of cores available to this process. */
bool hf_parallel_is_inside(void); /* Returns true in a thread of a loop below. */

/* The numbers from 0 to n - 1. Any number of threads take them in rising order, each number once. */
typedef struct {
    int n, n_taken;
    const unsigned char *wanted; /* [n], 0: the number is left out; NULL: no number is left out */
} hf_parallel_queue;

/* Returns the next number, or -1 if none is left. `queue` points to an hf_parallel_queue. */
int hf_parallel_take(void *queue);
/* Returns true if no number is left. */
bool hf_parallel_is_empty(const hf_parallel_queue *queue);

/* Adds value to *sum. Any thread may call it. */
void hf_parallel_add(double *sum, double value);

/* Calls work(context, room) for every room from 0 to n_thread - 1, in n_thread threads, and returns when all calls have
 * returned. Inside hf_parallel_for, the calling thread takes room 0, and then rooms that no other thread has taken.
 * Threads of hf_parallel_for without an item take rooms meanwhile. */
void hf_parallel_run(int n_thread, void (*work)(void *context, int room), void *context);

/* Calls work(context, room, i) once for each i from 0 to n - 1, by hf_parallel_run with n_thread rooms. If n_thread or
 * n is at most 1, the calling thread makes all calls, with room 0. */
void hf_parallel_each(int n_thread, int n, void (*work)(void *context, int room, int i), void *context);

/* Calls work(context, i) for each i from 0 to n - 1. The values of i are handed out in rising order to n_thread threads
 * (0: all cores). Calls of hf_parallel_run inside it share these threads. A thread that finds no i left helps there, so
 * all threads are busy until the last i is done. Work that is given to hf_later_do runs in one further thread, and is
 * done when this function returns. */
void hf_parallel_for(int n_thread, int n, void (*work)(void *context, int i), void *context);
