/* export - a stored shape as CSV files.
 *
 * nodes.csv : id,x_m,y_m,z_m,x0_m,y0_m,z0_m,role   (found and theoretical position)
 * cables.csv: id,i,j,group,law,length_m,tension_N,q_N_per_m
 * With a truss also truss_nodes.csv and members.csv as truss_import reads them; displacements and end forces stand
 * behind those columns when they are stored.
 * 17 significant digits: reading them back gives the same bits. */
#ifndef HIFDM_EXPORT_H
#define HIFDM_EXPORT_H

#include <hifdm/store.h>

/* What is to be written from which result. */
typedef struct {
    const char *file;   /* the result */
    const char *output; /* the file or folder to write, by exporter */
    const char *stage;  /* a word of hf_stage_word, NULL: the result of the run */
    int force;          /* replace what is there */
} hf_export_request;

/* Writes into the folder request->output (made if it is not there). Existing files stay unless request->force. `said`:
 * one line for people on what was written. */
hf_status hf_export(const hf_export_request *request, char *said, size_t size, hf_messages *messages);

/* One shape of a result file, as request->stage asks or the result of the run, with its summary and scene. `word`: what
 * the shape is called, for people. Free scene and shape in any case. */
hf_status hf_export_read(const hf_export_request *request, hf_summary *summary, hf_scene *scene, hf_shape *shape,
                         const char **word, hf_messages *messages);

/* HF_EXISTS with a message when `path` is there and not `force`. */
hf_status hf_export_claim(const char *path, int force, hf_messages *messages);

/* Make a folder unless it is there. HF_OK or HF_IO. */
hf_status hf_export_folder(const char *path, hf_messages *messages);

#endif
