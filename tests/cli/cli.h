/* cli - shared by the tests of the program: makes cases, runs the program, and checks its exit code, output and
 * files. */
#pragma once

#include "support.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

/* ---- cases ---- */

/* Returns a copy of a path that stays valid. Paths of support.h are overwritten after 16 further calls, and each run of
 * the program makes two calls. */
static inline const char *keep(const char *path)
{
    static char *kept[128];
    static int n;
    ck_assert_msg(n < 128, "a test keeps too many paths");
    ck_assert_ptr_nonnull(kept[n] = strdup(path));
    return kept[n++];
}

static inline const char *temp(const char *name)
{
    return keep(temp_path(name));
}

/* For runs that must leave no result. A result would go to the directory of the test. */
#define NOWHERE "-o", temp("nowhere.h5")

#define CHEN keep(source_path("configs/straight-edges.yaml"))
#define REFLECTOR keep(source_path("configs/reflector.yaml"))

/* A reflector of two nets. */
#define DISH "scene: {paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 4, rear_distance_m: 1.8}}\n"

/* A well-posed net that is solved in a millisecond. */
#define SMALL_SCENE                                                                                                    \
    "scene:\n"                                                                                                         \
    "  parabolic_cylinder: {aperture_m: 2, length_m: 3, focal_length_m: 2, modules: [2, 3], cells_per_module: [2, "    \
    "2], scallop: 0.1}\n"
#define ON_TRUSS EA_SCENE "form: {pretension_N: 20}\ntruss: {E_Pa: 2e9}\n"
#define EA_SCENE SMALL_SCENE "  EA_inner_N: 47000\n  EA_boundary_N: 47000\n"
#define SMALL_GA "optimize: {population: 6, generations: 3, seed: 7}\n"

/* Writes `text` to the file `name` in the directory of the test and returns its path. */
static inline const char *file_with(const char *name, const char *text)
{
    const char *path = temp(name);
    write_file(path, text);
    return path;
}

/* Writes an imported net as two files and their case. Returns the path of the case. */
static inline const char *net_with(const char *nodes, const char *cables)
{
    file_with("nodes.csv", nodes);
    file_with("cables.csv", cables);
    return file_with("net.yaml", "scene:\n  import: {nodes: nodes.csv, cables: cables.csv}\n");
}

/* ---- running the program ---- */

/* The last command, whose output is tested. The next command releases it. */
static struct command said;

static inline void demand_exit(struct command command, int exit_code, const char *words, int line)
{
    free_command(&said);
    said = command;
    ck_assert_msg(!command.timed_out, "line %d: %s: does not end", line, words);
    ck_assert_msg(command.exit_code == exit_code, "line %d: %s: exit code %d, not %d\n%s%s", line, words,
                  command.exit_code, exit_code, command.out, command.err);
}

/* HIFDM(0, "check", path) runs the program and demands the exit code. Its output is in said.out and said.err. */
#define HIFDM(exit_code, ...) demand_exit(run_hifdm(__VA_ARGS__), exit_code, #__VA_ARGS__, __LINE__)

/* SHELL(5, "exec \"$0\" schema >/dev/full") runs a script of the shell, with the program as $0 and further arguments as
 * $1, $2, ... */
#define SHELL(exit_code, ...) SHELL_(exit_code, __VA_ARGS__, NULL)
#define SHELL_(code, script, ...)                                                                                      \
    demand_exit(run_command(HANG_S, (const char *const[]){"sh", "-c", script, hifdm_program(), __VA_ARGS__, NULL}),    \
                code, script, __LINE__)

/* ---- output ---- */

static inline void demand_part(const char *text, const char *part, int line)
{
    ck_assert_msg(strstr(text, part) != NULL, "line %d: '%s' is not in\n%s", line, part, text);
}

#define OUT(part) demand_part(said.out, part, __LINE__)
#define ERR(part) demand_part(said.err, part, __LINE__)

/* ERRS("error: %s:4:3: ...", path) is ERR with a format. */
#define ERRS(...) demand_part(said.err, formatted(__VA_ARGS__), __LINE__)

static inline const char *formatted(const char *format, ...) __attribute__((format(printf, 1, 2)));
static inline const char *formatted(const char *format, ...)
{
    static char text[8192];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return text;
}

static inline int count_of(const char *text, const char *part)
{
    int n = 0;
    for (const char *p = text; (p = strstr(p, part)) != NULL; p += strlen(part))
        n++;
    return n;
}

/* ---- files ---- */

static inline bool is_there(const char *path)
{
    return access(path, F_OK) == 0;
}

/* Returns true if the user can make devices. In containers not even root may be able to. */
static inline bool can_make_devices(void)
{
    return geteuid() == 0 && mknod(temp_path("device"), S_IFCHR | 0600, makedev(1, 3)) == 0 &&
           unlink(temp_path("device")) == 0;
}

static inline bool file_is(const char *path, const char *text)
{
    char *now = read_file(path, NULL);
    bool same = strcmp(now, text) == 0;
    free(now);
    return same;
}

/* Writes said.out to a file, for EXPECT. */
static inline const char *out_as(const char *name)
{
    return file_with(name, said.out);
}

/* EXPECT(path_a, path_b, "--", "a[...] == b[...]") runs expect.py. */
#define EXPECT(...)                                                                                                    \
    do {                                                                                                               \
        const char *const expect_argv_[] = {python_program(), source_path("tests/cli/expect.py"), __VA_ARGS__, NULL};  \
        struct command expect_ = run_command(HANG_S, expect_argv_);                                                    \
        ck_assert_msg(expect_.exit_code == 0, "%s%s", expect_.out, expect_.err);                                       \
        free_command(&expect_);                                                                                        \
    } while (0)

/* Writes the JSON block of a page to a file, for EXPECT. */
static inline const char *data_of(const char *page, const char *name)
{
    static const char open_tag[] = "<script type=\"application/json\" id=\"data\">";
    char *text = read_file(page, NULL), *start = strstr(text, open_tag);
    ck_assert_ptr_nonnull(start);
    start += strlen(open_tag);
    char *end = strstr(start, "</script>");
    ck_assert_ptr_nonnull(end);
    *end = '\0';
    const char *path = file_with(name, start);
    free(text);
    return path;
}

/* Returns the number that follows these words in the output. */
static inline double number_after(const char *what)
{
    const char *at = strstr(said.out, what);
    ck_assert_msg(at, "%s is not in %s", what, said.out);
    return strtod(at + strlen(what), NULL);
}
