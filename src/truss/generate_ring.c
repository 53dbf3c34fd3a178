/* Makes the hoop truss under the rim of a net over a paraboloid:
 *
 *     rim of the net [n] -> front and rear joints -> longerons, verticals, bracing -> supports */
#include <hifdm/truss.h>

#include "base/elementary.h"
#include "truss/tube.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define ID_SIZE 16        /* bytes of a node id such as f<k>; a member id has room for two of them */
#define HEIGHT_SLACK 1e-9 /* relative; heights that agree to this are equal */

/* ---- what can be made ---- */

const char *hf_truss_ring_fault(const hf_truss_settings *s, const hf_paraboloid *p, char *what, size_t size)
{
    const hf_truss_ring *r = &s->ring;
    int n_gap = 6 * p->rings; /* for triangles; the gaps of a quad net are known only when they are made */
    bool is_counted = p->grid == HF_GRID_TRIANGLE;
    if (p->rear_distance_m == 0 && r->height_m == 0) {
        snprintf(what, size, "is missing: the net has no rear rim that gives this height");
        return "height_m";
    }
    if (p->rear_distance_m > 0 && r->height_m > 0 &&
        fabs(r->height_m - p->rear_distance_m) > HEIGHT_SLACK * p->rear_distance_m) {
        snprintf(
            what, size,
            "of %.6g m puts the rear ring elsewhere than the rim of the rear net, which hangs on it: leave it out, "
            "or make it rear_distance_m, %.6g m",
            r->height_m, p->rear_distance_m);
        return "height_m";
    }
    if (is_counted && (n_gap % r->cells_per_bay != 0 || n_gap / r->cells_per_bay < 3)) {
        snprintf(what, size, "%d must divide the %d cells at the rim into at least three bays", r->cells_per_bay,
                 n_gap);
        return "cells_per_bay";
    }
    return NULL;
}

/* ---- members ---- */

typedef struct {
    const hf_truss_settings *s;
    hf_truss *t;
    int n, cells; /* joints of a ring; gaps between joints in a bay */
    int i_member;
    char *text, *end;
} generator;

/* Returns joint k of the front ring, counted around. The joint of the rear ring below it has the next index. */
static int joint(const generator *g, int k)
{
    return 2 * (k % g->n);
}

static void join(generator *g, int a, int b, hf_unit unit)
{
    const hf_truss_ring *r = &g->s->ring;
    const hf_tube *tube = unit == HF_UNIT_LONGERON   ? &r->longeron
                          : unit == HF_UNIT_VERTICAL ? &r->vertical
                                                     : &r->diagonal;
    g->text = hf_tube_join(g->s, tube->diameter_m, tube->wall_m, g->t, g->i_member++, a, b, unit, g->text,
                           (size_t)(g->end - g->text));
}

static void join_all(generator *g)
{
    hf_diagonals bracing = g->s->ring.bracing;
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < g->n; k++)
            join(g, joint(g, k) + side, joint(g, k + 1) + side, HF_UNIT_LONGERON);
    for (int k = 0; k < g->n; k += g->cells)
        join(g, joint(g, k), joint(g, k) + 1, HF_UNIT_VERTICAL);
    for (int k = 0; k < g->n; k += g->cells) {
        int from = joint(g, k), to = joint(g, k + g->cells);
        bool falls = k / g->cells % 2 == 0;
        if (bracing == HF_DIAGONALS_CROSSED || (bracing == HF_DIAGONALS_SINGLE && falls))
            join(g, from, to + 1, HF_UNIT_DIAGONAL);
        if (bracing == HF_DIAGONALS_CROSSED || (bracing == HF_DIAGONALS_SINGLE && !falls))
            join(g, from + 1, to, HF_UNIT_DIAGONAL);
    }
}

/* ---- joints ---- */

static void place_joints(generator *g, const hf_paraboloid *p, const double *rim_m)
{
    double height_m = p->rear_distance_m > 0 ? p->rear_distance_m : g->s->ring.height_m;
    for (int k = 0; k < g->n; k++)
        for (int side = 0; side < 2; side++) {
            int i = joint(g, k) + side;
            double *place = g->t->position_m + 3 * (size_t)i;
            place[0] = rim_m[3 * k];
            place[1] = rim_m[3 * k + 1];
            place[2] = rim_m[3 * k + 2] - side * height_m;
            if (k % g->cells == 0) g->t->mass_kg[i] = g->s->hinge_mass_kg;
            g->t->node_id[i] = g->text;
            g->text += snprintf(g->text, (size_t)(g->end - g->text), "%c%d", side ? 'r' : 'f', k) + 1;
        }
}

/* Returns the first joint of the bay that is nearest to this direction from the middle of the aperture. The position of
 * a bay is that of its first vertical, or its middle if `is_middle` is true. */
static int nearest_bay(const generator *g, const hf_paraboloid *p, double angle_deg, bool is_middle)
{
    double along_x = hf_cosine(HF_RAD_PER_DEG * angle_deg), along_y = hf_sine(HF_RAD_PER_DEG * angle_deg),
           most = -INFINITY;
    int nearest = 0;
    for (int k = 0; k < g->n; k += g->cells) {
        const double *a = g->t->position_m + 3 * (size_t)joint(g, k);
        const double *b = is_middle ? g->t->position_m + 3 * (size_t)joint(g, k + g->cells) : a;
        double x = (a[0] + b[0]) / 2 - p->offset_m, y = (a[1] + b[1]) / 2;
        double cosine = (x * along_x + y * along_y) / hf_norm(x, y, 0);
        if (!(cosine > most + 1e-12)) continue; /* the first of two equally near ones */
        most = cosine;
        nearest = k;
    }
    return nearest;
}

static void hold(const generator *g, const hf_paraboloid *p)
{
    const hf_truss_ring *r = &g->s->ring;
    unsigned char dofs = g->s->support_dofs == HF_HELD_ALL_DOFS ? 0x3f : 0x07;
    int k = nearest_bay(g, p, r->held_at_deg, r->held == HF_RING_HELD_BAY);
    for (int side = 0; side < 2 && r->held != HF_RING_HELD_THREE_VERTICALS; side++) {
        g->t->fixed[joint(g, k) + side] = dofs;
        if (r->held == HF_RING_HELD_BAY) g->t->fixed[joint(g, k + g->cells) + side] = dofs;
    }
    int n_bay = g->n / g->cells; /* at least 3, so that the rounded thirds are different verticals */
    for (int i = 0; i < 3 && r->held == HF_RING_HELD_THREE_VERTICALS; i++)
        g->t->fixed[joint(g, (k / g->cells + (i * n_bay + 1) / 3) % n_bay * g->cells) + 1] = dofs;
}

/* ---- together ---- */

static hf_status make(generator *g, const hf_paraboloid *p, const double *rim_m)
{
    int n_bay = g->n / g->cells, n_member = 2 * g->n + n_bay * (1 + (int)g->s->ring.bracing);
    size_t size = ID_SIZE * 2 * ((size_t)g->n + (size_t)n_member);
    HF_TRY(hf_truss_allocate(g->t, 2 * g->n, n_member, false));
    g->t->text = g->text = malloc(size);
    if (!g->text) return HF_NO_MEMORY;
    g->end = g->text + size;
    place_joints(g, p, rim_m);
    join_all(g);
    hold(g, p);
    return HF_OK;
}

hf_status hf_truss_ring_generate(const hf_truss_settings *settings, const hf_paraboloid *paraboloid, hf_truss *truss,
                                 hf_messages *messages)
{
    char what[HF_GENERATE_FAULT_SIZE];
    double *rim_m = NULL;
    generator g = {.s = settings, .t = truss, .cells = settings->ring.cells_per_bay};
    *truss = (hf_truss){0};
    const char *key = hf_truss_ring_fault(settings, paraboloid, what, sizeof what);
    if (key) return hf_error(messages, HF_BAD_CASE, "truss.ring.%s: %s", key, what);
    hf_status status = hf_paraboloid_rim(paraboloid, &g.n, &rim_m);
    bool is_whole = g.n % g.cells == 0 && g.n / g.cells >= 3;
    if (status == HF_OK && is_whole) status = make(&g, paraboloid, rim_m);
    free(rim_m);
    if (status != HF_OK) return hf_error(messages, status, "truss: out of memory for a ring of %d joints", 2 * g.n);
    if (is_whole) return HF_OK;
    return hf_error(
        messages, HF_BAD_CASE,
        "truss.ring.cells_per_bay: bays of %d cells must divide the rim of %d cells into at least three equal parts",
        g.cells, g.n);
}
