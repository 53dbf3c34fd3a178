/* path_cable - the cables on the primal-dual path (interior.h), HF_LANES side by side: their two cones, their common
 * scaling, their part of a step.
 * Stability: internal; may change in any version.
 *
 * The points (v, d) and (T, -t) are in the cone |.| <= first. Directions are those of Nesterov and Todd (SIAM J. Optim.
 * 8, 1998), the second-order term is that of Mehrotra (SIAM J. Optim. 2, 1992), as in Andersen, Roos, Terlaky (Math.
 * Program. B 95, 2003). All instruction sets give the same bits: no operation mixes cables, and none is fused. */
#ifndef HIFDM_PATH_CABLE_H
#define HIFDM_PATH_CABLE_H

#include "base/lane.h"

#include <stdbool.h>

/* Cables 8 k to 8 k + 7. Those without a cone (between supports, or of law force_density) and the places after the last
 * cable have 0 in has_cone; their v, T, along and across stay as they are. */
typedef struct {
    double has_cone[HF_LANES];                       /* 1 or 0 */
    double has_multiplier[HF_LANES];                 /* 1: T is free and v = L + c T; 0: T is given and v is free */
    double target[HF_LANES], EA[HF_LANES];           /* L + c T = target + target T / EA */
    double theoretical[HF_LANES];                    /* length, m */
    double v[HF_LANES], T[HF_LANES], t[3][HF_LANES]; /* state */
    double T_before[HF_LANES];                       /* T before the last step */
    double d[3][HF_LANES];                           /* vector between the ends, m */
    double eta2[HF_LANES], w0[HF_LANES],
        w1[3][HF_LANES];                            /* scaling: W = eta (2 w w' - J)^(1/2), W^2 (T, -t) = (v, d) */
    double lambda0[HF_LANES], lambda1[3][HF_LANES]; /* W (T, -t) = W^-1 (v, d) ... */
    double det[HF_LANES];                           /* ... and the root of its determinant */
    double along[HF_LANES], across[HF_LANES], unit[3][HF_LANES];         /* K = across (I - uu') + along uu' */
    double flex[HF_LANES], short_m[HF_LANES];                            /* c, and L + c T - v */
    double weight[HF_LANES];                                             /* of mu: tension times length, J */
    double gap[HF_LANES];                                                /* T v - t.d, J */
    double R0[HF_LANES], off[3][HF_LANES], pull[3][HF_LANES];            /* of the right-hand side; pull = K off */
    double Dv[HF_LANES], DT[HF_LANES], Dt[3][HF_LANES], Dd[3][HF_LANES]; /* direction */
    double corrector0[HF_LANES], corrector1[3][HF_LANES];                /* second-order term */
} hf_path_cables;

/* Set t of cables of law force_density; gap and short_m. Returns the largest error of length over theoretical length.
 */
double hf_path_measure(int n_block, hf_path_cables *block);

/* Set scaling and stiffness at the point v, d, T, t. */
void hf_path_set_scaling(int n_block, hf_path_cables *block);

/* Set R0, off and pull for the product `target`, over the weight, with the second-order terms if wanted. */
void hf_path_set_side(int n_block, hf_path_cables *block, double target, bool corrected);

/* Set DT, Dv and Dt for the changes Dd of the vectors between the ends. Returns 1 over the largest part of the
 * direction that stays in all cones; 0 without end. With `corrects` the second-order terms are set, too. */
double hf_path_set_direction(int n_block, hf_path_cables *block, bool corrects);

/* Go this part of the direction. */
void hf_path_move(int n_block, hf_path_cables *block, double part);

#endif
