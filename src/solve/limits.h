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

/* By how much the shape in the workspace is beyond what the evaluator's designs must keep, in all: the rows, and the
 * cap on the boundary. 0: it keeps them. */
double hf_limits_violation(const hf_evaluator *evaluator, const hf_workspace *workspace);

/* How far a tension is outside of bounds, as violations count it. */
double hf_limits_tension_violation(const hf_model *model, double tension_N, double lower, double upper);

/* One side of a row that a shape is at, or beyond. */
typedef struct {
    int row;          /* of optimize.limits; HF_LIMITS_CAP: boundary_ratio_cap */
    int n;            /* cables or attachments that are there; of a ratio 1 */
    int cable, other; /* that which is farthest out; of a ratio those of the largest and the least tension; else -1 */
    int attachment;   /* the same; else -1 */
    double value, bound; /* of it */
    double beyond;       /* value beyond bound, over the bound; at most HF_LIMITS_AT where it is only at it */
} hf_limit_held;

#define HF_LIMITS_CAP (-1)
#define HF_LIMITS_AT 1e-8                           /* part of a bound from which on a value is at it */
#define HF_LIMITS_HELD (2 * HF_DESIGN_ROWS_MAX + 1) /* the most that there can be */

/* What the shape in the workspace is at, or beyond, in the order of the rows: returns their number. */
int hf_limits_held(const hf_evaluator *evaluator, const hf_workspace *workspace, hf_limit_held held[HF_LIMITS_HELD]);

/* Of what a limit is: "tension of cable c7", "ratio of cable c7 to c9", "displacement of node n12". Returns text. */
const char *hf_limits_name(const hf_scene *scene, const hf_model *model, const hf_limit_held *held, char *text,
                           size_t size);

/* Which limit the shape in the workspace breaks most: ": tension of cable c7 is 12 beside 10 of optimize.limits.0"; ""
 * where it breaks none. Returns text. */
const char *hf_limits_name_broken(const hf_evaluator *evaluator, const hf_scene *scene, const hf_workspace *workspace,
                                  char *text, size_t size);

/* By how much the tensions of these cables would have to change for a ratio of at most `cap`, cable by cable: a smaller
 * sum is nearer to the cap also where several cables share the largest or the smallest tension, so that no single one
 * of them changes the ratio. slack_N: no tension counts as less. */
double hf_limits_ratio_violation(int n_cable, const int *cable, const double *tension_N, double cap, double slack_N);

#endif
