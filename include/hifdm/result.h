/* result - what a form-finding gives: status, measures, why it stopped. Plain values, no pointers.
 * Stability: stable.
 *
 * HF_RESULT_LIST is the one list of the figures of a result. From it come the members of hf_form_result, the attributes
 * of /form, best_... of /ga and those of /polish, the data sets of /ga with a value per individual, the columns of a
 * sweep's ledger and of the merged study, the JSON objects of the stages (which the report shows), and the columns of
 * `evaluate`. A new figure is a row here and the code that computes it. */
#ifndef HIFDM_RESULT_H
#define HIFDM_RESULT_H

#include <hifdm/api.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>
#include <stddef.h>

HF_API_BEGIN

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

/* Whether the bounds of a result are proven, and if not, why. X(name, value, word stored in files, what it means).
 * Never renumber. */
#define HF_BOUND_REASON_LIST(X)                                                                                        \
    X(NONE, 0, "none", "no proof was tried")                                                                           \
    X(PROVEN, 1, "proven", "no equilibrium is farther away")                                                           \
    X(STRUTS, 2, "struts", "the net has struts: its energy is not convex")                                             \
    X(TRUSS, 3, "truss", "the flexibility of the truss has an eigenvalue below zero")                                  \
    X(NO_MATRIX, 4, "no_matrix", "the method has no Newton matrix for these laws")                                     \
    X(NOT_DEFINITE, 5, "not_definite", "the net is too soft in some direction to tell its stiffness from rounding")    \
    X(NOT_CONTRACTING, 6, "not_contracting", "the shape is too far from an equilibrium")                               \
    X(SLACK_OR_TAUT, 7, "slack_or_taut", "some cable is at the brink of going slack")                                  \
    X(DEPENDENT_LENGTHS, 8, "dependent_lengths", "prescribed lengths depend on each other")                            \
    X(LOOSE, 9, "loose", "no taut cable holds some node: its position is not unique")

typedef enum {
#define HF_BOUND_REASON_ENUM(name, value, word, meaning) HF_BOUND_##name = value,
    HF_BOUND_REASON_LIST(HF_BOUND_REASON_ENUM)
#undef HF_BOUND_REASON_ENUM
} hf_bound_reason;

const char *hf_bound_reason_word(int reason);    /* "unknown" for a foreign value */
const char *hf_bound_reason_meaning(int reason); /* the same */

/* ---- The list: X(type, member, kind, json, individual, key, units, description) ----
 *
 * kind         of the stored value (REAL, INT, or an enumeration of the store's layout)
 * json         place in the JSON object of a stage; equal places are in the order of the list; 0 = not there
 * individual   place among the figures of one individual (data sets of /ga, columns of `evaluate`); 0 = not there
 * key          in JSON; the attribute has the name of the member
 * description  attribute of the data set, where there is one
 *
 * Attributes and columns of the ledger are in the order of the list. JSON has the figures of a coupling between places
 * 4 and 5. Under a status other than HF_OK, HF_NOT_CONVERGED and those of a broken limit the REAL ones are NaN. Of a
 * design of hf_evaluate under any status but HF_OK psi_m and merit are NaN, and without a shape (hf_status_has_shape)
 * the two tension ratios and the violation are. In more detail:
 *   culprit                 cable (COLLAPSED, NOT_FINITE; NOT_CONVERGED: the one whose rounding stands in the way), row
 *                           of D (SINGULAR), chain (STRAIGHT_CHAIN)
 *                           OK, NOT_CONVERGED: with n_drifting > 0, the row that moves farthest
 *   psi_m                   Eq. 10, of the inner nodes that a taut cable holds; NaN when none does
 *   residual_N              with every cable at the tension of its law: of an elastic one EA (l/l0 - 1) at its length
 *                           l, not the multiplier that the iterations balance and of which length_error speaks
 *   length_error            for elastic cables L* = l0 (1 + T/EA); 0 without a cable of these laws
 *   inner_tension_ratio     max T / min T of the group, as boundary_tension_ratio; INFINITY when a cable of it is slack
 *                           (n_slack counts those of both groups), NaN when the group is empty or has a strut
 *   violation               sum over boundary cables of 1 - T/t below t and 1 - cap t/T above cap t, where t^2 = min T
 *                           max T / cap, with a slack T as if just taut; and what shapes are beyond optimize.limits;
 *                           NaN for what is no design
 *   n_loose                 such nodes are where no cable of theirs is too long, as near to their theoretical places as
 *                           that allows. A design (hf_evaluate) with such a node is SINGULAR
 *   n_drifting              others than those; position_error_m is then NaN
 *   position_error_m        this one, the bounds, condition (INFINITY: singular) and backward_error are NaN unless
 *                           hf_certify was called
 *   position_bound_m        for the exact values of laws, loads and supports as doubles (METHOD section 3); NaN when
 *                           bound_reason is not PROVEN */
#define HF_RESULT_LIST(X)                                                                                              \
    X(hf_status, status, STATUS, 1, 1, "status", "", "ok = feasible; under any other psi is NaN")                      \
    X(hf_stop_reason, stop_reason, STOP_REASON, 0, 0, "stop_reason", "", "why the iteration stopped")                  \
    X(int, iterations, INT, 5, 2, "iterations", "", "linear solves")                                                   \
    X(int, culprit, INT, 0, 0, "culprit", "", "what the status is about, see above, or -1")                            \
    X(double, psi_m, REAL, 2, 1, "psi_m", "m", "RMS distance of the inner nodes")                                      \
    X(double, residual_N, REAL, 4, 1, "residual_N", "N", "largest nodal force out of balance")                         \
    X(double, tension_error, REAL, 4, 0, "tension_error", "", "max |T/T*-1| over cables of law tension; 0: none")      \
    X(double, length_error, REAL, 4, 0, "length_error", "", "max |l/L*-1| over taut cables of law length or elastic")  \
    X(double, inner_tension_ratio, REAL, 3, 1, "inner_tension_ratio", "", "largest over smallest")                     \
    X(double, boundary_tension_ratio, REAL, 3, 1, "boundary_tension_ratio", "", "largest over smallest")               \
    X(double, violation, REAL, 0, 3, "violation", "", "of the limits, summed over cables; 0: none")                    \
    X(double, merit, REAL, 0, 3, "merit", "", "root of the sum of (weight x goal)^2; psi_m, in m, without goals")      \
    X(double, shortest_length_ratio, REAL, 4, 0, "shortest_length_ratio", "", "min l / theoretical l over all cables") \
    X(double, position_error_m, REAL, 4, 0, "position_error_m", "m", "estimate: largest move in one more Newton step") \
    X(double, position_bound_m, REAL, 4, 0, "position_bound_m", "m", "no node is farther from equilibrium: proven")    \
    X(double, psi_bound_m, REAL, 4, 0, "psi_bound_m", "m", "psi at equilibrium differs by no more: proven")            \
    X(hf_bound_reason, bound_reason, BOUND_REASON, 4, 0, "bound_reason", "", "proven, or why the bounds are NaN")      \
    X(double, condition, REAL, 4, 0, "condition", "", "estimate, of the Newton matrix, or D where there is none")      \
    X(double, backward_error, REAL, 4, 0, "backward_error", "",                                                        \
      "residual_N over the largest sum of tensions at a node")                                                         \
    X(int, n_slack, INT, 5, 0, "slack_cables", "", "cables under HF_SLACK_RATIO of the reference tension")             \
    X(int, n_loose, INT, 5, 0, "loose_nodes", "", "free nodes that no taut cable holds; psi is without them")          \
    X(int, n_drifting, INT, 5, 0, "drifting_nodes", "", "free nodes that can move without a force: not unique")        \
    X(int, n_loaded_chain, INT, 5, 0, "loaded_straight_chains", "",                                                    \
      "chains under lateral load: their tensions mean nothing")

/* The same list for the coupling of the net with its truss. */
#define HF_COUPLING_LIST(X)                                                                                            \
    X(hf_coupling_stop, stop_reason, COUPLING_STOP, 4, 0, "stop_reason", "", "how the coupling ended")                 \
    X(int, iterations, INT, 1, 0, "iterations", "", "form-findings of the loop, or steps in one matrix")               \
    X(double, step_m, REAL, 3, 0, "step_m", "m", "largest |F f - r| of an attachment: its move in the next iteration") \
    X(double, ratio, REAL, 3, 0, "ratio", "", "of the last two steps; NaN before there are two")                       \
    X(double, max_displacement_m, REAL, 2, 0, "max_displacement_m", "m", "largest displacement of an attachment")

#define HF_RESULT_MEMBER(type, member, kind, json, individual, key, units, description) type member;

/* All zero without a truss. */
typedef struct {
    HF_COUPLING_LIST(HF_RESULT_MEMBER)
} hf_coupling_result;

typedef struct {
    HF_RESULT_LIST(HF_RESULT_MEMBER)
    hf_coupling_result coupling;
    double goal[HF_DESIGN_ROWS_MAX]; /* of a design with goals: each in its own unit, in the order of optimize.goals */
} hf_form_result;

/* Set every REAL member of HF_RESULT_LIST to NaN. */
void hf_result_blank(hf_form_result *result);

/* ---- The list at run time ---- */

typedef enum {
    HF_RESULT_REAL,
    HF_RESULT_INT,
    HF_RESULT_STATUS,
    HF_RESULT_STOP_REASON,
    HF_RESULT_COUPLING_STOP,
    HF_RESULT_BOUND_REASON,
    /* only in the lists of <hifdm/summary.h> and <hifdm/surface.h> */
    HF_RESULT_LONG,
    HF_RESULT_FLAG,
    HF_RESULT_TRUTH,
    HF_RESULT_POLISH_STOP,
    HF_RESULT_SOLVER,
    HF_RESULT_GA_STOP
} hf_result_kind;

typedef struct {
    const char *name, *key, *units, *description;
    hf_result_kind kind;
    int json, individual;
    size_t offset, size; /* in its struct */
} hf_result_field;

#define HF_RESULT_COUNT(type, member, kind, json, individual, key, units, description) +1
#define HF_RESULT_COUNT_INDIVIDUAL(type, member, kind, json, individual, key, units, description) +(individual > 0)
enum {
    HF_RESULT_N = 0 HF_RESULT_LIST(HF_RESULT_COUNT),
    HF_COUPLING_N = 0 HF_COUPLING_LIST(HF_RESULT_COUNT),
    HF_RESULT_N_INDIVIDUAL = 0 HF_RESULT_LIST(HF_RESULT_COUNT_INDIVIDUAL)
};
enum { HF_RESULT_JSON_COUNTS = 5 }; /* first JSON place of the counts, which follow the figures of a coupling */

extern const hf_result_field hf_result_field_of[HF_RESULT_N];     /* of hf_form_result */
extern const hf_result_field hf_coupling_field_of[HF_COUPLING_N]; /* of hf_coupling_result */

/* The fields with a place among the figures of one individual, in that order. */
void hf_result_list_individual(const hf_result_field *field[HF_RESULT_N_INDIVIDUAL]);

/* ---- History of the iterations ---- */

/* Figures of each iteration of the coupling: arrays of `capacity`, owned by the caller. Iterations beyond the capacity
 * are not kept. */
typedef struct {
    int capacity, n;
    double *step_m, *psi_m, *max_displacement_m;
} hf_coupling_history;

/* Figures of each iteration of the form-finding: arrays of `capacity` >= max_iterations, owned by the caller. */
typedef struct {
    int capacity, n;
    double *psi_m, *residual_N, *inner_tension_ratio, *boundary_tension_ratio, *length_error;
    hf_coupling_history coupling;
} hf_history;

HF_API_END
#endif
