/* A sick machine for the program under test, by LD_PRELOAD: test_sick.c compiles it. SICK="CALL ERRNO FROM [PART]"
 * makes each call of that name from the FROM-th on fail with this error number; with PART only calls on files whose
 * names contain it count. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static int is_sick(const char *call, int file, const char *path)
{
    static atomic_long n;
    char name[32] = "", part[256] = "", link[64], target[512] = "";
    int why = 0;
    long from = 1;
    const char *how = getenv("SICK");
    if (!how || sscanf(how, "%31s %d %ld %255s", name, &why, &from, part) < 3 || strcmp(name, call) != 0) return 0;
    if (!path && *part) {
        snprintf(link, sizeof link, "/proc/self/fd/%d", file);
        ssize_t length = readlink(link, target, sizeof target - 1);
        target[length > 0 ? length : 0] = '\0';
        path = target;
    }
    if (*part && !strstr(path, part)) return 0;
    if (atomic_fetch_add(&n, 1) + 1 < from) return 0;
    errno = why;
    return 1;
}

#define SICK(type, name, file, parameters, arguments)                                                                  \
    type name parameters                                                                                               \
    {                                                                                                                  \
        static type(*real) parameters;                                                                                 \
        if (!real) *(void **)&real = dlsym(RTLD_NEXT, #name);                                                          \
        return is_sick(#name, file, NULL) ? (type)-1 : real arguments;                                                 \
    }
SICK(ssize_t, write, f, (int f, const void *p, size_t n), (f, p, n))
SICK(ssize_t, writev, f, (int f, const struct iovec *p, int n), (f, p, n))
SICK(ssize_t, pwrite, f, (int f, const void *p, size_t n, off_t at), (f, p, n, at))
SICK(ssize_t, pwrite64, f, (int f, const void *p, size_t n, off_t at), (f, p, n, at))
SICK(ssize_t, pread64, f, (int f, void *p, size_t n, off_t at), (f, p, n, at))
SICK(ssize_t, read, f, (int f, void *p, size_t n), (f, p, n))
SICK(int, fsync, f, (int f), (f))
SICK(int, fdatasync, f, (int f), (f))
SICK(int, flock, f, (int f, int how), (f, how))
SICK(int, close, f, (int f), (f))

/* PART is of the name of the library that asks for memory. */
extern void *__libc_malloc(size_t n);
void *malloc(size_t n)
{
    static __thread int is_asked;
    const char *how = getenv("SICK");
    Dl_info caller;
    if (!how || strncmp(how, "malloc", 6) != 0 || is_asked) return __libc_malloc(n);
    is_asked = 1;
    int sick = dladdr(__builtin_return_address(0), &caller) && is_sick("malloc", -1, caller.dli_fname);
    is_asked = 0;
    return sick ? NULL : __libc_malloc(n);
}

static int open_by(const char *real_name, const char *name, int flags, mode_t mode)
{
    int (*real)(const char *, int, ...) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, real_name);
    return is_sick("open", -1, name) ? -1 : real(name, flags, mode);
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
#define LOCK(call)                                                                                                     \
    int call(int file, int command, ...)                                                                               \
    {                                                                                                                  \
        int (*real)(int, int, ...) = NULL;                                                                             \
        va_list list;                                                                                                  \
        va_start(list, command);                                                                                       \
        void *argument = va_arg(list, void *);                                                                         \
        va_end(list);                                                                                                  \
        *(void **)&real = dlsym(RTLD_NEXT, #call);                                                                     \
        if ((command == F_SETLK || command == F_OFD_SETLK) && is_sick("fcntl", file, NULL)) return -1;                 \
        return real(file, command, argument);                                                                          \
    }
LOCK(fcntl)
LOCK(fcntl64)
