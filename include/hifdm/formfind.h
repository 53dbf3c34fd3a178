/* formfind - from force densities to shape, tensions and residual by classical FDM (Eqs. 1-6), iterative FDM (Eq. 7)
 * or HIFDM (Eqs. 7 and 8). One iteration does all three; the laws of the cables decide which one it is (METHOD sections
 * 1 and 2).
 * Stability: stable. */
#ifndef HIFDM_FORMFIND_H
#define HIFDM_FORMFIND_H

#include <hifdm/api.h>
#include <hifdm/result.h>
#include <hifdm/settings.h>
#include <hifdm/workspace.h>

HF_API_BEGIN

/* Copy laws, targets and first force densities from the model into the workspace, set displacement_m to zero, and
 * n_moving to n_free. */
void hf_form_prepare(const hf_model *model, hf_workspace *workspace);

/* Copy the theoretical positions into position_m, and add displacement_m to the attachments. */
void hf_form_place_supports(const hf_model *model, hf_workspace *workspace);

/* Iterate from the workspace's q_N_per_m under its law and target, with the attachments moved by displacement_m, until
 * the rule `stop` or a bound is met. Only the tolerances and bounds of `settings` are read. history may be NULL.
 * Returns result->status. Does not allocate. */
hf_status hf_form_find(const hf_model *model, const hf_form_settings *settings, hf_stop_rule stop,
                       hf_workspace *workspace, hf_history *history, hf_form_result *result);

/* Measure the shape that the workspace holds (position_m, law, target; q_N_per_m for cables under law length or
 * elastic): lengths, tensions by law, residual, all measures of the result. No system is solved: iterations is 0. The
 * stopping reason is RESIDUAL when the residual is within the tolerance; otherwise the status is HF_NOT_CONVERGED.
 * Returns result->status. */
hf_status hf_form_measure(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                          hf_form_result *result);

/* Assemble the force density matrix D of q_N_per_m (Eq. 2) into the workspace's band. */
void hf_form_assemble(const hf_model *model, hf_workspace *workspace);

/* Largest nodal force out of balance at the workspace's shape, N, with the tensions q l of elastic cables. Leaves the
 * nodal forces in force_N. The residual_N of a result has these cables at the tension of their law. */
double hf_form_residual_N(const hf_model *model, hf_workspace *workspace);

/* A cable of law force_density has collapsed when it is shorter than HF_FORM_GONE times its theoretical length (for a
 * cable of law tension the bound is collapse_ratio). A cable longer than HF_FORM_BLOWN_UP times its theoretical length
 * shows that the matrix was singular and was factored only because of rounding. The tests of solve and stress pass with
 * HF_FORM_GONE from 1e-15 to 1e-6 and HF_FORM_BLOWN_UP from 1e6 to 1e12. Of their 1988 solves, three fewer end well
 * with 1e-6, 17 fewer with 1e6, and six more with 1e12. */
#define HF_FORM_GONE 1e-12
#define HF_FORM_BLOWN_UP 1e9

/* Do what hf_form_find does after its last iteration, for a shape that another solver has found: the workspace holds
 * law, target, and positions that are the solution for q_N_per_m. Measures the shape and looks for loaded straight
 * chains. Returns result->status. */
hf_status hf_form_accept(const hf_model *model, const hf_form_settings *settings, hf_stop_reason reason, int iterations,
                         hf_workspace *workspace, hf_form_result *result);

/* Set the result of a candidate without a shape: the given status (an ill-posed one), NaN measures, no culprit. */
void hf_form_refuse(hf_status status, int iterations, hf_form_result *result);

/* The other parts of an iteration of hf_form_find, for programs with their own linear solver and for timing. Order:
 *   1. hf_form_assemble.
 *   2. hf_form_assemble_loads writes the right-hand sides (Eq. 5) into the free rows of position_m; its other rows hold
 *      the supports.
 *   3. The caller solves band * x = those rows, for x, y and z.
 *   4. hf_form_measure_cables computes lengths, tensions and the errors against the laws. result->status must be HF_OK
 *      before; afterwards it says whether this is a shape. *length_gap is the length error for the stopping rule.
 *   5. hf_form_residual_N.
 *   6. hf_form_update applies Eqs. 7 and 8. */
void hf_form_assemble_loads(const hf_model *model, hf_workspace *workspace);
void hf_form_measure_cables(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                            hf_form_result *result, double *length_gap);
void hf_form_update(const hf_model *model, hf_workspace *workspace);

/* Number of chains of the model that can be straight in a shape. On a truss these are all chains, because their
 * supports move. */
int hf_form_n_chain(const hf_model *model);

/* True when chain i is straight and under lateral load, or too short, in the workspace's shape. For messages that name
 * it. */
bool hf_form_chain_is_loaded(const hf_model *model, hf_workspace *workspace, int i_chain);

/* True when the lengths of chain i, which add up to *sum_m, are too short for the distance *span_m of its supports. */
bool hf_form_chain_is_short(const hf_model *model, const hf_workspace *workspace, int i_chain, double *sum_m,
                            double *span_m);

HF_API_END
#endif
