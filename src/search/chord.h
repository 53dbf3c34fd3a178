/* chord - evaluates designs near one base design by Newton steps with one matrix. The matrix is factored once, at the
 * base design, and shared read-only by all threads; each triangular solve serves eight designs, one in each SIMD lane.
 *
 * A design has converged when its own nodal forces vanish; the shared matrix only affects how many steps that takes.
 * The kernels measure the final shape, too; one with a fault goes to the scalar code of formfind, which names it. A
 * design whose residual does not fall fast enough is evaluated by hf_evaluate instead. No operation mixes lanes, so a
 * result depends neither on the designs in the other lanes nor on the thread. */
#ifndef HIFDM_CHORD_H
#define HIFDM_CHORD_H

#include "search/chord_kernel.h"
#include "search/lane_schedule.h"

/* Can designs of this evaluator be solved in this way? The energy must be convex, and no cable may have the law length
 * once the rule has replaced the laws of the genes. */
bool hf_chord_applies(const hf_evaluator *evaluator);

/* Factor the matrix at the base design. Returns HF_OK, HF_NO_MEMORY, or another status when the base design has no
 * shape or no positive definite matrix. workspace is scratch. Call hf_chord_free in any case. */
hf_status hf_chord_create(const hf_evaluator *evaluator, const double *base_N, hf_workspace *workspace,
                          hf_chord *chord);

/* The same at the shape that the workspace holds, of any laws: without genes, whose force densities the caller writes
 * into the lanes, row n_gene + e of `gene` for cable e. */
hf_status hf_chord_create_here(const hf_evaluator *evaluator, hf_workspace *workspace, hf_chord *chord);
void hf_chord_free(hf_chord *chord);

/* Returns the bytes that the shared matrix takes for this evaluator; *lanes_bytes are those of one thread's lanes. */
size_t hf_chord_bytes(const hf_evaluator *evaluator, size_t *lanes_bytes);

hf_status hf_chord_lanes_create(const hf_chord *chord, hf_chord_lanes *lanes);
void hf_chord_lanes_free(hf_chord_lanes *lanes);

/* Evaluate the designs whose indices `next(context)` returns, until it returns -1: from design_N [][n_gene] into
 * result []. With keeps_shape the workspace holds the last shape at the end; else it is scratch. */
void hf_chord_run(const hf_chord *chord, hf_chord_lanes *lanes, hf_workspace *workspace, hf_lane_next *next,
                  void *context, bool keeps_shape, const double *design_N, hf_form_result *result);

#endif
