/* `hifdm status` prints how many points of a study are in each state, and why points failed. */
#include "app/study_files.h"

#include "base/json.h"
#include "out/print.h"

/* At most this many failed points are listed with their reasons. Of the others, only the number is printed. */
#define FAILURES_SHOWN 10

static void write_status_json(const hf_study *study, const hf_points *points, FILE *file)
{
    hf_json j = {.file = file};
    hf_json_open(&j, NULL, '{');
    hf_json_integer(&j, "points", points->n_point);
    for (int k = 0; k < HF_N_POINT_STATE; k++)
        hf_json_integer(&j, hf_point_state_word[k], points->count[k]);
    hf_json_open_rows(&j, "failures");
    for (int i = 0; i < points->n_point; i++) {
        char text[1024];
        if (points->point[i].state != HF_POINT_FAILED) continue;
        hf_study_point_text(study, i, text, sizeof text);
        hf_json_open_row(&j);
        hf_json_text(&j, "id", study->id[i]);
        hf_json_text(&j, "point", text);
        hf_json_text(&j, "status", hf_status_word(points->point[i].status));
        hf_json_text(&j, "reason", points->point[i].reason);
        hf_json_close(&j, '}');
    }
    hf_json_close(&j, ']');
    hf_json_close(&j, '}');
    fputc('\n', file);
}

static void say_failures(const hf_study *study, const hf_points *points, FILE *file)
{
    int n = 0;
    for (int i = 0; i < points->n_point; i++) {
        char text[256];
        if (points->point[i].state != HF_POINT_FAILED || n++ >= FAILURES_SHOWN) continue;
        hf_study_point_text(study, i, text, sizeof text);
        hf_print_line(file, "  %s  %s: %s", study->id[i], text, points->point[i].reason);
    }
    if (n > FAILURES_SHOWN) fprintf(file, "  and %d more\n", n - FAILURES_SHOWN);
}

static void say_status(const hf_study *study, const char *folder, const hf_points *points, FILE *file)
{
    int n_begun = hf_ledger_n_begun(folder, study, points);
    hf_print_line(file, "%s: %d points, results in %s", study->path, points->n_point, folder);
    for (int k = 0; k < HF_N_POINT_STATE; k++)
        if (points->count[k] || k != HF_POINT_OUTDATED)
            fprintf(file, "  %-9s %d\n", hf_point_state_word[k], points->count[k]);
    if (n_begun) fprintf(file, "  of the missing ones, %d were begun and will go on\n", n_begun);
    if (points->n_lost)
        fprintf(file, "  of the missing ones, %d were done, but their files are gone or unfinished\n", points->n_lost);
    if (points->count[HF_POINT_OUTDATED]) hf_print_line(file, "  outdated: of another version of %s", study->base);
    if (points->count[HF_POINT_FAILED]) fprintf(file, "failed:\n");
    say_failures(study, points, file);
    if (points->count[HF_POINT_FAILED])
        hf_print_line(file, "'hifdm sweep %s --retry failed' runs these anew and replaces their files", study->path);
}

static hf_status command_status(const hf_options *o, FILE *file, hf_messages *messages)
{
    char folder[HF_PATH_SIZE];
    static hf_study study;
    hf_points points;
    hf_status status = hf_study_files_read(o, o->folder != NULL, folder, &study, &points, messages);
    if (status == HF_OK && o->json)
        write_status_json(&study, &points, file);
    else if (status == HF_OK)
        say_status(&study, folder, &points, file);
    hf_points_free(&points);
    hf_study_free(&study);
    return status;
}

const hf_command hf_cmd_status = {
    .name = "status",
    .argument = "STUDY",
    .help = "count the done, running, failed and missing points of a sweep, and print the reasons for failures",
    .about = "You can run hifdm status at any time, on any machine that can read the results folder of the sweep.",
    .examples = "hifdm status study.yaml",
    .run = command_status,
};
