/* Contents: names for what went wrong - form-finding - optimisation - output and signals -
 * the whole run */
#include "run.h"

#include "print.h"
#include "text.h"
#include "polish.h"
#include "symmetry.h"
#include <hifdm/batch.h>
#include <hifdm/metrics.h>
#include <hifdm/store.h>

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define NAMED_MAX 5         /* cables or chains that a message names */
#define HISTORY_MAX 1000000 /* iterations whose history is kept */

double hf_run_clock_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Everything a run owns. */
typedef struct {
    hf_case settings;
    hf_scene scene;
    hf_model model;
    hf_workspace workspace;
    hf_history history;
    hf_store *store;
    hf_evaluator evaluator;
    double *start_q_N_per_m; /* [n_cable] of the found shape */
    double *base_N;          /* [n_gene] boundary pretensions of the found shape */
    hf_batch batch;
    hf_ga ga;
} run;

static void run_free(run *r)
{
    hf_store_abandon(r->store); /* NULL once it is finished */
    hf_ga_free(&r->ga);
    hf_batch_free(&r->batch);
    free(r->start_q_N_per_m);
    free(r->base_N);
    free(r->history.psi_m);
    hf_workspace_free(&r->workspace);
    hf_model_free(&r->model);
    hf_scene_free(&r->scene);
    hf_case_free(&r->settings);
}

/* ---- names for what went wrong ---- */

typedef struct {
    char text[1600];
    size_t length;
    int n;
} name_list;

static void add_name(name_list *list, const char *name)
{
    if (list->n++ >= NAMED_MAX || list->length >= sizeof list->text) return;
    list->length += (size_t)snprintf(list->text + list->length, sizeof list->text - list->length, "%s%s",
                                     list->n > 1 ? ", " : "", name);
}

static const char *close_names(name_list *list)
{
    if (list->n > NAMED_MAX && list->length < sizeof list->text)
        snprintf(list->text + list->length, sizeof list->text - list->length, " and %d more", list->n - NAMED_MAX);
    return list->text;
}

static void name_loaded_chains(const hf_scene *scene, const hf_model *m, hf_workspace *w, name_list *list)
{
    for (int i = 0; i < m->n_chain; i++) {
        char name[256];
        if (!hf_form_chain_is_loaded(m, w, i)) continue;
        hf_model_chain_name(m, scene, i, name, sizeof name);
        add_name(list, name);
    }
}

static void warn(const char *stage, const hf_scene *scene, const hf_model *m, const hf_form_settings *form,
                 hf_workspace *w, const hf_form_result *r, hf_messages *messages)
{
    name_list chains = {0}, slack = {0};
    if (r->stop_reason == HF_STOPPED_RMS_CHANGE && r->residual_N > form->residual_tolerance * m->reference_N)
        hf_warning(messages,
                   "stop: rms_change ended before equilibrium: nodal residual %.2e N, cable lengths off by up to %.2e; "
                   "stop: residual iterates until they vanish",
                   r->residual_N, r->length_error);
    if (r->n_loaded_chain) {
        name_loaded_chains(scene, m, w, &chains);
        hf_warning(
            messages,
            "%d straight chains of length-controlled cables carry lateral load, which no finite tension holds: the "
            "boundary tensions depend on where the iteration stopped: %s",
            r->n_loaded_chain, close_names(&chains));
    }
    for (int e = 0; r->n_slack && e < m->n_cable; e++)
        if (hf_metrics_is_slack(m, w, e)) add_name(&slack, scene->cable_id[e]);
    if (r->n_slack) hf_warning(messages, "slack in the %s shape, %d: %s", stage, r->n_slack, close_names(&slack));
}

hf_status hf_run_explain(const hf_scene *scene, const hf_model *m, const hf_form_settings *form, hf_workspace *w,
                         const hf_form_result *r, hf_messages *messages)
{
    name_list chains = {0};
    switch (r->status) {
    case HF_OK:
        warn("form-finding", scene, m, form, w, r, messages);
        return HF_OK;
    case HF_NOT_CONVERGED:
        warn("form-finding", scene, m, form, w, r, messages);
        if (r->culprit >= 0)
            return hf_error(messages, r->status,
                            "form-finding is as exact as double precision allows, nodal residual %.2e N: cable '%s' is "
                            "%.2e m long, too short for coordinates of its size; move the origin near it, join its "
                            "nodes or loosen the tolerances",
                            r->residual_N, scene->cable_id[r->culprit], w->length_m[r->culprit]);
        return hf_error(
            messages, r->status,
            "form-finding did not converge in %d iterations: nodal residual %.2e N, cable lengths off by up to "
            "%.2e; raise form.max_iterations or loosen the tolerances",
            r->iterations, r->residual_N, r->length_error);
    case HF_STRAIGHT_CHAIN:
        name_loaded_chains(scene, m, w, &chains);
        return hf_error(
            messages, r->status,
            "ill-posed: %d straight chains of length-controlled cables carry lateral load, which no finite "
            "tension holds: %s. Give them slack (scene.parabolic_cylinder.scallop, longer L*), another law, or "
            "support their nodes",
            r->n_loaded_chain, close_names(&chains));
    case HF_COLLAPSED:
        return hf_error(
            messages, r->status,
            "ill-posed: the net collapses at cable '%s', whose length fell below %g of the theoretical one: its "
            "tension cannot hold it apart",
            scene->cable_id[r->culprit], form->collapse_ratio);
    case HF_NOT_FINITE:
        return hf_error(messages, r->status, "ill-posed: the tension of cable '%s' is no longer a finite number",
                        scene->cable_id[r->culprit]);
    default:
        return hf_error(messages, r->status,
                        "ill-posed: the force density matrix is singular or not positive definite at node '%s'",
                        r->culprit >= 0 ? scene->node_id[m->node_of_row[r->culprit]] : "?");
    }
}

/* ---- form-finding ---- */

static hf_status create_history(const hf_form_settings *form, hf_history *h)
{
    h->capacity = form->max_iterations < HISTORY_MAX ? form->max_iterations : HISTORY_MAX;
    size_t n = (size_t)h->capacity;
    double *block = calloc(5 * n, sizeof *block);
    if (!block) return HF_NO_MEMORY;
    h->psi_m = block;
    h->residual_N = block + n;
    h->inner_tension_ratio = block + 2 * n;
    h->boundary_tension_ratio = block + 3 * n;
    h->length_error = block + 4 * n;
    return HF_OK;
}

static hf_status find_form(run *r, hf_summary *s, hf_messages *messages)
{
    const hf_form_settings *form = &r->settings.form;
    if (hf_workspace_create(&r->model, &r->workspace) != HF_OK || create_history(form, &r->history) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for a net of %d nodes", r->model.n_node);
    double start_s = hf_run_clock_s();
    hf_evaluate_form(&r->model, form, &r->workspace, &r->history, &s->form);
    s->form_wall_s = hf_run_clock_s() - start_s;
    hf_status status = hf_run_explain(&r->scene, &r->model, form, &r->workspace, &s->form, messages);
    if (status != HF_OK && status != HF_NOT_CONVERGED) return status;
    HF_TRY(hf_store_form(r->store, &r->model, &r->workspace, &r->history, messages));
    return status;
}

/* ---- optimisation ---- */

/* Workspaces, population and evaluator, all before the first generation. */
static hf_status prepare_optimize(run *r, int threads, hf_messages *messages)
{
    const hf_model *m = &r->model;
    size_t n_cable = (size_t)m->n_cable, n_gene = (size_t)m->n_gene;
    r->start_q_N_per_m = malloc(n_cable * sizeof(double));
    r->base_N = malloc((n_gene ? n_gene : 1) * sizeof(double));
    if (!r->start_q_N_per_m || !r->base_N) return hf_error(messages, HF_NO_MEMORY, "out of memory");
    memcpy(r->start_q_N_per_m, r->workspace.q_N_per_m, n_cable * sizeof(double));
    for (int k = 0; k < m->n_gene; k++) {
        r->base_N[k] = r->workspace.tension_N[m->gene_cable[k]];
        if (!(r->base_N[k] > 0))
            return hf_error(messages, HF_BAD_CASE, "optimize: boundary cable '%s' has no tension to start from",
                            r->scene.cable_id[m->gene_cable[k]]);
        const hf_optimize_settings *o = &r->settings.optimize;
        if (r->base_N[k] + o->range_N < o->min_tension_N || r->base_N[k] - o->range_N > o->max_tension_N)
            return hf_error(
                messages, HF_BAD_CASE,
                "optimize: boundary cable '%s' has %g N after form-finding; range_N %g around that does not "
                "reach min_tension_N %g .. max_tension_N %g",
                r->scene.cable_id[m->gene_cable[k]], r->base_N[k], o->range_N, o->min_tension_N, o->max_tension_N);
    }
    hf_symmetry_average(m, r->base_N);
    r->evaluator = (hf_evaluator){m,
                                  &r->settings.form,
                                  r->start_q_N_per_m,
                                  r->settings.optimize.rule,
                                  r->settings.optimize.solver,
                                  r->settings.optimize.boundary_ratio_cap};
    if (hf_batch_create(&r->evaluator, threads, &r->batch) != HF_OK ||
        hf_ga_create(&r->settings.optimize, m, r->base_N, &r->ga) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for %d individuals of %d genes on %d threads",
                        r->settings.optimize.population, m->n_gene, r->batch.n_thread);
    return HF_OK;
}

static void note_best(const hf_ga *ga, hf_summary *s)
{
    if (ga->best < 0 || (s->best.status == HF_OK && !(ga->result[ga->best].psi_m < s->best.psi_m))) return;
    s->best = ga->result[ga->best];
    s->best_generation = ga->generation;
    s->best_individual = ga->best;
}

/* The shape of the best individual: elitism keeps it in the last generation, and it is evaluated to the same bits
 * again. */
static hf_status store_best(run *r, hf_summary *s, hf_messages *messages)
{
    const double *design = r->ga.design_N + (size_t)r->ga.best * (size_t)r->ga.n_gene;
    hf_form_result again;
    hf_workspace *w = hf_batch_run_one(&r->batch, design, &again);
    warn("optimised", &r->scene, &r->model, &r->settings.form, w, &s->best, messages);
    return hf_store_best(r->store, HF_STAGE_OPTIMIZE, &r->model, w, design, messages);
}

static hf_status evolve(run *r, const hf_options *options, hf_summary *s, hf_messages *messages)
{
    int show_progress = !options->quiet && isatty(STDERR_FILENO);
    hf_ga *ga = &r->ga;
    double start_s = hf_run_clock_s();
    s->best.status = HF_NO_FEASIBLE;
    s->solver = hf_batch_share(&r->batch, r->base_N);
    do {
        hf_batch_run(&r->batch, ga->n_individual, ga->design_N, ga->pending, ga->result);
        hf_ga_tell(ga);
        HF_TRY(hf_store_generation(r->store, &r->model, ga, messages));
        if (ga->generation == 0) s->base_psi_m = ga->result[0].psi_m;
        note_best(ga, s);
        if (show_progress) hf_print_progress(ga, hf_run_clock_s() - start_s, stderr);
    } while (hf_ga_next(ga));
    if (show_progress) hf_print_progress_end(stderr);
    s->has_optimize = 1; /* only now: a run that broke off has no such stage */
    s->optimize_wall_s = hf_run_clock_s() - start_s;
    s->optimize_cpu_s = r->batch.cpu_s;
    s->generations = ga->generation + 1;
    s->evaluations = ga->n_evaluation;
    s->infeasible = ga->n_evaluation_infeasible;
    s->optimize_stop = (int)ga->stop_reason;
    if (ga->best >= 0) return store_best(r, s, messages);
    return hf_error(messages, HF_NO_FEASIBLE, "optimize: no feasible design among %ld evaluations", s->evaluations);
}

/* Levenberg-Marquardt from the best individual, or from the base design when there was no genetic algorithm. */
static hf_status polish(run *r, hf_summary *s, hf_messages *messages)
{
    const hf_optimize_settings *o = &r->settings.optimize;
    hf_polish_result outcome;
    double *design = r->base_N, start_s = hf_run_clock_s();
    if (s->has_optimize && r->ga.best >= 0) design = r->ga.design_N + (size_t)r->ga.best * (size_t)r->ga.n_gene;
    hf_status status = hf_polish_run(&r->evaluator, r->ga.lower_N, r->ga.upper_N, o->polish_iterations, design,
                                     &r->workspace, &outcome);
    if (status == HF_NO_MEMORY) return hf_error(messages, status, "out of memory for the sensitivities");
    if (status != HF_OK) {
        const char *why = hf_status_text(status);
        if (o->method == HF_OPTIMIZE_LM)
            return hf_error(messages, HF_NO_FEASIBLE, "optimize: Levenberg-Marquardt has no feasible start: %s", why);
        hf_warning(messages, "optimize: Levenberg-Marquardt has no feasible start: %s", why);
        return HF_OK;
    }
    hf_evaluate(&r->evaluator, design, &r->workspace, &s->polish);
    s->has_polish = 1;
    s->polish_is_result = o->method != HF_OPTIMIZE_GA;
    s->polish_iterations = outcome.iterations;
    s->polish_evaluations = outcome.evaluations;
    s->polish_converged = outcome.converged;
    s->polish_wall_s = hf_run_clock_s() - start_s;
    return hf_store_best(r->store, HF_STAGE_POLISH, &r->model, &r->workspace, design, messages);
}

static hf_status optimize(run *r, const hf_options *options, hf_summary *s, hf_messages *messages)
{
    int method = r->settings.optimize.method;
    HF_TRY(prepare_optimize(r, options->threads, messages));
    s->threads = r->batch.n_thread;
    if (method != HF_OPTIMIZE_LM) HF_TRY(evolve(r, options, s, messages));
    if (hf_polish_applies(&r->evaluator)) return polish(r, s, messages);
    const char *needs = "optimize: Levenberg-Marquardt needs a net without struts and a rule other than seeded";
    if (method == HF_OPTIMIZE_LM) return hf_error(messages, HF_BAD_CASE, "%s", needs);
    if (method == HF_OPTIMIZE_GA_LM) hf_warning(messages, "%s", needs);
    return HF_OK;
}

/* ---- the whole run ---- */

void hf_run_describe(const hf_case *settings, const hf_model *model, hf_summary *s)
{
    snprintf(s->title, sizeof s->title, "%s", settings->title);
    snprintf(s->case_path, sizeof s->case_path, "%s", settings->path);
    s->threads = 1;
    s->seed = settings->optimize.seed;
    s->n_node = model->n_node;
    s->n_free = model->n_free;
    s->n_cable = model->n_cable;
    s->n_gene = model->n_gene;
    s->n_leader = model->n_leader;
    s->half_bandwidth = model->half_bandwidth;
    s->pretension_N = model->pretension_N;
}

/* -o, or the name of the case with .h5 in the current folder. */
static hf_status choose_output(const hf_options *o, char output[HF_OUTPUT_SIZE], hf_messages *messages)
{
    const char *slash = strrchr(o->file, '/'), *name = slash ? slash + 1 : o->file, *dot = strrchr(name, '.');
    int stem = dot && dot != name ? (int)(dot - name) : (int)strlen(name);
    int n = o->output ? snprintf(output, HF_OUTPUT_SIZE, "%s", o->output)
                      : snprintf(output, HF_OUTPUT_SIZE, "%.*s.h5", stem, name);
    if (n >= HF_OUTPUT_SIZE) return hf_error(messages, HF_IO, "%s: the path is too long", o->output);
    return HF_OK;
}

hf_status hf_run_spare_inputs(const hf_case *settings, const char *table, const char *output, hf_messages *messages)
{
    const char *input[] = {settings->path, table, settings->nodes_path, settings->cables_path};
    struct stat a, b;
    for (int i = 0; i < (settings->has_import ? 4 : 2); i++)
        if (input[i] && stat(input[i], &a) == 0 && stat(output, &b) == 0 && a.st_dev == b.st_dev &&
            a.st_ino == b.st_ino)
            return hf_error(messages, HF_EXISTS, "%s: is an input of this run; use -o to choose another name", output);
    return HF_OK;
}

/* ---- being told to stop: the temporary file goes, and the signal does what it would have done ---- */

static char unfinished[HF_OUTPUT_SIZE + 64];       /* "" when there is none */
static volatile sig_atomic_t creating, stopped_by; /* a signal while the file is being made waits until it is */
static const int stop_signals[] = {SIGINT, SIGTERM, SIGHUP};

static void remove_unfinished(int signal_number)
{
    if (creating) {
        stopped_by = signal_number;
        return;
    }
    if (unfinished[0]) unlink(unfinished);
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

static void set_handlers(void (*handler)(int))
{
    for (size_t i = 0; i < sizeof stop_signals / sizeof *stop_signals; i++) {
        struct sigaction old;
        if (sigaction(stop_signals[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN) /* nohup stays nohup */
            signal(stop_signals[i], handler);
    }
}

static hf_status create_store(run *r, const hf_options *options, int argc, char *const *argv, const char *output,
                              hf_messages *messages)
{
    creating = 1;
    set_handlers(remove_unfinished);
    hf_status status =
        hf_store_create(output, options->force, &r->settings, &r->scene, argc, argv, &r->store, messages);
    snprintf(unfinished, sizeof unfinished, "%s", status == HF_OK ? hf_store_temporary(r->store) : "");
    creating = 0;
    if (stopped_by) remove_unfinished(stopped_by);
    return status;
}

static hf_status finish_store(run *r, const hf_summary *s, hf_messages *messages)
{
    hf_status status = hf_store_finish(r->store, s, messages);
    r->store = NULL;
    set_handlers(SIG_DFL);
    unfinished[0] = '\0';
    return status;
}

/* The stages that the case asks for, in order. HF_NOT_CONVERGED: nothing follows on a shape that is not one. */
static hf_status stages(run *r, const hf_options *options, hf_summary *s, hf_messages *messages)
{
    HF_TRY(find_form(r, s, messages));
    if (r->settings.has_optimize && r->model.n_gene == 0)
        hf_warning(messages, "optimize: skipped, no boundary cable has a free end");
    else if (r->settings.has_optimize)
        return optimize(r, options, s, messages);
    return HF_OK;
}

/* The file of a run that did not reach its aim still says how far it came. */
static int leaves_result(hf_status status)
{
    return status == HF_OK || status == HF_NOT_CONVERGED || status == HF_NO_FEASIBLE;
}

static hf_status execute(run *r, const hf_options *options, int argc, char *const *argv, hf_summary *s, char *output,
                         hf_messages *messages)
{
    HF_TRY(hf_config_load(options->file, options->set, options->n_set, &r->settings, messages));
    if (options->has_seed) r->settings.optimize.seed = options->seed;
    if (options->has_seed && !r->settings.has_optimize)
        hf_warning(messages, "--seed has no effect: the case has no optimize section");
    HF_TRY(hf_config_scene(&r->settings, &r->scene, messages));
    HF_TRY(hf_model_build(&r->scene, &r->settings.form, &r->model, messages));
    if (r->settings.has_optimize)
        HF_TRY(hf_symmetry_apply(&r->scene, r->settings.optimize.symmetry, &r->model, &s->planes, messages));
    hf_run_describe(&r->settings, &r->model, s);
    HF_TRY(choose_output(options, output, messages));
    HF_TRY(hf_run_spare_inputs(&r->settings, NULL, output, messages));
    HF_TRY(create_store(r, options, argc, argv, output, messages));
    hf_status status = stages(r, options, s, messages);
    if (!leaves_result(status)) return status;
    snprintf(s->warnings, sizeof s->warnings, "%s", messages->text ? messages->text : "");
    hf_text_trim_utf8(s->warnings);
    hf_status finish = finish_store(r, s, messages);
    return finish != HF_OK ? finish : status;
}

hf_status hf_run(const hf_options *options, int argc, char *const *argv, hf_summary *summary,
                 char output[HF_OUTPUT_SIZE], hf_messages *messages)
{
    run r = {0};
    *summary = (hf_summary){.form.status = HF_NOT_EVALUATED, .threads = 1};
    snprintf(summary->version, sizeof summary->version, "%s", hf_store_version());
    output[0] = '\0';
    hf_status status = execute(&r, options, argc, argv, summary, output, messages);
    if (!leaves_result(status)) output[0] = '\0';
    run_free(&r);
    return status;
}
