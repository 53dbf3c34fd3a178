/* progress - how far a run is, for people who wait. */
#ifndef HIFDM_PROGRESS_H
#define HIFDM_PROGRESS_H

#include "run.h"

#include <stdio.h>

typedef struct {
    FILE *file;    /* NULL: say nothing */
    double last_s; /* when something was said last */
    int is_shown;  /* a line is there that must be cleared */
} hf_progress;

/* Quiet, and where `file` is no terminal, nothing is said. */
hf_progress hf_progress_on(FILE *file, int quiet);

/* An hf_run_observer with an hf_progress as its context: one line that overwrites itself some ten times a second. */
void hf_progress_show(void *progress, const hf_run_progress *now);
void hf_progress_end(hf_progress *progress);

#endif
