/* generations_list - the data sets of /ga that grow by a row per generation: where their values stand in a population,
 * and how they get there and back. */
#ifndef HIFDM_GENERATIONS_LIST_H
#define HIFDM_GENERATIONS_LIST_H

#include "store/generations.h"

/* A data set and where its values of one generation are: item after item, `stride` bytes apart. One without bytes is
 * not in the file. */
typedef struct {
    hf_hdf5_array array;
    const void *from;
    size_t stride, item_bytes;
} hf_generations_row;

/* The figures of the individuals are those of <hifdm/result.h>, status first and psi_m behind it. */
enum {
    HF_ROW_DESIGN,
    HF_ROW_EVALUATED,
    HF_ROW_RESULT,
    HF_ROW_STATUS = HF_ROW_RESULT,
    HF_ROW_PSI,
    HF_ROW_OBJECTIVE = HF_ROW_RESULT + HF_RESULT_N_INDIVIDUAL, /* those that a case does not have take no bytes */
    HF_ROW_TRIAL_STATUS = HF_ROW_OBJECTIVE + HF_OBJECTIVES_MAX,
    HF_ROW_TRIAL_PSI,
    HF_ROW_BREEDING,
    HF_ROW_BEST_INDIVIDUAL = HF_ROW_BREEDING + 3,
    HF_ROW_BEST_PSI,
    HF_ROW_BEST_MERIT,
    HF_ROW_VIOLATION,
    HF_ROW_N = HF_ROW_VIOLATION + 4
};
_Static_assert(HF_ROW_N == HF_GENERATIONS_PIECES, "count the rows again");

/* The rows of a population as hf_optimiser_tell left it. */
void hf_generations_list(const hf_population *population, hf_generations_row row[HF_GENERATIONS_PIECES]);

/* The list for its names and sizes alone, with so many individuals: the values are not valid. */
void hf_generations_list_empty(const hf_generations *g, int n_individual,
                               hf_generations_row row[HF_GENERATIONS_PIECES]);

/* A figure of the whole generation, as against a value per individual. */
static inline bool hf_generations_is_series(int i)
{
    return i >= HF_ROW_BEST_INDIVIDUAL;
}

/* Is the last generation kept beside the rows, which do not hold it as a whole? */
static inline bool hf_generations_has_last(const hf_generations *g)
{
    return g->every != 1;
}

/* Attributes of /ga/last, in the order of hf_generations.count. */
extern const char *const hf_generations_count_name[HF_GENERATIONS_COUNTS];

/* Add sign times the evaluations of a generation: all, those without a feasible design, those of them above the cap. */
void hf_generations_tally(const hf_population *population, int sign, long count[HF_GENERATIONS_COUNTS]);

/* Copy the values of one generation, of which `bytes` are stored, side by side as HDF5 takes them, and back. */
void hf_generations_gather(const hf_generations_row *row, size_t bytes, char *to);
void hf_generations_scatter(const hf_generations_row *row, size_t bytes, const char *from);

#endif
