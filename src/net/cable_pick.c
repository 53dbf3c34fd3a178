#include "net/cable_pick.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

static const char *const all_word = "all";

int hf_cable_pick(const hf_scene *s, const char *set, int *cable)
{
    int n = 0, group = 2;
    if (!strcmp(set, hf_group_word[HF_GROUP_INNER])) group = HF_GROUP_INNER;
    if (!strcmp(set, hf_group_word[HF_GROUP_BOUNDARY])) group = HF_GROUP_BOUNDARY;
    if (group < 2 || !*set || !strcmp(set, all_word)) {
        for (int e = 0; e < s->n_cable; e++) {
            if (group < 2 && s->group[e] != group) continue;
            if (cable) cable[n] = e;
            n++;
        }
        return n;
    }
    int k = hf_cable_set_find(s, set);
    if (k < 0) return -1;
    n = s->set_start[k + 1] - s->set_start[k];
    if (cable) memcpy(cable, s->set_cable + s->set_start[k], (size_t)n * sizeof *cable);
    return n;
}

/* Returns the word nearest to `set` among those that hf_cable_pick accepts, or NULL. */
static const char *nearest_set(const hf_scene *s, const char *set)
{
    const char *known[] = {all_word, hf_group_word[HF_GROUP_INNER], hf_group_word[HF_GROUP_BOUNDARY]};
    const char *pair[2] = {hf_text_nearest(set, known, 3), NULL};
    for (int k = 0; k < s->n_set; k++) {
        pair[pair[0] != NULL] = s->set_name[k];
        pair[0] = hf_text_nearest(set, pair, pair[1] ? 2 : 1);
        pair[1] = NULL;
    }
    return pair[0];
}

int hf_cable_pick_some(const hf_scene *s, const char *set, const char *where, int *cable, hf_messages *messages)
{
    int n = hf_cable_pick(s, set, cable);
    if (n > 0) return n;
    char sets[532] = "all, inner, boundary";
    const char *near = nearest_set(s, set);
    for (int k = 0; k < s->n_set && hf_text_append(sets, sizeof sets, ", ", s->set_name[k], ", ..."); k++)
        continue;
    if (n == 0)
        hf_error(messages, HF_BAD_CASE, "%s: this net has no %s cables", where, set);
    else if (near)
        hf_error(messages, HF_BAD_CASE, "%s: this net has no cable set '%s'; did you mean '%s'?", where, set, near);
    else
        hf_error(messages, HF_BAD_CASE, "%s: this net has no cable set '%s'. The sets of this net are %s", where, set,
                 sets);
    return 0;
}

hf_status hf_cable_demand_EA(const hf_scene *s, const char *where, const char *who_needs, const char *then,
                             hf_messages *messages)
{
    int n[2] = {0}, first[2] = {0};
    for (int e = 0; e < s->n_cable; e++)
        if (!(s->EA_N && s->EA_N[e] > 0) && n[s->group[e]]++ == 0) first[s->group[e]] = e;
    for (int g = 0; g < 2; g++)
        if (n[g])
            hf_error(messages, HF_BAD_CASE,
                     "%s: %d %s cable%s no stiffness EA, which %s. One of these cables is '%s'. Add the key "
                     "scene.EA_%s_N, or add the column EA_N to the table of an imported net%s",
                     where, n[g], hf_group_word[g], n[g] == 1 ? " has" : "s have", who_needs, s->cable_id[first[g]],
                     hf_group_word[g], then);
    return n[0] + n[1] ? HF_BAD_CASE : HF_OK;
}
