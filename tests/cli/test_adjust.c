/* hifdm adjust: the table of moves, and every bad input by name. */
#include "cli.h"

#define SECTIONS                                                                                                       \
    "tolerance: {sigma_cut_m: 0.0001}\n"                                                                               \
    "adjust: {set: inner, range_m: 0.002, step_m: 0.0001, max_adjustments: 3, sigma_m: 0.0001}\n"

/* The places of the design, changed: what a measurement of the nominal net would say. `change` may alter a line's
 * numbers; it returns false to leave the node out. */
typedef bool change_node(int i, double x[3]);

static const char *measured_of(const char *result, const char *name, const char *header, change_node *change,
                               const char *more)
{
    const char *folder = temp("shape");
    HIFDM(0, "export", result, "--csv", folder, "--force");
    char *text = read_file(formatted("%s/nodes.csv", folder), NULL), *to = malloc(1 << 16), *at = to;
    ck_assert(text && to);
    at += sprintf(at, "%s\n", header);
    int i = 0;
    for (char *line = strchr(text, '\n') + 1; *line; line = strchr(line, '\n') + 1, i++) {
        char id[64];
        double x[3];
        if (sscanf(line, "%63[^,],%lf,%lf,%lf", id, &x[0], &x[1], &x[2]) != 4) break;
        if (change && !change(i, x)) continue;
        at += sprintf(at, "%s,%.17g,%.17g,%.17g\n", id, x[0], x[1], x[2]);
    }
    sprintf(at, "%s", more);
    const char *path = file_with(name, to);
    free(text);
    free(to);
    return path;
}

static const char *measured_with(const char *name, const char *header, change_node *change, const char *more)
{
    const char *result = temp("shape.h5");
    HIFDM(0, "run", file_with("case.yaml", EA_SCENE SECTIONS), "-o", result, "--restart", "--quiet");
    return measured_of(result, name, header, change, more);
}

static bool wave(int i, double x[3])
{
    x[2] += (i % 5 - 2) * 2e-4;
    return i % 4 > 0;
}

/* By 3 mm in the middle. */
static bool sag(int i, double x[3])
{
    (void)i;
    x[2] -= 0.003 * (1 - x[0] * x[0]);
    return true;
}

static bool in_mm(int i, double x[3])
{
    (void)i;
    for (int c = 0; c < 3; c++)
        x[c] *= 1000;
    return true;
}

static bool turned(int i, double x[3])
{
    (void)i;
    double y = x[1];
    x[1] = 0.8 * y - 0.6 * x[2] + 0.25;
    x[2] = 0.6 * y + 0.8 * x[2];
    return true;
}

static bool one_off(int i, double x[3])
{
    if (i == 17) x[0] += 0.3;
    return true;
}

static bool one_wrong(int i, double x[3])
{
    if (i == 17) x[2] += 0.002;
    return true;
}

static bool two_nodes(int i, double x[3])
{
    (void)x;
    return i == 17 || i == 18 || i == 0;
}

#define HEADER "id,x_m,y_m,z_m"

START_TEST(moves_are_a_table)
{
    const char *measured = measured_with("m.csv", HEADER, wave, ""), *moves = temp("moves.csv");
    const char *path = file_with("case.yaml", EA_SCENE SECTIONS);
    HIFDM(0, "adjust", path, "--measured", measured, "-o", moves);
    OUT("nodes measured, chi^2 ");
    OUT("per coordinate (1 is expected); supports are assumed at their positions in the case");
    OUT("psi measured ");
    OUT("psi after 3 adjustments");
    OUT("all 3 are made (adjust.max_adjustments)");
    char *table = read_file(moves, NULL);
    ck_assert_int_eq(count_of(table, "\n"), 4);
    ck_assert_ptr_nonnull(strstr(
        table, "order,cable,set,turnbuckle_mm,tension_before_N,tension_after_N,predicted_rms_mm,expected_rms_mm\n1,"));
    HIFDM(5, "adjust", path, "--measured", measured, "-o", moves);
    ERR("exists");
    HIFDM(5, "adjust", path, "--measured", measured, "-o", measured, "--force");
    ERR("an input of this run");
    HIFDM(0, "adjust", path, "--measured", measured, "-o", temp("again.csv"), "--quiet", "--threads", "3");
    char *again = read_file(temp("again.csv"), NULL);
    ck_assert_str_eq(table, again);
    HIFDM(0, "adjust", path, "--measured", measured, "--json", "--set", "tolerance.sigma_support_m=1e-4");
    OUT("\"supports_estimated\": true");
    OUT("\"adjustments\": [");
    HIFDM(0, "adjust", path, "--measured", measured, "--set", "adjust.target_m=1");
    OUT("psi after 0 adjustments");
    OUT("no further adjustment: target_m is met");
    HIFDM(0, "adjust", path, "--measured", measured, "--json");
    double probable_m = number_after("\"adjusted_m\": "), expected_m = number_after("\"adjusted_expected_m\": ");
    ck_assert_double_lt(probable_m, expected_m);
    double before_m = number_after("\"estimated_expected_m\": "),
           before_sigma_m = number_after("\"estimated_sigma_m\": "), sigma_m = number_after("\"adjusted_sigma_m\": "),
           best_m = number_after("\"best_m\": ");
    const char *before =
                   keep(formatted("; expected %.4f +- %.4f mm over all nets that fit the measurement; of the design ",
                                  before_m * 1e3, before_sigma_m * 1e3)),
               *behind = keep(formatted(" %.4f mm; expected %.4f +- %.4f mm; a search over adjustments of all ",
                                        probable_m * 1e3, expected_m * 1e3, sigma_m * 1e3)),
               *best = keep(formatted("without minimum tensions, reached %.4f mm\n", best_m * 1e3));
    HIFDM(0, "adjust", path, "--measured", measured); /* the words have the same figures */
    OUT(before);
    OUT(behind);
    OUT(best);
    HIFDM(0, "adjust", path, "--measured", measured, "--set",
          formatted("adjust.target_m=%.17g", (probable_m + expected_m) / 2));
    OUT("no further adjustment: the most probable net meets target_m, but the expected value is ");
    static const char *const column[] = {
        "order",          "cable", "set", "turnbuckle_mm", "tension_before_N", "tension_after_N", "predicted_rms_mm",
        "expected_rms_mm"};
    for (int i = 0; i < 8; i++)
        HIFDM(0, "explain", column[i]);
    free(table);
    free(again);
}
END_TEST

/* A net with a psi of its own, and a range in which cables can be let out until they are slack: they are not. */
START_TEST(no_cable_is_let_out_until_it_is_slack)
{
    const char *measured = measured_with("m.csv", HEADER, NULL, ""), *moves = temp("moves.csv");
    const char *path = file_with("case.yaml", EA_SCENE SECTIONS);
    HIFDM(0, "adjust", path, "--measured", measured, "-o", moves, "--set", "adjust.range_m=0.05", "--set",
          "adjust.set=boundary", "--set", "adjust.aim=target_positions");
    OUT("the adjustments leave each cable its minimum tension and make no other cable slack");
    SHELL(0, "awk -F, 'NR > 1 && !($6 > 0.01) { bad = 1 } END { exit bad || NR < 2 }' \"$1\"", moves);
    HIFDM(0, "adjust", path, "--measured", measured, "--set", "adjust.range_m=100", "--set",
          "adjust.aim=target_positions");
    OUT("psi after 3 adjustments");
}
END_TEST

/* Of tensions after the moves, nine tenths of what is asked for, by requirements or optimize.limits; without
 * either less is left. */
START_TEST(least_tensions_are_asked_for)
{
    static const char least[] = "awk -F, 'NR > 1 && $6 < least { least = $6 } BEGIN { least = 1e9 } "
                                "END { exit !(low < least && least < high) }' low=\"$2\" high=\"$3\" \"$1\"";
    const char *measured = measured_with("m.csv", HEADER, NULL, ""), *moves = temp("moves.csv");
    const char *path = file_with("case.yaml", EA_SCENE SECTIONS);
#define LET_OUT                                                                                                        \
    "adjust", path, "--measured", measured, "-o", moves, "--force", "--stage", "form", "--set",                        \
        "adjust.range_m=0.001", "--set", "adjust.set=boundary", "--set", "adjust.max_adjustments=8", "--set",          \
        "adjust.aim=target_positions"
    HIFDM(0, LET_OUT);
    SHELL(0, least, moves, "-1", "4");
    HIFDM(0, LET_OUT, "--json"); /* nor is any cable slack on the way */
    ck_assert_int_eq(count_of(said.out, "\"slack\": 0"), 8);
    HIFDM(0, LET_OUT, "--set", "requirements=[{figure: tension, at_least: 5, share: 0.9}]");
    ck_assert_ptr_null(strstr(said.out, "may not lose tension"));
    SHELL(0, least, moves, "4.5", "1e3");
    HIFDM(0, LET_OUT, "--set", "requirements=[{figure: tension, at_least: 5e5}]");
    OUT("cables have less than the required 5e+05 N already and may not lose tension");
    HIFDM(0, LET_OUT, "--set", "optimize.limits=[{figure: tension, set: boundary, bounds: [8, 1e4]}]");
    SHELL(0, least, moves, "7.2", "1e3");
}
END_TEST

/* Moves bring the net back to its design, also where that is 39 mm from theory. Who aims at theory, or at facets, from
 * where the range does not reach is told what the other aims give: each of them by the same command. */
START_TEST(what_else_could_be_aimed_at_is_told)
{
    const char *measured = measured_with("m.csv", HEADER, wave, "");
    const char *path = file_with("case.yaml", EA_SCENE SECTIONS "surface: {}\n");
    static const char *const aim[] = {"adjust.aim=design", "adjust.aim=target_positions", "adjust.figure=facets"};
    double after[3];
    for (int k = 0; k < 3; k++) {
        HIFDM(0, "adjust", path, "--measured", measured, "--json", "--set", aim[k]);
        after[k] = number_after("\"adjusted_m\": ");
        ck_assert_double_gt(number_after("\"design_psi_m\": "), 0.03);
        ck_assert_double_lt(number_after("\"error_psi_m\": "), 0.002);
    }
    HIFDM(0, "adjust", path, "--measured", measured);
    OUT("psi of 13 of 23 free nodes is measured from the design (adjust.aim), which is 39.");
    OUT("Results with another figure or aim:");
    OUT(keep(formatted("to %.4f mm by 3 adjustments", after[1] * 1e3)));
    OUT(keep(formatted("to %.4f mm by 3 adjustments", after[2] * 1e3)));
    HIFDM(0, "adjust", path, "--measured", measured, "--set", aim[1]);
    OUT("3 of 3 adjustments are as large as adjust.range_m allows. Results with another figure or aim:");
    OUT("adjust: {figure: psi, aim: design} changes psi from ");
    OUT(keep(formatted("to %.4f mm by 3 adjustments", after[0] * 1e3)));
    OUT("adjust: {figure: facets} changes facets from ");
    OUT(keep(formatted("to %.4f mm by 3 adjustments", after[2] * 1e3)));
    HIFDM(0, "adjust", path, "--measured", measured, "--set", aim[2]);
    OUT("adjust: {figure: psi, aim: design} changes psi from ");
    OUT("adjust: {figure: psi, aim: target_positions} changes psi from ");
    ck_assert_ptr_null(strstr(said.out, "{figure: facets}"));
    OUT("facets: RMS along the normal of the target surface (the gain loss follows from the half-path RMS)\n");
    HIFDM(0, "adjust", path, "--measured", measured, "--json", "--set", aim[2]);
    const char *told = out_as("a.json"), *result = temp("r.h5");
    HIFDM(0, "run", path, "-o", result, "--quiet", "--set", "tolerance.samples=10");
    EXPECT(told, result, "--", "near(a['nominal_m'], b['surface/form'].attrs['facet_normal_rms_m'], 1e-6)",
           "not near(a['nominal_m'], b['surface/form'].attrs['facet_half_path_rms_m'], 1e-5)");
    HIFDM(0, "adjust", path, "--measured", measured, "--set", aim[1], "--set", "adjust.range_m=0.1");
    OUT("errors displace the nodes by ");
}
END_TEST

#define TIED                                                                                                           \
    "scene:\n  paraboloid: {aperture_m: 4, focal_length_m: 2.4, rings: 3, rear_distance_m: 1.2}\n"                     \
    "  EA_inner_N: 5000\n  EA_boundary_N: 10000\n"

/* One node was measured 2 mm wrong, on a net that is as it was designed: nothing else is told of it. What the cables
 * about it are taken to be off by is less than what the places alone say. */
START_TEST(outliers_are_told)
{
    const char *path = file_with("case.yaml", TIED SECTIONS "form: {prestress: exact}\n");
    const char *result = temp("exact.h5");
    HIFDM(0, "run", path, "-o", result, "--quiet");
    const char *measured = measured_of(result, "m.csv", HEADER, one_wrong, "");
    HIFDM(0, "adjust", path, "--measured", measured);
    OUT("2 of 74 measured nodes are more than 4 sigma off the estimated shape and count fully");
    OUT("node 'f2_10' (line 19): ");
    OUT("; the positions alone indicate ");
    OUT("such errors are estimated too small (hifdm explain outlier)");
    ck_assert_ptr_null(strstr(said.out, "another figure or aim"));
    HIFDM(0, "adjust", path, "--measured", measured, "--json");
    OUT("\"off_shape\": [");
    OUT("\"instead\": []");
    const char *first = strstr(said.out, "\"error_m\": ");
    ck_assert_ptr_nonnull(first);
    ck_assert_double_gt(fabs(number_after("\"by_positions_m\": ")), 1.1 * fabs(strtod(first + 11, NULL)));
    HIFDM(0, "explain", "outlier");
    OUT("an outlier is an error that is much larger");
    OUT("What to do: If a cable is the outlier, check the cable");
}
END_TEST

/* Of few nodes, some far off. */
static bool few_off(int i, double x[3])
{
    if (i % 7 != 4) return false;
    x[2] += (i % 2 ? 0.0008 : -0.0008) * (i % 4);
    return true;
}

static void demand_finite(void)
{
    ck_assert_ptr_null(strstr(said.out, " inf"));
    ck_assert_ptr_null(strstr(said.out, " nan"));
    ck_assert_ptr_null(strstr(said.out, "Infinity"));
}

/* Where places hardly tell the error of a cable from those of others nothing is said in their name; where they
 * contradict the estimate both signs are told. What cables only share is told of their spools alone. */
START_TEST(places_that_do_not_tell_say_nothing)
{
    const char *path =
        file_with("case.yaml", TIED "form: {prestress: exact}\n"
                                    "tolerance: {sigma_cut_m: 3e-5, sigma_cut_ratio: 0.0003, batch: 1}\n"
                                    "adjust: {set: inner, range_m: 0.002, step_m: 0.0001, max_adjustments: 1, "
                                    "sigma_m: 0.0001}\n");
    const char *result = temp("exact.h5");
    HIFDM(0, "run", path, "-o", result, "--quiet");
    const char *measured = measured_of(result, "m.csv", HEADER, few_off, "");
    HIFDM(0, "adjust", path, "--measured", measured);
    demand_finite();
    OUT("; the positions alone indicate "); /* of one that seems too long */
    ck_assert_int_gt(count_of(said.out, "cable '"), count_of(said.out, "; the positions alone indicate"));
    HIFDM(0, "adjust", path, "--measured", measured, "--json");
    demand_finite();
    OUT("\"by_positions_m\": null");
    OUT("\"by_positions_m\": -");
    HIFDM(0, "adjust", path, "--measured", measured, "--json", "--set", "tolerance.sigma_cut_m=0");
    demand_finite();
    OUT("\"stand_out\": []");
    ck_assert_double_gt(number_after("\"sigmas\": "), 3);
}
END_TEST

/* Of what spools are off by the summary has what is no accident, --json all. */
START_TEST(spools_stand_out)
{
    const char *measured = measured_with("m.csv", HEADER, sag, "");
    const char *path = file_with("case.yaml", EA_SCENE "tolerance: {sigma_cut_ratio: 3e-5, batch: 1}\n"
                                                       "adjust: {set: inner, range_m: 0.002, step_m: 0.0001, "
                                                       "sigma_m: 0.001}\n");
    HIFDM(0, "adjust", path, "--measured", measured);
    OUT("spool 'directrix' seems to have an error of -");
    OUT("spool 'edge' seems to have an error of +");
    ck_assert_ptr_null(strstr(said.out, "'generatrix'"));
    HIFDM(0, "adjust", path, "--measured", measured, "--json");
    OUT("\"generatrix\"");
}
END_TEST

#define DESIGN "optimize: {method: lm, range_N: 2}\n"

/* Measures the result of a case without an error. Nothing is then wrong with the net: its errors are below error_m. */
static void assert_nothing_is_wrong(const char *path, const char *result, const char *error_m)
{
    HIFDM(0, "run", path, "-o", result, "--quiet");
    const char *measured = measured_of(result, "m.csv", HEADER, NULL, "");
    HIFDM(0, "adjust", path, "--measured", measured, "--result", result, "--json", "--set", "adjust.aim=design");
    OUT("\"aim\": \"design\"");
    OUT("\"adjustments\": []");
    SHELL(0,
          "\"$1\" adjust \"$2\" --measured \"$3\" --result \"$4\" --json --set adjust.aim=design | \"$5\" -c 'import "
          "json, sys; a = json.load(sys.stdin); most = max([a[\"nominal_m\"], a[\"estimated_m\"], *map(abs, "
          "a[\"errors_m\"].values())]); print(most); sys.exit(not (a[\"settled\"] and most < float(sys.argv[1])))' $6",
          hifdm_program(), path, measured, result, python_program(), error_m);
}

/* The design is that of the result that the net was cut from. */
START_TEST(the_design_is_that_of_a_result)
{
    const char *path = file_with("case.yaml", EA_SCENE SECTIONS DESIGN), *result = temp("r.h5");
    assert_nothing_is_wrong(path, result, "1e-9");
    const char *measured = temp("m.csv");
    HIFDM(2, "adjust", path, "--measured", measured);
    ERR("the case has an `optimize` section, so --result FILE must give the result from which the cables were cut");
    HIFDM(2, "adjust", path, "--measured", measured, "--stage", "refine");
    ERR("the --stage option needs --result FILE with a result of this case. Only --stage form works without a result");
    HIFDM(0, "adjust", path, "--measured", measured, "--stage", "form");
    ERR("or another design of the net");
    const char *page = temp("moves.html");
    HIFDM(0, "adjust", path, "--measured", measured, "--result", result, "--report", page);
    OUT("report page: ");
    char *html = read_file(page, NULL);
    ck_assert_ptr_nonnull(html);
    ck_assert_ptr_nonnull(strstr(html, "\"adjust\": {\"set\": \"inner\""));
    free(html);
    HIFDM(5, "adjust", path, "--measured", measured, "--result", result, "--report", page);
    ERR("exists");
    HIFDM(5, "adjust", path, "--measured", measured, "--result", result, "--report", result, "--force");
    ERR("an input of this run");
    HIFDM(2, "adjust", path, "--measured", measured, "--result", result, "--report", "a", "-o", "a");
    ERR("the options -o and --report both name the file a. Use different names");
    HIFDM(2, "adjust", path, "--measured", measured, "--stage", "form", "--report", page, "--force");
    ERR("needs --result FILE with the result of this case");
    HIFDM(2, "adjust", path, "--measured", measured, "--result", result, "--stage", "search");
    ERR("this run has no search shape");
    HIFDM(2, "adjust", path, "--measured", measured, "--result", result, "--set", "scene.EA_inner_N=46000");
    ERR("this result belongs to another net than");
    ERR("The difference is in EA of cables");
    HIFDM(5, "adjust", path, "--measured", measured, "--result", measured);
    HIFDM(5, "adjust", path, "--measured", measured, "--result", result, "-o", result, "--force");
    ERR("an input of this run");
    HIFDM(2, "adjust", path, "--measured", measured, "--result", result, "--set", "adjust.figure=surface", "--set",
          "surface.frequencies_Hz=[1e9]", "--set", "adjust.aim=design");
    ERR("design goes with adjust.figure: psi alone");
}
END_TEST

START_TEST(bad_tables_are_named)
{
    const char *path = file_with("case.yaml", EA_SCENE SECTIONS), *bad;
    bad = measured_with("m.csv", HEADER, NULL, "x9,1,1,1\nn1_1,1,1,1\n");
    HIFDM(2, "adjust", path, "--measured", bad);
    ERRS("%s:37: 'x9': the net has no node with this id", bad);
    ERR("'n1_1'");
    bad = measured_with("m.csv", HEADER, in_mm, "");
    HIFDM(2, "adjust", path, "--measured", bad);
    ERR("the positions seem to be in mm, but the columns x_m, y_m and z_m must be in m");
    bad = measured_with("m.csv", HEADER, turned, "");
    HIFDM(2, "adjust", path, "--measured", bad);
    ERR("a rotation by 36.87 degrees explain all but");
    bad = measured_with("m.csv", HEADER, one_off, "");
    HIFDM(2, "adjust", path, "--measured", bad);
    ERRS("%s:19: node '", bad);
    ERR("is 300 mm from its design position");
    bad = measured_with("m.csv", HEADER, two_nodes, "");
    HIFDM(2, "adjust", path, "--measured", bad);
    ERR("the file has positions of 2 free nodes, but hifdm needs at least 3 positions");
    HIFDM(2, "adjust", path, "--measured", file_with("m.csv", HEADER ",sigma_m\nn1_1,0,0,0,-1\nn2_2,0,0,zero,1\n"));
    ERR("sigma_m must be above zero");
    bad = file_with("m.csv", HEADER ",sigma_m\nn1_1,0,0,0,1e-12\nn1_2,0,0,0,1\nn1_3,0,0,0,1\n");
    HIFDM(2, "adjust", path, "--measured", bad);
    ERRS("%s:2: the value sigma_m of 1e-12 m is too small for cable errors of 0.0001 m", bad);
    HIFDM(2, "adjust", path, "--measured", temp("missing.csv"));
    HIFDM(2, "adjust", path);
    ERR("needs the option --measured FILE");
}
END_TEST

/* On a truss the positions of a result are those after the truss has deflected, which must not be counted twice. */
START_TEST(the_design_on_a_truss_is_that_of_a_result)
{
    assert_nothing_is_wrong(file_with("case.yaml", ON_TRUSS "coupling: {tof_m: 1e-13}\n" SECTIONS DESIGN), temp("r.h5"),
                            "1e-9");
}
END_TEST

/* A table that contradicts its own sigmas, or says nothing, is used with a warning; one that contradicts them by ten
 * times is refused. */
START_TEST(doubtful_tables_are_told)
{
    const char *path = file_with("case.yaml", EA_SCENE SECTIONS), *measured = measured_with("m.csv", HEADER, wave, "");
    HIFDM(0, "adjust", path, "--measured", measured);
    ck_assert_ptr_null(strstr(said.err, "do not fit"));
    ck_assert_ptr_null(strstr(said.out, "do not trust"));
    HIFDM(0, "adjust", path, "--measured", measured, "--set", "adjust.sigma_m=3e-5");
    ERR("these positions do not fit the net and its tolerances, because chi^2 is ");
    ERR("The worst node '");
    ck_assert_ptr_eq(strstr(said.out, "the measurement does not fit this net: do not trust the adjustments below"),
                     said.out);
    HIFDM(0, "adjust", path, "--measured", measured, "--set", "adjust.sigma_m=3e-5", "--json");
    OUT("\"fits\": false");
    HIFDM(2, "adjust", path, "--measured", measured, "--set", "adjust.sigma_m=1e-5", "-o", temp("none.csv"));
    ERR("this measurement does not belong to this net, because chi^2 is ");
    ERR("The worst node '");
    ck_assert(!is_there(temp("none.csv")));
    HIFDM(0, "adjust", path, "--measured", measured, "--set", "adjust.sigma_m=0.1");
    ERR("makes these positions almost useless");
}
END_TEST

/* The truss of another temperature is not in the estimate, which says so. */
START_TEST(a_warm_truss_is_not_estimated)
{
    const char *result = temp("d.h5"), *path = file_with("case.yaml", ON_TRUSS SECTIONS);
    HIFDM(0, "run", file_with("design.yaml", ON_TRUSS), "-o", result, "--quiet", "--force");
    const char *measured = measured_of(result, "m.csv", HEADER, wave, "");
    HIFDM(0, "adjust", path, "--measured", measured);
    ck_assert_ptr_null(strstr(said.err, "is not estimated"));
    path = file_with("case.yaml", ON_TRUSS
                     "tolerance: {sigma_cut_m: 0.0001, truss: [{part: truss, sigma_temperature_K: 5}]}\n"
                     "adjust: {set: inner, range_m: 0.002, step_m: 0.0001, max_adjustments: 3, sigma_m: 0.0001}\n");
    HIFDM(0, "adjust", path, "--measured", measured, "--set", "truss.expansion_per_K=1e-6");
    ERR("hifdm adjust does not estimate the temperatures in tolerance.truss");
}
END_TEST

/* Errors far beyond what tensions stretch: which cables are slack, places do not tell, and how far moves are sure
 * neither. What a move gains is told with its sigma where that is more. */
START_TEST(what_is_not_sure_is_told)
{
    const char *result = temp("d.h5"),
               *path = file_with("case.yaml",
                                 "scene:\n"
                                 "  paraboloid: {aperture_m: 4, focal_length_m: 2.4, rings: 3, "
                                 "rear_distance_m: 1.2}\n"
                                 "  EA_inner_N: 5e4\n"
                                 "  EA_boundary_N: 5e4\n"
                                 "form: {pretension_N: 5, prestress: exact}\n"
                                 "tolerance: {sigma_cut_m: 0.0003, samples: 10}\n"
                                 "adjust: {set: all, range_m: 0.002, step_m: 0.00001, max_adjustments: 30, sigma_m: "
                                 "0.0001}\n");
    HIFDM(0, "run", path, "-o", result, "--quiet");
    const char *measured = measured_of(result, "m.csv", HEADER, wave, "");
    HIFDM(0, "adjust", path, "--measured", measured);
    OUT(" of 163 cables may be slack; positions do not show by how much");
    HIFDM(0, "adjust", path, "--measured", measured, "--set", "scene.EA_inner_N=500", "--set",
          "scene.EA_boundary_N=500");
    ck_assert_ptr_null(strstr(said.out, "may be slack"));
    measured = measured_with("m.csv", HEADER, wave, "");
    path = file_with("case.yaml",
                     EA_SCENE "tolerance: {sigma_cut_m: 0.0003}\n"
                              "adjust: {set: inner, range_m: 0.003, step_m: 0.0001, max_adjustments: 12, sigma_m: "
                              "0.0001}\n");
    HIFDM(0, "adjust", path, "--measured", measured);
    OUT("  gains ");
    OUT("\nthe measurement cannot resolve the gain of 1 of these adjustments at its position in the order (hifdm "
        "explain "
        "gain_sigma_m)\n");
    HIFDM(0, "adjust", path, "--measured", measured, "--json");
    EXPECT(
        out_as("a.json"), "--", "a['maybe_slack'] == 0",
        "a['adjustments'][-1]['expected_m'] == a['adjusted_expected_m'] > a['adjusted_m']",
        "all(m['expected_m'] > m['predicted_m'] for m in a['adjustments'])",
        "sum(m['gain_m'] < m['gain_sigma_m'] for m in a['adjustments']) == 1",
        "near(sum(m['gain_m'] for m in a['adjustments']), a['estimated_expected_m'] - a['adjusted_expected_m'], 1e-5)");
}
END_TEST

START_TEST(unknown_load_cases_are_named)
{
    const char *measured = measured_with("m.csv", HEADER, NULL, "");
    const char *path = file_with("case.yaml", EA_SCENE SECTIONS);
    HIFDM(2, "adjust", path, "--measured", measured, "--load-case", "up");
    ERR("--load-case up: the case ");
    ERR(" has no load cases. Add the load case of the measurement to the list `load_cases`");
    path = file_with("case.yaml", EA_SCENE SECTIONS "load_cases: [{name: windy, force_N: [0, 0, 1]}]\n");
    HIFDM(2, "adjust", path, "--measured", measured, "--load-case", "windi");
    ERR("has no such load case; did you mean 'windy'?");
    HIFDM(2, "adjust", path, "--measured", measured, "--load-case", "nominal");
    ERR("has no such load case. Its first load case is 'windy'");
    HIFDM(0, "adjust", path, "--measured", measured, "--json"); /* no requirement names a load case */
    ck_assert_ptr_null(strstr(said.out, "predictions"));
    HIFDM(2, "adjust", path, "--measured", measured, "--load-case", "windy"); /* the measurement knows no wind */
    ERR("The positions belong to another net, or the errors of the net are larger than in this section");
}
END_TEST

/* The tensions that adjustments keep are those required in the load case of the measurement. */
START_TEST(tensions_are_those_of_the_load_case)
{
    const char *measured = measured_with("m.csv", HEADER, wave, ""), *low = "less than the required 1000 N already";
    const char *path = file_with("case.yaml", EA_SCENE SECTIONS
                                 "load_cases: [{name: calm, force_N: [0, 0, 1e-6]}]\n"
                                 "requirements: [{figure: tension, at_least: 1000, load_case: calm}]\n");
    HIFDM(0, "adjust", path, "--measured", measured);
    ck_assert_ptr_null(strstr(said.out, low));
    OUT("predicted in load case");
    HIFDM(0, "adjust", path, "--measured", measured, "--load-case", "calm");
    OUT("measured in load case 'calm'");
    OUT(low);
}
END_TEST

START_TEST(bad_cases_are_named)
{
    const char *measured = measured_with("m.csv", HEADER, NULL, "");
    HIFDM(2, "adjust", file_with("case.yaml", EA_SCENE), "--measured", measured);
    ERR("the case has no `adjust` section");
    ERR("has no `tolerance` section");
    HIFDM(2, "adjust", file_with("case.yaml", SMALL_SCENE SECTIONS), "--measured", measured);
    ERR("have no stiffness EA");
    const char *path = file_with("case.yaml", EA_SCENE SECTIONS);
    HIFDM(2, "adjust", path, "--measured", measured, "--set", "adjust.range_m=5e-5");
    ERR("adjust.range_m: is smaller than adjust.step_m, which allows no move at all");
    HIFDM(2, "adjust", path, "--measured", measured, "--set", "tolerance.sigma_support_m=1e-12");
    ERR("tolerance.sigma_support_m of 1e-12 m is too small for cable errors of 0.0001 m");
    HIFDM(2, "adjust", path, "--measured", measured, "--set", "tolerance.sigma_cut_m=0.5");
    ERR("tolerance.sigma_cut_m: cable '");
    HIFDM(2, "adjust", path, "--measured", measured, "--set", "adjust.set=struts");
    ERR("adjust.set");
    HIFDM(2, "adjust", path, "--measured", measured, "--set", "adjust.figure=surface");
    ERR("the value surface needs a target surface. Add a `surface` section");
    HIFDM(2, "adjust", path, "--measured", measured, "--set", "tolerance.sigma_cut_m=0", "--set",
          "tolerance.sigma_support_m=1e-4");
    ERR("the section defines no cable errors that hifdm can estimate");
    HIFDM(2, "adjust",
          file_with("case.yaml", EA_SCENE "tolerance: {sigma_cut_m: 0.0001}\n"
                                          "adjust: {set: inner, range_m: 0.002, step_m: 0.0001}\n"),
          "--measured", measured);
    ERR("has no sigma_m; add the column, or adjust.sigma_m");
}
END_TEST

Suite *suite_cli_adjust(void)
{
    Suite *suite = suite_create("cli/adjust");
    TCase *tcase = tcase_create("adjust");
    tcase_set_timeout(tcase, HANG_S);
    tcase_add_test(tcase, moves_are_a_table);
    tcase_add_test(tcase, no_cable_is_let_out_until_it_is_slack);
    tcase_add_test(tcase, least_tensions_are_asked_for);
    tcase_add_test(tcase, what_else_could_be_aimed_at_is_told);
    tcase_add_test(tcase, outliers_are_told);
    tcase_add_test(tcase, places_that_do_not_tell_say_nothing);
    tcase_add_test(tcase, spools_stand_out);
    tcase_add_test(tcase, the_design_is_that_of_a_result);
    tcase_add_test(tcase, the_design_on_a_truss_is_that_of_a_result);
    tcase_add_test(tcase, bad_tables_are_named);
    tcase_add_test(tcase, doubtful_tables_are_told);
    tcase_add_test(tcase, a_warm_truss_is_not_estimated);
    tcase_add_test(tcase, what_is_not_sure_is_told);
    tcase_add_test(tcase, unknown_load_cases_are_named);
    tcase_add_test(tcase, tensions_are_those_of_the_load_case);
    tcase_add_test(tcase, bad_cases_are_named);
    suite_add_tcase(suite, tcase);
    return suite;
}
