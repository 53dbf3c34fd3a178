/* scene_arrays - a scene from plain arrays, for programs that have their net in memory and not in CSV files.
 * Stability: stable. */
#ifndef HIFDM_SCENE_ARRAYS_H
#define HIFDM_SCENE_ARRAYS_H

#include <hifdm/api.h>
#include <hifdm/scene.h>

HF_API_BEGIN

/* The arrays of a net. All members are borrowed. A member that may be NULL is then absent, or it has the default of a
 * table without that column. */
typedef struct {
    int n_node;                  /* number of nodes, at least 1 */
    const double *position_m;    /* [n_node][3] target positions; of supports also the real ones */
    const unsigned char *role;   /* [n_node] hf_role */
    const double *load_N;        /* [n_node][3] loads, or NULL */
    const char *const *node_id;  /* [n_node] ids, or NULL: "0", "1", ... */
    int n_cable;                 /* number of cables, at least 1 */
    const int *end;              /* [n_cable][2] nodes at the ends, from 0 */
    const unsigned char *group;  /* [n_cable] hf_group */
    const unsigned char *law;    /* [n_cable] hf_law */
    const double *value;         /* [n_cable] target values in the unit of the law; NaN: empty cell; NULL: all NaN */
    const double *EA_N;          /* [n_cable] axial stiffness, NaN: not given; or NULL */
    const char *const *cable_id; /* [n_cable] ids, or NULL: "0", "1", ... */
    int n_set;                   /* number of named sets of cables (cable_set.h) */
    const char *const *set_name; /* [n_set] in the order of strcmp without duplicates */
    const int *set_start;        /* [n_set + 1] first cable of each set in set_cable */
    const int *set_cable;        /* [set_start[n_set]] cables from 0, ascending in each set */
} hf_scene_arrays;

/* Copies the arrays into a scene. group_EA_N has the axial stiffness by hf_group for cables without EA_N, N; 0: none.
 * Returns HF_OK; HF_BAD_CASE with messages that name the node, cable or set; HF_NO_MEMORY. The scene must then be
 * checked (hf_scene_check). Call hf_scene_free in any case. */
hf_status hf_scene_from_arrays(const hf_scene_arrays *arrays, const double group_EA_N[2], hf_scene *scene,
                               hf_messages *messages);

HF_API_END
#endif
