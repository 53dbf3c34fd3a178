/* config - reads a case file (YAML) into validated settings and makes net, truss and load cases from them.
 * Stability: stable.
 *
 * Pipeline:
 *
 *   hf_config_load       case file and overrides -> hf_case, with all defaults
 *   hf_config_scene      hf_case -> scene
 *   hf_config_surface, _material, _load_cases   hf_case and scene -> target surface, material, load cases
 *   hf_config_truss, hf_config_carrier                        hf_case and scene -> truss, condensed to the supports
 *
 * One table (src/case/config_table.c) holds every key with its type, range, default and unit. The headers
 * generate.h and truss.h define the keys of the generators. The file src/case/keys.md describes each key. The loader
 * validates case files with this table, and `hifdm schema` prints the table. The table defines all defaults. */
#pragma once

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

/* A case contains the values of a case file and the defaults of all missing keys and sections. */
typedef struct {
    char path[HF_PATH_SIZE];                    /* path of the case file */
    char *text;                                 /* text of the case file without the section sweep */
    size_t text_length;                         /* size of the text in bytes */
    char *overrides;                            /* overrides, one per line; "": there are none */
    char sha256[65];                            /* hexadecimal digest of text and overrides */
    char title[256];                            /* title of the case */
    char *where_given;                          /* internal: locations of the keys, and the keys with faults */
    bool has_import, has_optimize, has_surface; /* which sections the case has */
    bool has_tolerance;                         /* the case has a section tolerance */
    bool has_sweep; /* the case has a section sweep; its lines are not in `text`, and study.h reads its axes */
#define HF_CASE_GENERATOR(section, type, KEYS)                                                                         \
    bool has_##section;                                                                                                \
    type section;
    HF_GENERATORS(HF_CASE_GENERATOR)
#undef HF_CASE_GENERATOR
    double EA_N[2]; /* axial stiffness, by hf_group, of cables without a value in the net; 0: not given */
    /* tables of the net; paths are resolved against the folder of the case file */
    char nodes_path[HF_PATH_SIZE], cables_path[HF_PATH_SIZE];
    char facets_path[HF_PATH_SIZE];  /* path of the table of facets; "": hf_facets_find finds the facets */
    hf_form_settings form;           /* section form, with coupling */
    hf_optimize_settings optimize;   /* section optimize */
    hf_front_origin taken;           /* point of a front that replaces the search; the run sets it, no key does */
    hf_surface_settings surface;     /* section surface; a generated net supplies missing values */
    bool has_adjust;                 /* the case has a section adjust */
    hf_adjust_settings adjust;       /* section adjust */
    hf_built_settings built;         /* rows of `cables`, `nodes` and `load_cases` */
    hf_tolerance_settings tolerance; /* section tolerance */
    int n_requirement;               /* number of rows of `requirements` */
    hf_requirement_settings requirement[HF_REQUIREMENT_ROWS_MAX]; /* [n_requirement] rows of `requirements` */

    bool has_truss, has_truss_import, has_truss_ring;                      /* which sections the case has */
    hf_truss_settings truss;                                               /* section truss */
    char truss_nodes_path[HF_PATH_SIZE], truss_members_path[HF_PATH_SIZE]; /* the tables of an imported truss */
} hf_case;

/* Reads and validates a case file. The strings overrides [n_override] have the form "key=value". The overrides replace
 * values of the file. If the file uses the old name of a key or word, the function accepts the old name and adds a
 * warning. Returns HF_OK or HF_NO_MEMORY. Returns HF_BAD_CASE if the file has faults or cannot be read. The function
 * adds a message with file:line:column for each fault. Call hf_case_free even if hf_config_load fails. */
hf_status hf_config_load(const char *path, const char *const *overrides, int n_override, hf_case *settings,
                         hf_messages *messages);

/* Reads a case from the text of a case file, in the same way as hf_config_load. The function uses the argument `path`
 * in messages and to resolve the paths of other files in the case. The function copies the text. */
hf_status hf_config_parse(const char *path, const char *text, const char *const *overrides, int n_override,
                          hf_case *settings, hf_messages *messages);

/* Writes a list of the keys in which two cases differ, such as "form.stop, optimize.seed", into text[size]. If the list
 * is longer than the buffer, the function truncates the list. Returns the number of keys that differ. */
int hf_config_differences(const hf_case *a, const hf_case *b, char *text, size_t size);

/* Writes the location of a key into text[size] for use in a message. Examples of locations are "case.yaml:7:3:
 * surface.kind" and "--set surface.kind". If the case does not contain the key, the location has no line number, as in
 * "case.yaml: surface.kind". If the key is missing in a row, as in "optimize.objective.0.set", the function writes the
 * location of the row. Returns true if the case has the key. */
bool hf_config_location(const hf_case *settings, const char *key, char *text, size_t size);

/* Makes and checks the scene that the case describes (hf_scene_check). Returns HF_OK or HF_NO_MEMORY. Returns
 * HF_BAD_CASE if the scene has faults or a file cannot be read. Call hf_scene_free even if hf_config_scene fails. */
hf_status hf_config_scene(const hf_case *settings, hf_scene *scene, hf_messages *messages);

/* Determines the target surface of a case that has a `surface` section. If the case has no `surface` section, the
 * function sets all members of *surface to zero. If the case does not specify a kind of surface, the function chooses
 * the kind that is closer to the inner nodes of the scene. Returns HF_OK, or HF_BAD_CASE if the target positions of the
 * inner nodes are not on the surface. The error message contains the RMS distances of the inner nodes from both kinds
 * of surface. If the focal length is out of proportion to the aperture, the function adds a warning. The check of the
 * focal length does not require a `surface` section. */
hf_status hf_config_surface(const hf_case *settings, const hf_scene *scene, hf_surface_settings *surface,
                            hf_messages *messages);

/* Sets the material of cables and nodes of the scene from the lists `cables` and `nodes` of the case. A later row
 * replaces the values of an earlier row. Returns HF_OK or HF_NO_MEMORY. Returns HF_BAD_CASE if a row matches no cable
 * or node of this net. Call hf_material_free even if hf_config_material fails. */
hf_status hf_config_material(const hf_case *settings, const hf_scene *scene, hf_material *material,
                             hf_messages *messages);

/* Checks that the truss has members in this part and that their thermal expansion is known. Returns HF_OK or
 * HF_BAD_CASE. The error message begins with the text `where` and ends with the text `other`. The text `other` suggests
 * an alternative to the user. If the truss is imported and no member of this part expands, the function adds a
 * warning. */
hf_status hf_config_demand_expansion(const hf_case *settings, const hf_truss *truss, hf_part part, const char *where,
                                     const char *other, hf_messages *messages);

/* Makes the load cases of the as-built net and their material from the list `load_cases`. If the case has no truss, the
 * argument `truss` is NULL. A case without rows of `load_cases` has no load cases. Returns HF_OK or HF_NO_MEMORY.
 * Returns HF_BAD_CASE if a row matches nothing in this net or truss, if cables have no EA, or if a table cannot be
 * read. Other causes of HF_BAD_CASE are a temperature of a part with unknown expansion, and gravity on cables of
 * unknown mass. The load cases borrow their names from the case. Call hf_load_cases_free even if hf_config_load_cases
 * fails. */
hf_status hf_config_load_cases(const hf_case *settings, const hf_scene *scene, const hf_truss *truss,
                               hf_load_cases *states, hf_messages *messages);

/* Makes and checks the truss of the case (hf_truss_check). The case must have a truss. Returns HF_OK or HF_NO_MEMORY.
 * Returns HF_BAD_CASE if the truss has faults or a file cannot be read. Call hf_truss_free even if hf_config_truss
 * fails. */
hf_status hf_config_truss(const hf_case *settings, hf_truss *truss, hf_messages *messages);

/* Makes the truss of the case and builds the carrier of the net from this truss (hf_carrier_build). Returns HF_OK,
 * HF_BAD_CASE, HF_MECHANISM, HF_NO_MEMORY or HF_NO_LAPACK. Call hf_carrier_free even if hf_config_carrier fails. */
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
    HF_FIELD_WORD,        /* index into `words` */
    HF_FIELD_TEXT,        /* text including its NUL */
    HF_FIELD_SET,         /* text including its NUL: names of sets of cables, joined by + */
    HF_FIELD_DOUBLE_LIST, /* hf_double_list */
    HF_FIELD_AMOUNT,      /* double[2]: a number or a ratio, such as 0.3 for 30 %; NaN: not given */
    HF_FIELD_BOUNDS,      /* double[2]: lower < upper; an open side is infinite */
    HF_FIELD_VECTOR       /* double[3]: along x, y, z */
} hf_field_type;

/* Describes a key of a case file. */
typedef struct {
    const char *path;   /* name including its sections, "form.pretension_N" */
    hf_field_type type; /* type of the value */
    size_t offset;      /* offset of the member in hf_case; for a key of a row, the offset in the row */
    /* inclusive bounds; min HF_ABOVE_ZERO: the value is above 0; for a text, max is the size of the buffer */
    double min, max;
    /* The string default_value is the default value as written in a case file. A NULL pointer means that every existing
     * section or row must contain the key. An empty string means that the key has no value by default. In a row, a
     * missing number is NaN, and missing bounds are infinite. */
    const char *default_value;
    const char *unit;         /* unit; "": dimensionless */
    const char *const *words; /* words of HF_FIELD_WORD by enumeration, terminated by NULL; NULL for other types */
} hf_field;

/* Describes a section of a case file. */
typedef struct {
    const char *path;      /* name, "scene.import" */
    size_t present_offset; /* offset of the bool in hf_case that states whether the section exists; SIZE_MAX: none */
} hf_section;

/* A list of rows. A row is a section without a name. The keys of a row have names such as
 * "optimize.variables.0.range". */
typedef struct {
    const char *path;            /* name, "optimize.variables" */
    size_t count_offset, offset; /* offsets in hf_case of the number of rows and of the first row */
    size_t row_size;             /* bytes from one row to the next */
    int max_row;                 /* maximum number of rows */
    const hf_field *field;       /* [n_field] keys of a row; their path is the last part of the name, "range" */
    int n_field;                 /* number of keys of a row */
} hf_list;

/* Creates a NULL-terminated list of words for a single row of the table. */
#define HF_WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

#define HF_ABOVE_ZERO 1e-300 /* value of `min` for a key that must be above zero */

extern const hf_field hf_field_table[];     /* [hf_n_field] keys in the order of their sections */
extern const int hf_n_field;                /* number of keys */
extern const hf_section hf_section_table[]; /* [hf_n_section] sections */
extern const int hf_n_section;              /* number of sections */
extern const hf_list hf_list_table[];       /* [hf_n_list] lists of rows */
extern const int hf_n_list;                 /* number of lists */

/* Returns the description of a section, a list or a key from src/case/keys.md. If `key` is not NULL, `path` is the list
 * and `key` is a key of its rows. Returns "" if there is no description. */
const char *hf_config_help(const char *path, const char *key);

/* Checks a value against the rules of a key in the table. An example of a key is "optimize.variables.0.range". The
 * string `value` has the form that it would have in a case file. Returns HF_OK, HF_NO_MEMORY, or HF_BAD_CASE with a
 * message "<location>: <key>: <fault>". Only hf_config_load checks that the row exists and that the values of several
 * keys are consistent. */
hf_status hf_config_check_value(const char *key, const char *value, const char *location, hf_messages *messages);

HF_API_END
