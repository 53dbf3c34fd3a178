/* Writes a merged study as JSON. */
#include "out/print_study.h"

#include <math.h>
#include <string.h>

/* Writes the values of the axes at point i, or of the group that begins with it. */
static void write_input(const hf_merged *m, int i, bool of_group, hf_json *j)
{
    hf_json_open(j, "input", '{');
    for (int a = 0; a < m->n_axis; a++) {
        if (of_group && a == m->replicate) continue;
        const hf_series *s = &m->input[a];
        const char *key = hf_texts_at(&m->input_name, a);
        if (s->n && s->columns == 1)
            hf_json_number(j, key, s->value[i]);
        else if (s->n)
            hf_json_list(j, key, s->value + (size_t)i * (size_t)s->columns, s->columns);
        else if (m->input_text[a].n)
            hf_json_text(j, key, hf_texts_at(&m->input_text[a], i));
    }
    hf_json_close(j, '}');
}

/* Writes the verdict on each requirement. */
static void write_rows(const hf_merged *m, int i, hf_json *j)
{
    hf_json_open(j, "rows", '[');
    for (int row = 0; row < m->n_row && hf_merged_is_done(m, i); row++) {
        size_t at = (size_t)i * (size_t)m->n_row + (size_t)row;
        double verdict = m->row_verdict.value[at];
        bool is_known = verdict >= 0 && verdict < HF_VERDICT_N;
        hf_json_open(j, NULL, '{');
        hf_json_text(j, "name", hf_texts_at(&m->row_name, row));
        hf_json_text(j, "verdict", hf_verdict_word[is_known ? (int)verdict : HF_VERDICT_NONE]);
        if (m->row_value.n == m->n) hf_json_number(j, "value", m->row_value.value[at]);
        if (m->row_at_least.n == m->n) hf_json_number(j, "at_least", m->row_at_least.value[at]);
        if (m->row_at_most.n == m->n) hf_json_number(j, "at_most", m->row_at_most.value[at]);
        hf_json_number(j, "margin", m->row_margin.value[at]);
        hf_json_number(j, "relative_margin", m->row_relative_margin.value[at]);
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
}

static void write_stages(const hf_merged *m, int i, hf_json *j)
{
    for (int k = 0; k < m->n_figure; k++) {
        const hf_merged_figure *f = &m->figure[k];
        bool is_last = k + 1 == m->n_figure;
        if (k == 0 || f[-1].stage != f->stage) hf_json_open(j, hf_merged_stage_word(m, f->stage), '{');
        if (f->stage == HF_MERGED_REQUIREMENTS && f[-1].stage != f->stage) write_rows(m, i, j);
        if (*f->load_case && (k == 0 || strcmp(f[-1].load_case, f->load_case) != 0)) hf_json_open(j, f->load_case, '{');
        hf_json_number(j, f->key, hf_merged_is_done(m, i) ? f->value.value[i] : (double)NAN);
        if (*f->load_case && (is_last || strcmp(f[1].load_case, f->load_case) != 0)) hf_json_close(j, '}');
        if (is_last || f[1].stage != f->stage) hf_json_close(j, '}');
    }
}

/* Writes the best point. A point that does not pass is only the closest one. */
static void write_best(const hf_merged *m, hf_json *j)
{
    bool is_judged = hf_merged_is_judged(m);
    char text[HF_PRINT_ADVICE_SIZE];
    int n_pass = 0;
    if (m->best >= 0) {
        bool is_best = !is_judged || m->judgement[m->best].verdict == HF_VERDICT_PASS;
        hf_json_text(j, is_best ? "best" : "closest", hf_texts_at(&m->id, m->best));
        if (m->lead >= 0) hf_json_text(j, "best_by", m->figure[m->lead].key);
    }
    if (!is_judged) return;
    for (int i = 0; i < m->n; i++)
        n_pass += m->judgement[i].verdict == HF_VERDICT_PASS;
    hf_json_integer(j, "passing", n_pass);
    hf_json_text(j, "advice", hf_print_study_advice(m, text));
}

void hf_print_study_groups(const hf_merged *m, hf_json *j)
{
    char text[HF_PRINT_ADVICE_SIZE];
    if (!m->n_group) return;
    hf_json_open(j, "replicates", '{');
    hf_json_text(j, "figure", m->figure[m->lead].key);
    hf_json_text(j, "scatter", hf_print_study_scatter(m, text));
    hf_json_number(j, "differ_p", m->differ_p);
    hf_json_bool(j, "differ", m->differ_p < HF_MERGED_DIFFER_P);
    hf_json_open_rows(j, "groups");
    for (int k = 0; k < m->n_group; k++) {
        const hf_merged_group *g = &m->group[k];
        hf_json_open_row(j);
        write_input(m, g->first, true, j);
        hf_json_integer(j, "rank", g->rank + 1);
        hf_json_integer(j, "n", g->n_run);
        hf_json_text(j, "best", g->best < 0 ? "" : hf_texts_at(&m->id, g->best));
        for (int s = 0; s < HF_MERGED_N_STATISTIC; s++)
            hf_json_number(j, hf_merged_statistic_word[s], g->statistic[s]);
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
    hf_json_close(j, '}');
}

void hf_print_study_json(const hf_merged *m, FILE *file)
{
    hf_json writer = {.file = file}, *j = &writer;
    hf_json_open(j, NULL, '{');
    hf_json_text(j, "title", hf_merged_heading(m));
    hf_json_text(j, "result", hf_merged_stage_word(m, m->main));
    write_best(m, j);
    hf_print_study_groups(m, j);
    hf_json_open_rows(j, "points");
    for (int i = 0; i < m->n; i++) {
        hf_json_open_row(j);
        hf_json_text(j, "id", hf_texts_at(&m->id, i));
        hf_json_text(j, "status", hf_status_word((hf_status)m->status.value[i]));
        if (*hf_texts_at(&m->reason, i)) hf_json_text(j, "reason", hf_texts_at(&m->reason, i));
        if (hf_merged_is_judged(m)) hf_json_text(j, "verdict", hf_verdict_word[m->judgement[i].verdict]);
        if (m->judgement[i].tightest >= 0)
            hf_json_text(j, "tightest", hf_texts_at(&m->row_name, m->judgement[i].tightest));
        write_input(m, i, false, j);
        write_stages(m, i, j);
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
    hf_json_line(j, " ");
    hf_json_text(j, "file", m->path);
    hf_json_end(j, false, NULL);
}
