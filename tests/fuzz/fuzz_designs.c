/* A table of designs, given to `hifdm evaluate` as the program itself calls it. */
#include "fuzz/fuzz.h"

#include "app/cmd.h"
#include "app/options.h"

static const char case_text[] = "scene: {parabolic_cylinder: {aperture_m: 2, length_m: 2, focal_length_m: 3,\n"
                                "  modules: [1, 1], cells_per_module: [2, 2], scallop: 0.1}}\n"
                                "form: {pretension_N: 10}\n";

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char path[FUZZ_PATH_SIZE], table[FUZZ_PATH_SIZE];
    static FILE *nowhere;
    if (!nowhere) {
        fuzz_keeps_case = true;
        fuzz_path("case.yaml", path);
        fuzz_path("d.csv", table);
        fuzz_write_text("case.yaml", case_text);
        nowhere = fopen("/dev/null", "w");
        FUZZ_REQUIRE(nowhere != NULL);
    }
    hf_messages messages = {0};
    hf_options options = {.command = &hf_cmd_evaluate, .file = path, .designs = table, .threads = 1};
    fuzz_write("d.csv", data, size);
    hf_status status = hf_cmd_evaluate.run(&options, nowhere, &messages);
    fuzz_judge(status, &messages);
    return 0;
}
