/* figures - compares figures of tests/verify with those of a source. If HIFDM_FIGURES names a file, each comparison
 * adds a line to it for the table of the manual: file, line, kind, figure, ours, reference, tolerance. */
#pragma once

#include "support.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static inline void keep_figure(const char *file, int line, const char *kind, double ours, double reference,
                               double tolerance, const char *format, ...) __attribute__((format(printf, 7, 8), unused));
static inline void keep_figure(const char *file, int line, const char *kind, double ours, double reference,
                               double tolerance, const char *format, ...)
{
    const char *path = getenv("HIFDM_FIGURES");
    char name[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(name, sizeof name, format, arguments);
    va_end(arguments);
    ck_assert_msg(isnan(tolerance) || fabs(ours - reference) <= tolerance || (*kind == '<' && ours <= reference),
                  "%s:%d: %s is %.17g, not within %g of %.17g", file, line, name, ours, tolerance, reference);
    FILE *kept = path ? fopen(path, "a") : NULL;
    if (!kept) return;
    fprintf(kept, "%s\t%d\t%s\t%s\t%.17g\t%.17g\t%.17g\n", file, line, kind, name, ours, reference, tolerance);
    fclose(kept);
}

/* VERIFY(ours, reference, tolerance, "psi at %s m, mm", ...): our figure is within the tolerance of that of the
 * source. */
#define VERIFY(ours, reference, tolerance, ...)                                                                        \
    keep_figure(__FILE__, __LINE__, "=", ours, reference, tolerance, __VA_ARGS__)
/* The largest difference of many figures is within the tolerance. */
#define VERIFY_WORST(difference, tolerance, ...)                                                                       \
    keep_figure(__FILE__, __LINE__, "worst", difference, 0, tolerance, __VA_ARGS__)
/* Our figure is at most that of the source. */
#define VERIFY_AT_MOST(ours, reference, ...) keep_figure(__FILE__, __LINE__, "<=", ours, reference, 0, __VA_ARGS__)
/* A figure of the source that we do not reach. */
#define NOT_MET(ours, reference, ...) keep_figure(__FILE__, __LINE__, "not met", ours, reference, NAN, __VA_ARGS__)
