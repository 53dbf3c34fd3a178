#include <hifdm/result.h>

#include <math.h>
#include <string.h>

/* ---- words ---- */

#define WORD(name, value, word, ...) [value] = word,
#define MEANING(name, value, word, meaning) [value] = meaning,
static const char *const stop_reason[] = {HF_STOP_REASON_LIST(WORD)};
static const char *const coupling_stop[] = {HF_COUPLING_STOP_LIST(WORD)};
static const char *const bound[] = {HF_BOUND_REASON_LIST(WORD)};
static const char *const bound_meaning[] = {HF_BOUND_REASON_LIST(MEANING)};

/* Returns the word of a value; "unknown" for a value that is not listed, as another version may have stored. */
static const char *word_of(int value, size_t n, const char *const *word)
{
    return value >= 0 && (size_t)value < n && word[value] ? word[value] : "unknown";
}
#define WORD_OF(value, words) word_of(value, sizeof(words) / sizeof *(words), words)

const char *hf_stop_reason_word(int reason)
{
    return WORD_OF(reason, stop_reason);
}

const char *hf_coupling_stop_word(int stop)
{
    return WORD_OF(stop, coupling_stop);
}

const char *hf_bound_reason_word(int reason)
{
    return WORD_OF(reason, bound);
}

const char *hf_bound_reason_meaning(int reason)
{
    return WORD_OF(reason, bound_meaning);
}

/* ---- the lists of fields ---- */

#define RESULT_FIELD(...) HF_RESULT_FIELD(hf_form_result, __VA_ARGS__)
#define COUPLING_FIELD(...) HF_RESULT_FIELD(hf_coupling_result, __VA_ARGS__)
const hf_result_field hf_result_field_of[HF_RESULT_N] = {HF_RESULT_LIST(RESULT_FIELD)};
const hf_result_field hf_coupling_field_of[HF_COUPLING_N] = {HF_COUPLING_LIST(COUPLING_FIELD)};

const char *hf_result_key(const hf_result_field *f)
{
    return f->key ? f->key : f->name;
}

void hf_result_blank(hf_form_result *r)
{
    const double none = (double)NAN;
    for (const hf_result_field *f = hf_result_field_of; f < hf_result_field_of + HF_RESULT_N; f++)
        if (f->kind == HF_RESULT_REAL) memcpy((char *)r + f->offset, &none, sizeof none);
}

void hf_result_list_individual(const hf_result_field *field[HF_RESULT_N_INDIVIDUAL])
{
    int n = 0;
    for (int position = 1; n < HF_RESULT_N_INDIVIDUAL; position++)
        for (int i = 0; i < HF_RESULT_N; i++)
            if (hf_result_field_of[i].individual == position) field[n++] = &hf_result_field_of[i];
}
