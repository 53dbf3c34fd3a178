/* problem_nets - the as-built nets over which a problem has objectives. */
#pragma once

#include <hifdm/problem.h>

/* Makes problem->nets if an objective is over load cases or samples. Scene, model, truss and load cases must exist.
 * Returns HF_OK; HF_BAD_CASE if the cables cannot be cut or the errors of tolerance are not valid; HF_NO_MEMORY. */
hf_status hf_problem_nets_make(hf_problem *problem, hf_messages *messages);
void hf_problem_nets_free(hf_problem *problem);

/* Returns the nets for hf_objectives_create, or NULL if no objective is over nets. */
const hf_objectives_nets *hf_problem_nets_of(const hf_problem *problem);

/* Returns the constraints that the rows of `requirements` set on designs, or NULL. */
const hf_constraints *hf_problem_constraints_of(const hf_problem *problem);

/* Returns true if this row of `requirements` constrains designs. */
bool hf_problem_is_constrained_by(const hf_problem *problem, int row);

/* Writes the row of a constraint, such as "requirements.2 (tension of tie)". Returns text. */
const char *hf_problem_constraint_name(const hf_problem *problem, int i_constraint, char *text, size_t size);

/* Writes which requirement the design judged last in problem->point breaks most, as the end of a sentence, such as
 * ": bound of requirements.2 (tension of tie) is missed by 0.62 N". Writes "" if it breaks none. Returns text. */
const char *hf_problem_broken_requirement(const hf_problem *problem, char *text, size_t size);
