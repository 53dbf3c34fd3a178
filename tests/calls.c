#include "calls.h"

#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

enum { N_KIND = 2 };

static struct {
    const char *name; /* NULL: none */
    atomic_long countdown;
    bool for_ever;
    int why;
} failing[N_KIND];

static _Atomic bool is_disturbed;
static atomic_long n_disturbed;

void fail_call_at(const char *name, long n, int why, bool for_ever)
{
    int i = 0;
    while (i < N_KIND - 1 && failing[i].name)
        i++;
    failing[i].why = why;
    failing[i].for_ever = for_ever;
    atomic_store(&failing[i].countdown, n);
    failing[i].name = name;
}

bool end_call_failure(void)
{
    bool are_reached = failing[0].name != NULL;
    for (int i = 0; i < N_KIND; i++) {
        if (failing[i].name) are_reached = are_reached && atomic_load(&failing[i].countdown) <= 0;
        failing[i].name = NULL;
    }
    return are_reached;
}

void disturb_calls(bool on)
{
    atomic_store(&n_disturbed, 0);
    atomic_store(&is_disturbed, on);
}

static atomic_long n_left; /* changes of files that this process may still begin, plus one; 0: any number */

void die_before_change(long n)
{
    atomic_store(&n_left, n);
}

/* Returns true for calls that make, change, name or remove files. */
static bool is_change(const char *name)
{
    static const char *const change[] = {"open",   "write", "writev", "pwrite",    "fsync", "fdatasync",
                                         "rename", "link",  "unlink", "ftruncate", "flock", "H5Fcreate"};
    for (size_t i = 0; i < sizeof change / sizeof *change; i++)
        if (!strcmp(name, change[i])) return true;
    return false;
}

static const char *awaited; /* name of a call; NULL: none */
static void (*act_before)(void);

void before_call(const char *name, void (*act)(void))
{
    act_before = act;
    awaited = name;
}

static bool fails(const char *name)
{
    if (atomic_load(&n_left) > 0 && is_change(name) && atomic_fetch_sub(&n_left, 1) == 1) _exit(9);
    if (awaited && strcmp(name, awaited) == 0) {
        awaited = NULL;
        act_before();
    }
    for (int i = 0; i < N_KIND; i++) {
        if (!failing[i].name || strcmp(name, failing[i].name) != 0) continue;
        long left = atomic_fetch_sub(&failing[i].countdown, 1) - 1;
        if (left != 0 && !(failing[i].for_ever && left < 0)) return false;
        errno = failing[i].why;
        return true;
    }
    return false;
}

static bool is_interrupted(void)
{
    if (!atomic_load(&is_disturbed) || atomic_fetch_add(&n_disturbed, 1) % 3 != 0) return false;
    errno = EINTR;
    return true;
}

/* Returns how many of n bytes such a call transfers. */
static size_t allowed(size_t n)
{
    return atomic_load(&is_disturbed) && atomic_load(&n_disturbed) % 3 == 2 && n > 1 ? 1 : n;
}

#define WRAP_AS(type, name, parameters, arguments, denied)                                                             \
    type __real_##name parameters;                                                                                     \
    type __wrap_##name parameters;                                                                                     \
    type __wrap_##name parameters                                                                                      \
    {                                                                                                                  \
        return (denied) ? (type)-1 : __real_##name arguments;                                                          \
    }
#define WRAP(type, name, parameters, arguments) WRAP_AS(type, name, parameters, arguments, fails(#name))
#define WRAP_SLOW(type, name, parameters, arguments)                                                                   \
    WRAP_AS(type, name, parameters, arguments, fails(#name) || is_interrupted())

/* No test can see what has reached the disk, and waiting for it thousands of times takes minutes. */
#define WRAP_SYNC(name)                                                                                                \
    int __wrap_##name(int file);                                                                                       \
    int __wrap_##name(int file)                                                                                        \
    {                                                                                                                  \
        return fails(#name) || is_interrupted() || fcntl(file, F_GETFD) < 0 ? -1 : 0;                                  \
    }

WRAP_SLOW(ssize_t, write, (int file, const void *from, size_t n), (file, from, allowed(n)))
WRAP_SLOW(ssize_t, pwrite, (int file, const void *from, size_t n, off_t at), (file, from, allowed(n), at))
WRAP_SLOW(ssize_t, read, (int file, void *to, size_t n), (file, to, allowed(n)))
WRAP_SLOW(ssize_t, pread, (int file, void *to, size_t n, off_t at), (file, to, allowed(n), at))
WRAP_SYNC(fsync)
WRAP_SYNC(fdatasync)
WRAP_SLOW(int, ftruncate, (int file, off_t size), (file, size))
WRAP_SLOW(int, flock, (int file, int how), (file, how))
WRAP(int, rename, (const char *from, const char *to), (from, to))
WRAP(int, link, (const char *from, const char *to), (from, to))
WRAP(int, unlink, (const char *name), (name))
WRAP(off_t, lseek, (int file, off_t at, int whence), (file, at, whence))
WRAP(int, fstat, (int file, struct stat *info), (file, info))
WRAP(int, stat, (const char *name, struct stat *info), (name, info))
WRAP(int, access, (const char *name, int mode), (name, mode))
WRAP(hid_t, H5Fcreate, (const char *name, unsigned flags, hid_t make, hid_t access_), (name, flags, make, access_))
WRAP(hid_t, H5Fopen, (const char *name, unsigned flags, hid_t access_), (name, flags, access_))
WRAP(hid_t, H5Dcreate2, (hid_t g, const char *name, hid_t t, hid_t s, hid_t l, hid_t c, hid_t a),
     (g, name, t, s, l, c, a))
WRAP(hid_t, H5Dopen2, (hid_t g, const char *name, hid_t a), (g, name, a))
WRAP(herr_t, H5Dset_extent, (hid_t d, const hsize_t *size), (d, size))
WRAP(herr_t, H5Dwrite, (hid_t d, hid_t t, hid_t m, hid_t f, hid_t p, const void *from), (d, t, m, f, p, from))
WRAP(herr_t, H5Dread, (hid_t d, hid_t t, hid_t m, hid_t f, hid_t p, void *to), (d, t, m, f, p, to))
WRAP(herr_t, H5Awrite, (hid_t a, hid_t t, const void *from), (a, t, from))
WRAP(herr_t, H5Aread, (hid_t a, hid_t t, void *to), (a, t, to))

ssize_t __real_writev(int file, const struct iovec *piece, int n);
ssize_t __wrap_writev(int file, const struct iovec *piece, int n);
ssize_t __wrap_writev(int file, const struct iovec *piece, int n)
{
    if (fails("writev") || is_interrupted()) return -1;
    struct iovec one = {piece->iov_base, 1};
    return allowed(2) == 1 ? __real_writev(file, &one, 1) : __real_writev(file, piece, n);
}

/* Calls the real close in any case, so that no descriptor stays open. */
int __real_close(int file);
int __wrap_close(int file);
int __wrap_close(int file)
{
    bool failed = fails("close");
    int why = errno, result = __real_close(file);
    if (failed) errno = why;
    return failed ? -1 : result;
}

int __real_open(const char *name, int flags, ...);
int __wrap_open(const char *name, int flags, ...);
int __wrap_open(const char *name, int flags, ...)
{
    va_list list;
    va_start(list, flags);
    mode_t mode = flags & O_CREAT ? (mode_t)va_arg(list, unsigned) : 0;
    va_end(list);
    return fails("open") || is_interrupted() ? -1 : __real_open(name, flags, mode);
}

/* Makes only the record locks of fcntl fail. */
int __real_fcntl(int file, int command, ...);
int __wrap_fcntl(int file, int command, ...);
int __wrap_fcntl(int file, int command, ...)
{
    va_list list;
    va_start(list, command);
    void *argument = va_arg(list, void *);
    va_end(list);
    bool is_lock = command == F_SETLK || command == F_GETLK;
    return is_lock && (fails("fcntl") || is_interrupted()) ? -1 : __real_fcntl(file, command, argument);
}
