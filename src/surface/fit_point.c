/* Computes the points of a best fit and their derivatives by its parameters:
 *
 *     parameters -> frame: shift, rotation and its derivatives, curvature
 *       -> each point: position in the frame, half-path error, first and second derivatives
 *       -> sum of squares, gradient G, Hessian H
 *
 * Contents: the frame - one point - the sum of squares */
#include "surface/fit_point.h"

#include "net/target_surface.h"
#include "surface/cloud.h"

#include <string.h>

enum { N_MOST = HF_FIT_N_PARAMETER };

/* ---- the frame ---- */

static void multiply_vector(const double m[3][3], const double v[3], double to[3])
{
    for (int k = 0; k < 3; k++)
        to[k] = m[k][0] * v[0] + m[k][1] * v[1] + m[k][2] * v[2];
}

/* Returns the component that a shift stands for, or -1. */
static int shift_of(int quantity)
{
    return quantity == HF_FIT_SHIFT_X ? 0 : quantity == HF_FIT_SHIFT_Y ? 1 : quantity == HF_FIT_SHIFT_Z ? 2 : -1;
}

hf_fit_frame hf_fit_frame_of(hf_surface_kind kind, double focal_length_m, int n, const double *position_m,
                             const double *root_weight, const hf_fit_parameters *found)
{
    const double *value = found->value, *angle = value + HF_FIT_TURN_X;
    hf_fit_frame f = {.kind = kind, .n = n, .position_m = position_m, .root_weight = root_weight, .found = found};
    f.wanted_per_m = 1 / (4 * focal_length_m);
    f.curvature_per_m = (1 + value[HF_FIT_CURVE]) / (4 * focal_length_m);
    f.shift_m[0] = found->size_m * value[HF_FIT_SHIFT_X];
    f.shift_m[1] = found->size_m * value[HF_FIT_SHIFT_Y];
    f.shift_m[2] = found->size_m * value[HF_FIT_SHIFT_Z];
    hf_fit_rotation(angle, (const int[3]){0}, f.turn);
    for (int a = 0; a < 3; a++)
        hf_fit_rotation(angle, (const int[3]){a == 0, a == 1, a == 2}, f.slope[a]);
    for (int shift = 0; shift < 3; shift++)
        for (int d = 0; d < 3; d++)
            f.by_shift[shift][d] = -found->size_m * f.turn[d][shift];
    return f;
}

/* ---- one point ---- */

void hf_fit_locate(const hf_fit_frame *f, int i, double arm[3], double at[3])
{
    for (int d = 0; d < 3; d++)
        arm[d] = f->position_m[d * f->n + i] - f->found->center_m[d] - f->shift_m[d];
    multiply_vector(f->turn, arm, at);
    for (int d = 0; d < 3; d++)
        at[d] += f->found->center_m[d];
}

double hf_fit_weight(const hf_fit_frame *f, int i)
{
    return f->root_weight ? f->root_weight[i] * f->root_weight[i] : 1;
}

/* Computes the second derivatives of the half-path error u / D, with D = 1 + t^2. */
static void bend_error(hf_surface_kind kind, double curvature, hf_fit_point *p)
{
    double t[2], u = hf_target_surface_height_above(kind, curvature, p->at, t), D = 1 + t[0] * t[0] + t[1] * t[1];
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

void hf_fit_derive(const hf_fit_frame *f, const double arm[3], double by[HF_FIT_N_PARAMETER][4])
{
    for (int k = 0; k < f->found->n; k++) {
        int shift = shift_of(f->found->quantity[k]), angle = hf_fit_angle_of(f->found->quantity[k]);
        by[k][3] = shift < 0 && angle < 0 ? f->wanted_per_m : 0;
        if (angle >= 0)
            multiply_vector(f->slope[angle], arm, by[k]);
        else if (shift >= 0)
            memcpy(by[k], f->by_shift[shift], sizeof f->by_shift[shift]);
        else
            memset(by[k], 0, 3 * sizeof by[k][0]);
    }
}

hf_fit_point hf_fit_point_take(const hf_fit_frame *f, int i)
{
    hf_fit_point p = {0};
    hf_fit_locate(f, i, p.arm, p.at);
    p.value = hf_cloud_error(f->kind, 1, f->curvature_per_m, p.at, p.d);
    bend_error(f->kind, f->curvature_per_m, &p);
    hf_fit_derive(f, p.arm, p.by);
    return p;
}

/* Computes the second derivative of the coordinates by parameters j and k. bend: second derivatives of the rotation. */
static void bend_position(const hf_fit_frame *f, double bend[3][3][3][3], const hf_fit_point *p, int j, int k,
                          double to[4])
{
    const int *quantity = f->found->quantity;
    int a = hf_fit_angle_of(quantity[j]), b = hf_fit_angle_of(quantity[k]), shift = shift_of(quantity[a < 0 ? j : k]);
    memset(to, 0, 4 * sizeof *to);
    if (a >= 0 && b >= 0) multiply_vector(bend[a][b], p->arm, to);
    if ((a >= 0) == (b >= 0) || shift < 0) return;
    for (int d = 0; d < 3; d++)
        to[d] = -f->found->size_m * f->slope[a < 0 ? b : a][d][shift];
}

/* ---- the sum of squares ---- */

double hf_fit_hessian(const hf_fit_frame *f, double *G, double *H)
{
    int n = f->found->n;
    double sum = 0, turn[3][3][3][3];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            const int order[3] = {(a == 0) + (b == 0), (a == 1) + (b == 1), (a == 2) + (b == 2)};
            hf_fit_rotation(f->found->value + HF_FIT_TURN_X, order, turn[a][b]);
        }
    memset(H, 0, (size_t)(n * n) * sizeof *H);
    memset(G, 0, (size_t)n * sizeof *G);
    for (int i = 0; i < f->n; i++) {
        double by[N_MOST], bend[4], weight = hf_fit_weight(f, i);
        hf_fit_point p = hf_fit_point_take(f, i);
        sum += weight * p.value * p.value;
        for (int k = 0; k < n; k++)
            by[k] = hf_fit_dot(p.d, p.by[k]);
        for (int k = 0; k < n; k++) {
            double turned[4]; /* dd times the derivative of the coordinates */
            G[k] += weight * p.value * by[k];
            for (int a = 0; a < 4; a++)
                turned[a] = hf_fit_dot(p.dd[a], p.by[k]);
            for (int j = 0; j <= k; j++) {
                bend_position(f, turn, &p, j, k, bend);
                H[k * n + j] +=
                    weight * (by[j] * by[k] + p.value * (hf_fit_dot(turned, p.by[j]) + hf_fit_dot(p.d, bend)));
            }
        }
    }
    for (int k = 0; k < n; k++)
        for (int j = 0; j < k; j++)
            H[j * n + k] = H[k * n + j];
    return sum / 2;
}
