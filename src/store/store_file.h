/* store_file - the file of a store: it has a temporary name while it is written and the visible name when it is whole.
 *
 * Names: RESULT is visible, closed and whole at any moment. RESULT.journal holds the lock and what RESULT does not hold
 * yet; RESULT.journal.tmp is being written, RESULT.journal.new takes the journal's place. All but RESULT belong to
 * whoever has the lock. What the next run finds after a kill at any instant:
 *
 *   killed while                              RESULT          .journal            what happens then
 *   the case is read, the shape found         none, or old    empty or torn head  begins anew, or as if never started
 *   a record is being written                 g0 generations  g0.., torn tail     tail cut off, the others added
 *   .tmp is being made, written, synced       g0              g0..g1              .tmp is written anew
 *   between link(.tmp) and its unlink        0               empty               .tmp is removed, never written into
 *   between rename(.tmp) and rotation         g1              g0..g1              what RESULT has is skipped
 *   between making .new and its rename        g1              g0..g1              the same; .new is made anew
 *   after the rename of .new                  g1              empty               goes on
 *   between the last rename and unlink        finished        g0..                says so, removes the journal
 *
 * The machine may stop, too: .tmp goes to the disk before its name changes, and the folder before the journal is
 * rotated; the journal itself goes there every HF_JOURNAL_SYNC_S. */
#ifndef HIFDM_STORE_FILE_H
#define HIFDM_STORE_FILE_H

#include "store/hdf5.h"
#include "store/journal.h"

#include <sys/stat.h>

typedef struct {
    hf_hdf5 io; /* of the temporary file; io.file is -1 while it is not open */
    hf_journal journal;
    int replaces;           /* what has the name may be replaced although this run did not make it */
    int is_published;       /* this run's file has the name */
    struct stat ours;       /* that file, */
    int visible;            /* open, so that it can be copied when somebody has taken its name; or -1 */
    int has_temporary;      /* there is something under the temporary name */
    int flow;               /* that, open; or -1 */
    int64_t flowing;        /* bytes of it that are on their way to the disk */
    char *path, *temporary; /* owned */
} hf_store_file;

/* Look whether `path` can be written, take its lock. replaces: what has the names of result and journal may go. HF_IO,
 * HF_EXISTS (a foreign journal), HF_NO_MEMORY. End in any case. */
hf_status hf_store_file_begin(const char *path, int replaces, hf_store_file *file, hf_messages *messages);

/* The calls from here on do nothing once io.status is not HF_OK. Create, open and close, and the end of an open file,
 * need the lock of HDF5. */

void hf_store_file_create(hf_store_file *file); /* a new temporary file */
void hf_store_file_open(hf_store_file *file);   /* a copy of the visible one as the temporary file, unless it is open */
void hf_store_file_adopt(hf_store_file *file);  /* the visible file is this run's */

/* Let the system begin to bring to the disk what was written since the last call, if it is much: the way of the last
 * bytes is short then. */
void hf_store_file_flow(hf_store_file *file);

void hf_store_file_close(hf_store_file *file); /* the temporary file is whole */

/* Give it the visible name; `durable`: after it went to the disk, as it holds work. HF_EXISTS when somebody else has
 * taken the name; the work is kept then, and after a rename that fails, under a name that the message tells. */
void hf_store_file_publish(hf_store_file *file, int durable);

/* Close and free everything, drop the temporary file, give the lock back. The journal stays when it holds what the
 * visible file does not, or was there before. */
void hf_store_file_end(hf_store_file *file);

#endif
