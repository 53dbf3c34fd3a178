/* lane_schedule - hands designs to the SIMD lanes of one thread: a lane that has finished takes the next design, until
 * none is left. The solvers chord and swarm supply the work on a lane. */
#ifndef HIFDM_LANE_SCHEDULE_H
#define HIFDM_LANE_SCHEDULE_H

#include <stdbool.h>

/* The index of the next design, or -1 when none is left. */
typedef int hf_lane_next(void *context);

/* The work of a solver; `solver` points to its own struct. */
typedef struct {
    void (*load)(void *solver, int lane, int i_design);   /* begin with a design in a lane */
    void (*look)(void *solver);                           /* measure the shapes of all lanes */
    bool (*settle)(void *solver, int lane, int i_design); /* store a final result; true: the lane is free */
    void (*step)(void *solver);                           /* advance all lanes by one iteration */
} hf_lane_solver;

/* Solve every design whose index next(context) returns. A lane that has no design yet is loaded with the first of
 * them, because the kernels work on all lanes and need ordinary numbers there; it is not settled. Designs that `next`
 * has not returned are not looked at: other threads may be writing them. */
void hf_lane_schedule_run(const hf_lane_solver *work, void *solver, hf_lane_next *next, void *context);

#endif
