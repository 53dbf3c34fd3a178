/* Writes and reads the verdicts on the rows of `requirements`, in the group /requirements and as JSON, by one table of
 * fields. store_tolerance.c writes the figures of the samples. */
#include "store/layout.h"

#include <stdlib.h>
#include <string.h>

#define GROUP "/requirements"
enum { WORD_SIZE = 32 };

/* A verdict as the data sets have it. */
typedef struct {
    char figure[WORD_SIZE], feed[WORD_SIZE], verdict[WORD_SIZE];
    hf_requirement_verdict of;
} judged;

/* What the row says, by X(kind, member of judged, name, description). */
#define ROW_LIST(X)                                                                                                    \
    X(CHARS, verdict, "verdict", "pass, fail or undecided")                                                            \
    X(CHARS, figure, "figure", "what the row bounds")                                                                  \
    X(CHARS, of.row.set, "set", "cables; empty: all")                                                                  \
    X(CHARS, feed, "feed", "feed of figures of the surface; empty: the figure has none")                               \
    X(REAL, of.row.frequency_Hz, "frequency_Hz", "of gain_loss, gain and pointing; NaN: none")                         \
    X(CHARS, of.row.load_case, "load_case", "nominal, all or the name of a load case")                                 \
    X(REAL, of.row.at_least, "at_least", "minimum, in the unit of the figure; NaN: none")                              \
    X(REAL, of.row.at_most, "at_most", "maximum, in the unit of the figure; NaN: none")                                \
    X(REAL, of.row.share, "share", "required share of the samples; NaN: the nominal net")
#define ROW(kind, member, name, description) HF_LAYOUT_MEMBER(judged, name, member, kind, "", description)
#define MEMBER(kind, type, member, size, description) ROW(kind, of.member, #member, description)
static const hf_layout_field judged_field[] = {ROW_LIST(ROW) HF_VERDICT_LIST(MEMBER)};
#define ONE(kind, member, name, description) +1
enum { N_ROW_FIELD = 0 ROW_LIST(ONE) }; /* those of the row come first */
#undef ONE
#undef MEMBER
#undef ROW

/* Returns the index of a word, or -1. */
static int index_of(const char *word, int n, const char *const *words)
{
    int k = 0;
    while (k < n && strncmp(words[k], word, WORD_SIZE) != 0)
        k++;
    return k < n ? k : -1;
}

/* Sets the bytes behind the end of a text to zero, because other programs read them. A text that replaced a longer one
 * leaves some of it. */
static void clear_rest(char *text, size_t size)
{
    size_t length = strnlen(text, size);
    memset(text + length, 0, size - length);
}

static void put_verdict(const hf_requirement_verdict *v, judged *row)
{
    row->of = *v;
    strncpy(row->figure, hf_required_figure_word[v->row.figure], WORD_SIZE - 1);
    if (hf_required_is_of(v->row.figure, HF_REQUIRED_OF_FEED))
        strncpy(row->feed, hf_focus_word[v->row.feed], WORD_SIZE - 1);
    strncpy(row->verdict, hf_verdict_word[v->verdict], WORD_SIZE - 1);
    clear_rest(row->of.row.set, sizeof row->of.row.set);
    clear_rest(row->of.row.load_case, sizeof row->of.row.load_case);
    clear_rest(row->of.worst_load_case, sizeof row->of.worst_load_case);
    clear_rest(row->of.worst_item, sizeof row->of.worst_item);
}

static void get_verdicts(hf_hdf5 *io, const judged *rows, hf_summary *s)
{
    for (int i = 0; i < s->n_requirement && io->status == HF_OK; i++) {
        int figure = index_of(rows[i].figure, HF_REQUIRED_N_FIGURE, hf_required_figure_word),
            feed = *rows[i].feed ? index_of(rows[i].feed, HF_N_FOCUS, hf_focus_word) : 0,
            verdict = index_of(rows[i].verdict, HF_VERDICT_N, hf_verdict_word);
        if (figure < 0 || feed < 0 || verdict < 0)
            hf_hdf5_damaged(io, io->file, GROUP, "has a word that this version does not know");
        hf_requirement_verdict *to = &s->requirement[i];
        *to = rows[i].of;
        to->row.figure = (hf_required_figure)figure;
        to->row.feed = (hf_focus)feed;
        to->verdict = (hf_verdict)verdict;
        to->row.set[HF_SET_NAME_SIZE - 1] = to->row.load_case[HF_SET_NAME_SIZE - 1] = '\0';
        to->worst_load_case[HF_SET_NAME_SIZE - 1] = to->worst_item[HF_REQUIREMENT_ITEM_SIZE - 1] = '\0';
    }
}

void hf_layout_put_requirements(hf_hdf5 *io, const hf_summary *s)
{
    if (s->n_requirement == 0) return;
    judged *rows = hf_hdf5_take(io, (size_t)s->n_requirement, sizeof *rows);
    for (int i = 0; rows && i < s->n_requirement; i++)
        put_verdict(&s->requirement[i], &rows[i]);
    hid_t group = hf_hdf5_make_group(io, GROUP);
    hf_layout_pass_fields(io, true, group, HF_LAYOUT_TABLE(judged_field), s->n_requirement, 0, rows);
    hf_hdf5_close(io, group);
    free(rows);
}

void hf_layout_get_requirements(hf_hdf5 *io, hf_summary *s)
{
    if (!hf_hdf5_has(io, io->file, GROUP "/verdict")) return;
    hid_t group = hf_hdf5_open_group(io, GROUP);
    s->n_requirement = hf_hdf5_length(io, group, "verdict", HF_REQUIREMENT_ROWS_MAX);
    s->requirement = hf_hdf5_take(io, HF_REQUIREMENT_ROWS_MAX, sizeof *s->requirement);
    judged *rows = hf_hdf5_take(io, HF_REQUIREMENT_ROWS_MAX, sizeof *rows);
    hf_layout_pass_fields(io, false, group, HF_LAYOUT_TABLE(judged_field), s->n_requirement, 0, rows);
    hf_hdf5_close(io, group);
    get_verdicts(io, rows, s);
    free(rows);
}

static void write_fields(const judged *row, int from, int to, hf_json *j)
{
    for (const hf_layout_field *f = judged_field + from; f < judged_field + to; f++) {
        const void *value = (const char *)row + f->offset;
        if (f->kind == HF_KIND_CHARS)
            hf_json_text(j, f->name, value);
        else if (f->kind == HF_KIND_LONG)
            hf_json_integer(j, f->name, *(const long *)value);
        else
            hf_json_number(j, f->name, *(const double *)value);
    }
}

void hf_layout_write_verdict(const hf_requirement_verdict *v, hf_json *j)
{
    judged row = {0};
    put_verdict(v, &row);
    write_fields(&row, 0, N_ROW_FIELD, j);
    hf_json_text(j, "unit", hf_required_figure_unit[v->row.figure]);
    write_fields(&row, N_ROW_FIELD, HF_HDF5_COUNT(judged_field), j);
}
