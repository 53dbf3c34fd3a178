/* later - hands the end of a piece of work to a thread that does nothing else. Such work mostly waits for the disk;
 * meanwhile the workers continue to compute.
 *
 *     one thread                 hf_later_serve(&list);
 *     each of n_worker threads   hf_later_join(&list); ... hf_later_do(work, context); ... hf_later_leave(&list); */
#pragma once

#include <pthread.h>

#define HF_LATER_MAX 8 /* maximum number of waiting items; each keeps files open */

typedef struct {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    int n;        /* waiting items */
    int n_worker; /* threads that may still add items */
    struct {
        void (*work)(void *context);
        void *context;
    } item[HF_LATER_MAX];
} hf_later_list;

/* Makes an empty list for n_worker threads. Call hf_later_close after hf_later_serve has returned. */
void hf_later_open(int n_worker, hf_later_list *list);
void hf_later_close(hf_later_list *list);

/* Runs the items in the order of their arrival. Returns when every worker has left and no item is waiting. */
void hf_later_serve(hf_later_list *list);

/* Join and leave a list. Between the two calls, hf_later_do in the calling thread adds items to the list. */
void hf_later_join(hf_later_list *list);
void hf_later_leave(hf_later_list *list);

/* Calls work(context) once. The serving thread makes the call if the calling thread has joined a list and fewer than
 * HF_LATER_MAX items are waiting. Otherwise the calling thread makes it at once. */
void hf_later_do(void (*work)(void *context), void *context);
