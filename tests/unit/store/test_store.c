/* Result files: what is written comes back, in C and in Python. */
#include "flexible.h"
#include "results.h"
#include "small_ga.h"

#include <hifdm/cable_set.h>

/* ---- round trips ---- */

static void fill_text(struct rng *rng, char *text, size_t size)
{
    size_t length = (size_t)rng_int(rng, 0, (int)size - 1);
    for (size_t i = 0; i < length; i++)
        text[i] = (char)rng_int(rng, 1, 126);
    text[length] = '\0';
}

/* Any bits, so also infinities, denormal numbers and NaN with a payload. */
static void fill_result(struct rng *rng, hf_form_result *result)
{
    unsigned char *bytes = (unsigned char *)result;
    for (size_t i = 0; i < sizeof *result; i++)
        bytes[i] = (unsigned char)rng_next(rng);
    result->status = rng_int(rng, 0, 1) ? HF_RATIO_CAP : HF_EXISTS;
    result->stop_reason = HF_STOPPED_ILL_POSED;
    result->bound_reason = HF_BOUND_SLACK_OR_TAUT;
    result->coupling.stop_reason = HF_COUPLING_DIVERGED;
    result->psi_m = result->merit = (double)NAN;
}

static void fill_summary(struct rng *rng, hf_summary *s)
{
    *s = (hf_summary){.threads = rng_int(rng, 1, 999),
                      .seed = rng_next(rng),
                      .n_node = rng_int(rng, 1, 1 << 30),
                      .n_free = rng_int(rng, 1, 1 << 30),
                      .n_inner_node = rng_int(rng, 1, 1 << 30),
                      .n_uncounted = rng_int(rng, 1, 1 << 30),
                      .uncounted_move_m = rng_uniform(rng, 0, 1),
                      .scale_min = rng_uniform(rng, 0, 1),
                      .scale_max = rng_uniform(rng, 1, 2),
                      .n_cable = rng_int(rng, 1, 1 << 30),
                      .n_variable = rng_int(rng, 1, 1 << 30),
                      .half_bandwidth = rng_int(rng, 1, 1 << 30),
                      .finished = 1,
                      .status = HF_NO_FEASIBLE,
                      .pretension_N = rng_uniform(rng, 0, 1),
                      .stage[HF_STAGE_FORM].wall_s = rng_uniform(rng, 0, 1),
                      .stage[HF_STAGE_SEARCH].exists = 1,
                      .has_coupling = 1,
                      .search.best_generation = rng_int(rng, -1, 1 << 30),
                      .search.best_individual = -1,
                      .search.n_leader = rng_int(rng, 1, 1 << 30),
                      .search.planes = 3,
                      .search.generations = rng_int(rng, 1, 1 << 30),
                      .search.evaluations = (long)(rng_next(rng) >> 1),
                      .search.infeasible = (long)(rng_next(rng) >> 1),
                      .search.algorithm_stop = HF_POPULATION_ALL_INFEASIBLE,
                      .stage[HF_STAGE_SEARCH].wall_s = rng_uniform(rng, 0, 1),
                      .search.cpu_s = -0.0};
    fill_text(rng, s->version, sizeof s->version);
    fill_text(rng, s->title, sizeof s->title);
    fill_text(rng, s->case_path, sizeof s->case_path);
    fill_text(rng, s->warnings, sizeof s->warnings);
    fill_result(rng, &s->stage[HF_STAGE_FORM].result);
    fill_result(rng, &s->stage[HF_STAGE_SEARCH].result);
    s->n_load_case = rng_int(rng, 0, 3);
    s->load_case = calloc((size_t)s->n_load_case + 1, sizeof *s->load_case);
    ck_assert_ptr_nonnull(s->load_case);
    for (int k = 0; k < s->n_load_case; k++) { /* in the order of the case, which is not that of the alphabet */
        snprintf(s->load_case[k].name, sizeof s->load_case[k].name, "state-%d", 9 - k);
        fill_result(rng, &s->load_case[k].result);
        s->load_case[k].tension_min_N = rng_uniform(rng, -1, 1);
        s->load_case[k].tension_max_N = INFINITY;
        s->load_case[k].displacement_rms_m = rng_uniform(rng, 0, 1);
        s->load_case[k].member_force_max_N = (double)NAN;
        s->load_case[k].surface.is_measured = rng_int(rng, 0, 1);
        if (s->load_case[k].surface.is_measured) s->load_case[k].surface.fit.center_x_m = rng_uniform(rng, 0, 1);
    }
}

static void same_fields(const hf_result_field *field, int n, const void *a, const void *b)
{
    for (const hf_result_field *f = field; f < field + n; f++)
        ck_assert_msg(!memcmp((const char *)a + f->offset, (const char *)b + f->offset, f->size), "%s", f->name);
}

/* By member, because padding between members is not stored. */
static void same_result(const hf_form_result *a, const hf_form_result *b)
{
    same_fields(hf_result_field_of, HF_RESULT_N, a, b);
    same_fields(hf_coupling_field_of, HF_COUPLING_N, &a->coupling, &b->coupling);
}

/* Bits, not values: NaN differs from itself, and 0 equals -0. */
static void same_summary(const hf_summary *a, const hf_summary *b)
{
#define MEMBER(name)                                                                                                   \
    {                                                                                                                  \
#name, offsetof(hf_summary, name), sizeof a->name                                                              \
    }
    static const struct {
        const char *name;
        size_t offset, size;
    } members[] = {MEMBER(threads),
                   MEMBER(status),
                   MEMBER(seed),
                   MEMBER(n_node),
                   MEMBER(n_free),
                   MEMBER(n_inner_node),
                   MEMBER(n_uncounted),
                   MEMBER(uncounted_move_m),
                   MEMBER(scale_min),
                   MEMBER(scale_max),
                   MEMBER(n_cable),
                   MEMBER(n_variable),
                   MEMBER(half_bandwidth),
                   MEMBER(pretension_N),
                   MEMBER(has_coupling),
                   MEMBER(stage[HF_STAGE_FORM].wall_s),
                   MEMBER(stage[HF_STAGE_SEARCH].exists),
                   MEMBER(stage[HF_STAGE_SEARCH].wall_s),
                   MEMBER(search.best_generation),
                   MEMBER(search.best_individual),
                   MEMBER(search.generations),
                   MEMBER(search.n_leader),
                   MEMBER(search.planes),
                   MEMBER(search.evaluations),
                   MEMBER(search.infeasible),
                   MEMBER(search.algorithm_stop),
                   MEMBER(search.cpu_s)};
#undef MEMBER
    same_result(&a->stage[HF_STAGE_FORM].result, &b->stage[HF_STAGE_FORM].result);
    same_result(&a->stage[HF_STAGE_SEARCH].result, &b->stage[HF_STAGE_SEARCH].result);
    ck_assert_int_eq(a->n_load_case, b->n_load_case);
    for (int k = 0; k < a->n_load_case; k++) {
        const hf_load_case_summary *s = &a->load_case[k], *t = &b->load_case[k];
        ck_assert_str_eq(s->name, t->name);
        same_result(&s->result, &t->result);
        ck_assert(!memcmp(&s->tension_min_N, &t->tension_min_N, sizeof(double)) &&
                  !memcmp(&s->tension_max_N, &t->tension_max_N, sizeof(double)) &&
                  !memcmp(&s->displacement_rms_m, &t->displacement_rms_m, sizeof(double)) &&
                  isnan(t->member_force_max_N));
        ck_assert(s->surface.is_measured == t->surface.is_measured &&
                  s->surface.fit.center_x_m == t->surface.fit.center_x_m);
    }
    ck_assert_str_eq(a->version, b->version);
    ck_assert_str_eq(a->title, b->title);
    ck_assert_str_eq(a->case_path, b->case_path);
    ck_assert_str_eq(a->warnings, b->warnings);
    for (int i = 0; i < N(members); i++)
        ck_assert_msg(
            !memcmp((const char *)a + members[i].offset, (const char *)b + members[i].offset, members[i].size), "%s",
            members[i].name);
}

START_TEST(summary_comes_back_bit_by_bit)
{
    struct rng rng = rng_start((uint64_t)_i);
    struct net net;
    hf_messages messages = {0};
    hf_summary written, read;
    open_bow(&net);
    fill_summary(&rng, &written);
    end(begin(temp_path("a.h5"), 1, &net.scene), &written);
    memset(&read, 0xff, sizeof read);
    ck_assert_int_eq(hf_store_read_summary(temp_path("a.h5"), &read, &messages), HF_OK);
    same_summary(&written, &read);
    hf_summary_free(&read);

    /* without a search, only the members of the form-finding are there */
    written.stage[HF_STAGE_SEARCH].exists = 0;
    end(begin(temp_path("b.h5"), 1, &net.scene), &written);
    ck_assert_int_eq(hf_store_read_summary(temp_path("b.h5"), &read, &messages), HF_OK);
    written.stage[HF_STAGE_SEARCH] = (hf_stage_summary){0};
    written.search = (hf_search_summary){0};
    same_summary(&written, &read);
    hf_summary_free(&read);

    /* without a truss nothing of the coupling */
    written.has_coupling = 0;
    end(begin(temp_path("c.h5"), 1, &net.scene), &written);
    ck_assert_int_eq(hf_store_read_summary(temp_path("c.h5"), &read, &messages), HF_OK);
    written.stage[HF_STAGE_FORM].result.coupling = (hf_coupling_result){0};
    same_summary(&written, &read);
    hf_summary_free(&read);
    hf_summary_free(&written);
    python("r", temp_path("c.h5"), "assert 'coupling' not in f\n");
    close_net(&net);
}
END_TEST

/* An object without items may come back as none. */
static void same_owned(const void *read, const void *written, size_t size, int n)
{
    ck_assert(read || n == 0);
    if (n > 0) ck_assert_mem_eq(read, written, size);
}

/* Any bits, NaN included; a shape that was not measured comes back as nothing. */
START_TEST(surface_comes_back_bit_by_bit)
{
    const int n = _i < 9 ? _i : HF_LIST_MAX;
    struct rng rng = rng_start(50 + (uint64_t)_i);
    struct net net;
    hf_messages messages = {0};
    const char letters[] = "of_fifty-seven_letters_behind_the_number_and_what_is_before";
    hf_summary read, written = {.surface = {.focal_length_m = 7.2,
                                            .strip_width_m = 0.25,
                                            .frequencies_Hz = {n, {0}},
                                            .mesh_tension_N_per_m = 3.5,
                                            .kind = (hf_surface_kind)(_i % 3)}};
    open_bow(&net);
    for (int k = 0; k < n; k++)
        written.surface.frequencies_Hz.value[k] = rng_uniform(&rng, 1e8, 1e11);
    for (int stage = 0; stage < 3; stage++) {
        hf_stage_summary *of = &written.stage[stage];
        hf_surface_measures *s = &of->surface;
        double *value = &s->z_rms_m; /* the first of many */
        if (stage == 1 && _i == 2) continue;
        s->is_measured = 1;
        of->sets = calloc(1, sizeof *of->sets);
        of->held = calloc(1, sizeof *of->held);
        ck_assert(of->sets && of->held);
        of->sets->n = _i % (HF_SUMMARY_SETS + 1);
        for (int k = 0; k < of->sets->n; k++) {
            snprintf(of->sets->name[k], HF_CABLE_SET_NAME_SIZE, "set_%02d%.*s", k, 57 * (k % 2), letters);
            of->sets->ratio[k] = k ? rng_uniform(&rng, 1, 2) : INFINITY;
            of->sets->min_N[k] = rng_uniform(&rng, -1, 2);
            of->sets->max_N[k] = rng_uniform(&rng, 1, 2);
        }
        of->held->n = _i * 4 % (HF_SUMMARY_HELD + 1);
        for (int k = 0; k < of->held->n; k++) {
            hf_held_limits *h = of->held;
            snprintf(h->name[k], HF_HELD_NAME_SIZE, "tension of cable %d%.*s", k, 57 * (k % 2), letters);
            h->row[k] = k / 2 - 1;
            h->count[k] = rng_int(&rng, 1, 100);
            h->value[k] = rng_uniform(&rng, -1, 2);
            h->bound[k] = rng_uniform(&rng, 1, 2);
        }
        s->fit.iterations = rng_int(&rng, 0, 100);
        s->fit.converged = stage == 0;
        for (size_t k = 0; (char *)(value + k) < (char *)&s->fit.iterations; k++)
            value[k] = k == 3 ? (double)NAN : rng_uniform(&rng, -1, 1);
        for (int k = 0; k < n; k++) {
#define LOSS(member, unit, description) s->member[k] = rng_uniform(&rng, 0, 1);
            HF_SURFACE_LOSS_LIST(LOSS)
#undef LOSS
        }
    }
    end(begin(temp_path("a.h5"), 1, &net.scene), &written);
    ck_assert_int_eq(hf_store_read_summary(temp_path("a.h5"), &read, &messages), HF_OK);
    ck_assert_mem_eq(&read.surface, &written.surface, sizeof read.surface);
    for (int stage = 0; stage < 3; stage++) {
        const hf_stage_summary *a = &read.stage[stage], *b = &written.stage[stage];
        ck_assert_mem_eq(&a->surface, &b->surface, sizeof a->surface);
        same_owned(a->sets, b->sets, sizeof *a->sets, b->sets ? b->sets->n : 0);
        same_owned(a->held, b->held, sizeof *a->held, b->held ? b->held->n : 0);
    }
    hf_summary_free(&read);
    hf_summary_free(&written);
    close_net(&net);
}
END_TEST

/* Without and with all that a scene may have. */
START_TEST(scene_comes_back)
{
    struct net net;
    hf_messages messages = {0};
    hf_scene with = {0}, read, *a, *b = &read;
    open_bow(&net);
    a = &net.scene;
    if (_i) {
        ck_assert_int_eq(hf_scene_allocate(&with, 3, 2, 1, 1, 1), HF_OK);
        for (int i = 0; i < 9; i++)
            with.load_N[i] = with.position_m[i] = 1.0 / (i - 3);
        const char *id[5] = {"", "n", "a long name, with \xc3\xa9", "c \"1\"", "c2"};
        memcpy(with.node_id, id, 3 * sizeof *id);
        memcpy(with.cable_id, id + 3, 2 * sizeof *id);
        memcpy(with.role, "\2\1\0", 3);
        memcpy(with.end, (int[4]){0, 1, 2, 1}, 4 * sizeof(int));
        with.target[0] = with.EA_N[1] = (double)NAN;
        with.law[1] = HF_LAW_FORCE_DENSITY;
        with.group[0] = HF_GROUP_BOUNDARY;
        const hf_cable_set_member member[] = {{2, 0}, {0, 1}, {2, 1}};
        const char *name[] = {"front", "nobody", "z-1_longer"};
        ck_assert_int_eq(hf_cable_set_make(&with, 3, name, 3, member), HF_OK);
        ck_assert_ptr_nonnull(with.facet = malloc(8 * sizeof *with.facet));
        memcpy(with.facet, (int[8]){0, 1, 2, 2, 2, 1, 0, 1}, 8 * sizeof(int));
        with.n_facet = 2;
        a = &with;
    }
    end(begin(temp_path("a.h5"), 1, a), &(hf_summary){0});
    ck_assert_int_eq(hf_store_read_scene(temp_path("a.h5"), b, &messages), HF_OK);
    ck_assert_int_eq(b->n_node, 3);
    ck_assert_int_eq(b->n_cable, 2);
    ck_assert_mem_eq(a->position_m, b->position_m, 9 * sizeof(double));
    ck_assert_mem_eq(a->role, b->role, 3);
    ck_assert_mem_eq(a->end, b->end, 4 * sizeof(int));
    ck_assert_mem_eq(a->group, b->group, 2);
    ck_assert_mem_eq(a->law, b->law, 2);
    ck_assert_mem_eq(a->target, b->target, 2 * sizeof(double));
    ck_assert_mem_eq(a->load_N, b->load_N, 9 * sizeof(double));
    ck_assert_int_eq(a->EA_N != NULL, b->EA_N != NULL);
    if (_i) ck_assert_mem_eq(a->EA_N, b->EA_N, 2 * sizeof(double));
    for (int i = 0; i < 3; i++)
        ck_assert_str_eq(a->node_id[i], b->node_id[i]);
    for (int e = 0; e < 2; e++)
        ck_assert_str_eq(a->cable_id[e], b->cable_id[e]);
    ck_assert_int_eq(b->n_set, _i ? 2 : 0);
    ck_assert_int_eq(b->n_facet, _i ? 2 : 0);
    if (_i) ck_assert_mem_eq(b->facet, a->facet, 8 * sizeof(int));
    ck_assert_int_eq(b->set_block != NULL, _i);
    if (_i) {
        ck_assert_mem_eq(b->set_start, ((int[]){0, 1, 3}), 3 * sizeof(int));
        ck_assert_mem_eq(b->set_cable, ((int[]){1, 0, 1}), 3 * sizeof(int));
        ck_assert_str_eq(b->set_name[0], "front");
        ck_assert_str_eq(b->set_name[1], "z-1_longer");
    }
    ck_assert_ptr_null(b->node_line);
    hf_scene_free(b);
    hf_scene_free(&with);
    close_net(&net);
}
END_TEST

/* In the order of the scene, which is not that of the model. */
START_TEST(shapes_come_back_in_the_order_of_the_scene)
{
    struct net net;
    hf_messages messages = {0};
    hf_shape shape;
    double psi_m[2] = {2.385, 1.125}, other[8] = {0.5, 0.25, 7, 8, 9, 10, 11, 12};
    hf_history history = {4, 2, psi_m, other, other + 2, other + 4, other + 6, {0}};
    OPEN_CASE(&net, SMALL_REFLECTOR);
    const hf_model *m = &net.model;
    double *design = calloc((size_t)m->n_variable, sizeof *design);
    hf_store *store = begin(temp_path("a.h5"), 1, &net.scene);
    find_shape(&net);
    ck_assert_int_eq(hf_store_form(store, m, &net.work, &history, &messages), HF_OK);
    double first_m = found_m(&net, 12, 2);
    net.work.q_N_per_m[3] *= 2; /* another shape */
    hf_form_find(m, &net.form, net.form.stop, &net.work, NULL, &net.result);
    net.work.law[2] = HF_LAW_FORCE_DENSITY;
    ck_assert_int_eq(hf_store_shape(store, HF_STAGE_SEARCH, m, &net.work, design, &messages), HF_OK);
    end(store, &(hf_summary){0});

    ck_assert_int_eq(hf_store_read_shape(temp_path("a.h5"), HF_STAGE_FORM, &shape, &messages), HF_OK);
    ck_assert_double_eq(shape.position_m[3 * 12 + 2], first_m);
    hf_shape_free(&shape);
    ck_assert_int_eq(hf_store_read_shape(temp_path("a.h5"), HF_STAGE_SEARCH, &shape, &messages), HF_OK);
    for (int i = 0; i < 3 * m->n_node; i++)
        ck_assert_double_eq(shape.position_m[i], found_m(&net, i / 3, i % 3));
    ck_assert_mem_eq(shape.length_m, net.work.length_m, (size_t)m->n_cable * sizeof(double));
    ck_assert_mem_eq(shape.tension_N, net.work.tension_N, (size_t)m->n_cable * sizeof(double));
    ck_assert_mem_eq(shape.q_N_per_m, net.work.q_N_per_m, (size_t)m->n_cable * sizeof(double));
    ck_assert_mem_eq(shape.law, net.work.law, (size_t)m->n_cable);
    hf_shape_free(&shape);
    ck_assert_ptr_null(shape.position_m);
    python("r", temp_path("a.h5"),
           "h = f['form/history']\n"
           "assert list(h['psi_m']) == [2.385, 1.125] and list(h['length_error']) == [11, 12]\n"
           "assert h5py.check_enum_dtype(f['form/law'].dtype) == {'tension': 0, 'length': 1, 'force_density': 2, "
           "'elastic': 3}");
    free(design);
    close_net(&net);
}
END_TEST

/* Two cables between two supports on a truss. */
START_TEST(coupling_is_stored_beside_the_shape)
{
    struct net net;
    struct rng rng = rng_start(4);
    hf_messages messages = {0};
    double form[5][8] = {{0}}, coupling[3][2] = {{1e-3, 1e-7}, {0.5, 0.25}, {0, 2e-3}};
    hf_history history = {8,       1,       form[0], form[1],
                          form[2], form[3], form[4], {2, 2, coupling[0], coupling[1], coupling[2]}};
    static const struct hand_node node[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 0.5, 0}, HF_ROLE_INNER, {0}}, {{2, 1, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{2, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10}};
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    attach_all(&net, &rng, 1e-4);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_ACCELERATED, 1e-9), HF_OK);
    hf_store *store = begin(temp_path("a.h5"), 1, &net.scene);
    ck_assert_int_eq(hf_store_form(store, &net.model, &net.work, &history, &messages), HF_OK);
    end(store, &(hf_summary){.has_coupling = 1, .stage[HF_STAGE_FORM].result = net.result});
    char script[800];
    snprintf(script, sizeof script,
             "c, n = f['coupling'], f['scene/node']\n"
             "moved = f['form/position_m'][:] - n['position_m'][:]\n"
             "import numpy as np\n"
             "assert list(c['node']) == [0, 2] and np.abs(moved[c['node'][:]] - c['displacement_m'][:]).max() < 1e-15\n"
             "assert np.abs(c['displacement_m'][:]).max() > 1e-4 and c['force_N'].attrs['units'] == 'N'\n"
             "assert list(c['history/step_m']) == [1e-3, 1e-7] and list(c['history/psi_m']) == [0.5, 0.25]\n"
             "assert c.attrs['iterations'] == %d and c.attrs['stop_reason'] == 1\n",
             net.result.coupling.iterations);
    python("r", temp_path("a.h5"), script);
    close_net(&net);
}
END_TEST

START_TEST(a_run_without_a_best_says_so)
{
    struct net net;
    hf_messages messages = {0};
    hf_shape shape;
    open_bow(&net);
    end(begin(temp_path("a.h5"), 1, &net.scene), &(hf_summary){0});
    ck_assert_int_eq(hf_store_read_shape(temp_path("a.h5"), HF_STAGE_SEARCH, &shape, &messages), HF_IO);
    ck_assert_ptr_nonnull(strstr(messages.text, "has no search shape"));
    hf_messages_free(&messages);
    close_net(&net);
}
END_TEST

/* ---- generations, read by Python ---- */

/* Sizes of a generation: usual; a row beyond one chunk; a single gene beyond one chunk; nothing to vary. */
static const struct {
    int n_individual, n_variable;
} sizes[] = {{4, 3}, {3, 70000}, {2, 140000}, {2, 0}};

/* An hf_optimiser in which every number shows by its value at which place it belongs. */
static void fill_generation(hf_population *g, int generation)
{
    g->generation = generation;
    for (int i = 0; i < g->n_individual; i++) {
        for (int k = 0; k < g->n_variable; k++)
            g->design[(size_t)i * (size_t)g->n_variable + (size_t)k] = generation * 1e7 + i * 1e6 + k;
        g->result[i] = (hf_form_result){.status = i == 1 ? HF_RATIO_CAP : HF_OK,
                                        .iterations = 10 * generation + i,
                                        .psi_m = i == 1 ? (double)NAN : generation + 0.1 * i,
                                        .merit = i == 1 ? (double)NAN : generation + 0.1 * i,
                                        .residual_N = generation + 0.25 * i,
                                        .inner_tension_ratio = 1 + i,
                                        .boundary_tension_ratio = 5 + i};
        g->pending[i] = (unsigned char)(i != 0);
        g->crossover_rate[i] = 0.5 + i;
        g->mutation_rate[i] = 0.25 + i;
        g->parent[2 * i] = generation - 1;
        g->parent[2 * i + 1] = i;
    }
    g->best = generation - 1;
    g->best_psi_m[generation] = g->best_merit[generation] = g->mean_psi_m = g->worst_psi_m = generation + 0.5;
    g->n_infeasible = 1;
}

START_TEST(generations_are_appended)
{
    int p = sizes[_i].n_individual, k = sizes[_i].n_variable;
    struct net net;
    hf_messages messages = {0};
    hf_optimiser ga;
    hf_optimize_settings settings = small_ga(p, 5);
    open_bow(&net);
    double *initial = malloc(((size_t)k + 1) * sizeof *initial);
    int *variable = malloc((3 * (size_t)k + 1) * sizeof *variable), *group = variable + k, *leader = group + k;
    for (int i = 0; i < k; i++) {
        initial[i] = i + 1;
        variable[i] = 2 * i;
        group[i] = i / 2;
        leader[i] = i;
    }
    hf_model m = {.n_variable = k,
                  .n_variable_group = k,
                  .variable_cable = variable,
                  .variable_group = group,
                  .variable_leader = leader,
                  .n_leader = k};
    ck_assert_int_eq(hf_optimiser_create(&hf_optimiser_ga, &settings, &m, initial, &ga), HF_OK);
    hf_store *store = begin(temp_path("a.h5"), 1, &net.scene);
    for (int g = 0; g < 5; g++) {
        fill_generation(&ga.population, g);
        ck_assert_msg(hf_store_generation(store, &m, &ga.population, &messages) == HF_OK, "%s", messages.text);
    }
    end(store, &(hf_summary){.stage[HF_STAGE_SEARCH] = {.exists = 1, .result.status = HF_NOT_EVALUATED},
                             .status = HF_NO_FEASIBLE});
    hf_optimiser_free(&ga);

    char script[2048];
    snprintf(
        script, sizeof script,
        "a = f['search/population']; v = f['variable']; p = %d; k = %d; g = np.arange(5)[:, None]; i = np.arange(p)\n"
        "design = a['design'][:][a['design_row'][:]]\n"
        "assert design.shape == (5, p, k) and a['design'].dtype == 'f8'\n"
        "assert np.prod(a['design'].chunks) * 8 <= 1 << 20\n"
        "assert (design == g[:, :, None] * 1e7 + i[:, None] * 1e6 + np.arange(k)).all()\n"
        "psi = g + 0.1 * i; psi[:, 1] = np.nan\n"
        "np.testing.assert_array_equal(a['psi_m'][:], psi)\n"
        "np.testing.assert_array_equal(a['status'][:], 0 * g + (i == 1) * 6)\n"
        "assert h5py.check_enum_dtype(a['status'].dtype)['ratio_cap'] == 6\n"
        "assert (a['residual_N'][:] == g + 0.25 * i).all() and (a['iterations'][:] == 10 * g + i).all()\n"
        "assert (a['inner_tension_ratio'][4] == 1 + i).all() and (a['boundary_tension_ratio'][4] == 5 + i).all()\n"
        "assert a['evaluated'].dtype == bool and (a['evaluated'][:] == (i != 0)).all()\n"
        "assert (a['crossover_rate'][3] == 0.5 + i).all() and (a['mutation_rate'][3] == 0.25 + i).all()\n"
        "assert (a['parent'][:, :, 0] == g - 1).all() and (a['parent'][:, :, 1] == i).all()\n"
        "for name in 'best', 'mean', 'worst': assert (a[name + '_psi_m'][:] == g[:, 0] + 0.5).all()\n"
        "assert (a['best_individual'][:] == g[:, 0] - 1).all() and (a['n_infeasible'][:] == 1).all()\n"
        "assert (v['cable'][:] == 2 * np.arange(k)).all() and (v['group'][:] == np.arange(k) // 2).all()\n"
        "assert v['lower'].shape == (k,)\n"
        "assert (v['upper'][:] == np.arange(k) + 2).all()\n"
        "assert f.attrs['status'] == b'no_feasible'\n",
        p, k);
    python("r", temp_path("a.h5"), script);
    free(initial);
    free(variable);
    close_net(&net);
}
END_TEST

/* Only vectors of design variables have no unit in their names: each variable may have its own. */
START_TEST(provenance_and_units_are_there)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    write_result(temp_path("a.h5"), &net);
    python("r", temp_path("a.h5"),
           "a = f.attrs\n"
           "for name in ('version git_describe compiler build_flags hdf5_version gsl_version lapack host rng seed "
           "threads '\n"
           "             'started_utc finished_utc status warnings title').split(): assert name in a, name\n"
           "assert a['program'] == b'hifdm' and a['format_version'] == 3\n"
           "assert list(a['argv']) == ['hifdm', 'run', 'a b.yaml']\n"
           "assert f['case/text'].asstr()[()] == 'title: any\\n' and f['case'].attrs['sha256'] == b'abc'\n"
           "assert f['case/overrides'].asstr()[()] == 'form.pretension_N=12\\n'\n"
           "assert f['scene/cable/id'].asstr()[0] == 'n0_0-n1_0'\n"
           "n = []\n"
           "def look(name, thing):\n"
           "    if isinstance(thing, h5py.Dataset):\n"
           "        n.append(name)\n"
           "        assert not thing.id.get_create_plist().get_obj_track_times()\n"
           "        unit = thing.attrs['units']; thing.attrs['description']\n"
           "        suffix = {'m': '_m', 'N': '_N', 'N/m': '_N_per_m'}.get(unit, '')\n"
           "        vector = name.split('/')[-1] in ('design', 'initial', 'lower', 'upper')\n"
           "        assert name.endswith(suffix) or vector, (name, unit)\n"
           "f.visititems(look)\n"
           "assert len(n) > 20");
    close_net(&net);
}
END_TEST

/* Two runs of one case differ in attributes only. */
START_TEST(data_sets_depend_on_the_case_alone)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    write_result(temp_path("a.h5"), &net);
    write_result(temp_path("b.h5"), &net);
    for (int i = 0; i < 2; i++)
        python("a", temp_path(i ? "a.h5" : "b.h5"), "for name in list(f.attrs): del f.attrs[name]");
    const char *const argv[] = {"h5diff", temp_path("a.h5"), temp_path("b.h5"), NULL};
    struct command command = run_command(HANG_S, argv);
    ck_assert_msg(command.exit_code == 0, "%s%s", command.out, command.err);
    free_command(&command);
    close_net(&net);
}
END_TEST

/* Tables of load cases are part of the identity of a case with their contents. A table that is missing is left out. */
START_TEST(tables_of_load_cases_identify)
{
    static hf_case c;
    struct net net;
    char identity[4][65], *path = c.built.load_case[1].nodes_path;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    c.built.n_load_case = 2;
    for (int i = 0; i < 4; i++) { /* without a name, missing, and with two contents */
        if (i == 1) snprintf(path, sizeof c.built.load_case[1].nodes_path, "%s", temp_path("wind.csv"));
        if (i > 1) write_file(temp_path("wind.csv"), i == 2 ? "id,Fx_N\n" : "id,Fy_N\n");
        ck_assert_int_eq(hf_store_identify(&c, &net.scene, NULL, identity[i]), HF_OK);
    }
    ck_assert_str_eq(identity[0], identity[1]);
    ck_assert_str_ne(identity[1], identity[2]);
    ck_assert_str_ne(identity[2], identity[3]);
    close_net(&net);
}
END_TEST

/* A resumed run must find the shape of the result: a difference by rounding gives a warning, a larger one a refusal. */
START_TEST(another_shape_is_not_gone_on_with)
{
    static const struct {
        double factor;
        hf_status status;
        int n_warning;
    } table[] = {{1, HF_OK, 0}, {1 + 1e-12, HF_OK, 1}, {1.001, HF_EXISTS, 0}, {(double)NAN, HF_EXISTS, 0}};
    struct net net;
    hf_messages messages = {0};
    OPEN_CASE(&net, SMALL_REFLECTOR);
    find_shape(&net);
    hf_store *store = begin(temp_path("a.h5"), 1, &net.scene);
    ck_assert_int_eq(hf_store_form(store, &net.model, &net.work, NULL, &messages), HF_OK);
    ck_assert_int_eq(hf_store_publish(store, &(hf_summary){0}, 1, &messages), HF_OK);
    hf_store_end(store);
    net.work.tension_N[3] *= table[_i].factor;
    ck_assert_int_eq(hf_store_resume(temp_path("a.h5"), &store, &messages), HF_OK);
    ck_assert_int_eq(hf_store_form(store, &net.model, &net.work, NULL, &messages), table[_i].status);
    ck_assert_int_eq(messages.n_warning, table[_i].n_warning);
    hf_store_end(store);
    hf_messages_free(&messages);
    close_net(&net);
}
END_TEST

Suite *suite_unit_store(void)
{
    Suite *suite = suite_create("unit/store");
    TCase *tests = tcase_create("store");
    suite_add_tcase(suite, tests);
    tcase_add_checked_fixture(tests, quiet, NULL);
    tcase_add_loop_test(tests, summary_comes_back_bit_by_bit, 0, 5);
    tcase_add_loop_test(tests, surface_comes_back_bit_by_bit, 0, 10);
    tcase_add_loop_test(tests, scene_comes_back, 0, 2);
    tcase_add_test(tests, shapes_come_back_in_the_order_of_the_scene);
    tcase_add_test(tests, coupling_is_stored_beside_the_shape);
    tcase_add_test(tests, a_run_without_a_best_says_so);
    tcase_add_loop_test(tests, generations_are_appended, 0, N(sizes));
    tcase_add_loop_test(tests, another_shape_is_not_gone_on_with, 0, 4);
    tcase_add_test(tests, provenance_and_units_are_there);
    tcase_add_test(tests, data_sets_depend_on_the_case_alone);
    tcase_add_test(tests, tables_of_load_cases_identify);
    return suite;
}
