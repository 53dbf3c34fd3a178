/* The kernels of pattern, compiled once for each instruction set.
 *
 *     points   quadrature points of a piece of facet, directions
 *                -> for each direction: phase in turns -> cosine and sine -> sum of current times phase
 *                -> local sums [6][n_angle], with phases relative to the middle of the piece
 *     spread   local sums at the nodes -> interpolate to all angles -> multiply by the phase of the middle
 *                -> add to the sums of the block */
#define HF_LANE_VECTORS
#include "surface/pattern_kernel.h"

#include <stddef.h>

INLINE vec at(const double *array, ptrdiff_t i)
{
    return *(const vec *)(const void *)(array + i);
}

INLINE void set(double *array, ptrdiff_t i, vec value)
{
    *(vec *)(void *)(array + i) = value;
}

static void points(int n_point, const double *point, int n_angle, const double *direction, double *sum)
{
    for (ptrdiff_t a = 0; a < n_angle; a += WIDTH) {
        vec d[3], total[6];
        foreach (k, 3)
            d[k] = at(direction, k * (ptrdiff_t)n_angle + a);
        foreach (k, 6)
            total[k] = splat(0);
        for (ptrdiff_t i = 0; i < n_point; i++) {
            const double *p = point + i;
            vec turns = -splat(p[3 * (ptrdiff_t)n_point]), cosine, sine;
            foreach (k, 3)
                turns = plus_product(turns, d[k], splat(p[k * (ptrdiff_t)n_point]));
            turn(turns, &cosine, &sine);
            foreach (k, 3) {
                vec current = splat(p[(4 + k) * (ptrdiff_t)n_point]);
                total[k] = plus_product(total[k], current, cosine);
                total[3 + k] = plus_product(total[3 + k], current, sine);
            }
        }
        foreach (k, 6)
            set(sum, k * (ptrdiff_t)n_angle + a, total[k]);
    }
}

static void spread(int n_node, int n_node_padded, const double *local, const double *between, const double middle[3],
                   double path, int n_angle, const double *direction, double *to)
{
    for (ptrdiff_t a = 0; a < n_angle; a += WIDTH) {
        vec total[6], turns = -splat(path), cosine, sine;
        foreach (k, 6)
            total[k] = n_node ? splat(0) : at(local, k * (ptrdiff_t)n_angle + a);
        for (ptrdiff_t i = 0; i < n_node; i++) {
            vec part = at(between, i * n_angle + a);
            foreach (k, 6)
                total[k] = plus_product(total[k], part, splat(local[k * (ptrdiff_t)n_node_padded + i]));
        }
        foreach (k, 3)
            turns = plus_product(turns, at(direction, k * (ptrdiff_t)n_angle + a), splat(middle[k]));
        turn(turns, &cosine, &sine);
        foreach (k, 3) {
            double *real = to + k * (ptrdiff_t)n_angle + a, *imaginary = real + 3 * (ptrdiff_t)n_angle;
            vec re = less_product(total[k] * cosine, total[3 + k], sine);
            vec im = plus_product(total[k] * sine, total[3 + k], cosine);
            set(real, 0, at(real, 0) + re);
            set(imaginary, 0, at(imaginary, 0) + im);
        }
    }
}

const hf_pattern_kernels HF_KERNEL(hf_pattern_kernels) = {points, spread};
