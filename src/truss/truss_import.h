/* truss_import - a truss from two CSV files, written as those of the net (scene_import).
 *
 * truss_nodes.csv: id,x_m,y_m,z_m,fixed[,mass_kg]
 *   fixed: the dofs that a support holds, any of ux uy uz rx ry rz parted by blanks, or all; empty: none
 * members.csv: id,i,j,E_Pa,A_m2[,G_Pa,Iy_m4,Iz_m4,J_m4,Asy_m2,Asz_m2,roll_rad,density_kg_per_m3,expansion_per_K,
 *              joint,unit]
 *   joint: rigid (also when empty) | pinned; a rigid member needs G_Pa, Iy_m4, Iz_m4 and J_m4. An empty shear area is
 *   infinite: no shear deformation. unit: bud | mbug | abug | other (also when empty). Other empty cells are 0. */
#ifndef HIFDM_TRUSS_IMPORT_H
#define HIFDM_TRUSS_IMPORT_H

#include <hifdm/truss.h>

/* HF_BAD_CASE with every fault named by file, line and id. Free the truss with hf_truss_free in any case. */
hf_status hf_truss_import(const char *nodes_path, const char *members_path, hf_truss *truss, hf_messages *messages);

#endif
