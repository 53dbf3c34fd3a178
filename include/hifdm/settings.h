/* settings - all settings of the library as plain values.
 * Stability: stable.
 *
 * The function hf_config_load reads these settings from a case file. The command `hifdm schema` describes the keys of
 * these settings. A program may also set these values without a case file. */
#pragma once

#include <hifdm/api.h>
#include <stdbool.h>
#include <stdint.h>

HF_API_BEGIN

/* Each of the following enumerations contains the choices for one key of a case file. `hifdm schema` describes the
 * values.
 *
 * The key form.method selects the method of the form-finding. */
typedef enum { HF_METHOD_HIFDM, HF_METHOD_ITERATIVE_FDM, HF_METHOD_FDM, HF_METHOD_NEWTON, HF_METHOD_AUTO } hf_method;
/* Each row X(enumerator, word) defines a method of the optimisation (optimize.method). Each row of HF_OPTIMISER_LIST
 * states the optimiser of one method. */
#define HF_OPTIMIZE_METHODS(X) X(GA, "ga") X(LM, "lm") X(GA_LM, "ga+lm") X(AUTO, "auto")
#define HF_OPTIMIZE_ENUMERATOR(name, word) HF_OPTIMIZE_##name,
/* The key optimize.method selects the method of the optimisation. */
typedef enum { HF_OPTIMIZE_METHODS(HF_OPTIMIZE_ENUMERATOR) HF_OPTIMIZE_N_METHOD } hf_optimize_method;
#undef HF_OPTIMIZE_ENUMERATOR
/* The key form.factor selects whether hifdm or LAPACK factors the positive definite matrices of form-finding. */
typedef enum { HF_FACTOR_OWN, HF_FACTOR_LAPACK } hf_factor;
/* The key optimize.solver selects the solver of the designs. */
typedef enum { HF_SOLVER_AUTO, HF_SOLVER_CHORD, HF_SOLVER_NEWTON, HF_SOLVER_FIXED_POINT } hf_solver;
/* The key form.prestress states whether the tensions are given or computed so that they hold every node at its target
 * position. */
typedef enum { HF_PRESTRESS_GIVEN, HF_PRESTRESS_EXACT } hf_prestress;
/* The key form.stop selects the stopping rule of the form-finding. */
typedef enum { HF_STOP_RESIDUAL, HF_STOP_RMS_CHANGE } hf_stop_rule;
/* The key optimize.rule selects the meaning of the pretension of a boundary cable in a design (METHOD section 7). */
typedef enum { HF_RULE_FORCE_DENSITY, HF_RULE_TENSION, HF_RULE_SEEDED } hf_rule;
/* The key coupling.scheme selects the scheme that couples net and truss (METHOD section 8). */
typedef enum { HF_COUPLING_ACCELERATED, HF_COUPLING_PLAIN, HF_COUPLING_AUTO } hf_coupling_scheme;
/* The key optimize.refine states whether Levenberg-Marquardt refines the best design of the method `ga`. */
typedef enum { HF_REFINE_AUTO, HF_REFINE_TRUE, HF_REFINE_FALSE } hf_refine_choice;
/* The key optimize.variation selects the method by which the genetic algorithm makes children. */
typedef enum { HF_VARIATION_DIFFERENCE, HF_VARIATION_CHAIN } hf_variation;
/* The key optimize.store selects the individuals that a result file keeps. */
typedef enum { HF_KEEP_ALL, HF_KEEP_BEST, HF_KEEP_EVERY } hf_keep;
/* The key surface.kind selects the kind of the target surface. */
typedef enum { HF_SURFACE_AUTO, HF_SURFACE_PARABOLIC_CYLINDER, HF_SURFACE_PARABOLOID } hf_surface_kind;
/* The key optimize.symmetry selects the mirror planes that link design variables. */
typedef enum { HF_SYMMETRY_NONE, HF_SYMMETRY_X, HF_SYMMETRY_Y, HF_SYMMETRY_XY, HF_SYMMETRY_AUTO } hf_symmetry;

/* Selects the quantity that a row of optimize.variables varies for each cable of its set, or for the supports at these
 * cables. */
typedef enum {
    HF_VARY_TENSION,           /* tension of a cable, N; the cable gets law tension */
    HF_VARY_FORCE_DENSITY,     /* force density of a cable, N/m; the cable gets law force_density */
    HF_VARY_LENGTH,            /* length of a cable, m; the cable gets law length */
    HF_VARY_UNSTRESSED_LENGTH, /* unstressed length of a cable of law elastic, m */
    HF_VARY_SUPPORT_Z,         /* displacement of a support along z, m */
    HF_VARY_SUPPORT_NORMAL,    /* displacement of a support along the normal of the target surface, m */
    HF_VARY_SUPPORT_XYZ,       /* displacement of a support along x, y and z: three design variables, m */
    HF_VARY_PRETENSION /* pretension of a boundary cable under optimize.rule, N; not available in optimize.variables */
} hf_vary;
/* The key optimize.link selects which design variables of a row change together: none, all by the same step, the
 * variables at mirrored positions by the same step, or all by the same factor. */
typedef enum { HF_LINK_EACH, HF_LINK_SET, HF_LINK_SYMMETRY, HF_LINK_SCALE } hf_link;

/* Selects the quantity that a row of optimize.objective or optimize.front measures. Every quantity of an objective is
 * at least zero and is minimised. */
typedef enum {
    HF_FIGURE_PSI,        /* psi: RMS distance of the inner nodes from their target positions, m */
    HF_FIGURE_SURFACE,    /* RMS distance of the inner nodes from the target surface, m */
    HF_FIGURE_FACETS,     /* RMS distance of the facets from the target surface, m */
    HF_FIGURE_TENSION,    /* RMS difference between the tensions of the set and `target`, N */
    HF_FIGURE_LENGTH,     /* RMS difference between the lengths of the set and `target`, m */
    HF_FIGURE_EVENNESS,   /* standard deviation of the tensions of the set, divided by their mean */
    HF_FIGURE_PULL,       /* maximum force of the net on a support, N */
    HF_FIGURE_DEFLECTION, /* maximum deflection of the truss at an attachment, m */
    HF_FIGURE_MASS,       /* mass of the cables of the set for mass_kg_per_m, kg */
    HF_FIGURE_RATIO,      /* ratio of maximum to minimum tension in the set */
    HF_FIGURE_GAIN        /* square root of the part of the gain that is lost in the direction of the beam */
} hf_figure_kind;
/* Selects the direction in which the distance to a surface is measured. */
typedef enum { HF_ALONG_NORMAL, HF_ALONG_HALF_PATH } hf_along;
/* A surface error or a radio figure belongs to one of two feeds. The refocused feed follows the best fit of the target
 * surface to the shape in position, direction and focal length. The fixed feed remains where the target surface has
 * it. */
typedef enum { HF_REFOCUSED, HF_FIXED, HF_N_FOCUS } hf_focus;

/* An objective is measured on the design or on samples of the errors of its as-built net. */
typedef enum { HF_OVER_DESIGN, HF_OVER_SAMPLES } hf_over;
/* The root mean square or the maximum combines the values of several shapes. */
typedef enum { HF_TAKE_MEAN, HF_TAKE_WORST } hf_take;

/* Selects the quantity that a row of optimize.limits bounds. */
typedef enum {
    HF_LIMIT_TENSION,   /* tension of each cable of the set, N */
    HF_LIMIT_RATIO,     /* ratio of maximum to minimum tension in the set */
    HF_LIMIT_DEFLECTION /* deflection of each attachment, m */
} hf_limit_kind;

/* Each array contains the words of a choice in a case file, indexed by an enumeration of this header. The last entry of
 * each array is NULL. For all other choices, the table of keys (config.h) contains the words. The array
 * hf_figure_kind_unit contains the units of the measured quantities and does not end with NULL. An empty unit means
 * that the quantity is dimensionless. The array hf_adjust_figure_word contains the words of adjust.figure, from
 * HF_FIGURE_PSI to HF_FIGURE_FACETS. Each row X(array, size, words ...) defines one array of words. */
#define HF_SETTINGS_WORDS(X)                                                                                           \
    X(hf_method_word, 6, "hifdm", "iterative_fdm", "fdm", "newton", "auto")                                            \
    X(hf_stop_rule_word, 3, "residual", "rms_change")                                                                  \
    X(hf_rule_word, 4, "force_density", "tension", "seeded")                                                           \
    X(hf_solver_word, 5, "auto", "chord", "newton", "fixed_point")                                                     \
    X(hf_keep_word, 4, "all", "best", "every")                                                                         \
    X(hf_symmetry_word, 6, "none", "x", "y", "xy", "auto")                                                             \
    X(hf_nodes_word, 5, "all", "support", "inner", "edge")                                                             \
    X(hf_part_word, 11, "all", "net", "truss", "bud", "mbug", "abug", "other", "longeron", "vertical", "diagonal")     \
    X(hf_surface_kind_word, 4, "auto", "parabolic_cylinder", "paraboloid")                                             \
    X(hf_feed_word, 5, "auto", "point", "line", "plane_wave")                                                          \
    X(hf_coupling_scheme_word, 4, "accelerated", "plain", "auto")                                                      \
    X(hf_vary_word, 8, "tension", "force_density", "length", "unstressed_length", "support_z", "support_normal",       \
      "support_xyz")                                                                                                   \
    X(hf_figure_kind_word, 12, "psi", "surface", "facets", "tension", "length", "evenness", "pull", "deflection",      \
      "mass", "ratio", "gain")                                                                                         \
    X(hf_figure_kind_unit, 11, "m", "m", "m", "N", "m", "", "N", "m", "kg", "", "")                                    \
    X(hf_over_word, 3, "design", "samples")                                                                            \
    X(hf_take_word, 3, "mean", "worst")                                                                                \
    X(hf_limit_word, 4, "tension", "ratio", "deflection")                                                              \
    X(hf_adjust_figure_word, 4, "psi", "surface", "facets")                                                            \
    X(hf_distribution_word, 3, "normal", "uniform")                                                                    \
    X(hf_sampling_word, 3, "random", "sobol")                                                                          \
    X(hf_aim_word, 3, "target_positions", "design")                                                                    \
    X(hf_focus_word, 3, "refocused", "fixed")
#define HF_SETTINGS_EXTERN(name, size, ...) extern const char *const name[size];
HF_SETTINGS_WORDS(HF_SETTINGS_EXTERN)
#undef HF_SETTINGS_EXTERN
extern const char *const hf_optimize_method_word[HF_OPTIMIZE_N_METHOD + 1];

/* Defines the size in bytes of the path of a case, a study, or a table of a net or truss. A longer path is rejected. */
#define HF_PATH_SIZE 1024

/* Describes the point of a Pareto front that a run uses as its result instead of a search. */
typedef struct {
    int point;               /* number of the point, counted from 1; 0: no point is used */
    char path[HF_PATH_SIZE]; /* path of the result file with the front, as the user gave it */
    char sha256[65];         /* hexadecimal digest of the design */
} hf_front_origin;

/* Contains the words of hf_tolerance_measure in a case file. The last entry is NULL. */
extern const char *const hf_tolerance_measure_word[];

#define HF_SET_NAME_SIZE 64 /* size in bytes of the name of a set of cables, including its NUL */

/* One row of optimize.variables. Values are in the unit of the varied quantity. */
typedef struct {
    char set[HF_SET_NAME_SIZE]; /* cables: name of a set, or inner, boundary, all */
    hf_vary vary;               /* varied quantity */
    double range;               /* maximum change from the value after form-finding; NaN: not given */
    double range_ratio;         /* maximum change relative to that value (`range: 30 %`); NaN: not given */
    double lower, upper;        /* bounds on the value (`bounds`); infinite if not given */
    hf_link link;               /* design variables that are linked */
} hf_variable_settings;

/* Describes one row of optimize.objective or optimize.front. Objectives of optimize.front have no weight. */
typedef struct {
    hf_figure_kind figure;      /* measured figure */
    char set[HF_SET_NAME_SIZE]; /* cables of the figures tension, length, evenness, mass and ratio; "": all */
    double target; /* target value of tension or length; NaN for length: the lengths between the target positions */
    double weight; /* weight of the objective: merit = sqrt(sum (weight * value)^2) */
    double mass_kg_per_m; /* mass of the cables per length, for the figure mass */
    hf_along along;       /* direction of the distance, for the figures surface and facets */
    hf_focus feed;        /* feed of the figures surface and facets; refocused: distance from the best fit */
    char load_case[HF_SET_NAME_SIZE]; /* name of a load case; "all": all load cases; "": none */
    hf_over over;                     /* shapes on which the figure is measured if there is no load case */
    hf_take take;                     /* figure that combines several load cases or samples */
    double quantile; /* replaces `take` for samples: share of samples that do not exceed the value; 0 or NaN: none */
    double frequency_Hz; /* frequency for the figure gain; 0 or NaN: the highest frequency of the surface */
} hf_objective_settings;

/* One row of optimize.limits. */
typedef struct {
    hf_limit_kind figure;       /* bounded quantity */
    char set[HF_SET_NAME_SIZE]; /* cables of the quantities tension and ratio; "": all */
    double lower, upper;        /* bounds on the quantity (`bounds`); infinite if not given */
} hf_limit_settings;

/* maximum number of rows of optimize.variables, of optimize.objective and of optimize.limits */
#define HF_DESIGN_ROWS_MAX 16
#define HF_FRONT_OBJECTIVES_MAX 3  /* maximum number of rows of optimize.front */
#define HF_FRONT_POINTS_MAX 512    /* maximum of optimize.front_points */
#define HF_OBJECTIVE_NAME_SIZE 112 /* size in bytes of the name of an objective: "objective_15_deflection_" and a set */

/* Contains the settings of the coupling of the net with an elastic truss (section `coupling`). If the case has no
 * truss, the coupling settings have no effect. */
typedef struct {
    double tof_m;              /* tolerance: maximum displacement of an attachment in an iteration */
    hf_coupling_scheme scheme; /* scheme of the coupling */
    int max_iterations;        /* maximum number of iterations */
} hf_coupling_settings;

/* Contains the settings of the form-finding (section `form`) and of its coupling. */
typedef struct {
    hf_method method;          /* method of the form-finding */
    double pretension_N;       /* pretension Td of cables of law tension without a target value */
    hf_prestress prestress;    /* tensions are given or computed */
    hf_stop_rule stop;         /* stopping rule */
    double residual_tolerance; /* rule residual: maximum residual force of a node, divided by the reference tension */
    double length_tolerance;   /* rule residual: maximum |l/L* - 1| of cables of law length or elastic */
    double rms_tolerance_m;    /* rule rms_change of the paper: maximum change of psi in an iteration */
    int max_iterations;        /* maximum number of linear solves */
    double collapse_ratio; /* minimum length of a cable of law tension, divided by its length at the target positions */
    hf_coupling_settings coupling; /* coupling with the truss */
    hf_factor factor;              /* code that factors the matrices */
} hf_form_settings;

/* Contains the settings of the optimisation (section `optimize`). */
typedef struct {
    hf_optimize_method method;            /* algorithms of the optimisation */
    hf_rule rule;                         /* meaning of the pretension of a boundary cable */
    hf_solver solver;                     /* solver of the designs */
    int population, generations;          /* number of individuals, and maximum number of generations */
    double range_N;                       /* |dT| of Eq. 13: maximum change of a boundary pretension */
    double min_tension_N, max_tension_N;  /* bounds on a boundary pretension, T' of Eq. 13 */
    double boundary_ratio_cap;            /* maximum boundary tension ratio of a feasible design */
    uint64_t seed;                        /* seed of the genetic algorithm */
    double crossover_high, crossover_low; /* crossover rates Pc1 and Pc2 (METHOD section 7, M10) */
    double mutation_high, mutation_low;   /* mutation rates Pm1 and Pm2 (METHOD section 7, M10) */
    hf_variation variation;               /* method by which the genetic algorithm makes children */
    int elites; /* number of best individuals; chain: they survive unchanged; difference: crossovers move them */
    double stagnation_tolerance_m;       /* the generations end if the best merit improves by less than this value */
    int stagnation_generations;          /* number of generations over which this improvement is measured */
    int refine_steps;                    /* maximum number of steps of Levenberg-Marquardt */
    hf_refine_choice refine;             /* use of Levenberg-Marquardt after method ga */
    hf_symmetry symmetry;                /* mirror planes that link design variables */
    hf_keep store;                       /* individuals that a result file keeps */
    int store_every;                     /* HF_KEEP_EVERY: the file keeps generations 0, n, 2n, ... */
    int n_variable_row, n_term, n_limit; /* numbers of rows; without rows: boundary pretensions, psi and no limits */
    hf_variable_settings variable_row[HF_DESIGN_ROWS_MAX]; /* [n_variable_row] rows of optimize.variables */
    hf_objective_settings term[HF_DESIGN_ROWS_MAX];        /* [n_term] rows of optimize.objective */
    hf_limit_settings limit[HF_DESIGN_ROWS_MAX];           /* [n_limit] rows of optimize.limits */
    int n_front; /* number of rows of optimize.front: 0, or 2 or 3 for a Pareto front */
    hf_objective_settings front[HF_FRONT_OBJECTIVES_MAX]; /* [n_front] rows of optimize.front */
    int front_points; /* number of points of a Pareto front that Levenberg-Marquardt computes */
    int samples;      /* number of random samples for objectives that are measured on samples */
} hf_optimize_settings;

/* Returns true if an objective is measured on all load cases of the as-built net. */
bool hf_objective_takes_load_cases(const hf_objective_settings *settings);

/* Returns true if an objective is measured on samples of as-built nets. */
bool hf_optimize_takes_samples(const hf_optimize_settings *settings);

/* Describes one row of the list `cables`. A row of `cables` contains the material of the cables of a set. NaN means
 * that a value is not given. */
typedef struct {
    char set[HF_SET_NAME_SIZE];            /* cables: name of a set, or inner, boundary, all */
    double expansion_per_K, mass_kg_per_m; /* thermal expansion, and mass per unstressed length */
} hf_cable_settings;

/* Selects the nodes to which a row applies: all nodes, or the nodes of one role. */
typedef enum { HF_NODES_ALL, HF_NODES_SUPPORT, HF_NODES_INNER, HF_NODES_EDGE } hf_nodes;

/* Describes one row of the list `nodes`. A row of `nodes` adds a mass to nodes. */
typedef struct {
    hf_nodes role;  /* nodes that have the mass */
    double mass_kg; /* mass of each node */
} hf_node_settings;

#define HF_MATERIAL_ROWS_MAX 16 /* maximum number of rows of `cables` and of `nodes` */

/* A row of `load_cases` gives a temperature to the whole structure, to all cables, or to the truss. Values from
 * HF_PART_UNIT on select the truss members of one unit, in the order of hf_unit. */
typedef enum { HF_PART_ALL, HF_PART_NET, HF_PART_TRUSS, HF_PART_UNIT } hf_part;

/* One row of `load_cases`. Rows with the same name form one load case. NaN means that a number is not given. */
typedef struct {
    char name[HF_SET_NAME_SIZE]; /* name of the load case */
    char set[HF_SET_NAME_SIZE];  /* cables that have the temperature; "": the part has the temperature */
    hf_part part;                /* part that has the temperature */
    double temperature_K;        /* difference from the temperature at which the net was cut and the truss was made */
    double gradient_K_per_m[3];  /* increase of the temperature in proportion to the position; 0 at the origin */
    double gravity_m_per_s2;     /* gravitational acceleration */
    double direction[3];         /* direction of gravity; default: -z */
    hf_nodes role;               /* nodes on which force_N acts */
    double force_N[3];           /* force on each of these nodes */
    double support_displacement_m[3]; /* displacement of all supports */
    char nodes_path[HF_PATH_SIZE];    /* table of forces and displacements by node; "": none */
} hf_load_case_settings;

#define HF_LOAD_CASE_ROWS_MAX 32 /* maximum number of rows of `load_cases` */
#define HF_LOAD_CASES_MAX 16     /* maximum number of load cases */

/* Contains the material and the load cases of the as-built net. */
typedef struct {
    int n_cable, n_node, n_load_case;                       /* numbers of rows */
    hf_cable_settings cable[HF_MATERIAL_ROWS_MAX];          /* [n_cable] rows of `cables` */
    hf_node_settings node[HF_MATERIAL_ROWS_MAX];            /* [n_node] rows of `nodes` */
    hf_load_case_settings load_case[HF_LOAD_CASE_ROWS_MAX]; /* [n_load_case] rows of `load_cases` */
} hf_built_settings;

/* When an as-built net is adjusted, psi is measured from the target positions or from the positions of the design. */
typedef enum { HF_AIM_TARGET, HF_AIM_DESIGN } hf_aim;

/* Contains the settings of the turnbuckles of an as-built net (section `adjust`). The adjustment lengthens or shortens
 * some cables of the set by whole steps within a range. The adjustment reduces the value of `figure`. */
typedef struct {
    char set[HF_SET_NAME_SIZE]; /* cables with turnbuckles: name of a set, or inner, boundary, all */
    double range_m, step_m;     /* maximum change of the cut length in either direction, and step */
    int max_adjustments;        /* maximum number of adjusted cables */
    double target_m;            /* no further cable is adjusted if the figure is below this value */
    hf_figure_kind figure;      /* HF_FIGURE_PSI, HF_FIGURE_SURFACE or HF_FIGURE_FACETS */
    hf_aim aim;                 /* positions from which psi is measured */
    double sigma_m; /* standard deviation of measured coordinates that have none of their own; 0: not given */
} hf_adjust_settings;

/* The enumeration hf_distribution selects the distribution of errors. The enumeration hf_sampling selects the method
 * that chooses samples of the errors. */
typedef enum { HF_DISTRIBUTION_NORMAL, HF_DISTRIBUTION_UNIFORM } hf_distribution;
typedef enum { HF_SAMPLING_RANDOM, HF_SAMPLING_SOBOL } hf_sampling;

/* Each row X(name, word, unit, condition, description) defines a measure of a sample of the as-built net. Case files
 * and result files contain the words. A measure exists if its condition is met:
 *
 *   ALWAYS       always
 *   SURFACE      with a section surface
 *   FACETS       with a section surface if the net has facets
 *   LOSS         with frequencies of the surface
 *   FACET_LOSS   with frequencies if the net has facets
 *   PATTERN      with a section surface.pattern if the net has facets
 *
 * The losses have the same order as the half-path errors from which they are computed. */
#define HF_TOLERANCE_MEASURES(X)                                                                                       \
    X(PSI, "psi_m", "m", ALWAYS, "RMS distance of the inner nodes to their target positions")                          \
    X(HALF_PATH, "half_path_rms_m", "m", SURFACE, "of the inner nodes to the target surface")                          \
    X(FIT_HALF_PATH, "fit_half_path_rms_m", "m", SURFACE, "the same after the best fit")                               \
    X(FACET_HALF_PATH, "facet_half_path_rms_m", "m", FACETS, "of the facets to the target surface")                    \
    X(FACET_FIT_HALF_PATH, "facet_fit_half_path_rms_m", "m", FACETS, "the same after the best fit")                    \
    X(GAIN_LOSS, "gain_loss_dB", "dB", LOSS,                                                                           \
      "of gain (Ruze) by half_path_rms_m at the highest frequency; infinite beyond 3 dB")                              \
    X(FIT_GAIN_LOSS, "fit_gain_loss_dB", "dB", LOSS, "the same by fit_half_path_rms_m")                                \
    X(FACET_GAIN_LOSS, "facet_gain_loss_dB", "dB", FACET_LOSS, "the same by facet_half_path_rms_m")                    \
    X(FACET_FIT_GAIN_LOSS, "facet_fit_gain_loss_dB", "dB", FACET_LOSS, "the same by facet_fit_half_path_rms_m")        \
    X(PATTERN_LOSS, "pattern_loss_dB", "dB", PATTERN,                                                                  \
      "in the direction of the beam at the highest frequency, by physical optics over the facets")                     \
    X(MIN_TENSION, "tension_min_N", "N", ALWAYS, "smallest tension of a cable")                                        \
    X(SLACK, "n_slack", "", ALWAYS, "slack cables")                                                                    \
    X(LOOSE, "n_loose", "", ALWAYS, "nodes that no taut cable holds")

#define HF_TOLERANCE_ENUMERATOR(name, word, unit, condition, description) HF_TOLERANCE_##name,
/* One measure of a sample. */
typedef enum { HF_TOLERANCE_MEASURES(HF_TOLERANCE_ENUMERATOR) HF_TOLERANCE_N_MEASURE } hf_tolerance_measure;
#undef HF_TOLERANCE_ENUMERATOR

/* One row of the old list tolerance.require, which hf_config_load converts to a row of `requirements`. */
typedef struct {
    int measure;              /* index of the old word */
    double at_most, at_least; /* bounds in the unit of the measure; NaN: not given */
} hf_require_settings;

#define HF_REQUIRE_ROWS_MAX 8 /* maximum number of rows of tolerance.require */

/* Describes one row of tolerance.truss. A row of tolerance.truss contains the temperature error that all members of a
 * part have in common. */
typedef struct {
    int part;                   /* 0: the whole truss; 1 + k: the members of hf_unit k */
    double sigma_temperature_K; /* standard deviation of the temperature */
} hf_truss_heat_settings;

#define HF_TRUSS_HEAT_ROWS_MAX 8 /* maximum number of rows of tolerance.truss, one for each part */

/* Contains the errors of the as-built net (section `tolerance`). The errors are standard deviations for every
 * distribution. */
typedef struct {
    double sigma_cut_m, sigma_cut_ratio; /* errors of cut lengths: absolute value, and value relative to the length */
    double sigma_support_m;              /* error of each coordinate of a support */
    double sigma_EA_ratio;               /* error of EA relative to EA */
    double sigma_temperature_K;          /* error of the temperature, which is the same for all cables */
    /* errors of what load cases prescribe: temperature of the cables, gravity and forces relative to their values */
    double sigma_load_case_temperature_K, sigma_gravity_ratio, sigma_force_ratio;
    hf_distribution distribution; /* distribution of the errors */
    double batch;         /* correlation of the relative length errors, and of the relative EA errors, within a spool */
    int samples;          /* number of samples */
    uint64_t seed;        /* seed of the random numbers */
    hf_sampling sampling; /* method by which samples are chosen */
    int find_scale;       /* 1: find the factor of all errors at which the samples have their required shares */
    int n_truss;          /* number of rows */
    hf_truss_heat_settings truss[HF_TRUSS_HEAT_ROWS_MAX]; /* [n_truss] rows of tolerance.truss */
    /* Keys before `requirements`, which hf_config_load converts; nothing else reads them. */
    double required_yield;
    int n_require;
    hf_require_settings require[HF_REQUIRE_ROWS_MAX];
} hf_tolerance_settings;

/* Returns true if temperatures of cables have errors. */
static inline bool hf_tolerance_is_warm(const hf_tolerance_settings *s)
{
    return s->sigma_temperature_K > 0 || s->sigma_load_case_temperature_K > 0;
}

/* A row of `requirements` constrains the search, or is judged at the end of the run alone. */
typedef enum { HF_SEARCH_ON, HF_SEARCH_OFF } hf_constrains;

/* Each row X(name, word, unit, description) defines a figure that a row of `requirements` can bound. A figure of a set
 * of cables or of supports is judged by its worst cable or support. */
#define HF_REQUIRED_FIGURES(X)                                                                                         \
    X(PSI, "psi", "m", "RMS distance of the inner nodes from their target positions")                                  \
    X(SURFACE, "surface", "m", "RMS half-path error of the inner nodes")                                               \
    X(FACETS, "facets", "m", "RMS half-path error of the facets")                                                      \
    X(GAIN_LOSS, "gain_loss", "dB", "loss of gain relative to the smooth target surface, by physical optics")          \
    X(GAIN, "gain", "dBi", "gain by physical optics")                                                                  \
    X(POINTING, "pointing", "deg", "angle between the main beam and the beam of the feed, by physical optics")         \
    X(TENSION, "tension", "N", "tension of each cable of the set")                                                     \
    X(RATIO, "ratio", "", "ratio of maximum to minimum tension in the set")                                            \
    X(SLACK, "slack_cables", "", "number of slack cables in the set")                                                  \
    X(LOOSE, "loose_nodes", "", "number of nodes that no taut cable holds")                                            \
    X(DEFLECTION, "deflection", "m", "displacement of each attachment by the forces of the net")                       \
    X(PULL, "pull", "N", "force of the net on each support")                                                           \
    X(MASS, "mass", "kg", "mass of the cables of the set")
#define HF_REQUIRED_ENUMERATOR(name, word, unit, description) HF_REQUIRED_##name,
typedef enum { HF_REQUIRED_FIGURES(HF_REQUIRED_ENUMERATOR) HF_REQUIRED_N_FIGURE } hf_required_figure;
#undef HF_REQUIRED_ENUMERATOR
/* Figures of a set of cables, errors of the surface, figures at a frequency, and all figures that have a feed. */
enum {
    HF_REQUIRED_OF_SET =
        1 << HF_REQUIRED_TENSION | 1 << HF_REQUIRED_RATIO | 1 << HF_REQUIRED_SLACK | 1 << HF_REQUIRED_MASS,
    HF_REQUIRED_OF_SURFACE = 1 << HF_REQUIRED_SURFACE | 1 << HF_REQUIRED_FACETS,
    HF_REQUIRED_OF_RADIO = 1 << HF_REQUIRED_GAIN_LOSS | 1 << HF_REQUIRED_GAIN | 1 << HF_REQUIRED_POINTING,
    HF_REQUIRED_OF_FEED = HF_REQUIRED_OF_SURFACE | HF_REQUIRED_OF_RADIO
};
/* Returns whether a figure is one of these. */
static inline bool hf_required_is_of(hf_required_figure figure, int figures)
{
    return (figures >> figure & 1) != 0;
}
/* Words of the figures, terminated by NULL, and their units. */
extern const char *const hf_required_figure_word[HF_REQUIRED_N_FIGURE + 1];
extern const char *const hf_required_figure_unit[HF_REQUIRED_N_FIGURE];

/* One row of `requirements`. A row bounds a figure of the design or, with a share, of the as-built samples. */
typedef struct {
    hf_required_figure figure;        /* bounded figure */
    char set[HF_SET_NAME_SIZE];       /* cables of the figures tension, ratio, slack_cables and mass; "": all */
    hf_focus feed;                    /* feed of errors of the surface and of figures at a frequency */
    double frequency_Hz;              /* frequency of the figures gain_loss, gain and pointing; NaN: none */
    char load_case[HF_SET_NAME_SIZE]; /* "nominal", the name of a load case, or "all" for nominal and all load cases */
    double at_least, at_most;         /* bounds in the unit of the figure; NaN: not given */
    double within[2];                 /* both bounds in one key; infinite if not given. The bounds are then copied */
    double share;                     /* required share of the as-built samples; NaN: nominal net */
    hf_constrains search;             /* whether the row constrains the search */
} hf_requirement_settings;

#define HF_REQUIREMENT_ROWS_MAX 32 /* maximum number of rows of `requirements` */

#define HF_LIST_MAX 32 /* maximum number of values in a list */

/* Contains a list of numbers from a case file. */
typedef struct {
    int n;                     /* number of values */
    double value[HF_LIST_MAX]; /* [n] the values */
} hf_double_list;

/* Feed that illuminates the reflector. HF_FEED_AUTO selects a line feed for a cylinder and a point feed for other
 * surfaces. */
typedef enum { HF_FEED_AUTO, HF_FEED_POINT, HF_FEED_LINE, HF_FEED_PLANE_WAVE } hf_feed_kind;
/* Selects the polarisation of the field of the feed on its axis. */
typedef enum { HF_POLARISATION_X, HF_POLARISATION_Y } hf_polarisation;

#define HF_PATTERN_CUTS 8 /* maximum number of cuts */

/* Contains the settings of the far field of the reflector (section surface.pattern, see pattern.h). If a value of the
 * feed is NaN, its default follows from the target surface. */
typedef struct {
    double theta_deg[2];    /* first and last angle of each cut, measured from +z */
    int n_theta;            /* number of angles, at equal steps */
    hf_double_list phi_deg; /* angle of each cut, measured from +x; at most HF_PATTERN_CUTS angles */
    hf_feed_kind feed;      /* kind of the feed */
    /* position of the feed, and point to which it is directed; a line feed runs along y */
    double position_m[3], aim_m[3];
    double cos_power;             /* exponent q: the field is cos^q of the angle from the axis */
    hf_polarisation polarisation; /* polarisation of the feed */
} hf_pattern_settings;

/* Reflecting surface (section surface). The surface is the parabolic cylinder z = x^2/(4f) along y or the paraboloid z
 * = (x^2 + y^2)/(4f). */
typedef struct {
    double focal_length_m;         /* focal length f; 0: the surface is not measured */
    double strip_width_m;          /* width of the flat strips along y that make up the surface; 0: unknown */
    hf_double_list frequencies_Hz; /* frequencies of the gain losses and of the far field */
    double mesh_tension_N_per_m;   /* tension of the mesh in all directions; 0: unknown */
    hf_surface_kind kind;        /* kind of the surface; HF_SURFACE_AUTO until hf_config_surface determines the kind */
    bool has_pattern;            /* true: the far field is computed */
    hf_pattern_settings pattern; /* settings of the far field */
} hf_surface_settings;

HF_API_END
