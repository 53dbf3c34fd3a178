/* truss - the deployable truss that carries the net: nodes, straight members and supports.
 * Stability: stable.
 *
 * A generator makes a truss, or truss_import reads a truss from CSV files. A truss is checked once and does not change
 * afterwards. The functions in frame.h solve a truss. A node has six degrees of freedom (dofs): displacements along x,
 * y, z in m, and rotations about x, y, z in rad. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/generate.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>

HF_API_BEGIN

#define HF_TRUSS_DOF 6 /* number of degrees of freedom of a node */

/* A rigid member is a beam that is clamped to its two nodes. A pinned member carries only axial force. */
typedef enum { HF_JOINT_RIGID, HF_JOINT_PINNED } hf_joint;

/* States the unit to which a member belongs. BUD, MBUG and ABUG are the basic units of the deployable structure (Fig.
 * 15). BUD lies along the directrix. MBUG and ABUG are the main and assistant units along the generatrix. LONGERON,
 * VERTICAL and DIAGONAL are the parts of a ring truss. Longerons run along a ring, verticals connect the rings, and
 * diagonals cross a bay. */
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

extern const char *const hf_dof_word[HF_TRUSS_DOF]; /* "ux", "uy", "uz", "rx", "ry", "rz" */
extern const char *const hf_joint_word[3];          /* "rigid", "pinned", NULL */
extern const char *const hf_unit_word[HF_N_UNIT];   /* "bud", "mbug", "abug", "other", "longeron", ... */

/* Each row X(name in struct and files, units, default if a file has no value, description) defines a numerical property
 * of a member. A property whose default is NaN is required.
 *
 * In the local axes of a member, x runs from end i to end j. The axis y is the horizontal unit vector along (-x_y, x_x,
 * 0). For a vertical member, y is the global y axis. The axis z is the cross product of x and y. The angle roll rotates
 * the axes y and z about the axis x. The second moment of area Iz resists bending in the plane of x and y, with the
 * shear area Asy. The second moment of area Iy resists bending in the plane of x and z, with the shear area Asz. An
 * infinite shear area makes the member an Euler-Bernoulli beam. */
#define HF_MEMBER_NUMBERS(X)                                                                                           \
    X(E_Pa, "Pa", NAN, "Young's modulus")                                                                              \
    X(A_m2, "m2", NAN, "cross-section")                                                                                \
    X(G_Pa, "Pa", NAN, "shear modulus")                                                                                \
    X(Iy_m4, "m4", NAN, "second moment of area for bending in the local x-z plane")                                    \
    X(Iz_m4, "m4", NAN, "second moment of area for bending in the local x-y plane")                                    \
    X(J_m4, "m4", NAN, "torsion constant")                                                                             \
    X(Asy_m2, "m2", INFINITY, "shear area along local y; infinite: no shear deformation")                              \
    X(Asz_m2, "m2", INFINITY, "shear area along local z; infinite: no shear deformation")                              \
    X(roll_rad, "rad", 0, "rotation of the local axes y and z about x")                                                \
    X(density_kg_per_m3, "kg/m3", 0, "density")                                                                        \
    X(expansion_per_K, "1/K", 0, "coefficient of thermal expansion")

/* Contains the nodes, the members and the supports of a truss. */
typedef struct {
    int n_node, n_member; /* number of nodes and number of members */
    double *position_m;   /* [n_node][3] positions */
    unsigned char *fixed; /* [n_node] bit k is 1 if a support holds degree of freedom k */
    double *mass_kg;      /* [n_node] mass of the hinges */
    int *end;             /* [n_member][2] nodes at the ends i and j */
    unsigned char *joint; /* [n_member] joint of each member (hf_joint) */
    unsigned char *unit;  /* [n_member] unit of each member (hf_unit) */
#define HF_MEMBER_FIELD(name, units, otherwise, description) double *name; /* [n_member] */
    HF_MEMBER_NUMBERS(HF_MEMBER_FIELD)
#undef HF_MEMBER_FIELD
    const char **node_id, **member_id;     /* [n_node] and [n_member] ids */
    int *node_line, *member_line;          /* line numbers in the files; NULL for a generated truss */
    const char *nodes_file, *members_file; /* file names for messages; may be NULL */
    void *block, *text;                    /* owned memory behind all arrays above */
} hf_truss;

/* Returns true if member i_member belongs to this part of the truss. If `part` is below HF_PART_UNIT, the part is the
 * whole truss. If `part` is HF_PART_UNIT or above, the part is one unit. */
static inline bool hf_truss_is_of(const hf_truss *truss, int i_member, hf_part part)
{
    return part < HF_PART_UNIT || (int)truss->unit[i_member] == (int)part - HF_PART_UNIT;
}

/* ---- the generated trusses ---- */

/* Selects the diagonals of a panel or of a bay. */
typedef enum { HF_DIAGONALS_NONE, HF_DIAGONALS_SINGLE, HF_DIAGONALS_CROSSED } hf_diagonals;
/* The beam theory determines the shear areas. */
typedef enum { HF_THEORY_EULER_BERNOULLI, HF_THEORY_TIMOSHENKO } hf_theory;
/* The spacecraft holds all corners of the central module, or only its rear corners. */
typedef enum { HF_HELD_CENTRAL_MODULE, HF_HELD_CENTRAL_MODULE_REAR } hf_held;
/* Selects the degrees of freedom that the spacecraft holds at the held nodes. */
typedef enum { HF_HELD_ALL_DOFS, HF_HELD_TRANSLATIONS } hf_held_dofs;
/* Selects the joints of a ring truss that are held. */
typedef enum { HF_RING_HELD_BAY, HF_RING_HELD_VERTICAL, HF_RING_HELD_THREE_VERTICALS } hf_ring_held;

/* Contains the words of hf_diagonals in a case file. The last entry of the array is NULL. */
extern const char *const hf_diagonals_word[4];

/* Describes a basic unit of the truss. A basic unit is a planar truss with the length of one module. The chords, posts
 * and diagonals of a basic unit are round tubes of the same size. */
typedef struct {
    double diameter_m, wall_m; /* outer diameter and wall thickness of the tube */
    int panels;                /* number of panels in the length of a module */
    hf_diagonals diagonals;    /* diagonals of a panel */
} hf_truss_unit;

/* A round tube. */
typedef struct {
    double diameter_m, wall_m; /* outer diameter and wall thickness */
} hf_tube;

/* Describes a hoop truss under the rim of a paraboloid. The front ring runs through the supports of the front net. The
 * rear ring is vertically below the front ring and runs through the supports of the rear net. Verticals divide the
 * rings into bays. */
typedef struct {
    double height_m;      /* distance of the rings along z; 0: the distance between the rims of the two nets */
    int cells_per_bay;    /* number of gaps between supports in a bay along the rim */
    hf_diagonals bracing; /* diagonals of a bay */
    hf_ring_held held;    /* joints that are held */
    double held_at_deg;   /* angle of the held joints about the centre of the aperture, from x towards y */
    hf_tube longeron, vertical, diagonal; /* tubes of the members */
} hf_truss_ring;

/* Contains the settings of the truss of a case (section `truss`). */
typedef struct {
    double depth_m; /* distance of the rear chords from the surface along its normal, for all units */
    /* every main_every-th generatrix line, counted from both edges, has MBUG units; the others have ABUG units */
    int main_every;
    hf_truss_unit bud, mbug, abug; /* BUD on the module borders along x; MBUG and ABUG on the borders along y */
    double E_Pa, G_Pa, density_kg_per_m3, expansion_per_K; /* material of the tubes */
    double hinge_mass_kg;                                  /* mass of the hinges at each node */
    hf_theory theory;          /* Timoshenko: the shear area is half of the cross-section, as for a thin round tube */
    hf_joint joints;           /* joints of all members */
    hf_held supports;          /* nodes that are held */
    hf_held_dofs support_dofs; /* degrees of freedom that are held at these nodes */
    double match_tolerance_m;  /* maximum distance between a support of the net and its node of the truss */
    hf_truss_ring ring;        /* settings of the ring truss, which replaces the units */
} hf_truss_settings;

/* Defines the keys of the `truss` section and of each of its units. The macro arguments are the default diameter of the
 * tubes and the default number of panels. Each row X(section, member, type, minimum, maximum, default, unit, words)
 * defines a key in hf_field_table (config.h). */
#define HF_TRUSS_KEYS(X, section)                                                                                      \
    X(section, depth_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e3, "1", "m", NULL)                                           \
    X(section, main_every, HF_FIELD_INT, 1, 2000, "2", "", NULL)                                                       \
    X(section, E_Pa, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e15, "130e9", "Pa", NULL)                                        \
    X(section, G_Pa, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e15, "5e9", "Pa", NULL)                                          \
    X(section, density_kg_per_m3, HF_FIELD_DOUBLE, 0, 1e6, "1600", "kg/m3", NULL)                                      \
    X(section, expansion_per_K, HF_FIELD_DOUBLE, -1, 1, "0", "1/K", NULL)                                              \
    X(section, hinge_mass_kg, HF_FIELD_DOUBLE, 0, 1e6, "1", "kg", NULL)                                                \
    X(section, theory, HF_FIELD_WORD, 0, 0, "euler_bernoulli", "", HF_WORDS("euler_bernoulli", "timoshenko"))          \
    X(section, joints, HF_FIELD_WORD, 0, 0, "rigid", "", hf_joint_word)                                                \
    X(section, supports, HF_FIELD_WORD, 0, 0, "central_module", "", HF_WORDS("central_module", "central_module_rear")) \
    X(section, support_dofs, HF_FIELD_WORD, 0, 0, "all", "", HF_WORDS("all", "translations"))

#define HF_TRUSS_UNIT_KEYS(X, section, diameter, panel_number)                                                         \
    X(section, diameter_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 10, diameter, "m", NULL)                                    \
    X(section, wall_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 5, "0.001", "m", NULL)                                          \
    X(section, panels, HF_FIELD_INT, 1, 1000, panel_number, "", NULL)                                                  \
    X(section, diagonals, HF_FIELD_WORD, 0, 0, "single", "", hf_diagonals_word)

/* Defines the keys of the section truss.ring and of each of its tubes. The macro argument is the default diameter of
 * the tubes. */
#define HF_RING_KEYS(X, section)                                                                                       \
    X(section, height_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 1e3, "", "m", NULL)                                           \
    X(section, cells_per_bay, HF_FIELD_INT, 1, 6000, "1", "", NULL)                                                    \
    X(section, bracing, HF_FIELD_WORD, 0, 0, "single", "", hf_diagonals_word)                                          \
    X(section, held, HF_FIELD_WORD, 0, 0, "bay", "", HF_WORDS("bay", "vertical", "three_verticals"))                   \
    X(section, held_at_deg, HF_FIELD_DOUBLE, 0, 360, "180", "deg", NULL)

#define HF_TUBE_KEYS(X, section, diameter)                                                                             \
    X(section, diameter_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 10, diameter, "m", NULL)                                    \
    X(section, wall_m, HF_FIELD_DOUBLE, HF_ABOVE_ZERO, 5, "0.001", "m", NULL)

/* Makes the truss of basic sub-rings over the modules of the net. The front nodes of the truss are the module corners
 * on the cylinder. At the outer edge of a net with edge ties, the front nodes of the truss are the supports of these
 * ties. The ids of the front nodes are f<i>_<j>, and the ids of the rear nodes are r<i>_<j>. Nodes inside a unit of
 * several panels have ids such as f<i>.<k>_<j> or f<i>_<j>.<k>. The ids of members are <node>-<node>. Returns HF_OK,
 * HF_NO_MEMORY, or HF_BAD_CASE if the truss would be too large. Call hf_truss_free even if hf_truss_generate fails. */
hf_status hf_truss_generate(const hf_truss_settings *settings, const hf_cylinder *cylinder, hf_truss *truss,
                            hf_messages *messages);

/* Makes the ring truss under the rim of the net. The ids of the front nodes are f<k>, and the ids of the rear nodes are
 * r<k>. The nodes are numbered in the order of the supports of the net, from x towards y. The ids of members are
 * <node>-<node>. The hinges and their mass are at the ends of the verticals. Returns HF_OK or HF_NO_MEMORY. Returns
 * HF_BAD_CASE if hf_truss_ring_fault finds a fault, or if the cells of a quad net cannot be divided into bays. Call
 * hf_truss_free even if hf_truss_ring_generate fails. */
hf_status hf_truss_ring_generate(const hf_truss_settings *settings, const hf_paraboloid *paraboloid, hf_truss *truss,
                                 hf_messages *messages);

/* Returns the key of truss.ring whose value cannot be realised. Writes the reason to what[size]. A buffer of
 * HF_GENERATE_FAULT_SIZE bytes is sufficient. Returns NULL if there is no fault. */
const char *hf_truss_ring_fault(const hf_truss_settings *settings, const hf_paraboloid *paraboloid, char *what,
                                size_t size);

/* ---- any truss ---- */

/* Finds the node of the truss that carries each support of the net. The function selects the nearest node within the
 * distance tolerance_m. The arrays scene_node and truss_node must have space for scene->n_node indices. The function
 * sets the first *n_attachment entries of the arrays scene_node and truss_node. Returns HF_OK, or HF_BAD_CASE with
 * messages that list the supports without a node within tolerance_m. */
hf_status hf_truss_attach(const hf_truss *truss, const hf_scene *scene, double tolerance_m, int *n_attachment,
                          int *scene_node, int *truss_node, hf_messages *messages);

/* Allocates a truss with n_node nodes and n_member members. All values of the truss are zero. The argument with_line
 * states whether the line numbers exist. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_truss_allocate(hf_truss *truss, int n_node, int n_member, bool with_line);
/* Frees the memory of the truss. */
void hf_truss_free(hf_truss *truss);

/* Checks the rules that every generated or imported truss must satisfy. All numbers must be finite, and stiffness must
 * be above zero. Each member needs two different ends and a length. The function writes a message with file, line and
 * id for each fault, up to a maximum number of messages. Returns HF_OK or HF_BAD_CASE. */
hf_status hf_truss_check(const hf_truss *truss, hf_messages *messages);

/* Defines the size in bytes of the buffer for hf_truss_describe. HF_TRUSS_DESCRIPTION_SIZE is sufficient for a path of
 * HF_PATH_SIZE bytes, a line number and an id of 255 bytes. The ids in tables have at most 255 bytes. */
#define HF_TRUSS_DESCRIPTION_SIZE (HF_PATH_SIZE + 300)

/* Writes a description such as "truss_nodes.csv:7: node 'a'" to text[size] for use in messages. If the truss has no
 * file, the function writes, for example, "truss: node 'a'". If the description does not fit into the buffer, the
 * function truncates the description. */
void hf_truss_describe(const hf_truss *truss, bool is_member, int index, char *text, size_t size);

/* Returns the length of member i_member in m. */
double hf_truss_member_length(const hf_truss *truss, int i_member);
/* Returns the mass of all members and hinges in kg. */
double hf_truss_mass(const hf_truss *truss);

HF_API_END
