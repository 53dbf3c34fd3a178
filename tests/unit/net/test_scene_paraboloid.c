/* Nets over a paraboloid, alone and tied to a rear net, against counts and geometry of the test's own. */
#include "nets.h"

#include "solve/prestress.h"
#include <hifdm/cable_set.h>
#include <hifdm/evaluate.h>
#include <hifdm/facets.h>

static const hf_paraboloid centre_fed = {.aperture_m = 6.1,
                                         .focal_length_m = 2.9,
                                         .rings = 5,
                                         .rear_distance_m = 2,
                                         .tie_law = HF_LAW_LENGTH,
                                         .tie_tension_N = 1};
static const hf_paraboloid offset_fed = {.aperture_m = 12.2,
                                         .focal_length_m = 9.1,
                                         .offset_m = 8.3,
                                         .rings = 4,
                                         .rear_distance_m = 3,
                                         .rear_focal_length_m = 12,
                                         .tie_law = HF_LAW_LENGTH,
                                         .tie_tension_N = 1};

/* ---- helpers ---- */

static hf_scene generate(const hf_paraboloid *p, const double EA_N[2])
{
    hf_messages messages = {0};
    hf_scene scene;
    ck_assert_msg(hf_scene_paraboloid(p, EA_N, &scene, &messages) == HF_OK, "%s", messages.text);
    ck_assert_msg(hf_scene_check(&scene, &messages) == HF_OK, "%s", messages.text);
    return scene;
}

static int size_of(const hf_scene *s, const char *set)
{
    int k = hf_cable_set_find(s, set);
    return k < 0 ? 0 : s->set_start[k + 1] - s->set_start[k];
}

static int count_role(const hf_scene *s, hf_role role)
{
    int n = 0;
    for (int i = 0; i < s->n_node; i++)
        n += s->role[i] == role;
    return n;
}

/* Radius about the middle of the aperture. */
static double radius_of(const hf_paraboloid *p, const double *x)
{
    return hypot(x[0] - p->offset_m, x[1]);
}

/* ---- counts ---- */

/* Rings of 6k nodes: 1 + 3 n (n + 1) nodes and 9 n^2 - 3 n cables, of which those to the 6n supports are the edge: two
 * from each of the 6 (n - 1) nodes of the last free ring and a third from its corners. */
START_TEST(triangles_are_counted)
{
    for (int n = 2; n < 9; n++) {
        hf_paraboloid p = centre_fed;
        p.rings = n;
        hf_scene s = generate(&p, NULL);
        int edge = 12 * (n - 1) + 6, all = 9 * n * n - 3 * n, inner = 1 + 3 * n * (n - 1);
        ck_assert_int_eq(s.n_node, 2 * (1 + 3 * n * (n + 1)));
        ck_assert_int_eq(s.n_cable, 2 * all + inner);
        ck_assert_int_eq(count_role(&s, HF_ROLE_SUPPORT), 12 * n);
        ck_assert_int_eq(count_role(&s, HF_ROLE_INNER), inner);
        ck_assert_int_eq(size_of(&s, "front_edge"), edge);
        ck_assert_int_eq(size_of(&s, "rear"), all - edge);
        ck_assert_int_eq(size_of(&s, "tie"), inner);
        hf_scene_free(&s);
    }
}
END_TEST

/* Five cells to the rim: rows and columns 3 and 4 end in the same supports, since 3^2 + 4^2 = 5^2. */
START_TEST(quads_are_counted)
{
    hf_paraboloid p = centre_fed;
    p.grid = HF_GRID_QUAD;
    p.rear_distance_m = 0;
    hf_scene s = generate(&p, NULL);
    int degree[512] = {0}, n_inner = 0;
    ck_assert_int_eq(s.n_set, 2);
    ck_assert_int_eq(count_role(&s, HF_ROLE_SUPPORT), 4 * 9 - 8);
    for (int k = 0; k < 2 * s.n_cable; k++)
        degree[s.end[k]]++;
    for (int i = 0; i < s.n_node; i++) {
        double r = hypot(s.position_m[3 * i], s.position_m[3 * i + 1]);
        n_inner += s.role[i] == HF_ROLE_INNER;
        if (s.role[i] == HF_ROLE_INNER)
            ck_assert_int_eq(degree[i], 4);
        else
            ck_assert_double_eq_tol(r, 3.05, 1e-14);
    }
    int inside = 0; /* points of the lattice within 4.75 cells */
    for (int i = -5; i <= 5; i++)
        for (int j = -5; j <= 5; j++)
            inside += hypot(i, j) < 4.75;
    ck_assert_int_eq(n_inner, inside);
    hf_scene_free(&s);
}
END_TEST

/* ---- geometry ---- */

/* Front nodes are on the paraboloid. The rear net has its rim 3 m below, and its vertex R^2/(4 f_rear) above that. */
START_TEST(nodes_are_on_their_surfaces)
{
    const hf_paraboloid *p = &offset_fed;
    hf_scene s = generate(p, NULL);
    double R = p->aperture_m / 2;
    int n = s.n_node / 2;
    for (int i = 0; i < n; i++) {
        const double *f = s.position_m + 3 * (size_t)i, *r = f + 3 * (size_t)n;
        ck_assert_double_eq_tol(f[2], (f[0] * f[0] + f[1] * f[1]) / (4 * 9.1), 1e-13);
        if (s.role[i] == HF_ROLE_SUPPORT) {
            ck_assert_double_eq_tol(radius_of(p, f), R, 1e-13);
            ck_assert_double_eq_tol(f[2], (R * R - 8.3 * 8.3 + 2 * 8.3 * f[0]) / (4 * 9.1), 1e-13); /* a plane */
        }
        ck_assert_double_eq_tol(r[0], f[0], 1e-14);
        ck_assert_double_eq_tol(r[1], f[1], 1e-14);
        double rim_z = (R * R - 8.3 * 8.3 + 2 * 8.3 * r[0]) / (4 * 9.1) - 3, inside = R * R - pow(radius_of(p, r), 2);
        ck_assert_double_eq_tol(r[2], rim_z + inside / (4 * 12), 1e-13);
        ck_assert_double_lt(r[2], f[2]);
    }
    hf_scene_free(&s);
}
END_TEST

/* Turned by 60 degrees, the net about the axis is the same. */
START_TEST(net_has_six_sides)
{
    hf_paraboloid p = centre_fed;
    p.spacing = _i ? HF_SPACING_EQUAL_ARC : HF_SPACING_EQUAL_PROJECTED;
    hf_scene s = generate(&p, NULL);
    for (int i = 0; i < s.n_node; i++) {
        const double *a = s.position_m + 3 * (size_t)i;
        double x = a[0] / 2 - a[1] * sqrt(0.75), y = a[0] * sqrt(0.75) + a[1] / 2, nearest = INFINITY;
        for (int k = 0; k < s.n_node; k++) {
            const double *b = s.position_m + 3 * (size_t)k;
            nearest = fmin(nearest, fmax(fabs(b[2] - a[2]), hypot(b[0] - x, b[1] - y)));
        }
        ck_assert_double_le(nearest, 1e-13);
    }
    hf_scene_free(&s);
}
END_TEST

/* Length of the meridian from the axis to this radius, by Simpson's rule. */
static double arc_to(double radius, double focal_length)
{
    double h = radius / 2000, arc = 0;
    for (int k = 0; k <= 2000; k++)
        arc += h / 3 * (k % 2000 == 0 ? 1 : k % 2 ? 4 : 2) * hypot(1, k * h / (2 * focal_length));
    return arc;
}

/* Equal arcs: a node stands at the part of the meridian that is its part of the radius with equal projected spacing. */
START_TEST(arcs_are_equal)
{
    hf_paraboloid p = centre_fed;
    p.grid = (hf_grid)_i;
    p.spacing = HF_SPACING_EQUAL_PROJECTED;
    hf_scene projected = generate(&p, NULL);
    p.spacing = HF_SPACING_EQUAL_ARC;
    hf_scene s = generate(&p, NULL);
    for (int i = 0; i < s.n_node / 2; i++) {
        double part = radius_of(&p, projected.position_m + 3 * (size_t)i) / 3.05;
        double arc = arc_to(radius_of(&p, s.position_m + 3 * (size_t)i), 2.9);
        ck_assert_double_eq_tol(arc, part * arc_to(3.05, 2.9), 1e-11);
    }
    hf_scene_free(&projected);
    hf_scene_free(&s);
}
END_TEST

/* Triangles fill the aperture with cells that widen gradually: neighbours along a cable differ little, and their error
 * is near that of equal-sided triangles of the same mean side, l^2/(16 sqrt(15) f) by METHOD section 9. */
START_TEST(cells_widen_gradually)
{
    static const int rings[] = {4, 8, 20};
    hf_messages messages = {0};
    hf_paraboloid p = centre_fed;
    hf_surface_settings surface = {.kind = HF_SURFACE_PARABOLOID, .focal_length_m = p.focal_length_m};
    hf_facets facets;
    p.rings = rings[_i];
    p.spacing = HF_SPACING_EQUAL_PROJECTED;
    p.rear_distance_m = 0;
    hf_scene s = generate(&p, NULL);
    ck_assert_int_eq(hf_facets_find(&s, &surface, &facets), HF_OK);
    ck_assert_int_eq(facets.n_facet, 6 * p.rings * p.rings); /* those at the rim, too, where no cable runs */
    ck_assert_int_eq(facets.n_open, 0);
    double area = 0, mean = 0, square = 0, side = 0;
    for (int k = 0; k < facets.n_facet; k++) {
        const int *c = facets.corner + 4 * (size_t)k;
        const double *x[3] = {s.position_m + 3 * (size_t)c[0], s.position_m + 3 * (size_t)c[1],
                              s.position_m + 3 * (size_t)c[2]};
        double l2[3], sum = 0, cross = 0;
        double twice = (x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) - (x[1][1] - x[0][1]) * (x[2][0] - x[0][0]);
        ck_assert_double_gt(twice, 0);
        for (int e = 0; e < 3; e++) {
            l2[e] = pow(x[e][0] - x[(e + 1) % 3][0], 2) + pow(x[e][1] - x[(e + 1) % 3][1], 2);
            side += sqrt(l2[e]) / (3 * facets.n_facet);
        }
        for (int e = 0; e < 3; e++) {
            sum += l2[e];
            cross += l2[e] * l2[e] + l2[e] * l2[(e + 1) % 3];
        }
        area += twice; /* dz is the sum of the products of two barycentric coordinates and l^2 between them, over 4 f */
        mean += twice * sum / 12 / (4 * p.focal_length_m);
        square += twice * cross / 90 / pow(4 * p.focal_length_m, 2);
    }
    double rms = sqrt(square / area - pow(mean / area, 2)), ideal = side * side / (16 * sqrt(15) * p.focal_length_m);
    ck_assert_double_eq_tol(area / 2, 3 * p.rings * 3.05 * 3.05 * sin(acos(-1) / (3 * p.rings)), 1e-12);
    ck_assert_double_lt(rms, 1.08 * ideal);
    ck_assert_double_gt(rms, 1.05 * ideal);
    ck_assert_ptr_null(messages.text);
    hf_facets_free(&facets);
    hf_scene_free(&s);
}
END_TEST

/* Ties along the normal of the front net: across both tangents, and on the rear surface at their other end. */
START_TEST(ties_along_the_normal)
{
    hf_paraboloid p = offset_fed;
    p.focal_length_m = 18;
    p.tie_direction = HF_TIES_ALONG_NORMAL;
    hf_scene s = generate(&p, NULL);
    double R = p.aperture_m / 2;
    int n = s.n_node / 2, moved = 0;
    for (int i = 0; i < n; i++) {
        const double *f = s.position_m + 3 * (size_t)i, *r = f + 3 * (size_t)n;
        if (s.role[i] == HF_ROLE_SUPPORT) continue;
        double d[3] = {r[0] - f[0], r[1] - f[1], r[2] - f[2]};
        ck_assert_double_eq_tol(d[0] + d[2] * f[0] / (2 * 18), 0, 1e-12);
        ck_assert_double_eq_tol(d[1] + d[2] * f[1] / (2 * 18), 0, 1e-12);
        ck_assert_double_lt(d[2], 0);
        double rim_z = (R * R - 8.3 * 8.3 + 2 * 8.3 * r[0]) / (4 * 18) - 3, inside = R * R - pow(radius_of(&p, r), 2);
        ck_assert_double_eq_tol(r[2], rim_z + inside / (4 * 12), 1e-12);
        moved += hypot(d[0], d[1]) > 0.1;
    }
    ck_assert_int_gt(moved, n / 2);
    hf_scene_free(&s);
}
END_TEST

/* ---- ties and tensions ---- */

/* Whatever its law, a tie has its tension at the theoretical length. */
START_TEST(ties_have_their_tension)
{
    static const double EA_N[2] = {2e5, 3e5};
    hf_paraboloid p = centre_fed;
    p.tie_law = (hf_law)_i;
    p.tie_tension_N = 7;
    hf_scene s = generate(&p, EA_N);
    int k = hf_cable_set_find(&s, "tie");
    for (int i = s.set_start[k]; i < s.set_start[k + 1]; i++) {
        int e = s.set_cable[i];
        double length = hf_scene_length_at_target(&s, e);
        ck_assert_int_eq(s.law[e], _i);
        if (_i == HF_LAW_TENSION) ck_assert_double_eq(s.target[e], 7);
        if (_i == HF_LAW_LENGTH) ck_assert_double_eq(s.target[e], length);
        if (_i == HF_LAW_FORCE_DENSITY) ck_assert_double_eq_tol(s.target[e] * length, 7, 1e-14);
        if (_i == HF_LAW_ELASTIC) ck_assert_double_eq_tol(2e5 * (length / s.target[e] - 1), 7, 1e-9);
    }
    hf_scene_free(&s);
}
END_TEST

/* Exact prestress holds all of them: centre-fed and offset, triangles and quads, ties along z and the normal (which a
 * quad net does not allow: five tensions, six equations). */
START_TEST(net_is_held_on_the_paraboloid)
{
    hf_messages messages = {0};
    hf_paraboloid p = _i % 2 ? offset_fed : centre_fed;
    p.grid = _i / 2 == 1 ? HF_GRID_QUAD : HF_GRID_TRIANGLE;
    p.tie_direction = _i / 2 == 2 ? HF_TIES_ALONG_NORMAL : HF_TIES_ALONG_Z;
    if (_i / 2 == 2) p.focal_length_m *= 3; /* on deep dishes the corners of the rear net would have to be pushed */
    struct net net = {.form = tight_form(HF_METHOD_AUTO), .scene = generate(&p, NULL)};
    ck_assert_msg(hf_prestress_hold(&net.scene, &net.form, NULL, &messages) == HF_OK, "%s", messages.text);
    open_net(&net);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_double_le(net.result.psi_m, 1e-12);
    ck_assert_int_eq(net.result.n_slack, 0);
    close_net(&net);
}
END_TEST

/* ---- what cannot be made ---- */

START_TEST(nets_that_would_meet_are_refused)
{
    hf_messages messages = {0};
    hf_paraboloid p = centre_fed;
    hf_scene s;
    p.rear_distance_m = 3.05 * 3.05 / (2 * 2.9);
    ck_assert_int_eq(hf_scene_paraboloid(&p, NULL, &s, &messages), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "scene.paraboloid.rear_distance_m: of 1.60388 m lets the nets meet"));
    hf_messages_free(&messages);
    p.tie_direction = HF_TIES_ALONG_NORMAL;
    p.rear_distance_m *= 1.001;
    p.focal_length_m = 2.9;
    p.rings = 30;
    ck_assert_int_eq(hf_scene_paraboloid(&p, NULL, &s, &messages), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "scene.paraboloid.tie_direction: normal leads to places outside the "));
    hf_messages_free(&messages);
    p.tie_direction = HF_TIES_ALONG_Z;
    s = generate(&p, NULL);
    hf_scene_free(&s);
    p = centre_fed; /* the corners of the grid are nearer to the rim than other nodes */
    p.tie_direction = HF_TIES_ALONG_NORMAL;
    p.focal_length_m = 4.5;
    ck_assert_ptr_null(hf_scene_paraboloid_fault(&p, (char[HF_GENERATE_FAULT_SIZE]){0}, HF_GENERATE_FAULT_SIZE));
    ck_assert_int_eq(hf_scene_paraboloid(&p, NULL, &s, &messages), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "scene.paraboloid.tie_direction: normal leads to places outside the "));
    hf_scene_free(&s);
    hf_messages_free(&messages);
    p.rings = 1000;
    ck_assert_int_eq(hf_scene_paraboloid(&p, NULL, &s, &messages), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "a net with 1000 rings has more nodes than the maximum"));
    hf_messages_free(&messages);
}
END_TEST

Suite *suite_unit_scene_paraboloid(void)
{
    Suite *suite = suite_create("unit/net/scene_paraboloid");
    TCase *tests = tcase_create("paraboloid");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, triangles_are_counted);
    tcase_add_test(tests, quads_are_counted);
    tcase_add_test(tests, nodes_are_on_their_surfaces);
    tcase_add_loop_test(tests, net_has_six_sides, 0, 2);
    tcase_add_loop_test(tests, arcs_are_equal, 0, 2);
    tcase_add_loop_test(tests, cells_widen_gradually, 0, 3);
    tcase_add_test(tests, ties_along_the_normal);
    tcase_add_loop_test(tests, ties_have_their_tension, 0, HF_N_LAW);
    tcase_add_loop_test(tests, net_is_held_on_the_paraboloid, 0, 6);
    tcase_add_test(tests, nets_that_would_meet_are_refused);
    return suite;
}
