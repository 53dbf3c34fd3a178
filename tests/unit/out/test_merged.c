/* The ranking of a merged study by verdicts: from summaries, through a ledger and a merge, to the best point and the
 * advice. */
#include "out/print_study.h"
#include "store/ledger.h"
#include "store/merge.h"
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N_POINT = 5, N_ROW = 3 };

/* What a point of the study has: verdicts and relative margins of its rows, and psi. */
typedef struct {
    hf_verdict verdict[N_ROW];
    double margin[N_ROW], psi_m;
} given;

#define P HF_VERDICT_PASS
#define F HF_VERDICT_FAIL
#define U HF_VERDICT_UNDECIDED
#define NO_MARGIN ((double)NAN)

/* Writes the points, whose axis is form.pretension_N = 1, ..., 5, and reads their merge. Rows: n_row, 0 for none. */
static void merge_points(const given point[N_POINT], int n_row, hf_merged *merged)
{
    static char output[1024];
    char folder[1024];
    hf_study study;
    hf_points points;
    hf_ledger ledger;
    hf_messages m = {0};
    hf_requirement_verdict row[N_ROW] = {
        {.row = {.figure = HF_REQUIRED_TENSION, .set = "tie", .load_case = "all", .share = 0.95}},
        {.row = {.figure = HF_REQUIRED_PSI, .load_case = "nominal", .share = (double)NAN}},
        {.row = {.figure = HF_REQUIRED_SLACK, .load_case = "nominal", .share = (double)NAN}}};
    write_file(temp_path("base.yaml"), "scene:\n  parabolic_cylinder: {aperture_m: 2, length_m: 3, focal_length_m: 2, "
                                       "modules: [2, 3], cells_per_module: [2, 2]}\n");
    write_file(temp_path("study.yaml"), "base: base.yaml\nsweep:\n  form.pretension_N: [1, 2, 3, 4, 5]\n");
    snprintf(folder, sizeof folder, "%s%d", temp_path("study.d"), n_row);
    snprintf(output, sizeof output, "%s", temp_path("study.h5"));
    ck_assert_msg(hf_study_read(temp_path("study.yaml"), &study, &m) == HF_OK, "%s", m.text);
    ck_assert_int_eq(hf_ledger_open(folder, &ledger, &m), HF_OK);
    for (int i = 0; i < N_POINT; i++) {
        hf_summary summary = {.stage[HF_STAGE_FORM].exists = true, .n_requirement = n_row, .requirement = row};
        summary.stage[HF_STAGE_FORM].result.psi_m = point[i].psi_m;
        for (int k = 0; k < n_row; k++) {
            row[k].verdict = point[i].verdict[k];
            row[k].relative_margin = point[i].margin[k];
            row[k].margin = isnan(point[i].margin[k]) ? -2 : 10 * point[i].margin[k];
        }
        ck_assert_int_eq(hf_ledger_write(&ledger, &study, i, HF_OK, "", &summary, &m), HF_OK);
    }
    hf_ledger_close(&ledger, &m);
    ck_assert_int_eq(hf_ledger_read(folder, &study, &points, &m), HF_OK);
    ck_assert_msg(hf_merge(&study, folder, &points, output, true, &m) == HF_OK, "%s", m.text);
    ck_assert_msg(hf_merged_read(output, merged, &m) == HF_OK, "%s", m.text);
    hf_points_free(&points);
    hf_study_free(&study);
}

static const char *advice_of(const hf_merged *m)
{
    static char text[HF_PRINT_ADVICE_SIZE];
    return hf_print_study_advice(m, text);
}

/* A failure outweighs every margin and psi, then an undecided requirement does, then the margin counts. */
START_TEST(points_rank_by_what_they_fail)
{
    static const given point[N_POINT] = {{{F, P, P}, {-0.001, 5, 5}, 1e-4},
                                         {{U, P, P}, {0.9, 5, 5}, 2e-4},
                                         {{P, P, P}, {0.1, 0.2, NO_MARGIN}, 5e-4},
                                         {{P, P, P}, {0.3, 0.2, NO_MARGIN}, 9e-4},
                                         {{F, F, P}, {-0.5, -0.1, 1}, 3e-4}};
    static const int order[N_POINT] = {3, 2, 1, 0, 4};
    static hf_merged m;
    char text[HF_PRINT_RANKING_SIZE];
    merge_points(point, N_ROW, &m);
    ck_assert_int_eq(m.best, 3);
    ck_assert_str_eq(m.figure[m.lead].key, HF_MERGED_MARGIN);
    for (int k = 0; k + 1 < N_POINT; k++) {
        ck_assert(hf_merged_ranks_before(&m, order[k], order[k + 1]));
        ck_assert(!hf_merged_ranks_before(&m, order[k + 1], order[k]));
    }
    ck_assert_str_eq(advice_of(&m), "2 of 5 points pass: pretension between the points 3 and 4 N; 1 is undecided");
    ck_assert_str_eq(hf_print_study_ranking(&m, text),
                     "failed requirements, then undecided ones, then smallest relative margin");
    ck_assert_str_eq(hf_print_study_tightest(&m, 4, text), "tension of tie, all load cases, 95 % of samples -50.0 %");
    ck_assert_str_eq(hf_print_study_tightest(&m, 3, text), "psi +20.0 %");
    ck_assert_str_eq(hf_print_study_verdict(&m, 4, text), "fail (2 of 3)");
    ck_assert_str_eq(hf_print_study_verdict(&m, 1, text), "undecided (1 of 3)");
    hf_merged_free(&m);
}
END_TEST

/* Verdicts of the same count: a row whose bound is 0 decides by its verdict and has a margin in its unit. */
START_TEST(a_failure_without_relative_margin_counts)
{
    static const given point[N_POINT] = {{{P, P, F}, {0.9, 0.9, NO_MARGIN}, 1e-4},
                                         {{P, P, F}, {0.8, 0.9, NO_MARGIN}, 1e-4},
                                         {{P, P, P}, {0.01, 0.9, NO_MARGIN}, 2e-4},
                                         {{P, P, F}, {0.8, 0.9, NO_MARGIN}, 1e-4},
                                         {{P, P, P}, {0.01, 0.9, NO_MARGIN}, 1e-4}};
    static hf_merged m;
    char text[HF_PRINT_RANKING_SIZE];
    merge_points(point, N_ROW, &m);
    ck_assert_int_eq(m.best, 4); /* of equal margins, that with the smaller psi */
    int row[HF_REQUIREMENT_ROWS_MAX];
    ck_assert_int_eq(hf_merged_required(&m, row), N_ROW);
    ck_assert(row[0] == 2 && row[1] == 0 && row[2] == 1); /* that which fails, then that which decides points */
    ck_assert_str_eq(hf_print_study_tightest(&m, 0, text), "slack_cables -2");
    ck_assert_str_eq(advice_of(&m), "2 of 5 points pass: pretension at the point 3 N, and at the point 5 N");
    hf_merged_free(&m);
}
END_TEST

/* No point passes: the closest one is known, and it is not said to pass. */
START_TEST(no_point_passes)
{
    static const given point[N_POINT] = {{{F, F, P}, {-0.1, -0.1, 1}, 1e-4},
                                         {{F, P, P}, {-0.9, 1, 1}, 2e-4},
                                         {{F, P, P}, {-0.8, 1, 1}, 3e-4},
                                         {{F, F, F}, {-0.1, -0.1, -1}, 1e-5},
                                         {{F, U, P}, {-0.1, 0, 1}, 1e-5}};
    static hf_merged m;
    merge_points(point, N_ROW, &m);
    ck_assert_int_eq(m.best, 2);
    ck_assert_str_eq(advice_of(&m),
                     "no point passes; at every point fails: tension of tie, all load cases, 95 % of samples");
    FILE *f = fopen(temp_path("shown.txt"), "w");
    hf_print_study(&m, (hf_print_style){0}, f);
    fclose(f);
    char *shown = read_file(temp_path("shown.txt"), NULL);
    ck_assert_ptr_nonnull(strstr(shown, "best (*)      fails 1 of 3, smallest margin -80.0 %"));
    free(shown);
    f = fopen(temp_path("shown.txt"), "w");
    hf_print_study_json(&m, f);
    fclose(f);
    shown = read_file(temp_path("shown.txt"), NULL);
    ck_assert(!strstr(shown, "\"best\":") && strstr(shown, "\"closest\":") && strstr(shown, "\"passing\": 0"));
    free(shown);
    hf_merged_free(&m);
}
END_TEST

/* Without requirements psi ranks the points, and nothing is advised. */
START_TEST(without_requirements_psi_ranks)
{
    static const given point[N_POINT] = {
        {.psi_m = 3e-4}, {.psi_m = 1e-4}, {.psi_m = 2e-4}, {.psi_m = 4e-4}, {.psi_m = 5e-4}};
    static hf_merged m;
    char text[HF_PRINT_RANKING_SIZE];
    merge_points(point, 0, &m);
    ck_assert_int_eq(m.n_row, 0);
    ck_assert_int_eq(m.best, 1);
    ck_assert_str_eq(hf_print_study_ranking(&m, text), "psi");
    ck_assert_str_eq(advice_of(&m), "");
    hf_merged_free(&m);
}
END_TEST

Suite *suite_unit_merged(void)
{
    Suite *suite = suite_create("unit/merged");
    TCase *tcase = tcase_create("merged");
    tcase_add_test(tcase, points_rank_by_what_they_fail);
    tcase_add_test(tcase, a_failure_without_relative_margin_counts);
    tcase_add_test(tcase, no_point_passes);
    tcase_add_test(tcase, without_requirements_psi_ranks);
    suite_add_tcase(suite, tcase);
    return suite;
}
