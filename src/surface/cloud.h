/* cloud - points of a shape at which an objective measures the distance from the target surface: inner nodes, or
 * quadrature points in flat facets. The derivatives are exact, also if the surface is the best fit to these points
 * (METHOD section 7). */
#pragma once

#include <hifdm/settings.h>

#include "base/arena.h"
#include "surface/surface_fit.h"

/* The best fit to the points: its parameters p, and their derivatives by the points. G is the gradient, by the
 * parameters, of half the sum of squares of the half-path errors. It is 0 at the fit. So the parameters change by -H^-1
 * dG, with H = dG/dp. */
typedef struct {
    hf_fit_parameters found;
    double factor[HF_FIT_N_PARAMETER * HF_FIT_N_PARAMETER]; /* factor of H from hf_dense_factor */
    int pivot[HF_FIT_N_PARAMETER];
    double *slope;                             /* [parameter][n], derivatives of the errors by the parameters */
    double *slope_center;                      /* [3][n], derivatives of the errors by the centre of the points */
    double *pull;                              /* [parameter][3][n], derivatives of G by a point, about the centre */
    double *pull_area;                         /* [parameter][n], derivatives of G by the area of a point */
    double pull_center[HF_FIT_N_PARAMETER][3]; /* derivatives of G by the centre */
    double *slope_size;                        /* [n], derivatives of the errors by the size, if shifts are held */
    double pull_size[HF_FIT_N_PARAMETER];      /* derivatives of G by the size, because held shifts grow with it */
} hf_cloud_pose;

/* The arrays of hf_cloud for n points. n_area is n with facets, else 0. */
#define HF_CLOUD_FIELDS(X)                                                                                             \
    X(double, position_m, 3 * n, "[3][n]")                                                                             \
    X(double, move, 3 * n, "[3][n], scratch: motion of the points per unit of a design variable")                      \
    X(double, error_m, n, "")                                                                                          \
    X(double, slope, 3 * n, "[3][n], derivatives of the error by the point; with a best fit, relative to the centre")  \
    X(double, root_m, n_area, "root of the projected area that a point represents")                                    \
    X(double, side_m, 4 * n_area, "[4][n], derivatives of that area by x_u, y_u, x_v and y_v")                         \
    X(double, grow_m2, n_area, "scratch: change of that area")

typedef struct hf_cloud {
    hf_surface_kind kind;
    double focal_length_m;
    hf_along along;
    hf_focus feed;
    int n_node;         /* nodes of the model */
    int n, n_facet;     /* points, with one residual each; facets, or 0 if the points are nodes */
    const int *row;     /* rows of the nodes [n], or of the corners [n_facet][4]; borrowed */
    hf_cloud_pose pose; /* used only for a refocused feed */
    double area_m2;     /* area of all facets, if there are any */
    HF_CLOUD_FIELDS(HF_ARENA_MEMBER)
} hf_cloud;

int hf_cloud_facet_points(int n_facet); /* number of points in n_facet facets */

/* Takes the arrays of a cloud from an arena. The members up to `row` must be set. */
void hf_cloud_lay_out(hf_arena *arena, hf_cloud *cloud);

/* Computes the residuals [n] of a shape, position_m [3][n_node] by row. Their norm is the RMS of the errors. They are
 * NaN if there is no best fit. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_cloud_measure(hf_cloud *cloud, const double *position_m, double *residual);

/* Computes the derivatives of the best fit at the shape measured last. Returns HF_OK, or HF_SINGULAR if the points do
 * not determine the fit. */
hf_status hf_cloud_linearise(hf_cloud *cloud);

/* Computes rate [n], the rates of the residuals for a motion `move` [3][n_node] of the nodes. */
void hf_cloud_push(hf_cloud *cloud, const double *move, double *rate);
