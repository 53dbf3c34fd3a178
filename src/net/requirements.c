/* Words of the verdicts, and the names of the rows of `requirements`. */
#include <hifdm/requirements.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define WORD(name, word) word,
const char *const hf_verdict_word[HF_VERDICT_N] = {HF_VERDICTS(WORD)};
#undef WORD

hf_verdict hf_requirements_verdict(int n, const hf_requirement_verdict *verdict)
{
    int count[HF_VERDICT_N] = {0};
    for (int i = 0; i < n; i++)
        count[verdict[i].verdict]++;
    if (count[HF_VERDICT_FAIL]) return HF_VERDICT_FAIL;
    if (count[HF_VERDICT_UNDECIDED]) return HF_VERDICT_UNDECIDED;
    return count[HF_VERDICT_PASS] ? HF_VERDICT_PASS : HF_VERDICT_NONE;
}

const char *hf_requirement_name(const hf_requirement_settings *r, char *text, size_t size)
{
    bool has_feed = hf_required_is_of(r->figure, HF_REQUIRED_OF_FEED);
    int n = snprintf(text, size, "%s", hf_required_figure_word[r->figure]);
    if (*r->set && (size_t)n < size) n += snprintf(text + n, size - (size_t)n, " of %s", r->set);
    if (hf_required_is_of(r->figure, HF_REQUIRED_OF_RADIO) && (size_t)n < size)
        n += snprintf(text + n, size - (size_t)n, " at %g GHz", r->frequency_Hz / 1e9);
    if (has_feed && (size_t)n < size) n += snprintf(text + n, size - (size_t)n, ", %s", hf_focus_word[r->feed]);
    if (strcmp(r->load_case, "nominal") != 0 && (size_t)n < size)
        n += snprintf(text + n, size - (size_t)n, !strcmp(r->load_case, "all") ? ", all load cases" : ", %s",
                      r->load_case);
    if (r->share > 0 && (size_t)n < size) snprintf(text + n, size - (size_t)n, ", %g %% of samples", 100 * r->share);
    if (r->share == 0 && (size_t)n < size) snprintf(text + n, size - (size_t)n, ", samples");
    return text;
}
