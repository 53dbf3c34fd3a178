/* cloud - the points of a shape at which a goal measures its distance to the wanted surface, inner nodes or points of
 * quadrature in flat facets, with exact derivatives; also where the surface is the best fit to these points (METHOD
 * section 7). */
#ifndef HIFDM_CLOUD_H
#define HIFDM_CLOUD_H

#include <hifdm/settings.h>

#include "base/arena.h"
#include "surface/surface_fit.h"

/* The best fit to the points: its parameters, and how they follow them. With G the derivatives of the sum of squares of
 * the half-path errors by the parameters, which are zero, the parameters change by -H^-1 dG, H = dG/dp. */
typedef struct {
    hf_fit_parameters found;
    double factor[HF_FIT_N_PARAMETER * HF_FIT_N_PARAMETER]; /* of H, as hf_dense_factor leaves it */
    int pivot[HF_FIT_N_PARAMETER];
    double *slope;                             /* [parameter][n] of the residual's error by a parameter */
    double *slope_center;                      /* [3][n] of it by the centre of the points */
    double *pull;                              /* [parameter][3][n] of G by a point, about the centre */
    double *pull_area;                         /* [parameter][n] of G by the area that a point stands for */
    double pull_center[HF_FIT_N_PARAMETER][3]; /* of G by the centre */
} hf_cloud_pose;

typedef struct hf_cloud {
    hf_surface_kind kind;
    double focal_length_m;
    hf_along along;
    hf_fit fit;
    int n_node;         /* of the model */
    int n, n_facet;     /* points, each with one residual; facets, or 0: the points are nodes */
    const int *row;     /* [n] of the nodes, or [n_facet][4] of the corners; borrowed */
    hf_cloud_pose pose; /* only of fit best */
    double *position_m; /* [3][n] */
    double *move;       /* [3][n] scratch: of the points per unit of a variable */
    double *error_m;    /* [n] */
    double *slope;      /* [3][n] of the error by the place of its point; of a fit about the centre */

    /* of facets */
    double area_m2;  /* of all */
    double *root_m;  /* [n] root of the projected area that a point stands for */
    double *side_m;  /* [4][n] derivatives of that area by those of x and y by u, then v */
    double *grow_m2; /* [n] scratch: change of that area */
} hf_cloud;

int hf_cloud_facet_points(int n_facet); /* points in so many facets */

/* Takes the memory of a cloud whose members up to `row` are set. */
void hf_cloud_lay_out(hf_arena *arena, hf_cloud *cloud);

/* residual [n] of a shape, position_m [3][n_node] by row, whose norm is the RMS of the errors; NaN without a best fit.
 * HF_OK or HF_NO_MEMORY. */
hf_status hf_cloud_measure(hf_cloud *cloud, const double *position_m, double *residual);

/* Derivatives of a best fit, at the shape that was measured last. HF_OK, or HF_SINGULAR when the points leave the fit
 * open. */
hf_status hf_cloud_linearise(hf_cloud *cloud);

/* rate [n] of the residuals for a move of all nodes [3][n_node]. */
void hf_cloud_push(hf_cloud *cloud, const double *move, double *rate);

/* ---- parts, for cloud.c ---- */

/* Error of a point, u / (1 + t^2)^m with its height u above a surface of this curvature and the slope t there (M16):
 * m = 1 of the half path, 1/2 along the normal. d [4]: its derivatives by the place and by the curvature. */
double hf_cloud_error(hf_surface_kind kind, double m, double curvature, const double p[3], double d[4]);

static inline double hf_cloud_power(hf_along along)
{
    return along == HF_ALONG_NORMAL ? 0.5 : 1;
}

void hf_cloud_fit_lay_out(hf_arena *arena, hf_cloud *cloud);

/* The best fit to position_m, and the errors from it; NaN where there is none. HF_OK or HF_NO_MEMORY. */
hf_status hf_cloud_fit_measure(hf_cloud *cloud);
hf_status hf_cloud_fit_linearise(hf_cloud *cloud);

/* rate [n]: of the errors, for `move` and `grow_m2`. */
void hf_cloud_fit_push(hf_cloud *cloud, double *rate);

#endif
