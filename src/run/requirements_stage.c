/* Gives the verdicts on the rows of `requirements` (METHOD section 14):
 *
 *     shape of the result, shapes of the load cases -> values with error bounds -> verdicts of the nominal net
 *     rows of the samples (tolerance_stage.c)                                   -> verdicts of the shares
 *         |
 *         v
 *     summary; warnings about bounds in another unit than the figure, also once for all points of a study */
#include "run/requirements_stage.h"

#include "base/arena.h"
#include "case/config_fault.h"
#include "built/required_radio.h"
#include "net/cable_pick.h"
#include "run/stages.h"
#include "run/tolerance_stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- checks ---- */

static hf_status check_masses(const hf_problem *p, const hf_material *material, int i, const int *cable, int n,
                              hf_messages *messages)
{
    char place[HF_LOCATION_SIZE];
    int n_unknown = 0, first = 0;
    for (int k = 0; k < n && material; k++)
        if (isnan(material->mass_kg_per_m[cable[k]]) && n_unknown++ == 0) first = cable[k];
    if (n_unknown == 0) return HF_OK;
    return hf_error(messages, HF_BAD_CASE,
                    "%s: %d cable%s no mass per length, such as '%s'. Add mass_kg_per_m to a row of the list `cables`",
                    hf_config_place(&p->settings, place, "requirements.%d.figure", i), n_unknown,
                    n_unknown == 1 ? " has" : "s have", p->scene.cable_id[first]);
}

static hf_status check_frequency(const hf_problem *p, int i, hf_messages *messages)
{
    char place[HF_LOCATION_SIZE];
    hf_gain_beam beam;
    double frequency_Hz = p->settings.requirement[i].frequency_Hz;
    hf_gain_beam_make(&p->surface, &p->facets, p->scene.position_m, frequency_Hz, &beam);
    if (beam.order < HF_GAIN_ORDER_MOST) return HF_OK;
    return hf_error(messages, HF_BAD_CASE,
                    "%s: hifdm cannot compute this figure at %g GHz, because " HF_GAIN_TOO_COARSE,
                    hf_config_place(&p->settings, place, "requirements.%d.figure", i), frequency_Hz / 1e9);
}

static hf_status check_row(const hf_problem *p, const hf_material *material, int i, int *cable, hf_messages *messages)
{
    const hf_requirement_settings *r = &p->settings.requirement[i];
    char place[HF_LOCATION_SIZE];
    int n = hf_cable_pick_some(&p->scene, r->set, hf_config_place(&p->settings, place, "requirements.%d.set", i), cable,
                               messages);
    if (n == 0) return HF_BAD_CASE;
    if (r->figure == HF_REQUIRED_MASS) return check_masses(p, material, i, cable, n, messages);
    if (!(p->surface.focal_length_m > 0)) return HF_OK; /* no section surface, or one with faults */
    bool is_radio = hf_required_is_of(r->figure, HF_REQUIRED_OF_RADIO);
    if (is_radio && p->facets.n_facet == 0)
        return hf_error(messages, HF_BAD_CASE,
                        "%s: this net has no facets, so it has no gain. Add cables that enclose facets to its surface",
                        hf_config_place(&p->settings, place, "requirements.%d.figure", i));
    if (r->figure == HF_REQUIRED_FACETS && p->facets.n_facet == 0)
        return hf_error(messages, HF_BAD_CASE,
                        "%s: this net has no facets. To bound the errors of the nodes, use the figure surface",
                        hf_config_place(&p->settings, place, "requirements.%d.figure", i));
    return is_radio && r->frequency_Hz > 0 ? check_frequency(p, i, messages) : HF_OK;
}

hf_status hf_requirements_stage_check(const hf_problem *p, const hf_material *material, hf_messages *messages)
{
    int *cable;
    void *block;
    hf_status worst = HF_OK;
    if (p->settings.n_requirement == 0) return HF_OK;
    if (HF_ARENA_ARRAYS(&block, HF_ARRAY(cable, p->scene.n_cable)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the requirements");
    for (int i = 0; i < p->settings.n_requirement; i++)
        if (hf_config_is_read(&p->settings, "requirements.%d", i) &&
            hf_config_is_sound(&p->settings, "requirements.%d.set", i) &&
            check_row(p, material, i, cable, messages) != HF_OK)
            worst = HF_BAD_CASE;
    hf_arena_free_block(block);
    return worst;
}

/* ---- measuring the design ---- */

hf_status hf_requirements_stage_rows(const hf_problem *p, hf_material *masses, hf_required *q, hf_messages *messages)
{
    const hf_case *c = &p->settings;
    bool needs_mass = false;
    for (int i = 0; i < c->n_requirement; i++)
        needs_mass |= c->requirement[i].figure == HF_REQUIRED_MASS;
    if (needs_mass) HF_TRY(hf_config_material(c, &p->scene, masses, messages));
    hf_status status =
        hf_required_create(c->n_requirement, c->requirement, &p->scene, &p->load_cases, masses->mass_kg_per_m, q);
    if (status == HF_OK) status = hf_required_radio_make(q, &p->surface, &p->facets, p->scene.position_m);
    return status == HF_OK ? HF_OK : hf_error(messages, status, "out of memory for the requirements");
}

hf_status hf_requirements_stage_open(const hf_problem *p, hf_requirements_stage *q, hf_messages *messages)
{
    *q = (hf_requirements_stage){0};
    HF_TRY(hf_requirements_stage_rows(p, &q->material, &q->required, messages));
    size_t n = (size_t)q->required.n_state * (size_t)q->required.n_column;
    if (HF_ARENA_ARRAYS(&q->block, HF_ARRAY(q->value, n), HF_ARRAY(q->item, n), HF_ARRAY(q->error, n)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the requirements");
    hf_requirements_stage_forget(q);
    return HF_OK;
}

void hf_requirements_stage_forget(hf_requirements_stage *q)
{
    for (int k = 0; k < q->required.n_state * q->required.n_column; k++)
        q->value[k] = q->item[k] = q->error[k] = (double)NAN;
}

void hf_requirements_stage_free(hf_requirements_stage *q)
{
    hf_required_free(&q->required);
    hf_material_free(&q->material);
    hf_arena_free_block(q->block);
    *q = (hf_requirements_stage){0};
}

hf_status hf_requirements_stage_take(hf_requirements_stage *q, int state, const hf_model *m, const hf_workspace *w,
                                     const hf_form_result *r, const hf_surface_measures *s, hf_messages *messages)
{
    const hf_required *of = &q->required;
    const hf_required_net net = {m, w->position_m, w->tension_N};
    hf_antenna_figures radio[HF_REQUIREMENT_ROWS_MAX], radio_error[HF_REQUIREMENT_ROWS_MAX];
    unsigned what[HF_REQUIREMENT_ROWS_MAX];
    size_t at = (size_t)state * (size_t)of->n_column;
    hf_required_shape shape = {.model = m,
                               .position_m = w->position_m,
                               .tension_N = w->tension_N,
                               .displacement_m = w->displacement_m,
                               .loose = r->n_loose ? w->loose : NULL,
                               .n_loose = r->n_loose,
                               .paths = {NAN, NAN, NAN, NAN},
                               .radio = radio,
                               .radio_error = radio_error,
                               .work = w};
    if (!(of->nominal >> state & 1u)) return HF_OK;
    if (hf_required_radio_what(of, false, state, what) &&
        (hf_required_radio_measure(of, of->antenna, what, &net, radio) != HF_OK ||
         hf_required_radio_bound(of, what, &net, r->position_bound_m, radio_error) != HF_OK))
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the requirements");
    if (s->is_measured) {
        double fit_m = s->fit.converged ? s->fit.half_path_rms_m : (double)NAN;
        shape.paths =
            (hf_surface_paths){s->half_path_rms_m, fit_m, s->facet_half_path_rms_m, s->facet_fit_half_path_rms_m};
    }
    hf_required_measure(of, false, state, &shape, q->value + at, q->item + at);
    hf_required_bound_errors(of, state, &shape, r->position_bound_m, r->psi_bound_m, q->value + at, q->error + at);
    return HF_OK;
}

/* ---- verdicts ---- */

void hf_requirements_stage_clear(const hf_requirements_stage *q, hf_requirement_verdict *verdict)
{
    const double none = (double)NAN;
    for (int i = 0; i < q->required.n; i++)
        verdict[i] = (hf_requirement_verdict){.row = q->required.row[i],
                                              .verdict = HF_VERDICT_NONE,
                                              .value = none,
                                              .bound = none,
                                              .margin = none,
                                              .relative_margin = none,
                                              .error_bound = none,
                                              .yield = none,
                                              .yield_low = none,
                                              .yield_high = none,
                                              .worst_sample = -1,
                                              .worst_margin = none,
                                              .worst_value = none};
}

/* Allocates the verdicts of the summary, without any verdict. */
static hf_status make_verdicts(const hf_requirements_stage *q, hf_summary *s, hf_messages *messages)
{
    if (!s->requirement) s->requirement = calloc((size_t)q->required.n, sizeof *s->requirement);
    if (!s->requirement) return hf_error(messages, HF_NO_MEMORY, "out of memory for the requirements");
    hf_requirements_stage_clear(q, s->requirement);
    return HF_OK;
}

void hf_requirements_stage_judge_design(const hf_requirements_stage *q, hf_requirement_verdict *verdict)
{
    for (int i = 0; i < q->required.n; i++)
        if (isnan(verdict[i].row.share))
            hf_required_judge_nominal(&q->required, i, q->value, q->item, q->error, &verdict[i]);
}

hf_status hf_requirements_stage_judge_samples(const hf_requirements_stage *q, const hf_montecarlo *t,
                                              const hf_statistics_rows *rows, hf_summary *s, hf_messages *messages)
{
    if (q->required.n_share == 0) return HF_OK;
    HF_TRY(make_verdicts(q, s, messages));
    return hf_statistics_judge(t, rows, s->requirement);
}

/* Returns by which factor a length, force or mass is off the nearer bound of its row, and sets *is_most to whether that
 * is at_most. Returns 0 if there is no such factor: a bound of 0 has no unit to be wrong in. */
static double factor_of(hf_required_figure figure, const double bounds[2], double value, bool *is_most)
{
    const char *unit = hf_required_figure_unit[figure];
    double nearest = 0;
    if ((strcmp(unit, "m") != 0 && strcmp(unit, "N") != 0 && strcmp(unit, "kg") != 0) || !(fabs(value) > 1e-9))
        return 0;
    for (int k = 0; k < 2; k++) {
        double factor = bounds[k] > 0 ? bounds[k] / fabs(value) : (double)NAN, off = fmax(factor, 1 / factor);
        if (isnan(factor) || (nearest > 0 && !(off < nearest))) continue;
        nearest = off;
        *is_most = k == 1;
    }
    return nearest;
}

/* Warns about a bound that is probably in mm, kN or g. The factor allows that the value is five times off the bound in
 * the right unit: with a bound in mm, a value that fails by 8 % is less than a thousand times off. */
#define OTHER_UNIT 200.0
static void doubt_bound(const char *place, hf_required_figure figure, double bound, const char *what, double value,
                        double factor, hf_messages *messages)
{
    const char *unit = hf_required_figure_unit[figure], *small = *unit == 'm' ? "mm" : *unit == 'k' ? "g" : "mN";
    if (factor < OTHER_UNIT) return;
    hf_warning(
        messages,
        "%s: the bound %.6g %s (%.6g %s) and the %s %.6g %s (%.6g %s) differ by a factor of %.3g. Check the unit "
        "of the bound",
        place, bound, unit, bound * 1e3, small, what, value, unit, value * 1e3, small, factor);
}

static void doubt_bounds(const hf_case *c, const hf_requirement_verdict *v, int i, hf_messages *messages)
{
    const hf_requirement_settings *r = &v->row;
    char place[HF_LOCATION_SIZE];
    const double bounds[2] = {r->at_least, r->at_most};
    bool is_most = false;
    double factor = factor_of(r->figure, bounds, v->value, &is_most);
    const char *key = isfinite(r->within[is_most]) ? "within" : is_most ? "at_most" : "at_least";
    hf_config_place(c, place, "requirements.%d.%s", i, key);
    doubt_bound(place, r->figure, bounds[is_most], "value", v->value, factor, messages);
}

/* A requirement at one point of a study, from the row of the ledger. */
typedef struct {
    hf_required_figure figure;
    double value, bounds[2];
} tried;

/* Reads the requirements of a point. Returns their number. */
static int read_tried(const hf_point *p, tried row[HF_REQUIREMENT_ROWS_MAX])
{
    static const char *const key[] = {"value_", "at_least_", "at_most_"};
    char name[HF_OBJECTIVE_NAME_SIZE];
    const char *names = p->field ? p->field[hf_ledger_names_field()] : "",
               *text = p->field ? p->field[hf_ledger_n_column() + HF_LEDGER_LIST_REQUIREMENTS] : "";
    double value;
    int n = 0;
    for (; names && *names && n < HF_REQUIREMENT_ROWS_MAX; names = strchr(names, ';'), names += names != NULL)
        row[n++] = (tried){hf_ledger_figure(names), (double)NAN, {NAN, NAN}};
    while (hf_ledger_next_value(HF_LEDGER_LIST_REQUIREMENTS, &text, name, &value))
        for (int k = 0; k < 3; k++) {
            size_t length = strlen(key[k]);
            int i = strncmp(name, key[k], length) ? -1 : atoi(name + length);
            if (i < 0 || i >= n) continue;
            if (k == 0) row[i].value = value;
            if (k > 0) row[i].bounds[k - 1] = value;
        }
    return n;
}

void hf_requirements_stage_doubt_points(const hf_points *points, hf_messages *messages)
{
    tried row[HF_REQUIREMENT_ROWS_MAX], nearest[HF_REQUIREMENT_ROWS_MAX];
    double least[HF_REQUIREMENT_ROWS_MAX] = {0};
    bool is_most = false;
    for (int p = 0; p < points->n_point; p++)
        for (int i = 0, n = read_tried(&points->point[p], row); i < n; i++) {
            if (row[i].figure == HF_REQUIRED_N_FIGURE) continue;
            double factor = factor_of(row[i].figure, row[i].bounds, row[i].value, &is_most);
            if (factor == 0 || (least[i] > 0 && !(factor < least[i]))) continue;
            least[i] = factor;
            nearest[i] = row[i];
            nearest[i].bounds[0] = row[i].bounds[is_most];
        }
    for (int i = 0; i < HF_REQUIREMENT_ROWS_MAX; i++) {
        char place[32];
        snprintf(place, sizeof place, "requirements.%d", i);
        if (least[i] > 0)
            doubt_bound(place, nearest[i].figure, nearest[i].bounds[0], "nearest value of all points", nearest[i].value,
                        least[i], messages);
    }
}

hf_status hf_stage_verdicts(hf_run *r, hf_summary *s, hf_messages *messages)
{
    hf_requirements_stage *q = &r->requirements;
    const hf_required *of = &q->required;
    if (hf_tolerance_stage_is_task(r->request) || !r->shape) return HF_OK;
    /* a front is no design, so that load cases and samples are those of the form-finding, too */
    hf_stage stage = r->front.n_point ? HF_STAGE_FORM : hf_store_result_stage(s);
    const hf_stage_summary *result = &s->stage[stage == HF_N_STAGE ? HF_STAGE_FORM : stage];
    HF_TRY(hf_requirements_stage_take(q, 0, &r->problem.model, r->shape, &result->result, &result->surface, messages));
    if (of->n_share == 0) HF_TRY(make_verdicts(q, s, messages));
    hf_requirements_stage_judge_design(q, s->requirement);
    for (int i = 0; i < of->n; i++)
        doubt_bounds(&r->problem.settings, &s->requirement[i], i, messages);
    s->n_requirement = of->n;
    return HF_OK;
}
