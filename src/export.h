/* export - a stored shape as CSV files.
 *
 * nodes.csv : id,x_m,y_m,z_m,x0_m,y0_m,z0_m,role   (found and theoretical position)
 * cables.csv: id,i,j,group,law,length_m,tension_N,q_N_per_m
 * 17 significant digits: reading them back gives the same bits. */
#ifndef HIFDM_EXPORT_H
#define HIFDM_EXPORT_H

#include "options.h"

/* Writes into options->csv (made if it is not there). Existing files stay unless options->force. `said`: one line for
 * people on what was written. */
hf_status hf_export(const hf_options *options, char *said, size_t size, hf_messages *messages);

#endif
