/* Implements the inner loops of chord, for HF_LANES designs side by side.
 *
 *     x_m, tensions -> forces  -> q of the cables, force_N, pull_N, maximum nodal force
 *     pull_N        -> couple  -> move_m, maximum gap F f - r                            (only with a truss)
 *     move_m        -> move    -> displacement_m, attachments in x_m, force_N            (only with a truss)
 *     force_N       -> packed_band solves H0 step = force -> step in force_N
 *     step          -> step    -> free nodes in x_m
 *     x_m, q        -> measure -> psi, tensions and length ratios of the shape in each lane
 *
 * The order of the operations in a lane is always the same. Products are fused with sums only where the source says so
 * (lane.h). All instruction sets therefore give the same bits.
 *
 * Contents: vectors - forces - the truss - the step - measures - table */
#define HF_LANE_VECTORS
#include "search/chord.h"

#include <math.h>
#include <stddef.h>

/* ---- vectors ---- */

enum { ROWS = HF_CHORD_ROWS };

/* Returns the larger value in each lane, or NaN if one of the two is NaN. */
INLINE vec larger_or_nan(vec now, vec next)
{
    typedef long long mask __attribute__((vector_size(WIDTH * sizeof(double))));
    mask takes = (next > now) | (next != next);
    return (vec)((takes & (mask)next) | (~takes & (mask)now));
}

/* Stores a vector in an array of any alignment, from index p on. */
INLINE void put(double *to, vec from, int p)
{
    foreach (k, WIDTH)
        to[p + k] = from[k];
}

/* Computes d, the vector from node `from` to node `to`; both are rows of the model. */
INLINE void difference(const double *x_m, int n_node, int from, int to, int p, vec d[3])
{
    foreach (c, 3)
        d[c] = *lanes_of(x_m, c * n_node + to, p) - *lanes_of(x_m, c * n_node + from, p);
}

/* ---- forces ---- */

static void pull(const hf_model *m, const double *x_m, const double *cut_m, const double *stiffness_N_per_m,
                 double *tension_N, double *q_N_per_m)
{
    for (int e = 0; e < m->n_cable; e++)
        for (int p = 0; p < HF_LANES; p += WIDTH) {
            vec d[3], none = splat(0);
            difference(x_m, m->n_node, m->end_row[2 * e], m->end_row[2 * e + 1], p, d);
            vec length = root(norm_squared(d[0], d[1], d[2])), over = length - *lanes_of(cut_m, e, p);
            vec tension = if_greater(over, none, *lanes_of(stiffness_N_per_m, e, p) * over, none);
            *lanes_of(tension_N, e, p) = tension;
            *lanes_of(q_N_per_m, e, p) = if_greater(tension, none, tension / length, none);
        }
}

/* Computes the force densities q = T / l of the cables with a given tension. */
static void find_densities(const hf_chord *chord, const hf_chord_lanes *l, int p)
{
    const hf_model *m = chord->evaluator->model;
    vec d[3];
    for (int i = 0; i < chord->n_pulled; i++) {
        int e = chord->pulled[i], k = chord->variable_of_cable[e];
        difference(l->x_m, m->n_node, m->end_row[2 * e], m->end_row[2 * e + 1], p, d);
        vec tension = k >= 0 ? *lanes_of(l->variable, k, p) : splat(m->target[e]);
        *lanes_of(l->variable, chord->slot_of_cable[e], p) = tension / root(norm_squared(d[0], d[1], d[2]));
    }
}

/* Computes the force f on model row `row`, whose cables are the incidences of `place`. The loop runs over the nodes and
 * not over the cables, so that a force is summed in registers. */
INLINE void sum_force(const hf_chord *chord, const hf_chord_lanes *l, int place, int row, int p, vec f[3])
{
    const hf_model *m = chord->evaluator->model;
    const hf_chord_incidence *i = chord->incidence + chord->incidence_start[place],
                             *end = chord->incidence + chord->incidence_start[place + 1];
    vec d[3];
    foreach (c, 3)
        f[c] = l->load_N ? *lanes_of(l->load_N, c * m->n_node + row, p)
                         : splat(m->load_N ? m->load_N[c * m->n_node + row] : 0);
    for (; i < end; i++) {
        vec q = *lanes_of(l->variable, i->slot, p);
        difference(l->x_m, m->n_node, row, i->other, p, d);
        foreach (c, 3)
            f[c] = plus_product(f[c], q, d[c]);
    }
}

/* Computes the forces on the free nodes and attachments, and the square of the maximum nodal force over the reference
 * tension. */
static void forces(const hf_chord *chord, const hf_chord_lanes *l, double residual_squared[HF_LANES])
{
    for (int p = 0; p < HF_LANES; p += WIDTH) {
        const hf_model *m = chord->evaluator->model;
        const double *force = l->force_N + chord->matrix.width * HF_LANES;
        /* The forces are scaled by the reference tension, because the squares of tiny forces would vanish. */
        vec f[3], largest = splat(0), scale = splat(1 / m->reference_N);
        find_densities(chord, l, p);
        for (int i = 0; i < m->n_free; i++) {
            sum_force(chord, l, i, i, p, f);
            foreach (c, 3)
                *lanes_of(force, 3 * i + c, p) = f[c];
            largest = larger_or_nan(largest, norm_squared(scale * f[0], scale * f[1], scale * f[2]));
        }
        /* Clear the rows after the last one: a lane that failed may have left NaNs there. */
        for (int i = chord->matrix.n; i < chord->matrix.n + chord->matrix.width + HF_PACKED_ROWS; i++)
            *lanes_of(force, i, p) = splat(0);
        for (int i = 0; 3 * i < chord->n_pull; i++) {
            sum_force(chord, l, m->n_free + i, m->attachment_row[i], p, f);
            foreach (c, 3)
                *lanes_of(l->pull_N, 3 * i + c, p) = f[c];
        }
        put(residual_squared, largest, p);
    }
}

/* ---- the truss ---- */

/* Computes ROWS rows at a time, which share the loads of `in`. */
static void multiply(int n_pad, int n, const double *packed, const double *in, double *out)
{
    for (int i = 0; i < n_pad; i += ROWS, packed += (ptrdiff_t)n * ROWS)
        for (int p = 0; p < HF_LANES; p += WIDTH) {
            vec sum[ROWS];
            foreach (r, ROWS)
                sum[r] = splat(0);
            for (int j = 0; j < n; j++) {
                vec x = *lanes_of(in, j, p);
                foreach (r, ROWS)
                    sum[r] = plus_product(sum[r], splat(packed[j * ROWS + r]), x);
            }
            foreach (r, ROWS)
                *lanes_of(out, i + r, p) = sum[r];
        }
}

/* Finds the maximum gap and multiplies the gaps by (I + F S)^-1 = I + sum of left right' over the modes. */
static void couple(const hf_chord *chord, const hf_chord_lanes *l, double gap_squared[HF_LANES])
{
    multiply(chord->n_pull_pad, chord->n_pull, chord->flexibility, l->pull_N, l->move_m);
    for (int p = 0; p < HF_LANES; p += WIDTH) {
        vec share[HF_CHORD_MODES_MAX], largest = splat(0);
        for (int i = 0; i < chord->n_pull; i++)
            *lanes_of(l->move_m, i, p) -= *lanes_of(l->displacement_m, i, p);
        for (int i = 0; i < chord->n_pull; i += 3) {
            const vec x = *lanes_of(l->move_m, i, p), y = *lanes_of(l->move_m, i + 1, p),
                      z = *lanes_of(l->move_m, i + 2, p);
            largest = larger_or_nan(largest, norm_squared(x, y, z));
        }
        put(gap_squared, largest, p);
        for (int k = 0; k < chord->n_mode; k++) {
            const double *right = chord->mode + (size_t)(2 * k + 1) * (size_t)chord->n_pull;
            share[k] = splat(0);
            for (int i = 0; i < chord->n_pull; i++)
                share[k] = plus_product(share[k], splat(right[i]), *lanes_of(l->move_m, i, p));
        }
        for (int k = 0; k < chord->n_mode; k++) {
            const double *left = chord->mode + (size_t)(2 * k) * (size_t)chord->n_pull;
            for (int i = 0; i < chord->n_pull; i++) {
                vec *at = lanes_of(l->move_m, i, p);
                *at = plus_product(*at, splat(left[i]), share[k]);
            }
        }
    }
}

/* Moves the attachments by move_m, and adds the stiffness of their cables times this step to the forces on free
 * nodes. */
static void move(const hf_chord *chord, const hf_chord_lanes *l)
{
    for (int p = 0; p < HF_LANES; p += WIDTH) {
        const hf_model *m = chord->evaluator->model;
        const double *force = l->force_N + chord->matrix.width * HF_LANES;
        for (int i = 0; i < m->n_attachment; i++)
            for (int c = 0; c < 3; c++) {
                vec step = *lanes_of(l->move_m, 3 * i + c, p);
                *lanes_of(l->displacement_m, 3 * i + c, p) += step;
                *lanes_of(l->x_m, c * m->n_node + m->attachment_row[i], p) += step;
            }
        for (int k = 0; k < m->n_tie; k++) {
            int there = m->end_row[m->tie[k] ^ 1];
            const double *block = chord->tie_block + 9 * k;
            if (there >= m->n_free) continue;
            foreach (c, 3) {
                vec *f = lanes_of(force, 3 * there + c, p);
                foreach (d, 3)
                    *f = plus_product(*f, splat(block[3 * c + d]),
                                      *lanes_of(l->move_m, 3 * m->tie_attachment[k] + d, p));
            }
        }
    }
}

/* ---- the step ---- */

static void step(const hf_chord *chord, const hf_chord_lanes *l)
{
    const hf_model *m = chord->evaluator->model;
    const double *step = l->force_N + chord->matrix.width * HF_LANES;
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < m->n_free; i++)
            for (int p = 0; p < HF_LANES; p += WIDTH)
                *lanes_of(l->x_m, c * m->n_node + i, p) += *lanes_of(step, 3 * i + c, p);
}

/* ---- measures ---- */

/* Returns psi of Eq. 10. */
static vec psi(const hf_model *m, const double *x_m, int p)
{
    vec sum = splat(0), d[3];
    for (int k = 0; k < m->n_inner_node; k++) {
        int row = m->inner_row[k];
        foreach (c, 3)
            d[c] = *lanes_of(x_m, c * m->n_node + row, p) - m->position_m[c * m->n_node + row];
        sum += norm_squared(d[0], d[1], d[2]);
    }
    return root(sum / (double)m->n_inner_node);
}

/* Finds the extreme tensions of each group, the extreme length ratios, the error against given tensions, and psi. */
static void measure(const hf_chord *chord, const hf_chord_lanes *l, hf_chord_measures *out)
{
    for (int p = 0; p < HF_LANES; p += WIDTH) {
        const hf_model *m = chord->evaluator->model;
        vec most = splat(INFINITY), none = splat(0), error = none, d[3];
        vec low[2] = {most, most}, high[2] = {-most, -most}, short_pulled = most, short_other = most, longest = none;
        for (int e = 0; e < m->n_cable; e++) {
            int k = chord->variable_of_cable[e], slot = chord->slot_of_cable[e];
            difference(l->x_m, m->n_node, m->end_row[2 * e], m->end_row[2 * e + 1], p, d);
            vec length = root(norm_squared(d[0], d[1], d[2])), part = length * chord->inverse_length[e];
            vec q = *lanes_of(l->variable, slot, p), tension = q * length;
            longest = larger(part, longest);
            if (m->group[e] == HF_GROUP_INNER) {
                low[HF_GROUP_INNER] = smaller(tension, low[HF_GROUP_INNER]);
                high[HF_GROUP_INNER] = larger(tension, high[HF_GROUP_INNER]);
            } else {
                low[HF_GROUP_BOUNDARY] = smaller(tension, low[HF_GROUP_BOUNDARY]);
                high[HF_GROUP_BOUNDARY] = larger(tension, high[HF_GROUP_BOUNDARY]);
            }
            if (chord->is_pulled[e]) {
                vec target = k >= 0 ? *lanes_of(l->variable, k, p) : splat(m->target[e]);
                error = larger(magnitude(tension / target - 1), error);
                short_pulled = smaller(part, short_pulled);
            } else {
                short_other = smaller(part, short_other);
            }
        }
        foreach (g, 2) {
            *lanes_of(out->lowest_N[g], 0, p) = low[g];
            *lanes_of(out->highest_N[g], 0, p) = high[g];
        }
        *lanes_of(out->psi_m, 0, p) = psi(m, l->x_m, p);
        *lanes_of(out->tension_error, 0, p) = error;
        *lanes_of(out->shortest_pulled, 0, p) = short_pulled;
        *lanes_of(out->shortest_other, 0, p) = short_other;
        *lanes_of(out->longest, 0, p) = longest;
    }
}

/* ---- table ---- */

const hf_chord_kernels HF_KERNEL(hf_chord_kernels) = {pull, multiply, forces, step, couple, move, measure};
