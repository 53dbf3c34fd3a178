/* settings - all settings of the engine, as plain values.
 * Stability: stable.
 *
 * hf_config_load fills them in from a case file; `hifdm schema` says what each means. A program may also set them
 * itself. */
#ifndef HIFDM_SETTINGS_H
#define HIFDM_SETTINGS_H

#include <hifdm/api.h>
#include <stdbool.h>
#include <stdint.h>

HF_API_BEGIN

/* Choices of a case file; `hifdm schema` says what each means. */
typedef enum { HF_METHOD_HIFDM, HF_METHOD_ITERATIVE_FDM, HF_METHOD_FDM, HF_METHOD_NEWTON, HF_METHOD_AUTO } hf_method;
/* X(enumerator, word). HF_OPTIMISER_LIST has a row for each, with the optimiser that it uses. */
#define HF_OPTIMIZE_METHODS(X) X(GA, "ga") X(LM, "lm") X(GA_LM, "ga+lm")
#define HF_OPTIMIZE_ENUMERATOR(name, word) HF_OPTIMIZE_##name,
typedef enum { HF_OPTIMIZE_METHODS(HF_OPTIMIZE_ENUMERATOR) HF_OPTIMIZE_N_METHOD } hf_optimize_method;
#undef HF_OPTIMIZE_ENUMERATOR
typedef enum { HF_FACTOR_OWN, HF_FACTOR_LAPACK } hf_factor; /* of positive definite matrices of form-finding */
typedef enum { HF_SOLVER_AUTO, HF_SOLVER_CHORD, HF_SOLVER_NEWTON, HF_SOLVER_FIXED_POINT } hf_solver;
typedef enum { HF_PRESTRESS_GIVEN, HF_PRESTRESS_EXACT } hf_prestress;
typedef enum { HF_STOP_RESIDUAL, HF_STOP_RMS_CHANGE } hf_stop_rule;
typedef enum { HF_RULE_FORCE_DENSITY, HF_RULE_TENSION, HF_RULE_SEEDED } hf_rule;
typedef enum { HF_COUPLING_ACCELERATED, HF_COUPLING_PLAIN, HF_COUPLING_AUTO } hf_coupling_scheme;
typedef enum { HF_COMPARE_AUTO, HF_COMPARE_TRUE, HF_COMPARE_FALSE } hf_compare;
typedef enum { HF_VARIATION_DIFFERENCE, HF_VARIATION_CHAIN } hf_variation;
typedef enum { HF_KEEP_ALL, HF_KEEP_BEST, HF_KEEP_EVERY } hf_keep;
typedef enum { HF_SURFACE_AUTO, HF_SURFACE_PARABOLIC_CYLINDER, HF_SURFACE_PARABOLOID } hf_surface_kind;
typedef enum { HF_SYMMETRY_NONE, HF_SYMMETRY_X, HF_SYMMETRY_Y, HF_SYMMETRY_XY, HF_SYMMETRY_AUTO } hf_symmetry;

/* What a row of optimize.variables varies of each cable of its set, or of the supports at which its cables end. */
typedef enum {
    HF_VARY_TENSION,           /* N, of a cable held at it */
    HF_VARY_FORCE_DENSITY,     /* N/m */
    HF_VARY_LENGTH,            /* m */
    HF_VARY_UNSTRESSED_LENGTH, /* m, of cables of law elastic */
    HF_VARY_SUPPORT_Z,         /* m, from where the net has the support */
    HF_VARY_SUPPORT_NORMAL,    /* the same along the normal of the wanted surface */
    HF_VARY_SUPPORT_XYZ,       /* three variables for each support */
    HF_VARY_PRETENSION         /* of no row: N, what optimize.rule makes of the pretension of a boundary cable */
} hf_vary;
/* Which variables of a row change by the same step: none, all, or those at mirrored places (optimize.symmetry). */
typedef enum { HF_LINK_EACH, HF_LINK_SET, HF_LINK_SYMMETRY } hf_link;

/* What a row of optimize.goals or optimize.objectives measures; each is zero or more, and less is better. */
typedef enum {
    HF_GOAL_PSI,          /* m, distance of the inner nodes to their theoretical places, RMS */
    HF_GOAL_SURFACE,      /* m, distance of the inner nodes to the wanted surface, RMS */
    HF_GOAL_FACETS,       /* m, distance of the facets to it, RMS */
    HF_GOAL_TENSION,      /* N, difference of tensions to `target`, RMS over the set */
    HF_GOAL_LENGTH,       /* m, difference of lengths to `target`, RMS over the set */
    HF_GOAL_EVENNESS,     /* standard deviation of the tensions of the set over their mean */
    HF_GOAL_PULL,         /* N, largest force of the net on a support */
    HF_GOAL_DISPLACEMENT, /* m, largest displacement of an attachment by the truss */
    HF_GOAL_MASS,         /* kg, of the cables of the set at mass_kg_per_m */
    HF_GOAL_RATIO,        /* largest over smallest tension of the set */
    HF_GOAL_GAIN          /* root of the part of the gain that is lost in the direction of the beam */
} hf_goal_kind;
typedef enum { HF_ALONG_NORMAL, HF_ALONG_HALF_PATH } hf_along;
typedef enum { HF_FIT_NONE, HF_FIT_BEST } hf_fit; /* the wanted surface itself, or its best fit to the shape */

/* Of what a goal is: the design, all states of the net that is cut for it, or samples of its errors; and which figure
 * of these: the root of the mean of squares, or the largest. */
typedef enum { HF_OVER_DESIGN, HF_OVER_STATES, HF_OVER_SAMPLES } hf_over;
typedef enum { HF_TAKE_MEAN, HF_TAKE_WORST } hf_take;

/* What a row of optimize.limits keeps between bounds. */
typedef enum {
    HF_LIMIT_TENSION,     /* N, of each cable of the set */
    HF_LIMIT_RATIO,       /* largest over smallest tension of the set */
    HF_LIMIT_DISPLACEMENT /* m, of each attachment */
} hf_limit_kind;

/* The words of these choices in a case file, indexed by the enumerations above; the last entry is NULL. */
extern const char *const hf_method_word[6];
extern const char *const hf_prestress_word[3];
extern const char *const hf_stop_rule_word[3];
extern const char *const hf_factor_word[3];
extern const char *const hf_rule_word[4];
extern const char *const hf_solver_word[5];
extern const char *const hf_optimize_method_word[HF_OPTIMIZE_N_METHOD + 1];
extern const char *const hf_compare_word[4];
extern const char *const hf_variation_word[3];
extern const char *const hf_keep_word[4];
extern const char *const hf_symmetry_word[6];
extern const char *const hf_nodes_word[5];
extern const char *const hf_part_word[11];
extern const char *const hf_surface_kind_word[4];
extern const char *const hf_feed_word[5];
extern const char *const hf_polarisation_word[3];
extern const char *const hf_coupling_scheme_word[4];
extern const char *const hf_vary_word[8];
extern const char *const hf_link_word[4];
extern const char *const hf_goal_word[12];
extern const char *const hf_goal_unit[11]; /* of the values; "" where they have none */
extern const char *const hf_along_word[3];
extern const char *const hf_fit_word[3];
extern const char *const hf_over_word[4];
extern const char *const hf_take_word[3];
extern const char *const hf_limit_word[4];
extern const char *const hf_figure_word[4]; /* the first goals, those that are figures of a shape */

/* Room for the path of a case, a study or a table of a net or truss; a longer one is refused. */
#define HF_PATH_SIZE 1024

/* The point of a front that a run takes for its result, in place of a search. */
typedef struct {
    int point;               /* its number, from 1; 0: none is taken */
    char path[HF_PATH_SIZE]; /* of the result with the front, as it was given */
    char sha256[65];         /* of its design */
} hf_front_origin;

extern const char *const hf_distribution_word[3];
extern const char *const hf_sampling_word[3];
extern const char *const hf_tolerance_measure_word[]; /* by hf_tolerance_measure, ended by NULL */

#define HF_SET_NAME_SIZE 64 /* of the name of a set of cables with its NUL */

/* A row of optimize.variables. Values in the unit of what varies. */
typedef struct {
    char set[HF_SET_NAME_SIZE]; /* of cables, or inner, boundary, all */
    hf_vary vary;
    double range;        /* how far each may move from its value after form-finding; NaN: as far as the bounds */
    double range_ratio;  /* the same over that value (`range: 30 %`); NaN: `range` holds */
    double lower, upper; /* `bounds`; infinite where none are given */
    hf_link link;
} hf_variable_settings;

/* A row of optimize.goals, or of optimize.objectives, where weight is nothing. */
typedef struct {
    hf_goal_kind goal;
    char set[HF_SET_NAME_SIZE];   /* of tension, length, evenness, mass, ratio; "": all */
    double target;                /* of tension and length; NaN: of lengths the theoretical ones */
    double weight;                /* the merit of a design is sqrt(sum (weight * value)^2) */
    double mass_kg_per_m;         /* of mass */
    hf_along along;               /* of surface and facets */
    hf_fit fit;                   /* the same */
    char state[HF_SET_NAME_SIZE]; /* of `cases`; "": `over` says */
    hf_over over;
    hf_take take;        /* of states and samples */
    double quantile;     /* of samples, instead of `take`: so large a part has no larger value; 0 or NaN: none */
    double frequency_Hz; /* of gain; 0 or NaN: the highest of the surface */
} hf_goal_settings;

/* A row of optimize.limits. */
typedef struct {
    hf_limit_kind limit;
    char set[HF_SET_NAME_SIZE]; /* of tension and ratio; "": all */
    double lower, upper;        /* `bounds`; infinite where none is given */
} hf_limit_settings;

#define HF_DESIGN_ROWS_MAX 16 /* rows of each of these lists */
#define HF_OBJECTIVES_MAX 3   /* rows of optimize.objectives */
#define HF_FRONT_POINTS_MAX 512
#define HF_GOAL_NAME_SIZE 112 /* of a goal in tables: "goal_15_displacement_" and the name of a set */

/* How a net is coupled with an elastic truss. They are not used without a truss. */
typedef struct {
    double tof_m; /* largest difference of an attachment's displacements in two iterations */
    hf_coupling_scheme scheme;
    int max_iterations;
} hf_coupling_settings;

typedef struct {
    hf_method method;
    double pretension_N; /* Td */
    hf_prestress prestress;
    hf_stop_rule stop;
    double residual_tolerance; /* max nodal residual relative to the pretension */
    double length_tolerance;   /* max |l/L*-1| of cables under the length law */
    double rms_tolerance_m;    /* change of psi between iterations, the paper's rule */
    int max_iterations;        /* bound on the linear solves */
    double collapse_ratio; /* a cable of law tension shorter than this part of its theoretical length has collapsed */
    hf_coupling_settings coupling;
    hf_factor factor;
} hf_form_settings;

typedef struct {
    hf_optimize_method method;
    hf_rule rule;                        /* what a design (a set of boundary pretensions) means */
    hf_solver solver;                    /* of the individuals */
    int population, generations;         /* individuals; largest number of generations */
    double range_N;                      /* |dT| of Eq. 13 */
    double min_tension_N, max_tension_N; /* bounds on T' */
    double boundary_ratio_cap;           /* largest allowed boundary tension ratio of an individual */
    uint64_t seed;
    double crossover_high, crossover_low; /* Pc1, Pc2 */
    double mutation_high, mutation_low;   /* Pm1, Pm2 */
    hf_variation variation;               /* how the genetic algorithm makes children */
    int elites;                           /* best individuals: kept unchanged, and what crossovers move */
    double stagnation_tolerance_m;        /* stop when the best psi improved by less than this ... */
    int stagnation_generations;           /* ... in so many generations */
    int polish_iterations;                /* bound on the iterations of Levenberg-Marquardt */
    hf_compare compare_lm;                /* Levenberg-Marquardt after method ga, for comparison */
    hf_symmetry symmetry;                 /* mirror planes that link genes */
    hf_keep store;                        /* what a result file holds of the generations */
    int store_every;                      /* of HF_KEEP_EVERY: whole generations so far apart */
    int n_variable, n_goal, n_limit;      /* 0: the pretensions of the boundary by rule and range_N; psi; no limits */
    hf_variable_settings variable[HF_DESIGN_ROWS_MAX];
    hf_goal_settings goal[HF_DESIGN_ROWS_MAX];
    hf_limit_settings limit[HF_DESIGN_ROWS_MAX];
    int n_objective; /* 0, or 2 or 3 instead of goals: the front of designs of which none is better in all of them */
    hf_goal_settings objective[HF_OBJECTIVES_MAX];
    int front_points; /* of this front */
    int samples;      /* of goals over samples: the first so many of the random ones of `tolerance` */
} hf_optimize_settings;

/* Is a goal, or an objective, over samples of nets with errors? */
bool hf_optimize_takes_samples(const hf_optimize_settings *settings);

/* A row of `cables`: what the cables of a set are made of. NaN where it is not given. */
typedef struct {
    char set[HF_SET_NAME_SIZE]; /* of cables, or inner, boundary, all */
    double expansion_per_K, mass_kg_per_m;
} hf_cable_settings;

/* Which nodes a row names: all, or those of a role. */
typedef enum { HF_NODES_ALL, HF_NODES_SUPPORT, HF_NODES_INNER, HF_NODES_EDGE } hf_nodes;

/* A row of `nodes`. */
typedef struct {
    hf_nodes role;
    double mass_kg; /* of each */
} hf_node_settings;

#define HF_MATERIAL_ROWS_MAX 16 /* rows of each of these lists */

/* What the temperature of a row of `cases` is that of: members of the truss by hf_unit from HF_PART_UNIT on. */
typedef enum { HF_PART_ALL, HF_PART_NET, HF_PART_TRUSS, HF_PART_UNIT } hf_part;

/* A row of `cases`; rows with the same name are one state. NaN where a number is not given. */
typedef struct {
    char name[HF_SET_NAME_SIZE];
    char set[HF_SET_NAME_SIZE]; /* of cables whose temperature it is; "": `part` says */
    hf_part part;
    double temperature_K;          /* difference to that at which the net was cut and the truss made */
    double gradient_K_per_m[3];    /* added to it, linear in the place from the origin */
    double gravity_m_per_s2;       /* weight */
    double direction[3];           /* in which it pulls; default: -z */
    hf_nodes role;                 /* nodes on which force_N acts */
    double force_N[3];             /* on each of them */
    double move_m[3];              /* of all supports */
    char nodes_path[HF_PATH_SIZE]; /* table of forces and moves by node; "": none */
} hf_state_settings;

#define HF_STATE_ROWS_MAX 32 /* rows of `cases` */
#define HF_STATES_MAX 16     /* states that they may name */

/* The net as built. */
typedef struct {
    int n_cable, n_node, n_state;
    hf_cable_settings cable[HF_MATERIAL_ROWS_MAX];
    hf_node_settings node[HF_MATERIAL_ROWS_MAX];
    hf_state_settings state[HF_STATE_ROWS_MAX];
} hf_built_settings;

/* The places that psi of a net that is adjusted is measured from. */
typedef enum { HF_AIM_THEORY, HF_AIM_DESIGN } hf_aim;
extern const char *const hf_aim_word[3]; /* "theory", "design", NULL */

/* Turnbuckles that bring the figure of the net as built back: some cables of a set, by whole steps within a range. */
typedef struct {
    char set[HF_SET_NAME_SIZE]; /* cables that can be turned */
    double range_m, step_m;     /* how far either way, and in which steps */
    int moves;                  /* cables that are turned at most */
    double target_m;            /* enough when the figure is below it */
    hf_goal_kind figure;        /* HF_GOAL_PSI, HF_GOAL_SURFACE or HF_GOAL_FACETS */
    hf_aim aim;                 /* of psi */
    double sigma_m;             /* of measured coordinates without one of their own; 0: not given */
} hf_adjust_settings;

/* How errors are distributed, and how samples of them are chosen. */
typedef enum { HF_DISTRIBUTION_NORMAL, HF_DISTRIBUTION_UNIFORM } hf_distribution;
typedef enum { HF_SAMPLING_RANDOM, HF_SAMPLING_SOBOL } hf_sampling;

/* X(name, word, unit, condition, description): what is measured of each sample of the net as built. The words are in
 * case files and result files. Conditions: ALWAYS, SURFACE (a section surface), FACETS (it has facets), LOSS (it has
 * frequencies), FACET_LOSS (both), PATTERN (it has facets and a section pattern). Losses stand in the order of the
 * half-path errors that make them. */
#define HF_TOLERANCE_MEASURES(X)                                                                                       \
    X(PSI, "psi_m", "m", ALWAYS, "RMS distance of the inner nodes to their theoretical places")                        \
    X(HALF_PATH, "half_path_rms_m", "m", SURFACE, "of the inner nodes to the wanted surface")                          \
    X(FIT_HALF_PATH, "fit_half_path_rms_m", "m", SURFACE, "the same after the best fit")                               \
    X(FACET_HALF_PATH, "facet_half_path_rms_m", "m", FACETS, "of the facets to the wanted surface")                    \
    X(FACET_FIT_HALF_PATH, "facet_fit_half_path_rms_m", "m", FACETS, "the same after the best fit")                    \
    X(GAIN_LOSS, "gain_loss_dB", "dB", LOSS,                                                                           \
      "of gain (Ruze) by half_path_rms_m at the highest frequency; infinite beyond 3 dB")                              \
    X(FIT_GAIN_LOSS, "fit_gain_loss_dB", "dB", LOSS, "the same by fit_half_path_rms_m")                                \
    X(FACET_GAIN_LOSS, "facet_gain_loss_dB", "dB", FACET_LOSS, "the same by facet_half_path_rms_m")                    \
    X(FACET_FIT_GAIN_LOSS, "facet_fit_gain_loss_dB", "dB", FACET_LOSS, "the same by facet_fit_half_path_rms_m")        \
    X(PATTERN_LOSS, "pattern_loss_dB", "dB", PATTERN,                                                                  \
      "in the direction of the beam at the highest frequency, by physical optics over the facets")                     \
    X(LEAST_TENSION, "least_tension_N", "N", ALWAYS, "smallest tension of a cable")                                    \
    X(SLACK, "n_slack", "", ALWAYS, "slack cables")                                                                    \
    X(LOOSE, "n_loose", "", ALWAYS, "nodes that no taut cable holds")

#define HF_TOLERANCE_ENUMERATOR(name, word, unit, condition, description) HF_TOLERANCE_##name,
typedef enum { HF_TOLERANCE_MEASURES(HF_TOLERANCE_ENUMERATOR) HF_TOLERANCE_N_MEASURE } hf_tolerance_measure;
#undef HF_TOLERANCE_ENUMERATOR

/* A row of tolerance.require. */
typedef struct {
    hf_tolerance_measure measure;
    double at_most, at_least; /* NaN: not given */
} hf_require_settings;

#define HF_REQUIRE_ROWS_MAX 8

/* A row of tolerance.truss: a temperature of its own of all members of a part. */
typedef struct {
    int part; /* from HF_PART_TRUSS on: 0 is the whole truss, 1 + k the members of hf_unit k */
    double sigma_temperature_K;
} hf_truss_heat_settings;

#define HF_TRUSS_HEAT_ROWS_MAX 8 /* each part once */

/* Errors of the net as built; standard deviations, whatever the distribution. */
typedef struct {
    double sigma_cut_m, sigma_cut_ratio; /* of cut lengths: absolute, and over the length */
    double sigma_support_m;              /* of each coordinate of a support */
    double sigma_EA_ratio;               /* of EA over EA */
    double sigma_temperature_K;          /* of the one temperature that all cables have */
    hf_distribution distribution;
    double batch; /* correlation of the errors sigma_cut_ratio, and of sigma_EA_ratio, among cables of one spool */
    int samples;
    uint64_t seed;
    hf_sampling sampling;
    double yield; /* part of the nets that should meet what is required; 0 = not asked for */
    int n_require, n_truss;
    hf_require_settings require[HF_REQUIRE_ROWS_MAX];
    hf_truss_heat_settings truss[HF_TRUSS_HEAT_ROWS_MAX];
} hf_tolerance_settings;

#define HF_LIST_MAX 32

typedef struct {
    int n; /* number of values in use */
    double value[HF_LIST_MAX];
} hf_double_list;

/* What illuminates the reflector, and the polarisation of its field. HF_FEED_AUTO: a line of a cylinder, else a point.
 */
typedef enum { HF_FEED_AUTO, HF_FEED_POINT, HF_FEED_LINE, HF_FEED_PLANE_WAVE } hf_feed_kind;
typedef enum { HF_POLARISATION_X, HF_POLARISATION_Y } hf_polarisation;

#define HF_PATTERN_CUTS 8

/* The far field that is asked for (pattern.h). NaN: what the feed of the wanted surface has. */
typedef struct {
    double theta_deg[2];    /* angles from +z at which each cut begins and ends */
    int n_theta;            /* of them, at even steps */
    hf_double_list phi_deg; /* cuts, at most HF_PATTERN_CUTS */
    hf_feed_kind feed;
    double position_m[3], aim_m[3]; /* of the feed, and the point it looks at; a line is along y through it */
    double cos_power;               /* q: its field goes as cos^q of the angle from there */
    hf_polarisation polarisation;
} hf_pattern_settings;

/* The reflecting surface: the parabolic cylinder z = x^2/(4f) along y, or the paraboloid z = (x^2 + y^2)/(4f). */
typedef struct {
    double focal_length_m; /* 0 when no measures of the surface are asked for */
    double strip_width_m;  /* of the flat strips along y of which it consists; 0 = not known */
    hf_double_list frequencies_Hz;
    double mesh_tension_N_per_m; /* of the mesh on the front net, in all directions; 0 = not known */
    hf_surface_kind kind;        /* HF_SURFACE_AUTO in a case alone, until hf_config_surface has looked at the nodes */
    bool has_pattern;            /* false: no far field is asked for */
    hf_pattern_settings pattern;
} hf_surface_settings;

HF_API_END
#endif
