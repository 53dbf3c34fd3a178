/* carrier - the truss of a case, with its stiffness matrix factored once and condensed to the supports of the net.
 * Stability: stable.
 *
 * Pipeline: truss and scene -> frame (hf_frame_build) -> attachments (hf_truss_attach) -> flexibility of the
 * attachments (hf_frame_condense), with which the net is coupled (METHOD section 8). */
#ifndef HIFDM_CARRIER_H
#define HIFDM_CARRIER_H

#include <hifdm/api.h>
#include <hifdm/frame.h>

HF_API_BEGIN

/* The truss that carries a net. Attachment k joins support scene_node[k] of the net to node truss_node[k] of the
 * truss. */
typedef struct {
    hf_truss truss;               /* the truss; owned */
    hf_frame frame;               /* its factored stiffness matrix */
    double mass_kg;               /* mass of members and hinges */
    int n_attachment;             /* number of attachments, a below */
    int *scene_node, *truss_node; /* [n_attachment] nodes of the scene, and of the truss */
    double *flexibility_m_per_N;  /* [3a][3a] symmetric; row and column of attachment k along c: 3*k+c */
    void *block;                  /* owned memory behind the arrays */
} hf_carrier;

/* Builds the carrier from a checked truss and the checked scene that it carries. Each support of the scene is attached
 * to the nearest node of the truss, if that is within match_tolerance_m (hf_truss_attach). The carrier takes ownership
 * of the truss, also after a failure, and sets *truss to all zero. The frame of the carrier points to its truss, so the
 * carrier must not be moved in memory. Returns HF_OK; HF_BAD_CASE, HF_MECHANISM, HF_NO_MEMORY or HF_NO_LAPACK with
 * messages. Call hf_carrier_free in any case. */
hf_status hf_carrier_build(hf_truss *truss, double match_tolerance_m, const hf_scene *scene, hf_carrier *carrier,
                           hf_messages *messages);
/* Frees truss, frame and arrays. */
void hf_carrier_free(hf_carrier *carrier);

/* Displacements and forces of the truss under a load case. */
typedef struct {
    double *displacement; /* [n_node][6] displacements, m, rad */
    double *reaction;     /* [n_node][6] reactions, N, N m; 0 at free dofs */
    double *end_force;    /* [n_member][12] local end forces as of hf_frame_member_forces, N, N m */
    void *block;          /* owned memory behind the arrays */
} hf_carrier_state;

/* Solves the truss under the forces force_N [n_attachment][3] on its attachments. Returns HF_OK or HF_NO_MEMORY. Call
 * hf_carrier_state_free in either case. */
hf_status hf_carrier_load(const hf_carrier *carrier, const double *force_N, hf_carrier_state *state);

/* Solves the truss under forces on its attachments and its own loads, such as temperature and weight. force_N
 * [n_attachment][3] or `own` may be NULL. Returns HF_OK; HF_MECHANISM if a moment of `own` acts where nothing resists
 * rotation; HF_NO_MEMORY. Call hf_carrier_state_free in any case. */
hf_status hf_carrier_load_own(const hf_carrier *carrier, const double *force_N, const hf_frame_load *own,
                              hf_carrier_state *state);

/* Adds the weight of members and hinges under the acceleration gravity_m_per_s2 [3] to force [n_node][6], N. Half of
 * the weight of a member acts at each end; bending of a member under its own weight is neglected. */
void hf_carrier_add_weight(const hf_carrier *carrier, const double gravity_m_per_s2[3], double *force);

/* Returns the order of magnitude of what linear theory neglects in the positions of the attachments, m. A member that
 * turns by an angle a moves its end by u = r sin a along the circle. Across the circle the end moves by r (1 - cos a),
 * about u a/2, and linear theory neglects this. a is the maximum rotation of a member, and u is the maximum
 * displacement of an attachment, to which *move_m is set. *span_m is set to the maximum distance of the first
 * attachment from another one. All three are 0 for a state that is all zero. */
double hf_carrier_second_order_m(const hf_carrier *carrier, const hf_carrier_state *state, double *move_m,
                                 double *span_m);

/* Frees the arrays of the state. */
void hf_carrier_state_free(hf_carrier_state *state);

HF_API_END
#endif
