/* numbering - an order of the free nodes with a small bandwidth. */
#ifndef HIFDM_NUMBERING_H
#define HIFDM_NUMBERING_H

#include <hifdm/scene.h>

/* order[0..n_free-1]: the free nodes of the scene, in the order with the smallest half-bandwidth found among reverse
 * Cuthill-McKee and sorting along x, y and z. HF_OK or HF_NO_MEMORY. */
hf_status hf_numbering_find(const hf_scene *scene, int *order, int *half_bandwidth);

#endif
