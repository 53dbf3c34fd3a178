/* descent - moves a net with elastic cables from any shape to near the minimum of its energy Pi (METHOD section 5).
 * Stability: internal; may change in any version.
 *
 * The tensions follow from the lengths, T = EA max(l/l0 - 1, 0), so stiff cables are far out of balance until the shape
 * is nearly right. Pi is convex: Newton's direction with a line search on Pi converges where a line search on the
 * forces would not. */
#ifndef HIFDM_DESCENT_H
#define HIFDM_DESCENT_H

#include <hifdm/workspace.h>

/* Descend from the workspace's position_m, and set tension_N and q_N_per_m by the laws. Cables under law length are
 * treated as stiff elastic ones. Returns the number of steps, at most max_steps. */
int hf_descent_run(const hf_model *model, hf_workspace *workspace, int max_steps);

#endif
