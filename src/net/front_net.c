/* Contents: the front net - the scene: cables, sets, names */
#include "net/front_net.h"

#include "base/arena.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the front net ---- */

hf_status hf_front_net_make(void (*add)(void *context, hf_front_net *front), void *context, hf_front_net *f)
{
    *f = (hf_front_net){0};
    add(context, f);
    HF_TRY(HF_ARENA_ARRAYS(&f->block, HF_ARRAY(f->position_m, 3 * (size_t)f->n_node), HF_ARRAY(f->role, f->n_node),
                           HF_ARRAY(f->label, f->n_node), HF_ARRAY(f->end, 2 * (size_t)f->n_cable),
                           HF_ARRAY(f->group, f->n_cable), HF_ARRAY(f->member, f->n_member)));
    f->n_node = f->n_cable = f->n_member = 0;
    add(context, f);
    return HF_OK;
}

void hf_front_net_free(hf_front_net *f)
{
    hf_arena_free_block(f->block);
    *f = (hf_front_net){0};
}

void hf_front_net_put(hf_front_net *f, int node, const double position_m[3], hf_role role, hf_front_label label)
{
    if (!f->position_m) return;
    memcpy(f->position_m + 3 * (size_t)node, position_m, 3 * sizeof *position_m);
    f->role[node] = (unsigned char)role;
    f->label[node] = label;
}

void hf_front_net_join(hf_front_net *f, int set)
{
    if (set < 0) return;
    if (f->member) f->member[f->n_member] = (hf_cable_set_member){set, f->n_cable};
    f->n_member++;
}

void hf_front_net_connect(hf_front_net *f, int a, int b, hf_group group)
{
    int e = f->n_cable++;
    if (!f->end) return;
    f->end[2 * e] = a;
    f->end[2 * e + 1] = b;
    f->group[e] = (unsigned char)group;
}

/* ---- the scene: cables ---- */

/* Writes cable e, from node a to node b, with the target value that its law has without a value from the user. */
static void put_cable(const double EA_N[2], int e, int a, int b, hf_group group, hf_law law, hf_scene *s)
{
    s->end[2 * e] = a;
    s->end[2 * e + 1] = b;
    s->group[e] = (unsigned char)group;
    s->law[e] = (unsigned char)law;
    s->target[e] = hf_law_default_target(law, hf_scene_length_at_target(s, e));
    if (s->EA_N) s->EA_N[e] = EA_N[group] > 0 ? EA_N[group] : (double)NAN;
}

static void put_cables(const hf_front_net *f, const double EA_N[2], int first, int first_node, hf_scene *s)
{
    for (int e = 0; e < f->n_cable; e++)
        put_cable(EA_N, first + e, first_node + f->end[2 * e], first_node + f->end[2 * e + 1], f->group[e],
                  f->group[e] == HF_GROUP_BOUNDARY ? HF_LAW_LENGTH : HF_LAW_TENSION, s);
}

/* Returns the target value of a tie by its law. With the laws tension, force_density and elastic, its tension at this
 * length is tension_N. */
static double tie_target(const hf_double_net *d, double length, double EA_N)
{
    if (d->law == HF_LAW_TENSION) return d->tension_N;
    if (d->law == HF_LAW_FORCE_DENSITY) return d->tension_N / length;
    return d->law == HF_LAW_ELASTIC ? length / (1 + d->tension_N / EA_N) : length;
}

/* Fills the rear half of the scene and adds the ties. */
static void put_rear(const hf_front_net *f, const hf_double_net *d, const double EA_N[2], hf_scene *s)
{
    int n = f->n_node, e = 2 * f->n_cable;
    for (int i = 0; i < n; i++) {
        bool is_support = s->role[i] == HF_ROLE_SUPPORT;
        bool along_z = d->direction == HF_TIES_ALONG_Z || (is_support && d->supports_along_z);
        hf_double_net_behind(d, along_z, s->position_m + 3 * (size_t)i, s->position_m + 3 * (size_t)(n + i));
        s->role[n + i] = is_support ? HF_ROLE_SUPPORT : HF_ROLE_EDGE;
    }
    put_cables(f, EA_N, f->n_cable, n, s);
    for (int i = 0; i < n; i++) {
        if (s->role[i] == HF_ROLE_SUPPORT) continue;
        put_cable(EA_N, e, i, n + i, HF_GROUP_INNER, d->law, s);
        s->target[e] = tie_target(d, hf_scene_length_at_target(s, e), s->EA_N ? s->EA_N[e] : (double)NAN);
        e++;
    }
}

/* ---- the scene: sets ---- */

/* Defines the sets: those of the front net, those of the rear net, and that of the n_tie ties. */
static hf_status join_sets(const hf_front_net *f, bool is_double, int n_tie, const hf_front_families *families,
                           hf_scene *s)
{
    int n = f->n_member;
    hf_cable_set_member *member;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(member, 2 * (size_t)n + (size_t)n_tie)));
    memcpy(member, f->member, (size_t)n * sizeof *member);
    for (int k = 0; k < f->n_member && is_double; k++)
        member[n++] = (hf_cable_set_member){families->rear[member[k].set], f->n_cable + member[k].cable};
    for (int k = 0; k < n_tie; k++)
        member[n++] = (hf_cable_set_member){families->tie, 2 * f->n_cable + k};
    hf_status status = hf_cable_set_make(s, families->n, families->name, n, member);
    hf_arena_free_block(block);
    return status;
}

/* ---- the scene: names ---- */

#define ID_SIZE 24 /* bytes of the id of a node: three letters, two numbers of nine digits, '_' and NUL */

static hf_status name_all(const hf_front_net *f, hf_scene *s)
{
    size_t size = ((size_t)s->n_node + 2 * (size_t)s->n_cable) * ID_SIZE;
    char *text = s->text = malloc(size);
    if (!text) return HF_NO_MEMORY;
    const char *end = text + size;
    for (int i = 0; i < s->n_node; i++) {
        const hf_front_label *label = &f->label[i % f->n_node];
        bool is_rear = i >= f->n_node, is_short = is_rear && (*label->prefix == 'f' || *label->prefix == 'n');
        s->node_id[i] = text;
        text += snprintf(text, (size_t)(end - text), "%s%s%d", is_rear ? "r" : "", label->prefix + is_short, label->a);
        if (label->b >= 0) text += snprintf(text, (size_t)(end - text), "_%d", label->b);
        text++;
    }
    for (int e = 0; e < s->n_cable; e++) {
        const char *a = s->node_id[s->end[2 * e]], *b = s->node_id[s->end[2 * e + 1]];
        s->cable_id[e] = text;
        text += snprintf(text, (size_t)(end - text), "%s-%s", a, b) + 1;
    }
    return HF_OK;
}

hf_status hf_front_net_scene(const hf_front_net *f, const hf_double_net *d, const double EA_N[2],
                             const hf_front_families *families, hf_scene *s)
{
    bool is_double = d->distance_m > 0, with_EA = EA_N && (EA_N[0] > 0 || EA_N[1] > 0);
    int n = f->n_node, n_layer = is_double ? 2 : 1, n_tie = 0;
    for (int i = 0; i < n && is_double; i++)
        n_tie += f->role[i] != HF_ROLE_SUPPORT;
    HF_TRY(hf_scene_allocate(s, n_layer * n, n_layer * f->n_cable + n_tie, false, with_EA, false));
    memcpy(s->position_m, f->position_m, 3 * (size_t)n * sizeof *s->position_m);
    memcpy(s->role, f->role, (size_t)n);
    put_cables(f, EA_N, 0, 0, s);
    if (is_double) put_rear(f, d, EA_N, s);
    HF_TRY(join_sets(f, is_double, n_tie, families, s));
    return name_all(f, s);
}
