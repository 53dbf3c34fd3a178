/* States of the net as built: what rows of `load_cases` say to a net and a truss, and their faults at file:line:col. */
#include "nets.h"

#include <hifdm/cable_set.h>
#include <hifdm/config.h>

#define NET                                                                                                            \
    "scene:\n"                                                                                                         \
    "  paraboloid: {aperture_m: 4, focal_length_m: 3, rings: 3, rear_distance_m: 1}\n"                                 \
    "  EA_inner_N: 1e5\n"                                                                                              \
    "  EA_boundary_N: 1e5\n"
#define CABLES NET "cables:\n  - {expansion_per_K: 2e-6, mass_kg_per_m: 0.003}\n"
#define TRUSS CABLES "truss: {ring: {height_m: 1}, expansion_per_K: 1e-6}\n"

struct read {
    hf_case c;
    hf_scene scene;
    hf_truss truss;
    hf_load_cases load_cases;
    char said[4000];
};

static hf_status read_load_cases(const char *text, const char *table, struct read *r)
{
    hf_messages messages = {0};
    char path[512], folder[512];
    *r = (struct read){0};
    snprintf(folder, sizeof folder, "%s", temp_path("nodes.csv"));
    write_file(folder, table);
    snprintf(path, sizeof path, "%s", temp_path("c.yaml"));
    write_file(path, text);
    hf_status status = hf_config_load(path, NULL, 0, &r->c, &messages);
    if (status == HF_OK) status = hf_config_scene(&r->c, &r->scene, &messages);
    if (status == HF_OK && r->c.has_truss) status = hf_config_truss(&r->c, &r->truss, &messages);
    if (status == HF_OK)
        status = hf_config_load_cases(&r->c, &r->scene, r->c.has_truss ? &r->truss : NULL, &r->load_cases, &messages);
    copy_without_folder(messages.text ? messages.text : "", r->said, sizeof r->said);
    hf_messages_free(&messages);
    return status;
}

static void free_read(struct read *r)
{
    hf_load_cases_free(&r->load_cases);
    hf_truss_free(&r->truss);
    hf_scene_free(&r->scene);
    hf_case_free(&r->c);
}

static bool is_in_set(const hf_scene *s, const char *set, int e)
{
    return hf_cable_set_has(s, hf_cable_set_find(s, set), e);
}

/* The last row that names a cable or a member holds; gradients count from the origin. */
START_TEST(temperatures_by_set_and_part)
{
    struct read r;
    ck_assert_msg(read_load_cases(TRUSS
                                  "load_cases:\n"
                                  "  - {name: cold, temperature_K: -100}\n"
                                  "  - {name: sun, gradient_K_per_m: [10, 0, 0], part: net}\n"
                                  "  - {name: cold, set: front, temperature_K: -120}\n"
                                  "  - {name: cold, part: truss, temperature_K: -60}\n"
                                  "  - {name: cold, part: vertical, temperature_K: -50, gradient_K_per_m: [0, 0, 2]}\n",
                                  "", &r) == HF_OK,
                  "%s", r.said);
    ck_assert_str_eq(r.said, "");
    ck_assert_int_eq(r.load_cases.n, 2);
    const hf_load_case *cold = &r.load_cases.load_case[0], *sun = &r.load_cases.load_case[1];
    ck_assert_str_eq(cold->name, "cold");
    ck_assert_str_eq(sun->name, "sun");
    for (int e = 0; e < r.scene.n_cable; e++) {
        const double *a = r.scene.position_m + 3 * r.scene.end[2 * e],
                     *b = r.scene.position_m + 3 * r.scene.end[2 * e + 1];
        ck_assert_double_eq(cold->rise_K[e], is_in_set(&r.scene, "front", e) ? -120 : -100);
        ck_assert_double_eq_tol(sun->rise_K[e], 10 * (a[0] + b[0]) / 2, 1e-12);
    }
    for (int e = 0; e < r.truss.n_member; e++) {
        const double *p = r.truss.position_m;
        double z = (p[3 * r.truss.end[2 * e] + 2] + p[3 * r.truss.end[2 * e + 1] + 2]) / 2;
        ck_assert_double_eq_tol(cold->member_rise_K[e], r.truss.unit[e] == HF_UNIT_VERTICAL ? -50 + 2 * z : -60, 1e-12);
        ck_assert(sun->member_rise_K[e] == 0);
    }
    free_read(&r);
}
END_TEST

START_TEST(gravity_forces_and_moves_add_up)
{
    struct read r;
    ck_assert_msg(read_load_cases(CABLES "load_cases:\n"
                                         "  - {name: a, gravity_m_per_s2: 10, direction: [0, 3, -4]}\n"
                                         "  - {name: a, force_N: [1, 0, 0], role: inner}\n"
                                         "  - {name: a, force_N: [0, 2, 0], support_displacement_m: [0, 0, 0.1]}\n"
                                         "  - {name: a, nodes: nodes.csv}\n"
                                         "  - {name: b, gravity_m_per_s2: 2, temperature_K: 0}\n",
                                  "id,Fz_N,dz_m\nf0_0,5,\nf3_0,,0.25\n", &r) == HF_OK,
                  "%s", r.said);
    const hf_load_case *a = &r.load_cases.load_case[0];
    ck_assert_double_eq_tol(a->gravity_m_per_s2[1], 6, 1e-14);
    ck_assert_double_eq_tol(a->gravity_m_per_s2[2], -8, 1e-14);
    ck_assert(r.load_cases.load_case[1].gravity_m_per_s2[2] == -2 &&
              r.load_cases.load_case[1].gravity_m_per_s2[0] == 0);
    for (int i = 0; i < r.scene.n_node; i++) {
        bool is_support = r.scene.role[i] == HF_ROLE_SUPPORT;
        ck_assert(a->force_N[3 * i] == (r.scene.role[i] == HF_ROLE_INNER) && a->force_N[3 * i + 1] == 2);
        ck_assert(a->force_N[3 * i + 2] == (strcmp(r.scene.node_id[i], "f0_0") ? 0 : 5));
        ck_assert_double_eq_tol(a->support_displacement_m[3 * i + 2],
                                (is_support ? 0.1 : 0) + (strcmp(r.scene.node_id[i], "f3_0") ? 0 : 0.25), 1e-15);
    }
    free_read(&r);
}
END_TEST

START_TEST(without_rows_there_is_nothing)
{
    struct read r;
    ck_assert_int_eq(read_load_cases(NET, "", &r), HF_OK);
    ck_assert(r.load_cases.n == 0 && !r.load_cases.block && !r.load_cases.material.block);
    free_read(&r);
}
END_TEST

static const struct {
    const char *text, *table, *said;
} fault[] = {
    {CABLES "load_cases:\n  - {name: 'a b', temperature_K: 1}\n", "",
     "error: c.yaml:8:12: load_cases.0.name: must be made of letters, digits, _ and -, and not begin with -\n"},
    {CABLES "load_cases:\n  - {name: name, temperature_K: 1}\n", "",
     "error: c.yaml:8:12: load_cases.0.name: must be another word than name, nominal and all\n"},
    {CABLES "load_cases:\n  - {name: a}\n", "",
     "error: c.yaml:8:12: load_cases.0.name: this row says nothing; give temperature_K, gradient_K_per_m, "
     "gravity_m_per_s2, "
     "force_N, support_displacement_m or nodes\n"
     "error: c.yaml:6:23: cables.0.expansion_per_K: has no effect: no row of load_cases has a temperature\n"},
    {CABLES "load_cases:\n  - {temperature_K: 1}\n", "",
     "error: c.yaml:8:5: load_cases.0.name: is missing and has no default\n"},
    {CABLES "load_cases:\n  - {name: a, temperature_K: 1, set: fornt}\n", "",
     "error: c.yaml:8:38: load_cases.0.set: this net has no cable set 'fornt'; did you mean 'front'?\n"},
    {CABLES "load_cases:\n  - {name: a, temperature_K: 1, part: truss}\n", "",
     "error: c.yaml:8:39: load_cases.0.part: the case has no truss\n"},
    {TRUSS "load_cases:\n  - {name: a, temperature_K: 1, part: mbug}\n", "",
     "error: c.yaml:9:39: load_cases.0.part: the truss has no members of the unit 'mbug'\n"},
    {CABLES "load_cases:\n  - {name: a, temperature_K: 1, part: net, set: tie}\n", "",
     "error: c.yaml:8:39: load_cases.0.part: does not go with set: a row names cables or members\n"},
    {CABLES "load_cases:\n  - {name: a, temperature_K: 1}\n  - {name: a, temperature_K: 2}\n", "",
     "error: c.yaml:9:30: load_cases.1.temperature_K: load_cases.0 has it for this load case already\n"},
    {CABLES "load_cases:\n  - {name: a, temperature_K: 1}\n  - {name: b, set: tie, force_N: [1, 0, 0]}\n", "",
     "error: c.yaml:9:20: load_cases.1.set: has no meaning without temperature_K or gradient_K_per_m\n"},
    {CABLES "load_cases:\n  - {name: a, temperature_K: 1, direction: [0, 0, 1], role: edge}\n", "",
     "error: c.yaml:8:44: load_cases.0.direction: has no meaning without gravity_m_per_s2\n"
     "error: c.yaml:8:61: load_cases.0.role: has no meaning without force_N\n"},
    {CABLES "load_cases:\n  - {name: a, temperature_K: 1, gravity_m_per_s2: 1, direction: [0, 0, 0]}\n", "",
     "error: c.yaml:8:65: load_cases.0.direction: must not be zero\n"},
    {CABLES "load_cases:\n  - {name: a, temperature_K: 1, force_N: [0, 1]}\n", "",
     "error: c.yaml:8:42: load_cases.0.force_N: must be a list of three numbers, along x, y and z, like [0, 0, -1]\n"},
    {NET "load_cases:\n  - {name: a, temperature_K: 1}\n", "",
     "error: c.yaml:6:30: load_cases.0.temperature_K: 163 cables have no thermal expansion coefficient, such as cable "
     "'f0_0-f1_0'. In the list `cables`, give expansion_per_K for these cables (0 for cables that do not expand)\n"},
    {NET "cables:\n  - {expansion_per_K: 1e-2}\nload_cases:\n  - {name: a, temperature_K: -200}\n", "",
     "error: c.yaml:8:30: load_cases.0.temperature_K: the lengths of 163 cables would change by more than the fraction "
     "0.1. For example, the length of cable 'f0_0-f1_0' would change by the fraction -2 at -200 K. Check this "
     "temperature and the value expansion_per_K\n"},
    {NET "cables:\n  - {set: front, mass_kg_per_m: 1}\nload_cases:\n  - {name: a, gravity_m_per_s2: 1}\n", "",
     "error: c.yaml:8:33: load_cases.0.gravity_m_per_s2: 121 cables have no mass per length, such as cable "
     "'f2_0-f3_17'. In the list `cables`, give mass_kg_per_m for these cables (0 for cables without mass)\n"},
    {NET "truss: {ring: {height_m: 1}}\ncables: [{expansion_per_K: 0}]\nload_cases:\n  - {name: a, temperature_K: 1}\n",
     "",
     "error: c.yaml:8:30: load_cases.0.temperature_K: the truss has no thermal expansion coefficient. Add the key "
     "truss.expansion_per_K (0 for a truss that does not expand), or part: net for a temperature of the cables "
     "alone\n"},
    {"scene: {paraboloid: {aperture_m: 4, focal_length_m: 3, rings: 3, rear_distance_m: 1}}\nload_cases:\n  - {name: "
     "a, "
     "force_N: [0, 0, 1]}\n",
     "",
     "error: c.yaml:3:12: load_cases.0.name: 163 cables have no stiffness EA, such as 'f0_0-f1_0', but load cases of "
     "the as-built net need this stiffness. Add the keys scene.EA_inner_N and scene.EA_boundary_N, or add the column "
     "EA_N to the table of an imported net\n"},
    {NET "load_cases:\n  - {name: a, force_N: [0, 0, 1], role: edge}\n  - {name: b, nodes: nodes.csv}\n",
     "id,Fx_N,dx_m\nf0_0,1,2\nzz,3,4\nf3_0,x,\nf3_0,1,\n",
     "error: nodes.csv:5: 'f3_0': this id was used before, on line 4\n"
     "error: nodes.csv:2: 'f0_0': is no support, so it has no place to be moved to: dx_m\n"
     "error: nodes.csv:3: 'zz': the net has no node with this id\n"
     "error: nodes.csv:4: 'f3_0': Fx_N must be a finite number, not x\n"},
    {NET "load_cases:\n  - {name: b, nodes: nodes.csv}\n", "id,x_m\nf0_0,1\n",
     "warning: nodes.csv:1: column 'x_m' is not used; did you mean 'dx_m'?\nerror: nodes.csv:1: the table gives no "
     "loads, because it has none of the columns Fx_N, Fy_N, Fz_N, dx_m, dy_m, dz_m\n"},
    {NET "load_cases:\n  - {name: b, nodes: other.csv}\n", "",
     "error: other.csv: cannot open: No such file or directory\n"},
};

START_TEST(faults_have_their_place)
{
    struct read r;
    ck_assert_int_eq(read_load_cases(fault[_i].text, fault[_i].table, &r), HF_BAD_CASE);
    ck_assert_str_eq(r.said, fault[_i].said);
    free_read(&r);
}
END_TEST

START_TEST(there_are_at_most_sixteen_load_cases)
{
    struct read r;
    char text[4000] = CABLES "load_cases:\n";
    for (int k = 0; k < 17; k++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "  - {name: s%d, temperature_K: 1}\n", k);
    ck_assert_int_eq(read_load_cases(text, "", &r), HF_BAD_CASE);
    ck_assert_str_eq(r.said, "error: c.yaml:24:12: load_cases.16.name: there are more than 16 load cases\n");
    free_read(&r);
}
END_TEST

Suite *suite_unit_config_load_cases(void)
{
    Suite *suite = suite_create("unit/config_states");
    TCase *tcase = tcase_create("config_states");
    tcase_add_test(tcase, temperatures_by_set_and_part);
    tcase_add_test(tcase, gravity_forces_and_moves_add_up);
    tcase_add_test(tcase, without_rows_there_is_nothing);
    tcase_add_loop_test(tcase, faults_have_their_place, 0, (int)(sizeof fault / sizeof *fault));
    tcase_add_test(tcase, there_are_at_most_sixteen_load_cases);
    suite_add_tcase(suite, tcase);
    return suite;
}
