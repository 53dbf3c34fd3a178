/* refine_problem - sets up the problem that Levenberg-Marquardt solves: the variables and their bounds, the shape of
 * the last design and its derivatives. refine.c takes the steps. */
#pragma once

#include "base/arena.h"
#include "linalg/quadratic.h"
#include "search/refine.h"
#include "search/residuals.h"
#include "search/saddle_step.h"
#include "search/watch.h"

/* The arrays of the problem: n variables, n_row residuals, n_variable design variables. n_dense is n, or 0 for steps by
 * the saddle-point system. */
#define HF_REFINE_FIELDS(X)                                                                                            \
    X(double, start, n_variable, "first values; those of tensions are pretensions q L*")                               \
    X(double, low, n, "lower bounds of the variables")                                                                 \
    X(double, high, n, "upper bounds of the variables")                                                                \
    X(double, down, n + 1, "[n] lower bounds of a step")                                                               \
    X(double, up, n + 1, "[n] upper bounds of a step")                                                                 \
    X(double, unit, n, "magnitude of the values; violations are relative to it")                                       \
    X(double, at, n, "best variables")                                                                                 \
    X(double, trial, n, "variables at the end of the last step")                                                       \
    X(double, design, n_variable, "design of the last evaluation; tensions as pretensions q L*")                       \
    X(double, best, n_variable, "best design in terms of `caller`")                                                    \
    X(double, step_taken, n, "the step that led to `trial` while it is corrected")                                     \
    X(double, pull, n, "gradient of a correction")                                                                     \
    X(double, scale, n, "maximum norm so far of each column of J")                                                     \
    X(double, row, n_dense *n_row, "[n][n_row] J'")                                                                    \
    X(double, gram, n_dense *n_dense, "[n][n] J'J; lower triangle by rows, like `hessian`")                            \
    X(double, hessian, n_dense ? (n + 1) * (n + 1) : 0, "[n][n] J'J with damping")                                     \
    X(double, sparse_x, n - n_dense, "the step of the saddle-point system")                                            \
    X(int, sparse_side, n - n_dense, "its active limits, as in hf_saddle_cable")                                       \
    X(double, gradient, n + 1, "[n] J'f")                                                                              \
    X(double, objective_rate, to->front ? n *(size_t)to->v.objectives->n_objective : 0,                                \
      "[n_objective][n] gradients of objectives without corners, for a point of a front")                              \
    X(double, constraint_rate, n *hf_refine_n_constraint(to), "[n_constraint][n] rates of the constraints")            \
    X(int, side, n + 1, "sides of the bounds that held the last step, while the remaining gain is predicted")          \
    X(double, state, to->front ? 0 : to->n_state, "the state of the run for hf_refine_watcher")

/* The tensions T and the force densities T/l of a shape describe the same shape. But the shape depends far more
 * linearly on the force densities, because a change of a single tension in a chain drags its nodes along. A design
 * variable that sets a tension therefore sets a force density here, and its bounds are limits on the tension. */
typedef struct {
    hf_evaluator v;             /* copy of `caller` with force densities and without limits */
    const hf_evaluator *caller; /* the evaluator of the caller */
    const double *lower, *upper;
    hf_workspace *w;
    hf_sensitivity slopes;
    hf_residuals residuals;
    hf_watch watch;
    hf_quadratic step;     /* for steps by the saddle-point system only x, side and n */
    bool is_sparse;        /* true: steps by `saddle`, without derivatives by each variable */
    hf_saddle_step saddle; /* used if is_sparse */
    bool needs_dense;      /* dense steps must continue: the cap is broken, or `saddle` leads no farther */
    /* The objectives, whose last one replaces a maximum of psi, and this maximum. NULL: none does. Its weight is found
     * by refinements: one below which psi exceeds the maximum and one above which it does not, and psi with each. A
     * weight of 0 is not known. The maximum is lower than the required one, so that psi is certain to keep it. */
    hf_objectives *relaxed;
    double psi_most_m, psi_weight, weight_low, psi_low_m, weight_high, psi_high_m;
    int n_weight;
    double zero;                      /* hf_refine_others below which nothing is left to gain */
    double psi_m, others;             /* psi and hf_refine_others of the design at `at` */
    double best_of_others;            /* hf_refine_others of the best design */
    double others_at_start;           /* that of the start, if it is feasible */
    const hf_watch_front *front;      /* the objective to minimise and the limits on the others, or NULL */
    const hf_refine_watcher *watcher; /* NULL: no watcher */
    hf_status told;                   /* the last status of the watcher */
    int first_row, n_row;             /* residuals to minimise */
    bool has_corners;                 /* true if the minimised objective has corners: a step then has its level, too */
    int n; /* number of variables: steps from `start` of each class of linked design variables */
    int evaluations;
    bool is_outside;       /* true while no shape within the limits is known */
    hf_form_result result; /* result of the last evaluation */
    HF_REFINE_FIELDS(HF_ARENA_MEMBER)
    double largest_scale;                /* maximum of `scale` */
    double pressure[HF_DESIGN_ROWS_MAX]; /* multipliers of the last step for merit^2/2, for a point of a front */
    double promise;                      /* gain that the linear model promised before the step was corrected */
    double damping, growth;              /* damping of the next step, and its factor if that step fails */
    double way, violation;               /* outside the limits: part of the way for the next step, and the violation */
    double best_psi_m;                   /* psi of the best design */
    double promised_before;              /* part of the merit that the last step promised; 0 if it failed */
    int settled_steps;                   /* steps since one promised much or changed the merit or an objective */
    double settled_merit, settled_objective[HF_DESIGN_ROWS_MAX]; /* merit and objectives at that step */
    size_t n_state;
    double noise; /* part of the merit that the tolerance of the form-finding leaves open */
    void *block;
} hf_refine_problem;

/* Returns the number of constraints by requirements. */
static inline size_t hf_refine_n_constraint(const hf_refine_problem *problem)
{
    const hf_objectives *objectives = problem->v.objectives;
    return objectives && objectives->constraints ? (size_t)objectives->constraints->n : 0;
}

/* Allocates the problem, in which the caller has set v, caller, lower, upper, w and front. Returns HF_OK or
 * HF_NO_MEMORY; call hf_refine_destroy in either case. */
hf_status hf_refine_create(hf_refine_problem *problem);
void hf_refine_destroy(hf_refine_problem *problem);

/* Begins at the design [n_variable] whose shape is in the workspace. */
void hf_refine_begin(hf_refine_problem *problem, const double *design);

/* Returns true if design variable k sets a tension for the caller, and therefore a force density here. */
bool hf_refine_is_tension(const hf_refine_problem *problem, int k);

/* Returns the merit of a result, or for a point of a front the value of the minimised objective (of a ratio its
 * logarithm). */
double hf_refine_merit(const hf_refine_problem *problem, const hf_form_result *result);

/* Returns the part of the merit that is rounding of positions. Only objectives that are lengths have one. */
double hf_refine_rounding(const hf_refine_problem *problem);

/* Evaluates the design at these steps [n] from `start`; its shape is in the workspace afterwards. Returns the status of
 * hf_evaluate. */
hf_status hf_refine_evaluate(hf_refine_problem *problem, const double *step);

/* Returns the merit of the first n objectives of a shape, which may be infeasible. */
double hf_refine_norm(const hf_objectives *objectives, int n, const hf_form_result *result);

/* Returns the merit without the objective that replaces a maximum of psi, or 0 if there is none. The result must have
 * been found with the present weight. */
double hf_refine_others(const hf_refine_problem *problem, const hf_form_result *result);

/* Returns true if an objective can replace a maximum of psi among the constraints. */
bool hf_refine_has_maximum(const hf_objectives *objectives);

/* Sets the weight of the objective that replaces a maximum of psi. Earlier results keep the merit of the old weight. */
void hf_refine_weigh(hf_refine_problem *problem, double weight);

/* Moves to `trial`, whose shape is in the workspace. It becomes the best design, unless a maximum of psi is replaced
 * and an earlier design within it is better by the other objectives, or nearer to it. */
void hf_refine_keep(hf_refine_problem *problem);

/* Computes the residuals, J', J'J, the gradient, and the limits with their rates at the shape in the workspace. Returns
 * HF_OK or the status of the failure. */
hf_status hf_refine_linearise(hf_refine_problem *problem);

/* Writes the state between two iterations into `state`. hf_refine_resume resumes from a state, after hf_refine_begin of
 * the same design, with the same bits. It returns false and changes nothing if the state belongs to another problem.
 * hf_refine_was_dense returns true if the state is that of a run without the saddle-point system. */
void hf_refine_pack(hf_refine_problem *problem, const hf_refine_result *result);
bool hf_refine_was_dense(size_t n_state, const double *state);
bool hf_refine_resume(hf_refine_problem *problem, size_t n_state, const double *state, hf_refine_result *result);
