/* Defines the functions that the exporters share. */
#include "out/export.h"

#include "base/csv.h"
#include "base/file_out.h"
#include "base/path.h"
#include "base/text.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

hf_status hf_export_claim(const hf_export_request *o, const char *path, hf_messages *messages)
{
    HF_TRY(hf_file_out_spare(o->file, "the result itself", path, messages));
    return hf_export_claim_file(path, o->force, messages);
}

hf_status hf_export_claim_part(const hf_export_request *o, const char *name, char path[PATH_MAX], hf_messages *messages)
{
    bool fits = o->is_folder ? snprintf(path, PATH_MAX, "%s/%s", o->output, name) < PATH_MAX
                             : hf_path_insert(o->output, name, path, PATH_MAX);
    if (!fits) return hf_error(messages, HF_IO, "%s: the path is too long", o->output);
    return hf_export_claim(o, path, messages);
}

hf_status hf_export_files(const hf_export_request *o, hf_export_file *file, int n, const void *context,
                          hf_messages *messages)
{
    for (int i = 0; i < n; i++)
        if (file[i].write) HF_TRY(hf_export_claim_part(o, file[i].name, file[i].path, messages));
    if (o->is_folder) HF_TRY(hf_file_out_folder(o->output, messages));
    for (int i = 0; i < n; i++)
        if (file[i].write) HF_TRY(hf_file_out_set_write(o->files, file[i].path, file[i].write, context, messages));
    return HF_OK;
}

hf_status hf_export_claim_file(const char *path, bool force, hf_messages *messages)
{
    char target[HF_FILE_OUT_SIZE];
    struct stat info;
    HF_TRY(hf_file_out_target(path, target, messages));
    hf_file_out_clean(target); /* temporary files of ended processes, also when the name is refused below */
    int seen = hf_path_look_at_link(target, &info);
    if (seen < 0) return hf_error(messages, HF_IO, "%s: cannot get the status of this file: %s", path, strerror(errno));
    if (seen == 0) return HF_OK;
    if (!S_ISREG(info.st_mode))
        return hf_error(messages, HF_IO, "%s: this is not a regular file. Choose another name", path);
    return force ? HF_OK : hf_error(messages, HF_EXISTS, "the file %s already exists. Use --force to replace it", path);
}

static const char *const shape_word[3] = {"form-finding", "search", "refinement"};

/* Checks that the result has the load case. Messages call the shape by the name of the load case. */
static hf_status find_load_case(const hf_export_request *o, hf_export_stored *stored, hf_messages *messages)
{
    const hf_summary *s = &stored->summary;
    char known[512] = "";
    int k = 0;
    for (; k < s->n_load_case && strcmp(o->load_case, s->load_case[k].name) != 0; k++)
        hf_text_append(known, sizeof known, ", ", s->load_case[k].name, "");
    if (s->n_load_case == 0) return hf_error(messages, HF_BAD_USAGE, "%s: this run has no load cases", o->file);
    if (k == s->n_load_case)
        return hf_error(messages, HF_BAD_USAGE,
                        "%s: this result has no load case '%s'. The load cases of this result are %s", o->file,
                        o->load_case, known);
    stored->word = s->load_case[k].name;
    return HF_OK;
}

hf_status hf_export_read(const hf_export_request *o, hf_export_extent extent, hf_export_stored *stored,
                         hf_messages *messages)
{
    hf_summary *summary = &stored->summary;
    HF_TRY(hf_store_read_summary(o->file, summary, messages));
    hf_stage result = hf_store_result_stage(summary);
    stored->stage = result;
    for (int i = 0; o->stage && i < HF_N_STAGE; i++)
        if (!strcmp(o->stage, hf_stage_word[i])) stored->stage = (hf_stage)i;
    stored->word = shape_word[stored->stage];
    if (o->load_case) HF_TRY(find_load_case(o, stored, messages));
    if (extent == HF_EXPORT_SHAPE && !o->load_case && !hf_summary_has_shape(summary, stored->stage))
        return hf_error(messages, HF_BAD_USAGE, "%s: this run has no %s shape. Use --stage %s", o->file, stored->word,
                        hf_stage_word[result]);
    if (extent >= HF_EXPORT_SCENE) HF_TRY(hf_store_read_scene(o->file, &stored->scene, messages));
    if (extent >= HF_EXPORT_SCENE && summary->surface.focal_length_m > 0 &&
        hf_facets_find(&stored->scene, &summary->surface, &stored->facets) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "%s: out of memory for the facets of this net", o->file);
    if (extent < HF_EXPORT_SHAPE) return HF_OK;
    return o->load_case ? hf_store_read_load_case(o->file, o->load_case, &stored->shape, messages)
                        : hf_store_read_shape(o->file, stored->stage, &stored->shape, messages);
}

bool hf_export_has_truss(const hf_export_request *o, const hf_summary *s, hf_messages *messages)
{
    if (s->has_truss && !s->finished)
        hf_warning(messages,
                   "%s: the export has no truss, because this run is unfinished and hifdm stores the truss at the end "
                   "of a run",
                   o->file);
    return s->has_truss && s->finished;
}

hf_status hf_export_read_truss(const char *file, const char *load_case, hf_truss *truss, hf_carrier_state *state,
                               hf_messages *messages)
{
    HF_TRY(hf_store_read_truss(file, truss, state, messages));
    if (!load_case) return HF_OK;
    hf_carrier_state_free(state);
    return hf_store_read_load_case_truss(file, load_case, truss, state, messages);
}

void hf_export_warn_of_shape(const char *file, const hf_summary *s, bool is_load_case, hf_messages *messages)
{
    if (!s->finished && !is_load_case)
        hf_warning(messages,
                   "%s: this run is unfinished, so the exported shape is that of the %s. Run the same command again to "
                   "resume the run",
                   file, shape_word[hf_store_result_stage(s)]);
    int point = s->front ? hf_front_suggested(s->front) : 0;
    bool is_end = !is_load_case && hf_store_result_stage(s) != HF_STAGE_FORM;
    if (!point) return;
    hf_warning(messages,
               "%s: no point of the Pareto front is selected, so hifdm uses %s%s. To compute the result of point %d, "
               "run `hifdm run %s --point %s:%d -o point%d.h5` with the --set options of the front",
               file,
               is_end ? "the end of the front with the minimum " : "the shape after form-finding, before optimisation",
               is_end ? s->objectives.name[0] : "", point, s->case_path, file, point, point);
}

void hf_export_free(hf_export_stored *stored)
{
    hf_shape_free(&stored->shape);
    hf_facets_free(&stored->facets);
    hf_scene_free(&stored->scene);
    hf_summary_free(&stored->summary);
}

void hf_export_ends(const char *id, const char *const *node_id, const int end[2], FILE *f)
{
    hf_csv_write_id(id, f);
    for (int k = 0; k < 2; k++) {
        fputc(',', f);
        hf_csv_write_id(node_id[end[k]], f);
    }
}

void hf_export_sets_of(const hf_scene *s, int e, FILE *f)
{
    const char *gap = "";
    if (s->n_set) fputc(',', f);
    for (int k = 0; k < s->n_set; k++) {
        if (!hf_cable_set_has(s, k, e)) continue;
        fprintf(f, "%s%s", gap, s->set_name[k]);
        gap = " ";
    }
}
