/* Requirements of a case: what a row must give, the verdicts that a run prints and stores, the option --strict, and
 * results that do not depend on threads, tasks and interruptions. */
#include "session.h"

#define BUILT_SCENE SMALL_SCENE "  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\n"
#define TOLERANCE "tolerance: {sigma_cut_m: 1e-4, samples: %d}\n"
#define LOADS                                                                                                          \
    "cables: [{expansion_per_K: 1e-5, mass_kg_per_m: 1e-3}]\nload_cases:\n  - {name: cold, temperature_K: -20}\n"      \
    "  - {name: windy, force_N: [0, 0, -1], role: inner}\n"
#define ROWS "requirements:\n"

/* ---- faults ---- */

/* The rows begin in line 6. */
START_TEST(faults_are_named)
{
#define LOADED "load_cases: [{name: cold, temperature_K: 5}]\ncables: [{expansion_per_K: 0, mass_kg_per_m: 1e-3}]\n"
#define SAMPLES "tolerance: {sigma_cut_m: 1e-4, samples: 100}\n"
    static const char *const fault[][2] = {
        {"  - {figure: psi}\n", "6:14: requirements.0.figure: has no bound; give at_most, at_least or within"},
        {"  - {at_most: 1}\n", "6:5: requirements.0.figure: is missing"},
        {"  - {figure: tensoin, at_least: 1}\n", "6:14: requirements.0.figure: must be one of psi surface facets "},
        {"  - {figure: tension, at_leat: 1}\n", "6:23: at_leat: unknown key; did you mean 'at_least'?"},
        {"  - {figure: tension, at_least: .nan}\n", "6:33: requirements.0.at_least: must be a finite number"},
        {"  - {figure: tension, at_least: 5, at_most: 2}\n",
         "6:33: requirements.0.at_least: must not be above at_most"},
        {"  - {figure: tension, within: [5, 2]}\n",
         "6:31: requirements.0.within: the lower bound must be below the upper one"},
        {"  - {figure: tension, within: [1, 2], at_most: 3}\n",
         "6:31: requirements.0.within: replaces at_least and at_most; keep one of them"},
        {"  - {figure: psi, at_most: -1e-3}\n", "6:28: requirements.0.at_most: is below 0, which no net can reach"},
        {"  - {figure: ratio, at_most: 0.5}\n",
         "6:30: requirements.0.at_most: is below 1, the ratio of equal tensions"},
        {"  - {figure: psi, at_most: 1, set: inner}\n",
         "6:36: requirements.0.set: has no meaning for psi, only for tension, ratio, slack_cables, mass"},
        {"  - {figure: tension, at_least: 1, feed: fixed}\n",
         "6:42: requirements.0.feed: has no meaning for tension, only for surface, facets"},
        {"  - {figure: tension, at_least: 1, set: innr}\n",
         "6:41: requirements.0.set: this net has no cable set 'innr'; did you mean 'inner'?"},
        {"  - {figure: tension, at_least: 1, load_case: cold}\n",
         "6:47: requirements.0.load_case: needs load cases; add rows to `load_cases`, or remove this key"},
        {"  - {figure: tension, at_least: 1, load_case: all}\n", "6:47: requirements.0.load_case: needs load cases"},
        {"  - {figure: tension, at_least: 1, load_case: clod}\n" LOADED,
         "6:47: requirements.0.load_case: is neither nominal, all nor a load case of `load_cases`; did you mean "
         "'cold'?"},
        {"  - {figure: tension, at_least: 1, load_case: xyzzy}\n" LOADED,
         "6:47: requirements.0.load_case: is neither nominal, all nor a load case of `load_cases`, whose first is "
         "'cold'"},
        {"  - {figure: tension, at_least: 1, load_case: cold}\nload_cases: [{name: cold, temperature_K: 5}]\n",
         "7:42: load_cases.0.temperature_K: 58 cables have no thermal expansion coefficient"},
        {"  - {figure: surface, at_most: 1}\n", "6:14: requirements.0.figure: is not measured; add a section surface"},
        {"  - {figure: facets, at_most: 1}\n", "6:14: requirements.0.figure: is not measured; add a section surface"},
        {"  - {figure: gain, at_least: 1}\n", "6:14: requirements.0.figure: is not measured; add a section surface"},
        {"  - {figure: gain, at_least: 1}\nsurface: {}\n",
         "6:14: requirements.0.figure: needs a frequency; add frequency_Hz to this row, or surface.frequencies_Hz"},
        {"  - {figure: gain, at_least: 1, frequency_Hz: 8}\nsurface: {}\n",
         "6:47: requirements.0.frequency_Hz: is 8 Hz, and below 1 MHz there are no reflectors: was GHz meant?"},
        {"  - {figure: psi, at_most: 1, frequency_Hz: 8e9}\n",
         "6:45: requirements.0.frequency_Hz: has no meaning for psi, only for gain_loss, gain, pointing"},
        {"  - {figure: pointing, at_most: 1, frequency_Hz: 8e8, feed: refocused}\nsurface: {}\n",
         "6:61: requirements.0.feed: cannot be refocused for pointing"},
        {"  - {figure: gain_loss, at_most: 1}\n  - {figure: gain_loss, at_most: 2, frequency_Hz: 8e8}\n"
         "surface: {frequencies_Hz: [8e8]}\n",
         "7:14: requirements.1.figure: is bounded by requirements.0 already; keep one of the rows"},
        {"  - {figure: gain_loss, at_most: 1, frequency_Hz: 8e12}\nsurface: {}\n",
         "6:14: requirements.0.figure: hifdm cannot compute this figure at 8000 GHz, because its facets are too "
         "coarse"},
        {"  - {figure: deflection, at_most: 1}\n", "6:14: requirements.0.figure: needs a section truss"},
        {"  - {figure: mass, at_most: 1}\n",
         "6:14: requirements.0.figure: 58 cables have no mass per length, such as '"},
        {"  - {figure: mass, at_most: 1, share: 0.5}\n" SAMPLES "cables: [{mass_kg_per_m: 1e-3}]\n",
         "6:39: requirements.0.share: has no meaning for mass, which neither loads nor errors change"},
        {"  - {figure: mass, at_most: 1, load_case: cold}\n" LOADED,
         "6:43: requirements.0.load_case: has no meaning for mass"},
        {"  - {figure: tension, at_least: 1, share: 0.9}\n",
         "6:43: requirements.0.share: needs a section tolerance, which defines the as-built samples"},
        {"  - {figure: tension, at_least: 1, share: 0.99}\n" SAMPLES,
         "6:43: requirements.0.share: cannot be decided by 100 samples; set tolerance.samples to at least 368"},
        {"  - {figure: tension, at_least: 1, share: 1}\n" SAMPLES,
         "6:43: requirements.0.share: cannot be 1: no number of samples shows that all nets pass"},
        {"  - {figure: tension, at_least: 1, share: 1.5}\n" SAMPLES,
         "6:43: requirements.0.share: must be above 0 and at most 1, not 1.5"},
        {"  - {figure: tension, at_least: 1, share: 0}\n" SAMPLES,
         "6:43: requirements.0.share: must be above 0 and at most 1, not 0"},
        {"  - {figure: tension, at_least: 1}\n  - {figure: tension, at_least: 2}\n",
         "7:14: requirements.1.figure: is bounded by requirements.0 already; keep one of the rows"},
        {"  - {figure: tension, at_least: 5}\n  - {figure: tension, set: all, at_most: 2}\n",
         "7:14: requirements.1.figure: contradicts requirements.0: no value meets both rows"},
        {"  - {figure: tension, at_least: 5}\n  - {figure: tension, set: boundary, at_most: 2}\n",
         "7:14: requirements.1.figure: contradicts requirements.0: no value meets both rows"},
        {"  - {figure: psi, at_most: 1}\n  - {figure: psi, at_least: 2, load_case: all}\n" LOADED,
         "7:14: requirements.1.figure: contradicts requirements.0: no value meets both rows"},
    };
    for (size_t k = 0; k < sizeof fault / sizeof *fault; k++) {
        const char *c = file_with("f.yaml", formatted(BUILT_SCENE ROWS "%s", fault[k][0]));
        HIFDM(2, "check", c);
        ERRS("f.yaml:%s", fault[k][1]);
        ck_assert_msg(count_of(said.err, "error: ") == 1, "%s", said.err);
        HIFDM(2, "run", c, NOWHERE);
        ERRS("f.yaml:%s", fault[k][1]);
    }
    file_with("n.csv", "id,x_m,y_m,z_m,role\na,-1,0,0,support\nb,1,0,0,support\nm,0,0.1,0,inner\n");
    file_with("e.csv", "id,i,j,group,law,value,EA_N\np,a,m,inner,force_density,10,2000\nq,b,m,inner,force_density,10,"
                       "2000\n");
    HIFDM(2, "run",
          file_with("f.yaml", "scene:\n  import: {nodes: n.csv, cables: e.csv}\n"
                              "surface: {kind: paraboloid, focal_length_m: 2, frequencies_Hz: [1e9]}\n"
                              "requirements: [{figure: gain, at_least: 1}]\n"),
          NOWHERE);
    ERR("f.yaml:4:25: requirements.0.figure: this net has no facets, so it has no gain");
    HIFDM(2, "run",
          file_with("f.yaml", "scene:\n  import: {nodes: n.csv, cables: e.csv}\n"
                              "surface: {kind: paraboloid, focal_length_m: 2}\n"
                              "requirements: [{figure: facets, at_most: 1}]\n"),
          NOWHERE);
    ERR("f.yaml:4:25: requirements.0.figure: this net has no facets. To bound the errors of the nodes, use the figure "
        "surface");
    ck_assert(!is_there(temp("nowhere.h5")));
}
END_TEST

/* One call reports the faults of a file, so that a user does not mend one and meets the next. The lists of a file
 * begin in line 4. A fault that follows from another one is not reported. */
START_TEST(all_faults_are_reported_at_once)
{
#define EA "scene.EA_inner_N=1e5", "--set", "scene.EA_boundary_N=1e5"
#define NO_SET(row, set) ": requirements." #row ".set: this net has no cable set '" #set "'"
#define NO_BOUND(row) ": requirements." #row ".figure: has no bound"
    static const struct {
        const char *text, *fault[6];
    } file[] = {
        {"requirements:\n  - {figure: tension, at_least: 5, at_most: 2, share: 0.9, set: innr}\n",
         {"5:33: requirements.0.at_least: must not be above at_most", "5:55: requirements.0.share: needs a section",
          "5:65" NO_SET(0, innr)}},
        {"requirements:\n  - {figure: tension, at_least: 5, set: innr}\n  - {figure: ratio, at_most: 5, set: out}\n"
         "  - {figure: mass, at_most: 1}\n",
         {"5:41" NO_SET(0, innr), "6:38" NO_SET(1, out), "7:14: requirements.2.figure: 58 cables have no mass"}},
        {"requirements:\n  - {figure: tensoin, at_least: 5}\n  - {figure: psi}\n"
         "  - {figure: tension, at_least: 1, share: 0.9}\n",
         {"5:14: requirements.0.figure: must be one of psi", "6:14" NO_BOUND(1), "7:43: requirements.2.share: needs"}},
        {"requirements:\n  - {figure: surface, at_most: 1}\n  - {figure: tension, set: innr, at_least: 1}\n",
         {"5:14: requirements.0.figure: is not measured", "6:28" NO_SET(1, innr)}},
        {"load_cases:\n  - {name: cold, temperature_K: -20}\nrequirements:\n"
         "  - {figure: tension, set: innr, at_least: 1, load_case: cold}\n",
         {"5:33: load_cases.0.temperature_K: 58 cables have no thermal expansion", "7:28" NO_SET(0, innr)}},
        {"requirements: [{figure: tension, set: innr, at_least: 1}]\noptimize:\n"
         "  limits: [{figure: tension, set: bundary, bounds: [1, 5]}]\n"
         "  variables: [{set: xx, vary: force_density, range: 10 %}]\n"
         "  objective: [{figure: length, set: yy, target: 1}]\n",
         {"4:39" NO_SET(0, innr), "6:35: optimize.limits.0.set: this net has", "7:21: optimize.variables.0.set: this",
          "8:37: optimize.objective.0.set: this net has"}},
        {"requirements: [{figure: psi}]\noptimize: {min_tension_N: 5, max_tension_N: 2, elites: 9, population: 8}\n",
         {"4:25" NO_BOUND(0), "5:27: optimize.min_tension_N: must be below", "5:56: optimize.elites: must be below"}},
        {"cables: [{set: inner}]\nrequirements:\n  - {figure: psi}\n  - {figure: deflection, at_most: 1}\n",
         {"4:16: cables.0.set: says nothing", "6:14" NO_BOUND(0), "7:14: requirements.1.figure: needs a section"}},
        {"surface: {frequencies_Hz: [8]}\nrequirements:\n  - {figure: gain, at_least: 1, frequency_Hz: 7}\n"
         "  - {figure: psi}\n",
         {"4:27: surface.frequencies_Hz: is 8 Hz", "6:47: requirements.0.frequency_Hz: is 7 Hz", "7:14" NO_BOUND(1)}},
        {"truss: {import: {nodes: n.csv, members: m.csv}, depth_m: 1}\nrequirements:\n  - {figure: psi}\n"
         "  - {figure: tension, set: innr, at_least: 2}\n",
         {"4:58: truss.depth_m: has no effect beside truss.import", "6:14" NO_BOUND(0), "7:28" NO_SET(1, innr)}},
        {"surface: {}\nrequirements:\n  - {figure: gain_loss, at_most: 1, frequency_Hz: 8e12}\n"
         "  - {figure: tension, set: innr, at_least: 2}\n  - {figure: mass, set: innr, at_most: 1}\n",
         {"6:14: requirements.0.figure: hifdm cannot compute this figure at 8000 GHz", "7:28" NO_SET(1, innr),
          "8:25" NO_SET(2, innr)}},
        {"tolerance: {sigma_temperature_K: 5, samples: 100}\nrequirements:\n  - {figure: psi}\n"
         "  - {figure: tension, set: innr, at_least: 2, share: 0.99}\n",
         {"4:34: tolerance.sigma_temperature_K: needs expansion_per_K", "6:14" NO_BOUND(0), "7:28" NO_SET(1, innr),
          "7:54: requirements.1.share: cannot be decided by 100 samples"}},
        {"requirements:\n  - {figure: tension, at_least: 5}\n  - {figure: tension, at_most: 2}\n"
         "  - {figure: ratio, at_most: 2, set: innr}\n",
         {"6:14: requirements.1.figure: contradicts", "7:38" NO_SET(2, innr)}},
        {"requirements:\n  - {figure: tension, at_leat: 1}\n  - {at_most: 1}\n  - {figure: psi}\n"
         "  - {figure: deflection, at_most: 1}\n  - {figure: tension, at_least: 1, set: innr}\n",
         {"5:23: at_leat: unknown key", "6:5: requirements.1.figure: is missing", "7:14" NO_BOUND(2),
          "8:14: requirements.3.figure: needs a section truss", "9:41" NO_SET(4, innr)}},
        {"load_cases: [{name: cold, temperature_K: -20, part: truss}, {name: warm, temperature_K: 5, set: innr}]\n"
         "cables: [{set: edg, expansion_per_K: 0}]\nrequirements: [{figure: tension, set: bundary, at_least: 1}]\n",
         {"5:16: cables.0.set: this net has no cable set 'edg'", "6:39" NO_SET(0, bundary)}},
        {"load_cases: [{name: cold, temperature_K: -20, part: truss}, {name: warm, temperature_K: 5, set: innr}]\n"
         "cables: [{expansion_per_K: 0}]\nrequirements: [{figure: tension, set: bundary, at_least: 1}]\n",
         {"4:53: load_cases.0.part: the case has no truss", "4:97: load_cases.1.set: this net has no cable set 'innr'",
          "6:39" NO_SET(0, bundary)}},
        {"surface: {frequencies_Hz: [1e9], pattern: {feed: {position_m: [0, 0, -3]}}}\n"
         "requirements: [{figure: tension, set: innr, at_least: 1}]\n",
         {"4:63: surface.pattern.feed.position_m: from (0, 0, -3) m", "5:39" NO_SET(0, innr)}},
        {"cables: [{expansion_per_K: 0}]\nload_cases: [{name: windy, force_N: [0, 0, -1]}]\n"
         "tolerance: {sigma_cut_m: 1e-4, samples: 100, sigma_gravity_ratio: 0.1}\n"
         "requirements: [{figure: tension, set: innr, at_least: 1, load_case: windy, share: 0.9}]\n",
         {"4:28: cables.0.expansion_per_K: has no effect", "6:67: tolerance.sigma_gravity_ratio: no load case has",
          "7:39" NO_SET(0, innr)}},
        /* what would follow from a misspelt section, list or word is left out */
        {"tolerence: {sigma_cut_m: 1e-4}\nrequirements: [{figure: psi, at_most: 1, share: 0.9}, {figure: psi}]\n",
         {"4:1: tolerence: unknown key", "5:64" NO_BOUND(1)}},
        {"load_cases: [{nam: cold, temperature_K: -20}]\ntolerance: {samples: many}\nsurface: 1\nrequirements:\n"
         "  - {figure: psi, at_most: 1, load_case: cold, share: 0.99}\n  - {figure: facets, at_most: 1}\n",
         {"4:15: nam: unknown key", "4:14: load_cases.0.name: is missing", "5:22: tolerance.samples: must be a whole",
          "6:1: surface: must be a section"}},
    };
    for (size_t k = 0; k < sizeof file / sizeof *file; k++) {
        const char *c = file_with("f.yaml", formatted("title: t\n" SMALL_SCENE "%s", file[k].text));
        for (int is_run = 0; is_run < 2; is_run++) {
            int n = 0;
            if (is_run)
                HIFDM(2, "run", c, "--set", EA, NOWHERE);
            else
                HIFDM(2, "check", c, "--set", EA);
            for (; file[k].fault[n]; n++)
                ERRS("f.yaml:%s", file[k].fault[n]);
            ck_assert_msg(count_of(said.err, "error: ") == n, "file %zu:\n%s", k, said.err);
        }
    }
    /* one fault of the net leaves the rows to be checked, and is itself reported once */
    HIFDM(2, "check",
          file_with("f.yaml", "title: t\n" SMALL_SCENE "load_cases: [{name: windy, force_N: [0, 0, -1]}]\n" SAMPLES
                              "requirements: [{figure: tension, set: innr, at_least: 1, share: 0.9}]\n"));
    ERR("f.yaml:4:21: load_cases.0.name: 58 cables have no stiffness EA");
    ERR("f.yaml:6:39" NO_SET(0, innr));
    ck_assert_int_eq(count_of(said.err, "error: "), 2);
}
END_TEST

/* Rows that look alike and still are different requirements. */
START_TEST(rows_that_differ_are_accepted)
{
    HIFDM(0, "check",
          file_with("c.yaml", formatted(BUILT_SCENE TOLERANCE LOADS ROWS
                                        "  - {figure: tension, at_least: 1}\n"
                                        "  - {figure: tension, at_most: 90}\n"
                                        "  - {figure: tension, at_least: 1, set: inner}\n"
                                        "  - {figure: tension, at_least: 2, share: 0.9}\n"
                                        "  - {figure: tension, at_least: 3, share: 0.5}\n"
                                        "  - {figure: tension, at_least: 2, load_case: all}\n"
                                        "  - {figure: tension, at_least: 2, load_case: cold, share: 0.9}\n",
                                        100)));
    OUT("valid");
    OUT("s a net in 2 load cases (the first "); /* those that rows with a share need, of three */
}
END_TEST

START_TEST(check_counts_the_rows_that_constrain)
{
    const char *c = file_with("c.yaml", BUILT_SCENE ROWS "  - {figure: tension, at_least: 1}\n"
                                                         "  - {figure: psi, at_most: 1, search: off}\n"
                                                         "  - {figure: slack_cables, at_least: 0}\n"
                                                         "  - {figure: loose_nodes, at_most: 0}\n"
                                                         "  - {figure: slack_cables, at_most: 0}\n");
    HIFDM(0, "check", c, "--set", "optimize.method=lm");
    OUT("\n                requirements: 2 of 5 rows constrain the optimisation; not requirements.1 (search: off), "
        "requirements.2 (slack_cables without at_most), requirements.3 (loose_nodes never constrains)\n");
    HIFDM(0, "check", c);
    ck_assert_ptr_null(strstr(said.out, "constrain"));
    HIFDM(0, "check", file_with("d.yaml", BUILT_SCENE "requirements: [{figure: psi, at_most: 1}]\noptimize: {}\n"));
    OUT("\n                requirements: 1 of 1 row constrains the optimisation\n");
}
END_TEST

START_TEST(a_run_without_a_design_names_the_row)
{
    const char *c = file_with("c.yaml", BUILT_SCENE ROWS "  - {figure: loose_nodes, at_most: 0}\n"
                                                         "  - {figure: tension, set: inner, at_least: 500}\n" SMALL_GA);
    HIFDM(3, "run", c, NOWHERE);
    ERR("; of the nearest design, the bound of requirements.1 (tension of inner) is missed by 490 N. Loosen the "
        "limits");
    HIFDM(3, "run", c, NOWHERE, "--set", "optimize.method=lm", "--restart");
    ERR("breaks a limit or a requirement: bound of requirements.1 (tension of inner) is missed by 490 N");
}
END_TEST

/* A row for several sets has the worst cable of any of them. The order of the names does not matter. */
START_TEST(a_row_for_several_sets_is_about_their_union)
{
    const char *c = file_with("c.yaml",
                              formatted(BUILT_SCENE TOLERANCE ROWS
                                        "  - {figure: tension, set: [directrix, edge], at_least: 1}\n"
                                        "  - {figure: tension, set: directrix, at_least: 1}\n"
                                        "  - {figure: tension, set: edge, at_least: 1}\n"
                                        "  - {figure: ratio, set: [edge, inner, directrix], at_most: 9}\n"
                                        "  - {figure: tension, set: [edge, directrix], at_least: 1, share: 0.5}\n"
                                        "  - {figure: tension, set: [directrix, edge], at_least: 1, share: 0.9}\n"
                                        "  - {figure: tension, set: directrix, at_least: 1, share: 0.5}\n"
                                        "  - {figure: tension, set: edge, at_least: 1, share: 0.5}\n",
                                        50)),
               *path = temp("a.h5");
    HIFDM(0, "run", c, "-o", path, "--json");
    EXPECT(out_as("a.json"), path, "--", "[r['set'] for r in a['requirements']][:1] == ['directrix+edge']",
           "a['requirements'][0]['value'] == min(r['value'] for r in a['requirements'][1:3])",
           "a['requirements'][0]['worst_item'] in [r['worst_item'] for r in a['requirements'][1:3]]",
           "[r['value'] for r in a['requirements'][1:3]] != [a['requirements'][0]['value']] * 2",
           "(b['tolerance/load_case/nominal/tension_min_directrix+edge'][:] == "
           "np.minimum(b['tolerance/load_case/nominal/tension_min_directrix'][:], "
           "b['tolerance/load_case/nominal/tension_min_edge'][:])).all()",
           "'tension_min_edge+directrix' not in b['tolerance/load_case/nominal']");
    OUT("\"figure\": \"ratio\", \"set\": \"directrix+edge+inner\"");
    HIFDM(0, "report", path, "-o", temp("a.html"));
    EXPECT(temp("a.html"), "--", "a.count(b'\"bound\":\"at_least\"') == 4"); /* a curve of each share */
    HIFDM(0, "check", c, "--set", "optimize.limits=[{figure: ratio, set: [directrix, edge], bounds: [1, 9]}]", "--set",
          "optimize.objective=[{figure: evenness, set: [directrix, edge]}]", "--set",
          "optimize.variables=[{set: [directrix, edge], vary: tension, range: 1}]");
    OUT("variables.0: tension of directrix+edge: ");
    OUT("objective.0: evenness of directrix+edge, ");
    OUT("limits.0: ratio of directrix+edge, bounds 1 .. 9");
    static const char *const fault[][2] = {{"[edge, edg]", "this net has no cable set 'edg'; did you mean 'edge'?"},
                                           {"[edge, [inner]]", "must be a list of names, like [front, rear]"},
                                           {"[]", "must be a text"},
                                           {"{}", "must be a text"},
                                           {"[edge, '']", "must be a list of names, like [front, rear]"},
                                           {"[edge, ed ge]", "must be made of letters, digits, _ and -"},
                                           {"edge+", "must be made of letters, digits, _ and -"},
                                           {"[an_abundance_of_words_without_a_meaning, as_long_as_a_name_may_be]",
                                            "the names must have at most 63 letters together"}};
    for (size_t k = 0; k < sizeof fault / sizeof *fault; k++) {
        HIFDM(2, "check", c, "--set", formatted("requirements.0.set=%s", fault[k][0]));
        ERRS("requirements.0.set: %s", fault[k][1]);
        ck_assert_msg(count_of(said.err, "error: ") == 1, "%s", said.err);
    }
    const char *study = file_with("s.yaml", "base: c.yaml\nsweep:\n  requirements.2.set: [edge, [edge, inner]]\n"),
               *folder = temp("s.d"), *merged = temp("m.h5");
    HIFDM(0, "sweep", study, "--dir", folder, "--quiet");
    HIFDM(0, "merge", study, "--dir", folder, "-o", merged, "--quiet");
    EXPECT(path, merged, "--", "b['points/requirements/value'][0][2] == a['requirements/value'][2]",
           "b['points/requirements/value'][1][2] < a['requirements/value'][2]");
    static const char *const clash[][2] = {{"[directrix, inner]", "directrix"}, {"directrix", "[inner, directrix]"}};
    for (int i = 0; i < 2; i++) {
        HIFDM(2, "check",
              file_with("d.yaml", formatted(BUILT_SCENE TOLERANCE ROWS "  - {figure: tension, set: %s, at_least: 20}\n"
                                                                       "  - {figure: tension, set: %s, at_most: 5}\n",
                                            50, clash[i][0], clash[i][1])));
        ERR("requirements.1.figure: contradicts requirements.0: no value meets both rows");
    }
    HIFDM(2, "check",
          file_with("d.yaml", formatted(BUILT_SCENE TOLERANCE ROWS
                                        "  - {figure: tension, set: [edge, inner], at_least: 2}\n"
                                        "  - {figure: tension, set: [inner, edge, inner], at_least: 3}\n",
                                        50)));
    ERR("is bounded by requirements.0 already");
}
END_TEST

/* ---- verdicts ---- */

#define MIXED                                                                                                          \
    "surface: {}\n" LOADS ROWS "  - {figure: tension, set: boundary, at_least: 1, load_case: all}\n"                   \
    "  - {figure: tension, within: [0.1, 500], load_case: all, share: 0.95}\n"                                         \
    "  - {figure: ratio, set: inner, at_most: 30, share: 0.5}\n"                                                       \
    "  - {figure: slack_cables, at_most: 3, load_case: cold, share: 0.5}\n"                                            \
    "  - {figure: loose_nodes, at_most: 0, load_case: windy, share: 0.9}\n"                                            \
    "  - {figure: psi, at_most: 0.01}\n"                                                                               \
    "  - {figure: facets, at_most: 0.5, load_case: all}\n"                                                             \
    "  - {figure: surface, at_most: 0.5, feed: fixed, load_case: all, share: 0.9}\n"                                   \
    "  - {figure: mass, at_most: 1}\n"                                                                                 \
    "  - {figure: pull, at_most: 200, load_case: all}\n"

static const char *mixed_case(int samples)
{
    return file_with("c.yaml", formatted(BUILT_SCENE TOLERANCE MIXED, samples));
}

/* Copies the part of the output above the summary, which is the verdict. */
static const char *verdict_of(const char *name)
{
    const char *end = strstr(said.out, "\npsi ");
    ck_assert_msg(end && strncmp(said.out, "verdict: ", 9) == 0, "%s", said.out);
    char *text = strndup(said.out, (size_t)(end - said.out));
    const char *path = file_with(name, text);
    free(text);
    return path;
}

/* Failed and undecided rows stand first, then five that pass, by relative margin. */
START_TEST(a_run_begins_with_its_verdict)
{
    const char *c = mixed_case(100), *path = temp("a.h5");
    HIFDM(0, "run", c, "-o", path);
    const char *run = verdict_of("run.txt");
    OUT("verdict: fail; 8 of 10 requirements pass, 1 fails, 1 undecided\n  fail          psi       ");
    OUT(" 39.27 mm  at most 10 mm ");
    OUT(" margin -29.27 mm (-293 %)\n  undecided     tension, all load cases, 95 % of samples ");
    OUT(" 0.1 to 500 N ");
    OUT(" % of samples meet it (");
    OUT("; worst: n4_0, cold\n");
    OUT("worst: infinite in sample ");
    OUT("                3 more rows: --verbose shows them\npsi ");
    ck_assert_int_eq(count_of(said.out, "\n  pass   "), 5);
    ck_assert(strstr(said.out, "(+27") == NULL || strstr(said.out, "(+43") > strstr(said.out, "(+27"));
    HIFDM(0, "show", path);
    const char *show = verdict_of("show.txt");
    HIFDM(0, "run", c, "-o", path);
    ERR("is the finished result of this case");
    EXPECT(run, show, verdict_of("again.txt"), "--", "a == b == c");
    HIFDM(0, "show", path, "--verbose");
    ck_assert_int_eq(count_of(said.out, "\n  pass   "), 8);
    ck_assert_ptr_null(strstr(said.out, "--verbose shows them"));
}
END_TEST

START_TEST(json_and_file_have_all_rows)
{
    const char *c = mixed_case(100), *path = temp("a.h5");
    HIFDM(0, "run", c, "-o", path, "--json");
    const char *run = out_as("run.json");
    HIFDM(0, "show", path, "--json");
    EXPECT(run, out_as("show.json"), path, "--", "a['requirements'] == b['requirements']", "a['verdict'] == 'fail'",
           "[r['verdict'] for r in a['requirements']] == ['pass', 'undecided', 'pass', 'pass', 'pass', 'fail', 'pass', "
           "'pass', 'pass', 'pass']",
           "[r['figure'] for r in a['requirements']] == texts(c['requirements/figure'])",
           "all(r['margin'] == c['requirements/margin'][i] for i, r in enumerate(a['requirements']))",
           "a['requirements'][1]['at_least'] == 0.1 and a['requirements'][1]['at_most'] == 500",
           "[r['share'] for r in a['requirements']][:5] == [None, 0.95, 0.5, 0.5, 0.9]",
           "a['requirements'][5]['error_bound'] < 1e-9 and a['requirements'][1]['error_bound'] is None",
           "a['requirements'][5]['worst_sample'] == -1 and a['requirements'][1]['worst_sample'] >= 0",
           "a['requirements'][4]['relative_margin'] is None and a['requirements'][4]['yield'] < 1",
           "all([r[k] for r in a['requirements']] == texts(c['requirements'][k]) for k in ['set', 'load_case', 'feed', "
           "'verdict', 'worst_load_case', 'worst_item'])", /* with no byte behind the end of a text */
           "sorted(c['tolerance/load_case']) == ['cold', 'nominal', 'windy']",
           "sorted(c['tolerance/load_case/windy']) == ['loose_nodes', 'surface_fixed', 'tension_max', "
           "'tension_max_cable', 'tension_min', 'tension_min_cable']",
           "sorted(c['tolerance/load_case/cold']) == ['slack_cables', 'surface_fixed', 'tension_max', "
           "'tension_max_cable', 'tension_min', 'tension_min_cable']",
           "(c['tolerance/load_case/nominal/tension_min'][:] == c['tolerance/sample/tension_min_N'][:]).all()",
           "(c['tolerance/load_case/nominal/surface_fixed'][:] == c['tolerance/sample/half_path_rms_m'][:]).all()");
}
END_TEST

/* A bound at the value itself: no numerical error and no number of samples decides it. */
START_TEST(a_bound_at_the_value_is_undecided)
{
    const char *text = BUILT_SCENE "tolerance: {sigma_cut_m: 1e-4, samples: 200}\n" ROWS
                                   "  - {figure: psi, at_most: %.17g}\n  - {figure: tension, at_least: %.17g, share: "
                                   "0.75}\n",
               *path = temp("a.h5");
    HIFDM(0, "run", file_with("c.yaml", formatted(text, 1.0, 1.0)), "-o", path, "--json");
    double psi_m = number_after("\"figure\": \"psi\", \"set\": \"\", \"feed\": \"\", "
                                "\"frequency_Hz\": null, \"load_case\": \"nominal\", \"at_least\": null, \"at_most\": "
                                "1, \"share\": null, \"unit\": \"m\", "
                                "\"value\": "),
           quantile_N = number_after("\"share\": 0.75, \"unit\": \"N\", \"value\": ");
    HIFDM(0, "run", file_with("c.yaml", formatted(text, psi_m, quantile_N)), "-o", path, "--restart", "--strict");
    OUT("verdict: undecided; 0 of 2 requirements pass, 2 undecided\n");
    OUT("; the value is certified to ");
    OUT("; 75 % of samples meet it (");
    OUT(" margin +0 N (+0 %)");
    HIFDM(0, "run", file_with("c.yaml", formatted(text, psi_m * (1 + 1e-9), quantile_N / 2)), "-o", path, "--restart",
          "--strict");
    OUT("verdict: pass; 2 of 2 requirements pass\n");
    HIFDM(6, "run", file_with("c.yaml", formatted(text, psi_m * (1 - 1e-9), quantile_N)), "-o", path, "--restart",
          "--strict");
    OUT("verdict: fail; 0 of 2 requirements pass, 1 fails, 1 undecided\n");
}
END_TEST

/* Samples almost without errors have the figures of the nominal net, in each load case and with each feed. */
START_TEST(samples_without_errors_radiate_like_the_nominal_net)
{
    static const char *const row[] = {"gain", "gain, feed: fixed", "gain_loss", "gain_loss, feed: fixed", "pointing"},
                             *const load_case[] = {"nominal", "cold", "windy"};
    enum { N = sizeof row / sizeof *row };
    char text[8192];
    int n = snprintf(text, sizeof text,
                     BUILT_SCENE "tolerance: {sigma_cut_m: 1e-10, samples: 20}\n"
                                 "surface: {frequencies_Hz: [1e9]}\n" LOADS ROWS);
    for (int i = 0; i < N; i++)
        for (int k = 0; k < 6; k++)
            n += snprintf(text + n, sizeof text - (size_t)n,
                          "  - {figure: %s, at_most: 1000, load_case: %s, frequency_Hz: %g%s}\n", row[i],
                          load_case[k / 2], 5e8 * (1 + i % 2), k % 2 ? ", share: 0.5" : "");
    HIFDM(0, "run", file_with("c.yaml", text), "-o", temp("a.h5"), "--json");
    const char *at = strstr(said.out, "\"requirements\": [");
    ck_assert_ptr_nonnull(at);
    for (int i = 0; i < 3 * N; i++) {
        double value[2];
        for (int k = 0; k < 2; k++) {
            at = strstr(at, "\"value\": ") + strlen("\"value\": ");
            value[k] = strtod(at, NULL);
        }
        ck_assert_msg(fabs(value[1] - value[0]) < 1e-6, "%s, %s: %.9g, not %.9g", row[i / 3], load_case[i % 3],
                      value[1], value[0]);
    }
}
END_TEST

/* Exit status 6 for a row that fails, also if the result was finished before; the result file is complete. */
START_TEST(strict_ends_with_its_own_status)
{
    const char *text = BUILT_SCENE "tolerance: {sigma_cut_m: 1e-4, samples: 50}\n" ROWS
                                   "  - {figure: tension, at_least: 0.1, share: 0.5}\n"
                                   "  - {figure: tension, at_most: 99, share: 0.5}\n  - {figure: psi, at_most: %s}\n",
               *path = temp("a.h5"), *c = file_with("c.yaml", formatted(text, "1e-3"));
    HIFDM(6, "run", c, "-o", path, "--strict", "--quiet");
    ERR("error: the result fails 1 of 3 requirements");
    EXPECT(path, "--", "a.attrs['finished']", "texts(a['requirements/verdict']) == ['pass', 'pass', 'fail']");
    HIFDM(6, "run", c, "-o", path, "--strict", "--quiet");
    HIFDM(6, "tolerance", c, "-o", path, "--strict", "--quiet");
    HIFDM(0, "tolerance", c, "-o", path, "--quiet");
    HIFDM(0, "show", path);
    OUT("verdict: fail; ");
    HIFDM(0, "run", file_with("c.yaml", formatted(text, "1")), "-o", path, "--restart", "--strict", "--quiet");
    HIFDM(0, "run", c, "-o", path, "--strict", "--quiet");
    HIFDM(2, "run", file_with("d.yaml", BUILT_SCENE), "-o", temp("d.h5"), "--strict", "--quiet");
    ERR("d.yaml: --strict checks requirements, but the case has none. Add the list `requirements`");
    ck_assert(!is_there(temp("d.h5"))); /* it is refused before it runs */
    HIFDM(6, "run", file_with("c.yaml", formatted(text, "1e-3")), "-o", path, "--restart", "--strict", "--json");
    EXPECT(out_as("a.json"), "--", "a['status'] == 'requirement_failed' and a['finished'] and a['verdict'] == 'fail'",
           "a['errors'] == ['the result fails 1 of 3 requirements']");
}
END_TEST

/* Requirements add to a result and change nothing of it. */
START_TEST(a_case_without_requirements_keeps_its_result)
{
    const char *plain = file_with("p.yaml", formatted(BUILT_SCENE TOLERANCE "surface: {}\n" LOADS, 80)),
               *path = temp("p.h5"), *other = temp("c.h5");
    HIFDM(0, "run", plain, "-o", path);
    ck_assert_ptr_null(strstr(said.out, "verdict"));
    ck_assert_int_eq(strncmp(said.out, "psi ", 4), 0);
    HIFDM(0, "show", path, "--json");
    ck_assert_ptr_null(strstr(said.out, "verdict"));
    ck_assert_ptr_null(strstr(said.out, "requirements"));
    HIFDM(0, "run", mixed_case(80), "-o", other, "--quiet");
    EXPECT(
        path, other, "--", "'requirements' not in a and 'load_case' not in a['tolerance']", "'requirements' in b",
        "all(a['tolerance/sample'][k][:].tobytes() == b['tolerance/sample'][k][:].tobytes() for k in "
        "a['tolerance/sample'])",
        "sorted(a['tolerance/sample']) == sorted(b['tolerance/sample'])",
        "all(a['load_cases'][k]['position_m'][:].tobytes() == b['load_cases'][k]['position_m'][:].tobytes() for k in "
        "['cold', 'windy'])");
    HIFDM(0, "run",
          file_with("n.yaml", formatted(BUILT_SCENE TOLERANCE LOADS ROWS "  - {figure: psi, at_most: 1}\n", 50)), "-o",
          other, "--restart", "--quiet"); /* no row needs samples */
    EXPECT(other, "--", "'load_case' not in a['tolerance']", "texts(a['requirements/verdict']) == ['pass']");
}
END_TEST

/* A search changes the tensions that the laws demand: error bounds are those of the result. A search of a front has
 * the form-finding's net as its result. */
START_TEST(the_result_is_judged)
{
    const char *path = temp("a.h5"), *text = BUILT_SCENE
                                     "optimize: {method: lm, variables: [{set: inner, vary: tension, bounds: [4, 40]}]"
                                     "%s}\n" ROWS "  - {figure: psi, at_most: 1}\n"
                                     "  - {figure: tension, set: inner, at_most: 30}\n";
    HIFDM(0, "run", file_with("c.yaml", formatted(text, "")), "-o", path, "--quiet");
    EXPECT(path, "--", "near(a['requirements/value'][0], a['refine'].attrs['psi_m'], 1e-14)",
           "abs(a['requirements/value'][0] - a['form'].attrs['psi_m']) > 1e-6",
           "a['requirements/value'][1] == a['refine/tension_N'][:][a['scene/cable/group'][:] == 0].max()",
           "abs(a['requirements/value'][1] - 10) > 0.1", "a['requirements/error_bound'][1] < 1e-9");
    HIFDM(
        0, "run",
        file_with("c.yaml", formatted(text, ", front_points: 3, front: [{figure: psi}, {figure: ratio, set: inner}]")),
        "-o", path, "--quiet", "--restart");
    EXPECT(path, "--", "near(a['requirements/value'][0], a['form'].attrs['psi_m'], 1e-14)");
}
END_TEST

/* The initial design fails, and the same search without the requirement ends at a lower psi with a design that would
 * fail. A design that fails never becomes the result of the search while one passes, and the search keeps the best of
 * those that pass. */
START_TEST(generations_rank_by_requirements_first)
{
    const char *path = temp("a.h5"), *free_path = temp("free.h5");
    const char *text = BUILT_SCENE "optimize: {population: 20, generations: 30, seed: 3, method: %s}\n%s",
               *row = ROWS "  - {figure: tension, set: boundary, at_least: 25.1}\n";
    static const char *const method[] = {"ga", "ga+lm"};
    const char *c = file_with("free.yaml", formatted(text, method[_i], ""));
    HIFDM(0, "run", c, "-o", free_path, "--quiet");
    c = file_with("c.yaml", formatted(text, method[_i], row));
    HIFDM(0, "run", c, "-o", path, "--strict");
    OUT("verdict: pass; 1 of 1 requirements pass\n");
    EXPECT(path, free_path, "--", "a['search/population/trial_status'][0, 0] != 0",
           "b['search/tension_N'][:][b['scene/cable/group'][:] == 1].min() < 25.1",
           "b['search'].attrs['psi_m'] < a['search'].attrs['psi_m']",
           "a['search'].attrs['psi_m'] == a['search/population/trial_psi_m'][:]"
           "[a['search/population/trial_status'][:] == 0].min()");
}
END_TEST

/* A strut is no slack cable, and a set with a strut has no ratio. */
START_TEST(struts_are_not_slack)
{
    file_with("n.csv", "id,x_m,y_m,z_m,role\na,-1,0,0,support\nb,1,0,0,support\nc,0,1,0,support\nm,0,0.2,0,inner\n");
    file_with("e.csv", "id,i,j,group,law,value\np,a,m,inner,force_density,10\nq,b,m,inner,force_density,10\n"
                       "r,c,m,inner,force_density,-3\n");
    HIFDM(0, "run",
          file_with("c.yaml", "scene: {import: {nodes: n.csv, cables: e.csv}}\nrequirements:\n"
                              "  - {figure: slack_cables, at_most: 0}\n  - {figure: ratio, at_most: 1e3}\n"
                              "  - {figure: tension, at_least: -5}\n"),
          "-o", temp("a.h5"), "--json");
    EXPECT(out_as("a.json"), "--", "[r['verdict'] for r in a['requirements']] == ['pass', 'fail', 'pass']",
           "a['requirements'][1]['value'] is None", "a['requirements'][2]['worst_item'] == 'r'",
           "a['form']['slack_cables'] == 0");
}
END_TEST

/* A length or force a thousand times off its bound is probably in mm or kN. */
START_TEST(a_bound_in_another_unit_is_doubted)
{
    const char *text = BUILT_SCENE ROWS "  - {figure: psi, at_most: %s}\n  - {figure: tension, at_most: %s}\n"
                                        "  - {figure: slack_cables, at_most: 5}\n",
               *path = temp("a.h5");
    HIFDM(0, "run", file_with("c.yaml", formatted(text, "8", "30")), "-o", path);
    ERR("requirements.0.at_most: the bound 8 m (8000 mm) and the value 0.0392743 m (39.2743 mm) differ by a "
        "factor of 204. Check the unit of the bound");
    ck_assert_int_eq(count_of(said.err, "warning: "), 1);
    HIFDM(0, "run", file_with("c.yaml", formatted(text, "7", "0.02")), "-o", path, "--restart");
    ERR("requirements.1.at_most: the bound 0.02 N (20 mN) and the value 24.8329 N (24832.9 mN) differ by a");
    ck_assert_int_eq(count_of(said.err, "warning: "), 1);
    HIFDM(0, "run", file_with("c.yaml", formatted(text, "7", "0.13")), "-o", path, "--restart");
    ck_assert_str_eq(said.err, "");
    static const char *const within[][2] = {
        {"[5, 6e4]", ""}, {"[0.01, 30]", ""}, {"[0, 6e4]", "60000 N"}, {"[3e4, 6e4]", "30000 N"}};
    for (size_t k = 0; k < sizeof within / sizeof *within; k++) { /* the nearer bound decides, and 0 has no unit */
        HIFDM(0, "run",
              file_with("c.yaml", formatted(BUILT_SCENE ROWS "  - {figure: tension, within: %s}\n", within[k][0])),
              "-o", path, "--restart");
        ck_assert_int_eq(count_of(said.err, "requirements.0.within: the bound "), *within[k][1] != 0);
        ERR(within[k][1]);
    }
}
END_TEST

/* A study warns once about each such bound, with the value that is nearest to it; a value that is not far off is enough
 * to trust the bound. */
START_TEST(a_study_doubts_a_bound_once)
{
    static const char said_once[] = "warning: requirements.1: the bound 0.02 N (20 mN) and the nearest value of all "
                                    "points ";
    file_with("c.yaml", formatted(BUILT_SCENE ROWS "  - {figure: psi, at_most: 1}\n"
                                                   "  - {figure: tension, at_most: 0.02}\n"));
    const char *study = file_with("s.yaml", "base: c.yaml\nsweep: {form.pretension_N: [20, 10, 40], files: all}\n");
    HIFDM(0, "sweep", study, "--dir", temp("s.d"), "--quiet");
    ERR(said_once);
    ck_assert_int_eq(count_of(said.err, "warning: "), 1);
    HIFDM(0, "merge", study, "--dir", temp("s.d"), "-o", temp("s.h5"), "--quiet");
    ERR(said_once);
    ck_assert_int_eq(count_of(said.err, "warning: "), 1);
    const char *warned = file_with("err.txt", said.err);
    EXPECT(temp("s.h5"), warned, "--",
           "('value %.6g N' % a['points/requirements/value'][:, 1].min()).replace('value', 'points') in b.decode()");
    HIFDM(0, "sweep", file_with("t.yaml", "base: c.yaml\nsweep: {requirements.1.at_most: [0.02, 20]}\n"), "--dir",
          temp("t.d"), "--quiet");
    ck_assert_str_eq(said.err, "");
}
END_TEST

/* ---- load cases ---- */

/* A net without a shape in a load case meets no row there, with and without a share. The other load cases have
 * verdicts. */
START_TEST(a_load_case_without_a_shape_fails_its_rows)
{
    const char *c =
        file_with("c.yaml", BUILT_SCENE "form: {method: fdm, max_iterations: 20}\nload_cases:\n"
                                        "  - {name: far, support_displacement_m: [0, 0, 0], force_N: [1e4, 1e4, 1e5]}\n"
                                        "  - {name: still, support_displacement_m: [0, 0, 0]}\n"
                                        "tolerance: {sigma_cut_m: 1e-5, samples: 50}\n" ROWS
                                        "  - {figure: psi, at_most: 1e6, load_case: far}\n"
                                        "  - {figure: psi, at_most: 1e6, load_case: all, share: 0.5}\n"
                                        "  - {figure: psi, at_most: 1, load_case: still}\n"
                                        "  - {figure: psi, at_most: 1, load_case: still, share: 0.5}\n");
    HIFDM(6, "run", c, "-o", temp("a.h5"), "--strict");
    ERR("no equilibrium was found in load case 'far': ");
    OUT("verdict: fail; 2 of 4 requirements pass, 2 fail\n");
    HIFDM(0, "show", temp("a.h5"), "--json");
    EXPECT(out_as("a.json"), temp("a.h5"), "--",
           "[r['verdict'] for r in a['requirements']] == ['fail', 'fail', 'pass', 'pass']",
           "all(r['value'] is None and r['worst_load_case'] == 'far' for r in a['requirements'][:2])",
           "a['requirements'][1]['yield'] == 0", "a['requirements'][3]['yield'] == 1",
           "np.isnan(b['tolerance/load_case/far/psi'][:]).all()",
           "np.isfinite(b['tolerance/load_case/still/psi'][:]).all()");
}
END_TEST

/* ---- the same bits ---- */

static const char *sampled_case(const char *sampling)
{
    return file_with(
        "c.yaml",
        formatted(BUILT_SCENE LOADS
                  "tolerance: {sigma_cut_m: 1e-4, sigma_support_m: 2e-5, sigma_EA_ratio: 0.01, "
                  "sigma_force_ratio: 0.1, sigma_load_case_temperature_K: 2, samples: 600, sampling: %s}\n" ROWS
                  "  - {figure: tension, within: [0.1, 90], load_case: all, share: 0.9}\n"
                  "  - {figure: psi, at_most: 0.04, load_case: all, share: 0.5}\n"
                  "  - {figure: slack_cables, at_most: 0, share: 0.5}\n",
                  sampling));
}

static void demand_same(const char *path, const char *whole)
{
    EXPECT(path, whole, "--",
           "all(a['tolerance/load_case'][s][k][:].tobytes() == b['tolerance/load_case'][s][k][:].tobytes() for s in "
           "b['tolerance/load_case'] for k in b['tolerance/load_case'][s])",
           "all(a['tolerance/sample'][k][:].tobytes() == b['tolerance/sample'][k][:].tobytes() for k in "
           "b['tolerance/sample'])",
           "all(a['requirements'][k][:].tobytes() == b['requirements'][k][:].tobytes() for k in b['requirements'])",
           "sorted(a['tolerance/load_case']) == ['cold', 'nominal', 'windy']",
           "len(a['tolerance/load_case/cold/psi']) == 600", "(a['tolerance/sample/n_slack'][:] > 0).any()");
}

/* By one thread, by three, and by three tasks of which one never ran. */
START_TEST(threads_and_tasks_change_nothing)
{
    const char *c = sampled_case(_i ? "sobol" : "random"), *whole = temp("a.h5"), *path = temp("b.h5");
    HIFDM(0, "tolerance", c, "-o", whole, "--threads", "1", "--quiet");
    HIFDM(0, "run", c, "-o", path, "--threads", "3", "--quiet");
    demand_same(path, whole);
    path = temp("c.h5");
    HIFDM(0, "tolerance", c, "-o", path, "--task", "0", "--tasks", "3", "--quiet");
    HIFDM(0, "tolerance", c, "-o", path, "--task", "2", "--tasks", "3", "--quiet", "--strict");
    ck_assert(!is_there(path));
    HIFDM(0, "tolerance", c, "-o", path, "--tasks", "3", "--quiet");
    demand_same(path, whole);
    SHELL(0, "test \"$(ls \"$1\"*)\" = \"$1\"", path); /* no journals are left */
}
END_TEST

/* Errors of load cases have random numbers of their own: all other errors keep their bits, and so do load cases without
 * such an error. */
START_TEST(errors_of_load_cases_change_nothing_else)
{
    const char *c = sampled_case(_i ? "sobol" : "random"), *whole = temp("a.h5"), *path = temp("b.h5");
    HIFDM(0, "tolerance", c, "-o", whole, "--quiet");
    HIFDM(0, "tolerance", c, "-o", path, "--quiet", "--set", "tolerance.sigma_load_case_temperature_K=0");
    EXPECT(path, whole, "--",
           "all(a['tolerance/sample'][k][:].tobytes() == b['tolerance/sample'][k][:].tobytes() for k in "
           "b['tolerance/sample'])",
           "a['tolerance/load_case/windy/psi'][:].tobytes() == b['tolerance/load_case/windy/psi'][:].tobytes()",
           "(a['tolerance/load_case/cold/psi'][:] != b['tolerance/load_case/cold/psi'][:]).all()",
           "'temperature_error_K' not in a['tolerance/load_case/cold']",
           "sorted(k for k in b['tolerance/load_case/windy'] if 'error' in k) == ['force_error_ratio']",
           "abs(b['tolerance/load_case/cold/temperature_error_K'][:].std() - 2) < 0.2",
           "abs(b['tolerance/load_case/windy/force_error_ratio'][:].std() - 0.1) < 0.01");
}
END_TEST

/* Killed after a few changes in its folder, and resumed: the same bits. */
START_TEST(killed_runs_resume)
{
    const char *c = sampled_case("random"), *whole = temp("a.h5");
    HIFDM(0, "tolerance", c, "-o", whole, "--quiet");
    demand_same(sample_with_kills(c, 3), whole);
}
END_TEST

/* Samples of other requirements have other figures. */
START_TEST(samples_of_other_requirements_are_not_used)
{
    const char *text = BUILT_SCENE "tolerance: {sigma_cut_m: 1e-4, samples: 300}\n" ROWS "  - {figure: %s}\n",
               *path = temp("a.h5");
    HIFDM(0, "tolerance", file_with("c.yaml", formatted(text, "psi, at_most: 1, share: 0.5")), "-o", path, "--task",
          "0", "--tasks", "2", "--quiet");
    HIFDM(5, "tolerance", file_with("c.yaml", formatted(text, "pull, at_most: 50, share: 0.5")), "-o", path, "--tasks",
          "2", "--quiet");
    ERR("has samples of another case");
    HIFDM(0, "tolerance", temp("c.yaml"), "-o", path, "--tasks", "2", "--quiet", "--restart");
    EXPECT(path, "--", "list(a['tolerance/load_case/nominal']) == ['pull']");
}
END_TEST

/* Below the verdicts stand at most 12 lines, with everything that a run can compute, and with a front. */
START_TEST(a_summary_below_verdicts_is_short)
{
    enum { FRONT = 1 };
    static const char *const search[] = {
        "  objective: [{figure: psi}]\n  population: 6\n  generations: 2\n  refine: true\n",
        "  method: lm\n  front: [{figure: psi}, {figure: pull}]\n",
    };
    const char *c = file_with(
        "c.yaml",
        formatted("title: everything\nscene:\n  paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 3, "
                  "rear_distance_m: 1.8}\n  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\nform: {pretension_N: 30, prestress: "
                  "exact}\n"
                  "truss: {expansion_per_K: 1e-6, ring: {cells_per_bay: 2, bracing: single, held: bay, longeron: "
                  "{diameter_m: 0.03, wall_m: "
                  "0.001}}}\nsurface: {frequencies_Hz: [2e9, 8e9], pattern: {phi_deg: [0, 90]}}\n" LOADS TOLERANCE
                  "optimize:\n  variables: [{set: tie, vary: force_density, range: 20 %%}]\n%s" ROWS
                  "  - {figure: psi, at_most: 1e-6, search: off}\n  - {figure: tension, at_least: 0.1, load_case: all, "
                  "share: 0.5, search: off}\n",
                  100, search[_i]));
    HIFDM(0, "run", c, "-o", temp("a.h5"), "--set", "tolerance.find_scale=true");
    OUT("verdict: ");
    if (_i == FRONT) { /* its points have verdicts, and load cases and samples are those of no point */
        OUT(" of 21 points of the front pass, ");
        ck_assert(!strstr(said.out, "worst of 2: psi") && !strstr(said.out, "as built"));
    } else {
        OUT("\n  load cases    worst of 2: psi ");
        OUT("samples that meet all rows with a share; the required shares hold up to ");
    }
    const char *below = said.out;
    for (int row = 0; row < (_i == FRONT ? 1 : 3); row++) /* the verdict and its two rows */
        below = strchr(below, '\n') + 1;
    ck_assert_msg(count_of(below, "\n") <= 12, "%s", below);
    HIFDM(0, "show", temp("a.h5"), "--verbose");
    OUT("\n  load cases    as-built net ");
    OUT("\n                windy ");
}
END_TEST

/* A study runs cases with requirements, too. */
START_TEST(points_of_a_study_have_verdicts)
{
    mixed_case(80);
    const char *study = file_with("s.yaml", "base: c.yaml\nsweep:\n  form.pretension_N: [10, 20]\n"),
               *folder = temp("s.d"), *merged = temp("m.h5"), *alone = temp("a.h5");
    HIFDM(0, "sweep", study, "--dir", folder, "--quiet");
    HIFDM(0, "merge", study, "--dir", folder, "-o", merged);
    HIFDM(0, "run", temp("c.yaml"), "-o", alone, "--quiet", "--set", "form.pretension_N=20");
    EXPECT(alone, merged, "--", "b['points/tolerance/psi_95_m'][1] == a['tolerance'].attrs['psi_95_m']");
}
END_TEST

/* Slack cables have no derivatives that lead out, but a higher pretension does. No objective prefers one pretension to
 * another here, so the result is the one with the largest margin of those that were tried. */
START_TEST(a_slack_start_is_scaled_into_the_requirements)
{
    static const char *const link[] = {"scale", "each"};
    const char *dish = source_path("configs/dish-8m.yaml"), *path = temp("a.h5");
    const char *set = formatted("optimize.variables.0.link=%s", link[_i]);
    HIFDM(0, "run", dish, "-o", path, "--quiet", "--json", "--set", "scene.paraboloid.rings=4", "--set", keep(set),
          "--set", "form.pretension_N=5", "--set", "tolerance.samples=100", "--set",
          "requirements=[{figure: tension, within: [2, 60], load_case: all, share: 0.95}, "
          "{figure: slack_cables, at_most: 0, load_case: all}]");
    EXPECT(out_as("run.json"), path, "--", "a['verdict'] == 'pass'", "a['refine']['stop_reason'] == 'converged'",
           "a['refine']['steps'] == 1", "min(r['relative_margin'] for r in a['requirements'][:1]) > 0.1",
           "b['/form/tension_N'][:].min() < 2");
}
END_TEST

/* If no design is feasible, the verdicts show what the net after form-finding lacks. They are those of a run that does
 * not optimise. */
START_TEST(a_failed_search_leaves_verdicts)
{
    static const char *const method[] = {"lm", "ga"};
    const char *dish = source_path("configs/dish-8m.yaml"), *path = temp("a.h5"), *plain = temp("b.h5");
#define LACKS                                                                                                          \
    "--quiet", "--set", "scene.paraboloid.rings=4", "--set", "form.pretension_N=5", "--set", "tolerance.samples=50",   \
        "--set",                                                                                                       \
        "requirements=[{figure: tension, within: [2, 60], load_case: all, share: 0.9}, "                               \
        "{figure: facets, at_most: 2.5e-3}]"
    const char *set = keep(formatted("optimize.method=%s", method[_i]));
    HIFDM(3, "run", dish, "-o", path, LACKS, "--set", set, "--set", "optimize.population=8", "--set",
          "optimize.generations=2");
    ERR("error: optimize: ");
    ERR("requirements.1: at the target positions, the facets already have ");
    if (_i == 0) ERR("at the nearest design, which scales variables by ");
    SHELL(0, "sed '/^optimize:/,$d' \"$1\" >\"$2\"", dish, temp("plain.yaml"));
    HIFDM(0, "run", temp("plain.yaml"), "-o", plain, LACKS);
    HIFDM(0, "show", plain, "--json");
    const char *expected = out_as("plain.json");
    HIFDM(0, "show", path, "--json");
    EXPECT(out_as("failed.json"), expected, "--", "a['status'] == 'no_feasible'", "a['verdict'] == 'fail'",
           "len(a['load_cases']) == 2",
           "[r | {'error_bound': 0} for r in a['requirements']] == [r | {'error_bound': 0} for r in b['requirements']]",
           "a['requirements'][0]['error_bound'] is b['requirements'][0]['error_bound'] is None",
           "abs(a['requirements'][1]['error_bound'] / b['requirements'][1]['error_bound'] - 1) < 1e-3");
    HIFDM(0, "show", path);
    OUT("verdict: fail; 0 of 2 requirements pass, 2 fail; of the net after form-finding\n");
}
END_TEST

/* The error of facets is in proportion to their area: as many facets as advised reach the bound, within 10 %. */
START_TEST(facets_too_large_for_a_bound_are_reported)
{
    static const char facets[] = "requirements=[{figure: facets, at_most: %g, feed: %s}]";
    const char *dish = source_path("configs/dish-8m.yaml");
    const char *const feed[] = {"refocused", "fixed"};
    const double bound_m[] = {0.43e-3, 1.66e-3}; /* 10 rings, 600 facets: 0.43 and 1.652 mm */
    for (int k = 0; k < 2; k++) {
        double has_mm, most_mm, n_facet;
        HIFDM(0, "check", dish, "--set", "scene.paraboloid.rings=5", "--set",
              keep(formatted(facets, bound_m[k], feed[k])));
        const char *said_so = strstr(said.err, "requirements.0: at the target positions, the facets already have ");
        ck_assert_msg(said_so != NULL, "%s", said.err);
        ck_assert_int_eq(sscanf(strstr(said_so, "have "), "have %lf mm, and the bound is %lf mm. Use about %lf facets",
                                &has_mm, &most_mm, &n_facet),
                         3);
        ck_assert(has_mm > most_mm && fabs(n_facet - 600) < 60);
        HIFDM(0, "check", dish, "--set", "scene.paraboloid.rings=11", "--set",
              keep(formatted(facets, bound_m[k], feed[k])));
        ck_assert_ptr_null(strstr(said.err, "the facets already have"));
    }
}
END_TEST

/* A doubt about the case is printed before the run computes, not after hours. */
START_TEST(warnings_come_at_once)
{
    const char *c = file_with("c.yaml", BUILT_SCENE "optimize: {method: lm, variables: [{set: inner, vary: "
                                                    "force_density, bounds: [1e3, 1e6], link: set}]}\n");
    SHELL(0, "exec \"$0\" run \"$1\" -o \"$2\" 2>&1", c, temp("a.h5"));
    const char *warning = strstr(said.out, "warning: "), *end = strstr(said.out, "  results  ");
    ck_assert_msg(warning && end && warning < end, "%s", said.out);
}
END_TEST

START_TEST(bounds_that_exclude_the_start_are_reported)
{
    const char *text = BUILT_SCENE "optimize: {method: lm, variables: [{set: inner, vary: force_density, bounds: "
                                   "[%s, 1e6], link: set}]}\n";
    HIFDM(0, "check", file_with("c.yaml", formatted(text, "1e3")));
    ERR("optimize.variables.0.bounds: the search starts at another shape, because ");
    ERR(" values after form-finding are outside these bounds. The values are from ");
    HIFDM(0, "check", file_with("c.yaml", formatted(text, "1e-3")));
    ck_assert_ptr_null(strstr(said.err, "another shape"));
}
END_TEST

Suite *suite_cli_requirements(void)
{
    Suite *suite = suite_create("cli/requirements");
    TCase *tests = tcase_create("requirements");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, faults_are_named);
    tcase_add_test(tests, all_faults_are_reported_at_once);
    tcase_add_test(tests, rows_that_differ_are_accepted);
    tcase_add_test(tests, check_counts_the_rows_that_constrain);
    tcase_add_test(tests, a_run_without_a_design_names_the_row);
    tcase_add_test(tests, a_row_for_several_sets_is_about_their_union);
    tcase_add_test(tests, a_run_begins_with_its_verdict);
    tcase_add_test(tests, json_and_file_have_all_rows);
    tcase_add_test(tests, a_bound_at_the_value_is_undecided);
    tcase_add_test(tests, samples_without_errors_radiate_like_the_nominal_net);
    tcase_add_test(tests, strict_ends_with_its_own_status);
    tcase_add_test(tests, a_case_without_requirements_keeps_its_result);
    tcase_add_test(tests, the_result_is_judged);
    tcase_add_loop_test(tests, generations_rank_by_requirements_first, 0, 2);
    tcase_add_test(tests, struts_are_not_slack);
    tcase_add_test(tests, a_bound_in_another_unit_is_doubted);
    tcase_add_test(tests, a_study_doubts_a_bound_once);
    tcase_add_test(tests, a_load_case_without_a_shape_fails_its_rows);
    tcase_add_loop_test(tests, threads_and_tasks_change_nothing, 0, 2);
    tcase_add_loop_test(tests, errors_of_load_cases_change_nothing_else, 0, 2);
    tcase_add_test(tests, killed_runs_resume);
    tcase_add_test(tests, samples_of_other_requirements_are_not_used);
    tcase_add_loop_test(tests, a_summary_below_verdicts_is_short, 0, 2);
    tcase_add_test(tests, points_of_a_study_have_verdicts);
    tcase_add_loop_test(tests, a_slack_start_is_scaled_into_the_requirements, 0, 2);
    tcase_add_loop_test(tests, a_failed_search_leaves_verdicts, 0, 2);
    tcase_add_test(tests, facets_too_large_for_a_bound_are_reported);
    tcase_add_test(tests, warnings_come_at_once);
    tcase_add_test(tests, bounds_that_exclude_the_start_are_reported);
    return suite;
}
