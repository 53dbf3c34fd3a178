#include "net/cable_pick.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

static const char *const all_word = "all";

const char *hf_cable_pick_name(const char *sets, char name[HF_SET_NAME_SIZE])
{
    size_t n = strcspn(sets, "+");
    snprintf(name, HF_SET_NAME_SIZE, "%.*s", (int)n, sets);
    return sets[n] ? sets + n + 1 : NULL;
}

/* Returns the index of the set with this name. Behind the sets are the groups, and then all cables. -1: none. */
static int find(const hf_scene *s, const char *name)
{
    for (int group = 0; group < 2; group++)
        if (!strcmp(name, hf_group_word[group])) return s->n_set + group;
    return !*name || !strcmp(name, all_word) ? s->n_set + 2 : hf_cable_set_find(s, name);
}

static bool has(const hf_scene *s, int set, int e)
{
    if (set < s->n_set) return hf_cable_set_has(s, set, e);
    return set == s->n_set + 2 || s->group[e] == set - s->n_set;
}

int hf_cable_pick(const hf_scene *s, const char *sets, int *cable)
{
    char name[HF_SET_NAME_SIZE];
    int set[HF_SET_NAME_SIZE], n_set = 0, n = 0;
    while (sets && n_set < HF_SET_NAME_SIZE) {
        sets = hf_cable_pick_name(sets, name);
        set[n_set] = find(s, name);
        if (set[n_set++] < 0) return -1;
    }
    for (int e = 0; e < s->n_cable; e++) {
        int k = 0;
        while (k < n_set && !has(s, set[k], e))
            k++;
        if (k < n_set) cable[n++] = e;
    }
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
    char sets[532] = "all, inner, boundary", name[HF_SET_NAME_SIZE];
    const char *rest = set;
    do /* the first unknown name */
        rest = hf_cable_pick_name(rest, name);
    while (rest && find(s, name) >= 0);
    const char *near = nearest_set(s, name);
    for (int k = 0; k < s->n_set && hf_text_append(sets, sizeof sets, ", ", s->set_name[k], ", ..."); k++)
        continue;
    if (n == 0)
        hf_error(messages, HF_BAD_CASE, "%s: this net has no %s cables", where, set);
    else if (near)
        hf_error(messages, HF_BAD_CASE, "%s: this net has no cable set '%s'; did you mean '%s'?", where, name, near);
    else
        hf_error(messages, HF_BAD_CASE, "%s: this net has no cable set '%s'. The sets of this net are %s", where, name,
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
