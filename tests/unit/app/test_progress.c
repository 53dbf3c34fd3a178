/* What is shown of how far a run is: in every mode, at given times, to the letter. */
#include "support.h"

#include "app/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N_EVENT = 15 };
static const hf_run_progress events[N_EVENT] = {
    {.phase = HF_RUN_FORM, .best_psi_m = NAN, .merit = NAN},
    {.phase = HF_RUN_SEARCH, .generation = 1, .generations = 100, .evaluations = 50, .best_psi_m = 0.002, .merit = NAN},
    {.phase = HF_RUN_SEARCH,
     .generation = 5,
     .generations = 100,
     .evaluations = 250,
     .best_psi_m = 0.0015,
     .elapsed_s = 0.05,
     .merit = NAN},
    {.phase = HF_RUN_SEARCH,
     .generation = 20,
     .generations = 100,
     .evaluations = 1000,
     .best_psi_m = 0.001,
     .elapsed_s = 40,
     .merit = NAN},
    {.phase = HF_RUN_SEARCH,
     .generation = 21,
     .generations = 100,
     .evaluations = 1050,
     .best_psi_m = 0.001,
     .elapsed_s = 40.5,
     .is_last = true,
     .merit = NAN},
    {.phase = HF_RUN_REFINE, .max_steps = 200, .best_psi_m = 0.001, .merit = NAN, .first_step = 4, .step = 4},
    {.phase = HF_RUN_REFINE,
     .max_steps = 200,
     .best_psi_m = NAN,
     .merit = 0.0013,
     .violation = 1.575,
     .first_step = 4,
     .step = 5,
     .evaluations = 8,
     .elapsed_s = 30},
    {.phase = HF_RUN_REFINE,
     .max_steps = 200,
     .best_psi_m = 0.0009,
     .merit = 0.0012,
     .first_step = 4,
     .step = 6,
     .evaluations = 9,
     .elapsed_s = 31},
    {.phase = HF_RUN_REFINE, .points_all = 21, .best_psi_m = NAN, .merit = NAN},
    {.phase = HF_RUN_REFINE,
     .points_all = 21,
     .points = 3,
     .steps = 70,
     .elapsed_s = 61,
     .best_psi_m = NAN,
     .merit = NAN},
    {.phase = HF_RUN_TOLERANCE, .samples_all = 1000, .best_psi_m = NAN, .merit = NAN},
    {.phase = HF_RUN_TOLERANCE,
     .samples = 128,
     .evaluations = 64,
     .samples_all = 1000,
     .elapsed_s = 32,
     .best_psi_m = NAN,
     .merit = NAN},
    {.phase = HF_RUN_TOLERANCE,
     .samples = 130,
     .evaluations = 66,
     .samples_all = 1000,
     .elapsed_s = 32.05,
     .best_psi_m = NAN,
     .merit = NAN},
    {.phase = HF_RUN_TOLERANCE,
     .samples = 640,
     .evaluations = 1600,
     .samples_all = 1000,
     .elapsed_s = 70,
     .sigma_scale = 0.5,
     .best_psi_m = NAN,
     .merit = NAN},
    {.phase = HF_RUN_TOLERANCE,
     .samples = 1000,
     .evaluations = 2000,
     .samples_all = 1000,
     .elapsed_s = 70.02,
     .is_last = true,
     .best_psi_m = NAN,
     .merit = NAN},
};

static void demand(hf_progress_mode mode, const char *wanted)
{
    FILE *file = tmpfile();
    hf_progress p = hf_progress_on(file, mode);
    for (int i = 0; i < N_EVENT; i++)
        hf_progress_show(&p, events + i);
    hf_progress_end(&p);
    hf_progress_end(&p);
    long size = ftell(file);
    char *text = calloc(1, (size_t)size + 1);
    rewind(file);
    ck_assert_uint_eq(fread(text, 1, (size_t)size, file), (size_t)size);
    ck_assert_str_eq(text, wanted);
    free(text);
    fclose(file);
}

#define CLEAR "\r\033[K"

START_TEST(a_line_is_written_anew_ten_times_a_second)
{
    demand(HF_PROGRESS_LINE, CLEAR
           "generation 1/100  best psi 2.0000 mm  0 evaluations/s  at most 0 us left" CLEAR
           "generation 20/100  best psi 1.0000 mm  25 evaluations/s  at most 2 min 40 s left" CLEAR
           "generation 21/100  best psi 1.0000 mm  26 evaluations/s  at most 2 min 32 s left" CLEAR
           "Levenberg-Marquardt: step 4 of at most 200  psi 1.0000 mm" CLEAR
           "Levenberg-Marquardt: step 5 of at most 200  outside the limits and requirements by 1.57 (sum of relative "
           "distances)  30.0 s a step" CLEAR
           "Levenberg-Marquardt: step 6 of at most 200  psi 0.9000 mm, merit 0.0012  15.5 s a step" CLEAR
           "front: point 0/21  0 steps of Levenberg-Marquardt  0 us so far" CLEAR
           "front: point 3/21  70 steps of Levenberg-Marquardt  1 min 1 s so far" CLEAR
           "first order, before 1000 samples" CLEAR "sample 128/1000  2 samples/s  7 min 16 s left" CLEAR
           "sample 640/1000; the yield with 0.5 times the errors" CLEAR);
}
END_TEST

START_TEST(a_log_has_a_line_every_half_minute)
{
    demand(HF_PROGRESS_LOG,
           "generation 20/100  best psi 1.0000 mm  25 evaluations/s  at most 2 min 40 s left\n"
           "Levenberg-Marquardt: step 5 of at most 200  outside the limits and requirements by 1.57 (sum of relative "
           "distances)  30.0 s a step\n"
           "front: point 3/21  70 steps of Levenberg-Marquardt  1 min 1 s so far\n"
           "sample 128/1000  2 samples/s  7 min 16 s left\n"
           "sample 640/1000; the yield with 0.5 times the errors\n");
}
END_TEST

START_TEST(objects_are_written_each_second_and_at_the_end)
{
    demand(
        HF_PROGRESS_JSONL,
        "{\"phase\": \"form\"}\n"
        "{\"phase\": \"search\", \"generation\": 1, \"generations\": 100, \"first_generation\": 0, \"evaluations\": "
        "50, \"best_psi_m\": 0.002, \"evaluations_per_s\": 0, \"elapsed_s\": 0, \"at_most_left_s\": 0}\n"
        "{\"phase\": \"search\", \"generation\": 20, \"generations\": 100, \"first_generation\": 0, \"evaluations\": "
        "1000, \"best_psi_m\": 0.001, \"evaluations_per_s\": 25, \"elapsed_s\": 40, \"at_most_left_s\": 160}\n"
        "{\"phase\": \"search\", \"generation\": 21, \"generations\": 100, \"first_generation\": 0, \"evaluations\": "
        "1050, \"best_psi_m\": 0.001, \"evaluations_per_s\": 25.925925925925927, \"elapsed_s\": 40.5, "
        "\"at_most_left_s\": 152.35714285714286}\n"
        "{\"phase\": \"refine\", \"step\": 4, \"max_steps\": 200, \"evaluations\": 0, \"best_psi_m\": 0.001, "
        "\"elapsed_s\": 0, \"at_most_left_s\": 0}\n"
        "{\"phase\": \"refine\", \"step\": 5, \"max_steps\": 200, \"evaluations\": 8, \"best_psi_m\": null, "
        "\"merit\": 0.0012999999999999999, \"violation\": 1.575, \"elapsed_s\": 30, \"at_most_left_s\": 5850}\n"
        "{\"phase\": \"refine\", \"step\": 6, \"max_steps\": 200, \"evaluations\": 9, \"best_psi_m\": "
        "0.00089999999999999998, \"merit\": 0.0011999999999999999, \"elapsed_s\": 31, \"at_most_left_s\": 3007}\n"
        "{\"phase\": \"refine\", \"point\": 0, \"points\": 21, \"steps\": 0, \"elapsed_s\": 0}\n"
        "{\"phase\": \"refine\", \"point\": 3, \"points\": 21, \"steps\": 70, \"elapsed_s\": 61}\n"
        "{\"phase\": \"tolerance\", \"sample\": 0, \"samples\": 1000, \"samples_per_s\": 0, \"elapsed_s\": 0}\n"
        "{\"phase\": \"tolerance\", \"sample\": 128, \"samples\": 1000, \"samples_per_s\": 2, \"elapsed_s\": 32}\n"
        "{\"phase\": \"tolerance\", \"sample\": 640, \"samples\": 1000, \"sigma_scale\": 0.5, \"elapsed_s\": 70}\n"
        "{\"phase\": \"tolerance\", \"sample\": 1000, \"samples\": 1000, \"samples_per_s\": 28.563267637817766, "
        "\"elapsed_s\": 70.019999999999996}\n");
}
END_TEST

START_TEST(nothing_is_written_unless_wanted)
{
    demand(HF_PROGRESS_NONE, "");
    FILE *file = tmpfile();
    ck_assert_int_eq((int)hf_progress_on(file, HF_PROGRESS_AUTO).mode, HF_PROGRESS_LOG);
    fclose(file);
}
END_TEST

Suite *suite_unit_progress(void)
{
    Suite *suite = suite_create("unit/app/progress");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_line_is_written_anew_ten_times_a_second);
    tcase_add_test(tests, a_log_has_a_line_every_half_minute);
    tcase_add_test(tests, objects_are_written_each_second_and_at_the_end);
    tcase_add_test(tests, nothing_is_written_unless_wanted);
    suite_add_tcase(suite, tests);
    return suite;
}
