/* Populations of designs in lanes, on single nets and on nets of two layers that are tied to each other: processor time
 * of one iteration of one design per degree of freedom, and the speed of the arithmetic of its band, since a tied net
 * has a wider one. */
#include "bench.h"

#include "base/clock.h"

#define ENOUGH_S 0.2
#define RESIDUAL_N 1e-8

static void run_lanes(bench_scene *b, hf_solver solver)
{
    hf_batch batch;
    hf_form_result result[BENCH_POPULATION];
    bool has_lanes;
    int n = 0;
    b->evaluator.solver = solver;
    solver = hf_batch_solver(&b->evaluator, &has_lanes);
    if (!has_lanes) bench_fail(b->name, "has no lanes");
    if (hf_batch_create(&b->evaluator, 1, &batch) != HF_OK || hf_batch_share(&batch, b->initial) != solver)
        bench_fail(b->name, "out of memory");
    double begin_s = hf_clock_thread_cpu_s(), taken_s = 0, iterations = 0;
    for (; taken_s < ENOUGH_S; taken_s = hf_clock_thread_cpu_s() - begin_s, n++)
        hf_batch_run(&batch, BENCH_POPULATION, b->design, NULL, result);
    for (int i = 0; i < BENCH_POPULATION; i++) {
        if (result[i].status != HF_OK) bench_fail(b->name, hf_status_text(result[i].status));
        iterations += result[i].iterations;
    }
    hf_batch_free(&batch);
    bool is_shared = solver == HF_SOLVER_CHORD;
    double free = b->model.n_free, width = b->model.half_bandwidth, wide = 3 * width + 2;
    /* two triangles of the Newton matrix; or a factor of the band of the force densities and three right-hand sides */
    double flops = is_shared ? 4 * 3 * free * wide : free * width * width + 3 * 4 * free * width;
    double iteration_s = taken_s / n / iterations;
    const char *method = is_shared ? "shared matrix" : "matrix per design";
    bench_emit("lanes", b->name, method, 3 * free, "half_bandwidth", is_shared ? wide : width);
    bench_emit("lanes", b->name, method, 3 * free, "iterations", iterations / BENCH_POPULATION);
    bench_emit("lanes", b->name, method, 3 * free, "design_s", taken_s / n / BENCH_POPULATION);
    bench_emit("lanes", b->name, method, 3 * free, "iteration_dof_s", iteration_s / (3 * free));
    bench_emit("lanes", b->name, method, 3 * free, "band_GFs", 1e-9 * flops / iteration_s);
}

void bench_lanes(const char *name, const char *folder)
{
    bench_scene b;
    bench_scene_named(name, folder, &b);
    b.form.residual_tolerance = RESIDUAL_N / b.model.reference_N;
    run_lanes(&b, HF_SOLVER_AUTO);
    if (b.model.has_newton) run_lanes(&b, HF_SOLVER_FIXED_POINT);
    bench_scene_free(&b);
}
