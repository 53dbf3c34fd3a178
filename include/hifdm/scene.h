/* scene - the net as the user described it: nodes, supports, loads, cables and the law of each cable.
 * Stability: stable.
 *
 * A scene is made by a generator (generate.h), from arrays (scene_arrays.h), or from CSV files (scene_import). It is
 * checked once and does not change afterwards. Lengths are in m, forces in N, force densities in N/m. */
#ifndef HIFDM_SCENE_H
#define HIFDM_SCENE_H

#include <hifdm/api.h>
#include <hifdm/cable_law.h>
#include <hifdm/status.h>
#include <stdbool.h>

HF_API_BEGIN

typedef enum { HF_ROLE_SUPPORT, HF_ROLE_INNER, HF_ROLE_EDGE } hf_role; /* role of a node; psi counts the inner nodes */
typedef enum { HF_GROUP_INNER, HF_GROUP_BOUNDARY } hf_group;           /* group of a cable */

extern const char *const hf_role_word[3];  /* "support", "inner", "edge" */
extern const char *const hf_group_word[2]; /* "inner", "boundary" */

/* Nodes and cables of a net. */
typedef struct {
    int n_node, n_cable;   /* numbers of nodes and cables */
    double *position_m;    /* [n_node][3] target positions; of supports also the real ones */
    double *load_N;        /* [n_node][3] loads, or NULL without loads */
    unsigned char *role;   /* [n_node] hf_role */
    int *end;              /* [n_cable][2] nodes at the ends */
    unsigned char *group;  /* [n_cable] hf_group */
    unsigned char *law;    /* [n_cable] hf_law */
    double *target;        /* [n_cable] T* (N), L* (m), q (N/m) or l0 (m) by law; NaN for law tension: pretension_N */
    double *EA_N;          /* [n_cable] axial stiffness, NaN where not given; NULL if no cable has one */
    int n_set;             /* number of named sets of cables besides the two groups (cable_set.h) */
    const char **set_name; /* [n_set] sorted by strcmp; NULL without sets */
    int *set_start;        /* [n_set + 1] first cable of each set in set_cable; NULL without sets */
    int *set_cable;        /* [set_start[n_set]] cables, ascending in each set; NULL without sets */
    int n_facet;           /* number of facets that an import names; 0: hf_facets_find finds them */
    int *facet;           /* [n_facet][4] nodes, counter-clockwise seen from +z; the last two of a triangle are equal */
    const char **node_id; /* [n_node] ids */
    const char **cable_id;                /* [n_cable] ids */
    int *node_line;                       /* [n_node] line in nodes_file, or NULL for a generated scene */
    int *cable_line;                      /* [n_cable] line in cables_file, or NULL for a generated scene */
    const char *nodes_file, *cables_file; /* file names for messages, or NULL */
    void *block, *text, *set_block; /* owned memory behind all of the above except `facet`, which is owned alone */
} hf_scene;

/* Allocates a scene of this size, all zero. with_load, with_EA and with_line say whether load_N, EA_N and the line
 * numbers exist. Returns HF_OK or HF_NO_MEMORY. Call hf_scene_free in either case. */
hf_status hf_scene_allocate(hf_scene *scene, int n_node, int n_cable, bool with_load, bool with_EA, bool with_line);

/* Checks what must hold for every scene, generated or read. It has a free node, an inner node and a support, and all
 * numbers are finite. Each cable has two different ends and a length, and an elastic cable has EA and an unstressed
 * length. A path of cables leads from every free node to a support. Cables are checked if the nodes have no faults.
 * Writes one message for each fault, with file, line and id; beyond HF_FAULT_MAX faults it writes only their number.
 * Returns HF_OK; HF_BAD_CASE; HF_NO_MEMORY. */
hf_status hf_scene_check(const hf_scene *scene, hf_messages *messages);

#define HF_SCENE_LOCATION_SIZE 1324 /* a path, a line and an id of a table; a longer id is cut */

/* Writes the beginning of a message about a node or cable into text[size]: "nodes.csv:7: node 'a'", "cables.csv:7:
 * cable 'a'", or "scene: node 'a'" without a file. */
void hf_scene_location(const hf_scene *scene, bool is_cable, int index, char *text, size_t size);

/* Counts a fault of a node or cable in *n_fault and adds the message "<location> <what>". Beyond HF_FAULT_MAX faults it
 * only counts. */
void hf_scene_fault(const hf_scene *scene, bool is_cable, int index, int *n_fault, const char *what,
                    hf_messages *messages);

/* Returns the length of cable i_cable between the target positions of its ends, m. */
double hf_scene_length_at_target(const hf_scene *scene, int i_cable);

/* Returns in what two nets differ, as a constant string: nodes, their roles or target positions, cables, or their ends.
 * Returns NULL if they agree in all of these. */
const char *hf_scene_difference(const hf_scene *a, const hf_scene *b);

/* Returns true if the numbers a [n] and b [n] are equal up to rounding, which is 1e-9 of the maximum absolute value of
 * a. Results of two machines differ by rounding. NULL agrees with NULL only. */
bool hf_scene_numbers_agree(size_t n, const double *a, const double *b);

/* Frees all memory of the scene. */
void hf_scene_free(hf_scene *scene);

HF_API_END
#endif
