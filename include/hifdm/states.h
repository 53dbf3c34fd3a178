/* states - named states of the net as built: what its temperatures, loads and supports are in each.
 * Stability: internal; may change in any version. */
#ifndef HIFDM_STATES_H
#define HIFDM_STATES_H

#include <hifdm/api.h>
#include <hifdm/material.h>

HF_API_BEGIN

/* Arrays of the state in the order of scene and truss, zero where nothing is said. */
typedef struct {
    const char *name;
    double *rise_K;        /* [n_cable] above the temperature at which they were cut */
    double *member_rise_K; /* [n_member] of the truss, the same */
    double *force_N;       /* [n_node][3] beside the loads of the design */
    double *move_m;        /* [n_node][3] of supports */
    double gravity_m_per_s2[3];
} hf_state;

typedef struct {
    int n; /* 0: nothing is allocated */
    hf_state state[HF_STATES_MAX];
    hf_material material;
    void *block;
} hf_states;

/* Make room for n >= 1 states of a scene and a truss of n_member members; all is zero, names are NULL. HF_OK or
 * HF_NO_MEMORY. Free it in any case. */
hf_status hf_states_allocate(const hf_scene *scene, int n_member, int n, hf_states *states);
void hf_states_free(hf_states *states);

HF_API_END
#endif
