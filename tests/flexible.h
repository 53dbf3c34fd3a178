/* flexible - random elastic foundations for the supports of test nets. Every symmetric positive definite matrix is the
 * flexibility of some structure. Header only, like nets.h. */
#pragma once

#include "nets.h"

#include "solve/certificate.h"
#include "solve/coupling.h"
#include "solve/equilibrium.h"
#include <hifdm/evaluate.h>

enum { MAX_ATTACHMENT = 160 };

/* Lists all supports of the net as attachments: sets their nodes in the scene and returns their number. */
static inline int list_supports(const struct net *net, int node[MAX_ATTACHMENT])
{
    int n = 0;
    for (int i = 0; i < net->scene.n_node; i++) {
        if (net->scene.role[i] != HF_ROLE_SUPPORT) continue;
        ck_assert_int_lt(n, MAX_ATTACHMENT);
        node[n++] = i;
    }
    return n;
}

/* Contents of a random flexibility: springs with a stiffness of about 1/scale at each attachment, and a few modes that
 * move all attachments together, like those of a bending truss, also by about `scale` per newton. */
enum { FLEX_FULL, FLEX_MODES_ALONE, FLEX_RIGID_IN_SOME, N_FLEX };

/* Returns a random flexibility [3n][3n], m/N, which the caller frees. With FLEX_RIGID_IN_SOME about every third
 * component does not move at all. */
static inline double *random_flexibility_of(struct rng *rng, int kind, int n_attachment, double scale_m_per_N)
{
    enum { N_MODE = 6 };
    int n = 3 * n_attachment;
    double *mode = malloc(sizeof *mode * (size_t)(N_MODE * n)), *f = calloc((size_t)(n * n), sizeof *f);
    ck_assert(mode && f);
    for (int i = 0; i < N_MODE * n; i++)
        mode[i] = rng_uniform(rng, -1, 1);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            for (int k = 0; k < N_MODE; k++)
                f[i * n + j] += scale_m_per_N / N_MODE * mode[k * n + i] * mode[k * n + j];
        if (kind != FLEX_MODES_ALONE) f[i * n + i] += scale_m_per_N * rng_uniform(rng, 0.5, 1);
    }
    for (int i = 0; i < n && kind == FLEX_RIGID_IN_SOME; i++)
        if (rng_int(rng, 0, 2) == 0)
            for (int j = 0; j < n; j++)
                f[i * n + j] = f[j * n + i] = 0;
    free(mode);
    return f;
}

static inline double *random_flexibility(struct rng *rng, int n_attachment, double scale_m_per_N)
{
    return random_flexibility_of(rng, FLEX_FULL, n_attachment, scale_m_per_N);
}

/* Puts all supports of an open net on a random foundation. The workspace is made again, because it becomes larger. */
static inline void attach_all_to(struct net *net, struct rng *rng, int kind, double scale_m_per_N)
{
    int node[MAX_ATTACHMENT], n = list_supports(net, node);
    hf_messages messages = {0};
    double *f = random_flexibility_of(rng, kind, n, scale_m_per_N);
    ck_assert_msg(hf_model_attach(&net->model, n, node, f, &messages) == HF_OK, "%s", messages.text);
    ck_assert(model_is_valid(&net->model));
    free(f);
    hf_workspace_free(&net->work);
    ck_assert_int_eq(hf_workspace_create(&net->model, &net->work), HF_OK);
    poison_workspace(&net->model, &net->work);
}

static inline void attach_all(struct net *net, struct rng *rng, double scale_m_per_N)
{
    attach_all_to(net, rng, FLEX_FULL, scale_m_per_N);
}

/* Puts the supports on a foundation of random stiffness. On the softest one supports move by centimetres. */
static inline void attach_some_way(struct net *net, struct rng *rng, int kind)
{
    attach_all_to(net, rng, kind % N_FLEX, exp(rng_uniform(rng, log(1e-7), log(3e-3))));
}

/* Finds the coupled shape of the net. */
static inline hf_status find_coupled(struct net *net, int scheme, double tof_m)
{
    net->form.coupling = (hf_coupling_settings){tof_m, (hf_coupling_scheme)scheme, 500};
    return hf_evaluate_form(&net->model, &net->form, &net->work, NULL, &net->result);
}

static inline hf_status find_net_of(const void *net, hf_workspace *w, hf_history *history, hf_form_result *r)
{
    const struct net *n = net;
    return hf_equilibrium_find(&n->model, &n->form, w, history, r);
}

/* Finds the coupled shape in one matrix, without prior iterations of the coupling. */
static inline hf_status find_at_once(struct net *net, double tof_m)
{
    net->form.coupling = (hf_coupling_settings){tof_m, HF_COUPLING_AUTO, 500};
    hf_form_prepare(&net->model, &net->work);
    hf_coupling_find_at_once(&net->model, &net->form.coupling, find_net_of, net, &net->work, NULL, &net->result);
    hf_certify(&net->model, &net->work, &net->result);
    return net->result.status;
}
