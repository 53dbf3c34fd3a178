/* What joins several keys of the lists about the net as built: cables, nodes, cases. */
#include "case/config_check.h"

#include <hifdm/cable_set.h>

#include <math.h>
#include <string.h>

void hf_config_check_set(hf_config_faults *f, const char *list, int row, const char *set)
{
    bool is_group = !strcmp(set, hf_group_word[0]) || !strcmp(set, hf_group_word[1]) || !strcmp(set, "all");
    const char *fault = *set && !is_group ? hf_cable_set_name_fault(set) : NULL;
    if (fault) hf_config_fault_in_row(f, list, row, "set", fault);
}

static void check_cables(const hf_built_settings *b, hf_config_faults *f)
{
    for (int i = 0; i < b->n_cable; i++) {
        const hf_cable_settings *row = &b->cable[i];
        hf_config_check_set(f, "cables", i, row->set);
        if (isnan(row->expansion_per_K) && isnan(row->mass_kg_per_m))
            hf_config_fault_in_row(f, "cables", i, "set",
                                   "says nothing of these cables; give expansion_per_K, mass_kg_per_m or both");
    }
}

void hf_config_check_built(const hf_case *c, hf_config_faults *f)
{
    check_cables(&c->built, f);
}
