/* Laws of linear frames on random ones: random trees of beams with random extra beams and bars. Tolerances: rounding of
 * the assembled matrix times its condition number, which stays below 1e7 here: 1e-8 of the largest of its kind. */
#include "trusses.h"

#include "base/arena.h"

#define TRIALS 60
#define TOLERANCE 1e-8

/* Random loads of all kinds; moments only where a beam resists them. */
struct loads {
    double *force, *settlement, *rise;
    hf_frame_load load;
};

static void random_loads(struct loads *l, const hf_truss *t, struct rng *rng)
{
    hf_frame frame;
    build_frame(t, &frame);
    l->force = zeros(6 * (size_t)t->n_node);
    l->settlement = zeros(6 * (size_t)t->n_node);
    l->rise = zeros((size_t)t->n_member);
    for (int k = 0; k < 6 * t->n_node; k++) {
        if (frame.row_of_dof[k] != HF_FRAME_ABSENT) l->force[k] = rng_uniform(rng, -500, 500);
        l->settlement[k] = rng_uniform(rng, -1e-3, 1e-3); /* used only where there is a support */
    }
    for (int e = 0; e < t->n_member; e++)
        l->rise[e] = rng_uniform(rng, -20, 20);
    l->load = (hf_frame_load){l->force, l->settlement, l->rise};
    hf_frame_free(&frame);
}

static void free_loads(struct loads *l)
{
    free(l->force);
    free(l->settlement);
    free(l->rise);
}

/* Free nodes in equilibrium; loads and reactions together without a resultant force or moment. */
START_TEST(equilibrium)
{
    struct rng rng = rng_start((uint64_t)_i);
    hf_truss t;
    struct loads l;
    struct solved s;
    random_truss(&t, &rng);
    random_loads(&l, &t, &rng);
    solve_truss(&t, &l.load, &s);
    double scale = largest(12 * t.n_member, s.end_force), sum[6] = {0};
    for (int k = 0; k < s.n; k++)
        ck_assert_double_le(fabs(s.residual[k]), TOLERANCE * scale);
    for (int i = 0; i < t.n_node; i++) {
        double f[6];
        const double *p = t.position_m + 3 * i;
        for (int c = 0; c < 6; c++)
            sum[c] += f[c] = l.force[6 * i + c] + s.reaction[6 * i + c];
        for (int c = 0; c < 3; c++)
            sum[3 + c] += p[(c + 1) % 3] * f[(c + 2) % 3] - p[(c + 2) % 3] * f[(c + 1) % 3];
    }
    for (int c = 0; c < 6; c++)
        ck_assert_double_le(fabs(sum[c]), TOLERANCE * scale);
    free_solved(&s);
    free_loads(&l);
    hf_truss_free(&t);
}
END_TEST

/* All supports moved as one rigid body: the frame follows and no member feels it. */
START_TEST(rigid_motion_strains_nothing)
{
    struct rng rng = rng_start((uint64_t)_i);
    hf_truss t;
    struct solved s;
    random_truss(&t, &rng);
    double *settlement = zeros(6 * (size_t)t.n_node), shift[3], turn[3];
    for (int c = 0; c < 3; c++) {
        shift[c] = rng_uniform(&rng, -1e-2, 1e-2);
        turn[c] = rng_uniform(&rng, -1e-2, 1e-2);
    }
    for (int i = 0; i < t.n_node; i++)
        for (int c = 0; c < 3; c++) {
            const double *p = t.position_m + 3 * i;
            settlement[6 * i + c] = shift[c] + turn[(c + 1) % 3] * p[(c + 2) % 3] - turn[(c + 2) % 3] * p[(c + 1) % 3];
            settlement[6 * i + 3 + c] = turn[c];
        }
    solve_truss(&t, &(hf_frame_load){NULL, settlement, NULL}, &s);
    for (int k = 0; k < s.n; k++)
        if (s.frame.row_of_dof[k] != HF_FRAME_ABSENT)
            ck_assert_double_eq_tol(s.displacement[k], settlement[k], TOLERANCE * 0.1);
    ck_assert_double_le(s.energy_J, 1e-8 * 1e5 * 1e-4); /* against EA u^2/L */
    free(settlement);
    free_solved(&s);
    hf_truss_free(&t);
}
END_TEST

/* The strain energy is half the work of the forces; a sum of loads moves the frame by the sum of motions. */
START_TEST(energy_and_superposition)
{
    struct rng rng = rng_start((uint64_t)_i);
    hf_truss t;
    struct loads a, b;
    struct solved sa, sb, sum, forced;
    random_truss(&t, &rng);
    random_loads(&a, &t, &rng);
    random_loads(&b, &t, &rng);
    solve_truss(&t, &a.load, &sa);
    solve_truss(&t, &b.load, &sb);
    solve_truss(&t, &(hf_frame_load){a.force, NULL, NULL}, &forced);
    double work = 0;
    for (int k = 0; k < forced.n; k++)
        work += a.force[k] * forced.displacement[k];
    ck_assert_double_eq_tol(forced.energy_J, work / 2, TOLERANCE * work);
    for (int k = 0; k < 6 * t.n_node; k++) {
        a.force[k] += 1.75 * b.force[k];
        a.settlement[k] += 1.75 * b.settlement[k];
        sa.displacement[k] += 1.75 * sb.displacement[k];
    }
    for (int e = 0; e < t.n_member; e++)
        a.rise[e] += 1.75 * b.rise[e];
    solve_truss(&t, &a.load, &sum);
    check_alike(sum.n, sum.displacement, sa.displacement, TOLERANCE);
    free_solved(&sa);
    free_solved(&sb);
    free_solved(&sum);
    free_solved(&forced);
    free_loads(&a);
    free_loads(&b);
    hf_truss_free(&t);
}
END_TEST

/* A flexibility: symmetric, positive, and column by column what full solves give (1e-10: both use one factor, the
 * solves add the scaling and dpbtrs's order for many right-hand sides). */
START_TEST(flexibility)
{
    struct rng rng = rng_start((uint64_t)_i);
    hf_truss t;
    hf_frame frame;
    int node[6], n = 0, bad_dof;
    random_truss(&t, &rng);
    build_frame(&t, &frame);
    for (int i = t.n_node - 1; i >= 0 && n < 6; i -= rng_int(&rng, 1, 4))
        node[n++] = i;
    double *F = zeros(9 * (size_t)(n * n)), *force = zeros(6 * (size_t)t.n_node), *u = zeros(6 * (size_t)t.n_node);
    double *work = zeros(hf_frame_work_size(&frame, 1));
    ck_assert_int_eq(hf_frame_condense(&frame, n, node, F), HF_OK);
    double most = largest(9 * n * n, F);
    for (int j = 0; j < 3 * n; j++) {
        memset(force, 0, 6 * (size_t)t.n_node * sizeof *force);
        force[6 * node[j / 3] + j % 3] = 1;
        ck_assert_int_eq(hf_frame_solve(&frame, 1, &(hf_frame_load){force, NULL, NULL}, work, u, &bad_dof), HF_OK);
        for (int i = 0; i < 3 * n; i++) {
            ck_assert_double_eq_tol(F[j * 3 * n + i], u[6 * node[i / 3] + i % 3], 1e-10 * most);
            ck_assert_double_eq(F[j * 3 * n + i], F[i * 3 * n + j]);
        }
    }
    for (int trial = 0; trial < 10; trial++) { /* f'Ff > 0, unless all of f stands on supports */
        double f[18], energy = 0, off_support = 0;
        for (int i = 0; i < 3 * n; i++) {
            f[i] = rng_uniform(&rng, -1, 1);
            if (frame.row_of_dof[6 * node[i / 3] + i % 3] >= 0) off_support = 1;
        }
        for (int i = 0; i < 9 * n * n; i++)
            energy += F[i] * f[i / (3 * n)] * f[i % (3 * n)];
        ck_assert(off_support == 0 ? energy == 0 : energy > 0);
    }
    free(F);
    free(force);
    free(u);
    free(work);
    hf_frame_free(&frame);
    hf_truss_free(&t);
}
END_TEST

/* The stiffness matrix by blocks, times the displacements under random forces, is those forces. Rows of supports have
 * no entry. A point given twice has no matrix. */
START_TEST(blocks)
{
    struct rng rng = rng_start((uint64_t)_i);
    hf_truss t;
    hf_frame frame;
    hf_stiffness_blocks k;
    struct loads l;
    struct solved s;
    random_truss(&t, &rng);
    build_frame(&t, &frame);
    random_loads(&l, &t, &rng);
    l.load.settlement = l.load.temperature_K = NULL;
    solve_truss(&t, &l.load, &s);
    int node[2] = {t.n_node - 1, rng_int(&rng, 0, t.n_node - 2)}, n = 2,
        *first = calloc(2 * (size_t)t.n_node, sizeof *first);
    ck_assert_int_eq(hf_frame_blocks(&frame, 2, node, &k), HF_OK);
    first[0] = 6 * node[0]; /* the first of the three dofs of each block */
    first[1] = 6 * node[1];
    for (int turn = 0; turn < 2; turn++)
        for (int i = 0; i < t.n_node; i++) {
            int dof = 6 * i + 3 * turn;
            bool is_point = turn == 0 && (i == node[0] || i == node[1]);
            if (is_point ||
                (turn == 1 && frame.row_of_dof[dof] == HF_FRAME_ABSENT &&
                 frame.row_of_dof[dof + 1] == HF_FRAME_ABSENT && frame.row_of_dof[dof + 2] == HF_FRAME_ABSENT))
                continue;
            first[n++] = dof;
        }
    ck_assert_int_eq(k.n, n);
    double *force = zeros(6 * (size_t)t.n_node), most = largest(6 * t.n_node, l.force);
    for (int b = 0; b < k.n_block; b++) {
        const hf_stiffness_block *block = &k.block[b];
        for (int i = 0; i < 9; i++) {
            int row = first[block->row] + i / 3, column = first[block->column] + i % 3;
            double entry = block->entry[i / 3][i % 3];
            if (k.is_held[3 * block->row + i / 3] || k.is_held[3 * block->column + i % 3])
                ck_assert_double_eq(entry, 0);
            force[row] += entry * s.displacement[column];
            if (block->row != block->column) force[column] += entry * s.displacement[row];
        }
    }
    for (int i = 0; i < 3 * n; i++) {
        int dof = first[i / 3] + i % 3;
        ck_assert_int_eq(k.is_held[i], frame.row_of_dof[dof] < 0);
        if (!k.is_held[i]) ck_assert_double_eq_tol(force[dof], l.force[dof], TOLERANCE * most);
        if (i % 3 == 0) ck_assert_mem_eq(k.position_m + i, t.position_m + 3 * (dof / 6), 3 * sizeof(double));
    }
    hf_arena_free_block(k.memory);
    node[1] = node[0];
    ck_assert_int_eq(hf_frame_blocks(&frame, 2, node, &k), HF_OK);
    ck_assert_int_eq(k.n, 0);
    hf_arena_free_block(k.memory);
    free(first);
    free(force);
    free_solved(&s);
    free_loads(&l);
    hf_frame_free(&frame);
    hf_truss_free(&t);
}
END_TEST

static void permute(int n, int *order, struct rng *rng)
{
    for (int i = 0; i < n; i++) {
        int j = rng_int(rng, 0, i);
        order[i] = order[j];
        order[j] = i;
    }
}

/* Other numbers for the nodes, another order of the members, members turned end for end: the same motion. Members that
 * are turned see their local y and z turned too, so their roll is turned back: y' = -y, z' = z. */
START_TEST(renumbering_changes_nothing)
{
    struct rng rng = rng_start((uint64_t)_i);
    hf_truss t, r;
    struct loads l;
    struct solved s, again;
    int node[40], member[128];
    random_truss(&t, &rng);
    random_loads(&l, &t, &rng);
    ck_assert_int_eq(hf_truss_allocate(&r, t.n_node, t.n_member, 0), HF_OK);
    permute(t.n_node, node, &rng);
    permute(t.n_member, member, &rng);
    double *force = zeros(6 * (size_t)t.n_node), *settlement = zeros(6 * (size_t)t.n_node);
    double *rise = zeros((size_t)t.n_member), *expected = zeros(6 * (size_t)t.n_node);
    for (int i = 0; i < t.n_node; i++) {
        int to = node[i];
        memcpy(r.position_m + 3 * to, t.position_m + 3 * i, 3 * sizeof(double));
        r.fixed[to] = t.fixed[i];
        memcpy(force + 6 * to, l.force + 6 * i, 6 * sizeof(double));
        memcpy(settlement + 6 * to, l.settlement + 6 * i, 6 * sizeof(double));
    }
    for (int e = 0; e < t.n_member; e++) {
        int to = member[e], turn = rng_int(&rng, 0, 1);
        r.end[2 * to + turn] = node[t.end[2 * e]];
        r.end[2 * to + 1 - turn] = node[t.end[2 * e + 1]];
        r.joint[to] = t.joint[e];
#define COPY(name, units, otherwise, description) r.name[to] = t.name[e];
        HF_MEMBER_NUMBERS(COPY)
#undef COPY
        if (turn) r.roll_rad[to] = -t.roll_rad[e];
        rise[to] = l.rise[e];
    }
    name_truss(&r);
    solve_truss(&t, &l.load, &s);
    solve_truss(&r, &(hf_frame_load){force, settlement, rise}, &again);
    for (int i = 0; i < t.n_node; i++)
        memcpy(expected + 6 * node[i], s.displacement + 6 * i, 6 * sizeof(double));
    check_alike(s.n, again.displacement, expected, TOLERANCE);
    free(force);
    free(settlement);
    free(rise);
    free(expected);
    free_solved(&s);
    free_solved(&again);
    free_loads(&l);
    hf_truss_free(&t);
    hf_truss_free(&r);
}
END_TEST

static void cross_product(const double *a, const double *b, double *c)
{
    for (int k = 0; k < 3; k++)
        c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Turning the frame turns its motion in the same way. Local axes are defined by the world's vertical, so the roll of a
 * turned member is computed: the angle from its y without roll to the turned y. */
START_TEST(rotation_turns_everything)
{
    struct rng rng = rng_start((uint64_t)_i);
    hf_truss t;
    struct loads l;
    struct solved s, turned;
    double R[9], *x = R, *y = R + 3, *z = R + 6, other[3];
    random_truss(&t, &rng);
    random_loads(&l, &t, &rng);
    for (int i = 0; i < t.n_node; i++)
        t.fixed[i] = t.fixed[i] == 0x3f ? 0x3f : 0; /* single components do not turn */
    solve_truss(&t, &l.load, &s);
    for (int c = 0; c < 3; c++) {
        x[c] = rng_uniform(&rng, -1, 1);
        other[c] = rng_uniform(&rng, -1, 1);
    }
    cross_product(x, other, z);
    cross_product(z, x, y);
    for (int k = 0; k < 3; k++) {
        double length = sqrt(R[3 * k] * R[3 * k] + R[3 * k + 1] * R[3 * k + 1] + R[3 * k + 2] * R[3 * k + 2]);
        for (int c = 0; c < 3; c++)
            R[3 * k + c] /= length;
    }
#define TURN(v)                                                                                                        \
    do {                                                                                                               \
        double old[3] = {(v)[0], (v)[1], (v)[2]};                                                                      \
        for (int k = 0; k < 3; k++)                                                                                    \
            (v)[k] = R[3 * k] * old[0] + R[3 * k + 1] * old[1] + R[3 * k + 2] * old[2];                                \
    } while (0)
    for (int i = 0; i < t.n_node; i++)
        TURN(t.position_m + 3 * i);
    for (int i = 0; i < 2 * t.n_node; i++) {
        TURN(l.force + 3 * i);
        TURN(l.settlement + 3 * i);
        TURN(s.displacement + 3 * i);
    }
    for (int e = 0; e < t.n_member; e++) {
        double axis[3], wanted[3], plain_y[3], plain_z[3];
        memcpy(axis, s.frame.axes + 9 * e, sizeof axis);
        memcpy(wanted, s.frame.axes + 9 * e + 3, sizeof wanted);
        TURN(axis);
        TURN(wanted);
        double across = hypot(axis[0], axis[1]);
        plain_y[0] = -axis[1] / across;
        plain_y[1] = axis[0] / across;
        plain_y[2] = 0;
        cross_product(axis, plain_y, plain_z);
        t.roll_rad[e] = atan2(wanted[0] * plain_z[0] + wanted[1] * plain_z[1] + wanted[2] * plain_z[2],
                              wanted[0] * plain_y[0] + wanted[1] * plain_y[1] + wanted[2] * plain_y[2]);
    }
    solve_truss(&t, &l.load, &turned);
    check_alike(s.n, turned.displacement, s.displacement, TOLERANCE);
    free_solved(&s);
    free_solved(&turned);
    free_loads(&l);
    hf_truss_free(&t);
}
END_TEST

/* Timoshenko's beam with ever larger shear areas becomes Euler and Bernoulli's. */
START_TEST(stiff_in_shear_is_euler_bernoulli)
{
    struct rng rng = rng_start((uint64_t)_i);
    hf_truss t;
    struct loads l;
    struct solved stiff, plain, soft;
    random_truss(&t, &rng);
    random_loads(&l, &t, &rng);
    solve_truss(&t, &l.load, &soft);
    for (int e = 0; e < t.n_member; e++)
        t.Asy_m2[e] = t.Asz_m2[e] = 1e12;
    solve_truss(&t, &l.load, &stiff);
    for (int e = 0; e < t.n_member; e++)
        t.Asy_m2[e] = t.Asz_m2[e] = INFINITY;
    solve_truss(&t, &l.load, &plain);
    check_alike(plain.n, stiff.displacement, plain.displacement, TOLERANCE);
    ck_assert_double_gt(fabs(largest(soft.n, soft.displacement) / largest(soft.n, plain.displacement) - 1), 1e-7);
    free_solved(&soft);
    free_solved(&stiff);
    free_solved(&plain);
    free_loads(&l);
    hf_truss_free(&t);
}
END_TEST

/* A frame without supports, or free to turn about one node, is refused, whatever sign rounding gives its last pivot. */
START_TEST(loose_frames_are_refused)
{
    struct rng rng = rng_start((uint64_t)_i);
    hf_truss t;
    hf_frame frame;
    hf_messages messages = {0};
    random_truss(&t, &rng);
    t.fixed[0] = t.fixed[1] = 0;
    ck_assert_int_eq(hf_frame_build(&t, &frame, &messages), HF_MECHANISM);
    hf_frame_free(&frame);
    t.fixed[rng_int(&rng, 0, t.n_node - 1)] = 0x07 | (unsigned char)(1 << rng_int(&rng, 3, 5));
    ck_assert_int_eq(hf_frame_build(&t, &frame, &messages), HF_MECHANISM);
    hf_frame_free(&frame);
    hf_messages_free(&messages);
    hf_truss_free(&t);
}
END_TEST

Suite *suite_property_frame(void)
{
    Suite *suite = suite_create("property/frame");
    TCase *tests = tcase_create("frame");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, equilibrium, 0, TRIALS);
    tcase_add_loop_test(tests, rigid_motion_strains_nothing, 0, TRIALS);
    tcase_add_loop_test(tests, energy_and_superposition, 0, TRIALS);
    tcase_add_loop_test(tests, flexibility, 0, TRIALS);
    tcase_add_loop_test(tests, blocks, 0, TRIALS);
    tcase_add_loop_test(tests, renumbering_changes_nothing, 0, TRIALS);
    tcase_add_loop_test(tests, rotation_turns_everything, 0, TRIALS);
    tcase_add_loop_test(tests, stiff_in_shear_is_euler_bernoulli, 0, TRIALS);
    tcase_add_loop_test(tests, loose_frames_are_refused, 0, TRIALS);
    return suite;
}
