/* Decides whether designs can be refined, and by which steps, and counts their operations. refine.h describes the
 * interface. */
#include "search/refine.h"

#include "search/chord.h"
#include "search/refine_problem.h"

#include <limits.h>
#include <math.h>

/* The numbers of steps were counted on the cases of configs and METHOD. UNNOTICED is the number of operations in about
 * 0.1 s. */
#define STEPS_EXPECTED 8
#define STEP_EVALUATIONS 2
#define NEWTON_STEPS 5
#define CHORD_STEPS 4
#define SADDLE_FACTORS 5 /* with their solves */
#define UNNOTICED 2e8
/* The dense algebra of a step may take this many times the operations of a factorisation of the saddle-point system. */
#define DENSE_UP_TO 20
#define MODEL_GENERATIONS 3 /* generations whose time a model for repairs may take */
#define MODEL_MAX 1e7       /* derivatives of positions that a search may keep: 80 MB */

bool hf_refine_applies(const hf_evaluator *v)
{
    for (int k = 0; k < v->model->n_variable; k++)
        if (hf_evaluate_sets(v, k) == HF_SETS_START) return false;
    for (int k = 0; v->objectives && k < v->objectives->n_objective; k++)
        if (!hf_objectives_is_smooth(&v->objectives->objective[k])) return false;
    return v->model->has_newton && v->model->n_variable > 0;
}

/* Returns the operations of the derivatives of a shape: a factorisation, and a solve per variable. *newton receives
 * those of a form-finding by Newton's method, and *evaluation those of one evaluation of the genetic algorithm. */
static double count_model(const hf_evaluator *v, double *newton, double *evaluation)
{
    const hf_model *m = v->model;
    double n_dof = 3.0 * m->n_free, width = 3.0 * m->half_bandwidth + 3;
    double factor = n_dof * width * width, solve = 4 * n_dof * width;
    *newton = NEWTON_STEPS * (factor + solve);
    *evaluation = v->solver == HF_SOLVER_CHORD ? CHORD_STEPS * solve : *newton;
    return factor + m->n_leader * solve;
}

/* Returns the operations of the dense algebra of one step, apart from the derivatives. */
static double count_dense(const hf_evaluator *v)
{
    double n = v->model->n_leader, n_row = 3.0 * v->model->n_inner_node;
    return n * n * ((v->objectives && v->objectives->nets ? v->objectives->n_row : n_row) + 2 * n);
}

/* Returns the operations of one factorisation of the saddle-point system as a band. Nested dissection needs fewer. */
static double count_saddle(const hf_evaluator *v)
{
    double width = 6.0 * v->model->half_bandwidth + 6;
    return 6.0 * v->model->n_free * width * width;
}

bool hf_refine_has_maximum(const hf_objectives *g)
{
    return g && g->constraints && g->constraints->psi_most_m > 0 && g->n_objective < HF_DESIGN_ROWS_MAX;
}

bool hf_refine_is_sparse(const hf_evaluator *v)
{
    const hf_constraints *c = v->objectives ? v->objectives->constraints : NULL;
    bool has_others = false; /* constraints that are not in the model of the saddle-point system */
    for (int k = 0; c && k < c->n; k++)
        if (k != c->psi || !hf_refine_has_maximum(v->objectives))
            has_others |= !c->limit || !c->limit[k] || c->limit[k]->kind != HF_LIMIT_TENSION;
    return hf_saddle_step_applies(v) && !has_others && count_dense(v) > DENSE_UP_TO * count_saddle(v);
}

/* Returns the operations of one step. *evaluation_of_ga receives those of one evaluation of the genetic algorithm. */
static double count_step(const hf_evaluator *v, double *evaluation_of_ga)
{
    double newton, evaluation, model = count_model(v, &newton, &evaluation);
    double algebra = hf_refine_is_sparse(v) ? SADDLE_FACTORS * count_saddle(v) : model + count_dense(v);
    double step = STEP_EVALUATIONS * newton + algebra;
    for (int i = 0; v->objectives && v->objectives->nets && i < hf_objectives_nets_count(v->objectives->nets); i++) {
        if (!hf_objectives_are_over(v->objectives, i)) continue;
        evaluation += newton;
        step += STEP_EVALUATIONS * newton + newton + model;
    }
    *evaluation_of_ga = evaluation;
    return step;
}

double hf_refine_operations(const hf_evaluator *v)
{
    double evaluation;
    return count_step(v, &evaluation);
}

bool hf_refine_is_cheap(const hf_evaluator *v, long n_evaluation)
{
    double evaluation, step = count_step(v, &evaluation);
    return STEPS_EXPECTED * step <= fmax(UNNOTICED, (double)n_evaluation * evaluation / 10);
}

bool hf_refine_model_is_cheap(const hf_evaluator *v, int population)
{
    hf_evaluator of_search = *v;
    if (v->solver == HF_SOLVER_AUTO && hf_chord_applies(v)) of_search.solver = HF_SOLVER_CHORD;
    double newton, evaluation, model = count_model(&of_search, &newton, &evaluation);
    return model <= MODEL_GENERATIONS * evaluation * population &&
           3.0 * v->model->n_free * v->model->n_leader <= MODEL_MAX;
}

int hf_refine_generations(const hf_evaluator *v, int population)
{
    double evaluation, step = count_step(v, &evaluation);
    return (int)fmin(fmax(STEPS_EXPECTED * step / (evaluation * population), 1), INT_MAX);
}
