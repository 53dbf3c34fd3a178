/* facet_import - the facets of an imported net, named in a table:
 *
 *     id,a,b,c,d     nodes around the facet, either way; of a triangle d is empty, or there is no such column */
#ifndef HIFDM_FACET_IMPORT_H
#define HIFDM_FACET_IMPORT_H

#include <hifdm/scene.h>

/* Give a scene its facets. HF_BAD_CASE with file, line and id of every fault: an unknown node, a node twice, nodes in a
 * line or not around a convex face (seen along z), a side without a cable and not between supports, a facet over
 * another one; HF_NO_MEMORY. */
hf_status hf_facet_import(const char *path, hf_scene *scene, hf_messages *messages);

/* Twice the area (m2) of the triangle of three nodes, seen along z: above 0 when they go counter-clockwise. */
double hf_facet_turn(const hf_scene *scene, int a, int b, int c);

#endif
