/* scene_arrays - a scene from plain arrays, for programs that have their net in memory rather than in CSV files.
 * Stability: stable. */
#ifndef HIFDM_SCENE_ARRAYS_H
#define HIFDM_SCENE_ARRAYS_H

#include <hifdm/api.h>
#include <hifdm/scene.h>

HF_API_BEGIN

/* All members are borrowed. What may be NULL is absent, or has the default of a table that lacks the column. */
typedef struct {
    int n_node;
    const double *position_m;   /* [n_node][3] theoretical position; of supports also the real one */
    const unsigned char *role;  /* [n_node] hf_role */
    const double *load_N;       /* [n_node][3], or NULL */
    const char *const *node_id; /* [n_node], or NULL: "0", "1", ... */
    int n_cable;
    const int *end;             /* [n_cable][2] node indices from 0 */
    const unsigned char *group; /* [n_cable] hf_group */
    const unsigned char *law;   /* [n_cable] hf_law */
    const double *value;        /* [n_cable] N, m, N/m or m by law; NaN as an empty cell of a table; or NULL: all NaN */
    const double *EA_N;         /* [n_cable] axial stiffness, NaN: not given; or NULL */
    const char *const *cable_id; /* [n_cable], or NULL: "0", "1", ... */
    int n_set;                   /* named sets of cables, see cable_set.h */
    const char *const *set_name; /* [n_set] in the order of strcmp, no two alike */
    const int *set_start;        /* [n_set + 1] where the cables of each begin in set_cable */
    const int *set_cable;        /* [set_start[n_set]] cable indices from 0, ascending in each set */
} hf_scene_arrays;

/* Copy the arrays into a scene. group_EA_N: by hf_group, for cables without EA_N; 0 = none. HF_OK; HF_BAD_CASE with a
 * message for every fault that names node or cable; HF_NO_MEMORY. Check the scene next (hf_scene_check). Free it with
 * hf_scene_free in any case. */
hf_status hf_scene_from_arrays(const hf_scene_arrays *arrays, const double group_EA_N[2], hf_scene *scene,
                               hf_messages *messages);

HF_API_END
#endif
