/* problem_explain - what went wrong in a form-finding, by the names of its cables, nodes and chains. */
#ifndef HIFDM_PROBLEM_EXPLAIN_H
#define HIFDM_PROBLEM_EXPLAIN_H

#include <hifdm/problem.h>

/* Explain problem->form, of the form-finding in the problem's workspace: warnings by hf_problem_warn, or an error that
 * names cables, nodes or chains. Returns problem->form.status. */
hf_status hf_problem_explain(hf_problem *problem, hf_messages *messages);

/* Warnings about a shape that was found: no equilibrium yet, loaded straight chains, slack cables, all by name. */
void hf_problem_warn(const hf_problem *problem, const char *stage, hf_workspace *workspace,
                     const hf_form_result *result, hf_messages *messages);

#endif
