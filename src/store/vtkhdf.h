/* vtkhdf - writes the group /VTKHDF: an unstructured grid in the format VTKHDF 1.0, which VTK 9.1, ParaView 5.11 and
 * newer versions open. Files of `export --vtk` have only this group; results have it beside their other groups.
 *
 * In a finished result the cells are the cables, and the points are the positions of the nodes in the result of the
 * run. Data sets of our groups that have the same layout are linked, not copied:
 *   /VTKHDF/Points     position_m of the result: hf_store_result_stage
 *   /VTKHDF/PointData  STAGE_position_m of each shape, target_position_m, load_N, tolerance_node_deviation_m; role
 *   /VTKHDF/CellData   STAGE_tension_N, STAGE_q_N_per_m, STAGE_length_m of each shape, length_at_target_m, EA_N,
 *                      tolerance_cable_share; group; tension_N, q_N_per_m, length_m of the shape of the points
 * STAGE is form, search or refine, or load_case_NAME for a load case of the as-built net. The points have positions,
 * not displacements. Links to positions cost no bytes, and the values are exactly those of our groups. The calculator
 * of ParaView takes them as coordinates, also with magnified displacements. Only the ends and types of the cells, and
 * role and group as numbers, are copies, because VTK reads neither pairs nor enumerations. */
#pragma once

#include "store/hdf5.h"
#include <hifdm/summary.h>

enum { HF_VTKHDF_LINE = 3, HF_VTKHDF_TRIANGLE = 5, HF_VTKHDF_QUAD = 9 }; /* type numbers of cells in VTK */

typedef struct {
    int n_point, n_cell;
    const int *corner;         /* [offset[n_cell]] points of the cells, one cell after the other */
    const int *offset;         /* [n_cell + 1] where the points of each cell begin */
    const unsigned char *type; /* [n_cell] type of each cell */
} hf_vtkhdf_cells;

/* Makes the group /VTKHDF with empty PointData and CellData, and without Points. */
void hf_vtkhdf_put_cells(hf_hdf5 *io, const hf_vtkhdf_cells *cells);

/* Makes the group of a result whose other groups exist already. Does nothing if the result has no shape. */
void hf_vtkhdf_put_result(hf_hdf5 *io, const hf_summary *summary);
