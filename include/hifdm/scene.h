/* scene - the net as the user describes it: nodes, supports, loads, cables and the law of each cable.
 * Stability: stable.
 *
 * A scene comes from a generator (generate.h), from arrays (scene_arrays.h) or from CSV files (scene_import.h). A
 * scene is checked once and does not change afterwards. Lengths are in m, forces in N and force densities in N/m. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/cable_law.h>
#include <hifdm/status.h>
#include <stdbool.h>

HF_API_BEGIN

/* role of a node; psi includes only inner nodes */
typedef enum { HF_ROLE_SUPPORT, HF_ROLE_INNER, HF_ROLE_EDGE } hf_role;
typedef enum { HF_GROUP_INNER, HF_GROUP_BOUNDARY } hf_group; /* group of a cable */

extern const char *const hf_role_word[3];  /* "support", "inner", "edge" */
extern const char *const hf_group_word[2]; /* "inner", "boundary" */

/* Describes the nodes and cables of a net. */
typedef struct {
    int n_node, n_cable;  /* numbers of nodes and cables */
    double *position_m;   /* [n_node][3] target positions; for supports also the actual positions */
    double *load_N;       /* [n_node][3] loads; NULL: no loads */
    unsigned char *role;  /* [n_node] role of each node (hf_role) */
    int *end;             /* [n_cable][2] nodes at the ends of each cable */
    unsigned char *group; /* [n_cable] group of each cable (hf_group) */
    unsigned char *law;   /* [n_cable] law of each cable (hf_law) */
    /* [n_cable] target value by law: T* (N), L* (m), q (N/m) or l0 (m); NaN with law tension: pretension_N */
    double *target;
    double *EA_N;          /* [n_cable] axial stiffness; NaN: not given; NULL: no cable has one */
    int n_set;             /* number of named sets of cables, in addition to the two groups (cable_set.h) */
    const char **set_name; /* [n_set] names sorted by strcmp; NULL without sets */
    int *set_start;        /* [n_set + 1] first cable of each set in set_cable; NULL without sets */
    int *set_cable;        /* [set_start[n_set]] cables, in ascending order in each set; NULL without sets */
    int n_facet;           /* number of facets that an import defines; 0: hf_facets_find finds the facets */
    int *facet;           /* [n_facet][4] nodes, counter-clockwise seen from +z; the last two of a triangle are equal */
    const char **node_id; /* [n_node] ids of the nodes */
    const char **cable_id;                /* [n_cable] ids of the cables */
    int *node_line;                       /* [n_node] line in nodes_file; NULL for a generated scene */
    int *cable_line;                      /* [n_cable] line in cables_file; NULL for a generated scene */
    const char *nodes_file, *cables_file; /* file names for messages; may be NULL */
    void *block, *text, *set_block; /* owned memory behind all arrays above except `facet`, which is owned separately */
} hf_scene;

/* Allocates a scene with n_node nodes and n_cable cables. All values of the scene are zero. The arguments with_load,
 * with_EA and with_line state whether load_N, EA_N and the line numbers exist. Returns HF_OK or HF_NO_MEMORY. Call
 * hf_scene_free even if hf_scene_allocate fails. */
hf_status hf_scene_allocate(hf_scene *scene, int n_node, int n_cable, bool with_load, bool with_EA, bool with_line);

/* Checks the rules that every generated or imported scene must satisfy. A scene needs a free node, an inner node and a
 * support. All numbers of the scene must be finite. Each cable needs two different ends and a length. An elastic cable
 * also needs EA and an unstressed length. A path of cables must lead from every free node to a support. If the nodes
 * have faults, the function does not check the cables. The function writes one message with file, line and id for each
 * fault. If there are more than HF_FAULT_MAX faults, the function writes only the number of the remaining faults.
 * Returns HF_OK, HF_BAD_CASE or HF_NO_MEMORY. */
hf_status hf_scene_check(const hf_scene *scene, hf_messages *messages);

#define HF_SCENE_LOCATION_SIZE 1324 /* size for a path, a line and an id of a table; a longer id is truncated */

/* Writes the beginning of a message about a node or cable to text[size]. For example, the function writes "nodes.csv:7:
 * node 'a'" or "cables.csv:7: cable 'a'". If the scene has no file, the function writes, for example, "scene: node
 * 'a'". */
void hf_scene_location(const hf_scene *scene, bool is_cable, int index, char *text, size_t size);

/* Increments the number of faults *n_fault and adds the message "<location> <what>" about a node or cable. After
 * HF_FAULT_MAX faults, the function only counts faults and adds no messages. */
void hf_scene_fault(const hf_scene *scene, bool is_cable, int index, int *n_fault, const char *what,
                    hf_messages *messages);

/* Returns the distance in m between the target positions of the ends of cable i_cable. */
double hf_scene_length_at_target(const hf_scene *scene, int i_cable);

/* Returns the first difference between two nets as a constant string. The function compares nodes, their roles and
 * target positions, cables, and the ends of cables. Returns NULL if the function finds no difference between the two
 * nets. */
const char *hf_scene_difference(const hf_scene *a, const hf_scene *b);

/* Returns true if the arrays a [n] and b [n] are equal up to rounding. The tolerance is 1e-9 of the maximum absolute
 * value in the array `a`. A tolerance is necessary because results of two machines differ by rounding. If one array is
 * NULL, the arrays are equal only if the other array is also NULL. */
bool hf_scene_numbers_agree(size_t n, const double *a, const double *b);

/* Frees all memory of the scene. */
void hf_scene_free(hf_scene *scene);

HF_API_END
