/* generate - nets that generators make from a few values in a section scene.NAME of the case file.
 * Stability: stable.
 *
 * Pipeline: settings of the section -> hf_scene_NAME_fault, which checks the case -> hf_scene_NAME -> scene.
 *
 * A new generator NAME with settings of type hf_TYPE needs one row of HF_GENERATORS, its settings and its keys in this
 * header. The file src/net/generate_NAME.c of a generator has three functions:
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

/* Each generator is one row X(name of the section, type of the settings, keys, help). `hifdm schema` lists the
 * generators in this order. */
#define HF_GENERATORS(X)                                                                                               \
    X(parabolic_cylinder, hf_cylinder, HF_CYLINDER_KEYS, "A net over a parabolic cylinder.")                           \
    X(paraboloid, hf_paraboloid, HF_PARABOLOID_KEYS,                                                                   \
      "A net over a paraboloid with a round aperture, with or without a rear net.")
/* Help of the section scene. The help states the number of generators plus one for import. */
#define HF_GENERATORS_HELP "The net. A case has exactly one of the three sections below."

#define HF_GENERATE_FAULT_SIZE 256 /* size in bytes of the reason why a net cannot be made */

/* ---- rear nets, which several generators can make ---- */

/* The direction of the ties between the nets of a double net. */
typedef enum { HF_TIES_ALONG_Z, HF_TIES_ALONG_NORMAL } hf_tie_direction;

/* Members that all settings with a rear net have. The rim of the rear net is rear_distance_m below the rim of the front
 * net. The rear net bulges towards the front net. */
#define HF_DOUBLE_NET_MEMBERS                                                                                          \
    double rear_distance_m;         /* distance between the rims; 0: no rear net */                                    \
    double rear_focal_length_m;     /* focal length of the rear net; 0: the focal length of the front net */           \
    hf_tie_direction tie_direction; /* direction of the ties */                                                        \
    hf_law tie_law;                 /* law of the ties */                                                              \
    double tie_tension_N; /* tension of the ties at the target positions (laws tension, force_density, elastic) */

/* Keys of these members, as rows X(section, member, type, minimum, maximum, default, unit, words, help) of
 * hf_field_table (config.h). */
#define HF_DOUBLE_NET_KEYS(X, section)                                                                                 \
    X(section, rear_distance_m, HF_FIELD_DOUBLE, 0, 1e4, "0", "m", NULL,                                               \
      "Distance of the rim of a rear net below the rim of the front net. Ties join the free nodes of the two nets. "   \
      "0: no rear net")                                                                                                \
    X(section, rear_focal_length_m, HF_FIELD_DOUBLE, 0, 1e9, "0", "m", NULL,                                           \
      "Focal length of the rear net, which is curved towards the front net. 0: the focal length of the front net")     \
    X(section, tie_direction, HF_FIELD_WORD, 0, 0, "z", "", HF_WORDS("z", "normal"),                                   \
      "Direction of the ties: z, or the normal of the front net")                                                      \
    X(section, tie_law, HF_FIELD_WORD, 0, 0, "length", "", ((const char *const[]){HF_LAW_LIST(HF_LAW_WORD) NULL}),     \
      "Law of the ties. The nets have law tension, and their boundary cables law length")                              \
    X(section, tie_tension_N, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e9, "1", "N", NULL,                                     \
      "Tension of the ties at the target positions, for the laws tension, force_density and elastic")

/* ---- parabolic_cylinder ---- */

/* Spacing of the nodes: equal arc length or equal projected length. */
typedef enum { HF_SPACING_EQUAL_ARC, HF_SPACING_EQUAL_PROJECTED } hf_spacing;
/* Cables that are boundary cables. */
typedef enum { HF_BOUNDARY_OUTER_EDGE, HF_BOUNDARY_MODULE_EDGES } hf_boundary;
/* Nodes that are supports. */
typedef enum { HF_SUPPORTS_MODULE_CORNERS, HF_SUPPORTS_RIBS, HF_SUPPORTS_PERIMETER } hf_supports;
/* Pattern of the cables. */
typedef enum { HF_PATTERN_QUAD, HF_PATTERN_TRIANGLE, HF_PATTERN_DIAGONAL, HF_PATTERN_ALTERNATING } hf_pattern;

/* Words of hf_spacing in a case file. The last entry of the array is NULL. */
extern const char *const hf_spacing_word[3];

/* A net over the parabolic cylinder z = x^2/(4 f). The x axis runs along the directrix and the y axis along the
 * generatrix. The origin is on the vertex line. */
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

/* Keys of the section, as rows X(section, member, type, minimum, maximum, default, unit, words, help) of hf_field_table
 * (config.h). */
#define HF_CYLINDER_KEYS(X, section)                                                                                   \
    X(section, aperture_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e4, NULL, "m", NULL, "Aperture along the directrix (x)")   \
    X(section, length_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e4, NULL, "m", NULL, "Length along the generatrix (y)")      \
    X(section, focal_length_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e9, NULL, "m", NULL, "Focal length of z = x^2/(4f)")   \
    X(section, modules, HF_FIELD_INT_PAIR, 1, 2000, NULL, "", NULL,                                                    \
      "Number of modules along the directrix and the generatrix")                                                      \
    X(section, cells_per_module, HF_FIELD_INT_PAIR, 1, 2000, NULL, "", NULL,                                           \
      "Number of net cells per module, along the directrix and the generatrix")                                        \
    X(section, pitches_x_m, HF_FIELD_DOUBLE_LIST, HF_ABOVE_ZERO, 1e4, "[]", "m", NULL,                                 \
      "Projected widths of the modules along x, from the left. Their sum must be aperture_m. Within each module "      \
      "the cells are equal, as spacing says. Without this key, all modules are equal")                                 \
    X(section, pitches_y_m, HF_FIELD_DOUBLE_LIST, HF_ABOVE_ZERO, 1e4, "[]", "m", NULL,                                 \
      "Lengths of the modules along y. Their sum must be length_m. Without this key, all modules are equal")           \
    X(section, pattern, HF_FIELD_WORD, 0, 0, "quad", "", HF_WORDS("quad", "triangle", "diagonal", "alternating"),      \
      "quad has cables along x and y. triangle adds one diagonal per cell, all in the same direction. alternating "    \
      "adds one diagonal per cell, in alternating directions. diagonal has four half diagonals per cell that meet "    \
      "in a node at its middle, and the boundary cables along x and y. All patterns except quad omit cables "          \
      "between two supports")                                                                                          \
    X(section, spacing, HF_FIELD_WORD, 0, 0, "equal_arc", "", hf_spacing_word,                                         \
      "Spacing of the nodes along the directrix: equal arc length, or equal projected (x) spacing")                    \
    X(section, boundary, HF_FIELD_WORD, 0, 0, "outer_edge", "", HF_WORDS("outer_edge", "module_edges"),                \
      "Which cables are boundary cables (law length). The other cables are inner cables (law tension)")                \
    X(section, scallop, HF_FIELD_DOUBLE, 0, 0.4, "0", "", NULL,                                                        \
      "Inward sag of a free outer edge between two supports, as a fraction of their distance. The edge is a "          \
      "parabola")                                                                                                      \
    X(section, supports, HF_FIELD_WORD, 0, 0, "module_corners", "", HF_WORDS("module_corners", "ribs", "perimeter"),   \
      "Fixed nodes: all module corners, all nodes on ribs (y = module border), or the perimeter")                      \
    X(section, edge_tie_m, HF_FIELD_DOUBLE, 0, 1e3, "0", "m", NULL,                                                    \
      "Length of the edge ties, which are boundary cables with law length. They connect the nodes of the outer "       \
      "edge to supports outside of the edge. The ties run along x or y, and along both at the corners of the net. "    \
      "0: the nodes of the outer edge are supports themselves")                                                        \
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
 * behind the front supports, in the direction of the ties. EA_N [2] has the axial stiffness in N by hf_group. The value
 * 0 means that the stiffness of a group is not given. NULL means that neither is given. Returns HF_OK or HF_NO_MEMORY.
 * Returns HF_BAD_CASE if the net would be too large, if elastic ties have no EA, or if
 * hf_scene_parabolic_cylinder_fault finds a fault. Call hf_scene_free even after a failure. */
hf_status hf_scene_parabolic_cylinder(const hf_cylinder *cylinder, const double EA_N[2], hf_scene *scene,
                                      hf_messages *messages);
/* Returns the member whose value cannot be realised and writes the reason to what[size]. Returns NULL if there is no
 * fault. */
const char *hf_scene_parabolic_cylinder_fault(const hf_cylinder *cylinder, char *what, size_t size);
/* Sets kind and focal length in *surface, and also the strip width if the strips are equal. Before the call, *surface
 * must be all zero. */
void hf_scene_parabolic_cylinder_surface(const hf_cylinder *cylinder, hf_surface_settings *surface);

/* ---- paraboloid ---- */

/* The grid of a net over a paraboloid. */
typedef enum { HF_GRID_TRIANGLE, HF_GRID_QUAD } hf_grid;

/* A net over the paraboloid z = (x^2 + y^2)/(4 f). The net is above the circle of the aperture, whose centre is at x =
 * offset_m. The rim of the front net is in the plane z_rim(x). The rear net is the surface z_rim - rear_distance_m +
 * (R^2 - r^2)/(4 f_rear). In this equation, r is the distance from the axis of the aperture, and R is the radius of the
 * aperture. */
typedef struct {
    double aperture_m;     /* diameter of the aperture */
    double focal_length_m; /* focal length f */
    double offset_m;       /* distance along x from the axis to the centre of the aperture */
    int rings;             /* number of cells from the centre to the rim */
    hf_grid grid;          /* grid of the cables */
    hf_spacing spacing;    /* spacing of the nodes along a radius */
    HF_DOUBLE_NET_MEMBERS
} hf_paraboloid;

/* Keys of the section, in the form of HF_CYLINDER_KEYS. */
#define HF_PARABOLOID_KEYS(X, section)                                                                                 \
    X(section, aperture_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e4, NULL, "m", NULL, "Diameter of the aperture")           \
    X(section, focal_length_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e9, NULL, "m", NULL,                                   \
      "Focal length of z = (x^2 + y^2)/(4f)")                                                                          \
    X(section, offset_m, HF_FIELD_DOUBLE, 0, 1e4, "0", "m", NULL,                                                      \
      "Distance of the middle of the aperture from the axis, along x. 0: a centre-fed reflector")                      \
    X(section, rings, HF_FIELD_INT, 1, 1000, NULL, "", NULL,                                                           \
      "Number of cells from the middle of the aperture to its rim")                                                    \
    X(section, grid, HF_FIELD_WORD, 0, 0, "triangle", "", HF_WORDS("triangle", "quad"),                                \
      "triangle has three families of cables, with rings of 6, 12, 18, ... nodes. The nodes of the last ring are "     \
      "supports on the rim. quad has cables along x and y that end at supports on the rim")                            \
    X(section, spacing, HF_FIELD_WORD, 0, 0, "equal_projected", "", hf_spacing_word,                                   \
      "Spacing of the nodes along a radius of the aperture: equal projected spacing, or equal arc length on a "        \
      "paraboloid around the middle of the aperture")                                                                  \
    HF_DOUBLE_NET_KEYS(X, section)

/* Makes the net over the paraboloid.
 *
 *   ids of nodes    f<ring>_<k> of the front net, r<ring>_<k> of the rear net; with grid quad f<i>_<j> by rows, and
 *                   fs<k> for supports
 *   ids of cables   <node>-<node>
 *   sets            front, front_edge (cables that end at a support); with a rear net also rear, rear_edge, tie
 *
 * Free nodes of the rear net have the role edge, so psi includes only nodes of the front net. The rear supports are
 * vertically below the front supports. EA_N, errors and ownership are the same as for hf_scene_parabolic_cylinder. */
hf_status hf_scene_paraboloid(const hf_paraboloid *paraboloid, const double EA_N[2], hf_scene *scene,
                              hf_messages *messages);
/* Finds the supports of the front net in the order of their angle from x towards y. The function sets *n to the number
 * of supports and *position_m to an array of their positions [n][3] in m. The array *position_m is allocated with
 * malloc. The caller must free it even after a failure. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_paraboloid_rim(const hf_paraboloid *paraboloid, int *n, double **position_m);
/* Returns the member whose value cannot be realised and writes the reason to what[size]. Returns NULL if there is no
 * fault. */
const char *hf_scene_paraboloid_fault(const hf_paraboloid *paraboloid, char *what, size_t size);
/* Sets kind and focal length in *surface, which must be all zero before the call. */
void hf_scene_paraboloid_surface(const hf_paraboloid *paraboloid, hf_surface_settings *surface);

HF_API_END
