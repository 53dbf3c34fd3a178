/* The HDF5 file of a run as h5py and h5dump see it: layout, units, provenance, and that its numbers belong together. */
#include "cli.h"

static const char *run_once(void)
{
    const char *out = temp("c.h5");
    HIFDM(0, "run", CHEN, "-o", out, "--quiet", "--set", "optimize.generations=8");
    return out;
}

START_TEST(every_data_set_has_units)
{
    EXPECT(run_once(), "--", "len(data_sets(a)) > 30",
           "[n for n, d in data_sets(a).items() if not isinstance(text(d.attrs.get('units')), str)] == []",
           /* and the unit that ends its name; names without one are dimensionless, texts, or as said in store.h */
           "[n for n, d in data_sets(a).items() if n.endswith('_m') and not n.endswith('_per_m') and attribute(d, "
           "'units') != 'm'] == []",
           "[n for n, d in data_sets(a).items() if n.endswith('_N') and attribute(d, 'units') != 'N'] == []",
           "[n for n, d in data_sets(a).items() if n.endswith('_N_per_m') and attribute(d, 'units') != 'N/m'] == []",
           "[n for n, d in data_sets(a).items() if attribute(d, 'units') and '_' not in n] == ['refine/design', "
           "'scene/cable/target', 'search/design', 'search/population/design', 'variable/initial', 'variable/lower', "
           "'variable/upper']");
}
END_TEST

/* The word for each sign, and for what rounds to 0; written out a second time, apart from the code. */
START_TEST(a_change_has_the_word_of_its_sign)
{
    static const struct {
        const char *part, *words; /* of the base in the result, of the file */
    } change[] = {{"0.6197", "38.0 % lower than "},
                  {"1.3803", "38.0 % higher than "},
                  {"1.00004", "the same as "},
                  {"0.99996", "the same as "},
                  {"1", "the same as "}};
    static const char set[] = "import h5py, sys\n"
                              "with h5py.File(sys.argv[1], 'r+') as f:\n"
                              "    a, form = f['search'].attrs, f['form'].attrs\n"
                              "    a['psi_m'] = a['initial_psi_m'] * float(sys.argv[2])\n"
                              "    if 'merit' in form:\n"
                              "        a['merit'] = form['merit'] * float(sys.argv[2])\n";
    const char *out = temp("c.h5"), *objectives = temp("g.h5");
    const char *path = file_with("c.yaml", SMALL_SCENE "optimize: {population: 4, generations: 1, refine: false}\n");
    HIFDM(0, "run", path, "-o", out, "--quiet");
    HIFDM(0, "run", path, "-o", objectives, "--quiet", "--set", "optimize.objective=[{figure: psi}]");
    for (size_t i = 0; i < sizeof change / sizeof *change; i++) {
        SHELL(0, "\"$1\" -c \"$2\" \"$3\" $4 && \"$0\" show \"$3\"", python_program(), set, out, change[i].part);
        OUT(formatted(", %sfor the initial design (", change[i].words));
        ck_assert_ptr_null(strstr(said.out, "-38"));
        SHELL(0, "\"$1\" -c \"$2\" \"$3\" $4 && \"$0\" show --verbose \"$3\"", python_program(), set, objectives,
              change[i].part);
        OUT(formatted("%safter form-finding; ", change[i].words));
    }
}
END_TEST

START_TEST(h5dump_reads_the_file)
{
    const char *const argv[] = {"h5dump", run_once(), NULL};
    demand_exit(run_command(HANG_S, argv), 0, "h5dump", __LINE__);
    ck_assert_str_eq(said.err, "");
    OUT("DATASET \"best_psi_m\"");
    OUT("\"straight_chain\""); /* the words of an enumeration */
}
END_TEST

/* Of the case file alone; with --set, of the file followed by the settings, a line each. */
START_TEST(the_case_is_kept_with_its_digest)
{
    const char *out = temp("r.h5");
    HIFDM(0, "run", REFLECTOR, "-o", out, "--quiet");
    SHELL(0, "sha256sum <\"$1\" | cut -d' ' -f1 | tr -d '\\n'", REFLECTOR);
    char digest[65];
    ck_assert_uint_eq(strlen(said.out), 64);
    strcpy(digest, said.out);
    EXPECT(out, REFLECTOR, "--", formatted("attribute(a['case'], 'sha256') == '%s'", digest),
           "texts(a['case/text']) == open(sys.argv[2]).read()", "texts(a['case/overrides']) == ''",
           "attribute(a['case'], 'case_path') == sys.argv[2]");
    HIFDM(0, "run", REFLECTOR, "-o", out, "--quiet", "--force", "--set", "form.pretension_N=11");
    EXPECT(out, "--",
           "attribute(a['case'], 'sha256') == sha256((texts(a['case/text']) + texts(a['case/overrides'])).encode())",
           formatted("attribute(a['case'], 'sha256') != '%s'", digest));
}
END_TEST

START_TEST(provenance_is_in_the_root_attributes)
{
    EXPECT(run_once(), "--",
           "{'program', 'format_version', 'version', 'git_describe', 'compiler', 'build_flags', 'hdf5_version', "
           "'gsl_version', 'lapack', 'rng', 'host', 'argv', 'started_utc', 'finished_utc', 'title', 'seed', 'threads', "
           "'warnings', 'has_search', 'status'} <= set(a.attrs)",
           "attribute(a, 'status') == 'ok'", "a.attrs['seed'] == 2022",
           "attribute(a, 'started_utc') <= attribute(a, 'finished_utc')", "attribute(a, 'argv')[1:2] == ['run']",
           "attribute(a, 'argv')[-1] == 'optimize.generations=8'", "'straight chains' in attribute(a, 'warnings')");
}
END_TEST

/* Recomputed here by Eqs. 4, 6 and 10 from the stored positions. 1e-12: a few roundings of numbers of size one. */
START_TEST(stored_shapes_belong_to_their_numbers)
{
    EXPECT(
        run_once(), "--", "near(psi_m(a, a['form/position_m'][:]), a['form'].attrs['psi_m'], 1e-12)",
        "near(psi_m(a, a['search/position_m'][:]), a['search'].attrs['psi_m'], 1e-12)",
        "a['form/history/psi_m'][-1] == a['form'].attrs['psi_m']",
        "len(a['form/history/psi_m']) == a['form'].attrs['iterations'] == 67",
        "near(ratio(a, a['form/tension_N'][:], 0), a['form'].attrs['inner_tension_ratio'], 1e-12)",
        "near(ratio(a, a['form/tension_N'][:], 1), a['form'].attrs['boundary_tension_ratio'], 1e-12)",
        "near(ratio(a, a['search/tension_N'][:], 1), a['search'].attrs['boundary_tension_ratio'], 1e-12)",
        "np.allclose(a['form/tension_N'], a['form/q_N_per_m'][:] * a['form/length_m'][:], rtol=1e-14)",
        "all(np.allclose(a[s + '/length_m'], np.linalg.norm(np.diff(a[s + '/position_m'][:][a['scene/cable/end'][:]],"
        " axis=1)[:, 0], axis=1), rtol=1e-14) for s in ('form', 'search'))",
        "(a['form/position_m'][:] == a['scene/node/position_m'][:])[a['scene/node/role'][:] == 0].all()");
}
END_TEST

START_TEST(every_generation_is_there)
{
    EXPECT(
        run_once(), "--",
        "a['search/population/psi_m'].shape == a['search/population/status'].shape == "
        "a['search/population/evaluated'].shape == (8, 50)",
        "designs(a).shape == (8, 50, 120)", "a['search/population/design'].dtype == 'f8'",
        /* each design is stored once, when an individual gets it */
        "len(a['search/population/design']) == n_new(designs(a))",
        "(np.unique(a['search/population/design_row'][:]) == np.arange(len(a['search/population/design']))).all()",
        "a['search/population/crossover_rate'].shape == a['search/population/mutation_rate'].shape == (8, 50)",
        "a['search/population/evaluated'][:].sum() == a['search'].attrs['evaluations']",
        "a['search/population/evaluated'][0].all()",
        "not np.isnan(a['search/population/psi_m'][:][a['search/population/status'][:] == 0]).any()",
        "np.isnan(a['search/population/psi_m'][:][a['search/population/status'][:] != 0]).all()",
        "(a['variable/lower'][:] <= designs(a)).all()", "(designs(a) <= a['variable/upper'][:]).all()",
        /* individual 0 is the found shape's tensions, the best one what its generation says */
        "(designs(a)[0, 0] == a['form/tension_N'][:][a['variable/cable'][:]]).all()",
        "a['search/population/best_psi_m'][:].tolist() == np.nanmin(a['search/population/psi_m'][:], axis=1).tolist()",
        "a['search/population/best_individual'][:].tolist() == np.nanargmin(a['search/population/psi_m'][:], "
        "axis=1).tolist()",
        "(a['search/design'][:] == designs(a)[-1, a['search/population/best_individual'][-1]]).all()",
        "a['search/population/psi_m'][a['search'].attrs['best_generation'], a['search'].attrs['best_individual']] == "
        "a['search'].attrs['psi_m'] == a['search/population/best_psi_m'][-1]",
        /* a child that was not evaluated is its parent: elite or unchanged */
        "all((designs(a)[g, i] == designs(a)[g - 1, a['search/population/parent'][g, i, 0]]).all() for g in range(1, "
        "8) "
        "for i in np.flatnonzero(a['search/population/evaluated'][g] == 0))");
}
END_TEST

/* The rows that are there are those of the whole file, and what reads results reads these, too. */
START_TEST(less_is_stored_where_less_is_asked_for)
{
    static const char *const words[] = {"best", "every"};
    const char *thin = temp("thin.h5"), *word = words[_i];
    HIFDM(0, "run", CHEN, "-o", thin, "--quiet", "--set", "optimize.generations=8", "--set",
          keep(formatted("optimize.store=%s", word)), "--set", "optimize.store_every=3");
    EXPECT(thin, run_once(), "--", formatted("holds_of(a, b, '%s', 3)", word),
           "a['search'].attrs['evaluations'] == b['search'].attrs['evaluations']",
           "a['search'].attrs['initial_psi_m'] == b['search'].attrs['initial_psi_m']",
           "all(name.startswith(('search/', 'case/')) for name in differing(a, b))");
    HIFDM(1, "diff", thin, run_once());
    HIFDM(0, "show", thin, "-v");
    OUT("found in generation ");
    HIFDM(0, "report", thin, "-o", temp("thin.html"));
    HIFDM(0, "export", thin, "--stage", "search", "--csv", temp("thin"));
}
END_TEST

Suite *suite_cli_results(void)
{
    Suite *suite = suite_create("cli/results");
    TCase *tcase = tcase_create("results");
    tcase_add_test(tcase, every_data_set_has_units);
    tcase_add_test(tcase, h5dump_reads_the_file);
    tcase_add_test(tcase, the_case_is_kept_with_its_digest);
    tcase_add_test(tcase, a_change_has_the_word_of_its_sign);
    tcase_add_test(tcase, provenance_is_in_the_root_attributes);
    tcase_add_test(tcase, stored_shapes_belong_to_their_numbers);
    tcase_add_test(tcase, every_generation_is_there);
    tcase_add_loop_test(tcase, less_is_stored_where_less_is_asked_for, 0, 2);
    suite_add_tcase(suite, tcase);
    return suite;
}
