/* Case file -> settings: defaults, overrides, both kinds of scene, and every fault at its file:line:col. */
#include "nets.h"

#include "case/config_key.h"

#include <fnmatch.h>

#define CYLINDER                                                                                                       \
    "scene:\n"                                                                                                         \
    "  parabolic_cylinder: {aperture_m: 10, length_m: 12, focal_length_m: 5, modules: [2, 3], cells_per_module: [4, "  \
    "2]}\n"

/* Load `text` as case.yaml; what was said goes to `said` without the folder. */
static hf_status load(const char *text, const char *const *overrides, int n_override, hf_case *c, char *said,
                      size_t size)
{
    hf_messages messages = {0};
    const char *path = temp_path("case.yaml");
    if (text) write_file(path, text);
    hf_status status = hf_config_load(path, overrides, n_override, c, &messages);
    copy_without_folder(messages.text, said, size);
    hf_messages_free(&messages);
    return status;
}

/* ---- what is accepted ---- */

START_TEST(defaults_hold_where_nothing_is_said)
{
    char said[256];
    hf_case c;
    ck_assert_int_eq(load(CYLINDER, NULL, 0, &c, said, sizeof said), HF_OK);
    ck_assert_str_eq(said, "");
    ck_assert(c.has_parabolic_cylinder && !c.has_import && !c.has_optimize);
    ck_assert_double_eq(c.parabolic_cylinder.aperture_m, 10);
    ck_assert_int_eq(c.parabolic_cylinder.modules[0], 2);
    ck_assert_int_eq(c.parabolic_cylinder.modules[1], 3);
    ck_assert_int_eq(c.parabolic_cylinder.cells_per_module[0], 4);
    ck_assert_int_eq(c.parabolic_cylinder.supports, HF_SUPPORTS_MODULE_CORNERS);
    ck_assert_int_eq(c.form.method, HF_METHOD_AUTO);
    ck_assert_int_eq(c.form.stop, HF_STOP_RESIDUAL); /* METHOD section 3 */
    ck_assert_double_eq(c.form.pretension_N, 10);
    ck_assert_int_eq(c.optimize.population, 50); /* METHOD section 7 */
    ck_assert_int_eq(c.optimize.generations, 400);
    ck_assert_double_eq(c.optimize.crossover_high, 0.9);
    ck_assert_double_eq(c.optimize.crossover_low, 0.6);
    ck_assert_double_eq(c.optimize.mutation_high, 0.1);
    ck_assert_double_eq(c.optimize.mutation_low, 0.001);
    ck_assert_str_eq(c.title, "");
    ck_assert_str_eq(c.overrides, "");
    ck_assert_str_eq(c.text, CYLINDER);
    hf_case_free(&c);
}
END_TEST

START_TEST(every_value_reaches_its_place)
{
    char said[256];
    hf_case c;
    ck_assert_int_eq(
        load("title: \"a: b\"\n" CYLINDER
             "form: {method: iterative_fdm, pretension_N: 12.5, stop: rms_change, residual_tolerance: 2e-9,"
             " length_tolerance: 3e-9, rms_tolerance_m: 4e-6, max_iterations: 77, collapse_ratio: 0.02}\n"
             "optimize: {rule: seeded, population: 12, generations: 34, range_N: 0.75, min_tension_N: 2,"
             " max_tension_N: 99, boundary_ratio_cap: 5.5, seed: 18446744073709551615, elites: 3,"
             " stagnation_tolerance_m: 7e-6, stagnation_generations: 21}\n",
             NULL, 0, &c, said, sizeof said),
        HF_OK);
    ck_assert_str_eq(c.title, "a: b");
    ck_assert_int_eq(c.form.method, HF_METHOD_ITERATIVE_FDM);
    ck_assert_int_eq(c.form.stop, HF_STOP_RMS_CHANGE);
    ck_assert_double_eq(c.form.pretension_N, 12.5);
    ck_assert_double_eq(c.form.residual_tolerance, 2e-9);
    ck_assert_double_eq(c.form.length_tolerance, 3e-9);
    ck_assert_double_eq(c.form.rms_tolerance_m, 4e-6);
    ck_assert_int_eq(c.form.max_iterations, 77);
    ck_assert_double_eq(c.form.collapse_ratio, 0.02);
    ck_assert(c.has_optimize);
    ck_assert_int_eq(c.optimize.rule, HF_RULE_SEEDED);
    ck_assert_int_eq(c.optimize.population, 12);
    ck_assert_int_eq(c.optimize.generations, 34);
    ck_assert_double_eq(c.optimize.range_N, 0.75);
    ck_assert_double_eq(c.optimize.min_tension_N, 2);
    ck_assert_double_eq(c.optimize.max_tension_N, 99);
    ck_assert_double_eq(c.optimize.boundary_ratio_cap, 5.5);
    ck_assert(c.optimize.seed == UINT64_MAX);
    ck_assert_int_eq(c.optimize.elites, 3);
    ck_assert_double_eq(c.optimize.stagnation_tolerance_m, 7e-6);
    ck_assert_int_eq(c.optimize.stagnation_generations, 21);
    hf_case_free(&c);
}
END_TEST

START_TEST(overrides_win_and_change_the_digest)
{
    static const char *const set[] = {"form.pretension_N=12", "scene.parabolic_cylinder.modules=[5, 6]",
                                      "optimize.seed=9"};
    char said[256];
    hf_case plain, c;
    ck_assert_int_eq(load(CYLINDER "form:\n  pretension_N: 11\n", NULL, 0, &plain, said, sizeof said), HF_OK);
    ck_assert_int_eq(load(NULL, set, 3, &c, said, sizeof said), HF_OK);
    ck_assert_double_eq(plain.form.pretension_N, 11);
    ck_assert_double_eq(c.form.pretension_N, 12);
    ck_assert_int_eq(c.parabolic_cylinder.modules[0], 5);
    ck_assert_int_eq(c.parabolic_cylinder.modules[1], 6);
    ck_assert(!plain.has_optimize && c.has_optimize); /* a key brings its section along */
    ck_assert(c.optimize.seed == 9);
    ck_assert_str_eq(c.overrides, "form.pretension_N=12\nscene.parabolic_cylinder.modules=[5, 6]\noptimize.seed=9\n");
    ck_assert_uint_eq(strlen(c.sha256), 64);
    ck_assert_str_ne(c.sha256, plain.sha256);
    hf_case_free(&c);
    hf_case_free(&plain);
}
END_TEST

START_TEST(the_last_of_equal_overrides_wins)
{
    static const char *const set[] = {"form.pretension_N=12", "form.pretension_N=13"};
    char said[256];
    hf_case c;
    ck_assert_int_eq(load(CYLINDER, set, 2, &c, said, sizeof said), HF_OK);
    ck_assert_double_eq(c.form.pretension_N, 13);
    hf_case_free(&c);
}
END_TEST

START_TEST(paths_are_relative_to_the_case_file)
{
    static const char *const set[] = {"scene.import.cables=d/cables.csv"};
    char said[256];
    hf_case c;
    ck_assert_int_eq(load("scene:\n  import: {nodes: n.csv, cables: /abs/c.csv}\n", NULL, 0, &c, said, sizeof said),
                     HF_OK);
    ck_assert(c.has_import && !c.has_parabolic_cylinder);
    ck_assert_str_eq(c.nodes_path, temp_path("n.csv"));
    ck_assert_str_eq(c.cables_path, "/abs/c.csv");
    hf_case_free(&c);
    ck_assert_int_eq(load(NULL, set, 1, &c, said, sizeof said), HF_OK);
    ck_assert_str_eq(c.cables_path, "d/cables.csv"); /* from the command line: the current folder */
    hf_case_free(&c);
}
END_TEST

/* Anchors are YAML; merge keys (<<) are no key of ours. */
START_TEST(anchors_work)
{
    char said[256];
    hf_case c;
    ck_assert_int_eq(load("scene:\n  parabolic_cylinder: {aperture_m: &a 10, length_m: *a, focal_length_m: 5,"
                          " modules: &m [2, 3], cells_per_module: *m}\n",
                          NULL, 0, &c, said, sizeof said),
                     HF_OK);
    ck_assert_double_eq(c.parabolic_cylinder.length_m, 10);
    ck_assert_int_eq(c.parabolic_cylinder.cells_per_module[1], 3);
    hf_case_free(&c);
}
END_TEST

START_TEST(both_kinds_of_scene_are_made)
{
    char said[256];
    hf_case c;
    hf_scene s;
    hf_messages m = {0};
    ck_assert_int_eq(load(CYLINDER, NULL, 0, &c, said, sizeof said), HF_OK);
    ck_assert_int_eq(hf_config_scene(&c, &s, &m), HF_OK);
    ck_assert_int_eq(s.n_node, 9 * 7);
    hf_scene_free(&s);
    hf_case_free(&c);
    write_file(temp_path("n.csv"), "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,0,inner\n");
    write_file(temp_path("c.csv"), "id,i,j,group,law,value\nab,a,b,inner,tension,\n");
    ck_assert_int_eq(load("scene:\n  import: {nodes: n.csv, cables: c.csv}\n", NULL, 0, &c, said, sizeof said), HF_OK);
    ck_assert_msg(hf_config_scene(&c, &s, &m) == HF_OK, "%s", m.text);
    ck_assert_int_eq(s.n_node, 2);
    hf_scene_free(&s);
    write_file(temp_path("c.csv"), "id,i,j,group,law,value\nab,a,a,inner,tension,\n");
    ck_assert_int_eq(hf_config_scene(&c, &s, &m), HF_BAD_CASE); /* the checks of the scene are made, too */
    ck_assert_ptr_nonnull(strstr(m.text, "c.csv:2: cable 'ab' joins a node to itself"));
    hf_messages_free(&m);
    hf_scene_free(&s);
    hf_case_free(&c);
}
END_TEST

/* ---- what is refused: test_config_faults.c has the exact messages; here nothing may crash or be accepted ---- */

/* Counts a path in n_path of the only entry of keys.md that describes it. */
static void check_help(const char *path, int n_path[])
{
    int n = 0, i = 0;
    for (const char *pattern = hf_config_help_text, *help; *pattern; pattern = help + strlen(help) + 1, i++) {
        help = pattern + strlen(pattern) + 1;
        ck_assert_msg(strlen(help) > 10 && help[strlen(help) - 1] == '.', "%s", pattern);
        if (fnmatch(pattern, path, 0) != 0) continue;
        ck_assert_str_eq(hf_config_help(path, NULL), help);
        n_path[i]++;
        n++;
    }
    ck_assert_msg(n == 1, "%d entries describe %s", n, path);
}

START_TEST(each_path_has_a_description)
{
    static int n_path[512];
    char path[HF_KEY_SIZE];
    for (int i = 0; i < hf_n_section; i++)
        check_help(hf_section_table[i].path, n_path);
    for (int i = 0; i < hf_n_field; i++)
        check_help(hf_field_table[i].path, n_path);
    for (int i = 0; i < hf_n_list; i++) {
        const hf_list *list = &hf_list_table[i];
        check_help(list->path, n_path);
        for (int k = 0; k < list->n_field; k++) {
            snprintf(path, sizeof path, "%s.%s", list->path, list->field[k].path);
            check_help(path, n_path);
            ck_assert_str_eq(hf_config_help(path, NULL), hf_config_help(list->path, list->field[k].path));
        }
    }
    int i = 0;
    for (const char *pattern = hf_config_help_text; *pattern; i++) {
        ck_assert_msg(n_path[i] > 0, "nothing has the path %s", pattern);
        pattern += strlen(pattern) + 1;
        pattern += strlen(pattern) + 1;
    }
    ck_assert_str_eq(hf_config_help("form.stopp", NULL), "");
    ck_assert_str_eq(hf_config_help("optimize.limits", "weight"), "");
}
END_TEST

static void check_field(const hf_field *field)
{
    ck_assert_msg(field->type == HF_FIELD_WORD ? !!field->words : field->min < field->max, "%s", field->path);
    ck_assert_msg(field->unit != NULL, "%s", field->path);
}

/* A default in the table must itself be a valid value: all are parsed by the same code, so a bad one shows in every
 * load. */
START_TEST(table_is_sound)
{
    const hf_field *field = hf_field_table;
    const hf_section *section = hf_section_table;
    for (int i = 0; i < hf_n_field; i++) {
        const char *dot = strrchr(field[i].path, '.');
        int n_match = !dot;
        for (int k = 0; dot && k < hf_n_section; k++)
            n_match += strlen(section[k].path) == (size_t)(dot - field[i].path) &&
                       !strncmp(section[k].path, field[i].path, (size_t)(dot - field[i].path));
        ck_assert_msg(n_match == 1, "%s is in no section", field[i].path);
        check_field(&field[i]);
        for (int k = 0; k < i; k++)
            ck_assert_str_ne(field[i].path, field[k].path);
    }
    for (int i = 0; i < hf_n_list; i++)
        for (int k = 0; k < hf_list_table[i].n_field; k++)
            check_field(&hf_list_table[i].field[k]);
}
END_TEST

/* Change the value at `to` in one of several ways; false when the type has no such way. */
static bool change(const hf_field *field, int way, void *to)
{
    hf_double_list *list = to;
    switch (field->type) {
    case HF_FIELD_DOUBLE:
        *(double *)to = way ? -*(double *)to - 1 : nextafter(*(double *)to, INFINITY);
        return way < 2;
    case HF_FIELD_INT:
    case HF_FIELD_WORD:
        *(int *)to ^= way ? 1 << 30 : 1;
        return way < 2;
    case HF_FIELD_UINT64:
        *(uint64_t *)to ^= way ? (uint64_t)1 << 63 : 1;
        return way < 2;
    case HF_FIELD_INT_PAIR:
        if (way < 2) ((int *)to)[way]++;
        return way < 2;
    case HF_FIELD_AMOUNT:
    case HF_FIELD_BOUNDS:
        if (way < 2) ((double *)to)[way] = 7;
        return way < 2;
    case HF_FIELD_VECTOR:
        if (way < 3) ((double *)to)[way] = 7;
        return way < 3;
    case HF_FIELD_TEXT:
    case HF_FIELD_SET:
        strcpy(to, way ? "b" : "");
        return way < 2;
    case HF_FIELD_DOUBLE_LIST:
        if (way < list->n)
            list->value[way] += 1;
        else
            list->n--;
        return way <= HF_LIST_MAX;
    }
    return false;
}

START_TEST(a_difference_in_any_key_is_named)
{
    hf_case a, b;
    char text[256], said[1000];
    ck_assert_int_eq(load(CYLINDER, NULL, 0, &a, said, sizeof said), HF_OK);
    for (int i = 0; i < hf_n_field; i++) {
        const hf_field *field = &hf_field_table[i];
        void *in_a = (char *)&a + field->offset, *in_b = (char *)&b + field->offset;
        if (field->type == HF_FIELD_DOUBLE_LIST)
            *(hf_double_list *)in_a = (hf_double_list){8, {1, 2, 3, 4, 5, 6, 7, 8}};
        if (field->type == HF_FIELD_TEXT || field->type == HF_FIELD_SET) strcpy(in_a, "a");
        int way = 0;
        for (b = a; change(field, way, in_b); b = a, way++) {
            ck_assert_msg(hf_config_differences(&a, &b, text, sizeof text) == 1, "%s, change %d: '%s'", field->path,
                          way, text);
            ck_assert_str_eq(text, field->path);
        }
        ck_assert_int_ge(way, 2);
        if (field->type != HF_FIELD_DOUBLE_LIST) continue;
        ((hf_double_list *)in_a)->n = ((hf_double_list *)in_b)->n = 7; /* entries beyond n do not count */
        ((hf_double_list *)in_b)->value[7] = 9;
        ck_assert_int_eq(hf_config_differences(&a, &b, text, sizeof text), 0);
    }
    hf_case_free(&a);
}
END_TEST

Suite *suite_unit_config(void)
{
    Suite *suite = suite_create("unit/config");
    TCase *tests = tcase_create("config");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, defaults_hold_where_nothing_is_said);
    tcase_add_test(tests, every_value_reaches_its_place);
    tcase_add_test(tests, overrides_win_and_change_the_digest);
    tcase_add_test(tests, the_last_of_equal_overrides_wins);
    tcase_add_test(tests, paths_are_relative_to_the_case_file);
    tcase_add_test(tests, anchors_work);
    tcase_add_test(tests, both_kinds_of_scene_are_made);
    tcase_add_test(tests, table_is_sound);
    tcase_add_test(tests, each_path_has_a_description);
    tcase_add_test(tests, a_difference_in_any_key_is_named);
    return suite;
}
