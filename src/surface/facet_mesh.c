/* Computes the shape of a mesh under tension N between cables, and the errors over facets:
 *
 *     shape, facets -> match the sides of facets with cables -> force F on cables between two facets
 *       -> sags F l^2 / (8 T) of the sides -> per facet: Ritz method, minimum area -> lift at any u, v
 *     shape, facets -> quadrature points: 3 x 3 per flat facet, or 5 x 5 per facet with a mesh
 *       -> RMS errors by projected area -> best fit to all points -> RMS errors after the fit
 *
 * Contents: facets - sides - the mesh of a facet - rules for waves - a shape - quadrature points - all facets - each
 * facet */
#include "surface/facet_mesh.h"

#include "base/elementary.h"
#include "base/arena.h"
#include "linalg/dense.h"
#include "net/side.h"
#include "net/target_surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N_SIDE = 4, N_BASIS = N_SIDE + HF_FACET_N_BUBBLE };

const double hf_facet_gauss_at[HF_FACET_N_GAUSS] = {0.046910077030668004, 0.23076534494715845, 0.5, 0.76923465505284155,
                                                    0.953089922969332};
const double hf_facet_gauss_weight[HF_FACET_N_GAUSS] = {0.11846344252809454, 0.23931433524968324, 64.0 / 225,
                                                        0.23931433524968324, 0.11846344252809454};

/* Computes `to`, the unit vector from a to b; 0 if a and b are equal. Returns the distance. */
static double direction(const double *a, const double *b, double to[3])
{
    for (int d = 0; d < 3; d++)
        to[d] = b[d] - a[d];
    double length = sqrt(hf_dot3(to, to));
    for (int d = 0; d < 3 && length > 0; d++)
        to[d] /= length;
    return length;
}

/* ---- facets ---- */

void hf_facet_mesh_take(const hf_facets *f, int i, const double *position_m, hf_facet_mesh *m)
{
    static const double origin[3] = {0};
    double one[3], other[3];
    const int *corner = f->corner + 4 * (size_t)i;
    *m = (hf_facet_mesh){.is_triangle = corner[2] == corner[3]};
    for (int k = 0; k < 4; k++)
        m->corner[k] = position_m + 3 * (size_t)corner[k];
    for (int d = 0; d < 3; d++) { /* the diagonals; for a triangle two sides */
        one[d] = m->corner[2][d] - m->corner[0][d];
        other[d] = m->corner[3][d] - m->corner[1][d];
    }
    hf_cross(one, other, m->normal);
    direction(origin, (double[3]){m->normal[0], m->normal[1], m->normal[2]}, m->normal);
}

void hf_facet_gather(const double *node, int n_node, const int *row, hf_facet_gathered *f)
{
    for (int k = 0; k < 4; k++) {
        for (int d = 0; d < 3; d++)
            f->corner[k][d] = node[d * n_node + row[k]];
        f->flat.corner[k] = f->corner[k];
    }
}

void hf_facet_mesh_at(const hf_facet_mesh *m, double u, double v, double p[3], double du[3], double dv[3])
{
    for (int d = 0; d < 3; d++) {
        double near = m->corner[0][d] + u * (m->corner[1][d] - m->corner[0][d]);
        double far = m->corner[3][d] + u * (m->corner[2][d] - m->corner[3][d]);
        p[d] = near + v * (far - near);
        du[d] = (1 - v) * (m->corner[1][d] - m->corner[0][d]) + v * (m->corner[2][d] - m->corner[3][d]);
        dv[d] = far - near;
    }
}

/* ---- sides ---- */

/* A side is of a facet (of = 4 i + k) or of a cable (of = -1 - e). */

static int collect(const hf_facets *f, const hf_facet_shape *shape, hf_side *all)
{
    int n = 0;
    for (int e = 0; e < shape->n_cable; e++)
        all[n++] = hf_side_of(shape->end[2 * e], shape->end[2 * e + 1], -1 - e);
    for (int i = 0; i < 4 * f->n_facet; i++) {
        int a = f->corner[i], b = f->corner[i % 4 == 3 ? i - 3 : i + 1];
        if (a != b) all[n++] = hf_side_of(a, b, i);
    }
    qsort(all, (size_t)n, sizeof *all, hf_side_compare);
    return n;
}

/* Computes the sags of a side for its two facets. The mesh of each facet pulls on the side with the force N per length,
 * in the plane of the facet. Two facets in one plane balance each other. At an angle, the rest F bends the cable into
 * an arc of height F l^2 / (8 T). Returns N l / T. */
static double bend(double mesh_N_per_m, const hf_facets *f, const hf_facet_shape *shape, double tension_N,
                   const hf_side pair[2], double *sag_m)
{
    double normal[2][3], pull[3] = {0}, length = 0;
    for (int c = 0; c < 2; c++) {
        hf_facet_mesh m;
        double along[3], inward[3];
        int k = pair[c].of % 4;
        hf_facet_mesh_take(f, pair[c].of / 4, shape->position_m, &m);
        length = direction(m.corner[k], m.corner[(k + 1) % 4], along);
        hf_cross(m.normal, along, inward);
        memcpy(normal[c], m.normal, sizeof m.normal);
        for (int d = 0; d < 3; d++)
            pull[d] += mesh_N_per_m * inward[d];
    }
    if (!(tension_N > 0)) return INFINITY;
    for (int c = 0; c < 2; c++)
        sag_m[pair[c].of] = hf_dot3(pull, normal[c]) * length * length / (8 * tension_N);
    return mesh_N_per_m * length / tension_N;
}

hf_status hf_facet_mesh_sags(double mesh_N_per_m, const hf_facets *f, const hf_facet_shape *shape, double *sag_m,
                             double *pull_ratio)
{
    hf_side *all;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(all, (size_t)shape->n_cable + 4 * (size_t)f->n_facet)));
    int n = collect(f, shape, all);
    memset(sag_m, 0, 4 * (size_t)f->n_facet * sizeof *sag_m);
    *pull_ratio = 0;
    for (int from = 0, to; from < n; from = to) { /* entries between the same two nodes; cables come first */
        double tension_N = 0;
        int first = from;
        for (to = from; to < n && hf_side_compare_nodes(all + to, all + from) == 0; to++)
            if (all[to].of < 0) {
                tension_N += shape->tension_N[-1 - all[to].of];
                first = to + 1;
            }
        if (to - first == 2)
            *pull_ratio = fmax(*pull_ratio, bend(mesh_N_per_m, f, shape, tension_N, all + first, sag_m));
    }
    hf_arena_free_block(block);
    return HF_OK;
}

hf_status hf_facet_mesh_make_sags(double mesh_N_per_m, const hf_facets *f, const hf_facet_shape *shape, hf_arena *arena,
                                  double **sag_m, double *pull_ratio)
{
    HF_TRY(HF_ARENA_MAKE(arena, *sag_m = hf_arena_take(arena, 4 * (size_t)f->n_facet, sizeof **sag_m)));
    return hf_facet_mesh_sags(mesh_N_per_m, f, shape, *sag_m, pull_ratio);
}

/* ---- the mesh of a facet ---- */

/* A function of u and v with its derivatives. */
typedef struct {
    double value, by_u, by_v;
} jet;

static jet times(jet a, jet b)
{
    return (jet){a.value * b.value, a.by_u * b.value + a.value * b.by_u, a.by_v * b.value + a.value * b.by_v};
}

static jet less(jet a, jet b)
{
    return (jet){a.value - b.value, a.by_u - b.by_u, a.by_v - b.by_v};
}

static jet scaled(double s, jet a)
{
    return (jet){s * a.value, s * a.by_u, s * a.by_v};
}

/* Evaluates the basis at u, v: arcs of height 1 along the sides, then functions that vanish at all sides. The latter
 * are the product of the distances from all sides, times polynomials up to degree 2. */
static void evaluate_basis(bool is_triangle, double u, double v, jet to[N_BASIS])
{
    const jet one = {1, 0, 0}, U = {u, 1, 0}, V = {v, 0, 1}, U1 = less(one, U), V1 = less(one, V);
    const jet a = times(U1, V1), b = times(U, V1); /* with V, the barycentric coordinates of a triangle */
    jet bubble = is_triangle ? times(times(a, b), V) : times(times(U, U1), times(V, V1));
    jet s = is_triangle ? less(b, a) : less(U, U1), t = is_triangle ? less(V, a) : less(V, V1);
    to[0] = scaled(4, is_triangle ? times(a, b) : times(times(U, U1), V1));
    to[1] = scaled(4, times(times(V, V1), U));
    to[2] = scaled(is_triangle ? 0 : 4, times(times(U, U1), V));
    to[3] = scaled(4, times(times(V, V1), U1));
    const jet factor[HF_FACET_N_BUBBLE] = {one, s, t, times(s, s), times(s, t), times(t, t)};
    for (int k = 0; k < HF_FACET_N_BUBBLE; k++)
        to[N_SIDE + k] = times(bubble, factor[k]);
}

/* Computes the metric of the plane of the facet at u, v. The product of the gradients of two functions a and b, times
 * the element of area, is g[0] a_u b_u + g[1] (a_u b_v + a_v b_u) + g[2] a_v b_v. *base: gradient of the height of the
 * bilinear surface over the plane. */
static void measure_at(const hf_facet_mesh *m, double u, double v, double g[3], jet *base)
{
    double du[3], dv[3], rise[3];
    for (int d = 0; d < 3; d++) {
        double near = m->corner[1][d] - m->corner[0][d], far = m->corner[2][d] - m->corner[3][d];
        du[d] = (1 - v) * near + v * far;
        dv[d] = (1 - u) * (m->corner[3][d] - m->corner[0][d]) + u * (m->corner[2][d] - m->corner[1][d]);
    }
    *base = (jet){0, hf_dot3(du, m->normal), hf_dot3(dv, m->normal)};
    for (int d = 0; d < 3; d++) {
        du[d] -= base->by_u * m->normal[d];
        dv[d] -= base->by_v * m->normal[d];
    }
    hf_cross(du, dv, rise);
    double area = fabs(hf_dot3(rise, m->normal));
    g[0] = hf_dot3(dv, dv) / area;
    g[1] = -hf_dot3(du, dv) / area;
    g[2] = hf_dot3(du, du) / area;
}

static double product(const double g[3], jet a, jet b)
{
    return g[0] * a.by_u * b.by_u + g[1] * (a.by_u * b.by_v + a.by_v * b.by_u) + g[2] * a.by_v * b.by_v;
}

/* Computes bubble_m from sag_m: the mesh has minimum area between its sides, to second order in the slopes. */
static void settle(hf_facet_mesh *m)
{
    double matrix[HF_FACET_N_BUBBLE * HF_FACET_N_BUBBLE] = {0}, right[HF_FACET_N_BUBBLE] = {0};
    int pivot[HF_FACET_N_BUBBLE];
    for (int k = 0; k < HF_FACET_N_GAUSS * HF_FACET_N_GAUSS; k++) {
        int i = k % HF_FACET_N_GAUSS, j = k / HF_FACET_N_GAUSS;
        double g[3], weight = hf_facet_gauss_weight[i] * hf_facet_gauss_weight[j];
        jet basis[N_BASIS], height;
        measure_at(m, hf_facet_gauss_at[i], hf_facet_gauss_at[j], g, &height);
        evaluate_basis(m->is_triangle, hf_facet_gauss_at[i], hf_facet_gauss_at[j], basis);
        for (int s = 0; s < N_SIDE; s++) {
            height.by_u += m->sag_m[s] * basis[s].by_u;
            height.by_v += m->sag_m[s] * basis[s].by_v;
        }
        for (int a = 0; a < HF_FACET_N_BUBBLE; a++) {
            right[a] -= weight * product(g, basis[N_SIDE + a], height);
            for (int b = 0; b < HF_FACET_N_BUBBLE; b++)
                matrix[HF_FACET_N_BUBBLE * b + a] += weight * product(g, basis[N_SIDE + a], basis[N_SIDE + b]);
        }
    }
    if (hf_dense_factor(HF_FACET_N_BUBBLE, matrix, pivot) != 0) return; /* a facet without area has no mesh */
    hf_dense_solve(HF_FACET_N_BUBBLE, matrix, pivot, 1, right);
    memcpy(m->bubble_m, right, sizeof right);
}

void hf_facet_mesh_take_bent(const hf_facets *f, int i, const double *position_m, const double *sag_m, hf_facet_mesh *m)
{
    hf_facet_mesh_take(f, i, position_m, m);
    if (!sag_m) return;
    memcpy(m->sag_m, sag_m + 4 * (size_t)i, sizeof m->sag_m);
    settle(m);
}

double hf_facet_mesh_lift_m(const hf_facet_mesh *m, double u, double v, double slope[2])
{
    jet basis[N_BASIS];
    double sum = 0, part[N_BASIS];
    memcpy(part, m->sag_m, sizeof m->sag_m);
    memcpy(part + N_SIDE, m->bubble_m, sizeof m->bubble_m);
    slope[0] = slope[1] = 0;
    evaluate_basis(m->is_triangle, u, v, basis);
    for (int k = 0; k < N_BASIS; k++) {
        sum += part[k] * basis[k].value;
        slope[0] += part[k] * basis[k].by_u;
        slope[1] += part[k] * basis[k].by_v;
    }
    return sum;
}

void hf_facet_mesh_lifted(const hf_facet_mesh *m, double u, double v, double p[3], double du[3], double dv[3])
{
    double slope[2], lift_m = hf_facet_mesh_lift_m(m, u, v, slope);
    hf_facet_mesh_at(m, u, v, p, du, dv);
    for (int d = 0; d < 3; d++) {
        p[d] += lift_m * m->normal[d];
        du[d] += slope[0] * m->normal[d];
        dv[d] += slope[1] * m->normal[d];
    }
}

/* Above this pull ratio a cable is slack: its remaining tension is rounding. */
#define SLACK_PULL 1e6

const char *hf_facet_mesh_pull_words(double pull_ratio, char text[64])
{
    if (pull_ratio < SLACK_PULL)
        snprintf(text, 64, "a cable with N l = %.3g of its tension", pull_ratio);
    else
        strcpy(text, "a slack cable");
    return text;
}

/* ---- rules for waves ---- */

int hf_gauss_order(double phase, double error_ln, int most)
{
    double ln = hf_logarithm(2.0), step = 2 * hf_logarithm(fmax(phase, 1e-3));
    for (int n = 1; n < most; n++) {
        double k = 2 * n;
        ln += step + hf_logarithm(4.0 * n * n * n * n / (k * k * k * (k - 1) * (k - 1) * (k - 1)));
        if (ln - hf_logarithm(k + 1) < error_ln) return n;
    }
    return most;
}

/* Returns the Legendre polynomial of order n at x, and writes its derivative. */
static double legendre(int n, double x, double *derivative)
{
    double p = 1, before = 0;
    for (int k = 1; k <= n; k++) {
        double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
    }
    *derivative = n * (x * p - before) / (x * x - 1);
    return p;
}

void hf_gauss_rule(int n, double *at, double *weight)
{
    for (int i = 0; i < n; i++) {
        double x = hf_cosine(HF_PI * (i + 0.75) / (n + 0.5)), slope = 1, step = 1;
        for (int k = 0; k < 10 && fabs(step) > 1e-15; k++)
            x -= step = legendre(n, x, &slope) / slope;
        legendre(n, x, &slope);
        at[i] = (1 - x) / 2;
        weight[i] = 1 / ((1 - x * x) * slope * slope);
    }
}

/* ---- a shape ---- */

hf_status hf_facet_shape_take(const hf_model *m, const double *position_m, const double *tension_N,
                              hf_facet_shape *shape)
{
    double *of_node_m;
    int *end;
    HF_TRY(HF_ARENA_ARRAYS(&shape->block, HF_ARRAY(of_node_m, 3 * (size_t)m->n_node),
                           HF_ARRAY(end, 2 * (size_t)m->n_cable)));
    for (int k = 0; k < 2 * m->n_cable; k++)
        end[k] = m->node_of_row[m->end_row[k]];
    hf_model_positions(m, position_m, of_node_m);
    shape->position_m = of_node_m;
    shape->n_cable = m->n_cable;
    shape->end = end;
    shape->tension_N = tension_N;
    return HF_OK;
}

/* ---- quadrature points ---- */

const double hf_facet_flat_at[HF_FACET_N_FLAT] = {0.11270166537925831, 0.5, 0.88729833462074169};
const double hf_facet_flat_weight[HF_FACET_N_FLAT] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

/* Quadrature points over all facets, [3][n], with those of a facet adjacent. root_m [n]: roots of their weights, which
 * are projected areas. */
typedef struct {
    int n, per_facet;
    double *position_m, *root_m;
    double *error_m;                 /* [n], scratch for hf_facet_map */
    double *sag_m;                   /* [n_facet][4], sags of the mesh */
    double pull_ratio, pillow_rms_m; /* NaN without a mesh */
    void *block;
    bool has_shape; /* false: a cable cannot carry the pull of the mesh */
} points;

/* Computes the points of all facets. A flat facet is a bilinear surface through four corners, or a triangle if the last
 * two are equal. The squared height error has degree 4 in each parameter, and the area has degree 1, so the rule is
 * exact for it. With a mesh, a cable may be unable to carry its pull. There is then no shape, and the lifts are NaN.
 * Returns HF_OK or HF_NO_MEMORY. */
static hf_status put_points(double mesh_N_per_m, const hf_facets *f, const hf_facet_shape *shape, points *q)
{
    bool has_mesh = mesh_N_per_m > 0;
    int n = has_mesh ? HF_FACET_N_GAUSS : HF_FACET_N_FLAT;
    const double *place = has_mesh ? hf_facet_gauss_at : hf_facet_flat_at;
    const double *weight = has_mesh ? hf_facet_gauss_weight : hf_facet_flat_weight;
    double square = 0, all = 0;
    if (has_mesh) HF_TRY(hf_facet_mesh_sags(mesh_N_per_m, f, shape, q->sag_m, &q->pull_ratio));
    q->has_shape = !has_mesh || q->pull_ratio <= HF_FACET_PULL_MOST;
    for (int i = 0, at = 0; i < f->n_facet; i++) {
        hf_facet_mesh m;
        hf_facet_mesh_take_bent(f, i, shape->position_m, has_mesh ? q->sag_m : NULL, &m);
        for (int k = 0; k < n * n; k++, at++) {
            double u = place[k % n], v = place[k / n], lift_m = q->has_shape ? 0 : (double)NAN;
            double p[3], du[3], dv[3], slope[2];
            if (has_mesh && q->has_shape) lift_m = hf_facet_mesh_lift_m(&m, u, v, slope);
            hf_facet_mesh_at(&m, u, v, p, du, dv);
            for (int d = 0; d < 3; d++)
                q->position_m[(size_t)d * (size_t)q->n + (size_t)at] = p[d] + lift_m * m.normal[d];
            /* the lift does not change the projected area to first order */
            double area_m2 = fabs(du[0] * dv[1] - du[1] * dv[0]) * weight[k % n] * weight[k / n];
            q->root_m[at] = sqrt(area_m2);
            square += area_m2 * lift_m * lift_m;
            all += area_m2;
        }
    }
    if (has_mesh) q->pillow_rms_m = sqrt(square / all);
    return HF_OK;
}

static hf_status take_points(const hf_surface_settings *s, const hf_facets *f, const hf_facet_shape *shape, points *q)
{
    bool has_mesh = s->mesh_tension_N_per_m > 0 && shape->tension_N;
    *q = (points){.per_facet = has_mesh ? HF_FACET_N_GAUSS * HF_FACET_N_GAUSS : HF_FACET_N_FLAT * HF_FACET_N_FLAT};
    q->pull_ratio = q->pillow_rms_m = (double)NAN;
    size_t n_facet = (size_t)f->n_facet, n = n_facet * (size_t)q->per_facet;
    q->n = (int)n;
    HF_TRY(HF_ARENA_ARRAYS(&q->block, HF_ARRAY(q->sag_m, 4 * n_facet), HF_ARRAY(q->position_m, 3 * n),
                           HF_ARRAY(q->root_m, n), HF_ARRAY(q->error_m, n)));
    return put_points(has_mesh ? s->mesh_tension_N_per_m : 0, f, shape, q);
}

/* Returns the height of a point above the target surface, m. *weight is 1 / (1 + t^2), with the slope t there. */
static double height_of(const hf_surface_settings *s, const points *q, int i, double *weight)
{
    double p[3] = {q->position_m[i], q->position_m[q->n + i], q->position_m[2 * (size_t)q->n + (size_t)i]}, slope[2];
    double above = hf_target_surface_height_above(s->kind, 1 / (4 * s->focal_length_m), p, slope);
    *weight = 1 / (1 + slope[0] * slope[0] + slope[1] * slope[1]);
    return above;
}

/* ---- all facets ---- */

static void sum_up(const hf_surface_settings *s, const points *q, hf_surface_measures *to)
{
    double normal = 0, half_path = 0;
    to->facet_area_m2 = 0;
    for (int i = 0; i < q->n; i++) {
        double weight, dz = height_of(s, q, i, &weight), area = q->root_m[i] * q->root_m[i];
        to->facet_area_m2 += area;
        normal += area * dz * dz * weight;
        half_path += area * dz * dz * weight * weight;
    }
    to->facet_normal_rms_m = sqrt(normal / to->facet_area_m2);
    to->facet_half_path_rms_m = sqrt(half_path / to->facet_area_m2);
}

hf_status hf_facet_measure(const hf_surface_settings *s, const hf_facets *f, const hf_facet_shape *shape,
                           hf_surface_measures *to)
{
    points q;
    hf_surface_fit fit;
    to->n_facet = f->n_facet;
    to->n_open_face = f->n_open;
    to->facet_area_m2 = 0;
    to->facet_normal_rms_m = to->facet_half_path_rms_m = to->facet_fit_focal_length_m = (double)NAN;
    to->facet_fit_normal_rms_m = to->facet_fit_half_path_rms_m = (double)NAN;
    to->pillow_rms_m = to->mesh_pull_ratio = (double)NAN;
    if (f->n_facet == 0) return HF_OK;
    hf_status status = take_points(s, f, shape, &q);
    to->mesh_pull_ratio = q.pull_ratio;
    to->pillow_rms_m = q.pillow_rms_m;
    if (status == HF_OK && q.has_shape) {
        sum_up(s, &q, to);
        status = hf_surface_fit_points(s->kind, s->focal_length_m, q.n, q.position_m, q.root_m, &fit);
    }
    hf_arena_free_block(q.block);
    if (status != HF_OK || !q.has_shape) return status;
    to->facet_fit_half_path_rms_m = fit.half_path_rms_m;
    to->facet_fit_normal_rms_m = fit.normal_rms_m;
    to->facet_fit_focal_length_m = fit.focal_length_m;
    return HF_OK;
}

hf_status hf_facet_fit(const hf_surface_settings *s, const hf_facets *f, const hf_facet_shape *shape,
                       hf_surface_fit *fit, hf_fit_parameters *parameters)
{
    points q;
    *fit = (hf_surface_fit){0};
    *parameters = (hf_fit_parameters){0};
    hf_status status = take_points(s, f, shape, &q);
    if (status == HF_OK && q.has_shape)
        status = hf_surface_fit_find(s->kind, s->focal_length_m, q.n, q.position_m, q.root_m, fit, parameters);
    hf_arena_free_block(q.block);
    return status;
}

hf_status hf_facet_measure_near(const hf_surface_pose *from, const hf_surface_settings *s, const hf_facets *f,
                                const hf_facet_shape *shape, double *half_path_rms_m, double *fit_half_path_rms_m)
{
    points q;
    hf_surface_fit fit;
    hf_surface_measures all;
    *half_path_rms_m = *fit_half_path_rms_m = (double)NAN;
    hf_status status = take_points(s, f, shape, &q);
    if (status == HF_OK && q.has_shape) {
        sum_up(s, &q, &all);
        *half_path_rms_m = all.facet_half_path_rms_m;
        if (!hf_surface_fit_near(from, q.n, q.position_m, q.root_m, fit_half_path_rms_m)) {
            status = hf_surface_fit_points(s->kind, s->focal_length_m, q.n, q.position_m, q.root_m, &fit);
            *fit_half_path_rms_m = fit.half_path_rms_m;
        }
    }
    hf_arena_free_block(q.block);
    return status;
}

/* ---- each facet ---- */

/* Computes mean and RMS of the errors of each facet, weighted by projected area. */
static void average(const points *q, int n_facet, double *mean_m, double *rms_m)
{
    for (int i = 0; i < n_facet; i++) {
        double area = 0, sum = 0, square = 0;
        for (int k = i * q->per_facet; k < (i + 1) * q->per_facet; k++) {
            double weight = q->root_m[k] * q->root_m[k], e = q->error_m[k];
            area += weight;
            sum += weight * e;
            square += weight * e * e;
        }
        mean_m[i] = sum / area;
        rms_m[i] = sqrt(square / area);
    }
}

hf_status hf_facet_map(const hf_surface_settings *s, const hf_facets *f, const hf_facet_shape *shape,
                       const hf_facet_errors *to)
{
    points q;
    hf_surface_fit fit;
    if (f->n_facet == 0) return HF_OK;
    hf_status status = take_points(s, f, shape, &q);
    for (int i = 0; i < q.n && status == HF_OK; i++) {
        double weight, dz = height_of(s, &q, i, &weight);
        q.error_m[i] = dz * sqrt(weight);
    }
    if (status == HF_OK) {
        average(&q, f->n_facet, to->normal_mean_m, to->normal_rms_m);
        average(&q, f->n_facet, to->fit_normal_mean_m, to->fit_normal_rms_m); /* NaN; final if there is no shape */
    }
    if (status == HF_OK && q.has_shape)
        status = hf_surface_fit_points(s->kind, s->focal_length_m, q.n, q.position_m, q.root_m, &fit);
    if (status == HF_OK && q.has_shape) {
        hf_surface_fit_errors(s->kind, &fit, q.n, q.position_m, q.error_m);
        average(&q, f->n_facet, to->fit_normal_mean_m, to->fit_normal_rms_m);
    }
    hf_arena_free_block(q.block);
    return status;
}
