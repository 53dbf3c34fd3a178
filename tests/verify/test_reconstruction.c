/* Three nets that give the printed figures of the paper, from the keys of the generator.
 *
 * Source of the tables: a search over 768 imported nets, made by another program; data/limits/triangles_{a,b,c}. Their
 * focal lengths and scallops are calibrated on the paper's psi of 6.6 mm and boundary ratio of 4.8445, and read off the
 * tables here: f = 25/(4 z) of a corner, scallop = rise/span of the first edge. Figures by that program, at the paper's
 * stop: psi 6.614, 6.604, 6.593 mm, inner ratio 1.0000, 1.0001, 1.0002, boundary ratio 4.846, 4.842, 4.833; held to
 * half a unit of their last digit. */
#include "figures.h"
#include "nets.h"

#include "net/scene_import.h"

static const struct {
    const char *file;
    hf_cylinder c;
    double psi_mm, inner_ratio, boundary_ratio;
} nets[] = {
    {"a",
     {.focal_length_m = 458.924208982529,
      .scallop = 0.113401206248162,
      .modules = {3, 3},
      .cells_per_module = {1, 2},
      .pattern = HF_PATTERN_TRIANGLE,
      .supports = HF_SUPPORTS_MODULE_CORNERS,
      .edge_tie_m = 0.1},
     6.614,
     1.0000,
     4.846},
    {"b",
     {.focal_length_m = 242.244555706559,
      .scallop = 0.0758665519960033,
      .modules = {1, 2},
      .cells_per_module = {6, 2},
      .pattern = HF_PATTERN_TRIANGLE,
      .supports = HF_SUPPORTS_RIBS,
      .edge_tie_m = 0.15},
     6.604,
     1.0001,
     4.842},
    {"c",
     {.focal_length_m = 154.09689404534,
      .scallop = 0.0524282744218751,
      .modules = {1, 5},
      .cells_per_module = {6, 2},
      .pattern = HF_PATTERN_ALTERNATING,
      .supports = HF_SUPPORTS_RIBS,
      .edge_tie_m = 0.1},
     6.593,
     1.0002,
     4.833},
};

/* Index of a node of the tables in the generated net, where supports of edge ties are s<i>_<j>, not ns_<i>_<j>. */
static int generated_node(const hf_scene *s, const char *id)
{
    char own[32];
    snprintf(own, sizeof own, "%s", strncmp(id, "ns_", 3) ? id : id + 1);
    if (own[0] == 's') memmove(own + 1, own + 2, strlen(own + 1));
    for (int k = 0; k < s->n_node; k++)
        if (!strcmp(s->node_id[k], own)) return k;
    ck_abort_msg("no node %s", own);
    return -1;
}

static void demand_same_cables(const hf_scene *generated, const hf_scene *table, const int *node)
{
    ck_assert_int_eq(generated->n_cable, table->n_cable);
    for (int e = 0; e < table->n_cable; e++) {
        int a = node[table->end[2 * e]], b = node[table->end[2 * e + 1]], n = 0;
        for (int k = 0; k < generated->n_cable; k++) {
            const int *end = generated->end + 2 * k;
            if (!(end[0] == a && end[1] == b) && !(end[0] == b && end[1] == a)) continue;
            n++;
            ck_assert_int_eq(generated->group[k], table->group[e]);
            ck_assert_int_eq(generated->law[k], table->law[e]);
            if (table->law[e] == HF_LAW_LENGTH)
                ck_assert_double_eq_tol(generated->target[k], table->target[e], 2e-14);
            else
                ck_assert(isnan(generated->target[k]) && isnan(table->target[e]));
        }
        ck_assert_msg(n == 1, "%d cables like %s", n, table->cable_id[e]);
    }
}

START_TEST(node_by_node_and_cable_by_cable)
{
    char nodes[256], cables[256];
    hf_messages messages = {0};
    hf_scene generated, table;
    hf_cylinder c = nets[_i].c;
    c.aperture_m = 10;
    c.length_m = 12;
    snprintf(nodes, sizeof nodes, "tests/verify/data/limits/triangles_%s_nodes.csv", nets[_i].file);
    snprintf(cables, sizeof cables, "tests/verify/data/limits/triangles_%s_cables.csv", nets[_i].file);
    char *nodes_path = strdup(source_path(nodes)), *cables_path = strdup(source_path(cables));
    ck_assert_msg(hf_scene_import(nodes_path, cables_path, (const double[2]){0}, &table, &messages) == HF_OK, "%s",
                  messages.text);
    free(nodes_path);
    free(cables_path);
    ck_assert_msg(hf_scene_parabolic_cylinder(&c, NULL, &generated, &messages) == HF_OK, "%s", messages.text);
    ck_assert_int_eq(generated.n_node, table.n_node);
    int node[128];
    ck_assert_int_le(table.n_node, 128);
    for (int k = 0; k < table.n_node; k++) {
        node[k] = generated_node(&generated, table.node_id[k]);
        ck_assert_int_eq(generated.role[node[k]], table.role[k]);
        for (int d = 0; d < 3; d++) /* the table has 15 digits */
            ck_assert_double_eq_tol(generated.position_m[3 * node[k] + d], table.position_m[3 * k + d], 1e-14);
    }
    demand_same_cables(&generated, &table, node);
    hf_scene_free(&table);
    hf_scene_free(&generated);
}
END_TEST

START_TEST(figures_of_the_search)
{
    struct net net = {.form = tight_form(HF_METHOD_HIFDM)};
    hf_messages messages = {0};
    hf_cylinder c = nets[_i].c;
    c.aperture_m = 10;
    c.length_m = 12;
    net.form.stop = HF_STOP_RMS_CHANGE;
    net.form.residual_tolerance = 1e-8;
    net.form.max_iterations = 1500;
    ck_assert_int_eq(hf_scene_parabolic_cylinder(&c, NULL, &net.scene, &messages), HF_OK);
    open_net(&net);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_RMS_CHANGE);
    VERIFY(1e3 * net.result.psi_m, nets[_i].psi_mm, 0.5e-3, "net %s: psi, mm", nets[_i].file);
    VERIFY(net.result.inner_tension_ratio, nets[_i].inner_ratio, 0.5e-4, "net %s: ratio inside", nets[_i].file);
    VERIFY(net.result.boundary_tension_ratio, nets[_i].boundary_ratio, 0.5e-3, "net %s: boundary ratio", nets[_i].file);
    close_net(&net);
}
END_TEST

Suite *suite_verify_reconstruction(void)
{
    Suite *suite = suite_create("verify/reconstruction");
    TCase *tests = tcase_create("reconstruction");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, node_by_node_and_cable_by_cable, 0, 3);
    tcase_add_loop_test(tests, figures_of_the_search, 0, 3);
    return suite;
}
