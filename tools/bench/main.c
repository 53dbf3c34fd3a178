/* Contents: small things - arguments */
#include "bench.h"

#include "base/clock.h"
#include "linalg/band.h"
#include "linalg/lapack.h"
#include <hifdm/store.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- small things ---- */

double bench_clock_s(void)
{
    return hf_clock_s();
}

void bench_fail(const char *what, const char *why)
{
    fprintf(stderr, "bench: %s: %s\n", what, why ? why : "failed");
    exit(1);
}

void *bench_alloc(size_t count, size_t item_bytes)
{
    void *block = calloc(count ? count : 1, item_bytes);
    if (!block) bench_fail("memory", "there is not enough");
    return block;
}

void bench_emit(const char *section, const char *scene, const char *method, double parameter, const char *quantity,
                double value)
{
    printf("%s\t%s\t%s\t%.9g\t%s\t%.9g\n", section, scene, method, parameter, quantity, value);
    fflush(stdout);
}

double bench_time_s(void (*work)(void *context), void *context, double enough_s)
{
    double start_s = bench_clock_s(), passed_s;
    long n = 0;
    do {
        work(context);
        n++;
        passed_s = bench_clock_s() - start_s;
    } while (passed_s < enough_s);
    return passed_s / (double)n;
}

void bench_measure(const hf_model *m, const hf_form_settings *form, hf_workspace *w)
{
    hf_form_result r = {.status = HF_OK};
    double length_gap;
    hf_form_measure_cables(m, form, w, &r, &length_gap);
    if (r.status != HF_OK) bench_fail("step", hf_status_text(r.status));
}

void bench_fdm_step(const hf_model *m, const hf_form_settings *form, hf_workspace *w)
{
    int bad_row;
    hf_form_assemble(m, w);
    hf_form_assemble_loads(m, w);
    if (hf_band_solve(false, m->n_free, m->half_bandwidth, w->band, w->position_m, m->n_node, &bad_row) != HF_OK)
        bench_fail("step", "singular");
    bench_measure(m, form, w);
}

/* ---- arguments ---- */

static void about(void)
{
    printf("hifdm %s\nlapack %s\ncholmod %s\n", hf_store_version(), hf_lapack_library(), bench_cholmod_version());
}

/* Called as: bench NAME FOLDER WHAT [more]; what: a scene, a size. */
typedef struct {
    const char *name;
    void (*run)(const char *what, const char *folder);
} section;

static const section section_table[] = {{"step", bench_step},      {"peak", bench_peak},
                                        {"phases", bench_phases},  {"precision", bench_precision},
                                        {"single", bench_single},  {"equilibrium", bench_equilibrium},
                                        {"growth", bench_growth},  {"population", bench_population},
                                        {"whole", bench_whole},    {"frame", bench_frame},
                                        {"lanes", bench_lanes},    {"cases", bench_cases},
                                        {"built", bench_built},    {"pattern", bench_pattern},
                                        {"antenna", bench_antenna}};

int main(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "", *folder = argc > 2 ? argv[2] : ".", *what = argc > 3 ? argv[3] : "";
    if (hf_lapack_load(NULL) != HF_OK) bench_fail("LAPACK", "cannot be loaded");
    if (!strcmp(name, "about")) {
        about();
        return 0;
    }
    if (!strcmp(name, "stages") && argc > 4) { /* WHAT, a case file and overrides of its keys */
        bench_stages(what, folder, argv[4], (const char *const *)(argv + 5), argc - 5);
        return 0;
    }
    for (size_t i = 0; i < sizeof section_table / sizeof *section_table; i++) {
        if (strcmp(name, section_table[i].name)) continue;
        section_table[i].run(what, folder);
        return 0;
    }
    bench_fail("usage", "bench about | SECTION FOLDER [WHAT]; the sections are in tools/bench/main.c");
    return 1;
}
