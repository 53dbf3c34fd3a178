/* built_design - makes the as-built net of a case, at the shape of its form-finding or of a result. */
#pragma once

#include "app/options.h"
#include <hifdm/built.h>
#include <hifdm/problem.h>

/* Makes the as-built net at the shape of options->stage of options->result, or of the form-finding if result is NULL. A
 * case with a section optimize then needs --stage form. The problem must be loaded; its workspace holds the design
 * afterwards. Returns HF_OK, HF_BAD_USAGE, HF_BAD_CASE for a result of another net or truss, HF_IO, HF_NO_MEMORY, or
 * the status of a form-finding that failed. Free `built` in any case. */
hf_status hf_built_design_make(const hf_options *options, hf_problem *problem, hf_built *built, hf_messages *messages);

/* Checks that the command line determines the design that was built. Returns HF_OK or HF_BAD_USAGE. */
hf_status hf_built_design_check(const hf_options *options, const hf_case *settings, hf_messages *messages);
