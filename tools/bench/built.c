/* Very many samples of the net as built (METHOD section 12): 21x25 nodes, 10 N, EA of 1e5 and 2e5 N, errors of cut
 * lengths of normal distribution. Samples per second, the time of one by tolerance against its true error, and the same
 * by hf_built_solve; the net and its samples are written for peers.py. */
#include "bench.h"

#include "base/clock.h"
#include <hifdm/built_batch.h>
#include <hifdm/problem.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define SCENE "21x25 f=7.2 as built"
#define ENOUGH_S 0.3
#define TOLERANCE 1e-8 /* of the samples that are counted */
#define TIGHTEST 1e-11 /* of the reference, with lengths within as much */
#define N_SAMPLE 64    /* different ones */
#define N_REPEAT 20    /* how often they are in one run of the batch, where they are quick */
#define QUICK_MM 0.05
#define N_TRUE 24 /* whose true error is measured */

typedef struct {
    hf_problem problem;
    hf_built built;
    hf_workspace work;
    double sigma_mm;
    double *error_m; /* [N_SAMPLE][n_cable] of cut lengths */
    double *true_m;  /* [N_TRUE][3][n_node] */
    double *found_m; /* the same, as taken; NULL: not wanted */
    int *n_slack, *n_loose, *n_step, *failed;
    double *residual_N; /* [N_SAMPLE] each */
} built_bench;

static double normal(unsigned *state) /* mean 0, variance 1; the same on every machine */
{
    double sum = 0;
    for (int i = 0; i < 12; i++) {
        *state = *state * 1664525u + 1013904223u;
        sum += (double)(*state >> 8) / 16777216.0;
    }
    return sum - 6;
}

static void open_built(const char *sigma, built_bench *b)
{
    static const char *const set[] = {"form.residual_tolerance=1e-11", "form.length_tolerance=1e-11",
                                      "scene.EA_inner_N=1e5", "scene.EA_boundary_N=2e5"};
    hf_messages messages = {0};
    unsigned state = 12;
    *b = (built_bench){.sigma_mm = atof(sigma)};
    hf_problem *p = &b->problem;
    if (hf_problem_open("configs/reflector.yaml", set, 4, 1, p, &messages) != HF_OK ||
        hf_built_make("configs/reflector.yaml", &p->scene, &p->model, &p->settings.form, &p->workspace, &b->built,
                      &messages) != HF_OK ||
        hf_workspace_create(&b->built.model, &b->work) != HF_OK)
        bench_fail(SCENE, messages.text);
    size_t n = (size_t)p->model.n_cable, places = 3 * (size_t)p->model.n_node;
    b->error_m = bench_alloc(N_SAMPLE * n, sizeof(double));
    b->true_m = bench_alloc(N_TRUE * places, sizeof(double));
    b->n_slack = bench_alloc(N_SAMPLE, sizeof(int));
    b->n_loose = bench_alloc(N_SAMPLE, sizeof(int));
    b->n_step = bench_alloc(N_SAMPLE, sizeof(int));
    b->failed = bench_alloc(N_SAMPLE, sizeof(int));
    b->residual_N = bench_alloc(N_SAMPLE, sizeof(double));
    for (size_t i = 0; i < N_SAMPLE * n; i++)
        b->error_m[i] = 1e-3 * b->sigma_mm * normal(&state);
    hf_messages_free(&messages);
}

static void close_built(built_bench *b)
{
    free(b->error_m);
    free(b->true_m);
    free(b->n_slack);
    free(b->n_loose);
    free(b->n_step);
    free(b->failed);
    free(b->residual_N);
    hf_workspace_free(&b->work);
    hf_built_free(&b->built);
    hf_problem_free(&b->problem);
}

static void make(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m, double *load_N)
{
    const built_bench *b = context;
    int n = b->built.model.n_cable;
    (void)EA_N, (void)support_displacement_m, (void)load_N;
    for (int e = 0; e < n; e++)
        cut_m[e] += b->error_m[i % N_SAMPLE * n + e];
}

static void take(void *context, long i, const hf_built_shape *shape, const hf_form_result *r)
{
    const built_bench *b = context;
    size_t places = 3 * (size_t)b->built.model.n_node;
    if (i >= N_SAMPLE) return;
    b->failed[i] = r->status != HF_OK;
    b->n_slack[i] = r->n_slack;
    b->n_loose[i] = r->n_loose;
    b->n_step[i] = r->iterations;
    b->residual_N[i] = r->n_loose ? 0 : r->residual_N; /* that of a place is the business of its tolerance */
    if (b->found_m && i < N_TRUE) memcpy(b->found_m + (size_t)i * places, shape->position_m, places * sizeof(double));
}

/* One sample by hf_built_solve. */
static void solve(built_bench *b, long i)
{
    size_t n = (size_t)b->built.model.n_cable;
    double *cut_m = bench_alloc(n, sizeof *cut_m);
    hf_form_result r;
    memcpy(cut_m, b->built.model.target, n * sizeof *cut_m);
    make(b, i, cut_m, NULL, NULL, NULL);
    hf_built_solve(&b->built, &(hf_built_net){.cut_m = cut_m}, &b->work, &r);
    hf_built_shape shape = {b->work.position_m, b->work.tension_N, b->work.loose, b->work.displacement_m};
    take(b, i, &shape, &r);
    free(cut_m);
}

static double largest_error_m(const built_bench *b, const double *found_m)
{
    double error_m = 0;
    for (int i = 0; i < N_TRUE; i++) {
        ptrdiff_t at = (ptrdiff_t)i * 3 * b->built.model.n_node;
        error_m = fmax(error_m, bench_distance_m(&b->built.model, found_m + at, b->true_m + at));
    }
    return error_m;
}

static double mean(const int *count)
{
    double sum = 0;
    for (int i = 0; i < N_SAMPLE; i++)
        sum += count[i];
    return sum / N_SAMPLE;
}

/* Time of one sample, wall and processor, in runs over all of them until ENOUGH_S have passed. */
static void time_batch(built_bench *b, int n_thread, double *wall_s, double *cpu_s)
{
    hf_built_batch *batch;
    if (hf_built_batch_create(&b->built, n_thread, &batch) != HF_OK) bench_fail(SCENE, "memory");
    hf_built_batch_run(batch, 0, 0, N_SAMPLE, make, take, b); /* makes the rooms, and keeps the figures */
    long n = 0, n_run = b->sigma_mm < QUICK_MM ? N_REPEAT * N_SAMPLE : N_SAMPLE;
    double start_s = bench_clock_s(), passed_s;
    clock_t start_cpu = clock();
    do {
        hf_built_batch_run(batch, 0, N_SAMPLE, n_run, make, take, b);
        n += n_run;
        passed_s = bench_clock_s() - start_s;
    } while (passed_s < ENOUGH_S);
    *wall_s = passed_s / (double)n;
    *cpu_s = (double)(clock() - start_cpu) / CLOCKS_PER_SEC / (double)n;
    hf_built_batch_free(batch);
}

static void find_true(built_bench *b)
{
    b->built.form.residual_tolerance = b->built.form.length_tolerance = TIGHTEST;
    b->found_m = b->true_m;
    for (int i = 0; i < N_TRUE; i++)
        solve(b, i);
}

static void count_samples(built_bench *b)
{
    double wall_s, cpu_s, worst_N = 0;
    for (int n_thread = 1; n_thread <= 2; n_thread++) {
        const char *method = n_thread == 1 ? "hifdm, 1 thread" : "hifdm, 2 threads";
        time_batch(b, n_thread, &wall_s, &cpu_s);
        bench_emit("built", SCENE, method, b->sigma_mm, "samples_per_s", 1 / wall_s);
        bench_emit("built", SCENE, method, b->sigma_mm, "cpu_s", cpu_s);
        bench_emit("built", SCENE, method, b->sigma_mm, "steps", mean(b->n_step));
        bench_emit("built", SCENE, method, b->sigma_mm, "slack_cables", mean(b->n_slack));
        bench_emit("built", SCENE, method, b->sigma_mm, "loose_nodes", mean(b->n_loose));
        for (int i = 0; i < N_SAMPLE; i++)
            worst_N = fmax(worst_N, b->residual_N[i]);
        bench_emit("built", SCENE, method, b->sigma_mm, "residual", worst_N / b->built.model.reference_N);
        bench_emit("built", SCENE, method, b->sigma_mm, "error_m", largest_error_m(b, b->found_m));
        bench_emit("built", SCENE, method, b->sigma_mm, "missed", mean(b->failed));
    }
    double start_s = hf_clock_thread_cpu_s();
    for (int i = 0; i < N_TRUE; i++)
        solve(b, i);
    cpu_s = (hf_clock_thread_cpu_s() - start_s) / N_TRUE;
    bench_emit("built", SCENE, "hf_built_solve", b->sigma_mm, "cpu_s", cpu_s);
    bench_emit("built", SCENE, "hf_built_solve", b->sigma_mm, "error_m", largest_error_m(b, b->found_m));
}

/* Time of a sample against its error, by tolerance: under a looser one than 1e-4 nodes count as loose that are not. The
 * method is the sigma, for the picture. */
static void trade(built_bench *b)
{
    char method[64];
    double wall_s, cpu_s;
    snprintf(method, sizeof method, "hifdm; %g mm", b->sigma_mm);
    for (int decade = 4; decade <= 10; decade++) {
        double tolerance = pow(10, -decade);
        b->built.form.residual_tolerance = tolerance;
        time_batch(b, 1, &wall_s, &cpu_s);
        if (mean(b->failed) > 0) continue;
        bench_emit("built_precision", SCENE, method, tolerance, "cpu_s", cpu_s);
        bench_emit("built_precision", SCENE, method, tolerance, "error_m", largest_error_m(b, b->found_m));
    }
}

static void write_array(FILE *file, const void *array, size_t item_bytes, size_t count)
{
    if (fwrite(array, item_bytes, count, file) != count) bench_fail("built.bin", "cannot be written");
}

/* For peers.py: int32 n_node, n_free, n_cable, samples; ends [n_cable][2]; then doubles: nominal shape [3][n_node],
 * unstressed lengths, EA, tensions [n_cable]; lengths of samples [][n_cable], their shapes [][3][n_node]. */
static void write_samples(built_bench *b, const char *folder)
{
    char name[64];
    const hf_model *m = &b->built.model;
    size_t n = (size_t)m->n_cable, places = 3 * (size_t)m->n_node;
    int size[4] = {m->n_node, m->n_free, m->n_cable, N_TRUE};
    double *cut_m = bench_alloc(n, sizeof *cut_m);
    snprintf(name, sizeof name, "built_%g.bin", b->sigma_mm);
    FILE *file = bench_open_file(folder, name);
    write_array(file, size, sizeof *size, 4);
    write_array(file, m->end_row, sizeof *m->end_row, 2 * n);
    write_array(file, b->built.position_m, sizeof(double), places);
    write_array(file, m->target, sizeof(double), n);
    write_array(file, m->EA_N, sizeof(double), n);
    write_array(file, b->built.tension_N, sizeof(double), n);
    for (int i = 0; i < N_TRUE; i++) {
        memcpy(cut_m, m->target, n * sizeof *cut_m);
        make(b, i, cut_m, NULL, NULL, NULL);
        write_array(file, cut_m, sizeof *cut_m, n);
    }
    write_array(file, b->true_m, sizeof(double), N_TRUE * places);
    if (fclose(file) != 0) bench_fail(name, "cannot be written");
    free(cut_m);
}

void bench_built(const char *sigma_mm, const char *folder)
{
    built_bench b;
    open_built(sigma_mm, &b);
    find_true(&b);
    write_samples(&b, folder);
    b.found_m = bench_alloc(N_TRUE * 3 * (size_t)b.built.model.n_node, sizeof(double));
    b.built.form.residual_tolerance = TOLERANCE;
    b.built.form.length_tolerance = b.problem.settings.form.length_tolerance;
    count_samples(&b);
    trade(&b);
    free(b.found_m);
    close_built(&b);
}
