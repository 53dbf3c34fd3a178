/* Measures the errors of a shape at the points of a cloud:
 *
 *     nodes -> points: nodes themselves, or 3 x 3 quadrature points per facet, with their areas
 *       -> best fit, if asked for (cloud_fit) -> errors -> residuals, weighted by area
 *     motion of the nodes -> motion of points and change of areas -> rates of the residuals
 *
 * Contents: layout - points - errors - derivatives */
#include "surface/cloud.h"

#include "linalg/dot.h"
#include "net/target_surface.h"
#include "surface/facet_rms.h"

#include <math.h>

enum { N_GAUSS = HF_FACET_N_FLAT, N_POINT = N_GAUSS * N_GAUSS }; /* quadrature points of a facet */

/* ---- layout ---- */

int hf_cloud_facet_points(int n_facet)
{
    return N_POINT * n_facet;
}

void hf_cloud_lay_out(hf_arena *a, hf_cloud *c)
{
    bool has_facets = c->n_facet > 0;
    size_t n = (size_t)c->n, n_area = has_facets ? n : 0;
    c->position_m = hf_arena_take(a, 3 * n, sizeof(double));
    c->move = hf_arena_take(a, 3 * n, sizeof(double));
    c->error_m = hf_arena_take(a, n, sizeof(double));
    c->slope = hf_arena_take(a, 3 * n, sizeof(double));
    if (c->fit == HF_FIT_BEST) hf_cloud_fit_lay_out(a, c);
    c->root_m = has_facets ? hf_arena_take(a, n_area, sizeof(double)) : NULL;
    c->side_m = has_facets ? hf_arena_take(a, 4 * n_area, sizeof(double)) : NULL;
    c->grow_m2 = has_facets ? hf_arena_take(a, n_area, sizeof(double)) : NULL;
}

/* ---- points ---- */

/* Computes quadrature point k of the facet with the corners `row`, bilinear in the nodes. node [3][n_node] contains
 * positions, or a motion. du, dv: derivatives by u and v. */
static void blend(const hf_cloud *c, const double *node, const int row[4], int k, double at[3], double du[3],
                  double dv[3])
{
    double u = hf_facet_flat_at[k % N_GAUSS], v = hf_facet_flat_at[k / N_GAUSS];
    for (int d = 0; d < 3; d++, node += c->n_node) {
        double near = node[row[0]] + u * (node[row[1]] - node[row[0]]);
        double far = node[row[3]] + u * (node[row[2]] - node[row[3]]);
        at[d] = near + v * (far - near);
        du[d] = (1 - v) * (node[row[1]] - node[row[0]]) + v * (node[row[2]] - node[row[3]]);
        dv[d] = far - near;
    }
}

static void take_facets(hf_cloud *c, const double *node)
{
    c->area_m2 = 0;
    for (int i = 0; i < c->n; i++) {
        int k = i % N_POINT;
        double p[3], du[3], dv[3], part = hf_facet_flat_weight[k % N_GAUSS] * hf_facet_flat_weight[k / N_GAUSS];
        blend(c, node, c->row + 4 * (i / N_POINT), k, p, du, dv);
        for (int d = 0; d < 3; d++)
            c->position_m[d * c->n + i] = p[d];
        double area = part * (du[0] * dv[1] - du[1] * dv[0]);
        if (area < 0) part = -part;
        c->side_m[i] = part * dv[1];
        c->side_m[c->n + i] = -part * dv[0];
        c->side_m[2 * c->n + i] = -part * du[1];
        c->side_m[3 * c->n + i] = part * du[0];
        c->root_m[i] = sqrt(fabs(area));
        c->area_m2 += fabs(area);
    }
}

static void take_points(hf_cloud *c, const double *node)
{
    if (c->n_facet > 0) {
        take_facets(c, node);
        return;
    }
    for (int d = 0; d < 3; d++)
        for (int i = 0; i < c->n; i++)
            c->position_m[d * c->n + i] = node[d * c->n_node + c->row[i]];
}

/* Computes the motion of the points and the changes of their areas from a motion of the nodes. Returns the change of
 * the total area. */
static double take_moves(hf_cloud *c, const double *node)
{
    double all_m2 = 0;
    for (int i = 0; i < c->n; i++) {
        double p[3], du[3], dv[3];
        if (c->n_facet > 0) {
            blend(c, node, c->row + 4 * (i / N_POINT), i % N_POINT, p, du, dv);
            all_m2 += c->grow_m2[i] = c->side_m[i] * du[0] + c->side_m[c->n + i] * du[1] +
                                      c->side_m[2 * c->n + i] * dv[0] + c->side_m[3 * c->n + i] * dv[1];
        } else {
            for (int d = 0; d < 3; d++)
                p[d] = node[d * c->n_node + c->row[i]];
        }
        for (int d = 0; d < 3; d++)
            c->move[d * c->n + i] = p[d];
    }
    return all_m2;
}

/* ---- errors ---- */

double hf_cloud_error(hf_surface_kind kind, double m, double curvature, const double p[3], double d[4])
{
    double t[2], u = hf_target_surface_height_above(kind, curvature, p, t), square = 1 + t[0] * t[0] + t[1] * t[1];
    double weight = m < 1 ? 1 / sqrt(square) : 1 / square;
    double flat = p[2] - u;     /* curvature times the squared distance from the axis */
    for (int k = 0; k < 2; k++) /* d(1 + t^2) = 2 t dt, and dt/dx = 2 curvature along an axis with a slope */
        d[k] = -weight * t[k] * (1 + 4 * m * curvature * u / square);
    d[2] = weight;
    d[3] = -weight * (flat / curvature + 8 * m * u * flat / square);
    return u * weight;
}

/* Returns the residual of point i per metre of error. */
static double residual_per_m(const hf_cloud *c, int i)
{
    return c->n_facet > 0 ? c->root_m[i] / sqrt(c->area_m2) : 1 / sqrt(c->n);
}

static void take_errors(hf_cloud *c)
{
    for (int i = 0; i < c->n; i++) {
        double d[4], p[3] = {c->position_m[i], c->position_m[c->n + i], c->position_m[2 * c->n + i]};
        c->error_m[i] = hf_cloud_error(c->kind, hf_cloud_power(c->along), 1 / (4 * c->focal_length_m), p, d);
        for (int k = 0; k < 3; k++)
            c->slope[k * c->n + i] = d[k];
    }
}

hf_status hf_cloud_measure(hf_cloud *c, const double *position_m, double *residual)
{
    take_points(c, position_m);
    if (c->fit == HF_FIT_BEST)
        HF_TRY(hf_cloud_fit_measure(c));
    else
        take_errors(c);
    for (int i = 0; i < c->n; i++)
        residual[i] = residual_per_m(c, i) * c->error_m[i];
    return HF_OK;
}

/* ---- derivatives ---- */

hf_status hf_cloud_linearise(hf_cloud *c)
{
    return c->fit == HF_FIT_BEST ? hf_cloud_fit_linearise(c) : HF_OK;
}

/* Computes rate [n], the rates of the errors. */
static void push_errors(const hf_cloud *c, double *rate)
{
    for (int i = 0; i < c->n; i++) {
        rate[i] = 0;
        for (int d = 0; d < 3; d++)
            rate[i] += c->slope[d * c->n + i] * c->move[d * c->n + i];
    }
}

void hf_cloud_push(hf_cloud *c, const double *move, double *rate)
{
    double grow_m2 = take_moves(c, move);
    if (c->fit == HF_FIT_BEST)
        hf_cloud_fit_push(c, rate);
    else
        push_errors(c, rate);
    for (int i = 0; i < c->n; i++) { /* a residual is error * sqrt(own area / total area) */
        double square = c->n_facet > 0 ? c->root_m[i] * c->root_m[i] : 0;
        if (square > 0) rate[i] += c->error_m[i] * (c->grow_m2[i] / square - grow_m2 / c->area_m2) / 2;
        rate[i] *= residual_per_m(c, i);
    }
}
