/* The laws of cables. What holds for every law is looked up in its row, so that a new law is tested as it stands. */
#include "laws.h"

#define DIGITS 1e-7 /* relative: a difference quotient over 1e-5 of the length, of values with 1e-16 each */

static const double length_m[] = {0.7, 0.999, 1.001, 1.2, 1.5};
enum { N_LENGTH = sizeof length_m / sizeof *length_m };

/* A cable of theoretical length 1.1 m; targets are of the size of one metre, newton or newton per metre. */
static hf_law_cable sample(hf_law law)
{
    return (hf_law_cable){law, 1.0, 250.0, 1.1};
}

/* The change of the potential phi from one length to another, J: phi = T* l, q l^2/2, EA (l - l0)^2/(2 l0). */
static double energy_change_J(hf_law_cable c, double from_m, double to_m)
{
    double over_m = fmax(from_m - c.target, 0), beyond_m = fmax(to_m - c.target, 0);
    switch (c.law) {
    case HF_LAW_TENSION:
        return c.target * (to_m - from_m);
    case HF_LAW_FORCE_DENSITY:
        return c.target * (to_m - from_m) * (to_m + from_m) / 2;
    case HF_LAW_ELASTIC:
        return c.EA_N / (2 * c.target) * (beyond_m - over_m) * (beyond_m + over_m);
    case HF_LAW_LENGTH:
        break;
    }
    return (double)NAN;
}

/* Known numbers: T* = 1 N, q = 1 N/m, L* = l0 = 1 m, EA = 250 N, at a length of 1.2 m. */
START_TEST(tensions_and_stiffnesses_are_those_of_the_potentials)
{
    ck_assert_double_eq(hf_law_tension_N(sample(HF_LAW_TENSION), 1.2), 1);
    ck_assert_double_eq(hf_law_tension_N(sample(HF_LAW_FORCE_DENSITY), 1.2), 1.2);
    ck_assert_double_eq_tol(hf_law_tension_N(sample(HF_LAW_ELASTIC), 1.2), 50, 1e-13 * 50);
    ck_assert_double_eq(hf_law_tension_N(sample(HF_LAW_ELASTIC), 0.9), 0);
    ck_assert_double_eq(hf_law_stiffness_N_per_m(sample(HF_LAW_TENSION), 1.2), 0);
    ck_assert_double_eq(hf_law_stiffness_N_per_m(sample(HF_LAW_FORCE_DENSITY), 1.2), 1);
    ck_assert_double_eq(hf_law_stiffness_N_per_m(sample(HF_LAW_ELASTIC), 1.2), 250);
    ck_assert_double_eq(hf_law_stiffness_N_per_m(sample(HF_LAW_ELASTIC), 0.9), 0);
    ck_assert_double_eq(hf_law_required_length_m(sample(HF_LAW_LENGTH), 50), 1);
    ck_assert_double_eq_tol(hf_law_required_length_m(sample(HF_LAW_ELASTIC), 50), 1.2, 1e-15);
    ck_assert_double_eq_tol(energy_change_J(sample(HF_LAW_TENSION), 0.9, 1.2), 0.3, 1e-15);
    ck_assert_double_eq_tol(energy_change_J(sample(HF_LAW_FORCE_DENSITY), 0.9, 1.2), 0.315, 1e-15);
    ck_assert_double_eq_tol(energy_change_J(sample(HF_LAW_ELASTIC), 0.9, 1.2), 5, 1e-13);
}
END_TEST

/* T = dphi/dl and k = dT/dl, away from the length where an elastic cable goes slack. */
START_TEST(stiffness_and_tension_are_derivatives)
{
    hf_law_cable c = sample((hf_law)_i);
    if (hf_law_has(c.law, HF_LAW_IS_RIGID)) {
        ck_assert_double_nan(hf_law_tension_N(c, 1));
        ck_assert_double_infinite(hf_law_stiffness_N_per_m(c, 1));
        return;
    }
    for (int k = 0; k < N_LENGTH; k++) {
        double h = 1e-5 * length_m[k], low = length_m[k] - h, high = length_m[k] + h;
        double slope = (hf_law_tension_N(c, high) - hf_law_tension_N(c, low)) / (2 * h);
        double rise = energy_change_J(c, low, high) / (2 * h);
        double k_N_per_m = hf_law_stiffness_N_per_m(c, length_m[k]), tension_N = hf_law_tension_N(c, length_m[k]);
        ck_assert_double_eq_tol(slope, k_N_per_m, DIGITS * (1 + k_N_per_m));
        ck_assert_double_eq_tol(rise, tension_N, DIGITS * (1 + tension_N));
    }
}
END_TEST

/* A law with a multiplier wants, at the tension of a taut cable, the length that it has; Eq. 8 then changes nothing.
 * Without one, the next force density has the tension of the law: Eq. 7. */
START_TEST(the_iteration_rests_where_the_law_is_met)
{
    hf_law_cable c = sample((hf_law)_i);
    for (int k = 0; k < N_LENGTH; k++) {
        double length = length_m[k], T = hf_law_tension_N(c, length);
        if (hf_law_has(c.law, HF_LAW_IS_RIGID)) T = 3, length = hf_law_required_length_m(c, T);
        if (!(T > 0)) continue;
        ck_assert_double_eq_tol(hf_law_next_q_N_per_m(c, length, T, T / length), T / length, 1e-13 * T / length);
        ck_assert_double_eq_tol(hf_law_held_q_N_per_m(c, length, T / length), T / length, 1e-13 * T / length);
        if (hf_law_has(c.law, HF_LAW_HAS_MULTIPLIER))
            ck_assert_double_eq_tol(hf_law_required_length_m(c, T), length, 1e-14 * length);
        else
            ck_assert_double_nan(hf_law_required_length_m(c, T));
    }
}
END_TEST

/* What the flags promise, and what messages need. */
START_TEST(rows_are_whole)
{
    hf_law_cable c = sample((hf_law)_i);
    bool has_multiplier = hf_law_has(c.law, HF_LAW_HAS_MULTIPLIER);
    ck_assert_ptr_nonnull(hf_law_word[_i]);
    ck_assert_ptr_nonnull(hf_law_target_unit[_i]);
    ck_assert(has_multiplier || !hf_law_has(c.law, HF_LAW_IS_RIGID | HF_LAW_GOES_SLACK | HF_LAW_NEEDS_EA));
    ck_assert(!has_multiplier || !hf_law_has(c.law, HF_LAW_GIVES_TENSION));
    ck_assert(!hf_law_has(c.law, HF_LAW_IS_RIGID) || !hf_law_has(c.law, HF_LAW_GOES_SLACK));
    /* a cable without a value has a default, or the pretension of the case, or the message names what is missing */
    if (!isnan(hf_law_default_target((hf_law)_i, 1.1))) ck_assert_ptr_null(hf_law_target_name[_i]);
    if (hf_law_has(c.law, HF_LAW_NEEDS_EA)) {
        ck_assert_ptr_nonnull(hf_law_target_name[_i]);
        c.EA_N = 500;
        ck_assert_double_gt(hf_law_tension_N(c, 1.2), hf_law_tension_N(sample((hf_law)_i), 1.2));
    }
    if (hf_law_has(c.law, HF_LAW_GIVES_TENSION))
        for (int k = 0; k < N_LENGTH; k++)
            ck_assert_double_eq(hf_law_tension_N(c, length_m[k]), c.target);
    double first_N = hf_law_first_tension_N(c, 7);
    ck_assert_double_eq(first_N, hf_law_has(c.law, HF_LAW_GOES_SLACK) ? hf_law_tension_N(c, 1.1) : 7);
    ck_assert(hf_law_is_served(c.law, ~0u));
    ck_assert(!hf_law_is_served(c.law, 0));
}
END_TEST

/* Stored codes: data sets of law hold these numbers. */
START_TEST(codes_are_stable)
{
    static const char *const word[] = {"tension", "length", "force_density", "elastic"};
    for (int law = 0; law < 4; law++)
        ck_assert_str_eq(hf_law_word[law], word[law]);
}
END_TEST

Suite *suite_unit_cable_law(void)
{
    Suite *suite = suite_create("unit/cable_law");
    TCase *tests = tcase_create("cable_law");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, tensions_and_stiffnesses_are_those_of_the_potentials);
    tcase_add_loop_test(tests, stiffness_and_tension_are_derivatives, 0, HF_N_LAW);
    tcase_add_loop_test(tests, the_iteration_rests_where_the_law_is_met, 0, HF_N_LAW);
    tcase_add_loop_test(tests, rows_are_whole, 0, HF_N_LAW);
    tcase_add_test(tests, codes_are_stable);
    return suite;
}
