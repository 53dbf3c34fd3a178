/* evolution - a small run of the genetic algorithm that goes into a store. Its results come from no net. */
#pragma once

#include "results.h"
#include "small_ga.h"

#include <math.h>

enum { N_GENERATION = 6, N_INDIVIDUAL = 5, N_VARIABLE = 4 };

struct run {
    struct net net;
    hf_model model;
    hf_optimize_settings settings;
    hf_optimiser ga;
    double initial[N_VARIABLE];
    int variable[N_VARIABLE], leader[N_VARIABLE];
};

static inline void open_run(struct run *r)
{
    memset(r, 0, sizeof *r);
    open_bow(&r->net);
    find_shape(&r->net);
    r->settings = small_ga(N_INDIVIDUAL, N_GENERATION);
    for (int k = 0; k < N_VARIABLE; k++)
        r->leader[k] = k;
    r->model = (hf_model){.n_variable = N_VARIABLE,
                          .n_variable_group = 1,
                          .variable_cable = r->variable,
                          .variable_group = r->variable,
                          .variable_leader = r->leader,
                          .n_leader = N_VARIABLE};
    ck_assert_int_eq(hf_optimiser_create(&hf_optimiser_ga, &r->settings, &r->model, r->initial, &r->ga), HF_OK);
}

static inline void close_run(struct run *r)
{
    hf_optimiser_free(&r->ga);
    close_net(&r->net);
}

/* Writes results that depend only on the designs, and ranks them. */
static inline void fill(hf_optimiser *o)
{
    hf_population *g = &o->population;
    for (int i = 0; i < N_INDIVIDUAL; i++) {
        double psi_m = 0;
        for (int k = 0; k < N_VARIABLE; k++)
            psi_m += fabs(g->design[i * N_VARIABLE + k] - 0.1 * k);
        if (g->pending[i])
            g->result[i] =
                (hf_form_result){.status = i == N_INDIVIDUAL - 1 ? HF_NOT_CONVERGED : HF_OK, /* not all have a shape */
                                 .psi_m = psi_m,
                                 .merit = psi_m,
                                 .iterations = g->generation};
    }
    hf_optimiser_tell(o);
}

/* Stores generations first to n - 1, and publishes in between. *acknowledged: number of generations that are certainly
 * stored. */
static inline hf_status store_some(hf_store *s, struct run *r, int first, int n, int *acknowledged,
                                   hf_messages *messages)
{
    for (int g = first; g < n; g++) {
        if (g > 0) ck_assert(hf_optimiser_next(&r->ga));
        fill(&r->ga);
        HF_TRY(hf_store_generation(s, &r->model, &r->ga.population, messages));
        *acknowledged = g + 1;
        HF_TRY(hf_store_publish(s, &(hf_summary){.stage[HF_STAGE_SEARCH].exists = 1}, g % 3 == 1, messages));
    }
    return HF_OK;
}

static inline hf_status begin_new(const char *path, struct run *r, hf_store **s, hf_messages *messages)
{
    hf_messages *m = messages;
    HF_TRY(hf_store_create(path, 0, any_case(), &r->net.scene, NULL, 0, NULL, s, m));
    HF_TRY(hf_store_form(*s, &r->net.model, &r->net.work, NULL, m));
    HF_TRY(hf_store_variables(*s, &r->model, &r->ga.population, m));
    return hf_store_publish(*s, &(hf_summary){0}, 1, m);
}
