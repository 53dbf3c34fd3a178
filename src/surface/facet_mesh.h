/* facet_mesh - the pillow shape of a tensioned mesh between cables that deflect under its pull (METHOD section 9). */
#ifndef HIFDM_FACET_MESH_H
#define HIFDM_FACET_MESH_H

#include "surface/facet_rms.h"

enum { HF_FACET_N_BUBBLE = 6 };

/* A facet under its mesh. A point of the bilinear surface through its corners is lifted along the normal. The lift is a
 * sum of arcs along the sides and of functions that vanish at the sides. */
typedef struct {
    const double *corner[4];
    double normal[3];
    bool is_triangle; /* the last two corners are equal; the third side has no length */
    double sag_m[4];  /* height of the middle of side k, from corner k to the next, along the normal */
    double bubble_m[HF_FACET_N_BUBBLE];
} hf_facet_mesh;

/* Sets up a flat facet i for a shape, position_m [n_node][3]. */
void hf_facet_mesh_take(const hf_facets *facets, int i, const double *position_m, hf_facet_mesh *mesh);

/* Sets up facet i bent by sag_m [n_facet][4], with its mesh settled. If sag_m is NULL, the facet is flat. */
void hf_facet_mesh_take_bent(const hf_facets *facets, int i, const double *position_m, const double *sag_m,
                             hf_facet_mesh *mesh);

/* A flat facet of an array [3][n_node] by row, which contains positions or a motion. */
typedef struct {
    double corner[4][3];
    hf_facet_mesh flat;
} hf_facet_gathered;

/* Gathers the corners of a facet, whose rows are row [4]. */
void hf_facet_gather(const double *node, int n_node, const int *row, hf_facet_gathered *facet);

/* Computes sag_m [n_facet][4], the sags of all sides. The pull of the mesh bends the cables between two facets.
 * *pull_ratio is the maximum N l / T of these cables, and INFINITY if one is slack. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_mesh_sags(double mesh_tension_N_per_m, const hf_facets *facets, const hf_facet_shape *shape,
                             double *sag_m, double *pull_ratio);

/* Computes the sags like hf_facet_mesh_sags, in new memory *sag_m of the arena. Free the arena in every case. */
hf_status hf_facet_mesh_make_sags(double mesh_tension_N_per_m, const hf_facets *facets, const hf_facet_shape *shape,
                                  hf_arena *arena, double **sag_m, double *pull_ratio);

/* Returns the lift of the point u, v, m. slope [2]: its derivatives by u and v. */
double hf_facet_mesh_lift_m(const hf_facet_mesh *mesh, double u, double v, double slope[2]);

/* Computes the point u, v of the bilinear surface through the corners, and its derivatives by u and v. */
void hf_facet_mesh_at(const hf_facet_mesh *mesh, double u, double v, double p[3], double du[3], double dv[3]);

/* Computes the point u, v of the mesh, and its derivatives by u and v. bubble_m must be set. */
void hf_facet_mesh_lifted(const hf_facet_mesh *mesh, double u, double v, double p[3], double du[3], double dv[3]);

/* The pillow shape is of first order in N l / T. Above this ratio the mesh is stronger than the cable, and the formula
 * does not hold. */
#define HF_FACET_PULL_MOST 1.0

/* Describes the cable with the maximum pull ratio: "a cable with N l = 0.4 of its tension", or "a slack
 * cable". Returns text. */
const char *hf_facet_mesh_pull_words(double pull_ratio, char text[64]);

/* Gauss-Legendre rule on [0, 1], exact for polynomials of degree 9. */
enum { HF_FACET_N_GAUSS = 5 };
extern const double hf_facet_gauss_at[HF_FACET_N_GAUSS], hf_facet_gauss_weight[HF_FACET_N_GAUSS];

#endif
