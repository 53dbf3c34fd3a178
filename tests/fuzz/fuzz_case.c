/* A case file: its settings, its scene, truss and model. What was accepted must read back from the text that a result
 * file would keep. */
#include "fuzz/fuzz.h"

#include "run/problem_parts.h"

static void read_back(const hf_case *settings)
{
    hf_case again;
    hf_messages messages = {0};
    char text[200];
    hf_status status = hf_config_parse(settings->path, settings->text, NULL, 0, &again, &messages);
    FUZZ_REQUIRE(status == HF_OK);
    again.has_sweep = settings->has_sweep; /* the section is not kept */
    FUZZ_REQUIRE(hf_config_differences(settings, &again, text, sizeof text) == 0);
    hf_case_free(&again);
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
    fuzz_write("case.yaml", data, size);
    hf_status status = hf_problem_load(path, NULL, 0, &problem, &messages);
    if (status == HF_OK) read_back(&problem.settings);
    hf_problem_free(&problem);
    fuzz_judge(status, &messages);
    return 0;
}
