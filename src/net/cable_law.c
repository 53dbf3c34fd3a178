/* Words of the cable laws, and checks of the values that a user gives for them. The other functions of the laws are
 * inline in the header. */
#include <hifdm/cable_law.h>

#include <stddef.h>
#include <stdio.h>

#define TARGET(name, word, target, unit, flags) target,
#define UNIT(name, word, target, unit, flags) unit,
const char *const hf_law_word[HF_N_LAW] = {HF_LAW_LIST(HF_LAW_WORD)};
const char *const hf_law_target_name[HF_N_LAW] = {HF_LAW_LIST(TARGET)};
const char *const hf_law_target_unit[HF_N_LAW] = {HF_LAW_LIST(UNIT)};

#define LENGTH_RATIO_MIN 1e-12 /* minimum of unstressed length / target length; below it the tension exceeds 1e12 EA */

const char *hf_law_target_fault(hf_law law, double target, double length_at_target_m, char text[HF_LAW_FAULT_SIZE])
{
    const char *word = hf_law_word[law], *name = hf_law_target_name[law], *what = NULL;
    bool may_push = hf_law_has(law, HF_LAW_MAY_PUSH);
    if (isnan(target) && name) {
        snprintf(text, HF_LAW_FAULT_SIZE, "the law %s needs a value%s%s in %s", word, *name ? ", the " : "", name,
                 hf_law_target_unit[law]);
        return text;
    }
    if (!may_push && target <= 0) what = "value must be above zero";
    if (may_push && target == 0) what = "value must not be zero";
    if (!what && hf_law_has(law, HF_LAW_NEEDS_EA) && target < LENGTH_RATIO_MIN * length_at_target_m)
        what = "value, the unstressed length, is less than 1e-12 of the distance of its ends";
    if (!what) return NULL;
    snprintf(text, HF_LAW_FAULT_SIZE, "%s for the law %s", what, word);
    return text;
}
