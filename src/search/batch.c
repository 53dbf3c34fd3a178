#include <hifdm/batch.h>

#include "base/clock.h"
#include "linalg/band.h"
#include "search/chord.h"
#include "search/swarm.h"

#include <assert.h>
#include <errno.h>
#include <omp.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdlib.h>
#include <string.h>

int hf_batch_default_threads(void)
{
    return omp_get_num_procs();
}

/* A batch beside others has more than one thread only when those others leave some: these bring their room along. */
static int n_room_at_once(const hf_batch *batch)
{
    return omp_in_parallel() ? 1 : batch->n_thread;
}

hf_status hf_batch_create(const hf_evaluator *evaluator, int n_thread, hf_batch *batch)
{
    if (n_thread <= 0) n_thread = hf_batch_default_threads();
    *batch = (hf_batch){.evaluator = evaluator};
    batch->workspace = calloc((size_t)n_thread, sizeof *batch->workspace);
    if (!batch->workspace) return HF_NO_MEMORY;
    batch->n_thread = n_thread;
    for (int i = 0; i < n_room_at_once(batch); i++)
        HF_TRY(hf_workspace_create(evaluator->model, &batch->workspace[i]));
    hf_band_single_threaded();
    return HF_OK;
}

/* ---- what designs are solved with ---- */

struct hf_batch_engine {
    int solver;               /* hf_solver: CHORD or FIXED_POINT; each design its own NEWTON needs no engine */
    hf_chord shared;          /* CHORD */
    hf_chord_lanes *chord;    /* [n_thread] */
    hf_lane_plan plan;        /* FIXED_POINT */
    hf_lane_workspace *lanes; /* [n_thread] */
};

static void free_engine(hf_batch *batch)
{
    struct hf_batch_engine *e = batch->engine;
    if (!e) return;
    for (int i = 0; e->chord && i < batch->n_thread; i++)
        hf_chord_lanes_free(&e->chord[i]);
    for (int i = 0; e->lanes && i < batch->n_thread; i++)
        hf_lane_workspace_free(&e->lanes[i]);
    free(e->chord);
    free(e->lanes);
    hf_chord_free(&e->shared);
    hf_lane_plan_free(&e->plan);
    free(e);
    batch->engine = NULL;
}

static hf_status create_chord(hf_batch *batch, struct hf_batch_engine *e, const double *base_N)
{
    HF_TRY(hf_chord_create(batch->evaluator, base_N, &batch->workspace[0], &e->shared));
    e->chord = calloc((size_t)batch->n_thread, sizeof *e->chord);
    if (!e->chord) return HF_NO_MEMORY;
    for (int i = 0; i < n_room_at_once(batch); i++)
        HF_TRY(hf_chord_lanes_create(&e->shared, &e->chord[i]));
    return HF_OK;
}

static hf_status create_lanes(hf_batch *batch, struct hf_batch_engine *e)
{
    HF_TRY(hf_lane_plan_create(batch->evaluator->model, hf_lane_best_isa(), &e->plan));
    e->lanes = calloc((size_t)batch->n_thread, sizeof *e->lanes);
    if (!e->lanes) return HF_NO_MEMORY;
    for (int i = 0; i < n_room_at_once(batch); i++)
        HF_TRY(hf_lane_workspace_create(&e->plan, &e->lanes[i]));
    return HF_OK;
}

/* Does the batch now have this engine? Out of memory, or an unsuitable base design, leave it without. */
static int set_engine(hf_batch *batch, int solver, const double *base_N)
{
    struct hf_batch_engine *e = batch->engine = calloc(1, sizeof *e);
    if (!e) return 0;
    e->solver = solver;
    hf_status status = solver == HF_SOLVER_CHORD ? create_chord(batch, e, base_N) : create_lanes(batch, e);
    if (status != HF_OK) free_engine(batch);
    return status == HF_OK;
}

static int each_by_newton(const hf_evaluator *v)
{
    return v->solver != HF_SOLVER_FIXED_POINT && v->rule != HF_RULE_SEEDED && v->model->has_newton;
}

int hf_batch_solver(const hf_evaluator *v, int *has_lanes)
{
    int may_share = v->solver == HF_SOLVER_AUTO || v->solver == HF_SOLVER_CHORD;
    *has_lanes = 1;
    if (may_share && hf_chord_applies(v)) return HF_SOLVER_CHORD;
    *has_lanes = 0;
    if (each_by_newton(v)) return HF_SOLVER_NEWTON;
    /* the lanes serve neither struts, nor every law, nor a truss: such nets are solved one by one */
    *has_lanes = !v->model->has_strut && !v->model->n_attachment;
    for (int e = 0; e < v->model->n_cable; e++)
        *has_lanes &= hf_law_is_served(v->model->law[e], HF_LANE_LAWS);
    return HF_SOLVER_FIXED_POINT;
}

int hf_batch_share(hf_batch *batch, const double *base_N)
{
    int has_lanes, solver = hf_batch_solver(batch->evaluator, &has_lanes);
    free_engine(batch); /* of an earlier base */
    if (!has_lanes || set_engine(batch, solver, base_N) || solver == HF_SOLVER_FIXED_POINT) return solver;
    return each_by_newton(batch->evaluator) ? HF_SOLVER_NEWTON : HF_SOLVER_FIXED_POINT;
}

/* Is there room for a helper, or memory for one? Only one thread at a time has the number. */
static int has_room(hf_batch *batch, int room)
{
    struct hf_batch_engine *e = batch->engine;
    if (!batch->workspace[room].block && hf_workspace_create(batch->evaluator->model, &batch->workspace[room]) != HF_OK)
        return 0;
    if (e && e->chord && !e->chord[room].block) return hf_chord_lanes_create(&e->shared, &e->chord[room]) == HF_OK;
    if (e && e->lanes && !e->lanes[room].block) return hf_lane_workspace_create(&e->plan, &e->lanes[room]) == HF_OK;
    return 1;
}

/* One thread's share of the designs that `next` hands out. */
static void work_off(hf_batch *batch, int room, int (*next)(void *), void *context, const double *design_N,
                     hf_form_result *result)
{
    const hf_evaluator *v = batch->evaluator;
    const struct hf_batch_engine *e = batch->engine;
    hf_workspace *w = &batch->workspace[room];
    if (e && e->solver == HF_SOLVER_CHORD)
        hf_chord_run(&e->shared, &e->chord[room], w, next, context, design_N, result);
    else if (e)
        hf_swarm_run(v, &e->plan, &e->lanes[room], w, next, context, design_N, result);
    else
        for (int i = next(context); i >= 0; i = next(context))
            hf_evaluate(v, design_N + (size_t)i * (size_t)v->model->n_gene, w, &result[i]);
}

/* ---- the parallel run ---- */

typedef struct {
    int n, done; /* designs; handed out so far */
    const unsigned char *pending;
} queue;

/* The next design that needs an evaluation, or -1; each is handed out once. */
static int take_next(void *context)
{
    queue *q = context;
    for (;;) {
        int i;
#pragma omp atomic capture
        i = q->done++;
        if (i >= q->n) return -1;
        if (!q->pending || q->pending[i]) return i;
    }
}

/* The same with the time it takes, added up over all who work. */
static void share_work(hf_batch *batch, int room, queue *work, const double *design_N, hf_form_result *result)
{
    double start_s = hf_clock_thread_cpu_s();
    work_off(batch, room, take_next, work, design_N, result);
    double cpu_s = hf_clock_thread_cpu_s() - start_s; /* without the wait for the other threads */
#pragma omp atomic
    batch->cpu_s += cpu_s;
}

static int is_done(const queue *q)
{
    int done;
#pragma omp atomic read
    done = q->done;
    return done >= q->n;
}

/* ---- batches beside each other ---- */

/* Helps with a batch if there are designs left, and memory. */
static void help(hf_batch *batch, int room, queue *work, const double *design_N, hf_form_result *result)
{
    if (!is_done(work) && has_room(batch, room)) share_work(batch, room, work, design_N, result);
}

/* In a thread of hf_batch_for: threads without work of their own may come and help. Whoever takes one of these tasks,
 * the thread itself or another, finds a room that is nobody else's. */
static void run_beside_others(hf_batch *batch, queue *work, const double *design_N, hf_form_result *result)
{
    for (int room = 1; room < batch->n_thread; room++) {
#pragma omp task firstprivate(room, batch, work, design_N, result)
        help(batch, room, work, design_N, result);
    }
    share_work(batch, 0, work, design_N, result);
#pragma omp taskwait
}

void hf_batch_run(hf_batch *batch, int n, const double *design_N, const unsigned char *pending, hf_form_result *result)
{
    if (n <= 0) return;
    queue work = {n, 0, pending};
    if (omp_in_parallel()) {
        run_beside_others(batch, &work, design_N, result);
        return;
    }
#pragma omp parallel num_threads(batch->n_thread)
    share_work(batch, omp_get_thread_num(), &work, design_N, result);
}

/* One thread breeds and another runs `beside` at the same time; who is through first evaluates first. */
static void breed_and_run(hf_batch *batch, hf_ga *ga, void (*beside)(void *), void *context)
{
    queue work = {0};
    sem_t bred;
    int failed = sem_init(&bred, 0, 0);
    assert(!failed);
    (void)failed;
#pragma omp parallel num_threads(batch->n_thread)
    {
        int thread = omp_get_thread_num(), n = omp_get_num_threads();
        if (thread == 0) {
            hf_ga_next(ga);
            work = (queue){ga->n_individual, 0, ga->pending};
            for (int i = 1; i < n; i++)
                sem_post(&bred);
        }
        if (thread == (n > 1)) beside(context);
        while (thread > 0 && sem_wait(&bred) != 0)
            assert(errno == EINTR);
        share_work(batch, thread, &work, ga->design_N, ga->result);
    }
    sem_destroy(&bred);
}

int hf_batch_next(hf_batch *batch, hf_ga *ga, void (*beside)(void *context), void *context)
{
    int is_last = ga->stop_reason != HF_GA_RUNNING;
    if (beside && !is_last && batch->n_thread > 1 && !omp_in_parallel()) {
        breed_and_run(batch, ga, beside, context);
        return 1;
    }
    if (beside) beside(context);
    if (!hf_ga_next(ga)) return 0;
    hf_batch_run(batch, ga->n_individual, ga->design_N, ga->pending, ga->result);
    return 1;
}

/* ---- the rest of a piece of work, which waits for the disk ---- */

#define LATER_MAX 8 /* each holds files open */

typedef struct {
    pthread_mutex_t lock;
    pthread_cond_t news;
    int n, n_worker; /* that wait; threads that may bring more */
    struct {
        void (*work)(void *context);
        void *context;
    } item[LATER_MAX];
} later_list;

static _Thread_local later_list *later_of_this; /* of the hf_batch_for that this thread works for, or NULL */

void hf_batch_later(void (*later)(void *context), void *context)
{
    later_list *l = later_of_this;
    int is_taken = 0;
    if (l) {
        pthread_mutex_lock(&l->lock);
        is_taken = l->n < LATER_MAX;
        if (is_taken) {
            l->item[l->n].work = later;
            l->item[l->n++].context = context;
            pthread_cond_signal(&l->news);
        }
        pthread_mutex_unlock(&l->lock);
    }
    if (!is_taken) later(context);
}

/* Until no worker is left and nothing waits. */
static void do_later(later_list *l)
{
    pthread_mutex_lock(&l->lock);
    for (;;) {
        while (l->n == 0 && l->n_worker > 0)
            pthread_cond_wait(&l->news, &l->lock);
        if (l->n == 0) break;
        void (*work)(void *) = l->item[0].work;
        void *context = l->item[0].context;
        memmove(l->item, l->item + 1, (size_t)--l->n * sizeof l->item[0]);
        pthread_mutex_unlock(&l->lock);
        work(context);
        pthread_mutex_lock(&l->lock);
    }
    pthread_mutex_unlock(&l->lock);
}

/* l: NULL when nobody does what is left for later. */
static void work_on_all(queue *items, later_list *l, void (*work)(void *context, int i), void *context)
{
    later_of_this = l;
    for (int i = take_next(items); i >= 0; i = take_next(items))
        work(context, i);
    later_of_this = NULL;
    if (!l) return;
    pthread_mutex_lock(&l->lock);
    l->n_worker--;
    pthread_cond_signal(&l->news);
    pthread_mutex_unlock(&l->lock);
}

void hf_batch_for(int n_thread, int n, void (*work)(void *context, int i), void *context)
{
    queue items = {n, 0, NULL};
    later_list later = {.lock = PTHREAD_MUTEX_INITIALIZER, .news = PTHREAD_COND_INITIALIZER};
    if (n_thread <= 0) n_thread = hf_batch_default_threads();
    later.n_worker = n_thread;
#pragma omp parallel num_threads(n_thread + 1)
    {
        int has_waiter = omp_get_num_threads() > n_thread; /* fewer threads than asked for all work */
        if (omp_get_thread_num() < n_thread)
            work_on_all(&items, has_waiter ? &later : NULL, work, context);
        else
            do_later(&later);
    } /* here threads that are through take the tasks of those that are not */
    pthread_mutex_destroy(&later.lock);
    pthread_cond_destroy(&later.news);
}

hf_workspace *hf_batch_run_one(hf_batch *batch, const double *design_N, hf_form_result *result)
{
    queue work = {1, 0, NULL};
    work_off(batch, 0, take_next, &work, design_N, result);
    return &batch->workspace[0];
}

void hf_batch_free(hf_batch *batch)
{
    free_engine(batch);
    for (int i = 0; i < batch->n_thread; i++)
        hf_workspace_free(&batch->workspace[i]);
    free(batch->workspace);
    *batch = (hf_batch){0};
}
