/* `hifdm show` prints the summary of a result file. */
#include "app/cmd.h"

#include "app/options.h"
#include "app/output.h"
#include "out/print.h"
#include <hifdm/store.h>

#include <unistd.h>

static hf_status command_show(const hf_options *o, FILE *file, hf_messages *messages)
{
    hf_summary summary;
    HF_TRY(hf_store_read_summary(o->file, &summary, messages));
    if (o->json) {
        hf_summary_write_json(&summary, summary.finished ? summary.status : summary.form.status, summary.warnings,
                              o->file, file);
    } else {
        hf_print_summary(&summary, o->file, (hf_print_style){o->verbose, hf_output_has_colour(STDOUT_FILENO)}, file);
        hf_print_lines(summary.warnings, file);
    }
    return HF_OK;
}

const hf_command hf_cmd_show = {
    .name = "show",
    .argument = "FILE",
    .help = "print the summary of a result file",
    .about = "The same lines that hifdm run printed when it was done, warnings last: the answer, then a row for each "
             "stage. With --verbose certificates, ratios of sets, goals, the surface of every stage, times.",
    .examples = "hifdm show chen2022.h5\n"
                "hifdm show chen2022.h5 --verbose\n"
                "hifdm show chen2022.h5 --json",
    .reads_results = true,
    .run = command_show,
};
