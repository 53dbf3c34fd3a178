/* cmd_check_study - runs `hifdm check` of a study: it prints what `hifdm sweep` would do. */
#ifndef HIFDM_CMD_CHECK_STUDY_H
#define HIFDM_CMD_CHECK_STUDY_H

#include <hifdm/status.h>
#include <stdio.h>

typedef struct {
    const char *path, *name; /* path of the case; its name in messages */
    const char *const *set;  /* [n_set], "key=value" */
    int n_set, threads;
} hf_check_request;

/* Checks and tries a case (in cmd_check.c). *most_s receives the maximum time of a run, without the as-built nets of a
 * section `tolerance`. Returns HF_OK, HF_BAD_CASE with all faults, the status of an ill-posed scene, or that of another
 * failure. */
hf_status hf_check_case(const hf_check_request *request, double *most_s, FILE *file, hf_messages *messages);

/* Returns the time of n > 0 tasks of each_s, which run in parallel, each in one thread. *threads becomes the number of
 * threads with work. */
double hf_check_together_s(double each_s, int n, int *threads);

/* Checks a study; request->n_set must be 0. Returns HF_OK, HF_BAD_USAGE, HF_BAD_CASE with all faults of study, base
 * case and points, or HF_POINTS_FAILED if some points cannot be run. */
hf_status hf_check_study(const hf_check_request *request, FILE *file, hf_messages *messages);

#endif
