/* nets - nets for tests, written by hand or from a case file. Header only, because most test files need two or three of
 * these functions and none needs all. Sections: opening and closing, nets by hand, nets from a case. */
#pragma once

#include "poison.h"
#include "support.h"
#include "valid.h"

#include <hifdm/config.h>
#include <hifdm/formfind.h>
#include <hifdm/metrics.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct net {
    hf_case settings; /* only for a net from a case */
    hf_form_settings form;
    hf_scene scene;
    hf_model model;
    hf_workspace work;
    hf_form_result result; /* of the last find_shape */
};

/* ---- opening and closing ---- */

/* Returns settings with tolerances far below the defaults of a case file. A test then compares laws, and not where the
 * iteration stopped. */
static inline hf_form_settings tight_form(int method)
{
    return (hf_form_settings){.method = (hf_method)method,
                              .pretension_N = 10,
                              .stop = HF_STOP_RESIDUAL,
                              .residual_tolerance = 1e-11,
                              .length_tolerance = 1e-11,
                              .rms_tolerance_m = 1e-6,
                              .max_iterations = 100000,
                              .collapse_ratio = 1e-3};
}

/* Makes model and workspace of net->scene under net->form. The workspace is filled with garbage, because its content
 * between calls has no meaning. */
static inline void open_net(struct net *net)
{
    hf_messages messages = {0};
    ck_assert_msg(hf_model_build(&net->scene, &net->form, &net->model, &messages) == HF_OK, "%s", messages.text);
    ck_assert(model_is_valid(&net->model));
    ck_assert_int_eq(hf_workspace_create(&net->model, &net->work), HF_OK);
    poison_workspace(&net->model, &net->work);
}

static inline void close_net(struct net *net)
{
    hf_workspace_free(&net->work);
    hf_model_free(&net->model);
    hf_scene_free(&net->scene);
    hf_case_free(&net->settings);
}

/* Finds the shape from the first force densities of the model, with the stop criterion of the settings. */
static inline hf_status find_shape(struct net *net)
{
    hf_form_prepare(&net->model, &net->work);
    return hf_form_find(&net->model, &net->form, net->form.stop, &net->work, NULL, &net->result);
}

/* Returns component c (0, 1, 2) of the found position of node i of the scene, m. */
static inline double found_m(const struct net *net, int i_node, int c)
{
    return net->work.position_m[c * net->model.n_node + net->model.row_of_node[i_node]];
}

/* ---- nets by hand ---- */

struct hand_node {
    double position_m[3];
    hf_role role;
    double load_N[3];
};

struct hand_cable {
    int end[2];
    hf_group group;
    hf_law law;
    double target; /* T* (N), L* (m) or q (N/m), by law */
};

/* Makes a scene. The ids are n0, n1, ... and c0, c1, ... The scene has loads if one of them is not zero. */
static inline void hand_scene(hf_scene *scene, int n_node, const struct hand_node *node, int n_cable,
                              const struct hand_cable *cable)
{
    int with_load = 0;
    for (int i = 0; i < 3 * n_node; i++)
        with_load |= node[i / 3].load_N[i % 3] != 0;
    ck_assert_int_eq(hf_scene_allocate(scene, n_node, n_cable, with_load, 0, 0), HF_OK);
    char *text = scene->text = malloc(16 * (size_t)(n_node + n_cable));
    ck_assert_ptr_nonnull(text);
    for (int i = 0; i < n_node; i++, text += 16) {
        snprintf(text, 16, "n%d", i);
        scene->node_id[i] = text;
        scene->role[i] = (unsigned char)node[i].role;
        memcpy(scene->position_m + 3 * i, node[i].position_m, sizeof node[i].position_m);
        if (with_load) memcpy(scene->load_N + 3 * i, node[i].load_N, sizeof node[i].load_N);
    }
    for (int e = 0; e < n_cable; e++, text += 16) {
        snprintf(text, 16, "c%d", e);
        scene->cable_id[e] = text;
        memcpy(scene->end + 2 * e, cable[e].end, sizeof cable[e].end);
        scene->group[e] = (unsigned char)cable[e].group;
        scene->law[e] = (unsigned char)cable[e].law;
        scene->target[e] = cable[e].target;
    }
}

static inline void open_hand(struct net *net, int n_node, const struct hand_node *node, int n_cable,
                             const struct hand_cable *cable, int method)
{
    *net = (struct net){.form = tight_form(method)};
    hand_scene(&net->scene, n_node, node, n_cable, cable);
    open_net(net);
}

/* OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM) opens a net of two arrays. */
#define OPEN_HAND(pointer, nodes, cables, method)                                                                      \
    open_hand(pointer, (int)(sizeof(nodes) / sizeof *(nodes)), nodes, (int)(sizeof(cables) / sizeof *(cables)),        \
              cables, method)

/* ---- nets from a case ---- */

static inline void open_case_file(struct net *net, const char *path, const char *const *overrides, int n_override)
{
    hf_messages messages = {0};
    *net = (struct net){0};
    hf_status status = hf_config_load(path, overrides, n_override, &net->settings, &messages);
    if (status == HF_OK) status = hf_config_scene(&net->settings, &net->scene, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text);
    net->form = net->settings.form;
    open_net(net);
}

/* OPEN_CASE(&net, "configs/reflector.yaml", "form.pretension_N=12") opens a case file of the sources, with
 * overrides. */
#define OPEN_CASE(pointer, ...) open_case(pointer, (const char *const[]){__VA_ARGS__, NULL})

static inline void open_case(struct net *net, const char *const *argument)
{
    int n_override = 0;
    while (argument[n_override + 1])
        n_override++;
    open_case_file(net, source_path(argument[0]), argument + 1, n_override);
}

/* A small well-posed reflector with 9 x 11 nodes, a scalloped edge and supports at the corners of 4 x 5 modules. */
#define SMALL_REFLECTOR                                                                                                \
    "configs/reflector.yaml", "scene.parabolic_cylinder.modules=[4, 5]", "scene.parabolic_cylinder.aperture_m=4",      \
        "scene.parabolic_cylinder.length_m=5"
