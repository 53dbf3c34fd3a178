/* model - a scene prepared for solving: numbering, bandwidth, band maps, laws, targets, loads.
 * Stability: stable.
 *
 * A model does not change once it is built, so all threads share it.
 *
 * Nodes are renumbered: "row" is a node's index in the model, free nodes first in band order (rows 0..n_free-1 are the
 * rows of the force density matrix D), then the supports on a truss, then the others. Cables keep the order of the
 * scene. The force density matrix is kept as LAPACK's lower band, column-major: D(i,j) at
 * band[i-j + j*(half_bandwidth+1)]. */
#ifndef HIFDM_MODEL_H
#define HIFDM_MODEL_H

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>

HF_API_BEGIN

/* A chain whose lengths exceed the distance of its supports by less than this part counts as straight: its sag would be
 * below 2e-5 of its span, and the tension above 1e4 times its load. With 1e-10 and 1e-8 the tests of model, solve and
 * stress pass; 1e-11 and 1e-7 each fail one of the model (straight_chains_are_found). */
#define HF_STRAIGHT_EXCESS 1e-9

/* What a gene sets in a scene with optimize.variables. */
typedef struct {
    hf_vary vary;        /* of the gene's cable, or HF_VARY_SUPPORT_... for a component of any of these */
    int setting;         /* row of optimize.variables */
    int support_row;     /* the support that moves, or -1 */
    double direction[3]; /* in which it moves, of length 1 */
} hf_gene;

typedef struct {
    int n_node, n_free, n_cable, n_inner_node; /* n_free: nodes that are no supports; n_inner_node: those in psi */
    int half_bandwidth;                        /* of D: columns below the diagonal */
    int n_band;      /* n_free * (half_bandwidth + 1); one spare place behind it takes the terms of supports */
    bool has_strut;  /* some force density is negative: D may be indefinite */
    bool has_newton; /* workspaces hold a Newton matrix: some law iterates (or hf_model_want_newton), and the energy is
                        convex (no strut) */
    bool by_lapack;  /* positive definite matrices are factored by LAPACK (form.factor) */
    double pretension_N;
    double reference_N; /* residuals are relative to it: the largest tension of a law or load, else the pretension */

    int *row_of_node;                            /* [n_node] */
    int *node_of_row;                            /* [n_node] */
    int *end_row;                                /* [n_cable][2] */
    int *diagonal_a, *diagonal_b, *off_diagonal; /* [n_cable] places in the band; n_band: none */
    int *inner_row;                              /* [n_inner_node] rows that psi counts */
    double *position_m;                          /* [3][n_node] theoretical, component by component; supports: real */
    double *load_N;                              /* [3][n_node], or NULL */
    double *length_m;                            /* [n_cable] theoretical */
    unsigned char *group;                        /* [n_cable] hf_group */
    int n_boundary, *boundary_cable;             /* [n_boundary] the cables of HF_GROUP_BOUNDARY */
    unsigned char *law;                          /* [n_cable] hf_law in force under the case's method */
    double *target;                              /* [n_cable] T* (N), L* (m), q (N/m) or l0 (m) by law */
    double *EA_N;                                /* [n_cable]; NULL unless some cable is elastic under the method */
    double *start_q_N_per_m;                     /* [n_cable] first force densities */

    /* Genes: the boundary cables with a free end, whose pretensions a design sets. Genes that meet at a free node
     * without a third one are in the same group, a chain. Unequal changes inside a chain push its nodes along it; equal
     * changes change its sag. */
    int n_gene, n_gene_group;
    int *gene_cable; /* [n_gene] -1: none, the gene moves a support */
    int *gene_group; /* [n_gene] 0..n_gene_group-1 */
    hf_gene *gene;   /* [n_gene] under optimize.variables, else NULL: boundary pretensions by optimize.rule */
    bool moves_supports;

    /* Genes linked by a symmetry of the net (module symmetry) change by the same step as the first of their class. */
    int n_leader;     /* number of classes, the independent genes; n_gene without a symmetry */
    int *gene_leader; /* [n_gene] first gene of the class: the gene itself without a symmetry */

    /* Chains of length-controlled cables between two supports. Straight chains, whose sum of L* does not exceed the
     * distance of the supports, come first. */
    int n_chain;       /* straight */
    int n_any_chain;   /* straight or with a sag */
    int *chain_start;  /* [n_any_chain + 1] into chain_cable */
    int *chain_cable;  /* [chain_start[n_any_chain]] cables in order along the chain */
    int *chain_of_row; /* [n_node] straight chain that passes through a free node, or -1 */

    /* Supports on an elastic truss (hf_model_attach): the displacement of degree of freedom 3*i + c under the forces on
     * the attachments, r = F f, Eq. 15 condensed. All zero without a truss. */
    int n_attachment, n_tie;
    int *attachment_row;         /* [n_attachment] rows n_free + i, in the order of the flexibility */
    double *flexibility_m_per_N; /* [3 n_attachment][3 n_attachment] symmetric; NULL without a truss */
    int *tie;                    /* [n_tie] cable ends at attachments: 2*cable + which end, by cable */
    int *tie_attachment;         /* [n_tie] index of the attachment */

    void *block, *attachment_block, *gene_block;
} hf_model;

/* Build from a checked scene. HF_OK or HF_NO_MEMORY (with a message). Free with hf_model_free in any case. */
hf_status hf_model_build(const hf_scene *scene, const hf_form_settings *form, hf_model *model, hf_messages *messages);

/* Put supports on a truss: node[i], a support of the scene, becomes attachment i. Forces on the attachments displace
 * them by the flexibility [3a][3a] in m/N (copied); all other supports stay fixed. A cable of law length between an
 * attachment and another support would be a rigid rod in the truss: it keeps its first tension instead. Returns HF_OK;
 * HF_BAD_CASE, naming the attachment by its index, when a node is no support or comes twice, or when the matrix is not
 * finite, not symmetric to 1e-9 of its largest entry (the copy is, exactly), or has a negative diagonal entry;
 * HF_NO_MEMORY. Call it once per model, before workspaces are created for it. */
hf_status hf_model_attach(hf_model *model, int n_attachment, const int *node, const double *flexibility_m_per_N,
                          hf_messages *messages);

/* Let workspaces of a net on a truss hold a Newton matrix where no law iterates, too, but for nets with struts: then
 * populations share one, and move net and truss in lanes (chord). Its set-up is dear beside one form-finding. Call it
 * before workspaces are created. */
void hf_model_want_newton(hf_model *model);

/* The force to which residuals and slack are relative, N: reference_N of a model of this scene. */
double hf_model_reference_N(const hf_scene *scene, double pretension_N);

/* What gene k sets: HF_VARY_PRETENSION unless optimize.variables says more. */
static inline hf_vary hf_model_vary(const hf_model *model, int i_gene)
{
    return model->gene ? model->gene[i_gene].vary : HF_VARY_PRETENSION;
}

/* Number the chains of the genes: gene_group, n_gene_group; and unlink them: gene_leader, n_leader. HF_OK or
 * HF_NO_MEMORY. For those who make genes. */
hf_status hf_model_group_genes(hf_model *model);

#define HF_GENE_NAME_SIZE 320 /* ids of tables have at most 255 bytes */

/* The name of a gene in tables: the id of its cable, or of the support that it moves with .x, .y, .z or .normal. */
void hf_model_gene_name(const hf_model *model, const hf_scene *scene, int i_gene, char *text, size_t size);

/* The unit of a gene: "N", "N/m" or "m". */
const char *hf_model_gene_unit(const hf_model *model, int i_gene);

/* True when every index and band place obeys its invariants; for asserts and tests. */
bool hf_model_is_valid(const hf_model *model);

/* Write the cables of a chain, "cable + cable + cable", into `text`; a text that does not fit ends with " ...". */
void hf_model_chain_name(const hf_model *model, const hf_scene *scene, int i_chain, char *text, size_t size);

/* A shape by row, row_m [3][n_node], in the order of the scene: position_m [n_node][3]. */
void hf_model_positions(const hf_model *model, const double *row_m, double *position_m);

void hf_model_free(hf_model *model);

HF_API_END
#endif
