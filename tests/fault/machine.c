/* Faults of a machine for the program under test, by LD_PRELOAD: tests/fault/table.py compiles it. FAULT="WHAT N CALLS
 * FOLDER": at the N-th of these calls on files of the folder, in each process, WHAT happens: kill or term, a signal to
 * the program that was started; vanish, FOLDER/out gets another name; or the number of an error, from then on. CALLS
 * are letters: w writes, s syncs, r reads, o opens, c closes, t ftruncate, m renames, l links, u unlinks. TALLY names a
 * file to which each process adds how many of these calls it made. */
#include "preload.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

static pid_t first;
static atomic_long n;

__attribute__((constructor)) static void begin(void)
{
    char text[32];
    snprintf(text, sizeof text, "%ld", (long)getpid());
    setenv("FAULT_FIRST", text, 0); /* a copy that the program starts of itself knows it, too */
    first = (pid_t)atol(getenv("FAULT_FIRST"));
}

__attribute__((destructor)) static void end(void)
{
    const char *name = getenv("TALLY");
    FILE *file = name ? fopen(name, "a") : NULL;
    if (!file) return;
    fprintf(file, "%ld\n", (long)n);
    fclose(file);
}

static char letter_of(const char *call)
{
    static const char *const word[] = {"write", "read", "sync", "close", "truncate", "rename", "unlink", "link"};
    for (int i = 0; i < 8; i++)
        if (strstr(call, word[i])) return "wrsctmul"[i];
    return 'o';
}

static void hide(const char *folder)
{
    char from[600], to[600];
    snprintf(from, sizeof from, "%s/out", folder);
    snprintf(to, sizeof to, "%s/out.gone", folder);
    renameat(AT_FDCWD, from, AT_FDCWD, to);
}

static int strikes(const char *call, int file, const char *path)
{
    char what[16] = "", calls[16] = "", part[512] = "", target[1024] = "";
    long at = 1;
    const char *how = getenv("FAULT");
    if (!how || sscanf(how, "%15s %ld %15s %511s", what, &at, calls, part) < 4 || !strchr(calls, letter_of(call)))
        return 0;
    if (!path) {
        path = path_of(file, target, sizeof target);
    } else if (*path != '/' && getcwd(target, sizeof target / 2)) {
        strcat(target, "/"); /* names are short here */
        path = strncat(target, path, sizeof target / 2 - 2);
    }
    if (!strstr(path, part)) return 0;
    long now = atomic_fetch_add(&n, 1) + 1;
    if (now < at) return 0;
    if (*what == 'k' || *what == 't') {
        if (now == at) kill(first, *what == 'k' ? SIGKILL : SIGTERM);
        return 0;
    }
    if (*what == 'v') {
        if (now == at) hide(part);
        return 0;
    }
    errno = atoi(what);
    return 1;
}

/* The file is closed all the same, as on Linux. */
int close(int f)
{
    int (*real)(int) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "close");
    int fails = strikes("close", f, NULL), why = errno;
    int result = real(f);
    if (!fails) return result;
    errno = why;
    return -1;
}
