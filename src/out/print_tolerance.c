#include "out/print_tolerance.h"

#include <math.h>
#include <string.h>

#define CABLES_TOLD 3

/* Lengths are told in mm, counts and tensions as they are. */
static double unit_of(int measure, const char **word)
{
    bool is_length = !strcmp(hf_tolerance_measure_unit[measure], "m");
    *word = is_length ? "mm" : hf_tolerance_measure_unit[measure];
    return is_length ? 1e3 : 1;
}

static void print_measure(const hf_tolerance_figures *f, int measure, FILE *file)
{
    const char *unit, *name = hf_tolerance_measure_word[measure];
    double times = unit_of(measure, &unit);
    if (!f->is_measured) return;
    const char *holds = hf_tolerance_more_is_better((hf_tolerance_measure)measure) ? "at least" : "at most";
    fprintf(file, "                %s: mean %.4g, in 50/95/99 %% %s %.4g/%.4g/%.4g", name, times * f->mean, holds,
            times * f->value[0], times * f->value[1], times * f->value[2]);
    if (*unit) fprintf(file, " %s", unit);
    if (isfinite(f->low[1]) && isfinite(f->high[1]))
        fprintf(file, " (95 %%: %.4g to %.4g)", times * f->low[1], times * f->high[1]);
    fputc('\n', file);
}

static void print_first_order(const hf_tolerance_summary *t, FILE *f)
{
    fprintf(f, "                root of mean psi^2: %.4f mm to first order, %.4f mm of the samples",
            t->first_order_rms_psi_m * 1e3, t->rms_psi_m * 1e3);
    if (isfinite(t->controlled_high_m - t->controlled_low_m))
        fprintf(f, ", %.4f to %.4f mm with first order as control", t->controlled_low_m * 1e3,
                t->controlled_high_m * 1e3);
    fprintf(f, " (correlation %.3f)\n", t->correlation);
}

static void print_yield(const hf_tolerance_summary *t, FILE *f)
{
    if (t->n_require == 0) return;
    fprintf(f, "                yield %.2f %% (%.2f to %.2f %%)", 100 * t->yield, 100 * t->yield_low,
            100 * t->yield_high);
    for (int k = 0; k < t->n_require; k++) {
        fprintf(f, "%s %s", k ? "," : ":", hf_tolerance_measure_word[t->require[k].measure]);
        if (!isnan(t->require[k].at_most)) fprintf(f, " at most %g", t->require[k].at_most);
        if (!isnan(t->require[k].at_least)) fprintf(f, " at least %g", t->require[k].at_least);
        fprintf(f, " %.2f %%", 100 * t->require_yield[k]);
    }
    fputc('\n', f);
    if (isnan(t->wanted_yield)) return;
    if (t->sigma_scale == 0)
        fprintf(f, "                a yield of %g %% is out of reach: the net without errors does not meet it\n",
                100 * t->wanted_yield);
    else
        fprintf(f, "                a yield of %g %% takes errors of %.3g of these (by %d samples)\n",
                100 * t->wanted_yield, t->sigma_scale, t->scale_samples);
}

static void print_shares(const hf_tolerance_summary *t, FILE *f)
{
    char line[1200] = "";
    for (int k = 0; k < t->n_ranked && k < CABLES_TOLD; k++) {
        size_t used = strlen(line);
        snprintf(line + used, sizeof line - used, "%s%s %.2g %%", k ? ", " : "", t->ranked_id[k],
                 100 * t->ranked_share[k]);
    }
    if (*line) hf_print_line(f, "                cables with the largest shares in it: %s", line);
}

void hf_print_tolerance(const hf_tolerance_summary *t, FILE *f)
{
    char wall[32];
    hf_print_duration(t->tolerance_wall_s, wall, sizeof wall);
    fprintf(f, "  as built      psi at most %.4f mm in 95 %% of %d nets, %.4f mm without errors; ", t->psi_95_m * 1e3,
            t->samples, t->nominal_psi_m * 1e3);
    fprintf(f, "%d with slack cables, %d with loose nodes, %d without a shape; %s\n", t->n_with_slack, t->n_with_loose,
            t->n_failed, wall);
    for (int k = 0; k < HF_TOLERANCE_N_MEASURE; k++)
        if (k < HF_TOLERANCE_SLACK) print_measure(&t->figure[k], k, f);
    print_first_order(t, f);
    print_yield(t, f);
    print_shares(t, f);
}
