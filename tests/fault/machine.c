/* Faults of a machine for the program under test, by LD_PRELOAD: tests/fault/table.py compiles it. FAULT="WHAT N CALLS
 * FOLDER": at the N-th of these calls (letters: w writes, s syncs, r reads, o opens) on files of the folder, in each
 * process, WHAT happens: kill or term, a signal to the program that was started, or the number of an error, from then
 * on. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static pid_t first;

__attribute__((constructor)) static void begin(void)
{
    first = getpid();
}

static int strikes(char call, int file, const char *path)
{
    static atomic_long n;
    char what[16] = "", calls[16] = "", part[512] = "", link[64], target[1024] = "";
    long at = 1;
    const char *how = getenv("FAULT");
    if (!how || sscanf(how, "%15s %ld %15s %511s", what, &at, calls, part) < 4 || !strchr(calls, call)) return 0;
    if (!path) {
        snprintf(link, sizeof link, "/proc/self/fd/%d", file);
        ssize_t length = readlink(link, target, sizeof target - 1);
        target[length > 0 ? length : 0] = '\0';
        path = target;
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

#define CALL(type, name, call, parameters, arguments)                                                                  \
    type name parameters                                                                                               \
    {                                                                                                                  \
        static type(*real) parameters;                                                                                 \
        if (!real) *(void **)&real = dlsym(RTLD_NEXT, #name);                                                          \
        return strikes(call, f, NULL) ? (type)-1 : real arguments;                                                     \
    }
CALL(ssize_t, write, 'w', (int f, const void *p, size_t n), (f, p, n))
CALL(ssize_t, writev, 'w', (int f, const struct iovec *p, int n), (f, p, n))
CALL(ssize_t, pwrite, 'w', (int f, const void *p, size_t n, off_t at), (f, p, n, at))
CALL(ssize_t, pwrite64, 'w', (int f, const void *p, size_t n, off_t at), (f, p, n, at))
CALL(ssize_t, read, 'r', (int f, void *p, size_t n), (f, p, n))
CALL(ssize_t, pread, 'r', (int f, void *p, size_t n, off_t at), (f, p, n, at))
CALL(ssize_t, pread64, 'r', (int f, void *p, size_t n, off_t at), (f, p, n, at))
CALL(int, fsync, 's', (int f), (f))
CALL(int, fdatasync, 's', (int f), (f))

static int open_by(const char *real_name, const char *name, int flags, mode_t mode)
{
    int (*real)(const char *, int, ...) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, real_name);
    return strikes('o', -1, name) ? -1 : real(name, flags, mode);
}
#define OPEN(call)                                                                                                     \
    int call(const char *name, int flags, ...)                                                                         \
    {                                                                                                                  \
        va_list list;                                                                                                  \
        va_start(list, flags);                                                                                         \
        mode_t mode = flags & O_CREAT ? (mode_t)va_arg(list, unsigned) : 0;                                            \
        va_end(list);                                                                                                  \
        return open_by(#call, name, flags, mode);                                                                      \
    }
OPEN(open)
OPEN(open64)
