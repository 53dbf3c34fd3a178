/* What cannot be taken as it is printed is said: tension ratios of nets with slack cables. */
#include "cli.h"

/* ---- slack cables ---- */

/* A net in which the cable `ad` is too long to pull. */
#define SLACK_NODES                                                                                                    \
    "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,2,0,0.1,support\nc,1,2,0,support\nd,1,0.7,0.05,inner\n"                  \
    "e,1,1.2,0.05,inner\n"
#define SLACK_CABLES                                                                                                   \
    "id,i,j,group,law,value\nad,a,d,boundary,length,9\nbd,b,d,inner,tension,10\nde,d,e,inner,tension,10\n"            \
    "ea,e,a,inner,tension,10\nec,e,c,inner,tension,12\n"

/* The same in the summary, in JSON and in the file, whatever a solver leaves of the tension. */
START_TEST(ratio_with_a_slack_cable_is_infinite)
{
    static const char *const method[] = {"newton", "hifdm"};
    const char *path = net_with(SLACK_NODES, SLACK_CABLES), *out = temp("s.h5");
    HIFDM(0, "run", path, "-o", out, "--set", formatted("form.method=%s", method[_i]));
    OUT("tension ratio 1.2000 inside, inf on the boundary (1 slack cable); ");
    HIFDM(0, "show", out, "--json");
    EXPECT(out_as("s.json"), out, "--", "a['form']['boundary_tension_ratio'] == 'Infinity'",
           "float(a['form']['boundary_tension_ratio']) == np.inf", "a['form']['slack_cables'] == 1",
           "a['form']['inner_tension_ratio'] == b['form'].attrs['inner_tension_ratio']",
           "b['form'].attrs['boundary_tension_ratio'] == np.inf", "b['form'].attrs['n_slack'] == 1");
    HIFDM(0, "report", out, "-o", temp("s.html"));
    char *page = read_file(temp("s.html"), NULL);
    demand_part(page, "\"boundary_tension_ratio\": \"Infinity\"", __LINE__);
    free(page);
}
END_TEST

Suite *suite_cli_wrong_surface(void)
{
    Suite *suite = suite_create("cli/wrong_surface");
    TCase *tests = tcase_create("wrong_surface");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, ratio_with_a_slack_cable_is_infinite, 0, 2);
    return suite;
}
