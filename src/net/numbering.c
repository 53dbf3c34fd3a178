/* Finds an order of the free nodes with little factorisation work:
 *
 *     scene -> adjacency of the free nodes
 *       -> Cuthill-McKee, and sorting along x, y, z; each order and its reverse
 *       -> estimate the work of factorisation, keep the best order
 *
 * Contents: adjacency of the free nodes - Cuthill-McKee - sorting along an axis - choice */
#include "net/numbering.h"

#include "base/arena.h"

#include <stdlib.h>
#include <string.h>

/* A node to be sorted along an axis. */
typedef struct {
    double key[3]; /* coordinate along the axis, then the two others to break ties */
    int node;
} sort_item;

typedef struct {
    const hf_scene *s;
    int n;           /* number of free nodes */
    int *free_of;    /* [n_node], index among the free nodes, -1 for a support */
    int *node_of;    /* [n], node of the scene */
    int *start;      /* [n + 1], first entry of each node in `neighbour` */
    int *neighbour;  /* free neighbours; each cable between free nodes has two entries */
    int *position;   /* [n], position in the order under test */
    int *order;      /* [n], the order under test */
    int *level;      /* [n], distance from the root of a search; -1 = not reached, -2 = already numbered */
    int *queue;      /* [n], scratch */
    int *best;       /* [n], the best order so far */
    int *wave;       /* [n], nodes of the last search */
    sort_item *item; /* [n], scratch of sort_along */
} graph;

/* ---- adjacency of the free nodes ---- */

static void build(graph *g)
{
    const hf_scene *s = g->s;
    for (int i = 0; i < s->n_node; i++) {
        g->free_of[i] = s->role[i] == HF_ROLE_SUPPORT ? -1 : g->n;
        if (g->free_of[i] >= 0) g->node_of[g->n++] = i;
    }
    for (int k = 0; k < 2 * s->n_cable; k++) {
        int node = g->free_of[s->end[k]], other = g->free_of[s->end[k ^ 1]];
        if (node >= 0 && other >= 0) g->start[node]++;
    }
    for (int i = 0; i < g->n; i++)
        g->start[i + 1] += g->start[i];             /* the end of the neighbours of node i */
    for (int k = 2 * s->n_cable - 1; k >= 0; k--) { /* becomes their start */
        int node = g->free_of[s->end[k]], other = g->free_of[s->end[k ^ 1]];
        if (node >= 0 && other >= 0) g->neighbour[--g->start[node]] = other;
    }
}

static int degree(const graph *g, int i)
{
    return g->start[i + 1] - g->start[i];
}

/* ---- Cuthill-McKee ---- */

/* Searches breadth-first from `root` over the nodes that are not yet numbered, neighbours by rising degree. Writes the
 * nodes it finds into `wave`, sets their levels, and returns their number. */
static int search(graph *g, int root, int *wave)
{
    int n = 0;
    g->level[root] = 0;
    wave[n++] = root;
    for (int i = 0; i < n; i++) {
        int first = n, node = wave[i];
        for (int k = g->start[node]; k < g->start[node + 1]; k++) {
            int next = g->neighbour[k];
            if (g->level[next] != -1) continue;
            g->level[next] = g->level[node] + 1;
            int at = n++; /* stable insertion by degree */
            for (; at > first && degree(g, wave[at - 1]) > degree(g, next); at--)
                wave[at] = wave[at - 1];
            wave[at] = next;
        }
    }
    return n;
}

/* Returns a node at the far end of the component of `root` (George & Liu 1979). */
static int peripheral(graph *g, int root)
{
    for (int depth = -1;;) {
        int n = search(g, root, g->wave), last = g->level[g->wave[n - 1]], far = g->wave[n - 1];
        for (int i = n - 1; i >= 0 && g->level[g->wave[i]] == last; i--)
            if (degree(g, g->wave[i]) < degree(g, far)) far = g->wave[i];
        for (int i = 0; i < n; i++)
            g->level[g->wave[i]] = -1;
        if (last <= depth) return root;
        depth = last;
        root = far;
    }
}

static void cuthill_mckee(graph *g)
{
    int n_done = 0;
    for (int i = 0; i < g->n; i++)
        g->level[i] = -1;
    for (int i = 0; i < g->n; i++) {
        if (g->level[i] != -1) continue;
        int root = peripheral(g, i), n = search(g, root, g->queue);
        for (int k = 0; k < n; k++) {
            g->level[g->queue[k]] = -2;
            g->order[n_done++] = g->queue[k];
        }
    }
}

/* ---- sorting along an axis ---- */

static int compare_items(const void *a, const void *b)
{
    const sort_item *x = a, *y = b;
    for (int c = 0; c < 3; c++)
        if (x->key[c] != y->key[c]) return x->key[c] < y->key[c] ? -1 : 1;
    return (x->node > y->node) - (x->node < y->node);
}

static void sort_along(graph *g, int axis)
{
    for (int i = 0; i < g->n; i++) {
        const double *p = g->s->position_m + 3 * (size_t)g->node_of[i];
        g->item[i] = (sort_item){{p[axis], p[axis == 0], p[axis == 2 ? 1 : 2]}, i};
    }
    qsort(g->item, (size_t)g->n, sizeof *g->item, compare_items);
    for (int i = 0; i < g->n; i++)
        g->order[i] = g->item[i].node;
}

/* ---- choice ---- */

/* Weight of the band in the work. It is small, because nearly all factorisations are those of populations. With 1/4,
 * the order of the examples changes for a band that is 10 % narrower. With less than 1/16, round nets keep an order
 * that costs four times as much. */
#define BAND_PART 0.125

/* Returns the work of factorisations with the order under test. For a skyline, as in the lanes of populations, it
 * grows with the sum of the squared row widths. For a band, as of the Newton matrix, it grows with n times the square
 * of the half-bandwidth. */
static double work(graph *g, int *half_bandwidth)
{
    double sum = 0;
    *half_bandwidth = 0;
    for (int i = 0; i < g->n; i++)
        g->position[g->order[i]] = i;
    for (int i = 0; i < g->n; i++) {
        int width = 0;
        for (int k = g->start[i]; k < g->start[i + 1]; k++)
            if (g->position[i] - g->position[g->neighbour[k]] > width)
                width = g->position[i] - g->position[g->neighbour[k]];
        sum += (double)width * width;
        if (width > *half_bandwidth) *half_bandwidth = width;
    }
    return sum + BAND_PART * g->n * *half_bandwidth * *half_bandwidth;
}

static void reverse(graph *g)
{
    for (int i = 0, j = g->n - 1; i < j; i++, j--) {
        int swap = g->order[i];
        g->order[i] = g->order[j];
        g->order[j] = swap;
    }
}

/* Keeps the order under test or its reverse, if one of them is better than the best so far. The rows of the reverse
 * have other widths. */
static void keep_if_better(graph *g, double *best_work, int *best_half_bandwidth)
{
    for (int pass = 0; pass < 2; pass++, reverse(g)) {
        int half_bandwidth;
        double this_work = work(g, &half_bandwidth);
        if (*best_work >= 0 && this_work >= *best_work) continue;
        *best_work = this_work;
        *best_half_bandwidth = half_bandwidth;
        memcpy(g->best, g->order, (size_t)g->n * sizeof(int));
    }
}

hf_status hf_numbering_find(const hf_scene *scene, int *order, int *half_bandwidth)
{
    graph g = {.s = scene};
    void *block;
    size_t n = (size_t)scene->n_node;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(g.free_of, n), HF_ARRAY(g.node_of, n), HF_ARRAY(g.start, n + 1),
                           HF_ARRAY(g.neighbour, 2 * (size_t)scene->n_cable), HF_ARRAY(g.position, n),
                           HF_ARRAY(g.order, n), HF_ARRAY(g.level, n), HF_ARRAY(g.queue, n), HF_ARRAY(g.best, n),
                           HF_ARRAY(g.wave, n), HF_ARRAY(g.item, n)));
    build(&g);
    double best_work = -1;
    cuthill_mckee(&g);
    keep_if_better(&g, &best_work, half_bandwidth);
    for (int axis = 0; axis < 3; axis++) {
        sort_along(&g, axis);
        keep_if_better(&g, &best_work, half_bandwidth);
    }
    for (int i = 0; i < g.n; i++)
        order[i] = g.node_of[g.best[i]];
    hf_arena_free_block(block);
    return HF_OK;
}
