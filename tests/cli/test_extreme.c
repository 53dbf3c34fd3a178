/* Values at and beyond the limits are refused quickly, reported as ill-posed, or answered correctly. They never cause a
 * crash, a hang, or a plausible wrong number. */
#include "cli.h"

#define CYLINDER "scene.parabolic_cylinder."

/* ---- sizes ---- */

static const struct {
    const char *modules, *cells, *error;
} huge[] = {
    {"[2000,2000]", "[2000,2000]", "error: scene: 4000001 x 4000001 nodes exceed the maximum of 4000000 nodes\n"},
    {"[2000,1]", "[2000,1]", "error: scene: 4000001 x 2 nodes exceed the maximum of 4000000 nodes\n"},
    {"[2001,1]", "[1,1]", "modules: must be at least 1 and at most 2000, not 2001\n"},
    {"[99999999999999999999,1]", "[1,1]", "must be at least 1 and at most 2000, not 99999999999999999999\n"},
    {"[0,1]", "[1,1]", "modules: must be at least 1 and at most 2000, not 0\n"},
    {"[-5,1]", "[1,1]", "modules: must be at least 1 and at most 2000, not -5\n"},
    /* few enough nodes, but their band matrix would need 4 GB per thread */
    {"[1,1]", "[800,800]",
     "error: the band matrix with 641597 rows and half-bandwidth 801 is too large. Use fewer nodes\n"},
};

/* 10 s of processor time is 100 times what it takes, and far less than any of these nets would. */
START_TEST(huge_nets_are_refused_quickly)
{
    static const char *const commands[] = {"run", "check"};
    for (int i = 0; i < 2; i++) {
        const char *modules = keep(formatted(CYLINDER "modules=%s", huge[_i].modules)),
                   *cells = keep(formatted(CYLINDER "cells_per_module=%s", huge[_i].cells));
        const char *const argv[] = {"sh",
                                    "-c",
                                    "ulimit -t 10; exec \"$0\" \"$@\"",
                                    hifdm_program(),
                                    commands[i],
                                    REFLECTOR,
                                    "--set",
                                    modules,
                                    "--set",
                                    cells,
                                    "--set",
                                    CYLINDER "scallop=0",
                                    i == 0 ? "-o" : NULL,
                                    temp("nowhere.h5"),
                                    NULL};
        struct command command = run_command(HANG_S, argv);
        ck_assert_msg(command.exit_code == 2 || command.exit_code == 5, "%d", command.exit_code);
        demand_part(command.err, huge[_i].error, __LINE__);
        free_command(&command);
        ck_assert(!is_there(temp("nowhere.h5")));
    }
}
END_TEST

/* A population that no memory holds; the limit keeps a machine with 100 GB from trying. The address sanitizer reserves
 * more than any limit leaves. */
START_TEST(huge_population_is_out_of_memory)
{
#ifdef __SANITIZE_ADDRESS__
    return;
#endif
    SHELL(5,
          "ulimit -v 4000000; exec \"$0\" run \"$1\" -o \"$2\" --set optimize.population=100000 --set " CYLINDER
          "modules=[40,40] --set form.rms_tolerance_m=1",
          CHEN, temp("c.h5"));
    ERR("error: out of memory for 100000 individuals of 6560 design variables");
    ck_assert(!is_there(temp("c.h5")));
}
END_TEST

/* ---- tensions: the shape does not depend on their unit ---- */

static const char *const pretensions[] = {"1e-300", "1e-160", "1e-30", "1e-3", "1e3", "1e9"};
enum { N_PRETENSION = sizeof pretensions / sizeof *pretensions };

/* Residual and tolerance scale with the pretension, so even the iterations are the same; 1e-9 m: roundings of powers
 * that are not of two, over a few hundred iterations. */
START_TEST(shape_does_not_depend_on_the_pretension)
{
    const char *path = file_with("c.yaml", SMALL_SCENE), *ten = temp("ten.h5"), *other = temp("other.h5");
    HIFDM(0, "run", path, "-o", ten);
    HIFDM(0, "run", path, "-o", other, "--set", keep(formatted("form.pretension_N=%s", pretensions[_i])));
    EXPECT(ten, other, "--", "near(a['form'].attrs['iterations'], b['form'].attrs['iterations'], 1)",
           "np.abs(a['form/position_m'][:] - b['form/position_m'][:]).max() < 1e-9");
}
END_TEST

#define SQUARE                                                                                                         \
    "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,2,0,0.3,support\nc,2,2,0,support\nd,0,2,0.3,support\n"                    \
    "p,0.9,0.8,0.1,inner\nq,1.2,1.1,0.2,inner\n"
#define SQUARE_CABLES(T)                                                                                               \
    "id,i,j,group,law,value\n1,a,p,inner,tension," T "\n2,b,p,inner,tension," T "\n3,d,p,inner,tension," T             \
    "\n4,p,q,inner,length,0.3\n5,q,c,boundary,tension," T "\n6,b,q,inner,tension," T "\n7,d,q,inner,tension," T "\n"

/* The same with every tension in the table of cables: form.pretension_N, which no cable uses, must not decide when the
 * shape is good enough. 1e-4 m: the tolerance of 1e-7 on forces leaves less. */
START_TEST(shape_does_not_depend_on_an_unused_pretension)
{
    const char *ten = temp("ten.h5"), *small = temp("small.h5");
    HIFDM(0, "run", net_with(SQUARE, SQUARE_CABLES("10")), "-o", ten);
    HIFDM(0, "run", net_with(SQUARE, SQUARE_CABLES("1e-5")), "-o", small);
    EXPECT(ten, small, "--", "np.abs(a['form/position_m'][:] - b['form/position_m'][:]).max() < 1e-4");
}
END_TEST

/* ---- geometry ---- */

static const struct {
    const char *set;
    int exit_code;
} odd_cylinders[] = {
    {CYLINDER "focal_length_m=1e9", 0},
    {CYLINDER "focal_length_m=1e-3", 2}, /* scallops of 1250 m long spans */
    {CYLINDER "aperture_m=1e-9", 2},
    {CYLINDER "scallop=0.4", 0},
    {CYLINDER "scallop=0", 4},
    {CYLINDER "scallop=1e-12", 4},
    {CYLINDER "scallop=0.41", 2},
    {CYLINDER "cells_per_module=[1,1]", 2},
    {CYLINDER "modules=[1,1]", 0},
    {CYLINDER "supports=perimeter", 0},
    {CYLINDER "supports=ribs", 0},
    {CYLINDER "spacing=equal_projected", 0},
    {CYLINDER "boundary=module_edges", 4},
    {"form.method=fdm", 0},
    {"form.method=iterative_fdm", 0},
    {"form.collapse_ratio=0.5", 0},
    {"form.max_iterations=1", 3},
};
enum { N_ODD = sizeof odd_cylinders / sizeof *odd_cylinders };

/* Whatever is answered with 0 is an equilibrium by our own sum of the forces on each node: 1e-5 N, ten times what the
 * default tolerance allows of 10 N, since that counts the tension of the law and this one the tension of the shape. */
START_TEST(odd_cylinders_are_answered_or_refused)
{
    const char *path = temp("o.h5");
    HIFDM(odd_cylinders[_i].exit_code, "run", REFLECTOR, "-o", path, "--set", "form.max_iterations=3000", "--set",
          odd_cylinders[_i].set);
    if (odd_cylinders[_i].exit_code == 0)
        EXPECT(path, "--", "residual_N(a) < 1e-5", "np.isfinite(a['form/position_m'][:]).all()",
               "(a['form/tension_N'][:] > 0).all()");
    else if (odd_cylinders[_i].exit_code != 3)
        ck_assert(!is_there(path));
}
END_TEST

/* ---- nets that have no answer ---- */

#define THREE "id,x_m,y_m,z_m,role,Fz_N\na,0,0,0,support,\nb,2,0,0,support,\nc,1,0,0,inner,-1\n"

/* Force densities that all but cancel: the node would be 10^16 m away. */
START_TEST(cancelling_struts_are_singular)
{
    HIFDM(4, "run",
          net_with(THREE, "id,i,j,group,law,value\n1,a,c,inner,force_density,1\n"
                          "2,c,b,inner,force_density,-1\n"),
          NOWHERE);
    ERR("error: ill-posed: the force density matrix is singular or not positive definite at node c (cables 1, 2). The "
        "cables of this node are slack, cannot balance its load, or do not lead to a support\n");
    HIFDM(4, "run",
          net_with(THREE, "id,i,j,group,law,value\n1,a,c,inner,force_density,1\n"
                          "2,c,b,inner,force_density,-0.9999999999999999\n"),
          NOWHERE);
    ERR("error: ill-posed: ");
}
END_TEST

/* The hand case of issue 2, to the last bit but rounding: both q = 1, load -1 N: (1, 0, -0.5). */
START_TEST(hand_case)
{
    HIFDM(0, "run",
          net_with(THREE, "id,i,j,group,law,value\n1,a,c,inner,force_density,1\n2,c,b,inner,force_density,1\n"), "-o",
          temp("h.h5"), "--json");
    EXPECT(temp("h.h5"), "--", "np.allclose(a['form/position_m'][2], [1, 0, -0.5], rtol=0, atol=1e-15)");
    OUT("\"stop_reason\": \"direct\"");
    OUT("\"boundary_tension_ratio\": null"); /* there is no boundary cable */
}
END_TEST

/* Lengths that cannot be: 1.8 m of cable between supports 2 m apart. The chain is named and the reason told. */
START_TEST(impossible_lengths_are_ill_posed)
{
    HIFDM(4, "run", net_with(THREE, "id,i,j,group,law,value\n1,a,c,inner,length,0.9\n2,c,b,inner,length,0.9\n"),
          NOWHERE);
    ERR("error: ill-posed: ");
    ERR("1 + 2");
    HIFDM(0, "run", net_with(THREE, "id,i,j,group,law,value\n1,a,c,inner,length,1.1\n2,c,b,inner,length,1.1\n"), "-o",
          temp("l.h5"));
    /* Pythagoras; 1e-7 is the tolerance on lengths, times 1.1 over the sag */
    EXPECT(temp("l.h5"), "--", "near(a['form/position_m'][2, 2], -(1.1**2 - 1) ** 0.5, 3e-7)");
}
END_TEST

/* A node between two supports is in balance wherever it stands on their line, but its cables have the tension that was
 * asked for only where the iteration ends. 1e-6: ten times the tolerance on forces. */
START_TEST(tensions_are_those_asked_for)
{
    HIFDM(0, "run",
          net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,2,0,0,support\nc,0.3,0.5,0,inner\n",
                   "id,i,j,group,law,value\n1,a,c,inner,tension,10\n2,c,b,inner,tension,10\n"),
          "-o", temp("t.h5"));
    EXPECT(temp("t.h5"), "--", "np.allclose(a['form/tension_N'], 10, rtol=1e-6, atol=0)");
}
END_TEST

/* ---- optimisation ---- */

/* Genes stay within range_N of the found tensions; when the bounds leave nothing of that, it is told. */
START_TEST(bounds_that_exclude_the_range_are_told)
{
    struct command command = run_hifdm("run", CHEN, "-o", temp("c.h5"), "--set", "optimize.min_tension_N=100", "--set",
                                       "optimize.generations=2");
    ck_assert_msg(command.exit_code != 0 || strstr(command.err, "min_tension_N"), "%s%s", command.out, command.err);
    free_command(&command);
}
END_TEST

static const char *const small_gas[] = {"optimize.population=2",     "optimize.generations=1",
                                        "optimize.elites=49",        "optimize.range_N=1e9",
                                        "optimize.range_N=1e-12",    "optimize.mutation_low=0",
                                        "optimize.max_tension_N=45", "optimize.stagnation_generations=1"};

START_TEST(odd_optimisations_never_lose_against_their_base)
{
    HIFDM(0, "run", CHEN, "-o", temp("c.h5"), "--set", "optimize.generations=3", "--set", small_gas[_i]);
    EXPECT(temp("c.h5"), "--", "a['search/population/best_psi_m'][-1] <= a['search/population/psi_m'][0, 0]",
           "(a['variable/lower'][:] >= 0.1).all() and (a['variable/upper'][:] > a['variable/lower'][:]).all()");
}
END_TEST

Suite *suite_cli_extreme(void)
{
    Suite *suite = suite_create("cli/extreme");
    TCase *tcase = tcase_create("extreme");
    tcase_add_loop_test(tcase, huge_nets_are_refused_quickly, 0, sizeof huge / sizeof *huge);
    tcase_add_test(tcase, huge_population_is_out_of_memory);
    tcase_add_loop_test(tcase, shape_does_not_depend_on_the_pretension, 0, N_PRETENSION);
    tcase_add_test(tcase, shape_does_not_depend_on_an_unused_pretension);
    tcase_add_loop_test(tcase, odd_cylinders_are_answered_or_refused, 0, N_ODD);
    tcase_add_test(tcase, cancelling_struts_are_singular);
    tcase_add_test(tcase, hand_case);
    tcase_add_test(tcase, impossible_lengths_are_ill_posed);
    tcase_add_test(tcase, tensions_are_those_asked_for);
    tcase_add_test(tcase, bounds_that_exclude_the_range_are_told);
    tcase_add_loop_test(tcase, odd_optimisations_never_lose_against_their_base, 0,
                        sizeof small_gas / sizeof *small_gas);
    suite_add_tcase(suite, tcase);
    return suite;
}
