/* Groups the points of a merged study that differ only in the replicate, compares the two best groups, and finds axes
 * to extend:
 *
 *     points of a group, sorted by the ranking -> statistics, best point -> rank of the group
 *       -> two best groups: values that differ by rounding become equal -> rank test
 *       -> whether the figure still improves at the end of an axis */
#include "out/merged.h"

#include "base/elementary.h"
#include "out/rank_test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const hf_merged_statistic_word[HF_MERGED_N_STATISTIC] = {"minimum", "lower_quartile", "median",
                                                                     "upper_quartile", "maximum"};

double hf_merged_median(const hf_merged *m, const hf_merged_group *g)
{
    double median = g->statistic[HF_MERGED_MEDIAN];
    return isnan(median) ? (double)INFINITY : hf_merged_is_margin(m, m->lead) ? -median : median;
}

/* What a point ranks by. */
typedef struct {
    bool is_done;
    int n_failed, n_undecided;
    double value; /* less is better */
    int index;    /* the point or the group */
} standing;

static standing standing_of(const hf_merged *m, int i)
{
    const hf_judgement *of = &m->judgement[i].of;
    return (standing){hf_merged_is_done(m, i), of->n_failed, of->n_undecided, hf_merged_rank_value(m, i), i};
}

/* Compares all but the values. */
static int compare_verdicts(const standing *a, const standing *b)
{
    if (a->is_done != b->is_done) return a->is_done ? -1 : 1;
    if (a->n_failed != b->n_failed) return a->n_failed < b->n_failed ? -1 : 1;
    return (a->n_undecided > b->n_undecided) - (a->n_undecided < b->n_undecided);
}

static int compare(const void *x, const void *y)
{
    const standing *a = x, *b = y;
    int by_verdict = compare_verdicts(a, b), by_value = (a->value > b->value) - (a->value < b->value);
    return by_verdict ? by_verdict : by_value ? by_value : (a->index > b->index) - (a->index < b->index);
}

/* Collects the points of a group that are done or have failed, sorted by the ranking. Returns their number. */
static int collect(const hf_merged *m, const hf_merged_group *g, standing *to)
{
    int n = 0;
    for (int i = g->first; i < g->first + g->n; i++)
        if (m->status.value[i] != HF_NOT_EVALUATED) to[n++] = standing_of(m, i);
    qsort(to, (size_t)n, sizeof *to, compare);
    return n;
}

/* Returns the value at a position from 0 to 1 among the sorted values; NaN if it is infinite. */
static double quantile(const double *value, int n, double position)
{
    double at = position * (n - 1), part = at - floor(at);
    int k = (int)at;
    double found = part > 0 ? (1 - part) * value[k] + part * value[k + 1] : value[k];
    return isfinite(found) ? found : (double)NAN;
}

/* Sets the statistics of a group. Returns the standing of its median, which ranks it. */
static standing measure(const hf_merged *m, hf_merged_group *g, standing *sorted, double *value)
{
    int n = g->n_run = collect(m, g, sorted);
    bool is_margin = hf_merged_is_margin(m, m->lead);
    g->best = n && sorted[0].is_done ? sorted[0].index : -1;
    for (int k = 0; k < HF_MERGED_N_STATISTIC; k++)
        g->statistic[k] = (double)NAN;
    if (n == 0) return (standing){.value = (double)INFINITY};
    for (int k = 0; k < n; k++)
        value[k] = is_margin ? -sorted[k].value : sorted[k].value;
    qsort(value, (size_t)n, sizeof *value, hf_compare_doubles);
    for (int k = 0; k < HF_MERGED_N_STATISTIC; k++)
        g->statistic[k] = quantile(value, n, k / (HF_MERGED_N_STATISTIC - 1.0));
    standing middle = sorted[n / 2]; /* the worse one of two */
    middle.value = hf_merged_median(m, g);
    return middle;
}

/* Tests whether the groups g and h differ. Neighbours in the ranking whose values differ by rounding count as equal. */
static double test_groups(const hf_merged *m, const hf_merged_group *g, const hf_merged_group *h, standing *both,
                          double *value)
{
    double rounding = hf_merged_rounding(m), class = 0;
    int n = 0, n_g = 0, n_h = 0;
    n = collect(m, g, both);
    n += collect(m, h, both + n);
    qsort(both, (size_t)n, sizeof *both, compare);
    double *a = value, *b = value + g->n_run;
    for (int k = 0; k < n; k++) {
        const standing *now = &both[k], *before = now - 1;
        if (k > 0 && (compare_verdicts(before, now) || hf_merged_is_resolved(before->value, now->value, rounding)))
            class ++;
        if (now->index >= g->first && now->index < g->first + g->n)
            a[n_g++] = class;
        else
            b[n_h++] = class;
    }
    return hf_rank_test(a, n_g, b, n_h);
}

/* Finds the groups: runs of points that agree in all other axes. Returns the number of points of the largest. */
static int find_groups(hf_merged *m)
{
    int most = 0;
    for (int i = 0; i < m->n; i++) {
        bool is_new = i == 0;
        for (int a = 0; a < m->n_axis && !is_new; a++)
            is_new = a != m->replicate && !hf_merged_agree(m, a, i - 1, i);
        if (is_new) m->group[m->n_group++].first = i;
        int n = ++m->group[m->n_group - 1].n;
        most = n > most ? n : most;
    }
    return most;
}

/* Sets the groups of the replicates. Returns HF_OK or HF_NO_MEMORY. */
static hf_status make_groups(hf_merged *m, hf_messages *messages)
{
    m->best_group = m->second_group = -1;
    m->differ_p = (double)NAN;
    if (m->replicate < 0 || m->lead < 0) return HF_OK;
    m->group = calloc((size_t)m->n, sizeof *m->group);
    int most = m->group ? find_groups(m) : 0;
    standing *room = malloc(2 * (size_t)most * sizeof *room + 1), *rank = malloc((size_t)m->n_group * sizeof *rank + 1);
    double *value = malloc(2 * (size_t)most * sizeof *value + 1);
    bool has_room = m->group && room && rank && value;
    for (int k = 0; k < m->n_group && has_room; k++) {
        rank[k] = measure(m, &m->group[k], room, value);
        rank[k].index = k;
    }
    if (has_room) qsort(rank, (size_t)m->n_group, sizeof *rank, compare);
    for (int k = 0; k < m->n_group && has_room; k++)
        m->group[rank[k].index].rank = k;
    if (has_room && rank[0].is_done) m->best_group = rank[0].index;
    if (has_room && m->n_group > 1 && rank[1].is_done) {
        m->second_group = rank[1].index;
        m->differ_p = test_groups(m, &m->group[rank[0].index], &m->group[rank[1].index], room, value);
    }
    free(room);
    free(rank);
    free(value);
    return has_room ? HF_OK : hf_error(messages, HF_NO_MEMORY, "%s: out of memory", m->path);
}

hf_status hf_merged_read(const char *path, hf_merged *m, hf_messages *messages)
{
    HF_TRY(hf_merged_read_points(path, m, messages));
    return make_groups(m, messages);
}

/* ---- the end of an axis ---- */

/* The points or, of a study with replicates, the groups. Item k has the axes of a point, and a value. */
static int n_item(const hf_merged *m)
{
    return m->n_group ? m->n_group : m->n;
}

static int point_of(const hf_merged *m, int k)
{
    return m->n_group ? m->group[k].first : k;
}

static double item_value(const hf_merged *m, int k)
{
    return m->n_group ? hf_merged_median(m, &m->group[k]) : hf_merged_rank_value(m, k);
}

/* Returns whether points i and j are different and agree in all axes but this one and the replicate. */
static bool is_on_curve(const hf_merged *m, int axis, int i, int j)
{
    for (int a = 0; a < m->n_axis; a++)
        if (a != axis && a != m->replicate && !hf_merged_agree(m, a, i, j)) return false;
    return i != j;
}

/* Returns whether the ranking figure improves from item i to item j by more than rounding. */
static bool improves(const hf_merged *m, int i, int j)
{
    double from = item_value(m, i), to = item_value(m, j);
    return isfinite(from) && to < from && hf_merged_is_resolved(from, to, hf_merged_rounding(m));
}

int hf_merged_improves_on(const hf_merged *m, int axis)
{
    const hf_series *s = &m->input[axis];
    int near = -1, next = -1, side = 0; /* the two items nearest to the best one, both on the same side of it */
    int best = m->n_group ? m->best_group : m->best;
    bool is_error = !strncmp(hf_texts_at(&m->input_name, axis), "tolerance.sigma_", 16) || axis == m->replicate;
    if (best < 0 || m->lead < 0 || !s->n || s->columns != 1 || is_error) return 0;
    double at = s->value[point_of(m, best)], near_m = 0, next_m = 0;
    for (int i = 0; i < n_item(m); i++) {
        double away = s->value[point_of(m, i)] - at;
        if (away == 0 || !is_on_curve(m, axis, point_of(m, i), point_of(m, best))) continue;
        if (side && (away > 0) != (side > 0)) return 0;
        side = away > 0 ? 1 : -1;
        if (near < 0 || fabs(away) < near_m) {
            next = near;
            next_m = near_m;
            near = i;
            near_m = fabs(away);
        } else if (next < 0 || fabs(away) < next_m) {
            next = i;
            next_m = fabs(away);
        }
    }
    if (next < 0 || !improves(m, next, near) || !improves(m, near, best)) return 0;
    return -side;
}
