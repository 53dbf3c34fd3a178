/* built - the as-built net: pieces of elastic cable with the lengths of a cut list (METHOD section 12).
 * Stability: internal; this header may change in any version.
 *
 * Each cable is cut to the length at which it has the tension of the design in the shape of the design. The shape and
 * the tensions of the as-built net then follow from lengths, stiffness, supports and loads. Pipeline:
 *
 *   hf_built_make    shape and tensions of a design -> unstressed lengths (M32) -> nominal as-built net
 *   hf_built_load_case   load case -> changed lengths, supports and loads
 *   hf_built_solve   one net, which differs from the nominal one -> its shape and tensions */
#pragma once

#include <hifdm/api.h>
#include <hifdm/evaluate.h>
#include <hifdm/load_cases.h>

HF_API_BEGIN

/* The as-built net of a design. The model of the as-built net has the same nodes and cables as the model of the design,
 * in the same order. The as-built net must not outlive the scene, and it must not be moved in memory. */
typedef struct {
    hf_scene scene; /* scene of the design with its own laws, target values, EA and supports; the rest is borrowed */
    hf_model model; /* model with elastic cables that have their unstressed lengths, on the truss of the design */
    hf_form_settings form;             /* settings of the form-finding */
    double *position_m;                /* [3][n_node] shape of the design by row, which is also the nominal shape */
    double *tension_N;                 /* [n_cable] tensions of the design, which are also the nominal tensions */
    const volatile sig_atomic_t *stop; /* NULL or a flag; if *stop != 0, computations on this net end early */
    void *block;                       /* owned memory behind the arrays */
} hf_built;

/* Returns true if the stop flag is set. A computation that the stop flag ends early returns HF_INTERRUPTED, and its
 * results are invalid. */
static inline bool hf_built_must_stop(const hf_built *built)
{
    return built->stop && *built->stop;
}

/* Makes the as-built net of the design whose shape `workspace` holds. The shape must be an equilibrium of `model`,
 * which is the model of `scene`. Residuals of the as-built net are relative to the maximum tension of the design.
 * Returns HF_OK, HF_NO_MEMORY, or HF_BAD_CASE if cables have no EA or are struts. Each error message begins with
 * `where`. Call hf_built_free even after a failure. */
hf_status hf_built_make(const char *where, const hf_scene *scene, const hf_model *model, const hf_form_settings *form,
                        const hf_workspace *workspace, hf_built *built, hf_messages *messages);
/* Frees the as-built net. This function does not reset the settings of the as-built net. */
void hf_built_free(hf_built *built);

/* Replaces the net by the as-built net of another design of the same model. The result is the same as that of
 * hf_built_make. Returns HF_OK, or HF_BAD_CASE if a cable is under compression. If the status is HF_BAD_CASE, the net
 * is unchanged. */
hf_status hf_built_renew(const hf_model *model, const hf_workspace *workspace, hf_built *built);

/* The differences between one net and the nominal net. If a member is NULL, the net has no difference of this kind. */
typedef struct {
    const double *cut_m; /* [n_cable] unstressed lengths at the temperature of the net */
    const double *EA_N;  /* [n_cable] axial stiffness */
    const double
        /* [3][n_node] displacements of supports by row; of attachments, the displacements without forces */
        *support_displacement_m;
    const double *load_N; /* [3][n_node] loads by row; they replace the loads of the design */
} hf_built_net;

/* Finds the shape of one net from its unstressed lengths alone. This function does not use the nominal shape. This
 * function is the reference for faster methods. The workspace must belong to built->model. The workspace holds the
 * shape after the call. The function also counts loose nodes and determines their positions (METHOD section 4). Returns
 * result->status. */
hf_status hf_built_solve(const hf_built *built, const hf_built_net *net, hf_workspace *workspace,
                         hf_form_result *result);

/* Computes the changes of the nominal net in a load case. Thermal expansion changes the lengths of the cables, and the
 * load case displaces supports. The loads are the sum of the loads of the design, the loads of the load case and the
 * weights of nodes and cables. Half the weight of a cable acts at each of its ends. The array attachment_move_m [3
 * n_attachment] has the displacements of the attachments by the truss alone, in m. The array attachment_move_m may be
 * NULL. The function writes the results to cut_m [n_cable] and, by row, to move_m [3][n_node] and load_N [3][n_node].
 * The function sets the members of *net to the arrays cut_m, move_m and load_N. */
void hf_built_load_case(const hf_built *built, const hf_material *material, const hf_load_case *load_case,
                        const double *attachment_move_m, double *cut_m, double *move_m, double *load_N,
                        hf_built_net *net);

HF_API_END
