/* Makes the as-built nets over which objectives are measured: load cases with the displacements of the truss, and
 * samples of the errors of tolerance. */
#include "run/problem_nets.h"

#include "base/arena.h"
#include "built/constraints.h"
#include "run/load_case_stage.h"
#include "run/requirements_stage.h"
#include "run/tolerance_stage.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct hf_problem_nets {
    hf_built_nets nets;
    hf_material material;                    /* expansion of the cables of samples */
    double *attachment_move_m, *by_weight_m; /* [n_load_case][3 n_attachment] m (hf_built_rest) */
    double *truss_move_m_per_K;              /* [n_truss][3 n_attachment] m/K, of samples */
    hf_tolerance_settings tolerance;         /* of the samples of a search under requirements */
    hf_required required;
    hf_material masses; /* mass of the cables, if a requirement needs it */
    hf_built_constraints constraints;
};

/* The verdict takes other samples than the search, so that no design is judged by the samples to which it was
 * fitted. */
#define SEED_OF_SEARCH 0x9e3779b97f4a7c15u
#define TAIL_LEAST 2 /* minimum number of samples that a share lets fail in the search */

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
    const hf_tolerance_settings *tolerance = &c->tolerance;
    bool is_on_truss = has_load_cases && p->model.n_attachment > 0, is_warm = hf_tolerance_is_warm(&c->tolerance);
    if (c->n_requirement > 0) {
        q->tolerance = c->tolerance;
        q->tolerance.seed ^= SEED_OF_SEARCH;
        tolerance = &q->tolerance;
    }
    if (n_sample > 0 && is_warm) HF_TRY(hf_config_material(c, &p->scene, &q->material, messages));
    hf_built_heat heat = {is_warm ? q->material.expansion_per_K : NULL,
                          c->tolerance.n_truss ? q->truss_move_m_per_K : NULL};
    hf_status status = is_on_truss ? hf_load_case_stage_rest(p, q->attachment_move_m, q->by_weight_m) : HF_OK;
    if (status == HF_OK && n_sample > 0 && c->tolerance.n_truss > 0)
        status = hf_load_case_stage_rest_by_heat(p, q->truss_move_m_per_K);
    if (status != HF_OK)
        return hf_error(messages, status, "hifdm cannot solve the truss of the as-built nets in the objectives: %s",
                        hf_status_text(status));
    const hf_built_rest rest = {q->attachment_move_m, q->by_weight_m}, none = {NULL, NULL};
    hf_built_nets_make(&p->scene, &p->model, &c->form, has_load_cases ? &p->load_cases : NULL,
                       is_on_truss ? &rest : &none, n_sample > 0 ? tolerance : NULL, &heat, n_sample, &q->nets);
    return HF_OK;
}

/* Returns the number of samples that the search needs. */
static int count_samples(const hf_problem *p)
{
    const hf_case *c = &p->settings;
    int n = hf_optimize_takes_samples(&c->optimize) ? c->optimize.samples : 0;
    for (int i = 0; i < c->n_requirement; i++) {
        const hf_requirement_settings *r = &c->requirement[i];
        if (r->search == HF_SEARCH_OFF || !(r->share > 0)) continue;
        int least = (int)ceil(TAIL_LEAST / (1 - r->share));
        if (n < c->optimize.samples) n = c->optimize.samples;
        if (n < least) n = least;
    }
    return n;
}

static bool constrains(const hf_problem *p)
{
    bool is_any = false;
    for (int i = 0; i < p->settings.n_requirement; i++)
        is_any |= p->settings.requirement[i].search == HF_SEARCH_ON;
    return is_any;
}

/* Returns the bits of the load cases in which rows of objectives need samples; load case k has bit 1 + k. */
static unsigned states_of_rows(const hf_problem *p, int n, const hf_objective_settings *row)
{
    unsigned states = 0;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < p->load_cases.n && row[i].over == HF_OVER_SAMPLES && *row[i].load_case; k++)
            if (hf_objective_takes_load_cases(&row[i]) || !strcmp(row[i].load_case, p->load_cases.load_case[k].name))
                states |= 2u << k;
    return states;
}

static unsigned states_of_objectives(const hf_problem *p)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    return states_of_rows(p, o->n_term, o->term) | states_of_rows(p, o->n_front, o->front);
}

/* Lists the load cases of the samples in the order of the case, as hf_objectives_nets wants them. */
static void list_states(const hf_problem *p, unsigned states, hf_objectives_nets *nets)
{
    for (int k = 0; k < p->load_cases.n; k++)
        if (states >> (1 + k) & 1u) nets->sample_load_case[nets->n_sample_state++] = k;
}

/* Adds to the nets the load cases of samples, and makes the constraints. */
static hf_status make_constraints(hf_problem *p, hf_messages *messages)
{
    struct hf_problem_nets *q = p->nets;
    HF_TRY(hf_requirements_stage_rows(p, &q->masses, &q->required, messages));
    unsigned many = hf_built_constraints_states(&q->required, true);
    bool has_nets = many || hf_built_constraints_states(&q->required, false) > 1u;
    list_states(p, many | states_of_objectives(p), &q->nets.as);
    hf_status status = hf_built_constraints_make(&q->required, &p->model, has_nets ? &q->nets : NULL, &p->surface,
                                                 &p->facets, &q->constraints);
    return status == HF_OK ? HF_OK : hf_error(messages, status, "out of memory for the requirements");
}

hf_status hf_problem_nets_make(hf_problem *p, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    bool is_constrained = constrains(p);
    bool has_load_cases = is_over_load_cases(o->term, o->n_term) || is_over_load_cases(o->front, o->n_front);
    int n_sample = count_samples(p);
    size_t n = 3 * (size_t)p->model.n_attachment;
    double *move_m, *by_weight, *by_heat;
    void *block; /* p->nets is the first item */
    for (int i = 0; i < p->settings.n_requirement; i++)
        has_load_cases |= strcmp(p->settings.requirement[i].load_case, "nominal") != 0;
    if (!has_load_cases && n_sample == 0 && !is_constrained) return HF_OK;
    if (HF_ARENA_ARRAYS(&block, HF_ARRAY(p->nets, 1), HF_ARRAY(move_m, (size_t)p->load_cases.n * n),
                        HF_ARRAY(by_weight, (size_t)p->load_cases.n * n),
                        HF_ARRAY(by_heat, (size_t)p->settings.tolerance.n_truss * n)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the as-built nets in the objectives");
    p->nets->attachment_move_m = move_m;
    p->nets->by_weight_m = by_weight;
    p->nets->truss_move_m_per_K = by_heat;
    HF_TRY(make_nets(p, has_load_cases, n_sample, messages));
    if (is_constrained) return make_constraints(p, messages);
    list_states(p, states_of_objectives(p), &p->nets->nets.as);
    return HF_OK;
}

void hf_problem_nets_free(hf_problem *p)
{
    if (p->nets) {
        hf_material_free(&p->nets->material);
        hf_material_free(&p->nets->masses);
        hf_arena_free_block(p->nets->constraints.block);
        hf_required_free(&p->nets->required);
    }
    hf_arena_free_block(p->nets);
    p->nets = NULL;
}

const hf_constraints *hf_problem_constraints_of(const hf_problem *p)
{
    return p->nets && p->nets->constraints.as.n > 0 ? &p->nets->constraints.as : NULL;
}

bool hf_problem_is_constrained_by(const hf_problem *p, int row)
{
    const hf_constraints *c = hf_problem_constraints_of(p);
    int k = 0;
    while (c && k < c->n && p->nets->constraints.row[k] != row)
        k++;
    return c && k < c->n;
}

const char *hf_problem_constraint_name(const hf_problem *p, int i_constraint, char *text, size_t size)
{
    char name[256];
    int row = p->nets->constraints.row[i_constraint];
    snprintf(text, size, "requirements.%d (%.160s)", row,
             hf_requirement_name(&p->settings.requirement[row], name, sizeof name));
    return text;
}

const char *hf_problem_broken_requirement(const hf_problem *p, char *text, size_t size)
{
    const hf_constraints *c = p->objectives.constraints;
    char name[256];
    int worst = -1, n_missed = 0;
    bool is_missed[HF_REQUIREMENT_ROWS_MAX] = {false};
    char others[48] = "";
    *text = '\0';
    for (int k = 0; c && k < c->n; k++) {
        double beyond = p->point.constraint[k] / c->unit[k];
        int row = p->nets->constraints.row[k];
        n_missed += beyond > 0 && !is_missed[row];
        is_missed[row] |= beyond > 0;
        if (beyond > 0 && (worst < 0 || beyond > p->point.constraint[worst] / c->unit[worst])) worst = k;
    }
    if (worst < 0) return text;
    if (n_missed > 1)
        snprintf(others, sizeof others, ", and %d more row%s missed", n_missed - 1, n_missed > 2 ? "s are" : " is");
    const hf_requirement_settings *r = &p->settings.requirement[p->nets->constraints.row[worst]];
    /* A count is judged by tensions. */
    const char *unit = r->figure == HF_REQUIRED_SLACK ? "N" : hf_required_figure_unit[r->figure];
    if (fabs(p->point.constraint[worst] / c->unit[worst] / HF_BUILT_NO_VALUE - 1) < 1e-9) {
        snprintf(text, size, ": bound of %s is missed, because the figure has no value%s",
                 hf_problem_constraint_name(p, worst, name, sizeof name), others);
        return text;
    }
    bool is_over_samples = !isnan(r->share), is_length = !strcmp(unit, "m");
    double times = is_length ? 1e3 : 1;
    if (is_length) unit = "mm";
    if (is_over_samples && hf_required_has_two_bounds(r) && r->figure != HF_REQUIRED_GAIN) {
        times = 100 / c->unit[worst];
        unit = "%";
    }
    snprintf(text, size, ": bound of %s is missed by %.3g%s%s%s%s",
             hf_problem_constraint_name(p, worst, name, sizeof name), times * p->point.constraint[worst],
             *unit ? " " : "", unit, is_over_samples ? " in samples of the search" : "", others);
    return text;
}

const hf_objectives_nets *hf_problem_nets_of(const hf_problem *p)
{
    return p->nets ? &p->nets->nets.as : NULL;
}
