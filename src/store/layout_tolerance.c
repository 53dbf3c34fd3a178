/* Writes and reads the statistics in the group /tolerance. The functions pass_... list the data sets once. With
 * put_values they write, with get_values they read. */
#include "store/layout.h"

#include <string.h>

#define GROUP "/tolerance"

enum { WORD_SIZE = 32, N_PLAIN = 7, N_QUANTILE = 3 };

/* The statistics of all measures in arrays, as the data sets have them. */
typedef struct {
    char measure[HF_TOLERANCE_N_MEASURE][WORD_SIZE];
    double plain[N_PLAIN][HF_TOLERANCE_N_MEASURE];
    double quantile[N_QUANTILE][HF_TOLERANCE_N_MEASURE][HF_TOLERANCE_QUANTILES];
} figures;

static const char *const plain_name[N_PLAIN][2] = {{"is_measured", "1: of the samples; 0: not in this case"},
                                                   {"mean", "over the samples that have a value"},
                                                   {"mean_low", "95 % interval of the mean"},
                                                   {"mean_high", "the same"},
                                                   {"deviation", "standard deviation"},
                                                   {"least", "smallest value"},
                                                   {"largest", "largest value"}};
static const char *const quantile_name[N_QUANTILE][2] = {
    {"quantile", "what 50, 95 and 99 % of all samples do not exceed (of least_tension_N: do not fall below); infinite: "
                 "fewer have a "
                 "value"},
    {"quantile_low", "95 % interval of each, by order statistics; NaN: too few samples"},
    {"quantile_high", "the same"}};

static void gather(const hf_tolerance_summary *s, figures *f)
{
    memset(f, 0, sizeof *f);
    for (int k = 0; k < HF_TOLERANCE_N_MEASURE; k++) {
        const hf_tolerance_figures *of = &s->figure[k];
        const double value[N_PLAIN] = {of->is_measured, of->mean, of->mean_low, of->mean_high,
                                       of->deviation,   of->min,  of->max};
        strncpy(f->measure[k], hf_tolerance_measure_word[k], WORD_SIZE - 1);
        for (int i = 0; i < N_PLAIN; i++)
            f->plain[i][k] = value[i];
        memcpy(f->quantile[0][k], of->value, sizeof of->value);
        memcpy(f->quantile[1][k], of->low, sizeof of->low);
        memcpy(f->quantile[2][k], of->high, sizeof of->high);
    }
}

/* Returns the row of a measure among n, or -1. */
static int row_of(int n, const figures *f, hf_tolerance_measure measure)
{
    for (int k = 0; k < n; k++)
        if (strncmp(hf_tolerance_measure_word[measure], f->measure[k], WORD_SIZE) == 0) return k;
    return -1;
}

/* Returns the measure that files of earlier versions call gain_loss_dB. They have only one loss. */
static hf_tolerance_measure loss_of_before(int n, const figures *f)
{
    int facets = row_of(n, f, HF_TOLERANCE_FACET_FIT_HALF_PATH);
    return facets >= 0 && f->plain[0][facets] == 1 ? HF_TOLERANCE_FACET_FIT_GAIN_LOSS : HF_TOLERANCE_FIT_GAIN_LOSS;
}

/* Copies n rows of figures into the summary. Files of earlier versions have fewer rows. */
static void scatter(int n, const figures *f, hf_tolerance_summary *s)
{
    bool has_losses = row_of(n, f, HF_TOLERANCE_FIT_GAIN_LOSS) >= 0;
    for (hf_tolerance_measure measure = 0; measure < HF_TOLERANCE_N_MEASURE; measure++) {
        int k = row_of(n, f, measure);
        if (k < 0) continue;
        bool is_old = measure == HF_TOLERANCE_GAIN_LOSS && !has_losses;
        hf_tolerance_figures *of = &s->figure[is_old ? loss_of_before(n, f) : measure];
        double *const value[N_PLAIN] = {NULL,           &of->mean, &of->mean_low, &of->mean_high,
                                        &of->deviation, &of->min,  &of->max};
        of->is_measured = f->plain[0][k] == 1;
        for (int i = 1; i < N_PLAIN; i++)
            *value[i] = f->plain[i][k];
        memcpy(of->value, f->quantile[0][k], sizeof of->value);
        memcpy(of->low, f->quantile[1][k], sizeof of->low);
        memcpy(of->high, f->quantile[2][k], sizeof of->high);
    }
}

/* Describes an array of numbers for writing or reading. */
static hf_hdf5_array numbers(const char *name, int n, const char *units, const char *description)
{
    return (hf_hdf5_array){name, HF_KIND_REAL, 1, {(hsize_t)n}, units, description};
}

static hf_hdf5_array words(const char *name, int n, int size, const char *description)
{
    return (hf_hdf5_array){name, HF_KIND_CHARS, 1, {(hsize_t)n, (hsize_t)size}, "", description};
}

typedef void pass(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, void *values);

static void put_values(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, void *values)
{
    hf_hdf5_write_array(io, group, array, values);
}

static void get_values(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, void *values)
{
    hf_hdf5_read_array(io, group, array, values);
}

static void pass_figures(hf_hdf5 *io, hid_t group, pass *with, int n, figures *f)
{
    hf_hdf5_array array = words("measure", n, WORD_SIZE, "what rows of the figures are of");
    with(io, group, &array, f->measure);
    for (int i = 0; i < N_PLAIN; i++) {
        array = numbers(plain_name[i][0], n, "", plain_name[i][1]);
        with(io, group, &array, f->plain[i]);
    }
    for (int i = 0; i < N_QUANTILE; i++) {
        array = numbers(quantile_name[i][0], n, "", quantile_name[i][1]);
        array.rank = 2;
        array.dims[1] = HF_TOLERANCE_QUANTILES;
        with(io, group, &array, f->quantile[i]);
    }
}

/* The rows of tolerance.require in arrays. */
typedef struct {
    char measure[HF_REQUIRE_ROWS_MAX][WORD_SIZE];
    double at_most[HF_REQUIRE_ROWS_MAX], at_least[HF_REQUIRE_ROWS_MAX];
} requirements;

static void pass_requirements(hf_hdf5 *io, hid_t group, pass *with, int n, requirements *r, double *yield)
{
    hf_hdf5_array array = words("require_measure", n, WORD_SIZE, "rows of tolerance.require");
    with(io, group, &array, r->measure);
    array = numbers("require_at_most", n, "", "NaN: no such limit");
    with(io, group, &array, r->at_most);
    array = numbers("require_at_least", n, "", "the same");
    with(io, group, &array, r->at_least);
    array = numbers("require_yield", n, "", "part of the samples that meets this row");
    with(io, group, &array, yield);
}

static void pass_shares(hf_hdf5 *io, hid_t group, pass *with, int n_kind, hf_tolerance_summary *s)
{
    hf_hdf5_array array = words("ranked_cable", s->n_ranked, HF_TOLERANCE_ID_SIZE, "cables with the largest shares");
    if (s->n_ranked > 0) with(io, group, &array, s->ranked_id);
    array = numbers("ranked_share", s->n_ranked, "", "of their own errors in what psi^2 gains, to first order");
    if (s->n_ranked > 0) with(io, group, &array, s->ranked_share);
    array = numbers("kind_share", n_kind, "", "the same of each kind of errors, see error_kind");
    with(io, group, &array, s->kind_share);
    array = numbers("histogram", HF_TOLERANCE_BINS, "", "part of the samples whose psi is in each of equal intervals");
    with(io, group, &array, s->bin);
}

void hf_layout_put_tolerance(hf_hdf5 *io, const hf_summary *summary)
{
    if (!summary->has_tolerance) return;
    hf_tolerance_summary s = summary->tolerance;
    char kind[HF_TOLERANCE_KINDS][WORD_SIZE] = {{0}};
    requirements r = {0};
    figures f;
    hid_t group = hf_hdf5_make_group(io, GROUP);
    gather(&s, &f);
    pass_figures(io, group, put_values, HF_TOLERANCE_N_MEASURE, &f);
    for (int k = 0; k < s.n_require; k++) {
        strncpy(r.measure[k], hf_tolerance_measure_word[s.require[k].measure], WORD_SIZE - 1);
        r.at_most[k] = s.require[k].at_most;
        r.at_least[k] = s.require[k].at_least;
    }
    if (s.n_require > 0) pass_requirements(io, group, put_values, s.n_require, &r, s.require_yield);
    for (int k = 0; k < HF_TOLERANCE_KINDS; k++)
        strncpy(kind[k], hf_tolerance_kind_word[k], WORD_SIZE - 1);
    hf_hdf5_array array = words("error_kind", HF_TOLERANCE_KINDS, WORD_SIZE, "kinds of errors");
    hf_hdf5_write_array(io, group, &array, kind);
    pass_shares(io, group, put_values, HF_TOLERANCE_KINDS, &s);
    hf_hdf5_close(io, group);
    hf_layout_put_summary(io, HF_LAYOUT_TOLERANCE, summary);
}

static void find_measures(hf_hdf5 *io, hid_t group, const requirements *r, hf_tolerance_summary *s)
{
    for (int k = 0; k < s->n_require && io->status == HF_OK; k++) {
        int measure = 0;
        while (hf_tolerance_measure_word[measure] &&
               strncmp(hf_tolerance_measure_word[measure], r->measure[k], WORD_SIZE) != 0)
            measure++;
        if (!hf_tolerance_measure_word[measure])
            hf_hdf5_damaged(io, group, "require_measure", "names what is not measured");
        s->require[k] = (hf_require_settings){(hf_tolerance_measure)measure, r->at_most[k], r->at_least[k]};
    }
}

void hf_layout_get_tolerance(hf_hdf5 *io, hf_summary *summary)
{
    hf_tolerance_summary *s = &summary->tolerance;
    summary->has_tolerance = io->status == HF_OK && hf_hdf5_has(io, io->file, GROUP) &&
                             hf_hdf5_has(io, io->file, GROUP "/histogram"); /* the last data set that is written */
    if (!summary->has_tolerance) return;
    requirements r = {0};
    figures f;
    hid_t group = hf_hdf5_open_group(io, GROUP);
    int n = hf_hdf5_length(io, group, "measure", HF_TOLERANCE_N_MEASURE);
    pass_figures(io, group, get_values, n, &f);
    if (io->status == HF_OK) scatter(n, &f, s);
    if (hf_hdf5_has(io, group, "require_yield"))
        s->n_require = hf_hdf5_length(io, group, "require_yield", HF_REQUIRE_ROWS_MAX);
    if (s->n_require > 0) pass_requirements(io, group, get_values, s->n_require, &r, s->require_yield);
    find_measures(io, group, &r, s);
    if (hf_hdf5_has(io, group, "ranked_share"))
        s->n_ranked = hf_hdf5_length(io, group, "ranked_share", HF_TOLERANCE_RANKED);
    int n_kind = hf_hdf5_length(io, group, "kind_share", HF_TOLERANCE_KINDS); /* version 0.1 had fewer kinds */
    if (n_kind > 0) pass_shares(io, group, get_values, n_kind, s);
    for (int k = 0; k < s->n_ranked; k++)
        s->ranked_id[k][HF_TOLERANCE_ID_SIZE - 1] = '\0';
    hf_hdf5_close(io, group);
    hf_layout_get_summary(io, HF_LAYOUT_TOLERANCE, summary);
}
