/* pattern_kernel - the sums of physical optics, several directions per vector, compiled once for each instruction set.
 * pattern.c chooses one at run time. All give the same bits (base/lane.h). */
#pragma once

#include "base/lane.h"

/* Members of a quadrature point, [HF_PATTERN_POINT][n_point]: position in wavelengths, relative to the middle of its
 * piece of facet (3); path minus the path to the middle, in wavelengths (1); current times its area (3). */
enum { HF_PATTERN_POINT = 7 };

/* The kernels of one instruction set.
 *
 * points: computes sum [6][n_angle], the sum over the points of J exp(j 2 pi (direction x - path)): real x y z, then
 *         imaginary x y z. direction [3][n_angle]. n_angle is a multiple of HF_LANES, and arrays are aligned to
 *         HF_ALIGNMENT.
 * spread: adds exp(j 2 pi (direction middle - path)) S to the array `to` [6][n_angle]. S is the sum over the nodes of
 *         between [n_node][n_angle] times local [6][n_node_padded]. If n_node is 0, S is local [6][n_angle] itself.
 *         middle [3] and path are in wavelengths. */
typedef struct {
    void (*points)(int n_point, const double *point, int n_angle, const double *direction, double *sum);
    void (*spread)(int n_node, int n_node_padded, const double *local, const double *between, const double middle[3],
                   double path, int n_angle, const double *direction, double *to);
} hf_pattern_kernels;

extern const hf_pattern_kernels HF_LANE_EACH(hf_pattern_kernels);
