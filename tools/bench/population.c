/* A genetic algorithm of 50 x 400 on one and two threads, with and without a result file, one after the other: what
 * storing costs, what a second thread is worth, and how busy both are. */
#include "bench.h"

#include "base/clock.h"
#include <hifdm/run.h>
#include <hifdm/store.h>

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define GENERATIONS 400
#define RESIDUAL_N 1e-8 /* of every individual */

/* A generation on its way into the store, as in `hifdm run`; and the largest residual of the feasible individuals. */
typedef struct {
    const hf_model *model;
    hf_store *store; /* NULL: none */
    hf_population ga;
    double worst_N, store_s, store_cpu_s;
} told;

static void keep(void *context)
{
    told *t = context;
    hf_messages messages = {0};
    hf_summary summary = {.stage[HF_STAGE_SEARCH].exists = true};
    double start_s = bench_clock_s(), cpu_s = hf_clock_thread_cpu_s();
    if (hf_store_generation(t->store, t->model, &t->ga, &messages) != HF_OK ||
        hf_store_publish(t->store, &summary, 0, &messages) != HF_OK)
        bench_fail("store", messages.text);
    t->store_s += bench_clock_s() - start_s;
    t->store_cpu_s += hf_clock_thread_cpu_s() - cpu_s;
    for (int i = 0; i < t->ga.n_individual; i++)
        if (t->ga.result[i].status == HF_OK) t->worst_N = fmax(t->worst_N, t->ga.result[i].residual_N);
}

/* Times of storing beside the search: *store_s of the wall, and into the processor time of the batch. */
static double evolve(const hf_model *m, hf_batch *batch, hf_store *store, hf_optimiser *ga, double *store_s)
{
    told now = {m, store, ga->population, 0, 0, 0};
    hf_batch_run(batch, ga->population.n_individual, ga->population.design, ga->population.pending,
                 ga->population.result);
    do {
        hf_optimiser_tell(ga);
        now.ga = ga->population;
    } while (hf_batch_next(batch, ga, keep, &now));
    *store_s = now.store_s;
    batch->cpu_s += now.store_cpu_s;
    return now.worst_N;
}

/* Bytes that this process has given to write(2) so far. */
static double written_bytes(void)
{
    double bytes = NAN;
    FILE *file = fopen("/proc/self/io", "r");
    if (file && fscanf(file, "rchar: %*s wchar: %lf", &bytes) != 1) bytes = NAN;
    if (file) fclose(file);
    return bytes;
}

typedef struct {
    bench_scene *scene;
    const char *path; /* of the result file; NULL = none is written */
    hf_batch batch;
    hf_optimiser ga;
    hf_store *store;
} population;

static void open_store(population *p)
{
    hf_messages messages = {0};
    if (p->path &&
        hf_store_create(p->path, 1, &p->scene->settings, &p->scene->scene, NULL, 0, NULL, &p->store, &messages))
        bench_fail(p->path, messages.text);
    hf_messages_free(&messages);
}

static void close_store(population *p)
{
    hf_messages messages = {0};
    hf_summary summary = {.threads = p->batch.n_thread,
                          .stage[HF_STAGE_FORM].result = p->scene->found,
                          .stage[HF_STAGE_SEARCH].exists = true};
    if (p->store && hf_store_finish(p->store, &summary, &messages) != HF_OK) bench_fail(p->path, messages.text);
    hf_messages_free(&messages);
}

static void once(bench_scene *b, int threads, const char *path)
{
    population p = {.scene = b, .path = path};
    const char *name = b->name, *mode = path ? "stored" : "not stored";
    struct stat file = {0};
    if (hf_batch_create(&b->evaluator, threads, &p.batch) != HF_OK ||
        hf_optimiser_create(&hf_optimiser_ga, &b->settings.optimize, &b->model, b->initial, &p.ga) != HF_OK)
        bench_fail(name, "out of memory");
    hf_batch_share(&p.batch, b->initial);
    double written = written_bytes(), start_s = bench_clock_s(), store_s;
    open_store(&p);
    double open_s = bench_clock_s();
    double worst_N = evolve(&b->model, &p.batch, p.store, &p.ga, &store_s);
    double close_s = bench_clock_s();
    close_store(&p);
    double end_s = bench_clock_s(), wall_s = end_s - start_s;
    store_s += open_s - start_s + end_s - close_s;
    written = written_bytes() - written;
    bench_emit("population", name, mode, threads, "wall_s", wall_s);
    bench_emit("population", name, mode, threads, "store_s", store_s);
    bench_emit("population", name, mode, threads, "store_share", store_s / wall_s);
    bench_emit("population", name, mode, threads, "utilisation", p.batch.cpu_s / wall_s / threads);
    bench_emit("population", name, mode, threads, "evaluations", (double)p.ga.population.n_evaluation);
    bench_emit("population", name, mode, threads, "evaluations_per_s", (double)p.ga.population.n_evaluation / wall_s);
    bench_emit("population", name, mode, threads, "worst_residual_N", worst_N);
    if (path && stat(path, &file) == 0) {
        bench_emit("population", name, mode, threads, "file_MB", 1e-6 * (double)file.st_size);
        bench_emit("population", name, mode, threads, "written_MB", 1e-6 * written);
    }
    hf_optimiser_free(&p.ga);
    hf_batch_free(&p.batch);
}

/* The least that storing can cost: writing as many bytes to a file and to the disk, and nothing else. */
static void write_bare(const char *name, const char *path, double bytes)
{
    static char piece[240000];
    double start_s = bench_clock_s();
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666), ok = file >= 0;
    for (double done = 0; ok && done < bytes; done += sizeof piece)
        ok = write(file, piece, sizeof piece) == sizeof piece;
    double written_s = bench_clock_s();
    if (!ok || fsync(file) != 0) bench_fail(path, "cannot write");
    bench_emit("population", name, "write(2) alone", 1, "wall_s", written_s - start_s);
    bench_emit("population", name, "write(2) and fsync alone", 1, "wall_s", bench_clock_s() - start_s);
    close(file);
    unlink(path);
}

void bench_population(const char *name, const char *folder)
{
    struct stat info = {0};
    bench_scene b;
    char path[HF_PATH_SIZE];
    hf_store_quiet();
    bench_scene_named(name, folder, &b);
    b.settings.optimize.population = BENCH_POPULATION;
    b.settings.optimize.generations = b.settings.optimize.stagnation_generations = GENERATIONS;
    b.form.residual_tolerance = RESIDUAL_N / b.model.reference_N;
    b.evaluator.boundary_ratio_cap = b.settings.optimize.boundary_ratio_cap;
    snprintf(path, sizeof path, "%s/population.h5", folder);
    for (int threads = 1; threads <= 2; threads++) {
        once(&b, threads, NULL);
        once(&b, threads, path);
        if (stat(path, &info) == 0) unlink(path);
    }
    write_bare(name, path, (double)info.st_size);
    bench_scene_free(&b);
}

/* All that `hifdm run` does once it has started, with and without a file. */
void bench_whole(const char *path, const char *folder)
{
    char output[HF_OUTPUT_SIZE], wanted[HF_PATH_SIZE];
    static hf_summary summary;
    snprintf(wanted, sizeof wanted, "%s/whole.h5", folder);
    hf_store_quiet();
    for (int stores = 0; stores < 2; stores++) {
        hf_messages messages = {0};
        hf_run_request request = {
            .input.case_path = path, .output = {.path = wanted, .no_file = !stores}, .control.threads = 2};
        double start_s = bench_clock_s();
        hf_status status = hf_run_case(&request, &summary, output, &messages);
        double wall_s = bench_clock_s() - start_s;
        if (status != HF_OK) bench_fail(path, messages.text);
        bench_emit("whole", path, stores ? "stored" : "not stored", 2, "wall_s", wall_s);
        hf_messages_free(&messages);
    }
    unlink(wanted);
}
