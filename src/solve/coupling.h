/* coupling - a net on an elastic truss (Fig. 17 of the paper, Eqs. 14, 15; METHOD section 8). Unknown are the
 * displacements r of the attachments. The pull f(r) of the net and the condensed flexibility F of the truss give
 * r = F f(r).
 *
 * auto: where the net is solved by Newton's method, the accelerated loop as long as it comes near quickly, and else net
 * and truss in one matrix, from where the loop is.
 * plain: the paper's loop, r <- F f(r). With S the net's stiffness condensed to the attachments, every iteration
 * multiplies the error by up to the largest eigenvalue of F S, which may be more than 1.
 * accelerated: Anderson's method (1965) on the same loop, with a depth of HF_COUPLING_DEPTH. It needs no matrix of the
 * net and so works with every law and stopping rule.
 * For a convex net the answer is unique: it minimises Pi(x, r) + r' F^-1 r / 2, which is convex, too.
 * schur.h has the exact derivative of the coupled net.
 * Stability: internal; may change in any version. */
#ifndef HIFDM_COUPLING_H
#define HIFDM_COUPLING_H

#include <hifdm/formfind.h>

/* A solver of the net: finds its shape from the workspace's q_N_per_m, with supports moved by displacement_m. */
typedef hf_status hf_net_solver(const void *context, hf_workspace *workspace, hf_history *history,
                                hf_form_result *result);

/* Find the coupled shape, starting from the workspace's displacement_m. With `start_counts` every form-finding starts
 * from the force densities of the first one; the caller sets it when the answer of `solve` depends on them. The result
 * is that of the last form-finding, with the iterations of all. Status: HF_TRUSS_TOO_SOFT when the loop diverges or the
 * net has no shape at the moved supports; HF_NOT_CONVERGED after max_iterations or when a form-finding has not
 * converged; HF_INTERRUPTED. The workspace ends with the displacements that belong to its shape. Returns
 * result->status. */
hf_status hf_coupling_find(const hf_model *model, const hf_coupling_settings *settings, hf_net_solver *solve,
                           const void *context, bool start_counts, hf_workspace *workspace, hf_history *history,
                           hf_form_result *result);

/* Find the coupled shape by one call of `solve` (hf_equilibrium_find), for which the attachments are unknowns
 * (n_moving). Status: that of the net, or HF_TRUSS_TOO_SOFT when the net has no shape on its truss, and on fixed
 * supports has one or fails in another way. */
hf_status hf_coupling_find_at_once(const hf_model *model, const hf_coupling_settings *settings, hf_net_solver *solve,
                                   const void *context, hf_workspace *workspace, hf_history *history,
                                   hf_form_result *result);

/* hf_coupling_find; if that does not end well, hf_coupling_find_at_once. With scheme auto the loop ends early: when two
 * rounds do not halve its step. On a stiff truss it takes two or three rounds, each of which costs less than the dense
 * matrix of the attachments. */
hf_status hf_coupling_find_either_way(const hf_model *model, const hf_coupling_settings *settings, hf_net_solver *solve,
                                      const void *context, hf_workspace *workspace, hf_history *history,
                                      hf_form_result *result);

/* Set attachment_force_N to the pull of the net on the attachments at the workspace's shape plus the loads on them. */
void hf_coupling_forces(const hf_model *model, hf_workspace *workspace);

/* Set step |F f - r| and largest displacement of result->coupling for the shape in the workspace, and
 * attachment_force_N. Returns the step, m. */
double hf_coupling_measure(const hf_model *model, hf_workspace *workspace, hf_form_result *result);

/* Set result->coupling for a shape of the population solver, which knows the step and the number of its passes. */
void hf_coupling_accept(const hf_model *model, const hf_workspace *workspace, int iterations, double step_m,
                        hf_form_result *result);

#endif
