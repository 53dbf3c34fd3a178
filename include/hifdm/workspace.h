/* workspace - all memory that the solvers of one thread write to. The workspace is allocated once from one list of
 * fields.
 * Stability: stable.
 *
 * After hf_form_find and hf_evaluate, the workspace contains the last shape. The shape consists of position_m,
 * q_N_per_m, length_m, tension_N, displacement_m and loose, and of the laws and target values in effect. After a
 * coupling, the workspace also contains attachment_force_N. All other fields are scratch memory and have no meaning
 * between calls. The scratch fields may change in any version. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/model.h>
#include <hifdm/result.h>
#include <signal.h>

HF_API_BEGIN

/* Newton's matrix has HF_NEWTON_DOFS unknowns without the attachments and HF_NEWTON_MOVES unknowns with the
 * attachments. */
#define HF_NEWTON_DOFS(m) ((m)->has_newton ? 3 * (size_t)(m)->n_free : 0)
#define HF_NEWTON_MOVES(m) ((m)->has_newton ? 3 * (size_t)((m)->n_free + (m)->n_attachment) : 0)

/* The accelerated coupling combines HF_COUPLING_DEPTH past displacements and steps. These data need HF_COUPLING_ITEMS
 * doubles. */
#define HF_COUPLING_DEPTH 8
#define HF_COUPLING_ITEMS(m) (3 * (size_t)(m)->n_attachment * (2 * HF_COUPLING_DEPTH + 4))

/* The solver solves the columns of HF_SCHUR_PANEL attachments together. The dense matrices of net and truss need
 * HF_SCHUR_ITEMS doubles (src/solve/schur.h). */
#define HF_SCHUR_PANEL 16
#define HF_SCHUR_COLUMNS(m) (3 * ((size_t)(m)->n_attachment + HF_SCHUR_PANEL * 3 * (size_t)(m)->n_free))
#define HF_SCHUR_ITEMS(m) (27 * (size_t)(m)->n_attachment * (size_t)(m)->n_attachment + HF_SCHUR_COLUMNS(m))

/* The primal-dual path needs HF_INTERIOR_ITEMS doubles (src/solve/path_kernel.h). Each block of eight cables needs
 * HF_INTERIOR_BLOCK doubles. */
#define HF_INTERIOR_BLOCK 416
#define HF_INTERIOR_ITEMS(m) (HF_INTERIOR_BLOCK * (((size_t)(m)->n_cable + 7) / 8))

/* The error bound of the certificate needs HF_BOUND_ITEMS doubles in total. Each cable needs HF_BOUND_CABLE_ITEMS
 * doubles (src/solve/precise.h), and the truss needs HF_BOUND_TRUSS_ITEMS doubles (src/solve/flexibility.h). The solver
 * processes HF_BOUND_CHUNK rows of the band at a time. */
#define HF_BOUND_CABLE_ITEMS 14
#define HF_BOUND_CHUNK 128
#define HF_BOUND_WINDOW(m) (3 * (size_t)(m)->n_attachment * (3 * (size_t)(m)->half_bandwidth + 2 + HF_BOUND_CHUNK))
#define HF_BOUND_TRUSS_ITEMS(m)                                                                                        \
    (HF_BOUND_WINDOW(m) + (size_t)(m)->n_attachment * (((m)->has_newton ? 18 : 20) * (size_t)(m)->n_attachment + 27))
#define HF_BOUND_ITEMS(m)                                                                                              \
    (HF_BOUND_CABLE_ITEMS * (size_t)(m)->n_cable + 6 * (size_t)(m)->n_node +                                           \
     16 * (size_t)((m)->n_free + (m)->n_attachment) + HF_BOUND_TRUSS_ITEMS(m))

/* Each row X(type, name, number of items for a model m, unit, meaning) defines one field. The solver of a net with
 * struts needs a general band matrix and pivots. Nets without struts need neither. */
#define HF_WORKSPACE_FIELDS(X)                                                                                         \
    X(double, position_m, 3 * (size_t)m->n_node, "m", "[3][n_node] by row, supports included")                         \
    X(double, band, (size_t)m->n_band + 1, "N/m", "lower band of D, then its Cholesky factor; one spare place")        \
    X(double, q_N_per_m, m->n_cable, "N/m", "[n_cable] force densities")                                               \
    X(double, length_m, m->n_cable, "m", "[n_cable] lengths of the last shape")                                        \
    X(double, tension_N, m->n_cable, "N", "[n_cable] tensions q l of the last shape")                                  \
    X(double, target, m->n_cable, "by law", "[n_cable] T*, L*, q or l0")                                               \
    X(double, EA_N, m->EA_N ? m->n_cable : 0, "N", "[n_cable] axial stiffness; nets with elastic cables")              \
    X(unsigned char, law, m->n_cable, "", "[n_cable] hf_law in force")                                                 \
    X(double, force_N, 3 * (size_t)m->n_node, "N", "[3][n_node] nodal forces")                                         \
    X(double, general_band, m->has_strut ? (size_t)m->n_free *(3 * (size_t)m->half_bandwidth + 1) : 0, "N/m",          \
      "struts")                                                                                                        \
    X(double, newton_band, HF_NEWTON_DOFS(m) * (3 * (size_t)m->half_bandwidth + 3), "N/m", "lower band, then factor")  \
    X(double, newton_force_N, HF_NEWTON_MOVES(m), "N", "[3 n_moving] by dof 3*row + c")                                \
    X(double, newton_step, HF_NEWTON_MOVES(m), "m", "[3 n_moving] by dof")                                             \
    X(double, newton_trial_m, m->has_newton ? 3 * (size_t)m->n_node : 0, "m", "[3][n_node] by row")                    \
    X(double, newton_trial_tension_N, m->has_newton ? (size_t)m->n_cable : 0, "N", "[n_cable]")                        \
    X(double, newton_work, 3 * HF_NEWTON_DOFS(m), "", "for the condition estimate")                                    \
    X(int, newton_integer_work, HF_NEWTON_DOFS(m), "", "for the condition estimate")                                   \
    X(double, interior_cable, m->has_newton ? HF_INTERIOR_ITEMS(m) : 0, "", "state and step of each cable")            \
    X(double, interior_position_m, m->has_newton ? 3 * (size_t)m->n_node : 0, "m", "[3][n_node] point of the path")    \
    X(double, bound_work, HF_BOUND_ITEMS(m), "", "cables and positions at twice the precision")                        \
    X(double, interior_tension_N, m->has_newton ? m->n_cable : 0, "N", "[n_cable] tensions there")                     \
    X(unsigned char, loose, m->n_node, "", "[n_node] 1: no taut cable holds this row")                                 \
    X(double, spring_N_per_m, m->has_newton ? (size_t)m->n_free : 0, "N/m", "[n_free] springs of the path")            \
    X(double, spring_anchor_m, m->has_newton ? 3 * (size_t)m->n_node : 0, "m", "[3][n_node] to where they pull")       \
    X(unsigned char, loose_law, m->has_newton ? m->n_cable : 0, "", "kept while loose nodes are placed")               \
    X(double, loose_target, m->has_newton ? m->n_cable : 0, "by law", "the same")                                      \
    X(double, loose_q_N_per_m, m->has_newton ? m->n_cable : 0, "N/m", "the same")                                      \
    X(double, loose_before_m, m->has_newton ? 3 * (size_t)m->n_node : 0, "m", "the same")                              \
    X(double, certificate_work, m->has_newton ? 0 : 3 * (size_t)m->n_node, "", "without a Newton matrix")              \
    X(int, certificate_integer_work, m->has_newton ? 0 : (size_t)m->n_free, "", "the same")                            \
    X(double, displacement_m, 3 * (size_t)m->n_attachment, "m", "[3 n_attachment] displacements by the truss")         \
    X(double, attachment_force_N, 3 * (size_t)m->n_attachment, "N", "[3 n_attachment] pull of the net on the truss")   \
    X(double, coupling_work, HF_COUPLING_ITEMS(m), "", "history of the accelerated coupling")                          \
    X(double, schur_work, m->has_newton && m->n_attachment ? HF_SCHUR_ITEMS(m) : 0, "", "net and truss together")      \
    X(int, schur_pivot, m->has_newton ? 3 * (size_t)m->n_attachment : 0, "", "the same")                               \
    X(double, coupling_q_N_per_m, m->n_attachment ? (size_t)m->n_cable : 0, "N/m",                                     \
      "[n_cable] from which the next form-finding starts")                                                             \
    X(double, support_displacement_m, m->moves_supports ? 3 * (size_t)m->n_node : 0, "m",                              \
      "[3][n_node] of a design's supports")                                                                            \
    X(int, pivot, m->has_strut ? (size_t)m->n_free : 0, "", "struts")

/* Contains the fields of HF_WORKSPACE_FIELDS and the state of the solver. Only one thread at a time may use a
 * workspace. */
typedef struct {
#define HF_WORKSPACE_MEMBER(type, name, count, unit, meaning) type *name;
    HF_WORKSPACE_FIELDS(HF_WORKSPACE_MEMBER)
#undef HF_WORKSPACE_MEMBER
    void *block; /* owned memory behind the fields */
    /* Number of rows that Newton's matrix moves. The number is n_free. If net and truss are solved together, n_moving
     * also includes the attachments. */
    int n_moving;
    bool starts_near;                  /* q_N_per_m is that of a shape whose supports have other positions */
    int n_joint_step;                  /* number of joint steps of net and truss in the current solve */
    hf_history *history;               /* history of the current form-finding; may be NULL */
    const volatile sig_atomic_t *stop; /* NULL or a flag; if *stop != 0, hf_form_find returns HF_INTERRUPTED */
} hf_workspace;

/* Returns cable i_cable with the law and the target value that are in effect in the workspace. */
static inline hf_law_cable hf_workspace_cable(const hf_model *model, const hf_workspace *workspace, int i_cable)
{
    hf_law_cable cable;
    cable.law = (hf_law)workspace->law[i_cable];
    cable.target = workspace->target[i_cable];
    cable.EA_N = hf_law_has(cable.law, HF_LAW_NEEDS_EA) ? workspace->EA_N[i_cable] : (double)NAN;
    cable.length_at_target_m = model->length_m[i_cable];
    return cable;
}

/* Returns the force density in N/m of cable i_cable for the shape in the workspace. If the law of the cable determines
 * the tension, the force density follows from this tension. If the law determines no tension, the force density is
 * q_N_per_m of the cable. */
static inline double hf_workspace_held_q_N_per_m(const hf_model *model, const hf_workspace *workspace, int i_cable)
{
    return hf_law_held_q_N_per_m(hf_workspace_cable(model, workspace, i_cable), workspace->length_m[i_cable],
                                 workspace->q_N_per_m[i_cable]);
}

/* Allocates a workspace and loads LAPACK for the solvers. Returns HF_OK, HF_NO_MEMORY or HF_NO_LAPACK. Call
 * hf_workspace_free even if hf_workspace_create fails. */
hf_status hf_workspace_create(const hf_model *model, hf_workspace *workspace);
/* Returns the number of bytes that hf_workspace_create allocates. */
size_t hf_workspace_bytes(const hf_model *model);
/* Frees the fields. */
void hf_workspace_free(hf_workspace *workspace);

/* Returns true if the law of at least one cable changes the force density of the cable between iterations (Eqs. 7,
 * 8). */
bool hf_workspace_iterates(const hf_model *model, const hf_workspace *workspace);

HF_API_END
