/* ledger - the state of the points of a study, in a folder into which any number of processes, on any number of
 * machines that share it, write at the same time.
 *
 *   points-HOST-PID.tsv   a line per finished point, by the process that finished it: id, fingerprint of the base
 *                         case, status, reason, every number of hf_summary, the goals and the errors of the surface
 *                         of each stage, the states. One write(2) each; an incomplete line is ignored.
 *   claims                no content: the process that runs a point holds a record lock on the byte at the offset that
 *                         the point's id gives as a number; the system releases it when the process ends.
 *   ID-FINGERPRINT.h5     result files of points that have one; of the fingerprint the first digits: runs of different
 *                         base cases never share a file. */
#ifndef HIFDM_LEDGER_H
#define HIFDM_LEDGER_H

#include "base/file_io.h"
#include "store/layout.h"
#include "case/study.h"

#include <hifdm/summary.h>
#include <pthread.h>

/* ---- The numbers of a point ---- */

int hf_ledger_n_column(void);
const hf_hdf5_member *hf_ledger_column(int i); /* a member of hf_summary, never of HF_KIND_CHARS */

/* Does the column depend on the machine and its load? Times and the number of threads do. */
bool hf_ledger_is_circumstance(const hf_hdf5_member *column);

/* ---- The fields of a row: these numbers, then lists "name=value name=value" as texts (ledger_fields.c) ---- */

/* The goals of each stage, then the errors of its surface, of facets where there are some, else of nodes, then the
 * figures of the states of the net as built, whose names are STATE.NAME here and STATE/NAME in a merge. */
enum { HF_LEDGER_LIST_CASES = 2 * HF_LAYOUT_N_GOALS_STAGE, HF_LEDGER_N_LIST };
#define HF_LEDGER_CASES "/cases"
typedef struct {
    const char *field;          /* what a row calls it, behind group and prefix */
    const char *group, *prefix; /* where a merge has its values, below /points: the group, what data sets begin with */
    const char *begin;          /* what the names of its values begin with */
} hf_ledger_list;
extern const hf_ledger_list hf_ledger_list_of[HF_LEDGER_N_LIST];

int hf_ledger_n_field(void); /* HF_LEDGER_N_LIST more than columns */
int hf_ledger_field_name(int i, char *text, size_t size);
int hf_ledger_print_field(int i, const hf_summary *summary, char *text, size_t size); /* nothing: not applicable */

/* Take the next value from the text of a list, which moves behind it; false at the end, or where it is damaged. */
bool hf_ledger_next_value(int list, const char **text, char name[HF_GOAL_NAME_SIZE], double *value);
const char *hf_ledger_goal(const char *name);      /* "tension_edge" of goal_1_tension_edge */
const char *hf_ledger_goal_unit(const char *name); /* of goal_1_tension_edge: N */
const char *hf_ledger_unit(const char *name);      /* the same, and of names that end in their unit */

/* ---- Writing ---- */

typedef struct {
    char folder[HF_PATH_SIZE];
    int rows, claims; /* file descriptors, -1 */
    int64_t size;     /* of the whole lines that this process has written into `rows` */
    double synced_s;
    pthread_mutex_t lock;
    struct hf_ledger_news *news; /* NULL before hf_ledger_watch */
} hf_ledger;

/* Makes the folder when it is not there. HF_OK or HF_IO. Close in any case: HF_IO when rows may not be on the disk. */
hf_status hf_ledger_open(const char *folder, hf_ledger *ledger, hf_messages *messages);
hf_status hf_ledger_close(hf_ledger *ledger, hf_messages *messages);

/* Claim the point for this process. On a file system without locks only shards keep processes apart. */
hf_lock hf_ledger_claim(hf_ledger *ledger, const char *id);
void hf_ledger_release(hf_ledger *ledger, const char *id);

/* Begin to watch which points any process finishes. Call it before hf_ledger_read. HF_OK or HF_NO_MEMORY. */
hf_status hf_ledger_watch(hf_ledger *ledger, const hf_study *study, hf_messages *messages);

/* Has the point been finished since hf_ledger_watch, with success or not? Call it after claiming the point. From any
 * thread. */
bool hf_ledger_is_finished(hf_ledger *ledger, const hf_study *study, int point);

/* A finished point, from any thread. reason: one line, "" after success; what is longer than HF_LEDGER_REASON_MAX bytes
 * is cut. HF_OK or HF_IO. */
#define HF_LEDGER_REASON_MAX 4000
hf_status hf_ledger_write(hf_ledger *ledger, const hf_study *study, int point, hf_status status, const char *reason,
                          const hf_summary *summary, hf_messages *messages);

/* Set the path of the point's result file; returns what is there. HF_LEDGER_UNSEEN and errno: the system cannot tell.
 */
typedef enum { HF_LEDGER_NO_FILE, HF_LEDGER_EMPTY_FILE, HF_LEDGER_FILE, HF_LEDGER_UNSEEN } hf_ledger_content;
hf_ledger_content hf_ledger_file(const char *folder, const hf_study *study, int point, char path[HF_PATH_SIZE + 32]);

/* ---- Reading ---- */

typedef enum {
    HF_POINT_MISSING,
    HF_POINT_RUNNING, /* by a living process */
    HF_POINT_DONE,
    HF_POINT_FAILED,
    HF_POINT_OUTDATED, /* finished, but of another base case */
    HF_N_POINT_STATE
} hf_point_state;
extern const char *const hf_point_state_word[HF_N_POINT_STATE];

typedef struct {
    hf_point_state state;
    hf_status status;   /* HF_NOT_EVALUATED unless done or failed */
    const char *reason; /* "" unless failed */
    char *const *field; /* [hf_ledger_n_field()] as text, "" = not applicable; NULL unless done or failed */
} hf_point;

typedef struct {
    hf_point *point; /* [n_point] in the order of the study */
    int n_point, count[HF_N_POINT_STATE];
    int n_lost;  /* of the missing ones: finished once, but the result file is gone or begun anew */
    char **text; /* contents of the files; reasons and fields point into them */
    char ***fields;
    int n_text, n_field_block;
} hf_points;

/* Read the state of the study's points. Without the folder all are missing. HF_OK; HF_IO, also when a name of ours is
 * that of no ordinary file or of one that is longer than rows can be; HF_NO_MEMORY. Free in any case. */
hf_status hf_ledger_read(const char *folder, const hf_study *study, hf_points *points, hf_messages *messages);
void hf_points_free(hf_points *points);

/* How many of the missing points have a result file that a sweep began. */
int hf_ledger_n_begun(const char *folder, const hf_study *study, const hf_points *points);

#endif
