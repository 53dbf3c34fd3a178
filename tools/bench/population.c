/* A genetic algorithm of 50 x 400 on one and two threads, with and without a result file, one after the other: what
 * storing costs, what a second thread is worth, and how busy both are. */
#include "bench.h"

#include <hifdm/store.h>

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define GENERATIONS 400
#define RESIDUAL_N 1e-8 /* of every individual */

enum { EVALUATE, BREED, STORE, N_PART };

/* The generations, as `hifdm run` does them: ask, batch, tell, store (NULL: without). Adds to the time spent in each;
 * returns the largest residual of all feasible individuals, N. */
static double evolve(const hf_model *m, hf_batch *batch, hf_store *store, hf_ga *ga, double spent_s[N_PART])
{
    hf_messages messages = {0};
    double worst_N = 0, t = bench_clock_s(), now;
    int more;
    do {
        hf_batch_run(batch, ga->n_individual, ga->design_N, ga->pending, ga->result);
        spent_s[EVALUATE] += (now = bench_clock_s()) - t, t = now;
        hf_ga_tell(ga);
        spent_s[BREED] += (now = bench_clock_s()) - t, t = now;
        if (store && hf_store_generation(store, m, ga, &messages) != HF_OK) bench_fail("store", messages.text);
        spent_s[STORE] += (now = bench_clock_s()) - t, t = now;
        for (int i = 0; i < ga->n_individual; i++)
            if (ga->result[i].status == HF_OK) worst_N = fmax(worst_N, ga->result[i].residual_N);
        t = bench_clock_s(); /* looking at residuals is nothing that a run does */
        more = hf_ga_next(ga);
        spent_s[BREED] += (now = bench_clock_s()) - t, t = now;
    } while (more);
    hf_messages_free(&messages);
    return worst_N;
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
    hf_ga ga;
    hf_store *store;
    double spent_s[N_PART], open_close_s;
} population;

static void open_store(population *p)
{
    hf_messages messages = {0};
    double start_s = bench_clock_s();
    if (p->path &&
        hf_store_create(p->path, 1, &p->scene->settings, &p->scene->scene, NULL, 0, NULL, &p->store, &messages))
        bench_fail(p->path, messages.text);
    p->open_close_s += bench_clock_s() - start_s;
    hf_messages_free(&messages);
}

static void close_store(population *p)
{
    hf_messages messages = {0};
    hf_summary summary = {.form = p->scene->found, .threads = p->batch.n_thread, .has_optimize = 1};
    double start_s = bench_clock_s();
    if (p->store && hf_store_finish(p->store, &summary, &messages) != HF_OK) bench_fail(p->path, messages.text);
    p->open_close_s += bench_clock_s() - start_s;
    hf_messages_free(&messages);
}

static void once(bench_scene *b, int threads, const char *path)
{
    population p = {.scene = b, .path = path};
    const char *name = b->name, *mode = path ? "stored" : "not stored";
    struct stat file = {0};
    if (hf_batch_create(&b->evaluator, threads, &p.batch) != HF_OK ||
        hf_ga_create(&b->settings.optimize, &b->model, b->base_N, &p.ga) != HF_OK)
        bench_fail(name, "out of memory");
    hf_batch_share(&p.batch, b->base_N);
    double written = written_bytes();
    open_store(&p);
    double worst_N = evolve(&b->model, &p.batch, p.store, &p.ga, p.spent_s);
    close_store(&p);
    written = written_bytes() - written;
    double evaluate_s = p.spent_s[EVALUATE];
    double wall_s = evaluate_s + p.spent_s[BREED] + p.spent_s[STORE] + p.open_close_s;
    bench_emit("population", name, mode, threads, "wall_s", wall_s);
    bench_emit("population", name, mode, threads, "evaluate_s", evaluate_s);
    bench_emit("population", name, mode, threads, "breed_s", p.spent_s[BREED]);
    bench_emit("population", name, mode, threads, "store_s", p.spent_s[STORE]);
    bench_emit("population", name, mode, threads, "open_close_s", p.open_close_s);
    bench_emit("population", name, mode, threads, "store_share", (p.spent_s[STORE] + p.open_close_s) / wall_s);
    bench_emit("population", name, mode, threads, "utilisation", p.batch.cpu_s / wall_s / threads);
    bench_emit("population", name, mode, threads, "waiting_share", 1 - p.batch.cpu_s / evaluate_s / threads);
    bench_emit("population", name, mode, threads, "evaluations", (double)p.ga.n_evaluation);
    bench_emit("population", name, mode, threads, "evaluations_per_s", (double)p.ga.n_evaluation / wall_s);
    bench_emit("population", name, mode, threads, "worst_residual_N", worst_N);
    if (path && stat(path, &file) == 0) {
        bench_emit("population", name, mode, threads, "file_MB", 1e-6 * (double)file.st_size);
        bench_emit("population", name, mode, threads, "written_MB", 1e-6 * written);
    }
    hf_ga_free(&p.ga);
    hf_batch_free(&p.batch);
}

void bench_population(const char *name, const char *folder)
{
    bench_scene b;
    char path[HF_PATH_SIZE];
    hf_store_quiet();
    bench_scene_named(name, folder, &b);
    b.settings.optimize.population = BENCH_POPULATION;
    b.settings.optimize.generations = b.settings.optimize.stagnation_generations = GENERATIONS;
    b.form.residual_tolerance = RESIDUAL_N / b.model.reference_N;
    b.evaluator.boundary_ratio_cap = b.settings.optimize.boundary_ratio_cap;
    snprintf(path, sizeof path, "%s/population.h5", folder);
    once(&b, 1, NULL);
    once(&b, 2, NULL);
    once(&b, 2, path);
    bench_scene_free(&b);
}
