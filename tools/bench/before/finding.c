/* Form-finding of one case, by the library of today or of an old commit: compiled once with each (../before.py).
 *
 * finding reference FILE CASE [KEY=VALUE...]: writes the shape of the tightest tolerance, by nodes of the scene.
 * finding measure FILE CASE [KEY=VALUE...]: lines "wanted_m, steps, processor seconds, error_m, slack cables, status",
 * with tabs between, at the loosest tolerance by half decades whose shape is that near to the shape in FILE.
 *
 * Contents: a case by either library - shapes - measuring */
#include <hifdm/hifdm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define TIGHTEST 1e-13
#define ENOUGH_S 0.1
#define HOPELESS_S 1.0 /* a form-finding that takes this long and fails is not tried at a tighter tolerance */

static void fail(const char *what, const char *why)
{
    fprintf(stderr, "finding: %s: %s\n", what, why);
    exit(1);
}

/* ---- a case by either library ---- */

#if __has_include(<hifdm/problem.h>)
#include <hifdm/problem.h>

static void open_case(const char *path, const char *const *set, int n_set, hf_problem *p, hf_messages *messages)
{
    hf_problem_open(path, set, n_set, 1, p, messages); /* what has no shape is opened all the same */
    if (!p->workspace.position_m) fail(path, messages->text);
}
#else
typedef struct {
    hf_case settings;
    hf_scene scene;
    hf_carrier carrier;
    hf_model model;
    hf_workspace workspace;
} hf_problem;

static hf_status open_truss(hf_problem *p, hf_messages *messages)
{
    const hf_carrier *c = &p->carrier;
    if (!p->settings.has_truss) return HF_OK;
    hf_status status = hf_carrier_build(&p->settings, &p->scene, &p->carrier, messages);
    if (status != HF_OK) return status;
    return hf_model_attach(&p->model, c->n_attachment, c->scene_node, c->flexibility_m_per_N, messages);
}

static void open_case(const char *path, const char *const *set, int n_set, hf_problem *p, hf_messages *messages)
{
    if (hf_config_load(path, set, n_set, &p->settings, messages) != HF_OK ||
        hf_config_scene(&p->settings, &p->scene, messages) != HF_OK ||
        hf_model_build(&p->scene, &p->settings.form, &p->model, messages) != HF_OK ||
        open_truss(p, messages) != HF_OK || hf_workspace_create(&p->model, &p->workspace) != HF_OK)
        fail(path, messages->text);
}
#endif

static hf_status find(hf_problem *p, double tolerance, double wanted_m, hf_form_result *result)
{
    hf_form_settings form = p->settings.form;
    form.residual_tolerance = tolerance;
    form.length_tolerance = fmin(tolerance, form.length_tolerance);
    form.coupling.tof_m = wanted_m / 10;
    return hf_evaluate_form(&p->model, &form, &p->workspace, NULL, result);
}

/* ---- shapes ---- */

static void write_shape(const hf_problem *p, FILE *file)
{
    for (int i = 0; i < p->model.n_node; i++)
        for (int c = 0; c < 3; c++)
            fprintf(file, "%.17g\n", p->workspace.position_m[c * p->model.n_node + p->model.row_of_node[i]]);
}

/* Largest distance of a node to its place in the file; infinite when there is no shape. */
static double error_m(const hf_problem *p, FILE *file)
{
    double largest_m = 0;
    rewind(file);
    for (int i = 0; i < p->model.n_node; i++) {
        double square = 0;
        for (int c = 0; c < 3; c++) {
            double there_m;
            if (fscanf(file, "%lf", &there_m) != 1) fail("reference", "too short");
            double d = p->workspace.position_m[c * p->model.n_node + p->model.row_of_node[i]] - there_m;
            square += d * d;
        }
        if (!(square <= largest_m)) largest_m = square;
    }
    return isfinite(largest_m) ? sqrt(largest_m) : (double)INFINITY;
}

/* ---- measuring ---- */

static double processor_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void measure(hf_problem *p, double wanted_m, FILE *reference)
{
    hf_form_result r;
    double tolerance = 1e-2, reached_m = INFINITY, start_s = processor_s();
    for (;; tolerance /= sqrt(10)) {
        double one_s = processor_s();
        bool has_shape = find(p, tolerance, wanted_m, &r) == HF_OK;
        if (has_shape) reached_m = error_m(p, reference);
        if (has_shape && reached_m <= wanted_m) break;
        if (tolerance < 2 * TIGHTEST || (!has_shape && processor_s() - one_s > HOPELESS_S)) break;
    }
    long n = 0;
    start_s = processor_s();
    double passed_s = 0;
    for (; passed_s < ENOUGH_S; n++, passed_s = processor_s() - start_s)
        find(p, tolerance, wanted_m, &r);
    const char *status = r.status == HF_OK && !(reached_m <= wanted_m) ? "not that near" : hf_status_text(r.status);
    printf("%g\t%d\t%.9g\t%.9g\t%d\t%s\n", wanted_m, r.iterations, passed_s / (double)n,
           r.status == HF_OK ? reached_m : (double)NAN, r.n_slack, status);
}

int main(int argc, char **argv)
{
    if (argc < 4) fail("usage", "finding reference|measure FILE CASE [KEY=VALUE...]");
    bool writes = !strcmp(argv[1], "reference");
    static hf_problem problem;
    hf_messages messages = {0};
    hf_form_result result;
    FILE *file = fopen(argv[2], writes ? "w" : "r");
    if (!file) fail(argv[2], "cannot be opened");
    open_case(argv[3], (const char *const *)(argv + 4), argc - 4, &problem, &messages);
    if (writes) {
        find(&problem, TIGHTEST, 10 * TIGHTEST, &result);
        write_shape(&problem, file);
        printf("%s\n", hf_status_text(result.status));
    } else {
        measure(&problem, 1e-6, file);
        measure(&problem, 1e-12, file);
    }
    fclose(file);
    return 0;
}
