/* scene - what the user described: nodes, cables and the law each cable obeys, supports, loads.
 * Stability: stable.
 *
 * A scene is made by a generator (generate.h) or read from CSV files (scene_import), checked once, and never changed
 * afterwards.
 * Lengths in m, forces in N, force densities in N/m. */
#ifndef HIFDM_SCENE_H
#define HIFDM_SCENE_H

#include <hifdm/api.h>
#include <hifdm/cable_law.h>
#include <hifdm/status.h>
#include <stdbool.h>

HF_API_BEGIN

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
    int n_set;             /* named sets of cables beside the two groups (cable_set.h) */
    const char **set_name; /* [n_set] sorted; NULL, as the next two, when there are no sets */
    int *set_start;        /* [n_set + 1] where the cables of each begin in set_cable */
    int *set_cable;        /* [set_start[n_set]] cables, ascending in each set */
    int n_facet;           /* facets that an import names; 0: they are found (facets.h) */
    int *facet; /* [n_facet][4] nodes, counter-clockwise seen from +z; of a triangle the last two are the same */
    const char **node_id;                 /* [n_node] */
    const char **cable_id;                /* [n_cable] */
    int *node_line;                       /* [n_node] line in nodes_file, or NULL for a generated scene */
    int *cable_line;                      /* [n_cable] line in cables_file, or NULL */
    const char *nodes_file, *cables_file; /* names for messages, or NULL */
    void *block, *text, *set_block;       /* owned memory behind all of the above but `facet`, which is its own */
} hf_scene;

/* Allocate a scene of this size, all zero; with_* tell which optional arrays exist. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_scene_allocate(hf_scene *scene, int n_node, int n_cable, bool with_load, bool with_EA, bool with_line);

/* Check what must hold for every scene, generated or read: a free node, an inner node, distinct ends, finite numbers,
 * no cable of zero length, every free node joined to a support. Reports all faults in one go, each with file, line and
 * id. */
hf_status hf_scene_check(const hf_scene *scene, hf_messages *messages);

#define HF_SCENE_PLACE_SIZE 1324 /* a path, a line and an id of a table; a longer id is cut */

/* Write what a message begins with: "nodes.csv:7: node 'a'", "cables.csv:7: cable 'a'", or "scene: node 'a'". */
void hf_scene_place(const hf_scene *scene, bool is_cable, int index, char *text, size_t size);

/* Count a fault of a node or cable, and report it unless there were HF_FAULT_MAX before: "<place> <what>". */
void hf_scene_fault(const hf_scene *scene, bool is_cable, int index, int *n_fault, const char *what,
                    hf_messages *messages);

double hf_scene_theoretical_length(const hf_scene *scene, int i_cable); /* m, between theoretical positions */

/* In what two nets differ: nodes, their roles or theoretical places, cables or their ends; NULL: in none of these. */
const char *hf_scene_difference(const hf_scene *a, const hf_scene *b);

/* Are these numbers [n] the same but for rounding, as that of two machines? NULL agrees with NULL alone. */
bool hf_scene_numbers_agree(size_t n, const double *a, const double *b);

void hf_scene_free(hf_scene *scene);

HF_API_END
#endif
