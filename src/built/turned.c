/* Solves posterior samples of an adjusted net (METHOD section 12). Input are the estimated errors, the posterior errors
 * of each sample and the adjustments. Output is the difference between solved and linear displacements. */
#include "built/turned.h"

#include <hifdm/built_batch.h>

#include <string.h>

hf_status hf_turned_answer(const hf_turned *t, const hf_workspace *shape, double *move_m)
{
    hf_built_linear *l = &t->estimate->linear;
    size_t n_cable = (size_t)l->built->model.n_cable, n_dof = l->n_dof;
    hf_status status = hf_built_linear_take(l, shape);
    if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
    memcpy(move_m, status == HF_OK ? t->cause->rest_m : t->doubt_m, HF_ESTIMATE_SAMPLES * n_dof * sizeof *move_m);
    for (size_t s = 0; s < HF_ESTIMATE_SAMPLES && status == HF_OK; s++) {
        for (size_t e = 0; e < n_cable; e++)
            t->strain_N[e] = l->cut_N_per_m[e] * t->cause->cut_m[s * n_cable + e];
        hf_built_linear_apply(l, 1, t->strain_N, move_m + s * n_dof, t->scratch);
    }
    return HF_OK;
}

/* Passes the arguments of hf_turned_beyond to each sample. */
typedef struct {
    const hf_turned *turned;
    const double *turn_m, *answer_m;
    const hf_workspace *shape;
    double *beyond_m;
} turned_samples;

/* Makes sample i: the estimated errors, its posterior errors and the adjustments. */
static void make_sample(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m)
{
    const turned_samples *t = context;
    const hf_estimate *p = t->turned->estimate;
    const hf_model *m = &p->built->model;
    const double *own_m = t->turned->cause->cut_m + (size_t)i * (size_t)m->n_cable;
    const double *rest_m = t->turned->cause->rest_m + (size_t)i * p->linear.n_dof;
    (void)EA_N;
    for (int e = 0; e < m->n_cable; e++)
        cut_m[e] += p->cut_m[e] + own_m[e] + t->turn_m[e];
    for (int row = m->n_free; row < m->n_node; row++)
        for (int c = 0; c < 3; c++)
            support_displacement_m[c * m->n_node + row] = p->rest_m[3 * row + c] + rest_m[3 * row + c];
}

/* Stores the displacements of sample i minus the linear ones. */
static void take_sample(void *context, long i, int place, const hf_built_shape *shape, const hf_form_result *result)
{
    const turned_samples *t = context;
    const hf_model *m = &t->turned->estimate->built->model;
    size_t first = (size_t)i * t->turned->estimate->linear.n_dof;
    const double *answer_m = t->answer_m + first, *at_m = t->shape->position_m;
    double *beyond_m = t->beyond_m + first;
    bool has_shape = hf_status_has_shape(result->status);
    (void)place;
    for (int row = 0; row < m->n_node; row++)
        for (int c = 0; c < 3; c++) {
            int at = c * m->n_node + row;
            beyond_m[3 * row + c] = has_shape ? shape->position_m[at] - at_m[at] - answer_m[3 * row + c] : 0;
        }
}

hf_status hf_turned_beyond(const hf_turned *turned, const double *turn_m, const hf_workspace *shape, int n_thread,
                           double *answer_m, double *beyond_m)
{
    const hf_built *b = turned->estimate->built;
    turned_samples t = {turned, turn_m, answer_m, shape, beyond_m};
    hf_built_batch *batch;
    HF_TRY(hf_turned_answer(turned, shape, answer_m));
    HF_TRY(hf_built_batch_create(b, n_thread, &batch));
    hf_built_batch_run(batch, HF_BUILT_VARIES_SUPPORTS, 0, HF_ESTIMATE_SAMPLES, make_sample, take_sample, &t);
    hf_built_batch_free(batch);
    return hf_built_must_stop(b) ? HF_INTERRUPTED : HF_OK;
}
