/* study - a sweep: the axes that a study file defines over keys of a base case, and the points that they span.
 *
 *     base: reflector.yaml              # relative to this file; without it, this file is the case itself
 *     title: which pretension?          # without it that of the case
 *     sweep:
 *       form.pretension_N: [8, 10, 12]
 *       scene.parabolic_cylinder.scallop: {from: 0.05, to: 0.15, n: 11, spacing: linear}   # or log
 *       optimize.range_N: {from: 0.5, to: 2, sample: sobol}   # or latin_hypercube; all sampled axes are one axis of n
 *       n: 64               # points along every range that has no n of its own
 *       combine: product    # or zip: all axes side by side
 *       replicates: 15      # runs of each combination, each with a seed of its own: an axis `replicate` of 1 to 15
 *       seed: 1             # of the latin hypercube
 *       files: auto         # a result file per point: auto = with an optimize section, all, none
 *
 * A point is identified by its values, not by its number. Its id is the first 12 digits of the SHA-256 of its sorted
 * lines "key=value", with the names of version 0.2. If an axis grows, or a version renames a key, the existing points
 * keep their ids, files and seeds. Replicate 1 has no line, so that it is the point of a study without replicates. */
#pragma once

#include "case/config_key.h"
#include <stdbool.h>
#include <string.h>

#define HF_STUDY_AXIS_MAX 32
#define HF_STUDY_POINT_MAX 1000000
#define HF_STUDY_TABLE_MAX 5
#define HF_STUDY_REPLICATES_MAX 1000
#define HF_STUDY_REPLICATE "replicate" /* name of the axis of the replicates, which is no key of a case */
#define HF_STUDY_ID_SIZE 13            /* 12 hexadecimal digits */
#define HF_STUDY_FINGERPRINT_SIZE 17

extern const char *const hf_study_files_word[3];
typedef enum { HF_FILES_AUTO, HF_FILES_ALL, HF_FILES_NONE } hf_study_files;

typedef struct {
    hf_key key;
    int line, column;
    bool is_sampled, is_replicate;
    int n_value;
    char **canonical; /* [n_value], "key=value" with one spelling for each value: 10, not 1e1 */
    char **set;       /* [n_value], the same as an override of hf_config_load: paths start from the current folder */
} hf_study_axis;

/* Returns value k of the axis as text, without its key. */
static inline const char *hf_study_axis_value(const hf_study_axis *axis, int k)
{
    return strchr(axis->canonical[k], '=') + 1;
}

typedef struct {
    uint64_t number; /* the id as a number */
    int point;
} hf_study_name;

typedef struct {
    char path[HF_PATH_SIZE];                      /* path of the study file */
    char base[HF_PATH_SIZE];                      /* path of the case; the same as `path` if there is no key base */
    char title[256];                              /* its own title, or that of the case; "": none */
    char table[HF_STUDY_TABLE_MAX][HF_PATH_SIZE]; /* tables that the first point imports; "": none */
    bool is_zip;
    hf_study_files files;
    int n_axis;
    hf_study_axis axis[HF_STUDY_AXIS_MAX]; /* sorted by key, as version 0.2 names it */
    int n_replicate; /* points of each combination of the other axes, which stand side by side; 0: no such axis */
    int n_point;
    int *value;                   /* [n_point][n_axis], index of the value */
    char (*id)[HF_STUDY_ID_SIZE]; /* [n_point] */
    hf_study_name *by_id;         /* [n_point], sorted */
    bool has_optimize;            /* the points have a section optimize */
    bool has_search;              /* they draw random numbers for it, unlike with the method lm */
    bool derives_seed;            /* true: every point has a seed of its own; optimize.seed is no axis */
    uint64_t seed;                /* optimize.seed of the base case */
    char fingerprint
        [HF_STUDY_FINGERPRINT_SIZE]; /* digest of the base case; results with another one belong to another study */
} hf_study;

/* The overrides of one point. They point into the study and into this struct; neither may move in memory. */
typedef struct {
    const char *set[HF_STUDY_AXIS_MAX + 1];
    int n_set;
    char seed[48];
} hf_study_overrides;

/* Returns true if the file is a study: a YAML file with a key base or sweep. Returns false if it cannot be read. */
bool hf_study_is(const char *path);

/* Reads a study and checks each value of each axis against the table of config.h. Returns HF_OK. Returns HF_BAD_CASE
 * after reporting all faults, each with file, line, column and axis; also if no point can be loaded as a case. Returns
 * HF_NO_MEMORY. Values that do not fit together are no fault of the study: such a point fails when it is run. Call
 * hf_study_free in every case. */
hf_status hf_study_read(const char *path, hf_study *study, hf_messages *messages);
void hf_study_free(hf_study *study);

/* Writes the overrides of point i. If derives_seed is true, they also set optimize.seed, computed from the seed of the
 * base case and the id of the point. So no two points share their random numbers. */
void hf_study_point_overrides(const hf_study *study, int i, hf_study_overrides *overrides);

/* Returns the point with this id, or -1. */
int hf_study_find(const hf_study *study, const char *id);

/* Returns point k of an order in which the first few points are always spread over all axes. k < n_point. */
int hf_study_spread(const hf_study *study, int k);

/* Writes "key=value, key=value" for messages. A text that is too long ends with "...". */
void hf_study_point_text(const hf_study *study, int i, char *text, size_t size);

/* Reports the faults that were found when point i was loaded. Each message contains the values of the point. */
void hf_study_tell_faults(const hf_study *study, int i, const hf_messages *found, hf_messages *messages);

/* Returns true if the points get result files. */
bool hf_study_has_files(const hf_study *study);

/* ---- shared by study.c and study_read.c ---- */

/* Writes the value of an axis {from, to} at x in 0..1, linear or logarithmic. It is an integer for integer keys. */
void hf_study_range_value(const hf_field *field, double from, double to, bool is_log, double x, char text[40]);

/* Compute n samples in n_axis <= 40 dimensions, x [n][n_axis] in 0..1. The first points of a Sobol sequence stay the
 * same when n grows; those of a latin hypercube change. Return HF_OK or HF_NO_MEMORY. */
hf_status hf_study_sobol(int n, int n_axis, double *x);
hf_status hf_study_latin_hypercube(int n, int n_axis, uint64_t seed, double *x);

/* Sets n_point from n_value of the axes; their values need not exist yet. Returns HF_OK, or HF_BAD_CASE if there are
 * too many points or the axes of a zip differ in length. */
hf_status hf_study_count_points(hf_study *study, hf_messages *messages);

/* Makes the points and their ids from the axes. Loads one point as a case, and thereby finds faults of the base case.
 * Returns HF_OK, HF_BAD_CASE, HF_IO or HF_NO_MEMORY. */
hf_status hf_study_make_points(hf_study *study, hf_messages *messages);

/* Returns "key=value" with the value in canonical form. The caller frees it; NULL if memory runs out. The value must be
 * valid for the key. */
char *hf_study_canonical(const hf_key *key, const char *value);
