/* export - writes a stored result in the formats of other programs.
 *
 * The file export_table.c lists all exporters. The file export_NAME.c contains the exporter NAME: its row and its
 * function. A new exporter needs such a file and its name in HF_EXPORTERS. The option of `hifdm export`, its help and
 * the call of the exporter follow from the row. */
#pragma once

#include "base/file_out.h"
#include <hifdm/facets.h>
#include <hifdm/store.h>

#include <limits.h>
#include <stdbool.h>

/* Describes what to export, and to where. */
typedef struct {
    const char *file;       /* path of the result */
    const char *output;     /* file or folder to write */
    bool is_folder;         /* output is a folder */
    const char *stage;      /* a word of hf_stage_word; NULL: the stage that is the result */
    const char *load_case;  /* name of a load case of the as-built net; NULL: a stage */
    bool force;             /* replace existing files */
    hf_file_out_set *files; /* collects the files; the caller renames them all at once */
    FILE *said;             /* receives one line for each exporter, which reports what was written */
} hf_export_request;

/* What an exporter reads of a result; each value includes those before it. */
typedef enum { HF_EXPORT_SUMMARY, HF_EXPORT_SCENE, HF_EXPORT_SHAPE } hf_export_extent;

/* Holds what was read of a result file. */
typedef struct {
    hf_summary summary;
    hf_stage stage; /* that of request->stage or, without it, the stage that is the result */
    hf_scene scene;
    hf_facets facets; /* with the scene; none when the case does not measure the surface */
    hf_shape shape;   /* of this stage, or of the load case */
    const char *word; /* name of the shape in messages */
} hf_export_stored;

typedef struct {
    const char *option;   /* such as "--csv" */
    const char *argument; /* DIR or FILE, the kind of hf_export_request.output */
    const char *help;
    hf_export_extent reads;
    bool takes_stage; /* true: writes one shape, chosen by --stage; false: writes every shape of the run */
    bool takes_case;  /* true: --load-case may also choose a load case of the as-built net */
    /* Writes the export of what was read. It checks all names before it writes anything, and keeps existing files
     * unless request->force is set. Returns HF_OK; HF_EXISTS, HF_IO, HF_NO_MEMORY, HF_BAD_CASE or HF_BAD_USAGE with a
     * message. */
    hf_status (*write)(const hf_export_request *request, const hf_export_stored *stored, hf_messages *messages);
} hf_exporter;

/* Lists the exporters in the order of the help. A command with several of their options writes them in this order. */
#define HF_EXPORTERS(X) X(csv) X(vtk) X(cutlist) X(front) X(pattern) X(rf)

#define HF_EXPORTER_ROW(name) extern const hf_exporter hf_exporter_##name;
HF_EXPORTERS(HF_EXPORTER_ROW)
#undef HF_EXPORTER_ROW

#define HF_EXPORTER_INDEX(name) HF_EXPORTER_##name,
enum { HF_EXPORTERS(HF_EXPORTER_INDEX) HF_N_EXPORTER };
#undef HF_EXPORTER_INDEX

extern const hf_exporter *const hf_exporter_table[HF_N_EXPORTER];

/* ---- shared by exporters ---- */

/* Reads the summary, the scene and the shape of request->stage or request->load_case, as far as `extent` asks for them.
 * When both are NULL, the shape is the result of the run. *stored must be zero on entry. Returns HF_OK; HF_BAD_USAGE
 * when the run has no such shape; HF_IO or HF_NO_MEMORY. Call hf_export_free in any case. */
hf_status hf_export_read(const hf_export_request *request, hf_export_extent extent, hf_export_stored *stored,
                         hf_messages *messages);
void hf_export_free(hf_export_stored *stored);

/* Returns whether the result has the nodes and members of a truss. An unfinished run with a truss does not have them
 * yet; it causes a warning. */
bool hf_export_has_truss(const hf_export_request *request, const hf_summary *summary, hf_messages *messages);

/* Reads the truss with its state under the result or, if load_case is not NULL, in this load case. Both must be zero on
 * entry. Returns HF_OK, HF_IO or HF_NO_MEMORY. Free both in any case. */
hf_status hf_export_read_truss(const char *file, const char *load_case, hf_truss *truss, hf_carrier_state *state,
                               hf_messages *messages);

/* Warns when the result `file` is unfinished, and when it has a Pareto front from which no point was taken. The
 * exported shape is then an end of the front, or belongs to the form-finding. Load cases always belong to the
 * form-finding. */
void hf_export_warn_of_shape(const char *file, const hf_summary *summary, bool is_load_case, hf_messages *messages);

/* hf_export_claim checks that `path` may be written. It returns HF_EXISTS with a message when `path` is request->file,
 * or when it exists and request->force is false. It returns HF_IO when `path` is not an ordinary file.
 * hf_export_claim_file does the same for outputs that are not made from a result. */
hf_status hf_export_claim(const hf_export_request *request, const char *path, hf_messages *messages);
hf_status hf_export_claim_file(const char *path, bool force, hf_messages *messages);

/* One text file of an export. */
typedef struct {
    /* Name of the file in the folder request->output. If request->output is a file, this is the part that is inserted
     * before the ending of its name. */
    const char *name;
    void (*write)(const void *context, FILE *file); /* NULL: the file is left out */
    char path[PATH_MAX];                            /* set by hf_export_files */
} hf_export_file;

/* Sets `path` to the path of the file `name`, as in hf_export_file, and checks it as hf_export_claim does. */
hf_status hf_export_claim_part(const hf_export_request *request, const char *name, char path[PATH_MAX],
                               hf_messages *messages);

/* Checks the names of all n files, makes the folder if request->is_folder, and writes the files. */
hf_status hf_export_files(const hf_export_request *request, hf_export_file *file, int n, const void *context,
                          hf_messages *messages);

/* Writes the first cells of a cable or a member: id,i,j. node_id has the ids of all nodes. */
void hf_export_ends(const char *id, const char *const *node_id, const int end[2], FILE *file);

/* Writes the cell of cable i_cable in the column `set`, with a comma before it. Writes nothing when the scene has no
 * sets. */
void hf_export_sets_of(const hf_scene *scene, int i_cable, FILE *file);
