/* tube - the section and material of a member, as the generators of trusses have them. */
#ifndef HIFDM_TUBE_H
#define HIFDM_TUBE_H

#include <hifdm/truss.h>

/* Set the numbers of member e: a round tube of this outer diameter and wall in the material of the settings. */
void hf_tube_set(const hf_truss_settings *settings, double diameter_m, double wall_m, hf_truss *truss, int e);

#endif
