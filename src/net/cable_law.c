/* The words of the laws. The functions of the laws are inline in the header. */
#include <hifdm/cable_law.h>

#include <stddef.h>

#define WORD(name, word, target, unit, flags) word,
#define TARGET(name, word, target, unit, flags) target,
#define UNIT(name, word, target, unit, flags) unit,
const char *const hf_law_word[HF_N_LAW] = {HF_LAW_LIST(WORD)};
const char *const hf_law_target_name[HF_N_LAW] = {HF_LAW_LIST(TARGET)};
const char *const hf_law_target_unit[HF_N_LAW] = {HF_LAW_LIST(UNIT)};
