/* journal - the file `<result>.journal` with the generations that the result file does not hold yet. A killed process
 * therefore loses none of them, except those that waited for a common write.
 *
 *     8 bytes     "hifdm-j3"
 *     64 bytes    identity of the run
 *     records     magic, length and CRC-32 of the rest, generation, payload
 *
 * Each record is written by one writev(2). With `hold_s` the records of short generations are written together, because
 * a write costs as much as some evaluations. A process that is killed at any instant leaves whole records and at most
 * one incomplete record at the end. The next run cuts that record off. The file is synced every HF_JOURNAL_SYNC_S, so a
 * power cut loses the records of that time at most.
 *
 * The journal is also the lock of the result. The lock is flock(2) on the journal, held from before the process looks
 * at the result until the result is finished. The name of the journal moves to another file only by rename(2). If a
 * process gets the lock of a file that no longer has the name, it opens the name again. */
#pragma once

#include <hifdm/status.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/uio.h>

#define HF_JOURNAL_SYNC_S 5.0 /* s; the tests of the store, of resuming and of interrupting pass with 0.5 to 50 */
#define HF_JOURNAL_PIECES 32  /* maximum number of pieces of a payload */
#define HF_JOURNAL_IDENTITY 64
#define HF_JOURNAL_HELD (256 << 10) /* maximum number of bytes of records that wait */

typedef struct {
    int file;           /* descriptor; -1: closed */
    bool is_new;        /* this process has made or emptied it */
    bool was_there;     /* another process has left it, perhaps with temporary files */
    const char *result; /* name of the result in messages; borrowed */
    char *path;         /* owned */
    int64_t size;       /* bytes up to the end of the last whole record in the file */
    double hold_s;      /* time for which records may wait; 0: none waits */
    double written_s;   /* time of the last write */
    char *held;         /* [HF_JOURNAL_HELD] records that wait, or NULL; owned */
    size_t n_held;      /* their bytes */
    double synced_s;    /* time of the last sync, or of the first hf_journal_tend */
    bool has_news;      /* something was appended after that sync */
    char identity[HF_JOURNAL_IDENTITY + 1];
} hf_journal;

/* Makes or opens the journal of `result`, which must not be a link, and takes its lock. The name of the journal may
 * belong to something else, a link included. With `replaces` this is removed with a warning; without it the status is
 * HF_EXISTS. Other errors: HF_EXISTS if another process holds the lock, HF_IO if the journal cannot be made or locked,
 * HF_NO_MEMORY. On a file system without locks it only warns. The caller calls hf_journal_close in any case. */
hf_status hf_journal_open(const char *result, bool replaces, hf_journal *journal, hf_messages *messages);

/* Returns true if `result`, or the file that it leads to, has a journal with a header. Sets the identity in the header,
 * and *has_records to whether the journal has records, too. The journal itself must not be a link. Takes no lock. */
bool hf_journal_peek(const char *result, char identity[HF_JOURNAL_IDENTITY + 1], bool *has_records);

/* Empties the journal and gives it the identity of a run. Returns HF_OK or HF_IO. */
hf_status hf_journal_restart(hf_journal *journal, const char *identity, hf_messages *messages);

/* Passes each whole record to `take`, oldest first, until it returns another status than HF_OK. An incomplete record at
 * the end is cut off. If `take` returns HF_DIFFERENT, that record and all after it are cut off, and this is no failure.
 * Other damage is cut off with a warning. A journal of another identity is restarted if it has no records; otherwise
 * the status is HF_EXISTS. Returns HF_OK, HF_EXISTS, HF_IO, HF_NO_MEMORY, or what `take` returned. */
typedef hf_status hf_journal_take(void *context, int generation, const void *payload, size_t bytes);
hf_status hf_journal_replay(hf_journal *journal, const char *identity, hf_journal_take *take, void *context,
                            hf_messages *messages);

/* Appends a generation in n <= HF_JOURNAL_PIECES pieces; an empty piece is not NULL. HF_OK: it survives the end of this
 * process, or with hold_s it waits because the last write was less than hold_s ago. HF_IO: neither it nor any
 * generation that waited is in the file, but all generations before them are. */
hf_status hf_journal_append(hf_journal *journal, int generation, const struct iovec *piece, int n,
                            hf_messages *messages);

/* Writes the waiting records. Returns HF_OK or HF_IO, as hf_journal_append. */
hf_status hf_journal_write(hf_journal *journal, hf_messages *messages);

/* Syncs the file if HF_JOURNAL_SYNC_S have passed since the last sync, and checks that the file still has its name. The
 * caller must call it regularly. now_s: present time, as hf_clock_s gives it. Returns HF_OK or HF_IO. */
hf_status hf_journal_tend(hf_journal *journal, double now_s, hf_messages *messages);

/* Replaces the journal by a new, empty one. The caller calls it when the result file holds all records, also those that
 * wait. Returns HF_OK or HF_IO. */
hf_status hf_journal_rotate(hf_journal *journal, hf_messages *messages);

/* Returns true if the journal has no records. */
bool hf_journal_is_empty(const hf_journal *journal);

/* Releases the lock and closes the file; with `remove` it deletes the file, too. Else it writes the waiting records as
 * far as this is possible. */
void hf_journal_close(hf_journal *journal, bool remove);
