/* `hifdm tolerance` runs a case with a section tolerance, as a whole or as one task of several. */
#include "app/cmd_run.h"

const hf_command hf_cmd_tolerance = {
    .name = "tolerance",
    .argument = "CASE",
    .help = "compute samples of the as-built net with the errors in section tolerance",
    .about =
        "This command works like hifdm run, for a case with a section tolerance. The shape of the result gives the "
        "cut lengths of the cables. hifdm solves the net again with errors of lengths, stiffness, supports and "
        "temperature. The tasks of a job array share the samples, and each task stores its own beside FILE. The same "
        "command without --task combines these samples. The result is bit-identical to that of one run.",
    .examples = "hifdm tolerance case.yaml -o case.h5\n"
                "hifdm tolerance case.yaml -o case.h5 --task 3 --tasks 16\n"
                "hifdm tolerance case.yaml -o case.h5 --tasks 16",
    .uses_threads = true,
    .run = hf_cmd_run_case,
};
