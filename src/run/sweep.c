/* Runs the missing points of a study on all cores.
 *
 *     ledger of the folder -> points to run (their states, task of several)
 *         | each point, on any thread:
 *         |     claim it by a lock, run the case with its overrides
 *         |     settle the file in the background, write the row of the ledger, release the lock
 *         v
 *     counts; a fault of the machine stops the sweep and fails no point */
#include "run/sweep.h"

#include "base/child.h"
#include "base/clock.h"
#include "base/later.h"
#include "base/path.h"
#include "base/text.h"
#include "linalg/lapack.h"
#include "run/requirements_stage.h"
#include "search/parallel.h"
#include "store/ledger.h"
#include <hifdm/run.h>
#include <hifdm/store.h>

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- points to run ---- */

typedef struct {
    const hf_sweep_request *request;
    hf_ledger ledger;
    hf_point_state *state; /* [n_point] before this sweep */
    int *todo;             /* [count.n_todo] points to run */
    double start_s;
    pthread_mutex_t lock; /* protects count, messages and the observer */
    hf_sweep_count count;
    hf_messages *messages;
    bool has_requirements;   /* of the points that were run */
    bool is_without_locks;   /* the file system has no locks, and a warning was given */
    _Atomic hf_status fatal; /* not HF_OK: fault of the machine, no point may begin; read without the lock */
} sweep;

static hf_status choose_points(sweep *w, const hf_points *points)
{
    unsigned wanted = w->request->retry ? w->request->retry : 1u << HF_POINT_MISSING;
    w->todo = malloc((size_t)points->n_point * sizeof *w->todo);
    w->state = malloc((size_t)points->n_point * sizeof *w->state);
    if (!w->todo || !w->state)
        return hf_error(w->messages, HF_NO_MEMORY, "out of memory for %d points", points->n_point);
    for (int i = 0; i < points->n_point; i++)
        w->state[i] = points->point[i].state;
    if (points->count[HF_POINT_OUTDATED] && !(wanted & 1u << HF_POINT_OUTDATED))
        return hf_error(w->messages, HF_EXISTS,
                        "%s: the base case has changed since %d points were run. Use --retry outdated,missing to run "
                        "these points again, or use --dir to select another folder",
                        w->ledger.folder, points->count[HF_POINT_OUTDATED]);
    for (int i = w->request->task; i < points->n_point; i += w->request->tasks)
        if (wanted & 1u << points->point[i].state)
            w->todo[w->count.n_todo++] = i;
        else
            w->count.n_failed_before += points->point[i].state == HF_POINT_FAILED;
    return HF_OK;
}

/* ---- one point ---- */

static void stop_sweep(sweep *w, hf_status status, const char *id, const char *words)
{
    pthread_mutex_lock(&w->lock);
    if (w->fatal == HF_OK) w->fatal = hf_error(w->messages, status, "point %s: %s", id, words);
    pthread_mutex_unlock(&w->lock);
}

/* Repeats those warnings of a point that are about files left in the folder of the sweep. The result file contains the
 * others. */
static void warn_of_files(sweep *w, const hf_messages *said)
{
    static const char begin[] = "warning: ";
    int n = 0;
    for (const char *line = said->text; line && *line; line += n + (line[n] == '\n')) {
        const char *found = strstr(line, ": cannot remove ");
        n = (int)strcspn(line, "\n");
        if (!strncmp(line, begin, strlen(begin)) && found && found < line + n)
            hf_warning(w->messages, "%.*s", n - (int)strlen(begin), line + strlen(begin));
    }
}

static void finish_point(sweep *w, int i, hf_status status, const hf_messages *said, const hf_summary *summary)
{
    char reason[HF_LEDGER_REASON_MAX + 1] = ""; /* the first error message as one line */
    hf_messages trouble = {0};
    const hf_sweep_request *r = w->request;
    if (status != HF_OK) {
        const char *why = hf_text_first_error(said->text, hf_status_text(status));
        snprintf(reason, sizeof reason, "%.*s", (int)strcspn(why, "\n"), why);
        hf_text_trim_utf8(reason);
    }
    /* Another attempt may not have a fault of the machine: the point does not count as failed, and no other begins. */
    if (status == HF_IO || status == HF_NO_MEMORY) {
        stop_sweep(w, status, r->study->id[i], reason);
        return;
    }
    hf_status written = hf_ledger_write(&w->ledger, w->request->study, i, status, reason, summary, &trouble);
    pthread_mutex_lock(&w->lock);
    warn_of_files(w, said);
    w->has_requirements |= summary->n_requirement > 0;
    w->count.n_done += status == HF_OK;
    w->count.n_failed += status != HF_OK;
    const char *words = hf_text_first_error(trouble.text, "cannot write");
    if (written != HF_OK && w->fatal == HF_OK)
        w->fatal = hf_error(w->messages, written, "%.*s", (int)strcspn(words, "\n"), words);
    w->count.wall_s = hf_clock_s() - w->start_s;
    if (r->observer) r->observer(r->observer_context, &w->count);
    pthread_mutex_unlock(&w->lock);
    hf_messages_free(&trouble);
}

/* A point that has been computed and whose result file is being written to the disk. */
typedef struct {
    sweep *w;
    int i;
    hf_status status;
    hf_store *store; /* NULL: no file, or it has its final name */
    hf_messages said;
    hf_summary summary;
} finished_point;

static void settle_point(void *context)
{
    finished_point *p = context;
    hf_status settled = hf_store_settle(p->store, &p->said);
    if (settled != HF_OK) p->status = settled;
    if (p->status != HF_INTERRUPTED) finish_point(p->w, p->i, p->status, &p->said, &p->summary);
    hf_ledger_release(&p->w->ledger, p->w->request->study->id[p->i]);
    hf_messages_free(&p->said);
    hf_summary_free(&p->summary);
    free(p);
}

/* Returns true if this process is to run the point. Without locks of the file system it always is. */
static bool claim(sweep *w, int i)
{
    const char *id = w->request->study->id[i];
    hf_lock lock = hf_ledger_claim(&w->ledger, id);
    if (lock == HF_LOCK_FAILED) {
        char words[256];
        snprintf(words, sizeof words, "cannot lock it in %s/claims: %s", hf_path_name(w->ledger.folder),
                 strerror(errno));
        stop_sweep(w, HF_IO, id, words);
        return false;
    }
    bool is_ours = lock != HF_LOCK_TAKEN;
    bool is_finished = is_ours && hf_ledger_is_finished(&w->ledger, i);
    if (is_finished) hf_ledger_release(&w->ledger, id); /* another sweep has finished it in the meantime */
    pthread_mutex_lock(&w->lock);
    w->count.n_elsewhere += !is_ours || is_finished;
    if (lock == HF_LOCK_NONE && !w->is_without_locks)
        hf_warning(w->messages,
                   "%s: this file system has no locks, so 'hifdm status' cannot show running points. Use the --task "
                   "option to prevent several sweeps from running the same points",
                   w->ledger.folder);
    w->is_without_locks |= lock == HF_LOCK_NONE;
    pthread_mutex_unlock(&w->lock);
    return is_ours && !is_finished;
}

static void run_point(void *context, int k)
{
    sweep *w = context;
    int i = w->todo[k];
    const char *id = w->request->study->id[i];
    if (*w->request->stop_requested || w->fatal != HF_OK || !claim(w, i)) return;
    char file[HF_PATH_SIZE + 32], output[HF_OUTPUT_SIZE];
    hf_study_overrides overrides;
    finished_point *p = calloc(1, sizeof *p);
    if (!p) {
        hf_ledger_release(&w->ledger, id);
        stop_sweep(w, HF_NO_MEMORY, id, hf_status_text(HF_NO_MEMORY));
        return;
    }
    *p = (finished_point){.w = w, .i = i};
    hf_study_point_overrides(w->request->study, i, &overrides);
    bool is_empty = hf_ledger_file(w->ledger.folder, w->request->study, i, file) == HF_LEDGER_EMPTY_FILE;
    hf_run_request request = {
        .input = {.case_path = w->request->study->base, .set = overrides.set, .n_set = overrides.n_set},
        .output = {.path = file,
                   .no_file = !hf_study_has_files(w->request->study),
                   .restart = w->state[i] == HF_POINT_FAILED || is_empty,
                   .argc = w->request->argc,
                   .argv = w->request->argv,
                   .unsettled = &p->store},
        .control = {.threads = w->request->threads, .stop_requested = w->request->stop_requested},
        .part = {.of_sweep = true}};
    p->status = hf_run_case(&request, &p->summary, output, &p->said);
    if (p->store)
        hf_later_do(settle_point, p);
    else
        settle_point(p);
}

/* ---- all points ---- */

static hf_status run_points(sweep *w)
{
    const hf_sweep_count *n = &w->count;
    if (n->n_todo > 0) HF_TRY(hf_lapack_load(w->messages)); /* before there are threads */
    w->start_s = hf_clock_s();
    hf_parallel_for(w->request->threads, n->n_todo, run_point, w);
    w->count.wall_s = hf_clock_s() - w->start_s;
    w->count.has_run = true;
    int left = n->n_todo - n->n_done - n->n_failed - n->n_elsewhere;
    if (n->n_elsewhere)
        hf_warning(w->messages, "other processes run or have run %d point%s of this sweep", n->n_elsewhere,
                   n->n_elsewhere == 1 ? "" : "s");
    if (w->fatal != HF_OK)
        return hf_error(
            w->messages, w->fatal,
            "the sweep has stopped with %d missing point%s, which do%s not count as failed. Remove the cause, "
            "then run the same command again to resume",
            left, left == 1 ? "" : "s", left == 1 ? "es" : "");
    if (left)
        return hf_error(w->messages, HF_INTERRUPTED,
                        "the sweep was interrupted with %d missing point%s. Run the same command again to resume", left,
                        left == 1 ? "" : "s");
    int n_failed = n->n_failed + n->n_failed_before;
    if (!n_failed) return HF_OK;
    return hf_error(w->messages, HF_POINTS_FAILED, "%d point%s failed%s. 'hifdm status' lists the reasons", n_failed,
                    n_failed == 1 ? "" : "s",
                    n->n_failed ? "" : " earlier. Only --retry failed runs failed points again");
}

hf_status hf_sweep_run(const hf_sweep_request *request, hf_sweep_count *count, hf_messages *messages)
{
    hf_points points;
    sweep w = {.request = request, .messages = messages};
    pthread_mutex_init(&w.lock, NULL);
    hf_child_server_begin(); /* before there are threads, and before the ledger has descriptors */
    hf_status status = hf_ledger_open(request->folder, &w.ledger, messages);
    if (status == HF_OK) status = hf_ledger_watch(&w.ledger, request->study, messages);
    if (status == HF_OK) {
        status = hf_ledger_read(request->folder, request->study, &points, messages);
        if (status == HF_OK) status = choose_points(&w, &points);
        hf_points_free(&points);
    }
    if (status == HF_OK) status = run_points(&w);
    if (w.has_requirements && hf_ledger_read(request->folder, request->study, &points, NULL) == HF_OK)
        hf_requirements_stage_doubt_points(&points, messages);
    if (w.has_requirements) hf_points_free(&points);
    hf_status closed = hf_ledger_close(&w.ledger, messages);
    if (closed != HF_OK) status = closed;
    hf_child_server_end();
    pthread_mutex_destroy(&w.lock);
    free(w.todo);
    free(w.state);
    *count = w.count;
    return status;
}
