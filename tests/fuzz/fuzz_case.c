/* A case file, behind it overrides as --set takes them, each behind a line "%%": the settings, scene, truss and
 * model. What was accepted must read back from the text and the overrides that a result file keeps. */
#include "fuzz/fuzz.h"

#include "run/problem_parts.h"

#include <stdlib.h>
#include <string.h>

enum { SET_MAX = 8 };

/* The rest of the input as overrides, each behind a line "%%"; they may have line ends of their own. The caller frees
 * them. Returns their number. */
static int take_overrides(const uint8_t *data, size_t size, char *set[SET_MAX])
{
    int n = 0;
    for (size_t n_byte, next; n < SET_MAX && size; data += next, size -= next) {
        next = fuzz_split(data, size, &n_byte);
        set[n] = strndup((const char *)data, n_byte && data[n_byte - 1] == '\n' ? n_byte - 1 : n_byte);
        FUZZ_REQUIRE(set[n++] != NULL);
    }
    return n;
}

/* As a store reads a case: an override a line. */
static void read_back(const hf_case *settings)
{
    hf_case again;
    hf_messages messages = {0};
    char text[200], *lines = strdup(settings->overrides);
    const char *set[SET_MAX + 1];
    int n_set = 0;
    FUZZ_REQUIRE(lines != NULL);
    for (char *line = lines, *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        *end = '\0';
        FUZZ_REQUIRE(n_set < SET_MAX);
        set[n_set++] = line;
    }
    hf_status status = hf_config_parse(settings->path, settings->text, set, n_set, &again, &messages);
    FUZZ_REQUIRE(status == HF_OK);
    again.has_sweep = settings->has_sweep; /* the section is not kept */
    FUZZ_REQUIRE(hf_config_differences(settings, &again, text, sizeof text) == 0);
    hf_case_free(&again);
    free(lines);
    fuzz_judge(status, &messages);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char path[FUZZ_PATH_SIZE];
    if (!*path) { /* tables that a case can name */
        fuzz_path("case.yaml", path);
        fuzz_write_text("n.csv", "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,0,support\nc,0.5,1,0,inner\n");
        fuzz_write_text("c.csv", "id,i,j,group,law,value\nac,a,c,inner,tension,\ncb,c,b,boundary,length,\n");
        fuzz_write_text("t.csv", "id,x_m,y_m,z_m,fixed\nA,0,0,0,all\nB,1,0,0,all\n");
        fuzz_write_text("m.csv", "id,i,j,E_Pa,A_m2\nAB,A,B,1e9,1e-3\n");
    }
    hf_problem problem;
    hf_messages messages = {0};
    char *set[SET_MAX];
    size_t n_byte, second = fuzz_split(data, size, &n_byte);
    int n_set = take_overrides(data + second, size - second, set);
    fuzz_write("case.yaml", data, n_byte);
    hf_status status = hf_problem_load(path, NULL, (const char *const *)set, n_set, NULL, &problem, &messages);
    if (status == HF_OK) read_back(&problem.settings);
    hf_problem_free(&problem);
    fuzz_judge(status, &messages);
    for (int i = 0; i < n_set; i++)
        free(set[i]);
    return 0;
}
