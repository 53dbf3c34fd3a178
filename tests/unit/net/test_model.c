/* The model: numbering and band places, laws and targets by method, genes, straight chains. */
#include "nets.h"

/* Supports 0 and 3, free nodes 1 and 2; one cable of each law. Numbers with simple lengths: 5, 13 and 10 m. */
static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                        {{3, 4, 0}, HF_ROLE_INNER, {0, 0, -2.385}},
                                        {{3, 9, 12}, HF_ROLE_EDGE, {0}},
                                        {{11, 3, 12}, HF_ROLE_SUPPORT, {0, 7, 0}}};
static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, (double)NAN},
                                          {{2, 1}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 12.5},
                                          {{3, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 0.75},
                                          {{3, 0}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 4}};

/* The same four cables under each method: law, target, first force density. Td = 10 N. */
static const struct {
    int method;
    double reference_N;
    struct {
        int law;
        double target, q;
    } of[4];
} expected[] = {
    {HF_METHOD_HIFDM,
     10,
     {{HF_LAW_TENSION, 10, 2},
      {HF_LAW_LENGTH, 12.5, 10.0 / 13},
      {HF_LAW_FORCE_DENSITY, 0.75, 0.75},
      {HF_LAW_TENSION, 4, 0}}},
    {HF_METHOD_ITERATIVE_FDM,
     10,
     {{HF_LAW_TENSION, 10, 2}, {HF_LAW_TENSION, 10, 10.0 / 13}, {HF_LAW_TENSION, 10, 1}, {HF_LAW_TENSION, 4, 0}}},
    {HF_METHOD_FDM,
     10,
     {{HF_LAW_FORCE_DENSITY, 2, 2},
      {HF_LAW_FORCE_DENSITY, 10.0 / 13, 10.0 / 13},
      {HF_LAW_FORCE_DENSITY, 0.75, 0.75},
      {HF_LAW_FORCE_DENSITY, 0, 0}}},
};

START_TEST(method_decides_laws_targets_and_first_force_densities)
{
    struct net net;
    OPEN_HAND(&net, node, cable, expected[_i].method);
    const hf_model *m = &net.model;
    double q3 = 4 / m->length_m[3]; /* hypot(11, 3, 12) is no simple number */
    for (int e = 0; e < 4; e++) {   /* one operation: to a few last bits */
        int held = expected[_i].of[e].law == HF_LAW_FORCE_DENSITY;
        ck_assert_int_eq(m->law[e], expected[_i].of[e].law);
        ck_assert_double_eq_tol(m->start_q_N_per_m[e], e == 3 ? q3 : expected[_i].of[e].q, 1e-15);
        ck_assert_double_eq_tol(m->target[e], e == 3 && held ? q3 : expected[_i].of[e].target, 1e-15);
    }
    ck_assert_double_eq_tol(m->reference_N, expected[_i].reference_N, 1e-14);
    ck_assert_double_eq(m->pretension_N, 10);
    ck_assert(!m->has_strut);
    close_net(&net);
}
END_TEST

START_TEST(model_mirrors_the_scene)
{
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    const hf_model *m = &net.model;
    ck_assert(m->n_node == 4 && m->n_free == 2 && m->n_cable == 4 && m->n_inner_node == 1);
    ck_assert_int_eq(m->half_bandwidth, 1);
    for (int i = 0; i < 4; i++) {
        int row = m->row_of_node[i];
        ck_assert_int_eq(row < m->n_free, node[i].role != HF_ROLE_SUPPORT);
        for (int c = 0; c < 3; c++) {
            ck_assert_double_eq(m->position_m[4 * c + row], node[i].position_m[c]);
            ck_assert_double_eq(m->load_N[4 * c + row], node[i].load_N[c]);
        }
    }
    for (int e = 0; e < 4; e++) {
        for (int k = 0; k < 2; k++)
            ck_assert_int_eq(m->node_of_row[m->end_row[2 * e + k]], cable[e].end[k]);
        ck_assert_int_eq(m->group[e], cable[e].group);
        ck_assert_double_eq(m->length_m[e], hf_scene_length_at_target(&net.scene, e));
    }
    ck_assert_int_eq(m->inner_row[0], m->row_of_node[1]);
    ck_assert_int_eq(m->n_variable, 1); /* cable 3 is boundary, but between supports */
    ck_assert_int_eq(m->variable_cable[0], 1);
    close_net(&net);
}
END_TEST

START_TEST(struts_are_noticed_and_get_room)
{
    struct hand_cable with_strut[4];
    struct net net;
    memcpy(with_strut, cable, sizeof cable);
    with_strut[2].target = -0.75;
    OPEN_HAND(&net, node, with_strut, HF_METHOD_FDM);
    ck_assert(net.model.has_strut);
    size_t with = hf_workspace_bytes(&net.model);
    net.model.has_strut = 0;
    ck_assert_uint_gt(with, hf_workspace_bytes(&net.model));
    net.model.has_strut = 1;
    close_net(&net);
}
END_TEST

START_TEST(pure_force_density_nets_have_a_reference_of_their_own)
{
    static const struct hand_cable held[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 3},
                                             {{2, 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, -2}};
    struct net net;
    OPEN_HAND(&net, node, held, HF_METHOD_HIFDM);
    ck_assert_double_eq(net.model.reference_N, 26); /* 2 N/m over 13 m beats 3 N/m over 5 m */
    close_net(&net);
}
END_TEST

START_TEST(the_model_does_not_need_the_scene)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    double psi_m = net.result.psi_m;
    memset(net.scene.position_m, 0x77, 3 * (size_t)net.scene.n_node * sizeof(double));
    hf_scene_free(&net.scene);
    ck_assert(model_is_valid(&net.model));
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_double_eq(net.result.psi_m, psi_m);
    close_net(&net);
}
END_TEST

/* Every single wrong index must show, otherwise model_is_valid guards nothing. */
START_TEST(every_damage_is_noticed)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    hf_model *m = &net.model;
    struct {
        const char *name;
        int *array, n;
    } index[] = {{"row_of_node", m->row_of_node, m->n_node},
                 {"node_of_row", m->node_of_row, m->n_node},
                 {"end_row", m->end_row, 2 * m->n_cable},
                 {"diagonal_a", m->diagonal_a, m->n_cable},
                 {"diagonal_b", m->diagonal_b, m->n_cable},
                 {"off_diagonal", m->off_diagonal, m->n_cable},
                 {"n_free", &m->n_free, 1},
                 {"half_bandwidth", &m->half_bandwidth, 1},
                 {"n_band", &m->n_band, 1}};
    for (size_t k = 0; k < sizeof index / sizeof *index; k++)
        for (int i = 0; i < index[k].n; i++) {
            int kept = index[k].array[i];
            index[k].array[i] = -1;
            ck_assert_msg(!model_is_valid(m), "%s[%d]", index[k].name, i);
            index[k].array[i] = kept + 1;
            int to_another_support = index[k].array == m->end_row && kept >= m->n_free; /* wrong, but a valid index */
            ck_assert_msg(!model_is_valid(m) || to_another_support, "%s[%d]", index[k].name, i);
            index[k].array[i] = kept;
        }
    m->inner_row[3] = m->n_free;
    ck_assert(!model_is_valid(m));
    close_net(&net);
}
END_TEST

/* ---- straight chains ---- */

/* Three cables of 1 m between supports 3 m apart; the middle one given `extra` m of excess. */
static int n_chain_with(double extra, int law_of_middle, int with_branch)
{
    static const struct hand_node row[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                           {{1, 0, 0}, HF_ROLE_EDGE, {0}},
                                           {{2, 0, 0}, HF_ROLE_INNER, {0}},
                                           {{3, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                           {{1, 1, 0}, HF_ROLE_SUPPORT, {0}}};
    struct hand_cable link[] = {{{0, 1}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1},
                                {{2, 1}, HF_GROUP_BOUNDARY, (hf_law)law_of_middle, 1 + extra},
                                {{2, 3}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1},
                                {{1, 4}, HF_GROUP_INNER, with_branch ? HF_LAW_LENGTH : HF_LAW_TENSION, 1}};
    struct net net;
    OPEN_HAND(&net, row, link, HF_METHOD_HIFDM);
    int n_chain = net.model.n_chain;
    if (n_chain == 1) {
        char name[64], cut[12];
        const hf_model *m = &net.model;
        ck_assert_int_eq(m->chain_start[1] - m->chain_start[0], 3);
        for (int k = 0; k < 3; k++)
            ck_assert_int_eq(m->chain_cable[k], k);
        for (int i = 0; i < 5; i++)
            ck_assert_int_eq(m->chain_of_row[m->row_of_node[i]], i == 1 || i == 2 ? 0 : -1);
        hf_model_chain_name(m, &net.scene, 0, name, sizeof name);
        ck_assert_str_eq(name, "c0 + c1 + c2");
        hf_model_chain_name(m, &net.scene, 0, cut, sizeof cut);
        ck_assert_str_eq(cut, "c0 + c1 ...");
    }
    close_net(&net);
    return n_chain;
}

START_TEST(straight_chains_are_found)
{
    ck_assert_int_eq(n_chain_with(0, HF_LAW_LENGTH, 0), 1);
    ck_assert_int_eq(n_chain_with(-0.1, HF_LAW_LENGTH, 0), 1); /* too short: worse than straight */
    ck_assert_int_eq(n_chain_with(1e-10, HF_LAW_LENGTH, 0), 1);
    ck_assert_int_eq(n_chain_with(1e-7, HF_LAW_LENGTH, 0), 0); /* slack of 1e-7 / 3 is enough to sag */
    ck_assert_int_eq(n_chain_with(0, HF_LAW_TENSION, 0), 0);   /* not one chain of law length */
    ck_assert_int_eq(n_chain_with(0, HF_LAW_LENGTH, 1), 0);    /* held at a node by a third one */
}
END_TEST

START_TEST(chains_of_the_papers_net)
{
    struct net net;
    OPEN_CASE(&net, "configs/straight-edges.yaml");
    /* 6 straight generatrix lines of 5 module edges; those along the directrix are polygons and not straight */
    ck_assert_int_eq(net.model.n_chain, 30);
    ck_assert_int_eq(net.model.n_variable, 120); /* 2 x 6 lines x 10 cables, all with a free end */
    close_net(&net);
    OPEN_CASE(&net, "configs/reflector.yaml");
    ck_assert_int_eq(net.model.n_chain, 0); /* scalloped */
    close_net(&net);
}
END_TEST

/* ---- groups of genes ---- */

/* Boundary cables c0-c1-c2 in a row, then c3 and c4 from the last free node, where three of them meet. */
START_TEST(genes_of_a_chain_are_one_group)
{
    static const struct hand_node row[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 0, 0}, HF_ROLE_EDGE, {0}},
                                           {{2, 0, 0}, HF_ROLE_EDGE, {0}},    {{3, 0, 0}, HF_ROLE_INNER, {0}},
                                           {{4, 1, 0}, HF_ROLE_SUPPORT, {0}}, {{4, -1, 0}, HF_ROLE_SUPPORT, {0}},
                                           {{1, 5, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable link[] = {
        {{1, 0}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 1}, {{1, 2}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 1},
        {{3, 2}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 1}, {{3, 4}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 1},
        {{5, 3}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 1}, {{1, 6}, HF_GROUP_INNER, HF_LAW_TENSION, 1}};
    static const int group[] = {0, 0, 0, 1, 2};
    struct net net;
    OPEN_HAND(&net, row, link, HF_METHOD_HIFDM);
    ck_assert_int_eq(net.model.n_variable, 5);
    ck_assert_int_eq(net.model.n_variable_group, 3);
    ck_assert_mem_eq(net.model.variable_group, group, sizeof group);
    close_net(&net);
}
END_TEST

START_TEST(groups_of_the_papers_net_are_module_edges)
{
    struct net net;
    OPEN_CASE(&net, "configs/straight-edges.yaml");
    int n_variable_of[120] = {0};
    ck_assert_int_eq(net.model.n_variable_group, 60);
    for (int k = 0; k < net.model.n_variable; k++)
        n_variable_of[net.model.variable_group[k]]++;
    for (int j = 0; j < 60; j++)
        ck_assert_int_eq(n_variable_of[j], 2);
    close_net(&net);
}
END_TEST

Suite *suite_unit_model(void)
{
    Suite *suite = suite_create("unit/model");
    TCase *tests = tcase_create("model");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, method_decides_laws_targets_and_first_force_densities, 0, 3);
    tcase_add_test(tests, model_mirrors_the_scene);
    tcase_add_test(tests, struts_are_noticed_and_get_room);
    tcase_add_test(tests, pure_force_density_nets_have_a_reference_of_their_own);
    tcase_add_test(tests, the_model_does_not_need_the_scene);
    tcase_add_test(tests, every_damage_is_noticed);
    tcase_add_test(tests, straight_chains_are_found);
    tcase_add_test(tests, chains_of_the_papers_net);
    tcase_add_test(tests, genes_of_a_chain_are_one_group);
    tcase_add_test(tests, groups_of_the_papers_net_are_module_edges);
    return suite;
}
