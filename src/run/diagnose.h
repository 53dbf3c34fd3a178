/* diagnose - what is wrong or doubtful about a problem or a result, in the words of messages. */
#pragma once

#include "search/repair.h"
#include <hifdm/carrier.h>
#include <hifdm/population.h>
#include <hifdm/problem.h>
#include <hifdm/summary.h>

/* ---- form-finding ---- */

/* Explains problem->form, the result of the form-finding in the problem's workspace: warnings by hf_problem_warn, or an
 * error that names cables, nodes or chains. Returns problem->form.status. */
hf_status hf_problem_explain(hf_problem *problem, hf_messages *messages);

/* Warns about a shape that was found: not yet in equilibrium, loaded straight chains, loose, drifting or slack parts.
 * The messages give their names. `stage` names the shape in them. */
void hf_problem_warn(const hf_problem *problem, const char *stage, hf_workspace *workspace,
                     const hf_form_result *result, hf_messages *messages);

/* ---- reach of the design variables ---- */

/* Checks a problem with its initial design. It warns about a row of objectives or limits that no variable changes, and
 * about a row of variables that changes nothing, with their locations. Returns HF_BAD_CASE, with errors, if an
 * objective of a front or all objectives are constant for that reason. It checks ranges alone if designs have no
 * derivatives, and reports nothing more if the initial design has no shape. Returns HF_OK, HF_BAD_CASE or
 * HF_NO_MEMORY. */
hf_status hf_reach_check(const hf_problem *problem, hf_messages *messages);

/* ---- no design ---- */

#define HF_NO_DESIGN_SIZE 1024
#define HF_NO_DESIGN_HINT_SIZE 192

/* Reports that no individual of any generation was feasible. `nearest` [n_variable] is the design that violates the
 * constraints least, or NULL if none has a shape; `advice` is that of hf_feasible_check. Returns HF_NO_FEASIBLE, with a
 * message. */
hf_status hf_no_design_evolved(hf_problem *problem, const hf_population *population, const double *nearest,
                               const char *advice, hf_messages *messages);

/* Warns that no design of the first generation is feasible and that, by the linear model at its design with the least
 * violation, none within the bounds meets this limit. */
void hf_no_design_expected(const hf_problem *problem, const hf_repair_doubt *doubt, hf_messages *messages);

/* Writes why Levenberg-Marquardt found no feasible design and ended with this status at this one, the nearest. Both
 * designs have [n_variable] values; `advice` is that of hf_feasible_check. Overwrites the shape in the problem's
 * workspace. Returns text. */
const char *hf_no_design_to_refine(hf_problem *problem, const double *initial, const double *design, hf_status status,
                                   const char *advice, char text[HF_NO_DESIGN_SIZE]);

/* Writes "; 10 is the default of ..." if the ratio exceeds a cap that the case does not set, because its author may not
 * know that cap. Otherwise writes "". Returns text. */
const char *hf_no_design_cap(const hf_problem *problem, double boundary_tension_ratio,
                             char text[HF_NO_DESIGN_HINT_SIZE]);

/* ---- doubts about a result ---- */

/* Warns if linear theory is not accurate enough for the truss. `shape` holds the result (NULL: there is none), and
 * `truss` is the state of the truss under it. */
void hf_result_doubt_truss(const hf_problem *problem, const hf_carrier_state *truss, const hf_workspace *shape,
                           hf_messages *messages);

/* Warns about the cable of the result with the maximum strain T/EA, if that is above STRAIN_DOUBT, 0.05. */
void hf_result_doubt_strain(const hf_problem *problem, const hf_workspace *shape, hf_messages *messages);

/* How objectives count the position of a node: not at all, by its distance from the surface, or completely. */
typedef enum { HF_COUNTED_NOT, HF_COUNTED_ACROSS, HF_COUNTED } hf_counted;

/* Positions of the nodes after form-finding, by row. All members are NULL if nothing was kept. */
typedef struct {
    double *position_m;     /* [3][n_node] m */
    double *cable_m;        /* [n_node] mean length of the cables at each node, m */
    int *n_cable;           /* [n_node] number of these cables */
    unsigned char *counted; /* [n_node] hf_counted */
    void *block;
} hf_places;

/* Keeps the positions of the shape in the problem's workspace. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_places_keep(const hf_problem *problem, hf_places *places);
void hf_places_free(hf_places *places);

/* Sets n_uncounted and uncounted_move_m of the summary, and warns about the free node with the maximum displacement
 * from these positions that no objective counts. For the warning, the displacement must exceed a quarter of the mean
 * length of the node's cables, and the counted displacement of every node. psi counts inner nodes, an objective of
 * length the ends of its cables, and objectives of the surface the distance of their nodes from it. Displacements
 * within the surface have a warning of their own. */
void hf_result_doubt_uncounted(const hf_problem *problem, const hf_places *form, const hf_workspace *shape,
                               hf_summary *summary, hf_messages *messages);
