/* tube - the section and material of a member of a generated truss. */
#pragma once

#include <hifdm/truss.h>

/* Makes member e from node a to b: a round tube with this outer diameter and wall, of the material in the settings.
 * Writes its id, made of the ids of its nodes, to text [size]. Returns the end of the id. */
char *hf_tube_join(const hf_truss_settings *settings, double diameter_m, double wall_m, hf_truss *truss, int e, int a,
                   int b, hf_unit unit, char *text, size_t size);
