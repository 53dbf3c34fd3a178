/* built - the as-built net: pieces of elastic cable with the lengths of a cut list (METHOD section 12).
 * Stability: internal. This header may change in any version.
 *
 * Each cable is cut to the unstressed length at which it has its design tension in the design shape. The shape and the
 * tensions of the as-built net follow from its lengths, stiffness, supports and loads. Pipeline:
 *
 *   hf_built_make    shape and tensions of a design -> unstressed lengths (M32) -> nominal as-built net
 *   hf_built_load_case   load case -> changed lengths, supports and loads
 *   hf_built_solve   one net, which differs from the nominal one -> its shape and tensions */
#pragma once

#include <hifdm/api.h>
#include <hifdm/evaluate.h>
#include <hifdm/load_cases.h>

HF_API_BEGIN

/* As-built net of a design. The model of the as-built net has the same nodes and cables as the model of the design, in
 * the same order. The as-built net must not outlive the scene. The as-built net must not be moved in memory. */
typedef struct {
    hf_scene scene; /* scene of the design with its own laws, target values, EA and supports; the rest is borrowed */
    hf_model model; /* model with elastic cables that have their unstressed lengths, on the truss of the design */
    hf_form_settings form;             /* settings of the form-finding */
    double *position_m;                /* [3][n_node] shape of the design by row, which is also the nominal shape */
    double *tension_N;                 /* [n_cable] tensions of the design, which are also the nominal tensions */
    const volatile sig_atomic_t *stop; /* NULL or a flag; if *stop != 0, computations on this net end early */
    void *block;                       /* owned memory behind the arrays */
} hf_built;

/* Returns true if the stop flag is set. If the stop flag ends a computation early, the computation returns
 * HF_INTERRUPTED and its results are invalid. */
static inline bool hf_built_must_stop(const hf_built *built)
{
    return built->stop && *built->stop;
}

/* Makes the as-built net of the design whose shape is in `workspace`. The shape must be an equilibrium of `model`. The
 * argument `model` must be the model of `scene`. Residuals of the as-built net are relative to the maximum tension of
 * the design. Returns HF_OK, HF_NO_MEMORY, or HF_BAD_CASE if cables have no EA or are struts. Each error message begins
 * with `where`. Call hf_built_free even if hf_built_make fails. */
hf_status hf_built_make(const char *where, const hf_scene *scene, const hf_model *model, const hf_form_settings *form,
                        const hf_workspace *workspace, hf_built *built, hf_messages *messages);
/* Frees the as-built net. This function does not reset the settings of the as-built net. */
void hf_built_free(hf_built *built);

/* Replaces the net by the as-built net of another design of the same model. The resulting net is identical to a net
 * that hf_built_make creates. Returns HF_OK, or HF_BAD_CASE if a cable is under compression. If the status is
 * HF_BAD_CASE, the net is unchanged. */
hf_status hf_built_renew(const hf_model *model, const hf_workspace *workspace, hf_built *built);

/* Describes how an as-built net differs from the nominal net. If a pointer in this struct is NULL, the net has the
 * nominal values of that quantity. */
typedef struct {
    const double *cut_m; /* [n_cable] unstressed lengths at the temperature of the net */
    const double *EA_N;  /* [n_cable] axial stiffness */
    const double
        /* [3][n_node] displacements of supports by row; of attachments, the displacements without forces */
        *support_displacement_m;
    const double *load_N; /* [3][n_node] loads by row; they replace the loads of the design */
} hf_built_net;

/* Finds the shape of one as-built net from the unstressed lengths of its cables. This function does not use the nominal
 * shape. The function hf_built_solve is the reference for faster methods. The workspace must belong to built->model.
 * After the call, the workspace contains the shape of the net. The function counts the nodes that no taut cable holds
 * and determines their positions (METHOD section 4). Returns result->status. */
hf_status hf_built_solve(const hf_built *built, const hf_built_net *net, hf_workspace *workspace,
                         hf_form_result *result);

/* Computes how a load case changes the nominal net. The load case changes the lengths of cables by thermal expansion
 * and displaces supports. The loads are the sum of the loads of the design, the loads of the load case and the weights
 * of nodes and cables. Half the weight of a cable acts at each of its ends. The array attachment_move_m [3
 * n_attachment] contains the displacements in m that the truss alone causes at the attachments. The array
 * attachment_move_m may be NULL. The function writes the results to the arrays cut_m [n_cable], move_m [3][n_node] and
 * load_N [3][n_node]. The function stores pointers to the arrays cut_m, move_m and load_N in *net. */
void hf_built_load_case(const hf_built *built, const hf_material *material, const hf_load_case *load_case,
                        const double *attachment_move_m, double *cut_m, double *move_m, double *load_N,
                        hf_built_net *net);

/* Makes the as-built net that has the load case `net` as its nominal state. The workspace contains the shape that
 * hf_built_solve found for this load case. Samples in this load case then differ from *to by their errors alone. If
 * *to is all zero, the function allocates its memory. Otherwise *to must come from an earlier call with the same base.
 * The net `base` must outlive *to. Returns HF_OK or HF_NO_MEMORY. Call hf_built_free even if the function fails. */
hf_status hf_built_in_load_case(const hf_built *base, const hf_built_net *net, const hf_workspace *workspace,
                                hf_built *to, hf_messages *messages);

HF_API_END
