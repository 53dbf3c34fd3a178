/* truss_import - reads a truss from two CSV files, in the format of the files of the net (scene_import).
 *
 *     truss_nodes.csv: id,x_m,y_m,z_m,fixed[,mass_kg]
 *       fixed: the dofs that a support holds, any of ux uy uz rx ry rz separated by blanks, or all; empty: none
 *     members.csv: id,i,j,E_Pa,A_m2[,G_Pa,Iy_m4,Iz_m4,J_m4,Asy_m2,Asz_m2,roll_rad,density_kg_per_m3,expansion_per_K,
 *                  joint,unit]
 *       joint: rigid (also when empty) | pinned
 *       unit: bud | mbug | abug | other (also when empty) | longeron | vertical | diagonal
 *
 * A rigid member needs G_Pa, Iy_m4, Iz_m4 and J_m4. An empty shear area is infinite: no shear deformation. An empty
 * mass, roll, density or expansion is 0. */
#pragma once

#include <hifdm/truss.h>

/* Reads a truss. Returns HF_OK. Returns HF_BAD_CASE after reporting every fault with file, line and id. Returns HF_IO
 * or HF_NO_MEMORY if reading fails. Call hf_truss_free in every case. */
hf_status hf_truss_import(const char *nodes_path, const char *members_path, hf_truss *truss, hf_messages *messages);
