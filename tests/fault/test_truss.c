/* The tests make each allocation between a case and a truss that carries its net fail once. The call must return
 * HF_NO_MEMORY with a message and leak nothing (the run under the sanitizers checks that). */
#include "trusses.h"

#include <hifdm/carrier.h>
#include <hifdm/store.h>

/* 0: over the small net of a generated truss, 1: the same from files of more than 64 rows, 2: a ring. */
static void load(hf_case *c, hf_scene *scene, int kind)
{
    hf_messages messages = {0};
    const char *path = temp_path("c.yaml");
    FILE *nodes = fopen(temp_path("tn.csv"), "w"), *members = fopen(temp_path("m.csv"), "w");
    ck_assert(nodes && members);
    fputs("id,x_m,y_m,z_m,fixed\n", nodes);
    fputs("id,i,j,E_Pa,A_m2,G_Pa,Iy_m4,Iz_m4,J_m4\n", members);
    for (int i = 0; i <= 100; i++) {
        fprintf(nodes, "node-%d,%g,0,0,%s\n", i, i * 0.01, i ? "" : "all");
        if (i) fprintf(members, "m%d,node-%d,node-%d,1e9,1e-4,1e9,1e-8,1e-8,1e-8\n", i, i - 1, i);
    }
    fclose(nodes);
    fclose(members);
    write_file(path, kind == 2 ? "scene: {paraboloid: {aperture_m: 2, focal_length_m: 2, rings: 2, grid: quad, "
                                 "rear_distance_m: 1}}\ntruss: {ring: {}}\n"
                     : kind == 1
                         ? "scene: {parabolic_cylinder: {aperture_m: 2, length_m: 2, focal_length_m: 2, modules: [1, "
                           "1], cells_per_module: [2, 2]}}\n"
                           "truss: {match_tolerance_m: 10, import: {nodes: tn.csv, members: m.csv}}\n"
                         : "scene: {parabolic_cylinder: {aperture_m: 2, length_m: 2, focal_length_m: 2, modules: [2, "
                           "2], cells_per_module: [2, 2]}}\ntruss: {}\n");
    ck_assert_msg(hf_config_load(path, NULL, 0, c, &messages) == HF_OK, "%s", messages.text);
    ck_assert_int_eq(hf_config_scene(c, scene, &messages), HF_OK);
    hf_messages_free(&messages); /* a warning: the supports are in one plane */
}

START_TEST(building_a_carrier)
{
    hf_case c;
    hf_scene scene;
    long n;
    load(&c, &scene, _i);
    for (n = 1;; n++) {
        hf_carrier carrier;
        hf_messages messages = {0};
        fail_allocation_at(n);
        hf_status status = hf_config_carrier(&c, &scene, &carrier, &messages);
        bool failed = end_allocation_failure();
        char said[256];
        snprintf(said, sizeof said, "%s", messages.text ? messages.text : "");
        int n_error = messages.n_error;
        hf_carrier_free(&carrier);
        hf_messages_free(&messages);
        if (!failed) {
            ck_assert_msg(status == HF_OK, "%s", said);
            break;
        }
        ck_assert_msg(status == HF_NO_MEMORY, "allocation %ld: %s: %s", n, hf_status_word(status), said);
        ck_assert_int_eq(n_error, 1);
        ck_assert_msg(strstr(said, "out of memory") != NULL, "allocation %ld: %s", n, said);
    }
    ck_assert_int_ge(n, 8);
    hf_scene_free(&scene);
    hf_case_free(&c);
}
END_TEST

START_TEST(loading_a_carrier)
{
    hf_case c;
    hf_scene scene;
    hf_carrier carrier;
    hf_carrier_state state;
    hf_messages messages = {0};
    static const double force[27];
    load(&c, &scene, 0);
    ck_assert_int_eq(hf_config_carrier(&c, &scene, &carrier, &messages), HF_OK);
    fail_allocation_at(1);
    hf_status status = hf_carrier_load(&carrier, force, NULL, &state);
    ck_assert(end_allocation_failure());
    ck_assert_int_eq(status, HF_NO_MEMORY);
    hf_carrier_state_free(&state);
    hf_carrier_free(&carrier);
    hf_scene_free(&scene);
    hf_case_free(&c);
}
END_TEST

/* Writes a truss and reads it back, with another allocation of our own code failing each time. */
START_TEST(storing_and_reading)
{
    hf_case c;
    hf_scene scene;
    hf_carrier carrier;
    hf_carrier_state state;
    hf_messages messages = {0};
    hf_summary summary = {.has_truss = 1};
    double force[27];
    load(&c, &scene, 0);
    for (int k = 0; k < 27; k++)
        force[k] = 2.385 * k;
    hf_store_quiet();
    ck_assert_int_eq(hf_config_carrier(&c, &scene, &carrier, &messages), HF_OK);
    ck_assert_int_eq(hf_carrier_load(&carrier, force, NULL, &state), HF_OK);
    const char *path = temp_path("t.h5");
    bool failed = true;
    long n;
    for (n = 1; failed; n++) {
        hf_store *store;
        ck_assert_int_eq(hf_store_create(path, 1, &c, &scene, &carrier.truss, 0, NULL, &store, &messages), HF_OK);
        fail_allocation_at(n);
        hf_status status = hf_store_truss(store, &carrier, &state, &messages);
        failed = end_allocation_failure();
        ck_assert_int_eq(status, failed ? HF_NO_MEMORY : HF_OK);
        if (failed)
            hf_store_end(store);
        else
            ck_assert_int_eq(hf_store_finish(store, &summary, &messages), HF_OK);
    }
    ck_assert_int_ge(n, 4);
    failed = true;
    for (n = 1; failed; n++) {
        hf_truss t;
        hf_carrier_state s;
        fail_allocation_at(n);
        hf_status status = hf_store_read_truss(path, &t, &s, &messages);
        failed = end_allocation_failure();
        ck_assert_int_eq(status, failed ? HF_NO_MEMORY : HF_OK);
        if (failed) {
            ck_assert(t.block == NULL && s.block == NULL);
        } else {
            size_t n_node = (size_t)t.n_node, n_member = (size_t)t.n_member;
            ck_assert_int_eq(t.n_node, carrier.truss.n_node);
            ck_assert(!memcmp(t.fixed, carrier.truss.fixed, n_node));
            ck_assert(!memcmp(s.displacement, state.displacement, 6 * n_node * sizeof(double)));
            ck_assert(!memcmp(s.reaction, state.reaction, 6 * n_node * sizeof(double)));
            ck_assert(!memcmp(s.end_force, state.end_force, 12 * n_member * sizeof(double)));
            ck_assert_str_eq(t.member_id[t.n_member - 1], carrier.truss.member_id[t.n_member - 1]);
        }
        hf_truss_free(&t);
        hf_carrier_state_free(&s);
    }
    ck_assert_int_ge(n, 6);
    hf_messages_free(&messages);
    hf_carrier_state_free(&state);
    hf_carrier_free(&carrier);
    hf_scene_free(&scene);
    hf_case_free(&c);
}
END_TEST

Suite *suite_fault_truss(void)
{
    Suite *suite = suite_create("fault/truss");
    TCase *tests = tcase_create("truss");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, building_a_carrier, 0, 3);
    tcase_add_test(tests, loading_a_carrier);
    tcase_add_test(tests, storing_and_reading);
    return suite;
}
