/* pattern_kernel - the sums of physical optics, eight directions side by side; compiled once for each instruction set.
 */
#ifndef HIFDM_PATTERN_KERNEL_H
#define HIFDM_PATTERN_KERNEL_H

#include "base/lane.h"

/* Members of a point of quadrature, [HF_PATTERN_POINT][n_point]: place in wavelengths from the middle of its facet, how
 * much longer the path to it is than to there, the current times its area. */
enum { HF_PATTERN_POINT = 7 };

/* sum [6][n_angle] = sum over the points of J exp(j 2 pi (direction x - path)), real x y z, then imaginary x y z, by
 * direction [3][n_angle]; n_angle is a multiple of HF_LANES, arrays of it are aligned to HF_ALIGNMENT. */
typedef void hf_pattern_points(int n_point, const double *point, int n_angle, const double *direction, double *sum);

/* to [6][n_angle] += exp(j 2 pi (direction middle - path)) sum over the nodes of between [n_node][n_angle] times local
 * [6][n_node_padded]; n_node 0: of local [6][n_angle] itself. middle [3], path in wavelengths. */
typedef void hf_pattern_spread(int n_node, int n_node_padded, const double *local, const double *between,
                               const double middle[3], double path, int n_angle, const double *direction, double *to);

/* The Makefile compiles pattern_kernel.c with -DHF_ISA=avx512 and so on; the names end in it. */
hf_pattern_points hf_pattern_points_portable, hf_pattern_points_avx2, hf_pattern_points_avx512;
hf_pattern_spread hf_pattern_spread_portable, hf_pattern_spread_avx2, hf_pattern_spread_avx512;

#endif
