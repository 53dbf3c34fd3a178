/* built - the net as it is made: each cable is a piece of elastic cable, cut so that the design's shape holds it at the
 * design's tension. Then shape and tensions follow from lengths, stiffness, supports and loads (METHOD section 12).
 * Stability: internal; may change in any version. */
#ifndef HIFDM_BUILT_H
#define HIFDM_BUILT_H

#include <hifdm/api.h>
#include <hifdm/evaluate.h>
#include <hifdm/states.h>

HF_API_BEGIN

/* A design that is made. Its model has the nodes and cables of the design's model in the same rows and the same order;
 * it lives as long as the scene and does not move in memory once it is made. */
typedef struct {
    hf_scene scene; /* the design's, but for laws, targets, EA and supports; it borrows all else */
    hf_model model; /* every cable of law elastic, target: its unstressed length; on the design's truss */
    hf_form_settings form;
    double *place_m;                   /* [3][n_node] shape of the design by row: where the nominal net has its nodes */
    double *tension_N;                 /* [n_cable] of the design, and so of the nominal net */
    const volatile sig_atomic_t *stop; /* NULL, or a flag: where *stop != 0 what works on this net leaves early */
    void *block;
} hf_built;

/* Is it told to stop? Then what was left early returns HF_INTERRUPTED, and what it found means nothing. */
static inline bool hf_built_must_stop(const hf_built *built)
{
    return built->stop && *built->stop;
}

/* Make the net whose design's shape `workspace` holds, an equilibrium of `model`, the model of `scene`. Residuals are
 * relative to the largest tension of the design. Returns HF_OK; HF_BAD_CASE with messages that begin with `where`, when
 * cables have no EA or are struts; HF_NO_MEMORY. Free it in any case. */
hf_status hf_built_make(const char *where, const hf_scene *scene, const hf_model *model, const hf_form_settings *form,
                        const hf_workspace *workspace, hf_built *built, hf_messages *messages);
void hf_built_free(hf_built *built);

/* The same net for another design of the same model: what hf_built_make makes of it. HF_OK, or HF_BAD_CASE when cables
 * push; then nothing has changed. */
hf_status hf_built_renew(const hf_model *model, const hf_workspace *workspace, hf_built *built);

/* In what one net differs from the nominal one. NULL: in nothing of the kind. */
typedef struct {
    const double *cut_m;          /* [n_cable] unstressed lengths, at the temperature that the net has */
    const double *EA_N;           /* [n_cable] */
    const double *support_move_m; /* [3][n_node] by row: how far supports are off; of attachments without any force */
    const double *load_N;         /* [3][n_node] by row: in place of the design's loads */
} hf_built_net;

/* Find the shape of one net from its unstressed lengths, whatever the nominal shape is: the reference for faster ways.
 * The workspace is one of built->model and holds the shape afterwards. Loose nodes are placed (hf_loose_settle) and
 * counted. Returns result->status. */
hf_status hf_built_solve(const hf_built *built, const hf_built_net *net, hf_workspace *workspace,
                         hf_form_result *result);

/* What a state makes of the nominal net, in arrays of the caller: cables are longer by their expansion, supports moved,
 * and loads are those of the design, of the state, and the weights of nodes and of cables, half at each end.
 * attachment_move_m [3 n_attachment]: how far the truss alone moves the attachments in this state, or NULL.
 * cut_m [n_cable]; move_m, load_N [3][n_node] by row. `net` points to them. */
void hf_built_state(const hf_built *built, const hf_material *material, const hf_state *state,
                    const double *attachment_move_m, double *cut_m, double *move_m, double *load_N, hf_built_net *net);

HF_API_END
#endif
