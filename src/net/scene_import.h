/* scene_import - reads a scene from two CSV files.
 *
 *     nodes.csv : id,x_m,y_m,z_m,role[,Fx_N,Fy_N,Fz_N]   role: support | inner | edge
 *     cables.csv: id,i,j,group,law,value[,EA_N,set]      group: inner | boundary
 *                                                        law: tension | length | force_density | elastic
 *                                                        set: names of sets with blanks or ; between them, or empty
 *
 * The header line determines the order of the columns. Ids are any strings. Fields may be quoted. Empty lines and lines
 * that start with '#' are skipped. The unit of value is N, m, N/m or m, by law. An empty value stands for the
 * pretension of the case (law tension) or the length at the target positions (law length). The law elastic needs a
 * value (the unstressed length l0) and an EA_N. */
#pragma once

#include <hifdm/scene.h>

/* Reads a scene. group_EA_N [2], by hf_group, is for cables whose EA_N is empty; 0: none. Returns HF_OK. Returns
 * HF_BAD_CASE after reporting every fault with file, line and id. Returns HF_IO or HF_NO_MEMORY if reading fails. Call
 * hf_scene_free in every case. */
hf_status hf_scene_import(const char *nodes_path, const char *cables_path, const double group_EA_N[2], hf_scene *scene,
                          hf_messages *messages);
