/* Contents: forces - matrix - one step - Newton from a shape - the alternation - certificate */
#include "solve/newton.h"

#include "linalg/band.h"

#include <math.h>
#include <string.h>

/* Stiffness of a length-controlled cable over its tension per length. The larger, the nearer to a hard constraint; the
 * forces never contain it, so it costs no accuracy in the residual. */
#define STIFFENING 1e7
#define FIRST_BLOCK 6        /* fixed-point iterations before Newton is tried; doubled after each failure */
#define STEPS_MAX 30         /* Newton steps per try */
#define DESCENT_MAX 300      /* steps per try on the energy of elastic cables */
#define HALVINGS_MAX 6       /* of one step */
#define TRUSTED_MAX 6        /* steps per try that may raise the merit */
#define TRUSTED_RISE 1e6     /* by no more than this factor */
#define FAR_EXCESS 16.0      /* a chain's excess length this many times too large: its tension is not near yet */
#define RESCALED_MAX 8       /* rounds of bringing it there */
#define ROUNDED_MAX 3        /* tries against rounding */
#define TENSION_KEPT 0.1     /* a step leaves at least this part of a multiplier */
#define DIAGONAL_GUARD 1e-14 /* Levenberg shift, relative to the largest diagonal, that is always there */
#define SHIFT_FIRST 1e-10    /* the first one after a failed factorisation */

static int dofs(const hf_model *m)
{
    return 3 * m->n_free;
}

static int half_bandwidth(const hf_model *m)
{
    return 3 * m->half_bandwidth + 2;
}

/* ---- forces ---- */

/* Length and unit vector of cable e at the shape x [3][n_node]. */
static double direction(const hf_model *m, const double *x, int e, double u[3])
{
    int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
    for (int c = 0; c < 3; c++)
        u[c] = x[c * m->n_node + b] - x[c * m->n_node + a];
    double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (int c = 0; c < 3; c++)
        u[c] /= length;
    return length;
}

static inline bool has_multiplier(hf_law_cable cable)
{
    return hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER);
}

/* The multiplier T where the law has one, else the tension that the law gives at this length. */
static inline double present_tension(hf_law_cable cable, double length, double T)
{
    return has_multiplier(cable) ? T : hf_law_tension_N(cable, length);
}

typedef struct {
    double residual_N; /* largest nodal force */
    double length_gap; /* largest length error, weighted by the pull of a cable that is too short */
    double merit;      /* what a step must lower: squares of forces over the reference tension, and of length errors */
} imbalance;

/* Nodal forces out of balance into force [3*row + c]: minus the gradient of Pi. */
static imbalance measure(const hf_model *m, const hf_workspace *w, const double *position_m, const double *T,
                         double *force)
{
    imbalance result = {0};
    double u[3], sum = 0, largest = 0, scale = 1 / m->reference_N; /* squares of tiny forces would vanish */
    for (int i = 0; i < m->n_free; i++)
        for (int c = 0; c < 3; c++)
            force[3 * i + c] = m->load_N ? m->load_N[c * m->n_node + i] : 0;
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        double length = direction(m, position_m, e, u), tension = present_tension(cable, length, T[e]);
        for (int c = 0; c < 3; c++) {
            if (a < m->n_free) force[3 * a + c] += tension * u[c];
            if (b < m->n_free) force[3 * b + c] -= tension * u[c];
        }
        if (!has_multiplier(cable)) continue;
        double gap = length / hf_law_wanted_length_m(cable, tension) - 1;
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
    return result;
}

/* ---- matrix ---- */

/* phi'' of a cable of this length; of a rigid one, of the stiff spring in its place. */
static inline double axial_stiffness(hf_law_cable cable, double length, double T)
{
    if (hf_law_has(cable.law, HF_LAW_IS_RIGID)) return STIFFENING * T / hf_law_wanted_length_m(cable, T);
    return hf_law_stiffness_N_per_m(cable, length);
}

/* How much a multiplier T changes in `part` of a step, which takes the cable of this length `beyond` the wanted one. */
static double tension_change(hf_law_cable cable, double length, double T, double part, double beyond)
{
    double k = axial_stiffness(cable, length, T);
    return k > 0 ? part * k * beyond : -part * T;
}

void hf_newton_block(const hf_model *m, const hf_workspace *w, int e, double block[3][3])
{
    hf_law_cable cable = hf_workspace_cable(m, w, e);
    double u[3], length = direction(m, w->position_m, e, u), T = present_tension(cable, length, w->tension_N[e]);
    double across = T / length, along = axial_stiffness(cable, length, T) - across;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            block[r][c] = along * u[r] * u[c] + (r == c ? across : 0);
}

/* The matrix at position_m, tension_N into newton_band; returns the largest diagonal entry. */
static double assemble(const hf_model *m, hf_workspace *w)
{
    int column = half_bandwidth(m) + 1;
    double *band = w->newton_band, block[3][3], largest = 0;
    memset(band, 0, (size_t)dofs(m) * (size_t)column * sizeof *band);
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1], low = a < b ? a : b, high = a < b ? b : a;
        if (low >= m->n_free) continue;
        hf_newton_block(m, w, e, block);
        for (int c = 0; c < 3; c++)
            for (int r = 0; r < 3; r++) {
                double k = block[r][c];
                double *diagonal = band + (r - c) + (size_t)(3 * low + c) * (size_t)column;
                if (r >= c) *diagonal += k;
                if (high >= m->n_free) continue;
                if (r >= c) diagonal[(size_t)(3 * (high - low)) * (size_t)column] += k;
                diagonal[3 * (high - low)] -= k;
            }
    }
    for (int i = 0; i < dofs(m); i++)
        largest = fmax(largest, band[(size_t)i * (size_t)column]);
    return largest;
}

static void shift_diagonal(const hf_model *m, hf_workspace *w, double shift)
{
    size_t column = (size_t)half_bandwidth(m) + 1;
    for (size_t i = 0; i < (size_t)dofs(m); i++)
        w->newton_band[i * column] += shift;
}

hf_status hf_newton_factor(const hf_model *m, hf_workspace *w, double *condition)
{
    int n = dofs(m), k = half_bandwidth(m);
    double shift = DIAGONAL_GUARD;
    for (;; shift = shift < SHIFT_FIRST ? SHIFT_FIRST : 100 * shift) {
        double largest = assemble(m, w);
        if (!(isfinite(largest) && largest > 0) || shift > 1) return HF_SINGULAR;
        shift_diagonal(m, w, shift * largest);
        double norm = condition ? hf_band_norm(n, k, w->newton_band, w->newton_work) : 0;
        if (hf_band_factor(n, k, w->newton_band) != 0) continue;
        if (condition)
            *condition = hf_band_condition(n, k, w->newton_band, norm, w->newton_work, w->newton_integer_work);
        if (condition && shift > DIAGONAL_GUARD) *condition = INFINITY;
        return HF_OK;
    }
}

/* ---- one step ---- */

/* Right-hand side with the tension steps eliminated: force plus what every multiplier changes by at its length. */
static void right_hand_side(const hf_model *m, const hf_workspace *w, const double *force, double *rhs)
{
    double u[3];
    memcpy(rhs, force, (size_t)dofs(m) * sizeof *rhs);
    for (int e = 0; e < m->n_cable; e++) {
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        if (!has_multiplier(cable)) continue;
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        double length = direction(m, w->position_m, e, u);
        double T = w->tension_N[e], beyond = length - hf_law_wanted_length_m(cable, T);
        double pull = tension_change(cable, length, T, 1, beyond);
        for (int c = 0; c < 3; c++) {
            if (a < m->n_free) rhs[3 * a + c] += pull * u[c];
            if (b < m->n_free) rhs[3 * b + c] -= pull * u[c];
        }
    }
}

/* The Newton step for the forces in newton_force_N, into newton_step; condition as in hf_newton_factor. */
static hf_status find_step(const hf_model *m, hf_workspace *w, double *condition)
{
    HF_TRY(hf_newton_factor(m, w, condition));
    right_hand_side(m, w, w->newton_force_N, w->newton_step);
    hf_band_back_solve(dofs(m), half_bandwidth(m), 1, w->newton_band, w->newton_step, dofs(m));
    return HF_OK;
}

/* Shape and multipliers after `part` of the step, into newton_trial_m and newton_trial_tension_N. */
static void try_step(const hf_model *m, hf_workspace *w, double part)
{
    const double *step = w->newton_step;
    double u[3];
    memcpy(w->newton_trial_m, w->position_m, 3 * (size_t)m->n_node * sizeof(double));
    memcpy(w->newton_trial_tension_N, w->tension_N, (size_t)m->n_cable * sizeof(double));
    for (int i = 0; i < m->n_free; i++)
        for (int c = 0; c < 3; c++)
            w->newton_trial_m[c * m->n_node + i] += part * step[3 * i + c];
    for (int e = 0; e < m->n_cable; e++) {
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        if (!has_multiplier(cable)) continue;
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        double length = direction(m, w->position_m, e, u), T = w->tension_N[e];
        double beyond = length - hf_law_wanted_length_m(cable, T);
        for (int c = 0; c < 3; c++) {
            if (a < m->n_free) beyond -= u[c] * step[3 * a + c];
            if (b < m->n_free) beyond += u[c] * step[3 * b + c];
        }
        double least = hf_law_has(cable.law, HF_LAW_GOES_SLACK) ? 0 : TENSION_KEPT * T;
        w->newton_trial_tension_N[e] = fmax(T + tension_change(cable, length, T, part, beyond), least);
    }
}

/* ---- Newton from a shape ---- */

static int is_balanced(const hf_model *m, const hf_form_settings *s, const imbalance *now)
{
    return now->residual_N <= s->residual_tolerance * m->reference_N && now->length_gap <= s->length_tolerance;
}

/* Newton steps from the workspace's shape and tensions while they help. On success q_N_per_m belongs to the new shape
 * and 1 is returned; else q_N_per_m is as it was. *n_step counts, up to max_steps. */
static int newton_steps(const hf_model *m, const hf_form_settings *s, hf_workspace *w, int max_steps, int *n_step)
{
    /* one more digit than asked for, so that the closing linear solve does not miss the tolerance by a hair */
    hf_form_settings tight = *s;
    tight.residual_tolerance = fmax(0.1 * s->residual_tolerance, 1e-13);
    tight.length_tolerance = fmax(0.1 * s->length_tolerance, 1e-14);
    imbalance now = measure(m, w, w->position_m, w->tension_N, w->newton_force_N), next = now;
    double first_merit = now.merit, u[3];
    int n_trusted = 0;
    for (int k = 0; k < max_steps && !is_balanced(m, &tight, &now); k++) {
        if (find_step(m, w, NULL) != HF_OK) break;
        double part = 1;
        int halvings = 0;
        for (; halvings <= HALVINGS_MAX; halvings++, part /= 2) {
            try_step(m, w, part);
            next = measure(m, w, w->newton_trial_m, w->newton_trial_tension_N, w->newton_force_N);
            if (next.merit < now.merit * (1 - 0.1 * part)) break; /* false for NaN */
        }
        ++*n_step;
        if (halvings > HALVINGS_MAX) {
            /* the merit need not fall on the way to tensions that are decades away: a few full steps on trust */
            if (++n_trusted > TRUSTED_MAX || is_balanced(m, s, &now)) break;
            try_step(m, w, 1);
            next = measure(m, w, w->newton_trial_m, w->newton_trial_tension_N, w->newton_force_N);
            if (!(next.merit < TRUSTED_RISE * now.merit)) break;
        }
        memcpy(w->position_m, w->newton_trial_m, 3 * (size_t)m->n_node * sizeof(double));
        memcpy(w->tension_N, w->newton_trial_tension_N, (size_t)m->n_cable * sizeof(double));
        now = next;
    }
    if (!(now.merit < first_merit)) return 0;
    for (int e = 0; e < m->n_cable; e++) {
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        double length = direction(m, w->position_m, e, u);
        double T = present_tension(cable, length, w->tension_N[e]);
        bool is_nothing = hf_law_has(cable.law, HF_LAW_GOES_SLACK) && T < HF_NEWTON_NOTHING * m->reference_N;
        w->q_N_per_m[e] = is_nothing ? 0 : T / length;
    }
    return 1;
}

/* ---- the alternation ---- */

/* The tension of a flat chain goes with the inverse root of its excess length, which lies decades away from where
 * Eq. 8 or Newton's linear model would look: scale its force densities to the excess that L* prescribes. Returns how
 * many chains were far from it. */
static int rescale_flat_chains(const hf_model *m, hf_workspace *w)
{
    int n_scaled = 0;
    for (int i = m->n_chain; i < m->n_any_chain; i++) {
        int first = m->chain_start[i], last = m->chain_start[i + 1] - 1, is_rigid = 1;
        double sum = 0, wanted = 0, u[3], *x = w->position_m;
        for (int k = first; k <= last; k++) {
            int e = m->chain_cable[k];
            is_rigid &= hf_law_has(w->law[e], HF_LAW_IS_RIGID);
            sum += direction(m, x, e, u);
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

/* First force densities unlike those of the case: the first shapes need not lie near the answer, and a cable that
 * shrinks to nothing in one of them proves nothing. */
static void start_elsewhere(const hf_model *m, hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++)
        if (hf_law_has(w->law[e], HF_LAW_ITERATES)) w->q_N_per_m[e] = m->start_q_N_per_m[e] * (1 + e % 3);
}

/* The fixed point knows little of elastic cables: the theoretical shape is the better start for them. */
static int start_elastic(const hf_model *m, const hf_form_settings *s, hf_workspace *w)
{
    int most = s->max_iterations < DESCENT_MAX ? s->max_iterations : DESCENT_MAX, n_step = 0;
    hf_form_place_supports(m, w);
    int n = hf_newton_descend(m, w, most);
    newton_steps(m, s, w, STEPS_MAX, &n_step);
    return n + n_step;
}

hf_status hf_newton_find(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_history *history,
                         hf_form_result *result)
{
    int n_done = 0, n_rescaled = 0, n_rounded = 0, n_restarted = 0, block = FIRST_BLOCK;
    if (m->EA_N) n_done = start_elastic(m, s, w);
    for (;;) {
        hf_form_settings part = *s;
        int left = s->max_iterations - n_done;
        part.max_iterations = left < 1 ? 1 : block < left ? block : left; /* the shape of the last step is measured */
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
        if (m->EA_N) n_done += hf_newton_descend(m, w, left < DESCENT_MAX ? left : DESCENT_MAX);
        left = s->max_iterations - n_done < STEPS_MAX ? s->max_iterations - n_done : STEPS_MAX;
        int has_moved = newton_steps(m, s, w, left, &n_step);
        n_done += n_step;
        /* a linear solve would round the shape anew, by the condition of D */
        if (has_moved && hf_form_measure(m, s, w, result) == HF_OK) {
            hf_form_accept(m, s, HF_STOPPED_RESIDUAL, n_done, w, result);
            break;
        }
        block = has_moved ? FIRST_BLOCK : 2 * block; /* after a failure the fixed point goes on */
    }
    result->iterations = n_done;
    return result->status;
}

/* ---- certificate ---- */

void hf_newton_certify(const hf_model *m, hf_workspace *w, hf_form_result *r)
{
    measure(m, w, w->position_m, w->tension_N, w->newton_force_N);
    if (find_step(m, w, &r->condition) != HF_OK) return;
    double largest = 0;
    for (int i = 0; i < m->n_free; i++) {
        const double *d = w->newton_step + 3 * i;
        double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (!(square <= largest)) largest = square; /* keeps a NaN */
    }
    r->position_error_m = sqrt(largest);
}
