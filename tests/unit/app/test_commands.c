/* Commands that are run again and again in one process, as the fuzzers do: nothing of a call is left for the next. */
#include "support.h"

#include "app/cmd.h"
#include "app/options.h"

#include <stdlib.h>
#include <string.h>

static const char case_text[] = "scene: {parabolic_cylinder: {aperture_m: 2, length_m: 2, focal_length_m: 3,\n"
                                "  modules: [1, 1], cells_per_module: [2, 2], scallop: 0.1}}\n"
                                "form: {pretension_N: 10}\n";

/* Runs a command. Returns its messages, until the next call, and what it printed in `printed`. */
static const char *run(const hf_options *options, hf_status expected, char *printed, size_t size)
{
    static char said[4096];
    hf_messages messages = {0};
    FILE *file = fmemopen(printed, size, "w");
    ck_assert_ptr_nonnull(file);
    hf_status status = options->command->run(options, file, &messages);
    fclose(file);
    ck_assert_msg(status == expected, "%s", messages.text ? messages.text : "no message");
    snprintf(said, sizeof said, "%s", messages.text ? messages.text : "");
    hf_messages_free(&messages);
    return said;
}

START_TEST(evaluate_after_a_table_with_faults)
{
    static char first[4096], again[4096], none[4096];
    char *path = strdup(temp_path("case.yaml")), *table = strdup(temp_path("designs.csv"));
    write_file(path, case_text);
    hf_options template = {.command = &hf_cmd_evaluate, .file = path, .template_path = table, .force = true};
    run(&template, HF_OK, none, sizeof none);
    hf_options options = {.command = &hf_cmd_evaluate, .file = path, .designs = table, .threads = 1};
    char *text = read_file(table, NULL);
    run(&options, HF_OK, first, sizeof first);
    ck_assert_ptr_nonnull(strstr(first, "psi_m"));
    strchr(text, '\n')[1] = '\0'; /* no rows */
    write_file(table, text);
    for (int i = 0; i < 2; i++)
        ck_assert_ptr_nonnull(strstr(run(&options, HF_BAD_CASE, none, sizeof none), "no rows"));
    run(&template, HF_OK, none, sizeof none);
    run(&options, HF_OK, again, sizeof again);
    ck_assert_str_eq(again, first);
    free(text);
    free(table);
    free(path);
}
END_TEST

/* Writes the positions of a result to a table, those of every fourth node 0.2 mm higher. */
static void measure(const hf_options *result, const char *table)
{
    static char printed[4096];
    char *folder = strdup(temp_path("shape")), name[4096], id[64];
    hf_options options = {.command = &hf_cmd_export, .file = result->output, .force = true};
    options.export_to[0] = folder; /* --csv is the first exporter */
    run(&options, HF_OK, printed, sizeof printed);
    snprintf(name, sizeof name, "%s/nodes.csv", folder);
    char *text = read_file(name, NULL), *line = strchr(text, '\n');
    double x[3];
    FILE *file = fopen(table, "w");
    ck_assert_ptr_nonnull(file);
    fputs("id,x_m,y_m,z_m\n", file);
    for (int i = 0; line && sscanf(line + 1, "%63[^,],%lf,%lf,%lf", id, &x[0], &x[1], &x[2]) == 4; i++) {
        fprintf(file, "%s,%.17g,%.17g,%.17g\n", id, x[0], x[1], x[2] + (i % 4 ? 0 : 2e-4));
        line = strchr(line + 1, '\n');
    }
    fclose(file);
    free(text);
    free(folder);
}

START_TEST(adjust_after_a_table_with_faults)
{
    static const char sections[] =
        "tolerance: {sigma_cut_m: 0.0001}\n"
        "adjust: {set: inner, range_m: 0.002, step_m: 0.0001, max_adjustments: 3, sigma_m: 0.0001}\n";
    static char printed[4096], first[4096];
    char *path = strdup(temp_path("built.yaml")), *table = strdup(temp_path("measured.csv"));
    char *bare = strdup(temp_path("case.yaml")), *bad = strdup(temp_path("bad.csv"));
    char *output = strdup(temp_path("built.h5")), text[sizeof case_text + sizeof sections + 100];
    const char *inside = strstr(case_text, "}}");
    write_file(bare, case_text);
    write_file(bad, "id,x_m,y_m,z_m\nnowhere,1,2,3\n");
    sprintf(text, "%.*s}, EA_inner_N: 47000, EA_boundary_N: 47000%s%s", (int)(inside - case_text), case_text,
            inside + 1, sections);
    write_file(path, text);
    hf_options result = {
        .command = &hf_cmd_run, .file = path, .output = output, .threads = 1, .task = -1, .quiet = true};
    run(&result, HF_OK, printed, sizeof printed);
    measure(&result, table);
    hf_options options = {.command = &hf_cmd_adjust, .file = path, .measured = table, .threads = 1};
    run(&options, HF_OK, first, sizeof first);
    ck_assert_ptr_nonnull(strstr(first, "psi"));
    for (int i = 0; i < 4; i++) {
        options.file = i % 2 ? bare : path; /* without the sections, the command ends before it allocates */
        options.measured = bad;
        const char *said = run(&options, HF_BAD_CASE, printed, sizeof printed);
        ck_assert_ptr_nonnull(strstr(said, i % 2 ? "tolerance" : "nowhere"));
    }
    options.file = path;
    options.measured = table;
    run(&options, HF_OK, printed, sizeof printed);
    ck_assert_str_eq(printed, first);
    free(output);
    free(bad);
    free(bare);
    free(table);
    free(path);
}
END_TEST

Suite *suite_unit_commands(void)
{
    Suite *suite = suite_create("unit/app/commands");
    TCase *tcase = tcase_create("again");
    tcase_add_test(tcase, evaluate_after_a_table_with_faults);
    tcase_add_test(tcase, adjust_after_a_table_with_faults);
    suite_add_tcase(suite, tcase);
    return suite;
}
