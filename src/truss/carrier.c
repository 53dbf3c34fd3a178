/* Builds the truss of a case and solves it under forces on its attachments:
 *
 *     checked truss, scene -> hf_frame_build: numbering, assembly, factor
 *       -> hf_truss_attach: supports of the net -> nearest truss nodes
 *       -> hf_frame_condense -> flexibility [3a][3a] of the attachments
 *     forces on attachments, own loads -> hf_frame_solve -> displacements, reactions, member forces */
#include <hifdm/carrier.h>

#include "base/arena.h"
#include "base/elementary.h"

#include <math.h>
#include <stdlib.h>

static hf_status attach(double tolerance_m, const hf_scene *scene, hf_carrier *c, hf_messages *messages)
{
    size_t n_support = 0;
    for (int i = 0; i < scene->n_node; i++)
        n_support += scene->role[i] == HF_ROLE_SUPPORT;
    hf_status status =
        HF_ARENA_ARRAYS(&c->block, HF_ARRAY(c->scene_node, n_support), HF_ARRAY(c->truss_node, n_support),
                        HF_ARRAY(c->flexibility_m_per_N, 9 * n_support * n_support));
    if (status == HF_OK) {
        HF_TRY(
            hf_truss_attach(&c->truss, scene, tolerance_m, &c->n_attachment, c->scene_node, c->truss_node, messages));
        status = hf_frame_condense(&c->frame, c->n_attachment, c->truss_node, c->flexibility_m_per_N);
        if (status == HF_OK) status = hf_frame_blocks(&c->frame, c->n_attachment, c->truss_node, &c->stiffness);
    }
    if (status == HF_OK) return HF_OK;
    return hf_error(messages, status, "out of memory for a truss with %zu attachments", n_support);
}

hf_status hf_carrier_build(hf_truss *truss, double match_tolerance_m, const hf_scene *scene, hf_carrier *carrier,
                           hf_messages *messages)
{
    *carrier = (hf_carrier){.truss = *truss};
    *truss = (hf_truss){0};
    carrier->mass_kg = hf_truss_mass(&carrier->truss);
    HF_TRY(hf_frame_build(&carrier->truss, &carrier->frame, messages));
    return attach(match_tolerance_m, scene, carrier, messages);
}

void hf_carrier_free(hf_carrier *carrier)
{
    hf_arena_free_block(carrier->stiffness.memory);
    hf_arena_free_block(carrier->block);
    hf_frame_free(&carrier->frame);
    hf_truss_free(&carrier->truss);
    *carrier = (hf_carrier){0};
}

hf_status hf_carrier_load(const hf_carrier *c, const double *force_N, const hf_frame_load *own, hf_carrier_state *state)
{
    double *force, *work;
    int bad_dof;
    size_t n = HF_TRUSS_DOF * (size_t)c->truss.n_node;
    *state = (hf_carrier_state){0};
    HF_TRY(HF_ARENA_ARRAYS(&state->block, HF_ARRAY(state->displacement, n), HF_ARRAY(state->reaction, n),
                           HF_ARRAY(state->end_force, 2 * HF_TRUSS_DOF * (size_t)c->truss.n_member), HF_ARRAY(force, n),
                           HF_ARRAY(work, hf_frame_work_size(&c->frame, 1))));
    hf_frame_load load = {0};
    if (own) load = *own;
    for (int i = 0; load.force && i < HF_TRUSS_DOF * c->truss.n_node; i++)
        force[i] = load.force[i];
    for (int k = 0; force_N && k < c->n_attachment; k++)
        for (int d = 0; d < 3; d++)
            force[HF_TRUSS_DOF * c->truss_node[k] + d] += force_N[3 * k + d];
    load.force = force;
    HF_TRY(hf_frame_solve(&c->frame, 1, &load, work, state->displacement, &bad_dof));
    hf_frame_reactions(&c->frame, &load, state->displacement, state->reaction, NULL);
    hf_frame_member_forces(&c->frame, &load, state->displacement, state->end_force);
    return HF_OK;
}

void hf_carrier_add_weight(const hf_carrier *c, const double gravity_m_per_s2[3], double *force)
{
    const hf_truss *t = &c->truss;
    for (int d = 0; d < 3; d++) {
        for (int i = 0; i < t->n_node; i++)
            force[HF_TRUSS_DOF * i + d] += t->mass_kg[i] * gravity_m_per_s2[d];
        for (int e = 0; e < t->n_member; e++)
            for (int k = 0; k < 2; k++)
                force[HF_TRUSS_DOF * t->end[2 * e + k] + d] +=
                    t->density_kg_per_m3[e] * t->A_m2[e] * c->frame.length_m[e] * gravity_m_per_s2[d] / 2;
    }
}

double hf_carrier_second_order_m(const hf_carrier *c, const hf_carrier_state *state, double *move_m, double *span_m)
{
    const hf_truss *t = &c->truss;
    double turn = 0;
    *move_m = *span_m = 0;
    for (int e = 0; e < t->n_member && state->displacement; e++) {
        const int *end = t->end + 2 * e;
        double along = 0, square = 0, length_m = c->frame.length_m[e];
        for (int d = 0; d < 3; d++) {
            double by = state->displacement[HF_TRUSS_DOF * end[1] + d] - state->displacement[HF_TRUSS_DOF * end[0] + d];
            along += by * (t->position_m[3 * end[1] + d] - t->position_m[3 * end[0] + d]) / length_m;
            square += by * by;
        }
        turn = fmax(turn, sqrt(fmax(0, square - along * along)) / length_m);
    }
    for (int k = 0; k < c->n_attachment && state->displacement; k++) {
        const double *u = state->displacement + HF_TRUSS_DOF * c->truss_node[k];
        const double *at = t->position_m + 3 * c->truss_node[k], *first = t->position_m + 3 * c->truss_node[0];
        *move_m = fmax(*move_m, hf_norm(u[0], u[1], u[2]));
        *span_m = fmax(*span_m, hf_distance(at, first));
    }
    return turn * *move_m / 2;
}

void hf_carrier_state_free(hf_carrier_state *state)
{
    hf_arena_free_block(state->block);
    *state = (hf_carrier_state){0};
}
