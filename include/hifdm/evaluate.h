/* evaluate - one form-finding by the method that suits the net, with or without a truss.
 * Stability: stable.
 *
 * hf_evaluate_form finds the shape of the case itself. hf_evaluate finds the shape of a design, which is one value for
 * each design variable. Both leave the shape in the workspace and its figures in a plain result. Pipeline of
 * hf_evaluate:
 *
 *   hf_evaluate_prepare   values of the design variables -> laws, target values, first force densities
 *   solver                Newton's method or the paper's iteration, coupled with the truss if there is one
 *   hf_evaluate_judge     constraints, violation and objectives -> status, merit */
#ifndef HIFDM_EVALUATE_H
#define HIFDM_EVALUATE_H

#include <hifdm/api.h>
#include <hifdm/formfind.h>
#include <hifdm/objectives.h>

HF_API_BEGIN

/* Returns the method that form.method selects for this net: HF_METHOD_NEWTON, or HF_METHOD_HIFDM for the paper's
 * iteration. The methods iterative_fdm and fdm use the same iteration; they differ in the laws of the model. *why is
 * set to the reason in words, a constant string; why may be NULL. */
hf_method hf_evaluate_method(const hf_model *model, const hf_form_settings *form, const char **why);

/* Finds the shape of the case and certifies it (hf_certify). The shape is left in the workspace. The figures of each
 * iteration are recorded in `history` unless it is NULL. Returns result->status: HF_OK, HF_NOT_CONVERGED,
 * HF_INTERRUPTED (*workspace->stop was set) or the status of an ill-posed net. */
hf_status hf_evaluate_form(const hf_model *model, const hf_form_settings *form, hf_workspace *workspace,
                           hf_history *history, hf_form_result *result);

/* Finds a shape as hf_evaluate_form does, but without a certificate. The caller has put laws, target values and first
 * force densities into the workspace after hf_form_prepare. Nodes that no taut cable holds are placed (METHOD section
 * 4). */
hf_status hf_evaluate_prepared(const hf_model *model, const hf_form_settings *form, hf_workspace *workspace,
                               hf_history *history, hf_form_result *result);

/* One row of optimize.limits: a quantity of the shape and its bounds. */
typedef struct {
    hf_limit_kind kind;  /* which quantity is bounded */
    double lower, upper; /* bounds in the unit of the quantity; infinite where a side is open */
    int n_cable;         /* number of cables of the row; 0 for displacements of attachments */
    int *cable;          /* [n_cable] cables whose tensions or tension ratio are bounded */
} hf_limit;

/* The rows of optimize.limits, made ready for the model. */
typedef struct {
    int n;         /* number of rows; 0: there are no limits */
    hf_limit *row; /* [n] the rows */
    void *block;   /* owned memory behind the rows */
} hf_limits;

/* The data that all designs of a run have in common; threads share them. The pointers are borrowed. */
typedef struct {
    const hf_model *model;        /* the net */
    const hf_form_settings *form; /* tolerances and bounds of the form-finding */
    /* [n_cable] force densities of the initial design; cables whose law iterates start from them */
    const double *start_q_N_per_m;
    hf_rule rule;     /* meaning of the pretension of a boundary cable (optimize.rule) */
    hf_solver solver; /* solver of the designs (optimize.solver) */
    /* maximum boundary tension ratio; a larger one gives HF_RATIO_CAP; INFINITY: no maximum */
    double boundary_ratio_cap;
    const hf_limits *limits;         /* a shape beyond one of them gives HF_OUT_OF_LIMITS; NULL: there are none */
    const hf_objectives *objectives; /* objectives that make up the merit of a shape; NULL: the merit is psi_m */
    int n_thread; /* number of threads for the derivatives of one design; 0: the calling thread alone */
    /* Levenberg-Marquardt: a design variable that sets a tension T sets the force density T/L* instead. */
    bool by_density;
} hf_evaluator;

/* What a design variable sets, according to optimize.rule and optimize.variables. */
typedef enum {
    HF_SETS_START,   /* first force density value/divisor; the law of the case is kept (rule seeded) */
    HF_SETS_TENSION, /* law tension with the target value T* = value */
    HF_SETS_DENSITY, /* law force_density with q = value/divisor */
    HF_SETS_LENGTH,  /* law length with the target value L* = value */
    HF_SETS_CUT,     /* unstressed length of a cable of law elastic */
    HF_SETS_SUPPORT  /* displacement of a support along its direction */
} hf_variable_sets;
/* Returns what design variable i_variable sets. */
hf_variable_sets hf_evaluate_sets(const hf_evaluator *evaluator, int i_variable);

/* Returns true if the shape of a design does not depend on the start of its solver. It depends on the start only under
 * rule seeded without optimize.variables. */
bool hf_evaluate_is_unique(const hf_evaluator *evaluator);

/* Returns the number by which the value of design variable i_variable is divided to get a force density: L* in m for
 * tensions, 1 for force densities. The variable must be one of a cable. */
double hf_evaluate_divisor(const hf_evaluator *evaluator, int i_variable);

/* Allocates in the workspace what the objectives of the evaluator need. Call it once before designs are evaluated
 * there; it does nothing without objectives or when it was called before. hf_workspace_free frees the memory. Returns
 * HF_OK or HF_NO_MEMORY. */
hf_status hf_evaluate_attend(const hf_evaluator *evaluator, hf_workspace *workspace);

/* Finds the shape of the design [model->n_variable], the values of the design variables, and leaves it in the
 * workspace. Values of cables are above 0. Returns result->status. If it is not HF_OK, the design is infeasible, and
 * psi_m and merit are NaN. Without a shape (hf_status_has_shape) the tension ratios and the violation are NaN, too. A
 * design with a node that no taut cable holds is HF_SINGULAR. A design for which an objective has no value is
 * HF_NOT_FINITE. */
hf_status hf_evaluate(const hf_evaluator *evaluator, const double *design, hf_workspace *workspace,
                      hf_form_result *result);

/* Writes laws, target values and first force densities of the design [n_variable] into the workspace: the part of
 * hf_evaluate before the solver. */
void hf_evaluate_prepare(const hf_evaluator *evaluator, const double *design, hf_workspace *workspace);
/* Returns true if hf_evaluate_judge will read the shape in the workspace: for limits, for objectives, or because the
 * boundary tension ratio exceeds its maximum. */
bool hf_evaluate_needs_shape(const hf_evaluator *evaluator, const hf_form_result *result);
/* Applies the constraints to a shape and measures its objectives: the part of hf_evaluate after the solver. Sets
 * violation, merit and status of the result, and NaN where hf_evaluate describes it. Returns result->status. */
hf_status hf_evaluate_judge(const hf_evaluator *evaluator, hf_workspace *workspace, hf_form_result *result);

/* Returns the length L* in m by which the pretension of a boundary cable is divided: the prescribed length of a cable
 * of law length, otherwise the length between the target positions of its ends. */
double hf_evaluate_design_length_m(const hf_model *model, int i_cable);

HF_API_END
#endif
