/* Names of files as text, and which of them are one file. */
#include "support.h"

#include "base/path.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const struct {
    const char *path, *name, *ending, *folder, *chosen, *inserted;
} part[] = {
    {"net.yaml", "net.yaml", ".yaml", ".", "net.h5", "net_nodes.yaml"},
    {"a/net.yaml", "net.yaml", ".yaml", "a", "net.h5", "a/net_nodes.yaml"},
    {"a.b/net", "net", "", "a.b", "net.h5", "a.b/net_nodes"},
    {"/net.x.y", "net.x.y", ".y", "/", "net.x.h5", "/net.x_nodes.y"},
    {"/a/.net", ".net", "", "/a", ".net.h5", "/a/.net_nodes"},
    {"a/", "", "", "a", ".h5", "a/_nodes"},
    {"a//net.", "net.", ".", "a/", "net.h5", "a//net_nodes."},
    {"", "", "", ".", ".h5", "_nodes"},
};

START_TEST(a_path_has_parts)
{
    char text[64];
    ck_assert_str_eq(hf_path_name(part[_i].path), part[_i].name);
    ck_assert_str_eq(hf_path_ending(part[_i].path), part[_i].ending);
    ck_assert(hf_path_folder(part[_i].path, text, sizeof text));
    ck_assert_str_eq(text, part[_i].folder);
    ck_assert(hf_path_choose(NULL, part[_i].path, ".h5", text, sizeof text));
    ck_assert_str_eq(text, part[_i].chosen);
    ck_assert(hf_path_insert(part[_i].path, "_nodes", text, sizeof text));
    ck_assert_str_eq(text, part[_i].inserted);
    size_t n = (size_t)hf_path_prefix_length(part[_i].path);
    ck_assert_uint_eq(n + strlen(part[_i].name), strlen(part[_i].path));
}
END_TEST

START_TEST(what_a_file_names_is_beside_it)
{
    char text[32];
    ck_assert(hf_path_beside("cases/net.yaml", "n.csv", text, sizeof text));
    ck_assert_str_eq(text, "cases/n.csv");
    ck_assert(hf_path_beside("net.yaml", "n.csv", text, sizeof text));
    ck_assert_str_eq(text, "n.csv");
    ck_assert(hf_path_beside("cases/net.yaml", "/n.csv", text, sizeof text));
    ck_assert_str_eq(text, "/n.csv");
    ck_assert(hf_path_beside("/net.yaml", "n.csv", text, sizeof text));
    ck_assert_str_eq(text, "/n.csv");
}
END_TEST

START_TEST(what_does_not_fit_is_told)
{
    char text[8];
    ck_assert(hf_path_folder("1234567/x", text, sizeof text));
    ck_assert(!hf_path_folder("12345678/x", text, sizeof text));
    ck_assert(hf_path_choose("1234567", "x", ".h5", text, sizeof text));
    ck_assert(!hf_path_choose("12345678", "x", ".h5", text, sizeof text));
    ck_assert(hf_path_choose(NULL, "a/1234.yaml", ".h5", text, sizeof text));
    ck_assert(!hf_path_choose(NULL, "a/12345.yaml", ".h5", text, sizeof text));
    ck_assert(hf_path_insert("12.c", "_45", text, sizeof text));
    ck_assert(!hf_path_insert("12.c", "_456", text, sizeof text));
    ck_assert(hf_path_beside("12/x", "4567", text, sizeof text));
    ck_assert(!hf_path_beside("12/x", "45678", text, sizeof text));
}
END_TEST

START_TEST(names_may_lead_to_one_file)
{
    const char *a = temp_path("a"), *b = temp_path("b"), *link_to_a = temp_path("link"), *twin = temp_path("twin");
    write_file(a, "a");
    write_file(b, "a");
    ck_assert_int_eq(symlink(a, link_to_a), 0);
    ck_assert_int_eq(link(a, twin), 0);
    ck_assert(hf_path_compare(a, a) == 1);
    ck_assert(hf_path_compare(a, link_to_a) == 1);
    ck_assert(hf_path_compare(twin, a) == 1);
    ck_assert(hf_path_compare(a, b) == 0);
    ck_assert(hf_path_compare(temp_path("none"), temp_path("none")) == 0);
    ck_assert(hf_path_will_be_same(temp_path("none"), temp_path("./none")));
    ck_assert(hf_path_will_be_same("none", "././none"));
    ck_assert(!hf_path_will_be_same("none", temp_path("none")));
    ck_assert(!hf_path_will_be_same(temp_path("none"), temp_path("nine")));

    int file = open(a, O_RDONLY);
    ck_assert_int_ge(file, 0);
    ck_assert(hf_path_leads_to(link_to_a, file));
    ck_assert_int_eq(rename(b, a), 0);
    ck_assert(!hf_path_leads_to(a, file));
    ck_assert(hf_path_leads_to(twin, file));
    ck_assert_int_eq(close(file), 0);
}
END_TEST

Suite *suite_unit_path(void)
{
    Suite *suite = suite_create("unit/path");
    TCase *tc = tcase_create("path");
    tcase_add_loop_test(tc, a_path_has_parts, 0, sizeof part / sizeof *part);
    tcase_add_test(tc, what_a_file_names_is_beside_it);
    tcase_add_test(tc, what_does_not_fit_is_told);
    tcase_add_test(tc, names_may_lead_to_one_file);
    suite_add_tcase(suite, tc);
    return suite;
}
