/* Contents: the scenes and the kernel net - opening one - an imported net - the reference shape */
#include "bench.h"

#include "linalg/band.h"
#include "solve/newton_matrix.h"
#include "solve/prestress.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OVERRIDES_MAX 6
#define IMPORTED "imported 31x37"

typedef struct {
    const char *name, *path;
    const char *overrides[OVERRIDES_MAX];
} scene_row;

#define CYLINDER "scene.parabolic_cylinder."
#define ONE_CELL CYLINDER "cells_per_module=[1,1]"
#define TIED CYLINDER "rear_distance_m=2.5"
#define PERIMETER CYLINDER "supports=perimeter", CYLINDER "scallop=0"

static const scene_row scene_table[] = {
    {"straight-edges", "configs/straight-edges.yaml", {NULL}},
    {"21x25 f=15", "configs/reflector.yaml", {CYLINDER "focal_length_m=15", NULL}},
    {"41x49 f=5", "configs/reflector.yaml", {CYLINDER "focal_length_m=5", CYLINDER "cells_per_module=[4,4]", NULL}},
    /* the base of the imported net, and the net of the kernels: no free boundary cable, so no genes */
    {"31x37", "configs/reflector.yaml", {CYLINDER "cells_per_module=[3,3]", NULL}},
    {"21x25 perimeter", "configs/reflector.yaml", {PERIMETER, NULL}},
    /* front and rear net, tied to each other */
    {"21x25 f=15 tied",
     "configs/reflector.yaml",
     {CYLINDER "focal_length_m=15", TIED, CYLINDER "tie_law=tension", NULL}},
    {"21x25 f=15 tied and held",
     "configs/reflector.yaml",
     {CYLINDER "focal_length_m=15", TIED, "form.prestress=exact", NULL}},
    /* half-bandwidths 21 and 65 */
    {"22x24 perimeter", "configs/reflector.yaml", {PERIMETER, ONE_CELL, CYLINDER "modules=[21,23]", NULL}},
    {"66x68 perimeter", "configs/reflector.yaml", {PERIMETER, ONE_CELL, CYLINDER "modules=[65,67]", NULL}},
};

/* ---- small things ---- */

static double uniform(unsigned *state) /* in -1 .. 1; the same on every machine */
{
    *state = *state * 1664525u + 1013904223u;
    return (double)(*state >> 8) / 8388608.0 - 1;
}

double bench_distance_m(const hf_model *m, const double *a, const double *b)
{
    double largest = 0;
    for (int i = 0; i < m->n_free; i++) {
        double square = 0;
        for (int c = 0; c < 3; c++) {
            double d = a[c * m->n_node + i] - b[c * m->n_node + i];
            square += d * d;
        }
        largest = fmax(largest, square);
    }
    return sqrt(largest);
}

/* ---- opening one ---- */

static void draw_designs(bench_scene *b)
{
    const hf_model *m = &b->model;
    const hf_optimize_settings *o = &b->settings.optimize;
    unsigned state = 2022;
    double *change = bench_alloc((size_t)m->n_variable_group + 1, sizeof *change);
    b->design = bench_alloc((size_t)BENCH_POPULATION * (size_t)m->n_variable + 1, sizeof *b->design);
    for (int i = 0; i < BENCH_POPULATION; i++) {
        for (int g = 0; g < m->n_variable_group; g++)
            change[g] = o->range_N * uniform(&state);
        for (int k = 0; k < m->n_variable; k++)
            b->design[i * m->n_variable + k] = fmax(b->initial[k] + change[m->variable_group[k]], o->min_tension_N);
    }
    free(change);
}

static void build(const char *name, const char *path, const char *const *overrides, int n_override, bench_scene *b)
{
    hf_messages messages = {0};
    *b = (bench_scene){.name = name};
    if (hf_config_load(path, overrides, n_override, &b->settings, &messages) != HF_OK ||
        hf_config_scene(&b->settings, &b->scene, &messages) != HF_OK ||
        (b->settings.form.prestress == HF_PRESTRESS_EXACT &&
         hf_prestress_hold(&b->scene, &b->settings.form, NULL, &messages) != HF_OK) ||
        hf_model_build(&b->scene, &b->settings.form, &b->model, &messages) != HF_OK)
        bench_fail(path, messages.text);
    b->form = b->settings.form;
    if (hf_workspace_create(&b->model, &b->workspace) != HF_OK) bench_fail(name, "out of memory");
    hf_messages_free(&messages);
}

void bench_scene_open(const char *name, const char *path, const char *const *overrides, int n_override, bench_scene *b)
{
    build(name, path, overrides, n_override, b);
    hf_form_settings quick = b->form; /* the same shape as by the paper's iteration, sooner */
    if (quick.stop == HF_STOP_RESIDUAL) quick.method = HF_METHOD_AUTO;
    hf_evaluate_form(&b->model, &quick, &b->workspace, NULL, &b->found);
    if (b->found.status != HF_OK) bench_fail(name, hf_status_text(b->found.status));
    size_t n_cable = (size_t)b->model.n_cable;
    b->start_q_N_per_m = bench_alloc(n_cable, sizeof(double));
    b->initial = bench_alloc((size_t)b->model.n_variable + 1, sizeof(double));
    memcpy(b->start_q_N_per_m, b->workspace.q_N_per_m, n_cable * sizeof(double));
    for (int k = 0; k < b->model.n_variable; k++)
        b->initial[k] = b->workspace.tension_N[b->model.variable_cable[k]];
    b->evaluator = (hf_evaluator){.model = &b->model,
                                  .form = &b->form,
                                  .start_q_N_per_m = b->start_q_N_per_m,
                                  .rule = HF_RULE_FORCE_DENSITY,
                                  .solver = HF_SOLVER_AUTO,
                                  .boundary_ratio_cap = 1e6};
    draw_designs(b);
}

void bench_scene_free(bench_scene *b)
{
    free(b->design);
    free(b->initial);
    free(b->start_q_N_per_m);
    hf_workspace_free(&b->workspace);
    hf_model_free(&b->model);
    hf_scene_free(&b->scene);
    hf_case_free(&b->settings);
}

/* ---- an imported net: a generated one with every node moved and loaded, through CSV files ---- */

FILE *bench_open_file(const char *folder, const char *name)
{
    char path[HF_PATH_SIZE];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (!file) bench_fail(path, "cannot be written");
    return file;
}

static void write_nodes(const hf_scene *s, FILE *file)
{
    unsigned state = 7;
    fputs("id,x_m,y_m,z_m,role,Fx_N,Fy_N,Fz_N\n", file);
    for (int i = 0; i < s->n_node; i++) {
        fputs(s->node_id[i], file);
        for (int c = 0; c < 3; c++)
            fprintf(file, ",%.17g", s->position_m[3 * i + c] + 0.01 * uniform(&state));
        fprintf(file, ",%s", hf_role_word[s->role[i]]);
        for (int c = 0; c < 3; c++)
            fprintf(file, ",%.17g", s->role[i] == HF_ROLE_SUPPORT ? 0 : 0.05 * uniform(&state));
        fputc('\n', file);
    }
}

static void write_cables(const hf_scene *s, FILE *file)
{
    fputs("id,i,j,group,law,value\n", file);
    for (int e = 0; e < s->n_cable; e++) /* no value: L* is the theoretical length, T* the case's pretension */
        fprintf(file, "%s,%s,%s,%s,%s,\n", s->cable_id[e], s->node_id[s->end[2 * e]], s->node_id[s->end[2 * e + 1]],
                hf_group_word[s->group[e]], hf_law_word[s->law[e]]);
}

static void write_imported(const char *folder)
{
    bench_scene base;
    bench_scene_named("31x37", folder, &base);
    FILE *file = bench_open_file(folder, "nodes.csv");
    write_nodes(&base.scene, file);
    fclose(file);
    file = bench_open_file(folder, "cables.csv");
    write_cables(&base.scene, file);
    fclose(file);
    file = bench_open_file(folder, "imported.yaml");
    fputs("scene:\n  import:\n    nodes: nodes.csv\n    cables: cables.csv\n", file);
    fclose(file);
    bench_scene_free(&base);
}

void bench_cases(const char *name, const char *folder)
{
    if (strcmp(name, IMPORTED)) bench_fail(name, "is not written to files");
    write_imported(folder);
}

static const scene_row *find_row(const char *name, int *n_override)
{
    const scene_row *row = scene_table, *end = row + sizeof scene_table / sizeof *scene_table;
    while (row < end && strcmp(name, row->name))
        row++;
    if (row == end) bench_fail(name, "no such scene");
    for (*n_override = 0; row->overrides[*n_override];)
        ++*n_override;
    return row;
}

void bench_scene_named(const char *name, const char *folder, bench_scene *b)
{
    int n_override;
    if (!strcmp(name, IMPORTED)) {
        char path[HF_PATH_SIZE];
        write_imported(folder);
        snprintf(path, sizeof path, "%s/imported.yaml", folder);
        bench_scene_open(IMPORTED, path, NULL, 0, b);
        return;
    }
    const scene_row *row = find_row(name, &n_override);
    bench_scene_open(name, row->path, row->overrides, n_override, b);
}

void bench_scene_model(const char *name, bench_scene *b)
{
    int n_override;
    const scene_row *row = find_row(name, &n_override);
    build(name, row->path, row->overrides, n_override, b);
}

/* ---- the reference shape: Newton whose residual is computed in long double ---- */

/* Nodal forces at x into force [3*row + c] and the tensions into the workspace; returns the largest force. */
static long double long_forces(const hf_model *m, hf_workspace *w, const long double *x, long double *force)
{
    long double largest = 0;
    for (int i = 0; i < m->n_free; i++)
        for (int c = 0; c < 3; c++)
            force[3 * i + c] = m->load_N ? m->load_N[c * m->n_node + i] : 0;
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        long double d[3], square = 0;
        for (int c = 0; c < 3; c++) {
            d[c] = x[c * m->n_node + b] - x[c * m->n_node + a];
            square += d[c] * d[c];
        }
        long double length = sqrtl(square), q = w->target[e];
        if (w->law[e] == HF_LAW_TENSION) q /= length;
        w->tension_N[e] = (double)(q * length);
        for (int c = 0; c < 3; c++) {
            if (a < m->n_free) force[3 * a + c] += q * d[c];
            if (b < m->n_free) force[3 * b + c] -= q * d[c];
        }
    }
    for (int i = 0; i < m->n_free; i++) {
        const long double *f = force + 3 * i;
        largest = fmaxl(largest, f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    }
    return sqrtl(largest);
}

double bench_reference(const hf_model *m, hf_workspace *w, double *x_m)
{
    size_t n = 3 * (size_t)m->n_node;
    int n_dof = 3 * m->n_free;
    long double *x = bench_alloc(n, sizeof *x), *force = bench_alloc(n, sizeof *force), reached = INFINITY;
    for (size_t i = 0; i < n; i++)
        x[i] = w->position_m[i];
    for (int k = 0; k < 40; k++) {
        long double residual = long_forces(m, w, x, force);
        if (!(residual < reached) && k > 5) break; /* rounding of the step is all that is left */
        reached = residual;
        if (reached <= 1e-15L * m->reference_N || hf_newton_matrix_factor(m, w, NULL) != HF_OK) break;
        for (int i = 0; i < n_dof; i++)
            w->newton_step[i] = (double)force[i];
        hf_band_back_solve(n_dof, 3 * m->half_bandwidth + 2, 1, w->newton_band, w->newton_step, n_dof);
        for (int i = 0; i < m->n_free; i++)
            for (int c = 0; c < 3; c++) {
                x[c * m->n_node + i] += w->newton_step[3 * i + c];
                w->position_m[c * m->n_node + i] = (double)x[c * m->n_node + i];
            }
    }
    for (size_t i = 0; i < n; i++)
        x_m[i] = (double)x[i];
    free(x);
    free(force);
    return (double)reached / m->reference_N;
}
