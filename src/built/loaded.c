#include "built/loaded.h"

#include "base/arena.h"

#include <stddef.h>
#include <string.h>

void hf_built_loaded_select(const hf_load_cases *load_cases, int k, const hf_built_rest *rest, int n_attachment,
                            hf_built_loaded *l)
{
    ptrdiff_t at = 3 * (ptrdiff_t)k * n_attachment;
    l->i_load_case = k;
    l->load_case = &load_cases->load_case[k];
    l->material = &load_cases->material;
    l->rest =
        (hf_built_rest){rest->move_m ? rest->move_m + at : NULL, rest->by_weight_m ? rest->by_weight_m + at : NULL};
}

static hf_status solve(const hf_built *base, hf_built_batch *near, hf_built_loaded *l, hf_messages *messages)
{
    hf_workspace own = {0};
    const hf_workspace *w = &own;
    hf_built_net net;
    hf_form_result r = {.status = HF_NO_MEMORY};
    hf_built_load_case(base, l->material, l->load_case, l->rest.move_m, l->cut_m, l->move_m, l->load_N, &net);
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
                               HF_ARRAY(l->load_N, n), HF_ARRAY(l->weight_N, n)));
    memset(l->weight_N, 0, n * sizeof *l->weight_N);
    if (hf_load_case_may_err(l->load_case, base->model.n_node, HF_LOAD_ERROR_GRAVITY)) /* else masses may be NaN */
        hf_built_add_weight(base, l->material, l->load_case->gravity_m_per_s2, l->weight_N);
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

bool hf_load_case_may_err(const hf_load_case *c, int n_node, hf_load_error kind)
{
    const double *of = kind == HF_LOAD_ERROR_GRAVITY ? c->gravity_m_per_s2 : c->force_N;
    int n = kind == HF_LOAD_ERROR_GRAVITY ? 3 : 3 * n_node;
    bool may = false;
    if (kind == HF_LOAD_ERROR_TEMPERATURE) return c->has_temperature;
    for (int i = 0; i < n && !may; i++)
        may = of[i] != 0;
    return may;
}

bool hf_built_loaded_errs(const hf_built_loaded *l, const hf_built_errors *e, hf_load_error kind)
{
    return e->sigma_load[kind] > 0 && hf_load_case_may_err(l->load_case, e->linear->built->model.n_node, kind);
}

double hf_built_loaded_error(const hf_built_loaded *l, const hf_built_errors *e, long sample, hf_load_error kind)
{
    return hf_built_loaded_errs(l, e, kind) ? hf_built_errors_of_load(e, sample, kind, l->i_load_case) : 0;
}

unsigned hf_built_loaded_vary(const hf_built_loaded *l, const hf_built_errors *e)
{
    bool has_gravity = hf_built_loaded_errs(l, e, HF_LOAD_ERROR_GRAVITY);
    bool has_loads = has_gravity || hf_built_loaded_errs(l, e, HF_LOAD_ERROR_FORCE);
    return hf_built_errors_vary(e) | (has_loads ? HF_BUILT_VARIES_LOADS : 0u) |
           (has_gravity && l->rest.by_weight_m ? HF_BUILT_VARIES_SUPPORTS : 0u);
}

/* Adds the errors of gravity and forces, each relative to what the load case prescribes. A truss deflects under its
 * weight, which has the same error. */
static void err_loads(const hf_built_loaded *l, const hf_model *m, double gravity, double force,
                      double *support_displacement_m, double *load_N)
{
    for (int k = 0; load_N && k < 3 * m->n_node; k++)
        load_N[k] +=
            gravity * l->weight_N[k] + force * l->load_case->force_N[3 * m->node_of_row[k % m->n_node] + k / m->n_node];
    for (int k = 0; gravity != 0 && l->rest.by_weight_m && k < 3 * m->n_attachment; k++)
        support_displacement_m[k % 3 * m->n_node + m->attachment_row[k / 3]] += gravity * l->rest.by_weight_m[k];
}

void hf_built_loaded_apply(const hf_built_loaded *l, const hf_built_errors *e, double scale, long sample,
                           const double *z, double *cut_m, double *EA_N, double *support_displacement_m, double *load_N)
{
    const hf_model *m = &e->linear->built->model;
    double warmer_K = scale * hf_built_loaded_error(l, e, sample, HF_LOAD_ERROR_TEMPERATURE);
    memcpy(cut_m, m->target, (size_t)m->n_cable * sizeof *cut_m);
    hf_built_errors_apply(e, scale, z, cut_m, EA_N, support_displacement_m);
    for (int i = 0; i < m->n_cable; i++) {
        double rise_K = l->load_case->rise_K[i] + warmer_K;
        if (rise_K != 0) cut_m[i] *= 1 + l->material->expansion_per_K[i] * rise_K;
    }
    err_loads(l, m, scale * hf_built_loaded_error(l, e, sample, HF_LOAD_ERROR_GRAVITY),
              scale * hf_built_loaded_error(l, e, sample, HF_LOAD_ERROR_FORCE), support_displacement_m, load_N);
}
