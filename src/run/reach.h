/* reach - finds objectives and limits that the variables of a case cannot change, and rows of variables that change
 * nothing. */
#ifndef HIFDM_REACH_H
#define HIFDM_REACH_H

#include <hifdm/problem.h>

/* Checks a problem with its initial design. It warns about a row of objectives or limits that no variable changes, and
 * about a row of variables that changes nothing, with their locations. Returns HF_BAD_CASE, with errors, if an
 * objective of a front or all objectives are constant for that reason. It checks ranges alone if designs have no
 * derivatives, and reports nothing more if the initial design has no shape. Returns HF_OK, HF_BAD_CASE or
 * HF_NO_MEMORY. */
hf_status hf_reach_check(const hf_problem *problem, hf_messages *messages);

#endif
