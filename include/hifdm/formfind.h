/* formfind - force densities -> shape, tensions, residual: classical FDM (Eqs. 1-6), iterative FDM (Eq. 7), HIFDM
 * (Eqs. 7 and 8). One iteration serves all three: the laws of the cables decide (METHOD sections 1 and 2).
 * Stability: stable. */
#ifndef HIFDM_FORMFIND_H
#define HIFDM_FORMFIND_H

#include <hifdm/result.h>
#include <hifdm/settings.h>
#include <hifdm/workspace.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Set laws, targets and first force densities of the workspace from the model; no support is displaced. */
void hf_form_prepare(const hf_model *model, hf_workspace *workspace);

/* Theoretical positions into position_m, but for the supports that displacement_m has moved. */
void hf_form_place_supports(const hf_model *model, hf_workspace *workspace);

/* Iterate from the workspace's q_N_per_m under its law and target, the attachments moved by displacement_m, until
 * `stop` or a bound holds. `settings` gives tolerances and bounds only. history may be NULL. Returns
 * result->status; never allocates. */
hf_status hf_form_find(const hf_model *model, const hf_form_settings *settings, hf_stop_rule stop,
                       hf_workspace *workspace, hf_history *history, hf_form_result *result);

/* Measure the shape that the workspace holds (position_m, law, target; q_N_per_m for cables under law length or
 * elastic): lengths, tensions by law, residual, all measures of the result. It solves nothing: iterations is 0, the
 * stopping reason is RESIDUAL when the residual is within the tolerance, else the status is HF_NOT_CONVERGED. Returns
 * result->status. */
hf_status hf_form_measure(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                          hf_form_result *result);

/* The force density matrix D of q_N_per_m (Eq. 2) into the workspace's band. */
void hf_form_assemble(const hf_model *model, hf_workspace *workspace);

/* Largest nodal force out of balance at the workspace's shape, N; leaves the nodal forces in force_N. */
double hf_form_residual_N(const hf_model *model, hf_workspace *workspace);

/* A cable of law force_density shorter than HF_FORM_GONE of its theoretical length has collapsed (one of law tension
 * has below collapse_ratio). A cable HF_FORM_BLOWN_UP times longer than that is what rounding leaves of a singular
 * matrix. */
#define HF_FORM_GONE 1e-12
#define HF_FORM_BLOWN_UP 1e9

/* The end of hf_form_find for an iteration done elsewhere: the workspace holds law, target, and positions that are the
 * solution for q_N_per_m. Measures them and judges the chains. Returns result->status. */
hf_status hf_form_accept(const hf_model *model, const hf_form_settings *settings, hf_stop_reason reason, int iterations,
                         hf_workspace *workspace, hf_form_result *result);

/* The result of a candidate without a shape: the status (an ill-posed one), NaN measures, no culprit. */
void hf_form_refuse(hf_status status, int iterations, hf_form_result *result);

/* The other parts of an iteration of hf_form_find, for programs with their own linear solver and for timing. In order:
 * hf_form_assemble; assemble_loads: the right-hand sides (Eq. 5) into the free rows of position_m, from the supports in
 * its other rows; solve band * x = those rows, for x, y and z; measure_cables: lengths, tensions and the errors against
 * the laws (result->status must be HF_OK before, and says afterwards whether this is a shape; *length_gap is the length
 * error that stopping looks at); hf_form_residual_N; update: Eqs. 7 and 8. */
void hf_form_assemble_loads(const hf_model *model, hf_workspace *workspace);
void hf_form_measure_cables(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                            hf_form_result *result, double *length_gap);
void hf_form_update(const hf_model *model, hf_workspace *workspace);

/* Chains of the model that can be straight in a shape: on a truss all of them, because their supports move. */
int hf_form_n_chain(const hf_model *model);

/* Is chain i straight and under lateral load in the workspace's shape? For messages that name it. */
bool hf_form_chain_is_loaded(const hf_model *model, hf_workspace *workspace, int i_chain);

#ifdef __cplusplus
}
#endif
#endif
