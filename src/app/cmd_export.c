/* `hifdm export` writes a result in the formats of the table of exporters (out/export.h). */
#include "app/cmd.h"

#include "app/options.h"
#include "out/print.h"

#include <unistd.h>

/* Writes the list of options, "--csv DIR, --vtk DIR or --cutlist FILE", into text. */
static void list_exporters(char *text, size_t size)
{
    size_t used = 0;
    *text = '\0';
    for (int i = 0; i < HF_N_EXPORTER && used < size; i++) {
        const hf_exporter *e = hf_exporter_table[i];
        const char *gap = i == 0 ? "" : i == HF_N_EXPORTER - 1 ? " or " : ", ";
        used += (size_t)snprintf(text + used, size - used, "%s%s %s", gap, e->option, e->argument);
    }
}

/* Checks that at least one format is requested, and that --stage and --load-case suit the formats. Returns HF_OK or
 * HF_BAD_USAGE. */
static hf_status check_request(const hf_options *o, hf_messages *messages)
{
    char list[512];
    const hf_exporter *every_shape = NULL;
    int n_asked = 0, n_one_shape = 0;
    for (int i = 0; i < HF_N_EXPORTER; i++) {
        if (!o->export_to[i]) continue;
        n_asked++;
        if (hf_exporter_table[i]->takes_stage)
            n_one_shape++;
        else
            every_shape = hf_exporter_table[i];
    }
    list_exporters(list, sizeof list);
    if (n_asked == 0) return hf_error(messages, HF_BAD_USAGE, "'hifdm export' needs %s", list);
    if (o->stage && o->load_case) return hf_error(messages, HF_BAD_USAGE, "--stage and --load-case exclude each other");
    for (int i = 0; i < HF_N_EXPORTER; i++)
        if (o->load_case && o->export_to[i] && !hf_exporter_table[i]->takes_case)
            return hf_error(messages, HF_BAD_USAGE, "--load-case does not go with %s, %s", hf_exporter_table[i]->option,
                            hf_exporter_table[i]->takes_stage ? "which is of the design that all load cases are made of"
                                                              : "which writes every shape");
    if (o->stage && n_one_shape == 0)
        return hf_error(messages, HF_BAD_USAGE, "--stage does not go with %s alone, which writes every shape",
                        every_shape->option);
    return HF_OK;
}

/* Warns once if the shape of a result with a front is none of its designs, whatever formats are requested. A format
 * that writes every shape also writes their names. */
static void warn_of_front(const hf_options *o, hf_messages *messages)
{
    static hf_summary summary;
    hf_messages unwanted = {0};
    bool has_one_shape = false;
    for (int i = 0; i < HF_N_EXPORTER; i++)
        has_one_shape |= o->export_to[i] && hf_exporter_table[i]->takes_stage;
    if (!has_one_shape || o->stage) return;
    if (hf_store_read_summary(o->file, &summary, &unwanted) == HF_OK)
        hf_export_warn_of_front(o->file, &summary, o->load_case, messages);
    hf_summary_free(&summary);
    hf_messages_free(&unwanted);
}

static hf_status command_export(const hf_options *o, FILE *file, hf_messages *messages)
{
    static char said[HF_N_EXPORTER][HF_EXPORT_SAID_SIZE];
    static hf_file_out_set files;
    HF_TRY(check_request(o, messages));
    hf_status status = HF_OK;
    bool is_new[HF_N_EXPORTER];
    for (int i = 0; i < HF_N_EXPORTER; i++)
        is_new[i] = o->export_to[i] && access(o->export_to[i], F_OK) != 0;
    for (int i = 0; i < HF_N_EXPORTER && status == HF_OK; i++) {
        const hf_export_request request = {o->file, o->export_to[i], o->stage, o->load_case, o->force, &files};
        if (o->export_to[i]) status = hf_exporter_table[i]->write(&request, said[i], sizeof said[i], messages);
    }
    status = hf_file_out_set_end(&files, status, messages);
    for (int i = 0; i < HF_N_EXPORTER && status != HF_OK; i++)
        if (is_new[i]) rmdir(o->export_to[i]); /* a folder that was made for files that failed */
    HF_TRY(status);
    warn_of_front(o, messages);
    for (int i = 0; i < HF_N_EXPORTER; i++)
        if (o->export_to[i]) hf_print_line(file, "%s", said[i]);
    return HF_OK;
}

const hf_command hf_cmd_export = {
    .name = "export",
    .argument = "FILE",
    .help = "write a result as CSV files, for ParaView, or as a cut list",
    .about = "Numbers have 17 significant digits: read back they are the stored ones, bit by bit.",
    .examples = "hifdm export chen2022.h5 --csv best\n"
                "hifdm export chen2022.h5 --csv found --stage form\n"
                "hifdm export night.h5 --csv cold --load-case cold\n"
                "hifdm export chen2022.h5 --vtk shapes --cutlist cut.csv",
    .reads_results = true,
    .run = command_export,
};
