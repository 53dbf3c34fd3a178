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
    hf_truss truss;                /* the truss, owned */
    hf_frame frame;                /* the factored stiffness matrix of the truss */
    double mass_kg;                /* mass of the members and hinges */
    int n_attachment;              /* number of attachments, called a below */
    int *scene_node, *truss_node;  /* [n_attachment] nodes of the scene and of the truss */
    double *flexibility_m_per_N;   /* [3a][3a] symmetric; 3*k+c is the row and column of attachment k along c */
    hf_stiffness_blocks stiffness; /* of the truss; the attachments come first */
    void *block;                   /* owned memory behind the arrays */
} hf_carrier;

/* Builds the carrier from a truss and the scene of the net on this truss. The truss and the scene must already be
 * checked. Each support of the scene is attached to the nearest node of the truss (hf_truss_attach). The maximum
 * distance of a support from its node is match_tolerance_m. The carrier takes ownership of the truss, even if
 * hf_carrier_build fails. The function sets all members of *truss to zero. The frame of the carrier contains a pointer
 * to the truss of the carrier. Therefore, the carrier must not be moved in memory. Returns HF_OK. If the function
 * fails, it adds messages and returns HF_BAD_CASE, HF_MECHANISM, HF_NO_MEMORY or HF_NO_LAPACK. Call hf_carrier_free
 * even if hf_carrier_build fails. */
hf_status hf_carrier_build(hf_truss *truss, double match_tolerance_m, const hf_scene *scene, hf_carrier *carrier,
                           hf_messages *messages);
/* Frees the truss, the frame and the arrays. */
void hf_carrier_free(hf_carrier *carrier);

/* Contains the displacements and forces of the truss in a load case. */
typedef struct {
    double *displacement; /* [n_node][6] displacements, m and rad */
    double *reaction;     /* [n_node][6] reactions, N and N m; 0 at free degrees of freedom */
    double *end_force;    /* [n_member][12] local end forces as in hf_frame_member_forces, N and N m */
    void *block;          /* owned memory behind the arrays */
} hf_carrier_state;

/* Solves the truss under forces on its attachments and under its own loads, such as temperature and weight. Either of
 * the arguments force_N [n_attachment][3] and `own` may be NULL. Returns HF_OK, HF_NO_MEMORY, or HF_MECHANISM if `own`
 * has a moment at a node where nothing resists rotation. Call hf_carrier_state_free even if hf_carrier_load fails. */
hf_status hf_carrier_load(const hf_carrier *carrier, const double *force_N, const hf_frame_load *own,
                          hf_carrier_state *state);

/* Adds the weight of members and hinges in N to the array force [n_node][6]. The argument gravity_m_per_s2 [3] is the
 * gravitational acceleration. Half of the weight of a member acts at each of its ends. The function neglects the
 * bending of members under their own weight. */
void hf_carrier_add_weight(const hf_carrier *carrier, const double gravity_m_per_s2[3], double *force);

/* Returns the order of magnitude, in m, of the errors of linear theory in the positions of the attachments. If a member
 * of length r rotates by an angle a, its end moves by u = r sin a along the tangent. Perpendicular to the tangent, the
 * end of the member moves by r (1 - cos a), which is about u a/2. Linear theory neglects this displacement. In this
 * estimate, the angle a is the maximum rotation of a member. The distance u is the maximum displacement of an
 * attachment. The function sets *move_m to the displacement u. The function sets *span_m to the maximum distance
 * between the first attachment and any other attachment. If all displacements of the state are zero, the return value,
 * *move_m and *span_m are 0. */
double hf_carrier_second_order_m(const hf_carrier *carrier, const hf_carrier_state *state, double *move_m,
                                 double *span_m);

/* Frees the arrays of the state. */
void hf_carrier_state_free(hf_carrier_state *state);

HF_API_END
