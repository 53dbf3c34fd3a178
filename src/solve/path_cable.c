/* Contents: the cone - scaling - direction - room */
#include "solve/path_cable.h"

#include <math.h>

/* ---- the cone ---- */

/* Root of the determinant a0^2 - |a1|^2 of a point in the cone; never zero. */
static double root_det(double a0, const double a1[3])
{
    double length = sqrt(hf_path_cable_dot(a1, a1)), det = (a0 - length) * (a0 + length);
    return sqrt(fmax(det, 1e-300));
}

/* b = W a */
static void scale(const hf_path_cable *p, double a0, const double a1[3], double *b0, double b1[3])
{
    double eta = sqrt(p->eta2), inner = hf_path_cable_dot(p->w1, a1), share = a0 + inner / (1 + p->w0);
    *b0 = eta * (p->w0 * a0 + inner);
    for (int c = 0; c < 3; c++)
        b1[c] = eta * (a1[c] + share * p->w1[c]);
}

/* b = W^-1 a */
static void unscale(const hf_path_cable *p, double a0, const double a1[3], double *b0, double b1[3])
{
    double eta = sqrt(p->eta2), inner = hf_path_cable_dot(p->w1, a1), share = inner / (1 + p->w0) - a0;
    *b0 = (p->w0 * a0 - inner) / eta;
    for (int c = 0; c < 3; c++)
        b1[c] = (a1[c] + share * p->w1[c]) / eta;
}

/* ---- scaling ---- */

void hf_path_cable_set_scaling(hf_path_cable *p, bool multiplier)
{
    double s = root_det(p->v, p->d), z = root_det(p->T, p->t);
    double s0 = p->v / s, z0 = p->T / z, s1[3], z1[3], inner = 0;
    for (int c = 0; c < 3; c++) {
        s1[c] = p->d[c] / s;
        z1[c] = -p->t[c] / z;
        inner += s1[c] * z1[c];
    }
    double gamma = sqrt((1 + s0 * z0 + inner) / 2), square = 0;
    p->eta2 = s / z;
    p->det = sqrt(s * z);
    p->w0 = (s0 + z0) / (2 * gamma);
    p->lambda0 = gamma * p->det;
    for (int c = 0; c < 3; c++) {
        p->w1[c] = (s1[c] - z1[c]) / (2 * gamma);
        p->lambda1[c] = p->det * ((gamma + z0) * s1[c] + (gamma + s0) * z1[c]) / (s0 + z0 + 2 * gamma);
        square += p->w1[c] * p->w1[c];
    }
    double A = 1 + 2 * square, size = sqrt(square), c = p->flex;
    p->across = 1 / p->eta2;
    p->along = multiplier ? (p->eta2 * A + c) / (p->eta2 * (p->eta2 + c * A)) : 1 / (p->eta2 * A);
    for (int k = 0; k < 3; k++)
        p->unit[k] = size > 0 ? p->w1[k] / size : 0;
}

/* ---- direction ---- */

void hf_path_cable_set_side(hf_path_cable *p, bool multiplier, double target, bool corrected)
{
    const double *l1 = p->lambda1;
    double l0 = p->lambda0, r0 = target * p->weight - l0 * l0 - hf_path_cable_dot(l1, l1), r1[3], q1[3], R1[3];
    for (int c = 0; c < 3; c++)
        r1[c] = -2 * l0 * l1[c];
    if (corrected) {
        r0 -= p->corrector0;
        for (int c = 0; c < 3; c++)
            r1[c] -= p->corrector1[c];
    }
    double q0 = (l0 * r0 - hf_path_cable_dot(l1, r1)) / (p->det * p->det); /* lambda o q = r */
    for (int c = 0; c < 3; c++)
        q1[c] = (r1[c] - q0 * l1[c]) / l0;
    scale(p, q0, q1, &p->R0, R1);
    double a = p->eta2 * (2 * p->w0 * p->w0 - 1), b = 2 * p->eta2 * p->w0;
    double share = multiplier ? b * (p->R0 - p->short_m) / (a + p->flex) : 0;
    for (int c = 0; c < 3; c++)
        p->off[c] = share * p->w1[c] - R1[c];
}

void hf_path_cable_set_direction(hf_path_cable *p, bool multiplier)
{
    double y[3];
    for (int c = 0; c < 3; c++)
        y[c] = p->Dd[c] + p->off[c];
    hf_path_cable_times_K(p, y, p->Dt);
    double a = p->eta2 * (2 * p->w0 * p->w0 - 1), turned = 2 * p->eta2 * p->w0 * hf_path_cable_dot(p->w1, p->Dt);
    p->DT = multiplier ? (p->R0 - p->short_m + turned) / (a + p->flex) : 0;
    p->Dv = multiplier ? p->flex * p->DT + p->short_m : p->R0 - a * p->DT + turned;
}

/* ---- room ---- */

/* How many times the scaled direction fits between the scaled point and the boundary of the cone, inverted: <= 0
 * without end. */
static double inverse_room(const hf_path_cable *p, double a0, const double a1[3])
{
    double l0 = p->lambda0 / p->det, l1[3], r1[3];
    for (int c = 0; c < 3; c++)
        l1[c] = p->lambda1[c] / p->det;
    double r0 = l0 * a0 - hf_path_cable_dot(l1, a1), share = (r0 + a0) / (l0 + 1);
    for (int c = 0; c < 3; c++)
        r1[c] = a1[c] - share * l1[c];
    return (sqrt(hf_path_cable_dot(r1, r1)) - r0) / p->det;
}

double hf_path_cable_inverse_room(hf_path_cable *p, bool corrects)
{
    double minus[3] = {-p->Dt[0], -p->Dt[1], -p->Dt[2]}, s0, s1[3], z0, z1[3];
    unscale(p, p->Dv, p->Dd, &s0, s1);
    scale(p, p->DT, minus, &z0, z1);
    if (corrects) {
        p->corrector0 = s0 * z0 + hf_path_cable_dot(s1, z1);
        for (int c = 0; c < 3; c++)
            p->corrector1[c] = s0 * z1[c] + z0 * s1[c];
    }
    return fmax(inverse_room(p, s0, s1), inverse_room(p, z0, z1));
}
