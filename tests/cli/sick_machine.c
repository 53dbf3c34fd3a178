/* A sick machine for the program under test, by LD_PRELOAD: test_sick.c compiles it. SICK="CALL ERRNO FROM [PART]"
 * makes each call of that name from the FROM-th on fail with this error number; with PART only calls on files whose
 * names contain it count. */
#include "../fault/preload.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>

static int strikes(const char *call, int file, const char *path)
{
    static atomic_long n;
    char name[32] = "", part[256] = "", target[512] = "";
    int why = 0;
    long from = 1;
    const char *how = getenv("SICK");
    if (!how || sscanf(how, "%31s %d %ld %255s", name, &why, &from, part) < 3 || strcmp(name, call) != 0) return 0;
    if (!path && *part) path = path_of(file, target, sizeof target);
    if (*part && !strstr(path, part)) return 0;
    if (atomic_fetch_add(&n, 1) + 1 < from) return 0;
    errno = why;
    return 1;
}

CALL(int, flock, (int f, int how), (f, how))
NAME_CALL(stat, (const char *name, struct stat *info), (name, info), name)
NAME_CALL(lstat, (const char *name, struct stat *info), (name, info), name)
CALL(int, close, (int f), (f))

char *realpath(const char *name, char *to)
{
    static char *(*real)(const char *, char *);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "realpath");
    return strikes("realpath", -1, name) ? NULL : real(name, to);
}

/* PART is of the name of the library that asks for memory. */
extern void *__libc_malloc(size_t n);
void *malloc(size_t n)
{
    static __thread int is_asked;
    const char *how = getenv("SICK");
    Dl_info caller;
    if (!how || strncmp(how, "malloc", 6) != 0 || is_asked) return __libc_malloc(n);
    is_asked = 1;
    int sick = dladdr(__builtin_return_address(0), &caller) && strikes("malloc", -1, caller.dli_fname);
    is_asked = 0;
    return sick ? NULL : __libc_malloc(n);
}
#define LOCK(call)                                                                                                     \
    int call(int file, int command, ...)                                                                               \
    {                                                                                                                  \
        int (*real)(int, int, ...) = NULL;                                                                             \
        va_list list;                                                                                                  \
        va_start(list, command);                                                                                       \
        void *argument = va_arg(list, void *);                                                                         \
        va_end(list);                                                                                                  \
        *(void **)&real = dlsym(RTLD_NEXT, #call);                                                                     \
        if ((command == F_SETLK || command == F_OFD_SETLK) && strikes("fcntl", file, NULL)) return -1;                 \
        return real(file, command, argument);                                                                          \
    }
LOCK(fcntl)
LOCK(fcntl64)
