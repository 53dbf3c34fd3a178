#include <hifdm/cable_set.h>

#include "base/arena.h"

#include <stdlib.h>
#include <string.h>

const char *hf_cable_set_name_fault(const char *name)
{
    static const char *const letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    size_t n = strlen(name);
    if (name[strspn(name, letters)] || n == 0) return "must be made of letters, digits, _ and -";
    if (*name == '-') return "must not begin with -"; /* a spreadsheet would take such a cell for a formula */
    if (n >= HF_CABLE_SET_NAME_SIZE) return "is longer than 63 letters";
    for (int g = 0; g < 2; g++)
        if (!strcmp(name, hf_group_word[g])) return "is the name of a group, which the column group sets; leave it out";
    if (!strcmp(name, "all")) return "is the name of all cables; leave it out";
    return NULL;
}

hf_status hf_cable_set_allocate(hf_scene *s, int n_set, int n_member)
{
    char(*name)[HF_CABLE_SET_NAME_SIZE];
    HF_TRY(HF_ARENA_ARRAYS(&s->set_block, HF_ARRAY(name, n_set), HF_ARRAY(s->set_name, n_set),
                           HF_ARRAY(s->set_start, n_set + 1), HF_ARRAY(s->set_cable, n_member)));
    for (int k = 0; k < n_set; k++)
        s->set_name[k] = name[k];
    s->n_set = n_set;
    return HF_OK;
}

hf_status hf_cable_set_make(hf_scene *scene, int n_set, const char *const *name, int n_member,
                            const hf_cable_set_member *member)
{
    int n_used = 0;
    if (n_member == 0) return HF_OK;
    int *next = calloc((size_t)n_set, sizeof *next); /* [n_set], size of a set, later its next entry in set_cable */
    if (!next) return HF_NO_MEMORY;
    for (int k = 0; k < n_member; k++)
        next[member[k].set]++;
    for (int k = 0; k < n_set; k++)
        n_used += next[k] > 0;
    if (hf_cable_set_allocate(scene, n_used, n_member) != HF_OK) {
        free(next);
        return HF_NO_MEMORY;
    }
    for (int k = 0, i = 0, start = 0; k < n_set; k++) {
        if (next[k] == 0) continue;
        strncpy((char *)scene->set_name[i], name[k], HF_CABLE_SET_NAME_SIZE - 1);
        scene->set_start[i] = start;
        start += next[k];
        next[k] = scene->set_start[i];
        scene->set_start[++i] = start;
    }
    for (int k = 0; k < n_member; k++)
        scene->set_cable[next[member[k].set]++] = member[k].cable;
    free(next);
    return HF_OK;
}

int hf_cable_set_find(const hf_scene *scene, const char *name)
{
    for (int k = 0; k < scene->n_set; k++)
        if (!strcmp(scene->set_name[k], name)) return k;
    return -1;
}

bool hf_cable_set_has(const hf_scene *scene, int i_set, int i_cable)
{
    int from = scene->set_start[i_set], to = scene->set_start[i_set + 1];
    while (from < to) {
        int middle = from + (to - from) / 2;
        if (scene->set_cable[middle] < i_cable)
            from = middle + 1;
        else
            to = middle;
    }
    return from < scene->set_start[i_set + 1] && scene->set_cable[from] == i_cable;
}
