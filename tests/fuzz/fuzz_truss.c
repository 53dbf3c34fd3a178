/* The tables of a truss: nodes, a line "%%", members. It carries a net of three cables; what was accepted is condensed
 * and solved with the net for a few iterations. */
#include "fuzz/fuzz.h"

#include "run/diagnose.h"
#include "run/problem_parts.h"
#include <hifdm/evaluate.h>

static void write_net(void)
{
    fuzz_write_text("case.yaml", "scene: {import: {nodes: n.csv, cables: c.csv}}\n"
                                 "form: {pretension_N: 10, max_iterations: 20}\n"
                                 "truss: {import: {nodes: t.csv, members: m.csv}, match_tolerance_m: 0.01}\n");
    fuzz_write_text("n.csv",
                    "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,0,support\nc,0,1,0,support\nd,0.3,0.3,0,inner\n");
    fuzz_write_text("c.csv", "id,i,j,group,law,value\nad,a,d,inner,tension,\nbd,b,d,inner,tension,\n"
                             "cd,c,d,boundary,length,\n");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char path[FUZZ_PATH_SIZE];
    if (!*path) {
        fuzz_keeps_case = true;
        fuzz_path("case.yaml", path);
        write_net();
    }
    hf_problem p;
    hf_messages messages = {0};
    size_t n_byte, second = fuzz_split(data, size, &n_byte);
    fuzz_write("t.csv", data, n_byte);
    fuzz_write("m.csv", data + second, size - second);
    hf_status status = hf_problem_load(path, NULL, NULL, 0, NULL, &p, &messages);
    if (status == HF_OK) status = hf_problem_allocate(&p, &messages);
    if (status == HF_OK) {
        hf_evaluate_form(&p.model, &p.settings.form, &p.workspace, NULL, &p.form);
        status = hf_problem_explain(&p, &messages);
    }
    hf_problem_free(&p);
    fuzz_judge(status, &messages);
    return 0;
}
