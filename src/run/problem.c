#include <hifdm/problem.h>

#include "solve/limits.h"

#include "run/problem_parts.h"

#include <stdlib.h>

hf_status hf_problem_open(const char *path, const char *const *set, int n_set, int n_thread, hf_problem *p,
                          hf_messages *messages)
{
    HF_TRY(hf_problem_load(path, set, n_set, p, messages));
    HF_TRY(hf_problem_allocate(p, messages));
    hf_evaluate_form(&p->model, &p->settings.form, &p->workspace, NULL, &p->form);
    HF_TRY(hf_problem_explain(p, messages));
    HF_TRY(hf_problem_base(p, messages));
    if (hf_problem_batch(p, n_thread) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the batch of a net of %d nodes", p->model.n_node);
    hf_problem_share(p);
    return HF_OK;
}

void hf_problem_free(hf_problem *p)
{
    hf_batch_free(&p->batch);
    free(p->start_q_N_per_m);
    free(p->base_N);
    hf_workspace_free(&p->workspace);
    hf_model_free(&p->model);
    hf_carrier_free(&p->carrier);
    hf_limits_free(&p->limits);
    hf_goals_free(&p->goals);
    hf_states_free(&p->states);
    hf_facets_free(&p->facets);
    hf_scene_free(&p->scene);
    hf_case_free(&p->settings);
    *p = (hf_problem){0};
}
