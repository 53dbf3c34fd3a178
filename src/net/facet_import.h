/* facet_import - reads the facets of an imported net from a table:
 *
 *     id,a,b,c,d     nodes around the facet in either direction; d is empty or missing for a triangle */
#pragma once

#include <hifdm/scene.h>

/* Reads the facets of a scene. Returns HF_OK. Returns HF_BAD_CASE after reporting every fault with file, line and
 * id: an unknown node, a node used twice, nodes in a line or not around a convex face (seen along z), a side
 * without a cable and not between supports, two facets on the same side of a cable. Returns HF_IO or HF_NO_MEMORY
 * if reading fails. */
hf_status hf_facet_import(const char *path, hf_scene *scene, hf_messages *messages);

/* Returns twice the area of the triangle of three nodes in m2, seen along z. It is positive if
 * they go counter-clockwise. */
double hf_facet_double_area(const hf_scene *scene, int a, int b, int c);
