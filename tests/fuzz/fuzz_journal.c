/* The journal of a run. The first byte of the input says how the rest is meant: bit 0: edits to the journal of a real
 * run, each two bytes of offset, one of length and that many bytes, else the journal itself; bit 1: the check sums are
 * put right afterwards, so that damage reaches what lies behind them; bit 2: the end is cut off as well, at an offset
 * given by two bytes; bits 3 to 7: the remainder by 3 says which generations have rows of individuals. The records are
 * taken as a store takes them, into an optimiser that breeds the designs again. */
#include "fuzz/fuzz.h"
#include "small_ga.h"

#include "store/generations.h"
#include "store/journal.h"

#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { N_GENERATION = 4, N_INDIVIDUAL = 3, N_VARIABLE = 2, HEADER_BYTES = 8 + HF_JOURNAL_IDENTITY, HEAD_BYTES = 16 };

static int variable[N_VARIABLE], leader[N_VARIABLE] = {0, 1};
static double initial[N_VARIABLE] = {10, 12};
static const hf_model model = {.n_variable = N_VARIABLE,
                               .n_variable_group = 1,
                               .variable_cable = variable,
                               .variable_group = variable,
                               .variable_leader = leader,
                               .n_leader = N_VARIABLE};

/* Values of hf_generations.every, and the one of this input. */
static const int every[] = {1, 2, HF_GENERATIONS_BEST};
enum { N_EVERY = sizeof every / sizeof *every };
static int kind;

typedef struct {
    hf_optimize_settings settings; /* of the optimiser, which borrows them */
    hf_optimiser optimiser;
    hf_generations rows;
    int n_taken;
} run;

static void open_run(run *r)
{
    *r = (run){.settings = small_ga(N_INDIVIDUAL, N_GENERATION + 2)};
    FUZZ_REQUIRE(hf_optimiser_create(&hf_optimiser_ga, &r->settings, &model, initial, &r->optimiser) == HF_OK);
    r->rows = (hf_generations){
        .n_individual = N_INDIVIDUAL, .n_variable = N_VARIABLE, .limit = r->settings.generations, .every = every[kind]};
    FUZZ_REQUIRE(hf_generations_create(&r->rows) == HF_OK);
}

static void close_run(run *r)
{
    hf_optimiser_free(&r->optimiser);
    hf_generations_free(&r->rows);
}

static hf_journal open_journal(int file)
{
    return (hf_journal){.file = file, .result = "run.h5", .path = "run.h5.journal"};
}

/* ---- a real journal ---- */

static uint8_t *real[N_EVERY];
static size_t real_size[N_EVERY];

static void make_real(int file)
{
    run r;
    hf_messages messages = {0};
    hf_journal journal = open_journal(file);
    struct iovec piece[HF_GENERATIONS_PAYLOAD];
    open_run(&r);
    FUZZ_REQUIRE(hf_journal_restart(&journal, "fuzz", &messages) == HF_OK);
    for (int g = 0; g < N_GENERATION; g++) {
        hf_population *p = &r.optimiser.population;
        if (g > 0) FUZZ_REQUIRE(hf_optimiser_next(&r.optimiser));
        for (int i = 0; i < N_INDIVIDUAL; i++)
            p->result[i] = (hf_form_result){.status = HF_OK,
                                            .psi_m = fabs(p->design[i * N_VARIABLE] - 10),
                                            .merit = fabs(p->design[i * N_VARIABLE] - 10),
                                            .iterations = g};
        hf_optimiser_tell(&r.optimiser);
        p->is_moved = g % 2 == 1; /* such a record has designs, too */
        hf_generations_add(&r.rows, p, piece);
        FUZZ_REQUIRE(hf_journal_append(&journal, g, piece, HF_GENERATIONS_PAYLOAD, &messages) == HF_OK);
    }
    close_run(&r);
    real_size[kind] = (size_t)journal.size;
    real[kind] = malloc(real_size[kind]);
    FUZZ_REQUIRE(real[kind] && pread(file, real[kind], real_size[kind], 0) == (ssize_t)real_size[kind]);
}

/* ---- damage ---- */

static void repair(uint8_t *journal, size_t size)
{
    for (size_t at = HEADER_BYTES; at + HEAD_BYTES <= size;) {
        uint32_t length, crc;
        memcpy(&length, journal + at + 4, sizeof length);
        if (length < 4 || length > size - at - 12) return;
        crc = (uint32_t)crc32(0, journal + at + 12, length);
        memcpy(journal + at + 8, &crc, sizeof crc);
        at += 12 + length;
    }
}

/* The journal that the input means, into the file. */
static void write_journal(int file, const uint8_t *data, size_t size)
{
    int how = size ? data[0] : 0;
    size_t at = size > 0, n = how & 1 ? real_size[kind] : size - at;
    uint8_t *journal = malloc(n + 1);
    FUZZ_REQUIRE(journal != NULL);
    memcpy(journal, how & 1 ? real[kind] : data + at, n);
    if ((how & 4) && (how & 1) && at + 2 <= size) {
        n = (data[at] + 256u * data[at + 1]) % (n + 1);
        at += 2;
    }
    for (; (how & 1) && n && at + 3 <= size;) {
        size_t offset = (data[at] + 256u * data[at + 1]) % n, length = data[at + 2];
        at += 3;
        for (size_t k = 0; k < length && at < size; k++, at++)
            if (offset + k < n) journal[offset + k] = data[at];
    }
    if (how & 2) repair(journal, n);
    FUZZ_REQUIRE(ftruncate(file, 0) == 0 && pwrite(file, journal, n, 0) == (ssize_t)n);
    free(journal);
}

/* ---- replay ---- */

/* As a store does: a generation counts that follows the last one and belongs to the designs that are bred again. */
static hf_status take(void *context, int generation, const void *payload, size_t bytes)
{
    run *r = context;
    hf_optimiser *o = &r->optimiser;
    if (generation != r->n_taken || !hf_generations_are_payload(&r->rows, payload, bytes) ||
        generation >= r->rows.limit)
        return HF_DIFFERENT;
    if (generation > 0) {
        hf_optimiser_tell(o);
        if (!hf_optimiser_next(o)) return HF_DIFFERENT;
    }
    const hf_population *before = generation > 0 ? &o->next : NULL;
    if (!hf_generations_take_payload(&r->rows, payload, before, &o->population) ||
        !hf_generations_are_sound(&o->population))
        return HF_DIFFERENT;
    o->is_fresh = false;
    hf_generations_add(&r->rows, &o->population, NULL);
    r->n_taken++;
    return HF_OK;
}

/* Returns how many generations were taken, and how many bytes count. */
static int replay(int file, int64_t *bytes)
{
    run r;
    hf_messages messages = {0};
    hf_journal journal = open_journal(file);
    struct stat info;
    open_run(&r);
    hf_status status = hf_journal_replay(&journal, "fuzz", take, &r, &messages);
    if (status == HF_OK) FUZZ_REQUIRE(fstat(file, &info) == 0 && info.st_size == journal.size);
    *bytes = journal.size;
    close_run(&r);
    fuzz_judge(status, &messages);
    return r.n_taken;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int file = -1;
    int64_t bytes, again;
    if (file < 0) {
        char path[FUZZ_PATH_SIZE];
        fuzz_path("journal", path);
        file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
        FUZZ_REQUIRE(file >= 0);
        for (kind = 0; kind < N_EVERY; kind++)
            make_real(file);
    }
    kind = size ? (data[0] >> 3) % N_EVERY : 0;
    write_journal(file, data, size);
    int n = replay(file, &bytes);
    /* what was cut off stays away, and what was whole stays */
    FUZZ_REQUIRE(replay(file, &again) == n && again == bytes);
    return 0;
}
