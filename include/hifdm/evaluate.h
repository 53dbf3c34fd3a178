/* evaluate - one form-finding by the method that suits the net, with or without a truss.
 * Stability: stable.
 *
 * The function hf_evaluate_form finds the shape of the case itself. The function hf_evaluate finds the shape of a
 * design with one value for each design variable. The functions hf_evaluate_form and hf_evaluate write the shape to the
 * workspace. The result, a struct without pointers, contains the properties of the shape. Pipeline of hf_evaluate:
 *
 *   hf_evaluate_prepare   values of the design variables -> laws, target values, first force densities
 *   solver                Newton's method or the paper's iteration, coupled with the truss if there is one
 *   hf_evaluate_judge     constraints, violation and objectives -> status, merit */
#pragma once

#include <hifdm/api.h>
#include <hifdm/formfind.h>
#include <hifdm/objectives.h>

HF_API_BEGIN

/* Returns the method that the key form.method selects for this net. The method is HF_METHOD_NEWTON or, for the paper's
 * iteration, HF_METHOD_HIFDM. The methods `iterative_fdm` and `fdm` use the paper's iteration with other cable laws in
 * the model. The function sets *why to a constant string that contains the reason for the selection. The argument why
 * may be NULL. */
hf_method hf_evaluate_method(const hf_model *model, const hf_form_settings *form, const char **why);

/* Finds the shape of the case and certifies it (hf_certify). After the call, the workspace contains the shape. Unless
 * `history` is NULL, the function records the values of each iteration in `history`. Returns result->status. If
 * *workspace->stop was set, the status is HF_INTERRUPTED. The status can also be HF_OK, HF_NOT_CONVERGED or the status
 * of an ill-posed net. */
hf_status hf_evaluate_form(const hf_model *model, const hf_form_settings *form, hf_workspace *workspace,
                           hf_history *history, hf_form_result *result);

/* Finds a shape in the same way as hf_evaluate_form, but without a certificate. The caller must call hf_form_prepare
 * and then write laws, target values and first force densities to the workspace. The function also determines positions
 * for nodes that no taut cable holds (METHOD section 4). */
hf_status hf_evaluate_prepared(const hf_model *model, const hf_form_settings *form, hf_workspace *workspace,
                               hf_history *history, hf_form_result *result);

/* Contains the rows of optimize.limits, prepared for the model. */
typedef struct {
    int n;         /* number of rows; 0: there are no limits */
    hf_limit *row; /* [n] the rows */
    void *block;   /* owned memory behind the rows */
} hf_limits;

/* Contains the data that all designs of a run have in common. The threads of a run share the data in this struct. The
 * struct does not own the data behind its pointers. */
typedef struct {
    const hf_model *model;        /* the net */
    const hf_form_settings *form; /* tolerances and bounds of the form-finding */
    /* [n_cable] force densities of the initial design, from which cables with an iterating law start */
    const double *start_q_N_per_m;
    hf_rule rule;     /* meaning of the pretension of a boundary cable (optimize.rule) */
    hf_solver solver; /* solver of the designs (optimize.solver) */
    /* maximum boundary tension ratio; INFINITY: none; a design with a larger ratio gets HF_RATIO_CAP */
    double boundary_ratio_cap;
    /* limits of the designs; a shape that violates a limit gets HF_OUT_OF_LIMITS; NULL: no limits */
    const hf_limits *limits;
    const hf_objectives *objectives; /* objectives that form the merit of a shape; NULL: the merit is psi_m */
    const double *initial;           /* [n_variable] initial design; used by design variables with link: scale */
    int n_thread; /* number of threads that compute the derivatives of one design; 0: the calling thread alone */
    /* Levenberg-Marquardt: a design variable of a tension T sets the force density T/L* instead of the tension, unless
     * tensions are linked (links_tensions of the model). */
    bool by_density;
} hf_evaluator;

/* The keys optimize.rule and optimize.variables determine the quantity that a design variable sets. */
typedef enum {
    HF_SETS_START,   /* first force density value/divisor; the cable keeps the law of the case (rule seeded) */
    HF_SETS_TENSION, /* law tension with the target value T* = value */
    HF_SETS_DENSITY, /* law force_density with q = value/divisor */
    HF_SETS_LENGTH,  /* law length with the target value L* = value */
    HF_SETS_CUT,     /* unstressed length of a cable of law elastic */
    HF_SETS_SUPPORT  /* displacement of a support along its direction */
} hf_variable_sets;
/* Returns the quantity that design variable i_variable sets. */
hf_variable_sets hf_evaluate_sets(const hf_evaluator *evaluator, int i_variable);

/* Returns true if the shape of a design does not depend on the starting point of its solver. The shape depends on the
 * starting point only if the rule is `seeded` and the case has no optimize.variables. */
bool hf_evaluate_is_unique(const hf_evaluator *evaluator);

/* Returns the divisor that converts the value of design variable i_variable to a force density. For a tension, the
 * divisor is the length L* in m. For a force density, the divisor is 1. The design variable must belong to a cable. */
double hf_evaluate_divisor(const hf_evaluator *evaluator, int i_variable);

/* Finds the shape of one design and writes the shape to the workspace. The array design [model->n_variable] contains
 * the values of the design variables. Design variables of cables must have values above 0. Returns result->status. If
 * the status is not HF_OK, the design is infeasible. The members psi_m and merit of an infeasible design are NaN. If
 * the design has no shape (hf_status_has_shape), the tension ratios and the violation are NaN. If no taut cable holds a
 * node of the design, the status is HF_SINGULAR. If an objective of a design has no value, the status is HF_NOT_FINITE.
 * `point` is the memory of this thread for the objectives (hf_objectives_point_create). If there are no objectives,
 * hf_evaluate ignores `point`. */
hf_status hf_evaluate(const hf_evaluator *evaluator, const double *design, hf_workspace *workspace,
                      hf_objectives_point *point, hf_form_result *result);

/* Writes laws, target values and first force densities of the design [n_variable] to the workspace. The function
 * performs the steps of hf_evaluate that precede the solver. */
void hf_evaluate_prepare(const hf_evaluator *evaluator, const double *design, hf_workspace *workspace);
/* Returns true if hf_evaluate_judge will read the shape in the workspace. The function hf_evaluate_judge reads the
 * shape to check limits, to measure objectives, or because the boundary tension ratio exceeds its maximum. */
bool hf_evaluate_needs_shape(const hf_evaluator *evaluator, const hf_form_result *result);
/* Applies the constraints to a shape and measures its objectives. The function performs the steps of hf_evaluate that
 * follow the solver. Sets violation, merit and status of the result. Sets quantities without a value to NaN as
 * described at hf_evaluate. Returns result->status. */
hf_status hf_evaluate_judge(const hf_evaluator *evaluator, const hf_workspace *workspace, hf_objectives_point *point,
                            hf_form_result *result);

/* Returns the length L* in m by which the pretension of a boundary cable is divided. For a cable of law length, the
 * length L* is the prescribed length of the cable. For all other cables, the length L* is the distance between the
 * target positions of the cable ends. */
double hf_evaluate_design_length_m(const hf_model *model, int i_cable);

HF_API_END
