/* Contents: what a case asks for - creation - sizes of which the largest counts - residuals - derivatives */
#include <hifdm/goals.h>

#include "base/arena.h"
#include "linalg/dot.h"
#include "net/cable_pick.h"
#include "solve/cloud.h"
#include "solve/newton_matrix.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- what a case asks for ---- */

static const hf_goal_settings psi_alone = {.goal = HF_GOAL_PSI, .target = NAN, .weight = 1, .mass_kg_per_m = NAN};

static bool is_on_surface(hf_goal_kind kind)
{
    return kind == HF_GOAL_SURFACE || kind == HF_GOAL_FACETS;
}

static bool has_set(hf_goal_kind kind)
{
    return kind == HF_GOAL_TENSION || kind == HF_GOAL_LENGTH || kind == HF_GOAL_EVENNESS || kind == HF_GOAL_MASS ||
           kind == HF_GOAL_RATIO;
}

bool hf_goals_is_largest(hf_goal_kind kind)
{
    return kind == HF_GOAL_PULL || kind == HF_GOAL_DISPLACEMENT || kind == HF_GOAL_RATIO;
}

/* What is wrong with a goal in this scene, as the end of a sentence, or NULL. */
static const char *fault_of(const hf_goal *g, const hf_model *m, const hf_surface_settings *surface,
                            const hf_facets *facets)
{
    const hf_goal_settings *s = &g->wanted;
    if (is_on_surface(s->goal) && (!surface || !(surface->focal_length_m > 0)))
        return "needs the wanted surface: add a section surface (of an imported net with focal_length_m)";
    if (s->goal == HF_GOAL_FACETS && (!facets || facets->n_facet == 0)) return "this net has no facets";
    if (s->goal == HF_GOAL_SURFACE && s->fit == HF_FIT_BEST && m->n_inner_node < HF_FIT_N_PARAMETER)
        return "a best fit needs at least six inner nodes";
    if (s->goal == HF_GOAL_TENSION && isnan(s->target)) return "needs a target, in N";
    if (s->goal == HF_GOAL_MASS && !(s->mass_kg_per_m > 0)) return "needs mass_kg_per_m, of the cables of its set";
    if (s->goal == HF_GOAL_EVENNESS && g->n_cable == 1) return "one cable is always even; name a set of several";
    if (s->goal == HF_GOAL_RATIO && g->n_cable == 1) return "the ratio of one cable is 1; name a set of several";
    if (s->goal == HF_GOAL_PULL && m->n_node == m->n_free) return "this net has no supports";
    if (s->goal == HF_GOAL_DISPLACEMENT && m->n_attachment == 0)
        return "needs a truss that gives way: this net has none";
    return NULL;
}

static int row_count(const hf_goals *goals, const hf_goal *g)
{
    const hf_model *m = goals->model;
    switch (g->wanted.goal) {
    case HF_GOAL_PSI:
        return 3 * m->n_inner_node;
    case HF_GOAL_PULL:
        return m->n_node - m->n_free;
    case HF_GOAL_DISPLACEMENT:
        return m->n_attachment;
    case HF_GOAL_MASS:
        return 1;
    case HF_GOAL_RATIO:
        return 2 * g->n_cable;
    case HF_GOAL_SURFACE:
    case HF_GOAL_FACETS:
        return hf_cloud_size(goals, g);
    default:
        return g->n_cable;
    }
}

/* ---- creation ---- */

static void lay_out(hf_arena *a, const hf_model *m, hf_goals *goals)
{
    for (int k = 0; k < goals->n_goal; k++)
        goals->goal[k].cable =
            has_set(goals->goal[k].wanted.goal) ? hf_arena_take(a, (size_t)m->n_cable, sizeof(int)) : NULL;
    goals->corner_row = hf_arena_take(a, 4 * (size_t)goals->n_facet, sizeof(int));
}

hf_status hf_goals_create(const hf_scene *scene, const hf_model *m, const hf_optimize_settings *s,
                          const hf_surface_settings *surface, const hf_facets *facets, hf_goals *goals,
                          hf_messages *messages)
{
    hf_arena arena = {0};
    int n_fault = 0;
    bool is_front = s->n_objective > 0;
    *goals = (hf_goals){.model = m, .n_goal = is_front ? s->n_objective : s->n_goal > 0 ? s->n_goal : 1};
    for (int k = 0; k < goals->n_goal; k++) {
        goals->goal[k].wanted = is_front ? s->objective[k] : s->n_goal > 0 ? s->goal[k] : psi_alone;
        if (is_front) goals->goal[k].wanted.weight = 1;
        if (goals->goal[k].wanted.goal == HF_GOAL_FACETS && facets) goals->n_facet = facets->n_facet;
    }
    if (surface) {
        goals->kind = surface->kind;
        goals->focal_length_m = surface->focal_length_m;
    }
    if (HF_ARENA_MAKE(&arena, lay_out(&arena, m, goals)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the goals");
    goals->block = arena.block;
    for (int i = 0; i < 4 * goals->n_facet; i++)
        goals->corner_row[i] = m->row_of_node[facets->corner[i]];
    for (int k = 0; k < goals->n_goal; k++) {
        hf_goal *g = &goals->goal[k];
        char where[HF_PLACE_SIZE];
        const char *list = is_front ? "objectives" : "goals";
        hf_messages_place(messages, where, "optimize.%s.%d.set", list, k);
        if (g->cable) g->n_cable = hf_cable_pick_some(scene, g->wanted.set, where, g->cable, messages);
        bool is_known = !g->cable || g->n_cable > 0;
        const char *fault = is_known ? fault_of(g, m, surface, facets) : NULL;
        hf_messages_place(messages, where, "optimize.%s.%d", list, k);
        if (fault) hf_error(messages, HF_BAD_CASE, "%s: %s: %s", where, hf_goal_word[g->wanted.goal], fault);
        n_fault += !is_known || fault;
        g->n_row = row_count(goals, g);
        goals->n_row += g->n_row;
    }
    return n_fault ? HF_BAD_CASE : HF_OK;
}

const char *hf_goals_name(const hf_goals *goals, int i_goal, char text[HF_GOAL_NAME_SIZE])
{
    const hf_goal_settings *s = &goals->goal[i_goal].wanted;
    snprintf(text, HF_GOAL_NAME_SIZE, "goal_%d_%s%s%s", i_goal, hf_goal_word[s->goal], *s->set ? "_" : "", s->set);
    return text;
}

void hf_goals_free(hf_goals *goals)
{
    hf_arena arena = {.block = goals->block};
    hf_arena_free(&arena);
    *goals = (hf_goals){0};
}

static void lay_out_point(hf_arena *a, const hf_goals *goals, hf_goals_point *p)
{
    const hf_model *m = goals->model;
    size_t n_support = (size_t)(m->n_node - m->n_free), n_size = n_support; /* attachments are supports */
    for (int k = 0; k < goals->n_goal; k++)
        if (goals->goal[k].wanted.goal == HF_GOAL_RATIO && n_size < (size_t)goals->goal[k].n_row)
            n_size = (size_t)goals->goal[k].n_row;
    p->psi_per_m = hf_arena_take(a, (size_t)m->n_inner_node, sizeof(double));
    p->force_N = hf_arena_take(a, 3 * n_support, sizeof(double));
    p->rate_N = hf_arena_take(a, 3 * n_support, sizeof(double));
    p->size = hf_arena_take(a, n_size, sizeof(double));
    p->row = hf_arena_take(a, (size_t)goals->n_row, sizeof(double));
    p->cloud = hf_arena_take(a, (size_t)goals->n_goal, sizeof *p->cloud);
    for (int k = 0; k < goals->n_goal; k++) {
        hf_cloud cloud = {0};
        if (is_on_surface(goals->goal[k].wanted.goal)) hf_cloud_lay_out(a, goals, &goals->goal[k], &cloud);
        if (a->block) p->cloud[k] = cloud;
    }
}

hf_status hf_goals_point_create(const hf_goals *goals, hf_goals_point *point)
{
    hf_arena arena = {0};
    *point = (hf_goals_point){0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out_point(&arena, goals, point)));
    point->block = arena.block;
    return HF_OK;
}

void hf_goals_point_free(hf_goals_point *point)
{
    hf_arena arena = {.block = point->block};
    hf_arena_free(&arena);
    *point = (hf_goals_point){0};
}

/* ---- sizes of which the largest counts ---- */

/* The smooth largest of n sizes is P = (sum s^16)^(1/16), and the residuals s^8/P^7 have the norm P. Returns the
 * largest size; size [n] becomes s/P. */
static double smooth_largest(int n, double *size, double *norm)
{
    double largest = 0, sum = 0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, size[i]);
    for (int i = 0; i < n && largest > 0; i++) {
        double part = size[i] / largest, square = part * part, fourth = square * square, eighth = fourth * fourth;
        sum += eighth * eighth;
    }
    *norm = largest * sqrt(sqrt(sqrt(sqrt(sum))));
    for (int i = 0; i < n; i++)
        size[i] = largest > 0 ? size[i] / *norm : 0;
    return largest;
}

static double seventh(double x)
{
    double square = x * x;
    return square * square * square * x;
}

/* rate [n]: changes of the sizes, then of the residuals; size [n]: s/P. Returns the change of P. */
static double push_smooth(int n, const double *size, double *rate)
{
    double norm_rate = 0;
    for (int i = 0; i < n; i++)
        norm_rate += seventh(size[i]) * seventh(size[i]) * size[i] * rate[i];
    for (int i = 0; i < n; i++)
        rate[i] = seventh(size[i]) * (8 * rate[i] - 7 * size[i] * norm_rate);
    return norm_rate;
}

static double norm3(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Add `pull` of cable e at its first end, and its opposite at the other, to the forces on those ends that are supports.
 */
static void add_pull(const hf_model *m, int e, const double pull[3], double *force_N)
{
    for (int end = 0; end < 2; end++) {
        int support = m->end_row[2 * e + end] - m->n_free;
        for (int c = 0; c < 3 && support >= 0; c++)
            force_N[3 * support + c] += end ? -pull[c] : pull[c];
    }
}

static bool is_at_support(const hf_model *m, int e)
{
    return m->end_row[2 * e] >= m->n_free || m->end_row[2 * e + 1] >= m->n_free;
}

void hf_goals_pulls(const hf_model *m, const hf_workspace *w, hf_goals_point *p)
{
    int n = m->n_node - m->n_free;
    memset(p->force_N, 0, 3 * (size_t)n * sizeof(double));
    for (int e = 0; e < m->n_cable; e++) {
        double u[3];
        if (!is_at_support(m, e)) continue;
        hf_newton_matrix_direction(m, w->position_m, e, u);
        for (int c = 0; c < 3; c++)
            u[c] *= w->tension_N[e];
        add_pull(m, e, u, p->force_N);
    }
    for (int i = 0; i < n; i++)
        p->size[i] = norm3(p->force_N + 3 * (size_t)i);
}

/* ---- residuals ---- */

/* Of psi; hf_metrics_psi_m leaves loose nodes out, too. */
static double measure_psi(const hf_model *m, const hf_workspace *w, hf_goals_point *p, double *f)
{
    int n = 0;
    for (int k = 0; k < m->n_inner_node; k++)
        n += !w->loose[m->inner_row[k]];
    for (int k = 0; k < m->n_inner_node; k++) {
        int row = m->inner_row[k];
        p->psi_per_m[k] = w->loose[row] ? 0 : 1 / sqrt(n);
        for (int c = 0; c < 3; c++, row += m->n_node)
            f[3 * k + c] = p->psi_per_m[k] > 0 ? p->psi_per_m[k] * (w->position_m[row] - m->position_m[row]) : 0;
    }
    return hf_metrics_psi_m(m, w);
}

static double mean_tension_N(const hf_goal *g, const hf_workspace *w)
{
    double sum = 0;
    for (int i = 0; i < g->n_cable; i++)
        sum += w->tension_N[g->cable[i]];
    return sum / g->n_cable;
}

/* Of tension, length, evenness and mass. */
static void measure_cables(const hf_goal *g, const hf_model *m, const hf_workspace *w, double *f)
{
    const hf_goal_settings *s = &g->wanted;
    double root = sqrt(g->n_cable), mean_N = s->goal == HF_GOAL_EVENNESS ? mean_tension_N(g, w) : 0, mass_kg = 0;
    for (int i = 0; i < g->n_cable; i++) {
        int e = g->cable[i];
        switch (s->goal) {
        case HF_GOAL_TENSION:
            f[i] = (w->tension_N[e] - s->target) / root;
            break;
        case HF_GOAL_LENGTH:
            f[i] = (w->length_m[e] - (isnan(s->target) ? m->length_m[e] : s->target)) / root;
            break;
        case HF_GOAL_EVENNESS:
            f[i] = (w->tension_N[e] / mean_N - 1) / root;
            break;
        default:
            mass_kg += w->length_m[e] * s->mass_kg_per_m;
            break;
        }
    }
    if (s->goal == HF_GOAL_MASS) f[0] = mass_kg;
}

/* f [n] from the n sizes in the point, which become parts of the smooth largest; returns the true largest. */
static double measure_largest(int n, hf_goals_point *p, double *f)
{
    double norm, largest = smooth_largest(n, p->size, &norm);
    for (int i = 0; i < n; i++)
        f[i] = norm * seventh(p->size[i]) * p->size[i];
    return largest;
}

static void take_displacements(const hf_model *m, const hf_workspace *w, hf_goals_point *p)
{
    for (int i = 0; i < m->n_attachment; i++)
        p->size[i] = norm3(w->displacement_m + 3 * (size_t)i);
}

/* The largest over the smallest of n tensions is the largest T times the largest 1/T, each of them smooth as above: A
 * and B. size [2n] becomes T/A and 1/(T B); returns A B. */
static double smooth_ratio(const hf_goal *g, const hf_workspace *w, double *size, double *high, double *low)
{
    int n = g->n_cable;
    for (int i = 0; i < n; i++) {
        size[i] = w->tension_N[g->cable[i]];
        size[n + i] = 1 / size[i];
    }
    smooth_largest(n, size, high);
    smooth_largest(n, size + n, low);
    return *high * *low;
}

/* f [2n] has the norm A B; with a slack cable or a strut there is no ratio. Returns the true ratio. */
static double measure_ratio(const hf_goal *g, const hf_model *m, const hf_workspace *w, hf_goals_point *p, double *f,
                            double *norm)
{
    double high, low, ratio = hf_metrics_set_ratio(m, w, g->n_cable, g->cable);
    *norm = ratio;
    memset(f, 0, (size_t)g->n_row * sizeof *f);
    if (!isfinite(ratio)) return ratio;
    *norm = smooth_ratio(g, w, p->size, &high, &low);
    for (int i = 0; i < g->n_row; i++)
        f[i] = sqrt(0.5) * *norm * seventh(p->size[i]) * p->size[i];
    return ratio;
}

/* Residuals of goal k without its weight, and their norm; *value as hf_goals_measure tells it. */
static hf_status measure_goal(const hf_goals *goals, int k, const hf_workspace *w, hf_goals_point *p, double *f,
                              double *value, double *norm)
{
    const hf_model *m = goals->model;
    const hf_goal *g = &goals->goal[k];
    bool has_own_value = true;
    switch (g->wanted.goal) {
    case HF_GOAL_PSI:
        *value = *norm = measure_psi(m, w, p, f);
        return HF_OK;
    case HF_GOAL_PULL:
        hf_goals_pulls(m, w, p);
        *value = measure_largest(g->n_row, p, f);
        break;
    case HF_GOAL_DISPLACEMENT:
        take_displacements(m, w, p);
        *value = measure_largest(g->n_row, p, f);
        break;
    case HF_GOAL_RATIO:
        *value = measure_ratio(g, m, w, p, f, norm);
        return HF_OK;
    case HF_GOAL_SURFACE:
    case HF_GOAL_FACETS:
        HF_TRY(hf_cloud_measure(&p->cloud[k], w, f));
        has_own_value = false;
        break;
    default:
        measure_cables(g, m, w, f);
        has_own_value = false;
    }
    *norm = sqrt(hf_dot((size_t)g->n_row, f, f));
    if (!has_own_value) *value = *norm;
    return HF_OK;
}

/* All goals into f [n_row], weighted. */
static hf_status measure_all(const hf_goals *goals, const hf_workspace *w, hf_goals_point *p, double *f, double *value,
                             double *merit)
{
    double square = 0, norm = 0;
    for (int k = 0; k < goals->n_goal; f += goals->goal[k++].n_row) {
        double weight = goals->goal[k].wanted.weight, one;
        HF_TRY(measure_goal(goals, k, w, p, f, value ? &value[k] : &one, &norm));
        for (int i = 0; i < goals->goal[k].n_row; i++)
            f[i] *= weight;
        norm *= weight;
        square += norm * norm;
    }
    *merit = goals->n_goal == 1 ? norm : sqrt(square);
    return HF_OK;
}

hf_status hf_goals_measure(const hf_goals *goals, const hf_workspace *w, hf_goals_point *p, double *value,
                           double *merit)
{
    return measure_all(goals, w, p, p->row, value, merit);
}

hf_status hf_goals_linearise(const hf_goals *goals, const hf_workspace *w, hf_goals_point *p, double *residual)
{
    double merit;
    HF_TRY(measure_all(goals, w, p, residual, NULL, &merit));
    if (!isfinite(merit)) return HF_NOT_FINITE;
    for (int k = 0; k < goals->n_goal; k++)
        if (is_on_surface(goals->goal[k].wanted.goal)) HF_TRY(hf_cloud_linearise(&p->cloud[k]));
    return HF_OK;
}

/* ---- derivatives ---- */

static void push_psi(const hf_model *m, const hf_goals_point *p, const double *move, double *rate)
{
    for (int k = 0; k < m->n_inner_node; k++)
        for (int c = 0; c < 3; c++)
            rate[3 * k + c] = p->psi_per_m[k] * move[c * m->n_node + m->inner_row[k]];
}

/* Change of the vector from the first end of cable e to the other. */
static void relative_move(const hf_model *m, int e, const double *move, double relative[3])
{
    for (int c = 0; c < 3; c++)
        relative[c] = move[c * m->n_node + m->end_row[2 * e + 1]] - move[c * m->n_node + m->end_row[2 * e]];
}

static double length_rate(const hf_model *m, const hf_workspace *w, int e, const double *move)
{
    double u[3], relative[3];
    hf_newton_matrix_direction(m, w->position_m, e, u);
    relative_move(m, e, move, relative);
    return u[0] * relative[0] + u[1] * relative[1] + u[2] * relative[2];
}

static void push_cables(const hf_goal *g, const hf_model *m, const hf_workspace *w, const hf_goals_rate *by,
                        double *rate)
{
    double root = sqrt(g->n_cable), mean_N = 0, mean_rate_N = 0, sum_m = 0;
    if (g->wanted.goal == HF_GOAL_EVENNESS) {
        mean_N = mean_tension_N(g, w);
        for (int i = 0; i < g->n_cable; i++)
            mean_rate_N += by->tension_N[g->cable[i]] / g->n_cable;
    }
    for (int i = 0; i < g->n_cable; i++) {
        int e = g->cable[i];
        switch (g->wanted.goal) {
        case HF_GOAL_TENSION:
            rate[i] = by->tension_N[e] / root;
            break;
        case HF_GOAL_LENGTH:
            rate[i] = length_rate(m, w, e, by->position_m) / root;
            break;
        case HF_GOAL_EVENNESS:
            rate[i] = (by->tension_N[e] - w->tension_N[e] * (mean_rate_N / mean_N)) / (mean_N * root);
            break;
        default:
            sum_m += length_rate(m, w, e, by->position_m);
            break;
        }
    }
    if (g->wanted.goal == HF_GOAL_MASS) rate[0] = g->wanted.mass_kg_per_m * sum_m;
}

/* Change of the size of a vector. */
static double size_rate(const double v[3], const double rate[3])
{
    double size = norm3(v);
    return size > 0 ? (v[0] * rate[0] + v[1] * rate[1] + v[2] * rate[2]) / size : 0;
}

void hf_goals_pull_rates(const hf_model *m, const hf_workspace *w, hf_goals_point *p, const hf_goals_rate *by,
                         double *rate)
{
    int n = m->n_node - m->n_free;
    memset(p->rate_N, 0, 3 * (size_t)n * sizeof(double));
    hf_goals_pulls(m, w, p);
    for (int e = 0; e < m->n_cable; e++) {
        double u[3], pull[3];
        if (!is_at_support(m, e)) continue;
        double length = hf_newton_matrix_direction(m, w->position_m, e, u);
        relative_move(m, e, by->position_m, pull);
        double along = u[0] * pull[0] + u[1] * pull[1] + u[2] * pull[2];
        for (int c = 0; c < 3; c++)
            pull[c] = by->tension_N[e] * u[c] + w->tension_N[e] * ((pull[c] - along * u[c]) / length);
        add_pull(m, e, pull, p->rate_N);
    }
    for (int i = 0; i < n; i++)
        rate[i] = size_rate(p->force_N + 3 * (size_t)i, p->rate_N + 3 * (size_t)i);
}

static void push_pulls(const hf_model *m, const hf_workspace *w, hf_goals_point *p, const hf_goals_rate *by,
                       double *rate)
{
    int n = m->n_node - m->n_free;
    double norm;
    hf_goals_pull_rates(m, w, p, by, rate);
    smooth_largest(n, p->size, &norm);
    push_smooth(n, p->size, rate);
}

static void push_displacements(const hf_model *m, const hf_workspace *w, hf_goals_point *p, const hf_goals_rate *by,
                               double *rate)
{
    double norm;
    take_displacements(m, w, p);
    smooth_largest(m->n_attachment, p->size, &norm);
    for (int i = 0; i < m->n_attachment; i++)
        rate[i] = size_rate(w->displacement_m + 3 * (size_t)i, by->displacement_m + 3 * (size_t)i);
    push_smooth(m->n_attachment, p->size, rate);
}

static void push_ratio(const hf_goal *g, const hf_workspace *w, hf_goals_point *p, const hf_goals_rate *by,
                       double *rate)
{
    int n = g->n_cable;
    double high, low;
    smooth_ratio(g, w, p->size, &high, &low);
    for (int i = 0; i < n; i++) {
        double tension = w->tension_N[g->cable[i]];
        rate[i] = by->tension_N[g->cable[i]];
        rate[n + i] = -rate[i] / (tension * tension);
    }
    double high_rate = push_smooth(n, p->size, rate), low_rate = push_smooth(n, p->size + n, rate + n);
    for (int i = 0; i < n; i++) {
        double *of_high = &rate[i], *of_low = &rate[n + i];
        *of_high = sqrt(0.5) * (low * *of_high + high * low_rate * seventh(p->size[i]) * p->size[i]);
        *of_low = sqrt(0.5) * (high * *of_low + low * high_rate * seventh(p->size[n + i]) * p->size[n + i]);
    }
}

void hf_goals_push(const hf_goals *goals, const hf_workspace *w, hf_goals_point *p, const hf_goals_rate *by,
                   double *rate)
{
    const hf_model *m = goals->model;
    for (int k = 0; k < goals->n_goal; rate += goals->goal[k++].n_row) {
        const hf_goal *g = &goals->goal[k];
        switch (g->wanted.goal) {
        case HF_GOAL_PSI:
            push_psi(m, p, by->position_m, rate);
            break;
        case HF_GOAL_PULL:
            push_pulls(m, w, p, by, rate);
            break;
        case HF_GOAL_DISPLACEMENT:
            push_displacements(m, w, p, by, rate);
            break;
        case HF_GOAL_RATIO:
            push_ratio(g, w, p, by, rate);
            break;
        case HF_GOAL_SURFACE:
        case HF_GOAL_FACETS:
            hf_cloud_push(&p->cloud[k], by->position_m, rate);
            break;
        default:
            push_cables(g, m, w, by, rate);
        }
        for (int i = 0; i < g->n_row; i++)
            rate[i] *= g->wanted.weight;
    }
}
