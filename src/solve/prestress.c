/* Finds tensions that hold every free node at its target position, for form.prestress: exact (METHOD section 11).
 *
 *     scene and model: positions, laws, loads
 *         | required tensions and weights by law; minimum tensions
 *         v
 *     dual of (M27): displacements of the free nodes, tensions by (M28)  <----+
 *         | Newton's method without limits, then with them                    |
 *         v                                                                   |
 *     tensions; the mean of each family becomes the required tension  --------+
 *         | the means have settled, or no tensions hold the nodes
 *         v
 *     every cable under law force_density, or an error that names the nodes */
#include "solve/prestress.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "linalg/band.h"
#include "solve/newton_matrix.h"
#include <hifdm/cable_set.h>
#include <hifdm/model.h>

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* Weight of a cable whose law gives no tension, relative to that of one whose law does. */
#define FREE_WEIGHT 1e-2
/* Minimum tension over the reference tension: ten times the tension that counts as slack (HF_SLACK_RATIO). */
#define LEAST_RATIO 1e-2
/* Maximum nodal force, over the reference tension, at which the tensions are as exact as rounding permits. */
#define EXACT 1e-14
/* Maximum nodal force, over the reference tension, of tensions that hold the net. */
#define HELD 1e-10
/* If no tensions hold the net, a node counts as not held when its force is at least this part of the maximum one. */
#define OUT_OF_BALANCE 1e-3
/* Shift of the matrix over its maximum diagonal entry; a failed factorisation multiplies it by 100. */
#define SHIFT 1e-13
/* Part of its stiffness that a cable at its minimum tension keeps in the matrix, so that its nodes have some. */
#define AT_LEAST 1e-9
/* A given length is the user's own if it differs from that at the target positions by this part: tables have six
 * digits. */
#define OWN_LENGTH 1e-4
#define STEP_MAX 200
/* Maximum number of solutions for the means of families, and the change over the reference tension at which they have
 * settled. */
#define MEANS_MAX 10
#define MEANS_SETTLED 1e-5

/* ---- layout ---- */

/* The arrays of the programme (M27) for a model m; e is its number of cables. */
#define PROGRAMME_FIELDS(X)                                                                                            \
    X(double, wanted_N, e, "required tensions")                                                                        \
    X(double, least_N, e, "minimum tensions")                                                                          \
    X(double, weight, e, "weights of the cables")                                                                      \
    X(double, tension_N, e, "tensions under the multipliers")                                                          \
    X(double, unit, 3 * e, "[n_cable][3] from the first end to the second")                                            \
    X(int, family, e, "family of the cable")                                                                           \
    X(double, family_sum_N, to->n_family, "sum of tensions")                                                           \
    X(int, family_count, to->n_family, "number of cables")                                                             \
    X(bool, is_free, e, "its law gives no tension")                                                                    \
    X(bool, is_least, e, "at its minimum tension now")                                                                 \
    X(bool, was_least, e, "at its minimum tension in the factor")                                                      \
    X(double, multiplier, to->n, "displacements of the free nodes, by dof")                                            \
    X(double, trial, to->n, "multipliers at the end of a trial step")                                                  \
    X(double, force_N, to->n, "A T + P, N")                                                                            \
    X(double, step, to->n, "of the multipliers")                                                                       \
    X(double, band, (size_t)to->n *((size_t)to->half_bandwidth + 1), "[n][half_bandwidth+1] the factor of A W A'")

/* The programme (M27) and its dual (M28). The multipliers of the 3 n_free equations are displacements. As in a net of
 * linear springs, the tension of a cable rises by its stretch under them divided by its weight. */
typedef struct {
    const hf_model *m;
    int n, half_bandwidth, n_family;
    double reference_N;
    PROGRAMME_FIELDS(HF_ARENA_MEMBER)
    bool has_factor;
    const volatile sig_atomic_t *stop;
} programme;

/* ---- required tensions ---- */

static void set_wants(programme *p)
{
    const hf_model *m = p->m;
    bool is_any_given = false;
    for (int e = 0; e < m->n_cable; e++)
        is_any_given |= !hf_law_has(m->law[e], HF_LAW_HAS_MULTIPLIER);
    for (int e = 0; e < m->n_cable; e++) {
        const int *end = m->end_row + 2 * e;
        for (int c = 0; c < 3; c++)
            p->unit[3 * e + c] =
                (m->position_m[c * m->n_node + end[1]] - m->position_m[c * m->n_node + end[0]]) / m->length_m[e];
        bool is_density = m->law[e] == HF_LAW_FORCE_DENSITY, is_strut = is_density && m->target[e] < 0;
        bool moves_none = end[0] >= m->n_free && end[1] >= m->n_free; /* balance needs no tension of it */
        bool gives = is_density || hf_law_has(m->law[e], HF_LAW_GIVES_TENSION);
        p->is_free[e] = is_any_given && !moves_none && !gives;
        p->least_N[e] = is_strut ? -INFINITY : LEAST_RATIO * p->reference_N;
        p->wanted_N[e] = is_density ? m->target[e] * m->length_m[e] : p->is_free[e] ? p->least_N[e] : m->target[e];
        if (!is_any_given || (moves_none && !gives)) p->wanted_N[e] = m->pretension_N;
        p->weight[e] = p->is_free[e] ? FREE_WEIGHT : 1;
    }
}

int hf_prestress_family(const hf_scene *s, int e)
{
    int family = s->n_set + s->group[e], least = INT_MAX;
    for (int k = 0; k < s->n_set; k++) {
        int size = s->set_start[k + 1] - s->set_start[k];
        if (size < least && hf_cable_set_has(s, k, e)) family = k, least = size;
    }
    return family;
}

/* Sets the required tension of each cable whose law gives none to the mean of its family, so the tensions of a family
 * become similar. Returns the maximum change, N. */
static double want_means(programme *p)
{
    double change_N = 0;
    memset(p->family_sum_N, 0, (size_t)p->n_family * sizeof *p->family_sum_N);
    memset(p->family_count, 0, (size_t)p->n_family * sizeof *p->family_count);
    for (int e = 0; e < p->m->n_cable; e++) {
        if (!p->is_free[e]) continue;
        p->family_sum_N[p->family[e]] += p->tension_N[e];
        p->family_count[p->family[e]]++;
    }
    for (int e = 0; e < p->m->n_cable; e++) {
        if (!p->is_free[e]) continue;
        double mean_N = p->family_sum_N[p->family[e]] / p->family_count[p->family[e]];
        change_N = fmax(change_N, fabs(mean_N - p->wanted_N[e]));
        p->wanted_N[e] = mean_N;
    }
    return change_N;
}

/* ---- tensions and forces ---- */

static double component(const programme *p, const double *vector, int row, int c)
{
    return row < p->m->n_free ? vector[3 * row + c] : 0;
}

/* Sets the tensions under these multipliers [n], within their limits if is_bounded. Returns the dual function, which
 * has its minimum at the answer. */
static double set_tensions(programme *p, const double *multiplier, bool is_bounded)
{
    const hf_model *m = p->m;
    double value = 0;
    for (int e = 0; e < m->n_cable; e++) {
        double stretch = 0, wanted = p->wanted_N[e], least = p->least_N[e], weight = p->weight[e];
        for (int c = 0; c < 3; c++)
            stretch += p->unit[3 * e + c] * (component(p, multiplier, m->end_row[2 * e], c) -
                                             component(p, multiplier, m->end_row[2 * e + 1], c));
        double T = wanted + stretch / weight, bounded = fmax(T, least);
        p->is_least[e] = is_bounded && T < least;
        p->tension_N[e] = p->is_least[e] ? bounded : T;
        value += p->is_least[e] ? weight * ((least * least - wanted * wanted) / 2 + least * (T - least))
                                : weight * (T * T - wanted * wanted) / 2;
    }
    for (int i = 0; m->load_N && i < m->n_free; i++)
        for (int c = 0; c < 3; c++)
            value += m->load_N[c * m->n_node + i] * multiplier[3 * i + c];
    return value;
}

/* Sets the forces on the free nodes. Returns the maximum component, N. */
static double set_forces(programme *p)
{
    const hf_model *m = p->m;
    double largest = 0;
    for (int i = 0; i < p->n; i++)
        p->force_N[i] = m->load_N ? m->load_N[i % 3 * m->n_node + i / 3] : 0;
    for (int e = 0; e < m->n_cable; e++)
        for (int c = 0; c < 3; c++) {
            int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
            if (a < m->n_free) p->force_N[3 * a + c] += p->unit[3 * e + c] * p->tension_N[e];
            if (b < m->n_free) p->force_N[3 * b + c] -= p->unit[3 * e + c] * p->tension_N[e];
        }
    for (int i = 0; i < p->n; i++)
        if (!(fabs(p->force_N[i]) <= largest)) largest = fabs(p->force_N[i]); /* a NaN stays */
    return isfinite(largest) ? largest : (double)INFINITY;
}

/* ---- the dual problem ---- */

static void assemble_springs(programme *p)
{
    const hf_model *m = p->m;
    int column = p->half_bandwidth + 1;
    memset(p->band, 0, (size_t)p->n * (size_t)column * sizeof *p->band);
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e] < m->n_free ? m->end_row[2 * e] : -1;
        int b = m->end_row[2 * e + 1] < m->n_free ? m->end_row[2 * e + 1] : -1;
        double block[3][3];
        if (a < 0 && b < 0) continue;
        hf_newton_matrix_spring((p->is_least[e] ? AT_LEAST : 1) / p->weight[e], 0, p->unit + 3 * (size_t)e, block);
        hf_newton_matrix_add_block(p->band, column, a, b, block);
    }
}

static hf_status factor_springs(programme *p)
{
    size_t column = (size_t)p->half_bandwidth + 1;
    if (p->has_factor && !memcmp(p->is_least, p->was_least, (size_t)p->m->n_cable * sizeof(bool))) return HF_OK;
    memcpy(p->was_least, p->is_least, (size_t)p->m->n_cable * sizeof(bool));
    for (double shift = SHIFT; shift < 1; shift *= 100) {
        double largest = 0;
        assemble_springs(p);
        for (size_t i = 0; i < (size_t)p->n; i++)
            largest = fmax(largest, p->band[i * column]);
        for (size_t i = 0; i < (size_t)p->n; i++)
            p->band[i * column] += shift * largest;
        hf_status status = hf_band_factor_until(p->stop, p->n, p->half_bandwidth, p->band);
        p->has_factor = status == HF_OK;
        if (status != HF_SINGULAR) return status;
    }
    return HF_SINGULAR;
}

/* Takes one step of Newton's method on the dual function, halved until the function falls enough. `value` is the
 * function before the step. Returns the part of the step taken. The tensions and forces are those at its end, and
 * *largest_N becomes the maximum force. */
static double take_step(programme *p, bool is_bounded, double value, double *largest_N)
{
    double slope = 0, part = 1;
    for (int i = 0; i < p->n; i++)
        p->step[i] = -p->force_N[i];
    hf_band_back_solve(p->n, p->half_bandwidth, 1, p->band, p->step, p->n);
    for (int i = 0; i < p->n; i++)
        slope += p->step[i] * p->force_N[i];
    for (;; part /= 2) {
        for (int i = 0; i < p->n; i++)
            p->trial[i] = p->multiplier[i] + part * p->step[i];
        double fallen = value - set_tensions(p, p->trial, is_bounded);
        if (!is_bounded || fallen >= -1e-4 * part * slope || part < 1e-8) break;
        /* near the answer the function is flat to rounding, so the forces decide */
        if (set_forces(p) < *largest_N / 2) break;
    }
    memcpy(p->multiplier, p->trial, (size_t)p->n * sizeof *p->trial);
    *largest_N = set_forces(p);
    return part;
}

/* Minimises the dual function by Newton's method. It ends after finitely many steps because the function is quadratic
 * as long as the set of cables at their minimum tension does not change. *largest_N becomes the maximum remaining
 * force. Returns HF_OK, HF_SINGULAR or HF_INTERRUPTED. */
static hf_status solve_dual(programme *p, bool is_bounded, double *largest_N)
{
    double value = set_tensions(p, p->multiplier, is_bounded);
    *largest_N = set_forces(p);
    for (int i = 0; i<STEP_MAX && * largest_N> EXACT * p->reference_N; i++) {
        double before_N = *largest_N;
        HF_TRY(factor_springs(p));
        double part = take_step(p, is_bounded, value, largest_N);
        value = set_tensions(p, p->multiplier, is_bounded);
        bool is_same = !memcmp(p->is_least, p->was_least, (size_t)p->m->n_cable * sizeof(bool));
        /* if only rounding remains, a shortened step leads no nearer either */
        bool is_as_near = part == 1 || *largest_N <= HELD * p->reference_N;
        if (is_same && is_as_near && !(*largest_N < before_N / 2)) break;
    }
    return HF_OK;
}

/* Solves first without limits, which needs one factorisation and is the answer for most nets, then with limits. */
static hf_status solve_within_limits(programme *p, double *largest_N)
{
    HF_TRY(solve_dual(p, false, largest_N));
    set_tensions(p, p->multiplier, true);
    return solve_dual(p, true, largest_N);
}

/* ---- nodes that no tensions hold ---- */

static double node_force_N(const programme *p, int row)
{
    const double *f = p->force_N + 3 * (size_t)row;
    return hf_norm(f[0], f[1], f[2]);
}

static hf_status name_unheld(const programme *p, const hf_scene *scene, hf_messages *messages)
{
    const hf_model *m = p->m;
    char names[1600] = "";
    size_t used = 0;
    int n = 0;
    double largest_N = 0;
    for (int i = 0; i < m->n_free; i++)
        largest_N = fmax(largest_N, node_force_N(p, i));
    for (int i = 0; i < m->n_free; i++) {
        if (node_force_N(p, i) < OUT_OF_BALANCE * largest_N) continue;
        if (n++ < 5 && used < sizeof names)
            used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", n > 1 ? ", " : "",
                                     scene->node_id[m->node_of_row[i]]);
    }
    char more[32] = "";
    if (n > 5) snprintf(more, sizeof more, " and %d more", n - 5);
    return hf_error(messages, HF_BAD_CASE,
                    "form.prestress: exact: no tensions above zero hold %d of the %d free nodes at their target "
                    "positions: %s%s. Each of these nodes lacks a cable that pulls it back onto the surface. Tie these "
                    "nodes to a second net, or allow other positions (form.prestress: given)",
                    n, m->n_free, names, more);
}

/* ---- the scene ---- */

static hf_status find_tensions(programme *p, const hf_scene *scene, hf_messages *messages)
{
    double largest_N = INFINITY;
    set_wants(p);
    for (int e = 0; e < p->m->n_cable; e++)
        p->family[e] = hf_prestress_family(scene, e);
    hf_status status = solve_within_limits(p, &largest_N);
    for (int i = 0; i < MEANS_MAX && status == HF_OK && largest_N <= HELD * p->reference_N; i++) {
        if (want_means(p) <= MEANS_SETTLED * p->reference_N) break;
        status = solve_within_limits(p, &largest_N);
    }
    if (status == HF_OK && largest_N <= HELD * p->reference_N) return HF_OK;
    if (status == HF_INTERRUPTED)
        return hf_error(messages, status,
                        "form.prestress: exact: the run was interrupted before hifdm found the tensions");
    return name_unheld(p, scene, messages);
}

/* Warns about lengths of the user's own that are not used because the cables change their laws. */
static void tell_lengths(const hf_scene *s, hf_messages *messages)
{
    int n = 0, first = 0;
    for (int e = s->n_cable - 1; e >= 0; e--) {
        double length_at_target_m = hf_scene_length_at_target(s, e);
        bool is_own = fabs(s->target[e] - length_at_target_m) > OWN_LENGTH * length_at_target_m;
        if (!hf_law_has(s->law[e], HF_LAW_HAS_MULTIPLIER) || !is_own) continue;
        first = e;
        n++;
    }
    if (n)
        hf_warning(messages,
                   "form.prestress: exact: the length given to cable '%s' (%.6g m) is not used%s. Instead, hifdm "
                   "computes the cable tension that holds the nodes at their target positions",
                   s->cable_id[first], s->target[first], n > 1 ? ", nor are those of others" : "");
}

static hf_status hold(hf_scene *scene, const hf_model *m, const volatile sig_atomic_t *stop, hf_messages *messages)
{
    programme p = {.m = m, .stop = stop, .n = 3 * m->n_free, .half_bandwidth = 3 * m->half_bandwidth + 2};
    p.reference_N = m->reference_N;
    p.n_family = scene->n_set + 2;
    size_t e = (size_t)m->n_cable;
    void *block;
    programme *to = &p;
    if (HF_ARENA_ARRAYS(&block, PROGRAMME_FIELDS(HF_ARENA_ITEM)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the tensions of a net of %d nodes", m->n_node);
    hf_status status = find_tensions(&p, scene, messages);
    for (int i = 0; i < m->n_cable && status == HF_OK; i++) {
        scene->law[i] = HF_LAW_FORCE_DENSITY;
        scene->target[i] = p.tension_N[i] / m->length_m[i];
    }
    hf_arena_free_block(block);
    return status;
}

hf_status hf_prestress_hold(hf_scene *scene, const hf_form_settings *form, const volatile sig_atomic_t *stop,
                            hf_messages *messages)
{
    hf_form_settings by_law = *form;
    hf_model model;
    tell_lengths(scene, messages);
    by_law.method = HF_METHOD_AUTO; /* the other methods replace laws */
    hf_status status = hf_model_build(scene, &by_law, &model, messages);
    if (status == HF_OK) status = hold(scene, &model, stop, messages);
    hf_model_free(&model);
    return status;
}
