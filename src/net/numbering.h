/* numbering - orders the free nodes so that factorisations are cheap. */
#pragma once

#include <hifdm/scene.h>

/* Writes the free nodes of the scene into order [n_free], and the half-bandwidth of this order. It is the order
 * with the least factorisation work among Cuthill-McKee, sorting along x, y and z, and the reverse of each. Returns
 * HF_OK or HF_NO_MEMORY. */
hf_status hf_numbering_find(const hf_scene *scene, int *order, int *half_bandwidth);
