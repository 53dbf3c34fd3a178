/* stress - common parts of the tests with numerically difficult nets. Every case must end in a solution that is
 * verified or in a refusal that names its culprit. Failures are a wrong number under a good status, a NaN under a good
 * status (but that of the position error where nodes drift), and a refusal without a culprit.
 * Contents: verdict - tally - known solutions. */
#pragma once

#include "laws.h"
#include "verified.h"

#include <hifdm/evaluate.h>

#define STRESS_TOLERANCE 1e-9 /* of the pretension, and of lengths */
#define STRESS_ROUNDED (1.01 * STRESS_TOLERANCE)

static inline int is_long_run(void)
{
    const char *value = getenv("HIFDM_STRESS");
    return value && *value && strcmp(value, "0") != 0;
}

/* ---- verdict ---- */

enum verdict { SOLVED, NAMED, NOT_CONVERGED, WRONG };

struct outcome {
    enum verdict verdict;
    hf_status status;
    double residual, condition, error_m; /* relative to the pretension; only of what is solved */
    int iterations;
};

static inline int is_named(const struct net *net)
{
    const hf_form_result *r = &net->result;
    int has_name = r->culprit >= 0 && r->culprit < (r->status == HF_SINGULAR         ? net->model.n_node
                                                    : r->status == HF_STRAIGHT_CHAIN ? net->model.n_chain
                                                                                     : net->model.n_cable);
    int is_ill_posed = r->status == HF_SINGULAR || r->status == HF_STRAIGHT_CHAIN || r->status == HF_COLLAPSED ||
                       r->status == HF_NOT_FINITE;
    if (r->status == HF_NOT_CONVERGED) return has_name && r->n_drifting == 0; /* rounding, at this cable */
    return has_name && is_ill_posed && isnan(r->psi_m) && isnan(r->position_error_m);
}

/* Check, find and verify net->scene with method newton; frees it. */
static inline struct outcome try_scene(hf_scene *scene, double pretension_N)
{
    struct net net = {.form = tight_form(HF_METHOD_NEWTON), .scene = *scene};
    struct outcome o = {.verdict = WRONG, .status = HF_BAD_CASE};
    hf_messages messages = {0};
    *scene = (hf_scene){0};
    net.form.pretension_N = pretension_N;
    net.form.residual_tolerance = net.form.length_tolerance = STRESS_TOLERANCE;
    net.form.max_iterations = 20000;
    hf_status checked = hf_scene_check(&net.scene, &messages);
    if (checked != HF_OK) {
        if (messages.text && strstr(messages.text, "'")) o.verdict = NAMED; /* an id in quotes */
        hf_messages_free(&messages);
        hf_scene_free(&net.scene);
        return o;
    }
    open_net(&net);
    o.status = hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result);
    o.iterations = net.result.iterations;
    if (o.status == HF_OK) {
        struct verified v = verify_shape(&net.model, &net.work, net.scene.law, net.scene.target);
        o.residual = v.residual_N / net.model.reference_N;
        o.condition = net.model.has_newton ? net.result.condition : 1;
        o.error_m = net.model.has_newton ? net.result.position_error_m : 0;
        int is_verified = o.residual <= STRESS_ROUNDED && v.length_gap <= STRESS_ROUNDED && v.least_tension_N >= 0;
        int is_unique = net.result.n_drifting == 0 && net.result.n_loose == 0;
        int has_error = is_unique || !net.model.has_newton ? o.error_m >= 0 : isnan(o.error_m);
        if (is_verified && isfinite(net.result.psi_m) && o.condition >= 1 && has_error) o.verdict = SOLVED;
    } else if (is_named(&net)) {
        o.verdict = NAMED;
    } else if (o.status == HF_NOT_CONVERGED) {
        o.verdict = NOT_CONVERGED;
        o.residual = net.result.residual_N / net.model.reference_N;
    }
    close_net(&net);
    return o;
}

/* ---- tally ---- */

struct tally {
    int n, count[4];
    double residual, condition; /* worst of what is solved; a singular matrix (INFINITY) is counted apart */
    int n_singular, iterations;
    int as[3]; /* named as singular, straight chain, collapsed; the rest when the scene was checked, or not finite */
};

static inline void tally_add(struct tally *t, const struct outcome *o)
{
    t->n++;
    t->count[o->verdict]++;
    if (o->iterations > t->iterations) t->iterations = o->iterations;
    if (o->verdict == NAMED && o->status >= HF_SINGULAR && o->status <= HF_COLLAPSED) t->as[o->status - HF_SINGULAR]++;
    if (o->verdict != SOLVED) return;
    t->residual = fmax(t->residual, o->residual);
    if (isinf(o->condition))
        t->n_singular++;
    else
        t->condition = fmax(t->condition, o->condition);
}

static inline void tally_join(struct tally *t, const struct tally *other)
{
    t->n += other->n;
    for (int i = 0; i < 4; i++)
        t->count[i] += other->count[i];
    for (int i = 0; i < 3; i++)
        t->as[i] += other->as[i];
    t->residual = fmax(t->residual, other->residual);
    t->condition = fmax(t->condition, other->condition);
    t->n_singular += other->n_singular;
    if (other->iterations > t->iterations) t->iterations = other->iterations;
}

static inline void tally_print(const char *name, const struct tally *t)
{
    printf(
        "%-30s %5d cases: %5d solved, %4d named (%d singular, %d straight, %d collapsed), %d not converged, %d wrong; "
        "worst residual %.1e Td, condition %.1e (%d infinite), %d iterations\n",
        name, t->n, t->count[SOLVED], t->count[NAMED], t->as[0], t->as[1], t->as[2], t->count[NOT_CONVERGED],
        t->count[WRONG], t->residual, t->condition, t->n_singular, t->iterations);
    fflush(stdout);
}

/* ---- known solutions ---- */

enum { KNOWN_NODE_MAX = 60, KNOWN_CABLE_MAX = 4 * KNOWN_NODE_MAX };

/* A net whose answer is known: positions and tensions first, loads that balance them after; then the theoretical shape
 * is the answer shaken by `shake` of the shortest cable. At least two cables of different direction at every free node
 * make the energy strictly convex. law_of: which laws may occur, a string of t, l, f. */
struct known {
    int is_planar;
    double decades;  /* of the tensions */
    double shake;    /* relative to the shortest cable */
    const char *law; /* drawn from at random */
    int one_side;    /* supports only where x is smallest */
};

static inline hf_law known_law(struct rng *rng, const char *law)
{
    char c = law[rng_int(rng, 0, (int)strlen(law) - 1)];
    return c == 't' ? HF_LAW_TENSION : c == 'l' ? HF_LAW_LENGTH : HF_LAW_FORCE_DENSITY;
}

static inline void known_scene(struct rng *rng, const struct known *k, hf_scene *scene)
{
    struct hand_node node[KNOWN_NODE_MAX];
    struct hand_cable cable[KNOWN_CABLE_MAX];
    int n_node = rng_int(rng, 8, KNOWN_NODE_MAX), n_support = rng_int(rng, 3, n_node / 2), n_cable = 0;
    double shortest = INFINITY;
    for (int i = 0; i < n_node; i++) {
        node[i] = (struct hand_node){.role = i < n_support ? HF_ROLE_SUPPORT : HF_ROLE_INNER};
        for (int c = 0; c < (k->is_planar ? 2 : 3); c++)
            node[i].position_m[c] = rng_uniform(rng, -2.385, 2.385);
        if (k->one_side && i < n_support) node[i].position_m[0] -= 4.8;
    }
    for (int i = n_support; i < n_node; i++) { /* to two or three earlier nodes: joined to the supports by induction */
        int n_new = rng_int(rng, 2, 3), before[3];
        for (int j = 0; j < n_new; j++) {
            int again = 1;
            while (again) {
                before[j] = rng_int(rng, 0, i - 1);
                again = 0;
                for (int h = 0; h < j; h++)
                    again |= before[h] == before[j];
            }
            struct hand_cable *e = &cable[n_cable++];
            *e = (struct hand_cable){{i, before[j]}, HF_GROUP_INNER, known_law(rng, k->law), 0};
            double *a = node[i].position_m, *b = node[before[j]].position_m, d[3];
            for (int c = 0; c < 3; c++)
                d[c] = b[c] - a[c];
            double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            double tension = 10 * pow(10, rng_uniform(rng, -k->decades / 2, k->decades / 2));
            shortest = fmin(shortest, length);
            e->target = e->law == HF_LAW_TENSION ? tension : e->law == HF_LAW_LENGTH ? length : tension / length;
            for (int c = 0; c < 3; c++) {
                node[i].load_N[c] -= tension * d[c] / length;
                if (before[j] >= n_support) node[before[j]].load_N[c] += tension * d[c] / length;
            }
        }
    }
    for (int i = n_support; i < n_node; i++)
        for (int c = 0; c < (k->is_planar ? 2 : 3); c++)
            node[i].position_m[c] += k->shake * shortest * rng_uniform(rng, -1, 1);
    hand_scene(scene, n_node, node, n_cable, cable);
}
