/* preload - the calls of the system that a library in front of the program's own (LD_PRELOAD) can make fail. The file
 * that includes this says which by strikes(). */
#pragma once

#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

/* Not 0: the call fails with the errno that this has set. path: NULL when the file is open. */
static int strikes(const char *call, int file, const char *path);

static const char *path_of(int file, char *target, size_t size)
{
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t length = readlink(link, target, size - 1);
    target[length > 0 ? length : 0] = '\0';
    return target;
}

#define CALL(type, name, parameters, arguments)                                                                        \
    type name parameters                                                                                               \
    {                                                                                                                  \
        static type(*real) parameters;                                                                                 \
        if (!real) *(void **)&real = dlsym(RTLD_NEXT, #name);                                                          \
        return strikes(#name, f, NULL) ? (type)-1 : real arguments;                                                    \
    }
CALL(ssize_t, write, (int f, const void *p, size_t n), (f, p, n))
CALL(ssize_t, writev, (int f, const struct iovec *p, int n), (f, p, n))
CALL(ssize_t, pwrite, (int f, const void *p, size_t n, off_t at), (f, p, n, at))
CALL(ssize_t, pwrite64, (int f, const void *p, size_t n, off_t at), (f, p, n, at))
CALL(ssize_t, read, (int f, void *p, size_t n), (f, p, n))
CALL(ssize_t, pread, (int f, void *p, size_t n, off_t at), (f, p, n, at))
CALL(ssize_t, pread64, (int f, void *p, size_t n, off_t at), (f, p, n, at))
CALL(int, fsync, (int f), (f))
CALL(int, fdatasync, (int f), (f))
CALL(int, ftruncate, (int f, off_t size), (f, size))
CALL(int, ftruncate64, (int f, off_t size), (f, size))

/* Calls on names; that of a file in an open folder is taken as one in the current folder. */
#define NAME_CALL(name, parameters, arguments, path)                                                                   \
    int name parameters                                                                                                \
    {                                                                                                                  \
        static int(*real) parameters;                                                                                  \
        if (!real) *(void **)&real = dlsym(RTLD_NEXT, #name);                                                          \
        return strikes(#name, -1, path) ? -1 : real arguments;                                                         \
    }
NAME_CALL(rename, (const char *from, const char *to), (from, to), from)
NAME_CALL(link, (const char *from, const char *to), (from, to), from)
NAME_CALL(unlink, (const char *name), (name), name)
NAME_CALL(unlinkat, (int folder, const char *name, int flags), (folder, name, flags), name)

static int open_by(const char *real_name, const char *name, int flags, mode_t mode)
{
    int (*real)(const char *, int, ...) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, real_name);
    return strikes("open", -1, name) ? -1 : real(name, flags, mode);
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
