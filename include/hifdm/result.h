/* result - what comes of a form-finding: status, measures, why it stopped. Plain values, no pointers. */
#ifndef HIFDM_RESULT_H
#define HIFDM_RESULT_H

#include <hifdm/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* X(name, value, word stored in files). Never renumber. */
#define HF_STOP_REASON_LIST(X)                                                                                         \
    X(NONE, 0, "none")                                                                                                 \
    X(DIRECT, 1, "direct")                 /* no law changes a force density: one solve is the answer */               \
    X(RESIDUAL, 2, "residual")             /* equilibrium and lengths within the tolerances */                         \
    X(RMS_CHANGE, 3, "rms_change")         /* the paper's rule */                                                      \
    X(MAX_ITERATIONS, 4, "max_iterations") /* not converged */                                                         \
    X(ILL_POSED, 5, "ill_posed")           /* see the status */

typedef enum {
#define HF_STOP_REASON_ENUM(name, value, word) HF_STOPPED_##name = value,
    HF_STOP_REASON_LIST(HF_STOP_REASON_ENUM)
#undef HF_STOP_REASON_ENUM
} hf_stop_reason;

const char *hf_stop_reason_word(int reason); /* "unknown" for a foreign value */

/* How the coupling of the net with an elastic truss ended. X(name, value, word stored in files). Never renumber. */
#define HF_COUPLING_STOP_LIST(X)                                                                                       \
    X(NONE, 0, "none")                     /* there is no truss */                                                     \
    X(TOF, 1, "tof")                       /* no attachment moves farther than tof_m any more */                       \
    X(MAX_ITERATIONS, 2, "max_iterations") /* not converged */                                                         \
    X(DIVERGED, 3, "diverged")             /* the steps grow: the truss is too soft */                                 \
    X(NET, 4, "net")                       /* the net has no shape, see the status */

typedef enum {
#define HF_COUPLING_STOP_ENUM(name, value, word) HF_COUPLING_##name = value,
    HF_COUPLING_STOP_LIST(HF_COUPLING_STOP_ENUM)
#undef HF_COUPLING_STOP_ENUM
} hf_coupling_stop;

const char *hf_coupling_stop_word(int stop); /* "unknown" for a foreign value */

/* All zero without a truss. */
typedef struct {
    hf_coupling_stop stop_reason;
    int iterations;            /* form-findings of the loop; passes of the population solver */
    double step_m;             /* largest |F f - r| of an attachment: what the next iteration would move it */
    double ratio;              /* of the last two steps; NaN before there are two */
    double max_displacement_m; /* largest displacement of an attachment */
} hf_coupling_result;

/* Plain values, no pointers. Under a status other than HF_OK and HF_NOT_CONVERGED the measures are NaN. */
typedef struct {
    hf_status status;
    hf_stop_reason stop_reason;
    int iterations;             /* linear solves */
    int culprit;                /* cable (COLLAPSED, NOT_FINITE; NOT_CONVERGED: the one whose rounding stands
                                   in the way), row of D (SINGULAR), chain (STRAIGHT_CHAIN), or -1 */
    double psi_m;               /* Eq. 10 */
    double residual_N;          /* largest nodal force out of balance with every cable at the tension of its law */
    double tension_error;       /* max |T/T*-1| over cables of law tension, 0 without one */
    double length_error;        /* max |l/L*-1| over taut cables of law length, or elastic with L* = l0 (1 + T/EA);
                                   0 without one */
    double inner_tension_ratio; /* max T / min T of the group; NaN when it is empty or a tension is not positive */
    double boundary_tension_ratio;
    double shortest_length_ratio; /* min l / theoretical l over all cables */
    double position_error_m;      /* estimate: largest move of a node in the Newton step that would follow */
    double condition;             /* estimate for the Newton matrix, or D where it has none; INFINITY: singular */
    double backward_error;        /* residual_N over the largest sum of tensions at a node; the three are NaN unless
                                       hf_certify was asked */
    hf_coupling_result coupling;  /* of the net with its truss */
    int n_slack;                  /* cables under HF_SLACK_RATIO of the reference tension */
    int n_loaded_chain;           /* straight chains under lateral load: tensions there mean nothing */
} hf_form_result;

/* The same of each iteration of the coupling. Arrays of `capacity`, owned by the caller; entries beyond are lost. */
typedef struct {
    int capacity, n;
    double *step_m, *psi_m, *max_displacement_m;
} hf_coupling_history;

/* What each iteration looked like. Arrays of `capacity` >= max_iterations, owned by the caller. */
typedef struct {
    int capacity, n;
    double *psi_m, *residual_N, *inner_tension_ratio, *boundary_tension_ratio, *length_error;
    hf_coupling_history coupling;
} hf_history;

#ifdef __cplusplus
}
#endif
#endif
