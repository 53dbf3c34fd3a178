/* facet_mesh - the facets of a shape, with the pillow shape of a tensioned mesh between cables that deflect under its
 * pull, and the errors of the surface between the nodes (METHOD section 9). */
#pragma once

#include "base/arena.h"
#include "surface/surface_near.h"

/* A shape in the order of the scene. All pointers are borrowed, except those into the block. */
typedef struct {
    const double *position_m; /* [n_node][3] */
    int n_cable;
    const int *end;          /* [n_cable][2] */
    const double *tension_N; /* [n_cable]; NULL (target positions): facets are flat, even with a mesh tension */
    void *block;             /* owned memory of hf_facet_shape_take behind position_m and end, or NULL */
} hf_facet_shape;

/* Makes an hf_facet_shape from a shape of a model, position_m [3][n_node] by row. Borrows tension_N [n_cable]. Returns
 * HF_OK or HF_NO_MEMORY. Free the block in every case. */
hf_status hf_facet_shape_take(const hf_model *model, const double *position_m, const double *tension_N,
                              hf_facet_shape *shape);

/* ---- a facet ---- */

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

/* Gauss-Legendre rule on [0, 1] for flat facets, exact for polynomials of degree 5. */
enum { HF_FACET_N_FLAT = 3 };
extern const double hf_facet_flat_at[HF_FACET_N_FLAT], hf_facet_flat_weight[HF_FACET_N_FLAT];

/* The same for facets with a mesh, exact for polynomials of degree 9. */
enum { HF_FACET_N_GAUSS = 5 };
extern const double hf_facet_gauss_at[HF_FACET_N_GAUSS], hf_facet_gauss_weight[HF_FACET_N_GAUSS];

/* ---- Gauss-Legendre rules for waves ---- */

/* Returns the smallest order, at most `most`, whose error for exp(j phase x), -1 <= x <= 1, is below exp(error_ln). The
 * error bound is phase^(2n) 2^(2n+1) n!^4 / ((2n+1) (2n)!^3). */
int hf_gauss_order(double phase, double error_ln, int most);

/* Computes the rule of order n on [0, 1]: at [n], weight [n]. */
void hf_gauss_rule(int n, double *at, double *weight);

/* ---- errors: RMS over all facets, and of each facet ---- */

/* Sets the members facet_..., n_facet, n_open_face, pillow_rms_m and mesh_pull_ratio of `to`, but no losses of gain.
 * The errors are NaN without facets. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_measure(const hf_surface_settings *settings, const hf_facets *facets, const hf_facet_shape *shape,
                           hf_surface_measures *to);

/* Finds the best fit to the facets of a shape, with its parameters. It has not converged if the mesh has no shape.
 * Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_fit(const hf_surface_settings *settings, const hf_facets *facets, const hf_facet_shape *shape,
                       hf_surface_fit *fit, hf_fit_parameters *parameters);

/* Computes facet_half_path_rms_m and facet_fit_half_path_rms_m as hf_facet_measure does. The fit starts from that of a
 * similar shape. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_measure_near(const hf_surface_pose *from, const hf_surface_settings *settings,
                                const hf_facets *facets, const hf_facet_shape *shape, double *half_path_rms_m,
                                double *fit_half_path_rms_m);

/* Errors of each facet along the normal, [n_facet], weighted by projected area: mean and RMS, against the target
 * surface and against the best fit to all facets (NaN if it does not converge). */
typedef struct {
    double *normal_mean_m, *normal_rms_m, *fit_normal_mean_m, *fit_normal_rms_m;
} hf_facet_errors;

/* Computes the errors of each facet. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_map(const hf_surface_settings *settings, const hf_facets *facets, const hf_facet_shape *shape,
                       const hf_facet_errors *to);
