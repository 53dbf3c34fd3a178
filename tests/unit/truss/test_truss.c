/* Contents: the generator - attachments - import */
#include "trusses.h"

#include <hifdm/config.h>
#include "truss/truss_import.h"

/* ---- the generator ---- */

static const hf_cylinder paper = {.aperture_m = 10,
                                  .length_m = 12,
                                  .focal_length_m = 70.6,
                                  .modules = {5, 5},
                                  .cells_per_module = {2, 2},
                                  .boundary = HF_BOUNDARY_MODULE_EDGES};

static hf_truss_settings settings(void)
{
    return (hf_truss_settings){.depth_m = 1,
                               .main_every = 2,
                               .bud = {0.03, 0.001, 2, HF_DIAGONALS_SINGLE},
                               .mbug = {0.03, 0.001, 1, HF_DIAGONALS_SINGLE},
                               .abug = {0.025, 0.001, 1, HF_DIAGONALS_SINGLE},
                               .E_Pa = 130e9,
                               .G_Pa = 5e9,
                               .density_kg_per_m3 = 1600,
                               .hinge_mass_kg = 1,
                               .match_tolerance_m = 1e-6};
}

static void generate(const hf_truss_settings *set, const hf_cylinder *cylinder, hf_truss *t)
{
    hf_messages messages = {0};
    ck_assert_msg(hf_truss_generate(set, cylinder, t, &messages) == HF_OK, "%s", messages.text);
    ck_assert_msg(hf_truss_check(t, &messages) == HF_OK, "%s", messages.text);
    ck_assert_ptr_null(messages.text);
}

static int count_units(const hf_truss *t, int unit)
{
    int n = 0;
    for (int e = 0; e < t->n_member; e++)
        n += t->unit[e] == unit;
    return n;
}

/* 6 ribs of 10 panels, 4 main and 2 assistant lines of 5 panels. */
START_TEST(sub_rings)
{
    hf_truss t;
    hf_truss_settings set = settings();
    generate(&set, &paper, &t);
    ck_assert_int_eq(t.n_node, 2 * 6 * (10 + 1));
    ck_assert_int_eq(count_units(&t, HF_UNIT_BUD), 6 * (10 * 3 + 11)); /* two chords, a diagonal; posts */
    ck_assert_int_eq(count_units(&t, HF_UNIT_MBUG), 4 * 5 * 3);
    ck_assert_int_eq(count_units(&t, HF_UNIT_ABUG), 2 * 5 * 3);
    ck_assert_int_eq(t.n_member, 6 * 41 + 60 + 30);
    for (int i = 0; i < t.n_node; i += 2) { /* front on the parabola, rear a depth behind, along the normal */
        const double *f = t.position_m + 3 * i, *r = f + 3;
        ck_assert_double_eq_tol(f[2], f[0] * f[0] / (4 * 70.6), 1e-14);
        ck_assert_double_eq_tol(hypot(f[0] - r[0], f[2] - r[2]), 1, 1e-14);
        ck_assert_double_eq(f[1], r[1]);
        ck_assert_double_eq_tol((f[0] - r[0]) + (f[2] - r[2]) * f[0] / (2 * 70.6), 0, 1e-14);
        ck_assert(t.node_id[i][0] == 'f' && t.node_id[i + 1][0] == 'r');
        ck_assert_str_eq(t.node_id[i] + 1, t.node_id[i + 1] + 1);
    }
    int n_fixed = 0;
    for (int i = 0; i < t.n_node; i++) {
        const double *p = t.position_m + 3 * i;
        ck_assert(t.fixed[i] ==
                  (fabs(p[0]) < 1.1 && fabs(p[1] - 6) < 1.3 && strchr(t.node_id[i], '.') == NULL ? 0x3f : 0));
        n_fixed += t.fixed[i] != 0;
    }
    ck_assert_int_eq(n_fixed, 8);
    hf_truss_free(&t);
}
END_TEST

/* The truss is symmetric about x = 0. */
START_TEST(ribs_are_symmetric)
{
    hf_truss t;
    hf_truss_settings set = settings();
    generate(&set, &paper, &t);
    int n_found = 0;
    for (int e = 0; e < t.n_member; e++)
        for (int k = 0; k < t.n_member; k++) {
            int same[2] = {1, 1}; /* end for end, and turned */
            for (int turn = 0; turn < 2; turn++)
                for (int end = 0; end < 2; end++) {
                    const double *a = t.position_m + 3 * t.end[2 * e + end];
                    const double *b = t.position_m + 3 * t.end[2 * k + (end ^ turn)];
                    same[turn] &= fabs(a[0] + b[0]) < 1e-12 && a[1] == b[1] && fabs(a[2] - b[2]) < 1e-12;
                }
            n_found += (same[0] || same[1]) && t.A_m2[e] == t.A_m2[k];
        }
    ck_assert_int_eq(n_found, t.n_member);
    hf_truss_free(&t);
}
END_TEST

/* 200 kg +- 5 % with the defaults of the case file, and the same by hand: tubes by length, hinges by node. */
START_TEST(mass_by_hand)
{
    hf_case c;
    hf_truss t;
    hf_messages messages = {0};
    ck_assert_int_eq(hf_config_load(source_path("configs/straight-edges.yaml"),
                                    (const char *const[]){"truss.depth_m=1"}, 1, &c, &messages),
                     HF_OK);
    ck_assert_int_eq(hf_config_truss(&c, &t, &messages), HF_OK);
    double mass = t.n_node;
    for (int e = 0; e < t.n_member; e++) {
        double outer = t.unit[e] == HF_UNIT_ABUG ? 0.0125 : 0.015,
               area = 3.141592653589793 * (pow(outer, 2) - pow(outer - 0.001, 2));
        ck_assert_double_eq_tol(t.A_m2[e], area, 1e-16);
        ck_assert_double_eq_tol(t.Iy_m4[e], area * (pow(outer, 2) + pow(outer - 0.001, 2)) / 4, 1e-21);
        mass += 1600 * area * hf_truss_member_length(&t, e);
    }
    ck_assert_double_eq_tol(hf_truss_mass(&t), mass, 1e-10);
    ck_assert_double_eq_tol(mass, 200, 10);
    hf_truss_free(&t);
    hf_case_free(&c);
    hf_messages_free(&messages);
}
END_TEST

/* Panels, diagonals, supports, theory and joints as asked for; counts by hand. */
START_TEST(every_choice)
{
    hf_truss t;
    hf_truss_settings set = settings();
    hf_cylinder c = paper;
    c.modules[0] = 4;
    c.modules[1] = 2;
    c.spacing = HF_SPACING_EQUAL_PROJECTED;
    set.main_every = 3; /* lines 0 and 4 are main, 1 to 3 assistant */
    set.bud.panels = 1;
    set.bud.diagonals = HF_DIAGONALS_CROSSED;
    set.mbug.panels = 3;
    set.abug.diagonals = HF_DIAGONALS_NONE;
    set.supports = HF_HELD_CENTRAL_MODULE_REAR;
    set.support_dofs = HF_HELD_TRANSLATIONS;
    set.theory = HF_THEORY_TIMOSHENKO;
    generate(&set, &c, &t);
    ck_assert_int_eq(t.n_node, 2 * 15 + 2 * 2 * 2 * 2);
    ck_assert_int_eq(count_units(&t, HF_UNIT_BUD), 15 + 3 * 4 * 4);
    ck_assert_int_eq(count_units(&t, HF_UNIT_MBUG), 2 * 2 * (3 * 3 + 2));
    ck_assert_int_eq(count_units(&t, HF_UNIT_ABUG), 3 * 2 * 2);
    int n_fixed = 0;
    for (int i = 0; i < t.n_node; i++) {
        n_fixed += t.fixed[i] != 0;
        if (t.fixed[i]) ck_assert(t.fixed[i] == 0x07 && strcmp(t.node_id[i], "r2_1") == 0);
    }
    ck_assert_int_eq(n_fixed, 1);
    for (int e = 0; e < t.n_member; e++)
        ck_assert_double_eq(t.Asy_m2[e], t.A_m2[e] / 2);
    hf_truss_free(&t);
}
END_TEST

/* The supports of edge ties stand outside the net, and the truss with them; uneven modules and ribs are followed. */
START_TEST(it_carries_edge_ties)
{
    hf_truss t;
    hf_truss_settings set = settings();
    hf_cylinder c = paper;
    hf_messages messages = {0};
    hf_scene net;
    c.edge_tie_m = 0.2;
    c.pattern = HF_PATTERN_DIAGONAL;
    c.supports = HF_SUPPORTS_RIBS;
    c.pitches_x_m.n = c.modules[0];
    for (int k = 0; k < c.modules[0]; k++)
        c.pitches_x_m.value[k] = c.aperture_m / c.modules[0] + (k == 0) - (k == 1);
    set.bud.panels = c.cells_per_module[0];
    generate(&set, &c, &t);
    ck_assert_int_eq(hf_scene_parabolic_cylinder(&c, NULL, &net, &messages), HF_OK);
    int n_attachment, n_support = 0, *node = calloc(2 * (size_t)net.n_node, sizeof *node);
    ck_assert_ptr_nonnull(node);
    for (int i = 0; i < net.n_node; i++)
        n_support += net.role[i] == HF_ROLE_SUPPORT;
    ck_assert_msg(hf_truss_attach(&t, &net, 1e-12, &n_attachment, node, node + net.n_node, &messages) == HF_OK, "%s",
                  messages.text);
    ck_assert_int_eq(n_attachment, n_support);
    free(node);
    hf_scene_free(&net);
    hf_truss_free(&t);
}
END_TEST

START_TEST(too_many_modules)
{
    hf_truss t;
    hf_truss_settings set = settings();
    hf_cylinder c = paper;
    hf_messages messages = {0};
    c.modules[0] = c.modules[1] = 2000;
    ck_assert_int_eq(hf_truss_generate(&set, &c, &t, &messages), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "truss: 16"));
    hf_truss_free(&t);
    hf_messages_free(&messages);
}
END_TEST

/* The flexibility that the net is given: symmetric, positive but for the attachments on supports, and what full solves
 * give; forces on the attachments are balanced by the reactions. */
START_TEST(what_the_net_is_given)
{
    hf_case c;
    hf_scene scene;
    hf_carrier carrier;
    hf_carrier_state state;
    hf_messages messages = {0};
    struct rng rng = rng_start(1);
    double force[108], sum[3] = {0}, most = 0;
    ck_assert_int_eq(hf_config_load(source_path("configs/straight-edges-truss.yaml"), NULL, 0, &c, &messages), HF_OK);
    ck_assert_int_eq(hf_config_scene(&c, &scene, &messages), HF_OK);
    ck_assert_msg(hf_config_carrier(&c, &scene, &carrier, &messages) == HF_OK, "%s", messages.text);
    ck_assert_int_eq(carrier.n_attachment, 36);
    for (int k = 0; k < 36; k++) {
        ck_assert_int_eq(scene.role[carrier.scene_node[k]], HF_ROLE_SUPPORT);
        for (int d = 0; d < 3; d++) {
            ck_assert_double_eq_tol(scene.position_m[3 * carrier.scene_node[k] + d],
                                    carrier.truss.position_m[3 * carrier.truss_node[k] + d], 1e-12);
            sum[d] += force[3 * k + d] = rng_uniform(&rng, -20, 20);
        }
    }
    ck_assert_int_eq(hf_carrier_load(&carrier, force, NULL, &state), HF_OK);
    for (int i = 0; i < 108; i++)
        for (int j = 0; j < 108; j++)
            most = fmax(most, fabs(carrier.flexibility_m_per_N[108 * i + j]));
    for (int i = 0; i < 108; i++) {
        double moved = 0;
        for (int j = 0; j < 108; j++)
            moved += carrier.flexibility_m_per_N[108 * i + j] * force[j];
        /* 1e-10 of the largest: rounding times the condition number 2e6 */
        ck_assert_double_eq_tol(moved, state.displacement[6 * carrier.truss_node[i / 3] + i % 3],
                                1e-10 * most * 108 * 20);
    }
    for (int i = 0; i < 6 * carrier.truss.n_node; i++)
        if (i % 6 < 3) sum[i % 6] += state.reaction[i];
    for (int d = 0; d < 3; d++)
        ck_assert_double_eq_tol(sum[d], 0, 1e-9 * 36 * 20);
    hf_carrier_state_free(&state);
    hf_carrier_free(&carrier);
    hf_scene_free(&scene);
    hf_case_free(&c);
    hf_messages_free(&messages);
}
END_TEST

/* The weight of members and hinges is what the supports carry; loads of the truss itself add to those of the net. */
START_TEST(own_loads_add_up)
{
    hf_case c;
    hf_scene scene;
    hf_carrier carrier;
    hf_carrier_state own, net, both;
    hf_messages messages = {0};
    struct rng rng = rng_start(2);
    const double g[3] = {1, -2, 9.81};
    double pull[108];
    ck_assert_int_eq(hf_config_load(source_path("configs/straight-edges-truss.yaml"), NULL, 0, &c, &messages), HF_OK);
    ck_assert_int_eq(hf_config_scene(&c, &scene, &messages), HF_OK);
    ck_assert_int_eq(hf_config_carrier(&c, &scene, &carrier, &messages), HF_OK);
    size_t n = 6 * (size_t)carrier.truss.n_node;
    double *force = zeros(n), *rise_K = zeros((size_t)carrier.truss.n_member), sum[3] = {0}, most = 0;
    for (int k = 0; k < 108; k++)
        pull[k] = rng_uniform(&rng, -20, 20);
    hf_carrier_add_weight(&carrier, g, force);
    ck_assert_int_eq(hf_carrier_load(&carrier, NULL, &(hf_frame_load){.force = force}, &own), HF_OK);
    for (size_t i = 0; i < n; i++)
        if (i % 6 < 3) sum[i % 6] -= own.reaction[i];
    for (int d = 0; d < 3; d++)
        ck_assert_double_eq_tol(sum[d], carrier.mass_kg * g[d], 1e-7 * carrier.mass_kg); /* rounding by condition 2e6 */
    hf_carrier_state_free(&own);
    for (int e = 0; e < carrier.truss.n_member; e++) {
        carrier.truss.expansion_per_K[e] = 1e-6;
        rise_K[e] = rng_uniform(&rng, -100, 100);
    }
    const hf_frame_load load = {.force = force, .temperature_K = rise_K};
    ck_assert_int_eq(hf_carrier_load(&carrier, NULL, &load, &own), HF_OK);
    ck_assert_int_eq(hf_carrier_load(&carrier, pull, NULL, &net), HF_OK);
    ck_assert_int_eq(hf_carrier_load(&carrier, pull, &load, &both), HF_OK);
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(both.displacement[i]));
    for (size_t i = 0; i < n; i++)
        ck_assert_double_eq_tol(both.displacement[i], own.displacement[i] + net.displacement[i], 1e-9 * most);
    hf_carrier_state_free(&own);
    hf_carrier_state_free(&net);
    hf_carrier_state_free(&both);
    free(force);
    free(rise_K);
    hf_carrier_free(&carrier);
    hf_scene_free(&scene);
    hf_case_free(&c);
}
END_TEST

/* A net whose supports are on all ribs has more of them than a truss with corners two cells apart has nodes. */
START_TEST(support_without_attachment)
{
    hf_case c;
    hf_scene scene;
    hf_carrier carrier;
    hf_messages messages = {0};
    static const char *const ribs[] = {"scene.parabolic_cylinder.supports=ribs", "truss.bud.panels=1"};
    ck_assert_int_eq(hf_config_load(source_path("configs/straight-edges-truss.yaml"), ribs, 2, &c, &messages), HF_OK);
    ck_assert_int_eq(hf_config_scene(&c, &scene, &messages), HF_OK);
    ck_assert_int_eq(hf_config_carrier(&c, &scene, &carrier, &messages), HF_BAD_CASE);
    ck_assert_ptr_nonnull(
        strstr(messages.text, "truss: net support 'n1_0' has no attachment, because the nearest truss node 'f"));
    ck_assert_ptr_nonnull(strstr(messages.text, "truss: 10 more net supports have no attachment")); /* 6 ribs of 5 */
    hf_carrier_free(&carrier);
    hf_messages_free(&messages);
    c.truss.bud.panels = 2; /* nodes amid the ribs */
    ck_assert_msg(hf_config_carrier(&c, &scene, &carrier, &messages) == HF_OK, "%s", messages.text);
    ck_assert_int_eq(carrier.n_attachment, 66);
    hf_carrier_free(&carrier);
    hf_scene_free(&scene);
    hf_case_free(&c);
    hf_messages_free(&messages);
}
END_TEST

/* ---- import ---- */

#define NODES "id,x_m,y_m,z_m,fixed,mass_kg\na,0,0,0,all,\nb,1.5,-2.25,3e-1,,1.25\nc,4,0,0,ux  uz rx,0\n"
#define MEMBERS                                                                                                        \
    "id,i,j,E_Pa,A_m2,G_Pa,Iy_m4,Iz_m4,J_m4,Asy_m2,roll_rad,joint,unit\n"                                              \
    "ab,a,b,130e9,1e-4,5e9,1e-8,2e-8,3e-8,5e-5,0.5,rigid,mbug\n"                                                       \
    "bc,b,c,70e9,2e-4,,,,,,,pinned,\n"

/* What was said, without the folder of the files. */
static hf_status import(const char *nodes, const char *members, hf_truss *t, char *said, size_t size)
{
    hf_messages messages = {0};
    const char *nodes_path = temp_path("truss_nodes.csv"), *members_path = temp_path("members.csv");
    write_file(nodes_path, nodes);
    write_file(members_path, members);
    hf_status status = hf_truss_import(nodes_path, members_path, t, &messages);
    if (status == HF_OK) status = hf_truss_check(t, &messages);
    copy_without_folder(messages.text, said, size);
    hf_messages_free(&messages);
    return status;
}

START_TEST(good_import)
{
    hf_truss t;
    char said[4096];
    ck_assert_msg(import(NODES, MEMBERS, &t, said, sizeof said) == HF_OK, "%s", said);
    ck_assert_str_eq(said, "");
    ck_assert(t.n_node == 3 && t.n_member == 2);
    ck_assert_str_eq(t.node_id[2], "c");
    ck_assert_str_eq(t.member_id[1], "bc");
    ck_assert(t.fixed[0] == 0x3f && t.fixed[1] == 0 && t.fixed[2] == 0x0d);
    ck_assert_double_eq(t.position_m[4], -2.25);
    ck_assert(t.mass_kg[0] == 0 && t.mass_kg[1] == 1.25);
    ck_assert(t.end[2] == 1 && t.end[3] == 2);
    ck_assert(t.joint[0] == HF_JOINT_RIGID && t.joint[1] == HF_JOINT_PINNED);
    ck_assert(t.unit[0] == HF_UNIT_MBUG && t.unit[1] == HF_UNIT_OTHER);
    ck_assert(t.E_Pa[1] == 70e9 && t.A_m2[1] == 2e-4 && t.Iz_m4[0] == 2e-8 && t.roll_rad[0] == 0.5);
    ck_assert(t.Asy_m2[0] == 5e-5 && isinf(t.Asz_m2[0]) && isinf(t.Asy_m2[1]) && t.density_kg_per_m3[0] == 0);
    hf_truss_free(&t);
}
END_TEST

/* A support of the net at each node of the truss in turn. */
START_TEST(the_nearest_node_is_taken)
{
    hf_truss t;
    char said[4096];
    double position_m[3];
    unsigned char role = HF_ROLE_SUPPORT;
    const char *id = "s";
    hf_scene scene = {.n_node = 1, .position_m = position_m, .role = &role, .node_id = &id};
    ck_assert_msg(import(NODES, MEMBERS, &t, said, sizeof said) == HF_OK, "%s", said);
    for (int i = 0; i < t.n_node; i++) {
        hf_messages messages = {0};
        int n, scene_node, truss_node;
        memcpy(position_m, t.position_m + 3 * i, sizeof position_m);
        position_m[2] += 1e-4;
        ck_assert_int_eq(hf_truss_attach(&t, &scene, 1e-3, &n, &scene_node, &truss_node, &messages), HF_OK);
        ck_assert(n == 1 && scene_node == 0 && truss_node == i);
        ck_assert_int_eq(hf_truss_attach(&t, &scene, 0.9e-4, &n, &scene_node, &truss_node, &messages), HF_BAD_CASE);
        snprintf(said, sizeof said, "the nearest truss node '%s'", t.node_id[i]);
        ck_assert_ptr_nonnull(strstr(messages.text, said));
        hf_messages_free(&messages);
    }
    hf_truss_free(&t);
}
END_TEST

static const struct {
    const char *nodes, *members, *says;
} faulty[] = {
    {"id,x_m,y_m,z_m\na,0,0,0\n", MEMBERS, "error: truss_nodes.csv:1: a column is missing: fixed\n"},
    {NODES, "id,i,j,E_Pa\nab,a,b,1\n", "error: members.csv:1: a column is missing: A_m2\n"},
    {NODES "d,1,2,3,ux up,\n", MEMBERS,
     "error: truss_nodes.csv:5: 'd': fixed must be empty, all, or some of ux uy uz rx ry rz, not up\n"},
    {NODES "a,1,2,3,,\n", MEMBERS, "error: truss_nodes.csv:5: 'a': this id was used before, on line 2\n"},
    {NODES, MEMBERS "ad,a,d,1,1,,,,,,,pinned,\n", "error: members.csv:4: 'ad': there is no truss node with the id d\n"},
    {NODES, MEMBERS "ac,a,c,1,nan,,,,,,,pinned,\n",
     "error: members.csv:4: 'ac': A_m2 must be a finite number, not nan\n"},
    {NODES, MEMBERS "ac,a,c,,1,,,,,,,pinned,\n",
     "error: members.csv:4: 'ac': E_Pa must be a finite number, not empty\n"},
    {NODES, MEMBERS "ac,a,c,1,1,1,,1,1,,,,\n",
     "error: members.csv:4: member 'ac' needs E, G, A, Iy, Iz, J and shear areas above zero\n"},
    {NODES, MEMBERS "ac,a,c,1,-1,,,,,,,pinned,\n", "error: members.csv:4: member 'ac' needs E and A above zero\n"},
    {NODES, MEMBERS "ac,a,c,1,1,,,,,,,hinged,\n",
     "error: members.csv:4: 'ac': joint must be one of rigid pinned, not hinged; did you mean 'pinned'?\n"},
    {NODES, MEMBERS "ac,a,c,1,1,,,,,,,pinned,bug\n",
     "error: members.csv:4: 'ac': unit must be one of bud mbug abug other longeron vertical diagonal, not bug; did you "
     "mean 'bud'?\n"},
    {NODES, MEMBERS "aa,a,a,1,1,,,,,,,pinned,\n", "error: members.csv:4: member 'aa' joins a node to itself\n"},
    {NODES "d,0,0,0,,\n", MEMBERS "ad,a,d,1,1,,,,,,,pinned,\n",
     "error: members.csv:4: member 'ad' has zero length: its two nodes are at the same position\n"},
    {NODES "d,1,1,1,,-3\n", MEMBERS, "error: truss_nodes.csv:5: node 'd' has a mass that is no number or below zero\n"},
};
enum { N_FAULTY = sizeof faulty / sizeof *faulty };

START_TEST(faulty_import)
{
    hf_truss t;
    char said[4096];
    ck_assert_int_eq(import(faulty[_i].nodes, faulty[_i].members, &t, said, sizeof said), HF_BAD_CASE);
    ck_assert_str_eq(said, faulty[_i].says);
    hf_truss_free(&t);
}
END_TEST

/* A mechanism in a file is told with the line of its node. */
START_TEST(mechanism_of_a_file)
{
    hf_truss t;
    hf_frame frame;
    char said[4096];
    hf_messages messages = {0};
    ck_assert_int_eq(import(NODES "d,7,7,7,,\n", MEMBERS "bd,b,d,1e9,1e-4,,,,,,,pinned,\n", &t, said, sizeof said),
                     HF_OK);
    ck_assert_int_eq(hf_frame_build(&t, &frame, &messages), HF_MECHANISM);
    ck_assert_msg(strstr(messages.text, "truss_nodes.csv:5: node 'd' can move along") != NULL, "%s", messages.text);
    hf_frame_free(&frame);
    hf_truss_free(&t);
    hf_messages_free(&messages);
}
END_TEST

Suite *suite_unit_truss(void)
{
    Suite *suite = suite_create("unit/truss");
    TCase *tests = tcase_create("truss");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, sub_rings);
    tcase_add_test(tests, ribs_are_symmetric);
    tcase_add_test(tests, mass_by_hand);
    tcase_add_test(tests, every_choice);
    tcase_add_test(tests, it_carries_edge_ties);
    tcase_add_test(tests, too_many_modules);
    tcase_add_test(tests, what_the_net_is_given);
    tcase_add_test(tests, own_loads_add_up);
    tcase_add_test(tests, support_without_attachment);
    tcase_add_test(tests, good_import);
    tcase_add_test(tests, the_nearest_node_is_taken);
    tcase_add_loop_test(tests, faulty_import, 0, N_FAULTY);
    tcase_add_test(tests, mechanism_of_a_file);
    return suite;
}
