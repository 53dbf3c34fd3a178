/* Implements report_required.h. */
#include "out/report_required.h"

#include "base/elementary.h"
#include "built/required.h"
#include "store/store_open.h"
#include "store/store_read.h"
#include "store/store_series.h"
#include <hifdm/config.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define VALUES_MAX 400 /* values of a curve on the page, about what a screen can show */

/* Sorts the samples, and keeps evenly spaced ones, the first and the last among them. */
static hf_status keep_values(const hf_series *samples, hf_report_curve *to)
{
    int n = 0;
    for (int i = 0; i < samples->n; i++) /* a sample without a shape has no value */
        if (isfinite(samples->value[i])) samples->value[n++] = samples->value[i];
    qsort(samples->value, (size_t)n, sizeof(double), hf_compare_doubles);
    to->n = samples->n;
    to->n_value = n < VALUES_MAX ? n : VALUES_MAX;
    to->value = calloc(2 * (size_t)to->n_value + 1, sizeof(double));
    if (!to->value) return HF_NO_MEMORY;
    to->share = to->value + to->n_value;
    for (int k = 0; k < to->n_value; k++) {
        int i = to->n_value == n ? k : (int)((long)k * (n - 1) / (VALUES_MAX - 1));
        to->value[k] = samples->value[i];
        to->share[k] = (i + 1.0) / samples->n;
    }
    return HF_OK;
}

/* Ranks the cables by the number of samples in which their tension breaks the bound. `at` [n samples] are the cables
 * with the tension. */
static hf_status rank_cables(const hf_series *samples, const hf_series *at, double bound, int n_cable,
                             hf_report_curve *to)
{
    int *count = calloc((size_t)n_cable + 1, sizeof *count);
    if (!count) return HF_NO_MEMORY;
    for (int i = 0; i < samples->n; i++) {
        double v = samples->value[i], e = at->value[i];
        if (!(to->is_low ? v < bound : v > bound) || !(e >= 0 && e < n_cable)) continue;
        count[(int)e]++;
        to->n_failing++;
    }
    for (to->n_cable = 0; to->n_cable < HF_TOLERANCE_RANKED; to->n_cable++) {
        int most = 0;
        for (int e = 1; e < n_cable; e++)
            if (count[e] > count[most]) most = e;
        if (count[most] == 0) break;
        to->cable[to->n_cable] = most;
        to->count[to->n_cable] = count[most];
        count[most] = 0;
    }
    free(count);
    return HF_OK;
}

/* Returns the distance of a value of this curve from the bounds that the curve belongs to. Both bounds of a tension
 * have a curve of their own. */
static double distance_of(const hf_report_curve *c, const hf_requirement_settings *row, double value)
{
    double nearest = INFINITY;
    for (int is_high = 0; is_high < 2; is_high++) {
        bool is_other = row->figure == HF_REQUIRED_TENSION && c->is_low == is_high;
        if (isnan(is_high ? row->at_most : row->at_least) || is_other) continue;
        nearest = fmin(nearest, hf_required_distance(row, is_high, value));
    }
    return nearest;
}

/* Takes the samples of a load case into the worst of all load cases. A sample without a value has none there, too. */
static hf_status take_worst(const hf_report_curve *c, const hf_requirement_settings *row, const hf_series *samples,
                            hf_series *worst)
{
    bool is_first = worst->n == 0;
    if (is_first) worst->value = malloc(((size_t)samples->n + 1) * sizeof *worst->value);
    if (!worst->value) return HF_NO_MEMORY;
    if (is_first) worst->n = samples->n;
    for (int i = 0; i < worst->n; i++) {
        double value = i < samples->n ? samples->value[i] : (double)NAN;
        bool has_both = !isnan(value) && (is_first || !isnan(worst->value[i]));
        if (!has_both)
            worst->value[i] = (double)NAN;
        else if (is_first || distance_of(c, row, value) < distance_of(c, row, worst->value[i]))
            worst->value[i] = value;
    }
    return HF_OK;
}

/* Appends a curve of samples. `samples` are sorted. */
static hf_status add_curve(hf_report_curve c, hf_series *samples, hf_report_curves *curves)
{
    if (samples->n == 0) return HF_OK;
    HF_TRY(keep_values(samples, &c));
    curves->curve[curves->n++] = c;
    return HF_OK;
}

static hf_status read_curve(const char *path, hf_report_curve c, const hf_requirement_settings *row, int n_cable,
                            hf_series *worst, hf_report_curves *curves, hf_messages *messages)
{
    const hf_required_column column = {.figure = row->figure,
                                       .is_minimum = c.is_low,
                                       .feed = row->feed,
                                       .frequency_Hz = row->frequency_Hz,
                                       .set = row->set};
    char name[HF_REQUIRED_NAME_SIZE], place[HF_REQUIRED_NAME_SIZE + HF_SET_NAME_SIZE + 40];
    hf_series samples = {0}, at = {0};
    snprintf(place, sizeof place, "/tolerance/load_case/%s/%s", c.load_case, hf_required_column_name(&column, name));
    hf_status status = hf_store_read_series(path, place, 1, &samples, messages);
    if (status == HF_OK && row->figure == HF_REQUIRED_TENSION) {
        strcat(place, "_cable"); /* earlier versions did not store it */
        status = hf_store_read_series(path, place, 1, &at, messages);
    }
    if (status == HF_OK && samples.n > 0) {
        if (at.n == samples.n)
            status = rank_cables(&samples, &at, c.is_low ? row->at_least : row->at_most, n_cable, &c);
        if (status == HF_OK && worst) status = take_worst(&c, row, &samples, worst);
        if (status == HF_OK) status = add_curve(c, &samples, curves);
        if (status == HF_NO_MEMORY) hf_error(messages, status, "%s: out of memory", path);
    }
    hf_series_free(&samples);
    hf_series_free(&at);
    return status;
}

/* Reads the curves of row i that belong to its minimum or to its maximum: of each load case and, if the row applies to
 * all of them, the worst of all. */
static hf_status read_side(const char *path, const hf_summary *s, int i, bool is_low, hf_report_curves *curves,
                           hf_messages *messages)
{
    const hf_requirement_settings *row = &s->requirement[i].row;
    bool is_all = !strcmp(row->load_case, "all");
    hf_report_curve c = {.row = i, .is_low = is_low};
    hf_series worst = {0};
    hf_status status = HF_OK;
    for (int state = 0; state <= s->n_load_case && status == HF_OK; state++) {
        c.load_case = state ? s->load_case[state - 1].name : "nominal";
        if (is_all || !strcmp(row->load_case, c.load_case))
            status = read_curve(path, c, row, s->n_cable, is_all ? &worst : NULL, curves, messages);
    }
    c.load_case = "all";
    if (status == HF_OK && add_curve(c, &worst, curves) != HF_OK)
        status = hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    hf_series_free(&worst);
    return status;
}

hf_status hf_report_curves_read(const char *path, const hf_summary *s, hf_report_curves *curves, hf_messages *messages)
{
    *curves = (hf_report_curves){0};
    if (s->n_requirement == 0) return HF_OK;
    curves->curve = calloc(2 * (size_t)s->n_requirement * (size_t)(2 + s->n_load_case), sizeof *curves->curve);
    if (!curves->curve) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    for (int i = 0; i < s->n_requirement; i++) {
        const hf_requirement_settings *row = &s->requirement[i].row;
        bool has_low = !isnan(row->at_least), has_high = !isnan(row->at_most);
        bool is_same = has_low && has_high && row->figure != HF_REQUIRED_TENSION; /* of both bounds */
        if (isnan(row->share)) continue;
        if (has_low) HF_TRY(read_side(path, s, i, true, curves, messages));
        if (has_high && !is_same) HF_TRY(read_side(path, s, i, false, curves, messages));
    }
    return HF_OK;
}

void hf_report_curves_free(hf_report_curves *curves)
{
    for (int k = 0; k < curves->n; k++)
        free(curves->curve[k].value);
    free(curves->curve);
    *curves = (hf_report_curves){0};
}

static void write_curve(const hf_report_curve *c, FILE *f)
{
    fputs("{\"load_case\":", f);
    hf_json_string(c->load_case, f);
    fprintf(f, ",\"bound\":\"%s\",\"n\":%d", c->is_low ? "at_least" : "at_most", c->n);
    hf_json_pack_values("value", "f32", c->value, c->n_value, f);
    hf_json_pack_values("share", "f32", c->share, c->n_value, f);
    if (c->n_cable) {
        hf_json j = {.file = f, .is_due = true};
        hf_json_integer(&j, "failing", c->n_failing);
        hf_json_open(&j, "cables", '[');
        for (int k = 0; k < c->n_cable; k++) {
            hf_json_integer(&j, NULL, c->cable[k]);
            hf_json_integer(&j, NULL, c->count[k]);
        }
        hf_json_close(&j, ']');
    }
    fputc('}', f);
}

void hf_report_curves_write(const hf_summary *s, const hf_report_curves *curves, FILE *f)
{
    char name[256];
    if (s->n_requirement == 0) return;
    fputs(",\n\"required\":[", f);
    for (int i = 0; i < s->n_requirement; i++) {
        const char *comma = "";
        fputs(i ? ",\n{\"name\":" : "{\"name\":", f);
        hf_json_string(hf_requirement_name(&s->requirement[i].row, name, sizeof name), f);
        fputs(",\"curves\":[", f);
        for (int k = 0; k < curves->n; k++) {
            if (curves->curve[k].row != i) continue;
            fputs(comma, f);
            write_curve(&curves->curve[k], f);
            comma = ",";
        }
        fputs("]}", f);
    }
    fputc(']', f);
}

static void write_limit(const hf_limit_settings *row, hf_json *j)
{
    if (row->figure != HF_LIMIT_TENSION) return;
    hf_json_open(j, NULL, '{');
    hf_json_text(j, "set", row->set);
    hf_json_number(j, "at_least", isfinite(row->lower) ? row->lower : (double)NAN);
    hf_json_number(j, "at_most", isfinite(row->upper) ? row->upper : (double)NAN);
    hf_json_close(j, '}');
}

void hf_report_limits_write(const char *path, hf_json *j)
{
    hf_case *c = calloc(1, sizeof *c);
    if (!c) return;
    hf_hdf5 io = hf_store_open_result(path, NULL);
    bool is_known = io.status == HF_OK && hf_store_parse_case(&io, path, c);
    is_known = hf_store_close_result(&io) == HF_OK && is_known;
    if (is_known && c->optimize.n_limit) {
        hf_json_open_line(j, "", "limits", '[');
        for (int k = 0; k < c->optimize.n_limit; k++)
            write_limit(&c->optimize.limit[k], j);
        hf_json_close(j, ']');
    }
    hf_case_free(c);
    free(c);
}
