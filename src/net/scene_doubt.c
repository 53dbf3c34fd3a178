/* Contents: duplicate cables - far nodes - lengths - the plane of the supports - together */
#include "net/scene_doubt.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "net/side.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SAID_MAX 5    /* warnings of one kind */
#define FAR 100.0     /* ratio to the distance of the others from the middle; mm given as m are 1000 times as far */
#define LARGE_M 500.0 /* extent of the net; a larger one was probably given in mm */
#define LENGTH_PART 0.5
#define PLANE_PART 1e-6   /* relative to the extent of the supports; positions in tables are rounded */
#define FLATTER_PART 1e-3 /* relative to the same extent; nearer inner nodes are probably meant to be in the plane */

typedef struct {
    double m;
    int node;
} distance;

typedef struct {
    hf_side *side;      /* [n_cable] */
    double *coordinate; /* [n_node] */
    distance *from;     /* [n_node], distances of the nodes from the middle of the net */
} scratch;

/* ---- duplicate cables ---- */

static void doubt_cables(const hf_scene *s, hf_side *all, hf_messages *messages)
{
    char place[HF_SCENE_LOCATION_SIZE];
    int n_said = 0, first = 0;
    for (int e = 0; e < s->n_cable; e++)
        all[e] = hf_side_of(s->end[2 * e], s->end[2 * e + 1], e);
    qsort(all, (size_t)s->n_cable, sizeof *all, hf_side_compare);
    for (int k = 1; k < s->n_cable; k++) {
        if (hf_side_compare_nodes(all + k, all + first) != 0) {
            first = k;
            continue;
        }
        if (++n_said > SAID_MAX) continue;
        hf_scene_location(s, true, all[k].of, place, sizeof place);
        hf_warning(messages, "%s joins the same two nodes as cable '%s'", place, s->cable_id[all[first].of]);
    }
    if (n_said > SAID_MAX)
        hf_warning(messages, "scene: %d more cables join the same two nodes as another cable", n_said - SAID_MAX);
}

/* ---- far nodes ---- */

static int by_distance(const void *a, const void *b)
{
    const distance *x = a, *y = b;
    if (x->m != y->m) return x->m < y->m ? -1 : 1;
    return x->node < y->node ? -1 : 1;
}

/* Warns of nodes far from the middle of the net. The middle is the median of each coordinate, which a few far nodes
 * do not change. */
static void doubt_nodes(const hf_scene *s, const scratch *t, hf_messages *messages)
{
    char place[HF_SCENE_LOCATION_SIZE];
    double middle[3];
    int n = s->n_node, k = n / 2 + 1;
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < n; i++)
            t->coordinate[i] = s->position_m[3 * i + c];
        qsort(t->coordinate, (size_t)n, sizeof(double), hf_compare_doubles);
        middle[c] = t->coordinate[n / 2];
    }
    for (int i = 0; i < n; i++)
        t->from[i] = (distance){hf_distance(s->position_m + 3 * (size_t)i, middle), i};
    qsort(t->from, (size_t)n, sizeof *t->from, by_distance);
    while (k < n && !(t->from[k - 1].m > 0 && t->from[k].m > FAR * t->from[k - 1].m))
        k++;
    for (int i = k; i < n && i < k + SAID_MAX; i++) {
        hf_scene_location(s, false, t->from[i].node, place, sizeof place);
        hf_warning(messages,
                   "%s is %.3g m from the middle of the net, which is %.3g times as far as the other nodes. Are all "
                   "coordinates in m?",
                   place, t->from[i].m, t->from[i].m / t->from[k - 1].m);
    }
    if (n > k + SAID_MAX)
        hf_warning(messages, "scene: %d more nodes are similarly far from the middle of the net", n - k - SAID_MAX);
}

/* Warns if the longest side of the box around all nodes is too long. */
static void doubt_size(const hf_scene *s, hf_messages *messages)
{
    double largest = 0;
    for (int c = 0; c < 3; c++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < s->n_node; i++) {
            low = fmin(low, s->position_m[3 * i + c]);
            high = fmax(high, s->position_m[3 * i + c]);
        }
        largest = fmax(largest, high - low);
    }
    if (largest > LARGE_M) hf_warning(messages, "scene: the net is %.4g m across. Are all lengths in m?", largest);
}

/* ---- lengths ---- */

/* Warns of cables whose length by law differs much from the distance of their nodes. Lengths in mm are
 * the usual reason. */
static void doubt_lengths(const hf_scene *s, hf_messages *messages)
{
    char place[HF_SCENE_LOCATION_SIZE];
    int n_said = 0;
    for (int e = 0; e < s->n_cable; e++) {
        double length_at_target_m = hf_scene_length_at_target(s, e), ratio = s->target[e] / length_at_target_m;
        bool is_length = s->law[e] == HF_LAW_LENGTH || s->law[e] == HF_LAW_ELASTIC;
        if (!is_length || fabs(ratio - 1) <= LENGTH_PART || ++n_said > SAID_MAX) continue;
        hf_scene_location(s, true, e, place, sizeof place);
        hf_warning(
            messages,
            "%s is %.4g m long by its law, which is %.3g times the distance between its nodes. Is this length in m?",
            place, s->target[e], ratio);
    }
    if (n_said > SAID_MAX)
        hf_warning(messages, "scene: %d more cables have lengths that differ from the distances between their nodes",
                   n_said - SAID_MAX);
}

/* ---- the plane of the supports ---- */

/* The flat that the supports span: a point, a line or a plane, with orthonormal directions. */
typedef struct {
    double origin[3], along[2][3];
    int n_along;
} flat;

/* Returns the distance of a point from the flat, m. `off` is the vector of this distance. */
static double off_flat(const flat *f, const double *p, double off[3])
{
    for (int c = 0; c < 3; c++)
        off[c] = p[c] - f->origin[c];
    for (int k = 0; k < f->n_along; k++) {
        double dot = off[0] * f->along[k][0] + off[1] * f->along[k][1] + off[2] * f->along[k][2];
        for (int c = 0; c < 3; c++)
            off[c] -= dot * f->along[k][c];
    }
    return sqrt(off[0] * off[0] + off[1] * off[1] + off[2] * off[2]);
}

/* Returns the maximum distance of a support from the flat, m, and writes its vector. */
static double farthest_support(const hf_scene *s, const flat *f, double max_off[3])
{
    double max_m = 0, off[3];
    for (int i = 0; i < s->n_node; i++) {
        double d = s->role[i] == HF_ROLE_SUPPORT ? off_flat(f, s->position_m + 3 * (size_t)i, off) : 0;
        if (d <= max_m) continue;
        max_m = d;
        memcpy(max_off, off, sizeof off);
    }
    return max_m;
}

/* Computes a flat of at most two directions through all supports, to PLANE_PART of their extent. Returns false if
 * there is none. */
static bool span_supports(const hf_scene *s, flat *f, double *extent_m)
{
    double off[3] = {0};
    *f = (flat){.n_along = 0};
    for (int i = s->n_node - 1; i >= 0; i--)
        if (s->role[i] == HF_ROLE_SUPPORT) memcpy(f->origin, s->position_m + 3 * (size_t)i, sizeof f->origin);
    *extent_m = farthest_support(s, f, off);
    for (double d = *extent_m; d > PLANE_PART * *extent_m; d = farthest_support(s, f, off)) {
        if (f->n_along == 2) return false;
        for (int c = 0; c < 3; c++)
            f->along[f->n_along][c] = off[c] / d;
        f->n_along++;
    }
    return true;
}

/* Warns of a net that collapses into the flat of its supports. Without loads and struts, each free node is a weighted
 * mean of its neighbours, so a taut net is inside the convex hull of its supports. */
static void doubt_plane(const hf_scene *s, hf_messages *messages)
{
    static const char *const word[3] = {"at one point", "on one line", "in one plane"};
    double extent_m, square = 0, off[3];
    int n = 0;
    flat f;
    for (int e = 0; e < s->n_cable; e++)
        if (hf_law_has(s->law[e], HF_LAW_MAY_PUSH) && s->target[e] < 0) return;
    if (s->load_N || !span_supports(s, &f, &extent_m)) return;
    for (int i = 0; i < s->n_node; i++) {
        if (s->role[i] != HF_ROLE_INNER) continue;
        double d = off_flat(&f, s->position_m + 3 * (size_t)i, off);
        square += d * d;
        n++;
    }
    double rms_m = sqrt(square / n);
    if (rms_m > FLATTER_PART * extent_m)
        hf_warning(messages,
                   "scene: all supports are %s, and no load, tie or strut holds the net away from there. With any "
                   "tensions, the net collapses there, so the inner nodes are at least %.4g mm RMS from "
                   "their target positions. Put supports on the surface, tie the net to another net, or add loads",
                   word[f.n_along], rms_m * 1e3);
}

/* ---- together ---- */

hf_status hf_scene_doubt(const hf_scene *s, hf_messages *messages)
{
    void *block;
    scratch t;
    if (HF_ARENA_ARRAYS(&block, HF_ARRAY(t.side, s->n_cable), HF_ARRAY(t.coordinate, s->n_node),
                        HF_ARRAY(t.from, s->n_node)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "scene: out of memory");
    doubt_cables(s, t.side, messages);
    doubt_nodes(s, &t, messages);
    doubt_size(s, messages);
    doubt_lengths(s, messages);
    doubt_plane(s, messages);
    hf_arena_free_block(block);
    return HF_OK;
}
