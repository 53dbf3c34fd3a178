/* goals - rows of optimize.objective for tests, and a net with the target surface of these rows. Header only, like
 * nets.h. */
#pragma once

#include "flexible.h"

#include <hifdm/objectives.h>
#include <hifdm/surface.h>

/* ---- rows ---- */

#define WANT(kind, of_set, to, weighed)                                                                                \
    {                                                                                                                  \
        .figure = HF_FIGURE_##kind, .set = of_set, .target = to, .weight = weighed, .mass_kg_per_m = NAN               \
    }
#define WANT_MASS(of_set, kg_per_m)                                                                                    \
    {                                                                                                                  \
        .figure = HF_FIGURE_MASS, .set = of_set, .target = NAN, .weight = 1, .mass_kg_per_m = kg_per_m                 \
    }
#define WANT_ERROR(kind, by, of_feed, weighed)                                                                         \
    {                                                                                                                  \
        .figure = HF_FIGURE_##kind, .target = NAN, .weight = weighed, .mass_kg_per_m = NAN, .along = HF_ALONG_##by,    \
        .feed = HF_##of_feed                                                                                           \
    }
#define WANT_ERRORS(kind, weighed)                                                                                     \
    WANT_ERROR(kind, NORMAL, FIXED, weighed), WANT_ERROR(kind, NORMAL, REFOCUSED, weighed),                            \
        WANT_ERROR(kind, HALF_PATH, FIXED, weighed), WANT_ERROR(kind, HALF_PATH, REFOCUSED, weighed)
/* Eight rows: four for nodes, then four for facets. */
#define WANT_SURFACES(weighed) WANT_ERRORS(SURFACE, weighed), WANT_ERRORS(FACETS, weighed)

static inline hf_objective_settings objective_of(hf_figure_kind kind)
{
    return (hf_objective_settings){.figure = kind, .target = NAN, .weight = 1, .mass_kg_per_m = NAN};
}

/* ---- a net ---- */

#define SMALL_BOWL "configs/paraboloid-6m.yaml", "scene.paraboloid.rings=3"
#define FAR_FIELD "surface.frequencies_Hz=[0.2e9, 0.3e9]", "surface.pattern.n_theta=3"

/* A net with its target surface and facets. */
struct wanting {
    struct net net;
    hf_surface_settings surface;
    hf_facets facets;
    hf_objectives objectives;
    hf_objectives_point point;
};

static inline void open_wanting(struct wanting *t, bool is_round, bool with_truss, struct rng *rng)
{
    hf_messages messages = {0};
    if (is_round)
        OPEN_CASE(&t->net, SMALL_BOWL, FAR_FIELD);
    else
        OPEN_CASE(&t->net, SMALL_REFLECTOR, FAR_FIELD);
    ck_assert_msg(hf_config_surface(&t->net.settings, &t->net.scene, &t->surface, &messages) == HF_OK, "%s",
                  messages.text);
    ck_assert_int_eq(hf_facets_find(&t->net.scene, &t->surface, &t->facets), HF_OK);
    ck_assert_int_gt(t->facets.n_facet, 0);
    if (with_truss) attach_all(&t->net, rng, 1e-4);
    hf_status status = with_truss ? find_coupled(&t->net, HF_COUPLING_AUTO, 1e-9)
                                  : hf_evaluate_form(&t->net.model, &t->net.form, &t->net.work, NULL, &t->net.result);
    ck_assert_int_eq(status, HF_OK);
}

static inline void close_wanting(struct wanting *t)
{
    hf_objectives_point_free(&t->point);
    hf_objectives_free(&t->objectives);
    hf_facets_free(&t->facets);
    close_net(&t->net);
}

static inline void want(struct wanting *t, int n_objective, const hf_objective_settings *objective)
{
    hf_optimize_settings s = {.n_term = n_objective};
    hf_messages messages = {0};
    ck_assert_int_le(n_objective, HF_DESIGN_ROWS_MAX);
    for (int k = 0; k < n_objective; k++)
        s.term[k] = objective[k];
    hf_status status = hf_objectives_create(&t->net.scene, &t->net.model, &s, &t->surface, &t->facets, NULL,
                                            &t->objectives, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text);
    hf_messages_free(&messages); /* warns of a feed without a beam */
    ck_assert_int_eq(hf_objectives_point_create(&t->objectives, &t->point), HF_OK);
}
