/* print_study - a merged study for a terminal: what it asks, axes, points as a table, the best of them marked. */
#ifndef HIFDM_PRINT_STUDY_H
#define HIFDM_PRINT_STUDY_H

#include "out/merged.h"
#include "out/print.h"

/* Lines of at most 100 characters, as far as names allow; without `verbose` only the best points of a large study. */
void hf_print_study(const hf_merged *merged, hf_print_style style, FILE *file);

/* The same as one JSON object: an object for each point with what it sets and the figures of each stage. */
void hf_print_study_json(const hf_merged *merged, FILE *file);

/* What people call an axis, "pretension" of form.pretension_N, and the unit that its values are told in. */
#define HF_AXIS_NAME_SIZE 64
const char *hf_print_axis(const char *key, char name[HF_AXIS_NAME_SIZE]);

/* What a goal is called: "tension edge" of goal_1_tension_edge. Returns words. */
const char *hf_print_goal_words(const char *key, char words[HF_AXIS_NAME_SIZE]);

#endif
