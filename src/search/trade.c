/* Contents: one point - many points at once - the ends - between them - the front */
#include "search/trade.h"

#include "base/arena.h"
#include "search/parallel.h"
#include "search/polish.h"

#include <math.h>
#include <string.h>

/* In brackets: the range over which no test fails, as far as it was tried. */
#define END_GIVES 1e-6 /* part of its range by which the objective of an end may rise where that lowers the other ... */
#define END_GAINS 0.05 /* ... by more than this part of the other's range */
#define LONG_GAP 0.5 /* gaps longer than this part of the longest are halved at once, whatever the number of threads */
#define NO_GAP 1e-9  /* part of the range of the limited objective: no limit fits between */

/* A point that is wanted, and what is found. */
typedef struct {
    int least;             /* the objective that is to be least */
    double most;           /* of the other; INFINITY: any */
    const double *from[2]; /* [n_gene] designs to begin from: the second where the first leads nowhere; or NULL */
    double *design;        /* [n_gene] the answer */
    hf_front_point found;
    const void *closed; /* the next point on the way, with none to be found between */
} job;

typedef struct {
    const hf_trade *t;
    size_t n_gene;
    int main, other; /* the objective that is least, under a limit on the other */
    double range[2]; /* of the objectives between the ends */
    int failed_end;  /* the objective whose end has no design; else -1 */
    int n, n_run;    /* jobs, and those of them that have run */
    job *job;        /* [n_point + 4] */
    int n_way;
    job **way;         /* [n_point + 4] points that none of them dominates, ascending by the other objective */
    double *length;    /* [n_point + 4] of the gap that follows each */
    hf_status failure; /* HF_NO_MEMORY or HF_INTERRUPTED of a thread */
    hf_parallel_queue queue;
    hf_status *of_room; /* [n_thread] */
    void *block;
} search;

bool hf_trade_applies(const hf_evaluator *v)
{
    return v->goals && v->goals->n_goal == 2 && hf_polish_applies(v);
}

/* ---- one point ---- */

/* Levenberg-Marquardt from the design, which is replaced. Returns what ends the whole search, else HF_OK. */
static hf_status polish(const search *s, const job *j, double *design, hf_workspace *w, hf_front_point *point)
{
    const hf_trade *t = s->t;
    double most[2] = {INFINITY, INFINITY};
    const hf_watch_trade trade = {j->least, most};
    hf_polish_result r;
    hf_form_result result;
    most[1 - j->least] = j->most;
    *point = (hf_front_point){.objective = {NAN, NAN, NAN}, .multiplier = {NAN, NAN, NAN}};
    hf_status status = hf_polish_trade(t->evaluator, t->lower, t->upper, t->max_iterations, &trade, design, w, &r);
    if (status == HF_OK) status = hf_evaluate(t->evaluator, design, w, &result);
    if (t->stop && *t->stop) return HF_INTERRUPTED;
    if (status == HF_NO_MEMORY) return status;
    point->status = status;
    point->iterations = r.iterations;
    point->is_converged = status == HF_OK && r.stop == HF_POLISH_CONVERGED;
    for (int k = 0; k < 2 && status == HF_OK; k++) {
        point->objective[k] = result.goal[k];
        if (j->least == s->main && point->is_converged) point->multiplier[k] = r.multiplier[k];
    }
    return HF_OK;
}

/* Is a point unfinished, or worse than one that is there? */
static bool is_doubtful(const search *s, const job *j)
{
    if (j->found.status != HF_OK || !j->found.is_converged) return true;
    for (int i = 0; i < s->n_way; i++)
        if (hf_front_dominates(2, s->way[i]->found.objective, j->found.objective)) return true;
    return false;
}

static hf_status find(const search *s, job *j, hf_workspace *w)
{
    size_t size = s->n_gene * sizeof(double);
    hf_front_point again;
    memcpy(j->design, j->from[0], size);
    HF_TRY(polish(s, j, j->design, w, &j->found));
    if (!j->from[1] || !is_doubtful(s, j)) return HF_OK;
    double *design = j->design + s->n_gene; /* the second half of its room */
    memcpy(design, j->from[1], size);
    HF_TRY(polish(s, j, design, w, &again));
    again.iterations += j->found.iterations;
    bool is_better =
        again.status == HF_OK && (j->found.status != HF_OK || again.objective[j->least] < j->found.objective[j->least]);
    if (is_better) {
        j->found = again;
        memcpy(j->design, design, size);
    }
    j->found.iterations = again.iterations;
    return HF_OK;
}

/* ---- many points at once ---- */

static void work(void *context, int room)
{
    search *s = context;
    hf_workspace w = {0};
    hf_status status = hf_workspace_create(s->t->evaluator->model, &w);
    if (status == HF_OK) status = hf_evaluate_attend(s->t->evaluator, &w);
    w.stop = s->t->stop;
    while (status == HF_OK) {
        int i = hf_parallel_take(&s->queue);
        if (i < 0) break;
        status = find(s, &s->job[s->n_run + i], &w);
    }
    hf_workspace_free(&w);
    s->of_room[room] = status;
}

/* Run the jobs that were added. Each depends on earlier ones alone, so threads change nothing. */
static hf_status run(search *s)
{
    int n_thread = s->t->n_thread;
    s->queue = (hf_parallel_queue){.n = s->n - s->n_run};
    memset(s->of_room, 0, (size_t)n_thread * sizeof *s->of_room);
    hf_parallel_run(n_thread, work, s);
    s->n_run = s->n;
    for (int i = 0; i < n_thread; i++)
        HF_TRY(s->of_room[i]);
    return HF_OK;
}

static job *add(search *s, int least, double most, const double *first, const double *second)
{
    job *j = &s->job[s->n++];
    j->least = least;
    j->most = most;
    j->from[0] = first;
    j->from[1] = second;
    return j;
}

/* ---- the ends ---- */

/* The start with the least objective k of those that are feasible, or of those that have a shape, or any. */
static hf_status choose_start(const search *s, int k, hf_workspace *w, const double **start)
{
    int best_rank = -1;
    double least = INFINITY;
    *start = s->t->start;
    for (int i = 0; i < s->t->n_start; i++) {
        const double *design = s->t->start + (size_t)i * s->n_gene;
        hf_form_result r;
        hf_status status = hf_evaluate(s->t->evaluator, design, w, &r);
        if (status == HF_NO_MEMORY) return status;
        int rank = status == HF_OK ? 2 : hf_status_has_shape(status);
        double value = status == HF_OK ? r.goal[k] : i;
        if (rank < best_rank || (rank == best_rank && !(value < least))) continue;
        best_rank = rank;
        least = value;
        *start = design;
    }
    return HF_OK;
}

/* The least of each objective alone, and where that leaves room, the least of the other beside it. */
static hf_status find_ends(search *s, job *end[2])
{
    const double *start[2];
    hf_workspace w = {0};
    hf_status status = hf_workspace_create(s->t->evaluator->model, &w);
    if (status == HF_OK) status = hf_evaluate_attend(s->t->evaluator, &w);
    for (int k = 0; k < 2 && status == HF_OK; k++)
        status = choose_start(s, k, &w, &start[k]);
    hf_workspace_free(&w);
    HF_TRY(status);
    for (int k = 0; k < 2; k++)
        end[k] = add(s, k, INFINITY, start[k], start[1 - k]);
    HF_TRY(run(s));
    for (int k = 0; k < 2; k++) {
        s->failed_end = k;
        if (end[k]->found.status != HF_OK) return end[k]->found.status;
    }
    s->failed_end = -1;
    const hf_front_point *a = &end[0]->found, *b = &end[1]->found;
    s->range[0] = b->objective[0] - a->objective[0];
    s->range[1] = a->objective[1] - b->objective[1];
    if (!(s->range[0] > 0 && s->range[1] > 0)) return HF_OK; /* one design is best in both */
    job *beside[2];
    for (int k = 0; k < 2; k++)
        beside[k] = add(s, 1 - k, end[k]->found.objective[k] + END_GIVES * s->range[k], end[k]->design, NULL);
    HF_TRY(run(s));
    for (int k = 0; k < 2; k++) {
        const hf_front_point *found = &beside[k]->found;
        double gain = end[k]->found.objective[1 - k] - found->objective[1 - k];
        if (found->status != HF_OK || !(gain > END_GAINS * s->range[1 - k])) continue;
        end[k] = beside[k];
        for (int i = 0; i < 2; i++) /* that of the limit of END_GIVES, not of the front */
            end[k]->found.multiplier[i] = NAN;
    }
    s->range[0] = end[1]->found.objective[0] - end[0]->found.objective[0];
    s->range[1] = end[0]->found.objective[1] - end[1]->found.objective[1];
    return HF_OK;
}

/* ---- between them ---- */

/* Put a point in its place on the way, and what it dominates out of it; nothing if it is dominated itself. */
static void join(search *s, job *j)
{
    int at = 0, n = 0;
    const double *objective = j->found.objective;
    if (j->found.status != HF_OK) return;
    for (int i = 0; i < s->n_way; i++) {
        const double *of = s->way[i]->found.objective;
        bool is_same = of[0] == objective[0] && of[1] == objective[1];
        if (is_same || hf_front_dominates(2, of, objective)) return;
    }
    for (int i = 0; i < s->n_way; i++)
        if (!hf_front_dominates(2, objective, s->way[i]->found.objective)) s->way[n++] = s->way[i];
    while (at < n && s->way[at]->found.objective[s->other] < objective[s->other])
        at++;
    memmove(s->way + at + 1, s->way + at, (size_t)(n - at) * sizeof *s->way);
    s->way[at] = j;
    s->n_way = n + 1;
}

/* Lengths of the gaps in parts of the ranges; 0 of one into which nothing fits. Returns the longest. */
static double measure_gaps(search *s)
{
    double longest = 0;
    for (int i = 0; i + 1 < s->n_way; i++) {
        const double *a = s->way[i]->found.objective, *b = s->way[i + 1]->found.objective;
        double x = (b[0] - a[0]) / s->range[0], y = (b[1] - a[1]) / s->range[1];
        bool is_open = s->way[i]->closed != s->way[i + 1] && b[s->other] - a[s->other] > NO_GAP * s->range[s->other];
        s->length[i] = is_open ? sqrt(x * x + y * y) : 0;
        longest = fmax(longest, s->length[i]);
    }
    return longest;
}

/* Halve the longest gaps, up to n_more of them. The design of the tighter limit keeps the new one. */
static hf_status halve_gaps(search *s, int n_more)
{
    double longest = measure_gaps(s);
    int first = s->n;
    for (; n_more > 0; n_more--) {
        int at = 0;
        for (int i = 1; i + 1 < s->n_way; i++)
            if (s->length[i] > s->length[at]) at = i;
        if (!(s->length[at] > LONG_GAP * longest)) break;
        s->length[at] = 0;
        job *low = s->way[at], *high = s->way[at + 1];
        double middle = (low->found.objective[s->other] + high->found.objective[s->other]) / 2;
        add(s, s->main, middle, low->design, high->design);
        low->closed = high; /* until a point comes between them */
    }
    HF_TRY(run(s));
    for (int i = first; i < s->n; i++)
        join(s, &s->job[i]);
    return HF_OK;
}

static hf_status fill(search *s, job *end[2])
{
    int n_end = s->n - 2;
    s->n_way = 0;
    join(s, end[0]);
    join(s, end[1]);
    while (s->n - n_end < s->t->n_point) {
        int before = s->n;
        HF_TRY(halve_gaps(s, s->t->n_point - (s->n - n_end)));
        if (s->n == before) break;
    }
    return HF_OK;
}

/* ---- the front ---- */

static void lay_out(hf_arena *a, search *s)
{
    size_t n = (size_t)s->t->n_point + 4;
    s->job = hf_arena_take(a, n, sizeof *s->job);
    s->way = hf_arena_take(a, n, sizeof *s->way);
    s->length = hf_arena_take(a, n, sizeof(double));
    s->of_room = hf_arena_take(a, (size_t)s->t->n_thread, sizeof *s->of_room);
    for (size_t i = 0; i < n; i++) {
        double *design = hf_arena_take(a, 2 * s->n_gene, sizeof(double));
        if (a->block) s->job[i].design = design;
    }
}

static void copy(const search *s, const job *j, int at, hf_front *front)
{
    double *design = front->design + (size_t)at * s->n_gene;
    front->point[at] = j->found;
    for (size_t k = 0; k < s->n_gene; k++)
        design[k] = j->found.status == HF_OK ? j->design[k] : (double)NAN;
}

static hf_status hand_over(const search *s, job *end[2], int n_end, hf_front *front)
{
    int n = 0;
    HF_TRY(hf_front_create(2, (int)s->n_gene, 2 + s->n - n_end, front));
    front->minimised = s->main;
    for (int k = 0; k < 2; k++)
        copy(s, end[k], n++, front);
    for (int i = n_end; i < s->n; i++)
        copy(s, &s->job[i], n++, front);
    hf_front_settle(front);
    return HF_OK;
}

hf_status hf_trade_find(const hf_trade *trade, hf_front *front, int *failed_end)
{
    hf_trade t = *trade;
    hf_evaluator alone = *trade->evaluator; /* each point has one thread */
    hf_arena arena = {0};
    job *end[2];
    if (t.n_thread <= 0) t.n_thread = hf_parallel_cores();
    search s = {.t = &t, .failed_end = -1, .n_gene = (size_t)t.evaluator->model->n_gene};
    alone.n_thread = 1;
    t.evaluator = &alone;
    *front = (hf_front){.minimised = -1, .knee = -1};
    *failed_end = -1;
    s.main = hf_goals_is_largest(t.evaluator->goals->goal[0].wanted.goal) &&
             !hf_goals_is_largest(t.evaluator->goals->goal[1].wanted.goal);
    s.other = 1 - s.main;
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, &s)));
    hf_status status = find_ends(&s, end);
    int n_end = s.n;
    if (status == HF_OK && s.range[0] > 0 && s.range[1] > 0) status = fill(&s, end);
    if (status == HF_OK) status = hand_over(&s, end, n_end, front);
    hf_arena_free(&arena);
    *failed_end = s.failed_end;
    return status;
}
