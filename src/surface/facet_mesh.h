/* facet_mesh - the pillow: the shape that a tensioned mesh takes between cables which give way to its pull (METHOD
 * section 9). */
#ifndef HIFDM_FACET_MESH_H
#define HIFDM_FACET_MESH_H

#include "surface/facet_rms.h"

enum { HF_FACET_N_BUBBLE = 6 };

/* A facet under its mesh: a point of the bilinear surface of its corners is lifted along its normal by a sum of
 * functions that are arcs along the sides, and of functions that vanish there. */
typedef struct {
    const double *corner[4];
    double normal[3];
    bool is_triangle; /* the last two corners are the same; the third side has no length */
    double sag_m[4];  /* along the normal, of the middle of side k, from corner k to the next */
    double bubble_m[HF_FACET_N_BUBBLE];
} hf_facet_mesh;

/* A flat facet. */
void hf_facet_mesh_take(const hf_facets *facets, int i, const double *position_m, hf_facet_mesh *mesh);

/* A facet bent by sag_m [n_facet][4], settled; NULL: flat. */
void hf_facet_mesh_take_bent(const hf_facets *facets, int i, const double *position_m, const double *sag_m,
                             hf_facet_mesh *mesh);

/* sag_m [n_facet][4]: of the sides of all facets, from the pull of the mesh on the cables between two facets;
 * pull_ratio: the largest N l / T of these cables, INFINITY where one is slack. HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_mesh_sags(double mesh_tension_N_per_m, const hf_facets *facets, const hf_facet_shape *shape,
                             double *sag_m, double *pull_ratio);

/* The same into new memory of the arena; free it in any case. */
hf_status hf_facet_mesh_make_sags(double mesh_tension_N_per_m, const hf_facets *facets, const hf_facet_shape *shape,
                                  hf_arena *arena, double **sag_m, double *pull_ratio);

/* Set bubble_m from sag_m: the mesh has the least area, to the second power of slopes, between its sides. */
void hf_facet_mesh_settle(hf_facet_mesh *mesh);

/* How far the point u, v is lifted; slope: its derivatives by u and v. */
double hf_facet_mesh_lift_m(const hf_facet_mesh *mesh, double u, double v, double slope[2]);

/* The point u, v of the bilinear surface through the corners, and its derivatives by u and v. */
void hf_facet_mesh_at(const hf_facet_mesh *mesh, double u, double v, double p[3], double du[3], double dv[3]);

/* The same of the mesh, with its bubble_m set. */
void hf_facet_mesh_lifted(const hf_facet_mesh *mesh, double u, double v, double p[3], double du[3], double dv[3]);

/* The pillow is of first order in N l / T. Above this the mesh outweighs the cable, and the formula says nothing. */
#define HF_FACET_PULL_MOST 1.0

/* What the mesh pulls on, in words: "a cable with N l = 0.4 of its tension", or "a slack cable". Returns text. */
const char *hf_facet_mesh_pull_words(double pull_ratio, char text[64]);

/* Gauss-Legendre on [0, 1], exact to the ninth power. */
enum { HF_FACET_N_GAUSS = 5 };
extern const double hf_facet_gauss_at[HF_FACET_N_GAUSS], hf_facet_gauss_weight[HF_FACET_N_GAUSS];

#endif
