/* objectives - objectives of a design, as blocks of residuals of a shape with exact derivatives (METHOD section 7).
 * Stability: internal. This header may change in any version.
 *
 * Each row of optimize.objective or optimize.front has one block of residuals. The objectives of optimize.front have
 * the weight 1. Pipeline:
 *
 *   hf_objectives_measure                shape in a workspace -> values of the objectives, merit
 *   hf_objectives_linearise              shape -> weighted residuals, and the data of its derivatives
 *   hf_objectives_push                   rates of the shape by a design variable -> rates of the residuals
 *   hf_objectives_nets_linearise, _push, _close   the same steps for objectives over as-built nets
 *
 * Each objective has a value in its own unit (settings.h). The value of an objective is the norm of its residuals. The
 * merit of a design is sqrt(sum (weight * value)^2) over all objectives.
 *
 * The value of the objective pull or deflection is the maximum of several quantities s. The residuals of pull and
 * deflection have the smooth norm (sum s^16)^(1/16) instead of the maximum. For n quantities, the smooth norm is
 * between their maximum and n^(1/16) times their maximum. The merit contains the smooth norm instead of the maximum. A
 * tension ratio is the product of the maximum tension and the maximum of 1/tension. The smooth norm also replaces both
 * maxima of a tension ratio. If a shape does not determine the value of an objective, the value is NaN or infinite. For
 * example, psi is NaN if all nodes are loose, and a tension ratio is infinite if a cable of its set is slack. If a
 * surface has no best fit, an objective that requires the fit has no value. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/facets.h>
#include <hifdm/workspace.h>

HF_API_BEGIN

/* One objective. */
typedef struct {
    hf_objective_settings settings; /* row of the case for this objective */
    int n_cable;                    /* number of cables in the set of the objective */
    int *cable;                     /* [n_cable] cables of the set, in ascending order; NULL without a set */
    int n_shape_row;                /* number of residuals of one shape */
    bool takes_tail;                /* derivatives are needed: the mean of the worst samples replaces the quantile */
    int first_net, n_net;           /* as-built nets on which the objective is measured; n_net 0: the design itself */
    int first_row, n_row;           /* rows of the objective among all residuals, one shape after the other */
} hf_objective;

/* Contains the rates of change of a shape per unit of a design variable. */
typedef struct {
    const double *position_m; /* [3][n_node] rates of the positions by row, including supports, m */
    const double *tension_N;  /* [n_cable] rates of the tensions, N */
    /* [3 n_attachment] rates of the attachment displacements by the truss, m; NULL without a truss */
    const double *displacement_m;
} hf_objectives_rate;

/* Receives the shape of as-built net i_net. If the as-built net has no shape, the argument `shape` is NULL. Only the
 * fields position_m, tension_N, length_m, displacement_m and loose of the workspace are valid. */
typedef void hf_objectives_take(void *context, int i_net, const hf_workspace *shape);

/* Describes the as-built nets of a design on which objectives may be measured. The nets are the load cases of the
 * design, followed by samples of its errors. The module built/built_nets.h makes the as-built nets and supplies the
 * functions of this struct. This module calls the functions through pointers because built/built_nets.h depends on this
 * module. The shape of an as-built net depends only on the design and on the index of the net. */
typedef struct hf_objectives_nets {
    int n_load_case, n_sample; /* number of load cases and number of samples */
    /* Load cases in which the samples exist. Net n_load_case + s n_sample + i is sample i in state s. State 0 is the
     * nominal load case, and state s > 0 is load case sample_load_case[s]. They are in ascending order. */
    int n_sample_state;
    int sample_load_case[1 + HF_LOAD_CASES_MAX]; /* [n_sample_state] */
    const char *const *load_case_name;           /* [n_load_case] names of the load cases */
    /* Allocates the scratch memory *room of one thread. Returns HF_OK or HF_NO_MEMORY. Call `close` even if `open`
     * fails. */
    hf_status (*open)(const struct hf_objectives_nets *nets, void **room);
    /* Frees the scratch memory of a thread. */
    void (*close)(void *room);
    /* Cuts the as-built nets for the design whose shape is in the workspace. The other functions of this struct refer
     * to the design of the last call of `cut`. Returns HF_OK, HF_NO_MEMORY, or HF_BAD_CASE if the cables cannot be
     * cut. */
    hf_status (*cut)(void *room, const hf_workspace *design);
    /* Finds the shapes of n nets from index `first` on, and calls `take` for each of these nets. The function calls
     * `take` in the calling thread and in any order. */
    void (*solve)(void *room, int first, int n, hf_objectives_take *take, void *context);
    /* Finds the shape of one net and factors the matrix of the net in this shape. Sets *shape to a workspace that
     * `room` owns. Returns HF_OK, HF_NO_MEMORY, or HF_NOT_FINITE if the net has no shape. If the status is HF_OK, later
     * calls of `follow` refer to this net. */
    hf_status (*linearise)(void *room, int i_net, const hf_workspace **shape);
    /* Converts n rates of the design to rates of the as-built net. The number n must not exceed HF_OBJECTIVES_AT_ONCE.
     * The array by_net [n] points to arrays that `room` owns. */
    void (*follow)(void *room, int n, const hf_objectives_rate *by_design, hf_objectives_rate *by_net);
} hf_objectives_nets;
/* Returns the number of all nets. */
static inline int hf_objectives_nets_count(const hf_objectives_nets *nets)
{
    return nets->n_load_case + nets->n_sample_state * nets->n_sample;
}
#define HF_OBJECTIVES_AT_ONCE 8 /* maximum number of rates in one call of `follow` */

/* Writes the rates of the shape of the design by variable i_rate to move_m [3][n_node] and tension_rate [n_cable].
 * Returns the rates of the attachment displacements [3 n_attachment]. */
typedef const double *hf_constraints_spread(const void *context, int i_rate, double *move_m, double *tension_rate);

/* Describes bounds of a quantity of the shape: a row of optimize.limits, or a constraint. */
typedef struct {
    hf_limit_kind kind;  /* the quantity */
    double lower, upper; /* bounds in the unit of the quantity; an open side is infinite */
    int n_cable;         /* number of cables of the row; 0 for displacements of attachments */
    const int *cable;    /* [n_cable] cables whose tensions or tension ratio are bounded */
} hf_limit;

/* Describes the constraints that rows of `requirements` set on designs (METHOD section 14). The module
 * built/constraints.h makes them. This module calls the functions through pointers because built/constraints.h depends
 * on this module. A constraint is the signed distance of a figure from its bound. A design is feasible if no distance
 * is above 0. */
typedef struct hf_constraints {
    int n;              /* number of constraints */
    const double *unit; /* [n] distances in this unit make up the violation of a design */
    /* Allocates the scratch memory *room of one thread. Returns HF_OK or HF_NO_MEMORY. Call `close` even if `open`
     * fails. */
    hf_status (*open)(const struct hf_constraints *constraints, void **room);
    /* Frees the scratch memory of a thread. */
    void (*close)(void *room);
    /* Measures the design whose shape is in the workspace. The array value [n] receives the distances. If is_smooth is
     * true, a constraint over samples is the mean of the worst samples, otherwise their quantile. Returns HF_OK or
     * HF_NO_MEMORY. */
    hf_status (*measure)(void *room, const hf_workspace *design, bool is_smooth, double *value);
    /* Computes rate [n][n_rate], the derivatives of the smooth distances of the design measured last. Returns HF_OK or
     * HF_NO_MEMORY. */
    hf_status (*linearise)(void *room, int n_rate, hf_constraints_spread *spread, const void *context, double *rate);
    double psi_most_m; /* maximum psi of the design, or 0 if no constraint is about it */
    int psi;           /* constraint of this maximum */
    /* [n] the same constraint as a limit on each cable or attachment of the design; NULL: it is none */
    const hf_limit *const *limit;
} hf_constraints;

/* Contains the objectives of a case, prepared for the model. The objectives do not change after creation. Threads can
 * therefore share the objectives. */
typedef struct {
    const hf_model *model;                      /* the net; borrowed */
    hf_surface_kind kind;                       /* kind of the target surface; used by surface and facets */
    double focal_length_m;                      /* focal length of the target surface; used by surface and facets */
    int n_facet;                                /* number of facets */
    int *corner_row;                            /* [n_facet][4] rows of the corner nodes; used by facets and gain */
    struct hf_gain_beam *beam;                  /* [n_objective] data of the beam for each objective gain */
    int n_objective, n_row;                     /* number of objectives, and number of all residuals */
    hf_objective objective[HF_DESIGN_ROWS_MAX]; /* [n_objective] the objectives */
    const hf_objectives_nets *nets;    /* as-built nets, borrowed; NULL if no objective is measured on as-built nets */
    const hf_constraints *constraints; /* constraints by requirements, borrowed; NULL: none */
    bool replaces_psi; /* true: the last objective replaces the constraint on psi, which is not judged */
    void *block;       /* owned memory behind the arrays */
} hf_objectives;

/* Returns true if constraint k is judged: the last objective does not replace it. */
static inline bool hf_objectives_judges(const hf_objectives *objectives, int k)
{
    return !objectives->replaces_psi || k != objectives->constraints->psi;
}

/* Contains the memory of one thread for the objectives. In addition to scratch memory, the struct contains the data
 * that hf_objectives_linearise prepares for hf_objectives_push. */
typedef struct hf_objectives_point {
    double *psi_per_m;             /* [n_inner_node] residual of psi divided by the distance; 0 for a loose node */
    double *force_N;               /* [n_support][3] scratch: forces of the net on the supports */
    double *rate_N;                /* [n_support][3] scratch: rates of these forces */
    double *size;                  /* scratch: [n_support], [n_attachment] or, for a ratio, [2 n_cable] */
    double *row;                   /* [n_row] scratch */
    struct hf_gain *gain;          /* [n_objective] scratch of each objective gain */
    struct hf_cloud *cloud;        /* [n_objective] points, errors and best fit of the objectives surface and facets */
    void *nets;                    /* scratch of as-built nets; NULL without nets */
    void (*free_nets)(void *room); /* frees `nets` */
    double *net_value; /* [n_objective][number of nets] value in each net; infinite if the net has no shape */
    double *net_norm;  /* [n_objective][number of nets] norm of the residuals in each net */
    /* [n_objective][number of nets] norm divided by the smooth maximum, or weight in the mean of the worst samples */
    double *net_part;
    double *net_order;                    /* [2 n_sample] scratch */
    struct hf_ranked *net_ranked;         /* [n_sample] scratch */
    void *constraints;                    /* scratch of the constraints; NULL without constraints */
    void (*free_constraints)(void *room); /* frees `constraints` */
    double *constraint;                   /* [constraints->n] distances of the design that was judged last */
    void *block;                          /* owned memory behind the arrays */
} hf_objectives_point;

/* Creates the objectives of a case from the rows of optimize.front or optimize.objective. If the case has no rows for
 * objectives, the objective is psi. The caller must already have attached the truss to the model. If no objective needs
 * the surface or the facets, the arguments `surface` and `facets` may be NULL. If all objectives are measured on the
 * design, the borrowed argument `nets` may be NULL. Returns HF_OK or HF_NO_MEMORY. Returns HF_BAD_CASE if there would
 * be too many residuals, or if a row needs data that this scene does not have. The function adds a message for each row
 * that needs missing data. Call hf_objectives_free even if hf_objectives_create fails. */
hf_status hf_objectives_create(const hf_scene *scene, const hf_model *model, const hf_optimize_settings *settings,
                               const hf_surface_settings *surface, const hf_facets *facets,
                               const hf_objectives_nets *nets, hf_objectives *objectives, hf_messages *messages);
/* Frees the objectives. */
void hf_objectives_free(hf_objectives *objectives);

/* Writes the name of objective i_objective, as used in tables, to `text`. Examples of names are objective_0_psi and,
 * for a set, objective_1_tension_edge. If the objective is measured on load cases or samples, the name ends with a
 * suffix for the load cases or samples. Returns the argument `text`. */
const char *hf_objectives_name(const hf_objectives *objectives, int i_objective, char text[HF_OBJECTIVE_NAME_SIZE]);

/* Allocates the memory of one thread for these objectives. If `objectives` is NULL, *point is empty. Returns HF_OK or
 * HF_NO_MEMORY. Call hf_objectives_point_free even if hf_objectives_point_create fails. */
hf_status hf_objectives_point_create(const hf_objectives *objectives, hf_objectives_point *point);
/* Frees the memory of a thread. */
void hf_objectives_point_free(hf_objectives_point *point);

/* Measures the shape in the workspace. The array value [n_objective] receives the values of the objectives in their own
 * units. The argument *merit receives the merit. The function overwrites the point. The function allocates memory only
 * for a best fit. Returns HF_OK or HF_NO_MEMORY. If an objective has no value, the merit has no value and the status is
 * HF_OK. */
hf_status hf_objectives_measure(const hf_objectives *objectives, const hf_workspace *workspace,
                                hf_objectives_point *point, double *value, double *merit);

/* Computes the weighted residuals of the shape in the workspace and writes the residuals to residual [n_row]. The
 * function also prepares the data for hf_objectives_push. The norm of the residuals is the merit. If with_nets is
 * false, the function computes only the objectives that are measured on the design itself. The rows of objectives that
 * are measured on as-built nets do not change. Returns HF_OK, HF_NO_MEMORY, or HF_NOT_FINITE if an objective has no
 * value. */
hf_status hf_objectives_linearise(const hf_objectives *objectives, bool with_nets, const hf_workspace *workspace,
                                  hf_objectives_point *point, double *residual);

/* Computes the derivatives of the residuals of hf_objectives_linearise with respect to a design variable. The array
 * rate [n_row] receives the derivatives. The argument `by` contains the rates of change of the shape. The function does
 * not change the rows of objectives that are measured on as-built nets. The workspace must contain the same shape as in
 * the call of hf_objectives_linearise. */
void hf_objectives_push(const hf_objectives *objectives, const hf_workspace *workspace, hf_objectives_point *point,
                        const hf_objectives_rate *by, double *rate);

/* ---- objectives over as-built nets ---- */

/* Returns true if an objective has derivatives. A quantile has none, but the mean of the worst samples has. */
bool hf_objectives_is_smooth(const hf_objective *objective);

/* Returns true if an objective is measured on net i_net. */
bool hf_objectives_are_over(const hf_objectives *objectives, int i_net);

/* Finds the shape of net i_net of the design that was cut last, and prepares the derivatives of this net. Sets *shape
 * to the workspace that holds the shape of the net. Returns HF_OK, HF_NO_MEMORY, or HF_NOT_FINITE if the net has no
 * shape or an objective has no value in this shape. */
hf_status hf_objectives_nets_linearise(const hf_objectives *objectives, int i_net, hf_objectives_point *point,
                                       const hf_workspace **shape);
/* Writes the derivatives of the unweighted residuals of net i_net with respect to a design variable to rate [n_row].
 * The argument `by` contains the rates of the as-built net. The shape must be the shape of the last call of
 * hf_objectives_nets_linearise. */
void hf_objectives_nets_push(const hf_objectives *objectives, int i_net, const hf_workspace *shape,
                             hf_objectives_point *point, const hf_objectives_rate *by, double *rate);
/* Combines the rates of all nets in the array rate [n_row] into the rates of the residuals residual [n_row]. The
 * residuals must come from a call of hf_objectives_linearise with the same `point`. */
void hf_objectives_nets_close(const hf_objectives *objectives, const hf_objectives_point *point, const double *residual,
                              double *rate);

/* ---- parts ---- */

/* Returns true for the objectives surface and facets. */
bool hf_objectives_is_on_surface(hf_figure_kind kind);

/* Returns true if the value of the objective is a maximum of several quantities, or a ratio to a minimum. A maximum of
 * several quantities is not smooth. Therefore, a smooth approximation replaces the maximum in the residuals. */
bool hf_objectives_is_maximum(hf_figure_kind kind);

/* Sets point->size [n_support] to the forces of the net on its supports in N. */
void hf_objectives_pulls(const hf_model *model, const hf_workspace *workspace, hf_objectives_point *point);
/* Computes the derivatives of the forces of the net on its supports with respect to a design variable. The array rate
 * [n_support] receives the derivatives. The argument `by` contains the rates of change of the shape. */
void hf_objectives_pull_rates(const hf_model *model, const hf_workspace *workspace, hf_objectives_point *point,
                              const hf_objectives_rate *by, double *rate);

HF_API_END
