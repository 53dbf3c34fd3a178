/* swarm_lane - the form-finding iteration for eight individuals of one net at a time, one in each SIMD lane.
 *
 * The eight share the net, its numbering and the laws; each has its own force densities, targets and support positions.
 * Every array below ends in [HF_LANES]: place k belongs to individual k, and no operation mixes lanes. Meaningless
 * numbers, NaN or an indefinite matrix in one lane do not change a bit in the others. A lane without an individual
 * holds a copy of another one.
 *
 * One iteration:    hf_swarm_solve(plan, w);                  force densities -> positions (Eqs. 2, 5)
 *                   hf_swarm_measure(plan, w, &measures);     lengths, errors, the next force densities (Eqs. 4, 7, 8)
 *                   hf_swarm_residual(plan, w, &measures);
 *                   ... hf_swarm_get each individual that has ended ...
 *                   hf_swarm_update(w);
 *                   ... hf_swarm_put the individuals that take their lanes ... */
#ifndef HIFDM_SWARM_LANE_H
#define HIFDM_SWARM_LANE_H

#include "search/swarm_kernel.h"

/* ---- set-up ---- */

/* Make the plan of a model without struts, with the kernels of an instruction set that this machine has. Returns HF_OK
 * or HF_NO_MEMORY; free in either case. */
hf_status hf_swarm_plan_create(const hf_model *model, hf_lane_isa isa, hf_swarm_plan *plan);
void hf_swarm_plan_free(hf_swarm_plan *plan);

/* hf_swarm_lanes_take lays the fields out in the caller's arena. hf_swarm_lanes_create allocates a block for them:
 * HF_OK or HF_NO_MEMORY; free in either case. The same lanes serve all plans of one model. */
void hf_swarm_lanes_take(hf_arena *arena, const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
size_t hf_swarm_lanes_bytes(const hf_swarm_plan *plan);
hf_status hf_swarm_lanes_create(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
void hf_swarm_lanes_free(hf_swarm_lanes *lanes);

/* Copy the force densities, targets and support positions of one individual into a lane. The caller sets the laws. */
void hf_swarm_put(const hf_swarm_plan *plan, const hf_workspace *from, int lane, hf_swarm_lanes *lanes);

/* Copy the shape of a lane into a workspace, after hf_swarm_measure: positions, force densities, lengths and
 * tensions. */
void hf_swarm_get(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, int lane, hf_workspace *to);

/* ---- kernels ---- */

/* Write D, from the force densities, into the tiles of `matrix` that have entries, and the right-hand sides (loads, and
 * the pull of the supports) into the free rows of position_m. */
void hf_swarm_assemble(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);

/* Replace D by its Cholesky factor. A pivot that is not positive sets bad_row; its row and column are taken out, so
 * that the numbers of the lane stay bounded. */
void hf_swarm_factor(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);

/* Replace the right-hand sides in the free rows of position_m by the solutions. */
void hf_swarm_substitute(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);

/* Assemble, factor and substitute. The forward substitution is done while the factor is in the cache: the bits are
 * those of the three calls, in less time. */
void hf_swarm_solve(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);

/* Compute lengths, errors against the laws and the next force densities. Sets all measures but residual_N and psi_m. */
void hf_swarm_measure(const hf_swarm_plan *plan, hf_swarm_lanes *lanes, hf_swarm_measures *measures);

/* Set residual_N: the largest force out of balance at a free node with every cable at the tension of its law. Call it
 * after hf_swarm_measure. */
void hf_swarm_residual(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, hf_swarm_measures *measures);

/* Set psi_m, the root mean square of Eq. 10. */
void hf_swarm_psi(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, hf_swarm_measures *measures);

/* Make the next force densities the present ones. */
void hf_swarm_update(hf_swarm_lanes *lanes);

#endif
