/* What storing costs: the loop of `hifdm run` (ask, batch, tell, store) with the time inside each of its calls, once
 * with and once without a result file. */
#include "bench.h"

#include <hifdm/store.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define GENERATIONS 400
#define RESIDUAL_N 1e-8 /* of every individual */

enum { EVALUATE, BREED, STORE, N_PART };
static const char *const part_word[N_PART] = {"evaluate_s", "breed_s", "store_s"};

static void evolve(bench_scene *b, hf_batch *batch, hf_store *store, double spent_s[N_PART])
{
    hf_ga ga;
    hf_messages messages = {0};
    if (hf_ga_create(&b->settings.optimize, &b->model, b->base_N, &ga) != HF_OK) bench_fail(b->name, "out of memory");
    int more;
    double worst_N = 0;
    double t = bench_clock_s(), now;
    do {
        hf_batch_run(batch, ga.n_individual, ga.design_N, ga.pending, ga.result);
        spent_s[EVALUATE] += (now = bench_clock_s()) - t, t = now;
        for (int i = 0; i < ga.n_individual; i++)
            if (ga.result[i].status == HF_OK) worst_N = fmax(worst_N, ga.result[i].residual_N);
        hf_ga_tell(&ga);
        spent_s[BREED] += (now = bench_clock_s()) - t, t = now;
        if (store && hf_store_generation(store, &b->model, &ga, &messages) != HF_OK) bench_fail("store", messages.text);
        spent_s[STORE] += (now = bench_clock_s()) - t, t = now;
        more = hf_ga_next(&ga);
        spent_s[BREED] += (now = bench_clock_s()) - t, t = now;
    } while (more);
    bench_emit("storing", b->name, store ? "stored" : "not stored", batch->n_thread, "evaluations",
               (double)ga.n_evaluation);
    bench_emit("storing", b->name, store ? "stored" : "not stored", batch->n_thread, "worst_residual_N", worst_N);
    hf_ga_free(&ga);
    hf_messages_free(&messages);
}

static void once(bench_scene *b, hf_batch *batch, const char *folder, int with_store)
{
    double spent_s[N_PART] = {0};
    hf_messages messages = {0};
    hf_store *store = NULL;
    char path[HF_PATH_SIZE];
    snprintf(path, sizeof path, "%s/storing.h5", folder);
    if (with_store && hf_store_create(path, 1, &b->settings, &b->scene, 0, NULL, &store, &messages) != HF_OK)
        bench_fail(path, messages.text);
    double start_s = bench_clock_s();
    evolve(b, batch, store, spent_s);
    const char *word = with_store ? "stored" : "not stored";
    bench_emit("storing", b->name, word, batch->n_thread, "wall_s", bench_clock_s() - start_s);
    for (int i = 0; i < N_PART; i++)
        bench_emit("storing", b->name, word, batch->n_thread, part_word[i], spent_s[i]);
    hf_store_abandon(store);
    hf_messages_free(&messages);
}

void bench_population(const char *name, const char *folder, int threads)
{
    bench_scene b;
    hf_batch batch;
    hf_store_quiet();
    bench_scene_named(name, folder, &b);
    b.settings.optimize.population = BENCH_POPULATION;
    b.settings.optimize.generations = b.settings.optimize.stagnation_generations = GENERATIONS;
    b.form.residual_tolerance = RESIDUAL_N / b.model.reference_N;
    b.evaluator.boundary_ratio_cap = b.settings.optimize.boundary_ratio_cap;
    if (hf_batch_create(&b.evaluator, threads, &batch) != HF_OK) bench_fail(name, "out of memory");
    hf_batch_share(&batch, b.base_N);
    for (int with_store = 0; with_store < 2; with_store++)
        once(&b, &batch, folder, with_store);
    hf_batch_free(&batch);
    bench_scene_free(&b);
}
