/* built - the as-built net: pieces of elastic cable with the lengths of a cut list (METHOD section 12).
 * Stability: internal; may change in any version.
 *
 * Each cable is cut so that it has the tension of the design at the design's shape. Then shape and tensions follow from
 * lengths, stiffness, supports and loads. Pipeline:
 *
 *   hf_built_make    shape and tensions of a design -> unstressed lengths (M32) -> nominal as-built net
 *   hf_built_load_case   load case -> changed lengths, supports and loads
 *   hf_built_solve   one net, which differs from the nominal one -> its shape and tensions */
#ifndef HIFDM_BUILT_H
#define HIFDM_BUILT_H

#include <hifdm/api.h>
#include <hifdm/evaluate.h>
#include <hifdm/load_cases.h>

HF_API_BEGIN

/* The as-built net of a design. Its model has nodes and cables in the same rows and order as the design's model. It
 * must not outlive the scene, and it must not be moved in memory. */
typedef struct {
    hf_scene scene; /* as the design's, with its own laws, target values, EA and supports; the rest is borrowed */
    hf_model model; /* cables of law elastic with their unstressed lengths, on the truss of the design */
    hf_form_settings form;             /* settings of the form-finding */
    double *position_m;                /* [3][n_node] shape of the design by row, which is that of the nominal net */
    double *tension_N;                 /* [n_cable] tensions of the design, which are those of the nominal net */
    const volatile sig_atomic_t *stop; /* NULL, or a flag: *stop != 0 ends computations on this net early */
    void *block;                       /* owned memory behind the arrays */
} hf_built;

/* Returns true if the flag to stop is set. A computation that ends early returns HF_INTERRUPTED, and its results are
 * invalid. */
static inline bool hf_built_must_stop(const hf_built *built)
{
    return built->stop && *built->stop;
}

/* Makes the as-built net of the design whose shape `workspace` holds, an equilibrium of `model`, the model of `scene`.
 * Residuals are relative to the maximum tension of the design. Returns HF_OK; HF_BAD_CASE, with messages that begin
 * with `where`, if cables have no EA or are struts; HF_NO_MEMORY. Call hf_built_free in any case. */
hf_status hf_built_make(const char *where, const hf_scene *scene, const hf_model *model, const hf_form_settings *form,
                        const hf_workspace *workspace, hf_built *built, hf_messages *messages);
/* Frees the as-built net; the settings in it are not reset. */
void hf_built_free(hf_built *built);

/* Changes the net to that of another design of the same model, as hf_built_make would make it. Returns HF_OK, or
 * HF_BAD_CASE if a cable pushes; then nothing has changed. */
hf_status hf_built_renew(const hf_model *model, const hf_workspace *workspace, hf_built *built);

/* The differences of one net from the nominal net. A member that is NULL stands for no difference of this kind. */
typedef struct {
    const double *cut_m; /* [n_cable] unstressed lengths, at the temperature of the net */
    const double *EA_N;  /* [n_cable] axial stiffness */
    const double
        *support_displacement_m; /* [3][n_node] displacements of supports by row, of attachments without forces */
    const double *load_N;        /* [3][n_node] loads by row, which replace those of the design */
} hf_built_net;

/* Finds the shape of one net from its unstressed lengths alone, whatever the nominal shape is. It is the reference for
 * faster methods. The workspace is one of built->model and holds the shape afterwards. Loose nodes are placed (METHOD
 * section 4) and counted. Returns result->status. */
hf_status hf_built_solve(const hf_built *built, const hf_built_net *net, hf_workspace *workspace,
                         hf_form_result *result);

/* Computes what a load case changes in the nominal net. Cables are longer by their thermal expansion, and supports are
 * displaced. Loads are those of the design and of the load case, and the weights of nodes and cables, half at each end
 * of a cable. attachment_move_m [3 n_attachment] has the displacements of the attachments by the truss alone, m; it may
 * be NULL. The results are written to cut_m [n_cable], move_m and load_N, both [3][n_node] by row; *net points to
 * them. */
void hf_built_load_case(const hf_built *built, const hf_material *material, const hf_load_case *load_case,
                        const double *attachment_move_m, double *cut_m, double *move_m, double *load_N,
                        hf_built_net *net);

HF_API_END
#endif
