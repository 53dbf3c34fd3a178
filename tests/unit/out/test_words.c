/* The glossary that `hifdm explain` reads: its form, and an entry for each figure, status and reason of the lists. */
#include "support.h"

#include "out/words.h"

#include <hifdm/optimiser.h>
#include <hifdm/population.h>
#include <hifdm/summary.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 1024 };

/* ---- the form ---- */

/* Reads the glossary from its file, because the first use changes the embedded one. Free *text. */
static int read_glossary(char **text, hf_word entry[SIZE])
{
    int fault;
    *text = read_file(source_path("src/manual/glossary.md"), NULL);
    int n = hf_words_read(*text, entry, SIZE, &fault);
    ck_assert_msg(fault == 0, "src/manual/glossary.md:%d: breaks a rule of the parser", fault);
    return n;
}

START_TEST(every_line_of_the_glossary_is_read)
{
    static hf_word entry[SIZE];
    static const char *const markup[] = {"](", "**", "| ", "<!--", "\n\n", "  "};
    char *text;
    int n = read_glossary(&text, entry);
    ck_assert_int_lt(n, SIZE);
    ck_assert_int_eq(n, hf_word_count());
    for (int i = 0; i < n; i++) {
        const hf_word *w = &entry[i], embedded = hf_word_at(i);
        ck_assert_str_eq(w->text, embedded.text);
        for (size_t k = 0; k < sizeof markup / sizeof *markup; k++)
            ck_assert_msg(!strstr(w->text, markup[k]), "%s: '%s' in its text", w->word, markup[k]);
        ck_assert_msg(strchr(".!)", w->text[strlen(w->text) - 1]), "%s: its text is no sentence", w->word);
        ck_assert_msg(!strcmp(w->kind, "status") == (*w->exit_status != '\0'), "%s: exit status", w->word);
        ck_assert_msg(!*w->message || !strcmp(w->kind, "warning") || *w->exit_status, "%s: message", w->word);
        ck_assert_msg(*w->message || strcmp(w->kind, "warning"), "%s: no message leads to it", w->word);
        for (int k = 0; k < n; k++)
            ck_assert_msg(k == i || strcmp(entry[k].kind, w->kind) != 0 || !hf_word_is(k, w->word),
                          "%s: two entries of one kind", w->word);
    }
    free(text);
}
END_TEST

#define BEGIN "# Title\n\nWords.\n\n<!--\n  ### no entry\n-->\n\n## Nets\n\n`term`: words of\nnets.\n\n### a\n\n"

START_TEST(an_entry_has_all_its_parts)
{
    char text[] =
        BEGIN "- Unit: N\n- Also: b, c d\n- Formerly: e\n- Message contains: `x, `\n- Message contains: `y: z`\n"
              "\nOne `word` of `two\nwords`, `'q'/r`.\nMore.\n\n\nWhat to do: Nothing.\n\n### f\nText.\n"
              "\n## Prose\n\nNo entries.\n- Nor here.\n\n## Statuses\n\n`status`: ends.\n\n### g\n"
              "- Exit status: 75\n\nText";
    hf_word entry[4];
    int fault;
    ck_assert_int_eq(hf_words_read(text, entry, 4, &fault), 3);
    ck_assert_int_eq(fault, 0);
    const hf_word *a = entry, *f = &entry[1], *g = &entry[2];
    ck_assert_str_eq(a->word, "a");
    ck_assert_str_eq(a->section, "Nets");
    ck_assert_str_eq(a->kind, "term");
    ck_assert_str_eq(a->unit, "N");
    ck_assert(!memcmp(a->also, "b\0c d\0", 7));
    ck_assert(!memcmp(a->formerly, "e\0", 3));
    ck_assert(!memcmp(a->message, "x, \0y: z\0", 10));
    ck_assert_str_eq(a->text, "One word of `two words`, 'q'/r. More.\nWhat to do: Nothing.");
    ck_assert_str_eq(f->word, "f");
    ck_assert(!*f->unit && !*f->also && !*f->formerly && !*f->message && !*f->exit_status);
    ck_assert_str_eq(f->text, "Text.");
    ck_assert_str_eq(g->section, "Statuses");
    ck_assert_str_eq(g->kind, "status");
    ck_assert_str_eq(g->exit_status, "75");
    ck_assert_str_eq(g->text, "Text");
}
END_TEST

/* Lines that break a rule, below BEGIN, whose last line is line 15. */
static const struct {
    const char *lines;
    int fault, n;
} broken[] = {
    {"Text.\n", 0, 1},
    {"", 15, 1},
    {"### b\n\nText.\n", 16, 2},                                  /* a has no text */
    {"Text.\n\n## Prose\n\nNothing.\n\n### b\n\nText.\n", 22, 1}, /* outside a section with words */
    {"- Units: N\n\nText.\n", 16, 1},
    {"Text.\n\n- Unit: N\n", 18, 1},
    {"- Message contains: `x`\n- Unit: N\n\nText.\n", 17, 1},
    {"- Message contains: x\n\nText.\n", 16, 1},
    {"- Message contains: ``\n\nText.\n", 16, 1},
    {"One `word.\n\n### b\n\nText.\n", 18, 2},
    {"One.\n\n### b\n\nTwo.\n\n### c\n\nThree.\n\n### d\n\nFour.\n", 26, 3}, /* no room */
};

START_TEST(a_broken_entry_is_found)
{
    char text[1024];
    hf_word entry[3];
    int fault;
    snprintf(text, sizeof text, "%s%s", BEGIN, broken[_i].lines);
    int n = hf_words_read(text, entry, 3, &fault);
    ck_assert_msg(n == broken[_i].n && fault == broken[_i].fault, "%s: %d entries, line %d", broken[_i].lines, n,
                  fault);
}
END_TEST

/* ---- entries for the lists ---- */

/* Returns true if `name` is the word, or an earlier name, of entry i and of a kind that begins so. */
static bool is_entry(int i, const char *kind, const char *name)
{
    return !strncmp(hf_word_at(i).kind, kind, strlen(kind)) && hf_word_is(i, name);
}

static void demand(const char *kind, const char *name)
{
    int n = 0;
    for (int i = 0; i < hf_word_count(); i++)
        n += is_entry(i, kind, name);
    ck_assert_msg(n > 0, "src/manual/glossary.md has no %s '%s'", kind, name);
}

#define FIELD(type, member, kind_, ...) {.name = #member, __VA_ARGS__},
#define FIT(type, member, kind_, ...) {.name = "fit_" #member, __VA_ARGS__},
#define LOSS(member, unit, text) {.name = #member},
static const hf_result_field shape[] = {HF_RESULT_LIST(FIELD)}, coupling[] = {HF_COUPLING_LIST(FIELD)},
                             form[] = {HF_SUMMARY_FORM_LIST(FIELD)}, search[] = {HF_SUMMARY_SEARCH_LIST(FIELD)},
                             refine[] = {HF_SUMMARY_REFINE_LIST(FIELD)}, load_case[] = {HF_LOAD_CASE_LIST(FIELD)},
                             truss[] = {HF_SUMMARY_TRUSS_LIST(FIELD)}, tolerance[] = {HF_TOLERANCE_LIST(FIELD)},
                             surface[] = {HF_SURFACE_LIST(FIELD) HF_SURFACE_FIT_LIST(FIT) HF_SURFACE_LOSS_LIST(LOSS)};
#define ROWS(list) list, sizeof list / sizeof *list
static const struct {
    const hf_result_field *field;
    size_t n;
    const char *kind; /* of entries that are for rows of these lists only */
} list[] = {{ROWS(shape), NULL},
            {ROWS(coupling), "figure of truss, coupling"},
            {ROWS(form), NULL},
            {ROWS(search), "figure of search, refine"},
            {ROWS(refine), "figure of search, refine"},
            {ROWS(load_case), NULL},
            {ROWS(truss), "figure of truss, coupling"},
            {ROWS(tolerance), NULL},
            {ROWS(surface), "figure of surface"}};
enum { N_LIST = sizeof list / sizeof *list };

START_TEST(every_figure_has_an_entry)
{
    for (int l = 0; l < N_LIST; l++)
        for (size_t k = 0; k < list[l].n; k++)
            demand("figure", hf_result_key(&list[l].field[k]));
}
END_TEST

/* Of a point of a front these are figures of the stage that no list has. */
START_TEST(every_figure_of_a_list_is_in_one)
{
    for (int i = 0; i < hf_word_count(); i++) {
        bool is_due = false, found = !strncmp(hf_word_at(i).word, "front_", 6);
        for (int l = 0; l < N_LIST; l++) {
            if (!list[l].kind || strcmp(hf_word_at(i).kind, list[l].kind) != 0) continue;
            is_due = true;
            for (size_t k = 0; k < list[l].n; k++)
                found |= hf_word_is(i, hf_result_key(&list[l].field[k]));
        }
        ck_assert_msg(found || !is_due, "src/manual/glossary.md: no list has '%s'", hf_word_at(i).word);
    }
}
END_TEST

#define WORD(name, value, word, ...) word,
static const char *const stop[] = {HF_STOP_REASON_LIST(WORD) HF_COUPLING_STOP_LIST(WORD)}, *const bound[] = {
                                                                                               HF_BOUND_REASON_LIST(
                                                                                                   WORD)};
#undef WORD

START_TEST(every_reason_has_an_entry)
{
    for (size_t k = 0; k < sizeof bound / sizeof *bound; k++)
        demand("bound_reason", bound[k]);
    for (size_t k = 0; k < sizeof stop / sizeof *stop; k++)
        if (strcmp(stop[k], "none") != 0) demand("stop_reason", stop[k]);
    for (size_t k = 0; k < sizeof hf_population_stop_word / sizeof *hf_population_stop_word; k++)
        demand("stop_reason", hf_population_stop_word[k]);
    for (size_t k = 0; k < sizeof hf_refine_stop_word / sizeof *hf_refine_stop_word; k++)
        demand("stop_reason", hf_refine_stop_word[k]);
}
END_TEST

START_TEST(every_status_has_an_entry_with_its_exit_status)
{
#define STATUS(name, ...) HF_##name,
    static const hf_status status[] = {HF_STATUS_LIST(STATUS)};
#undef STATUS
    for (size_t k = 0; k < sizeof status / sizeof *status; k++) {
        demand("status", hf_status_word(status[k]));
        for (int i = 0; i < hf_word_count(); i++)
            if (is_entry(i, "status", hf_status_word(status[k])))
                ck_assert_int_eq(atoi(hf_word_at(i).exit_status), hf_status_exit_code(status[k]));
    }
    for (int i = 0; i < hf_word_count(); i++) {
        bool found = strcmp(hf_word_at(i).kind, "status") != 0;
        for (size_t k = 0; k < sizeof status / sizeof *status; k++)
            found |= hf_word_is(i, hf_status_word(status[k]));
        ck_assert_msg(found, "src/manual/glossary.md: '%s' is no status", hf_word_at(i).word);
    }
}
END_TEST

Suite *suite_unit_words(void)
{
    Suite *suite = suite_create("unit/words");
    TCase *tests = tcase_create("words");
    tcase_add_test(tests, every_line_of_the_glossary_is_read);
    tcase_add_test(tests, an_entry_has_all_its_parts);
    tcase_add_loop_test(tests, a_broken_entry_is_found, 0, sizeof broken / sizeof *broken);
    tcase_add_test(tests, every_figure_has_an_entry);
    tcase_add_test(tests, every_figure_of_a_list_is_in_one);
    tcase_add_test(tests, every_reason_has_an_entry);
    tcase_add_test(tests, every_status_has_an_entry_with_its_exit_status);
    suite_add_tcase(suite, tests);
    return suite;
}
