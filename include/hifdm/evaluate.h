/* evaluate - one form-finding with the method that suits the net, with or without a truss, which gives one plain
 * result. hf_evaluate_form evaluates the case itself, hf_evaluate a design, which is a boundary pretension for each
 * gene. Stability: stable. */
#ifndef HIFDM_EVALUATE_H
#define HIFDM_EVALUATE_H

#include <hifdm/api.h>
#include <hifdm/formfind.h>
#include <hifdm/goals.h>

HF_API_BEGIN

/* The method that form.method selects for this net: HF_METHOD_NEWTON, or HF_METHOD_HIFDM for the paper's iteration. The
 * methods iterative_fdm and fdm use this iteration, too; they differ in the laws of the model. *why is set to the
 * reason in words; why may be NULL. */
hf_method hf_evaluate_method(const hf_model *model, const hf_form_settings *form, const char **why);

/* Form-finding as the case asks for it, with its certificate. history may be NULL; otherwise iterations are recorded
 * there. Returns result->status: HF_OK, HF_NOT_CONVERGED or a status of an ill-posed net. The shape is left in the
 * workspace. */
hf_status hf_evaluate_form(const hf_model *model, const hf_form_settings *form, hf_workspace *workspace,
                           hf_history *history, hf_form_result *result);

/* The same for laws, targets and first force densities that the caller has put into the workspace after
 * hf_form_prepare, without a certificate. Loose nodes are placed. */
hf_status hf_evaluate_prepared(const hf_model *model, const hf_form_settings *form, hf_workspace *workspace,
                               hf_history *history, hf_form_result *result);

/* A row of optimize.limits: what it keeps between bounds. */
typedef struct {
    hf_limit_kind kind;
    double lower, upper;
    int n_cable;
    int *cable; /* [n_cable] of tension and ratio */
} hf_limit;

typedef struct {
    int n;
    hf_limit *row; /* [n] */
    void *block;
} hf_limits;

/* What is constant during a run and shared by all threads. model, form and start_q_N_per_m are borrowed. */
typedef struct {
    const hf_model *model;
    const hf_form_settings *form;
    const double *start_q_N_per_m; /* [n_cable] force densities of the found shape, from which the inner cables start */
    hf_rule rule;
    hf_solver solver;
    double boundary_ratio_cap; /* a larger boundary tension ratio gives HF_RATIO_CAP; INFINITY: no cap */
    const hf_limits *limits;   /* a shape that breaks one of them gives HF_OUT_OF_LIMITS; NULL: none */
    const hf_goals *goals;     /* the merit of a shape; NULL: psi */
    int n_thread;              /* that find the derivatives of one design; 0: the calling one alone */
    bool by_density; /* genes that set a tension T set the force density T/L* instead, as Levenberg-Marquardt wants */
} hf_evaluator;

/* What gene k sets, and in which way, by optimize.rule and optimize.variables. */
typedef enum {
    HF_SETS_START,   /* q = value/divisor, from which the case's own law starts (rule seeded) */
    HF_SETS_TENSION, /* law tension */
    HF_SETS_DENSITY, /* law force_density, q = value/divisor */
    HF_SETS_LENGTH,  /* law length */
    HF_SETS_CUT,     /* law elastic: its unstressed length */
    HF_SETS_SUPPORT  /* the place of a support */
} hf_gene_sets;
hf_gene_sets hf_evaluate_sets(const hf_evaluator *evaluator, int i_gene);

/* Does a design have one answer, wherever its solve starts? Not under rule seeded. */
bool hf_evaluate_is_unique(const hf_evaluator *evaluator);

/* By what the value of a gene is divided for its force density: L* (m) of pretensions, 1 of force densities. */
double hf_evaluate_divisor(const hf_evaluator *evaluator, int i_gene);

/* Make a workspace ready for designs of an evaluator with goals. HF_OK or HF_NO_MEMORY; hf_workspace_free frees it. */
hf_status hf_evaluate_attend(const hf_evaluator *evaluator, hf_workspace *workspace);

/* Evaluate design_N [model->n_gene], the values of the genes: those of cables > 0. The shape is left in the workspace.
 * A design that fails has its status in the result and NaN for psi and ratios (one that breaks the cap keeps its
 * ratios); the run itself does not fail. Returns result->status. */
hf_status hf_evaluate(const hf_evaluator *evaluator, const double *design_N, hf_workspace *workspace,
                      hf_form_result *result);

/* The parts of hf_evaluate before and after the solver. hf_evaluate_prepare writes laws, targets and first force
 * densities of a design into the workspace. hf_evaluate_judge applies the cap on the ratio, sets the
 * violation, and the measures of an infeasible design to NaN, and returns the status; of a design above the cap it
 * reads the tensions in the workspace. */
void hf_evaluate_prepare(const hf_evaluator *evaluator, const double *design_N, hf_workspace *workspace);
bool hf_evaluate_needs_shape(const hf_evaluator *evaluator, const hf_form_result *result);
hf_status hf_evaluate_judge(const hf_evaluator *evaluator, hf_workspace *workspace, hf_form_result *result);

/* L* (m) of a boundary cable: the prescribed length where there is one, else the theoretical length. */
double hf_evaluate_design_length_m(const hf_model *model, int i_cable);

HF_API_END
#endif
