#include "net/double_net.h"

#include "net/target_surface.h"

#include <math.h>
#include <stdio.h>

#define FOUND 1e-10 /* relative step at which Newton's method ends: the next step is below rounding */

const char *const hf_tie_direction_word[3] = {"z", "normal", NULL};
#define LAW_WORD(name, word, target, unit, flags) word,
const char *const hf_tie_law_word[HF_N_LAW + 1] = {HF_LAW_LIST(LAW_WORD) NULL};
#undef LAW_WORD

/* ---- positions ---- */

static double front_curvature(const hf_double_net *d)
{
    return 1 / (4 * d->focal_length_m);
}

/* Returns how the nets approach each other, 1/m: at the distance s from the middle, they are nearer than at the rim by
 * (half_m^2 - s^2) times this. */
static double nearing(const hf_double_net *d)
{
    return front_curvature(d) + 1 / (4 * d->rear_focal_length_m);
}

/* Returns z of the rear surface at x and y of point p, m, and its slopes. */
static double rear_height(const hf_double_net *d, const double p[3], double slope[2])
{
    bool is_round = d->kind == HF_SURFACE_PARABOLOID;
    double dx = p[0] - d->middle_x_m, dy = is_round ? p[1] : 0;
    double front_z = p[2] - hf_target_surface_height_above(d->kind, front_curvature(d), p, slope);
    slope[0] -= 2 * nearing(d) * dx;
    slope[1] -= 2 * nearing(d) * dy;
    return front_z + (d->half_m * d->half_m - dx * dx - dy * dy) * nearing(d) - d->distance_m;
}

bool hf_double_net_behind(const hf_double_net *d, bool along_z, const double front_m[3], double rear_m[3])
{
    double slope[2], normal[3] = {0, 0, -1}, t = 0;
    bool is_found = along_z;
    hf_target_surface_height_above(d->kind, front_curvature(d), front_m, slope);
    for (int c = 0; c < 3; c++)
        rear_m[c] = front_m[c];
    if (!along_z) normal[0] = slope[0], normal[1] = slope[1];
    for (int i = 0; i < 60 && !is_found; i++) { /* Newton's method for the length along the normal */
        for (int c = 0; c < 3; c++)
            rear_m[c] = front_m[c] + t * normal[c];
        double above = rear_m[2] - rear_height(d, rear_m, slope);
        double step = above / (normal[2] - slope[0] * normal[0] - slope[1] * normal[1]);
        t -= step;
        is_found = fabs(step) <= FOUND * fabs(t);
    }
    for (int c = 0; c < 2; c++)
        rear_m[c] = front_m[c] + t * normal[c];
    rear_m[2] = rear_height(d, rear_m, slope);
    return is_found && rear_m[2] < front_m[2];
}

const char *hf_double_net_fault(const hf_double_net *d, char *what, size_t size)
{
    double nearer_m = d->half_m * d->half_m * nearing(d);
    if (d->distance_m == 0 || d->distance_m > nearer_m) return NULL;
    snprintf(what, size, "of %.6g m lets the nets meet in the middle, where they come %.6g m nearer than at the rim",
             d->distance_m, nearer_m);
    return "rear_distance_m";
}

bool hf_double_net_lacks_EA(const hf_double_net *d, const double EA_N[2])
{
    return d->distance_m > 0 && d->law == HF_LAW_ELASTIC && !(EA_N && EA_N[HF_GROUP_INNER] > 0);
}

/* ---- cables ---- */

/* Returns the target value of a tie by its law. With the laws tension, force_density and elastic, its tension at this
 * length is tension_N. */
static double tie_target(const hf_double_net *d, double length, double EA_N)
{
    switch (d->law) {
    case HF_LAW_TENSION:
        return d->tension_N;
    case HF_LAW_FORCE_DENSITY:
        return d->tension_N / length;
    case HF_LAW_ELASTIC:
        return length / (1 + d->tension_N / EA_N);
    default:
        return length;
    }
}

void hf_double_net_put_cable(const double EA_N[2], int e, int a, int b, hf_group group, hf_law law, hf_scene *s)
{
    s->end[2 * e] = a;
    s->end[2 * e + 1] = b;
    s->group[e] = (unsigned char)group;
    s->law[e] = (unsigned char)law;
    s->target[e] = hf_law_default_target(law, hf_scene_length_at_target(s, e));
    if (s->EA_N) s->EA_N[e] = EA_N[group] > 0 ? EA_N[group] : (double)NAN;
}

void hf_double_net_fill(const hf_double_net *d, const double EA_N[2], int n_front, int m_front, hf_scene *s)
{
    int m = 2 * m_front;
    for (int i = 0; i < n_front; i++) {
        bool is_support = s->role[i] == HF_ROLE_SUPPORT;
        const double *front = s->position_m + 3 * (size_t)i;
        hf_double_net_behind(d, d->direction == HF_TIES_ALONG_Z || (is_support && d->supports_along_z), front,
                             s->position_m + 3 * (size_t)(n_front + i));
        s->role[n_front + i] = is_support ? HF_ROLE_SUPPORT : HF_ROLE_EDGE;
    }
    for (int e = 0; e < m_front; e++)
        hf_double_net_put_cable(EA_N, m_front + e, n_front + s->end[2 * e], n_front + s->end[2 * e + 1], s->group[e],
                                s->law[e], s);
    for (int i = 0; i < n_front; i++) {
        if (s->role[i] == HF_ROLE_SUPPORT) continue;
        hf_double_net_put_cable(EA_N, m, i, n_front + i, HF_GROUP_INNER, d->law, s);
        s->target[m] = tie_target(d, hf_scene_length_at_target(s, m), s->EA_N ? s->EA_N[m] : (double)NAN);
        m++;
    }
}

int hf_double_net_join(hf_cable_set_member *member, int n_member, int m_front, int n_tie, const int *rear_set,
                       int tie_set)
{
    int n = n_member;
    for (int k = 0; k < n_member; k++, n++)
        if (member) member[n] = (hf_cable_set_member){rear_set[member[k].set], m_front + member[k].cable};
    for (int k = 0; k < n_tie; k++, n++)
        if (member) member[n] = (hf_cable_set_member){tie_set, 2 * m_front + k};
    return n;
}

/* ---- names ---- */

void hf_double_net_name(hf_scene *s, int n_front, char *text, const char *end)
{
    for (int i = n_front; i < s->n_node; i++) {
        const char *front = s->node_id[i - n_front];
        s->node_id[i] = text;
        text += snprintf(text, (size_t)(end - text), "r%s", front + (*front == 'f' || *front == 'n')) + 1;
    }
    for (int e = 0; e < s->n_cable; e++) {
        s->cable_id[e] = text;
        text +=
            snprintf(text, (size_t)(end - text), "%s-%s", s->node_id[s->end[2 * e]], s->node_id[s->end[2 * e + 1]]) + 1;
    }
}
