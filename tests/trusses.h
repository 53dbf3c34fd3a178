/* trusses - trusses for tests, written by hand or made at random. Header only. */
#pragma once

#include "support.h"

#include <hifdm/frame.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Returns n doubles, all zero. */
static inline double *zeros(size_t n)
{
    double *values = calloc(n ? n : 1, sizeof *values);
    ck_assert_ptr_nonnull(values);
    return values;
}

/* Gives nodes the ids a0, a1, ... and members the ids m0, m1, ... */
static inline void name_truss(hf_truss *t)
{
    char *text = t->text = malloc(16 * (size_t)(t->n_node + t->n_member));
    ck_assert_ptr_nonnull(text);
    for (int i = 0; i < t->n_node + t->n_member; i++, text += 16) {
        int member = i >= t->n_node;
        snprintf(text, 16, "%c%d", member ? 'm' : 'a', member ? i - t->n_node : i);
        *(member ? &t->member_id[i - t->n_node] : &t->node_id[i]) = text;
    }
}

/* Makes a truss of one tube from nodes and pairs of nodes. It has no supports yet. */
static inline void make_truss(hf_truss *t, int n_node, const double (*position_m)[3], int n_member, const int (*end)[2])
{
    ck_assert_int_eq(hf_truss_allocate(t, n_node, n_member, 0), HF_OK);
    memcpy(t->position_m, position_m, (size_t)n_node * sizeof *position_m);
    memcpy(t->end, end, (size_t)n_member * sizeof *end);
    for (int e = 0; e < n_member; e++) {
        t->E_Pa[e] = 130e9;
        t->G_Pa[e] = 5.3e9;
        t->A_m2[e] = 91.1e-6;
        t->Iy_m4[e] = t->Iz_m4[e] = 9.589e-9;
        t->J_m4[e] = 19.18e-9;
        t->Asy_m2[e] = t->Asz_m2[e] = INFINITY;
        t->density_kg_per_m3[e] = 1600;
    }
    name_truss(t);
}

/* Makes a random frame. Each node is joined to an earlier one, and a few more pairs are joined. Sections differ and
 * have roll and shear. Node 0 is held in all degrees of freedom and node 1 in some. */
static inline void random_truss(hf_truss *t, struct rng *rng)
{
    int n = rng_int(rng, 3, 40), m = n - 1, extra = rng_int(rng, 0, 2 * n);
    ck_assert_int_eq(hf_truss_allocate(t, n, m + extra, 0), HF_OK);
    for (int k = 0; k < 3 * n; k++)
        t->position_m[k] = rng_uniform(rng, -3, 3);
    for (int e = 0; e < m + extra; e++) {
        int a = e < m ? e + 1 : rng_int(rng, 1, n - 1), b = rng_int(rng, 0, a - 1);
        t->end[2 * e] = e % 2 ? a : b;
        t->end[2 * e + 1] = e % 2 ? b : a;
        t->E_Pa[e] = rng_uniform(rng, 50e9, 200e9);
        t->G_Pa[e] = rng_uniform(rng, 20e9, 80e9);
        t->A_m2[e] = rng_uniform(rng, 1e-3, 5e-3);
        t->Asy_m2[e] = t->A_m2[e] * rng_uniform(rng, 0.3, 0.9);
        t->Asz_m2[e] = rng_int(rng, 0, 1) ? t->A_m2[e] * rng_uniform(rng, 0.3, 0.9) : (double)INFINITY;
        t->Iy_m4[e] = rng_uniform(rng, 1e-6, 2e-5);
        t->Iz_m4[e] = rng_uniform(rng, 1e-6, 2e-5);
        t->J_m4[e] = rng_uniform(rng, 1e-6, 2e-5);
        t->roll_rad[e] = rng_uniform(rng, -3, 3);
        t->expansion_per_K[e] = rng_uniform(rng, 0, 2e-5);
        t->joint[e] = e >= m && rng_int(rng, 0, 2) == 0 ? HF_JOINT_PINNED : HF_JOINT_RIGID;
    }
    t->fixed[0] = 0x3f;
    t->fixed[1] = (unsigned char)rng_int(rng, 0, 0x3f);
    name_truss(t);
}

struct solved {
    hf_frame frame;
    int n; /* 6 * n_node */
    double *displacement, *reaction, *residual, *end_force;
    double energy_J;
};

static inline void build_frame(const hf_truss *t, hf_frame *frame)
{
    hf_messages messages = {0};
    ck_assert_msg(hf_truss_check(t, &messages) == HF_OK, "%s", messages.text);
    ck_assert_msg(hf_frame_build(t, frame, &messages) == HF_OK, "%s", messages.text);
    ck_assert_ptr_null(messages.text);
}

static inline void solve_truss(const hf_truss *t, const hf_frame_load *load, struct solved *s)
{
    int bad_dof;
    build_frame(t, &s->frame);
    s->n = 6 * t->n_node;
    s->displacement = zeros((size_t)s->n);
    s->reaction = zeros((size_t)s->n);
    s->residual = zeros((size_t)s->n);
    s->end_force = zeros(12 * (size_t)t->n_member);
    double *work = zeros(hf_frame_work_size(&s->frame, 1));
    ck_assert_int_eq(hf_frame_solve(&s->frame, 1, load, work, s->displacement, &bad_dof), HF_OK);
    hf_frame_reactions(&s->frame, load, s->displacement, s->reaction, s->residual);
    hf_frame_member_forces(&s->frame, load, s->displacement, s->end_force);
    s->energy_J = hf_frame_strain_energy(&s->frame, load, s->displacement);
    free(work);
}

static inline void free_solved(struct solved *s)
{
    hf_frame_free(&s->frame);
    free(s->displacement);
    free(s->reaction);
    free(s->residual);
    free(s->end_force);
}

static inline double largest(int n, const double *value)
{
    double most = 0;
    for (int k = 0; k < n; k++)
        most = fmax(most, fabs(value[k]));
    return most;
}

/* Checks that a and b agree, separately for the first and the last three of every six components. The tolerance is
 * relative to the largest of these components in b. */
static inline void check_alike(int n, const double *a, const double *b, double tolerance)
{
    for (int kind = 0; kind < 2; kind++) {
        double most = 0;
        for (int k = 0; k < n; k++)
            if (k % 6 / 3 == kind) most = fmax(most, fabs(b[k]));
        for (int k = 0; k < n; k++)
            if (k % 6 / 3 == kind)
                ck_assert_msg(fabs(a[k] - b[k]) <= tolerance * most, "component %d of node %d: %.17g, not %.17g", k % 6,
                              k / 6, a[k], b[k]);
    }
}
