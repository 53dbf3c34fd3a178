/* Reading CSV: what is accepted in which spelling, and every fault with file, line and id. */
#include "nets.h"

#include "net/scene_import.h"

#define NODES "id,x_m,y_m,z_m,role\n"
#define CABLES "id,i,j,group,law,value\n"
#define GOOD_NODES NODES "a,0,0,0,support\nb,1.5,-2.25,3e-1,inner\nc,4,0,0,support\n"
#define GOOD_CABLES CABLES "ab,a,b,inner,tension,12.5\nbc,b,c,boundary,length,\n"

/* Import and check; what was said, without the folder of the files. */
static hf_status import(const char *nodes, const char *cables, hf_scene *scene, char *said, size_t size)
{
    hf_messages messages = {0};
    const char *nodes_path = temp_path("nodes.csv"), *cables_path = temp_path("cables.csv");
    if (nodes) write_file(nodes_path, nodes);
    if (cables) write_file(cables_path, cables);
    hf_status status = hf_scene_import(nodes_path, cables_path, (const double[2]){0}, scene, &messages);
    if (status == HF_OK) status = hf_scene_check(scene, &messages);
    copy_without_folder(messages.text, said, size);
    hf_messages_free(&messages);
    return status;
}

static const struct {
    const char *name, *nodes, *cables;
} spelling[] = {
    {"plain", GOOD_NODES, GOOD_CABLES},
    {"any order of columns", "role,z_m,id,y_m,x_m\nsupport,0,a,0,0\ninner,3e-1,b,-2.25,1.5\nsupport,0,c,0,4\n",
     "value,law,j,i,id,group\n12.5,tension,b,a,ab,inner\n,length,c,b,bc,boundary\n"},
    {"quotes", "\"id\",x_m,y_m,z_m,role\n\"a\",\"0\",0,0,support\n\"b\",1.5,-2.25,3e-1,\"inner\"\nc,4,0,0,support\n",
     CABLES "\"ab\" , \"a\" ,b,inner,tension,\"12.5\"\nbc,b,c,boundary,length,\"\"\n"},
    {"CRLF", "id,x_m,y_m,z_m,role\r\na,0,0,0,support\r\nb,1.5,-2.25,3e-1,inner\r\nc,4,0,0,support\r\n",
     "id,i,j,group,law,value\r\nab,a,b,inner,tension,12.5\r\nbc,b,c,boundary,length,\r\n"},
    {"CRCRLF", "id,x_m,y_m,z_m,role\r\r\na,0,0,0,support\r\r\nb,1.5,-2.25,3e-1,inner\r\r\nc,4,0,0,support\r\r\n",
     "id,i,j,group,law,value\r\r\nab,a,b,inner,tension,12.5\r\r\nbc,b,c,boundary,length,\r\r\n"},
    {"byte order mark", "\xEF\xBB\xBF" GOOD_NODES, "\xEF\xBB\xBF" GOOD_CABLES},
    {"comments and empty lines",
     "# net\n\n" NODES "# a\na,0,0,0,support\n \t\nb,1.5,-2.25,3e-1,inner\n#\nc,4,0,0,support",
     "#\n" CABLES "\n\nab,a,b,inner,tension,12.5\n#ab,a,b\nbc,b,c,boundary,length,"},
    {"blanks", "id, x_m ,y_m,z_m,role\n a , 0,0 ,\t0,support\nb,1.5 , -2.25,3e-1, inner \nc,4,0,0,support\n",
     CABLES " ab,a , b,inner, tension,12.5 \nbc,b,c,boundary,length, \n"},
};
enum { N_SPELLING = sizeof spelling / sizeof *spelling };

START_TEST(every_spelling_gives_the_same_scene)
{
    char said[512];
    hf_scene s;
    hf_status status = import(spelling[_i].nodes, spelling[_i].cables, &s, said, sizeof said);
    ck_assert_msg(status == HF_OK, "%s: %s", spelling[_i].name, said);
    ck_assert_str_eq(said, "");
    static const double position[] = {0, 0, 0, 1.5, -2.25, 0.3, 4, 0, 0};
    static const unsigned char role[] = {HF_ROLE_SUPPORT, HF_ROLE_INNER, HF_ROLE_SUPPORT};
    static const int end[] = {0, 1, 1, 2};
    ck_assert_int_eq(s.n_node, 3);
    ck_assert_int_eq(s.n_cable, 2);
    ck_assert_mem_eq(s.position_m, position, sizeof position);
    ck_assert_mem_eq(s.role, role, sizeof role);
    ck_assert_mem_eq(s.end, end, sizeof end);
    ck_assert_str_eq(s.node_id[1], "b");
    ck_assert_str_eq(s.cable_id[1], "bc");
    ck_assert(s.group[0] == HF_GROUP_INNER && s.group[1] == HF_GROUP_BOUNDARY);
    ck_assert(s.law[0] == HF_LAW_TENSION && s.law[1] == HF_LAW_LENGTH);
    ck_assert_double_eq(s.target[0], 12.5);
    ck_assert_double_eq(s.target[1], hf_scene_length_at_target(&s, 1)); /* empty: the theoretical length */
    ck_assert_ptr_null(s.load_N);
    ck_assert_ptr_null(s.EA_N);
    hf_scene_free(&s);
}
END_TEST

START_TEST(optional_columns)
{
    char said[512];
    hf_scene s;
    hf_status status =
        import("Fz_N,id,x_m,y_m,z_m,role,Fx_N\n,a,0,0,0,support,\n-2.5,b,1,0,0,inner,\n,c,2,0,0,support,0\n",
               "id,i,j,group,law,value,EA_N\nab,a,b,inner,force_density,-3.5,47000\n"
               "\"b,\"\"c\"\"\",b,c,inner,tension,,\n",
               &s, said, sizeof said);
    ck_assert_msg(status == HF_OK, "%s", said);
    static const double load[] = {0, 0, 0, 0, 0, -2.5, 0, 0, 0};
    ck_assert_ptr_nonnull(s.load_N);
    ck_assert_mem_eq(s.load_N, load, sizeof load);
    ck_assert_double_eq(s.target[0], -3.5); /* a strut */
    ck_assert_double_nan(s.target[1]);      /* the pretension of the case */
    ck_assert_double_eq(s.EA_N[0], 47000);
    ck_assert_double_nan(s.EA_N[1]);
    ck_assert_str_eq(s.cable_id[1], "b,\"c\"");
    ck_assert_int_eq(s.cable_line[1], 3);
    hf_scene_free(&s);
}
END_TEST

START_TEST(loads_of_zero_are_no_loads)
{
    char said[512];
    hf_scene s;
    hf_status status = import("id,x_m,y_m,z_m,role,Fx_N\na,0,0,0,support,0\nb,1.5,0,0,inner,0\nc,4,0,0,support,\n",
                              GOOD_CABLES, &s, said, sizeof said);
    ck_assert_msg(status == HF_OK, "%s", said);
    ck_assert_ptr_null(s.load_N);
    hf_scene_free(&s);
}
END_TEST

/* To the bits of the same table in metres; 10 inches and 10 feet by definition. */
START_TEST(lengths_may_be_in_millimetres)
{
    static const struct {
        const char *nodes;
        double x_m, y_m, z_m;
    } table[] = {
        {"id,x_mm,y_mm,z_mm,role\na,0,0,0,support\nb,1234.5,-0.7,+12e2,inner\nc,4e3,0,0,support\n", 1.2345, -0.0007,
         1.2},
        {"id,x_cm,y_cm,z_cm,role\na,0,0,0,support\nb,123.45,.1,7.E-1,inner\nc,4e2,0,0,support\n", 1.2345, 0.001, 0.007},
        {"id,x_in,y_in,z_in,role\na,0,0,0,support\nb,10,-1,1000,inner\nc,99,0,0,support\n", 0.254, -0.0254, 25.4},
        {"id,x_ft,y_ft,z_ft,role\na,0,0,0,support\nb,10,-1,0,inner\nc,99,0,0,support\n", 3.048, -0.3048, 0},
    };
    char said[512];
    hf_scene s;
    for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
        ck_assert_int_eq(import(table[k].nodes, GOOD_CABLES, &s, said, sizeof said), HF_OK);
        ck_assert_msg(!strstr(said, "column"), "%s", said);
        ck_assert_double_eq(s.position_m[3], table[k].x_m);
        ck_assert_double_eq(s.position_m[4], table[k].y_m);
        ck_assert_double_eq(s.position_m[5], table[k].z_m);
        hf_scene_free(&s);
    }
}
END_TEST

START_TEST(unused_columns_are_warned_about)
{
    char said[512];
    hf_scene s;
    hf_status status = import("id,x_m,y_m,z_m,role,FzN\na,0,0,0,support,\nb,1.5,0,0,inner,\nc,4,0,0,support,\n",
                              GOOD_CABLES, &s, said, sizeof said);
    ck_assert_int_eq(status, HF_OK);
    ck_assert_str_eq(said, "warning: nodes.csv:1: column 'FzN' is not used; did you mean 'Fz_N'?\n");
    hf_scene_free(&s);
}
END_TEST

/* ---- faults: NULL stands for the good file ---- */

static const struct {
    const char *nodes, *cables, *said;
} faulty[] = {
    {"", NULL, "error: nodes.csv:1: the file is empty: a header line is needed\n"},
    {NULL, "# only a comment\n\n", "error: cables.csv:1: the file is empty: a header line is needed\n"},
    {NODES, NULL, "error: nodes.csv:1: there is a header, but no rows\n"},
    {NULL, CABLES, "error: cables.csv:1: there is a header, but no rows\n"},
    {"id,x_m,y_m,role\na,0,0,support\n", NULL, "error: nodes.csv:1: a column is missing: z_m\n"},
    {NULL, "id,i,j,group,value\nab,a,b,inner,1\n", "error: cables.csv:1: a column is missing: law\n"},
    {"id,x_m,x_m,y_m,z_m,role\na,0,0,0,0,support\n", NULL, "error: nodes.csv:1: this column stands twice: x_m\n"},
    {"id,x_m,x_mm,y_m,z_m,role\na,0,0,0,0,support\n", NULL, "error: nodes.csv:1: this column stands twice: x_m\n"},
    {"id,x_mm,y_mm,z_m,role\na,0,0,0,support\n", NULL, "error: nodes.csv:1: lengths are in one unit, mm or m: z_m\n"},
    {"id,x_mm,y_mm,role\na,0,0,support\n", NULL, "error: nodes.csv:1: a column is missing: z_m\n"},
    {"id,x_mm,y_mm,z_mm,role\na,0,0,0,support\nb,1,,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': y_mm must be a finite number, not empty\n"},
    {NODES "a,0,0,0,support\nb,1,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 4 fields where the header has 5\n"},
    {NODES "a,0,0,0,support\nb,1,0,0,inner,9\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 6 fields where the header has 5\n"},
    {NODES "a,0,0,0,support\n\"b,1,0,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: a quoted field does not end on this line\n"},
    {NODES "a,0,0,0,support\n\"b\"x,1,0,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: a quoted field does not end on this line\n"},
    {NODES "a,0,0,0,support\nb,1,0,0,inner\nc,4,0,0,support\nb,5,0,0,inner\n", NULL,
     "error: nodes.csv:5: 'b': this id was used before, on line 3\n"},
    {NULL, CABLES "ab,a,b,inner,tension,1\n# gap\nab,b,c,inner,tension,1\n",
     "error: cables.csv:4: 'ab': this id was used before, on line 2\n"},
    {NODES "a,0,0,0,support\nb,1,0,0,inner\nc,4,0,0,support\n,5,0,0,inner\n", NULL,
     "error: nodes.csv:5: the id is empty\n"},
    {NODES "a,0,0,0,support\nb,1,nan,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': y_m must be a finite number, not nan\n"},
    {NODES "a,0,0,0,support\nb,1,NaN,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': y_m must be a finite number, not NaN\n"},
    {NODES "a,0,0,0,support\nb,1,inf,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': y_m must be a finite number, not inf\n"},
    {NODES "a,0,0,0,support\nb,1,-inf,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': y_m must be a finite number, not -inf\n"},
    {NODES "a,0,0,0,support\nb,1,0x10,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': y_m must be a finite number, not 0x10\n"},
    {NODES "a,0,0,0,support\nb,1,1;5,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': y_m must be a finite number, not 1;5\n"},
    {NODES "a,0,0,0,support\nb,1,1e999,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': y_m must be a finite number, not 1e999\n"},
    {NODES "a,0,0,0,support\nb,1,1.2.3,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': y_m must be a finite number, not 1.2.3\n"},
    {NODES "a,0,0,0,support\nb,1,one,0,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': y_m must be a finite number, not one\n"},
    {NODES "a,0,0,0,support\nb,1,0,,inner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': z_m must be a finite number, not empty\n"},
    {"id,x_m,y_m,z_m,role,Fy_N\na,0,0,0,support,\nb,1,0,0,inner,nan\nc,4,0,0,support,\n", NULL,
     "error: nodes.csv:3: 'b': Fy_N must be a finite number, not nan\n"},
    {NODES "a,0,0,0,support\nb,1,0,0,iner\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': role must be one of support inner edge, not iner; did you mean 'inner'?\n"},
    {NODES "a,0,0,0,support\nb,1,0,0,\nc,4,0,0,support\n", NULL,
     "error: nodes.csv:3: 'b': role must be one of support inner edge, not empty\n"},
    {NULL, CABLES "ab,a,b,middle,tension,1\nbc,b,c,boundary,length,\n",
     "error: cables.csv:2: 'ab': group must be one of inner boundary, not middle\n"},
    {NULL, CABLES "ab,a,b,inner,rigid,1\nbc,b,c,boundary,length,\n",
     "error: cables.csv:2: 'ab': law must be one of tension length force_density elastic, not rigid\n"},
    {NULL, CABLES "ab,a,b,inner,elastic,1\nbc,b,c,boundary,length,\n",
     "error: cables.csv:2: 'ab': the law elastic needs an EA_N\n"},
    {NULL, "id,i,j,group,law,value,EA_N\nab,a,b,inner,elastic,1,\nbc,b,c,boundary,elastic,,5\n",
     "error: cables.csv:2: 'ab': the law elastic needs an EA_N\n"
     "error: cables.csv:3: 'bc': the law elastic needs a value, the unstressed length in m\n"},
    {NULL, "id,i,j,group,law,value,EA_N\nab,a,b,inner,elastic,-1,5\nbc,b,c,boundary,length,,\n",
     "error: cables.csv:2: 'ab': value must be above zero for the law elastic\n"},
    {NULL, CABLES "ab,a,x,inner,tension,1\nbc,b,c,boundary,length,\n",
     "error: cables.csv:2: 'ab': there is no node with the id x\n"},
    {NULL, CABLES "ab,,b,inner,tension,1\nbc,b,c,boundary,length,\n",
     "error: cables.csv:2: 'ab': there is no node with the id (empty)\n"},
    {NULL, CABLES "ab,b,b,inner,tension,1\nbc,b,c,boundary,length,\n",
     "error: cables.csv:2: cable 'ab' joins a node to itself\n"},
    {NULL, CABLES "ab,a,b,inner,tension,inf\nbc,b,c,boundary,length,\n",
     "error: cables.csv:2: 'ab': value must be a finite number, not inf\n"},
    {NULL, CABLES "ab,a,b,inner,tension,0\nbc,b,c,boundary,length,\n",
     "error: cables.csv:2: 'ab': value must be above zero for the law tension\n"},
    {NULL, CABLES "ab,a,b,boundary,length,-1\nbc,b,c,boundary,length,\n",
     "error: cables.csv:2: 'ab': value must be above zero for the law length\n"},
    {NULL, CABLES "ab,a,b,inner,force_density,0\nbc,b,c,boundary,length,\n",
     "error: cables.csv:2: 'ab': value must not be zero for the law force_density\n"},
    {NULL, CABLES "ab,a,b,inner,force_density,\nbc,b,c,boundary,length,\n",
     "error: cables.csv:2: 'ab': the law force_density needs a value in N/m\n"},
    {NULL, "id,i,j,group,law,value,EA_N\nab,a,b,inner,tension,1,0\nbc,b,c,inner,tension,1,\n",
     "error: cables.csv:2: 'ab': EA_N must be above zero\n"},
    {NODES "a,0,0,0,support\n\nb,0,0,0,inner\nc,4,0,0,support\n", NULL,
     "error: cables.csv:2: cable 'ab' has zero length: its two nodes are at the same position\n"},
    {GOOD_NODES "d,1,1,1,inner\n", NULL,
     "error: nodes.csv:5: node 'd' has no path of cables to a support; connect it or remove it\n"},
};
enum { N_FAULTY = sizeof faulty / sizeof *faulty };

START_TEST(faults_are_named_by_file_line_and_id)
{
    char said[1024];
    hf_scene s;
    hf_status status = import(faulty[_i].nodes ? faulty[_i].nodes : GOOD_NODES,
                              faulty[_i].cables ? faulty[_i].cables : GOOD_CABLES, &s, said, sizeof said);
    ck_assert_str_eq(said, faulty[_i].said);
    ck_assert_int_eq(status, HF_BAD_CASE);
    hf_scene_free(&s);
}
END_TEST

START_TEST(binary_and_missing_files_are_refused)
{
    char said[512];
    hf_scene s;
    ck_assert_int_eq(import(NULL, GOOD_CABLES, &s, said, sizeof said), HF_BAD_CASE);
    ck_assert_str_eq(said, "error: nodes.csv: cannot open: No such file or directory\n");
    FILE *file = fopen(temp_path("nodes.csv"), "wb");
    ck_assert_ptr_nonnull(file);
    fwrite("\x89HDF\r\n\x1a\n\0\0\0\0", 1, 12, file);
    fclose(file);
    ck_assert_int_eq(import(NULL, GOOD_CABLES, &s, said, sizeof said), HF_BAD_CASE);
    ck_assert_str_eq(said, "error: nodes.csv: this file is not a text file\n");
    file = fopen(temp_path("nodes.csv"), "wb"); /* without a byte order mark */
    ck_assert_ptr_nonnull(file);
    fwrite("i\0d\0,\0", 1, 6, file);
    fclose(file);
    ck_assert_int_eq(import(NULL, GOOD_CABLES, &s, said, sizeof said), HF_BAD_CASE);
    ck_assert_str_eq(said, "error: nodes.csv: this file contains UTF-16 text. Save the file as CSV UTF-8\n");
}
END_TEST

START_TEST(faults_of_both_files_are_told_in_one_run)
{
    char said[1024];
    hf_scene s;
    ck_assert_int_eq(
        import(NODES "a,0,0,0,support\nb,one,0,0,inner\n", CABLES "ab,a,x,inner,tension,1\n", &s, said, sizeof said),
        HF_BAD_CASE);
    ck_assert_str_eq(said, "error: nodes.csv:3: 'b': x_m must be a finite number, not one\n"
                           "error: cables.csv:2: 'ab': there is no node with the id x\n");
}
END_TEST

/* Within a set in the order of the file, however many names lie between. */
START_TEST(faults_of_sets_are_in_order)
{
    char said[2048], cables[1024] = "id,i,j,group,law,value,set\n", expected[2048] = "";
    hf_scene s;
    for (int k = 0; k < 9; k++) {
        char row[64], words[96];
        snprintf(row, sizeof row, "c%d,a,b,inner,tension,%d,%s\n", k, k + 1, k % 2 ? "rim" : "hub rim hub");
        strcat(cables, row);
        snprintf(words, sizeof words, "error: cables.csv:%d: 'c%d': stands twice in the set hub\n", k + 2, k);
        if (k % 2 == 0) strcat(expected, words);
    }
    ck_assert_int_eq(import(GOOD_NODES, cables, &s, said, sizeof said), HF_BAD_CASE);
    ck_assert_str_eq(said, expected);
    hf_scene_free(&s);
}
END_TEST

START_TEST(many_faults_are_cut_short)
{
    char nodes[2048] = NODES, said[8192];
    int n_line = 0;
    hf_scene s;
    for (int i = 0; i < 50; i++)
        snprintf(nodes + strlen(nodes), 64, "n%d,?,0,0,inner\n", i);
    ck_assert_int_eq(import(nodes, CABLES "c,n0,n1,inner,tension,1\n", &s, said, sizeof said), HF_BAD_CASE);
    for (const char *p = said; (p = strchr(p, '\n')) != NULL; p++)
        n_line++;
    ck_assert_int_eq(n_line, 21);
    ck_assert_ptr_nonnull(strstr(said, "error: nodes.csv: hifdm found 30 more faults in this file\n"));
}
END_TEST

START_TEST(too_many_columns_are_refused)
{
    char nodes[512] = "id", said[512];
    hf_scene s;
    for (int i = 0; i < 70; i++)
        snprintf(nodes + strlen(nodes), 8, ",x%d", i);
    ck_assert_int_eq(import(nodes, GOOD_CABLES, &s, said, sizeof said), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(said, "error: nodes.csv:1: too many columns\n"));
}
END_TEST

Suite *suite_unit_scene_import(void)
{
    Suite *suite = suite_create("unit/scene_import");
    TCase *tests = tcase_create("scene_import");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, every_spelling_gives_the_same_scene, 0, N_SPELLING);
    tcase_add_test(tests, optional_columns);
    tcase_add_test(tests, loads_of_zero_are_no_loads);
    tcase_add_test(tests, lengths_may_be_in_millimetres);
    tcase_add_test(tests, unused_columns_are_warned_about);
    tcase_add_loop_test(tests, faults_are_named_by_file_line_and_id, 0, N_FAULTY);
    tcase_add_test(tests, binary_and_missing_files_are_refused);
    tcase_add_test(tests, faults_of_both_files_are_told_in_one_run);
    tcase_add_test(tests, faults_of_sets_are_in_order);
    tcase_add_test(tests, many_faults_are_cut_short);
    tcase_add_test(tests, too_many_columns_are_refused);
    return suite;
}
