/* Links design variables that are mirror images:
 *
 *     scene, model -> sort nodes along the longest axis, sort cables by their ends
 *       -> for each plane: images of nodes -> images of cables -> join the design variables of each pair
 *       -> classes with a leader, merged groups
 *
 * Contents: mirror images of nodes - mirror images of cables - one plane - classes of design variables -
 * together - steps */
#include "net/symmetry.h"

#include "base/arena.h"
#include "base/text.h"
#include "base/union_find.h"
#include "net/side.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Tolerance of positions, relative to the size of the net, and of loads and targets, relative to their values. No test
 * of the room `net` changes with values from 1e-10 to 1e-8; 1e-11 and 1e-7 each fail one. */
#define TOLERANCE 1e-9
/* Initial tensions that agree to this relative tolerance differ only by rounding and convergence. No test of the room
 * `net` changes with values from 1e-6 to 1e-2; 1e-9 fails one. */
#define BASE_AGREEMENT 1e-6
#define NAMED_MAX 5 /* maximum number of cables in a message; ids of tables have at most 255 bytes */

/* ---- mirror images of nodes ---- */

typedef struct {
    double at_m; /* coordinate along the axis of the sweep */
    int node;
} sorted_node;

typedef struct {
    hf_side side; /* of the cable */
    int kind;     /* group and law */
    double target;
} link;

typedef struct {
    const hf_scene *s;
    const hf_model *m;
    double low_m[3], high_m[3], size_m, load_N; /* extent; largest load component */
    int sweep;                                  /* the longest axis; nodes are sorted along it */
    sorted_node *node;                          /* [n_node], sorted */
    link *link;                                 /* [n_cable], sorted */
    int *node_image, *cable_image;              /* [n_node], [n_cable], images under the current plane; -1: none */
    int *variable_of_cable, *variable_of_node;  /* [n_cable], [n_node], variables that may be linked; -1: none */
    int *parent;                                /* [n_variable], union-find over both planes */
    int *group_parent, *group_label;            /* [n_variable_group] */
} search;

static double coordinate(const search *q, int node, int c)
{
    return q->s->position_m[3 * (size_t)node + (size_t)c];
}

static int compare_coordinates(const void *a, const void *b)
{
    const sorted_node *x = a, *y = b;
    return x->at_m != y->at_m ? (x->at_m > y->at_m) - (x->at_m < y->at_m) : (x->node > y->node) - (x->node < y->node);
}

static void measure(search *q)
{
    for (int c = 0; c < 3; c++) {
        q->low_m[c] = INFINITY;
        q->high_m[c] = -INFINITY;
        for (int i = 0; i < q->s->n_node; i++) {
            q->low_m[c] = fmin(q->low_m[c], coordinate(q, i, c));
            q->high_m[c] = fmax(q->high_m[c], coordinate(q, i, c));
            if (q->s->load_N) q->load_N = fmax(q->load_N, fabs(q->s->load_N[3 * (size_t)i + (size_t)c]));
        }
        double extent = q->high_m[c] - q->low_m[c];
        if (extent > q->size_m) q->sweep = c;
        q->size_m = fmax(q->size_m, extent);
    }
}

/* Returns true if node j is at `target`, has the role of node i, and carries its mirrored load. */
static bool is_node_image(const search *q, int axis, int i, int j, const double target[3])
{
    if (q->s->role[i] != q->s->role[j]) return false;
    for (int c = 0; c < 3; c++) {
        if (fabs(coordinate(q, j, c) - target[c]) > TOLERANCE * q->size_m) return false;
        if (!q->s->load_N) continue;
        double load = q->s->load_N[3 * (size_t)i + (size_t)c], other = q->s->load_N[3 * (size_t)j + (size_t)c];
        if (fabs(other - (c == axis ? -load : load)) > TOLERANCE * q->load_N) return false;
    }
    return true;
}

static int find_node_image(const search *q, int axis, int i)
{
    double target[3], slack = TOLERANCE * q->size_m;
    for (int c = 0; c < 3; c++)
        target[c] = c == axis ? q->low_m[c] + q->high_m[c] - coordinate(q, i, c) : coordinate(q, i, c);
    int from = 0, to = q->s->n_node;
    while (from < to) { /* finds the first node not before the target */
        int middle = from + (to - from) / 2;
        if (q->node[middle].at_m < target[q->sweep] - slack)
            from = middle + 1;
        else
            to = middle;
    }
    for (; from < q->s->n_node && q->node[from].at_m <= target[q->sweep] + slack; from++)
        if (is_node_image(q, axis, i, q->node[from].node, target)) return q->node[from].node;
    return -1;
}

/* ---- mirror images of cables ---- */

/* Orders cables by their ends. Cables with the same ends are ordered by kind and target. A cable and its image then
 * have the same rank among the cables with their ends. */
static int compare_links(const void *a, const void *b)
{
    const link *x = a, *y = b;
    int order = hf_side_compare_nodes(&x->side, &y->side);
    if (!order) order = x->kind - y->kind;
    if (!order) order = (x->target > y->target) - (x->target < y->target);
    return order ? order : (x->side.of > y->side.of) - (x->side.of < y->side.of);
}

/* Returns true if cables a and b agree in kind, target and EA. The tolerance of the target includes that of lengths,
 * which follows from the tolerance of positions. */
static bool is_alike(const search *q, const link *a, const link *b)
{
    int of_a = a->side.of, of_b = b->side.of;
    double tolerance = fmax(TOLERANCE, 4 * TOLERANCE * q->size_m / q->m->length_m[of_a]);
    if (a->kind != b->kind || !(fabs(a->target - b->target) <= tolerance * fabs(a->target))) return false;
    const double *EA_N = hf_law_has(q->m->law[of_a], HF_LAW_NEEDS_EA) ? q->m->EA_N : NULL;
    return !EA_N || fabs(EA_N[of_a] - EA_N[of_b]) <= TOLERANCE * EA_N[of_a];
}

/* Returns the image of the cable at index `here`, or -1. The image has the same rank among the cables
 * between its ends. */
static int find_cable_image(const search *q, int here)
{
    const link *own = q->link + here;
    int a = q->node_image[own->side.from], b = q->node_image[own->side.to], rank = 0, from = 0, to = q->s->n_cable;
    if (a < 0 || b < 0) return -1;
    const hf_side asked = hf_side_of(a, b, 0);
    while (rank < here && !hf_side_compare_nodes(&own->side, &q->link[here - rank - 1].side))
        rank++;
    while (from < to) {
        int middle = from + (to - from) / 2;
        if (hf_side_compare_nodes(&q->link[middle].side, &asked) < 0)
            from = middle + 1;
        else
            to = middle;
    }
    const link *image = q->link + from + rank;
    bool is_found = from + rank < q->s->n_cable && !hf_side_compare_nodes(&image->side, &asked);
    return is_found && is_alike(q, own, image) ? image->side.of : -1;
}

/* ---- one plane ---- */

/* Finds all images under one plane. Returns the number of cables without an image. */
static int reflect(search *q, int axis)
{
    int n_missing = 0;
    for (int i = 0; i < q->s->n_node; i++)
        q->node_image[i] = find_node_image(q, axis, i);
    for (int k = 0; k < q->s->n_cable; k++)
        q->cable_image[q->link[k].side.of] = find_cable_image(q, k);
    for (int e = 0; e < q->s->n_cable; e++) { /* if two nodes have the same position, an image may not point back */
        int image = q->cable_image[e];
        if (image < 0 || q->cable_image[image] != e) n_missing++;
    }
    return n_missing;
}

static hf_status refuse(const search *q, int axis, int n_missing, hf_messages *messages)
{
    char names[NAMED_MAX * 260] = "", more[32] = "";
    for (int e = 0, n = 0; e < q->s->n_cable && n < NAMED_MAX; e++) {
        int image = q->cable_image[e];
        if (image >= 0 && q->cable_image[image] == e) continue;
        n += hf_text_append(names, sizeof names, ", ", q->s->cable_id[e], "");
    }
    if (n_missing > NAMED_MAX) snprintf(more, sizeof more, " and %d more", n_missing - NAMED_MAX);
    char where[HF_LOCATION_SIZE];
    hf_messages_location(messages, where, "optimize.symmetry");
    return hf_error(messages, HF_BAD_CASE,
                    "%s: the net is not symmetric about the plane %c = %.10g m. %d cable%s no mirror image with the "
                    "same ends, roles, loads, group, law and target: %s%s",
                    where, "xy"[axis], (q->low_m[axis] + q->high_m[axis]) / 2, n_missing,
                    n_missing == 1 ? " has" : "s have", names, more);
}

/* ---- classes of design variables ---- */

/* Merges groups whose design variables have the same leader. Numbers the groups again in the order of
 * their design variables. */
static void merge_groups(const search *q, hf_model *m)
{
    int *group_parent = q->group_parent, *label = q->group_label;
    for (int g = 0; g < m->n_variable_group; g++) {
        group_parent[g] = g;
        label[g] = -1;
    }
    for (int k = 0; k < m->n_variable; k++)
        hf_union_find_join(group_parent, m->variable_group[k], m->variable_group[m->variable_leader[k]]);
    m->n_variable_group = 0;
    for (int k = 0; k < m->n_variable; k++) {
        int root = hf_union_find_root(group_parent, m->variable_group[k]);
        if (label[root] < 0) label[root] = m->n_variable_group++;
        m->variable_group[k] = label[root];
    }
}

/* ---- together ---- */

/* Joins two images. Neither is linked if only one of them is varied, or if different rows of
 * optimize.variables vary them. */
static void join_images(search *q, int variable, int image)
{
    const hf_model *m = q->m;
    if (variable < 0 || image < 0 || (m->variable && m->variable[variable].setting != m->variable[image].setting))
        return;
    hf_union_find_join(q->parent, variable, image);
}

static hf_status link_variables(search *q, hf_symmetry asked, hf_model *m, int *planes, hf_messages *messages)
{
    for (int axis = 0; axis < 2; axis++) {
        bool by_name = asked == HF_SYMMETRY_XY || asked == (axis == 0 ? HF_SYMMETRY_X : HF_SYMMETRY_Y);
        if (!by_name && asked != HF_SYMMETRY_AUTO) continue;
        int n_missing = reflect(q, axis);
        if (n_missing && by_name) return refuse(q, axis, n_missing, messages);
        if (n_missing) continue;
        *planes |= axis == 0 ? HF_PLANE_X : HF_PLANE_Y;
        for (int e = 0; e < m->n_cable; e++)
            join_images(q, q->variable_of_cable[e], q->variable_of_cable[q->cable_image[e]]);
        for (int i = 0; i < m->n_node; i++)
            if (q->variable_of_node[i] >= 0)
                join_images(q, q->variable_of_node[i], q->variable_of_node[q->node_image[i]]);
    }
    m->n_leader = 0;
    for (int k = 0; k < m->n_variable; k++) {
        m->variable_leader[k] = hf_union_find_root(q->parent, k);
        m->n_leader += m->variable_leader[k] == k;
    }
    if (*planes) merge_groups(q, m);
    return HF_OK;
}

static void sort(search *q, const hf_optimize_settings *o)
{
    const hf_model *m = q->m;
    for (int i = 0; i < q->s->n_node; i++)
        q->node[i] = (sorted_node){coordinate(q, i, q->sweep), i};
    for (int e = 0; e < q->s->n_cable; e++) {
        hf_side side = hf_side_of(q->s->end[2 * e], q->s->end[2 * e + 1], e);
        q->link[e] = (link){side, m->group[e] << 8 | m->law[e], m->target[e]};
        q->variable_of_cable[e] = -1;
    }
    for (int i = 0; i < m->n_node; i++)
        q->variable_of_node[i] = -1;
    for (int k = 0; k < m->n_variable; k++) {
        q->parent[k] = m->variable_leader[k];
        if (m->variable && o->variable_row[m->variable[k].setting].link != HF_LINK_SYMMETRY) continue;
        if (m->variable_cable[k] >= 0)
            q->variable_of_cable[m->variable_cable[k]] = k;
        else
            q->variable_of_node[m->node_of_row[m->variable[k].support_row]] = k;
    }
    qsort(q->node, (size_t)q->s->n_node, sizeof *q->node, compare_coordinates);
    qsort(q->link, (size_t)q->s->n_cable, sizeof *q->link, compare_links);
}

hf_status hf_symmetry_apply(const hf_scene *scene, const hf_optimize_settings *settings, hf_model *m, int *planes,
                            hf_messages *messages)
{
    hf_symmetry asked = settings->symmetry;
    search q = {.s = scene, .m = m};
    void *block;
    size_t n = (size_t)m->n_node, n_cable = (size_t)m->n_cable;
    *planes = 0;
    if (asked == HF_SYMMETRY_NONE) return HF_OK;
    if (HF_ARENA_ARRAYS(&block, HF_ARRAY(q.node, n), HF_ARRAY(q.link, n_cable), HF_ARRAY(q.node_image, n),
                        HF_ARRAY(q.cable_image, n_cable), HF_ARRAY(q.variable_of_cable, n_cable),
                        HF_ARRAY(q.variable_of_node, n), HF_ARRAY(q.parent, m->n_variable),
                        HF_ARRAY(q.group_parent, m->n_variable_group),
                        HF_ARRAY(q.group_label, m->n_variable_group)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "optimize.symmetry: out of memory");
    measure(&q);
    sort(&q, settings);
    hf_status status = link_variables(&q, asked, m, planes, messages);
    hf_arena_free_block(block);
    return status;
}

const char *hf_symmetry_planes_text(int planes)
{
    static const char *const text[] = {"no plane", "plane x", "plane y", "planes x and y"};
    return text[planes & (HF_PLANE_X | HF_PLANE_Y)];
}

/* ---- steps ---- */

void hf_symmetry_average(const hf_model *m, double *initial)
{
    for (int leader = 0; leader < m->n_variable && m->n_leader < m->n_variable; leader++) {
        double low = initial[leader], high = low, sum = 0;
        int n = 0;
        if (m->variable_leader[leader] != leader || (m->variable && m->variable[leader].scales)) continue;
        for (int k = leader; k < m->n_variable; k++) {
            if (m->variable_leader[k] != leader) continue;
            low = fmin(low, initial[k]);
            high = fmax(high, initial[k]);
            sum += initial[k];
            n++;
        }
        if (!(high - low <= BASE_AGREEMENT * fabs(high))) continue;
        for (int k = leader; k < m->n_variable; k++)
            if (m->variable_leader[k] == leader) initial[k] = sum / n;
    }
}

double hf_symmetry_weight(const hf_model *m, const double *initial, int k)
{
    return initial && m->variable && m->variable[k].scales ? initial[k] / initial[m->variable_leader[k]] : 1;
}

void hf_symmetry_follow(const hf_model *m, const double *initial, double *design)
{
    const int *leader = m->variable_leader;
    for (int k = 0; k < m->n_variable; k++)
        if (initial[k] == initial[leader[k]]) /* equal in every bit: the copy stays exactly symmetric */
            design[k] = design[leader[k]];
        else
            design[k] = initial[k] + hf_symmetry_weight(m, initial, k) * (design[leader[k]] - initial[leader[k]]);
}
