/* Contents: words - memory - checks - comparison of two scenes */
#include <hifdm/scene.h>

#include "base/arena.h"
#include "base/elementary.h"
#include "base/text.h"
#include "base/union_find.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDING 1e-9 /* relative to the largest number */

const char *const hf_role_word[3] = {"support", "inner", "edge"};
const char *const hf_group_word[2] = {"inner", "boundary"};

/* ---- memory ---- */

hf_status hf_scene_allocate(hf_scene *s, int n_node, int n_cable, bool with_load, bool with_EA, bool with_line)
{
    size_t n = (size_t)n_node, m = (size_t)n_cable;
    *s = (hf_scene){0};
    HF_TRY(HF_ARENA_ARRAYS(&s->block, HF_ARRAY(s->position_m, 3 * n), HF_ARRAY(s->load_N, with_load ? 3 * n : 0),
                           HF_ARRAY(s->role, n), HF_ARRAY(s->end, 2 * m), HF_ARRAY(s->group, m), HF_ARRAY(s->law, m),
                           HF_ARRAY(s->target, m), HF_ARRAY(s->EA_N, with_EA ? m : 0), HF_ARRAY(s->node_id, n),
                           HF_ARRAY(s->cable_id, m), HF_ARRAY(s->node_line, with_line ? n : 0),
                           HF_ARRAY(s->cable_line, with_line ? m : 0)));
    s->n_node = n_node;
    s->n_cable = n_cable;
    if (!with_load) s->load_N = NULL;
    if (!with_EA) s->EA_N = NULL;
    if (!with_line) s->node_line = s->cable_line = NULL;
    return HF_OK;
}

void hf_scene_free(hf_scene *scene)
{
    hf_arena_free_block(scene->block);
    free(scene->text);
    hf_arena_free_block(scene->set_block);
    free(scene->facet);
    *scene = (hf_scene){0};
}

double hf_scene_length_at_target(const hf_scene *scene, int i_cable)
{
    const double *a = scene->position_m + 3 * (size_t)scene->end[2 * i_cable];
    const double *b = scene->position_m + 3 * (size_t)scene->end[2 * i_cable + 1];
    return hf_distance(a, b);
}

/* ---- checks ---- */

void hf_scene_location(const hf_scene *s, bool is_cable, int index, char *text, size_t size)
{
    const int *line = is_cable ? s->cable_line : s->node_line;
    const char *file = is_cable ? s->cables_file : s->nodes_file, *kind = is_cable ? "cable" : "node";
    const char *id = is_cable ? s->cable_id[index] : s->node_id[index];
    if (line && file)
        snprintf(text, size, "%s:%d: %s '%s'", file, line[index], kind, id);
    else
        snprintf(text, size, "scene: %s '%s'", kind, id);
    hf_text_trim_utf8(text);
}

void hf_scene_fault(const hf_scene *s, bool is_cable, int index, int *n_fault, const char *what, hf_messages *messages)
{
    char where[HF_SCENE_LOCATION_SIZE];
    if (++*n_fault > HF_FAULT_MAX) return;
    hf_scene_location(s, is_cable, index, where, sizeof where);
    hf_error(messages, HF_BAD_CASE, "%s %s", where, what);
}

static void check_nodes(const hf_scene *s, int *n_fault, hf_messages *messages)
{
    for (int i = 0; i < s->n_node; i++)
        for (int c = 0; c < 3; c++) {
            if (!isfinite(s->position_m[3 * i + c]))
                hf_scene_fault(s, false, i, n_fault, "has a position that is no number", messages);
            if (s->load_N && !isfinite(s->load_N[3 * i + c]))
                hf_scene_fault(s, false, i, n_fault, "has a load that is no number", messages);
        }
}

/* Checks a cable whose law needs EA_N. Its target must also be above zero. */
static void check_elastic(const hf_scene *s, int e, int *n_fault, hf_messages *messages)
{
    char what[96];
    const char *word = hf_law_word[s->law[e]];
    snprintf(what, sizeof what, "has the law %s, but no %s above zero", word, hf_law_target_name[s->law[e]]);
    if (!(s->target[e] > 0)) hf_scene_fault(s, true, e, n_fault, what, messages);
    snprintf(what, sizeof what, "has the law %s, but no EA_N above zero", word);
    if (!(s->EA_N && s->EA_N[e] > 0)) hf_scene_fault(s, true, e, n_fault, what, messages);
}

static void check_cables(const hf_scene *s, int *n_fault, hf_messages *messages)
{
    for (int e = 0; e < s->n_cable; e++) {
        int a = s->end[2 * e], b = s->end[2 * e + 1];
        if (a == b)
            hf_scene_fault(s, true, e, n_fault, "joins a node to itself", messages);
        else if (!(hf_scene_length_at_target(s, e) > 0))
            hf_scene_fault(s, true, e, n_fault, "has zero length: its two nodes are at the same position", messages);
        if (hf_law_has(s->law[e], HF_LAW_NEEDS_EA)) check_elastic(s, e, n_fault, messages);
    }
}

/* Checks that cables connect every free node with a support. Cables join nodes into classes, and each class
 * needs a support. */
static hf_status check_anchored(const hf_scene *s, int *n_fault, hf_messages *messages)
{
    int *parent;
    bool *is_anchored;
    void *block;
    if (HF_ARENA_ARRAYS(&block, HF_ARRAY(parent, s->n_node), HF_ARRAY(is_anchored, s->n_node)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "scene: out of memory");
    for (int i = 0; i < s->n_node; i++)
        parent[i] = i;
    for (int e = 0; e < s->n_cable; e++)
        hf_union_find_join(parent, s->end[2 * e], s->end[2 * e + 1]);
    for (int i = 0; i < s->n_node; i++)
        if (s->role[i] == HF_ROLE_SUPPORT) is_anchored[hf_union_find_root(parent, i)] = true;
    for (int i = 0; i < s->n_node; i++)
        if (!is_anchored[hf_union_find_root(parent, i)])
            hf_scene_fault(s, false, i, n_fault, "has no path of cables to a support; connect it or remove it",
                           messages);
    hf_arena_free_block(block);
    return HF_OK;
}

hf_status hf_scene_check(const hf_scene *scene, hf_messages *messages)
{
    int n_fault = 0, n_free = 0, n_inner = 0;
    for (int i = 0; i < scene->n_node; i++) {
        n_free += scene->role[i] != HF_ROLE_SUPPORT;
        n_inner += scene->role[i] == HF_ROLE_INNER;
    }
    if (n_free == 0)
        return hf_error(messages, HF_BAD_CASE, "scene: the net has no free nodes, because every node is a support");
    if (n_inner == 0)
        return hf_error(messages, HF_BAD_CASE,
                        "scene: no node has the role 'inner', so psi would include no nodes. Give "
                        "the role 'inner' to the nodes on the surface");
    if (n_free == scene->n_node)
        return hf_error(messages, HF_BAD_CASE,
                        "scene: no node has the role 'support', so the net has no supports. Give the role 'support' to "
                        "the nodes that do not move");
    check_nodes(scene, &n_fault, messages);
    if (n_fault == 0) check_cables(scene, &n_fault, messages);
    HF_TRY(check_anchored(scene, &n_fault, messages));
    if (n_fault > HF_FAULT_MAX)
        hf_error(messages, HF_BAD_CASE, "scene: hifdm found %d more faults in this net", n_fault - HF_FAULT_MAX);
    return n_fault ? HF_BAD_CASE : HF_OK;
}

/* ---- comparison of two scenes ---- */

bool hf_scene_numbers_agree(size_t n, const double *a, const double *b)
{
    double size = 0;
    if (!a || !b) return !a && !b;
    for (size_t i = 0; i < n; i++)
        if (isfinite(a[i])) size = fmax(size, fabs(a[i]));
    for (size_t i = 0; i < n; i++) {
        bool is_same = a[i] == b[i] || (isnan(a[i]) && isnan(b[i]));
        if (!is_same && !(fabs(a[i] - b[i]) <= ROUNDING * size)) return false;
    }
    return true;
}

static bool have_same_ids(int n, const char *const *a, const char *const *b)
{
    for (int i = 0; i < n; i++)
        if (strcmp(a[i], b[i]) != 0) return false;
    return true;
}

const char *hf_scene_difference(const hf_scene *a, const hf_scene *b)
{
    size_t n = (size_t)a->n_node, n_cable = (size_t)a->n_cable;
    if (a->n_node != b->n_node || !have_same_ids(a->n_node, a->node_id, b->node_id)) return "nodes";
    if (memcmp(a->role, b->role, n) != 0) return "roles of nodes";
    if (!hf_scene_numbers_agree(3 * n, a->position_m, b->position_m)) return "target positions of nodes";
    if (a->n_cable != b->n_cable || !have_same_ids(a->n_cable, a->cable_id, b->cable_id)) return "cables";
    if (memcmp(a->end, b->end, 2 * n_cable * sizeof *a->end) != 0) return "ends of cables";
    return NULL;
}
