/* The page of a merged study. Contents: writing - reading */
#include "out/report_study.h"

#include "base/file_out.h"
#include "base/json.h"
#include "base/path.h"
#include "case/study.h"
#include "out/report_page.h"
#include "store/store_series.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LINK_SIZE (PATH_MAX + 2) /* of a path to a folder, with a slash; the system refuses longer ones */

/* A stage is shown when any point has it. Each row: the name on the page, and where its data sets begin in the file. */
static const char *const stage_path[][2] = {
    {"form", "/points/form/"}, {"optimize", "/points/ga/best_"}, {"polish", "/points/polish/"}};
static const char *const output_name[] = {"psi_m", "inner_tension_ratio", "boundary_tension_ratio", "residual_N",
                                          "n_slack"};
/* Figures beside those of the stages, shown when any point has them: data set, words, unit. */
static const char *const figure_text[][3] = {
    {"/points/tolerance/psi_95_m", "ψ that 95 % of the nets as built keep", "m"},
    {"/points/tolerance/yield", "part of the nets as built that meets all requirements", ""},
};
enum {
    N_STAGE = 3,
    N_OUTPUT = sizeof output_name / sizeof *output_name,
    N_FIGURE = sizeof figure_text / sizeof *figure_text
};

/* Goals of a stage that a page shows: all of a case, and more where their sets or kinds are axes. */
enum { GOALS_MAX = 2 * HF_DESIGN_ROWS_MAX };
typedef struct {
    int n;
    char name[GOALS_MAX][HF_GOAL_NAME_SIZE]; /* goal_1_tension_edge */
    hf_series value[GOALS_MAX];
} goal_columns;

typedef struct {
    const char *path;
    char folder[LINK_SIZE], from_page[LINK_SIZE]; /* paths to the merged file's folder: "" or ending in '/' */
    int n;                                        /* points */
    hf_texts id, reason, file, input_name, title;
    hf_series status;
    hf_series input[HF_STUDY_AXIS_MAX];
    hf_texts input_text[HF_STUDY_AXIS_MAX]; /* of axes whose values are words or seeds */
    hf_series output[N_STAGE][N_OUTPUT], figure[N_FIGURE];
    goal_columns goals[N_STAGE];
} study_page;

bool hf_report_is_study(const char *path)
{
    hf_messages unwanted = {0};
    hf_series status = {0};
    hf_status found = hf_store_read_series(path, "/points/status", 1, &status, &unwanted);
    bool is_study = found == HF_OK && status.n > 0;
    hf_series_free(&status);
    hf_messages_free(&unwanted);
    return is_study;
}

/* ---- writing ---- */

/* ,"key":["...",...] */
static void write_texts(const char *key, const hf_texts *texts, FILE *f)
{
    fprintf(f, ",\"%s\":[", key);
    for (int i = 0; i < texts->n; i++) {
        if (i) fputc(',', f);
        hf_json_string(hf_texts_at(texts, i), f);
    }
    fputc(']', f);
}

static void write_status(const study_page *p, FILE *f)
{
    fputs(",\"status\":[", f);
    for (int i = 0; i < p->n; i++) {
        if (i) fputc(',', f);
        hf_json_string(hf_status_word((hf_status)p->status.value[i]), f);
    }
    fputc(']', f);
}

/* Writes links: to the result file of each point, and to the page of that result when one lies beside it. */
static void write_links(const study_page *p, FILE *f)
{
    char link[LINK_SIZE + 1100];
    for (int is_page = 0; is_page < 2; is_page++) {
        fprintf(f, ",\"%s\":[", is_page ? "page" : "file");
        for (int i = 0; i < p->n; i++) {
            const char *file = p->file.n ? hf_texts_at(&p->file, i) : "", *its_own = hf_path_ending(file);
            const char *ending = is_page ? ".html" : its_own;
            bool is_absolute = *file == '/';
            int stem = (int)(its_own - file);
            snprintf(link, sizeof link, "%s%.*s%s", is_absolute ? "" : p->folder, stem, file, ending);
            bool is_there = *file && access(link, R_OK) == 0;
            snprintf(link, sizeof link, "%s%.*s%s", is_absolute ? "" : p->from_page, stem, file, ending);
            if (i) fputc(',', f);
            hf_json_string(is_there ? link : "", f);
        }
        fputc(']', f);
    }
}

static void write_inputs(const study_page *p, FILE *f)
{
    const char *comma = "";
    fputs(",\n\"input\":[", f);
    for (int a = 0; a < p->input_name.n && a < HF_STUDY_AXIS_MAX; a++) {
        const hf_series *s = &p->input[a];
        if (s->n != p->n && p->input_text[a].n != p->n) continue;
        fprintf(f, "%s\n{", comma);
        hf_json_text(&(hf_json){.file = f}, "name", hf_texts_at(&p->input_name, a));
        if (s->n == p->n) {
            fprintf(f, ",\"columns\":%d", s->columns);
            hf_json_values("values", s->value, s->n * s->columns, 1, 17, f);
        } else {
            write_texts("texts", &p->input_text[a], f);
        }
        fputc('}', f);
        comma = ",";
    }
    fputc(']', f);
}

static void write_outputs(const study_page *p, FILE *f)
{
    const char *comma = "";
    fputs(",\n\"output\":[", f);
    for (int s = 0; s < N_STAGE; s++) {
        if (p->output[s][0].n != p->n) continue;
        fprintf(f, "%s\n{\"stage\":\"%s\"", comma, stage_path[s][0]);
        for (int k = 0; k < N_OUTPUT; k++)
            if (p->output[s][k].n == p->n) hf_json_values(output_name[k], p->output[s][k].value, p->n, 1, 9, f);
        for (int k = 0; k < p->goals[s].n; k++)
            if (p->goals[s].value[k].n == p->n)
                hf_json_values(p->goals[s].name[k], p->goals[s].value[k].value, p->n, 1, 9, f);
        fputc('}', f);
        comma = ",";
    }
    fputc(']', f);
}

static void write_study_figures(const study_page *p, FILE *f)
{
    hf_json j = {.file = f, .is_due = true};
    hf_json_line(&j, "");
    hf_json_open(&j, "figure", '[');
    for (int k = 0; k < N_FIGURE; k++) {
        if (p->figure[k].n != p->n) continue;
        hf_json_open(&j, NULL, '{');
        hf_json_text(&j, "key", figure_text[k][0] + strlen("/points/"));
        hf_json_text(&j, "title", figure_text[k][1]);
        hf_json_text(&j, "unit", figure_text[k][2]);
        hf_json_values("values", p->figure[k].value, p->n, 1, 9, f);
        hf_json_close(&j, '}');
    }
    hf_json_close(&j, ']');
}

/* The heading of the page: the title of the study or, without one, the name of the merged file. */
static const char *study_heading(const study_page *p)
{
    return p->title.n ? hf_texts_at(&p->title, 0) : hf_path_name(p->path);
}

static void write_data(const void *context, FILE *f)
{
    const study_page *p = context;
    fputc('{', f);
    hf_json_text(&(hf_json){.file = f}, "title", study_heading(p));
    fputs(",\n\"study\":{", f);
    hf_json_text(&(hf_json){.file = f}, "path", p->path);
    fprintf(f, ",\"n\":%d", p->n);
    write_texts("id", &p->id, f);
    write_texts("reason", &p->reason, f);
    write_status(p, f);
    write_links(p, f);
    write_inputs(p, f);
    write_outputs(p, f);
    write_study_figures(p, f);
    fputs("}}\n", f);
}

static void write_page(const void *context, FILE *f)
{
    const study_page *p = context;
    hf_report_page_write(study_heading(p), NULL, write_data, p, f);
}

/* ---- reading ---- */

/* The data sets of a stage that are goals: their names begin with goal_, behind what all of the stage begin with. */
static hf_status read_goals(const char *file, const char *stage, goal_columns *goals, hf_messages *messages)
{
    char group[32], path[64 + HF_GOAL_NAME_SIZE];
    const char *prefix = strrchr(stage, '/') + 1;
    size_t n_prefix = strlen(prefix);
    hf_texts names = {0};
    snprintf(group, sizeof group, "%.*s", (int)(prefix - stage - 1), stage);
    hf_status status = hf_store_read_names(file, group, &names, messages);
    for (int i = 0; i < names.n && goals->n < GOALS_MAX && status == HF_OK; i++) {
        const char *name = hf_texts_at(&names, i), *goal = name + n_prefix;
        if (strncmp(name, prefix, n_prefix) != 0 || strncmp(goal, "goal_", 5) != 0) continue;
        if (strlen(goal) >= HF_GOAL_NAME_SIZE) continue;
        strcpy(goals->name[goals->n], goal);
        snprintf(path, sizeof path, "%s%s", stage, goal);
        status = hf_store_read_series(file, path, 1, &goals->value[goals->n++], messages);
    }
    hf_texts_free(&names);
    return status;
}

static hf_status read_page(study_page *p, hf_messages *messages)
{
    char name[512];
    HF_TRY(hf_store_read_series(p->path, "/points/status", 1, &p->status, messages));
    HF_TRY(hf_store_read_texts(p->path, "/points/id", &p->id, messages));
    HF_TRY(hf_store_read_texts(p->path, "/points/reason", &p->reason, messages));
    HF_TRY(hf_store_read_texts(p->path, "/study/title", &p->title, messages));
    p->n = p->status.n;
    for (int i = 0; i < p->n; i++)
        if (!(p->status.value[i] >= 0 && p->status.value[i] <= SCHAR_MAX))
            return hf_error(messages, HF_IO, "%s: is damaged: /points/status holds what is no status", p->path);
    if (p->id.n != p->n)
        return hf_error(messages, HF_IO, "%s: is damaged: /points/id does not name every point", p->path);
    HF_TRY(hf_store_read_links(p->path, "/runs", &p->id, &p->file, messages));
    HF_TRY(hf_store_read_names(p->path, "/points/input", &p->input_name, messages));
    for (int a = 0; a < p->input_name.n && a < HF_STUDY_AXIS_MAX; a++) {
        snprintf(name, sizeof name, "/points/input/%s", hf_texts_at(&p->input_name, a));
        HF_TRY(hf_store_read_texts(p->path, name, &p->input_text[a], messages));
        if (!p->input_text[a].n) HF_TRY(hf_store_read_series(p->path, name, 0, &p->input[a], messages));
    }
    for (int s = 0; s < N_STAGE; s++) {
        for (int k = 0; k < N_OUTPUT; k++) {
            snprintf(name, sizeof name, "%s%s", stage_path[s][1], output_name[k]);
            HF_TRY(hf_store_read_series(p->path, name, 1, &p->output[s][k], messages));
        }
        HF_TRY(read_goals(p->path, stage_path[s][1], &p->goals[s], messages));
    }
    for (int k = 0; k < N_FIGURE; k++)
        HF_TRY(hf_store_read_series(p->path, figure_text[k][0], 1, &p->figure[k], messages));
    return HF_OK;
}

static void free_page(study_page *p)
{
    hf_texts_free(&p->id);
    hf_texts_free(&p->reason);
    hf_texts_free(&p->file);
    hf_texts_free(&p->input_name);
    hf_texts_free(&p->title);
    hf_series_free(&p->status);
    for (int a = 0; a < HF_STUDY_AXIS_MAX; a++) {
        hf_series_free(&p->input[a]);
        hf_texts_free(&p->input_text[a]);
    }
    for (int s = 0; s < N_STAGE; s++) {
        for (int k = 0; k < N_OUTPUT; k++)
            hf_series_free(&p->output[s][k]);
        for (int k = 0; k < p->goals[s].n; k++)
            hf_series_free(&p->goals[s].value[k]);
    }
    for (int k = 0; k < N_FIGURE; k++)
        hf_series_free(&p->figure[k]);
}

/* A page in the folder of the merged file links to the results by the same relative paths as that file. A page in
 * another folder links by absolute paths. */
static void find_folders(study_page *p, const char *output)
{
    char merge_folder[LINK_SIZE], page_folder[LINK_SIZE], merge_real[PATH_MAX], page_real[PATH_MAX];
    snprintf(p->folder, sizeof p->folder, "%.*s", hf_path_prefix_length(p->path), p->path);
    hf_path_folder(p->path, merge_folder, sizeof merge_folder);
    hf_path_folder(output, page_folder, sizeof page_folder);
    if (!realpath(merge_folder, merge_real)) return;
    if (realpath(page_folder, page_real) && !strcmp(merge_real, page_real)) return;
    snprintf(p->from_page, sizeof p->from_page, "%s/", merge_real);
}

hf_status hf_report_study(const char *path, const char *output, hf_messages *messages)
{
    study_page p = {.path = path};
    find_folders(&p, output);
    hf_status status = read_page(&p, messages);
    if (status == HF_OK) status = hf_file_out_write(output, write_page, &p, messages);
    free_page(&p);
    return status;
}
