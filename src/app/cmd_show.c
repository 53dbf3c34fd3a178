/* `hifdm show` prints the summary of a result file, or the table of a merged study. */
#include "app/output.h"

#include "out/print_study.h"
#include <hifdm/store.h>

#include <unistd.h>

static hf_status show_study(const hf_options *o, FILE *file, hf_messages *messages)
{
    static hf_merged merged; /* too large for a small stack, like the summary below */
    hf_status status = hf_merged_read(o->file, &merged, messages);
    if (status == HF_OK && o->json)
        hf_print_study_json(&merged, file);
    else if (status == HF_OK)
        hf_print_study(
            &merged, (hf_print_style){.verbose = o->verbose, .has_colour = hf_output_has_colour(STDOUT_FILENO)}, file);
    hf_merged_free(&merged);
    return status;
}

static hf_status command_show(const hf_options *o, FILE *file, hf_messages *messages)
{
    static hf_summary summary;
    HF_TRY(hf_output_refuse_case(o->file, messages));
    if (hf_merged_is(o->file)) return show_study(o, file, messages);
    HF_TRY(hf_store_read_summary(o->file, &summary, messages));
    if (o->json) {
        hf_summary_write_json(&summary, hf_summary_status(&summary), summary.warnings, o->file, file);
    } else {
        hf_print_summary(&summary, o->file,
                         (hf_print_style){.verbose = o->verbose, .has_colour = hf_output_has_colour(STDOUT_FILENO)},
                         file);
        hf_print_lines(summary.warnings, file);
    }
    hf_summary_free(&summary);
    return HF_OK;
}

const hf_command hf_cmd_show = {
    .name = "show",
    .argument = "FILE",
    .help = "print the summary of a result file, or the table of a merged study",
    .about = "The summary of a run begins with the result, continues with a row for each stage, and ends with the "
             "warnings. The --verbose option adds estimated position errors, conditions and backward errors, the "
             "tension ratios of cable sets, the objectives, the "
             "surface errors of every stage, and times.\nFor a merged study, hifdm show prints the axes, the values "
             "that all points share, and a table of the points. The best point is marked. With the --verbose option, "
             "hifdm show prints all points of a large study.",
    .examples = "hifdm show chen2022.h5\n"
                "hifdm show chen2022.h5 --verbose\n"
                "hifdm show chen2022.h5 --json\n"
                "hifdm show study.h5",
    .reads_results = true,
    .run = command_show,
};
