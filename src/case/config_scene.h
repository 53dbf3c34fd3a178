/* config_scene - which sections of a case make its net. */
#ifndef HIFDM_CONFIG_SCENE_H
#define HIFDM_CONFIG_SCENE_H

#include <hifdm/config.h>
#include <stdbool.h>

#define HF_CONFIG_WHAT_SIZE 512

/* Does exactly one section make the net? If not, `what` says what is wrong with the section scene. */
bool hf_config_scene_is_one(const hf_case *settings, char what[HF_CONFIG_WHAT_SIZE]);

/* What a generated net knows of its surface; 0 where it does not. */
hf_surface_settings hf_config_scene_surface(const hf_case *settings);

#endif
