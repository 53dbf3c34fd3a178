/* A table of facets: what is accepted, and every fault with file, line and id. */
#include "nets.h"

#include "net/facet_import.h"
#include <hifdm/facets.h>

/* A square 0 1 4 3 beside a triangle 1 2 4, a node in the middle of their seam's side, and a far one:
 *
 *     d   e            a b c are on y = 0, m between b and e, far away from all: z
 *     a   b   c */
static const char *const id[] = {"a", "b", "c", "d", "e", "m", "z, far"};
static const double xy[][2] = {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {1, 0.5}, {9, 9}};
static const int end[][2] = {{0, 1}, {1, 4}, {4, 3}, {3, 0}, {1, 2}, {2, 4}, {1, 5}, {5, 4}, {0, 2}};
enum { N_NODE = 7, N_CABLE = 9 };

static hf_status import(const char *table, hf_scene *s, char *said, size_t size)
{
    hf_messages messages = {0};
    ck_assert_int_eq(hf_scene_allocate(s, N_NODE, N_CABLE, false, false, false), HF_OK);
    for (int i = 0; i < N_NODE; i++) {
        memcpy(s->position_m + 3 * i, xy[i], sizeof xy[i]);
        s->node_id[i] = id[i];
        s->role[i] = i == 0 || i == 3 ? HF_ROLE_SUPPORT : HF_ROLE_INNER;
    }
    memcpy(s->end, end, sizeof end);
    write_file(temp_path("facets.csv"), table);
    hf_status status = hf_facet_import(temp_path("facets.csv"), s, &messages);
    copy_without_folder(messages.text, said, size);
    hf_messages_free(&messages);
    return status;
}

/* Either way around, in any order of columns, with or without a column d. */
START_TEST(facets_are_taken_counter_clockwise)
{
    static const char *const table[] = {"id,a,b,c,d\n1,a,b,e,d\n2,b,c,e,\n", "d,c,b,a,id\nb,e,d,a,1\n,b,e,c,2\n"};
    static const int corner[2][8] = {{0, 1, 4, 3, 1, 2, 4, 4}, {0, 1, 4, 3, 2, 4, 1, 1}};
    const hf_surface_settings any = {.focal_length_m = 1, .kind = HF_SURFACE_PARABOLOID};
    char said[512];
    hf_scene s;
    hf_facets f;
    ck_assert_msg(import(table[_i], &s, said, sizeof said) == HF_OK, "%s", said);
    ck_assert_str_eq(said, "");
    ck_assert_int_eq(s.n_facet, 2);
    ck_assert_mem_eq(s.facet, corner[_i], sizeof corner[_i]);
    ck_assert_int_eq(hf_facets_find(&s, &any, &f), HF_OK); /* those that are named are those that are found */
    ck_assert_int_eq(f.n_facet, 2);
    ck_assert_int_eq(f.n_open, 0);
    ck_assert(f.is_planar);
    ck_assert_mem_eq(f.corner, corner[_i], sizeof corner[_i]);
    hf_facets_free(&f);
    hf_scene_free(&s);
}
END_TEST

/* A square that is a metre behind the surface, as one of a rear net. */
START_TEST(facets_behind_the_surface_do_not_count)
{
    const hf_surface_settings flat = {.focal_length_m = 1e6, .kind = HF_SURFACE_PARABOLOID};
    char said[512];
    hf_scene s;
    hf_facets f;
    ck_assert_int_eq(import("id,a,b,c,d\n1,a,b,e,d\n2,b,c,e,\n", &s, said, sizeof said), HF_OK);
    for (int i = 0; i < N_NODE; i++) {
        bool is_rear = i == 0 || i == 1 || i == 3 || i == 4;
        s.position_m[3 * i + 2] = is_rear ? -1 : 0;
        s.role[i] = is_rear ? HF_ROLE_EDGE : HF_ROLE_INNER;
    }
    ck_assert_int_eq(hf_facets_find(&s, &flat, &f), HF_OK);
    ck_assert_int_eq(f.n_facet, 1);
    ck_assert_mem_eq(f.corner, s.facet + 4, 4 * sizeof *s.facet);
    hf_facets_free(&f);
    hf_scene_free(&s);
}
END_TEST

START_TEST(triangles_need_no_fourth_column)
{
    static const int corner[] = {1, 2, 4, 4};
    char said[512];
    hf_scene s;
    ck_assert_int_eq(import("id,a,b,c\nonly,b,c,e\n", &s, said, sizeof said), HF_OK);
    ck_assert_int_eq(s.n_facet, 1);
    ck_assert_mem_eq(s.facet, corner, sizeof corner);
    hf_scene_free(&s);
}
END_TEST

#define HEAD "id,a,b,c,d\n"
static const struct {
    const char *table, *said;
} faulty[] = {
    {HEAD "1,a,b,x,d\n", "error: facets.csv:2: '1': there is no node with the id x\n"},
    {HEAD "1,a,b,e,d\n\"t,1\",b,c,b,\n", "error: facets.csv:3: 't,1': names a node twice: b\n"},
    {HEAD "1,a,b,c,\n", "error: facets.csv:2: '1': its nodes are in a line, seen along z\n"},
    {HEAD "1,a,e,b,d\n", "error: facets.csv:2: '1': its nodes, in this order, do not go around a convex quadrilateral, "
                         "seen along z\n"},
    {HEAD "1,a,b,,\n", "error: facets.csv:2: '1': a facet has three or four nodes; there is none in the column c\n"},
    {HEAD "1,a,b,e\n", "error: facets.csv:2: 4 fields where the header has 5\n"},
    {"id,a,b\n1,a,b\n", "error: facets.csv:1: a column is missing: c\n"},
    {HEAD "1,a,b,e,d\n1,b,c,e,\n", "error: facets.csv:3: '1': this id was used before, on line 2\n"},
    {HEAD "1,a,b,d,\n2,a,d,e,\n", "error: facets.csv:2: '1': no cable joins its nodes 'b' and 'd'\n"},
    {HEAD "1,a,b,e,\n", "error: facets.csv:2: '1': no cable joins its nodes 'e' and 'a'\n"},
    {HEAD "1,a,b,e,d\n\n2,d,e,b,a\n",
     "error: facets.csv:4: '2': is on the same side of a cable as the facet '1' on line 2\n"},
    {HEAD "1,a,b,e,d\n2,b,c,e,\n3,a,c,e,d\n", /* in the order of nodes, one for each side */
     "error: facets.csv:4: '3': is on the same side of a cable as the facet '2' on line 3\n"
     "error: facets.csv:4: '3': is on the same side of a cable as the facet '1' on line 2\n"
     "error: facets.csv:4: '3': is on the same side of a cable as the facet '1' on line 2\n"},
    {HEAD, "error: facets.csv:1: there is a header, but no rows\n"},
};
enum { N_FAULTY = sizeof faulty / sizeof *faulty };

START_TEST(faults_are_named_by_file_line_and_id)
{
    char said[2048];
    hf_scene s;
    ck_assert_int_eq(import(faulty[_i].table, &s, said, sizeof said), HF_BAD_CASE);
    ck_assert_msg(!strncmp(said, faulty[_i].said, strlen(faulty[_i].said)), "%s is not\n%s", said, faulty[_i].said);
    hf_scene_free(&s);
}
END_TEST

Suite *suite_unit_facet_import(void)
{
    Suite *suite = suite_create("unit/facet_import");
    TCase *tests = tcase_create("facet_import");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, facets_are_taken_counter_clockwise, 0, 2);
    tcase_add_test(tests, facets_behind_the_surface_do_not_count);
    tcase_add_test(tests, triangles_need_no_fourth_column);
    tcase_add_loop_test(tests, faults_are_named_by_file_line_and_id, 0, N_FAULTY);
    return suite;
}
