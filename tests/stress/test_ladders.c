/* Ladders: each raises one difficulty step by step, from harmless to beyond double precision, with a few random nets
 * per step. Every net must end in a verified solution or in a refusal that names its culprit.
 *
 * A short run in `make test`; `make stress` (HIFDM_STRESS=1) tries 20 times as many. HIFDM_TEST_SEED replays a run. */
#include "stress.h"

#include <inttypes.h>
#include <stdio.h>

static void stretch(hf_scene *s, double x, double y, double z)
{
    const double m[3][3] = {{x, 0, 0}, {0, y, 0}, {0, 0, z}}, t[3] = {0};
    double *load_N = s->load_N; /* positions only */
    s->load_N = NULL;
    map_scene(s, m, t);
    s->load_N = load_N;
    for (int e = 0; e < s->n_cable; e++)
        if (s->law[e] == HF_LAW_LENGTH) s->target[e] = hf_scene_length_at_target(s, e);
}

/* ---- ladders: rung 0, 1, ... ---- */

static void densities_16_decades(struct rng *rng, int rung, hf_scene *s)
{
    random_fdm_scene(rng, s);
    for (int e = 0; e < s->n_cable; e++)
        s->target[e] = pow(10, rng_uniform(rng, -rung, rung));
}

static void tensions_apart(struct rng *rng, int rung, hf_scene *s)
{
    known_scene(rng, &(struct known){.decades = 2 * rung, .shake = 0.01, .law = rung % 2 ? "tf" : "f"}, s);
}

/* A cable of prescribed length across the net, longer or shorter by a part 10^-1-rung than the nodes are apart: its
 * tension is nearly nothing, or nothing. */
static void nearly_slack(struct rng *rng, int rung, hf_scene *s)
{
    known_scene(rng, &(struct known){.decades = 0.5, .shake = 0, .law = "tf"}, s);
    int e = rng_int(rng, 0, s->n_cable - 1), other = rng_int(rng, 0, s->n_cable - 1);
    double sign = rng_int(rng, 0, 1) ? 1 : -1;
    int from = s->end[2 * e], to = s->end[2 * other] == from ? s->end[2 * other + 1] : s->end[2 * other];
    hf_scene more;
    ck_assert_int_eq(hf_scene_allocate(&more, s->n_node, s->n_cable + 1, 1, 0, 0), HF_OK);
    memcpy(more.position_m, s->position_m, 3 * (size_t)s->n_node * sizeof(double));
    memcpy(more.load_N, s->load_N, 3 * (size_t)s->n_node * sizeof(double));
    memcpy(more.role, s->role, (size_t)s->n_node);
    memcpy(more.end, s->end, 2 * (size_t)s->n_cable * sizeof(int));
    memcpy(more.group, s->group, (size_t)s->n_cable);
    memcpy(more.law, s->law, (size_t)s->n_cable);
    memcpy(more.target, s->target, (size_t)s->n_cable * sizeof(double));
    memcpy(more.node_id, s->node_id, (size_t)s->n_node * sizeof *s->node_id);
    memcpy(more.cable_id, s->cable_id, (size_t)s->n_cable * sizeof *s->cable_id);
    more.cable_id[s->n_cable] = "across";
    more.end[2 * s->n_cable] = from;
    more.end[2 * s->n_cable + 1] = to;
    more.law[s->n_cable] = HF_LAW_LENGTH;
    more.target[s->n_cable] = hf_scene_length_at_target(&more, s->n_cable) * (1 + sign * pow(10, -1 - rung));
    more.text = s->text;
    s->text = NULL;
    hf_scene_free(s);
    *s = more;
}

static void cylinder(struct rng *rng, double scallop, hf_scene *s)
{
    hf_messages messages = {0};
    hf_cylinder c = {.aperture_m = rng_uniform(rng, 3, 5),
                     .length_m = rng_uniform(rng, 3, 5),
                     .focal_length_m = rng_uniform(rng, 3, 8),
                     .modules = {rng_int(rng, 2, 4), rng_int(rng, 2, 4)},
                     .cells_per_module = {2, 2},
                     .spacing = (hf_spacing)rng_int(rng, 0, 1),
                     .scallop = scallop,
                     .supports = HF_SUPPORTS_MODULE_CORNERS};
    ck_assert_msg(hf_scene_parabolic_cylinder(&c, NULL, s, &messages) == HF_OK, "%s", messages.text);
}

static void nearly_straight(struct rng *rng, int rung, hf_scene *s)
{
    cylinder(rng, 0.1 * pow(10, -rung), s);
}

static void long_cells(struct rng *rng, int rung, hf_scene *s)
{
    double ratio = pow(10, rung % 4);
    if (rung / 4 % 2)
        random_tension_scene(rng, s);
    else
        random_reflector_scene(rng, s);
    if (rung < 8)
        stretch(s, 1, ratio, 1);
    else
        stretch(s, ratio, 1, 1);
}

static void micrometre_to_kilometre(struct rng *rng, int rung, hf_scene *s)
{
    double size = pow(10, rung / 3 - 6);
    if (rung % 3 == 0) random_tension_scene(rng, s);
    if (rung % 3 == 1) random_reflector_scene(rng, s);
    if (rung % 3 == 2) known_scene(rng, &(struct known){.decades = 1, .shake = 0.1, .law = "tl"}, s);
    stretch(s, size, size, size);
}

/* Two joined nodes 10^-rung m apart; the cable between them pulls with its tension, or has the force density that
 * does. */
static void near_duplicates(struct rng *rng, int rung, hf_scene *s)
{
    random_tension_scene(rng, s);
    for (;;) {
        int e = rng_int(rng, 0, s->n_cable - 1), a = s->end[2 * e], b = s->end[2 * e + 1];
        if (s->role[a] != HF_ROLE_INNER || s->role[b] != HF_ROLE_INNER) continue;
        memcpy(s->position_m + 3 * a, s->position_m + 3 * b, 3 * sizeof(double));
        for (int c = 0; c < 3; c++)
            s->position_m[3 * a + c] += pow(10, -rung) * rng_uniform(rng, 0.2, 1);
        if (rng_int(rng, 0, 1)) {
            s->law[e] = HF_LAW_FORCE_DENSITY;
            s->target[e] /= hf_scene_length_at_target(s, e);
        }
        return;
    }
}

/* Prescribed lengths and force densities under loads of 10^rung times the pretension. */
static void loads_above_pretension(struct rng *rng, int rung, hf_scene *s)
{
    if (rung % 2) {
        cylinder(rng, 0.1, s);
        for (int e = 0; e < s->n_cable; e++)
            if (s->law[e] == HF_LAW_TENSION) {
                s->law[e] = HF_LAW_LENGTH;
                s->target[e] = 1.01 * hf_scene_length_at_target(s, e);
            }
        mix_laws(rng, s);
    } else {
        random_fdm_scene(rng, s);
    }
    for (int k = 0; k < 3 * s->n_node; k++)
        s->load_N[k] *= pow(10, rung);
}

/* Held on one side, pulled by its own tension, with ever less load to hold it up. */
static void one_sided(struct rng *rng, int rung, hf_scene *s)
{
    known_scene(rng, &(struct known){.decades = 1, .shake = 0.01, .law = "tf", .one_side = 1}, s);
    for (int k = 0; k < 3 * s->n_node; k++)
        s->load_N[k] *= rung < 8 ? 1 - 0.125 * rung : 0;
}

/* ---- the run ---- */

static const struct ladder {
    const char *name;
    void (*make)(struct rng *, int rung, hf_scene *);
    int n_rung;
} ladders[] = {
    {"force densities over decades", densities_16_decades, 9},
    {"tensions over decades", tensions_apart, 9},
    {"nearly slack", nearly_slack, 15},
    {"nearly straight", nearly_straight, 13},
    {"aspect 1:1000", long_cells, 12},
    {"micrometre to kilometre", micrometre_to_kilometre, 30},
    {"near-duplicate nodes", near_duplicates, 14},
    {"loads above the pretension", loads_above_pretension, 10},
    {"supports on one side", one_sided, 9},
};
enum { N_LADDER = sizeof ladders / sizeof *ladders, N_NET = 4 };

START_TEST(every_rung_is_solved_or_named)
{
    struct tally all = {0};
    int is_long = is_long_run(), n_told = 0, n_bad = 0;
    for (int l = 0; l < N_LADDER; l++) {
        struct tally t = {0};
        for (int k = 0; k < ladders[l].n_rung * N_NET * (is_long ? 20 : 1); k++) {
            struct rng rng = rng_start((uint64_t)(10000000 + 100000 * l + k));
            int rung = k % ladders[l].n_rung;
            hf_scene scene;
            ladders[l].make(&rng, rung, &scene);
            struct outcome o = try_scene(&scene, 10);
            tally_add(&t, &o);
            n_bad += o.verdict > NAMED;
            if (o.verdict > NAMED && n_told++ < 20)
                printf("stress/ladders: %s, rung %d, net %d: %s after %d iterations, residual %.1e Td\n",
                       ladders[l].name, rung, k, hf_status_word(o.status), o.iterations, o.residual);
        }
        if (is_long) tally_print(ladders[l].name, &t);
        tally_join(&all, &t);
    }
    printf("seed %" PRIu64 ", %d cases neither solved nor named\n", test_seed(), n_bad);
    tally_print("stress/ladders", &all);
    ck_assert_int_eq(all.count[WRONG], 0);
    ck_assert_int_le(200 * n_bad, all.n); /* 99.5 %, as of random nets */
}
END_TEST

Suite *suite_stress_ladders(void)
{
    Suite *suite = suite_create("stress/ladders");
    TCase *tests = tcase_create("ladders");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, every_rung_is_solved_or_named);
    return suite;
}
