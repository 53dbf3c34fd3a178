/* The tables of config.h: every key of a case file with its default. The rows of generators are beside their settings,
 * in generate.h and truss.h. No other file contains defaults. */
#include "case/config_rename.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define AT(member) offsetof(hf_case, member)
#define BIG 1e300

const hf_section hf_section_table[] = {
    {"scene", SIZE_MAX},
#define SECTION(section, type, KEYS) {"scene." #section, AT(has_##section)},
    HF_GENERATORS(SECTION)
#undef SECTION
        {"scene.import", AT(has_import)},
    {"surface", AT(has_surface)},
    {"surface.pattern", AT(surface.has_pattern)},
    {"surface.pattern.feed", AT(surface.has_pattern)},
    {"form", SIZE_MAX},
    {"optimize", AT(has_optimize)},
    {"tolerance", AT(has_tolerance)},
    {"truss", AT(has_truss)},
    {"truss.bud", AT(has_truss)},
    {"truss.mbug", AT(has_truss)},
    {"truss.abug", AT(has_truss)},
    {"truss.ring", AT(has_truss_ring)},
    {"truss.ring.longeron", AT(has_truss_ring)},
    {"truss.ring.vertical", AT(has_truss_ring)},
    {"truss.ring.diagonal", AT(has_truss_ring)},
    {"truss.import", AT(has_truss_import)},
    {"coupling", SIZE_MAX},
    {"adjust", AT(has_adjust)},
    {"sweep", AT(has_sweep)},
};
const int hf_n_section = sizeof hf_section_table / sizeof *hf_section_table;

const hf_field hf_field_table[] = {
    {"title", HF_FIELD_TEXT, AT(title), 0, sizeof((hf_case *)0)->title, "", "", NULL},

    {"scene.EA_inner_N", HF_FIELD_DOUBLE, AT(EA_N[0]), HF_ABOVE_ZERO, 1e15, "", "N", NULL},
    {"scene.EA_boundary_N", HF_FIELD_DOUBLE, AT(EA_N[1]), HF_ABOVE_ZERO, 1e15, "", "N", NULL},

#define FIELD(section, member, type, ...) {"scene." #section "." #member, type, AT(section.member), __VA_ARGS__},
#define FIELDS(section, type, KEYS) KEYS(FIELD, section)
    HF_GENERATORS(FIELDS)
#undef FIELDS
#undef FIELD

        {"scene.import.nodes", HF_FIELD_TEXT, AT(nodes_path), 1, HF_PATH_SIZE, NULL, "", NULL},
    {"scene.import.cables", HF_FIELD_TEXT, AT(cables_path), 1, HF_PATH_SIZE, NULL, "", NULL},

    {"scene.import.facets", HF_FIELD_TEXT, AT(facets_path), 1, HF_PATH_SIZE, "", "", NULL},

    {"surface.kind", HF_FIELD_WORD, AT(surface.kind), 0, 0, "auto", "", hf_surface_kind_word},
    {"surface.focal_length_m", HF_FIELD_DOUBLE, AT(surface.focal_length_m), HF_ABOVE_ZERO, 1e9, "", "m", NULL},
    {"surface.strip_width_m", HF_FIELD_DOUBLE, AT(surface.strip_width_m), HF_ABOVE_ZERO, 1e4, "", "m", NULL},
    {"surface.mesh_tension_N_per_m", HF_FIELD_DOUBLE, AT(surface.mesh_tension_N_per_m), 0, 1e6, "0", "N/m", NULL},
    {"surface.frequencies_Hz", HF_FIELD_DOUBLE_LIST, AT(surface.frequencies_Hz), HF_ABOVE_ZERO, 1e15, "[]", "Hz", NULL},

    {"surface.pattern.theta_deg", HF_FIELD_BOUNDS, AT(surface.pattern.theta_deg), -180, 180, "[-5, 5]", "deg", NULL},
    {"surface.pattern.n_theta", HF_FIELD_INT, AT(surface.pattern.n_theta), 2, 4001, "721", "", NULL},
    {"surface.pattern.phi_deg", HF_FIELD_DOUBLE_LIST, AT(surface.pattern.phi_deg), -360, 360, "[0, 90]", "deg", NULL},
    {"surface.pattern.feed.kind", HF_FIELD_WORD, AT(surface.pattern.feed), 0, 0, "auto", "", hf_feed_word},
    {"surface.pattern.feed.position_m", HF_FIELD_VECTOR, AT(surface.pattern.position_m), -1e9, 1e9, "", "m", NULL},
    {"surface.pattern.feed.aim_m", HF_FIELD_VECTOR, AT(surface.pattern.aim_m), -1e9, 1e9, "", "m", NULL},
    {"surface.pattern.feed.cos_power", HF_FIELD_DOUBLE, AT(surface.pattern.cos_power), 0, 1e4, "", "", NULL},
    {"surface.pattern.feed.polarisation", HF_FIELD_WORD, AT(surface.pattern.polarisation), 0, 0, "x", "",
     HF_WORDS("x", "y")},

    {"form.method", HF_FIELD_WORD, AT(form.method), 0, 0, "auto", "", hf_method_word},
    {"form.pretension_N", HF_FIELD_DOUBLE, AT(form.pretension_N), HF_ABOVE_ZERO, 1e9, "10", "N", NULL},
    {"form.prestress", HF_FIELD_WORD, AT(form.prestress), 0, 0, "given", "", HF_WORDS("given", "exact")},
    {"form.stop", HF_FIELD_WORD, AT(form.stop), 0, 0, "residual", "", hf_stop_rule_word},
    {"form.residual_tolerance", HF_FIELD_DOUBLE, AT(form.residual_tolerance), 1e-13, 1, "1e-7", "", NULL},
    {"form.length_tolerance", HF_FIELD_DOUBLE, AT(form.length_tolerance), 1e-13, 1, "1e-7", "", NULL},
    {"form.rms_tolerance_m", HF_FIELD_DOUBLE, AT(form.rms_tolerance_m), HF_ABOVE_ZERO, BIG, "1e-6", "m", NULL},
    {"form.max_iterations", HF_FIELD_INT, AT(form.max_iterations), 1, 10000000, "100000", "", NULL},
    {"form.collapse_ratio", HF_FIELD_DOUBLE, AT(form.collapse_ratio), 1e-12, 0.5, "1e-3", "", NULL},
    {"form.factor", HF_FIELD_WORD, AT(form.factor), 0, 0, "own", "", HF_WORDS("own", "lapack")},

    {"coupling.tof_m", HF_FIELD_DOUBLE, AT(form.coupling.tof_m), HF_ABOVE_ZERO, BIG, "1e-8", "m", NULL},
    {"coupling.scheme", HF_FIELD_WORD, AT(form.coupling.scheme), 0, 0, "auto", "", hf_coupling_scheme_word},
    {"coupling.max_iterations", HF_FIELD_INT, AT(form.coupling.max_iterations), 1, 1000000, "200", "", NULL},

    {"adjust.set", HF_FIELD_SET, AT(adjust.set), 1, HF_SET_NAME_SIZE, NULL, "", NULL},
    {"adjust.range_m", HF_FIELD_DOUBLE, AT(adjust.range_m), HF_ABOVE_ZERO, 1e3, NULL, "m", NULL},
    {"adjust.step_m", HF_FIELD_DOUBLE, AT(adjust.step_m), HF_ABOVE_ZERO, 1e3, NULL, "m", NULL},
    {"adjust.max_adjustments", HF_FIELD_INT, AT(adjust.max_adjustments), 1, 1000000, "10", "", NULL},
    {"adjust.target_m", HF_FIELD_DOUBLE, AT(adjust.target_m), 0, BIG, "0", "m", NULL},
    {"adjust.figure", HF_FIELD_WORD, AT(adjust.figure), 0, 0, "psi", "", hf_adjust_figure_word},
    {"adjust.aim", HF_FIELD_WORD, AT(adjust.aim), 0, 0, "design", "", hf_aim_word},
    {"adjust.sigma_m", HF_FIELD_DOUBLE, AT(adjust.sigma_m), HF_ABOVE_ZERO, BIG, "", "m", NULL},

    {"optimize.method", HF_FIELD_WORD, AT(optimize.method), 0, 0, "ga", "", hf_optimize_method_word},
    {"optimize.refine", HF_FIELD_WORD, AT(optimize.refine), 0, 0, "auto", "", HF_WORDS("auto", "true", "false")},
    {"optimize.rule", HF_FIELD_WORD, AT(optimize.rule), 0, 0, "force_density", "", hf_rule_word},
    {"optimize.symmetry", HF_FIELD_WORD, AT(optimize.symmetry), 0, 0, "none", "", hf_symmetry_word},
    {"optimize.solver", HF_FIELD_WORD, AT(optimize.solver), 0, 0, "auto", "", hf_solver_word},
    {"optimize.population", HF_FIELD_INT, AT(optimize.population), 2, 100000, "50", "", NULL},
    {"optimize.generations", HF_FIELD_INT, AT(optimize.generations), 1, 1000000, "400", "", NULL},
    {"optimize.range_N", HF_FIELD_DOUBLE, AT(optimize.range_N), HF_ABOVE_ZERO, 1e9, "1", "N", NULL},
    {"optimize.min_tension_N", HF_FIELD_DOUBLE, AT(optimize.min_tension_N), HF_ABOVE_ZERO, 1e9, "0.1", "N", NULL},
    {"optimize.max_tension_N", HF_FIELD_DOUBLE, AT(optimize.max_tension_N), HF_ABOVE_ZERO, BIG, "1e6", "N", NULL},
    {"optimize.boundary_ratio_cap", HF_FIELD_DOUBLE, AT(optimize.boundary_ratio_cap), 1, BIG, "10", "", NULL},
    {"optimize.seed", HF_FIELD_UINT64, AT(optimize.seed), 0, 18446744073709551615.0, "1", "", NULL},
    {"optimize.crossover_high", HF_FIELD_DOUBLE, AT(optimize.crossover_high), 0, 1, "0.9", "", NULL},
    {"optimize.crossover_low", HF_FIELD_DOUBLE, AT(optimize.crossover_low), 0, 1, "0.6", "", NULL},
    {"optimize.mutation_high", HF_FIELD_DOUBLE, AT(optimize.mutation_high), 0, 1, "0.1", "", NULL},
    {"optimize.mutation_low", HF_FIELD_DOUBLE, AT(optimize.mutation_low), 0, 1, "0.001", "", NULL},
    {"optimize.variation", HF_FIELD_WORD, AT(optimize.variation), 0, 0, "difference", "",
     HF_WORDS("difference", "chain")},
    {"optimize.elites", HF_FIELD_INT, AT(optimize.elites), 1, 100000, "1", "", NULL},
    {"optimize.stagnation_tolerance_m", HF_FIELD_DOUBLE, AT(optimize.stagnation_tolerance_m), 0, BIG, "1e-6", "m",
     NULL},
    {"optimize.stagnation_generations", HF_FIELD_INT, AT(optimize.stagnation_generations), 1, 1000000, "50", "", NULL},
    {"optimize.store", HF_FIELD_WORD, AT(optimize.store), 0, 0, "all", "", hf_keep_word},
    {"optimize.store_every", HF_FIELD_INT, AT(optimize.store_every), 2, 1000000, "100", "", NULL},
    {"optimize.refine_steps", HF_FIELD_INT, AT(optimize.refine_steps), 1, 100000, "200", "", NULL},
    {"optimize.samples", HF_FIELD_INT, AT(optimize.samples), 2, 100000, "64", "", NULL},
    {"optimize.front_points", HF_FIELD_INT, AT(optimize.front_points), 3, HF_FRONT_POINTS_MAX, "21", "", NULL},

    {"tolerance.sigma_cut_m", HF_FIELD_DOUBLE, AT(tolerance.sigma_cut_m), 0, 1, "0", "m", NULL},
    {"tolerance.sigma_cut_ratio", HF_FIELD_DOUBLE, AT(tolerance.sigma_cut_ratio), 0, 0.05, "0", "", NULL},
    {"tolerance.sigma_EA_ratio", HF_FIELD_DOUBLE, AT(tolerance.sigma_EA_ratio), 0, 0.05, "0", "", NULL},
    {"tolerance.sigma_support_m", HF_FIELD_DOUBLE, AT(tolerance.sigma_support_m), 0, 1, "0", "m", NULL},
    {"tolerance.sigma_temperature_K", HF_FIELD_DOUBLE, AT(tolerance.sigma_temperature_K), 0, 1000, "0", "K", NULL},
    {"tolerance.sigma_load_case_temperature_K", HF_FIELD_DOUBLE, AT(tolerance.sigma_load_case_temperature_K), 0, 1000,
     "0", "K", NULL},
    {"tolerance.sigma_gravity_ratio", HF_FIELD_DOUBLE, AT(tolerance.sigma_gravity_ratio), 0, 1, "0", "", NULL},
    {"tolerance.sigma_force_ratio", HF_FIELD_DOUBLE, AT(tolerance.sigma_force_ratio), 0, 1, "0", "", NULL},
    {"tolerance.distribution", HF_FIELD_WORD, AT(tolerance.distribution), 0, 0, "normal", "", hf_distribution_word},
    {"tolerance.batch", HF_FIELD_DOUBLE, AT(tolerance.batch), 0, 1, "0", "", NULL},
    {"tolerance.samples", HF_FIELD_INT, AT(tolerance.samples), 10, 100000000, "1000", "", NULL},
    {"tolerance.seed", HF_FIELD_UINT64, AT(tolerance.seed), 0, 18446744073709551615.0, "1", "", NULL},
    {"tolerance.sampling", HF_FIELD_WORD, AT(tolerance.sampling), 0, 0, "random", "", hf_sampling_word},
    {"tolerance.find_scale", HF_FIELD_WORD, AT(tolerance.find_scale), 0, 0, "false", "", HF_WORDS("false", "true")},

#define FIELD(section, member, type, ...) {"truss." #member, type, AT(section.member), __VA_ARGS__},
    HF_TRUSS_KEYS(FIELD, truss)
#undef FIELD
        {"truss.match_tolerance_m", HF_FIELD_DOUBLE, AT(truss.match_tolerance_m), 0, 1e3, "1e-6", "m", NULL},

#define FIELD(section, member, type, ...) {"truss." #section "." #member, type, AT(truss.section.member), __VA_ARGS__},
#define UNIT(section, diameter, panels) HF_TRUSS_UNIT_KEYS(FIELD, section, diameter, panels)
    UNIT(bud, "0.03", "2") UNIT(mbug, "0.03", "1") UNIT(abug, "0.025", "1")
#undef UNIT

        HF_RING_KEYS(FIELD, ring)
#undef FIELD
#define FIELD(section, member, type, ...)                                                                              \
    {"truss.ring." #section "." #member, type, AT(truss.ring.section.member), __VA_ARGS__},
            HF_TUBE_KEYS(FIELD, longeron, "0.03") HF_TUBE_KEYS(FIELD, vertical, "0.03")
                HF_TUBE_KEYS(FIELD, diagonal, "0.02")
#undef FIELD

                    {"truss.import.nodes", HF_FIELD_TEXT, AT(truss_nodes_path), 1, HF_PATH_SIZE, NULL, "", NULL},
    {"truss.import.members", HF_FIELD_TEXT, AT(truss_members_path), 1, HF_PATH_SIZE, NULL, "", NULL},

    /* The HF_OLD_FIELDS old keys. */
    {"tolerance.required_yield", HF_FIELD_DOUBLE, AT(tolerance.required_yield), 0, 0.9999, "0", "", NULL},
    {"tolerance.yield", HF_FIELD_DOUBLE, AT(tolerance.required_yield), 0, 0.9999, "0", "", NULL},
};
const int hf_n_field = sizeof hf_field_table / sizeof *hf_field_table - HF_OLD_FIELDS;

/* ---- lists of rows ---- */

#define IN(row, member) offsetof(hf_##row##_settings, member)

_Static_assert(IN(variable, range_ratio) == IN(variable, range) + sizeof(double) &&
                   IN(variable, upper) == IN(variable, lower) + sizeof(double),
               "a range is an amount, bounds are bounds");
static const hf_field variable_field[] = {
    {"set", HF_FIELD_SET, IN(variable, set), 1, HF_SET_NAME_SIZE, NULL, "", NULL},
    {"vary", HF_FIELD_WORD, IN(variable, vary), 0, 0, NULL, "", hf_vary_word},
    {"range", HF_FIELD_AMOUNT, IN(variable, range), HF_ABOVE_ZERO, BIG, "", "", NULL},
    {"bounds", HF_FIELD_BOUNDS, IN(variable, lower), -BIG, BIG, "", "", NULL},
    {"link", HF_FIELD_WORD, IN(variable, link), 0, 0, "each", "", HF_WORDS("each", "set", "symmetry", "scale")},
};

static const hf_field objective_field[] = {
    {"figure", HF_FIELD_WORD, IN(objective, figure), 0, 0, NULL, "", hf_figure_kind_word},
    {"set", HF_FIELD_SET, IN(objective, set), 1, HF_SET_NAME_SIZE, "", "", NULL},
    {"target", HF_FIELD_DOUBLE, IN(objective, target), -BIG, BIG, "", "", NULL},
    {"mass_kg_per_m", HF_FIELD_DOUBLE, IN(objective, mass_kg_per_m), HF_ABOVE_ZERO, BIG, "", "kg/m", NULL},
    {"along", HF_FIELD_WORD, IN(objective, along), 0, 0, "normal", "", HF_WORDS("normal", "half_path")},
    {"feed", HF_FIELD_WORD, IN(objective, feed), 0, 0, "fixed", "", hf_focus_word},
    {"frequency_Hz", HF_FIELD_DOUBLE, IN(objective, frequency_Hz), HF_ABOVE_ZERO, 1e15, "", "Hz", NULL},
    {"load_case", HF_FIELD_TEXT, IN(objective, load_case), 1, HF_SET_NAME_SIZE, "", "", NULL},
    {"over", HF_FIELD_WORD, IN(objective, over), 0, 0, "design", "", hf_over_word},
    {"take", HF_FIELD_WORD, IN(objective, take), 0, 0, "mean", "", hf_take_word},
    {"quantile", HF_FIELD_DOUBLE, IN(objective, quantile), HF_ABOVE_ZERO, 1, "", "", NULL},
    {"weight", HF_FIELD_DOUBLE, IN(objective, weight), HF_ABOVE_ZERO, BIG, "1", "", NULL},
};

_Static_assert(IN(limit, upper) == IN(limit, lower) + sizeof(double), "bounds are bounds");
static const hf_field limit_field[] = {
    {"figure", HF_FIELD_WORD, IN(limit, figure), 0, 0, NULL, "", hf_limit_word},
    {"set", HF_FIELD_SET, IN(limit, set), 1, HF_SET_NAME_SIZE, "", "", NULL},
    {"bounds", HF_FIELD_BOUNDS, IN(limit, lower), -BIG, BIG, NULL, "", NULL},
};

static const hf_field cable_field[] = {
    {"set", HF_FIELD_SET, IN(cable, set), 1, HF_SET_NAME_SIZE, "all", "", NULL},
    {"expansion_per_K", HF_FIELD_DOUBLE, IN(cable, expansion_per_K), -1, 1, "", "1/K", NULL},
    {"mass_kg_per_m", HF_FIELD_DOUBLE, IN(cable, mass_kg_per_m), 0, 1e6, "", "kg/m", NULL},
};

static const hf_field node_field[] = {
    {"role", HF_FIELD_WORD, IN(node, role), 0, 0, "all", "", hf_nodes_word},
    {"mass_kg", HF_FIELD_DOUBLE, IN(node, mass_kg), 0, 1e6, NULL, "kg", NULL},
};

static const hf_field load_case_field[] = {
    {"name", HF_FIELD_TEXT, IN(load_case, name), 1, HF_SET_NAME_SIZE, NULL, "", NULL},
    {"set", HF_FIELD_SET, IN(load_case, set), 1, HF_SET_NAME_SIZE, "", "", NULL},
    {"part", HF_FIELD_WORD, IN(load_case, part), 0, 0, "all", "", hf_part_word},
    {"temperature_K", HF_FIELD_DOUBLE, IN(load_case, temperature_K), -1e4, 1e4, "", "K", NULL},
    {"gradient_K_per_m", HF_FIELD_VECTOR, IN(load_case, gradient_K_per_m), -1e4, 1e4, "", "K/m", NULL},
    {"gravity_m_per_s2", HF_FIELD_DOUBLE, IN(load_case, gravity_m_per_s2), HF_ABOVE_ZERO, 1e6, "", "m/s2", NULL},
    {"direction", HF_FIELD_VECTOR, IN(load_case, direction), -1e9, 1e9, "", "", NULL},
    {"force_N", HF_FIELD_VECTOR, IN(load_case, force_N), -1e12, 1e12, "", "N", NULL},
    {"role", HF_FIELD_WORD, IN(load_case, role), 0, 0, "all", "", hf_nodes_word},
    {"support_displacement_m", HF_FIELD_VECTOR, IN(load_case, support_displacement_m), -1e6, 1e6, "", "m", NULL},
    {"nodes", HF_FIELD_TEXT, IN(load_case, nodes_path), 1, HF_PATH_SIZE, "", "", NULL},
};

#define WORD(word, figure, feed, is_ruze) word,
static const char *const old_measure[] = {HF_OLD_MEASURES(WORD) NULL};
#undef WORD

static const hf_field require_field[] = {
    {"measure", HF_FIELD_WORD, IN(require, measure), 0, 0, NULL, "", old_measure},
    {"at_most", HF_FIELD_DOUBLE, IN(require, at_most), -BIG, BIG, "", "", NULL},
    {"at_least", HF_FIELD_DOUBLE, IN(require, at_least), -BIG, BIG, "", "", NULL},
};

static const hf_field requirement_field[] = {
    {"figure", HF_FIELD_WORD, IN(requirement, figure), 0, 0, NULL, "", hf_required_figure_word},
    {"set", HF_FIELD_SET, IN(requirement, set), 1, HF_SET_NAME_SIZE, "", "", NULL},
    {"feed", HF_FIELD_WORD, IN(requirement, feed), 0, 0, "refocused", "", hf_focus_word},
    {"frequency_Hz", HF_FIELD_DOUBLE, IN(requirement, frequency_Hz), HF_ABOVE_ZERO, 1e15, "", "Hz", NULL},
    {"load_case", HF_FIELD_TEXT, IN(requirement, load_case), 1, HF_SET_NAME_SIZE, "nominal", "", NULL},
    {"at_least", HF_FIELD_DOUBLE, IN(requirement, at_least), -BIG, BIG, "", "", NULL},
    {"at_most", HF_FIELD_DOUBLE, IN(requirement, at_most), -BIG, BIG, "", "", NULL},
    {"within", HF_FIELD_BOUNDS, IN(requirement, within), -BIG, BIG, "", "", NULL},
    {"share", HF_FIELD_DOUBLE, IN(requirement, share), HF_ABOVE_ZERO, 1, "", "", NULL},
    {"search", HF_FIELD_WORD, IN(requirement, search), 0, 0, "on", "", HF_WORDS("on", "off")},
};

static const hf_field truss_heat_field[] = {
    {"part", HF_FIELD_WORD, IN(truss_heat, part), 0, 0, NULL, "", hf_part_word + HF_PART_TRUSS},
    {"sigma_temperature_K", HF_FIELD_DOUBLE, IN(truss_heat, sigma_temperature_K), HF_ABOVE_ZERO, 1000, NULL, "K", NULL},
};

#undef IN

/* `less` is the number of last keys that the rows of this list do not have. */
#define LIST(name, count, row, max_row, keys, less)                                                                    \
    {                                                                                                                  \
        name, AT(count), AT(row), sizeof(((hf_case *)0)->row[0]), max_row, keys,                                       \
            (int)(sizeof keys / sizeof *keys) - less                                                                   \
    }
const hf_list hf_list_table[] = {
    LIST("optimize.variables", optimize.n_variable_row, optimize.variable_row, HF_DESIGN_ROWS_MAX, variable_field, 0),
    LIST("optimize.objective", optimize.n_term, optimize.term, HF_DESIGN_ROWS_MAX, objective_field, 0),
    /* A row of optimize.front has the keys of a row of optimize.objective without the last one, weight. */
    LIST("optimize.front", optimize.n_front, optimize.front, HF_FRONT_OBJECTIVES_MAX, objective_field, 1),
    LIST("optimize.limits", optimize.n_limit, optimize.limit, HF_DESIGN_ROWS_MAX, limit_field, 0),
    LIST("cables", built.n_cable, built.cable, HF_MATERIAL_ROWS_MAX, cable_field, 0),
    LIST("nodes", built.n_node, built.node, HF_MATERIAL_ROWS_MAX, node_field, 0),
    LIST("load_cases", built.n_load_case, built.load_case, HF_LOAD_CASE_ROWS_MAX, load_case_field, 0),
    LIST("requirements", n_requirement, requirement, HF_REQUIREMENT_ROWS_MAX, requirement_field, 0),
    LIST("tolerance.truss", tolerance.n_truss, tolerance.truss, HF_TRUSS_HEAT_ROWS_MAX, truss_heat_field, 0),
    /* The HF_OLD_LISTS old lists. */
    LIST("tolerance.require", tolerance.n_require, tolerance.require, HF_REQUIRE_ROWS_MAX, require_field, 0),
};
#undef LIST
const int hf_n_list = sizeof hf_list_table / sizeof *hf_list_table - HF_OLD_LISTS;

/* ---- differences ---- */

static bool is_same(const hf_field *f, const char *a, const char *b)
{
    const hf_double_list *p = (const void *)a, *q = (const void *)b;
    switch (f->type) { /* no default label, so that the compiler reports a type without a comparison */
    case HF_FIELD_TEXT:
    case HF_FIELD_SET:
        return !strcmp(a, b);
    case HF_FIELD_DOUBLE:
        return !memcmp(a, b, sizeof(double));
    case HF_FIELD_UINT64:
        return !memcmp(a, b, sizeof(uint64_t));
    case HF_FIELD_INT_PAIR:
        return !memcmp(a, b, 2 * sizeof(int));
    case HF_FIELD_AMOUNT:
    case HF_FIELD_BOUNDS:
        return !memcmp(a, b, 2 * sizeof(double));
    case HF_FIELD_VECTOR:
        return !memcmp(a, b, 3 * sizeof(double));
    case HF_FIELD_INT:
    case HF_FIELD_WORD:
        return !memcmp(a, b, sizeof(int));
    case HF_FIELD_DOUBLE_LIST:
        return p->n == q->n && !memcmp(p->value, q->value, (size_t)p->n * sizeof *p->value);
    }
    return false;
}

static int add_key(const char *key, int n, char *text, size_t size)
{
    size_t used = strlen(text);
    snprintf(text + used, size - used, "%s%s", n ? ", " : "", key);
    return n + 1;
}

/* Adds the keys in which the rows of a list differ. Adds the list itself if the numbers of rows differ. */
static int add_rows(const hf_list *list, const hf_case *a, const hf_case *b, int n, char *text, size_t size)
{
    int n_row = hf_key_n_row(a, list);
    if (n_row != hf_key_n_row(b, list)) return add_key(list->path, n, text, size);
    for (int row = 0; row < n_row; row++)
        for (int i = 0; i < list->n_field; i++) {
            const hf_key key = hf_key_of_row(list, row, i);
            if (!is_same(key.field, (const char *)a + key.offset, (const char *)b + key.offset))
                n = add_key(key.path, n, text, size);
        }
    return n;
}

int hf_config_differences(const hf_case *a, const hf_case *b, char *text, size_t size)
{
    const char *p = (const char *)a, *q = (const char *)b;
    int n = 0;
    *text = '\0';
    for (int i = 0; i < hf_n_section; i++) {
        size_t at = hf_section_table[i].present_offset;
        if (at != SIZE_MAX && memcmp(p + at, q + at, sizeof(bool)) != 0)
            n = add_key(hf_section_table[i].path, n, text, size);
    }
    for (int i = 0; i < hf_n_field; i++)
        if (!is_same(&hf_field_table[i], p + hf_field_table[i].offset, q + hf_field_table[i].offset))
            n = add_key(hf_field_table[i].path, n, text, size);
    for (int i = 0; i < hf_n_list; i++)
        n = add_rows(&hf_list_table[i], a, b, n, text, size);
    return n;
}
