/* objectives - what a design is judged by: blocks of residuals of a shape with exact derivatives (METHOD section 7).
 * Stability: internal; may change in any version.
 *
 * There is one block for each row of optimize.objective, or of optimize.front, whose weights are 1. Pipeline:
 *
 *   hf_objectives_measure                shape in a workspace -> values of the objectives, merit
 *   hf_objectives_linearise              shape -> weighted residuals, and the data of its derivatives
 *   hf_objectives_push                   rates of the shape by a design variable -> rates of the residuals
 *   hf_objectives_nets_linearise, _push, _close   the same for objectives over as-built nets
 *
 * Each objective has a value in its own unit (settings.h), and residuals whose norm is that value. The merit of a
 * design is sqrt(sum (weight * value)^2).
 *
 * Pull and deflection are the maximum of several sizes s. Their value is that maximum, but their residuals have the
 * norm (sum s^16)^(1/16), which is smooth. This norm is between the maximum of n sizes and n^(1/16) times the maximum.
 * The merit contains the norm. A ratio is the maximum tension times the maximum 1/tension, and both are smoothed in
 * this way. A value is NaN or infinite where the shape has none: psi if all nodes are loose, a surface without a best
 * fit, the ratio of a set with a slack cable. */
#ifndef HIFDM_OBJECTIVES_H
#define HIFDM_OBJECTIVES_H

#include <hifdm/api.h>
#include <hifdm/facets.h>
#include <hifdm/workspace.h>

HF_API_BEGIN

/* One objective. */
typedef struct {
    hf_objective_settings settings; /* its row of the case */
    int n_cable;                    /* number of cables of its set */
    int *cable;                     /* [n_cable] cables of its set, ascending; NULL without a set */
    int n_shape_row;                /* number of residuals of one shape */
    int first_net, n_net;           /* the as-built nets on which it is measured; n_net 0: the design itself */
    int first_row, n_row;           /* its rows among all residuals, one shape after the other */
} hf_objective;

/* Rates of change of a shape by a design variable, per unit of the variable. */
typedef struct {
    const double *position_m; /* [3][n_node] rates of the positions by row, supports included, m */
    const double *tension_N;  /* [n_cable] rates of the tensions, N */
    /* [3 n_attachment] rates of the displacements by the truss, m; NULL without a truss */
    const double *displacement_m;
} hf_objectives_rate;

/* Receives the shape of as-built net i_net; NULL: it has none. Of the workspace only position_m, tension_N, length_m,
 * displacement_m and loose are valid. */
typedef void hf_objectives_take(void *context, int i_net, const hf_workspace *shape);

/* The as-built nets of a design on which objectives may be measured: its load cases, then samples of its errors. The
 * room that makes these nets (built/built_nets.h) is above this one, so it supplies the functions. Shapes depend on the
 * design and on the number of the net alone. */
typedef struct hf_objectives_nets {
    int n_load_case, n_sample;         /* numbers of load cases and of samples */
    const char *const *load_case_name; /* [n_load_case] names of the load cases */
    /* Allocates the scratch of one thread, *room. Returns HF_OK or HF_NO_MEMORY. Call close in either case. */
    hf_status (*open)(const struct hf_objectives_nets *nets, void **room);
    /* Frees the scratch of a thread. */
    void (*close)(void *room);
    /* Cuts the nets for the design whose shape the workspace holds; the functions below are then about this design.
     * Returns HF_OK; HF_NO_MEMORY; HF_BAD_CASE if the cables cannot be cut. */
    hf_status (*cut)(void *room, const hf_workspace *design);
    /* Finds the shapes of the nets first to first + n - 1 and calls `take` for each, in this thread and in any
     * order. */
    void (*solve)(void *room, int first, int n, hf_objectives_take *take, void *context);
    /* Finds the shape of one net and factors its matrix there. *shape is set to the workspace, owned by the room.
     * Returns HF_OK, and `follow` is then about this net; HF_NOT_FINITE if the net has no shape; HF_NO_MEMORY. */
    hf_status (*linearise)(void *room, int i_net, const hf_workspace **shape);
    /* Converts n <= HF_OBJECTIVES_AT_ONCE rates of the design to rates of the net. by_net [n] points into arrays of the
     * room. */
    void (*follow)(void *room, int n, const hf_objectives_rate *by_design, hf_objectives_rate *by_net);
} hf_objectives_nets;
#define HF_OBJECTIVES_AT_ONCE 8 /* maximum number of rates in one call of `follow` */

/* The objectives of a case. They do not change after creation, so threads share them. */
typedef struct {
    const hf_model *model;                      /* the net; borrowed */
    hf_surface_kind kind;                       /* kind of the target surface; used by surface and facets */
    double focal_length_m;                      /* focal length of the target surface; used by surface and facets */
    int n_facet;                                /* number of facets */
    int *corner_row;                            /* [n_facet][4] rows of the corners; used by facets and gain */
    struct hf_gain_beam *beam;                  /* [n_objective] the beam of each objective gain */
    int n_objective, n_row;                     /* numbers of objectives and of all residuals */
    hf_objective objective[HF_DESIGN_ROWS_MAX]; /* [n_objective] the objectives */
    const hf_objectives_nets *nets;             /* as-built nets; borrowed; NULL if no objective is measured on them */
    void *block;                                /* owned memory behind the arrays */
} hf_objectives;

/* The memory of one thread: scratch of a measurement, and the data of the last hf_objectives_linearise that
 * hf_objectives_push needs. */
typedef struct hf_objectives_point {
    double *psi_per_m;             /* [n_inner_node] residual of psi per distance; 0 for a loose node */
    double *force_N;               /* [n_support][3] scratch: forces of the net on the supports */
    double *rate_N;                /* [n_support][3] scratch: rates of these forces */
    double *size;                  /* [n_support], [n_attachment] or for a ratio [2 n_cable] scratch */
    double *row;                   /* [n_row] scratch */
    struct hf_gain *gain;          /* [n_objective] scratch of each objective gain */
    struct hf_cloud *cloud;        /* [n_objective] of surface and facets: points, errors, best fit */
    void *nets;                    /* scratch of as-built nets; NULL without nets */
    void (*free_nets)(void *room); /* frees `nets` */
    double *net_value; /* [n_objective][n_load_case + n_sample] value in each net; infinite without a shape */
    double *net_norm;  /* [n_objective][n_load_case + n_sample] norm of the residuals in each net */
    double *net_part;  /* [n_objective][n_load_case + n_sample] norm over the smooth maximum; or scratch */
    void *block;       /* owned memory behind the arrays */
} hf_objectives_point;

/* Creates the objectives of a case: the rows of optimize.front or optimize.objective, or psi if there are none. The
 * model has its truss already. `surface` and `facets` may be NULL if no objective needs them, `nets` (borrowed) if all
 * are measured on the design. Returns HF_OK; HF_BAD_CASE with a message for each row that needs what this scene does
 * not have, or if there would be too many residuals; HF_NO_MEMORY. Call hf_objectives_free in any case. */
hf_status hf_objectives_create(const hf_scene *scene, const hf_model *model, const hf_optimize_settings *settings,
                               const hf_surface_settings *surface, const hf_facets *facets,
                               const hf_objectives_nets *nets, hf_objectives *objectives, hf_messages *messages);
/* Frees the objectives. */
void hf_objectives_free(hf_objectives *objectives);

/* Writes the name of objective i_objective in tables into text: objective_0_psi, objective_1_tension_edge for a set,
 * followed by the load case or by what it is measured on. Returns text. */
const char *hf_objectives_name(const hf_objectives *objectives, int i_objective, char text[HF_OBJECTIVE_NAME_SIZE]);

/* Allocates the memory of one thread for these objectives. Returns HF_OK or HF_NO_MEMORY. Call hf_objectives_point_free
 * in either case. */
hf_status hf_objectives_point_create(const hf_objectives *objectives, hf_objectives_point *point);
/* Frees the memory of a thread. */
void hf_objectives_point_free(hf_objectives_point *point);

/* Measures the shape in the workspace: value [n_objective] receives the values of the objectives, and *merit the merit.
 * Overwrites the point. Allocates memory only for a best fit. Returns HF_OK, also if an objective and so the merit has
 * no value; HF_NO_MEMORY. */
hf_status hf_objectives_measure(const hf_objectives *objectives, const hf_workspace *workspace,
                                hf_objectives_point *point, double *value, double *merit);

/* Computes the weighted residuals residual [n_row] of the shape in the workspace, whose norm is the merit, and the data
 * for hf_objectives_push. Without with_nets, only the objectives that are measured on the design itself are computed,
 * and the rows of the others do not change. Returns HF_OK; HF_NOT_FINITE if an objective has no value; HF_NO_MEMORY. */
hf_status hf_objectives_linearise(const hf_objectives *objectives, bool with_nets, const hf_workspace *workspace,
                                  hf_objectives_point *point, double *residual);

/* Computes the rates rate [n_row] of the residuals of hf_objectives_linearise by a design variable, from the rates `by`
 * of the shape. The rows of objectives over as-built nets are not changed. The workspace holds the same shape. */
void hf_objectives_push(const hf_objectives *objectives, const hf_workspace *workspace, hf_objectives_point *point,
                        const hf_objectives_rate *by, double *rate);

/* ---- objectives over as-built nets ---- */

/* Returns true if an objective has derivatives; a quantile has none. */
bool hf_objectives_is_smooth(const hf_objective_settings *objective);

/* Returns true if an objective is measured on net i_net. */
bool hf_objectives_are_over(const hf_objectives *objectives, int i_net);

/* Finds net i_net of the design that was cut last and prepares its derivatives. *shape is set to the workspace with its
 * shape. Returns HF_OK; HF_NOT_FINITE if the net has no shape or an objective no value there; HF_NO_MEMORY. */
hf_status hf_objectives_nets_linearise(const hf_objectives *objectives, int i_net, hf_objectives_point *point,
                                       const hf_workspace **shape);
/* Writes the rates of the residuals of net i_net by a design variable, without weights, into rate [n_row]. `by` has the
 * rates of the net. The shape is that of the last hf_objectives_nets_linearise. */
void hf_objectives_nets_push(const hf_objectives *objectives, int i_net, const hf_workspace *shape,
                             hf_objectives_point *point, const hf_objectives_rate *by, double *rate);
/* Combines the rates of all nets in rate [n_row] to the rates of `residual` [n_row], which hf_objectives_linearise
 * computed with `point`. */
void hf_objectives_nets_close(const hf_objectives *objectives, const hf_objectives_point *point, const double *residual,
                              double *rate);

/* ---- parts ---- */

/* Returns true for the objectives surface and facets. */
bool hf_objectives_is_on_surface(hf_figure_kind kind);

/* Returns true if the value is a maximum of several sizes, or a ratio to a minimum. Such a value has corners, so its
 * residuals are those of a smooth value. */
bool hf_objectives_is_maximum(hf_figure_kind kind);

/* Sets point->size [n_support] to the forces of the net on its supports, N. */
void hf_objectives_pulls(const hf_model *model, const hf_workspace *workspace, hf_objectives_point *point);
/* Computes the rates rate [n_support] of the forces of the net on its supports by a design variable, from the rates
 * `by` of the shape. */
void hf_objectives_pull_rates(const hf_model *model, const hf_workspace *workspace, hf_objectives_point *point,
                              const hf_objectives_rate *by, double *rate);

HF_API_END
#endif
