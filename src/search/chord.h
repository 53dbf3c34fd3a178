/* chord - a population near one shape: Newton steps with one matrix, factored once and shared read-only by all threads,
 * eight designs to a triangular solve (one per SIMD lane).
 *
 * A design converges when its own nodal forces vanish; the shared matrix only decides how fast. Each result is measured
 * again by the scalar code of formfind. A design that does not contract is evaluated by hf_evaluate on its own.
 * Lanes never touch each other: a result does not depend on which designs share a pass, or on the thread. */
#ifndef HIFDM_CHORD_H
#define HIFDM_CHORD_H

#include "search/chord_kernel.h"
#include "search/lane_schedule.h"

/* Can this rule be served? No cable may be left under law length, and the energy must be convex. */
int hf_chord_applies(const hf_evaluator *evaluator);

/* Factor at the base design. HF_OK; HF_NO_MEMORY; any other status: the base design has no shape, or no matrix, to
 * share. workspace is scratch. Free in any case. */
hf_status hf_chord_create(const hf_evaluator *evaluator, const double *base_N, hf_workspace *workspace,
                          hf_chord *chord);
void hf_chord_free(hf_chord *chord);

/* Bytes that the shared matrix and the lanes of one thread would take for this evaluator. */
size_t hf_chord_bytes(const hf_evaluator *evaluator, size_t *lanes_bytes);

hf_status hf_chord_lanes_create(const hf_chord *chord, hf_chord_lanes *lanes);
void hf_chord_lanes_free(hf_chord_lanes *lanes);

/* Of all this only the matrix, for right-hand sides of somebody else's: no base design, no truss. HF_OK or
 * HF_NO_MEMORY. Free both in any case. */
hf_status hf_chord_create_matrix(const hf_evaluator *evaluator, hf_chord *chord, hf_chord_lanes *lanes);

/* The factored Newton matrix of the workspace becomes the chord's. */
void hf_chord_pack(const hf_workspace *workspace, hf_chord *chord);

/* b [n_rhs][ldb], ldb >= 3 n_free: right-hand sides in, solutions out. As hf_band_back_solve, eight at a time. */
void hf_chord_back_solve(const hf_chord *chord, const hf_chord_lanes *lanes, int n_rhs, double *b, size_t ldb);

/* Evaluate the designs whose indices `next(context)` hands out, until it returns -1. design_N [][n_gene], result []. */
void hf_chord_run(const hf_chord *chord, hf_chord_lanes *lanes, hf_workspace *workspace, hf_lane_next *next,
                  void *context, const double *design_N, hf_form_result *result);

#endif
