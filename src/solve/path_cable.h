/* path_cable - one cable on the primal-dual path (interior.h): its two cones, their common scaling, its part of a step.
 * Stability: internal; may change in any version.
 *
 * The points (v, d) and (T, -t) are in the cone |.| <= first. Directions are those of Nesterov and Todd (SIAM J. Optim.
 * 8, 1998), the second-order term is that of Mehrotra (SIAM J. Optim. 2, 1992), as in Andersen, Roos, Terlaky (Math.
 * Program. B 95, 2003). */
#ifndef HIFDM_PATH_CABLE_H
#define HIFDM_PATH_CABLE_H

#include <stdbool.h>

typedef struct {
    double v, T, t[3];                /* state */
    double T_before;                  /* T before the last step */
    double d[3];                      /* vector between the ends, m */
    double eta2, w0, w1[3];           /* scaling: W = eta (2 w w' - J)^(1/2), W^2 (T, -t) = (v, d) */
    double lambda0, lambda1[3], det;  /* W (T, -t) = W^-1 (v, d), and the root of its determinant */
    double along, across, unit[3];    /* K = across (I - uu') + along uu' */
    double flex, short_m;             /* c, and L + c T - v */
    double weight;                    /* of mu: tension times length, J */
    double R0, off[3];                /* of the right-hand side */
    double Dv, DT, Dt[3], Dd[3];      /* direction */
    double corrector0, corrector1[3]; /* second-order term */
} hf_path_cable;

static inline double hf_path_cable_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* b = K a */
static inline void hf_path_cable_times_K(const hf_path_cable *p, const double a[3], double b[3])
{
    double more = (p->along - p->across) * hf_path_cable_dot(p->unit, a);
    for (int c = 0; c < 3; c++)
        b[c] = p->across * a[c] + more * p->unit[c];
}

/* `multiplier` below: the law has one, so that T is free and v = L + flex T; else T is given and v is free. */

/* Set scaling and stiffness at the point v, d, T, t. */
void hf_path_cable_set_scaling(hf_path_cable *cable, bool multiplier);

/* Set R0 and off for the product `target`, over the weight, with the second-order terms if wanted. */
void hf_path_cable_set_side(hf_path_cable *cable, bool multiplier, double target, bool corrected);

/* Set DT, Dv and Dt for the change Dd of the vector between the ends. */
void hf_path_cable_set_direction(hf_path_cable *cable, bool multiplier);

/* 1 over the largest part of the direction that stays in both cones; <= 0 without end. With `corrects` the second-order
 * terms are set, too. */
double hf_path_cable_inverse_room(hf_path_cable *cable, bool corrects);

#endif
