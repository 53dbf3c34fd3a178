/* load_cases - the load cases of the as-built net, with temperatures, loads and support displacements (METHOD section
 * 12).
 * Stability: internal. This header may change in any version. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/material.h>

HF_API_BEGIN

/* Describes one load case of the as-built net. The arrays have the order of the nodes and cables in the scene and of
 * the members in the truss. Values that the case does not give are zero. */
typedef struct {
    const char *name;               /* name of the load case; borrowed */
    bool has_temperature;           /* true if the load case gives a temperature to cables, even a rise of 0 */
    double *rise_K;                 /* [n_cable] rise above the temperature at which the cables were cut */
    double *member_rise_K;          /* [n_member] rise above the temperature at which the truss was made */
    double *force_N;                /* [n_node][3] forces in addition to the loads of the design */
    double *support_displacement_m; /* [n_node][3] displacements of supports */
    double gravity_m_per_s2[3];     /* gravitational acceleration along x, y, z */
} hf_load_case;

/* Contains the load cases of a case and the material of its net. */
typedef struct {
    int n;                                     /* number of load cases; 0: no memory is allocated */
    hf_load_case load_case[HF_LOAD_CASES_MAX]; /* [n] the load cases */
    hf_material material;                      /* thermal expansion and mass of cables and nodes */
    void *block;                               /* owned memory behind the arrays */
} hf_load_cases;

/* Allocates n load cases for a scene and for a truss with n_member members. The number n must be at least 1. If the
 * case has no truss, n_member is 0. The function sets all values to zero and all names to NULL. Returns HF_OK or
 * HF_NO_MEMORY. Call hf_load_cases_free even if hf_load_cases_allocate fails. */
hf_status hf_load_cases_allocate(const hf_scene *scene, int n_member, int n, hf_load_cases *load_cases);
/* Frees the load cases and the material. */
void hf_load_cases_free(hf_load_cases *load_cases);

HF_API_END
