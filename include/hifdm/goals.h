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

#include <hifdm/facets.h>
#include <hifdm/workspace.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    hf_goal_settings wanted;
    int n_cable; /* of its set */
    int *cable;  /* [n_cable] ascending; NULL where the goal has no set */
    int n_row;   /* its residuals */
} hf_goal;

/* Constant after creation, shared by all threads. */
typedef struct {
    const hf_model *model; /* borrowed */
    hf_surface_kind kind;  /* of the wanted surface, as the next; only with goals surface and facets */
    double focal_length_m;
    int n_facet;
    int *corner_row; /* [n_facet][4] rows of the model; only with a goal facets */
    int n_goal, n_row;
    hf_goal goal[HF_DESIGN_ROWS_MAX];
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
    struct hf_cloud *cloud; /* [n_goal] of those of the surface: its points, their errors, the best fit */
    void *block;
} hf_goals_point;

/* Changes of a shape per unit of a variable. */
typedef struct {
    const double *position_m;     /* [3][n_node] by row, supports included */
    const double *tension_N;      /* [n_cable] */
    const double *displacement_m; /* [3 n_attachment], of the attachments by the truss; NULL without a truss */
} hf_goals_rate;

/* The goals of a case, its objectives, or psi where there is no row. The model has its truss already; `surface` and
 * `facets` may be NULL for goals that do not need them. HF_OK; HF_BAD_CASE with a message for each row that asks for
 * what this scene does not have, "optimize.goals.1: ..." or "optimize.objectives.1: ..."; HF_NO_MEMORY. Free in any
 * case. */
hf_status hf_goals_create(const hf_scene *scene, const hf_model *model, const hf_optimize_settings *settings,
                          const hf_surface_settings *surface, const hf_facets *facets, hf_goals *goals,
                          hf_messages *messages);
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

/* The derivative [n_row] of these residuals by a variable. The workspace holds the same shape. */
void hf_goals_push(const hf_goals *goals, const hf_workspace *workspace, hf_goals_point *point, const hf_goals_rate *by,
                   double *rate);

/* Is the value the largest of several sizes, or over their least? Then it has corners, and residuals are of a smooth
 * value beside it. */
bool hf_goals_is_largest(hf_goal_kind kind);

/* The forces (N) of the net on its supports, as point->size [n_support], and their change [n_support] by a variable. */
void hf_goals_pulls(const hf_model *model, const hf_workspace *workspace, hf_goals_point *point);
void hf_goals_pull_rates(const hf_model *model, const hf_workspace *workspace, hf_goals_point *point,
                         const hf_goals_rate *by, double *rate);

#ifdef __cplusplus
}
#endif
#endif
