/* own_optimiser - an optimiser of your own on libhifdm: a random search around the tensions after form-finding.
 *
 *     cc -std=c11 tools/own_optimiser.c $(pkg-config --cflags --libs hifdm) -o own_optimiser
 *     ./own_optimiser configs/chen2022.yaml
 *
 * Under a prefix that is not the system's, PKG_CONFIG_PATH=PREFIX/lib/pkgconfig in front of the first line, and
 * LD_LIBRARY_PATH=PREFIX/lib in front of the second. */
#include <hifdm/hifdm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define N_DESIGN 64 /* evaluated at a time, on all cores */
#define N_ROUND 30

/* Zero at first; whatever was made can be freed, whatever went wrong. */
typedef struct {
    hf_messages said; /* errors and warnings, in words */
    hf_case c;
    hf_scene scene;
    hf_carrier carrier;
    hf_model m;
    hf_workspace w;
    hf_batch batch;
    double *best_N, *design_N; /* [n_gene], [N_DESIGN][n_gene] */
    double *step;              /* [n_gene_group] */
} thing;

/* -1 to 1: splitmix64 */
static double uniform(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
}

static hf_status search(const char *path, thing *t)
{
    hf_form_result form, result[N_DESIGN];
    HF_TRY(hf_config_load(path, NULL, 0, &t->c, &t->said));
    HF_TRY(hf_config_scene(&t->c, &t->scene, &t->said));
    HF_TRY(hf_model_build(&t->scene, &t->c.form, &t->m, &t->said));
    if (t->c.has_truss) { /* that gives way under the net */
        const hf_carrier *r = &t->carrier;
        HF_TRY(hf_config_carrier(&t->c, &t->scene, &t->carrier, &t->said));
        HF_TRY(hf_model_attach(&t->m, r->n_attachment, r->scene_node, r->flexibility_m_per_N, &t->said));
    }
    HF_TRY(hf_workspace_create(&t->m, &t->w));
    HF_TRY(hf_evaluate_form(&t->m, &t->c.form, &t->w, NULL, &form)); /* t->w now holds the shape */

    size_t n = (size_t)t->m.n_gene;
    t->best_N = calloc(n, sizeof(double));
    t->design_N = calloc(N_DESIGN * n, sizeof(double));
    t->step = calloc((size_t)t->m.n_gene_group, sizeof(double));
    if (!t->best_N || !t->design_N || !t->step) return HF_NO_MEMORY;
    for (size_t k = 0; k < n; k++) /* pretension of the cable scene.cable_id[m.gene_cable[k]] */
        t->best_N[k] = t->w.tension_N[t->m.gene_cable[k]];

    hf_evaluator v = {.model = &t->m,
                      .form = &t->c.form,
                      .start_q_N_per_m = t->w.q_N_per_m,
                      .rule = t->c.optimize.rule,
                      .solver = t->c.optimize.solver,
                      .boundary_ratio_cap = t->c.optimize.boundary_ratio_cap};
    HF_TRY(hf_batch_create(&v, 0, &t->batch)); /* 0: all cores */
    hf_batch_share(&t->batch, t->best_N);

    uint64_t state = 1;
    double size = 0.2, best_m = INFINITY;
    for (int round = 0; round < N_ROUND; round++) {
        for (int i = 0; i < N_DESIGN; i++) {
            for (int g = 0; g < t->m.n_gene_group; g++) /* the first design of a round is the best so far */
                t->step[g] = i ? size * uniform(&state) : 0;
            for (size_t k = 0; k < n; k++) /* cables of a chain change alike, else they drag its nodes along it */
                t->design_N[(size_t)i * n + k] = t->best_N[k] * (1 + t->step[t->m.gene_group[k]]);
        }
        hf_batch_run(&t->batch, N_DESIGN, t->design_N, NULL, result); /* -> result[i].psi_m, .status, ... */
        int best = 0;
        for (int i = 1; i < N_DESIGN; i++)
            if (result[i].status == HF_OK && !(result[i].psi_m >= result[best].psi_m)) best = i;
        if (best == 0 && round > 0) size /= 2;
        for (size_t k = 0; k < n; k++)
            t->best_N[k] = t->design_N[(size_t)best * n + k];
        best_m = result[best].psi_m;
        if (round % 10 == 0) printf("round %2d: psi %.4f mm\n", round, best_m * 1e3);
    }
    printf("psi %.4f mm, from %.4f mm after form-finding, in %d designs of %zu cables\n", best_m * 1e3,
           form.psi_m * 1e3, N_ROUND * N_DESIGN, n);
    return HF_OK;
}

int main(int argc, char **argv)
{
    thing t = {0};
    if (argc != 2) {
        fprintf(stderr, "usage: %s CASE\n", argv[0]);
        return 2;
    }
    hf_status status = search(argv[1], &t);
    if (t.said.text) fputs(t.said.text, stderr);
    if (status != HF_OK) fprintf(stderr, "%s: %s\n", argv[1], hf_status_text(status));
    hf_batch_free(&t.batch);
    free(t.design_N);
    free(t.best_N);
    free(t.step);
    hf_workspace_free(&t.w);
    hf_model_free(&t.m);
    hf_carrier_free(&t.carrier);
    hf_scene_free(&t.scene);
    hf_case_free(&t.c);
    hf_messages_free(&t.said);
    return hf_status_exit_code(status);
}
