/* batch - evaluates many designs on all cores. <hifdm/batch.h> describes the interface.
 *
 *     hf_batch_share   chooses the solver and makes its engine: chord, swarm or none
 *     hf_batch_run     designs [n][n_variable] -> results [n]
 *     hf_batch_next    the optimiser proposes individuals -> results of the next generation
 *
 *     each thread: take the next index -> load the design into a lane -> solve -> store result[i] -> take ...
 *
 * Without an engine, each thread solves one design after the other by hf_evaluate.
 * Contents: the engine - the parallel run - waiting threads */
#include <hifdm/batch.h>

#include "base/clock.h"
#include "search/chord.h"
#include "search/parallel.h"
#include "search/swarm.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int hf_batch_default_threads(void)
{
    return hf_parallel_cores();
}

/* Returns the number of rooms (parallel.h) whose memory is allocated when the batch is made. A batch inside
 * hf_parallel_for begins with one room. has_room allocates each of the others when a thread begins to work in it. */
static int n_room_at_once(const hf_batch *batch)
{
    return hf_parallel_is_inside() ? 1 : batch->n_thread;
}

/* Allocates the workspace of one room, and its memory for the objectives of the evaluator. */
static hf_status make_room(hf_batch *batch, int room)
{
    const hf_evaluator *v = batch->evaluator;
    HF_TRY(hf_workspace_create(v->model, &batch->workspace[room]));
    return hf_objectives_point_create(v->objectives, &batch->point[room]);
}

hf_status hf_batch_create(const hf_evaluator *evaluator, int n_thread, hf_batch *batch)
{
    if (n_thread <= 0) n_thread = hf_batch_default_threads();
    *batch = (hf_batch){.evaluator = evaluator};
    batch->workspace = calloc((size_t)n_thread, sizeof *batch->workspace);
    batch->point = calloc((size_t)n_thread, sizeof *batch->point);
    if (!batch->workspace || !batch->point) return HF_NO_MEMORY;
    batch->n_thread = n_thread;
    for (int i = 0; i < n_room_at_once(batch); i++)
        HF_TRY(make_room(batch, i));
    return HF_OK;
}

/* ---- the engine ---- */

/* What the threads share to solve designs, and the lanes of each thread. */
struct hf_batch_engine {
    hf_solver solver;      /* CHORD or FIXED_POINT; no other solver has an engine */
    hf_chord shared;       /* for CHORD: the shared Newton matrix */
    hf_chord_lanes *chord; /* [n_thread], for CHORD: the lanes of each room */
    hf_swarm_plan plan;    /* for FIXED_POINT: what the lanes share */
    hf_swarm_lanes *lanes; /* [n_thread], for FIXED_POINT: the lanes of each room */
};

static void free_engine(hf_batch *batch)
{
    struct hf_batch_engine *e = batch->engine;
    if (!e) return;
    for (int i = 0; i < batch->n_thread; i++) {
        hf_arena_free(&e->chord[i].arena);
        hf_arena_free(&e->lanes[i].arena);
    }
    hf_arena_free(&e->shared.arena);
    hf_arena_free_block(e->plan.block);
    hf_arena_free_block(e);
    batch->engine = NULL;
}

/* Allocates the lanes of one room, unless they are allocated already. */
static hf_status make_lanes(struct hf_batch_engine *e, int room)
{
    if (e->chord[room].arena.block || e->lanes[room].arena.block) return HF_OK;
    return e->solver == HF_SOLVER_CHORD ? hf_chord_lanes_create(&e->shared, &e->chord[room])
                                        : hf_swarm_lanes_create(&e->plan, &e->lanes[room]);
}

static hf_status fill_engine(hf_batch *batch, struct hf_batch_engine *e, const double *initial)
{
    const hf_evaluator *v = batch->evaluator;
    if (e->solver == HF_SOLVER_CHORD)
        HF_TRY(hf_chord_create(v, initial, &batch->workspace[0], &batch->point[0], &e->shared));
    else
        HF_TRY(hf_swarm_plan_create(v->model, hf_lane_best_isa(), &e->plan));
    for (int i = 0; i < n_room_at_once(batch); i++)
        HF_TRY(make_lanes(e, i));
    return HF_OK;
}

/* Makes the engine of this solver; initial [n_variable] is the initial design. Returns false and leaves the batch
 * without an engine if memory runs out, or if the initial design is unsuitable. lacks_memory is true in the first
 * case. */
static bool set_engine(hf_batch *batch, hf_solver solver, const double *initial)
{
    struct hf_batch_engine made = {.solver = solver};
    void *block; /* the engine is its first item */
    hf_status status = HF_ARENA_ARRAYS(&block, HF_ARRAY(batch->engine, 1), HF_ARRAY(made.chord, batch->n_thread),
                                       HF_ARRAY(made.lanes, batch->n_thread));
    if (status == HF_OK) {
        *batch->engine = made;
        status = fill_engine(batch, batch->engine, initial);
    }
    batch->lacks_memory = status == HF_NO_MEMORY;
    if (status != HF_OK) free_engine(batch);
    return status == HF_OK;
}

/* Returns true if hf_evaluate solves each design of this evaluator by Newton's method. */
static bool each_by_newton(const hf_evaluator *v)
{
    return v->solver != HF_SOLVER_FIXED_POINT && hf_evaluate_is_unique(v) && v->model->has_newton;
}

hf_solver hf_batch_solver(const hf_evaluator *v, bool *has_lanes)
{
    bool may_share = v->solver == HF_SOLVER_AUTO || v->solver == HF_SOLVER_CHORD;
    *has_lanes = true;
    if (may_share && hf_chord_applies(v)) return HF_SOLVER_CHORD;
    *has_lanes = false;
    if (each_by_newton(v)) return HF_SOLVER_NEWTON;
    /* The lanes of swarm support neither LAPACK, struts, a truss, optimize.variables, limits nor objectives, and only
     * some laws. Such designs are solved one after the other. */
    *has_lanes = !v->model->by_lapack && !v->model->has_strut && !v->model->n_attachment && !v->model->variable &&
                 !v->limits && !v->objectives;
    for (int e = 0; e < v->model->n_cable && *has_lanes; e++)
        *has_lanes = hf_law_is_served(v->model->law[e], HF_SWARM_LAWS);
    return HF_SOLVER_FIXED_POINT;
}

hf_solver hf_batch_share(hf_batch *batch, const double *initial)
{
    bool has_lanes;
    hf_solver solver = hf_batch_solver(batch->evaluator, &has_lanes);
    free_engine(batch); /* made for an earlier initial design */
    batch->lacks_memory = false;
    if (!has_lanes || set_engine(batch, solver, initial) || solver == HF_SOLVER_FIXED_POINT) return solver;
    return each_by_newton(batch->evaluator) ? HF_SOLVER_NEWTON : HF_SOLVER_FIXED_POINT;
}

/* Allocates the memory of a room unless it is allocated already. Returns false if that fails. Only one thread at a time
 * works in a room, so no lock is needed. */
static bool has_room(hf_batch *batch, int room)
{
    if (!batch->workspace[room].block && make_room(batch, room) != HF_OK) return false;
    return !batch->engine || make_lanes(batch->engine, room) == HF_OK;
}

/* Evaluates designs in the calling thread until `next` returns -1. design: [][n_variable]; r: [], written at the
 * indices that `next` returns. If keeps_shape is true, the workspace of the room holds the last shape afterwards. */
static void work_off(hf_batch *batch, int room, hf_lane_next *next, void *context, bool keeps_shape,
                     const double *design, hf_form_result *r)
{
    const hf_evaluator *v = batch->evaluator;
    const struct hf_batch_engine *e = batch->engine;
    hf_workspace *w = &batch->workspace[room];
    hf_objectives_point *point = &batch->point[room];
    if (e && e->solver == HF_SOLVER_CHORD)
        hf_chord_run(&e->shared, &e->chord[room], w, point, next, context, keeps_shape, design, r);
    else if (e)
        hf_swarm_run(v, &e->plan, &e->lanes[room], w, next, context, design, r);
    else
        for (int i = next(context); i >= 0; i = next(context))
            hf_evaluate(v, design + (size_t)i * (size_t)v->model->n_variable, w, point, &r[i]);
}

/* ---- the parallel run ---- */

/* The designs of one call of hf_batch_run or hf_batch_next, shared by all its threads. */
typedef struct {
    hf_batch *batch;
    hf_parallel_queue queue; /* indices of the designs, or of the individuals that are still to be proposed */
    const double *design;
    hf_form_result *result;
    hf_optimiser *optimiser; /* proposes the individuals of the next generation; NULL: the designs are given */
    void (*beside)(void *context);
    void *context;
} batch_job;

/* Returns the index of the next design, or -1 when none is left. Proposes individuals until one must be evaluated. */
static int next_design(void *context)
{
    batch_job *j = context;
    for (int i = hf_parallel_take(&j->queue);; i = hf_parallel_take(&j->queue)) {
        if (i < 0 || !j->optimiser) return i;
        hf_optimiser_propose(j->optimiser, i);
        if (j->optimiser->next.pending[i]) return i;
    }
}

/* Does the work of one thread. Room 0 first calls `beside`. If the memory for its room cannot be allocated, the thread
 * returns, and the others evaluate the remaining designs. */
static void work_on_job(void *context, int room)
{
    batch_job *j = context;
    if (room == 0 && j->beside) j->beside(j->context);
    if (hf_parallel_is_empty(&j->queue) || !has_room(j->batch, room)) return;
    double start_s = hf_clock_thread_cpu_s();
    work_off(j->batch, room, next_design, j, false, j->design, j->result);
    /* Only the processor time of this thread counts. Its wait for other threads is not included. */
    hf_parallel_add(&j->batch->cpu_s, hf_clock_thread_cpu_s() - start_s);
}

void hf_batch_run(hf_batch *batch, int n, const double *design, const unsigned char *pending, hf_form_result *r)
{
    batch_job job = {batch, {n, 0, pending}, design, r, NULL, NULL, NULL};
    if (n > 0) hf_parallel_run(batch->n_thread, work_on_job, &job);
}

bool hf_batch_next(hf_batch *batch, hf_optimiser *optimiser, void (*beside)(void *context), void *context)
{
    const hf_population *next = &optimiser->next;
    batch_job job = {
        batch, {optimiser->population.n_individual, 0, NULL}, next->design, next->result, optimiser, beside, context};
    if (!hf_optimiser_begin(optimiser)) {
        if (beside) beside(context);
        return false;
    }
    hf_parallel_run(batch->n_thread, work_on_job, &job);
    hf_optimiser_end(optimiser);
    return true;
}

hf_workspace *hf_batch_run_one(hf_batch *batch, const double *design, hf_form_result *r)
{
    hf_parallel_queue one = {1, 0, NULL};
    work_off(batch, 0, hf_parallel_take, &one, true, design, r);
    return &batch->workspace[0];
}

void hf_batch_free(hf_batch *batch)
{
    free_engine(batch);
    for (int i = 0; i < batch->n_thread; i++) {
        hf_objectives_point_free(&batch->point[i]);
        hf_workspace_free(&batch->workspace[i]);
    }
    free(batch->point);
    free(batch->workspace);
    *batch = (hf_batch){0};
}

/* ---- waiting threads ---- */

/* Makes OpenMP threads sleep while they wait: sets two environment variables and starts the program again. */
void hf_batch_wait_quietly(char *const *argv)
{
    char path[PATH_MAX];
    if (getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT")) return;
    ssize_t n = readlink("/proc/self/exe", path, sizeof path - 1);
    if (n <= 0 || n == sizeof path - 1) return; /* the path is unknown, or may be truncated */
    path[n] = '\0';
    /* The dynamic linker was started with this program as its argument, so the path is not that of the program. */
    if (strstr(path, "/ld-") || strstr(path, "/ld.so")) return;
    if (setenv("GOMP_SPINCOUNT", "2000", 1) != 0) return;
    /* GOMP_SPINCOUNT is read by libgomp, OMP_WAIT_POLICY by other OpenMP libraries. */
    if (setenv("OMP_WAIT_POLICY", "passive", 1) == 0) execv(path, argv);
}
