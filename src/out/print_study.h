/* print_study - prints a merged study for a terminal: its axes, its points as a table with the best one marked, and
 * what they have in common. */
#pragma once

#include "out/merged.h"
#include "out/print.h"

/* Prints the study. Lines have at most 100 characters, if names allow it. Without `verbose` a large study shows only
 * its best points. */
void hf_print_study(const hf_merged *merged, hf_print_style style, FILE *file);

/* Writes the study as one JSON object, with an object for each point: its inputs and the figures of each stage. */
void hf_print_study_json(const hf_merged *merged, FILE *file);

#define HF_AXIS_NAME_SIZE 64
/* Formats the name of an objective: "tension edge" for objective_1_tension_edge. Returns words. */
const char *hf_print_objective_words(const char *key, char words[HF_AXIS_NAME_SIZE]);
