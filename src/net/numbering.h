/* numbering - an order of the free nodes that makes factorisations cheap. */
#ifndef HIFDM_NUMBERING_H
#define HIFDM_NUMBERING_H

#include <hifdm/scene.h>

/* order[0..n_free-1]: the free nodes of the scene, in the order with the least work of factorisations found among
 * Cuthill-McKee, sorting along x, y and z, and the reverse of each. HF_OK or HF_NO_MEMORY. */
hf_status hf_numbering_find(const hf_scene *scene, int *order, int *half_bandwidth);

#endif
