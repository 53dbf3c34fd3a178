/* goals - rows of optimize.goals for tests, and a net with the target surface of these rows. Header only, like
 * nets.h. */
#ifndef HIFDM_TESTS_GOALS_H
#define HIFDM_TESTS_GOALS_H

#include "flexible.h"

#include <hifdm/goals.h>
#include <hifdm/surface.h>

/* ---- rows ---- */

#define WANT(kind, of_set, to, weighed)                                                                                \
    {                                                                                                                  \
        .goal = HF_GOAL_##kind, .set = of_set, .target = to, .weight = weighed, .mass_kg_per_m = NAN                   \
    }
#define WANT_MASS(of_set, kg_per_m)                                                                                    \
    {                                                                                                                  \
        .goal = HF_GOAL_MASS, .set = of_set, .target = NAN, .weight = 1, .mass_kg_per_m = kg_per_m                     \
    }
#define WANT_ERROR(kind, by, of_fit, weighed)                                                                          \
    {                                                                                                                  \
        .goal = HF_GOAL_##kind, .target = NAN, .weight = weighed, .mass_kg_per_m = NAN, .along = HF_ALONG_##by,        \
        .fit = HF_FIT_##of_fit                                                                                         \
    }
#define WANT_ERRORS(kind, weighed)                                                                                     \
    WANT_ERROR(kind, NORMAL, NONE, weighed), WANT_ERROR(kind, NORMAL, BEST, weighed),                                  \
        WANT_ERROR(kind, HALF_PATH, NONE, weighed), WANT_ERROR(kind, HALF_PATH, BEST, weighed)
/* Eight rows: four for nodes, then four for facets. */
#define WANT_SURFACES(weighed) WANT_ERRORS(SURFACE, weighed), WANT_ERRORS(FACETS, weighed)

static inline hf_goal_settings goal_of(hf_goal_kind kind)
{
    return (hf_goal_settings){.goal = kind, .target = NAN, .weight = 1, .mass_kg_per_m = NAN};
}

/* ---- a net ---- */

#define SMALL_BOWL "configs/paraboloid-6m.yaml", "scene.paraboloid.rings=3"
#define FAR_FIELD "surface.frequencies_Hz=[0.2e9, 0.3e9]", "surface.pattern.n_theta=3"

/* A net with its target surface and facets. */
struct wanting {
    struct net net;
    hf_surface_settings surface;
    hf_facets facets;
    hf_goals goals;
    hf_goals_point point;
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
    hf_goals_point_free(&t->point);
    hf_goals_free(&t->goals);
    hf_facets_free(&t->facets);
    close_net(&t->net);
}

static inline void want(struct wanting *t, int n_goal, const hf_goal_settings *goal)
{
    hf_optimize_settings s = {.n_goal = n_goal};
    hf_messages messages = {0};
    ck_assert_int_le(n_goal, HF_DESIGN_ROWS_MAX);
    for (int k = 0; k < n_goal; k++)
        s.goal[k] = goal[k];
    hf_status status =
        hf_goals_create(&t->net.scene, &t->net.model, &s, &t->surface, &t->facets, NULL, &t->goals, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text);
    hf_messages_free(&messages); /* warns of a feed without a beam */
    ck_assert_int_eq(hf_goals_point_create(&t->goals, &t->point), HF_OK);
}

#endif
