#define _GNU_SOURCE /* strtod_l */
#include "base/text.h"

#include "base/file_io.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FILE_MAX (1 << 30) /* bytes */
#define READ_AT_ONCE 4096

/* Reports that a path is not an ordinary file. Such files are refused before reading: a device may have no end, and a
 * pipe may have no writer. */
static hf_status refuse_kind(const char *path, hf_status code, hf_messages *messages)
{
    struct stat info = {0};
    stat(path, &info);
    const char *kind = S_ISDIR(info.st_mode)                            ? "a folder"
                       : S_ISFIFO(info.st_mode)                         ? "a pipe"
                       : S_ISCHR(info.st_mode) || S_ISBLK(info.st_mode) ? "a device"
                       : S_ISSOCK(info.st_mode)                         ? "a socket"
                                                                        : "no file of the disk";
    return hf_error(messages, code, "%s: this is %s. Give the name of a regular file", path, kind);
}

/* Reads to the end of the file. A file may be longer than its reported size; files in /proc are. Sets *buffer to NULL
 * if memory runs out. Returns 0, or -1 and errno. */
static int read_to_end(int file, size_t capacity, char **buffer, size_t *length)
{
    *buffer = malloc(capacity);
    while (*buffer) {
        ssize_t n = hf_file_io_read(file, *buffer + *length, capacity - *length - 1);
        if (n < 0) return -1;
        *length += (size_t)n;
        if (*length < capacity - 1 || *length > FILE_MAX) return 0;
        char *bigger = realloc(*buffer, capacity *= 2);
        if (!bigger) free(*buffer);
        *buffer = bigger;
    }
    return 0;
}

hf_status hf_text_read_file(const char *path, hf_status code, char **text, size_t *length, hf_messages *messages)
{
    char *buffer = NULL;
    off_t size;
    *text = NULL;
    *length = 0;
    int file = hf_file_io_open_ordinary(path, &size);
    if (file < 0 && errno == EEXIST) return refuse_kind(path, code, messages);
    if (file < 0)
        return hf_error(messages, hf_file_io_fault(errno, code), "%s: cannot open: %s", path, strerror(errno));
    bool is_long = size > FILE_MAX;
    int failed = is_long ? 0 : read_to_end(file, (size_t)size + READ_AT_ONCE, &buffer, length), why = errno;
    close(file);
    is_long |= *length > FILE_MAX;
    if (!buffer && !is_long) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    if (failed || is_long) free(buffer);
    if (failed) return hf_error(messages, hf_file_io_fault(why, code), "%s: cannot read: %s", path, strerror(why));
    if (is_long) return hf_error(messages, code, "%s: this file is larger than %d MB", path, FILE_MAX >> 20);
    buffer[*length] = '\0';
    *text = buffer;
    return HF_OK;
}

#define DIGITS "0123456789"

/* Converts like strtod(3) in the C locale, whatever locale the calling program has set. Another locale may use
 * a decimal comma. */
static double number_of(const char *text)
{
    locale_t c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    double value = c_locale ? strtod_l(text, NULL, c_locale) : strtod(text, NULL);
    if (c_locale) freelocale(c_locale);
    return value;
}

bool hf_text_double(const char *text, double *value)
{
    return hf_text_decimal(text, 0, value);
}

#define DIGITS_MAX 400    /* maximum length of a number that hf_text_decimal scales */
#define EXPONENT_MAX 9999 /* with so few digits, larger exponents give 0 or an overflow in any case */

bool hf_text_decimal(const char *text, int decimals, double *value)
{
    const char *p = text, *whole, *fraction;
    char scaled[DIGITS_MAX + 32];
    if (*p == '+' || *p == '-') p++;
    whole = p;
    p += strspn(p, DIGITS);
    size_t n_digit = (size_t)(p - whole);
    if (*p == '.') {
        fraction = ++p;
        p += strspn(p, DIGITS);
        n_digit += (size_t)(p - fraction);
    }
    if (n_digit == 0) return false;
    int n = (int)(p - text);
    if (*p == 'e' || *p == 'E') {
        p++;
        if (*p == '+' || *p == '-') p++;
        if (!isdigit((unsigned char)*p)) return false;
        p += strspn(p, DIGITS);
    }
    if (*p) return false;
    if (decimals != 0) {
        long exponent = text[n] ? strtol(text + n + 1, NULL, 10) : 0;
        if (n > DIGITS_MAX) return false;
        exponent = exponent > EXPONENT_MAX ? EXPONENT_MAX : exponent < -EXPONENT_MAX ? -EXPONENT_MAX : exponent;
        snprintf(scaled, sizeof scaled, "%.*se%ld", n, text, exponent + decimals);
        text = scaled;
    }
    *value = number_of(text);
    return isfinite(*value);
}

bool hf_text_uint64(const char *text, uint64_t *value)
{
    if (!isdigit((unsigned char)*text) || text[strspn(text, DIGITS)]) return false;
    errno = 0;
    unsigned long long number = strtoull(text, NULL, 10);
    *value = number;
    return errno == 0;
}

int hf_text_character(const char *text, uint32_t *code)
{
    const unsigned char *p = (const unsigned char *)text;
    if (p[0] < 0x80) {
        *code = p[0];
        return 1;
    }
    int n = p[0] >= 0xf0 ? 4 : p[0] >= 0xe0 ? 3 : 2;
    if (p[0] < 0xc2 || p[0] > 0xf4) return 0;
    *code = p[0] & (0xffu >> (n + 1));
    for (int i = 1; i < n; i++) {
        if ((p[i] & 0xc0) != 0x80) return 0;
        *code = *code << 6 | (p[i] & 0x3fu);
    }
    if ((p[0] == 0xe0 && p[1] < 0xa0) || (p[0] == 0xed && p[1] > 0x9f)) return 0;
    return (p[0] == 0xf0 && p[1] < 0x90) || (p[0] == 0xf4 && p[1] > 0x8f) ? 0 : n;
}

bool hf_text_is_utf8(const char *text)
{
    while (*text) {
        uint32_t code;
        int n = hf_text_character(text, &code);
        if (n == 0 || (code < 0x20 && code != '\t')) return false;
        text += n;
    }
    return true;
}

bool hf_text_is_hidden(uint32_t code)
{
    return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x61c || code == 0x200e || code == 0x200f ||
           (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

size_t hf_text_escape(const char *text, char *escaped, size_t size)
{
    size_t used = 0;
    if (size) *escaped = '\0';
    while (*text) {
        uint32_t code;
        char shown[8];
        int n = hf_text_character(text, &code), n_shown;
        if (n == 0)
            n_shown = snprintf(shown, sizeof shown, "\\x%02x", (unsigned char)*text);
        else if (!hf_text_is_hidden(code))
            n_shown = snprintf(shown, sizeof shown, "%.*s", n, text);
        else if (code == '\n' || code == '\t' || code == '\r')
            n_shown = snprintf(shown, sizeof shown, "\\%c", code == '\n' ? 'n' : code == '\t' ? 't' : 'r');
        else
            n_shown = snprintf(shown, sizeof shown, code < 0x80 ? "\\x%02x" : "\\u%04x", (unsigned)code);
        if (used + (size_t)n_shown < size) memcpy(escaped + used, shown, (size_t)n_shown + 1);
        used += (size_t)n_shown;
        text += n ? n : 1;
    }
    return used;
}

bool hf_text_append(char *text, size_t size, const char *between, const char *item, const char *more)
{
    size_t used = strlen(text);
    bool fits = used + strlen(between) + strlen(item) + strlen(more) < size;
    snprintf(text + used, size - used, "%s%s", fits && used ? between : "", fits ? item : more);
    return fits;
}

void hf_text_trim_utf8(char *text)
{
    size_t n = strlen(text), back = 0;
    while (back < 4 && back < n && ((unsigned char)text[n - 1 - back] & 0xc0) == 0x80)
        back++;
    if (back == n) return;
    unsigned char first = (unsigned char)text[n - 1 - back];
    size_t whole = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : first >= 0xc0 ? 2 : 1;
    if (whole > back + 1) text[n - 1 - back] = '\0';
}

const char *hf_text_first_error(const char *lines, const char *otherwise)
{
    static const char begin[] = "error: ";
    const char *line = lines ? lines : "";
    while (*line && strncmp(line, begin, strlen(begin)) != 0) {
        line += strcspn(line, "\n");
        line += *line == '\n';
    }
    return *line ? line + strlen(begin) : otherwise;
}

int hf_text_too_deep(const char *text)
{
    int depth = 0, line = 1;
    for (; *text; text++) {
        line += *text == '\n';
        depth += *text == '[' || *text == '{';
        depth -= depth > 0 && (*text == ']' || *text == '}');
        if (depth > HF_TEXT_NESTING_MAX) return line;
    }
    return 0;
}

#define NEAREST_MAX 63 /* bytes; longer words have no suggestion */

/* Returns the Levenshtein distance of two short words, ignoring case. */
static int edit_distance(const char *a, const char *b)
{
    int row[NEAREST_MAX + 1], n_a = (int)strlen(a), n_b = (int)strlen(b);
    if (n_a > NEAREST_MAX || n_b > NEAREST_MAX) return INT_MAX;
    for (int j = 0; j <= n_b; j++)
        row[j] = j;
    for (int i = 1; i <= n_a; i++) {
        int diagonal = row[0];
        row[0] = i;
        for (int j = 1; j <= n_b; j++) {
            int differs = tolower((unsigned char)a[i - 1]) != tolower((unsigned char)b[j - 1]);
            int best = diagonal + differs;
            diagonal = row[j];
            if (row[j] + 1 < best) best = row[j] + 1;
            if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
            row[j] = best;
        }
    }
    return row[n_b];
}

int hf_text_index(const char *word, const char *const *words, int n)
{
    for (int i = 0; i < n; i++)
        if (!strcmp(word, words[i])) return i;
    return -1;
}

/* Returns true if the name is this word with a unit, such as EA_N for EA. */
static bool is_with_unit(const char *name, const char *word)
{
    size_t n = strlen(word);
    return n && !strncmp(name, word, n) && name[n] == '_';
}

const char *hf_text_nearest(const char *word, const char *const *candidates, int n_candidate)
{
    const char *nearest = NULL;
    int limit = 1 + (int)strlen(word) / 3, best = limit + 1;
    for (int i = 0; i < n_candidate; i++) {
        int distance = is_with_unit(candidates[i], word) ? 1 : edit_distance(word, candidates[i]);
        if (distance < best) {
            best = distance;
            nearest = candidates[i];
        }
    }
    return nearest;
}

void hf_text_hint(const char *word, const char *const *candidates, int n_candidate, char hint[HF_TEXT_HINT_SIZE])
{
    const char *near = hf_text_nearest(word, candidates, n_candidate);
    *hint = '\0';
    if (near) snprintf(hint, HF_TEXT_HINT_SIZE, "; did you mean '%s'?", near);
}

bool hf_text_has_decimal_comma(const char *text)
{
    char point[64];
    double value;
    char *comma;
    if (strlen(text) >= sizeof point) return false;
    strcpy(point, text);
    comma = strchr(point, ',');
    if (!comma || strchr(comma + 1, ',')) return false;
    *comma = '.';
    return hf_text_double(point, &value);
}
