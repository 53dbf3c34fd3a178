/* Words of the choices in case files. Defaults, ranges and help are in case/config_table.c. */
#include <hifdm/settings.h>

#include <stddef.h>
#include <string.h>

#define WORDS(name, size, ...) const char *const name[size] = {__VA_ARGS__};
HF_SETTINGS_WORDS(WORDS)
#define WORD(name, word) word,
const char *const hf_optimize_method_word[HF_OPTIMIZE_N_METHOD + 1] = {HF_OPTIMIZE_METHODS(WORD) NULL};
#undef WORD
#define WORD(name, word, unit, description) word,
const char *const hf_required_figure_word[HF_REQUIRED_N_FIGURE + 1] = {HF_REQUIRED_FIGURES(WORD) NULL};
#undef WORD
#define UNIT(name, word, unit, description) unit,
const char *const hf_required_figure_unit[HF_REQUIRED_N_FIGURE] = {HF_REQUIRED_FIGURES(UNIT)};
#undef UNIT
#define WORD(name, word, unit, condition, description) word,
const char *const hf_tolerance_measure_word[] = {HF_TOLERANCE_MEASURES(WORD) NULL};
#undef WORD

bool hf_objective_takes_load_cases(const hf_objective_settings *s)
{
    return !strcmp(s->load_case, "all");
}

bool hf_optimize_takes_samples(const hf_optimize_settings *s)
{
    bool takes = false;
    for (int k = 0; k < s->n_term; k++)
        takes |= s->term[k].over == HF_OVER_SAMPLES;
    for (int k = 0; k < s->n_front; k++)
        takes |= s->front[k].over == HF_OVER_SAMPLES;
    return takes;
}
