/* errors - the errors of an as-built net as independent random numbers of mean 0 and standard deviation 1 (METHOD
 * section 12). The functions turn these numbers into cut lengths, stiffnesses and supports, or into first-order changes
 * of tensions.
 *
 * Errors are numbered by kind. A number depends on (seed, sample, kind, item) alone. Other kinds of errors and the
 * order of nodes in the model do not change it. */
#pragma once

#include "built/linear.h"
#include <hifdm/built_batch.h>

/* X(name, word, items of a kind). A relative error is the sum of the cable's own one and of its spool's, which all
 * cables of the spool share. */
#define HF_ERROR_KINDS(X)                                                                                              \
    X(CUT, "cut_m", "cables")                                                                                          \
    X(RATIO, "cut_ratio", "cables")                                                                                    \
    X(RATIO_BATCH, "cut_ratio_batch", "spools")                                                                        \
    X(EA, "EA_ratio", "cables")                                                                                        \
    X(EA_BATCH, "EA_ratio_batch", "spools")                                                                            \
    X(SUPPORT, "support_m", "coordinates of supports")                                                                 \
    X(TEMPERATURE, "temperature_K", "one for all cables")                                                              \
    X(TRUSS_TEMPERATURE, "truss_temperature_K", "parts of the truss")

#define HF_ERROR_ENUMERATOR(name, word, items) HF_ERROR_##name,
typedef enum { HF_ERROR_KINDS(HF_ERROR_ENUMERATOR) HF_ERROR_N_KIND } hf_error_kind;
#undef HF_ERROR_ENUMERATOR

/* Kinds of random numbers below this one belong to errors, others are free for other uses. Temperatures of the truss
 * have the kind HF_ERROR_TEMPERATURE and the items 1 + part. */
#define HF_ERROR_STREAMS HF_ERROR_TRUSS_TEMPERATURE

/* X(name, word, units, description): the errors of what a load case prescribes, one of each kind for each sample and
 * load case. They change no net without a load case, so they are not among the numbers z. */
#define HF_LOAD_ERRORS(X)                                                                                              \
    X(TEMPERATURE, "temperature_error_K", "K", "error of the temperature of all cables in this load case")             \
    X(GRAVITY, "gravity_error_ratio", "", "error of gravity in this load case, relative to it")                        \
    X(FORCE, "force_error_ratio", "", "error of the forces in this load case, relative to them")

#define HF_LOAD_ERROR_ENUMERATOR(name, word, units, description) HF_LOAD_ERROR_##name,
typedef enum { HF_LOAD_ERRORS(HF_LOAD_ERROR_ENUMERATOR) HF_LOAD_ERROR_N } hf_load_error;
#undef HF_LOAD_ERROR_ENUMERATOR

/* Their kinds of random numbers begin here; the item is the number of the load case. */
enum { HF_LOAD_ERROR_STREAMS = 12 };

/* Describes the effects of temperatures. A member is NULL when its temperatures do not vary. */
typedef struct {
    const double *expansion_per_K; /* [n_cable] of cables, needed if one of their sigmas is above 0 */
    /* [n_truss][3 n_attachment] displacements of the attachments without forces, for each row of tolerance.truss. */
    const double *truss_move_m_per_K;
} hf_built_heat;

typedef struct {
    const hf_built_linear *linear;
    hf_distribution distribution;
    uint64_t seed;
    double sigma_load[HF_LOAD_ERROR_N]; /* standard deviation of each error of load cases; 0: there is none */
    double sigma[HF_ERROR_N_KIND];      /* standard deviation of each kind; 0: it has no errors */
    int first[HF_ERROR_N_KIND + 1];     /* first error of each kind; the last entry is the number of all errors */
    int n_spool, *spool;                /* spools, and [n_cable] spool of each cable */
    int n_support, *support;            /* [n_support] nodes of the scene, ascending */
    double *expansion_per_K;            /* [n_cable] thermal expansion of each cable */
    int n_truss, part[HF_TRUSS_HEAT_ROWS_MAX]; /* part of each row of tolerance.truss */
    double *truss_move_m; /* [n_truss][3 n_attachment] displacements of the attachments by one sigma */
    void *block;
} hf_built_errors;

/* Makes the errors that `settings` describes, for the net of `linear`. Both `linear` and its net are borrowed. The
 * spool of a cable is the first set, in the order of names, that has the cable, or else its group. heat is NULL when no
 * temperature varies. Returns HF_OK or HF_NO_MEMORY; the caller frees its block in any case. */
hf_status hf_built_errors_make(const hf_built_linear *linear, const hf_tolerance_settings *settings,
                               const hf_built_heat *heat, hf_built_errors *errors);

static inline int hf_built_errors_count(const hf_built_errors *errors)
{
    return errors->first[HF_ERROR_N_KIND];
}

/* Returns which properties of a net vary beside its cut lengths, as flags HF_BUILT_VARIES_... */
unsigned hf_built_errors_vary(const hf_built_errors *errors);

hf_error_kind hf_built_errors_kind(const hf_built_errors *errors, int i_error);

/* Returns the cable to which an error belongs, or -1 for an error that is not a cable's own. */
int hf_built_errors_cable(const hf_built_errors *errors, int i_error);

/* hf_built_errors_uniform returns a uniform random number in (0, 1). hf_built_errors_shape transforms it to the
 * distribution with mean 0 and standard deviation 1. */
double hf_built_errors_uniform(uint64_t seed, long sample, int kind, int item);
double hf_built_errors_shape(hf_distribution distribution, double uniform);

/* Returns the largest factor of all errors that leaves at least half of each cut length and of each EA. It assumes
 * numbers up to 6 sigma, or up to the maximum of uniform ones. Returns INFINITY when neither varies. */
double hf_built_errors_largest_scale(const hf_built_errors *errors);

/* Draws the numbers z [n] of a sample. */
void hf_built_errors_draw(const hf_built_errors *errors, long sample, double *z);

/* Returns the error of this kind in load case i_load_case, in units of the kind, of a sample. */
double hf_built_errors_of_load(const hf_built_errors *errors, long sample, hf_load_error kind, int i_load_case);

/* Applies the numbers z, times `scale`, to the nominal values in cut_m and EA_N [n_cable], and adds them to
 * support_displacement_m [3][n_node] by row. EA_N and support_displacement_m may be NULL when they do not vary. */
void hf_built_errors_apply(const hf_built_errors *errors, double scale, const double *z, double *cut_m, double *EA_N,
                           double *support_displacement_m);

/* Computes the first-order effect of the numbers z, times `scale`, as hf_built_linear_apply expects it: strain_N
 * [n_cable], move_m [n_dof]. */
void hf_built_errors_strain(const hf_built_errors *errors, double scale, const double *z, double *strain_N,
                            double *move_m);

/* Computes the transpose of hf_built_errors_strain: from the output of hf_built_linear_transpose to the derivatives
 * with respect to the numbers, slope_z [n]. */
void hf_built_errors_slope(const hf_built_errors *errors, const double *strain, const double *slope, double *slope_z);
