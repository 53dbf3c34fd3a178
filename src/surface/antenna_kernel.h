/* antenna_kernel - currents and fields of the points of a shape, compiled once for each instruction set. All give the
 * same bits (base/lane.h). */
#pragma once

#include "base/lane.h"
#include <hifdm/pattern.h>

/* Sums over points with the current c, the position x along two directions in radians, and the phase as a complex unit
 * number E: real part, then imaginary part. */
typedef struct {
    double current[3][2]; /* of c E */
    double moment[6][2];  /* of (c . co) E times 1, x0, x1, x0 x0, x0 x1, x1 x1 */
} hf_antenna_sums;

/* The kernels of one instruction set. n is a multiple of HF_LANES; arrays are aligned to HF_ALIGNMENT.
 *
 * light: x [6][n] position and vector of area -> current [3][n], path_m [n]. sum: real and imaginary part of the sum of
 *        the currents along co in the direction of the beam of the feed, then the sum of their sizes.
 * look:  x, current, path_m -> sums in a direction. e: unit vectors across it. */
typedef struct {
    void (*light)(const hf_feed *feed, const double co[3], double wavelength_m, int n, const double *x, double *current,
                  double *path_m, double sum[3]);
    void (*look)(const double direction[3], double e[2][3], const double co[3], const double center_m[3],
                 double wavelength_m, int n, const double *x, const double *current, const double *path_m,
                 hf_antenna_sums *sums);
} hf_antenna_kernels;

extern const hf_antenna_kernels HF_LANE_EACH(hf_antenna_kernels);
