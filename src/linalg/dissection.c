/* Factors sparse symmetric matrices of 6 x 6 blocks by nested dissection. dissection.h describes the interface.
 *
 *     positions, edges -> cut at medians -> order of elimination -> rows of each front
 *     each front: its columns + what its halves leave over -> eliminate its blocks -> rest for the front above
 *     eliminate: subtract W A' of all earlier blocks from the columns of a block -> invert its pivot P -> W = A P^-1
 *     solve: forward with L = W, multiply by P^-1, backward with L'
 *
 * Contents: order - rows - matrix - factor - solve */
#include "linalg/dissection.h"

#include "base/arena.h"
#include "linalg/block_kernel.h"
#include "linalg/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SMALL 12 /* blocks of a part that is not cut any more; 8 to 20 take the same time */

static const hf_block_kernels *const kernels_of_isa[] = {HF_LANE_EACH(&hf_block_kernels)};

/* ---- order ---- */

typedef struct {
    double along; /* coordinate along the extent that is cut */
    int vertex;
} cut_item;

typedef struct {
    const double *position;
    int *start, *neighbour; /* [n + 1], [2 n_edge] */
    int *vertex;            /* [n] in the order of elimination */
    int *side, n_side;      /* [n] number of the half to which a vertex belongs */
    cut_item *item;         /* [n] scratch */
    hf_dissection *to;
} cutter;

static int compare_items(const void *a, const void *b)
{
    const cut_item *first = a, *second = b;
    if (first->along != second->along) return first->along < second->along ? -1 : 1;
    return (first->vertex > second->vertex) - (first->vertex < second->vertex);
}

/* Sorts the items of n vertices along their longest extent. */
static void sort_along(cutter *k, const int *vertex, int n)
{
    double longest = -1;
    int axis = 0;
    for (int c = 0; c < 3; c++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < n; i++) {
            low = fmin(low, k->position[3 * (ptrdiff_t)vertex[i] + c]);
            high = fmax(high, k->position[3 * (ptrdiff_t)vertex[i] + c]);
        }
        if (!(high - low > longest)) continue;
        longest = high - low;
        axis = c;
    }
    for (int i = 0; i < n; i++)
        k->item[i] = (cut_item){k->position[3 * (ptrdiff_t)vertex[i] + axis], vertex[i]};
    qsort(k->item, (size_t)n, sizeof *k->item, compare_items);
}

static bool touches(const cutter *k, int vertex, int side)
{
    for (int i = k->start[vertex]; i < k->start[vertex + 1]; i++)
        if (k->side[k->neighbour[i]] == side) return true;
    return false;
}

/* Moves the vertices of each half to the front, and those of the separator to the end. n_half [2] receives the numbers
 * of the halves. */
static void cut(cutter *k, int *vertex, int n, int n_half[2])
{
    int side[2] = {k->n_side + 1, k->n_side + 2}, n_touch[2] = {0, 0}, n_done = 0;
    sort_along(k, vertex, n);
    k->n_side += 2;
    for (int i = 0; i < n; i++)
        k->side[k->item[i].vertex] = side[i >= n / 2];
    for (int i = 0; i < n; i++)
        n_touch[i >= n / 2] += touches(k, k->item[i].vertex, side[i < n / 2]);
    int separated = n_touch[1] < n_touch[0]; /* the half that gives the separator */
    n_half[0] = n / 2;
    n_half[1] = n - n / 2;
    n_half[separated] -= n_touch[separated];
    int n_rest = n_half[0] + n_half[1];
    for (int i = 0; i < n; i++) {
        int half = i >= n / 2, at = k->item[i].vertex;
        if (half == separated && touches(k, at, side[!half]))
            vertex[n_rest++] = at;
        else
            vertex[n_done++] = at;
    }
}

/* Orders the n vertices from place `first` on. Returns their last front. */
static int dissect(cutter *k, int first, int n)
{
    int n_half[2] = {0, 0}, part[2] = {-1, -1};
    if (n > SMALL) cut(k, k->vertex + first, n, n_half);
    for (int half = 0, at = first; half < 2; at += n_half[half++])
        if (n_half[half] > 0) part[half] = dissect(k, at, n_half[half]);
    int n_part = n_half[0] + n_half[1];
    k->to->front[k->to->n_front] =
        (hf_dissection_front){.first = first + n_part, .n_pivot = n - n_part, .part = {part[0], part[1]}};
    return k->to->n_front++;
}

/* ---- rows ---- */

static int compare_places(const void *a, const void *b)
{
    int first = *(const int *)a, second = *(const int *)b;
    return (first > second) - (first < second);
}

static void find_row(int place, int end, int mark, int *marked, int *row, int *n)
{
    if (place < end || marked[place] == mark) return;
    marked[place] = mark;
    row[(*n)++] = place;
}

/* Finds the rows of front i: later places that are adjacent to its blocks or rows of its halves. marked, row: [n]. */
static hf_status find_rows(const cutter *k, int i, int *marked, int *row)
{
    const hf_dissection *to = k->to;
    hf_dissection_front *f = &to->front[i];
    int end = f->first + f->n_pivot;
    for (int place = f->first; place < end; place++) {
        row[f->n_row++] = place;
        to->front_of[place] = i;
    }
    for (int place = f->first; place < end; place++)
        for (int e = k->start[k->vertex[place]]; e < k->start[k->vertex[place] + 1]; e++)
            find_row(to->place[k->neighbour[e]], end, i + 1, marked, row, &f->n_row);
    for (int half = 0; half < 2; half++)
        for (int r = 0; f->part[half] >= 0 && r < to->front[f->part[half]].n_row; r++)
            find_row(to->front[f->part[half]].row[r], end, i + 1, marked, row, &f->n_row);
    qsort(row + f->n_pivot, (size_t)(f->n_row - f->n_pivot), sizeof *row, compare_places);
    HF_TRY(HF_ARENA_ARRAYS(&f->block, HF_ARRAY(f->row, f->n_row)));
    memcpy(f->row, row, (size_t)f->n_row * sizeof *row);
    return HF_OK;
}

/* Returns a number of rows with padding to whole vectors. Padding is zero. Kernels also write to rows above a pivot
 * block, which are never read. */
static size_t padded(size_t n)
{
    return (n + HF_LANES - 1) / HF_LANES * HF_LANES;
}

/* Returns the number of rows that a front leaves over, with padding. */
static size_t n_rest(const hf_dissection *m, int i_front)
{
    return i_front < 0 ? 0 : padded(HF_BLOCK * (size_t)(m->front[i_front].n_row - m->front[i_front].n_pivot));
}

/* Returns the length of the columns that a front leaves over. */
static size_t rest_size(const hf_dissection *m, int i_front)
{
    return i_front < 0 ? 0
                       : n_rest(m, i_front) * HF_BLOCK * (size_t)(m->front[i_front].n_row - m->front[i_front].n_pivot);
}

static hf_status make_numbers(hf_dissection *to)
{
    size_t top = 0, most = 0, scratch = 0, n = (size_t)to->n;
    for (int i = 0; i < to->n_front; i++) {
        hf_dissection_front *f = &to->front[i];
        f->ld = padded(HF_BLOCK * (size_t)f->n_pivot + n_rest(to, i));
        size_t size = HF_BLOCK * (size_t)f->n_pivot * f->ld;
        to->n_entry += size;
        if (top + rest_size(to, i) > most) most = top + rest_size(to, i);
        top += rest_size(to, i) - rest_size(to, f->part[0]) - rest_size(to, f->part[1]);
        if (size > scratch) scratch = size;
        if (HF_BLOCK * n + f->ld > scratch) scratch = HF_BLOCK * n + f->ld;
    }
    HF_TRY(HF_ARENA_ARRAYS(&to->block, HF_ARRAY(to->entry, to->n_entry), HF_ARRAY(to->inverse, HF_BLOCK * HF_BLOCK * n),
                           HF_ARRAY(to->stack, most), HF_ARRAY(to->scratch, scratch), HF_ARRAY(to->at, n)));
    double *entry = to->entry;
    for (int i = 0; i < to->n_front; i++) {
        hf_dissection_front *f = &to->front[i];
        f->entry = entry;
        entry += HF_BLOCK * (size_t)f->n_pivot * f->ld;
    }
    return HF_OK;
}

static void list_neighbours(int n, int n_edge, const int *end, cutter *k)
{
    for (int e = 0; e < 2 * n_edge; e++)
        k->start[end[e]]++;
    for (int i = 0; i < n; i++)
        k->start[i + 1] += k->start[i];
    for (int e = 2 * n_edge - 1; e >= 0; e--)
        k->neighbour[--k->start[end[e]]] = end[e ^ 1];
}

hf_status hf_dissection_create(int n, const double *position, int n_edge, const int *end, hf_dissection *to)
{
    cutter k = {.position = position, .to = to};
    int *marked, *row;
    void *block;
    *to = (hf_dissection){.n = n};
    HF_TRY(HF_ARENA_ARRAYS(&to->order_block, HF_ARRAY(to->place, n), HF_ARRAY(to->front_of, n),
                           HF_ARRAY(to->front, 2 * (size_t)n)));
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(k.start, (size_t)n + 1), HF_ARRAY(k.neighbour, 2 * (size_t)n_edge),
                           HF_ARRAY(k.vertex, n), HF_ARRAY(k.side, n), HF_ARRAY(k.item, n), HF_ARRAY(marked, n),
                           HF_ARRAY(row, n)));
    list_neighbours(n, n_edge, end, &k);
    for (int i = 0; i < n; i++)
        k.vertex[i] = i;
    dissect(&k, 0, n);
    for (int i = 0; i < n; i++)
        to->place[k.vertex[i]] = i;
    hf_status status = HF_OK;
    for (int i = 0; i < to->n_front && status == HF_OK; i++)
        status = find_rows(&k, i, marked, row);
    hf_arena_free_block(block);
    return status == HF_OK ? make_numbers(to) : status;
}

void hf_dissection_free(hf_dissection *m)
{
    for (int i = 0; i < m->n_front; i++)
        hf_arena_free_block(m->front[i].block);
    hf_arena_free_block(m->block);
    hf_arena_free_block(m->order_block);
    *m = (hf_dissection){0};
}

/* ---- matrix ---- */

void hf_dissection_clear(hf_dissection *m)
{
    memset(m->entry, 0, m->n_entry * sizeof *m->entry);
}

/* Returns the index of a place in the rows of a front. */
static int row_of(const hf_dissection_front *f, int place)
{
    if (place < f->first + f->n_pivot) return place - f->first;
    const int *row = bsearch(&place, f->row + f->n_pivot, (size_t)(f->n_row - f->n_pivot), sizeof *row, compare_places);
    return (int)(row - f->row);
}

void hf_dissection_add(hf_dissection *m, int i, int j, double block[HF_BLOCK][HF_BLOCK])
{
    bool is_turned = m->place[i] < m->place[j];
    int row = m->place[is_turned ? j : i], column = m->place[is_turned ? i : j];
    const hf_dissection_front *f = &m->front[m->front_of[column]];
    size_t ld = f->ld;
    double *to = f->entry + HF_BLOCK * ((size_t)(column - f->first) * ld + (size_t)row_of(f, row));
    for (int c = 0; c < HF_BLOCK; c++)
        for (int r = 0; r < HF_BLOCK; r++)
            to[(size_t)c * ld + (size_t)r] += is_turned ? block[c][r] : block[r][c];
}

/* ---- factor ---- */

/* Computes the inverse of a pivot block, of which rows and columns are first scaled to entries of at most 1. Returns
 * false if it is singular. */
static bool invert(const double *p, size_t ld, double *inverse)
{
    double scaled[HF_BLOCK * HF_BLOCK], scale[HF_BLOCK];
    int pivot[HF_BLOCK];
    for (size_t c = 0; c < HF_BLOCK; c++) {
        double most = 0;
        for (size_t r = 0; r < HF_BLOCK; r++)
            most = fmax(most, fabs(p[c * ld + r]));
        if (!(most > 0) || !isfinite(most)) return false;
        scale[c] = 1 / sqrt(most);
    }
    for (size_t c = 0; c < HF_BLOCK; c++)
        for (size_t r = 0; r < HF_BLOCK; r++) {
            scaled[HF_BLOCK * c + r] = scale[r] * p[c * ld + r] * scale[c];
            inverse[HF_BLOCK * c + r] = r == c;
        }
    if (hf_dense_factor(HF_BLOCK, scaled, pivot)) return false;
    hf_dense_solve(HF_BLOCK, scaled, pivot, HF_BLOCK, inverse);
    for (int c = 0; c < HF_BLOCK; c++)
        for (int r = 0; r < HF_BLOCK; r++)
            inverse[HF_BLOCK * c + r] *= scale[r] * scale[c];
    return true;
}

/* Adds the rest of a half to the front whose rows are at[place], with the rest `own`. */
static void take_rest(const hf_dissection *m, int i_front, int i_part, const double *rest, double *own)
{
    const hf_dissection_front *f = &m->front[i_front], *part = &m->front[i_part];
    size_t n = n_rest(m, i_part), n_own = n_rest(m, i_front), n_pivot = HF_BLOCK * (size_t)f->n_pivot;
    for (int j = part->n_pivot; j < part->n_row; j++)
        for (size_t c = 0; c < HF_BLOCK; c++, rest += n) {
            size_t column = HF_BLOCK * (size_t)m->at[part->row[j]] + c;
            bool is_pivot = column < n_pivot;
            double *to = is_pivot ? f->entry + column * f->ld : own + (column - n_pivot) * n_own;
            for (int i = j; i < part->n_row; i++) {
                size_t row = HF_BLOCK * (size_t)m->at[part->row[i]] - (is_pivot ? 0 : n_pivot);
                for (size_t r = 0; r < HF_BLOCK; r++)
                    to[row + r] += rest[HF_BLOCK * (size_t)(i - part->n_pivot) + r];
            }
        }
}

/* Eliminates the blocks of a front. `rest` receives what they change in later places. Returns HF_OK or HF_SINGULAR. */
static hf_status eliminate(const hf_dissection *m, int i_front, double *rest)
{
    const hf_block_kernels *kernels = kernels_of_isa[hf_lane_best_isa()];
    const hf_dissection_front *f = &m->front[i_front];
    size_t ld = f->ld, n_rest_row = n_rest(m, i_front), n_pivot = HF_BLOCK * (size_t)f->n_pivot;
    double *a = m->scratch; /* [n_pivot][ld] the columns before they are divided by their pivots */
    for (size_t at = 0; at < n_pivot; at += HF_BLOCK) {
        double *column = f->entry + at * ld, minus[HF_BLOCK * HF_BLOCK];
        double *inverse = m->inverse + HF_BLOCK * (HF_BLOCK * (size_t)f->first + at);
        size_t row = at / HF_LANES * HF_LANES, below = (at + HF_BLOCK) / HF_LANES * HF_LANES;
        kernels->subtract((int)(ld - row), (int)at, f->entry + row, ld, a + at, ld, column + row, ld);
        if (!invert(column + at, ld, inverse)) return HF_SINGULAR;
        for (int k = 0; k < HF_BLOCK * HF_BLOCK; k++)
            minus[k] = -inverse[k];
        memcpy(a + at * ld, column, HF_BLOCK * ld * sizeof *a);
        for (size_t c = 0; c < HF_BLOCK; c++)
            memset(column + c * ld + below, 0, (ld - below) * sizeof *column);
        kernels->subtract((int)(ld - below), HF_BLOCK, a + at * ld + below, ld, minus, HF_BLOCK, column + below, ld);
    }
    for (size_t at = 0; n_pivot + at < HF_BLOCK * (size_t)f->n_row; at += HF_BLOCK) {
        size_t row = at / HF_LANES * HF_LANES;
        kernels->subtract((int)(n_rest_row - row), (int)n_pivot, f->entry + n_pivot + row, ld, a + n_pivot + at, ld,
                          rest + at * n_rest_row + row, n_rest_row);
    }
    return HF_OK;
}

hf_status hf_dissection_factor(hf_dissection *m)
{
    double *top = m->stack;
    for (int i = 0; i < m->n_front; i++) {
        const hf_dissection_front *f = &m->front[i];
        size_t size = rest_size(m, i), low = rest_size(m, f->part[0]), high = rest_size(m, f->part[1]);
        double *rests = top - high - low;
        memset(top, 0, size * sizeof *top);
        for (int r = 0; r < f->n_row; r++)
            m->at[f->row[r]] = r;
        if (low > 0) take_rest(m, i, f->part[0], rests, top);
        if (high > 0) take_rest(m, i, f->part[1], rests + low, top);
        HF_TRY(eliminate(m, i, top));
        memmove(rests, top, size * sizeof *top);
        top = rests + size;
    }
    return HF_OK;
}

/* ---- solve ---- */

static void forward(const hf_dissection *m, const hf_dissection_front *f, double *x, double *w)
{
    const hf_block_kernels *kernels = kernels_of_isa[hf_lane_best_isa()];
    for (int r = 0; r < f->n_row; r++)
        memcpy(w + HF_BLOCK * (ptrdiff_t)r, x + HF_BLOCK * (ptrdiff_t)f->row[r], HF_BLOCK * sizeof *w);
    for (int j = 0; j < f->n_pivot; j++) {
        double value[HF_BLOCK], *at = w + HF_BLOCK * (ptrdiff_t)j;
        const double *inverse = m->inverse + HF_BLOCK * HF_BLOCK * (size_t)(f->first + j);
        kernels->spread(HF_BLOCK * (f->n_row - 1 - j), f->entry + HF_BLOCK * ((size_t)j * f->ld + (size_t)j + 1), f->ld,
                        at, at + HF_BLOCK);
        memcpy(value, at, sizeof value);
        for (int c = 0; c < HF_BLOCK; c++) {
            at[c] = 0;
            for (int k = 0; k < HF_BLOCK; k++)
                at[c] += inverse[HF_BLOCK * c + k] * value[k];
        }
    }
    for (int r = 0; r < f->n_row; r++)
        memcpy(x + HF_BLOCK * (ptrdiff_t)f->row[r], w + HF_BLOCK * (ptrdiff_t)r, HF_BLOCK * sizeof *w);
}

static void backward(const hf_dissection_front *f, double *x, double *w)
{
    const hf_block_kernels *kernels = kernels_of_isa[hf_lane_best_isa()];
    for (int r = 0; r < f->n_row; r++)
        memcpy(w + HF_BLOCK * (ptrdiff_t)r, x + HF_BLOCK * (ptrdiff_t)f->row[r], HF_BLOCK * sizeof *w);
    for (int j = f->n_pivot - 1; j >= 0; j--) {
        double sum[HF_BLOCK], *at = w + HF_BLOCK * (ptrdiff_t)j;
        kernels->dot(HF_BLOCK * (f->n_row - 1 - j), f->entry + HF_BLOCK * ((size_t)j * f->ld + (size_t)j + 1), f->ld,
                     at + HF_BLOCK, sum);
        for (int c = 0; c < HF_BLOCK; c++)
            at[c] -= sum[c];
    }
    memcpy(x + HF_BLOCK * (ptrdiff_t)f->first, w, HF_BLOCK * (size_t)f->n_pivot * sizeof *w);
}

void hf_dissection_solve(const hf_dissection *m, double *x)
{
    double *by_place = m->scratch, *w = by_place + HF_BLOCK * (ptrdiff_t)m->n;
    for (int i = 0; i < m->n; i++)
        memcpy(by_place + HF_BLOCK * (ptrdiff_t)m->place[i], x + HF_BLOCK * (ptrdiff_t)i, HF_BLOCK * sizeof *x);
    for (int i = 0; i < m->n_front; i++)
        forward(m, &m->front[i], by_place, w);
    for (int i = m->n_front - 1; i >= 0; i--)
        backward(&m->front[i], by_place, w);
    for (int i = 0; i < m->n; i++)
        memcpy(x + HF_BLOCK * (ptrdiff_t)i, by_place + HF_BLOCK * (ptrdiff_t)m->place[i], HF_BLOCK * sizeof *x);
}
