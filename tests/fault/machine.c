/* Faults of a machine for the program under test, by LD_PRELOAD: tests/fault/table.py compiles it. FAULT="WHAT N CALLS
 * FOLDER": at the N-th of these calls (letters: w writes, s syncs, r reads, o opens) on files of the folder, in each
 * process, WHAT happens: kill or term, a signal to the program that was started, or the number of an error, from then
 * on. */
#include "preload.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

static pid_t first;

__attribute__((constructor)) static void begin(void)
{
    first = getpid();
}

static char letter_of(const char *call)
{
    return strstr(call, "write") ? 'w' : strstr(call, "read") ? 'r' : strstr(call, "sync") ? 's' : 'o';
}

static int strikes(const char *call, int file, const char *path)
{
    static atomic_long n;
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
    errno = atoi(what);
    return 1;
}
