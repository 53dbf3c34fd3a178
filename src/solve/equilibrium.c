/* Finds the shape of minimum energy of a tension net (METHOD section 5).
 *
 *     force densities of the workspace
 *         | near: FIRST_BLOCK iterations of the paper, then Newton steps   -> shape, if they converge
 *         |   (left out if cables are elastic and the start is not near)
 *         v
 *     path: primal-dual interior method from the target positions        -> shape
 *         | not solved
 *         v
 *     the reason: a straight chain, a cable whose rounding prevents convergence, or the status of the path
 *
 * The paper's iteration (form.method: hifdm) asks the same path whether a net that it refuses has a shape. */
#include "solve/equilibrium.h"

#include "solve/coupling.h"
#include "solve/interior.h"
#include "solve/joint.h"
#include "solve/newton.h"

#define FIRST_BLOCK 6  /* iterations of hf_form_find before Newton's method; the tests pass with 2 and 20 */
#define NEWTON_MAX 30  /* maximum Newton steps after them */
#define PATH_MAX 60    /* maximum factorisations on the path; stress tests took up to 49 */
#define LAST_BLOCK 200 /* iterations that reduce errors to rounding, to find the cable whose rounding is largest */

static int smaller(int a, int b)
{
    return a < b ? a : b;
}

/* ---- from a start near the answer ---- */

/* Returns true if the attachments are within tof_m of the displacements F f under the measured shape, and sets
 * displacement_m. Also returns true if the attachments are not unknowns. */
static bool is_on_truss(const hf_model *m, const hf_form_settings *s, hf_workspace *w)
{
    hf_form_result at;
    if (w->n_moving == m->n_free) return true;
    hf_joint_set_displacement(m, w);
    return hf_coupling_measure(m, w, &at) <= s->coupling.tof_m;
}

/* Takes iterations of the paper and Newton steps from the force densities of the workspace. They converge in few steps
 * if these are near the answer. Returns true if the result is final. */
static bool try_near(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_history *history,
                     hf_form_result *r)
{
    hf_form_settings part = *s;
    part.max_iterations = smaller(FIRST_BLOCK, s->max_iterations);
    hf_form_find(m, &part, HF_STOP_RESIDUAL, w, history, r);
    bool is_found = r->status == HF_OK && is_on_truss(m, s, w);
    if (is_found || r->status == HF_INTERRUPTED || r->iterations >= s->max_iterations) return true;
    if (r->status != HF_OK && r->status != HF_NOT_CONVERGED) return false;
    int n_step = r->iterations;
    bool is_near = hf_newton_run(m, s, w, smaller(NEWTON_MAX, s->max_iterations - n_step), &n_step);
    /* No further solve with D follows: it would add rounding errors in proportion to the condition of D. */
    is_near = is_near && hf_form_measure(m, s, w, r) == HF_OK && is_on_truss(m, s, w);
    if (is_near) hf_form_accept(m, s, HF_STOPPED_CONVERGED, n_step, w, r);
    r->iterations = n_step;
    return is_near || n_step >= s->max_iterations;
}

/* ---- from anywhere ---- */

/* Returns true if the status may be caused by the iterate and not by the net. */
static bool is_refusal(hf_status status)
{
    return status == HF_COLLAPSED || status == HF_SINGULAR || status == HF_NOT_FINITE;
}

/* Sets first force densities for laws that may have changed since hf_form_prepare. */
static void set_first_force_densities(const hf_model *m, hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++) {
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        bool is_open = hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER);
        w->q_N_per_m[e] = is_open ? m->start_q_N_per_m[e] : hf_law_tension_N(cable, m->length_m[e]) / m->length_m[e];
    }
}

/* Finds the reason why the path has not solved the net: a straight chain, the cable whose rounding prevents
 * convergence, or none (culprit -1). Iterations from the end of the path reduce the errors to rounding. If they fail,
 * iterations from the first force densities may still find a chain. Returns result->status. */
static hf_status name_reason(const hf_model *m, const hf_form_settings *s, int n_step, hf_workspace *w,
                             hf_history *history, hf_form_result *r)
{
    hf_form_settings part = *s;
    hf_form_accept(m, s, HF_STOPPED_MAX_ITERATIONS, n_step, w, r);
    bool is_finite = r->status != HF_NOT_FINITE;
    int cable = r->culprit; /* with a tension that is not finite */
    if (is_finite && (r->status != HF_NOT_CONVERGED || r->culprit >= 0)) return r->status;
    hf_newton_copy(m, w->position_m, w->q_N_per_m, w->interior_position_m, w->interior_tension_N);
    for (int start = is_finite ? 0 : 1; start < 2; start++) {
        part.max_iterations = smaller(LAST_BLOCK, s->max_iterations - n_step);
        if (part.max_iterations < 1) break;
        if (start > 0) set_first_force_densities(m, w);
        for (int e = 0; e < m->n_cable; e++) /* a slack cable keeps HF_LAW_MIN_Q_N_PER_M */
            if (w->q_N_per_m[e] == 0) w->q_N_per_m[e] = HF_LAW_MIN_Q_N_PER_M;
        hf_form_find(m, &part, HF_STOP_RESIDUAL, w, history, r);
        n_step += r->iterations;
        r->iterations = n_step;
        bool is_iterate = r->status == HF_COLLAPSED || r->status == HF_NOT_FINITE;
        if (r->status == HF_STRAIGHT_CHAIN || (is_finite && !is_iterate)) return r->status;
    }
    if (!is_finite) {
        hf_form_refuse(HF_NOT_FINITE, n_step, r);
        r->culprit = cable;
    }
    if (!is_finite || r->status == HF_COLLAPSED) return r->status; /* both starts have failed */
    hf_newton_copy(m, w->interior_position_m, w->interior_tension_N, w->position_m, w->q_N_per_m);
    return hf_form_accept(m, s, HF_STOPPED_MAX_ITERATIONS, n_step, w, r);
}

/* Finds the shape by the path, after n_step steps of other kinds. Returns result->status. */
static hf_status find_on_path(const hf_model *m, const hf_form_settings *s, int n_step, hf_workspace *w,
                              hf_history *history, hf_form_result *r)
{
    int culprit = -1;
    hf_status status =
        hf_interior_run(m, s, w, false, smaller(PATH_MAX, s->max_iterations - n_step), &n_step, &culprit);
    if (status == HF_OK && hf_form_measure(m, s, w, r) == HF_OK)
        return hf_form_accept(m, s, HF_STOPPED_CONVERGED, n_step, w, r);
    if (status == HF_OK || status == HF_STRAIGHT_CHAIN || status == HF_NOT_CONVERGED)
        return name_reason(m, s, n_step, w, history, r);
    hf_form_refuse(status, n_step, r);
    r->culprit = culprit;
    return status;
}

hf_status hf_equilibrium_find(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_history *history,
                              hf_form_result *r)
{
    w->history = history;
    /* the first force densities of elastic cables can be wrong by decades */
    bool has_start = !m->EA_N || w->starts_near, is_over = has_start && try_near(m, s, w, history, r);
    if (!is_over) find_on_path(m, s, has_start ? r->iterations : 0, w, history, r);
    w->history = NULL;
    return r->status;
}

/* ---- by the paper's iteration ---- */

/* Maximum steps of the path and of name_reason that decide whether a net has a shape. */
#define VERDICT_MAX (PATH_MAX + 2 * LAST_BLOCK)

/* Runs the path and writes its result into *said. Keeps q_N_per_m and position_m. Returns said->status. */
static hf_status ask_path(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_form_result *said)
{
    hf_form_settings whole = *s;
    whole.max_iterations = VERDICT_MAX;
    hf_newton_copy(m, w->position_m, w->q_N_per_m, w->loose_before_m, w->loose_q_N_per_m);
    find_on_path(m, &whole, 0, w, NULL, said);
    hf_newton_copy(m, w->loose_before_m, w->loose_q_N_per_m, w->position_m, w->q_N_per_m);
    return said->status;
}

hf_status hf_equilibrium_judge_open(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_form_result *r)
{
    hf_form_result said;
    if (!m->has_newton || r->status != HF_NOT_CONVERGED || r->culprit >= 0) return r->status;
    hf_status status = ask_path(m, s, w, &said);
    if (status == HF_OK || status == HF_NOT_CONVERGED) { /* measure again the shape that is stored as not converged */
        double length_gap;
        hf_form_measure_cables(m, s, w, &said, &length_gap);
        hf_form_residual_N(m, w);
        return r->status;
    }
    said.iterations += r->iterations;
    *r = said;
    return r->status;
}

hf_status hf_equilibrium_find_by_paper(const hf_model *m, const hf_form_settings *s, hf_stop_rule stop, hf_workspace *w,
                                       hf_history *history, hf_form_result *r)
{
    hf_form_result said;
    hf_form_find(m, s, stop, w, history, r);
    if (r->status == HF_NOT_CONVERGED && stop == HF_STOP_RESIDUAL) return hf_equilibrium_judge_open(m, s, w, r);
    if (!m->has_newton || !is_refusal(r->status)) return r->status;
    int n_step = r->iterations;
    hf_status status = ask_path(m, s, w, &said);
    bool has_shape =
        status == HF_OK || status == HF_NOT_CONVERGED ||
        (status == HF_STRAIGHT_CHAIN && stop == HF_STOP_RMS_CHANGE); /* the paper's rule stops in spite of the chain */
    if (has_shape) {
        hf_form_settings rest = *s;
        rest.collapse_ratio = HF_FORM_GONE;
        rest.max_iterations = n_step < s->max_iterations ? s->max_iterations - n_step : 1;
        hf_form_find(m, &rest, stop, w, history, r);
        /* HF_NOT_FINITE stays: the coupling measures an iterate that has not converged, and here there is none. */
        if (r->status == HF_COLLAPSED || r->status == HF_SINGULAR) hf_form_refuse(HF_NOT_CONVERGED, r->iterations, r);
    } else {
        *r = said;
    }
    r->iterations += n_step;
    return r->status;
}
