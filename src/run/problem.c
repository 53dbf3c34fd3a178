/* Opens a case as a problem that evaluates designs, and finds the derivatives of its figures. */
#include <hifdm/problem.h>

#include "run/problem_nets.h"
#include "run/diagnose.h"
#include "run/problem_parts.h"
#include "search/jacobian.h"
#include "search/refine.h"

#include <math.h>
#include <stdlib.h>

hf_status hf_problem_open(const char *path, const char *const *set, int n_set, int n_thread, hf_problem *p,
                          hf_messages *messages)
{
    HF_TRY(hf_problem_load(path, NULL, set, n_set, NULL, p, messages));
    HF_TRY(hf_problem_allocate(p, messages));
    hf_evaluate_form(&p->model, &p->settings.form, &p->workspace, NULL, &p->form);
    HF_TRY(hf_problem_explain(p, messages));
    return hf_problem_prepare(p, n_thread, messages);
}

bool hf_problem_has_merit(const hf_problem *p)
{
    return p->settings.optimize.n_front == 0;
}

int hf_problem_list_figures(const hf_problem *p, const hf_result_field *field[HF_RESULT_N_INDIVIDUAL])
{
    int n = 0;
    hf_result_list_individual(field);
    for (int k = 0; k < HF_RESULT_N_INDIVIDUAL; k++)
        if (hf_problem_has_merit(p) || field[k]->offset != offsetof(hf_form_result, merit)) field[n++] = field[k];
    return n;
}

int hf_problem_n_slope(const hf_problem *p)
{
    return p->objectives.n_objective + hf_problem_has_merit(p);
}

const char *hf_problem_slope_name(const hf_problem *p, int i_slope, char text[HF_OBJECTIVE_NAME_SIZE])
{
    if (i_slope < p->objectives.n_objective) return hf_objectives_name(&p->objectives, i_slope, text);
    snprintf(text, HF_OBJECTIVE_NAME_SIZE, "%s", p->objectives.n_objective ? "merit" : "psi_m");
    return text;
}

hf_status hf_problem_has_slopes(const hf_problem *p, hf_messages *messages)
{
    const hf_optimize_settings *s = &p->settings.optimize;
    char place[HF_LOCATION_SIZE];
    for (int k = 0; k < p->objectives.n_objective; k++) /* the value is the quantile, whatever the refinement takes */
        if (p->objectives.objective[k].settings.quantile > 0)
            return hf_error(messages, HF_BAD_CASE,
                            "%s: quantiles have no derivatives. Use `take: mean` or `take: worst`",
                            hf_messages_location(messages, place, "optimize.%s.%d.quantile",
                                                 s->n_front > 0 ? "front" : "objective", k));
    if (hf_refine_applies(&p->evaluator)) return HF_OK;
    return hf_error(messages, HF_BAD_CASE, "%s", hf_problem_no_slopes(p));
}

hf_status hf_problem_slopes(hf_problem *p, int n, const double *design, const hf_form_result *result, double *slope,
                            hf_messages *messages)
{
    hf_jacobian jacobian;
    hf_form_result r;
    double *all = NULL; /* derivatives of all figures; the merit is last */
    size_t n_variable = (size_t)p->model.n_variable, size = (size_t)hf_problem_n_slope(p) * n_variable;
    HF_TRY(hf_problem_has_slopes(p, messages));
    hf_status status = hf_jacobian_create(&p->evaluator, &jacobian);
    if (status == HF_OK) all = malloc(((size_t)jacobian.n_figure * n_variable + 1) * sizeof *all);
    if (!all) status = HF_NO_MEMORY;
    for (int i = 0; i < n && status == HF_OK; i++) {
        if (result[i].status != HF_OK) continue;
        hf_status found = hf_evaluate(&p->evaluator, design + (size_t)i * n_variable, &p->workspace, &p->point, &r);
        if (found == HF_OK) found = hf_jacobian_find(&jacobian, &p->workspace, all);
        if (found == HF_NO_MEMORY) status = HF_NO_MEMORY;
        for (size_t k = 0; k < size; k++)
            slope[k] = found == HF_OK ? all[k] : (double)NAN;
        slope += size;
    }
    free(all);
    hf_jacobian_free(&jacobian);
    return status == HF_OK
               ? HF_OK
               : hf_error(messages, status, "out of memory for the derivatives with respect to %zu design variables",
                          n_variable);
}

void hf_problem_free(hf_problem *p)
{
    hf_batch_free(&p->batch);
    free(p->start_q_N_per_m);
    free(p->initial);
    hf_objectives_point_free(&p->point);
    hf_workspace_free(&p->workspace);
    hf_model_free(&p->model);
    hf_carrier_free(&p->carrier);
    hf_arena_free_block(p->limits.block);
    hf_objectives_free(&p->objectives);
    hf_problem_nets_free(p);
    hf_load_cases_free(&p->load_cases);
    hf_facets_free(&p->facets);
    hf_scene_free(&p->scene);
    hf_case_free(&p->settings);
    *p = (hf_problem){0};
}
