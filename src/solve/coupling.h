/* coupling - a net on an elastic truss (Fig. 17 of the paper, Eqs. 14, 15; METHOD section 8). The unknowns are the
 * displacements r of the attachments. The pull f(r) of the net and the condensed flexibility F of the truss give r = F
 * f(r).
 *
 * Schemes:
 *
 *   auto         If Newton's method solves the net: the accelerated loop while its steps halve in two rounds, then net
 *                and truss in one matrix, starting from the state of the loop. Otherwise the accelerated loop.
 *   plain        The paper's loop, r <- F f(r). With S the stiffness of the net at the attachments, an iteration
 *                multiplies the error by up to the maximum eigenvalue of F S, which may exceed 1.
 *   accelerated  Anderson's method (1965) on the same loop with a depth of HF_COUPLING_DEPTH. It needs no matrix of the
 *                net, so it works with every law and stopping rule.
 *
 * The answer of a convex net is unique, because it minimises Pi(x, r) + r' F^-1 r / 2, which is convex, too. schur.h
 * has the exact derivative of the coupled net.
 * Stability: internal; may change in any version. */
#pragma once

#include <hifdm/formfind.h>

/* Finds the shape of the net alone from the workspace's q_N_per_m, with supports displaced by displacement_m. Returns
 * result->status. */
typedef hf_status hf_net_solver(const void *context, hf_workspace *workspace, hf_history *history,
                                hf_form_result *result);

/* Finds the coupled shape, starting from the workspace's displacement_m. With start_counts every form-finding starts
 * from the force densities of the first one. The caller sets it if the answer of `solve` depends on them. history may
 * be NULL. The result is that of the last form-finding, with the iterations of all. The workspace ends with the
 * displacements that belong to its shape. Returns result->status:
 *
 *   HF_OK              the shape is coupled to within tof_m
 *   HF_TRUSS_TOO_SOFT  the loop diverges, or the net loses its shape after the first iteration
 *   HF_NOT_CONVERGED   max_iterations is reached, the steps stall, or a form-finding did not converge
 *   HF_INTERRUPTED     the workspace's stop was set
 *   other              the first form-finding finds no shape, with this status */
hf_status hf_coupling_find(const hf_model *model, const hf_coupling_settings *settings, hf_net_solver *solve,
                           const void *context, bool start_counts, hf_workspace *workspace, hf_history *history,
                           hf_form_result *result);

/* Finds the coupled shape by one call of `solve` (hf_equilibrium_find), with the attachments as unknowns (n_moving).
 * Returns result->status: that of the net, or HF_NOT_CONVERGED if |F f - r| of an attachment exceeds tof_m. It is
 * HF_TRUSS_TOO_SOFT if the net has no shape on its truss, but has one on fixed supports or fails there in another
 * way. */
hf_status hf_coupling_find_at_once(const hf_model *model, const hf_coupling_settings *settings, hf_net_solver *solve,
                                   const void *context, hf_workspace *workspace, hf_history *history,
                                   hf_form_result *result);

/* Calls hf_coupling_find and, if that fails, hf_coupling_find_at_once. With scheme auto the loop ends early if two
 * rounds do not halve its step. On a stiff truss it takes two or three rounds, and each costs less than the dense
 * matrix of the attachments. Returns result->status. */
hf_status hf_coupling_find_either_way(const hf_model *model, const hf_coupling_settings *settings, hf_net_solver *solve,
                                      const void *context, hf_workspace *workspace, hf_history *history,
                                      hf_form_result *result);

/* Sets attachment_force_N to the pull of the net on the attachments at the workspace's shape plus the loads on them,
 * N. */
void hf_coupling_forces(const hf_model *model, hf_workspace *workspace);

/* Sets step_m, |F f - r|, and max_displacement_m of result->coupling for the shape in the workspace, and
 * attachment_force_N. Returns the step, m. */
double hf_coupling_measure(const hf_model *model, hf_workspace *workspace, hf_form_result *result);

/* Sets result->coupling for a converged shape of the population solver, which knows its step, m, and its number of
 * passes. */
void hf_coupling_accept(const hf_model *model, const hf_workspace *workspace, int iterations, double step_m,
                        hf_form_result *result);
