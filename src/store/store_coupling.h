/* store_coupling - the group /coupling of a result file, as <hifdm/store.h> describes it. */
#ifndef HIFDM_STORE_COUPLING_H
#define HIFDM_STORE_COUPLING_H

#include "store/hdf5_io.h"
#include <hifdm/summary.h>
#include <hifdm/workspace.h>

/* Where the attachments are and went, what pulls them; how the loop got there unless history is NULL. */
void hf_store_write_coupling(hf_hdf5 *io, const hf_model *model, const hf_workspace *workspace,
                             const hf_coupling_history *history);

/* The results of the coupling in a summary, as attributes of the groups of their shapes. */
void hf_store_put_coupling(hf_hdf5 *io, const hf_summary *summary);
void hf_store_get_coupling(hf_hdf5 *io, hf_summary *summary);

#endif
