/* Determines whether Levenberg-Marquardt applies to an evaluator, and what it costs. refine.h describes the
 * interface. */
#include "search/refine.h"

#include <math.h>

/* The numbers of steps were counted on the cases of configs and METHOD. UNNOTICED is the number of operations in about
 * 0.1 s. */
#define STEPS_EXPECTED 8
#define STEP_EVALUATIONS 2
#define NEWTON_STEPS 5
#define CHORD_STEPS 4
#define UNNOTICED 2e8

bool hf_refine_applies(const hf_evaluator *v)
{
    for (int k = 0; k < v->model->n_variable; k++)
        if (hf_evaluate_sets(v, k) == HF_SETS_START) return false;
    for (int k = 0; v->objectives && k < v->objectives->n_objective; k++)
        if (!hf_objectives_is_smooth(&v->objectives->objective[k].settings)) return false;
    return v->model->has_newton && v->model->n_variable > 0;
}

/* Returns the operations of one step. *evaluation_of_ga receives those of one evaluation of the genetic algorithm. */
static double count_step(const hf_evaluator *v, double *evaluation_of_ga)
{
    const hf_model *m = v->model;
    double n_dof = 3.0 * m->n_free, width = 3.0 * m->half_bandwidth + 3, n = m->n_leader;
    double factor = n_dof * width * width, solve = 4 * n_dof * width, newton = NEWTON_STEPS * (factor + solve);
    double evaluation = v->solver == HF_SOLVER_CHORD ? CHORD_STEPS * solve : newton;
    double n_row = v->objectives && v->objectives->nets ? v->objectives->n_row : 3.0 * m->n_inner_node;
    double step = STEP_EVALUATIONS * newton + factor + n * solve + n * n * (n_row + 2 * n);
    for (int i = 0;
         v->objectives && v->objectives->nets && i < v->objectives->nets->n_load_case + v->objectives->nets->n_sample;
         i++) {
        if (!hf_objectives_are_over(v->objectives, i)) continue;
        evaluation += newton;
        step += STEP_EVALUATIONS * newton + newton + factor + n * solve;
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
