/* facets - the triangles and quadrilaterals that the cables of a net enclose.
 * Stability: internal. This header may change in any version.
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

/* Finds the facets of a scene. The focal length surface->focal_length_m must be above 0. The kind surface->kind must
 * not be HF_SURFACE_AUTO.
 *
 * Inner nodes are on the target surface. Any other node is on the surface if its target position deviates from the
 * surface by at most 1e-3 of the depth of the surface. If a cable connects a node with an inner node and stays close to
 * the surface, the node is also on the surface. The cable may deviate from the surface by at most 0.1 of its length.
 * Therefore, the nodes at the rim of a net are on the surface even if the truss of the net deflects.
 *
 * If the scene contains facets, the function uses the facets that have a node on the surface. If the scene contains no
 * facets, the function projects the cables between nodes on the surface along z. The projected cables form a plane
 * graph. Each minimal face of the plane graph is a facet. If no cable runs along the rim, the straight line between two
 * supports closes the face of the inner nodes between these supports. If boundary cables form an edge from one support
 * to the other, the straight line between the supports does not close a face.
 *
 * Returns HF_OK or HF_NO_MEMORY. Call hf_facets_free even if hf_facets_find fails. */
hf_status hf_facets_find(const hf_scene *scene, const hf_surface_settings *surface, hf_facets *facets);

/* Frees the facets. */
void hf_facets_free(hf_facets *facets);

HF_API_END
