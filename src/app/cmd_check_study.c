#include "app/cmd_check_study.h"

#include "app/study_files.h"
#include "base/clock.h"
#include "base/text.h"
#include "out/print.h"
#include "run/problem_parts.h"

#include <string.h>

#define VALUES_TOLD 6 /* of an axis; of more the first and the last */
#define MAKING_S 5.0  /* the nets of so many points are made as this time allows */

static const char *value_of(const hf_study_axis *axis, int k)
{
    return strchr(axis->canonical[k], '=') + 1;
}

static void print_axes(const hf_study *s, FILE *f)
{
    for (int a = 0; a < s->n_axis; a++) {
        const hf_study_axis *axis = &s->axis[a];
        char text[1024];
        size_t used = 0;
        for (int k = 0; k < axis->n_value && axis->n_value <= VALUES_TOLD && used < sizeof text; k++)
            used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", k ? ", " : "", value_of(axis, k));
        if (axis->n_value > VALUES_TOLD)
            snprintf(text, sizeof text, "%d values%s, %s .. %s", axis->n_value, axis->is_sampled ? ", sampled" : "",
                     value_of(axis, 0), value_of(axis, axis->n_value - 1));
        hf_text_trim_utf8(text);
        hf_print_line(f, "  %-13s %s: %s%s%s", a ? "" : "axes", axis->key.path, text, *axis->key.field->unit ? " " : "",
                      axis->key.field->unit);
    }
}

static void print_points(const hf_study *s, FILE *f)
{
    char text[512];
    hf_print_line(f, "  %-13s %d%s%s", "points", s->n_point, s->is_zip ? ", the axes side by side" : "",
                  s->derives_seed ? ", each with a seed of its own" : "");
    for (int is_last = 0; is_last < 2; is_last++) {
        int i = is_last ? s->n_point - 1 : 0;
        hf_study_point_text(s, i, text, sizeof text);
        hf_print_line(f, "  %-13s %s %s: %s", "", is_last ? "last " : "first", s->id[i], text);
    }
}

/* What is in the folder of the results. */
static hf_status print_done(const hf_study *s, int *n_left, FILE *f, hf_messages *messages)
{
    char folder[HF_PATH_SIZE];
    hf_points points = {0};
    HF_TRY(hf_study_files_name(NULL, s->path, ".d", folder, messages));
    hf_status status = hf_ledger_read(folder, s, &points, messages);
    if (status == HF_OK) {
        const int *count = points.count;
        *n_left = count[HF_POINT_MISSING];
        hf_print_line(f, "  %-13s in %s, %s: %d done, %d failed, %d running, %d to run", "results", folder,
                      hf_study_has_files(s) ? "a file for each point" : "a row for each point and no files",
                      count[HF_POINT_DONE], count[HF_POINT_FAILED], count[HF_POINT_RUNNING], *n_left);
        if (count[HF_POINT_OUTDATED])
            hf_print_line(f, "  %-13s %d more are of another version of %s: --retry outdated,missing runs them anew",
                          "", count[HF_POINT_OUTDATED], s->base);
    }
    hf_points_free(&points);
    return status;
}

/* Make scene and model of the points as `hifdm run` does, as many as there is time for, to find what only they show. */
static hf_status make_points(const hf_study *s, int *n_made, hf_messages *messages)
{
    double begin_s = hf_clock_s();
    int n_fault = 0;
    for (int i = 0; i < s->n_point && hf_clock_s() - begin_s < MAKING_S; i++, ++*n_made) {
        hf_study_overrides o;
        hf_messages found = {0};
        hf_problem p = {0};
        hf_study_point_overrides(s, i, &o);
        hf_status status = hf_problem_load(s->base, NULL, o.set, o.n_set, NULL, &p, &found);
        hf_problem_free(&p);
        if (status != HF_OK && n_fault++ < HF_FAULT_MAX_POINT) hf_study_tell_faults(s, i, &found, messages);
        hf_messages_free(&found);
        if (status == HF_NO_MEMORY || status == HF_IO || status == HF_INTERRUPTED) return status;
    }
    if (n_fault > HF_FAULT_MAX_POINT)
        hf_error(messages, HF_BAD_CASE, "%s: sweep: and %d more points with faults", s->path,
                 n_fault - HF_FAULT_MAX_POINT);
    return n_fault ? HF_BAD_CASE : HF_OK;
}

static void print_time(int n_left, double each_s, int threads, bool has_tolerance, FILE *f)
{
    char one[32], all[32];
    const char *more = has_tolerance ? ", and the time of the nets as built" : "";
    hf_print_duration(each_s, one, sizeof one);
    hf_print_duration(each_s * n_left / threads, all, sizeof all);
    if (n_left)
        fprintf(f, "%d points to run, each like this one at most some %s, on %d threads: at most about %s%s\n", n_left,
                one, threads, all, more);
    else
        fprintf(f, "all points have been run\n");
}

static hf_status check_study(const hf_check_request *request, const hf_study *s, FILE *f, hf_messages *messages)
{
    char text[512];
    hf_study_overrides o;
    double most_s;
    int n_left = 0, n_made = 0;
    HF_TRY(make_points(s, &n_made, messages));
    hf_print_line(f, "%s: valid", request->name);
    if (*s->title) hf_print_line(f, "  %-13s %s", "study", s->title);
    hf_print_line(f, "  %-13s %s", "base case", s->base);
    print_axes(s, f);
    print_points(s, f);
    if (n_made < s->n_point) fprintf(f, "  %-13s the nets of %d were made, the others are only read\n", "", n_made);
    HF_TRY(print_done(s, &n_left, f, messages));
    hf_study_point_overrides(s, 0, &o);
    snprintf(text, sizeof text, "the first point, %s", s->id[0]);
    const hf_check_request first = {.path = s->base, .name = text, .set = o.set, .n_set = o.n_set, .threads = 1};
    hf_status status = hf_check_case(&first, &most_s, f, messages);
    print_time(n_left, most_s, request->threads, s->has_tolerance, f);
    return status;
}

hf_status hf_check_study(const hf_check_request *request, FILE *f, hf_messages *messages)
{
    hf_study study;
    if (request->n_set)
        return hf_error(messages, HF_BAD_USAGE, "%s: is a study, which takes no --set: change its base case or an axis",
                        request->name);
    hf_status status = hf_study_read(request->path, &study, messages);
    if (status == HF_OK) status = check_study(request, &study, f, messages);
    hf_study_free(&study);
    return status;
}
