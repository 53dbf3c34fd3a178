/* problem_explain - explains the result of a form-finding with the names of its cables, nodes and chains. */
#ifndef HIFDM_PROBLEM_EXPLAIN_H
#define HIFDM_PROBLEM_EXPLAIN_H

#include <hifdm/problem.h>

/* Explains problem->form, the result of the form-finding in the problem's workspace: warnings by hf_problem_warn, or an
 * error that names cables, nodes or chains. Returns problem->form.status. */
hf_status hf_problem_explain(hf_problem *problem, hf_messages *messages);

/* Warns about a shape that was found: not yet in equilibrium, loaded straight chains, loose, drifting or slack parts.
 * The messages give their names. `stage` names the shape in them. */
void hf_problem_warn(const hf_problem *problem, const char *stage, hf_workspace *workspace,
                     const hf_form_result *result, hf_messages *messages);

#endif
