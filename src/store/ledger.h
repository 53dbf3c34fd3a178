/* ledger - the state of the points of a study, in a folder. Any number of processes, on any number of machines that
 * share the folder, write into it at the same time.
 *
 *   points-HOST-PID.tsv   one line per finished point, written by the process that finished it: id, fingerprint of the
 *                         base case, status, reason, every number of hf_summary, the objectives and the surface errors
 *                         of each stage, the load cases. Each line is one write(2); an incomplete line is ignored.
 *   claims                an empty file. The process that runs a point holds a record lock on one byte of it. The
 *                         offset of the byte is the id of the point as a number. The lock ends with the process.
 *   ID-FINGERPRINT.h5     the result file of a point, if it has one. FINGERPRINT are the first 8 digits of that of the
 *                         base case, so that runs of different base cases never share a file. */
#pragma once

#include "base/file_io.h"
#include "store/layout.h"
#include "case/study.h"

#include <hifdm/summary.h>
#include <pthread.h>

/* ---- The numbers of a point ---- */

/* A number of the summary: member of the owner of its part (hf_layout_owner), and the object that has it in a file. */
typedef struct {
    const char *object;
    hf_layout_part part;
    const hf_result_field *field; /* never a text */
} hf_ledger_number;

/* hf_ledger_n_column returns the number of columns. hf_ledger_column sets *number to that of column i, and returns
 * false after the last one. */
int hf_ledger_n_column(void);
bool hf_ledger_column(int i, hf_ledger_number *number);

/* Returns true if the column depends on the machine and its load. These are the times and the number of threads. */
bool hf_ledger_is_circumstance(const hf_ledger_number *number);

/* ---- The fields of a row: the numbers, then lists as texts (ledger_fields.c) ---- */

/* The lists of a row, each a text "name=value name=value": the objectives of each stage, the surface errors of each
 * stage, the figures of the load cases, and the verdicts on the rows of `requirements`. The surface errors are those of
 * the facets if there are any, else those of the nodes. The names of load cases are NAME.FIGURE here and NAME/FIGURE in
 * a merge. The verdicts are n_failed, n_undecided and relative_margin_min, and for row k verdict_k (of hf_verdict),
 * value_k, at_least_k, at_most_k, margin_k and relative_margin_k. */
enum { HF_LEDGER_LIST_CASES = 2 * HF_N_STAGE, HF_LEDGER_LIST_REQUIREMENTS, HF_LEDGER_N_LIST };
#define HF_LEDGER_LOAD_CASES "/load_cases"
#define HF_LEDGER_REQUIREMENTS "/requirements"
#define HF_LEDGER_REQUIREMENT_SIZE 256 /* size in bytes of the name of a requirement */
typedef struct {
    const char *field; /* name of the list in a header, after its group */
    const char *group; /* in a merge: group of its values below /points */
    const char *begin; /* prefix of the names of its values */
} hf_ledger_list;
extern const hf_ledger_list hf_ledger_list_of[HF_LEDGER_N_LIST];

/* Returns the figure of a requirement from its name, which begins with it; HF_REQUIRED_N_FIGURE: none. */
hf_required_figure hf_ledger_figure(const char *requirement);

/* hf_ledger_n_field returns the number of fields: the columns, the lists, and the names of the requirements, which ';'
 * separates. hf_ledger_names_field returns the index of the last. hf_ledger_field_name writes the name of field i into
 * text[size]. hf_ledger_print_field writes its value, and nothing if the field does not apply. Both return the number
 * of bytes, like snprintf. */
int hf_ledger_n_field(void);
int hf_ledger_names_field(void);
int hf_ledger_field_name(int i, char *text, size_t size);
int hf_ledger_print_field(int i, const hf_summary *summary, char *text, size_t size);

/* Takes the next value from the text of a list and moves *text behind it. Returns false at the end of the list, or if
 * the list is damaged. */
bool hf_ledger_next_value(int list, const char **text, char name[HF_OBJECTIVE_NAME_SIZE], double *value);
const char *hf_ledger_objective(const char *name);      /* returns "tension_edge" for objective_1_tension_edge */
const char *hf_ledger_objective_unit(const char *name); /* returns the unit of such a name, here "N" */
const char *hf_ledger_unit(const char *name);           /* returns the unit of any name in a list */

/* ---- Writing ---- */

typedef struct {
    char folder[HF_PATH_SIZE];
    int rows, claims; /* file descriptors, or -1 */
    int64_t size;     /* bytes of the whole lines in `rows` */
    double synced_s;
    pthread_mutex_t lock;
    struct hf_ledger_news *news; /* NULL before hf_ledger_watch */
} hf_ledger;

/* Opens the ledger, and makes the folder if it does not exist. Returns HF_OK or HF_IO. The caller calls hf_ledger_close
 * in any case. hf_ledger_close returns HF_IO if rows may not be on the disk. */
hf_status hf_ledger_open(const char *folder, hf_ledger *ledger, hf_messages *messages);
hf_status hf_ledger_close(hf_ledger *ledger, hf_messages *messages);

/* Claims the point for this process, or releases it. On a file system without locks only shards keep processes
 * apart. */
hf_lock hf_ledger_claim(hf_ledger *ledger, const char *id);
void hf_ledger_release(hf_ledger *ledger, const char *id);

/* Begins to watch which points any process finishes. The study is borrowed. The caller calls it before hf_ledger_read.
 * Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_ledger_watch(hf_ledger *ledger, const hf_study *study, hf_messages *messages);

/* Returns true if the point was finished after hf_ledger_watch, successfully or not. The caller has claimed the point
 * before. Any thread may call it. */
bool hf_ledger_is_finished(hf_ledger *ledger, int point);

/* Writes the row of a finished point. Any thread may call it. reason: one line, "" after success, cut off after
 * HF_LEDGER_REASON_MAX bytes. Returns HF_OK, HF_IO or HF_NO_MEMORY. */
#define HF_LEDGER_REASON_MAX 4000
hf_status hf_ledger_write(hf_ledger *ledger, const hf_study *study, int point, hf_status status, const char *reason,
                          const hf_summary *summary, hf_messages *messages);

/* Writes the path of the result file of a point into `path`, and returns what is there. HF_LEDGER_UNSEEN: the system
 * cannot tell, and errno has the reason. */
typedef enum { HF_LEDGER_NO_FILE, HF_LEDGER_EMPTY_FILE, HF_LEDGER_FILE, HF_LEDGER_UNSEEN } hf_ledger_content;
hf_ledger_content hf_ledger_file(const char *folder, const hf_study *study, int point, char path[HF_PATH_SIZE + 32]);

/* ---- Reading ---- */

typedef enum {
    HF_POINT_MISSING,
    HF_POINT_RUNNING, /* a living process runs it */
    HF_POINT_DONE,
    HF_POINT_FAILED,
    HF_POINT_OUTDATED, /* finished, but with another base case */
    HF_N_POINT_STATE
} hf_point_state;
extern const char *const hf_point_state_word[HF_N_POINT_STATE];

typedef struct {
    hf_point_state state;
    hf_status status;   /* HF_NOT_EVALUATED unless done or failed */
    const char *reason; /* "" unless failed */
    /* [hf_ledger_n_field()] The fields as texts, "" = not applicable; NULL unless done or failed. */
    char *const *field;
} hf_point;

typedef struct {
    hf_point *point; /* [n_point] in the order of the study */
    int n_point, count[HF_N_POINT_STATE];
    int n_lost;   /* missing points that were finished once, but whose result file is gone or begun again */
    void **block; /* [n_block] contents of the files, into which reasons and fields point, and lists of fields */
    int n_block;
} hf_points;

/* Reads the state of the points of the study. If the folder does not exist, all points are missing. Returns HF_OK;
 * HF_IO, also if a file of the ledger is no ordinary file or is longer than its rows can be; HF_NO_MEMORY. The caller
 * calls hf_points_free in any case. */
hf_status hf_ledger_read(const char *folder, const hf_study *study, hf_points *points, hf_messages *messages);
void hf_points_free(hf_points *points);

/* Returns how many of the missing points have a result file that a sweep has begun. */
int hf_ledger_n_begun(const char *folder, const hf_study *study, const hf_points *points);
