/* A file of finished points that lies in the folder of a sweep. In the input stand @F for the fingerprint of the study
 * and @0, @1, @2 for the ids of its points. What is read must make a whole table. */
#include "fuzz/fuzz.h"

#include "store/ledger.h"
#include "store/merge.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static hf_study study;
static char sweep[FUZZ_PATH_SIZE];

static void open_study(void)
{
    char path[FUZZ_PATH_SIZE];
    hf_messages messages = {0};
    fuzz_path("study.yaml", path);
    fuzz_path("", sweep);
    fuzz_write_text("study.yaml", "scene: {parabolic_cylinder: {aperture_m: 2, length_m: 2, focal_length_m: 3, "
                                  "modules: [1, 1], cells_per_module: [2, 2], scallop: 0.1}}\n"
                                  "sweep:\n  form.pretension_N: [8, 10, 12]\n");
    FUZZ_REQUIRE(hf_study_read(path, &study, &messages) == HF_OK && study.n_point == 3);
}

/* The input with its marks replaced; the caller frees it. */
static char *expand(const uint8_t *data, size_t size, size_t *length)
{
    char *text = malloc(size * HF_STUDY_FINGERPRINT_SIZE + 1);
    FUZZ_REQUIRE(text != NULL);
    *length = 0;
    for (size_t i = 0; i < size; i++) {
        int mark = data[i] == '@' && i + 1 < size ? data[i + 1] : 0;
        const char *means = mark == 'F' ? study.fingerprint : mark >= '0' && mark <= '2' ? study.id[mark - '0'] : NULL;
        if (means) {
            memcpy(text + *length, means, strlen(means));
            *length += strlen(means);
            i++;
        } else {
            text[(*length)++] = (char)data[i];
        }
    }
    return text;
}

static void look_at(const hf_points *points)
{
    int n = 0;
    size_t sum = 0;
    for (int k = 0; k < HF_N_POINT_STATE; k++)
        n += points->count[k];
    FUZZ_REQUIRE(n == study.n_point);
    for (int i = 0; i < points->n_point; i++) {
        const hf_point *p = &points->point[i];
        bool is_finished = p->state == HF_POINT_DONE || p->state == HF_POINT_FAILED;
        FUZZ_REQUIRE(is_finished == (p->field != NULL));
        FUZZ_REQUIRE(is_finished || p->status == HF_NOT_EVALUATED);
        sum += strlen(p->reason);
        for (int c = 0; is_finished && c < hf_ledger_n_column(); c++)
            sum += strlen(p->field[c]);
    }
    FUZZ_REQUIRE(sum < 1u << 24);
}

/* The table of all points, as `hifdm merge` writes it. */
static hf_status merge(const hf_points *points, hf_messages *messages)
{
    char path[FUZZ_PATH_SIZE];
    fuzz_path("merged.h5", path);
    return hf_merge(&study, sweep, points, path, true, messages);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (!study.n_point) open_study();
    size_t length;
    char *text = expand(data, size, &length);
    hf_messages messages = {0};
    hf_points points;
    hf_ledger ledger;
    /* the first half is there when another process begins to watch, the rest comes later */
    fuzz_write("points-fuzz-1.tsv", text, length / 2);
    hf_status status = hf_ledger_open(sweep, &ledger, &messages);
    if (status == HF_OK) status = hf_ledger_watch(&ledger, &study, &messages);
    fuzz_write("points-fuzz-1.tsv", text, length);
    for (int i = 0; status == HF_OK && i < study.n_point; i++)
        hf_ledger_is_finished(&ledger, i);
    hf_status closed = hf_ledger_close(&ledger, &messages);
    FUZZ_REQUIRE(status == HF_OK && closed == HF_OK);
    status = hf_ledger_read(sweep, &study, &points, &messages);
    if (status == HF_OK) look_at(&points);
    /* one input of 16, because HDF5 takes longer than all the rest */
    if (status == HF_OK && length % 16 == 0) status = merge(&points, &messages);
    hf_points_free(&points);
    fuzz_judge(status, &messages);
    free(text);
    return 0;
}
