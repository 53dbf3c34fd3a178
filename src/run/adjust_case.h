/* adjust_case - estimates the errors of cutting lengths of a case from measured positions of its as-built net, and
 * finds the turnbuckle adjustments that restore its figure. */
#pragma once

#include "built/adjust.h"
#include "built/loaded.h"
#include "built/measured.h"
#include "built/prior.h"
#include "run/problem_parts.h"

#define HF_ADJUST_CASE_STANDS_OUT 3.0 /* sigmas above which an error is reported */
#define HF_ADJUST_CASE_OFF 4.0 /* sigmas above which a measured position is reported; one in a thousand is by chance */
/* The maximum number of other aims. */
enum { HF_ADJUST_CASE_INSTEAD = 3 };

/* What adjustments with another figure or aim would reach. */
typedef struct {
    hf_figure_kind figure;
    hf_aim aim;
    double before_m, after_m; /* value of the figure at the estimated shape, and after the adjustments */
    int n_turnbuckle, n_at_range;
} hf_adjust_case_instead;

/* What the adjustments do to the net in a load case. NaN: it has no shape. */
typedef struct {
    const char *load_case;          /* "nominal": none */
    double estimated_m, adjusted_m; /* figure before and after the adjustments */
    double tension_min_N;           /* minimum tension after them */
    int n_slack;                    /* slack cables after them */
} hf_adjust_case_prediction;

/* An item of a list that is sorted by size. */
typedef struct {
    double size;
    int at;
} hf_adjust_case_sized;

/* A measured net and what was found of it. A program that prints reads it; adjust_case.c alone writes it, except for
 * `built`. */
typedef struct {
    hf_problem problem;
    hf_built built;        /* of the design */
    const char *load_case; /* of the measurement, borrowed; NULL: none */
    int i_load_case;       /* its number, -1: none */
    hf_built_loaded loaded;
    hf_built *net; /* the net without errors as it was measured: `built`, or that in the load case */
    hf_measured measured;
    const char *path, *measured_path; /* of the case and of the table of positions; borrowed */
    int threads;
    hf_estimate estimate;
    hf_objectives objectives;
    hf_adjustment adjustment;
    hf_adjust_task task;
    int *cable; /* [n_cable], cables of the task */
    hf_prior prior;
    double *least_N;                  /* [n_cable], minimum tensions that the case demands */
    double *expected_m;               /* [n_node], RMS displacement of each node by errors */
    double measured_m;                /* psi of the measured inner nodes; NaN for other figures */
    int n_out, *out;                  /* [n_out], cables whose errors stand out, worst first */
    double *by_places_m;              /* [n_out], errors by positions alone, without own sigmas; NaN: not known */
    int n_far, *far_row;              /* [n_far], rows of measured nodes far from the estimated shape, worst first */
    hf_adjust_case_sized *sized;      /* [max(n_cable, n_node)], scratch */
    double design_psi_m, error_psi_m; /* psi of the design from target positions; RMS of the effect of errors */
    int n_at_range;                   /* number of adjustments that reach the range */
    int n_instead;
    hf_adjust_case_instead instead[HF_ADJUST_CASE_INSTEAD]; /* [n_instead], other aims */
    int n_prediction;
    hf_adjust_case_prediction prediction[1 + HF_LOAD_CASES_MAX]; /* [n_prediction], in other load cases */
    double *rest_m; /* [n_load_case][3 n_attachment], displacements of the attachments by the truss alone */
    void *block, *rest_block;
} hf_adjust_case;

/* Loads the case and checks that it has the sections for an adjustment. *adjust must be zero on entry. load_case is the
 * name of the load case of the measurement, NULL for none. The texts are borrowed. Returns HF_OK; HF_BAD_CASE with all
 * faults; HF_BAD_USAGE for an unknown load case; or the status of another failure. The caller calls
 * hf_adjust_case_free in any case. */
hf_status hf_adjust_case_load(const char *path, const char *const *set, int n_set, const char *load_case,
                              hf_adjust_case *adjust, hf_messages *messages);

/* Picks the cables with turnbuckles and reads the measured positions. Returns HF_OK, HF_BAD_CASE, HF_IO or
 * HF_NO_MEMORY. */
hf_status hf_adjust_case_read(const char *measured_path, int threads, hf_adjust_case *adjust, hf_messages *messages);

/* Estimates the errors and finds the adjustments, after the caller has made adjust->built. Returns HF_OK, also if no
 * adjustment is worthwhile; HF_BAD_CASE, HF_INTERRUPTED, HF_NO_MEMORY, or the status of a shape that failed. */
hf_status hf_adjust_case_find(hf_adjust_case *adjust, hf_messages *messages);

void hf_adjust_case_free(hf_adjust_case *adjust);

/* Returns chi^2 per coordinate. Its mean is 1 if the sigmas of errors and positions are right, whatever was
 * measured. */
double hf_adjust_case_chi_square(const hf_adjust_case *adjust);

/* Returns true if chi^2 can be due to chance. */
bool hf_adjust_case_fits(const hf_adjust_case *adjust);

/* Returns the estimated error of a cable divided by its sigma; 0 for a cable without a sigma. */
double hf_adjust_case_sigmas(const hf_adjust_case *adjust, int cable);

/* Returns the distance of a measured node from the estimated shape, m. */
double hf_adjust_case_off_m(const hf_adjust_case *adjust, int row);
/* Returns this distance divided by the sigma of the measurement. */
double hf_adjust_case_off_sigmas(const hf_adjust_case *adjust, int row);
