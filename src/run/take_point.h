/* take_point - makes a point of a front the result of a run, instead of a search. */
#pragma once

#include <hifdm/population.h>
#include <hifdm/problem.h>
#include <hifdm/result.h>

typedef struct {
    double *design;                            /* [n_variable]; NULL: no point is taken. The caller frees it. */
    double objective[HF_FRONT_OBJECTIVES_MAX]; /* values of the objectives in the front */
    double largest[HF_FRONT_OBJECTIVES_MAX]; /* maximum size of each objective over the front and its initial design */
} hf_taken_point;

/* Reads "FILE:N": point N of the front in the result FILE, which must have the objectives and variables of the problem.
 * The settings of the problem receive its origin. Returns HF_OK; HF_BAD_USAGE, HF_BAD_CASE, HF_IO or HF_NO_MEMORY with
 * a message. */
hf_status hf_take_point_read(const char *point, hf_problem *problem, hf_taken_point *taken, hf_messages *messages);

/* Checks the evaluation `found` of the point. Returns HF_OK; HF_BAD_CASE, with a message, if an objective differs from
 * the front or the design violates the bounds, because the point then belongs to another case; HF_NO_MEMORY. */
hf_status hf_take_point_check(const hf_problem *problem, const hf_taken_point *taken, const hf_population *bounds,
                              const hf_form_result *found, hf_messages *messages);
