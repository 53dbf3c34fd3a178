/* swarm_lane - runs the paper's iteration for eight designs of one net at a time, one in each SIMD lane.
 *
 * The eight share the net, its numbering and the laws. Each has its own force densities, targets and support positions.
 * Every array below ends in [HF_LANES], with entry k for lane k, and no operation mixes lanes. Meaningless numbers, NaN
 * or an indefinite matrix in one lane do not change a bit in the others. A lane without a design holds a copy of
 * another one.
 *
 *     One iteration:    hf_swarm_solve(plan, w);                  force densities -> positions (Eqs. 2, 5)
 *                       hf_swarm_measure(plan, w, &measures);     lengths, errors, next force densities (Eqs. 4, 7, 8)
 *                       hf_swarm_residual(plan, w, &measures);
 *                       ... hf_swarm_get each design that has ended ...
 *                       hf_swarm_update(w);
 *                       ... hf_swarm_put the designs that take their lanes ... */
#ifndef HIFDM_SWARM_LANE_H
#define HIFDM_SWARM_LANE_H

#include "search/swarm_kernel.h"

/* ---- set-up ---- */

/* Makes the plan of a model without struts, with the kernels of an instruction set that this machine has. Returns HF_OK
 * or HF_NO_MEMORY; call hf_swarm_plan_free in either case. */
hf_status hf_swarm_plan_create(const hf_model *model, hf_lane_isa isa, hf_swarm_plan *plan);
void hf_swarm_plan_free(hf_swarm_plan *plan);

/* hf_swarm_lanes_take takes the fields from the caller's arena. hf_swarm_lanes_create allocates a block for them, and
 * returns HF_OK or HF_NO_MEMORY; call hf_swarm_lanes_free in either case. hf_swarm_lanes_bytes returns the size of the
 * block. The same lanes serve all plans of one model. */
void hf_swarm_lanes_take(hf_arena *arena, const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
size_t hf_swarm_lanes_bytes(const hf_swarm_plan *plan);
hf_status hf_swarm_lanes_create(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
void hf_swarm_lanes_free(hf_swarm_lanes *lanes);

/* Copies the force densities, targets and support positions of one design from a workspace into a lane. The caller sets
 * the laws. */
void hf_swarm_put(const hf_swarm_plan *plan, const hf_workspace *from, int lane, hf_swarm_lanes *lanes);

/* Copies the shape of a lane into a workspace, after hf_swarm_measure: positions, force densities, lengths and
 * tensions. */
void hf_swarm_get(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, int lane, hf_workspace *to);

/* ---- kernels ---- */

/* Assembles D from the force densities in the tiles of `matrix` that have entries. Writes the right-hand sides (loads,
 * and the forces from supports) into the free rows of position_m. */
void hf_swarm_assemble(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);

/* Replaces D by its Cholesky factor. A pivot that is not positive sets bad_row. Its row and column are removed, so that
 * the numbers of the lane stay bounded. */
void hf_swarm_factor(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);

/* Replaces the right-hand sides in the free rows of position_m by the solutions. */
void hf_swarm_substitute(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);

/* Assembles, factors and substitutes, with the bits of the three calls in less time: the forward substitution runs
 * while the factor is in the cache. */
void hf_swarm_solve(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);

/* Computes lengths, errors against the laws and the next force densities. Sets all measures except residual_N and
 * psi_m. */
void hf_swarm_measure(const hf_swarm_plan *plan, hf_swarm_lanes *lanes, hf_swarm_measures *measures);

/* Sets residual_N, the maximum force out of balance at a free node with every cable at the tension of its law. Call it
 * after hf_swarm_measure. */
void hf_swarm_residual(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, hf_swarm_measures *measures);

/* Sets psi_m, the root mean square of Eq. 10. */
void hf_swarm_psi(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, hf_swarm_measures *measures);

/* Makes the next force densities the present ones. */
void hf_swarm_update(hf_swarm_lanes *lanes);

#endif
