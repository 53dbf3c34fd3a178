/* store_internal - the struct of a store, shared by the files store*.c; making and freeing one. */
#ifndef HIFDM_STORE_INTERNAL_H
#define HIFDM_STORE_INTERNAL_H

#include "store/generations.h"
#include "store/store_file.h"

typedef struct hf_store hf_store;

struct hf_store {
    hf_store_file f;
    hf_generations rows;
    int every;     /* of the rows to be, see hf_generations_create */
    int n_journal; /* generations that only the journal has, until hf_store_restore has bred their designs again */
    bool is_resumed;
    char identity[65];
    double publish_s, published_at_s; /* how long the last publication took, and when it ended */
    double *polish; /* [n_polish] wall-clock time and state of hf_store_polish, for the next publication; NULL: none */
    size_t n_polish;
    void *scratch;
    size_t scratch_bytes;
};

/* An attribute of the root: beside this file, while it is unfinished, is an earlier result (store_file). */
#define HF_KEEPS_EARLIER "keeps_earlier"

/* What a run that replaces the file at `path` finds there. HF_OK, or HF_IO or HF_NO_MEMORY if it cannot be read now. */
hf_status hf_store_look_before(const char *path, hf_earlier *earlier, hf_messages *messages);

bool hf_store_keeps_earlier(hf_hdf5 *io);

/* A new store that holds the lock of `path`; NULL and *status when the lock cannot be had. */
hf_store *hf_store_new(const char *path, bool replaces, hf_status *status, hf_messages *messages);

/* Returns the status. Damage of a resumed file stands in the way of every attempt (HF_EXISTS); what the machine cannot
 * do now it may do later (HF_IO). */
hf_status hf_store_judge(hf_store *s);

/* Last step of the calls that make a store: sets *store, or frees `s` after a failure. Releases the lock of HDF5 and
 * returns the status. */
hf_status hf_store_hand_over(hf_store *s, hf_store **store);

void hf_store_free(hf_store *s, hf_messages *messages);

/* Scratch memory, valid until the next call. NULL when the store has failed already, or, with a message, without
 * memory. */
void *hf_store_scratch(hf_store *s, size_t bytes);

/* Write what hf_store_polish was told into a file that is published, and nothing into one that is finished. */
void hf_store_put_polish(hf_store *s, bool finished);

/* Write attributes of the root: the time now in UTC; the ids of the Slurm job, by which its logs can be found. */
void hf_store_put_time(hf_store *s, const char *attribute);
void hf_store_put_job(hf_store *s);

#endif
