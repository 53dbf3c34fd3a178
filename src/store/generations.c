/* Contents: the list - memory - waiting - writing - putting back */
#include "store/generations.h"

#include "base/arena.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Memory, chunks and time depend on these, the values stored do not. The tests of the store pass within the ranges
 * given; with a CHUNK_BYTES of 25 MiB or a CHUNK_MAX of 100 MiB one fails (generations_are_appended). */
#define WAITING_BYTES (512 << 10) /* of waiting rows without designs; a larger generation waits alone; 1 to 50 MiB */
#define DESIGN_CHUNKS 3           /* chunks of designs that may wait, so that a run seldom waits for HDF5; 1 to 300 */
#define CHUNK_BYTES (256 << 10)   /* of a data set: rows as far as they fit; 1 to 256 KiB */
#define CHUNK_MAX (1 << 20)       /* of a row larger than CHUNK_BYTES: what HDF5 caches of a data set; 1 KiB to 1 MiB */
#define BLOCK 1024                /* generations read at a time for the sums; 1 to 102400 */

/* ---- the list ---- */

/* A data set and where its values of one generation are: item after item, `stride` bytes apart. */
typedef struct {
    hf_hdf5_array array;
    const void *from;
    size_t stride, item_bytes;
} ga_row;

/* The figures of the individuals are those of <hifdm/result.h>, status first and psi_m behind it. */
enum {
    ROW_DESIGN,
    ROW_EVALUATED,
    ROW_RESULT,
    ROW_STATUS = ROW_RESULT,
    ROW_PSI,
    ROW_TRIAL_STATUS = ROW_RESULT + HF_RESULT_N_INDIVIDUAL,
    ROW_TRIAL_PSI,
    ROW_BREEDING,
    ROW_BEST_INDIVIDUAL = ROW_BREEDING + 3,
    ROW_BEST_PSI,
    ROW_VIOLATION,
    ROW_N = ROW_VIOLATION + 4
};
_Static_assert(ROW_N == HF_GENERATIONS_PIECES, "count the rows again");

static int list_rows(const hf_population *now, ga_row row[HF_GENERATIONS_PIECES])
{
    const hsize_t p = (hsize_t)now->n_individual, k = (hsize_t)now->n_gene;
#define ARRAY(member) now->member, sizeof *now->member, sizeof *now->member
#define SINGLE(value) &(value), 0, sizeof(value)
    const ga_row before[] = {
        {{"design_N", HF_KIND_REAL, 3, {1, p, k}, "N", "boundary pretension T' of each gene"}, ARRAY(design_N)},
        {{"evaluated",
          HF_KIND_FLAG,
          2,
          {1, p},
          "",
          "TRUE = a trial was evaluated for this place; FALSE: its result was known"},
         ARRAY(pending)}};
    const ga_row behind[] = {
        {{"trial_status", HF_KIND_STATUS, 2, {1, p}, "", "of what was proposed for this place"}, ARRAY(trial_status)},
        {{"trial_psi_m", HF_KIND_REAL, 2, {1, p}, "m", "the same; kept when it was not worse"}, ARRAY(trial_psi_m)},
        {{"crossover_rate", HF_KIND_REAL, 2, {1, p}, "", "that bred the individual"}, ARRAY(crossover_rate)},
        {{"mutation_rate", HF_KIND_REAL, 2, {1, p}, "", "that bred the individual"}, ARRAY(mutation_rate)},
        {{"parent", HF_KIND_INT, 3, {1, p, 2}, "", "individuals of the generation before, or -1; i, -1: i was kept"},
         ARRAY(parent)},
        {{"best_individual", HF_KIND_INT, 1, {1}, "", "-1 while none is feasible"}, SINGLE(now->best)},
        {{"best_psi_m", HF_KIND_REAL, 1, {1}, "m", "of the generation"}, SINGLE(now->best_psi_m[now->generation])},
        {{"least_violation", HF_KIND_REAL, 1, {1}, "", "0: a design is feasible; inf: none has a shape"},
         SINGLE(now->least_violation[now->generation])},
        {{"mean_psi_m", HF_KIND_REAL, 1, {1}, "m", "of the feasible individuals"}, SINGLE(now->mean_psi_m)},
        {{"worst_psi_m", HF_KIND_REAL, 1, {1}, "m", "of the feasible individuals"}, SINGLE(now->worst_psi_m)},
        {{"n_infeasible", HF_KIND_INT, 1, {1}, "", "individuals whose status is not ok"}, SINGLE(now->n_infeasible)}};
#undef ARRAY
#undef SINGLE
    _Static_assert(sizeof before == ROW_RESULT * sizeof row[0], "rows before the results");
    _Static_assert(sizeof behind == (ROW_N - ROW_TRIAL_STATUS) * sizeof row[0], "rows behind the results");
    const hf_result_field *field[HF_RESULT_N_INDIVIDUAL];
    hf_result_list_individual(field);
    memcpy(row, before, sizeof before);
    for (int i = 0; i < HF_RESULT_N_INDIVIDUAL; i++) {
        const hf_result_field *f = field[i];
        row[ROW_RESULT + i] = (ga_row){{f->name, hf_layout_kind_of(f->kind), 2, {1, p}, f->units, f->description},
                                       (const char *)now->result + f->offset,
                                       sizeof *now->result,
                                       f->size};
    }
    memcpy(row + ROW_TRIAL_STATUS, behind, sizeof behind);
    assert(!strcmp(row[ROW_STATUS].array.name, "status") && !strcmp(row[ROW_PSI].array.name, "psi_m") &&
           !strcmp(row[ROW_BEST_INDIVIDUAL].array.name, "best_individual") &&
           !strcmp(row[ROW_BEST_PSI].array.name, "best_psi_m") &&
           !strcmp(row[ROW_TRIAL_STATUS].array.name, "trial_status") &&
           !strcmp(row[ROW_VIOLATION].array.name, "least_violation"));
    return ROW_N;
}

/* The list for its names and sizes alone: the values are not valid. */
static int list_arrays(const hf_generations *g, ga_row row[HF_GENERATIONS_PIECES])
{
    hf_form_result nothing = {0};
    double none = 0;
    const hf_population empty = {.n_individual = g->n_individual,
                                 .n_gene = g->n_gene,
                                 .result = &nothing,
                                 .best_psi_m = &none,
                                 .least_violation = &none};
    return list_rows(&empty, row);
}

/* ---- memory ---- */

static void lay_out(hf_arena *arena, hf_generations *g)
{
    for (int i = 0; i < HF_GENERATIONS_PIECES; i++)
        g->row[i] = hf_arena_take(arena, (size_t)(i == ROW_DESIGN ? g->design_capacity : g->capacity), g->row_bytes[i]);
}

bool hf_generations_are_of(const hf_generations *g, const hf_population *population)
{
    return g->n_individual == population->n_individual && g->n_gene == population->n_gene &&
           g->limit == population->generation_limit;
}

/* At least one, and no more than there can be. */
static int how_many(size_t fit, int limit)
{
    return fit < 1 ? 1 : fit < (size_t)limit ? (int)fit : limit;
}

hf_status hf_generations_create(int n_individual, int n_gene, int limit, hf_generations *g)
{
    ga_row row[HF_GENERATIONS_PIECES];
    hf_arena arena = {0};
    *g = (hf_generations){.n_individual = n_individual, .n_gene = n_gene, .limit = limit};
    int n = list_arrays(g, row);
    for (int i = 0; i < n; i++) {
        g->row_bytes[i] = hf_hdf5_kind_bytes(row[i].array.kind);
        for (int d = 1; d < row[i].array.rank; d++)
            g->row_bytes[i] *= (size_t)row[i].array.dims[d];
        g->payload_bytes += i == ROW_DESIGN ? sizeof g->design_hash : g->row_bytes[i];
    }
    g->capacity = how_many(WAITING_BYTES / g->payload_bytes, limit);
    g->design_chunk = how_many(g->row_bytes[ROW_DESIGN] ? CHUNK_BYTES / g->row_bytes[ROW_DESIGN] : 1, g->capacity);
    g->design_capacity = how_many((size_t)(DESIGN_CHUNKS * g->design_chunk), g->capacity);
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, g)));
    g->block = arena.block;
    return HF_OK;
}

void hf_generations_free(hf_generations *g)
{
    free(g->block);
    *g = (hf_generations){0};
}

/* ---- waiting ---- */

bool hf_generations_are_full(const hf_generations *g)
{
    return g->n_waiting == g->capacity || g->n_design == g->design_capacity;
}

bool hf_generations_are_due(const hf_generations *g)
{
    return g->n_waiting == g->capacity || g->n_design >= g->design_chunk;
}

/* The values of one generation side by side, as HDF5 takes them; an enumeration is an int in memory, a byte there. */
static void gather(const ga_row *row, size_t bytes, char *to)
{
    size_t each = hf_hdf5_kind_bytes(row->array.kind), n = bytes / each;
    const char *from = row->from;
    if (row->item_bytes == each && (row->stride == each || n == 1)) {
        if (bytes) memcpy(to, from, bytes);
        return;
    }
    for (size_t i = 0; i < n; i++, from += row->stride) {
        int value;
        if (row->item_bytes == each) {
            memcpy(to + i * each, from, each);
        } else {
            memcpy(&value, from, sizeof value);
            to[i] = (char)value;
        }
    }
}

static char *slot(const hf_generations *g, int i)
{
    return g->row[i] + (size_t)(i == ROW_DESIGN ? g->n_design : g->n_waiting) * g->row_bytes[i];
}

/* Hash that differs for designs which differ in a bit or in their order: four interleaved chains like FNV-1a, of 8-byte
 * words. */
static uint64_t hash_designs(const hf_population *population)
{
    enum { CHAINS = 4 };
    const uint64_t factor = 0x9e3779b97f4a7c15u; /* odd: multiplication by it is a bijection */
    uint64_t chain[CHAINS] = {1, 2, 3, 4}, bits, all = 0;
    for (size_t i = 0; i < (size_t)population->n_individual * (size_t)population->n_gene; i++) {
        uint64_t *h = &chain[i % CHAINS];
        memcpy(&bits, &population->design_N[i], sizeof bits);
        *h = (*h ^ bits) * factor;
        *h ^= *h >> 32;
    }
    for (int i = 0; i < CHAINS; i++)
        all = (all ^ chain[i]) * factor, all ^= all >> 32;
    return all;
}

void hf_generations_add(hf_generations *g, const hf_population *population, struct iovec *piece)
{
    ga_row row[HF_GENERATIONS_PIECES];
    int n = list_rows(population, row);
    assert(g->n_waiting < g->capacity && hf_generations_are_of(g, population));
    for (int i = 0; i < n; i++) {
        gather(&row[i], g->row_bytes[i], slot(g, i));
        if (piece) piece[i] = (struct iovec){slot(g, i), g->row_bytes[i]};
    }
    if (piece) {
        g->design_hash = hash_designs(population);
        piece[ROW_DESIGN] = (struct iovec){&g->design_hash, sizeof g->design_hash};
    }
    g->n_waiting++;
    g->n_design++;
}

/* Copy the values of one generation back into the population. */
static void scatter(const ga_row *row, size_t bytes, const char *from)
{
    size_t each = hf_hdf5_kind_bytes(row->array.kind), n = bytes / each;
    char *to = (char *)row->from;
    for (size_t i = 0; i < n; i++, to += row->stride) {
        int value = (signed char)from[i];
        if (row->item_bytes == each)
            memcpy(to, from + i * each, each);
        else
            memcpy(to, &value, sizeof value);
    }
}

bool hf_generations_take_payload(const hf_generations *g, const void *payload, const hf_population *before,
                                 hf_population *population)
{
    ga_row row[HF_GENERATIONS_PIECES];
    uint64_t hash;
    int n = list_rows(population, row);
    const char *from = payload;
    memcpy(&hash, from, sizeof hash);
    from += sizeof hash;
    for (int i = ROW_DESIGN + 1; i < n; from += g->row_bytes[i++])
        scatter(&row[i], g->row_bytes[i], from);
    for (int i = 0; i < population->n_individual && before; i++)
        if (population->parent[2 * i] == i && population->parent[2 * i + 1] == -1)
            hf_population_take_over(before, population, i);
    return hash == hash_designs(population);
}

/* Has every value of an enumeration a word? */
static bool are_words(const ga_row *row, int n)
{
    if (row->array.kind->class != HF_HDF5_ENUM) return true;
    const char *from = row->from;
    for (int i = 0; i < n; i++, from += row->stride) {
        int value = *(const signed char *)from;
        if (row->item_bytes == sizeof value) memcpy(&value, from, sizeof value);
        signed char stored = (signed char)value;
        if (stored != value || !hf_hdf5_are_known(row->array.kind, &stored, 1)) return false;
    }
    return true;
}

/* On another machine the bounds may have other last bits. */
static bool is_within(double value, double low, double high)
{
    double slack = 1e-6 * (fabs(low) + fabs(high));
    return value >= low - slack && value <= high + slack;
}

bool hf_generations_are_sound(const hf_population *p)
{
    ga_row row[HF_GENERATIONS_PIECES];
    list_rows(p, row);
    for (int i = ROW_EVALUATED; i < ROW_BEST_INDIVIDUAL; i++)
        if (!are_words(&row[i], p->n_individual)) return false;
    for (int i = 0; i < p->n_individual; i++) {
        const hf_form_result *r = &p->result[i];
        if (r->status == HF_OK && !isfinite(r->psi_m)) return false;
        for (int k = 0; k < 2; k++)
            if (p->parent[2 * i + k] < -1 || p->parent[2 * i + k] >= p->n_individual) return false;
        for (int k = 0; k < p->n_gene; k++)
            if (!is_within(p->design_N[(size_t)i * (size_t)p->n_gene + (size_t)k], p->lower_N[k], p->upper_N[k]))
                return false;
    }
    return true;
}

/* ---- writing ---- */

/* As many rows as fit, but no more than are written at a time; a row larger than CHUNK_BYTES is cut along its other
 * sides. */
static void choose_chunk(const hf_hdf5_array *a, size_t row_bytes, hsize_t rows, hsize_t chunk[3])
{
    size_t fit = row_bytes ? CHUNK_BYTES / row_bytes : rows;
    hsize_t left = CHUNK_MAX / hf_hdf5_kind_bytes(a->kind);
    chunk[0] = fit < 1 ? 1 : fit < rows ? fit : rows;
    for (int i = a->rank - 1; i > 0; i--) {
        chunk[i] = a->dims[i] < 1 ? 1 : a->dims[i] < left ? a->dims[i] : left;
        left = left / chunk[i] ? left / chunk[i] : 1;
    }
}

static hid_t open_arrays(hf_hdf5 *io, const hf_generations *g, ga_row row[HF_GENERATIONS_PIECES])
{
    int n = list_arrays(g, row);
    hid_t group = hf_hdf5_make_group(io, "/ga");
    if (g->n_stored > 0 || hf_hdf5_has(io, group, row[ROW_DESIGN].array.name)) return group;
    for (int i = 0; i < n; i++) {
        hsize_t chunk[3];
        choose_chunk(&row[i].array, g->row_bytes[i], (hsize_t)g->capacity, chunk);
        hf_hdf5_close(io, hf_hdf5_make_array(io, group, &row[i].array, chunk));
    }
    return group;
}

static void write_row(hf_hdf5 *io, const hf_generations *g, hid_t group, ga_row *row, int i, int n)
{
    row[i].array.dims[0] = (hsize_t)n;
    hf_hdf5_write_rows(io, group, &row[i].array, (hsize_t)(g->n_stored + g->n_waiting - n), g->row[i]);
}

void hf_generations_make_room(hf_hdf5 *io, hf_generations *g)
{
    ga_row row[HF_GENERATIONS_PIECES];
    if (io->status != HF_OK) return;
    if (g->n_waiting == g->capacity) {
        hf_generations_write(io, g);
    } else if (g->n_design >= g->design_chunk) {
        hid_t group = open_arrays(io, g, row);
        write_row(io, g, group, row, ROW_DESIGN, g->n_design);
        hf_hdf5_close(io, group);
        g->n_design = 0;
    }
}

void hf_generations_write(hf_hdf5 *io, hf_generations *g)
{
    ga_row row[HF_GENERATIONS_PIECES];
    if (g->n_waiting == 0 || io->status != HF_OK) return;
    hid_t group = open_arrays(io, g, row);
    if (g->n_design) write_row(io, g, group, row, ROW_DESIGN, g->n_design);
    for (int i = ROW_DESIGN + 1; i < HF_GENERATIONS_PIECES; i++)
        write_row(io, g, group, row, i, g->n_waiting);
    hf_hdf5_close(io, group);
    g->n_stored += g->n_waiting;
    g->n_waiting = g->n_design = 0;
}

/* ---- putting back ---- */

int hf_generations_count(hf_hdf5 *io, hf_generations *g)
{
    g->n_stored = 0;
    if (hf_hdf5_has(io, io->file, "/ga") && hf_hdf5_has(io, io->file, "/ga/n_infeasible"))
        g->n_stored = hf_hdf5_length(io, io->file, "/ga/n_infeasible", g->limit);
    return g->n_stored;
}

/* Evaluations of the first n generations, from what was stored, a block of generations at a time. */
static void count_evaluations(hf_hdf5 *io, hid_t group, const hf_generations *g, int n, hf_population *to)
{
    ga_row row[HF_GENERATIONS_PIECES];
    size_t p = (size_t)g->n_individual;
    list_arrays(g, row);
    to->n_evaluation = to->n_evaluation_infeasible = to->n_evaluation_above_cap = 0;
    char *block = malloc(2 * BLOCK * p);
    if (!block) {
        hf_hdf5_no_memory(io);
        return;
    }
    char *status = block + BLOCK * p;
    for (int first = 0; io->status == HF_OK && first < n; first += BLOCK) {
        int some = n - first < BLOCK ? n - first : BLOCK;
        row[ROW_EVALUATED].array.dims[0] = row[ROW_TRIAL_STATUS].array.dims[0] = (hsize_t)some;
        hf_hdf5_read_rows(io, group, &row[ROW_EVALUATED].array, (hsize_t)first, block);
        hf_hdf5_read_rows(io, group, &row[ROW_TRIAL_STATUS].array, (hsize_t)first, status);
        for (size_t i = 0; io->status == HF_OK && i < (size_t)some * p; i++) {
            to->n_evaluation += block[i] != 0;
            to->n_evaluation_infeasible += block[i] != 0 && status[i] != HF_OK;
            to->n_evaluation_above_cap += block[i] != 0 && status[i] == HF_RATIO_CAP;
        }
    }
    free(block);
}

/* Read one figure of the best individual from the data set of its row. */
static void read_of_best(hf_hdf5 *io, hid_t group, const ga_row *row, const hf_result_field *field, hf_summary *s)
{
    size_t n = (size_t)row->array.dims[1], each = hf_hdf5_kind_bytes(row->array.kind);
    char *values = malloc(n * each), *to = (char *)&s->best + field->offset;
    if (!values) hf_hdf5_no_memory(io);
    hf_hdf5_read_rows(io, group, &row->array, (hsize_t)s->best_generation, values);
    if (io->status == HF_OK && s->best_individual >= 0 && (size_t)s->best_individual < n)
        scatter(&(ga_row){row->array, to, 0, field->size}, each, values + (size_t)s->best_individual * each);
    free(values);
}

/* The best as the run noted it: of the first generation with the least psi. Figures that are not stored are NaN. */
static void note_best(hf_hdf5 *io, hid_t group, const ga_row *row, const double *best_psi_m, int n, hf_summary *s)
{
    const hf_result_field *field[HF_RESULT_N_INDIVIDUAL];
    int best = -1;
    for (int i = 0; i < n; i++)
        if (!isnan(best_psi_m[i]) && (best < 0 || best_psi_m[i] < best_psi_m[best])) best = i;
    if (best < 0) return;
    s->best_generation = best;
    s->best = (hf_form_result){.status = HF_OK, .culprit = -1};
    hf_result_blank(&s->best);
    s->best.psi_m = best_psi_m[best];
    hf_hdf5_read_rows(io, group, &row[ROW_BEST_INDIVIDUAL].array, (hsize_t)best, &s->best_individual);
    hf_result_list_individual(field);
    for (int i = 0; i < HF_RESULT_N_INDIVIDUAL; i++)
        read_of_best(io, group, &row[ROW_RESULT + i], field[i], s);
}

void hf_generations_restore(hf_hdf5 *io, const hf_generations *g, hf_population *population)
{
    ga_row row[HF_GENERATIONS_PIECES];
    int last = g->n_stored - 1;
    assert(g->n_waiting == 0 && last >= 0 && hf_generations_are_of(g, population));
    size_t largest = g->row_bytes[0] + (size_t)population->n_individual * 2 * sizeof(double) + sizeof(double);
    char *values = malloc(largest);
    if (!values) {
        hf_hdf5_no_memory(io);
        return;
    }
    hid_t group = hf_hdf5_open_group(io, "/ga");
    population->generation = last;
    int n = list_rows(population, row);
    for (int i = 0; i < n && io->status == HF_OK; i++) {
        assert(g->row_bytes[i] <= largest);
        hf_hdf5_read_rows(io, group, &row[i].array, (hsize_t)last, values);
        if (io->status == HF_OK) scatter(&row[i], g->row_bytes[i], values);
    }
    free(values);
    if (io->status == HF_OK && !hf_generations_are_sound(population))
        hf_hdf5_damaged(io, group, NULL, "has a last generation that no run stores");
    row[ROW_BEST_PSI].array.dims[0] = (hsize_t)g->n_stored;
    row[ROW_VIOLATION].array.dims[0] = (hsize_t)g->n_stored;
    hf_hdf5_read_rows(io, group, &row[ROW_BEST_PSI].array, 0, population->best_psi_m);
    hf_hdf5_read_rows(io, group, &row[ROW_VIOLATION].array, 0, population->least_violation);
    count_evaluations(io, group, g, last, population);
    hf_hdf5_close(io, group);
}

void hf_generations_sum_up(hf_hdf5 *io, const hf_generations *g, hf_summary *s)
{
    ga_row row[HF_GENERATIONS_PIECES];
    if (g->n_stored == 0 || io->status != HF_OK) return;
    int longer = g->n_stored > g->n_individual ? g->n_stored : g->n_individual;
    double *best_psi_m = malloc((size_t)longer * sizeof *best_psi_m);
    if (!best_psi_m) {
        hf_hdf5_no_memory(io);
        return;
    }
    hid_t group = hf_hdf5_open_group(io, "/ga");
    list_arrays(g, row);
    hf_hdf5_read_rows(io, group, &row[ROW_PSI].array, 0, best_psi_m); /* of the first generation */
    if (io->status == HF_OK) s->base_psi_m = best_psi_m[0];
    row[ROW_BEST_PSI].array.dims[0] = (hsize_t)g->n_stored;
    hf_hdf5_read_rows(io, group, &row[ROW_BEST_PSI].array, 0, best_psi_m);
    if (io->status == HF_OK) note_best(io, group, row, best_psi_m, g->n_stored, s);
    hf_population sums;
    count_evaluations(io, group, g, g->n_stored, &sums);
    s->evaluations = sums.n_evaluation;
    s->infeasible = sums.n_evaluation_infeasible;
    s->has_optimize = true;
    s->generations = g->n_stored;
    free(best_psi_m);
    hf_hdf5_close(io, group);
}
