/* Ranks designs with two or three objectives. pareto.h describes the interface.
 *
 *     objectives, violations -> heapsort -> fronts, by binary search over the fronts so far -> rank of each design
 *     one front -> room between neighbours -> remove the most crowded design, again and again -> designs to keep
 *
 * Contents: values and dominance - order - fronts - crowded fronts - the front of a population */
#include "search/pareto.h"

#include <math.h>
#include <string.h>

/* ---- values and dominance ---- */

void hf_pareto_set(hf_pareto *p, int i, const double *objective, double violation)
{
    bool has_values = true;
    for (int j = 0; j < p->n_objective; j++) {
        p->value[(size_t)i * HF_FRONT_OBJECTIVES_MAX + (size_t)j] = objective[j];
        has_values &= isfinite(objective[j]) != 0;
    }
    p->violation[i] = isnan(violation) || (violation <= 0 && !has_values) ? INFINITY : violation;
}

static bool is_feasible(const hf_pareto *p, int i)
{
    return !(p->violation[i] > 0);
}

bool hf_pareto_dominates(const hf_pareto *p, int a, int b)
{
    if (!is_feasible(p, a) || !is_feasible(p, b)) return p->violation[a] < p->violation[b];
    return hf_front_dominates(p->n_objective, hf_pareto_value(p, a), hf_pareto_value(p, b));
}

/* ---- order ---- */

/* Returns a number below zero if a comes before b. If `objective` is below 0, the order is by violation and then by all
 * objectives in turn, so that no design comes before one that dominates it. Otherwise the order is by this objective.
 * The index decides between equal designs. */
static int compare(const hf_pareto *p, int objective, int a, int b)
{
    const double *x = hf_pareto_value(p, a), *y = hf_pareto_value(p, b);
    if (objective >= 0) {
        if (x[objective] != y[objective]) return x[objective] < y[objective] ? -1 : 1;
        /* In the other objectives, the index decides the other way round. So only one of two equal designs is an
         * end. */
        return objective == 0 ? a - b : b - a;
    }
    if (!is_feasible(p, a) || !is_feasible(p, b)) {
        if (p->violation[a] != p->violation[b]) return p->violation[a] < p->violation[b] ? -1 : 1;
        return a - b;
    }
    for (int j = 0; j < p->n_objective; j++)
        if (x[j] != y[j]) return x[j] < y[j] ? -1 : 1;
    return a - b;
}

/* Restores the heap order [n] below entry i. */
static void sink(const hf_pareto *p, int objective, int *order, int i, int n)
{
    int item = order[i];
    for (int child = 2 * i + 1; child < n; i = child, child = 2 * i + 1) {
        if (child + 1 < n && compare(p, objective, order[child], order[child + 1]) < 0) child++;
        if (compare(p, objective, item, order[child]) >= 0) break;
        order[i] = order[child];
    }
    order[i] = item;
}

/* Sorts by heapsort, because qsort may allocate memory. */
static void sort(const hf_pareto *p, int objective, int *order, int n)
{
    for (int i = n / 2 - 1; i >= 0; i--)
        sink(p, objective, order, i, n);
    for (int last = n - 1; last > 0; last--) {
        int item = order[last];
        order[last] = order[0];
        order[0] = item;
        sink(p, objective, order, 0, last);
    }
}

/* ---- fronts ---- */

/* Returns true if a member of the front dominates design i, which comes after all members in the order. With two
 * objectives, the last member has the minimum of the second one, so the other members need no test. */
static bool front_dominates(const hf_pareto *p, int last, const int *earlier, int i)
{
    for (int k = last; k >= 0; k = earlier[k]) {
        if (hf_pareto_dominates(p, k, i)) return true;
        if (p->n_objective == 2) return false;
    }
    return false;
}

int hf_pareto_rank(const hf_pareto *p, int *rank)
{
    int *order = p->scratch, *last = order + p->n, *earlier = last + p->n, n_front = 0;
    for (int i = 0; i < p->n; i++)
        order[i] = i;
    sort(p, -1, order, p->n);
    for (int k = 0; k < p->n; k++) {
        int i = order[k], low = 0, high = n_front;
        /* Find the first front that does not dominate design i. If a front dominates it, so do the fronts before. */
        while (low < high) {
            int middle = low + (high - low) / 2;
            if (front_dominates(p, last[middle], earlier, i))
                low = middle + 1;
            else
                high = middle;
        }
        earlier[i] = low < n_front ? last[low] : -1;
        last[low] = i;
        rank[i] = low;
        if (low == n_front) n_front++;
    }
    return n_front;
}

/* ---- crowded fronts ---- */

/* The neighbours of each design in the order of each objective; -1 at the ends. */
typedef struct {
    int *before, *after; /* [n_objective][n] */
    double range[HF_FRONT_OBJECTIVES_MAX];
} neighbours;

/* Returns the room between the neighbours of design i, or INFINITY at an end. With two objectives, it is the area that
 * this design alone dominates (its part of the hypervolume). With three, it is the sum of the distances between its
 * neighbours in each objective, in parts of the ranges. */
static double room_of(const hf_pareto *p, const neighbours *list, int i)
{
    double sum = 0, side[HF_FRONT_OBJECTIVES_MAX];
    for (int j = 0; j < p->n_objective; j++) {
        int a = list->before[j * p->n + i], b = list->after[j * p->n + i];
        if (a < 0 || b < 0) return INFINITY;
        double to = hf_pareto_value(p, b)[j];
        side[j] = to - hf_pareto_value(p, i)[j];
        sum += (to - hf_pareto_value(p, a)[j]) / list->range[j];
    }
    return p->n_objective == 2 ? side[0] * side[1] : sum;
}

/* Sorts the members by each objective, and links each member with its neighbours. */
static neighbours link_up(const hf_pareto *p, int n_member, const int *member)
{
    int *order = p->scratch, n_all = p->n_objective * p->n;
    neighbours list = {order + p->n, order + p->n + n_all, {0}};
    for (int j = 0; j < p->n_objective; j++) {
        for (int k = 0; k < n_member; k++)
            order[k] = member[k];
        sort(p, j, order, n_member);
        for (int k = 0; k < n_member; k++) {
            list.before[j * p->n + order[k]] = k > 0 ? order[k - 1] : -1;
            list.after[j * p->n + order[k]] = k + 1 < n_member ? order[k + 1] : -1;
        }
        double range = hf_pareto_value(p, order[n_member - 1])[j] - hf_pareto_value(p, order[0])[j];
        list.range[j] = range > 0 ? range : 1;
    }
    return list;
}

/* Removes design i from the lists. Its neighbours then have more room. */
static void unlink_one(const hf_pareto *p, neighbours *list, int i)
{
    p->room[i] = -1;
    for (int j = 0; j < p->n_objective; j++) {
        int a = list->before[j * p->n + i], b = list->after[j * p->n + i];
        if (a >= 0) list->after[j * p->n + a] = b;
        if (b >= 0) list->before[j * p->n + b] = a;
    }
    for (int j = 0; j < p->n_objective; j++) {
        int a = list->before[j * p->n + i], b = list->after[j * p->n + i];
        if (a >= 0) p->room[a] = room_of(p, list, a);
        if (b >= 0) p->room[b] = room_of(p, list, b);
    }
}

void hf_pareto_keep(const hf_pareto *p, int n_member, int *member, int n_keep)
{
    if (n_keep >= n_member || !is_feasible(p, member[0])) return;
    neighbours list = link_up(p, n_member, member);
    for (int k = 0; k < n_member; k++)
        p->room[member[k]] = room_of(p, &list, member[k]);
    for (int left = n_member; left > n_keep; left--) {
        int least = -1;
        for (int k = 0; k < n_member; k++) {
            double room = p->room[member[k]];
            if (room >= 0 && (least < 0 || room <= p->room[least])) least = member[k];
        }
        unlink_one(p, &list, least);
    }
    int n_kept = 0;
    for (int k = 0; k < n_member; k++) {
        int i = member[k];
        if (p->room[i] < 0) continue;
        member[k] = member[n_kept];
        member[n_kept++] = i;
    }
}

/* ---- the front of a population ---- */

static void copy_point(const hf_population *population, int i, hf_front *f, int place)
{
    size_t n = (size_t)population->n_variable;
    hf_front_point *point = &f->point[place];
    *point = (hf_front_point){.status = HF_OK, .mark = HF_FRONT_ON};
    for (int j = 0; j < HF_FRONT_OBJECTIVES_MAX; j++) {
        point->objective[j] = j < f->n_objective ? population->result[i].objective[j] : (double)NAN;
        point->multiplier[j] = (double)NAN;
    }
    memcpy(f->design + (size_t)place * n, population->design + (size_t)i * n, n * sizeof(double));
}

hf_status hf_pareto_front(const hf_population *population, hf_front *front)
{
    hf_pareto p = {.n = population->n_individual, .n_objective = population->n_objective};
    size_t size = (size_t)p.n_objective * sizeof(double);
    void *block;
    int *rank, n_on = 0;
    *front = (hf_front){.minimised = -1, .knee = -1};
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_PARETO_ARRAYS(p), HF_ARRAY(rank, p.n)));
    for (int i = 0; i < p.n; i++)
        hf_pareto_set(&p, i, population->result[i].objective, hf_population_violation(&population->result[i]));
    hf_pareto_rank(&p, rank);
    int *order = p.scratch;
    /* hf_pareto_rank leaves this order: by the objectives in turn, so that equal designs are neighbours. */
    for (int k = 0, last = -1; k < p.n; k++) {
        int i = order[k];
        bool is_new = last < 0 || memcmp(hf_pareto_value(&p, last), hf_pareto_value(&p, i), size) != 0;
        if (rank[i] == 0 && is_feasible(&p, i) && is_new) order[n_on++] = last = i;
    }
    hf_status status = hf_front_create(p.n_objective, population->n_variable, n_on, front);
    for (int k = 0; status == HF_OK && k < n_on; k++)
        copy_point(population, order[k], front, k);
    if (status == HF_OK) hf_front_settle(front);
    hf_arena_free_block(block);
    return status;
}
