/* Solves many samples of an as-built net on all cores (METHOD section 12). Each thread runs this pipeline:
 *
 *     queue of sample numbers ---> make_sample: cut lengths, EA, positions of supports and loads of the sample
 *                                    |
 *                                    v
 *                                  chord steps, eight samples in the lanes of the vectors (built/near)
 *                                    |                    |
 *                                    | converged          | does not contract
 *                                    v                    v
 *                                  give <---------------- Newton's method (hf_near_find), else hf_built_solve
 *                                    |
 *                                    v
 *                                  the caller's hf_built_take
 *
 * Contents: working memory of a thread, the batch, one sample, the run. */
#include <hifdm/built_batch.h>

#include "base/arena.h"
#include "built/near.h"
#include "search/parallel.h"

#include <limits.h>
#include <string.h>

/* ---- working memory of a thread ---- */

/* Holds the working memory of one thread. Each array has a part for each lane. */
typedef struct {
    hf_workspace work;
    hf_near_lanes near;
    double *cut_m, *EA_N;           /* [HF_LANES][n_cable] of the samples in the lanes */
    double *support_displacement_m; /* [HF_LANES][3][n_node] by row */
    /* [HF_LANES][3][n_node] by row, and [3][n_node][HF_LANES] for the kernels; none if the net has no loads */
    double *load_N, *load_lanes_N;
    void *block;
} batch_room;

struct hf_built_batch {
    const hf_built *built;
    int n_thread;
    bool has_lanes; /* false: the nominal net has no matrix that samples could share */
    hf_near near;
    /* [n_thread] The first room is made with the batch, each other one by the first thread that needs it. */
    batch_room *room;
};

/* Makes a room unless it exists. Returns HF_OK or HF_NO_MEMORY. Only one thread at a time has the number of a room, so
 * no lock is needed. */
static hf_status make_room(const hf_built_batch *batch, batch_room *room)
{
    const hf_model *m = &batch->built->model;
    size_t n = (size_t)m->n_cable * HF_LANES, n_coordinate = 3 * (size_t)m->n_node * HF_LANES;
    size_t n_load = m->load_N ? n_coordinate : 0;
    if (room->block) return HF_OK;
    if (!room->work.block && hf_workspace_create(m, &room->work) != HF_OK) return HF_NO_MEMORY;
    if (batch->has_lanes && !room->near.block && hf_near_lanes_create(&batch->near, &room->near) != HF_OK) {
        hf_near_lanes_free(&room->near);
        return HF_NO_MEMORY;
    }
    return HF_ARENA_ARRAYS(&room->block, HF_ARRAY(room->cut_m, n), HF_ARRAY(room->EA_N, n),
                           HF_ARRAY(room->support_displacement_m, n_coordinate), HF_ARRAY(room->load_N, n_load),
                           HF_ARRAY(room->load_lanes_N, n_load));
}

/* ---- the batch ---- */

hf_status hf_built_batch_create(const hf_built *built, int n_thread, hf_built_batch **batch)
{
    void *block; /* the batch is its first item */
    batch_room *room;
    if (n_thread <= 0) n_thread = hf_parallel_cores();
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(*batch, 1), HF_ARRAY(room, n_thread)));
    **batch = (hf_built_batch){.built = built, .n_thread = n_thread, .room = room};
    /* The first room: the shared matrix needs its workspace. */
    hf_status status = hf_workspace_create(&built->model, &room[0].work);
    if (status == HF_OK) status = hf_built_batch_renew(*batch);
    if (status == HF_OK) status = make_room(*batch, &room[0]);
    if (status == HF_OK) return HF_OK;
    hf_built_batch_free(*batch);
    *batch = NULL;
    return HF_NO_MEMORY;
}

hf_status hf_built_batch_renew(hf_built_batch *batch)
{
    hf_near_free(&batch->near);
    hf_status status = hf_near_create(batch->built, &batch->room[0].work, &batch->near);
    batch->has_lanes = status == HF_OK;
    if (status == HF_OK && !batch->room[0].near.block) /* no earlier design had a matrix */
        status = hf_near_lanes_create(&batch->near, &batch->room[0].near);
    return status == HF_NO_MEMORY ? status : HF_OK;
}

void hf_built_batch_free(hf_built_batch *batch)
{
    if (!batch) return;
    for (int i = 0; i < batch->n_thread; i++) {
        hf_workspace_free(&batch->room[i].work);
        hf_near_lanes_free(&batch->room[i].near);
        hf_arena_free_block(batch->room[i].block);
    }
    hf_near_free(&batch->near);
    hf_arena_free_block(batch);
}

int hf_built_batch_threads(const hf_built_batch *batch)
{
    return batch->n_thread;
}

/* ---- one sample ---- */

/* Holds the samples of one call of hf_built_batch_run. All threads share it. */
typedef struct {
    hf_built_batch *batch;
    unsigned varies;
    long first;
    hf_parallel_queue queue;
    hf_built_sample *make;
    hf_built_take *take;
    void *context;
} batch_job;

/* Holds the state of one thread. */
typedef struct {
    const batch_job *job;
    batch_room *room;
    hf_built_net net[HF_LANES]; /* nets of the lanes; without lanes only the first is used */
} batch_work;

/* Makes sample i in the arrays of one lane. It starts with the nominal values, which the caller's function then
 * changes. */
static void make_sample(batch_work *work, int lane, int i)
{
    const batch_job *j = work->job;
    const hf_built *b = j->batch->built;
    size_t n = (size_t)b->model.n_cable, n_coordinate = 3 * (size_t)b->model.n_node;
    bool has_EA = j->varies & HF_BUILT_VARIES_EA, has_supports = j->varies & HF_BUILT_VARIES_SUPPORTS;
    bool has_loads = j->varies & HF_BUILT_VARIES_LOADS;
    double *cut_m = work->room->cut_m + (size_t)lane * n, *EA_N = work->room->EA_N + (size_t)lane * n;
    double *move_m = has_supports ? work->room->support_displacement_m + (size_t)lane * n_coordinate : NULL;
    double *load_N = has_loads ? work->room->load_N + (size_t)lane * n_coordinate : NULL;
    memcpy(cut_m, b->model.target, n * sizeof(double));
    memcpy(EA_N, b->model.EA_N, n * sizeof(double));
    if (has_supports) memset(move_m, 0, n_coordinate * sizeof(double));
    if (has_loads) memcpy(load_N, b->model.load_N, n_coordinate * sizeof(double));
    j->make(j->context, j->first + i, cut_m, has_EA ? EA_N : NULL, move_m, load_N);
    work->net[lane] = (hf_built_net){cut_m, EA_N, move_m, load_N};
}

/* Passes the shape of sample i, which the workspace holds, to the caller's function. */
static void give(const batch_work *work, int i, const hf_form_result *r)
{
    const batch_job *j = work->job;
    const hf_workspace *w = &work->room->work;
    hf_built_shape shape = {w->position_m, w->tension_N, w->loose, w->displacement_m};
    if (r->n_loose == 0) memset(w->loose, 0, (size_t)j->batch->built->model.n_node);
    j->take(j->context, j->first + i, &shape, r);
}

/* Solves one net by Newton's method from the nominal shape, or by the reference where that does not converge. */
static void find_net(const hf_built_batch *batch, const hf_built_net *net, hf_workspace *w, hf_form_result *r)
{
    if (!batch->has_lanes || !hf_near_find(&batch->near, net, w, r)) hf_built_solve(batch->built, net, w, r);
}

static void solve_alone(const batch_work *work, int lane, int i)
{
    hf_form_result r;
    find_net(work->job->batch, &work->net[lane], &work->room->work, &r);
    give(work, i, &r);
}

const hf_workspace *hf_built_batch_find(hf_built_batch *batch, const hf_built_net *net, hf_form_result *result)
{
    find_net(batch, net, &batch->room[0].work, result);
    return &batch->room[0].work;
}

/* ---- the run ---- */

/* Puts sample i into a lane. This function and the next three form the hf_lane_solver of work_on_job. */
static void load(void *solver, int lane, int i)
{
    batch_work *work = solver;
    make_sample(work, lane, i);
    hf_near_load(&work->job->batch->near, &work->room->near, lane, &work->net[lane]);
}

/* Measures the forces in all lanes. */
static void look(void *solver)
{
    batch_work *work = solver;
    hf_near_look(&work->job->batch->near, &work->room->near);
}

/* Returns whether the lane is free: its sample has converged, or has been solved by another method. */
static bool settle(void *solver, int lane, int i)
{
    batch_work *work = solver;
    batch_room *room = work->room;
    hf_form_result r;
    hf_near_verdict verdict =
        hf_near_settle(&work->job->batch->near, &room->near, lane, &work->net[lane], &room->work, &r);
    if (verdict == HF_NEAR_FOUND) give(work, i, &r);
    if (verdict == HF_NEAR_LOST) solve_alone(work, lane, i);
    return verdict != HF_NEAR_GOES_ON;
}

/* Takes a chord step in all lanes. */
static void step(void *solver)
{
    batch_work *work = solver;
    hf_near_step(&work->job->batch->near, &work->room->near);
}

/* Returns the next sample, or -1 when none is left or built->stop requests a stop. It is an hf_lane_next. */
static int take_next(void *context)
{
    batch_job *j = context;
    return hf_built_must_stop(j->batch->built) ? -1 : hf_parallel_take(&j->queue);
}

/* Does the work of one thread. It returns without any work when there is no memory for its room; the other threads then
 * take all samples. */
static void work_on_job(void *context, int i_room)
{
    static const hf_lane_solver in_lanes = {load, look, settle, step};
    batch_job *j = context;
    batch_work work = {.job = j, .room = &j->batch->room[i_room]};
    if (hf_parallel_is_empty(&j->queue) || make_room(j->batch, work.room) != HF_OK) return;
    work.room->work.stop = j->batch->built->stop;
    work.room->near.lanes.load_N = j->varies & HF_BUILT_VARIES_LOADS ? work.room->load_lanes_N : NULL;
    if (j->batch->has_lanes) {
        hf_lane_schedule_run(&in_lanes, &work, take_next, j);
        return;
    }
    for (int i = take_next(j); i >= 0; i = take_next(j)) {
        make_sample(&work, 0, i);
        solve_alone(&work, 0, i);
    }
}

void hf_built_batch_run(hf_built_batch *batch, unsigned varies, long first, long n, hf_built_sample *make,
                        hf_built_take *take, void *context)
{
    const long n_max = INT_MAX / 2; /* samples of one queue; its counter still rises when it is empty */
    for (; n > 0 && !hf_built_must_stop(batch->built); first += n_max, n -= n_max) {
        batch_job job = {batch, varies, first, {(int)(n < n_max ? n : n_max), 0, NULL}, make, take, context};
        if (batch->n_thread > 1)
            hf_parallel_run(batch->n_thread, work_on_job, &job);
        else
            work_on_job(&job, 0);
    }
}
