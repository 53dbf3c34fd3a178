/* Warnings about limits that no design can meet, of random double nets with random variables and limits, against linear
 * programmes in another language. */
#include "../cli/cli.h"

#include <inttypes.h>

#define N_NET "100"

START_TEST(random_limits_agree_with_the_oracle)
{
    const char *const argv[] = {python_program(),
                                keep(source_path("tests/verify/feasible_oracle.py")),
                                hifdm_program(),
                                N_NET,
                                keep(formatted("%" PRIu64, test_seed())),
                                NULL};
    demand_exit(run_command(HANG_S, argv), 0, "feasible_oracle.py", __LINE__);
    printf("feasible_oracle.py, seed %" PRIu64 ": %s", test_seed(), said.out);
    OUT(N_NET " nets: 0 wrong; ");
    OUT(" alone,"); /* of all kinds */
    OUT(" alone, advised,");
    OUT(" met,");
    OUT(" together");
}
END_TEST

Suite *suite_verify_feasible(void)
{
    Suite *suite = suite_create("verify/feasible");
    TCase *tcase = tcase_create("feasible");
    tcase_add_test(tcase, random_limits_agree_with_the_oracle);
    suite_add_tcase(suite, tcase);
    return suite;
}
