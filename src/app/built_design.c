/* Makes the as-built net of a case at the shape of a design. built_design.h describes the interface.
 *
 *     options -> form-finding of the case, or a stored result of the same net and truss -> shape in the workspace
 *     shape   -> hf_built_make -> as-built net
 *
 * Contents: the net of the result - the shape of the result - interface */
#include "app/built_design.h"

#include "run/diagnose.h"
#include "run/problem_parts.h"
#include "solve/coupling.h"
#include "solve/schur.h"
#include <hifdm/formfind.h>
#include <hifdm/metrics.h>

#include <string.h>

/* ---- the net of the result ---- */

/* Returns the property in which two nets differ, or NULL if a design of one net fits the other. */
static const char *net_difference(const hf_scene *a, const hf_scene *b)
{
    const char *what = hf_scene_difference(a, b);
    if (what) return what;
    if (!hf_scene_numbers_agree(3 * (size_t)a->n_node, a->load_N, b->load_N)) return "loads";
    if (!hf_scene_numbers_agree((size_t)a->n_cable, a->EA_N, b->EA_N)) return "EA of cables";
    return NULL;
}

/* Returns the property in which two trusses differ, or NULL. */
static const char *truss_difference(const hf_truss *a, const hf_truss *b)
{
    size_t n = (size_t)a->n_node, n_member = (size_t)a->n_member;
    if (a->n_node != b->n_node || a->n_member != b->n_member) return "the truss";
    if (!hf_scene_numbers_agree(3 * n, a->position_m, b->position_m)) return "nodes of the truss";
    if (memcmp(a->fixed, b->fixed, n) != 0) return "supports of the truss";
    if (memcmp(a->end, b->end, 2 * n_member * sizeof *a->end) != 0) return "ends of members";
    if (memcmp(a->joint, b->joint, n_member) != 0) return "joints of members";
#define DIFFER(name, units, otherwise, description)                                                                    \
    if (!hf_scene_numbers_agree(n_member, a->name, b->name)) return #name " of members";
    HF_MEMBER_NUMBERS(DIFFER)
#undef DIFFER
    return NULL;
}

/* Checks that the stored result has the net and the truss of the case. Returns HF_OK, HF_BAD_CASE, HF_IO or
 * HF_NO_MEMORY. */
static hf_status compare(const hf_options *o, const hf_problem *p, const hf_export_stored *stored,
                         hf_messages *messages)
{
    hf_truss truss = {0};
    hf_carrier_state state = {0};
    const char *what = net_difference(&p->scene, &stored->scene);
    hf_status status = HF_OK;
    if (!what && stored->summary.has_truss != p->settings.has_truss) what = "the truss";
    if (!what && p->settings.has_truss) {
        status = hf_store_read_truss(o->result, &truss, &state, messages);
        if (status == HF_OK) what = truss_difference(&p->carrier.truss, &truss);
    }
    hf_carrier_state_free(&state);
    hf_truss_free(&truss);
    HF_TRY(status);
    if (!what) return HF_OK;
    return hf_error(messages, HF_BAD_CASE,
                    "%s: this result belongs to another net than the case %s. The difference is in %s. Use the case "
                    "file of this result",
                    o->result, o->file, what);
}

/* ---- the shape of the result ---- */

/* Copies the stored shape into the workspace, and computes the displacements by the truss. */
static void take_shape(const hf_export_stored *stored, hf_problem *p)
{
    const hf_model *m = &p->model;
    const hf_shape *s = &stored->shape;
    hf_workspace *w = &p->workspace;
    hf_form_prepare(m, w);
    for (int i = 0; i < m->n_node; i++)
        for (int c = 0; c < 3; c++)
            w->position_m[c * m->n_node + m->row_of_node[i]] = s->position_m[3 * i + c];
    memcpy(w->length_m, s->length_m, (size_t)m->n_cable * sizeof(double));
    memcpy(w->tension_N, s->tension_N, (size_t)m->n_cable * sizeof(double));
    memcpy(w->q_N_per_m, s->q_N_per_m, (size_t)m->n_cable * sizeof(double));
    /* Each cable keeps its force density, because a design may have replaced the targets of the laws. A slack cable
     * keeps its law if that is still the law of the scene. It then has the length that its law gives, as in the cut
     * list. */
    for (int e = 0; e < m->n_cable; e++) {
        if (hf_metrics_is_slack(m, w, e) && s->law[e] == m->law[e]) continue;
        w->law[e] = HF_LAW_FORCE_DENSITY;
        w->target[e] = s->q_N_per_m[e];
    }
    if (!m->n_attachment) return;
    hf_coupling_forces(m, w);
    hf_schur_flex(m, w->attachment_force_N, w->displacement_m);
}

static hf_status read_design(const hf_options *o, hf_problem *p, hf_messages *messages)
{
    static hf_export_stored stored;
    const hf_export_request request = {.file = o->result, .stage = o->stage};
    hf_status status = hf_export_read(&request, HF_EXPORT_SHAPE, &stored, messages);
    if (status == HF_OK) status = compare(o, p, &stored, messages);
    if (status == HF_OK && !o->stage) hf_export_warn_of_shape(o->result, &stored.summary, false, messages);
    if (status == HF_OK) take_shape(&stored, p);
    hf_export_free(&stored);
    return status;
}

/* ---- interface ---- */

hf_status hf_built_design_check(const hf_options *o, const hf_case *c, hf_messages *messages)
{
    bool is_form = o->stage && !strcmp(o->stage, hf_stage_word[HF_STAGE_FORM]);
    if (o->result || is_form || (!o->stage && !c->has_optimize)) return HF_OK;
    if (o->stage)
        return hf_error(messages, HF_BAD_USAGE,
                        "the --stage option needs --result FILE with a result of this case. Only --stage form works "
                        "without a result");
    return hf_error(messages, HF_BAD_USAGE,
                    "%s: the case has an `optimize` section, so --result FILE must give the result from which the "
                    "cables were cut. If the cables were cut to the lengths after form-finding, use --stage form",
                    o->file);
}

hf_status hf_built_design_make(const hf_options *o, hf_problem *p, hf_built *built, hf_messages *messages)
{
    HF_TRY(hf_problem_allocate(p, messages));
    if (o->result) {
        HF_TRY(read_design(o, p, messages));
    } else {
        hf_evaluate_form(&p->model, &p->settings.form, &p->workspace, NULL, &p->form);
        HF_TRY(hf_problem_explain(p, messages));
    }
    return hf_built_make(o->result ? o->result : o->file, &p->scene, &p->model, &p->settings.form, &p->workspace, built,
                         messages);
}
