/* store_tolerance - writes the as-built samples into a result file. The group /tolerance gets a data set with one value
 * per sample for each measure, the shares of the cables and the deviations of the nodes. layout_tolerance writes the
 * statistics of the samples into the same group. */
#pragma once

#include "built/statistics.h"
#include <hifdm/store.h>

/* Writes the samples, once, before hf_store_complete. Returns the errors of the other calls of a store, and HF_OK if
 * store is NULL. */
hf_status hf_store_tolerance(hf_store *store, const hf_montecarlo *montecarlo, const hf_statistics_rows *rows,
                             hf_messages *messages);
