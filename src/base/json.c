/* Contents: the writer - compact lists - numbers in base64 */
#include "base/json.h"

#include "base/text.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Writes a text in quotes. Escapes all hidden characters, although JSON requires it only below U+0020. A reader gets
 * the same text, and a terminal or a script of a page does not execute the characters. JSON cannot contain a byte that
 * is not UTF-8, so such a byte becomes U+FFFD. */
static void write_string(const char *text, size_t length, FILE *f)
{
    fputc('"', f);
    for (const char *end = text + length; text < end;) {
        uint32_t code;
        int n = hf_text_character(text, &code);
        if (n == 0)
            fputs("\\ufffd", f);
        else if (code == '"' || code == '\\')
            fprintf(f, "\\%c", *text);
        else if (code == '<' || hf_text_is_hidden(code))
            fprintf(f, "\\u%04x", (unsigned)code);
        else
            fwrite(text, 1, (size_t)n, f);
        text += n ? n : 1;
    }
    fputc('"', f);
}

/* ---- the writer ---- */

/* Writes what precedes an item: a comma, a new line or a blank, and the key. */
static void begin_item(hf_json *j, const char *key)
{
    if (j->is_due) fputc(',', j->file);
    if (j->line)
        fprintf(j->file, "\n%s", j->line);
    else if (j->is_due)
        fputc(' ', j->file);
    j->line = NULL;
    j->is_due = true;
    if (!key) return;
    write_string(key, strlen(key), j->file); /* a key may be the id of a cable */
    fputs(": ", j->file);
}

void hf_json_open(hf_json *j, const char *key, char bracket)
{
    begin_item(j, key);
    fputc(bracket, j->file);
    j->is_due = false;
}

void hf_json_close(hf_json *j, char bracket)
{
    fputc(bracket, j->file);
    j->is_due = true;
}

void hf_json_line(hf_json *j, const char *indentation)
{
    j->line = indentation;
}

void hf_json_open_line(hf_json *j, const char *indentation, const char *key, char bracket)
{
    hf_json_line(j, indentation);
    hf_json_open(j, key, bracket);
}

void hf_json_open_rows(hf_json *j, const char *key)
{
    hf_json_open_line(j, " ", key, '[');
}

void hf_json_open_row(hf_json *j)
{
    hf_json_open_line(j, "  ", NULL, '{');
}

void hf_json_text(hf_json *j, const char *key, const char *text)
{
    begin_item(j, key);
    hf_json_string(text, j->file);
}

void hf_json_number(hf_json *j, const char *key, double value)
{
    begin_item(j, key);
    hf_json_value(value, 17, j->file);
}

void hf_json_numbers(hf_json *j, const hf_json_pair *pair)
{
    for (; pair->key; pair++)
        hf_json_number(j, pair->key, pair->value);
}

void hf_json_integer(hf_json *j, const char *key, int64_t value)
{
    begin_item(j, key);
    fprintf(j->file, "%" PRId64, value);
}

void hf_json_unsigned(hf_json *j, const char *key, uint64_t value)
{
    begin_item(j, key);
    fprintf(j->file, "%" PRIu64, value);
}

void hf_json_bool(hf_json *j, const char *key, bool value)
{
    begin_item(j, key);
    fputs(value ? "true" : "false", j->file);
}

void hf_json_list(hf_json *j, const char *key, const double *value, int n)
{
    hf_json_open(j, key, '[');
    for (int i = 0; i < n; i++) {
        begin_item(j, NULL);
        hf_json_value(value[i], 17, j->file);
    }
    hf_json_close(j, ']');
}

void hf_json_lines(hf_json *j, const char *key, const char *prefix, const char *lines)
{
    hf_json_open(j, key, '[');
    for (size_t length; lines && *lines; lines += length + (lines[length] != '\0')) {
        size_t skip = strlen(prefix);
        length = strcspn(lines, "\n");
        if (length < skip || strncmp(lines, prefix, skip) != 0) continue;
        begin_item(j, NULL);
        write_string(lines + skip, length - skip, j->file);
    }
    hf_json_close(j, ']');
}

void hf_json_end(hf_json *j, bool has_failed, const char *messages)
{
    hf_json_line(j, " ");
    hf_json_lines(j, "warnings", "warning: ", messages);
    if (has_failed) {
        hf_json_line(j, " ");
        hf_json_lines(j, "errors", "error: ", messages);
    }
    hf_json_close(j, '}');
    fputc('\n', j->file);
}

/* ---- compact lists ---- */

void hf_json_string(const char *text, FILE *f)
{
    write_string(text, strlen(text), f);
}

void hf_json_value(double value, int digits, FILE *f)
{
    if (isnan(value))
        fputs("null", f);
    else if (isinf(value))
        fputs(value > 0 ? "\"Infinity\"" : "\"-Infinity\"", f);
    else
        fprintf(f, "%.*g", digits, value + 0.0); /* + 0.0 turns -0 into 0 */
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

/* ---- numbers in base64 ---- */

hf_json_packed hf_json_pack(const char *key, const char *type, FILE *f)
{
    fprintf(f, ",\"%s\":{\"%s\":\"", key, type);
    return (hf_json_packed){.file = f, .type = *type, .n_byte = atoi(type + 1) / 8};
}

static void put_letter(unsigned six_bits, FILE *f)
{
    fputc("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"[six_bits & 63], f);
}

static uint64_t bits_of(double value, char type, int n_byte)
{
    uint32_t half;
    uint64_t whole;
    float single = (float)value;
    if (type == 'i') return (uint32_t)(int32_t)value;
    memcpy(&half, &single, sizeof half);
    memcpy(&whole, &value, sizeof whole);
    return n_byte == 4 ? half : whole;
}

void hf_json_pack_value(hf_json_packed *p, double value)
{
    uint64_t word = bits_of(value, p->type, p->n_byte);
    for (int i = 0; i < p->n_byte; i++) {
        p->bits = p->bits << 8 | (unsigned)(word >> 8 * i & 255);
        for (p->n_bit += 8; p->n_bit >= 6; p->n_bit -= 6)
            put_letter(p->bits >> (p->n_bit - 6), p->file);
    }
}

void hf_json_pack_end(hf_json_packed *p)
{
    static const char *const padding[] = {"", "", "==", "", "="}; /* for 2 or 4 remaining bits */
    if (p->n_bit) put_letter(p->bits << (6 - p->n_bit), p->file);
    fprintf(p->file, "%s\"}", padding[p->n_bit]);
}

void hf_json_pack_values(const char *key, const char *type, const double *value, int n, FILE *f)
{
    hf_json_packed p = hf_json_pack(key, type, f);
    for (int i = 0; i < n; i++)
        hf_json_pack_value(&p, value[i]);
    hf_json_pack_end(&p);
}
