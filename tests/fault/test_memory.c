/* The tests make each allocation of each set-up function fail once. The function must return HF_NO_MEMORY with a
 * message and leak nothing (the run under the sanitizers checks that). Allocations inside libyaml cannot be made to
 * fail. */
#include "nets.h"

#include <hifdm/batch.h>
#include <hifdm/optimiser.h>
#include "net/symmetry.h"

/* What is under test, prepared before the failure and cleaned up after it, whether it succeeded or not. */
struct subject {
    const char *path;
    hf_case settings;
    hf_scene scene;
    hf_model model;
    hf_workspace work;
    hf_evaluator evaluator;
    hf_batch batch;
    hf_optimiser ga;
    hf_messages messages;
};

typedef hf_status action(struct subject *);

static hf_status load_case(struct subject *s)
{
    static const char *const set[] = {"form.pretension_N=12", "optimize.seed=7"};
    return hf_config_load(s->path, set, 2, &s->settings, &s->messages);
}

static hf_status make_scene(struct subject *s)
{
    return hf_config_scene(&s->settings, &s->scene, &s->messages);
}

static hf_status build_model(struct subject *s)
{
    return hf_model_build(&s->scene, &s->settings.form, &s->model, &s->messages);
}

static hf_status apply_symmetry(struct subject *s)
{
    int planes;
    return hf_symmetry_apply(&s->scene, &(hf_optimize_settings){.symmetry = HF_SYMMETRY_AUTO}, &s->model, &planes,
                             &s->messages);
}

static hf_status create_workspace(struct subject *s)
{
    return hf_workspace_create(&s->model, &s->work);
}

static hf_status create_batch(struct subject *s)
{
    s->evaluator = (hf_evaluator){.model = &s->model,
                                  .form = &s->settings.form,
                                  .start_q_N_per_m = s->model.start_q_N_per_m,
                                  .rule = HF_RULE_FORCE_DENSITY,
                                  .solver = HF_SOLVER_AUTO,
                                  .boundary_ratio_cap = 10};
    return hf_batch_create(&s->evaluator, 3, &s->batch);
}

static hf_status create_ga(struct subject *s)
{
    return hf_optimiser_create(&hf_optimiser_ga, &s->settings.optimize, &s->model, s->model.length_m,
                               &s->ga); /* any numbers above zero */
}

static const struct stage {
    const char *name;
    action *act;
    int has_message; /* 0: the function has no messages argument, so it reports by its status alone */
} stages[] = {{"hf_config_load", load_case, 1},
              {"hf_config_scene", make_scene, 1},
              {"hf_model_build", build_model, 1},
              {"hf_symmetry_apply", apply_symmetry, 1},
              {"hf_workspace_create", create_workspace, 0},
              {"hf_batch_create", create_batch, 0},
              {"hf_optimiser_create", create_ga, 0}};
enum { N_STAGE = sizeof stages / sizeof *stages };

/* More rows and ids than the first capacities of the import (64 rows), so that its growth fails, too. */
static const char *write_import_case(void)
{
    FILE *nodes = fopen(temp_path("nodes.csv"), "w"), *cables = fopen(temp_path("cables.csv"), "w");
    ck_assert(nodes && cables);
    fputs("id,x_m,y_m,z_m,role,Fz_N\n", nodes);
    fputs("id,i,j,group,law,value,EA_N\n", cables);
    for (int i = 0; i <= 150; i++) {
        fprintf(nodes, "node-%d,%d,0,0,%s,-1\n", i, i, i % 150 ? "inner" : "support");
        if (i < 150) fprintf(cables, "cable-%d,node-%d,node-%d,boundary,length,1.01,47000\n", i, i, i + 1);
    }
    fclose(nodes);
    fclose(cables);
    const char *path = temp_path("import.yaml");
    write_file(path, "scene:\n  import: {nodes: nodes.csv, cables: cables.csv}\n");
    return path;
}

static const char *write_cylinder_case(void)
{
    const char *path = temp_path("cylinder.yaml");
    write_file(path, "scene:\n  parabolic_cylinder: {aperture_m: 4, length_m: 5, focal_length_m: 5, modules: [2, 2],"
                     " cells_per_module: [2, 2], scallop: 0.1}\noptimize: {}\n");
    return path;
}

static void clean_up(struct subject *s)
{
    hf_optimiser_free(&s->ga);
    hf_batch_free(&s->batch);
    hf_workspace_free(&s->work);
    hf_model_free(&s->model);
    hf_scene_free(&s->scene);
    hf_case_free(&s->settings);
    hf_messages_free(&s->messages);
}

/* Runs one stage again and again, with its first, second, ... allocation failing; returns how many it makes. */
static long fail_each_in_turn(const struct stage *stage, const char *path)
{
    for (long n = 1;; n++) {
        struct subject s = {.path = path};
        for (const struct stage *before = stages; before < stage; before++)
            ck_assert_int_eq(before->act(&s), HF_OK);
        fail_allocation_at(n);
        hf_status status = stage->act(&s);
        bool failed = end_allocation_failure();
        char said[256];
        snprintf(said, sizeof said, "%s", s.messages.text ? s.messages.text : "");
        int n_error = s.messages.n_error;
        clean_up(&s);
        if (!failed) {
            ck_assert_msg(status == HF_OK, "%s: %s", stage->name, said);
            return n - 1;
        }
        ck_assert_msg(status == HF_NO_MEMORY, "%s, allocation %ld: %s", stage->name, n, hf_status_word(status));
        ck_assert_int_eq(n_error, stage->has_message);
        ck_assert_int_eq(strstr(said, "out of memory") != NULL, stage->has_message);
    }
}

START_TEST(set_up_of_a_generated_scene)
{
    ck_assert_int_ge(fail_each_in_turn(&stages[_i], write_cylinder_case()), 1);
}
END_TEST

START_TEST(set_up_of_an_imported_scene)
{
    ck_assert_int_ge(fail_each_in_turn(&stages[_i], write_import_case()), 1);
}
END_TEST

/* The messages about a faulty case need memory. Whichever allocation fails, the case is never accepted. */
START_TEST(faulty_cases_stay_faulty)
{
    static const char bad[] = "scene: {parabolic_cylinder: {aperture_m: x, nonsense: 1}}\nform: {stop: never}\n";
    write_file(temp_path("bad.yaml"), bad);
    for (long n = 1;; n++) {
        hf_case c;
        hf_messages messages = {0};
        fail_allocation_at(n);
        hf_status status = hf_config_load(temp_path("bad.yaml"), NULL, 0, &c, &messages);
        bool failed = end_allocation_failure();
        int n_error = messages.n_error;
        hf_case_free(&c);
        hf_messages_free(&messages);
        ck_assert(status == HF_BAD_CASE || (failed && status == HF_NO_MEMORY));
        ck_assert_int_ge(n_error, 1);
        if (status == HF_BAD_CASE) ck_assert_int_eq(n_error, 7); /* 3 values, 4 missing keys */
        if (!failed) break;
    }
}
END_TEST

Suite *suite_fault_memory(void)
{
    Suite *suite = suite_create("fault/memory");
    TCase *tests = tcase_create("memory");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, set_up_of_a_generated_scene, 0, N_STAGE);
    tcase_add_loop_test(tests, set_up_of_an_imported_scene, 0, N_STAGE);
    tcase_add_test(tests, faulty_cases_stay_faulty);
    return suite;
}
