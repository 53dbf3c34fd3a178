/* problem - an opened case: its net with its truss, the shape found, and a batch that evaluates designs.
 * Stability: stable.
 *
 * hf_problem_open and hf_problem_free are all that a program needs around its own optimiser, see tools/own_optimiser.c.
 * `hifdm run`, `check` and `evaluate` make the same object step by step (src/run/problem_parts.h). Pipeline:
 *
 *   case file -> hf_case -> scene, truss -> model -> form-finding -> initial design, evaluator -> batch */
#ifndef HIFDM_PROBLEM_H
#define HIFDM_PROBLEM_H

#include <hifdm/api.h>
#include <hifdm/batch.h>
#include <hifdm/config.h>
#include <hifdm/facets.h>
#include <hifdm/scene_arrays.h>

HF_API_BEGIN

/* An opened case. Its members point to each other, so it must be neither moved nor copied. It belongs to one thread at
 * a time. */
typedef struct {
    hf_case settings;             /* the case */
    hf_scene scene;               /* the net as described */
    hf_carrier carrier;           /* the truss; all zero without one */
    hf_model model;               /* the net prepared for solving */
    hf_load_cases load_cases;     /* load cases of the as-built net; none without `load_cases` */
    hf_surface_settings surface;  /* target surface with its kind; all zero without a section surface */
    hf_facets facets;             /* facets of the target surface; none without a section surface */
    int planes;                   /* mirror planes that link design variables: flags 1 (x) and 2 (y) */
    hf_workspace workspace;       /* holds the shape of the form-finding until another one is computed in it */
    hf_form_result form;          /* result of the form-finding */
    double *start_q_N_per_m;      /* [n_cable] force densities of the form-finding */
    double *initial;              /* [n_variable] initial design, averaged over linked design variables */
    hf_limits limits;             /* rows of optimize.limits; none without rows */
    struct hf_problem_nets *nets; /* as-built nets of objectives over load cases or samples; NULL: there are none */
    hf_objectives objectives;     /* rows of optimize.objective or optimize.front; none without rows: psi */
    hf_evaluator evaluator;       /* common data of the designs */
    hf_batch batch;               /* evaluates designs; borrows the evaluator */
    hf_solver solver;             /* solver that the batch uses */
} hf_problem;

/* A case whose net a program has in memory. Both members are borrowed. */
typedef struct {
    const char *text; /* text of a case file with a section scene.import; the files that it names are not read */
    const hf_scene_arrays *net; /* the net */
} hf_problem_source;

/* Opens the case file `path` under n_set overrides "key=value" (NULL and 0: none). It builds the model with truss and
 * symmetry, finds the shape, and creates the batch of n_thread threads (0: all cores), which shares data made at
 * `initial` (hf_batch_share). A section sweep is ignored. model.n_variable may be 0: then there is nothing to design.
 *
 * Returns HF_OK; HF_BAD_CASE with messages about all faults; HF_NOT_CONVERGED or the status of an ill-posed net, with
 * the names of cables or nodes; HF_MECHANISM; HF_NO_MEMORY; HF_NO_LAPACK. Every failure adds an error message. If the
 * form-finding fails, `form` and `workspace` hold what it reached, and there is no batch. Call hf_problem_free in any
 * case. */
hf_status hf_problem_open(const char *path, const char *const *set, int n_set, int n_thread, hf_problem *problem,
                          hf_messages *messages);

/* Returns true if designs have a merit; with optimize.front they have none. */
bool hf_problem_has_merit(const hf_problem *problem);

/* Writes the figures of a design into `field` in their order. Returns their number, which is HF_RESULT_N_INDIVIDUAL
 * unless there is no merit. */
int hf_problem_list_figures(const hf_problem *problem, const hf_result_field *field[HF_RESULT_N_INDIVIDUAL]);

/* Returns the number of figures that have derivatives by the design variables: the value of each objective and, without
 * optimize.front, the merit. Without objectives the only one is psi_m. */
int hf_problem_n_slope(const hf_problem *problem);
/* Writes the name of figure i_slope with derivatives into text: that of its objective, "merit" or "psi_m". Returns
 * text. */
const char *hf_problem_slope_name(const hf_problem *problem, int i_slope, char text[HF_OBJECTIVE_NAME_SIZE]);

/* Computes the exact derivatives of the hf_problem_n_slope figures (METHOD section 7). design [n][n_variable] has n
 * designs, and result [n] their results of hf_batch_run. slope [feasible designs][n_slope][n_variable] receives the
 * derivatives by each design variable alone, in the unit of the figure per unit of the variable. They do not contain
 * the weights of objectives. For an objective that is a maximum of several sizes they are those of its smooth maximum.
 * The derivatives of a figure that is 0 are NaN. Overwrites problem->workspace. Returns HF_OK; HF_BAD_CASE with a
 * message if there are no derivatives (hf_problem_has_slopes); HF_NO_MEMORY. */
hf_status hf_problem_slopes(hf_problem *problem, int n, const double *design, const hf_form_result *result,
                            double *slope, hf_messages *messages);
/* Returns HF_OK if designs of this problem have derivatives. Returns HF_BAD_CASE with a message if not: for nets with
 * struts, under rule seeded, and for quantiles. */
hf_status hf_problem_has_slopes(const hf_problem *problem, hf_messages *messages);

/* Frees all members. */
void hf_problem_free(hf_problem *problem);

HF_API_END
#endif
