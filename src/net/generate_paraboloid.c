/* Makes the net over a paraboloid with a round aperture, alone or tied to a rear net.
 * Contents: surfaces - what can be made - the plane grid - the triangular grid - the quad grid - nodes - cables - names
 * - together */
#include <hifdm/generate.h>

#include "base/elementary.h"
#include "net/parabola.h"
#include <hifdm/cable_set.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define NODE_MAX 4000000  /* keeps every index and band offset well inside an int */
#define LEAST_EDGE 0.25   /* of a cell: no cable of the quad grid ends nearer to the rim than this */
#define SAME_SUPPORT 1e-9 /* of the radius: ends of rows and columns that meet on the rim */
#define HALF_ROOT_3 0.86602540378443864676
#define PI 3.14159265358979323846

const char *const hf_grid_word[3] = {"triangle", "quad", NULL};
const char *const hf_tie_direction_word[3] = {"z", "normal", NULL};
#define LAW_WORD(name, word, target, unit, flags) word,
const char *const hf_tie_law_word[HF_N_LAW + 1] = {HF_LAW_LIST(LAW_WORD) NULL};
#undef LAW_WORD

/* ---- surfaces ---- */

static double radius(const hf_paraboloid *p)
{
    return p->aperture_m / 2;
}

static double rear_focal_length_m(const hf_paraboloid *p)
{
    return p->rear_focal_length_m > 0 ? p->rear_focal_length_m : p->focal_length_m;
}

static double z_front(const hf_paraboloid *p, double x, double y)
{
    return (x * x + y * y) / (4 * p->focal_length_m);
}

static double z_rear(const hf_paraboloid *p, double x, double y)
{
    double dx = x - p->offset_m, above_m2 = radius(p) * radius(p) - dx * dx - y * y;
    return z_front(p, x, y) + above_m2 / (4 * p->focal_length_m) - p->rear_distance_m +
           above_m2 / (4 * rear_focal_length_m(p));
}

/* Where the normal of the front net at (x, y) meets the rear net, by Newton's method along it. */
static void follow_normal(const hf_paraboloid *p, const double front[3], double rear[3])
{
    double n[3] = {front[0] / (2 * p->focal_length_m), front[1] / (2 * p->focal_length_m), -1}, t = 0;
    for (int i = 0; i < 60; i++) {
        for (int c = 0; c < 3; c++)
            rear[c] = front[c] + t * n[c];
        double slope_x = rear[0] / (2 * p->focal_length_m) - (rear[0] - p->offset_m) / (2 * p->focal_length_m) -
                         (rear[0] - p->offset_m) / (2 * rear_focal_length_m(p));
        double slope_y = -rear[1] / (2 * rear_focal_length_m(p));
        double step = (rear[2] - z_rear(p, rear[0], rear[1])) / (n[2] - slope_x * n[0] - slope_y * n[1]);
        t -= step;
        if (fabs(step) <= 1e-16 * fabs(t)) break;
    }
    rear[2] = z_rear(p, rear[0], rear[1]);
}

/* ---- what can be made ---- */

/* Does a normal from the outermost free nodes lead past the rim of the rear net, or nowhere? */
static bool leaves_rim(const hf_paraboloid *p)
{
    double R = radius(p), r = R * (p->rings - (p->grid == HF_GRID_QUAD ? LEAST_EDGE : 1)) / p->rings;
    for (int k = 0; k < 24; k++) {
        double angle = PI / 12 * k, rear[3], front[3] = {p->offset_m + r * hf_cosine(angle), r * hf_sine(angle), 0};
        front[2] = z_front(p, front[0], front[1]);
        follow_normal(p, front, rear);
        if (!(hf_norm(rear[0] - p->offset_m, rear[1], 0) < R && rear[2] < front[2])) return true;
    }
    return false;
}

const char *hf_scene_paraboloid_fault(const hf_paraboloid *p, char *what, size_t size)
{
    double R = radius(p), sag_m = R * R / (4 * p->focal_length_m) + R * R / (4 * rear_focal_length_m(p));
    if (p->rear_distance_m == 0) return NULL;
    if (p->rear_distance_m > sag_m) {
        if (p->tie_direction != HF_TIES_ALONG_NORMAL || p->rings == 1 || !leaves_rim(p)) return NULL;
        snprintf(what, size,
                 "normal leads to places outside the rim of the rear net; take z, a flatter front net or "
                 "fewer rings");
        return "tie_direction";
    }
    snprintf(what, size, "of %.6g m lets the nets meet in the middle, where they come %.6g m nearer than at the rim",
             p->rear_distance_m, sag_m);
    return "rear_distance_m";
}

/* ---- the plane grid ---- */

/* Nodes and cables in the plane of the aperture, about its middle, of one net. */
typedef struct {
    int n_node, n_cable;
    double *plane_m; /* [n_node][2]; NULL while counting */
    bool *is_rim;    /* [n_node] a support */
    int *label;      /* [n_node][2] for the id */
    int *end;        /* [n_cable][2] */
} plane_grid;

static int add_point(plane_grid *g, double x, double y, bool is_rim, int a, int b)
{
    int node = g->n_node++;
    if (!g->plane_m) return node;
    g->plane_m[2 * node] = x;
    g->plane_m[2 * node + 1] = y;
    g->is_rim[node] = is_rim;
    g->label[2 * node] = a;
    g->label[2 * node + 1] = b;
    return node;
}

static void add_line(plane_grid *g, int a, int b)
{
    if (g->end) g->end[2 * g->n_cable] = a, g->end[2 * g->n_cable + 1] = b;
    g->n_cable++;
}

/* Moves a point along its radius so that radii are divided evenly in arc length. */
static double spread(const hf_paraboloid *p, double r)
{
    double R = radius(p);
    if (p->spacing == HF_SPACING_EQUAL_PROJECTED || r == 0) return 1;
    return hf_parabola_x_at_arc_m(r / R * hf_parabola_arc_m(R, p->focal_length_m), p->focal_length_m) / r;
}

/* ---- the triangular grid ---- */

static int first_of_ring(int ring)
{
    return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1);
}

/* Ring k has 6k nodes, k to a side of a hexagon; those of the last ring stand evenly on the rim. */
static void place_ring(const hf_paraboloid *p, plane_grid *g, int ring)
{
    static const double corner[7][2] = {
        {1, 0}, {0.5, HALF_ROOT_3}, {-0.5, HALF_ROOT_3}, {-1, 0}, {-0.5, -HALF_ROOT_3}, {0.5, -HALF_ROOT_3}, {1, 0}};
    double R = radius(p), cell = R / p->rings;
    for (int i = 0; i < 6 * ring; i++) {
        int side = i / ring, j = i % ring;
        double x = cell * (ring * corner[side][0] + j * (corner[side + 1][0] - corner[side][0]));
        double y = cell * (ring * corner[side][1] + j * (corner[side + 1][1] - corner[side][1]));
        double scale = spread(p, hf_norm(x, y, 0)), angle = PI / 3 * i / ring;
        if (ring == p->rings)
            add_point(g, R * hf_cosine(angle), R * hf_sine(angle), true, ring, i);
        else
            add_point(g, scale * x, scale * y, false, ring, i);
    }
}

/* Cables along the ring, and outward: two from each node, three from a corner. */
static void join_ring(const hf_paraboloid *p, plane_grid *g, int ring)
{
    int here = first_of_ring(ring), out = first_of_ring(ring + 1), n = 6 * ring, n_out = 6 * (ring + 1);
    for (int i = 0; i < n && ring < p->rings; i++) {
        int side = i / ring, j = i % ring, next = side * (ring + 1) + j;
        add_line(g, here + i, here + (i + 1) % n);
        if (j == 0) add_line(g, here + i, out + (next + n_out - 1) % n_out);
        add_line(g, here + i, out + next);
        add_line(g, here + i, out + next + 1);
    }
}

static void make_triangles(const hf_paraboloid *p, plane_grid *g)
{
    add_point(g, 0, 0, false, 0, 0);
    for (int ring = 1; ring <= p->rings; ring++)
        place_ring(p, g, ring);
    for (int i = 0; i < 6; i++)
        add_line(g, 0, 1 + i);
    for (int ring = 1; ring < p->rings; ring++)
        join_ring(p, g, ring);
}

/* ---- the quad grid ---- */

/* The last node of row or column k, counted from the middle: the farthest inside the rim. */
static int last_in_row(const hf_paraboloid *p, int k)
{
    double n = p->rings - LEAST_EDGE;
    return k > n ? -1 : (int)sqrt(n * n - (double)k * k);
}

/* The support at the end of a row or column, made unless the other one has made it. */
static int rim_point(const hf_paraboloid *p, plane_grid *g, int first_support, double x, double y)
{
    for (int i = first_support; g->plane_m && i < g->n_node; i++)
        if (hf_norm(g->plane_m[2 * i] - x, g->plane_m[2 * i + 1] - y, 0) < SAME_SUPPORT * radius(p)) return i;
    return add_point(g, x, y, true, -1, g->n_node - first_support);
}

/* node: [2 rings + 1][2 rings + 1] scratch, by rows: the nodes of the grid. */
static void make_quads(const hf_paraboloid *p, plane_grid *g, int *node)
{
    int N = p->rings, width = 2 * N + 1;
    double cell = radius(p) / N;
    for (int j = -N; j <= N; j++)
        for (int i = -last_in_row(p, abs(j)); i <= last_in_row(p, abs(j)); i++) {
            double scale = spread(p, cell * hf_norm(i, j, 0));
            node[(j + N) * width + i + N] = add_point(g, scale * cell * i, scale * cell * j, false, i + N, j + N);
        }
    int first_support = g->n_node;
    for (int axis = 0; axis < 2; axis++)
        for (int k = -N; k <= N; k++) {
            int last = last_in_row(p, abs(k)), step = axis == 0 ? 1 : width;
            if (last < 0) continue;
            int *line = axis == 0 ? node + (k + N) * width + N : node + N * width + k + N;
            double along = sqrt((double)N * N - (double)k * k) * cell, across = k * cell;
            for (int i = -last; i < last; i++)
                add_line(g, line[i * step], line[(i + 1) * step]);
            for (int end = -1; end <= 1; end += 2)
                add_line(
                    g, line[end * last * step],
                    rim_point(p, g, first_support, axis == 0 ? end * along : across, axis == 0 ? across : end * along));
        }
}

/* ---- nodes ---- */

typedef struct {
    const hf_paraboloid *p;
    const double *EA_N; /* by hf_group, 0 = not given */
    hf_scene *s;
    plane_grid g;
    int n_layer;           /* 1, or 2 with a rear net */
    int n_cable, n_member; /* so far; with member == NULL they are only counted */
    hf_cable_set_member *member;
} double_net;

/* The free nodes of the rear net are edge nodes, which psi leaves out. */
static void place_layer_nodes(const double_net *d)
{
    const hf_paraboloid *p = d->p;
    int n = d->g.n_node;
    for (int i = 0; i < n; i++) {
        bool is_rim = d->g.is_rim[i];
        double *front = d->s->position_m + 3 * (size_t)i, *rear = front + 3 * (size_t)n;
        front[0] = d->g.plane_m[2 * i] + p->offset_m;
        front[1] = d->g.plane_m[2 * i + 1];
        front[2] = z_front(p, front[0], front[1]);
        d->s->role[i] = is_rim ? HF_ROLE_SUPPORT : HF_ROLE_INNER;
        if (d->n_layer == 1) continue;
        d->s->role[n + i] = is_rim ? HF_ROLE_SUPPORT : HF_ROLE_EDGE;
        rear[0] = front[0];
        rear[1] = front[1];
        rear[2] = is_rim ? front[2] - p->rear_distance_m : z_rear(p, rear[0], rear[1]);
        if (!is_rim && p->tie_direction == HF_TIES_ALONG_NORMAL) follow_normal(p, front, rear);
    }
}

/* ---- cables ---- */

/* Families of cables, in the order of their names. */
enum { FRONT, FRONT_EDGE, REAR, REAR_EDGE, TIE, N_FAMILY };
static const char *const family_name[N_FAMILY] = {"front", "front_edge", "rear", "rear_edge", "tie"};

/* The tie's target by its law, where its tension at the theoretical length is to be tie_tension_N. */
static double tie_target(const hf_paraboloid *p, double length, double EA_N)
{
    switch (p->tie_law) {
    case HF_LAW_TENSION:
        return p->tie_tension_N;
    case HF_LAW_FORCE_DENSITY:
        return p->tie_tension_N / length;
    case HF_LAW_ELASTIC:
        return length / (1 + p->tie_tension_N / EA_N);
    default:
        return length;
    }
}

static void put_cable(double_net *d, int a, int b, int family)
{
    hf_scene *s = d->s;
    int e = d->n_cable++, group = family == FRONT_EDGE || family == REAR_EDGE ? HF_GROUP_BOUNDARY : HF_GROUP_INNER;
    if (d->member) d->member[d->n_member] = (hf_cable_set_member){family, e};
    d->n_member++;
    if (!d->member) return;
    double EA_N = d->EA_N && d->EA_N[group] > 0 ? d->EA_N[group] : (double)NAN;
    s->end[2 * e] = a;
    s->end[2 * e + 1] = b;
    s->group[e] = (unsigned char)group;
    s->law[e] = family == TIE                ? (unsigned char)d->p->tie_law
                : group == HF_GROUP_BOUNDARY ? HF_LAW_LENGTH
                                             : HF_LAW_TENSION;
    double length = hf_scene_theoretical_length(s, e);
    s->target[e] = family == TIE ? tie_target(d->p, length, EA_N) : hf_law_default_target(s->law[e], length);
    if (s->EA_N) s->EA_N[e] = EA_N;
}

static void put_cables(double_net *d)
{
    d->n_cable = d->n_member = 0;
    for (int layer = 0; layer < d->n_layer; layer++)
        for (int k = 0; k < d->g.n_cable; k++) {
            int a = d->g.end[2 * k], b = d->g.end[2 * k + 1], first = layer * d->g.n_node;
            bool is_edge = d->g.is_rim[a] || d->g.is_rim[b];
            put_cable(d, first + a, first + b, (layer ? REAR : FRONT) + is_edge);
        }
    for (int i = 0; i < d->g.n_node && d->n_layer > 1; i++)
        if (!d->g.is_rim[i]) put_cable(d, i, d->g.n_node + i, TIE);
}

/* ---- names ---- */

static hf_status name_nodes(const double_net *d)
{
    hf_scene *s = d->s;
    size_t n_digit = 24, size = (size_t)s->n_node * n_digit + (size_t)s->n_cable * 2 * n_digit;
    char *text = s->text = malloc(size);
    if (!text) return HF_NO_MEMORY;
    const char *end = text + size;
    for (int i = 0; i < s->n_node; i++) {
        const int *label = d->g.label + 2 * (i % d->g.n_node);
        char layer = i < d->g.n_node ? 'f' : 'r';
        s->node_id[i] = text;
        if (label[0] < 0)
            text += snprintf(text, (size_t)(end - text), "%cs%d", layer, label[1]) + 1;
        else
            text += snprintf(text, (size_t)(end - text), "%c%d_%d", layer, label[0], label[1]) + 1;
    }
    for (int e = 0; e < s->n_cable; e++) {
        s->cable_id[e] = text;
        text +=
            snprintf(text, (size_t)(end - text), "%s-%s", s->node_id[s->end[2 * e]], s->node_id[s->end[2 * e + 1]]) + 1;
    }
    return HF_OK;
}

/* ---- together ---- */

/* Counts with an empty grid, and fills it once it has its arrays. */
static void make_grid(const hf_paraboloid *p, plane_grid *g, int *node)
{
    g->n_node = g->n_cable = 0;
    if (p->grid == HF_GRID_TRIANGLE)
        make_triangles(p, g);
    else
        make_quads(p, g, node);
}

static hf_status allocate_grid(const hf_paraboloid *p, plane_grid *g, int **node)
{
    size_t width = 2 * (size_t)p->rings + 1;
    *node = malloc(width * width * sizeof **node);
    if (!*node) return HF_NO_MEMORY;
    make_grid(p, g, *node);
    size_t n = (size_t)g->n_node;
    double *plane_m = malloc(n * 2 * sizeof *plane_m);
    g->is_rim = malloc(n * sizeof *g->is_rim);
    g->label = malloc(n * 2 * sizeof *g->label);
    g->end = malloc((size_t)g->n_cable * 2 * sizeof *g->end);
    g->plane_m = plane_m;
    return plane_m && g->is_rim && g->label && g->end ? HF_OK : HF_NO_MEMORY;
}

static void free_grid(plane_grid *g, int *node)
{
    free(node);
    free(g->plane_m);
    free(g->is_rim);
    free(g->label);
    free(g->end);
}

static hf_status make_net(double_net *d, int *node)
{
    make_grid(d->p, &d->g, node);
    put_cables(d); /* only counts */
    bool with_EA = d->EA_N && (d->EA_N[0] > 0 || d->EA_N[1] > 0);
    HF_TRY(hf_scene_allocate(d->s, d->g.n_node * d->n_layer, d->n_cable, false, with_EA, false));
    d->member = malloc((size_t)d->n_member * sizeof *d->member);
    if (!d->member) return HF_NO_MEMORY;
    place_layer_nodes(d);
    put_cables(d);
    hf_status status = hf_cable_set_make(d->s, N_FAMILY, family_name, d->n_member, d->member);
    free(d->member);
    return status == HF_OK ? name_nodes(d) : status;
}

hf_status hf_scene_paraboloid(const hf_paraboloid *paraboloid, const double EA_N[2], hf_scene *scene,
                              hf_messages *messages)
{
    char what[HF_GENERATE_FAULT_SIZE];
    *scene = (hf_scene){0};
    double rings = paraboloid->rings, n_layer = paraboloid->rear_distance_m > 0 ? 2 : 1;
    bool is_quad = paraboloid->grid == HF_GRID_QUAD; /* of the square around the aperture */
    if (n_layer * (is_quad ? (2 * rings + 1) * (2 * rings + 1) : 1 + 3 * rings * (rings + 1)) > NODE_MAX)
        return hf_error(messages, HF_BAD_CASE, "scene: %d rings make more nodes than this program takes (%d)",
                        paraboloid->rings, NODE_MAX);
    const char *key = hf_scene_paraboloid_fault(paraboloid, what, sizeof what);
    if (key) return hf_error(messages, HF_BAD_CASE, "scene.paraboloid.%s: %s", key, what);
    if (paraboloid->tie_law == HF_LAW_ELASTIC && !(EA_N && EA_N[HF_GROUP_INNER] > 0))
        return hf_error(messages, HF_BAD_CASE, "scene.paraboloid.tie_law: elastic needs the stiffness of inner cables");
    double_net d = {.p = paraboloid, .EA_N = EA_N, .s = scene, .n_layer = (int)n_layer};
    int *node = NULL;
    hf_status status = allocate_grid(paraboloid, &d.g, &node);
    if (status == HF_OK) status = make_net(&d, node);
    free_grid(&d.g, node);
    return status == HF_OK ? HF_OK : hf_error(messages, status, "scene: out of memory for %d rings", paraboloid->rings);
}

void hf_scene_paraboloid_surface(const hf_paraboloid *paraboloid, hf_surface_settings *surface)
{
    surface->kind = HF_SURFACE_PARABOLOID;
    surface->focal_length_m = paraboloid->focal_length_m;
}
