/* facet_rms - the errors of the surface between the nodes: RMS over the facets of a shape (METHOD section 9). */
#ifndef HIFDM_FACET_RMS_H
#define HIFDM_FACET_RMS_H

#include <hifdm/facets.h>
#include <hifdm/surface.h>

/* Set the members facet_... and n_facet, n_open_face of `to` from the shape in the workspace; NaN without a facet.
 * HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_measure(const hf_surface_settings *settings, const hf_facets *facets, const hf_model *model,
                           const hf_workspace *workspace, hf_surface_measures *to);

#endif
