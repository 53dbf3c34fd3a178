/* Implements the kernels of swarm, which are compiled once for each instruction set. The table at the end of the file
 * has the name of the instruction set (HF_ISA).
 *
 *     q, supports -> assemble   -> tiles of D, right-hand sides in position_m
 *     D           -> factor     -> Cholesky factor, bad_row
 *     factor      -> substitute -> positions of the free nodes
 *     q, supports -> solve      -> the three steps above, block row by block row
 *     positions   -> measure    -> lengths, errors, next q                           (Eqs. 4, 7, 8)
 *     positions   -> residual, psi
 *
 * The factorisation is left-looking, by tiles of 4 x 4 entries. A tile stays in registers (16 of the 32 of AVX-512)
 * while the finished parts of its two block rows are read. That takes 8 loads for 16 fused multiply-adds. Both parts
 * are contiguous for every bandwidth. Each entry has one accumulator that runs over the columns in rising order. How
 * the entries are grouped (GROUP columns at a time) therefore cannot change a bit.
 *
 * The following table shows the gain by fused multiply-adds. It was *measured* on one core of a Zen 5 EPYC, which gains
 * little because it multiplies and adds in separate units. The numbers are medians of the processor time per matrix for
 * factoring 8 matrices (n = 440, half-bandwidth 21) on busy cores. A processor without fused multiply-adds runs "any
 * x86-64".
 *
 *                        fused        not fused
 *         AVX-512        1.8 us       2.0 us
 *         AVX2           3.6 us       4.2 us
 *         any x86-64     239 us       8.4 us      (C's fma() in software takes thirty times as long as lane.h does)
 *
 * Contents: vectors - tiles - factor - substitution - assembly - solve - measures - table */
#define HF_LANE_VECTORS
#include "search/swarm_kernel.h"

#include <hifdm/metrics.h>

#include <math.h>
#include <string.h>

/* ---- vectors ---- */

/* GROUP columns of a tile are eliminated at a time: their accumulators fill the registers. */
#if defined __AVX512F__
enum { GROUP = 4 };
#else
enum { GROUP = 2 };
#endif

INLINE vec load(const double *p)
{
    return *(const vec *)p;
}

INLINE void store(double *p, vec a)
{
    *(vec *)p = a;
}

#if defined __AVX512F__
INLINE bool all_positive(vec a)
{
    return _mm512_cmp_pd_mask(a, _mm512_setzero_pd(), _CMP_NGT_UQ) == 0;
}
#elif defined __AVX2__
INLINE bool all_positive(vec a)
{
    return _mm256_movemask_pd(_mm256_cmp_pd(a, _mm256_setzero_pd(), _CMP_NGT_UQ)) == 0;
}
#else
INLINE bool all_positive(vec a)
{
    return a[0] > 0 && a[1] > 0;
}
#endif

/* ---- tiles ---- */

enum { BLOCK = HF_SWARM_BLOCK, COLUMN = BLOCK * HF_LANES, TILE = BLOCK * COLUMN, POINT = 3 * HF_LANES };

/* Eliminates GROUP columns of n_row rows, after all columns before them are finished:
 *
 *     t(r,c) = (t(r,c) - sum over k of t(r,k) l(c,k)) / l(c,c),   k rising
 *
 * `row` points to the first column k of the rows, whose columns are `stride` apart. `pivot_row` points to the same
 * column of the rows of l. The entries t(r,c) and l(c,c) are n_before columns further on. If is_empty is true, the
 * t(r,c) are taken as 0. */
INLINE void eliminate(int n_row, double *row, int stride, const double *pivot_row, int n_before, bool is_empty)
{
    vec t[BLOCK][GROUP];
    double *target = row + n_before * stride;
    foreach (c, GROUP)
        foreach (r, BLOCK)
            if (r < n_row) t[r][c] = is_empty ? splat(0) : load(target + c * stride + r * HF_LANES);
    for (int k = 0; k < n_before; k++, row += stride, pivot_row += COLUMN) {
        vec l[GROUP];
        foreach (c, GROUP)
            l[c] = load(pivot_row + c * HF_LANES);
        foreach (r, BLOCK) {
            if (r >= n_row) continue;
            vec a = load(row + r * HF_LANES);
            foreach (c, GROUP)
                t[r][c] = less_product(t[r][c], a, l[c]);
        }
    }
    foreach (c, GROUP) {
        vec inverse = load(pivot_row + c * COLUMN + c * HF_LANES);
        foreach (r, BLOCK) {
            if (r >= n_row) continue;
            t[r][c] *= inverse;
            store(target + c * stride + r * HF_LANES, t[r][c]);
        }
        foreach (d, GROUP) {
            if (d <= c) continue;
            vec l = load(pivot_row + c * COLUMN + d * HF_LANES);
            foreach (r, BLOCK)
                if (r < n_row) t[r][d] = less_product(t[r][d], t[r][c], l);
        }
    }
}

/* Subtracts the products of the n_before columns before a diagonal tile from its lower half. `row` points to the first
 * of these columns. */
INLINE void reduce_diagonal(double *row, int n_before)
{
    vec t[BLOCK][BLOCK];
    double *tile = row + n_before * COLUMN;
    foreach (c, BLOCK)
        foreach (r, BLOCK)
            if (r >= c) t[r][c] = load(tile + c * COLUMN + r * HF_LANES);
    for (; row != tile; row += COLUMN) {
        vec a[BLOCK];
        foreach (r, BLOCK)
            a[r] = load(row + r * HF_LANES);
        foreach (c, BLOCK)
            foreach (r, BLOCK)
                if (r >= c) t[r][c] = less_product(t[r][c], a[r], a[c]);
    }
    foreach (c, BLOCK)
        foreach (r, BLOCK)
            if (r >= c) store(tile + c * COLUMN + r * HF_LANES, t[r][c]);
}

/* Replaces pivots that are not positive by infinity, and stores the row of the first one in bad_row. The reciprocal of
 * an infinite pivot is 0, which removes its row and column, so no number grows from there. */
static __attribute__((noinline, cold)) vec mend_pivot(vec pivot, int i_row, int *bad_row)
{
    for (int k = 0; k < WIDTH; k++) {
        if (pivot[k] > 0) continue;
        if (bad_row[k] < 0) bad_row[k] = i_row;
        pivot[k] = INFINITY;
    }
    return pivot;
}

/* Finishes column c of a reduced tile: the reciprocal of its pivot and the rest of the column. Then subtracts its
 * products from the columns after it. */
INLINE void finish_column(int c, double *tile, int i_row, int *bad_row)
{
    double *column = tile + c * COLUMN;
    vec l[BLOCK], pivot = load(column + c * HF_LANES);
    if (!all_positive(pivot)) pivot = mend_pivot(pivot, i_row, bad_row);
    vec inverse = 1 / root(pivot);
    store(column + c * HF_LANES, inverse);
    foreach (r, BLOCK) {
        if (r <= c) continue;
        l[r] = load(column + r * HF_LANES) * inverse;
        store(column + r * HF_LANES, l[r]);
        foreach (d, BLOCK) {
            double *entry = tile + d * COLUMN + r * HF_LANES;
            if (c < d && d <= r) store(entry, less_product(load(entry), l[r], l[d]));
        }
    }
}

/* ---- factor ---- */

/* Returns the tile of a block row in tile column j_block. */
static double *tile_at(const hf_swarm_plan *plan, const hf_swarm_lanes *w, int i_block, int j_block)
{
    return w->matrix + (plan->tile_0[i_block] + (size_t)j_block) * TILE;
}

static bool tile_has_entry(const hf_swarm_plan *plan, int i_block, int j_block)
{
    return plan->has_entry[plan->tile_0[i_block] + (size_t)j_block];
}

static void finish_one(const hf_swarm_plan *plan, hf_swarm_lanes *w, int i_block, int c, int p)
{
    double *tile = tile_at(plan, w, i_block, i_block) + p;
    int i_row = i_block * BLOCK + c - plan->n_pad;
    switch (c) { /* The columns are constants, so that the loops unroll. */
    case 0:
        finish_column(0, tile, i_row, w->bad_row + p);
        break;
    case 1:
        finish_column(1, tile, i_row, w->bad_row + p);
        break;
    case 2:
        finish_column(2, tile, i_row, w->bad_row + p);
        break;
    default:
        finish_column(3, tile, i_row, w->bad_row + p);
    }
}

/* Finishes at most `count` columns of the diagonal tile of a block row, from column *c on. *c becomes the next
 * column. */
static void finish_columns(const hf_swarm_plan *plan, hf_swarm_lanes *w, int i_block, int count, int *c)
{
    for (; count > 0 && *c < BLOCK; count--, ++*c)
        for (int p = 0; p < HF_LANES; p += WIDTH)
            finish_one(plan, w, i_block, *c, p);
}

/* From this number of tiles on (1 kB each), the matrix does not fit into the second-level cache. The tiles of the next
 * block row are then prefetched while this one is factored. *Measured* with half-bandwidth 65, 18 000 tiles and AVX2:
 * 74 % of the peak speed instead of 59 %. With half-bandwidth 21 and 660 tiles, prefetching costs 0 to 4 %. */
enum { FETCHED_FROM = 2000 };

INLINE void fetch_tile(const double *tile)
{
    for (int k = 0; k < TILE; k += HF_LANES)
        __builtin_prefetch(tile + k, 1);
}

/* Factors a block row up to its diagonal tile, which is only reduced. The root and the division of a pivot take as long
 * as half a tile, and the next pivot depends on them. The pivots of the block row before are therefore found here, one
 * before each tile that does not need them. All lanes of a tile are done before the next tile, so the finished rows are
 * read from the second-level cache once. */
static void factor_block_row(const hf_swarm_plan *plan, hf_swarm_lanes *w, int i_block)
{
    int first = plan->first_column[i_block], c = i_block ? 0 : BLOCK;
    double *row = tile_at(plan, w, i_block, 0);
    for (int j_block = first / BLOCK; j_block < i_block; j_block++) {
        finish_columns(plan, w, i_block - 1, j_block < i_block - 1 ? 1 : BLOCK, &c);
        if (plan->n_tile >= FETCHED_FROM && i_block + 1 < plan->n_block)
            fetch_tile(tile_at(plan, w, i_block + 1, j_block + 1));
        const double *pivot_row = tile_at(plan, w, j_block, 0);
        int j = j_block * BLOCK, k = plan->first_column[j_block];
        bool is_empty = !tile_has_entry(plan, i_block, j_block);
        if (k < first) k = first < j ? first : j;
        for (int p = 0; p < HF_LANES; p += WIDTH)
            for (int g = 0; g < BLOCK; g += GROUP)
                eliminate(BLOCK, row + k * COLUMN + p, COLUMN, pivot_row + k * COLUMN + g * HF_LANES + p, j + g - k,
                          is_empty);
    }
    if (c < BLOCK) finish_columns(plan, w, i_block - 1, BLOCK, &c);
    for (int p = 0; p < HF_LANES; p += WIDTH)
        reduce_diagonal(row + first * COLUMN + p, i_block * BLOCK - first);
}

static void factor_last_tile(const hf_swarm_plan *plan, hf_swarm_lanes *w)
{
    int c = 0;
    finish_columns(plan, w, plan->n_block - 1, BLOCK, &c);
}

static void factor(const hf_swarm_plan *plan, hf_swarm_lanes *w)
{
    memset(w->bad_row, -1, HF_LANES * sizeof(int));
    for (int i_block = 0; i_block < plan->n_block; i_block++)
        factor_block_row(plan, w, i_block);
    factor_last_tile(plan, w);
}

/* ---- substitution ---- */

/* Substitutes forward in a block row. The right-hand sides are treated as three more rows of the matrix. */
static void substitute_forward(const hf_swarm_plan *plan, hf_swarm_lanes *w, int i_block, int p)
{
    int first = plan->first_column[i_block], n_before = i_block * BLOCK - first;
    const double *row = tile_at(plan, w, i_block, 0) + first * COLUMN + p;
    for (int g = 0; g < BLOCK; g += GROUP)
        eliminate(3, w->position_m + first * POINT + p, POINT, row + g * HF_LANES, n_before + g, 0);
}

/* Finds the unknowns of the block row, the last one first. Then subtracts their part from all rows before it, the
 * nearest row first. */
static void substitute_back(const hf_swarm_plan *plan, hf_swarm_lanes *w, int i_block, int p)
{
    const double *column = tile_at(plan, w, i_block, i_block) + p;
    double *x = w->position_m + i_block * BLOCK * POINT + p;
    vec t[BLOCK][3], l[BLOCK];
    foreach (k, BLOCK) {
        int r = BLOCK - 1 - k;
        foreach (c, 3) {
            t[r][c] = load(x + r * POINT + c * HF_LANES);
            foreach (n, BLOCK) {
                int s = BLOCK - 1 - n;
                if (s > r) t[r][c] = less_product(t[r][c], load(column + r * COLUMN + s * HF_LANES), t[s][c]);
            }
            t[r][c] *= load(column + r * COLUMN + r * HF_LANES);
            store(x + r * POINT + c * HF_LANES, t[r][c]);
        }
    }
    for (int j = i_block * BLOCK - 1; j >= plan->first_column[i_block]; j--) {
        column -= COLUMN, x -= POINT;
        foreach (r, BLOCK)
            l[r] = load(column + r * HF_LANES);
        foreach (c, 3) {
            vec y = load(x + c * HF_LANES);
            foreach (k, BLOCK)
                y = less_product(y, l[BLOCK - 1 - k], t[BLOCK - 1 - k][c]);
            store(x + c * HF_LANES, y);
        }
    }
}

static void substitute_all_back(const hf_swarm_plan *plan, hf_swarm_lanes *w)
{
    for (int i_block = plan->n_block - 1; i_block >= 0; i_block--)
        for (int p = 0; p < HF_LANES; p += WIDTH)
            substitute_back(plan, w, i_block, p);
}

static void substitute(const hf_swarm_plan *plan, hf_swarm_lanes *w)
{
    for (int i_block = 0; i_block < plan->n_block; i_block++)
        for (int p = 0; p < HF_LANES; p += WIDTH)
            substitute_forward(plan, w, i_block, p);
    substitute_all_back(plan, w);
}

/* ---- assembly ---- */

/* Assembles a row of D and its right-hand sides. The loop runs over the nodes, so that both are summed in registers. */
static void assemble_row(const hf_swarm_plan *plan, hf_swarm_lanes *w, int i_row, int p)
{
    const hf_model *m = plan->model;
    int i = plan->n_pad + i_row, first_support = plan->n_pad + m->n_free;
    vec diagonal = splat(0), b[3];
    foreach (c, 3)
        b[c] = splat(m->load_N ? m->load_N[c * m->n_node + i_row] : 0);
    for (int k = plan->incidence_start[i_row]; k < plan->incidence_start[i_row + 1]; k++) {
        int other = plan->incidence[k].other;
        vec q = load(w->q_N_per_m + plan->incidence[k].i_cable * HF_LANES + p);
        diagonal += q;
        if (other < i) {
            double *entry = w->matrix + hf_swarm_place(plan, i, other) + p;
            store(entry, load(entry) - q);
        } else if (other >= first_support) {
            foreach (c, 3)
                b[c] = plus_product(b[c], q, load(w->position_m + other * POINT + c * HF_LANES + p));
        }
    }
    store(w->matrix + hf_swarm_place(plan, i, i) + p, diagonal);
    foreach (c, 3)
        store(w->position_m + i * POINT + c * HF_LANES + p, b[c]);
}

static void assemble_dummy_row(const hf_swarm_plan *plan, hf_swarm_lanes *w, int i, int p)
{
    store(w->matrix + hf_swarm_place(plan, i, i) + p, splat(1));
    for (int c = 0; c < 3; c++)
        store(w->position_m + i * POINT + c * HF_LANES + p, splat(0));
}

/* Clears the tiles of a block row that have entries; `eliminate` does not read the others. The loop is unrolled,
 * because gcc 12 makes a memset of a plain loop and `rep stos` of the memset, which takes three times as long. */
static void clear_block_row(const hf_swarm_plan *plan, hf_swarm_lanes *w, int i_block)
{
    for (int j_block = plan->first_column[i_block] / BLOCK; j_block <= i_block; j_block++) {
        if (!tile_has_entry(plan, i_block, j_block)) continue;
        for (double *column = tile_at(plan, w, i_block, j_block), *end = column + TILE; column != end; column += COLUMN)
            foreach (k, COLUMN / WIDTH)
                store(column + k * WIDTH, splat(0));
    }
}

static void assemble_block_row(const hf_swarm_plan *plan, hf_swarm_lanes *w, int i_block)
{
    clear_block_row(plan, w, i_block);
    for (int i = i_block * BLOCK; i < (i_block + 1) * BLOCK; i++)
        for (int p = 0; p < HF_LANES; p += WIDTH) {
            if (i < plan->n_pad)
                assemble_dummy_row(plan, w, i, p);
            else
                assemble_row(plan, w, i - plan->n_pad, p);
        }
}

static void assemble(const hf_swarm_plan *plan, hf_swarm_lanes *w)
{
    for (int i_block = 0; i_block < plan->n_block; i_block++)
        assemble_block_row(plan, w, i_block);
}

/* ---- solve ---- */

/* Assembles each block row just before it is factored, so that it is still in the first-level cache. */
static void solve(const hf_swarm_plan *plan, hf_swarm_lanes *w)
{
    memset(w->bad_row, -1, HF_LANES * sizeof(int));
    for (int i_block = 0; i_block < plan->n_block; i_block++) {
        assemble_block_row(plan, w, i_block);
        factor_block_row(plan, w, i_block);
        for (int p = 0; i_block && p < HF_LANES; p += WIDTH)
            substitute_forward(plan, w, i_block - 1, p); /* the row whose pivots have just been found */
    }
    factor_last_tile(plan, w);
    for (int p = 0; p < HF_LANES; p += WIDTH)
        substitute_forward(plan, w, plan->n_block - 1, p);
    substitute_all_back(plan, w);
}

/* ---- measures ---- */

static void measure_part(const hf_swarm_plan *plan, hf_swarm_lanes *w, hf_swarm_measures *out, int p)
{
    const hf_model *m = plan->model;
    const double *position = w->position_m + plan->n_pad * POINT + p;
    vec tension_error = splat(0), length_error = splat(0), gap = splat(0), finite = splat(0);
    vec shortest[3] = {splat(INFINITY), splat(INFINITY), splat(INFINITY)}, longest = splat(0);
    for (int e = 0; e < m->n_cable; e++) {
        const double *a = position + m->end_row[2 * e] * POINT, *b = position + m->end_row[2 * e + 1] * POINT;
        vec dx = load(b) - load(a), dy = load(b + HF_LANES) - load(a + HF_LANES),
            dz = load(b + 2 * HF_LANES) - load(a + 2 * HF_LANES);
        vec q = load(w->q_N_per_m + e * HF_LANES + p), target = load(w->target + e * HF_LANES + p);
        vec length = root(norm_squared(dx, dy, dz)), tension = q * length;
        vec part = length * plan->inverse_length[e];
        finite += tension - tension; /* NaN if the tension is infinite or NaN, else 0 */
        longest = larger(part, longest);
        if (hf_law_has(w->law[e], HF_LAW_GIVES_TENSION)) {
            shortest[HF_LAW_TENSION] = smaller(part, shortest[HF_LAW_TENSION]);
            tension_error = larger(magnitude(tension / target - 1), tension_error);
            q = target / length; // Eq. 7
        } else if (hf_law_has(w->law[e], HF_LAW_HAS_MULTIPLIER)) {
            shortest[HF_LAW_LENGTH] = smaller(part, shortest[HF_LAW_LENGTH]);
            vec ratio = length / target, strain = ratio - 1, error = magnitude(strain), none = splat(0);
            vec pull = smaller(tension / m->reference_N, splat(1));
            vec taut_error = if_greater(splat(HF_SLACK_RATIO), pull, none, error);
            length_error = larger(taut_error, length_error);
            vec weighed = if_greater(strain, none, error, if_greater(taut_error, none, error, error * pull));
            gap = larger(weighed, gap);
            q = larger(splat(HF_LAW_MIN_Q_N_PER_M), q * ratio); // Eq. 8
        } else {
            shortest[HF_LAW_FORCE_DENSITY] = smaller(part, shortest[HF_LAW_FORCE_DENSITY]);
        }
        store(w->length_m + e * HF_LANES + p, length);
        store(w->next_q_N_per_m + e * HF_LANES + p, q);
    }
    store(out->tension_error + p, tension_error);
    store(out->length_error + p, length_error);
    store(out->length_gap + p, gap);
    store(out->shortest_length_ratio + p, smaller(shortest[0], smaller(shortest[1], shortest[2])));
    store(out->longest_length_ratio + p, longest);
    foreach (k, 3)
        store(out->shortest_of_law[k] + p, shortest[k]);
    for (int l = 0; l < WIDTH; l++)
        out->is_finite[p + l] = finite[l] == 0;
}

static void measure(const hf_swarm_plan *plan, hf_swarm_lanes *w, hf_swarm_measures *out)
{
    for (int p = 0; p < HF_LANES; p += WIDTH)
        measure_part(plan, w, out, p);
}

/* Computes the maximum nodal force. The loop runs over the nodes, so that the forces need no array. */
static void residual_part(const hf_swarm_plan *plan, const hf_swarm_lanes *w, hf_swarm_measures *out, int p)
{
    const hf_model *m = plan->model;
    const double *q_by_law[] = {w->q_N_per_m, w->next_q_N_per_m};
    /* The forces are scaled by the reference tension, because the squares of tiny forces would vanish. */
    vec largest = splat(0), scale = splat(1 / m->reference_N);
    for (int i_row = 0; i_row < m->n_free; i_row++) {
        const double *x = w->position_m + (plan->n_pad + i_row) * POINT + p;
        vec f[3], x_i[3];
        foreach (c, 3) {
            f[c] = splat(m->load_N ? m->load_N[c * m->n_node + i_row] : 0);
            x_i[c] = load(x + c * HF_LANES);
        }
        for (int k = plan->incidence_start[i_row]; k < plan->incidence_start[i_row + 1]; k++) {
            int e = plan->incidence[k].i_cable;
            const double *other = w->position_m + plan->incidence[k].other * POINT + p;
            vec q = load(q_by_law[hf_law_has(w->law[e], HF_LAW_GIVES_TENSION)] + e * HF_LANES + p);
            foreach (c, 3)
                f[c] = plus_product(f[c], q, load(other + c * HF_LANES) - x_i[c]);
        }
        foreach (c, 3)
            f[c] *= scale;
        largest = larger(norm_squared(f[0], f[1], f[2]), largest);
    }
    store(out->residual_N + p, root(largest) * m->reference_N);
}

static void residual(const hf_swarm_plan *plan, const hf_swarm_lanes *w, hf_swarm_measures *out)
{
    for (int p = 0; p < HF_LANES; p += WIDTH)
        residual_part(plan, w, out, p);
}

static void psi(const hf_swarm_plan *plan, const hf_swarm_lanes *w, hf_swarm_measures *out)
{
    const hf_model *m = plan->model;
    for (int p = 0; p < HF_LANES; p += WIDTH) {
        vec sum = splat(0);
        for (int k = 0; k < m->n_inner_node; k++) {
            int row = m->inner_row[k];
            const double *x = w->position_m + (plan->n_pad + row) * POINT + p;
            vec d[3];
            foreach (c, 3)
                d[c] = load(x + c * HF_LANES) - m->position_m[c * m->n_node + row];
            sum += norm_squared(d[0], d[1], d[2]);
        }
        store(out->psi_m + p, root(sum / (double)m->n_inner_node));
    }
}

/* ---- table ---- */

const hf_swarm_kernels HF_KERNEL(hf_swarm_kernels) = {assemble, factor, substitute, solve, measure, residual, psi};
