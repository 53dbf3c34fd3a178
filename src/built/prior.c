/* Computes the prior covariance D + U U' of the errors of cut lengths (METHOD section 12). own_m are the roots of D,
 * shared_m are the columns of U. Input are the sigmas of built/errors.h. */
#include "built/prior.h"

#include "base/arena.h"

#include <math.h>

/* Returns the error of the length of cable i by an error of 1 of this kind. */
static double effect_of(const hf_built_errors *errors, hf_error_kind kind, int i)
{
    const hf_built *b = errors->linear->built;
    double l0 = b->scene.target[i];
    if (kind == HF_ERROR_CUT) return 1;
    if (kind == HF_ERROR_TEMPERATURE) return errors->expansion_per_K[i] * l0;
    bool is_length = kind == HF_ERROR_RATIO || kind == HF_ERROR_RATIO_BATCH;
    return is_length ? l0 : -l0 * b->tension_N[i] / b->scene.EA_N[i];
}

static int count_cables(const hf_built_errors *errors, int spool)
{
    int n = 0;
    for (int i = 0; i < errors->linear->built->model.n_cable; i++)
        n += errors->spool[i] == spool;
    return n;
}

/* Adds the shared number of a kind for the cables of a spool, or for all cables when spool is -1. A spool of one cable
 * adds to the own error of that cable instead. */
static void add_number(const hf_built_errors *errors, hf_error_kind kind, int spool, hf_prior *p)
{
    const hf_scene *s = &errors->linear->built->scene;
    size_t n_cable = (size_t)s->n_cable;
    int n = spool < 0 ? s->n_cable : count_cables(errors, spool);
    if (errors->sigma[kind] == 0 || n == 0) return;
    double *column = p->shared_m + (size_t)p->n_shared * n_cable;
    for (int i = 0; i < s->n_cable; i++) {
        bool is_in = spool < 0 || errors->spool[i] == spool;
        double length = is_in ? errors->sigma[kind] * effect_of(errors, kind, i) : 0;
        if (n == 1)
            p->own_m[i] = sqrt(p->own_m[i] * p->own_m[i] + length * length);
        else
            column[i] = length;
    }
    if (n == 1) return;
    const char *name = spool < 0 ? NULL : spool < s->n_set ? s->set_name[spool] : hf_group_word[spool - s->n_set];
    p->number[p->n_shared++] = (hf_prior_number){kind, name, errors->sigma[kind]};
}

static void fill_prior(const hf_built_errors *errors, hf_prior *p)
{
    static const hf_error_kind own[] = {HF_ERROR_CUT, HF_ERROR_RATIO, HF_ERROR_EA};
    size_t n_cable = (size_t)errors->linear->built->model.n_cable;
    for (size_t i = 0; i < n_cable; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            double length = errors->sigma[own[k]] * effect_of(errors, own[k], (int)i);
            square += length * length;
        }
        p->own_m[i] = sqrt(square);
    }
    for (int spool = 0; spool < errors->n_spool; spool++) {
        add_number(errors, HF_ERROR_RATIO_BATCH, spool, p);
        add_number(errors, HF_ERROR_EA_BATCH, spool, p);
    }
    add_number(errors, HF_ERROR_TEMPERATURE, -1, p);
    for (size_t i = 0; i < n_cable; i++) {
        double square = p->own_m[i] * p->own_m[i];
        for (size_t k = 0; k < (size_t)p->n_shared; k++)
            square += p->shared_m[k * n_cable + i] * p->shared_m[k * n_cable + i];
        p->sigma_m[i] = sqrt(square);
    }
}

/* Allocates the prior, with room for all shared numbers that there can be. */
static hf_status allocate_prior(const hf_built_errors *e, hf_prior *p)
{
    size_t n = e->sigma[HF_ERROR_TEMPERATURE] > 0, per_spool = e->sigma[HF_ERROR_RATIO_BATCH] > 0;
    size_t n_cable = (size_t)e->linear->built->scene.n_cable;
    per_spool += e->sigma[HF_ERROR_EA_BATCH] > 0;
    for (int spool = 0; spool < e->n_spool && per_spool; spool++)
        n += count_cables(e, spool) > 1 ? per_spool : 0;
    n++; /* one spare: add_number forms the address of a column for a spool of one cable, too */
    return HF_ARENA_ARRAYS(&p->block, HF_ARRAY(p->own_m, n_cable), HF_ARRAY(p->sigma_m, n_cable),
                           HF_ARRAY(p->number, n), HF_ARRAY(p->shared_m, n * n_cable));
}

hf_status hf_prior_make(const hf_built *b, const hf_tolerance_settings *t, const double *expansion_per_K, hf_prior *p)
{
    const hf_built_linear of = {.built = b}; /* making errors reads only the net */
    hf_built_errors errors;
    *p = (hf_prior){0};
    hf_status status = hf_built_errors_make(&of, t, &(hf_built_heat){expansion_per_K, NULL}, &errors);
    if (status == HF_OK) status = allocate_prior(&errors, p);
    if (status == HF_OK) fill_prior(&errors, p);
    hf_arena_free_block(errors.block);
    return status;
}
