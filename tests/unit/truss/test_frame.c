/* Contents: by hand - theories and joints - laws - refusals - condensation */
#include "trusses.h"

#include <hifdm/carrier.h>

/* ---- by hand ---- */

/* A cantilever of length L along a skew axis: tip force, tip moment, and heating, by the beam formulae. 1e-10:
 * rounding times EA L^2/EI, which is 6e4. */
START_TEST(cantilever)
{
    const double tip[3] = {1.2, -0.7, 2.1}, L = sqrt(1.2 * 1.2 + 0.7 * 0.7 + 2.1 * 2.1), EI = 130e9 * 9.589e-9;
    const double position[2][3] = {{0, 0, 0}, {tip[0], tip[1], tip[2]}},
                 across[3] = {0.7 / hypot(1.2, 0.7), 1.2 / hypot(1.2, 0.7), 0};
    double force[12] = {0}, rise[1] = {40};
    hf_truss t;
    struct solved s;
    make_truss(&t, 2, position, 1, (const int[1][2]){{0, 1}});
    t.fixed[0] = 0x3f;
    t.expansion_per_K[0] = 2e-5;
    t.Asy_m2[0] = t.Asz_m2[0] = 45e-6;
    for (int c = 0; c < 3; c++)
        force[6 + c] = 3 * across[c] + 100 * tip[c] / L;
    solve_truss(&t, &(hf_frame_load){force, NULL, rise}, &s);
    double bend = 3 * L * L * L / (3 * EI) + 3 * L / (5.3e9 * 45e-6),
           stretch = 100 * L / (130e9 * 91.1e-6) + 2e-5 * 40 * L;
    for (int c = 0; c < 3; c++)
        ck_assert_double_eq_tol(s.displacement[6 + c], bend * across[c] + stretch * tip[c] / L, 1e-10 * bend);
    ck_assert_double_eq_tol(hypot(hypot(s.displacement[9], s.displacement[10]), s.displacement[11]),
                            3 * L * L / (2 * EI), 1e-10 * bend);
    ck_assert_double_eq_tol(s.end_force[0], -100, 1e-10); /* tension; heat alone makes none here */
    ck_assert_double_eq_tol(hypot(s.end_force[4], s.end_force[5]), 3 * L, 1e-10);
    ck_assert_double_eq_tol(s.energy_J, 3 * bend * 3 / 3 / 2 + 100 * 100 * L / (130e9 * 91.1e-6) / 2, 1e-10 * bend);
    free_solved(&s);
    hf_truss_free(&t);
}
END_TEST

/* Ferreira, MATLAB Codes for Finite Element Analysis: 3D frame of three beams, node 1 loaded. Printed with nine
 * digits, hence 1e-8 of the largest. */
START_TEST(ferreira_three_beams)
{
    const double position[4][3] = {{0, 0, 0}, {3, 0, 0}, {0, 0, -3}, {0, -4, 0}};
    const double expected[6] = {-7.05147750e-6, -6.65367e-8,   1.41769582e-5,
                                1.44778793e-6,  1.74858422e-6, 1.13605431e-6};
    double force[24] = {-10e3, 0, 20e3};
    hf_truss t;
    struct solved s;
    make_truss(&t, 4, position, 3, (const int[3][2]){{0, 1}, {0, 2}, {0, 3}});
    for (int e = 0; e < 3; e++) {
        t.E_Pa[e] = 210e9;
        t.G_Pa[e] = 84e9;
        t.A_m2[e] = 0.02;
        t.Iy_m4[e] = 1e-4;
        t.Iz_m4[e] = 2e-4;
        t.J_m4[e] = 0.5e-4;
        t.fixed[e + 1] = 0x3f;
    }
    solve_truss(&t, &(hf_frame_load){force, NULL, NULL}, &s);
    for (int c = 0; c < 6; c++)
        ck_assert_double_eq_tol(s.displacement[c], expected[c], 1e-8 * 1.4e-5);
    free_solved(&s);
    hf_truss_free(&t);
}
END_TEST

/* A bar between two walls that is heated: no motion, N = -EA alpha dT. One wall moves: N = EA d/L. */
START_TEST(heated_and_settled_bar)
{
    const double position[3][3] = {{0, 0, 0}, {1.3, 0, 0}, {2.6, 0, 0}}, EA = 130e9 * 91.1e-6;
    double settlement[18] = {0}, rise[2] = {35, 35};
    hf_truss t;
    struct solved s;
    make_truss(&t, 3, position, 2, (const int[2][2]){{0, 1}, {2, 1}});
    t.fixed[0] = t.fixed[2] = 0x3f;
    t.expansion_per_K[0] = t.expansion_per_K[1] = 1.1e-5;
    solve_truss(&t, &(hf_frame_load){NULL, NULL, rise}, &s);
    for (int k = 0; k < 18; k++)
        ck_assert_double_eq_tol(s.displacement[k], 0, 1e-18);
    ck_assert_double_eq_tol(s.end_force[0], EA * 1.1e-5 * 35, 1e-12 * EA * 1.1e-5 * 35); /* compression */
    ck_assert_double_eq_tol(s.energy_J, 2 * EA * 1.3 * pow(1.1e-5 * 35, 2) / 2, 1e-12);
    free_solved(&s);
    settlement[12] = 2e-3;
    solve_truss(&t, &(hf_frame_load){NULL, settlement, NULL}, &s);
    ck_assert_double_eq_tol(s.displacement[6], 1e-3, 1e-15);
    ck_assert_double_eq(s.displacement[12], 2e-3);
    ck_assert_double_eq_tol(s.reaction[12], EA * 2e-3 / 2.6, 1e-12 * EA);
    free_solved(&s);
    hf_truss_free(&t);
}
END_TEST

/* A space truss of three pinned bars: forces by statics, no rotation, no bending. */
START_TEST(pinned_tripod)
{
    const double position[4][3] = {{0, 0, 2}, {1, 0, 0}, {-0.5, 0.8, 0}, {-0.5, -0.8, 0}};
    double force[24] = {0, 0, -600};
    hf_truss t;
    struct solved s;
    make_truss(&t, 4, position, 3, (const int[3][2]){{0, 1}, {2, 0}, {0, 3}});
    for (int e = 0; e < 3; e++) {
        t.joint[e] = HF_JOINT_PINNED;
        t.fixed[e + 1] = 0x07; /* rotations there are absent, too: no beam */
    }
    solve_truss(&t, &(hf_frame_load){force, NULL, NULL}, &s);
    ck_assert_int_eq(s.frame.n_dof, 3);
    double pull[3] = {0};
    for (int e = 0; e < 3; e++) {
        const double *other = position[e + 1];
        double length = hf_truss_member_length(&t, e);
        for (int c = 0; c < 3; c++)
            pull[c] -= s.end_force[12 * e] * (other[c] - position[0][c]) / length;
        for (int k = 1; k < 12; k++)
            if (k != 6) ck_assert_double_eq(s.end_force[12 * e + k], 0);
        ck_assert_double_gt(s.end_force[12 * e], 0); /* all three are compressed */
    }
    ck_assert_double_eq_tol(pull[0], 0, 1e-10);
    ck_assert_double_eq_tol(pull[1], 0, 1e-10);
    ck_assert_double_eq_tol(pull[2], 600, 1e-10);
    for (int k = 3; k < 6; k++)
        ck_assert_double_eq(s.displacement[k], 0);
    free_solved(&s);
    hf_truss_free(&t);
}
END_TEST

/* A moment on a node without beams: nothing resists it. */
START_TEST(moment_that_nothing_resists)
{
    const double position[4][3] = {{0, 0, 2}, {1, 0, 0}, {-0.5, 0.8, 0}, {-0.5, -0.8, 0}};
    double force[24] = {0, 0, -600, 0, 2}, *work, u[24];
    hf_truss t;
    hf_frame frame;
    int bad_dof;
    make_truss(&t, 4, position, 3, (const int[3][2]){{0, 1}, {2, 0}, {0, 3}});
    for (int e = 0; e < 3; e++) {
        t.joint[e] = HF_JOINT_PINNED;
        t.fixed[e + 1] = 0x07;
    }
    build_frame(&t, &frame);
    work = zeros(hf_frame_work_size(&frame, 1));
    ck_assert_int_eq(hf_frame_solve(&frame, 1, &(hf_frame_load){force, NULL, NULL}, work, u, &bad_dof), HF_MECHANISM);
    ck_assert_int_eq(bad_dof, 4);
    force[4] = 0;
    ck_assert_int_eq(hf_frame_solve(&frame, 1, &(hf_frame_load){force, NULL, NULL}, work, u, &bad_dof), HF_OK);
    ck_assert_int_eq(bad_dof, -1);
    free(work);
    hf_frame_free(&frame);
    hf_truss_free(&t);
}
END_TEST

/* ---- refusals ---- */

/* A portal of four columns under a square, and how to spoil it. */
static const double portal_m[8][3] = {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0},
                                      {0, 0, 4}, {3, 0, 4}, {3, 2, 4}, {0, 2, 4}};
static const int portal_end[8][2] = {{0, 4}, {1, 5}, {2, 6}, {3, 7}, {4, 5}, {5, 6}, {6, 7}, {7, 4}};

static void expect_refusal(const hf_truss *t, const char *says, const char *also)
{
    hf_frame frame;
    hf_messages messages = {0};
    ck_assert_int_eq(hf_frame_build(t, &frame, &messages), HF_MECHANISM);
    ck_assert_int_eq(messages.n_error, 1);
    ck_assert_msg(strstr(messages.text, says) && strstr(messages.text, also), "%s", messages.text);
    hf_frame_free(&frame);
    hf_messages_free(&messages);
}

static void make_portal(hf_truss *t)
{
    make_truss(t, 8, portal_m, 8, portal_end);
    for (int i = 0; i < 4; i++)
        t->fixed[i] = 0x3f;
}

/* Members so soft that the scaled matrix overflows: no motion is known to be free, so no node is named as the loose
 * one, least of all a supported one. */
START_TEST(stiffness_out_of_range_names_no_node)
{
    hf_truss t;
    hf_frame frame;
    hf_messages messages = {0};
    make_portal(&t);
    for (int e = 0; e < 8; e++)
        t.E_Pa[e] = t.G_Pa[e] = 1e-310;
    ck_assert_int_eq(hf_frame_build(&t, &frame, &messages), HF_MECHANISM);
    ck_assert_msg(!strstr(messages.text, "node") && strstr(messages.text, "truss: the stiffness matrix cannot be "),
                  "%s", messages.text);
    hf_frame_free(&frame);
    hf_messages_free(&messages);
    hf_truss_free(&t);
}
END_TEST

START_TEST(floating_frame)
{
    hf_truss t;
    make_portal(&t);
    for (int i = 0; i < 4; i++)
        t.fixed[i] = 0;
    expect_refusal(&t, "truss: node 'a", "no node of the truss is supported");
    t.fixed[2] = 0x07; /* held at a ball: it can still turn */
    expect_refusal(&t, "truss: node 'a", "without force, because the truss is a mechanism or has too few supports");
    t.fixed[2] = 0x17; /* and about y */
    expect_refusal(&t, "truss: node 'a", "without force");
    t.fixed[2] = 0x3f;
    hf_frame frame;
    build_frame(&t, &frame);
    hf_frame_free(&frame);
    hf_truss_free(&t);
}
END_TEST

/* Pinned all over, a portal sways: some node of the upper square moves in the horizontal plane. */
START_TEST(pinned_portal)
{
    hf_truss t;
    make_portal(&t);
    for (int e = 0; e < 8; e++)
        t.joint[e] = HF_JOINT_PINNED;
    expect_refusal(&t, "can move along", "without force");
    hf_truss_free(&t);
}
END_TEST

/* A node on the middle of a pinned member, which nothing holds sideways, in a frame that is otherwise sound. */
START_TEST(unbraced_node)
{
    const double position[10][3] = {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0},   {0, 0, 4},
                                    {3, 0, 4}, {3, 2, 4}, {0, 2, 4}, {1.5, 0, 4}, {9, 9, 9}};
    const int end[10][2] = {{0, 4}, {1, 5}, {2, 6}, {3, 7}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {4, 8}, {8, 5}};
    hf_truss t;
    make_truss(&t, 9, position, 10, end);
    for (int i = 0; i < 4; i++)
        t.fixed[i] = 0x3f;
    t.joint[8] = t.joint[9] = HF_JOINT_PINNED;
    expect_refusal(&t, "node 'a8' can move along", "without force");
    t.fixed[8] = 0x06; /* held in y and z */
    hf_frame frame;
    build_frame(&t, &frame);
    ck_assert_int_eq(frame.n_dof, 4 * 6 + 1); /* the rotations of node 8 are absent */
    hf_frame_free(&frame);
    hf_truss_free(&t);
}
END_TEST

START_TEST(node_without_members)
{
    hf_truss t;
    const double position[3][3] = {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}};
    make_truss(&t, 3, position, 1, (const int[1][2]){{0, 1}});
    t.fixed[0] = 0x3f;
    expect_refusal(&t, "node 'a2' can move along x", "without force");
    t.fixed[2] = 0x07;
    hf_frame frame;
    build_frame(&t, &frame);
    hf_frame_free(&frame);
    hf_truss_free(&t);
}
END_TEST

/* A beam that can spin about its own axis between two balls. */
START_TEST(spinning_beam)
{
    hf_truss t;
    const double position[2][3] = {{0, 0, 0}, {3, 0, 0}};
    make_truss(&t, 2, position, 1, (const int[1][2]){{0, 1}});
    t.fixed[0] = t.fixed[1] = 0x07;
    expect_refusal(&t, "can turn about x", "without force");
    t.fixed[1] = 0x0f;
    hf_frame frame;
    build_frame(&t, &frame);
    hf_frame_free(&frame);
    hf_truss_free(&t);
}
END_TEST

/* A long, slender, sound cantilever is soft but no mechanism: 200 beams of 30 mm tube, each 5 m long. */
START_TEST(soft_is_not_loose)
{
    enum { N = 201 };
    static double position[N][3];
    static int end[N - 1][2];
    double force[6 * N] = {0};
    hf_truss t;
    struct solved s;
    for (int i = 0; i < N; i++)
        position[i][0] = 5 * i;
    for (int e = 0; e < N - 1; e++) {
        end[e][0] = e;
        end[e][1] = e + 1;
    }
    make_truss(&t, N, (const double(*)[3])position, N - 1, (const int(*)[2])end);
    t.fixed[0] = 0x3f;
    force[6 * (N - 1) + 2] = 1e-3;
    solve_truss(&t, &(hf_frame_load){force, NULL, NULL}, &s);
    double EI = 130e9 * 9.589e-9, expected = 1e-3 * pow(1000, 3) / (3 * EI);
    /* the condition number, about 200^4, times rounding */
    ck_assert_double_eq_tol(s.displacement[6 * (N - 1) + 2], expected, 1e-5 * expected);
    free_solved(&s);
    hf_truss_free(&t);
}
END_TEST

START_TEST(everything_fixed)
{
    hf_truss t;
    hf_frame frame;
    hf_messages messages = {0};
    make_portal(&t);
    memset(t.fixed, 0x3f, 8);
    ck_assert_int_eq(hf_frame_build(&t, &frame, &messages), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "every node is supported"));
    hf_frame_free(&frame);
    hf_messages_free(&messages);
    hf_truss_free(&t);
}
END_TEST

/* ---- many cases at once ---- */

START_TEST(many_cases_are_each_alone)
{
    hf_truss t;
    hf_frame frame;
    int bad_dof;
    double force[3][48] = {{0}}, rise[8] = {10, 20, 0, 0, 5, 0, 0, 1}, settlement[48] = {0}, u[3][48], one[48];
    make_portal(&t);
    for (int e = 0; e < 8; e++)
        t.expansion_per_K[e] = 1e-5;
    build_frame(&t, &frame);
    force[0][24] = 2.385;
    force[2][47] = -1.75;
    settlement[2] = 1e-3;
    const hf_frame_load load[3] = {{force[0], NULL, NULL}, {NULL, settlement, rise}, {force[2], settlement, NULL}};
    double *work = zeros(hf_frame_work_size(&frame, 3));
    ck_assert_int_eq(hf_frame_solve(&frame, 3, load, work, u[0], &bad_dof), HF_OK);
    for (int k = 0; k < 3; k++) { /* dpbtrs may sum in another order for several right-hand sides */
        ck_assert_int_eq(hf_frame_solve(&frame, 1, &load[k], work, one, &bad_dof), HF_OK);
        check_alike(48, u[k], one, 1e-12);
    }
    free(work);
    hf_frame_free(&frame);
    hf_truss_free(&t);
}
END_TEST

/* ---- checks of a truss ---- */

START_TEST(faults_are_named)
{
    hf_truss t;
    hf_messages messages = {0};
    make_portal(&t);
    ck_assert_int_eq(hf_truss_check(&t, &messages), HF_OK);
    t.E_Pa[1] = 0;
    t.Iz_m4[2] = NAN;
    t.end[2 * 3 + 1] = t.end[2 * 3];
    t.position_m[3 * 5] = INFINITY;
    t.mass_kg[6] = -1;
    t.density_kg_per_m3[7] = -1;
    ck_assert_int_eq(hf_truss_check(&t, &messages), HF_BAD_CASE);
    for (const char *const *id = (const char *const[]){"'m1'", "'m2'", "'m3'", "'a5'", "'a6'", "'m7'", NULL}; *id; id++)
        ck_assert_msg(strstr(messages.text, *id) != NULL, "%s is not in: %s", *id, messages.text);
    t.joint[2] = HF_JOINT_PINNED; /* which needs no Iz */
    hf_messages_free(&messages);
    ck_assert_int_eq(hf_truss_check(&t, &messages), HF_BAD_CASE);
    ck_assert_ptr_null(strstr(messages.text, "'m2'"));
    hf_messages_free(&messages);
    hf_truss_free(&t);
}
END_TEST

/* A bar that turns by 0.01 about its end: linear theory leaves its other end 1 - cos off, of second order. */
START_TEST(second_order_of_a_turn)
{
    double position_m[6] = {0, 0, 0, 1.2, 1.6, 0}, length_m = 2, displacement[12] = {0}, move_m, span_m;
    int end[2] = {0, 1}, truss_node[2] = {0, 1};
    hf_carrier c = {.truss = {.n_node = 2, .n_member = 1, .position_m = position_m, .end = end},
                    .frame = {.length_m = &length_m},
                    .n_attachment = 2,
                    .truss_node = truss_node};
    const hf_carrier_state state = {.displacement = displacement}, none = {0};
    displacement[HF_TRUSS_DOF] = -0.01 * 1.6;
    displacement[HF_TRUSS_DOF + 1] = 0.01 * 1.2;
    ck_assert_double_eq_tol(hf_carrier_second_order_m(&c, &state, &move_m, &span_m), 2 * (1 - cos(0.01)), 1e-8);
    ck_assert_double_eq_tol(span_m, 2, 1e-15);
    ck_assert_double_eq_tol(move_m, 0.02, 1e-15);
    ck_assert_double_eq(hf_carrier_second_order_m(&c, &none, &move_m, &span_m), 0);
}
END_TEST

Suite *suite_unit_frame(void)
{
    Suite *suite = suite_create("unit/frame");
    TCase *tests = tcase_create("frame");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, cantilever);
    tcase_add_test(tests, ferreira_three_beams);
    tcase_add_test(tests, heated_and_settled_bar);
    tcase_add_test(tests, pinned_tripod);
    tcase_add_test(tests, moment_that_nothing_resists);
    tcase_add_test(tests, floating_frame);
    tcase_add_test(tests, stiffness_out_of_range_names_no_node);
    tcase_add_test(tests, pinned_portal);
    tcase_add_test(tests, unbraced_node);
    tcase_add_test(tests, node_without_members);
    tcase_add_test(tests, spinning_beam);
    tcase_add_test(tests, soft_is_not_loose);
    tcase_add_test(tests, everything_fixed);
    tcase_add_test(tests, many_cases_are_each_alone);
    tcase_add_test(tests, second_order_of_a_turn);
    tcase_add_test(tests, faults_are_named);
    return suite;
}
