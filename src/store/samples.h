/* samples - keeps the rows of the as-built samples while a run computes them. They are in a scratch file without a
 * name, so that the memory does not depend on their number. They are also in a journal beside the result, so that a
 * killed process loses none.
 *
 * The samples come in chunks, and each chunk is a record of the journal. Each task of a job array has its own journal.
 * The process that writes the result reads the journals of all tasks. */
#pragma once

#include "built/statistics.h"
#include "store/journal.h"

#define HF_SAMPLES_NAME_SIZE 4200

typedef struct {
    const volatile sig_atomic_t *stop; /* NULL, or a flag: if *stop != 0, hf_samples_read returns HF_INTERRUPTED */
    long n;                            /* number of samples */
    int n_chunk;                       /* samples per chunk; the last chunk may have fewer */
    int n_value;                       /* values of a sample */
    int n_have, n_all;                 /* number of chunks that are there, and of all chunks */
    unsigned char *has;                /* [n_all] 1: the chunk is there; owned */
    int rows;                          /* descriptor of the scratch file; -1: none */
    hf_journal journal;                /* journal.path NULL: none */
    char name[HF_SAMPLES_NAME_SIZE], identity[HF_JOURNAL_IDENTITY + 1];
    hf_messages *messages;
} hf_samples;

/* Opens the samples of a result. The journal is RESULT.tolerance.journal, or RESULT.tolerance-TASK-of-TASKS.journal if
 * tasks > 0; task is 0 to tasks - 1. result NULL: no journal. The scratch file is in the folder of `beside`, or in that
 * of temporary files if `beside` is NULL. The chunks that an earlier process with the same identity has left are taken
 * over, unless `restart`. Returns HF_OK; HF_EXISTS if the journal belongs to another case or is in use; HF_IO;
 * HF_NO_MEMORY. The caller calls hf_samples_close in any case. */
hf_status hf_samples_open(const char *result, const char *beside, int task, int tasks, const char *identity,
                          bool restart, long n, int n_chunk, int n_value, hf_samples *samples, hf_messages *messages);

/* Writes the identity of the samples: parts of the digest of the case and of the digest of its design. */
void hf_samples_identify(const char of_case[65], const char of_design[65], char identity[65]);

/* Returns HF_EXISTS if the journal of `task` has samples of another case, else HF_OK. With task < 0 it looks at every
 * journal that would be read. It is called before the design is known. */
hf_status hf_samples_look(const char *result, int task, int tasks, const char of_case[65], hf_messages *messages);

/* Takes over the chunks of the journals of all tasks. With `restart`, journals of another identity are removed; without
 * it they give HF_EXISTS. */
hf_status hf_samples_collect(hf_samples *samples, const char *result, int tasks, bool restart);

/* Returns the first sample of a chunk, and sets *n to the number of its samples. */
static inline long hf_samples_first(const hf_samples *samples, int chunk, int *n)
{
    long first = (long)chunk * samples->n_chunk, left = samples->n - first;
    *n = left < samples->n_chunk ? (int)left : samples->n_chunk;
    return first;
}

/* Adds the rows of a chunk, row [n][n_value]. Returns HF_OK or HF_IO. If there is a journal, the rows
 * survive the end of this process after HF_OK. */
hf_status hf_samples_add(hf_samples *samples, int chunk, const double *row);

/* Reads rows for the statistics; an hf_statistics_read. samples: an hf_samples that has all chunks. */
hf_status hf_samples_read(void *samples, long first, int n, double *row);

void hf_samples_close(hf_samples *samples);

/* Removes the journals of a finished result, for any number of tasks. */
void hf_samples_remove(const char *result);
