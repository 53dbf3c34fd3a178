/* Defines the units, descriptions and words of the measures and kinds of errors of a tolerance analysis. */
#include <hifdm/tolerance.h>

#include "built/errors.h"

#define UNIT(name, word, unit, condition, description) unit,
#define HELP(name, word, unit, condition, description) description,
const char *const hf_tolerance_measure_unit[HF_TOLERANCE_N_MEASURE] = {HF_TOLERANCE_MEASURES(UNIT)};
const char *const hf_tolerance_measure_help[HF_TOLERANCE_N_MEASURE] = {HF_TOLERANCE_MEASURES(HELP)};

const double hf_tolerance_quantile[HF_TOLERANCE_QUANTILES] = {0.5, 0.95, 0.99};

bool hf_tolerance_more_is_better(hf_tolerance_measure measure)
{
    return measure == HF_TOLERANCE_MIN_TENSION;
}

_Static_assert(HF_TOLERANCE_KINDS == HF_ERROR_N_KIND, "a summary has room for each kind of errors");
#define WORD(name, word, items) word,
const char *const hf_tolerance_kind_word[HF_TOLERANCE_KINDS] = {HF_ERROR_KINDS(WORD)};
