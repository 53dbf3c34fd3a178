/* own_optimiser - an optimiser of your own on libhifdm: a random search around the initial design.
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
#include <string.h>

#define N_DESIGN 64 /* evaluated at a time, on all cores */
#define N_ROUND 30

/* All zero at first, so that main can free it after any error. */
typedef struct {
    hf_messages said; /* errors and warnings */
    hf_problem p;
    double *best_N, *design; /* [n_variable], [N_DESIGN][n_variable] */
    double *step;            /* [n_variable_group] */
} thing;

/* Returns a random number from -1 to 1 (splitmix64). */
static double uniform(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
}

static hf_status search(const char *path, thing *t)
{
    hf_form_result result[N_DESIGN];
    HF_TRY(hf_problem_open(path, NULL, 0, 0, &t->p, &t->said)); /* NULL, 0: no overrides; 0: all cores */
    const hf_model *m = &t->p.model;
    size_t n = (size_t)m->n_variable; /* variable k is the pretension of cable p.scene.cable_id[m->variable_cable[k]] */

    t->best_N = calloc(n + 1, sizeof(double));
    t->design = calloc(N_DESIGN * n + 1, sizeof(double));
    t->step = calloc((size_t)m->n_variable_group + 1, sizeof(double));
    if (!t->best_N || !t->design || !t->step) return HF_NO_MEMORY;
    memcpy(t->best_N, t->p.initial, n * sizeof(double)); /* the pretensions of the shape that was found */

    uint64_t state = 1;
    double size = 0.2, best_m = INFINITY;
    for (int round = 0; round < N_ROUND; round++) {
        for (int i = 0; i < N_DESIGN; i++) {
            for (int g = 0; g < m->n_variable_group; g++) /* the first design of a round is the best so far */
                t->step[g] = i ? size * uniform(&state) : 0;
            for (size_t k = 0; k < n; k++) /* unequal changes in a chain push its nodes along it */
                t->design[(size_t)i * n + k] = t->best_N[k] * (1 + t->step[m->variable_group[k]]);
        }
        hf_batch_run(&t->p.batch, N_DESIGN, t->design, NULL, result); /* -> result[i].psi_m, .status, ... */
        int best = 0;
        for (int i = 1; i < N_DESIGN; i++)
            if (result[i].status == HF_OK && !(result[i].psi_m >= result[best].psi_m)) best = i;
        if (best == 0 && round > 0) size /= 2;
        for (size_t k = 0; k < n; k++)
            t->best_N[k] = t->design[(size_t)best * n + k];
        best_m = result[best].psi_m;
        if (round % 10 == 0) printf("round %2d: psi %.4f mm\n", round, best_m * 1e3);
    }
    printf("psi %.4f mm, from %.4f mm after form-finding, in %d designs of %zu cables\n", best_m * 1e3,
           t->p.form.psi_m * 1e3, N_ROUND * N_DESIGN, n);
    return HF_OK;
}

int main(int argc, char **argv)
{
    thing t = {0};
    hf_batch_wait_quietly(argv);
    if (argc != 2) {
        fprintf(stderr, "usage: %s CASE\n", argv[0]);
        return 2;
    }
    hf_status status = search(argv[1], &t);
    if (t.said.text) fputs(t.said.text, stderr);
    if (status != HF_OK) fprintf(stderr, "%s: %s\n", argv[1], hf_status_text(status));
    free(t.design);
    free(t.best_N);
    free(t.step);
    hf_problem_free(&t.p);
    hf_messages_free(&t.said);
    return hf_status_exit_code(status);
}
