/* bench - what the parts of the benchmark driver share. The driver only measures: each sample is one line on standard
 * output, `section scene method parameter quantity value` with tabs between; run.py calls it in rounds, takes medians
 * and writes the tables and figures. */
#pragma once

#include <hifdm/batch.h>
#include <hifdm/config.h>
#include <hifdm/formfind.h>

#include <stdio.h>

#define BENCH_POPULATION 50
#define BENCH_TRUE 2 /* designs whose true position error is measured */

/* A case, ready to be evaluated. Never moved: evaluator points into it. */
typedef struct {
    const char *name;
    hf_case settings;
    hf_scene scene;
    hf_model model;
    hf_form_settings form; /* that the evaluator uses: tolerances change between measurements */
    hf_workspace workspace;
    hf_form_result found; /* of the case's own form-finding */
    hf_evaluator evaluator;
    double *start_q_N_per_m; /* [n_cable] of the found shape */
    double *initial;         /* [n_variable] */
    double *design; /* [BENCH_POPULATION][n_variable] base +- range_N, a chain of boundary cables moves together */
} bench_scene;

/* Load, find the shape, draw the designs; ends the program with a message when that fails. To be freed. */
void bench_scene_open(const char *name, const char *path, const char *const *overrides, int n_override,
                      bench_scene *scene);
/* The scenes by name; see the table in scene.c. `folder`: where the imported net is written. */
void bench_scene_named(const char *name, const char *folder, bench_scene *scene);
/* Only case, scene, model and workspace: no shape, no designs. */
void bench_scene_model(const char *name, bench_scene *scene);
void bench_scene_free(bench_scene *scene);

/* Shape of the prepared workspace's laws (no law length) by Newton in long double, from its position_m, into x_m
 * [3][n_node]. Returns the largest residual over the reference tension that was reached. */
double bench_reference(const hf_model *model, hf_workspace *workspace, double *x_m);

/* Largest distance of a free node between two shapes [3][n_node]. */
double bench_distance_m(const hf_model *model, const double *a_m, const double *b_m);

double bench_clock_s(void);
void *bench_alloc(size_t count, size_t item_bytes); /* zeroed; ends the program when there is no memory */
void bench_fail(const char *what, const char *why);
FILE *bench_open_file(const char *folder, const char *name); /* to be written; ends the program when it cannot be */
void bench_emit(const char *section, const char *scene, const char *method, double parameter, const char *quantity,
                double value);

/* Seconds per call of work(context): at least one call, and calls until `enough_s` have passed. */
double bench_time_s(void (*work)(void *context), void *context, double enough_s);

/* One step of the force density method by hf_form_find's own parts: assembly, factor, three right-hand sides, lengths
 * and tensions. measure: its last part, for a shape that another solver left in the workspace. */
void bench_fdm_step(const hf_model *model, const hf_form_settings *form, hf_workspace *workspace);
void bench_measure(const hf_model *model, const hf_form_settings *form, hf_workspace *workspace);

/* The net, a prepared workspace's laws and force densities and a shape to hold against, for peers.py. */
void bench_write_net(const bench_scene *scene, const hf_workspace *workspace, const double *reference_m,
                     const char *folder, const char *name);

/* CHOLMOD as a peer: analysis once, then numbers only. NULL when the driver was built without it. */
typedef struct bench_cholmod bench_cholmod;
bench_cholmod *bench_cholmod_create(const hf_model *model);
/* D x = b with the workspace's q_N_per_m: right-hand sides in and shape out of position_m. Returns 0 on success. */
int bench_cholmod_step(bench_cholmod *peer, const hf_model *model, hf_workspace *workspace);
double bench_cholmod_bytes(const bench_cholmod *peer); /* of the factor and the matrix */
void bench_cholmod_free(bench_cholmod *peer);
const char *bench_cholmod_version(void);

/* The sections, a file each. One more (the frame of a truss, say) is a file like step.c, a row in main.c, a line in
 * `measure`, a write_... in run.py, and a row in results/bench/README.md. */
void bench_frame(const char *what, const char *folder);
void bench_cases(const char *name, const char *folder); /* only writes the imported net's case into the folder */
void bench_step(const char *what, const char *folder);
void bench_peak(const char *what, const char *folder);
void bench_phases(const char *scene, const char *folder);
void bench_precision(const char *scene, const char *folder);
void bench_single(const char *scene, const char *folder);
void bench_equilibrium(const char *net, const char *folder);
void bench_built(const char *sigma_mm, const char *folder);
void bench_pattern(const char *to_deg, const char *folder);
void bench_antenna(const char *what, const char *folder); /* Ruze's formula beside physical optics; antenna.csv */
void bench_growth(const char *scale, const char *folder);
void bench_population(const char *scene, const char *folder);
void bench_lanes(const char *scene, const char *folder);
void bench_whole(const char *path, const char *folder);
void bench_stages(const char *name, const char *folder, const char *path, const char *const *overrides, int n_override);
