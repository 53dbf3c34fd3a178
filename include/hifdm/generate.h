/* generate - nets that generators make from a few values in a section scene.NAME of the case file.
 * Stability: stable.
 *
 * Pipeline: settings of the section -> hf_scene_NAME_fault, which checks the case -> hf_scene_NAME -> scene.
 *
 * To add a generator NAME, define its struct of settings hf_TYPE, its keys and one row of HF_GENERATORS in this header.
 * The file src/net/generate_NAME.c of a generator has three functions:
 *
 *   hf_scene_NAME         const hf_TYPE *, const double EA_N[2], hf_scene *, hf_messages * -> hf_status
 *                         makes the scene
 *   hf_scene_NAME_fault   const hf_TYPE *, char what[size], size -> the member whose value cannot be realised, or NULL;
 *                         writes the reason to `what` (HF_GENERATE_FAULT_SIZE is sufficient); the time does not
 *                         depend on the size of the net
 *   hf_scene_NAME_surface const hf_TYPE *, hf_surface_settings *, which is all zero -> sets the members that the net
 *                         determines: kind, focal length, strip width; the others remain 0
 *
 * The row defines the key table, the loading and checking of the section, its help and the creation of the scene. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/cable_law.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>

HF_API_BEGIN

/* Each row X(name of the section, type of the settings, keys) defines one generator. `hifdm schema` lists the
 * generators in this order. */
#define HF_GENERATORS(X)                                                                                               \
    X(parabolic_cylinder, hf_cylinder, HF_CYLINDER_KEYS)                                                               \
    X(paraboloid, hf_paraboloid, HF_PARABOLOID_KEYS)
#define HF_GENERATE_FAULT_SIZE 256 /* size in bytes of the reason why a net cannot be made */

/* ---- rear nets, which several generators can make ---- */

/* The ties between the two nets of a double net run along z or along the normal of the front net. */
typedef enum { HF_TIES_ALONG_Z, HF_TIES_ALONG_NORMAL } hf_tie_direction;

/* Defines the members that the settings of each generator with a rear net contain. The rim of the rear net is
 * rear_distance_m below the rim of the front net. The rear net bulges towards the front net. */
#define HF_DOUBLE_NET_MEMBERS                                                                                          \
    double rear_distance_m;         /* distance between the rims; 0: no rear net */                                    \
    double rear_focal_length_m;     /* focal length of the rear net; 0: the focal length of the front net */           \
    hf_tie_direction tie_direction; /* direction of the ties */                                                        \
    hf_law tie_law;                 /* law of the ties */                                                              \
    double tie_tension_N; /* tension of the ties at the target positions (laws tension, force_density, elastic) */

/* Each row X(section, member, type, minimum, maximum, default, unit, words) defines the key of one of these
 * members in hf_field_table (config.h). */
#define HF_DOUBLE_NET_KEYS(X, section)                                                                                 \
    X(section, rear_distance_m, HF_FIELD_DOUBLE, 0, 1e4, "0", "m", NULL)                                               \
    X(section, rear_focal_length_m, HF_FIELD_DOUBLE, 0, 1e9, "0", "m", NULL)                                           \
    X(section, tie_direction, HF_FIELD_WORD, 0, 0, "z", "", HF_WORDS("z", "normal"))                                   \
    X(section, tie_law, HF_FIELD_WORD, 0, 0, "length", "", ((const char *const[]){HF_LAW_LIST(HF_LAW_WORD) NULL}))     \
    X(section, tie_tension_N, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e9, "1", "N", NULL)

/* ---- parabolic_cylinder ---- */

/* The nodes have equal spacing in arc length or in projected length. */
typedef enum { HF_SPACING_EQUAL_ARC, HF_SPACING_EQUAL_PROJECTED } hf_spacing;
/* Cables that are boundary cables. */
typedef enum { HF_BOUNDARY_OUTER_EDGE, HF_BOUNDARY_MODULE_EDGES } hf_boundary;
/* Nodes that are supports. */
typedef enum { HF_SUPPORTS_MODULE_CORNERS, HF_SUPPORTS_RIBS, HF_SUPPORTS_PERIMETER } hf_supports;
/* Pattern of the cables. */
typedef enum { HF_PATTERN_QUAD, HF_PATTERN_TRIANGLE, HF_PATTERN_DIAGONAL, HF_PATTERN_ALTERNATING } hf_pattern;

/* Contains the words of hf_spacing in a case file. The last entry of the array is NULL. */
extern const char *const hf_spacing_word[3];

/* Describes a net over the parabolic cylinder z = x^2/(4 f). The x axis runs along the directrix and the y axis along
 * the generatrix. The origin is on the vertex line. */
typedef struct {
    double aperture_m;       /* aperture along the directrix (x), symmetric about x = 0 */
    double length_m;         /* length along the generatrix (y), from y = 0 */
    double focal_length_m;   /* focal length f */
    int modules[2];          /* numbers of modules along x and y */
    int cells_per_module[2]; /* numbers of cells of a module along x and y */
    /* lengths of the modules from x = -aperture_m/2 and from y = 0; empty: equal lengths */
    hf_double_list pitches_x_m, pitches_y_m;
    hf_pattern pattern;   /* pattern of the cables */
    hf_spacing spacing;   /* spacing of the nodes along the directrix */
    hf_boundary boundary; /* cables that are boundary cables (law length) */
    double scallop;       /* inward sag of a free outer edge between two supports, divided by their distance */
    hf_supports supports; /* nodes that are supports */
    double edge_tie_m;    /* distance along x or y from the outer edge to the supports of edge ties; 0: no ties */
    HF_DOUBLE_NET_MEMBERS
} hf_cylinder;

/* Each row X(section, member, type, minimum, maximum, default, unit, words) defines a key of the section in
 * hf_field_table (config.h). */
#define HF_CYLINDER_KEYS(X, section)                                                                                   \
    X(section, aperture_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e4, NULL, "m", NULL)                                       \
    X(section, length_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e4, NULL, "m", NULL)                                         \
    X(section, focal_length_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e9, NULL, "m", NULL)                                   \
    X(section, modules, HF_FIELD_INT_PAIR, 1, 2000, NULL, "", NULL)                                                    \
    X(section, cells_per_module, HF_FIELD_INT_PAIR, 1, 2000, NULL, "", NULL)                                           \
    X(section, pitches_x_m, HF_FIELD_DOUBLE_LIST, HF_ABOVE_ZERO, 1e4, "[]", "m", NULL)                                 \
    X(section, pitches_y_m, HF_FIELD_DOUBLE_LIST, HF_ABOVE_ZERO, 1e4, "[]", "m", NULL)                                 \
    X(section, pattern, HF_FIELD_WORD, 0, 0, "quad", "", HF_WORDS("quad", "triangle", "diagonal", "alternating"))      \
    X(section, spacing, HF_FIELD_WORD, 0, 0, "equal_arc", "", hf_spacing_word)                                         \
    X(section, boundary, HF_FIELD_WORD, 0, 0, "outer_edge", "", HF_WORDS("outer_edge", "module_edges"))                \
    X(section, scallop, HF_FIELD_DOUBLE, 0, 0.4, "0", "", NULL)                                                        \
    X(section, supports, HF_FIELD_WORD, 0, 0, "module_corners", "", HF_WORDS("module_corners", "ribs", "perimeter"))   \
    X(section, edge_tie_m, HF_FIELD_DOUBLE, 0, 1e3, "0", "m", NULL)                                                    \
    HF_DOUBLE_NET_KEYS(X, section)

/* Makes the net over the parabolic cylinder.
 *
 *   ids of nodes    n<i>_<j>; m<i>_<j> in the middle of cells; s<i>_<j> for the support of n<i>_<j> at an edge tie;
 *                   after them r<i>_<j>, rm<i>_<j>, rs<i>_<j> of the rear net
 *   ids of cables   <node>-<node>
 *   sets            directrix (along x), generatrix (along y), diagonal, edge (of the outer edge), edge_tie; with a
 *                   rear net also front (all of the former), rear, tie, and rear_directrix and so on
 *
 * Free nodes of the rear net have the role edge, so psi includes only nodes of the front net. The rear supports are
 * behind the front supports, in the direction of the ties. The array EA_N [2] contains the axial stiffness in N of each
 * group (hf_group). The value 0 means that the stiffness of a group is not given. If EA_N is NULL, no axial stiffness
 * is given. Returns HF_OK or HF_NO_MEMORY. Returns HF_BAD_CASE if the net would be too large or if elastic ties have no
 * EA. Returns HF_BAD_CASE also if hf_scene_parabolic_cylinder_fault finds a fault. Call hf_scene_free even if
 * hf_scene_parabolic_cylinder fails. */
hf_status hf_scene_parabolic_cylinder(const hf_cylinder *cylinder, const double EA_N[2], hf_scene *scene,
                                      hf_messages *messages);
/* Returns the name of the member whose value cannot be realised, and writes the reason to what[size]. Returns NULL if
 * there is no fault. */
const char *hf_scene_parabolic_cylinder_fault(const hf_cylinder *cylinder, char *what, size_t size);
/* Sets the kind and the focal length in *surface. If the strips are equal, the function also sets the strip width.
 * Before the call, all members of *surface must be zero. */
void hf_scene_parabolic_cylinder_surface(const hf_cylinder *cylinder, hf_surface_settings *surface);

/* ---- paraboloid ---- */

/* Defines the grid of a net over a paraboloid. */
typedef enum { HF_GRID_TRIANGLE, HF_GRID_QUAD } hf_grid;

/* Describes a net over the paraboloid z = (x^2 + y^2)/(4 f). The net is above the circular aperture. The centre of the
 * aperture is at x = offset_m. The rim of the front net is in the plane z_rim(x). The equation of the rear net is z =
 * z_rim - rear_distance_m + (R^2 - r^2)/(4 f_rear). In this equation, r is the distance from the axis of the aperture,
 * and R is the radius of the aperture. */
typedef struct {
    double aperture_m;     /* diameter of the aperture */
    double focal_length_m; /* focal length f */
    double offset_m;       /* distance along x from the axis to the centre of the aperture */
    int rings;             /* number of cells from the centre to the rim */
    hf_grid grid;          /* grid of the cables */
    hf_spacing spacing;    /* spacing of the nodes along a radius */
    HF_DOUBLE_NET_MEMBERS
} hf_paraboloid;

/* Defines the keys of the section in the form of HF_CYLINDER_KEYS. */
#define HF_PARABOLOID_KEYS(X, section)                                                                                 \
    X(section, aperture_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e4, NULL, "m", NULL)                                       \
    X(section, focal_length_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e9, NULL, "m", NULL)                                   \
    X(section, offset_m, HF_FIELD_DOUBLE, 0, 1e4, "0", "m", NULL)                                                      \
    X(section, rings, HF_FIELD_INT, 1, 1000, NULL, "", NULL)                                                           \
    X(section, grid, HF_FIELD_WORD, 0, 0, "triangle", "", HF_WORDS("triangle", "quad"))                                \
    X(section, spacing, HF_FIELD_WORD, 0, 0, "equal_projected", "", hf_spacing_word)                                   \
    HF_DOUBLE_NET_KEYS(X, section)

/* Makes the net over the paraboloid.
 *
 *   ids of nodes    f<ring>_<k> of the front net, r<ring>_<k> of the rear net; with grid quad f<i>_<j> by rows, and
 *                   fs<k> for supports
 *   ids of cables   <node>-<node>
 *   sets            front, front_edge (cables that end at a support); with a rear net also rear, rear_edge, tie
 *
 * Free nodes of the rear net have the role edge, so psi includes only nodes of the front net. The rear supports are
 * vertically below the front supports. The rules of hf_scene_parabolic_cylinder for EA_N, errors and ownership also
 * apply to this function. */
hf_status hf_scene_paraboloid(const hf_paraboloid *paraboloid, const double EA_N[2], hf_scene *scene,
                              hf_messages *messages);
/* Finds the supports of the front net, sorted by their angle from x towards y. The function sets *n to the number of
 * supports. The array *position_m [n][3] contains the positions of the supports in m. The function allocates the array
 * *position_m with malloc. The caller must free *position_m even if the function fails. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_paraboloid_rim(const hf_paraboloid *paraboloid, int *n, double **position_m);
/* Returns the name of the member whose value cannot be realised, and writes the reason to what[size]. Returns NULL if
 * there is no fault. */
const char *hf_scene_paraboloid_fault(const hf_paraboloid *paraboloid, char *what, size_t size);
/* Sets the kind and the focal length in *surface. Before the call, all members of *surface must be zero. */
void hf_scene_paraboloid_surface(const hf_paraboloid *paraboloid, hf_surface_settings *surface);

HF_API_END
