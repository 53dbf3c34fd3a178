/* The package for Python as it is installed: each script of this folder is one test. */
#include "support.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define IS_SANITIZED true /* a library that Python cannot load */
#else
#define IS_SANITIZED false
#endif

/* Below the prefix, in the folder of Python's version. */
static const char *package_folder(void)
{
    static char folder[4096];
    char pattern[4096];
    glob_t found;
    snprintf(pattern, sizeof pattern, "%s/lib/python*/*-packages", installed_prefix());
    ck_assert_msg(glob(pattern, 0, NULL, &found) == 0, "no package at %s", pattern);
    snprintf(folder, sizeof folder, "%s", found.gl_pathv[0]);
    globfree(&found);
    return folder;
}

static const char *const script[] = {"bits.py",   "errors.py",  "threads.py",   "processes.py", "examples.py",
                                     "manual.py", "renamed.py", "held_lock.py", "residuals.py", "optimiser_times.py"};
enum { N_SCRIPT = sizeof script / sizeof *script };

START_TEST(script_passes)
{
    char path[64], folder[4096];
    if (IS_SANITIZED) {
        skip_for_machine("python/package", "Python cannot load a library with sanitizers");
        return;
    }
    snprintf(path, sizeof path, "tests/python/%s", script[_i]);
    snprintf(folder, sizeof folder, "%s", temp_path(""));
    setenv("PYTHONPATH", package_folder(), 1);
    setenv("PYTHONDONTWRITEBYTECODE", "1", 1);
    setenv("OMP_WAIT_POLICY", "passive", 1);
    setenv("HIFDM", hifdm_program(), 0);
    setenv("MPLCONFIGDIR", folder, 1);
    setenv("MPLBACKEND", "Agg", 1);
    struct command command =
        run_command(HANG_S, (const char *const[]){python_program(), source_path(path), folder, NULL});
    ck_assert_msg(!command.timed_out, "%s does not end", path);
    ck_assert_msg(command.exit_code == 0, "%s:\n%s%s", path, command.out, command.err);
    for (char *line = command.out; (line = strstr(line, "skipped: ")) != NULL;) {
        line += strlen("skipped: ");
        char *end = line + strcspn(line, "\n");
        bool goes_on = *end != '\0';
        *end = '\0';
        skip_for_tool("python/package", line);
        line = end + goes_on;
    }
    free_command(&command);
}
END_TEST

Suite *suite_python_package(void)
{
    Suite *suite = suite_create("python/package");
    TCase *tcase = tcase_create("package");
    tcase_add_loop_test(tcase, script_passes, 0, N_SCRIPT);
    suite_add_tcase(suite, tcase);
    return suite;
}
