/* The cables that a row of a case file names: a group, a named set, all; what is said of a name without cables. */
#include "nets.h"

#include "net/cable_pick.h"

enum { N_CABLE = 5 };

/* Cables 1 and 3 are of the boundary, or none; 0 and 3 are front, 4 is tie. */
static void make(hf_scene *s, bool with_boundary, bool with_sets)
{
    static const char *const name[] = {"front", "tie"};
    static const hf_cable_set_member member[] = {{0, 0}, {0, 3}, {1, 4}};
    ck_assert_int_eq(hf_scene_allocate(s, 3, N_CABLE, false, false, false), HF_OK);
    for (int e = 0; e < N_CABLE; e++)
        s->group[e] = with_boundary && e % 2 ? HF_GROUP_BOUNDARY : HF_GROUP_INNER;
    if (with_sets) ck_assert_int_eq(hf_cable_set_make(s, 2, name, 3, member), HF_OK);
}

static const struct {
    const char *set;
    int n, cable[N_CABLE];
} known[] = {
    {"", 5, {0, 1, 2, 3, 4}},
    {"all", 5, {0, 1, 2, 3, 4}},
    {"inner", 3, {0, 2, 4}},
    {"boundary", 2, {1, 3}},
    {"front", 2, {0, 3}},
    {"tie", 1, {4}},
    {"tie+front", 3, {0, 3, 4}},
    {"front+boundary+front", 3, {0, 1, 3}},
    {"inner+boundary", 5, {0, 1, 2, 3, 4}},
};
enum { N_KNOWN = sizeof known / sizeof *known };

START_TEST(a_name_gives_its_cables)
{
    hf_scene s;
    hf_messages messages = {0};
    int cable[N_CABLE], again[N_CABLE], n = known[_i].n;
    make(&s, true, true);
    ck_assert_int_eq(hf_cable_pick(&s, known[_i].set, cable), n);
    ck_assert_mem_eq(cable, known[_i].cable, (size_t)n * sizeof(int));
    ck_assert_int_eq(hf_cable_pick_some(&s, known[_i].set, "row", again, &messages), n);
    ck_assert_mem_eq(again, cable, (size_t)n * sizeof(int));
    ck_assert_ptr_null(messages.text);
    hf_scene_free(&s);
}
END_TEST

static const struct {
    const char *set, *said;
    bool with_boundary, with_sets;
} faulty[] = {
    {"fron", "error: row: this net has no cable set 'fron'; did you mean 'front'?\n", true, true},
    {"front+ties+fron", "error: row: this net has no cable set 'ties'; did you mean 'tie'?\n", true, true},
    {"ties", "error: row: this net has no cable set 'ties'; did you mean 'tie'?\n", true, true},
    {"bounday", "error: row: this net has no cable set 'bounday'; did you mean 'boundary'?\n", true, true},
    {"rearward",
     "error: row: this net has no cable set 'rearward'. The sets of this net are all, inner, boundary, front, tie\n",
     true, true},
    {"rearward", "error: row: this net has no cable set 'rearward'. The sets of this net are all, inner, boundary\n",
     true, false},
    {"boundary", "error: row: this net has no boundary cables\n", false, true},
};
enum { N_FAULTY = sizeof faulty / sizeof *faulty };

START_TEST(a_name_without_cables_is_refused)
{
    hf_scene s;
    hf_messages messages = {0};
    int cable[N_CABLE];
    make(&s, faulty[_i].with_boundary, faulty[_i].with_sets);
    ck_assert_int_eq(hf_cable_pick(&s, faulty[_i].set, cable), faulty[_i].with_boundary ? -1 : 0);
    ck_assert_int_eq(hf_cable_pick_some(&s, faulty[_i].set, "row", cable, &messages), 0);
    ck_assert_str_eq(messages.text, faulty[_i].said);
    ck_assert_int_eq(messages.n_error, 1);
    hf_messages_free(&messages);
    hf_scene_free(&s);
}
END_TEST

/* Names that do not all fit are cut off between two of them. */
START_TEST(many_sets_are_listed_as_far_as_they_fit)
{
    enum { N_SET = 64 };
    static const char *const tail = ", family_45, ...\n";
    char text[N_SET][HF_CABLE_SET_NAME_SIZE];
    const char *name[N_SET];
    hf_cable_set_member member[N_SET];
    hf_scene s;
    hf_messages messages = {0};
    make(&s, true, false);
    for (int k = 0; k < N_SET; k++) {
        snprintf(text[k], sizeof text[k], "family_%02d", k);
        name[k] = text[k];
        member[k] = (hf_cable_set_member){k, 0};
    }
    ck_assert_int_eq(hf_cable_set_make(&s, N_SET, name, N_SET, member), HF_OK);
    ck_assert_int_eq(hf_cable_pick_some(&s, "elsewhere", "row", NULL, &messages), 0);
    ck_assert_ptr_nonnull(strstr(messages.text, ", boundary, family_00, family_01"));
    ck_assert_str_eq(messages.text + strlen(messages.text) - strlen(tail), tail);
    hf_messages_free(&messages);
    hf_scene_free(&s);
}
END_TEST

Suite *suite_unit_cable_pick(void)
{
    Suite *suite = suite_create("unit/cable_pick");
    TCase *tests = tcase_create("cable_pick");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, a_name_gives_its_cables, 0, N_KNOWN);
    tcase_add_loop_test(tests, a_name_without_cables_is_refused, 0, N_FAULTY);
    tcase_add_test(tests, many_sets_are_listed_as_far_as_they_fit);
    return suite;
}
