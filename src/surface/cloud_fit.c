/* The best fit to a cloud as a function of its points:
 *
 *     points -> hf_surface_fit_find -> one Newton step -> errors from the fitted surface
 *     linearise: H factored; derivatives of G and of the errors by each point
 *     push: motion of points -> change of G -> change of the parameters by H^-1 -> rates of the errors
 *
 * Contents: layout - one point - the fit - derivatives */
#include "surface/cloud.h"

#include "linalg/dense.h"
#include "surface/fit_point.h"

#include <math.h>
#include <string.h>

enum { N_MOST = HF_FIT_N_PARAMETER };

/* Maximum Newton step, for parameters of order one. After a longer step the fit is not yet a minimum, so the step
 * is not taken. */
#define STEP_MOST 1e-3

/* ---- layout ---- */

void hf_cloud_fit_lay_out(hf_arena *a, hf_cloud *c)
{
    size_t n = (size_t)c->n;
    c->pose.slope = hf_arena_take(a, N_MOST * n, sizeof(double));
    c->pose.slope_center = hf_arena_take(a, 3 * n, sizeof(double));
    c->pose.pull = hf_arena_take(a, N_MOST * 3 * n, sizeof(double));
    c->pose.pull_area = hf_arena_take(a, N_MOST * n, sizeof(double));
}

/* ---- one point ---- */

static double dot4(const double a[4], const double b[4])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

static hf_fit_frame frame_of(const hf_cloud *c)
{
    return hf_fit_frame_of(c->kind, c->focal_length_m, c->n, c->position_m, c->n_facet > 0 ? c->root_m : NULL,
                           &c->pose.found);
}

/* ---- the fit ---- */

/* Computes G [n], and H [n][n] factored. Returns HF_OK or HF_SINGULAR. */
static hf_status factor(hf_cloud *c, const hf_fit_frame *f, double *G)
{
    hf_fit_hessian(f, G, c->pose.factor);
    return hf_dense_factor(c->pose.found.n, c->pose.factor, c->pose.pivot) == 0 ? HF_OK : HF_SINGULAR;
}

/* Improves the fit by one Newton step. The fit ends when rounding keeps the sum of squares from falling. At that point
 * the parameters have only half of the digits, which is not enough for differences of residuals. */
static void refine(hf_cloud *c)
{
    hf_fit_parameters *found = &c->pose.found;
    hf_fit_frame f = frame_of(c);
    double step[N_MOST], most = 0;
    if (factor(c, &f, step) != HF_OK) return;
    hf_dense_solve(found->n, c->pose.factor, c->pose.pivot, 1, step);
    for (int k = 0; k < found->n; k++)
        most = fmax(most, fabs(step[k]));
    if (!(most < STEP_MOST)) return;
    for (int k = 0; k < found->n; k++)
        found->value[found->quantity[k]] -= step[k];
}

hf_status hf_cloud_fit_measure(hf_cloud *c)
{
    hf_surface_fit fit;
    HF_TRY(hf_surface_fit_find(c->kind, c->focal_length_m, c->n, c->position_m, c->n_facet > 0 ? c->root_m : NULL, &fit,
                               &c->pose.found));
    if (fit.converged) refine(c);
    hf_fit_frame f = frame_of(c);
    for (int i = 0; i < c->n; i++) {
        double arm[3], at[3], d[4];
        hf_fit_locate(&f, i, arm, at);
        c->error_m[i] =
            fit.converged ? hf_cloud_error(c->kind, hf_cloud_power(c->along), f.curvature_per_m, at, d) : (double)NAN;
    }
    return HF_OK;
}

/* ---- derivatives ---- */

/* Adds the contributions of point i to the derivatives of G for parameter k. */
static void pull_of(hf_cloud *c, const hf_fit_frame *f, const hf_fit_point *p, int i, int k)
{
    hf_cloud_pose *q = &c->pose;
    int angle = hf_fit_angle_of(q->found.quantity[k]);
    double by = dot4(p->d, p->by[k]), weight = hf_fit_weight(f, i), bent[3];
    for (int a = 0; a < 3; a++)
        bent[a] = p->d[a] * by + p->value * dot4(p->dd[a], p->by[k]);
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

hf_status hf_cloud_fit_linearise(hf_cloud *c)
{
    hf_cloud_pose *q = &c->pose;
    hf_fit_frame f = frame_of(c);
    double G[N_MOST];
    HF_TRY(factor(c, &f, G));
    memset(q->pull_center, 0, sizeof q->pull_center);
    for (int i = 0; i < c->n; i++) {
        double d[4];
        hf_fit_point p = hf_fit_point_take(&f, i);
        hf_cloud_error(c->kind, hf_cloud_power(c->along), f.curvature_per_m, p.at, d);
        for (int k = 0; k < q->found.n; k++) {
            pull_of(c, &f, &p, i, k);
            q->slope[k * c->n + i] = dot4(d, p.by[k]);
        }
        for (int k = 0; k < 3; k++) {
            double by = d[0] * f.turn[0][k] + d[1] * f.turn[1][k] + d[2] * f.turn[2][k];
            c->slope[k * c->n + i] = by;
            q->slope_center[k * c->n + i] = d[k] - by;
        }
    }
    return HF_OK;
}

void hf_cloud_fit_push(hf_cloud *c, double *rate)
{
    const hf_cloud_pose *q = &c->pose;
    int n = q->found.n;
    double center[3] = {0}, change[N_MOST] = {0};
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
    }
    hf_dense_solve(n, q->factor, q->pivot, 1, change);
    for (int i = 0; i < c->n; i++) {
        rate[i] = 0;
        for (int d = 0; d < 3; d++)
            rate[i] += c->slope[d * c->n + i] * c->move[d * c->n + i] + q->slope_center[d * c->n + i] * center[d];
        for (int k = 0; k < n; k++)
            rate[i] += q->slope[k * c->n + i] * change[k];
    }
}
