/* problem - an opened case: the net with its truss, its shape, and a batch that evaluates designs.
 * Stability: stable.
 *
 * In addition to the batch, a program with its own optimiser needs only hf_problem_open and hf_problem_free (see
 * tools/own_optimiser.c). The commands `hifdm run`, `check` and `evaluate` fill the struct hf_problem step by step
 * (src/run/problem_parts.h). Pipeline:
 *
 *   case file -> hf_case -> scene, truss -> model -> form-finding -> initial design, evaluator -> batch */
#pragma once

#include <hifdm/api.h>
#include <hifdm/batch.h>
#include <hifdm/config.h>
#include <hifdm/facets.h>
#include <hifdm/scene_arrays.h>

HF_API_BEGIN

/* An opened case. A problem must be neither moved nor copied because its members point to each other. Only one thread
 * at a time may use a problem. */
typedef struct {
    hf_case settings;            /* the case */
    hf_scene scene;              /* net as the case describes it */
    hf_carrier carrier;          /* truss; all zero without a truss */
    hf_model model;              /* net prepared for solving */
    hf_load_cases load_cases;    /* load cases of the as-built net; empty without `load_cases` */
    hf_surface_settings surface; /* target surface including its kind; all zero without a section surface */
    hf_facets facets;            /* facets of the target surface; empty without a section surface */
    int planes;                  /* mirror planes that link design variables: flags 1 (x) and 2 (y) */
    hf_workspace workspace;    /* workspace with the shape of the form-finding, until another shape is computed in it */
    hf_objectives_point point; /* memory for the objectives of designs that are evaluated in this workspace */
    hf_form_result form;       /* result of the form-finding */
    double *start_q_N_per_m;   /* [n_cable] force densities of the form-finding */
    double *initial;           /* [n_variable] initial design, averaged over linked design variables */
    hf_limits limits;          /* rows of optimize.limits; empty without rows */
    struct hf_problem_nets *nets; /* as-built nets of objectives over load cases or samples; NULL: there are none */
    /* rows of optimize.objective or optimize.front; empty without rows: psi is the objective */
    hf_objectives objectives;
    hf_evaluator evaluator; /* data that all designs have in common */
    hf_batch batch;         /* batch that evaluates designs; borrows the evaluator */
    hf_solver solver;       /* solver that the batch uses */
} hf_problem;

/* Describes a case whose net is in the memory of a program. The struct does not own the data behind its members. */
typedef struct {
    /* text of a case file with a section scene.import; the files that this section lists are not read */
    const char *text;
    const hf_scene_arrays *net; /* net in memory */
} hf_problem_source;

/* Opens the case file `path` with n_set overrides of the form "key=value". If there are no overrides, `set` is NULL and
 * n_set is 0. The function builds the model with truss and symmetry, finds the shape, and creates a batch of n_thread
 * threads. If n_thread is 0, the batch uses all cores. The threads share data that hf_batch_share prepares at the
 * design `initial`. The function ignores a `sweep` section of the case. If the case has no design variables,
 * model.n_variable is 0.
 *
 * Returns HF_OK. If the case has faults, the function returns HF_BAD_CASE with messages about all faults. If the
 * form-finding fails, the function returns HF_NOT_CONVERGED or the status of an ill-posed net. The error messages
 * contain the cables or nodes at fault. The function can also return HF_MECHANISM, HF_NO_MEMORY and HF_NO_LAPACK. If
 * the function fails, it adds an error message. If the form-finding fails, there is no batch. After a failed
 * form-finding, the members `form` and `workspace` contain the last state of the form-finding. Call hf_problem_free
 * even if hf_problem_open fails. */
hf_status hf_problem_open(const char *path, const char *const *set, int n_set, int n_thread, hf_problem *problem,
                          hf_messages *messages);

/* Returns true if designs have a merit. If the case has optimize.front, the designs have no merit. */
bool hf_problem_has_merit(const hf_problem *problem);

/* Writes pointers to the descriptions of the quantities of a design to `field`. Returns the number of figures. If the
 * designs have a merit, the function returns HF_RESULT_N_INDIVIDUAL. */
int hf_problem_list_figures(const hf_problem *problem, const hf_result_field *field[HF_RESULT_N_INDIVIDUAL]);

/* Returns the number of quantities that have derivatives with respect to the design variables. Each objective has
 * derivatives. If the case has no optimize.front, the merit also has derivatives. If the case has no objectives, only
 * psi_m has derivatives. */
int hf_problem_n_slope(const hf_problem *problem);
/* Writes the name of quantity i_slope with derivatives to `text`. The name is the name of the objective, "merit" or
 * "psi_m". Returns the argument `text`. */
const char *hf_problem_slope_name(const hf_problem *problem, int i_slope, char text[HF_OBJECTIVE_NAME_SIZE]);

/* Computes the exact derivatives of the quantities that hf_problem_n_slope counts (METHOD section 7). The array design
 * [n][n_variable] contains n designs, and the array result [n] contains their results from hf_batch_run. The array
 * slope [feasible designs][n_slope][n_variable] receives the derivatives with respect to each single design variable.
 * The unit of a derivative is the unit of the quantity divided by the unit of the design variable. The derivatives do
 * not include the weights of the objectives. If an objective is the maximum of several quantities, the function
 * computes the derivatives of its smooth maximum. If a quantity is 0, its derivatives are NaN. The function overwrites
 * problem->workspace. Returns HF_OK or HF_NO_MEMORY. If the designs have no derivatives (hf_problem_has_slopes), the
 * function returns HF_BAD_CASE with a message. */
hf_status hf_problem_slopes(hf_problem *problem, int n, const double *design, const hf_form_result *result,
                            double *slope, hf_messages *messages);
/* Returns HF_OK if the designs of this problem have derivatives. If the designs have no derivatives, the function
 * returns HF_BAD_CASE with a message. Nets with struts, designs under the rule `seeded`, and quantiles have no
 * derivatives. */
hf_status hf_problem_has_slopes(const hf_problem *problem, hf_messages *messages);

/* ---- Residuals ----
 *
 * The residuals of a design form blocks of rows. Each objective has a block of weighted residuals with the name of the
 * objective (hf_objectives_name). The merit is the norm of all these residuals. Without objectives, the only block of
 * this kind is "psi_m", whose norm is psi. The last two blocks contain the shape:
 *
 *   position_m [n_node][3]   positions of all nodes in the order of the scene, m
 *   tension_N [n_cable]      tensions of all cables, N
 *
 * The argument `blocks` selects blocks: bit i selects block i. The rows of the selected blocks follow each other in the
 * order of the blocks. */

/* Returns the number of rows of block i_block and writes the name of the block to `name`. Returns -1 if there is no
 * such block. */
int hf_problem_block(const hf_problem *problem, int i_block, char name[HF_OBJECTIVE_NAME_SIZE]);
/* Returns the bits of the blocks whose residuals have the merit as their norm: all blocks except the last two. */
unsigned hf_problem_objective_blocks(const hf_problem *problem);

/* Computes the residuals of one design and their exact derivatives (METHOD section 7). The array design [n_variable]
 * contains the values of the design variables. Design variables of cables must have values above 0. The array residual
 * [n_row] receives the residuals of the selected blocks. The array jacobian [n_row][n_variable] receives their
 * derivatives with respect to each single design variable. If `jacobian` is NULL, the function computes no derivatives.
 * A design that violates only limits has residuals. The function overwrites problem->workspace. Returns HF_OK. If the
 * design has no shape, returns the status of hf_evaluate. If an objective has no value, returns HF_NOT_FINITE. If the
 * designs have no derivatives (hf_problem_has_slopes), returns HF_BAD_CASE. Can also return HF_NO_MEMORY. If the
 * function fails, it adds an error message. */
hf_status hf_problem_residuals(hf_problem *problem, const double *design, unsigned blocks, double *residual,
                               double *jacobian, hf_messages *messages);

/* Computes product [n_variable], the product of the transposed Jacobian of the selected blocks and vector [n_row]. All
 * other rules of hf_problem_residuals apply. The function stores one column of the Jacobian of the shape at a time. It
 * needs the same number of solves as the Jacobian: one for each design variable. */
hf_status hf_problem_vjp(hf_problem *problem, const double *design, unsigned blocks, const double *vector,
                         double *product, hf_messages *messages);

/* Frees all members of the problem. */
void hf_problem_free(hf_problem *problem);

HF_API_END
