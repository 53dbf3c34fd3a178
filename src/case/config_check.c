#include "case/config_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Returns true if exactly one section makes the net. Otherwise `what` describes the fault of the section scene. */
static bool one_section_makes_the_net(const hf_case *c, char what[HF_CONFIG_WHAT_SIZE])
{
    int n_present = 0;
    char present[256] = "", all[256] = "";
    const struct {
        const char *name;
        bool is_present;
    } source[] = {
#define SOURCE(section, type, KEYS) {#section, c->has_##section},
        HF_GENERATORS(SOURCE)
#undef SOURCE
            {"import", c->has_import}};
    for (size_t i = 0; i < sizeof source / sizeof *source; i++) {
        size_t n_all = strlen(all), n = strlen(present);
        snprintf(all + n_all, sizeof all - n_all, "%s%s", i ? " or " : "", source[i].name);
        if (source[i].is_present)
            snprintf(present + n, sizeof present - n, "%s%s", n_present++ ? " and " : "", source[i].name);
    }
    if (n_present)
        snprintf(what, HF_CONFIG_WHAT_SIZE, "has both %s; keep one", present);
    else
        snprintf(what, HF_CONFIG_WHAT_SIZE, "needs either %s", all);
    return n_present == 1;
}

hf_surface_settings hf_config_known_surface(const hf_case *c, const char **key)
{
    hf_surface_settings known = {0};
#define KNOW(section, type, KEYS)                                                                                      \
    if (c->has_##section) {                                                                                            \
        hf_scene_##section##_surface(&c->section, &known);                                                             \
        *key = "scene." #section ".focal_length_m";                                                                    \
    }
    HF_GENERATORS(KNOW)
#undef KNOW
    return known;
}

/* Reports a fault of a key on which other checks depend. */
static void refuse(hf_config_faults *f, const char *path, const char *what)
{
    hf_config_fault_of(f, path, what);
    hf_config_note_unread(f, path);
}

/* Reports settings from which a generator cannot make a net, as a fault of one of its keys. */
static void check_generators(const hf_case *c, hf_config_faults *f)
{
    char what[HF_GENERATE_FAULT_SIZE], path[128];
    const char *key;
#define CHECK(section, type, KEYS)                                                                                     \
    if (c->has_##section && (key = hf_scene_##section##_fault(&c->section, what, sizeof what)) != NULL) {              \
        snprintf(path, sizeof path, "scene.%s.%s", #section, key);                                                     \
        refuse(f, path, what);                                                                                         \
    }
    HF_GENERATORS(CHECK)
#undef CHECK
#define CHECK_TIES(section)                                                                                            \
    if (c->has_##section && c->section.rear_distance_m > 0 && c->section.tie_law == HF_LAW_ELASTIC &&                  \
        c->EA_N[HF_GROUP_INNER] == 0)                                                                                  \
        hf_config_fault_of(f, "scene." #section ".tie_law",                                                            \
                           "elastic needs scene.EA_inner_N, the stiffness of the ties");
    CHECK_TIES(parabolic_cylinder)
    CHECK_TIES(paraboloid)
#undef CHECK_TIES
}

/* Returns true if the section of this key exists. Sections that cannot be omitted always exist. */
static bool has_section_of(const hf_case *c, const char *key)
{
    const char *dot = strrchr(key, '.');
    for (int i = 0; dot && i < hf_n_section; i++) {
        const hf_section *s = &hf_section_table[i];
        if (s->present_offset != SIZE_MAX && strlen(s->path) == (size_t)(dot - key) &&
            !strncmp(s->path, key, (size_t)(dot - key)))
            return *(const bool *)((const char *)c + s->present_offset);
    }
    return true;
}

/* Lower bound of a frequency, a wavelength of 300 m. A number in GHz or MHz without its exponent is far below it. */
#define LEAST_HZ 1e6

const char *hf_config_frequency_fault(double frequency_Hz, char what[HF_CONFIG_WHAT_SIZE])
{
    if (!(frequency_Hz > 0 && frequency_Hz < LEAST_HZ)) return NULL; /* 0 or NaN: not given */
    snprintf(what, HF_CONFIG_WHAT_SIZE,
             "is %g Hz, and below 1 MHz there are no reflectors: was GHz meant? 6 GHz is 6e9", frequency_Hz);
    return what;
}

double hf_config_highest_Hz(const hf_case *c)
{
    double highest_Hz = (double)NAN;
    for (int k = 0; k < c->surface.frequencies_Hz.n; k++)
        highest_Hz = fmax(highest_Hz, c->surface.frequencies_Hz.value[k]); /* fmax ignores NaN */
    return highest_Hz;
}

static void check_frequencies(const hf_double_list *frequency_Hz, hf_config_faults *f)
{
    char what[HF_CONFIG_WHAT_SIZE];
    int i = 0;
    while (i < frequency_Hz->n && !hf_config_frequency_fault(frequency_Hz->value[i], what))
        i++;
    if (i < frequency_Hz->n) hf_config_fault_of(f, "surface.frequencies_Hz", what);
}

static void check_pattern(const hf_case *c, hf_config_faults *f)
{
    static const char *const of_feed[] = {"surface.pattern.feed.position_m", "surface.pattern.feed.aim_m",
                                          "surface.pattern.feed.cos_power"};
    const hf_pattern_settings *p = &c->surface.pattern;
    const char *given = "surface.pattern"; /* the section itself has no line, but its keys have one */
    for (int i = hf_n_field - 1; i >= 0; i--)
        if (!strncmp(hf_field_table[i].path, "surface.pattern.", 16) && *hf_config_where(f, i))
            given = hf_field_table[i].path;
    if (c->surface.frequencies_Hz.n == 0)
        hf_config_fault_of(f, given, "needs surface.frequencies_Hz: at which frequencies is the far field wanted?");
    if (isinf(p->theta_deg[0]) || isinf(p->theta_deg[1]))
        hf_config_fault_of(f, "surface.pattern.theta_deg", "must have both ends, like [-5, 5]");
    if (p->phi_deg.n < 1 || p->phi_deg.n > HF_PATTERN_CUTS)
        hf_config_fault_of(f, "surface.pattern.phi_deg", "must have 1 to 8 cuts");
    for (size_t k = 0; k < sizeof of_feed / sizeof *of_feed && p->feed == HF_FEED_PLANE_WAVE; k++)
        if (hf_config_is_given(f, of_feed[k]))
            hf_config_fault_of(f, of_feed[k], "has no meaning for a plane_wave, which comes along -z; remove it");
}

/* Reports keys of a generated truss that have no effect on an imported truss or a ring truss. */
static void check_unused(const hf_case *c, hf_config_faults *f)
{
    static const char *const of_units[] = {"truss.depth_m", "truss.main_every", "truss.supports"};
    for (int i = 0; i < hf_n_field; i++) {
        const char *path = hf_field_table[i].path;
        bool is_of_units =
            !strncmp(path, "truss.bud.", 10) || !strncmp(path, "truss.mbug.", 11) || !strncmp(path, "truss.abug.", 11);
        if (strncmp(path, "truss.", 6) || !strncmp(path, "truss.import.", 13) || !*hf_config_where(f, i)) continue;
        for (size_t k = 0; k < sizeof of_units / sizeof *of_units; k++)
            is_of_units |= !strcmp(path, of_units[k]);
        if (c->has_truss_import && strcmp(path, "truss.match_tolerance_m") != 0)
            hf_config_fault_of(f, path, "has no effect beside truss.import, which brings all members; remove it");
        else if (c->has_truss_ring && is_of_units)
            hf_config_fault_of(f, path, "has no effect beside truss.ring, which has no units; remove it");
    }
}

static void check_wall(hf_config_faults *f, const char *key, double diameter_m, double wall_m)
{
    if (2 * wall_m > diameter_m) hf_config_fault_of(f, key, "must not be more than half the diameter_m beside it");
}

static void check_ring(const hf_case *c, hf_config_faults *f)
{
    char what[HF_GENERATE_FAULT_SIZE], path[128];
    const hf_truss_ring *ring = &c->truss.ring;
    if (!c->has_paraboloid) {
        hf_config_fault_of(f, "truss.ring", "needs scene.paraboloid, under whose rim it stands");
        return;
    }
    const char *key = hf_truss_ring_fault(&c->truss, &c->paraboloid, what, sizeof what);
    snprintf(path, sizeof path, "truss.ring.%s", key ? key : "");
    if (key) hf_config_fault_of(f, path, what);
    check_wall(f, "truss.ring.longeron.wall_m", ring->longeron.diameter_m, ring->longeron.wall_m);
    check_wall(f, "truss.ring.vertical.wall_m", ring->vertical.diameter_m, ring->vertical.wall_m);
    check_wall(f, "truss.ring.diagonal.wall_m", ring->diagonal.diameter_m, ring->diagonal.wall_m);
}

static void check_units(const hf_case *c, hf_config_faults *f)
{
    if (c->has_paraboloid)
        hf_config_fault_of(f, "truss", "needs a section ring to stand on under scene.paraboloid, or truss.import");
    else if (!c->has_parabolic_cylinder)
        hf_config_fault_of(f, "truss", "needs scene.parabolic_cylinder to be generated over, or truss.import");
    else if (c->parabolic_cylinder.rear_distance_m > 0)
        hf_config_fault_of(f, "scene.parabolic_cylinder.rear_distance_m",
                           "the truss over the modules has no joints where the supports of the rear net are; leave the "
                           "truss out, or bring one by truss.import");
    check_wall(f, "truss.bud.wall_m", c->truss.bud.diameter_m, c->truss.bud.wall_m);
    check_wall(f, "truss.mbug.wall_m", c->truss.mbug.diameter_m, c->truss.mbug.wall_m);
    check_wall(f, "truss.abug.wall_m", c->truss.abug.diameter_m, c->truss.abug.wall_m);
}

static void check_truss(const hf_case *c, hf_config_faults *f)
{
    check_unused(c, f);
    if (c->has_truss_import && c->has_truss_ring)
        hf_config_fault_of(f, "truss", "has both ring and import; keep one");
    else if (c->has_truss_ring)
        check_ring(c, f);
    else if (!c->has_truss_import)
        check_units(c, f);
}

/* ---- rows of lists ---- */

static void check_rows_are_whole(const hf_case *c, hf_config_faults *f)
{
    for (const hf_list *list = hf_list_table; list < hf_list_table + hf_n_list + HF_OLD_LISTS; list++)
        for (int row = 0; row < hf_key_n_row(c, list); row++) {
            if (!*hf_config_where(f, hf_key_of_row(list, row, -1).i_location)) continue; /* the item was no row */
            for (int i = 0; i < list->n_field; i++) {
                const hf_key key = hf_key_of_row(list, row, i);
                if (!key.field->default_value && !*hf_config_where(f, key.i_location))
                    refuse(f, key.path, "is missing and has no default");
            }
        }
}

void hf_config_check_use(hf_config_faults *f, const char *list, int row, const char *key, int kind,
                         const char *const *kind_word, unsigned users)
{
    char path[HF_KEY_SIZE], what[HF_CONFIG_WHAT_SIZE];
    snprintf(path, sizeof path, "%s.%d.%s", list, row, key);
    if (users & 1u << kind || !hf_config_is_given(f, path)) return;
    int used = snprintf(what, sizeof what, "has no meaning for %s, only for", kind_word[kind]), n = 0;
    for (int k = 0; kind_word[k]; k++)
        if (users & 1u << k)
            used += snprintf(what + used, sizeof what - (size_t)used, "%s %s", n++ ? "," : "", kind_word[k]);
    hf_config_fault_of(f, path, what);
}

static void check_variables(const hf_optimize_settings *o, hf_config_faults *f)
{
    static const char list[] = "optimize.variables";
    static const char *const of_default[] = {"optimize.range_N", "optimize.min_tension_N", "optimize.max_tension_N"};
    for (int i = 0; i < o->n_variable_row; i++) {
        const hf_variable_settings *v = &o->variable_row[i];
        bool has_bounds = !isinf(v->lower) || !isinf(v->upper);
        hf_config_check_set(f, list, i, v->set);
        if (isnan(v->range) && isnan(v->range_ratio) && !has_bounds)
            hf_config_fault_in_row(f, list, i, "range", "is missing; give range, bounds or both");
        if (!isnan(v->range_ratio) && v->vary >= HF_VARY_SUPPORT_Z)
            hf_config_fault_in_row(f, list, i, "range",
                                   "must be in m: the place of a support has no size to take a part of");
        if (v->link == HF_LINK_SYMMETRY && o->symmetry == HF_SYMMETRY_NONE)
            hf_config_fault_in_row(f, list, i, "link", "symmetry needs optimize.symmetry, which is none");
        if (v->link == HF_LINK_SCALE && v->vary >= HF_VARY_SUPPORT_Z)
            hf_config_fault_in_row(f, list, i, "link", "scale needs values above 0, which displacements do not have");
        if (v->link == HF_LINK_SYMMETRY && v->vary == HF_VARY_SUPPORT_XYZ)
            hf_config_fault_in_row(f, list, i, "link",
                                   "cannot be symmetry with support_xyz: mirrored supports move apart along x or y");
    }
    if (o->n_variable_row == 0) return;
    for (size_t k = 0; k < sizeof of_default / sizeof *of_default; k++)
        if (hf_config_is_given(f, of_default[k]))
            hf_config_fault_of(
                f, of_default[k],
                "is of the default variables alone; with optimize.variables give range and bounds there");
    if (o->rule == HF_RULE_SEEDED)
        hf_config_fault_of(f, "optimize.rule", "cannot be seeded with optimize.variables; remove one of them");
}

/* Checks the rows of optimize.objective or optimize.front. */
static void check_objectives(const char *list, int n_objective, const hf_objective_settings *objective,
                             hf_config_faults *f)
{
    enum {
        SETS = 1u << HF_FIGURE_TENSION | 1u << HF_FIGURE_LENGTH | 1u << HF_FIGURE_EVENNESS | 1u << HF_FIGURE_MASS |
               1u << HF_FIGURE_RATIO,
        SURFACES = 1u << HF_FIGURE_SURFACE | 1u << HF_FIGURE_FACETS
    };
    static const struct {
        const char *key;
        unsigned users;
    } use[] = {{"set", SETS},
               {"target", 1u << HF_FIGURE_TENSION | 1u << HF_FIGURE_LENGTH},
               {"mass_kg_per_m", 1u << HF_FIGURE_MASS},
               {"along", SURFACES},
               {"feed", SURFACES},
               {"frequency_Hz", 1u << HF_FIGURE_GAIN}};
    char what[HF_CONFIG_WHAT_SIZE];
    for (int i = 0; i < n_objective; i++) {
        const hf_objective_settings *g = &objective[i];
        for (size_t k = 0; k < sizeof use / sizeof *use; k++)
            hf_config_check_use(f, list, i, use[k].key, (int)g->figure, hf_figure_kind_word, use[k].users);
        hf_config_check_set(f, list, i, g->set);
        if (g->figure == HF_FIGURE_TENSION && isnan(g->target))
            hf_config_fault_in_row(f, list, i, "target", "is missing: the tension that is wanted, in N");
        if (g->figure == HF_FIGURE_LENGTH && g->target <= 0)
            hf_config_fault_in_row(f, list, i, "target", "of length must be above 0");
        if (g->figure == HF_FIGURE_MASS && isnan(g->mass_kg_per_m))
            hf_config_fault_in_row(f, list, i, "mass_kg_per_m", "is missing: the mass of the cables");
        if (g->figure == HF_FIGURE_GAIN && hf_config_frequency_fault(g->frequency_Hz, what))
            hf_config_fault_in_row(f, list, i, "frequency_Hz", what);
    }
}

/* Reports keys of the genetic algorithm that have no meaning for a Pareto front. */
static void check_use_of_front(const hf_optimize_settings *o, hf_config_faults *f)
{
    static const char *const without[] = {"optimize.elites", "optimize.crossover_low", "optimize.mutation_low"};
    for (size_t k = 0; k < sizeof without / sizeof *without; k++)
        if (hf_config_is_given(f, without[k]))
            hf_config_fault_of(f, without[k], "has no meaning for optimize.front; remove it");
    if (o->variation == HF_VARIATION_CHAIN)
        hf_config_fault_of(f, "optimize.variation",
                           "cannot be chain with optimize.front, whose children move along differences; remove it");
}

static void check_front(const hf_optimize_settings *o, hf_config_faults *f)
{
    static const char list[] = "optimize.front";
    check_objectives(list, o->n_front, o->front, f);
    if (o->n_front == 1)
        hf_config_fault_of(f, "optimize.front.0",
                           "is the only row; a front is of two or three objectives. For one use optimize.objective");
    if (o->n_front > 0 && o->n_term > 0)
        hf_config_fault_of(f, "optimize.objective.0",
                           "cannot be with optimize.front, which replaces the objective; keep one of them");
    if (o->n_front > 2 && o->front_points < 4)
        hf_config_fault_of(f, "optimize.front_points", "must be at least 4 with three objectives, for the ends alone");
    if (o->n_front > 1 && o->refine == HF_REFINE_TRUE)
        hf_config_fault_of(f, "optimize.refine", "compares one design; it has no meaning for optimize.front");
    if (o->n_front > 1) check_use_of_front(o, f);
    for (int i = 1; i < o->n_front; i++)
        for (int k = 0; k < i; k++)
            if (!memcmp(&o->front[i], &o->front[k], sizeof o->front[i]))
                hf_config_fault_in_row(f, list, i, "figure",
                                       "is the objective of an earlier row; a front needs different ones");
}

static void check_limits(const hf_optimize_settings *o, hf_config_faults *f)
{
    static const char list[] = "optimize.limits";
    for (int i = 0; i < o->n_limit; i++) {
        const hf_limit_settings *l = &o->limit[i];
        hf_config_check_use(f, list, i, "set", (int)l->figure, hf_limit_word,
                            1u << HF_LIMIT_TENSION | 1u << HF_LIMIT_RATIO);
        hf_config_check_set(f, list, i, l->set);
        double least = l->figure == HF_LIMIT_RATIO ? 1 : 0; /* smallest possible value */
        if (l->figure != HF_LIMIT_TENSION && (l->lower > least || l->upper <= least || isinf(l->upper)))
            hf_config_fault_in_row(f, list, i, "bounds",
                                   l->figure == HF_LIMIT_RATIO
                                       ? "must end above 1, and not begin above it: even tensions have 1"
                                       : "must end above 0, and not begin above it");
    }
}

void hf_config_check(const hf_case *c, hf_config_faults *f)
{
    const hf_optimize_settings *o = &c->optimize;
    const char *key;
    char what[HF_CONFIG_WHAT_SIZE];
    if (!one_section_makes_the_net(c, what)) refuse(f, "scene", what);
    for (int i = 0; i < hf_n_field; i++)
        if (!hf_field_table[i].default_value && has_section_of(c, hf_field_table[i].path) && !*hf_config_where(f, i))
            refuse(f, hf_field_table[i].path, "is missing and has no default");
    check_rows_are_whole(c, f);
    bool has_scene = hf_config_is_read(c, "scene"), has_surface = c->has_surface && hf_config_is_read(c, "surface");
    if (has_scene && has_surface && c->surface.focal_length_m == 0 &&
        hf_config_known_surface(c, &key).focal_length_m == 0)
        hf_config_fault_of(f, "surface.focal_length_m",
                           c->has_import ? "is missing: an imported net does not tell its surface"
                                         : "is missing: this net does not tell its surface");
    if (has_surface) check_frequencies(&c->surface.frequencies_Hz, f);
    if (c->surface.has_pattern && hf_config_is_read(c, "surface")) check_pattern(c, f);
    if (has_scene) check_generators(c, f);
    if ((c->has_truss || c->has_truss_import || c->has_truss_ring) && hf_config_is_read(c, "truss") &&
        hf_config_is_read(c, "scene"))
        check_truss(c, f);
    hf_config_check_built(c, f);
    hf_config_check_requirements(c, f);
    if (!c->has_optimize || !hf_config_is_read(c, "optimize")) return; /* rejected values are not compared */
    if (o->min_tension_N >= o->max_tension_N)
        hf_config_fault_of(f, "optimize.min_tension_N", "must be below optimize.max_tension_N");
    if (o->refine == HF_REFINE_TRUE && o->rule == HF_RULE_SEEDED)
        hf_config_fault_of(
            f, "optimize.refine",
            "cannot be true with optimize.rule seeded, under which Levenberg-Marquardt has no derivatives");
    if (o->solver == HF_SOLVER_CHORD && c->form.factor == HF_FACTOR_LAPACK)
        hf_config_fault_of(f, "optimize.solver",
                           "chord shares one factor among designs, which form.factor: lapack does not; use newton, "
                           "fixed_point or auto");
    if (o->elites >= o->population) hf_config_fault_of(f, "optimize.elites", "must be below optimize.population");
    if (o->crossover_low > o->crossover_high)
        hf_config_fault_of(f, "optimize.crossover_low", "must not be above optimize.crossover_high");
    if (o->mutation_low > o->mutation_high)
        hf_config_fault_of(f, "optimize.mutation_low", "must not be above optimize.mutation_high");
    check_variables(o, f);
    check_objectives("optimize.objective", o->n_term, o->term, f);
    check_front(o, f);
    check_limits(o, f);
    hf_config_check_nets(c, "optimize.objective", o->n_term, o->term, f);
    hf_config_check_nets(c, "optimize.front", o->n_front, o->front, f);
}

void hf_config_complete(hf_case *c)
{
    c->has_truss |= c->has_truss_import || c->has_truss_ring;
    hf_config_complete_requirements(c);
    if (!c->has_surface) return;
    const char *key;
    hf_surface_settings known = hf_config_known_surface(c, &key);
    if (c->surface.kind == HF_SURFACE_AUTO) c->surface.kind = known.kind;
    if (c->surface.focal_length_m == 0) c->surface.focal_length_m = known.focal_length_m;
    if (c->surface.strip_width_m == 0) c->surface.strip_width_m = known.strip_width_m;
}
