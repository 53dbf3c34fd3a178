/* Leads from a case to a problem that can evaluate designs, step by step.
 *
 *     case file or source
 *         | load: scene, surface and facets, prestress, model, truss, load cases, limits, objectives, symmetry
 *         v
 *     model  -- allocate, form-finding (evaluate.c) -->  shape
 *         | base: initial design and evaluator, with checks of its bounds
 *         | batch, share: threads and the factorisation that they share
 *         v
 *     problem */
#include "run/problem_parts.h"

#include "base/elementary.h"
#include "base/file_out.h"
#include "case/config_fault.h"
#include "linalg/lapack.h"
#include "net/scene_doubt.h"
#include "net/symmetry.h"
#include "net/variables.h"
#include "run/problem_nets.h"
#include "run/requirements_stage.h"
#include "run/tolerance_stage.h"
#include "search/refine.h"
#include "surface/facet_mesh.h"
#include "solve/limits.h"
#include "solve/prestress.h"
#include <hifdm/evaluate.h>
#include <hifdm/optimiser.h>
#include <hifdm/pattern.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RUZE_MOST_DB 3.0        /* maximum loss for which Ruze's formula holds */
#define FACET_LOSS_MOST_DB 1.0  /* loss above which facets are too coarse for the surface (METHOD section 13) */
#define PATTERN_TERMS_MOST 1e13 /* maximum terms of a far field at one frequency: hours on one core */
#define SAME_VALUE 1e-12        /* relative rounding of a value that equals its bound */
#define WAVELENGTHS_LEAST 5.0   /* minimum diameter of a reflector for physical optics */

/* ---- from the case to the model ---- */

/* Checks the frequencies of the far field. Returns HF_OK, with a warning if the reflector is too small for physical
 * optics. Returns HF_BAD_CASE with a message if a far field would take too many terms. */
static hf_status check_frequencies(const hf_problem *p, const hf_feed *feed, double area_m2, hf_messages *messages)
{
    const hf_double_list *at = &p->surface.frequencies_Hz;
    const hf_pattern_surface theory = {&p->facets, p->scene.position_m, NULL};
    char place[HF_LOCATION_SIZE];
    double least_Hz = INFINITY;
    for (int k = 0; k < at->n; k++) {
        hf_far_field plan;
        hf_pattern_plan(&p->surface.pattern, &theory, feed, at->value[k], &plan);
        double terms = (double)plan.n_point * hf_pattern_angles(&plan);
        least_Hz = fmin(least_Hz, at->value[k]);
        if (terms <= PATTERN_TERMS_MOST) continue;
        return hf_error(
            messages, HF_BAD_CASE,
            "%s: at %g GHz, the far field needs %.3g quadrature points times %d angles. The far field is therefore a "
            "sum of %.2g terms, but the maximum is %g terms. Lower the frequency, or narrow surface.pattern.theta_deg",
            hf_config_place(&p->settings, place, "surface.frequencies_Hz"), at->value[k] / 1e9, (double)plan.n_point,
            hf_pattern_angles(&plan), terms, PATTERN_TERMS_MOST);
    }
    double across = 2 * sqrt(area_m2 / HF_PI) * least_Hz / HF_LIGHT_M_PER_S;
    if (across < WAVELENGTHS_LEAST)
        hf_warning(messages,
                   "surface.pattern: at %g GHz, the reflector is only %.2g wavelengths across, but physical optics is "
                   "valid only above about %g wavelengths",
                   least_Hz / 1e9, across, WAVELENGTHS_LEAST);
    return HF_OK;
}

/* Checks that the feed sees all facets of the net at the target positions, and warns if these are too coarse to be
 * taken for the surface. Returns HF_OK, HF_BAD_CASE or HF_NO_MEMORY, with a message. */
static hf_status check_pattern(const hf_problem *p, hf_messages *messages)
{
    char place[HF_LOCATION_SIZE];
    hf_feed feed;
    hf_surface_measures m;
    const hf_facet_shape theory = {.position_m = p->scene.position_m};
    const double most_Hz = hf_surface_highest_Hz(&p->surface);
    bool is_given = hf_config_location(&p->settings, "surface.pattern.feed.position_m", place, sizeof place);
    if (!is_given) hf_config_place(&p->settings, place, "surface.pattern");
    if (p->facets.n_facet == 0)
        return hf_error(messages, HF_BAD_CASE, "%s: the far field needs facets, but this net has no facets", place);
    int n_dark = hf_feed_make(&p->surface, &p->facets, p->scene.position_m, &feed);
    if (isnan(feed.axis[2]))
        return hf_error(messages, HF_BAD_CASE, "%s: the feed at (%g, %g, %g) m cannot aim at its own position",
                        hf_config_place(&p->settings, place, "surface.pattern.feed.aim_m"), feed.position_m[0],
                        feed.position_m[1], feed.position_m[2]);
    if (n_dark > 0)
        return hf_error(messages, HF_BAD_CASE,
                        "%s: from (%g, %g, %g) m, the feed illuminates %d of %d facets from behind or not at all. "
                        "Place the feed above all facets, and aim the feed at the facets",
                        place, feed.position_m[0], feed.position_m[1], feed.position_m[2], n_dark, p->facets.n_facet);
    if (hf_facet_measure(&p->surface, &p->facets, &theory, &m) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the surface errors");
    HF_TRY(check_frequencies(p, &feed, m.facet_area_m2, messages));
    double loss_dB = hf_surface_ruze_dB(m.facet_fit_half_path_rms_m, most_Hz);
    char loss[32] = "more than 3 dB";
    if (loss_dB <= RUZE_MOST_DB) snprintf(loss, sizeof loss, "%.2g dB", loss_dB);
    if (loss_dB > FACET_LOSS_MOST_DB)
        hf_warning(messages,
                   "surface.pattern: at %g GHz, the facets are coarse. Even at the target positions, the half-path "
                   "error of the facets is %.3g mm RMS, with a loss of %s to grating lobes. A net of about %.0f facets "
                   "instead of %d would lose %g dB",
                   most_Hz / 1e9, m.facet_fit_half_path_rms_m * 1e3, loss,
                   ceil(p->facets.n_facet * sqrt(loss_dB / FACET_LOSS_MOST_DB)), p->facets.n_facet, FACET_LOSS_MOST_DB);
    return HF_OK;
}

static hf_status find_facets(hf_problem *p, hf_messages *messages)
{
    if (hf_facets_find(&p->scene, &p->surface, &p->facets) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the facets of a net of %d nodes", p->scene.n_node);
    if (!p->facets.is_planar)
        hf_warning(messages, "surface: as seen along the z axis, cables of the surface cross without a common node, so "
                             "hifdm cannot find the facets");
    else if (p->facets.n_facet == 0)
        hf_warning(messages,
                   "surface: the net has no facets, so hifdm computes errors and losses from the nodes alone");
    return p->surface.has_pattern ? check_pattern(p, messages) : HF_OK;
}

static void find_key_place(const void *settings, const char *key, char *text, size_t size)
{
    hf_config_location(settings, key, text, size);
}

/* Keeps the first status that is not HF_OK. Returns true if this one is HF_OK. */
static bool keep(hf_status status, hf_status *first)
{
    if (*first == HF_OK) *first = status;
    return status == HF_OK;
}

/* Creates limits and objectives from their rows, and reports the faults of both. The as-built nets are made only if the
 * case has had no fault before. */
static void judge_by_rows(hf_problem *p, hf_status *first, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    keep(hf_limits_create(&p->scene, &p->model, o, &p->limits, messages), first);
    if (*first == HF_OK && (o->n_term || o->n_front || p->settings.n_requirement))
        keep(hf_problem_nets_make(p, messages), first);
    if (o->n_term || o->n_front || hf_problem_constraints_of(p))
        keep(hf_objectives_create(&p->scene, &p->model, o, &p->surface, &p->facets, hf_problem_nets_of(p),
                                  &p->objectives, messages),
             first);
    p->objectives.constraints = hf_problem_constraints_of(p);
}

static hf_status make_scene(const hf_problem_source *source, hf_problem *p, hf_messages *messages)
{
    if (!source) return hf_config_scene(&p->settings, &p->scene, messages);
    if (!p->settings.has_import || *p->settings.facets_path)
        return hf_error(messages, HF_BAD_CASE,
                        "%s: a net from arrays needs a `scene` section that imports nodes and cables but no facets",
                        p->settings.path);
    HF_TRY(hf_scene_from_arrays(source->net, p->settings.EA_N, &p->scene, messages));
    HF_TRY(hf_scene_check(&p->scene, messages));
    return hf_scene_doubt(&p->scene, messages);
}

hf_status hf_problem_hold_at(const hf_problem *p, const hf_problem_source *source, double pretension_N,
                             double *tension_N)
{
    hf_messages unread = {0};
    hf_problem *other = calloc(1, sizeof *other);
    if (!other) return HF_NO_MEMORY;
    other->settings = p->settings;
    other->settings.form.pretension_N = pretension_N;
    hf_status status = make_scene(source, other, &unread);
    if (status == HF_OK) status = hf_prestress_hold(&other->scene, &other->settings.form, NULL, &unread);
    for (int e = 0; status == HF_OK && e < p->scene.n_cable; e++)
        tension_N[e] = other->scene.target[e] * hf_scene_length_at_target(&other->scene, e);
    hf_scene_free(&other->scene);
    hf_messages_free(&unread);
    free(other);
    return status;
}

/* Makes all that follows from the case and its scene. *first is the status of the case. A part whose keys have faults,
 * or that needs a part with faults, is not made; the faults of all others are reported. */
static void make_parts(hf_problem *p, const volatile sig_atomic_t *stop, hf_material *material, hf_status *first,
                       hf_messages *messages)
{
    const hf_case *c = &p->settings;
    bool has_surface =
        hf_config_is_sound(c, "surface") && keep(hf_config_surface(c, &p->scene, &p->surface, messages), first);
    if (!has_surface) p->surface.focal_length_m = 0; /* other parts do without */
    has_surface = has_surface && (!c->has_surface || keep(find_facets(p, messages), first));
    bool has_material = hf_config_is_read(c, "cables") && hf_config_is_sound(c, "nodes") &&
                        keep(hf_config_material(c, &p->scene, material, messages), first);
    keep(hf_requirements_stage_check(p, has_material ? material : NULL, messages), first);
    bool has_model = hf_config_is_sound(c, "form") &&
                     (c->form.prestress != HF_PRESTRESS_EXACT ||
                      keep(hf_prestress_hold(&p->scene, &c->form, stop, messages), first)) &&
                     keep(hf_model_build(&p->scene, &c->form, &p->model, messages), first);
    bool optimizes = c->has_optimize && has_model && has_surface && hf_config_is_sound(c, "optimize");
    bool has_variables =
        optimizes && keep(hf_variables_apply(&p->scene, &c->optimize, &p->surface, &p->model, messages), first);
    bool has_truss = !c->has_truss || (hf_config_is_sound(c, "truss") &&
                                       keep(hf_config_carrier(c, &p->scene, &p->carrier, messages), first));
    if (c->has_truss && has_truss && has_model) {
        const hf_carrier *t = &p->carrier;
        has_truss =
            keep(hf_model_attach(&p->model, t->n_attachment, t->scene_node, t->flexibility_m_per_N, messages), first);
        p->model.truss_stiffness = t->stiffness.n > 0 ? &t->stiffness : NULL;
        if (c->has_optimize) hf_model_want_newton(&p->model);
    }
    const hf_truss *truss = c->has_truss ? &p->carrier.truss : NULL;
    bool has_built = has_material && has_truss && hf_config_is_sound(c, "load_cases") &&
                     keep(hf_config_load_cases(c, &p->scene, truss, &p->load_cases, messages), first);
    if (c->has_tolerance && has_built && has_model && hf_config_is_sound(c, "tolerance"))
        keep(hf_tolerance_stage_check(p, material, messages), first);
    if (optimizes && has_truss) judge_by_rows(p, first, messages);
    if (has_variables && has_truss)
        keep(hf_symmetry_apply(&p->scene, &c->optimize, &p->model, &p->planes, messages), first);
}

static hf_status load_parts(const char *path, const hf_problem_source *source, const char *const *set, int n_set,
                            const volatile sig_atomic_t *stop, hf_problem *p, hf_messages *messages)
{
    hf_material material = {0};
    hf_status first = source ? hf_config_parse(path, source->text, set, n_set, &p->settings, messages)
                             : hf_config_load(path, set, n_set, &p->settings, messages);
    if (first != HF_OK && !(first == HF_BAD_CASE && hf_config_is_sound(&p->settings, "scene"))) return first;
    if (keep(make_scene(source, p, messages), &first)) make_parts(p, stop, &material, &first, messages);
    hf_material_free(&material);
    return first;
}

hf_status hf_problem_load(const char *path, const hf_problem_source *source, const char *const *set, int n_set,
                          const volatile sig_atomic_t *stop, hf_problem *p, hf_messages *messages)
{
    *p = (hf_problem){0};
    messages->find_location = find_key_place;
    messages->location_context = &p->settings;
    hf_status status = load_parts(path, source, set, n_set, stop, p, messages);
    messages->find_location = NULL;
    messages->location_context = NULL;
    return status;
}

hf_status hf_problem_allocate(hf_problem *p, hf_messages *messages)
{
    HF_TRY(hf_lapack_load(messages));
    p->start_q_N_per_m = malloc((size_t)p->model.n_cable * sizeof(double));
    p->initial = malloc(((size_t)p->model.n_variable + 1) * sizeof(double));
    if (!p->start_q_N_per_m || !p->initial || hf_workspace_create(&p->model, &p->workspace) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for a net of %d nodes", p->model.n_node);
    return HF_OK;
}

/* Returns true if no cable uses form.pretension_N. */
static bool has_own_tensions(const hf_problem *p)
{
    if (p->settings.form.prestress == HF_PRESTRESS_EXACT) return false;
    for (int e = 0; e < p->scene.n_cable; e++)
        if (p->scene.law[e] == HF_LAW_TENSION && isnan(p->scene.target[e])) return false;
    return true;
}

void hf_problem_describe(const hf_problem *p, hf_summary *s)
{
    const hf_case *settings = &p->settings;
    const hf_model *model = &p->model;
    snprintf(s->title, sizeof s->title, "%s", settings->title);
    snprintf(s->case_path, sizeof s->case_path, "%s", settings->path);
    s->threads = 1;
    s->seed = settings->optimize.seed;
    s->n_node = model->n_node;
    s->n_free = model->n_free;
    s->n_inner_node = model->n_inner_node;
    s->uncounted_move_m = s->scale_min = s->scale_max = (double)NAN;
    s->n_cable = model->n_cable;
    s->n_variable = model->n_variable;
    s->search.n_leader = model->n_leader;
    s->half_bandwidth = model->half_bandwidth;
    s->search.planes = p->planes;
    s->has_coupling = model->n_attachment > 0;
    s->pretension_N = model->pretension_N;
    s->has_own_tensions = has_own_tensions(p);
    s->surface = p->surface;
    s->objectives.n = p->objectives.n_objective;
    s->objectives.is_front = settings->optimize.n_front > 0;
    for (int k = 0; k < s->objectives.n; k++) {
        const hf_objective_settings *wanted = &p->objectives.objective[k].settings;
        hf_objectives_name(&p->objectives, k, s->objectives.name[k]);
        s->objectives.weight[k] = wanted->weight;
        bool of_surface = wanted->figure == HF_FIGURE_SURFACE || wanted->figure == HF_FIGURE_FACETS;
        s->objectives.after_fit[k] = !of_surface ? -1 : wanted->feed == HF_REFOCUSED;
    }
    s->taken = settings->taken;
    s->has_truss = settings->has_truss;
    s->truss.mass_kg = p->carrier.mass_kg;
    s->truss.n_node = p->carrier.truss.n_node;
    s->truss.n_member = p->carrier.truss.n_member;
}

hf_status hf_problem_spare_inputs(const hf_problem *p, const char *table, const char *output, hf_messages *messages)
{
    const hf_case *c = &p->settings;
    const char *input[] = {
        c->path, table, c->nodes_path, c->cables_path, c->facets_path, c->truss_nodes_path, c->truss_members_path,
    };
    for (size_t i = 0; i < sizeof input / sizeof *input; i++)
        HF_TRY(hf_file_out_spare(input[i], "an input of this run", output, messages));
    for (int i = 0; i < c->built.n_load_case; i++)
        HF_TRY(hf_file_out_spare(c->built.load_case[i].nodes_path, "an input of this run", output, messages));
    return HF_OK;
}

/* ---- the initial design ---- */

hf_evaluator hf_problem_evaluator(const hf_problem *p)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    return (hf_evaluator){.model = &p->model,
                          .form = &p->settings.form,
                          .start_q_N_per_m = p->start_q_N_per_m,
                          .rule = o->rule,
                          .solver = o->solver,
                          .boundary_ratio_cap = p->settings.has_optimize ? o->boundary_ratio_cap : INFINITY,
                          .limits = p->limits.n ? &p->limits : NULL,
                          .objectives = p->objectives.n_objective ? &p->objectives : NULL,
                          .initial = p->initial};
}

/* Checks that design variable k has an initial value and bounds that allow values; those of cables must be above zero.
 * Returns HF_OK, or HF_NO_FEASIBLE or HF_BAD_CASE with a message. */
static hf_status check_variable(const hf_problem *p, int k, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    double base = p->initial[k], lower, upper, reach;
    char name[HF_VARIABLE_NAME_SIZE], where[HF_LOCATION_SIZE];
    hf_model_variable_name(&p->model, &p->scene, k, name, sizeof name);
    bool is_row = p->model.variable, is_cable = p->model.variable_cable[k] >= 0;
    if (is_cable && !(base > 0))
        return hf_error(messages, HF_NO_FEASIBLE,
                        "optimize: %s '%s' has no tension after form-finding, so the search cannot start. Use a "
                        "shorter length or a law that keeps this cable taut",
                        is_row ? "cable" : "boundary cable", name);
    if (is_row)
        hf_config_place(&p->settings, where, "optimize.variables.%d", p->model.variable[k].setting);
    else
        hf_config_place(&p->settings, where, "optimize.range_N");
    if (!is_row && (base + o->range_N < o->min_tension_N || base - o->range_N > o->max_tension_N))
        return hf_error(messages, HF_BAD_CASE,
                        "%s: boundary cable '%s' has a tension of %g N after form-finding. The range of %g N (range_N) "
                        "around this tension does not overlap the interval from min_tension_N %g to max_tension_N %g",
                        where, name, base, o->range_N, o->min_tension_N, o->max_tension_N);
    hf_variables_bound(o, &p->model, k, base, &lower, &upper, &reach);
    if (is_row && is_cable && !(upper > 0))
        return hf_error(
            messages, HF_BAD_CASE,
            "%s: the bounds of '%s' allow no value above 0 %s, but tensions and lengths of cables must be above zero",
            where, name, hf_model_variable_unit(&p->model, k));
    if (is_row && (base + reach < lower || base - reach > upper))
        return hf_error(messages, HF_BAD_CASE,
                        "%s: the design variable '%s' has the value %g %s after form-finding. The range around this "
                        "value does not overlap the bounds of the design variable",
                        where, name, base, hf_model_variable_unit(&p->model, k));
    if (hf_optimiser_plan_of(o).kind && !isfinite(upper - lower))
        return hf_error(messages, HF_BAD_CASE,
                        "%s: the design variable '%s' has no bound on one side. Add the missing bound or a range for "
                        "the genetic algorithm, or use optimize.method: lm",
                        where, name);
    return HF_OK;
}

const char *hf_problem_no_slopes(const hf_problem *p)
{
    if (p->model.has_strut) return "there are no derivatives of nets with struts";
    if (p->settings.optimize.rule == HF_RULE_SEEDED) return "there are no derivatives under optimize.rule seeded";
    if (p->model.has_newton) return "there are no derivatives of quantiles";
    return "there are no derivatives by the default variables where every cable keeps its force density, as with "
           "form.prestress exact; give optimize.variables, as [{set: boundary, vary: force_density, range: 10 %}]";
}

void hf_problem_limit_search(hf_problem *p)
{
    hf_optimize_settings *o = &p->settings.optimize;
    const hf_evaluator v = hf_problem_evaluator(p);
    if (o->method != HF_OPTIMIZE_AUTO || o->n_front > 0 || !hf_refine_applies(&v)) return;
    int most = hf_refine_generations(&v, o->population);
    if (o->generations > most) o->generations = most;
}

void hf_problem_warn_of_refine(const hf_problem *p, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    hf_optimiser_plan plan = hf_optimiser_plan_of(o);
    if (!plan.kind || o->n_front > 0 || hf_refine_applies(&p->evaluator)) return;
    if (plan.ends_with_refine || o->refine == HF_REFINE_TRUE)
        hf_warning(messages, HF_PROBLEM_REFINE_NEEDS, hf_problem_no_slopes(p));
}

void hf_problem_warn_of_front(const hf_problem *p, hf_messages *messages)
{
    const hf_case *c = &p->settings;
    if (c->optimize.n_front == 0 || (p->load_cases.n == 0 && !c->has_tolerance)) return;
    hf_warning(messages,
               "optimize.front: a front is not a single design, so hifdm computes %s%s%s for the net after "
               "form-finding, before optimisation. To compute load cases or samples for point N of the front, run "
               "`hifdm run %s --point FRONT.h5:N -o point.h5`",
               p->load_cases.n ? "load cases" : "", p->load_cases.n && c->has_tolerance ? " and " : "",
               c->has_tolerance ? "samples" : "", c->path);
}

/* Warns if values after form-finding are outside the bounds of their row, because the search then starts at another
 * shape. */
static void warn_of_bounds(const hf_problem *p, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    char where[HF_LOCATION_SIZE];
    for (int i = 0; i < o->n_variable_row; i++) {
        const hf_variable_settings *row = &o->variable_row[i];
        double low = INFINITY, high = -INFINITY;
        int n = 0, n_outside = 0, last = 0;
        for (int k = 0; k < p->model.n_variable; k++) {
            if (p->model.variable[k].setting != i) continue;
            n++;
            double rounding = SAME_VALUE * fabs(p->initial[k]);
            n_outside += p->initial[k] < row->lower - rounding || p->initial[k] > row->upper + rounding;
            low = fmin(low, p->initial[k]);
            high = fmax(high, p->initial[k]);
            last = k;
        }
        if (n_outside == 0) continue;
        hf_config_place(&p->settings, where, "optimize.variables.%d.bounds", i);
        hf_warning(messages,
                   "%s: the search starts at another shape, because %d of %d values after form-finding are outside "
                   "these bounds. The values are from %.4g to %.4g %s; widen the bounds to include them",
                   where, n_outside, n, low, high, hf_model_variable_unit(&p->model, last));
    }
}

hf_status hf_problem_base(hf_problem *p, hf_messages *messages)
{
    const hf_model *m = &p->model;
    const hf_workspace *w = &p->workspace;
    memcpy(p->start_q_N_per_m, w->q_N_per_m, (size_t)m->n_cable * sizeof(double));
    hf_variables_read(m, w->q_N_per_m, w->tension_N, w->length_m, p->initial);
    p->evaluator = hf_problem_evaluator(p);
    if (!p->point.block && hf_objectives_point_create(p->evaluator.objectives, &p->point) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the objectives");
    bool optimizes = p->settings.has_optimize && m->n_variable > 0;
    for (int k = 0; k < m->n_variable && optimizes; k++)
        HF_TRY(check_variable(p, k, messages));
    if (optimizes && m->variable) warn_of_bounds(p, messages);
    if (optimizes && !hf_optimiser_plan_of(&p->settings.optimize).kind && !hf_refine_applies(&p->evaluator))
        return hf_error(messages, HF_BAD_CASE, HF_PROBLEM_REFINE_NEEDS, hf_problem_no_slopes(p));
    hf_symmetry_average(m, p->initial);
    return HF_OK;
}

/* ---- the batch ---- */

hf_status hf_problem_batch(hf_problem *p, int n_thread)
{
    hf_status status = hf_batch_create(&p->evaluator, n_thread, &p->batch);
    p->evaluator.n_thread = p->batch.n_thread;
    return status;
}

hf_status hf_problem_prepare(hf_problem *p, int n_thread, hf_messages *messages)
{
    HF_TRY(hf_problem_base(p, messages));
    if (hf_problem_batch(p, n_thread) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for evaluations of a net of %d nodes", p->model.n_node);
    return hf_problem_share(p, messages);
}

hf_status hf_problem_share(hf_problem *p, hf_messages *messages)
{
    int n_taut = 0;
    while (n_taut < p->model.n_variable && (p->model.variable_cable[n_taut] < 0 || p->initial[n_taut] > 0))
        n_taut++;
    p->solver = HF_SOLVER_AUTO;
    if (n_taut > 0 && n_taut == p->model.n_variable) p->solver = hf_batch_share(&p->batch, p->initial);
    if (!p->batch.lacks_memory) return HF_OK;
    return hf_error(messages, HF_NO_MEMORY, "out of memory for the data that all designs of a net of %d nodes share",
                    p->model.n_node);
}
