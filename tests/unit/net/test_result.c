/* The list of a result's figures: the properties of its rows on which the code that reads it relies. */
#include "support.h"

#include <hifdm/result.h>
#include <math.h>
#include <string.h>

START_TEST(blank_sets_the_measures_and_nothing_else)
{
    hf_form_result r, before;
    memset(&r, 1, sizeof r);
    before = r;
    hf_result_blank(&r);
    for (int i = 0; i < HF_RESULT_N; i++) {
        const hf_result_field *f = &hf_result_field_of[i];
        double value = 0;
        if (f->kind == HF_RESULT_REAL) memcpy(&value, (char *)&r + f->offset, sizeof value);
        ck_assert_msg(f->kind == HF_RESULT_REAL ? isnan(value)
                                                : !memcmp((char *)&r + f->offset, (char *)&before + f->offset, f->size),
                      "%s", f->name);
    }
    ck_assert_int_eq(memcmp(&r.coupling, &before.coupling, sizeof r.coupling), 0);
}
END_TEST

/* Files, journals and tables of earlier versions have the figures in this order. */
START_TEST(individuals_have_their_figures_in_this_order)
{
    static const char *const name[] = {
        "status", "psi_m", "residual_N", "inner_tension_ratio", "boundary_tension_ratio", "iterations"};
    const hf_result_field *field[HF_RESULT_N_INDIVIDUAL];
    int n = 0;
    for (int i = 0; i < HF_RESULT_N; i++)
        n += hf_result_field_of[i].individual > 0;
    ck_assert_int_eq(n, HF_RESULT_N_INDIVIDUAL);
    hf_result_list_individual(field);
    ck_assert_str_eq(field[0]->name, "status");
    for (int i = 0, k = 0; k < 6; i++) { /* new ones may stand between them */
        ck_assert_int_lt(i, HF_RESULT_N_INDIVIDUAL);
        k += !strcmp(field[i]->name, name[k]);
    }
}
END_TEST

/* An object opens with the one figure at place 1; no key stands twice. */
static void check_keys(const hf_result_field *field, int n)
{
    int n_first = 0;
    for (int i = 0; i < n; i++) {
        n_first += field[i].json == 1;
        ck_assert_int_ge(field[i].json, 0);
        ck_assert_int_le(field[i].json, 9);
        for (int k = 0; k < i; k++) {
            ck_assert_str_ne(hf_result_key(&field[i]), hf_result_key(&field[k]));
            ck_assert_str_ne(field[i].name, field[k].name);
        }
    }
    ck_assert_int_eq(n_first, 1);
}

START_TEST(keys_are_unique_and_one_opens_the_object)
{
    check_keys(hf_result_field_of, HF_RESULT_N);
    check_keys(hf_coupling_field_of, HF_COUPLING_N);
}
END_TEST

Suite *suite_unit_result(void)
{
    Suite *suite = suite_create("unit/result");
    TCase *tests = tcase_create("result");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, blank_sets_the_measures_and_nothing_else);
    tcase_add_test(tests, individuals_have_their_figures_in_this_order);
    tcase_add_test(tests, keys_are_unique_and_one_opens_the_object);
    return suite;
}
