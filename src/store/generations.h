/* generations - the data sets of /search/population that grow by one row per generation. The rows of one generation are
 * all that an optimiser needs to propose the next one (hf_optimiser_kind).
 *
 *     population after hf_optimiser_tell
 *         hf_generations_add            keeps its rows in memory and returns the payload for the journal
 *         hf_generations_make_room      writes full chunks of designs, and the other rows less often
 *         hf_generations_write          writes all waiting rows
 *     unfinished file and journal
 *         hf_generations_restore        reads the last generation of the file
 *         hf_generations_take_payload   reads a generation of the journal, whose designs were proposed again
 *
 * Most individuals keep their design for several generations. Their designs are most of the bytes, so each design is
 * stored once: `design` has a row for each design that differs from that of the same individual in the generation
 * before, and `design_row` has the row of each individual. Rows wait in memory, up to a limit, because every call of
 * HDF5 costs some microseconds.
 *
 * By optimize.store a file may have fewer rows of individuals: those of the best individual of each generation, or
 * those of every n-th generation. Figures of a generation always have a row. The last generation is then stored as a
 * whole in /search/population/last. */
#pragma once

#include "store/layout.h"

#include <hifdm/population.h>
#include <hifdm/summary.h>
#include <sys/uio.h>

#define HF_GENERATIONS_GROUP "/search/population"           /* group of all rows */
#define HF_GENERATIONS_PIECES (18 + HF_RESULT_N_INDIVIDUAL) /* number of data sets */
#define HF_GENERATIONS_PAYLOAD (HF_GENERATIONS_PIECES + 1)  /* number of pieces of a payload */
#define HF_GENERATIONS_BEST 0                               /* value of `every`: only the best individual has rows */
/* Number of counts of evaluations in hf_generations.count. */
enum { HF_GENERATIONS_COUNTS = 3 };

/* Head of the payload of a generation. */
typedef struct {
    uint64_t hash;   /* of the designs */
    int32_t n_fresh; /* number of individuals that are not kept from the generation before */
    int32_t n_new;   /* number of designs in the payload; -1: it has no designs */
} hf_generations_head;

typedef struct {
    /* The caller sets the members from here to `every`. */
    bool has_rows; /* as in hf_population */
    int n_individual, n_variable, n_objective;
    int limit; /* maximum number of generations */
    /* 1: the individuals of each generation have rows; n > 1: those of generations 0, n, 2 n, ...;
     * HF_GENERATIONS_BEST: the best one of each generation. */
    int every;
    int n_stored;                              /* generations in the file */
    int n_waiting, capacity;                   /* generations in memory, and their maximum */
    int n_design_stored;                       /* rows of designs in the file */
    int n_design, design_capacity;             /* rows of designs in memory, and their maximum */
    int design_chunk;                          /* rows per chunk of the data set of designs */
    int *design_row;                           /* [individuals in a row]: row of their design in the last generation */
    double *design;                            /* [individuals in a row][n_variable]: these designs */
    uint64_t *hash;                            /* [individuals in a row]: their hashes */
    size_t row_bytes[HF_GENERATIONS_PIECES];   /* bytes of one row */
    size_t whole_bytes[HF_GENERATIONS_PIECES]; /* bytes of one generation with all its individuals */
    hf_generations_head head;                  /* of the last payload */
    size_t fresh_bytes;                        /* bytes of the results of one individual in a payload */
    char *fresh;                               /* [number of individuals][fresh_bytes]: those of the last payload */
    char *row[HF_GENERATIONS_PIECES];          /* [capacity] rows of each data set; of designs [design_capacity] */
    /* The individuals of the last generation that was added, all of them; not used if `every` is 1. */
    char *last[HF_GENERATIONS_PIECES];
    /* Evaluations of all generations: all, infeasible ones, and infeasible ones with a shape. Not valid if `every` is
     * 1. */
    long count[HF_GENERATIONS_COUNTS];
    double base_psi_m; /* psi of the initial design, m; NaN until generation 0 is added */
    void *block;
} hf_generations;

/* Creates the waiting rows, which are empty. Returns HF_OK or HF_NO_MEMORY. The caller calls hf_generations_free in any
 * case. */
hf_status hf_generations_create(hf_generations *g);
void hf_generations_free(hf_generations *g);

/* hf_generations_are_full returns true if hf_generations_make_room must be called before the next generation is added.
 * hf_generations_are_due returns true if enough rows wait for that call. */
bool hf_generations_are_full(const hf_generations *g);
bool hf_generations_are_due(const hf_generations *g);

/* Adds a generation, which hf_optimiser_tell has ranked, to the waiting rows. These must not be full. piece
 * [HF_GENERATIONS_PAYLOAD] (may be NULL) becomes its payload, borrowed until the next generation is added. In place of
 * the designs, nine tenths of the bytes, the payload has their hash: hf_optimiser_next proposes the designs and their
 * rates again from the generation before. Results are those of the individuals that are not kept. Only if designs were
 * moved into limits, the payload has the new rows of designs and the row of each individual; without rows of each
 * generation it then has the designs of all individuals. */
void hf_generations_add(hf_generations *g, const hf_population *population, struct iovec *piece);

/* Returns true if the numbers in the head of a payload are possible and the payload has the size that follows. */
bool hf_generations_are_payload(const hf_generations *g, const void *payload, size_t bytes);

/* Copies the results and all other values of a payload, which hf_generations_are_payload has accepted, into
 * `population`, whose designs were proposed again. Individuals that were kept are copied from the generation `before`
 * (NULL: there is none). Returns false if the designs differ in any bit from those of the results, or if the results
 * are not those of the individuals that are not kept. */
bool hf_generations_take_payload(const hf_generations *g, const void *payload, const hf_population *before,
                                 hf_population *population);

/* Returns true if sizes and limit are those of this population. A damaged file may have any sizes. */
bool hf_generations_are_of(const hf_generations *g, const hf_population *population);

/* Returns true if a run can have stored the present generation, which was read from a file or a journal. Its designs
 * must be within the bounds, its words known and its parents existing. Psi, merit and objectives must be finite where
 * the status is HF_OK. */
bool hf_generations_are_sound(const hf_population *population);

/* hf_generations_write writes all waiting rows. hf_generations_make_room writes the rows for which there is no more
 * room: full chunks of designs, or all rows. The first call makes the data sets. */
void hf_generations_write(hf_hdf5 *io, hf_generations *g);
void hf_generations_make_room(hf_hdf5 *io, hf_generations *g);

/* Returns the number of generations in the file and sets n_stored and n_design_stored. The waiting generations do not
 * count. */
int hf_generations_count(hf_hdf5 *io, hf_generations *g);

/* Sets the members of the summary that follow from the generations of the file: their number, the evaluations and the
 * best design so far. No rows may wait. */
void hf_generations_sum_up(hf_hdf5 *io, const hf_generations *g, hf_summary *summary);

/* Puts a newly created population into the state before hf_optimiser_tell of the last generation of the file. A file of
 * other dimensions is damaged (HF_IO in io->status). */
void hf_generations_restore(hf_hdf5 *io, hf_generations *g, hf_population *population);
