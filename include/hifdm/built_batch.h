/* built_batch - solves very many as-built nets with different errors on all cores (METHOD section 12).
 * Stability: internal; this header may change in any version.
 *
 * Pipeline for eight samples at a time in vector lanes:
 *
 *   hf_built_sample   index -> lengths, stiffness and supports of the sample
 *   solver            steps with the matrix of the nominal net (M33), then Newton's method (M34), then hf_built_solve
 *   hf_built_take     receives shape and result -> measures of the caller
 *
 * The header built.h describes the as-built net and its possible differences from the nominal net. The function
 * hf_built_solve is the reference. The reference gives the same statuses and counts as a batch, and the same shapes
 * within the residual tolerance. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/built.h>

HF_API_BEGIN

/* Quantities, in addition to the cable lengths, that vary between the samples of a run. */
enum {
    HF_BUILT_VARIES_EA = 1,      /* axial stiffness of cables */
    HF_BUILT_VARIES_SUPPORTS = 2 /* positions of supports */
};

/* The shape of one sample, in arrays by row. The arrays of the shape are valid only during the call of hf_built_take.
 * If the status gives no shape (hf_status_has_shape), the values of the arrays have no meaning. */
typedef struct {
    const double *position_m; /* [3][n_node] positions, m */
    const double *tension_N;  /* [n_cable] tensions, N */
    /* [n_node] 1: no taut cable holds this node; all 0 unless n_loose of the result is above 0 */
    const unsigned char *loose;
    const double *displacement_m; /* [3 n_attachment] displacements of the attachments by the truss, m */
} hf_built_shape;

/* Defines sample i. The callback changes the nominal values in cut_m [n_cable] and EA_N [n_cable], and the zeros in
 * support_displacement_m [3][n_node] by row. The struct hf_built_net describes these arrays. EA_N is NULL if the
 * stiffness does not vary, and support_displacement_m is NULL if the supports do not vary. Any thread may call the
 * callback, also for several samples at the same time and more than once for one sample. The values that the callback
 * writes must depend on i alone. */
typedef void hf_built_sample(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m);

/* Receives the shape and the result of sample i. Any thread may call the callback, in any order and for several samples
 * at the same time. */
typedef void hf_built_take(void *context, long i, const hf_built_shape *shape, const hf_form_result *result);

/* A batch holds the memory of the threads and the matrix that they share. */
typedef struct hf_built_batch hf_built_batch;

/* Creates a batch of n_thread threads. If n_thread is 0, the batch has one thread for each core. The batch borrows
 * `built` until hf_built_batch_free. Returns HF_OK, or HF_NO_MEMORY with *batch set to NULL. */
hf_status hf_built_batch_create(const hf_built *built, int n_thread, hf_built_batch **batch);
/* Frees the batch, which may be NULL. */
void hf_built_batch_free(hf_built_batch *batch);
/* Returns the number of threads. */
int hf_built_batch_threads(const hf_built_batch *batch);

/* Updates a batch of one thread after a call of hf_built_renew. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_built_batch_renew(hf_built_batch *batch);

/* Solves one net in the calling thread. The net may have its own loads. Returns the workspace of the first thread. The
 * workspace holds the shape until the next call. */
const hf_workspace *hf_built_batch_find(hf_built_batch *batch, const hf_built_net *net, hf_form_result *result);

/* Makes and solves the samples first to first + n - 1, and passes each sample to `take`. The function ends early if the
 * flag built->stop is set. The argument `varies` is 0 or a combination of the flags HF_BUILT_VARIES_... The bits of a
 * result depend only on the values of its sample. The bits of a result do not depend on the number of threads, the
 * other samples or the instruction set. The result has the same figures as that of hf_built_solve. Only the counts of
 * steps differ, because they are the counts of the faster method (iterations and, on a truss, the coupling). */
void hf_built_batch_run(hf_built_batch *batch, unsigned varies, long first, long n, hf_built_sample *make,
                        hf_built_take *take, void *context);

HF_API_END
