/* Finds the load cases of the as-built net, once the design is known (METHOD section 12).
 *
 *     design -> cut pieces of its cables (hf_built_make)
 *     each load case
 *         | truss alone, under its temperature and weight: displacements of the attachments
 *         | lengths at the temperature, displacements of supports, loads (hf_built_load_case)
 *         | shape (hf_built_solve), forces in the truss under the pull of the net
 *         v
 *     measures of the shape -> summary and store */
#include "run/stages.h"

#include "base/arena.h"
#include "base/clock.h"
#include "case/config_fault.h"
#include "solve/certificate.h"
#include "solve/coupling.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the design ---- */

hf_status hf_load_case_stage_take(const hf_problem *p, const hf_workspace *w, hf_load_case_stage *c,
                                  hf_messages *messages)
{
    char where[HF_LOCATION_SIZE];
    size_t n = 3 * (size_t)p->model.n_node;
    hf_load_case_stage_free(c);
    hf_config_place(&p->settings, where, "load_cases.0.name");
    HF_TRY(hf_built_make(where, &p->scene, &p->model, &p->settings.form, w, &c->built, messages));
    if (HF_ARENA_ARRAYS(&c->block, HF_ARRAY(c->cut_m, p->model.n_cable), HF_ARRAY(c->move_m, n), HF_ARRAY(c->load_N, n),
                        HF_ARRAY(c->attachment_move_m, 3 * p->model.n_attachment),
                        HF_ARRAY(c->truss_force, HF_TRUSS_DOF * p->carrier.truss.n_node)) != HF_OK ||
        hf_workspace_create(&c->built.model, &c->workspace) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the load cases of a net of %d nodes",
                        p->model.n_node);
    return HF_OK;
}

void hf_load_case_stage_free(hf_load_case_stage *c)
{
    hf_workspace_free(&c->workspace);
    hf_built_free(&c->built);
    hf_arena_free_block(c->block);
    *c = (hf_load_case_stage){0};
}

/* ---- one load case ---- */

/* Returns the loads of the truss itself, its temperature and its weight. force [n_truss_node][6] receives the
 * weight. */
static hf_frame_load load_of_truss(const hf_carrier *carrier, const hf_load_case *load_case, double *force)
{
    memset(force, 0, HF_TRUSS_DOF * (size_t)carrier->truss.n_node * sizeof *force);
    hf_carrier_add_weight(carrier, load_case->gravity_m_per_s2, force);
    return (hf_frame_load){.force = force, .temperature_K = load_case->member_rise_K};
}

/* Sets move_m [3 n_attachment] to the displacements of the attachments by the truss without the net, m. */
static hf_status move_attachments(const hf_carrier *carrier, const hf_frame_load *own, double *move_m)
{
    hf_carrier_state alone;
    hf_status status = hf_carrier_load(carrier, NULL, own, &alone);
    for (int k = 0; status == HF_OK && k < carrier->n_attachment; k++)
        for (int d = 0; d < 3; d++)
            move_m[3 * k + d] = alone.displacement[HF_TRUSS_DOF * carrier->truss_node[k] + d];
    hf_carrier_state_free(&alone);
    return status;
}

static void measure(const hf_built *b, const hf_carrier_state *truss, int n_member, const hf_workspace *w,
                    hf_load_case_summary *s)
{
    const hf_model *m = &b->model;
    double square = 0;
    s->tension_min_N = INFINITY;
    s->tension_max_N = -INFINITY;
    for (int e = 0; e < m->n_cable; e++) {
        s->tension_min_N = fmin(s->tension_min_N, w->tension_N[e]);
        s->tension_max_N = fmax(s->tension_max_N, w->tension_N[e]);
    }
    for (int i = 0; i < m->n_inner_node; i++)
        for (int c = 0; c < 3; c++) {
            double d = w->position_m[c * m->n_node + m->inner_row[i]] - b->position_m[c * m->n_node + m->inner_row[i]];
            square += d * d;
        }
    s->displacement_rms_m = sqrt(square / m->n_inner_node);
    s->member_force_max_N = n_member ? 0 : (double)NAN;
    for (int e = 0; e < n_member; e++)
        s->member_force_max_N = fmax(s->member_force_max_N, fabs(truss->end_force[12 * e]));
}

/* Measures and stores a shape that was found. `truss` is the state of the truss in this load case, NULL without a
 * truss. */
static hf_status keep_shape(const hf_problem *p, hf_load_case_stage *c, hf_store *store, const hf_carrier_state *truss,
                            hf_load_case_summary *s, hf_messages *messages)
{
    const hf_model *m = &c->built.model;
    measure(&c->built, truss, truss ? p->carrier.truss.n_member : 0, &c->workspace, s);
    if (p->settings.has_surface && hf_surface_measure(&p->surface, &p->facets, m, c->workspace.position_m,
                                                      c->workspace.tension_N, &s->surface) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the surface errors");
    if (isnan(s->result.psi_m)) hf_surface_blank(&s->surface);
    return hf_store_built(store, s->name, m, &c->workspace, &p->carrier, truss, messages);
}

hf_status hf_load_case_stage_rest(const hf_problem *p, double *move_m, double *by_weight_m)
{
    void *block;
    double *force;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(force, HF_TRUSS_DOF * (size_t)p->carrier.truss.n_node)));
    hf_status status = HF_OK;
    for (int k = 0; k < p->load_cases.n && status == HF_OK; k++) {
        hf_frame_load own = load_of_truss(&p->carrier, &p->load_cases.load_case[k], force);
        size_t at = 3 * (size_t)k * (size_t)p->carrier.n_attachment;
        status = move_attachments(&p->carrier, &own, move_m + at);
        own.temperature_K = NULL;
        if (status == HF_OK && by_weight_m) status = move_attachments(&p->carrier, &own, by_weight_m + at);
    }
    hf_arena_free_block(block);
    return status;
}

hf_status hf_load_case_stage_rest_by_heat(const hf_problem *p, double *move_m_per_K)
{
    const hf_tolerance_settings *s = &p->settings.tolerance;
    const hf_truss *t = &p->carrier.truss;
    void *block;
    double *rise_K;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(rise_K, t->n_member)));
    const hf_frame_load own = {.temperature_K = rise_K};
    hf_status status = HF_OK;
    for (int k = 0; k < s->n_truss && status == HF_OK; k++) {
        for (int e = 0; e < t->n_member; e++)
            rise_K[e] = hf_truss_is_of(t, e, (hf_part)(HF_PART_TRUSS + s->truss[k].part));
        status = move_attachments(&p->carrier, &own, move_m_per_K + 3 * (size_t)k * (size_t)p->carrier.n_attachment);
    }
    hf_arena_free_block(block);
    return status;
}

/* Runs load case k. `requirements` is NULL if no figure of it is required. */
static hf_status run_load_case(const hf_problem *p, int k, hf_load_case_stage *c, hf_store *store,
                               hf_requirements_stage *requirements, hf_load_case_summary *s, hf_messages *messages)
{
    const hf_load_case *load_case = &p->load_cases.load_case[k];
    bool has_truss = p->settings.has_truss;
    hf_frame_load own = {0};
    hf_built_net net;
    hf_carrier_state truss = {0};
    hf_status status = HF_OK;
    if (has_truss) {
        own = load_of_truss(&p->carrier, load_case, c->truss_force);
        status = move_attachments(&p->carrier, &own, c->attachment_move_m);
    }
    if (status != HF_OK) return hf_error(messages, status, "out of memory for the truss");
    hf_built_load_case(&c->built, &p->load_cases.material, load_case, has_truss ? c->attachment_move_m : NULL, c->cut_m,
                       c->move_m, c->load_N, &net);
    hf_built_solve(&c->built, &net, &c->workspace, &s->result);
    if (s->result.status != HF_OK) return HF_OK;
    hf_model loaded = c->built.model;
    loaded.load_N = c->load_N;
    if (requirements && requirements->required.nominal >> (1 + k) & 1u) hf_certify(&loaded, &c->workspace, &s->result);
    if (has_truss) {
        hf_coupling_forces(&loaded, &c->workspace);
        status = hf_carrier_load(&p->carrier, c->workspace.attachment_force_N, &own, &truss);
        if (status != HF_OK) hf_error(messages, status, "out of memory for the forces in the truss");
    }
    if (status == HF_OK) status = keep_shape(p, c, store, has_truss ? &truss : NULL, s, messages);
    if (status == HF_OK && requirements)
        status =
            hf_requirements_stage_take(requirements, 1 + k, &loaded, &c->workspace, &s->result, &s->surface, messages);
    hf_carrier_state_free(&truss);
    return status;
}

hf_status hf_load_case_stage_try(const hf_problem *p, const hf_workspace *shape, double most_s, double *all_s)
{
    hf_load_case_stage c = {0};
    hf_load_case_summary unread;
    hf_messages messages = {0};
    double begin_s = hf_clock_thread_cpu_s(), spent_s = 0;
    int n = 0;
    hf_status status = hf_load_case_stage_take(p, shape, &c, &messages);
    for (; status == HF_OK && n < p->load_cases.n && spent_s < most_s; n++) {
        unread = (hf_load_case_summary){0};
        status = run_load_case(p, n, &c, NULL, NULL, &unread, &messages);
        spent_s = hf_clock_thread_cpu_s() - begin_s;
    }
    if (status == HF_OK) *all_s = spent_s * p->load_cases.n / n;
    hf_load_case_stage_free(&c);
    hf_messages_free(&messages);
    return status;
}

hf_status hf_load_case_stage_measure(const hf_problem *p, const hf_workspace *shape, hf_requirements_stage *q,
                                     hf_messages *messages)
{
    hf_load_case_stage c = {0};
    unsigned needed = q->required.nominal >> 1;
    if (needed == 0) return HF_OK;
    hf_status status = hf_load_case_stage_take(p, shape, &c, messages);
    for (int k = 0; k < p->load_cases.n && status == HF_OK; k++) {
        hf_load_case_summary unread = {0};
        if (needed >> k & 1u) status = run_load_case(p, k, &c, NULL, q, &unread, messages);
    }
    hf_load_case_stage_free(&c);
    return status;
}

/* ---- all load cases ---- */

static void warn(const hf_load_case_summary *s, hf_messages *messages)
{
    const hf_form_result *r = &s->result;
    if (r->status != HF_OK)
        hf_warning(messages, "load_cases: no equilibrium was found in load case '%s': %s", s->name,
                   hf_status_text(r->status));
    else if (r->n_slack)
        hf_warning(messages, "load_cases: in load case '%s', %d cable%s slack and %d node%s loose", s->name, r->n_slack,
                   r->n_slack == 1 ? " is" : "s are", r->n_loose, r->n_loose == 1 ? " is" : "s are");
}

hf_status hf_stage_load_cases(hf_run *r, hf_summary *summary, hf_messages *messages)
{
    const hf_problem *p = &r->problem;
    hf_load_case_stage *c = &r->cases;
    c->workspace.stop = r->request->control.stop_requested;
    if (!summary->load_case) summary->load_case = calloc((size_t)p->load_cases.n, sizeof *summary->load_case);
    if (!summary->load_case) return hf_error(messages, HF_NO_MEMORY, "out of memory for the load cases");
    for (int k = 0; k < p->load_cases.n; k++) {
        hf_load_case_summary *s = &summary->load_case[k];
        *s = (hf_load_case_summary){.result.status = HF_NOT_EVALUATED};
        snprintf(s->name, sizeof s->name, "%s", p->load_cases.load_case[k].name);
        s->tension_min_N = s->tension_max_N = s->displacement_rms_m = s->member_force_max_N = (double)NAN;
        HF_TRY(run_load_case(p, k, c, r->store, &r->requirements, s, messages));
        if (hf_run_must_stop(r)) return HF_INTERRUPTED;
        summary->n_load_case = k + 1;
        warn(s, messages);
    }
    return HF_OK;
}
