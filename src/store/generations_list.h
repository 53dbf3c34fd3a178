/* generations_list - lists the data sets of /ga that grow by one row per generation, and copies their values from a
 * population and back. */
#ifndef HIFDM_GENERATIONS_LIST_H
#define HIFDM_GENERATIONS_LIST_H

#include "store/generations.h"

/* A data set and the location of its values of one generation: one item after the other, `stride` bytes apart. A data
 * set without bytes is not in the file. */
typedef struct {
    hf_hdf5_array array;
    const void *from;
    size_t stride, item_bytes;
} hf_generations_row;

/* Indices of the data sets. The figures of the individuals are those of <hifdm/result.h>: status first, then psi_m. */
enum {
    HF_ROW_DESIGN,
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

/* Lists the data sets with their values in a population that hf_optimiser_tell has ranked. */
void hf_generations_list(const hf_population *population, hf_generations_row row[HF_GENERATIONS_PIECES]);

/* Lists names and sizes alone, for n_individual individuals. The pointers to values are not valid. */
void hf_generations_list_empty(const hf_generations *g, int n_individual,
                               hf_generations_row row[HF_GENERATIONS_PIECES]);

/* Returns true for a figure of the whole generation, false for a value per individual. */
static inline bool hf_generations_is_series(int i)
{
    return i >= HF_ROW_BEST_INDIVIDUAL;
}

/* Returns true if the last generation is stored as a whole beside the rows, which do not have all of it. */
static inline bool hf_generations_has_last(const hf_generations *g)
{
    return g->every != 1;
}

/* Attributes of /ga/last, in the order of hf_generations.count. */
extern const char *const hf_generations_count_name[HF_GENERATIONS_COUNTS];

/* Adds sign times the evaluations of a generation to `count`: all of them, those without a feasible design, and those
 * among the latter that have a shape. */
void hf_generations_tally(const hf_population *population, int sign, long count[HF_GENERATIONS_COUNTS]);

/* Copies the values of one generation between the population and `packed`, where they are side by side as HDF5 takes
 * them: to `packed` with `packs`, else back. bytes: of all of them there. */
void hf_generations_copy(const hf_generations_row *row, size_t bytes, bool packs, char *packed);

#endif
