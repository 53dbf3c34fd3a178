/* Implements loops over threads by OpenMP. parallel.h describes the interface.
 *
 *     hf_parallel_for     n_thread workers and one server -> items 0 ... n-1
 *     hf_parallel_run     inside hf_parallel_for: a task for each room; otherwise: a thread for each room
 *     hf_parallel_each    hf_parallel_run, whose rooms take items 0 ... n-1 from one queue */
#include "search/parallel.h"

#include "base/later.h"

#include <omp.h>
#include <stddef.h>

int hf_parallel_cores(void)
{
    return omp_get_num_procs();
}

bool hf_parallel_is_inside(void)
{
    return omp_in_parallel() != 0;
}

int hf_parallel_take(void *queue)
{
    hf_parallel_queue *q = queue;
    for (;;) {
        int i;
#pragma omp atomic capture
        i = q->n_taken++;
        if (i >= q->n) return -1;
        if (!q->wanted || q->wanted[i]) return i;
    }
}

bool hf_parallel_is_empty(const hf_parallel_queue *queue)
{
    int n_taken;
#pragma omp atomic read
    n_taken = queue->n_taken;
    return n_taken >= queue->n;
}

void hf_parallel_add(double *sum, double value)
{
#pragma omp atomic
    *sum += value;
}

void hf_parallel_run(int n_thread, void (*work)(void *context, int room), void *context)
{
    if (!hf_parallel_is_inside()) {
#pragma omp parallel num_threads(n_thread)
        work(context, omp_get_thread_num());
        return;
    }
    /* In a thread of hf_parallel_for, each room is a task, whichever thread runs it. */
    for (int room = 1; room < n_thread; room++) {
#pragma omp task firstprivate(room, work, context)
        work(context, room);
    }
    work(context, 0);
#pragma omp taskwait
}

/* The items of hf_parallel_each. */
typedef struct {
    hf_parallel_queue queue;
    void (*work)(void *context, int room, int i);
    void *context;
} shared_items;

static void work_in_room(void *context, int room)
{
    shared_items *items = context;
    for (int i = hf_parallel_take(&items->queue); i >= 0; i = hf_parallel_take(&items->queue))
        items->work(items->context, room, i);
}

void hf_parallel_each(int n_thread, int n, void (*work)(void *context, int room, int i), void *context)
{
    shared_items items = {{n, 0, NULL}, work, context};
    if (n_thread > n) n_thread = n;
    if (n_thread > 1)
        hf_parallel_run(n_thread, work_in_room, &items);
    else
        work_in_room(&items, 0);
}

/* Works on items until none is left. `later` is NULL if no thread serves the list. */
static void work_on_items(hf_parallel_queue *items, hf_later_list *later, void (*work)(void *context, int i),
                          void *context)
{
    if (later) hf_later_join(later);
    for (int i = hf_parallel_take(items); i >= 0; i = hf_parallel_take(items))
        work(context, i);
    if (later) hf_later_leave(later);
}

void hf_parallel_for(int n_thread, int n, void (*work)(void *context, int i), void *context)
{
    hf_parallel_queue items = {n, 0, NULL};
    hf_later_list later;
    if (n_thread <= 0) n_thread = hf_parallel_cores();
    hf_later_open(n_thread, &later);
#pragma omp parallel num_threads(n_thread + 1)
    {
        /* If OpenMP provides fewer threads than requested, all of them work and none serves. */
        bool has_server = omp_get_num_threads() > n_thread;
        if (omp_get_thread_num() < n_thread)
            work_on_items(&items, has_server ? &later : NULL, work, context);
        else
            hf_later_serve(&later);
        /* At this barrier, threads without an item run the tasks of hf_parallel_run. */
    }
    hf_later_close(&later);
}
