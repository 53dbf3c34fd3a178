/* descent - for a net with elastic cables: from any shape to near the minimum of its energy Pi (METHOD section 5).
 * Stability: internal; may change in any version.
 *
 * The tensions follow the lengths here, T = EA max(l/l0 - 1, 0), and those of stiff cables are far from any balance
 * until the shape is nearly right. Pi is convex, so Newton's direction with a line search on Pi itself converges where
 * a search on the forces would not. */
#ifndef HIFDM_DESCENT_H
#define HIFDM_DESCENT_H

#include <hifdm/workspace.h>

/* Descend from the workspace's position_m, and set tension_N and q_N_per_m by the laws; a cable under law length is a
 * stiff elastic one meanwhile. Returns the number of steps, at most max_steps. */
int hf_descent_run(const hf_model *model, hf_workspace *workspace, int max_steps);

#endif
