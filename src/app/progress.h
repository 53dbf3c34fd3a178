/* progress - shows how far a run is, to people and to programs that watch it. */
#ifndef HIFDM_PROGRESS_H
#define HIFDM_PROGRESS_H

#include <hifdm/run.h>

#include <stdbool.h>
#include <stdio.h>

typedef enum {
    HF_PROGRESS_AUTO, /* LINE on a terminal, LOG elsewhere */
    HF_PROGRESS_NONE,
    HF_PROGRESS_LINE, /* one line on a terminal, rewritten up to ten times a second */
    HF_PROGRESS_LOG,  /* a line every HF_PROGRESS_LOG_S; shorter runs print nothing */
    HF_PROGRESS_JSONL /* one JSON object per line: when a phase begins, every second, and when it ends */
} hf_progress_mode;

extern const char *const hf_progress_word[6]; /* by hf_progress_mode, ended by NULL */

#define HF_PROGRESS_LOG_S 30.0 /* between two lines of HF_PROGRESS_LOG */

typedef struct {
    FILE *file;
    hf_progress_mode mode; /* not AUTO */
    double last_s;         /* when the last line of this phase was written */
    bool is_shown;         /* the terminal shows a line that hf_progress_end must clear */
} hf_progress;

/* Progress to be written to `file`; AUTO becomes LINE or LOG. */
hf_progress hf_progress_on(FILE *file, hf_progress_mode mode);

/* An hf_run_observer whose context is an hf_progress. */
void hf_progress_show(void *progress, const hf_run_progress *now);

/* Clears the line on the terminal, if there is one. */
void hf_progress_end(hf_progress *progress);

#endif
