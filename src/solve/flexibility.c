/* Factors the flexibility of the truss, and with it the Hessian of net and truss together (METHOD section 3).
 *
 *     F of the model ----- factor: Cholesky, with pivoting if F is singular ----> L with F = L L'
 *     factor of H_ff, blocks of the cables at attachments
 *         | stiffness of the net: S = own blocks - V V'  (M15), in chunks of columns
 *         v
 *     share + L' S L, minus what rounding may change
 *         | Cholesky
 *         v
 *     factor of the rows of the truss; none if the Hessian is not positive definite */
#include "solve/flexibility.h"

#include "linalg/band.h"
#include "linalg/dot.h"
#include "solve/schur.h"

#include <string.h>

/* ---- the factor ---- */

/* Returns the value up to which an entry of the flexibility, or of its remainder, counts as rounding, m/N. */
static double rounding_of_flexibility(const hf_model *m)
{
    int n = 3 * m->n_attachment;
    double largest = 0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, m->flexibility_m_per_N[(size_t)i * (size_t)n + (size_t)i]);
    return 8 * HF_UNIT * (n + 8) * largest;
}

/* Factors F without pivoting into root. Returns true if F is positive definite beyond rounding, as it is for most
 * trusses. */
static bool factor_definite(const hf_model *m, double nothing, hf_flexibility *f)
{
    size_t n = (size_t)f->n;
    for (size_t j = 0; j < n; j++)
        memcpy(f->root + j * n, m->flexibility_m_per_N + j * n + j, (n - j) * sizeof *f->root);
    if (hf_band_factor(f->n, f->n - 1, f->root) != 0) return false;
    for (size_t j = 0; j < n; j++)
        if (!(f->root[j * n] * f->root[j * n] > nothing)) return false;
    for (size_t j = 1; j < n; j++) {
        memmove(f->root + j * n + j, f->root + j * n, (n - j) * sizeof *f->root);
        memset(f->root + j * n, 0, j * sizeof *f->root);
    }
    f->rank = f->n;
    f->is_lower = true;
    return true;
}

/* Factors F with pivoting until only rounding remains. Returns false if the remainder is larger than rounding. */
static bool factor_semidefinite(const hf_model *m, double nothing, hf_flexibility *f)
{
    size_t n = (size_t)f->n;
    double *left = f->factor;
    memcpy(left, m->flexibility_m_per_N, n * n * sizeof *left);
    for (; f->rank < f->n; f->rank++) {
        size_t pivot = 0;
        double *column = f->root + (size_t)f->rank * n;
        for (size_t i = 1; i < n; i++)
            if (left[i * n + i] > left[pivot * n + pivot]) pivot = i;
        double largest = left[pivot * n + pivot];
        if (!(largest > nothing)) break;
        for (size_t i = 0; i < n; i++)
            column[i] = left[pivot * n + i] / sqrt(largest);
        for (size_t i = 0; i < n; i++)
            hf_subtract(n, column[i], column, left + i * n);
    }
    for (size_t i = 0; i < n * n; i++)
        if (!(fabs(left[i]) <= 4 * nothing)) return false;
    return true;
}

bool hf_flexibility_factor(const hf_model *m, hf_flexibility *f)
{
    double nothing = rounding_of_flexibility(m);
    f->n = 3 * m->n_attachment;
    f->rank = 0;
    f->is_lower = false;
    f->trace = 0;
    if (!factor_definite(m, nothing, f) && !factor_semidefinite(m, nothing, f)) return false;
    for (int k = 0; k < f->rank; k++) {
        const double *column = f->root + (size_t)k * (size_t)f->n;
        f->trace += hf_dot((size_t)f->n, column, column);
    }
    f->trace *= 1 + 4 * HF_UNIT * f->n;
    return true;
}

/* ---- products ---- */

static size_t first_of(const hf_flexibility *f, size_t column)
{
    return f->is_lower ? column : 0;
}

void hf_flexibility_displace(const hf_flexibility *f, const double *s, double *r)
{
    size_t n = (size_t)f->n;
    memset(r, 0, n * sizeof *r);
    for (size_t k = 0; k < (size_t)f->rank; k++) {
        size_t first = first_of(f, k);
        hf_subtract(n - first, -s[k], f->root + k * n + first, r + first);
    }
}

void hf_flexibility_load(const hf_flexibility *f, const double *b, double *s)
{
    hf_dots((size_t)f->rank, (size_t)f->n, f->root, (size_t)f->n, b, s);
}

/* Returns the inner product of b [n] with n entries of a, `stride` apart, at twice the precision. */
static hf_twofold dot_twofold(size_t n, const double *a, size_t stride, const hf_twofold *b)
{
    hf_twofold sum = {0, 0};
    for (size_t i = 0; i < n; i++)
        hf_twofold_add_to(&sum, hf_twofold_multiply(hf_twofold_of(a[i * stride]), b[i]));
    return sum;
}

hf_twofold hf_flexibility_displace_twofold(const hf_flexibility *f, const hf_twofold *s, int i)
{
    size_t n_column = f->is_lower ? (size_t)i + 1 : (size_t)f->rank;
    return dot_twofold(n_column, f->root + i, (size_t)f->n, s);
}

hf_twofold hf_flexibility_load_twofold(const hf_flexibility *f, const hf_twofold *b, int k)
{
    size_t n = (size_t)f->n, first = first_of(f, (size_t)k);
    return dot_twofold(n - first, f->root + (size_t)k * n + first, 1, b + first);
}

hf_twofold hf_flexibility_row_twofold(const hf_model *m, const hf_twofold *b, int i)
{
    size_t n = 3 * (size_t)m->n_attachment;
    return dot_twofold(n, m->flexibility_m_per_N + (size_t)i * n, 1, b);
}

/* ---- rounding ---- */

/* Computes the bounds from the numbers of operations. In the unknowns of free nodes and attachments, a column of the
 * factor has at most k + 1 + n entries. An inner product has at most k + 1 terms; between two attachments it has one
 * for each unknown. With t terms its error is at most (t + 2) u times the root of the product of two diagonal entries.
 * Cauchy's inequality turns that into a part of the diagonal, as in METHOD section 3.
 *
 * Errors at attachments become a part of |s|^2 by |L s|^2 <= trace |s|^2 and stiffness_N_per_m. The products with L add
 * at most 2 n u |L| |S| |L|. Here |.| is the 2-norm of the matrix of absolute values, at most sqrt(n) times that of the
 * matrix. */
hf_flexibility_rounding hf_flexibility_rounding_of(const hf_model *m, const hf_flexibility *f, double stiffness_N_per_m,
                                                   double n_cable)
{
    double k = m->has_newton ? 3.0 * m->half_bandwidth + 2 : m->half_bandwidth, n = f->n;
    double all = HF_UNIT * (1.1 * (k + 4) * (k + 1 + n) + 400 + 20 * n_cable);
    double between = 1.1 * HF_UNIT * (3.0 * m->n_free + n + 4) * (n + 1) + 8 * HF_UNIT * n * sqrt(n);
    return (hf_flexibility_rounding){all, 1.1 * HF_UNIT * (n + 4) * (n + 1), 2 * all * stiffness_N_per_m,
                                     2 * (all + between) * stiffness_N_per_m * f->trace};
}

/* ---- the stiffness of the net ---- */

/* The factor of the free nodes: of all their coordinates (per_node 3), or of D, which serves each coordinate alone
 * (per_node 1). n_border is the number of attachment coordinates beside it. */
typedef struct {
    int n, half_bandwidth, per_node, n_border;
    const double *band;
} free_factor;

static free_factor free_factor_of(const hf_model *m, const hf_workspace *w)
{
    if (m->has_newton)
        return (free_factor){3 * m->n_free, 3 * m->half_bandwidth + 2, 3, 3 * m->n_attachment, w->newton_band};
    return (free_factor){m->n_free, m->half_bandwidth, 1, m->n_attachment, w->band};
}

/* Adds the blocks of the cables between free nodes and attachments to border [n_border][ld]. Only columns `first` to
 * end - 1 are added. */
static void add_border(const hf_model *m, const hf_workspace *w, const free_factor *free, hf_newton_block *block_of,
                       int first, int end, double *border, size_t ld)
{
    double block[3][3];
    for (int tie = 0; tie < m->n_tie; tie++) {
        int there = m->end_row[m->tie[tie] ^ 1], column = free->per_node * there;
        if (there >= m->n_free || column + free->per_node <= first || column >= end) continue;
        double *row = border + (size_t)(free->per_node * m->tie_attachment[tie]) * ld;
        block_of(m, w, m->tie[tie] / 2, block);
        for (int d = 0; d < free->per_node; d++, row += ld)
            for (int c = 0; c < free->per_node; c++)
                if (column + c >= first && column + c < end) row[column + c - first] -= block[c][d];
    }
}

/* Subtracts V V' from stiffness [n_border][n_border], where V solves (factor of the free nodes) V' = border. It works
 * in chunks of HF_BOUND_CHUNK columns. A row of `window` has the columns of a chunk, followed by those that the band
 * still reaches. gram is scratch. */
static void eliminate_free(const hf_model *m, const hf_workspace *w, const free_factor *free, hf_newton_block *block_of,
                           double *window, double *gram, double *stiffness)
{
    size_t k = (size_t)free->half_bandwidth, ld = HF_BOUND_CHUNK + k, n_border = (size_t)free->n_border;
    memset(window, 0, n_border * ld * sizeof *window);
    for (int first = 0; first < free->n; first += HF_BOUND_CHUNK) {
        int end = free->n - first < HF_BOUND_CHUNK ? free->n : first + HF_BOUND_CHUNK;
        add_border(m, w, free, block_of, first, end, window, ld);
        for (size_t r = 0; r < n_border; r++)
            for (int j = first; j < end; j++) {
                const double *column = free->band + (size_t)j * (k + 1);
                double *v = window + r * ld + (j - first);
                if (*v == 0) continue;
                *v /= *column;
                hf_subtract(free->n - 1 - j < (int)k ? (size_t)(free->n - 1 - j) : k, *v, column + 1, v + 1);
            }
        hf_band_gram(0, (int)n_border, end - first, window, (int)ld, gram, (int)n_border);
        for (size_t i = 0; i < n_border; i++)
            hf_subtract(i + 1, 1, gram + i * n_border, stiffness + i * n_border);
        for (size_t r = 0; r < n_border; r++) {
            memmove(window + r * ld, window + r * ld + HF_BOUND_CHUNK, k * sizeof *window);
            memset(window + r * ld + k, 0, HF_BOUND_CHUNK * sizeof *window);
        }
    }
    for (size_t i = 0; i < n_border; i++) /* copies the lower triangle to the upper one */
        for (size_t j = 0; j < i; j++)
            stiffness[j * n_border + i] = stiffness[i * n_border + j];
}

/* ---- net and truss together ---- */

/* Sets product [n] to S times column k of L. S is that of all coordinates, or of each coordinate alone. sum [n_border]
 * is scratch. */
static void stiffen_column(const hf_flexibility *f, const free_factor *free, const double *stiffness, size_t k,
                           double *sum, double *product)
{
    size_t n = (size_t)f->n, n_border = (size_t)free->n_border, n_pass = n / n_border;
    for (size_t c = 0; c < n_pass; c++) {
        const double *column = f->root + k * n + c;
        memset(sum, 0, n_border * sizeof *sum);
        for (size_t j = 0; j < n_border; j++)
            if (column[n_pass * j] != 0) hf_subtract(n_border, -column[n_pass * j], stiffness + j * n_border, sum);
        for (size_t i = 0; i < n_border; i++)
            product[n_pass * i + c] = sum[i];
    }
}

/* Sets f->factor to the Cholesky factor of share + L' S L, with `rounding` (may be NULL) subtracted from the diagonal.
 * Returns false if there is none. */
static bool factor_own(const hf_flexibility *f, const free_factor *free, const double *stiffness,
                       const hf_flexibility_rounding *rounding, double share)
{
    size_t rank = (size_t)f->rank, n = (size_t)f->n;
    double *sum = f->window, *product = sum + n;
    for (size_t k = 0; k < rank; k++) {
        double *column = f->factor + k * rank;
        stiffen_column(f, free, stiffness, k, sum, product);
        hf_dots(rank - k, n, f->root + k * n, n, product, column);
        *column += share;
        if (rounding) *column -= rounding->own * *column + rounding->own_1;
    }
    return hf_band_factor(f->rank, f->rank - 1, f->factor) == 0;
}

bool hf_flexibility_factor_net(const hf_model *m, hf_workspace *w, hf_newton_block *block_of,
                               const hf_flexibility_rounding *rounding, double share, hf_flexibility *f)
{
    if (f->rank == 0) return true;
    free_factor free = free_factor_of(m, w);
    size_t n_square = (size_t)free.n_border * (size_t)free.n_border;
    double *stiffness = m->has_newton ? hf_schur_of(m, w).factor : f->window + HF_BOUND_WINDOW(m);
    double *gram = m->has_newton ? hf_schur_of(m, w).flexed : stiffness + n_square;
    memset(stiffness, 0, n_square * sizeof *stiffness);
    hf_schur_add_own(m, w, block_of, free.per_node, stiffness);
    eliminate_free(m, w, &free, block_of, f->window, gram, stiffness);
    return factor_own(f, &free, stiffness, rounding, share);
}

bool hf_flexibility_factor_schur(const hf_model *m, const hf_workspace *w, hf_flexibility *f)
{
    free_factor free = free_factor_of(m, w);
    return f->rank == 0 || factor_own(f, &free, hf_schur_of(m, w).stiffness, NULL, 1);
}
