/* Proven bounds against an oracle with fifty digits: never below the true error. */
#include "../../bounds.h"

START_TEST(bounds_are_never_below_the_error)
{
    hold_bounds(4000, 96, 0.4, 10);
}
END_TEST

Suite *suite_property_bound(void)
{
    Suite *suite = suite_create("property/solve/bound");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 300);
    tcase_add_test(tests, bounds_are_never_below_the_error);
    suite_add_tcase(suite, tests);
    return suite;
}
