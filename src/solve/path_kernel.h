/* path_kernel - the cables on the primal-dual path (interior.h), HF_LANES side by side: their two cones, the common
 * scaling, and their part of a step.
 * Stability: internal; may change in any version.
 *
 * The points (v, d) and (T, -t) are in the cone |.| <= first. Directions are those of Nesterov and Todd (SIAM J. Optim.
 * 8, 1998), the second-order term is that of Mehrotra (SIAM J. Optim. 2, 1992), as in Andersen, Roos, Terlaky (Math.
 * Program. B 95, 2003). The kernels are compiled once for each instruction set. All instruction sets give the same
 * bits, because no operation mixes cables and none is fused. */
#pragma once

#include "base/lane.h"

/* Cables 8 k to 8 k + 7. has_cone is 0 for cables between supports or of law force_density, and in the lanes after the
 * last cable. Their v, T, along and across do not change. */
typedef struct {
    double has_cone[HF_LANES];                       /* 1 or 0 */
    double has_multiplier[HF_LANES];                 /* 1: T is free and v = L + c T; 0: T is given, v is free */
    double target[HF_LANES], EA[HF_LANES];           /* L + c T = target + target T / EA */
    double theoretical[HF_LANES];                    /* length at the target positions, m */
    double v[HF_LANES], T[HF_LANES], t[3][HF_LANES]; /* point of the path: m, N, N */
    double T_before[HF_LANES];                       /* T before the last step */
    double d[3][HF_LANES];                           /* vector between the ends, m */
    double eta2[HF_LANES], w0[HF_LANES],
        w1[3][HF_LANES];                            /* scaling by W = eta (2 w w' - J)^(1/2), W^2 (T, -t) = (v, d) */
    double lambda0[HF_LANES], lambda1[3][HF_LANES]; /* the scaled point W (T, -t) = W^-1 (v, d) */
    double det[HF_LANES];                           /* root of the determinant of the scaled point */
    double along[HF_LANES], across[HF_LANES], unit[3][HF_LANES];         /* K = across (I - uu') + along uu' */
    double flex[HF_LANES], short_m[HF_LANES];                            /* c, m/N, and L + c T - v, m */
    double weight[HF_LANES];                                             /* weight of mu: tension times length, J */
    double gap[HF_LANES];                                                /* T v - t.d, J */
    double R0[HF_LANES], off[3][HF_LANES], pull[3][HF_LANES];            /* right-hand side; pull = K off */
    double Dv[HF_LANES], DT[HF_LANES], Dt[3][HF_LANES], Dd[3][HF_LANES]; /* direction */
    double corrector0[HF_LANES], corrector1[3][HF_LANES];                /* second-order term */
} hf_path_cables;

/* The kernels of one instruction set.
 *
 * measure:       sets gap and short_m, and t of cables of law force_density. Returns the maximum error of length over
 *                the length at the target positions.
 * set_scaling:   sets scaling and stiffness at the point v, d, T, t.
 * set_side:      sets R0, off and pull for the product `target` times the weight. With `corrected` it includes the
 *                second-order terms.
 * set_direction: sets DT, Dv and Dt for the changes Dd of the vectors between the ends. With `corrects` it sets the
 *                second-order terms. Returns the reciprocal of the maximum part of the direction that stays in all
 *                cones, or 0 if every part does.
 * move:          moves the point by this part of the direction. */
typedef struct {
    double (*measure)(int n_block, hf_path_cables *block);
    void (*set_scaling)(int n_block, hf_path_cables *block);
    void (*set_side)(int n_block, hf_path_cables *block, double target, bool corrected);
    double (*set_direction)(int n_block, hf_path_cables *block, bool corrects);
    void (*move)(int n_block, hf_path_cables *block, double part);
} hf_path_kernels;

extern const hf_path_kernels HF_LANE_EACH(hf_path_kernels);
