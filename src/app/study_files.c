/* Finds and reads the files of a study. study_files.h describes the interface. */
#include "app/study_files.h"

#include "base/path.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

hf_status hf_study_files_name(const char *given, const char *study, const char *ending, char name[HF_PATH_SIZE],
                              hf_messages *messages)
{
    if (!hf_path_choose(given, study, ending, name, HF_PATH_SIZE))
        return hf_error(messages, HF_IO, "%s: the path is longer than the maximum of %d bytes", given ? given : study,
                        HF_PATH_SIZE - 1);
    return *name ? HF_OK : hf_error(messages, HF_IO, "%s: the name of a file or folder is empty", study);
}

hf_status hf_study_files_read(const hf_options *o, bool demand_folder, char folder[HF_PATH_SIZE], hf_study *study,
                              hf_points *points, hf_messages *messages)
{
    *points = (hf_points){0};
    *study = (hf_study){0};
    HF_TRY(hf_study_files_name(o->folder, o->file, ".d", folder, messages));
    HF_TRY(hf_study_read(o->file, study, messages));
    if (demand_folder && access(folder, F_OK) != 0)
        return hf_error(
            messages, HF_IO,
            "%s: %s. Run 'hifdm sweep' to create the folder, or use the --dir option to select another folder", folder,
            errno == ENOENT ? "there is no such folder of results" : strerror(errno));
    return hf_ledger_read(folder, study, points, messages);
}
