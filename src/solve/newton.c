/* Solves for the shape of a tension net by Newton's method on its energy (METHOD section 5).
 *
 *     position_m and tension_N of the workspace
 *         | forces out of balance (M2), length errors of the multipliers
 *         | factor H, solve H d = rhs (M8); multipliers change by (M7)
 *         | halve the step until the merit falls; repeat
 *         v
 *     hf_newton_run: shape and force densities
 *
 * hf_newton_certify takes the same step once from a final shape. Its size estimates the position error, and the factor
 * gives the condition. */
#include "solve/newton.h"

#include "solve/history.h"
#include "solve/joint.h"

#include <math.h>
#include <string.h>

/* Maximum halvings of one step before it counts as failed. From 0 to 6 the tests of solve and stress pass; with 12
 * those of stress fail. */
#define HALVINGS_MAX 6
/* At most TRUSTED_MAX steps per run may raise the merit, each by less than the factor TRUSTED_RISE. The tests of
 * form-finding pass with 0 and 30 such steps, and with factors of 1e1 and 1e12. */
#define TRUSTED_MAX 6
#define TRUSTED_RISE 1e6
/* After more steps than this the merit must be below the first one, else the path is tried: in large nets steps are
 * expensive. The tests of form-finding pass with 4 and 12. */
#define LOST_AFTER 8
/* A step keeps at least this fraction of a multiplier. The tests of form-finding pass with 0.01 and 0.5. */
#define TENSION_KEPT 0.1
/* Constants of look_for_drift, in this order:
 *
 *   the condition number above which it looks
 *   the rounds of inverse iteration
 *   the displacement of the trial, relative to the mean length
 *   the error that counts as rounding
 *   the force at a node that counts as zero, relative to the tensions there */
#define DRIFT_CONDITION 1e12
#define DRIFT_ROUNDS 3
#define DRIFT_PART 1e-2
#define DRIFT_NOTHING 1e-15
#define DRIFT_FORCE 1e-9

/* ---- forces ---- */

typedef struct {
    double residual_N; /* maximum nodal force */
    double length_gap; /* maximum length error; that of a cable that is too short is weighted by its tension */
    double truss_m;    /* maximum |F f - r| of an attachment, m */
    double merit;      /* sum of squares of the forces over the reference tension, and of length errors and gaps */
} imbalance;

/* Measures the shape position_m with the multipliers T [n_cable]. Sets force [3*row + c] to the nodal forces out of
 * balance, N: minus the gradient of Pi (M2). */
static imbalance measure_imbalance(const hf_model *m, const hf_workspace *w, const double *position_m, const double *T,
                                   double *force)
{
    imbalance result = {0};
    double u[3], sum = 0, largest = 0, scale = 1 / m->reference_N; /* the squares of tiny forces would underflow */
    hf_newton_matrix_set_loads(m, w, force);
    for (int e = 0; e < m->n_cable; e++) {
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        double length = hf_newton_matrix_direction(m, position_m, e, u),
               tension = hf_newton_matrix_tension_N(cable, length, T[e]);
        double pull[3] = {tension * u[0], tension * u[1], tension * u[2]};
        hf_newton_matrix_add_pull(m, w, e, pull, force);
        if (!hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER)) continue;
        double gap = length / hf_law_required_length_m(cable, tension) - 1;
        if (gap < 0) gap *= fmin(1, tension / m->reference_N);
        result.length_gap = fmax(result.length_gap, fabs(gap));
        result.merit += gap * gap;
    }
    for (int i = 0; i < m->n_free; i++) {
        double x = scale * force[3 * i], y = scale * force[3 * i + 1], z = scale * force[3 * i + 2];
        double square = x * x + y * y + z * z;
        largest = fmax(largest, square);
        sum += square;
    }
    result.residual_N = sqrt(largest) * m->reference_N;
    result.merit += sum;
    result.truss_m = hf_joint_gap_m(m, w, position_m, force, &result.merit);
    return result;
}

/* ---- one step ---- */

void hf_newton_copy(const hf_model *m, const double *from_m, const double *from_cable, double *to_m, double *to_cable)
{
    memcpy(to_m, from_m, 3 * (size_t)m->n_node * sizeof(double));
    memcpy(to_cable, from_cable, (size_t)m->n_cable * sizeof(double));
}

/* Returns the change of the multiplier T, N, for `part` of a step. After the whole step the cable would exceed its
 * required length by `beyond`, m (M7). A cable without stiffness loses `part` of T. */
static double tension_change(hf_law_cable cable, double length, double T, double part, double beyond)
{
    double k = hf_newton_matrix_stiffness(cable, length, T);
    return k > 0 ? part * k * beyond : -part * T;
}

/* Sets rhs [3 n_moving] to the right-hand side of (M8): the forces, plus the effect of the multiplier changes for the
 * present length errors. */
static void right_hand_side(const hf_model *m, const hf_workspace *w, const double *force, double *rhs)
{
    double u[3];
    memcpy(rhs, force, 3 * (size_t)w->n_moving * sizeof *rhs);
    for (int e = 0; e < m->n_cable; e++) {
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        if (!hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER)) continue;
        double length = hf_newton_matrix_direction(m, w->position_m, e, u);
        double T = w->tension_N[e], beyond = length - hf_law_required_length_m(cable, T);
        double more = tension_change(cable, length, T, 1, beyond), pull[3] = {more * u[0], more * u[1], more * u[2]};
        hf_newton_matrix_add_pull(m, w, e, pull, rhs);
    }
}

/* Sets newton_step to the Newton step for the forces in newton_force_N, with the factored matrix. */
static void solve_step_of(const hf_model *m, hf_workspace *w)
{
    right_hand_side(m, w, w->newton_force_N, w->newton_step);
    hf_joint_solve(m, w, hf_newton_matrix_block, NULL, w->newton_step);
}

/* Sets newton_trial_m and newton_trial_tension_N to the shape and the multipliers after `part` of the step. */
static void try_step(const hf_model *m, hf_workspace *w, double part)
{
    const double *step = w->newton_step;
    double u[3];
    hf_newton_copy(m, w->position_m, w->tension_N, w->newton_trial_m, w->newton_trial_tension_N);
    hf_newton_matrix_move_nodes(m, w, part, w->newton_trial_m);
    for (int e = 0; e < m->n_cable; e++) {
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        if (!hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER)) continue;
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        double length = hf_newton_matrix_direction(m, w->position_m, e, u), T = w->tension_N[e];
        double beyond = length - hf_law_required_length_m(cable, T);
        for (int c = 0; c < 3; c++) {
            if (a < w->n_moving) beyond -= u[c] * step[3 * a + c];
            if (b < w->n_moving) beyond += u[c] * step[3 * b + c];
        }
        double least = hf_law_has(cable.law, HF_LAW_GOES_SLACK) ? 0 : TENSION_KEPT * T;
        w->newton_trial_tension_N[e] = fmax(T + tension_change(cable, length, T, part, beyond), least);
    }
}

/* ---- Newton from a shape ---- */

static bool is_balanced(const hf_model *m, const hf_form_settings *s, const imbalance *now)
{
    return now->residual_N <= s->residual_tolerance * m->reference_N && now->length_gap <= s->length_tolerance &&
           now->truss_m <= fmax(s->coupling.tof_m, HF_JOINT_NO_GAP_M);
}

void hf_newton_set_force_densities(const hf_model *m, unsigned may_be_slack, hf_workspace *w)
{
    double u[3];
    for (int e = 0; e < m->n_cable; e++) {
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        double length = w->length_m[e] = hf_newton_matrix_direction(m, w->position_m, e, u);
        double T = hf_newton_matrix_tension_N(cable, length, w->tension_N[e]);
        bool is_nothing = hf_law_has(cable.law, may_be_slack) && T < HF_NEWTON_NOTHING * m->reference_N;
        bool is_spring = hf_newton_matrix_is_spring(cable.law);
        w->q_N_per_m[e] = is_nothing ? 0 : is_spring ? hf_law_tension_N(cable, 1) : T / length;
    }
}

bool hf_newton_run(const hf_model *m, const hf_form_settings *s, hf_workspace *w, int max_steps, int *n_step)
{
    /* A tenth of the tolerances is the aim, so that a later linear solve still meets them. */
    hf_form_settings tight = *s;
    tight.residual_tolerance = fmax(0.1 * s->residual_tolerance, 1e-13);
    tight.length_tolerance = fmax(0.1 * s->length_tolerance, 1e-14);
    tight.coupling.tof_m = 0.1 * s->coupling.tof_m;
    imbalance now = measure_imbalance(m, w, w->position_m, w->tension_N, w->newton_force_N), next = now;
    double first_merit = now.merit;
    int n_trusted = 0;
    for (int k = 0; k < max_steps && !is_balanced(m, &tight, &now); k++) {
        if (hf_joint_factor(m, w, hf_newton_matrix_block, NULL, NULL, NULL) != HF_OK) break;
        solve_step_of(m, w);
        double part = 1;
        int halvings = 0;
        for (; halvings <= HALVINGS_MAX; halvings++, part /= 2) {
            try_step(m, w, part);
            next = measure_imbalance(m, w, w->newton_trial_m, w->newton_trial_tension_N, w->newton_force_N);
            if (next.merit < now.merit * (1 - 0.1 * part)) break; /* false for NaN */
        }
        ++*n_step;
        if (halvings > HALVINGS_MAX) {
            /* The merit can rise on the way to tensions that are decades away, so a few such full steps are allowed. */
            if (++n_trusted > TRUSTED_MAX || is_balanced(m, s, &now)) break;
            try_step(m, w, 1);
            next = measure_imbalance(m, w, w->newton_trial_m, w->newton_trial_tension_N, w->newton_force_N);
            if (!(next.merit < TRUSTED_RISE * now.merit)) break;
        }
        hf_newton_copy(m, w->newton_trial_m, w->newton_trial_tension_N, w->position_m, w->tension_N);
        now = next;
        if (k >= LOST_AFTER && !(now.merit < first_merit)) return false;
        hf_history_add_step(m, w, now.residual_N, now.length_gap, now.truss_m);
    }
    if (!(now.merit < first_merit)) return false;
    hf_newton_set_force_densities(m, HF_LAW_GOES_SLACK, w);
    return true;
}

/* ---- certificate ---- */

/* Scales newton_step so that the maximum displacement of a node is 1, and sets loose nodes to 0. Returns the row of
 * that node, or -1. */
static int normalise_step(const hf_model *m, const hf_workspace *w)
{
    int row = -1;
    double largest = 0;
    for (int i = 0; i < m->n_free; i++) {
        double *d = w->newton_step + 3 * i;
        if (w->loose[i]) d[0] = d[1] = d[2] = 0;
        double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (!(square > largest)) continue;
        largest = square;
        row = i;
    }
    for (int k = 0; k < hf_newton_matrix_dofs(m) && row >= 0; k++)
        w->newton_step[k] /= sqrt(largest);
    return row;
}

/* Returns the sum of the tensions at a row, N. */
static double pull_at_row_N(const hf_model *m, const hf_workspace *w, int row)
{
    double sum = 0;
    for (int k = 0; k < 2 * m->n_cable; k++)
        if (m->end_row[k] == row) sum += w->tension_N[k / 2];
    return sum;
}

/* Checks whether a nearly singular matrix means that the equilibrium is not unique. It displaces the nodes slightly
 * along the softest direction, which inverse iteration finds. If the forces still balance there, it sets n_drifting to
 * the number of nodes that take part and culprit to the one that moves farthest. position_error_m becomes NaN. */
static void look_for_drift(const hf_model *m, hf_workspace *w, hf_form_result *r)
{
    int n = hf_newton_matrix_dofs(m), row = -1;
    imbalance here = measure_imbalance(m, w, w->position_m, w->tension_N, w->newton_force_N);
    for (int k = 0; k < 3 * w->n_moving; k++)
        w->newton_step[k] = k < n ? 1 + k % 7 - k % 3 : 0; /* attachments stay, and the pull on them must not change */
    for (int k = 0; k < DRIFT_ROUNDS; k++) {
        hf_newton_matrix_solve(m, w, NULL, 1, w->newton_step);
        if ((row = normalise_step(m, w)) < 0) return;
    }
    for (int side = -1; side <= 1 && r->n_drifting == 0; side += 2) {
        try_step(m, w, side * DRIFT_PART * hf_joint_mean_length_m(m));
        imbalance there = measure_imbalance(m, w, w->newton_trial_m, w->tension_N, w->newton_force_N);
        if (!(there.residual_N <= 1.001 * here.residual_N + DRIFT_NOTHING * m->reference_N)) continue;
        const double *f = w->newton_force_N + 3 * row; /* next to a weak cable elsewhere, all forces are small */
        if (!(sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]) <= DRIFT_FORCE * pull_at_row_N(m, w, row))) continue;
        if (!(there.length_gap <= 1.001 * here.length_gap + DRIFT_NOTHING)) continue;
        if (!(there.truss_m <= 1.001 * here.truss_m + HF_JOINT_NO_GAP_M)) continue;
        for (int i = 0; i < m->n_free; i++) {
            const double *d = w->newton_step + 3 * i;
            r->n_drifting += d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > DRIFT_PART * DRIFT_PART;
        }
        r->culprit = row;
        r->position_error_m = (double)NAN;
    }
}

double hf_newton_certify(const hf_model *m, hf_workspace *w, hf_form_result *r)
{
    double least = 0;
    int n_moving = w->n_moving;
    hf_status status = HF_OK;
    w->n_moving = m->n_free + m->n_attachment;
    measure_imbalance(m, w, w->position_m, w->tension_N, w->newton_force_N);
    if (!m->n_attachment && !r->n_loose) least = hf_newton_matrix_factor_below(m, w, &r->condition);
    if (!(least > 0)) {
        double spring_N_per_m = hf_joint_loose_spring_N_per_m(m);
        for (int i = 0; i < m->n_free; i++) /* a loose node has no stiffness of its own */
            w->spring_N_per_m[i] = w->loose[i] ? spring_N_per_m : 0;
        r->condition = (double)NAN;
        status = hf_joint_factor(m, w, hf_newton_matrix_block, w->spring_N_per_m, NULL, &r->condition);
    }
    if (status == HF_OK) solve_step_of(m, w);
    if (status == HF_OK && !r->n_loose) r->position_error_m = hf_joint_largest(w->n_moving, 1, w->newton_step, NULL);
    if (status != HF_OK) r->condition = (double)NAN;
    if (r->condition > DRIFT_CONDITION) look_for_drift(m, w, r);
    w->n_moving = n_moving;
    return least;
}
