/* Contents: flat chains - starts - the alternation */
#include "solve/equilibrium.h"

#include "solve/descent.h"
#include "solve/newton.h"
#include "solve/newton_matrix.h"

#include <math.h>

/* Iterations of hf_form_find before Newton is tried, doubled after each failure of Newton. The tests of form-finding
 * pass with 2 and 20. */
#define FIRST_BLOCK 6
/* Newton steps per try. From 30 to 300 the tests of solve and stress pass; with 10 two fail, a net of stiff cables and
 * one of stress/ladders. */
#define STEPS_MAX 30
/* Steps per try on the energy of elastic cables. From 30 to 1000 the tests of solve pass; with 10 one fails
 * (stiff_cables_keep_their_length). */
#define DESCENT_MAX 300
/* A flat chain whose excess length is more than FAR_EXCESS times the wanted one is rescaled, in at most RESCALED_MAX
 * rounds. The tests of form-finding, Newton and verification pass with a FAR_EXCESS of 4 and of 100, and with a
 * RESCALED_MAX from 1 to 80; from 4 on they take the same steps. With 0 one fails (flat_edges_are_solved). */
#define FAR_EXCESS 16.0
#define RESCALED_MAX 8
/* Further tries after a shape whose residual is limited by rounding. From 0 to 30 no net of the tests of solve and
 * stress is judged otherwise; only the steps until it is refused change. */
#define ROUNDED_MAX 3

/* ---- flat chains ---- */

/* The tension of a flat chain is proportional to the inverse square root of its excess length (M5). It can be decades
 * away from the present one, too far for Eq. 8 or Newton's linear model. This scales the chain's force densities to the
 * excess that L* prescribes. Returns the number of chains scaled. */
static int rescale_flat_chains(const hf_model *m, hf_workspace *w)
{
    int n_scaled = 0;
    for (int i = m->n_chain; i < m->n_any_chain; i++) {
        int first = m->chain_start[i], last = m->chain_start[i + 1] - 1;
        bool is_rigid = true;
        double sum = 0, wanted = 0, u[3], *x = w->position_m;
        for (int k = first; k <= last; k++) {
            int e = m->chain_cable[k];
            is_rigid = is_rigid && hf_law_has(w->law[e], HF_LAW_IS_RIGID);
            sum += hf_newton_matrix_direction(m, x, e, u);
            wanted += w->target[e];
        }
        const int *a = m->end_row + 2 * m->chain_cable[first], *b = m->end_row + 2 * m->chain_cable[last];
        int from = a[0] > a[1] ? a[0] : a[1], to = b[0] > b[1] ? b[0] : b[1]; /* the supports */
        for (int c = 0; c < 3; c++)
            u[c] = x[c * m->n_node + to] - x[c * m->n_node + from];
        double span = hypot(hypot(u[0], u[1]), u[2]), excess = sum - span, wanted_excess = wanted - span;
        if (!is_rigid || !(wanted_excess > 0 && excess > FAR_EXCESS * wanted_excess)) continue;
        for (int k = first; k <= last; k++)
            w->q_N_per_m[m->chain_cable[k]] *= sqrt(excess / wanted_excess);
        n_scaled++;
    }
    return n_scaled;
}

/* ---- starts ---- */

/* Sets first force densities other than those of the case, for one more try. The first shapes can be far from the
 * answer, so a cable that collapses in one of them does not prove that there is no answer. */
static void start_elsewhere(const hf_model *m, hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++)
        if (hf_law_has(w->law[e], HF_LAW_ITERATES)) w->q_N_per_m[e] = m->start_q_N_per_m[e] * (1 + e % 3);
}

/* A start for nets with elastic cables: descent and Newton from the theoretical shape, which is a better start for them
 * than iterations of hf_form_find. Returns the number of steps. */
static int start_elastic(const hf_model *m, const hf_form_settings *s, hf_workspace *w)
{
    int most = s->max_iterations < DESCENT_MAX ? s->max_iterations : DESCENT_MAX, n_step = 0;
    hf_form_place_supports(m, w);
    int n = hf_descent_run(m, w, most);
    hf_newton_run(m, s, w, STEPS_MAX, &n_step);
    return n + n_step;
}

/* ---- the alternation ---- */

hf_status hf_equilibrium_find(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_history *history,
                              hf_form_result *result)
{
    int n_done = 0, n_rescaled = 0, n_rounded = 0, n_restarted = 0, block = FIRST_BLOCK;
    if (m->EA_N) n_done = start_elastic(m, s, w);
    for (;;) {
        hf_form_settings part = *s;
        int left = s->max_iterations - n_done;
        part.max_iterations = left < 1 ? 1 : block < left ? block : left; /* at least one: it measures the shape */
        hf_form_find(m, &part, HF_STOP_RESIDUAL, w, history, result);
        n_done += result->iterations;
        if (result->status == HF_COLLAPSED && n_done <= FIRST_BLOCK && n_restarted++ == 0) {
            start_elsewhere(m, w);
            continue;
        }
        if (result->status != HF_NOT_CONVERGED || n_done >= s->max_iterations) break;
        if (result->culprit >= 0 && n_rounded++ == ROUNDED_MAX) break;
        if (n_rescaled < RESCALED_MAX && rescale_flat_chains(m, w)) {
            n_rescaled++;
            continue;
        }
        int n_step = 0;
        left = s->max_iterations - n_done;
        if (m->EA_N) n_done += hf_descent_run(m, w, left < DESCENT_MAX ? left : DESCENT_MAX);
        left = s->max_iterations - n_done < STEPS_MAX ? s->max_iterations - n_done : STEPS_MAX;
        bool has_moved = hf_newton_run(m, s, w, left, &n_step);
        n_done += n_step;
        /* the shape is not solved for again with D: that would add rounding errors in proportion to D's condition */
        if (has_moved && hf_form_measure(m, s, w, result) == HF_OK) {
            hf_form_accept(m, s, HF_STOPPED_RESIDUAL, n_done, w, result);
            break;
        }
        block = has_moved ? FIRST_BLOCK : 2 * block; /* after a failure hf_form_find goes on longer */
    }
    result->iterations = n_done;
    return result->status;
}
