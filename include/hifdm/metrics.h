/* metrics - the quality of a shape: psi, tension ratios, slack (METHOD section 9). All read the shape that a workspace
 * holds.
 * Stability: stable. */
#ifndef HIFDM_METRICS_H
#define HIFDM_METRICS_H

#include <hifdm/workspace.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A cable whose tension is below this part of the reference tension is slack. */
#define HF_SLACK_RATIO 1e-3

/* RMS distance of the inner nodes to their theoretical positions, m (Eqs. 9, 10). */
double hf_metrics_psi_m(const hf_model *model, const hf_workspace *workspace);

/* Largest over smallest tension of a group. NaN when the group is empty or a tension is not positive. */
double hf_metrics_tension_ratio(const hf_model *model, const hf_workspace *workspace, hf_group group);

/* Is this cable slack? And how many cables are? */
bool hf_metrics_is_slack(const hf_model *model, const hf_workspace *workspace, int i_cable);
int hf_metrics_slack_count(const hf_model *model, const hf_workspace *workspace);

#ifdef __cplusplus
}
#endif
#endif
