/* scene_doubt - what a scene may be, but is hardly meant to be: warnings before anything runs. */
#ifndef HIFDM_SCENE_DOUBT_H
#define HIFDM_SCENE_DOUBT_H

#include <hifdm/scene.h>

/* Warn of cables that join the same two nodes, of nodes far beyond all others, and of a net that nothing holds off the
 * plane of its supports. The scene has passed hf_scene_check. HF_OK or HF_NO_MEMORY. */
hf_status hf_scene_doubt(const hf_scene *scene, hf_messages *messages);

#endif
