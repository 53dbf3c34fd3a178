/* The checks that every scene goes through, wherever it came from. */
#include "nets.h"

/* 5 x 7 nodes. */
static const hf_cylinder plain = {.aperture_m = 10,
                                  .length_m = 12,
                                  .focal_length_m = 5,
                                  .modules = {2, 3},
                                  .cells_per_module = {2, 2},
                                  .supports = HF_SUPPORTS_MODULE_CORNERS};

static hf_scene generate(const hf_cylinder *cylinder)
{
    hf_messages messages = {0};
    hf_scene scene;
    ck_assert_msg(hf_scene_parabolic_cylinder(cylinder, NULL, &scene, &messages) == HF_OK, "%s", messages.text);
    return scene;
}

static hf_status check(hf_scene *scene, char *text, size_t size)
{
    hf_messages messages = {0};
    hf_status status = hf_scene_check(scene, &messages);
    snprintf(text, size, "%s", messages.text ? messages.text : "");
    hf_messages_free(&messages);
    hf_scene_free(scene);
    return status;
}

START_TEST(nothing_to_find_is_refused)
{
    char text[256];
    hf_cylinder c = plain;
    c.cells_per_module[0] = c.cells_per_module[1] = 1; /* every node is a module corner */
    hf_scene s = generate(&c);
    ck_assert_int_eq(check(&s, text, sizeof text), HF_BAD_CASE);
    ck_assert_str_eq(text, "error: scene: the net has no free nodes, because every node is a support\n");
    c.cells_per_module[0] = 2; /* free nodes on the edges only */
    c.boundary = HF_BOUNDARY_MODULE_EDGES;
    s = generate(&c);
    ck_assert_int_eq(check(&s, text, sizeof text), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(text, "no node has the role 'inner'"));
}
END_TEST

START_TEST(all_faults_are_named_at_once)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1, 0, 0}, HF_ROLE_INNER, {0}},
                                            {{1, 0, 0}, HF_ROLE_EDGE, {0}},
                                            {{5, 5, 5}, HF_ROLE_INNER, {0}},
                                            {{6, 5, 5}, HF_ROLE_INNER, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 1},
                                              {{1, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 1},
                                              {{1, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 1},
                                              {{3, 4}, HF_GROUP_INNER, HF_LAW_TENSION, 1}};
    char text[1024];
    hf_scene s;
    hand_scene(&s, 5, node, 4, cable);
    ck_assert_int_eq(check(&s, text, sizeof text), HF_BAD_CASE);
    ck_assert_str_eq(text, "error: scene: cable 'c1' has zero length: its two nodes are at the same position\n"
                           "error: scene: cable 'c2' joins a node to itself\n"
                           "error: scene: node 'n3' has no path of cables to a support; connect it or remove it\n"
                           "error: scene: node 'n4' has no path of cables to a support; connect it or remove it\n");
}
END_TEST

START_TEST(many_faults_are_cut_short)
{
    char text[4096];
    int n_line = 0;
    hf_scene s = generate(&plain);
    for (int e = 0; e < 33; e++)
        s.end[2 * e + 1] = s.end[2 * e];
    hf_status status = check(&s, text, sizeof text);
    ck_assert_int_eq(status, HF_BAD_CASE);
    for (const char *p = text; (p = strchr(p, '\n')) != NULL; p++)
        n_line++;
    ck_assert_int_eq(n_line, 21);
    ck_assert_ptr_nonnull(strstr(text, " more faults in this net\n"));
}
END_TEST

START_TEST(good_scenes_pass)
{
    char text[256];
    hf_scene s = generate(&plain);
    ck_assert_int_eq(check(&s, text, sizeof text), HF_OK);
    ck_assert_str_eq(text, "");
}
END_TEST

Suite *suite_unit_scene_check(void)
{
    Suite *suite = suite_create("unit/scene_check");
    TCase *tests = tcase_create("scene_check");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, good_scenes_pass);
    tcase_add_test(tests, nothing_to_find_is_refused);
    tcase_add_test(tests, all_faults_are_named_at_once);
    tcase_add_test(tests, many_faults_are_cut_short);
    return suite;
}
