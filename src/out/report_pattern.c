/* Writes the far field of a shape as JSON, thinned to what a screen can show. */
#include "out/report_pattern.h"

#include "base/json.h"

#include <math.h>
#include <string.h>

#define ANGLES_MAX 1000  /* angles of a cut on the page, about what a screen can show */
#define GAINS_MAX 100000 /* gains of all cuts of a shape, about 600 kB */

static double highest(const double *value, int n)
{
    double most = -(double)INFINITY;
    for (int i = 0; i < n; i++)
        most = fmax(most, value[i]);
    return most;
}

/* Returns the number of neighbouring angles that share a point. */
static int stride_of(const hf_pattern_table *t)
{
    int most = GAINS_MAX / (t->n_frequency * t->n_cut);
    if (most > ANGLES_MAX) most = ANGLES_MAX;
    return (t->n_theta + most - 1) / most;
}

/* Writes one cut. The maximum of each few neighbours is kept, because a sidelobe can lie between two of the angles that
 * remain. */
static void write_cut(const hf_pattern_table *t, int k, const hf_cut_figures *c, FILE *f)
{
    hf_json j = {.file = f};
    const double *co_dBi = t->co_dBi + (size_t)k * (size_t)t->n_theta;
    int stride = stride_of(t), i_cut = k % t->n_cut;
    double cross_dBi = highest(t->cross_dBi + (size_t)k * (size_t)t->n_theta, t->n_theta);
    hf_json_open(&j, NULL, '{');
    hf_json_number(&j, "frequency_Hz", t->frequency_Hz[k / t->n_cut]);
    hf_json_number(&j, "phi_deg", t->phi_deg[i_cut]);
    hf_json_number(&j, "gain_dBi", c->gain_dBi);
    hf_json_number(&j, "beam_deg", c->beam_deg);
    hf_json_number(&j, "half_power_width_deg", c->half_power_width_deg);
    hf_json_number(&j, "first_sidelobe_dB", c->first_sidelobe_dB);
    hf_json_number(&j, "highest_sidelobe_dB", c->highest_sidelobe_dB);
    hf_json_number(&j, "cross_dB", cross_dBi - c->gain_dBi);
    fputs(",\"co_dBi\":[", f);
    for (int i = 0; i < t->n_theta; i += stride) {
        if (i) fputc(',', f);
        hf_json_value(highest(co_dBi + i, t->n_theta - i < stride ? t->n_theta - i : stride), 5, f);
    }
    fputc(']', f);
    hf_json_close(&j, '}');
}

void hf_report_pattern_write(const char *stage, const hf_pattern_summary *s, const hf_pattern_table *t, FILE *f)
{
    hf_json j = {.file = f};
    int stride = stride_of(t);
    hf_json_open(&j, NULL, '{');
    hf_json_text(&j, "stage", stage);
    hf_json_text(&j, "feed", hf_feed_word[s->feed.kind]);
    hf_json_number(&j, "cos_power", s->feed.cos_power);
    hf_json_integer(&j, "angles", t->n_theta);
    hf_json_integer(&j, "stride", stride);
    fputs(",\"theta_deg\":[", f);
    for (int i = 0; i < t->n_theta; i += stride) {
        int last = i + stride < t->n_theta ? i + stride - 1 : t->n_theta - 1;
        if (i) fputc(',', f);
        hf_json_value((t->theta_deg[i] + t->theta_deg[last]) / 2, 7, f);
    }
    fputs("],\n\"cut\":[", f);
    for (int k = 0; k < t->n_frequency * t->n_cut; k++) {
        if (k) fputs(",\n", f);
        write_cut(t, k, &s->figure[k], f);
    }
    fputc(']', f);
    hf_json_close(&j, '}');
}
