/* facets - the surface between the nodes: the triangles and quadrilaterals of a net, as its cables enclose them.
 * Stability: internal; may change in any version. */
#ifndef HIFDM_FACETS_H
#define HIFDM_FACETS_H

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>

HF_API_BEGIN

typedef struct {
    int n_facet;
    int *corner; /* [n_facet][4] nodes of the scene, counter-clockwise seen from +z; of a triangle the last two are the
                       same */
    int n_open;  /* faces that are no facets: more than four sides, or not convex */
    bool is_planar; /* false: cables cross, seen along z; there are no facets then */
    void *block;    /* owned memory behind `corner` */
} hf_facets;

/* Nodes are on the wanted surface that are inner nodes, and of the others those whose theoretical position is on it up
 * to 1e-3 of its depth, or that a cable holds to an inner node along the surface, up to 0.1 of its length: those of a
 * rim that gave way. Of the facets that the scene names, those with a node on the surface. Where it names none they
 * are found: a facet is a minimal face of the plane graph that the cables between nodes on the surface make, seen
 * along z. Where no cable runs along the rim, the straight line between two supports closes the face at the inner
 * nodes between them, unless boundary cables hang there from one to the other as an edge. surface->focal_length_m > 0,
 * and its kind is known. HF_OK or HF_NO_MEMORY; free with hf_facets_free in any case. */
hf_status hf_facets_find(const hf_scene *scene, const hf_surface_settings *surface, hf_facets *facets);

void hf_facets_free(hf_facets *facets);

HF_API_END
#endif
