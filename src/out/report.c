/* Chooses the name of the page, and the kind of page by the kind of file. */
#include "out/report.h"

#include "base/path.h"
#include "out/merged.h"
#include "out/print.h"

#include <string.h>
#include <sys/stat.h>

/* Sets the path of the page: that of -o, or the name of the file with the ending .html in the current folder. Two files
 * give both names, A_B.html. The path of the file itself is refused. */
static hf_status choose_output(const hf_export_request *o, const char *other, char output[PATH_MAX],
                               hf_messages *messages)
{
    char page[PATH_MAX], part[PATH_MAX] = "";
    const char *name = other ? hf_path_name(other) : "";
    bool fits = hf_path_choose(o->output, o->file, ".html", page, PATH_MAX);
    if (other && !o->output)
        fits = fits && snprintf(part, PATH_MAX, "_%.*s", (int)(hf_path_ending(name) - name), name) < PATH_MAX;
    if (!fits || (*part ? !hf_path_insert(page, part, output, PATH_MAX) : !strcpy(output, page)))
        return hf_error(messages, HF_IO, "%s: the path is too long", o->output ? o->output : hf_path_name(o->file));
    return hf_export_claim(o, output, messages);
}

hf_status hf_report(const hf_export_request *request, const char *other, hf_messages *messages)
{
    char output[PATH_MAX];
    struct stat info = {0};
    HF_TRY(choose_output(request, other, output, messages));
    HF_TRY(hf_file_out_spare(other, "the result to compare with", output, messages));
    if (other && (hf_merged_is(request->file) || hf_merged_is(other)))
        return hf_error(messages, HF_BAD_USAGE, "%s is a merged study, but hifdm report compares only two results",
                        hf_merged_is(other) ? other : request->file);
    if (hf_merged_is(request->file))
        HF_TRY(hf_report_study(request->file, output, messages));
    else
        HF_TRY(hf_report_result(request->file, other, NULL, output, messages));
    if (stat(output, &info) == 0)
        hf_print_line(request->said, "%s%s%s: report in %s (%.0f kB)", request->file, other ? " and " : "",
                      other ? other : "", output, (double)info.st_size / 1000);
    return HF_OK;
}
