/* Case files with faults: each message has file:line:col, key and remedy; one run reports all faults of a file. */
#include "nets.h"

#include "case/config_key.h"
#include "case/config_suggest.h"

#define CYLINDER                                                                                                       \
    "scene:\n"                                                                                                         \
    "  parabolic_cylinder: {aperture_m: 10, length_m: 12, focal_length_m: 5, modules: [2, 3], cells_per_module: [4, "  \
    "2]}\n"
#define FORM CYLINDER "form:\n"

/* What hf_config_load says about `text`, without the folder of the file; it must refuse it. */
static const char *complaint(const char *text, const char *override)
{
    static char said[4096];
    hf_messages messages = {0};
    hf_case c;
    const char *path = temp_path("c.yaml");
    write_file(path, text);
    hf_status status = hf_config_load(path, &override, override != NULL, &c, &messages);
    copy_without_folder(messages.text, said, sizeof said);
    ck_assert_msg(status == HF_BAD_CASE, "not refused:\n%s", text);
    ck_assert_int_gt(messages.n_error, 0);
    hf_messages_free(&messages);
    hf_case_free(&c);
    return said;
}

static const struct {
    const char *text, *override, *said;
} faulty[] = {
    {FORM "  pretention_N: 10\n", NULL, "error: c.yaml:4:3: pretention_N: unknown key; did you mean 'pretension_N'?\n"},
    {CYLINDER "frm: {}\n", NULL, "error: c.yaml:3:1: frm: unknown key; did you mean 'form'?\n"},
    {CYLINDER "pretension_N: 10\n", NULL,
     "error: c.yaml:3:1: pretension_N: unknown key; did you mean 'form.pretension_N'?\n"},
    {FORM "  colour: red\n", NULL, "error: c.yaml:4:3: colour: unknown key (hifdm schema lists all keys)\n"},
    {FORM "  stop: residual\n  method: fdm\n  stop: residual\n", NULL,
     "error: c.yaml:6:3: stop: this key stands here already, on line 4\n"},
    {CYLINDER "form: {}\nform: {}\n", NULL, "error: c.yaml:4:1: form: this key stands here already, on line 3\n"},
    {FORM "  [a, b]: 1\n", NULL, "error: c.yaml:4:3: form: a key must be a plain word\n"},
    {FORM "  ? {a: b}\n  : 1\n", NULL, "error: c.yaml:4:5: form: a key must be a plain word\n"},
    {FORM "  <<: {stop: residual}\n", NULL, "error: c.yaml:4:3: <<: unknown key (hifdm schema lists all keys)\n"},
    {FORM "  pretension_N: \"ten\"\n", NULL, "error: c.yaml:4:17: form.pretension_N: must be a number, not a text\n"},
    {FORM "  pretension_N: ten\n", NULL, "error: c.yaml:4:17: form.pretension_N: must be a number, not a text\n"},
    {FORM "  pretension_N: [1]\n", NULL, "error: c.yaml:4:17: form.pretension_N: must be a number\n"},
    {FORM "  pretension_N: {a: 1}\n", NULL, "error: c.yaml:4:17: form.pretension_N: must be a number\n"},
    {FORM "  pretension_N: \n", NULL, "error: c.yaml:4:16: form.pretension_N: must be a number, not a text\n"},
    {FORM "  pretension_N: ~\n", NULL, "error: c.yaml:4:17: form.pretension_N: must be a number, not a text\n"},
    {FORM "  pretension_N: nan\n", NULL, "error: c.yaml:4:17: form.pretension_N: must be a finite number, not nan\n"},
    {FORM "  pretension_N: .nan\n", NULL, "error: c.yaml:4:17: form.pretension_N: must be a finite number, not .nan\n"},
    {FORM "  pretension_N: .inf\n", NULL, "error: c.yaml:4:17: form.pretension_N: must be a finite number, not .inf\n"},
    {FORM "  pretension_N: 0x10\n", NULL, "error: c.yaml:4:17: form.pretension_N: must be a number, not a text\n"},
    {FORM "  pretension_N: 1_000\n", NULL, "error: c.yaml:4:17: form.pretension_N: must be a number, not a text\n"},
    {FORM "  pretension_N: 1:30\n", NULL, "error: c.yaml:4:17: form.pretension_N: must be a number, not a text\n"},
    {FORM "  pretension_N: 1e999\n", NULL,
     "error: c.yaml:4:17: form.pretension_N: must be a finite number, not 1e999\n"},
    {FORM "  pretension_N: 10 N\n", NULL,
     "error: c.yaml:4:17: form.pretension_N: must be a number, not a text; the unit is in the key's name\n"},
    {FORM "  pretension_N: 10N\n", NULL,
     "error: c.yaml:4:17: form.pretension_N: must be a number, not a text; the unit is in the key's name\n"},
    {FORM "  max_iterations: 1.5\n", NULL,
     "error: c.yaml:4:19: form.max_iterations: must be a whole number, not 1.5\n"},
    {FORM "  max_iterations: 1e3\n", NULL,
     "error: c.yaml:4:19: form.max_iterations: must be a whole number, not 1e3\n"},
    {FORM "  max_iterations: true\n", NULL,
     "error: c.yaml:4:19: form.max_iterations: must be a whole number, not true\n"},
    {FORM "  max_iterations: 5 6\n", NULL,
     "error: c.yaml:4:19: form.max_iterations: must be a whole number, not 5 6\n"},
    {FORM "  max_iterations: \"5\"\n", NULL, "error: c.yaml:4:19: form.max_iterations: must be a whole number\n"},
    {CYLINDER "optimize: {seed: -1}\n", NULL,
     "error: c.yaml:3:18: optimize.seed: must be a whole number from 0 to 18446744073709551615\n"},
    {CYLINDER "optimize: {seed: 18446744073709551616}\n", NULL,
     "error: c.yaml:3:18: optimize.seed: must be a whole number from 0 to 18446744073709551615\n"},
    {FORM "  stop: Residual\n", NULL,
     "error: c.yaml:4:9: form.stop: must be one of residual rms_change, not Residual; did you mean 'residual'?\n"},
    {FORM "\tstop: residual\n", NULL,
     "error: c.yaml:4:1: YAML: a tab: lines are set in by blanks, and no tab stands before a value\n"},
    {FORM "  stop: @\n", NULL, "error: c.yaml:4:9: YAML: found character that cannot start any token\n"},
    {FORM "  pretension_N: 10,5\n", NULL,
     "error: c.yaml:4:17: form.pretension_N: has a decimal comma, and numbers have points: 10,5\n"},
    {CYLINDER "form: {pretension_N: 10,5}\n", NULL,
     "error: c.yaml:3:25: 5: unknown key; is it behind a decimal comma? Numbers have points\n"},
    {FORM "  stop: [residual]\n", NULL,
     "error: c.yaml:4:9: form.stop: must be one of residual rms_change, not a list or section\n"},
    {CYLINDER "title: [a]\n", NULL, "error: c.yaml:3:8: title: must be a text\n"},
    {CYLINDER "form: 7\n", NULL,
     "error: c.yaml:3:1: form: must be a section of key: value lines ({} takes every default)\n"},
    {CYLINDER "form:\n", NULL,
     "error: c.yaml:3:1: form: must be a section of key: value lines ({} takes every default)\n"},
    {CYLINDER, "scene.parabolic_cylinder.modules=[1]",
     "error: --set scene.parabolic_cylinder.modules=[1]: scene.parabolic_cylinder.modules: must be a list of two whole "
     "numbers, like [5, 5]\n"},
    {CYLINDER, "scene.parabolic_cylinder.modules=[1, 2, 3]",
     "error: --set scene.parabolic_cylinder.modules=[1, 2, 3]: scene.parabolic_cylinder.modules: must be a list of two "
     "whole numbers, like [5, 5]\n"},
    {CYLINDER, "scene.parabolic_cylinder.modules=5",
     "error: --set scene.parabolic_cylinder.modules=5: scene.parabolic_cylinder.modules: must be a list of two whole "
     "numbers, like [5, 5]\n"},
    {CYLINDER, "scene.parabolic_cylinder.modules={a: 1}",
     "error: --set scene.parabolic_cylinder.modules={a: 1}: scene.parabolic_cylinder.modules: must be a list of two "
     "whole numbers, like [5, 5]\n"},
    {CYLINDER, "scene.parabolic_cylinder.modules=[1, [2]]",
     "error: --set scene.parabolic_cylinder.modules=[1, [2]]: scene.parabolic_cylinder.modules: must be a whole "
     "number\n"},
    {FORM "  pretension_N: 0\n", NULL,
     "error: c.yaml:4:17: form.pretension_N: must be above 0 and at most 1000000000, not 0\n"},
    {FORM "  pretension_N: -10\n", NULL,
     "error: c.yaml:4:17: form.pretension_N: must be above 0 and at most 1000000000, not -10\n"},
    {FORM "  collapse_ratio: 0.6\n", NULL,
     "error: c.yaml:4:19: form.collapse_ratio: must be at least 1e-12 and at most 0.5, not 0.6\n"},
    {FORM "  max_iterations: 0\n", NULL,
     "error: c.yaml:4:19: form.max_iterations: must be at least 1 and at most 10000000, not 0\n"},
    {FORM "  max_iterations: -3\n", NULL,
     "error: c.yaml:4:19: form.max_iterations: must be at least 1 and at most 10000000, not -3\n"},
    {FORM "  max_iterations: 99999999999999999999\n", NULL,
     "error: c.yaml:4:19: form.max_iterations: must be at least 1 and at most 10000000, not 99999999999999999999\n"},
    {CYLINDER "optimize: {stagnation_tolerance_m: -1}\n", NULL,
     "error: c.yaml:3:36: optimize.stagnation_tolerance_m: must be at least 0, not -1\n"},
    {FORM "  rms_tolerance_m: 0\n", NULL, "error: c.yaml:4:20: form.rms_tolerance_m: must be above 0, not 0\n"},
    {"form: {}\n", NULL, "error: c.yaml: scene: needs either parabolic_cylinder or paraboloid or import\n"},
    {CYLINDER "  import: {nodes: n.csv, cables: c.csv}\n", NULL,
     "error: c.yaml: scene: has both parabolic_cylinder and import; keep one\n"},
    {"scene:\n  import: {nodes: n.csv}\n", NULL, "error: c.yaml: scene.import.cables: is missing and has no default\n"},
    {"scene:\n  import: {nodes: \"\", cables: c.csv}\n", NULL,
     "error: c.yaml:2:19: scene.import.nodes: must be a text\n"},
    {CYLINDER "optimize:\n  min_tension_N: 5\n  max_tension_N: 5\n", NULL,
     "error: c.yaml:4:18: optimize.min_tension_N: must be below optimize.max_tension_N\n"},
    {CYLINDER "optimize: {elites: 9, population: 9}\n", NULL,
     "error: c.yaml:3:20: optimize.elites: must be below optimize.population\n"},
    {CYLINDER "form: {factor: lapack}\noptimize: {solver: chord}\n", NULL,
     "error: c.yaml:4:20: optimize.solver: chord shares one factor among designs, which form.factor: lapack does not; "
     "use newton, fixed_point or auto\n"},
    {CYLINDER "optimize: {crossover_low: 0.95}\n", NULL,
     "error: c.yaml:3:27: optimize.crossover_low: must not be above optimize.crossover_high\n"},
    {CYLINDER "optimize: {}\n", "optimize.mutation_low=0.5",
     "error: --set optimize.mutation_low: must not be above optimize.mutation_high\n"},
    {CYLINDER, "pretension", "error: --set pretension: must be key=value, like form.pretension_N=12\n"},
    {CYLINDER, "title=\"a\nb\"", "error: --set title=\"a\\nb\": must be on one line\n"},
    {CYLINDER, "=5", "error: --set =5: must be key=value, like form.pretension_N=12\n"},
    {CYLINDER,
     "form.pretension_N=", "error: --set form.pretension_N=: form.pretension_N: there is no value after the '='\n"},
    {CYLINDER, "form.pretention_N=5",
     "error: --set form.pretention_N=5: pretention_N: unknown key; did you mean 'pretension_N'?\n"},
    {CYLINDER, "form=5", "error: --set form=5: form: must be a section of key: value lines ({} takes every default)\n"},
    {CYLINDER, "form.pretension_N=0",
     "error: --set form.pretension_N=0: form.pretension_N: must be above 0 and at most 1000000000, not 0\n"},
    {"{scene: {parabolic_cylinder: {aperture_m: 10, length_m: 12, focal_length_m: 5, modules: [2, 3], "
     "cells_per_module: [4, 2]}}, sweep: {form.pretension_N: [1, 2]}}\n",
     "form.pretension_N=5", "error: c.yaml:1:125: sweep: must stand on lines of its own\n"},
    {"", NULL, "error: c.yaml:1:1: case: the file is empty\n"},
    {"# nothing\n", NULL, "error: c.yaml:1:1: case: the file is empty\n"},
    {"- a\n- b\n", NULL, "error: c.yaml:1:1: case: must be key: value lines\n"},
    {CYLINDER "---\n" CYLINDER, NULL, "error: c.yaml:3:1: YAML: a second document in this file; one case per file\n"},
};
enum { N_FAULTY = sizeof faulty / sizeof *faulty };

START_TEST(faults_are_told_where_they_are)
{
    ck_assert_str_eq(complaint(faulty[_i].text, faulty[_i].override), faulty[_i].said);
}
END_TEST

START_TEST(all_faults_are_told_in_one_run)
{
    const char *said = complaint("scene:\n"
                                 "  parabolic_cylinder:\n"
                                 "    aperture_m: ten\n"
                                 "    lenght_m: 12\n"
                                 "    focal_length_m: -5\n"
                                 "    modules: [2, 3]\n"
                                 "    modules: [2, 4]\n"
                                 "form: {pretension_N: 1e400}\n",
                                 "form.stop=never");
    ck_assert_str_eq(
        said,
        "error: c.yaml:3:17: scene.parabolic_cylinder.aperture_m: must be a number, not a text\n"
        "error: c.yaml:4:5: lenght_m: unknown key; did you mean 'length_m'?\n"
        "error: c.yaml:5:21: scene.parabolic_cylinder.focal_length_m: must be above 0 and at most 1000000000, not -5\n"
        "error: c.yaml:7:5: modules: this key stands here already, on line 6\n"
        "error: c.yaml:8:22: form.pretension_N: must be a finite number, not 1e400\n"
        "error: --set form.stop=never: form.stop: must be one of residual rms_change, not never\n"
        "error: c.yaml: scene.parabolic_cylinder.length_m: is missing and has no default\n"
        "error: c.yaml: scene.parabolic_cylinder.cells_per_module: is missing and has no default\n");
}
END_TEST

/* The words after "YAML: " are libyaml's own. */
START_TEST(broken_yaml_is_told_where_it_breaks)
{
    static const struct {
        const char *text, *said;
    } broken[] = {
        {CYLINDER "form: {stop: residual\n", "error: c.yaml:4:1: YAML: "},
        {CYLINDER "form:\n\tstop: residual\n", "error: c.yaml:4:1: YAML: "},
        {CYLINDER "title: *nowhere\n", "error: c.yaml:3:8: YAML: "},
        {CYLINDER "title: \"open\n", "error: c.yaml:4:1: YAML: "},
    };
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
        const char *said = complaint(broken[i].text, NULL);
        ck_assert_msg(!strncmp(said, broken[i].said, strlen(broken[i].said)), "%s", said);
        ck_assert_ptr_eq(strchr(said, '\n'), said + strlen(said) - 1); /* one line, no faults that follow from it */
    }
}
END_TEST

/* The parser must neither crash nor hang on absurdly deep nesting. */
START_TEST(deep_nesting_is_refused)
{
    enum { DEPTH = 20000 };
    static char text[2 * DEPTH + 64];
    strcpy(text, "title: ");
    memset(text + 7, '[', DEPTH);
    memset(text + 7 + DEPTH, ']', DEPTH);
    ck_assert_ptr_nonnull(strstr(complaint(text, NULL), "c.yaml:1:"));
}
END_TEST

START_TEST(long_keys_and_texts_are_refused)
{
    char text[3000] = CYLINDER;
    size_t n = strlen(text);
    memset(text + n, 'k', 500);
    strcpy(text + n + 500, ": 1\n");
    ck_assert_ptr_nonnull(strstr(complaint(text, NULL), "unknown key"));
    strcpy(text + n, "title: ");
    memset(text + n + 7, 't', 256); /* one more than title holds with its NUL */
    strcpy(text + n + 7 + 256, "\n");
    ck_assert_str_eq(complaint(text, NULL), "error: c.yaml:3:8: title: is too long\n");
}
END_TEST

START_TEST(missing_and_binary_files_are_refused)
{
    hf_messages m = {0};
    hf_case c;
    ck_assert_int_eq(hf_config_load(temp_path("none.yaml"), NULL, 0, &c, &m), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(m.text, "none.yaml: cannot open"));
    hf_messages_free(&m);
    hf_case_free(&c);
    ck_assert_ptr_nonnull(strstr(complaint("\x89HDF\r\n\x1a\n", NULL), "is an HDF5 file, not a case"));
}
END_TEST

/* Keys of other programs: what is named instead is there. */
START_TEST(what_others_call_a_key_is_known)
{
    static const struct {
        const char *section, *key, *meant;
    } of[] = {{"optimize", "max_iterations", "'optimize.refine_steps'"},
              {"optimize", "nGen", "'optimize.generations'"},
              {"optimize", "pop_size", "'optimize.population'"},
              {"optimize", "tol", "'optimize.stagnation_tolerance_m'"},
              {"optimize", "algorithm", "'optimize.method'"},
              {"optimize", "bounds", "'optimize.range_N'"},
              {"form", "tolerance", "'form.residual_tolerance'"},
              {"form", "max_iter", "'form.max_iterations'"},
              {"form", "solver", "'form.method'"},
              {"tolerance", "sigma", "'tolerance.sigma_cut_m'"},
              {"tolerance", "n_samples", "'tolerance.samples'"},
              {"surface", "freq", "'surface.frequencies_Hz'"},
              {"truss", "E", "'truss.E_Pa'"},
              {"truss.ring", "young_modulus", "'truss.E_Pa'"},
              {"scene.paraboloid", "diameter", "'scene.paraboloid.aperture_m'"},
              {"scene.paraboloid", "f", "'scene.paraboloid.focal_length_m'"},
              {"scene.paraboloid", "depth_m", "'scene.paraboloid.rear_distance_m'"},
              {"", "seed", "'tolerance.seed'"},
              {"", "iterations", "'optimize.generations'"},
              {"", "threads", "--threads"},
              {"scene", "EA", "'scene.EA_inner_N'"},
              {"", "young_modulus", "'scene.EA_boundary_N'"},
              {"", "tension", "'form.pretension_N'"},
              {"", "loads", "'scene.import.nodes'"},
              {"", "gravity", "'load_cases'"},
              {"", "material", "'truss.density_kg_per_m3'"},
              {"", "focal_length", "'surface.focal_length_m'"},
              {"surface", "aperture", "'scene.paraboloid.aperture_m'"},
              {"", "output", "-o "}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        const char *meant = hf_config_suggestion(of[i].section, of[i].key);
        ck_assert_msg(meant && strstr(meant, of[i].meant), "%s: %s", of[i].key, meant ? meant : "nothing");
        for (const char *quote = strchr(meant, '\''); quote; quote = strchr(quote, '\'')) {
            char path[HF_KEY_SIZE];
            hf_key key;
            snprintf(path, sizeof path, "%.*s", (int)strcspn(quote + 1, "'"), quote + 1);
            ck_assert_msg(hf_key_find(path, &key) || hf_key_find_list(path), "%s is no key", path);
            quote += strlen(path) + 2;
        }
    }
    ck_assert_ptr_null(hf_config_suggestion("form", "seeds"));
    ck_assert_ptr_null(hf_config_suggestion("formal", "solver"));
    static const char *const row[] = {"optimize.objective.0", "optimize.variables.1", "optimize.limits.0"};
    for (int i = 0; i < 3; i++)
        ck_assert_ptr_null(hf_config_suggestion(row[i], "tol"));
    ck_assert_ptr_null(hf_config_suggestion("tolerance.require.0", "n"));
    ck_assert_ptr_nonnull(strstr(complaint(FORM "  pretension_N: 10\n", "optimize.max_iterations=9"),
                                 "; did you mean 'optimize.refine_steps' (steps of Levenberg-Marquardt) or "));
}
END_TEST

Suite *suite_unit_config_faults(void)
{
    Suite *suite = suite_create("unit/config_faults");
    TCase *tests = tcase_create("config_faults");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, faults_are_told_where_they_are, 0, N_FAULTY);
    tcase_add_test(tests, what_others_call_a_key_is_known);
    tcase_add_test(tests, broken_yaml_is_told_where_it_breaks);
    tcase_add_test(tests, all_faults_are_told_in_one_run);
    tcase_add_test(tests, deep_nesting_is_refused);
    tcase_add_test(tests, long_keys_and_texts_are_refused);
    tcase_add_test(tests, missing_and_binary_files_are_refused);
    return suite;
}
