#include "store/samples.h"

#include "base/arena.h"
#include "base/clock.h"
#include "base/file_io.h"
#include "base/file_out.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define ROW_BYTES (HF_TOLERANCE_COLUMNS * sizeof(double))

static void name_journal(const char *result, int task, int tasks, char name[HF_SAMPLES_NAME_SIZE])
{
    if (tasks > 0)
        snprintf(name, HF_SAMPLES_NAME_SIZE, "%s.tolerance-%d-of-%d", result, task, tasks);
    else
        snprintf(name, HF_SAMPLES_NAME_SIZE, "%s.tolerance", result);
}

static hf_status fail_rows(hf_samples *s, const char *what)
{
    return hf_error(s->messages, HF_IO, "%s: cannot %s its scratch file in the folder of temporary files: %s", s->name,
                    what, strerror(errno));
}

static hf_status keep_rows(hf_samples *s, int chunk, const void *row)
{
    int n;
    off_t at = (off_t)hf_samples_first(s, chunk, &n) * (off_t)ROW_BYTES;
    if (hf_file_io_write_at(s->rows, row, (size_t)n * ROW_BYTES, at) != 0) return fail_rows(s, "write");
    s->n_have += !s->has[chunk];
    s->has[chunk] = 1;
    return HF_OK;
}

/* An hf_journal_take. */
static hf_status take_chunk(void *context, int chunk, const void *payload, size_t bytes)
{
    hf_samples *s = context;
    int n = 0;
    if (chunk >= 0 && chunk < s->n_all) hf_samples_first(s, chunk, &n);
    if (n == 0 || bytes != (size_t)n * ROW_BYTES)
        return hf_error(s->messages, HF_EXISTS,
                        "%s: its journal has %zu bytes of chunk %d, which this case has not; "
                        "delete it, or begin anew with --restart",
                        s->name, bytes, chunk);
    return keep_rows(s, chunk, payload);
}

hf_status hf_samples_open(const char *result, int task, int tasks, const char *identity, bool restart, long n,
                          int n_chunk, hf_samples *s, hf_messages *messages)
{
    *s = (hf_samples){.n = n, .n_chunk = n_chunk, .messages = messages, .journal.file = -1, .rows = -1};
    hf_arena arena = {0};
    s->n_all = (int)((n + n_chunk - 1) / n_chunk);
    snprintf(s->identity, sizeof s->identity, "%s", identity);
    name_journal(result ? result : "samples", task, tasks, s->name);
    if (HF_ARENA_MAKE(&arena, s->has = hf_arena_take(&arena, (size_t)s->n_all, 1)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", s->name);
    s->block = arena.block;
    s->rows = hf_file_out_scratch();
    if (s->rows < 0) return fail_rows(s, "make");
    if (!result) return HF_OK;
    s->has_journal = true;
    HF_TRY(hf_journal_open(s->name, restart, &s->journal, messages));
    if (restart) return hf_journal_restart(&s->journal, identity, messages);
    return hf_journal_replay(&s->journal, identity, take_chunk, s, messages);
}

hf_status hf_samples_collect(hf_samples *s, const char *result, int tasks)
{
    char name[HF_SAMPLES_NAME_SIZE];
    for (int task = 0; task < tasks; task++) {
        hf_journal journal;
        name_journal(result, task, tasks, name);
        if (!hf_journal_is_there(name)) continue;
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
    const struct iovec piece = {(void *)(uintptr_t)row, (size_t)n * ROW_BYTES}; /* which is only read */
    if (s->has_journal) {
        HF_TRY(hf_journal_append(&s->journal, chunk, &piece, 1, s->messages));
        HF_TRY(hf_journal_tend(&s->journal, hf_clock_s(), s->messages));
    }
    return keep_rows(s, chunk, row);
}

hf_status hf_samples_read(void *context, long first, int n, double *row)
{
    hf_samples *s = context;
    size_t bytes = (size_t)n * ROW_BYTES;
    ssize_t got = hf_file_io_read_at(s->rows, row, bytes, (off_t)first * (off_t)ROW_BYTES);
    return got == (ssize_t)bytes ? HF_OK : fail_rows(s, "read");
}

void hf_samples_close(hf_samples *s)
{
    hf_messages *messages = s->messages;
    hf_arena arena = {.block = s->block};
    if (s->n > 0 && s->rows >= 0) close(s->rows);
    if (s->has_journal) hf_journal_close(&s->journal, false);
    hf_arena_free(&arena);
    *s = (hf_samples){.messages = messages, .rows = -1};
}

void hf_samples_remove(const char *result, int tasks)
{
    char name[HF_SAMPLES_NAME_SIZE + 16];
    for (int task = -1; task < tasks; task++) {
        name_journal(result, task, task < 0 ? 0 : tasks, name);
        strcat(name, ".journal");
        unlink(name);
    }
}
