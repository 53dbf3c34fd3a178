/* truss - the deployable truss that carries the net: nodes, straight members with their sections, supports.
 * Stability: stable.
 *
 * A truss is made by a generator or read from CSV files (truss_import), checked once, and never changed afterwards;
 * hf_frame solves it. Dofs of a node: displacement along x, y, z (m), rotation about x, y, z (rad). */
#ifndef HIFDM_TRUSS_H
#define HIFDM_TRUSS_H

#include <hifdm/api.h>
#include <hifdm/generate.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>

HF_API_BEGIN

#define HF_TRUSS_DOF 6 /* of a node */

/* A rigid member is a beam clamped to its two nodes; a pinned one carries axial force alone. */
typedef enum { HF_JOINT_RIGID, HF_JOINT_PINNED } hf_joint;

/* What a member belongs to. Basic units of the deployable structure (Fig. 15): on the directrix, main and assistant on
 * the generatrix. Parts of a ring truss: along a ring, between the rings, across a bay. */
typedef enum {
    HF_UNIT_BUD,
    HF_UNIT_MBUG,
    HF_UNIT_ABUG,
    HF_UNIT_OTHER,
    HF_UNIT_LONGERON,
    HF_UNIT_VERTICAL,
    HF_UNIT_DIAGONAL,
    HF_N_UNIT
} hf_unit;

extern const char *const hf_dof_word[HF_TRUSS_DOF]; /* "ux".."rz" */
extern const char *const hf_joint_word[3];          /* "rigid", "pinned", NULL */
extern const char *const hf_unit_word[HF_N_UNIT];   /* "bud", "mbug", ... */

/* Numbers of a member, X(name in struct and files, units, default when a file leaves it out, description). A number
 * whose default is NaN must be given. Local axes: x from i to j; y horizontal, y = (-x_y, x_x, 0) normalised, or the
 * global y of a vertical member; z = x cross y; roll turns y and z about x. Iz resists bending in the plane of x and y
 * (with the shear area Asy), Iy in that of x and z (Asz). An infinite shear area is Euler and Bernoulli's beam. */
#define HF_MEMBER_NUMBERS(X)                                                                                           \
    X(E_Pa, "Pa", NAN, "Young's modulus")                                                                              \
    X(A_m2, "m2", NAN, "cross-section")                                                                                \
    X(G_Pa, "Pa", NAN, "shear modulus")                                                                                \
    X(Iy_m4, "m4", NAN, "second moment of area for bending in the local x-z plane")                                    \
    X(Iz_m4, "m4", NAN, "second moment of area for bending in the local x-y plane")                                    \
    X(J_m4, "m4", NAN, "torsion constant")                                                                             \
    X(Asy_m2, "m2", INFINITY, "shear area along local y; infinite: no shear deformation")                              \
    X(Asz_m2, "m2", INFINITY, "shear area along local z; infinite: no shear deformation")                              \
    X(roll_rad, "rad", 0, "turn of the local axes y and z about x")                                                    \
    X(density_kg_per_m3, "kg/m3", 0, "density")                                                                        \
    X(expansion_per_K, "1/K", 0, "coefficient of thermal expansion")

typedef struct {
    int n_node, n_member;
    double *position_m;   /* [n_node][3] */
    unsigned char *fixed; /* [n_node] bit k: dof k is held by a support */
    double *mass_kg;      /* [n_node] of hinges */
    int *end;             /* [n_member][2] node indices i, j */
    unsigned char *joint; /* [n_member] hf_joint */
    unsigned char *unit;  /* [n_member] hf_unit */
#define HF_MEMBER_FIELD(name, units, otherwise, description) double *name; /* [n_member] */
    HF_MEMBER_NUMBERS(HF_MEMBER_FIELD)
#undef HF_MEMBER_FIELD
    const char **node_id, **member_id;     /* [n_node], [n_member] */
    int *node_line, *member_line;          /* lines in the files, or NULL for a generated truss */
    const char *nodes_file, *members_file; /* names for messages, or NULL */
    void *block, *text;                    /* owned memory behind all of the above */
} hf_truss;

/* Is member i_member of this part, from HF_PART_UNIT on of one unit? */
static inline bool hf_truss_is_of(const hf_truss *truss, int i_member, hf_part part)
{
    return part < HF_PART_UNIT || (int)truss->unit[i_member] == (int)part - HF_PART_UNIT;
}

/* ---- the generated trusses ---- */

typedef enum { HF_DIAGONALS_NONE, HF_DIAGONALS_SINGLE, HF_DIAGONALS_CROSSED } hf_diagonals;
typedef enum { HF_THEORY_EULER_BERNOULLI, HF_THEORY_TIMOSHENKO } hf_theory;
typedef enum { HF_HELD_CENTRAL_MODULE, HF_HELD_CENTRAL_MODULE_REAR } hf_held;
typedef enum { HF_HELD_ALL_DOFS, HF_HELD_TRANSLATIONS } hf_held_dofs;
typedef enum { HF_RING_HELD_BAY, HF_RING_HELD_VERTICAL, HF_RING_HELD_THREE_VERTICALS } hf_ring_held;

/* Words of a case file, indexed by the enumerations above; the last entry is NULL. */
extern const char *const hf_diagonals_word[4];
extern const char *const hf_theory_word[3];
extern const char *const hf_held_word[3];
extern const char *const hf_held_dofs_word[3];
extern const char *const hf_ring_held_word[4];

/* A basic unit: a planar truss one module long with chords, posts and diagonals of one round tube. */
typedef struct {
    double diameter_m, wall_m; /* of the tube, outside */
    int panels;                /* along a module */
    hf_diagonals diagonals;    /* of a panel */
} hf_truss_unit;

typedef struct {
    double diameter_m, wall_m; /* outside */
} hf_tube;

/* A hoop truss under the rim of a paraboloid: a front ring through the supports of the front net, a rear ring straight
 * below it, through those of the rear net; bays between verticals. */
typedef struct {
    double height_m;   /* 0: that of the rear rim below the front rim */
    int cells_per_bay; /* gaps between supports along the rim in a bay */
    hf_diagonals bracing;
    hf_ring_held held;
    double held_at_deg; /* about the middle of the aperture, from x towards y */
    hf_tube longeron, vertical, diagonal;
} hf_truss_ring;

typedef struct {
    double depth_m;                /* of all units: the rear chords lie this far behind the surface, along its normal */
    int main_every;                /* counted from both edges, every main_every-th generatrix line is MBUG, else ABUG */
    hf_truss_unit bud, mbug, abug; /* BUD on the module borders along x, the others along y */
    double E_Pa, G_Pa, density_kg_per_m3, expansion_per_K;
    double hinge_mass_kg; /* of each node */
    hf_theory theory;     /* shear area of a thin round tube: half its cross-section */
    hf_joint joints;      /* of all members */
    hf_held supports;     /* which nodes */
    hf_held_dofs support_dofs;
    double match_tolerance_m; /* between a net support and its attachment */
    hf_truss_ring ring;       /* instead of units */
} hf_truss_settings;

/* Keys of the section truss, and of each of its units with the defaults of diameter and number of panels, as rows of
 * hf_field_table (config.h): X(section, member, type, least, largest, default, unit, words, help). */
#define HF_TRUSS_KEYS(X, section)                                                                                      \
    X(section, depth_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e3, "1", "m", NULL,                                           \
      "distance of the rear chords from the front chords, along the normal of the surface")                            \
    X(section, main_every, HF_FIELD_INT, 1, 2000, "2", "", NULL,                                                       \
      "counted from both edges, every so many module borders along y carry main units (mbug), the others "             \
      "assistant ones")                                                                                                \
    X(section, E_Pa, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e15, "130e9", "Pa", NULL, "Young's modulus of the tubes")        \
    X(section, G_Pa, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e15, "5e9", "Pa", NULL,                                          \
      "shear modulus of the tubes; E/(2(1+nu)) for isotropic material")                                                \
    X(section, density_kg_per_m3, HF_FIELD_DOUBLE, 0, 1e6, "1600", "kg/m3", NULL, "density of the tubes")              \
    X(section, expansion_per_K, HF_FIELD_DOUBLE, -1, 1, "0", "1/K", NULL, "thermal expansion of the tubes")            \
    X(section, hinge_mass_kg, HF_FIELD_DOUBLE, 0, 1e6, "1", "kg", NULL, "mass of the hinges at each node")             \
    X(section, theory, HF_FIELD_WORD, 0, 0, "euler_bernoulli", "", hf_theory_word,                                     \
      "beams without shear deformation, or with a shear area of half the cross-section (thin round tube)")             \
    X(section, joints, HF_FIELD_WORD, 0, 0, "rigid", "", hf_joint_word,                                                \
      "members clamped to their nodes, or carrying axial force alone")                                                 \
    X(section, supports, HF_FIELD_WORD, 0, 0, "central_module", "", hf_held_word,                                      \
      "nodes held by the spacecraft: all corners of the central module, or its rear ones")                             \
    X(section, support_dofs, HF_FIELD_WORD, 0, 0, "all", "", hf_held_dofs_word,                                        \
      "what is held there: displacements and rotations, or displacements only")

#define HF_TRUSS_UNIT_KEYS(X, section, diameter, panel_number)                                                         \
    X(section, diameter_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 10, diameter, "m", NULL, "outer diameter of its tubes")     \
    X(section, wall_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 5, "0.001", "m", NULL, "wall thickness of its tubes")           \
    X(section, panels, HF_FIELD_INT, 1, 1000, panel_number, "", NULL, "panels along one module")                       \
    X(section, diagonals, HF_FIELD_WORD, 0, 0, "single", "", hf_diagonals_word, "diagonals of each panel")

/* Keys of the section truss.ring, and of each of its tubes with the default of the diameter. */
#define HF_RING_KEYS(X, section)                                                                                       \
    X(section, height_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e3, "", "m", NULL,                                           \
      "distance of the rear ring below the front ring, along z; default: rear_distance_m of the net")                  \
    X(section, cells_per_bay, HF_FIELD_INT, 1, 6000, "1", "", NULL,                                                    \
      "cells of the net along the rim in a bay of the ring, which has a vertical at each end; the longerons bend at "  \
      "the supports of the net between them")                                                                          \
    X(section, bracing, HF_FIELD_WORD, 0, 0, "single", "", hf_diagonals_word,                                          \
      "diagonals of each bay; single ones fall and rise by turns")                                                     \
    X(section, held, HF_FIELD_WORD, 0, 0, "bay", "", hf_ring_held_word,                                                \
      "joints held by the spacecraft or the ground: the four of a bay, the two of a vertical, or the rear ones of "    \
      "three verticals a third of the way round apart")                                                                \
    X(section, held_at_deg, HF_FIELD_DOUBLE, 0, 360, "180", "deg", NULL,                                               \
      "where the bay or the (first) vertical is, to the nearest one: the angle about the middle of the aperture, "     \
      "from "                                                                                                          \
      "x towards y; 180 is the side of the axis of an offset reflector")

#define HF_TUBE_KEYS(X, section, diameter)                                                                             \
    X(section, diameter_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 10, diameter, "m", NULL, "outer diameter of its tubes")     \
    X(section, wall_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 5, "0.001", "m", NULL, "wall thickness of its tubes")

/* Make the truss of basic sub-rings over the modules of the net, with front nodes on the module corners, on the
 * cylinder; the outer ones stand where the supports of edge ties are. Node ids f<i>_<j> in front and r<i>_<j> behind,
 * f<i>.<k>_<j> or f<i>_<j>.<k> inside units of several panels; member ids <node>-<node>. Free the truss in any case.
 * Returns HF_OK; HF_BAD_CASE when it would be too large; HF_NO_MEMORY. */
hf_status hf_truss_generate(const hf_truss_settings *settings, const hf_cylinder *cylinder, hf_truss *truss,
                            hf_messages *messages);

/* Make the ring truss under the rim of the net. Node ids f<k> in front and r<k> behind, counted around from x towards y
 * as the supports of the net are; member ids <node>-<node>. Hinges are where verticals end. Free the truss in any case.
 * Returns HF_OK; HF_BAD_CASE for what hf_truss_ring_fault tells, or when a quad net's cells do not divide into bays;
 * HF_NO_MEMORY. */
hf_status hf_truss_ring_generate(const hf_truss_settings *settings, const hf_paraboloid *paraboloid, hf_truss *truss,
                                 hf_messages *messages);

/* The key of truss.ring that asks for what cannot be made, with the reason in what[size] (HF_GENERATE_FAULT_SIZE is
 * enough), or NULL. */
const char *hf_truss_ring_fault(const hf_truss_settings *settings, const hf_paraboloid *paraboloid, char *what,
                                size_t size);

/* ---- any truss ---- */

/* Find the truss node that carries each support of the net: the nearest one, within the tolerance. scene_node,
 * truss_node: room for scene->n_node; n_attachment of each are set. HF_BAD_CASE names every net support without one. */
hf_status hf_truss_attach(const hf_truss *truss, const hf_scene *scene, double tolerance_m, int *n_attachment,
                          int *scene_node, int *truss_node, hf_messages *messages);

/* Allocate a truss of this size, all zero. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_truss_allocate(hf_truss *truss, int n_node, int n_member, bool with_line);
void hf_truss_free(hf_truss *truss);

/* Check what must hold for every truss, generated or read: finite numbers, stiffness above zero, members with two
 * different ends and a length. Reports all faults in one go, each with file, line and id. HF_OK, HF_BAD_CASE. */
hf_status hf_truss_check(const hf_truss *truss, hf_messages *messages);

/* Room for a path of HF_PATH_SIZE bytes, a line and an id of 255 bytes, the most that a table may have. */
#define HF_TRUSS_DESCRIPTION_SIZE (HF_PATH_SIZE + 300)

/* Write "truss_nodes.csv:7: node 'a'" or "truss: node 'a'" into text[size], for messages; what has no room is cut. */
void hf_truss_describe(const hf_truss *truss, bool is_member, int index, char *text, size_t size);

double hf_truss_member_length(const hf_truss *truss, int i_member); /* m */
double hf_truss_mass(const hf_truss *truss);                        /* kg: members and hinges */

HF_API_END
#endif
