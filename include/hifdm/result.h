/* result - the figures of a form-finding: status, measures and stop reason. All values are plain and contain no
 * pointers.
 * Stability: stable.
 *
 * Each row of HF_RESULT_LIST describes one quantity of a result. The list defines the members of hf_form_result and the
 * attributes in the HDF5 group of each stage. The list also defines the JSON objects of the stages and the data sets in
 * /search/population with one value per individual. The list also defines the columns of `hifdm evaluate`, of the
 * ledger of a sweep and of the merged study. To add a quantity, add a row to the list and the code that computes the
 * quantity. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>
#include <stddef.h>

HF_API_BEGIN

/* Each row X(name, value, word stored in files) defines a reason why a form-finding stopped. Files contain the values.
 * Therefore, never renumber the values. */
#define HF_STOP_REASON_LIST(X)                                                                                         \
    X(NONE, 0, "none")                                                                                                 \
    X(DIRECT, 1, "direct")                 /* no law changes a force density, so one solve is exact */                 \
    X(CONVERGED, 2, "converged")           /* residual and length errors are within their tolerances */                \
    X(RMS_CHANGE, 3, "rms_change")         /* the paper's rule: psi changed by less than its tolerance */              \
    X(MAX_ITERATIONS, 4, "max_iterations") /* the maximum number of iterations was reached without convergence */      \
    X(ILL_POSED, 5, "ill_posed")           /* the net has no shape; see the status */

/* Reason why a form-finding stopped. */
typedef enum {
#define HF_STOP_REASON_ENUM(name, value, word) HF_STOPPED_##name = value,
    HF_STOP_REASON_LIST(HF_STOP_REASON_ENUM)
#undef HF_STOP_REASON_ENUM
} hf_stop_reason;

/* Returns the word for a stop reason as a constant string. Returns "unknown" for other values. */
const char *hf_stop_reason_word(int reason);

/* Each row X(name, value, word stored in files) defines a reason why the coupling of the net with an elastic truss
 * ended. Files contain the values. Therefore, never renumber the values. */
#define HF_COUPLING_STOP_LIST(X)                                                                                       \
    X(NONE, 0, "none")                     /* there is no truss */                                                     \
    X(CONVERGED, 1, "converged")           /* no attachment moves by more than coupling.tof_m */                       \
    X(MAX_ITERATIONS, 2, "max_iterations") /* the maximum number of iterations was reached without convergence */      \
    X(DIVERGED, 3, "diverged")             /* the steps grow because the truss is too soft */                          \
    X(NET, 4, "net")                       /* the net has no shape; see the status */

/* Reason why the coupling ended. */
typedef enum {
#define HF_COUPLING_STOP_ENUM(name, value, word) HF_COUPLING_##name = value,
    HF_COUPLING_STOP_LIST(HF_COUPLING_STOP_ENUM)
#undef HF_COUPLING_STOP_ENUM
} hf_coupling_stop;

/* Returns the word for the reason why a coupling ended, as a constant string. Returns "unknown" for other values. */
const char *hf_coupling_stop_word(int stop);

/* Each row X(name, value, word stored in files, description for the user) defines a certification status of the error
 * bounds of a result (METHOD section 3). Files contain the values. Therefore, never renumber the values. */
#define HF_BOUND_REASON_LIST(X)                                                                                        \
    X(NONE, 0, "none", "no certified bound was computed")                                                              \
    X(CERTIFIED, 1, "certified", "no equilibrium is farther away")                                                     \
    X(STRUTS, 2, "struts", "the net has struts: its energy is not convex")                                             \
    X(TRUSS, 3, "truss", "the flexibility matrix of the truss has a negative eigenvalue")                              \
    X(NO_MATRIX, 4, "no_matrix", "the method has no Newton matrix for these laws")                                     \
    X(NOT_DEFINITE, 5, "not_definite",                                                                                 \
      "the net is so soft in some direction that its stiffness cannot be distinguished from rounding")                 \
    X(NOT_CONTRACTING, 6, "not_contracting", "the shape is too far from an equilibrium")                               \
    X(SLACK_OR_TAUT, 7, "slack_or_taut", "some cable is about to go slack")                                            \
    X(DEPENDENT_LENGTHS, 8, "dependent_lengths", "prescribed lengths depend on each other")                            \
    X(LOOSE, 9, "loose", "no taut cable holds some node, so its position is not unique")

/* The certification status states that the error bounds are certified, or why they are not. */
typedef enum {
#define HF_BOUND_REASON_ENUM(name, value, ...) HF_BOUND_##name = value,
    HF_BOUND_REASON_LIST(HF_BOUND_REASON_ENUM)
#undef HF_BOUND_REASON_ENUM
} hf_bound_reason;

/* The function hf_bound_reason_word returns the word of a bound reason as a constant string. The function
 * hf_bound_reason_meaning returns the meaning of a bound reason as a constant string. For other values,
 * hf_bound_reason_word and hf_bound_reason_meaning return "unknown". */
const char *hf_bound_reason_word(int reason);
const char *hf_bound_reason_meaning(int reason);

/* ---- The list: X(type, member, kind, ...), where ... are designated members of hf_result_field ----
 *
 *   kind          type of the stored value: REAL, INT, or an enumeration of the store
 *   .json         place in the JSON object of a stage; equal places keep the order of the list; omitted: not in JSON
 *   .individual   place among the figures of one individual, which are data sets of /search/population and columns of
 *                 `hifdm evaluate`; omitted: not among them
 *   .key          name in JSON; omitted: the name of the member, which is also that of the HDF5 attribute
 *   .units        unit; omitted: none
 *   .description  description of the data set; omitted: there is no data set
 *
 * HDF5 attributes and columns of the ledger have the order of the list. In JSON, the quantities of a coupling follow
 * the rows with place 4 and precede the rows with place 5. The REAL quantities have values only if the status is HF_OK,
 * HF_NOT_CONVERGED or the status of a violated limit. For all other statuses, the REAL quantities are NaN. If the
 * status of a design (hf_evaluate) is not HF_OK, psi_m and merit are NaN. If a design has no shape
 * (hf_status_has_shape), its tension ratios and its violation are NaN. Notes on single figures:
 *
 *   culprit              HF_COLLAPSED, HF_NOT_FINITE: a cable; HF_SINGULAR: a row of D; HF_STRAIGHT_CHAIN: a chain;
 *                        HF_NOT_CONVERGED: the cable whose rounding prevents convergence; HF_OK and
 *                        HF_NOT_CONVERGED with n_drifting > 0: the row that moves farthest
 *   psi_m                Eq. 10, over the inner nodes that a taut cable holds; NaN if there are no such nodes
 *   residual_N           with every cable at the tension of its law, which is EA (l/l0 - 1) for an elastic cable of
 *                        length l. The iterations adjust a multiplier instead, and length_error shows the difference
 *                        between the two.
 *   length_error         L* = l0 (1 + T/EA) for elastic cables; 0 if no cable has one of these laws
 *   inner_tension_ratio  max T / min T of the group, as in boundary_tension_ratio; INFINITY if a cable of the group is
 *                        slack, NaN if the group is empty or has a strut. n_slack counts the cables of both groups.
 *   violation            sum over boundary cables of 1 - T/t for T < t and of 1 - cap t/T for T > cap t, where
 *                        t^2 = min T max T / cap, and a slack T counts as if barely taut; plus the excess of the shape
 *                        over the limits of optimize.limits
 *   n_loose              these nodes have the positions closest to their target positions at which none of their
 *                        cables is too long. The status of a design with such a node is HF_SINGULAR.
 *   n_drifting           excludes the nodes of n_loose; if it is above 0, position_error_m is NaN
 *   position_error_m     NaN without hf_certify; the same holds for the bounds, condition (INFINITY: singular) and
 *                        backward_error
 *   position_bound_m     holds for the exact double values of laws, loads and supports; NaN unless bound_reason is
 *                        HF_BOUND_CERTIFIED */
#define HF_RESULT_LIST(X)                                                                                              \
    X(hf_status, status, STATUS, .json = 1, .individual = 1,                                                           \
      .description = "ok = feasible; under any other psi is NaN")                                                      \
    X(hf_stop_reason, stop_reason, STOP_REASON, .description = "why the iteration stopped")                            \
    X(int, iterations, INT, .json = 5, .individual = 2, .description = "linear solves")                                \
    X(int, culprit, INT, .description = "what the status is about, see above, or -1")                                  \
    X(double, psi_m, REAL, .json = 2, .individual = 1, .units = "m", .description = "RMS distance of the inner nodes") \
    X(double, residual_N, REAL, .json = 4, .individual = 1, .units = "N",                                              \
      .description = "maximum nodal force out of balance")                                                             \
    X(double, tension_error, REAL, .json = 4, .description = "max |T/T*-1| over cables of law tension; 0: none")       \
    X(double, length_error, REAL, .json = 4, .description = "max |l/L*-1| over taut cables of law length or elastic")  \
    X(double, inner_tension_ratio, REAL, .json = 3, .individual = 1, .description = "maximum over minimum")            \
    X(double, boundary_tension_ratio, REAL, .json = 3, .individual = 1, .description = "maximum over minimum")         \
    X(double, violation, REAL, .individual = 3, .description = "of the limits, summed over cables; 0: none")           \
    X(double, merit, REAL, .individual = 3,                                                                            \
      .description = "root of the sum of (weight x figure)^2; psi_m, in m, without an objective")                      \
    X(double, shortest_length_ratio, REAL, .json = 4,                                                                  \
      .description = "minimum of length over length at the target positions, all cables")                              \
    X(double, position_error_m, REAL, .json = 4, .units = "m",                                                         \
      .description = "estimate: maximum displacement in one more Newton step")                                         \
    X(double, position_bound_m, REAL, .json = 4, .units = "m",                                                         \
      .description = "no node is farther from equilibrium: certified")                                                 \
    X(double, psi_bound_m, REAL, .json = 4, .units = "m",                                                              \
      .description = "psi at equilibrium differs by no more: certified")                                               \
    X(hf_bound_reason, bound_reason, BOUND_REASON, .json = 4, .description = "certified, or why the bounds are NaN")   \
    X(double, condition, REAL, .json = 4, .description = "estimate, of the Newton matrix, or D where there is none")   \
    X(double, backward_error, REAL, .json = 4, .description = "residual_N over the maximum sum of tensions at a node") \
    X(int, n_slack, INT, .json = 5, .key = "slack_cables",                                                             \
      .description = "cables under HF_SLACK_RATIO of the reference tension")                                           \
    X(int, n_loose, INT, .json = 5, .key = "loose_nodes",                                                              \
      .description = "free nodes that no taut cable holds; psi is without them")                                       \
    X(int, n_drifting, INT, .json = 5, .key = "drifting_nodes",                                                        \
      .description = "free nodes that can move without a force: not unique")                                           \
    X(int, n_loaded_chain, INT, .json = 5, .key = "loaded_straight_chains",                                            \
      .description = "chains under lateral load: their tensions mean nothing")

/* This list describes the quantities of the coupling of the net with its truss. */
#define HF_COUPLING_LIST(X)                                                                                            \
    X(hf_coupling_stop, stop_reason, COUPLING_STOP, .json = 4, .description = "how the coupling ended")                \
    X(int, iterations, INT, .json = 1, .description = "form-findings of the loop, or steps in one matrix")             \
    X(double, step_m, REAL, .json = 3, .units = "m",                                                                   \
      .description = "maximum |F f - r| of an attachment: its displacement in the next iteration")                     \
    X(double, ratio, REAL, .json = 3, .description = "of the last two steps; NaN before there are two")                \
    X(double, deflection_max_m, REAL, .json = 2, .units = "m",                                                         \
      .description = "maximum deflection of the truss at an attachment")

#define HF_RESULT_MEMBER(type, member, ...) type member;

/* The figures of a coupling. If the case has no truss, all members of this struct are zero. */
typedef struct {
    HF_COUPLING_LIST(HF_RESULT_MEMBER)
} hf_coupling_result;

/* Contains the quantities of a form-finding or of a design. */
typedef struct {
    HF_RESULT_LIST(HF_RESULT_MEMBER)
    hf_coupling_result coupling;          /* figures of the coupling with the truss */
    double objective[HF_DESIGN_ROWS_MAX]; /* objectives of a design in the order of their rows, each in its own unit */
} hf_form_result;

/* Sets every REAL member of HF_RESULT_LIST to NaN. */
void hf_result_blank(hf_form_result *result);

/* ---- The list at run time ---- */

/* Type of a stored value. */
typedef enum {
    HF_RESULT_REAL,
    HF_RESULT_INT,
    HF_RESULT_STATUS,
    HF_RESULT_STOP_REASON,
    HF_RESULT_COUPLING_STOP,
    HF_RESULT_BOUND_REASON,
    /* The following types occur only in the lists of <hifdm/summary.h> and <hifdm/surface.h>. */
    HF_RESULT_LONG,
    HF_RESULT_FLAG,
    HF_RESULT_TRUTH,
    HF_RESULT_REFINE_STOP,
    HF_RESULT_SOLVER,
    HF_RESULT_SEARCH_STOP,
    /* No list contains the following types. */
    HF_RESULT_UINT64,
    HF_RESULT_CHARS,
    HF_RESULT_SURFACE,
    HF_RESULT_FEED
} hf_result_kind;

/* Describes one row of a list at run time. */
typedef struct {
    const char *name, *key, *units, *description; /* texts of the row; key NULL: the same as name; units NULL: none */
    hf_result_kind kind;                          /* type of the stored value */
    int json, individual; /* place in JSON and place among the figures of an individual; 0: none */
    size_t offset, size;  /* offset and size in bytes of the member in its struct */
} hf_result_field;

/* Initialises an hf_result_field from a row that describes a member of the struct `owner`. */
#define HF_RESULT_FIELD(owner, type, member_, kind_, ...)                                                              \
    {.name = #member_,                                                                                                 \
     .kind = HF_RESULT_##kind_,                                                                                        \
     .offset = offsetof(owner, member_),                                                                               \
     .size = sizeof(type),                                                                                             \
     __VA_ARGS__},

#define HF_RESULT_COUNT(...) +1
/* These constants are the numbers of rows of HF_RESULT_LIST and HF_COUPLING_LIST. The constant HF_RESULT_N_INDIVIDUAL
 * is the number of rows with a place among the quantities of one individual. */
enum {
    HF_RESULT_N = 0 HF_RESULT_LIST(HF_RESULT_COUNT),
    HF_COUPLING_N = 0 HF_COUPLING_LIST(HF_RESULT_COUNT),
    HF_RESULT_N_INDIVIDUAL = 8
};
enum { HF_RESULT_JSON_COUNTS = 5 }; /* first JSON place of the counts, which follow the figures of a coupling */

extern const hf_result_field hf_result_field_of[HF_RESULT_N];     /* rows of HF_RESULT_LIST for hf_form_result */
extern const hf_result_field hf_coupling_field_of[HF_COUPLING_N]; /* rows of HF_COUPLING_LIST for hf_coupling_result */

/* Returns the JSON name of a quantity. */
const char *hf_result_key(const hf_result_field *field);

/* Writes pointers to the rows with a place among the quantities of one individual to `field`, in the order of these
 * places. The rows are constants of the library. */
void hf_result_list_individual(const hf_result_field *field[HF_RESULT_N_INDIVIDUAL]);

/* ---- History of the iterations ---- */

/* Contains the quantities of each iteration of the coupling. The caller owns the arrays. Each array has space for
 * `capacity` items. The arrays do not record iterations beyond `capacity`. */
typedef struct {
    int capacity, n; /* capacity of the arrays, and number of recorded iterations */
    /* [capacity] step |F f - r|, psi, and maximum deflection of the attachments, m */
    double *step_m, *psi_m, *deflection_max_m;
} hf_coupling_history;

/* Contains the quantities of each iteration of a form-finding. The caller owns the arrays. Each array has space for
 * `capacity` items. The arrays do not record iterations beyond `capacity`. */
typedef struct {
    int capacity, n; /* capacity of the arrays, and number of recorded iterations */
    /* [capacity] figures of HF_RESULT_LIST of each iteration */
    double *psi_m, *residual_N, *inner_tension_ratio, *boundary_tension_ratio, *length_error;
    hf_coupling_history coupling; /* history of the coupling */
} hf_history;

HF_API_END
