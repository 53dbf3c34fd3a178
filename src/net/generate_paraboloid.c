/* Makes the net over a paraboloid with a round aperture, alone or tied to a rear net:
 *
 *     settings -> plane grid in the aperture (triangular: rings, then relaxed; quad: rows and columns, ends on the rim)
 *       -> front net on the paraboloid -> rear net and ties, if asked for, sets of cables, ids (front_net)
 *
 * Contents: what can be made - the plane grid - the triangular grid - relaxing the triangular grid - the quad grid -
 * together - the rim */
#include <hifdm/generate.h>

#include "base/arena.h"
#include "base/elementary.h"
#include "net/front_net.h"
#include "net/parabola.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define NODE_MAX 4000000  /* keeps every index and band offset far below the range of int */
#define EDGE_MIN 0.25     /* minimum distance of a node of the quad grid from the rim, in cells */
#define SAME_SUPPORT 1e-9 /* relative to the radius; nearer ends of rows and columns are one support */
#define RELAXED 1e-16     /* relative to the first residual */
#define RELAX_STEPS 40    /* maximum, per ring; about 4 are needed */

/* ---- what can be made ---- */

static double radius(const hf_paraboloid *p)
{
    return p->aperture_m / 2;
}

static hf_double_net rear_of(const hf_paraboloid *p)
{
    return (hf_double_net){.kind = HF_SURFACE_PARABOLOID,
                           .focal_length_m = p->focal_length_m,
                           .middle_x_m = p->offset_m,
                           .half_m = radius(p),
                           .supports_along_z = true,
                           HF_DOUBLE_NET_OF(p)};
}

static double front_height(const hf_paraboloid *p, double x, double y)
{
    return (x * x + y * y) / (4 * p->focal_length_m);
}

static const char *const outside =
    "normal leads to places outside the rim of the rear net; take z, a flatter front net or fewer rings";

/* Returns true if the normal at one of 24 points on a circle near the outermost free nodes misses the rear net or meets
 * it outside its rim. */
static bool leaves_rim(const hf_paraboloid *p)
{
    hf_double_net d = rear_of(p);
    double R = radius(p), r = R * (p->rings - (p->grid == HF_GRID_QUAD ? EDGE_MIN : 1)) / p->rings;
    for (int k = 0; k < 24; k++) {
        double angle = HF_PI / 12 * k, rear[3], front[3] = {p->offset_m + r * hf_cosine(angle), r * hf_sine(angle), 0};
        front[2] = front_height(p, front[0], front[1]);
        if (!hf_double_net_behind(&d, false, front, rear)) return true;
        if (!(hf_norm(rear[0] - p->offset_m, rear[1], 0) < R)) return true;
    }
    return false;
}

const char *hf_scene_paraboloid_fault(const hf_paraboloid *p, char *what, size_t size)
{
    hf_double_net d = rear_of(p);
    const char *key = hf_double_net_fault(&d, what, size);
    if (key || p->rear_distance_m == 0) return key;
    if (p->tie_direction != HF_TIES_ALONG_NORMAL || p->rings == 1 || !leaves_rim(p)) return NULL;
    snprintf(what, size, "%s", outside);
    return "tie_direction";
}

/* ---- the plane grid ---- */

/* The grid in the plane of the aperture is a front net at z = 0. Its origin is the middle of the aperture. */
typedef struct {
    const hf_paraboloid *p;
    int *node_at; /* [2 rings + 1][2 rings + 1], nodes of the quad grid, by rows */
} plane_grid;

/* Families of cables, sorted by name. */
enum { FRONT, FRONT_EDGE, REAR, REAR_EDGE, TIE, N_FAMILY };
static const char *const family_name[N_FAMILY] = {"front", "front_edge", "rear", "rear_edge", "tie"};
static const int rear_family[N_FAMILY] = {REAR, REAR_EDGE};

static int add_point(hf_front_net *f, double x, double y, bool is_rim, hf_front_label label)
{
    int node = f->n_node++;
    hf_front_net_put(f, node, (double[3]){x, y, 0}, is_rim ? HF_ROLE_SUPPORT : HF_ROLE_INNER, label);
    return node;
}

static bool is_rim(const hf_front_net *f, int node)
{
    return f->role && f->role[node] == HF_ROLE_SUPPORT;
}

/* Adds a cable. Those that end on the rim are boundary cables. */
static void add_line(hf_front_net *f, int a, int b)
{
    bool is_edge = is_rim(f, a) || is_rim(f, b);
    hf_front_net_join(f, is_edge ? FRONT_EDGE : FRONT);
    hf_front_net_connect(f, a, b, is_edge ? HF_GROUP_BOUNDARY : HF_GROUP_INNER);
}

/* Returns the factor by which a point at radius r is scaled so that radii are divided evenly in arc length. It is 1 if
 * `spacing` is equal_projected. */
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

/* Adds ring k with 6k nodes, k on each side. The nodes of the last ring are evenly spaced on the rim. Those of the
 * other rings start on circles and are relaxed later. */
static void add_ring(const hf_paraboloid *p, hf_front_net *f, int ring)
{
    double r = radius(p) * ring / p->rings;
    for (int i = 0; i < 6 * ring; i++) {
        double angle = HF_PI / 3 * i / ring;
        add_point(f, r * hf_cosine(angle), r * hf_sine(angle), ring == p->rings, (hf_front_label){"f", ring, i});
    }
}

/* Adds the cables along the ring, and those to the next ring: two from each node, three from a corner. */
static void join_ring(const hf_paraboloid *p, hf_front_net *f, int ring)
{
    int here = first_of_ring(ring), out = first_of_ring(ring + 1), n = 6 * ring, n_out = 6 * (ring + 1);
    for (int i = 0; i < n && ring < p->rings; i++) {
        int side = i / ring, j = i % ring, next = side * (ring + 1) + j;
        add_line(f, here + i, here + (i + 1) % n);
        if (j == 0) add_line(f, here + i, out + (next + n_out - 1) % n_out);
        add_line(f, here + i, out + next);
        add_line(f, here + i, out + next + 1);
    }
}

static void make_triangles(const hf_paraboloid *p, hf_front_net *f)
{
    add_point(f, 0, 0, false, (hf_front_label){"f", 0, 0});
    for (int ring = 1; ring <= p->rings; ring++)
        add_ring(p, f, ring);
    for (int i = 0; i < 6; i++)
        add_line(f, 0, 1 + i);
    for (int ring = 1; ring < p->rings; ring++)
        join_ring(p, f, ring);
}

/* ---- relaxing the triangular grid ----
 * Cells of one size do not fill a circle. Their size changes gradually if the grid is a plane net of equal force
 * densities that is held at its rim. For any number of rings, the facet error (RMS after a best fit) is then 1.07 times
 * that of equilateral facets with the same mean side. The tensions that hold the net are nearly even. */

/* Computes the forces of the cables on the free nodes at the positions at_m [n_node][3], with the sign changed.
 * Writes them to minus_force [n_node][3]. */
static void pull(const hf_front_net *f, const double *at_m, double *minus_force)
{
    for (int i = 0; i < 3 * f->n_node; i++)
        minus_force[i] = 0;
    for (int e = 0; e < f->n_cable; e++)
        for (int c = 0, a = 3 * f->end[2 * e], b = 3 * f->end[2 * e + 1]; c < 2; c++) {
            minus_force[a + c] += at_m[a + c] - at_m[b + c];
            minus_force[b + c] -= at_m[a + c] - at_m[b + c];
        }
    for (int i = 0; i < f->n_node; i++)
        if (is_rim(f, i)) minus_force[3 * i] = minus_force[3 * i + 1] = 0;
}

static double product(size_t n, const double *a, const double *b)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Relaxes the grid by conjugate gradients, to rounding. The number of steps is proportional to the number of rings.
 * Finally applies `spacing` to the radii. */
static hf_status relax(const hf_paraboloid *p, hf_front_net *f)
{
    size_t n = 3 * (size_t)f->n_node;
    double *residual, *direction, *image;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(residual, n), HF_ARRAY(direction, n), HF_ARRAY(image, n)));
    pull(f, f->position_m, residual);
    for (size_t i = 0; i < n; i++)
        direction[i] = residual[i] = -residual[i];
    double square = product(n, residual, residual), enough = RELAXED * RELAXED * square;
    for (int step = 0; step < RELAX_STEPS * p->rings && square > enough; step++) {
        pull(f, direction, image);
        double length = square / product(n, direction, image), before = square;
        for (size_t i = 0; i < n; i++) {
            f->position_m[i] += length * direction[i];
            residual[i] -= length * image[i];
        }
        square = product(n, residual, residual);
        for (size_t i = 0; i < n; i++)
            direction[i] = residual[i] + square / before * direction[i];
    }
    hf_arena_free_block(block);
    for (int i = 0; i < f->n_node; i++) {
        double *x = f->position_m + 3 * (size_t)i, scale = is_rim(f, i) ? 1 : spread(p, hf_norm(x[0], x[1], 0));
        x[0] *= scale;
        x[1] *= scale;
    }
    return HF_OK;
}

/* ---- the quad grid ---- */

/* Returns the index of the last node of row or column k, counted from the middle: the farthest inside the rim. Returns
 * -1 if there is none. */
static int last_in_row(const hf_paraboloid *p, int k)
{
    double n = p->rings - EDGE_MIN;
    return k > n ? -1 : (int)sqrt(n * n - (double)k * k);
}

/* Returns the support at the end of a row or column. Adds it unless another row or column ends there. */
static int rim_point(const hf_paraboloid *p, hf_front_net *f, int first_support, double x, double y)
{
    for (int i = first_support; f->position_m && i < f->n_node; i++)
        if (hf_norm(f->position_m[3 * i] - x, f->position_m[3 * i + 1] - y, 0) < SAME_SUPPORT * radius(p)) return i;
    return add_point(f, x, y, true, (hf_front_label){"fs", f->n_node - first_support, -1});
}

static void make_quads(const hf_paraboloid *p, hf_front_net *f, int *node)
{
    int N = p->rings, width = 2 * N + 1;
    double cell = radius(p) / N;
    for (int j = -N; j <= N; j++)
        for (int i = -last_in_row(p, abs(j)); i <= last_in_row(p, abs(j)); i++) {
            double scale = spread(p, cell * hf_norm(i, j, 0));
            node[(j + N) * width + i + N] =
                add_point(f, scale * cell * i, scale * cell * j, false, (hf_front_label){"f", i + N, j + N});
        }
    int first_support = f->n_node;
    for (int axis = 0; axis < 2; axis++)
        for (int k = -N; k <= N; k++) {
            int last = last_in_row(p, abs(k)), step = axis == 0 ? 1 : width;
            if (last < 0) continue;
            int *line = axis == 0 ? node + (k + N) * width + N : node + N * width + k + N;
            double along = sqrt((double)N * N - (double)k * k) * cell, across = k * cell;
            for (int i = -last; i < last; i++)
                add_line(f, line[i * step], line[(i + 1) * step]);
            for (int end = -1; end <= 1; end += 2)
                add_line(
                    f, line[end * last * step],
                    rim_point(p, f, first_support, axis == 0 ? end * along : across, axis == 0 ? across : end * along));
        }
}

/* ---- together ---- */

/* Adds all nodes and cables, for hf_front_net_make. */
static void add_all(void *context, hf_front_net *f)
{
    plane_grid *g = context;
    if (g->p->grid == HF_GRID_TRIANGLE)
        make_triangles(g->p, f);
    else
        make_quads(g->p, f, g->node_at);
}

static hf_status make_grid(const hf_paraboloid *p, hf_front_net *f)
{
    size_t width = 2 * (size_t)p->rings + 1;
    plane_grid g = {.p = p};
    void *block;
    *f = (hf_front_net){0};
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(g.node_at, p->grid == HF_GRID_QUAD ? width * width : 0)));
    hf_status status = hf_front_net_make(add_all, &g, f);
    hf_arena_free_block(block);
    return status;
}

/* Puts the grid on the paraboloid. */
static void raise(const hf_paraboloid *p, hf_front_net *f)
{
    for (int i = 0; i < f->n_node; i++) {
        double *front = f->position_m + 3 * (size_t)i;
        front[0] += p->offset_m;
        front[2] = front_height(p, front[0], front[1]);
    }
}

/* Returns the number of free rear nodes that are outside the rim of the rear net. */
static int count_outside(const hf_paraboloid *p, int n_front, const hf_scene *s)
{
    int n = 0;
    for (int i = n_front; i < s->n_node; i++) {
        const double *rear = s->position_m + 3 * (size_t)i;
        n += s->role[i] != HF_ROLE_SUPPORT && !(hf_norm(rear[0] - p->offset_m, rear[1], 0) < radius(p));
    }
    return n;
}

hf_status hf_scene_paraboloid(const hf_paraboloid *paraboloid, const double EA_N[2], hf_scene *scene,
                              hf_messages *messages)
{
    char what[HF_GENERATE_FAULT_SIZE];
    *scene = (hf_scene){0};
    double rings = paraboloid->rings, n_layer = paraboloid->rear_distance_m > 0 ? 2 : 1;
    bool is_quad = paraboloid->grid == HF_GRID_QUAD; /* nodes of the square around the aperture */
    if (n_layer * (is_quad ? (2 * rings + 1) * (2 * rings + 1) : 1 + 3 * rings * (rings + 1)) > NODE_MAX)
        return hf_error(messages, HF_BAD_CASE, "scene: a net with %d rings has more nodes than the maximum of %d",
                        paraboloid->rings, NODE_MAX);
    const char *key = hf_scene_paraboloid_fault(paraboloid, what, sizeof what);
    if (key) return hf_error(messages, HF_BAD_CASE, "scene.paraboloid.%s: %s", key, what);
    const hf_double_net rear = rear_of(paraboloid);
    if (hf_double_net_lacks_EA(&rear, EA_N))
        return hf_error(
            messages, HF_BAD_CASE,
            "scene.paraboloid.tie_law: the law elastic needs the stiffness of the inner cables (scene.EA_inner_N)");
    const hf_front_families families = {N_FAMILY, family_name, rear_family, TIE};
    hf_front_net front;
    hf_status status = make_grid(paraboloid, &front);
    if (status == HF_OK && !is_quad) status = relax(paraboloid, &front);
    if (status == HF_OK) {
        raise(paraboloid, &front);
        status = hf_front_net_scene(&front, &rear, EA_N, &families, scene);
    }
    bool is_outside = status == HF_OK && count_outside(paraboloid, front.n_node, scene) > 0;
    hf_front_net_free(&front);
    if (is_outside) return hf_error(messages, HF_BAD_CASE, "scene.paraboloid.tie_direction: %s", outside);
    return status == HF_OK ? HF_OK : hf_error(messages, status, "scene: out of memory for %d rings", paraboloid->rings);
}

/* ---- the rim ---- */

/* Compares two positions about the middle of the aperture for qsort(3): counter-clockwise from x, without angles. */
static int by_angle(const void *a, const void *b)
{
    const double *p = a, *q = b;
    bool p_low = p[1] < 0 || (p[1] == 0 && p[0] < 0), q_low = q[1] < 0 || (q[1] == 0 && q[0] < 0);
    double cross = p[0] * q[1] - p[1] * q[0];
    if (p_low != q_low) return p_low ? 1 : -1;
    return cross > 0 ? -1 : cross < 0;
}

hf_status hf_paraboloid_rim(const hf_paraboloid *paraboloid, int *n, double **position_m)
{
    hf_front_net front;
    *n = 0;
    hf_status status = make_grid(paraboloid, &front);
    *position_m = status == HF_OK ? malloc(3 * (size_t)front.n_node * sizeof **position_m) : NULL;
    if (!*position_m) status = HF_NO_MEMORY;
    for (int i = 0; i < front.n_node && status == HF_OK; i++) {
        double *p = *position_m + 3 * (size_t)*n;
        if (!is_rim(&front, i)) continue;
        p[0] = front.position_m[3 * i];
        p[1] = fabs(front.position_m[3 * i + 1]) < SAME_SUPPORT * radius(paraboloid) ? 0 : front.position_m[3 * i + 1];
        p[2] = 0;
        ++*n;
    }
    hf_front_net_free(&front);
    if (status != HF_OK) return status;
    qsort(*position_m, (size_t)*n, 3 * sizeof **position_m, by_angle);
    for (int i = 0; i < *n; i++) {
        double *p = *position_m + 3 * (size_t)i;
        p[0] += paraboloid->offset_m;
        p[2] = front_height(paraboloid, p[0], p[1]);
    }
    return HF_OK;
}

void hf_scene_paraboloid_surface(const hf_paraboloid *paraboloid, hf_surface_settings *surface)
{
    surface->kind = HF_SURFACE_PARABOLOID;
    surface->focal_length_m = paraboloid->focal_length_m;
}
