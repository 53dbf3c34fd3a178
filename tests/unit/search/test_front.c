/* Fronts: order, marks and knee of points by hand. */
#include "support.h"

#include <hifdm/front.h>

static void put(hf_front *f, int i, double a, double b, hf_status status)
{
    f->point[i] = (hf_front_point){.objective = {a, b}, .multiplier = {NAN, i}, .status = status, .steps = i};
    f->design[i] = i;
}

START_TEST(points_are_sorted_and_marked)
{
    static const struct {
        int was;
        hf_front_mark mark;
    } wanted[8] = {{3, HF_FRONT_ON},        {7, HF_FRONT_DOMINATED}, {2, HF_FRONT_ON},     {4, HF_FRONT_DOMINATED},
                   {5, HF_FRONT_DOMINATED}, {0, HF_FRONT_ON},        {1, HF_FRONT_FAILED}, {6, HF_FRONT_FAILED}};
    hf_front f;
    ck_assert_int_eq(hf_front_create(2, 1, 8, &f), HF_OK);
    put(&f, 0, 5, 0, HF_OK);
    put(&f, 1, NAN, NAN, HF_COLLAPSED);
    put(&f, 2, 1, 1, HF_OK);
    put(&f, 3, 0, 4, HF_OK);
    put(&f, 4, 1, 1, HF_OK); /* equal to an earlier one */
    put(&f, 5, 2, 1, HF_OK);
    put(&f, 6, NAN, NAN, HF_RATIO_CAP);
    put(&f, 7, 0, 5, HF_OK);
    hf_front_settle(&f);
    for (int i = 0; i < 8; i++) {
        ck_assert_int_eq(f.point[i].steps, wanted[i].was);
        ck_assert_double_eq(f.design[i], wanted[i].was);
        ck_assert_int_eq(f.point[i].mark, wanted[i].mark);
    }
    ck_assert_int_eq(f.knee, 2); /* 1/5 + 1/4 */
    hf_front_free(&f);
    hf_front_free(&f);
}
END_TEST

START_TEST(a_straight_front_has_no_knee)
{
    hf_front f;
    ck_assert_int_eq(hf_front_create(2, 1, 3, &f), HF_OK);
    for (int i = 0; i < 3; i++)
        put(&f, i, 0.1 * i, 7 - 0.1 * i, HF_OK);
    hf_front_settle(&f);
    ck_assert_int_eq(f.knee, -1);
    f.point[1].objective[1] -= 0.01;
    hf_front_settle(&f);
    ck_assert_int_eq(f.knee, 1);
    hf_front_free(&f);
}
END_TEST

/* Of more points than there are rows the table has the ends, the knee, and the others evenly. */
START_TEST(a_table_of_many_points_has_the_ends_and_the_knee)
{
    static const int n_of[] = {1, 511, 512, 513, 514, 700, 1500, 100000};
    static hf_front_table t;
    int n = n_of[_i], n_on = n - n / 10, knee = 2 * n_on / 3, widest = 1;
    hf_front f;
    ck_assert_int_eq(hf_front_create(2, 0, n, &f), HF_OK);
    for (int i = 0; i < n; i++) { /* as they are once settled */
        f.point[i] = (hf_front_point){.objective = {i, i < n_on ? n_on - i : n}, .steps = i};
        f.point[i].mark = i < n_on ? HF_FRONT_ON : HF_FRONT_DOMINATED;
    }
    f.knee = n > 1 ? knee : -1;
    hf_front_tabulate(&f, &t);
    ck_assert_int_eq(t.n_point, n);
    ck_assert_int_eq(t.n_on, n_on);
    ck_assert_int_eq(t.n_row, n < HF_FRONT_POINTS_MAX ? n : HF_FRONT_POINTS_MAX);
    for (int i = 0; i < t.n_row; i++) {
        ck_assert_int_eq(t.row[i].steps, t.index[i]);
        if (i == 0) continue;
        ck_assert_int_lt(t.index[i - 1], t.index[i]);
        if (t.index[i] - t.index[i - 1] > widest) widest = t.index[i] - t.index[i - 1];
    }
    ck_assert_int_le(widest, n < HF_FRONT_POINTS_MAX ? 1 : n / (HF_FRONT_POINTS_MAX - 3) + 2);
    ck_assert_int_eq(t.index[t.end[0]], 0);
    ck_assert_int_eq(t.index[t.end[1]], n_on - 1);
    ck_assert_int_eq(t.end[2], -1);
    ck_assert_int_eq(n > 1 ? t.index[t.knee] : t.knee, f.knee);
    hf_front_free(&f);
}
END_TEST

/* ---- requirements ---- */

static void judge(hf_front *f, int i, int n_failed, int n_undecided, double margin)
{
    f->point[i].judgement = (hf_judgement){4, n_failed, n_undecided, margin};
    f->point[i].is_converged = true;
}

static int first_of(const hf_front *f)
{
    static hf_front_table t;
    hf_front_tabulate(f, &t);
    ck_assert(t.suggested == -1 || t.first.steps == f->point[t.suggested].steps);
    return hf_front_suggested(&t) - 1;
}

/* Without verdicts the knee comes first. With them a point that fails never does while another one passes, also a
 * dominated one; among equal verdicts it is a converged point, then one with a larger margin. */
START_TEST(verdicts_decide_which_point_is_first)
{
    hf_front f;
    ck_assert_int_eq(hf_front_create(2, 1, 6, &f), HF_OK);
    for (int i = 0; i < 4; i++)
        put(&f, i, i, (3 - i) * (3 - i), HF_OK);
    put(&f, 4, 9, 9, HF_OK); /* dominated */
    put(&f, 5, NAN, NAN, HF_COLLAPSED);
    f.minimised = 0;
    hf_front_settle(&f);
    int usual = f.knee;
    ck_assert_int_ge(usual, 0);
    ck_assert_int_eq(f.point[4].mark, HF_FRONT_DOMINATED);
    ck_assert_int_eq(first_of(&f), usual);
    for (int i = 0; i < 5; i++)
        judge(&f, i, 1 + i % 2, 0, 9);
    judge(&f, 5, 0, 0, 99); /* it has no design */
    judge(&f, 4, 0, 2, 0.1);
    ck_assert_int_eq(first_of(&f), 4);
    judge(&f, 3, 0, 2, 0.05);
    ck_assert_int_eq(first_of(&f), 3);
    judge(&f, 0, 0, 1, 0.01);
    ck_assert_int_eq(first_of(&f), 0);
    judge(&f, 3, 0, 1, 0.02);
    ck_assert_int_eq(first_of(&f), 3);
    f.point[3].is_converged = false;
    ck_assert_int_eq(first_of(&f), 0);
    f.minimised = -1; /* a genetic algorithm converges nowhere */
    ck_assert_int_eq(first_of(&f), 3);
    for (int i = 0; i < 4; i++)
        judge(&f, i, 0, 0, 0.2 + 1e-9 * i);
    ck_assert_int_eq(first_of(&f), usual);
    for (int i = 0; i < 6; i++)
        f.point[i].mark = HF_FRONT_FAILED, f.point[i].status = HF_COLLAPSED;
    f.knee = -1;
    ck_assert_int_eq(first_of(&f), -1);
    hf_front_free(&f);
}
END_TEST

Suite *suite_unit_front(void)
{
    Suite *s = suite_create("unit/front");
    TCase *t = tcase_create("points");
    tcase_add_test(t, points_are_sorted_and_marked);
    tcase_add_test(t, a_straight_front_has_no_knee);
    tcase_add_loop_test(t, a_table_of_many_points_has_the_ends_and_the_knee, 0, 8);
    tcase_add_test(t, verdicts_decide_which_point_is_first);
    suite_add_tcase(s, t);
    return s;
}
