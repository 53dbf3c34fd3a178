/* export - writes a stored result in formats of other programs. The file export_NAME.c holds the exporter NAME: its row
 * and its function. A new exporter needs such a file and its name in HF_EXPORTERS; the option of `hifdm export`, its
 * help and the call of the exporter follow from the row. */
#ifndef HIFDM_EXPORT_H
#define HIFDM_EXPORT_H

#include "base/file_out.h"
#include <hifdm/store.h>

#include <limits.h>
#include <stdbool.h>

/* Room for the line in which an exporter says what it wrote: words, and at most five paths. */
#define HF_EXPORT_SAID_SIZE (5 * PATH_MAX + 256)

/* What to export, and where to. */
typedef struct {
    const char *file;       /* the result */
    const char *output;     /* the file or folder to write: hf_exporter.argument says which */
    const char *stage;      /* a word of hf_stage_word, NULL: the result of the run */
    const char *state;      /* of the net as built, by its name; NULL: a stage */
    bool force;             /* replace existing files */
    hf_file_out_set *files; /* takes what is written; the caller gives all of it names at once */
} hf_export_request;

typedef struct {
    const char *option;   /* "--csv" */
    const char *argument; /* DIR or FILE: what hf_export_request.output is */
    const char *help;
    bool takes_stage; /* true: writes one shape, chosen by --stage; false: writes every shape of the run */
    bool takes_case;  /* true: and that may be a state of the net as built, chosen by --case */
    /* Existing files are kept unless request->force is set; all names are checked before anything is written. `said`
     * gets one line for people on what was written. HF_EXISTS, HF_IO, HF_NO_MEMORY, HF_BAD_CASE or HF_BAD_USAGE, with
     * a message. */
    hf_status (*write)(const hf_export_request *request, char *said, size_t size, hf_messages *messages);
} hf_exporter;

/* In the order in which help lists them, and in which they are written when one command asks for several. */
#define HF_EXPORTERS(X) X(csv) X(vtk) X(cutlist) X(front) X(pattern) X(rf)

#define HF_EXPORTER_ROW(name) extern const hf_exporter hf_exporter_##name;
HF_EXPORTERS(HF_EXPORTER_ROW)
#undef HF_EXPORTER_ROW

#define HF_EXPORTER_INDEX(name) HF_EXPORTER_##name,
enum { HF_EXPORTERS(HF_EXPORTER_INDEX) HF_N_EXPORTER };
#undef HF_EXPORTER_INDEX

extern const hf_exporter *const hf_exporter_table[HF_N_EXPORTER];

/* ---- what exporters share ---- */

/* One shape of a result file. */
typedef struct {
    hf_summary summary;
    hf_scene scene;
    hf_shape shape;
    const char *word; /* the name of the shape in messages */
} hf_export_stored;

typedef hf_status hf_export_write_shape(const hf_export_request *request, const hf_export_stored *stored, char *said,
                                        size_t size, hf_messages *messages);

/* Read the shape of request->stage or request->state or, when both are NULL, the result of the run, with its summary
 * and scene; all zero on entry. HF_BAD_USAGE when the run has no such shape; HF_IO, HF_NO_MEMORY. Free it in any
 * case. */
hf_status hf_export_read(const hf_export_request *request, hf_export_stored *stored, hf_messages *messages);
void hf_export_free(hf_export_stored *stored);

/* Returns whether the result has the nodes and members of a truss; warns of an unfinished one, which has not yet. */
bool hf_export_has_truss(const hf_export_request *request, const hf_summary *summary, hf_messages *messages);

/* Of the result `file` with a front: the shape of its result, or of a state, is none of the designs that were found. */
void hf_export_warn_of_front(const char *file, const hf_summary *summary, bool is_state, hf_messages *messages);

/* For exporters that take a stage: calls `write` with what hf_export_read has read. */
hf_status hf_export_shape(const hf_export_request *request, hf_export_write_shape *write, char *said, size_t size,
                          hf_messages *messages);

/* Checks that `path` may be written: HF_EXISTS with a message when it is request->file, or exists and request->force is
 * false; HF_IO when it is not an ordinary file. The second is for outputs that are not made of a result. */
hf_status hf_export_claim(const hf_export_request *request, const char *path, hf_messages *messages);
hf_status hf_export_claim_file(const char *path, bool force, hf_messages *messages);

/* The same of the file `name` in the folder request->output, which sets `path` to it. */
hf_status hf_export_claim_in_folder(const hf_export_request *request, const char *name, char path[PATH_MAX],
                                    hf_messages *messages);

/* The first cells of cable i_cable: id,i,j,group. */
void hf_export_ends_of(const hf_scene *scene, int i_cable, FILE *file);

/* The cell of cable i_cable in the column `set`, with the comma in front; nothing when the scene has no sets. */
void hf_export_sets_of(const hf_scene *scene, int i_cable, FILE *file);

#endif
