/* Ruze's formula beside physical optics (METHOD section 13): 30 generated dishes and cylinders with facets of several
 * sizes, deflected by heat and by moved rims, and as built with errors of cut lengths, up to 1 dB of loss. Prints a
 * line for each net and writes each shape to antenna.csv. */
#include "bench.h"

#include "surface/antenna.h"
#include "surface/facet_mesh.h"
#include <hifdm/built.h>
#include <hifdm/problem.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LOSS_MOST_DB 1.0
#define WARNED_DB 0.1 /* difference of losses that a run reports (RUZE_OFF_DB in run/stages_measure.c) */
#define N_CASE 30
#define N_SAMPLE 4
#define FACET_LOSSES 4 /* frequencies of each net, by the loss of its facets at the target positions */

static const double facet_loss_dB[FACET_LOSSES] = {0.02, 0.1, 0.3, 0.7};

typedef struct {
    hf_problem problem;
    hf_built built;
    hf_workspace work;
    double *target_m, *cut_m, *move_m; /* [n_node][3], [n_cable], [3][n_node] */
    FILE *csv;
    int row;
    int n[2];        /* shapes with a loss up to LOSS_MOST_DB; refocused, fixed */
    double worst[2]; /* largest difference of Ruze's loss, dB, with its sign */
    double mean[2];  /* sum of the sizes of the differences */
} antenna_bench;

/* ---- nets ---- */

/* Writes the case of net k, of 18 dishes and 12 cylinders. */
static void write_case(int k, FILE *f)
{
    static const char *const pattern[] = {"triangle", "quad", "diagonal"};
    fputs("scene:\n  EA_inner_N: 2e4\n  EA_boundary_N: 2e4\n", f);
    if (k < 18) {
        double offset_m = k % 3 == 0 ? 0 : k % 3 == 1 ? 3 : 5.5, focal_m = k / 3 % 2 ? 4.8 : 6.4;
        fprintf(f,
                "  paraboloid: {aperture_m: 8, focal_length_m: %g, offset_m: %g, rings: %d, rear_distance_m: 1.8}\n"
                "form: {pretension_N: 30, prestress: exact}\nsurface: {frequencies_Hz: [1e9]}\n",
                focal_m, offset_m, 4 + 2 * (k / 6) + k % 3);
    } else {
        k -= 18;
        fprintf(f,
                "  parabolic_cylinder: {aperture_m: 8, length_m: 6, focal_length_m: %g, modules: [1, 1], "
                "cells_per_module: [%d, %d], pattern: %s, supports: perimeter, rear_distance_m: 2.5, "
                "tie_direction: z}\n"
                "form: {pretension_N: 30, prestress: exact}\nsurface: {frequencies_Hz: [1e9]}\n",
                k % 2 ? 4.0 : 6.0, 8 + 2 * (k / 3), 4 + 2 * (k / 3), pattern[k % 3]);
    }
}

static void open_net(int k, const char *folder, antenna_bench *b)
{
    hf_messages messages = {0};
    char path[512];
    FILE *f = bench_open_file(folder, "antenna.yaml");
    write_case(k, f);
    fclose(f);
    snprintf(path, sizeof path, "%s/antenna.yaml", folder);
    hf_problem *p = &b->problem;
    if (hf_problem_open(path, NULL, 0, 1, p, &messages) != HF_OK ||
        hf_built_make(path, &p->scene, &p->model, &p->settings.form, &p->workspace, &b->built, &messages) != HF_OK ||
        hf_workspace_create(&b->built.model, &b->work) != HF_OK || p->facets.n_facet == 0)
        bench_fail("antenna", messages.text ? messages.text : "a net without facets");
    hf_messages_free(&messages);
    b->target_m = bench_alloc(3 * (size_t)p->model.n_node, sizeof(double));
    b->move_m = bench_alloc(3 * (size_t)p->model.n_node, sizeof(double));
    b->cut_m = bench_alloc((size_t)p->model.n_cable, sizeof(double));
    hf_model_positions(&p->model, p->model.position_m, b->target_m);
}

static void close_net(antenna_bench *b)
{
    free(b->target_m);
    free(b->move_m);
    free(b->cut_m);
    hf_workspace_free(&b->work);
    hf_built_free(&b->built);
    hf_problem_free(&b->problem);
}

/* ---- shapes ---- */

static double normal(unsigned *state) /* mean 0, variance 1; the same on every machine */
{
    double sum = 0;
    for (int i = 0; i < 12; i++) {
        *state = *state * 1664525u + 1013904223u;
        sum += (double)(*state >> 8) / 16777216.0;
    }
    return sum - 6;
}

typedef enum { NOMINAL, HEAT, RIM, BUILT, N_KIND } shape_kind;
static const char *const kind_word[N_KIND] = {"nominal", "heat", "rim", "built"};

/* Solves the net with an error: all cables longer by this part, a rim bent into a saddle by this height, or cut lengths
 * with this standard deviation. Returns false if there is no shape. */
static bool solve(antenna_bench *b, shape_kind kind, double size, unsigned *state)
{
    const hf_model *m = &b->built.model;
    hf_form_result r;
    for (int e = 0; e < m->n_cable; e++)
        b->cut_m[e] = m->target[e] * (kind == HEAT ? 1 + size : 1) + (kind == BUILT ? size * normal(state) : 0);
    memset(b->move_m, 0, 3 * (size_t)m->n_node * sizeof *b->move_m);
    for (int i = 0; i < m->n_node && kind == RIM; i++)
        b->move_m[2 * m->n_node + i] = size * (m->position_m[i] / 8 - m->position_m[m->n_node + i] / 4);
    const hf_built_net net = {.cut_m = b->cut_m, .support_displacement_m = b->move_m};
    return hf_built_solve(&b->built, &net, &b->work, &r) == HF_OK && r.n_loose == 0;
}

/* Notes the difference of Ruze's loss from that by physical optics. Returns the smaller of both losses. */
static double note(antenna_bench *b, shape_kind kind, double frequency_Hz, double size)
{
    const hf_problem *p = &b->problem;
    hf_facet_shape shape = {0};
    hf_antenna antenna;
    hf_antenna_figures is;
    if (hf_facet_shape_take(&b->built.model, b->work.position_m, b->work.tension_N, &shape) != HF_OK ||
        hf_antenna_make(&p->surface, &p->facets, b->target_m, frequency_Hz, &antenna) != HF_OK)
        bench_fail("antenna", "out of memory");
    double *scratch = NULL;
    void *block = NULL;
    const hf_pattern_surface surface = {&p->facets, shape.position_m, NULL};
    if (HF_ARENA_ARRAYS(&block, HF_ARRAY(scratch, hf_antenna_scratch(&antenna))) != HF_OK ||
        hf_antenna_measure(&antenna, HF_ANTENNA_ALL, &surface, scratch, &is) != HF_OK)
        bench_fail("antenna", "out of memory");
    const hf_antenna_feed *feed[2] = {&is.refocused, &is.fixed};
    fprintf(b->csv, "%d,%d,%s,%.6g,%.6g", b->row, p->facets.n_facet, kind_word[kind], frequency_Hz / 1e9, size);
    for (int k = 0; k < 2; k++) {
        double difference_dB = feed[k]->ruze_loss_dB - feed[k]->gain_loss_dB;
        fprintf(b->csv, ",%.6f,%.6f", feed[k]->gain_loss_dB, feed[k]->ruze_loss_dB);
        if (!(feed[k]->gain_loss_dB <= LOSS_MOST_DB)) continue;
        b->n[k]++;
        b->mean[k] += fabs(difference_dB);
        if (!(fabs(difference_dB) <= fabs(b->worst[k]))) b->worst[k] = difference_dB;
    }
    fprintf(b->csv, ",%.6f\n", is.pointing_deg);
    hf_arena_free_block(block);
    hf_antenna_free(&antenna);
    hf_arena_free_block(shape.block);
    return fmin(is.refocused.gain_loss_dB, is.fixed.gain_loss_dB);
}

static void measure_net(antenna_bench *b)
{
    static const double first[N_KIND] = {0, 1e-6, 1e-4, 5e-6}; /* smallest errors; each next one is twice as large */
    static const int steps[N_KIND] = {1, 14, 8, 14}; /* a rim moves by at most 13 mm, heat stretches by 0.8 % */
    unsigned state = 33 + (unsigned)b->row;
    const hf_problem *p = &b->problem;
    hf_surface_measures m;
    if (hf_surface_measure(&p->surface, &p->facets, &p->model, p->workspace.position_m, p->workspace.tension_N, &m) !=
        HF_OK)
        bench_fail("antenna", "out of memory");
    for (int k = 0; k < FACET_LOSSES; k++) {
        double frequency_Hz = hf_surface_frequency_of_loss_Hz(m.refocused_half_path_rms_m, facet_loss_dB[k]);
        for (int kind = 0; kind < N_KIND; kind++)
            for (int sample = 0; sample < (kind == BUILT ? N_SAMPLE : 1); sample++) {
                double size = first[kind];
                for (int step = 0; step < steps[kind] && solve(b, (shape_kind)kind, size, &state); step++, size *= 2)
                    if (!(note(b, (shape_kind)kind, frequency_Hz, size) < LOSS_MOST_DB) || kind == NOMINAL) break;
            }
    }
}

void bench_antenna(const char *what, const char *folder)
{
    (void)what;
    antenna_bench b = {.csv = bench_open_file(folder, "antenna.csv")};
    fputs("net,facets,shape,frequency_GHz,size,refocused_dB,refocused_ruze_dB,fixed_dB,fixed_ruze_dB,pointing_deg\n",
          b.csv);
    printf("net facets  refocused: shapes  mean  worst dB   fixed: shapes  mean  worst dB\n");
    for (b.row = 0; b.row < N_CASE; b.row++) {
        memset(b.n, 0, sizeof b.n);
        memset(b.worst, 0, sizeof b.worst);
        memset(b.mean, 0, sizeof b.mean);
        open_net(b.row, folder, &b);
        measure_net(&b);
        bool is_off = fmax(fabs(b.worst[0]), fabs(b.worst[1])) > WARNED_DB;
        printf("%3d %6d %18d %6.3f %8.3f %14d %6.3f %8.3f%s\n", b.row, b.problem.facets.n_facet, b.n[0],
               b.mean[0] / b.n[0], b.worst[0], b.n[1], b.mean[1] / b.n[1], b.worst[1],
               is_off ? "  a run of this shape warns of the difference" : "");
        fflush(stdout);
        close_net(&b);
    }
    fclose(b.csv);
}
