/* generations - the data sets of /ga that grow by a row per generation. One list names them and says where the values
 * of a row come from; writing and restoring both use it. The rows of a generation are all that an optimiser needs to
 * propose the next one (hf_optimiser_kind). Rows wait in memory, up to a bound, to be written together, because
 * every call of HDF5 costs some microseconds. The designs, nine tenths of the bytes, are written when a chunk of them
 * is full, all other rows less often.
 *
 * A file may hold less: of each generation the best individual alone, or whole generations only now and then. Figures
 * of a generation have a row in any case, and the last generation stands as a whole in /ga/last. */
#ifndef HIFDM_GENERATIONS_H
#define HIFDM_GENERATIONS_H

#include "store/layout.h"

#include <hifdm/population.h>
#include <hifdm/summary.h>
#include <sys/uio.h>

#define HF_GENERATIONS_PIECES (17 + HF_RESULT_N_INDIVIDUAL) /* data sets, and pieces of a payload */
#define HF_GENERATIONS_BEST 0                               /* as `every`: rows of the best individuals */
enum { HF_GENERATIONS_COUNTS = 3 };

typedef struct {
    bool has_rows; /* as of hf_population; set it after creation */
    int n_individual, n_gene, n_objective;
    int limit;                                 /* generations that there can be */
    int every;                                 /* whole ones that have a row: 0, every, 2 every, ... */
    int n_stored;                              /* in the file */
    int n_waiting, capacity;                   /* in memory */
    int n_design, design_capacity;             /* the last of these, whose designs are in memory, too */
    int design_chunk;                          /* designs per chunk of the data set */
    size_t row_bytes[HF_GENERATIONS_PIECES];   /* of a row */
    size_t whole_bytes[HF_GENERATIONS_PIECES]; /* of one generation with all its individuals */
    size_t payload_bytes;                      /* of what the journal keeps of one */
    uint64_t design_hash;                      /* of the last one added */
    char *row[HF_GENERATIONS_PIECES];          /* [capacity] rows of each data set, [design_capacity] of designs */
    char *last[HF_GENERATIONS_PIECES]; /* unless `every` is 1: the last one added, but for its figures as a whole */
    long count[HF_GENERATIONS_COUNTS]; /* evaluations, infeasible, above the cap, of all added; unless `every` is 1 */
    double base_psi_m;                 /* NaN until the first one is added */
    void *block;
} hf_generations;

/* every: 1: each generation has a row of each data set; n: each n-th; HF_GENERATIONS_BEST. HF_OK or HF_NO_MEMORY. Free
 * in any case. */
hf_status hf_generations_create(int n_individual, int n_gene, int n_objective, int limit, int every, hf_generations *g);
void hf_generations_free(hf_generations *g);

/* Full: hf_generations_make_room must be called before another is added. Due: enough waits for that call. */
bool hf_generations_are_full(const hf_generations *g);
bool hf_generations_are_due(const hf_generations *g);

/* Add a generation that hf_optimiser_tell has ranked to those that wait, which must not be full. `piece` (may be NULL)
 * is its payload [HF_GENERATIONS_PIECES], borrowed until the next is added: all of it but the designs, nine tenths of
 * its bytes, which hf_optimiser_next proposes again from the generation before. Of the designs the payload has only a
 * hash. */
void hf_generations_add(hf_generations *g, const hf_population *population, struct iovec *piece);

/* Copy results and all else from a payload into `population`, whose designs were proposed again; those that were kept
 * come from the generation `before` (NULL: there is none). False when the designs have other bits than those that the
 * results are of. */
bool hf_generations_take_payload(const hf_generations *g, const void *payload, const hf_population *before,
                                 hf_population *population);

/* Are the sizes and the limit those of this population? A file may say anything. */
bool hf_generations_are_of(const hf_generations *g, const hf_population *population);

/* Is the present generation, which was read from a file or a journal, one that a run stores: designs within the bounds,
 * known words, parents that exist, a finite psi where the status is ok? */
bool hf_generations_are_sound(const hf_population *population);

/* Write waiting rows below /ga of the file: all of them, or those for which there is no more room. The first call makes
 * the data sets. */
void hf_generations_write(hf_hdf5 *io, hf_generations *g);
void hf_generations_make_room(hf_hdf5 *io, hf_generations *g);

/* How many generations the file has; those that wait do not count. Sets n_stored. */
int hf_generations_count(hf_hdf5 *io, hf_generations *g);

/* Set the members of the summary that follow from the generations of the file: their number, evaluations, the best so
 * far. None may wait. */
void hf_generations_sum_up(hf_hdf5 *io, const hf_generations *g, hf_summary *summary);

/* Put `population`, just created, into the state before hf_optimiser_tell of the last generation of the file. HF_IO
 * also for a file of other dimensions. */
void hf_generations_restore(hf_hdf5 *io, const hf_generations *g, hf_population *population);

#endif
