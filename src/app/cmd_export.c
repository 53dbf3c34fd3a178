/* `hifdm export` writes a result in the formats of the table of exporters (out/export.h). */
#include "app/options.h"

#include "base/text.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Checks that at least one format is requested, and that --stage and --load-case suit the formats. Finds how much of
 * the result the formats read, and whether one of them writes one shape. Returns HF_OK or HF_BAD_USAGE. */
static hf_status check_request(const hf_options *o, hf_export_extent *extent, bool *has_one_shape,
                               hf_messages *messages)
{
    char list[512] = "", item[64]; /* "--csv DIR, --vtk DIR or --cutlist FILE" */
    const hf_exporter *every_shape = NULL;
    *extent = HF_EXPORT_SUMMARY;
    *has_one_shape = false;
    for (int i = 0; i < HF_N_EXPORTER; i++) {
        const hf_exporter *e = hf_exporter_table[i];
        snprintf(item, sizeof item, "%s %s", e->option, e->argument);
        hf_text_append(list, sizeof list, i == HF_N_EXPORTER - 1 ? " or " : ", ", item, "");
        if (!o->export_to[i]) continue;
        if (e->reads > *extent) *extent = e->reads;
        *has_one_shape |= e->takes_stage;
        if (!e->takes_stage) every_shape = e;
    }
    if (!*has_one_shape && !every_shape) return hf_error(messages, HF_BAD_USAGE, "'hifdm export' needs %s", list);
    if (o->stage && o->load_case)
        return hf_error(messages, HF_BAD_USAGE, "the options --stage and --load-case cannot be combined");
    for (int i = 0; i < HF_N_EXPORTER; i++)
        if (o->load_case && o->export_to[i] && !hf_exporter_table[i]->takes_case)
            return hf_error(messages, HF_BAD_USAGE,
                            "the option --load-case cannot be combined with %s, because that option %s",
                            hf_exporter_table[i]->option,
                            hf_exporter_table[i]->takes_stage ? "exports the design that all load cases share"
                                                              : "exports all shapes");
    if (o->stage && !*has_one_shape)
        return hf_error(messages, HF_BAD_USAGE,
                        "the option --stage cannot be combined with %s alone, because that option exports all shapes",
                        every_shape->option);
    return HF_OK;
}

static hf_status command_export(const hf_options *o, FILE *file, hf_messages *messages)
{
    static hf_export_stored stored;
    static hf_file_out_set files;
    char *said = NULL;
    size_t size;
    hf_export_extent extent;
    bool is_new[HF_N_EXPORTER], has_one_shape;
    HF_TRY(check_request(o, &extent, &has_one_shape, messages));
    hf_export_request request = {.file = o->file,
                                 .stage = o->stage,
                                 .load_case = o->load_case,
                                 .force = o->force,
                                 .files = &files,
                                 .said = open_memstream(&said, &size)};
    if (!request.said) return hf_error(messages, HF_NO_MEMORY, "out of memory");
    for (int i = 0; i < HF_N_EXPORTER; i++)
        is_new[i] = o->export_to[i] && access(o->export_to[i], F_OK) != 0;
    hf_status status = hf_export_read(&request, extent, &stored, messages);
    for (int i = 0; i < HF_N_EXPORTER && status == HF_OK; i++) {
        const hf_exporter *e = hf_exporter_table[i];
        request.output = o->export_to[i];
        request.is_folder = !strcmp(e->argument, "DIR");
        if (request.output) status = e->write(&request, &stored, messages);
    }
    status = hf_file_out_set_end(&files, status, messages);
    fclose(request.said);
    if (status == HF_OK) fputs(said, file);
    free(said);
    for (int i = 0; i < HF_N_EXPORTER && status != HF_OK; i++)
        if (is_new[i]) rmdir(o->export_to[i]); /* a folder that was made for files that failed */
    /* A format that writes every shape also writes their names. */
    if (status == HF_OK && has_one_shape && !o->stage)
        hf_export_warn_of_shape(o->file, &stored.summary, o->load_case, messages);
    hf_export_free(&stored);
    return status;
}

const hf_command hf_cmd_export = {
    .name = "export",
    .argument = "FILE",
    .help = "export a result as CSV files, as VTK files for ParaView, or as a cut list",
    .about = "hifdm export writes numbers with 17 significant digits, except in rounded files such as cut_mm.csv, so a "
             "program reads exactly the stored values.",
    .examples = "hifdm export chen2022.h5 --csv best\n"
                "hifdm export chen2022.h5 --csv found --stage form\n"
                "hifdm export night.h5 --csv cold --load-case cold\n"
                "hifdm export chen2022.h5 --vtk shapes --cutlist cut.csv",
    .reads_results = true,
    .run = command_export,
};
