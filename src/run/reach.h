/* reach - what the variables of a case cannot change: goals, limits, and rows of variables that change nothing. */
#ifndef HIFDM_REACH_H
#define HIFDM_REACH_H

#include <hifdm/problem.h>

/* Of a problem with its base design, whose case has rows. A row of goals or limits that looks at nothing that any
 * variable moves, and a row of variables that moves nothing, has a warning with its place; HF_BAD_CASE with errors
 * where that leaves an objective, or the only goals, as they are. Nothing is known, and said, of designs without
 * derivatives, nor where the base has no shape. HF_OK, HF_BAD_CASE or HF_NO_MEMORY. */
hf_status hf_reach_check(const hf_problem *problem, hf_messages *messages);

#endif
