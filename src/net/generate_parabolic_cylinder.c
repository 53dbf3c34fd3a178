/* Makes the quad net over a parabolic cylinder. */
#include <hifdm/generate.h>

#include "base/elementary.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#define NODE_MAX 4000000 /* keeps every index and band offset well inside an int */

const char *const hf_spacing_word[3] = {"equal_arc", "equal_projected", NULL};
const char *const hf_boundary_word[3] = {"outer_edge", "module_edges", NULL};
const char *const hf_supports_word[4] = {"module_corners", "ribs", "perimeter", NULL};

/* Arc length of z = x^2/(4f) from the vertex to x. */
static double arc_length(double x, double focal)
{
    double slope = x / (2 * focal);
    return focal * (slope * sqrt(1 + slope * slope) + hf_inverse_sinh(slope));
}

/* Inverse of arc_length by Newton's method. The function is convex and increasing, and the start s is not below the
 * solution (x <= s); the iterates therefore decrease to the solution, and converge quadratically. */
static double x_at_arc_length(double s, double focal)
{
    double x = s;
    for (int i = 0; i < 60; i++) {
        double step = (arc_length(x, focal) - s) / hf_norm(1, x / (2 * focal), 0);
        x -= step;
        if (fabs(step) <= 1e-16 * fabs(s)) break;
    }
    return x;
}

typedef struct {
    const hf_cylinder *c;
    const double *EA_N; /* by hf_group, 0 = not given */
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
        double t = (2.0 * i - (g->nx - 1)) / (g->nx - 1); /* exactly antisymmetric in i */
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

static bool is_support(const grid *g, int i, int j)
{
    bool on_rib = j % g->c->cells_per_module[1] == 0;
    bool on_perimeter = i == 0 || j == 0 || i == g->nx - 1 || j == g->ny - 1;
    switch (g->c->supports) {
    case HF_SUPPORTS_RIBS:
        return on_rib;
    case HF_SUPPORTS_PERIMETER:
        return on_perimeter;
    default:
        return on_rib && i % g->c->cells_per_module[0] == 0;
    }
}

/* True when the grid line i = const (axis 0) or j = const (axis 1) is made of boundary cables. */
static bool is_boundary_line(const grid *g, int axis, int index)
{
    int last = (axis == 0 ? g->nx : g->ny) - 1;
    if (g->c->boundary == HF_BOUNDARY_MODULE_EDGES) return index % g->c->cells_per_module[axis] == 0;
    return index == 0 || index == last;
}

static hf_group group_of_line(const grid *g, int axis, int index)
{
    return is_boundary_line(g, axis, index) ? HF_GROUP_BOUNDARY : HF_GROUP_INNER;
}

static void assign_roles(const grid *g)
{
    for (int j = 0; j < g->ny; j++)
        for (int i = 0; i < g->nx; i++) {
            bool on_boundary = is_boundary_line(g, 0, i) || is_boundary_line(g, 1, j);
            g->s->role[at(g, i, j)] = (unsigned char)(is_support(g, i, j) ? HF_ROLE_SUPPORT
                                                      : on_boundary       ? HF_ROLE_EDGE
                                                                          : HF_ROLE_INNER);
        }
}

static void add_cable(const grid *g, int *i_cable, int a, int b, hf_group group)
{
    hf_scene *s = g->s;
    int e = (*i_cable)++;
    s->end[2 * e] = a;
    s->end[2 * e + 1] = b;
    s->group[e] = (unsigned char)group;
    s->law[e] = group == HF_GROUP_BOUNDARY ? HF_LAW_LENGTH : HF_LAW_TENSION;
    if (s->EA_N) s->EA_N[e] = g->EA_N[s->group[e]] > 0 ? g->EA_N[s->group[e]] : (double)NAN;
}

static void connect(const grid *g)
{
    int e = 0;
    for (int j = 0; j < g->ny; j++)
        for (int i = 0; i < g->nx; i++) {
            if (i + 1 < g->nx) add_cable(g, &e, at(g, i, j), at(g, i + 1, j), group_of_line(g, 1, j));
            if (j + 1 < g->ny) add_cable(g, &e, at(g, i, j), at(g, i, j + 1), group_of_line(g, 0, i));
        }
}

/* Node k of the grid line that runs along `axis` (0: x, 1: y) at index `line` of the other axis. */
static int on_line(const grid *g, int axis, int line, int k)
{
    return axis == 0 ? at(g, k, line) : at(g, line, k);
}

/* Moves the free nodes of one outer edge inward by the parabola 4 s span t (1-t) between consecutive supports, where
 * span is their distance. A curved edge (axis 0, along x) moves in y; a straight edge moves in x and stays on the
 * cylinder. */
static void scallop_edge(const grid *g, int axis, int line, double inward)
{
    int n = axis == 0 ? g->nx : g->ny, from = 0;
    double *position = g->s->position_m;
    for (int k = 1; k < n; k++) {
        int here = on_line(g, axis, line, k);
        if (g->s->role[here] != HF_ROLE_SUPPORT) continue;
        const double *a = position + 3 * (size_t)on_line(g, axis, line, from), *b = position + 3 * (size_t)here;
        double span = hf_distance(a, b);
        for (int i = from + 1; i < k; i++) {
            double t = (double)(i - from) / (k - from), sag = 4 * g->c->scallop * span * t * (1 - t);
            double *p = position + 3 * (size_t)on_line(g, axis, line, i);
            p[axis == 0 ? 1 : 0] += inward * sag;
            if (axis == 1) p[2] = z_on_parabola(g, p[0]);
        }
        from = k;
    }
}

/* Writes the ids n<i>_<j> of nodes and <node>-<node> of cables. */
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

hf_status hf_scene_parabolic_cylinder(const hf_cylinder *cylinder, const double EA_N[2], hf_scene *scene,
                                      hf_messages *messages)
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
    grid g = {cylinder, EA_N, scene, (int)nx, (int)ny};
    int n_cable = (g.nx - 1) * g.ny + g.nx * (g.ny - 1);
    bool with_EA = EA_N && (EA_N[0] > 0 || EA_N[1] > 0);
    hf_status status = hf_scene_allocate(scene, g.nx * g.ny, n_cable, false, with_EA, false);
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

void hf_scene_parabolic_cylinder_surface(const hf_cylinder *cylinder, hf_surface_settings *surface)
{
    double n_cell = (double)cylinder->modules[0] * cylinder->cells_per_module[0];
    surface->kind = HF_SURFACE_PARABOLIC_CYLINDER;
    surface->focal_length_m = cylinder->focal_length_m;
    if (n_cell > 0) surface->strip_width_m = cylinder->aperture_m / n_cell;
}
