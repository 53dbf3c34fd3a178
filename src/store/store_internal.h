/* store_internal - the struct of a store, shared by the files store*.c, and the calls that make and free a store. */
#pragma once

#include "store/generations.h"
#include "store/store_file.h"

typedef struct hf_store hf_store;

struct hf_store {
    hf_store_file f;
    hf_generations rows; /* rows.block is NULL before the search, but rows.every is set */
    int n_journal;       /* generations that only the journal has, until hf_store_restore has taken them */
    bool is_resumed;
    bool is_continued; /* the visible file is finished; it stays as it is until another finished one replaces it */
    char identity[65];
    double publish_s, published_at_s; /* duration of the last publication, and when it ended */
    double *refine;                   /* [n_refine] state of hf_store_refine, for the next publication; NULL: none */
    size_t n_refine;
    double refine_wall_s; /* wall-clock time until then */
};

/* Attribute of the root: an earlier result is beside this file while it is unfinished (store_file). */
#define HF_KEEPS_EARLIER "keeps_earlier"

/* Sets *earlier to the kind of the file at `path`, which a run is about to replace. Returns HF_OK, or HF_IO or
 * HF_NO_MEMORY if the file cannot be read now. */
hf_status hf_store_look_before(const char *path, hf_earlier *earlier, hf_messages *messages);

/* Reads everything that a run will read. It runs in a child process, because HDF5 crashes on some damaged files or
 * reads them forever. Of a finished result a run reads only the summary. */
void hf_store_read_like_a_run(const char *path);

/* Sets the command of hf_child_spawn whose process calls hf_store_read_like_a_run with the path of a file, before a run
 * reads this file. NULL: a copy of this process calls it. The words are borrowed. */
void hf_store_set_reader(const char *const *command);

/* Returns the value of the attribute HF_KEEPS_EARLIER, and false if the file does not have it. */
bool hf_store_keeps_earlier(hf_hdf5 *io);

/* Makes a new store that holds the lock of `path`. Returns NULL and sets *status if the lock cannot be taken or memory
 * runs out. */
hf_store *hf_store_new(const char *path, bool replaces, hf_status *status, hf_messages *messages);

/* Returns the status of the store. If a resumed file is damaged, the status becomes HF_EXISTS, because every further
 * attempt would fail. A failure of the machine stays HF_IO, because it may not recur. */
hf_status hf_store_judge(hf_store *s);

/* Ends the calls that make a store: sets *store, or frees `s` after a failure. Releases the lock of HDF5 and returns
 * the status. */
hf_status hf_store_hand_over(hf_store *s, hf_store **store);

void hf_store_free(hf_store *s, hf_messages *messages);

/* Lets generations wait in memory for hold_s, s, so that short ones are written to the journal together. A process that
 * is killed loses those that wait. hold_s 0 writes them. Returns HF_OK or HF_IO. */
hf_status hf_store_hold(hf_store *s, double hold_s, hf_messages *messages);

/* Begins a call that uses the file: takes the lock of HDF5 and opens the file. The caller releases the lock. */
hf_hdf5 *hf_store_enter(hf_store *s, hf_messages *messages);

#define HF_REFINE_STATE "/refine_state"
/* Writes the state of hf_store_refine. Removes one that an earlier session has left in a file that is finished without
 * one. */
void hf_store_put_refine(hf_store *s, bool finished);
