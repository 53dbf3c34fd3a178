/* merged - a merged study as people are shown it: axes, points, the figures of each stage, which of these vary, and
 * which point is best. The page of `hifdm report` and the table of `hifdm show` are made from it. */
#ifndef HIFDM_MERGED_H
#define HIFDM_MERGED_H

#include "case/study.h"
#include "store/store_series.h"

/* Stages of a run, the net as built (`tolerance`), and its states (`cases`). */
typedef enum {
    HF_MERGED_FORM,
    HF_MERGED_OPTIMIZE,
    HF_MERGED_POLISH,
    HF_MERGED_BUILT,
    HF_MERGED_CASES,
    HF_MERGED_N_STAGE
} hf_merged_stage;
extern const char *const hf_merged_stage_word[HF_MERGED_N_STAGE];

/* Does a point meet the yield that its case wants? Open: the wanted one is within the 95 % interval of its samples. */
typedef enum { HF_MERGED_NOT_ASKED, HF_MERGED_NO, HF_MERGED_OPEN, HF_MERGED_YES, HF_MERGED_N_ANSWER } hf_merged_answer;
extern const char *const hf_merged_answer_word[HF_MERGED_N_ANSWER]; /* "", "no", "open", "yes" */

typedef struct {
    hf_merged_stage stage;
    char state[HF_SET_NAME_SIZE]; /* of `cases`; "" of other stages */
    char key[HF_GOAL_NAME_SIZE];  /* psi_m, goal_1_tension_edge, facet_half_path_rms_m, ... */
    hf_series value;              /* [n]; NaN where a point has none */
    bool is_same;                 /* at all points that are done, but for rounding; also: no value at all of them */
    bool is_psi;                  /* a goal that is psi of this stage at all points */
} hf_merged_figure;

#define HF_MERGED_FIGURE_MAX 1536
#define HF_MERGED_RESOLVED_M 1e-9 /* lengths below it are what rounding leaves */

typedef struct {
    const char *path; /* borrowed */
    int n;            /* points */
    hf_texts id, reason, title, input_name;
    hf_series status;                       /* [n] hf_status */
    hf_series input[HF_STUDY_AXIS_MAX];     /* [n] or [n][2] of axis a, */
    hf_texts input_text[HF_STUDY_AXIS_MAX]; /* or, of axes whose values are words or seeds, [n] */
    int n_axis;
    int n_figure;
    hf_merged_figure figure[HF_MERGED_FIGURE_MAX]; /* by stage */
    hf_merged_stage main;                          /* the stage that is the result */
    int lead, best; /* the figure that says which point is best: it has the least value there; -1: none varies */
} hf_merged;

/* True when the file has a table of points. False for any other file, also for one that cannot be read. */
bool hf_merged_is(const char *path);

/* HF_OK, HF_IO or HF_NO_MEMORY with a message. Free in any case. */
hf_status hf_merged_read(const char *path, hf_merged *merged, hf_messages *messages);
void hf_merged_free(hf_merged *merged);

bool hf_merged_is_done(const hf_merged *merged, int point);
bool hf_merged_axis_varies(const hf_merged *merged, int axis);

/* The figure of this stage, of the first state that has it; NULL without it. */
const hf_merged_figure *hf_merged_find(const hf_merged *merged, hf_merged_stage stage, const char *key);

/* A loss of gain without a value: is there a surface, whose loss is more than Ruze's formula holds for? */
bool hf_merged_is_beyond(const hf_merged *merged, const hf_merged_figure *loss, int point);

/* Where the best point lies at an end of this axis and the figure that says which is best still falls towards it, over
 * the last two steps and beyond rounding, between points that agree in all other axes: 1 at the largest value, -1 at
 * the smallest. Else 0; of an axis of errors, too, of which less is better anyway. */
int hf_merged_falls_on(const hf_merged *merged, int axis);

hf_merged_answer hf_merged_meets_yield(const hf_merged *merged, int point);
double hf_merged_wanted_yield(const hf_merged *merged); /* of all points; NaN: of none, or not one and the same */

/* The title of the study or, without one, the name of the merged file. */
const char *hf_merged_heading(const hf_merged *merged);

#endif
