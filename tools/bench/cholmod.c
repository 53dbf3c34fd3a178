/* The peer CHOLMOD: supernodal or simplicial as it decides itself, analysis once per net. */
#include "bench.h"

#include <stdlib.h>
#include <string.h>

#ifdef HF_BENCH_CHOLMOD
#include <suitesparse/cholmod.h>

#define TEXT_(x) #x
#define TEXT(x) TEXT_(x)

struct bench_cholmod {
    cholmod_common common;
    cholmod_sparse *matrix; /* lower part */
    cholmod_factor *factor;
    cholmod_dense *b, *x, *y, *e;                /* reused between steps */
    int *diagonal_a, *diagonal_b, *off_diagonal; /* [n_cable] places in the values, -1 = not there */
};

/* Columns of the lower part: the diagonal first, then one entry per cable between free nodes. Two cables between the
 * same two nodes would get two entries of the same place: nets here have none. */
static void build_pattern(bench_cholmod *p, const hf_model *m)
{
    int n = m->n_free, *start = p->matrix->p, *row = p->matrix->i;
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        if (a < n && b < n) start[(a < b ? a : b) + 1]++;
    }
    for (int j = 0; j < n; j++)
        start[j + 1] += start[j] + 1;
    int *fill = bench_alloc((size_t)n, sizeof *fill);
    for (int j = 0; j < n; j++) {
        row[start[j]] = j;
        fill[j] = start[j] + 1;
    }
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1], low = a < b ? a : b, high = a < b ? b : a;
        p->diagonal_a[e] = a < n ? start[a] : -1;
        p->diagonal_b[e] = b < n ? start[b] : -1;
        p->off_diagonal[e] = high < n ? fill[low]++ : -1;
        if (high < n) row[p->off_diagonal[e]] = high;
    }
    free(fill);
}

static void fill_values(bench_cholmod *p, const hf_model *m, const double *q)
{
    double *value = p->matrix->x;
    memset(value, 0, p->matrix->nzmax * sizeof *value);
    for (int e = 0; e < m->n_cable; e++) {
        if (p->diagonal_a[e] >= 0) value[p->diagonal_a[e]] += q[e];
        if (p->diagonal_b[e] >= 0) value[p->diagonal_b[e]] += q[e];
        if (p->off_diagonal[e] >= 0) value[p->off_diagonal[e]] -= q[e];
    }
}

bench_cholmod *bench_cholmod_create(const hf_model *m)
{
    bench_cholmod *p = bench_alloc(1, sizeof *p);
    size_t n = (size_t)m->n_free, n_cable = (size_t)m->n_cable;
    p->diagonal_a = bench_alloc(n_cable, sizeof(int));
    p->diagonal_b = bench_alloc(n_cable, sizeof(int));
    p->off_diagonal = bench_alloc(n_cable, sizeof(int));
    cholmod_start(&p->common);
    size_t n_entry = n;
    for (int e = 0; e < m->n_cable; e++)
        n_entry += m->end_row[2 * e] < m->n_free && m->end_row[2 * e + 1] < m->n_free;
    p->matrix = cholmod_allocate_sparse(n, n, n_entry, 0, 1, -1, CHOLMOD_REAL, &p->common);
    memset(p->matrix->p, 0, (n + 1) * sizeof(int));
    build_pattern(p, m);
    fill_values(p, m, m->start_q_N_per_m);
    p->factor = cholmod_analyze(p->matrix, &p->common);
    p->b = cholmod_zeros(n, 3, CHOLMOD_REAL, &p->common);
    return p;
}

int bench_cholmod_step(bench_cholmod *p, const hf_model *m, hf_workspace *w)
{
    size_t n = (size_t)m->n_free;
    fill_values(p, m, w->q_N_per_m);
    hf_form_assemble_loads(m, w);
    for (size_t c = 0; c < 3; c++)
        memcpy((double *)p->b->x + c * n, w->position_m + c * (size_t)m->n_node, n * sizeof(double));
    if (!cholmod_factorize(p->matrix, p->factor, &p->common) || p->common.status != CHOLMOD_OK) return 1;
    if (!cholmod_solve2(CHOLMOD_A, p->factor, p->b, NULL, &p->x, NULL, &p->y, &p->e, &p->common)) return 1;
    for (size_t c = 0; c < 3; c++)
        memcpy(w->position_m + c * (size_t)m->n_node, (double *)p->x->x + c * n, n * sizeof(double));
    return 0;
}

double bench_cholmod_bytes(const bench_cholmod *p)
{
    const cholmod_factor *f = p->factor;
    double matrix = (double)p->matrix->nzmax * 12, values = (double)(f->is_super ? f->xsize : f->nzmax);
    return matrix + 8 * values + 4 * (double)(f->is_super ? f->ssize : f->nzmax);
}

void bench_cholmod_free(bench_cholmod *p)
{
    if (!p) return;
    cholmod_free_dense(&p->b, &p->common);
    cholmod_free_dense(&p->x, &p->common);
    cholmod_free_dense(&p->y, &p->common);
    cholmod_free_dense(&p->e, &p->common);
    cholmod_free_factor(&p->factor, &p->common);
    cholmod_free_sparse(&p->matrix, &p->common);
    cholmod_finish(&p->common);
    free(p->diagonal_a);
    free(p->diagonal_b);
    free(p->off_diagonal);
    free(p);
}

const char *bench_cholmod_version(void)
{
    return TEXT(CHOLMOD_MAIN_VERSION) "." TEXT(CHOLMOD_SUB_VERSION) "." TEXT(CHOLMOD_SUBSUB_VERSION);
}

#else

bench_cholmod *bench_cholmod_create(const hf_model *m)
{
    (void)m;
    return NULL;
}

int bench_cholmod_step(bench_cholmod *p, const hf_model *m, hf_workspace *w)
{
    (void)p, (void)m, (void)w;
    return 1;
}

double bench_cholmod_bytes(const bench_cholmod *p)
{
    (void)p;
    return 0;
}

void bench_cholmod_free(bench_cholmod *p)
{
    (void)p;
}

const char *bench_cholmod_version(void)
{
    return "not there";
}
#endif
