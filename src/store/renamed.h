/* renamed - the names that version 0.2 gave to groups, data sets and attributes (src/manual/renames.md).
 *
 * Files of version 0.2 are read through these names: hf_renamed is the hf_hdf5_alias of such a file. Files of this
 * version hold the old names as well, so that programs for files of 0.2 go on working until version 0.4.
 * hf_renamed_link writes them:
 *
 *     group that moved as a whole       a soft link to the new group
 *     data set with another name        a soft link beside the new one, or in an old group
 *     attribute with another name       a copy beside the new one, or in an old group
 *     /ga, /ga/best, /ga/last, /polish  groups with soft links and copies alone
 *
 * No reader of hifdm follows these links. */
#pragma once

#include "store/hdf5.h"

#define HF_FORMAT_0_2 2 /* format_version of files of version 0.2 */

/* Writes the k-th name of an object or attribute of today in a file of 0.2, see hf_hdf5_alias. */
hf_hdf5_alias hf_renamed;

/* Sets io->alias if the open file is one of version 0.2. */
void hf_renamed_note(hf_hdf5 *io);

/* Writes the old names into the file. has_rows: the design variables are those of optimize.variables, which have no
 * unit in their names. */
void hf_renamed_link(hf_hdf5 *io, bool has_rows);

/* Removes all soft links of the file and the groups that hf_renamed_link made. */
void hf_renamed_unlink(hf_hdf5 *io);

/* Writes today's name of a figure, measure or objective of 0.2 into now[size], and returns it. */
const char *hf_renamed_figure(const char *then, char *now, size_t size);

/* Writes today's name of an object in a group of a merge of 0.2 into now[size], and returns it. group: path of today,
 * such as "/points/search". */
const char *hf_renamed_point(const char *group, const char *then, char *now, size_t size);
