/* polish_problem - what Levenberg-Marquardt works on: variables, their bounds, the shape of the last design and its
 * derivatives. polish.c is the way to the optimum. */
#ifndef HIFDM_POLISH_PROBLEM_H
#define HIFDM_POLISH_PROBLEM_H

#include "base/arena.h"
#include "linalg/quadratic.h"
#include "search/polish.h"
#include "search/residuals.h"
#include "search/watch.h"

/* Shapes of tensions T and of the force densities T/l are the same, but the shape is a far more even function of the
 * force densities: single tensions in a chain drag its nodes along. So genes that set a tension mean force densities
 * here, and their bounds are limits on the tensions. */
typedef struct {
    hf_evaluator v;             /* that of the caller, by force densities and without limits */
    const hf_evaluator *caller; /* that of the caller */
    const double *lower, *upper;
    hf_workspace *w;
    hf_sensitivity slopes;
    hf_residuals residuals;
    hf_watch watch;
    hf_quadratic step;
    const hf_watch_trade *trade;      /* or NULL: the merit is to be least */
    const hf_polish_watcher *watcher; /* or NULL */
    hf_status told;                   /* what it returned last */
    int first_row, n_row;             /* of the residuals that are to be least */
    bool has_corners;                 /* the goal to be least: then the level is one more variable of a step */
    int n;                            /* variables: steps from `start`, one for each class of linked genes */
    int evaluations;
    bool is_outside;                     /* no shape within the limits is known yet */
    hf_form_result result;               /* of the last evaluation */
    double *start;                       /* [n_gene] values; of tensions the pretensions q L* */
    double *low, *high;                  /* [n] bounds of the variables */
    double *down, *up;                   /* [n] of a step: how far it may go */
    double *unit;                        /* [n] size of the values: violations are relative to it */
    double *at, *trial;                  /* [n] the best variables; those of the last step */
    double *design;                      /* [n_gene] of the last evaluation, tensions as pretensions q L* */
    double *best;                        /* [n_gene] the best design in the caller's meaning */
    double *step_taken;                  /* [n] that led to `trial`, while it is corrected */
    double *pull;                        /* [n] gradient of a correction */
    double *scale;                       /* [n] largest norm of each column of J so far */
    double largest_scale;                /* of them */
    double *row;                         /* [n][rows of the residuals] J' */
    double *gram;                        /* [n][n] J'J; lower triangle by rows, as `hessian` */
    double *hessian;                     /* [n][n] J'J, damped */
    double *gradient;                    /* [n] J'f */
    double *goal_rate;                   /* [n_goal][n] of a trade: of goals without corners */
    double pressure[HF_DESIGN_ROWS_MAX]; /* of a trade: multipliers of the last step, in units of merit^2/2 */
    double promise;                      /* of a step before it was solved again: what the linear model says */
    double damping, growth;              /* of the next step, and by what the former grows if that is none */
    double way, violation; /* outside of the limits: the part of the way that the next step goes; how far outside */
    double best_psi_m;     /* of the best design */
    int settled_steps;     /* since the merit, or a goal, last changed by more than what is read of it */
    double settled_merit, settled_goal[HF_DESIGN_ROWS_MAX]; /* of then */
    size_t n_state;
    double *state; /* [n_state] where the run is, for hf_polish_watcher */
    double noise;  /* what the tolerance of the form-finding leaves open in the merit */
} hf_polish_problem;

/* v, caller, lower, upper, w, trade are set. HF_OK or HF_NO_MEMORY; destroy it in either case. */
hf_status hf_polish_create(hf_polish_problem *problem, hf_arena *arena);
void hf_polish_destroy(hf_polish_problem *problem, hf_arena *arena);

/* Start at the design [n_gene] whose shape is in the workspace. */
void hf_polish_begin(hf_polish_problem *problem, const double *design);

/* Does gene k set a tension for the caller, and a force density here? */
bool hf_polish_is_tension(const hf_polish_problem *problem, int k);

/* What is to be least. */
double hf_polish_merit(const hf_polish_problem *problem, const hf_form_result *result);

/* Find the shape of these variables [n] in the workspace. */
hf_status hf_polish_evaluate(hf_polish_problem *problem, const double *variable);

/* Take the shape in the workspace, that of `trial`, as the best. */
void hf_polish_keep(hf_polish_problem *problem);

/* Write residuals, J', J'J, the gradient and what is watched with its rates at the workspace's shape. */
hf_status hf_polish_linearise(hf_polish_problem *problem);

/* Write where the run is between two iterations into `state`: with it hf_polish_go_on, after hf_polish_begin of the
 * same design, makes a run go on with the same bits. A state of another problem is refused: false. */
void hf_polish_pack(hf_polish_problem *problem, const hf_polish_result *result);
bool hf_polish_go_on(hf_polish_problem *problem, size_t n_state, const double *state, hf_polish_result *result);

#endif
