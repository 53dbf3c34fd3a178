/* Contents: points of quadrature - all facets - each facet */
#include "solve/facet_rms.h"

#include "base/arena.h"
#include "net/wanted.h"

#include <math.h>

/* ---- points of quadrature ---- */

enum { N_GAUSS = 3, N_POINT = N_GAUSS * N_GAUSS }; /* of a facet */

/* Gauss-Legendre on [0, 1], exact to the fifth power. */
static const double gauss_at[N_GAUSS] = {0.11270166537925831, 0.5, 0.88729833462074169};
static const double gauss_weight[N_GAUSS] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

/* Points of quadrature over all facets, those of a facet together: [3][n], and the roots of their weights, which are
 * projected area. */
typedef struct {
    int n;
    double *position_m, *root_m;
    double *error_m; /* [n] scratch of a map */
} points;

static void lay_out(hf_arena *a, int n_facet, points *q)
{
    size_t n = (size_t)n_facet * N_POINT;
    q->n = (int)n;
    q->position_m = hf_arena_take(a, 3 * n, sizeof(double));
    q->root_m = hf_arena_take(a, n, sizeof(double));
    q->error_m = hf_arena_take(a, n, sizeof(double));
}

/* The bilinear surface through four corners in space; through three of them, the last twice, it is their triangle. The
 * square of the error by height has the fourth power of each parameter, times the first of the area: the rule is exact
 * for it. */
static void put_facet(const hf_facets *f, int i, const hf_facet_shape *shape, points *q)
{
    const double *c[4];
    for (int k = 0; k < 4; k++)
        c[k] = shape->position_m + 3 * (size_t)f->corner[4 * (size_t)i + (size_t)k];
    for (int k = 0; k < N_POINT; k++) {
        double u = gauss_at[k % N_GAUSS], v = gauss_at[k / N_GAUSS], du[3], dv[3];
        size_t at = (size_t)i * N_POINT + (size_t)k;
        for (int d = 0; d < 3; d++) {
            double near = c[0][d] + u * (c[1][d] - c[0][d]), far = c[3][d] + u * (c[2][d] - c[3][d]);
            q->position_m[(size_t)d * (size_t)q->n + at] = near + v * (far - near);
            du[d] = (1 - v) * (c[1][d] - c[0][d]) + v * (c[2][d] - c[3][d]);
            dv[d] = far - near;
        }
        double area_m2 = fabs(du[0] * dv[1] - du[1] * dv[0]);
        q->root_m[at] = sqrt(area_m2 * gauss_weight[k % N_GAUSS] * gauss_weight[k / N_GAUSS]);
    }
}

static hf_status take_points(const hf_facets *f, const hf_facet_shape *shape, hf_arena *arena, points *q)
{
    HF_TRY(HF_ARENA_MAKE(arena, lay_out(arena, f->n_facet, q)));
    for (int i = 0; i < f->n_facet; i++)
        put_facet(f, i, shape, q);
    return HF_OK;
}

/* Height of a point above the wanted surface; 1 / (1 + t^2) with the slope t there. */
static double height_of(const hf_surface_settings *s, const points *q, int i, double *weight)
{
    double p[3] = {q->position_m[i], q->position_m[q->n + i], q->position_m[2 * (size_t)q->n + (size_t)i]}, slope[2];
    double above = hf_wanted_height_above(s->kind, 1 / (4 * s->focal_length_m), p, slope);
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
    hf_arena arena = {0};
    to->n_facet = f->n_facet;
    to->n_open_face = f->n_open;
    to->facet_area_m2 = 0;
    to->facet_normal_rms_m = to->facet_half_path_rms_m = to->facet_fit_focal_length_m = (double)NAN;
    to->facet_fit_normal_rms_m = to->facet_fit_half_path_rms_m = (double)NAN;
    if (f->n_facet == 0) return HF_OK;
    HF_TRY(take_points(f, shape, &arena, &q));
    sum_up(s, &q, to);
    hf_status status = hf_surface_fit_points(s->kind, s->focal_length_m, q.n, q.position_m, q.root_m, &fit);
    hf_arena_free(&arena);
    if (status != HF_OK) return status;
    to->facet_fit_half_path_rms_m = fit.half_path_rms_m;
    to->facet_fit_normal_rms_m = fit.normal_rms_m;
    to->facet_fit_focal_length_m = fit.focal_length_m;
    return HF_OK;
}

/* ---- each facet ---- */

/* Mean and RMS of the errors of each facet, by projected area. */
static void average(const points *q, int n_facet, double *mean_m, double *rms_m)
{
    for (int i = 0; i < n_facet; i++) {
        double area = 0, sum = 0, square = 0;
        for (int k = i * N_POINT; k < (i + 1) * N_POINT; k++) {
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
    hf_arena arena = {0};
    if (f->n_facet == 0) return HF_OK;
    HF_TRY(take_points(f, shape, &arena, &q));
    for (int i = 0; i < q.n; i++) {
        double weight, dz = height_of(s, &q, i, &weight);
        q.error_m[i] = dz * sqrt(weight);
    }
    average(&q, f->n_facet, to->normal_mean_m, to->normal_rms_m);
    hf_status status = hf_surface_fit_points(s->kind, s->focal_length_m, q.n, q.position_m, q.root_m, &fit);
    if (status == HF_OK) {
        hf_surface_fit_errors(s->kind, &fit, q.n, q.position_m, q.error_m);
        average(&q, f->n_facet, to->fit_normal_mean_m, to->fit_normal_rms_m);
    }
    hf_arena_free(&arena);
    return status;
}
