/* file_io - complete transfers of bytes through descriptors.
 *
 * A call that a signal interrupts is repeated. A transfer that ends early continues where it ended, until it is
 * complete or fails with a reason. Unless stated otherwise, the functions return 0, or -1 and errno; the caller
 * writes the message. */
#pragma once

#include <errno.h>
#include <hifdm/status.h>
#include <stdbool.h>
#include <sys/types.h>
#include <sys/uio.h>

/* Repeats a system call while a signal interrupts it. The value is its result. */
#define HF_UNINTERRUPTED(call)                                                                                         \
    __extension__({                                                                                                    \
        __typeof__(call) result_;                                                                                      \
        do                                                                                                             \
            result_ = (call);                                                                                          \
        while (result_ < 0 && errno == EINTR);                                                                         \
        result_;                                                                                                       \
    })

int hf_file_io_open(const char *name, int flags); /* open(2), mode 0666 for new files; returns the descriptor */

/* Opens an ordinary file to read, and writes its size. Returns the descriptor, or -1 and errno. errno is EEXIST if
 * `name` is not an ordinary file: a folder, a pipe, a socket or a device. The function does not wait for the writer
 * of a pipe. */
int hf_file_io_open_ordinary(const char *name, off_t *size);

int hf_file_io_write(int file, const void *from, size_t n);
int hf_file_io_write_at(int file, const void *from, size_t n, off_t at);

/* Writes n pieces one after the other, in one writev(2) unless that ends early. Changes the pieces. */
int hf_file_io_write_pieces(int file, struct iovec *piece, int n);

/* Return the number of bytes read, or -1 and errno. The number is smaller than n only at the end of the file. */
ssize_t hf_file_io_read(int file, void *to, size_t n);
ssize_t hf_file_io_read_at(int file, void *to, size_t n, off_t at);

int hf_file_io_cut(int file, off_t size); /* ftruncate(2) */

/* Waits until the content of the file is on the disk. The times of the file are included unless `content_alone` is
 * true. If the file system has no such operation, the function succeeds. */
int hf_file_io_sync(int file, bool content_alone);

/* Closes the descriptor. It is free afterwards even if the call fails. A failure means that written data
 * may be lost. */
int hf_file_io_close(int file);

/* Results of a lock. The functions do not wait. HF_LOCK_TAKEN: another process or descriptor has the lock.
 * HF_LOCK_NONE: the file system has no locks. HF_LOCK_FAILED: it has locks, but the call failed; the reason
 * is in errno. */
typedef enum { HF_LOCK_OURS, HF_LOCK_TAKEN, HF_LOCK_NONE, HF_LOCK_FAILED } hf_lock;
hf_lock hf_file_io_lock(int file);                /* locks the whole file for this descriptor, flock(2) */
hf_lock hf_file_io_lock_byte(int file, off_t at); /* locks one byte for this process, fcntl(2) */
void hf_file_io_unlock_byte(int file, off_t at);

/* Waits until a pipe or a terminal accepts data, or until writing would fail. Returns false if a request to stop has
 * arrived and nothing was read within grace_ms (milliseconds) afterwards. */
bool hf_file_io_await_room(int file, int grace_ms);

/* Returns the status for a file that cannot be opened or read with errno `why`. Returns `otherwise` if the name or the
 * file is wrong, and HF_INTERRUPTED for EINTR. Returns HF_NO_MEMORY or HF_IO if the machine is at fault; the same call
 * may succeed later. */
hf_status hf_file_io_fault(int why, hf_status otherwise);
