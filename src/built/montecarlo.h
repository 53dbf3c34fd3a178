/* montecarlo - samples of a net as built: their errors, their shapes, what is measured of them. */
#ifndef HIFDM_MONTECARLO_H
#define HIFDM_MONTECARLO_H

#include "built/directions.h"
#include <hifdm/built_batch.h>
#include "surface/gain.h"
#include "surface/surface_near.h"
#include <hifdm/tolerance.h>

#include <stdatomic.h>

/* Everything that samples need; it is not moved. */
typedef struct {
    const hf_tolerance_settings *settings;
    const hf_built *built;
    const hf_surface_settings *surface; /* focal_length_m 0: the surface is not measured */
    const hf_facets *facets;
    const hf_gain_beam *beam; /* borrowed, to be set before samples; NULL: the far field is not measured */
    hf_surface_design design; /* where the best fits of samples begin */
    hf_built_linear linear;
    hf_built_errors errors;
    hf_covariance covariance;
    hf_directions directions; /* n is 0 with random numbers alone */
    hf_built_batch *batch;
    int n_chunk;  /* most samples at a time */
    double scale; /* of all errors, now */
    long first;   /* sample of the first row, now */
    int n_now;
    double *row;     /* [n_chunk][HF_TOLERANCE_COLUMNS] */
    double *z;       /* [n_chunk][n_z] errors of each sample */
    double *point;   /* [n_chunk][directions.n] */
    double *scratch; /* [n_thread][n_room] */
    size_t n_z, n_room;
    unsigned varies;                           /* HF_BUILT_VARIES_... */
    atomic_bool has_no_memory;                 /* some sample could not be measured; any thread may find that */
    bool skips_surface;                        /* it is not measured, now */
    void (*tell)(void *context, double scale); /* before each yield on the way to a scale; NULL: not */
    void *tell_context;
    void *block;
} hf_montecarlo;

/* settings, built, surface, facets are borrowed. heat: as hf_built_errors_make. HF_OK; HF_SINGULAR when the nominal
 * net has no factor; HF_INTERRUPTED; HF_NO_MEMORY. Free in any case. */
hf_status hf_montecarlo_create(const hf_tolerance_settings *settings, const hf_built *built,
                               const hf_surface_settings *surface, const hf_facets *facets, const hf_built_heat *heat,
                               int n_thread, hf_montecarlo *montecarlo);
void hf_montecarlo_free(hf_montecarlo *montecarlo);

/* Is this measured? */
bool hf_montecarlo_measures(const hf_surface_settings *surface, const hf_facets *facets, hf_tolerance_measure measure);

/* Solve samples first to first + n - 1, n <= n_chunk, with all errors times `scale`, into montecarlo->row. HF_OK;
 * HF_INTERRUPTED when built->stop says so; HF_NO_MEMORY. */
hf_status hf_montecarlo_run(hf_montecarlo *montecarlo, double scale, long first, int n);

/* Does a row meet row k of the requirements, or all of them? */
bool hf_montecarlo_meets(const hf_tolerance_settings *settings, int k, const double *row);
bool hf_montecarlo_meets_all(const hf_tolerance_settings *settings, const double *row);

/* The search of a scale: doublings, then halvings, with a yield for each, and one for where it begins. */
enum { HF_SCALE_DOUBLINGS = 10, HF_SCALE_HALVINGS = 7, HF_SCALE_YIELDS = 1 + HF_SCALE_DOUBLINGS + HF_SCALE_HALVINGS };

/* Is a requirement about the surface? To measure it takes longer than to find a sample, so a search measures it only
 * then. */
bool hf_montecarlo_requires_surface(const hf_tolerance_settings *settings);

/* The factor of all errors with which a part settings->yield of the first n samples meets what is required, by
 * bisection with the same numbers for each, to 1 %. bound 0: found, and `scale` 0: not even the nominal net does; 1: at
 * least `scale`, the largest that is tried (hf_built_errors_largest_scale); -1: below `scale`, the smallest. */
hf_status hf_montecarlo_find_scale(hf_montecarlo *montecarlo, int n, double *scale, int *bound);

#endif
