/* carrier - the truss of a case, with its stiffness matrix factored once and condensed to the supports of the net.
 * Stability: stable. */
#ifndef HIFDM_CARRIER_H
#define HIFDM_CARRIER_H

#include <hifdm/api.h>
#include <hifdm/frame.h>

HF_API_BEGIN

/* Attachment k joins the net's support scene_node[k] to the truss node truss_node[k]. */
typedef struct {
    hf_truss truss;
    hf_frame frame;
    double mass_kg;
    int n_attachment;
    int *scene_node, *truss_node; /* [n_attachment] */
    double *flexibility_m_per_N;  /* [3a][3a], dof 3*k+c; symmetric */
    void *block;
} hf_carrier;

/* Build the carrier from a checked truss and the checked scene that it carries. Each support of the scene is attached
 * to the nearest truss node within the tolerance (hf_truss_attach). The carrier takes ownership of the truss, also
 * after a failure, and sets *truss to all zero. Returns HF_OK; HF_BAD_CASE, HF_MECHANISM or HF_NO_MEMORY with messages.
 * The carrier must not be moved in memory, because its frame points to its truss. Free it in any case. */
hf_status hf_carrier_build(hf_truss *truss, double match_tolerance_m, const hf_scene *scene, hf_carrier *carrier,
                           hf_messages *messages);
void hf_carrier_free(hf_carrier *carrier);

/* Displacements and forces of the truss under forces on its attachments. */
typedef struct {
    double *displacement; /* [n_node][6] m, rad */
    double *reaction;     /* [n_node][6] N, N m; 0 at free dofs */
    double *end_force;    /* [n_member][12] N, N m, local, as hf_frame_member_forces */
    void *block;
} hf_carrier_state;

/* Solve the truss under force_N [n_attachment][3] on its attachments. Returns HF_OK or HF_NO_MEMORY. Free the state in
 * any case. */
hf_status hf_carrier_load(const hf_carrier *carrier, const double *force_N, hf_carrier_state *state);

/* The same with loads of its own beside them, as of temperature and weight; either may be NULL. Own moments where
 * nothing resists rotation are refused: HF_MECHANISM. */
hf_status hf_carrier_load_own(const hf_carrier *carrier, const double *force_N, const hf_frame_load *own,
                              hf_carrier_state *state);

/* Add the weight of members and hinges under gravity_m_per_s2 [3] to force [n_node][6]: of a member half at each end,
 * so that its own bending between its ends is left out. */
void hf_carrier_add_weight(const hf_carrier *carrier, const double gravity_m_per_s2[3], double *force);

/* How far the attachments may be, m, from where linear theory has them, to order of magnitude: what turns by an angle a
 * moves its end by u = r sin a along the circle, and by r (1 - cos a) = u a/2 across it, which small displacements
 * leave out. a is the largest turn of a member, u = *move_m the largest displacement of an attachment; *span_m is the
 * largest distance of the first attachment to another. 0 of a state that is all zero. */
double hf_carrier_second_order_m(const hf_carrier *carrier, const hf_carrier_state *state, double *move_m,
                                 double *span_m);

void hf_carrier_state_free(hf_carrier_state *state);

HF_API_END
#endif
