/* problem_nets - the nets as built that the goals of a problem are over. */
#ifndef HIFDM_PROBLEM_NETS_H
#define HIFDM_PROBLEM_NETS_H

#include <hifdm/problem.h>

/* Make problem->nets, if some goal is over states or samples; scene, model, truss and states are there. HF_OK;
 * HF_BAD_CASE where cables cannot be cut, or errors mean nothing; HF_NO_MEMORY. */
hf_status hf_problem_nets_make(hf_problem *problem, hf_messages *messages);
void hf_problem_nets_free(hf_problem *problem);

/* What goals see; NULL where none is over nets. */
const hf_goals_nets *hf_problem_nets_of(const hf_problem *problem);

#endif
