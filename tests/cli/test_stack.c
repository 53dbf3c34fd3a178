/* Small stacks: every command runs with 128 kB for its first thread and for each of the others, which take the same
 * limit, and with less than that for the others alone. */
#include "cli.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define IS_SANITIZED true /* frames are larger, and sanitizers take stack themselves */
#else
#define IS_SANITIZED false
#endif

#define FULL_CASE                                                                                                      \
    ON_TRUSS SMALL_GA "surface: {frequencies_Hz: [1e9]}\nload_cases:\n  - {name: cold, force_N: [0, 0, -0.1]}\n"       \
                      "tolerance: {sigma_cut_m: 1e-4, samples: 20}\n"                                                  \
                      "adjust: {set: inner, range_m: 0.002, step_m: 0.0001, max_adjustments: 3, sigma_m: 0.0001}\n"

/* In the order in which they can run: the words behind `hifdm`. */
static const char *const command[] = {
    "version",
    "help run",
    "schema",
    "explain truss",
    "new begun --paraboloid",
    "run full.yaml -o full.h5",
    "run full.yaml -o other.h5 --seed 8",
    "run full.yaml -o full.h5", /* it is finished */
    "run front.yaml -o front.h5",
    "run full.yaml -o front.h5 --restart",
    "run front.yaml -o front.h5 --restart",
    "run front.yaml -o point.h5 --point front.h5:1",
    "run struts.yaml",
    "check full.yaml",
    "check study.yaml",
    "tolerance full.yaml -o full.h5 --restart",
    "evaluate full.yaml --template designs.csv",
    "evaluate full.yaml --designs designs.csv -o results.csv --jacobian slopes.csv --residuals rows.csv",
    "show full.h5 --verbose",
    "show full.h5 --json",
    "recover full.h5",
    "report full.h5 -o full.html",
    "report full.h5 other.h5 -o both.html",
    "export full.h5 --csv csv --vtk vtk --cutlist cut.csv --rf rf",
    "export full.h5 --csv cold --load-case cold",
    "export front.h5 --front front.csv",
    "adjust full.yaml --result full.h5 --measured csv/nodes.csv -o moves.csv --report adjust.html",
    "diff full.h5 full.h5",
    "sweep study.yaml",
    "status study.yaml",
    "merge study.yaml",
    "show study.h5 --verbose",
    "report study.h5 -o study.html",
};
enum { N_COMMAND = sizeof command / sizeof *command };

/* Of OMP_STACKSIZE: a worker under LAPACK's band matrices, for struts, needs 66 kB for their work arrays alone. */
static const char *const limit[] = {"ulimit -s 256", "ulimit -s 128", "export OMP_STACKSIZE=96k"};

START_TEST(every_command_runs)
{
    if (IS_SANITIZED) return;
    const char *folder = temp("");
    file_with("full.yaml", FULL_CASE);
    file_with("front.yaml", SMALL_SCENE "optimize:\n  population: 8\n  generations: 3\n  front: [{figure: psi}, "
                                        "{figure: evenness, set: all}]\n");
    file_with("study.yaml", "base: full.yaml\nsweep:\n  form.pretension_N: [8, 9, 10]\n  files: all\n");
    file_with("nodes.csv", "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,2,0,0,support\nc,0,2,0,support\nd,0.9,0.8,0,"
                           "inner\ne,0.4,0.4,0,inner\n");
    file_with("cables.csv", "id,i,j,group,law,value\n1,a,e,boundary,tension,\n2,d,b,inner,force_density,10\n3,d,c,"
                            "inner,force_density,10\n4,e,d,inner,force_density,-1\n5,e,b,inner,force_density,10\n6,e,"
                            "c,inner,force_density,10\n");
    file_with("struts.yaml", "scene:\n  import: {nodes: nodes.csv, cables: cables.csv}\noptimize: {population: 40, "
                             "generations: 3}\n");
    for (int i = 0; i < N_COMMAND; i++)
        SHELL(0, "cd \"$1\" && $2 && OMP_NUM_THREADS=4 exec \"$0\" $3", folder, limit[_i], command[i]);
}
END_TEST

START_TEST(every_command_is_in_the_list)
{
    HIFDM(0, "help");
    for (const char *line = strstr(said.out, "\n  hifdm "); line; line = strstr(line + 1, "\n  hifdm ")) {
        const char *name = line + strlen("\n  hifdm ");
        size_t n = strcspn(name, " \n");
        bool is_there = false;
        for (int i = 0; i < N_COMMAND; i++)
            is_there |= !strncmp(command[i], name, n) && (command[i][n] == ' ' || command[i][n] == '\0');
        ck_assert_msg(is_there, "%.*s", (int)n, name);
    }
}
END_TEST

Suite *suite_cli_stack(void)
{
    Suite *suite = suite_create("cli/stack");
    TCase *tcase = tcase_create("stack");
    tcase_add_loop_test(tcase, every_command_runs, 0, sizeof limit / sizeof *limit);
    tcase_add_test(tcase, every_command_is_in_the_list);
    suite_add_tcase(suite, tcase);
    return suite;
}
