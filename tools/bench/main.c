/* Contents: small things - arguments */
#include "bench.h"

#include "band.h"
#include <hifdm/store.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- small things ---- */

double bench_clock_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
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
    if (hf_band_solve(m->n_free, m->half_bandwidth, w->band, w->position_m, m->n_node, &bad_row) != HF_OK)
        bench_fail("step", "singular");
    bench_measure(m, form, w);
}

/* ---- arguments ---- */

static void about(void)
{
    printf("hifdm %s\nlapack %s\ncholmod %s\n", hf_store_version(), hf_band_library(), bench_cholmod_version());
}

int main(int argc, char **argv)
{
    const char *section = argc > 1 ? argv[1] : "", *folder = argc > 2 ? argv[2] : ".", *what = argc > 3 ? argv[3] : "";
    hf_band_single_threaded();
    if (!strcmp(section, "about"))
        about();
    else if (!strcmp(section, "precision"))
        bench_precision(what, folder);
    else if (!strcmp(section, "single"))
        bench_single(what, folder);
    else if (!strcmp(section, "step"))
        bench_step(folder);
    else if (!strcmp(section, "peak"))
        bench_peak();
    else if (!strcmp(section, "growth"))
        bench_growth(atoi(what));
    else if (!strcmp(section, "phases"))
        bench_phases(what, folder);
    else if (!strcmp(section, "population"))
        bench_population(what, folder, argc > 4 ? atoi(argv[4]) : 1);
    else
        bench_fail("usage", "bench about|precision|single|step|peak|growth|phases|population FOLDER [WHAT] [THREADS]");
    return 0;
}
