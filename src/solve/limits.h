/* limits - the limits that a design must obey: the cap on the boundary tension ratio and the rows of optimize.limits. A
 * design whose shape breaks one is infeasible. Its violation is a sum over all limits, and infeasible designs are
 * ranked by it. */
#pragma once

#include <hifdm/evaluate.h>

/* Creates the limits of a case. Returns HF_OK; HF_BAD_CASE for a set that does not exist or is empty, or for
 * displacements without a truss; HF_NO_MEMORY. The caller frees their block in any case. */
hf_status hf_limits_create(const hf_scene *scene, const hf_model *model, const hf_optimize_settings *settings,
                           hf_limits *limits, hf_messages *messages);

/* Returns the violation of the shape in the workspace: the sum over the rows, and over the cap on the boundary ratio.
 * It is 0 if the shape obeys all limits. */
double hf_limits_violation(const hf_evaluator *evaluator, const hf_workspace *workspace);

/* Returns by how much a tension is outside of its bounds, relative to the reference tension, as violations count it. */
double hf_limits_tension_violation(const hf_model *model, double tension_N, double lower, double upper);

/* One side of a row that a shape reaches or exceeds. */
typedef struct {
    int row;             /* row of optimize.limits; HF_LIMITS_CAP: boundary_ratio_cap */
    int n;               /* number of cables or attachments there; 1 of a ratio */
    int cable, other;    /* cable with the maximum excess; of a ratio those of maximum and minimum tension; else -1 */
    int attachment;      /* attachment with the maximum excess; else -1 */
    double value, bound; /* value of that cable or attachment, and its bound */
    double beyond;       /* value beyond the bound, relative to it; up to HF_LIMITS_AT it is only reached */
} hf_limit_held;

#define HF_LIMITS_CAP (-1)
#define HF_LIMITS_AT 1e-8                           /* a value within this part of its bound has reached it */
#define HF_LIMITS_HELD (2 * HF_DESIGN_ROWS_MAX + 1) /* maximum number of sides */

/* Lists the sides that the shape in the workspace reaches or exceeds, the cap first, then in the order of the rows.
 * Returns their number. */
int hf_limits_held(const hf_evaluator *evaluator, const hf_workspace *workspace, hf_limit_held held[HF_LIMITS_HELD]);

/* Writes what a limit is about: "tension of cable c7", "ratio of cable c7 to c9", "displacement of node n12". Returns
 * text. */
const char *hf_limits_name(const hf_scene *scene, const hf_model *model, const hf_limit_held *held, char *text,
                           size_t size);

/* Writes which limit the shape in the workspace exceeds most: ": tension of cable c7 is 12 beside 10 of
 * optimize.limits.0". Writes "" if it breaks none. Returns text. */
const char *hf_limits_name_broken(const hf_evaluator *evaluator, const hf_scene *scene, const hf_workspace *workspace,
                                  char *text, size_t size);
