/* The cable net of the jax_fdm page, designed by 220 force densities.
 *
 * Source: arpastrana/jax_fdm, documentation, example "cable net": a grid of 10 x 10 m with 10 x 10 cells, its corners
 * supports, two opposite ones lifted to 5 m; over the lifted lengths, edge cables have 20 kN and the others 1 kN as
 * force densities. It prints edge forces of 15.1608 to 18.2654 kN, inner lengths of 0.7938 to 1.8030 m, a loss of
 * 12.69522 = mean (T_edge - 20 kN)^2 + mean (l_inner - 1 m)^2, and what its optimiser makes of it with force densities
 * of 0.1 kN/m at least: 0.000804. */
#include "figures.h"
#include "nets.h"

#include <hifdm/run.h>

enum { N_CELL = 10 };

static double height_m(int i, int j)
{
    return i == j && i % N_CELL == 0 ? 5 : 0;
}

static void write_tables(const char *nodes_path, const char *cables_path)
{
    FILE *nodes = fopen(nodes_path, "w"), *cables = fopen(cables_path, "w");
    ck_assert(nodes && cables);
    fprintf(nodes, "id,x_m,y_m,z_m,role\n");
    fprintf(cables, "id,i,j,group,law,value,set\n");
    for (int i = 0; i <= N_CELL; i++)
        for (int j = 0; j <= N_CELL; j++) {
            bool is_corner = i % N_CELL == 0 && j % N_CELL == 0;
            fprintf(nodes, "n%d_%d,%d,%d,%g,%s\n", i, j, i, j, height_m(i, j), is_corner ? "support" : "inner");
            for (int along = 0; along < 2; along++) {
                int k = i + !along, l = j + along;
                if (k > N_CELL || l > N_CELL) continue;
                bool is_edge = (along ? i : j) % N_CELL == 0;
                double rise = height_m(k, l) - height_m(i, j), q = (is_edge ? 20e3 : 1e3) / sqrt(1 + rise * rise);
                fprintf(cables, "c%d_%d_%d,n%d_%d,n%d_%d,%s,force_density,%.17g,%s\n", i, j, along, i, j, k, l,
                        is_edge ? "boundary" : "inner", q, is_edge ? "edge" : "field");
            }
        }
    ck_assert(fclose(nodes) == 0 && fclose(cables) == 0);
}

static const char *written_case(void)
{
    const char *path = temp_path("case.yaml");
    write_tables(temp_path("nodes.csv"), temp_path("cables.csv"));
    write_file(path, "title: cable net of the jax_fdm page\n"
                     "scene: {import: {nodes: nodes.csv, cables: cables.csv}}\n"
                     "form: {pretension_N: 1000}\n"
                     "optimize:\n"
                     "  method: lm\n"
                     "  variables: [{set: all, vary: force_density, bounds: [100, null]}]\n"
                     "  objective:\n"
                     "    - {figure: tension, set: edge, target: 20000, weight: 1e-3}\n"
                     "    - {figure: length, set: field, target: 1}\n");
    return path;
}

START_TEST(it_starts_where_the_page_starts)
{
    struct net net;
    double range[2][2] = {{INFINITY, 0}, {INFINITY, 0}}, loss = 0;
    open_case_file(&net, written_case(), NULL, 0);
    ck_assert_int_eq(net.model.n_cable, 220);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    for (int e = 0; e < net.model.n_cable; e++) {
        bool is_edge = net.model.group[e] == HF_GROUP_BOUNDARY;
        double value = is_edge ? net.work.tension_N[e] / 1e3 : net.work.length_m[e], off = value - (is_edge ? 20 : 1);
        range[is_edge][0] = fmin(range[is_edge][0], value);
        range[is_edge][1] = fmax(range[is_edge][1], value);
        loss += off * off / (is_edge ? 4 * N_CELL : net.model.n_cable - 4 * N_CELL);
    }
    VERIFY(range[true][0], 15.1608, 0.5e-4, "least force of an edge, kN");
    VERIFY(range[true][1], 18.2654, 0.5e-4, "largest force of an edge, kN");
    VERIFY(range[false][0], 0.7938, 0.5e-4, "least inner length, m");
    VERIFY(range[false][1], 1.8030, 0.5e-4, "largest inner length, m");
    VERIFY(loss, 12.69522, 0.5e-5, "loss before the optimisation");
    close_net(&net);
}
END_TEST

/* In no more steps than it takes today, and a few: each is about 2 ms. */
START_TEST(it_ends_no_later_than_the_page)
{
    char output[HF_OUTPUT_SIZE];
    static hf_summary s;
    static const char *const set[] = {"optimize.refine_steps=19"};
    hf_messages said = {0};
    hf_run_request request = {
        .input = {written_case(), .set = set, .n_set = _i ? 0 : 1}, .output.no_file = true, .control.threads = 2};
    ck_assert_msg(hf_run_case(&request, &s, output, &said) == HF_OK, "%s", said.text);
    double loss = s.stage[HF_STAGE_REFINE].result.merit * s.stage[HF_STAGE_REFINE].result.merit;
    ck_assert_double_le(loss, _i ? 0.000712 : 0.000804);
    VERIFY_AT_MOST(loss, 0.000804, "loss after the optimisation, %s", _i ? "converged" : "19 steps");
    if (_i) ck_assert_int_eq(s.refine.algorithm_stop, HF_REFINE_CONVERGED);
    hf_messages_free(&said);
}
END_TEST

Suite *suite_verify_jax_fdm(void)
{
    Suite *suite = suite_create("verify/jax_fdm");
    TCase *tests = tcase_create("jax_fdm");
    tcase_add_test(tests, it_starts_where_the_page_starts);
    tcase_add_loop_test(tests, it_ends_no_later_than_the_page, 0, 2);
    suite_add_tcase(suite, tests);
    return suite;
}
