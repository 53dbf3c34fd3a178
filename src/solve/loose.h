/* loose - free nodes without load that no taut cable holds (METHOD section 4): which they are, and the place that they
 * are given.
 * Stability: internal; may change in any version. */
#ifndef HIFDM_LOOSE_H
#define HIFDM_LOOSE_H

#include <hifdm/formfind.h>

/* For an equilibrium (status OK, stopped by residual) that is the final one: mark its loose nodes in workspace->loose
 * and move them to where no cable of theirs is too long, as near to their theoretical places as that allows; their
 * cables have no force, and all other nodes stay. Then the result is measured again, n_loose is set, and psi leaves
 * them out. NOT_CONVERGED when there is no such place within the tolerance. Does nothing without such nodes. */
void hf_loose_settle(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                     hf_form_result *result);

/* For a design: one with loose nodes is SINGULAR, and the first of them is the culprit. */
void hf_loose_refuse(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                     hf_form_result *result);

/* Stiffness that stands in for the missing one of loose rows in a matrix, N/m. */
double hf_loose_spring_N_per_m(const hf_model *model);

#endif
