/* montecarlo - samples of an as-built net: their errors, their shapes and their measures (METHOD section 12). */
#pragma once

#include "built/directions.h"
#include "built/loaded.h"
#include "built/required.h"
#include <hifdm/built_batch.h>
#include "surface/gain.h"
#include "surface/surface_measure.h"
#include <hifdm/tolerance.h>

#include <stdatomic.h>

/* The samples of one load case. */
typedef struct {
    int state; /* 1 + number of the load case */
    hf_built_loaded net;
    hf_surface_design design; /* starting values of the best fits of its samples */
    hf_antenna *antenna;      /* [required->n_antenna] the same for figures at a frequency */
} hf_montecarlo_load_case;

/* Holds everything that samples need. It must not be moved in memory, because its members point to each other. */
typedef struct {
    const hf_tolerance_settings *settings;
    const hf_built *built;
    const hf_surface_settings *surface; /* NULL or focal_length_m 0: the surface is not measured */
    const hf_facets *facets;
    /* Borrowed, to be set before the first sample; NULL: the far field is not measured. */
    const hf_gain_beam *beam;
    hf_surface_design design; /* starting values of the best fits of samples */
    hf_built_linear linear;
    hf_built_errors errors;
    hf_covariance covariance;
    hf_directions directions; /* n is 0 with random numbers alone */
    hf_built_batch *batch;
    int n_chunk;  /* maximum number of samples in one call of hf_montecarlo_run */
    double scale; /* present factor of all errors */
    long first;   /* sample of the first row */
    /* Present number of rows. */
    int n_now;
    /* Values of a row: HF_TOLERANCE_COLUMNS and, with required, the margins [n_share] of its rows with a share, then
     * value [n_column] and item [n_column] of each load case, and the counts HF_SAMPLE_... over all load cases. */
    int n_value;
    double *row;     /* [n_chunk][n_value] results of the samples */
    double *z;       /* [n_chunk][n_z] numbers of each sample */
    double *point;   /* [n_chunk][directions.n] points of Sobol's sequence */
    double *scratch; /* [n_thread][n_room] scratch of each thread */
    size_t n_z, n_room;
    unsigned varies;           /* flags HF_BUILT_VARIES_... */
    atomic_bool has_no_memory; /* a sample could not be measured; any thread may set it */
    bool skips_surface;        /* the surface is not measured at present */
    /* Reports each scale before its yield is computed; may be NULL. */
    void (*tell)(void *context, double scale);
    void *tell_context;
    const hf_required *required; /* NULL: nothing is required of samples */
    hf_antenna *antenna;         /* [required->n_antenna] antennas of the samples without load case */
    int n_load_case;
    hf_montecarlo_load_case *load_case; /* [n_load_case] load cases that samples need */
    void *block, *required_block;
} hf_montecarlo;

/* Makes the nominal net's linear model, its errors and their covariance, for samples in n_thread threads (0: all
 * cores). settings, built, surface and facets are borrowed; heat is that of hf_built_errors_make. Returns HF_OK;
 * HF_SINGULAR when the nominal net has no stiffness; HF_INTERRUPTED; HF_NO_MEMORY. Call hf_montecarlo_free in any
 * case. */
hf_status hf_montecarlo_create(const hf_tolerance_settings *settings, const hf_built *built,
                               const hf_surface_settings *surface, const hf_facets *facets, const hf_built_heat *heat,
                               int n_thread, hf_montecarlo *montecarlo);
void hf_montecarlo_free(hf_montecarlo *montecarlo);

/* Adds to the samples what rows of `requirements` need: the figures, and the load cases. Call it before the first
 * sample. All arguments are borrowed. Returns HF_OK, HF_NO_MEMORY or HF_INTERRUPTED. */
hf_status hf_montecarlo_require(hf_montecarlo *montecarlo, const hf_required *required, const hf_built_rest *rest,
                                hf_messages *messages);

/* Returns the offset in a row of the margin of share row k, and of the values or the items of a load case. */
static inline size_t hf_montecarlo_margin_at(int k)
{
    return (size_t)(HF_TOLERANCE_COLUMNS + k);
}
static inline size_t hf_montecarlo_value_at(const hf_required *q, int state, bool is_item)
{
    return (size_t)(HF_TOLERANCE_COLUMNS + q->n_share + (2 * state + is_item) * q->n_column);
}

/* Returns the offset of the counts over all load cases: the largest number of slack cables in one of them, and the
 * number of load cases without a shape. */
enum { HF_SAMPLE_SLACK, HF_SAMPLE_WITHOUT_SHAPE, HF_SAMPLE_COUNTS };
static inline size_t hf_montecarlo_count_at(const hf_required *q)
{
    return hf_montecarlo_value_at(q, q->n_state, false);
}

/* Returns whether samples have a value of this measure. */
bool hf_montecarlo_measures(const hf_surface_settings *surface, const hf_facets *facets, hf_tolerance_measure measure);

/* Solves and measures the samples first to first + n - 1, n <= n_chunk, with all errors multiplied by `scale`. Writes
 * their rows to montecarlo->row. Returns HF_OK; HF_INTERRUPTED when built->stop requests it; HF_NO_MEMORY. */
hf_status hf_montecarlo_run(hf_montecarlo *montecarlo, double scale, long first, int n);

/* Finds the cable whose tension the errors change most, relative to its tension without errors, to first order.
 * *deviation_N becomes the standard deviation of its tension, of 64 samples. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_montecarlo_find_touchiest(const hf_montecarlo *montecarlo, int *cable, double *deviation_N);

/* Limits of the search for a scale: doublings, halvings, and all scales that it tries, including the first. */
enum { HF_SCALE_DOUBLINGS = 10, HF_SCALE_HALVINGS = 7, HF_SCALE_YIELDS = 1 + HF_SCALE_DOUBLINGS + HF_SCALE_HALVINGS };

/* Finds the factor of all errors at which each row of montecarlo->required with a share has that share of the first n
 * samples, by bisection to 1 %. Each factor uses the same random numbers. There is at least one such row. The surface
 * is measured only if a row needs it, because that takes longer than solving a sample.
 *
 * *bound is 0 when *scale is the factor, or when *scale is 0 because not even the nominal net meets the requirements.
 * It is 1 when the factor is at least *scale, the largest one tried (hf_built_errors_largest_scale). It is -1 when the
 * factor is below *scale, the smallest one tried. Returns the status of hf_montecarlo_run. */
hf_status hf_montecarlo_find_scale(hf_montecarlo *montecarlo, int n, double *scale, int *bound);
