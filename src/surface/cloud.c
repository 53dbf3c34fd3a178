/* Measures the errors of a shape at the points of a cloud:
 *
 *     nodes -> points: nodes themselves, or 3 x 3 quadrature points per facet, with their areas
 *       -> best fit, if asked for -> errors -> residuals, weighted by area
 *     motion of the nodes -> motion of points and change of areas -> rates of the residuals
 *
 * The best fit as a function of the points:
 *
 *     points -> hf_surface_fit_find -> one Newton step -> errors from the fitted surface
 *     linearise: H factored; derivatives of G and of the errors by each point
 *     push: motion of points -> change of G -> change of the parameters by H^-1 -> rates of the errors
 *
 * Contents: layout - points - errors - the best fit - residuals */
#include "surface/cloud.h"

#include "base/elementary.h"
#include "linalg/dense.h"
#include "surface/facet_mesh.h"

#include <math.h>
#include <string.h>

enum { N_GAUSS = HF_FACET_N_FLAT, N_POINT = N_GAUSS * N_GAUSS }; /* quadrature points of a facet */
enum { N_MOST = HF_FIT_N_PARAMETER };

/* Maximum Newton step, for parameters of order one. After a longer step the fit is not yet a minimum, so the step
 * is not taken. */
#define STEP_MOST 1e-3

/* ---- layout ---- */

int hf_cloud_facet_points(int n_facet)
{
    return N_POINT * n_facet;
}

void hf_cloud_lay_out(hf_arena *arena, hf_cloud *to)
{
    size_t n = (size_t)to->n, n_area = to->n_facet > 0 ? n : 0, n_fit = to->feed == HF_REFOCUSED ? n : 0;
    HF_CLOUD_FIELDS(HF_ARENA_TAKE)
    to->pose.slope = hf_arena_take(arena, N_MOST * n_fit, sizeof(double));
    to->pose.slope_center = hf_arena_take(arena, 3 * n_fit, sizeof(double));
    to->pose.pull = hf_arena_take(arena, N_MOST * 3 * n_fit, sizeof(double));
    to->pose.pull_area = hf_arena_take(arena, N_MOST * n_fit, sizeof(double));
    to->pose.slope_size = hf_arena_take(arena, n_fit, sizeof(double));
}

/* ---- points ---- */

/* Computes quadrature point i, bilinear in the nodes, and its derivatives by u and v. node [3][n_node] contains
 * positions, or a motion. *f: the facet of this point and of the last one. */
static void blend(const hf_cloud *c, const double *node, int i, hf_facet_gathered *f, double at[3], double du[3],
                  double dv[3])
{
    int k = i % N_POINT;
    if (k == 0) hf_facet_gather(node, c->n_node, c->row + 4 * (i / N_POINT), f);
    hf_facet_mesh_at(&f->flat, hf_facet_flat_at[k % N_GAUSS], hf_facet_flat_at[k / N_GAUSS], at, du, dv);
}

static void take_facets(hf_cloud *c, const double *node)
{
    hf_facet_gathered f;
    c->area_m2 = 0;
    for (int i = 0; i < c->n; i++) {
        int k = i % N_POINT;
        double p[3], du[3], dv[3], part = hf_facet_flat_weight[k % N_GAUSS] * hf_facet_flat_weight[k / N_GAUSS];
        blend(c, node, i, &f, p, du, dv);
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
    hf_facet_gathered f;
    double all_m2 = 0;
    for (int i = 0; i < c->n; i++) {
        double p[3], du[3], dv[3];
        if (c->n_facet > 0) {
            blend(c, node, i, &f, p, du, dv);
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

/* Returns the power m of hf_fit_error. */
static double power_of(const hf_cloud *c)
{
    return c->along == HF_ALONG_NORMAL ? 0.5 : 1;
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
        c->error_m[i] = hf_fit_error(c->kind, power_of(c), 1 / (4 * c->focal_length_m), p, d);
        for (int k = 0; k < 3; k++)
            c->slope[k * c->n + i] = d[k];
    }
}

/* ---- the best fit ---- */

static hf_fit_frame frame_of(const hf_cloud *c, const hf_fit_parameters *found)
{
    return hf_fit_frame_of(c->kind, c->focal_length_m, c->n, c->position_m, c->n_facet > 0 ? c->root_m : NULL, found);
}

/* Returns by how much held parameter k, in its unit, grows with the size. A bound of a shift is a part of the size. */
static double grow_with_size(const hf_fit_parameters *found, int k)
{
    int quantity = found->quantity[k];
    return quantity == HF_FIT_CURVE ? 0 : found->value[quantity] / found->size_m;
}

/* Computes G by the parameters of the frame, and H by the free ones, factored. Returns HF_OK or HF_SINGULAR. */
static hf_status factor(hf_cloud *c, const hf_fit_frame *f, double *G)
{
    hf_cloud_pose *q = &c->pose;
    int n = q->found.n, n_all = f->found->n;
    double H[N_MOST * N_MOST];
    hf_fit_hessian(f, G, H);
    for (int k = 0; k < n; k++) {
        memcpy(q->factor + k * n, H + k * n_all, (size_t)n * sizeof *H);
        q->pull_size[k] = 0;
        for (int held = n; held < n_all; held++)
            q->pull_size[k] += H[k * n_all + held] * grow_with_size(f->found, held);
    }
    return hf_dense_factor(n, q->factor, q->pivot) == 0 ? HF_OK : HF_SINGULAR;
}

/* Improves the fit by one Newton step. The fit ends when rounding keeps the sum of squares from falling. At that point
 * the parameters have only half of the digits, which is not enough for differences of residuals. */
static void polish(hf_cloud *c)
{
    hf_fit_parameters *found = &c->pose.found;
    hf_fit_frame f = frame_of(c, found);
    double step[N_MOST];
    if (factor(c, &f, step) != HF_OK) return;
    hf_dense_solve(found->n, c->pose.factor, c->pose.pivot, 1, step);
    if (!(hf_max_magnitude((size_t)found->n, step) < STEP_MOST)) return;
    for (int k = 0; k < found->n; k++)
        found->value[found->quantity[k]] -= step[k];
}

/* Finds the best fit to position_m and the errors from it; NaN if there is no fit. Returns HF_OK or HF_NO_MEMORY. */
static hf_status fit_measure(hf_cloud *c)
{
    hf_surface_fit fit;
    HF_TRY(hf_surface_fit_find(c->kind, c->focal_length_m, c->n, c->position_m, c->n_facet > 0 ? c->root_m : NULL, &fit,
                               &c->pose.found));
    if (fit.converged) polish(c);
    hf_fit_frame f = frame_of(c, &c->pose.found);
    for (int i = 0; i < c->n; i++) {
        double arm[3], at[3], d[4];
        hf_fit_locate(&f, i, arm, at);
        c->error_m[i] = fit.converged ? hf_fit_error(c->kind, power_of(c), f.curvature_per_m, at, d) : (double)NAN;
    }
    return HF_OK;
}

/* Adds the contributions of point i to the derivatives of G for parameter k. */
static void pull_of(hf_cloud *c, const hf_fit_frame *f, const hf_fit_point *p, int i, int k)
{
    hf_cloud_pose *q = &c->pose;
    int angle = hf_fit_angle_of(q->found.quantity[k]);
    double by = hf_fit_dot(p->d, p->by[k]), weight = hf_fit_weight(f, i), bent[3];
    for (int a = 0; a < 3; a++)
        bent[a] = p->d[a] * by + p->value * hf_fit_dot(p->dd[a], p->by[k]);
    for (int d = 0; d < 3; d++) {
        double pull = 0;
        for (int a = 0; a < 3; a++) {
            pull += bent[a] * f->turn[a][d];
            if (angle >= 0) pull += p->value * p->d[a] * f->slope[angle][a][d];
        }
        q->pull[(3 * k + d) * c->n + i] = weight * pull;
        q->pull_center[k][d] += weight * (bent[d] - pull); /* points are measured relative to the centre */
    }
    q->pull_area[k * c->n + i] = p->value * by;
}

static hf_status fit_linearise(hf_cloud *c)
{
    hf_cloud_pose *q = &c->pose;
    hf_fit_parameters all = q->found;
    double G[N_MOST];
    all.n += all.n_held;
    hf_fit_frame f = frame_of(c, &all);
    HF_TRY(factor(c, &f, G));
    memset(q->pull_center, 0, sizeof q->pull_center);
    for (int i = 0; i < c->n; i++) {
        double d[4];
        hf_fit_point p = hf_fit_point_take(&f, i);
        hf_fit_error(c->kind, power_of(c), f.curvature_per_m, p.at, d);
        for (int k = 0; k < q->found.n; k++) {
            pull_of(c, &f, &p, i, k);
            q->slope[k * c->n + i] = hf_fit_dot(d, p.by[k]);
        }
        q->slope_size[i] = 0;
        for (int k = q->found.n; k < all.n; k++)
            q->slope_size[i] += hf_fit_dot(d, p.by[k]) * grow_with_size(&all, k);
        for (int k = 0; k < 3; k++) {
            double by = d[0] * f.turn[0][k] + d[1] * f.turn[1][k] + d[2] * f.turn[2][k];
            c->slope[k * c->n + i] = by;
            q->slope_center[k * c->n + i] = d[k] - by;
        }
    }
    return HF_OK;
}

/* Computes rate [n], the rates of the errors, for `move` and `grow_m2`. */
static void fit_push(hf_cloud *c, double *rate)
{
    const hf_cloud_pose *q = &c->pose;
    int n = q->found.n;
    double center[3] = {0}, change[N_MOST] = {0};
    double size = q->found.n_held ? (c->move[q->found.size_end[1]] - c->move[q->found.size_end[0]]) / 2 : 0;
    for (int d = 0; d < 3; d++)
        for (int i = 0; i < c->n; i++)
            center[d] += c->move[d * c->n + i] / c->n;
    for (int k = 0; k < n; k++) {
        for (int d = 0; d < 3; d++) {
            change[k] -= q->pull_center[k][d] * center[d];
            for (int i = 0; i < c->n; i++)
                change[k] -= q->pull[(3 * k + d) * c->n + i] * c->move[d * c->n + i];
        }
        for (int i = 0; i < c->n && c->n_facet > 0; i++)
            change[k] -= q->pull_area[k * c->n + i] * c->grow_m2[i];
        change[k] -= q->pull_size[k] * size;
    }
    hf_dense_solve(n, q->factor, q->pivot, 1, change);
    for (int i = 0; i < c->n; i++) {
        rate[i] = 0;
        for (int d = 0; d < 3; d++)
            rate[i] += c->slope[d * c->n + i] * c->move[d * c->n + i] + q->slope_center[d * c->n + i] * center[d];
        for (int k = 0; k < n; k++)
            rate[i] += q->slope[k * c->n + i] * change[k];
        rate[i] += q->slope_size[i] * size;
    }
}

/* ---- residuals ---- */

hf_status hf_cloud_measure(hf_cloud *c, const double *position_m, double *residual)
{
    take_points(c, position_m);
    if (c->feed == HF_REFOCUSED)
        HF_TRY(fit_measure(c));
    else
        take_errors(c);
    for (int i = 0; i < c->n; i++)
        residual[i] = residual_per_m(c, i) * c->error_m[i];
    return HF_OK;
}

hf_status hf_cloud_linearise(hf_cloud *c)
{
    return c->feed == HF_REFOCUSED ? fit_linearise(c) : HF_OK;
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
    if (c->feed == HF_REFOCUSED)
        fit_push(c, rate);
    else
        push_errors(c, rate);
    for (int i = 0; i < c->n; i++) { /* a residual is error * sqrt(own area / total area) */
        double square = c->n_facet > 0 ? c->root_m[i] * c->root_m[i] : 0;
        if (square > 0) rate[i] += c->error_m[i] * (c->grow_m2[i] / square - grow_m2 / c->area_m2) / 2;
        rate[i] *= residual_per_m(c, i);
    }
}
