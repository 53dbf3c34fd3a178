/* Two published force-density nets, read from files and imported; their shapes and forces are compared.
 *
 * Source: arpastrana/jax_fdm (MIT), commit 71d4490, tests/data/reference/{stuttgart21,olympia}-{nodes,edges}.csv,
 * results of "an independent structural-analysis solver". stuttgart21 is all in tension; olympia has struts (q < 0).
 * The reference coordinates and forces have 9 to 10 digits, so the tolerance is 1e-8 of the net's size and of each
 * force. */
#include "figures.h"
#include "reference.h"

static const struct {
    const char *name;
    int n_node, n_cable, has_strut;
} nets[] = {{"stuttgart21", 98, 168, 0}, {"olympia", 102, 166, 1}};

/* One line "id,number,..." of the expected file that is not a comment; the number of values read. */
static int next_line(FILE *file, char id[16], double value[3])
{
    char line[256];
    do
        if (!fgets(line, sizeof line, file)) return 0;
    while (*line == '#');
    return sscanf(line, "%15[^,],%lf,%lf,%lf", id, value, value + 1, value + 2) - 1;
}

START_TEST(coordinates_and_forces)
{
    struct net net;
    open_reference(&net, nets[_i].name, "method: fdm, residual_tolerance: 1e-12");
    ck_assert_int_eq(net.scene.n_node, nets[_i].n_node);
    ck_assert_int_eq(net.scene.n_cable, nets[_i].n_cable);
    ck_assert_int_eq(net.model.has_strut, nets[_i].has_strut);
    ck_assert_msg(find_shape(&net) == HF_OK, "%s", hf_status_word(net.result.status));
    ck_assert_int_eq(net.result.iterations, 1);

    double size_m = 0, value[3], worst_m = 0, worst_force = 0;
    for (int k = 0; k < 3 * net.scene.n_node; k++)
        size_m = fmax(size_m, fabs(net.scene.position_m[k]));
    char expected_path[128], id[16];
    snprintf(expected_path, sizeof expected_path, "tests/verify/data/%s_expected.csv", nets[_i].name);
    FILE *file = fopen(source_path(expected_path), "r");
    ck_assert_ptr_nonnull(file);
    ck_assert_int_eq(next_line(file, id, value), 0); /* header */
    for (int i = 0; i < net.scene.n_node; i++) {
        ck_assert_int_eq(next_line(file, id, value), 3);
        ck_assert_str_eq(id, net.scene.node_id[i]);
        for (int c = 0; c < 3; c++)
            worst_m = fmax(worst_m, fabs(found_m(&net, i, c) - value[c]));
    }
    ck_assert_int_eq(next_line(file, id, value), 0);
    for (int e = 0; e < net.scene.n_cable; e++) {
        ck_assert_int_eq(next_line(file, id, value), 1);
        ck_assert_str_eq(id, net.scene.cable_id[e]);
        worst_force = fmax(worst_force, fabs(net.work.tension_N[e] / value[0] - 1));
    }
    VERIFY_WORST(worst_m, 1e-8 * size_m, "%s: coordinates of %d nodes, m", nets[_i].name, net.scene.n_node);
    VERIFY_WORST(worst_force, 1e-8, "%s: forces of %d cables, in parts of each", nets[_i].name, net.scene.n_cable);
    fclose(file);
    close_net(&net);
}
END_TEST

Suite *suite_verify_forcedensity(void)
{
    Suite *suite = suite_create("verify/forcedensity");
    TCase *tests = tcase_create("forcedensity");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, coordinates_and_forces, 0, 2);
    return suite;
}
