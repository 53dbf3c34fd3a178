/* later - the end of a piece of work, which mostly waits for the disk, handed to a thread that does nothing else, so
 * that the workers go on computing meanwhile.
 *
 *     one thread                 hf_later_serve(&list);
 *     each of n_worker threads   hf_later_join(&list); ... hf_later_do(work, context); ... hf_later_leave(&list); */
#ifndef HIFDM_LATER_H
#define HIFDM_LATER_H

#include <pthread.h>

#define HF_LATER_MAX 8 /* items that may wait at the same time: each holds files open */

typedef struct {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    int n;        /* items that wait */
    int n_worker; /* threads that may still add items */
    struct {
        void (*work)(void *context);
        void *context;
    } item[HF_LATER_MAX];
} hf_later_list;

/* An empty list for n_worker threads. Close it after hf_later_serve has returned. */
void hf_later_open(int n_worker, hf_later_list *list);
void hf_later_close(hf_later_list *list);

/* Do the items in the order in which they came, until every worker has left and none waits. */
void hf_later_serve(hf_later_list *list);

/* Between the two calls, hf_later_do in this thread adds to the list. */
void hf_later_join(hf_later_list *list);
void hf_later_leave(hf_later_list *list);

/* Call work(context) once: in the serving thread, or at once in this one when it has joined no list or HF_LATER_MAX
 * items wait already. */
void hf_later_do(void (*work)(void *context), void *context);

#endif
