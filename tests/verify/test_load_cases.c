/* States of the net as built against an oracle in another language: random nets on rigid ground and on bar trusses,
 * with temperatures, gravity, forces and moves of supports, and slack cables. */
#include "../cli/cli.h"

#define N_CASE "13" /* of four states each */

START_TEST(random_load_cases_agree_with_the_oracle)
{
    const char *oracle = keep(source_path("tests/verify/load_cases_oracle.py")), *folder = temp("states");
    SHELL(0, "mkdir \"$2\" && \"$1\" \"$3\" make " N_CASE " \"$2\"", python_program(), folder, oracle);
    SHELL(0, "for k in $(seq " N_CASE "); do \"$0\" run \"$1/$k/case.yaml\" -o \"$1/$k.h5\" --quiet || exit; done",
          folder);
    const char *const check[] = {python_program(), oracle, "check", N_CASE, folder, NULL};
    demand_exit(run_command(HANG_S, check), 0, "load_cases_oracle.py", __LINE__);
    ck_assert_int_eq(count_of(said.out, "truss True: "), 7);
}
END_TEST

Suite *suite_verify_load_cases(void)
{
    Suite *suite = suite_create("verify/load_cases");
    TCase *tcase = tcase_create("states");
    tcase_add_test(tcase, random_load_cases_agree_with_the_oracle);
    suite_add_tcase(suite, tcase);
    return suite;
}
