/* Measures the errors over the facets of a shape:
 *
 *     shape, facets -> quadrature points: 3 x 3 per flat facet, or 5 x 5 per facet with a mesh (facet_mesh)
 *       -> RMS errors by projected area -> best fit to all points -> RMS errors after the fit
 *
 * Contents: a shape - quadrature points - all facets - each facet */
#include "surface/facet_rms.h"

#include "base/arena.h"
#include "net/target_surface.h"
#include "surface/facet_mesh.h"

#include <math.h>
#include <string.h>

/* ---- a shape ---- */

hf_status hf_facet_shape_take(const hf_model *m, const double *position_m, const double *tension_N,
                              hf_facet_shape *shape, hf_arena *arena)
{
    double *of_node_m;
    int *end;
    HF_TRY(HF_ARENA_MAKE(arena, (of_node_m = hf_arena_take(arena, 3 * (size_t)m->n_node, sizeof(double)),
                                 end = hf_arena_take(arena, 2 * (size_t)m->n_cable, sizeof(int)))));
    for (int k = 0; k < 2 * m->n_cable; k++)
        end[k] = m->node_of_row[m->end_row[k]];
    hf_model_positions(m, position_m, of_node_m);
    *shape = (hf_facet_shape){of_node_m, m->n_cable, end, tension_N};
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
    bool has_shape;                  /* false: a cable cannot carry the pull of the mesh */
} points;

static void lay_out(hf_arena *a, int n_facet, points *q)
{
    size_t n = (size_t)n_facet * (size_t)q->per_facet;
    q->n = (int)n;
    q->sag_m = hf_arena_take(a, 4 * (size_t)n_facet, sizeof(double));
    q->position_m = hf_arena_take(a, 3 * n, sizeof(double));
    q->root_m = hf_arena_take(a, n, sizeof(double));
    q->error_m = hf_arena_take(a, n, sizeof(double));
}

/* Computes a point p of a facet, lifted along the normal. Returns the projected area per du dv there, m2. The lift does
 * not change the area to first order. */
static double point_at(const hf_facet_mesh *m, double u, double v, double lift_m, double p[3])
{
    double du[3], dv[3];
    hf_facet_mesh_at(m, u, v, p, du, dv);
    for (int d = 0; d < 3; d++)
        p[d] += lift_m * m->normal[d];
    return fabs(du[0] * dv[1] - du[1] * dv[0]);
}

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
            double u = place[k % n], v = place[k / n], p[3], slope[2], lift_m = q->has_shape ? 0 : (double)NAN;
            if (has_mesh && q->has_shape) lift_m = hf_facet_mesh_lift_m(&m, u, v, slope);
            double area_m2 = point_at(&m, u, v, lift_m, p) * weight[k % n] * weight[k / n];
            for (int d = 0; d < 3; d++)
                q->position_m[(size_t)d * (size_t)q->n + (size_t)at] = p[d];
            q->root_m[at] = sqrt(area_m2);
            square += area_m2 * lift_m * lift_m;
            all += area_m2;
        }
    }
    if (has_mesh) q->pillow_rms_m = sqrt(square / all);
    return HF_OK;
}

static hf_status take_points(const hf_surface_settings *s, const hf_facets *f, const hf_facet_shape *shape,
                             hf_arena *arena, points *q)
{
    bool has_mesh = s->mesh_tension_N_per_m > 0 && shape->tension_N;
    *q = (points){.per_facet = has_mesh ? HF_FACET_N_GAUSS * HF_FACET_N_GAUSS : HF_FACET_N_FLAT * HF_FACET_N_FLAT};
    q->pull_ratio = q->pillow_rms_m = (double)NAN;
    HF_TRY(HF_ARENA_MAKE(arena, lay_out(arena, f->n_facet, q)));
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
    hf_arena arena = {0};
    to->n_facet = f->n_facet;
    to->n_open_face = f->n_open;
    to->facet_area_m2 = 0;
    to->facet_normal_rms_m = to->facet_half_path_rms_m = to->facet_fit_focal_length_m = (double)NAN;
    to->facet_fit_normal_rms_m = to->facet_fit_half_path_rms_m = (double)NAN;
    to->pillow_rms_m = to->mesh_pull_ratio = (double)NAN;
    if (f->n_facet == 0) return HF_OK;
    hf_status status = take_points(s, f, shape, &arena, &q);
    to->mesh_pull_ratio = q.pull_ratio;
    to->pillow_rms_m = q.pillow_rms_m;
    if (status != HF_OK || !q.has_shape) {
        hf_arena_free(&arena);
        return status;
    }
    sum_up(s, &q, to);
    status = hf_surface_fit_points(s->kind, s->focal_length_m, q.n, q.position_m, q.root_m, &fit);
    hf_arena_free(&arena);
    if (status != HF_OK) return status;
    to->facet_fit_half_path_rms_m = fit.half_path_rms_m;
    to->facet_fit_normal_rms_m = fit.normal_rms_m;
    to->facet_fit_focal_length_m = fit.focal_length_m;
    return HF_OK;
}

hf_status hf_facet_fit(const hf_surface_settings *s, const hf_facets *f, const hf_facet_shape *shape,
                       hf_surface_fit *fit, hf_fit_parameters *parameters)
{
    points q;
    hf_arena arena = {0};
    *fit = (hf_surface_fit){0};
    *parameters = (hf_fit_parameters){0};
    hf_status status = take_points(s, f, shape, &arena, &q);
    if (status == HF_OK && q.has_shape)
        status = hf_surface_fit_find(s->kind, s->focal_length_m, q.n, q.position_m, q.root_m, fit, parameters);
    hf_arena_free(&arena);
    return status;
}

hf_status hf_facet_measure_near(const hf_surface_pose *from, const hf_surface_settings *s, const hf_facets *f,
                                const hf_facet_shape *shape, double *half_path_rms_m, double *fit_half_path_rms_m)
{
    points q;
    hf_surface_fit fit;
    hf_surface_measures all;
    hf_arena arena = {0};
    *half_path_rms_m = *fit_half_path_rms_m = (double)NAN;
    hf_status status = take_points(s, f, shape, &arena, &q);
    if (status == HF_OK && q.has_shape) {
        sum_up(s, &q, &all);
        *half_path_rms_m = all.facet_half_path_rms_m;
        if (!hf_surface_fit_near(from, q.n, q.position_m, q.root_m, fit_half_path_rms_m)) {
            status = hf_surface_fit_points(s->kind, s->focal_length_m, q.n, q.position_m, q.root_m, &fit);
            *fit_half_path_rms_m = fit.half_path_rms_m;
        }
    }
    hf_arena_free(&arena);
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
    hf_arena arena = {0};
    if (f->n_facet == 0) return HF_OK;
    hf_status status = take_points(s, f, shape, &arena, &q);
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
    hf_arena_free(&arena);
    return status;
}
