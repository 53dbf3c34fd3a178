/* coupling - the net and the elastic truss that it stands on (Fig. 17, Eqs. 14, 15): unknown displacements r of the
 * attachments, which the pull f of the net sets by the condensed flexibility, r = F f(r).
 *
 * plain: the paper's loop, r <- F f(r). With S the net's stiffness condensed to the attachments its error shrinks by
 * the largest eigenvalue of F S each time, or grows. accelerated: Anderson's method (1965) on the same loop, with a
 * depth of HF_COUPLING_DEPTH; it needs no matrix of the net, so it serves every law and stopping rule. For a convex net
 * f = F^-1 r is where Pi(x, r) + r' F^-1 r / 2 is least, which is convex, too: there is one answer.
 * schur.h has the exact derivative of the coupled net.
 * Stability: internal; may change in any version. */
#ifndef HIFDM_COUPLING_H
#define HIFDM_COUPLING_H

#include <hifdm/formfind.h>

/* Find the shape of the net from the workspace's q_N_per_m, with supports moved by its displacement_m. */
typedef hf_status hf_net_solver(const void *context, hf_workspace *workspace, hf_history *history,
                                hf_form_result *result);

/* The coupled shape, starting from the workspace's displacement_m. `start_counts`: each form-finding starts from the
 * force densities of the first one, because its answer depends on them. result: of the last form-finding, iterations of
 * all; HF_TRUSS_TOO_SOFT when the loop diverges or the moved supports leave the net without a shape, HF_NOT_CONVERGED
 * after max_iterations or when the net itself is, HF_INTERRUPTED. The displacements stay in the workspace and belong to
 * its shape. Returns result->status. */
hf_status hf_coupling_find(const hf_model *model, const hf_coupling_settings *settings, hf_net_solver *solve,
                           const void *context, bool start_counts, hf_workspace *workspace, hf_history *history,
                           hf_form_result *result);

/* Pull of the net on the attachments at the workspace's shape, and the loads that stand there, into
 * attachment_force_N. */
void hf_coupling_forces(const hf_model *model, hf_workspace *workspace);

/* Sets result->coupling for the shape in the workspace: forces, step |F f - r|, largest displacement. Returns the
 * step, m. */
double hf_coupling_measure(const hf_model *model, hf_workspace *workspace, hf_form_result *result);

/* The same where the step is known: a shape of the population solver, after so many passes. */
void hf_coupling_accept(const hf_model *model, const hf_workspace *workspace, int iterations, double step_m,
                        hf_form_result *result);

/* position_error_m of the coupled shape: the Newton step of net and truss together. newton_band holds the factor that
 * hf_newton_certify left. */
void hf_coupling_certify(const hf_model *model, hf_workspace *workspace, hf_form_result *result);

#endif
