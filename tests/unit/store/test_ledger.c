/* The ledger: rows written by any number of processes, incomplete rows, locks that end with their process. */
#include "store/ledger.h"

#include "calls.h"
#include "support.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static char folder[1024];

static void open_study(hf_study *study)
{
    hf_messages m = {0};
    write_file(temp_path("base.yaml"), "scene:\n  parabolic_cylinder: {aperture_m: 2, length_m: 3, focal_length_m: 2, "
                                       "modules: [2, 3], cells_per_module: [2, 2]}\n");
    write_file(temp_path("study.yaml"), "base: base.yaml\nsweep:\n  form.pretension_N: {from: 1, to: 5, n: 5}\n");
    snprintf(folder, sizeof folder, "%s", temp_path("study.d"));
    ck_assert_msg(hf_study_read(temp_path("study.yaml"), study, &m) == HF_OK, "%s", m.text);
}

static hf_points read_points(const hf_study *s)
{
    hf_points points;
    hf_messages m = {0};
    ck_assert_msg(hf_ledger_read(folder, s, &points, &m) == HF_OK, "%s", m.text);
    return points;
}

static int column_of(const char *object, const char *name)
{
    hf_ledger_number number;
    for (int i = 0; hf_ledger_column(i, &number); i++)
        if (!strcmp(number.object, object) && !strcmp(number.field->name, name)) return i;
    ck_abort_msg("no column %s/%s", object, name);
    return -1;
}

/* Write point i with this status, as a process of its own would. */
static void write_point(const hf_study *s, int i, hf_status status, const char *reason, const hf_summary *summary)
{
    hf_ledger ledger;
    hf_messages m = {0};
    ck_assert_int_eq(hf_ledger_open(folder, &ledger, &m), HF_OK);
    ck_assert_int_eq(hf_ledger_claim(&ledger, s->id[i]), HF_LOCK_OURS);
    ck_assert_int_eq(hf_ledger_write(&ledger, s, i, status, reason, summary, &m), HF_OK);
    hf_ledger_close(&ledger, &m);
}

START_TEST(numbers_come_back_bit_by_bit)
{
    hf_study s;
    hf_summary summary = {.seed = 18446744073709551615u,
                          .stage = {[HF_STAGE_FORM].exists = true, [HF_STAGE_SEARCH].exists = true},
                          .search.evaluations = 5000000000};
    open_study(&s);
    hf_points points = read_points(&s); /* the folder is not there yet */
    ck_assert_int_eq(points.count[HF_POINT_MISSING], 5);
    hf_points_free(&points);
    summary.stage[HF_STAGE_FORM].result.psi_m = 0.1 + 0.2;
    summary.stage[HF_STAGE_FORM].result.residual_N = (double)NAN;
    summary.stage[HF_STAGE_SEARCH].result.psi_m = 5e-324;
    write_point(&s, 2, HF_OK, "", &summary);
    write_point(&s, 4, HF_COLLAPSED, "cable\t'a'\nfell", &summary);
    points = read_points(&s);
    ck_assert_int_eq(points.count[HF_POINT_MISSING], 3);
    ck_assert_int_eq(points.count[HF_POINT_DONE], 1);
    ck_assert_int_eq(points.count[HF_POINT_FAILED], 1);
    const hf_point *p = &points.point[2];
    ck_assert_double_eq(strtod(p->field[column_of("/form", "psi_m")], NULL), 0.1 + 0.2);
    ck_assert(isnan(strtod(p->field[column_of("/form", "residual_N")], NULL)));
    ck_assert_double_eq(strtod(p->field[column_of("/search", "psi_m")], NULL), 5e-324);
    ck_assert_str_eq(p->field[column_of("/", "seed")], "18446744073709551615");
    ck_assert_str_eq(p->field[column_of("/search", "evaluations")], "5000000000");
    ck_assert_str_eq(p->field[column_of("/refine", "psi_m")], ""); /* there was no such stage */
    ck_assert_int_eq(points.point[4].status, HF_COLLAPSED);
    ck_assert_str_eq(points.point[4].reason, "cable 'a' fell");
    hf_points_free(&points);
    hf_study_free(&s);
}
END_TEST

/* The longest row that there is: load cases with the longest names and all their errors, read to the last one. */
START_TEST(all_load_cases_come_back)
{
    hf_study s;
    hf_summary *summary = calloc(1, sizeof *summary);
    summary->stage[HF_STAGE_FORM].exists = true;
    summary->n_load_case = HF_LOAD_CASES_MAX;
    summary->load_case = calloc(HF_LOAD_CASES_MAX, sizeof *summary->load_case);
    summary->surface.frequencies_Hz.n = HF_LIST_MAX;
    for (int k = 0; k < HF_LIST_MAX; k++)
        summary->surface.frequencies_Hz.value[k] = 1.23456789e-8 * (k + 1);
    for (int k = 0; k < HF_LOAD_CASES_MAX; k++) {
        hf_load_case_summary *load_case = &summary->load_case[k];
        hf_surface_measures *m = &load_case->surface;
        memset(load_case->name, 'a' + k, sizeof load_case->name - 1);
        load_case->result.psi_m = -1.2345678901234567e-300;
        m->is_measured = true;
        m->n_facet = 1;
        for (int i = 0; i < HF_LIST_MAX; i++)
            m->facet_gain_loss_dB[i] = m->facet_fit_gain_loss_dB[i] = -0.1 / 3 * 1e-300;
    }
    summary->load_case[3].result.status = HF_COLLAPSED;
    open_study(&s);
    write_point(&s, 1, HF_OK, "", summary);
    hf_points points = read_points(&s);
    ck_assert_int_eq(points.point[1].state, HF_POINT_DONE);
    const char *text = points.point[1].field[hf_ledger_n_column() + HF_LEDGER_LIST_CASES];
    char name[HF_OBJECTIVE_NAME_SIZE];
    double value;
    int n = 0, n_psi = 0, n_none = 0;
    while (hf_ledger_next_value(HF_LEDGER_LIST_CASES, &text, name, &value)) {
        n++;
        bool is_psi = strstr(name, ".psi_m") != NULL;
        n_none += is_psi && isnan(value);
        n_psi += is_psi && value == -1.2345678901234567e-300;
    }
    ck_assert_int_eq(n_psi, HF_LOAD_CASES_MAX - 1);
    ck_assert_int_eq(n_none, 1); /* without a shape */
    ck_assert_int_eq(n, HF_LOAD_CASES_MAX * (4 + 2 * (2 + HF_LIST_MAX) + 3 * HF_LIST_MAX));
    hf_points_free(&points);
    hf_study_free(&s);
    hf_summary_free(summary);
    free(summary);
}
END_TEST

/* Takes the next value of a list, which must have this name. */
static double value_of(int list, const char **text, const char *wanted)
{
    char name[HF_OBJECTIVE_NAME_SIZE] = "";
    double value = (double)NAN;
    ck_assert_msg(hf_ledger_next_value(list, text, name, &value), "no value %s in '%s'", wanted, *text);
    ck_assert_str_eq(name, wanted);
    return value;
}

/* Its rows have other names of columns and of values. A set keeps its name, whatever that is. */
START_TEST(rows_of_version_0_2_are_read)
{
    static const struct {
        const char *then, *object, *name, *value;
    } column[] = {{"//seed", "/", "seed", "7"},
                  {"//has_polish", "/", "has_refine", "1"},
                  {"//has_optimize", "/", "has_search", "1"},
                  {"/form/n_gene", "/form", "n_variable", "36"},
                  {"/form/psi_m", "/form", "psi_m", "0.25"},
                  {"/form/form_wall_s", "/form", "wall_s", "2"},
                  {"/ga/best_psi_m", "/search", "psi_m", "0.125"},
                  {"/ga/best_n_slack", "/search", "n_slack", "3"},
                  {"/ga/base_psi_m", "/search", "initial_psi_m", "0.5"},
                  {"/ga/optimize_stop", "/search", "algorithm_stop", "2"},
                  {"/polish/polish_iterations", "/refine", "steps", "11"},
                  {"/polish/iterations", "/refine", "iterations", "12"},
                  {"/polish/coupling_max_displacement_m", "/refine", "coupling_deflection_max_m", "0.75"},
                  {"/coupling/max_displacement_m", "/coupling", "deflection_max_m", "0.0625"}};
    static const char lists[] = "goal_0_psi=1 goal_1_displacement=2 goal_2_tension_displacement=3\t"
                                "facet_half_path_rms_m=4 facet_good_to_Hz=5\tcold.largest_tension_N=6 cold.psi_m=7\n";
    enum { N = sizeof column / sizeof *column };
    char text[4096] = "#hifdm-points-1\tfingerprint\tstatus\treason", path[1200], command[1300];
    hf_study s;
    open_study(&s);
    for (int i = 0; i < N; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "\t%s", column[i].then);
    snprintf(text + strlen(text), sizeof text - strlen(text),
             "\t/ga/best_goals\t/surface/polish/errors\t/cases/figures\n%s\t%s\tok\t", s.id[3], s.fingerprint);
    for (int i = 0; i < N; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "\t%s", column[i].value);
    snprintf(text + strlen(text), sizeof text - strlen(text), "\t%s", lists);
    snprintf(command, sizeof command, "mkdir '%s'", folder);
    ck_assert_int_eq(system(command), 0);
    snprintf(path, sizeof path, "%s/points-old-1.tsv", folder);
    write_file(path, text);
    write_point(&s, 1, HF_OK, "",
                &(hf_summary){.seed = 8, .stage[HF_STAGE_FORM].exists = true}); /* of today, beside it */
    hf_points points = read_points(&s);
    ck_assert_int_eq(points.count[HF_POINT_DONE], 2);
    for (int i = 0; i < N; i++)
        ck_assert_str_eq(points.point[3].field[column_of(column[i].object, column[i].name)], column[i].value);
    ck_assert_str_eq(points.point[1].field[column_of("/", "seed")], "8");
    char *const *list = points.point[3].field + hf_ledger_n_column();
    const char *objectives = list[HF_STAGE_SEARCH], *errors = list[HF_N_STAGE + HF_STAGE_REFINE],
               *load_cases = list[HF_LEDGER_LIST_CASES];
    ck_assert(value_of(HF_STAGE_SEARCH, &objectives, "objective_0_psi") == 1);
    ck_assert(value_of(HF_STAGE_SEARCH, &objectives, "objective_1_deflection") == 2);
    ck_assert(value_of(HF_STAGE_SEARCH, &objectives, "objective_2_tension_displacement") == 3);
    ck_assert(value_of(HF_N_STAGE + HF_STAGE_REFINE, &errors, "facet_half_path_rms_m") == 4);
    ck_assert(value_of(HF_N_STAGE + HF_STAGE_REFINE, &errors, "facet_gain_loss_1dB_Hz") == 5);
    ck_assert(value_of(HF_LEDGER_LIST_CASES, &load_cases, "cold.tension_max_N") == 6);
    ck_assert(value_of(HF_LEDGER_LIST_CASES, &load_cases, "cold.psi_m") == 7);
    hf_points_free(&points);
    hf_study_free(&s);
}
END_TEST

/* The objectives of each stage that the run reached, by name, to the last bit. */
START_TEST(objectives_come_back)
{
    hf_study s;
    hf_summary summary = {.stage = {[HF_STAGE_FORM].exists = true, [HF_STAGE_REFINE].exists = true},
                          .objectives = {.n = 2, .name = {"objective_0_psi", "objective_1_tension_edge"}}};
    summary.stage[HF_STAGE_FORM].result.objective[0] = (double)NAN;
    summary.stage[HF_STAGE_FORM].result.objective[1] = 0.1 + 0.2;
    summary.stage[HF_STAGE_REFINE].result.objective[0] = 5e-324;
    summary.stage[HF_STAGE_REFINE].result.objective[1] = INFINITY;
    open_study(&s);
    write_point(&s, 1, HF_OK, "", &summary);
    write_point(&s, 2, HF_OK, "", &(hf_summary){0}); /* no objectives */
    hf_points points = read_points(&s);
    char *const *objectives = points.point[1].field + hf_ledger_n_column(), name[HF_OBJECTIVE_NAME_SIZE];
    const char *form = objectives[0], *refine = objectives[2];
    double value;
    ck_assert_str_eq(objectives[1], ""); /* there was no such stage */
    ck_assert_str_eq(points.point[2].field[hf_ledger_n_column()], "");
    ck_assert(hf_ledger_next_value(0, &form, name, &value) && isnan(value) && !strcmp(name, "objective_0_psi"));
    ck_assert(hf_ledger_next_value(0, &form, name, &value) && value == 0.1 + 0.2 &&
              !strcmp(name, "objective_1_tension_edge"));
    ck_assert(!hf_ledger_next_value(0, &form, name, &value));
    ck_assert(hf_ledger_next_value(2, &refine, name, &value) && value == 5e-324);
    ck_assert(hf_ledger_next_value(2, &refine, name, &value) && value == INFINITY);
    ck_assert(!hf_ledger_next_value(2, &refine, name, &value));
    hf_points_free(&points);
    hf_study_free(&s);
}
END_TEST

/* Names become those of data sets. */
START_TEST(damaged_objectives_are_none)
{
    static const char *const damaged[] = {
        "psi=1", "objective_0/x=1", "objective_0_psi", "objective_0_psi=", "objective_0_psi=x", "=1", ""};
    char name[HF_OBJECTIVE_NAME_SIZE], longest[2 * HF_OBJECTIVE_NAME_SIZE];
    double value;
    for (size_t i = 0; i < sizeof damaged / sizeof *damaged; i++)
        ck_assert(!hf_ledger_next_value(1, &(const char *){damaged[i]}, name, &value));
    snprintf(longest, sizeof longest, "objective_0_%0*d=1", HF_OBJECTIVE_NAME_SIZE, 0);
    ck_assert(!hf_ledger_next_value(1, &(const char *){longest}, name, &value));
    ck_assert_str_eq(hf_ledger_objective_unit("objective_1_tension_mass"), "N");
    ck_assert_str_eq(hf_ledger_objective_unit("objective_15_mass"), "kg");
    ck_assert_str_eq(hf_ledger_objective_unit("objective_0_ratio_edge"), "");
    ck_assert_str_eq(hf_ledger_objective_unit("objective_0_ratios"), "");
}
END_TEST

/* Give the file of rows that was just written the name of another process. */
static void rename_rows(const char *name)
{
    char command[2600];
    snprintf(command, sizeof command, "mv '%s'/points-*-*.tsv '%s/points-%s.tsv'", folder, folder, name);
    ck_assert_int_eq(system(command), 0);
}

/* Whichever is read first: files are read in the order of their names. */
START_TEST(a_success_counts_more_than_a_failure)
{
    static const hf_status status[] = {HF_OK, HF_IO, HF_IO, HF_OK};
    hf_study s;
    hf_summary summary = {0};
    open_study(&s);
    for (int k = 0; k < 4; k++) {
        write_point(&s, k / 2, status[k], status[k] == HF_OK ? "" : "disk full", &summary);
        rename_rows((const char[]){(char)('a' + k), '\0'});
    }
    hf_points points = read_points(&s);
    ck_assert_int_eq(points.count[HF_POINT_DONE], 2);
    ck_assert_str_eq(points.point[0].reason, "");
    hf_points_free(&points);
    hf_study_free(&s);
}
END_TEST

/* Written in the order of their names and against it: the file system may list them in any. */
START_TEST(the_same_row_counts_in_any_order_of_files)
{
    hf_study s;
    open_study(&s);
    for (int k = 0; k < 12; k++) {
        char reason[2] = {(char)('a' + (_i ? 11 - k : k)), '\0'};
        write_point(&s, 0, HF_IO, reason, &(hf_summary){.n_node = k});
        rename_rows(reason);
    }
    hf_points points = read_points(&s);
    ck_assert_str_eq(points.point[0].reason, "l");
    hf_points_free(&points);
    hf_study_free(&s);
}
END_TEST

/* A process that began earlier sees the points that another one finishes, but none that belong to another base case. */
START_TEST(what_others_finish_is_noticed)
{
    hf_study s;
    hf_ledger mine;
    hf_messages m = {0};
    hf_summary summary = {0};
    open_study(&s);
    write_point(&s, 0, HF_OK, "", &summary);
    ck_assert_int_eq(hf_ledger_open(folder, &mine, &m), HF_OK);
    ck_assert_int_eq(hf_ledger_watch(&mine, &s, &m), HF_OK);
    ck_assert(!hf_ledger_is_finished(&mine, 0)); /* before: --retry may ask for it */
    ck_assert(!hf_ledger_is_finished(&mine, 1));
    write_point(&s, 1, HF_OK, "", &summary);
    write_point(&s, 2, HF_COLLAPSED, "fell", &summary);
    s.fingerprint[0] ^= 1;
    write_point(&s, 3, HF_OK, "", &summary);
    s.fingerprint[0] ^= 1;
    for (int i = 0; i < 5; i++)
        ck_assert_int_eq(hf_ledger_is_finished(&mine, i), i == 1 || i == 2);
    hf_ledger_close(&mine, &m);
    hf_study_free(&s);
}
END_TEST

START_TEST(rows_of_another_base_case_are_outdated)
{
    hf_study s;
    hf_summary summary = {0};
    open_study(&s);
    write_point(&s, 0, HF_OK, "", &summary);
    write_point(&s, 1, HF_OK, "", &summary);
    s.fingerprint[0] = s.fingerprint[0] == '0' ? '1' : '0';
    write_point(&s, 1, HF_OK, "", &summary); /* has been run anew since */
    hf_points points = read_points(&s);
    ck_assert_int_eq(points.point[0].state, HF_POINT_OUTDATED);
    ck_assert_int_eq(points.point[1].state, HF_POINT_DONE);
    hf_points_free(&points);
    hf_study_free(&s);
}
END_TEST

/* The disk refuses a row in its middle: what follows begins on a line of its own, and what was written counts. */
START_TEST(a_row_that_fails_takes_no_other_along)
{
    hf_study s;
    hf_summary summary = {0};
    open_study(&s);
    for (long n = 1; n < 12; n++) {
        hf_ledger ledger;
        hf_messages m = {0};
        int n_written = 0;
        bool was_reached = false;
        char command[2600];
        snprintf(command, sizeof command, "rm -rf '%s'", folder);
        ck_assert_int_eq(system(command), 0);
        ck_assert_int_eq(hf_ledger_open(folder, &ledger, &m), HF_OK);
        disturb_calls(true);
        fail_call_at("write", n, EDQUOT, false);
        if (_i) fail_call_at("ftruncate", 1, EIO, false);
        for (int i = 0; i < 5; i++) {
            hf_status status = hf_ledger_write(&ledger, &s, i, HF_OK, "", &summary, &m);
            n_written += status == HF_OK;
            if (status != HF_OK) was_reached = end_call_failure();
        }
        disturb_calls(false);
        end_call_failure();
        ck_assert(was_reached);
        ck_assert_int_eq(n_written, 4);
        ck_assert_int_eq(m.n_error, 1);
        ck_assert_ptr_nonnull(strstr(m.text, strerror(EDQUOT)));
        ck_assert_int_eq(hf_ledger_close(&ledger, &m), HF_OK);
        hf_points points = read_points(&s);
        ck_assert_int_eq(points.count[HF_POINT_DONE], 4);
        hf_points_free(&points);
        hf_messages_free(&m);
    }
    hf_study_free(&s);
}
END_TEST

/* The first row is synced, since it is long after the last sync. */
START_TEST(a_row_goes_to_the_disk)
{
    hf_study s;
    hf_summary summary = {0};
    hf_ledger ledger;
    hf_messages m = {0};
    open_study(&s);
    ck_assert_int_eq(hf_ledger_open(folder, &ledger, &m), HF_OK);
    fail_call_at("fdatasync", 1, EIO, false);
    ck_assert_int_eq(hf_ledger_write(&ledger, &s, 0, HF_OK, "", &summary, &m), HF_IO);
    ck_assert(end_call_failure());
    ck_assert_int_eq(hf_ledger_close(&ledger, &m), HF_OK);
    hf_messages_free(&m);
    hf_study_free(&s);
}
END_TEST

/* What a close or a sync says at the end is an error. */
START_TEST(rows_that_do_not_reach_the_disk)
{
    static const char *const name[] = {"close", "fdatasync"};
    hf_study s;
    hf_summary summary = {0};
    hf_ledger ledger;
    hf_messages m = {0};
    open_study(&s);
    ck_assert_int_eq(hf_ledger_open(folder, &ledger, &m), HF_OK);
    ck_assert_int_eq(hf_ledger_write(&ledger, &s, 0, HF_OK, "", &summary, &m), HF_OK);
    fail_call_at(name[_i], 1, EIO, false);
    ck_assert_int_eq(hf_ledger_close(&ledger, &m), HF_IO);
    ck_assert(end_call_failure());
    ck_assert_ptr_nonnull(strstr(m.text, "cannot write to the disk: Input/output error"));
    hf_messages_free(&m);
    hf_study_free(&s);
}
END_TEST

/* A process was killed while it wrote: cut the file at every byte. Whole rows count, nothing else does. */
START_TEST(torn_rows_are_ignored)
{
    hf_study s;
    hf_summary summary = {0};
    hf_ledger ledger;
    hf_messages m = {0};
    char path[1200], command[2600];
    open_study(&s);
    ck_assert_int_eq(hf_ledger_open(folder, &ledger, &m), HF_OK);
    for (int i = 0; i < 2; i++)
        ck_assert_int_eq(hf_ledger_write(&ledger, &s, i, HF_OK, "", &summary, &m), HF_OK);
    hf_ledger_close(&ledger, &m);
    snprintf(path, sizeof path, "%s/points-x.tsv", folder);
    snprintf(command, sizeof command, "mv '%s'/points-*-*.tsv '%s'", folder, path);
    ck_assert_int_eq(system(command), 0);
    size_t size;
    char *text = read_file(path, &size);
    size_t second = (size_t)(strchr(strchr(text, '\n') + 1, '\n') + 1 - text),
           first = (size_t)(strchr(text, '\n') + 1 - text);
    for (size_t cut = 0; cut <= size; cut += cut < first ? 97 : 1) {
        char kept = text[cut];
        text[cut] = '\0';
        write_file(path, text);
        text[cut] = kept;
        hf_points points = read_points(&s);
        ck_assert_int_eq(points.count[HF_POINT_DONE], cut < second ? 0 : cut < size ? 1 : 2);
        hf_points_free(&points);
    }
    free(text);
    hf_study_free(&s);
}
END_TEST

/* A child process holds two points: they count as running while the child lives, and no longer. */
START_TEST(a_point_runs_as_long_as_its_process_lives)
{
    hf_study s;
    hf_messages m = {0};
    hf_ledger mine;
    int ready[2], end[2];
    char byte;
    open_study(&s);
    ck_assert_int_eq(hf_ledger_open(folder, &mine, &m), HF_OK);
    ck_assert(pipe(ready) == 0 && pipe(end) == 0);
    pid_t child = fork();
    if (child == 0) {
        hf_ledger theirs;
        if (hf_ledger_open(folder, &theirs, &m) == HF_OK && hf_ledger_claim(&theirs, s.id[1]) == HF_LOCK_OURS &&
            hf_ledger_claim(&theirs, s.id[3]) == HF_LOCK_OURS && write(ready[1], "x", 1) == 1 &&
            read(end[0], &byte, 1) == 1)
            kill(getpid(), SIGKILL);
        _exit(1);
    }
    ck_assert_int_eq(read(ready[0], &byte, 1), 1);
    hf_points points = read_points(&s);
    ck_assert_int_eq(points.count[HF_POINT_RUNNING], 2);
    ck_assert(points.point[1].state == HF_POINT_RUNNING && points.point[3].state == HF_POINT_RUNNING);
    hf_points_free(&points);
    ck_assert_int_eq(hf_ledger_claim(&mine, s.id[1]), HF_LOCK_TAKEN);
    ck_assert_int_eq(hf_ledger_claim(&mine, s.id[2]), HF_LOCK_OURS);
    ck_assert_int_eq(write(end[1], "x", 1), 1);
    int how;
    ck_assert_int_eq(waitpid(child, &how, 0), child);
    ck_assert(WIFSIGNALED(how) && WTERMSIG(how) == SIGKILL);
    points = read_points(&s);
    ck_assert_int_eq(points.count[HF_POINT_RUNNING], 0);
    hf_points_free(&points);
    ck_assert_int_eq(hf_ledger_claim(&mine, s.id[1]), HF_LOCK_OURS);
    hf_ledger_close(&mine, &m);
    hf_study_free(&s);
}
END_TEST

/* A point that is given back is free at once, for other processes as well, while all others stay claimed. */
START_TEST(a_released_point_is_free)
{
    hf_study s;
    hf_messages m = {0};
    hf_ledger mine;
    open_study(&s);
    ck_assert_int_eq(hf_ledger_open(folder, &mine, &m), HF_OK);
    for (int i = 1; i <= 3; i++)
        ck_assert_int_eq(hf_ledger_claim(&mine, s.id[i]), HF_LOCK_OURS);
    hf_ledger_release(&mine, s.id[2]);
    pid_t child = fork();
    if (child == 0) {
        hf_ledger theirs;
        bool is_free =
            hf_ledger_open(folder, &theirs, &m) == HF_OK && hf_ledger_claim(&theirs, s.id[1]) == HF_LOCK_TAKEN &&
            hf_ledger_claim(&theirs, s.id[2]) == HF_LOCK_OURS && hf_ledger_claim(&theirs, s.id[3]) == HF_LOCK_TAKEN;
        _exit(is_free ? 0 : 1);
    }
    int how;
    ck_assert_int_eq(waitpid(child, &how, 0), child);
    ck_assert(WIFEXITED(how) && WEXITSTATUS(how) == 0);
    hf_ledger_close(&mine, &m);
    hf_study_free(&s);
}
END_TEST

/* Nothing of the folder is waited for, neither when a sweep begins nor later, and what cannot be rows is not read. */
START_TEST(what_is_no_table_is_in_the_way)
{
    static const char *const command[] = {"mkfifo '%s'", "mkdir '%s'", "truncate -s 40G '%s'"};
    static const char *const words[] = {
        ": this is not a regular file. Remove it\n", ": this is not a regular file. Remove it\n",
        ": this file is larger than 4096 MB, so it is not a table of hifdm. Remove it\n"};
    hf_study s;
    hf_ledger mine;
    hf_points points;
    hf_messages m = {0};
    char path[1200], line[1300];
    open_study(&s);
    ck_assert_int_eq(hf_ledger_open(folder, &mine, &m), HF_OK);
    ck_assert_int_eq(hf_ledger_watch(&mine, &s, &m), HF_OK);
    snprintf(path, sizeof path, "%s/points-a.tsv", folder);
    snprintf(line, sizeof line, command[_i], path);
    ck_assert_int_eq(system(line), 0);
    write_point(&s, 1, HF_OK, "", &(hf_summary){0});
    ck_assert(hf_ledger_is_finished(&mine, 1));
    ck_assert_int_eq(hf_ledger_read(folder, &s, &points, &m), HF_IO);
    ck_assert_ptr_nonnull(strstr(m.text, path));
    ck_assert_ptr_nonnull(strstr(m.text, words[_i]));
    hf_points_free(&points);
    hf_ledger_close(&mine, &m);
    hf_messages_free(&m);
    hf_study_free(&s);
}
END_TEST

Suite *suite_unit_ledger(void)
{
    Suite *suite = suite_create("unit/ledger");
    TCase *tests = tcase_create("ledger");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, numbers_come_back_bit_by_bit);
    tcase_add_test(tests, objectives_come_back);
    tcase_add_test(tests, all_load_cases_come_back);
    tcase_add_test(tests, rows_of_version_0_2_are_read);
    tcase_add_test(tests, damaged_objectives_are_none);
    tcase_add_test(tests, a_success_counts_more_than_a_failure);
    tcase_add_loop_test(tests, the_same_row_counts_in_any_order_of_files, 0, 2);
    tcase_add_test(tests, what_others_finish_is_noticed);
    tcase_add_test(tests, rows_of_another_base_case_are_outdated);
    tcase_add_loop_test(tests, a_row_that_fails_takes_no_other_along, 0, 2);
    tcase_add_test(tests, a_row_goes_to_the_disk);
    tcase_add_loop_test(tests, rows_that_do_not_reach_the_disk, 0, 2);
    tcase_add_test(tests, torn_rows_are_ignored);
    tcase_add_test(tests, a_point_runs_as_long_as_its_process_lives);
    tcase_add_test(tests, a_released_point_is_free);
    tcase_add_loop_test(tests, what_is_no_table_is_in_the_way, 0, 3);
    return suite;
}
