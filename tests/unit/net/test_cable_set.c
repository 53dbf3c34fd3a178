/* Named sets of cables: how a table names them, what it may not say, and what a scene holds of them. */
#include "nets.h"

#include "net/scene_import.h"
#include <hifdm/cable_set.h>

#define NODES "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,0,inner\nc,2,0,0,inner\nd,3,0,0,support\n"
#define HEADER "id,i,j,group,law,value,set\n"

static hf_status import(const char *cables, hf_scene *scene, char *said, size_t size)
{
    hf_messages messages = {0};
    const char *nodes_path = temp_path("nodes.csv"), *cables_path = temp_path("cables.csv");
    write_file(nodes_path, NODES);
    write_file(cables_path, cables);
    hf_status status = hf_scene_import(nodes_path, cables_path, (const double[2]){0}, scene, &messages);
    copy_without_folder(messages.text, said, size);
    hf_messages_free(&messages);
    return status;
}

START_TEST(a_table_names_sets)
{
    char said[512];
    hf_scene s;
    hf_status status = import(HEADER "ab,a,b,inner,tension,1,z_1 front\n"
                                     "bc,b,c,inner,tension,1,\n"
                                     "cd,c,d,boundary,length,,; 9-x;;front\tz_1 \n",
                              &s, said, sizeof said);
    ck_assert_msg(status == HF_OK, "%s", said);
    ck_assert_str_eq(said, "");
    static const char *const name[] = {"9-x", "front", "z_1"};
    static const int start[] = {0, 1, 3, 5}, cable[] = {2, 0, 2, 0, 2};
    ck_assert_int_eq(s.n_set, 3);
    ck_assert_mem_eq(s.set_start, start, sizeof start);
    ck_assert_mem_eq(s.set_cable, cable, sizeof cable);
    for (int k = 0; k < 3; k++) {
        ck_assert_str_eq(s.set_name[k], name[k]);
        ck_assert_int_eq(hf_cable_set_find(&s, name[k]), k);
    }
    ck_assert_int_eq(hf_cable_set_find(&s, "fron"), -1);
    ck_assert(!hf_cable_set_has(&s, 0, 0) && !hf_cable_set_has(&s, 0, 1) && hf_cable_set_has(&s, 0, 2));
    ck_assert(hf_cable_set_has(&s, 1, 0) && !hf_cable_set_has(&s, 1, 1) && hf_cable_set_has(&s, 1, 2));
    hf_scene_free(&s);
    ck_assert_ptr_null(s.set_name);
}
END_TEST

static const char *const without[] = {"id,i,j,group,law,value\nab,a,b,inner,tension,1\nbc,b,c,inner,tension,1\n",
                                      HEADER "ab,a,b,inner,tension,1,\nbc,b,c,inner,tension,1, ; \n"};

START_TEST(without_names_there_is_nothing)
{
    char said[512];
    hf_scene s;
    ck_assert_int_eq(import(without[_i], &s, said, sizeof said), HF_OK);
    ck_assert_int_eq(s.n_set, 0);
    ck_assert_ptr_null(s.set_block);
    ck_assert_ptr_null(s.set_name);
    ck_assert_ptr_null(s.set_start);
    ck_assert_ptr_null(s.set_cable);
    ck_assert_int_eq(hf_cable_set_find(&s, "front"), -1);
    hf_scene_free(&s);
}
END_TEST

#define LONG_63 "abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyz01234567890"

static const struct {
    const char *set, *said;
} faulty[] = {
    {"front rear front", "error: cables.csv:3: 'bc': stands twice in the set front\n"},
    {"a.b", "error: cables.csv:3: 'bc': the set 'a.b' must be made of letters, digits, _ and -\n"},
    {"ok;b\xc3\xa9", "error: cables.csv:3: 'bc': the set 'b\xc3\xa9' must be made of letters, digits, _ and -\n"},
    {"-x", "error: cables.csv:3: 'bc': the set '-x' must not begin with -\n"},
    {"boundary", "error: cables.csv:3: 'bc': the set 'boundary' is the name of a group, which the column group sets; "
                 "leave it out\n"},
    {"all", "error: cables.csv:3: 'bc': the set 'all' is the name of all cables; leave it out\n"},
    {LONG_63 "4", "error: cables.csv:3: 'bc': the set '" LONG_63 "' is longer than 63 letters\n"},
};
enum { N_FAULTY = sizeof faulty / sizeof *faulty };

START_TEST(wrong_names_are_refused)
{
    char said[512], cables[512];
    hf_scene s;
    snprintf(cables, sizeof cables, HEADER "ab,a,b,inner,tension,1,front\nbc,b,c,inner,tension,1,%s\n", faulty[_i].set);
    ck_assert_int_eq(import(cables, &s, said, sizeof said), HF_BAD_CASE);
    ck_assert_str_eq(said, faulty[_i].said);
    ck_assert_ptr_null(s.set_block);
}
END_TEST

START_TEST(the_longest_name_is_taken)
{
    char said[512];
    hf_scene s;
    ck_assert_int_eq(import(HEADER "ab,a,b,inner,tension,1," LONG_63 "\n", &s, said, sizeof said), HF_OK);
    ck_assert_str_eq(s.set_name[0], LONG_63);
    hf_scene_free(&s);
}
END_TEST

Suite *suite_unit_cable_set(void)
{
    Suite *suite = suite_create("unit/cable_set");
    TCase *tests = tcase_create("cable_set");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, a_table_names_sets);
    tcase_add_loop_test(tests, without_names_there_is_nothing, 0, sizeof without / sizeof *without);
    tcase_add_loop_test(tests, wrong_names_are_refused, 0, N_FAULTY);
    tcase_add_test(tests, the_longest_name_is_taken);
    return suite;
}
