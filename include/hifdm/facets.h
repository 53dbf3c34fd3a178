/* facets - the triangles and quadrilaterals that the cables of a net enclose.
 * Stability: internal; this header may change in any version.
 *
 * Pipeline: nodes on the target surface -> plane graph of the cables between these nodes, seen along z -> faces of the
 * graph -> facets (METHOD section 9). */
#pragma once

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>

HF_API_BEGIN

/* The facets of a net. */
typedef struct {
    int n_facet;    /* number of facets */
    int *corner;    /* [n_facet][4] nodes, counter-clockwise seen from +z; the last two of a triangle are equal */
    int n_open;     /* number of faces that are not facets because they have more than four sides or are not convex */
    bool is_planar; /* false: cables cross, seen along z, so there are no facets */
    void *block;    /* owned memory behind `corner` */
} hf_facets;

/* Finds the facets of a scene. The focal length surface->focal_length_m must be above 0, and surface->kind must not be
 * HF_SURFACE_AUTO.
 *
 * Inner nodes are on the target surface. Other nodes are on the surface if the distance of their target position from
 * it is at most 1e-3 of the depth of the surface. A node that a cable connects with an inner node is also on the
 * surface if the cable stays close to it. The deviation of the cable must be at most 0.1 of its length. This rule
 * includes nodes at the rim of a net on a truss that deflects.
 *
 * If the scene contains facets, the function uses those that have a node on the surface. If the scene contains no
 * facets, the function forms the plane graph of the cables between nodes on the surface, seen along z. Each minimal
 * face of this graph is a facet. If no cable runs along the rim, the straight line between two supports closes the face
 * at the inner nodes between them. The line does not close a face if boundary cables form an edge from one support to
 * the other.
 *
 * Returns HF_OK or HF_NO_MEMORY. Call hf_facets_free even after a failure. */
hf_status hf_facets_find(const hf_scene *scene, const hf_surface_settings *surface, hf_facets *facets);

/* Frees the facets. */
void hf_facets_free(hf_facets *facets);

HF_API_END
