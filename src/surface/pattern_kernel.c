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

/* Computes cosine and sine of an angle in turns, below 2^51; the error is below 6e-16. Whole turns are subtracted
 * exactly, which leaves -1/2 to 1/2. Series give cosine and sine of half of the angle, and then its double follows. */
INLINE void turn(vec turns, vec *cosine, vec *sine)
{
    static const double s[] = {-2.2948428997269873e-08, 7.952054001475513e-07,  -2.1915353447830217e-05,
                               0.00046630280576761255,  -0.0073704309457143504, 0.08214588661112823,
                               -0.5992645293207921,     2.5501640398773455,     -5.16771278004997,
                               3.141592653589793};
    static const double c[] = {3.604730797462501e-09,
                               -1.3878952462213771e-07,
                               4.303069587032947e-06,
                               -0.0001046381049248457,
                               0.0019295743094039231,
                               -0.02580689139001406,
                               0.2353306303588932,
                               -1.3352627688545895,
                               4.0587121264167685,
                               -4.934802200544679,
                               1.0};
    vec whole = (turns + 0x1.8p52) - 0x1.8p52, r = turns - whole, square = r * r, half = splat(s[0]),
        other = splat(c[0]);
    foreach (k, 9)
        half = plus_product(splat(s[k + 1]), half, square);
    foreach (k, 10)
        other = plus_product(splat(c[k + 1]), other, square);
    half *= r;
    vec twice = half + half;
    *sine = twice * other;
    *cosine = less_product(splat(1), twice, half);
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
