/* Thousands of seeded random nets: well-posed ones must be solved, ill-posed ones refused with their culprit.
 *
 * A short run in `make test`; `make stress` (HIFDM_STRESS=1) tries 20 times as many. HIFDM_TEST_SEED replays a run. */
#include "stress.h"

#include <inttypes.h>
#include <stdio.h>

/* ---- well-posed ---- */

static void planar_known(struct rng *rng, hf_scene *s)
{
    known_scene(rng, &(struct known){.is_planar = 1, .decades = 1, .shake = 0.1, .law = "tf"}, s);
}

static void spatial_known(struct rng *rng, hf_scene *s)
{
    known_scene(rng, &(struct known){.decades = 1, .shake = 0.1, .law = "tf"}, s);
}

static void spatial_tension(struct rng *rng, hf_scene *s)
{
    known_scene(rng, &(struct known){.decades = 1, .shake = 0.1, .law = "t"}, s);
}

static void with_lengths(struct rng *rng, hf_scene *s)
{
    known_scene(rng, &(struct known){.decades = 1, .shake = 0.05, .law = "ttffl"}, s);
}

static void one_side(struct rng *rng, hf_scene *s)
{
    known_scene(rng, &(struct known){.decades = 1, .shake = 0.1, .law = "tf", .one_side = 1}, s);
}

static void four_decades(struct rng *rng, hf_scene *s)
{
    known_scene(rng, &(struct known){.decades = 4, .shake = 0.1, .law = "tf"}, s);
}

static void mixed_reflector(struct rng *rng, hf_scene *s)
{
    random_reflector_scene(rng, s);
    mix_laws(rng, s);
}

/* ---- ill-posed ---- */

/* A reflector without scallop: its outer edges are straight and loaded. */
static void straight_edges(struct rng *rng, hf_scene *s)
{
    random_reflector_scene(rng, s);
    hf_scene_free(s);
    hf_messages messages = {0};
    hf_cylinder cylinder = {.aperture_m = rng_uniform(rng, 3, 5),
                            .length_m = rng_uniform(rng, 3, 5),
                            .focal_length_m = rng_uniform(rng, 3, 8),
                            .modules = {rng_int(rng, 2, 4), rng_int(rng, 2, 4)},
                            .cells_per_module = {2, 2},
                            .boundary = (hf_boundary)rng_int(rng, 0, 1),
                            .supports = HF_SUPPORTS_MODULE_CORNERS};
    ck_assert_msg(hf_scene_parabolic_cylinder(&cylinder, NULL, s, &messages) == HF_OK, "%s", messages.text);
}

/* One cable of a quad net pulls more than all others at its node can balance. */
static void overpowered(struct rng *rng, hf_scene *s)
{
    random_tension_scene(rng, s);
    for (;;) {
        int e = rng_int(rng, 0, s->n_cable - 1);
        if (s->role[s->end[2 * e]] != HF_ROLE_INNER || s->role[s->end[2 * e + 1]] != HF_ROLE_INNER) continue;
        s->target[e] *= rng_uniform(rng, 10, 1000);
        return;
    }
}

/* A free node whose load exceeds the sum of its tensions has no equilibrium: it moves away without end. */
static void overloaded(struct rng *rng, hf_scene *s)
{
    random_tension_scene(rng, s);
    for (int i = 0; i < s->n_node; i++)
        if (s->role[i] == HF_ROLE_INNER) s->load_N[3 * i + 2] += rng_uniform(rng, 50, 500);
}

/* The last column of a quad net is let go: one cable each, under law tension, and no edge cable to hold them. */
static void unanchored_edge(struct rng *rng, hf_scene *s)
{
    random_tension_scene(rng, s);
    double most = -INFINITY;
    for (int i = 0; i < s->n_node; i++)
        most = fmax(most, s->position_m[3 * i]);
    for (int e = 0; e < s->n_cable; e++)
        for (int side = 0; side < 2; side++) {
            int i = s->end[2 * e + side];
            if (s->position_m[3 * i] > most - 0.5) s->role[i] = HF_ROLE_INNER;
        }
}

static void cut_off(struct rng *rng, hf_scene *s)
{
    random_fdm_scene(rng, s);
    for (int e = 0; e < s->n_cable; e++) /* every cable at node 4 is led elsewhere */
        for (int side = 0; side < 2; side++)
            if (s->end[2 * e + side] == 4) s->end[2 * e + side] = s->end[2 * e + 1 - side] == 0 ? 1 : 0;
    s->role[4] = HF_ROLE_INNER;
}

static void coincident(struct rng *rng, hf_scene *s)
{
    random_tension_scene(rng, s);
    int e = rng_int(rng, 0, s->n_cable - 1);
    memcpy(s->position_m + 3 * s->end[2 * e], s->position_m + 3 * s->end[2 * e + 1], 3 * sizeof(double));
}

/* ---- the run ---- */

static const struct family {
    const char *name;
    void (*make)(struct rng *, hf_scene *);
    int n, is_well_posed;
} families[] = {
    {"planar, answer known", planar_known, 100, 1},
    {"spatial, answer known", spatial_known, 100, 1},
    {"spatial, tensions only", spatial_tension, 100, 1},
    {"spatial, some lengths", with_lengths, 100, 1},
    {"supports on one side", one_side, 100, 1},
    {"tensions over four decades", four_decades, 100, 1},
    {"quad net under load", random_tension_scene, 100, 1},
    {"scalloped reflector", random_reflector_scene, 60, 1},
    {"reflector of all laws", mixed_reflector, 60, 1},
    {"force densities", random_fdm_scene, 60, 1},
    {"straight loaded edges", straight_edges, 20, 0},
    {"one cable too strong", overpowered, 20, 0},
    {"load beyond the tensions", overloaded, 20, 0},
    {"unanchored edge", unanchored_edge, 20, 0},
    {"cut off from supports", cut_off, 20, 0},
    {"nodes at one place", coincident, 20, 0},
};
enum { N_FAMILY = sizeof families / sizeof *families };

START_TEST(every_net_is_solved_or_named)
{
    struct tally well = {0}, ill = {0}, all = {0};
    int is_long = is_long_run(), n_told = 0;
    for (int f = 0; f < N_FAMILY; f++) {
        struct tally t = {0};
        for (int k = 0; k < families[f].n * (is_long ? 20 : 1); k++) {
            struct rng rng = rng_start((uint64_t)(100000 * f + k));
            hf_scene scene;
            families[f].make(&rng, &scene);
            struct outcome o = try_scene(&scene, 10);
            tally_add(&t, &o);
            if (o.verdict != (families[f].is_well_posed ? SOLVED : NAMED) && n_told++ < 20)
                printf("stress/random: %s, net %d: %s after %d iterations, residual %.1e Td\n", families[f].name, k,
                       hf_status_word(o.status), o.iterations, o.residual);
        }
        if (is_long) tally_print(families[f].name, &t);
        tally_join(families[f].is_well_posed ? &well : &ill, &t);
    }
    tally_join(&all, &well);
    tally_join(&all, &ill);
    printf("seed %" PRIu64 ", %d of %d well-posed solved, %d of %d ill-posed named\n", test_seed(), well.count[SOLVED],
           well.n, ill.count[NAMED], ill.n);
    tally_print("stress/random", &all);
    ck_assert_int_eq(all.count[WRONG], 0);
    ck_assert_int_ge(1000 * well.count[SOLVED], 995 * well.n);
    ck_assert_int_eq(ill.count[NAMED], ill.n);
}
END_TEST

Suite *suite_stress_random(void)
{
    Suite *suite = suite_create("stress/random");
    TCase *tests = tcase_create("random");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, every_net_is_solved_or_named);
    return suite;
}
