/* Makes the net over a parabolic cylinder:
 *
 *     settings -> count cables and ties -> nodes on a grid (x along the directrix, y along the generatrix)
 *       -> scallop the free outer edges -> cables, boundary cables, edge ties
 *       -> rear net and ties, if asked for, sets of cables, ids (front_net)
 *
 * Contents: the parabola - positions along the axes - what can be made - roles - nodes - scallops - cables -
 * together */
#include <hifdm/generate.h>

#include "base/elementary.h"
#include "net/front_net.h"
#include "net/parabola.h"

#include <math.h>
#include <stdio.h>

#define NODE_MAX 4000000   /* keeps every index and band offset far below the range of int */
#define SUM_TOLERANCE 1e-9 /* relative; pitches are written with about ten digits at most */

const char *const hf_spacing_word[3] = {"equal_arc", "equal_projected", NULL};

/* ---- the parabola ---- */

static double z_on_parabola(const hf_cylinder *c, double x)
{
    return x * x / (4 * c->focal_length_m);
}

/* ---- positions along the axes ---- */

/* Returns the position of module border k for uneven pitches that begin at `from` and end at `to`. Each half is summed
 * from its own end. So symmetric pitches give borders that are symmetric to the last bit. */
static double border(const hf_double_list *pitches, double from, double to, int k)
{
    double low = from, high = to;
    for (int i = 0; i < k; i++)
        low += pitches->value[i];
    for (int i = pitches->n - 1; i >= k; i--)
        high -= pitches->value[i];
    return 2 * k < pitches->n ? low : 2 * k > pitches->n ? high : (low + high) / 2;
}

/* Returns x at this fraction of the arc or of the projection from a to b, as `spacing` says. */
static double x_between(const hf_cylinder *c, double a, double b, double fraction)
{
    if (c->spacing == HF_SPACING_EQUAL_PROJECTED || fraction == 0) return a + (b - a) * fraction;
    double s_a = hf_parabola_arc_m(a, c->focal_length_m), s_b = hf_parabola_arc_m(b, c->focal_length_m);
    double s = s_a + (s_b - s_a) * fraction;
    return copysign(hf_parabola_x_at_arc_m(fabs(s), c->focal_length_m), s);
}

/* Returns x (axis 0) or y (axis 1) of the grid line half_index / 2. An odd half_index is in the middle of a cell. */
static double position_along(const hf_cylinder *c, int axis, int half_index)
{
    const hf_double_list *pitches = axis == 0 ? &c->pitches_x_m : &c->pitches_y_m;
    double half = c->aperture_m / 2, from = axis == 0 ? -half : 0, to = axis == 0 ? half : c->length_m;
    int n = 2 * c->cells_per_module[axis], last = n * c->modules[axis], k = half_index / n, i = half_index % n;
    if (pitches->n > 0) {
        double a = border(pitches, from, to, k), b = i > 0 ? border(pitches, from, to, k + 1) : a;
        return axis == 0 ? x_between(c, a, b, (double)i / n) : a + (b - a) * i / n;
    }
    if (axis == 1) return c->length_m * half_index / last;
    double t = (2.0 * half_index - last) / last; /* exactly antisymmetric */
    if (c->spacing == HF_SPACING_EQUAL_PROJECTED || half_index == 0 || half_index == last) return t * half;
    return copysign(hf_parabola_x_at_arc_m(fabs(t) * hf_parabola_arc_m(half, c->focal_length_m), c->focal_length_m), t);
}

/* ---- what can be made ---- */

static const char *fault_of_pitches(const hf_cylinder *c, int axis, char *what, size_t size)
{
    static const char *const key[] = {"pitches_x_m", "pitches_y_m"}, *const whole[] = {"aperture_m", "length_m"};
    const hf_double_list *pitches = axis == 0 ? &c->pitches_x_m : &c->pitches_y_m;
    double required = axis == 0 ? c->aperture_m : c->length_m, sum = 0;
    for (int i = 0; i < pitches->n; i++)
        sum += pitches->value[i];
    if (pitches->n == 0) return NULL;
    bool are_ascending = true;
    for (int k = 0, n = 2 * c->cells_per_module[axis]; k < pitches->n && pitches->n == c->modules[axis]; k++)
        are_ascending &= position_along(c, axis, k * n) < position_along(c, axis, (k + 1) * n);
    if (pitches->n != c->modules[axis])
        snprintf(what, size, "must have a value for each of the %d modules along %c, and has %d", c->modules[axis],
                 "xy"[axis], pitches -> n);
    else if (fabs(sum - required) > SUM_TOLERANCE * required)
        snprintf(what, size, "must add up to %s, %.12g m, and do to %.12g m", whole[axis], required, sum);
    else if (!are_ascending)
        snprintf(what, size, "must not differ so much that a module vanishes beside the others");
    else
        return NULL;
    return key[axis];
}

/* Returns the smallest module along an axis, m. */
static double smallest_pitch(const hf_cylinder *c, int axis)
{
    double smallest = INFINITY;
    for (int k = 0; k < c->modules[axis]; k++) {
        int n = 2 * c->cells_per_module[axis];
        smallest = fmin(smallest, position_along(c, axis, (k + 1) * n) - position_along(c, axis, k * n));
    }
    return smallest;
}

static const char *fault_of_ties(const hf_cylinder *c, char *what, size_t size)
{
    double smallest = fmin(smallest_pitch(c, 0), smallest_pitch(c, 1));
    if (c->edge_tie_m < smallest) return NULL;
    snprintf(what, size, "of %.6g m must be shorter than the smallest module, %.6g m", c->edge_tie_m, smallest);
    return "edge_tie_m";
}

/* Returns the maximum distance by which a scallop displaces nodes of the edges along `axis`, m. It occurs in
 * the widest module. */
static double largest_sag(const hf_cylinder *c, int axis)
{
    int n = c->cells_per_module[axis];
    double largest = 0, t = (double)(n / 2) / n;
    bool is_held = c->supports == HF_SUPPORTS_PERIMETER || (c->supports == HF_SUPPORTS_RIBS && axis == 0);
    for (int k = 0; k < c->modules[axis] && !is_held; k++) {
        double a = position_along(c, axis, 2 * n * k), b = position_along(c, axis, 2 * n * (k + 1));
        double dz = axis == 0 ? z_on_parabola(c, b) - z_on_parabola(c, a) : 0;
        largest = fmax(largest, 4 * c->scallop * hf_norm(b - a, dz, 0) * t * (1 - t));
    }
    return largest;
}

/* Checks that the edges stay clear of the nodes next to them. If the net has only one cell across, they must stay clear
 * of each other. */
static const char *fault_of_scallops(const hf_cylinder *c, char *what, size_t size)
{
    for (int axis = 0; axis < 2; axis++) {
        int across = 1 - axis, last = 2 * c->cells_per_module[across] * c->modules[across];
        int next = c->pattern == HF_PATTERN_DIAGONAL ? 1 : 2;
        double room = fmin(position_along(c, across, next) - position_along(c, across, 0),
                           position_along(c, across, last) - position_along(c, across, last - next));
        double sag = largest_sag(c, axis);
        if (last == 2 && next == 2) room /= 2;
        if (sag < room) continue;
        snprintf(what, size, "of %g moves edge nodes by %.4g m, past %s %.4g m inward; lower it", c->scallop, sag,
                 last == 2 && next == 2 ? "the middle of the net" : "the next nodes", room);
        return "scallop";
    }
    return NULL;
}

static hf_double_net rear_of(const hf_cylinder *c)
{
    return (hf_double_net){.kind = HF_SURFACE_PARABOLIC_CYLINDER,
                           .focal_length_m = c->focal_length_m,
                           .half_m = c->aperture_m / 2,
                           HF_DOUBLE_NET_OF(c)};
}

/* Checks the rear net. The normals of the front net diverge outwards. On a deep net, the outermost ones can miss the
 * rear net and pass below its rim. */
static const char *fault_of_rear(const hf_cylinder *c, char *what, size_t size)
{
    hf_double_net d = rear_of(c);
    double x = c->aperture_m / 2 + c->edge_tie_m, outermost[3] = {x, 0, z_on_parabola(c, x)}, rear[3];
    const char *key = hf_double_net_fault(&d, what, size);
    if (key || c->rear_distance_m == 0 ||
        hf_double_net_behind(&d, c->tie_direction == HF_TIES_ALONG_Z, outermost, rear))
        return key;
    snprintf(what, size, "normal leads past the rear net at the edge of the aperture; take z or a flatter net");
    return "tie_direction";
}

const char *hf_scene_parabolic_cylinder_fault(const hf_cylinder *cylinder, char *what, size_t size)
{
    const char *key = NULL;
    for (int axis = 0; axis < 2 && !key; axis++)
        key = fault_of_pitches(cylinder, axis, what, size);
    if (!key && cylinder->edge_tie_m > 0) key = fault_of_ties(cylinder, what, size);
    if (!key && cylinder->scallop > 0) key = fault_of_scallops(cylinder, what, size);
    if (!key) key = fault_of_rear(cylinder, what, size);
    return key;
}

/* ---- roles ---- */

typedef struct {
    const hf_cylinder *c;
    hf_front_net *front;
    int nx, ny;                  /* nodes along the directrix and along the generatrix */
    int first_middle, first_tie; /* first node in the middle of a cell; first support of an edge tie */
} grid;

static int at(const grid *g, int i, int j)
{
    return j * g->nx + i;
}

static bool is_on_perimeter(const grid *g, int i, int j)
{
    return i == 0 || j == 0 || i == g->nx - 1 || j == g->ny - 1;
}

/* Returns true if the truss holds this node, directly or by an edge tie. */
static bool is_held(const grid *g, int i, int j)
{
    bool on_rib = j % g->c->cells_per_module[1] == 0;
    if (g->c->supports == HF_SUPPORTS_PERIMETER) return is_on_perimeter(g, i, j);
    return on_rib && (g->c->supports == HF_SUPPORTS_RIBS || i % g->c->cells_per_module[0] == 0);
}

static bool is_tied(const grid *g, int i, int j)
{
    return g->c->edge_tie_m > 0 && is_on_perimeter(g, i, j) && is_held(g, i, j);
}

static bool is_outer_line(const grid *g, int axis, int index)
{
    return index == 0 || index == (axis == 0 ? g->nx : g->ny) - 1;
}

/* Returns true if the grid line i = const (axis 0) or j = const (axis 1) consists of boundary cables. */
static bool is_boundary_line(const grid *g, int axis, int index)
{
    if (g->c->boundary == HF_BOUNDARY_MODULE_EDGES) return index % g->c->cells_per_module[axis] == 0;
    return is_outer_line(g, axis, index);
}

static hf_role role_of(const grid *g, int i, int j)
{
    if (is_held(g, i, j) && !is_tied(g, i, j)) return HF_ROLE_SUPPORT;
    return is_boundary_line(g, 0, i) || is_boundary_line(g, 1, j) ? HF_ROLE_EDGE : HF_ROLE_INNER;
}

/* ---- nodes ---- */

static void put_node(const grid *g, int node, double x, double y, hf_role role, hf_front_label label)
{
    hf_front_net_put(g->front, node, (double[3]){x, y, z_on_parabola(g->c, x)}, role, label);
}

static void put_nodes(const grid *g)
{
    bool with_middles = g->c->pattern == HF_PATTERN_DIAGONAL;
    for (int i = 0; i < g->nx; i++) {
        double x = position_along(g->c, 0, 2 * i),
               middle_x = with_middles && i + 1 < g->nx ? position_along(g->c, 0, 2 * i + 1) : 0;
        for (int j = 0; j < g->ny; j++) {
            put_node(g, at(g, i, j), x, position_along(g->c, 1, 2 * j), role_of(g, i, j), (hf_front_label){"n", i, j});
            if (with_middles && i + 1 < g->nx && j + 1 < g->ny)
                put_node(g, g->first_middle + j * (g->nx - 1) + i, middle_x, position_along(g->c, 1, 2 * j + 1),
                         HF_ROLE_INNER, (hf_front_label){"m", i, j});
        }
    }
}

/* ---- scallops ---- */

/* Returns node k of the grid line along `axis` (0: x, 1: y) that has index `line` on the other axis. */
static int on_line(const grid *g, int axis, int line, int k)
{
    return axis == 0 ? at(g, k, line) : at(g, line, k);
}

/* Moves the free nodes of one outer edge inward by the parabola 4 s span t (1-t) between consecutive held nodes. span
 * is the distance of these nodes, and s is `scallop`. An edge along x (axis 0) is curved and moves in y. An edge along
 * y is straight, moves in x and stays on the cylinder. */
static void scallop_edge(const grid *g, int axis, int line, double inward)
{
    int n = axis == 0 ? g->nx : g->ny, from = 0;
    double *position = g->front->position_m;
    for (int k = 1; k < n; k++) {
        int here = on_line(g, axis, line, k);
        if (!(axis == 0 ? is_held(g, k, line) : is_held(g, line, k))) continue;
        const double *a = position + 3 * (size_t)on_line(g, axis, line, from), *b = position + 3 * (size_t)here;
        double span = hf_distance(a, b);
        for (int i = from + 1; i < k; i++) {
            double t = (double)(i - from) / (k - from), sag = 4 * g->c->scallop * span * t * (1 - t);
            double *p = position + 3 * (size_t)on_line(g, axis, line, i);
            p[axis == 0 ? 1 : 0] += inward * sag;
            if (axis == 1) p[2] = z_on_parabola(g->c, p[0]);
        }
        from = k;
    }
}

static void scallop_edges(const grid *g)
{
    for (int axis = 0; axis < 2 && g->c->scallop > 0; axis++) {
        scallop_edge(g, axis, 0, +1);
        scallop_edge(g, axis, axis == 0 ? g->ny - 1 : g->nx - 1, -1);
    }
}

/* ---- cables ---- */

/* Families of cables, sorted by name: X(enumerator, name, family in the rear net). */
#define FAMILIES(X)                                                                                                    \
    X(DIAGONAL, "diagonal", REAR_DIAGONAL)                                                                             \
    X(DIRECTRIX, "directrix", REAR_DIRECTRIX)                                                                          \
    X(EDGE, "edge", REAR_EDGE)                                                                                         \
    X(EDGE_TIE, "edge_tie", REAR_EDGE_TIE)                                                                             \
    X(FRONT, "front", REAR)                                                                                            \
    X(GENERATRIX, "generatrix", REAR_GENERATRIX)                                                                       \
    X(REAR, "rear", NO_FAMILY)                                                                                         \
    X(REAR_DIAGONAL, "rear_diagonal", NO_FAMILY)                                                                       \
    X(REAR_DIRECTRIX, "rear_directrix", NO_FAMILY)                                                                     \
    X(REAR_EDGE, "rear_edge", NO_FAMILY)                                                                               \
    X(REAR_EDGE_TIE, "rear_edge_tie", NO_FAMILY)                                                                       \
    X(REAR_GENERATRIX, "rear_generatrix", NO_FAMILY)                                                                   \
    X(TIE, "tie", NO_FAMILY)
#define ENUMERATOR(family, name, rear) family,
enum { FAMILIES(ENUMERATOR) N_FAMILY, NO_FAMILY = -1 };
#define NAME(family, name, rear) name,
static const char *const family_name[N_FAMILY] = {FAMILIES(NAME)};
#define BEHIND(family, name, rear) rear,
static const int rear_family[N_FAMILY] = {FAMILIES(BEHIND)};

static void add_cable(const grid *g, int a, int b, hf_group group, int family, int second_family)
{
    hf_front_net_join(g->front, family);
    hf_front_net_join(g->front, second_family);
    hf_front_net_join(g->front, g->c->rear_distance_m > 0 ? FRONT : NO_FAMILY);
    hf_front_net_connect(g->front, a, b, group);
}

/* Adds the cable from node (i, j) to the next node along `axis`. The pattern diagonal has such cables only on boundary
 * lines. Only the quad net has cables between two supports. */
static void add_along(const grid *g, int axis, int i, int j)
{
    int to_i = i + (axis == 0), to_j = j + (axis == 1), line = axis == 0 ? j : i;
    bool is_boundary = is_boundary_line(g, 1 - axis, line);
    if (to_i >= g->nx || to_j >= g->ny) return;
    if (g->c->pattern == HF_PATTERN_DIAGONAL && !is_boundary) return;
    if (g->c->pattern != HF_PATTERN_QUAD && role_of(g, i, j) == HF_ROLE_SUPPORT &&
        role_of(g, to_i, to_j) == HF_ROLE_SUPPORT)
        return;
    add_cable(g, at(g, i, j), at(g, to_i, to_j), is_boundary ? HF_GROUP_BOUNDARY : HF_GROUP_INNER,
              axis == 0 ? DIRECTRIX : GENERATRIX, is_outer_line(g, 1 - axis, line) ? EDGE : NO_FAMILY);
}

/* Adds the diagonals of the cell whose first corner is (i, j). */
static void add_across(const grid *g, int i, int j)
{
    bool falls = g->c->pattern == HF_PATTERN_ALTERNATING && (i + j) % 2 != 0;
    int a = falls ? i + 1 : i, b = falls ? i : i + 1;
    if (i + 1 == g->nx || j + 1 == g->ny || g->c->pattern == HF_PATTERN_QUAD) return;
    if (g->c->pattern == HF_PATTERN_DIAGONAL)
        for (int k = 0; k < 4; k++)
            add_cable(g, at(g, i + k % 2, j + k / 2), g->first_middle + j * (g->nx - 1) + i, HF_GROUP_INNER, DIAGONAL,
                      NO_FAMILY);
    else if (role_of(g, a, j) != HF_ROLE_SUPPORT || role_of(g, b, j + 1) != HF_ROLE_SUPPORT)
        add_cable(g, at(g, a, j), at(g, b, j + 1), HF_GROUP_INNER, DIAGONAL, NO_FAMILY);
}

/* Returns -1 for the first of n lines, 1 for the last, else 0. */
static int side(int index, int n)
{
    return index == 0 ? -1 : index == n - 1;
}

/* Adds the edge ties. Seen along z, they run outward along x or y. At a corner of the net they extend by the same
 * distance along both. They end on the cylinder. */
static void add_edge_ties(const grid *g)
{
    double edge_tie_m = g->c->edge_tie_m;
    for (int j = 0; j < g->ny; j++)
        for (int i = 0; i < g->nx; i++) {
            if (!is_tied(g, i, j)) continue;
            int node = g->front->n_node++;
            if (g->front->position_m) {
                const double *p = g->front->position_m + 3 * (size_t)at(g, i, j);
                put_node(g, node, p[0] + side(i, g->nx) * edge_tie_m, p[1] + side(j, g->ny) * edge_tie_m,
                         HF_ROLE_SUPPORT, (hf_front_label){"s", i, j});
            }
            add_cable(g, node, at(g, i, j), HF_GROUP_BOUNDARY, EDGE_TIE, NO_FAMILY);
        }
}

/* ---- together ---- */

/* Adds all nodes and cables, for hf_front_net_make. */
static void add_all(void *context, hf_front_net *front)
{
    grid *g = context;
    g->front = front;
    front->n_node = g->first_tie;
    if (front->position_m) {
        put_nodes(g);
        scallop_edges(g);
    }
    for (int j = 0; j < g->ny; j++)
        for (int i = 0; i < g->nx; i++) {
            add_along(g, 0, i, j);
            add_along(g, 1, i, j);
            add_across(g, i, j);
        }
    add_edge_ties(g);
}

hf_status hf_scene_parabolic_cylinder(const hf_cylinder *cylinder, const double EA_N[2], hf_scene *scene,
                                      hf_messages *messages)
{
    char what[HF_GENERATE_FAULT_SIZE];
    *scene = (hf_scene){0};
    double nx = (double)cylinder->modules[0] * cylinder->cells_per_module[0] + 1;
    double ny = (double)cylinder->modules[1] * cylinder->cells_per_module[1] + 1;
    bool with_middles = cylinder->pattern == HF_PATTERN_DIAGONAL, is_double = cylinder->rear_distance_m > 0;
    if ((nx * ny + (with_middles ? (nx - 1) * (ny - 1) : 0)) * (is_double ? 2 : 1) > NODE_MAX)
        return hf_error(messages, HF_BAD_CASE, "scene: %.0f x %.0f nodes%s%s exceed the maximum of %d nodes", nx, ny,
                        with_middles ? " and those in the middle of cells" : "", is_double ? ", twice," : "", NODE_MAX);
    const char *key = hf_scene_parabolic_cylinder_fault(cylinder, what, sizeof what);
    if (key) return hf_error(messages, HF_BAD_CASE, "scene.parabolic_cylinder.%s: %s", key, what);
    const hf_double_net rear = rear_of(cylinder);
    if (hf_double_net_lacks_EA(&rear, EA_N))
        return hf_error(messages, HF_BAD_CASE,
                        "scene.parabolic_cylinder.tie_law: the law elastic needs the stiffness of the inner cables "
                        "(scene.EA_inner_N)");
    grid g = {.c = cylinder, .nx = (int)nx, .ny = (int)ny};
    g.first_middle = g.nx * g.ny;
    g.first_tie = g.first_middle + (with_middles ? (g.nx - 1) * (g.ny - 1) : 0);
    const hf_front_families families = {N_FAMILY, family_name, rear_family, TIE};
    hf_front_net front;
    hf_status status = hf_front_net_make(add_all, &g, &front);
    if (status == HF_OK) status = hf_front_net_scene(&front, &rear, EA_N, &families, scene);
    hf_front_net_free(&front);
    if (status != HF_OK) return hf_error(messages, status, "scene: out of memory for %d nodes", g.first_tie);
    return HF_OK;
}

void hf_scene_parabolic_cylinder_surface(const hf_cylinder *cylinder, hf_surface_settings *surface)
{
    double n_cell = (double)cylinder->modules[0] * cylinder->cells_per_module[0];
    bool are_even = cylinder->pitches_x_m.n == 0 && cylinder->pattern != HF_PATTERN_DIAGONAL;
    surface->kind = HF_SURFACE_PARABOLIC_CYLINDER;
    surface->focal_length_m = cylinder->focal_length_m;
    if (n_cell > 0 && are_even) surface->strip_width_m = cylinder->aperture_m / n_cell;
}
