#include "solve/schur.h"

#include "base/arena.h"
#include "linalg/dot.h"
#include "solve/newton_matrix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* LAPACK and BLAS (Fortran interface) */
void dgetrf_(const int *m, const int *n, double *a, const int *lda, int *pivot, int *info);
void dgetrs_(const char *trans, const int *n, const int *n_rhs, const double *a, const int *lda, const int *pivot,
             double *b, const int *ldb, int *info);
void dgemm_(const char *trans_a, const char *trans_b, const int *m, const int *n, const int *k, const double *alpha,
            const double *a, const int *lda, const double *b, const int *ldb, const double *beta, double *c,
            const int *ldc);

/* Goes through F by columns. F is symmetric, so they are its rows. */
void hf_schur_flex(const hf_model *m, const double *force, double *r)
{
    size_t n = (size_t)(3 * m->n_attachment);
    memset(r, 0, n * sizeof *r);
    for (size_t j = 0; j < n; j++) {
        const double *column = m->flexibility_m_per_N + j * n;
        for (size_t i = 0; i < n; i++)
            r[i] += column[i] * force[j];
    }
}

static void lay_out_schur(hf_arena *arena, const hf_model *m, hf_schur *s)
{
    size_t n = (size_t)s->n;
    s->stiffness = hf_arena_take(arena, n * n, sizeof(double));
    s->flexed = hf_arena_take(arena, n * n, sizeof(double));
    s->factor = hf_arena_take(arena, n * n, sizeof(double));
    s->column = hf_arena_take(arena, 3 * (size_t)m->n_free + n, sizeof(double));
    s->pivot = hf_arena_take(arena, n, sizeof(int));
}

hf_status hf_schur_create(const hf_model *m, hf_schur *schur)
{
    *schur = (hf_schur){.n = 3 * m->n_attachment};
    hf_arena arena = {0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out_schur(&arena, m, schur)));
    schur->block = arena.block;
    return HF_OK;
}

void hf_schur_free(hf_schur *schur)
{
    free(schur->block);
    *schur = (hf_schur){0};
}

void hf_schur_push(const hf_model *m, const hf_workspace *w, const double *displacement_m, double *force)
{
    double block[3][3];
    for (int k = 0; k < m->n_tie; k++) {
        int there = m->end_row[m->tie[k] ^ 1];
        const double *r = displacement_m + 3 * m->tie_attachment[k];
        if (there >= m->n_free) continue;
        hf_newton_matrix_block(m, w, m->tie[k] / 2, block);
        for (int c = 0; c < 3; c++)
            force[3 * there + c] += block[c][0] * r[0] + block[c][1] * r[1] + block[c][2] * r[2];
    }
}

void hf_schur_pull(const hf_model *m, const hf_workspace *w, const double *step_m, double *pull)
{
    double block[3][3];
    for (int k = 0; k < m->n_tie; k++) {
        int there = m->end_row[m->tie[k] ^ 1];
        const double *d = step_m + 3 * there;
        if (there >= m->n_free) continue;
        hf_newton_matrix_block(m, w, m->tie[k] / 2, block);
        for (int c = 0; c < 3; c++)
            pull[3 * m->tie_attachment[k] + c] += block[c][0] * d[0] + block[c][1] * d[1] + block[c][2] * d[2];
    }
}

/* Adds H_aa to the stiffness: cables from attachments to free nodes, fixed supports and other attachments. */
static void add_attachment_stiffness(const hf_model *m, const hf_workspace *w, hf_schur *s)
{
    double block[3][3];
    size_t n = (size_t)s->n;
    for (int k = 0; k < m->n_tie; k++) {
        int partner = k > 0 && m->tie[k - 1] == (m->tie[k] ^ 1) ? k - 1 : k + 1;
        bool is_pair = partner < m->n_tie && m->tie[partner] == (m->tie[k] ^ 1);
        size_t here = 3 * (size_t)m->tie_attachment[k];
        hf_newton_matrix_block(m, w, m->tie[k] / 2, block);
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c < 3; c++) {
                s->stiffness[(here + r) * n + here + c] += block[r][c];
                if (is_pair) s->stiffness[(here + r) * n + 3 * (size_t)m->tie_attachment[partner] + c] -= block[r][c];
            }
    }
}

hf_status hf_schur_factor(const hf_model *m, const hf_workspace *w, hf_schur *s)
{
    size_t n = (size_t)s->n, n_dof = 3 * (size_t)m->n_free;
    double *unit = s->column + n_dof, one = 1, zero = 0;
    int info = 0;
    memset(s->stiffness, 0, n * n * sizeof(double));
    memset(unit, 0, n * sizeof(double));
    for (size_t j = 0; j < n; j++) { /* row j of - H_af H_ff^-1 H_fa */
        memset(s->column, 0, n_dof * sizeof(double));
        unit[j] = 1;
        hf_schur_push(m, w, unit, s->column);
        unit[j] = 0;
        hf_newton_matrix_solve(m, w, s->column);
        hf_schur_pull(m, w, s->column, s->stiffness + j * n);
        for (size_t i = 0; i < n; i++)
            s->stiffness[j * n + i] = -s->stiffness[j * n + i];
    }
    add_attachment_stiffness(m, w, s);
    dgemm_("N", "N", &s->n, &s->n, &s->n, &one, m->flexibility_m_per_N, &s->n, s->stiffness, &s->n, &zero, s->flexed,
           &s->n);
    memcpy(s->factor, s->flexed, n * n * sizeof(double));
    for (size_t i = 0; i < n; i++)
        s->factor[i * n + i] += 1;
    dgetrf_(&s->n, &s->n, s->factor, &s->n, s->pivot, &info);
    return info == 0 ? HF_OK : HF_SINGULAR;
}

void hf_schur_solve(const hf_schur *s, double *b)
{
    int one = 1, info = 0;
    dgetrs_("N", &s->n, &one, s->factor, &s->n, s->pivot, b, &s->n, &info);
}

void hf_schur_displace(const hf_model *m, const hf_schur *s, const double *b, double *displacement_m)
{
    hf_schur_flex(m, b, displacement_m);
    hf_schur_solve(s, displacement_m);
}

/* Cross approximation of A = (I + F S)^-1 - I. The longest column of A, scaled to length 1, is `left`; the products of
 * all columns with it are `right`; left right' is subtracted from A before the next mode. */
int hf_schur_modes(hf_schur *s, double tolerance, int max_mode, double *mode)
{
    size_t n = (size_t)s->n;
    double *a = s->flexed;
    int info = 0, n_mode = 0;
    dgetrs_("N", &s->n, &s->n, s->factor, &s->n, s->pivot, a, &s->n, &info);
    for (size_t i = 0; i < n * n; i++)
        a[i] = -a[i];
    for (; n_mode < max_mode; n_mode++, mode += 2 * n) {
        double total = 0, longest = 0;
        size_t pivot = 0;
        for (size_t j = 0; j < n; j++) {
            double square = hf_dot(n, a + j * n, a + j * n);
            total += square;
            if (square > longest) longest = square, pivot = j;
        }
        if (!(sqrt(total) > tolerance)) break;
        for (size_t i = 0; i < n; i++)
            mode[i] = a[pivot * n + i] / sqrt(longest);
        for (size_t j = 0; j < n; j++) {
            double share = mode[n + j] = hf_dot(n, mode, a + j * n);
            for (size_t i = 0; i < n; i++)
                a[j * n + i] -= share * mode[i];
        }
    }
    return n_mode;
}
