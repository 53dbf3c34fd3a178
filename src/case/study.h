/* study - a sweep: the axes that a study file gives over keys of a base case, and the points that they span.
 *
 *     base: reflector.yaml              # relative to this file; without it, this file is the case itself
 *     title: which pretension?          # without it that of the case
 *     sweep:
 *       form.pretension_N: [8, 10, 12]
 *       scene.parabolic_cylinder.scallop: {from: 0.05, to: 0.15, n: 11, spacing: linear}   # or log
 *       optimize.range_N: {from: 0.5, to: 2, sample: sobol}   # or latin_hypercube; all sampled axes are one axis of n
 *       n: 64               # points along every range that has no n of its own
 *       combine: product    # or zip: all axes side by side
 *       seed: 1             # of the latin hypercube
 *       files: auto         # a result file per point: auto = with an optimize section, all, none
 *
 * A point is named by what it sets, not by its number: its id is the beginning of the SHA-256 of its sorted lines
 * "key=value". Points of an axis that grows keep their names, their files and their seeds. */
#ifndef HIFDM_STUDY_H
#define HIFDM_STUDY_H

#include "case/config_key.h"
#include <stdbool.h>

#define HF_STUDY_AXIS_MAX 32
#define HF_STUDY_POINT_MAX 1000000
#define HF_STUDY_TABLE_MAX 5
#define HF_STUDY_ID_SIZE 13 /* 12 hexadecimal digits */
#define HF_STUDY_FINGERPRINT_SIZE 17

extern const char *const hf_study_files_word[3];
typedef enum { HF_FILES_AUTO, HF_FILES_ALL, HF_FILES_NONE } hf_study_files;

typedef struct {
    hf_key key;
    int line, column;
    bool is_sampled;
    int n_value;
    char **canonical; /* [n_value] "key=value", one way to write each value: 10, not 1e1 */
    char **set;       /* [n_value] the same as an override of hf_config_load: paths lead from the current folder */
} hf_study_axis;

typedef struct {
    uint64_t number; /* the id, read as a number */
    int point;
} hf_study_name;

typedef struct {
    char path[HF_PATH_SIZE];                      /* of the study file */
    char base[HF_PATH_SIZE];                      /* of the case; the same in the one-file form */
    char title[256];                              /* its own, or that of the case; "": none */
    char table[HF_STUDY_TABLE_MAX][HF_PATH_SIZE]; /* that the first point imports; "": none */
    bool is_zip;
    hf_study_files files;
    int n_axis;
    hf_study_axis axis[HF_STUDY_AXIS_MAX]; /* sorted by key */
    int n_point;
    int *value;                   /* [n_point][n_axis] index of the value */
    char (*id)[HF_STUDY_ID_SIZE]; /* [n_point] */
    hf_study_name *by_id;         /* [n_point] sorted */
    bool has_optimize;            /* the points have an optimize section */
    bool has_tolerance;           /* and one with tolerances */
    bool derives_seed;            /* optimize.seed is no axis: every point has a seed of its own */
    uint64_t seed;                /* optimize.seed of the base case */
    char fingerprint
        [HF_STUDY_FINGERPRINT_SIZE]; /* of the base case; results that carry another one belong to another study */
} hf_study;

/* The overrides of one point. They point into the study and into this struct: neither may move. */
typedef struct {
    const char *set[HF_STUDY_AXIS_MAX + 1];
    int n_set;
    char seed[48];
} hf_study_overrides;

/* Is it a study, a YAML file with a base or a sweep section? False for what cannot be read. */
bool hf_study_is(const char *path);

/* Reads a study and checks each value of each axis against the table of config.h: HF_BAD_CASE with all faults, each
 * with file, line, column and axis, and where no point can be loaded as a case; HF_NO_MEMORY. A point whose values do
 * not go together is no fault of the study: it fails when it is run. Free in any case. */
hf_status hf_study_read(const char *path, hf_study *study, hf_messages *messages);
void hf_study_free(hf_study *study);

/* What point i sets. Unless optimize.seed is an axis, it is set too, from the seed of the base case and the point's id,
 * so that no two points share their random numbers. */
void hf_study_point_overrides(const hf_study *study, int i, hf_study_overrides *overrides);

/* The point with this id; -1: there is none. */
int hf_study_find(const hf_study *study, const char *id);

/* Point k of an order in which any first few points are spread over all axes, k < n_point. */
int hf_study_spread(const hf_study *study, int k);

/* "key=value, key=value" for people, cut off with "..." where it is too long. */
void hf_study_point_text(const hf_study *study, int i, char *text, size_t size);

/* Report the faults that loading point i has found; each message names the point. */
void hf_study_tell_faults(const hf_study *study, int i, const hf_messages *found, hf_messages *messages);

/* Do the points get result files? */
bool hf_study_has_files(const hf_study *study);

/* ---- between study and study_read ---- */

/* A value of an axis {from, to} at x in 0..1, linear or logarithmic; whole for whole-number keys. */
void hf_study_range_value(const hf_field *field, double from, double to, bool is_log, double x, char text[40]);

/* n samples in n_axis dimensions, x[n][n_axis] in 0..1. Sobol's first points stay when n grows, those of a latin
 * hypercube do not. HF_OK or HF_NO_MEMORY. n_axis <= 40. */
hf_status hf_study_sobol(int n, int n_axis, double *x);
hf_status hf_study_latin_hypercube(int n, int n_axis, uint64_t seed, double *x);

/* Sets n_point from n_value of the axes, whose values need not be there yet. HF_BAD_CASE for too many points. */
hf_status hf_study_count_points(hf_study *study, hf_messages *messages);

/* Makes the points and their ids from the axes, and loads one of them as a case, which finds the faults of the base. */
hf_status hf_study_make_points(hf_study *study, hf_messages *messages);

/* "key=value" with the value in its canonical form; the caller frees it; NULL without memory. The value must be valid
 * for the key. */
char *hf_study_canonical(const hf_key *key, const char *value);

#endif
