/* vtkhdf - the group /VTKHDF: an unstructured grid as VTKHDF 1.0, which VTK 9.1, ParaView 5.11 and newer open; files of
 * `export --vtk` have nothing else, results have it beside their groups.
 *
 * In a finished result its cells are the cables and its points the nodes where the result of the run has them; all that
 * our groups hold in the same layout is linked rather than copied:
 *   /VTKHDF/Points     position_m of the result: hf_store_result_stage
 *   /VTKHDF/PointData  STAGE_position_m of each shape, theoretical_position_m, load_N, tolerance_node_deviation_m; role
 *   /VTKHDF/CellData   STAGE_tension_N, STAGE_q_N_per_m, STAGE_length_m of each shape, theoretical_length_m, EA_N,
 *                      tolerance_cable_share; group; tension_N, q_N_per_m, length_m of the shape that Points are of
 * STAGE is form, optimize, polish, or case_NAME of a state of the net as built. Positions rather than displacements:
 * they cost no bytes, are the very numbers of our groups, and the calculator of ParaView takes them for coordinates,
 * with displacements magnified as well. The copies are ends and kinds of the cells, and role and group as their
 * numbers: VTK reads no pairs and no enumerations. */
#ifndef HIFDM_STORE_VTKHDF_H
#define HIFDM_STORE_VTKHDF_H

#include "store/hdf5.h"
#include <hifdm/summary.h>

enum { HF_VTKHDF_LINE = 3, HF_VTKHDF_TRIANGLE = 5, HF_VTKHDF_QUAD = 9 }; /* VTK's numbers of the types of cells */

typedef struct {
    int n_point, n_cell;
    const int *corner;         /* [offset[n_cell]] points of the cells, one after the other */
    const int *offset;         /* [n_cell + 1] where those of each begin */
    const unsigned char *type; /* [n_cell] */
} hf_vtkhdf_cells;

/* A new group /VTKHDF with empty PointData and CellData, and without Points. */
void hf_vtkhdf_put_cells(hf_hdf5 *io, const hf_vtkhdf_cells *cells);

/* The group of a result, whose other groups are there already; nothing when it has no shape. */
void hf_vtkhdf_put_result(hf_hdf5 *io, const hf_summary *summary);

#endif
