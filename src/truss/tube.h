/* tube - the section and material of a member, as the generators of trusses have them. */
#ifndef HIFDM_TUBE_H
#define HIFDM_TUBE_H

#include <hifdm/truss.h>

/* Member e from node a to b: a round tube of this outer diameter and wall in the material of the settings. Its id, of
 * the ids of its nodes, is written to text [size]; returns its end. */
char *hf_tube_join(const hf_truss_settings *settings, double diameter_m, double wall_m, hf_truss *truss, int e, int a,
                   int b, hf_unit unit, char *text, size_t size);

#endif
