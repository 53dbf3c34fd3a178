/* cmd_check_study - `hifdm check` of a study: what `hifdm sweep` would do. */
#ifndef HIFDM_CMD_CHECK_STUDY_H
#define HIFDM_CMD_CHECK_STUDY_H

#include <hifdm/status.h>
#include <stdio.h>

typedef struct {
    const char *path, *name; /* of the case; what it is called where it is told to be valid */
    const char *const *set;  /* [n_set] "key=value" */
    int n_set, threads;
} hf_check_request;

/* In cmd_check.c. Checks and tries a case, and tells how long a run of it may take at most (the nets as built of a
 * section `tolerance` left out): HF_OK, HF_BAD_CASE with all faults, an ill-posed status. */
hf_status hf_check_case(const hf_check_request *request, double *most_s, FILE *file, hf_messages *messages);

/* What n > 0 things of each_s take side by side, each in one thread; *threads becomes the number of those with work. */
double hf_check_together_s(double each_s, int n, int *threads);

/* The same of a study; request->n_set is 0. HF_BAD_CASE with all faults of study, base case and points. */
hf_status hf_check_study(const hf_check_request *request, FILE *file, hf_messages *messages);

#endif
