/* metrics - the quality of a shape: psi, tension ratios, slack. All read the shape that a workspace holds. */
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

/* Largest over smallest tension of a group (hf_group). NaN when the group is empty or a tension is not positive. */
double hf_metrics_tension_ratio(const hf_model *model, const hf_workspace *workspace, int group);

/* One cable: 1 or 0; all of them: how many. */
int hf_metrics_is_slack(const hf_model *model, const hf_workspace *workspace, int i_cable);
int hf_metrics_slack_count(const hf_model *model, const hf_workspace *workspace);

#ifdef __cplusplus
}
#endif
#endif
