/* summary - the figures of a complete run.
 * Stability: stable.
 *
 * The command `run` prints the summary and stores it with the results. The command `show` prints the stored summary.
 * The list HF_RESULT_LIST in <hifdm/result.h> describes the quantities of the shape of a stage. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/cable_set.h>
#include <hifdm/front.h>
#include <hifdm/optimiser.h>
#include <hifdm/pattern.h>
#include <hifdm/requirements.h>
#include <hifdm/surface.h>
#include <hifdm/tolerance.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

HF_API_BEGIN

#define HF_WARNINGS_SIZE 4096 /* size in bytes of the text of the warnings */

/* ---- The lists: rows as in HF_RESULT_LIST, without .individual and .units ----
 *
 *   .json   place in the JSON object of the stage, after the figures of its result
 *
 * The lists define the members of hf_summary and the JSON objects. The rows also define, in their order, the HDF5
 * attributes and the columns of the ledger of a sweep. To add a quantity of a run, add a row to one of these lists and
 * the code that computes the quantity. */

/* Figures of the net. */
#define HF_SUMMARY_FORM_LIST(X)                                                                                        \
    X(int, n_node, INT, .description = "nodes")                                                                        \
    X(int, n_free, INT, .json = 1, .description = "nodes that are no supports")                                        \
    X(int, n_inner_node, INT, .json = 1, .description = "free nodes that psi counts; 0: an earlier version")           \
    X(int, n_uncounted, INT, .json = 1,                                                                                \
      .description = "free nodes whose positions no objective fixes in all directions; 0: nothing was optimised")      \
    X(double, uncounted_move_m, REAL, .json = 1,                                                                       \
      .description = "maximum displacement of these nodes since form-finding that no objective counts, in the result") \
    X(double, scale_min, REAL, .json = 1,                                                                              \
      .description = "minimum factor by which the result scales design variables with link: scale; NaN: none")         \
    X(double, scale_max, REAL, .json = 1, .description = "maximum factor by which the result scales them")             \
    X(int, n_cable, INT, .description = "cables")                                                                      \
    X(int, n_variable, INT, .description = "design variables")                                                         \
    X(int, half_bandwidth, INT, .description = "of the force density matrix")                                          \
    X(double, pretension_N, REAL, .description = "of the case, N")                                                     \
    X(bool, has_own_tensions, TRUTH, .description = "1: no cable takes pretension_N, by the laws of all")

/* This list describes the quantities that only the search has. The search is the genetic algorithm. */
#define HF_SUMMARY_SEARCH_LIST(X)                                                                                      \
    X(hf_solver, solver, SOLVER, .json = 6, .description = "solver of the individuals")                                \
    X(double, initial_psi_m, REAL, .json = 2,                                                                          \
      .description = "psi of the initial design under the rule; NaN if it is infeasible")                              \
    X(int, n_leader, INT, .json = 5, .key = "independent_variables",                                                   \
      .description = "design variables that no symmetry links to another one")                                         \
    X(int, planes, INT, .description = "HF_PLANE_ bits of the symmetry (1 = x, 2 = y) that links the others")          \
    X(int, best_generation, INT, .json = 3, .description = "generation of the best individual, counted from 0")        \
    X(int, best_individual, INT, .json = 3, .description = "number of the best individual in it, counted from 0")      \
    X(int, generations, INT, .json = 1, .description = "number of generations that were finished")                     \
    X(long, evaluations, LONG, .json = 1, .description = "form-findings")                                              \
    X(long, infeasible, LONG, .json = 1, .description = "form-findings without a feasible shape")                      \
    X(int, n_at_lower, INT, .json = 3, .key = "at_lower_bound",                                                        \
      .description = "design variables of the best individual at their lower bounds")                                  \
    X(int, n_at_upper, INT, .json = 3, .key = "at_upper_bound",                                                        \
      .description = "design variables of the best individual at their upper bounds")                                  \
    X(hf_population_stop, algorithm_stop, SEARCH_STOP, .json = 7, .key = "stop_reason",                                \
      .description = "why the algorithm ended")                                                                        \
    X(double, cpu_s, REAL, .json = 4,                                                                                  \
      .description = "processor time of breeding, evaluating and storing, over all threads; without waiting")          \
    X(double, store_cpu_s, REAL, .json = 4, .description = "processor time of storing alone")

/* This list describes the quantities that only the refinement has. The refinement is Levenberg-Marquardt. */
#define HF_SUMMARY_REFINE_LIST(X)                                                                                      \
    X(bool, is_result, FLAG, .json = 2, .description = "its design is the result, not that of the search")             \
    X(int, steps, INT, .json = 1, .description = "steps of Levenberg-Marquardt")                                       \
    X(int, evaluations, INT, .json = 1, .description = "form-findings")                                                \
    X(hf_refine_stop, algorithm_stop, REFINE_STOP, .json = 4, .key = "stop_reason",                                    \
      .description = "why the algorithm ended")                                                                        \
    X(double, predicted_gain, REAL, .json = 4,                                                                         \
      .description = "part of the merit (psi) by which the linear model would still lower it; NaN: not known")         \
    X(int, n_at_lower, INT, .json = 5, .key = "at_lower_bound",                                                        \
      .description = "design variables at their lower bounds")                                                         \
    X(int, n_at_upper, INT, .json = 5, .key = "at_upper_bound",                                                        \
      .description = "design variables at their upper bounds")                                                         \
    X(bool, is_at_cap, FLAG, .json = 5, .key = "at_ratio_cap",                                                         \
      .description = "the design is at the cap on the boundary tension ratio")                                         \
    X(int, n_at_limit, INT, .json = 5, .key = "at_limit",                                                              \
      .description = "limits of optimize.limits that the design is at, cable by cable")

/* This list describes the quantities of a load case of the as-built net (`load_cases`) in addition to its result. */
#define HF_LOAD_CASE_LIST(X)                                                                                           \
    X(double, tension_min_N, REAL, .json = 1, .description = "minimum tension of all cables")                          \
    X(double, tension_max_N, REAL, .json = 1, .description = "maximum tension of all cables")                          \
    X(double, displacement_rms_m, REAL, .json = 2,                                                                     \
      .description = "RMS displacement of the inner nodes from their positions in the design")                         \
    X(double, member_force_max_N, REAL, .json = 3,                                                                     \
      .description = "maximum axial force of a truss member; NaN: no truss")

/* Figures of the truss. */
#define HF_SUMMARY_TRUSS_LIST(X)                                                                                       \
    X(double, mass_kg, REAL, .json = 1, .description = "mass of members and hinges")                                   \
    X(int, n_node, INT, .json = 1, .key = "nodes", .description = "nodes of the truss")                                \
    X(int, n_member, INT, .json = 1, .key = "members", .description = "members of the truss")

/* Defines the maximum number of sets in hf_set_tensions. A page has space for HF_SUMMARY_SETS sets. */
#define HF_SUMMARY_SETS 16

/* Contains the tensions of the first HF_SUMMARY_SETS named sets of cables of the net in one shape. The tension ratio is
 * computed as in hf_metrics_set_ratio. */
typedef struct {
    int n;                                              /* number of sets */
    char name[HF_SUMMARY_SETS][HF_CABLE_SET_NAME_SIZE]; /* [n] names of the sets */
    /* [n] minimum and maximum of the tensions, and their ratio */
    double min_N[HF_SUMMARY_SETS], max_N[HF_SUMMARY_SETS], ratio[HF_SUMMARY_SETS];
} hf_set_tensions;

/* HF_SUMMARY_HELD is the maximum number of constraints in hf_held_limits. HF_HELD_NAME_SIZE is the size in bytes of the
 * name of a constraint. */
#define HF_SUMMARY_HELD (2 * HF_DESIGN_ROWS_MAX + 1)
#define HF_HELD_NAME_SIZE 160

/* Contains the active constraints of the shape of a stage. A constraint is active if the shape reaches its bound within
 * 1e-8. The constraints are boundary_ratio_cap and the rows of optimize.limits. The lower and the upper bound of a row
 * are separate constraints. The form-finding has no constraints. */
typedef struct {
    int n;                      /* number of constraints */
    int row[HF_SUMMARY_HELD];   /* [n] row of optimize.limits; -1: boundary_ratio_cap */
    int count[HF_SUMMARY_HELD]; /* [n] number of cables or attachments of the row at this bound */
    /* [n] example of these cables or attachments, such as "tension of cable c7" */
    char name[HF_SUMMARY_HELD][HF_HELD_NAME_SIZE];
    double value[HF_SUMMARY_HELD], bound[HF_SUMMARY_HELD]; /* [n] value and bound of this example, N, m or a ratio */
} hf_held_limits;

/* Describes the rows of optimize.objective or optimize.front. The rows of optimize.front have neither weights nor a
 * merit. The values of the objectives and the merit are in the results of the stages. */
typedef struct {
    int n; /* number of objectives; 0: psi is minimised */
    /* [n] name such as objective_1_tension_edge: number, figure, set */
    char name[HF_DESIGN_ROWS_MAX][HF_OBJECTIVE_NAME_SIZE];
    double weight[HF_DESIGN_ROWS_MAX]; /* [n] weights of the objectives */
    /* [n] 1: surface error for a refocused feed; 0: for a fixed feed; -1: other figure */
    int after_fit[HF_DESIGN_ROWS_MAX];
    bool is_front; /* true: the rows are those of optimize.front */
} hf_objective_list;

#define HF_SUMMARY_MEMBER(type, member, ...) type member;

/* The figures of the truss. */
typedef struct {
    HF_SUMMARY_TRUSS_LIST(HF_SUMMARY_MEMBER)
} hf_truss_summary;

/* Contains the quantities of a load case. If the load case has no shape, all values except the status are NaN. */
typedef struct {
    char name[HF_SET_NAME_SIZE]; /* name of the load case */
    hf_form_result result;       /* result of the form-finding of the load case */
    HF_LOAD_CASE_LIST(HF_SUMMARY_MEMBER)
    hf_surface_measures surface; /* surface figures of its shape */
} hf_load_case_summary;

/* These stages of a run produce a shape. */
typedef enum { HF_STAGE_FORM, HF_STAGE_SEARCH, HF_STAGE_REFINE, HF_N_STAGE } hf_stage;
extern const char *const hf_stage_word[HF_N_STAGE + 1]; /* "form", "search", "refine", "none" */

/* Data that every stage has. The summary owns the memory behind the pointers. The memory comes from calloc. If a
 * pointer is NULL, the stage has no data of this kind. */
typedef struct {
    bool exists; /* true: the stage ran, or HF_STAGE_REFINE holds the selected point of a front */
    /* result of its shape; for the search, that of the best individual (HF_NO_FEASIBLE: none is feasible) */
    hf_form_result result;
    double wall_s;               /* wall-clock time of the stage */
    hf_surface_measures surface; /* surface figures of its shape */
    hf_pattern_summary *pattern; /* far field of its shape */
    hf_set_tensions *sets;       /* tensions of the named sets of cables */
    hf_held_limits *held;        /* active constraints of its shape */
    hf_optima *optima;           /* optima that method `auto` found */
} hf_stage_summary;

/* The struct hf_search_summary contains the data that only the search has. The struct hf_refine_summary contains the
 * data that only the refinement has. */
typedef struct {
    HF_SUMMARY_SEARCH_LIST(HF_SUMMARY_MEMBER)
} hf_search_summary;
typedef struct {
    HF_SUMMARY_REFINE_LIST(HF_SUMMARY_MEMBER)
} hf_refine_summary;

/* The figures of a run. If all members of a summary are zero, the summary is empty. A copy by assignment shares the
 * memory that hf_summary_free frees. */
typedef struct {
    /* version of the program; title of the case; path of the case file */
    char version[64], title[256], case_path[HF_PATH_SIZE];
    bool finished;                   /* false: the run can be resumed */
    hf_status status;                /* status of the whole run; HF_NOT_EVALUATED if the run is not finished */
    int threads;                     /* number of threads of the run */
    uint64_t seed;                   /* seed of the genetic algorithm */
    char warnings[HF_WARNINGS_SIZE]; /* lines "error: ...", followed by lines "warning: ..." */

    HF_SUMMARY_FORM_LIST(HF_SUMMARY_MEMBER)
    hf_surface_settings surface;  /* target surface; focal_length_m is 0 without a section surface */
    hf_objective_list objectives; /* objectives of the run */
    bool has_coupling;            /* true: the net is on an elastic truss; false: `coupling` of all results is zero */
    bool has_truss;               /* true: `truss` is set */
    hf_truss_summary truss;       /* figures of the truss */

    hf_stage_summary stage[HF_N_STAGE]; /* figures of each stage */
    hf_search_summary search;           /* figures of the search; set if the search exists */
    hf_refine_summary refine;           /* figures of the refinement; set if the refinement exists */
    /* selected point of the front of another run; its shape is stored as that of the refinement */
    hf_front_origin taken;

    hf_front_table *front;               /* Pareto front of optimize.front, owned; NULL: none */
    int n_load_case;                     /* number of load cases of the as-built net */
    hf_load_case_summary *load_case;     /* [n_load_case] figures of the load cases, owned */
    hf_tolerance_summary *tolerance;     /* result of the tolerance analysis, owned; NULL: none */
    int n_requirement;                   /* number of rows of `requirements` with a verdict */
    hf_requirement_verdict *requirement; /* [n_requirement] verdicts on the rows, owned */
} hf_summary;

/* Frees the memory that the summary owns and empties the summary. */
void hf_summary_free(hf_summary *summary);

/* Writes the summary to `file` as one JSON object, grouped by stage. The object omits stages that did not run and
 * contains null for NaN. The argument `messages` contains lines in the form of hf_messages and may be NULL. The
 * argument `path` is the path of the result file. If no file was written, `path` is NULL. The caller can check the
 * stream for write errors (ferror). */
void hf_summary_write_json(const hf_summary *summary, hf_status status, const char *messages, const char *path,
                           FILE *file);

/* Returns the status that hf_summary_write_json writes for a file. If the run has ended, the function returns the
 * status of the whole run. If the run has not ended, the function returns the status of the form-finding. */
hf_status hf_summary_status(const hf_summary *summary);

/* Returns the judgement on the result by the requirements. If the run has found a Pareto front, the result is the point
 * that ranks first. The member `requirement` of the summary then refers to the net after form-finding. */
hf_judgement hf_summary_judge(const hf_summary *summary);

/* Returns the word for the algorithm of a stage. The word is "ga" or "nsga2" for the search and "lm" for the
 * refinement. For other stages, the word is "". */
const char *hf_summary_algorithm(const hf_summary *summary, hf_stage stage);

/* Returns true if the result contains a shape of the stage. The search has a shape only if the run is finished and its
 * best individual is feasible. */
bool hf_summary_has_shape(const hf_summary *summary, hf_stage stage);

/* Returns the share (0 to 1) of the time of all threads that was spent on breeding, evaluating and storing. Returns NaN
 * if no time was measured. */
double hf_summary_utilisation(const hf_summary *summary);

HF_API_END
