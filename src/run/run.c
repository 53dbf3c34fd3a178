/* Runs a whole case, as `hifdm run` does.
 *
 *     prepare       case, net, truss, model (problem_parts.c); a point of an earlier front
 *     open_store    the result file is created, resumed, found finished or continued (--more)
 *     run_stages    form-finding                                  (stages_form.c)
 *                   search: generations, each stored              (stages_search.c)
 *                   refinement, or a point of an earlier front    (stages_refine.c)
 *                   or a front                                    (stages_front.c)
 *                   load cases of the as-built net                (load_case_stage.c)
 *                   samples of the as-built net                   (tolerance_stage.c)
 *                   verdicts on the requirements                  (requirements_stage.c)
 *     finish        doubts about the result, summary, finished file
 *
 * Each stage measures and stores its shape. A run that is told to stop publishes its file, and the same command resumes
 * it. */
#include <hifdm/run.h>

#include "base/path.h"
#include "base/text.h"
#include "linalg/lapack.h"
#include "net/variables.h"
#include "run/problem_parts.h"
#include "run/stages.h"
#include "run/tolerance_stage.h"
#include "store/store_read.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const hf_run_phase_word[4] = {"form", "search", "refine", "tolerance"};

/* Returns true for faults of the machine and for files in the way. The same command may succeed once they are
 * removed. */
static bool is_of_machine(hf_status status)
{
    return status == HF_IO || status == HF_NO_MEMORY || status == HF_EXISTS;
}

/* Returns true if the run writes its file. A run that did not converge or found no feasible design writes one that
 * shows how far it came. */
static bool leaves_result(hf_status status)
{
    return status == HF_OK || status == HF_NOT_CONVERGED || status == HF_NO_FEASIBLE;
}

/* ---- before the stages ---- */

static hf_status prepare(hf_run *r, hf_summary *s, hf_messages *messages)
{
    const hf_run_input *q = &r->request->input;
    const hf_run_part *part = &r->request->part;
    hf_case *settings = &r->problem.settings;
    HF_TRY(hf_problem_load(q->case_path, q->source, q->set, q->n_set, r->request->control.stop_requested, &r->problem,
                           messages));
    if (settings->has_sweep && !part->of_sweep)
        return hf_error(messages, HF_BAD_USAGE,
                        "%s: this file has a `sweep` section. Run the study with 'hifdm sweep %s'", q->case_path,
                        q->case_path);
    if (part->is_strict && settings->n_requirement == 0)
        return hf_error(
            messages, HF_BAD_USAGE,
            "%s: --strict checks requirements, but the case has none. Add the list `requirements`, or remove "
            "the option",
            q->case_path);
    if (part->of_tolerance && !settings->has_tolerance)
        return hf_error(messages, HF_BAD_USAGE,
                        "%s: the case has no `tolerance` section. 'hifdm schema' lists the keys of this section",
                        q->case_path);
    HF_TRY(hf_requirements_stage_open(&r->problem, &r->requirements, messages));
    if (q->seed) settings->optimize.seed = *q->seed;
    if (q->seed && !settings->has_optimize)
        hf_warning(messages, "the option --seed has no effect, because the case has no `optimize` section");
    if (q->point) HF_TRY(hf_take_point_read(q->point, &r->problem, &r->taken, messages));
    hf_problem_describe(&r->problem, s);
    return HF_OK;
}

/* Opens the finished result whose refinement the request continues. If that refinement has converged or stalled, no
 * store is opened and *state stays HF_STORE_FINISHED. */
static hf_status open_to_continue(hf_run *r, hf_store_state *state, hf_messages *messages)
{
    hf_summary *before = calloc(1, sizeof *before);
    if (!before) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", r->output);
    hf_status status = *state == HF_STORE_FINISHED ? hf_store_read_finished(r->output, before, messages) : HF_OK;
    const hf_refine_summary refine = before->refine;
    bool has_refine = before->stage[HF_STAGE_REFINE].exists && refine.algorithm_stop != HF_REFINE_TAKEN;
    bool is_infeasible = before->status == HF_NO_FEASIBLE;
    hf_summary_free(before);
    free(before);
    HF_TRY(status);
    if (*state != HF_STORE_FINISHED)
        return hf_error(messages, HF_BAD_USAGE,
                        "%s: the option --more continues a finished result, but this file %s. Run the command without "
                        "--more first",
                        r->output, *state == HF_STORE_UNFINISHED ? "is unfinished" : "does not exist");
    if (!has_refine)
        return hf_error(messages, HF_BAD_USAGE, "%s: this result has no refinement that --more could continue%s",
                        r->output,
                        is_infeasible ? ", because no design met the constraints. Loosen requirements or limits, or "
                                        "change the start, and run again"
                                      : ". Set optimize.method to lm or ga+lm");
    r->steps_before = refine.steps;
    if (refine.algorithm_stop == HF_REFINE_CONVERGED || refine.algorithm_stop == HF_REFINE_STALLED) {
        hf_warning(messages, "%s: --more changes nothing, because the refinement has %s", r->output,
                   refine.algorithm_stop == HF_REFINE_CONVERGED ? "converged" : "stalled");
        return HF_OK;
    }
    *state = HF_STORE_UNFINISHED;
    HF_TRY(hf_lapack_load(messages));
    return hf_store_continue(r->output, &r->store, messages);
}

/* Sets *state and opens the store. No store is opened for a finished result, nor for one task of several, which has
 * none. The path of the result is the given one, or else the name of the case with .h5 in the current folder. */
static hf_status open_store(hf_run *r, hf_store_state *state, hf_messages *messages)
{
    const hf_run_request *q = r->request;
    const hf_run_output *to = &q->output;
    const hf_case *settings = &r->problem.settings;
    const hf_scene *scene = &r->problem.scene;
    const hf_truss *truss = settings->has_truss ? &r->problem.carrier.truss : NULL;
    if (!hf_path_choose(to->path, q->input.case_path, ".h5", r->output, HF_OUTPUT_SIZE))
        return hf_error(messages, HF_IO, "%s: the path is too long", to->path ? to->path : q->input.case_path);
    HF_TRY(
        hf_problem_spare_inputs(&r->problem, settings->taken.point ? settings->taken.path : NULL, r->output, messages));
    if (!to->restart) HF_TRY(hf_store_look(r->output, settings, scene, truss, state, messages));
    if (q->part.more_steps) return open_to_continue(r, state, messages);
    if (*state == HF_STORE_FINISHED) return HF_OK;
    HF_TRY(hf_tolerance_stage_look(q, &r->problem, r->output, messages));
    if (hf_tolerance_stage_is_task(q)) return HF_OK;
    HF_TRY(hf_lapack_load(messages)); /* the file records which one it is */
    if (*state == HF_STORE_UNFINISHED) return hf_store_resume(r->output, &r->store, messages);
    return hf_store_create(r->output, to->restart, settings, scene, truss, to->argc, to->argv, &r->store, messages);
}

/* Returns the stored summary and status of a result that is already finished, with the errors that explain the
 * status. */
static hf_status repeat_finished(const hf_run *r, hf_summary *s, hf_messages *messages)
{
    HF_TRY(hf_store_read_finished(r->output, s, messages));
    if (s->tolerance) hf_tolerance_stage_end(r->request, r->output);
    if (!r->request->part.more_steps)
        hf_warning(messages,
                   "%s: this file is the finished result of this case. Use --restart to compute the result again",
                   r->output);
    for (const char *line = s->warnings; *line; line += strcspn(line, "\n"), line += *line == '\n')
        if (!strncmp(line, "error: ", 7)) hf_error(messages, s->status, "%.*s", (int)strcspn(line + 7, "\n"), line + 7);
    return s->status;
}

/* ---- the stages ---- */

/* Ends a run that was told to stop, or that the machine failed after its design was found. Publishes what is stored, so
 * that the same command resumes it. A disk that is full then has its message unless the design was found: the file
 * published before and the journals remain. Returns `status`, or an error of the store. */
static hf_status end_unfinished(hf_run *r, const hf_summary *s, hf_status status, hf_messages *messages)
{
    hf_status kept = HF_OK;
    /* a failure after the design has its own message */
    if (r->may_publish) kept = hf_store_publish(r->store, s, true, r->has_design ? NULL : messages);
    if (kept != HF_OK && !r->has_design) return kept;
    if (status == HF_INTERRUPTED && (r->store || hf_tolerance_stage_is_task(r->request)))
        hf_error(messages, status, "%s: the run was interrupted%s. %s", r->output, r->stopped_at,
                 r->request->part.more_steps ? "The earlier result is unchanged"
                                             : "Run the same command again to resume");
    if (status != HF_INTERRUPTED && r->store && kept == HF_OK && !r->request->part.of_sweep &&
        !r->request->part.more_steps)
        hf_warning(messages, "%s: this result is unfinished. Run the same command again to resume", r->output);
    return status;
}

enum { STAGES_MAX = 7 };

/* Lists the stages of the case. Returns their number; *n_design is that of the stages that find the design. */
static int list_stages(hf_run *r, hf_run_stage *stage[STAGES_MAX], int *n_design)
{
    const hf_case *c = &r->problem.settings;
    int n = 0;
    stage[n++] = hf_stage_form;
    if (c->has_optimize) stage[n++] = hf_stage_begin;
    if (c->has_optimize && r->problem.model.n_variable > 0) {
        r->plan = hf_optimiser_plan_of(&c->optimize);
        if (r->plan.kind && !r->taken.design) stage[n++] = hf_stage_search;
        stage[n++] = r->taken.design ? hf_stage_point : c->optimize.n_front > 0 ? hf_stage_front : hf_stage_refine;
    }
    *n_design = n;
    if (r->problem.load_cases.n) stage[n++] = hf_stage_load_cases;
    if (c->has_tolerance) stage[n++] = hf_stage_samples;
    if (c->n_requirement > 0) stage[n++] = hf_stage_verdicts;
    return n;
}

/* Makes the net after form-finding the result again, after other shapes used its workspace. */
static hf_status return_to_form(hf_run *r, hf_messages *messages)
{
    hf_problem *p = &r->problem;
    hf_evaluate_form(&p->model, &p->settings.form, &p->workspace, NULL, &p->form);
    if (!hf_status_has_shape(p->form.status)) return p->form.status; /* only if the run was stopped */
    return hf_stage_take(r, &p->workspace, messages);
}

/* Runs the stages in turn. The first failure ends the run; a stop ends it after the stage that is running. If no design
 * is feasible, the verdicts are on the net after form-finding, because they show what it lacks. */
static hf_status run_stages(hf_run *r, hf_summary *s, hf_messages *messages)
{
    hf_run_stage *stage[STAGES_MAX];
    int n_design, n = list_stages(r, stage, &n_design);
    hf_status status = HF_OK, failed = HF_OK;
    for (int i = 0; i < n && status == HF_OK; i++) {
        r->has_design = i >= n_design && failed == HF_OK;
        status = i > 0 && hf_run_must_stop(r) ? HF_INTERRUPTED : stage[i](r, s, messages);
        if (status != HF_NO_FEASIBLE || i >= n_design || r->problem.settings.n_requirement == 0) continue;
        failed = status;
        i = n_design - 1;
        status = return_to_form(r, messages);
    }
    if (status == HF_OK) status = failed;
    bool is_found = r->has_design || failed != HF_OK; /* or none is */
    bool is_unfinished = status == HF_INTERRUPTED || (is_found && is_of_machine(status));
    return is_unfinished ? end_unfinished(r, s, status, messages) : status;
}

/* ---- after the stages ---- */

/* Copies the messages into text, errors first. If there is no room for all lines, warnings are lost and not the reason
 * of a failure. */
static void keep_messages(const hf_messages *messages, char text[HF_WARNINGS_SIZE])
{
    size_t n = 0, length;
    *text = '\0';
    for (int of_errors = 1; of_errors >= 0; of_errors--)
        for (const char *line = messages->text; line && *line && n < HF_WARNINGS_SIZE; line += length) {
            length = strcspn(line, "\n") + 1; /* each line has an end */
            bool is_error = strncmp(line, "error: ", 7) == 0;
            if (is_error == of_errors) n += (size_t)snprintf(text + n, HF_WARNINGS_SIZE - n, "%.*s", (int)length, line);
        }
    hf_text_trim_utf8(text);
}

/* Writes into the summary by which factors the result scales variables with `link: scale`. */
static void note_scale(const hf_run *r, hf_summary *s)
{
    const hf_model *m = &r->problem.model;
    const double *initial = r->optimiser.population.initial, *design = s->taken.point ? r->taken.design : r->design;
    if (!r->has_design || !initial || (s->front && !s->taken.point)) return;
    hf_variables_scales(m, initial, design, &s->scale_min, &s->scale_max);
}

/* Writes the doubts about the result and its summary, and finishes the file. Returns `status`, or an error of the
 * store. */
static hf_status finish(hf_run *r, hf_summary *s, hf_status status, hf_messages *messages)
{
    const hf_problem *p = &r->problem;
    hf_result_doubt_truss(p, &r->truss, r->shape, messages);
    hf_result_doubt_strain(p, r->shape, messages);
    hf_result_doubt_uncounted(p, &r->places, r->shape, s, messages);
    note_scale(r, s);
    if (s->has_truss) HF_TRY(hf_store_truss(r->store, &p->carrier, &r->truss, messages));
    keep_messages(messages, s->warnings);
    s->finished = true;
    s->status = status;
    hf_status finished = hf_store_complete(r->store, s, messages);
    hf_store *store = r->store;
    r->store = NULL;
    if (finished == HF_OK && r->request->output.unsettled)
        *r->request->output.unsettled = store;
    else
        finished = hf_store_settle(store, messages);
    if (finished == HF_OK && s->tolerance) hf_tolerance_stage_end(r->request, r->output);
    return finished != HF_OK ? finished : status;
}

static hf_status execute(hf_run *r, hf_summary *s, hf_messages *messages)
{
    hf_store_state state = HF_STORE_NOTHING;
    HF_TRY(prepare(r, s, messages));
    if (!r->request->output.no_file) HF_TRY(open_store(r, &state, messages));
    if (state == HF_STORE_FINISHED) return repeat_finished(r, s, messages);
    hf_status status = run_stages(r, s, messages);
    /* The result keeps its design although a stage after it failed, if another attempt would fail, too. The result
     * then contains the reason. */
    bool has_design_alone = r->has_design && status != HF_OK && status != HF_INTERRUPTED && !is_of_machine(status);
    if (hf_tolerance_stage_is_task(r->request) || !(leaves_result(status) || has_design_alone)) return status;
    if (has_design_alone) hf_warning(messages, "tolerance: the result has only the design and no samples");
    return finish(r, s, status, messages);
}

static void run_free(hf_run *r, hf_messages *messages)
{
    hf_store_abandon(r->store, messages); /* NULL once it is finished */
    hf_optimiser_free(&r->optimiser);
    hf_front_free(&r->front);
    free(r->taken.design);
    hf_carrier_state_free(&r->truss);
    hf_places_free(&r->places);
    hf_load_case_stage_free(&r->cases);
    hf_requirements_stage_free(&r->requirements);
    hf_problem_free(&r->problem);
    free(r);
}

hf_status hf_run_case(const hf_run_request *request, hf_summary *summary, char output[HF_OUTPUT_SIZE],
                      hf_messages *messages)
{
    hf_run *r = calloc(1, sizeof *r);
    if (request->output.unsettled) *request->output.unsettled = NULL;
    memset(summary, 0, sizeof *summary); /* a literal would take as much of the stack */
    summary->stage[HF_STAGE_FORM].result.status = HF_NOT_EVALUATED;
    summary->threads = 1;
    snprintf(summary->version, sizeof summary->version, "%s", hf_store_version());
    output[0] = '\0';
    if (!r) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", request->input.case_path);
    r->request = request;
    r->output = output;
    hf_status status = execute(r, summary, messages);
    bool is_kept = leaves_result(status) || (summary->finished && summary->status == status);
    if (!is_kept || hf_tolerance_stage_is_task(request)) output[0] = '\0';
    run_free(r, messages);
    return status;
}
