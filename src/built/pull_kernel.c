/* Kernels of as-built nets in lanes. HF_LANES nets stand side by side in the last index of each array:
 *
 *     hf_pull_find      positions [3][n_node] ---> lengths l ---> T = max(EA/l0 (l - l0), 0), q = T/l   [n_cable]
 *     hf_pull_multiply  A [n][n] in blocks of HF_PULL_ROWS rows, in [n] ---> out = A in                [n] */
#define HF_LANE_VECTORS
#include "built/pull_kernel.h"

#include <stddef.h>

INLINE vec lanes_at(const double *array, ptrdiff_t row, int p)
{
    return *(const vec *)(const void *)(array + row * HF_LANES + p);
}

INLINE void set_lanes(double *array, ptrdiff_t row, int p, vec value)
{
    *(vec *)(void *)(array + row * HF_LANES + p) = value;
}

void HF_KERNEL(hf_pull_find)(const hf_model *m, const double *x_m, const double *cut_m, const double *stiffness_N_per_m,
                             double *tension_N, double *q_N_per_m)
{
    for (int e = 0; e < m->n_cable; e++)
        for (int p = 0; p < HF_LANES; p += WIDTH) {
            vec d[3], none = splat(0);
            foreach (c, 3) {
                ptrdiff_t first = (ptrdiff_t)c * m->n_node;
                d[c] = lanes_at(x_m, first + m->end_row[2 * e + 1], p) - lanes_at(x_m, first + m->end_row[2 * e], p);
            }
            vec length = root(norm_squared(d[0], d[1], d[2]));
            vec over = length - lanes_at(cut_m, e, p);
            vec tension = if_greater(over, none, lanes_at(stiffness_N_per_m, e, p) * over, none);
            set_lanes(tension_N, e, p, tension);
            set_lanes(q_N_per_m, e, p, if_greater(tension, none, tension / length, none));
        }
}

void HF_KERNEL(hf_pull_multiply)(int n, const double *packed, const double *in, double *out)
{
    for (int i = 0; i < n; i += HF_PULL_ROWS, packed += (ptrdiff_t)n * HF_PULL_ROWS)
        for (int p = 0; p < HF_LANES; p += WIDTH) {
            vec sum[HF_PULL_ROWS];
            foreach (r, HF_PULL_ROWS)
                sum[r] = splat(0);
            for (int j = 0; j < n; j++) {
                vec x = lanes_at(in, j, p);
                foreach (r, HF_PULL_ROWS)
                    sum[r] = plus_product(sum[r], splat(packed[j * HF_PULL_ROWS + r]), x);
            }
            foreach (r, HF_PULL_ROWS)
                set_lanes(out, i + r, p, sum[r]);
        }
}
