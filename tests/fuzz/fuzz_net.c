/* The tables of a net: nodes, a line "%%", cables. A net that was accepted is also solved for a few iterations. */
#include "fuzz/fuzz.h"
#include "valid.h"

#include "run/diagnose.h"
#include "run/problem_parts.h"
#include <hifdm/evaluate.h>

#include <math.h>

/* Without one psi has nothing to measure. */
static bool has_taut_inner_node(const hf_problem *p)
{
    for (int k = 0; k < p->model.n_inner_node; k++)
        if (!p->workspace.loose[p->model.inner_row[k]]) return true;
    return false;
}

static void solve(hf_problem *p, hf_messages *messages, hf_status *status)
{
    FUZZ_REQUIRE(model_is_valid(&p->model));
    *status = hf_problem_allocate(p, messages);
    if (*status != HF_OK) return;
    hf_evaluate_form(&p->model, &p->settings.form, &p->workspace, NULL, &p->form);
    FUZZ_REQUIRE(p->form.status != HF_OK || isfinite(p->form.psi_m) || !has_taut_inner_node(p));
    *status = hf_problem_explain(p, messages);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char path[FUZZ_PATH_SIZE];
    if (!*path) {
        fuzz_keeps_case = true;
        fuzz_path("case.yaml", path);
        fuzz_write_text("case.yaml", "scene: {import: {nodes: n.csv, cables: c.csv}}\n"
                                     "form: {pretension_N: 10, max_iterations: 30}\n"
                                     "optimize: {range_N: 2, symmetry: auto}\n");
    }
    hf_problem p;
    hf_messages messages = {0};
    size_t n_byte, second = fuzz_split(data, size, &n_byte);
    fuzz_write("n.csv", data, n_byte);
    fuzz_write("c.csv", data + second, size - second);
    hf_status status = hf_problem_load(path, NULL, NULL, 0, NULL, &p, &messages);
    if (status == HF_OK) solve(&p, &messages, &status);
    hf_problem_free(&p);
    fuzz_judge(status, &messages);
    return 0;
}
