/* `hifdm sweep` runs the missing points of a study, on all cores.
 * Contents: which points - one point - sweep */
#include "app/cmd.h"

#include "app/study_files.h"
#include "base/clock.h"
#include "base/later.h"
#include "base/signals.h"
#include "base/text.h"
#include "out/print.h"
#include "search/parallel.h"
#include <hifdm/batch.h>
#include <hifdm/run.h>
#include <hifdm/store.h>

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define REFRESH_S 0.1 /* between two updates of the line on a terminal */
#define LOG_S 60.0    /* between two lines in a log */

/* ---- which points ---- */

typedef struct {
    const hf_options *options;
    const volatile sig_atomic_t *stop_requested;
    const hf_study *study;
    hf_ledger ledger;
    hf_point_state *state; /* [n_point] before this sweep */
    int *todo;             /* [n_todo] points to run */
    int n_todo, threads;
    int n_failed_before;  /* points of this task that failed earlier and are left alone */
    pthread_mutex_t lock; /* protects all members below but fatal */
    FILE *progress;       /* NULL: say nothing */
    bool on_terminal;
    int n_done, n_failed, n_elsewhere;
    double start_s, said_s;
    hf_messages *messages;
    _Atomic hf_status fatal; /* not HF_OK: rows cannot be written, so no point may begin; read without the lock */
} sweep;

/* True when the variable is there and holds a number. */
static bool environment_number(const char *name, int *value)
{
    const char *text = getenv(name);
    uint64_t number;
    if (!text || !hf_text_uint64(text, &number) || number > 100000000) return false;
    *value = (int)number;
    return true;
}

/* Which part of the points this process runs: by --task and --tasks, or by the index in a Slurm array. Indices of an
 * array must be evenly spaced, else some points would belong to no task. */
static hf_status choose_task(const hf_options *o, int *task, int *tasks, hf_messages *messages)
{
    int id = 0, count = 1, low = 0, high = 0, step = 1;
    bool in_array = environment_number("SLURM_ARRAY_TASK_ID", &id);
    *task = o->task;
    *tasks = o->tasks;
    if (o->tasks && o->task < 0) {
        if (!in_array) return hf_error(messages, HF_BAD_USAGE, "--tasks needs --task, or Slurm's SLURM_ARRAY_TASK_ID");
        *task = id;
    } else if (!o->tasks && o->task >= 0) {
        return hf_error(messages, HF_BAD_USAGE, "--task needs --tasks");
    } else if (!o->tasks) {
        *task = 0;
        *tasks = 1;
        if (!in_array || !environment_number("SLURM_ARRAY_TASK_COUNT", &count)) return HF_OK;
        environment_number("SLURM_ARRAY_TASK_MIN", &low);
        environment_number("SLURM_ARRAY_TASK_MAX", &high);
        environment_number("SLURM_ARRAY_TASK_STEP", &step);
        if (step < 1 || high - low != (count - 1) * step || id < low || (id - low) % step)
            return hf_error(messages, HF_BAD_USAGE,
                            "the Slurm array has gaps: say with --tasks N how many tasks share the points");
        *task = (id - low) / step;
        *tasks = count;
    }
    if (*task >= *tasks) return hf_error(messages, HF_BAD_USAGE, "task %d of %d: they count from 0", *task, *tasks);
    return HF_OK;
}

static hf_status choose_points(sweep *w, const hf_points *points, int task, int tasks)
{
    unsigned wanted = w->options->retry ? w->options->retry : 1u << HF_POINT_MISSING;
    w->todo = malloc((size_t)points->n_point * sizeof *w->todo);
    w->state = malloc((size_t)points->n_point * sizeof *w->state);
    if (!w->todo || !w->state)
        return hf_error(w->messages, HF_NO_MEMORY, "out of memory for %d points", points->n_point);
    for (int i = 0; i < points->n_point; i++)
        w->state[i] = points->point[i].state;
    if (points->count[HF_POINT_OUTDATED] && !(wanted & 1u << HF_POINT_OUTDATED))
        return hf_error(w->messages, HF_EXISTS,
                        "%s: the base case has changed since %d points were run; --retry outdated,missing runs them "
                        "anew, --dir chooses another folder",
                        w->ledger.folder, points->count[HF_POINT_OUTDATED]);
    for (int i = task; i < points->n_point; i += tasks)
        if (wanted & 1u << points->point[i].state)
            w->todo[w->n_todo++] = i;
        else
            w->n_failed_before += points->point[i].state == HF_POINT_FAILED;
    return HF_OK;
}

/* ---- one point ---- */

/* Writes the first error message as one line, without "error: " in front. */
static void first_error(const hf_messages *said, hf_status status, char reason[1024])
{
    const char *from = said->text;
    while (from && strncmp(from, "error: ", 7)) {
        from = strchr(from, '\n');
        if (from) from++;
    }
    if (from && *from)
        snprintf(reason, 1024, "%.*s", (int)strcspn(from + 7, "\n"), from + 7);
    else
        snprintf(reason, 1024, "%s", hf_status_text(status));
    hf_text_trim_utf8(reason);
}

static void show_progress(sweep *w, double now_s)
{
    int finished = w->n_done + w->n_failed;
    char left[32];
    if (!w->progress || now_s - w->said_s < (w->on_terminal ? REFRESH_S : LOG_S)) return;
    w->said_s = now_s;
    hf_print_duration((now_s - w->start_s) * (w->n_todo - finished) / (finished ? finished : 1), left, sizeof left);
    fprintf(w->progress, "%s%d of %d points, %d failed, %s left%s", w->on_terminal ? "\r\033[K" : "", finished,
            w->n_todo, w->n_failed, finished ? left : "?", w->on_terminal ? "" : "\n");
    fflush(w->progress);
}

static void finish_point(sweep *w, int i, hf_status status, const hf_messages *said, const hf_summary *summary)
{
    char reason[1024] = "";
    hf_messages trouble = {0};
    if (status != HF_OK) first_error(said, status, reason);
    hf_status written = hf_ledger_write(&w->ledger, w->study, i, status, reason, summary, &trouble);
    pthread_mutex_lock(&w->lock);
    w->n_done += status == HF_OK;
    w->n_failed += status != HF_OK;
    if (written != HF_OK && w->fatal == HF_OK) {
        w->fatal = written;
        const char *words = trouble.text ? trouble.text + strlen("error: ") : "cannot write";
        hf_error(w->messages, written, "%.*s", (int)strcspn(words, "\n"), words);
    }
    show_progress(w, hf_clock_s());
    pthread_mutex_unlock(&w->lock);
    hf_messages_free(&trouble);
}

static bool must_stop(const sweep *w)
{
    return *w->stop_requested || w->fatal != HF_OK;
}

/* A point whose computation has ended and whose result file is being written to the disk. */
typedef struct {
    sweep *w;
    int i;
    hf_status status;
    hf_store *store; /* NULL: there is no file, or it already has its final name */
    hf_messages said;
    hf_summary summary;
} finished_point;

static void settle_point(void *context)
{
    finished_point *p = context;
    hf_status settled = hf_store_settle(p->store, &p->said);
    if (settled != HF_OK) p->status = settled;
    if (p->status != HF_INTERRUPTED) finish_point(p->w, p->i, p->status, &p->said, &p->summary);
    hf_ledger_release(&p->w->ledger, p->w->study->id[p->i]);
    hf_messages_free(&p->said);
    free(p);
}

static void out_of_memory(sweep *w, const char *id)
{
    hf_ledger_release(&w->ledger, id);
    pthread_mutex_lock(&w->lock);
    w->fatal = hf_error(w->messages, HF_NO_MEMORY, "out of memory for a point");
    pthread_mutex_unlock(&w->lock);
}

static void run_point(void *context, int k)
{
    sweep *w = context;
    int i = w->todo[k];
    const char *id = w->study->id[i];
    if (must_stop(w)) return;
    bool is_ours = hf_ledger_claim(&w->ledger, id);
    if (!is_ours || hf_ledger_is_finished(&w->ledger, w->study, i)) { /* another sweep has finished it meanwhile */
        if (is_ours) hf_ledger_release(&w->ledger, id);
        pthread_mutex_lock(&w->lock);
        w->n_elsewhere++;
        pthread_mutex_unlock(&w->lock);
        return;
    }
    char file[HF_PATH_SIZE + 32], output[HF_OUTPUT_SIZE];
    hf_study_overrides overrides;
    finished_point *p = calloc(1, sizeof *p);
    if (!p) {
        out_of_memory(w, id);
        return;
    }
    *p = (finished_point){.w = w, .i = i};
    hf_study_point(w->study, i, &overrides);
    bool is_empty = hf_ledger_file(w->ledger.folder, w->study, i, file) == HF_LEDGER_EMPTY_FILE;
    hf_run_request request = {.case_path = w->study->base,
                              .set = overrides.set,
                              .n_set = overrides.n_set,
                              .output = file,
                              .of_sweep = 1,
                              .no_file = !hf_study_has_files(w->study),
                              .restart = w->state[i] == HF_POINT_FAILED || is_empty,
                              .threads = w->threads,
                              .argc = w->options->argc,
                              .argv = w->options->argv,
                              .stop_requested = w->stop_requested,
                              .unsettled = &p->store};
    p->status = hf_run_case(&request, &p->summary, output, &p->said);
    if (p->store)
        hf_later_do(settle_point, p);
    else
        settle_point(p);
}

/* ---- sweep ---- */

static hf_status run_points(sweep *w, FILE *file)
{
    bool quiet = w->options->quiet;
    char took[32];
    w->start_s = w->said_s = hf_clock_s();
    w->on_terminal = isatty(STDERR_FILENO);
    w->progress = quiet ? NULL : stderr;
    hf_parallel_for(w->threads, w->n_todo, run_point, w);
    if (w->progress && w->on_terminal) fputs("\r\033[K", w->progress);
    int left = w->n_todo - w->n_done - w->n_failed - w->n_elsewhere;
    hf_print_duration(hf_clock_s() - w->start_s, took, sizeof took);
    if (!quiet)
        fprintf(file, "%d points run in %s on %d threads, %d of them failed; results in %s\n", w->n_done + w->n_failed,
                took, w->threads, w->n_failed, w->ledger.folder);
    if (w->n_elsewhere) hf_warning(w->messages, "%d points are run by another process", w->n_elsewhere);
    if (w->fatal != HF_OK) return w->fatal;
    if (left)
        return hf_error(w->messages, HF_INTERRUPTED, "told to stop: %d points are left; the same command goes on",
                        left);
    int n_failed = w->n_failed + w->n_failed_before;
    if (!n_failed) return HF_OK;
    return hf_error(w->messages, HF_POINTS_FAILED, "%d points failed%s; 'hifdm status' says why", n_failed,
                    w->n_failed ? "" : " earlier and are not run again without --retry failed");
}

static hf_status sweep_study(sweep *w, const char *folder, int task, int tasks, FILE *file)
{
    hf_points points;
    hf_status status = hf_ledger_open(folder, &w->ledger, w->messages);
    if (status == HF_OK) status = hf_ledger_watch(&w->ledger, w->study, w->messages);
    if (status == HF_OK) {
        status = hf_ledger_read(folder, w->study, &points, w->messages);
        if (status == HF_OK) status = choose_points(w, &points, task, tasks);
        hf_points_free(&points);
    }
    if (status == HF_OK) status = run_points(w, file);
    hf_ledger_close(&w->ledger);
    return status;
}

static hf_status command_sweep(const hf_options *o, FILE *file, hf_messages *messages)
{
    char folder[HF_PATH_SIZE];
    hf_study study;
    sweep w = {.options = o,
               .stop_requested = hf_signals_watch(),
               .study = &study,
               .threads = o->threads ? o->threads : hf_batch_default_threads(),
               .messages = messages};
    int task, tasks;
    HF_TRY(choose_task(o, &task, &tasks, messages));
    HF_TRY(hf_study_files_name(o->folder, o->file, ".d", folder, messages));
    hf_status status = hf_study_read(o->file, &study, messages);
    pthread_mutex_init(&w.lock, NULL);
    if (status == HF_OK) status = sweep_study(&w, folder, task, tasks, file);
    pthread_mutex_destroy(&w.lock);
    free(w.todo);
    free(w.state);
    hf_study_free(&study);
    return status;
}

const hf_command hf_cmd_sweep = {
    .name = "sweep",
    .argument = "STUDY",
    .help = "run the points of a sweep that are missing, on all cores; each once, a failed one stops no other",
    .about = "A study is a base case and axes over its keys. Points that are done are not run again, so the same "
             "command goes on after whatever stopped it. In a Slurm array every task takes its share.",
    .examples = "hifdm sweep study.yaml\n"
                "hifdm sweep study.yaml --task 0 --tasks 8\n"
                "hifdm sweep study.yaml --retry failed",
    .uses_threads = true,
    .run = command_sweep,
};
