/* Implements <hifdm/summary.h> without the JSON, and the words and groups of the stages. */
#include <hifdm/summary.h>

#include <hifdm/store.h>

#include <math.h>
#include <stdlib.h>

const char *const hf_stage_word[HF_N_STAGE + 1] = {"form", "search", "refine", "none"};
const char *const hf_stage_group[HF_N_STAGE + 1] = {"/form", "/search", "/refine", "/"};

void hf_summary_free(hf_summary *s)
{
    for (int i = 0; i < HF_N_STAGE; i++) {
        free(s->stage[i].pattern);
        free(s->stage[i].sets);
        free(s->stage[i].held);
        free(s->stage[i].optima);
    }
    free(s->front);
    free(s->load_case);
    free(s->tolerance);
    free(s->requirement);
    *s = (hf_summary){0};
}

const char *hf_summary_algorithm(const hf_summary *s, hf_stage stage)
{
    if (stage == HF_STAGE_SEARCH) return s->objectives.is_front ? "nsga2" : "ga";
    return stage == HF_STAGE_REFINE ? "lm" : "";
}

bool hf_summary_has_shape(const hf_summary *s, hf_stage stage)
{
    const hf_stage_summary *of = &s->stage[stage];
    if (stage == HF_STAGE_FORM) return true;
    return of->exists && (stage == HF_STAGE_REFINE || (of->result.status == HF_OK && s->finished));
}

double hf_summary_utilisation(const hf_summary *s)
{
    double available_s = s->stage[HF_STAGE_SEARCH].wall_s * s->threads;
    return available_s > 0 ? s->search.cpu_s / available_s : (double)NAN;
}

hf_stage hf_store_result_stage(const hf_summary *s)
{
    if (s->stage[HF_STAGE_REFINE].exists && s->refine.is_result) return HF_STAGE_REFINE;
    return hf_summary_has_shape(s, HF_STAGE_SEARCH) ? HF_STAGE_SEARCH : HF_STAGE_FORM;
}

hf_judgement hf_summary_judge(const hf_summary *s)
{
    bool is_of_point = s->front && hf_front_is_judged(s->front) && hf_front_suggested(s->front) > 0;
    return is_of_point ? s->front->first.judgement : hf_requirements_judge(s->n_requirement, s->requirement);
}

hf_status hf_summary_status(const hf_summary *s)
{
    return s->finished ? s->status : s->stage[HF_STAGE_FORM].result.status;
}
