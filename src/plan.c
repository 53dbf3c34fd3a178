#include "plan.h"

#include "print.h"
#include "run.h"
#include <hifdm/batch.h>

#include <stdlib.h>
#include <string.h>

#define TRIAL_S 1.0 /* how long a form-finding is tried */

typedef struct {
    hf_case settings;
    hf_scene scene;
    hf_model model;
    hf_workspace workspace;
} plan;

static void print_scene(const plan *p, FILE *f)
{
    const hf_model *m = &p->model;
    int count[3] = {0}, law[3] = {0};
    for (int i = 0; i < m->n_node; i++)
        count[p->scene.role[i]]++;
    for (int e = 0; e < m->n_cable; e++)
        law[m->law[e]]++;
    fprintf(f, "  scene         %d nodes: %d supports, %d inner (psi counts these), %d edge\n", m->n_node,
            count[HF_ROLE_SUPPORT], count[HF_ROLE_INNER], count[HF_ROLE_EDGE]);
    fprintf(f, "                %d cables by law in force: %d tension, %d length, %d force density%s\n", m->n_cable,
            law[HF_LAW_TENSION], law[HF_LAW_LENGTH], law[HF_LAW_FORCE_DENSITY], m->has_strut ? " (with struts)" : "");
    fprintf(f, "  equations     %d unknowns, three right-hand sides; half-bandwidth %d; %s\n", m->n_free,
            m->half_bandwidth, m->has_strut ? "indefinite: band LU (dgbtrf)" : "band Cholesky (dpbtrf)");
    if (m->n_chain) fprintf(f, "  note          %d straight chains of length-controlled cables\n", m->n_chain);
}

static void print_plan(const plan *p, FILE *f)
{
    const hf_case *c = &p->settings;
    const hf_optimize_settings *o = &c->optimize;
    const char *why;
    int method = hf_evaluate_method(&p->model, &c->form, &why);
    fprintf(f, "  will run      form-finding: %s, solved by %s (%s), stop: %s, at most %d iterations\n",
            hf_method_word[c->form.method], method == HF_METHOD_NEWTON ? "newton" : "fixed point", why,
            hf_stop_rule_word[c->form.stop], c->form.max_iterations);
    int optimizes = c->has_optimize && p->model.n_gene > 0;
    if (optimizes)
        fprintf(f,
                "                optimisation: rule %s, %d genes, %d individuals, at most %d generations, seed %llu\n",
                hf_rule_word[o->rule], p->model.n_gene, o->population, o->generations, (unsigned long long)o->seed);
    fprintf(f, "  skipped       %s%s%s\n",
            optimizes         ? ""
            : c->has_optimize ? "optimisation (no boundary cable has a free end); "
                              : "optimisation (no optimize section); ",
            p->model.load_N ? "" : "loads (none given); ", p->model.has_strut ? "" : "general band matrix (no struts)");
}

static void print_memory(const plan *p, int threads, FILE *f)
{
    char workspace[32], population[32], result[32];
    size_t n_individual = p->settings.has_optimize ? (size_t)p->settings.optimize.population : 0;
    hf_print_bytes((double)hf_workspace_bytes(&p->model) * (p->settings.has_optimize ? threads + 1 : 1), workspace,
                   sizeof workspace);
    hf_print_bytes((double)n_individual * 2 * ((double)p->model.n_gene * sizeof(double) + sizeof(hf_form_result)),
                   population, sizeof population);
    if (n_individual && p->model.n_gene) {
        hf_print_bytes((double)n_individual * (8.0 * p->model.n_gene + 70) * p->settings.optimize.generations, result,
                       sizeof result);
        fprintf(f, "  result file   at most %s of generations\n", result);
    }
    fprintf(f, "  memory        %s of workspaces (%d thread%s), %s of population\n", workspace, threads,
            threads == 1 ? "" : "s", population);
}

/* One evaluation of the base design, timed; its cost times the largest number of evaluations is the bound printed. */
static void print_optimize_time(plan *p, const hf_form_settings *form, int threads, FILE *f)
{
    const hf_model *m = &p->model;
    const hf_optimize_settings *o = &p->settings.optimize;
    double *start = malloc((size_t)m->n_cable * sizeof *start), *base = malloc((size_t)m->n_gene * sizeof *base);
    if (start && base) {
        hf_form_result r;
        hf_evaluator v = {m, form, start, o->rule, o->solver, o->boundary_ratio_cap};
        memcpy(start, p->workspace.q_N_per_m, (size_t)m->n_cable * sizeof *start);
        for (int k = 0; k < m->n_gene; k++)
            base[k] = p->workspace.tension_N[m->gene_cable[k]];
        double begin_s = hf_run_clock_s();
        hf_evaluate(&v, base, &p->workspace, &r);
        double evaluation_s = hf_run_clock_s() - begin_s, total = (double)o->population * o->generations;
        char one[32], all[32];
        hf_print_duration(evaluation_s, one, sizeof one);
        hf_print_duration(evaluation_s * total / threads, all, sizeof all);
        fprintf(f,
                "                optimisation: %s for the first design (%d iterations, %s); about %s for %.0f "
                "evaluations\n",
                one, r.iterations, hf_status_word(r.status), all, total);
    }
    free(start);
    free(base);
}

static hf_status print_time(plan *p, int threads, FILE *f, hf_messages *messages)
{
    hf_form_settings form = p->settings.form;
    hf_form_result r;
    char text[32];
    /* a few iterations give the time of one; as many as fit into TRIAL_S are then tried */
    form.max_iterations = form.max_iterations < 3 ? form.max_iterations : 3;
    double begin_s = hf_run_clock_s();
    hf_form_prepare(&p->model, &p->workspace);
    hf_form_find(&p->model, &form, form.stop, &p->workspace, NULL, &r);
    double iteration_s = (hf_run_clock_s() - begin_s) / r.iterations, affordable = TRIAL_S / iteration_s;
    form.max_iterations =
        affordable < p->settings.form.max_iterations ? (int)affordable + 1 : p->settings.form.max_iterations;
    begin_s = hf_run_clock_s();
    hf_form_prepare(&p->model, &p->workspace);
    hf_form_find(&p->model, &form, form.stop, &p->workspace, NULL, &r);
    double trial_s = hf_run_clock_s() - begin_s;
    if (r.status == HF_NOT_CONVERGED && form.max_iterations < p->settings.form.max_iterations) {
        hf_print_duration(iteration_s * p->settings.form.max_iterations, text, sizeof text);
        fprintf(f, "  expected time form-finding: not finished after %d iterations; at most %s\n", r.iterations, text);
        return HF_OK;
    }
    hf_print_duration(trial_s, text, sizeof text);
    fprintf(f, "  expected time form-finding: %s (%d iterations, stopped by %s)\n", text, r.iterations,
            hf_stop_reason_word((int)r.stop_reason));
    HF_TRY(hf_run_explain(&p->scene, &p->model, &p->settings.form, &p->workspace, &r, messages));
    if (p->settings.has_optimize && p->model.n_gene) print_optimize_time(p, &form, threads, f);
    return HF_OK;
}

static hf_status check(plan *p, const hf_options *options, FILE *f, hf_messages *messages)
{
    HF_TRY(hf_config_load(options->file, options->set, options->n_set, &p->settings, messages));
    HF_TRY(hf_config_scene(&p->settings, &p->scene, messages));
    HF_TRY(hf_model_build(&p->scene, &p->settings.form, &p->model, messages));
    int threads = options->threads ? options->threads : hf_batch_default_threads();
    fprintf(f, "%s: valid\n", options->file);
    print_scene(p, f);
    print_plan(p, f);
    print_memory(p, threads, f);
    if (hf_workspace_create(&p->model, &p->workspace) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for a net of %d nodes", p->model.n_node);
    return print_time(p, threads, f, messages);
}

hf_status hf_plan(const hf_options *options, FILE *file, hf_messages *messages)
{
    plan p = {0};
    hf_status status = check(&p, options, file, messages);
    hf_workspace_free(&p.workspace);
    hf_model_free(&p.model);
    hf_scene_free(&p.scene);
    hf_case_free(&p.settings);
    return status;
}
