/* formfind - finds shape, tensions and residual from force densities. The iteration ends when the cables obey their
 * laws.
 * Stability: stable.
 *
 * The laws of the cables determine the method (METHOD sections 1 and 2). The method is classical FDM (Eqs. 1-6),
 * iterative FDM (Eq. 7) or HIFDM (Eqs. 7 and 8). Pipeline of one iteration:
 *
 *   hf_form_assemble         force densities -> matrix D (Eq. 2)
 *   hf_form_assemble_loads   loads and supports -> right-hand sides (Eq. 5)
 *   band solver              D x = right-hand sides, for x, y and z -> positions
 *   hf_form_measure_cables   positions -> lengths, tensions (Eqs. 4, 6), deviations from the laws
 *   hf_form_residual_N       tensions -> maximum residual force of a node
 *   hf_form_update           Eqs. 7 and 8 -> next force densities, unless the stopping rule is satisfied */
#pragma once

#include <hifdm/api.h>
#include <hifdm/result.h>
#include <hifdm/settings.h>
#include <hifdm/workspace.h>

HF_API_BEGIN

/* Prepares the workspace for the case of the model. Copies laws, target values, EA and first force densities to the
 * workspace. Sets displacement_m, support_displacement_m and loose to zero, and n_moving to n_free. */
void hf_form_prepare(const hf_model *model, hf_workspace *workspace);

/* Writes the initial positions of a solve to position_m. The initial positions are the target positions. The positions
 * of supports that a design moves include support_displacement_m. The positions of attachments include
 * displacement_m. */
void hf_form_set_supports(const hf_model *model, hf_workspace *workspace);

/* Finds a shape by iteration. The iteration starts from the force densities q_N_per_m in the workspace. The workspace
 * also contains the laws and the target values. The member displacement_m of the workspace contains the displacements
 * of the attachments. The iteration ends when the rule `stop` is satisfied, after max_iterations, or when the net is
 * ill-posed. The function reads only the tolerances and bounds of `settings`. Unless `history` is NULL, the function
 * records the values of each iteration in `history`. The function does not allocate memory.
 *
 * Returns result->status. The status is HF_OK, HF_NOT_CONVERGED, or HF_INTERRUPTED if *workspace->stop was set. If the
 * net is ill-posed, the status is HF_SINGULAR, HF_COLLAPSED, HF_NOT_FINITE or HF_STRAIGHT_CHAIN. If the net is
 * ill-posed, result->culprit is the index of the row, cable or chain at fault. */
hf_status hf_form_find(const hf_model *model, const hf_form_settings *settings, hf_stop_rule stop,
                       hf_workspace *workspace, hf_history *history, hf_form_result *result);

/* Measures the shape in the workspace without solving a system. Sets result->iterations to 0. The function reads
 * position_m, law and target. For cables whose law is not tension, the function also reads q_N_per_m. The function sets
 * the lengths, tensions and residual, and all other values of the result. The stop reason is HF_STOPPED_CONVERGED if
 * residual and lengths are within their tolerances. If the residual or the lengths are not within their tolerances, the
 * status is HF_NOT_CONVERGED and the stop reason is HF_STOPPED_MAX_ITERATIONS. If a cable has collapsed, the status is
 * HF_COLLAPSED. Returns result->status. */
hf_status hf_form_measure(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                          hf_form_result *result);

/* Writes the force density matrix D (Eq. 2) for the force densities q_N_per_m to the band of the workspace. */
void hf_form_assemble(const hf_model *model, hf_workspace *workspace);

/* Returns the maximum residual force of a node in N, for the shape in the workspace. Writes the nodal forces to
 * force_N. For a cable of law tension, the function uses the target tension. For a cable of any other law, the tension
 * is the product of the force density q and the length l. For elastic cables, the member residual_N of a final result
 * uses the tension of the law. */
double hf_form_residual_N(const hf_model *model, hf_workspace *workspace);

/* The relative length of a cable is its length divided by its length at the target positions. A cable of law
 * force_density has collapsed if its relative length is below HF_FORM_GONE. A cable of law tension has collapsed if its
 * relative length is below collapse_ratio. If a relative length exceeds HF_FORM_BLOWN_UP, the matrix D is singular and
 * could be factored only because of rounding.
 *
 * The tests `solve` and `stress` pass with HF_FORM_GONE from 1e-15 to 1e-6 and with HF_FORM_BLOWN_UP from 1e6 to 1e12.
 * With HF_FORM_GONE = 1e-6, 3 fewer of the 1988 solves in these tests succeed than with the present value. With
 * HF_FORM_BLOWN_UP = 1e6, 17 fewer solves succeed than with the present value. With HF_FORM_BLOWN_UP = 1e12, 6 more
 * solves succeed than with the present value. */
#define HF_FORM_GONE 1e-12
#define HF_FORM_BLOWN_UP 1e9

/* Completes a shape that another solver has found, in the same way as hf_form_find after its last iteration. The
 * workspace must contain the laws, the target values, the force densities q_N_per_m, and the positions that follow from
 * these force densities. The function copies `reason` and `iterations` to the result. The function measures the shape
 * and searches for loaded straight chains. Returns result->status. */
hf_status hf_form_accept(const hf_model *model, const hf_form_settings *settings, hf_stop_reason reason, int iterations,
                         hf_workspace *workspace, hf_form_result *result);

/* Sets the result of a design without a shape. Sets result->status to `status`, all REAL members to NaN, the culprit to
 * -1, and the stop reason to HF_STOPPED_ILL_POSED. */
void hf_form_refuse(hf_status status, int iterations, hf_form_result *result);

/* Writes the right-hand sides (Eq. 5) to the rows of position_m that belong to free nodes. The other rows contain the
 * positions of the supports.
 *
 * The function hf_form_assemble_loads and the next two functions are for timing and for programs with their own linear
 * solver. Call hf_form_assemble_loads, hf_form_measure_cables and hf_form_update in the order of the pipeline at the
 * head of this file. For each of x, y and z, the caller solves the linear system with the matrix `band`. The solution
 * replaces the right-hand sides in the rows of position_m that belong to free nodes. */
void hf_form_assemble_loads(const hf_model *model, hf_workspace *workspace);
/* Uses the positions to compute the lengths and tensions of the cables and their deviations from the laws. Before the
 * call, result->status must be HF_OK. If the positions are not a valid shape, the function sets the status to
 * HF_NOT_FINITE, HF_COLLAPSED or HF_SINGULAR. The function sets *length_gap to the length error for the stopping
 * rule. */
void hf_form_measure_cables(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                            hf_form_result *result, double *length_gap);
/* Computes the next force densities from lengths and tensions with Eqs. 7 and 8. */
void hf_form_update(const hf_model *model, hf_workspace *workspace);

/* Returns the number of chains of the model that can be straight in a shape. If the net is on a truss, any chain can
 * become straight because its supports move. */
int hf_form_n_chain(const hf_model *model);

/* Returns true if chain i_chain is straight in the shape of the workspace and carries a lateral load. Also returns true
 * if the chain is too short for its supports. The function overwrites force_N. */
bool hf_form_chain_is_loaded(const hf_model *model, hf_workspace *workspace, int i_chain);

/* Returns true if all cables of chain i_chain have law length and the chain is too short for its supports. The function
 * sets *sum_m to the sum of the cable lengths in m. The function sets *span_m to the present distance between the
 * supports in m. */
bool hf_form_chain_is_short(const hf_model *model, const hf_workspace *workspace, int i_chain, double *sum_m,
                            double *span_m);

HF_API_END
