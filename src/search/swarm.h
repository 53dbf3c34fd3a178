/* swarm - runs the paper's iteration for many designs, eight at a time in the SIMD lanes of `lane`. It does what
 * hf_evaluate does with the solver fixed_point, about fifteen times faster. A lane that has finished takes the next
 * design. No operation mixes lanes, so a result depends neither on the designs in the other lanes nor on the thread. */
#ifndef HIFDM_SWARM_H
#define HIFDM_SWARM_H

#include "search/lane_schedule.h"
#include "search/swarm_lane.h"
#include <hifdm/evaluate.h>

/* Evaluates the designs whose indices next(context) returns, until it returns -1. design: [][n_variable]; result: [].
 * A design without a shape has its status in the result. If its lane fails and the model has no Newton matrix, the
 * result does not identify the cable or node at fault. */
void hf_swarm_run(const hf_evaluator *evaluator, const hf_swarm_plan *plan, hf_swarm_lanes *lanes,
                  hf_workspace *workspace, hf_lane_next *next, void *context, const double *design,
                  hf_form_result *result);

#endif
