/* Share of time per phase. One design by the fixed point: a loop over the parts of hf_form_find. Many designs: the real
 * hf_swarm_run and hf_chord_run, with a clock in front of each of their kernels; "rest" is what they do around them:
 * put designs into lanes, take shapes out, measure these by the scalar code and judge them.
 *
 * Contents: time spent per phase - one design - eight to a pass, fixed point - eight to a pass, chord */
#include "bench.h"

#include "linalg/band.h"
#include "search/chord.h"
#include "search/swarm.h"

#include <string.h>

#define ENOUGH_S 0.2
#define ITERATIONS 100 /* of each design by the fixed point */

/* ---- time spent per phase ---- */

enum { ASSEMBLY, FACTOR, SOLVE, MEASURE, RESIDUAL, UPDATE, REST, N_PHASE };
static const char *const phase_word[N_PHASE] = {"assembly", "factor", "solve", "measure", "residual", "update", "rest"};

static double spent_s[N_PHASE]; /* a global, because kernels have no context to pass it in */

static void charge(int phase, double *since_s)
{
    double now_s = bench_clock_s();
    spent_s[phase] += now_s - *since_s;
    *since_s = now_s;
}

static void emit(const char *name, const char *method, double n)
{
    double total_s = 0;
    for (int i = 0; i < N_PHASE; i++)
        total_s += spent_s[i];
    for (int i = 0; i < N_PHASE; i++) {
        if (spent_s[i] == 0) continue; /* there is no such phase */
        bench_emit("phases", name, method, i, phase_word[i], spent_s[i] / n);
        bench_emit("phases", name, method, i, "share", spent_s[i] / total_s);
    }
}

/* ---- one design ---- */

static void fixed_point_step(bench_scene *b)
{
    const hf_model *m = &b->model;
    hf_workspace *w = &b->workspace;
    double t = bench_clock_s();
    hf_form_assemble(m, w);
    hf_form_assemble_loads(m, w);
    charge(ASSEMBLY, &t);
    if (hf_band_factor(m->n_free, m->half_bandwidth, w->band) != 0) bench_fail(b->name, "singular");
    charge(FACTOR, &t);
    hf_band_back_solve(m->n_free, m->half_bandwidth, 3, w->band, w->position_m, m->n_node);
    charge(SOLVE, &t);
    bench_measure(m, &b->form, w);
    charge(MEASURE, &t);
    hf_form_residual_N(m, w);
    charge(RESIDUAL, &t);
    hf_form_update(m, w);
    charge(UPDATE, &t);
}

static void fixed_point_phases(bench_scene *b)
{
    int n = 0;
    memset(spent_s, 0, sizeof spent_s);
    hf_evaluate_prepare(&b->evaluator, b->design, &b->workspace);
    memcpy(b->workspace.position_m, b->model.position_m, 3 * (size_t)b->model.n_node * sizeof(double));
    for (double start_s = bench_clock_s(); bench_clock_s() - start_s < ENOUGH_S; n++)
        fixed_point_step(b);
    emit(b->name, "fixed point iteration", n);
}

/* ---- populations, run over and over ---- */

static int next_design(void *context)
{
    int *n_left = context;
    return --*n_left;
}

typedef void run_population(bench_scene *b, int (*next)(void *context), void *context, hf_form_result *result);

/* Time per iteration, or per evaluation. */
static void population_phases(bench_scene *b, const char *method, run_population *run, int by_iteration)
{
    hf_form_result result[BENCH_POPULATION];
    double n = 0, kernels_s = 0, start_s = bench_clock_s(), passed_s;
    memset(spent_s, 0, sizeof spent_s);
    do {
        int n_left = BENCH_POPULATION;
        run(b, next_design, &n_left, result);
        for (int i = 0; i < BENCH_POPULATION; i++)
            n += by_iteration ? result[i].iterations : 1;
        passed_s = bench_clock_s() - start_s;
    } while (passed_s < ENOUGH_S);
    for (int i = 0; i < N_PHASE; i++)
        kernels_s += spent_s[i];
    spent_s[REST] = passed_s - kernels_s;
    emit(b->name, method, n);
}

/* ---- eight to a pass, fixed point ---- */

static const hf_swarm_kernels *swarm_kernels;
static hf_swarm_plan swarm_plan;
static hf_swarm_lanes swarm_lanes;

/* In three calls what the kernel `solve` interleaves: the same bits, a little slower. */
static void timed_swarm_solve(const hf_swarm_plan *plan, hf_swarm_lanes *w)
{
    double t = bench_clock_s();
    swarm_kernels->assemble(plan, w);
    charge(ASSEMBLY, &t);
    swarm_kernels->factor(plan, w);
    charge(FACTOR, &t);
    swarm_kernels->substitute(plan, w);
    charge(SOLVE, &t);
}

static void timed_swarm_measure(const hf_swarm_plan *plan, hf_swarm_lanes *w, hf_swarm_measures *measures)
{
    double t = bench_clock_s();
    swarm_kernels->measure(plan, w, measures);
    charge(MEASURE, &t);
}

static void timed_swarm_residual(const hf_swarm_plan *plan, const hf_swarm_lanes *w, hf_swarm_measures *measures)
{
    double t = bench_clock_s();
    swarm_kernels->residual(plan, w, measures);
    charge(RESIDUAL, &t);
}

static void run_swarm(bench_scene *b, int (*next)(void *context), void *context, hf_form_result *result)
{
    hf_swarm_run(&b->evaluator, &swarm_plan, &swarm_lanes, &b->workspace, next, context, b->design, result);
}

static void swarm_phases(bench_scene *b)
{
    if (hf_swarm_plan_create(&b->model, hf_lane_best_isa(), &swarm_plan) != HF_OK ||
        hf_swarm_lanes_create(&swarm_plan, &swarm_lanes) != HF_OK)
        bench_fail(b->name, "out of memory");
    hf_swarm_kernels timed = *swarm_plan.kernels;
    swarm_kernels = swarm_plan.kernels;
    timed.solve = timed_swarm_solve;
    timed.measure = timed_swarm_measure;
    timed.residual = timed_swarm_residual;
    swarm_plan.kernels = &timed;
    b->form.residual_tolerance = 0; /* never reached: as many iterations for each design */
    b->form.max_iterations = ITERATIONS;
    population_phases(b, "fixed point iteration, lanes", run_swarm, 1);
    b->form = b->settings.form;
    hf_arena_free(&swarm_lanes.arena);
    hf_arena_free_block(swarm_plan.block);
}

/* ---- eight to a pass, chord ---- */

static const hf_chord_kernels *chord_kernels;
static hf_chord chord;
static hf_chord_lanes chord_lanes;

static void timed_chord_forces(const hf_chord *c, const hf_chord_lanes *l, double residual_squared[HF_LANES])
{
    double t = bench_clock_s();
    chord_kernels->forces(c, l, residual_squared);
    charge(RESIDUAL, &t);
}

static hf_packed_band_solve *chord_solve;

static void timed_chord_solve(const hf_packed_band *matrix, double *lanes)
{
    double t = bench_clock_s();
    chord_solve(matrix, lanes);
    charge(SOLVE, &t);
}

static void timed_chord_step(const hf_chord *c, const hf_chord_lanes *l)
{
    double t = bench_clock_s();
    chord_kernels->step(c, l);
    charge(UPDATE, &t);
}

static void timed_chord_measure(const hf_chord *c, const hf_chord_lanes *l, hf_chord_measures *measures)
{
    double t = bench_clock_s();
    chord_kernels->measure(c, l, measures);
    charge(MEASURE, &t);
}

static void run_chord(bench_scene *b, int (*next)(void *context), void *context, hf_form_result *result)
{
    hf_chord_run(&chord, &chord_lanes, &b->workspace, NULL, next, context, false, b->design, result);
}

static void chord_phases(bench_scene *b)
{
    static const hf_chord_kernels timed = {
        .forces = timed_chord_forces, .step = timed_chord_step, .measure = timed_chord_measure};
    if (!hf_chord_applies(&b->evaluator)) return;
    b->evaluator.solver = HF_SOLVER_NEWTON;
    b->form.residual_tolerance = 1e-7;
    if (hf_chord_create(&b->evaluator, b->initial, &b->workspace, NULL, &chord) != HF_OK ||
        hf_chord_lanes_create(&chord, &chord_lanes) != HF_OK)
        bench_fail(b->name, "no matrix to share");
    chord_kernels = chord.kernels;
    chord.kernels = &timed;
    chord_solve = chord.matrix.solve;
    chord.matrix.solve = timed_chord_solve;
    population_phases(b, "chord evaluation", run_chord, 0);
    hf_arena_free(&chord_lanes.arena);
    hf_arena_free(&chord.arena);
}

void bench_phases(const char *name, const char *folder)
{
    bench_scene b;
    bench_scene_named(name, folder, &b);
    fixed_point_phases(&b);
    swarm_phases(&b);
    chord_phases(&b);
    bench_scene_free(&b);
}
