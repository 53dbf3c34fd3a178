/* samples - rows of the samples of nets as built, while a run finds them: in a scratch file without a name, so that
 * memory does not depend on their number, and in a journal beside the result, so that a killed process loses none.
 *
 * Samples come in chunks, a record of the journal each. A task of a job array has a journal of its own; whoever puts
 * the result together reads those of all tasks. */
#ifndef HIFDM_SAMPLES_H
#define HIFDM_SAMPLES_H

#include "built/statistics.h"
#include "store/journal.h"

#define HF_SAMPLES_NAME_SIZE 4200

typedef struct {
    const volatile sig_atomic_t *stop; /* NULL, or a flag: *stop != 0 makes hf_samples_read return HF_INTERRUPTED */
    long n;                            /* samples */
    int n_chunk;                       /* samples of a chunk; of the last one perhaps less */
    int n_have, n_all;                 /* chunks that are there, and of all samples */
    unsigned char *has;                /* [n_all] */
    int rows;                          /* the scratch file; -1: none */
    void *block;
    bool has_journal;
    hf_journal journal;
    char name[HF_SAMPLES_NAME_SIZE], identity[HF_JOURNAL_IDENTITY + 1];
    hf_messages *messages;
} hf_samples;

/* The name of the journal of a result is RESULT.tolerance.journal, and with a task from 0 to tasks - 1
 * RESULT.tolerance-TASK-of-TASKS.journal. RESULT NULL: no journal. The scratch file is in the folder of `beside`, or of
 * temporary files where that is NULL. Takes what an earlier process has left there of the
 * same identity, unless `restart`. HF_OK; HF_EXISTS when it is of another case or in use, HF_IO, HF_NO_MEMORY. Close in
 * any case. */
hf_status hf_samples_open(const char *result, const char *beside, int task, int tasks, const char *identity,
                          bool restart, long n, int n_chunk, hf_samples *samples, hf_messages *messages);

/* The identity of samples of a case and of the design that was found for it, of a digest of each. */
void hf_samples_identify(const char of_case[65], const char of_design[65], char identity[65]);

/* Before the design is known: HF_EXISTS when the journal of `task`, or with task < 0 any of those that would be read,
 * has samples of another case. */
hf_status hf_samples_look(const char *result, int task, int tasks, const char of_case[65], hf_messages *messages);

/* Take what the journals of all tasks have. With `restart` those of another identity are removed, else they are
 * HF_EXISTS. */
hf_status hf_samples_collect(hf_samples *samples, const char *result, int tasks, bool restart);

/* First sample of a chunk, and how many it has. */
static inline long hf_samples_first(const hf_samples *samples, int chunk, int *n)
{
    long first = (long)chunk * samples->n_chunk, left = samples->n - first;
    *n = left < samples->n_chunk ? (int)left : samples->n_chunk;
    return first;
}

/* Add the rows of a chunk. HF_OK: they survive the end of this process. */
hf_status hf_samples_add(hf_samples *samples, int chunk, const double *row);

/* An hf_statistics_read, whose context is an hf_samples that has all chunks. */
hf_status hf_samples_read(void *samples, long first, int n, double *row);

void hf_samples_close(hf_samples *samples);

/* Remove the journals of a result that is finished, of any number of tasks: nobody needs them any more. */
void hf_samples_remove(const char *result);

#endif
