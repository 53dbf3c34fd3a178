#include "base/later.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

static _Thread_local hf_later_list *joined_list; /* NULL: the thread has joined no list */

void hf_later_open(int n_worker, hf_later_list *list)
{
    *list =
        (hf_later_list){.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER, .n_worker = n_worker};
}

void hf_later_close(hf_later_list *list)
{
    pthread_mutex_destroy(&list->lock);
    pthread_cond_destroy(&list->changed);
}

void hf_later_serve(hf_later_list *list)
{
    pthread_mutex_lock(&list->lock);
    for (;;) {
        while (list->n == 0 && list->n_worker > 0)
            pthread_cond_wait(&list->changed, &list->lock);
        if (list->n == 0) break;
        void (*work)(void *) = list->item[0].work;
        void *context = list->item[0].context;
        memmove(list->item, list->item + 1, (size_t)--list->n * sizeof list->item[0]);
        pthread_mutex_unlock(&list->lock);
        work(context);
        pthread_mutex_lock(&list->lock);
    }
    pthread_mutex_unlock(&list->lock);
}

void hf_later_join(hf_later_list *list)
{
    joined_list = list;
}

void hf_later_leave(hf_later_list *list)
{
    joined_list = NULL;
    pthread_mutex_lock(&list->lock);
    list->n_worker--;
    pthread_cond_signal(&list->changed);
    pthread_mutex_unlock(&list->lock);
}

void hf_later_do(void (*work)(void *context), void *context)
{
    hf_later_list *list = joined_list;
    bool is_taken = false;
    if (list) {
        pthread_mutex_lock(&list->lock);
        is_taken = list->n < HF_LATER_MAX;
        if (is_taken) {
            list->item[list->n].work = work;
            list->item[list->n++].context = context;
            pthread_cond_signal(&list->changed);
        }
        pthread_mutex_unlock(&list->lock);
    }
    if (!is_taken) work(context);
}
