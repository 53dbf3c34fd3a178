/* Prints lines and formats numbers for people. Contents: lines, units for people. */
#include "out/print.h"

#include "base/text.h"
#include <math.h>
#include <stdarg.h>
#include <string.h>

#define LINE_SIZE 16384

/* ---- lines ---- */

static void print_escaped(const char *text, FILE *f)
{
    static char shown[LINE_SIZE];
    hf_text_escape(text, shown, sizeof shown);
    fputs(shown, f);
    fputc('\n', f);
}

void hf_print_line(FILE *f, const char *format, ...)
{
    static char text[LINE_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    print_escaped(text, f);
}

void hf_print_lines(const char *lines, FILE *f)
{
    static char text[LINE_SIZE];
    for (size_t n; *lines; lines += n + (lines[n] != '\0')) {
        n = strcspn(lines, "\n");
        snprintf(text, sizeof text, "%.*s", (int)n, lines);
        print_escaped(text, f);
    }
}

/* ---- units for people ---- */

void hf_print_duration(double seconds, char *text, size_t size)
{
    if (seconds < 1e-3)
        snprintf(text, size, seconds < 1e-6 ? "%.1g us" : "%.0f us", seconds * 1e6);
    else if (seconds < 1)
        snprintf(text, size, "%.1f ms", seconds * 1e3);
    else if (seconds < 60)
        snprintf(text, size, "%.1f s", seconds);
    else if (seconds < 3600)
        snprintf(text, size, "%.0f min %.0f s", floor(seconds / 60), floor(fmod(seconds, 60)));
    else
        snprintf(text, size, "%.0f h %.0f min", floor(seconds / 3600), floor(fmod(seconds, 3600) / 60));
}

void hf_print_bytes(double bytes, char *text, size_t size)
{
    static const char *const unit[] = {"B", "kB", "MB", "GB", "TB"};
    int i = 0;
    for (; bytes >= 1000 && i < 4; i++)
        bytes /= 1000;
    snprintf(text, size, i ? "%.1f %s" : "%.0f %s", bytes, unit[i]);
}

#define LEAST_DB 1e-9 /* the loss of an RMS of 1e-6 wavelengths; exact positions give about 1e-27 */
double hf_print_loss_dB(double loss_dB)
{
    return loss_dB < LEAST_DB ? 0 : loss_dB;
}

const char *hf_print_change(double value, double base, char text[HF_PRINT_CHANGE_SIZE])
{
    double below = 100 * (1 - value / base);
    int n = snprintf(text, HF_PRINT_CHANGE_SIZE, fabs(below) < 10 ? "%.2f %%" : "%.1f %%", fabs(below));
    snprintf(text + n, HF_PRINT_CHANGE_SIZE - (size_t)n, below > 0 ? " lower than" : " higher than");
    if (!strncmp(text, "0.00 ", 5)) strcpy(text, "the same as");
    return text;
}

double hf_print_scale(const char *unit, const char **told)
{
    *told = !strcmp(unit, "m") ? "mm" : !strcmp(unit, "Hz") ? "GHz" : unit;
    return !strcmp(unit, "m") ? 1e3 : !strcmp(unit, "Hz") ? 1e-9 : 1;
}

const char *hf_print_decimals(double value, char text[32])
{
    if (isfinite(value))
        snprintf(text, 32, "%.4f", value);
    else
        strcpy(text, isinf(value) ? "inf" : "-");
    return text;
}
