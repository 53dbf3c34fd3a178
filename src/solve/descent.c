#include "solve/descent.h"

#include "solve/newton.h"
#include "solve/newton_matrix.h"

#include <math.h>
#include <string.h>

/* Behind each: the range over which the tests of solve pass, the property tests on nets of elastic cables included. */
#define PENALTY 1e3     /* EA of the elastic cable in place of one under law length, over reference_N; 10 to 1e6 */
#define SLOPE_KEPT 1e-4 /* fraction of the decrease of Pi to first order that a step must reach (Armijo); 1e-6 to 0.1 */
#define HALVINGS_MAX 30 /* lengths tried for one step, each half of the one before; 30 to 100, 10 fails */
#define NEAR 1e-3       /* imbalance over the reference tension where hf_newton_run takes over; 1e-6 to 0.1, 1 fails */
#define FARTHEST 0.5    /* largest move of a node in one step, over the longest cable; 0.005 to 50 */
#define ROUNDING 1e-15  /* a relative decrease of Pi up to this is rounding; 0 to 1e-11: the same steps */

/* Replaces law length by law elastic for the descent; harden takes it back. */
static void soften(const hf_model *m, hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++) {
        if (!hf_law_has(w->law[e], HF_LAW_IS_RIGID)) continue;
        w->law[e] = HF_LAW_ELASTIC;
        w->EA_N[e] = PENALTY * m->reference_N;
    }
}

static void harden(const hf_model *m, hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++)
        if (hf_law_has(m->law[e], HF_LAW_IS_RIGID) && w->law[e] == HF_LAW_ELASTIC) w->law[e] = m->law[e];
}

static void vector(const hf_model *m, const double *x, int e, double d[3])
{
    for (int c = 0; c < 3; c++)
        d[c] = x[c * m->n_node + m->end_row[2 * e + 1]] - x[c * m->n_node + m->end_row[2 * e]];
}

static double norm(const double d[3])
{
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* Pi at `to` minus Pi at `from`, from differences without cancellation. *scale: sum of the cables' absolute changes. */
static double energy_change(const hf_model *m, const hf_workspace *w, const double *from, const double *to,
                            double *scale)
{
    double sum = 0;
    *scale = 0;
    for (int e = 0; e < m->n_cable; e++) {
        double a[3], b[3], square = 0;
        vector(m, from, e, a);
        vector(m, to, e, b);
        for (int c = 0; c < 3; c++)
            square += (b[c] - a[c]) * (b[c] + a[c]);
        double change = hf_law_energy_change_J(hf_workspace_cable(m, w, e), norm(a), norm(b), square);
        sum += change;
        *scale += fabs(change);
    }
    for (int k = 0; m->load_N && k < 3 * m->n_node; k++)
        if (k % m->n_node < m->n_free) sum -= m->load_N[k] * (to[k] - from[k]);
    return sum;
}

/* Sets tension_N and q_N_per_m by the laws and newton_force_N to the forces out of balance. Returns the largest one. */
static double apply_laws(const hf_model *m, hf_workspace *w)
{
    double *force = w->newton_force_N, largest = 0;
    for (int i = 0; i < m->n_free; i++)
        for (int c = 0; c < 3; c++)
            force[3 * i + c] = m->load_N ? m->load_N[c * m->n_node + i] : 0;
    for (int e = 0; e < m->n_cable; e++) {
        double d[3];
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        vector(m, w->position_m, e, d);
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        double length = norm(d), T = w->tension_N[e] = hf_law_tension_N(cable, length);
        bool is_nothing = hf_law_has(cable.law, HF_LAW_GOES_SLACK) && T < HF_NEWTON_NOTHING * m->reference_N;
        w->q_N_per_m[e] = is_nothing ? 0 : T / length;
        for (int c = 0; c < 3; c++) {
            if (a < m->n_free) force[3 * a + c] += w->q_N_per_m[e] * d[c];
            if (b < m->n_free) force[3 * b + c] -= w->q_N_per_m[e] * d[c];
        }
    }
    for (int i = 0; i < m->n_free; i++)
        largest = fmax(largest, norm(force + 3 * i));
    return largest;
}

static double longest_m(const hf_model *m)
{
    double longest = 0;
    for (int e = 0; e < m->n_cable; e++)
        longest = fmax(longest, m->length_m[e]);
    return longest;
}

/* Fraction of newton_step that moves no node farther than FARTHEST allows. */
static double limit_step(const hf_model *m, const hf_workspace *w)
{
    double farthest = 0, most = FARTHEST * longest_m(m);
    for (int i = 0; i < m->n_free; i++)
        farthest = fmax(farthest, norm(w->newton_step + 3 * i));
    return farthest > most ? most / farthest : 1;
}

/* Moves along newton_step by the first of the halved steps that lowers Pi enough. False when none does, or when Pi
 * fell by no more than rounding. */
static bool search_line(const hf_model *m, hf_workspace *w)
{
    double promised = 0, scale, *to = w->newton_trial_m;
    for (int k = 0; k < 3 * m->n_free; k++)
        promised += w->newton_force_N[k] * w->newton_step[k];
    double part = limit_step(m, w);
    for (int n = 0; n < HALVINGS_MAX; n++, part /= 2) {
        memcpy(to, w->position_m, 3 * (size_t)m->n_node * sizeof *to);
        for (int i = 0; i < m->n_free; i++)
            for (int c = 0; c < 3; c++)
                to[c * m->n_node + i] += part * w->newton_step[3 * i + c];
        double change = energy_change(m, w, w->position_m, to, &scale);
        if (!(change <= -SLOPE_KEPT * part * promised)) continue; /* also for NaN */
        memcpy(w->position_m, to, 3 * (size_t)m->n_node * sizeof *to);
        return -change > ROUNDING * scale;
    }
    return false;
}

/* Newton's direction into newton_step. Without a matrix, because all cables are slack, the direction of the forces. */
static void find_direction(const hf_model *m, hf_workspace *w)
{
    int n_dof = 3 * m->n_free;
    bool has_matrix = hf_newton_matrix_factor(m, w, NULL) == HF_OK;
    memcpy(w->newton_step, w->newton_force_N, (size_t)n_dof * sizeof(double));
    if (has_matrix)
        hf_newton_matrix_solve(m, w, w->newton_step);
    else
        for (int k = 0; k < n_dof; k++)
            w->newton_step[k] *= longest_m(m) / m->reference_N;
}

int hf_descent_run(const hf_model *m, hf_workspace *w, int max_steps)
{
    int n = 0;
    soften(m, w);
    while (apply_laws(m, w) > NEAR * m->reference_N && n < max_steps) {
        find_direction(m, w);
        n++;
        if (!search_line(m, w)) break;
    }
    apply_laws(m, w);
    harden(m, w);
    return n;
}
