/* built_batch - very many nets as built, each with errors of its own, solved on all cores (METHOD section 12).
 * Stability: internal; may change in any version.
 *
 * What a net as built is, and what may differ in one, stands in built.h; hf_built_solve, the reference, gives the same
 * shapes to the tolerance of the residual, and the same statuses and counts. */
#ifndef HIFDM_BUILT_BATCH_H
#define HIFDM_BUILT_BATCH_H

#include <hifdm/api.h>
#include <hifdm/built.h>

HF_API_BEGIN

/* In what the samples of a run differ, beside the lengths of their cables. */
enum {
    HF_BUILT_VARIES_EA = 1,      /* the stiffnesses of cables */
    HF_BUILT_VARIES_SUPPORTS = 2 /* the places of supports */
};

/* The shape of one sample, by row; valid during the call of hf_built_take. Of a sample whose status gives no shape
 * (hf_status_has_shape) the values mean nothing. */
typedef struct {
    const double *position_m;     /* [3][n_node] */
    const double *tension_N;      /* [n_cable] */
    const unsigned char *loose;   /* [n_node] 1: no taut cable holds this node; all 0 unless the result has n_loose */
    const double *displacement_m; /* [3 n_attachment] of the attachments by the truss */
} hf_built_shape;

/* Make sample i: change the nominal values in cut_m [n_cable], EA_N [n_cable], and the zeros in support_move_m
 * [3][n_node] by row, which mean what they mean in hf_built_net. EA_N and support_move_m are NULL when they do not
 * vary. Called in any thread, for several samples at a time, and more than once for some: what it writes depends on i
 * alone. */
typedef void hf_built_sample(void *context, long i, double *cut_m, double *EA_N, double *support_move_m);

/* Take the shape and the result of sample i. Called in any thread and in any order, for several samples at a time, but
 * never for two with the same `place`, 0 to n_thread - 1, at once. */
typedef void hf_built_take(void *context, long i, int place, const hf_built_shape *shape, const hf_form_result *result);

typedef struct hf_built_batch hf_built_batch;

/* n_thread 0: one for each core. `built` is borrowed until hf_built_batch_free. Returns HF_OK; HF_NO_MEMORY, and *batch
 * is NULL. */
hf_status hf_built_batch_create(const hf_built *built, int n_thread, hf_built_batch **batch);
void hf_built_batch_free(hf_built_batch *batch);
int hf_built_batch_threads(const hf_built_batch *batch);

/* After hf_built_renew, of a batch of one thread. HF_OK or HF_NO_MEMORY. */
hf_status hf_built_batch_renew(hf_built_batch *batch);

/* Solve one net, which may have loads of its own, in this thread: the workspace of the first one holds its shape. */
const hf_workspace *hf_built_batch_find(hf_built_batch *batch, const hf_built_net *net, hf_form_result *result);

/* Make, solve and take samples first to first + n - 1: all of them, unless built->stop says to leave. `varies`: 0 or
 * flags HF_BUILT_VARIES_... A sample's bits depend on its own values alone: neither on the number of threads, nor on
 * the other samples, nor on the instruction set. In its result all figures of hf_built_solve are set but those of the
 * steps taken (iterations, and of a truss the coupling), which count the steps of another way. */
void hf_built_batch_run(hf_built_batch *batch, unsigned varies, long first, long n, hf_built_sample *make,
                        hf_built_take *take, void *context);

HF_API_END
#endif
