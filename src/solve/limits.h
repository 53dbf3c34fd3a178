/* limits - what a design must keep: the cap on the boundary tension ratio and the rows of optimize.limits. A design
 * with a shape that breaks one is infeasible by so much: its violation, by which infeasible designs are ranked. */
#ifndef HIFDM_LIMITS_H
#define HIFDM_LIMITS_H

#include <hifdm/evaluate.h>

/* HF_OK; HF_BAD_CASE for a set that does not exist or is empty, or displacements without a truss; HF_NO_MEMORY. Without
 * rows there is nothing to free. */
hf_status hf_limits_create(const hf_scene *scene, const hf_model *model, const hf_optimize_settings *settings,
                           hf_limits *limits, hf_messages *messages);
void hf_limits_free(hf_limits *limits);

/* By how much the shape in the workspace is beyond the rows, in all; 0: it keeps them. */
double hf_limits_violation(const hf_limits *limits, const hf_model *model, const hf_workspace *workspace);

/* By how much the tensions of these cables would have to change for a ratio of at most `cap`, cable by cable: a smaller
 * sum is nearer to the cap also where several cables share the largest or the smallest tension, so that no single one
 * of them changes the ratio. slack_N: no tension counts as less. */
double hf_limits_ratio_violation(int n_cable, const int *cable, const double *tension_N, double cap, double slack_N);

#endif
