/* Contents: ids - nodes - cables - sets - together */
#include <hifdm/scene_arrays.h>

#include "base/text.h"
#include <hifdm/cable_law.h>
#include <hifdm/cable_set.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ID_SIZE_MAX 256   /* as in tables */
#define NUMBER_ID_SIZE 12 /* bytes of an index used as id */

/* ---- ids ---- */

static size_t id_bytes(const char *const *id, int n)
{
    if (!id) return (size_t)n * NUMBER_ID_SIZE;
    size_t size = 0;
    for (int i = 0; i < n; i++)
        size += strlen(id[i]) + 1;
    return size;
}

/* Copies n ids to `text` and sets to[n]. Returns the end of the text. */
static char *copy_ids(const char *const *id, int n, char *text, const char **to)
{
    for (int i = 0; i < n; i++) {
        to[i] = text;
        text += 1 + (id ? sprintf(text, "%s", id[i]) : sprintf(text, "%d", i));
    }
    return text;
}

static int by_id(const void *a, const void *b)
{
    const char *const *const *p = a, *const *const *q = b;
    int order = strcmp(**p, **q);
    return order ? order : (*p > *q) - (*p < *q);
}

/* Checks that ids given by the caller are UTF-8, unique, not empty and not too long. Returns HF_OK or HF_NO_MEMORY;
 * faults are counted. */
static hf_status check_ids(const hf_scene *s, bool is_cable, int *n_fault, hf_messages *messages)
{
    const char **id = is_cable ? s->cable_id : s->node_id;
    size_t n = (size_t)(is_cable ? s->n_cable : s->n_node);
    const char ***sorted = malloc(n * sizeof *sorted);
    if (!sorted) return HF_NO_MEMORY;
    for (size_t i = 0; i < n; i++) {
        sorted[i] = &id[i];
        if (!*id[i]) hf_scene_fault(s, is_cable, (int)i, n_fault, "has an empty id", messages);
        if (!hf_text_is_utf8(id[i]))
            hf_scene_fault(s, is_cable, (int)i, n_fault, "has an id that is no UTF-8", messages);
        if (strlen(id[i]) >= ID_SIZE_MAX)
            hf_scene_fault(s, is_cable, (int)i, n_fault, "has an id longer than 255 bytes", messages);
    }
    qsort(sorted, n, sizeof *sorted, by_id);
    for (size_t i = 1; i < n; i++)
        if (!strcmp(*sorted[i], *sorted[i - 1]))
            hf_scene_fault(s, is_cable, (int)(sorted[i] - id), n_fault, "has an id that was used before", messages);
    free(sorted);
    return HF_OK;
}

static hf_status take_ids(const hf_scene_arrays *a, hf_scene *s, int *n_fault, hf_messages *messages)
{
    char *text = s->text = malloc(id_bytes(a->node_id, a->n_node) + id_bytes(a->cable_id, a->n_cable));
    if (!text) return HF_NO_MEMORY;
    text = copy_ids(a->node_id, a->n_node, text, s->node_id);
    copy_ids(a->cable_id, a->n_cable, text, s->cable_id);
    if (a->node_id) HF_TRY(check_ids(s, false, n_fault, messages));
    return a->cable_id ? check_ids(s, true, n_fault, messages) : HF_OK;
}

/* ---- nodes ---- */

static bool any_is_loaded(const hf_scene_arrays *a)
{
    for (int i = 0; a->load_N && i < 3 * a->n_node; i++)
        if (a->load_N[i] != 0) return true; /* also true for NaN */
    return false;
}

static void take_nodes(const hf_scene_arrays *a, hf_scene *s, int *n_fault, hf_messages *messages)
{
    size_t n = (size_t)s->n_node;
    memcpy(s->position_m, a->position_m, 3 * n * sizeof *s->position_m);
    memcpy(s->role, a->role, n);
    if (s->load_N) memcpy(s->load_N, a->load_N, 3 * n * sizeof *s->load_N);
    for (int i = 0; i < s->n_node; i++)
        if (s->role[i] > HF_ROLE_EDGE)
            hf_scene_fault(s, false, i, n_fault, "has a role that is none of 0 to 2", messages);
}

/* ---- cables ---- */

static bool take_ends(const hf_scene_arrays *a, hf_scene *s, int e, int *n_fault, hf_messages *messages)
{
    char what[96];
    bool are_nodes = true;
    for (int k = 0; k < 2; k++) {
        int end = a->end[2 * e + k];
        bool is_node = end >= 0 && end < s->n_node;
        snprintf(what, sizeof what, "ends at node %d, but nodes count from 0 to %d", end, s->n_node - 1);
        if (!is_node) hf_scene_fault(s, true, e, n_fault, what, messages);
        s->end[2 * e + k] = is_node ? end : 0;
        are_nodes = are_nodes && is_node;
    }
    return are_nodes;
}

static void take_value(double given, hf_scene *s, int e, int *n_fault, hf_messages *messages)
{
    char text[HF_LAW_FAULT_SIZE];
    double length_at_target_m = hf_scene_length_at_target(s, e);
    s->target[e] = isnan(given) ? hf_law_default_target(s->law[e], length_at_target_m) : given;
    const char *fault = isinf(given) ? "value must be a finite number"
                                     : hf_law_target_fault(s->law[e], given, length_at_target_m, text);
    char what[HF_LAW_FAULT_SIZE + 16];
    snprintf(what, sizeof what, "is refused: %s", fault ? fault : "");
    if (fault) hf_scene_fault(s, true, e, n_fault, what, messages);
}

static void take_cables(const hf_scene_arrays *a, const double group_EA_N[2], hf_scene *s, int *n_fault,
                        hf_messages *messages)
{
    for (int e = 0; e < s->n_cable; e++) {
        bool are_nodes = take_ends(a, s, e, n_fault, messages);
        s->group[e] = a->group[e];
        s->law[e] = a->law[e];
        if (s->group[e] > HF_GROUP_BOUNDARY)
            hf_scene_fault(s, true, e, n_fault, "has a group that is none of 0 and 1", messages);
        if (s->law[e] >= HF_N_LAW) hf_scene_fault(s, true, e, n_fault, "has a law that there is not", messages);
        if (s->group[e] > HF_GROUP_BOUNDARY || s->law[e] >= HF_N_LAW || !are_nodes) continue;
        take_value(a->value ? a->value[e] : (double)NAN, s, e, n_fault, messages);
        if (!s->EA_N) continue;
        double EA_N = a->EA_N ? a->EA_N[e] : (double)NAN;
        if (EA_N <= 0 || isinf(EA_N))
            hf_scene_fault(s, true, e, n_fault, "is refused: EA_N must be a finite number above zero", messages);
        bool has_group = isnan(EA_N) && group_EA_N[s->group[e]] > 0;
        s->EA_N[e] = has_group ? group_EA_N[s->group[e]] : EA_N;
    }
}

/* ---- sets ---- */

static hf_status fault_of_set(const char *name, const char *what, hf_messages *messages)
{
    return hf_error(messages, HF_BAD_CASE, "scene: the set '%.63s' %s", name, what);
}

static hf_status take_sets(const hf_scene_arrays *a, hf_scene *s, hf_messages *messages)
{
    int n = a->n_set ? a->set_start[a->n_set] : 0;
    for (int k = 0; k < a->n_set; k++) {
        const char *fault = hf_cable_set_name_fault(a->set_name[k]);
        if (fault) return fault_of_set(a->set_name[k], fault, messages);
        if (k > 0 && strcmp(a->set_name[k - 1], a->set_name[k]) >= 0)
            return fault_of_set(a->set_name[k], "is not behind the one before it, by strcmp", messages);
        for (int i = a->set_start[k]; i < a->set_start[k + 1]; i++) {
            if (a->set_cable[i] < 0 || a->set_cable[i] >= s->n_cable)
                return fault_of_set(a->set_name[k], "names a cable that there is not", messages);
            if (i > a->set_start[k] && a->set_cable[i - 1] >= a->set_cable[i])
                return fault_of_set(a->set_name[k], "must name each cable once, in ascending order", messages);
        }
    }
    hf_cable_set_member *member = malloc((size_t)(n + 1) * sizeof *member);
    if (!member) return HF_NO_MEMORY;
    for (int k = 0; k < a->n_set; k++)
        for (int i = a->set_start[k]; i < a->set_start[k + 1]; i++)
            member[i] = (hf_cable_set_member){k, a->set_cable[i]};
    hf_status status = hf_cable_set_make(s, a->n_set, a->set_name, n, member);
    free(member);
    return status;
}

/* ---- together ---- */

hf_status hf_scene_from_arrays(const hf_scene_arrays *a, const double group_EA_N[2], hf_scene *s, hf_messages *messages)
{
    int n_fault = 0;
    *s = (hf_scene){0};
    if (a->n_node < 1 || a->n_cable < 1)
        return hf_error(messages, HF_BAD_CASE, "scene: %d nodes and %d cables do not form a net", a->n_node,
                        a->n_cable);
    bool with_EA = a->EA_N || group_EA_N[0] > 0 || group_EA_N[1] > 0;
    hf_status status = hf_scene_allocate(s, a->n_node, a->n_cable, any_is_loaded(a), with_EA, false);
    if (status == HF_OK) status = take_ids(a, s, &n_fault, messages);
    if (status == HF_OK) {
        take_nodes(a, s, &n_fault, messages);
        take_cables(a, group_EA_N, s, &n_fault, messages);
        status = take_sets(a, s, messages);
    }
    if (status == HF_NO_MEMORY) return hf_error(messages, status, "scene: out of memory for %d nodes", a->n_node);
    if (n_fault > HF_FAULT_MAX)
        hf_error(messages, HF_BAD_CASE, "scene: hifdm found %d more faults in this net", n_fault - HF_FAULT_MAX);
    return n_fault ? HF_BAD_CASE : status;
}
