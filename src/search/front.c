/* Sorts and marks the points of a Pareto front, finds its knee and makes its table. <hifdm/front.h> describes the
 * interface.
 *
 *     points -> sort: feasible ones by their objectives, then failed ones -> mark: on, dominated, failed -> knee
 *     front  -> tabulate: ends, knee and evenly spaced points -> table of a summary
 *
 * Contents: order - the knee - the table */
#include <hifdm/front.h>

#include "base/arena.h"

#include <math.h>
#include <string.h>

#define SAME_MARGIN 1e-6 /* relative margins that differ by less are equal */

#define WORD(name, word) word,
const char *const hf_front_mark_word[HF_FRONT_N_MARK + 1] = {HF_FRONT_MARKS(WORD) NULL};
#undef WORD

hf_status hf_front_create(int n_objective, int n_variable, int n_point, hf_front *f)
{
    *f = (hf_front){.n_objective = n_objective, .n_variable = n_variable, .minimised = -1, .knee = -1};
    HF_TRY(HF_ARENA_ARRAYS(&f->block, HF_ARRAY(f->point, n_point),
                           HF_ARRAY(f->design, (size_t)n_point * (size_t)n_variable)));
    f->n_point = n_point;
    return HF_OK;
}

void hf_front_free(hf_front *f)
{
    hf_arena_free_block(f->block);
    *f = (hf_front){.minimised = -1, .knee = -1};
}

bool hf_front_dominates(int n_objective, const double *a, const double *b)
{
    bool is_better = false;
    for (int k = 0; k < n_objective; k++) {
        if (a[k] > b[k]) return false;
        is_better |= a[k] < b[k];
    }
    return is_better;
}

/* ---- order ---- */

static bool is_equal(const hf_front *f, const hf_front_point *a, const hf_front_point *b)
{
    for (int k = 0; k < f->n_objective; k++)
        if (a->objective[k] != b->objective[k]) return false;
    return true;
}

static bool comes_before(const hf_front *f, const hf_front_point *a, const hf_front_point *b)
{
    if ((a->status == HF_OK) != (b->status == HF_OK)) return a->status == HF_OK;
    for (int k = 0; k < f->n_objective && a->status == HF_OK; k++)
        if (a->objective[k] != b->objective[k]) return a->objective[k] < b->objective[k];
    return false;
}

static void swap(void *a, void *b, size_t size)
{
    char *p = a, *q = b;
    for (size_t i = 0; i < size; i++) {
        char kept = p[i];
        p[i] = q[i];
        q[i] = kept;
    }
}

/* Sorts the points by insertion: equal points keep their order, and a front has few points. */
static void sort(hf_front *f)
{
    size_t n_variable = (size_t)f->n_variable;
    for (int i = 1; i < f->n_point; i++)
        for (int k = i; k > 0 && comes_before(f, &f->point[k], &f->point[k - 1]); k--) {
            swap(&f->point[k], &f->point[k - 1], sizeof *f->point);
            swap(f->design + (size_t)k * n_variable, f->design + (size_t)(k - 1) * n_variable,
                 n_variable * sizeof(double));
        }
}

/* Marks each point: failed, dominated by another one or equal to an earlier one, or on the front. */
static void mark(hf_front *f)
{
    for (int i = 0; i < f->n_point; i++) {
        hf_front_point *p = &f->point[i];
        p->mark = p->status == HF_OK ? HF_FRONT_ON : HF_FRONT_FAILED;
        for (int k = 0; k < f->n_point && p->mark == HF_FRONT_ON; k++) {
            const hf_front_point *q = &f->point[k];
            if (q->status != HF_OK) continue;
            if (hf_front_dominates(f->n_objective, q->objective, p->objective) || (k < i && is_equal(f, p, q)))
                p->mark = HF_FRONT_DOMINATED;
        }
    }
}

/* ---- the knee ---- */

/* Returns the knee: the point farthest below the line, or plane, through the minimum of each objective. Each objective
 * is scaled to 0 at its minimum and 1 at its maximum on the front. The knee is then the point with the smallest sum of
 * objectives. Returns -1 if no sum is below 1, as for a straight front, or if an objective has no range. */
static int find_knee(const hf_front *f)
{
    double low[HF_FRONT_OBJECTIVES_MAX], high[HF_FRONT_OBJECTIVES_MAX],
        least = 1 - 1e-9; /* sums of 1 differ by rounding */
    int knee = -1;
    for (int k = 0; k < f->n_objective; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
        for (int i = 0; i < f->n_point; i++) {
            if (f->point[i].mark != HF_FRONT_ON) continue;
            low[k] = fmin(low[k], f->point[i].objective[k]);
            high[k] = fmax(high[k], f->point[i].objective[k]);
        }
        if (!(high[k] > low[k])) return -1;
    }
    for (int i = 0; i < f->n_point; i++) {
        double sum = 0;
        if (f->point[i].mark != HF_FRONT_ON) continue;
        for (int k = 0; k < f->n_objective; k++)
            sum += (f->point[i].objective[k] - low[k]) / (high[k] - low[k]);
        if (!(sum < least)) continue;
        least = sum;
        knee = i;
    }
    return knee;
}

void hf_front_settle(hf_front *f)
{
    sort(f);
    mark(f);
    f->knee = find_knee(f);
}

/* ---- the table ---- */

/* Returns the first point on the front with the minimum of objective k, or -1 if no point is on the front. */
static int find_end(const hf_front *f, int k)
{
    int end = -1;
    for (int i = 0; i < f->n_point; i++)
        if (f->point[i].mark == HF_FRONT_ON && (end < 0 || f->point[i].objective[k] < f->point[end].objective[k]))
            end = i;
    return end;
}

/* Returns true if point i is the knee or an end of the front. */
static bool has_a_name(const hf_front *f, const int end[HF_FRONT_OBJECTIVES_MAX], int i)
{
    bool is_named = i == f->knee;
    for (int k = 0; k < f->n_objective; k++)
        is_named |= i == end[k];
    return is_named;
}

/* Chooses the rows of the table: all ends and the knee, and n_kept evenly spaced ones of the n_other other points. */
static void choose_rows(const hf_front *f, const int end[HF_FRONT_OBJECTIVES_MAX], hf_front_table *t)
{
    long n_named = 0, n_other, n_kept, other = 0;
    for (int i = 0; i < f->n_point; i++)
        n_named += has_a_name(f, end, i);
    n_other = f->n_point - n_named;
    n_kept = n_other < HF_FRONT_POINTS_MAX - n_named ? n_other : HF_FRONT_POINTS_MAX - n_named;
    t->n_row = 0;
    for (int i = 0; i < f->n_point; i++) {
        bool is_row = has_a_name(f, end, i);
        if (!is_row) {
            is_row = (other + 1) * n_kept / n_other > other * n_kept / n_other;
            other++;
        }
        if (!is_row) continue;
        t->index[t->n_row] = i;
        t->row[t->n_row++] = f->point[i];
    }
}

bool hf_front_agrees(const hf_front_table *t)
{
    return t->n_on == 1 && t->n_failed == 0;
}

int hf_front_suggested(const hf_front_table *t)
{
    return t->suggested + 1;
}

bool hf_front_is_judged(const hf_front_table *t)
{
    return t->n_verdict[HF_VERDICT_NONE] < t->n_point - t->n_failed;
}

/* Returns whether point a ranks before point b by its verdicts. Margins that differ by rounding are equal. */
static bool ranks_before(const hf_front *f, const hf_front_point *a, const hf_front_point *b)
{
    hf_judgement p = a->judgement, q = b->judgement;
    bool is_equal = fabs(p.relative_margin_min - q.relative_margin_min) <= SAME_MARGIN;
    p.relative_margin_min = q.relative_margin_min = (double)NAN;
    int order = hf_judgement_compare(&p, &q);
    if (order) return order < 0;
    if (a->mark != b->mark) return a->mark == HF_FRONT_ON;
    if (f->minimised >= 0 && a->is_converged != b->is_converged) return a->is_converged;
    return !is_equal && hf_judgement_compare(&a->judgement, &b->judgement) < 0;
}

/* Returns the point that ranks first: `usual`, the knee or an end, unless another point ranks before it by its
 * verdicts. */
static int find_first(const hf_front *f, int usual)
{
    int first = usual;
    for (int i = 0; i < f->n_point && first >= 0 && f->point[first].judgement.n_required > 0; i++)
        if (f->point[i].status == HF_OK && ranks_before(f, &f->point[i], &f->point[first])) first = i;
    return first;
}

/* Returns the row of the table that holds point `index` of the front, or -1. */
static int row_of(const hf_front_table *t, int index)
{
    int row = index < 0 ? -1 : t->n_row - 1;
    while (row >= 0 && t->index[row] != index)
        row--;
    return row;
}

void hf_front_tabulate(const hf_front *f, hf_front_table *t)
{
    int count[HF_FRONT_N_MARK] = {0}, end[HF_FRONT_OBJECTIVES_MAX] = {-1, -1, -1};
    for (int i = 0; i < f->n_point; i++)
        count[f->point[i].mark]++;
    for (int k = 0; k < f->n_objective; k++)
        end[k] = find_end(f, k);
    t->n_objective = f->n_objective;
    t->n_point = f->n_point;
    t->n_on = count[HF_FRONT_ON];
    t->n_dominated = count[HF_FRONT_DOMINATED];
    t->n_failed = count[HF_FRONT_FAILED];
    t->n_unconverged = 0;
    for (int i = 0; i < f->n_point && f->minimised >= 0; i++)
        t->n_unconverged += f->point[i].status == HF_OK && !f->point[i].is_converged;
    t->minimised = f->minimised;
    memcpy(t->initial, f->initial, sizeof t->initial);
    memset(t->n_verdict, 0, sizeof t->n_verdict);
    for (int i = 0; i < f->n_point; i++)
        if (f->point[i].status == HF_OK) t->n_verdict[hf_judgement_verdict(&f->point[i].judgement)]++;
    t->suggested = find_first(f, f->knee >= 0 ? f->knee : end[0]);
    if (t->suggested >= 0) t->first = f->point[t->suggested];
    choose_rows(f, end, t);
    t->knee = row_of(t, f->knee);
    for (int k = 0; k < HF_FRONT_OBJECTIVES_MAX; k++)
        t->end[k] = row_of(t, end[k]);
}
