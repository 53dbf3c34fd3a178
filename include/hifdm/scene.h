/* scene - what the user described: nodes, cables and the law each cable obeys, supports, loads.
 *
 * A scene is made by a generator or read from CSV files (scene_import), checked once, and never changed afterwards.
 * Lengths in m, forces in N, force densities in N/m. */
#ifndef HIFDM_SCENE_H
#define HIFDM_SCENE_H

#include <hifdm/cable_law.h>
#include <hifdm/status.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum { HF_ROLE_SUPPORT, HF_ROLE_INNER, HF_ROLE_EDGE } hf_role; /* psi counts the inner nodes */
typedef enum { HF_GROUP_INNER, HF_GROUP_BOUNDARY } hf_group;

extern const char *const hf_role_word[3];  /* "support", "inner", "edge" */
extern const char *const hf_group_word[2]; /* "inner", "boundary" */

typedef struct {
    int n_node, n_cable;
    double *position_m;    /* [n_node][3] theoretical position; of supports also the real one */
    double *load_N;        /* [n_node][3], or NULL when nothing is loaded */
    unsigned char *role;   /* [n_node] hf_role */
    int *end;              /* [n_cable][2] node indices */
    unsigned char *group;  /* [n_cable] hf_group */
    unsigned char *law;    /* [n_cable] hf_law: cable_law.h has one potential per law */
    double *target;        /* [n_cable] T* (N), L* (m), q (N/m) or l0 (m) by law; NaN in a tension law: the case's
                                pretension */
    double *EA_N;          /* [n_cable] axial stiffness, NaN where not given; NULL when no cable has one */
    const char **node_id;  /* [n_node] */
    const char **cable_id; /* [n_cable] */
    int *node_line;        /* [n_node] line in nodes_file, or NULL for a generated scene */
    int *cable_line;       /* [n_cable] line in cables_file, or NULL */
    const char *nodes_file, *cables_file; /* names for messages, or NULL */
    void *block, *text;                   /* owned memory behind all of the above */
} hf_scene;

typedef enum { HF_SPACING_EQUAL_ARC, HF_SPACING_EQUAL_PROJECTED } hf_spacing;
typedef enum { HF_BOUNDARY_OUTER_EDGE, HF_BOUNDARY_MODULE_EDGES } hf_boundary;
typedef enum { HF_SUPPORTS_MODULE_CORNERS, HF_SUPPORTS_RIBS, HF_SUPPORTS_PERIMETER } hf_supports;

/* A parabolic cylinder z = x^2/(4 f): x along the directrix, y along the generatrix, origin on the vertex line. */
typedef struct {
    double aperture_m; /* along the directrix (x), symmetric about x = 0 */
    double length_m;   /* along the generatrix (y), from y = 0 */
    double focal_length_m;
    int modules[2];          /* along x, along y */
    int cells_per_module[2]; /* along x, along y */
    int spacing;             /* hf_spacing of the nodes along the directrix */
    int boundary;            /* hf_boundary: which cables are boundary (law length) */
    double scallop;          /* sag of a free outer edge between two supports, relative to their distance */
    int supports;            /* hf_supports */
    double EA_N[2];          /* by hf_group, 0 = not given */
} hf_cylinder;

/* Quad net over the cylinder; node ids n<i>_<j>, cable ids <node>-<node>. Free it with hf_scene_free in any case.
 * HF_BAD_CASE when the net would be too large, HF_NO_MEMORY. */
hf_status hf_scene_parabolic_cylinder(const hf_cylinder *cylinder, hf_scene *scene, hf_messages *messages);

/* Room for a scene of this size, all zero; with_* say which optional arrays exist. HF_OK or HF_NO_MEMORY. */
hf_status hf_scene_allocate(hf_scene *scene, int n_node, int n_cable, int with_load, int with_EA, int with_line);

/* Everything that must hold whatever the scene came from: a free node, an inner node, distinct ends, finite numbers, no
 * cable of zero length, every free node joined to a support. All faults in one go, each naming file, line and id. */
hf_status hf_scene_check(const hf_scene *scene, hf_messages *messages);

double hf_scene_theoretical_length(const hf_scene *scene, int i_cable); /* m, between theoretical positions */

void hf_scene_free(hf_scene *scene);

#ifdef __cplusplus
}
#endif
#endif
