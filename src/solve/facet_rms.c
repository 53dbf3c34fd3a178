#include "solve/facet_rms.h"

#include "base/arena.h"
#include "net/wanted.h"

#include <math.h>

enum { N_GAUSS = 3, N_POINT = N_GAUSS * N_GAUSS }; /* of a facet */

/* Gauss-Legendre on [0, 1], exact to the fifth power. */
static const double gauss_at[N_GAUSS] = {0.11270166537925831, 0.5, 0.88729833462074169};
static const double gauss_weight[N_GAUSS] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

/* Points of quadrature over all facets, [3][n], and the roots of their weights: projected area. */
typedef struct {
    int n;
    double *position_m, *root_m;
} points;

/* The bilinear surface through four corners in space; through three of them, the last twice, it is their triangle. The
 * square of the error by height has the fourth power of each parameter, times the first of the area: the rule is exact
 * for it. */
static void put_facet(const hf_facets *f, int i, const hf_model *m, const hf_workspace *w, points *q)
{
    double c[4][3];
    for (int k = 0; k < 4; k++)
        for (int d = 0; d < 3; d++)
            c[k][d] = w->position_m[d * m->n_node + m->row_of_node[f->corner[4 * (size_t)i + (size_t)k]]];
    for (int k = 0; k < N_POINT; k++) {
        double u = gauss_at[k % N_GAUSS], v = gauss_at[k / N_GAUSS], du[3], dv[3];
        for (int d = 0; d < 3; d++) {
            double near = c[0][d] + u * (c[1][d] - c[0][d]), far = c[3][d] + u * (c[2][d] - c[3][d]);
            q->position_m[(size_t)d * (size_t)f->n_facet * N_POINT + (size_t)q->n] = near + v * (far - near);
            du[d] = (1 - v) * (c[1][d] - c[0][d]) + v * (c[2][d] - c[3][d]);
            dv[d] = far - near;
        }
        double area_m2 = fabs(du[0] * dv[1] - du[1] * dv[0]);
        q->root_m[q->n++] = sqrt(area_m2 * gauss_weight[k % N_GAUSS] * gauss_weight[k / N_GAUSS]);
    }
}

static void sum_up(const hf_surface_settings *s, const points *q, hf_surface_measures *to)
{
    double curvature = 1 / (4 * s->focal_length_m), normal = 0, half_path = 0, slope[2];
    to->facet_area_m2 = 0;
    for (int i = 0; i < q->n; i++) {
        double p[3] = {q->position_m[i], q->position_m[q->n + i], q->position_m[2 * (size_t)q->n + (size_t)i]};
        double dz = hf_wanted_height_above(s->kind, curvature, p, slope), area = q->root_m[i] * q->root_m[i];
        double weight = 1 / (1 + slope[0] * slope[0] + slope[1] * slope[1]);
        to->facet_area_m2 += area;
        normal += area * dz * dz * weight;
        half_path += area * dz * dz * weight * weight;
    }
    to->facet_normal_rms_m = sqrt(normal / to->facet_area_m2);
    to->facet_half_path_rms_m = sqrt(half_path / to->facet_area_m2);
}

hf_status hf_facet_measure(const hf_surface_settings *s, const hf_facets *f, const hf_model *m, const hf_workspace *w,
                           hf_surface_measures *to)
{
    size_t n = (size_t)f->n_facet * N_POINT;
    points q = {0};
    hf_surface_fit fit;
    hf_arena arena = {0};
    to->n_facet = f->n_facet;
    to->n_open_face = f->n_open;
    to->facet_area_m2 = 0;
    to->facet_normal_rms_m = to->facet_half_path_rms_m = to->facet_fit_focal_length_m = (double)NAN;
    to->facet_fit_normal_rms_m = to->facet_fit_half_path_rms_m = (double)NAN;
    if (f->n_facet == 0) return HF_OK;
    HF_TRY(HF_ARENA_MAKE(&arena, q.position_m = hf_arena_take(&arena, 4 * n, sizeof(double))));
    q.root_m = q.position_m + 3 * n;
    for (int i = 0; i < f->n_facet; i++)
        put_facet(f, i, m, w, &q);
    sum_up(s, &q, to);
    hf_status status = hf_surface_fit_points(s->kind, s->focal_length_m, q.n, q.position_m, q.root_m, &fit);
    hf_arena_free(&arena);
    if (status != HF_OK) return status;
    to->facet_fit_half_path_rms_m = fit.half_path_rms_m;
    to->facet_fit_normal_rms_m = fit.normal_rms_m;
    to->facet_fit_focal_length_m = fit.focal_length_m;
    return HF_OK;
}
