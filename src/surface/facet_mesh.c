/* Computes the shape of a mesh under tension N between cables:
 *
 *     shape, facets -> match the sides of facets with cables -> force F on cables between two facets
 *       -> sags F l^2 / (8 T) of the sides -> per facet: Ritz method, minimum area -> lift at any u, v
 *
 * Contents: facets - sides - the mesh of a facet */
#include "surface/facet_mesh.h"

#include "base/elementary.h"
#include "base/arena.h"
#include "linalg/dense.h"
#include "net/side.h"

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
    hf_arena arena = {0};
    size_t most = (size_t)shape->n_cable + 4 * (size_t)f->n_facet;
    HF_TRY(HF_ARENA_MAKE(&arena, all = hf_arena_take(&arena, most, sizeof *all)));
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
    hf_arena_free(&arena);
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
        rise[d] = 0;
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
