/* Writes messages that explain why a run has no design: counts of evaluations, the limit that the initial design
 * exceeds most, and the settings to change. */
#include "run/no_design.h"

#include "solve/limits.h"
#include <hifdm/batch.h>
#include <hifdm/summary.h>

#include <math.h>
#include <stdio.h>

const char *hf_no_design_cap(const hf_problem *p, double boundary_tension_ratio, char text[HF_NO_DESIGN_HINT_SIZE])
{
    char place[HF_LOCATION_SIZE];
    double cap = p->settings.optimize.boundary_ratio_cap;
    *text = '\0';
    if (!(boundary_tension_ratio > cap)) return text;
    if (hf_config_location(&p->settings, "optimize.boundary_ratio_cap", place, sizeof place)) return text;
    snprintf(
        text, HF_NO_DESIGN_HINT_SIZE,
        "; %g is the default of optimize.boundary_ratio_cap: if the net may have a larger ratio, set this key in the "
        "case",
        cap);
    return text;
}

/* Writes which limit the shape in the workspace exceeds most, ": tension of cable c7 is 9, but the
 * bound of optimize.limits.1 is 50", or "". */
static void name_broken(const hf_problem *p, const hf_workspace *w, const hf_form_result *r,
                        char text[2 * HF_HELD_NAME_SIZE])
{
    *text = '\0';
    if (hf_status_has_shape(r->status)) hf_limits_name_broken(&p->evaluator, &p->scene, w, text, 2 * HF_HELD_NAME_SIZE);
}

hf_status hf_no_design_evolved(hf_problem *p, const hf_population *of, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    long above = of->n_evaluation_above_cap, shapeless = of->n_evaluation_infeasible - above;
    const char *wider = p->model.variable ? "the ranges and bounds of optimize.variables" : "optimize.range_N";
    hf_form_result base;
    char broken[2 * HF_HELD_NAME_SIZE], hint[HF_NO_DESIGN_HINT_SIZE];
    const hf_workspace *w = hf_batch_run_one(&p->batch, of->initial, &base);
    name_broken(p, w, &base, broken);
    if (above > 0 && o->n_limit > 0)
        return hf_error(messages, HF_NO_FEASIBLE,
                        "optimize: no feasible design: %ld of %ld evaluations exceed optimize.limits or "
                        "boundary_ratio_cap%s%s; loosen the limits, or widen %s%s",
                        above, of->n_evaluation, *broken ? "; of the initial design, the" : "",
                        broken + (*broken == ':'), wider, hf_no_design_cap(p, base.boundary_tension_ratio, hint));
    if (above == 0)
        return hf_error(messages, HF_NO_FEASIBLE,
                        "optimize: no feasible design: none of %ld evaluations has a shape (%s); narrow %s to keep "
                        "designs closer to "
                        "the initial design",
                        shapeless, hf_status_text(of->trial_status[0]), wider);
    char of_initial[64] = "has no shape", others[64] = "";
    if (isfinite(base.boundary_tension_ratio))
        snprintf(of_initial, sizeof of_initial, "has %.4g", base.boundary_tension_ratio);
    if (shapeless > 0) snprintf(others, sizeof others, ", %ld have no shape", shapeless);
    return hf_error(
        messages, HF_NO_FEASIBLE,
        "optimize: no feasible design: %ld of %ld evaluations are above boundary_ratio_cap %g%s; the initial "
        "design %s; raise optimize.boundary_ratio_cap, or widen %s%s",
        above, of->n_evaluation, o->boundary_ratio_cap, others, of_initial, wider, hf_no_design_cap(p, INFINITY, hint));
}

const char *hf_no_design_to_refine(hf_problem *p, const double *design, hf_status status, char text[HF_NO_DESIGN_SIZE])
{
    hf_form_result start;
    char broken[2 * HF_HELD_NAME_SIZE], hint[HF_NO_DESIGN_HINT_SIZE];
    hf_evaluate(&p->evaluator, design, &p->workspace, &start);
    name_broken(p, &p->workspace, &start, broken);
    snprintf(text, HF_NO_DESIGN_SIZE, "optimize: Levenberg-Marquardt has no feasible start: %s%s%s",
             hf_status_text(status), broken, hf_no_design_cap(p, start.boundary_tension_ratio, hint));
    return text;
}
