/* built_batch - very many as-built nets, each with errors of its own, solved on all cores (METHOD section 12).
 * Stability: internal; may change in any version.
 *
 * Pipeline, for eight samples at a time in vector lanes:
 *
 *   hf_built_sample   index -> lengths, stiffness and supports of the sample
 *   solver            steps with the matrix of the nominal net (M33), then Newton's method (M34), then hf_built_solve
 *   hf_built_take     shape and result -> measures of the caller
 *
 * built.h describes the as-built net and the differences that one may have. hf_built_solve, the reference, gives the
 * same shapes to the tolerance of the residual, and the same statuses and counts. */
#ifndef HIFDM_BUILT_BATCH_H
#define HIFDM_BUILT_BATCH_H

#include <hifdm/api.h>
#include <hifdm/built.h>

HF_API_BEGIN

/* What varies between the samples of a run besides the lengths of their cables. */
enum {
    HF_BUILT_VARIES_EA = 1,      /* axial stiffness of cables */
    HF_BUILT_VARIES_SUPPORTS = 2 /* positions of supports */
};

/* The shape of one sample, by row. It is valid during the call of hf_built_take. If the status gives no shape
 * (hf_status_has_shape), the values have no meaning. */
typedef struct {
    const double *position_m;     /* [3][n_node] positions, m */
    const double *tension_N;      /* [n_cable] tensions, N */
    const unsigned char *loose;   /* [n_node] 1: no taut cable holds this node; all 0 unless the result has n_loose */
    const double *displacement_m; /* [3 n_attachment] displacements of the attachments by the truss, m */
} hf_built_shape;

/* Makes sample i. The callback changes the nominal values in cut_m [n_cable] and EA_N [n_cable], and the zeros in
 * support_displacement_m [3][n_node] by row; hf_built_net describes them. EA_N and support_displacement_m are NULL if
 * they do not vary. It is called in any thread, for several samples at a time, and more than once for some. What it
 * writes depends on i alone. */
typedef void hf_built_sample(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m);

/* Receives the shape and the result of sample i. The callback is called in any thread, in any order and for several
 * samples at a time. */
typedef void hf_built_take(void *context, long i, const hf_built_shape *shape, const hf_form_result *result);

/* The memory of the threads and the matrix that they share. */
typedef struct hf_built_batch hf_built_batch;

/* Creates a batch of n_thread threads; 0: one for each core. `built` is borrowed until hf_built_batch_free. Returns
 * HF_OK, or HF_NO_MEMORY with *batch NULL. */
hf_status hf_built_batch_create(const hf_built *built, int n_thread, hf_built_batch **batch);
/* Frees the batch, which may be NULL. */
void hf_built_batch_free(hf_built_batch *batch);
/* Returns the number of threads. */
int hf_built_batch_threads(const hf_built_batch *batch);

/* Updates a batch of one thread after hf_built_renew. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_built_batch_renew(hf_built_batch *batch);

/* Solves one net, which may have loads of its own, in this thread. Returns the workspace of the first thread, which
 * holds the shape until the next call. */
const hf_workspace *hf_built_batch_find(hf_built_batch *batch, const hf_built_net *net, hf_form_result *result);

/* Makes and solves the samples first to first + n - 1, and passes each of them to `take`. It ends early if built->stop
 * is set. `varies` is 0 or flags HF_BUILT_VARIES_... The bits of a sample depend on its own values alone, not on the
 * number of threads, the other samples or the instruction set. The result has all figures of hf_built_solve except the
 * counts of steps (iterations, and the coupling on a truss), which are those of the faster method. */
void hf_built_batch_run(hf_built_batch *batch, unsigned varies, long first, long n, hf_built_sample *make,
                        hf_built_take *take, void *context);

HF_API_END
#endif
