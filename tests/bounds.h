/* bounds - tests the error bounds on random nets of all laws, on rigid supports and on trusses. Each net is solved and
 * stopped at sixteen points between its first iteration and its answer. The oracle tests/verify/bound_oracle.py finds
 * the equilibrium with fifty digits and compares it with the bounds. Header only: a short run is part of `make test`
 * (property/solve), a long one of `make stress`. */
#pragma once

#include "flexible.h"
#include "stress/stress.h"

#include <inttypes.h>

enum { BOUND_STOPS = 16 };

/* ---- nets ---- */

/* Makes the fraction `part` of the cables of net->scene elastic. Their unstressed lengths fit the shape in the
 * workspace, with relative errors of up to `off`. Their stiffness is EA_N times a factor of 1 to 10^decades. */
static inline void cut_cables(struct rng *rng, struct net *net, double part, double EA_N, double decades, double off)
{
    hf_scene *s = &net->scene;
    hf_scene cut;
    ck_assert_int_eq(hf_scene_allocate(&cut, s->n_node, s->n_cable, s->load_N != NULL, 1, 0), HF_OK);
    memcpy(cut.position_m, s->position_m, 3 * (size_t)s->n_node * sizeof(double));
    if (s->load_N) memcpy(cut.load_N, s->load_N, 3 * (size_t)s->n_node * sizeof(double));
    memcpy(cut.role, s->role, (size_t)s->n_node);
    memcpy(cut.end, s->end, 2 * (size_t)s->n_cable * sizeof(int));
    memcpy(cut.group, s->group, (size_t)s->n_cable);
    for (int i = 0; i < s->n_node; i++)
        cut.node_id[i] = s->node_id[i];
    for (int e = 0; e < s->n_cable; e++) {
        double EA = EA_N * pow(10, rng_uniform(rng, 0, decades)), T = net->work.tension_N[e];
        bool is_cut = rng_uniform(rng, 0, 1) < part && T > 0;
        cut.cable_id[e] = s->cable_id[e];
        cut.law[e] = is_cut ? HF_LAW_ELASTIC : s->law[e];
        cut.EA_N[e] = is_cut ? EA : (double)NAN;
        cut.target[e] =
            is_cut ? net->work.length_m[e] / (1 + T / EA) * (1 + rng_uniform(rng, -off, off)) : s->target[e];
    }
    cut.text = s->text;
    s->text = NULL;
    hf_scene_free(s);
    *s = cut;
}

/* Makes a cable of length L* = span (1 + excess), divided into n pieces between two supports and loaded across by
 * cables of given tension. */
static inline void chain_scene(struct rng *rng, hf_scene *scene)
{
    struct hand_node node[24];
    struct hand_cable cable[24];
    int n = rng_int(rng, 2, 10), n_node = 0, n_cable = 0;
    double excess = pow(10, rng_uniform(rng, -8, -1));
    for (int i = 0; i <= n; i++)
        node[n_node++] = (struct hand_node){{i, 0, 0}, i == 0 || i == n ? HF_ROLE_SUPPORT : HF_ROLE_INNER, {0}};
    for (int i = 0; i < n; i++)
        cable[n_cable++] = (struct hand_cable){{i, i + 1}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1 + excess};
    for (int i = 1; i < n; i++) {
        node[n_node] =
            (struct hand_node){{i, 1 + rng_uniform(rng, 0, 1), rng_uniform(rng, -1, 1)}, HF_ROLE_SUPPORT, {0}};
        cable[n_cable++] = (struct hand_cable){{i, n_node++}, HF_GROUP_INNER, HF_LAW_TENSION, rng_uniform(rng, 5, 15)};
    }
    hand_scene(scene, n_node, node, n_cable, cable);
}

static inline void known_of(struct rng *rng, const char *law, double decades, int one_side, hf_scene *s)
{
    known_scene(rng, &(struct known){.decades = decades, .shake = 0.05, .law = law, .one_side = one_side}, s);
}

/* Kinds of nets. In those from 6 on, some or all cables are made elastic. */
enum { BOUND_KINDS = 12 };

static inline void open_kind(struct rng *rng, int kind, struct net *net)
{
    *net = (struct net){.form = tight_form(HF_METHOD_AUTO)};
    net->form.max_iterations = 3000;
    switch (kind % 6) {
    case 0:
        kind < 6 ? random_fdm_scene(rng, &net->scene) : known_of(rng, "ttffl", 1, 0, &net->scene);
        break;
    case 1:
        random_tension_scene(rng, &net->scene);
        break;
    case 2:
        random_reflector_scene(rng, &net->scene);
        break;
    case 3:
        known_of(rng, "tfl", 1, rng_int(rng, 0, 1), &net->scene);
        break;
    case 4:
        kind < 6 ? known_of(rng, "tf", 4, 0, &net->scene) : known_of(rng, "tffl", 2, 1, &net->scene);
        break;
    default:
        kind < 6 ? chain_scene(rng, &net->scene) : random_reflector_scene(rng, &net->scene);
    }
    open_net(net);
    if (kind < 6 || hf_evaluate_form(&net->model, &net->form, &net->work, NULL, &net->result) != HF_OK) return;
    double off = rng_int(rng, 0, 2) ? pow(10, rng_uniform(rng, -7, -2)) : 0;
    cut_cables(rng, net, kind % 3 ? 1 : 0.5, pow(10, rng_uniform(rng, 2, 5)), rng_uniform(rng, 0, 4), off);
    hf_workspace_free(&net->work);
    hf_model_free(&net->model);
    open_net(net);
}

/* ---- stops ---- */

/* Sets stop i. The first eight stops end the paper's iteration early; the others have tolerances from 1e-2 to 1e-14. On
 * a truss, the schemes of the coupling alternate, and its tolerance in metres is that of the lengths. */
static inline void set_stop(int i, hf_form_settings *form)
{
    static const int last[] = {1, 3, 10, 30, 100, 300, 1000, 3000};
    bool early = i < 8;
    form->method = early ? HF_METHOD_HIFDM : HF_METHOD_AUTO;
    form->max_iterations = early ? last[i] : 3000;
    form->residual_tolerance = form->length_tolerance = early ? 1e-13 : pow(10, -2 - 1.7 * (i - 8));
    form->coupling = (hf_coupling_settings){fmax(form->length_tolerance, 1e-13), (hf_coupling_scheme)(i % 3), 50};
}

static inline void put(FILE *f, const double *value, size_t n)
{
    ck_assert_uint_eq(fwrite(value, sizeof *value, n, f), n);
}

static inline void put_scene(FILE *f, int kind, const hf_model *m)
{
    size_t n = 3 * (size_t)m->n_node;
    size_t n_truss = 3 * (size_t)m->n_attachment;
    put(f, (double[]){kind, m->n_node, m->n_free, m->n_cable, m->reference_N, m->n_inner_node, m->n_attachment}, 7);
    for (int i = 0; i < m->n_attachment; i++)
        ck_assert_int_eq(m->attachment_row[i], m->n_free + i);
    if (n_truss) put(f, m->flexibility_m_per_N, n_truss * n_truss);
    put(f, m->position_m, n);
    for (size_t i = 0; i < n; i++)
        put(f, &(double){m->load_N ? m->load_N[i] : 0}, 1);
    for (int k = 0; k < m->n_inner_node; k++)
        put(f, &(double){m->inner_row[k]}, 1);
    for (int e = 0; e < m->n_cable; e++)
        put(f,
            (double[]){m->end_row[2 * e], m->end_row[2 * e + 1], m->law[e], m->target[e],
                       m->EA_N && m->law[e] == HF_LAW_ELASTIC ? m->EA_N[e] : (double)NAN},
            5);
}

/* Writes one record per stop: eight figures, positions, tensions. */
static inline void put_stop(FILE *f, const struct net *net, const hf_form_result *r)
{
    put(f,
        (double[]){r->status, r->bound_reason, r->condition, r->position_bound_m, r->psi_bound_m, r->psi_m,
                   r->position_error_m, r->residual_N},
        8);
    put(f, net->work.position_m, 3 * (size_t)net->model.n_node);
    put(f, net->work.tension_N, (size_t)net->model.n_cable);
}

/* Writes n_scene nets with their stops, and lets the oracle check them. least_proven: minimum share of shapes with
 * certified bounds. most_ratio: maximum of the median ratio of bound to true error. */
static inline void hold_bounds(uint64_t stream, int n_scene, bool on_truss, double least_proven, double most_ratio)
{
    const char *path = temp_path("bounds.bin");
    FILE *f = fopen(path, "wb");
    ck_assert_ptr_nonnull(f);
    for (int k = 0; k < n_scene; k++) {
        struct rng rng = rng_start(stream + (uint64_t)k);
        struct net net;
        open_kind(&rng, k % BOUND_KINDS, &net);
        if (on_truss) attach_some_way(&net, &rng, k);
        put_scene(f, k % BOUND_KINDS, &net.model);
        for (int i = 0; i < BOUND_STOPS; i++) {
            set_stop(i, &net.form);
            hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result);
            put_stop(f, &net, &net.result);
        }
        close_net(&net);
    }
    ck_assert_int_eq(fclose(f), 0);
    char proven[32], ratio[32];
    snprintf(proven, sizeof proven, "%g", least_proven);
    snprintf(ratio, sizeof ratio, "%g", most_ratio);
    printf("bounds of %d nets %s at %d stops each, seed %" PRIu64 ":\n", n_scene,
           on_truss ? "on trusses" : "on rigid supports", BOUND_STOPS, test_seed());
    struct command run =
        run_command(1500, (const char *const[]){python_program(), source_path("tests/verify/bound_oracle.py"), path,
                                                proven, ratio, NULL});
    printf("%s", run.out);
    ck_assert_msg(run.exit_code == 0, "%s%s", run.out, run.err);
    free_command(&run);
}
