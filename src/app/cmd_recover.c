/* `hifdm recover` adds the generations in the journal of an unfinished result to the result file. It does not resume
 * the run. */
#include "app/options.h"

#include <hifdm/store.h>

static hf_status command_recover(const hf_options *o, FILE *file, hf_messages *messages)
{
    static hf_summary summary;
    HF_TRY(hf_store_recover(o->file, &summary, messages));
    hf_summary_free(&summary);
    return hf_cmd_show.run(o, file, messages);
}

const hf_command hf_cmd_recover = {
    .name = "recover",
    .argument = "FILE",
    .help = "add the generations of the journal FILE.journal to an unfinished result",
    .about = "If a run was killed, use this command to complete its result file without resuming the run. If you "
             "resume the run, hifdm run adds the generations automatically.",
    .examples = "hifdm recover night.h5",
    .reads_results = true,
    .run = command_recover,
};
