/* loose - finds free nodes without load that no taut cable holds, and gives them positions (METHOD section 4).
 * Stability: internal; may change in any version. */
#pragma once

#include <hifdm/formfind.h>

/* Marks the loose nodes of a final equilibrium (status HF_OK, stopped by residual) in workspace->loose and moves them.
 * They come as near to their target positions as their cables allow without being too long. Their cables have no force,
 * and all other nodes stay. The result is then measured again and n_loose is set; psi leaves loose nodes out. The
 * status becomes HF_NOT_CONVERGED if there are no such positions within the tolerance. Does nothing without loose
 * nodes. */
void hf_loose_settle(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                     hf_form_result *result);

/* Refuses a design with loose nodes: the status becomes HF_SINGULAR, and the first of them is the culprit. */
void hf_loose_refuse(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                     hf_form_result *result);
