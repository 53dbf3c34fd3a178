/* Finds the shape of the case, explains, measures and stores it. */
#include "run/stages.h"

#include "base/clock.h"
#include "run/problem_parts.h"

#include <math.h>
#include <stdlib.h>

#define HISTORY_MAX 1000000 /* maximum number of iterations in the history */

/* Allocates the history with calloc, because calloc does not touch the memory. Most form-findings fill less than a
 * thousandth of the history. */
static hf_status create_history(const hf_form_settings *s, bool has_truss, hf_history *h, void **block)
{
    double **const column[] = {
        &h->psi_m,        &h->residual_N,      &h->inner_tension_ratio, &h->boundary_tension_ratio,
        &h->length_error, &h->coupling.step_m, &h->coupling.psi_m,      &h->coupling.deflection_max_m};
    h->capacity = s->max_iterations < HISTORY_MAX ? s->max_iterations : HISTORY_MAX;
    h->coupling.capacity = has_truss ? s->coupling.max_iterations : 0;
    double *to = *block = calloc(5 * (size_t)h->capacity + 3 * (size_t)h->coupling.capacity, sizeof *to);
    for (int k = 0; k < 8 && to; k++) {
        *column[k] = to;
        to += k < 5 ? h->capacity : h->coupling.capacity;
    }
    return *block ? HF_OK : HF_NO_MEMORY;
}

/* Measures and stores the shape in the problem's workspace. Returns HF_INTERRUPTED for an interrupted measurement after
 * the shape is stored. */
static hf_status keep_form(hf_run *r, const hf_history *history, hf_summary *s, hf_messages *messages)
{
    hf_problem *p = &r->problem;
    hf_status status = hf_problem_explain(p, messages);
    if (status != HF_OK && status != HF_NOT_CONVERGED) return status;
    hf_status measured = hf_stage_measure(r, HF_STAGE_FORM, &p->workspace, s, messages);
    if (measured != HF_OK && measured != HF_INTERRUPTED) return measured;
    HF_TRY(hf_store_form(r->store, &p->model, &p->workspace, history, messages));
    r->may_publish = hf_store_generations(r->store) == 0;
    HF_TRY(measured);
    HF_TRY(hf_stage_take(r, &p->workspace, messages));
    return status;
}

hf_status hf_stage_form(hf_run *r, hf_summary *s, hf_messages *messages)
{
    hf_problem *p = &r->problem;
    hf_stage_summary *to = &s->stage[HF_STAGE_FORM];
    hf_history history = {0};
    void *block;
    HF_TRY(hf_problem_allocate(p, messages));
    p->workspace.stop = r->request->control.stop_requested;
    if (create_history(&p->settings.form, p->model.n_attachment > 0, &history, &block) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for a net of %d nodes", p->model.n_node);
    hf_run_report(&r->request->control, (hf_run_progress){.phase = HF_RUN_FORM, .best_psi_m = NAN, .merit = NAN});
    double start_s = hf_clock_s();
    hf_evaluate_form(&p->model, &p->settings.form, &p->workspace, &history, &p->form);
    to->wall_s = hf_clock_s() - start_s;
    to->exists = true;
    to->result = p->form;
    for (int k = 0; k < HF_DESIGN_ROWS_MAX; k++) /* measured in hf_stage_begin, with the initial design */
        to->result.objective[k] = (double)NAN;
    hf_status status = keep_form(r, &history, s, messages);
    free(block);
    return status;
}
