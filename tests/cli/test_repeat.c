/* The same case gives the same data sets: for any number of threads, and again; another seed gives others. Compared bit
 * by bit through h5py; attributes hold times and machine, and do not count. */
#include "cli.h"

#define SHORT "--quiet", "--set", "optimize.generations=15"

START_TEST(data_sets_do_not_depend_on_the_number_of_threads)
{
    const char *one = temp("1.h5"), *two = temp("2.h5"), *seven = temp("7.h5");
    HIFDM(0, "run", CHEN, "-o", one, "--threads", "1", SHORT);
    HIFDM(0, "run", CHEN, "-o", two, "--threads", "2", SHORT);
    HIFDM(0, "run", CHEN, "-o", seven, "--threads", "7", SHORT);
    EXPECT(one, two, seven, "--", "differing(a, b) == []", "differing(a, c) == []", "a.attrs['threads'] == 1",
           "c.attrs['threads'] == 7", /* and that much was compared */
           "len(contents(a)) > 30", "designs(a).shape == (15, 50, 120)");
}
END_TEST

/* A band wide enough (half-bandwidth 140) for OpenBLAS to use threads of its own, as many as these variables or the
 * machine's cores say. Stopped after a few iterations, since every one of them would show it. */
START_TEST(data_sets_do_not_depend_on_the_threads_of_the_linear_algebra)
{
    const char *one = temp("1.h5"), *two = temp("2.h5");
    static const char script[] =
        "OPENBLAS_NUM_THREADS=$3 OMP_NUM_THREADS=$3 exec \"$0\" run \"$1\" -o \"$2\" --quiet --set "
        "scene.parabolic_cylinder.modules=[1,1] --set scene.parabolic_cylinder.cells_per_module=[140,150] --set "
        "scene.parabolic_cylinder.supports=perimeter --set form.max_iterations=4 --set form.factor=lapack";
    SHELL(3, script, REFLECTOR, one, "1");
    SHELL(3, script, REFLECTOR, two, "2");
    EXPECT(one, two, "--", "differing(a, b) == []", "a['scene/node/id'].shape == (141 * 151,)");
}
END_TEST

START_TEST(same_seed_same_data_another_seed_others)
{
    const char *first = temp("1.h5"), *again = temp("2.h5"), *other = temp("3.h5");
    HIFDM(0, "run", CHEN, "-o", first, SHORT);
    HIFDM(0, "run", CHEN, "-o", again, SHORT);
    HIFDM(0, "run", CHEN, "-o", other, SHORT, "--seed", "2023");
    EXPECT(first, again, other, "--", "differing(a, b) == []",
           /* the search differs, what comes before it does not */
           "{'search/population/design', 'search/population/psi_m', 'search/population/parent', 'search/design'} <= "
           "set(differing(a, c))",
           "all(name.startswith(('search/', 'refine', 'set_tension/')) for name in differing(a, c))");
}
END_TEST

/* Imported nets as well, and a case that is run from another folder. */
START_TEST(data_sets_do_not_depend_on_the_folder)
{
    net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,2,0,0,support\nc,1,0.5,0.1,inner\nd,1,1.7,0,support\n",
             "id,i,j,group,law,value\n1,a,c,inner,tension,10\n2,b,c,inner,tension,10\n3,c,d,boundary,tension,12\n");
    const char *folder = temp(".");
    SHELL(0, "cd \"$1\" && \"$0\" run net.yaml -o here.h5 --set optimize.generations=3", folder);
    SHELL(0, "cd / && \"$0\" run \"$1/net.yaml\" -o \"$1/there.h5\" --set optimize.generations=3", folder);
    EXPECT(temp("here.h5"), temp("there.h5"), "--", "differing(a, b) == []");
}
END_TEST

Suite *suite_cli_repeat(void)
{
    Suite *suite = suite_create("cli/repeat");
    TCase *tcase = tcase_create("repeat");
    tcase_add_test(tcase, data_sets_do_not_depend_on_the_number_of_threads);
    tcase_add_test(tcase, data_sets_do_not_depend_on_the_threads_of_the_linear_algebra);
    tcase_add_test(tcase, same_seed_same_data_another_seed_others);
    tcase_add_test(tcase, data_sets_do_not_depend_on_the_folder);
    suite_add_tcase(suite, tcase);
    return suite;
}
