/* measured - the places of nodes of the net as it stands, from a table id,x_m,y_m,z_m[,sigma_m].
 *
 * The table is held against the nominal net before anybody believes it: units, frame, ids that were mixed up. */
#ifndef HIFDM_MEASURED_H
#define HIFDM_MEASURED_H

#include "built/linear.h"

/* By dof 3*row + c of the model. */
typedef struct {
    int n_node;            /* nodes that were measured */
    double *place_m;       /* [n_dof] */
    double *weight_per_m2; /* [n_dof] 1/sigma^2; 0: not measured */
    int *line;             /* [n_node of the model] by row: where in the table; 0: not there */
    void *block;
} hf_measured;

/* Of the nodes of a scene, whose model says the rows. sigma_m: of nodes without one of their own; 0: there is none.
 * HF_OK; HF_BAD_CASE with all faults by file, line and id; HF_NO_MEMORY. Free in any case. */
hf_status hf_measured_read(const char *path, const hf_scene *scene, const hf_model *model, double sigma_m,
                           hf_measured *measured, hf_messages *messages);
void hf_measured_free(hf_measured *measured);

/* Can errors of this size have moved the nominal net to where it was measured? expected_m [n_node of the model], by
 * row: RMS of how far they move each node. HF_OK, or HF_BAD_CASE with what explains the places instead: another unit,
 * another frame, nodes far away by name and line. */
hf_status hf_measured_check(const char *path, const hf_built *built, const double *expected_m,
                            const hf_measured *measured, hf_messages *messages);

#endif
