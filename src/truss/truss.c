/* Functions for all trusses, generated or imported. Contents: words - memory - measures - attachments - checks */
#include <hifdm/truss.h>

#include "base/arena.h"
#include "base/text.h"
#include "base/elementary.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

const char *const hf_dof_word[HF_TRUSS_DOF] = {"ux", "uy", "uz", "rx", "ry", "rz"};
const char *const hf_joint_word[3] = {"rigid", "pinned", NULL};
const char *const hf_unit_word[HF_N_UNIT] = {"bud", "mbug", "abug", "other", "longeron", "vertical", "diagonal"};

/* ---- memory ---- */

hf_status hf_truss_allocate(hf_truss *t, int n_node, int n_member, bool with_line)
{
    size_t n = (size_t)n_node, m = (size_t)n_member;
    *t = (hf_truss){0};
#define NUMBERS(name, ...) HF_ARRAY(t->name, m),
    HF_TRY(HF_ARENA_ARRAYS(&t->block, HF_MEMBER_NUMBERS(NUMBERS) HF_ARRAY(t->position_m, 3 * n), HF_ARRAY(t->fixed, n),
                           HF_ARRAY(t->mass_kg, n), HF_ARRAY(t->end, 2 * m), HF_ARRAY(t->joint, m),
                           HF_ARRAY(t->unit, m), HF_ARRAY(t->node_id, n), HF_ARRAY(t->member_id, m),
                           HF_ARRAY(t->node_line, with_line ? n : 0), HF_ARRAY(t->member_line, with_line ? m : 0)));
#undef NUMBERS
    if (!with_line) t->node_line = t->member_line = NULL;
    t->n_node = n_node;
    t->n_member = n_member;
    return HF_OK;
}

void hf_truss_free(hf_truss *truss)
{
    hf_arena_free_block(truss->block);
    free(truss->text);
    *truss = (hf_truss){0};
}

/* ---- measures ---- */

double hf_truss_member_length(const hf_truss *t, int i_member)
{
    const double *a = t->position_m + 3 * (size_t)t->end[2 * i_member];
    const double *b = t->position_m + 3 * (size_t)t->end[2 * i_member + 1];
    return hf_distance(a, b);
}

double hf_truss_mass(const hf_truss *t)
{
    double mass = 0;
    for (int i = 0; i < t->n_node; i++)
        mass += t->mass_kg[i];
    for (int e = 0; e < t->n_member; e++)
        mass += t->density_kg_per_m3[e] * t->A_m2[e] * hf_truss_member_length(t, e);
    return mass;
}

/* ---- attachments ---- */

hf_status hf_truss_attach(const hf_truss *t, const hf_scene *scene, double tolerance_m, int *n_attachment,
                          int *scene_node, int *truss_node, hf_messages *messages)
{
    int n_fault = 0;
    *n_attachment = 0;
    for (int i = 0; i < scene->n_node; i++) {
        if (scene->role[i] != HF_ROLE_SUPPORT) continue;
        const double *p = scene->position_m + 3 * (size_t)i;
        int nearest = 0;
        for (int k = 1; k < t->n_node; k++)
            if (hf_distance(p, t->position_m + 3 * (size_t)k) < hf_distance(p, t->position_m + 3 * (size_t)nearest))
                nearest = k;
        double gap = hf_distance(p, t->position_m + 3 * (size_t)nearest);
        if (!(gap <= tolerance_m) && ++n_fault <= HF_FAULT_MAX)
            hf_error(messages, HF_BAD_CASE,
                     "truss: net support '%s' has no attachment, because the nearest truss node '%s' is %.3g m away. "
                     "The maximum distance truss.match_tolerance_m is %g m",
                     scene->node_id[i], t->node_id[nearest], gap, tolerance_m);
        scene_node[*n_attachment] = i;
        truss_node[(*n_attachment)++] = nearest;
    }
    if (n_fault > HF_FAULT_MAX)
        hf_error(messages, HF_BAD_CASE, "truss: %d more net supports have no attachment", n_fault - HF_FAULT_MAX);
    return n_fault ? HF_BAD_CASE : HF_OK;
}

/* ---- checks ---- */

void hf_truss_describe(const hf_truss *t, bool is_member, int index, char *text, size_t size)
{
    const int *line = is_member ? t->member_line : t->node_line;
    const char *file = is_member ? t->members_file : t->nodes_file, *kind = is_member ? "member" : "node";
    const char *id = is_member ? t->member_id[index] : t->node_id[index];
    if (line && file)
        snprintf(text, size, "%s:%d: %s '%s'", file, line[index], kind, id);
    else
        snprintf(text, size, "truss: %s '%s'", kind, id);
    hf_text_trim_utf8(text);
}

static void fault(const hf_truss *t, bool is_member, int index, int *n_fault, const char *what, hf_messages *messages)
{
    char where[HF_TRUSS_DESCRIPTION_SIZE];
    if (++*n_fault > HF_FAULT_MAX) return;
    hf_truss_describe(t, is_member, index, where, sizeof where);
    hf_error(messages, HF_BAD_CASE, "%s %s", where, what);
}

static void check_member(const hf_truss *t, int e, int *n_fault, hf_messages *messages)
{
    int rigid = t->joint[e] == HF_JOINT_RIGID;
    const double positive[] = {t->E_Pa[e],  t->A_m2[e], t->G_Pa[e],   t->Iy_m4[e],
                               t->Iz_m4[e], t->J_m4[e], t->Asy_m2[e], t->Asz_m2[e]};
    int all = 1;
    for (size_t k = 0; k < (rigid ? sizeof positive / sizeof *positive : 2); k++)
        all = all && positive[k] > 0 && (k > 5 || isfinite(positive[k]));
    if (!all)
        fault(t, true, e, n_fault,
              rigid ? "needs E, G, A, Iy, Iz, J and shear areas above zero" : "needs E and A above zero", messages);
    if (!isfinite(t->roll_rad[e]) || !isfinite(t->expansion_per_K[e]) || !(t->density_kg_per_m3[e] >= 0) ||
        !isfinite(t->density_kg_per_m3[e]))
        fault(t, true, e, n_fault, "needs a finite roll and expansion, and a density that is not below zero", messages);
    if (t->end[2 * e] == t->end[2 * e + 1])
        fault(t, true, e, n_fault, "joins a node to itself", messages);
    else if (!(hf_truss_member_length(t, e) > 0))
        fault(t, true, e, n_fault, "has zero length: its two nodes are at the same position", messages);
}

hf_status hf_truss_check(const hf_truss *t, hf_messages *messages)
{
    int n_fault = 0;
    for (int i = 0; i < t->n_node; i++) {
        const double *p = t->position_m + 3 * (size_t)i;
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
            fault(t, false, i, &n_fault, "has a position that is no number", messages);
        if (!(t->mass_kg[i] >= 0) || !isfinite(t->mass_kg[i]))
            fault(t, false, i, &n_fault, "has a mass that is no number or below zero", messages);
    }
    for (int e = 0; e < t->n_member && n_fault <= HF_FAULT_MAX; e++)
        check_member(t, e, &n_fault, messages);
    if (n_fault > HF_FAULT_MAX) hf_error(messages, HF_BAD_CASE, "truss: hifdm found more faults in the truss");
    return n_fault ? HF_BAD_CASE : HF_OK;
}
