/* config - reads a case file (YAML) into validated settings and makes net, truss and load cases from them.
 * Stability: stable.
 *
 * Pipeline:
 *
 *   hf_config_load       case file and overrides -> hf_case, with every default filled in
 *   hf_config_scene      hf_case -> scene
 *   hf_config_surface, _material, _load_cases   hf_case and scene -> target surface, material, load cases
 *   hf_config_truss, hf_config_carrier                        hf_case and scene -> truss, condensed to the supports
 *
 * One table (src/case/config_table.c) holds every key with its type, range, default, unit and help; the rows of
 * generators are in generate.h and truss.h. The loader validates by the table, and `hifdm schema` prints it. No default
 * is defined anywhere else. */
#ifndef HIFDM_CONFIG_H
#define HIFDM_CONFIG_H

#include <hifdm/api.h>
#include <hifdm/carrier.h>
#include <hifdm/generate.h>
#include <hifdm/material.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>
#include <hifdm/load_cases.h>
#include <hifdm/status.h>
#include <hifdm/truss.h>

HF_API_BEGIN

/* A case: the content of a case file, with every default filled in, also in sections that the file does not have. */
typedef struct {
    char path[HF_PATH_SIZE];                    /* path of the case file */
    char *text;                                 /* its text, without the section sweep */
    size_t text_length;                         /* bytes of the text */
    char *overrides;                            /* the overrides, one line each; "": there are none */
    char sha256[65];                            /* digest of text and overrides in hexadecimal digits */
    char title[256];                            /* title of the case */
    char *where_given;                          /* internal: locations of the keys, for hf_config_location */
    bool has_import, has_optimize, has_surface; /* which sections the case has */
    bool has_tolerance;                         /* the case has a section tolerance */
    bool has_sweep;                             /* its lines are not in `text`; study.h reads the axes */
#define HF_CASE_GENERATOR(section, type, KEYS, help)                                                                   \
    bool has_##section;                                                                                                \
    type section;
    HF_GENERATORS(HF_CASE_GENERATOR)
#undef HF_CASE_GENERATOR
    double EA_N[2]; /* axial stiffness by hf_group of cables without a value in the net; 0: not given */
    char nodes_path[HF_PATH_SIZE], cables_path[HF_PATH_SIZE]; /* resolved against the folder of the case file */
    char facets_path[HF_PATH_SIZE];                           /* the same; "": hf_facets_find finds the facets */
    hf_form_settings form;                                    /* section form, with coupling */
    hf_optimize_settings optimize;                            /* section optimize */
    hf_front_origin taken;           /* a point of a front that replaces the search; set by the run, not by a key */
    hf_surface_settings surface;     /* section surface; a generated net supplies what is not given */
    bool has_adjust;                 /* the case has a section adjust */
    hf_adjust_settings adjust;       /* section adjust */
    hf_built_settings built;         /* rows of `cables`, `nodes` and `load_cases` */
    hf_tolerance_settings tolerance; /* section tolerance */

    bool has_truss, has_truss_import, has_truss_ring;                      /* which sections the case has */
    hf_truss_settings truss;                                               /* section truss */
    char truss_nodes_path[HF_PATH_SIZE], truss_members_path[HF_PATH_SIZE]; /* the tables of an imported truss */
} hf_case;

/* Reads and validates a case file. overrides [n_override] are strings "key=value" that replace values of the file. An
 * old name of a key or a word is read as the new one, with a warning. Returns HF_OK; HF_BAD_CASE, also if the file
 * cannot be read, with a message for each fault, file:line:column; HF_NO_MEMORY. Call hf_case_free in any case. */
hf_status hf_config_load(const char *path, const char *const *overrides, int n_override, hf_case *settings,
                         hf_messages *messages);

/* Reads a case as hf_config_load does, from the text of a case file. `path` is used in messages and to resolve the
 * paths of other files in the case. The text is copied. */
hf_status hf_config_parse(const char *path, const char *text, const char *const *overrides, int n_override,
                          hf_case *settings, hf_messages *messages);

/* Writes the keys in which two cases differ, such as "form.stop, optimize.seed", into text[size]. A list that does not
 * fit is cut. Returns the number of these keys. */
int hf_config_differences(const hf_case *a, const hf_case *b, char *text, size_t size);

/* Writes the location of a key for a message into text[size]: "case.yaml:7:3: surface.kind", "--set surface.kind", or
 * "case.yaml: surface.kind" if the case does not have the key. For a missing key of a row, such as
 * "optimize.objective.0.set", the location is that of the row. Returns true if the case has the key. */
bool hf_config_location(const hf_case *settings, const char *key, char *text, size_t size);

/* Makes the scene that the case describes and checks it (hf_scene_check). Returns HF_OK; HF_BAD_CASE, also if a file
 * cannot be read; HF_NO_MEMORY. Call hf_scene_free in any case. */
hf_status hf_config_scene(const hf_case *settings, hf_scene *scene, hf_messages *messages);

/* Determines the target surface of a case with a section surface; without one, *surface is all zero. If the case leaves
 * the kind open, it is the kind to which the inner nodes of the scene are nearer. Returns HF_OK; HF_BAD_CASE if their
 * target positions are not on the surface, with a message that contains the RMS distance for both kinds. Also without
 * the section, a focal length out of proportion to the aperture gets a warning. */
hf_status hf_config_surface(const hf_case *settings, const hf_scene *scene, hf_surface_settings *surface,
                            hf_messages *messages);

/* Sets the material of cables and nodes of the scene from the rows of `cables` and `nodes`; a later row replaces the
 * values of an earlier one. Returns HF_OK; HF_BAD_CASE for rows that match nothing in this net; HF_NO_MEMORY. Call
 * hf_material_free in any case. */
hf_status hf_config_material(const hf_case *settings, const hf_scene *scene, hf_material *material,
                             hf_messages *messages);

/* Checks that the truss has members of this part and that their thermal expansion is known. Returns HF_OK, or
 * HF_BAD_CASE with a message that begins with `where` and ends with `other`, an alternative for the user. An imported
 * truss in which no member of the part expands gets a warning. */
hf_status hf_config_demand_expansion(const hf_case *settings, const hf_truss *truss, hf_part part, const char *where,
                                     const char *other, hf_messages *messages);

/* Makes the load cases of the as-built net from the rows of `load_cases`, with their material. truss is NULL if there
 * is none. A case without rows has no load cases. Returns HF_OK; HF_NO_MEMORY; HF_BAD_CASE for rows that match nothing
 * in this net or truss, for cables without EA, and for a table that cannot be read. A temperature of a part with
 * unknown expansion and gravity on cables with unknown mass are also HF_BAD_CASE. The names are borrowed from the case.
 * Call hf_load_cases_free in any case. */
hf_status hf_config_load_cases(const hf_case *settings, const hf_scene *scene, const hf_truss *truss,
                               hf_load_cases *states, hf_messages *messages);

/* Makes the truss of a case that has one and checks it (hf_truss_check). Returns HF_OK; HF_BAD_CASE, also if a file
 * cannot be read; HF_NO_MEMORY. Call hf_truss_free in any case. */
hf_status hf_config_truss(const hf_case *settings, hf_truss *truss, hf_messages *messages);

/* Makes the truss of the case and builds the carrier of the scene's supports from it (hf_carrier_build). Returns HF_OK;
 * HF_BAD_CASE; HF_MECHANISM; HF_NO_MEMORY; HF_NO_LAPACK. Call hf_carrier_free in any case. */
hf_status hf_config_carrier(const hf_case *settings, const hf_scene *scene, hf_carrier *carrier, hf_messages *messages);

/* Frees the memory of a case. */
void hf_case_free(hf_case *settings);

/* ---- The table of keys: internal; it may change in any version ---- */

/* Type of a key. */
typedef enum {
    HF_FIELD_DOUBLE,      /* double */
    HF_FIELD_INT,         /* int */
    HF_FIELD_UINT64,      /* uint64_t */
    HF_FIELD_INT_PAIR,    /* int[2] */
    HF_FIELD_WORD,        /* an enumeration: index into words */
    HF_FIELD_TEXT,        /* text with its NUL */
    HF_FIELD_DOUBLE_LIST, /* hf_double_list */
    HF_FIELD_AMOUNT,      /* double[2]: a number or a ratio, such as 0.3 for 30 %; NaN: not given */
    HF_FIELD_BOUNDS,      /* double[2]: lower < upper; infinite where a side is open */
    HF_FIELD_VECTOR       /* double[3]: along x, y, z */
} hf_field_type;

/* A key of a case file. */
typedef struct {
    const char *path;   /* name with its sections, "form.pretension_N" */
    hf_field_type type; /* type of the value */
    size_t offset;      /* offset of the member in hf_case; for a key of a row: in the row */
    double min, max;    /* inclusive bounds; min HF_ABOVE_ZERO: above 0; text: max is the size of the buffer */
    /* As written in a case file. NULL: the key is required if its section or row exists. "": no value; in a row,
     * numbers are then NaN and bounds are open. */
    const char *default_value;
    const char *unit;         /* unit; "": dimensionless */
    const char *const *words; /* words of HF_FIELD_WORD, ended by NULL; otherwise NULL */
    const char *help;         /* help of the key */
} hf_field;

/* A section of a case file. */
typedef struct {
    const char *path;      /* name, "scene.import" */
    size_t present_offset; /* offset of the bool in hf_case that is true if the section exists; SIZE_MAX: none */
    const char *help;      /* help of the section */
} hf_section;

/* A list of rows. A row is a section without a name; its keys are "optimize.variables.0.range" and so on. */
typedef struct {
    const char *path;            /* name, "optimize.variables" */
    size_t count_offset, offset; /* offsets in hf_case of the number of rows and of the first row */
    size_t row_size;             /* bytes from one row to the next */
    int max_row;                 /* maximum number of rows */
    const hf_field *field;       /* [n_field] keys of a row, whose path is the last part, "range" */
    int n_field;                 /* number of keys of a row */
    const char *help;            /* help of the list */
} hf_list;

#define HF_ABOVE_ZERO 1e-300 /* min of a key that must be above zero */

extern const hf_field hf_field_table[];     /* [hf_n_field] keys in the order of their sections */
extern const int hf_n_field;                /* number of keys */
extern const hf_section hf_section_table[]; /* [hf_n_section] sections */
extern const int hf_n_section;              /* number of sections */
extern const hf_list hf_list_table[];       /* [hf_n_list] lists of rows */
extern const int hf_n_list;                 /* number of lists */

/* Checks `value`, written as in a case file, against a key of the table: "form.stop" or "optimize.variables.0.range".
 * Returns HF_OK; HF_BAD_CASE with a message "<location>: <key>: <fault>"; HF_NO_MEMORY. The rules that involve several
 * keys, and whether the row exists, are checked only by hf_config_load. */
hf_status hf_config_check_value(const char *key, const char *value, const char *location, hf_messages *messages);

HF_API_END
#endif
