/* The inner loops of chord, over HF_LANES designs side by side. Multiplications and additions are never fused, and the
 * order of the operations in a lane is always the same, so all instruction sets give the same bits. */
#include "search/chord_kernel.h"

typedef double lanes __attribute__((vector_size(HF_LANES * sizeof(double))));

/* sqrt has no vector form in C; a loop over the lanes becomes one instruction */
static inline void square_root(lanes *value)
{
    for (int k = 0; k < HF_LANES; k++)
        (*value)[k] = __builtin_sqrt((*value)[k]);
}

/* with_truss is a constant where this is inlined */
static inline __attribute__((always_inline)) void forces(const hf_chord *chord, const hf_chord_lanes *l,
                                                         bool with_truss, double residual_squared[HF_LANES])
{
    const hf_model *m = chord->evaluator->model;
    const lanes *x = (const lanes *)(const void *)l->x_m, *y = x + m->n_node, *z = y + m->n_node;
    const lanes *gene = (const lanes *)(const void *)l->gene;
    lanes *force = (lanes *)(void *)l->force_N + chord->width, *pull = (lanes *)(void *)l->pull_N;
    const lanes zero = {0};
    int tension_rule = chord->evaluator->rule == HF_RULE_TENSION;
    for (int i = 0; i < m->n_free; i++)
        for (int c = 0; c < 3; c++) {
            double load = m->load_N ? m->load_N[c * m->n_node + i] : 0;
            force[3 * i + c] = zero + load;
        }
    /* the rows after the last: a lane that failed may have left NaNs there */
    for (int i = chord->n_dof; i < chord->n_dof + chord->width + 8; i++)
        force[i] = zero;
    for (int i = 0; with_truss && i < m->n_attachment; i++)
        for (int c = 0; c < 3; c++) {
            double load = m->load_N ? m->load_N[c * m->n_node + m->attachment_row[i]] : 0;
            pull[3 * i + c] = zero + load;
        }
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1], k = chord->gene_of_cable[e];
        lanes dx = x[b] - x[a], dy = y[b] - y[a], dz = z[b] - z[a], q = {0};
        if (k >= 0)
            q = gene[k];
        else
            q += m->target[e];
        if (k >= 0 ? tension_rule : hf_law_has(m->law[e], HF_LAW_GIVES_TENSION)) {
            lanes length = dx * dx + dy * dy + dz * dz;
            square_root(&length);
            q /= length;
        }
        dx *= q, dy *= q, dz *= q;
        if (a < m->n_free) force[3 * a] += dx, force[3 * a + 1] += dy, force[3 * a + 2] += dz;
        if (b < m->n_free) force[3 * b] -= dx, force[3 * b + 1] -= dy, force[3 * b + 2] -= dz;
        if (!with_truss) continue;
        int at_a = chord->pull_of_row[a], at_b = chord->pull_of_row[b];
        if (at_a >= 0) pull[at_a] += dx, pull[at_a + 1] += dy, pull[at_a + 2] += dz;
        if (at_b >= 0) pull[at_b] -= dx, pull[at_b + 1] -= dy, pull[at_b + 2] -= dz;
    }
    lanes largest = {0};
    const double scale = 1 / m->reference_N; /* squares of tiny forces would vanish */
    for (int i = 0; i < m->n_free; i++) {
        lanes fx = scale * force[3 * i], fy = scale * force[3 * i + 1], fz = scale * force[3 * i + 2];
        lanes square = fx * fx + fy * fy + fz * fz;
        for (int k = 0; k < HF_LANES; k++)
            largest[k] = square[k] <= largest[k] ? largest[k] : square[k]; /* keeps a NaN */
    }
    for (int k = 0; k < HF_LANES; k++)
        residual_squared[k] = largest[k];
}

void HF_KERNEL(hf_chord_forces)(const hf_chord *chord, const hf_chord_lanes *l, double residual_squared[HF_LANES])
{
    if (chord->n_pull)
        forces(chord, l, true, residual_squared);
    else
        forces(chord, l, false, residual_squared);
}

/* ---- the truss ---- */

/* Compute F f - r for HF_CHORD_ROWS rows at a time, which share the loads of f. */
static void find_gap(const hf_chord *chord, const lanes *pull, const lanes *r, lanes *gap)
{
    const double *f = chord->flexibility;
    const lanes zero = {0};
    for (int i = 0; i < chord->n_pull_pad; i += HF_CHORD_ROWS) {
        lanes s0 = zero, s1 = zero, s2 = zero, s3 = zero, s4 = zero, s5 = zero;
        for (int j = 0; j < chord->n_pull; j++, f += HF_CHORD_ROWS) {
            lanes p = pull[j];
            s0 += f[0] * p;
            s1 += f[1] * p;
            s2 += f[2] * p;
            s3 += f[3] * p;
            s4 += f[4] * p;
            s5 += f[5] * p;
        }
        gap[i] = s0 - r[i];
        gap[i + 1] = s1 - r[i + 1];
        gap[i + 2] = s2 - r[i + 2];
        gap[i + 3] = s3 - r[i + 3];
        gap[i + 4] = s4 - r[i + 4];
        gap[i + 5] = s5 - r[i + 5];
    }
}

void HF_KERNEL(hf_chord_couple)(const hf_chord *chord, const hf_chord_lanes *l, double gap_squared[HF_LANES])
{
    lanes *move = (lanes *)(void *)l->move_m, share[HF_CHORD_MODES_MAX], largest = {0};
    find_gap(chord, (const lanes *)(const void *)l->pull_N, (const lanes *)(const void *)l->displacement_m, move);
    for (int i = 0; i < chord->n_pull; i += 3) {
        lanes square = move[i] * move[i] + move[i + 1] * move[i + 1] + move[i + 2] * move[i + 2];
        for (int k = 0; k < HF_LANES; k++)
            largest[k] = square[k] <= largest[k] ? largest[k] : square[k]; /* keeps a NaN */
    }
    for (int k = 0; k < HF_LANES; k++)
        gap_squared[k] = largest[k];
    const double *mode = chord->mode;
    for (int k = 0; k < chord->n_mode; k++) {
        const double *right = mode + (size_t)(2 * k + 1) * (size_t)chord->n_pull;
        share[k] = (lanes){0};
        for (int i = 0; i < chord->n_pull; i++)
            share[k] += right[i] * move[i];
    }
    for (int k = 0; k < chord->n_mode; k++) {
        const double *left = mode + (size_t)(2 * k) * (size_t)chord->n_pull;
        for (int i = 0; i < chord->n_pull; i++)
            move[i] += left[i] * share[k];
    }
}

void HF_KERNEL(hf_chord_move)(const hf_chord *chord, const hf_chord_lanes *l)
{
    const hf_model *m = chord->evaluator->model;
    lanes *x = (lanes *)(void *)l->x_m, *r = (lanes *)(void *)l->displacement_m;
    lanes *force = (lanes *)(void *)l->force_N + chord->width;
    const lanes *move = (const lanes *)(const void *)l->move_m;
    for (int i = 0; i < m->n_attachment; i++)
        for (int c = 0; c < 3; c++) {
            r[3 * i + c] += move[3 * i + c];
            x[c * m->n_node + m->attachment_row[i]] += move[3 * i + c];
        }
    for (int k = 0; k < m->n_tie; k++) {
        int there = m->end_row[m->tie[k] ^ 1];
        const lanes *d = move + 3 * m->tie_attachment[k];
        const double *block = chord->tie_block + 9 * k;
        if (there >= m->n_free) continue;
        for (int c = 0; c < 3; c++)
            force[3 * there + c] += block[3 * c] * d[0] + block[3 * c + 1] * d[1] + block[3 * c + 2] * d[2];
    }
}

/* ---- the matrix ---- */

/* Both triangular solves take four rows at a time, which share the loads of what is already solved. A packed row (or
 * column) holds `width` entries, zeros where the band is shorter. `width` zero rows stand before and after the
 * right-hand side, and up to three rows after the last are computed without being used, so no edge needs code of its
 * own. Entries outside the skyline of a block of four are zero and are left out. */

/* Row j + p holds the columns j + p - w .. j + p - 1; all four share j + 3 - w .. j - 1. */
static void forward(const hf_chord *chord, lanes *f)
{
    int w = chord->width;
    for (int j = 0; j < chord->n_dof; j += 4) {
        const double *r0 = chord->row + (size_t)j * (size_t)w, *r1 = r0 + w, *r2 = r1 + w, *r3 = r2 + w;
        const double *d = chord->inverse_diagonal + j;
        lanes *y = f + j;
        lanes s0 = y[0] - r0[0] * y[-w] - r0[1] * y[1 - w] - r0[2] * y[2 - w];
        lanes s1 = y[1] - r1[0] * y[1 - w] - r1[1] * y[2 - w], s2 = y[2] - r2[0] * y[2 - w], s3 = y[3];
        for (int i = chord->row_begin[j / 4]; i + 3 < w; i++) {
            lanes solved = y[3 - w + i];
            s0 -= r0[3 + i] * solved;
            s1 -= r1[2 + i] * solved;
            s2 -= r2[1 + i] * solved;
            s3 -= r3[i] * solved;
        }
        y[0] = s0 *= d[0];
        y[1] = s1 = (s1 - r1[w - 1] * s0) * d[1];
        y[2] = s2 = (s2 - r2[w - 2] * s0 - r2[w - 1] * s1) * d[2];
        y[3] = (s3 - r3[w - 3] * s0 - r3[w - 2] * s1 - r3[w - 1] * s2) * d[3];
    }
}

/* Column j + p holds the rows j + p + 1 .. j + p + w; all four share j + 4 .. j + w. */
static void backward(const hf_chord *chord, lanes *f)
{
    int w = chord->width;
    for (int j = (chord->n_dof - 1) / 4 * 4; j >= 0; j -= 4) {
        const double *c0 = chord->column + (size_t)j * (size_t)w, *c1 = c0 + w, *c2 = c1 + w, *c3 = c2 + w;
        const double *d = chord->inverse_diagonal + j;
        lanes *y = f + j;
        lanes s0 = y[0], s1 = y[1] - c1[w - 1] * y[w + 1], s2 = y[2] - c2[w - 2] * y[w + 1] - c2[w - 1] * y[w + 2];
        lanes s3 = y[3] - c3[w - 3] * y[w + 1] - c3[w - 2] * y[w + 2] - c3[w - 1] * y[w + 3];
        for (int i = 0; i < chord->column_end[j / 4]; i++) {
            lanes solved = y[4 + i];
            s0 -= c0[3 + i] * solved;
            s1 -= c1[2 + i] * solved;
            s2 -= c2[1 + i] * solved;
            s3 -= c3[i] * solved;
        }
        y[3] = s3 *= d[3];
        y[2] = s2 = (s2 - c2[0] * s3) * d[2];
        y[1] = s1 = (s1 - c1[0] * s2 - c1[1] * s3) * d[1];
        y[0] = (s0 - c0[0] * s1 - c0[1] * s2 - c0[2] * s3) * d[0];
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
