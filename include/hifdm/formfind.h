/* formfind - force densities -> shape, tensions, residual: classical FDM (Eqs. 1-6), iterative FDM (Eq. 7), HIFDM
 * (Eqs. 7 and 8). One iteration serves all three: the laws of the cables decide. */
#ifndef HIFDM_FORMFIND_H
#define HIFDM_FORMFIND_H

#include <hifdm/workspace.h>

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

/* Set laws, targets and first force densities of the workspace from the model; no support is displaced. */
void hf_form_prepare(const hf_model *model, hf_workspace *workspace);

/* Theoretical positions into position_m, but for the supports that displacement_m has moved. */
void hf_form_place_supports(const hf_model *model, hf_workspace *workspace);

/* Iterate from the workspace's q_N_per_m under its law and target, the attachments moved by displacement_m, until
 * `stop` (hf_stop_rule) or a bound holds. `settings` gives tolerances and bounds only. history may be NULL. Returns
 * result->status; never allocates. */
hf_status hf_form_find(const hf_model *model, const hf_form_settings *settings, int stop, hf_workspace *workspace,
                       hf_history *history, hf_form_result *result);

/* Measure the shape that the workspace holds (position_m, law, target; q_N_per_m for cables under law length or
 * elastic): lengths,
 * tensions by law, residual, all measures of the result. No solve: iterations is 0, the stopping reason RESIDUAL when
 * the residual is within the tolerance, else the status is HF_NOT_CONVERGED. Returns result->status. */
hf_status hf_form_measure(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                          hf_form_result *result);

/* The force density matrix D of q_N_per_m (Eq. 2) into the workspace's band. */
void hf_form_assemble(const hf_model *model, hf_workspace *workspace);

/* Largest nodal force out of balance at the workspace's shape, N; leaves the nodal forces in force_N. */
double hf_form_residual_N(const hf_model *model, hf_workspace *workspace);

/* A cable of law tension or force_density shorter than this part of its theoretical length is gone whatever
 * collapse_ratio says; one this many times longer is what rounding leaves of a singular matrix. */
#define HF_FORM_GONE 1e-12
#define HF_FORM_BLOWN_UP 1e9

/* The end of hf_form_find for an iteration done elsewhere: the workspace holds law, target, and positions that are the
 * solution for q_N_per_m. Measures them and judges the chains. Returns result->status. */
hf_status hf_form_accept(const hf_model *model, const hf_form_settings *settings, hf_stop_reason reason, int iterations,
                         hf_workspace *workspace, hf_form_result *result);

/* The result of a candidate without a shape: the status (an ill-posed one), NaN measures, no culprit. */
void hf_form_refuse(hf_status status, int iterations, hf_form_result *result);

/* The other parts of an iteration of hf_form_find, for a linear solver of one's own and for timing. In order:
 * hf_form_assemble; assemble_loads: the right-hand sides (Eq. 5) into the free rows of position_m, from the supports in
 * its other rows; solve band * x = those rows, for x, y and z; measure_cables: lengths, tensions and the errors against
 * the laws (result->status must be HF_OK before, and says afterwards whether this is a shape; *length_gap is the length
 * error that stopping looks at); hf_form_residual_N; update: Eqs. 7 and 8. */
void hf_form_assemble_loads(const hf_model *model, hf_workspace *workspace);
void hf_form_measure_cables(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                            hf_form_result *result, double *length_gap);
void hf_form_update(const hf_model *model, hf_workspace *workspace);

/* Chains of the model that can be straight in a shape: on a truss all of them, because their supports move. */
int hf_form_n_chain(const hf_model *model);

/* Is chain i straight and under lateral load in the workspace's shape? For naming it. */
int hf_form_chain_is_loaded(const hf_model *model, hf_workspace *workspace, int i_chain);

#ifdef __cplusplus
}
#endif
#endif
