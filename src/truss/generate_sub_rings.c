/* Makes the truss of basic sub-rings over the modules of a net on a parabolic cylinder (Chen et al. 2022, Fig. 15):
 *
 *     net settings -> grid of front nodes on the ribs -> module corners with posts
 *       -> ribs along x (unit BUD) -> lines along y (units MBUG, ABUG) -> supports */
#include <hifdm/truss.h>
#include "base/elementary.h"
#include "truss/tube.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#define TRUSS_NODE_MAX 1000000 /* keeps every index far below the range of int */
#define ID_SIZE 40             /* bytes of a node id such as f<i>.<k>_<j>; a member id has room for two of them */

const char *const hf_diagonals_word[4] = {"none", "single", "crossed", NULL};

typedef struct {
    const hf_truss_settings *set;
    const hf_cylinder *c;
    hf_truss *t;
    hf_scene grid; /* front nodes of all ribs: modules[0]*panels+1 along x, modules[1]+1 along y */
    int i_node, i_member;
    char *text;
} generator;

static const hf_truss_unit *unit_of(const hf_truss_settings *s, hf_unit unit)
{
    return unit == HF_UNIT_BUD ? &s->bud : unit == HF_UNIT_MBUG ? &s->mbug : &s->abug;
}

/* Returns the unit of generatrix line i of n + 1: MBUG or ABUG. */
static hf_unit line_unit(const hf_truss_settings *s, int i, int n)
{
    int from_edge = i < n - i ? i : n - i;
    return from_edge % s->main_every == 0 ? HF_UNIT_MBUG : HF_UNIT_ABUG;
}

/* Returns the index of the front node of module corner (i, j). Its rear node has the next index. */
static int corner(const generator *g, int i, int j)
{
    return 2 * (j * (g->c->modules[0] + 1) + i);
}

/* Adds a front node and the rear node behind it. An outer node is at the support of its edge tie, outside the net.
 * i_line, j_line: the module borders on which the node lies; -1 if it is between two borders. `where` is the id of both
 * without the first letter. */
static void add_node(generator *g, const double *grid_m, int i_line, int j_line, const char *where)
{
    const hf_cylinder *cylinder = g->c;
    double x = grid_m[0] + ((i_line == cylinder->modules[0]) - (i_line == 0)) * cylinder->edge_tie_m;
    double y = grid_m[1] + ((j_line == cylinder->modules[1]) - (j_line == 0)) * cylinder->edge_tie_m;
    double front_m[3] = {x, y, x * x / (4 * cylinder->focal_length_m)};
    double slope = x / (2 * cylinder->focal_length_m), stretch = hf_norm(1, slope, 0);
    double normal[3] = {-slope / stretch, 0, 1 / stretch};
    for (int side = 0; side < 2; side++) {
        int i = g->i_node++;
        for (int c = 0; c < 3; c++)
            g->t->position_m[3 * i + c] = front_m[c] - side * g->set->depth_m * normal[c];
        g->t->mass_kg[i] = g->set->hinge_mass_kg;
        g->t->node_id[i] = g->text;
        g->text += snprintf(g->text, ID_SIZE, "%c%s", side ? 'r' : 'f', where) + 1;
    }
}

static void add_member(generator *g, int a, int b, hf_unit unit)
{
    const hf_truss_unit *u = unit_of(g->set, unit);
    g->text = hf_tube_join(g->set, u->diameter_m, u->wall_m, g->t, g->i_member++, a, b, unit, g->text, 2 * ID_SIZE);
}

/* Adds chords, inner posts and diagonals of one unit between the front nodes a and b. Its inner front nodes have the
 * indices inside, inside + 2, ... i_panel is the index of the unit's first panel along the whole line. Single diagonals
 * fall in panels of even index and rise in the others. */
static void add_unit(generator *g, hf_unit unit, int a, int b, int inside, int i_panel)
{
    int n = unit_of(g->set, unit)->panels;
    hf_diagonals diagonals = unit_of(g->set, unit)->diagonals;
    for (int k = 0; k < n; k++) {
        int from = k ? inside + 2 * (k - 1) : a, to = k < n - 1 ? inside + 2 * k : b;
        bool falls = (i_panel + k) % 2 == 0;
        add_member(g, from, to, unit);
        add_member(g, from + 1, to + 1, unit);
        if (k) add_member(g, from, from + 1, unit);
        if (diagonals == HF_DIAGONALS_CROSSED || (diagonals == HF_DIAGONALS_SINGLE && falls))
            add_member(g, from, to + 1, unit);
        if (diagonals == HF_DIAGONALS_CROSSED || (diagonals == HF_DIAGONALS_SINGLE && !falls))
            add_member(g, from + 1, to, unit);
    }
}

static const double *front_of(const generator *g, int i_module, int k, int j)
{
    int nx = g->c->modules[0] * g->set->bud.panels + 1;
    return g->grid.position_m + 3 * (size_t)(j * nx + i_module * g->set->bud.panels + k);
}

static void add_corners(generator *g)
{
    char where[ID_SIZE];
    for (int j = 0; j <= g->c->modules[1]; j++)
        for (int i = 0; i <= g->c->modules[0]; i++) {
            snprintf(where, sizeof where, "%d_%d", i, j);
            add_node(g, front_of(g, i, 0, j), i, j, where);
        }
    for (int k = 0; k < g->i_node; k += 2)
        add_member(g, k, k + 1, HF_UNIT_BUD);
}

static void add_ribs(generator *g)
{
    char where[ID_SIZE];
    int n = g->set->bud.panels;
    for (int j = 0; j <= g->c->modules[1]; j++)
        for (int i = 0; i < g->c->modules[0]; i++) {
            int inside = g->i_node;
            for (int k = 1; k < n; k++) {
                snprintf(where, sizeof where, "%d.%d_%d", i, k, j);
                add_node(g, front_of(g, i, k, j), -1, j, where);
            }
            add_unit(g, HF_UNIT_BUD, corner(g, i, j), corner(g, i + 1, j), inside, i * n);
        }
}

static void add_lines(generator *g)
{
    char where[ID_SIZE];
    for (int i = 0; i <= g->c->modules[0]; i++) {
        hf_unit unit = line_unit(g->set, i, g->c->modules[0]);
        int n = unit_of(g->set, unit)->panels;
        for (int j = 0; j < g->c->modules[1]; j++) {
            int inside = g->i_node;
            const double *from = front_of(g, i, 0, j), *to = front_of(g, i, 0, j + 1);
            for (int k = 1; k < n; k++) {
                double position_m[3] = {from[0], from[1] + (to[1] - from[1]) * k / n, from[2]};
                snprintf(where, sizeof where, "%d_%d.%d", i, j, k);
                add_node(g, position_m, i, -1, where);
            }
            add_unit(g, unit, corner(g, i, j), corner(g, i, j + 1), inside, j * n);
        }
    }
}

/* Holds the corners of the middle module. If the number of modules along an axis is even, the line between the two
 * middle modules replaces the middle module along that axis. */
static void hold(const generator *g)
{
    const int *m = g->c->modules;
    for (int j = m[1] / 2; j <= (m[1] + 1) / 2; j++)
        for (int i = m[0] / 2; i <= (m[0] + 1) / 2; i++)
            for (int side = g->set->supports == HF_HELD_CENTRAL_MODULE_REAR; side < 2; side++)
                g->t->fixed[corner(g, i, j) + side] = g->set->support_dofs == HF_HELD_ALL_DOFS ? 0x3f : 0x07;
}

/* Adds the nodes and members of n_unit units to the counts, without module corners and the posts there. */
static void count_unit(const hf_truss_unit *u, double n_unit, double *n_node, double *n_member)
{
    *n_node += n_unit * 2 * (u->panels - 1);
    *n_member += n_unit * (u->panels * (2.0 + (int)u->diagonals) + u->panels - 1);
}

static hf_status generate(generator *g, hf_messages *messages)
{
    const int *m = g->c->modules;
    double corners = (m[0] + 1.0) * (m[1] + 1.0), n_node = 2 * corners, n_member = corners;
    count_unit(&g->set->bud, m[0] * (m[1] + 1.0), &n_node, &n_member);
    for (int i = 0; i <= m[0]; i++)
        count_unit(unit_of(g->set, line_unit(g->set, i, m[0])), m[1], &n_node, &n_member);
    if (n_node > TRUSS_NODE_MAX)
        return hf_error(messages, HF_BAD_CASE, "truss: %.0f nodes exceed the maximum of %d", n_node, TRUSS_NODE_MAX);
    hf_cylinder ribs = *g->c;
    ribs.cells_per_module[0] = g->set->bud.panels;
    ribs.cells_per_module[1] = 1;
    ribs.scallop = ribs.edge_tie_m = ribs.rear_distance_m = 0;
    ribs.pattern = HF_PATTERN_QUAD;
    HF_TRY(hf_scene_parabolic_cylinder(&ribs, NULL, &g->grid, messages));
    hf_status status = hf_truss_allocate(g->t, (int)n_node, (int)n_member, false);
    g->text = status == HF_OK ? malloc(ID_SIZE * (size_t)(n_node + 2 * n_member)) : NULL;
    g->t->text = g->text;
    if (!g->text) return hf_error(messages, HF_NO_MEMORY, "truss: out of memory for %.0f nodes", n_node);
    add_corners(g);
    add_ribs(g);
    add_lines(g);
    hold(g);
    return HF_OK;
}

hf_status hf_truss_generate(const hf_truss_settings *s, const hf_cylinder *cylinder, hf_truss *truss,
                            hf_messages *messages)
{
    *truss = (hf_truss){0};
    generator g = {.set = s, .c = cylinder, .t = truss};
    hf_status status = generate(&g, messages);
    hf_scene_free(&g.grid);
    return status;
}
