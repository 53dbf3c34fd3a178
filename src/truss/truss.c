/* Contents: words - memory - measures - the generated truss - attachments - checks */
#include <hifdm/truss.h>

#include "base/arena.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define FAULT_MAX 20           /* faults that are spelled out */
#define TRUSS_NODE_MAX 1000000 /* keeps every index well inside an int */
#define ID_SIZE 40             /* f<i>.<k>_<j>, and room for two of them in a member's */

static const double PI = 3.14159265358979323846;

const char *const hf_dof_word[HF_TRUSS_DOF] = {"ux", "uy", "uz", "rx", "ry", "rz"};
const char *const hf_joint_word[2] = {"rigid", "pinned"};
const char *const hf_unit_word[4] = {"bud", "mbug", "abug", "other"};

/* ---- memory ---- */

static void lay_out(hf_arena *arena, hf_truss *t, int with_line)
{
    size_t n = (size_t)t->n_node, m = (size_t)t->n_member;
    t->position_m = hf_arena_take(arena, 3 * n, sizeof(double));
    t->fixed = hf_arena_take(arena, n, 1);
    t->mass_kg = hf_arena_take(arena, n, sizeof(double));
    t->end = hf_arena_take(arena, 2 * m, sizeof(int));
    t->joint = hf_arena_take(arena, m, 1);
    t->unit = hf_arena_take(arena, m, 1);
#define TAKE(name, units, otherwise, description) t->name = hf_arena_take(arena, m, sizeof(double));
    HF_MEMBER_NUMBERS(TAKE)
#undef TAKE
    t->node_id = hf_arena_take(arena, n, sizeof *t->node_id);
    t->member_id = hf_arena_take(arena, m, sizeof *t->member_id);
    t->node_line = with_line ? hf_arena_take(arena, n, sizeof(int)) : NULL;
    t->member_line = with_line ? hf_arena_take(arena, m, sizeof(int)) : NULL;
}

hf_status hf_truss_allocate(hf_truss *truss, int n_node, int n_member, bool with_line)
{
    *truss = (hf_truss){.n_node = n_node, .n_member = n_member};
    hf_arena arena = {0};
    if (HF_ARENA_MAKE(&arena, lay_out(&arena, truss, with_line)) != HF_OK) {
        *truss = (hf_truss){0};
        return HF_NO_MEMORY;
    }
    truss->block = arena.block;
    return HF_OK;
}

void hf_truss_free(hf_truss *truss)
{
    free(truss->block);
    free(truss->text);
    *truss = (hf_truss){0};
}

/* ---- measures ---- */

double hf_truss_member_length(const hf_truss *t, int i_member)
{
    const double *a = t->position_m + 3 * (size_t)t->end[2 * i_member];
    const double *b = t->position_m + 3 * (size_t)t->end[2 * i_member + 1];
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

double hf_truss_mass(const hf_truss *t)
{
    double mass = 0;
    for (int i = 0; i < t->n_node; i++)
        mass += t->mass_kg[i];
    for (int e = 0; e < t->n_member; e++)
        mass += t->density_kg_per_m3[e] * t->A_m2[e] * hf_truss_member_length(t, e);
    return mass;
}

/* ---- the generated truss ---- */

typedef struct {
    const hf_truss_settings *set;
    const hf_cylinder *c;
    hf_truss *t;
    hf_scene grid; /* front nodes of all ribs: modules[0]*panels+1 along x, modules[1]+1 along y */
    int i_node, i_member;
    char *text;
} generator;

static const hf_truss_unit *unit_of(const hf_truss_settings *set, int unit)
{
    return unit == HF_UNIT_BUD ? &set->bud : unit == HF_UNIT_MBUG ? &set->mbug : &set->abug;
}

/* MBUG or ABUG for the generatrix line i of n+1. */
static int line_unit(const hf_truss_settings *set, int i, int n)
{
    int from_edge = i < n - i ? i : n - i;
    return from_edge % set->main_every == 0 ? HF_UNIT_MBUG : HF_UNIT_ABUG;
}

/* Front node of module corner (i, j); its rear node follows. */
static int corner(const generator *g, int i, int j)
{
    return 2 * (j * (g->c->modules[0] + 1) + i);
}

static void add_node(generator *g, const double *front_m, const char *where)
{
    double slope = front_m[0] / (2 * g->c->focal_length_m), stretch = hypot(1, slope);
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

static void add_member(generator *g, int a, int b, int unit)
{
    hf_truss *t = g->t;
    const hf_truss_unit *u = unit_of(g->set, unit);
    int e = g->i_member++;
    double outer = u->diameter_m / 2, inner = outer - u->wall_m;
    t->end[2 * e] = a;
    t->end[2 * e + 1] = b;
    t->unit[e] = (unsigned char)unit;
    t->joint[e] = (unsigned char)g->set->joints;
    t->E_Pa[e] = g->set->E_Pa;
    t->G_Pa[e] = g->set->G_Pa;
    t->A_m2[e] = PI * (outer * outer - inner * inner);
    t->Iy_m4[e] = t->Iz_m4[e] = PI / 4 * (pow(outer, 4) - pow(inner, 4));
    t->J_m4[e] = 2 * t->Iy_m4[e];
    t->Asy_m2[e] = t->Asz_m2[e] = g->set->theory == HF_THEORY_TIMOSHENKO ? t->A_m2[e] / 2 : (double)INFINITY;
    t->density_kg_per_m3[e] = g->set->density_kg_per_m3;
    t->expansion_per_K[e] = g->set->expansion_per_K;
    t->member_id[e] = g->text;
    g->text += snprintf(g->text, 2 * ID_SIZE, "%s-%s", t->node_id[a], t->node_id[b]) + 1;
}

/* Chords, inner posts and diagonals of one unit from the front node a to the front node b, by way of the inner front
 * nodes from `inside` on. i_panel: of its first panel along the whole line; single diagonals zigzag. */
static void add_unit(generator *g, int unit, int a, int b, int inside, int i_panel)
{
    int n = unit_of(g->set, unit)->panels, diagonals = unit_of(g->set, unit)->diagonals;
    for (int k = 0; k < n; k++) {
        int from = k ? inside + 2 * (k - 1) : a, to = k < n - 1 ? inside + 2 * k : b, falls = (i_panel + k) % 2 == 0;
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
            add_node(g, front_of(g, i, 0, j), where);
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
                add_node(g, front_of(g, i, k, j), where);
            }
            add_unit(g, HF_UNIT_BUD, corner(g, i, j), corner(g, i + 1, j), inside, i * n);
        }
}

static void add_lines(generator *g)
{
    char where[ID_SIZE];
    for (int i = 0; i <= g->c->modules[0]; i++) {
        int unit = line_unit(g->set, i, g->c->modules[0]), n = unit_of(g->set, unit)->panels;
        for (int j = 0; j < g->c->modules[1]; j++) {
            int inside = g->i_node;
            const double *from = front_of(g, i, 0, j), *to = front_of(g, i, 0, j + 1);
            for (int k = 1; k < n; k++) {
                double position_m[3] = {from[0], from[1] + (to[1] - from[1]) * k / n, from[2]};
                snprintf(where, sizeof where, "%d_%d.%d", i, j, k);
                add_node(g, position_m, where);
            }
            add_unit(g, unit, corner(g, i, j), corner(g, i, j + 1), inside, j * n);
        }
    }
}

/* The corners of the module in the middle; of an even number of modules the line between the two middle ones. */
static void hold(const generator *g)
{
    const int *m = g->c->modules;
    for (int j = m[1] / 2; j <= (m[1] + 1) / 2; j++)
        for (int i = m[0] / 2; i <= (m[0] + 1) / 2; i++)
            for (int side = g->set->supports == HF_HELD_CENTRAL_MODULE_REAR; side < 2; side++)
                g->t->fixed[corner(g, i, j) + side] = g->set->support_dofs == HF_HELD_ALL_DOFS ? 0x3f : 0x07;
}

/* Nodes and members of a unit besides the corners and their posts. */
static void count_unit(const hf_truss_unit *u, double n_unit, double *n_node, double *n_member)
{
    *n_node += n_unit * 2 * (u->panels - 1);
    *n_member += n_unit * (u->panels * (2.0 + u->diagonals) + u->panels - 1);
}

static hf_status generate(generator *g, hf_messages *messages)
{
    const int *m = g->c->modules;
    double corners = (m[0] + 1.0) * (m[1] + 1.0), n_node = 2 * corners, n_member = corners;
    count_unit(&g->set->bud, m[0] * (m[1] + 1.0), &n_node, &n_member);
    for (int i = 0; i <= m[0]; i++)
        count_unit(unit_of(g->set, line_unit(g->set, i, m[0])), m[1], &n_node, &n_member);
    if (n_node > TRUSS_NODE_MAX)
        return hf_error(messages, HF_BAD_CASE, "truss: %.0f nodes are more than this program takes (%d)", n_node,
                        TRUSS_NODE_MAX);
    hf_cylinder ribs = *g->c;
    ribs.cells_per_module[0] = g->set->bud.panels;
    ribs.cells_per_module[1] = 1;
    ribs.scallop = 0;
    HF_TRY(hf_scene_parabolic_cylinder(&ribs, NULL, &g->grid, messages));
    hf_status status = hf_truss_allocate(g->t, (int)n_node, (int)n_member, 0);
    g->text = status == HF_OK ? malloc(ID_SIZE * (size_t)(n_node + 2 * n_member)) : NULL;
    g->t->text = g->text;
    if (!g->text) return hf_error(messages, HF_NO_MEMORY, "truss: out of memory for %.0f nodes", n_node);
    add_corners(g);
    add_ribs(g);
    add_lines(g);
    hold(g);
    return HF_OK;
}

hf_status hf_truss_generate(const hf_truss_settings *settings, const hf_cylinder *cylinder, hf_truss *truss,
                            hf_messages *messages)
{
    *truss = (hf_truss){0};
    generator g = {.set = settings, .c = cylinder, .t = truss};
    hf_status status = generate(&g, messages);
    hf_scene_free(&g.grid);
    return status;
}

/* ---- attachments ---- */

static double distance_m(const double *a, const double *b)
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

hf_status hf_truss_attach(const hf_truss *t, const hf_scene *scene, double tolerance_m, int *n_attachment,
                          int *scene_node, int *truss_node, hf_messages *messages)
{
    int n_fault = 0;
    *n_attachment = 0;
    for (int i = 0; i < scene->n_node; i++) {
        if (scene->role[i] != HF_ROLE_SUPPORT) continue;
        const double *p = scene->position_m + 3 * (size_t)i;
        int nearest = 0;
        for (int k = 1; k < t->n_node; k++)
            if (distance_m(p, t->position_m + 3 * (size_t)k) < distance_m(p, t->position_m + 3 * (size_t)nearest))
                nearest = k;
        double gap = distance_m(p, t->position_m + 3 * (size_t)nearest);
        if (!(gap <= tolerance_m) && ++n_fault <= FAULT_MAX)
            hf_error(messages, HF_BAD_CASE,
                     "truss: net support '%s' has no attachment: the nearest truss node, '%s', is %.3g m away, and "
                     "truss.match_tolerance_m is %g m",
                     scene->node_id[i], t->node_id[nearest], gap, tolerance_m);
        scene_node[*n_attachment] = i;
        truss_node[(*n_attachment)++] = nearest;
    }
    if (n_fault > FAULT_MAX) hf_error(messages, HF_BAD_CASE, "truss: and %d more supports", n_fault - FAULT_MAX);
    return n_fault ? HF_BAD_CASE : HF_OK;
}

/* ---- checks ---- */

void hf_truss_describe(const hf_truss *t, bool is_member, int index, char *text, size_t size)
{
    const int *line = is_member ? t->member_line : t->node_line;
    const char *file = is_member ? t->members_file : t->nodes_file, *kind = is_member ? "member" : "node";
    const char *id = is_member ? t->member_id[index] : t->node_id[index];
    if (line && file)
        snprintf(text, size, "%s:%d: %s '%s'", file, line[index], kind, id);
    else
        snprintf(text, size, "truss: %s '%s'", kind, id);
    hf_text_trim_utf8(text);
}

static void fault(const hf_truss *t, int is_member, int index, int *n_fault, const char *what, hf_messages *messages)
{
    char where[512];
    if (++*n_fault > FAULT_MAX) return;
    hf_truss_describe(t, is_member, index, where, sizeof where);
    hf_error(messages, HF_BAD_CASE, "%s %s", where, what);
}

static void check_member(const hf_truss *t, int e, int *n_fault, hf_messages *messages)
{
    int rigid = t->joint[e] == HF_JOINT_RIGID;
    const double positive[] = {t->E_Pa[e],  t->A_m2[e], t->G_Pa[e],   t->Iy_m4[e],
                               t->Iz_m4[e], t->J_m4[e], t->Asy_m2[e], t->Asz_m2[e]};
    int all = 1;
    for (size_t k = 0; k < (rigid ? sizeof positive / sizeof *positive : 2); k++)
        all = all && positive[k] > 0 && (k > 5 || isfinite(positive[k]));
    if (!all)
        fault(t, 1, e, n_fault,
              rigid ? "needs E, G, A, Iy, Iz, J and shear areas above zero" : "needs E and A above zero", messages);
    if (!isfinite(t->roll_rad[e]) || !isfinite(t->expansion_per_K[e]) || !(t->density_kg_per_m3[e] >= 0) ||
        !isfinite(t->density_kg_per_m3[e]))
        fault(t, 1, e, n_fault, "needs a finite roll and expansion, and a density that is not below zero", messages);
    if (t->end[2 * e] == t->end[2 * e + 1])
        fault(t, 1, e, n_fault, "joins a node to itself", messages);
    else if (!(hf_truss_member_length(t, e) > 0))
        fault(t, 1, e, n_fault, "has zero length: its two nodes are at the same position", messages);
}

hf_status hf_truss_check(const hf_truss *t, hf_messages *messages)
{
    int n_fault = 0;
    for (int i = 0; i < t->n_node; i++) {
        const double *p = t->position_m + 3 * (size_t)i;
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
            fault(t, 0, i, &n_fault, "has a position that is no number", messages);
        if (!(t->mass_kg[i] >= 0) || !isfinite(t->mass_kg[i]))
            fault(t, 0, i, &n_fault, "has a mass that is no number or below zero", messages);
    }
    for (int e = 0; e < t->n_member && n_fault <= FAULT_MAX; e++)
        check_member(t, e, &n_fault, messages);
    if (n_fault > FAULT_MAX) hf_error(messages, HF_BAD_CASE, "truss: and more faults like these");
    return n_fault ? HF_BAD_CASE : HF_OK;
}
