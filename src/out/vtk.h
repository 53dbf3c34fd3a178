/* vtk - the shapes of a run for ParaView: VTKHDF 1.0 files of an unstructured grid of lines, read by VTK 9.1, ParaView
 * 5.11 and newer.
 *
 * theoretical.hdf, form.hdf, and as far as the run has them optimize.hdf and polish.hdf. Points and cells are in the
 * order of the scene. Point data: role, load_N; of a found shape displacement_m (from the theoretical shape) and its
 * size deviation_m; normal_error_m, when the case asks for measures of the surface. Cell data: group, law, length_m,
 * EA_N; of a found shape tension_N, q_N_per_m, slack, length_change_m (from the theoretical length). Words are numbers
 * here: role 0 support, 1 inner, 2 edge; group 0 inner, 1 boundary; law 0 tension, 1 length, 2 force_density,
 * 3 elastic.
 *
 * truss.hdf, of a run with one: points fixed (bit k: dof k is held), mass_kg, displacement_m, rotation_rad; cells unit,
 * joint, axial_force_N (tension > 0). */
#ifndef HIFDM_VTK_H
#define HIFDM_VTK_H

#include "out/export.h"

/* Of request->file into the folder request->output; else as hf_export. */
hf_status hf_vtk(const hf_export_request *request, char *said, size_t size, hf_messages *messages);

#endif
