#define _DEFAULT_SOURCE /* flock */
#include "base/file_io.h"

#include "base/signals.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define AWAIT_MS 200 /* poll(2) misses a request that arrives just before it; this bounds the delay */

int hf_file_io_open(const char *name, int flags)
{
    return HF_UNINTERRUPTED(open(name, flags, 0666));
}

int hf_file_io_open_ordinary(const char *name, off_t *size)
{
    struct stat info;
    int file = hf_file_io_open(name, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (file < 0 && errno == ENXIO) errno = EEXIST; /* the file is a socket */
    if (file < 0) return -1;
    int failed = fstat(file, &info), why = failed ? errno : EEXIST;
    *size = failed ? 0 : info.st_size;
    if (!failed && S_ISREG(info.st_mode)) return file;
    close(file);
    errno = why;
    return -1;
}

/* ---- whole transfers ---- */

enum { HERE = -1 };

/* Returns true if a write failed or wrote nothing. A write of 0 bytes becomes ENOSPC, because its repetition
 * would never end. */
static bool is_stuck(ssize_t done)
{
    if (done == 0) errno = ENOSPC;
    return done <= 0;
}

/* Writes to the present position of the file for at = HERE, otherwise to `at`. */
int hf_file_io_write_at(int file, const void *from, size_t n, off_t at)
{
    const char *bytes = from;
    for (size_t done = 0; done < n;) {
        ssize_t now = HF_UNINTERRUPTED(at == HERE ? write(file, bytes + done, n - done)
                                                  : pwrite(file, bytes + done, n - done, at + (off_t)done));
        if (is_stuck(now)) return -1;
        done += (size_t)now;
    }
    return 0;
}

int hf_file_io_write(int file, const void *from, size_t n)
{
    return hf_file_io_write_at(file, from, n, HERE);
}

int hf_file_io_write_pieces(int file, struct iovec *piece, int n)
{
    while (n > 0) {
        if (piece->iov_len == 0) {
            piece++, n--;
            continue;
        }
        ssize_t now = HF_UNINTERRUPTED(writev(file, piece, n));
        if (is_stuck(now)) return -1;
        for (size_t left = (size_t)now; left > 0;) {
            size_t taken = left < piece->iov_len ? left : piece->iov_len;
            piece->iov_base = (char *)piece->iov_base + taken;
            piece->iov_len -= taken;
            left -= taken;
            if (piece->iov_len == 0) piece++, n--;
        }
    }
    return 0;
}

/* Reads from the present position of the file for at = HERE, otherwise from `at`. */
ssize_t hf_file_io_read_at(int file, void *to, size_t n, off_t at)
{
    char *bytes = to;
    size_t done = 0;
    while (done < n) {
        ssize_t now = HF_UNINTERRUPTED(at == HERE ? read(file, bytes + done, n - done)
                                                  : pread(file, bytes + done, n - done, at + (off_t)done));
        if (now < 0) return -1;
        if (now == 0) break;
        done += (size_t)now;
    }
    return (ssize_t)done;
}

ssize_t hf_file_io_read(int file, void *to, size_t n)
{
    return hf_file_io_read_at(file, to, n, HERE);
}

int hf_file_io_cut(int file, off_t size)
{
    return HF_UNINTERRUPTED(ftruncate(file, size));
}

/* ---- the disk ---- */

int hf_file_io_sync(int file, bool content_alone)
{
    int result = HF_UNINTERRUPTED(content_alone ? fdatasync(file) : fsync(file));
    return result == 0 || errno == EINVAL || errno == ENOSYS || errno == ENOTSUP ? 0 : -1;
}

int hf_file_io_close(int file)
{
    return close(file) == 0 || errno == EINTR ? 0 : -1; /* Linux frees the descriptor before a signal can interrupt */
}

/* ---- locks ---- */

static hf_lock lock_of_result(int result)
{
    if (result == 0) return HF_LOCK_OURS;
    if (errno == EWOULDBLOCK || errno == EACCES) return HF_LOCK_TAKEN;
    return errno == ENOSYS || errno == EOPNOTSUPP || errno == EINVAL ? HF_LOCK_NONE : HF_LOCK_FAILED;
}

hf_lock hf_file_io_lock(int file)
{
    return lock_of_result(HF_UNINTERRUPTED(flock(file, LOCK_EX | LOCK_NB)));
}

static int set_byte(int file, off_t at, short type)
{
    struct flock lock = {.l_type = type, .l_whence = SEEK_SET, .l_start = at, .l_len = 1};
    return HF_UNINTERRUPTED(fcntl(file, F_SETLK, &lock));
}

hf_lock hf_file_io_lock_byte(int file, off_t at)
{
    return lock_of_result(set_byte(file, at, F_WRLCK));
}

void hf_file_io_unlock_byte(int file, off_t at)
{
    set_byte(file, at, F_UNLCK); /* if this fails, the lock ends with the process */
}

/* ---- waiting, and faults ---- */

bool hf_file_io_await_room(int file, int grace_ms)
{
    struct pollfd one = {.fd = file, .events = POLLOUT};
    for (;;) {
        bool is_last = *hf_signals_request() != 0;
        int n = poll(&one, 1, is_last ? grace_ms : AWAIT_MS);
        if (n > 0 || (n < 0 && errno != EINTR)) return true;
        if (n == 0 && is_last) return false;
    }
}

hf_status hf_file_io_fault(int why, hf_status otherwise)
{
    static const int of_name[] = {ENOENT, ENOTDIR, EISDIR, EACCES, EPERM, ELOOP, ENAMETOOLONG, ENXIO, ENODEV};
    for (size_t i = 0; i < sizeof of_name / sizeof *of_name; i++)
        if (why == of_name[i]) return otherwise;
    return why == ENOMEM ? HF_NO_MEMORY : why == EINTR ? HF_INTERRUPTED : HF_IO;
}
