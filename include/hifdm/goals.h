/* goals - what a design wants: blocks of residuals of a shape, one for each row of optimize.goals, or of
 * optimize.objectives, whose weights are 1, with their exact derivatives (METHOD section 7).
 * Stability: internal; may change in any version.
 *
 * Each goal has a value in its own unit (settings.h), and residuals whose norm is that value; the merit of a design is
 * sqrt(sum (weight * value)^2). Of pull and displacement, which are the largest of several sizes s, value is the
 * largest, but the residuals have the norm (sum s^16)^(1/16), which is smooth: it is between the largest of n sizes and
 * n^(1/16) times that, and it is what the merit has. Of ratio, the largest tension times the largest 1/tension, both
 * are smooth. A value is NaN or infinite where the shape has none: psi when all nodes are loose, a surface without a
 * best fit, the ratio of a set with a slack cable. */
#ifndef HIFDM_GOALS_H
#define HIFDM_GOALS_H

#include <hifdm/api.h>
#include <hifdm/facets.h>
#include <hifdm/workspace.h>

HF_API_BEGIN

typedef struct {
    hf_goal_settings wanted;
    int n_cable;          /* of its set */
    int *cable;           /* [n_cable] ascending; NULL where the goal has no set */
    int n_shape_row;      /* residuals of one shape */
    int first_net, n_net; /* nets that it is over; n_net 0: the design itself */
    int first_row, n_row; /* its residuals among all: of one shape after the other */
} hf_goal;

/* Changes of a shape per unit of a variable. */
typedef struct {
    const double *position_m;     /* [3][n_node] by row, supports included */
    const double *tension_N;      /* [n_cable] */
    const double *displacement_m; /* [3 n_attachment], of the attachments by the truss; NULL without a truss */
} hf_goals_rate;

/* Take the shape of a net, NULL where it has none: position_m, tension_N, length_m, displacement_m and loose alone. */
typedef void hf_goals_take(void *context, int i_net, const hf_workspace *shape);

/* The nets that are made of a design and that goals may be over: its states, then samples of its errors. Who knows them
 * (built/built_nets.h) stands above this room, and fills in the functions. What is found of a net depends on the design
 * and on the number of the net alone. */
typedef struct hf_goals_nets {
    int n_state, n_sample;
    const char *const *state_name; /* [n_state] */
    /* The scratch of one thread. HF_OK or HF_NO_MEMORY; close it in either case. */
    hf_status (*open)(const struct hf_goals_nets *nets, void **room);
    void (*close)(void *room);
    /* Cut the nets for the design whose shape the workspace holds. HF_OK; HF_NO_MEMORY; HF_BAD_CASE where it cannot be
     * cut. The other functions are of this design. */
    hf_status (*cut)(void *room, const hf_workspace *design);
    /* Find shapes; `take` is called in this thread, in any order. */
    void (*solve)(void *room, int first, int n, hf_goals_take *take, void *context);
    /* Find the shape of one net and factor its matrix there: HF_OK, it is the net of `follow`; HF_NOT_FINITE: it has
     * none; HF_NO_MEMORY. */
    hf_status (*linearise)(void *room, int i_net, const hf_workspace **shape);
    /* n <= HF_GOALS_AT_ONCE changes of the design to those of the net, in arrays of the room. */
    void (*follow)(void *room, int n, const hf_goals_rate *by_design, hf_goals_rate *by_net);
} hf_goals_nets;
#define HF_GOALS_AT_ONCE 8

/* Constant after creation, shared by all threads. */
typedef struct {
    const hf_model *model; /* borrowed */
    hf_surface_kind kind;  /* of the wanted surface, as the next; only with goals surface and facets */
    double focal_length_m;
    int n_facet;
    int *corner_row;           /* [n_facet][4] rows of the model; only with a goal facets or gain */
    struct hf_gain_beam *beam; /* [n_goal] of those of gain */
    int n_goal, n_row;
    hf_goal goal[HF_DESIGN_ROWS_MAX];
    const hf_goals_nets *nets; /* borrowed; NULL where no goal is over any */
    void *block;
} hf_goals;

/* What a thread needs: scratch of a measurement, and what hf_goals_push has to know of the shape of the last
 * hf_goals_linearise. */
typedef struct hf_goals_point {
    double *psi_per_m;      /* [n_inner_node] residual per distance; 0 of a loose node */
    double *force_N;        /* [n_support][3] scratch: sums of T u, forces of the net on the supports */
    double *rate_N;         /* [n_support][3] scratch: their change */
    double *size;           /* [n_support], [n_attachment] or of ratio [2 n_cable] scratch */
    double *row;            /* [n_row] scratch */
    struct hf_gain *gain;   /* [n_goal] of those of gain */
    struct hf_cloud *cloud; /* [n_goal] of those of the surface: its points, their errors, the best fit */
    void *nets;             /* the room of goals->nets; NULL without */
    void (*free_nets)(void *room);
    double *net_value; /* [n_goal][n_state + n_sample] of the goals over nets, in each; infinite without a shape */
    double *net_norm;  /* the same of residuals */
    double *net_part;  /* the same over the smooth largest; or scratch */
    void *block;
} hf_goals_point;

/* The goals of a case, its objectives, or psi where there is no row. The model has its truss already; `surface` and
 * `facets` may be NULL for goals that do not need them, `nets` (borrowed) where all are of the design. HF_OK;
 * HF_BAD_CASE with a message for each row that asks for what this scene does not have, "optimize.goals.1: ..." or
 * "optimize.objectives.1: ..."; HF_NO_MEMORY. Free in any case. */
hf_status hf_goals_create(const hf_scene *scene, const hf_model *model, const hf_optimize_settings *settings,
                          const hf_surface_settings *surface, const hf_facets *facets, const hf_goals_nets *nets,
                          hf_goals *goals, hf_messages *messages);
void hf_goals_free(hf_goals *goals);

/* What goal i_goal is called in tables: goal_0_psi, or goal_1_tension_edge of a goal of a set; returns text. */
const char *hf_goals_name(const hf_goals *goals, int i_goal, char text[HF_GOAL_NAME_SIZE]);

/* HF_OK or HF_NO_MEMORY; free in either case. */
hf_status hf_goals_point_create(const hf_goals *goals, hf_goals_point *point);
void hf_goals_point_free(hf_goals_point *point);

/* value [n_goal] of the shape in the workspace, and its merit. Allocates nothing but for a best fit. HF_OK, also when a
 * goal has no value (nor has the merit); HF_NO_MEMORY. Overwrites the point. */
hf_status hf_goals_measure(const hf_goals *goals, const hf_workspace *workspace, hf_goals_point *point, double *value,
                           double *merit);

/* Weighted residuals [n_row] of the shape in the workspace, whose norm is the merit, and what hf_goals_push needs.
 * HF_OK; HF_NOT_FINITE when one has no value; HF_NO_MEMORY. */
hf_status hf_goals_linearise(const hf_goals *goals, const hf_workspace *workspace, hf_goals_point *point,
                             double *residual);

/* The same of the goals of the design itself alone; the rows of others are left as they are. */
hf_status hf_goals_linearise_design(const hf_goals *goals, const hf_workspace *workspace, hf_goals_point *point,
                                    double *residual);

/* The derivative [n_row] of these residuals by a variable, of the goals of the design itself. The workspace holds the
 * same shape. */
void hf_goals_push(const hf_goals *goals, const hf_workspace *workspace, hf_goals_point *point, const hf_goals_rate *by,
                   double *rate);

/* ---- goals over nets ---- */

/* Has this goal derivatives? Not a quantile. */
bool hf_goals_is_smooth(const hf_goal_settings *goal);

/* Is some goal over this net? */
bool hf_goals_are_over(const hf_goals *goals, int i_net);

/* Find the nets of the design in the workspace: residuals of the goals over them, without weights, and net_value and
 * net_norm of the point. HF_OK, also when nets have no shape; HF_NO_MEMORY. */
hf_status hf_goals_nets_measure(const hf_goals *goals, const hf_workspace *workspace, hf_goals_point *point,
                                double *residual);

/* What goal i_goal takes of its nets: scales its residuals [n_row], whose norm is *norm then. */
void hf_goals_nets_gather(const hf_goals *goals, int i_goal, hf_goals_point *point, double *residual, double *value,
                          double *norm);

/* Derivatives by a variable, net by net: hf_goals_nets_push writes into rate [n_row] the change of the residuals of net
 * i_net by themselves, at the shape that hf_goals_nets_linearise took last (HF_OK or HF_NOT_FINITE). When all are there
 * hf_goals_nets_close makes of them the change of `residual` [n_row], which hf_goals_linearise wrote with `point`. */
hf_status hf_goals_nets_linearise(const hf_goals *goals, int i_net, hf_goals_point *point, const hf_workspace **shape);
void hf_goals_nets_push(const hf_goals *goals, int i_net, const hf_workspace *shape, hf_goals_point *point,
                        const hf_goals_rate *by, double *rate);
void hf_goals_nets_close(const hf_goals *goals, const hf_goals_point *point, const double *residual, double *rate);

/* ---- parts, for goals_nets.c ---- */

/* Residuals of goal i_goal of one shape, without its weight, with their norm and value; and their derivative. */
hf_status hf_goals_measure_shape(const hf_goals *goals, int i_goal, const hf_workspace *shape, hf_goals_point *point,
                                 double *residual, double *value, double *norm);
void hf_goals_push_shape(const hf_goals *goals, int i_goal, const hf_workspace *shape, hf_goals_point *point,
                         const hf_goals_rate *by, double *rate);
/* What goal i_goal needs for that derivative, of the shape that was measured last. As hf_goals_linearise. */
hf_status hf_goals_linearise_shape(const hf_goals *goals, int i_goal, const hf_workspace *shape, hf_goals_point *point);
bool hf_goals_is_on_surface(hf_goal_kind kind);

/* The largest of n sizes, and the smooth one P = (sum s^16)^(1/16) as *norm; size [n] becomes s/P. */
double hf_goals_smooth_largest(int n, double *size, double *norm);

static inline double hf_goals_seventh(double x)
{
    double square = x * x;
    return square * square * square * x;
}

/* Is the value the largest of several sizes, or over their least? Then it has corners, and residuals are of a smooth
 * value beside it. */
bool hf_goals_is_largest(hf_goal_kind kind);

/* The forces (N) of the net on its supports, as point->size [n_support], and their change [n_support] by a variable. */
void hf_goals_pulls(const hf_model *model, const hf_workspace *workspace, hf_goals_point *point);
void hf_goals_pull_rates(const hf_model *model, const hf_workspace *workspace, hf_goals_point *point,
                         const hf_goals_rate *by, double *rate);

HF_API_END
#endif
