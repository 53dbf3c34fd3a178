/* carrier - the truss of a case, with a stiffness matrix that is factored once and condensed to the net's supports.
 * Stability: stable.
 *
 * Pipeline: truss and scene -> frame (hf_frame_build) -> attachments (hf_truss_attach) -> flexibility of the
 * attachments (hf_frame_condense), which couples the truss with the net (METHOD section 8). */
#pragma once

#include <hifdm/api.h>
#include <hifdm/frame.h>

HF_API_BEGIN

/* A carrier is the truss that carries a net. Attachment k connects support scene_node[k] of the net with node
 * truss_node[k] of the truss. */
typedef struct {
    hf_truss truss;               /* the truss, owned */
    hf_frame frame;               /* the factored stiffness matrix of the truss */
    double mass_kg;               /* mass of the members and hinges */
    int n_attachment;             /* number of attachments, called a below */
    int *scene_node, *truss_node; /* [n_attachment] nodes of the scene and of the truss */
    double *flexibility_m_per_N;  /* [3a][3a] symmetric; 3*k+c is the row and column of attachment k along c */
    void *block;                  /* owned memory behind the arrays */
} hf_carrier;

/* Builds the carrier from a checked truss and the checked scene of the net on this truss. Each support of the scene is
 * attached to the nearest node of the truss if the distance is at most match_tolerance_m (hf_truss_attach). The carrier
 * takes ownership of the truss, even after a failure. The function sets *truss to all zero. The frame of the carrier
 * points to the truss of the carrier, so the carrier must not be moved in memory. Returns HF_OK. On failure returns
 * HF_BAD_CASE, HF_MECHANISM, HF_NO_MEMORY or HF_NO_LAPACK and adds messages. Call hf_carrier_free even after a
 * failure. */
hf_status hf_carrier_build(hf_truss *truss, double match_tolerance_m, const hf_scene *scene, hf_carrier *carrier,
                           hf_messages *messages);
/* Frees the truss, the frame and the arrays. */
void hf_carrier_free(hf_carrier *carrier);

/* Displacements and forces of the truss in a load case. */
typedef struct {
    double *displacement; /* [n_node][6] displacements, m and rad */
    double *reaction;     /* [n_node][6] reactions, N and N m; 0 at free degrees of freedom */
    double *end_force;    /* [n_member][12] local end forces as in hf_frame_member_forces, N and N m */
    void *block;          /* owned memory behind the arrays */
} hf_carrier_state;

/* Solves the truss under forces on its attachments and under its own loads, such as temperature and weight. Either
 * force_N [n_attachment][3] or `own` may be NULL. Returns HF_OK, HF_NO_MEMORY, or HF_MECHANISM if a moment of `own`
 * acts at a node where nothing resists rotation. Call hf_carrier_state_free even after a failure. */
hf_status hf_carrier_load(const hf_carrier *carrier, const double *force_N, const hf_frame_load *own,
                          hf_carrier_state *state);

/* Adds the weight of members and hinges under the acceleration gravity_m_per_s2 [3] to force [n_node][6], in N. Half of
 * the weight of a member acts at each end. The bending of a member under its own weight is neglected. */
void hf_carrier_add_weight(const hf_carrier *carrier, const double gravity_m_per_s2[3], double *force);

/* Returns the order of magnitude, in m, of the errors of linear theory in the positions of the attachments. A member of
 * length r that rotates by an angle a moves its end by u = r sin a along the tangent. Perpendicular to the tangent, the
 * end moves by r (1 - cos a), about u a/2. Linear theory neglects this displacement. In the estimate, a is the maximum
 * rotation of a member and u is the maximum displacement of an attachment. The function sets *move_m to u. The function
 * sets *span_m to the maximum distance of another attachment from the first one. If the state is all zero, the return
 * value, *move_m and *span_m are 0. */
double hf_carrier_second_order_m(const hf_carrier *carrier, const hf_carrier_state *state, double *move_m,
                                 double *span_m);

/* Frees the arrays of the state. */
void hf_carrier_state_free(hf_carrier_state *state);

HF_API_END
