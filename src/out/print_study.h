/* print_study - prints a merged study for a terminal: its axes, its points as a table with the best one marked, and
 * what they have in common. */
#pragma once

#include "base/json.h"
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

/* The texts below are the same on the page of a study. All functions return text. */

#define HF_PRINT_ADVICE_SIZE 1024
/* Formats which points pass: "3 of 6 points pass: pretension between the points 25 and 40 N". The text is empty if
 * nothing is required. It states intervals for a study of one axis of numbers, and only between points that were
 * tried. */
const char *hf_print_study_advice(const hf_merged *merged, char text[HF_PRINT_ADVICE_SIZE]);

/* Formats whether the two best groups of replicates differ by more than the scatter of the search. The text is empty
 * without two groups. */
const char *hf_print_study_scatter(const hf_merged *merged, char text[HF_PRINT_ADVICE_SIZE]);

/* Writes the member "replicates" with the groups and their statistics; nothing without replicates. */
void hf_print_study_groups(const hf_merged *merged, hf_json *json);

#define HF_PRINT_RANKING_SIZE 128
/* Formats what ranks the points: "psi", or "failed requirements, then undecided ones, then smallest relative
 * margin". */
const char *hf_print_study_ranking(const hf_merged *merged, char text[HF_PRINT_RANKING_SIZE]);

/* Formats the verdict on a point: "pass", "fail (2 of 9)", "undecided (1 of 9)", or "-" without one. */
const char *hf_print_study_verdict(const hf_merged *merged, int point, char text[HF_AXIS_NAME_SIZE]);

#define HF_PRINT_TIGHTEST_SIZE 96
/* Formats the requirement that decides and its margin: "tension of tie, all load cases -12.3 %", or "-". */
const char *hf_print_study_tightest(const hf_merged *merged, int point, char text[HF_PRINT_TIGHTEST_SIZE]);
