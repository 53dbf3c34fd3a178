/* Checks names of files, and writes to readers that may have stopped reading. output.h describes the interface. */
#define _GNU_SOURCE /* for fopencookie */
#include "app/output.h"

#include "base/file_io.h"
#include "base/path.h"
#include "case/study.h"
#include "run/problem_parts.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PART 4096     /* a pipe with any room takes this many bytes at once (PIPE_BUF) */
#define GRACE_MS 3000 /* total time for a slow reader, after a request to stop */

int hf_output_write(int file, const char *text, size_t n)
{
    static bool gave_up;
    for (size_t part; n > 0; text += part, n -= part) {
        part = n < PART ? n : PART;
        if (!hf_file_io_await_room(file, gave_up ? 0 : GRACE_MS)) {
            gave_up = true;
            errno = EINTR;
            return -1;
        }
        if (hf_file_io_write(file, text, part) != 0) return -1;
    }
    return 0;
}

hf_status hf_output_check(const hf_options *o, const hf_problem *problem, const char *table, const char *path,
                          hf_messages *messages)
{
    if (!path) return HF_OK;
    HF_TRY(hf_problem_spare_inputs(problem, table, path, messages));
    HF_TRY(hf_file_out_spare(o->result, "an input of this run", path, messages));
    HF_TRY(hf_export_claim_file(path, o->force, messages));
    return hf_file_out_try(path, messages);
}

bool hf_output_has_colour(int file)
{
    const char *none = getenv("NO_COLOR"), *term = getenv("TERM");
    return isatty(file) && !(none && *none) && term && strcmp(term, "dumb") != 0;
}

/* Writes for fopencookie; returns 0 after a failure. */
static ssize_t take(void *unused, const char *text, size_t n)
{
    (void)unused;
    return hf_output_write(STDOUT_FILENO, text, n) == 0 ? (ssize_t)n : 0;
}

FILE *hf_output_stream(void)
{
    FILE *stream = fopencookie(NULL, "w", (cookie_io_functions_t){.write = take});
    if (stream && isatty(STDOUT_FILENO)) setvbuf(stream, NULL, _IOLBF, BUFSIZ);
    return stream ? stream : stdout;
}

hf_status hf_output_refuse_case(const char *file, hf_messages *messages)
{
    const char *ending = hf_path_ending(file);
    if (strcmp(ending, ".yaml") != 0 && strcmp(ending, ".yml") != 0) return HF_OK;
    bool is_study = hf_study_is(file);
    return hf_error(messages, HF_IO,
                    "%s: this file is not a result file (HDF5) but a %s. To check this file, use `hifdm check %s`. To "
                    "compute a result, use `hifdm %s %s`",
                    file, is_study ? "study" : "case", file, is_study ? "merge" : "run", file);
}
