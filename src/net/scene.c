/* Contents: words - memory - parabolic cylinder - checks */
#include <hifdm/scene.h>

#include "base/arena.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NODE_MAX 4000000 /* keeps every index and band offset well inside an int */
#define FAULT_MAX 20     /* faults of one kind that are spelled out */

const char *const hf_role_word[3] = {"support", "inner", "edge"};
const char *const hf_group_word[2] = {"inner", "boundary"};

/* ---- memory ---- */

static void lay_out(hf_arena *arena, hf_scene *s, int with_load, int with_EA, int with_line)
{
    size_t n = (size_t)s->n_node, m = (size_t)s->n_cable;
    s->position_m = hf_arena_take(arena, 3 * n, sizeof *s->position_m);
    s->load_N = with_load ? hf_arena_take(arena, 3 * n, sizeof *s->load_N) : NULL;
    s->role = hf_arena_take(arena, n, sizeof *s->role);
    s->end = hf_arena_take(arena, 2 * m, sizeof *s->end);
    s->group = hf_arena_take(arena, m, sizeof *s->group);
    s->law = hf_arena_take(arena, m, sizeof *s->law);
    s->target = hf_arena_take(arena, m, sizeof *s->target);
    s->EA_N = with_EA ? hf_arena_take(arena, m, sizeof *s->EA_N) : NULL;
    s->node_id = hf_arena_take(arena, n, sizeof *s->node_id);
    s->cable_id = hf_arena_take(arena, m, sizeof *s->cable_id);
    s->node_line = with_line ? hf_arena_take(arena, n, sizeof *s->node_line) : NULL;
    s->cable_line = with_line ? hf_arena_take(arena, m, sizeof *s->cable_line) : NULL;
}

hf_status hf_scene_allocate(hf_scene *scene, int n_node, int n_cable, int with_load, int with_EA, int with_line)
{
    *scene = (hf_scene){.n_node = n_node, .n_cable = n_cable};
    hf_arena arena = {0};
    if (HF_ARENA_MAKE(&arena, lay_out(&arena, scene, with_load, with_EA, with_line)) != HF_OK) {
        *scene = (hf_scene){0};
        return HF_NO_MEMORY;
    }
    scene->block = arena.block;
    return HF_OK;
}

void hf_scene_free(hf_scene *scene)
{
    free(scene->block);
    free(scene->text);
    *scene = (hf_scene){0};
}

double hf_scene_theoretical_length(const hf_scene *scene, int i_cable)
{
    const double *a = scene->position_m + 3 * (size_t)scene->end[2 * i_cable];
    const double *b = scene->position_m + 3 * (size_t)scene->end[2 * i_cable + 1];
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* ---- parabolic cylinder ---- */

/* Arc length of z = x^2/(4f) from the vertex to x. */
static double arc_length(double x, double focal)
{
    double slope = x / (2 * focal);
    return focal * (slope * sqrt(1 + slope * slope) + asinh(slope));
}

/* Inverse of arc_length: Newton on a convex increasing function, from above (x <= s), quadratic. */
static double x_at_arc_length(double s, double focal)
{
    double x = s;
    for (int i = 0; i < 60; i++) {
        double step = (arc_length(x, focal) - s) / hypot(1, x / (2 * focal));
        x -= step;
        if (fabs(step) <= 1e-16 * fabs(s)) break;
    }
    return x;
}

typedef struct {
    const hf_cylinder *c;
    hf_scene *s;
    int nx, ny; /* nodes along the directrix and the generatrix */
} grid;

static int at(const grid *g, int i, int j)
{
    return j * g->nx + i;
}

static double z_on_parabola(const grid *g, double x)
{
    return x * x / (4 * g->c->focal_length_m);
}

static void place_nodes(const grid *g)
{
    double half = g->c->aperture_m / 2, focal = g->c->focal_length_m;
    double half_arc = arc_length(half, focal);
    for (int i = 0; i < g->nx; i++) {
        double t = (2.0 * i - (g->nx - 1)) / (g->nx - 1); /* exactly antisymmetric */
        double x = t * half;
        if (g->c->spacing == HF_SPACING_EQUAL_ARC && i != 0 && i != g->nx - 1)
            x = copysign(x_at_arc_length(fabs(t) * half_arc, focal), t);
        for (int j = 0; j < g->ny; j++) {
            double *p = g->s->position_m + 3 * (size_t)at(g, i, j);
            p[0] = x;
            p[1] = g->c->length_m * j / (g->ny - 1);
            p[2] = z_on_parabola(g, x);
        }
    }
}

static int is_support(const grid *g, int i, int j)
{
    int on_rib = j % g->c->cells_per_module[1] == 0;
    int on_perimeter = i == 0 || j == 0 || i == g->nx - 1 || j == g->ny - 1;
    switch (g->c->supports) {
    case HF_SUPPORTS_RIBS:
        return on_rib;
    case HF_SUPPORTS_PERIMETER:
        return on_perimeter;
    default:
        return on_rib && i % g->c->cells_per_module[0] == 0;
    }
}

/* Is the grid line i = const (axis 0) or j = const (axis 1) made of boundary cables? */
static int is_boundary_line(const grid *g, int axis, int index)
{
    int last = (axis == 0 ? g->nx : g->ny) - 1;
    if (g->c->boundary == HF_BOUNDARY_MODULE_EDGES) return index % g->c->cells_per_module[axis] == 0;
    return index == 0 || index == last;
}

static void assign_roles(const grid *g)
{
    for (int j = 0; j < g->ny; j++)
        for (int i = 0; i < g->nx; i++) {
            int on_boundary = is_boundary_line(g, 0, i) || is_boundary_line(g, 1, j);
            g->s->role[at(g, i, j)] = (unsigned char)(is_support(g, i, j) ? HF_ROLE_SUPPORT
                                                      : on_boundary       ? HF_ROLE_EDGE
                                                                          : HF_ROLE_INNER);
        }
}

static void add_cable(const grid *g, int *i_cable, int a, int b, int boundary)
{
    hf_scene *s = g->s;
    int e = (*i_cable)++;
    s->end[2 * e] = a;
    s->end[2 * e + 1] = b;
    s->group[e] = boundary ? HF_GROUP_BOUNDARY : HF_GROUP_INNER;
    s->law[e] = boundary ? HF_LAW_LENGTH : HF_LAW_TENSION;
    if (s->EA_N) s->EA_N[e] = g->c->EA_N[s->group[e]] > 0 ? g->c->EA_N[s->group[e]] : (double)NAN;
}

static void connect(const grid *g)
{
    int e = 0;
    for (int j = 0; j < g->ny; j++)
        for (int i = 0; i < g->nx; i++) {
            if (i + 1 < g->nx) add_cable(g, &e, at(g, i, j), at(g, i + 1, j), is_boundary_line(g, 1, j));
            if (j + 1 < g->ny) add_cable(g, &e, at(g, i, j), at(g, i, j + 1), is_boundary_line(g, 0, i));
        }
}

/* Node k of the grid line that runs along `axis` (0: x, 1: y) at index `line` of the other axis. */
static int on_line(const grid *g, int axis, int line, int k)
{
    return axis == 0 ? at(g, k, line) : at(g, line, k);
}

/* Move the free nodes of one outer edge inward by the parabola 4 s span t (1-t) between consecutive supports. A curved
 * edge (axis 0, along x) moves in y, its span the chord; a straight edge moves in x and stays on the cylinder. */
static void scallop_edge(const grid *g, int axis, int line, double inward)
{
    int n = axis == 0 ? g->nx : g->ny, from = 0;
    double *position = g->s->position_m;
    for (int k = 1; k < n; k++) {
        int here = on_line(g, axis, line, k);
        if (g->s->role[here] != HF_ROLE_SUPPORT) continue;
        const double *a = position + 3 * (size_t)on_line(g, axis, line, from), *b = position + 3 * (size_t)here;
        double span = hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
        for (int i = from + 1; i < k; i++) {
            double t = (double)(i - from) / (k - from), sag = 4 * g->c->scallop * span * t * (1 - t);
            double *p = position + 3 * (size_t)on_line(g, axis, line, i);
            p[axis == 0 ? 1 : 0] += inward * sag;
            if (axis == 1) p[2] = z_on_parabola(g, p[0]);
        }
        from = k;
    }
}

/* Ids n<i>_<j> and <node>-<node>. */
static hf_status name_all(const grid *g)
{
    hf_scene *s = g->s;
    size_t n_digit = 16, size = (size_t)s->n_node * n_digit + (size_t)s->n_cable * 2 * n_digit;
    char *text = s->text = malloc(size);
    if (!text) return HF_NO_MEMORY;
    const char *end = text + size;
    for (int j = 0; j < g->ny; j++)
        for (int i = 0; i < g->nx; i++) {
            s->node_id[at(g, i, j)] = text;
            text += snprintf(text, (size_t)(end - text), "n%d_%d", i, j) + 1;
        }
    for (int e = 0; e < s->n_cable; e++) {
        s->cable_id[e] = text;
        text +=
            snprintf(text, (size_t)(end - text), "%s-%s", s->node_id[s->end[2 * e]], s->node_id[s->end[2 * e + 1]]) + 1;
    }
    return HF_OK;
}

hf_status hf_scene_parabolic_cylinder(const hf_cylinder *cylinder, hf_scene *scene, hf_messages *messages)
{
    *scene = (hf_scene){0};
    double nx = (double)cylinder->modules[0] * cylinder->cells_per_module[0] + 1;
    double ny = (double)cylinder->modules[1] * cylinder->cells_per_module[1] + 1;
    if (nx * ny > NODE_MAX)
        return hf_error(messages, HF_BAD_CASE, "scene: %.0f x %.0f nodes are more than this program takes (%d)", nx, ny,
                        NODE_MAX);
    double cell_x = cylinder->aperture_m / (nx - 1), cell_y = cylinder->length_m / (ny - 1);
    double sag_x = cylinder->scallop * cell_y * cylinder->cells_per_module[1];
    double sag_y = cylinder->scallop * cell_x * cylinder->cells_per_module[0];
    if (cylinder->supports != HF_SUPPORTS_PERIMETER && (sag_x >= cell_x || sag_y >= cell_y))
        return hf_error(messages, HF_BAD_CASE,
                        "scene: scallop %g moves edge nodes by %.3g m, past the next nodes %.3g m inward; lower it",
                        cylinder->scallop, sag_x / cell_x > sag_y / cell_y ? sag_x : sag_y,
                        sag_x / cell_x > sag_y / cell_y ? cell_x : cell_y);
    grid g = {cylinder, scene, (int)nx, (int)ny};
    int n_cable = (g.nx - 1) * g.ny + g.nx * (g.ny - 1);
    int with_EA = cylinder->EA_N[0] > 0 || cylinder->EA_N[1] > 0;
    hf_status status = hf_scene_allocate(scene, g.nx * g.ny, n_cable, 0, with_EA, 0);
    if (status == HF_OK) {
        place_nodes(&g);
        assign_roles(&g);
        connect(&g);
        if (cylinder->scallop > 0) {
            scallop_edge(&g, 0, 0, +1);
            scallop_edge(&g, 0, g.ny - 1, -1);
            scallop_edge(&g, 1, 0, +1);
            scallop_edge(&g, 1, g.nx - 1, -1);
        }
        for (int e = 0; e < n_cable; e++)
            scene->target[e] = hf_law_default_target(scene->law[e], hf_scene_theoretical_length(scene, e));
        status = name_all(&g);
    }
    if (status != HF_OK) return hf_error(messages, status, "scene: out of memory for %d nodes", g.nx * g.ny);
    return HF_OK;
}

/* ---- checks ---- */

/* "nodes.csv:7: node 'a'" or "scene: node 'a'" */
static void describe(const hf_scene *s, int is_cable, int index, char *text, size_t size)
{
    const int *line = is_cable ? s->cable_line : s->node_line;
    const char *file = is_cable ? s->cables_file : s->nodes_file, *kind = is_cable ? "cable" : "node";
    const char *id = is_cable ? s->cable_id[index] : s->node_id[index];
    if (line && file)
        snprintf(text, size, "%s:%d: %s '%s'", file, line[index], kind, id);
    else
        snprintf(text, size, "scene: %s '%s'", kind, id);
}

static void fault(const hf_scene *s, int is_cable, int index, int *n_fault, const char *what, hf_messages *messages)
{
    char where[512];
    if (++*n_fault > FAULT_MAX) return;
    describe(s, is_cable, index, where, sizeof where);
    hf_text_trim_utf8(where);
    hf_error(messages, HF_BAD_CASE, "%s %s", where, what);
}

static void check_nodes(const hf_scene *s, int *n_fault, hf_messages *messages)
{
    for (int i = 0; i < s->n_node; i++)
        for (int c = 0; c < 3; c++) {
            if (!isfinite(s->position_m[3 * i + c]))
                fault(s, 0, i, n_fault, "has a position that is no number", messages);
            if (s->load_N && !isfinite(s->load_N[3 * i + c]))
                fault(s, 0, i, n_fault, "has a load that is no number", messages);
        }
}

/* A cable whose law needs its stiffness. */
static void check_elastic(const hf_scene *s, int e, int *n_fault, hf_messages *messages)
{
    char what[96];
    const char *word = hf_law_word[s->law[e]];
    snprintf(what, sizeof what, "has the law %s, but no %s above zero", word, hf_law_target_name[s->law[e]]);
    if (!(s->target[e] > 0)) fault(s, 1, e, n_fault, what, messages);
    snprintf(what, sizeof what, "has the law %s, but no EA_N above zero", word);
    if (!(s->EA_N && s->EA_N[e] > 0)) fault(s, 1, e, n_fault, what, messages);
}

static void check_cables(const hf_scene *s, int *n_fault, hf_messages *messages)
{
    for (int e = 0; e < s->n_cable; e++) {
        int a = s->end[2 * e], b = s->end[2 * e + 1];
        if (a == b)
            fault(s, 1, e, n_fault, "joins a node to itself", messages);
        else if (!(hf_scene_theoretical_length(s, e) > 0))
            fault(s, 1, e, n_fault, "has zero length: its two nodes are at the same position", messages);
        if (hf_law_has(s->law[e], HF_LAW_NEEDS_EA)) check_elastic(s, e, n_fault, messages);
    }
}

/* Union-find with path halving: joins all nodes that cables connect. */
static int find_root(int *parent, int i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

static hf_status check_anchored(const hf_scene *s, int *n_fault, hf_messages *messages)
{
    int *parent = malloc((size_t)s->n_node * 2 * sizeof *parent);
    if (!parent) return hf_error(messages, HF_NO_MEMORY, "scene: out of memory");
    int *anchored = parent + s->n_node;
    for (int i = 0; i < s->n_node; i++) {
        parent[i] = i;
        anchored[i] = 0;
    }
    for (int e = 0; e < s->n_cable; e++)
        parent[find_root(parent, s->end[2 * e])] = find_root(parent, s->end[2 * e + 1]);
    for (int i = 0; i < s->n_node; i++)
        if (s->role[i] == HF_ROLE_SUPPORT) anchored[find_root(parent, i)] = 1;
    for (int i = 0; i < s->n_node; i++)
        if (!anchored[find_root(parent, i)])
            fault(s, 0, i, n_fault, "has no path of cables to a support; connect it or remove it", messages);
    free(parent);
    return HF_OK;
}

hf_status hf_scene_check(const hf_scene *scene, hf_messages *messages)
{
    int n_fault = 0, n_free = 0, n_inner = 0;
    for (int i = 0; i < scene->n_node; i++) {
        n_free += scene->role[i] != HF_ROLE_SUPPORT;
        n_inner += scene->role[i] == HF_ROLE_INNER;
    }
    if (n_free == 0) return hf_error(messages, HF_BAD_CASE, "scene: every node is a support: there is nothing to find");
    if (n_inner == 0)
        return hf_error(messages, HF_BAD_CASE,
                        "scene: no node has the role 'inner': psi would count nothing; give inner nodes that role");
    check_nodes(scene, &n_fault, messages);
    if (n_fault == 0) check_cables(scene, &n_fault, messages);
    HF_TRY(check_anchored(scene, &n_fault, messages));
    if (n_fault > FAULT_MAX) hf_error(messages, HF_BAD_CASE, "scene: and %d more faults", n_fault - FAULT_MAX);
    return n_fault ? HF_BAD_CASE : HF_OK;
}
