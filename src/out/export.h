/* export - a stored result in formats of other programs. The file export_NAME.c holds the exporter NAME: its row and
 * what it writes. A new exporter is such a file and its name in HF_EXPORTERS; the row makes the option of `hifdm
 * export`, its help and its dispatch. */
#ifndef HIFDM_EXPORT_H
#define HIFDM_EXPORT_H

#include <hifdm/store.h>
#include <stdbool.h>

#define HF_EXPORT_SAID_SIZE 4096 /* room for the line that an exporter says */

/* What is to be written from which result. */
typedef struct {
    const char *file;   /* the result */
    const char *output; /* the file or folder to write, by exporter */
    const char *stage;  /* a word of hf_stage_word, NULL: the result of the run */
    bool force;         /* replace existing files */
} hf_export_request;

typedef struct {
    const char *option;   /* "--csv" */
    const char *argument; /* DIR or FILE: what hf_export_request.output is */
    const char *help;
    bool takes_stage; /* writes one shape, which --stage chooses; else every shape of the run */
    /* Existing files are kept unless request->force, and all names are checked before anything is written. `said`: one
     * line for people on what was written. HF_EXISTS, HF_IO, HF_NO_MEMORY, HF_BAD_CASE, HF_BAD_USAGE with a message. */
    hf_status (*write)(const hf_export_request *request, char *said, size_t size, hf_messages *messages);
} hf_exporter;

/* In the order in which help lists them and a command line with several writes them. */
#define HF_EXPORTERS(X) X(csv) X(vtk) X(cutlist)

#define HF_EXPORTER_ROW(name) extern const hf_exporter hf_exporter_##name;
HF_EXPORTERS(HF_EXPORTER_ROW)
#undef HF_EXPORTER_ROW

#define HF_EXPORTER_INDEX(name) HF_EXPORTER_##name,
enum { HF_EXPORTERS(HF_EXPORTER_INDEX) HF_N_EXPORTER };
#undef HF_EXPORTER_INDEX

extern const hf_exporter *const hf_exporter_table[HF_N_EXPORTER];

/* ---- what exporters share ---- */

/* One shape of a result file, as request->stage asks or the result of the run, with its summary and scene. `word`: what
 * messages call the shape. Free scene and shape in any case. */
hf_status hf_export_read(const hf_export_request *request, hf_summary *summary, hf_scene *scene, hf_shape *shape,
                         const char **word, hf_messages *messages);

/* HF_EXISTS with a message when `path` is there and not `force`. */
hf_status hf_export_claim(const char *path, bool force, hf_messages *messages);

/* Make a folder unless it is there. HF_OK or HF_IO. */
hf_status hf_export_folder(const char *path, hf_messages *messages);

#endif
