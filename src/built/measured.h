/* measured - reads measured positions of nodes of an as-built net, from a table id,x_m,y_m,z_m[,sigma_m].
 *
 * The table is compared with the nominal net before it is used. This finds wrong units, another frame and mixed-up
 * ids. */
#pragma once

#include "built/linear.h"

/* Holds the measured positions. Arrays [n_dof] have the entry 3*row + c for coordinate c of a node of the model. */
typedef struct {
    int n_node;            /* number of measured nodes */
    double *position_m;    /* [n_dof] measured positions */
    double *weight_per_m2; /* [n_dof] 1/sigma^2; 0: not measured */
    int *line;             /* [n_node of the model] line of the table by row; 0: not in the table */
    void *block;
} hf_measured;

/* Reads the table. `scene` has the ids of the nodes, `model` has their rows. sigma_m is the standard deviation of nodes
 * without one in the table; 0: there is none. Returns HF_OK; HF_BAD_CASE with all faults by file, line and id;
 * HF_NO_MEMORY. The caller frees its block in any case. */
hf_status hf_measured_read(const char *path, const hf_scene *scene, const hf_model *model, double sigma_m,
                           hf_measured *measured, hf_messages *messages);

/* Checks whether errors of the expected size can explain the measured positions. expected_m [n_node of the model] is
 * the RMS displacement of each node by row. Returns HF_OK, perhaps with warnings; or HF_BAD_CASE with an explanation:
 * another unit, another frame, or single nodes by name and line. */
hf_status hf_measured_check(const char *path, const hf_built *built, const double *expected_m,
                            const hf_measured *measured, hf_messages *messages);
