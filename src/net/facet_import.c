/* Contents: nodes - sides - together */
#include "net/facet_import.h"

#include "base/csv.h"
#include "net/side.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COLUMN_MAX 64
#define NARROW_PART 1e-9 /* nodes are in a line if they enclose less than this share of their distance squared */

enum { FACET_ID, FACET_A, FACET_D = FACET_A + 3, N_FACET_COLUMN };
static const char *const facet_column[N_FACET_COLUMN] = {"id", "a", "b", "c", "d"};

/* ---- nodes ---- */

double hf_facet_double_area(const hf_scene *s, int a, int b, int c)
{
    const double *p = s->position_m + 3 * (size_t)a, *q = s->position_m + 3 * (size_t)b;
    const double *r = s->position_m + 3 * (size_t)c;
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

/* Makes the n nodes of a facet go counter-clockwise. Returns what is wrong with their shape, or NULL. */
static const char *fault_of_shape(const hf_scene *s, int n, int corner[4])
{
    double area = 0, span = 0, min_area = INFINITY;
    for (int k = 1; k < n; k++) {
        const double *p = s->position_m + 3 * (size_t)corner[0], *q = s->position_m + 3 * (size_t)corner[k];
        span = fmax(span, (q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]));
        if (k + 1 < n) area += hf_facet_double_area(s, corner[0], corner[k], corner[k + 1]);
    }
    if (area < 0) {
        int second = corner[1];
        corner[1] = corner[n - 1];
        corner[n - 1] = second;
    }
    for (int k = 0; k < n; k++)
        min_area = fmin(min_area, hf_facet_double_area(s, corner[k], corner[(k + 1) % n], corner[(k + 2) % n]));
    if (n == 3) return min_area > NARROW_PART * span ? NULL : "its nodes are in a line, seen along z";
    return fabs(area) > NARROW_PART * span && min_area > -NARROW_PART * span
               ? NULL
               : "its nodes, in this order, do not go around a convex quadrilateral, seen along z";
}

/* Reads the corners of row r. If the row has a fault, they are all 0. */
static void read_corners(hf_csv *t, const int *where, hf_scene *s, int r)
{
    const char *id = hf_csv_cell(t, r, where[FACET_ID]);
    int n_before = t->n_fault, *corner = s->facet + 4 * (size_t)r;
    int n = where[FACET_D] >= 0 && *hf_csv_cell(t, r, where[FACET_D]) ? 4 : 3;
    for (int k = 0; k < n; k++) {
        const char *name = hf_csv_cell(t, r, where[FACET_A + k]);
        corner[k] = hf_csv_find_known(t, name);
        if (!*name)
            hf_csv_fault(t, t->line[r], id, "a facet has three or four nodes; there is none in the column ",
                         facet_column[FACET_A + k]);
        else if (corner[k] < 0)
            hf_csv_fault(t, t->line[r], id, "there is no node with the id ", name);
        for (int other = 0; other < k && corner[k] >= 0; other++)
            if (corner[other] == corner[k]) hf_csv_fault(t, t->line[r], id, "names a node twice: ", name);
    }
    const char *fault = t->n_fault == n_before ? fault_of_shape(s, n, corner) : NULL;
    if (fault) hf_csv_fault(t, t->line[r], id, fault, "");
    if (t->n_fault > n_before) memset(corner, 0, 4 * sizeof *corner);
    if (n == 3) corner[3] = corner[2];
}

/* ---- sides ---- */

/* Checks that each side is a cable or lies between two supports, and that no other facet is on its left. The sides of a
 * facet go around it, with the facet on their left. */
static void check_sides(hf_csv *t, const int *where, const hf_scene *s, hf_side *of_cable, hf_side *of_facet)
{
    int n = 0;
    for (int e = 0; e < s->n_cable; e++)
        of_cable[e] = hf_side_of(s->end[2 * e], s->end[2 * e + 1], e);
    qsort(of_cable, (size_t)s->n_cable, sizeof *of_cable, hf_side_compare);
    for (int r = 0; r < s->n_facet; r++)
        for (int k = 0; k < 4; k++) {
            int i = s->facet[4 * r + k], j = s->facet[4 * r + (k + 1) % 4];
            hf_side key = hf_side_of(i, j, 0);
            if (i == j) continue; /* the fourth side of a triangle, or any side of a facet with a fault */
            of_facet[n++] = (hf_side){i, j, r};
            bool is_rim = s->role[i] == HF_ROLE_SUPPORT && s->role[j] == HF_ROLE_SUPPORT;
            if (is_rim || bsearch(&key, of_cable, (size_t)s->n_cable, sizeof *of_cable, hf_side_compare_nodes))
                continue;
            char nodes[640];
            snprintf(nodes, sizeof nodes, "'%s' and '%s'", s->node_id[i], s->node_id[j]);
            hf_csv_fault(t, t->line[r], hf_csv_cell(t, r, where[FACET_ID]), "no cable joins its nodes ", nodes);
        }
    qsort(of_facet, (size_t)n, sizeof *of_facet, hf_side_compare);
    for (int k = 1; k < n; k++) {
        const hf_side *p = &of_facet[k - 1], *q = &of_facet[k];
        if (hf_side_compare_nodes(p, q) != 0) continue;
        char other[320];
        snprintf(other, sizeof other, "'%s' on line %d", hf_csv_cell(t, p->of, where[FACET_ID]), t->line[p->of]);
        hf_csv_fault(t, t->line[q->of], hf_csv_cell(t, q->of, where[FACET_ID]),
                     "is on the same side of a cable as the facet ", other);
        while (k + 1 < n && hf_side_compare_nodes(p, &of_facet[k + 1]) == 0)
            k++;
    }
}

/* ---- together ---- */

static hf_status build(hf_csv *t, hf_scene *s)
{
    int where[N_FACET_COLUMN];
    HF_TRY(hf_csv_read(t->path, COLUMN_MAX, t, t->messages));
    HF_TRY(hf_csv_find_columns(t, facet_column, N_FACET_COLUMN, FACET_D, where));
    HF_TRY(hf_csv_index(t, where[FACET_ID]));
    HF_TRY(hf_csv_know(t, s->n_node, s->node_id));
    size_t n = (size_t)t->n_row;
    hf_side *sides = malloc((4 * n + (size_t)s->n_cable) * sizeof *sides);
    s->facet = calloc(4 * n, sizeof *s->facet);
    bool has_room = sides && s->facet;
    if (has_room) {
        s->n_facet = t->n_row;
        for (int r = 0; r < t->n_row; r++)
            read_corners(t, where, s, r);
        check_sides(t, where, s, sides, sides + s->n_cable);
    }
    free(sides);
    return has_room ? hf_csv_close_faults(t) : hf_csv_no_memory(t);
}

hf_status hf_facet_import(const char *path, hf_scene *scene, hf_messages *messages)
{
    hf_csv table = {.path = path, .messages = messages};
    hf_status status = build(&table, scene);
    hf_csv_free(&table);
    return status;
}
