/* The hoop truss under a round net: counts, names, symmetry, joints that are held. tests/verify/generators_oracle.py
 * holds geometry and statics of the examples against another program. */
#include "trusses.h"

static const hf_paraboloid dish = {
    .aperture_m = 6.1, .focal_length_m = 2.9, .offset_m = 4, .rings = 4, .rear_distance_m = 2};

static hf_truss_settings settings(void)
{
    return (hf_truss_settings){.E_Pa = 130e9,
                               .G_Pa = 5e9,
                               .density_kg_per_m3 = 1600,
                               .hinge_mass_kg = 0.3,
                               .ring = {.cells_per_bay = 1,
                                        .bracing = HF_DIAGONALS_SINGLE,
                                        .held_at_deg = 180,
                                        .longeron = {0.03, 0.001},
                                        .vertical = {0.025, 0.002},
                                        .diagonal = {0.02, 0.001}}};
}

static void generate(const hf_truss_settings *s, const hf_paraboloid *p, hf_truss *t)
{
    hf_messages messages = {0};
    ck_assert_msg(hf_truss_ring_generate(s, p, t, &messages) == HF_OK, "%s", messages.text);
    ck_assert_msg(hf_truss_check(t, &messages) == HF_OK, "%s", messages.text);
}

static int count_unit(const hf_truss *t, hf_unit unit)
{
    int n = 0;
    for (int e = 0; e < t->n_member; e++)
        n += t->unit[e] == unit;
    return n;
}

static int node(const hf_truss *t, const char *id)
{
    for (int i = 0; i < t->n_node; i++)
        if (!strcmp(t->node_id[i], id)) return i;
    ck_abort_msg("no joint %s", id);
    return -1;
}

/* 24 supports on a rim, in bays of one to eight cells, with any bracing. */
START_TEST(members_are_counted)
{
    static const int cells[] = {1, 2, 3, 4, 6, 8};
    for (int bracing = 0; bracing < 3; bracing++) {
        hf_truss_settings s = settings();
        hf_truss t;
        int n_bay = 24 / cells[_i], n_hinge = 0;
        s.ring.cells_per_bay = cells[_i];
        s.ring.bracing = (hf_diagonals)bracing;
        generate(&s, &dish, &t);
        ck_assert_int_eq(t.n_node, 48);
        ck_assert_int_eq(count_unit(&t, HF_UNIT_LONGERON), 48);
        ck_assert_int_eq(count_unit(&t, HF_UNIT_VERTICAL), n_bay);
        ck_assert_int_eq(count_unit(&t, HF_UNIT_DIAGONAL), bracing * n_bay);
        ck_assert_int_eq(t.n_member, 48 + n_bay * (1 + bracing));
        for (int i = 0; i < t.n_node; i++)
            n_hinge += t.mass_kg[i] == 0.3;
        ck_assert_int_eq(n_hinge, 2 * n_bay);
        hf_truss_free(&t);
    }
}
END_TEST

/* Front joints are the rim of the net, in one plane; rear joints are 2 m below; a vertical is 2 m long, a longeron a
 * chord of a 24th of the circle seen along z. */
START_TEST(joints_are_on_the_rims)
{
    hf_truss_settings s = settings();
    hf_messages messages = {0};
    hf_truss t;
    hf_scene net;
    int n_attachment, scene_node[512], truss_node[512];
    generate(&s, &dish, &t);
    ck_assert_int_eq(hf_scene_paraboloid(&dish, NULL, &net, &messages), HF_OK);
    ck_assert_int_eq(hf_truss_attach(&t, &net, 1e-12, &n_attachment, scene_node, truss_node, &messages), HF_OK);
    ck_assert_int_eq(n_attachment, 48);
    for (int k = 0; k < n_attachment; k++) { /* f4_7 on f7, r4_7 on r7 */
        const char *support = net.node_id[scene_node[k]], *joint = t.node_id[truss_node[k]];
        ck_assert_int_eq(support[0], joint[0]);
        ck_assert_str_eq(strchr(support, '_') + 1, joint + 1);
    }
    for (int e = 0; e < t.n_member; e++) {
        const double *a = t.position_m + 3 * (size_t)t.end[2 * e], *b = t.position_m + 3 * (size_t)t.end[2 * e + 1];
        double across = hypot(a[0] - b[0], a[1] - b[1]), chord = 6.1 * sin(acos(-1) / 24);
        ck_assert_double_eq_tol(across, t.unit[e] == HF_UNIT_VERTICAL ? 0 : chord, 1e-14);
        if (t.unit[e] == HF_UNIT_VERTICAL) ck_assert_double_eq_tol(hf_truss_member_length(&t, e), 2, 1e-14);
        double outer = t.unit[e] == HF_UNIT_VERTICAL ? 0.025 : t.unit[e] == HF_UNIT_LONGERON ? 0.03 : 0.02;
        double inner = outer - (t.unit[e] == HF_UNIT_VERTICAL ? 0.004 : 0.002), PI = acos(-1);
        ck_assert_double_eq_tol(t.A_m2[e], PI / 4 * (outer * outer - inner * inner), 1e-18);
        ck_assert_double_eq_tol(t.Iz_m4[e], PI / 64 * (pow(outer, 4) - pow(inner, 4)), 1e-22);
    }
    hf_scene_free(&net);
    hf_truss_free(&t);
}
END_TEST

/* At 180 degrees, the side of the axis: joint 12 of 24, and of the two bays that are equally near the first. */
START_TEST(joints_are_held)
{
    static const struct {
        hf_ring_held held;
        double at_deg;
        int n;
        const char *id[4];
    } wanted[] = {{HF_RING_HELD_BAY, 180, 4, {"f11", "r11", "f12", "r12"}},
                  {HF_RING_HELD_BAY, 100, 4, {"f6", "r6", "f7", "r7"}},
                  {HF_RING_HELD_BAY, 350, 4, {"f23", "r23", "f0", "r0"}},
                  {HF_RING_HELD_VERTICAL, 180, 2, {"f12", "r12"}},
                  {HF_RING_HELD_VERTICAL, 0, 2, {"f0", "r0"}},
                  {HF_RING_HELD_THREE_VERTICALS, 30, 3, {"r2", "r10", "r18"}},
                  {HF_RING_HELD_THREE_VERTICALS, 180, 3, {"r4", "r12", "r20"}}};
    for (int dofs = 0; dofs < 2; dofs++) {
        hf_truss_settings s = settings();
        hf_truss t;
        hf_frame frame;
        int n_held = 0;
        s.support_dofs = (hf_held_dofs)dofs;
        s.ring.held = wanted[_i].held;
        s.ring.held_at_deg = wanted[_i].at_deg;
        generate(&s, &dish, &t);
        for (int i = 0; i < t.n_node; i++)
            n_held += t.fixed[i] != 0;
        ck_assert_int_eq(n_held, wanted[_i].n);
        for (int k = 0; k < n_held; k++)
            ck_assert_int_eq(t.fixed[node(&t, wanted[_i].id[k])], dofs ? 0x07 : 0x3f);
        if (dofs == 0 || n_held > 2) { /* two joints without moments let the ring turn about their line */
            build_frame(&t, &frame);
            hf_frame_free(&frame);
        }
        hf_truss_free(&t);
    }
}
END_TEST

/* Centre-fed, crossed, with a pull towards the axis on all joints and held at three verticals: the ring is the same
 * when it is turned by 120 degrees, and so are the displacements. */
START_TEST(ring_has_three_fold_symmetry)
{
    hf_truss_settings s = settings();
    hf_paraboloid p = dish;
    hf_truss t;
    struct solved out;
    p.offset_m = 0;
    s.ring.bracing = HF_DIAGONALS_CROSSED;
    s.ring.held = HF_RING_HELD_THREE_VERTICALS;
    s.ring.held_at_deg = 0;
    generate(&s, &p, &t);
    double *force = zeros(6 * (size_t)t.n_node);
    for (int i = 0; i < t.n_node; i++)
        for (int c = 0; c < 2; c++)
            force[6 * i + c] = -10 * t.position_m[3 * i + c];
    solve_truss(&t, &(hf_frame_load){.force = force}, &out);
    double most = largest(out.n, out.displacement), cosine = -0.5, sine = sqrt(0.75);
    for (int k = 0; k < 24; k++)
        for (int side = 0; side < 2; side++) {
            const double *u = out.displacement + 6 * (2 * k + side);
            const double *v = out.displacement + 6 * (2 * ((k + 8) % 24) + side);
            ck_assert_double_eq_tol(v[0], cosine * u[0] - sine * u[1], 1e-9 * most);
            ck_assert_double_eq_tol(v[1], sine * u[0] + cosine * u[1], 1e-9 * most);
            ck_assert_double_eq_tol(v[2], u[2], 1e-9 * most);
        }
    free(force);
    free_solved(&out);
    hf_truss_free(&t);
}
END_TEST

/* Of three bays, where each direction lies between two verticals. */
START_TEST(three_verticals_are_three)
{
    hf_truss_settings s = settings();
    hf_truss t;
    int n_held = 0;
    s.ring.held = HF_RING_HELD_THREE_VERTICALS;
    s.ring.held_at_deg = 180;
    s.ring.cells_per_bay = 8;
    generate(&s, &dish, &t);
    for (int i = 0; i < t.n_node; i++)
        n_held += t.fixed[i] != 0;
    ck_assert_int_eq(n_held, 3);
    hf_truss_free(&t);
}
END_TEST

Suite *suite_unit_ring(void)
{
    Suite *suite = suite_create("unit/truss/ring");
    TCase *tests = tcase_create("ring");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, members_are_counted, 0, 6);
    tcase_add_test(tests, joints_are_on_the_rims);
    tcase_add_loop_test(tests, joints_are_held, 0, 7);
    tcase_add_test(tests, three_verticals_are_three);
    tcase_add_test(tests, ring_has_three_fold_symmetry);
    return suite;
}
