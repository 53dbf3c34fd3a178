/* file_io - the one way to read and write through a descriptor: to the last byte. What a signal interrupts is taken up
 * again, and a transfer that ends early goes on where it ended, until it is whole or fails with a reason.
 *
 * The functions return 0, or -1 and errno, so that the caller says what it was doing. */
#ifndef HIFDM_FILE_IO_H
#define HIFDM_FILE_IO_H

#include <hifdm/status.h>
#include <stdbool.h>
#include <sys/types.h>
#include <sys/uio.h>

int hf_file_io_open(const char *name, int flags); /* open(2); new files get the mode 0666. Returns the descriptor */

/* An ordinary file to read, and its size. EEXIST when the name is that of anything else: a folder, a pipe, which is not
 * waited for, a device. */
int hf_file_io_open_ordinary(const char *name, off_t *size);

int hf_file_io_write(int file, const void *from, size_t n);
int hf_file_io_write_at(int file, const void *from, size_t n, off_t at);

/* All pieces one after the other, in one writev(2) unless that ends early. The pieces are changed. */
int hf_file_io_write_pieces(int file, struct iovec *piece, int n);

/* The number of bytes that were read: fewer than n only at the end of the file. */
ssize_t hf_file_io_read(int file, void *to, size_t n);
ssize_t hf_file_io_read_at(int file, void *to, size_t n, off_t at);

int hf_file_io_cut(int file, off_t size); /* ftruncate(2) */

/* The file's content is on the disk; with `content_alone` not its times. A file system that knows no such thing is no
 * failure. */
int hf_file_io_sync(int file, bool content_alone);

/* The descriptor is free in any case. A failure means that what was written may be lost. */
int hf_file_io_close(int file);

/* Locks are had at once or not at all. NONE: this file system knows no locks. FAILED: it does, but the machine refuses,
 * with errno. */
typedef enum { HF_LOCK_OURS, HF_LOCK_TAKEN, HF_LOCK_NONE, HF_LOCK_FAILED } hf_lock;
hf_lock hf_file_io_lock(int file);                /* of the whole file, with this descriptor: flock(2) */
hf_lock hf_file_io_lock_byte(int file, off_t at); /* with this process: a record lock of fcntl(2) */
void hf_file_io_unlock_byte(int file, off_t at);

/* Wait until something can be written to a pipe or a terminal, or writing would fail. False when a request to stop came
 * and nobody has read for grace_ms since. */
bool hf_file_io_await_room(int file, int grace_ms);

/* Whose fault is it that a file cannot be opened or read? HF_NO_MEMORY and HF_IO: the machine's, and another time it
 * may go well; HF_INTERRUPTED for EINTR; `otherwise` when the name or the file is wrong. */
hf_status hf_file_io_fault(int why, hf_status otherwise);

#endif
