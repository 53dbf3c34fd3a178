/* Creates the objectives of a case from the rows of optimize.goals or optimize.objectives.
 *
 *     row of settings
 *         | load case or samples -> nets;  set -> cables;  gain -> beam
 *         | faults of the row in this scene -> messages
 *         v
 *     objective with its block of residuals among all */
#include <hifdm/goals.h>

#include "base/arena.h"
#include "net/cable_pick.h"
#include "surface/cloud.h"
#include "surface/gain.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- rows of the settings ---- */

static const hf_goal_settings psi_alone = {.goal = HF_GOAL_PSI, .target = NAN, .weight = 1, .mass_kg_per_m = NAN};

bool hf_goals_is_on_surface(hf_goal_kind kind)
{
    return kind == HF_GOAL_SURFACE || kind == HF_GOAL_FACETS;
}

static bool is_of_facets(hf_goal_kind kind)
{
    return kind == HF_GOAL_FACETS || kind == HF_GOAL_GAIN;
}

static bool has_set(hf_goal_kind kind)
{
    return kind == HF_GOAL_TENSION || kind == HF_GOAL_LENGTH || kind == HF_GOAL_EVENNESS || kind == HF_GOAL_MASS ||
           kind == HF_GOAL_RATIO;
}

bool hf_goals_is_largest(hf_goal_kind kind)
{
    return kind == HF_GOAL_PULL || kind == HF_GOAL_DISPLACEMENT || kind == HF_GOAL_RATIO;
}

/* Returns what is wrong with objective k in this scene, as the end of a sentence, or NULL. */
static const char *fault_of(const hf_goals *goals, int k, const hf_surface_settings *surface, const hf_facets *facets)
{
    const hf_goal *g = &goals->goal[k];
    const hf_model *m = goals->model;
    const hf_goal_settings *s = &g->wanted;
    if (hf_goals_is_on_surface(s->goal) && (!surface || !(surface->focal_length_m > 0)))
        return "needs the wanted surface: add a section surface (of an imported net with focal_length_m)";
    if (s->goal == HF_GOAL_GAIN && (!surface || !surface->has_pattern))
        return "needs a section surface.pattern, which says what illuminates the reflector";
    if (is_of_facets(s->goal) && (!facets || facets->n_facet == 0)) return "this net has no facets";
    if (s->goal == HF_GOAL_GAIN && goals->beam[k].order == HF_GAIN_ORDER_MOST) return HF_GAIN_TOO_COARSE;
    if (s->goal == HF_GOAL_SURFACE && s->fit == HF_FIT_BEST && m->n_inner_node < HF_FIT_N_PARAMETER)
        return "a best fit needs at least six inner nodes";
    if (s->goal == HF_GOAL_TENSION && isnan(s->target)) return "needs a target, in N";
    if (s->goal == HF_GOAL_MASS && !(s->mass_kg_per_m > 0)) return "needs mass_kg_per_m, of the cables of its set";
    if (s->goal == HF_GOAL_EVENNESS && g->n_cable == 1) return "one cable is always even; name a set of several";
    if (s->goal == HF_GOAL_RATIO && g->n_cable == 1) return "the ratio of one cable is 1; name a set of several";
    if (s->goal == HF_GOAL_PULL && m->n_node == m->n_free) return "this net has no supports";
    if (s->goal == HF_GOAL_DISPLACEMENT && m->n_attachment == 0)
        return "needs a truss that gives way: this net has none";
    return NULL;
}

static int row_count(const hf_goals *goals, const hf_goal *g)
{
    const hf_model *m = goals->model;
    switch (g->wanted.goal) {
    case HF_GOAL_PSI:
        return 3 * m->n_inner_node;
    case HF_GOAL_PULL:
        return m->n_node - m->n_free;
    case HF_GOAL_DISPLACEMENT:
        return m->n_attachment;
    case HF_GOAL_MASS:
        return 1;
    case HF_GOAL_RATIO:
        return 2 * g->n_cable;
    case HF_GOAL_FACETS:
        return hf_cloud_facet_points(goals->n_facet);
    case HF_GOAL_SURFACE:
        return m->n_inner_node;
    case HF_GOAL_GAIN:
        return 2 * hf_gain_points(&goals->beam[g - goals->goal], goals->n_facet);
    default:
        return g->n_cable;
    }
}

/* ---- creation ---- */

#define LOSS_MOST_DB 3.0 /* loss at the target positions above which an objective of gain causes a warning */

/* Maximum number of residuals of all objectives: a table of them takes 1 GiB, and their indices are int. */
#define ROWS_MAX (1L << 27)

/* Gives objective g its rows and adds their number to *n_all. That number is a long: 3 000 nodes under 16 objectives
 * over 100 000 samples have more rows than an int holds. */
static void number_rows(hf_goals *goals, hf_goal *g, long *n_all)
{
    g->n_shape_row = row_count(goals, g);
    *n_all += (long)g->n_shape_row * (g->n_net ? g->n_net : 1);
    if (*n_all > ROWS_MAX) return; /* hf_goals_create refuses more rows */
    g->first_row = goals->n_row;
    g->n_row = (int)*n_all - g->first_row;
    goals->n_row = (int)*n_all;
}

static hf_status refuse_rows(const hf_goals *goals, const char *list, long n_all, hf_messages *messages)
{
    char where[HF_PLACE_SIZE];
    int n_sample = 0;
    for (int k = 0; k < goals->n_goal; k++)
        if (goals->goal[k].wanted.over == HF_OVER_SAMPLES) n_sample = goals->goal[k].n_net;
    if (n_sample)
        hf_messages_place(messages, where, "optimize.samples");
    else
        hf_messages_place(messages, where, "optimize.%s", list);
    return hf_error(messages, HF_BAD_CASE,
                    "%s: the goals have %ld residuals in all nets, and at most %ld (1 GiB) are kept: take fewer %s",
                    where, n_all, ROWS_MAX, n_sample ? "samples, or fewer goals over samples" : "goals");
}

static void lay_out(hf_arena *a, const hf_model *m, hf_goals *goals)
{
    for (int k = 0; k < goals->n_goal; k++)
        goals->goal[k].cable =
            has_set(goals->goal[k].wanted.goal) ? hf_arena_take(a, (size_t)m->n_cable, sizeof(int)) : NULL;
    goals->corner_row = hf_arena_take(a, 4 * (size_t)goals->n_facet, sizeof(int));
    goals->beam = hf_arena_take(a, (size_t)goals->n_goal, sizeof *goals->beam);
}

/* Sets the nets of an objective. The case has been checked, so the load case or the samples of the row exist. */
static void choose_nets(const hf_goals_nets *nets, hf_goal *g)
{
    const hf_goal_settings *s = &g->wanted;
    for (int k = 0; nets && *s->state && k < nets->n_state; k++)
        if (!strcmp(nets->state_name[k], s->state)) g->first_net = k, g->n_net = 1;
    if (nets && s->over == HF_OVER_STATES) g->n_net = nets->n_state;
    if (nets && s->over == HF_OVER_SAMPLES) g->first_net = nets->n_state, g->n_net = nets->n_sample;
}

/* Makes the beam of objective k, if it is a gain. Without a frequency in the row it uses the highest one of the
 * surface. */
static void make_beam(const hf_scene *scene, const hf_surface_settings *s, const hf_facets *facets, hf_goals *goals,
                      int k)
{
    double frequency_Hz = goals->goal[k].wanted.frequency_Hz;
    if (goals->goal[k].wanted.goal != HF_GOAL_GAIN || !s || !s->has_pattern || !facets || !facets->n_facet) return;
    if (!(frequency_Hz > 0)) frequency_Hz = hf_surface_highest_Hz(s);
    hf_gain_beam_make(s, facets, scene->position_m, frequency_Hz, &goals->beam[k]);
}

/* Warns if the shape at the target positions has no beam whose gain objective k could raise. A paraboloid, for example,
 * focuses a plane wave along its axis. */
static void warn_of_no_beam(const hf_scene *scene, const hf_facets *facets, const hf_goals *goals, int k,
                            const char *where, hf_messages *messages)
{
    if (goals->goal[k].wanted.goal != HF_GOAL_GAIN) return;
    double loss_dB =
        hf_gain_loss_dB(&goals->beam[k], &(hf_pattern_surface){.facets = facets, .position_m = scene->position_m});
    if (loss_dB > LOSS_MOST_DB)
        hf_warning(
            messages,
            "%s: gain: the theoretical shape itself loses %.3g dB in the direction of the beam: this "
            "feed makes no beam of it. Use another surface.pattern.feed (a plane wave is focused by a paraboloid), "
            "a lower frequency or more facets",
            where, loss_dB);
}

hf_status hf_goals_create(const hf_scene *scene, const hf_model *m, const hf_optimize_settings *s,
                          const hf_surface_settings *surface, const hf_facets *facets, const hf_goals_nets *nets,
                          hf_goals *goals, hf_messages *messages)
{
    hf_arena arena = {0};
    int n_fault = 0;
    long n_all = 0;
    bool is_front = s->n_objective > 0;
    *goals = (hf_goals){.model = m, .n_goal = is_front ? s->n_objective : s->n_goal > 0 ? s->n_goal : 1};
    for (int k = 0; k < goals->n_goal; k++) {
        goals->goal[k].wanted = is_front ? s->objective[k] : s->n_goal > 0 ? s->goal[k] : psi_alone;
        if (is_front) goals->goal[k].wanted.weight = 1;
        if (is_of_facets(goals->goal[k].wanted.goal) && facets) goals->n_facet = facets->n_facet;
        choose_nets(nets, &goals->goal[k]);
        if (goals->goal[k].n_net) goals->nets = nets;
    }
    if (surface) {
        goals->kind = surface->kind;
        goals->focal_length_m = surface->focal_length_m;
    }
    if (HF_ARENA_MAKE(&arena, lay_out(&arena, m, goals)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the goals");
    goals->block = arena.block;
    for (int i = 0; i < 4 * goals->n_facet; i++)
        goals->corner_row[i] = m->row_of_node[facets->corner[i]];
    const char *list = is_front ? "objectives" : "goals";
    for (int k = 0; k < goals->n_goal; k++) {
        hf_goal *g = &goals->goal[k];
        char where[HF_PLACE_SIZE];
        hf_messages_place(messages, where, "optimize.%s.%d.set", list, k);
        make_beam(scene, surface, facets, goals, k);
        if (g->cable) g->n_cable = hf_cable_pick_some(scene, g->wanted.set, where, g->cable, messages);
        bool is_known = !g->cable || g->n_cable > 0;
        const char *fault = is_known ? fault_of(goals, k, surface, facets) : NULL;
        hf_messages_place(messages, where, "optimize.%s.%d", list, k);
        if (fault) hf_error(messages, HF_BAD_CASE, "%s: %s: %s", where, hf_goal_word[g->wanted.goal], fault);
        if (!fault) warn_of_no_beam(scene, facets, goals, k, where, messages);
        n_fault += !is_known || fault;
        number_rows(goals, g, &n_all);
    }
    if (n_all > ROWS_MAX) return refuse_rows(goals, list, n_all, messages);
    return n_fault ? HF_BAD_CASE : HF_OK;
}

const char *hf_goals_name(const hf_goals *goals, int i_goal, char text[HF_GOAL_NAME_SIZE])
{
    const hf_goal_settings *s = &goals->goal[i_goal].wanted;
    int n =
        snprintf(text, HF_GOAL_NAME_SIZE, "goal_%d_%s%s%s", i_goal, hf_goal_word[s->goal], *s->set ? "_" : "", s->set);
    const char *of_many = s->quantile > 0 ? "quantile" : hf_take_word[s->take];
    if (*s->state) /* as much of the name as fits */
        snprintf(text + n, HF_GOAL_NAME_SIZE - (size_t)n, "_%.24s", s->state);
    else if (s->over != HF_OVER_DESIGN)
        snprintf(text + n, HF_GOAL_NAME_SIZE - (size_t)n, "_%s_%s", hf_over_word[s->over], of_many);
    return text;
}

void hf_goals_free(hf_goals *goals)
{
    hf_arena arena = {.block = goals->block};
    hf_arena_free(&arena);
    *goals = (hf_goals){0};
}
