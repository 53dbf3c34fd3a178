/* store_internal - the struct of a store, which its parts share; how it is made, handed over and freed. */
#ifndef HIFDM_STORE_INTERNAL_H
#define HIFDM_STORE_INTERNAL_H

#include "store/generations.h"
#include "store/store_file.h"

typedef struct hf_store hf_store;

struct hf_store {
    hf_store_file f;
    hf_generations rows;
    int n_journal; /* generations that only the journal has, until hf_store_restore has bred their designs again */
    int is_resumed;
    char identity[65];
    double publish_s, published_at_s; /* how long the last publication took, and when it ended */
    void *scratch;
    size_t scratch_bytes;
};

/* With the lock of the name; NULL and *status without. */
hf_store *hf_store_new(const char *path, int replaces, hf_status *status, hf_messages *messages);

/* The end of what makes a store: *store when all went well. Gives HDF5 back, returns the status. */
hf_status hf_store_hand_over(hf_store *s, hf_store **store);

void hf_store_free(hf_store *s);

/* Space that lasts until the next call; NULL, with a message, when there is none or the store has failed already. */
void *hf_store_scratch(hf_store *s, size_t bytes);

/* Attributes of the root: now in UTC; which job of Slurm this is, so that logs can be found. */
void hf_store_put_time(hf_store *s, const char *attribute);
void hf_store_put_job(hf_store *s);

#endif
