/* scene_import - a scene from two CSV files.
 *
 * nodes.csv : id,x_m,y_m,z_m,role[,Fx_N,Fy_N,Fz_N]   role: support | inner | edge
 * cables.csv: id,i,j,group,law,value[,EA_N,set]      group: inner | boundary
 *                                                    law: tension | length | force_density | elastic
 *                                                    set: names of sets with blanks or ; between them, or empty
 *
 * The header line gives the order of the columns; ids are any strings; fields may be quoted; empty lines and lines that
 * start with '#' are skipped. value: N, m, N/m or m by law; empty = the case's pretension, or the theoretical
 * length; the law elastic needs a value (l0) and an EA_N. */
#ifndef HIFDM_SCENE_IMPORT_H
#define HIFDM_SCENE_IMPORT_H

#include <hifdm/scene.h>

/* group_EA_N: by hf_group, for cables whose EA_N is empty; 0 = none. HF_BAD_CASE with a message for every fault that
 * gives file, line and id. Free the scene with hf_scene_free in any case. */
hf_status hf_scene_import(const char *nodes_path, const char *cables_path, const double group_EA_N[2], hf_scene *scene,
                          hf_messages *messages);

#endif
