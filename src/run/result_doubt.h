/* result_doubt - warns about a result before it is built: a truss beyond linear theory, cables with too large strains,
 * and nodes far from their positions after form-finding because no objective counts their position. */
#ifndef HIFDM_RESULT_DOUBT_H
#define HIFDM_RESULT_DOUBT_H

#include <hifdm/carrier.h>
#include <hifdm/problem.h>

/* Warns if linear theory is not accurate enough for the truss. `shape` holds the result (NULL: there is none), and
 * `truss` is the state of the truss under it. */
void hf_result_doubt_truss(const hf_problem *problem, const hf_carrier_state *truss, const hf_workspace *shape,
                           hf_messages *messages);

/* Warns about the cable of the result with the maximum strain T/EA, if that is above STRAIN_DOUBT, 0.05. */
void hf_result_doubt_strain(const hf_problem *problem, const hf_workspace *shape, hf_messages *messages);

/* How objectives count the position of a node: not at all, by its distance from the surface, or completely. */
typedef enum { HF_COUNTED_NOT, HF_COUNTED_ACROSS, HF_COUNTED } hf_counted;

/* Positions of the nodes after form-finding, by row. All members are NULL if nothing was kept. */
typedef struct {
    double *position_m;     /* [3][n_node] m */
    double *cable_m;        /* [n_node] mean length of the cables at each node, m */
    int *n_cable;           /* [n_node] number of these cables */
    unsigned char *counted; /* [n_node] hf_counted */
    void *block;
} hf_places;

/* Keeps the positions of the shape in the problem's workspace. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_places_keep(const hf_problem *problem, hf_places *places);
void hf_places_free(hf_places *places);

/* Warns about the free node with the maximum displacement from these positions that no objective counts. It must exceed
 * a quarter of the mean length of the node's cables, and the counted displacement of every node. psi counts inner
 * nodes, an objective of length the ends of its cables, and objectives of the surface the distance of their nodes from
 * it. Displacements within the surface have a warning of their own. */
void hf_result_doubt_uncounted(const hf_problem *problem, const hf_places *form, const hf_workspace *shape,
                               hf_messages *messages);

#endif
