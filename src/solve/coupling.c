/* Couples a net with its elastic truss (METHOD section 8).
 *
 *     displacements r of the attachments, force densities
 *         |
 *         v
 *     loop: solve the net at supports displaced by r -> pull f(r)
 *         | step = F f(r) - r: converged if no attachment steps farther than tof_m
 *         | plain: r <- F f(r);   accelerated: Anderson's method on past steps
 *         | auto: the loop ends early if its steps do not halve in two rounds
 *         v
 *     one matrix (auto only): the attachments become unknowns of the net solver (joint.c) */
#include "solve/coupling.h"

#include "linalg/dot.h"
#include "solve/history.h"
#include "solve/joint.h"
#include "solve/schur.h"

#include <math.h>
#include <string.h>

/* The tests of the coupling also pass with other values: GROWTHS_MAX 1 and 10, PATIENCE 5 and 50, STALLED 1e-4 and 0.3,
 * RETREATS_MAX 4, GRAM_SHIFT 1e-16 and 1e-11. */
#define GROWTHS_MAX 3    /* consecutive growing steps of the plain loop that count as divergence */
#define PATIENCE 15      /* iterations of the accelerated loop without a new smallest step */
#define SLOW 0.5         /* auto: two rounds must reduce the step to this part [0.2 to 0.7 pass] */
#define WILD 2.0         /* auto: no round may increase the step by more than this factor [1.5 to 10 pass] */
#define STALLED 1e-2     /* without progress: stalled below this part of the first step, else divergence */
#define RETREATS_MAX 12  /* halvings of steps to displacements at which the net has no shape */
#define GRAM_SHIFT 1e-14 /* relative shift of the diagonal of the least squares: past steps become nearly parallel */

static int dofs(const hf_model *m)
{
    return 3 * m->n_attachment;
}

/* ---- forces and displacements ---- */

void hf_coupling_forces(const hf_model *m, hf_workspace *w)
{
    double *f = w->attachment_force_N;
    for (int i = 0; i < m->n_attachment; i++)
        for (int c = 0; c < 3; c++)
            f[3 * i + c] = m->load_N ? m->load_N[c * m->n_node + m->attachment_row[i]] : 0;
    for (int k = 0; k < m->n_tie; k++) {
        int e = m->tie[k] / 2, here = m->end_row[m->tie[k]], there = m->end_row[m->tie[k] ^ 1];
        double q = hf_workspace_held_q_N_per_m(m, w, e);
        for (int c = 0; c < 3; c++)
            f[3 * m->tie_attachment[k] + c] +=
                q * (w->position_m[c * m->n_node + there] - w->position_m[c * m->n_node + here]);
    }
}

double hf_coupling_measure(const hf_model *m, hf_workspace *w, hf_form_result *r)
{
    double *next = w->coupling_work;
    hf_coupling_forces(m, w);
    hf_schur_flex(m, w->attachment_force_N, next);
    r->coupling.step_m = hf_joint_largest(m->n_attachment, 1, next, w->displacement_m);
    r->coupling.deflection_max_m = hf_joint_largest(m->n_attachment, 1, w->displacement_m, NULL);
    return r->coupling.step_m;
}

void hf_coupling_accept(const hf_model *m, const hf_workspace *w, int iterations, double step_m, hf_form_result *r)
{
    r->coupling =
        (hf_coupling_result){.stop_reason = HF_COUPLING_CONVERGED, .iterations = iterations, .step_m = step_m};
    r->coupling.ratio = (double)NAN;
    r->coupling.deflection_max_m = hf_joint_largest(m->n_attachment, 1, w->displacement_m, NULL);
}

/* ---- Anderson's method: combines past displacements so that their step is smallest ---- */

typedef struct {
    size_t n;
    int depth;                         /* maximum number of differences; 0: the plain loop */
    int n_seen;                        /* iterations since the last restart */
    double *next;                      /* [n] F f(r), m */
    double *step, *step_before;        /* [n] next - r now and in the iteration before, m */
    double *next_before;               /* [n] next of the iteration before, m */
    double *d_step[HF_COUPLING_DEPTH]; /* [n] differences of successive steps, m */
    double *d_next[HF_COUPLING_DEPTH]; /* [n] differences of successive next, m */
} accelerator;

static accelerator lay_out_accelerator(const hf_model *m, hf_coupling_scheme scheme, hf_workspace *w)
{
    accelerator a = {.n = (size_t)dofs(m), .depth = scheme == HF_COUPLING_PLAIN ? 0 : HF_COUPLING_DEPTH};
    double *at = w->coupling_work;
    double **field[] = {&a.next, &a.step, &a.step_before, &a.next_before};
    for (int k = 0; k < 4; k++, at += a.n)
        *field[k] = at;
    for (int k = 0; k < HF_COUPLING_DEPTH; k++, at += 2 * a.n) {
        a.d_step[k] = at;
        a.d_next[k] = at + a.n;
    }
    return a;
}

/* Solves the n x n system of the symmetric matrix g and the right-hand side b in place, by Cholesky. Returns false if g
 * is not positive definite. */
static bool solve_gram(int n, double g[HF_COUPLING_DEPTH][HF_COUPLING_DEPTH], double b[HF_COUPLING_DEPTH])
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = g[i][j];
            for (int k = 0; k < j; k++)
                sum -= g[i][k] * g[j][k];
            if (j < i)
                g[i][j] = sum / g[j][j];
            else if (sum > 0)
                g[i][i] = sqrt(sum);
            else
                return false;
        }
        for (int k = 0; k < i; k++)
            b[i] -= g[i][k] * b[k];
        b[i] /= g[i][i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++)
            b[i] -= g[k][i] * b[k];
        b[i] /= g[i][i];
    }
    return true;
}

/* Sets r [n] to the next displacements, m, from the history and a->next and a->step, and adds these two to the history.
 * If the least squares have no factor, r becomes a->next and the history restarts. */
static void accelerate(accelerator *a, double *r)
{
    double gram[HF_COUPLING_DEPTH][HF_COUPLING_DEPTH], share[HF_COUPLING_DEPTH];
    int n_kept = a->n_seen < a->depth ? a->n_seen : a->depth;
    if (n_kept > 0) {
        int last = (a->n_seen - 1) % a->depth;
        for (size_t i = 0; i < a->n; i++) {
            a->d_step[last][i] = a->step[i] - a->step_before[i];
            a->d_next[last][i] = a->next[i] - a->next_before[i];
        }
    }
    double largest = 0;
    for (int i = 0; i < n_kept; i++) {
        share[i] = hf_dot(a->n, a->d_step[i], a->step);
        for (int j = 0; j <= i; j++)
            gram[i][j] = hf_dot(a->n, a->d_step[i], a->d_step[j]);
        largest = fmax(largest, gram[i][i]);
    }
    for (int i = 0; i < n_kept; i++)
        gram[i][i] += GRAM_SHIFT * largest;
    bool solved = solve_gram(n_kept, gram, share);
    memcpy(r, a->next, a->n * sizeof *r);
    for (int k = 0; k < n_kept && solved; k++)
        hf_subtract(a->n, share[k], a->d_next[k], r);
    memcpy(a->step_before, a->step, a->n * sizeof *r);
    memcpy(a->next_before, a->next, a->n * sizeof *r);
    a->n_seen = solved ? a->n_seen + 1 : 1;
}

/* ---- the loop ---- */

typedef struct {
    double first_m, best_m, step_m, ratio; /* first, smallest and last step; ratio of the last two steps */
    double before_m;                       /* step before the last */
    int n_growth, n_since_best;
} progress;

/* Adds a step to the progress. Returns true if the loop no longer improves. */
static bool is_hopeless(progress *p, hf_coupling_scheme scheme, double step_m)
{
    if (isnan(p->step_m)) p->first_m = step_m;
    double two_m = p->before_m;
    p->ratio = step_m / p->step_m; /* NaN at the first step */
    p->before_m = p->step_m;
    p->step_m = step_m;
    p->n_growth = p->ratio >= 1 ? p->n_growth + 1 : 0;
    p->n_since_best = step_m < p->best_m ? 0 : p->n_since_best + 1;
    if (step_m < p->best_m) p->best_m = step_m;
    if (!isfinite(step_m)) return true;
    if (scheme == HF_COUPLING_AUTO) return p->ratio > WILD || step_m > SLOW * two_m;
    return scheme == HF_COUPLING_PLAIN ? p->n_growth >= GROWTHS_MAX : p->n_since_best >= PATIENCE;
}

static void give_up(hf_status status, hf_coupling_stop reason, hf_form_result *r)
{
    hf_coupling_result kept = r->coupling;
    int culprit = r->culprit;
    if (status == HF_TRUSS_TOO_SOFT) hf_form_refuse(status, r->iterations, r);
    r->culprit = culprit;
    r->status = status;
    r->coupling = kept;
    r->coupling.stop_reason = reason;
}

/* Handles a net without a shape at its displaced supports. In the accelerated loop, if the net had a shape before, sets
 * the displacements halfway back and returns true. Otherwise sets the result and returns false. */
static bool try_nearer(const hf_model *m, const hf_coupling_settings *s, const accelerator *a, int *n_retreat,
                       hf_workspace *w, hf_form_result *r)
{
    if (r->status == HF_NOT_CONVERGED) { /* there is a shape, so its coupling can be measured */
        double before_m = r->coupling.step_m;
        r->coupling.ratio = hf_coupling_measure(m, w, r) / before_m;
    }
    if (r->status == HF_NOT_CONVERGED || r->status == HF_INTERRUPTED || a->n_seen == 0) {
        give_up(r->status, HF_COUPLING_NET, r);
        return false;
    }
    if (s->scheme != HF_COUPLING_ACCELERATED || *n_retreat == RETREATS_MAX) {
        give_up(HF_TRUSS_TOO_SOFT, HF_COUPLING_DIVERGED, r);
        return false;
    }
    ++*n_retreat;
    for (size_t i = 0; i < a->n; i++)
        w->displacement_m[i] = (w->displacement_m[i] + a->next_before[i] - a->step_before[i]) / 2;
    memcpy(w->q_N_per_m, w->coupling_q_N_per_m, (size_t)m->n_cable * sizeof(double));
    return true;
}

/* Decides for a net with a shape whether the loop ends here. Returns true if so, with the status and the reason set. */
static bool is_over(const hf_model *m, const hf_coupling_settings *s, accelerator *a, progress *p, hf_workspace *w,
                    hf_form_result *r)
{
    double step_m = hf_coupling_measure(m, w, r);
    bool hopeless = is_hopeless(p, s->scheme, step_m);
    r->coupling.ratio = p->ratio;
    /* The first step is measured from the start and not from an iterate, so it ends the loop only if it is zero. */
    if (step_m <= s->tof_m && (a->n_seen > 0 || step_m == 0)) {
        r->coupling.stop_reason = HF_COUPLING_CONVERGED;
        return true;
    }
    /* The tolerance of the net limits the accuracy of its forces, so the steps may stay above tof_m. */
    bool stalls = hopeless && p->best_m < STALLED * p->first_m;
    if (hopeless && !stalls) {
        give_up(HF_TRUSS_TOO_SOFT, HF_COUPLING_DIVERGED, r);
        return true;
    }
    if (stalls || r->coupling.iterations >= s->max_iterations) {
        give_up(HF_NOT_CONVERGED, HF_COUPLING_MAX_ITERATIONS, r);
        return true;
    }
    for (size_t i = 0; i < a->n; i++)
        a->step[i] = a->next[i] - w->displacement_m[i];
    return false;
}

hf_status hf_coupling_find(const hf_model *m, const hf_coupling_settings *s, hf_net_solver *solve, const void *context,
                           bool start_counts, hf_workspace *w, hf_history *history, hf_form_result *r)
{
    size_t q_bytes = (size_t)m->n_cable * sizeof(double);
    accelerator a = lay_out_accelerator(m, s->scheme, w);
    progress p = {.best_m = INFINITY, .step_m = (double)NAN, .before_m = (double)NAN};
    int n_solve = 0, n_retreat = 0;
    memcpy(w->coupling_q_N_per_m, w->q_N_per_m, q_bytes);
    for (int i = 1;; i++) {
        solve(context, w, history, r);
        r->iterations = n_solve += r->iterations;
        r->coupling = (hf_coupling_result){.iterations = i, .step_m = p.step_m, .ratio = p.ratio};
        if (r->status != HF_OK) {
            if (!try_nearer(m, s, &a, &n_retreat, w, r)) break;
            continue;
        }
        double psi_m = r->psi_m; /* is_over may refuse the result and blank its psi */
        bool over = is_over(m, s, &a, &p, w, r);
        hf_history_add_coupling(history, r->coupling.step_m, psi_m, r->coupling.deflection_max_m);
        if (over) break;
        if (start_counts)
            memcpy(w->q_N_per_m, w->coupling_q_N_per_m, q_bytes);
        else
            memcpy(w->coupling_q_N_per_m, w->q_N_per_m, q_bytes);
        accelerate(&a, w->displacement_m);
    }
    return r->status;
}

/* ---- in one matrix ---- */

/* Returns the status of the net alone on fixed supports. Overwrites the shape in the workspace. */
static hf_status status_alone(const hf_model *m, hf_net_solver *solve, const void *context, hf_workspace *w)
{
    hf_form_result alone;
    w->n_moving = m->n_free;
    w->starts_near = false;
    memset(w->displacement_m, 0, (size_t)dofs(m) * sizeof(double));
    memcpy(w->q_N_per_m, w->coupling_q_N_per_m, (size_t)m->n_cable * sizeof(double));
    return solve(context, w, NULL, &alone);
}

hf_status hf_coupling_find_at_once(const hf_model *m, const hf_coupling_settings *s, hf_net_solver *solve,
                                   const void *context, hf_workspace *w, hf_history *history, hf_form_result *r)
{
    memcpy(w->coupling_q_N_per_m, w->q_N_per_m, (size_t)m->n_cable * sizeof(double));
    w->n_moving = m->n_free + m->n_attachment;
    w->n_joint_step = 0;
    solve(context, w, history, r);
    r->coupling = (hf_coupling_result){.stop_reason = HF_COUPLING_NET, .iterations = w->n_joint_step};
    r->coupling.ratio = r->coupling.step_m = (double)NAN;
    if (r->status == HF_OK || r->status == HF_NOT_CONVERGED) {
        hf_joint_set_displacement(m, w);
        bool is_there = hf_coupling_measure(m, w, r) <= s->tof_m && r->status == HF_OK;
        if (is_there) r->coupling.stop_reason = HF_COUPLING_CONVERGED;
        r->status = is_there ? HF_OK : HF_NOT_CONVERGED;
    } else if (r->status != HF_INTERRUPTED) {
        hf_status alone = status_alone(m, solve, context, w);
        if (alone == HF_INTERRUPTED)
            r->status = alone;
        else if (alone != r->status)
            give_up(HF_TRUSS_TOO_SOFT, HF_COUPLING_DIVERGED, r);
    }
    return r->status;
}

hf_status hf_coupling_find_either_way(const hf_model *m, const hf_coupling_settings *s, hf_net_solver *solve,
                                      const void *context, hf_workspace *w, hf_history *history, hf_form_result *r)
{
    hf_status status = hf_coupling_find(m, s, solve, context, false, w, history, r);
    /* The loop is final if the net ran out of iterations while the loop was not diverging. */
    bool is_over = status == HF_NOT_CONVERGED && r->coupling.stop_reason == HF_COUPLING_NET && !(r->coupling.ratio > 1);
    if (status == HF_OK || status == HF_INTERRUPTED || is_over) return status;
    int n_round = r->coupling.iterations, n_step = r->iterations;
    w->starts_near = n_round > 1;    /* coupling_q_N_per_m belongs to a shape */
    if (!(r->coupling.ratio <= 1)) { /* the loop diverged or made no progress */
        memcpy(w->q_N_per_m, w->coupling_q_N_per_m, (size_t)m->n_cable * sizeof(double));
        memset(w->displacement_m, 0, (size_t)dofs(m) * sizeof(double));
    }
    hf_coupling_find_at_once(m, s, solve, context, w, history, r);
    w->starts_near = false;
    r->iterations += n_step;
    r->coupling.iterations += n_round;
    return r->status;
}
