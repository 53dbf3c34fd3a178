/* What `hifdm export` gives to other programs and to the workshop: ParaView files, cut lists; and the measures of the
 * surface. */
#include "cli.h"

#define FREQUENCIES "surface.frequencies_Hz=[1.2e9, 2.4e9, 9.6e9]"

static const char *run_chen(void)
{
    const char *out = temp("c.h5");
    HIFDM(0, "run", CHEN, "-o", out, "--quiet", "--set", "optimize.generations=3", "--set", FREQUENCIES);
    return out;
}

/* ---- ParaView ---- */

static void demand_vtk(const char *result, const char *folder, const char *stages)
{
    const char *const argv[] = {python_program(), source_path("tests/cli/vtk_reads.py"), result, folder, NULL};
    demand_exit(run_command(HANG_S, argv), 0, "vtk_reads.py", __LINE__);
    if (strstr(said.out, "no VTK here")) skip_for_tool("cli/workshop: files read by VTK", "no Python module vtk");
    OUT(stages);
}

START_TEST(paraview_files_hold_the_stored_numbers)
{
    const char *out = run_chen(), *folder = temp("vtk");
    HIFDM(0, "export", out, "--vtk", folder);
    OUT("for ParaView, in ");
    OUT(": target.hdf target_facets.hdf form.hdf form_facets.hdf search.hdf search_facets.hdf refine.hdf "
        "refine_facets.hdf\n");
    demand_vtk(out, folder, "form form_facets refine refine_facets search search_facets target target_facets");
}
END_TEST

START_TEST(paraview_file_of_the_truss)
{
    const char *out = temp("t.h5"), *folder = temp("vtk");
    HIFDM(0, "run", keep(source_path("configs/straight-edges-truss.yaml")), "-o", out, "--quiet", "--set",
          "optimize.generations=1");
    HIFDM(0, "export", out, "--vtk", folder);
    OUT(" refine.hdf truss.hdf\n");
    demand_vtk(out, folder, "form refine search target truss");
}
END_TEST

/* The result file itself, of a rigid rim, of a truss, of states as built, of samples; whatever its name. */
START_TEST(paraview_opens_the_result)
{
    static const char *const argument[][5] = {
        {"configs/straight-edges.yaml", "optimize.generations=3", "title=grid", "form refine search\n", "c.h5"},
        {"configs/straight-edges-truss.yaml", "optimize.generations=1", "title=grid", "form refine search\n", "t.hdf"},
        {"configs/paraboloid-load-cases.yaml", "title=grid", "title=grid",
         "form load_case_cold load_case_cup_down load_case_cup_up load_case_spun load_case_sun\n", "e.hdf"},
        {NULL, "scene.EA_inner_N=1e5", "scene.EA_boundary_N=2e5", "form\n", "s.hdf"}};
    const char *samples = file_with("s.yaml", SMALL_SCENE "tolerance: {sigma_cut_m: 1e-4, samples: 20}\n");
    const char *const *of = argument[_i], *out = temp(of[4]);
    HIFDM(0, "run", of[0] ? keep(source_path(of[0])) : samples, "-o", out, "--quiet", "--set", of[1], "--set", of[2]);
    const char *const argv[] = {python_program(), source_path("tests/cli/vtk_reads.py"), out, NULL};
    demand_exit(run_command(HANG_S, argv), 0, "vtk_reads.py", __LINE__);
    if (strstr(said.out, "no VTK here")) skip_for_tool("cli/workshop: results read by VTK", "no Python module vtk");
    OUT(of[3]);
    HIFDM(0, "show", out);
}
END_TEST

/* Triangles of a double net and quadrilaterals of a cylinder: their errors along the normal, by numpy. */
START_TEST(paraview_files_of_facets)
{
    static const char *const text[] = {"scene: {paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 6, "
                                       "rear_distance_m: 1.8}}\nsurface: {}\n",
                                       SMALL_SCENE "surface: {}\n"};
    const char *out = temp("f.h5"), *folder = temp("vtk");
    HIFDM(0, "run", file_with("f.yaml", text[_i]), "-o", out, "--quiet");
    HIFDM(0, "export", out, "--vtk", folder);
    OUT(": target.hdf target_facets.hdf form.hdf form_facets.hdf\n");
    demand_vtk(out, folder, "form form_facets target target_facets");
    SHELL(0, "cd \"$1\" && rm form.hdf target.hdf target_facets.hdf", folder);
    HIFDM(5, "export", out, "--vtk", folder);
    ERR("form_facets.hdf already exists. Use --force to replace it");
}
END_TEST

/* The pillow of triangles and quadrilaterals, against membranes by harmonic polynomials. A mesh that a cable cannot
 * hold is told, and the facets have no errors then. */
START_TEST(mesh_makes_pillows)
{
    static const char *const grid[] = {"scene.paraboloid.grid=triangle", "scene.paraboloid.grid=quad"};
    const char *out = temp("m.h5"),
               *path = file_with("m.yaml", "scene: {paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 4, "
                                           "rear_distance_m: 1.8}}\nform: {prestress: exact}\nsurface: {}\n");
    HIFDM(0, "run", path, "-o", out, "-v", "--set", grid[_i], "--set", "surface.mesh_tension_N_per_m=1", "--set",
          "surface.frequencies_Hz=[2e9]");
    OUT("; pillow 0.");
    OUT("gain loss at 2 GHz, physical optics:\n                  refocused feed: gain ");
    HIFDM(0, "export", out, "--vtk", temp("vtk"));
    const char *const argv[] = {python_program(), keep(source_path("tests/verify/mesh_oracle.py")), out,
                                temp("vtk/form_facets.hdf"), NULL};
    demand_exit(run_command(HANG_S, argv), 0, "mesh_oracle.py", __LINE__);
    demand_vtk(out, temp("vtk"), "form form_facets target target_facets");
    HIFDM(0, "run", path, "-o", out, "--force", "--json", "--set", grid[_i], "--set",
          "surface.mesh_tension_N_per_m=100");
    ERR("warning: surface: in the shape of stage form, the mesh pulls on a cable with N l = ");
    ERR("which does not hold here, so hifdm reports no facet errors. Raise the cable tensions, or lower "
        "surface.mesh_tension_N_per_m\n");
    EXPECT(out_as("m.json"), out, "--", "a['form']['surface']['facet_normal_rms_m'] is None",
           "a['form']['surface']['pillow_rms_m'] is None", "a['form']['surface']['mesh_pull_ratio'] > 1",
           "np.isnan(b['surface/form'].attrs['facet_fit_normal_rms_m'])");
    HIFDM(0, "report", out, "-o", temp("m.html"));
    HIFDM(0, "export", out, "--vtk", temp("vtk2"));
}
END_TEST

/* Loads, a slack cable, the law elastic, no optimisation; and nothing is replaced unasked. */
START_TEST(paraview_files_of_an_imported_net)
{
    const char *path = net_with("id,x_m,y_m,z_m,role,Fz_N\na,0,0,0,support,\nb,1,0,0.1,inner,-3\nc,2,0,0,support,\n"
                                "d,1,0,-5,support,\n",
                                "id,i,j,group,law,value,EA_N\nab,a,b,inner,elastic,1.01,5000\n"
                                "bc,b,c,inner,tension,10,\nbd,b,d,inner,elastic,7,5000\n");
    const char *out = temp("net.h5"), *folder = temp("vtk"), *form = temp("vtk/form.hdf");
    HIFDM(0, "run", path, "-o", out, "--quiet");
    ERR("warning: these cables of the form-finding shape are slack (1): bd\n");
    HIFDM(0, "export", out, "--vtk", folder);
    demand_vtk(out, folder, "form target");
    write_file(form, "mine");
    HIFDM(5, "export", out, "--vtk", folder);
    ERRS("error: the file %s already exists. Use --force to replace it", form);
    ck_assert(file_is(form, "mine"));
    HIFDM(0, "export", out, "--vtk", folder, "--force");
    demand_vtk(out, folder, "form target");
    HIFDM(2, "export", out, "--vtk", folder, "--stage", "form");
    ERR("error: the option --stage cannot be combined with --vtk alone, because that option exports all shapes\n");
    HIFDM(5, "export", out, "--vtk", temp("no/such/folder"));
    ERR("cannot create this folder");
    HIFDM(5, "export", out, "--vtk", form); /* below an ordinary file */
    ERR("Not a directory");
}
END_TEST

/* ---- cut list ---- */

/* The net that is built from the cut lengths, hung into the target positions, comes to the stored shape. 1e-9 m is
 * what an engineer could ask for; 17 digits of l0 of 1 m, at 47 kN and some 0.3 N/m of the softest motion, are
 * 1e-11 m. */
START_TEST(net_built_from_the_cut_list_has_the_found_shape)
{
    static const char *const stage[] = {"form", "search", "refine"}, *const word[] = {"form", "search", "refine"};
    const char *out = run_chen(), *built = temp("built.h5"), *cut = temp("cut.csv");
    HIFDM(0, "export", out, "--cutlist", cut, "--csv", temp("net"), "--stage", word[_i], "--force");
    OUT("cutting lengths of 220 cables of the ");
    SHELL(0, "cd \"$1\" && sed -e '1s/.*/id,found_x,found_y,found_z,x_m,y_m,z_m,role/' net/nodes.csv >start.csv",
          temp("."));
    const char *path =
        file_with("built.yaml", "scene: {import: {nodes: start.csv, cables: cut.csv}}\n"
                                "form: {method: newton, residual_tolerance: 1e-12, length_tolerance: 1e-12}\n");
    HIFDM(0, "run", path, "-o", built, "--quiet");
    EXPECT(out, built, file_with("stage", stage[_i]), "--",
           "(b['scene/node/position_m'][:] == a['scene/node/position_m'][:]).all()", /* not the found shape itself */
           "np.abs(a[c.decode()]['position_m'][:] - b['form/position_m'][:]).max() < 1e-9",
           "np.abs(a[c.decode()]['tension_N'][:] - b['form/tension_N'][:]).max() < 1e-6",
           "(b['form/law'][:] == 3).all()", "b['form'].attrs['length_error'] < 1e-12");
    /* the two files together are a net as well */
    path = file_with("jig.yaml", "scene: {import: {nodes: cut_nodes.csv, cables: cut.csv}}\n"
                                 "form: {residual_tolerance: 1e-12, length_tolerance: 1e-12}\n");
    HIFDM(0, "run", path, "-o", built, "--quiet", "--force");
    EXPECT(out, built, file_with("stage", stage[_i]), "--",
           "a[c.decode()]['position_m'][:].tobytes() == b['scene/node/position_m'][:].tobytes()",
           "np.abs(a[c.decode()]['position_m'][:] - b['form/position_m'][:]).max() < 1e-9");
}
END_TEST

START_TEST(cut_list_holds_what_it_says)
{
    const char *out = run_chen(), *cut = temp("cut.csv");
    HIFDM(0, "export", out, "--cutlist", cut, "--stage", "form");
    EXPECT(
        cut, temp("cut_mm.csv"), "--",
        "[r['id'] for r in a] == [r['id'] for r in b] and list(b[0])[:5] == ['id', 'i', "
        "'j', 'group', 'unstressed_length_mm'] and [r['set'] for r in a] == [r['set'] for r in b]",
        "all(abs(1e3 * float(r[k + '_m']) - float(s[k + '_mm'])) < 0.00050001 and len(s[k + '_mm'].split('.')[1]) == 3 "
        "for r, s in zip(a, b) for k in ('unstressed_length', 'length', 'elongation', 'unstressed_minus_target'))",
        "all(abs(float(r['tension_N']) - float(s['tension_N'])) < 0.0050001 for r, s in zip(a, b))",
        "not any(v in ('-0.000', '-0.00') for s in b for v in s.values())");
    EXPECT(
        cut, temp("cut_nodes.csv"), temp("cut_totals.csv"), out, "--", "len(a) == 220", "len(b) == 121",
        "list(a[0]) == ['id', 'i', 'j', 'group', 'tension_N', 'length_m', 'unstressed_length_m', 'elongation_m', "
        "'EA_N', "
        "'unstressed_minus_target_m', 'law', 'value', 'set']",
        "[r['id'] for r in a] == texts(d['scene/cable/id'])",
        "column(a, 'tension_N').tobytes() == d['form/tension_N'][:].tobytes()",
        "column(a, 'length_m').tobytes() == d['form/length_m'][:].tobytes()",
        "column(b, 'x_m', 'y_m', 'z_m').tobytes() == d['form/position_m'][:].tobytes()",
        "(column(a, 'EA_N') == 47000).all()",
        "np.allclose(column(a, 'unstressed_length_m') * (1 + column(a, 'tension_N') / 47000), column(a, 'length_m'), "
        "rtol=4e-16)",
        "np.allclose(column(a, 'elongation_m'), column(a, 'length_m') - column(a, 'unstressed_length_m'), atol=1e-15)",
        "np.allclose(column(a, 'unstressed_minus_target_m'), (column(a, 'length_m') - d['scene/cable/length_m'][:]) / "
        "(1 + column(a, 'tension_N') / 47000), atol=1e-15)",
        "(column(a, 'unstressed_length_m') == column(a, 'value')).all()", "{r['law'] for r in a} == {'elastic'}",
        "[r['group'] for r in c] == ['inner', 'boundary', 'all', 'directrix', 'edge', 'generatrix']",
        "[r['cables'] for r in c] == ['100', '120', '220', '110', '40', '110']",
        "near(sum(float(r['unstressed_length_m']) for r in a if r['group'] == 'inner'), "
        "float(c[0]['unstressed_length_m']), 1e-12)",
        "near(sum(float(r['length_m']) for r in a), float(c[2]['length_m']), 1e-12)",
        "min(float(r['unstressed_minus_target_m']) for r in a) == float(c[2]['unstressed_minus_target_min_m'])",
        "max(float(r['unstressed_minus_target_m']) for r in a) == float(c[2]['unstressed_minus_target_max_m'])",
        "min(float(r['tension_N']) for r in a if r['group'] == 'inner') == float(c[0]['tension_min_N'])",
        "max(float(r['tension_N']) for r in a if r['group'] == 'boundary') == float(c[1]['tension_max_N'])");
}
END_TEST

/* What a workshop buys by family, and what `adjust` needs to know of the net that comes back. */
START_TEST(cut_list_keeps_the_families)
{
    const char *out = temp("p.h5"), *again = temp("again.h5"), *cut = temp("cut.csv");
    HIFDM(0, "run",
          file_with("p.yaml", "scene:\n  EA_inner_N: 5e4\n  EA_boundary_N: 5e4\n"
                              "  paraboloid: {aperture_m: 4, focal_length_m: 3, rings: 2, rear_distance_m: 1}\n"
                              "form: {prestress: exact}\n"),
          "-o", out, "--quiet");
    HIFDM(0, "export", out, "--cutlist", cut);
    EXPECT(cut, temp("cut_totals.csv"), out, "--",
           "[r['group'] for r in b] == ['inner', 'boundary', 'all', 'front', 'front_edge', 'rear', 'rear_edge', 'tie']",
           "all(int(r['cables']) == sum(c['set'] == r['group'] for c in a) > 0 for r in b[3:])",
           "all(near(float(r['unstressed_length_m']), sum(float(c['unstressed_length_m']) for c in a if c['set'] == "
           "r['group']), 1e-12) for r in "
           "b[3:])");
    HIFDM(0, "run", file_with("again.yaml", "scene: {import: {nodes: cut_nodes.csv, cables: cut.csv}}\n"), "-o", again);
    ck_assert_str_eq(said.err, "");
    EXPECT(out, again, "--", "sets_of(a) == sets_of(b)", "len(sets_of(a)) == 5");
}
END_TEST

/* Of a cable that hangs loose the shape tells no length: its law does. */
START_TEST(slack_cables_are_cut_as_their_law_says)
{
    const char *path = net_with("id,x_m,y_m,z_m,role,Fz_N\na,0,0,0,support,\nb,1,0,0.1,inner,-3\nc,2,0,0,support,\n"
                                "d,1,0,-1,support,\ne,1,1,-1,support,\n",
                                "id,i,j,group,law,value,EA_N\nab,a,b,inner,tension,10,5000\n"
                                "bc,b,c,inner,tension,10,5000\nbd,b,d,inner,elastic,1.5,4000\n"
                                "be,b,e,boundary,length,2.5,4000\n");
    HIFDM(0, "run", path, "-o", temp("s.h5"), "--quiet");
    HIFDM(0, "export", temp("s.h5"), "--cutlist", temp("s.csv"));
    EXPECT(temp("s.csv"), temp("s_nodes.csv"), "--", "[float(r['unstressed_length_m']) for r in a[2:]] == [1.5, 2.5]",
           "near(float(a[0]['unstressed_length_m']), float(a[0]['length_m']) / 1.002, 1e-9)",
           "float(b[1]['Fz_N']) == -3");
}
END_TEST

START_TEST(cut_list_needs_EA)
{
    const char *out = temp("f.h5"), *cut = temp("cut.csv");
    HIFDM(0, "run", file_with("f.yaml", SMALL_SCENE), "-o", out, "--quiet");
    HIFDM(2, "export", out, "--cutlist", cut);
    ERR("inner cables have no stiffness EA, which cutting lengths need. One of these cables is 'n");
    ERR("Add the key scene.EA_inner_N, or add the column EA_N to the table of an imported net, and run again\n");
    ERR("boundary cables have no stiffness EA");
    HIFDM(0, "run", temp("f.yaml"), "-o", out, "--quiet", "--force", "--set", "scene.EA_inner_N=5e4");
    HIFDM(2, "export", out, "--cutlist", cut);
    ERR("boundary cables have no stiffness EA");
    ck_assert_ptr_null(strstr(said.err, "inner cables have no stiffness EA"));
    ck_assert(!is_there(cut));
    HIFDM(0, "run", temp("f.yaml"), "-o", out, "--quiet", "--force", "--set", "scene.EA_inner_N=5e4", "--set",
          "scene.EA_boundary_N=6e4");
    write_file(temp("cut_totals.csv"), "mine");
    HIFDM(5, "export", out, "--cutlist", cut); /* none of the three unless all three */
    ERR("cut_totals.csv already exists. Use --force to replace it");
    ck_assert(!is_there(cut));
    HIFDM(0, "export", out, "--cutlist", cut, "--force");
    EXPECT(cut, "--", "{(r['group'], r['EA_N']) for r in a} == {('inner', '50000'), ('boundary', '60000')}");
    HIFDM(2, "run", temp("f.yaml"), NOWHERE, "--set", "scene.EA_inner_N=0");
    ERR("scene.EA_inner_N: must be above 0");
    HIFDM(2, "run", temp("f.yaml"), NOWHERE, "--set", "scene.EA_inner_N=");
    ERR("there is no value");
}
END_TEST

/* An imported net takes what its file leaves open from the case. */
START_TEST(case_completes_EA_of_an_imported_net)
{
    net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,0.1,inner\nc,2,0,0,support\n",
             "id,i,j,group,law,value,EA_N\nab,a,b,inner,elastic,0.99,7000\nbc,b,c,inner,elastic,0.99,\n");
    HIFDM(2, "check", temp("net.yaml"));
    ERR("cables.csv:3: 'bc': the law elastic needs an EA_N\n");
    HIFDM(0, "check", temp("net.yaml"), "--set", "scene.EA_inner_N=8000");
    OUT("0 force density, 2 elastic\n");
    HIFDM(0, "run", temp("net.yaml"), "-o", temp("net.h5"), "--quiet", "--set", "scene.EA_inner_N=8000");
    EXPECT(temp("net.h5"), "--", "a['scene/cable/EA_N'][:].tolist() == [7000, 8000]");
}
END_TEST

/* ---- measures of the surface ---- */

START_TEST(surface_is_measured_for_every_shape)
{
    const char *out = temp("c.h5");
    HIFDM(0, "run", CHEN, "-o", out, "--json", "--set", "optimize.generations=3", "--set", FREQUENCIES);
    const char *json = out_as("run.json");
    HIFDM(0, "show", out, "--json");
    const char *shown = out_as("show.json");
    for (int i = 0; i < 3; i++) {
        static const char *const stage[] = {"form", "search", "refine"};
        EXPECT(out, json, shown, file_with("stage", stage[i]), "--",
               "b[d.decode()]['surface'] == c[d.decode()]['surface']",
               "all((b[d.decode()]['surface'][k] is None if v != v else b[d.decode()]['surface'][k] == v) "
               "for k, v in a['surface'][d.decode()].attrs.items() if k in b[d.decode()]['surface'])",
               "len(b[d.decode()]['surface']) == 48",
               /* the losses of the facets, from their own RMS; their place in the file is that in JSON */
               "near(b[d.decode()]['surface']['facet_gain_loss_dB'][0], 10 / np.log(10) * (4 * np.pi * 1.2e9 / "
               "299792458 * b[d.decode()]['surface']['facet_half_path_rms_m'])**2, 1e-12)",
               "near(b[d.decode()]['surface']['facet_fit_gain_loss_dB'][0], 10 / np.log(10) * (4 * np.pi * 1.2e9 / "
               "299792458 * b[d.decode()]['surface']['facet_fit_half_path_rms_m'])**2, 1e-12)",
               "a['surface'][d]['facet_gain_loss_dB'][:2].tolist() == "
               "b[d.decode()]['surface']['facet_gain_loss_dB'][:2]",
               "a['surface'][d]['facet_fit_gain_loss_dB'][0] == b[d.decode()]['surface']['facet_fit_gain_loss_dB'][0]",
               "a['surface'][d].attrs['facet_ruze_limit_Hz'] == b[d.decode()]['surface']['facet_ruze_limit_Hz']",
               "b[d.decode()]['surface']['kind'] == 'parabolic_cylinder'",
               /* against numpy: the sums in another order */
               "near(np.sqrt(np.mean([(p[2] - p[0]**2 / 282.4)**2 / (1 + (p[0] / 141.2)**2) for p in "
               "a[d.decode()]['position_m'][:][a['scene/node/role'][:] == 1]])), b[d.decode()]['surface']"
               "['normal_rms_m'], 1e-15)",
               "near(np.percentile(np.linalg.norm((a[d.decode()]['position_m'][:] - a['scene/node/position_m'][:])"
               "[a['scene/node/role'][:] == 1], axis=1), 95), b[d.decode()]['surface']['deviation_p95_m'], 1e-15)",
               "b[d.decode()]['surface']['frequency_Hz'] == [1.2e9, 2.4e9, 9.6e9] == "
               "a['surface/frequency_Hz'][:].tolist()",
               "near(b[d.decode()]['surface']['gain_loss_dB'][1] / b[d.decode()]['surface']['gain_loss_dB'][0], 4, "
               "1e-12)",
               /* Ruze's formula ends at 3 dB: the last frequency is beyond it, and every place says so */
               "b[d.decode()]['surface']['gain_loss_dB'][2] is None and np.isnan(a['surface'][d]['gain_loss_dB'][2])",
               "near(b[d.decode()]['surface']['gain_loss_dB'][1] * (b[d.decode()]['surface']['ruze_limit_Hz'] / 2.4e9)"
               "**2, 3, 1e-12)",
               "b[d.decode()]['surface']['ruze_limit_Hz'] < 9.6e9 < 1e12",
               "near(b[d.decode()]['surface']['faceting_rms_m'], 1 / (24 * 5**.5 * 70.6), 1e-18)",
               "b[d.decode()]['surface']['fit_half_path_rms_m'] <= b[d.decode()]['surface']['half_path_rms_m']",
               "b[d.decode()]['surface']['fit_converged'] is True and a['surface'][d].attrs['fit_converged'] == 1");
    }
    HIFDM(0, "report", out, "-o", temp("c.html"));
    char *page = read_file(temp("c.html"), NULL);
    demand_part(page, "\"fit_half_path_rms_m\": ", __LINE__);
    free(page);
    HIFDM(0, "show", out, "-v");
    OUT("surface, parabolic cylinder: half-path RMS ");
    ck_assert_int_eq(count_of(said.out, "gain loss at 1.2 GHz, physical optics:\n"), 3);
    ck_assert_int_eq(count_of(said.out, "gain loss at 9.6 GHz, physical optics:\n"), 3);
    ck_assert_ptr_null(strstr(said.out, "inf dB")); /* beyond 3 dB, Ruze's formula gives nothing */
    ck_assert_int_eq(count_of(said.out, "deviation of 50/90/95/99 % of the nodes at most "), 3);
}
END_TEST

/* Tensions of named sets, the same in the summary, in JSON and in the file, and by numpy from the cables. */
START_TEST(tension_ratio_of_each_set)
{
    const char *out = temp("sets.h5");
    HIFDM(0, "run", REFLECTOR, "-o", out, "--verbose");
    OUT("                tension ratio of sets: directrix ");
    HIFDM(0, "show", out, "--json");
    EXPECT(out_as("sets.json"), out, "--",
           "list(a['form']['sets']) == b['set_tension/form/name'].asstr()[:].tolist() == "
           "['directrix', 'edge', 'generatrix']",
           "[s['tension_ratio'] for s in a['form']['sets'].values()] == b['set_tension/form/ratio'][:].tolist()",
           "[s['min_N'] for s in a['form']['sets'].values()] == b['set_tension/form/min_N'][:].tolist()",
           "all(t.max() / t.min() == r and t.max() == m for t, r, m in zip([b['form/tension_N'][:]"
           "[b['scene/set/cable'][p:q]] for p, q in zip(b['scene/set/start'][:], b['scene/set/start'][1:])], "
           "b['set_tension/form/ratio'][:], b['set_tension/form/max_N'][:]))");
}
END_TEST

/* Nothing of it in a case that does not ask; what is asked for in vain or wrongly is told. */
START_TEST(surface_is_measured_only_when_asked_for)
{
    const char *out = temp("s.h5"), *path = file_with("s.yaml", SMALL_SCENE);
    HIFDM(0, "run", path, "-o", out, "--json");
    ck_assert_ptr_null(strstr(said.out, "surface"));
    EXPECT(out, "--", "'surface' not in a");
    HIFDM(0, "run", file_with("e.yaml", SMALL_SCENE "surface: {}\n"), "-o", out, "--json", "--force");
    EXPECT(out, out_as("e.json"), "--", "b['form']['surface']['frequency_Hz'] == []", "set(a['surface/form']) == set()",
           "near(a['surface'].attrs['strip_width_m'], 0.5, 0)", "a['surface'].attrs['focal_length_m'] == 2");
    /* the quadrilaterals of 5 x 7 nodes, f = 2 m, against numpy: sums in another order;
     * more points tell what 3 x 3 leave out for slopes that change in a cell, 2e-6 of the RMS */
    EXPECT(out, out_as("e.json"), "--", "b['form']['surface']['n_facet'] == a['surface/form'].attrs['n_facet'] == 24",
           "near(facet_rms(a['form/position_m'][:].reshape(7, 5, 3), 2, 3), "
           "b['form']['surface']['facet_normal_rms_m'], 1e-15)",
           "near(facet_rms(a['form/position_m'][:].reshape(7, 5, 3), 2, 8), "
           "b['form']['surface']['facet_normal_rms_m'], 1e-7)",
           "b['form']['surface']['facet_normal_rms_m'] == a['surface/form'].attrs['facet_normal_rms_m']",
           "b['form']['surface']['facet_fit_normal_rms_m'] < b['form']['surface']['facet_normal_rms_m']",
           "b['form']['surface']['n_open_face'] == 0");
    net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,0.083,inner\nc,2,0,0.333,support\n",
             "id,i,j,group,law,value\nab,a,b,inner,tension,\nbc,b,c,inner,tension,\n");
    HIFDM(2, "run", temp("net.yaml"), NOWHERE, "--set", "surface.frequencies_Hz=1e9");
    ERR("surface.focal_length_m: is missing: an imported net does not tell its surface\n");
    HIFDM(0, "run", temp("net.yaml"), "-o", out, "--json", "--force", "--set", "surface.frequencies_Hz=1e9", "--set",
          "surface.focal_length_m=3");
    EXPECT(out_as("n.json"), "--", "a['form']['surface']['faceting_rms_m'] is None",
           "len(a['form']['surface']['gain_loss_dB']) == 1");
    HIFDM(2, "run", path, NOWHERE, "--set",
          "surface.frequencies_Hz=[1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,"
          "21,22,23,24,25,26,27,28,29,30,31,32,33]");
    ERR("must be a list of at most 32 numbers, like [1, 2.5]");
    HIFDM(2, "run", path, NOWHERE, "--set", "surface.frequencies_Hz=[1e9, -1]");
    ERR("must be above 0");
    HIFDM(2, "run", path, NOWHERE, "--set", "surface.frequencies_Hz={a: 1}");
    ERR("must be a list of at most 32 numbers");
    HIFDM(2, "run", path, NOWHERE, "--set", "surface.frequencies_Hz=[[1], 2]");
    ERR("must be a number");
}
END_TEST

Suite *suite_cli_workshop(void)
{
    Suite *suite = suite_create("cli/workshop");
    TCase *tests = tcase_create("trade");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, paraview_files_hold_the_stored_numbers);
    tcase_add_test(tests, paraview_file_of_the_truss);
    tcase_add_loop_test(tests, paraview_opens_the_result, 0, 4);
    tcase_add_loop_test(tests, paraview_files_of_facets, 0, 2);
    tcase_add_test(tests, tension_ratio_of_each_set);
    tcase_add_loop_test(tests, mesh_makes_pillows, 0, 2);
    tcase_add_test(tests, paraview_files_of_an_imported_net);
    tcase_add_loop_test(tests, net_built_from_the_cut_list_has_the_found_shape, 0, 3);
    tcase_add_test(tests, cut_list_holds_what_it_says);
    tcase_add_test(tests, cut_list_keeps_the_families);
    tcase_add_test(tests, slack_cables_are_cut_as_their_law_says);
    tcase_add_test(tests, cut_list_needs_EA);
    tcase_add_test(tests, case_completes_EA_of_an_imported_net);
    tcase_add_test(tests, surface_is_measured_for_every_shape);
    tcase_add_test(tests, surface_is_measured_only_when_asked_for);
    return suite;
}
