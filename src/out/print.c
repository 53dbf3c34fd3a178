/* Prints lines and formats numbers for people. Contents: lines, units for people. */
#include "out/print.h"

#include "base/text.h"
#include <math.h>
#include <stdarg.h>
#include <string.h>

#define LINE_SIZE 16384

/* ---- lines ---- */

void hf_print_line(FILE *f, const char *format, ...)
{
    static char text[LINE_SIZE], shown[LINE_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    hf_text_escape(text, shown, sizeof shown);
    fputs(shown, f);
    fputc('\n', f);
}

void hf_print_lines(const char *lines, FILE *f)
{
    for (size_t n; *lines; lines += n + (lines[n] != '\0')) {
        n = strcspn(lines, "\n");
        hf_print_line(f, "%.*s", (int)n, lines);
    }
}

/* ---- units for people ---- */

hf_print_text hf_print_duration(double seconds)
{
    hf_print_text t;
    if (seconds < 1e-3)
        snprintf(t.text, sizeof t.text, seconds < 1e-6 ? "%.1g us" : "%.0f us", seconds * 1e6);
    else if (seconds < 1)
        snprintf(t.text, sizeof t.text, "%.1f ms", seconds * 1e3);
    else if (seconds < 60)
        snprintf(t.text, sizeof t.text, "%.1f s", seconds);
    else if (seconds < 3600)
        snprintf(t.text, sizeof t.text, "%.0f min %.0f s", floor(seconds / 60), floor(fmod(seconds, 60)));
    else
        snprintf(t.text, sizeof t.text, "%.0f h %.0f min", floor(seconds / 3600), floor(fmod(seconds, 3600) / 60));
    return t;
}

hf_print_text hf_print_bytes(double bytes)
{
    static const char *const unit[] = {"B", "kB", "MB", "GB", "TB"};
    hf_print_text t;
    int i = 0;
    for (; bytes >= 1000 && i < 4; i++)
        bytes /= 1000;
    snprintf(t.text, sizeof t.text, i ? "%.1f %s" : "%.0f %s", bytes, unit[i]);
    return t;
}

#define LEAST_DB 1e-9 /* the loss of an RMS of 1e-6 wavelengths; exact positions give about 1e-27 */
double hf_print_loss_dB(double loss_dB)
{
    return loss_dB < LEAST_DB ? 0 : loss_dB;
}

int hf_print_highest_optics(const hf_summary *s, const hf_surface_measures *m)
{
    const hf_double_list *at = &s->surface.frequencies_Hz;
    int highest = -1;
    for (int k = 0; m->is_measured && k < at->n; k++)
        if (isfinite(m->refocused_gain_loss_dB[k]) && (highest < 0 || at->value[k] > at->value[highest])) highest = k;
    return highest;
}

hf_print_text hf_print_counted(int n_inner_node, int n_free)
{
    hf_print_text t = {""};
    if (n_inner_node > 0 && n_inner_node < n_free)
        snprintf(t.text, sizeof t.text, "%d of %d free nodes", n_inner_node, n_free);
    return t;
}

hf_print_text hf_print_change(double value, double base)
{
    double below = 100 * (1 - value / base);
    hf_print_text t;
    const char *what = below > 0 ? "lower than" : "higher than";
    snprintf(t.text, sizeof t.text, fabs(below) < 10 ? "%.2f %% %s" : "%.1f %% %s", fabs(below), what);
    if (!strncmp(t.text, "0.00 ", 5)) strcpy(t.text, "the same as");
    return t;
}

double hf_print_scale(const char *unit, const char **told)
{
    *told = !strcmp(unit, "m") ? "mm" : !strcmp(unit, "Hz") ? "GHz" : unit;
    return !strcmp(unit, "m") ? 1e3 : !strcmp(unit, "Hz") ? 1e-9 : 1;
}

hf_print_text hf_print_decimals(double value)
{
    hf_print_text t;
    if (isfinite(value))
        snprintf(t.text, sizeof t.text, "%.4f", value);
    else
        strcpy(t.text, isinf(value) ? "inf" : "-");
    return t;
}
