/* `hifdm report` shows a result, two of them side by side, or a merged study as one HTML page. */
#include "app/output.h"

#include "out/report.h"

static hf_status command_report(const hf_options *o, FILE *file, hf_messages *messages)
{
    const hf_export_request request = {.file = o->file, .output = o->output, .force = o->force, .said = file};
    HF_TRY(hf_output_refuse_case(o->file, messages));
    if (o->second) HF_TRY(hf_output_refuse_case(o->second, messages));
    return hf_report(&request, o->second, messages);
}

const hf_command hf_cmd_report = {
    .name = "report",
    .argument = "FILE [OTHER]",
    .help = "write an HTML page with the net, histories, tensions and summary of a result",
    .about = "The HTML page is a single file that any browser can open offline. With a second result, the page "
             "compares the cases, summaries and cable tensions of the two results.",
    .examples = "hifdm report chen2022.h5 -o chen2022.html\n"
                "hifdm report monday.h5 tuesday.h5 -o both.html",
    .reads_results = true,
    .run = command_report,
};
