/* merge - one HDF5 file with all points of a study, finished or not, in the order of the study. With n points:
 *   /                attributes: program, format_version, version, study, base, fingerprint
 *   /study           text, base_text
 *   /points          id, status (not_evaluated = not finished), reason [n]
 *   /points/input    what each point sets, a data set per axis, named by its key: [n], pairs [n][2]
 *   /points/form, ga, polish   the numbers of hf_summary [n], those that any point has; NaN, 0 or not_evaluated
 *                    where a point has none. Times and threads are not merged.
 *   /points/form, ga, polish   goal_0_psi, best_goal_0_psi, ...: goals by their names [n]
 *   /points/surface/form, optimize, polish   of facets where there are some, else of nodes, and after their best fit:
 *                    facet_half_path_rms_m, facet_good_to_Hz (1 dB), facet_gain_loss_at_10_GHz_dB, facet_fit_... [n]
 *   /runs            an external link per result file, named by the point's id, with a path relative to this file
 * Data sets depend on study and base case alone: not on shards, order, threads or interruptions. */
#ifndef HIFDM_MERGE_H
#define HIFDM_MERGE_H

#include "store/ledger.h"

/* folder: of the ledger that `points` was read from. An earlier merge at `output` is replaced; any other file only with
 * `force`, else HF_EXISTS; never an input of the merge or what is no ordinary file. HF_IO, HF_NO_MEMORY. */
hf_status hf_merge(const hf_study *study, const char *folder, const hf_points *points, const char *output, bool force,
                   hf_messages *messages);

#endif
