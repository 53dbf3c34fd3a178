/* Proven bounds of thousands of nets at sixteen stops each (HIFDM_STRESS=1; else a few). */
#include "../bounds.h"

START_TEST(bounds_hold_at_every_stop)
{
    hold_bounds(100000 + 1000 * (uint64_t)_i, is_long_run() ? 504 : 12, _i % 2, is_long_run() ? 0.3 : 0, 10);
}
END_TEST

Suite *suite_stress_bounds(void)
{
    Suite *suite = suite_create("stress/bounds");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 1800);
    tcase_add_loop_test(tests, bounds_hold_at_every_stop, 0, is_long_run() ? 4 : 2);
    suite_add_tcase(suite, tests);
    return suite;
}
