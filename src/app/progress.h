/* progress - how far a run is, for people who wait and programs that watch. */
#ifndef HIFDM_PROGRESS_H
#define HIFDM_PROGRESS_H

#include <hifdm/run.h>

#include <stdio.h>

/* Their words are in options.c. */
typedef enum {
    HF_PROGRESS_AUTO, /* LINE on a terminal, LOG elsewhere */
    HF_PROGRESS_NONE,
    HF_PROGRESS_LINE, /* one line that overwrites itself some ten times a second */
    HF_PROGRESS_LOG,  /* a line every HF_PROGRESS_LOG_S, so that short runs say nothing */
    HF_PROGRESS_JSONL /* a JSON object in a line at the beginning of each phase, every second, and at its end */
} hf_progress_mode;

#define HF_PROGRESS_LOG_S 30.0

typedef struct {
    FILE *file;
    int mode;      /* hf_progress_mode, not AUTO */
    double last_s; /* when something was said last in this phase */
    int is_shown;  /* a line is there that must be cleared */
} hf_progress;

hf_progress hf_progress_on(FILE *file, int mode);

/* An hf_run_observer with an hf_progress as its context. */
void hf_progress_show(void *progress, const hf_run_progress *now);
void hf_progress_end(hf_progress *progress);

#endif
