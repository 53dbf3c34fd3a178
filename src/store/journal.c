/* Implements journal.h. Sections: file and lock, records, replay, rotation and end. */
#include "store/journal.h"

#include "base/clock.h"
#include "base/file_io.h"
#include "base/file_out.h"
#include "base/path.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#define MAGIC "hifdm-j3"
#define RECORD_MAGIC 0x4a444648u /* "HFDJ" as bytes of a little-endian machine */
#define HEADER_BYTES (8 + HF_JOURNAL_IDENTITY)
#define PAYLOAD_MAX (1u << 31)
/* An attempt fails only if another process removes the journal between opening and locking it. The tests of the store
 * and of interrupting pass with 1 and with 500. */
#define OPEN_ATTEMPTS 5

typedef struct {
    uint32_t magic, length, crc; /* crc and length: of generation and payload */
    int32_t generation;
} record_head;
_Static_assert(sizeof(record_head) == 16, "records have no padding");
#define GENERATION_AT offsetof(record_head, generation) /* length and crc count the bytes from here on */

/* ---- file and lock ---- */

static hf_status fail(const hf_journal *j, const char *what, const char *path, hf_messages *messages)
{
    return hf_error(messages, HF_IO, "%s: cannot %s %s: %s", j->result, what, path, strerror(errno));
}

typedef enum { JOURNAL, OTHER_VERSION, FOREIGN } content;

static hf_status look_at_head(hf_journal *j, content *is, hf_messages *messages)
{
    char magic[8];
    struct stat info;
    *is = FOREIGN;
    if (j->file < 0) return HF_OK;
    if (fstat(j->file, &info) != 0) return fail(j, "read", j->path, messages);
    j->is_new = info.st_size == 0;
    j->size = info.st_size;
    ssize_t n = hf_file_io_read_at(j->file, magic, sizeof magic, 0);
    if (n < 0) return fail(j, "read", j->path, messages);
    if (n == sizeof magic && memcmp(magic, MAGIC, sizeof magic - 1) == 0) *is = OTHER_VERSION;
    if (memcmp(magic, MAGIC, (size_t)n) == 0) *is = JOURNAL; /* also true for the beginning of a header */
    return HF_OK;
}

/* Opens and locks the journal, and looks at its head. Returns HF_OK with j->file -1 if the name belongs to a link or to
 * another thing that is no ordinary file. */
static hf_status open_and_lock(hf_journal *j, content *is, hf_messages *messages)
{
    bool was_there;
    for (int i = 0; i < OPEN_ATTEMPTS; i++) {
        j->file = hf_file_out_keep(j->path, &was_there);
        j->was_there |= was_there;
        if (j->file < 0 && errno == EEXIST) return look_at_head(j, is, messages);
        if (j->file < 0) return fail(j, "create", j->path, messages);
        hf_lock lock = hf_file_io_lock(j->file);
        if (lock == HF_LOCK_TAKEN || lock == HF_LOCK_FAILED) {
            int why = errno;
            close(j->file);
            j->file = -1;
            errno = why;
            if (lock == HF_LOCK_FAILED) return fail(j, "lock", j->path, messages);
            return hf_error(messages, HF_EXISTS, "%s: another process is writing this result and holds the lock of %s",
                            j->result, j->path);
        }
        if (lock == HF_LOCK_NONE && i == 0)
            hf_warning(messages,
                       "%s: this file system has no locks (%s), so hifdm cannot prevent a second process from writing "
                       "this result. Do not start a second process",
                       j->result, strerror(errno));
        if (hf_path_leads_to(j->path, j->file)) return look_at_head(j, is, messages);
        close(j->file); /* its owner rotated or removed it between open and lock */
        j->file = -1;
    }
    return hf_error(messages, HF_EXISTS, "%s: %s keeps changing. Is another process writing it?", j->result, j->path);
}

hf_status hf_journal_open(const char *result, bool replaces, hf_journal *j, hf_messages *messages)
{
    size_t size = strlen(result) + 16;
    content is;
    *j = (hf_journal){.file = -1, .result = result, .path = malloc(size)};
    if (!j->path) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", result);
    snprintf(j->path, size, "%s.journal", result);
    HF_TRY(open_and_lock(j, &is, messages));
    if (is != JOURNAL && replaces) { /* unlink, not truncate: the name may be a link to another file */
        if (unlink(j->path) != 0) return fail(j, "remove", j->path, messages);
        hf_warning(messages, "%s: %s was not a journal of hifdm, so hifdm replaced this file", result, j->path);
        if (j->file >= 0) close(j->file);
        HF_TRY(open_and_lock(j, &is, messages));
    }
    if (is == JOURNAL) return HF_OK;
    if (j->file >= 0) close(j->file);
    j->file = -1;
    if (is == OTHER_VERSION)
        return hf_error(messages, HF_EXISTS,
                        "%s: %s is a journal of another version of hifdm. Finish the run with that version, or restart "
                        "the run with --restart (in a sweep: --retry failed)",
                        result, j->path);
    return hf_error(messages, HF_EXISTS,
                    "%s: %s is not a journal of hifdm, but the file has the name of a journal. Delete this file, use "
                    "--restart (in a sweep: --retry failed) to replace both files, or use -o to choose another name",
                    result, j->path);
}

bool hf_journal_peek(const char *result, char identity[HF_JOURNAL_IDENTITY + 1], bool *has_records)
{
    char path[HF_FILE_OUT_SIZE + 16], header[HEADER_BYTES + 1] = "";
    struct stat info;
    /* Reading through links of other users is safe. */
    if (hf_file_out_target(result, path, NULL) != HF_OK && !realpath(result, path)) return false;
    strcat(path, ".journal");
    int file = hf_file_io_open(path, O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
    ssize_t n = file >= 0 ? hf_file_io_read(file, header, HEADER_BYTES) : -1;
    *has_records = n == HEADER_BYTES && fstat(file, &info) == 0 && info.st_size > HEADER_BYTES;
    if (file >= 0) close(file);
    strcpy(identity, header + 8);
    return n >= 8 && !memcmp(header, MAGIC, 8);
}

/* Writes a header and goes to its end. Returns 0, or -1 and errno. */
static int write_header(int file, const char *identity)
{
    char header[HEADER_BYTES] = {0};
    memcpy(header, MAGIC, 8);
    memcpy(header + 8, identity, strnlen(identity, HF_JOURNAL_IDENTITY));
    if (hf_file_io_write_at(file, header, sizeof header, 0) != 0) return -1;
    return lseek(file, HEADER_BYTES, SEEK_SET) == HEADER_BYTES ? 0 : -1;
}

hf_status hf_journal_restart(hf_journal *j, const char *identity, hf_messages *messages)
{
    snprintf(j->identity, sizeof j->identity, "%s", identity);
    if (hf_file_io_cut(j->file, 0) != 0 || write_header(j->file, identity) != 0)
        return fail(j, "write", j->path, messages);
    j->size = HEADER_BYTES;
    j->n_held = 0;
    j->is_new = true;
    j->has_news = false;
    return HF_OK;
}

bool hf_journal_is_empty(const hf_journal *j)
{
    return j->size <= HEADER_BYTES && j->n_held == 0;
}

/* ---- records ---- */

/* Writes whole records, `bytes` in all. */
static hf_status write_records(hf_journal *j, struct iovec *piece, int n, size_t bytes, hf_messages *messages)
{
    if (hf_file_io_write_pieces(j->file, piece, n) == 0) {
        j->size += (int64_t)bytes;
        j->has_news = true;
        j->written_s = hf_clock_s();
        return HF_OK;
    }
    hf_status status = fail(j, "write", j->path, messages);
    if (hf_file_io_cut(j->file, j->size) == 0) lseek(j->file, j->size, SEEK_SET); /* if not, the CRC detects it */
    return status;
}

hf_status hf_journal_append(hf_journal *j, int generation, const struct iovec *piece, int n, hf_messages *messages)
{
    struct iovec part[HF_JOURNAL_PIECES + 1];
    record_head head = {.magic = RECORD_MAGIC, .generation = generation};
    size_t bytes = sizeof head;
    part[0] = (struct iovec){&head, sizeof head};
    for (int i = 0; i < n; i++) {
        part[i + 1] = piece[i];
        bytes += piece[i].iov_len;
    }
    if (bytes > PAYLOAD_MAX) return hf_error(messages, HF_IO, "%s: a generation is larger than 2 GiB", j->result);
    head.length = (uint32_t)(bytes - GENERATION_AT);
    if (j->n_held + bytes > HF_JOURNAL_HELD) HF_TRY(hf_journal_write(j, messages));
    if (j->hold_s > 0 && !j->held) j->held = malloc(HF_JOURNAL_HELD); /* without it nothing waits */
    if (!j->held || bytes > HF_JOURNAL_HELD) {
        uLong crc = crc32(0, (const Bytef *)&head.generation, sizeof head.generation);
        for (int i = 0; i < n; i++)
            crc = crc32(crc, piece[i].iov_base, (uInt)piece[i].iov_len);
        head.crc = (uint32_t)crc;
        return write_records(j, part, n + 1, bytes, messages);
    }
    char *record = j->held + j->n_held, *to = record;
    for (int i = 0; i <= n; to += part[i++].iov_len)
        memcpy(to, part[i].iov_base, part[i].iov_len);
    head.crc = (uint32_t)crc32(0, (const Bytef *)record + GENERATION_AT, (uInt)(bytes - GENERATION_AT));
    memcpy(record, &head, sizeof head);
    j->n_held += bytes;
    return hf_clock_s() - j->written_s < j->hold_s ? HF_OK : hf_journal_write(j, messages);
}

hf_status hf_journal_write(hf_journal *j, hf_messages *messages)
{
    struct iovec piece = {j->held, j->n_held};
    if (j->n_held == 0) return HF_OK;
    j->n_held = 0;
    return write_records(j, &piece, 1, piece.iov_len, messages);
}

hf_status hf_journal_tend(hf_journal *j, double now_s, hf_messages *messages)
{
    if (j->synced_s == 0) j->synced_s = now_s; /* the first call starts the clock */
    if (now_s - j->synced_s < HF_JOURNAL_SYNC_S) return HF_OK;
    j->synced_s = now_s;
    if (!hf_path_leads_to(j->path, j->file))
        return hf_error(messages, HF_IO, "%s: the journal %s was removed or replaced during the run", j->result,
                        j->path);
    if (j->has_news && hf_file_io_sync(j->file, true) != 0) return fail(j, "write", j->path, messages);
    j->has_news = false;
    return HF_OK;
}

/* ---- replay ---- */

/* Reads exactly n bytes. Returns 1, 0 if there are fewer, or -1 and errno. */
static int read_whole(int file, void *to, size_t n, int64_t at)
{
    ssize_t got = hf_file_io_read_at(file, to, n, (off_t)at);
    return got < 0 ? -1 : (size_t)got == n;
}

/* Reads the record at `at` into *payload, which grows as needed. Returns 1, 0 if there is no whole record, or -1 and
 * errno. *is_damaged becomes true if there is no whole record because of damage. A record shorter than its head says is
 * no damage if the rest of the file is shorter than the longest record so far: the process ended while it wrote the
 * record. */
static int read_record(const hf_journal *j, int64_t at, int64_t end, record_head *head, char **payload,
                       size_t *capacity, bool *is_damaged)
{
    int got = read_whole(j->file, head, sizeof *head, at);
    if (got <= 0) return got;
    size_t bytes = head->length - sizeof head->generation;
    bool fits = at + (int64_t)sizeof *head + (int64_t)bytes <= end;
    if (head->magic != RECORD_MAGIC || head->length < sizeof head->generation || head->length > PAYLOAD_MAX || !fits) {
        bool has_room = *payload && at + (int64_t)sizeof *head + (int64_t)*capacity <= end;
        *is_damaged = fits || has_room || head->magic != RECORD_MAGIC;
        return 0;
    }
    if (bytes > *capacity || !*payload) {
        char *bigger = realloc(*payload, bytes + 1);
        if (!bigger) {
            errno = ENOMEM;
            return -1;
        }
        *payload = bigger;
        *capacity = bytes;
    }
    got = read_whole(j->file, *payload, bytes, at + (int64_t)sizeof *head);
    if (got <= 0) return got;
    uLong crc = crc32(0, (const Bytef *)&head->generation, sizeof head->generation);
    *is_damaged = (uint32_t)crc32(crc, (const Bytef *)*payload, (uInt)bytes) != head->crc;
    return !*is_damaged;
}

hf_status hf_journal_replay(hf_journal *j, const char *identity, hf_journal_take *take, void *context,
                            hf_messages *messages)
{
    char header[HEADER_BYTES], *payload = NULL;
    size_t capacity = 0;
    record_head head;
    struct stat info;
    hf_status status = HF_OK;
    bool is_damaged = false;
    int got = read_whole(j->file, header, sizeof header, 0);
    if (got < 0 || fstat(j->file, &info) != 0) return fail(j, "read", j->path, messages);
    bool is_ours = got && strncmp(header + 8, identity, HF_JOURNAL_IDENTITY) == 0;
    if (!is_ours && info.st_size > HEADER_BYTES)
        return hf_error(messages, HF_EXISTS,
                        "%s: the journal %s belongs to another case. Delete this journal, replace it with the right "
                        "journal, or restart the run with --restart (in a sweep: --retry failed)",
                        j->result, j->path);
    if (!is_ours) return hf_journal_restart(j, identity, messages);
    snprintf(j->identity, sizeof j->identity, "%s", identity);
    int64_t at = HEADER_BYTES;
    while (status == HF_OK && (got = read_record(j, at, info.st_size, &head, &payload, &capacity, &is_damaged)) == 1) {
        status = take(context, head.generation, payload, head.length - sizeof head.generation);
        if (status != HF_OK) break;
        at += (int64_t)sizeof head + head.length - (int64_t)sizeof head.generation;
    }
    int why = errno;
    free(payload);
    errno = why;
    if (status != HF_OK && status != HF_DIFFERENT) return status;
    if (got < 0 && errno == ENOMEM) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", j->result);
    if (got < 0) return fail(j, "read", j->path, messages);
    if (is_damaged)
        hf_warning(messages, "%s: the journal %s is damaged, so hifdm ignores its last %lld bytes", j->result, j->path,
                   (long long)(info.st_size - at));
    if (hf_file_io_cut(j->file, at) != 0 || lseek(j->file, at, SEEK_SET) < 0)
        return fail(j, "write", j->path, messages);
    j->size = at;
    return HF_OK;
}

/* ---- rotation and end ---- */

hf_status hf_journal_rotate(hf_journal *j, hf_messages *messages)
{
    hf_file_out next;
    if (hf_file_out_make(j->result, &next) != 0) return fail(j, "create", next.temporary, messages);
    int file = fcntl(next.file, F_DUPFD_CLOEXEC, 0); /* a copy, because hf_file_out_replace closes next.file */
    hf_lock lock = file < 0 ? HF_LOCK_FAILED : hf_file_io_lock(file);
    if ((lock != HF_LOCK_OURS && lock != HF_LOCK_NONE) || write_header(file, j->identity) != 0 ||
        hf_file_out_replace(&next, j->path) != 0) {
        hf_status status = fail(j, "write", next.temporary, messages);
        if (file >= 0) close(file);
        hf_file_out_drop(&next, messages);
        return status;
    }
    close(j->file);
    j->file = file;
    j->size = HEADER_BYTES;
    j->n_held = 0;
    j->has_news = false;
    return HF_OK;
}

void hf_journal_close(hf_journal *j, bool remove)
{
    if (j->file >= 0) {
        if (remove)
            unlink(j->path);
        else
            (void)hf_journal_write(j, NULL);
        close(j->file);
    }
    free(j->held);
    free(j->path);
    *j = (hf_journal){.file = -1};
}
