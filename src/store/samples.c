/* Implements samples.h: a chunk is appended to the journal first and then written to its position in the scratch
 * file. */
#include "store/samples.h"

#include "base/clock.h"
#include "base/file_io.h"
#include "base/file_out.h"
#include "base/path.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define OF_CASE 32 /* characters of the identity that are known before the design is */

static void name_journal(const char *result, int task, int tasks, char name[HF_SAMPLES_NAME_SIZE])
{
    if (tasks > 0)
        snprintf(name, HF_SAMPLES_NAME_SIZE, "%s.tolerance-%d-of-%d", result, task, tasks);
    else
        snprintf(name, HF_SAMPLES_NAME_SIZE, "%s.tolerance", result);
}

static size_t row_bytes(const hf_samples *s)
{
    return (size_t)s->n_value * sizeof(double);
}

static hf_status fail_rows(hf_samples *s, const char *what, const char *why)
{
    return hf_error(s->messages, HF_IO, "%s: cannot %s the scratch file of samples: %s", s->name, what, why);
}

static hf_status keep_rows(hf_samples *s, int chunk, const void *row)
{
    int n;
    off_t at = (off_t)hf_samples_first(s, chunk, &n) * (off_t)row_bytes(s);
    if (hf_file_io_write_at(s->rows, row, (size_t)n * row_bytes(s), at) != 0)
        return fail_rows(s, "write", strerror(errno));
    s->n_have += !s->has[chunk];
    s->has[chunk] = 1;
    return HF_OK;
}

/* Takes a chunk from a journal; an hf_journal_take. */
static hf_status take_chunk(void *context, int chunk, const void *payload, size_t bytes)
{
    hf_samples *s = context;
    int n = 0;
    if (chunk >= 0 && chunk < s->n_all) hf_samples_first(s, chunk, &n);
    if (n == 0 || bytes != (size_t)n * row_bytes(s))
        return hf_error(s->messages, HF_EXISTS,
                        "%s: the journal has %zu bytes of chunk %d, but this case has no such chunk. Delete the "
                        "journal, or restart the run with --restart",
                        s->name, bytes, chunk);
    return keep_rows(s, chunk, payload);
}

hf_status hf_samples_open(const char *result, const char *beside, int task, int tasks, const char *identity,
                          bool restart, long n, int n_chunk, int n_value, hf_samples *s, hf_messages *messages)
{
    *s = (hf_samples){
        .n = n, .n_chunk = n_chunk, .n_value = n_value, .messages = messages, .journal.file = -1, .rows = -1};
    s->n_all = (int)((n + n_chunk - 1) / n_chunk);
    snprintf(s->identity, sizeof s->identity, "%s", identity);
    name_journal(result ? result : "samples", task, tasks, s->name);
    if (!(s->has = calloc((size_t)s->n_all, 1))) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", s->name);
    s->rows = hf_file_out_scratch(beside);
    if (s->rows < 0) return fail_rows(s, "make", strerror(errno));
    if (!result) return HF_OK;
    HF_TRY(hf_journal_open(s->name, restart, &s->journal, messages));
    if (restart) return hf_journal_restart(&s->journal, identity, messages);
    return hf_journal_replay(&s->journal, identity, take_chunk, s, messages);
}

void hf_samples_identify(const char of_case[65], const char of_design[65], char identity[65])
{
    snprintf(identity, 65, "%.*s%.*s", OF_CASE, of_case, 64 - OF_CASE, of_design);
}

hf_status hf_samples_look(const char *result, int task, int tasks, const char of_case[65], hf_messages *messages)
{
    char name[HF_SAMPLES_NAME_SIZE], identity[HF_JOURNAL_IDENTITY + 1];
    bool has_records;
    int first = task < 0 ? -1 : task, end = task < 0 ? tasks : task + 1;
    for (int i = first; i < end; i++) {
        name_journal(result, i, i < 0 ? 0 : tasks, name);
        if (hf_journal_peek(name, identity, &has_records) && has_records && strncmp(identity, of_case, OF_CASE) != 0)
            return hf_error(
                messages, HF_EXISTS,
                "%s: %s.journal has samples of another case. Delete the journal, or restart the run with --restart",
                result, name);
    }
    return HF_OK;
}

static bool remove_journal_of(const char *name)
{
    char path[HF_SAMPLES_NAME_SIZE + 16];
    snprintf(path, sizeof path, "%s.journal", name);
    return unlink(path) == 0;
}

hf_status hf_samples_collect(hf_samples *s, const char *result, int tasks, bool restart)
{
    char name[HF_SAMPLES_NAME_SIZE], identity[HF_JOURNAL_IDENTITY + 1];
    for (int task = 0; task < tasks; task++) {
        hf_journal journal;
        bool has_records;
        name_journal(result, task, tasks, name);
        if (!hf_journal_peek(name, identity, &has_records)) continue;
        if (restart && has_records && strcmp(identity, s->identity) != 0 && remove_journal_of(name)) continue;
        hf_status status = hf_journal_open(name, false, &journal, s->messages);
        if (status == HF_OK) status = hf_journal_replay(&journal, s->identity, take_chunk, s, s->messages);
        hf_journal_close(&journal, false);
        HF_TRY(status);
    }
    return HF_OK;
}

hf_status hf_samples_add(hf_samples *s, int chunk, const double *row)
{
    int n;
    hf_samples_first(s, chunk, &n);
    const struct iovec piece = {(void *)(uintptr_t)row, (size_t)n * row_bytes(s)}; /* the row is only read */
    if (s->journal.path) {
        HF_TRY(hf_journal_append(&s->journal, chunk, &piece, 1, s->messages));
        HF_TRY(hf_journal_tend(&s->journal, hf_clock_s(), s->messages));
    }
    return keep_rows(s, chunk, row);
}

hf_status hf_samples_read(void *context, long first, int n, double *row)
{
    hf_samples *s = context;
    size_t bytes = (size_t)n * row_bytes(s);
    if (s->stop && *s->stop) return HF_INTERRUPTED;
    ssize_t got = hf_file_io_read_at(s->rows, row, bytes, (off_t)first * (off_t)row_bytes(s));
    if (got < 0) return fail_rows(s, "read", strerror(errno));
    return got == (ssize_t)bytes ? HF_OK : fail_rows(s, "read", "it ends too early");
}

void hf_samples_close(hf_samples *s)
{
    hf_messages *messages = s->messages;
    if (s->n > 0 && s->rows >= 0) close(s->rows);
    if (s->journal.path) hf_journal_close(&s->journal, false);
    free(s->has);
    *s = (hf_samples){.messages = messages, .rows = -1};
}

/* Returns true for the journal of a task, RESULT.tolerance-*-of-*.journal, with any number of tasks. `name` begins
 * after RESULT. */
static bool is_of_task(const char *name)
{
    int task, tasks, end = 0;
    return sscanf(name, ".tolerance-%d-of-%d.journal%n", &task, &tasks, &end) == 2 && end > 0 && !name[end];
}

void hf_samples_remove(const char *result)
{
    char path[HF_SAMPLES_NAME_SIZE], folder[HF_SAMPLES_NAME_SIZE];
    const char *base = hf_path_name(result);
    size_t n = strlen(base);
    name_journal(result, -1, 0, path);
    remove_journal_of(path);
    hf_path_folder(result, folder, sizeof folder);
    DIR *entries = opendir(folder);
    if (!entries) return;
    for (struct dirent *e = readdir(entries); e; e = readdir(entries))
        if (!strncmp(e->d_name, base, n) && is_of_task(e->d_name + n)) unlinkat(dirfd(entries), e->d_name, 0);
    closedir(entries);
}
