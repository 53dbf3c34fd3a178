/* scene_import - a scene from two CSV files.
 *
 * nodes.csv : id,x_m,y_m,z_m,role[,Fx_N,Fy_N,Fz_N]   role: support | inner | edge
 * cables.csv: id,i,j,group,law,value[,EA_N]          group: inner | boundary; law: tension | length | force_density
 *
 * The header decides the order of the columns; ids are any strings; fields may be quoted; empty lines and lines that
 * start with '#' are skipped. value: N, m or N/m by law; empty = the case's pretension, or the theoretical length. */
#ifndef HIFDM_SCENE_IMPORT_H
#define HIFDM_SCENE_IMPORT_H

#include <hifdm/scene.h>

/* HF_BAD_CASE with every fault named by file, line and id. Free the scene with hf_scene_free in any case. */
hf_status hf_scene_import(const char *nodes_path, const char *cables_path, hf_scene *scene, hf_messages *messages);

#endif
