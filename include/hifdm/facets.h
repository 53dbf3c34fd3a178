/* facets - the triangles and quadrilaterals between the nodes of a net, as its cables enclose them.
 * Stability: internal; may change in any version.
 *
 * Pipeline: nodes on the target surface -> plane graph of the cables between them, seen along z -> its faces -> facets
 * (METHOD section 9). */
#ifndef HIFDM_FACETS_H
#define HIFDM_FACETS_H

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>

HF_API_BEGIN

/* The facets of a net. */
typedef struct {
    int n_facet;    /* number of facets */
    int *corner;    /* [n_facet][4] nodes, counter-clockwise seen from +z; the last two of a triangle are equal */
    int n_open;     /* number of faces that are no facets: more than four sides, or not convex */
    bool is_planar; /* false: cables cross, seen along z, and there are no facets */
    void *block;    /* owned memory behind `corner` */
} hf_facets;

/* Finds the facets of a scene. surface->focal_length_m is above 0 and surface->kind is not HF_SURFACE_AUTO.
 *
 * A node is on the target surface if it is an inner node or its target position is within 1e-3 of the depth of the
 * surface. A node that a cable joins to an inner node is also on it if the cable leaves the surface by at most 0.1 of
 * its length. These are nodes of a rim on a truss that deflects.
 *
 * If the scene has facets, those with a node on the surface are taken. Otherwise a facet is a minimal face of the plane
 * graph that the cables between nodes on the surface form, seen along z. Where no cable runs along the rim, the
 * straight line between two supports closes the face at the inner nodes between them. It does not if boundary cables
 * hang there from one support to the other as an edge.
 *
 * Returns HF_OK or HF_NO_MEMORY. Call hf_facets_free in either case. */
hf_status hf_facets_find(const hf_scene *scene, const hf_surface_settings *surface, hf_facets *facets);

/* Frees the facets. */
void hf_facets_free(hf_facets *facets);

HF_API_END
#endif
