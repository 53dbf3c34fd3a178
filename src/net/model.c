/* Builds a model from a scene:
 *
 *     scene -> number the nodes (numbering) -> positions in the band -> laws and targets, design variables
 *       -> groups of design variables -> chains of length-controlled cables -> model
 *     truss flexibility -> attach: supports become attachments -> model
 *
 * Contents: layout - numbering and band positions - laws and targets - chains of length-controlled cables - groups of
 * design variables - names and units of design variables - build - attachments - checks */
#include <hifdm/model.h>

#include "base/arena.h"
#include "base/elementary.h"
#include "base/text.h"
#include "base/union_find.h"
#include "net/numbering.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- layout ---- */

/* Returns true if a law in force needs the axial stiffness. The methods iterative_fdm and fdm replace
 * every such law. */
static bool needs_EA(const hf_scene *s, hf_method method)
{
    if (method == HF_METHOD_ITERATIVE_FDM || method == HF_METHOD_FDM) return false;
    for (int e = 0; e < s->n_cable; e++)
        if (hf_law_has(s->law[e], HF_LAW_NEEDS_EA)) return true;
    return false;
}

static hf_status allocate(const hf_scene *s, hf_method method, hf_model *m)
{
    size_t n = (size_t)m->n_node, e = (size_t)m->n_cable;
    size_t n_load = s->load_N ? 3 * n : 0, n_EA = needs_EA(s, method) ? e : 0;
    HF_TRY(HF_ARENA_ARRAYS(&m->block, HF_ARRAY(m->row_of_node, n), HF_ARRAY(m->node_of_row, n),
                           HF_ARRAY(m->end_row, 2 * e), HF_ARRAY(m->diagonal_a, e), HF_ARRAY(m->diagonal_b, e),
                           HF_ARRAY(m->off_diagonal, e), HF_ARRAY(m->inner_row, n), HF_ARRAY(m->position_m, 3 * n),
                           HF_ARRAY(m->load_N, n_load), HF_ARRAY(m->length_m, e), HF_ARRAY(m->group, e),
                           HF_ARRAY(m->boundary_cable, e), HF_ARRAY(m->law, e), HF_ARRAY(m->target, e),
                           HF_ARRAY(m->EA_N, n_EA), HF_ARRAY(m->start_q_N_per_m, e), HF_ARRAY(m->variable_cable, e),
                           HF_ARRAY(m->variable_group, e), HF_ARRAY(m->variable_leader, e),
                           HF_ARRAY(m->chain_start, e + 1), HF_ARRAY(m->chain_cable, e), HF_ARRAY(m->chain_of_row, n)));
    if (!n_load) m->load_N = NULL;
    if (!n_EA) m->EA_N = NULL;
    return HF_OK;
}

/* ---- numbering and band positions ---- */

static void number_nodes(const hf_scene *s, hf_model *m)
{
    int n_support = 0;
    for (int i = 0; i < m->n_node; i++)
        if (s->role[i] == HF_ROLE_SUPPORT) m->node_of_row[m->n_free + n_support++] = i;
    for (int row = 0; row < m->n_node; row++) {
        int node = m->node_of_row[row];
        m->row_of_node[node] = row;
        for (int c = 0; c < 3; c++) {
            m->position_m[c * m->n_node + row] = s->position_m[3 * (size_t)node + (size_t)c];
            if (m->load_N) m->load_N[c * m->n_node + row] = s->load_N[3 * (size_t)node + (size_t)c];
        }
        if (s->role[node] == HF_ROLE_INNER) m->inner_row[m->n_inner_node++] = row;
    }
}

static void find_band_entries(const hf_scene *s, hf_model *m)
{
    int column = m->half_bandwidth + 1;
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->row_of_node[s->end[2 * e]], b = m->row_of_node[s->end[2 * e + 1]];
        int low = a < b ? a : b, high = a < b ? b : a;
        m->end_row[2 * e] = a;
        m->end_row[2 * e + 1] = b;
        m->diagonal_a[e] = a < m->n_free ? a * column : m->n_band;
        m->diagonal_b[e] = b < m->n_free ? b * column : m->n_band;
        m->off_diagonal[e] = high < m->n_free ? high - low + low * column : m->n_band;
    }
}

/* ---- laws and targets ---- */

/* Returns the tension that a cable is given, N; 0 if its law gives none. The tension of an elastic cable at the target
 * positions does not count, because it may be a thousand times the tension in the final shape. */
static double given_tension(const hf_scene *s, double pretension_N, int e)
{
    if (hf_law_has(s->law[e], HF_LAW_HAS_MULTIPLIER)) return 0;
    if (!hf_law_has(s->law[e], HF_LAW_GIVES_TENSION)) return fabs(s->target[e]) * hf_scene_length_at_target(s, e);
    return isnan(s->target[e]) ? pretension_N : s->target[e];
}

double hf_model_reference_N(const hf_scene *scene, double pretension_N)
{
    double largest_N = 0;
    for (int e = 0; e < scene->n_cable; e++)
        largest_N = fmax(largest_N, given_tension(scene, pretension_N, e));
    for (int i = 0; scene->load_N && i < scene->n_node; i++) {
        const double *p = scene->load_N + 3 * (size_t)i;
        if (scene->role[i] != HF_ROLE_SUPPORT) largest_N = fmax(largest_N, hf_norm(p[0], p[1], p[2]));
    }
    return largest_N > 0 ? largest_N : pretension_N;
}

static void set_laws(const hf_scene *s, const hf_form_settings *form, hf_model *m)
{
    m->by_lapack = form->factor == HF_FACTOR_LAPACK;
    m->pretension_N = form->pretension_N;
    m->reference_N = hf_model_reference_N(s, form->pretension_N);
    for (int e = 0; e < m->n_cable; e++) {
        int law = s->law[e];
        double length = hf_scene_length_at_target(s, e), target = s->target[e];
        double given = given_tension(s, form->pretension_N, e), tension = given > 0 ? given : m->reference_N;
        hf_law_cable cable = {(hf_law)law, target, s->EA_N ? s->EA_N[e] : (double)NAN, length};
        tension = hf_law_first_tension_N(cable, tension);
        double q = law == HF_LAW_FORCE_DENSITY ? target : tension / length;
        if (law == HF_LAW_TENSION) target = tension;
        if (form->method == HF_METHOD_ITERATIVE_FDM) {
            if (law != HF_LAW_TENSION) tension = form->pretension_N;
            law = HF_LAW_TENSION;
            target = tension;
            q = tension / length;
        } else if (form->method == HF_METHOD_FDM) {
            law = HF_LAW_FORCE_DENSITY;
            target = q;
        }
        if (m->EA_N) m->EA_N[e] = s->EA_N ? s->EA_N[e] : (double)NAN;
        m->length_m[e] = length;
        m->group[e] = s->group[e];
        if (s->group[e] == HF_GROUP_BOUNDARY) m->boundary_cable[m->n_boundary++] = e;
        m->law[e] = (unsigned char)law;
        m->target[e] = target;
        m->start_q_N_per_m[e] = q;
        m->has_strut |= q < 0;
        if (s->group[e] == HF_GROUP_BOUNDARY && (m->end_row[2 * e] < m->n_free || m->end_row[2 * e + 1] < m->n_free))
            m->variable_cable[m->n_variable++] = e;
    }
    bool iterates = false, is_convex = !m->has_strut;
    for (int e = 0; e < m->n_cable; e++) {
        iterates |= hf_law_has(m->law[e], HF_LAW_ITERATES);
        is_convex &= hf_law_has(m->law[e], HF_LAW_IS_CONVEX);
    }
    m->has_newton = iterates && is_convex;
}

/* ---- chains of length-controlled cables ---- */

/* The cables of law length at each row, and the state of a search from one support. */
typedef struct {
    int *start, *cable; /* [n_node + 1], [2 n_cable]: those at a row are cable[start[row] .. start[row + 1] - 1] */
    int *queue, *via;   /* [n_node]: rows to continue from; the cable by which a row was reached */
    char *is_waiting;   /* [n_node], true if a row is in the queue */
    double *reach_m;    /* [n_node], minimum sum of lengths to a row, m */
    long steps_left;
} length_graph;

static bool is_rigid(const hf_model *m, int cable)
{
    return hf_law_has(m->law[cable], HF_LAW_IS_RIGID);
}

/* Lists the cables of each row. */
static void list_cables(const hf_model *m, length_graph *g)
{
    for (int k = 0; k < 2 * m->n_cable; k++)
        g->start[m->end_row[k]] += is_rigid(m, k / 2);
    for (int row = 0; row < m->n_node; row++)
        g->start[row + 1] += g->start[row];       /* the end of the cables of `row` */
    for (int k = 2 * m->n_cable - 1; k >= 0; k--) /* becomes their start */
        if (is_rigid(m, k / 2)) g->cable[--g->start[m->end_row[k]]] = k / 2;
}

static int count_cables(const length_graph *g, int row)
{
    return g->start[row + 1] - g->start[row];
}

static double distance(const hf_model *m, int row_a, int row_b)
{
    double d[3];
    for (int c = 0; c < 3; c++)
        d[c] = m->position_m[c * m->n_node + row_a] - m->position_m[c * m->n_node + row_b];
    return hf_norm(d[0], d[1], d[2]);
}

/* Follows the chain that leaves the support `from` by cable `first`. Keeps it if it ends at a support and is straight
 * (want_straight) or has a sag (not want_straight). Each chain is found from both ends; it is kept only from the end
 * with the smaller cable index. */
static void follow_chain(hf_model *m, const length_graph *g, int from, int first, bool want_straight)
{
    int start = m->chain_start[m->n_any_chain], n = 0, row = from, e = first;
    double sum = 0;
    if (start == m->n_cable) return; /* all cables are already in chains */
    for (;;) {
        row = m->end_row[2 * e] == row ? m->end_row[2 * e + 1] : m->end_row[2 * e];
        m->chain_cable[start + n++] = e;
        sum += m->target[e];
        if (row >= m->n_free) break;
        if (count_cables(g, row) != 2 || n == m->n_cable - start) return;
        const int *at = g->cable + g->start[row];
        e = at[0] == e ? at[1] : at[0];
    }
    bool is_straight = sum <= distance(m, from, row) * (1 + HF_STRAIGHT_EXCESS);
    if (n < 2 || e < first || is_straight != want_straight) return;
    int through = from;
    for (int k = 0; is_straight && k + 1 < n; k++) {
        int *end = m->end_row + 2 * m->chain_cable[start + k];
        through = end[0] == through ? end[1] : end[0];
        m->chain_of_row[through] = m->n_any_chain;
    }
    m->chain_start[++m->n_any_chain] = start + n;
}

/* Finds the shortest path of cables from one support to every row. Paths pass only through free nodes. */
static void search_from(const hf_model *m, length_graph *s, int from)
{
    int n_waiting = 1, first = 0;
    for (int row = 0; row < m->n_node; row++)
        s->reach_m[row] = INFINITY;
    s->reach_m[from] = 0;
    s->queue[0] = from;
    while (n_waiting-- > 0) {
        int row = s->queue[first];
        first = (first + 1) % m->n_node;
        s->is_waiting[row] = 0;
        for (int k = s->start[row]; k < s->start[row + 1] && s->steps_left > 0; k++, s->steps_left--) {
            int e = s->cable[k], to = m->end_row[2 * e] == row ? m->end_row[2 * e + 1] : m->end_row[2 * e];
            if (!(s->reach_m[row] + m->target[e] < s->reach_m[to])) continue;
            s->reach_m[to] = s->reach_m[row] + m->target[e];
            s->via[to] = e;
            if (to >= m->n_free || s->is_waiting[to]) continue;
            s->is_waiting[to] = 1;
            s->queue[(first + n_waiting++) % m->n_node] = to;
        }
    }
}

static int row_before(const hf_model *m, const length_graph *s, int row)
{
    const int *end = m->end_row + 2 * s->via[row];
    return end[0] == row ? end[1] : end[0];
}

/* Keeps the path from `to` back to `from` as a chain. Returns false if it has only one cable, or if one of its cables
 * is already in a chain. */
static bool keep_path(hf_model *m, const length_graph *s, int from, int to)
{
    int start = m->chain_start[m->n_any_chain], n = 0;
    if (row_before(m, s, to) == from) return false;
    for (int row = to; row != from; row = row_before(m, s, row))
        for (int k = 0; k < start; k++)
            if (m->chain_cable[k] == s->via[row]) return false;
    for (int row = to; row != from; row = row_before(m, s, row)) {
        m->chain_cable[start + n++] = s->via[row];
        if (row < m->n_free && m->chain_of_row[row] < 0) m->chain_of_row[row] = m->n_any_chain;
    }
    m->chain_start[++m->n_any_chain] = start + n;
    return true;
}

/* Finds cables that are too short to span two supports, on a path through nodes at which chains branch. One such path
 * proves that no shape satisfies the lengths, so the first one is kept as a chain. The limit PATH_STEPS is far above
 * the need of nets in which only some cables have law length. If the search reaches it, a path may stay undetected. */
#define PATH_STEPS 4000000
static void keep_short_path(hf_model *m, length_graph *s)
{
    s->steps_left = PATH_STEPS;
    for (int from = m->n_free; from < m->n_node; from++) {
        if (count_cables(s, from) == 0) continue;
        search_from(m, s, from);
        for (int to = from + 1; to < m->n_node; to++)
            if (s->reach_m[to] * (1 + HF_STRAIGHT_EXCESS) < distance(m, from, to) && keep_path(m, s, from, to)) return;
    }
}

static hf_status find_chains(hf_model *m)
{
    size_t n = (size_t)m->n_node;
    bool branches = false;
    length_graph g;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(g.start, n + 1), HF_ARRAY(g.cable, 2 * (size_t)m->n_cable),
                           HF_ARRAY(g.queue, n), HF_ARRAY(g.via, n), HF_ARRAY(g.is_waiting, n),
                           HF_ARRAY(g.reach_m, n)));
    list_cables(m, &g);
    for (int row = 0; row < m->n_node; row++) {
        m->chain_of_row[row] = -1;
        branches |= row < m->n_free && count_cables(&g, row) > 2;
    }
    for (int want_straight = 1; want_straight >= 0; want_straight--) {
        for (int k = 0; k < 2 * m->n_cable; k++)
            if (is_rigid(m, k / 2) && m->end_row[k] >= m->n_free && m->end_row[k ^ 1] < m->n_free)
                follow_chain(m, &g, m->end_row[k], k / 2, want_straight);
        if (!want_straight) break;
        if (branches) keep_short_path(m, &g);
        m->n_chain = m->n_any_chain;
    }
    hf_arena_free_block(block);
    return HF_OK;
}

void hf_model_chain_name(const hf_model *m, const hf_scene *scene, int i_chain, char *text, size_t size)
{
    text[0] = '\0';
    for (int k = m->chain_start[i_chain]; k < m->chain_start[i_chain + 1]; k++)
        if (!hf_text_append(text, size, " + ", scene->cable_id[m->chain_cable[k]], " ...")) return;
}

/* ---- groups of design variables ---- */

hf_status hf_model_group_variables(hf_model *m)
{
    int *count, *variable_at, *parent, *label;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(count, m->n_node), HF_ARRAY(variable_at, 2 * m->n_node),
                           HF_ARRAY(parent, m->n_variable), HF_ARRAY(label, m->n_variable)));
    m->n_variable_group = 0;
    for (int k = 0; k < m->n_variable; k++) {
        parent[k] = k;
        label[k] = -1;
        for (int end = 0; end < 2 && m->variable_cable[k] >= 0; end++) {
            int row = m->end_row[2 * m->variable_cable[k] + end];
            if (count[row] < 2) variable_at[2 * row + count[row]] = k;
            count[row]++;
        }
    }
    for (int row = 0; row < m->n_free; row++)
        if (count[row] == 2) hf_union_find_join(parent, variable_at[2 * row], variable_at[2 * row + 1]);
    for (int k = 0; k < m->n_variable; k++) {
        int root = hf_union_find_root(parent, k);
        if (label[root] < 0) label[root] = m->n_variable_group++;
        m->variable_group[k] = label[root];
        m->variable_leader[k] = k;
    }
    m->n_leader = m->n_variable;
    hf_arena_free_block(block);
    return HF_OK;
}

/* ---- names and units of design variables ---- */

static const char *direction_name(const hf_variable *g)
{
    if (g->vary == HF_VARY_SUPPORT_NORMAL) return "normal";
    return g->direction[0] > 0 ? "x" : g->direction[1] > 0 ? "y" : "z";
}

void hf_model_variable_name(const hf_model *m, const hf_scene *scene, int k, char *text, size_t size)
{
    if (m->variable_cable[k] >= 0)
        snprintf(text, size, "%s", scene->cable_id[m->variable_cable[k]]);
    else
        snprintf(text, size, "%s.%s", scene->node_id[m->node_of_row[m->variable[k].support_row]],
                 direction_name(&m->variable[k]));
}

const char *hf_model_variable_unit(const hf_model *m, int k)
{
    hf_vary vary = hf_model_vary(m, k);
    return vary == HF_VARY_PRETENSION || vary == HF_VARY_TENSION ? "N" : vary == HF_VARY_FORCE_DENSITY ? "N/m" : "m";
}

/* ---- build ---- */

static hf_status build(const hf_scene *scene, const hf_form_settings *form, const int *order, hf_model *m)
{
    HF_TRY(allocate(scene, form->method, m));
    memcpy(m->node_of_row, order, (size_t)m->n_free * sizeof(int));
    number_nodes(scene, m);
    find_band_entries(scene, m);
    set_laws(scene, form, m);
    HF_TRY(hf_model_group_variables(m));
    return find_chains(m);
}

hf_status hf_model_build(const hf_scene *scene, const hf_form_settings *form, hf_model *m, hf_messages *messages)
{
    *m = (hf_model){.n_node = scene->n_node, .n_cable = scene->n_cable};
    for (int i = 0; i < scene->n_node; i++)
        m->n_free += scene->role[i] != HF_ROLE_SUPPORT;
    int *order = malloc((size_t)scene->n_node * sizeof *order);
    hf_status status = order ? hf_numbering_find(scene, order, &m->half_bandwidth) : HF_NO_MEMORY;
    double n_band = (double)m->n_free * (m->half_bandwidth + 1.0);
    if (status == HF_OK && 3 * n_band > INT_MAX / 2) { /* 3: the general band of a net with struts */
        free(order);
        return hf_error(messages, HF_NO_MEMORY,
                        "the band matrix with %d rows and half-bandwidth %d is too large. Use fewer nodes", m->n_free,
                        m->half_bandwidth);
    }
    m->n_band = (int)n_band;
    if (status == HF_OK) status = build(scene, form, order, m);
    free(order);
    if (status != HF_OK) return hf_error(messages, status, "out of memory for a model of %d nodes", scene->n_node);
    return HF_OK;
}

void hf_model_free(hf_model *m)
{
    hf_arena_free_block(m->block);
    hf_arena_free_block(m->attachment_block);
    hf_arena_free_block(m->variable_block);
    *m = (hf_model){0};
}

/* ---- attachments ---- */

/* Relative to the largest entry. It allows for the rounding of solves with a condition number of 1e6. No test of model,
 * truss or coupling changes with values from 1e-12 to 1e-6. */
#define SYMMETRY_TOLERANCE 1e-9

static hf_status check_attachments(const hf_model *m, int n, const int *node, hf_messages *messages)
{
    for (int i = 0; i < n; i++) {
        if (node[i] < 0 || node[i] >= m->n_node || m->row_of_node[node[i]] < m->n_free)
            return hf_error(messages, HF_BAD_CASE,
                            "attachment %d of the truss belongs to node %d, but this node is not a support", i,
                            node[i]);
        for (int j = 0; j < i; j++)
            if (node[j] == node[i])
                return hf_error(messages, HF_BAD_CASE, "attachments %d and %d of the truss belong to the same node", j,
                                i);
    }
    return HF_OK;
}

static hf_status check_flexibility(int n, const double *flexibility, hf_messages *messages)
{
    double largest = 0;
    size_t dofs = 3 * (size_t)n;
    for (size_t i = 0; i < dofs * dofs; i++) {
        if (!isfinite(flexibility[i]))
            return hf_error(messages, HF_BAD_CASE, "the flexibility of the truss at attachment %d is not finite",
                            (int)(i / dofs / 3));
        largest = fmax(largest, fabs(flexibility[i]));
    }
    for (size_t i = 0; i < dofs; i++) {
        if (flexibility[i * dofs + i] < 0)
            return hf_error(messages, HF_BAD_CASE, "the flexibility of the truss at attachment %d is negative: %g m/N",
                            (int)(i / 3), flexibility[i * dofs + i]);
        for (size_t j = 0; j < i; j++)
            if (!(fabs(flexibility[i * dofs + j] - flexibility[j * dofs + i]) <= SYMMETRY_TOLERANCE * largest))
                return hf_error(messages, HF_BAD_CASE,
                                "the flexibility of the truss is not symmetric between attachments %d and %d",
                                (int)(j / 3), (int)(i / 3));
    }
    return HF_OK;
}

/* Lists the cable ends at attachments. Without a list, only counts them. */
static void find_ties(hf_model *m)
{
    m->n_tie = 0;
    for (int k = 0; k < 2 * m->n_cable; k++) {
        int i = m->end_row[k] - m->n_free;
        if (i < 0 || i >= m->n_attachment) continue;
        if (m->tie) m->tie[m->n_tie] = k;
        if (m->tie) m->tie_attachment[m->n_tie] = i;
        m->n_tie++;
    }
}

/* Replaces rigid laws of cables between an attachment and another support. Such a cable would be a rigid rod in the
 * truss. It keeps its first tension instead. */
static void hold_rods(hf_model *m)
{
    for (int k = 0; k < m->n_tie; k++) {
        int e = m->tie[k] / 2;
        if (!hf_law_has(m->law[e], HF_LAW_IS_RIGID)) continue;
        if (m->end_row[2 * e] < m->n_free || m->end_row[2 * e + 1] < m->n_free) continue;
        m->law[e] = HF_LAW_TENSION;
        m->target[e] = m->start_q_N_per_m[e] * m->length_m[e];
    }
}

/* Sets chain_of_row for chains with a sag, too. The displacement of supports can straighten them. */
static void mark_chains(hf_model *m)
{
    for (int i = m->n_chain; i < m->n_any_chain; i++)
        for (int k = m->chain_start[i]; k < m->chain_start[i + 1]; k++)
            for (int side = 0; side < 2; side++) {
                int row = m->end_row[2 * m->chain_cable[k] + side];
                if (row < m->n_free) m->chain_of_row[row] = i;
            }
}

static void swap_rows(hf_model *m, int a, int b)
{
    int node_a = m->node_of_row[a], node_b = m->node_of_row[b], chain = m->chain_of_row[a];
    m->node_of_row[a] = node_b;
    m->node_of_row[b] = node_a;
    m->row_of_node[node_a] = b;
    m->row_of_node[node_b] = a;
    m->chain_of_row[a] = m->chain_of_row[b];
    m->chain_of_row[b] = chain;
    double *vector[] = {m->position_m, m->load_N};
    for (int k = 0; k < 2; k++)
        for (int c = 0; c < 3 && vector[k]; c++) {
            double *x = vector[k] + c * m->n_node, kept = x[a];
            x[a] = x[b];
            x[b] = kept;
        }
    for (int k = 0; k < 2 * m->n_cable; k++)
        m->end_row[k] = m->end_row[k] == a ? b : m->end_row[k] == b ? a : m->end_row[k];
}

static hf_status attach(hf_model *m, int n, const int *node, const double *flexibility)
{
    size_t dofs = 3 * (size_t)n;
    for (int i = 0; i < n; i++)
        swap_rows(m, m->n_free + i, m->row_of_node[node[i]]);
    m->n_attachment = n;
    find_ties(m);
    if (HF_ARENA_ARRAYS(&m->attachment_block, HF_ARRAY(m->attachment_row, n),
                        HF_ARRAY(m->flexibility_m_per_N, dofs * dofs), HF_ARRAY(m->tie, m->n_tie),
                        HF_ARRAY(m->tie_attachment, m->n_tie)) != HF_OK) {
        m->n_attachment = m->n_tie = 0;
        return HF_NO_MEMORY;
    }
    find_ties(m);
    for (int i = 0; i < n; i++)
        m->attachment_row[i] = m->n_free + i;
    for (size_t i = 0; i < dofs; i++)
        for (size_t j = 0; j < dofs; j++)
            m->flexibility_m_per_N[i * dofs + j] = (flexibility[i * dofs + j] + flexibility[j * dofs + i]) / 2;
    hold_rods(m);
    mark_chains(m);
    return HF_OK;
}

hf_status hf_model_attach(hf_model *m, int n_attachment, const int *node, const double *flexibility_m_per_N,
                          hf_messages *messages)
{
    assert(m->n_attachment == 0 && n_attachment > 0);
    HF_TRY(check_attachments(m, n_attachment, node, messages));
    HF_TRY(check_flexibility(n_attachment, flexibility_m_per_N, messages));
    if (attach(m, n_attachment, node, flexibility_m_per_N) == HF_OK) return HF_OK;
    return hf_error(messages, HF_NO_MEMORY, "out of memory for %d attachments", n_attachment);
}

void hf_model_want_newton(hf_model *m)
{
    m->has_newton |= m->n_attachment > 0 && !m->has_strut; /* laws that do not iterate have convex energy */
}

/* ---- positions ---- */

void hf_model_positions(const hf_model *m, const double *row_m, double *position_m)
{
    size_t n = (size_t)m->n_node;
    for (size_t row = 0; row < n; row++)
        for (size_t c = 0; c < 3; c++)
            position_m[3 * (size_t)m->node_of_row[row] + c] = row_m[c * n + row];
}
