/* verified - computes the measures of a result a second time, from positions and laws alone, in long double and with
 * sums in another order. A mistake in how the library measures a result is found in this way. */
#pragma once

#include "nets.h"

struct verified {
    double residual_N;      /* largest nodal force out of balance; INFINITY if something is not finite */
    double length_gap;      /* largest |l/L-1| of laws length and elastic; too short: weighted by the tension */
    double least_tension_N; /* minimum tension of these laws: a multiplier must not be negative */
    /* Largest distance of an attachment from its position on the truss under the pull of the net. */
    double truss_m;
};

/* Measures the shape in `w` under law[] and target[] of the cables of the model (NaN: the pretension of the case). */
static inline struct verified verify_shape(const hf_model *m, const hf_workspace *w, const unsigned char *law,
                                           const double *target)
{
    struct verified v = {0, 0, INFINITY, 0};
    long double *force = calloc(3 * (size_t)m->n_node, sizeof *force);
    ck_assert_ptr_nonnull(force);
    for (int k = 0; k < 3 * m->n_node && m->load_N; k++)
        force[k] = m->load_N[k];
    for (int e = m->n_cable - 1; e >= 0; e--) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        long double d[3], square = 0, pull;
        for (int c = 0; c < 3; c++) {
            d[c] = (long double)w->position_m[c * m->n_node + b] - w->position_m[c * m->n_node + a];
            square += d[c] * d[c];
        }
        long double length = sqrtl(square), wanted = isnan(target[e]) ? m->pretension_N : target[e];
        if (law[e] == HF_LAW_LENGTH || law[e] == HF_LAW_ELASTIC) {
            pull = w->q_N_per_m[e];
            if (law[e] == HF_LAW_ELASTIC) wanted *= 1 + pull * length / m->EA_N[e];
            double tension = (double)(pull * length), gap = (double)(length / wanted - 1);
            v.least_tension_N = fmin(v.least_tension_N, tension);
            v.length_gap = fmax(v.length_gap, gap > 0 ? gap : -gap * fmin(1, tension / m->reference_N));
        } else {
            pull = law[e] == HF_LAW_TENSION ? wanted / length : wanted;
        }
        for (int c = 0; c < 3; c++) {
            force[c * m->n_node + a] += pull * d[c];
            force[c * m->n_node + b] -= pull * d[c];
        }
    }
    for (int i = 0; i < m->n_free; i++) {
        const long double *x = force + i, *y = x + m->n_node, *z = y + m->n_node;
        double size = (double)sqrtl(*x * *x + *y * *y + *z * *z);
        v.residual_N = isfinite(size) ? fmax(v.residual_N, size) : INFINITY;
    }
    for (int i = 0; i < m->n_attachment; i++) {
        long double square = 0;
        for (int c = 0; c < 3; c++) {
            int row = m->attachment_row[i], n = 3 * m->n_attachment;
            long double gap = (long double)m->position_m[c * m->n_node + row] - w->position_m[c * m->n_node + row];
            for (int k = 0; k < n; k++)
                gap +=
                    m->flexibility_m_per_N[(3 * i + c) * n + k] * force[k % 3 * m->n_node + m->attachment_row[k / 3]];
            square += gap * gap;
        }
        v.truss_m = fmax(v.truss_m, (double)sqrtl(square));
    }
    free(force);
    return v;
}

/* Returns the largest distance between the positions of a node in two shapes [3][n_node] of one model, m. */
static inline double largest_move_m(const hf_model *m, const double *a, const double *b)
{
    double most = 0;
    for (int i = 0; i < m->n_node; i++) {
        double square = 0;
        for (int c = 0; c < 3; c++)
            square += (a[c * m->n_node + i] - b[c * m->n_node + i]) * (a[c * m->n_node + i] - b[c * m->n_node + i]);
        most = fmax(most, sqrt(square));
    }
    return most;
}

static inline double *copy_positions(const hf_model *m, const hf_workspace *w)
{
    size_t bytes = 3 * (size_t)m->n_node * sizeof(double);
    double *copy = malloc(bytes);
    ck_assert_ptr_nonnull(copy);
    memcpy(copy, w->position_m, bytes);
    return copy;
}

/* Gives some inner cables of a reflector force densities, and all inner nodes loads. The net then has all three
 * laws. */
static inline void mix_laws(struct rng *rng, hf_scene *scene)
{
    hf_scene s;
    ck_assert_int_eq(hf_scene_allocate(&s, scene->n_node, scene->n_cable, 1, 0, 0), HF_OK);
    memcpy(s.position_m, scene->position_m, 3 * (size_t)s.n_node * sizeof(double));
    memcpy(s.role, scene->role, (size_t)s.n_node);
    memcpy(s.end, scene->end, 2 * (size_t)s.n_cable * sizeof(int));
    memcpy(s.group, scene->group, (size_t)s.n_cable);
    memcpy(s.law, scene->law, (size_t)s.n_cable);
    memcpy(s.target, scene->target, (size_t)s.n_cable * sizeof(double));
    memcpy(s.node_id, scene->node_id, (size_t)s.n_node * sizeof *s.node_id);
    memcpy(s.cable_id, scene->cable_id, (size_t)s.n_cable * sizeof *s.cable_id);
    for (int e = 0; e < s.n_cable; e++)
        if (s.law[e] == HF_LAW_TENSION && rng_int(rng, 0, 3) == 0) {
            s.law[e] = HF_LAW_FORCE_DENSITY;
            s.target[e] = rng_uniform(rng, 8, 12) / hf_scene_length_at_target(&s, e);
        }
    for (int k = 0; k < 3 * s.n_node; k++)
        s.load_N[k] = s.role[k / 3] == HF_ROLE_INNER ? rng_uniform(rng, -0.3, 0.3) : 0;
    s.text = scene->text; /* the text of the ids */
    scene->text = NULL;
    hf_scene_free(scene);
    *scene = s;
}
