/* Lists of rows in a case file: what varies, goals and limits; their keys by --set, their faults at file:line:col. */
#include "nets.h"

#define CYLINDER                                                                                                       \
    "scene:\n"                                                                                                         \
    "  parabolic_cylinder: {aperture_m: 10, length_m: 12, focal_length_m: 5, modules: [2, 3], cells_per_module: [4, "  \
    "2]}\n"
#define OPTIMIZE CYLINDER "optimize:\n"
#define ROWS                                                                                                           \
    OPTIMIZE "  symmetry: x\n"                                                                                         \
             "  variables:\n"                                                                                          \
             "    - {set: boundary, vary: force_density, range: 30 %, link: symmetry}\n"                               \
             "    - {set: tie, vary: tension, bounds: [1, 40], range: \"2.5%\", link: set}\n"                          \
             "    - {set: front-2, vary: support_z, range: 0.02, bounds: [null, 0.5]}\n"                               \
             "  objective:\n"                                                                                          \
             "    - figure: psi\n"                                                                                     \
             "    - {figure: tension, set: edge, target: 20000, weight: 1e-3}\n"                                       \
             "    - {figure: facets, along: half_path, feed: refocused}\n"                                             \
             "    - {figure: mass, mass_kg_per_m: 0.004}\n"                                                            \
             "  limits:\n"                                                                                             \
             "    - {figure: tension, set: tie, bounds: [1, .inf]}\n"                                                  \
             "    - {figure: ratio, set: inner, bounds: [~, 1.5]}\n"

static hf_status load_rows(const char *text, const char *const *set, int n_set, hf_case *c, char *said, size_t size)
{
    hf_messages messages = {0};
    const char *path = temp_path("c.yaml");
    write_file(path, text);
    hf_status status = hf_config_load(path, set, n_set, c, &messages);
    copy_without_folder(messages.text, said, size);
    hf_messages_free(&messages);
    return status;
}

static void accept_rows(const char *text, const char *const *set, int n_set, hf_case *c)
{
    char said[2000];
    hf_status status = load_rows(text, set, n_set, c, said, sizeof said);
    ck_assert_msg(status == HF_OK, "%s", said);
}

/* ---- what is accepted ---- */

START_TEST(variables_reach_their_place)
{
    hf_case c;
    accept_rows(ROWS, NULL, 0, &c);
    const hf_variable_settings *v = c.optimize.variable_row;
    ck_assert_int_eq(c.optimize.n_variable_row, 3);
    ck_assert_str_eq(v[0].set, "boundary");
    ck_assert_int_eq(v[0].vary, HF_VARY_FORCE_DENSITY);
    ck_assert(isnan(v[0].range) && v[0].lower == -INFINITY && v[0].upper == INFINITY);
    ck_assert_double_eq(v[0].range_ratio, 0.3);
    ck_assert_int_eq(v[0].link, HF_LINK_SYMMETRY);
    ck_assert_str_eq(v[1].set, "tie");
    ck_assert_int_eq(v[1].vary, HF_VARY_TENSION);
    ck_assert_double_eq(v[1].range_ratio, 0.025);
    ck_assert(v[1].lower == 1 && v[1].upper == 40 && v[1].link == HF_LINK_SET);
    ck_assert_str_eq(v[2].set, "front-2");
    static const char *const all[] = {"optimize.variables.1.set=all"};
    hf_case every;
    accept_rows(ROWS, all, 1, &every);
    ck_assert_str_eq(every.optimize.variable_row[1].set, "all");
    hf_case_free(&every);
    ck_assert_int_eq(v[2].vary, HF_VARY_SUPPORT_Z);
    ck_assert_double_eq(v[2].range, 0.02);
    ck_assert(isnan(v[2].range_ratio) && v[2].lower == -INFINITY && v[2].upper == 0.5 && v[2].link == HF_LINK_EACH);
    hf_case_free(&c);
}
END_TEST

START_TEST(objectives_and_limits_reach_their_place)
{
    hf_case c;
    accept_rows(ROWS, NULL, 0, &c);
    const hf_objective_settings *g = c.optimize.term;
    const hf_limit_settings *l = c.optimize.limit;
    ck_assert_int_eq(c.optimize.n_term, 4);
    ck_assert(g[0].figure == HF_FIGURE_PSI && g[0].weight == 1 && isnan(g[0].target) && !*g[0].set);
    ck_assert(g[0].along == HF_ALONG_NORMAL && g[0].feed == HF_FIXED && isnan(g[0].mass_kg_per_m));
    ck_assert(g[1].figure == HF_FIGURE_TENSION && g[1].target == 20000 && g[1].weight == 1e-3);
    ck_assert_str_eq(g[1].set, "edge");
    ck_assert(g[2].figure == HF_FIGURE_FACETS && g[2].along == HF_ALONG_HALF_PATH && g[2].feed == HF_REFOCUSED);
    ck_assert(g[3].figure == HF_FIGURE_MASS && g[3].mass_kg_per_m == 0.004 && !*g[3].set);
    ck_assert_int_eq(c.optimize.n_limit, 2);
    ck_assert(l[0].figure == HF_LIMIT_TENSION && l[0].lower == 1 && l[0].upper == INFINITY);
    ck_assert(l[1].figure == HF_LIMIT_RATIO && l[1].lower == -INFINITY && l[1].upper == 1.5);
    ck_assert_str_eq(l[1].set, "inner");
    hf_case_free(&c);
}
END_TEST

START_TEST(objectives_reach_their_place)
{
    static const char *const set[] = {"optimize.objective=[]", "optimize.method=lm",
                                      "optimize.front=[{figure: psi}, {figure: ratio, set: edge}]"};
    hf_case c;
    accept_rows(ROWS, set, 3, &c);
    const hf_objective_settings *g = c.optimize.front;
    ck_assert_int_eq(c.optimize.n_front, 2);
    ck_assert_int_eq(c.optimize.front_points, 21);
    ck_assert(g[0].figure == HF_FIGURE_PSI && isnan(g[0].target) && !*g[0].set && g[1].figure == HF_FIGURE_RATIO);
    ck_assert_str_eq(g[1].set, "edge");
    hf_case_free(&c);
}
END_TEST

START_TEST(overrides_set_keys_of_rows_and_whole_lists)
{
    static const char *const set[] = {"optimize.variables.0.range=5", "optimize.variables.2.bounds=[-1, 1]",
                                      "optimize.objective=[{figure: pull}]", "optimize.objective.0.weight=3",
                                      "optimize.limits=[]"};
    hf_case c;
    accept_rows(ROWS, set, 5, &c);
    ck_assert(c.optimize.variable_row[0].range == 5 && isnan(c.optimize.variable_row[0].range_ratio));
    ck_assert(c.optimize.variable_row[2].lower == -1 && c.optimize.variable_row[2].upper == 1);
    ck_assert_int_eq(c.optimize.n_term, 1);
    ck_assert(c.optimize.term[0].figure == HF_FIGURE_PULL && c.optimize.term[0].weight == 3);
    ck_assert_int_eq(c.optimize.n_limit, 0);
    hf_case_free(&c);
    accept_rows(CYLINDER, set + 2, 2, &c);
    ck_assert(c.has_optimize && c.optimize.n_term == 1);
    hf_case_free(&c);
}
END_TEST

START_TEST(a_difference_in_a_row_is_named)
{
    static const char *const of[][2] = {{"optimize.variables.1.set=tie2", "optimize.variables.1.set"},
                                        {"optimize.variables.0.vary=tension", "optimize.variables.0.vary"},
                                        {"optimize.variables.2.range=2 %", NULL},
                                        {"optimize.variables.0.range=30", "optimize.variables.0.range"},
                                        {"optimize.variables.2.bounds=[-9, 0.5]", "optimize.variables.2.bounds"},
                                        {"optimize.variables.0.range=30%", ""},
                                        {"optimize.objective.1.target=3", "optimize.objective.1.target"},
                                        {"optimize.objective.2.feed=fixed", "optimize.objective.2.feed"},
                                        {"optimize.limits.1.bounds=[1, 1.5]", "optimize.limits.1.bounds"},
                                        {"optimize.limits=[]", "optimize.limits"}};
    hf_case a, b;
    char text[256], said[2000];
    accept_rows(ROWS, NULL, 0, &a);
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        hf_status status = load_rows(ROWS, &of[i][0], 1, &b, said, sizeof said);
        ck_assert_int_eq(status, of[i][1] ? HF_OK : HF_BAD_CASE);
        if (of[i][1]) {
            hf_config_differences(&a, &b, text, sizeof text);
            ck_assert_str_eq(text, of[i][1]);
        }
        hf_case_free(&b);
    }
    hf_case_free(&a);
}
END_TEST

START_TEST(places_of_rows_are_told)
{
    static const char *const set = "optimize.objective.0.weight=2";
    static const struct {
        const char *key, *place;
        bool is_given;
    } wanted[] = {{"optimize.variables.1.set", "c.yaml:7:13: optimize.variables.1.set", true},
                  {"optimize.variables.2", "c.yaml:8:7: optimize.variables.2", true},
                  {"optimize.variables.2.link", "c.yaml:8:7: optimize.variables.2.link", false},
                  {"optimize.objective.0.set", "c.yaml:10:7: optimize.objective.0.set", false},
                  {"optimize.objective.0.weight", "--set optimize.objective.0.weight", true},
                  {"optimize.limits.7.set", "c.yaml: optimize.limits.7.set", false}};
    hf_case c;
    char text[2 * HF_PATH_SIZE], place[256];
    accept_rows(ROWS, &set, 1, &c);
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        ck_assert_int_eq(hf_config_location(&c, wanted[i].key, text, sizeof text), wanted[i].is_given);
        copy_without_folder(text, place, sizeof place);
        ck_assert_str_eq(place, wanted[i].place);
    }
    hf_case_free(&c);
}
END_TEST

/* ---- what is refused ---- */

#define VARIABLE OPTIMIZE "  variables:\n    - "
#define OBJECTIVE OPTIMIZE "  objective: ["
#define FRONT OPTIMIZE "  method: lm\n  front: ["
#define LIMIT OPTIMIZE "  limits: ["
#define ROW "{set: a, vary: length, range: 1}"

static const struct {
    const char *text, *override, *said;
} bad_row[] = {
    {OPTIMIZE "  variables: {set: a}\n", NULL,
     "error: c.yaml:4:14: optimize.variables: must be a list of rows, each a line '- {key: value, ...}'\n"},
    {OPTIMIZE "  objective:\n", NULL,
     "error: c.yaml:4:13: optimize.objective: must be a list of rows, each a line '- {key: value, ...}'\n"},
    {VARIABLE "tension\n", NULL, "error: c.yaml:5:7: optimize.variables.0: must be a row {key: value, ...}\n"},
    {OPTIMIZE "  variable: []\n", NULL, "error: c.yaml:4:3: variable: unknown key; did you mean 'variables'?\n"},
    {VARIABLE "{set: a, vary: length, ranges: 1, bounds: [1, 2]}\n", NULL,
     "error: c.yaml:5:30: ranges: unknown key; did you mean 'range'?\n"},
    {VARIABLE "{set: a, vary: tension, range_N: 1, bounds: [1, 2]}\n", NULL,
     "error: c.yaml:5:31: range_N: unknown key; did you mean 'range'?\n"},
    {VARIABLE "{set: a, vary: tension, range: 1, set: b}\n", NULL,
     "error: c.yaml:5:41: set: this key stands here already, on line 5\n"},
    {VARIABLE "{vary: tension, range: 1}\n", NULL,
     "error: c.yaml:5:7: optimize.variables.0.set: is missing and has no default\n"},
    {VARIABLE "{set: a, range: 1}\n", NULL,
     "error: c.yaml:5:7: optimize.variables.0.vary: is missing and has no default\n"},
    {OBJECTIVE "{figure: psi}, {weight: 2}]\n", NULL,
     "error: c.yaml:4:30: optimize.objective.1.figure: is missing and has no default\n"},
    {LIMIT "{bounds: [1, 2]}]\n", NULL,
     "error: c.yaml:4:12: optimize.limits.0.figure: is missing and has no default\n"},
    {LIMIT "{figure: tension}]\n", NULL,
     "error: c.yaml:4:12: optimize.limits.0.bounds: is missing and has no default\n"},
    {VARIABLE "{set: a, vary: tensions, range: 1}\n", NULL,
     "error: c.yaml:5:22: optimize.variables.0.vary: must be one of tension force_density length unstressed_length "
     "support_z support_normal support_xyz, not tensions; did you mean 'tension'?\n"},
    {OBJECTIVE "{figure: rms}]\n", NULL,
     "error: c.yaml:4:24: optimize.objective.0.figure: must be one of psi surface facets tension length evenness pull "
     "deflection mass ratio gain, not rms\n"},
    {LIMIT "{figure: length, bounds: [1, 2]}]\n", NULL,
     "error: c.yaml:4:21: optimize.limits.0.figure: must be one of tension ratio deflection, not length\n"},
    {VARIABLE "{set: a, vary: tension}\n", NULL,
     "error: c.yaml:5:7: optimize.variables.0.range: is missing; give range, bounds or both\n"},
    {VARIABLE "{set: a, vary: tension, range: 0}\n", NULL,
     "error: c.yaml:5:38: optimize.variables.0.range: must be above 0, not 0\n"},
    {VARIABLE "{set: a, vary: tension, range: -5 %}\n", NULL,
     "error: c.yaml:5:38: optimize.variables.0.range: must be above 0, not -5 %\n"},
    {VARIABLE "{set: a, vary: tension, range: 5 N}\n", NULL,
     "error: c.yaml:5:38: optimize.variables.0.range: must be a number, or a part like 30 %, not 5 N\n"},
    {VARIABLE "{set: a, vary: tension, range: \"5\"}\n", NULL,
     "error: c.yaml:5:38: optimize.variables.0.range: must be a number, or a part like 30 %\n"},
    {VARIABLE "{set: a, vary: tension, range: \"%\"}\n", NULL,
     "error: c.yaml:5:38: optimize.variables.0.range: must be a number, or a part like 30 %, not %\n"},
    {VARIABLE "{set: a, vary: tension, range: [1, 2]}\n", NULL,
     "error: c.yaml:5:38: optimize.variables.0.range: must be a number, or a part like 30 %\n"},
    {VARIABLE "{set: a, vary: support_z, range: 5 %}\n", NULL,
     "error: c.yaml:5:40: optimize.variables.0.range: must be in m: the place of a support has no size to take a part "
     "of\n"},
    {VARIABLE "{set: a, vary: tension, bounds: [2, 2]}\n", NULL,
     "error: c.yaml:5:39: optimize.variables.0.bounds: the lower bound must be below the upper one\n"},
    {VARIABLE "{set: a, vary: tension, bounds: 2}\n", NULL,
     "error: c.yaml:5:39: optimize.variables.0.bounds: must be two bounds, like [1, 20]\n"},
    {VARIABLE "{set: a, vary: tension, bounds: [1, 2, 3]}\n", NULL,
     "error: c.yaml:5:39: optimize.variables.0.bounds: must be two bounds, like [1, 20]\n"},
    {VARIABLE "{set: a, vary: tension, bounds: [1, b]}\n", NULL,
     "error: c.yaml:5:43: optimize.variables.0.bounds: must be a number, not a text\n"},
    {VARIABLE "{set: a, vary: tension, bounds: [.inf, 1]}\n", NULL,
     "error: c.yaml:5:40: optimize.variables.0.bounds: must be a finite number, not .inf\n"},
    {VARIABLE "{set: a, vary: tension, bounds: [-.inf, .inf]}\n", NULL,
     "error: c.yaml:5:39: optimize.variables.0.bounds: leaves both sides open; give one bound at least\n"},
    {VARIABLE "{set: front edge, vary: tension, range: 1}\n", NULL,
     "error: c.yaml:5:13: optimize.variables.0.set: must be made of letters, digits, _ and -\n"},
    {OBJECTIVE "{figure: evenness, set: -a}]\n", NULL,
     "error: c.yaml:4:39: optimize.objective.0.set: must not begin with -\n"},
    {LIMIT "{figure: ratio, set: \"a;b\", bounds: [1, 2]}]\n", NULL,
     "error: c.yaml:4:33: optimize.limits.0.set: must be made of letters, digits, _ and -\n"},
    {VARIABLE "{set: \"\", vary: tension, range: 1}\n", NULL,
     "error: c.yaml:5:13: optimize.variables.0.set: must be a text\n"},
    {VARIABLE "{set: a123456789a123456789a123456789a123456789a123456789a123456789abcd, vary: tension, range: 1}\n",
     NULL, "error: c.yaml:5:13: optimize.variables.0.set: is too long\n"},
    {VARIABLE "{set: a, vary: tension, range: 1, link: symmetry}\n", NULL,
     "error: c.yaml:5:47: optimize.variables.0.link: symmetry needs optimize.symmetry, which is none\n"},
    {OPTIMIZE "  symmetry: x\n  variables: [{set: a, vary: support_xyz, range: 1, link: symmetry}]\n", NULL,
     "error: c.yaml:5:59: optimize.variables.0.link: cannot be symmetry with support_xyz: mirrored supports move apart "
     "along x or y\n"},
    {OBJECTIVE "{figure: psi, set: a}]\n", NULL,
     "error: c.yaml:4:34: optimize.objective.0.set: has no meaning for psi, only for tension, length, evenness, mass, "
     "ratio\n"},
    {FRONT "{figure: psi}]\n", NULL,
     "error: c.yaml:5:11: optimize.front.0: is the only row; a front is of two or three objectives. For one use "
     "optimize.objective\n"},
    {FRONT "{figure: psi}, {figure: pull}]\n  objective: [{figure: psi}]\n", NULL,
     "error: c.yaml:6:15: optimize.objective.0: cannot be with optimize.front, which replaces the objective; keep "
     "one of them\n"},
    {FRONT "{figure: psi}, {figure: psi}]\n", NULL,
     "error: c.yaml:5:35: optimize.front.1.figure: is the objective of an earlier row; a front needs different "
     "ones\n"},
    {FRONT "{figure: psi}, {figure: pull}, {figure: mass}, {figure: ratio}]\n", NULL,
     "error: c.yaml:5:58: optimize.front: there are more than 3 rows\n"},
    {FRONT "{figure: psi}, {figure: pull}, {figure: evenness}]\n  front_points: 3\n", NULL,
     "error: c.yaml:6:17: optimize.front_points: must be at least 4 with three objectives, for the ends alone\n"},
    {FRONT "{figure: psi}, {figure: pull}]\n  refine: true\n", NULL,
     "error: c.yaml:6:11: optimize.refine: compares one design; it has no meaning for optimize.front\n"},
    {FRONT "{figure: psi}, {figure: pull}]\n  variation: chain\n", NULL,
     "error: c.yaml:6:14: optimize.variation: cannot be chain with optimize.front, whose children move along "
     "differences; remove it\n"},
    {FRONT "{figure: psi}, {figure: pull}]\n  elites: 2\n", NULL,
     "error: c.yaml:6:11: optimize.elites: has no meaning for optimize.front; remove it\n"},
    {FRONT "{figure: psi}, {figure: pull}]\n  crossover_low: 0.5\n", NULL,
     "error: c.yaml:6:18: optimize.crossover_low: has no meaning for optimize.front; remove it\n"},
    {FRONT "{figure: psi}, {figure: pull}]\n", "optimize.mutation_low=0.01",
     "error: --set optimize.mutation_low: has no meaning for optimize.front; remove it\n"},
    {FRONT "{figure: psi, weight: 2}, {figure: pull}]\n", NULL,
     "error: c.yaml:5:25: weight: unknown key (hifdm schema lists all keys)\n"},
    {FRONT "{figure: psi}, {figure: ratio, target: 2}]\n", NULL,
     "error: c.yaml:5:50: optimize.front.1.target: has no meaning for ratio, only for tension, length\n"},
    {OBJECTIVE "{figure: psi, target: 1}]\n", NULL,
     "error: c.yaml:4:37: optimize.objective.0.target: has no meaning for psi, only for tension, length\n"},
    {OBJECTIVE "{figure: facets, frequency_Hz: 1e9}]\n", NULL,
     "error: c.yaml:4:46: optimize.objective.0.frequency_Hz: has no meaning for facets, only for gain\n"},
    {OBJECTIVE "{figure: tension, target: 1, along: normal}]\n", NULL,
     "error: c.yaml:4:51: optimize.objective.0.along: has no meaning for tension, only for surface, facets\n"},
    {OBJECTIVE "{figure: pull, feed: fixed}]\n", NULL,
     "error: c.yaml:4:36: optimize.objective.0.feed: has no meaning for pull, only for surface, facets\n"},
    {OBJECTIVE "{figure: length, mass_kg_per_m: 1}]\n", NULL,
     "error: c.yaml:4:47: optimize.objective.0.mass_kg_per_m: has no meaning for length, only for mass\n"},
    {LIMIT "{figure: deflection, set: a, bounds: [0, 1]}]\n", NULL,
     "error: c.yaml:4:38: optimize.limits.0.set: has no meaning for deflection, only for tension, ratio\n"},
    {OBJECTIVE "{figure: tension}]\n", NULL,
     "error: c.yaml:4:15: optimize.objective.0.target: is missing: the tension that is wanted, in N\n"},
    {OBJECTIVE "{figure: length, target: 0}]\n", NULL,
     "error: c.yaml:4:40: optimize.objective.0.target: of length must be above 0\n"},
    {OBJECTIVE "{figure: mass}]\n", NULL,
     "error: c.yaml:4:15: optimize.objective.0.mass_kg_per_m: is missing: the mass of the cables\n"},
    {OBJECTIVE "{figure: mass, mass_kg_per_m: 0}]\n", NULL,
     "error: c.yaml:4:45: optimize.objective.0.mass_kg_per_m: must be above 0, not 0\n"},
    {OBJECTIVE "{figure: psi, weight: 0}]\n", NULL,
     "error: c.yaml:4:37: optimize.objective.0.weight: must be above 0, not 0\n"},
    {LIMIT "{figure: ratio, bounds: [0, 1]}]\n", NULL,
     "error: c.yaml:4:36: optimize.limits.0.bounds: must end above 1, and not begin above it: even tensions have 1\n"},
    {LIMIT "{figure: ratio, bounds: [1, null]}]\n", NULL,
     "error: c.yaml:4:36: optimize.limits.0.bounds: must end above 1, and not begin above it: even tensions have 1\n"},
    {LIMIT "{figure: ratio, bounds: [2, 3]}]\n", NULL,
     "error: c.yaml:4:36: optimize.limits.0.bounds: must end above 1, and not begin above it: even tensions have 1\n"},
    {LIMIT "{figure: deflection, bounds: [-1, 0]}]\n", NULL,
     "error: c.yaml:4:41: optimize.limits.0.bounds: must end above 0, and not begin above it\n"},
    {LIMIT "{figure: deflection, bounds: [1e-3, 1]}]\n", NULL,
     "error: c.yaml:4:41: optimize.limits.0.bounds: must end above 0, and not begin above it\n"},
    {OPTIMIZE "  rule: seeded\n  variables: [" ROW "]\n", NULL,
     "error: c.yaml:4:9: optimize.rule: cannot be seeded with optimize.variables; remove one of them\n"},
    {OPTIMIZE "  range_N: 1\n  variables: [" ROW "]\n", NULL,
     "error: c.yaml:4:12: optimize.range_N: is of the default variables alone; with optimize.variables give range and "
     "bounds there\n"},
    {OPTIMIZE "  min_tension_N: 1\n  variables: [" ROW "]\n", NULL,
     "error: c.yaml:4:18: optimize.min_tension_N: is of the default variables alone; with optimize.variables give "
     "range "
     "and bounds there\n"},
    {OPTIMIZE "  variables: [" ROW "]\n", "optimize.max_tension_N=9",
     "error: --set optimize.max_tension_N: is of the default variables alone; with optimize.variables give range and "
     "bounds there\n"},
    {OPTIMIZE "  variables: [" ROW "]\n", "optimize.variables.1.range=1",
     "error: --set optimize.variables.1.range=1: optimize.variables.1.range: there is no such row: optimize.variables "
     "has 1, numbered from 0\n"},
    {OPTIMIZE "  variables: [" ROW "]\n", "optimize.variables.16.range=1",
     "error: --set optimize.variables.16.range=1: optimize.variables.16.range: is no key of a row, which is "
     "optimize.variables.N.KEY with N from 0 to 15\n"},
    {OPTIMIZE "  variables: [" ROW "]\n", "optimize.variables.0={set: b}",
     "error: --set optimize.variables.0={set: b}: optimize.variables.0: is no key of a row, which is "
     "optimize.variables.N.KEY with N from 0 to 15\n"},
    {OPTIMIZE "  variables: [" ROW "]\n", "optimize.variables.0.rnge=1",
     "error: --set optimize.variables.0.rnge=1: rnge: unknown key; did you mean 'range'?\n"},
    {OPTIMIZE "  variables: [" ROW "]\n", "optimize.variables.0.link=symmetry",
     "error: --set optimize.variables.0.link: symmetry needs optimize.symmetry, which is none\n"},
    {OPTIMIZE "  variables: [" ROW "]\n", "optimize.variables=[{set: a, vary: length}]",
     "error: --set optimize.variables.0.range: is missing; give range, bounds or both\n"},
};
enum { N_BAD_ROW = sizeof bad_row / sizeof *bad_row };

START_TEST(faults_of_rows_are_told_where_they_are)
{
    char said[2000];
    hf_case c;
    ck_assert_int_eq(
        load_rows(bad_row[_i].text, &bad_row[_i].override, bad_row[_i].override != NULL, &c, said, sizeof said),
        HF_BAD_CASE);
    ck_assert_str_eq(said, bad_row[_i].said);
    hf_case_free(&c);
}
END_TEST

START_TEST(rows_are_counted)
{
    char text[4000] = OPTIMIZE "  variables:\n", said[2000];
    hf_case c;
    for (int i = 0; i < HF_DESIGN_ROWS_MAX; i++)
        strcat(text, "    - " ROW "\n");
    accept_rows(text, NULL, 0, &c);
    ck_assert_int_eq(c.optimize.n_variable_row, HF_DESIGN_ROWS_MAX);
    hf_case_free(&c);
    strcat(text, "    - " ROW "\n    - " ROW "\n");
    ck_assert_int_eq(load_rows(text, NULL, 0, &c, said, sizeof said), HF_BAD_CASE);
    ck_assert_str_eq(said, "error: c.yaml:21:7: optimize.variables: there are more than 16 rows\n");
    hf_case_free(&c);
}
END_TEST

START_TEST(all_faults_of_rows_are_told_in_one_run)
{
    char said[2000];
    hf_case c;
    ck_assert_int_eq(load_rows(OPTIMIZE "  rule: seeded\n"
                                        "  variables:\n"
                                        "    - {set: a, vary: tension}\n"
                                        "    - {set: a b, vary: length, range: 1}\n"
                                        "  objective: [{figure: psi, set: a, feed: fixed}]\n",
                               NULL, 0, &c, said, sizeof said),
                     HF_BAD_CASE);
    ck_assert_str_eq(
        said, "error: c.yaml:6:7: optimize.variables.0.range: is missing; give range, bounds or both\n"
              "error: c.yaml:7:13: optimize.variables.1.set: must be made of letters, digits, _ and -\n"
              "error: c.yaml:4:9: optimize.rule: cannot be seeded with optimize.variables; remove one of them\n"
              "error: c.yaml:8:34: optimize.objective.0.set: has no meaning for psi, only for tension, length, "
              "evenness, mass, ratio\n"
              "error: c.yaml:8:43: optimize.objective.0.feed: has no meaning for psi, only for surface, facets\n");
    hf_case_free(&c);
}
END_TEST

/* Rows get their defaults while the file is being read: without memory there, too, a status, no leak and no crash. */
START_TEST(any_allocation_of_rows_may_fail)
{
    for (long n = 1;; n += 1 + n / 100) {
        hf_messages messages = {0};
        hf_case c;
        fail_allocation_at(n);
        hf_status status = hf_config_parse("c.yaml", ROWS, NULL, 0, &c, &messages);
        bool reached = end_allocation_failure();
        hf_case_free(&c);
        hf_messages_free(&messages);
        ck_assert_msg(status == (reached ? HF_NO_MEMORY : HF_OK), "allocation %ld: %d", n, status);
        if (!reached) break;
    }
}
END_TEST

Suite *suite_unit_config_rows(void)
{
    Suite *suite = suite_create("unit/config_rows");
    TCase *tests = tcase_create("config_rows");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, variables_reach_their_place);
    tcase_add_test(tests, objectives_and_limits_reach_their_place);
    tcase_add_test(tests, objectives_reach_their_place);
    tcase_add_test(tests, overrides_set_keys_of_rows_and_whole_lists);
    tcase_add_test(tests, a_difference_in_a_row_is_named);
    tcase_add_test(tests, places_of_rows_are_told);
    tcase_add_loop_test(tests, faults_of_rows_are_told_where_they_are, 0, N_BAD_ROW);
    tcase_add_test(tests, rows_are_counted);
    tcase_add_test(tests, all_faults_of_rows_are_told_in_one_run);
    tcase_add_test(tests, any_allocation_of_rows_may_fail);
    return suite;
}
