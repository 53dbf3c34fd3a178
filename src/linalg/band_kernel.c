/* The kernels of band, compiled once for each instruction set.
 *
 *     factor       band -> for each block of 4 columns, for each strip of rows: subtract the products of the finished
 *                  columns, divide by the pivots -> L, in place
 *     back_solve   L, b -> forward and backward substitution, 4 columns at a time, for 1 to 3 right-hand sides -> x
 *     gram         A -> tiles of 4 x 4 inner products of rows -> lower triangle of A A'
 *
 * Contents: strips - factor - substitution - products of rows - table
 *
 * In LAPACK's lower band, entry (i,j) is at band[i - j + j (k + 1)] = band[i + j k]. The entries of a row are k apart
 * in memory, and the entries of a column are adjacent. The factorisation is left-looking by blocks of four columns. It
 * keeps the entries of eight or sixteen rows in registers while it reads the finished columns. */
#define HF_LANE_VECTORS
#include "linalg/band_kernel.h"

#include <math.h>
#include <stddef.h>

/* ---- strips: eight rows of a column, in PARTS vectors ---- */

enum { ROWS = HF_LANES, COLUMNS = 4 };

typedef vec row_vec __attribute__((aligned(8)));
typedef struct {
    vec part[PARTS];
} strip;

INLINE int least(int a, int b)
{
    return a < b ? a : b;
}

INLINE strip zero(void)
{
    strip s;
    foreach (i, PARTS)
        s.part[i] = splat(0);
    return s;
}

INLINE strip load(const double *from)
{
    strip s;
    foreach (i, PARTS)
        s.part[i] = *(const row_vec *)(from + i * WIDTH);
    return s;
}

INLINE void store(double *to, strip s)
{
    foreach (i, PARTS)
        *(row_vec *)(to + i * WIDTH) = s.part[i];
}

/* Returns the first `count` rows at `from`. The other rows are 0, and their memory is not read. */
INLINE strip load_first(const double *from, int count)
{
    if (count >= ROWS) return load(from);
#if defined __AVX512F__
    strip s;
    s.part[0] = _mm512_maskz_loadu_pd((__mmask8)(count > 0 ? (1 << count) - 1 : 0), from);
    return s;
#elif defined __AVX2__
    static const long long mask[2 * ROWS] = {-1, -1, -1, -1, -1, -1, -1, -1};
    const long long *first = mask + ROWS - (count > 0 ? count : 0);
    strip s;
    foreach (i, PARTS)
        s.part[i] = _mm256_maskload_pd(from + i * WIDTH, _mm256_loadu_si256((const __m256i *)(first + i * WIDTH)));
    return s;
#else
    double row[ROWS] = {0};
    for (int r = 0; r < count; r++)
        row[r] = from[r];
    return load(row);
#endif
}

/* Stores only rows begin to end - 1. */
INLINE void store_some(double *to, strip s, int begin, int end)
{
#if defined __AVX512F__
    _mm512_mask_storeu_pd(to, (__mmask8)(end > begin ? ((1 << least(end, ROWS)) - 1) & ~((1 << begin) - 1) : 0),
                          s.part[0]);
#else
    if (begin == 0 && end >= ROWS) {
        store(to, s);
        return;
    }
    double row[ROWS];
    store(row, s);
    for (int r = begin; r < least(end, ROWS); r++)
        to[r] = row[r];
#endif
}

INLINE double row_of(strip s, int row)
{
    return s.part[row / WIDTH][row % WIDTH];
}

INLINE void subtract(strip *s, strip a, double b)
{
    foreach (i, PARTS)
        s->part[i] = less_product(s->part[i], a.part[i], splat(b));
}

INLINE void multiply(strip *s, double by)
{
    foreach (i, PARTS)
        s->part[i] *= by;
}

/* Returns the sum of the rows, added in the same order for all vector widths. */
INLINE double sum(strip s)
{
    double row[ROWS];
    store(row, s);
    return ((row[0] + row[4]) + (row[2] + row[6])) + ((row[1] + row[5]) + (row[3] + row[7]));
}

/* ---- factor ---- */

#if defined __AVX512F__
enum { STRIPS = 2 }; /* strips that are processed together */
#else
enum { STRIPS = 1 };
#endif

/* One step: a block of columns j to j + n_column - 1 of a matrix of n rows. */
typedef struct {
    double *band;
    ptrdiff_t k; /* half-bandwidth */
    int n, j, n_column;
    double inverse[COLUMNS]; /* [n_column], reciprocals of the pivots */
} block;

INLINE double *place(const block *b, int row, int column)
{
    return b->band + row + column * b->k;
}

/* Returns the number of entries that a column has in this row and below. The caller never changes those below row
 * n - 1. */
INLINE int entries(const block *b, int row, int column)
{
    return column + (int)b->k - row + 1;
}

/* Subtracts the products of columns `begin` to j - 1 from t. t contains the strips of the block from row `row` on. */
INLINE void eliminate(const block *b, int n_strip, int n_column, int row, int begin, strip t[][COLUMNS])
{
    int full = least(b->j, row + ROWS * n_strip - 1 - (int)b->k); /* columns before `full` lack some of these rows */
    for (int p = begin; p < full; p++)
        foreach (s, n_strip) {
            strip l = load_first(place(b, row + ROWS * s, p), entries(b, row + ROWS * s, p));
            foreach (c, COLUMNS)
                if (c < n_column) subtract(&t[s][c], l, *place(b, b->j + c, p));
        }
    for (int p = full > begin ? full : begin; p < b->j; p++)
        foreach (s, n_strip) {
            strip l = load(place(b, row + ROWS * s, p));
            foreach (c, COLUMNS)
                if (c < n_column) subtract(&t[s][c], l, *place(b, b->j + c, p));
        }
}

/* Finishes ROWS * n_strip rows of the block, from row `row` on. If row is j, they begin at the diagonal. Returns 0, or
 * 1 + the row whose pivot is not positive. */
INLINE int finish_rows(block *b, int n_strip, int n_column, int row, int begin)
{
    strip t[STRIPS][COLUMNS];
    foreach (s, n_strip)
        foreach (c, COLUMNS) {
            int first = row + ROWS * s, column = b->j + c;
            t[s][c] = c < n_column ? load_first(place(b, first, column), entries(b, first, column)) : zero();
        }
    eliminate(b, n_strip, n_column, row, begin, t);
    foreach (c, COLUMNS) {
        if (c >= n_column) continue;
        int column = b->j + c;
        double pivot = 0;
        if (row == b->j) {
            pivot = row_of(t[0][c], c);
            if (!(pivot > 0)) return column + 1;
            pivot = sqrt(pivot);
            b->inverse[c] = 1 / pivot;
        }
        foreach (s, n_strip) {
            int first = row + ROWS * s;
            multiply(&t[s][c], b->inverse[c]);
            store_some(place(b, first, column), t[s][c], row == b->j && s == 0 ? c + 1 : 0,
                       least(entries(b, first, column), b->n - first));
        }
        if (row == b->j) *place(b, column, column) = pivot;
        foreach (d, COLUMNS) {
            if (d <= c || d >= n_column) continue;
            double l = row == b->j ? row_of(t[0][c], d) : d - c > b->k ? 0 : *place(b, b->j + d, column);
            foreach (s, n_strip)
                subtract(&t[s][d], t[s][c], l);
        }
    }
    return 0;
}

/* Factors one block, sixteen rows at a time. If STRIPS is 1, both halves still begin with the same column, because a
 * product with an entry outside the band can change the sign of a zero. So all instruction sets give the same bits. */
INLINE int factor_block(block *b, int n_column)
{
    int last = least(b->j + n_column - 1 + (int)b->k, b->n - 1);
    for (int row = b->j; row <= last; row += 2 * ROWS) {
        int begin = row - (int)b->k > 0 ? row - (int)b->k : 0;
        for (int s = 0; s < 2; s += STRIPS) {
            if (row + ROWS * s > last) break;
            int failed = finish_rows(b, STRIPS, n_column, row + ROWS * s, begin);
            if (failed) return failed;
        }
    }
    return 0;
}

static int factor(int n, int half_bandwidth, double *band, int first, int end)
{
    block b = {.band = band, .k = half_bandwidth, .n = n};
    for (b.j = first; b.j < end; b.j += COLUMNS) {
        int n_column = least(COLUMNS, n - b.j);
        int failed = n_column == COLUMNS ? factor_block(&b, COLUMNS) : factor_block(&b, n_column);
        if (failed) return failed;
    }
    return 0;
}

/* ---- substitution ---- */

/* Returns entry (j + d, j + c) of the block's triangle. */
INLINE double in_block(const block *b, int d, int c)
{
    return d - c > b->k ? 0 : *place(b, b->j + d, b->j + c);
}

INLINE void forward(const block *b, int n_column, int n_rhs, double *x, int ld)
{
    int last = least(b->j + n_column - 1 + (int)b->k, b->n - 1);
    double y[COLUMNS][COLUMNS] = {{0}};
    foreach (c, COLUMNS)
        foreach (r, n_rhs) {
            if (c >= n_column) continue;
            double v = x[r * (ptrdiff_t)ld + b->j + c];
            foreach (d, COLUMNS)
                if (d < c) v = fma(-in_block(b, c, d), y[d][r], v);
            x[r * (ptrdiff_t)ld + b->j + c] = y[c][r] = v / *place(b, b->j + c, b->j + c);
        }
    for (int row = b->j + n_column; row <= last; row += ROWS)
        foreach (r, n_rhs) {
            double *at = x + r * (ptrdiff_t)ld + row;
            strip v = load_first(at, b->n - row);
            foreach (c, COLUMNS)
                if (c < n_column) subtract(&v, load_first(place(b, row, b->j + c), entries(b, row, b->j + c)), y[c][r]);
            store_some(at, v, 0, b->n - row);
        }
}

INLINE void subtract_product(strip *s, strip a, strip b)
{
    foreach (i, PARTS)
        s->part[i] = less_product(s->part[i], a.part[i], b.part[i]);
}

INLINE void backward(const block *b, int n_column, int n_rhs, double *x, int ld)
{
    int last = least(b->j + n_column - 1 + (int)b->k, b->n - 1);
    strip t[COLUMNS][COLUMNS];
    foreach (c, COLUMNS)
        foreach (r, n_rhs)
            t[c][r] = zero();
    for (int row = b->j + n_column; row <= last; row += ROWS)
        foreach (c, COLUMNS) {
            if (c >= n_column) continue;
            int count = least(entries(b, row, b->j + c), b->n - row);
            strip l = load_first(place(b, row, b->j + c), count);
            foreach (r, n_rhs)
                subtract_product(&t[c][r], l, load_first(x + r * (ptrdiff_t)ld + row, count));
        }
    double y[COLUMNS][COLUMNS] = {{0}};
    foreach (i, COLUMNS)
        foreach (r, n_rhs) {
            int c = COLUMNS - 1 - i;
            if (c >= n_column) continue;
            double *at = x + r * (ptrdiff_t)ld + b->j, v = at[c] + sum(t[c][r]);
            foreach (d, COLUMNS)
                if (d > c && d < n_column) v = fma(-in_block(b, d, c), y[d][r], v);
            at[c] = y[c][r] = v / *place(b, b->j + c, b->j + c);
        }
}

INLINE void back_solve(int n, int half_bandwidth, int n_rhs, double *factor, double *x, int ld)
{
    block b = {.band = factor, .k = half_bandwidth, .n = n};
    int whole = n - n % COLUMNS;
    for (; b.j < whole; b.j += COLUMNS)
        forward(&b, COLUMNS, n_rhs, x, ld);
    if (whole < n) {
        forward(&b, n - whole, n_rhs, x, ld);
        backward(&b, n - whole, n_rhs, x, ld);
    }
    while ((b.j -= COLUMNS) >= 0)
        backward(&b, COLUMNS, n_rhs, x, ld);
}

static void back_solve_all(int n, int half_bandwidth, int n_rhs, const double *factor, double *b, int ldb)
{
    double *f = (double *)factor; /* only read */
    for (; n_rhs >= 3; n_rhs -= 3, b += 3 * (ptrdiff_t)ldb)
        back_solve(n, half_bandwidth, 3, f, b, ldb);
    if (n_rhs == 2) back_solve(n, half_bandwidth, 2, f, b, ldb);
    if (n_rhs == 1) back_solve(n, half_bandwidth, 1, f, b, ldb);
}

/* ---- products of rows ---- */

/* Computes the inner products of n_row rows from `row` on with n_column rows from `column` on. */
INLINE void gram_tile(int n_row, int n_column, int n, const double *row, const double *column, ptrdiff_t ld,
                      double *gram, ptrdiff_t ldg)
{
    strip t[COLUMNS][COLUMNS];
    foreach (r, n_row)
        foreach (c, n_column)
            t[r][c] = zero();
    for (int i = 0; i < n; i += ROWS) {
        strip b[COLUMNS];
        foreach (c, n_column)
            b[c] = load_first(column + c * ld + i, n - i);
        foreach (r, n_row) {
            strip a = load_first(row + r * ld + i, n - i);
            foreach (c, n_column)
                subtract_product(&t[r][c], a, b[c]);
        }
    }
    foreach (r, n_row)
        foreach (c, n_column)
            gram[r * ldg + c] = -sum(t[r][c]);
}

/* Computes the requested rows tile by tile. The few requested rows stay in the cache while all earlier rows
 * are read once. */
static void gram_rows(int first, int end, int n_column, const double *a, int lda, double *gram, int ldg)
{
    for (int j = 0; j < end; j += COLUMNS)
        for (int i = first > j ? first : j; i < end; i += COLUMNS) {
            const double *row = a + i * (ptrdiff_t)lda, *column = a + j * (ptrdiff_t)lda;
            double *to = gram + i * (ptrdiff_t)ldg + j;
            if (i + COLUMNS <= end) {
                gram_tile(COLUMNS, COLUMNS, n_column, row, column, lda, to, ldg);
                continue;
            }
            for (int r = 0; i + r < end; r++)
                for (int c = 0; c < COLUMNS && j + c <= i + r; c++)
                    gram_tile(1, 1, n_column, row + r * (ptrdiff_t)lda, column + c * (ptrdiff_t)lda, lda,
                              to + r * (ptrdiff_t)ldg + c, ldg);
        }
}

/* ---- table ---- */

const hf_band_kernels HF_KERNEL(hf_band_kernels) = {factor, back_solve_all, gram_rows};
