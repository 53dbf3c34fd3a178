/* Patterns, pitches, scallops and edge ties of the parabolic cylinder, against counts and geometry of the test's own.
 * Contents: helpers - patterns - pitches - edge ties - rear nets - symmetry - what cannot be made */
#include "nets.h"

#include "net/symmetry.h"
#include <hifdm/cable_set.h>

#include <float.h>

/* 2 x 3 modules of 2 x 4 cells: 5 x 13 grid nodes. */
static const hf_cylinder plain = {.aperture_m = 10.3,
                                  .length_m = 12.7,
                                  .focal_length_m = 4.77,
                                  .modules = {2, 3},
                                  .cells_per_module = {2, 4},
                                  .supports = HF_SUPPORTS_MODULE_CORNERS};
enum { NX = 5, NY = 13, N_CELL = (NX - 1) * (NY - 1) };

#define ROUNDOFF (16 * 10 * DBL_EPSILON) /* of a few operations on numbers of size 10 */

/* ---- helpers ---- */

static hf_scene generate(const hf_cylinder *cylinder)
{
    hf_messages messages = {0};
    hf_scene scene;
    ck_assert_msg(hf_scene_parabolic_cylinder(cylinder, NULL, &scene, &messages) == HF_OK, "%s", messages.text);
    ck_assert_msg(hf_scene_check(&scene, &messages) == HF_OK, "%s", messages.text);
    ck_assert_ptr_null(messages.text);
    return scene;
}

static int node_named(const hf_scene *s, const char *format, int i, int j)
{
    char id[32];
    snprintf(id, sizeof id, format, i, j);
    for (int k = 0; k < s->n_node; k++)
        if (!strcmp(s->node_id[k], id)) return k;
    return -1;
}

static int set_size(const hf_scene *s, const char *name)
{
    int k = hf_cable_set_find(s, name);
    return k < 0 ? 0 : s->set_start[k + 1] - s->set_start[k];
}

/* The one cable between two nodes, or -1. */
static int cable_between(const hf_scene *s, int a, int b)
{
    int found = -1;
    for (int e = 0; e < s->n_cable; e++)
        if ((s->end[2 * e] == a && s->end[2 * e + 1] == b) || (s->end[2 * e] == b && s->end[2 * e + 1] == a)) {
            ck_assert_int_eq(found, -1);
            found = e;
        }
    return found;
}

static bool is_in(const hf_scene *s, const char *name, int i_cable)
{
    int k = hf_cable_set_find(s, name);
    return k >= 0 && hf_cable_set_has(s, k, i_cable);
}

static double arc_m(double x, double focal)
{
    double slope = x / (2 * focal);
    return focal * (slope * sqrt(1 + slope * slope) + log(slope + sqrt(1 + slope * slope)));
}

/* ---- patterns ---- */

/* What a cable of each family looks like on the grid; every cable is one of them. */
static void demand_families(const hf_scene *s)
{
    for (int e = 0; e < s->n_cable; e++) {
        int i[2], j[2];
        char kind[2];
        for (int k = 0; k < 2; k++)
            ck_assert_int_eq(sscanf(s->node_id[s->end[2 * e + k]], "%c%d_%d", &kind[k], &i[k], &j[k]), 3);
        bool is_tie = kind[0] == 's', is_middle = kind[1] == 'm';
        int di = abs(i[1] - i[0]), dj = abs(j[1] - j[0]);
        ck_assert_int_eq(is_in(s, "edge_tie", e), is_tie);
        ck_assert_int_eq(is_in(s, "directrix", e), !is_tie && !is_middle && di == 1 && dj == 0);
        ck_assert_int_eq(is_in(s, "generatrix", e), !is_tie && !is_middle && di == 0 && dj == 1);
        ck_assert_int_eq(is_in(s, "diagonal", e), !is_tie && (is_middle || (di == 1 && dj == 1)));
        bool along_x_edge = j[0] == j[1] && (j[0] == 0 || j[0] == NY - 1);
        bool along_y_edge = i[0] == i[1] && (i[0] == 0 || i[0] == NX - 1);
        bool is_outer = !is_tie && !is_middle && (along_x_edge || along_y_edge);
        ck_assert_int_eq(is_in(s, "edge", e), is_outer);
        ck_assert_int_eq(s->group[e], is_outer || is_tie ? HF_GROUP_BOUNDARY : HF_GROUP_INNER);
        ck_assert_int_eq(s->law[e], is_outer || is_tie ? HF_LAW_LENGTH : HF_LAW_TENSION);
    }
}

/* By hand: 4 x 13 cables along x, 5 x 12 along y, of them 8 and 24 on the outer edge; 48 cells. With supports on ribs
 * (4 lines of 5 nodes) the 4 cables of the two inner ribs join two supports, and those of the outer ones, too. */
static const struct {
    int pattern, supports, n_node, n_directrix, n_generatrix, n_diagonal, n_edge;
} counts[] = {
    {HF_PATTERN_QUAD, HF_SUPPORTS_MODULE_CORNERS, NX *NY, 52, 60, 0, 32},
    {HF_PATTERN_TRIANGLE, HF_SUPPORTS_MODULE_CORNERS, NX *NY, 52, 60, N_CELL, 32},
    {HF_PATTERN_ALTERNATING, HF_SUPPORTS_MODULE_CORNERS, NX *NY, 52, 60, N_CELL, 32},
    {HF_PATTERN_DIAGONAL, HF_SUPPORTS_MODULE_CORNERS, NX *NY + N_CELL, 8, 24, 4 * N_CELL, 32},
    {HF_PATTERN_QUAD, HF_SUPPORTS_RIBS, NX *NY, 52, 60, 0, 32},
    {HF_PATTERN_TRIANGLE, HF_SUPPORTS_RIBS, NX *NY, 52 - 16, 60, N_CELL, 24},
    {HF_PATTERN_DIAGONAL, HF_SUPPORTS_RIBS, NX *NY + N_CELL, 0, 24, 4 * N_CELL, 24},
};
enum { N_COUNTS = sizeof counts / sizeof *counts };

START_TEST(patterns_are_as_counted)
{
    hf_cylinder c = plain;
    c.pattern = (hf_pattern)counts[_i].pattern;
    c.supports = (hf_supports)counts[_i].supports;
    hf_scene s = generate(&c);
    ck_assert_int_eq(s.n_node, counts[_i].n_node);
    ck_assert_int_eq(set_size(&s, "directrix"), counts[_i].n_directrix);
    ck_assert_int_eq(set_size(&s, "generatrix"), counts[_i].n_generatrix);
    ck_assert_int_eq(set_size(&s, "diagonal"), counts[_i].n_diagonal);
    ck_assert_int_eq(set_size(&s, "edge"), counts[_i].n_edge);
    ck_assert_int_eq(set_size(&s, "edge_tie"), 0);
    ck_assert_int_eq(s.n_cable, counts[_i].n_directrix + counts[_i].n_generatrix + counts[_i].n_diagonal);
    demand_families(&s);
    hf_scene_free(&s);
}
END_TEST

/* From which corner of cell (i, j) its diagonal runs: (i, j), or (i + 1, j) in every second cell of alternating. */
START_TEST(diagonals_run_as_said)
{
    hf_cylinder c = plain;
    c.pattern = _i ? HF_PATTERN_ALTERNATING : HF_PATTERN_TRIANGLE;
    hf_scene s = generate(&c);
    for (int j = 0; j + 1 < NY; j++)
        for (int i = 0; i + 1 < NX; i++) {
            bool falls = _i && (i ^ j) & 1;
            int a = node_named(&s, "n%d_%d", i, j), b = node_named(&s, "n%d_%d", i + 1, j);
            int over_a = node_named(&s, "n%d_%d", i, j + 1), over_b = node_named(&s, "n%d_%d", i + 1, j + 1);
            ck_assert_int_eq(cable_between(&s, a, over_b) >= 0, !falls);
            ck_assert_int_eq(cable_between(&s, b, over_a) >= 0, falls);
        }
    hf_scene_free(&s);
}
END_TEST

/* The middle of a cell is that of its arc (or of its projection), on the cylinder, and joined to its four corners. */
START_TEST(middles_of_cells)
{
    hf_cylinder c = plain;
    c.pattern = HF_PATTERN_DIAGONAL;
    c.spacing = (hf_spacing)_i;
    hf_scene s = generate(&c);
    for (int j = 0; j + 1 < NY; j++)
        for (int i = 0; i + 1 < NX; i++) {
            int middle = node_named(&s, "m%d_%d", i, j);
            const double *p = s.position_m + 3 * middle, *corner[4];
            for (int k = 0; k < 4; k++) {
                int node = node_named(&s, "n%d_%d", i + k % 2, j + k / 2);
                ck_assert_int_ge(cable_between(&s, middle, node), 0);
                corner[k] = s.position_m + 3 * node;
            }
            double low = corner[0][0], high = corner[3][0];
            if (c.spacing == HF_SPACING_EQUAL_ARC)
                ck_assert_double_eq_tol(2 * arc_m(p[0], 4.77), arc_m(low, 4.77) + arc_m(high, 4.77), 2 * ROUNDOFF);
            else
                ck_assert_double_eq_tol(2 * p[0], low + high, ROUNDOFF);
            ck_assert_double_eq_tol(2 * p[1], corner[0][1] + corner[3][1], ROUNDOFF);
            ck_assert_double_eq_tol(p[2], p[0] * p[0] / (4 * 4.77), ROUNDOFF);
            ck_assert_int_eq(s.role[middle], HF_ROLE_INNER);
        }
    hf_scene_free(&s);
}
END_TEST

/* ---- pitches ---- */

START_TEST(pitches_place_the_borders)
{
    hf_cylinder c = plain;
    c.pitches_x_m = (hf_double_list){2, {4.1, 6.2}};
    c.pitches_y_m = (hf_double_list){3, {3.2, 5.5, 4}};
    c.spacing = (hf_spacing)_i;
    hf_scene s = generate(&c);
    static const double x_border[] = {-5.15, -1.05, 5.15}, y_border[] = {0, 3.2, 8.7, 12.7};
    for (int j = 0; j < NY; j++)
        for (int i = 0; i < NX; i++) {
            const double *p = s.position_m + 3 * (size_t)node_named(&s, "n%d_%d", i, j);
            double low = x_border[i / 2], high = i / 2 < 2 ? x_border[i / 2 + 1] : low;
            double y_low = y_border[j / 4], y_high = j / 4 < 3 ? y_border[j / 4 + 1] : y_low;
            if (c.spacing == HF_SPACING_EQUAL_ARC)
                ck_assert_double_eq_tol(arc_m(p[0], 4.77),
                                        arc_m(low, 4.77) + (i % 2) * (arc_m(high, 4.77) - arc_m(low, 4.77)) / 2,
                                        2 * ROUNDOFF);
            else
                ck_assert_double_eq_tol(p[0], low + (i % 2) * (high - low) / 2, ROUNDOFF);
            ck_assert_double_eq_tol(p[1], y_low + (j % 4) * (y_high - y_low) / 4, ROUNDOFF);
            ck_assert_double_eq_tol(p[2], p[0] * p[0] / (4 * 4.77), ROUNDOFF);
        }
    hf_scene_free(&s);
}
END_TEST

/* Pitches that are all alike, and projected, are the net without pitches. */
START_TEST(even_pitches_change_nothing)
{
    hf_cylinder c = plain;
    c.spacing = HF_SPACING_EQUAL_PROJECTED;
    hf_scene without = generate(&c);
    c.pitches_x_m = (hf_double_list){2, {5.15, 5.15}};
    c.pitches_y_m = (hf_double_list){3, {12.7 / 3, 12.7 / 3, 12.7 / 3}};
    hf_scene with = generate(&c);
    for (int k = 0; k < 3 * with.n_node; k++)
        ck_assert_double_eq_tol(with.position_m[k], without.position_m[k], ROUNDOFF);
    hf_scene_free(&with);
    hf_scene_free(&without);
}
END_TEST

/* ---- edge ties ---- */

static const struct {
    int supports, n_tie, n_support; /* n_support: those that stay inside */
} tied[] = {
    {HF_SUPPORTS_MODULE_CORNERS, 3 * 4 - 2, 2}, /* corners: 3 x 4, two of them inside */
    {HF_SUPPORTS_RIBS, 2 * 5 + 2 * 2, 2 * 3},
    {HF_SUPPORTS_PERIMETER, 2 * (NX + NY) - 4, 0},
};

START_TEST(edge_ties_stand_outside)
{
    hf_cylinder c = plain;
    c.supports = (hf_supports)tied[_i].supports;
    c.pattern = HF_PATTERN_ALTERNATING;
    c.scallop = 0.05;
    hf_scene bare = generate(&c);
    c.edge_tie_m = 0.3;
    hf_scene s = generate(&c);
    ck_assert_int_eq(set_size(&s, "edge_tie"), tied[_i].n_tie);
    ck_assert_int_eq(s.n_node, bare.n_node + tied[_i].n_tie);
    demand_families(&s);
    int n_inside = 0;
    for (int k = 0; k < bare.n_node; k++) { /* the net is the one without ties, hanging */
        const double *p = s.position_m + 3 * (size_t)k, *p0 = bare.position_m + 3 * (size_t)k;
        ck_assert_mem_eq(p, p0, 3 * sizeof *p);
        int i, j;
        ck_assert_int_eq(sscanf(s.node_id[k], "n%d_%d", &i, &j), 2);
        int tie = node_named(&s, "s%d_%d", i, j);
        bool is_outer = i == 0 || i == NX - 1 || j == 0 || j == NY - 1;
        n_inside += s.role[k] == HF_ROLE_SUPPORT;
        ck_assert_int_eq(tie >= 0, bare.role[k] == HF_ROLE_SUPPORT && is_outer);
        if (tie < 0) {
            ck_assert_int_eq(s.role[k], bare.role[k]);
            continue;
        }
        double x = p[0] + (i == 0 ? -0.3 : i == NX - 1 ? 0.3 : 0), y = p[1] + (j == 0 ? -0.3 : j == NY - 1 ? 0.3 : 0);
        const double *end = s.position_m + 3 * (size_t)tie;
        ck_assert_double_eq_tol(end[0], x, ROUNDOFF);
        ck_assert_double_eq_tol(end[1], y, ROUNDOFF);
        ck_assert_double_eq_tol(end[2], x * x / (4 * 4.77), ROUNDOFF);
        ck_assert_int_eq(s.role[k], HF_ROLE_EDGE);
        ck_assert_int_eq(s.role[tie], HF_ROLE_SUPPORT);
        int e = cable_between(&s, tie, k);
        ck_assert_int_ge(e, 0);
        ck_assert_double_eq_tol(s.target[e], hypot(hypot(x - p[0], y - p[1]), end[2] - p[2]), ROUNDOFF);
    }
    ck_assert_int_eq(n_inside, tied[_i].n_support);
    hf_scene_free(&s);
    hf_scene_free(&bare);
}
END_TEST

/* ---- rear nets ---- */

/* Node by node: the rear net is z_edge - distance + ((a/2)^2 - x^2)/(4 f_rear), straight below or where the normal of
 * the front leads. Of each front cable there is one behind, and of each free node a tie. */
START_TEST(rear_net_stands_behind)
{
    hf_cylinder c = plain;
    c.pattern = (hf_pattern)(_i % 4);
    c.tie_direction = _i < 4 ? HF_TIES_ALONG_Z : HF_TIES_ALONG_NORMAL;
    c.scallop = 0.05;
    c.edge_tie_m = 0.2;
    hf_scene single = generate(&c);
    c.rear_distance_m = 3.1;
    c.rear_focal_length_m = 6.2;
    c.tie_law = HF_LAW_FORCE_DENSITY;
    c.tie_tension_N = 4;
    hf_scene s = generate(&c);
    int n = single.n_node, m = single.n_cable, n_free = 0;
    ck_assert_int_eq(s.n_node, 2 * n);
    ck_assert_mem_eq(s.position_m, single.position_m, 3 * (size_t)n * sizeof(double));
    for (int i = 0; i < n; i++) {
        const double *f = s.position_m + 3 * (size_t)i, *r = f + 3 * (size_t)n;
        double slope = _i < 4 ? 0 : f[0] / (2 * 4.77), edge_z = pow(10.3 / 2, 2) / (4 * 4.77);
        ck_assert_double_eq_tol(r[2], edge_z - 3.1 + (pow(10.3 / 2, 2) - r[0] * r[0]) / (4 * 6.2), 1e-12);
        ck_assert_double_eq_tol(r[0] - f[0], slope * (f[2] - r[2]), 1e-12);
        ck_assert_double_eq(r[1], f[1]);
        ck_assert_double_lt(r[2], f[2] - 0.1);
        ck_assert_int_eq(s.role[i], single.role[i]);
        ck_assert_int_eq(s.role[n + i], s.role[i] == HF_ROLE_SUPPORT ? HF_ROLE_SUPPORT : HF_ROLE_EDGE);
        bool is_plain = s.node_id[i][0] == 'n';
        ck_assert_int_eq(s.node_id[n + i][0], 'r');
        ck_assert_str_eq(s.node_id[n + i] + 1, s.node_id[i] + is_plain);
        if (s.role[i] == HF_ROLE_SUPPORT) continue;
        int e = cable_between(&s, i, n + i);
        ck_assert_int_eq(e, 2 * m + n_free++);
        ck_assert_double_eq_tol(s.target[e] * hf_scene_length_at_target(&s, e), 4, 1e-14);
    }
    ck_assert_int_eq(s.n_cable, 2 * m + n_free);
    for (int e = 0; e < m; e++) {
        for (int k = 0; k < 2; k++)
            ck_assert_int_eq(s.end[2 * (m + e) + k], s.end[2 * e + k] + n);
        ck_assert_int_eq(s.law[m + e], s.law[e]);
        ck_assert(is_in(&s, "front", e) && is_in(&s, "rear", m + e));
        ck_assert(is_in(&s, "edge", e) == is_in(&single, "edge", e));
        ck_assert(is_in(&s, "edge", e) == is_in(&s, "rear_edge", m + e));
    }
    ck_assert_int_eq(set_size(&s, "tie"), n_free);
    ck_assert_int_eq(set_size(&s, "rear_edge_tie"), set_size(&single, "edge_tie"));
    hf_scene_free(&single);
    hf_scene_free(&s);
}
END_TEST

START_TEST(rear_nets_that_cannot_be_are_refused)
{
    char what[HF_GENERATE_FAULT_SIZE];
    hf_messages messages = {0};
    hf_scene s;
    hf_cylinder c = plain;
    c.rear_distance_m = 2.78; /* 5.15^2/(2 f) = 2.7801 */
    ck_assert_str_eq(hf_scene_parabolic_cylinder_fault(&c, what, sizeof what), "rear_distance_m");
    ck_assert_str_eq(what,
                     "of 2.78 m lets the nets meet in the middle, where they come 2.78014 m nearer than at the rim");
    c.rear_distance_m = 2.781;
    ck_assert_ptr_null(hf_scene_parabolic_cylinder_fault(&c, what, sizeof what));
    c.tie_law = HF_LAW_ELASTIC;
    ck_assert_int_eq(hf_scene_parabolic_cylinder(&c, NULL, &s, &messages), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "parabolic_cylinder.tie_law: the law elastic needs the stiffness"));
    hf_messages_free(&messages);
    c.tie_direction = HF_TIES_ALONG_NORMAL; /* on so deep a net the normal runs beside the falling rear net */
    c.focal_length_m = 1;
    c.rear_distance_m = 20;
    ck_assert_str_eq(hf_scene_parabolic_cylinder_fault(&c, what, sizeof what), "tie_direction");
}
END_TEST

/* ---- symmetry ---- */

static const struct {
    int pattern, planes;
    hf_double_list pitches_x_m, pitches_y_m;
} mirrored[] = {
    {HF_PATTERN_QUAD, HF_PLANE_X | HF_PLANE_Y, {0}, {0}},
    {HF_PATTERN_TRIANGLE, 0, {0}, {0}},
    {HF_PATTERN_ALTERNATING, HF_PLANE_X | HF_PLANE_Y, {0}, {0}}, /* even numbers of cells: 4 and 12 */
    {HF_PATTERN_DIAGONAL, HF_PLANE_X | HF_PLANE_Y, {0}, {0}},
    {HF_PATTERN_DIAGONAL, HF_PLANE_Y, {2, {4.1, 6.2}}, {3, {3.3, 6.1, 3.3}}},
    {HF_PATTERN_ALTERNATING, HF_PLANE_X, {2, {5.15, 5.15}}, {3, {3.2, 5.5, 4}}},
};

START_TEST(mirror_planes_are_found)
{
    struct net net = {.form = tight_form(HF_METHOD_NEWTON)};
    hf_messages messages = {0};
    hf_cylinder c = plain;
    int planes;
    c.pattern = (hf_pattern)mirrored[_i].pattern;
    c.pitches_x_m = mirrored[_i].pitches_x_m;
    c.pitches_y_m = mirrored[_i].pitches_y_m;
    c.scallop = 0.05;
    c.edge_tie_m = 0.2;
    net.scene = generate(&c);
    open_net(&net);
    ck_assert_int_eq(hf_symmetry_apply(&net.scene, &(hf_optimize_settings){.symmetry = HF_SYMMETRY_AUTO}, &net.model,
                                       &planes, &messages),
                     HF_OK);
    ck_assert_int_eq(planes, mirrored[_i].planes);
    close_net(&net);
}
END_TEST

/* ---- what cannot be made ---- */

static const struct {
    hf_cylinder c; /* 0: as `plain` has it */
    const char *key, *what;
} impossible[] = {
    {{.pitches_x_m = {3, {4, 4, 2.3}}},
     "pitches_x_m",
     "must have a value for each of the 2 modules along x, and has 3"},
    {{.pitches_x_m = {2, {4, 6.2}}}, "pitches_x_m", "must add up to aperture_m, 10.3 m, and do to 10.2 m"},
    {{.pitches_y_m = {3, {3, 5, 4.8}}}, "pitches_y_m", "must add up to length_m, 12.7 m, and do to 12.8 m"},
    {{.edge_tie_m = 3, .pitches_y_m = {3, {3, 5, 4.7}}},
     "edge_tie_m",
     "of 3 m must be shorter than the smallest module, 3 m"},
    /* along x: chords of hypot(5.15, 5.15^2/19.08) = 5.334 m, 12.7/12 m to the next row */
    {{.scallop = 0.2}, "scallop", "of 0.2 moves edge nodes by 1.067 m, past the next nodes 1.058 m inward; lower it"},
    {{.scallop = 0.2, .pattern = HF_PATTERN_DIAGONAL},
     "scallop",
     "of 0.2 moves edge nodes by 1.067 m, past the next nodes 0.5292 m inward; lower it"},
    /* one cell of 6.35 m across: scallops of 3.2 m from both sides meet */
    {{.scallop = 0.32, .modules = {1, 1}, .cells_per_module = {2, 1}, .length_m = 6.35},
     "scallop",
     "of 0.32 moves edge nodes by 3.296 m, past the middle of the net 3.175 m inward; lower it"},
};
enum { N_IMPOSSIBLE = sizeof impossible / sizeof *impossible };

START_TEST(the_impossible_is_named)
{
    hf_cylinder c = plain;
    const hf_cylinder *wanted = &impossible[_i].c;
    hf_messages messages = {0};
    hf_scene s;
    char what[HF_GENERATE_FAULT_SIZE], said[400];
    c.pitches_x_m = wanted->pitches_x_m;
    c.pitches_y_m = wanted->pitches_y_m;
    c.pattern = wanted->pattern;
    c.scallop = wanted->scallop;
    c.edge_tie_m = wanted->edge_tie_m;
    if (wanted->length_m > 0) c.length_m = wanted->length_m;
    for (int k = 0; k < 2 && wanted->modules[0] > 0; k++) {
        c.modules[k] = wanted->modules[k];
        c.cells_per_module[k] = wanted->cells_per_module[k];
    }
    const char *key = hf_scene_parabolic_cylinder_fault(&c, what, sizeof what);
    ck_assert_ptr_nonnull(key);
    ck_assert_str_eq(key, impossible[_i].key);
    ck_assert_str_eq(what, impossible[_i].what);
    ck_assert_int_eq(hf_scene_parabolic_cylinder(&c, NULL, &s, &messages), HF_BAD_CASE);
    snprintf(said, sizeof said, "error: scene.parabolic_cylinder.%s: %s\n", key, what);
    ck_assert_str_eq(messages.text, said);
    hf_messages_free(&messages);
    hf_scene_free(&s);
}
END_TEST

/* At the very edge of what is refused, edge nodes are still in order: those of scallops just below the limit. */
START_TEST(what_is_made_does_not_cross)
{
    static const int pattern[] = {HF_PATTERN_ALTERNATING, HF_PATTERN_DIAGONAL};
    hf_cylinder c = plain;
    char what[HF_GENERATE_FAULT_SIZE];
    double low = 0, high = 0.4;
    c.pattern = (hf_pattern)pattern[_i];
    for (int k = 0; k < 30; k++) {
        c.scallop = (low + high) / 2;
        *(hf_scene_parabolic_cylinder_fault(&c, what, sizeof what) ? &high : &low) = c.scallop;
    }
    c.scallop = low;
    hf_scene s = generate(&c);
    const char *next = _i ? "m%d_%d" : "n%d_%d";
    double least = INFINITY;
    for (int i = 1; i + 1 < NX; i++) {
        const double *edge = s.position_m + 3 * (size_t)node_named(&s, "n%d_%d", i, 0);
        least = fmin(least, s.position_m[3 * (size_t)node_named(&s, next, i, !_i) + 1] - edge[1]);
    }
    ck_assert_double_gt(least, 0);
    ck_assert_double_lt(least, 1e-8); /* 30 halvings of 0.4, spans of 5.3 m */
    hf_scene_free(&s);
}
END_TEST

Suite *suite_unit_scene_patterns(void)
{
    Suite *suite = suite_create("unit/scene_patterns");
    TCase *tests = tcase_create("scene_patterns");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, rear_net_stands_behind, 0, 8);
    tcase_add_test(tests, rear_nets_that_cannot_be_are_refused);
    tcase_add_loop_test(tests, patterns_are_as_counted, 0, N_COUNTS);
    tcase_add_loop_test(tests, diagonals_run_as_said, 0, 2);
    tcase_add_loop_test(tests, middles_of_cells, 0, 2);
    tcase_add_loop_test(tests, pitches_place_the_borders, 0, 2);
    tcase_add_test(tests, even_pitches_change_nothing);
    tcase_add_loop_test(tests, edge_ties_stand_outside, 0, sizeof tied / sizeof *tied);
    tcase_add_loop_test(tests, mirror_planes_are_found, 0, sizeof mirrored / sizeof *mirrored);
    tcase_add_loop_test(tests, the_impossible_is_named, 0, N_IMPOSSIBLE);
    tcase_add_loop_test(tests, what_is_made_does_not_cross, 0, 2);
    return suite;
}
