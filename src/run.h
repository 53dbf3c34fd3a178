/* run - the visible loop: case -> scene -> model -> form-finding -> (ask -> batch -> tell -> store)* -> file. */
#ifndef HIFDM_RUN_H
#define HIFDM_RUN_H

#include "options.h"
#include <hifdm/model.h>
#include <hifdm/summary.h>

#define HF_OUTPUT_SIZE 4096

/* Run the case of the options and store it. `output` is the path of the result file, "" when none was written.
 * HF_OK, or the status of what went wrong with messages; HF_NOT_CONVERGED and HF_NO_FEASIBLE still write the file. */
hf_status hf_run(const hf_options *options, int argc, char *const *argv, hf_summary *summary,
                 char output[HF_OUTPUT_SIZE], hf_messages *messages);

/* Fill in what the case and the model say. */
void hf_run_describe(const hf_case *settings, const hf_model *model, hf_summary *summary);

/* Turn an ill-posed or unconverged form-finding into messages that name cables or chains. Returns result->status. */
hf_status hf_run_explain(const hf_scene *scene, const hf_model *model, const hf_form_settings *form,
                         hf_workspace *workspace, const hf_form_result *result, hf_messages *messages);

/* Not even --force lets a result replace what it is made from: the case, its net, a table (may be NULL). */
hf_status hf_run_spare_inputs(const hf_case *settings, const char *table, const char *output, hf_messages *messages);

double hf_run_clock_s(void);

#endif
