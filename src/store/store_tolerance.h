/* store_tolerance - the samples of nets as built in a result file: below /tolerance, a data set for each measure with a
 * value per sample, the shares of cables and the deviations of nodes. Their figures are attributes and data sets of the
 * same group (layout_tolerance). */
#ifndef HIFDM_STORE_TOLERANCE_H
#define HIFDM_STORE_TOLERANCE_H

#include "built/statistics.h"
#include <hifdm/store.h>

/* Write them once, before hf_store_complete. Errors as the other calls of a store; store NULL: HF_OK. */
hf_status hf_store_tolerance(hf_store *store, const hf_montecarlo *montecarlo, const hf_statistics_rows *rows,
                             hf_messages *messages);

#endif
