/* The best fit to a cloud as a function of its points. Contents: layout - one point - the fit - derivatives */
#include "solve/cloud.h"

#include "linalg/dense.h"
#include "net/wanted.h"

#include <math.h>
#include <string.h>

enum { N_MOST = HF_FIT_N_PARAMETER };

/* Of parameters of the order of one. A longer step says that the fit is not a minimum as yet, and is not taken. */
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

/* The parameters' derivatives of turn (r) with r = p - center - shift: what a point needs, the same for all points. */
typedef struct {
    double slope[3][3][3];    /* of the rotation by each angle */
    double bend[3][3][3][3];  /* by two angles */
    double unit_m, curvature; /* of a shift; of CURVE */
} pose_slopes;

/* A point in the frame of the surface: its place and the curvature are four coordinates. */
typedef struct {
    double at[3], arm[3];         /* its place there; its place from the shifted centre, in the frame of the net */
    double by[N_MOST][4];         /* coordinates by parameter */
    double value, d[4], dd[4][4]; /* its half-path error, and the derivatives by coordinates */
} fitted_point;

static void multiply_vector(const double m[3][3], const double v[3], double to[3])
{
    for (int k = 0; k < 3; k++)
        to[k] = m[k][0] * v[0] + m[k][1] * v[1] + m[k][2] * v[2];
}

static double dot4(const double a[4], const double b[4])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

/* Component of a shift, or -1; which angle, or -1. */
static int shift_of(int quantity)
{
    return quantity == HF_FIT_SHIFT_X ? 0 : quantity == HF_FIT_SHIFT_Y ? 1 : quantity == HF_FIT_SHIFT_Z ? 2 : -1;
}

static int angle_of(int quantity)
{
    return quantity >= HF_FIT_TURN_X && quantity <= HF_FIT_TURN_Z ? quantity - HF_FIT_TURN_X : -1;
}

static pose_slopes slopes_of(const hf_cloud *c)
{
    const hf_fit_parameters *f = &c->pose.found;
    pose_slopes s = {.unit_m = f->size_m, .curvature = 1 / (4 * c->focal_length_m)};
    for (int a = 0; a < 3; a++) {
        hf_fit_rotation(f->value + HF_FIT_TURN_X, (const int[3]){a == 0, a == 1, a == 2}, s.slope[a]);
        for (int b = 0; b < 3; b++) {
            const int order[3] = {(a == 0) + (b == 0), (a == 1) + (b == 1), (a == 2) + (b == 2)};
            hf_fit_rotation(f->value + HF_FIT_TURN_X, order, s.bend[a][b]);
        }
    }
    return s;
}

static void locate(const hf_cloud *c, int i, double arm[3], double at[3])
{
    const hf_cloud_pose *q = &c->pose;
    for (int d = 0; d < 3; d++)
        arm[d] = c->position_m[d * c->n + i] - q->found.center_m[d] - q->shift_m[d];
    multiply_vector(q->turn, arm, at);
    for (int d = 0; d < 3; d++)
        at[d] += q->found.center_m[d];
}

/* Second derivatives of u / D with D = 1 + t^2, of a half-path error. */
static void bend_error(hf_surface_kind kind, double curvature, fitted_point *p)
{
    double t[2], u = hf_wanted_height_above(kind, curvature, p->at, t), D = 1 + t[0] * t[0] + t[1] * t[1];
    double flat = p->at[2] - u, u1[4] = {-t[0], -t[1], 1, -flat / curvature}, u2[4][4] = {{0}}, D2[4][4] = {{0}};
    double D1[4] = {4 * curvature * t[0], 4 * curvature * t[1], 0, 8 * flat};
    for (int k = 0; k < (kind == HF_SURFACE_PARABOLOID ? 2 : 1); k++) {
        u2[k][k] = -2 * curvature;
        u2[k][3] = u2[3][k] = -t[k] / curvature;
        D2[k][k] = 8 * curvature * curvature;
        D2[k][3] = D2[3][k] = 8 * t[k];
    }
    D2[3][3] = 8 * flat / curvature;
    for (int a = 0; a < 4; a++)
        for (int b = 0; b < 4; b++)
            p->dd[a][b] =
                (u2[a][b] - (u1[a] * D1[b] + u1[b] * D1[a] + u * D2[a][b] - 2 * u * D1[a] * D1[b] / D) / D) / D;
}

static void take_point(const hf_cloud *c, const pose_slopes *s, int i, fitted_point *p)
{
    const hf_cloud_pose *q = &c->pose;
    locate(c, i, p->arm, p->at);
    p->value = hf_cloud_error(c->kind, 1, q->curvature, p->at, p->d);
    bend_error(c->kind, q->curvature, p);
    for (int k = 0; k < q->found.n; k++) {
        int shift = shift_of(q->found.quantity[k]), angle = angle_of(q->found.quantity[k]);
        memset(p->by[k], 0, sizeof p->by[k]);
        if (shift >= 0)
            for (int d = 0; d < 3; d++)
                p->by[k][d] = -s->unit_m * q->turn[d][shift];
        else if (angle >= 0)
            multiply_vector(s->slope[angle], p->arm, p->by[k]);
        else
            p->by[k][3] = s->curvature;
    }
}

/* Derivative of the coordinates by parameters j and k. */
static void bend_place(const hf_cloud *c, const pose_slopes *s, const fitted_point *p, int j, int k, double to[4])
{
    const int *quantity = c->pose.found.quantity;
    int a = angle_of(quantity[j]), b = angle_of(quantity[k]), shift = shift_of(quantity[a < 0 ? j : k]);
    memset(to, 0, 4 * sizeof *to);
    if (a >= 0 && b >= 0) multiply_vector(s->bend[a][b], p->arm, to);
    if ((a >= 0) == (b >= 0) || shift < 0) return;
    for (int d = 0; d < 3; d++)
        to[d] = -s->unit_m * s->slope[a < 0 ? b : a][d][shift];
}

/* ---- the fit ---- */

static void set_pose(hf_cloud *c)
{
    hf_cloud_pose *q = &c->pose;
    const double *value = q->found.value;
    q->curvature = (1 + value[HF_FIT_CURVE]) / (4 * c->focal_length_m);
    q->shift_m[0] = q->found.size_m * value[HF_FIT_SHIFT_X];
    q->shift_m[1] = q->found.size_m * value[HF_FIT_SHIFT_Y];
    q->shift_m[2] = q->found.size_m * value[HF_FIT_SHIFT_Z];
    hf_fit_rotation(value + HF_FIT_TURN_X, (const int[3]){0}, q->turn);
}

static double weight_of(const hf_cloud *c, int i)
{
    return c->n_facet > 0 ? c->root_m[i] * c->root_m[i] : 1;
}

/* G [n], and H [n][n] factored. HF_OK or HF_SINGULAR. */
static hf_status factor(hf_cloud *c, const pose_slopes *s, double *G)
{
    hf_cloud_pose *q = &c->pose;
    int n = q->found.n;
    memset(q->factor, 0, sizeof q->factor);
    memset(G, 0, N_MOST * sizeof *G);
    for (int i = 0; i < c->n; i++) {
        fitted_point p;
        double by[N_MOST], bend[4], weight = weight_of(c, i);
        take_point(c, s, i, &p);
        for (int k = 0; k < n; k++)
            by[k] = dot4(p.d, p.by[k]);
        for (int k = 0; k < n; k++) {
            double turned[4]; /* dd times the derivative of the coordinates */
            G[k] += weight * p.value * by[k];
            for (int a = 0; a < 4; a++)
                turned[a] = dot4(p.dd[a], p.by[k]);
            for (int j = 0; j <= k; j++) {
                bend_place(c, s, &p, j, k, bend);
                q->factor[k * n + j] += weight * (by[j] * by[k] + p.value * (dot4(turned, p.by[j]) + dot4(p.d, bend)));
            }
        }
    }
    for (int k = 0; k < n; k++)
        for (int j = 0; j < k; j++)
            q->factor[j * n + k] = q->factor[k * n + j];
    return hf_dense_factor(n, q->factor, q->pivot) == 0 ? HF_OK : HF_SINGULAR;
}

/* The fit ends where rounding keeps the sum of squares from falling, which is half of the digits away from where G is
 * zero; one step of Newton's method goes there. Differences of residuals need that. */
static void refine(hf_cloud *c)
{
    hf_fit_parameters *f = &c->pose.found;
    pose_slopes s = slopes_of(c);
    double step[N_MOST], most = 0;
    if (factor(c, &s, step) != HF_OK) return;
    hf_dense_solve(f->n, c->pose.factor, c->pose.pivot, 1, step);
    for (int k = 0; k < f->n; k++)
        most = fmax(most, fabs(step[k]));
    if (!(most < STEP_MOST)) return;
    for (int k = 0; k < f->n; k++)
        f->value[f->quantity[k]] -= step[k];
    set_pose(c);
}

hf_status hf_cloud_fit_measure(hf_cloud *c)
{
    hf_surface_fit fit;
    hf_cloud_pose *q = &c->pose;
    HF_TRY(hf_surface_fit_find(c->kind, c->focal_length_m, c->n, c->position_m, c->n_facet > 0 ? c->root_m : NULL, &fit,
                               &q->found));
    set_pose(c);
    if (fit.converged) refine(c);
    for (int i = 0; i < c->n; i++) {
        double arm[3], at[3], d[4];
        locate(c, i, arm, at);
        c->error_m[i] =
            fit.converged ? hf_cloud_error(c->kind, hf_cloud_power(c->along), q->curvature, at, d) : (double)NAN;
    }
    return HF_OK;
}

/* ---- derivatives ---- */

/* What point i adds to the derivatives of G by parameter k. */
static void pull_of(hf_cloud *c, const pose_slopes *s, const fitted_point *p, int i, int k)
{
    hf_cloud_pose *q = &c->pose;
    int angle = angle_of(q->found.quantity[k]);
    double by = dot4(p->d, p->by[k]), weight = weight_of(c, i), bent[3];
    for (int a = 0; a < 3; a++)
        bent[a] = p->d[a] * by + p->value * dot4(p->dd[a], p->by[k]);
    for (int d = 0; d < 3; d++) {
        double pull = 0;
        for (int a = 0; a < 3; a++) {
            pull += bent[a] * q->turn[a][d];
            if (angle >= 0) pull += p->value * p->d[a] * s->slope[angle][a][d];
        }
        q->pull[(3 * k + d) * c->n + i] = weight * pull;
        q->pull_center[k][d] += weight * (bent[d] - pull); /* a point is placed about the centre */
    }
    q->pull_area[k * c->n + i] = p->value * by;
}

hf_status hf_cloud_fit_linearise(hf_cloud *c)
{
    hf_cloud_pose *q = &c->pose;
    pose_slopes s = slopes_of(c);
    double G[N_MOST];
    HF_TRY(factor(c, &s, G));
    memset(q->pull_center, 0, sizeof q->pull_center);
    for (int i = 0; i < c->n; i++) {
        fitted_point p;
        double d[4];
        take_point(c, &s, i, &p);
        hf_cloud_error(c->kind, hf_cloud_power(c->along), q->curvature, p.at, d);
        for (int k = 0; k < q->found.n; k++) {
            pull_of(c, &s, &p, i, k);
            q->slope[k * c->n + i] = dot4(d, p.by[k]);
        }
        for (int k = 0; k < 3; k++) {
            double by = d[0] * q->turn[0][k] + d[1] * q->turn[1][k] + d[2] * q->turn[2][k];
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
