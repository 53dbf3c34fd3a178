/* cutlist - what the workshop needs to make a net, from a stored shape. For --cutlist NAME.csv three CSV files:
 *
 * NAME.csv       : id,i,j,group,tension_N,length_m,l0_m,elongation_m,EA_N,adjustment_m,law,value
 *                  l0_m          unstressed length, length_m / (1 + T/EA); a slack cable of law length or elastic has
 *                                the length that its law gives
 *                  elongation_m  length_m - l0_m
 *                  adjustment_m  l0_m less the unstressed length, under the same tension, of a cable cut for the
 *                                theoretical shape: what a turnbuckle must give (> 0) or take up (< 0) in a net that
 *                                was cut from the drawing
 *                  law, value    "elastic" and l0_m again: NAME.csv is also the cables.csv of the net as built
 * NAME_nodes.csv : id,x_m,y_m,z_m,role[,Fx_N,Fy_N,Fz_N]    where the jig holds each node; also a nodes.csv
 * NAME_totals.csv: group,cables,l0_m,length_m,least_tension_N,largest_tension_N,least_adjustment_m,
 *                  largest_adjustment_m    by group, and for all
 * 17 significant digits: the net that is built from them has the stored shape. */
#ifndef HIFDM_CUTLIST_H
#define HIFDM_CUTLIST_H

#include "out/export.h"

/* Of request->file into request->output. HF_BAD_CASE when cables have no EA, with their group; else as hf_export. */
hf_status hf_cutlist(const hf_export_request *request, char *said, size_t size, hf_messages *messages);

#endif
