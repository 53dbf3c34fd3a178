/* front_net - the net that a generator makes, and the scene that follows from it: the same net, behind it a rear net
 * with ties if there is one (double_net), sets of cables and ids.
 *
 * A generator adds nodes and cables twice. First they are only counted, then they are kept. */
#pragma once

#include "net/double_net.h"
#include <hifdm/cable_set.h>

/* The id of a node: prefix<a>_<b>, or prefix<a> if b is negative. The prefix has at most two letters. */
typedef struct {
    const char *prefix;
    int a, b;
} hf_front_label;

typedef struct {
    int n_node, n_cable, n_member; /* added so far */
    /* Arrays, NULL while nodes and cables are only counted: */
    double *position_m;          /* [n_node][3] */
    unsigned char *role;         /* [n_node] hf_role */
    hf_front_label *label;       /* [n_node] */
    int *end;                    /* [n_cable][2] */
    unsigned char *group;        /* [n_cable] hf_group; boundary cables have law length, inner cables law tension */
    hf_cable_set_member *member; /* [n_member] */
    void *block;
} hf_front_net;

/* Names the sets of a generator: their names by strcmp, for each set that of the same cables in the rear net, and the
 * set of the ties. */
typedef struct {
    int n;
    const char *const *name;
    const int *rear, tie;
} hf_front_families;

/* Makes a net by calling `add` twice. Returns HF_OK or HF_NO_MEMORY. Call hf_front_net_free in any case. */
hf_status hf_front_net_make(void (*add)(void *context, hf_front_net *front), void *context, hf_front_net *front);
void hf_front_net_free(hf_front_net *front);

/* Writes a node whose index is below n_node; does nothing while nodes are only counted. */
void hf_front_net_put(hf_front_net *front, int node, const double position_m[3], hf_role role, hf_front_label label);

/* hf_front_net_join puts the next cable into a set, which may be negative for none. hf_front_net_connect then adds the
 * cable. */
void hf_front_net_join(hf_front_net *front, int set);
void hf_front_net_connect(hf_front_net *front, int a, int b, hf_group group);

/* Makes the scene. With a rear net, node n + i of the scene is behind node i, and cable m + e behind cable e; ties from
 * free nodes follow. Rear supports are behind supports; free rear nodes have role edge, so psi does not count them. A
 * rear node is called r, followed by the id of its front node without a leading f or n. A cable is called
 * <node>-<node>. EA_N is that of the generators. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_front_net_scene(const hf_front_net *front, const hf_double_net *d, const double EA_N[2],
                             const hf_front_families *families, hf_scene *scene);
