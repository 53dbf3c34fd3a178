#include "base/json.h"

#include <math.h>
#include <string.h>

static void write_string(const char *text, size_t length, FILE *f)
{
    fputc('"', f);
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)text[i];
        if (c == '"' || c == '\\')
            fprintf(f, "\\%c", c);
        else if (c < 0x20 || c == '<')
            fprintf(f, "\\u%04x", c);
        else
            fputc(c, f);
    }
    fputc('"', f);
}

void hf_json_text(const char *key, const char *text, FILE *f)
{
    fprintf(f, "\"%s\": ", key);
    write_string(text, strlen(text), f);
}

void hf_json_string(const char *text, FILE *f)
{
    write_string(text, strlen(text), f);
}

void hf_json_number(const char *key, double value, FILE *f)
{
    if (isfinite(value))
        fprintf(f, "\"%s\": %.17g", key, value);
    else
        fprintf(f, "\"%s\": null", key);
}

void hf_json_value(double value, int digits, FILE *f)
{
    if (!isfinite(value))
        fputs("null", f);
    else
        fprintf(f, "%.*g", digits, value + 0.0); /* no -0 */
}

void hf_json_strings(const char *key, const char *const *text, int n, FILE *f)
{
    fprintf(f, ",\"%s\":[", key);
    for (int i = 0; i < n; i++) {
        if (i) fputc(',', f);
        hf_json_string(text[i], f);
    }
    fputc(']', f);
}

void hf_json_values(const char *key, const double *value, int n, int stride, int digits, FILE *f)
{
    fprintf(f, ",\"%s\":[", key);
    for (int i = 0; i < n; i++) {
        if (i % stride != 0 && i != n - 1) continue;
        if (i) fputc(',', f);
        hf_json_value(value[i], digits, f);
    }
    fputc(']', f);
}

void hf_json_lines(const char *key, const char *prefix, const char *lines, FILE *f)
{
    const char *comma = "";
    fprintf(f, "\"%s\": [", key);
    for (size_t length; lines && *lines; lines += length + (lines[length] != '\0')) {
        size_t skip = strlen(prefix);
        length = strcspn(lines, "\n");
        if (length < skip || strncmp(lines, prefix, skip) != 0) continue;
        fputs(comma, f);
        write_string(lines + skip, length - skip, f);
        comma = ", ";
    }
    fputc(']', f);
}
