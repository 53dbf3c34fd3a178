/* store_surface - the measures of the surface in a result file, below /surface:
 *   /surface           attributes focal_length_m, strip_width_m; frequency_Hz [k]
 *   /surface/STAGE     form, optimize, polish, as far as they ran: attributes, the numbers of hf_surface_measures and
 *                      of its fit (fit_...); gain_loss_dB, fit_gain_loss_dB [k]
 * Nothing when the case asks for none; no data sets when it names no frequencies. */
#ifndef HIFDM_STORE_SURFACE_H
#define HIFDM_STORE_SURFACE_H

#include "store/hdf5_io.h"
#include <hifdm/summary.h>

/* Both do nothing after a failure, as all of hdf5_io. */
void hf_store_put_surface(hf_hdf5 *io, const hf_summary *summary);
void hf_store_get_surface(hf_hdf5 *io, hf_summary *summary);

#endif
