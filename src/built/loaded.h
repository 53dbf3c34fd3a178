/* loaded - the as-built net of a design in one load case, near which the samples in this load case are (METHOD section
 * 12). */
#pragma once

#include "built/errors.h"

typedef struct {
    /* Borrowed, to be set before the first call. */
    const hf_load_case *load_case;
    const hf_material *material;
    /* [3 n_attachment] displacements of the attachments by the truss alone, m; NULL without a truss. */
    const double *attachment_move_m;
    bool has_shape;                  /* false: the design has no shape in this load case */
    hf_built built;                  /* the design in this load case */
    hf_built_batch *batch;           /* of `built`, after the first shape */
    double *cut_m, *move_m, *load_N; /* [n_cable], [3][n_node], [3][n_node] as hf_built_load_case sets them */
    void *block;
} hf_built_loaded;

/* Solves the design `base` in the load case, and makes the net and its batch of n_thread threads. A later call renews
 * them for another design of the same model. `near` is the batch of `base`, which solves from the nominal shape; NULL:
 * hf_built_solve solves. Returns HF_OK, also without a shape; HF_NO_MEMORY or HF_INTERRUPTED. Call hf_built_loaded_free
 * in any case. */
hf_status hf_built_loaded_make(const hf_built *base, hf_built_batch *near, int n_thread, hf_built_loaded *loaded,
                               hf_messages *messages);
void hf_built_loaded_free(hf_built_loaded *loaded);

/* Applies the numbers z of a sample, as hf_built_errors_apply does, to the net in the load case. The errors change the
 * nominal cut lengths, and the temperature of the load case changes the lengths as cut. Whatever cut_m contains is
 * replaced. */
void hf_built_loaded_apply(const hf_built_loaded *loaded, const hf_built_errors *errors, double scale, const double *z,
                           double *cut_m, double *EA_N, double *support_displacement_m);
