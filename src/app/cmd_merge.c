/* `hifdm merge` collects the points of a study in one file. */
#include "app/study_files.h"

#include "out/print.h"
#include "run/requirements_stage.h"
#include "store/merge.h"

static hf_status command_merge(const hf_options *o, FILE *file, hf_messages *messages)
{
    char folder[HF_PATH_SIZE], output[HF_PATH_SIZE];
    static hf_study study;
    hf_points points;
    hf_status status = hf_study_files_read(o, true, folder, &study, &points, messages);
    if (status == HF_OK) status = hf_study_files_name(o->output, o->file, ".h5", output, messages);
    if (status == HF_OK && points.count[HF_POINT_OUTDATED] && !o->force)
        status = hf_error(messages, HF_EXISTS,
                          "%s: %d points are outdated, because the base case has changed since. Run 'hifdm sweep %s "
                          "--retry outdated' first, or use --force to merge without these points",
                          folder, points.count[HF_POINT_OUTDATED], o->file);
    if (status == HF_OK) status = hf_merge(&study, folder, &points, output, o->force, messages);
    if (status == HF_OK) hf_requirements_stage_doubt_points(&points, messages);
    if (status == HF_OK && !o->quiet)
        hf_print_line(file, "%s: %d points, %d of them done, %d failed", output, points.n_point,
                      points.count[HF_POINT_DONE], points.count[HF_POINT_FAILED]);
    hf_points_free(&points);
    hf_study_free(&study);
    return status;
}

const hf_command hf_cmd_merge = {
    .name = "merge",
    .argument = "STUDY",
    .help = "write an HDF5 file with a table of all points of a sweep and links to their result files",
    .about = "You can run hifdm merge at any time after the sweep has started. Points without a result have the status "
             "not_evaluated in the table.",
    .examples = "hifdm merge study.yaml -o study.h5\n"
                "hifdm report study.h5",
    .run = command_merge,
};
