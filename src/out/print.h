/* print - what people read: lines, the summary of a result, durations and sizes with units. */
#ifndef HIFDM_PRINT_H
#define HIFDM_PRINT_H

#include <hifdm/status.h>
#include <hifdm/summary.h>
#include <stdio.h>

/* One line, which must not end in a newline of its own: the text is escaped (hf_text_escape) as a whole, because names
 * and titles in it may hold anything. It is cut at some 16 kB. */
void hf_print_line(FILE *file, const char *format, ...) HF_PRINTF(2, 3);

/* Messages that a file holds, each of them escaped. */
void hf_print_lines(const char *lines, FILE *file);

#define HF_PRINT_BOLD "\x1b[1m"
#define HF_PRINT_YELLOW "\x1b[33m"
#define HF_PRINT_RED "\x1b[31m"
#define HF_PRINT_PLAIN "\x1b[0m"

typedef struct {
    bool verbose;    /* certificates, ratios of sets, times and all else that an engineer may want to look up */
    bool has_colour; /* for a terminal: app/output.h */
} hf_print_style;

/* The summary: the answer in its first line, what the case is, a row for each stage. path: of the result, or NULL. */
void hf_print_summary(const hf_summary *summary, const char *path, hf_print_style style, FILE *file);

/* "85 us", "1.3 ms", "2.7 s", "4 min 10 s" */
void hf_print_duration(double seconds, char *text, size_t size);

/* "4.2315", "inf", or "-" when it has no value. */
const char *hf_print_decimals(double value, char text[32]);

/* Where a value lies of a base above 0: "34.89 % below", "38.03 % above", and "as large as" for what rounds to 0. */
#define HF_PRINT_CHANGE_SIZE 48
const char *hf_print_change(double value, double base, char text[HF_PRINT_CHANGE_SIZE]);

/* By what a value in this unit of files is multiplied where people are told it in another: m in mm, Hz in GHz. */
double hf_print_scale(const char *unit, const char **told);

/* A loss of gain, dB, as it is told: what is rounding is 0. */
double hf_print_loss_dB(double loss_dB);

/* "640 B", "1.2 MB" */
void hf_print_bytes(double bytes, char *text, size_t size);

#endif
