/* config - case file (YAML) -> validated settings. One table (config_table.c) holds every key with its type, range,
 * default, unit and help; the same table validates, prints `hifdm schema`, and is the only place of a default. */
#ifndef HIFDM_CONFIG_H
#define HIFDM_CONFIG_H

#include <hifdm/scene.h>
#include <hifdm/status.h>
#include <hifdm/truss.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Words of a case file; `hifdm schema` says what each means. */
typedef enum { HF_METHOD_HIFDM, HF_METHOD_ITERATIVE_FDM, HF_METHOD_FDM, HF_METHOD_NEWTON, HF_METHOD_AUTO } hf_method;
typedef enum { HF_OPTIMIZE_GA, HF_OPTIMIZE_LM, HF_OPTIMIZE_GA_LM } hf_optimize_method;
typedef enum { HF_SOLVER_AUTO, HF_SOLVER_CHORD, HF_SOLVER_NEWTON, HF_SOLVER_FIXED_POINT } hf_solver;
typedef enum { HF_STOP_RESIDUAL, HF_STOP_RMS_CHANGE } hf_stop_rule;
typedef enum { HF_RULE_FORCE_DENSITY, HF_RULE_TENSION, HF_RULE_SEEDED } hf_rule;
typedef enum { HF_COUPLING_ACCELERATED, HF_COUPLING_PLAIN } hf_coupling_scheme;
typedef enum { HF_SYMMETRY_NONE, HF_SYMMETRY_X, HF_SYMMETRY_Y, HF_SYMMETRY_XY, HF_SYMMETRY_AUTO } hf_symmetry;

/* By the enumerations above. */
extern const char *const hf_method_word[5];
extern const char *const hf_stop_rule_word[2];
extern const char *const hf_rule_word[3];
extern const char *const hf_solver_word[4];
extern const char *const hf_optimize_method_word[3];
extern const char *const hf_symmetry_word[5];
extern const char *const hf_coupling_scheme_word[2];

/* Of the net with an elastic truss; without attachments nothing looks at them. */
typedef struct {
    double tof_m; /* largest difference of an attachment's displacements in two iterations */
    int scheme;   /* hf_coupling_scheme */
    int max_iterations;
} hf_coupling_settings;

typedef struct {
    int method;                /* hf_method */
    double pretension_N;       /* Td */
    int stop;                  /* hf_stop_rule */
    double residual_tolerance; /* max nodal residual relative to the pretension */
    double length_tolerance;   /* max |l/L*-1| of cables under the length law */
    double rms_tolerance_m;    /* change of psi between iterations, the paper's rule */
    int max_iterations;        /* bound on the linear solves */
    double collapse_ratio; /* a cable of law tension shorter than this part of its theoretical length has collapsed */
    hf_coupling_settings coupling;
} hf_form_settings;

typedef struct {
    int method;                          /* hf_optimize_method */
    int rule;                            /* hf_rule: what a design (a set of boundary pretensions) means */
    int solver;                          /* hf_solver of the individuals */
    int population, generations;         /* individuals; largest number of generations */
    double range_N;                      /* |dT| of Eq. 13 */
    double min_tension_N, max_tension_N; /* bounds on T' */
    double boundary_ratio_cap;           /* largest allowed boundary tension ratio of an individual */
    uint64_t seed;
    double crossover_high, crossover_low; /* Pc1, Pc2 */
    double mutation_high, mutation_low;   /* Pm1, Pm2 */
    int elites;                           /* best individuals that live on unchanged */
    double stagnation_tolerance_m;        /* stop when the best psi gained less than this ... */
    int stagnation_generations;           /* ... in so many generations */
    int polish_iterations;                /* bound on those of Levenberg-Marquardt */
    int symmetry;                         /* hf_symmetry: mirror planes that link genes */
} hf_optimize_settings;

#define HF_LIST_MAX 8

typedef struct {
    int n; /* of `value` in use */
    double value[HF_LIST_MAX];
} hf_double_list;

/* The reflecting surface: the parabolic cylinder z = x^2/(4f) along y. */
typedef struct {
    double focal_length_m; /* 0 when no measures of the surface are asked for */
    double strip_width_m;  /* of flat strips along y that make it up; 0 = not known */
    hf_double_list frequencies_Hz;
} hf_surface_settings;

#define HF_PATH_SIZE 1024

/* A case file, with every default filled in; those of sections that are not there, too. */
typedef struct {
    char path[HF_PATH_SIZE]; /* of the case file */
    char *text;              /* its content */
    size_t text_length;
    char *overrides; /* the --set arguments, a line each; "" when there are none */
    char sha256[65]; /* of text and overrides */
    char title[256];
    int has_cylinder, has_import, has_optimize, has_surface; /* which sections are there */
    int has_sweep; /* axes of a sweep are read by study.h; they are cut out of `text`, which is one point's case */
    hf_cylinder cylinder;
    char nodes_path[HF_PATH_SIZE], cables_path[HF_PATH_SIZE]; /* resolved against the folder of the case file */
    hf_form_settings form;
    hf_optimize_settings optimize;
    hf_surface_settings surface; /* what is not given is that of the cylinder */

    int has_truss, has_truss_import; /* sections; the import's files as those of the net */
    hf_truss_settings truss;
    char truss_nodes_path[HF_PATH_SIZE], truss_members_path[HF_PATH_SIZE];
} hf_case;

/* Read and validate. `overrides`: n "path=value" strings that win over the file. All faults in one go as
 * file:line:col; HF_BAD_CASE then. HF_NO_MEMORY. Free with hf_case_free in any case. */
hf_status hf_config_load(const char *path, const char *const *overrides, int n_override, hf_case *settings,
                         hf_messages *messages);

/* The same of the text of a case file; `path` says where it was, for messages and for the files it names. */
hf_status hf_config_parse(const char *path, const char *text, const char *const *overrides, int n_override,
                          hf_case *settings, hf_messages *messages);

/* The keys in which two cases differ, "form.stop, optimize.seed", into text[size] (cut short when it is full). Returns
 * how many there are. */
int hf_config_differences(const hf_case *a, const hf_case *b, char *text, size_t size);

/* The scene that the case describes, checked (hf_scene_check). HF_OK; HF_BAD_CASE, files that cannot be read included;
 * HF_NO_MEMORY. Free the scene in any case. */
hf_status hf_config_scene(const hf_case *settings, hf_scene *scene, hf_messages *messages);

/* The truss of a case that has one, checked (hf_truss_check). Errors as hf_config_scene. Free the truss in any case. */
hf_status hf_config_truss(const hf_case *settings, hf_truss *truss, hf_messages *messages);

void hf_case_free(hf_case *settings);

/* Would this value, as it stands in a case file, do for the key? HF_OK, or HF_BAD_CASE with "<place>: <key>:
 * <why not>". field: index into hf_field_table. What joins several keys is for hf_config_load. */
hf_status hf_config_check_value(int field, const char *value, const char *place, hf_messages *messages);

/* The table itself, for printing the reference. */
typedef enum {
    HF_FIELD_DOUBLE,
    HF_FIELD_INT,
    HF_FIELD_UINT64,
    HF_FIELD_INT_PAIR,
    HF_FIELD_WORD,
    HF_FIELD_TEXT,
    HF_FIELD_DOUBLE_LIST /* hf_double_list */
} hf_field_type;

typedef struct {
    const char *path; /* "form.pretension_N" */
    hf_field_type type;
    size_t offset;             /* in hf_case */
    double min, max;           /* inclusive; min HF_ABOVE_ZERO: exclusive 0; text: max is the size of the buffer */
    const char *default_value; /* as written in a case file; NULL = required when its section is there; "" = nothing */
    const char *unit;          /* "" = dimensionless */
    const char *const *words;  /* of a WORD, NULL-terminated */
    const char *help;
} hf_field;

typedef struct {
    const char *path;      /* "scene.import" */
    size_t present_offset; /* of the int in hf_case that is 1 when the section is there */
    const char *help;
} hf_section;

#define HF_ABOVE_ZERO 1e-300 /* the min of a field that must be positive */

extern const hf_field hf_field_table[]; /* [hf_n_field], by section */
extern const int hf_n_field;
extern const hf_section hf_section_table[];
extern const int hf_n_section;

#ifdef __cplusplus
}
#endif
#endif
