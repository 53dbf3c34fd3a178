/* Writes and reads the statistics of the as-built samples in the group /tolerance, by tables of fields. */
#include "store/layout.h"

#include <string.h>

#define GROUP "/tolerance"
enum { WORD_SIZE = 32 };

/* ---- tables ---- */

/* A measure as the data sets have it. Rows are found by their words, because other versions have other measures. */
typedef struct {
    char word[WORD_SIZE];
    double is_measured;
    hf_tolerance_figures figures;
} measured;

#define MEASURED(name, member, kind, description) HF_LAYOUT_MEMBER(measured, name, member, kind, "", description)
#define QUANTILE(name, member, description)                                                                            \
    HF_LAYOUT_STRIDED(measured, name, figures.member[0], REAL, "", description, sizeof(measured),                      \
                      HF_TOLERANCE_QUANTILES)
static const hf_layout_field measured_field[] = {
    MEASURED("measure", word, CHARS, "what the rows of the figures describe") MEASURED(
        "is_measured", is_measured, REAL, "1: of the samples; 0: not in this case")
        MEASURED("mean", figures.mean, REAL, "over the samples that have a value") MEASURED(
            "mean_low", figures.mean_low, REAL, "95 % interval of the mean: its lower end")
            MEASURED("mean_high", figures.mean_high, REAL, "95 % interval of the mean: its upper end") MEASURED(
                "deviation", figures.deviation, REAL, "standard deviation")
                MEASURED("min", figures.min, REAL, "minimum") MEASURED("max", figures.max, REAL, "maximum") QUANTILE(
                    "quantile", value,
                    "what 50, 95 and 99 % of all samples do not exceed (of tension_min_N: do not fall below); "
                    "infinite: fewer have a value")
                    QUANTILE("quantile_low", low,
                             "95 % interval of each, by order statistics: its lower end; NaN: too few samples")
                        QUANTILE("quantile_high", high,
                                 "95 % interval of each, by order statistics: its upper end; NaN: too few samples")};

#define SHARE(name, member, kind, description)                                                                         \
    HF_LAYOUT_FIELD(hf_tolerance_summary, name, member, kind, "", description)
static const hf_layout_field ranked_field[] = {
    SHARE("ranked_cable", ranked_id, CHARS, "cables with the largest shares")
        SHARE("ranked_share", ranked_share, REAL, "share of their own errors in the growth of psi^2, to first order")};
static const hf_layout_field kind_field[] = {
    SHARE("kind_share", kind_share, REAL, "the same share of each kind of errors, see error_kind")};
static const hf_layout_field bin_field[] = {
    SHARE("histogram", bin, REAL, "share of the samples whose psi is in each of equal intervals")};

static void pass_shares(hf_hdf5 *io, bool writes, hid_t group, int n_kind, hf_tolerance_summary *s)
{
    hf_layout_pass_fields(io, writes, group, HF_LAYOUT_TABLE(ranked_field), s->n_ranked, 0, s);
    hf_layout_pass_fields(io, writes, group, HF_LAYOUT_TABLE(kind_field), n_kind, 0, s);
    hf_layout_pass_fields(io, writes, group, HF_LAYOUT_TABLE(bin_field), HF_TOLERANCE_BINS, 0, s);
}

/* ---- writing ---- */

void hf_layout_put_tolerance(hf_hdf5 *io, const hf_summary *summary)
{
    hf_tolerance_summary *s = summary->tolerance;
    measured figures[HF_TOLERANCE_N_MEASURE] = {{{0}, 0, {0}}};
    char kind[HF_TOLERANCE_KINDS][WORD_SIZE] = {{0}};
    if (!s) return;
    for (int k = 0; k < HF_TOLERANCE_N_MEASURE; k++) {
        figures[k].is_measured = s->figure[k].is_measured;
        figures[k].figures = s->figure[k];
        strncpy(figures[k].word, hf_tolerance_measure_word[k], WORD_SIZE - 1);
    }
    for (int k = 0; k < HF_TOLERANCE_KINDS; k++)
        strncpy(kind[k], hf_tolerance_kind_word[k], WORD_SIZE - 1);
    hid_t group = hf_hdf5_make_group(io, GROUP);
    const hf_hdf5_array kinds = {"error_kind", HF_KIND_CHARS,    1, {HF_TOLERANCE_KINDS, WORD_SIZE},
                                 "",           "kinds of errors"};
    hf_layout_pass_fields(io, true, group, HF_LAYOUT_TABLE(measured_field), HF_TOLERANCE_N_MEASURE, 0, figures);
    hf_hdf5_write_array(io, group, &kinds, kind);
    pass_shares(io, true, group, HF_TOLERANCE_KINDS, s);
    hf_hdf5_close(io, group);
    hf_layout_pass_part(io, true, HF_LAYOUT_TOLERANCE, summary);
}

/* ---- reading ---- */

/* Returns the measure of a stored word, also one of an earlier version, or HF_TOLERANCE_N_MEASURE. */
static hf_tolerance_measure measure_of(char word[WORD_SIZE])
{
    char now[2 * WORD_SIZE];
    hf_tolerance_measure measure = 0;
    word[WORD_SIZE - 1] = '\0';
    hf_renamed_figure(word, now, sizeof now);
    while (measure < HF_TOLERANCE_N_MEASURE && strcmp(hf_tolerance_measure_word[measure], word) != 0 &&
           strcmp(hf_tolerance_measure_word[measure], now) != 0)
        measure++;
    return measure;
}

/* Copies n measures into the summary. Version 0.1 had one loss, gain_loss_dB, after the best fit to the facets or, if
 * there were none, to the nodes. */
static void take_measures(int n, measured *stored, hf_tolerance_summary *s)
{
    bool has_losses = false, has_facets = false;
    for (int k = 0; k < n; k++) {
        hf_tolerance_measure measure = measure_of(stored[k].word);
        has_losses |= measure == HF_TOLERANCE_FIT_GAIN_LOSS;
        has_facets |= measure == HF_TOLERANCE_FACET_FIT_HALF_PATH && stored[k].is_measured == 1;
    }
    for (int k = 0; k < n; k++) {
        hf_tolerance_measure measure = measure_of(stored[k].word);
        if (measure == HF_TOLERANCE_GAIN_LOSS && !has_losses)
            measure = has_facets ? HF_TOLERANCE_FACET_FIT_GAIN_LOSS : HF_TOLERANCE_FIT_GAIN_LOSS;
        if (measure == HF_TOLERANCE_N_MEASURE) continue;
        s->figure[measure] = stored[k].figures;
        s->figure[measure].is_measured = stored[k].is_measured == 1;
    }
}

void hf_layout_get_tolerance(hf_hdf5 *io, hf_summary *summary)
{
    measured figures[HF_TOLERANCE_N_MEASURE] = {{{0}, 0, {0}}};
    if (!hf_hdf5_has(io, io->file, GROUP "/histogram")) return; /* the last data set that is written */
    hf_tolerance_summary *s = summary->tolerance = hf_hdf5_take(io, 1, sizeof *s);
    if (!s) return;
    hid_t group = hf_hdf5_open_group(io, GROUP);
    int n = hf_hdf5_length(io, group, "measure", HF_TOLERANCE_N_MEASURE);
    hf_layout_pass_fields(io, false, group, HF_LAYOUT_TABLE(measured_field), n, 0, figures);
    if (io->status == HF_OK) take_measures(n, figures, s);
    bool is_ranked = hf_hdf5_has(io, group, "ranked_share");
    s->n_ranked = is_ranked ? hf_hdf5_length(io, group, "ranked_share", HF_TOLERANCE_RANKED) : 0;
    /* Version 0.1 had fewer kinds. */
    pass_shares(io, false, group, hf_hdf5_length(io, group, "kind_share", HF_TOLERANCE_KINDS), s);
    for (int k = 0; k < s->n_ranked; k++)
        s->ranked_id[k][HF_TOLERANCE_ID_SIZE - 1] = '\0';
    hf_hdf5_close(io, group);
    hf_layout_pass_part(io, false, HF_LAYOUT_TOLERANCE, summary);
}
