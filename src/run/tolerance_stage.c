/* Finds samples of the as-built net with errors of cutting, stiffness, supports and temperature (METHOD section 12).
 *
 *     design -> as-built net (hf_built_make), prediction to first order
 *         |
 *         v
 *     samples in chunks (hf_montecarlo_run) -> journal, kept for a resumed run and for other tasks
 *         | all chunks are there
 *         v
 *     statistics; the scale of the errors for the required shares -> summary and store
 *
 * hf_tolerance_stage_check refuses a case before the form-finding. hf_tolerance_stage_try estimates the time from a few
 * samples. */
#include "run/tolerance_stage.h"

#include "base/arena.h"
#include "base/clock.h"
#include "base/sha256.h"
#include "case/config_fault.h"
#include "net/cable_pick.h"
#include "run/stages.h"
#include "store/samples.h"
#include "store/store_tolerance.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <string.h>

#define SLACK_DOUBT 0.05   /* part of the samples with slack cables above which a warning appears */
#define SCALE_SAMPLES 1000 /* maximum samples of each yield in the search for the scale */

/* ---- checks of the case ---- */

/* Makes the beam whose loss the samples measure, at the highest frequency. Returns true if the facets are fine enough
 * for it. */
static bool make_beam(const hf_problem *p, hf_gain_beam *beam)
{
    hf_gain_beam_make(&p->surface, &p->facets, p->scene.position_m, hf_surface_highest_Hz(&p->surface), beam);
    return beam->order < HF_GAIN_ORDER_MOST;
}

static hf_status check_expansion(const hf_problem *p, const hf_material *t, hf_messages *messages)
{
    const hf_scene *s = &p->scene;
    char place[HF_LOCATION_SIZE];
    int n = 0, first = 0;
    const char *key =
        p->settings.tolerance.sigma_temperature_K > 0 ? "sigma_temperature_K" : "sigma_load_case_temperature_K";
    for (int e = 0; e < s->n_cable && hf_tolerance_is_warm(&p->settings.tolerance); e++)
        if (isnan(t->expansion_per_K[e]) && n++ == 0) first = e;
    if (n == 0) return HF_OK;
    return hf_error(messages, HF_BAD_CASE,
                    "%s: %d cable%s no expansion_per_K, such as '%s'. Add this value to a row of the list `cables`",
                    hf_config_place(&p->settings, place, "tolerance.%s", key), n, n == 1 ? " has" : "s have",
                    s->cable_id[first]);
}

/* Checks that each error of load cases has a load case that prescribes what it is an error of. */
static hf_status check_load_errors(const hf_problem *p, hf_messages *messages)
{
    const hf_tolerance_settings *t = &p->settings.tolerance;
    const struct {
        const char *key, *what, *advice;
        double sigma;
    } of[HF_LOAD_ERROR_N] = {{"sigma_load_case_temperature_K", "a temperature of the cables", "temperature_K",
                              t->sigma_load_case_temperature_K},
                             {"sigma_gravity_ratio", "gravity", "gravity_m_per_s2", t->sigma_gravity_ratio},
                             {"sigma_force_ratio", "forces", "force_N", t->sigma_force_ratio}};
    char place[HF_LOCATION_SIZE];
    hf_status status = HF_OK;
    for (int kind = 0; kind < HF_LOAD_ERROR_N; kind++) {
        bool has = !(of[kind].sigma > 0);
        for (int k = 0; k < p->load_cases.n && !has; k++)
            has = hf_load_case_may_err(&p->load_cases.load_case[k], p->scene.n_node, (hf_load_error)kind);
        if (!has)
            status = hf_error(
                messages, HF_BAD_CASE,
                "%s: no load case has %s, so this error has no effect. Add %s to a row of `load_cases`, or "
                "remove this key",
                hf_config_place(&p->settings, place, "tolerance.%s", of[kind].key), of[kind].what, of[kind].advice);
    }
    return status;
}

/* Checks that the parts of the truss in tolerance.truss exist and have an expansion. Returns HF_OK, or the status of
 * the last fault, with messages. */
static hf_status check_truss_heat(const hf_problem *p, hf_messages *messages)
{
    const hf_tolerance_settings *t = &p->settings.tolerance;
    hf_status worst = HF_OK;
    for (int i = 0; i < t->n_truss; i++) {
        char place[HF_LOCATION_SIZE];
        hf_config_place(&p->settings, place, "tolerance.truss.%d.part", i);
        hf_part part = (hf_part)(HF_PART_TRUSS + t->truss[i].part);
        hf_status status = hf_config_demand_expansion(&p->settings, &p->carrier.truss, part, place, "", messages);
        if (status != HF_OK) worst = status;
    }
    return worst;
}

/* Checks that all errors together leave at least half of each cable. Returns HF_OK, or HF_BAD_CASE with a message. */
#define LARGEST_NUMBER 9 /* no number of either distribution is larger */
static hf_status check_cuts(const hf_problem *p, const hf_material *material, hf_messages *messages)
{
    const hf_scene *s = &p->scene;
    const hf_tolerance_settings *t = &p->settings.tolerance;
    double by_ratio = LARGEST_NUMBER * t->sigma_cut_ratio * (sqrt(1 - t->batch) + sqrt(t->batch));
    char place[HF_LOCATION_SIZE];
    for (int e = 0; e < s->n_cable; e++) {
        double length = hf_scene_length_at_target(s, e), by_cut = LARGEST_NUMBER * t->sigma_cut_m / length;
        double by_heat = 0;
        if (hf_tolerance_is_warm(t) && !isnan(material->expansion_per_K[e])) /* check_expansion reports the others */
            by_heat = LARGEST_NUMBER * (t->sigma_temperature_K + t->sigma_load_case_temperature_K) *
                      fabs(material->expansion_per_K[e]);
        if (by_cut + by_ratio + by_heat < 0.5) continue;
        const char *key = by_cut >= by_ratio && by_cut >= by_heat ? "tolerance.sigma_cut_m"
                          : by_ratio >= by_heat                   ? "tolerance.sigma_cut_ratio"
                          : t->sigma_temperature_K > 0            ? "tolerance.sigma_temperature_K"
                                                                  : "tolerance.sigma_load_case_temperature_K";
        return hf_error(messages, HF_BAD_CASE,
                        "%s: cable '%s' is %.3g m long. At %d standard deviations, errors of cutting and temperature "
                        "change the cable length by the fraction %.3g, but the maximum is 0.5. Use smaller errors",
                        hf_config_place(&p->settings, place, "%s", key), s->cable_id[e], length, LARGEST_NUMBER,
                        by_cut + by_ratio + by_heat);
    }
    return HF_OK;
}

/* Writes the location of the section for messages: that of the first sigma in the case. Returns place. */
static const char *place_section(const hf_case *c, char place[HF_LOCATION_SIZE])
{
    static const char *const key[] = {"tolerance.sigma_cut_m",
                                      "tolerance.sigma_cut_ratio",
                                      "tolerance.sigma_EA_ratio",
                                      "tolerance.sigma_support_m",
                                      "tolerance.sigma_temperature_K",
                                      "tolerance.truss.0.part",
                                      "tolerance.sigma_load_case_temperature_K",
                                      "tolerance.sigma_gravity_ratio",
                                      "tolerance.sigma_force_ratio"};
    for (size_t i = 0; i < sizeof key / sizeof *key; i++)
        if (hf_config_location(c, key[i], place, HF_LOCATION_SIZE)) break;
    return place;
}

/* Refuses struts that are visible in the laws. Struts that result from other laws show only after form-finding. */
static hf_status check_struts(const hf_problem *p, hf_messages *messages)
{
    const hf_scene *s = &p->scene;
    char place[HF_LOCATION_SIZE];
    int n = 0, first = 0;
    for (int e = 0; e < s->n_cable; e++)
        if (hf_law_has(s->law[e], HF_LAW_MAY_PUSH) && s->target[e] < 0 && n++ == 0) first = e;
    if (n == 0) return HF_OK;
    return hf_error(messages, HF_BAD_CASE,
                    "%s: the as-built net cannot have struts, but %d cable%s in compression, such as '%s'",
                    place_section(&p->settings, place), n, n == 1 ? " is" : "s are", s->cable_id[first]);
}

hf_status hf_tolerance_stage_check(const hf_problem *p, const hf_material *material, hf_messages *messages)
{
    char place[HF_LOCATION_SIZE];
    place_section(&p->settings, place);
    const hf_status of[] = {
        check_expansion(p, material, messages),
        check_cuts(p, material, messages),
        hf_cable_demand_EA(&p->scene, place, "errors of as-built nets need", "", messages),
        check_struts(p, messages),
        check_truss_heat(p, messages),
        check_load_errors(p, messages),
    };
    for (size_t i = 0; i < sizeof of / sizeof *of; i++)
        HF_TRY(of[i]);
    return HF_OK;
}

/* ---- the identity of samples ---- */

static hf_status identify_case(const hf_problem *p, char identity[65])
{
    const hf_truss *truss = p->settings.has_truss ? &p->carrier.truss : NULL;
    return hf_store_identify(&p->settings, &p->scene, truss, identity);
}

/* The identity depends on the case and on the net made of the design, so machines that find different designs do not
 * share samples. */
static hf_status identify(const hf_problem *p, const hf_built *b, char identity[65])
{
    char of_case[65], of_design[65];
    HF_TRY(identify_case(p, of_case));
    hf_sha256(b->scene.target, (size_t)b->scene.n_cable * sizeof(double), of_design);
    hf_samples_identify(of_case, of_design, identity);
    return HF_OK;
}

hf_status hf_tolerance_stage_look(const hf_run_request *q, const hf_problem *p, const char *output,
                                  hf_messages *messages)
{
    char of_case[65];
    if (!p->settings.has_tolerance || q->output.restart || q->part.of_sweep) return HF_OK;
    if (identify_case(p, of_case) != HF_OK) return hf_error(messages, HF_NO_MEMORY, "tolerance: out of memory");
    return hf_samples_look(output, q->part.tasks > 0 ? q->part.task : -1, q->part.tasks, of_case, messages);
}

/* ---- samples ---- */

typedef struct {
    const hf_run_request *request;
    const hf_problem *problem;
    const hf_requirements_stage *requirements; /* NULL: none */
    const hf_workspace *shape;                 /* of the result, an equilibrium of problem->model */
    hf_built built;
    hf_montecarlo montecarlo;
    hf_gain_beam beam; /* of the net at the target positions, used for all shapes */
    hf_samples samples;
    void *rest_block;       /* displacements of the attachments in load cases */
    int i_design, n_design; /* design of several, whose samples are reported as one series */
    double begin_s;
} job;

static void job_free(job *j)
{
    hf_samples_close(&j->samples);
    hf_montecarlo_free(&j->montecarlo);
    hf_arena_free_block(j->rest_block);
    hf_built_free(&j->built);
}

/* Passes the progress of this phase to the observer, if there is one. No design is evaluated here. */
static void report(const job *j, hf_run_progress now)
{
    now.phase = HF_RUN_TOLERANCE;
    now.best_psi_m = now.merit = NAN;
    hf_run_report(&j->request->control, now);
}

static void report_samples(const job *j, long n_new, bool is_last)
{
    long n = j->samples.n, done = (long)j->samples.n_have * j->samples.n_chunk, before = j->i_design * n;
    report(j, (hf_run_progress){.samples = before + (done < n ? done : n),
                                .samples_all = n * j->n_design,
                                .evaluations = before + n_new,
                                .is_last = is_last && j->i_design == j->n_design - 1,
                                .elapsed_s = hf_clock_s() - j->begin_s});
}

/* Reports the search for the scale: all samples exist, and some are solved again with scaled errors. */
static void report_scale(void *context, double scale)
{
    const job *j = context;
    report(j, (hf_run_progress){.samples = j->samples.n,
                                .samples_all = j->samples.n,
                                .evaluations = j->samples.n,
                                .sigma_scale = scale,
                                .elapsed_s = hf_clock_s() - j->begin_s});
}

static hf_status find_samples(job *j, hf_messages *messages)
{
    const hf_run_part *part = &j->request->part;
    hf_samples *s = &j->samples;
    long n_new = 0;
    report_samples(j, 0, false);
    for (int chunk = 0; chunk < s->n_all; chunk++) {
        int n;
        long first = hf_samples_first(s, chunk, &n);
        bool is_mine = part->task < 0 || part->tasks <= 0 || chunk % part->tasks == part->task;
        if (s->has[chunk] || !is_mine) continue;
        hf_status status = hf_montecarlo_run(&j->montecarlo, 1, first, n);
        if (status == HF_NO_MEMORY)
            hf_error(messages, status, "tolerance: out of memory for the results of the samples");
        HF_TRY(status);
        HF_TRY(hf_samples_add(s, chunk, j->montecarlo.row));
        n_new += n;
        report_samples(j, n_new, s->n_have == s->n_all);
    }
    return HF_OK;
}

/* Opens the journals next to the result file; "": there is none. */
static hf_status open_samples(job *j, const char *beside, hf_messages *messages)
{
    const hf_problem *p = j->problem;
    const hf_run_request *q = j->request;
    char identity[65];
    bool is_task = hf_tolerance_stage_is_task(q);
    const char *output = *beside && !q->part.of_sweep ? beside : NULL; /* points of a sweep begin anew */
    if (identify(p, &j->built, identity) != HF_OK) return hf_error(messages, HF_NO_MEMORY, "tolerance: out of memory");
    HF_TRY(hf_samples_open(output, *beside ? beside : NULL, q->part.task, is_task ? q->part.tasks : 0, identity,
                           q->output.restart, p->settings.tolerance.samples, j->montecarlo.n_chunk,
                           j->montecarlo.n_value, &j->samples, messages));
    j->samples.stop = q->control.stop_requested;
    if (output && q->part.tasks > 0 && !is_task)
        HF_TRY(hf_samples_collect(&j->samples, output, q->part.tasks, q->output.restart));
    return HF_OK;
}

/* Adds to the samples what the requirements need. */
static hf_status require(job *j, hf_messages *messages)
{
    const hf_problem *p = j->problem;
    size_t n = 3 * (size_t)p->load_cases.n * (size_t)p->model.n_attachment;
    double *move_m, *by_weight_m;
    HF_TRY(HF_ARENA_ARRAYS(&j->rest_block, HF_ARRAY(move_m, n), HF_ARRAY(by_weight_m, n)));
    if (p->settings.has_truss) HF_TRY(hf_load_case_stage_rest(p, move_m, by_weight_m));
    const hf_built_rest rest = {move_m, by_weight_m}, none = {NULL, NULL};
    return hf_montecarlo_require(&j->montecarlo, &j->requirements->required, p->settings.has_truss ? &rest : &none,
                                 messages);
}

static hf_status open_montecarlo(job *j, hf_messages *messages)
{
    const hf_problem *p = j->problem;
    const hf_tolerance_settings *t = &p->settings.tolerance;
    hf_material material;
    double *by_heat;
    void *block = NULL;
    size_t n_move = 3 * (size_t)t->n_truss * (size_t)p->model.n_attachment;
    hf_status status = hf_config_material(&p->settings, &p->scene, &material, messages);
    if (status == HF_OK) {
        status = HF_ARENA_ARRAYS(&block, HF_ARRAY(by_heat, n_move));
        if (status == HF_OK) status = hf_load_case_stage_rest_by_heat(p, by_heat);
        hf_built_heat heat = {hf_tolerance_is_warm(t) ? material.expansion_per_K : NULL, t->n_truss ? by_heat : NULL};
        if (status == HF_OK)
            status = hf_montecarlo_create(t, &j->built, &p->surface, &p->facets, &heat, j->request->control.threads,
                                          &j->montecarlo);
        if (status == HF_OK && j->requirements) status = require(j, messages);
        if (status == HF_NO_MEMORY) hf_error(messages, status, "tolerance: out of memory");
        if (status == HF_SINGULAR)
            hf_error(messages, status,
                     "tolerance: the net of the design is not stiff even without errors, so the position of some node "
                     "is not unique");
    }
    hf_material_free(&material);
    hf_arena_free_block(block);
    return status;
}

/* ---- results ---- */

/* Returns the number of slack cables of the design. *first becomes the first of them. */
static int count_slack(const job *j, int *first)
{
    const hf_model *m = &j->problem->model;
    int n = 0;
    for (int e = m->n_cable - 1; e >= 0; e--) {
        if (!hf_metrics_is_slack(m, j->shape, e)) continue;
        *first = e;
        n++;
    }
    return n;
}

/* Warns about samples with slack cables: such a net is not the one that was designed. */
static hf_status warn_of_slack(const job *j, const hf_tolerance_summary *t, hf_messages *messages)
{
    const hf_scene *scene = &j->problem->scene;
    bool is_nominal = t->n_with_slack > SLACK_DOUBT * t->samples;
    int e = 0, n = is_nominal ? t->n_with_slack : t->n_with_slack_in_any, n_slack = count_slack(j, &e);
    char why[320] = "";
    if (n <= SLACK_DOUBT * t->samples) return HF_OK;
    if (!is_nominal)
        snprintf(why, sizeof why, " in a load case");
    else if (n_slack)
        snprintf(why, sizeof why, ": %d %s slack in the design already, such as '%.80s'", n_slack,
                 n_slack == 1 ? "is" : "are", scene->cable_id[e]);
    else {
        double deviation_N = 0;
        HF_TRY(hf_montecarlo_find_touchiest(&j->montecarlo, &e, &deviation_N));
        snprintf(why, sizeof why,
                 ": to first order, the errors change the tension of %.3g N in cable '%.80s' (EA %.3g N) with a "
                 "standard deviation of %.3g N",
                 j->shape->tension_N[e], scene->cable_id[e], j->built.scene.EA_N[e], deviation_N);
    }
    hf_warning(messages,
               "tolerance: cables are slack in %d of %d samples%s. Raise the minimum tensions (form.pretension_N, "
               "optimize.limits), use cables with a lower EA, or reduce the errors (tolerance.sigma_cut_m)",
               n, t->samples, why);
    return HF_OK;
}

static int scale_samples(const hf_tolerance_settings *t)
{
    return t->samples < SCALE_SAMPLES ? t->samples : SCALE_SAMPLES;
}

static hf_status sum_up(job *j, hf_store *store, hf_summary *summary, hf_messages *messages)
{
    const hf_tolerance_settings *t = &j->problem->settings.tolerance;
    const hf_statistics_rows rows = {j->samples.n, hf_samples_read, &j->samples, j->montecarlo.n_value};
    hf_tolerance_summary *to = summary->tolerance = calloc(1, sizeof *to);
    if (!to) return hf_error(messages, HF_NO_MEMORY, "tolerance: out of memory");
    hf_status status = hf_statistics_sum_up(&j->montecarlo, &rows, to);
    if (status == HF_OK && j->requirements)
        status = hf_requirements_stage_judge_samples(j->requirements, &j->montecarlo, &rows, summary, messages);
    if (status == HF_OK && t->find_scale) {
        to->scale_samples = scale_samples(t);
        j->montecarlo.tell = report_scale;
        j->montecarlo.tell_context = j;
        status = hf_montecarlo_find_scale(&j->montecarlo, to->scale_samples, &to->sigma_scale, &to->scale_bound);
    }
    if (status == HF_OK) status = warn_of_slack(j, to, messages);
    if (status != HF_OK) { /* the summary then says nothing about samples */
        free(to);
        summary->tolerance = NULL;
    }
    if (status == HF_NO_MEMORY) return hf_error(messages, status, "tolerance: out of memory");
    HF_TRY(status);
    to->tolerance_wall_s = hf_clock_s() - j->begin_s;
    return hf_store_tolerance(store, &j->montecarlo, &rows, messages);
}

static void aim_beam(job *j, hf_messages *messages)
{
    const hf_problem *p = j->problem;
    if (!hf_montecarlo_measures(&p->surface, &p->facets, HF_TOLERANCE_PATTERN_LOSS)) return;
    if (make_beam(p, &j->beam))
        j->montecarlo.beam = &j->beam;
    else
        hf_warning(messages, "tolerance: pattern_loss_dB is not measured at %g GHz: " HF_GAIN_TOO_COARSE,
                   hf_surface_highest_Hz(&p->surface) / 1e9);
}

/* ---- a trial ---- */

/* Solves the first samples, twice as many each time, while that takes no longer than a trial may. Samples with slack
 * cables take far longer than others, so few are not enough. TRIED samples are enough if they took TRIED_S; in a
 * shorter time the cold start would be a large part. */
#define TRIED 16 /* two rounds of the lanes of a thread */
#define TRIED_MOST 128
#define TRIED_S 0.1
#define OPERATIONS_PER_S 8e9 /* of one core, in solves with several right-hand sides */

static hf_status try_samples(job *j, double most_s, hf_tolerance_trial *trial, hf_messages *messages)
{
    const hf_problem *p = j->problem;
    HF_TRY(hf_built_make("", &p->scene, &p->model, &p->settings.form, j->shape, &j->built, messages));
    HF_TRY(open_montecarlo(j, messages));
    aim_beam(j, messages);
    trial->begin_s = hf_clock_thread_cpu_s() - j->begin_s;
    trial->n_load_case = j->montecarlo.n_load_case;
    double first_s = hf_clock_thread_cpu_s(), now_s = first_s, took_s = 0;
    for (int n = 1; n <= TRIED_MOST && n <= j->montecarlo.n_chunk; n *= 2) {
        double begin_s = now_s;
        if (begin_s - first_s + 2 * took_s > most_s) break;
        if (n > TRIED && took_s >= TRIED_S) break;
        HF_TRY(hf_montecarlo_run(&j->montecarlo, 1, 0, n));
        now_s = hf_clock_thread_cpu_s();
        took_s = now_s - begin_s;
        trial->sample_s = trial->scale_sample_s = took_s / n;
        trial->n_tried = n;
    }
    if (!trial->n_tried || !trial->scale_yields || hf_required_needs_surface(j->montecarlo.required, true, 0))
        return HF_OK;
    j->montecarlo.skips_surface = true;
    HF_TRY(hf_montecarlo_run(&j->montecarlo, 1, 0, trial->n_tried));
    trial->scale_sample_s = (hf_clock_thread_cpu_s() - now_s) / trial->n_tried;
    return HF_OK;
}

/* Tries the search for the scale itself, with TRIED nets. Nets with larger errors take longer, and yields that fail end
 * early, so the time of a sample does not predict that of the search. */
static hf_status try_scale(job *j, double most_s, hf_tolerance_trial *trial)
{
    double first_s = hf_clock_thread_cpu_s(), scale;
    int n = trial->scale_samples < TRIED ? trial->scale_samples : TRIED, bound;
    if (!trial->n_tried || trial->scale_yields * n * trial->scale_sample_s > most_s / 2) return HF_OK;
    HF_TRY(hf_montecarlo_find_scale(&j->montecarlo, n, &scale, &bound));
    trial->scale_s = (hf_clock_thread_cpu_s() - first_s) * trial->scale_samples / n;
    return HF_OK;
}

hf_status hf_tolerance_stage_try(const hf_problem *p, const hf_workspace *shape, double most_s,
                                 hf_tolerance_trial *trial)
{
    const hf_run_request request = {.control.threads = 1};
    job j = {.request = &request, .problem = p, .shape = shape, .begin_s = hf_clock_thread_cpu_s()};
    hf_messages messages = {0};
    /* The first order takes one solve for each coordinate of an inner node (built/covariance). */
    double rows = 3.0 * p->model.n_free, solves = 3.0 * p->model.n_inner_node;
    *trial =
        (hf_tolerance_trial){.begin_s = solves * 4 * rows * (3.0 * p->model.half_bandwidth + 2) / OPERATIONS_PER_S};
    if (p->settings.tolerance.find_scale) {
        trial->scale_yields = HF_SCALE_YIELDS;
        trial->scale_samples = scale_samples(&p->settings.tolerance);
    }
    hf_requirements_stage requirements;
    hf_status status = hf_requirements_stage_open(p, &requirements, &messages);
    j.requirements = &requirements;
    if (status == HF_OK && trial->begin_s <= most_s) status = try_samples(&j, most_s, trial, &messages);
    if (status == HF_OK && trial->scale_yields) status = try_scale(&j, most_s, trial);
    job_free(&j);
    hf_requirements_stage_free(&requirements);
    return status;
}

/* ---- the stage ---- */

static hf_status make_net(job *j, hf_messages *messages)
{
    const hf_problem *p = j->problem;
    char place[HF_LOCATION_SIZE];
    HF_TRY(hf_built_make(place_section(&p->settings, place), &p->scene, &p->model, &p->settings.form, j->shape,
                         &j->built, messages));
    j->built.stop = j->request->control.stop_requested;
    return HF_OK;
}

static hf_status work_off(job *j, hf_run *r, hf_summary *summary, hf_messages *messages)
{
    HF_TRY(make_net(j, messages));
    /* before the first sample: the first order takes a while in large nets */
    report(j, (hf_run_progress){.samples_all = j->problem->settings.tolerance.samples});
    HF_TRY(open_montecarlo(j, messages));
    aim_beam(j, messages);
    HF_TRY(open_samples(j, r->output, messages));
    HF_TRY(find_samples(j, messages));
    if (j->samples.n_have < j->samples.n_all) return HF_OK; /* a task of several */
    return sum_up(j, r->store, summary, messages);
}

hf_status hf_stage_samples(hf_run *r, hf_summary *summary, hf_messages *messages)
{
    job j = {.request = r->request,
             .problem = &r->problem,
             .requirements = &r->requirements,
             .shape = r->shape,
             .n_design = 1,
             .begin_s = hf_clock_s()};
    hf_status status = work_off(&j, r, summary, messages);
    job_free(&j);
    return status;
}

hf_status hf_tolerance_stage_judge(const hf_run *r, const hf_tolerance_design *design, hf_requirement_verdict *verdict,
                                   hf_messages *messages)
{
    hf_run_request request = *r->request;
    job j = {.request = &request,
             .problem = &r->problem,
             .requirements = &r->requirements,
             .shape = design->shape,
             .i_design = design->i,
             .n_design = design->n,
             .begin_s = design->begin_s};
    request.part = (hf_run_part){.of_sweep = true}; /* no journal, no tasks */
    hf_status status = make_net(&j, messages);
    if (status == HF_OK) status = open_montecarlo(&j, messages);
    if (status == HF_OK) {
        j.montecarlo.skips_surface = !hf_required_needs_surface(j.montecarlo.required, true, 0);
        status = open_samples(&j, r->output, messages);
    }
    if (status == HF_OK) status = find_samples(&j, messages);
    if (status == HF_OK) {
        const hf_statistics_rows rows = {j.samples.n, hf_samples_read, &j.samples, j.montecarlo.n_value};
        status = hf_statistics_judge(&j.montecarlo, &rows, verdict);
    }
    job_free(&j);
    return status;
}

void hf_tolerance_stage_end(const hf_run_request *q, const char *output)
{
    if (*output && !q->part.of_sweep) hf_samples_remove(output);
}
