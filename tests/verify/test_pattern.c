/* Far fields of a whole run, and what export hands over to physical-optics programs, against dense sums in numpy; what
 * is refused, and what is not done unasked. */
#include "../cli/cli.h"

#define OFFSET_REFLECTOR source_path("configs/paraboloid-offset-12m.yaml")
#define AT_1_AND_2_GHZ                                                                                                 \
    "--set", "surface.frequencies_Hz=[1e9, 2e9]", "--set", "surface.pattern.n_theta=61", "--set",                      \
        "surface.pattern.phi_deg=[0, 40, 90]"

static void ask(const char *what, const char *result, const char *folder)
{
    const char *const oracle[] = {
        python_program(), source_path("tests/verify/pattern_oracle.py"), what, result, folder, NULL};
    demand_exit(run_command(HANG_S, oracle), 0, "pattern_oracle.py", __LINE__);
}

START_TEST(fields_agree_with_the_oracle)
{
    const char *flat = keep(temp("flat.h5")), *pillows = keep(temp("pillows.h5"));
    const char *csv = keep(temp("csv")), *rf = keep(temp("rf"));
    HIFDM(0, "run", OFFSET_REFLECTOR, AT_1_AND_2_GHZ, "-o", flat);
    OUT("   physical optics, feed: a point, cos^6.4\n");
    HIFDM(0, "export", flat, "--csv", csv, "--rf", rf);
    ask("field", flat, csv);
    ask("points", flat, rf);
    HIFDM(0, "run", OFFSET_REFLECTOR, AT_1_AND_2_GHZ, "--set", "surface.mesh_tension_N_per_m=2", "-o", pillows);
    HIFDM(0, "export", pillows, "--rf", rf, "--force");
    ask("points", pillows, rf);
}
END_TEST

/* Both feeds of a design that is on its surface, and of a shape that is 38 mm off it: the gains agree to 3e-7 dB. */
START_TEST(feeds_agree_with_the_oracle)
{
    const char *h5 = keep(temp("a.h5")), *csv = keep(temp("csv"));
    HIFDM(0, "run", OFFSET_REFLECTOR, "--set", "surface.frequencies_Hz=[2e9]", "-o", h5);
    HIFDM(0, "export", h5, "--csv", csv);
    ask("antenna", h5, csv);
    HIFDM(0, "run",
          file_with("rough.yaml", "scene:\n  paraboloid: {aperture_m: 8, focal_length_m: 6.4, offset_m: 5.5, rings: 6, "
                                  "rear_distance_m: 1.8}\nform: {pretension_N: 30}\n"
                                  "surface: {frequencies_Hz: [2e9, 4e9]}\n"),
          "-o", h5, "--force");
    HIFDM(0, "export", h5, "--csv", csv, "--force");
    ask("antenna", h5, csv);
}
END_TEST

/* The same numbers in --json, show, the file and the table; with any number of threads. */
START_TEST(figures_are_told_everywhere)
{
    const char *one = keep(temp("one.h5")), *three = keep(temp("three.h5")), *csv = keep(temp("f.csv"));
    HIFDM(0, "run", OFFSET_REFLECTOR, AT_1_AND_2_GHZ, "--threads", "1", "-o", one);
    HIFDM(0, "run", OFFSET_REFLECTOR, AT_1_AND_2_GHZ, "--threads", "3", "-o", three, "--json");
    const char *run = keep(file_with("run.json", said.out));
    HIFDM(0, "show", three, "--json");
    const char *show = keep(file_with("show.json", said.out));
    HIFDM(0, "export", three, "--pattern", csv);
    EXPECT(run, show, three, one, csv, "--", "a['form']['pattern'] == b['form']['pattern']",
           "len(a['form']['pattern']) == 6 and a['form']['pattern'][4]['phi_deg'] == 40",
           "all(a['form']['pattern'][k][n] == c['pattern/form/' + n][k // 3, k % 3] for k in range(6) "
           "for n in ('gain_dBi', 'beam_deg', 'half_power_width_deg', 'first_sidelobe_dB', 'highest_sidelobe_dB'))",
           "all((c['pattern/form/' + n][:] == d['pattern/form/' + n][:]).all() for n in ('co_dBi', 'cross_dBi'))",
           "[float(r['co_dBi']) for r in e] == c['pattern/form/co_dBi'][:].ravel().tolist()",
           "[float(r['theta_deg']) for r in e[61:122]] == c['pattern/form/theta_deg'][:].tolist()");
    HIFDM(2, "export", three, "--pattern", csv, "--force", "--stage", "refine");
    ERR("this shape has no far field");
}
END_TEST

/* Figures that the angles do not tell are left out, with a warning. */
START_TEST(angles_that_miss_the_beam_are_told)
{
    const char *h5 = keep(temp("c.h5"));
    HIFDM(0, "run", OFFSET_REFLECTOR, AT_1_AND_2_GHZ, "--set", "surface.pattern.n_theta=41", "-o", h5);
    ERR("warning: surface.pattern: in 3 of 6 cuts of stage form, such as phi 0 deg at 2 GHz, the steps of 0.25 deg are "
        "coarse");
    EXPECT(h5, "--",
           "all((a['pattern/form/' + n][1] != a['pattern/form/' + n][1]).all() for n in "
           "('half_power_width_deg', 'first_sidelobe_dB', 'highest_sidelobe_dB'))",
           "(a['pattern/form/half_power_width_deg'][0] > 1).all()", "(a['pattern/form/gain_dBi'][1] > 40).all()");
    HIFDM(0, "run", OFFSET_REFLECTOR, AT_1_AND_2_GHZ, "--set", "surface.pattern.theta_deg=[0.3, 3]", "-o", h5,
          "--restart");
    ERR(" the maximum gain is at the end of theta_deg");
}
END_TEST

START_TEST(nothing_is_done_unasked)
{
    const char *h5 = keep(temp("plain.h5"));
    HIFDM(0, "run", OFFSET_REFLECTOR, "-o", h5);
    ck_assert(!strstr(said.out, "\n  pattern  "));
    EXPECT(h5, "--", "'pattern' not in a");
    HIFDM(2, "export", h5, "--pattern", temp("p.csv"));
    ERR("this shape has no far field, because the case has no section surface.pattern");
}
END_TEST

START_TEST(faults_have_their_line)
{
    static const char head[] = "scene:\n  paraboloid: {aperture_m: 4, focal_length_m: 2, rings: 5}\n";
    const char *path = file_with("c.yaml", "scene:\n"
                                           "  paraboloid: {aperture_m: 4, focal_length_m: 2, rings: 5}\n"
                                           "surface:\n"
                                           "  pattern:\n"
                                           "    n_theta: 1\n"
                                           "    theta_deg: [3, -3]\n"
                                           "    feed: {kind: horn}\n");
    HIFDM(2, "check", path);
    ERRS("error: %s:5:14: surface.pattern.n_theta: must be at least 2 and at most 4001, not 1\n", path);
    ERRS("error: %s:6:16: surface.pattern.theta_deg: the lower bound must be below the upper one\n", path);
    ERRS("error: %s:7:18: surface.pattern.feed.kind: must be one of auto point line plane_wave, not horn\n", path);
    char text[512];
    snprintf(text, sizeof text, "%ssurface:\n  pattern: {phi_deg: [1,2,3,4,5,6,7,8,9], theta_deg: [null, 2]}\n", head);
    path = file_with("d.yaml", text);
    HIFDM(2, "check", path);
    ERRS("error: %s:4:54: surface.pattern.theta_deg: needs surface.frequencies_Hz: at which frequencies is the far "
         "field wanted?\n",
         path);
    ERRS("error: %s:4:22: surface.pattern.phi_deg: must have 1 to 8 cuts\n", path);
    ERR("surface.pattern.theta_deg: must have both ends, like [-5, 5]\n");
    snprintf(text, sizeof text,
             "%ssurface:\n  frequencies_Hz: [1e9]\n  pattern:\n    feed:\n      position_m: [0, 0, 0.1]\n", head);
    path = file_with("e.yaml", text);
    HIFDM(2, "check", path, "--set", "surface.pattern.feed.kind=plane_wave");
    ERRS("error: %s:7:19: surface.pattern.feed.position_m: has no meaning for a plane_wave, which comes along -z",
         path);
    HIFDM(2, "check", path, "--set", "surface.pattern.feed.position_m=[0, 0, -3]");
    ERR("error: --set surface.pattern.feed.position_m: from (0, 0, -3) m, the feed illuminates 150 of 150 facets from "
        "behind or not at all. Place the feed above all facets, and aim the feed at the facets\n");
    HIFDM(0, "check", path, "--set", "surface.pattern.feed.position_m=[0, 0, 2]");
    ck_assert(!strstr(said.err, "coarse"));
    HIFDM(0, "check", path, "--set", "surface.pattern.feed.position_m=[0, 0, 2]", "--set",
          "surface.frequencies_Hz=[1e9, 40e9]");
    ERR("warning: surface.pattern: at 40 GHz, the facets are coarse. ");
    ERR(" facets instead of 150 would lose 1 dB\n");
    HIFDM(2, "check", path, "--set", "surface.pattern.feed.position_m=[0, 0, 2]", "--set",
          "surface.pattern.feed.aim_m=[0, 0, 2]");
    ERR("error: --set surface.pattern.feed.aim_m: the feed at (0, 0, 2) m cannot aim at its own position\n");
    HIFDM(2, "check", path, "--set", "surface.pattern.feed.position_m=[0, 0, 2]", "--set",
          "surface.frequencies_Hz=[1e9, 1e15]");
    ERR("error: --set surface.frequencies_Hz: at 1e+06 GHz, the far field needs ");
    HIFDM(0, "check", path, "--set", "surface.pattern.feed.position_m=[0, 0, 2]", "--set",
          "surface.frequencies_Hz=[1e8]");
    ERR(" wavelengths across, but physical optics is valid only above about 5 wavelengths\n");
    OUT("                far field at 0.1 GHz: ");
}
END_TEST

Suite *suite_verify_pattern(void)
{
    Suite *suite = suite_create("verify/pattern");
    TCase *tcase = tcase_create("pattern");
    tcase_add_test(tcase, fields_agree_with_the_oracle);
    tcase_add_test(tcase, feeds_agree_with_the_oracle);
    tcase_add_test(tcase, figures_are_told_everywhere);
    tcase_add_test(tcase, angles_that_miss_the_beam_are_told);
    tcase_add_test(tcase, nothing_is_done_unasked);
    tcase_add_test(tcase, faults_have_their_line);
    suite_add_tcase(suite, tcase);
    return suite;
}
