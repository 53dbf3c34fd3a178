/* lane_schedule - distributes designs to the SIMD lanes of one thread. A lane that has finished takes the next design,
 * until no design is left. The solvers chord and swarm supply the work on a lane. */
#pragma once

#include <stdbool.h>

/* Returns the index of the next design, or -1 when no design is left. */
typedef int hf_lane_next(void *context);

/* The work of a solver. `solver` points to the solver's own struct. */
typedef struct {
    void (*load)(void *solver, int lane, int i_design);   /* begins with a design in a lane */
    void (*look)(void *solver);                           /* measures the shapes of all lanes */
    bool (*settle)(void *solver, int lane, int i_design); /* stores a final result and returns true: the lane is free */
    void (*step)(void *solver);                           /* advances all lanes by one iteration */
} hf_lane_solver;

/* Solves every design whose index next(context) returns. The kernels compute in all lanes and need ordinary numbers
 * there. Free lanes therefore hold a copy of the first design until they get one of their own. Their results are not
 * stored. Designs that `next` has not returned are not read, because other threads may be writing them. */
void hf_lane_schedule_run(const hf_lane_solver *work, void *solver, hf_lane_next *next, void *context);
