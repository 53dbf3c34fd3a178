/* Implements generations.h. Sections: list of data sets, memory, waiting rows, writing, restoring. */
#include "store/generations.h"

#include "base/arena.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Memory, chunks and time depend on the constants below; the stored values do not. The tests of the store pass within
 * the ranges given. With a CHUNK_BYTES of 25 MiB or a CHUNK_MAX of 100 MiB the test generations_are_appended fails. */
/* Bytes of waiting rows without designs. A generation that is larger waits alone. Tested from 1 to 50 MiB. */
#define WAITING_BYTES (1 << 20)
/* Chunks of designs that may wait; half of them are written at a time. Tested from 1 to 300. */
#define DESIGN_CHUNKS 8
/* Maximum number of rows of a chunk that are no designs, so that a short run has no empty chunks. */
#define CHUNK_ROWS 256
/* Bytes of a chunk of a data set, which has as many rows as fit. Tested from 1 to 256 KiB. */
#define CHUNK_BYTES (256 << 10)
/* Bytes of a chunk of one row that is larger than CHUNK_BYTES: the size of HDF5's cache of a data set. Tested from 1
 * KiB to 1 MiB. */
#define CHUNK_MAX (1 << 20)
/* Factor of hashes: odd, so that multiplication by it is a bijection. */
#define HASH_FACTOR 0x9e3779b97f4a7c15u
/* Generations that are read at a time for the sums. Tested from 1 to 102400. */
#define BLOCK 1024

/* ---- the list of data sets ---- */

/* A data set and the location of its values of one generation: one item after the other, `stride` bytes apart. A data
 * set without bytes is not in the file. */
typedef struct {
    hf_hdf5_array array;
    const void *from;
    size_t stride, item_bytes;
} generation_row;

/* Indices of the data sets. The figures of the individuals are those of <hifdm/result.h>: status first, then psi_m. */
enum {
    HF_ROW_DESIGN,
    HF_ROW_PLACE,
    HF_ROW_EVALUATED,
    HF_ROW_RESULT,
    HF_ROW_STATUS = HF_ROW_RESULT,
    HF_ROW_PSI,
    HF_ROW_OBJECTIVE = HF_ROW_RESULT + HF_RESULT_N_INDIVIDUAL, /* objectives that a case does not have take no bytes */
    HF_ROW_TRIAL_STATUS = HF_ROW_OBJECTIVE + HF_FRONT_OBJECTIVES_MAX,
    HF_ROW_TRIAL_PSI,
    HF_ROW_BREEDING,
    HF_ROW_BEST_INDIVIDUAL = HF_ROW_BREEDING + 3,
    HF_ROW_BEST_PSI,
    HF_ROW_BEST_MERIT,
    HF_ROW_VIOLATION,
    HF_ROW_N = HF_ROW_VIOLATION + 4
};
_Static_assert(HF_ROW_N == HF_GENERATIONS_PIECES, "count the rows again");

/* Returns true for a figure of the whole generation, false for a value per individual. */
static bool is_series(int i)
{
    return i >= HF_ROW_BEST_INDIVIDUAL;
}

/* Returns true if the last generation is stored as a whole beside the rows, which do not have all of it. */
static bool has_last(const hf_generations *g)
{
    return g->every != 1;
}

/* Returns true for a data set that is stored with it: a value per individual, and the designs themselves. */
static bool is_in_last(int i)
{
    return !is_series(i) && i != HF_ROW_PLACE;
}

/* Returns true for a figure of an individual that a kept individual has from the generation before. */
static bool is_result(int i)
{
    return i >= HF_ROW_RESULT && i < HF_ROW_TRIAL_STATUS;
}

/* Returns true if individual i has design and results of an individual of the generation before. */
static bool is_kept(const hf_population *p, int i)
{
    return p->parent[2 * i] >= 0 && p->parent[2 * i] < p->n_individual && p->parent[2 * i + 1] == -1;
}

/* Lists the data sets with their values in a population that hf_optimiser_tell has ranked. The designs are those of the
 * whole population; `design_row` has no values here. */
static void list_rows(const hf_population *now, generation_row row[HF_GENERATIONS_PIECES])
{
    const hsize_t p = (hsize_t)now->n_individual, k = (hsize_t)now->n_variable;
#define ARRAY(member) now->member, sizeof *now->member, sizeof *now->member
#define SINGLE(value) &(value), 0, sizeof(value)
#define ROW(i, name, kind, rank, units, description, ...)                                                              \
    row[i] = (generation_row){{name, HF_KIND_##kind, rank, {1, p, 2}, units, description}, __VA_ARGS__}
    row[HF_ROW_DESIGN] = (generation_row){
        hf_layout_of_variables("design", now->has_rows, 3, (const hsize_t[3]){1, p, k}), ARRAY(design)};
    row[HF_ROW_PLACE] = (generation_row){
        {"design_row", HF_KIND_INT, 2, {1, p}, "", "row of `design` that has the design of each individual"},
        NULL,
        sizeof(int),
        sizeof(int)};
    ROW(HF_ROW_EVALUATED, "evaluated", FLAG, 2, "",
        "TRUE = a trial was evaluated for this individual; FALSE: its result was known", ARRAY(pending));
    ROW(HF_ROW_TRIAL_STATUS, "trial_status", STATUS, 2, "", "of what was proposed for this individual",
        ARRAY(trial_status));
    ROW(HF_ROW_TRIAL_PSI, "trial_psi_m", REAL, 2, "m", "the same; kept when it was not worse", ARRAY(trial_psi_m));
    ROW(HF_ROW_BREEDING, "crossover_rate", REAL, 2, "", "that bred the individual", ARRAY(crossover_rate));
    ROW(HF_ROW_BREEDING + 1, "mutation_rate", REAL, 2, "", "that bred the individual", ARRAY(mutation_rate));
    ROW(HF_ROW_BREEDING + 2, "parent", INT, 3, "", "individuals of the generation before, or -1; i, -1: i was kept",
        ARRAY(parent));
    ROW(HF_ROW_BEST_INDIVIDUAL, "best_individual", INT, 1, "", "-1 while none is feasible", SINGLE(now->best));
    ROW(HF_ROW_BEST_PSI, "best_psi_m", REAL, 1, "m", "of the generation", SINGLE(now->best_psi_m[now->generation]));
    ROW(HF_ROW_BEST_MERIT, "best_merit", REAL, 1, "",
        "of the generation: psi, m, without an objective; the first one of a front",
        SINGLE(now->best_merit[now->generation]));
    ROW(HF_ROW_VIOLATION, "violation_min", REAL, 1, "", "0: a design is feasible; inf: none has a shape",
        SINGLE(now->least_violation[now->generation]));
    ROW(HF_ROW_VIOLATION + 1, "mean_psi_m", REAL, 1, "m", "of the feasible individuals", SINGLE(now->mean_psi_m));
    ROW(HF_ROW_VIOLATION + 2, "worst_psi_m", REAL, 1, "m", "of the feasible individuals", SINGLE(now->worst_psi_m));
    ROW(HF_ROW_VIOLATION + 3, "n_infeasible", INT, 1, "", "individuals whose status is not ok",
        SINGLE(now->n_infeasible));
    const hf_result_field *field[HF_RESULT_N_INDIVIDUAL];
    hf_result_list_individual(field);
    for (int i = 0; i < HF_RESULT_N_INDIVIDUAL; i++) {
        const hf_result_field *f = field[i];
        row[HF_ROW_RESULT + i] =
            (generation_row){{f->name, hf_layout_kind_of(f), 2, {1, p}, f->units ? f->units : "", f->description},
                             (const char *)now->result + f->offset,
                             sizeof *now->result,
                             f->size};
    }
    for (int i = 0; i < HF_FRONT_OBJECTIVES_MAX; i++) {
        static const char *const name[] = {"objective_0", "objective_1", "objective_2"};
        _Static_assert(sizeof name / sizeof *name == HF_FRONT_OBJECTIVES_MAX, "a name for each objective");
        hsize_t n = i < now->n_objective ? p : 0;
        row[HF_ROW_OBJECTIVE + i] =
            (generation_row){{name[i], HF_KIND_REAL, 2, {1, n}, "", "of optimize.front, each in its own unit"},
                             &now->result->objective[i],
                             sizeof *now->result,
                             sizeof(double)};
    }
}

/* Lists names and sizes alone, for n_individual individuals. The pointers to values are not valid. */
static void list_empty(const hf_generations *g, int n_individual, generation_row row[HF_GENERATIONS_PIECES])
{
    hf_form_result nothing = {0};
    double none = 0;
    const hf_population empty = {.n_individual = n_individual,
                                 .n_variable = g->n_variable,
                                 .n_objective = g->n_objective,
                                 .has_rows = g->has_rows,
                                 .result = &nothing,
                                 .best_psi_m = &none,
                                 .best_merit = &none,
                                 .least_violation = &none};
    list_rows(&empty, row);
}

/* Attributes of /search/population/last, in the order of hf_generations.count. */
static const char *const count_name[HF_GENERATIONS_COUNTS] = {"n_evaluation", "n_evaluation_infeasible",
                                                              "n_evaluation_above_cap"};

/* Adds sign times the evaluations of a generation to `count`: all of them, those without a feasible design, and those
 * among the latter that have a shape. */
static void tally(const hf_population *p, int sign, long count[HF_GENERATIONS_COUNTS])
{
    for (int i = 0; i < p->n_individual; i++) {
        count[0] += p->pending[i] ? sign : 0;
        count[1] += p->pending[i] && p->trial_status[i] != HF_OK ? sign : 0;
        count[2] += p->pending[i] && p->trial_status[i] != HF_OK && hf_status_has_shape(p->trial_status[i]) ? sign : 0;
    }
}

/* Copies the values of one generation between the population and `packed`, where they are side by side as HDF5 takes
 * them: to `packed` with `packs`, else back. bytes: of all of them there. */
static void copy_values(const generation_row *row, size_t bytes, bool packs, char *packed)
{
    size_t each = hf_hdf5_kind_bytes(row->array.kind);
    hf_layout_copy(row->array.kind, each, row->item_bytes, row->stride, (int)(bytes / each), packs, packed,
                   (char *)row->from);
}

/* ---- memory ---- */

/* Returns the number of individuals in one row. */
static int n_in_row(const hf_generations *g)
{
    return g->every == HF_GENERATIONS_BEST ? 1 : g->n_individual;
}

/* Returns how many rows of individuals the first n generations have. */
static int rows_of(const hf_generations *g, int n)
{
    return g->every > 1 ? (n + g->every - 1) / g->every : n;
}

static void lay_out(hf_arena *arena, hf_generations *g)
{
    for (int i = 0; i < HF_GENERATIONS_PIECES; i++) {
        g->row[i] =
            hf_arena_take(arena, (size_t)(i == HF_ROW_DESIGN ? g->design_capacity : g->capacity), g->row_bytes[i]);
        g->last[i] = hf_arena_take(arena, has_last(g) && is_in_last(i), g->whole_bytes[i]);
    }
    g->design_row = hf_arena_take(arena, (size_t)n_in_row(g), sizeof(int));
    g->design = hf_arena_take(arena, (size_t)n_in_row(g), g->row_bytes[HF_ROW_DESIGN]);
    g->hash = hf_arena_take(arena, (size_t)n_in_row(g), sizeof *g->hash);
    g->fresh = hf_arena_take(arena, (size_t)g->n_individual, g->fresh_bytes);
}

bool hf_generations_are_of(const hf_generations *g, const hf_population *population)
{
    return g->n_individual == population->n_individual && g->n_variable == population->n_variable &&
           g->n_objective == population->n_objective && g->limit == population->generation_limit;
}

/* Returns `fit`, but at least 1 and at most `limit`. */
static int how_many(size_t fit, int limit)
{
    return fit < 1 ? 1 : fit < (size_t)limit ? (int)fit : limit;
}

/* Sets the bytes of one generation of n_individual individuals in each data set. */
static void measure_rows(const hf_generations *g, int n_individual, size_t bytes[HF_GENERATIONS_PIECES])
{
    generation_row row[HF_GENERATIONS_PIECES];
    list_empty(g, n_individual, row);
    assert(!strcmp(row[HF_ROW_STATUS].array.name, "status") && !strcmp(row[HF_ROW_PSI].array.name, "psi_m"));
    for (int i = 0; i < HF_GENERATIONS_PIECES; i++) {
        bytes[i] = hf_hdf5_kind_bytes(row[i].array.kind);
        for (int d = 1; d < row[i].array.rank; d++)
            bytes[i] *= (size_t)row[i].array.dims[d];
    }
}

hf_status hf_generations_create(hf_generations *g)
{
    hf_arena arena = {0};
    size_t waiting = 0, bytes = 0;
    g->base_psi_m = (double)NAN;
    measure_rows(g, g->n_individual, g->whole_bytes);
    measure_rows(g, n_in_row(g), g->row_bytes);
    g->row_bytes[HF_ROW_DESIGN] = (size_t)g->n_variable * sizeof(double);
    for (int i = HF_ROW_PLACE; i < HF_GENERATIONS_PIECES; i++) {
        bytes += is_result(i) ? g->whole_bytes[i] : 0;
        waiting += g->row_bytes[i];
    }
    g->fresh_bytes = bytes / (size_t)g->n_individual;
    g->capacity = how_many(WAITING_BYTES / waiting, g->limit);
    int most = g->capacity * n_in_row(g);
    g->design_chunk = how_many(g->n_variable ? CHUNK_BYTES / g->row_bytes[HF_ROW_DESIGN] : 1, most);
    g->design_capacity = how_many((size_t)(DESIGN_CHUNKS * g->design_chunk + n_in_row(g)), most);
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, g)));
    g->block = arena.block;
    return HF_OK;
}

void hf_generations_free(hf_generations *g)
{
    hf_arena_free_block(g->block);
    *g = (hf_generations){0};
}

/* ---- waiting ---- */

bool hf_generations_are_full(const hf_generations *g)
{
    return g->n_waiting == g->capacity || g->n_design + n_in_row(g) > g->design_capacity;
}

bool hf_generations_are_due(const hf_generations *g)
{
    return g->n_waiting == g->capacity || (g->n_design >= g->design_chunk && 2 * g->n_design >= g->design_capacity);
}

static char *slot(const hf_generations *g, int i)
{
    int n = is_series(i)         ? g->n_waiting
            : i == HF_ROW_DESIGN ? g->n_design
                                 : rows_of(g, g->n_stored + g->n_waiting) - rows_of(g, g->n_stored);
    return g->row[i] + (size_t)n * g->row_bytes[i];
}

/* Takes a word of 8 bytes into a chain of a hash. If chain or word is fixed, the result is a bijection of the other. */
static uint64_t hash_word(uint64_t chain, const void *word)
{
    uint64_t bits;
    memcpy(&bits, word, sizeof bits);
    chain = (chain ^ bits) * HASH_FACTOR;
    return chain ^ chain >> 32;
}

/* Returns a hash of a design that depends on every bit. Eight interleaved chains are similar to FNV-1a. */
static uint64_t hash_design(const double *design, int n)
{
    enum { CHAINS = 8 };
    uint64_t chain[CHAINS] = {0}, all = 0;
    int i = 0;
    for (; i + CHAINS <= n; i += CHAINS)
        for (int c = 0; c < CHAINS; c++)
            chain[c] = hash_word(chain[c], &design[i + c]);
    for (int c = 0; i + c < n; c++)
        chain[c] = hash_word(chain[c], &design[i + c]);
    for (int c = 0; c < CHAINS; c++) /* odd factors */
        all += chain[c] * (HASH_FACTOR + 2 * (uint64_t)c);
    return all ^ all >> 32;
}

/* Returns a hash of all designs and of their order. known: hashes of the designs, or NULL. */
static uint64_t hash_designs(const hf_population *population, const uint64_t *known)
{
    uint64_t all = 0;
    for (int i = 0, k = population->n_variable; i < population->n_individual; i++) {
        all = (all ^ (known ? known[i] : hash_design(population->design + (size_t)i * (size_t)k, k))) * HASH_FACTOR;
        all ^= all >> 32;
    }
    return all;
}

/* Returns the row that the next design gets. */
static int next_design_row(const hf_generations *g)
{
    return g->n_design_stored + g->n_design;
}

/* Adds the designs of a row of individuals that are not those of the row before, and the row of each. population: if it
 * is the generation after that row, else NULL. */
static void add_designs(hf_generations *g, const double *design, const hf_population *population)
{
    size_t k = (size_t)g->n_variable, bytes = g->row_bytes[HF_ROW_DESIGN];
    bool is_first = next_design_row(g) == 0;
    for (int i = 0; i < n_in_row(g); i++) {
        const double *now = design + (size_t)i * k;
        double *before = g->design + (size_t)i * k;
        bool is_same = population && is_kept(population, i) && population->parent[2 * i] == i;
        if (!is_first && (is_same || !memcmp(before, now, bytes))) continue;
        memcpy(before, now, bytes);
        memcpy(slot(g, HF_ROW_DESIGN), now, bytes);
        g->design_row[i] = next_design_row(g);
        g->hash[i] = hash_design(now, g->n_variable);
        g->n_design++;
    }
    memcpy(slot(g, HF_ROW_PLACE), g->design_row, g->row_bytes[HF_ROW_PLACE]);
}

/* Adds the rows of individuals that the file keeps of a generation. The whole generation is in g->last already. */
static void add_part(hf_generations *g, const hf_population *population)
{
    bool is_best = g->every == HF_GENERATIONS_BEST;
    int nearest = is_best ? hf_population_nearest(population) : 0;
    size_t first = nearest < 0 ? 0 : (size_t)nearest; /* of a generation without shapes the first one */
    if (!is_best && (g->n_stored + g->n_waiting) % g->every != 0) return;
    add_designs(g, population->design + first * (size_t)g->n_variable, NULL);
    for (int i = HF_ROW_EVALUATED; !is_series(i); i++)
        if (g->row_bytes[i]) memcpy(slot(g, i), g->last[i] + first * g->row_bytes[i], g->row_bytes[i]);
}

/* Copies the results of the individuals that are not kept from `packed` to g->fresh. Returns their number. */
static int pack_fresh(hf_generations *g, const hf_population *population, char *const packed[HF_GENERATIONS_PIECES])
{
    char *to = g->fresh;
    int n = 0;
    for (int i = 0; i < g->n_individual; i++) {
        if (is_kept(population, i)) continue;
        for (int k = HF_ROW_RESULT; is_result(k); k++) {
            size_t each = g->whole_bytes[k] / (size_t)g->n_individual;
            const char *from = packed[k] + (size_t)i * each;
            if (each == sizeof(double)) /* without a call */
                memcpy(to, from, sizeof(double));
            else
                memcpy(to, from, each);
            to += each;
        }
        n++;
    }
    return n;
}

/* Returns the bytes of a piece of a payload. */
static size_t piece_bytes(const hf_generations *g, const hf_generations_head *head, int i)
{
    if (i == HF_ROW_DESIGN) return sizeof *head;
    if (i == HF_ROW_PLACE) return head->n_new >= 0 && !has_last(g) ? g->row_bytes[i] : 0;
    if (i == HF_ROW_RESULT) return (size_t)head->n_fresh * g->fresh_bytes;
    if (i == HF_GENERATIONS_PIECES) return head->n_new > 0 ? (size_t)head->n_new * g->row_bytes[HF_ROW_DESIGN] : 0;
    bool is_proposed = i == HF_ROW_BREEDING || i == HF_ROW_BREEDING + 1; /* known again when breeding is repeated */
    return is_result(i) || is_proposed ? 0 : g->whole_bytes[i];
}

void hf_generations_add(hf_generations *g, const hf_population *population, struct iovec *piece)
{
    generation_row row[HF_GENERATIONS_PIECES];
    char *packed[HF_GENERATIONS_PAYLOAD];
    int n_design = g->n_design;
    list_rows(population, row);
    assert(g->n_waiting < g->capacity && hf_generations_are_of(g, population));
    for (int i = HF_ROW_EVALUATED; i < HF_GENERATIONS_PIECES; i++) {
        packed[i] = has_last(g) && !is_series(i) ? g->last[i] : slot(g, i);
        copy_values(&row[i], g->whole_bytes[i], true, packed[i]);
    }
    packed[HF_GENERATIONS_PIECES] = has_last(g) ? (char *)population->design : slot(g, HF_ROW_DESIGN);
    if (has_last(g)) {
        memcpy(g->last[HF_ROW_DESIGN], population->design, g->whole_bytes[HF_ROW_DESIGN]);
        add_part(g, population);
    } else {
        add_designs(g, population->design, population);
    }
    if (piece) {
        int n_new = has_last(g) ? g->n_individual : g->n_design - n_design;
        g->head = (hf_generations_head){.hash = hash_designs(population, has_last(g) ? NULL : g->hash),
                                        .n_fresh = pack_fresh(g, population, packed),
                                        .n_new = population->is_moved ? n_new : -1};
        packed[HF_ROW_DESIGN] = (char *)&g->head;
        packed[HF_ROW_PLACE] = (char *)g->design_row;
        packed[HF_ROW_RESULT] = g->fresh;
        for (int i = 0; i < HF_GENERATIONS_PAYLOAD; i++)
            piece[i] = (struct iovec){packed[i], piece_bytes(g, &g->head, i)};
    }
    tally(population, 1, g->count);
    if (g->n_stored + g->n_waiting == 0) g->base_psi_m = population->result[0].psi_m;
    g->n_waiting++;
}

bool hf_generations_are_payload(const hf_generations *g, const void *payload, size_t bytes)
{
    hf_generations_head head;
    size_t all = 0;
    if (bytes < sizeof head) return false;
    memcpy(&head, payload, sizeof head);
    if (head.n_fresh < 0 || head.n_fresh > g->n_individual || head.n_new < -1 || head.n_new > g->n_individual)
        return false;
    if (has_last(g) && head.n_new >= 0 && head.n_new < g->n_individual) return false;
    for (int i = 0; i < HF_GENERATIONS_PAYLOAD; i++)
        all += piece_bytes(g, &head, i);
    return bytes == all;
}

/* Copies the n_new designs of a payload, which are those of individuals with a new row of designs. The others have the
 * designs of the generation before. Returns false if these are not n_new individuals. */
static bool take_designs(const hf_generations *g, const char *places, const char *from, int n_new,
                         hf_population *population)
{
    size_t bytes = g->row_bytes[HF_ROW_DESIGN];
    int next = next_design_row(g), place;
    for (int i = 0; i < g->n_individual; i++) {
        memcpy(&place, places + (size_t)i * sizeof place, sizeof place);
        bool is_new = place == next;
        if (is_new ? n_new-- == 0 : next_design_row(g) == 0 || place != g->design_row[i]) return false;
        memcpy((char *)population->design + (size_t)i * bytes,
               is_new ? from : (const char *)g->design + (size_t)i * bytes, bytes);
        from += is_new ? bytes : 0;
        next += is_new;
    }
    return n_new == 0;
}

/* Copies the results of the individuals that are not kept, and takes over the others from the generation before.
 * Returns false if these are not n_fresh individuals. */
static bool take_results(const hf_generations *g, const generation_row *row, const char *from, int n_fresh,
                         const hf_population *before, hf_population *population)
{
    for (int i = 0; i < g->n_individual; i++) {
        bool is_fresh = !is_kept(population, i);
        if (is_fresh ? n_fresh-- == 0 : !before) return false;
        if (!is_fresh) hf_population_take_over(before, population->parent[2 * i], population, i);
        for (int k = HF_ROW_RESULT; is_fresh && is_result(k); k++) {
            generation_row one = row[k];
            size_t each = g->whole_bytes[k] / (size_t)g->n_individual;
            one.from = (const char *)row[k].from + (size_t)i * row[k].stride;
            copy_values(&one, each, false, (char *)from);
            from += each;
        }
    }
    return n_fresh == 0;
}

bool hf_generations_take_payload(const hf_generations *g, const void *payload, const hf_population *before,
                                 hf_population *population)
{
    generation_row row[HF_GENERATIONS_PIECES];
    hf_generations_head head;
    const char *piece[HF_GENERATIONS_PAYLOAD], *from = payload;
    list_rows(population, row);
    memcpy(&head, payload, sizeof head);
    for (int i = 0; i < HF_GENERATIONS_PAYLOAD; from += piece_bytes(g, &head, i++))
        piece[i] = from;
    for (int i = HF_ROW_EVALUATED; i < HF_GENERATIONS_PIECES; i++)
        if (!is_result(i)) copy_values(&row[i], piece_bytes(g, &head, i), false, (char *)piece[i]);
    if (!take_results(g, row, piece[HF_ROW_RESULT], head.n_fresh, before, population)) return false;
    from = piece[HF_GENERATIONS_PIECES];
    if (head.n_new >= 0 && has_last(g)) memcpy(population->design, from, g->whole_bytes[HF_ROW_DESIGN]);
    if (head.n_new >= 0 && !has_last(g) && !take_designs(g, piece[HF_ROW_PLACE], from, head.n_new, population))
        return false;
    return head.hash == hash_designs(population, NULL);
}

/* Returns true if every value of an enumeration has a word. Values of other kinds need none. */
static bool are_words(const generation_row *row, int n)
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

bool hf_generations_are_sound(const hf_population *p)
{
    generation_row row[HF_GENERATIONS_PIECES];
    list_rows(p, row);
    if (p->best < -1 || p->best >= p->n_individual) return false;
    for (int i = HF_ROW_EVALUATED; i < HF_ROW_BEST_INDIVIDUAL; i++)
        if (!are_words(&row[i], p->n_individual)) return false;
    for (int i = 0; i < p->n_individual; i++) {
        const hf_form_result *r = &p->result[i];
        if (r->status == HF_OK && !(isfinite(r->psi_m) && isfinite(r->merit))) return false;
        for (int k = 0; k < p->n_objective; k++)
            if (r->status == HF_OK && !isfinite(r->objective[k])) return false;
        for (int k = 0; k < 2; k++)
            if (p->parent[2 * i + k] < -1 || p->parent[2 * i + k] >= p->n_individual) return false;
        for (int k = 0; k < p->n_variable; k++) {
            double value = p->design[(size_t)i * (size_t)p->n_variable + (size_t)k];
            double slack = 1e-6 * (fabs(p->lower[k]) + fabs(p->upper[k])); /* last bits of another machine */
            if (!(value >= p->lower[k] - slack && value <= p->upper[k] + slack)) return false;
        }
    }
    return true;
}

/* ---- writing ---- */

/* Returns false for an objective that the case does not have. */
static bool is_stored(const hf_generations *g, int i)
{
    return i < HF_ROW_OBJECTIVE + g->n_objective || i >= HF_ROW_OBJECTIVE + HF_FRONT_OBJECTIVES_MAX;
}

/* Describes rows of designs: a design each. */
static hf_hdf5_array array_of_designs(const hf_generations *g, int n)
{
    return hf_layout_of_variables("design", g->has_rows, 2, (const hsize_t[2]){(hsize_t)n, (hsize_t)g->n_variable});
}

/* Makes a data set with as many rows per chunk as fit, but no more than are written at a time. A row larger than
 * CHUNK_BYTES is divided along its other dimensions. */
static void make_array(hf_hdf5 *io, hid_t group, const generation_row *row, size_t row_bytes, int rows)
{
    const hf_hdf5_array *a = &row->array;
    hsize_t chunk[3] = {(hsize_t)how_many(row_bytes ? CHUNK_BYTES / row_bytes : (size_t)rows, rows)};
    hsize_t left = CHUNK_MAX / hf_hdf5_kind_bytes(a->kind);
    for (int i = a->rank - 1; i > 0; i--) {
        chunk[i] = a->dims[i] < 1 ? 1 : a->dims[i] < left ? a->dims[i] : left;
        left = left / chunk[i] ? left / chunk[i] : 1;
    }
    hf_hdf5_close(io, hf_hdf5_make_array(io, group, a, chunk, false));
}

static hid_t open_arrays(hf_hdf5 *io, const hf_generations *g, generation_row row[HF_GENERATIONS_PIECES])
{
    list_empty(g, n_in_row(g), row);
    row[HF_ROW_DESIGN].array = array_of_designs(g, 1);
    hid_t group = hf_hdf5_make_group(io, HF_GENERATIONS_GROUP);
    if (g->n_stored > 0 || hf_hdf5_has(io, group, row[HF_ROW_DESIGN].array.name)) return group;
    for (int i = 0; i < HF_GENERATIONS_PIECES; i++)
        if (is_stored(g, i))
            make_array(io, group, &row[i], g->row_bytes[i],
                       i == HF_ROW_DESIGN ? g->design_chunk : how_many(CHUNK_ROWS, g->capacity));
    return group;
}

/* Writes the first n waiting designs. */
static void write_designs(hf_hdf5 *io, hf_generations *g, hid_t group, int n)
{
    const hf_hdf5_array array = array_of_designs(g, n);
    size_t bytes = g->row_bytes[HF_ROW_DESIGN];
    char *from = g->row[HF_ROW_DESIGN];
    if (n == 0) return;
    hf_hdf5_write_rows(io, group, &array, (hsize_t)g->n_design_stored, from);
    memmove(from, from + (size_t)n * bytes, (size_t)(g->n_design - n) * bytes);
    g->n_design_stored += n;
    g->n_design -= n;
}

/* Writes the n waiting rows of data set i. They are its last rows so far. */
static void write_row(hf_hdf5 *io, const hf_generations *g, hid_t group, generation_row *row, int i, int n)
{
    int end = g->n_stored + g->n_waiting;
    if (!is_series(i)) end = rows_of(g, end);
    row[i].array.dims[0] = (hsize_t)n;
    if (n > 0 && is_stored(g, i)) hf_hdf5_write_rows(io, group, &row[i].array, (hsize_t)(end - n), g->row[i]);
}

/* Writes the last generation as a whole, from which a run is resumed, and the counts of all generations so far. */
static void write_last(hf_hdf5 *io, const hf_generations *g)
{
    generation_row row[HF_GENERATIONS_PIECES];
    list_empty(g, g->n_individual, row);
    hid_t group = hf_hdf5_make_group(io, HF_GENERATIONS_GROUP "/last");
    bool is_new = !hf_hdf5_has(io, group, row[HF_ROW_DESIGN].array.name);
    for (int i = 0; !is_series(i); i++) {
        if (!is_stored(g, i) || !is_in_last(i)) continue;
        if (is_new) make_array(io, group, &row[i], g->whole_bytes[i], 1);
        hf_hdf5_write_rows(io, group, &row[i].array, 0, g->last[i]);
    }
    for (int i = 0; i < HF_GENERATIONS_COUNTS; i++)
        hf_hdf5_put(io, group, ".", count_name[i], HF_KIND_LONG, 0, &g->count[i]);
    hf_hdf5_close(io, group);
}

void hf_generations_make_room(hf_hdf5 *io, hf_generations *g)
{
    generation_row row[HF_GENERATIONS_PIECES];
    if (io->status != HF_OK) return;
    if (g->n_waiting == g->capacity) {
        hf_generations_write(io, g);
    } else if (g->n_design >= g->design_chunk) {
        hid_t group = open_arrays(io, g, row);
        write_designs(io, g, group,
                      (g->n_design_stored + g->n_design) / g->design_chunk * g->design_chunk - g->n_design_stored);
        hf_hdf5_close(io, group);
    }
}

void hf_generations_write(hf_hdf5 *io, hf_generations *g)
{
    generation_row row[HF_GENERATIONS_PIECES];
    if (g->n_waiting == 0 || io->status != HF_OK) return;
    hid_t group = open_arrays(io, g, row);
    int n_row = rows_of(g, g->n_stored + g->n_waiting) - rows_of(g, g->n_stored);
    write_designs(io, g, group, g->n_design);
    for (int i = HF_ROW_PLACE; i < HF_GENERATIONS_PIECES; i++)
        write_row(io, g, group, row, i, is_series(i) ? g->n_waiting : n_row);
    hf_hdf5_close(io, group);
    if (has_last(g)) write_last(io, g);
    g->n_stored += g->n_waiting;
    g->n_waiting = 0;
}

/* ---- putting back ---- */

int hf_generations_count(hf_hdf5 *io, hf_generations *g)
{
    g->n_stored = g->n_design_stored = 0;
    if (hf_hdf5_has(io, io->file, HF_GENERATIONS_GROUP "/n_infeasible")) {
        g->n_stored = hf_hdf5_length(io, io->file, HF_GENERATIONS_GROUP "/n_infeasible", g->limit);
        g->n_design_stored = hf_hdf5_length(io, io->file, HF_GENERATIONS_GROUP "/design", INT_MAX);
    }
    for (int i = 0; has_last(g) && g->n_stored > 0 && i < HF_GENERATIONS_COUNTS; i++)
        hf_hdf5_get(io, io->file, HF_GENERATIONS_GROUP "/last", count_name[i], HF_KIND_LONG, &g->count[i],
                    sizeof g->count[i]);
    return g->n_stored;
}

/* Reads n rows of a data set from row `first` on. */
static void read_some(hf_hdf5 *io, hid_t group, generation_row *row, int first, int n, void *values)
{
    row->array.dims[0] = (hsize_t)n;
    hf_hdf5_read_rows(io, group, &row->array, (hsize_t)first, values);
}

/* Opens the group in which the last generation is stored as a whole. */
static hid_t open_whole(hf_hdf5 *io, const hf_generations *g)
{
    return hf_hdf5_open_group(io, has_last(g) ? HF_GENERATIONS_GROUP "/last" : HF_GENERATIONS_GROUP);
}

/* Counts the evaluations of the first n generations in the file, one block of generations at a time. */
static void count_evaluations(hf_hdf5 *io, hid_t group, const hf_generations *g, int n,
                              long count[HF_GENERATIONS_COUNTS])
{
    generation_row row[HF_GENERATIONS_PIECES];
    size_t p = (size_t)g->n_individual;
    list_empty(g, g->n_individual, row);
    memset(count, 0, HF_GENERATIONS_COUNTS * sizeof *count);
    char *block = hf_hdf5_take(io, 2 * BLOCK, p), *status = block + BLOCK * p;
    for (int first = 0; io->status == HF_OK && first < n; first += BLOCK) {
        int some = n - first < BLOCK ? n - first : BLOCK;
        read_some(io, group, &row[HF_ROW_EVALUATED], first, some, block);
        read_some(io, group, &row[HF_ROW_TRIAL_STATUS], first, some, status);
        for (size_t i = 0; io->status == HF_OK && i < (size_t)some * p; i++) {
            count[0] += block[i] != 0;
            count[1] += block[i] != 0 && status[i] != HF_OK;
            count[2] += block[i] != 0 && status[i] != HF_OK && hf_status_has_shape((hf_status)status[i]);
        }
    }
    free(block);
}

/* Reads one figure of an individual, which row `at` of the data set has, to `to`. */
static void read_of_best(hf_hdf5 *io, hid_t group, generation_row row, int at, int individual, void *to)
{
    size_t n = (size_t)row.array.dims[1], each = hf_hdf5_kind_bytes(row.array.kind);
    char *values = hf_hdf5_take(io, n, each);
    hf_hdf5_read_rows(io, group, &row.array, (hsize_t)at, values);
    row.from = to;
    if (io->status == HF_OK && individual >= 0 && (size_t)individual < n)
        copy_values(&row, each, false, values + (size_t)individual * each);
    free(values);
}

/* Sets the best design of the summary: that of the first generation with the minimum merit. The best design stays in
 * the population, so /search/population/last has its figures. Figures that are not stored are NaN. */
static void note_best(hf_hdf5 *io, hid_t group, const hf_generations *g, const double *best_merit, hf_summary *s)
{
    generation_row row[HF_GENERATIONS_PIECES];
    const hf_result_field *field[HF_RESULT_N_INDIVIDUAL];
    bool is_whole = has_last(g);
    int best = -1, individual = -1, last = g->n_stored - 1;
    for (int i = 0; i <= last; i++)
        if (!isnan(best_merit[i]) && (best < 0 || best_merit[i] < best_merit[best])) best = i;
    if (best < 0) return;
    list_empty(g, g->n_individual, row);
    s->search.best_generation = best;
    hf_form_result *result = &s->stage[HF_STAGE_SEARCH].result;
    *result = (hf_form_result){.status = HF_OK, .culprit = -1};
    hf_result_blank(result);
    result->merit = best_merit[best];
    read_some(io, group, &row[HF_ROW_BEST_PSI], best, 1, &result->psi_m);
    read_some(io, group, &row[HF_ROW_BEST_INDIVIDUAL], best, 1, &s->search.best_individual);
    read_some(io, group, &row[HF_ROW_BEST_INDIVIDUAL], is_whole ? last : best, 1, &individual);
    hid_t whole = open_whole(io, g);
    hf_result_list_individual(field);
    for (int i = 0; i < HF_RESULT_N_INDIVIDUAL; i++)
        read_of_best(io, whole, row[HF_ROW_RESULT + i], is_whole ? 0 : best, individual,
                     (char *)result + field[i]->offset);
    for (int k = 0; k < g->n_objective; k++)
        read_of_best(io, whole, row[HF_ROW_OBJECTIVE + k], is_whole ? 0 : best, individual, &result->objective[k]);
    hf_hdf5_close(io, whole);
}

/* Restores the counts of the generations before the last one. hf_optimiser_tell will add those of the last one. */
static void restore_counts(hf_hdf5 *io, hid_t group, const hf_generations *g, hf_population *p)
{
    long count[HF_GENERATIONS_COUNTS];
    memcpy(count, g->count, sizeof count);
    if (has_last(g))
        tally(p, -1, count);
    else
        count_evaluations(io, group, g, g->n_stored - 1, count);
    p->n_evaluation = count[0];
    p->n_evaluation_infeasible = count[1];
    p->n_evaluation_above_cap = count[2];
}

/* Reads the designs of the last row of individuals. */
static void read_designs(hf_hdf5 *io, hid_t group, hf_generations *g)
{
    generation_row row[HF_GENERATIONS_PIECES];
    list_empty(g, n_in_row(g), row);
    const hf_hdf5_array one = array_of_designs(g, 1);
    read_some(io, group, &row[HF_ROW_PLACE], rows_of(g, g->n_stored) - 1, 1, g->design_row);
    for (int i = 0; i < n_in_row(g) && io->status == HF_OK; i++) {
        if (g->design_row[i] < 0 || g->design_row[i] >= g->n_design_stored)
            hf_hdf5_damaged(io, group, row[HF_ROW_PLACE].array.name, "points to a design that is not there");
        double *design = g->design + (size_t)i * (size_t)g->n_variable;
        hf_hdf5_read_rows(io, group, &one, (hsize_t)g->design_row[i], design);
        g->hash[i] = hash_design(design, g->n_variable);
    }
}

void hf_generations_restore(hf_hdf5 *io, hf_generations *g, hf_population *population)
{
    generation_row row[HF_GENERATIONS_PIECES];
    int last = g->n_stored - 1;
    assert(g->n_waiting == 0 && last >= 0 && hf_generations_are_of(g, population));
    size_t largest = g->whole_bytes[0] + (size_t)population->n_individual * 2 * sizeof(double) + sizeof(double);
    char *values = hf_hdf5_take(io, largest, 1);
    if (!values) return;
    hid_t group = hf_hdf5_open_group(io, HF_GENERATIONS_GROUP), whole = open_whole(io, g);
    population->generation = last;
    list_rows(population, row);
    read_designs(io, group, g);
    if (!has_last(g)) memcpy(population->design, g->design, g->whole_bytes[HF_ROW_DESIGN]);
    for (int i = has_last(g) ? 0 : HF_ROW_EVALUATED; i < HF_GENERATIONS_PIECES && io->status == HF_OK; i++) {
        bool is_alone = has_last(g) && !is_series(i);
        assert(g->whole_bytes[i] <= largest);
        if (!is_stored(g, i) || i == HF_ROW_PLACE) continue;
        hf_hdf5_read_rows(io, is_alone ? whole : group, &row[i].array, is_alone ? 0 : (hsize_t)last, values);
        if (io->status == HF_OK) copy_values(&row[i], g->whole_bytes[i], false, values);
    }
    free(values);
    if (io->status == HF_OK && !hf_generations_are_sound(population))
        hf_hdf5_damaged(io, group, NULL, "has a last generation that no run stores");
    read_some(io, group, &row[HF_ROW_BEST_PSI], 0, g->n_stored, population->best_psi_m);
    read_some(io, group, &row[HF_ROW_BEST_MERIT], 0, g->n_stored, population->best_merit);
    read_some(io, group, &row[HF_ROW_VIOLATION], 0, g->n_stored, population->least_violation);
    restore_counts(io, group, g, population);
    HF_HDF5_CLOSE(io, whole, group);
}

void hf_generations_sum_up(hf_hdf5 *io, const hf_generations *g, hf_summary *s)
{
    generation_row row[HF_GENERATIONS_PIECES];
    if (g->n_stored == 0 || io->status != HF_OK) return;
    int longer = g->n_stored > g->n_individual ? g->n_stored : g->n_individual;
    double *values = hf_hdf5_take(io, (size_t)longer, sizeof *values);
    if (!values) return;
    long count[HF_GENERATIONS_COUNTS];
    hid_t group = hf_hdf5_open_group(io, HF_GENERATIONS_GROUP);
    list_empty(g, g->n_individual, row);
    if (isfinite(g->base_psi_m)) s->search.initial_psi_m = g->base_psi_m;
    if (g->every != HF_GENERATIONS_BEST) {
        hf_hdf5_read_rows(io, group, &row[HF_ROW_PSI].array, 0, values); /* the first generation */
        if (io->status == HF_OK) s->search.initial_psi_m = values[0];
    }
    read_some(io, group, &row[HF_ROW_BEST_MERIT], 0, g->n_stored, values);
    if (io->status == HF_OK) note_best(io, group, g, values, s);
    memcpy(count, g->count, sizeof count);
    if (!has_last(g)) count_evaluations(io, group, g, g->n_stored, count);
    s->search.evaluations = count[0];
    s->search.infeasible = count[1];
    s->stage[HF_STAGE_SEARCH].exists = true;
    s->search.generations = g->n_stored;
    free(values);
    hf_hdf5_close(io, group);
}
