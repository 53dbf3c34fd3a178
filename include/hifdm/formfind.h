/* formfind - finds shape, tensions and residual from force densities, and iterates them until the cables obey their
 * laws.
 * Stability: stable.
 *
 * The laws of the cables decide which method this is (METHOD sections 1 and 2): classical FDM (Eqs. 1-6), iterative FDM
 * (Eq. 7) or HIFDM (Eqs. 7 and 8). Pipeline of one iteration:
 *
 *   hf_form_assemble         force densities -> matrix D (Eq. 2)
 *   hf_form_assemble_loads   loads and supports -> right-hand sides (Eq. 5)
 *   band solver              D x = right-hand sides, for x, y and z -> positions
 *   hf_form_measure_cables   positions -> lengths, tensions (Eqs. 4, 6), errors against the laws
 *   hf_form_residual_N       tensions -> maximum nodal force out of balance
 *   hf_form_update           Eqs. 7 and 8 -> next force densities, unless the stopping rule holds */
#ifndef HIFDM_FORMFIND_H
#define HIFDM_FORMFIND_H

#include <hifdm/api.h>
#include <hifdm/result.h>
#include <hifdm/settings.h>
#include <hifdm/workspace.h>

HF_API_BEGIN

/* Prepares the workspace for the case of the model: copies laws, target values, EA and first force densities; sets
 * displacement_m, support_displacement_m and loose to zero, and n_moving to n_free. */
void hf_form_prepare(const hf_model *model, hf_workspace *workspace);

/* Writes the positions from which a solve starts into position_m: the target positions. Supports that a design moves
 * are displaced by support_displacement_m, attachments by displacement_m. */
void hf_form_set_supports(const hf_model *model, hf_workspace *workspace);

/* Finds a shape by iteration from the workspace's q_N_per_m under its laws and target values. The attachments are
 * displaced by displacement_m. The iteration ends when the rule `stop` holds, at max_iterations, or when the net is
 * ill-posed; only the tolerances and bounds of `settings` are read. The figures of each iteration are recorded in
 * `history` unless it is NULL. Does not allocate.
 *
 * Returns result->status: HF_OK, HF_NOT_CONVERGED, HF_INTERRUPTED (*workspace->stop was set), or HF_SINGULAR,
 * HF_COLLAPSED, HF_NOT_FINITE, HF_STRAIGHT_CHAIN with the cable, row or chain in result->culprit. */
hf_status hf_form_find(const hf_model *model, const hf_form_settings *settings, hf_stop_rule stop,
                       hf_workspace *workspace, hf_history *history, hf_form_result *result);

/* Measures the shape that the workspace holds, without solving a system; result->iterations is 0. It reads position_m,
 * law and target, and q_N_per_m except for cables of law tension. Sets lengths, tensions, residual and all other
 * figures of the result. The stop reason is HF_STOPPED_CONVERGED if residual and lengths are within their tolerances.
 * Otherwise the status is HF_NOT_CONVERGED, and the stop reason is HF_STOPPED_MAX_ITERATIONS. A shape with a collapsed
 * cable is HF_COLLAPSED. Returns result->status. */
hf_status hf_form_measure(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                          hf_form_result *result);

/* Writes the force density matrix D of q_N_per_m (Eq. 2) into the band of the workspace. */
void hf_form_assemble(const hf_model *model, hf_workspace *workspace);

/* Returns the maximum nodal force out of balance of the workspace's shape, N, and leaves the nodal forces in force_N. A
 * cable of law tension has its target tension; all others have q l. In a final result, residual_N has elastic cables at
 * the tension of their law instead. */
double hf_form_residual_N(const hf_model *model, hf_workspace *workspace);

/* Limits on the length of a cable, as a part of the length at the target positions. A cable of law force_density below
 * HF_FORM_GONE has collapsed; for law tension the limit is collapse_ratio. A cable above HF_FORM_BLOWN_UP shows that D
 * was singular and could be factored only because of rounding.
 *
 * The tests of solve and stress pass with HF_FORM_GONE from 1e-15 to 1e-6 and HF_FORM_BLOWN_UP from 1e6 to 1e12. Of
 * their 1988 solves, three fewer end well with 1e-6, 17 fewer with 1e6, and six more with 1e12. */
#define HF_FORM_GONE 1e-12
#define HF_FORM_BLOWN_UP 1e9

/* Completes a shape that another solver has found, as hf_form_find does after its last iteration. The workspace holds
 * laws, target values, and positions that are the solution for q_N_per_m. `reason` and `iterations` are copied into the
 * result. Measures the shape and looks for loaded straight chains. Returns result->status. */
hf_status hf_form_accept(const hf_model *model, const hf_form_settings *settings, hf_stop_reason reason, int iterations,
                         hf_workspace *workspace, hf_form_result *result);

/* Sets the result of a design without a shape: `status` is that of the fault, all real figures are NaN, the culprit
 * is -1, and the stop reason is HF_STOPPED_ILL_POSED. */
void hf_form_refuse(hf_status status, int iterations, hf_form_result *result);

/* Writes the right-hand sides (Eq. 5) into the free rows of position_m; the other rows hold the positions of the
 * supports.
 *
 * This function and the next two are for programs with their own linear solver and for timing. The order of an
 * iteration is that in the head of this file. The caller solves band * x = the free rows of position_m, in place, for
 * x, y and z. */
void hf_form_assemble_loads(const hf_model *model, hf_workspace *workspace);
/* Computes lengths, tensions and the errors against the laws from the positions. result->status must be HF_OK before.
 * It is HF_NOT_FINITE, HF_COLLAPSED or HF_SINGULAR afterwards if this is no shape. *length_gap is set to the length
 * error that the stopping rule reads. */
void hf_form_measure_cables(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                            hf_form_result *result, double *length_gap);
/* Computes the next force densities from lengths and tensions, by Eqs. 7 and 8. */
void hf_form_update(const hf_model *model, hf_workspace *workspace);

/* Returns the number of chains of the model that can be straight in a shape. On a truss these are all chains, because
 * their supports move. */
int hf_form_n_chain(const hf_model *model);

/* Returns true if chain i_chain is straight in the workspace's shape and carries a lateral load or is too short for its
 * supports. Overwrites force_N. */
bool hf_form_chain_is_loaded(const hf_model *model, hf_workspace *workspace, int i_chain);

/* Returns true if all cables of chain i_chain have law length and their lengths are too short for its supports. Sets
 * *sum_m to the sum of the lengths and *span_m to the present distance of the supports, both in m. */
bool hf_form_chain_is_short(const hf_model *model, const hf_workspace *workspace, int i_chain, double *sum_m,
                            double *span_m);

HF_API_END
#endif
