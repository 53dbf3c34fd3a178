/* `hifdm sweep` runs the missing points of a study, on all cores.
 *
 * Contents: which points - progress - the command */
#include "app/study_files.h"

#include "base/file_io.h"
#include "base/signals.h"
#include "base/text.h"
#include "out/print.h"
#include "run/sweep.h"
#include <hifdm/batch.h>

#include <stdlib.h>
#include <unistd.h>

#define REFRESH_S 0.1 /* seconds between two updates of the line on a terminal */
#define LOG_S 60.0    /* seconds between two lines in a log */

/* ---- which points ---- */

/* Returns true if the environment variable is set and holds a number. */
static bool environment_number(const char *name, int *value)
{
    const char *text = getenv(name);
    uint64_t number;
    if (!text || !hf_text_uint64(text, &number) || number > 100000000) return false;
    *value = (int)number;
    return true;
}

/* Chooses which part of the points this process runs: by --task and --tasks, or by the index in a Slurm array. The
 * indices of an array must be evenly spaced, otherwise some points would belong to no task. Returns HF_OK or
 * HF_BAD_USAGE. */
static hf_status choose_task(const hf_options *o, int *task, int *tasks, hf_messages *messages)
{
    int id = 0, count = 1, low = 0, high = 0, step = 1;
    bool in_array = environment_number("SLURM_ARRAY_TASK_ID", &id);
    *task = o->task;
    *tasks = o->tasks;
    if (o->tasks && o->task < 0) {
        if (!in_array)
            return hf_error(
                messages, HF_BAD_USAGE,
                "the option --tasks needs the option --task, or the environment variable SLURM_ARRAY_TASK_ID");
        *task = id;
    } else if (!o->tasks && o->task >= 0) {
        return hf_error(messages, HF_BAD_USAGE, "the option --task needs --tasks");
    } else if (!o->tasks) {
        *task = 0;
        *tasks = 1;
        if (!in_array || !environment_number("SLURM_ARRAY_TASK_COUNT", &count)) return HF_OK;
        environment_number("SLURM_ARRAY_TASK_MIN", &low);
        environment_number("SLURM_ARRAY_TASK_MAX", &high);
        environment_number("SLURM_ARRAY_TASK_STEP", &step);
        if (step < 1 || high - low != (count - 1) * step || id < low || (id - low) % step)
            return hf_error(messages, HF_BAD_USAGE,
                            "the task numbers of the Slurm array have gaps. Use the option --tasks N, where N is the "
                            "number of tasks that share the points");
        *task = (id - low) / step;
        *tasks = count;
    }
    if (*task >= *tasks)
        return hf_error(messages, HF_BAD_USAGE, "task %d of %d does not exist, because the tasks are numbered from 0",
                        *task, *tasks);
    return HF_OK;
}

/* ---- progress ---- */

typedef struct {
    bool on_terminal;
    double said_s; /* hf_sweep_count.wall_s at the last report */
} teller;

static void show_points(void *context, const hf_sweep_count *n)
{
    teller *t = context;
    int finished = n->n_done + n->n_failed;
    if (n->wall_s - t->said_s < (t->on_terminal ? REFRESH_S : LOG_S)) return;
    t->said_s = n->wall_s;
    if (!hf_file_io_await_room(STDERR_FILENO, 0)) return;
    fprintf(stderr, "%s%d of %d points, %d failed, %s left%s", t->on_terminal ? "\r\033[K" : "", finished, n->n_todo,
            n->n_failed,
            finished ? hf_print_duration(n->wall_s * (n->n_todo - finished) / (finished ? finished : 1)).text : "?",
            t->on_terminal ? "" : "\n");
    fflush(stderr);
}

/* ---- the command ---- */

/* Runs the points and prints how many. request->observer is NULL with --quiet. */
static hf_status sweep_study(const hf_sweep_request *request, FILE *file, hf_messages *messages)
{
    const teller *t = request->observer_context;
    hf_sweep_count n;
    hf_status status = hf_sweep_run(request, &n, messages);
    if (!request->observer || !n.has_run) return status;
    if (t->on_terminal && hf_file_io_await_room(STDERR_FILENO, 0)) fputs("\r\033[K", stderr);
    hf_print_line(file, "%d point%s run in %s on %d thread%s, %d of them failed; results in %s", n.n_done + n.n_failed,
                  n.n_done + n.n_failed == 1 ? "" : "s", hf_print_duration(n.wall_s).text, request->threads,
                  request->threads == 1 ? "" : "s", n.n_failed, request->folder);
    return status;
}

static hf_status command_sweep(const hf_options *o, FILE *file, hf_messages *messages)
{
    char folder[HF_PATH_SIZE];
    static hf_study study;
    teller t = {.on_terminal = isatty(STDERR_FILENO)};
    hf_sweep_request request = {.study = &study,
                                .folder = folder,
                                .retry = o->retry,
                                .threads = o->threads ? o->threads : hf_batch_default_threads(),
                                .argc = o->argc,
                                .argv = o->argv,
                                .stop_requested = hf_signals_watch(),
                                .observer = o->quiet ? NULL : show_points,
                                .observer_context = &t};
    HF_TRY(choose_task(o, &request.task, &request.tasks, messages));
    HF_TRY(hf_study_files_name(o->folder, o->file, ".d", folder, messages));
    hf_status status = hf_study_read(o->file, &study, messages);
    if (status == HF_OK) status = sweep_study(&request, file, messages);
    hf_study_free(&study);
    return status;
}

const hf_command hf_cmd_sweep = {
    .name = "sweep",
    .argument = "STUDY",
    .help = "run the missing points of a sweep on all cores",
    .about = "A study consists of a base case and axes that vary keys of this case. A failed point does not stop the "
             "other points of the sweep. hifdm sweep does not run finished points again. To resume a sweep that was "
             "stopped, run the same command again. In a Slurm array, each task runs its share of the points.",
    .examples = "hifdm sweep study.yaml\n"
                "hifdm sweep study.yaml --task 0 --tasks 8\n"
                "hifdm sweep study.yaml --retry failed",
    .uses_threads = true,
    .run = command_sweep,
};
