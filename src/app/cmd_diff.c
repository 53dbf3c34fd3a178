/* `hifdm diff` compares two result files, data set by data set. */
#include "app/options.h"

#include "out/print.h"
#include "store/compare.h"

static void tell_difference(void *context, const char *path, const char *how)
{
    hf_print_line(context, "%s%s", path, how);
}

static hf_status command_diff(const hf_options *o, FILE *file, hf_messages *messages)
{
    hf_comparison c = {.rtol = o->rtol, .atol = o->atol};
    hf_status status = hf_compare_files(o->file, o->second, &c, tell_difference, file, messages);
    if (status != HF_OK && status != HF_DIFFERENT) return status;
    fprintf(file, "%d data sets, %d differ; attributes (times, machine, provenance, summary) are not compared\n",
            c.n_data_set, c.n_different);
    return status;
}

const hf_command hf_cmd_diff = {
    .name = "diff",
    .argument = "A B",
    .help = "compare the data sets of two result files, ignoring times and provenance",
    .about = "Two runs of the same case with the same seed give bit-identical results. Neither the number of threads "
             "nor interruptions change the results. If the files differ, hifdm diff prints the first differences and "
             "exits with status 1.",
    .examples = "hifdm diff monday.h5 tuesday.h5\n"
                "hifdm diff mine.h5 yours.h5 --rtol 1e-9",
    .reads_results = true,
    .run = command_diff,
};
