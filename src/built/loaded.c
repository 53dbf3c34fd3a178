#include "built/loaded.h"

#include "base/arena.h"

#include <string.h>

static hf_status solve(const hf_built *base, hf_built_batch *near, hf_built_loaded *l, hf_messages *messages)
{
    hf_workspace own = {0};
    const hf_workspace *w = &own;
    hf_built_net net;
    hf_form_result r = {.status = HF_NO_MEMORY};
    hf_built_load_case(base, l->material, l->load_case, l->attachment_move_m, l->cut_m, l->move_m, l->load_N, &net);
    hf_status status = HF_OK;
    if (near) {
        w = hf_built_batch_find(near, &net, &r);
    } else {
        status = hf_workspace_create(&base->model, &own);
        own.stop = base->stop;
        if (status == HF_OK) hf_built_solve(base, &net, &own, &r);
    }
    l->has_shape = r.status == HF_OK;
    if (hf_built_must_stop(base)) status = HF_INTERRUPTED;
    if (status == HF_OK && l->has_shape) status = hf_built_in_load_case(base, &net, w, &l->built, messages);
    hf_workspace_free(&own);
    return status;
}

hf_status hf_built_loaded_make(const hf_built *base, hf_built_batch *near, int n_thread, hf_built_loaded *l,
                               hf_messages *messages)
{
    size_t n = 3 * (size_t)base->model.n_node;
    if (!l->block)
        HF_TRY(HF_ARENA_ARRAYS(&l->block, HF_ARRAY(l->cut_m, base->model.n_cable), HF_ARRAY(l->move_m, n),
                               HF_ARRAY(l->load_N, n)));
    HF_TRY(solve(base, near, l, messages));
    if (!l->has_shape) return HF_OK;
    return l->batch ? hf_built_batch_renew(l->batch) : hf_built_batch_create(&l->built, n_thread, &l->batch);
}

void hf_built_loaded_free(hf_built_loaded *l)
{
    hf_built_batch_free(l->batch);
    hf_built_free(&l->built);
    hf_arena_free_block(l->block);
    *l = (hf_built_loaded){0};
}

void hf_built_loaded_apply(const hf_built_loaded *l, const hf_built_errors *e, double scale, const double *z,
                           double *cut_m, double *EA_N, double *support_displacement_m)
{
    const hf_model *m = &e->linear->built->model;
    memcpy(cut_m, m->target, (size_t)m->n_cable * sizeof *cut_m);
    hf_built_errors_apply(e, scale, z, cut_m, EA_N, support_displacement_m);
    for (int i = 0; i < m->n_cable; i++)
        if (l->load_case->rise_K[i] != 0) cut_m[i] *= 1 + l->material->expansion_per_K[i] * l->load_case->rise_K[i];
}
