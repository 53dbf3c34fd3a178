/* chord - evaluates designs near one initial design by Newton steps that share one matrix. The matrix is factored once,
 * at the initial design, and read by all threads. Each triangular solve serves eight designs, one in each SIMD lane.
 *
 * A design has converged when its own nodal forces are below the tolerance. The shared matrix only affects how many
 * steps that takes. The kernels measure the final shape, too. If the shape has a fault, the scalar code of formfind
 * measures it again and identifies the fault. If the residual of a design does not fall fast enough, hf_evaluate solves
 * the design instead. No operation mixes lanes, so a result depends neither on the designs in the other lanes nor on
 * the thread. */
#ifndef HIFDM_CHORD_H
#define HIFDM_CHORD_H

#include "search/chord_kernel.h"
#include "search/lane_schedule.h"

/* Returns true if chord can solve the designs of this evaluator. Each design variable must set a tension or a force
 * density. All other cables must have a law of HF_CHORD_LAWS, except those between two fixed supports. The net must
 * have a Newton matrix (a convex energy), and form.factor must not be `lapack`. */
bool hf_chord_applies(const hf_evaluator *evaluator);

/* Evaluates the initial design [n_variable], factors its Newton matrix and packs it for the lanes. workspace is
 * scratch. Returns HF_OK, HF_NO_MEMORY, or another status if the initial design has no shape or no positive definite
 * matrix. Call hf_chord_free in any case. */
hf_status hf_chord_create(const hf_evaluator *evaluator, const double *initial, hf_workspace *workspace,
                          hf_chord *chord);

/* Makes the shared matrix at the shape that the workspace holds, whatever the laws of its cables. This serves nets
 * without design variables: the caller writes the force density of cable e into row n_variable + e of `variable` of the
 * lanes. Returns HF_OK, HF_NO_MEMORY or HF_SINGULAR. Call hf_chord_free in any case. */
hf_status hf_chord_create_here(const hf_evaluator *evaluator, hf_workspace *workspace, hf_chord *chord);
void hf_chord_free(hf_chord *chord);

/* Returns the size in bytes of the shared matrix for this evaluator. *lanes_bytes is set to the size of the lanes of
 * one thread. */
size_t hf_chord_bytes(const hf_evaluator *evaluator, size_t *lanes_bytes);

/* Allocates the lanes of one thread. Returns HF_OK or HF_NO_MEMORY; call hf_chord_lanes_free in either case. */
hf_status hf_chord_lanes_create(const hf_chord *chord, hf_chord_lanes *lanes);
void hf_chord_lanes_free(hf_chord_lanes *lanes);

/* Evaluates the designs whose indices next(context) returns, until it returns -1. design: [][n_variable]; result: [].
 * If keeps_shape is true, the workspace holds the last shape afterwards; otherwise it is scratch. */
void hf_chord_run(const hf_chord *chord, hf_chord_lanes *lanes, hf_workspace *workspace, hf_lane_next *next,
                  void *context, bool keeps_shape, const double *design, hf_form_result *result);

#endif
