/* Distributes designs to the lanes of one thread. lane_schedule.h describes the interface.
 *
 *     load designs into free lanes -> look at all lanes -> settle: store results, free lanes -> step -> load ...
 *
 * The loop ends when `next` returns -1 and all lanes are free. */
#include "search/lane_schedule.h"

#include "base/lane.h"

void hf_lane_schedule_run(const hf_lane_solver *work, void *solver, hf_lane_next *next, void *context)
{
    int design[HF_LANES], n_busy = 0; /* design[lane]: index, or -1 if the lane is free */
    bool has_more = true;
    int i = next(context); /* design that waits for a lane, or -1 */
    if (i < 0) return;
    /* Load the first design into all lanes, because the kernels also compute in free lanes. Other designs must not be
     * read: another thread may be writing them. */
    for (int lane = 0; lane < HF_LANES; lane++) {
        work->load(solver, lane, i);
        design[lane] = -1;
    }
    for (;;) {
        for (int lane = 0; lane < HF_LANES && has_more; lane++) {
            if (design[lane] >= 0) continue;
            if (i < 0) i = next(context);
            has_more = i >= 0;
            if (!has_more) break;
            work->load(solver, lane, i);
            design[lane] = i;
            i = -1;
            n_busy++;
        }
        if (n_busy == 0) return;
        work->look(solver);
        for (int lane = 0; lane < HF_LANES; lane++) {
            if (design[lane] < 0 || !work->settle(solver, lane, design[lane])) continue;
            design[lane] = -1;
            n_busy--;
        }
        if (n_busy == 0 && !has_more) return;
        work->step(solver);
    }
}
