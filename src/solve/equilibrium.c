/* Contents: from a start near the answer - from anywhere */
#include "solve/equilibrium.h"

#include "solve/coupling.h"
#include "solve/interior.h"
#include "solve/joint.h"
#include "solve/newton.h"

#define FIRST_BLOCK 6  /* iterations of hf_form_find before Newton is tried. Tests pass with 2 and 20. */
#define NEWTON_MAX 30  /* Newton steps after them */
#define PATH_MAX 60    /* factorisations on the path; up to 49 were seen in stress tests */
#define LAST_BLOCK 200 /* iterations that bring errors down to rounding, to name the cable at which it is largest */

static int smaller(int a, int b)
{
    return a < b ? a : b;
}

/* ---- from a start near the answer ---- */

/* Whether attachments that are unknowns have come to where the truss has them under the measured shape. */
static bool is_on_truss(const hf_model *m, const hf_form_settings *s, hf_workspace *w)
{
    hf_form_result at;
    if (w->n_moving == m->n_free) return true;
    hf_joint_set_displacement(m, w);
    return hf_coupling_measure(m, w, &at) <= s->coupling.tof_m;
}

/* Iterations of the paper and Newton steps from the case's force densities: they take few steps when these are near the
 * answer's. True when the result is final. */
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
    /* the shape is not solved for again with D: that would add rounding errors in proportion to D's condition */
    is_near = is_near && hf_form_measure(m, s, w, r) == HF_OK && is_on_truss(m, s, w);
    if (is_near) hf_form_accept(m, s, HF_STOPPED_RESIDUAL, n_step, w, r);
    r->iterations = n_step;
    return is_near || n_step >= s->max_iterations;
}

/* ---- from anywhere ---- */

/* For a net that the path has not solved: the straight chain that is the reason, the cable whose rounding is, or no
 * name. */
static hf_status name_reason(const hf_model *m, const hf_form_settings *s, int n_step, hf_workspace *w,
                             hf_history *history, hf_form_result *r)
{
    hf_form_accept(m, s, HF_STOPPED_MAX_ITERATIONS, n_step, w, r);
    hf_form_settings part = *s;
    part.max_iterations = smaller(LAST_BLOCK, s->max_iterations - n_step);
    if (r->status != HF_NOT_CONVERGED || r->culprit >= 0 || part.max_iterations < 1) return r->status;
    hf_form_find(m, &part, HF_STOP_RESIDUAL, w, history, r);
    r->iterations += n_step;
    return r->status;
}

static hf_status find_equilibrium(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_history *history,
                                  hf_form_result *r)
{
    int n_step = 0, culprit = -1;
    if (!m->EA_N) { /* first force densities of elastic cables can be decades away */
        if (try_near(m, s, w, history, r)) return r->status;
        n_step = r->iterations;
    }
    hf_status status = hf_interior_run(m, s, w, smaller(PATH_MAX, s->max_iterations - n_step), &n_step, &culprit);
    if (status == HF_OK && hf_form_measure(m, s, w, r) == HF_OK)
        return hf_form_accept(m, s, HF_STOPPED_RESIDUAL, n_step, w, r);
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
    find_equilibrium(m, s, w, history, r);
    w->history = NULL;
    return r->status;
}
