/* `hifdm tolerance` runs a case with a section tolerance, as a whole or as one task of several. */
#include "app/cmd_run.h"

const hf_command hf_cmd_tolerance = {
    .name = "tolerance",
    .argument = "CASE",
    .help = "samples of the as-built net, with the errors of the section tolerance",
    .about =
        "As hifdm run, for a case with a section tolerance: the net is cut at the shape of the result, after an "
        "optimisation if there is one, and solved again with errors of lengths, stiffness, supports and temperature. "
        "Tasks of a job array share the samples: each keeps its own beside FILE, and the same command without --task "
        "puts them together, to the same bits as one run.",
    .examples = "hifdm tolerance case.yaml -o case.h5\n"
                "hifdm tolerance case.yaml -o case.h5 --task 3 --tasks 16\n"
                "hifdm tolerance case.yaml -o case.h5 --tasks 16",
    .uses_threads = true,
    .run = hf_cmd_run_case,
};
