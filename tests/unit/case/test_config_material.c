/* What cables and nodes are made of: rows of `cables` and `nodes`, and their faults at file:line:col. */
#include "nets.h"

#include <hifdm/cable_set.h>
#include <hifdm/config.h>

#define NET                                                                                                            \
    "scene:\n"                                                                                                         \
    "  paraboloid: {aperture_m: 4, focal_length_m: 3, rings: 3, rear_distance_m: 1}\n"

static hf_status read_material(const char *text, hf_scene *scene, hf_material *t, char *said, size_t size)
{
    hf_messages messages = {0};
    hf_case c;
    const char *path = temp_path("c.yaml");
    write_file(path, text);
    *scene = (hf_scene){0};
    *t = (hf_material){0};
    hf_status status = hf_config_load(path, NULL, 0, &c, &messages);
    if (status == HF_OK) status = hf_config_scene(&c, scene, &messages);
    if (status == HF_OK) status = hf_config_material(&c, scene, t, &messages);
    copy_without_folder(messages.text ? messages.text : "", said, size);
    hf_messages_free(&messages);
    hf_case_free(&c);
    return status;
}

START_TEST(later_rows_replace_earlier_ones)
{
    char said[2000];
    hf_scene s;
    hf_material t;
    int n_tie = 0;
    ck_assert_int_eq(read_material(NET "cables:\n"
                                       "  - {expansion_per_K: 2e-6, mass_kg_per_m: 0.003}\n"
                                       "  - {set: tie, expansion_per_K: -1e-6}\n"
                                       "nodes:\n"
                                       "  - {mass_kg: 0.5}\n"
                                       "  - {role: support, mass_kg: 0}\n"
                                       "load_cases: [{name: cold, temperature_K: -1}]\n",
                                   &s, &t, said, sizeof said),
                     HF_OK);
    ck_assert_str_eq(said, "");
    for (int e = 0; e < s.n_cable; e++) {
        bool is_tie = hf_cable_set_has(&s, hf_cable_set_find(&s, "tie"), e);
        n_tie += is_tie;
        ck_assert(t.expansion_per_K[e] == (is_tie ? -1e-6 : 2e-6) && t.mass_kg_per_m[e] == 0.003);
    }
    ck_assert_int_gt(n_tie, 0);
    for (int i = 0; i < s.n_node; i++)
        ck_assert(t.node_mass_kg[i] == (s.role[i] == HF_ROLE_SUPPORT ? 0 : 0.5));
    hf_material_free(&t);
    hf_scene_free(&s);
}
END_TEST

START_TEST(what_is_not_said_is_not_known)
{
    char said[2000];
    hf_scene s;
    hf_material t;
    ck_assert_int_eq(read_material(NET "cables:\n  - {set: boundary, mass_kg_per_m: 0.1}\n", &s, &t, said, sizeof said),
                     HF_OK);
    for (int e = 0; e < s.n_cable; e++) {
        ck_assert(isnan(t.expansion_per_K[e]));
        ck_assert(s.group[e] == HF_GROUP_BOUNDARY ? t.mass_kg_per_m[e] == 0.1 : isnan(t.mass_kg_per_m[e]));
    }
    hf_material_free(&t);
    hf_scene_free(&s);
}
END_TEST

START_TEST(faults_have_their_place)
{
    static const struct {
        const char *text, *said;
    } fault[] = {
        {NET "cables:\n  - {set: ties, mass_kg_per_m: 1}\n",
         "error: c.yaml:4:11: cables.0.set: this net has no cable set 'ties'; did you mean 'tie'?\n"},
        {NET "cables:\n  - {set: tie}\n", "error: c.yaml:4:11: cables.0.set: says nothing of these cables; give "
                                          "expansion_per_K, mass_kg_per_m or both\n"},
        {NET "cables: {set: tie}\n",
         "error: c.yaml:3:9: cables: must be a list of rows, each a line '- {key: value, ...}'\n"},
        {NET "nodes:\n  - {role: inner}\n", "error: c.yaml:4:5: nodes.0.mass_kg: is missing and has no default\n"},
        {NET "nodes:\n  - {role: inner, mass_kg: -1}\n",
         "error: c.yaml:4:28: nodes.0.mass_kg: must be at least 0 and at most 1000000, not -1\n"},
    };
    for (size_t i = 0; i < sizeof fault / sizeof *fault; i++) {
        char said[2000];
        hf_scene s;
        hf_material t;
        ck_assert_int_eq(read_material(fault[i].text, &s, &t, said, sizeof said), HF_BAD_CASE);
        ck_assert_str_eq(said, fault[i].said);
        hf_material_free(&t);
        hf_scene_free(&s);
    }
}
END_TEST

Suite *suite_unit_config_material(void)
{
    Suite *suite = suite_create("unit/config_material");
    TCase *tcase = tcase_create("config_material");
    tcase_add_test(tcase, later_rows_replace_earlier_ones);
    tcase_add_test(tcase, what_is_not_said_is_not_known);
    tcase_add_test(tcase, faults_have_their_place);
    suite_add_tcase(suite, tcase);
    return suite;
}
