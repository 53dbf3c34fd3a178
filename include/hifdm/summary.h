/* summary - the figures of a whole run. `run` prints them and stores them with the results; `show` prints them again.
 * Stability: stable.
 *
 * The figures of a result (form, best, polish) are those of HF_RESULT_LIST in <hifdm/result.h>. */
#ifndef HIFDM_SUMMARY_H
#define HIFDM_SUMMARY_H

#include <hifdm/population.h>
#include <hifdm/surface.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HF_WARNINGS_SIZE 4096

typedef struct {
    char version[64], title[256], case_path[HF_PATH_SIZE];
    bool finished;    /* false: the run can be resumed */
    hf_status status; /* of the whole run; HF_NOT_EVALUATED unless finished */
    int threads;      /* number used */
    uint64_t seed;    /* of the genetic algorithm */
    int n_node, n_free, n_cable, n_gene, half_bandwidth;
    double pretension_N;
    char warnings[HF_WARNINGS_SIZE]; /* lines "warning: ..." and "error: ..." */

    hf_surface_settings surface;     /* focal_length_m is 0 when the case has no such section */
    hf_surface_measures measures[3]; /* of the shapes of form, optimize, polish (hf_stage) */

    hf_form_result form;
    double form_wall_s; /* of the form-finding */
    bool has_coupling;  /* the net is attached to an elastic truss; else member `coupling` of the results is all zero */

    hf_solver solver; /* of the individuals */

    bool has_polish;       /* Levenberg-Marquardt ran */
    bool polish_is_result; /* optimize.method asks for it: its design is the result, not only a comparison */
    hf_form_result polish;
    int polish_iterations, polish_evaluations; /* steps; form-findings */
    bool polish_converged;                     /* to its tolerance */
    double polish_wall_s;

    bool has_truss;       /* the next three are set */
    double truss_mass_kg; /* members and hinges */
    int truss_nodes, truss_members;

    bool has_optimize;    /* the genetic algorithm ran; all that follows is about it */
    double base_psi_m;    /* of individual 0 of generation 0, the tensions found under the rule; NaN if infeasible */
    int n_leader, planes; /* independent genes; HF_PLANE_ bits of the symmetry (1 = x, 2 = y) that links the others */
    hf_form_result best;  /* of the best individual; status HF_NOT_EVALUATED when none was feasible */
    int best_generation, best_individual; /* where the best was found, counted from 0 */
    int generations;                      /* number finished */
    long evaluations, infeasible;         /* form-findings; those without a feasible shape among them */
    hf_population_stop optimize_stop;
    double optimize_wall_s, optimize_cpu_s; /* cpu_s: inside evaluations, over all threads */
} hf_summary;

/* One JSON object, grouped by stage; a stage that did not run is absent, NaN is null. `messages`: lines as hf_messages
 * holds them, or NULL; `path`: of the result file, or NULL when none was written. Write errors can be read from the
 * stream (ferror). */
void hf_summary_write_json(const hf_summary *summary, hf_status status, const char *messages, const char *path,
                           FILE *file);

/* True when the file holds the shape of the best individual, which is stored when the genetic algorithm has ended. */
bool hf_summary_has_best_shape(const hf_summary *summary);

/* Share of the threads' time that was spent inside evaluations, 0..1; NaN when nothing was timed. */
double hf_summary_utilisation(const hf_summary *summary);

#ifdef __cplusplus
}
#endif
#endif
