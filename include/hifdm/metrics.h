/* metrics - the quality of a shape: psi, tension ratios, slack (METHOD section 9). All functions read the shape in a
 * workspace.
 * Stability: stable. */
#ifndef HIFDM_METRICS_H
#define HIFDM_METRICS_H

#include <hifdm/api.h>
#include <hifdm/workspace.h>

HF_API_BEGIN

/* A cable is slack when its tension is below this fraction of the reference tension. */
#define HF_SLACK_RATIO 1e-3

/* RMS distance of the inner nodes to their theoretical positions, m (Eqs. 9, 10), loose nodes left out; NaN when all
 * are loose. */
double hf_metrics_psi_m(const hf_model *model, const hf_workspace *workspace);

/* Largest tension of a group divided by its smallest one. NaN when the group is empty or has a strut; else INFINITY
 * when a cable is slack: what is left of its tension, 0 or 1e-22 N, is rounding. */
double hf_metrics_tension_ratio(const hf_model *model, const hf_workspace *workspace, hf_group group);

/* The same of n cables. */
double hf_metrics_set_ratio(const hf_model *model, const hf_workspace *workspace, int n, const int *cable);

/* Whether cable i_cable is slack, and the number of slack cables. */
bool hf_metrics_is_slack(const hf_model *model, const hf_workspace *workspace, int i_cable);
int hf_metrics_slack_count(const hf_model *model, const hf_workspace *workspace);

HF_API_END
#endif
