/* Groups of replicates: from summaries, through a ledger and a merge, to medians, ranks and what is said of them. */
#include "out/print_study.h"
#include "store/ledger.h"
#include "store/merge.h"
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MISSING (-1.0) /* a replicate that has not been run */
#define FAILED (-2.0)

static hf_merged merged;
static char scatter[HF_PRINT_ADVICE_SIZE];

/* Reads the merge of a study of pretensions 1, 2, ... with n replicates each and these values of psi, in mm. */
static void make(int n_group, int n, const double *psi_mm)
{
    static char output[1024];
    static int n_made;
    char folder[1024], text[256];
    hf_study study;
    hf_points points;
    hf_ledger ledger;
    hf_messages m = {0};
    write_file(temp_path("base.yaml"), "scene:\n  parabolic_cylinder: {aperture_m: 2, length_m: 3, focal_length_m: 2, "
                                       "modules: [2, 3], cells_per_module: [2, 2]}\noptimize: {}\n");
    snprintf(text, sizeof text,
             "base: base.yaml\nsweep:\n  files: none\n  replicates: %d\n  form.pretension_N: {from: 1, to: %d, n: "
             "%d}\n",
             n, n_group, n_group);
    write_file(temp_path("study.yaml"), text);
    snprintf(folder, sizeof folder, "%s%d", temp_path("study.d"), n_made++);
    snprintf(output, sizeof output, "%s", temp_path("study.h5"));
    ck_assert_msg(hf_study_read(temp_path("study.yaml"), &study, &m) == HF_OK, "%s", m.text);
    ck_assert_int_eq(study.n_point, n_group * n);
    ck_assert_int_eq(hf_ledger_open(folder, &ledger, &m), HF_OK);
    for (int i = 0; i < study.n_point; i++) {
        hf_summary summary = {.stage[HF_STAGE_FORM].exists = psi_mm[i] != FAILED};
        hf_status status = psi_mm[i] == FAILED ? HF_NOT_CONVERGED : HF_OK;
        summary.stage[HF_STAGE_FORM].result.psi_m = 1e-3 * psi_mm[i];
        if (psi_mm[i] != MISSING)
            ck_assert_int_eq(hf_ledger_write(&ledger, &study, i, status, "", &summary, &m), HF_OK);
    }
    hf_ledger_close(&ledger, &m);
    ck_assert_int_eq(hf_ledger_read(folder, &study, &points, &m), HF_OK);
    ck_assert_msg(hf_merge(&study, folder, &points, output, true, &m) == HF_OK, "%s", m.text);
    ck_assert_msg(hf_merged_read(output, &merged, &m) == HF_OK, "%s", m.text);
    hf_print_study_scatter(&merged, scatter);
    hf_points_free(&points);
    hf_study_free(&study);
    hf_messages_free(&m);
}

static void check_group(int k, int n_run, int rank, const double mm[5])
{
    const hf_merged_group *g = &merged.group[k];
    ck_assert_int_eq(g->n_run, n_run);
    ck_assert_int_eq(g->rank, rank);
    for (int i = 0; i < 5; i++)
        if (isnan(mm[i]))
            ck_assert_double_nan(g->statistic[i]);
        else
            ck_assert_double_eq_tol(1e3 * g->statistic[i], mm[i], 1e-12);
}

/* The group with the best point has the worse median. A failed replicate ranks last; a missing one does not count. */
START_TEST(groups_rank_by_their_medians)
{
    static const double psi[] = {1, 9, 8, 7, 6, 5, 4, FAILED, 6, 5.5, 3, MISSING, 2, 3, MISSING};
    static const double mm[][5] = {{1, 6, 7, 8, 9}, {4, 5, 5.5, 6, (double)NAN}, {2, 2.5, 3, 3, 3}};
    make(3, 5, psi);
    ck_assert_int_eq(merged.n_group, 3);
    check_group(0, 5, 2, mm[0]);
    check_group(1, 5, 1, mm[1]);
    check_group(2, 3, 0, mm[2]);
    ck_assert_int_eq(merged.best, 0);
    ck_assert_int_eq(merged.best_group, 2);
    ck_assert_int_eq(merged.group[0].best, 0);
    ck_assert_int_eq(merged.group[2].best, 12);
    ck_assert_msg(!!strstr(scatter, "pretension 3 N and pretension 2 N are not shown to differ"), "%s", scatter);
    ck_assert_msg(!!strstr(scatter, "at least 5 replicates"), "%s", scatter);
    hf_merged_free(&merged);
}
END_TEST

/* Five replicates that do not overlap differ: p = 2/252. */
START_TEST(groups_that_do_not_overlap_differ)
{
    static const double psi[] = {5, 1, 4, 2, 3, 8, 9, 6, 7, 6.5};
    make(2, 5, psi);
    ck_assert_double_eq_tol(merged.differ_p, 2 / 252.0, 1e-14);
    ck_assert_str_eq(scatter, "pretension 1 N and pretension 2 N differ by more than the scatter of the search "
                              "(Mann-Whitney U test, p = 0.0079)");
    hf_merged_free(&merged);
}
END_TEST

/* Groups must not be said to differ if they overlap, if they are few, or if all differences are rounding. */
START_TEST(other_groups_are_not_said_to_differ)
{
    static const double overlap[] = {5, 1, 4, 2, 6.2, 8, 9, 6, 7, 6.5}, few[] = {1, 2, 3, 4, 5, 6, 7, 8};
    static const double rounding[] = {1,         1,         1, 1, 1, 1.0000001, 1.0000001, 1.0000001,
                                      1.0000001, 1.0000001, 2, 2, 2, 2,         2};
    make(2, 5, overlap);
    ck_assert_double_gt(merged.differ_p, 0.01);
    ck_assert_msg(!!strstr(scatter, "are not shown to differ"), "%s", scatter);
    ck_assert_msg(!strstr(scatter, "at least 5"), "%s", scatter);
    hf_merged_free(&merged);
    make(2, 4, few);
    ck_assert_double_eq_tol(merged.differ_p, 2 / 70.0, 1e-14);
    ck_assert_msg(!!strstr(scatter, "are not shown to differ"), "%s", scatter);
    hf_merged_free(&merged);
    make(3, 5, rounding);
    ck_assert_double_eq(merged.differ_p, 1);
    ck_assert_msg(!!strstr(scatter, "are not shown to differ"), "%s", scatter);
    hf_merged_free(&merged);
}
END_TEST

/* Without a second group that has a point, there is no statement; without any figure that varies, no group. */
START_TEST(nothing_is_said_without_two_groups)
{
    static const double one[] = {1, 2, 3, MISSING, MISSING, MISSING}, same[] = {1, 1, 1, 1, 1, 1};
    static const double failed[] = {1, 2, 3, FAILED, FAILED, FAILED};
    make(2, 3, one);
    ck_assert_int_eq(merged.best_group, 0);
    ck_assert_str_eq(scatter, "");
    hf_merged_free(&merged);
    make(2, 3, failed);
    ck_assert_int_eq(merged.second_group, -1);
    ck_assert_str_eq(scatter, "");
    hf_merged_free(&merged);
    make(2, 3, same);
    ck_assert_int_eq(merged.n_group, 0);
    ck_assert_str_eq(scatter, "");
    hf_merged_free(&merged);
}
END_TEST

/* The medians fall towards 4 N; the best points, by luck, do not. */
START_TEST(the_end_of_an_axis_is_that_of_the_medians)
{
    static const double psi[] = {8, 8, 8, 7, 1, 7, 6, 6, 6, 5, 5, 5};
    make(4, 3, psi);
    for (int a = 0; a < merged.n_axis; a++)
        ck_assert_int_eq(hf_merged_improves_on(&merged, a), a == merged.replicate ? 0 : 1);
    ck_assert_int_eq(merged.best, 4);
    hf_merged_free(&merged);
}
END_TEST

Suite *suite_unit_merged_groups(void)
{
    Suite *suite = suite_create("unit/merged_groups");
    TCase *tcase = tcase_create("merged_groups");
    tcase_add_test(tcase, groups_rank_by_their_medians);
    tcase_add_test(tcase, groups_that_do_not_overlap_differ);
    tcase_add_test(tcase, other_groups_are_not_said_to_differ);
    tcase_add_test(tcase, nothing_is_said_without_two_groups);
    tcase_add_test(tcase, the_end_of_an_axis_is_that_of_the_medians);
    suite_add_tcase(suite, tcase);
    return suite;
}
