/* Finds the points of a Pareto front. front_refine.h describes the interface.
 *
 *     minimum of each objective alone -> ends, ranges -> first lines: without a limit on THIRD, and at its minimum
 *     longest gap on a line      -> mean limit on OTHER -> one more point
 *     longest gap between lines  -> mean limit on THIRD -> one more line
 *     ... until there are n_point points
 *
 * One objective, MAIN, is minimised under limits on the others. With two objectives, the points form one line, in the
 * order of the limit on OTHER. With three, they form several lines. Each line has its own limit on THIRD, from its
 * minimum to no limit. One point:
 *
 *     best_start      best start for an objective
 *     meet            sums of squares, if the minimum of an objective is 0 -> a design to begin from
 *     refine          Levenberg-Marquardt under limits on the other objectives -> objectives, multipliers
 *     find_common     points at the ends -> one that is best in all objectives
 *
 * Some objectives can be 0, such as evenness of tensions. Their size has no slope there that a limit could follow, but
 * their square has one. Such an objective is called `met`.
 *
 * Contents: one point - many points at once - lines - the ends - gaps - the front */
#include "search/front_refine.h"

#include "base/arena.h"
#include "search/parallel.h"
#include "search/refine.h"
#include "search/watch.h"

#include <math.h>
#include <string.h>

/* Brackets contain the range in which no test fails, as far as it was tried. */
/* The objective of an end may rise by END_GIVES of its range if another objective then falls by more than END_GAINS of
 * its range. */
#define END_GIVES 1e-6
#define END_GAINS 0.05
#define AGREE 1e-5    /* a design this near (in parts of the ranges) to the minimum of every objective is best in all */
#define ENDS_MAX 14   /* maximum number of designs found before the first one between the ends */
#define NO_RANGE 1e-9 /* a difference below this part of an objective counts as none */
#define LONG_GAP 0.5  /* gaps above this part of the longest one are halved at once, with any number of threads */
#define NO_GAP 1e-9   /* in a gap below this part of the range of the limited objective, there is no room for a limit */
#define HELD 1e-6     /* an objective within this part of its range below its limit is held by it [1e-4; 1e-8 fails] */
/* The line at the minimum of THIRD is one point if its ends are nearer than this, in parts of the ranges [0.01 to
 * 0.2]. */
#define ONE_POINT 0.05

enum { MAIN, OTHER, THIRD }; /* roles of the objectives, see search.role */

/* A point to find, and what was found. */
typedef struct {
    int least;                            /* the objective to minimise */
    double most[HF_FRONT_OBJECTIVES_MAX]; /* limits on the others; INFINITY: none */
    /* [n_variable], the designs to begin from. The second one (or NULL) is used if the first one does not succeed. */
    const double *from[2];
    int met;        /* objective that is 0 at from[0]; equal to `least`: all may be 0; -1: none */
    double *design; /* [n_variable], the design found */
    hf_front_point found;
    bool is_point;      /* true if it is a point of the front, even if it fails */
    const void *closed; /* the next point of the line, if no point is to be sought between them */
} job;

/* Designs under one limit on THIRD. */
typedef struct {
    double most; /* limit on THIRD; INFINITY: none, as on the only line of two objectives */
    job *end[2]; /* the points of minimum MAIN and of minimum OTHER */
    bool is_new[2];
    job *beside[2]; /* for each end, the minimum of the other objective next to it */
    int n_way;
    job **way;          /* [n_job], points that none of them beats in MAIN and OTHER, ascending by OTHER */
    double *length;     /* [n_job], length of the gap after each point */
    const void *closed; /* the next line, if no line is to be sought between them */
    double gap;         /* distance to the next line */
} line;

typedef struct {
    const hf_front_refine *t;
    hf_evaluator by_limits; /* evaluator of `t`, in which limits on the objective psi replace a maximum of psi */
    hf_objectives objectives;
    size_t n_variable;
    int n_objective, role[HF_FRONT_OBJECTIVES_MAX]; /* the objectives that are MAIN, OTHER and THIRD */
    double range[HF_FRONT_OBJECTIVES_MAX];          /* range of each objective between the ends */
    double largest[HF_FRONT_OBJECTIVES_MAX];        /* maximum of each objective at the designs to begin from */
    int failed_end;                                 /* the objective whose end has no design, or -1 */
    int n, n_run, n_job;                            /* jobs, jobs that have run, and maximum of jobs */
    job *job;
    int n_point;
    job **point;             /* [n_job], points of the front, without those that only led to others */
    int n_line, n_room;      /* lines of the front, and all lines that were begun */
    line *line_room, **line; /* [n_point + 2]; lines in the order of their limits */
    hf_parallel_queue queue;
    hf_status *of_room; /* [n_thread], status of each thread */
} search;

bool hf_front_refine_applies(const hf_evaluator *v)
{
    return v->objectives && v->objectives->n_objective >= 2 && v->objectives->n_objective <= HF_FRONT_OBJECTIVES_MAX &&
           hf_refine_applies(v);
}

/* ---- one point ---- */

/* The memory in which one thread evaluates designs. */
typedef struct {
    hf_workspace w;
    hf_objectives_point point;
} room;

/* Returns HF_OK or HF_NO_MEMORY; call close_room in either case. */
static hf_status open_room(const hf_front_refine *t, room *own)
{
    *own = (room){0};
    HF_TRY(hf_workspace_create(t->evaluator->model, &own->w));
    own->w.stop = t->stop;
    return hf_objectives_point_create(t->evaluator->objectives, &own->point);
}

static void close_room(room *own)
{
    hf_objectives_point_free(&own->point);
    hf_workspace_free(&own->w);
}

/* The weights of `least` next to an objective whose minimum is 0 (`met`), both in parts of their ranges. `met` then
 * rises by about the square of the weight. With the last weight alone, a search that begins where `met` is 0 may find
 * no way along a curved valley. */
static const double weight[] = {1e-2, 1e-4};
enum { N_WEIGHT = sizeof weight / sizeof *weight };

/* Sets role [n_objective]: first the objective to minimise, which is the first one without corners if there is one,
 * then the others in their order. */
static void choose_roles(const hf_objectives *objectives, int *role)
{
    int main = 0, n = 0;
    while (main < objectives->n_objective && hf_objectives_is_maximum(objectives->objective[main].settings.figure))
        main++;
    if (main == objectives->n_objective) main = 0;
    role[n++] = main;
    for (int k = 0; k < objectives->n_objective; k++)
        if (k != main) role[n++] = k;
}

/* Finds the start with the minimum of objective k among the feasible starts. If none is feasible, *start is the first
 * one with a shape, or the first of all. largest [n_objective] rises to the maxima of the feasible starts. Returns
 * HF_OK or HF_NO_MEMORY. */
static hf_status best_start(const hf_front_refine *t, int k, room *own, double *largest, const double **start)
{
    int best_rank = -1;
    double least = INFINITY;
    *start = t->start;
    for (int i = 0; i < t->n_start; i++) {
        const double *design = t->start + (size_t)i * (size_t)t->evaluator->model->n_variable;
        hf_form_result r;
        hf_status status = hf_evaluate(t->evaluator, design, &own->w, &own->point, &r);
        if (status == HF_NO_MEMORY) return status;
        for (int g = 0; g < t->evaluator->objectives->n_objective && status == HF_OK; g++)
            largest[g] = fmax(largest[g], r.objective[g]);
        int rank = status == HF_OK ? 2 : hf_status_has_shape(status);
        double value = status == HF_OK ? r.objective[k] : i;
        if (rank < best_rank || (rank == best_rank && !(value < least))) continue;
        best_rank = rank;
        least = value;
        *start = design;
    }
    return HF_OK;
}

/* Counts one more finished point for the watcher. */
static void count_point(const hf_front_refine *t)
{
    if (t->watcher) atomic_fetch_add(&t->watcher->n_point, 1);
}

/* Counts a step of the search, and reports the progress unless another thread is reporting. */
static hf_status tell_step(void *context, const hf_refine_progress *now)
{
    hf_front_refine_watcher *w = context;
    if (now->iterations == 0) return HF_OK;
    atomic_fetch_add(&w->n_step, 1);
    if (atomic_flag_test_and_set(&w->is_telling)) return HF_OK;
    w->tell(w->context, atomic_load(&w->n_point), atomic_load(&w->n_step));
    atomic_flag_clear(&w->is_telling);
    return HF_OK;
}

/* Replaces the design [n_variable] by one that minimises the objective `least` while the objective `met` rises by about
 * 1e-8 of its range. It minimises the sum of their squares, with a decreasing weight of `least`. If met == least, it
 * minimises the sum of the squares of all objectives. range [n_objective] scales them. Returns HF_OK, also if the
 * design does not change, HF_NO_MEMORY or HF_INTERRUPTED. */
static hf_status meet(const hf_front_refine *t, int met, int least, const double *range, double *design,
                      hf_workspace *w)
{
    hf_evaluator evaluator = *t->evaluator;
    hf_objectives objectives = *evaluator.objectives;
    hf_refine_result result;
    const hf_refine_watcher watcher = {.after = tell_step, .context = t->watcher};
    evaluator.objectives = &objectives;
    for (int i = met == least ? N_WEIGHT - 1 : 0; i < N_WEIGHT; i++) {
        for (int k = 0; k < objectives.n_objective; k++) {
            double part = k == met || met == least ? 1 : k == least ? weight[i] : 0;
            objectives.objective[k].settings.weight = range[k] > 0 ? part / range[k] : 0;
        }
        hf_status status = hf_refine_run(&evaluator, t->lower, t->upper, t->max_iterations, NULL,
                                         t->watcher ? &watcher : NULL, design, w, &result);
        if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
    }
    return HF_OK;
}

/* Returns the index of the point [n] whose objectives are all within `part` of their minima over the n points, or -1.
 * The differences are in parts of the range from the minimum to the maximum over the points and largest [n_objective].
 * Of several such points, it is the nearest to the minima. */
static int find_common(int n_objective, int n, const hf_front_point *const *point, const double *largest, double part)
{
    int common = -1;
    double least[HF_FRONT_OBJECTIVES_MAX], most[HF_FRONT_OBJECTIVES_MAX];
    for (int k = 0; k < n_objective; k++) {
        least[k] = INFINITY;
        most[k] = largest[k];
        for (int i = 0; i < n; i++) {
            if (point[i]->status != HF_OK) continue;
            least[k] = fmin(least[k], point[i]->objective[k]);
            most[k] = fmax(most[k], point[i]->objective[k]);
        }
    }
    for (int i = 0; i < n; i++) {
        double above = point[i]->status == HF_OK ? 0 : INFINITY;
        for (int k = 0; k < n_objective && point[i]->status == HF_OK; k++)
            if (most[k] - least[k] > NO_RANGE * most[k])
                above = fmax(above, (point[i]->objective[k] - least[k]) / (most[k] - least[k]));
        if (!(above <= part) || (common >= 0 && !(above < part))) continue;
        common = i;
        part = above;
    }
    return common;
}

/* Refines the design of a job by Levenberg-Marquardt. Multipliers are slopes of MAIN, so they are NaN if another
 * objective is minimised. Returns HF_OK, or a status that ends the whole search. */
static hf_status refine(const search *s, const job *j, double *design, room *own, hf_front_point *point)
{
    const hf_front_refine *t = s->t;
    const hf_watch_front limits = {j->least, j->most};
    hf_refine_result r;
    hf_form_result result;
    const hf_refine_watcher watcher = {.after = tell_step, .context = t->watcher};
    *point = (hf_front_point){.objective = {NAN, NAN, NAN}, .multiplier = {NAN, NAN, NAN}};
    hf_status status = hf_refine_run(&s->by_limits, t->lower, t->upper, t->max_iterations, &limits,
                                     t->watcher ? &watcher : NULL, design, &own->w, &r);
    if (status == HF_OK) status = hf_evaluate(t->evaluator, design, &own->w, &own->point, &result);
    if (t->stop && *t->stop) return HF_INTERRUPTED;
    if (status == HF_NO_MEMORY) return status;
    point->status = status;
    point->steps = r.iterations;
    point->is_converged = status == HF_OK && r.stop == HF_REFINE_CONVERGED;
    for (int k = 0; k < s->n_objective && status == HF_OK; k++) {
        point->objective[k] = result.objective[k];
        if (point->is_converged && j->least == s->role[MAIN]) point->multiplier[k] = r.multiplier[k];
    }
    return HF_OK;
}

/* Returns true if a point has not converged, or if a known point dominates it. */
static bool is_doubtful(const search *s, const job *j)
{
    if (j->found.status != HF_OK || !j->found.is_converged) return true;
    for (int l = 0; l < s->n_line; l++)
        for (int i = 0; i < s->line[l]->n_way; i++)
            if (hf_front_dominates(s->n_objective, s->line[l]->way[i]->found.objective, j->found.objective))
                return true;
    return false;
}

/* Finds the point of a job from its first design. If it is doubtful, searches again from the second design and keeps
 * the better point. */
static hf_status find(const search *s, job *j, room *own)
{
    size_t size = s->n_variable * sizeof(double);
    hf_front_point again;
    memcpy(j->design, j->from[0], size);
    if (j->met >= 0) HF_TRY(meet(s->t, j->met, j->least, s->range, j->design, &own->w));
    HF_TRY(refine(s, j, j->design, own, &j->found));
    if (!j->from[1] || !is_doubtful(s, j)) return HF_OK;
    double *design = j->design + s->n_variable; /* the second half of its memory */
    memcpy(design, j->from[1], size);
    HF_TRY(refine(s, j, design, own, &again));
    again.steps += j->found.steps;
    bool is_better =
        again.status == HF_OK && (j->found.status != HF_OK || again.objective[j->least] < j->found.objective[j->least]);
    if (is_better) {
        j->found = again;
        memcpy(j->design, design, size);
    }
    j->found.steps = again.steps;
    return HF_OK;
}

/* ---- many points at once ---- */

/* Forgets multipliers that are not slopes of the front. */
static void forget_multipliers(job *j)
{
    for (int k = 0; k < HF_FRONT_OBJECTIVES_MAX; k++)
        j->found.multiplier[k] = NAN;
}

/* Runs jobs in one thread until none is left. */
static void work(void *context, int i_room)
{
    search *s = context;
    room own;
    hf_status status = open_room(s->t, &own);
    while (status == HF_OK) {
        int i = hf_parallel_take(&s->queue);
        if (i < 0) break;
        status = find(s, &s->job[s->n_run + i], &own);
        if (s->job[s->n_run + i].is_point) count_point(s->t);
    }
    close_room(&own);
    s->of_room[i_room] = status;
}

/* Runs the jobs that were added. Each depends on earlier jobs only, so the number of threads does not change the
 * results. */
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

/* Limits objective k of a job, psi to no more than the requirements allow. */
static void limit(const search *s, job *j, int k, double most)
{
    bool is_required = s->objectives.replaces_psi && s->objectives.objective[k].settings.figure == HF_FIGURE_PSI;
    j->most[k] = is_required ? fmin(most, s->objectives.constraints->psi_most_m) : most;
}

/* Adds a job that minimises the objective with this role under a limit on THIRD, from the designs `first` and
 * `second`. */
static job *add(search *s, int role, double third_most, const double *first, const double *second)
{
    job *j = &s->job[s->n++];
    j->least = s->role[role];
    j->met = -1;
    for (int k = 0; k < s->n_objective; k++)
        limit(s, j, k, INFINITY);
    if (s->n_objective > 2) limit(s, j, s->role[THIRD], third_most);
    j->from[0] = first;
    j->from[1] = second;
    return j;
}

static double value_of(const search *s, const job *j, int role)
{
    return j->found.objective[s->role[role]];
}

/* Returns true if the minimum of the objective with this role is 0, compared with its range. */
static bool is_met(const search *s, const job *least, int role)
{
    double range = s->range[s->role[role]];
    return range > 0 && value_of(s, least, role) <= END_GIVES * range;
}

/* Adds a job that minimises the objective with this role next to the end `end` of role `of`, whose objective may rise
 * by END_GIVES of its range. If the minimum at that end is 0, and no other limit is active, the search begins with a
 * sum of squares. If that does not succeed, it begins again without. */
static job *begin_beside(search *s, int role, double third_most, const job *end, int of)
{
    job *j = add(s, role, third_most, end->design, NULL);
    limit(s, j, s->role[of], value_of(s, end, of) + END_GIVES * s->range[s->role[of]]);
    if ((of != THIRD && isfinite(third_most)) || !is_met(s, end, of)) return j;
    j->met = s->role[of];
    j->from[1] = j->from[0];
    return j;
}

/* Returns the distance of two points in parts of the ranges. */
static double distance(const search *s, const job *a, const job *b)
{
    double square = 0;
    for (int k = 0; k < s->n_objective; k++) {
        double part = s->range[k] > 0 ? (b->found.objective[k] - a->found.objective[k]) / s->range[k] : 0;
        square += part * part;
    }
    return sqrt(square);
}

/* ---- lines ---- */

/* Returns true if a is as good as b in MAIN and OTHER. */
static bool beats(const search *s, const job *a, const job *b)
{
    return value_of(s, a, MAIN) <= value_of(s, b, MAIN) && value_of(s, a, OTHER) <= value_of(s, b, OTHER);
}

/* Inserts a point into a line, and removes the points that it beats. Does nothing if the point has failed or is beaten
 * itself. */
static void join(const search *s, line *l, job *j)
{
    int at = 0, n = 0;
    if (j->found.status != HF_OK) return;
    for (int i = 0; i < l->n_way; i++)
        if (beats(s, l->way[i], j)) return;
    for (int i = 0; i < l->n_way; i++)
        if (!beats(s, j, l->way[i])) l->way[n++] = l->way[i];
    while (at < n && value_of(s, l->way[at], OTHER) < value_of(s, j, OTHER))
        at++;
    memmove(l->way + at + 1, l->way + at, (size_t)(n - at) * sizeof *l->way);
    l->way[at] = j;
    l->n_way = n + 1;
}

/* Adds a line whose ends are still to be found. */
static line *add_line(search *s, double third_most)
{
    line *l = &s->line_room[s->n_room++];
    s->line[s->n_line++] = l;
    l->most = third_most;
    return l;
}

/* Completes the lines from index `first` on, after the jobs of their new ends have been added. Next to each new end,
 * the other objective is minimised. If it gains more than END_GAINS, the design found becomes the end. */
static hf_status finish_lines(search *s, int first)
{
    HF_TRY(run(s));
    for (int i = first; i < s->n_line; i++)
        for (int e = 0; e < 2; e++) {
            line *l = s->line[i];
            if (l->is_new[e] && l->end[e]->found.status == HF_OK)
                l->beside[e] = begin_beside(s, 1 - e, l->most, l->end[e], e);
        }
    HF_TRY(run(s));
    for (int i = first; i < s->n_line; i++)
        for (int e = 0; e < 2; e++) {
            line *l = s->line[i];
            job *beside = l->beside[e];
            if (!beside || beside->found.status != HF_OK) continue;
            double gain = value_of(s, l->end[e], 1 - e) - value_of(s, beside, 1 - e);
            if (!(gain > END_GAINS * s->range[s->role[1 - e]])) continue;
            l->end[e] = beside;
            forget_multipliers(beside); /* of the limit of END_GIVES */
        }
    return HF_OK;
}

/* Adds the new ends of a line to the front, and both ends to the line. */
static void close_line(search *s, line *l)
{
    for (int e = 0; e < 2; e++) {
        if (l->is_new[e]) {
            s->point[s->n_point++] = l->end[e];
            count_point(s->t);
        }
        join(s, l, l->end[e]);
    }
}

/* ---- the ends ---- */

/* Sets the range of each objective: how far it rises above its own end at the ends of the others. */
static void measure_ranges(search *s, job *const end[])
{
    for (int r = 0; r < s->n_objective; r++) {
        double most = value_of(s, end[r], r);
        for (int i = 0; i < s->n_objective; i++)
            most = fmax(most, value_of(s, end[i], r));
        double range = most - value_of(s, end[r], r);
        s->range[s->role[r]] = range > NO_RANGE * fabs(most) ? range : 0;
    }
}

/* Chooses another MAIN of three objectives if the present one has no range. The other two then form the front. */
static void choose_main(search *s, job *end[])
{
    if (s->n_objective < 3 || s->range[s->role[MAIN]] > 0) return;
    int role = s->role[MAIN];
    job *first = end[MAIN];
    for (int r = MAIN; r < THIRD; r++) {
        s->role[r] = s->role[r + 1];
        end[r] = end[r + 1];
    }
    s->role[THIRD] = role;
    end[THIRD] = first;
    forget_multipliers(first); /* slopes of the old MAIN */
}

/* Minimises each objective alone, by its role. Returns HF_OK or the status of the failure; failed_end is then the
 * objective of an end without a design. */
static hf_status find_alone(search *s, job *alone[])
{
    const double *start[HF_FRONT_OBJECTIVES_MAX];
    room own;
    int n = s->n_objective;
    hf_status status = open_room(s->t, &own);
    for (int r = 0; r < n && status == HF_OK; r++)
        status = best_start(s->t, s->role[r], &own, s->largest, &start[r]);
    close_room(&own);
    HF_TRY(status);
    for (int r = 0; r < n; r++)
        alone[r] = add(s, r, INFINITY, start[r], start[(r + 1) % n]);
    HF_TRY(run(s));
    int found = n - 1; /* an end from which those begin again that have found no design */
    while (found > 0 && alone[found]->found.status != HF_OK)
        found--;
    for (int r = 0; r < n && alone[found]->found.status == HF_OK; r++)
        if (alone[r]->found.status != HF_OK) alone[r] = add(s, r, INFINITY, alone[found]->design, NULL);
    HF_TRY(run(s));
    for (int k = 0; k < n; k++)
        for (int r = 0; r < n; r++) {
            if (s->role[r] != k || alone[r]->found.status == HF_OK) continue;
            s->failed_end = k;
            return alone[r]->found.status;
        }
    return HF_OK;
}

/* If the minimum of every objective is 0, searches for one design that reaches all of them. */
static hf_status meet_all(search *s, job *const alone[])
{
    for (int r = 0; r < s->n_objective; r++)
        if (!is_met(s, alone[r], r)) return HF_OK;
    job *j = add(s, MAIN, INFINITY, alone[MAIN]->design, NULL);
    j->met = j->least;
    for (int r = OTHER; r < s->n_objective; r++)
        limit(s, j, s->role[r], value_of(s, alone[r], r) + END_GIVES * s->range[s->role[r]]);
    return run(s);
}

/* Returns true if one of the designs at the ends is best in all objectives. It is then the only point of the front. */
static bool take_common(search *s)
{
    const hf_front_point *found[ENDS_MAX];
    for (int i = 0; i < s->n; i++)
        found[i] = &s->job[i].found;
    int common = find_common(s->n_objective, s->n, found, s->largest, AGREE);
    if (common < 0) return false;
    s->point[0] = &s->job[common];
    s->n_point = 1;
    s->n_line = 0;
    forget_multipliers(s->point[0]);
    return true;
}

/* Finds the line without a limit on THIRD, and the line at the minimum of THIRD. */
static hf_status find_ends(search *s)
{
    job *end[HF_FRONT_OBJECTIVES_MAX];
    HF_TRY(find_alone(s, end));
    measure_ranges(s, end);
    choose_main(s, end);
    HF_TRY(meet_all(s, end));
    if (take_common(s)) return HF_OK;
    double main = s->range[s->role[MAIN]], other = s->range[s->role[OTHER]];
    double third = s->n_objective > 2 ? s->range[s->role[THIRD]] : 0;
    if (!(main > 0 && (other > 0 || third > 0))) { /* MAIN has no trade-off: the ends are the front */
        for (int r = 0; r < s->n_objective; r++)
            s->point[s->n_point++] = end[r];
        return HF_OK;
    }
    line *bottom = NULL;
    if (third > 0) {
        bottom = add_line(s, value_of(s, end[THIRD], THIRD) + END_GIVES * third);
        for (int e = 0; e < 2; e++)
            bottom->end[e] = begin_beside(s, e, bottom->most, end[THIRD], THIRD);
        bottom->is_new[MAIN] = bottom->is_new[OTHER] = true;
    }
    line *top = add_line(s, INFINITY);
    for (int e = 0; e < 2; e++) {
        top->end[e] = end[e];
        top->is_new[e] = true;
    }
    HF_TRY(finish_lines(s, 0));
    if (take_common(s)) return HF_OK;
    for (int e = 0; e < 2; e++) {
        end[e] = top->end[e];
        if (!bottom || bottom->end[e]->found.status == HF_OK) continue;
        s->failed_end = s->role[THIRD];
        return bottom->end[e]->found.status;
    }
    if (bottom) end[THIRD] = bottom->end[MAIN];
    measure_ranges(s, end);
    if (bottom && distance(s, bottom->end[MAIN], bottom->end[OTHER]) < ONE_POINT) {
        bottom->end[OTHER] = bottom->end[MAIN];
        bottom->is_new[OTHER] = false;
    }
    for (int l = 0; l < s->n_line; l++)
        close_line(s, s->line[l]);
    return HF_OK;
}

/* ---- gaps ---- */

/* Returns true if there may be a point between two neighbours of a line. If the limit on THIRD is active at neither of
 * them, the points between them belong to a line with a higher limit. */
static bool is_open(const search *s, const line *l, const job *low, const job *high)
{
    if (low->closed == high) return false;
    if (!(value_of(s, high, OTHER) - value_of(s, low, OTHER) > NO_GAP * s->range[s->role[OTHER]])) return false;
    if (!isfinite(l->most)) return true;
    return fmax(value_of(s, low, THIRD), value_of(s, high, THIRD)) > l->most - HELD * s->range[s->role[THIRD]];
}

/* Computes the lengths of all gaps on the lines; 0 if there is no room for a point. Returns the maximum. */
static double measure_gaps(search *s)
{
    double longest = 0;
    for (int k = 0; k < s->n_line; k++) {
        line *l = s->line[k];
        for (int i = 0; i + 1 < l->n_way; i++) {
            l->length[i] = is_open(s, l, l->way[i], l->way[i + 1]) ? distance(s, l->way[i], l->way[i + 1]) : 0;
            longest = fmax(longest, l->length[i]);
        }
    }
    return longest;
}

/* Halves up to n_more of the longest gaps. A search begins at the neighbour with the tighter limit, which also keeps
 * the new limit. */
static hf_status halve_gaps(search *s, int n_more, double longest)
{
    line *of[HF_FRONT_POINTS_MAX];
    int first = s->n;
    for (; n_more > 0; n_more--) {
        line *l = NULL;
        int at = 0;
        for (int k = 0; k < s->n_line; k++)
            for (int i = 0; i + 1 < s->line[k]->n_way; i++) {
                if (l && !(s->line[k]->length[i] > l->length[at])) continue;
                l = s->line[k];
                at = i;
            }
        if (!l || !(l->length[at] > LONG_GAP * longest)) break;
        l->length[at] = 0;
        job *low = l->way[at], *high = l->way[at + 1];
        of[s->n - first] = l;
        job *j = add(s, MAIN, l->most, low->design, high->design);
        j->most[s->role[OTHER]] = (value_of(s, low, OTHER) + value_of(s, high, OTHER)) / 2;
        j->is_point = true;
        low->closed = high; /* the gap is closed until a point comes between them */
    }
    HF_TRY(run(s));
    for (int i = first; i < s->n; i++) {
        s->point[s->n_point++] = &s->job[i];
        join(s, of[i - first], &s->job[i]);
    }
    return HF_OK;
}

/* Returns the maximum of THIRD at the ends of a line. */
static double third_of(const search *s, const line *l)
{
    return fmax(value_of(s, l->end[MAIN], THIRD), value_of(s, l->end[OTHER], THIRD));
}

/* Computes the distances between the ends of neighbouring lines; 0 if there is no room for a line. Returns the
 * maximum. */
static double measure_lines(search *s)
{
    double longest = 0;
    for (int i = 0; i + 1 < s->n_line; i++) {
        line *l = s->line[i], *next = s->line[i + 1];
        bool fits = l->closed != next && third_of(s, next) - third_of(s, l) > NO_GAP * s->range[s->role[THIRD]];
        l->gap =
            fits ? fmax(distance(s, l->end[MAIN], next->end[MAIN]), distance(s, l->end[OTHER], next->end[OTHER])) : 0;
        longest = fmax(longest, l->gap);
    }
    return longest;
}

/* Inserts the new lines in the order of their limits. A line without an end is removed, and no other line is sought
 * between the same neighbours. */
static void place_lines(search *s, int first, line *const *tight)
{
    int n_new = s->n_line - first;
    line *new[HF_FRONT_POINTS_MAX];
    memcpy(new, s->line + first, (size_t)n_new * sizeof *new);
    s->n_line = first;
    for (int i = 0; i < n_new; i++) {
        int at = 0;
        close_line(s, new[i]);
        while (s->line[at] != tight[i])
            at++;
        if (new[i]->end[MAIN]->found.status != HF_OK || new[i]->end[OTHER]->found.status != HF_OK) {
            s->line[at]->closed = s->line[at + 1];
            continue;
        }
        memmove(s->line + at + 2, s->line + at + 1, (size_t)(s->n_line - at - 1) * sizeof(line *));
        s->line[at + 1] = new[i];
        s->n_line++;
    }
}

/* Adds up to n_more lines in the longest gaps between lines, with the mean of the THIRD of both neighbours as their
 * limit. The ends of the tighter neighbour keep this limit, so the searches begin there. An end of the looser one that
 * also keeps it is an end of the new line. */
static hf_status halve_lines(search *s, int n_more, double longest)
{
    line *tight[HF_FRONT_POINTS_MAX];
    int first = s->n_line;
    for (; n_more > 0; n_more--) {
        int at = 0;
        for (int i = 1; i + 1 < first; i++)
            if (s->line[i]->gap > s->line[at]->gap) at = i;
        if (!(s->line[at]->gap > LONG_GAP * longest)) break;
        line *low = s->line[at], *high = s->line[at + 1];
        low->gap = 0;
        tight[s->n_line - first] = low;
        line *l = add_line(s, (third_of(s, low) + third_of(s, high)) / 2);
        for (int e = 0; e < 2; e++) {
            l->is_new[e] = value_of(s, high->end[e], THIRD) > l->most;
            l->end[e] = l->is_new[e] ? add(s, e, l->most, low->end[e]->design, high->end[e]->design) : high->end[e];
        }
    }
    HF_TRY(finish_lines(s, first));
    place_lines(s, first, tight);
    return HF_OK;
}

/* Adds points in the longest gaps, on lines or between them, until there are n_point points or no gap is left. */
static hf_status fill(search *s)
{
    while (s->n_point < s->t->n_point) {
        int before = s->n_point, n_more = s->t->n_point - s->n_point;
        double longest = measure_gaps(s), between = measure_lines(s);
        if (between > longest && n_more > 1)
            HF_TRY(halve_lines(s, n_more / 2, between));
        else
            HF_TRY(halve_gaps(s, n_more, longest));
        if (s->n_point == before) break;
    }
    return HF_OK;
}

/* ---- the front ---- */

/* Allocates the arrays. Each point needs one job. Each end of a line needs another one for the minimum next to it. */
static hf_status allocate(search *s, void **block)
{
    size_t n = (size_t)s->n_job, n_line = s->n_objective > 2 ? (size_t)s->t->n_point + 2 : 1;
    job **way;
    double *length, *design;
    HF_TRY(HF_ARENA_ARRAYS(block, HF_ARRAY(s->job, n), HF_ARRAY(s->point, n), HF_ARRAY(s->line_room, n_line),
                           HF_ARRAY(s->line, n_line), HF_ARRAY(s->of_room, s->t->n_thread), HF_ARRAY(way, n_line * n),
                           HF_ARRAY(length, n_line * n), HF_ARRAY(design, 2 * n * s->n_variable)));
    for (size_t i = 0; i < n_line; i++) {
        s->line_room[i].way = way + i * n;
        s->line_room[i].length = length + i * n;
    }
    for (size_t i = 0; i < n; i++)
        s->job[i].design = design + 2 * i * s->n_variable;
    return HF_OK;
}

/* Creates the front from the points found. */
static hf_status hand_over(const search *s, hf_front *front)
{
    HF_TRY(hf_front_create(s->n_objective, (int)s->n_variable, s->n_point, front));
    front->minimised = s->role[MAIN];
    for (int i = 0; i < s->n_point; i++) {
        const job *j = s->point[i];
        double *design = front->design + (size_t)i * s->n_variable;
        front->point[i] = j->found;
        for (size_t k = 0; k < s->n_variable; k++)
            design[k] = j->found.status == HF_OK ? j->design[k] : (double)NAN;
    }
    hf_front_settle(front);
    return HF_OK;
}

hf_status hf_front_refine_find(const hf_front_refine *task, hf_front *front, int *failed_end)
{
    hf_front_refine t = *task;
    /* Each point is found in one thread, so this copy of the evaluator has one. */
    hf_evaluator alone = *task->evaluator;
    void *block;
    if (t.n_thread <= 0) t.n_thread = hf_parallel_cores();
    search s = {.t = &t, .failed_end = -1, .n_variable = (size_t)t.evaluator->model->n_variable};
    alone.n_thread = 1;
    t.evaluator = &alone;
    *front = (hf_front){.minimised = -1, .knee = -1};
    *failed_end = -1;
    s.objectives = *alone.objectives;
    s.n_objective = s.objectives.n_objective;
    for (int k = 0; k < s.n_objective && s.objectives.constraints; k++)
        s.objectives.replaces_psi |=
            s.objectives.objective[k].settings.figure == HF_FIGURE_PSI && s.objectives.constraints->psi_most_m > 0;
    s.by_limits = alone;
    s.by_limits.objectives = &s.objectives;
    s.n_job = s.n_objective > 2 ? 2 * t.n_point + 10 : t.n_point + 5;
    choose_roles(t.evaluator->objectives, s.role);
    HF_TRY(allocate(&s, &block));
    hf_status status = find_ends(&s);
    if (status == HF_OK) status = fill(&s);
    if (status == HF_OK) status = hand_over(&s, front);
    hf_arena_free_block(block);
    *failed_end = s.failed_end;
    return status;
}
