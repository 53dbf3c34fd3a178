/* states - the load cases of the as-built net: temperatures, loads and support displacements of each (METHOD section
 * 12).
 * Stability: internal; may change in any version. */
#ifndef HIFDM_LOAD_CASES_H
#define HIFDM_LOAD_CASES_H

#include <hifdm/api.h>
#include <hifdm/material.h>

HF_API_BEGIN

/* One load case. Its arrays are in the order of scene and truss, and zero where the case gives nothing. */
typedef struct {
    const char *name;           /* name of the load case; borrowed */
    double *rise_K;             /* [n_cable] rise above the temperature at which the cables were cut */
    double *member_rise_K;      /* [n_member] rise above the temperature at which the truss was made */
    double *force_N;            /* [n_node][3] forces, in addition to the loads of the design */
    double *move_m;             /* [n_node][3] displacements of supports */
    double gravity_m_per_s2[3]; /* acceleration of gravity along x, y, z */
} hf_load_case;

/* The load cases of a case, with the material of its net. */
typedef struct {
    int n;                                     /* number of load cases; 0: nothing is allocated */
    hf_load_case load_case[HF_LOAD_CASES_MAX]; /* [n] the load cases */
    hf_material material;                      /* expansion and mass of cables and nodes */
    void *block;                               /* owned memory behind the arrays */
} hf_load_cases;

/* Allocates n >= 1 load cases of a scene and a truss of n_member members (0 without a truss). All values are zero and
 * the names NULL. Returns HF_OK or HF_NO_MEMORY. Call hf_load_cases_free in either case. */
hf_status hf_load_cases_allocate(const hf_scene *scene, int n_member, int n, hf_load_cases *load_cases);
/* Frees the load cases and the material. */
void hf_load_cases_free(hf_load_cases *load_cases);

HF_API_END
#endif
