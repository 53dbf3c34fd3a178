/* journal - the file `<result>.journal` with the generations that a result file does not hold yet: a killed process
 * loses none.
 *
 * File: 8 bytes "hifdm-j2", 64 of the run's identity, then records: magic, length and CRC-32 of what follows,
 * generation, payload. A record is one writev(2), so that a process killed at any instant leaves whole records and at
 * most one incomplete record at the end, which the next run cuts off. The file is synced every HF_JOURNAL_SYNC_S, so
 * that a power cut loses no more than that.
 *
 * The journal is also the lock of the result: flock(2) on it is held from before the result is looked at until after
 * it is finished. The name moves to another file only by rename(2). A process that gets the lock of a file which no
 * longer has the name opens the name again. */
#ifndef HIFDM_JOURNAL_H
#define HIFDM_JOURNAL_H

#include <hifdm/status.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/uio.h>

#define HF_JOURNAL_SYNC_S 5.0 /* from 0.5 to 50 no test of the store, of resuming or of interrupting changes */
#define HF_JOURNAL_PIECES 32  /* most pieces of a payload */
#define HF_JOURNAL_IDENTITY 64

typedef struct {
    int file;           /* -1: closed */
    bool is_new;        /* made or emptied by this process */
    bool was_there;     /* another process has left it, and may have left temporary files */
    const char *result; /* as messages call the result; borrowed */
    char *path;         /* owned */
    int64_t size;       /* up to the end of the last whole record */
    double synced_s;    /* time of the last sync, or of the first hf_journal_tend */
    bool has_news;      /* something was appended since that sync */
    char identity[HF_JOURNAL_IDENTITY + 1];
} hf_journal;

/* Make or open the journal of `result`, which is no link, and take its lock. HF_IO when it cannot be made or locked;
 * HF_EXISTS when another process holds the lock, or when what has that name is no journal, a link included, unless
 * `replaces`: then it is removed, with a warning. On a file system without locks there is a warning instead.
 * HF_NO_MEMORY. Close in any case. */
hf_status hf_journal_open(const char *result, bool replaces, hf_journal *journal, hf_messages *messages);

/* Is there a journal of `result`, or of the file that it leads to, with a header? Takes no lock. */
bool hf_journal_is_there(const char *result);

/* Whose records are in the journal of `result`, where there are any: identity, or "" . Takes no lock. */
void hf_journal_peek(const char *result, char identity[HF_JOURNAL_IDENTITY + 1]);

/* Is there a journal of the run of this identity, with records or without? Takes no lock. */
bool hf_journal_is_of(const char *result, const char *identity);

/* Empty the journal; from now on it is that of the run of this identity. HF_OK or HF_IO. */
hf_status hf_journal_restart(hf_journal *journal, const char *identity, hf_messages *messages);

/* Give each whole record to `take`, oldest first, until it returns something other than HF_OK. An incomplete record at
 * the end is cut off. HF_DIFFERENT from `take` is no failure: that record and all after it are cut off. Other damage is
 * cut off with a warning. A journal of another identity, or without one, is restarted when it has no record; else
 * HF_EXISTS. HF_OK, HF_IO, HF_NO_MEMORY, or what `take` returned. */
typedef hf_status hf_journal_take(void *context, int generation, const void *payload, size_t bytes);
hf_status hf_journal_replay(hf_journal *journal, const char *identity, hf_journal_take *take, void *context,
                            hf_messages *messages);

/* Append a generation: piece[n], n <= HF_JOURNAL_PIECES. HF_OK: it survives the end of this process. HF_IO: none
 * of it is in the file, all generations before it are. */
hf_status hf_journal_append(hf_journal *journal, int generation, const struct iovec *piece, int n,
                            hf_messages *messages);

/* Call it regularly: it syncs the file when HF_JOURNAL_SYNC_S have passed, and checks that it still has its name. */
hf_status hf_journal_tend(hf_journal *journal, double now_s, hf_messages *messages);

/* Replace the journal by a new, empty one. Call it when the result file holds all records. */
hf_status hf_journal_rotate(hf_journal *journal, hf_messages *messages);

/* Does it hold no record? hf_journal_forget makes it count as empty. */
bool hf_journal_is_empty(const hf_journal *journal);
void hf_journal_forget(hf_journal *journal);

/* Release the lock; with `remove` delete the file, too. */
void hf_journal_close(hf_journal *journal, bool remove);

#endif
