/* A study file with its base case, and the points that it spans. */
#include "fuzz/fuzz.h"

#include "case/study.h"

static void look_at_points(const hf_study *study)
{
    static const size_t sizes[] = {1, 5, 24, 4096};
    for (int i = 0; i < study->n_point; i++) {
        hf_study_overrides overrides;
        char text[4096];
        hf_study_point_overrides(study, i, &overrides);
        FUZZ_REQUIRE(overrides.n_set >= study->n_axis);
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
            hf_study_point_text(study, i, text, sizes[k]);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char path[FUZZ_PATH_SIZE];
    if (!*path) {
        fuzz_path("study.yaml", path);
        fuzz_write_text("base.yaml", "scene: {parabolic_cylinder: {aperture_m: 2, length_m: 2, focal_length_m: 3, "
                                     "modules: [2, 2], cells_per_module: [2, 2]}}\n"
                                     "optimize: {range_N: 2, population: 4, generations: 2}\n");
    }
    hf_study study;
    hf_messages messages = {0};
    fuzz_write("study.yaml", data, size);
    hf_status status = hf_study_read(path, &study, &messages);
    if (status == HF_OK) look_at_points(&study);
    hf_study_free(&study);
    fuzz_judge(status, &messages);
    return 0;
}
