/* Finds the facets of a net as the faces of a plane graph:
 *
 *     scene, target surface -> choose_nodes: nodes on the surface
 *       -> keep_named: if the scene has facets, those with a node on the surface
 *       -> else drop_ends: remove nodes at the end of a single cable
 *            -> collect: half edges, sorted around each node
 *            -> find_faces: walk around each face; close_gaps adds faces at the rim
 *       -> facets [n_facet][4]
 *
 * Contents: the graph - faces - together */
#include <hifdm/facets.h>

#include "base/arena.h"
#include "base/elementary.h"
#include "base/union_find.h"
#include "net/facet_import.h"
#include "net/target_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Nodes other than inner nodes are on the target surface if they are nearer to it than NEAR_PART of its depth. They are
 * also on it if their cable to an inner node departs from it by less than NEAR_SLOPE of its length. */
#define NEAR_PART 1e-3
#define NEAR_SLOPE 0.1
/* Cosine of the maximum turn at which two cables continue each other. The sag is then 0.29 of the span. */
#define STRAIGHT_ON 0.5
#define STRAIGHT_PART 1e-9 /* a corner that points inwards by less of the area is straight, but for rounding */

/* ---- the graph ---- */

/* A cable in one direction. Those of a node are adjacent, in counter-clockwise order of their directions. */
typedef struct {
    int from, to;
    double dx, dy;
    int twin, rank; /* index of the other direction of the cable; index before sorting */
    int cable;
} half;

/* All arrays are zero at first. */
typedef struct {
    const hf_scene *scene;
    double *above_m;      /* [n_node], height above the target surface */
    unsigned char *is_on; /* [n_node], true for nodes of the graph */
    int *degree, *mixed;  /* [n_node], used by drop_ends */
    int *first;           /* [n_node + 1], first half edge of each node */
    int *parent;          /* [n_node], classes of connected nodes (union-find) */
    int *sorted;          /* [n_half], index of a half edge after sorting */
    half *edge;           /* [n_half] */
    unsigned char *seen;  /* [n_half] */
    int n_half;
} graph;

/* Adds nodes that a cable joins to an inner node along the surface. The rim of a net on a deflected truss is off by
 * millimetres, but the cables of the surface still end there. */
static void follow_cables(graph *g)
{
    const hf_scene *s = g->scene;
    for (int e = 0; e < s->n_cable; e++)
        for (int k = 0; k < 2; k++) {
            int i = s->end[2 * e + k], from = s->end[2 * e + 1 - k];
            if (s->role[i] == HF_ROLE_INNER || s->role[from] != HF_ROLE_INNER) continue;
            double max_m = NEAR_SLOPE * hf_scene_length_at_target(s, e);
            if (fabs(g->above_m[i] - g->above_m[from]) <= max_m) g->is_on[i] = 1;
        }
}

static void choose_nodes(graph *g, const hf_surface_settings *surface)
{
    const hf_scene *s = g->scene;
    double slope[2], curvature = 1 / (4 * surface->focal_length_m);
    double near_m = NEAR_PART * hf_target_surface_compare(surface->kind, surface->focal_length_m, s).depth_m;
    for (int i = 0; i < s->n_node; i++) {
        g->above_m[i] = hf_target_surface_height_above(surface->kind, curvature, s->position_m + 3 * (size_t)i, slope);
        g->is_on[i] = s->role[i] == HF_ROLE_INNER || fabs(g->above_m[i]) <= near_m;
    }
    follow_cables(g);
}

static bool in_graph(const graph *g, int cable)
{
    const int *end = g->scene->end + 2 * (size_t)cable;
    return g->is_on[end[0]] && g->is_on[end[1]];
}

/* Returns true if end k of the cable is a support and its other end an inner node. The surface then extends to the
 * support, even if no cable runs along the rim. */
static bool is_rim(const graph *g, int cable, int k)
{
    const hf_scene *s = g->scene;
    return s->role[s->end[2 * cable + k]] == HF_ROLE_SUPPORT && s->role[s->end[2 * cable + 1 - k]] == HF_ROLE_INNER;
}

/* Removes nodes at the end of a single cable, such as that of an edge tie, because no face contains them. A chain of
 * such nodes is removed from its end. Each node stores the number of its remaining cables and the exclusive or of their
 * indices. The latter is the index of the last cable when one remains, so the time is proportional to the size of the
 * net. A cable counts twice at a support on the rim, so that such supports stay. */
static void drop_ends(graph *g)
{
    const hf_scene *s = g->scene;
    for (int e = 0; e < s->n_cable; e++)
        for (int k = 0; k < 2 && in_graph(g, e); k++) {
            g->degree[s->end[2 * e + k]] += is_rim(g, e, k) ? 2 : 1;
            g->mixed[s->end[2 * e + k]] ^= e;
        }
    for (int i = 0; i < s->n_node; i++)
        for (int at = i, next; g->is_on[at] && g->degree[at] <= 1; at = next) {
            int e = g->mixed[at];
            g->is_on[at] = false;
            if (g->degree[at] == 0) break;
            int k = s->end[2 * e] == at;
            next = s->end[2 * e + k];
            g->degree[next] -= is_rim(g, e, k) ? 2 : 1;
            g->mixed[next] ^= e;
        }
}

/* Orders half edges by node, then counter-clockwise from the direction of -x. Directions below the x axis come first,
 * so no angles are needed. Two cables between the same nodes are neighbours; their order at one end is the reverse of
 * that at the other end. */
static int by_direction(const void *a, const void *b)
{
    const half *p = a, *q = b;
    if (p->from != q->from) return p->from < q->from ? -1 : 1;
    bool p_up = p->dy > 0 || (p->dy == 0 && p->dx > 0), q_up = q->dy > 0 || (q->dy == 0 && q->dx > 0);
    if (p_up != q_up) return p_up ? 1 : -1;
    double cross = p->dx * q->dy - p->dy * q->dx;
    if (cross != 0) return cross > 0 ? -1 : 1;
    if (p->to != q->to) return p->to < q->to ? -1 : 1;
    int order = p->rank < q->rank ? -1 : p->rank > q->rank;
    return p->from < p->to ? order : -order;
}

static void collect(graph *g)
{
    const hf_scene *s = g->scene;
    for (int e = 0; e < s->n_cable; e++)
        for (int k = 0; k < 2 && in_graph(g, e); k++) {
            int from = s->end[2 * e + k], to = s->end[2 * e + 1 - k];
            const double *p = s->position_m + 3 * (size_t)from, *q = s->position_m + 3 * (size_t)to;
            g->edge[g->n_half] = (half){from, to, q[0] - p[0], q[1] - p[1], g->n_half ^ 1, g->n_half, e};
            g->n_half++;
        }
    qsort(g->edge, (size_t)g->n_half, sizeof *g->edge, by_direction);
    for (int h = 0; h < g->n_half; h++) {
        g->sorted[g->edge[h].rank] = h;
        g->first[g->edge[h].from + 1]++;
    }
    for (int i = 0; i < s->n_node; i++)
        g->first[i + 1] += g->first[i];
    for (int h = 0; h < g->n_half; h++)
        g->edge[h].twin = g->sorted[g->edge[h].twin];
}

/* ---- faces ---- */

/* Returns the next half edge around the face on the left: at the far node, the next one clockwise from the way back. */
static int next_around(const graph *g, int h)
{
    int twin = g->edge[h].twin, node = g->edge[h].to;
    return twin > g->first[node] ? twin - 1 : g->first[node + 1] - 1;
}

/* Walks around the face on the left of h. Returns its number of sides. Writes its first four corners, and twice its
 * area in m2. */
static int walk(graph *g, int h, int corner[4], double *area)
{
    const double *p0 = g->scene->position_m + 3 * (size_t)g->edge[h].from;
    int n = 0;
    *area = 0;
    for (; !g->seen[h]; h = next_around(g, h)) {
        const double *p = g->scene->position_m + 3 * (size_t)g->edge[h].from;
        g->seen[h] = true;
        *area += (p[0] - p0[0]) * g->edge[h].dy - (p[1] - p0[1]) * g->edge[h].dx;
        if (n < 4) corner[n] = g->edge[h].from;
        n++;
    }
    return n;
}

static bool is_convex(const hf_scene *s, int n, const int corner[4], double area)
{
    for (int k = 0; k < n; k++)
        if (!(hf_facet_double_area(s, corner[k], corner[(k + 1) % n], corner[(k + 2) % n]) > -STRAIGHT_PART * area))
            return false;
    return true;
}

static void add_facet(const hf_scene *s, int n, const int node[4], double area, hf_facets *f)
{
    int *corner = f->corner + 4 * (size_t)f->n_facet;
    if (n > 4 || !is_convex(s, n, node, area)) {
        f->n_open++;
        return;
    }
    for (int k = 0; k < 4; k++)
        corner[k] = node[k < n ? k : n - 1];
    f->n_facet++;
}

/* Returns true if the n >= 2 cables along the outside from half edge h are an edge that hangs between two supports,
 * with nothing beyond it. All of them must be boundary cables. If there are only two, they must continue each other.
 * Two cables that do not continue each other can hold the last node before a rim. */
static bool is_hanging_edge(const graph *g, int h, int n)
{
    const half *p = &g->edge[h], *q = &g->edge[next_around(g, h)];
    double along = p->dx * q->dx + p->dy * q->dy;
    for (int i = 0; i < n; i++, h = next_around(g, h))
        if (g->scene->group[g->edge[h].cable] != HF_GROUP_BOUNDARY) return false;
    return n > 2 || along > STRAIGHT_ON * hf_norm(p->dx, p->dy, 0) * hf_norm(q->dx, q->dy, 0);
}

/* Walks along the outside of the net from half edge h and closes gaps at the rim. Every inner node is surrounded by
 * surface. So the gap between two consecutive supports with only inner nodes between them is a face, and its last side
 * is the straight line between the supports. There is no such face if an edge of the net hangs in the gap. */
static void close_gaps(const graph *g, int h, hf_facets *f)
{
    const hf_scene *s = g->scene;
    int from = h;
    do {
        int node[4] = {g->edge[h].from}, n = 1, k = h;
        double area = 0;
        if (s->role[node[0]] == HF_ROLE_SUPPORT) {
            for (; s->role[g->edge[k].to] == HF_ROLE_INNER; k = next_around(g, k), n++) {
                if (n < 4) node[n] = g->edge[k].to;
                area += hf_facet_double_area(s, node[0], g->edge[k].to, g->edge[next_around(g, k)].to);
            }
            if (n < 4) node[n] = g->edge[k].to;
            bool is_gap = n > 1 && s->role[g->edge[k].to] == HF_ROLE_SUPPORT && area > 0;
            if (is_gap && !is_hanging_edge(g, h, n)) add_facet(s, n + 1, node, area, f);
        }
        h = next_around(g, h);
    } while (h != from);
}

/* Finds all faces and keeps those that are facets. A face without area lies between two cables with the same nodes. A
 * face with negative area is the outside of the net. The only face of a tree, such as one node between supports, is
 * also the outside. By Euler's formula, a graph with C components is drawn without crossings if and only if V - E + F
 * = 2 C. */
static void find_faces(graph *g, hf_facets *f)
{
    const hf_scene *s = g->scene;
    int n_face = 0, n_node = 0, n_part = 0;
    for (int i = 0; i < s->n_node; i++)
        g->parent[i] = i;
    for (int h = 0; h < g->n_half; h++)
        hf_union_find_join(g->parent, g->edge[h].from, g->edge[h].to);
    for (int i = 0; i < s->n_node; i++) {
        n_node += g->is_on[i];
        n_part += g->is_on[i] && g->parent[i] == i;
    }
    for (int h = 0; h < g->n_half; h++) {
        int corner[4];
        double area;
        if (g->seen[h]) continue;
        int n = walk(g, h, corner, &area);
        n_face++;
        bool is_tree = n == g->n_half;
        if (area < 0 || is_tree) close_gaps(g, h, f);
        if (n >= 3 && area > 0 && !is_tree) add_facet(s, n, corner, area, f);
    }
    f->is_planar = n_node - g->n_half / 2 + n_face == 2 * n_part;
    if (!f->is_planar) f->n_facet = f->n_open = 0;
}

/* ---- together ---- */

/* Keeps the facets of the scene that have a node on the surface. Others belong to a rear net. */
static void keep_named(const graph *g, hf_facets *f)
{
    for (int i = 0; i < g->scene->n_facet; i++) {
        const int *from = g->scene->facet + 4 * (size_t)i;
        bool is_on = g->is_on[from[0]] || g->is_on[from[1]] || g->is_on[from[2]] || g->is_on[from[3]];
        if (is_on) memcpy(f->corner + 4 * (size_t)f->n_facet++, from, 4 * sizeof *from);
    }
}

hf_status hf_facets_find(const hf_scene *scene, const hf_surface_settings *surface, hf_facets *facets)
{
    *facets = (hf_facets){.is_planar = true};
    graph g = {.scene = scene};
    void *block;
    size_t n_named = (size_t)scene->n_facet, n = (size_t)scene->n_node, n_half = 2 * (size_t)scene->n_cable;
    size_t n_corner = 4 * (n_named > 0 ? n_named : (size_t)scene->n_cable + 1); /* a face needs at least 3/2 cables */
    HF_TRY(HF_ARENA_ARRAYS(&facets->block, HF_ARRAY(facets->corner, n_corner)));
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(g.above_m, n), HF_ARRAY(g.is_on, n), HF_ARRAY(g.degree, n),
                           HF_ARRAY(g.mixed, n), HF_ARRAY(g.first, n + 1), HF_ARRAY(g.parent, n),
                           HF_ARRAY(g.sorted, n_half), HF_ARRAY(g.edge, n_half), HF_ARRAY(g.seen, n_half)));
    choose_nodes(&g, surface);
    if (n_named > 0) {
        keep_named(&g, facets);
    } else {
        drop_ends(&g);
        collect(&g);
        find_faces(&g, facets);
    }
    hf_arena_free_block(block);
    return HF_OK;
}

void hf_facets_free(hf_facets *facets)
{
    hf_arena_free_block(facets->block);
    *facets = (hf_facets){0};
}
