/* result_doubt - what about a found result its author should know before it is built: a truss beyond linear theory,
 * cables stretched more than cables can be, and nodes that an optimisation has moved far because no goal counts where
 * they are. */
#ifndef HIFDM_RESULT_DOUBT_H
#define HIFDM_RESULT_DOUBT_H

#include <hifdm/carrier.h>
#include <hifdm/problem.h>

/* `shape` holds the result, NULL where there is none; `truss` what the truss does under it. */
void hf_result_doubt_truss(const hf_problem *problem, const hf_carrier_state *truss, const hf_workspace *shape,
                           hf_messages *messages);

/* Warn of the cable of the result that is stretched most, T/EA, where that is more than a twentieth. */
void hf_result_doubt_strain(const hf_problem *problem, const hf_workspace *shape, hf_messages *messages);

/* How far the goals of a case count where a node is: not, its distance from the surface alone, or wholly. */
typedef enum { HF_COUNTED_NOT, HF_COUNTED_ACROSS, HF_COUNTED } hf_counted;

/* Where the form-finding has the nodes, by row. All NULL: nothing was kept. */
typedef struct {
    double *position_m;     /* [3][n_node] */
    double *cable_m;        /* [n_node] mean length of the cables at each */
    int *n_cable;           /* [n_node] how many these are */
    unsigned char *counted; /* [n_node] hf_counted */
    void *block;
} hf_places;

/* Keep those of the shape that the workspace of the problem holds. HF_OK or HF_NO_MEMORY. */
hf_status hf_places_keep(const hf_problem *problem, hf_places *places);
void hf_places_free(hf_places *places);

/* Warn of the free node that has moved farthest from there in a way that no goal counts: by more than a quarter of the
 * mean length of its cables, and than any node where it counts. psi counts its inner nodes, a goal length the ends of
 * its cables, goals of the surface how far their nodes are from it; the way within the surface has a warning of its
 * own. */
void hf_result_doubt_uncounted(const hf_problem *problem, const hf_places *form, const hf_workspace *shape,
                               hf_messages *messages);

#endif
