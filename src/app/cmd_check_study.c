/* Runs `hifdm check` of a study. cmd_check_study.h describes the interface.
 *
 *     study -> make the nets of as many points as time allows -> axes, points, results so far -> check of one point */
#include "app/cmd_check_study.h"

#include "app/study_files.h"
#include "base/text.h"
#include "out/print.h"

#include <string.h>

#define VALUES_TOLD 6 /* maximum number of values that are listed for an axis; else the first and the last */

static const char *value_of(const hf_study_axis *axis, int k)
{
    return strchr(axis->canonical[k], '=') + 1;
}

static void print_axes(const hf_study *s, FILE *f)
{
    for (int a = 0; a < s->n_axis; a++) {
        const hf_study_axis *axis = &s->axis[a];
        char text[1024] = "";
        for (int k = 0; k < axis->n_value && axis->n_value <= VALUES_TOLD; k++)
            hf_text_append(text, sizeof text, ", ", value_of(axis, k), "");
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

/* Prints the number of points in each state, from the folder of the results. */
static hf_status print_done(const hf_study *s, int count[HF_N_POINT_STATE], FILE *f, hf_messages *messages)
{
    char folder[HF_PATH_SIZE];
    hf_points points = {0};
    HF_TRY(hf_study_files_name(NULL, s->path, ".d", folder, messages));
    hf_status status = hf_ledger_read(folder, s, &points, messages);
    if (status == HF_OK) {
        memcpy(count, points.count, sizeof points.count);
        hf_print_line(f, "  %-13s in %s, %s: %d done, %d failed, %d running, %d to run", "results", folder,
                      hf_study_has_files(s) ? "a file for each point" : "a row for each point and no files",
                      count[HF_POINT_DONE], count[HF_POINT_FAILED], count[HF_POINT_RUNNING], count[HF_POINT_MISSING]);
        if (count[HF_POINT_OUTDATED])
            hf_print_line(f, "  %-13s %d outdated: of another version of %s", "", count[HF_POINT_OUTDATED], s->base);
    }
    hf_points_free(&points);
    return status;
}

static void print_time(int n, const char *what, double each_s, int threads, bool has_tolerance, FILE *f)
{
    double all_s = hf_check_together_s(each_s, n, &threads);
    fprintf(f, "%d point%s to run%s, each like this one at most some %s, on %d thread%s: at most about %s%s\n", n,
            n == 1 ? "" : "s", what, hf_print_duration(each_s).text, threads, threads == 1 ? "" : "s",
            hf_print_duration(all_s).text, has_tolerance ? ", plus the time of the as-built samples" : "");
}

/* Prints what a sweep runs by default, and what it runs again with --retry. */
static void print_left(const hf_study *s, const int count[HF_N_POINT_STATE], double each_s, int threads, FILE *f)
{
    static const hf_point_state other[] = {HF_POINT_FAILED, HF_POINT_OUTDATED, HF_POINT_RUNNING};
    int n_missing = count[HF_POINT_MISSING], n_anew = count[HF_POINT_FAILED] + count[HF_POINT_OUTDATED];
    char told[128] = "", retry[64] = "", item[32];
    if (n_missing) print_time(n_missing, "", each_s, threads, s->has_tolerance, f);
    if (n_missing && n_anew) strcpy(retry, hf_point_state_word[0]);
    for (size_t k = 0; k < sizeof other / sizeof *other; k++) {
        const char *word = hf_point_state_word[other[k]];
        if (!count[other[k]]) continue;
        snprintf(item, sizeof item, "%d %s", count[other[k]], word);
        hf_text_append(told, sizeof told, ", ", item, "");
        if (other[k] != HF_POINT_RUNNING) hf_text_append(retry, sizeof retry, ",", word, "");
    }
    if (n_anew)
        hf_print_line(f, "%s%s: `hifdm sweep %s --retry %s`%s", n_missing ? "" : "nothing is missing; ", told, s->path,
                      retry, n_missing ? " runs these, too" : "");
    else if (!n_missing && *told)
        hf_print_line(f, "nothing is missing; %s", told);
    else if (!n_missing)
        fprintf(f, "all points have been run\n");
    if (!n_missing && n_anew) print_time(n_anew, " anew", each_s, threads, s->has_tolerance, f);
}

static hf_status check_study(const hf_check_request *request, const hf_study *s, hf_check *check, FILE *f,
                             hf_messages *messages)
{
    char text[512];
    hf_study_overrides o;
    int count[HF_N_POINT_STATE] = {0};
    hf_check_points t;
    HF_TRY(hf_check_study_points(s, &check->problem, &t, messages));
    hf_print_line(f, "%s: valid", request->path);
    if (*s->title) hf_print_line(f, "  %-13s %s", "study", s->title);
    hf_print_line(f, "  %-13s %s", "base case", s->base);
    print_axes(s, f);
    print_points(s, f);
    if (t.n_tried < s->n_point) fprintf(f, "  %-13s the nets of %d of them were made\n", "", t.n_tried);
    if (t.n_fault) fprintf(f, "  %-13s %d of these cannot be run\n", "", t.n_fault);
    HF_TRY(print_done(s, count, f, messages));
    hf_study_point_overrides(s, t.first, &o);
    snprintf(text, sizeof text, t.first ? "point %s" : "the first point, %s", s->id[t.first]);
    const hf_check_request first = {.path = s->base, .set = o.set, .n_set = o.n_set, .threads = 1};
    hf_status status = hf_cmd_check_case(&first, text, check, f, messages);
    print_left(s, count, check->at_most_s, request->threads, f);
    if (status != HF_OK || t.n_fault == 0) return status;
    return hf_error(messages, HF_POINTS_FAILED,
                    "%s: sweep: %d of the %d points that were tried cannot be run. A sweep counts them as failed and "
                    "runs the others",
                    s->path, t.n_fault, t.n_tried);
}

hf_status hf_cmd_check_study(const hf_check_request *request, hf_check *check, FILE *f, hf_messages *messages)
{
    static hf_study study;
    if (request->n_set)
        return hf_error(messages, HF_BAD_USAGE, "%s: --set does not work with a study; change its base case or an axis",
                        request->path);
    hf_status status = hf_study_read(request->path, &study, messages);
    if (status == HF_OK) status = check_study(request, &study, check, f, messages);
    hf_study_free(&study);
    return status;
}
