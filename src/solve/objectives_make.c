/* Creates the objectives of a case from the rows of optimize.objective or optimize.front.
 *
 *     row of settings
 *         | load case or samples -> nets;  set -> cables;  gain -> beam
 *         | faults of the row in this scene -> messages
 *         v
 *     objective with its block of residuals among all */
#include <hifdm/objectives.h>

#include "base/arena.h"
#include "net/cable_pick.h"
#include "surface/cloud.h"
#include "surface/gain.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- rows of the settings ---- */

static const hf_objective_settings psi_alone = {
    .figure = HF_FIGURE_PSI, .target = NAN, .weight = 1, .mass_kg_per_m = NAN};

bool hf_objectives_is_on_surface(hf_figure_kind kind)
{
    return kind == HF_FIGURE_SURFACE || kind == HF_FIGURE_FACETS;
}

static bool is_of_facets(hf_figure_kind kind)
{
    return kind == HF_FIGURE_FACETS || kind == HF_FIGURE_GAIN;
}

static bool has_set(hf_figure_kind kind)
{
    return kind == HF_FIGURE_TENSION || kind == HF_FIGURE_LENGTH || kind == HF_FIGURE_EVENNESS ||
           kind == HF_FIGURE_MASS || kind == HF_FIGURE_RATIO;
}

bool hf_objectives_is_maximum(hf_figure_kind kind)
{
    return kind == HF_FIGURE_PULL || kind == HF_FIGURE_DEFLECTION || kind == HF_FIGURE_RATIO;
}

/* Returns what is wrong with objective k in this scene, as the end of a sentence, or NULL. */
static const char *fault_of(const hf_objectives *objectives, int k, const hf_surface_settings *surface,
                            const hf_facets *facets)
{
    const hf_objective *g = &objectives->objective[k];
    const hf_model *m = objectives->model;
    const hf_objective_settings *s = &g->settings;
    if (hf_objectives_is_on_surface(s->figure) && (!surface || !(surface->focal_length_m > 0)))
        return "needs a target surface: add a section surface (with focal_length_m for an imported net)";
    if (s->figure == HF_FIGURE_GAIN && (!surface || !surface->has_pattern))
        return "needs a section surface.pattern with the feed of the reflector";
    if (is_of_facets(s->figure) && (!facets || facets->n_facet == 0)) return "this net has no facets";
    if (s->figure == HF_FIGURE_GAIN && objectives->beam[k].order == HF_GAIN_ORDER_MOST) return HF_GAIN_TOO_COARSE;
    if (s->figure == HF_FIGURE_SURFACE && s->feed == HF_REFOCUSED && m->n_inner_node < HF_FIT_N_PARAMETER)
        return "a refocused feed needs at least six inner nodes; use feed: fixed";
    if (s->figure == HF_FIGURE_TENSION && isnan(s->target)) return "needs a target, in N";
    if (s->figure == HF_FIGURE_MASS && !(s->mass_kg_per_m > 0)) return "needs mass_kg_per_m of the cables of its set";
    if (s->figure == HF_FIGURE_EVENNESS && g->n_cable == 1)
        return "the evenness of one cable is always 0; use a set of several cables";
    if (s->figure == HF_FIGURE_RATIO && g->n_cable == 1)
        return "the ratio of one cable is always 1; use a set of several cables";
    if (s->figure == HF_FIGURE_PULL && m->n_node == m->n_free) return "this net has no supports";
    if (s->figure == HF_FIGURE_DEFLECTION && m->n_attachment == 0)
        return "needs a truss that deflects, but this net has none";
    return NULL;
}

static int row_count(const hf_objectives *objectives, const hf_objective *g)
{
    const hf_model *m = objectives->model;
    hf_figure_kind figure = g->settings.figure;
    if (figure == HF_FIGURE_PSI) return 3 * m->n_inner_node;
    if (figure == HF_FIGURE_PULL) return m->n_node - m->n_free;
    if (figure == HF_FIGURE_DEFLECTION) return m->n_attachment;
    if (figure == HF_FIGURE_MASS) return 1;
    if (figure == HF_FIGURE_RATIO) return 2 * g->n_cable;
    if (figure == HF_FIGURE_FACETS) return hf_cloud_facet_points(objectives->n_facet);
    if (figure == HF_FIGURE_SURFACE) return m->n_inner_node;
    if (figure != HF_FIGURE_GAIN) return g->n_cable;
    return 2 * hf_gain_points(&objectives->beam[g - objectives->objective], objectives->n_facet);
}

/* ---- creation ---- */

#define LOSS_MOST_DB 3.0 /* loss at the target positions above which an objective of gain causes a warning */

/* Maximum number of residuals of all objectives: a table of them takes 1 GiB, and their indices are int. */
#define ROWS_MAX (1L << 27)

/* Gives objective g its rows and adds their number to *n_all. That number is a long: 3 000 nodes under 16 objectives
 * over 100 000 samples have more rows than an int holds. */
static void number_rows(hf_objectives *objectives, hf_objective *g, long *n_all)
{
    g->n_shape_row = row_count(objectives, g);
    *n_all += (long)g->n_shape_row * (g->n_net ? g->n_net : 1);
    if (*n_all > ROWS_MAX) return; /* hf_objectives_create refuses more rows */
    g->first_row = objectives->n_row;
    g->n_row = (int)*n_all - g->first_row;
    objectives->n_row = (int)*n_all;
}

static hf_status refuse_rows(const hf_objectives *objectives, const char *list, long n_all, hf_messages *messages)
{
    char where[HF_LOCATION_SIZE];
    int n_sample = 0;
    for (int k = 0; k < objectives->n_objective; k++)
        if (objectives->objective[k].settings.over == HF_OVER_SAMPLES) n_sample = objectives->objective[k].n_net;
    if (n_sample)
        hf_messages_location(messages, where, "optimize.samples");
    else
        hf_messages_location(messages, where, "optimize.%s", list);
    return hf_error(messages, HF_BAD_CASE,
                    "%s: the objectives have %ld residuals over all nets, but the maximum is %ld (1 GiB). Use fewer %s",
                    where, n_all, ROWS_MAX, n_sample ? "samples, or fewer objectives over samples" : "objectives");
}

/* Allocates the arrays. Each objective of a set has room for all cables. */
static hf_status allocate(const hf_model *m, hf_objectives *objectives)
{
    int *cable;
    size_t n = (size_t)objectives->n_objective, n_cable = (size_t)m->n_cable;
    HF_TRY(HF_ARENA_ARRAYS(&objectives->block, HF_ARRAY(cable, n * n_cable), HF_ARRAY(objectives->beam, n),
                           HF_ARRAY(objectives->corner_row, 4 * (size_t)objectives->n_facet)));
    for (size_t k = 0; k < n; k++)
        if (has_set(objectives->objective[k].settings.figure)) objectives->objective[k].cable = cable + k * n_cable;
    return HF_OK;
}

/* Sets the nets of an objective. The case has been checked, so the load case or the samples of the row exist. */
static void choose_nets(const hf_objectives_nets *nets, hf_objective *g)
{
    const hf_objective_settings *s = &g->settings;
    for (int k = 0; nets && *s->load_case && k < nets->n_load_case; k++)
        if (!strcmp(nets->load_case_name[k], s->load_case)) g->first_net = k, g->n_net = 1;
    if (nets && hf_objective_takes_load_cases(s)) g->n_net = nets->n_load_case;
    if (!nets || s->over != HF_OVER_SAMPLES) return;
    int state = 0, n_state = hf_objective_takes_load_cases(s) ? nets->n_sample_state : 1;
    for (int k = 1; k < nets->n_sample_state && *s->load_case && n_state == 1; k++)
        if (!strcmp(nets->load_case_name[nets->sample_load_case[k]], s->load_case)) state = k;
    g->first_net = nets->n_load_case + state * nets->n_sample;
    g->n_net = n_state * nets->n_sample;
}

/* Makes the beam of objective k, if it is a gain. Without a frequency in the row it uses the highest one of the
 * surface. */
static void make_beam(const hf_scene *scene, const hf_surface_settings *s, const hf_facets *facets,
                      hf_objectives *objectives, int k)
{
    double frequency_Hz = objectives->objective[k].settings.frequency_Hz;
    if (objectives->objective[k].settings.figure != HF_FIGURE_GAIN || !s || !s->has_pattern || !facets ||
        !facets->n_facet)
        return;
    if (!(frequency_Hz > 0)) frequency_Hz = hf_surface_highest_Hz(s);
    hf_gain_beam_make(s, facets, scene->position_m, frequency_Hz, &objectives->beam[k]);
}

/* Warns if the shape at the target positions has no beam whose gain objective k could raise. A paraboloid, for example,
 * focuses a plane wave along its axis. */
static void warn_of_no_beam(const hf_scene *scene, const hf_facets *facets, const hf_objectives *objectives, int k,
                            const char *where, hf_messages *messages)
{
    if (objectives->objective[k].settings.figure != HF_FIGURE_GAIN) return;
    double loss_dB =
        hf_gain_loss_dB(&objectives->beam[k], &(hf_pattern_surface){.facets = facets, .position_m = scene->position_m});
    if (loss_dB > LOSS_MOST_DB)
        hf_warning(messages,
                   "%s: gain: even at its target positions, the net loses %.3g dB in the direction of the beam, so "
                   "there is no beam that this objective could improve. Use another surface.pattern.feed (a paraboloid "
                   "focuses a plane wave, which gives no beam), a lower frequency or more facets",
                   where, loss_dB);
}

hf_status hf_objectives_create(const hf_scene *scene, const hf_model *m, const hf_optimize_settings *s,
                               const hf_surface_settings *surface, const hf_facets *facets,
                               const hf_objectives_nets *nets, hf_objectives *objectives, hf_messages *messages)
{
    int n_fault = 0;
    long n_all = 0;
    bool is_front = s->n_front > 0;
    *objectives = (hf_objectives){.model = m, .n_objective = is_front ? s->n_front : s->n_term > 0 ? s->n_term : 1};
    for (int k = 0; k < objectives->n_objective; k++) {
        objectives->objective[k].settings = is_front ? s->front[k] : s->n_term > 0 ? s->term[k] : psi_alone;
        if (is_front) objectives->objective[k].settings.weight = 1;
        if (is_of_facets(objectives->objective[k].settings.figure) && facets) objectives->n_facet = facets->n_facet;
        choose_nets(nets, &objectives->objective[k]);
        objectives->objective[k].takes_tail =
            objectives->objective[k].settings.quantile > 0 && s->method != HF_OPTIMIZE_GA;
        if (objectives->objective[k].n_net) objectives->nets = nets;
    }
    if (surface) {
        objectives->kind = surface->kind;
        objectives->focal_length_m = surface->focal_length_m;
    }
    if (allocate(m, objectives) != HF_OK) return hf_error(messages, HF_NO_MEMORY, "out of memory for the objectives");
    for (int i = 0; i < 4 * objectives->n_facet; i++)
        objectives->corner_row[i] = m->row_of_node[facets->corner[i]];
    const char *list = is_front ? "front" : "objective";
    for (int k = 0; k < objectives->n_objective; k++) {
        hf_objective *g = &objectives->objective[k];
        char where[HF_LOCATION_SIZE];
        hf_messages_location(messages, where, "optimize.%s.%d.set", list, k);
        make_beam(scene, surface, facets, objectives, k);
        if (g->cable) g->n_cable = hf_cable_pick_some(scene, g->settings.set, where, g->cable, messages);
        bool is_known = !g->cable || g->n_cable > 0;
        const char *fault = is_known ? fault_of(objectives, k, surface, facets) : NULL;
        hf_messages_location(messages, where, "optimize.%s.%d", list, k);
        if (fault) hf_error(messages, HF_BAD_CASE, "%s: %s: %s", where, hf_figure_kind_word[g->settings.figure], fault);
        if (!fault) warn_of_no_beam(scene, facets, objectives, k, where, messages);
        n_fault += !is_known || fault;
        number_rows(objectives, g, &n_all);
    }
    if (n_all > ROWS_MAX) return refuse_rows(objectives, list, n_all, messages);
    return n_fault ? HF_BAD_CASE : HF_OK;
}

const char *hf_objectives_name(const hf_objectives *objectives, int i_objective, char text[HF_OBJECTIVE_NAME_SIZE])
{
    const hf_objective_settings *s = &objectives->objective[i_objective].settings;
    int n = snprintf(text, HF_OBJECTIVE_NAME_SIZE, "objective_%d_%s%s%s", i_objective, hf_figure_kind_word[s->figure],
                     *s->set ? "_" : "", s->set);
    const char *of_many = s->quantile > 0 ? "quantile" : hf_take_word[s->take];
    if (*s->load_case && s->over == HF_OVER_SAMPLES)
        snprintf(text + n, HF_OBJECTIVE_NAME_SIZE - (size_t)n, "_%.24s_%s_%s", s->load_case, hf_over_word[s->over],
                 of_many);
    else if (hf_objective_takes_load_cases(s))
        snprintf(text + n, HF_OBJECTIVE_NAME_SIZE - (size_t)n, "_load_cases_%s", of_many);
    else if (*s->load_case) /* as much of the name as fits */
        snprintf(text + n, HF_OBJECTIVE_NAME_SIZE - (size_t)n, "_%.24s", s->load_case);
    else if (s->over != HF_OVER_DESIGN)
        snprintf(text + n, HF_OBJECTIVE_NAME_SIZE - (size_t)n, "_%s_%s", hf_over_word[s->over], of_many);
    return text;
}

void hf_objectives_free(hf_objectives *objectives)
{
    hf_arena_free_block(objectives->block);
    *objectives = (hf_objectives){0};
}
