/* Finds free nodes that no taut cable holds, and gives them positions (METHOD section 4).
 *
 *     converged equilibrium
 *         | mark: nodes without load and without taut cable  -> workspace->loose
 *         | remove the tensions of their cables, which may be above zero by rounding; balance the other nodes again
 *         | path (interior.c) with springs to the target positions, cables under law length, other nodes fixed
 *         v
 *     positions of the loose nodes, result measured again */
#include "solve/loose.h"

#include "solve/interior.h"
#include "solve/joint.h"
#include "solve/newton.h"

#include <math.h>
#include <string.h>

#define PLACE_MAX 100         /* maximum factorisations for the positions of loose nodes */
#define PLACE_TOLERANCE 1e-10 /* relative errors at which that path ends */
#define REFINE_MAX 10         /* maximum Newton steps after the tensions of loose cables are removed */

/* ---- which nodes ---- */

/* Returns the force below which a cable or a load counts as zero, N. The equilibrium is known only within the tolerance
 * of its residual. */
static double nothing_N(const hf_model *m, const hf_form_settings *s)
{
    return s->residual_tolerance * m->reference_N;
}

static bool is_loaded(const hf_model *m, const hf_form_settings *s, int row)
{
    double square = 0, none_N = nothing_N(m, s);
    for (int c = 0; c < 3 && m->load_N; c++)
        square += m->load_N[c * m->n_node + row] * m->load_N[c * m->n_node + row];
    return square > none_N * none_N;
}

static bool is_taut(const hf_model *m, const hf_form_settings *s, const hf_workspace *w, int e)
{
    if (!hf_law_has((hf_law)w->law[e], HF_LAW_HAS_MULTIPLIER)) return true; /* it cannot be slack */
    double T = w->tension_N[e], slack_m = hf_law_required_length_m(hf_workspace_cable(m, w, e), T) - w->length_m[e];
    return T > nothing_N(m, s) && T / m->reference_N > slack_m / m->length_m[e];
}

static bool is_loose_cable(const hf_model *m, const hf_workspace *w, int e)
{
    return w->loose[m->end_row[2 * e]] || w->loose[m->end_row[2 * e + 1]];
}

/* Marks the free rows without load and without taut cable in w->loose. Returns their number. */
static int mark(const hf_model *m, const hf_form_settings *s, hf_workspace *w)
{
    int n = 0;
    for (int i = 0; i < m->n_node; i++)
        w->loose[i] = i < m->n_free && !is_loaded(m, s, i);
    for (int e = 0; e < m->n_cable; e++)
        if (is_taut(m, s, w, e)) w->loose[m->end_row[2 * e]] = w->loose[m->end_row[2 * e + 1]] = 0;
    for (int i = 0; i < m->n_free; i++)
        n += w->loose[i];
    return n;
}

/* ---- their positions ---- */

/* Returns the maximum length of cable e without tension, m. */
static double slack_length_m(const hf_model *m, const hf_workspace *w, int e)
{
    return hf_law_required_length_m(hf_workspace_cable(m, w, e), 0);
}

static bool fits(const hf_model *m, const hf_form_settings *s, const hf_workspace *w)
{
    double u[3];
    for (int e = 0; e < m->n_cable; e++)
        if (is_loose_cable(m, w, e) && !(hf_newton_matrix_direction(m, w->position_m, e, u) <=
                                         (1 + s->length_tolerance) * slack_length_m(m, w, e))) /* true for a NaN, too */
            return false;
    return true;
}

/* Prepares the path that finds the positions, which are a shape of minimum energy, too. The cables of loose nodes are
 * under law length, and all others have no force. The other nodes are fixed, and a spring pulls each loose node to its
 * target position. */
static void set_up_places(const hf_model *m, hf_workspace *w)
{
    double spring = hf_joint_loose_spring_N_per_m(m);
    for (int e = 0; e < m->n_cable; e++) {
        bool is_loose = is_loose_cable(m, w, e);
        double slack_m = is_loose ? slack_length_m(m, w, e) : 0;
        w->law[e] = is_loose ? HF_LAW_LENGTH : HF_LAW_FORCE_DENSITY;
        w->target[e] = slack_m;
    }
    memcpy(w->spring_anchor_m, w->position_m, 3 * (size_t)m->n_node * sizeof(double));
    for (int i = 0; i < m->n_free; i++) {
        w->spring_N_per_m[i] = w->loose[i] ? spring : INFINITY;
        for (int c = 0; c < 3 && w->loose[i]; c++)
            w->spring_anchor_m[c * m->n_node + i] = m->position_m[c * m->n_node + i];
    }
}

/* Moves the marked nodes and increases *n_step by the number of factorisations. If the path finds no positions at which
 * their cables are short enough, the nodes stay. Returns the status of the path. */
static hf_status find_places(const hf_model *m, const hf_form_settings *s, hf_workspace *w, int *n_step)
{
    size_t n = (size_t)m->n_cable, bytes = n * sizeof(double), places = 3 * (size_t)m->n_node * sizeof(double);
    int culprit, n_moving = w->n_moving;
    w->n_moving = m->n_free;
    memcpy(w->loose_law, w->law, n);
    memcpy(w->loose_target, w->target, bytes);
    memcpy(w->loose_q_N_per_m, w->q_N_per_m, bytes);
    memcpy(w->loose_before_m, w->position_m, places);
    set_up_places(m, w);
    hf_form_settings tight = *s;
    tight.residual_tolerance = PLACE_TOLERANCE;
    tight.length_tolerance = fmin(s->length_tolerance, PLACE_TOLERANCE);
    hf_status status = hf_interior_run(m, &tight, w, true, PLACE_MAX, n_step, &culprit);
    w->n_moving = n_moving;
    memcpy(w->law, w->loose_law, n);
    memcpy(w->target, w->loose_target, bytes);
    memcpy(w->q_N_per_m, w->loose_q_N_per_m, bytes);
    if (!fits(m, s, w)) memcpy(w->position_m, w->loose_before_m, places);
    return status;
}

/* Balances the held nodes again with the attachments fixed. If Newton's method fails, restores the positions. */
static void refine(const hf_model *m, const hf_form_settings *s, hf_workspace *w, int *n_step)
{
    size_t places = 3 * (size_t)m->n_node * sizeof(double);
    int n_moving = w->n_moving;
    memcpy(w->loose_before_m, w->position_m, places);
    w->n_moving = m->n_free;
    if (!hf_newton_run(m, s, w, REFINE_MAX, n_step)) memcpy(w->position_m, w->loose_before_m, places);
    w->n_moving = n_moving;
}

/* ---- results ---- */

void hf_loose_settle(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_form_result *r)
{
    if (!m->has_newton || r->status != HF_OK || r->stop_reason != HF_STOPPED_CONVERGED) return;
    int n_loose = mark(m, s, w);
    if (n_loose == 0) return;
    hf_form_result before = *r;
    for (int e = 0; e < m->n_cable; e++)
        if (is_loose_cable(m, w, e)) w->q_N_per_m[e] = w->tension_N[e] = 0;
    if (hf_form_residual_N(m, w) > nothing_N(m, s)) /* the paper's iteration leaves some tension in slack cables */
        refine(m, s, w, &before.iterations);
    hf_status status = find_places(m, s, w, &before.iterations);
    hf_form_measure(m, s, w, r);
    if (status == HF_INTERRUPTED) r->status = status;
    r->iterations = before.iterations;
    r->coupling = before.coupling;
    r->n_loaded_chain = before.n_loaded_chain;
    r->n_loose = n_loose;
}

void hf_loose_refuse(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_form_result *r)
{
    if (!m->has_newton || r->status != HF_OK || r->stop_reason != HF_STOPPED_CONVERGED || mark(m, s, w) == 0) return;
    int row = 0;
    while (!w->loose[row])
        row++;
    hf_form_refuse(HF_SINGULAR, r->iterations, r);
    r->culprit = row;
}
