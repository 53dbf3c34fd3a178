/* progress - shows the progress of a run to people, and to programs that watch it. */
#pragma once

#include <hifdm/run.h>

#include <stdbool.h>
#include <stdio.h>

typedef enum {
    HF_PROGRESS_AUTO, /* LINE on a terminal, LOG elsewhere */
    HF_PROGRESS_NONE,
    HF_PROGRESS_LINE, /* one line on a terminal, rewritten at most ten times a second */
    HF_PROGRESS_LOG,  /* one line every 30 s; shorter runs print nothing */
    HF_PROGRESS_JSONL /* one JSON object per line: when a phase begins, every second, and when it ends */
} hf_progress_mode;

extern const char *const hf_progress_word[6]; /* indexed by hf_progress_mode, NULL at the end */

typedef struct {
    FILE *file;
    hf_progress_mode mode; /* never HF_PROGRESS_AUTO */
    double last_s;         /* time of the last line, since the phase began */
    bool is_shown;         /* true if the terminal shows a line that hf_progress_end must clear */
} hf_progress;

/* Returns a progress that writes to `file`. AUTO becomes LINE or LOG. */
hf_progress hf_progress_on(FILE *file, hf_progress_mode mode);

/* Prints the progress of a run. It is an hf_run_observer whose context is an hf_progress. */
void hf_progress_show(void *progress, const hf_run_progress *now);

/* Clears the line on the terminal, if there is one. */
void hf_progress_end(hf_progress *progress);
