/* The JSON writer: commas and line breaks in the right places, strings that every JSON reader accepts. */
#define _GNU_SOURCE /* open_memstream */
#include "support.h"

#include "base/json.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

START_TEST(commas_stand_between_items)
{
    char *text;
    size_t size;
    hf_json j = {.file = open_memstream(&text, &size)};
    hf_json_open(&j, NULL, '{');
    hf_json_text(&j, "a", "x");
    hf_json_open(&j, "empty", '{');
    hf_json_close(&j, '}');
    hf_json_line(&j, " ");
    hf_json_open(&j, "list", '[');
    for (int i = 0; i < 2; i++) {
        hf_json_line(&j, "  ");
        hf_json_open(&j, NULL, '{');
        hf_json_integer(&j, "i", -i);
        hf_json_bool(&j, "is", i == 0);
        hf_json_close(&j, '}');
    }
    hf_json_close(&j, ']');
    hf_json_unsigned(&j, "seed", UINT64_MAX);
    hf_json_number(&j, "number", 0.5);
    hf_json_number(&j, "none", NAN);
    hf_json_number(&j, "endless", -INFINITY);
    hf_json_list(&j, "values", (const double[]){1, INFINITY, -0.0}, 3);
    hf_json_list(&j, "no_values", NULL, 0);
    hf_json_lines(&j, "errors", "error: ", "warning: a\nerror: b\nerror: c");
    hf_json_lines(&j, "nothing", "error: ", NULL);
    hf_json_close(&j, '}');
    fclose(j.file);
    ck_assert_str_eq(text,
                     "{\"a\": \"x\", \"empty\": {},\n \"list\": [\n  {\"i\": 0, \"is\": true},\n  {\"i\": -1, \"is\": "
                     "false}], \"seed\": 18446744073709551615, \"number\": 0.5, \"none\": null, \"endless\": "
                     "\"-Infinity\", \"values\": [1, \"Infinity\", "
                     "0], \"no_values\": [], \"errors\": [\"b\", \"c\"], \"nothing\": []}");
    free(text);
}
END_TEST

START_TEST(texts_are_escaped)
{
    char *text;
    size_t size;
    hf_json j = {.file = open_memstream(&text, &size)};
    hf_json_text(&j, "k", "a\"b\\c\n</script>\xc3\xa9");
    fclose(j.file);
    ck_assert_str_eq(text, "\"k\": \"a\\\"b\\\\c\\u000a\\u003c/script>\xc3\xa9\"");
    free(text);
    j = (hf_json){.file = open_memstream(&text, &size)};
    hf_json_integer(&j, "a\"</", 1); /* the id of a cable may be a key */
    fclose(j.file);
    ck_assert_str_eq(text, "\"a\\\"\\u003c/\": 1");
    free(text);
    j = (hf_json){.file = open_memstream(&text, &size)};
    hf_json_text(&j, "k", "\x1b\x7f\xc2\x9b\xe2\x80\xa8\xe2\x80\xae\xff\xe2\x80");
    fclose(j.file);
    ck_assert_str_eq(text, "\"k\": \"\\u001b\\u007f\\u009b\\u2028\\u202e\\ufffd\\ufffd\\ufffd\"");
    free(text);
}
END_TEST

/* The letters are those of base64.b64encode(struct.pack("<3f", ...)) in Python, likewise <2i and <1d. */
START_TEST(numbers_are_packed)
{
    char *text;
    size_t size;
    FILE *f = open_memstream(&text, &size);
    hf_json_pack_values("a", "f32", (const double[]){1.5, -0.1, INFINITY}, 3, f);
    hf_json_pack_values("b", "i32", (const double[]){-2, 70000}, 2, f);
    hf_json_pack_values("c", "f64", (const double[]){0.1}, 1, f);
    hf_json_pack_values("d", "f32", NULL, 0, f);
    hf_json_pack_values("e", "i32", (const double[]){INT_MIN}, 1, f);
    fclose(f);
    ck_assert_str_eq(text,
                     ",\"a\":{\"f32\":\"AADAP83MzL0AAIB/\"},\"b\":{\"i32\":\"/v///"
                     "3ARAQA=\"},\"c\":{\"f64\":\"mpmZmZmZuT8=\"},\"d\":{\"f32\":\"\"},\"e\":{\"i32\":\"AAAAgA==\"}");
    free(text);
}
END_TEST

Suite *suite_unit_json(void)
{
    Suite *suite = suite_create("unit/json");
    TCase *tests = tcase_create("json");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, commas_stand_between_items);
    tcase_add_test(tests, texts_are_escaped);
    tcase_add_test(tests, numbers_are_packed);
    return suite;
}
