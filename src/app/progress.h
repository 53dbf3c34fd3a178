/* progress - how far a run is, for people and for programs that watch it. */
#ifndef HIFDM_PROGRESS_H
#define HIFDM_PROGRESS_H

#include <hifdm/run.h>

#include <stdbool.h>
#include <stdio.h>

typedef enum {
    HF_PROGRESS_AUTO, /* LINE on a terminal, LOG elsewhere */
    HF_PROGRESS_NONE,
    HF_PROGRESS_LINE, /* one line that overwrites itself some ten times a second */
    HF_PROGRESS_LOG,  /* a line every HF_PROGRESS_LOG_S; nothing in shorter runs */
    HF_PROGRESS_JSONL /* a JSON object in a line at the beginning of each phase, every second, and at its end */
} hf_progress_mode;

extern const char *const hf_progress_word[6]; /* by hf_progress_mode, ended by NULL */

#define HF_PROGRESS_LOG_S 30.0

typedef struct {
    FILE *file;
    hf_progress_mode mode; /* not AUTO */
    double last_s;         /* when the last line of this phase was written */
    bool is_shown;         /* a line on the terminal must be cleared */
} hf_progress;

hf_progress hf_progress_on(FILE *file, hf_progress_mode mode);

/* An hf_run_observer with an hf_progress as its context. */
void hf_progress_show(void *progress, const hf_run_progress *now);
void hf_progress_end(hf_progress *progress);

#endif
