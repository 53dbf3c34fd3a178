/* carrier - the truss of a case as the net sees it: factored once, and condensed to the supports of the net.
 * Stability: stable. */
#ifndef HIFDM_CARRIER_H
#define HIFDM_CARRIER_H

#include <hifdm/frame.h>

#ifdef __cplusplus
extern "C" {
#endif

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

/* Of a checked truss and the checked scene that it carries; each support of the scene stands on the nearest truss node
 * within the tolerance (hf_truss_attach). The carrier takes the truss over, whatever happens, and leaves *truss all
 * zero. HF_BAD_CASE, HF_MECHANISM or HF_NO_MEMORY with messages. The carrier must stay where it is (its frame points to
 * its truss); free it in any case. */
hf_status hf_carrier_build(hf_truss *truss, double match_tolerance_m, const hf_scene *scene, hf_carrier *carrier,
                           hf_messages *messages);
void hf_carrier_free(hf_carrier *carrier);

/* What forces on the attachments do to the truss. */
typedef struct {
    double *displacement; /* [n_node][6] m, rad */
    double *reaction;     /* [n_node][6] N, N m; 0 at free dofs */
    double *end_force;    /* [n_member][12] N, N m, local, as hf_frame_member_forces */
    void *block;
} hf_carrier_state;

/* force_N: [n_attachment][3]. HF_OK or HF_NO_MEMORY. Free the state in any case. */
hf_status hf_carrier_load(const hf_carrier *carrier, const double *force_N, hf_carrier_state *state);

void hf_carrier_state_free(hf_carrier_state *state);

#ifdef __cplusplus
}
#endif
#endif
