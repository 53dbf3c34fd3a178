/* Prints the figures of a tolerance analysis. */
#include "out/print_summary.h"
#include "base/text.h"

#include <math.h>

#define CABLES_SHOWN 3

/* Prints numbers as "1/2/3", with "-" for those that are unknown or infinite. */
static void print_numbers(FILE *file, int n, const double *value, double times)
{
    for (int i = 0; i < n; i++) {
        if (i > 0) fputc('/', file);
        if (isfinite(value[i]))
            fprintf(file, "%.4g", times * value[i]);
        else
            fputc('-', file);
    }
}

/* Prints a length in mm. Values below 1e-5 m have three significant digits; those below 1e-9 m are rounding and print
 * as 0.0000. */
static void print_mm(FILE *file, double value_m)
{
    if (value_m >= 1e-9 && value_m < 1e-5)
        fprintf(file, "%.3g mm", value_m * 1e3);
    else if (isfinite(value_m))
        fprintf(file, "%.4f mm", value_m * 1e3);
    else
        fputc('-', file);
}

/* Returns whether a measure is a gain loss by Ruze's formula, without the weights of the illumination. */
static bool is_ruze(int measure)
{
    return measure == HF_TOLERANCE_GAIN_LOSS || measure == HF_TOLERANCE_FIT_GAIN_LOSS ||
           measure == HF_TOLERANCE_FACET_GAIN_LOSS || measure == HF_TOLERANCE_FACET_FIT_GAIN_LOSS;
}

static void print_measure(const hf_tolerance_figures *f, int measure, FILE *file)
{
    const char *unit;
    double times = hf_print_scale(hf_tolerance_measure_unit[measure], &unit);
    if (!f->is_measured) return;
    const char *holds = hf_tolerance_more_is_better((hf_tolerance_measure)measure) ? "at least" : "at most";
    fprintf(file, "                %s%s: mean ", hf_tolerance_measure_word[measure], is_ruze(measure) ? " (Ruze)" : "");
    print_numbers(file, 1, &f->mean, times);
    fprintf(file, "; 50/95/99 %% of the samples have %s ", holds);
    print_numbers(file, HF_TOLERANCE_QUANTILES, f->value, times);
    if (*unit) fprintf(file, " %s", unit);
    if (isfinite(f->low[1]) && isfinite(f->high[1]))
        fprintf(file, " (at 95 %%: %.4g to %.4g)", times * f->low[1], times * f->high[1]);
    fputc('\n', file);
}

/* Smallest correlation at which the linear psi is used as control variate. */
#define LEAST_CORRELATION 0.5

static void print_first_order(const hf_tolerance_summary *t, FILE *f)
{
    fputs("                RMS of psi: ", f);
    print_mm(f, t->first_order_rms_psi_m);
    fputs(" to first order, ", f);
    print_mm(f, t->rms_psi_m);
    fputs(t->n_failed ? " over the samples with a shape" : " over the samples", f);
    if (isfinite(t->controlled_high_m - t->controlled_low_m) && t->correlation >= LEAST_CORRELATION)
        fprintf(f, ", %.4f to %.4f mm with first order as control variate", t->controlled_low_m * 1e3,
                t->controlled_high_m * 1e3);
    if (isfinite(t->correlation)) fprintf(f, " (correlation %.3f)", t->correlation);
    fputc('\n', f);
}

/* Prints the yield, and on the same line by how much all errors could be larger, or must be smaller. */
static void print_yield(const hf_tolerance_summary *t, FILE *f)
{
    const char *bound = t->scale_bound > 0 ? "at least " : t->scale_bound < 0 ? "less than " : "";
    const char *lead = isfinite(t->yield) ? "; " : "                ";
    if (isfinite(t->yield))
        fprintf(
            f,
            "                yield %.2f %% (95 %% interval %.2f to %.2f %%): samples that meet all rows with a share",
            100 * t->yield, 100 * t->yield_low, 100 * t->yield_high);
    if (t->sigma_scale == 0)
        fprintf(f, "%sno errors are small enough for the required shares, because the net without errors fails", lead);
    else if (t->sigma_scale < 1)
        fprintf(f, "%sfor the required shares, reduce all errors to %s%.4g %% (from %d samples)", lead, bound,
                100 * t->sigma_scale, t->scale_samples);
    else if (t->sigma_scale >= 1)
        fprintf(f, "%sthe required shares hold up to %s%.4g times these errors (from %d samples)", lead, bound,
                t->sigma_scale, t->scale_samples);
    if (isfinite(t->yield) || isfinite(t->sigma_scale)) fputc('\n', f);
}

static void print_shares(const hf_tolerance_summary *t, FILE *f)
{
    char line[1200] = "", item[400];
    for (int k = 0; k < t->n_ranked && k < CABLES_SHOWN; k++) {
        double percent = 100 * t->ranked_share[k];
        snprintf(item, sizeof item, percent < 99.5 ? "%s %.2g %%" : "%s %.0f %%", t->ranked_id[k], percent);
        hf_text_append(line, sizeof line, ", ", item, "");
    }
    if (*line) hf_print_line(f, "                cables that contribute most to the variance of psi: %s", line);
}

void hf_print_tolerance(const hf_summary *s, hf_print_amount amount, FILE *f)
{
    const hf_tolerance_summary *t = s->tolerance;
    fprintf(f, "  as built      %s", s->n_load_case ? "nominal load case: " : "");
    if (isinf(t->psi_95_m))
        fprintf(f, "fewer than 95 %% of %d samples have a shape; psi ", t->samples);
    else {
        fputs("psi at most ", f);
        print_mm(f, t->psi_95_m);
        fprintf(f, " in 95 %% of %d samples, ", t->samples);
    }
    print_mm(f, t->nominal_psi_m);
    fprintf(f, " without errors; %d with slack cables, %d with loose nodes, %d without a shape; ", t->n_with_slack,
            t->n_with_loose, t->n_failed);
    if (t->n_sampled_load_case)
        fprintf(f, "in any of %d load cases: %d with slack cables, %d without a shape; ", 1 + t->n_sampled_load_case,
                t->n_with_slack_in_any, t->n_failed_in_any);
    fprintf(f, "%s\n", hf_print_duration(t->tolerance_wall_s).text);
    bool has_optics = hf_print_highest_optics(s, &s->stage[HF_STAGE_FORM].surface) >= 0;
    for (int k = 0; amount == HF_PRINT_VERBOSE && k < HF_TOLERANCE_SLACK; k++)
        if (!is_ruze(k) || !has_optics) print_measure(&t->figure[k], k, f);
    if (amount == HF_PRINT_VERBOSE) print_first_order(t, f);
    print_yield(t, f);
    if (amount != HF_PRINT_SHORT) print_shares(t, f);
}
