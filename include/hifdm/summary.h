/* summary - the figures of a whole run.
 * Stability: stable.
 *
 * `run` prints them and stores them with the results; `show` prints them again. The figures of a result (form, best,
 * polish) are those of HF_RESULT_LIST in <hifdm/result.h>. */
#ifndef HIFDM_SUMMARY_H
#define HIFDM_SUMMARY_H

#include <hifdm/api.h>
#include <hifdm/cable_set.h>
#include <hifdm/front.h>
#include <hifdm/optimiser.h>
#include <hifdm/pattern.h>
#include <hifdm/surface.h>
#include <hifdm/tolerance.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

HF_API_BEGIN

#define HF_WARNINGS_SIZE 4096 /* bytes of the text of warnings */

/* ---- The lists: rows as in HF_RESULT_LIST, without .individual and .units ----
 *
 *   .json   place in the JSON object of the stage, after the figures of its result
 *
 * The lists define the members of hf_summary and the JSON objects. In their own order they define the attributes in
 * HDF5 and the columns of a sweep's ledger. A new figure of a run is a row here and the code that computes it. */

/* The net and the form-finding. */
#define HF_SUMMARY_FORM_LIST(X)                                                                                        \
    X(int, n_node, INT, .description = "nodes")                                                                        \
    X(int, n_free, INT, .description = "nodes that are no supports")                                                   \
    X(int, n_cable, INT, .description = "cables")                                                                      \
    X(int, n_gene, INT, .description = "variables: pretensions of boundary cables, or what optimize.variables says")   \
    X(int, half_bandwidth, INT, .description = "of the force density matrix")                                          \
    X(double, pretension_N, REAL, .description = "of the case, N")                                                     \
    X(bool, has_own_tensions, TRUTH, .description = "1: no cable takes pretension_N, by the laws of all")              \
    X(double, form_wall_s, REAL, .json = 1, .key = "wall_s", .description = "of the form-finding")

/* The genetic algorithm. */
#define HF_SUMMARY_SEARCH_LIST(X)                                                                                      \
    X(hf_solver, solver, SOLVER, .json = 6, .description = "of the individuals")                                       \
    X(double, base_psi_m, REAL, .json = 2,                                                                             \
      .description = "of individual 0 of generation 0, the tensions found under the rule; NaN if infeasible")          \
    X(int, n_leader, INT, .json = 5, .key = "independent_genes", .description = "independent genes")                   \
    X(int, planes, INT, .description = "HF_PLANE_ bits of the symmetry (1 = x, 2 = y) that links the others")          \
    X(int, best_generation, INT, .json = 3, .description = "where the best was found, counted from 0")                 \
    X(int, best_individual, INT, .json = 3, .description = "which individual of that generation, counted from 0")      \
    X(int, generations, INT, .json = 1, .description = "number finished")                                              \
    X(long, evaluations, LONG, .json = 1, .description = "form-findings")                                              \
    X(long, infeasible, LONG, .json = 1, .description = "those without a feasible shape among them")                   \
    X(int, best_n_at_lower, INT, .json = 3, .key = "at_lower_bound",                                                   \
      .description = "genes of the best at their lower bounds")                                                        \
    X(int, best_n_at_upper, INT, .json = 3, .key = "at_upper_bound",                                                   \
      .description = "genes of the best at their upper bounds")                                                        \
    X(hf_population_stop, optimize_stop, SEARCH_STOP, .json = 7, .key = "stop_reason", .description = "why it ended")  \
    X(double, optimize_wall_s, REAL, .json = 4, .key = "wall_s", .description = "wall-clock time")                     \
    X(double, optimize_cpu_s, REAL, .json = 4, .key = "cpu_s",                                                         \
      .description = "breeding, evaluating and storing, over all threads; without waiting")                            \
    X(double, store_cpu_s, REAL, .json = 4, .description = "storing alone")

/* Levenberg-Marquardt. */
#define HF_SUMMARY_REFINE_LIST(X)                                                                                      \
    X(bool, polish_is_result, FLAG, .json = 2, .key = "is_result",                                                     \
      .description = "its design is the result, not only a comparison")                                                \
    X(int, polish_iterations, INT, .json = 1, .key = "lm_iterations", .description = "steps of Levenberg-Marquardt")   \
    X(int, polish_evaluations, INT, .json = 1, .key = "evaluations", .description = "form-findings")                   \
    X(hf_refine_stop, polish_stop, REFINE_STOP, .json = 4, .key = "stop_reason", .description = "why it ended")        \
    X(int, polish_n_at_lower, INT, .json = 5, .key = "at_lower_bound", .description = "genes at their lower bounds")   \
    X(int, polish_n_at_upper, INT, .json = 5, .key = "at_upper_bound", .description = "genes at their upper bounds")   \
    X(bool, polish_is_at_cap, FLAG, .json = 5, .key = "at_ratio_cap",                                                  \
      .description = "the cap on the boundary tension ratio holds it")                                                 \
    X(int, polish_n_at_limit, INT, .json = 5, .key = "at_limit",                                                       \
      .description = "limits of optimize.limits that hold it, cable by cable")                                         \
    X(double, polish_wall_s, REAL, .json = 3, .key = "wall_s", .description = "wall-clock time")

/* A load case of the as-built net (`cases`), besides the figures of its result. */
#define HF_LOAD_CASE_LIST(X)                                                                                           \
    X(double, least_tension_N, REAL, .json = 1, .description = "least tension of all cables")                          \
    X(double, largest_tension_N, REAL, .json = 1, .description = "largest tension of all cables")                      \
    X(double, move_rms_m, REAL, .json = 2,                                                                             \
      .description = "RMS of how far the inner nodes are from their places in the design")                             \
    X(double, largest_member_N, REAL, .json = 3, .description = "largest axial force of a truss member; NaN: no truss")

/* The truss. */
#define HF_SUMMARY_TRUSS_LIST(X)                                                                                       \
    X(double, mass_kg, REAL, .json = 1, .description = "mass of members and hinges")                                   \
    X(int, n_node, INT, .json = 1, .key = "nodes", .description = "nodes of the truss")                                \
    X(int, n_member, INT, .json = 1, .key = "members", .description = "members of the truss")

/* Maximum number of sets in hf_set_tensions, for which a page has room. */
#define HF_SUMMARY_SETS 16

/* Tensions of the named sets of cables in one shape, for the first HF_SUMMARY_SETS sets of the net. The ratio is that
 * of hf_metrics_set_ratio. */
typedef struct {
    int n;                                              /* number of sets */
    char name[HF_SUMMARY_SETS][HF_CABLE_SET_NAME_SIZE]; /* [n] names of the sets */
    /* [n] minimum, maximum and ratio of the tensions */
    double least_N[HF_SUMMARY_SETS], largest_N[HF_SUMMARY_SETS], ratio[HF_SUMMARY_SETS];
} hf_set_tensions;

/* Maximum number of constraints in hf_held_limits, and bytes of the name of one. */
#define HF_SUMMARY_HELD (2 * HF_DESIGN_ROWS_MAX + 1)
#define HF_HELD_NAME_SIZE 160

/* The constraints that hold the shape of a stage, which is at their bounds within 1e-8: boundary_ratio_cap, and rows of
 * optimize.limits, one side of a row after the other. The form-finding has none. */
typedef struct {
    int n;                                         /* number of constraints */
    int row[HF_SUMMARY_HELD];                      /* [n] row of optimize.limits; -1: boundary_ratio_cap */
    int count[HF_SUMMARY_HELD];                    /* [n] number of cables or attachments of the row at this bound */
    char name[HF_SUMMARY_HELD][HF_HELD_NAME_SIZE]; /* [n] one of these, such as "tension of cable c7" */
    double value[HF_SUMMARY_HELD], bound[HF_SUMMARY_HELD]; /* [n] value and bound of this one, N, m or a ratio */
} hf_held_limits;

/* The rows of optimize.goals or optimize.objectives. The latter have neither weights nor a merit. The values, with the
 * merit, are in the results of the stages. */
typedef struct {
    int n;                                                 /* number of objectives; 0: psi is minimised */
    char name[HF_DESIGN_ROWS_MAX][HF_OBJECTIVE_NAME_SIZE]; /* [n] goal_1_tension_edge: number, figure, set */
    double weight[HF_DESIGN_ROWS_MAX];                     /* [n] weights */
    int after_fit[HF_DESIGN_ROWS_MAX]; /* [n] surface figures: 1 after the best fit, 0 without; -1: other figures */
    bool is_front;                     /* the rows are those of optimize.objectives */
} hf_objective_list;

#define HF_SUMMARY_MEMBER(type, member, ...) type member;

/* The figures of the truss. */
typedef struct {
    HF_SUMMARY_TRUSS_LIST(HF_SUMMARY_MEMBER)
} hf_truss_summary;

/* The figures of a load case. Without a shape they are NaN, except for the status. */
typedef struct {
    char name[HF_SET_NAME_SIZE]; /* name of the load case */
    hf_form_result result;       /* result of its form-finding */
    HF_LOAD_CASE_LIST(HF_SUMMARY_MEMBER)
    hf_surface_measures measures; /* surface of its shape */
} hf_load_case_summary;

/* The figures of a run. */
typedef struct {
    char version[64], title[256], case_path[HF_PATH_SIZE]; /* version of the program; title and path of the case */
    bool finished;                                         /* false: the run can be resumed */
    hf_status status;                /* status of the whole run; HF_NOT_EVALUATED unless finished */
    int threads;                     /* number of threads of the run */
    uint64_t seed;                   /* seed of the genetic algorithm */
    char warnings[HF_WARNINGS_SIZE]; /* lines "error: ...", then lines "warning: ..." */

    hf_surface_settings surface;     /* target surface; focal_length_m is 0 without a section surface */
    hf_pattern_summary pattern[3];   /* [hf_stage] far fields of the shapes; none without surface.pattern */
    hf_surface_measures measures[3]; /* [hf_stage] surfaces of the shapes of form, optimize, polish */
    hf_set_tensions sets[3];         /* [hf_stage] tensions of sets; n is 0 without sets or without the shape */
    hf_held_limits held[3];          /* [hf_stage] constraints that hold the shapes */

    hf_objective_list objectives; /* objectives of the run */
    hf_front_origin taken;        /* the point of another run's front that is the result, as the shape of `polish` */

    int n_load_case;                                   /* number of load cases of the as-built net */
    hf_load_case_summary load_case[HF_LOAD_CASES_MAX]; /* [n_load_case] the load cases */

    HF_SUMMARY_FORM_LIST(HF_SUMMARY_MEMBER)
    hf_form_result form; /* result of the form-finding */
    bool has_coupling;   /* the net is on an elastic truss; false: `coupling` of all results is zero */

    bool has_polish;       /* Levenberg-Marquardt ran, or a point of a front was taken */
    hf_form_result polish; /* result of Levenberg-Marquardt */
    HF_SUMMARY_REFINE_LIST(HF_SUMMARY_MEMBER)

    bool has_front;       /* `front` is set; its objectives are those of `goals` */
    hf_front_table front; /* the front of optimize.objectives */

    bool has_truss;         /* `truss` is set */
    hf_truss_summary truss; /* figures of the truss */

    bool has_tolerance;             /* `tolerance` is set: samples of the as-built net were computed */
    hf_tolerance_summary tolerance; /* result of the tolerance analysis */

    bool has_optimize;   /* the genetic algorithm ran; all following members are about it */
    hf_form_result best; /* result of the best individual; status HF_NO_FEASIBLE: none is feasible */
    HF_SUMMARY_SEARCH_LIST(HF_SUMMARY_MEMBER)
} hf_summary;

/* Writes one JSON object, grouped by stage, to `file`. A stage that did not run is absent, and NaN is null. `messages`
 * has lines as hf_messages, or is NULL. `path` is that of the result file; NULL: none was written. Write errors can be
 * read from the stream (ferror). */
void hf_summary_write_json(const hf_summary *summary, hf_status status, const char *messages, const char *path,
                           FILE *file);

/* Returns the status with which hf_summary_write_json presents a file: that of the whole run, or of its form-finding
 * while the run has not ended. */
hf_status hf_summary_status(const hf_summary *summary);

/* Returns true if the file contains the shape of the best individual: the run is finished, and its genetic algorithm
 * found a feasible design. */
bool hf_summary_has_best_shape(const hf_summary *summary);

/* Returns the share of the time of all threads that was spent in breeding, evaluating and storing, 0 to 1; NaN if no
 * time was measured. */
double hf_summary_utilisation(const hf_summary *summary);

HF_API_END
#endif
