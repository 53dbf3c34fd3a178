/* model - a scene that is prepared for solving. A model adds the numbering, the matrix band, the laws, the loads and
 * the design variables to its scene.
 * Stability: stable.
 *
 * Pipeline:
 *
 *   hf_model_build        scene and settings -> model
 *   hf_model_attach       flexibility of a truss -> attachments (only with a truss)
 *   hf_workspace_create   model -> memory of one thread
 *
 * A model does not change after it is built, so all threads can share it.
 *
 * The model renumbers the nodes. The row of a node is its index in the model. Free nodes have the first rows, in the
 * order of the matrix band. Rows 0 to n_free-1 are the rows of the force density matrix D. Supports on a truss have the
 * next rows, and all other supports have the last rows. The cables have the same order as in the scene. The matrix D is
 * stored as a lower band in the column-major layout of LAPACK. D(i,j) is band[i-j + j*(half_bandwidth+1)]. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>

HF_API_BEGIN

/* A chain is straight if its length exceeds the distance between its supports by less than the relative limit
 * HF_STRAIGHT_EXCESS. A chain below the limit HF_STRAIGHT_EXCESS would have a sag below 2e-5 of its span and a tension
 * above 1e4 times its load. The tests `model`, `solve` and `stress` also pass with limits of 1e-10 and 1e-8. With a
 * limit of 1e-11 or 1e-7, the test straight_chains_are_found of `model` fails. */
#define HF_STRAIGHT_EXCESS 1e-9

/* Describes the quantity that a design variable of optimize.variables sets. */
typedef struct {
    hf_vary vary;        /* quantity of the cable; HF_VARY_SUPPORT_...: displacement of the support */
    int setting;         /* row of optimize.variables */
    int support_row;     /* row of the displaced support; -1: none */
    double direction[3]; /* unit vector of the displacement */
    bool scales;         /* the design variables of the row change by the same factor (link: scale) */
} hf_variable;

/* A block of a symmetric matrix: entry [r][c] belongs to row 3*row+r and column 3*column+c of the matrix. */
typedef struct {
    int row, column;
    double entry[3][3];
} hf_stiffness_block;

/* Contains the stiffness matrix of a truss as a sum of blocks. A block with different row and column also stands
 * for its transpose. The first blocks are the translations of the attachments. */
typedef struct {
    int n, n_block;            /* the matrix has 3 n rows; number of blocks */
    hf_stiffness_block *block; /* [n_block] N/m, N and N m */
    bool *is_held;             /* [n][3] the row belongs to a fixed degree of freedom and has no entry */
    double *position_m;        /* [n][3] node of each three rows */
    void *memory;              /* owned memory behind the arrays */
} hf_stiffness_blocks;

/* Contains a scene that is prepared for solving. In this struct, "row" means the index of a node in the model. */
typedef struct {
    /* n_free: nodes that are not supports; n_inner_node: nodes that psi includes */
    int n_node, n_free, n_cable, n_inner_node;
    int half_bandwidth; /* number of matrix columns of D below the diagonal */
    int n_band;         /* n_free * (half_bandwidth + 1); the entry behind the band collects the terms of supports */
    bool has_strut;     /* at least one force density is negative, so D may be indefinite */
    /* Workspaces hold a Newton matrix. A Newton matrix requires a convex energy. The Newton matrix also requires a law
     * that iterates or a call of hf_model_want_newton. */
    bool has_newton;
    bool by_lapack;      /* LAPACK factors the positive definite matrices (form.factor) */
    double pretension_N; /* pretension Td of the case */
    double reference_N;  /* reference force of residuals: maximum tension of a law or load, otherwise pretension_N */

    int *row_of_node;                            /* [n_node] row of each node */
    int *node_of_row;                            /* [n_node] node of each row */
    int *end_row;                                /* [n_cable][2] rows of the ends */
    int *diagonal_a, *diagonal_b, *off_diagonal; /* [n_cable] index of each entry in the band; n_band: no entry */
    int *inner_row;                              /* [n_inner_node] rows of the nodes that psi includes */
    double *position_m;              /* [3][n_node] target positions by component; actual positions of supports */
    double *load_N;                  /* [3][n_node] loads by component, or NULL */
    double *length_m;                /* [n_cable] lengths between target positions */
    unsigned char *group;            /* [n_cable] group of each cable (hf_group) */
    int n_boundary, *boundary_cable; /* [n_boundary] cables of HF_GROUP_BOUNDARY */
    unsigned char *law;              /* [n_cable] hf_law in force under form.method */
    double *target;                  /* [n_cable] target value by law: T* (N), L* (m), q (N/m) or l0 (m) */
    double *EA_N;                    /* [n_cable] axial stiffness; NULL if no law in force needs it */
    double *start_q_N_per_m;         /* [n_cable] first force densities */

    /* The rows of optimize.variables define the design variables. By default, the design variables are the pretensions
     * of the boundary cables that end at a free node. If exactly two varied cables meet at a free node, their design
     * variables belong to the same chain. Unequal changes within a chain push its nodes along the chain, and equal
     * changes change its sag. */
    int n_variable, n_variable_group; /* numbers of design variables and of chains */
    int *variable_cable;              /* [n_variable] varied cable; -1: the variable displaces a support */
    int *variable_group;              /* [n_variable] index of the chain, 0 to n_variable_group-1 */
    hf_variable *variable; /* [n_variable] rows of optimize.variables; NULL: boundary pretensions under optimize.rule */
    bool moves_supports;   /* at least one design variable displaces a support */

    /* A class consists of the design variables that a symmetry or a row of optimize.variables links. All design
     * variables of a class change by the same step as the first one. */
    int n_leader;         /* number of classes, which is the number of independent design variables */
    int *variable_leader; /* [n_variable] first design variable of the class; without links, the variable itself */
    bool links_tensions;  /* a class has tensions of cables that are not mirror images in any shape */

    /* A chain is a path of at least two cables of law length between two supports. A chain passes only through free
     * nodes that have no other cable of law length. The list of chains begins with the straight chains. The total
     * length L* of a straight chain does not exceed the distance between its supports. The straight chains may include
     * one path that is too short and passes through nodes where chains branch. */
    int n_chain;       /* number of straight chains */
    int n_any_chain;   /* number of all chains */
    int *chain_start;  /* [n_any_chain + 1] first cable of each chain in chain_cable */
    int *chain_cable;  /* [chain_start[n_any_chain]] cables in their order along the chain */
    int *chain_of_row; /* [n_node] straight chain through a free node, or any chain on a truss; -1: none */

    /* Supports on an elastic truss are called attachments (hf_model_attach). The flexibility matrix F determines the
     * displacements r = F f of the attachments under the forces f (Eq. 15, condensed). In the vectors r and f,
     * component c of attachment i has the index 3*i + c. The following members are zero without a truss. */
    int n_attachment, n_tie;     /* number of attachments, and number of cable ends at attachments */
    int *attachment_row;         /* [n_attachment] rows n_free + i, in the order of the flexibility */
    double *flexibility_m_per_N; /* [3 n_attachment][3 n_attachment] symmetric; NULL without a truss */
    /* stiffness matrix of the truss, borrowed; NULL: unknown, so that only F is used */
    const hf_stiffness_blocks *truss_stiffness;
    int *tie;            /* [n_tie] cable ends at attachments, as 2*cable + end (0 or 1), sorted by cable */
    int *tie_attachment; /* [n_tie] attachment of each cable end */

    void *block, *attachment_block, *variable_block; /* owned memory behind the arrays */
} hf_model;

/* Builds a model from a checked scene. The method form->method determines the laws of the cables. Returns HF_OK.
 * Returns HF_NO_MEMORY with a message if memory runs out or the band is too large. Call hf_model_free even if
 * hf_model_build fails. */
hf_status hf_model_build(const hf_scene *scene, const hf_form_settings *form, hf_model *model, hf_messages *messages);

/* Connects supports with a truss. The support node[i] of the scene becomes attachment i. The argument n_attachment must
 * be above 0. The matrix flexibility_m_per_N [3 n_attachment][3 n_attachment] determines the displacements of the
 * attachments under forces on the attachments. The function copies the matrix and makes it exactly symmetric. All other
 * supports remain fixed. A cable of law length between an attachment and another support would act as a rigid rod in
 * the truss. A cable of law length between an attachment and another support therefore receives the law tension with
 * its first tension. Call hf_model_attach at most once per model, and before workspaces for the model are created.
 *
 * Returns HF_OK or HF_NO_MEMORY. If an argument is invalid, the function returns HF_BAD_CASE with a message that
 * contains the index of the attachment. A node is invalid if it is not a support or occurs twice. The matrix is invalid
 * if it is not finite or has a negative diagonal entry. An asymmetry above 1e-9 of the maximum absolute entry also
 * makes the matrix invalid. */
hf_status hf_model_attach(hf_model *model, int n_attachment, const int *node, const double *flexibility_m_per_N,
                          hf_messages *messages);

/* Adds a Newton matrix to the workspaces of a net on a truss even if no law iterates. Nets with struts are excluded.
 * With the Newton matrix, the solver `chord` uses one factored matrix for whole populations and solves net and truss in
 * vector lanes. The set-up of the solver `chord` is expensive compared with one form-finding. Call hf_model_want_newton
 * before workspaces for the model are created. */
void hf_model_want_newton(hf_model *model);

/* Returns the reference force in N for residuals and slack cables. The returned value equals reference_N of a model of
 * this scene. The argument pretension_N is Td. */
double hf_model_reference_N(const hf_scene *scene, double pretension_N);

/* Returns the quantity that design variable i_variable sets. If the case has no optimize.variables, the quantity is
 * HF_VARY_PRETENSION. */
static inline hf_vary hf_model_vary(const hf_model *model, int i_variable)
{
    return model->variable ? model->variable[i_variable].vary : HF_VARY_PRETENSION;
}

/* Numbers the chains of the design variables (variable_group, n_variable_group). Removes the links between the design
 * variables (variable_leader, n_leader). Code that sets variable_cable calls this function afterwards. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_model_group_variables(hf_model *model);

#define HF_VARIABLE_NAME_SIZE 320 /* the ids in tables have at most 255 bytes */

/* Writes the name of a design variable, as used in tables, to text[size]. The name is the id of the cable that the
 * variable changes. For a support, the name is the id of the support, followed by .x, .y, .z or .normal. */
void hf_model_variable_name(const hf_model *model, const hf_scene *scene, int i_variable, char *text, size_t size);

/* Returns the unit of a design variable as a constant string: "N", "N/m" or "m". */
const char *hf_model_variable_unit(const hf_model *model, int i_variable);

/* Writes the cables of a chain to text[size] in the form "cable + cable + cable". If the name does not fit into the
 * buffer, the function truncates the name and ends it with " ...". */
void hf_model_chain_name(const hf_model *model, const hf_scene *scene, int i_chain, char *text, size_t size);

/* Copies the positions in m from row_m [3][n_node] to position_m [n_node][3] in the order of the scene. */
void hf_model_positions(const hf_model *model, const double *row_m, double *position_m);

/* Frees the arrays of the model. */
void hf_model_free(hf_model *model);

HF_API_END
