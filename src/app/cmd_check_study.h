/* cmd_check_study - runs `hifdm check` of a study: it prints what `hifdm sweep` would do. */
#pragma once

#include "run/check.h"
#include <stdio.h>

/* Checks and tries a case, and prints what it finds (in cmd_check.c). *check must be zero on entry. Returns HF_OK,
 * HF_BAD_CASE with all faults, the status of an ill-posed scene, or that of another failure. Free
 * check->problem in any case. */
hf_status hf_cmd_check_case(const hf_check_request *request, const char *name, hf_check *check, FILE *file,
                            hf_messages *messages);

/* Checks a study; request->n_set must be 0. *check must be zero on entry, and receives the check of its first point.
 * Returns HF_OK, HF_BAD_USAGE, HF_BAD_CASE with all faults of study, base case and points, or HF_POINTS_FAILED if some
 * points cannot be run. Free check->problem in any case. */
hf_status hf_cmd_check_study(const hf_check_request *request, hf_check *check, FILE *file, hf_messages *messages);
