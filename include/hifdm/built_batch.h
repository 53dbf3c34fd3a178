/* built_batch - solves very many as-built nets with different errors on all cores (METHOD section 12).
 * Stability: internal. This header may change in any version.
 *
 * Pipeline for eight samples at a time in vector lanes:
 *
 *   hf_built_sample   index -> lengths, stiffness, supports and loads of the sample
 *   solver            steps with the matrix of the nominal net (M33), then Newton's method (M34), then hf_built_solve
 *   hf_built_take     receives shape and result -> measures of the caller
 *
 * The header built.h describes the as-built net and its possible differences from the nominal net. The function
 * hf_built_solve is the reference for this solver. A batch and hf_built_solve return the same statuses and counts. The
 * shapes of a batch and of hf_built_solve agree within the residual tolerance. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/built.h>

HF_API_BEGIN

/* These flags select the quantities that vary between samples in addition to the cable lengths. */
enum {
    HF_BUILT_VARIES_EA = 1,       /* axial stiffness of cables */
    HF_BUILT_VARIES_SUPPORTS = 2, /* positions of supports */
    HF_BUILT_VARIES_LOADS = 4     /* loads of nodes, of a net whose model has loads */
};

/* Points to the arrays that describe the shape of one sample. The arrays of the shape are valid only during the call of
 * hf_built_take. If the sample has no shape (hf_status_has_shape), the values in the arrays have no meaning. */
typedef struct {
    const double *position_m; /* [3][n_node] positions, m */
    const double *tension_N;  /* [n_cable] tensions, N */
    /* [n_node] 1: no taut cable holds this node; all 0 unless n_loose of the result is above 0 */
    const unsigned char *loose;
    const double *displacement_m; /* [3 n_attachment] displacements of the attachments by the truss, m */
} hf_built_shape;

/* Defines sample i. On entry, the arrays cut_m [n_cable] and EA_N [n_cable] contain the nominal values, and the array
 * support_displacement_m [3][n_node] contains zeros. The array load_N [3][n_node] contains the loads of the nominal
 * net. The callback changes the arrays to the values of sample i. The struct hf_built_net describes the arrays. The
 * arrays of quantities that do not vary are NULL. Several threads may call the callback at the same time. The callback
 * may be called more than once for the same sample. The values that the callback writes must depend on i alone. */
typedef void hf_built_sample(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m,
                             double *load_N);

/* Receives the shape and the result of sample i. Several threads may call the callback at the same time, and for the
 * samples in any order. */
typedef void hf_built_take(void *context, long i, const hf_built_shape *shape, const hf_form_result *result);

/* A batch contains the memory of its threads and the matrix that the threads share. */
typedef struct hf_built_batch hf_built_batch;

/* Creates a batch of n_thread threads. If n_thread is 0, the batch has one thread for each core. The batch borrows
 * `built` until hf_built_batch_free is called. Returns HF_OK, or HF_NO_MEMORY with *batch set to NULL. */
hf_status hf_built_batch_create(const hf_built *built, int n_thread, hf_built_batch **batch);
/* Frees the batch, which may be NULL. */
void hf_built_batch_free(hf_built_batch *batch);
/* Returns the number of threads. */
int hf_built_batch_threads(const hf_built_batch *batch);

/* Updates the batch that belongs to one thread. Call this function after hf_built_renew. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_built_batch_renew(hf_built_batch *batch);

/* Solves one net in the calling thread. The loads of this net may differ from the loads of the design. Returns the
 * workspace of the first thread. The shape in the workspace is valid until the next call. */
const hf_workspace *hf_built_batch_find(hf_built_batch *batch, const hf_built_net *net, hf_form_result *result);

/* Makes and solves the n samples from index `first` on, and passes each sample to the callback `take`. If the flag
 * built->stop is set, the function ends early. The argument `varies` is 0 or a combination of the flags
 * HF_BUILT_VARIES_... The values of a sample alone determine every bit of its result. The number of threads, the other
 * samples and the instruction set do not change any bit of a result. The result contains the same quantities as a
 * result of hf_built_solve. Only the numbers of iterations and of coupling steps differ from the results of
 * hf_built_solve. A batch counts the steps of the faster method. */
void hf_built_batch_run(hf_built_batch *batch, unsigned varies, long first, long n, hf_built_sample *make,
                        hf_built_take *take, void *context);

HF_API_END
