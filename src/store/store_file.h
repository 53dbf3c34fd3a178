/* store_file - the file of a store. It has a temporary name while it is written, and gets the visible name when it is
 * whole.
 *
 * RESULT is the visible file, closed and whole at any moment. If its path is a link, RESULT is the file that the link
 * leads to (file_out). RESULT.journal holds the lock and the generations that RESULT does not hold yet. `tmp` is the
 * temporary file that is being written, and `new` is the one that replaces the journal; file_out names both. Only the
 * process that has the lock touches these files. The journal is made before the temporary files and removed after them.
 * A process that finds a journal therefore looks for the temporary files of a killed process and removes them.
 *
 * A process may be killed at any instant. RESULT then has generations up to g0 or g1, and the journal those that
 * follow:
 *
 *   killed during                             RESULT          .journal            the next run
 *   reading the case, form-finding            none, or old    empty or torn head  starts anew, or finds the old result
 *   writing a record                          g0              g0.., torn tail     cuts off the tail, takes the others
 *   making, writing or syncing tmp            g0              g0..g1              removes tmp and writes another one
 *   between link(tmp) and its unlink          0, or finished  empty               removes tmp, never writes into it
 *   between rename(tmp) and rotation          g1              g0..g1              skips the records that RESULT has
 *   between making new and its rename         g1              g0..g1              does the same and removes new
 *   after the rename of new                   g1              empty               resumes the run
 *   between the last rename and unlink        finished        g0..                ends at once, removes the journal
 *
 * Against power cuts, tmp is synced before its name changes, the folder is synced before the journal is rotated, and
 * the journal is synced every HF_JOURNAL_SYNC_S. */
#pragma once

#include "store/hdf5.h"
#include "store/journal.h"

#include <sys/stat.h>

/* An earlier result that a run with --restart replaces. A finished result gets the name RESULT.before-restart when the
 * unfinished file of the new run gets its name. It is removed when the new run is finished. A file that cannot be read
 * is treated in the same way, because it may be a finished result, unless the name RESULT.before-restart is taken.
 * NONE: there is no earlier result; THERE: it has its own name; KEPT: it has the other name; UNREAD: it cannot be
 * read. */
typedef enum { HF_EARLIER_NONE, HF_EARLIER_THERE, HF_EARLIER_KEPT, HF_EARLIER_UNREAD } hf_earlier;

typedef struct {
    hf_hdf5 io; /* the temporary file in HDF5; io.file is -1 while it is not open */
    hf_journal journal;
    bool replaces; /* a file of another run with this name may be replaced */
    hf_earlier earlier;
    char earlier_name[HF_FILE_OUT_SIZE + 16]; /* RESULT.before-restart */
    bool is_published;                        /* the visible file is that of this run */
    struct stat ours;                         /* identity of that file */
    int visible;                              /* descriptor of that file, for copies even if its name is taken; or -1 */
    hf_file_out out;                          /* out.path is RESULT, out.file the temporary file */
    int64_t flowing; /* bytes of the temporary file that the system was asked to write to the disk */
    int64_t beside;  /* bytes written so far that are not in the file: copies, and journals that were rotated */
} hf_store_file;

/* Returns the bytes of the temporary file, or else of the visible file. */
int64_t hf_store_file_size(const hf_store_file *file);

/* Checks that a file of this name can be made, or that the ordinary file there can be replaced. It is called before the
 * run, not after hours of work. Returns HF_OK, HF_EXISTS or HF_IO. */
hf_status hf_store_file_check(const char *path, hf_messages *messages);

/* Checks that `path` can be written, takes its lock, and removes what a killed process has left. replaces: files with
 * the names of result and journal may be replaced. Returns HF_OK; HF_EXISTS if something else has one of the names or
 * the lock is taken; HF_IO; HF_NO_MEMORY. The caller calls hf_store_file_end in any case. */
hf_status hf_store_file_begin(const char *path, bool replaces, hf_store_file *file, hf_messages *messages);

/* Checks that the name for an earlier result is free. Returns HF_OK, HF_EXISTS if it is taken, or HF_IO. */
hf_status hf_store_file_demand_room(hf_store_file *file, hf_messages *messages);

/* Removes the earlier result beside a finished one. The process of the finished run has ended before it could do so. */
void hf_store_file_forget_earlier(const char *result);

/* The calls below do nothing if io.status is not HF_OK, except hf_store_file_close and hf_store_file_end. Creating,
 * opening and closing need the lock of HDF5, and so does hf_store_file_end of an open file. */

void hf_store_file_create(hf_store_file *file); /* makes a new temporary file */
void hf_store_file_open(hf_store_file *file);   /* copies the visible file into the temporary file, unless it is open */
void hf_store_file_adopt(hf_store_file *file);  /* the visible file becomes that of this run */

/* Asks the system to start writing to the disk what is new since the last call, if it is FLOW_BYTES or more. The sync
 * at the end then has less to wait for. */
void hf_store_file_flow(hf_store_file *file);

void hf_store_file_close(hf_store_file *file); /* closes the temporary file, which is whole */

/* Gives the temporary file the visible name; with `durable`, after a sync. io.status becomes HF_EXISTS if another
 * process has taken the name, and HF_IO if the rename fails. With `durable` the file is then kept under a name that the
 * message gives. An earlier finished result keeps a name until is_finished. */
void hf_store_file_publish(hf_store_file *file, bool durable, bool is_finished);

/* Closes and frees everything, removes the temporary file and releases the lock. The journal stays if it holds
 * generations that the visible file does not hold. It also stays if nothing was published and it was there before, or
 * if the temporary file could not be removed. */
void hf_store_file_end(hf_store_file *file, hf_messages *messages);
