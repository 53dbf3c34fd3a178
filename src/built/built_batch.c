/* Contents: what one thread works with - the batch - one sample - the run */
#include <hifdm/built_batch.h>

#include "base/arena.h"
#include "linalg/band.h"
#include "search/parallel.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* ---- what one thread works with ---- */

typedef struct {
    hf_workspace work;
    double *cut_m, *EA_N, *support_move_m; /* of the sample */
    void *block;
} batch_room;

struct hf_built_batch {
    const hf_built *built;
    int n_thread;
    batch_room *room; /* [n_thread] each is made by the first thread that needs it; the first one with the batch */
};

static void lay_out_room(hf_arena *arena, const hf_model *m, batch_room *room)
{
    room->cut_m = hf_arena_take(arena, (size_t)m->n_cable, sizeof(double));
    room->EA_N = hf_arena_take(arena, (size_t)m->n_cable, sizeof(double));
    room->support_move_m = hf_arena_take(arena, 3 * (size_t)m->n_node, sizeof(double));
}

/* Returns HF_OK, also when the room has been made before, or HF_NO_MEMORY. Only one thread at a time has the number of
 * a room, so nothing is locked. */
static hf_status make_room(const hf_built *b, batch_room *room)
{
    hf_arena arena = {0};
    if (room->block) return HF_OK;
    if (!room->work.block && hf_workspace_create(&b->model, &room->work) != HF_OK) return HF_NO_MEMORY;
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out_room(&arena, &b->model, room)));
    room->block = arena.block;
    return HF_OK;
}

/* ---- the batch ---- */

static void lay_out(hf_arena *arena, int n_thread, hf_built_batch **batch, batch_room **room)
{
    *batch = hf_arena_take(arena, 1, sizeof **batch);
    *room = hf_arena_take(arena, (size_t)n_thread, sizeof **room);
}

hf_status hf_built_batch_create(const hf_built *built, int n_thread, hf_built_batch **batch)
{
    hf_arena arena = {0};
    batch_room *room = NULL;
    if (n_thread <= 0) n_thread = hf_parallel_cores();
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, n_thread, batch, &room)));
    **batch = (hf_built_batch){built, n_thread, room};
    hf_band_single_threaded();
    if (make_room(built, &room[0]) == HF_OK) return HF_OK;
    hf_built_batch_free(*batch);
    *batch = NULL;
    return HF_NO_MEMORY;
}

void hf_built_batch_free(hf_built_batch *batch)
{
    hf_arena arena = {.block = (unsigned char *)batch}; /* the batch is the first thing in its block */
    if (!batch) return;
    for (int i = 0; i < batch->n_thread; i++) {
        hf_arena own = {.block = batch->room[i].block};
        hf_workspace_free(&batch->room[i].work);
        hf_arena_free(&own);
    }
    hf_arena_free(&arena);
}

int hf_built_batch_threads(const hf_built_batch *batch)
{
    return batch->n_thread;
}

/* ---- one sample ---- */

/* The samples of one call, shared by all its threads. */
typedef struct {
    hf_built_batch *batch;
    unsigned varies;
    long first;
    hf_parallel_queue queue;
    hf_built_sample *make;
    hf_built_take *take;
    void *context;
} batch_job;

static hf_built_net make_sample(const batch_job *j, const batch_room *room, long i)
{
    const hf_built *b = j->batch->built;
    size_t bytes = (size_t)b->scene.n_cable * sizeof(double);
    bool has_EA = j->varies & HF_BUILT_VARIES_EA, has_supports = j->varies & HF_BUILT_VARIES_SUPPORTS;
    hf_built_net net = {room->cut_m, has_EA ? room->EA_N : NULL, has_supports ? room->support_move_m : NULL, NULL};
    memcpy(room->cut_m, b->model.target, bytes);
    if (has_EA) memcpy(room->EA_N, b->model.EA_N, bytes);
    if (has_supports) memset(room->support_move_m, 0, 3 * (size_t)b->model.n_node * sizeof(double));
    j->make(j->context, i, room->cut_m, has_EA ? room->EA_N : NULL, has_supports ? room->support_move_m : NULL);
    return net;
}

static void solve_alone(const batch_job *j, batch_room *room, int place, long i)
{
    const hf_built *b = j->batch->built;
    hf_workspace *w = &room->work;
    hf_form_result r;
    hf_built_net net = make_sample(j, room, i);
    hf_built_solve(b, &net, w, &r);
    if (r.n_loose == 0) memset(w->loose, 0, (size_t)b->model.n_node);
    hf_built_shape shape = {w->position_m, w->tension_N, w->loose};
    j->take(j->context, i, place, &shape, &r);
}

/* ---- the run ---- */

/* The work of one thread. When there is no memory for its room, it returns and the other threads do its work. */
static void work_on_job(void *context, int place)
{
    batch_job *j = context;
    batch_room *room = &j->batch->room[place];
    if (hf_parallel_is_empty(&j->queue) || make_room(j->batch->built, room) != HF_OK) return;
    for (int i = hf_parallel_take(&j->queue); i >= 0; i = hf_parallel_take(&j->queue))
        solve_alone(j, room, place, j->first + i);
}

void hf_built_batch_run(hf_built_batch *batch, unsigned varies, long first, long n, hf_built_sample *make,
                        hf_built_take *take, void *context)
{
    const long most = INT_MAX / 2; /* in one queue, which goes on counting when it is empty */
    for (; n > 0; first += most, n -= most) {
        batch_job job = {batch, varies, first, {(int)(n < most ? n : most), 0, NULL}, make, take, context};
        hf_parallel_run(batch->n_thread, work_on_job, &job);
    }
}
