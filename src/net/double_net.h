/* double_net - a rear net behind a front net, and the ties between both: what the generators of such nets share.
 *
 * The front net is over z = x^2/(4f), or z = (x^2 + y^2)/(4f). With s the distance from its middle (along x, or in the
 * plane of x and y), its rim at s = half_m, the rear surface is z_front + (half^2 - s^2) (1/(4f) + 1/(4f_rear)) -
 * distance: its rim lies straight below, and it bulges towards the front. */
#ifndef HIFDM_DOUBLE_NET_H
#define HIFDM_DOUBLE_NET_H

#include <hifdm/cable_set.h>
#include <hifdm/generate.h>

typedef struct {
    hf_surface_kind kind; /* of the front */
    double focal_length_m, rear_focal_length_m;
    double middle_x_m, half_m;
    double distance_m; /* 0: no rear net */
    hf_tie_direction direction;
    bool supports_along_z; /* also where ties run along the normal */
    hf_law law;            /* of the ties */
    double tension_N;      /* what ties of the laws tension, force_density and elastic have at the theoretical places */
} hf_double_net;

/* The members of hf_double_net that are settings of a generator, which has HF_DOUBLE_NET_MEMBERS. */
#define HF_DOUBLE_NET_OF(p)                                                                                            \
    .distance_m = (p)->rear_distance_m, .direction = (p)->tie_direction, .law = (p)->tie_law,                          \
    .tension_N = (p)->tie_tension_N,                                                                                   \
    .rear_focal_length_m = (p)->rear_focal_length_m > 0 ? (p)->rear_focal_length_m : (p)->focal_length_m

/* What stands behind this point of the front net: straight below it, or where its normal meets the rear surface. False
 * when it meets none below. */
bool hf_double_net_behind(const hf_double_net *d, bool along_z, const double front_m[3], double rear_m[3]);

/* "rear_distance_m" when the nets meet in the middle, with the reason in `what`, or NULL. */
const char *hf_double_net_fault(const hf_double_net *d, char *what, size_t size);

/* Are there elastic ties, and no stiffness for them in EA_N (as for generators)? */
bool hf_double_net_lacks_EA(const hf_double_net *d, const double EA_N[2]);

/* Fill in the rear half of a scene whose first n_front nodes and m_front cables are made: node n_front + i behind node
 * i (supports behind supports; free rear nodes have role edge, which psi leaves out), cable m_front + e behind cable e,
 * and then the ties. EA_N as for generators. */
void hf_double_net_fill(const hf_double_net *d, const double EA_N[2], int n_front, int m_front, hf_scene *scene);

/* Append to member [n_member], which are those of the front net: rear cables join rear_set[set of their front cable],
 * the ties tie_set. Returns the number of members, at most 2 n_member + the number of ties; with NULL they are only
 * counted. */
int hf_double_net_join(hf_cable_set_member *member, int n_member, int m_front, int n_tie, const int *rear_set,
                       int tie_set);

/* Write the names that follow from those of the n_front front nodes into text, up to end: of a rear node r and the name
 * of the front node without its f or n, of cables <node>-<node>. A single net has n_front == scene->n_node. */
void hf_double_net_name(hf_scene *scene, int n_front, char *text, const char *end);

#endif
