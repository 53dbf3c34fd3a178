/* Prints the verdicts on the rows of `requirements`, worst first. */
#include "out/print_summary.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TIGHTEST_SHOWN 5 /* rows shown besides those that are not passed */
#define CELL 128

/* Returns the order of the verdicts in the table: failed rows, undecided ones, passed ones. */
static int rank_of(hf_verdict verdict)
{
    static const int rank[HF_VERDICT_N] = {[HF_VERDICT_UNDECIDED] = 1, [HF_VERDICT_PASS] = 2};
    return rank[verdict];
}

/* Returns the relative margin, by which rows of different figures are compared. A row without one comes last. */
static double tightness(const hf_requirement_verdict *v)
{
    return isnan(v->relative_margin) ? (double)INFINITY : v->relative_margin;
}

static int compare_rows(const void *a, const void *b)
{
    const hf_requirement_verdict *p = *(const hf_requirement_verdict *const *)a,
                                 *q = *(const hf_requirement_verdict *const *)b;
    int by_verdict = rank_of(p->verdict) - rank_of(q->verdict);
    if (by_verdict) return by_verdict;
    if (tightness(p) != tightness(q)) return tightness(p) < tightness(q) ? -1 : 1;
    return p < q ? -1 : 1; /* in the order of the case */
}

/* Formats a value with its unit for people: "0.6142 mm", "4.974 N", "2". */
static const char *value_text(const char *unit, double value, char text[CELL])
{
    double times = hf_print_scale(unit, &unit);
    if (isfinite(value))
        snprintf(text, CELL, "%.4g%s%s", times * value, *unit ? " " : "", unit);
    else
        snprintf(text, CELL, "%s", isnan(value) ? "-" : "infinite");
    return text;
}

const char *hf_print_bound(const char *unit, double at_least, double at_most, char text[HF_PRINT_BOUND_SIZE])
{
    char low[CELL], high[CELL];
    value_text(unit, at_least, low);
    value_text(unit, at_most, high);
    if (isnan(at_most))
        snprintf(text, HF_PRINT_BOUND_SIZE, "at least %.40s", low);
    else if (isnan(at_least))
        snprintf(text, HF_PRINT_BOUND_SIZE, "at most %.40s", high);
    else
        snprintf(text, HF_PRINT_BOUND_SIZE, "%.*s to %.30s", (int)strcspn(low, " "), low, high);
    return text;
}

static const char *unit_of(const hf_requirement_verdict *v)
{
    return hf_required_figure_unit[v->row.figure];
}

static void print_margin_of(const hf_requirement_verdict *v, char text[CELL])
{
    char margin[CELL];
    value_text(unit_of(v), v->margin, margin);
    if (!isfinite(v->margin)) /* a shape without the figure, such as a pattern without a beam */
        snprintf(text, CELL, "none: the figure has no value");
    else if (isfinite(v->relative_margin))
        snprintf(text, CELL, "%s%.60s (%+.3g %%)", v->margin >= 0 ? "+" : "", margin, 100 * v->relative_margin);
    else
        snprintf(text, CELL, "%s%.60s", v->margin >= 0 ? "+" : "", margin);
}

/* Prints which samples meet the row, or the numerical error of a nominal value that decides nothing. */
static void print_evidence(const hf_requirement_verdict *v, FILE *f)
{
    char error[CELL];
    if (isfinite(v->yield))
        fprintf(f, "; %.4g %% of samples meet it (%.4g to %.4g %%)", 100 * v->yield, 100 * v->yield_low,
                100 * v->yield_high);
    else if (v->verdict == HF_VERDICT_UNDECIDED)
        fprintf(f, "; the value is certified to %s only", value_text(unit_of(v), v->error_bound, error));
}

static void print_worst(const hf_requirement_verdict *v, FILE *f)
{
    char value[CELL];
    bool is_sample = v->worst_sample >= 0, has_case = strcmp(v->row.load_case, v->worst_load_case) != 0;
    bool is_alike = is_sample && v->verdict == HF_VERDICT_PASS && v->worst_value == 0; /* no sample has slack cables */
    if (is_alike || (!is_sample && !*v->worst_item && !has_case)) return;
    fprintf(f, "; worst: ");
    if (is_sample) fprintf(f, "%s in sample %ld", value_text(unit_of(v), v->worst_value, value), v->worst_sample);
    if (*v->worst_item) fprintf(f, "%s%s", is_sample ? ", " : "", v->worst_item);
    if (has_case) fprintf(f, "%s%s", is_sample || *v->worst_item ? ", " : "", v->worst_load_case);
}

static void print_row(const hf_requirement_verdict *v, int width, FILE *f)
{
    char name[256], shown[512], bound[HF_PRINT_BOUND_SIZE], margin[CELL], value[CELL];
    hf_text_escape(hf_requirement_name(&v->row, name, sizeof name), shown, sizeof shown);
    hf_print_bound(unit_of(v), v->row.at_least, v->row.at_most, bound);
    print_margin_of(v, margin);
    fprintf(f, "  %-12s  %-*s  %11s  %-18s  margin %s", hf_verdict_word[v->verdict], width, shown,
            value_text(unit_of(v), v->value, value), bound, margin);
    print_evidence(v, f);
    print_worst(v, f);
    fputc('\n', f);
}

/* Begins the line of a verdict with its colour. */
static void begin_verdict(hf_verdict verdict, hf_print_style style, FILE *f)
{
    const char *colour = verdict == HF_VERDICT_FAIL        ? HF_PRINT_RED
                         : verdict == HF_VERDICT_UNDECIDED ? HF_PRINT_YELLOW
                                                           : "";
    if (style.has_colour) fprintf(f, "%s%s", HF_PRINT_BOLD, colour);
}

/* Prints the verdict on a front: that of the point that ranks first. */
static void print_front(const hf_summary *s, hf_print_style style, FILE *f)
{
    const hf_front_table *t = s->front;
    hf_judgement first = hf_summary_judge(s);
    hf_verdict verdict = hf_judgement_verdict(&first);
    begin_verdict(verdict, style, f);
    fprintf(f, "verdict: %s; %d of %d points of the front pass, %d fail", hf_verdict_word[verdict],
            t->n_verdict[HF_VERDICT_PASS], t->n_point, t->n_verdict[HF_VERDICT_FAIL]);
    if (t->n_verdict[HF_VERDICT_UNDECIDED]) fprintf(f, ", %d undecided", t->n_verdict[HF_VERDICT_UNDECIDED]);
    fprintf(f, "; point %d ranks first", hf_front_suggested(t));
    fputs(style.has_colour ? HF_PRINT_PLAIN "\n" : "\n", f);
}

void hf_print_requirements(const hf_summary *s, hf_print_style style, FILE *f)
{
    const hf_requirement_verdict *row[HF_REQUIREMENT_ROWS_MAX];
    int n = s->n_requirement, width = 0, n_shown = 0;
    hf_judgement of = hf_requirements_judge(n, s->requirement);
    hf_verdict all = hf_judgement_verdict(&of);
    bool is_front = s->front && hf_front_is_judged(s->front), is_form = s->front || s->status == HF_NO_FEASIBLE;
    char name[256];
    if (n == 0) return;
    if (is_front) print_front(s, style, f);
    if (is_front && !style.verbose) return;
    for (int i = 0; i < n; i++)
        row[i] = &s->requirement[i];
    qsort(row, (size_t)n, sizeof *row, compare_rows);
    n_shown = style.verbose ? n : of.n_failed + of.n_undecided + TIGHTEST_SHOWN;
    if (n_shown > n) n_shown = n;
    for (int i = 0; i < n_shown; i++) {
        int length = (int)strlen(hf_requirement_name(&row[i]->row, name, sizeof name));
        if (length > width) width = length;
    }
    if (!is_front) begin_verdict(all, style, f);
    fprintf(f, "%s%s; %d of %d requirements pass",
            is_front ? "  net after form-finding: " : "verdict: ", hf_verdict_word[all],
            of.n_required - of.n_failed - of.n_undecided, of.n_required);
    if (of.n_failed) fprintf(f, ", %d fail%s", of.n_failed, of.n_failed == 1 ? "s" : "");
    if (of.n_undecided) fprintf(f, ", %d undecided", of.n_undecided);
    if (is_form && !is_front) fputs("; of the net after form-finding", f);
    fputs(style.has_colour && !is_front ? HF_PRINT_PLAIN "\n" : "\n", f);
    for (int i = 0; i < n_shown; i++)
        print_row(row[i], width, f);
    if (n_shown < n)
        fprintf(f, "                %d more row%s: --verbose shows them\n", n - n_shown, n - n_shown == 1 ? "" : "s");
}
