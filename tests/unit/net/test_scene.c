/* The generator of the parabolic cylinder. */
#include "nets.h"

#include <float.h>

/* 2 x 3 modules of 2 x 2 cells: 5 x 7 nodes. Numbers that are no round binary fractions. */
static const hf_cylinder plain = {.aperture_m = 10.3,
                                  .length_m = 12.7,
                                  .focal_length_m = 4.77,
                                  .modules = {2, 3},
                                  .cells_per_module = {2, 2},
                                  .spacing = HF_SPACING_EQUAL_ARC,
                                  .boundary = HF_BOUNDARY_OUTER_EDGE,
                                  .scallop = 0,
                                  .supports = HF_SUPPORTS_MODULE_CORNERS};
enum { NX = 5, NY = 7 };

static hf_scene generate(const hf_cylinder *cylinder)
{
    hf_messages messages = {0};
    hf_scene scene;
    ck_assert_msg(hf_scene_parabolic_cylinder(cylinder, NULL, &scene, &messages) == HF_OK, "%s", messages.text);
    ck_assert_ptr_null(messages.text);
    return scene;
}

static const double *at(const hf_scene *s, int i, int j)
{
    return s->position_m + 3 * (j * NX + i);
}

/* Arc length of the parabola between two x by Simpson's rule, 1000 intervals: error below 1e-13 here. */
static double arc_m(double x0, double x1, double focal)
{
    int n = 1000;
    double sum = 0, h = (x1 - x0) / n;
    for (int k = 0; k <= n; k++) {
        double slope = (x0 + k * h) / (2 * focal);
        sum += (k == 0 || k == n ? 1 : k % 2 ? 4 : 2) * sqrt(1 + slope * slope);
    }
    return sum * h / 3;
}

/* Roundoff of a few operations on numbers of size 10. */
#define ROUNDOFF (16 * 10 * DBL_EPSILON)

START_TEST(nodes_lie_on_the_cylinder)
{
    hf_cylinder c = plain;
    c.spacing = (hf_spacing)_i;
    hf_scene s = generate(&c);
    ck_assert_int_eq(s.n_node, NX * NY);
    for (int j = 0; j < NY; j++)
        for (int i = 0; i < NX; i++) {
            const double *p = at(&s, i, j), *mirror = at(&s, NX - 1 - i, j);
            ck_assert_double_eq_tol(p[2], p[0] * p[0] / (4 * 4.77), ROUNDOFF);
            ck_assert_double_eq_tol(p[1], 12.7 * j / 6, ROUNDOFF);
            ck_assert_double_eq(p[0], -mirror[0]); /* to the last bit */
            ck_assert_double_eq(p[2], mirror[2]);
        }
    ck_assert_double_eq(at(&s, 0, 0)[0], -5.15);
    ck_assert_double_eq(at(&s, NX - 1, 0)[0], 5.15);
    hf_scene_free(&s);
}
END_TEST

START_TEST(arc_or_projection_is_equal)
{
    hf_cylinder c = plain;
    hf_scene s = generate(&c);
    for (int i = 0; i + 1 < NX; i++) /* Newton of the generator and Simpson's rule: both to roundoff */
        ck_assert_double_eq_tol(arc_m(at(&s, i, 3)[0], at(&s, i + 1, 3)[0], 4.77), arc_m(-5.15, 5.15, 4.77) / 4, 1e-12);
    hf_scene_free(&s);
    c.spacing = HF_SPACING_EQUAL_PROJECTED;
    s = generate(&c);
    for (int i = 0; i < NX; i++)
        ck_assert_double_eq_tol(at(&s, i, 3)[0], -5.15 + i * 10.3 / 4, ROUNDOFF);
    hf_scene_free(&s);
}
END_TEST

/* The flatter the parabola, the nearer the two spacings: no cancellation spoils a nearly flat one. */
START_TEST(a_flat_reflector_is_flat)
{
    hf_cylinder c = plain;
    c.focal_length_m = 1e8;
    hf_scene s = generate(&c);
    for (int i = 0; i < NX; i++)
        ck_assert_double_eq_tol(at(&s, i, 0)[0], -5.15 + i * 10.3 / 4, ROUNDOFF);
    hf_scene_free(&s);
}
END_TEST

/* Counted by hand on paper for 5 x 7 nodes. */
static const struct {
    int supports, boundary, n_support, n_edge, n_inner, n_boundary_cable;
} counts[] = {
    {HF_SUPPORTS_MODULE_CORNERS, HF_BOUNDARY_OUTER_EDGE, 12, 10, 13, 20},
    {HF_SUPPORTS_MODULE_CORNERS, HF_BOUNDARY_MODULE_EDGES, 12, 17, 6, 34},
    {HF_SUPPORTS_RIBS, HF_BOUNDARY_OUTER_EDGE, 20, 6, 9, 20},
    {HF_SUPPORTS_RIBS, HF_BOUNDARY_MODULE_EDGES, 20, 9, 6, 34},
    {HF_SUPPORTS_PERIMETER, HF_BOUNDARY_OUTER_EDGE, 20, 0, 15, 20},
    {HF_SUPPORTS_PERIMETER, HF_BOUNDARY_MODULE_EDGES, 20, 9, 6, 34},
};
enum { N_COUNTS = sizeof counts / sizeof *counts };

START_TEST(roles_and_groups_are_as_counted)
{
    hf_cylinder c = plain;
    c.supports = (hf_supports)counts[_i].supports;
    c.boundary = (hf_boundary)counts[_i].boundary;
    hf_scene s = generate(&c);
    int n_role[3] = {0}, n_group[2] = {0};
    hf_messages messages = {0};
    ck_assert_msg(hf_scene_check(&s, &messages) == HF_OK, "%s", messages.text);
    for (int k = 0; k < s.n_node; k++)
        n_role[s.role[k]]++;
    for (int e = 0; e < s.n_cable; e++) {
        n_group[s.group[e]]++;
        int is_boundary = s.group[e] == HF_GROUP_BOUNDARY;
        ck_assert_int_eq(s.law[e], is_boundary ? HF_LAW_LENGTH : HF_LAW_TENSION);
        if (is_boundary)
            ck_assert_double_eq(s.target[e], hf_scene_length_at_target(&s, e));
        else
            ck_assert_double_nan(s.target[e]);
    }
    ck_assert_int_eq(n_role[HF_ROLE_SUPPORT], counts[_i].n_support);
    ck_assert_int_eq(n_role[HF_ROLE_EDGE], counts[_i].n_edge);
    ck_assert_int_eq(n_role[HF_ROLE_INNER], counts[_i].n_inner);
    ck_assert_int_eq(n_group[HF_GROUP_BOUNDARY], counts[_i].n_boundary_cable);
    ck_assert_int_eq(s.n_cable, 4 * 7 + 5 * 6);
    hf_scene_free(&s);
}
END_TEST

/* One node of each kind, so that right counts in wrong places show; 2 x 3 cells, so that x and y are told apart. */
START_TEST(roles_are_in_the_right_places)
{
    static const struct {
        int supports, i, j, role;
    } place[] = {
        {HF_SUPPORTS_MODULE_CORNERS, 2, 3, HF_ROLE_SUPPORT},
        {HF_SUPPORTS_MODULE_CORNERS, 1, 3, HF_ROLE_EDGE},
        {HF_SUPPORTS_MODULE_CORNERS, 2, 4, HF_ROLE_EDGE},
        {HF_SUPPORTS_MODULE_CORNERS, 3, 4, HF_ROLE_INNER},
        {HF_SUPPORTS_RIBS, 1, 3, HF_ROLE_SUPPORT},
        {HF_SUPPORTS_RIBS, 2, 4, HF_ROLE_EDGE},
        {HF_SUPPORTS_RIBS, 1, 4, HF_ROLE_INNER},
        {HF_SUPPORTS_PERIMETER, 0, 4, HF_ROLE_SUPPORT},
        {HF_SUPPORTS_PERIMETER, 2, 2, HF_ROLE_EDGE},
        {HF_SUPPORTS_PERIMETER, 1, 2, HF_ROLE_INNER},
    };
    hf_cylinder c = plain;
    c.boundary = HF_BOUNDARY_MODULE_EDGES;
    c.modules[1] = 2, c.cells_per_module[1] = 3;
    for (size_t k = 0; k < sizeof place / sizeof *place; k++) {
        c.supports = (hf_supports)place[k].supports;
        hf_scene s = generate(&c);
        ck_assert_int_eq(s.role[place[k].j * NX + place[k].i], place[k].role);
        hf_scene_free(&s);
    }
}
END_TEST

START_TEST(ids_name_grid_places)
{
    hf_scene s = generate(&plain);
    ck_assert_str_eq(s.node_id[3 * NX + 2], "n2_3");
    int found = 0;
    for (int e = 0; e < s.n_cable; e++) {
        const int *end = s.end + 2 * e;
        char name[64];
        snprintf(name, sizeof name, "%s-%s", s.node_id[end[0]], s.node_id[end[1]]);
        ck_assert_str_eq(s.cable_id[e], name);
        ck_assert(end[1] - end[0] == 1 || end[1] - end[0] == NX); /* neighbours along x or y */
        found += !strcmp(s.cable_id[e], "n2_3-n2_4");
    }
    ck_assert_int_eq(found, 1);
    hf_scene_free(&s);
}
END_TEST

/* METHOD section 3 (M4): a free edge node at fraction t between its supports is moved inward by 4 s span t (1-t). */
START_TEST(scallop_follows_its_formula)
{
    hf_cylinder c = plain;
    c.cells_per_module[0] = c.cells_per_module[1] = 3; /* so that t is 1/3, 2/3 and not only 1/2 */
    hf_scene flat = generate(&c);
    c.scallop = 0.137;
    hf_scene s = generate(&c);
    int nx = 7, ny = 10;
    double factor = 4 * 0.137 * (1.0 / 3) * (2.0 / 3), x3 = flat.position_m[3 * 3], x0 = flat.position_m[0];
    double chord = hypot(x3 - x0, flat.position_m[3 * 3 + 2] - flat.position_m[2]), rib = 12.7 / 3;
    for (int k = 0; k < s.n_node; k++) {
        const double *p = s.position_m + 3 * k, *p0 = flat.position_m + 3 * k;
        int i = k % nx, j = k / nx;
        double dx = 0, dy = 0;
        if (i % 3 && (j == 0 || j == ny - 1)) dy = (j == 0 ? 1 : -1) * factor * chord;
        if (j % 3 && (i == 0 || i == nx - 1)) dx = (i == 0 ? 1 : -1) * factor * rib;
        ck_assert_double_eq_tol(p[0] - p0[0], dx, ROUNDOFF);
        ck_assert_double_eq_tol(p[1] - p0[1], dy, ROUNDOFF);
        ck_assert_double_eq_tol(p[2], p[0] * p[0] / (4 * 4.77), ROUNDOFF);
    }
    hf_scene_free(&s);
    hf_scene_free(&flat);
}
END_TEST

START_TEST(too_many_nodes_are_refused)
{
    hf_messages messages = {0};
    hf_cylinder c = plain;
    hf_scene s;
    c.modules[0] = c.modules[1] = c.cells_per_module[0] = c.cells_per_module[1] = 2000;
    ck_assert_int_eq(hf_scene_parabolic_cylinder(&c, NULL, &s, &messages), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "4000001 x 4000001 nodes"));
    hf_messages_free(&messages);
    hf_scene_free(&s);
}
END_TEST

Suite *suite_unit_scene(void)
{
    Suite *suite = suite_create("unit/scene");
    TCase *tests = tcase_create("scene");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, nodes_lie_on_the_cylinder, 0, 2);
    tcase_add_test(tests, arc_or_projection_is_equal);
    tcase_add_test(tests, a_flat_reflector_is_flat);
    tcase_add_loop_test(tests, roles_and_groups_are_as_counted, 0, N_COUNTS);
    tcase_add_test(tests, roles_are_in_the_right_places);
    tcase_add_test(tests, ids_name_grid_places);
    tcase_add_test(tests, scallop_follows_its_formula);
    tcase_add_test(tests, too_many_nodes_are_refused);
    return suite;
}
