/* errors - the errors of a net as built, as independent numbers of mean 0 and deviation 1: what they make of cut
 * lengths, stiffnesses and supports, and to first order of tensions (METHOD section 12).
 *
 * Errors are numbered by kind. A number depends on (seed, sample, kind, item) alone: neither a kind that is added nor
 * the order of nodes in the model changes the others. */
#ifndef HIFDM_ERRORS_H
#define HIFDM_ERRORS_H

#include "built/linear.h"
#include <hifdm/built_batch.h>

/* X(name, word, items of a kind). An error of a ratio is the sum of that of the cable and that of its spool, which all
 * its cables share. */
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

/* Kinds of numbers below it are errors, others are free for other numbers: temperatures of the truss are of the kind of
 * that of the cables, items 1 + part. */
#define HF_ERROR_STREAMS HF_ERROR_TRUSS_TEMPERATURE

/* What temperatures do. Both NULL: nothing of the kind varies. */
typedef struct {
    const double *expansion_per_K; /* [n_cable] of cables, needed with sigma_temperature_K */
    const double
        *truss_move_m_per_K; /* [n_truss][3 n_attachment] of attachments without any force, by tolerance.truss */
} hf_built_heat;

typedef struct {
    const hf_built_linear *linear;
    hf_distribution distribution;
    uint64_t seed;
    double sigma[HF_ERROR_N_KIND];  /* of each kind; 0: there are none */
    int first[HF_ERROR_N_KIND + 1]; /* numbers of the errors of each kind; the last entry is the number of all */
    int n_spool, *spool;            /* [n_cable] spool of each cable */
    int n_support, *support;        /* [n_support] nodes of the scene, ascending */
    double *expansion_per_K;        /* [n_cable] */
    int n_truss, part[HF_TRUSS_HEAT_ROWS_MAX]; /* of each row, as in settings */
    double *truss_move_m;                      /* [n_truss][3 n_attachment] of attachments, by one sigma */
    void *block;
} hf_built_errors;

/* A spool is a set of cables: the first in the order of names that has the cable, or else its group.
 * heat: NULL where none varies.
 * HF_OK or HF_NO_MEMORY; free in any case. */
hf_status hf_built_errors_make(const hf_built_linear *linear, const hf_tolerance_settings *settings,
                               const hf_built_heat *heat, hf_built_errors *errors);
void hf_built_errors_free(hf_built_errors *errors);

static inline int hf_built_errors_count(const hf_built_errors *errors)
{
    return errors->first[HF_ERROR_N_KIND];
}

/* What of a net they change beside lengths: flags HF_BUILT_VARIES_... */
unsigned hf_built_errors_vary(const hf_built_errors *errors);

hf_error_kind hf_built_errors_kind(const hf_built_errors *errors, int i_error);

/* The cable that error i_error is of, or -1. */
int hf_built_errors_cable(const hf_built_errors *errors, int i_error);

/* A number in (0, 1), uniform, and what the distribution makes of it. */
double hf_built_errors_uniform(uint64_t seed, long sample, int kind, int item);
double hf_built_errors_shape(hf_distribution distribution, double uniform);

/* The largest factor of all errors that leaves at least half of each cut length and of each EA, for numbers up to 6, or
 * up to the largest of uniform ones. INFINITY where neither varies. */
double hf_built_errors_largest_scale(const hf_built_errors *errors);

/* The numbers z [n] of a sample. */
void hf_built_errors_draw(const hf_built_errors *errors, long sample, double *z);

/* What numbers times `scale` change in the nominal cut_m, EA_N [n_cable] (NULL: EA does not vary), and support_move_m
 * [3][n_node] by row (NULL: supports do not). */
void hf_built_errors_apply(const hf_built_errors *errors, double scale, const double *z, double *cut_m, double *EA_N,
                           double *support_move_m);

/* The same to first order, as hf_built_linear_apply takes it: strain_N [n_cable], move_m [n_dof]. */
void hf_built_errors_strain(const hf_built_errors *errors, double scale, const double *z, double *strain_N,
                            double *move_m);

/* The transpose: from what hf_built_linear_transpose gives to derivatives with respect to the numbers, slope_z [n]. */
void hf_built_errors_slope(const hf_built_errors *errors, const double *strain, const double *slope, double *slope_z);

#endif
