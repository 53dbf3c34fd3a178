/* built_design - the net that was built, of a case: made at the shape that its form-finding has, or at that of a
 * result. */
#ifndef HIFDM_BUILT_DESIGN_H
#define HIFDM_BUILT_DESIGN_H

#include "app/options.h"
#include <hifdm/built.h>
#include <hifdm/problem.h>

/* Make the net of options->result (NULL: of the form-finding, which a case with a section optimize has to be asked for
 * by --stage form) and options->stage. The problem is loaded; its workspace then holds the design. HF_OK; HF_BAD_USAGE;
 * HF_BAD_CASE for a result of another net or truss; HF_IO, HF_NO_MEMORY, or the status of a form-finding that failed.
 * Free `built` in any case. */
hf_status hf_built_design_make(const hf_options *options, hf_problem *problem, hf_built *built, hf_messages *messages);

/* Does the command line say which design was built? HF_OK or HF_BAD_USAGE. */
hf_status hf_built_design_check(const hf_options *options, const hf_case *settings, hf_messages *messages);

#endif
