/* merged - a merged study prepared for display: its axes, its points, the figures of each stage, which of these vary,
 * and the best point. The page of `hifdm report` and the table of `hifdm show` use it. */
#pragma once

#include "case/study.h"
#include "store/store_series.h"
#include <hifdm/requirements.h>

/* The stages of a run, the as-built net (`tolerance`), its load cases (`load_cases`) and the requirements. */
typedef enum {
    HF_MERGED_FORM = HF_STAGE_FORM,
    HF_MERGED_SEARCH = HF_STAGE_SEARCH,
    HF_MERGED_REFINE = HF_STAGE_REFINE,
    HF_MERGED_BUILT = HF_N_STAGE,
    HF_MERGED_LOAD_CASES,
    HF_MERGED_REQUIREMENTS
} hf_merged_stage;

typedef struct {
    hf_merged_stage stage;
    char load_case[HF_SET_NAME_SIZE]; /* load case of HF_MERGED_LOAD_CASES; "" for other stages */
    char key[HF_OBJECTIVE_NAME_SIZE]; /* such as psi_m, objective_1_tension_edge or facet_half_path_rms_m */
    hf_series value;                  /* [n]; NaN where a point has no value */
    bool is_same; /* equal at all completed points up to rounding, or without a value at all of them */
    bool is_psi;  /* an objective that equals psi of this stage at all points, up to rounding */
} hf_merged_figure;

/* What a point has to meet: the rows of `requirements` with a verdict. Points rank by the
 * number of requirements that fail, then by the number of undecided ones, then by the smallest relative margin. */
typedef struct {
    hf_verdict verdict; /* HF_VERDICT_NONE: nothing is required, or the point is not done */
    hf_judgement of;    /* without its margin, which ranks points as one of the figures, because of rounding */
    int tightest;       /* row that decides: the first of those that fail, else of the undecided ones,
                                            else of all, by relative margin; -1: none */
} hf_merged_judgement;

/* The replicates of one combination of the other axes: consecutive points. The ranking figure has these statistics over
 * the replicates that are done; a failed replicate and one without a value rank last, as infinite. Quartiles are
 * interpolated between the sorted values, of which the first has position 0 and the last 1. */
typedef enum {
    HF_MERGED_MINIMUM,
    HF_MERGED_LOWER_QUARTILE,
    HF_MERGED_MEDIAN,
    HF_MERGED_UPPER_QUARTILE,
    HF_MERGED_MAXIMUM,
    HF_MERGED_N_STATISTIC
} hf_merged_statistic;
extern const char *const hf_merged_statistic_word[HF_MERGED_N_STATISTIC]; /* "minimum", "lower_quartile", ... */

typedef struct {
    int first, n;                            /* its points */
    int n_run;                               /* replicates that are done or have failed */
    int best;                                /* best point of the group; -1: none is done */
    int rank;                                /* from 0, by the verdict and the value of the median */
    double statistic[HF_MERGED_N_STATISTIC]; /* SI units; NaN: it has no value */
} hf_merged_group;

#define HF_MERGED_DIFFER_P 0.01 /* groups differ if the p-value of the rank test is below */
#define HF_MERGED_DIFFER_N 5    /* fewer replicates cannot give such a p-value */

#define HF_MERGED_FIGURE_MAX 1536
#define HF_MERGED_LEADS_MAX 3

typedef struct {
    const char *path; /* borrowed */
    int n;            /* number of points */
    hf_texts id, reason, title, input_name;
    hf_series status;                       /* [n] values of hf_status */
    hf_series input[HF_STUDY_AXIS_MAX];     /* [n] or [n][2] values of axis a */
    hf_texts input_text[HF_STUDY_AXIS_MAX]; /* [n] values of an axis of words or seeds */
    int n_axis;
    int n_inner_node, n_free; /* the nodes that psi counts, and all free nodes; 0: points differ, or do not say it */
    int n_figure;
    hf_merged_figure figure[HF_MERGED_FIGURE_MAX]; /* in the order of the stages */
    hf_merged_stage main; /* the stage that is the result; where that is the search, REFINE has its figures */
    bool is_mixed;        /* REFINE has figures of the search at a point, so it is called "result" */
    int n_row;            /* number of rows of `requirements`; 0: the study has none */
    hf_texts row_name;    /* [n_row] names of the rows */
    hf_series row_verdict, row_margin, row_relative_margin; /* [n][n_row] hf_verdict, margin, relative margin */
    /* [n][n_row] value and bounds of each row; NaN: none. The series are empty in files of earlier versions. */
    hf_series row_value, row_at_least, row_at_most;
    hf_merged_judgement *judgement; /* [n] owned */
    /* The figures that rank the points, after what they fail (hf_merged_is_judged): the next one ranks points that are
     * equal in those before. Values up to `floor` are equal, and so are margins that print as 0. */
    struct {
        int figure[HF_MERGED_LEADS_MAX], n, most;
        double floor[HF_MERGED_LEADS_MAX];
    } leads;
    /* The first of them in which points with the verdicts of the best one differ, and the best point; -1 when nothing
     * varies. Among these points, the best one has the minimum of this figure or, of HF_MERGED_MARGIN, its maximum. */
    int lead, best;
    int replicate;          /* the axis of the replicates; -1: none */
    int n_group;            /* 0: the study has no replicates, or nothing varies */
    hf_merged_group *group; /* [n_group] owned, in the order of the points */
    /* The two best groups, and the p-value of the Mann-Whitney U test whether they differ (out/rank_test.h). Values
     * that differ by rounding count as equal. best_group -1: no point is done. second_group -1: there is no second one,
     * and differ_p is NaN. */
    int best_group, second_group;
    double differ_p;
} hf_merged;

/* Returns the word of a stage in JSON: that of hf_stage_word, "result", "tolerance", "load_cases" or "requirements".
 * m: NULL for the word of the group in a file. */
const char *hf_merged_stage_word(const hf_merged *m, hf_merged_stage stage);

/* Key of the smallest relative margin, a figure of HF_MERGED_REQUIREMENTS. */
#define HF_MERGED_MARGIN "relative_margin_min"

/* Returns whether the file has a table of points. Returns false for any other file and for one that cannot be read. */
bool hf_merged_is(const char *path);

/* Reads a merged study. `path` is borrowed. Returns HF_OK; HF_IO or HF_NO_MEMORY with a message. Call hf_merged_free in
 * any case. */
hf_status hf_merged_read(const char *path, hf_merged *merged, hf_messages *messages);
void hf_merged_free(hf_merged *merged);

/* hf_merged_is_done returns whether the run of a point has completed with HF_OK. hf_merged_axis_varies returns whether
 * an axis has different values. */
bool hf_merged_is_done(const hf_merged *merged, int point);
bool hf_merged_axis_varies(const hf_merged *merged, int axis);

/* Returns a figure of a stage, that of the first load case that has it, or NULL. */
const hf_merged_figure *hf_merged_find(const hf_merged *merged, hf_merged_stage stage, const char *key);

/* Returns whether a missing gain loss of a point is outside the range of Ruze's formula. This is so when the surface
 * error has a value. */
bool hf_merged_is_beyond(const hf_merged *merged, const hf_merged_figure *loss, int point);

/* Returns 1 or -1 when an axis should be extended above or below its range, otherwise 0. This is so when the best point
 * is at an end of the axis and the ranking figure still improves towards it. It must improve over the last two steps by
 * more than rounding, between points that agree in all other axes. With replicates this holds for the medians of
 * groups. Returns 0 for an axis of errors, too, because
 * smaller errors are always better. */
int hf_merged_improves_on(const hf_merged *merged, int axis);

/* Returns whether any point has a verdict. The points then rank by their verdicts first. */
bool hf_merged_is_judged(const hf_merged *merged);

/* Returns the number of points at which a requirement fails. *n_judged: number of points at which it has a verdict. */
int hf_merged_failing(const hf_merged *merged, int row, int *n_judged);

/* Sets row[n_row] to the requirements in the order of their columns: first those that fail at the most points, then
 * those that decide the most points (hf_merged_judgement.tightest), then those with the smallest relative margin at the
 * best point. Returns n_row, or 0 if no point has a value of a requirement. */
int hf_merged_required(const hf_merged *merged, int row[HF_REQUIREMENT_ROWS_MAX]);

/* Returns the SI unit of a requirement; "" if the file has a figure that this version does not know. */
const char *hf_merged_unit(const hf_merged *merged, int row);

/* Returns a bound of a requirement, of row_at_least or row_at_most. NaN: there is none, or points differ in it. */
double hf_merged_bound(const hf_merged *merged, const hf_series *bound, int row);

/* Returns whether a figure is the smallest relative margin, of which more is better. -1: no figure. */
bool hf_merged_is_margin(const hf_merged *merged, int figure);

/* The part of hf_merged_read before the groups of replicates. */
hf_status hf_merged_read_points(const char *path, hf_merged *merged, hf_messages *messages);

/* Returns the absolute difference up to which values of the ranking figure count as equal. They also do up to a
 * relative difference of 1e-6 (hf_merged_is_resolved). */
double hf_merged_rounding(const hf_merged *merged);
bool hf_merged_is_resolved(double a, double b, double rounding);

/* Returns whether two points have the same value of an axis. */
bool hf_merged_agree(const hf_merged *merged, int axis, int i, int j);

/* Return the value of the ranking figure of a point or the median of a group, of which less is better: its negative for
 * a margin. Infinite: the point is not done, or there is no value. */
double hf_merged_rank_value(const hf_merged *merged, int point);
double hf_merged_median(const hf_merged *merged, const hf_merged_group *group);

/* Returns whether point i ranks before point j. Points that are equal but for rounding keep their order. */
bool hf_merged_ranks_before(const hf_merged *merged, int i, int j);

/* Lists the intervals of an axis of numbers within which all points pass, by the first and the last value of each, in
 * ascending order. All other axes are fixed; otherwise, and on an axis of other values, there are none. Returns the
 * number of intervals, at most `most`. */
typedef struct {
    double low, high;
} hf_merged_interval;
int hf_merged_passing(const hf_merged *merged, int axis, hf_merged_interval *interval, int most);

/* Returns the title of the study or, without a title, the name of the merged file. */
const char *hf_merged_heading(const hf_merged *merged);
