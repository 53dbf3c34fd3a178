/* statistics - figures of any number of samples, which are read block by block. The memory does not depend on their
 * number. */
#pragma once

#include "built/montecarlo.h"

/* Reads the rows first to first + n - 1 into row [n][n_value]. Returns HF_OK, or a status with a
 * message. */
typedef hf_status hf_statistics_read(void *context, long first, int n, double *row);

typedef struct {
    long n; /* number of rows */
    hf_statistics_read *read;
    void *context;
    int n_value; /* values of a row */
} hf_statistics_rows;

/* Computes all members of the summary except those of time and of the scale. Returns HF_OK, HF_NO_MEMORY, or a status
 * of rows->read. */
hf_status hf_statistics_sum_up(const hf_montecarlo *montecarlo, const hf_statistics_rows *rows,
                               hf_tolerance_summary *summary);

/* Gives the verdicts on the rows of montecarlo->required that have a share. verdict [required->n]: the other rows are
 * not changed. Returns HF_OK, HF_NO_MEMORY, or a status of rows->read. */
hf_status hf_statistics_judge(const hf_montecarlo *montecarlo, const hf_statistics_rows *rows,
                              hf_requirement_verdict *verdict);

/* Finds the values of n_rank ranks, 1 to the number of rows, in a column in which NaN counts as `missing`. The values
 * are exact. Each of four passes over the rows finds 16 more bits of each value. Returns HF_OK, HF_NO_MEMORY, or a
 * status of rows->read. */
#define HF_STATISTICS_RANKS 9
hf_status hf_statistics_order(const hf_statistics_rows *rows, int column, double missing, int n_rank, const long *rank,
                              double *value);

/* Finds the ranks that enclose the quantile `part` of n independent values with 95 % confidence. Rank 0 or n + 1 means
 * that there is no such value. */
void hf_statistics_ranks(long n, double part, long *low, long *high);

/* Computes the 95 % confidence interval of a probability when `met` of n trials have succeeded (Clopper and
 * Pearson). */
void hf_statistics_interval(long n, long met, double *low, double *high);
