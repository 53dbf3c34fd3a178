/* Condenses the Newton matrix of the net to the attachments of its truss (METHOD section 8).
 *
 *     factor of H_ff, blocks of the cables at attachments
 *         | H_ff^-1 H_fa, HF_SCHUR_PANEL attachments at a time
 *         v
 *     S = H_aa - H_af H_ff^-1 H_fa   (M15)
 *         | F S, then the LU factor of I + F S
 *         v
 *     hf_schur_solve, hf_schur_displace: steps of the attachments
 *     hf_schur_modes: (I + F S)^-1 as I plus a few modes, for the lanes of the population solver */
#include "solve/schur.h"

#include "linalg/dense.h"
#include "linalg/dot.h"

#include <math.h>
#include <string.h>

/* F is symmetric, so its columns are its rows. */
void hf_schur_flex(const hf_model *m, const double *force, double *r)
{
    size_t n = (size_t)(3 * m->n_attachment);
    memset(r, 0, n * sizeof *r);
    for (size_t j = 0; j < n; j++)
        hf_subtract(n, -force[j], m->flexibility_m_per_N + j * n, r);
}

static void lay_out(hf_arena *arena, const hf_model *m, hf_schur *to){HF_SCHUR_FIELDS(HF_ARENA_TAKE)}

hf_schur hf_schur_of(const hf_model *m, const hf_workspace *w)
{
    size_t n = 3 * (size_t)m->n_attachment;
    double *at = w->schur_work;
    return (hf_schur){(int)n, at, at + n * n, at + 2 * n * n, at + 3 * n * n, w->schur_pivot, {0}};
}

hf_status hf_schur_create(const hf_model *m, hf_schur *schur)
{
    *schur = (hf_schur){.n = 3 * m->n_attachment};
    return HF_ARENA_MAKE(&schur->arena, lay_out(&schur->arena, m, schur));
}

/* Adds the blocks of the ties times `from` to `to`: from attachments [n] to free nodes [3 n_free], or with
 * to_attachment the other way. */
static void add_ties(const hf_model *m, const hf_workspace *w, hf_newton_block *block_of, bool to_attachment,
                     const double *from, double *to)
{
    double block[3][3];
    for (int k = 0; k < m->n_tie; k++) {
        int here = m->tie_attachment[k], there = m->end_row[m->tie[k] ^ 1];
        const double *d = from + 3 * (to_attachment ? there : here);
        double *f = to + 3 * (to_attachment ? here : there);
        if (there >= m->n_free) continue;
        block_of(m, w, m->tie[k] / 2, block);
        for (int c = 0; c < 3; c++)
            f[c] += block[c][0] * d[0] + block[c][1] * d[1] + block[c][2] * d[2];
    }
}

void hf_schur_push(const hf_model *m, const hf_workspace *w, hf_newton_block *block_of, const double *displacement_m,
                   double *force)
{
    add_ties(m, w, block_of, false, displacement_m, force);
}

void hf_schur_pull(const hf_model *m, const hf_workspace *w, hf_newton_block *block_of, const double *step_m,
                   double *pull)
{
    add_ties(m, w, block_of, true, step_m, pull);
}

/* Returns the tie at the other end of the same cable if that is an attachment, too, else -1. */
static int partner_of(const hf_model *m, int k)
{
    int partner = k > 0 && m->tie[k - 1] == (m->tie[k] ^ 1) ? k - 1 : k + 1;
    return partner < m->n_tie && m->tie[partner] == (m->tie[k] ^ 1) ? partner : -1;
}

void hf_schur_hold(const hf_model *m, const hf_workspace *w, hf_newton_block *block_of, const double *displacement_m,
                   double *pull)
{
    double block[3][3];
    for (int k = 0; k < m->n_tie; k++) {
        int partner = partner_of(m, k);
        const double *r = displacement_m + 3 * m->tie_attachment[k];
        double d[3] = {r[0], r[1], r[2]};
        for (int c = 0; c < 3 && partner >= 0; c++)
            d[c] -= displacement_m[3 * m->tie_attachment[partner] + c];
        block_of(m, w, m->tie[k] / 2, block);
        for (int c = 0; c < 3; c++)
            pull[3 * m->tie_attachment[k] + c] -= block[c][0] * d[0] + block[c][1] * d[1] + block[c][2] * d[2];
    }
}

void hf_schur_add_own(const hf_model *m, const hf_workspace *w, hf_newton_block *block_of, int per_node,
                      double *stiffness)
{
    double block[3][3];
    size_t n_coordinate = (size_t)per_node, n = n_coordinate * (size_t)m->n_attachment;
    for (int k = 0; k < m->n_tie; k++) {
        int partner = partner_of(m, k);
        size_t here = n_coordinate * (size_t)m->tie_attachment[k];
        block_of(m, w, m->tie[k] / 2, block);
        for (size_t r = 0; r < n_coordinate; r++)
            for (size_t c = 0; c < n_coordinate; c++) {
                double *row = stiffness + (here + r) * n;
                row[here + c] += block[r][c];
                if (partner >= 0) row[n_coordinate * (size_t)m->tie_attachment[partner] + c] -= block[r][c];
            }
    }
}

/* Subtracts H_af H_ff^-1 H_fa from the rows of the stiffness that belong to HF_SCHUR_PANEL attachments, beginning with
 * `from`. `column` has room for that many. */
static void subtract_panel(const hf_model *m, const hf_workspace *w, hf_newton_block *block_of, int from, hf_schur *s)
{
    int end = from + HF_SCHUR_PANEL < m->n_attachment ? from + HF_SCHUR_PANEL : m->n_attachment;
    size_t n = (size_t)s->n, n_dof = (size_t)hf_newton_matrix_dofs(m), n_column = 3 * (size_t)(end - from);
    double block[3][3];
    memset(s->column, 0, n_column * n_dof * sizeof(double));
    for (int k = 0; k < m->n_tie; k++) {
        int here = m->tie_attachment[k], there = m->end_row[m->tie[k] ^ 1];
        if (here < from || here >= end || there >= m->n_free) continue;
        block_of(m, w, m->tie[k] / 2, block);
        double *column = s->column + (size_t)(3 * (here - from)) * n_dof + 3 * there;
        for (int c = 0; c < 3; c++, column += n_dof)
            for (int r = 0; r < 3; r++)
                column[r] += block[r][c];
    }
    hf_newton_matrix_solve(m, w, NULL, (int)n_column, s->column);
    for (size_t j = 0; j < n_column; j++) {
        double *row = s->stiffness + (3 * (size_t)from + j) * n;
        hf_schur_pull(m, w, block_of, s->column + j * n_dof, row);
        for (size_t i = 0; i < n; i++)
            row[i] = -row[i];
    }
}

hf_status hf_schur_factor(const hf_model *m, const hf_workspace *w, hf_newton_block *block_of, hf_schur *s)
{
    size_t n = (size_t)s->n;
    memset(s->stiffness, 0, n * n * sizeof(double));
    for (int from = 0; from < m->n_attachment; from += HF_SCHUR_PANEL)
        subtract_panel(m, w, block_of, from, s);
    hf_schur_add_own(m, w, block_of, 3, s->stiffness);
    hf_dense_multiply(s->n, m->flexibility_m_per_N, s->stiffness, s->flexed);
    memcpy(s->factor, s->flexed, n * n * sizeof(double));
    for (size_t i = 0; i < n; i++)
        s->factor[i * n + i] += 1;
    return hf_dense_factor(s->n, s->factor, s->pivot) == 0 ? HF_OK : HF_SINGULAR;
}

void hf_schur_solve(const hf_schur *s, double *b)
{
    hf_dense_solve(s->n, s->factor, s->pivot, 1, b);
}

void hf_schur_displace(const hf_model *m, const hf_schur *s, const double *b, double *displacement_m)
{
    hf_schur_flex(m, b, displacement_m);
    hf_schur_solve(s, displacement_m);
}

/* Approximates A = (I + F S)^-1 - I by crosses. `left` is the longest column of A, scaled to length 1. `right` has the
 * inner products of all columns with it. left right' is subtracted from A before the next mode. */
int hf_schur_modes(hf_schur *s, double tolerance, int max_mode, double *mode)
{
    size_t n = (size_t)s->n;
    double *a = s->flexed;
    int n_mode = 0;
    hf_dense_solve(s->n, s->factor, s->pivot, s->n, a);
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
            mode[n + j] = hf_dot(n, mode, a + j * n);
            hf_subtract(n, mode[n + j], mode, a + j * n);
        }
    }
    return n_mode;
}
