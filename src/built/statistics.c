/* Computes the figures of a tolerance analysis from the rows of its samples (METHOD section 12):
 *
 *     pass 1      counts, sums, minimum, maximum           (add_row)
 *     pass 2      deviations, products with the linear psi (add_deviations)
 *     4 passes for each measure: its ranks, 16 bits a pass (hf_statistics_order)
 *     ---> means, quantiles and yields with their intervals, control variate, ranked cables
 *
 * Contents: rows, intervals, order, moments, all figures together. */
#include "built/statistics.h"

#include "base/arena.h"
#include "base/elementary.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#define BLOCK 1024  /* rows read at a time */
#define TAIL 0.025  /* probability beyond each end of an interval */
#define DIGIT 65536 /* values of a digit of 16 bits */
/* 97.5 % quantile of the normal distribution. */
#define NORMAL_95 1.959963984540054

/* ---- rows ---- */

/* Calls `take` for each row, in order. Returns HF_OK, HF_NO_MEMORY, or a status of rows->read. */
static hf_status visit_rows(const hf_statistics_rows *rows, void (*take)(void *context, const double *row),
                            void *context)
{
    double *row;
    void *block;
    hf_status status = HF_ARENA_ARRAYS(&block, HF_ARRAY(row, BLOCK * (size_t)rows->n_value));
    for (long first = 0; first < rows->n && status == HF_OK; first += BLOCK) {
        int n = rows->n - first < BLOCK ? (int)(rows->n - first) : BLOCK;
        status = rows->read(rows->context, first, n, row);
        for (int i = 0; i < n && status == HF_OK; i++)
            take(context, row + i * rows->n_value);
    }
    hf_arena_free_block(block);
    return status;
}

/* ---- intervals ---- */

/* Returns the continued fraction of the incomplete beta function without its factor (Abramowitz and Stegun 26.5.8, by
 * Lentz's method). It takes about sqrt(a + b) terms when x is at most about the mean, a/(a + b). */
static double beta_fraction(double x, double a, double b)
{
    enum { TERMS = 1000000 };
    double up = 1, down = 1 / (1 - (a + b) * x / (a + 1)), value = down, change = 0;
    for (int i = 1; i < TERMS && !(fabs(change - 1) < 1e-14); i++) {
        double even = i * (b - i) * x / ((a + 2 * i - 1) * (a + 2 * i));
        double odd = -(a + i) * (a + b + i) * x / ((a + 2 * i) * (a + 2 * i + 1));
        down = 1 / (1 + even * down);
        up = 1 + even / up;
        value *= down * up;
        down = 1 / (1 + odd * down);
        up = 1 + odd / up;
        change = down * up;
        value *= change;
    }
    return value;
}

/* Returns P(B <= x) of a beta distribution, to a relative error of 1e-6 for a + b up to 1e8. GSL's function fails when
 * its fraction takes more than 512 terms, and its inverse fails at a = 969, b = 32. */
static double beta_below(double x, double a, double b)
{
    if (!(x > 0) || !(x < 1)) return x >= 1;
    double factor = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log1p(-x));
    return x <= (a + 1) / (a + b + 2) ? factor / a * beta_fraction(x, a, b)
                                      : 1 - factor / b * beta_fraction(1 - x, b, a);
}

/* Returns the inverse of beta_below by bisection: the lower of the two neighbouring doubles that enclose it. */
static double beta_quantile(double probability, double a, double b)
{
    double low = 0, high = 1;
    for (double middle = 0.5; middle > low && middle < high; middle = low + (high - low) / 2)
        *(beta_below(middle, a, b) < probability ? &low : &high) = middle;
    return low;
}

/* Returns the smallest k with P(B <= k) >= probability, where B is the number of successes in n trials of probability
 * `part`. */
static long binomial_quantile(long n, double part, double probability)
{
    long low = 0, high = n;
    while (low < high) {
        long middle = low + (high - low) / 2; /* less than n */
        if (1 - beta_below(part, (double)middle + 1, (double)(n - middle)) >= probability)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* A quantile is below the value of rank k when at most k - 1 values are below the quantile. The ranks therefore follow
 * from the binomial distribution. */
void hf_statistics_ranks(long n, double part, long *low, long *high)
{
    *low = binomial_quantile(n, part, TAIL);
    *high = binomial_quantile(n, part, 1 - TAIL) + 1;
}

void hf_statistics_interval(long n, long met, double *low, double *high)
{
    double a = (double)met, b = (double)(n - met);
    *low = met > 0 ? beta_quantile(TAIL, a, b + 1) : 0;
    *high = met < n ? beta_quantile(1 - TAIL, a + 1, b) : 1;
}

/* ---- order ---- */

/* Returns a whole number whose order is that of the values. */
static uint64_t key_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits >> 63 ? ~bits : bits | 1ull << 63;
}

/* Returns the value of a key, the inverse of key_of. */
static double value_of(uint64_t key)
{
    double value;
    key = key >> 63 ? key & ~(1ull << 63) : ~key;
    memcpy(&value, &key, sizeof value);
    return value;
}

/* Holds the state of the search for ranks, digit by digit from the top. */
typedef struct {
    int column, n_rank, shift;           /* the digit in question begins at bit `shift` */
    double missing;                      /* value that replaces NaN */
    uint64_t above[HF_STATISTICS_RANKS]; /* known leading digits of each rank's value */
    long left[HF_STATISTICS_RANKS];      /* rank among the values with these digits */
    long *count;                         /* [n_rank][DIGIT] values with each digit */
} selection;

/* Counts the next digit of a row for each rank whose leading digits it has. */
static void count_digit(void *context, const double *row)
{
    selection *s = context;
    uint64_t key = key_of(isnan(row[s->column]) ? s->missing : row[s->column]),
             above = s->shift == 48 ? 0 : key >> (s->shift + 16);
    for (int k = 0; k < s->n_rank; k++)
        s->count[(size_t)k * DIGIT + (key >> s->shift & (DIGIT - 1))] += above == s->above[k];
}

/* Appends to each rank the digit that its count leads to. */
static void choose_digits(selection *s)
{
    for (int k = 0; k < s->n_rank; k++) {
        const long *count = s->count + (size_t)k * DIGIT;
        uint64_t digit = 0;
        while (digit < DIGIT - 1 && count[digit] < s->left[k])
            s->left[k] -= count[digit++];
        s->above[k] = s->above[k] << 16 | digit;
    }
}

hf_status hf_statistics_order(const hf_statistics_rows *rows, int column, double missing, int n_rank, const long *rank,
                              double *value)
{
    selection s = {.column = column, .n_rank = n_rank, .missing = missing};
    void *block;
    hf_status status = HF_ARENA_ARRAYS(&block, HF_ARRAY(s.count, (size_t)n_rank * DIGIT));
    memcpy(s.left, rank, (size_t)n_rank * sizeof *rank);
    for (s.shift = 48; s.shift >= 0 && status == HF_OK; s.shift -= 16) {
        memset(s.count, 0, (size_t)n_rank * DIGIT * sizeof *s.count);
        status = visit_rows(rows, count_digit, &s);
        choose_digits(&s);
    }
    for (int k = 0; k < n_rank; k++)
        value[k] = value_of(s.above[k]);
    hf_arena_free_block(block);
    return status;
}

/* ---- moments ---- */

/* Holds the sums over all rows. x is psi^2 of the linear model, y is psi^2 of the solved sample. */
typedef struct {
    int n_share;     /* number of rows of `requirements` with a share */
    size_t count_at; /* of the counts over all load cases in a row; 0: there are none */
    hf_tolerance_summary *to;
    long n[HF_TOLERANCE_N_MEASURE], n_both, met, bin[HF_TOLERANCE_BINS];
    double sum[HF_TOLERANCE_N_MEASURE], square[HF_TOLERANCE_N_MEASURE]; /* of values, of (value - mean)^2 */
    double mean_y, mean_x, xx, xy, yy; /* means of y and x, sums of products of deviations */
} moments;

/* Adds a row in the first pass. */
static void add_row(void *context, const double *row)
{
    moments *s = context;
    double psi = row[HF_TOLERANCE_FIRST + HF_TOLERANCE_PSI], linear = row[HF_TOLERANCE_LINEAR_PSI];
    for (int k = 0; k < HF_TOLERANCE_N_MEASURE; k++) {
        hf_tolerance_figures *f = &s->to->figure[k];
        double value = row[HF_TOLERANCE_FIRST + k];
        if (isnan(value)) continue;
        f->min = s->n[k] ? fmin(f->min, value) : value;
        f->max = s->n[k]++ ? fmax(f->max, value) : value;
        s->sum[k] += value;
    }
    if (row[HF_TOLERANCE_STATUS] != HF_OK) s->to->n_failed++;
    s->to->n_with_slack += row[HF_TOLERANCE_FIRST + HF_TOLERANCE_SLACK] > 0;
    s->to->n_with_loose += row[HF_TOLERANCE_FIRST + HF_TOLERANCE_LOOSE] > 0;
    if (s->count_at) {
        s->to->n_with_slack_in_any += row[s->count_at + HF_SAMPLE_SLACK] > 0;
        s->to->n_failed_in_any += row[s->count_at + HF_SAMPLE_WITHOUT_SHAPE] > 0;
    }
    bool meets = true;
    for (int k = 0; k < s->n_share; k++)
        meets &= row[hf_montecarlo_margin_at(k)] >= 0;
    s->met += meets;
    if (isnan(psi)) return;
    s->n_both++;
    s->mean_y += psi * psi;
    s->mean_x += linear * linear;
}

/* Adds a row in the second pass, after the means are known. */
static void add_deviations(void *context, const double *row)
{
    moments *s = context;
    const hf_tolerance_figures *psi_of = &s->to->figure[HF_TOLERANCE_PSI];
    double psi = row[HF_TOLERANCE_FIRST + HF_TOLERANCE_PSI], linear = row[HF_TOLERANCE_LINEAR_PSI];
    for (int k = 0; k < HF_TOLERANCE_N_MEASURE; k++) {
        double off = row[HF_TOLERANCE_FIRST + k] - s->to->figure[k].mean;
        if (!isnan(row[HF_TOLERANCE_FIRST + k])) s->square[k] += off * off;
    }
    if (isnan(psi)) return;
    double y = psi * psi - s->mean_y, x = linear * linear - s->mean_x;
    s->xx += x * x;
    s->xy += x * y;
    s->yy += y * y;
    double width = psi_of->max - psi_of->min, part = width > 0 ? (psi - psi_of->min) / width : 0;
    int bin = (int)(part * HF_TOLERANCE_BINS);
    s->bin[bin < HF_TOLERANCE_BINS ? bin : HF_TOLERANCE_BINS - 1]++;
}

/* ---- all figures together ---- */

/* Finds the quantiles of measure k over all samples, with intervals. A sample without a value counts as the worst. */
static hf_status find_quantiles(const hf_statistics_rows *rows, int k, hf_tolerance_figures *f)
{
    long rank[HF_STATISTICS_RANKS], n = rows->n;
    bool more_is_better = hf_tolerance_more_is_better((hf_tolerance_measure)k);
    double value[HF_STATISTICS_RANKS], worst = more_is_better ? -(double)INFINITY : (double)INFINITY;
    for (int q = 0; q < HF_TOLERANCE_QUANTILES; q++) {
        rank[3 * q] = (long)ceil(hf_tolerance_quantile[q] * (double)n);
        hf_statistics_ranks(n, hf_tolerance_quantile[q], &rank[3 * q + 1], &rank[3 * q + 2]);
        if (!more_is_better) continue;
        long low = rank[3 * q + 1]; /* with a larger value better, ranks count from the other end */
        rank[3 * q] = n + 1 - rank[3 * q];
        rank[3 * q + 1] = n + 1 - rank[3 * q + 2];
        rank[3 * q + 2] = n + 1 - low;
    }
    long asked[HF_STATISTICS_RANKS];
    for (int i = 0; i < HF_STATISTICS_RANKS; i++)
        asked[i] = rank[i] < 1 ? 1 : rank[i] > n ? n : rank[i];
    HF_TRY(hf_statistics_order(rows, HF_TOLERANCE_FIRST + k, worst, HF_STATISTICS_RANKS, asked, value));
    for (int q = 0; q < HF_TOLERANCE_QUANTILES; q++) {
        f->value[q] = value[3 * q];
        f->low[q] = rank[3 * q + 1] < 1 ? (double)NAN : value[3 * q + 1];
        f->high[q] = rank[3 * q + 2] > n ? (double)NAN : value[3 * q + 2];
    }
    return HF_OK;
}

/* Returns the square root of an end of an interval, 0 for a negative one. NaN remains NaN. */
static double root_of(double square)
{
    return sqrt(square < 0 ? 0 : square);
}

/* Estimates the mean of psi^2 with x, psi^2 of the linear model, as control variate. The mean of x is known exactly.
 * The mean of y is corrected by beta = cov(x, y)/var(x) times the error of the mean of x. The known mean holds for all
 * nets, so there is no correction when samples have no psi. */
static void control(const hf_covariance *c, const moments *s, hf_tolerance_summary *to)
{
    double known = c->nominal_psi_m * c->nominal_psi_m + c->spread_m2, n = (double)s->n_both;
    double beta = s->xx > 0 ? s->xy / s->xx : 0, left = s->yy - beta * s->xy;
    double error = n > 1 ? NORMAL_95 * sqrt(s->yy / (n - 1) / n) : (double)NAN;
    double less = n > 2 ? NORMAL_95 * sqrt(fmax(left, 0) / (n - 2) / n) : (double)NAN;
    double mean = s->n_both == to->samples ? s->mean_y - beta * (s->mean_x - known) : (double)NAN;
    to->rms_psi_m = sqrt(s->mean_y);
    to->rms_psi_low_m = root_of(s->mean_y - error);
    to->rms_psi_high_m = root_of(s->mean_y + error);
    to->controlled_rms_psi_m = root_of(mean);
    to->controlled_low_m = root_of(mean - less);
    to->controlled_high_m = root_of(mean + less);
    to->correlation = s->xx > 0 && s->yy > 0 ? s->xy / sqrt(s->xx * s->yy) : (double)NAN;
    to->variance_saved = isnan(mean) ? (double)NAN : to->correlation * to->correlation;
}

/* Computes the share of the samples that meet all rows with a share, with its interval. */
static void judge_yield(const moments *s, long n, hf_tolerance_summary *to)
{
    to->yield = to->yield_low = to->yield_high = to->sigma_scale = (double)NAN;
    if (s->n_share == 0) return;
    to->yield = (double)s->met / (double)n;
    hf_statistics_interval(n, s->met, &to->yield_low, &to->yield_high);
}

/* Lists the cables with the largest shares in the spread of psi^2, and sets the share of each kind of error. */
static void rank_cables(const hf_montecarlo *t, hf_tolerance_summary *to)
{
    const hf_covariance *c = &t->covariance;
    int n_cable = t->built->scene.n_cable, ranked[HF_TOLERANCE_RANKED] = {0};
    for (int e = 0; e < n_cable; e++)
        if (c->cable_m2[e] > 0)
            to->n_ranked = hf_list_largest(e, c->cable_m2, HF_TOLERANCE_RANKED, to->n_ranked, ranked);
    for (int k = 0; k < to->n_ranked; k++) {
        strncpy(to->ranked_id[k], t->built->scene.cable_id[ranked[k]], HF_TOLERANCE_ID_SIZE - 1);
        to->ranked_share[k] = c->cable_m2[ranked[k]] / c->spread_m2;
    }
    for (int k = 0; k < HF_ERROR_N_KIND; k++)
        to->kind_share[k] = c->spread_m2 > 0 ? c->kind_m2[k] / c->spread_m2 : 0;
}

/* Computes mean, deviation and interval of the mean of measure k from its sums. Unknown figures are NaN. */
static void find_figures(const moments *s, int k, hf_tolerance_figures *f)
{
    double n = (double)s->n[k], nothing = (double)NAN;
    if (s->n[k] == 0) {
        *f = (hf_tolerance_figures){false, nothing, nothing, nothing, nothing, nothing, nothing, {0}, {0}, {0}};
        for (int q = 0; q < HF_TOLERANCE_QUANTILES; q++)
            f->value[q] = f->low[q] = f->high[q] = nothing;
        return;
    }
    if (!isfinite(f->mean)) f->mean = nothing; /* an infinite gain loss has no mean */
    f->deviation = s->n[k] > 1 && !isnan(f->mean) ? sqrt(s->square[k] / (n - 1)) : nothing;
    f->mean_low = f->mean - NORMAL_95 * f->deviation / sqrt(n);
    f->mean_high = f->mean + NORMAL_95 * f->deviation / sqrt(n);
    /* No value of such a measure is negative. */
    if (!hf_tolerance_more_is_better((hf_tolerance_measure)k) && f->mean_low < 0) f->mean_low = 0;
}

hf_status hf_statistics_sum_up(const hf_montecarlo *t, const hf_statistics_rows *rows, hf_tolerance_summary *to)
{
    const hf_covariance *c = &t->covariance;
    moments s = {.to = to};
    if (t->required) s.n_share = t->required->n_share;
    if (t->n_load_case) s.count_at = hf_montecarlo_count_at(t->required);
    *to = (hf_tolerance_summary){
        .samples = (int)rows->n, .nominal_psi_m = c->nominal_psi_m, .n_sampled_load_case = t->n_load_case};
    to->first_order_rms_psi_m = sqrt(c->nominal_psi_m * c->nominal_psi_m + c->spread_m2);
    HF_TRY(visit_rows(rows, add_row, &s));
    s.mean_y /= (double)s.n_both;
    s.mean_x /= (double)s.n_both;
    for (int k = 0; k < HF_TOLERANCE_N_MEASURE; k++)
        to->figure[k].mean = s.sum[k] / (double)s.n[k];
    HF_TRY(visit_rows(rows, add_deviations, &s));
    for (int k = 0; k < HF_TOLERANCE_N_MEASURE; k++) {
        hf_tolerance_figures *f = &to->figure[k];
        find_figures(&s, k, f);
        f->is_measured = s.n[k] > 0 && hf_montecarlo_measures(t->surface, t->facets, (hf_tolerance_measure)k);
        if (f->is_measured) HF_TRY(find_quantiles(rows, k, f));
    }
    control(c, &s, to);
    judge_yield(&s, rows->n, to);
    rank_cables(t, to);
    to->psi_95_m = to->figure[HF_TOLERANCE_PSI].value[1]; /* index 1 is the 95 % quantile of hf_tolerance_quantile */
    to->bin_low_m = to->figure[HF_TOLERANCE_PSI].min;
    to->bin_high_m = to->figure[HF_TOLERANCE_PSI].max;
    for (int k = 0; k < HF_TOLERANCE_BINS; k++)
        to->bin[k] = (double)s.bin[k] / (double)s.n_both;
    return HF_OK;
}

/* ---- requirements ---- */

/* Looks for the samples that a verdict describes. */
typedef struct {
    const hf_required *required;
    int row;       /* row of the requirements */
    size_t at;     /* of its margin in a row of a sample */
    long i, n_met; /* number of the present sample; samples that meet the row */
    double quantile, worst;
    bool has_quantile; /* the sample with the margin `quantile` was found */
    hf_requirement_verdict *to;
} search;

static void count_met(void *context, const double *row)
{
    search *s = context;
    s->n_met += row[s->at] >= 0;
    s->i++;
}

static void note_sample(void *context, const double *row)
{
    search *s = context;
    const hf_required *q = s->required;
    const double *value = row + hf_montecarlo_value_at(q, 0, false), *item = row + hf_montecarlo_value_at(q, 0, true);
    const size_t stride = 2 * (size_t)q->n_column;
    if (!s->has_quantile && row[s->at] == s->quantile) {
        s->has_quantile = true;
        hf_required_note(q, s->row, false, value, item, stride, s->to);
    }
    if (s->to->worst_sample < 0 || row[s->at] < s->worst) {
        s->to->worst_sample = s->i;
        s->worst = row[s->at];
        hf_required_note(q, s->row, true, value, item, stride, s->to);
    }
    s->i++;
}

/* The quantile is the margin of the first sample that the share does not let fail. Its sign therefore agrees with the
 * comparison of yield and share. */
static hf_status judge_share(const hf_required *q, int k, const hf_statistics_rows *rows, hf_requirement_verdict *to)
{
    const hf_requirement_settings *r = &q->row[q->share[k]];
    search s = {.required = q, .row = q->share[k], .at = hf_montecarlo_margin_at(k), .to = to};
    long may_fail = (long)floor((1 - r->share) * (double)rows->n * (1 + 1e-12)), rank = may_fail + 1;
    if (rank > rows->n) rank = rows->n;
    to->worst_sample = -1;
    to->error_bound = (double)NAN;
    HF_TRY(hf_statistics_order(rows, (int)s.at, -(double)INFINITY, 1, &rank, &s.quantile));
    HF_TRY(visit_rows(rows, count_met, &s));
    s.i = 0;
    HF_TRY(visit_rows(rows, note_sample, &s));
    to->yield = (double)s.n_met / (double)rows->n;
    hf_statistics_interval(rows->n, s.n_met, &to->yield_low, &to->yield_high);
    to->verdict = to->yield_low >= r->share   ? HF_VERDICT_PASS
                  : to->yield_high < r->share ? HF_VERDICT_FAIL
                                              : HF_VERDICT_UNDECIDED;
    return HF_OK;
}

hf_status hf_statistics_judge(const hf_montecarlo *t, const hf_statistics_rows *rows, hf_requirement_verdict *verdict)
{
    for (int k = 0; t->required && k < t->required->n_share; k++)
        HF_TRY(judge_share(t->required, k, rows, &verdict[t->required->share[k]]));
    return HF_OK;
}
