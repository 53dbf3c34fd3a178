/* journal - the generations that a result file does not hold yet, in `<result>.journal`, so that kill -9 loses none.
 *
 * File: 8 bytes "hifdm-j2", 64 of the run's identity, then records: magic, length and CRC-32 of what follows,
 * generation, payload. A record is one writev(2), so that a process killed at any instant leaves whole records and at
 * most a torn last one, which the next run cuts off. The file is synced every HF_JOURNAL_SYNC_S, so that a power cut
 * loses no more than that.
 *
 * The journal is also the lock of the result: flock(2) on it is held from before the result is looked at until after it
 * is finished. Its name changes hands by rename(2) only, so that whoever gets the lock of a file that has lost the name
 * notices and tries again. */
#ifndef HIFDM_JOURNAL_H
#define HIFDM_JOURNAL_H

#include <hifdm/status.h>
#include <stdint.h>
#include <sys/uio.h>

#define HF_JOURNAL_SYNC_S 5.0
#define HF_JOURNAL_PIECES 32 /* a payload may have */
#define HF_JOURNAL_IDENTITY 64

typedef struct {
    int file;           /* -1: closed */
    int is_new;         /* it was made, or emptied, by this process */
    const char *result; /* as messages call the result; borrowed */
    char *path, *next;  /* owned */
    int64_t size;       /* up to the end of the last whole record */
    double synced_s;    /* when it went to the disk last */
    int has_news;       /* something was appended since */
    char identity[HF_JOURNAL_IDENTITY + 1];
} hf_journal;

/* Make or open the journal of `result` and take its lock. HF_IO when another process holds it, or when it cannot be
 * made; HF_EXISTS when a file of that name is no journal, unless `replaces`: then it is removed, with a warning.
 * HF_NO_MEMORY. Close in any case. */
hf_status hf_journal_open(const char *result, int replaces, hf_journal *journal, hf_messages *messages);

/* Is there a journal of `result` that somebody has begun to write? Takes no lock. */
int hf_journal_is_there(const char *result);

/* Forget what is in it, and write for the run of this identity from now on. HF_OK or HF_IO. */
hf_status hf_journal_restart(hf_journal *journal, const char *identity, hf_messages *messages);

/* Give each whole record to `take`, oldest first, until it returns something other than HF_OK; cut off a torn tail, and
 * from the record on of which `take` says HF_DIFFERENT: that is no failure. What is damaged in another way
 * goes with a warning. A journal of another identity, or without one, is restarted when it has no record; else
 * HF_EXISTS. HF_OK, HF_IO, HF_NO_MEMORY, or what `take` returned. */
typedef hf_status hf_journal_take(void *context, int generation, const void *payload, size_t bytes);
hf_status hf_journal_replay(hf_journal *journal, const char *identity, hf_journal_take *take, void *context,
                            hf_messages *messages);

/* Append a generation: piece[n], n <= HF_JOURNAL_PIECES. HF_OK: it survives the end of this process. HF_IO: nothing of
 * it is there, all before it is. */
hf_status hf_journal_append(hf_journal *journal, int generation, const struct iovec *piece, int n,
                            hf_messages *messages);

/* To be called regularly: syncs the file when HF_JOURNAL_SYNC_S have passed, and checks that it still has its name. */
hf_status hf_journal_tend(hf_journal *journal, double now_s, hf_messages *messages);

/* The result file holds all records now: a new, empty journal takes the name. */
hf_status hf_journal_rotate(hf_journal *journal, hf_messages *messages);

/* Does it hold any record? After hf_journal_forget, none that counts. */
int hf_journal_is_empty(const hf_journal *journal);
void hf_journal_forget(hf_journal *journal);

/* Give the lock back; `remove`: and the name. */
void hf_journal_close(hf_journal *journal, int remove);

#endif
