/* report_required - the rows of `requirements` on the page of a result: their names and the distribution functions of
 * their samples. */
#pragma once

#include "base/json.h"
#include <hifdm/status.h>
#include <hifdm/summary.h>
#include <stdio.h>

/* Contains the samples of one figure in one load case, or the worst of all load cases in each sample. */
typedef struct {
    int row;               /* of `requirements` */
    const char *load_case; /* borrowed from the summary; "all": the worst of all load cases */
    bool is_low;           /* the figure belongs to at_least, else to at_most */
    int n;                 /* number of samples */
    int n_value;           /* number of the values below */
    double *value;         /* [n_value] order statistics, ascending, owned; samples without a value are left out */
    double *share;         /* [n_value] share of all samples that is at most as large */
    int n_failing;         /* of a tension: number of samples that break the bound */
    int n_cable;           /* number of the cables below; 0: not known */
    int cable[HF_TOLERANCE_RANKED]; /* cables with the tension that breaks the bound, the most frequent first */
    int count[HF_TOLERANCE_RANKED]; /* number of the samples in which they have it */
} hf_report_curve;

typedef struct {
    int n;
    hf_report_curve *curve; /* [n] owned */
} hf_report_curves;

/* Reads the samples of all rows with a share from the result file. A curve has at most a few hundred values, which are
 * evenly spaced among the samples. Returns HF_OK, also if the file has no samples; HF_IO or HF_NO_MEMORY with a
 * message. The caller calls hf_report_curves_free in any case. */
hf_status hf_report_curves_read(const char *path, const hf_summary *summary, hf_report_curves *curves,
                                hf_messages *messages);
void hf_report_curves_free(hf_report_curves *curves);

/* Writes the member "limits": set and bounds of each row of optimize.limits about tensions. Writes nothing if the case
 * has none, or keys that this version does not know. */
void hf_report_limits_write(const char *path, hf_json *json);

/* Writes the member "required": name and curves of each row, in the order of the case. Writes nothing without rows. */
void hf_report_curves_write(const hf_summary *summary, const hf_report_curves *curves, FILE *file);
