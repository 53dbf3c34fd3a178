/* The kernels of antenna, compiled once for each instruction set.
 *
 *     light    points -> direction and path from the feed, field -> current 2 n x H -> sum with the phases
 *     look     points, currents -> sums of currents and of their first and second moments with the phases
 *
 * Sums run in eight lanes, which are added at the end in a fixed order. */
#define HF_LANE_VECTORS
#include "surface/antenna_kernel.h"

#include "base/elementary.h"

#include <string.h>

enum { N_SUM = sizeof(hf_antenna_sums) / sizeof(double) };

INLINE vec dot(const vec a[3], const double b[3])
{
    return plus_product(plus_product(a[0] * b[0], a[1], splat(b[1])), a[2], splat(b[2]));
}

INLINE void cross(const vec a[3], const vec b[3], vec to[3])
{
    foreach (d, 3) {
        int i = (d + 1) % 3, j = (d + 2) % 3;
        to[d] = less_product(a[i] * b[j], a[j], b[i]);
    }
}

static double add_lanes(const double lane[HF_LANES])
{
    double sum = 0;
    for (int k = 0; k < HF_LANES; k++)
        sum += lane[k];
    return sum;
}

/* Computes the field of the feed at p as hf_feed_light does. Returns the path. */
INLINE vec feed_field(const hf_feed *f, const vec p[3], vec t[3], vec field[3])
{
    vec along[3], size = splat(1), path;
    if (f->kind == HF_FEED_PLANE_WAVE) {
        foreach (d, 3)
            t[d] = splat(f->axis[d]);
        path = dot(p, f->axis);
    } else {
        foreach (d, 3)
            t[d] = p[d] - f->position_m[d];
        if (f->kind == HF_FEED_LINE) t[1] = splat(0);
        path = root(norm_squared(t[0], t[1], t[2]));
        foreach (d, 3)
            t[d] /= path;
        size = power(dot(t, f->axis), f->cos_power) / (f->kind == HF_FEED_LINE ? root(path) : path);
    }
    if (f->kind == HF_FEED_LINE) { /* along y, or t x y */
        bool is_along = f->co[1] != 0;
        along[0] = is_along ? splat(0) : -t[2];
        along[1] = splat(is_along);
        along[2] = is_along ? splat(0) : t[0];
    } else {
        vec twist = dot(t, f->co) / (1 + dot(t, f->axis));
        foreach (d, 3)
            along[d] = less_product(splat(f->co[d]), twist, f->axis[d] + t[d]);
    }
    cross(t, along, field);
    foreach (d, 3)
        field[d] =
            if_greater(size, splat(0), size * field[d], splat(0)); /* behind the feed, there may be no direction */
    return path;
}

static void light(const hf_feed *feed, const double co[3], double wavelength_m, int n, const double *x, double *current,
                  double *path_m, double sum[3])
{
    _Alignas(64) double lane[3][HF_LANES] = {{0}};
    const double per_m = 1 / wavelength_m;
    for (ptrdiff_t i = 0; i < n; i += WIDTH) {
        vec p[3], up[3], t[3], field[3], c[3], cosine, sine;
        foreach (d, 3) {
            p[d] = *(const vec *)(const void *)(x + d * (ptrdiff_t)n + i);
            up[d] = *(const vec *)(const void *)(x + (3 + d) * (ptrdiff_t)n + i);
        }
        vec path = feed_field(feed, p, t, field);
        vec facing = plus_product(plus_product(t[0] * up[0], t[1], up[1]), t[2], up[2]);
        vec lit = if_greater(splat(0), facing, splat(2), splat(0));
        cross(up, field, c);
        foreach (d, 3) {
            c[d] *= lit;
            *(vec *)(void *)(current + d * (ptrdiff_t)n + i) = c[d];
        }
        *(vec *)(void *)(path_m + i) = path;
        turn(per_m * (dot(p, feed->beam) - path), &cosine, &sine);
        vec size = dot(c, co);
        *lanes_of(lane[0], 0, (int)(i % HF_LANES)) += size * cosine;
        *lanes_of(lane[1], 0, (int)(i % HF_LANES)) += size * sine;
        *lanes_of(lane[2], 0, (int)(i % HF_LANES)) += magnitude(size);
    }
    foreach (k, 3)
        sum[k] = add_lanes(lane[k]);
}

static void look(const double direction[3], double e[2][3], const double co[3], const double center_m[3],
                 double wavelength_m, int n, const double *x, const double *current, const double *path_m,
                 hf_antenna_sums *sums)
{
    _Alignas(64) double lane[N_SUM][HF_LANES] = {{0}};
    const double per_m = 1 / wavelength_m, wave = 2 * HF_PI * per_m;
    double sum[N_SUM] = {0};
    for (int part = 0; part < HF_LANES; part += WIDTH) {
        vec total[N_SUM];
        foreach (k, N_SUM)
            total[k] = splat(0);
        for (ptrdiff_t i = part; i < n; i += HF_LANES) {
            vec p[3], c[3], turned[2];
            foreach (d, 3) {
                p[d] = *(const vec *)(const void *)(x + d * (ptrdiff_t)n + i) - center_m[d];
                c[d] = *(const vec *)(const void *)(current + d * (ptrdiff_t)n + i);
            }
            turn(per_m * (dot(p, direction) - *(const vec *)(const void *)(path_m + i)), &turned[0], &turned[1]);
            vec size = dot(c, co), u = wave * dot(p, e[0]), v = wave * dot(p, e[1]);
            const vec su = size * u, sv = size * v;
            const vec part_of[9] = {c[0], c[1], c[2], size, su, sv, su * u, su * v, sv * v};
            foreach (k, 9)
                foreach (r, 2)
                    total[2 * k + r] = plus_product(total[2 * k + r], part_of[k], turned[r]);
        }
        foreach (k, N_SUM)
            *lanes_of(lane[k], 0, part) = total[k];
    }
    for (int k = 0; k < N_SUM; k++)
        sum[k] = add_lanes(lane[k]);
    memcpy(sums, sum, sizeof sum);
}

const hf_antenna_kernels HF_KERNEL(hf_antenna_kernels) = {light, look};
