/* loaded - the as-built net of a design in one load case, near which the samples in this load case are (METHOD section
 * 12). */
#pragma once

#include "built/errors.h"

/* Displacements of the attachments by the truss alone in each load case, and the part of them that is due to its
 * weight, [n_load_case][3 n_attachment] m. Both are NULL without a truss. */
typedef struct {
    const double *move_m, *by_weight_m;
} hf_built_rest;

typedef struct {
    int i_load_case;
    /* Borrowed. */
    const hf_load_case *load_case;
    const hf_material *material;
    hf_built_rest rest;              /* of this load case, [3 n_attachment] */
    bool has_shape;                  /* false: the design has no shape in this load case */
    hf_built built;                  /* the design in this load case */
    hf_built_batch *batch;           /* of `built`, after the first shape */
    double *cut_m, *move_m, *load_N; /* [n_cable], [3][n_node], [3][n_node] as hf_built_load_case sets them */
    double *weight_N;                /* [3][n_node] weights under the gravity of the load case */
    void *block;
} hf_built_loaded;

/* Selects load case i_load_case for a net with n_attachment attachments. load_cases and the arrays of `rest` are
 * borrowed. */
void hf_built_loaded_select(const hf_load_cases *load_cases, int i_load_case, const hf_built_rest *rest,
                            int n_attachment, hf_built_loaded *loaded);

/* Solves the design `base` in the load case, and makes the net and its batch of n_thread threads. A later call renews
 * them for another design of the same model. `near` is the batch of `base`, which solves from the nominal shape; NULL:
 * hf_built_solve solves. Returns HF_OK, also without a shape; HF_NO_MEMORY or HF_INTERRUPTED. Call hf_built_loaded_free
 * in any case. */
hf_status hf_built_loaded_make(const hf_built *base, hf_built_batch *near, int n_thread, hf_built_loaded *loaded,
                               hf_messages *messages);
void hf_built_loaded_free(hf_built_loaded *loaded);

/* Returns whether a load case of a net with n_node nodes prescribes what can have an error of this kind. */
bool hf_load_case_may_err(const hf_load_case *load_case, int n_node, hf_load_error kind);

/* Returns whether samples have errors of this kind in the load case. */
bool hf_built_loaded_errs(const hf_built_loaded *loaded, const hf_built_errors *errors, hf_load_error kind);

/* Returns the error of this kind of a sample, 0 if there is none. */
double hf_built_loaded_error(const hf_built_loaded *loaded, const hf_built_errors *errors, long sample,
                             hf_load_error kind);

/* Returns which properties of samples vary in the load case, as flags HF_BUILT_VARIES_... */
unsigned hf_built_loaded_vary(const hf_built_loaded *loaded, const hf_built_errors *errors);

/* Applies the numbers z of a sample, as hf_built_errors_apply does, and its errors of the load case. The errors change
 * the nominal cut lengths, and the temperature of the load case changes the lengths as cut. Whatever cut_m contains is
 * replaced. load_N [3][n_node] by row has the loads of the load case on entry; NULL if loads do not vary. */
void hf_built_loaded_apply(const hf_built_loaded *loaded, const hf_built_errors *errors, double scale, long sample,
                           const double *z, double *cut_m, double *EA_N, double *support_displacement_m,
                           double *load_N);

/* Adds the weights of nodes and cables under the gravity g to load_N [3][n_node] by row. */
void hf_built_add_weight(const hf_built *built, const hf_material *material, const double g[3], double *load_N);
