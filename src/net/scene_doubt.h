/* scene_doubt - warnings about a scene that is valid but probably not what the user intended. */
#pragma once

#include <hifdm/scene.h>

/* Warns of cables that join the same two nodes, of nodes far from all others, of a net that is too large, of lengths in
 * another unit, and of a net that nothing holds off the plane of its supports. The scene must have passed
 * hf_scene_check. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_scene_doubt(const hf_scene *scene, hf_messages *messages);
