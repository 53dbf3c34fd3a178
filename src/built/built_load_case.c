/* Sets the cut lengths, supports and loads of the as-built net in one load case (METHOD section 12). */
#include "built/loaded.h"

#include "linalg/dot.h"

void hf_built_add_weight(const hf_built *b, const hf_material *t, const double g[3], double *load_N)
{
    const hf_model *m = &b->model;
    const hf_scene *s = &b->scene;
    for (int c = 0; c < 3; c++) {
        double *load = load_N + (size_t)c * (size_t)m->n_node;
        for (int i = 0; i < s->n_node; i++)
            load[m->row_of_node[i]] += t->node_mass_kg[i] * g[c];
        for (int e = 0; e < s->n_cable; e++)
            for (int k = 0; k < 2; k++) /* the mass is that of the unstressed length */
                load[m->end_row[2 * e + k]] += t->mass_kg_per_m[e] * s->target[e] * g[c] / 2;
    }
}

void hf_built_load_case(const hf_built *b, const hf_material *t, const hf_load_case *load_case,
                        const double *attachment_move_m, double *cut_m, double *move_m, double *load_N,
                        hf_built_net *net)
{
    const hf_model *m = &b->model;
    const double *g = load_case->gravity_m_per_s2;
    size_t n = (size_t)m->n_node;
    for (int e = 0; e < m->n_cable; e++) {
        cut_m[e] = b->scene.target[e];
        if (load_case->rise_K[e] != 0) cut_m[e] *= 1 + t->expansion_per_K[e] * load_case->rise_K[e];
    }
    hf_copy(3 * n, m->load_N, load_N);
    for (size_t row = 0; row < n; row++)
        for (size_t c = 0; c < 3; c++) {
            size_t at = 3 * (size_t)m->node_of_row[row] + c;
            load_N[c * n + row] += load_case->force_N[at];
            move_m[c * n + row] = load_case->support_displacement_m[at];
        }
    for (int k = 0; attachment_move_m && k < m->n_attachment; k++)
        for (size_t c = 0; c < 3; c++)
            move_m[c * n + (size_t)m->attachment_row[k]] += attachment_move_m[3 * k + (int)c];
    if (g[0] != 0 || g[1] != 0 || g[2] != 0) hf_built_add_weight(b, t, g, load_N);
    *net = (hf_built_net){.cut_m = cut_m, .support_displacement_m = move_m, .load_N = load_N};
}
