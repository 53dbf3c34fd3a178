/* config - case file (YAML) -> validated settings.
 * Stability: stable.
 *
 * One table (src/case/config_table.c) holds every key with its type, range, default, unit and help. The loader
 * validates by it, `hifdm schema` prints it, and no default stands anywhere else. */
#ifndef HIFDM_CONFIG_H
#define HIFDM_CONFIG_H

#include <hifdm/api.h>
#include <hifdm/carrier.h>
#include <hifdm/generate.h>
#include <hifdm/material.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>
#include <hifdm/states.h>
#include <hifdm/status.h>
#include <hifdm/truss.h>

HF_API_BEGIN

/* A case file with every default filled in, also in sections that the file does not have. */
typedef struct {
    char path[HF_PATH_SIZE]; /* of the case file */
    char *text;              /* its content */
    size_t text_length;
    char *overrides; /* the --set arguments, one line each; "" when there are none */
    char sha256[65]; /* of text and overrides */
    char title[256];
    char *where_given;                          /* places of the keys, for hf_config_place; internal */
    bool has_import, has_optimize, has_surface; /* which sections are there */
    bool has_tolerance;
    bool has_sweep; /* its lines are cut out of `text`; study.h reads the axes */
#define HF_CASE_GENERATOR(section, type, KEYS, help)                                                                   \
    bool has_##section;                                                                                                \
    type section;
    HF_GENERATORS(HF_CASE_GENERATOR)
#undef HF_CASE_GENERATOR
    double EA_N[2]; /* by hf_group, of cables without a value in the net; 0 = not given */
    char nodes_path[HF_PATH_SIZE], cables_path[HF_PATH_SIZE]; /* resolved against the folder of the case file */
    char facets_path[HF_PATH_SIZE];                           /* the same; "": facets are found */
    hf_form_settings form;
    hf_optimize_settings optimize;
    hf_front_origin taken;       /* in place of what optimize would find; no key: it comes with the run */
    hf_surface_settings surface; /* a generated net supplies what is not given */
    bool has_adjust;
    hf_adjust_settings adjust;
    hf_built_settings built;
    hf_tolerance_settings tolerance;

    bool has_truss, has_truss_import, has_truss_ring; /* which sections are there */
    hf_truss_settings truss;
    char truss_nodes_path[HF_PATH_SIZE], truss_members_path[HF_PATH_SIZE];
} hf_case;

/* Read and validate a case file. `overrides`: n_override strings "path=value" that override the file. Returns HF_OK;
 * HF_BAD_CASE with a message file:line:col for every fault; HF_NO_MEMORY. Free with hf_case_free in any case. */
hf_status hf_config_load(const char *path, const char *const *overrides, int n_override, hf_case *settings,
                         hf_messages *messages);

/* hf_config_load from the text of a case file. `path` is used in messages and to resolve the files that the case
 * names. */
hf_status hf_config_parse(const char *path, const char *text, const char *const *overrides, int n_override,
                          hf_case *settings, hf_messages *messages);

/* Write the keys in which two cases differ, such as "form.stop, optimize.seed", into text[size]; a list that does not
 * fit is cut. Returns the number of these keys. */
int hf_config_differences(const hf_case *a, const hf_case *b, char *text, size_t size);

/* Write where a key of the table stands, for a message: "case.yaml:7:3: surface.kind", "--set surface.kind", or
 * "case.yaml: surface.kind" when it is not given; of a key of a row, such as "optimize.goals.0.set", then where the row
 * stands, which is "optimize.goals.0". Returns whether it is given. */
bool hf_config_place(const hf_case *settings, const char *key, char *text, size_t size);

/* Make the scene that the case describes, and check it (hf_scene_check). Returns HF_OK; HF_BAD_CASE, also when a file
 * cannot be read; HF_NO_MEMORY. Free the scene in any case. */
hf_status hf_config_scene(const hf_case *settings, hf_scene *scene, hf_messages *messages);

/* The wanted surface of a case with a section `surface`, all zero without one: that of the case, with the kind that the
 * inner nodes of the scene are on where the case leaves it open. Returns HF_OK; HF_BAD_CASE when their theoretical
 * positions are not on the surface, with the RMS of both kinds. Warns of a focal length out of proportion, also without
 * that section. */
hf_status hf_config_surface(const hf_case *settings, const hf_scene *scene, hf_surface_settings *surface,
                            hf_messages *messages);

/* What cables and nodes of the scene are made of, by the rows of `cables` and `nodes`; a later row replaces what an
 * earlier one says. Returns HF_OK; HF_BAD_CASE for rows that name nothing of this net; HF_NO_MEMORY. Free it in any
 * case. */
hf_status hf_config_material(const hf_case *settings, const hf_scene *scene, hf_material *material,
                             hf_messages *messages);

/* Has the truss members of this part, and is their expansion known? HF_OK; HF_BAD_CASE with a message that begins with
 * `where` and ends with `other`, what may be done instead. Warns of a table in which none of them expands. */
hf_status hf_config_demand_expansion(const hf_case *settings, const hf_truss *truss, hf_part part, const char *where,
                                     const char *other, hf_messages *messages);

/* The states that the rows of `cases` describe, with their material; truss: NULL when there is none. A case without
 * rows has none. HF_BAD_CASE for rows that name nothing of this net or truss, for cables without EA, for temperatures
 * of what has no known expansion, for gravity on what has no known mass; HF_NO_MEMORY. Free them in any case. */
hf_status hf_config_states(const hf_case *settings, const hf_scene *scene, const hf_truss *truss, hf_states *states,
                           hf_messages *messages);

/* Make the truss of a case that has one, and check it (hf_truss_check). Errors as hf_config_scene. Free the truss in
 * any case. */
hf_status hf_config_truss(const hf_case *settings, hf_truss *truss, hf_messages *messages);

/* Build the carrier of the scene's supports from the truss of the case (hf_carrier_build). Errors as hf_config_truss,
 * and HF_MECHANISM. Free the carrier in any case. */
hf_status hf_config_carrier(const hf_case *settings, const hf_scene *scene, hf_carrier *carrier, hf_messages *messages);

void hf_case_free(hf_case *settings);

/* ---- The table of keys: internal; it may change in any version ---- */

typedef enum {
    HF_FIELD_DOUBLE,
    HF_FIELD_INT,
    HF_FIELD_UINT64,
    HF_FIELD_INT_PAIR,
    HF_FIELD_WORD, /* an enumeration: index into words */
    HF_FIELD_TEXT,
    HF_FIELD_DOUBLE_LIST, /* hf_double_list */
    HF_FIELD_AMOUNT,      /* double[2]: a number, or a part of something such as 30 % as 0.3; NaN is what it is not */
    HF_FIELD_BOUNDS,      /* double[2]: lower < upper, infinite where a side is open */
    HF_FIELD_VECTOR       /* double[3]: along x, y, z */
} hf_field_type;

typedef struct {
    const char *path; /* "form.pretension_N" */
    hf_field_type type;
    size_t offset;             /* in hf_case; of a key of a row: in the row */
    double min, max;           /* inclusive; min HF_ABOVE_ZERO: above 0; text: max is the size of the buffer */
    const char *default_value; /* as written in a case file; NULL = required when its section or row is there; "" =
                                * nothing, which in a row is NaN of numbers and open of bounds */
    const char *unit;          /* "" = dimensionless */
    const char *const *words;  /* of HF_FIELD_WORD, NULL-terminated */
    const char *help;
} hf_field;

typedef struct {
    const char *path;      /* "scene.import" */
    size_t present_offset; /* of the bool in hf_case that is true when the section is there */
    const char *help;
} hf_section;

/* A list of rows: a row is a section without a name, whose keys are "optimize.variables.0.range" and so on. */
typedef struct {
    const char *path;            /* "optimize.variables" */
    size_t count_offset, offset; /* in hf_case: of the int that counts its rows, of the first row */
    size_t row_size;
    int max_row;
    const hf_field *field; /* [n_field] the keys of a row, with the path "range" */
    int n_field;
    const char *help;
} hf_list;

#define HF_ABOVE_ZERO 1e-300 /* the min of a field that must be positive */

extern const hf_field hf_field_table[]; /* [hf_n_field], by section */
extern const int hf_n_field;
extern const hf_section hf_section_table[];
extern const int hf_n_section;
extern const hf_list hf_list_table[];
extern const int hf_n_list;

/* Check `value`, written as in a case file, against a key of the table, "form.stop" or "optimize.variables.0.range".
 * Returns HF_OK; HF_BAD_CASE with the message "<place>: <key>: <why not>"; HF_NO_MEMORY. Only hf_config_load checks the
 * rules that involve several keys, and whether there is such a row. */
hf_status hf_config_check_value(const char *key, const char *value, const char *place, hf_messages *messages);

HF_API_END
#endif
