/* Share of time per phase, by a loop of the driver's own around the library's parts: a fixed-point iteration, and a
 * chord evaluation, per individual of eight that start together (hf_chord_run also refills lanes one by one). */
#include "bench.h"

#include "band.h"
#include "chord.h"
#include "chord_kernel.h"
#include "newton.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ENOUGH_S 0.3

/* ---- fixed point ---- */

enum { ASSEMBLY, FACTOR, SOLVE, MEASURE, UPDATE, N_PHASE };
static const char *const phase_word[N_PHASE] = {"assembly", "factor", "solve", "measure", "update"};

static void fixed_point_step(bench_scene *b, double spent_s[N_PHASE])
{
    const hf_model *m = &b->model;
    hf_workspace *w = &b->workspace;
    double t[N_PHASE + 1];
    t[0] = bench_clock_s();
    bench_fdm_matrix(m, w);
    bench_fdm_loads(m, w);
    t[1] = bench_clock_s();
    if (hf_band_factor(m->n_free, m->half_bandwidth, w->band) != 0) bench_fail(b->name, "singular");
    t[2] = bench_clock_s();
    hf_band_back_solve(m->n_free, m->half_bandwidth, 3, w->band, w->position_m, m->n_node);
    t[3] = bench_clock_s();
    bench_fdm_measure(m, w);
    t[4] = bench_clock_s();
    bench_fdm_update(m, w);
    t[5] = bench_clock_s();
    for (int i = 0; i < N_PHASE; i++)
        spent_s[i] += t[i + 1] - t[i];
}

static void fixed_point_phases(bench_scene *b)
{
    double spent_s[N_PHASE] = {0}, total_s = 0;
    int n = 0;
    if (b->model.n_gene > 0)
        hf_evaluate_prepare(&b->evaluator, b->design_N, &b->workspace);
    else
        hf_form_prepare(&b->model, &b->workspace);
    memcpy(b->workspace.position_m, b->model.position_m, 3 * (size_t)b->model.n_node * sizeof(double));
    for (double start_s = bench_clock_s(); bench_clock_s() - start_s < ENOUGH_S; n++)
        fixed_point_step(b, spent_s);
    for (int i = 0; i < N_PHASE; i++)
        total_s += spent_s[i];
    for (int i = 0; i < N_PHASE; i++) {
        bench_emit("phases", b->name, "fixed point iteration", i, phase_word[i], spent_s[i] / n);
        bench_emit("phases", b->name, "fixed point iteration", i, "share", spent_s[i] / total_s);
    }
}

/* ---- chord ---- */

enum { LOAD, FORCES, TRIANGLES, STEP, CERTIFY, N_CHORD_PHASE };
static const char *const chord_word[N_CHORD_PHASE] = {"load", "assembly (forces)", "solve", "step", "measure"};

typedef struct {
    void (*forces)(const hf_chord *, const hf_chord_lanes *, double *);
    void (*solve)(const hf_chord *, const hf_chord_lanes *);
    void (*step)(const hf_chord *, const hf_chord_lanes *);
} kernels;

/* The same choice as in chord.c, where it is static. */
static kernels choose(void)
{
    if (__builtin_cpu_supports("avx512f"))
        return (kernels){hf_chord_forces_avx512, hf_chord_solve_avx512, hf_chord_step_avx512};
    if (__builtin_cpu_supports("avx2")) return (kernels){hf_chord_forces_avx2, hf_chord_solve_avx2, hf_chord_step_avx2};
    return (kernels){hf_chord_forces_portable, hf_chord_solve_portable, hf_chord_step_portable};
}

static void load_lanes(const bench_scene *b, const hf_chord *c, hf_chord_lanes *l, int first)
{
    const hf_model *m = &b->model;
    for (size_t lane = 0; lane < HF_LANES; lane++) {
        const double *design = b->design_N + ((size_t)first + lane) * (size_t)m->n_gene;
        for (size_t i = 0; i < 3 * (size_t)m->n_node; i++)
            l->x_m[i * HF_LANES + lane] = c->base_m[i];
        for (int k = 0; k < m->n_gene; k++)
            l->gene[(size_t)k * HF_LANES + lane] = design[k] / hf_evaluate_design_length_m(m, m->gene_cable[k]);
    }
}

static void certify_lanes(bench_scene *b, const hf_chord_lanes *l, int first)
{
    const hf_model *m = &b->model;
    hf_form_result r;
    for (size_t lane = 0; lane < HF_LANES; lane++) {
        hf_evaluate_prepare(&b->evaluator, b->design_N + ((size_t)first + lane) * (size_t)m->n_gene, &b->workspace);
        for (size_t i = 0; i < 3 * (size_t)m->n_node; i++)
            b->workspace.position_m[i] = l->x_m[i * HF_LANES + lane];
        hf_form_measure(m, &b->form, &b->workspace, &r);
        hf_evaluate_judge(&b->evaluator, &r);
    }
}

/* Eight designs until the slowest has converged; returns the passes. */
static int chord_pass(bench_scene *b, const hf_chord *c, hf_chord_lanes *l, int first, double spent_s[N_CHORD_PHASE])
{
    kernels k = choose();
    double square[HF_LANES], t = bench_clock_s(), now;
    load_lanes(b, c, l, first);
    spent_s[LOAD] += (now = bench_clock_s()) - t, t = now;
    for (int n = 1; n < 60; n++) {
        double worst = 0;
        k.forces(c, l, square);
        spent_s[FORCES] += (now = bench_clock_s()) - t, t = now;
        for (int lane = 0; lane < HF_LANES; lane++)
            worst = fmax(worst, square[lane]);
        if (sqrt(worst) <= b->form.residual_tolerance) {
            certify_lanes(b, l, first);
            spent_s[CERTIFY] += bench_clock_s() - t;
            return n;
        }
        k.solve(c, l);
        spent_s[TRIANGLES] += (now = bench_clock_s()) - t, t = now;
        k.step(c, l);
        spent_s[STEP] += (now = bench_clock_s()) - t, t = now;
    }
    bench_fail(b->name, "the chord does not contract");
    return 0;
}

static void chord_phases(bench_scene *b)
{
    double spent_s[N_CHORD_PHASE] = {0}, total_s = 0;
    hf_chord chord;
    hf_chord_lanes lanes;
    int n = 0, n_pass = 0;
    if (!hf_chord_applies(&b->evaluator)) return;
    b->evaluator.solver = HF_SOLVER_NEWTON;
    double start_s = bench_clock_s();
    if (hf_chord_create(&b->evaluator, b->base_N, &b->workspace, &chord) != HF_OK ||
        hf_chord_lanes_create(&chord, &lanes) != HF_OK)
        bench_fail(b->name, "no matrix to share");
    bench_emit("phases", b->name, "chord evaluation", 0, "setup_s", bench_clock_s() - start_s);
    for (start_s = bench_clock_s(); bench_clock_s() - start_s < ENOUGH_S; n++)
        n_pass += chord_pass(b, &chord, &lanes, n * HF_LANES % (BENCH_POPULATION - HF_LANES), spent_s);
    for (int i = 0; i < N_CHORD_PHASE; i++)
        total_s += spent_s[i];
    for (int i = 0; i < N_CHORD_PHASE; i++) {
        bench_emit("phases", b->name, "chord evaluation", i, chord_word[i], spent_s[i] / n / HF_LANES);
        bench_emit("phases", b->name, "chord evaluation", i, "share", spent_s[i] / total_s);
    }
    bench_emit("phases", b->name, "chord evaluation", 0, "passes", (double)n_pass / n);
    hf_chord_lanes_free(&lanes);
    hf_chord_free(&chord);
}

void bench_phases(const char *name, const char *folder)
{
    bench_scene b;
    bench_scene_named(name, folder, &b);
    b.form.residual_tolerance = 1e-7;
    fixed_point_phases(&b);
    if (b.model.n_gene > 0) chord_phases(&b);
    bench_scene_free(&b);
}
