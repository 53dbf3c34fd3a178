/* Prints the progress of a run: lines on a terminal or in a log, or JSON objects. progress.h describes the
 * interface. */
#include "app/progress.h"

#include "app/output.h"
#include "base/file_io.h"
#include "base/json.h"
#include "out/print.h"

#include <math.h>
#include <unistd.h>

const char *const hf_progress_word[6] = {"auto", "none", "line", "log", "jsonl", NULL};
/* The time in s between two lines, for each hf_progress_mode. */
static const double interval_s[] = {0, 0, 0.1, 30, 1};

hf_progress hf_progress_on(FILE *file, hf_progress_mode mode)
{
    if (mode == HF_PROGRESS_AUTO) mode = isatty(fileno(file)) ? HF_PROGRESS_LINE : HF_PROGRESS_LOG;
    return (hf_progress){.file = file, .mode = mode};
}

/* Returns the evaluations per second of this process. */
static double rate_per_s(const hf_run_progress *now)
{
    return now->elapsed_s > 0 ? (double)now->evaluations / now->elapsed_s : 0;
}

/* Returns an upper bound of the remaining time; the optimisation may stop before its last generation. Generations of an
 * earlier process do not count, because the elapsed time does not contain them. */
static double left_s(const hf_run_progress *now)
{
    bool steps = now->phase == HF_RUN_REFINE;
    int at = steps ? now->step : now->generation, done = at - (steps ? now->first_step : now->first_generation);
    return done > 0 ? now->elapsed_s * ((steps ? now->max_steps : now->generations) - at) / done : 0;
}

static void show_samples(FILE *f, const hf_run_progress *now)
{
    double each_s = now->evaluations > 0 ? now->elapsed_s / (double)now->evaluations : 0;
    if (now->evaluations == 0)
        fprintf(f, "first order, before %ld samples", now->samples_all);
    else if (now->sigma_scale > 0)
        fprintf(f, "sample %ld/%ld; the yield with %.3g times the errors", now->samples, now->samples_all,
                now->sigma_scale);
    else
        fprintf(f, "sample %ld/%ld  %.0f samples/s  %s left", now->samples, now->samples_all, rate_per_s(now),
                hf_print_duration(each_s * (double)(now->samples_all - now->samples)).text);
}

static void show_generation(FILE *f, const hf_run_progress *now)
{
    fprintf(f, "generation %d/%d  ", now->generation, now->generations);
    if (isfinite(now->best_psi_m)) fprintf(f, "best psi %.4f mm  ", now->best_psi_m * 1e3);
    fprintf(f, "%.0f evaluations/s  at most %s left", rate_per_s(now), hf_print_duration(left_s(now)).text);
}

static void show_step(FILE *f, const hf_run_progress *now)
{
    fprintf(f, "Levenberg-Marquardt: step %d of at most %d  ", now->step, now->max_steps);
    if (now->violation > 0)
        fprintf(f, "outside the limits and requirements by %.3g (sum of relative distances)", now->violation);
    else
        fprintf(f, "psi %.4f mm", now->best_psi_m * 1e3);
    if (isfinite(now->merit) && now->violation == 0) fprintf(f, ", merit %.6g", now->merit);
    /* the time left is not known: most refinements converge long before the last step */
    if (now->step > now->first_step)
        fprintf(f, "  %s a step", hf_print_duration(now->elapsed_s / (now->step - now->first_step)).text);
}

static void show_front(FILE *f, const hf_run_progress *now)
{
    fprintf(f, "front: point %d/%d  %ld steps of Levenberg-Marquardt  %s so far", now->points, now->points_all,
            now->steps, hf_print_duration(now->elapsed_s).text);
}

static void show_json(FILE *f, const hf_run_progress *now)
{
    hf_json j = {.file = f};
    bool samples = now->phase == HF_RUN_TOLERANCE, front = now->points_all > 0, generations = now->generation > 0;
    bool steps = now->phase == HF_RUN_REFINE && now->max_steps > 0;
    hf_json_open(&j, NULL, '{');
    hf_json_text(&j, "phase", hf_run_phase_word[now->phase]);
    if (samples) {
        hf_json_integer(&j, "sample", now->samples);
        hf_json_integer(&j, "samples", now->samples_all);
        if (now->sigma_scale > 0)
            hf_json_number(&j, "sigma_scale", now->sigma_scale);
        else
            hf_json_number(&j, "samples_per_s", rate_per_s(now));
    }
    if (front) {
        hf_json_integer(&j, "point", now->points);
        hf_json_integer(&j, "points", now->points_all);
        hf_json_integer(&j, "steps", now->steps);
    }
    if (steps) {
        hf_json_integer(&j, "step", now->step);
        hf_json_integer(&j, "max_steps", now->max_steps);
    }
    if (generations) {
        hf_json_integer(&j, "generation", now->generation);
        hf_json_integer(&j, "generations", now->generations);
        hf_json_integer(&j, "first_generation", now->first_generation);
    }
    if (steps || generations) {
        hf_json_integer(&j, "evaluations", now->evaluations);
        hf_json_number(&j, "best_psi_m", now->best_psi_m);
    }
    if (steps && isfinite(now->merit)) hf_json_number(&j, "merit", now->merit);
    if (now->violation > 0) hf_json_number(&j, "violation", now->violation);
    if (generations) hf_json_number(&j, "evaluations_per_s", rate_per_s(now));
    if (samples || front || steps || generations) hf_json_number(&j, "elapsed_s", now->elapsed_s);
    if (steps || generations) hf_json_number(&j, "at_most_left_s", left_s(now));
    hf_json_close(&j, '}');
}

void hf_progress_show(void *progress, const hf_run_progress *now)
{
    hf_progress *p = progress;
    bool samples = now->phase == HF_RUN_TOLERANCE, steps = now->phase == HF_RUN_REFINE, front = now->points_all > 0;
    bool is_first = samples ? now->evaluations == 0
                    : front ? now->steps == 0
                    : steps ? now->step <= now->first_step
                            : now->generation <= now->first_generation + 1;
    bool is_last = (samples || steps || now->generation > 0) && now->is_last;
    bool has_line = samples ? now->evaluations > 0 || p->mode == HF_PROGRESS_LINE
                    : steps ? now->max_steps > 0 || front
                            : now->phase == HF_RUN_SEARCH;
    if (is_first) p->last_s = p->mode == HF_PROGRESS_LOG ? 0 : -interval_s[p->mode];
    if (p->mode == HF_PROGRESS_NONE || (!has_line && p->mode != HF_PROGRESS_JSONL)) return;
    if (now->elapsed_s - p->last_s < interval_s[p->mode] && !(is_last && p->mode == HF_PROGRESS_JSONL)) return;
    p->last_s = now->elapsed_s;
    if (!hf_file_io_await_room(fileno(p->file), 0)) return;
    void (*show)(FILE *, const hf_run_progress *) = p->mode == HF_PROGRESS_JSONL ? show_json
                                                    : samples                    ? show_samples
                                                    : front                      ? show_front
                                                    : steps                      ? show_step
                                                                                 : show_generation;
    p->is_shown = p->mode == HF_PROGRESS_LINE;
    if (p->is_shown) fputs(HF_OUTPUT_CLEAR_LINE, p->file);
    show(p->file, now);
    if (!p->is_shown) fputc('\n', p->file);
    fflush(p->file);
}

void hf_progress_end(hf_progress *p)
{
    if (!p->is_shown || !hf_file_io_await_room(fileno(p->file), 0)) return;
    fputs(HF_OUTPUT_CLEAR_LINE, p->file);
    fflush(p->file);
    p->is_shown = false;
}
