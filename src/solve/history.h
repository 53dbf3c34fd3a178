/* history - records the figures of each iteration and step of a form-finding (hf_history).
 * Stability: internal; may change in any version. */
#pragma once

#include <hifdm/workspace.h>

/* Adds a row for the shape and the tension_N in the workspace. Does nothing if the history is full. */
void hf_history_add(hf_history *history, const hf_model *model, const hf_workspace *workspace, double psi_m,
                    double residual_N, double length_error);

/* Adds a row to the workspace's history, if it has one, for a step of Newton's method or of the path to position_m. If
 * the attachments are unknowns, adds a row to the history of the coupling as well; gap_m is that of hf_joint_gap_m.
 * tension_N must hold the tensions of the cables with a multiplier, N; those of the others are set. */
void hf_history_add_step(const hf_model *model, hf_workspace *workspace, double residual_N, double length_error,
                         double gap_m);

/* Adds a row to the history of the coupling. history may be NULL. */
void hf_history_add_coupling(hf_history *history, double step_m, double psi_m, double max_displacement_m);
