/* Contents: design variables of cables - design variables of supports - links - all rows - values and bounds */
#include "net/variables.h"

#include "base/arena.h"
#include "net/cable_pick.h"
#include "net/target_surface.h"

#include <math.h>
#include <string.h>

/* Minimum of a tension, force density or length relative to its initial value, whatever its range. A cable without
 * tension is no cable, and the solvers need values above zero. */
#define LEFT 1e-3

/* ---- design variables of cables ---- */

typedef struct {
    const hf_scene *scene;
    const hf_optimize_settings *settings;
    const hf_surface_settings *surface;
    hf_model *m;
    int *picked;           /* [n_cable], scratch: the cables of a row */
    int *taken;            /* [n_cable + n_node], the row that varies a cable or a support; -1: none */
    int *cable;            /* [n_cable + 3 n_node], cable of each design variable, as in the model */
    hf_variable *variable; /* [n_cable + 3 n_node], design variables */
    hf_messages *messages;
    char place[HF_LOCATION_SIZE];
} maker;

/* Returns the location of a key of a row. */
static const char *where_in(maker *q, int row, const char *key)
{
    return hf_messages_location(q->messages, q->place, "optimize.variables.%d.%s", row, key);
}

static bool varies_support(hf_vary vary)
{
    return vary == HF_VARY_SUPPORT_Z || vary == HF_VARY_SUPPORT_NORMAL || vary == HF_VARY_SUPPORT_XYZ;
}

/* Records that a row varies cable or support `at`. Returns HF_BAD_CASE if another row already does. */
static hf_status take(maker *q, int row, int at, const char *kind, const char *id)
{
    if (q->taken[at] >= 0)
        return hf_error(q->messages, HF_BAD_CASE, "%s: %s '%s' is already a design variable of optimize.variables.%d",
                        where_in(q, row, "set"), kind, id, q->taken[at]);
    q->taken[at] = row;
    return HF_OK;
}

static void add(maker *q, int cable, hf_variable variable)
{
    q->cable[q->m->n_variable] = cable;
    q->variable[q->m->n_variable++] = variable;
}

static hf_status add_cable(maker *q, int row, int e)
{
    const hf_variable_settings *s = &q->settings->variable_row[row];
    const hf_model *m = q->m;
    const char *id = q->scene->cable_id[e];
    if (m->end_row[2 * e] >= m->n_free && m->end_row[2 * e + 1] >= m->n_free) return HF_OK;
    if (s->vary == HF_VARY_UNSTRESSED_LENGTH && !hf_law_has((hf_law)m->law[e], HF_LAW_NEEDS_EA))
        return hf_error(
            q->messages, HF_BAD_CASE,
            "%s: cable '%s' of set %s has the law %s, but only cables with the law elastic have an unstressed length",
            where_in(q, row, "vary"), id, s->set, hf_law_word[m->law[e]]);
    if (m->start_q_N_per_m[e] < 0)
        return hf_error(q->messages, HF_BAD_CASE,
                        "%s: cable '%s' of set %s is a strut, so it cannot be a design variable",
                        where_in(q, row, "set"), id, s->set);
    HF_TRY(take(q, row, e, "cable", id));
    add(q, e, (hf_variable){.vary = s->vary, .setting = row, .support_row = -1});
    return HF_OK;
}

/* ---- design variables of supports ---- */

static void find_normal(const maker *q, int support_row, double normal[3])
{
    double p[3], slope[2];
    for (int c = 0; c < 3; c++)
        p[c] = q->m->position_m[c * q->m->n_node + support_row];
    hf_target_surface_height_above(q->surface->kind, 1 / (4 * q->surface->focal_length_m), p, slope);
    double length = sqrt(1 + slope[0] * slope[0] + slope[1] * slope[1]);
    normal[0] = -slope[0] / length;
    normal[1] = -slope[1] / length;
    normal[2] = 1 / length;
}

static hf_status add_support(maker *q, int row, int support_row)
{
    const hf_model *m = q->m;
    hf_variable variable = {.vary = q->settings->variable_row[row].vary, .setting = row, .support_row = support_row};
    HF_TRY(take(q, row, m->n_cable + support_row, "support", q->scene->node_id[m->node_of_row[support_row]]));
    if (variable.vary == HF_VARY_SUPPORT_NORMAL) find_normal(q, support_row, variable.direction);
    if (variable.vary == HF_VARY_SUPPORT_Z) variable.direction[2] = 1;
    if (variable.vary != HF_VARY_SUPPORT_XYZ) add(q, -1, variable);
    for (int c = 0; c < 3 && variable.vary == HF_VARY_SUPPORT_XYZ; c++) {
        for (int d = 0; d < 3; d++)
            variable.direction[d] = c == d;
        add(q, -1, variable);
    }
    return HF_OK;
}

/* Returns true if a cable joins this support to a free node. */
static bool holds_net(const hf_model *m, int support_row)
{
    for (int k = 0; k < 2 * m->n_cable; k++)
        if (m->end_row[k] == support_row && m->end_row[k ^ 1] < m->n_free) return true;
    return false;
}

/* Adds the supports at the ends of the cables of a row that hold the net. Each is added once, in the order
 * of the cables. */
static hf_status add_supports(maker *q, int row, int n_picked)
{
    const hf_model *m = q->m;
    if (q->settings->variable_row[row].vary == HF_VARY_SUPPORT_NORMAL && !(q->surface->focal_length_m > 0))
        return hf_error(q->messages, HF_BAD_CASE,
                        "%s: the variable support_normal needs a target surface. Add a `surface` section",
                        where_in(q, row, "vary"));
    for (int i = 0; i < 2 * n_picked; i++) {
        int support_row = m->end_row[2 * q->picked[i / 2] + i % 2];
        if (support_row < m->n_free || q->taken[m->n_cable + support_row] == row) continue;
        if (!holds_net(m, support_row)) continue;
        HF_TRY(add_support(q, row, support_row));
    }
    return HF_OK;
}

/* ---- links ---- */

/* Lets the design variables of a row with link: set or link: scale follow the first one. For support_xyz, each
 * component follows the same component of the first support. */
static void link_sets(const maker *q)
{
    hf_model *m = q->m;
    int first = 0;
    m->n_leader = 0;
    for (int k = 0; k < m->n_variable; k++) {
        const hf_variable_settings *s = &q->settings->variable_row[m->variable[k].setting];
        int n_component = s->vary == HF_VARY_SUPPORT_XYZ ? 3 : 1;
        if (k == 0 || m->variable[k].setting != m->variable[k - 1].setting) first = k;
        m->variable[k].scales = s->link == HF_LINK_SCALE;
        if (s->link == HF_LINK_SET || s->link == HF_LINK_SCALE)
            m->variable_leader[k] = first + (k - first) % n_component;
        m->links_tensions |= m->variable_leader[k] != k && s->vary == HF_VARY_TENSION;
        m->n_leader += m->variable_leader[k] == k;
    }
}

/* Puts linked design variables into the same group. Groups are numbered in the order of their
 * first design variables. */
static void join_groups(hf_model *m, int *label)
{
    int n = 0;
    for (int k = 0; k < m->n_variable; k++)
        label[k] = -1;
    for (int k = 0; k < m->n_variable; k++) {
        int group = m->variable_group[m->variable_leader[k]];
        if (label[group] < 0) label[group] = n++;
    }
    for (int k = m->n_variable - 1; k >= 0; k--) /* a leader precedes its followers */
        m->variable_group[k] = label[m->variable_group[m->variable_leader[k]]];
    m->n_variable_group = n;
}

/* ---- all rows ---- */

static hf_status make_row(maker *q, int row)
{
    const hf_variable_settings *s = &q->settings->variable_row[row];
    int before = q->m->n_variable, n_picked;
    n_picked = hf_cable_pick_some(q->scene, s->set, where_in(q, row, "set"), q->picked, q->messages);
    if (n_picked == 0) return HF_BAD_CASE;
    if (varies_support(s->vary)) HF_TRY(add_supports(q, row, n_picked));
    for (int i = 0; i < n_picked && !varies_support(s->vary); i++)
        HF_TRY(add_cable(q, row, q->picked[i]));
    if (q->m->n_variable == before)
        return hf_error(q->messages, HF_BAD_CASE, "%s: set %s has %d cables, but no %s. Choose another set",
                        where_in(q, row, "set"), s->set, n_picked,
                        varies_support(s->vary) ? "support at their ends that holds a free node"
                                                : "cable with a free end");
    return HF_OK;
}

/* Copies the design variables into a block that the model owns. */
static hf_status keep(const maker *q)
{
    hf_model *m = q->m;
    int *label;
    size_t n = (size_t)m->n_variable;
    HF_TRY(HF_ARENA_ARRAYS(&m->variable_block, HF_ARRAY(m->variable_cable, n), HF_ARRAY(m->variable_group, n),
                           HF_ARRAY(m->variable_leader, n), HF_ARRAY(label, n), HF_ARRAY(m->variable, n)));
    memcpy(m->variable_cable, q->cable, n * sizeof(int));
    memcpy(m->variable, q->variable, n * sizeof(hf_variable));
    for (size_t k = 0; k < n; k++)
        m->moves_supports |= m->variable[k].support_row >= 0;
    HF_TRY(hf_model_group_variables(m));
    link_sets(q);
    join_groups(m, label);
    return HF_OK;
}

hf_status hf_variables_apply(const hf_scene *scene, const hf_optimize_settings *settings,
                             const hf_surface_settings *surface, hf_model *m, hf_messages *messages)
{
    maker q = {.scene = scene, .settings = settings, .surface = surface, .m = m, .messages = messages};
    void *block;
    size_t e = (size_t)m->n_cable, n = (size_t)m->n_node;
    if (settings->n_variable_row == 0) return HF_OK;
    if (HF_ARENA_ARRAYS(&block, HF_ARRAY(q.picked, e), HF_ARRAY(q.taken, e + n), HF_ARRAY(q.cable, e + 3 * n),
                        HF_ARRAY(q.variable, e + 3 * n)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "optimize.variables: out of memory");
    for (int i = 0; i < m->n_cable + m->n_node; i++)
        q.taken[i] = -1;
    m->n_variable = 0;
    hf_status status = HF_OK;
    for (int row = 0; row < settings->n_variable_row; row++) /* reports the faults of all rows */
        if (make_row(&q, row) != HF_OK) status = HF_BAD_CASE;
    if (status != HF_OK) m->n_variable = 0;
    if (status == HF_OK && keep(&q) != HF_OK)
        status = hf_error(messages, HF_NO_MEMORY, "optimize.variables: out of memory");
    m->has_newton = !m->has_strut; /* a design may need Newton's method although the laws of the scene do not iterate */
    hf_arena_free_block(block);
    return status;
}

/* ---- values and bounds ---- */

void hf_variables_read(const hf_model *m, const double *q_N_per_m, const double *tension_N, const double *length_m,
                       double *value)
{
    const double *const of_cable[] = {[HF_VARY_PRETENSION] = tension_N,
                                      [HF_VARY_TENSION] = tension_N,
                                      [HF_VARY_FORCE_DENSITY] = q_N_per_m,
                                      [HF_VARY_LENGTH] = length_m,
                                      [HF_VARY_UNSTRESSED_LENGTH] = m->target};
    for (int k = 0; k < m->n_variable; k++) /* supports begin at 0 */
        value[k] = m->variable_cable[k] < 0 ? 0 : of_cable[hf_model_vary(m, k)][m->variable_cable[k]];
}

static double within(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

void hf_variables_scales(const hf_model *m, const double *initial, const double *design, double *least, double *most)
{
    *least = *most = (double)NAN;
    for (int k = 0; m->variable && k < m->n_variable; k++) {
        if (!m->variable[k].scales || initial[k] == 0) continue;
        *least = fmin(*least, design[k] / initial[k]); /* fmin and fmax ignore NaN */
        *most = fmax(*most, design[k] / initial[k]);
    }
}

void hf_variables_bound(const hf_optimize_settings *s, const hf_model *m, int k, double base, double *lower,
                        double *upper, double *reach)
{
    if (hf_model_vary(m, k) == HF_VARY_PRETENSION) {
        *reach = s->range_N;
        *lower = within(base - s->range_N, s->min_tension_N, s->max_tension_N);
        *upper = within(base + s->range_N, s->min_tension_N, s->max_tension_N);
        return;
    }
    const hf_variable_settings *row = &s->variable_row[m->variable[k].setting];
    double range = isnan(row->range_ratio) ? row->range : row->range_ratio * fabs(base);
    bool is_ranged = !isnan(range);
    double low = is_ranged ? base - range : row->lower, high = is_ranged ? base + range : row->upper;
    if (!varies_support(row->vary)) low = fmax(low, LEFT * base);
    *lower = within(low, row->lower, row->upper);
    *upper = within(high, row->lower, row->upper);
    *reach = is_ranged ? range : fmax(base - *lower, *upper - base);
    if (isinf(*reach)) *reach = isinf(*upper) ? base - *lower : *upper - base;
}
