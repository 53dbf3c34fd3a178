/* metrics - the quality of a shape: psi, tension ratios and slack cables (METHOD section 9).
 * Stability: stable.
 *
 * All functions read the positions, the tensions and the loose nodes of the shape in the workspace. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/workspace.h>

HF_API_BEGIN

/* A cable is slack if its tension is below HF_SLACK_RATIO times the reference tension. */
#define HF_SLACK_RATIO 1e-3

/* Returns the RMS distance psi, in m, of the inner nodes from their target positions (Eqs. 9, 10). Loose nodes are not
 * included. If all inner nodes are loose, psi is NaN. */
double hf_metrics_psi_m(const hf_model *model, const hf_workspace *workspace);
/* Returns psi of the positions position_m [3][n_node] by row. loose [n_node]: nodes to leave out, or NULL for none. */
double hf_metrics_psi_of_m(const hf_model *model, const double *position_m, const unsigned char *loose);

/* Returns the ratio of the maximum to the minimum tension in a group of cables. Returns NaN if the group is empty or
 * contains a strut. If the group has a slack cable but no strut, the function returns INFINITY because the tension of a
 * slack cable is only rounding. */
double hf_metrics_tension_ratio(const hf_model *model, const hf_workspace *workspace, hf_group group);

/* Returns the tension ratio of the n cables in the array `cable`, computed as in hf_metrics_tension_ratio. */
double hf_metrics_set_ratio(const hf_model *model, const hf_workspace *workspace, int n, const int *cable);

/* Returns true if cable i_cable is slack. */
bool hf_metrics_is_slack(const hf_model *model, const hf_workspace *workspace, int i_cable);
/* Returns the number of slack cables. */
int hf_metrics_slack_count(const hf_model *model, const hf_workspace *workspace);

HF_API_END
