/* Form-finding of a case as `run` does it, to a true error of 1e-6 m and of 1e-12 m: nets of the other sections, and
 * nets of laws that the paper's iteration does not know, made from the shape that one of them has.
 *
 * Contents: nets of other laws - one net */
#include "bench.h"

#include <hifdm/problem.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ENOUGH_S 0.1
#define BASE "21x25 f=15"
#define EA_N 1e5
#define CUT_ERROR_M 0.5e-3 /* of elastic cables, standard deviation */
#define MIXED_ERROR_M 1e-3 /* the same for three laws side by side */
#define TIGHTEST 1e-13     /* residual over the reference tension, by which the reference is made */
#define TIGHTEST_M 1e-13   /* the same, of the attachments to a truss */

/* ---- nets of other laws ---- */

typedef enum { OWN, ELASTIC, CUT, MIXED } net_kind;

static double normal(unsigned *state) /* mean 0, variance 1; the same on every machine */
{
    double sum = 0;
    for (int i = 0; i < 12; i++) {
        *state = *state * 1664525u + 1013904223u;
        sum += (double)(*state >> 8) / 16777216.0;
    }
    return sum - 6;
}

static void write_cable(const bench_scene *b, int e, net_kind kind, unsigned *state, FILE *file)
{
    const hf_scene *s = &b->scene;
    double T = b->workspace.tension_N[e], length_m = b->workspace.length_m[e], l0_m = length_m / (1 + T / EA_N);
    double error_m = normal(state);
    hf_law law = kind == MIXED ? (hf_law[]){HF_LAW_TENSION, HF_LAW_LENGTH, HF_LAW_ELASTIC}[e % 3] : HF_LAW_ELASTIC;
    double value = law == HF_LAW_TENSION ? T : law == HF_LAW_LENGTH ? length_m + MIXED_ERROR_M * fabs(error_m) : l0_m;
    if (kind == CUT) value += CUT_ERROR_M * error_m;
    fprintf(file, "%s,%s,%s,%s,%s,%.17g,", s->cable_id[e], s->node_id[s->end[2 * e]], s->node_id[s->end[2 * e + 1]],
            hf_group_word[s->group[e]], hf_law_word[law], value);
    fprintf(file, law == HF_LAW_ELASTIC ? "%g\n" : "\n", EA_N);
}

/* The net of BASE in its found shape, each cable as long as it is there, but for errors of cutting. */
static void write_net(net_kind kind, const char *folder)
{
    bench_scene b;
    unsigned state = 7;
    bench_scene_named(BASE, folder, &b);
    FILE *file = bench_open_file(folder, "laws_nodes.csv");
    fputs("id,x_m,y_m,z_m,role\n", file);
    for (int i = 0; i < b.scene.n_node; i++) {
        const double *x = b.scene.position_m + 3 * i;
        fprintf(file, "%s,%.17g,%.17g,%.17g,%s\n", b.scene.node_id[i], x[0], x[1], x[2], hf_role_word[b.scene.role[i]]);
    }
    fclose(file);
    file = bench_open_file(folder, "laws_cables.csv");
    fputs("id,i,j,group,law,value,EA_N\n", file);
    for (int e = 0; e < b.scene.n_cable; e++)
        write_cable(&b, e, kind, &state, file);
    fclose(file);
    file = bench_open_file(folder, "laws.yaml");
    fputs("scene:\n  import:\n    nodes: laws_nodes.csv\n    cables: laws_cables.csv\nform: {stop: residual}\n", file);
    fclose(file);
    bench_scene_free(&b);
}

/* ---- one net ---- */

typedef struct {
    hf_problem *problem;
    hf_form_settings form;
    hf_form_result result;
} finding;

static void find(void *context)
{
    finding *f = context;
    hf_evaluate_form(&f->problem->model, &f->form, &f->problem->workspace, NULL, &f->result);
}

/* Emits time, steps and true error at the loosest residual tolerance, by half decades, whose error is small enough. */
static void to_error(finding *f, const char *name, const double *reference_m, double wanted_m)
{
    double error_m = INFINITY;
    for (double tolerance = 1e-2; tolerance > 0.9 * TIGHTEST; tolerance /= sqrt(10)) {
        f->form.residual_tolerance = tolerance;
        f->form.length_tolerance = fmin(tolerance, f->problem->settings.form.length_tolerance);
        f->form.coupling.tof_m = wanted_m / 10;
        find(f);
        if (f->result.status != HF_OK) continue;
        error_m = bench_distance_m(&f->problem->model, f->problem->workspace.position_m, reference_m);
        if (error_m <= wanted_m) break;
    }
    bench_emit("equilibrium", name, "auto", wanted_m, "error_m", error_m);
    if (!(error_m <= wanted_m)) return;
    bench_emit("equilibrium", name, "auto", wanted_m, "time_s", bench_time_s(find, f, ENOUGH_S));
    bench_emit("equilibrium", name, "auto", wanted_m, "steps", f->result.iterations);
    bench_emit("equilibrium", name, "auto", wanted_m, "n_slack", f->result.n_slack);
}

static const struct {
    const char *name, *path;
    net_kind kind;
    const char *set[4];
} net_table[] = {
    {"21x25 f=15", "configs/reflector.yaml", OWN, {"scene.parabolic_cylinder.focal_length_m=15"}},
    {"41x49 f=5",
     "configs/reflector.yaml",
     OWN,
     {"scene.parabolic_cylinder.focal_length_m=5", "scene.parabolic_cylinder.cells_per_module=[4,4]"}},
    {"on its truss",
     "configs/straight-edges-truss.yaml",
     OWN,
     {"scene.parabolic_cylinder.boundary=outer_edge", "scene.parabolic_cylinder.scallop=0.1"}},
    {"on a truss 300 times as soft",
     "configs/straight-edges-truss.yaml",
     OWN,
     {"scene.parabolic_cylinder.boundary=outer_edge", "scene.parabolic_cylinder.scallop=0.1", "truss.E_Pa=4.3e8"}},
    {"21x25 elastic", NULL, ELASTIC, {NULL}},
    {"21x25 elastic; cut with errors of 0.5 mm", NULL, CUT, {NULL}},
    {"21x25 tension; length and elastic", NULL, MIXED, {NULL}},
};

void bench_equilibrium(const char *name, const char *folder)
{
    size_t i = 0;
    while (i < sizeof net_table / sizeof *net_table && strcmp(name, net_table[i].name))
        i++;
    if (i == sizeof net_table / sizeof *net_table) bench_fail(name, "no such net");
    char path[HF_PATH_SIZE];
    snprintf(path, sizeof path, "%s/laws.yaml", folder);
    if (net_table[i].kind != OWN) write_net(net_table[i].kind, folder);
    const char *set[6] = {"form.method=auto", "form.stop=residual"};
    int n_set = 2;
    for (const char *const *more = net_table[i].set; n_set < 6 && *more; more++)
        set[n_set++] = *more;
    hf_problem problem;
    hf_messages messages = {0};
    if (hf_problem_open(net_table[i].path ? net_table[i].path : path, set, n_set, 1, &problem, &messages) != HF_OK)
        bench_fail(name, messages.text);
    finding f = {&problem, problem.settings.form, {0}};
    size_t n = 3 * (size_t)problem.model.n_node;
    double *reference_m = bench_alloc(n, sizeof *reference_m);
    f.form.residual_tolerance = TIGHTEST;
    f.form.length_tolerance = TIGHTEST;
    f.form.coupling.tof_m = TIGHTEST_M;
    find(&f);
    memcpy(reference_m, problem.workspace.position_m, n * sizeof *reference_m);
    bench_emit("equilibrium", name, "reference", 0, "error_m", f.result.position_error_m);
    to_error(&f, name, reference_m, 1e-6);
    to_error(&f, name, reference_m, 1e-12);
    free(reference_m);
    hf_messages_free(&messages);
    hf_problem_free(&problem);
}
