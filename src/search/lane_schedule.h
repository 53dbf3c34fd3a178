/* lane_schedule - hands designs to the SIMD lanes of one thread: a lane that has finished takes the next design, until
 * none is left. chord and swarm say what is done with a lane. */
#ifndef HIFDM_LANE_SCHEDULE_H
#define HIFDM_LANE_SCHEDULE_H

#include <stdbool.h>

/* The index of the next design, or -1 when none is left. */
typedef int hf_lane_next(void *context);

/* What a solver does; `solver` is its own struct. */
typedef struct {
    void (*load)(void *solver, int lane, int i_design);   /* begin with a design in a lane */
    void (*look)(void *solver);                           /* measure the shapes of all lanes */
    bool (*settle)(void *solver, int lane, int i_design); /* store the result if it is final: is the lane free? */
    void (*step)(void *solver);                           /* all lanes one iteration on */
} hf_lane_solver;

/* Solve every design that next(context) hands out. All lanes are worked on from the start, with design 0 where there is
 * no other, because kernels need numbers that do no harm; lanes without a design are not settled. */
void hf_lane_schedule_run(const hf_lane_solver *work, void *solver, hf_lane_next *next, void *context);

#endif
