/* form.prestress: exact of random double nets, some of which no cables that pull can hold, against a linear and a
 * quadratic programme in another language. */
#include "../cli/cli.h"

#include <inttypes.h>

#define N_NET "30"

START_TEST(random_nets_agree_with_the_oracle)
{
    const char *const argv[] = {python_program(),
                                keep(source_path("tests/verify/prestress_oracle.py")),
                                hifdm_program(),
                                N_NET,
                                keep(formatted("%" PRIu64, test_seed())),
                                NULL};
    int n_held = 0;
    demand_exit(run_command(HANG_S, argv), 0, "prestress_oracle.py", __LINE__);
    printf("prestress_oracle.py, seed %" PRIu64 ": %s", test_seed(), said.out);
    ck_assert_int_eq(sscanf(said.out, N_NET " nets, %d can be held; 0 wrong", &n_held), 1);
    ck_assert(n_held > 5 && n_held < 30); /* of both kinds */
}
END_TEST

Suite *suite_verify_prestress(void)
{
    Suite *suite = suite_create("verify/prestress");
    TCase *tcase = tcase_create("prestress");
    tcase_add_test(tcase, random_nets_agree_with_the_oracle);
    suite_add_tcase(suite, tcase);
    return suite;
}
