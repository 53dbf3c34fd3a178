/* The one test program: run_tests [WORD...] runs the suites of suites.list.h whose room/name contains a word, or all.
 *
 * check's own variables work: CK_FORK=no for a debugger, CK_RUN_SUITE, CK_RUN_CASE, CK_VERBOSITY=verbose. */
#include "support.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    Suite *(*create)(void);
} suites[] = {
#define SUITE(kind, name) {#kind "/" #name, suite_##kind##_##name},
#define MIRROR(kind, room, name) {#kind "/" #room "/" #name, suite_##kind##_##name},
#include "suites.list.h"
#undef MIRROR
#undef SUITE
};

static bool is_wanted(const char *name, int n_word, char **words)
{
    for (int i_word = 0; i_word < n_word; i_word++)
        if (strstr(name, words[i_word])) return true;
    return n_word == 0;
}

int main(int argc, char **argv)
{
    begin_test_run();
    SRunner *runner = srunner_create(NULL);
    for (size_t i_suite = 0; i_suite < sizeof suites / sizeof suites[0]; i_suite++)
        if (is_wanted(suites[i_suite].name, argc - 1, argv + 1)) srunner_add_suite(runner, suites[i_suite].create());
    srunner_run_all(runner, CK_ENV);
    end_test_run();

    int n_run = srunner_ntests_run(runner), n_failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (n_failed > 0) printf("random numbers of this run: HIFDM_TEST_SEED=%" PRIu64 "\n", test_seed());
    if (n_run == 0) printf("no test ran\n");
    printf("%d passed, %d failed\n", n_run - n_failed, n_failed);
    return n_run > 0 && n_failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
