/* Makes the as-built nets over which objectives are measured: load cases with the displacements of the truss, and
 * samples of the errors of tolerance. */
#include "run/problem_nets.h"

#include "base/arena.h"
#include "built/built_nets.h"
#include "run/load_case_stage.h"
#include "run/tolerance_stage.h"

struct hf_problem_nets {
    hf_built_nets nets;
    hf_material material;       /* expansion of the cables of samples */
    double *attachment_move_m;  /* [n_load_case][3 n_attachment] m */
    double *truss_move_m_per_K; /* [n_truss][3 n_attachment] m/K, of samples */
};

static bool is_over_load_cases(const hf_objective_settings *g, int n)
{
    bool is_over = false;
    for (int k = 0; k < n; k++)
        is_over |= *g[k].load_case != '\0';
    return is_over;
}

static hf_status make_nets(hf_problem *p, bool has_load_cases, int n_sample, hf_messages *messages)
{
    struct hf_problem_nets *q = p->nets;
    const hf_case *c = &p->settings;
    bool is_on_truss = has_load_cases && p->model.n_attachment > 0, is_warm = c->tolerance.sigma_temperature_K > 0;
    if (n_sample > 0) HF_TRY(hf_tolerance_stage_check(p, false, messages));
    if (n_sample > 0 && is_warm) HF_TRY(hf_config_material(c, &p->scene, &q->material, messages));
    hf_built_heat heat = {is_warm ? q->material.expansion_per_K : NULL,
                          c->tolerance.n_truss ? q->truss_move_m_per_K : NULL};
    hf_status status = is_on_truss ? hf_load_case_stage_rest(p, q->attachment_move_m) : HF_OK;
    if (status == HF_OK && n_sample > 0 && c->tolerance.n_truss > 0)
        status = hf_load_case_stage_rest_by_heat(p, q->truss_move_m_per_K);
    if (status != HF_OK)
        return hf_error(messages, status, "hifdm cannot solve the truss of the as-built nets in the objectives: %s",
                        hf_status_text(status));
    hf_built_nets_make(&p->scene, &p->model, &c->form, has_load_cases ? &p->load_cases : NULL,
                       is_on_truss ? q->attachment_move_m : NULL, n_sample > 0 ? &c->tolerance : NULL, &heat, n_sample,
                       &q->nets);
    return HF_OK;
}

hf_status hf_problem_nets_make(hf_problem *p, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    bool has_load_cases = is_over_load_cases(o->term, o->n_term) || is_over_load_cases(o->front, o->n_front);
    int n_sample = hf_optimize_takes_samples(o) ? o->samples : 0;
    size_t n = 3 * (size_t)p->model.n_attachment;
    double *move_m, *by_heat;
    void *block; /* p->nets is the first item */
    if (!has_load_cases && n_sample == 0) return HF_OK;
    if (HF_ARENA_ARRAYS(&block, HF_ARRAY(p->nets, 1), HF_ARRAY(move_m, (size_t)p->load_cases.n * n),
                        HF_ARRAY(by_heat, (size_t)p->settings.tolerance.n_truss * n)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the as-built nets in the objectives");
    p->nets->attachment_move_m = move_m;
    p->nets->truss_move_m_per_K = by_heat;
    return make_nets(p, has_load_cases, n_sample, messages);
}

void hf_problem_nets_free(hf_problem *p)
{
    if (p->nets) hf_material_free(&p->nets->material);
    hf_arena_free_block(p->nets);
    p->nets = NULL;
}

const hf_objectives_nets *hf_problem_nets_of(const hf_problem *p)
{
    return p->nets ? &p->nets->nets.as : NULL;
}
