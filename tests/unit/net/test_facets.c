/* Facets of small nets drawn by hand: which faces are found, and which are left out. */
#include "nets.h"

#include <hifdm/facets.h>

enum { SHALLOW_M = 1000 };
static const hf_surface_settings flat = {.focal_length_m = SHALLOW_M, .kind = HF_SURFACE_PARABOLOID};

/* A scene of inner nodes on the wanted surface at these x, y, with cables between these ends. */
static hf_scene drawn(int n_node, const double (*xy)[2], int n_cable, const int (*end)[2])
{
    hf_scene s;
    ck_assert_int_eq(hf_scene_allocate(&s, n_node, n_cable, false, false, false), HF_OK);
    for (int i = 0; i < n_node; i++) {
        s.position_m[3 * i] = xy[i][0];
        s.position_m[3 * i + 1] = xy[i][1];
        s.position_m[3 * i + 2] = (xy[i][0] * xy[i][0] + xy[i][1] * xy[i][1]) / (4 * SHALLOW_M);
        s.role[i] = HF_ROLE_INNER;
    }
    memcpy(s.end, end, (size_t)n_cable * sizeof *end);
    return s;
}

static hf_facets found(const hf_scene *s)
{
    hf_facets f;
    ck_assert_int_eq(hf_facets_find(s, &flat, &f), HF_OK);
    return f;
}

/* Twice the area of a facet, counter-clockwise positive. */
static double area_of(const hf_scene *s, const int c[4])
{
    double sum = 0;
    for (int k = 0; k < 4; k++) {
        const double *p = s->position_m + 3 * c[k], *q = s->position_m + 3 * c[(k + 1) % 4];
        sum += p[0] * q[1] - p[1] * q[0];
    }
    return sum;
}

/* A square beside a triangle, a tie that hangs at a corner, and two cables between the same nodes on the seam. */
START_TEST(triangles_and_quadrilaterals_are_found)
{
    static const double xy[][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0.5}, {-1, -1}, {-2, -1}};
    static const int end[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {1, 4}, {4, 2}, {0, 5}, {5, 6}, {2, 1}};
    hf_scene s = drawn(7, xy, 9, end);
    hf_facets f = found(&s);
    ck_assert(f.is_planar);
    ck_assert_int_eq(f.n_facet, 2);
    ck_assert_int_eq(f.n_open, 0);
    int n_triangle = 0;
    for (int i = 0; i < 2; i++) {
        bool is_triangle = f.corner[4 * i + 2] == f.corner[4 * i + 3];
        n_triangle += is_triangle;
        ck_assert_double_eq_tol(area_of(&s, f.corner + 4 * i), is_triangle ? 1 : 2, 1e-15);
    }
    ck_assert_int_eq(n_triangle, 1);
    hf_facets_free(&f);
    hf_scene_free(&s);
}
END_TEST

/* A pentagon, and a quadrilateral with a corner that points inwards. */
START_TEST(other_faces_are_counted)
{
    static const double xy[][2] = {{0, 0}, {2, 0}, {3, 1}, {1, 3}, {-1, 1}, {0.5, -2}, {1, -0.5}};
    static const int end[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 0}, {0, 5}, {5, 1}, {0, 6}, {6, 1}};
    hf_scene s = drawn(7, xy, 9, end);
    hf_facets f = found(&s);
    ck_assert(f.is_planar);
    ck_assert_int_eq(f.n_facet, 1); /* 0, 6, 1 */
    ck_assert_int_eq(f.n_open, 2);
    hf_facets_free(&f);
    hf_scene_free(&s);
}
END_TEST

/* Two diagonals that cross without a node: the faces are not those of the mesh. */
START_TEST(crossing_cables_have_no_facets)
{
    static const double xy[][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    static const int end[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}, {1, 3}};
    for (int n_cable = 5; n_cable <= 6; n_cable++) {
        hf_scene s = drawn(4, xy, n_cable, end);
        hf_facets f = found(&s);
        ck_assert_int_eq(f.is_planar, n_cable == 5);
        ck_assert_int_eq(f.n_facet, n_cable == 5 ? 2 : 0);
        hf_facets_free(&f);
        hf_scene_free(&s);
    }
}
END_TEST

/* One node between supports, and no cable on the rim: a net that is a tree has its facets, too. */
START_TEST(a_tree_between_supports_is_closed)
{
    enum { ARMS = 6 };
    double xy[ARMS + 1][2] = {{0.1, 0.2}};
    int end[ARMS][2];
    for (int i = 0; i < ARMS; i++) {
        xy[i + 1][0] = cos(acos(0.5) * i);
        xy[i + 1][1] = sin(acos(0.5) * i);
        end[i][0] = 0;
        end[i][1] = i + 1;
    }
    hf_scene s = drawn(ARMS + 1, (const double(*)[2])xy, ARMS, (const int(*)[2])end);
    for (int i = 1; i <= ARMS; i++)
        s.role[i] = HF_ROLE_SUPPORT;
    hf_facets f = found(&s);
    double area = 0;
    for (int i = 0; i < f.n_facet; i++)
        area += area_of(&s, f.corner + 4 * i);
    ck_assert(f.is_planar);
    ck_assert_int_eq(f.n_facet, ARMS);
    ck_assert_int_eq(f.n_open, 0);
    ck_assert_double_eq_tol(area, 3 * sqrt(3.0), 1e-12);
    hf_facets_free(&f);
    hf_scene_free(&s);
}
END_TEST

/* Nodes of a rear net and ties are not on the surface; supports and edge nodes are where they are. */
START_TEST(only_nodes_on_the_surface_count)
{
    static const double xy[][2] = {{0, 0}, {9, 0}, {9, 9}, {0, 9}, {3, 3}};
    static const int end[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {2, 4}};
    hf_scene s = drawn(5, xy, 6, end);
    s.role[0] = s.role[1] = s.role[2] = s.role[3] = HF_ROLE_SUPPORT;
    s.role[4] = HF_ROLE_EDGE;
    hf_facets f = found(&s);
    ck_assert_int_eq(f.n_facet, 2); /* 0, 1, 2, 4 and 0, 4, 2, 3, with a corner on the line of its neighbours */
    hf_facets_free(&f);
    s.position_m[14] -= 0.5;
    f = found(&s);
    ck_assert_int_eq(f.n_facet, 1);
    ck_assert_double_eq_tol(area_of(&s, f.corner), 162, 1e-12);
    hf_facets_free(&f);
    hf_scene_free(&s);
}
END_TEST

/* Corners of a square with a middle: a rim that gave way still holds the cables of the surface; a tie does not. */
START_TEST(a_rim_that_gave_way_holds_the_surface)
{
    static const double xy[][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.5}};
    static const int end[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 0}, {4, 1}, {4, 2}, {4, 3}};
    static const double below_m[] = {0.02, 0.06, 0.08, 0.5};
    static const int n_facet[] = {4, 4, 2, 2};
    for (int k = 0; k < 4; k++) {
        hf_scene s = drawn(5, xy, 8, end);
        for (int i = 0; i < 4; i++)
            s.role[i] = HF_ROLE_SUPPORT;
        s.position_m[2] -= below_m[k];
        hf_facets f = found(&s);
        ck_assert_int_eq(f.n_facet, n_facet[k]);
        hf_facets_free(&f);
        hf_scene_free(&s);
    }
}
END_TEST

/* The quad net of a generator: all of its cells, whatever the supports. */
START_TEST(cells_of_a_generated_net_are_found)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR, "surface.strip_width_m=1");
    hf_facets f;
    ck_assert_int_eq(hf_facets_find(&net.scene, &net.settings.surface, &f), HF_OK);
    const hf_cylinder *c = &net.settings.parabolic_cylinder;
    ck_assert(f.is_planar);
    ck_assert_int_eq(f.n_facet + f.n_open,
                     c->modules[0] * c->cells_per_module[0] * c->modules[1] * c->cells_per_module[1]);
    ck_assert_int_eq(f.n_open, 0);
    hf_facets_free(&f);
    close_net(&net);
}
END_TEST

/* A chain of half a million nodes hangs at a triangle, its end first or last in the order of the nodes. With a time
 * that grows with the square of the chain this would take many minutes. */
START_TEST(a_long_chain_leaves_in_linear_time)
{
    enum { N = 500000 };
    hf_scene s;
    ck_assert_int_eq(hf_scene_allocate(&s, N, N, false, false, false), HF_OK);
    for (int i = 0; i < N; i++) {
        s.position_m[3 * i] = _i ? -i * 1e-6 : i * 1e-6;
        s.role[i] = HF_ROLE_INNER;
        s.end[2 * i] = i;
        s.end[2 * i + 1] = i + 1;
    }
    int tip = _i ? 0 : N - 1, other = _i ? 2 : N - 3;
    s.position_m[3 * tip + 1] = 1;
    s.end[2 * (N - 1)] = tip;
    s.end[2 * (N - 1) + 1] = other;
    hf_facets f = found(&s);
    ck_assert(f.is_planar);
    ck_assert_int_eq(f.n_facet, 1);
    ck_assert_int_eq(f.n_open, 0);
    hf_facets_free(&f);
    hf_scene_free(&s);
}
END_TEST

/* Two supports and what is between them outside of two cells: boundary cables that hang as an edge, over one node or
 * two, leave nothing to close; those that hold the last nodes before a rim (the same, but steep), or that an inner
 * cable joins, do. */
START_TEST(an_edge_that_hangs_closes_no_gap)
{
    static const struct {
        double depth;
        int n_between, n_gap;
        hf_group middle;
    } edge[] = {{0.1, 1, 0, HF_GROUP_BOUNDARY},
                {0.25, 1, 0, HF_GROUP_BOUNDARY},
                {0.5, 1, 1, HF_GROUP_BOUNDARY},
                {0.1, 2, 0, HF_GROUP_BOUNDARY},
                {0.1, 2, 1, HF_GROUP_INNER}};
    static const int one[][2] = {{0, 1}, {1, 2}, {0, 3}, {3, 1}, {3, 2}};
    static const int two[][2] = {{0, 1}, {1, 2}, {2, 3}, {0, 4}, {4, 1}, {4, 2}, {4, 3}};
    double depth = edge[_i].depth;
    const double xy_one[][2] = {{0, 0}, {0.5, depth}, {1, 0}, {0.5, 2}};
    const double xy_two[][2] = {{0, 0}, {0.3, depth}, {0.7, depth}, {1, 0}, {0.5, 2}};
    bool is_one = edge[_i].n_between == 1;
    hf_scene s = is_one ? drawn(4, xy_one, 5, one) : drawn(5, xy_two, 7, two);
    int n_along = edge[_i].n_between + 1;
    s.role[0] = s.role[n_along] = HF_ROLE_SUPPORT;
    for (int e = 0; e < s.n_cable; e++)
        s.group[e] = (unsigned char)(e >= n_along ? HF_GROUP_INNER : e == 1 ? edge[_i].middle : HF_GROUP_BOUNDARY);
    hf_facets f = found(&s);
    ck_assert(f.is_planar);
    ck_assert_int_eq(f.n_facet, n_along + edge[_i].n_gap);
    hf_facets_free(&f);
    hf_scene_free(&s);
}
END_TEST

START_TEST(memory_may_end)
{
    static const double xy[][2] = {{0, 0}, {1, 0}, {1, 1}};
    static const int end[][2] = {{0, 1}, {1, 2}, {2, 0}};
    hf_scene s = drawn(3, xy, 3, end);
    for (long n = 1;; n++) {
        hf_facets f;
        fail_allocation_at(n);
        hf_status status = hf_facets_find(&s, &flat, &f);
        bool failed = end_allocation_failure();
        ck_assert_int_eq(status, failed ? HF_NO_MEMORY : HF_OK);
        hf_facets_free(&f);
        if (!failed) break;
    }
    hf_scene_free(&s);
}
END_TEST

Suite *suite_unit_facets(void)
{
    Suite *suite = suite_create("unit/facets");
    TCase *tests = tcase_create("facets");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, triangles_and_quadrilaterals_are_found);
    tcase_add_test(tests, other_faces_are_counted);
    tcase_add_test(tests, crossing_cables_have_no_facets);
    tcase_add_test(tests, a_tree_between_supports_is_closed);
    tcase_add_test(tests, only_nodes_on_the_surface_count);
    tcase_add_test(tests, a_rim_that_gave_way_holds_the_surface);
    tcase_add_test(tests, cells_of_a_generated_net_are_found);
    tcase_add_loop_test(tests, a_long_chain_leaves_in_linear_time, 0, 2);
    tcase_add_loop_test(tests, an_edge_that_hangs_closes_no_gap, 0, 5);
    tcase_add_test(tests, memory_may_end);
    return suite;
}
