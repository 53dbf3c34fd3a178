/* store_file - the file of a store: it has a temporary name while it is written and the visible name when it is whole.
 *
 * Names: RESULT is visible, closed and whole at any moment; of a path that is a link, it is the file that is meant
 * (file_out). RESULT.journal holds the lock and what RESULT does not hold yet. `tmp` is the temporary file that is
 * being written, `new` the one that takes the journal's place; file_out gives them their names. Only the process that
 * has the lock touches them. The journal is made before them and removed after them, so a process that finds one looks
 * for what a killed process left, and removes it. What the next run finds after a kill at any instant:
 *
 *   killed while                              RESULT          .journal            what happens then
 *   the case is read, the shape found         none, or old    empty or torn head  begins anew, or as if never started
 *   a record is being written                 g0 generations  g0.., torn tail     tail cut off, the others added
 *   tmp is being made, written, synced        g0              g0..g1              tmp is removed, another one written
 *   between link(tmp) and its unlink          0, or finished  empty               tmp is removed, never written into
 *   between rename(tmp) and rotation          g1              g0..g1              what RESULT has is skipped
 *   between making new and its rename         g1              g0..g1              the same; new is removed
 *   after the rename of new                   g1              empty               goes on
 *   between the last rename and unlink        finished        g0..                says so, removes the journal
 *
 * Against power cuts tmp is synced before its name changes, the folder before the journal is rotated, and the journal
 * every HF_JOURNAL_SYNC_S. */
#ifndef HIFDM_STORE_FILE_H
#define HIFDM_STORE_FILE_H

#include "store/hdf5.h"
#include "store/journal.h"

#include <sys/stat.h>

/* A finished result that a run with --restart replaces: it gets the name RESULT.before-restart when the unfinished file
 * of that run gets its name, and loses it when the run is finished. So does a file that cannot be read, since it may be
 * one, unless the name is taken. */
typedef enum { HF_EARLIER_NONE, HF_EARLIER_THERE, HF_EARLIER_KEPT, HF_EARLIER_UNREAD } hf_earlier;

typedef struct {
    hf_hdf5 io; /* of the temporary file; io.file is -1 while it is not open */
    hf_journal journal;
    bool replaces; /* a file of another run with this name may be replaced */
    hf_earlier earlier;
    bool is_published; /* this run's file has the name */
    struct stat ours;  /* identity of that file */
    int visible;       /* that file, open, so that it can be copied even if its name is taken; or -1 */
    hf_file_out out;   /* out.path is RESULT, out.file the temporary file */
    int64_t flowing;   /* bytes of it that the system was asked to write to the disk */
} hf_store_file;

/* Can a file be made under this name, or the ordinary file there be replaced? Asked before the run rather than after
 * hours of work. HF_EXISTS, HF_IO. */
hf_status hf_store_file_check(const char *path, hf_messages *messages);

/* Check that `path` can be written, take its lock, and remove what a killed process left. replaces: files with the
 * names of result and journal may be replaced. HF_IO, HF_EXISTS (a foreign journal), HF_NO_MEMORY. End in any case. */
hf_status hf_store_file_begin(const char *path, bool replaces, hf_store_file *file, hf_messages *messages);

/* HF_EXISTS if the name for an earlier result is taken. */
hf_status hf_store_file_demand_room(hf_store_file *file, hf_messages *messages);

/* Removes the earlier result beside a finished one whose process ended before it did so. */
void hf_store_file_forget_earlier(const char *result);

/* The calls from here on do nothing once io.status is not HF_OK. Create, open and close, and the end of an open file,
 * need the lock of HDF5. */

void hf_store_file_create(hf_store_file *file); /* a new temporary file */
void hf_store_file_open(hf_store_file *file);   /* a copy of the visible one as the temporary file, unless it is open */
void hf_store_file_adopt(hf_store_file *file);  /* the visible file is this run's */

/* Ask the system to begin to write to the disk what is new since the last call, if it is FLOW_BYTES or more: the sync
 * at the end has less to wait for. */
void hf_store_file_flow(hf_store_file *file);

void hf_store_file_close(hf_store_file *file); /* the temporary file is whole */

/* Give it the visible name; with `durable` only after a sync. HF_EXISTS when another process has taken the name. Then,
 * and after a rename that fails, the file is kept under a name that the message gives. An earlier finished result keeps
 * a name until is_finished. */
void hf_store_file_publish(hf_store_file *file, bool durable, bool is_finished);

/* Close and free everything, remove the temporary file, release the lock. The journal stays when it holds generations
 * that the visible file does not, or was there before. */
void hf_store_file_end(hf_store_file *file, hf_messages *messages);

#endif
