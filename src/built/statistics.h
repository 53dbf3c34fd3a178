/* statistics - of very many samples that are read block by block: memory does not depend on their number. */
#ifndef HIFDM_STATISTICS_H
#define HIFDM_STATISTICS_H

#include "built/montecarlo.h"

/* Read rows first to first + n - 1, row [n][HF_TOLERANCE_COLUMNS]. HF_OK, or a status with a message. */
typedef hf_status hf_statistics_read(void *context, long first, int n, double *row);

typedef struct {
    long n; /* rows */
    hf_statistics_read *read;
    void *context;
} hf_statistics_rows;

/* All figures but those of time, of the scale and of the ranked cables' ids. HF_OK, HF_NO_MEMORY, or what read gave. */
hf_status hf_statistics_sum_up(const hf_montecarlo *montecarlo, const hf_statistics_rows *rows,
                               hf_tolerance_summary *summary);

/* The values of these ranks, 1 to the number of rows, in a column where NaN counts as `missing`: exact, by four passes
 * over the rows, each of which finds 16 bits more of each value. */
#define HF_STATISTICS_RANKS 9
hf_status hf_statistics_order(const hf_statistics_rows *rows, int column, double missing, int n_rank, const long *rank,
                              double *value);

/* Ranks between which the quantile `part` of n independent values is with 95 %; 0, or n + 1: there is no such value. */
void hf_statistics_ranks(long n, double part, long *low, long *high);

/* 95 % interval of a probability when `met` of n have it (Clopper and Pearson). */
void hf_statistics_interval(long n, long met, double *low, double *high);

#endif
