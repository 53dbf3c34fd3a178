/* Contents: references - one method at one tolerance - a peer step by step - work-precision - one evaluation to a given
 * error */
#include "bench.h"

#include "linalg/band.h"
#include "search/chord.h"
#include "solve/certificate.h"
#include "solve/equilibrium.h"
#include "solve/interior.h"
#include "solve/newton.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ENOUGH_S 0.02
#define TOLERANCE_LOOSEST 1e-1
#define TOLERANCE_TIGHTEST 1e-9
#define COLD_TIGHTEST 1e-7
#define WANTED_M 1e-6
#define COUNT_MAX 200000
#define TRACE_S 20.0      /* a peer is given up after this time */
#define TRACE_LEAST 1e-10 /* m; no peer is asked for less error */
#define PATH_STEPS 200

/* ---- references: the true shapes of the first designs ---- */

/* Number of designs that the slow fixed point solves. */
static int n_true(const bench_scene *b)
{
    if (b->model.n_variable == 0) return 1;
    return b->model.n_free > 700 ? 1 : BENCH_TRUE;
}

static const double *design(const bench_scene *b, int i)
{
    return b->design + (size_t)i * (size_t)b->model.n_variable;
}

static size_t shape_size(const bench_scene *b)
{
    return 3 * (size_t)b->model.n_node;
}

static double *make_references(bench_scene *b)
{
    hf_form_result r;
    double *all = bench_alloc(BENCH_TRUE * shape_size(b), sizeof *all), worst = 0;
    b->form.residual_tolerance = 1e-9;
    b->evaluator.solver = HF_SOLVER_NEWTON;
    for (int i = 0; i < n_true(b); i++) {
        if (hf_evaluate(&b->evaluator, design(b, i), &b->workspace, NULL, &r) != HF_OK)
            bench_fail(b->name, hf_status_text(r.status));
        worst = fmax(worst, bench_reference(&b->model, &b->workspace, all + (size_t)i * shape_size(b)));
    }
    bench_emit("precision", b->name, "reference", 0, "relative_residual", worst);
    return all;
}

/* ---- one method at one tolerance ---- */

typedef struct {
    bench_scene *scene;
    const double *reference_m;
    hf_batch *batch;
    const char *name;
    void (*work)(void *context); /* all designs once */
    int n;                       /* designs per call of work */
    double error_m;              /* largest so far; NaN leaves it */
    hf_form_result result[BENCH_POPULATION];
} run;

static void note_error(run *r, int i, const hf_workspace *w)
{
    const bench_scene *b = r->scene;
    double error_m = bench_distance_m(&b->model, w->position_m, r->reference_m + (size_t)i * shape_size(b));
    r->error_m = fmax(r->error_m, error_m);
}

static void one_by_one(run *r)
{
    for (int i = 0; i < r->n; i++) {
        hf_evaluate(&r->scene->evaluator, design(r->scene, i), &r->scene->workspace, NULL, &r->result[i]);
        note_error(r, i, &r->scene->workspace); /* some microseconds, beside milliseconds */
    }
}

static void by_fixed_point(void *context)
{
    ((run *)context)->scene->evaluator.solver = HF_SOLVER_FIXED_POINT;
    one_by_one(context);
}

/* From the theoretical shape, Td / l, where the paper starts. */
static void by_cold_fixed_point(void *context)
{
    run *r = context;
    bench_scene *b = r->scene;
    b->evaluator.start_q_N_per_m = b->model.start_q_N_per_m;
    by_fixed_point(r);
    b->evaluator.start_q_N_per_m = b->start_q_N_per_m;
}

static void by_newton(void *context)
{
    ((run *)context)->scene->evaluator.solver = HF_SOLVER_NEWTON;
    one_by_one(context);
}

/* From the theoretical shape, as the first form-finding of a case that nothing else solves. */
static void by_path(void *context)
{
    run *r = context;
    bench_scene *b = r->scene;
    for (int i = 0; i < r->n; i++) {
        int n_step = 0, culprit;
        hf_evaluate_prepare(&b->evaluator, design(b, i), &b->workspace);
        hf_status status = hf_interior_run(&b->model, &b->form, &b->workspace, false, PATH_STEPS, &n_step, &culprit);
        if (status != HF_OK) bench_fail(b->name, hf_status_text(status));
        r->result[i].iterations = n_step;
        note_error(r, i, &b->workspace);
    }
}

static void by_paper_stop(void *context)
{
    run *r = context;
    bench_scene *b = r->scene;
    for (int i = 0; i < r->n; i++) {
        hf_evaluate_prepare(&b->evaluator, design(b, i), &b->workspace);
        hf_form_find(&b->model, &b->form, HF_STOP_RMS_CHANGE, &b->workspace, NULL, &r->result[i]);
        note_error(r, i, &b->workspace);
    }
}

static void by_chord(void *context)
{
    run *r = context;
    hf_batch_run(r->batch, r->n, r->scene->design, NULL, r->result);
}

static double iterations(const run *r)
{
    double sum = 0;
    for (int i = 0; i < r->n; i++)
        sum += r->result[i].iterations;
    return sum / r->n;
}

/* Time per design and true error at the residual tolerance (relative). Returns the error. */
static double sample(run *r, const char *section, double tolerance)
{
    bench_scene *b = r->scene;
    hf_form_result again;
    b->form.residual_tolerance = tolerance;
    r->error_m = 0;
    double time_s = bench_time_s(r->work, r, ENOUGH_S) / r->n;
    if (r->work == by_chord)
        for (int i = 0; i < n_true(b); i++)
            note_error(r, i, hf_batch_run_one(r->batch, design(b, i), &again)); /* the same bits as in the batch */
    bench_emit(section, b->name, r->name, tolerance, "time_s", time_s);
    bench_emit(section, b->name, r->name, tolerance, "error_m", r->error_m);
    bench_emit(section, b->name, r->name, tolerance, "iterations", iterations(r));
    return r->error_m;
}

/* The error bounds of the shapes that Newton found and the estimates, the largest of all designs as of the error; NaN
 * when one has none. */
static void sample_bound(run *r, double tolerance)
{
    bench_scene *b = r->scene;
    double bound_m = 0, estimate_m = 0;
    for (int i = 0; i < r->n; i++) {
        hf_form_result result;
        hf_evaluate(&b->evaluator, design(b, i), &b->workspace, NULL, &result);
        hf_certify(&b->model, &b->workspace, &result);
        if (!(result.position_bound_m <= bound_m)) bound_m = result.position_bound_m;
        estimate_m = fmax(estimate_m, result.position_error_m);
    }
    bench_emit("precision", b->name, r->name, tolerance, "bound_m", bound_m);
    bench_emit("precision", b->name, r->name, tolerance, "estimate_m", estimate_m);
}

static int share_matrix(bench_scene *b, hf_batch *batch)
{
    b->evaluator.solver = HF_SOLVER_AUTO;
    b->form.residual_tolerance = TOLERANCE_TIGHTEST;
    if (hf_batch_create(&b->evaluator, 1, batch) != HF_OK) bench_fail(b->name, "out of memory");
    if (b->model.n_variable == 0) return 0;
    double start_s = bench_clock_s();
    hf_solver by = hf_batch_share(batch, b->initial);
    bench_emit("precision", b->name, "chord", 0, "setup_s", bench_clock_s() - start_s);
    return by == HF_SOLVER_CHORD;
}

/* ---- a peer step by step: the time its steps took, whenever the true error has fallen below another decade ---- */

/* The fixed point of Eqs. 7 and 8 with CHOLMOD, of the first design, from the found shape; the errors are not timed. */
static void trace_cholmod(bench_scene *b, const double *reference_m)
{
    const hf_model *m = &b->model;
    hf_workspace *w = &b->workspace;
    bench_cholmod *peer = bench_cholmod_create(m);
    double passed_s = 0, wanted_m = INFINITY;
    if (!peer) return;
    hf_evaluate_prepare(&b->evaluator, b->design, w);
    for (int k = 1; passed_s < TRACE_S && wanted_m > TRACE_LEAST; k++) {
        double start_s = bench_clock_s();
        if (bench_cholmod_step(peer, m, w)) bench_fail(b->name, "CHOLMOD");
        bench_measure(m, &b->form, w);
        passed_s += bench_clock_s() - start_s;
        double error_m = bench_distance_m(m, w->position_m, reference_m);
        if (error_m <= wanted_m) {
            wanted_m = pow(10, floor(log10(error_m)));
            bench_emit("precision", b->name, "CHOLMOD fixed point", wanted_m, "time_s", passed_s);
            bench_emit("precision", b->name, "CHOLMOD fixed point", wanted_m, "error_m", error_m);
            bench_emit("precision", b->name, "CHOLMOD fixed point", wanted_m, "iterations", k);
        }
        start_s = bench_clock_s();
        hf_form_update(m, w);
        passed_s += bench_clock_s() - start_s;
    }
    bench_cholmod_free(peer);
}

/* ---- work-precision ---- */

void bench_precision(const char *name, const char *folder)
{
    bench_scene b;
    hf_batch batch;
    bench_scene_named(name, folder, &b);
    double *reference_m = make_references(&b);
    hf_evaluate_prepare(&b.evaluator, b.design, &b.workspace);
    bench_write_net(&b, &b.workspace, reference_m, folder, name);
    int has_chord = share_matrix(&b, &batch), n = n_true(&b);
    run way[] = {{&b, reference_m, NULL, "fixed point", by_fixed_point, n, 0, {{0}}},
                 {&b, reference_m, NULL, "fixed point, cold", by_cold_fixed_point, n, 0, {{0}}},
                 {&b, reference_m, NULL, "newton", by_newton, n, 0, {{0}}},
                 {&b, reference_m, NULL, "path, cold", by_path, n, 0, {{0}}},
                 {&b, reference_m, &batch, "chord", by_chord, BENCH_POPULATION, 0, {{0}}}};
    for (double tolerance = TOLERANCE_LOOSEST; tolerance > 0.9 * TOLERANCE_TIGHTEST; tolerance /= 10)
        for (int i = 0; i < 4 + has_chord; i++)
            /* the cold start only costs a longer way to the same line */
            if (way[i].work != by_cold_fixed_point || tolerance > COLD_TIGHTEST) {
                sample(&way[i], "precision", tolerance);
                if (way[i].work == by_newton) sample_bound(&way[i], tolerance);
            }
    run paper = {&b, reference_m, NULL, "paper's stop", by_paper_stop, n, 0, {{0}}};
    sample(&paper, "precision", b.form.rms_tolerance_m);
    trace_cholmod(&b, reference_m);
    hf_batch_free(&batch);
    free(reference_m);
    bench_scene_free(&b);
}

/* ---- one evaluation to a true error of WANTED_M ---- */

/* Steps of the fixed point until the first design's true error is below WANTED_M. */
static int count_fixed_point(bench_scene *b, const double *reference_m)
{
    const hf_model *m = &b->model;
    hf_workspace *w = &b->workspace;
    memcpy(w->position_m, m->position_m, shape_size(b) * sizeof(double));
    hf_evaluate_prepare(&b->evaluator, b->design, w);
    for (int k = 1; k < COUNT_MAX; k++) {
        bench_fdm_step(m, &b->form, w);
        if (bench_distance_m(m, w->position_m, reference_m) <= WANTED_M) return k;
        hf_form_update(m, w);
    }
    return 0;
}

static void single_fixed_point(run *r)
{
    bench_scene *b = r->scene;
    int k = count_fixed_point(b, r->reference_m), keep = b->form.max_iterations;
    b->form.max_iterations = k;
    b->form.residual_tolerance = 0; /* the count ends it */
    r->n = 1;
    r->error_m = 0;
    bench_emit("single", b->name, "fixed point", WANTED_M, "time_s", bench_time_s(by_fixed_point, r, ENOUGH_S));
    bench_emit("single", b->name, "fixed point", WANTED_M, "error_m", r->error_m);
    bench_emit("single", b->name, "fixed point", WANTED_M, "iterations", k);
    b->form.max_iterations = keep;
}

/* The loosest tolerance, by half decades, at which the error is small enough. */
static void single_by_tolerance(run *r)
{
    bench_scene *b = r->scene;
    hf_form_result again;
    double tolerance = TOLERANCE_LOOSEST;
    for (; tolerance > 1e-13; tolerance /= sqrt(10)) {
        b->form.residual_tolerance = tolerance;
        r->error_m = 0;
        if (r->work != by_chord) r->work(r);
        for (int i = 0; r->work == by_chord && i < n_true(b); i++)
            note_error(r, i, hf_batch_run_one(r->batch, design(b, i), &again));
        if (r->error_m <= WANTED_M) break;
    }
    double time_s = bench_time_s(r->work, r, ENOUGH_S) / r->n;
    bench_emit("single", b->name, r->name, WANTED_M, "time_s", time_s);
    bench_emit("single", b->name, r->name, WANTED_M, "error_m", r->error_m);
    bench_emit("single", b->name, r->name, WANTED_M, "iterations", iterations(r));
    bench_emit("single", b->name, r->name, WANTED_M, "tolerance", tolerance);
}

/* The case's own laws (law length on the boundary), from the theoretical shape, as `run` does it first. */
static void single_form_finding(bench_scene *b)
{
    hf_form_settings s = b->settings.form;
    hf_form_result r;
    if (s.stop != HF_STOP_RESIDUAL) return;
    for (int method = HF_METHOD_HIFDM;; method = HF_METHOD_NEWTON) {
        const char *name = method == HF_METHOD_HIFDM ? "form-finding, fixed point" : "form-finding, newton";
        double start_s = bench_clock_s();
        hf_form_prepare(&b->model, &b->workspace);
        if (method == HF_METHOD_HIFDM)
            hf_form_find(&b->model, &s, HF_STOP_RESIDUAL, &b->workspace, NULL, &r);
        else
            hf_equilibrium_find(&b->model, &s, &b->workspace, NULL, &r);
        bench_emit("form", b->name, name, s.residual_tolerance, "time_s", bench_clock_s() - start_s);
        if (b->model.has_newton) hf_newton_certify(&b->model, &b->workspace, &r);
        bench_emit("form", b->name, name, s.residual_tolerance, "iterations", r.iterations);
        bench_emit("form", b->name, name, s.residual_tolerance, "residual_N", r.residual_N);
        bench_emit("form", b->name, name, s.residual_tolerance, "position_error_estimate_m", r.position_error_m);
        if (method == HF_METHOD_NEWTON) return;
    }
}

void bench_single(const char *name, const char *folder)
{
    bench_scene b;
    hf_batch batch;
    bench_scene_named(name, folder, &b);
    single_form_finding(&b);
    /* without genes the base shape is the one to be found: start from the theoretical shape */
    if (b.model.n_variable == 0) b.evaluator.start_q_N_per_m = b.model.start_q_N_per_m;
    double *reference_m = make_references(&b);
    int has_chord = share_matrix(&b, &batch);
    hf_evaluate_prepare(&b.evaluator, b.design, &b.workspace);
    bench_write_net(&b, &b.workspace, reference_m, folder, name);
    run fixed = {&b, reference_m, NULL, "fixed point", by_fixed_point, 1, 0, {{0}}};
    run newton = {&b, reference_m, NULL, "newton", by_newton, n_true(&b), 0, {{0}}};
    run chord = {&b, reference_m, &batch, "chord", by_chord, BENCH_POPULATION, 0, {{0}}};
    single_fixed_point(&fixed);
    single_by_tolerance(&newton);
    if (has_chord) single_by_tolerance(&chord);
    hf_batch_free(&batch);
    free(reference_m);
    bench_scene_free(&b);
}
