/* laws - what tests of cable laws need in addition to nets.h. Sections: random nets; shapes, and changes of a scene. */
#pragma once

#include "nets.h"

/* ---- random nets ---- */

/* Makes a random connected net under load. Its force densities are positive and span a decade, so the force density
 * method has exactly one answer. The first three nodes are always supports, so that every net is held. */
static inline void random_fdm_scene(struct rng *rng, hf_scene *scene)
{
    enum { MAX_NODE = 60, MAX_CABLE = 3 * MAX_NODE };
    struct hand_node node[MAX_NODE];
    struct hand_cable cable[MAX_CABLE];
    int n_node = rng_int(rng, 5, MAX_NODE), n_cable = rng_int(rng, n_node, MAX_CABLE);
    for (int i = 0; i < n_node; i++) {
        int is_support = i < 3 || (i > 3 && rng_int(rng, 0, 5) == 0); /* node 3 is always free */
        node[i] = (struct hand_node){.role = is_support ? HF_ROLE_SUPPORT : HF_ROLE_INNER};
        for (int c = 0; c < 3; c++)
            node[i].position_m[c] = rng_uniform(rng, -2.385, 2.385);
        for (int c = 0; c < 3; c++)
            node[i].load_N[c] = rng_uniform(rng, -1.25, 1.25);
    }
    for (int e = 0; e < n_cable; e++) { /* the first n_node - 1 cables are a tree that joins all nodes */
        int i = e + 1 < n_node ? e + 1 : rng_int(rng, 1, n_node - 1), j = rng_int(rng, 0, i - 1);
        double q = exp(rng_uniform(rng, log(0.317), log(3.17)));
        cable[e] = (struct hand_cable){{i, j}, e % 3 ? HF_GROUP_INNER : HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, q};
    }
    hand_scene(scene, n_node, node, n_cable, cable);
}

/* Makes a net of quadrilaterals over a random saddle, with randomly displaced nodes and a fixed perimeter. Tensions are
 * 10 N +- 10 %, but nearly equal along a line. Small kinks at the crossing cables balance the differences, so no cable
 * collapses. */
static inline void random_tension_scene(struct rng *rng, hf_scene *scene)
{
    enum { MAX_SIDE = 8 };
    struct hand_node node[MAX_SIDE * MAX_SIDE];
    struct hand_cable cable[2 * MAX_SIDE * MAX_SIDE];
    int nx = rng_int(rng, 4, MAX_SIDE), ny = rng_int(rng, 4, MAX_SIDE), n_cable = 0;
    double line_N[2][MAX_SIDE];
    for (int k = 0; k < 2 * MAX_SIDE; k++)
        line_N[k / MAX_SIDE][k % MAX_SIDE] = rng_uniform(rng, 9, 11);
    double bend_x = rng_uniform(rng, 0.02, 0.06), bend_y = -rng_uniform(rng, 0.02, 0.06);
    for (int k = 0; k < nx * ny; k++) {
        int i = k % nx, j = k / nx, is_support = i == 0 || j == 0 || i == nx - 1 || j == ny - 1;
        double x = i + rng_uniform(rng, -0.1, 0.1), y = 1.2 * j + rng_uniform(rng, -0.1, 0.1);
        node[k] = (struct hand_node){.position_m = {x, y, bend_x * x * x + bend_y * y * y},
                                     .role = is_support ? HF_ROLE_SUPPORT : HF_ROLE_INNER,
                                     .load_N = {0, 0, rng_uniform(rng, -0.3, 0.3)}};
        for (int axis = 0; axis < 2; axis++) {
            if (axis == 0 ? i + 1 == nx || j == 0 || j == ny - 1 : j + 1 == ny || i == 0 || i == nx - 1) continue;
            double tension_N = line_N[axis][axis == 0 ? j : i] * rng_uniform(rng, 0.99, 1.01);
            int next = axis == 0 ? k + 1 : k + nx;
            cable[n_cable++] = (struct hand_cable){{k, next}, HF_GROUP_INNER, HF_LAW_TENSION, tension_N};
        }
    }
    hand_scene(scene, nx * ny, node, n_cable, cable);
}

/* Makes a cylinder of random size, topology and scallop, with supports at the module corners. Its outer edge has the
 * law length. */
static inline void random_reflector_scene(struct rng *rng, hf_scene *scene)
{
    hf_messages messages = {0};
    hf_cylinder cylinder = {.aperture_m = rng_uniform(rng, 3, 5),
                            .length_m = rng_uniform(rng, 3, 5),
                            .focal_length_m = rng_uniform(rng, 3, 8),
                            .modules = {rng_int(rng, 2, 4), rng_int(rng, 2, 4)},
                            .cells_per_module = {2, 2},
                            .spacing = (hf_spacing)rng_int(rng, 0, 1),
                            .boundary = HF_BOUNDARY_OUTER_EDGE,
                            .scallop = rng_uniform(rng, 0.08, 0.12),
                            .supports = HF_SUPPORTS_MODULE_CORNERS};
    ck_assert_msg(hf_scene_parabolic_cylinder(&cylinder, NULL, scene, &messages) == HF_OK, "%s", messages.text);
}

/* ---- shapes, and changes of a scene ---- */

/* Returns the found shape in the order of the scene, [n_node][3]; the caller frees it. */
static inline double *copy_shape(const struct net *net)
{
    double *shape = malloc(3 * (size_t)net->scene.n_node * sizeof *shape);
    ck_assert_ptr_nonnull(shape);
    for (int k = 0; k < 3 * net->scene.n_node; k++)
        shape[k] = found_m(net, k / 3, k % 3);
    return shape;
}

static inline double largest(const double *a, int n)
{
    double most = 0;
    for (int i = 0; i < n; i++)
        most = fmax(most, fabs(a[i]));
    return most;
}

static inline double length_between(const double *shape, const int end[2])
{
    const double *a = shape + 3 * end[0], *b = shape + 3 * end[1];
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* Maps positions p to M p + t and loads P to M P. */
static inline void map_scene(hf_scene *scene, const double m[3][3], const double t[3])
{
    for (int i = 0; i < scene->n_node; i++)
        for (int what = 0; what < (scene->load_N ? 2 : 1); what++) {
            double *v = (what ? scene->load_N : scene->position_m) + 3 * i, old[3] = {v[0], v[1], v[2]};
            for (int c = 0; c < 3; c++) {
                v[c] = m[c][0] * old[0] + m[c][1] * old[1] + m[c][2] * old[2] + (what ? 0 : t[c]);
            }
        }
}

/* Makes a random rotation from a unit quaternion. */
static inline void random_rotation(struct rng *rng, double m[3][3])
{
    double q[4], norm = 0;
    for (int k = 0; k < 4; k++)
        q[k] = rng_uniform(rng, -1, 1), norm += q[k] * q[k];
    double w = q[0] / sqrt(norm), x = q[1] / sqrt(norm), y = q[2] / sqrt(norm), z = q[3] / sqrt(norm);
    const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    memcpy(m, r, sizeof r);
}

/* Shuffles nodes and cables of a scene and reverses some cables. Node i becomes node to[i]. */
static inline void shuffle_scene(struct rng *rng, hf_scene *scene, int *to)
{
    hf_scene s;
    int n = scene->n_node, *cable_to = malloc((size_t)scene->n_cable * sizeof *cable_to);
    ck_assert_ptr_nonnull(cable_to);
    ck_assert_int_eq(hf_scene_allocate(&s, n, scene->n_cable, scene->load_N != NULL, 0, 0), HF_OK);
    for (int pass = 0; pass < 2; pass++) {
        int *place = pass ? cable_to : to, count = pass ? scene->n_cable : n;
        for (int i = 0; i < count; i++) { /* Fisher-Yates shuffle, inside-out */
            int j = rng_int(rng, 0, i);
            place[i] = place[j];
            place[j] = i;
        }
    }
    for (int i = 0; i < n; i++) {
        memcpy(s.position_m + 3 * to[i], scene->position_m + 3 * i, 3 * sizeof(double));
        if (s.load_N) memcpy(s.load_N + 3 * to[i], scene->load_N + 3 * i, 3 * sizeof(double));
        s.role[to[i]] = scene->role[i];
        s.node_id[to[i]] = scene->node_id[i];
    }
    for (int e = 0; e < scene->n_cable; e++) {
        int k = cable_to[e], turn = rng_int(rng, 0, 1);
        for (int side = 0; side < 2; side++)
            s.end[2 * k + (side ^ turn)] = to[scene->end[2 * e + side]];
        s.group[k] = scene->group[e];
        s.law[k] = scene->law[e];
        s.target[k] = scene->target[e];
        s.cable_id[k] = scene->cable_id[e];
    }
    s.text = scene->text; /* the text of the ids */
    scene->text = NULL;
    hf_scene_free(scene);
    free(cable_to);
    *scene = s;
}

/* Solves net->scene as it is now, closes the net and returns the shape, which the caller frees. */
static inline double *shape_of(struct net *net)
{
    open_net(net);
    ck_assert_msg(find_shape(net) == HF_OK, "%s", hf_status_word(net->result.status));
    double *shape = copy_shape(net);
    close_net(net);
    return shape;
}
