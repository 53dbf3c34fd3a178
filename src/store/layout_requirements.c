/* Writes and reads the verdicts on the rows of `requirements` in the group /requirements, by a table of
 * fields. store_tolerance.c writes the figures of the samples. */
#include "store/layout.h"

#include <string.h>

#define GROUP "/requirements"
enum { WORD_SIZE = 32 };

/* A verdict as the data sets have it. */
typedef struct {
    char figure[WORD_SIZE], feed[WORD_SIZE], verdict[WORD_SIZE];
    hf_requirement_verdict of;
} judged;

#define CHARS(name, member, description) HF_LAYOUT_MEMBER(judged, name, member, CHARS, "", description)
#define REAL(name, member, description) HF_LAYOUT_MEMBER(judged, name, of.member, REAL, "", description)
static const hf_layout_field judged_field[] = {
    CHARS("figure", figure, "what the row bounds") CHARS("set", of.row.set, "cables; empty: all") CHARS(
        "feed", feed, "feed of figures of the surface") REAL("frequency_Hz", row.frequency_Hz,
                                                             "of gain_loss, gain and pointing; NaN: none")
        CHARS("load_case", of.row.load_case, "nominal, all or the name of a load case") REAL(
            "at_least", row.at_least, "minimum, in the unit of the figure; NaN: none")
            REAL("at_most", row.at_most, "maximum, in the unit of the figure; NaN: none") REAL(
                "share", row.share, "required share of the samples; 0: none is required; NaN: the nominal net")
                CHARS("verdict", verdict, "pass, fail, undecided or none") REAL("value", value,
                                                                                "of the nominal net, or of the share")
                    REAL("bound", bound, "the bound that the value is nearer to")
                        REAL("margin", margin, "signed distance of the value from that bound; negative: not met") REAL(
                            "relative_margin", relative_margin, "margin relative to that bound; NaN: the bound is 0")
                            REAL("error_bound", error_bound, "of the value of the nominal net; NaN: not known")
                                REAL("yield", yield, "share of the samples that meet the row")
                                    REAL("yield_low", yield_low, "95 % interval of the yield: its lower end") REAL(
                                        "yield_high", yield_high, "95 % interval of the yield: its upper end")
                                        HF_LAYOUT_MEMBER(judged, "worst_sample", of.worst_sample, LONG, "",
                                                         "sample with the minimum margin, from 0; -1: the nominal net")
                                            REAL("worst_margin", worst_margin, "margin of the worst net")
                                                REAL("worst_value", worst_value, "value of the worst net")
                                                    CHARS("worst_load_case", of.worst_load_case,
                                                          "load case of the worst value")
                                                        CHARS("worst_item", of.worst_item,
                                                              "cable or support of the worst value; empty: none")};

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
            feed = index_of(rows[i].feed, HF_N_FOCUS, hf_focus_word),
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

void hf_layout_pass_requirements(hf_hdf5 *io, bool writes, hf_summary *s)
{
    static judged rows[HF_REQUIREMENT_ROWS_MAX]; /* the lock of the store is held */
    if (writes ? s->n_requirement == 0 : !hf_hdf5_has(io, io->file, GROUP "/verdict")) return;
    memset(rows, 0, sizeof rows);
    for (int i = 0; writes && i < s->n_requirement; i++)
        put_verdict(&s->requirement[i], &rows[i]);
    hid_t group = writes ? hf_hdf5_make_group(io, GROUP) : hf_hdf5_open_group(io, GROUP);
    if (!writes) s->n_requirement = hf_hdf5_length(io, group, "verdict", HF_REQUIREMENT_ROWS_MAX);
    if (!writes) s->requirement = hf_hdf5_take(io, HF_REQUIREMENT_ROWS_MAX, sizeof *s->requirement);
    hf_layout_pass_fields(io, writes, group, HF_LAYOUT_TABLE(judged_field), s->n_requirement, 0, rows);
    hf_hdf5_close(io, group);
    if (!writes) get_verdicts(io, rows, s);
}
