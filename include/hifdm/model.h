/* model - a scene prepared for solving: numbering, band of the matrix, laws, target values, loads, design variables.
 * Stability: stable.
 *
 * Pipeline:
 *
 *   hf_model_build        scene and settings -> model
 *   hf_model_attach       flexibility of a truss -> attachments, if there is a truss
 *   hf_workspace_create   memory of a thread for this model
 *
 * A model does not change once it is built, so all threads share it.
 *
 * Nodes are renumbered; the row of a node is its index in the model. Free nodes come first, in the order of the band:
 * rows 0 to n_free-1 are the rows of the force density matrix D. Supports on a truss follow, then all other supports.
 * Cables keep the order of the scene. D is stored as a lower band in LAPACK's layout, column-major: D(i,j) is
 * band[i-j + j*(half_bandwidth+1)]. */
#ifndef HIFDM_MODEL_H
#define HIFDM_MODEL_H

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>

HF_API_BEGIN

/* A chain is straight if its lengths exceed the distance of its supports by less than this part. Its sag would be below
 * 2e-5 of its span, and its tension above 1e4 times its load. The tests of model, solve and stress pass with 1e-10 and
 * 1e-8. With 1e-11 and with 1e-7 one test of the model fails (straight_chains_are_found). */
#define HF_STRAIGHT_EXCESS 1e-9

/* What a design variable of optimize.variables sets. */
typedef struct {
    hf_vary vary;        /* quantity of its cable; HF_VARY_SUPPORT_...: a displacement of its support */
    int setting;         /* row of optimize.variables */
    int support_row;     /* row of the support that is displaced; -1: none */
    double direction[3]; /* unit vector of the displacement */
} hf_variable;

/* A scene prepared for solving. "Row" stands for the index of a node in the model. */
typedef struct {
    int n_node, n_free, n_cable, n_inner_node; /* n_free: not supports; n_inner_node: counted in psi */
    int half_bandwidth;                        /* number of columns of D below the diagonal */
    int n_band;     /* n_free * (half_bandwidth + 1); an entry behind the band takes the terms of supports */
    bool has_strut; /* a force density is negative, so D may be indefinite */
    /* Workspaces hold a Newton matrix: a law iterates (or hf_model_want_newton was called), and the energy is
     * convex. */
    bool has_newton;
    bool by_lapack;      /* LAPACK factors the positive definite matrices (form.factor) */
    double pretension_N; /* pretension Td of the case */
    double reference_N;  /* reference of residuals: maximum tension of a law or load, otherwise pretension_N */

    int *row_of_node;                            /* [n_node] row of each node */
    int *node_of_row;                            /* [n_node] node of each row */
    int *end_row;                                /* [n_cable][2] rows of the ends */
    int *diagonal_a, *diagonal_b, *off_diagonal; /* [n_cable] entries in the band; n_band: none */
    int *inner_row;                              /* [n_inner_node] rows that count in psi */
    double *position_m;              /* [3][n_node] target positions by component; of supports the real ones */
    double *load_N;                  /* [3][n_node] loads by component, or NULL */
    double *length_m;                /* [n_cable] lengths between target positions */
    unsigned char *group;            /* [n_cable] hf_group */
    int n_boundary, *boundary_cable; /* [n_boundary] cables of HF_GROUP_BOUNDARY */
    unsigned char *law;              /* [n_cable] hf_law in force under form.method */
    double *target;                  /* [n_cable] T* (N), L* (m), q (N/m) or l0 (m) by law */
    double *EA_N;                    /* [n_cable] axial stiffness; NULL if no law in force needs it */
    double *start_q_N_per_m;         /* [n_cable] first force densities */

    /* Design variables: by default the pretensions of the boundary cables with a free end, otherwise those of
     * optimize.variables. If exactly two of their cables meet at a free node, the two are in one group, a chain.
     * Unequal changes inside a chain push its nodes along it; equal changes change its sag. */
    int n_variable, n_variable_group; /* numbers of design variables and of chains */
    int *variable_cable;              /* [n_variable] cable that it varies; -1: it displaces a support */
    int *variable_group;              /* [n_variable] chain, 0 to n_variable_group-1 */
    hf_variable *variable; /* [n_variable] with optimize.variables; NULL: boundary pretensions under optimize.rule */
    bool moves_supports;   /* some design variable displaces a support */

    /* Design variables that a symmetry or a row of optimize.variables links are a class. All change by the step of the
     * first. */
    int n_leader;         /* number of classes, which is that of the independent design variables */
    int *variable_leader; /* [n_variable] first design variable of the class; without links the variable itself */

    /* Chains of at least two cables of law length between two supports, through free nodes with no other such cable.
     * Straight chains come first: their lengths L* do not exceed the distance of the supports. One path that is too
     * short, through nodes where chains branch, may be among them. */
    int n_chain;       /* number of straight chains */
    int n_any_chain;   /* number of all chains */
    int *chain_start;  /* [n_any_chain + 1] first cable of each chain in chain_cable */
    int *chain_cable;  /* [chain_start[n_any_chain]] cables in order along the chain */
    int *chain_of_row; /* [n_node] straight chain through a free node, on a truss any chain; -1: none */

    /* Supports on an elastic truss (hf_model_attach). The flexibility F gives the displacements r = F f of the
     * attachments under the forces f on them (Eq. 15, condensed). Both are vectors by degree of freedom 3*i + c. These
     * members are zero without a truss. */
    int n_attachment, n_tie;     /* numbers of attachments and of cable ends at them */
    int *attachment_row;         /* [n_attachment] rows n_free + i, in the order of the flexibility */
    double *flexibility_m_per_N; /* [3 n_attachment][3 n_attachment] symmetric; NULL without a truss */
    int *tie;                    /* [n_tie] cable ends at attachments, 2*cable + end (0 or 1), by cable */
    int *tie_attachment;         /* [n_tie] attachment of each */

    void *block, *attachment_block, *variable_block; /* owned memory behind the arrays */
} hf_model;

/* Builds a model from a checked scene with the laws that form->method puts in force. Returns HF_OK or HF_NO_MEMORY with
 * a message, also if the band is too large. Call hf_model_free in either case. */
hf_status hf_model_build(const hf_scene *scene, const hf_form_settings *form, hf_model *model, hf_messages *messages);

/* Puts supports on a truss: node[i], a support of the scene, becomes attachment i of n_attachment > 0. Forces on the
 * attachments displace them by flexibility_m_per_N [3 n_attachment][3 n_attachment], which is copied and made exactly
 * symmetric. All other supports stay fixed. A cable of law length between an attachment and another support would be a
 * rigid rod in the truss; it gets law tension with its first tension instead. Call this at most once per model, before
 * workspaces are created for it.
 *
 * Returns HF_OK; HF_NO_MEMORY; HF_BAD_CASE with a message that contains the index of the attachment. That is the status
 * if a node is no support or occurs twice. It is also the status if the matrix is not finite, negative on the diagonal,
 * or not symmetric to 1e-9 of its maximum absolute entry. */
hf_status hf_model_attach(hf_model *model, int n_attachment, const int *node, const double *flexibility_m_per_N,
                          hf_messages *messages);

/* Makes workspaces of a net on a truss hold a Newton matrix also if no law iterates, except with struts. Populations
 * then share one matrix and move net and truss in vector lanes (chord). Its set-up is expensive compared with one
 * form-finding. Call it before workspaces are created. */
void hf_model_want_newton(hf_model *model);

/* Returns the force to which residuals and slack are relative, N: reference_N of a model of this scene. pretension_N is
 * Td. */
double hf_model_reference_N(const hf_scene *scene, double pretension_N);

/* Returns what design variable i_variable sets: HF_VARY_PRETENSION without optimize.variables. */
static inline hf_vary hf_model_vary(const hf_model *model, int i_variable)
{
    return model->variable ? model->variable[i_variable].vary : HF_VARY_PRETENSION;
}

/* Numbers the chains of the design variables (variable_group, n_variable_group) and unlinks the variables
 * (variable_leader, n_leader). For code that sets variable_cable. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_model_group_variables(hf_model *model);

#define HF_VARIABLE_NAME_SIZE 320 /* the ids of tables have at most 255 bytes */

/* Writes the name of a design variable in tables into text[size]: the id of its cable, or of its support followed by
 * .x, .y, .z or .normal. */
void hf_model_variable_name(const hf_model *model, const hf_scene *scene, int i_variable, char *text, size_t size);

/* Returns the unit of a design variable, "N", "N/m" or "m", a constant string. */
const char *hf_model_variable_unit(const hf_model *model, int i_variable);

/* Returns true if all indices of the model obey their invariants. For asserts and tests. */
bool hf_model_is_valid(const hf_model *model);

/* Writes the cables of a chain, "cable + cable + cable", into text[size]. A text that does not fit ends with " ...". */
void hf_model_chain_name(const hf_model *model, const hf_scene *scene, int i_chain, char *text, size_t size);

/* Copies row_m [3][n_node], positions by row, into position_m [n_node][3] in the order of the scene, m. */
void hf_model_positions(const hf_model *model, const double *row_m, double *position_m);

/* Frees the arrays of the model. */
void hf_model_free(hf_model *model);

HF_API_END
#endif
