/* merge - writes one HDF5 file with all points of a study, finished or not, in the order of the study. With n points:
 *
 *   /                attributes: program, format_version, version, study, base, fingerprint
 *   /study           text, base_text; title if the study has one
 *   /points          id, status (not_evaluated = not finished), reason [n]
 *   /points/input    one data set per axis, named by its key: the value of each point [n], pairs [n][2]
 *   /points/GROUP    the numbers of hf_summary that any point has [n], in the group of their attributes: form, search,
 *                    refine, coupling, truss, tolerance; those of the root are in /points. A point without the number
 *                    has NaN, 0 or not_evaluated. Times and threads are not merged.
 *   /points/form, search, refine   objective_0_psi, ...: values of the objectives, by name [n]
 *   /points/surface/form, search, refine   surface errors of the facets if there are any, else of the nodes, as
 *                    computed and after the best fit: facet_half_path_rms_m, facet_gain_loss_1dB_Hz (the frequency of
 *                    1 dB gain loss), facet_gain_loss_at_10_GHz_dB, facet_fit_... [n]
 *   /points/load_cases/NAME   figures of the load cases [n]
 *   /runs            one external link per result file, named by the id of the point, with a path relative to this file
 *
 * The names of version 0.2 are soft links to these data sets (renamed.h).
 *
 * The data sets depend only on the study and the base case, not on shards, order, threads or interruptions. */
#pragma once

#include "store/ledger.h"

/* Merges `points`, which hf_ledger_read has read from `folder`, into the file `output`. An earlier merge there is
 * replaced. Any other file is replaced only with `force`. Inputs of the merge, and anything but an ordinary file, are
 * never replaced. Returns HF_OK, HF_EXISTS if the file may not be replaced, HF_IO or HF_NO_MEMORY. */
hf_status hf_merge(const hf_study *study, const char *folder, const hf_points *points, const char *output, bool force,
                   hf_messages *messages);
