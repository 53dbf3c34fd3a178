/* constraints - rows of `requirements` as constraints of the search, over the design, its load cases and samples of its
 * errors (METHOD section 14). It implements the interface hf_constraints of evaluate.h.
 *
 *     design -> nets (built_nets) -> distance of each figure from its bound, positive beyond it
 *       row without a share: one constraint for each load case and bound
 *       row with a share:    maximum over load cases and bounds of each sample -> quantile, or CVaR where derivatives
 *                            are needed: the mean of the worst 1 - share of the samples
 *
 * Slack cables of a row are judged by tensions, because a count has no derivative. */
#pragma once

#include "built/built_nets.h"
#include "built/required.h"
#include "surface/cloud.h"

/* Distance from its bound, in units of the constraint, of a net without a shape or without the figure. */
#define HF_BUILT_NO_VALUE 1e3

typedef struct {
    hf_constraints as; /* the first member: the interface that evaluate.h uses */
    const hf_required *required;
    const hf_model *model;
    const hf_built_nets *nets; /* NULL: all constraints are about the design itself */
    const hf_surface_settings *surface;
    const hf_facets *facets;
    bool needs_surface, needs_radio;
    int n_facet, *corner_row;                 /* facets of the net; [n_facet][4] */
    int *row;                                 /* [as.n] row of each constraint */
    int *state;                               /* [as.n] its load case; -1: all of its row */
    bool *is_high;                            /* [as.n] which bound of its row, if it has a load case */
    double *unit;                             /* [as.n] as.unit */
    hf_limit *limit;                          /* [as.n] those of as.limit */
    const hf_limit **as_limit;                /* [as.n] as.limit */
    int state_of_samples[HF_REQUIRED_STATES]; /* state of the samples (built_nets.h) in each load case, -1: none */
    void *block;
} hf_built_constraints;

/* Returns the bits of the load cases that the search needs of the design, or of samples. */
unsigned hf_built_constraints_states(const hf_required *required, bool is_many);

/* Makes the constraints. All arguments are borrowed; nets may be NULL if only the design itself is constrained. Returns
 * HF_OK or HF_NO_MEMORY; the caller frees the block in any case. */
hf_status hf_built_constraints_make(const hf_required *required, const hf_model *model, const hf_built_nets *nets,
                                    const hf_surface_settings *surface, const hf_facets *facets,
                                    hf_built_constraints *constraints);
