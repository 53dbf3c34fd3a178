/* The order of the free nodes is a permutation; its bandwidth is reported correctly and is small. */
#include "laws.h"

#include "net/numbering.h"

/* Half-bandwidth of an order, from the cables themselves; asserts that it is a permutation of the free nodes.
 * *squares: sum of the squared row widths. */
static int true_half_bandwidth(const hf_scene *s, const int *order, int n_free, double *squares)
{
    int *place = malloc((size_t)s->n_node * sizeof *place), *width = calloc((size_t)n_free, sizeof *width), widest = 0;
    ck_assert_ptr_nonnull(place);
    ck_assert_ptr_nonnull(width);
    for (int i = 0; i < s->n_node; i++)
        place[i] = -1;
    for (int i = 0; i < n_free; i++) {
        ck_assert(order[i] >= 0 && order[i] < s->n_node);
        ck_assert_int_ne(s->role[order[i]], HF_ROLE_SUPPORT);
        ck_assert_int_eq(place[order[i]], -1);
        place[order[i]] = i;
    }
    for (int e = 0; e < s->n_cable; e++) {
        int a = place[s->end[2 * e]], b = place[s->end[2 * e + 1]];
        int last = a > b ? a : b;
        if (a < 0 || b < 0) continue;
        if (abs(a - b) > width[last]) width[last] = abs(a - b);
        if (abs(a - b) > widest) widest = abs(a - b);
    }
    *squares = 0;
    for (int i = 0; i < n_free; i++)
        *squares += (double)width[i] * width[i];
    free(width);
    free(place);
    return widest;
}

/* Half-bandwidth found, checked to be what the order really has. squares[0]: sum of the squared row widths found,
 * squares[1]: that of the scene's own order. */
static int number(const hf_scene *s, double squares[2])
{
    int *order = malloc((size_t)s->n_node * sizeof *order), n_free = 0, half_bandwidth = -5;
    ck_assert_ptr_nonnull(order);
    for (int i = 0; i < s->n_node; i++)
        if (s->role[i] != HF_ROLE_SUPPORT) order[n_free++] = i;
    true_half_bandwidth(s, order, n_free, &squares[1]);
    ck_assert_int_eq(hf_numbering_find(s, order, &half_bandwidth), HF_OK);
    ck_assert_int_eq(half_bandwidth, true_half_bandwidth(s, order, n_free, &squares[0]));
    free(order);
    return half_bandwidth;
}

/* Nodes 0..n-1 in a row, the last a support, named in a random order: the best order has half-bandwidth 1. */
START_TEST(a_shuffled_path_becomes_a_path)
{
    enum { N = 40 };
    struct rng rng = rng_start((uint64_t)_i);
    struct hand_node node[N];
    struct hand_cable cable[N - 1];
    int name[N];
    double squares[2];
    for (int i = 0; i < N; i++)
        name[i] = i;
    for (int i = N - 2; i > 0; i--) {
        int j = rng_int(&rng, 0, i), swap = name[i];
        name[i] = name[j], name[j] = swap;
    }
    for (int i = 0; i < N; i++) { /* positions at random: sorting along an axis does not help */
        node[i] = (struct hand_node){.role = i == N - 1 ? HF_ROLE_SUPPORT : HF_ROLE_INNER};
        for (int c = 0; c < 3; c++)
            node[i].position_m[c] = rng_uniform(&rng, -1, 1);
    }
    for (int e = 0; e + 1 < N; e++)
        cable[e] = (struct hand_cable){{name[e], name[e + 1]}, HF_GROUP_INNER, HF_LAW_TENSION, 1};
    hf_scene s;
    hand_scene(&s, N, node, N - 1, cable);
    ck_assert_int_eq(number(&s, squares), 1);
    ck_assert_double_eq(squares[0], N - 2); /* N - 1 free nodes, the first row is empty */
    ck_assert_double_gt(squares[1], squares[0]);
    hf_scene_free(&s);
}
END_TEST

/* At least as good as sorting a p x q grid of free nodes along its long side, where every node but those of the first
 * line reaches back to the line before. */
START_TEST(grids_are_at_least_sorted)
{
    static const int cells[][2] = {{2, 2}, {5, 9}, {9, 5}, {12, 3}, {3, 12}, {2, 20}};
    const int *c = cells[_i];
    hf_cylinder cylinder = {.aperture_m = 10,
                            .length_m = 12,
                            .focal_length_m = 5,
                            .modules = {1, 1},
                            .cells_per_module = {c[0], c[1]},
                            .supports = HF_SUPPORTS_PERIMETER};
    hf_messages messages = {0};
    hf_scene s;
    int p = c[0] - 1 < c[1] - 1 ? c[0] - 1 : c[1] - 1, n = (c[0] - 1) * (c[1] - 1);
    double squares[2];
    ck_assert_int_eq(hf_scene_parabolic_cylinder(&cylinder, NULL, &s, &messages), HF_OK);
    number(&s, squares);
    ck_assert_double_le(squares[0], (n - p) * p * p + p - 1);
    hf_scene_free(&s);
}
END_TEST

/* Random graphs: at least as good as the order in which the nodes came. */
START_TEST(never_worse_than_it_was_and_usually_better)
{
    int n_better = 0;
    for (uint64_t trial = 0; trial < 50; trial++) {
        struct rng rng = rng_start(trial);
        hf_scene s;
        double squares[2];
        random_fdm_scene(&rng, &s);
        number(&s, squares);
        n_better += squares[0] < squares[1];
        ck_assert_msg(squares[0] <= squares[1], "trial %d: %g instead of %g", (int)trial, squares[0], squares[1]);
        hf_scene_free(&s);
    }
    ck_assert_int_ge(n_better, 40);
}
END_TEST

/* The program's usual net, 41 x 49 nodes: no row reaches further back than one rib's nodes do, and most less. */
START_TEST(a_reflector_has_narrow_rows)
{
    hf_cylinder cylinder = {.aperture_m = 10,
                            .length_m = 12,
                            .focal_length_m = 5,
                            .modules = {10, 12},
                            .cells_per_module = {4, 4},
                            .supports = HF_SUPPORTS_MODULE_CORNERS};
    hf_messages messages = {0};
    hf_scene s;
    double squares[2];
    ck_assert_int_eq(hf_scene_parabolic_cylinder(&cylinder, NULL, &s, &messages), HF_OK);
    ck_assert_int_le(number(&s, squares), 49);
    ck_assert_double_le(squares[0], 0.8 * (41 * 49 - 11 * 13) * 41 * 41);
    hf_scene_free(&s);
}
END_TEST

/* Sorted along y, whose skyline is best, a net of rings has a band of 35. */
START_TEST(a_round_net_has_a_narrow_band)
{
    const hf_paraboloid dish = {.aperture_m = 6, .focal_length_m = 3, .rings = 10};
    hf_messages messages = {0};
    hf_scene s;
    double squares[2];
    ck_assert_int_eq(hf_scene_paraboloid(&dish, NULL, &s, &messages), HF_OK);
    ck_assert_int_le(number(&s, squares), 21);
    ck_assert_double_le(squares[0], squares[1]);
    hf_scene_free(&s);
}
END_TEST

/* Two nets that share nothing, and free nodes that touch supports only. */
START_TEST(separate_parts_are_numbered)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 0, 0}, HF_ROLE_INNER, {0}},
                                            {{9, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{2, 0, 0}, HF_ROLE_INNER, {0}},
                                            {{3, 1, 0}, HF_ROLE_EDGE, {0}},    {{5, 1, 0}, HF_ROLE_INNER, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 1},
                                              {{2, 3}, HF_GROUP_INNER, HF_LAW_TENSION, 1},
                                              {{5, 4}, HF_GROUP_INNER, HF_LAW_TENSION, 1},
                                              {{4, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 1}};
    hf_scene s;
    double squares[2];
    hand_scene(&s, 6, node, 4, cable);
    ck_assert_int_eq(number(&s, squares), 1);
    hf_scene_free(&s);
    hand_scene(&s, 4, node, 2, cable); /* no two free nodes joined: D is diagonal */
    ck_assert_int_eq(number(&s, squares), 0);
    hf_scene_free(&s);
}
END_TEST

Suite *suite_unit_numbering(void)
{
    Suite *suite = suite_create("unit/numbering");
    TCase *tests = tcase_create("numbering");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, a_shuffled_path_becomes_a_path, 0, 5);
    tcase_add_loop_test(tests, grids_are_at_least_sorted, 0, 6);
    tcase_add_test(tests, never_worse_than_it_was_and_usually_better);
    tcase_add_test(tests, a_reflector_has_narrow_rows);
    tcase_add_test(tests, a_round_net_has_a_narrow_band);
    tcase_add_test(tests, separate_parts_are_numbered);
    return suite;
}
