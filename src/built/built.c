/* Makes the as-built net of a design and solves it (METHOD section 12):
 *
 *     design: lengths l, tensions T, stiffnesses EA ---> cut lengths l0 = l/(1 + T/EA), all cables elastic
 *     cut lengths, EA, supports, loads of one net   ---> shape and tensions (hf_built_solve)
 *
 * Contents: the nominal net, one net. */
#include <hifdm/built.h>

#include "base/arena.h"
#include "base/elementary.h"
#include "net/cable_pick.h"
#include <hifdm/metrics.h>

#include <assert.h>
#include <string.h>

/* ---- the nominal net ---- */

/* Returns HF_BAD_CASE with a message for each kind of cable that cannot be cut. These are cables without EA, listed by
 * group, and struts. */
static hf_status refuse_cables(const char *where, const hf_scene *s, const hf_workspace *w, hf_messages *messages)
{
    int n = 0, first = 0;
    hf_status status = hf_cable_demand_EA(s, where, "the as-built net needs", "", messages);
    for (int e = 0; e < s->n_cable; e++)
        if (w->tension_N[e] < 0 && n++ == 0) first = e;
    if (n == 0) return status;
    return hf_error(messages, HF_BAD_CASE,
                    "%s: the as-built net cannot have struts, but %d cable%s in compression, such as '%s' with %.3g N",
                    where, n, n == 1 ? " is" : "s are", s->cable_id[first], w->tension_N[first]);
}

/* Sets the resting positions of the supports: those of the design, less the displacement of the truss at
 * attachments. */
static void rest_supports(const hf_model *m, const hf_workspace *w, hf_scene *s)
{
    for (int i = 0; i < s->n_node; i++)
        for (int c = 0; c < 3 && s->role[i] == HF_ROLE_SUPPORT; c++)
            s->position_m[3 * i + c] = w->position_m[c * m->n_node + m->row_of_node[i]];
    for (int k = 0; k < m->n_attachment; k++)
        for (int c = 0; c < 3; c++)
            s->position_m[3 * m->node_of_row[m->attachment_row[k]] + c] -= w->displacement_m[3 * k + c];
}

/* Puts the supports on the same truss as in the design's model. */
static hf_status attach_truss(const hf_model *m, hf_built *b, hf_messages *messages)
{
    void *block;
    int *node;
    if (!m->n_attachment) return HF_OK;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(node, m->n_attachment)));
    for (int k = 0; k < m->n_attachment; k++)
        node[k] = m->node_of_row[m->attachment_row[k]];
    hf_status status = hf_model_attach(&b->model, m->n_attachment, node, m->flexibility_m_per_N, messages);
    hf_arena_free_block(block);
    return status;
}

/* Takes supports, cut lengths (M32), tensions and positions from the shape of the design. */
static void take_design(const hf_model *m, const hf_workspace *w, hf_built *b)
{
    rest_supports(m, w, &b->scene);
    for (int e = 0; e < b->scene.n_cable; e++) {
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        cable.EA_N = b->scene.EA_N[e];
        b->scene.target[e] = hf_law_cut_m(cable, w->length_m[e], w->tension_N[e], hf_metrics_is_slack(m, w, e));
        b->tension_N[e] = w->tension_N[e];
    }
    memcpy(b->position_m, w->position_m, 3 * (size_t)m->n_node * sizeof(double));
}

/* Sets those entries of the model that depend on the design. */
static void hold_design(const hf_workspace *w, hf_built *b)
{
    hf_model *m = &b->model;
    for (int row = m->n_free; row < m->n_node; row++)
        for (int c = 0; c < 3; c++)
            m->position_m[c * m->n_node + row] = b->scene.position_m[3 * m->node_of_row[row] + c];
    m->reference_N = hf_max_magnitude((size_t)m->n_cable, b->tension_N);
    for (int e = 0; e < m->n_cable; e++) {
        m->target[e] = b->scene.target[e];
        m->length_m[e] = hf_scene_length_at_target(&b->scene, e);
        m->start_q_N_per_m[e] = b->tension_N[e] / w->length_m[e];
    }
}

hf_status hf_built_make(const char *where, const hf_scene *s, const hf_model *m, const hf_form_settings *form,
                        const hf_workspace *w, hf_built *b, hf_messages *messages)
{
    size_t n = (size_t)s->n_cable, n_coordinate = 3 * (size_t)s->n_node;
    *b = (hf_built){.scene = *s, .form = *form};
    HF_TRY(refuse_cables(where, s, w, messages));
    if (HF_ARENA_ARRAYS(&b->block, HF_ARRAY(b->scene.law, n), HF_ARRAY(b->scene.target, n), HF_ARRAY(b->scene.EA_N, n),
                        HF_ARRAY(b->scene.position_m, n_coordinate), HF_ARRAY(b->position_m, n_coordinate),
                        HF_ARRAY(b->tension_N, n)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "%s: out of memory for the as-built net", where);
    b->form.method = HF_METHOD_NEWTON;
    b->form.stop = HF_STOP_RESIDUAL;
    b->form.factor = HF_FACTOR_OWN; /* samples share a factor of hf_band_factor */
    memcpy(b->scene.position_m, s->position_m, n_coordinate * sizeof(double));
    memcpy(b->scene.EA_N, s->EA_N, n * sizeof(double));
    memset(b->scene.law, HF_LAW_ELASTIC, n);
    take_design(m, w, b);
    HF_TRY(hf_model_build(&b->scene, &b->form, &b->model, messages));
    HF_TRY(attach_truss(m, b, messages));
    assert(memcmp(b->model.row_of_node, m->row_of_node, (size_t)s->n_node * sizeof(int)) == 0);
    b->model.moves_supports = true;
    hold_design(w, b);
    return HF_OK;
}

hf_status hf_built_renew(const hf_model *m, const hf_workspace *w, hf_built *b)
{
    for (int e = 0; e < m->n_cable; e++)
        if (!(w->tension_N[e] >= 0)) return HF_BAD_CASE;
    take_design(m, w, b);
    hold_design(w, b);
    return HF_OK;
}

/* Makes the arrays and the model of a net in a load case. */
static hf_status make_loaded(const hf_built *base, hf_built *to, hf_messages *messages)
{
    size_t n = (size_t)base->scene.n_cable, n_coordinate = 3 * (size_t)base->scene.n_node;
    *to = (hf_built){.scene = base->scene, .form = base->form, .stop = base->stop};
    if (HF_ARENA_ARRAYS(&to->block, HF_ARRAY(to->scene.target, n), HF_ARRAY(to->scene.position_m, n_coordinate),
                        HF_ARRAY(to->position_m, n_coordinate), HF_ARRAY(to->tension_N, n),
                        HF_ARRAY(to->scene.load_N, n_coordinate)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the as-built net in a load case");
    memcpy(to->scene.position_m, base->scene.position_m, n_coordinate * sizeof(double));
    memcpy(to->scene.target, base->scene.target, n * sizeof(double));
    HF_TRY(hf_model_build(&to->scene, &to->form, &to->model, messages));
    HF_TRY(attach_truss(&base->model, to, messages));
    to->model.moves_supports = true;
    return HF_OK;
}

hf_status hf_built_in_load_case(const hf_built *base, const hf_built_net *net, const hf_workspace *w, hf_built *to,
                                hf_messages *messages)
{
    const hf_scene *s = &base->scene;
    const hf_model *m = &base->model;
    size_t n = (size_t)s->n_cable * sizeof(double), n_coordinate = 3 * (size_t)s->n_node * sizeof(double);
    if (!to->block) HF_TRY(make_loaded(base, to, messages));
    memcpy(to->scene.target, net->cut_m, n);
    memcpy(to->position_m, w->position_m, n_coordinate);
    memcpy(to->tension_N, w->tension_N, n);
    memcpy(to->model.load_N, net->load_N, n_coordinate);
    memcpy(to->scene.position_m, s->position_m, n_coordinate);
    for (int i = 0; i < s->n_node; i++)
        for (int c = 0; c < 3 && s->role[i] == HF_ROLE_SUPPORT; c++)
            to->scene.position_m[3 * i + c] += net->support_displacement_m[c * m->n_node + m->row_of_node[i]];
    hold_design(w, to);
    to->model.reference_N = m->reference_N; /* a cable is slack below the same tension in all load cases */
    return HF_OK;
}

void hf_built_free(hf_built *b)
{
    hf_model_free(&b->model);
    hf_arena_free_block(b->block);
    b->block = NULL;
}

/* ---- one net ---- */

hf_status hf_built_solve(const hf_built *b, const hf_built_net *net, hf_workspace *w, hf_form_result *r)
{
    hf_model loaded = b->model;
    size_t n = (size_t)loaded.n_cable * sizeof(double);
    if (net->load_N) loaded.load_N = (double *)(uintptr_t)net->load_N; /* no solver writes to load_N */
    hf_form_prepare(&loaded, w);
    if (net->cut_m) memcpy(w->target, net->cut_m, n);
    if (net->EA_N) memcpy(w->EA_N, net->EA_N, n);
    if (net->support_displacement_m)
        memcpy(w->support_displacement_m, net->support_displacement_m, 3 * (size_t)loaded.n_node * sizeof(double));
    return hf_evaluate_prepared(&loaded, &b->form, w, NULL, r);
}
