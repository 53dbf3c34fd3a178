/* Writes the page of a merged study. */
#include "out/report.h"

#include "base/path.h"
#include "out/merged.h"
#include "out/print_study.h"
#include "store/ledger.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LINK_SIZE (PATH_MAX + 2) /* size of a path to a folder with a slash; the system refuses longer ones */

typedef struct {
    hf_merged merged;
    hf_texts file;                                /* result file of each point */
    char folder[LINK_SIZE], from_page[LINK_SIZE]; /* paths to the folder of the merged file: "" or ending in '/' */
} study_page;

/* Writes ,"key":["...",...]. */
static void write_texts(const char *key, const hf_texts *texts, FILE *f)
{
    fprintf(f, ",\"%s\":[", key);
    for (int i = 0; i < texts->n; i++) {
        if (i) fputc(',', f);
        hf_json_string(hf_texts_at(texts, i), f);
    }
    fputc(']', f);
}

static void write_status(const hf_merged *m, FILE *f)
{
    fputs(",\"status\":[", f);
    for (int i = 0; i < m->n; i++) {
        if (i) fputc(',', f);
        hf_json_string(hf_status_word((hf_status)m->status.value[i]), f);
    }
    fputc(']', f);
}

/* Writes links to the result file of each point, and to the page of that result if it is in the same folder. */
static void write_links(const study_page *p, FILE *f)
{
    char link[LINK_SIZE + 1100];
    for (int is_page = 0; is_page < 2; is_page++) {
        fprintf(f, ",\"%s\":[", is_page ? "page" : "file");
        for (int i = 0; i < p->merged.n; i++) {
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

static void write_inputs(const hf_merged *m, FILE *f)
{
    const char *comma = "";
    fputs(",\n\"input\":[", f);
    for (int a = 0; a < m->n_axis; a++) {
        const hf_series *s = &m->input[a];
        if (s->n == 0 && m->input_text[a].n == 0) continue;
        fprintf(f, "%s\n{", comma);
        hf_json_text(&(hf_json){.file = f}, "name", hf_texts_at(&m->input_name, a));
        if (s->n) {
            fprintf(f, ",\"columns\":%d", s->columns);
            hf_json_values("values", s->value, s->n * s->columns, 1, 17, f);
        } else {
            write_texts("texts", &m->input_text[a], f);
        }
        int side = hf_merged_improves_on(m, a);
        if (side) fprintf(f, ",\"extend\":\"%s\"", side > 0 ? "above" : "below");
        fputc('}', f);
        comma = ",";
    }
    fputc(']', f);
}

#define WORD_SIZE (HF_SET_NAME_SIZE + 16)

/* Returns the stage of a figure on the page, where each load case is a stage of its own. */
static const char *stage_word(const hf_merged *m, const hf_merged_figure *figure, char word[WORD_SIZE])
{
    if (!*figure->load_case) return hf_merged_stage_word(m, figure->stage);
    snprintf(word, WORD_SIZE, "load case %s", figure->load_case);
    return word;
}

/* Writes the figures of each stage that has psi, of the as-built net, of its load cases and of the requirements. */
static void write_outputs(const hf_merged *m, FILE *f)
{
    const char *comma = "";
    char word[WORD_SIZE];
    fputs(",\n\"output\":[", f);
    for (int k = 0, next; k < m->n_figure; k = next) {
        const hf_merged_figure *first = &m->figure[k];
        bool has_psi = first->stage == HF_MERGED_REQUIREMENTS ||
                       hf_merged_find(m, first->stage, first->stage == HF_MERGED_BUILT ? "psi_95_m" : "psi_m");
        if (has_psi) {
            fprintf(f, "%s\n{", comma);
            hf_json_text(&(hf_json){.file = f}, "stage", stage_word(m, first, word));
            comma = ",";
        }
        for (next = k; next < m->n_figure; next++) {
            const hf_merged_figure *figure = &m->figure[next];
            if (figure->stage != first->stage || strcmp(figure->load_case, first->load_case) != 0) break;
            if (has_psi) hf_json_values(figure->key, figure->value.value, m->n, 1, 9, f);
        }
        if (has_psi) fputc('}', f);
    }
    fputc(']', f);
}

/* Writes the properties of each figure: its unit, whether it is the same at all points, whether it is psi, and whether
 * it ranks the points. */
static void write_figures(const hf_merged *m, FILE *f)
{
    hf_json j = {.file = f, .is_due = true};
    char word[WORD_SIZE];
    hf_json_open_line(&j, "", "figure", '[');
    for (int k = 0; k < m->n_figure; k++) {
        const hf_merged_figure *figure = &m->figure[k];
        hf_json_open(&j, NULL, '{');
        hf_json_text(&j, "stage", stage_word(m, figure, word));
        hf_json_text(&j, "key", figure->key);
        hf_json_text(&j, "unit", hf_ledger_unit(figure->key));
        char words[HF_AXIS_NAME_SIZE];
        if (!strncmp(figure->key, "objective_", 10))
            hf_json_text(&j, "objective", hf_print_objective_words(figure->key, words));
        if (figure->is_same) hf_json_bool(&j, "same", true);
        if (figure->is_psi) hf_json_bool(&j, "psi", true);
        if (k == m->lead) hf_json_bool(&j, "lead", true);
        hf_json_close(&j, '}');
    }
    hf_json_close(&j, ']');
    hf_json_text(&j, "main", hf_merged_stage_word(m, m->main));
    hf_json_integer(&j, "best", m->best);
}

/* Writes the verdict on each point, and what the study recommends. */
static void write_verdicts(const hf_merged *m, FILE *f)
{
    hf_json j = {.file = f, .is_due = true};
    char text[HF_PRINT_ADVICE_SIZE];
    hf_json_text(&j, "ranked_by", hf_print_study_ranking(m, text));
    hf_json_text(&j, "advice", hf_print_study_advice(m, text));
    hf_print_study_groups(m, &j);
    hf_json_open(&j, "verdict", '[');
    for (int i = 0; i < m->n; i++)
        hf_json_text(&j, NULL, hf_verdict_word[m->judgement[i].verdict]);
    hf_json_close(&j, ']');
    hf_json_open(&j, "verdict_text", '[');
    for (int i = 0; i < m->n; i++)
        hf_json_text(&j, NULL, hf_print_study_verdict(m, i, text));
    hf_json_close(&j, ']');
    hf_json_open(&j, "tightest", '[');
    for (int i = 0; i < m->n && m->n_row > 0; i++)
        hf_json_text(&j, NULL, hf_print_study_tightest(m, i, text));
    hf_json_close(&j, ']');
}

/* Writes the requirements in the order of their columns: name, unit, bounds and values. Writes nothing without any. */
static void write_required(const hf_merged *m, FILE *f)
{
    hf_json j = {.file = f, .is_due = true};
    int row[HF_REQUIREMENT_ROWS_MAX], n = hf_merged_required(m, row);
    if (n == 0) return;
    hf_json_open_line(&j, "", "required", '[');
    for (int k = 0; k < n; k++) {
        hf_json_open(&j, NULL, '{');
        hf_json_text(&j, "name", hf_texts_at(&m->row_name, row[k]));
        hf_json_text(&j, "unit", hf_merged_unit(m, row[k]));
        hf_json_number(&j, "at_least", hf_merged_bound(m, &m->row_at_least, row[k]));
        hf_json_number(&j, "at_most", hf_merged_bound(m, &m->row_at_most, row[k]));
        hf_json_open(&j, "values", '[');
        for (int i = 0; i < m->n; i++)
            hf_json_number(&j, NULL, m->row_value.value[(size_t)i * (size_t)m->n_row + (size_t)row[k]]);
        hf_json_close(&j, ']');
        hf_json_close(&j, '}');
    }
    hf_json_close(&j, ']');
}

static void write_data(const void *context, FILE *f)
{
    const study_page *p = context;
    const hf_merged *m = &p->merged;
    fputc('{', f);
    hf_json_text(&(hf_json){.file = f}, "title", hf_merged_heading(m));
    fputs(",\n\"study\":{", f);
    hf_json_text(&(hf_json){.file = f}, "path", m->path);
    fprintf(f, ",\"n\":%d", m->n);
    write_texts("id", &m->id, f);
    write_texts("reason", &m->reason, f);
    write_status(m, f);
    write_links(p, f);
    write_inputs(m, f);
    write_outputs(m, f);
    write_figures(m, f);
    write_verdicts(m, f);
    write_required(m, f);
    fputs("}}\n", f);
}

/* Finds the folders for links. A page in the folder of the merged file links to the results by the same relative paths
 * as that file. A page in another folder uses absolute paths. */
static void find_folders(study_page *p, const char *output)
{
    static char merge_folder[LINK_SIZE], page_folder[LINK_SIZE], merge_real[PATH_MAX], page_real[PATH_MAX];
    snprintf(p->folder, sizeof p->folder, "%.*s", hf_path_prefix_length(p->merged.path), p->merged.path);
    hf_path_folder(p->merged.path, merge_folder, sizeof merge_folder);
    hf_path_folder(output, page_folder, sizeof page_folder);
    if (!realpath(merge_folder, merge_real)) return;
    if (realpath(page_folder, page_real) && !strcmp(merge_real, page_real)) return;
    snprintf(p->from_page, sizeof p->from_page, "%s/", merge_real);
}

hf_status hf_report_study(const char *path, const char *output, hf_messages *messages)
{
    static study_page p;
    p = (study_page){0};
    hf_status status = hf_merged_read(path, &p.merged, messages);
    find_folders(&p, output);
    if (status == HF_OK) status = hf_store_read_links(path, "/runs", &p.merged.id, &p.file, messages);
    const hf_report_page page = {hf_merged_heading(&p.merged), NULL, write_data, &p};
    if (status == HF_OK) status = hf_file_out_write(output, hf_report_page_write, &page, messages);
    hf_texts_free(&p.file);
    hf_merged_free(&p.merged);
    return status;
}
