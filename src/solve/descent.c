#include "solve/descent.h"

#include "solve/newton.h"
#include "solve/newton_matrix.h"

#include <math.h>
#include <string.h>

#define PENALTY 1e3     /* a cable under law length is one of EA = PENALTY reference_N here */
#define SLOPE_KEPT 1e-4 /* part of the promised decrease of Pi that a step must bring */
#define HALVINGS_MAX 30 /* of one step */
#define NEAR 1e-3       /* imbalance over the reference tension that is left to the steps with multipliers */
#define FARTHEST 0.5    /* move of a node in one step, relative to the longest cable */
#define ROUNDING 1e-15  /* relative decrease of Pi that means nothing */

/* Cables under law length are springs here, and no longer afterwards. */
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

/* Pi at `to` less Pi at `from`, by differences that lose no digits; *scale: the size of what is added up. */
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

/* Tensions by law into tension_N and q_N_per_m, the forces out of balance into newton_force_N; returns the largest. */
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

/* The step in newton_step, shortened so that no node jumps over the net; returns how much of it is left. */
static double limit_step(const hf_model *m, const hf_workspace *w)
{
    double farthest = 0, most = FARTHEST * longest_m(m);
    for (int i = 0; i < m->n_free; i++)
        farthest = fmax(farthest, norm(w->newton_step + 3 * i));
    return farthest > most ? most / farthest : 1;
}

/* Move along newton_step as far as Pi falls enough. Returns 0 when it does not. */
static int search_line(const hf_model *m, hf_workspace *w)
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
    return 0;
}

/* Newton's direction into newton_step; that of the forces where every cable hangs loose and there is no matrix. */
static void find_direction(const hf_model *m, hf_workspace *w)
{
    int n_dof = 3 * m->n_free, has_matrix = hf_newton_matrix_factor(m, w, NULL) == HF_OK;
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
