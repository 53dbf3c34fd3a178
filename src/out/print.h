/* print - output for people: lines, the summary of a result, durations and sizes with units. */
#pragma once

#include <hifdm/status.h>
#include <hifdm/summary.h>
#include <stdio.h>

/* Prints one line and its newline; the text must not end in one. The whole text is escaped by hf_text_escape, because
 * names and titles in it may contain any characters. It is cut at about 16 kB. */
void hf_print_line(FILE *file, const char *format, ...) HF_PRINTF(2, 3);

/* Prints the lines of a text from a file, each of them escaped. */
void hf_print_lines(const char *lines, FILE *file);

#define HF_PRINT_BOLD "\x1b[1m"
#define HF_PRINT_YELLOW "\x1b[33m"
#define HF_PRINT_RED "\x1b[31m"
#define HF_PRINT_PLAIN "\x1b[0m"

typedef struct {
    bool verbose;    /* adds certificates, tension ratios of sets, times and further figures */
    bool has_colour; /* colours of a terminal, see app/output.h */
    bool has_error;  /* the command prints the error of the run, so the summary does not repeat it */
} hf_print_style;

/* Prints the summary: the answer in the first line, the case, and a row for each stage. path is that of the result, or
 * NULL. */
void hf_print_summary(const hf_summary *summary, const char *path, hf_print_style style, FILE *file);

/* A short text that a function returns by value, for use within one expression: hf_print_duration(wall_s).text */
typedef struct {
    char text[64];
} hf_print_text;

/* Formats a duration: "85 us", "1.3 ms", "2.7 s", "4 min 10 s". */
hf_print_text hf_print_duration(double seconds);

/* Formats a size: "640 B", "1.2 MB". */
hf_print_text hf_print_bytes(double bytes);

/* Formats a value: "4.2315", "inf", or "-" for NaN. */
hf_print_text hf_print_decimals(double value);

/* Formats the change of a value relative to a base > 0: "34.9 % lower than", "4.24 % higher than", or "the same as"
 * when it rounds to 0. */
hf_print_text hf_print_change(double value, double base);

/* Formats which nodes psi counts: "11 of 59 free nodes", or "" when it counts all of them. n_inner_node is 0 in files
 * of earlier versions, which do not say it. */
hf_print_text hf_print_counted(int n_inner_node, int n_free);

/* Returns the factor from a unit of files to that of people, and sets *told to the latter: m to mm, Hz to GHz. */
double hf_print_scale(const char *unit, const char **told);

#define HF_PRINT_BOUND_SIZE 64
/* Formats the bounds of a requirement, NaN for none: "at most 0.55 mm", "5 to 60 N". Returns text. */
const char *hf_print_bound(const char *unit, double at_least, double at_most, char text[HF_PRINT_BOUND_SIZE]);

/* Returns a gain loss for display, dB: 0 when it is rounding. */
double hf_print_loss_dB(double loss_dB);

/* Returns the index of the highest frequency at which a shape has figures by physical optics, or -1. */
int hf_print_highest_optics(const hf_summary *summary, const hf_surface_measures *surface);
