/* Words of the verdicts, and the names of the rows of `requirements`. */
#include <hifdm/requirements.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define WORD(name, word) word,
const char *const hf_verdict_word[HF_VERDICT_N] = {HF_VERDICTS(WORD)};
#undef WORD

hf_judgement hf_requirements_judge(int n, const hf_requirement_verdict *verdict)
{
    hf_judgement j = {.relative_margin_min = (double)NAN};
    for (int i = 0; i < n; i++) {
        if (verdict[i].verdict == HF_VERDICT_NONE) continue;
        j.n_required++;
        j.n_failed += verdict[i].verdict == HF_VERDICT_FAIL;
        j.n_undecided += verdict[i].verdict == HF_VERDICT_UNDECIDED;
        j.relative_margin_min = fmin(j.relative_margin_min, verdict[i].relative_margin); /* fmin ignores NaN */
    }
    if (j.n_failed > 0 && j.relative_margin_min >= 0) j.relative_margin_min = (double)NAN;
    return j;
}

hf_verdict hf_judgement_verdict(const hf_judgement *j)
{
    if (j->n_required == 0) return HF_VERDICT_NONE;
    return j->n_failed ? HF_VERDICT_FAIL : j->n_undecided ? HF_VERDICT_UNDECIDED : HF_VERDICT_PASS;
}

int hf_judgement_compare(const hf_judgement *a, const hf_judgement *b)
{
    bool has_a = a->n_required > 0, has_b = b->n_required > 0;
    if (has_a != has_b) return has_a ? -1 : 1;
    if (a->n_failed != b->n_failed) return a->n_failed - b->n_failed;
    if (a->n_undecided != b->n_undecided) return a->n_undecided - b->n_undecided;
    return (b->relative_margin_min > a->relative_margin_min) - (a->relative_margin_min > b->relative_margin_min);
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
    return text;
}
