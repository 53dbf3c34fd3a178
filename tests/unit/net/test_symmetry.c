/* Mirror images of boundary cables: what counts as one, what breaks a symmetry, and what linked genes do. */
#include "nets.h"

#include "net/symmetry.h"

static hf_status apply(struct net *net, int wanted, int *planes, char *said, size_t size)
{
    hf_messages messages = {0};
    hf_status status = hf_symmetry_apply(&net->scene, &(hf_optimize_settings){.symmetry = (hf_symmetry)wanted},
                                         &net->model, planes, &messages);
    snprintf(said, size, "%s", messages.text ? messages.text : "");
    hf_messages_free(&messages);
    return status;
}

/* ---- the paper's net ---- */

/* Does gene k have an end within 1e-9 m of (x, y)? */
static bool touches(const struct net *net, int k, double x_m, double y_m)
{
    for (int side = 0; side < 2; side++) {
        const double *p = net->scene.position_m + 3 * net->scene.end[2 * net->model.variable_cable[k] + side];
        if (hypot(p[0] - x_m, p[1] - y_m) < 1e-9) return true;
    }
    return false;
}

/* The images of a gene from the definition: both ends mirrored; x about 0, y about 6 m. */
static bool are_images(const struct net *net, int a, int b, int planes)
{
    for (int mirror = 0; mirror < 4; mirror++) {
        bool all = !(mirror & ~planes);
        for (int side = 0; all && side < 2; side++) {
            const double *p = net->scene.position_m + 3 * net->scene.end[2 * net->model.variable_cable[a] + side];
            all = touches(net, b, mirror & HF_PLANE_X ? -p[0] : p[0], mirror & HF_PLANE_Y ? 12 - p[1] : p[1]);
        }
        if (all) return true;
    }
    return false;
}

static const struct {
    int wanted, planes, n_leader, n_group;
} expected[] = {{HF_SYMMETRY_NONE, 0, 120, 60},
                {HF_SYMMETRY_X, HF_PLANE_X, 60, 33},
                {HF_SYMMETRY_Y, HF_PLANE_Y, 60, 33},
                {HF_SYMMETRY_XY, HF_PLANE_X | HF_PLANE_Y, 30, 18},
                {HF_SYMMETRY_AUTO, HF_PLANE_X | HF_PLANE_Y, 30, 18}};

/* 60 module edges of two cables each: 30 along x on 6 lines (5 to a line), 30 along y. The plane x maps the 5 edges of
 * a line to 3 classes (the middle one to itself) and 6 lines along y to 3: 6 * 3 + 3 * 5 = 33; both planes: 3 * 3
 * twice. */
START_TEST(classes_of_the_papers_net)
{
    struct net net;
    char said[512];
    int planes;
    OPEN_CASE(&net, "configs/straight-edges.yaml");
    const hf_model *m = &net.model;
    ck_assert_int_eq(apply(&net, expected[_i].wanted, &planes, said, sizeof said), HF_OK);
    ck_assert_int_eq(planes, expected[_i].planes);
    ck_assert_int_eq(m->n_leader, expected[_i].n_leader);
    ck_assert_int_eq(m->n_variable_group, expected[_i].n_group);
    ck_assert(model_is_valid(m));
    for (int a = 0; a < m->n_variable; a++)
        for (int b = 0; b < m->n_variable; b++) {
            bool linked = m->variable_leader[a] == m->variable_leader[b];
            ck_assert_msg(linked == are_images(&net, a, b, planes), "genes %d and %d", a, b);
            if (linked) ck_assert_int_eq(m->variable_group[a], m->variable_group[b]);
        }
    close_net(&net);
}
END_TEST

/* ---- a net by hand: a free node row between four supports, symmetric about x = 0.5 and y = 0 ---- */

enum { N_NODE = 6, N_CABLE = 7 };
static const struct hand_node nodes[N_NODE] = {
    {{-1, 0.5, 0}, HF_ROLE_SUPPORT, {0}},   {{-1, -0.5, 0}, HF_ROLE_SUPPORT, {0}},
    {{2, 0.5, 0}, HF_ROLE_SUPPORT, {0}},    {{2, -0.5, 0}, HF_ROLE_SUPPORT, {0}},
    {{0, 0, 0}, HF_ROLE_INNER, {1, 0, -1}}, {{1, 0, 0}, HF_ROLE_INNER, {-1, 0, -1}}};
/* c5 and c6 lie side by side with different tensions */
static const struct hand_cable cables[N_CABLE] = {
    {{0, 4}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 10}, {{4, 1}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 10},
    {{2, 5}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 10}, {{3, 5}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 10},
    {{4, 5}, HF_GROUP_INNER, HF_LAW_TENSION, NAN},   {{4, 5}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 5},
    {{5, 4}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 6}};

START_TEST(a_net_by_hand)
{
    struct net net;
    char said[512];
    int planes;
    OPEN_HAND(&net, nodes, cables, HF_METHOD_HIFDM);
    ck_assert_msg(apply(&net, HF_SYMMETRY_XY, &planes, said, sizeof said) == HF_OK, "%s", said);
    static const int leader[] = {0, 0, 0, 0, 4, 5}; /* genes: c0 .. c3, c5, c6 */
    ck_assert_int_eq(net.model.n_variable, 6);
    ck_assert_mem_eq(net.model.variable_leader, leader, sizeof leader);
    ck_assert_int_eq(net.model.n_leader, 3);
    close_net(&net);
}
END_TEST

/* What breaks which plane, and which cables are named. */
static void shift(struct hand_node *n, struct hand_cable *c)
{
    (void)c;
    n[4].position_m[0] += 1e-7;
}
static void nudge(struct hand_node *n, struct hand_cable *c)
{
    (void)c;
    n[4].position_m[0] += 1e-10; /* below 1e-9 of 3 m */
}
static void pull(struct hand_node *n, struct hand_cable *c)
{
    (void)c;
    n[4].load_N[0] = 1.1;
}
static void push_aside(struct hand_node *n, struct hand_cable *c)
{
    (void)c;
    n[4].load_N[1] = n[5].load_N[1] = 0.5;
}
static void relabel(struct hand_node *n, struct hand_cable *c)
{
    (void)c;
    n[5].role = HF_ROLE_EDGE;
}
static void tighten(struct hand_node *n, struct hand_cable *c)
{
    (void)n;
    c[3].target = 11;
}
static void regroup(struct hand_node *n, struct hand_cable *c)
{
    (void)n;
    c[0].group = c[1].group = HF_GROUP_INNER;
}
static void relaw(struct hand_node *n, struct hand_cable *c)
{
    (void)n;
    c[1].law = c[3].law = HF_LAW_FORCE_DENSITY;
}

static const struct {
    void (*change)(struct hand_node *, struct hand_cable *);
    int planes;
    const char *x_names, *y_names; /* of the refusal, or NULL */
} broken[] = {
    {shift, HF_PLANE_Y, ": c0, c1, c2, c3, c4 and 2 more", NULL},
    {nudge, HF_PLANE_X | HF_PLANE_Y, NULL, NULL},
    {pull, HF_PLANE_Y, ": c0, c1, c2, c3, c4 and 2 more", NULL},
    {push_aside, HF_PLANE_X, NULL, ": c0, c1, c2, c3, c4 and 2 more"},
    {relabel, HF_PLANE_Y, ": c0, c1, c2, c3, c4 and 2 more", NULL},
    {tighten, 0, ": c1, c3", ": c2, c3"},
    {regroup, HF_PLANE_Y, ": c0, c1, c2, c3", NULL},
    {relaw, HF_PLANE_X, NULL, ": c0, c1, c2, c3"},
};
enum { N_BROKEN = sizeof broken / sizeof *broken };

START_TEST(what_breaks_a_symmetry_is_named)
{
    struct hand_node n[N_NODE];
    struct hand_cable c[N_CABLE];
    struct net net;
    char said[512];
    int planes;
    memcpy(n, nodes, sizeof n);
    memcpy(c, cables, sizeof c);
    broken[_i].change(n, c);
    OPEN_HAND(&net, n, c, HF_METHOD_HIFDM);
    ck_assert_int_eq(apply(&net, HF_SYMMETRY_AUTO, &planes, said, sizeof said), HF_OK);
    ck_assert_int_eq(planes, broken[_i].planes);
    close_net(&net);
    for (int axis = 0; axis < 2; axis++) {
        const char *names = axis ? broken[_i].y_names : broken[_i].x_names;
        OPEN_HAND(&net, n, c, HF_METHOD_HIFDM);
        hf_status status = apply(&net, axis ? HF_SYMMETRY_Y : HF_SYMMETRY_X, &planes, said, sizeof said);
        ck_assert_int_eq(status, names ? HF_BAD_CASE : HF_OK);
        ck_assert_msg(!names || strstr(said, names), "%s", said);
        ck_assert_msg(!names || strstr(said, axis ? "the plane y = 0 m" : "the plane x = 0.5 m"), "%s", said);
        close_net(&net);
    }
}
END_TEST

/* ---- steps ---- */

START_TEST(linked_genes_share_the_step)
{
    int leader[] = {0, 0, 2, 2};
    hf_model m = {.n_variable = 4, .n_leader = 2, .variable_leader = leader};
    double initial[] = {10, 10 * (1 + 5e-7), 3, 4}, design[] = {10.75, 0, 3.5, 0};
    hf_symmetry_average(&m, initial);
    ck_assert_double_eq(initial[0], initial[1]); /* alike: their mean */
    ck_assert_double_eq_tol(initial[0], 10 * (1 + 2.5e-7), 1e-12);
    ck_assert(initial[2] == 3 && initial[3] == 4); /* not alike: each keeps its own */
    hf_symmetry_follow(&m, initial, design);
    ck_assert(design[0] == 10.75 && design[1] == 10.75);
    ck_assert(design[2] == 3.5 && design[3] == 4.5);
    hf_variable variable[4] = {[2] = {.scales = true}, [3] = {.scales = true}};
    m.variable = variable;
    hf_symmetry_follow(&m, initial, design);
    ck_assert(design[2] == 3.5);
    ck_assert_double_eq_tol(design[3], 4 * (3.5 / 3), 1e-15); /* the same factor */
    ck_assert_double_eq_tol(hf_symmetry_weight(&m, initial, 3), 4.0 / 3, 1e-15);
    ck_assert_double_eq(hf_symmetry_weight(&m, initial, 1), 1);
}
END_TEST

Suite *suite_unit_symmetry(void)
{
    Suite *suite = suite_create("unit/symmetry");
    TCase *tests = tcase_create("symmetry");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, classes_of_the_papers_net, 0, sizeof expected / sizeof *expected);
    tcase_add_test(tests, a_net_by_hand);
    tcase_add_loop_test(tests, what_breaks_a_symmetry_is_named, 0, N_BROKEN);
    tcase_add_test(tests, linked_genes_share_the_step);
    return suite;
}
