/* The two loops of chord that do all the work, over HF_LANES designs side by side. Multiplications and additions are never
 * fused and every lane keeps its own order of operations, so all instruction sets give the same bits. */
#include "chord_kernel.h"

typedef double lanes __attribute__((vector_size(HF_LANES * sizeof(double))));

/* sqrt has no vector form in C; a loop over the lanes becomes one instruction */
static inline void square_root(lanes *value)
{
    for (int k = 0; k < HF_LANES; k++)
        (*value)[k] = __builtin_sqrt((*value)[k]);
}

void HF_KERNEL(hf_chord_forces)(const hf_chord *chord, const hf_chord_lanes *l, double residual_squared[HF_LANES])
{
    const hf_model *m = chord->evaluator->model;
    const lanes *x = (const lanes *)(const void *)l->x_m, *y = x + m->n_node, *z = y + m->n_node;
    const lanes *gene = (const lanes *)(const void *)l->gene;
    lanes *force = (lanes *)(void *)l->force_N + chord->width;
    int tension_rule = chord->evaluator->rule == HF_RULE_TENSION;
    for (int i = 0; i < m->n_free; i++)
        for (int c = 0; c < 3; c++) {
            double load = m->load_N ? m->load_N[c * m->n_node + i] : 0;
            force[3 * i + c] = (lanes){0} + load;
        }
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1], k = chord->gene_of_cable[e];
        lanes dx = x[b] - x[a], dy = y[b] - y[a], dz = z[b] - z[a], q;
        if (k >= 0 && !tension_rule) {
            q = gene[k];
        } else if (k < 0 && m->law[e] == HF_LAW_FORCE_DENSITY) {
            q = (lanes){0} + m->target[e];
        } else {
            lanes length = dx * dx + dy * dy + dz * dz;
            square_root(&length);
            q = (k >= 0 ? gene[k] : (lanes){0} + m->target[e]) / length;
        }
        dx *= q, dy *= q, dz *= q;
        if (a < m->n_free) force[3 * a] += dx, force[3 * a + 1] += dy, force[3 * a + 2] += dz;
        if (b < m->n_free) force[3 * b] -= dx, force[3 * b + 1] -= dy, force[3 * b + 2] -= dz;
    }
    lanes largest = {0};
    for (int i = 0; i < m->n_free; i++) {
        const lanes *f = force + 3 * i;
        lanes square = f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
        for (int k = 0; k < HF_LANES; k++)
            largest[k] = square[k] <= largest[k] ? largest[k] : square[k]; /* keeps a NaN */
    }
    for (int k = 0; k < HF_LANES; k++)
        residual_squared[k] = largest[k];
}

/* Four rows at a time: the rows share the loads of what is already solved. The packed rows hold `width` entries, zeros
 * first where the band is shorter, and the right-hand side has `width` zero rows in front and behind. */
static void forward(const hf_chord *chord, lanes *f)
{
    int w = chord->width;
    for (int j = 0; j < chord->n_dof; j += 4) {
        int n_row = chord->n_dof - j < 4 ? chord->n_dof - j : 4;
        const double *r0 = chord->row + (size_t)j * (size_t)w, *r1 = r0 + w, *r2 = r1 + w, *r3 = r2 + w;
        lanes s0 = f[j], s1 = f[j + 1], s2 = f[j + 2], s3 = f[j + 3];
        /* row j + p holds the columns j + p - w .. j + p - 1; the shared ones are j + 3 - w .. j - 1 */
        for (int p = 0; p < n_row; p++) {
            const double *r = chord->row + (size_t)(j + p) * (size_t)w;
            lanes *s = p == 0 ? &s0 : p == 1 ? &s1 : p == 2 ? &s2 : &s3;
            for (int i = 0; i < 3 - p; i++)
                *s -= r[i] * f[j + p - w + i];
        }
        for (int i = 0; i + 3 < w; i++) {
            lanes y = f[j + 3 - w + i];
            s0 -= r0[3 + i] * y;
            s1 -= r1[2 + i] * y;
            s2 -= r2[1 + i] * y;
            s3 -= r3[i] * y;
        }
        const double *d = chord->inverse_diagonal + j;
        f[j] = s0 *= d[0];
        if (n_row > 1) f[j + 1] = s1 = (s1 - r1[w - 1] * s0) * d[1];
        if (n_row > 2) f[j + 2] = s2 = (s2 - r2[w - 2] * s0 - r2[w - 1] * s1) * d[2];
        if (n_row > 3) f[j + 3] = (s3 - r3[w - 3] * s0 - r3[w - 2] * s1 - r3[w - 1] * s2) * d[3];
    }
}

/* The same from below with the columns: column j holds the rows j + 1 .. j + w. */
static void backward(const hf_chord *chord, lanes *f)
{
    int w = chord->width;
    for (int top = (chord->n_dof - 1) / 4 * 4; top >= 0; top -= 4) {
        int n_row = chord->n_dof - top < 4 ? chord->n_dof - top : 4;
        for (int p = n_row - 1; p >= 0; p--) {
            /* two sums, even and odd entries, to keep the adders busy */
            const double *c = chord->column + (size_t)(top + p) * (size_t)w;
            const lanes *below = f + top + p + 1;
            lanes even = f[top + p], odd = {0};
            for (int i = 0; i < w; i += 2) {
                even -= c[i] * below[i];
                odd += c[i + 1] * below[i + 1];
            }
            f[top + p] = (even - odd) * chord->inverse_diagonal[top + p];
        }
    }
}

void HF_KERNEL(hf_chord_solve)(const hf_chord *chord, const hf_chord_lanes *l)
{
    lanes *force = (lanes *)(void *)l->force_N + chord->width;
    forward(chord, force);
    backward(chord, force);
}

void HF_KERNEL(hf_chord_step)(const hf_chord *chord, const hf_chord_lanes *l)
{
    const hf_model *m = chord->evaluator->model;
    lanes *x = (lanes *)(void *)l->x_m;
    const lanes *step = (const lanes *)(const void *)l->force_N + chord->width;
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < m->n_free; i++)
            x[c * m->n_node + i] += step[3 * i + c];
}
