/* scene_arrays - a scene from plain arrays, for programs whose net is in memory and not in CSV files.
 * Stability: stable. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/scene.h>

HF_API_BEGIN

/* Contains the arrays that define a net. The struct does not own the arrays behind its members. A NULL member has the
 * same effect as a missing column in a table of an imported net. */
typedef struct {
    int n_node;                  /* number of nodes, at least 1 */
    const double *position_m;    /* [n_node][3] target positions; for supports also the actual positions */
    const unsigned char *role;   /* [n_node] role of each node (hf_role) */
    const double *load_N;        /* [n_node][3] loads; may be NULL */
    const char *const *node_id;  /* [n_node] ids; NULL: "0", "1", ... */
    int n_cable;                 /* number of cables, at least 1 */
    const int *end;              /* [n_cable][2] nodes at the ends of each cable, counted from 0 */
    const unsigned char *group;  /* [n_cable] group of each cable (hf_group) */
    const unsigned char *law;    /* [n_cable] law of each cable (hf_law) */
    const double *value;         /* [n_cable] target values in the unit of the law; NaN: empty cell; NULL: all NaN */
    const double *EA_N;          /* [n_cable] axial stiffness; NaN: not given; may be NULL */
    const char *const *cable_id; /* [n_cable] ids; NULL: "0", "1", ... */
    int n_set;                   /* number of named sets of cables (cable_set.h) */
    const char *const *set_name; /* [n_set] names in the order of strcmp, without duplicates */
    const int *set_start;        /* [n_set + 1] first cable of each set in set_cable */
    const int *set_cable;        /* [set_start[n_set]] cables, counted from 0, in ascending order in each set */
} hf_scene_arrays;

/* Copies the arrays into a scene. The array group_EA_N [2] contains, for each hf_group, the axial stiffness in N of
 * cables without their own EA_N. The value 0 means that no axial stiffness is given. Returns HF_OK or HF_NO_MEMORY. If
 * the arrays have faults, the function returns HF_BAD_CASE with messages that contain the node, cable or set. After a
 * call of this function, the caller must check the scene (hf_scene_check). Call hf_scene_free even if
 * hf_scene_from_arrays fails. */
hf_status hf_scene_from_arrays(const hf_scene_arrays *arrays, const double group_EA_N[2], hf_scene *scene,
                               hf_messages *messages);

HF_API_END
