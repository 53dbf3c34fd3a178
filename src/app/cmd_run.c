/* `hifdm run` computes one case and writes its result file. `hifdm tolerance` does the same for a case with a section
 * tolerance, as a whole or as one task of several. */
#include "app/cmd.h"
#include "app/output.h"
#include "app/progress.h"
#include "base/signals.h"
#include "out/print.h"
#include <hifdm/run.h>

#include <unistd.h>

static hf_status check_tasks(const hf_options *o, hf_messages *messages)
{
    if (o->task >= 0 && o->tasks == 0)
        return hf_error(messages, HF_BAD_USAGE, "the option '--task' also needs '--tasks'");
    if (o->tasks > 0 && o->task >= o->tasks)
        return hf_error(messages, HF_BAD_USAGE,
                        "--task %d is out of range, because the %d tasks are numbered from 0 to %d", o->task, o->tasks,
                        o->tasks - 1);
    return HF_OK;
}

static hf_status judge_strictly(const hf_summary *s, hf_messages *messages)
{
    hf_judgement of = hf_summary_judge(s);
    if (!s->finished) return HF_OK; /* a task of several */
    if (of.n_failed == 0) return HF_OK;
    if (s->front && hf_front_is_judged(s->front))
        return hf_error(messages, HF_REQUIREMENT_FAILED,
                        "every point of the front fails a requirement; point %d ranks first and fails %d of %d",
                        hf_front_suggested(s->front), of.n_failed, of.n_required);
    return hf_error(messages, HF_REQUIREMENT_FAILED, "the result fails %d of %d requirements", of.n_failed,
                    s->n_requirement);
}

static hf_status check_more(const hf_options *o, hf_messages *messages)
{
    if (o->more && (o->force || o->point))
        return hf_error(messages, HF_BAD_USAGE,
                        "the option '--more' continues a finished result, so it cannot be combined with '%s'",
                        o->point ? "--point" : "--restart");
    return HF_OK;
}

static hf_status run_case(const hf_options *o, FILE *file, hf_messages *messages)
{
    static hf_summary summary;
    char output[HF_OUTPUT_SIZE];
    bool of_tolerance = o->command == &hf_cmd_tolerance;
    HF_TRY(check_tasks(o, messages));
    HF_TRY(check_more(o, messages));
    hf_progress progress = hf_progress_on(stderr, o->quiet ? HF_PROGRESS_NONE : o->progress);
    hf_run_request request = {.input = {.case_path = o->file,
                                        .set = o->set,
                                        .n_set = o->n_set,
                                        .seed = o->has_seed ? &o->seed : NULL,
                                        .point = o->point},
                              .output = {.path = o->output, .restart = o->force, .argc = o->argc, .argv = o->argv},
                              .control = {o->threads, hf_signals_watch(), hf_progress_show, &progress},
                              .part = {.of_tolerance = of_tolerance,
                                       .is_strict = o->strict,
                                       .task = o->task,
                                       .tasks = of_tolerance ? o->tasks : 0,
                                       .more_steps = o->more}};
    hf_status status = hf_run_case(&request, &summary, output, messages);
    hf_progress_end(&progress);
    const char *path = *output ? output : NULL;
    if (status == HF_OK && o->strict) status = judge_strictly(&summary, messages);
    if (o->json)
        hf_summary_write_json(&summary, status, messages->text, path, file);
    else if (path && !o->quiet)
        hf_print_summary(&summary, path,
                         (hf_print_style){o->verbose, hf_output_has_colour(STDOUT_FILENO), messages->n_error > 0},
                         file);
    hf_summary_free(&summary);
    return status;
}

const hf_command hf_cmd_run = {
    .name = "run",
    .argument = "CASE",
    .help = "run a case and store its results in one HDF5 file",
    .about =
        "The case file determines the stages of the run. Form-finding always runs. If the case has an `optimize` "
        "section, the search and the refinement follow the form-finding. If the case has a `tolerance` section, hifdm "
        "also computes samples of the as-built net. The run stores every generation. To resume a run that was killed "
        "or interrupted, run the same command again. hifdm keeps a finished result unless you use the --restart "
        "option.\nFor a case with the list optimize.front, the --point option uses a point of an existing Pareto front "
        "instead of a search. The result contains the shape, the cut list and the as-built net of the selected "
        "point.\nThe "
        "--more option continues a refinement that ended before it converged. hifdm then also computes the load cases "
        "and the samples again. The earlier result remains until the new result is finished.",
    .examples = "hifdm run configs/chen2022.yaml\n"
                "hifdm run case.yaml --set form.pretension_N=12 --seed 7 -o twelve.h5\n"
                "hifdm run case.yaml --point front.h5:7 -o point7.h5\n"
                "hifdm run case.yaml --more 50",
    .uses_threads = true,
    .run = run_case,
};

const hf_command hf_cmd_tolerance = {
    .name = "tolerance",
    .argument = "CASE",
    .help = "compute samples of the as-built net with the errors in the `tolerance` section",
    .about = "hifdm tolerance works like hifdm run, but the case must have a `tolerance` section. hifdm derives the "
             "cutting lengths of the cables from the shape of the design. For each sample, hifdm solves the net again "
             "with errors of lengths, stiffness, supports and temperature. In a job array, each task computes a share "
             "of the samples and stores this share beside FILE. To combine the samples of all tasks, run the same "
             "command without the --task option. The combined result is bit-identical to the result of a single run.",
    .examples = "hifdm tolerance case.yaml -o case.h5\n"
                "hifdm tolerance case.yaml -o case.h5 --task 3 --tasks 16\n"
                "hifdm tolerance case.yaml -o case.h5 --tasks 16",
    .uses_threads = true,
    .run = run_case,
};
