/* Sweeps on sick machines: a call of the system fails, descriptors, memory or room run out. Then the sweep ends with
 * exit status 5 and words, no point counts as failed, and the same command goes on when the cause is gone. */
#include "cli.h"

#include <errno.h>

/* The program starts with the sanitizer's library first, so that none can be loaded before it. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_PRELOAD 0
#else
#define HAS_PRELOAD 1
#endif

static const char *study(void)
{
    file_with("base.yaml", SMALL_SCENE SMALL_GA);
    return file_with("study.yaml", "base: base.yaml\nsweep:\n  form.pretension_N: [8, 10, 12]\n");
}

/* After a sweep that ended with an error. */
static void goes_on(const char *path, const char *folder, bool has_run)
{
    if (has_run) {
        HIFDM(0, "status", path, "--dir", folder, "--json");
        OUT("\"failed\": 0");
    }
    HIFDM(0, "sweep", path, "--dir", folder, "--quiet");
    HIFDM(0, "status", path, "--dir", folder, "--json");
    OUT("\"done\": 3");
    SHELL(0, "[ $(ls -A \"$1\" | grep -c 'tmp$\\|journal$') = 0 ] && [ $(ls \"$1\"/*.h5 | wc -l) = 3 ]", folder);
}

static const struct {
    const char *call;
    int why;
    const char *where; /* from which call on, and a part of the names that count */
    int exit_code;
    const char *words;
} sick[] = {
    {"pwrite", ENOSPC, "6 .tmp", 5, "No space left on device"},
    {"pwrite", EDQUOT, "1", 5, "Disk quota exceeded"},
    {"writev", ENOSPC, "2 .journal", 5, "No space left on device"},
    {"write", EDQUOT, "2 points-", 5, "Disk quota exceeded"},
    {"fsync", EIO, "1", 5, "Input/output error"},
    {"fdatasync", EIO, "1 points-", 5, "Input/output error"},
    {"close", EIO, "1 .tmp", 5, "Input/output error"},
    {"close", EIO, "1 points-", 5, "Input/output error"},
    {"open", EMFILE, "20", 5, "Too many open files"},
    {"open", ENFILE, "1 claims", 5, "Too many open files in system"},
    {"open", ENOMEM, "1 points-", 5, "Cannot allocate memory"},
    {"malloc", ENOMEM, "1 libyaml", 5, "study.yaml: out of memory"},
    {"malloc", ENOMEM, "60 libyaml", 5, "base.yaml: out of memory"},
    {"malloc", ENOMEM, "300 libyaml", 5, "base.yaml: out of memory"},
    {"open", EIO, "3 base.yaml", 5, "Input/output error"},
    {"read", EIO, "1 base.yaml", 5, "Input/output error"},
    {"flock", ENOLCK, "1", 5, "No locks available"},
    {"fcntl", ENOLCK, "1 claims", 5, "No locks available"},
    /* file systems without locks */
    {"flock", ENOSYS, "1", 0, ""},
    {"flock", EOPNOTSUPP, "1", 0, ""},
    {"fcntl", ENOSYS, "1", 0, "this file system has no locks"},
    {"fcntl", EOPNOTSUPP, "1", 0, "this file system has no locks"},
};
enum { N_SICK = sizeof sick / sizeof *sick };

static const char *sick_machine(void)
{
    const char *library = temp("sick.so");
    SHELL(0, "cc -shared -fPIC -O1 -w \"$1\" -o \"$2\" -ldl", keep(source_path("tests/cli/sick_machine.c")), library);
    return library;
}

START_TEST(a_call_that_fails)
{
    const char *path = study(), *library = sick_machine();
    for (int i = _i; i < N_SICK; i += 4) {
        const char *folder = temp(formatted("s%d.d", i));
        const char *how = keep(formatted("SICK=%s %d %s", sick[i].call, sick[i].why, sick[i].where));
        SHELL(sick[i].exit_code,
              "exec env \"$3\" LD_PRELOAD=\"$4\" \"$0\" sweep \"$1\" --dir \"$2\" --quiet --threads 2", path, folder,
              how, library);
        ck_assert_msg(strstr(said.err, sick[i].words) != NULL, "%s: %s", how, said.err);
        goes_on(path, folder, is_there(folder));
    }
}
END_TEST

/* A run on a file system without locks warns. */
START_TEST(a_run_without_locks)
{
    const char *path = file_with("c.yaml", SMALL_SCENE SMALL_GA), *library = sick_machine();
    SHELL(0, "SICK='flock 38 1' LD_PRELOAD=\"$3\" \"$0\" run \"$1\" -o \"$2\" --quiet", path, temp("a.h5"), library);
    ERR("this file system has no locks (Function not implemented), so hifdm cannot prevent a second process from "
        "writing this result");
    SHELL(5, "SICK='flock 37 1' LD_PRELOAD=\"$3\" \"$0\" run \"$1\" -o \"$2\" --quiet", path, temp("b.h5"), library);
    ERR("No locks available");
    HIFDM(0, "run", path, "-o", temp("b.h5"), "--quiet");
    HIFDM(0, "diff", temp("a.h5"), temp("b.h5"));
}
END_TEST

/* Real limits: of descriptors, those of the tests aside, and of the size of files in blocks. */
START_TEST(limits)
{
    const char *path = study();
    static const char *const limit[] = {"n 7", "n 8", "n 9", "n 10", "f 1", "f 8", "f 40"};
    for (size_t i = 0; i < sizeof limit / sizeof *limit; i++) {
        const char *folder = temp(formatted("n%zu.d", i));
        SHELL(5, "exec 3>&- 4>&- 5>&- 6>&- 7>&- 8>&- 9>&-; ulimit -$3; exec \"$0\" sweep \"$1\" --dir \"$2\" --quiet",
              path, folder, limit[i]);
        ERR("error: ");
        goes_on(path, folder, true);
    }
}
END_TEST

/* Whatever memory is there, from what the libraries need to be loaded to enough for the command: it ends, with words
 * unless it is done. net.yaml has a strut, whose matrix two threads factor by LAPACK. 800 MB are enough: when two
 * threads first allocate at the same time, glibc reserves 128 MB for each of them beside the buffers of OpenBLAS. */
static const int memory_mb[] = {40, 50, 70, 120, 250, 320, 350, 356, 360, 366, 374, 800};
static const char *const memory_command[] = {
    "sweep study.yaml --dir points --threads 2",
    "run net.yaml -o net.h5 --restart --threads 2",
    "tolerance base.yaml -o cut.h5 --restart --threads 2",
    "adjust base.yaml --stage form --measured measured.csv -o moves.csv --force",
};
enum { N_MEMORY = sizeof memory_mb / sizeof *memory_mb, N_COMMAND = sizeof memory_command / sizeof *memory_command };

START_TEST(memory)
{
    const char *folder = temp("."), *mb = keep(formatted("%d", memory_mb[_i] * 1024)), *path = study();
    if (!HAS_PRELOAD) return; /* sanitizers map terabytes */
    net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,3,0,1,support\nc,1,0,0,inner\nd,2,0,0,inner\n",
             "id,i,j,group,law,value\n1,a,c,boundary,force_density,5\n2,c,d,inner,force_density,-1\n"
             "3,d,b,boundary,force_density,6\n");
    SHELL(0, "cd \"$1\" && echo 'optimize: {population: 20, generations: 3, range_N: 1}' >>net.yaml", folder);
    file_with("base.yaml", EA_SCENE SMALL_GA
              "tolerance: {sigma_cut_m: 0.0001, samples: 20}\n"
              "adjust: {set: inner, range_m: 0.002, step_m: 0.0001, max_adjustments: 3, sigma_m: 0.0001}\n");
    SHELL(0,
          "cd \"$1\" && \"$0\" run base.yaml -o shape.h5 --quiet && \"$0\" export shape.h5 --csv shape && "
          "cut -d, -f1-4 shape/nodes.csv >measured.csv",
          folder);
    for (int k = 0; k < N_COMMAND; k++) {
        SHELL(0,
              "cd \"$1\"; (ulimit -v $2; exec \"$0\" version) >err 2>&1 || exit 0; "
              "(ulimit -v $2; exec \"$0\" $3 --quiet) >out 2>err; s=$?; "
              "case $s in 0) ;; 5) grep -q 'error: ' err && [ $2 -lt 800000 ] ;; *) false ;; esac || "
              "{ echo \"$3: $s\" >&2; cat err >&2; exit 1; }",
              folder, mb, memory_command[k]);
    }
    goes_on(path, temp("points"), is_there(temp("points")));
}
END_TEST

START_TEST(a_table_that_is_not_there_is_the_fault_of_its_point)
{
    const char *folder = temp("t.d");
    net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,0,inner\nc,2,0,0,support\n",
             "id,i,j,group,law,value\nx,a,b,inner,tension,\ny,b,c,inner,tension,\n");
    const char *path = file_with("study.yaml", "base: net.yaml\nsweep:\n  scene.import.nodes: [nodes.csv, gone.csv]\n");
    HIFDM(3, "sweep", path, "--dir", folder, "--quiet");
    HIFDM(0, "status", path, "--dir", folder);
    OUT("done      1");
    OUT("failed    1");
    OUT("gone.csv: cannot open: No such file or directory");
}
END_TEST

Suite *suite_cli_sick(void)
{
    Suite *suite = suite_create("cli/sick");
    TCase *tcase = tcase_create("sick");
    if (HAS_PRELOAD) tcase_add_loop_test(tcase, a_call_that_fails, 0, 4);
    if (HAS_PRELOAD) tcase_add_test(tcase, a_run_without_locks);
    tcase_add_test(tcase, limits);
    tcase_add_loop_test(tcase, memory, 0, N_MEMORY);
    tcase_add_test(tcase, a_table_that_is_not_there_is_the_fault_of_its_point);
    suite_add_tcase(suite, tcase);
    return suite;
}
