#include <hifdm/status.h>

#include "base/text.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The rows of HF_STATUS_LIST. */
static const struct row {
    hf_status status;
    const char *word, *text;
    int exit_code;
} table[] = {
#define ROW(name, value, word_, ...) {.status = HF_##name, .word = word_, __VA_ARGS__},
    HF_STATUS_LIST(ROW)
#undef ROW
};
enum { N_ROW = sizeof table / sizeof *table };

static const struct row *find(hf_status status)
{
    static const struct row unknown = {.word = "unknown", .text = "unknown status", .exit_code = 5};
    for (int i = 0; i < N_ROW; i++)
        if (table[i].status == status) return &table[i];
    return &unknown;
}

const char *hf_status_word(hf_status status)
{
    return find(status)->word;
}

hf_status hf_status_of_word(const char *word)
{
    for (int i = 0; i < N_ROW; i++)
        if (!strcmp(word, table[i].word)) return table[i].status;
    return HF_IO;
}

const char *hf_status_text(hf_status status)
{
    return find(status)->text;
}

int hf_status_exit_code(hf_status status)
{
    return find(status)->exit_code;
}

/* Reserves room for `extra` more bytes and the final NUL. Returns false if memory runs out. */
static bool reserve(hf_messages *m, size_t extra)
{
    size_t need = m->length + extra + 1;
    if (need <= m->capacity) return true;
    size_t capacity = m->capacity ? 2 * m->capacity : 256;
    if (capacity < need) capacity = need;
    char *text = realloc(m->text, capacity);
    if (!text) return false;
    m->text = text;
    m->capacity = capacity;
    return true;
}

/* Appends one message. The body is escaped as a whole, so that a message is one line of visible characters, whatever
 * names and files contain. */
static void append(hf_messages *m, const char *prefix, const char *format, va_list args)
{
    va_list count_args;
    va_copy(count_args, args);
    int n_body = vsnprintf(NULL, 0, format, count_args);
    va_end(count_args);
    size_t n_prefix = strlen(prefix);
    if (n_body < 0 || !reserve(m, n_prefix + (size_t)n_body + 1)) return;
    size_t start = m->length, begin = start + n_prefix;
    vsnprintf(m->text + begin, (size_t)n_body + 1, format, args);
    size_t n_shown = hf_text_escape(m->text + begin, NULL, 0);
    if (n_shown != (size_t)n_body) { /* the body moves behind the room for its escaped form */
        if (!reserve(m, n_prefix + n_shown + 1 + (size_t)n_body)) {
            m->text[m->length] = '\0';
            return;
        }
        char *body = memmove(m->text + begin + n_shown + 1, m->text + begin, (size_t)n_body + 1);
        hf_text_escape(body, m->text + begin, n_shown + 1);
    }
    memcpy(m->text + m->length, prefix, n_prefix);
    m->length = begin + n_shown;
    m->text[m->length++] = '\n';
    m->text[m->length] = '\0';
    if (m->report) m->report(m->text + start);
}

hf_status hf_error(hf_messages *messages, hf_status code, const char *format, ...)
{
    va_list args;
    if (!messages) return code;
    va_start(args, format);
    append(messages, "error: ", format, args);
    va_end(args);
    messages->n_error++;
    return code;
}

void hf_warning(hf_messages *messages, const char *format, ...)
{
    va_list args;
    if (!messages) return;
    va_start(args, format);
    append(messages, "warning: ", format, args);
    va_end(args);
    messages->n_warning++;
}

const char *hf_messages_location(const hf_messages *messages, char text[HF_LOCATION_SIZE], const char *key_format, ...)
{
    char key[128];
    va_list args;
    va_start(args, key_format);
    vsnprintf(key, sizeof key, key_format, args);
    va_end(args);
    if (messages && messages->find_location)
        messages->find_location(messages->location_context, key, text, HF_LOCATION_SIZE);
    else
        snprintf(text, HF_LOCATION_SIZE, "%s", key);
    return text;
}

void hf_messages_free(hf_messages *messages)
{
    free(messages->text);
    *messages = (hf_messages){0};
}
