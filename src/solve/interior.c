/* Contents: cones - state and start - errors - scaling - direction - step length - the path - the end
 *
 * The net as a second-order cone programme. A cable of the vector d between its ends, |d| <= v, pulls with a force t of
 * at most T:
 *
 *     (v, d) and (T, -t) in the cone |.| <= first,   T v - t.d = 0,
 *     T = T* (law tension),   v = L + c T (laws with a multiplier; c is 0 under law length, l0/EA of an elastic cable),
 *     sum of t + loads = 0 at every free node.
 *
 * A slack cable has T = 0 and v > |d|; a taut one t = T d/v and v = |d|. Cables of law force_density are springs,
 * t = q d. All equations but the product are linear, also where a cable is turned or shrinks to nothing, so that steps
 * are long from any start: this is what distinguishes the path from Newton's method on the energy. The product is
 * replaced by a small one, mu times the weight of the cable, and mu goes to zero. Directions are those of Nesterov and
 * Todd (SIAM J. Optim. 8, 1998), centring and second-order term those of Mehrotra (SIAM J. Optim. 2, 1992), as in
 * Andersen, Roos, Terlaky (Math. Program. B 95, 2003). Per cable the variables v, T, t are eliminated; what is left has
 * the form of the Newton matrix. */
#include "solve/interior.h"

#include "solve/history.h"
#include "solve/joint.h"
#include "solve/newton.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* In brackets: other values with which the tests of solve, stress and the elastic nets pass, or do not. The way through
 * the degenerate ones among these nets is narrow: many values lose one net. */
#define MU_FIRST 0.1      /* first mu over reference tension and mean length [1e-3 and 10 lose a net] */
#define STEP_KEPT 0.995   /* part of the way to the boundary of the cones [0.9 passes, 0.9999 does not] */
#define NEAR 1e-5         /* relative errors at which the end is tried first [1e-3 and 1e-7 lose nets] */
#define LEAST_WEIGHT 1e-4 /* tension in the weight of a cable, over the reference tension [1e-6 to 1e-2 pass] */
#define UNBALANCED 100.0  /* errors of balance may be larger than the others [1 to 1e4 pass] */
#define NEARER 30.0       /* how much smaller they are at each next try [3 and 1e3 lose nets] */
#define TRIES_MAX 4       /* [12 passes, 1 does not] */
#define STALLED 1e-7      /* a shorter step does not move [1e-4 passes, 1e-12 does not] */
#define FINAL_MAX 12      /* steps of one try at the end [4 and 60 lose nets] */
#define STIFFENING 1e7    /* of a taut cable of law length, at its tension or at LEAST_PULL [1e9 passes, 1e5 not] */
#define LEAST_PULL 1e-3   /* over the reference tension [0.1 passes, 1e-6 does not] */
#define FIRST_RANGE 10.0  /* first tension of an elastic cable, around the reference tension [1e6 passes, 1 not] */

typedef struct {
    double v, T, t[3];                /* state */
    double d[3];                      /* vector between the ends, m */
    double eta2, w0, w1[3];           /* scaling: W = eta (2 w w' - J)^(1/2), W^2 (T, -t) = (v, d) */
    double lambda0, lambda1[3], det;  /* W (T, -t) = W^-1 (v, d), and the root of its determinant */
    double along, across, unit[3];    /* K = across (I - uu') + along uu' */
    double flex, short_m;             /* c, and L + c T - v */
    double weight;                    /* of mu: tension times length, J */
    double R0, off[3];                /* of the right-hand side */
    double Dv, DT, Dt[3], Dd[3];      /* direction */
    double corrector0, corrector1[3]; /* second-order term */
} path_cable;

static_assert(sizeof(path_cable) == HF_INTERIOR_ITEMS * sizeof(double), "HF_INTERIOR_ITEMS");

/* ---- cones ---- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Root of the determinant a0^2 - |a1|^2 of a point in the cone; never zero. */
static double root_det(double a0, const double a1[3])
{
    double length = sqrt(dot(a1, a1)), det = (a0 - length) * (a0 + length);
    return sqrt(fmax(det, 1e-300));
}

/* b = W a */
static void scale(const path_cable *p, double a0, const double a1[3], double *b0, double b1[3])
{
    double eta = sqrt(p->eta2), inner = dot(p->w1, a1), share = a0 + inner / (1 + p->w0);
    *b0 = eta * (p->w0 * a0 + inner);
    for (int c = 0; c < 3; c++)
        b1[c] = eta * (a1[c] + share * p->w1[c]);
}

/* b = W^-1 a */
static void unscale(const path_cable *p, double a0, const double a1[3], double *b0, double b1[3])
{
    double eta = sqrt(p->eta2), inner = dot(p->w1, a1), share = inner / (1 + p->w0) - a0;
    *b0 = (p->w0 * a0 - inner) / eta;
    for (int c = 0; c < 3; c++)
        b1[c] = (a1[c] + share * p->w1[c]) / eta;
}

static void times_K(const path_cable *p, const double a[3], double b[3])
{
    double more = (p->along - p->across) * dot(p->unit, a);
    for (int c = 0; c < 3; c++)
        b[c] = p->across * a[c] + more * p->unit[c];
}

/* ---- state and start ---- */

static path_cable *cables(const hf_workspace *w)
{
    return (path_cable *)w->interior_cable;
}

static bool is_fixed(const hf_model *m, const hf_workspace *w, int e)
{
    return m->end_row[2 * e] >= w->n_moving && m->end_row[2 * e + 1] >= w->n_moving;
}

static bool has_multiplier(const hf_workspace *w, int e)
{
    return hf_law_has((hf_law)w->law[e], HF_LAW_HAS_MULTIPLIER);
}

/* A cable whose force is a linear function of the positions has no cone. */
static bool is_spring(const hf_workspace *w, int e)
{
    return !hf_law_has((hf_law)w->law[e], HF_LAW_HAS_MULTIPLIER | HF_LAW_GIVES_TENSION);
}

static void set_vector(const hf_model *m, const hf_workspace *w, int e, double d[3])
{
    int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
    for (int c = 0; c < 3; c++)
        d[c] = w->position_m[c * m->n_node + b] - w->position_m[c * m->n_node + a];
}

/* That of the law, else T with v = L + c T and T (v - l) = MU_FIRST times reference tension and length, within
 * FIRST_RANGE of the reference tension. */
static double first_tension_N(const hf_model *m, hf_law_cable cable, double flex, double length)
{
    if (hf_law_has(cable.law, HF_LAW_GIVES_TENSION)) return cable.target;
    double reference = m->reference_N;
    if (!(flex > 0)) return reference;
    double over = length - hf_law_wanted_length_m(cable, 0), mu = MU_FIRST * reference * cable.theoretical_m;
    double T = (over + sqrt(over * over + 4 * flex * mu)) / (2 * flex);
    return fmin(fmax(T, reference / FIRST_RANGE), reference * FIRST_RANGE);
}

/* A centred point for MU_FIRST at the theoretical shape. Errors of length and balance are left to the path. */
static void set_start(const hf_model *m, hf_workspace *w)
{
    double mean_m = hf_joint_mean_length_m(m);
    hf_form_place_supports(m, w);
    for (int e = 0; e < m->n_cable; e++) {
        path_cable *p = cables(w) + e;
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        memset(p, 0, sizeof *p);
        set_vector(m, w, e, p->d);
        double square = dot(p->d, p->d), length = sqrt(square);
        p->flex = has_multiplier(w, e) ? 1 / hf_law_stiffness_N_per_m(cable, INFINITY) : 0;
        if (is_spring(w, e)) {
            p->along = p->across = hf_law_tension_N(cable, 1);
            p->T = p->along * length;
        } else if (is_fixed(m, w, e)) {
            double over = has_multiplier(w, e) ? length - hf_law_wanted_length_m(cable, 0) : 0;
            p->T =
                p->flex > 0 ? fmax(over, 0) / p->flex : hf_law_held_q_N_per_m(cable, length, w->q_N_per_m[e]) * length;
            p->v = length;
        } else {
            p->T = first_tension_N(m, cable, p->flex, length);
            p->weight = mean_m * (has_multiplier(w, e) ? m->reference_N : fmax(p->T, LEAST_WEIGHT * m->reference_N));
            double over = MU_FIRST * p->weight / p->T;
            p->v = (over + sqrt(over * over + 4 * square)) / 2;
        }
        for (int c = 0; c < 3; c++)
            p->t[c] = is_spring(w, e) ? p->along * p->d[c] : p->T / p->v * p->d[c];
    }
}

/* ---- errors ---- */

typedef struct {
    double balance, length, gap; /* relative to reference tension and theoretical lengths */
    double truss_m;              /* between attachments and truss, as hf_joint_gap_m */
    double mu;
} path_error;

static double largest_force_N(const hf_model *m, const double *force)
{
    double largest = 0, scale_N = 1 / m->reference_N;
    for (int i = 0; i < m->n_free; i++) {
        double f[3] = {scale_N * force[3 * i], scale_N * force[3 * i + 1], scale_N * force[3 * i + 2]};
        double square = dot(f, f);
        if (!(square <= largest)) largest = square; /* keeps a NaN */
    }
    return sqrt(largest) * m->reference_N;
}

/* Sets newton_force_N to the forces out of balance, and d and short_m of the cables. */
static path_error measure_path(const hf_model *m, hf_workspace *w)
{
    path_error error = {0};
    double sum = 0, all = 0;
    hf_newton_matrix_set_loads(m, w, w->newton_force_N);
    for (int e = 0; e < m->n_cable; e++) {
        path_cable *p = cables(w) + e;
        if (is_fixed(m, w, e)) continue;
        set_vector(m, w, e, p->d);
        if (is_spring(w, e)) {
            for (int c = 0; c < 3; c++)
                p->t[c] = p->along * p->d[c];
        } else {
            sum += p->T * p->v - dot(p->t, p->d);
            all += p->weight;
        }
        hf_newton_matrix_add_pull(m, w, e, p->t, w->newton_force_N);
        if (!has_multiplier(w, e)) continue;
        p->short_m = hf_law_wanted_length_m(hf_workspace_cable(m, w, e), p->T) - p->v;
        error.length = fmax(error.length, fabs(p->short_m) / m->length_m[e]);
    }
    error.balance = largest_force_N(m, w->newton_force_N) / m->reference_N;
    error.truss_m = hf_joint_gap_m(m, w, w->position_m, w->newton_force_N, NULL);
    error.length = fmax(error.length, error.truss_m / hf_joint_mean_length_m(m));
    error.gap = error.mu = all > 0 ? sum / all : 0;
    return error;
}

/* ---- scaling ---- */

static void set_scaling(path_cable *p, bool multiplier)
{
    double s = root_det(p->v, p->d), z = root_det(p->T, p->t);
    double s0 = p->v / s, z0 = p->T / z, s1[3], z1[3], inner = 0;
    for (int c = 0; c < 3; c++) {
        s1[c] = p->d[c] / s;
        z1[c] = -p->t[c] / z;
        inner += s1[c] * z1[c];
    }
    double gamma = sqrt((1 + s0 * z0 + inner) / 2), square = 0;
    p->eta2 = s / z;
    p->det = sqrt(s * z);
    p->w0 = (s0 + z0) / (2 * gamma);
    p->lambda0 = gamma * p->det;
    for (int c = 0; c < 3; c++) {
        p->w1[c] = (s1[c] - z1[c]) / (2 * gamma);
        p->lambda1[c] = p->det * ((gamma + z0) * s1[c] + (gamma + s0) * z1[c]) / (s0 + z0 + 2 * gamma);
        square += p->w1[c] * p->w1[c];
    }
    double A = 1 + 2 * square, size = sqrt(square), c = p->flex;
    p->across = 1 / p->eta2;
    p->along = multiplier ? (p->eta2 * A + c) / (p->eta2 * (p->eta2 + c * A)) : 1 / (p->eta2 * A);
    for (int k = 0; k < 3; k++)
        p->unit[k] = size > 0 ? p->w1[k] / size : 0;
}

static void path_block(const hf_model *m, const hf_workspace *w, int e, double block[3][3])
{
    const path_cable *p = cables(w) + e;
    (void)m;
    hf_newton_matrix_spring(p->along, p->across, p->unit, block);
}

/* ---- direction ---- */

/* Sets R0 and off for the product `target`, over the weight, with the second-order terms if wanted. */
static void set_cable_side(path_cable *p, bool multiplier, double target, bool corrected)
{
    const double *l1 = p->lambda1;
    double l0 = p->lambda0, r0 = target * p->weight - l0 * l0 - dot(l1, l1), r1[3], q1[3], R1[3];
    for (int c = 0; c < 3; c++)
        r1[c] = -2 * l0 * l1[c];
    if (corrected) {
        r0 -= p->corrector0;
        for (int c = 0; c < 3; c++)
            r1[c] -= p->corrector1[c];
    }
    double q0 = (l0 * r0 - dot(l1, r1)) / (p->det * p->det); /* lambda o q = r */
    for (int c = 0; c < 3; c++)
        q1[c] = (r1[c] - q0 * l1[c]) / l0;
    scale(p, q0, q1, &p->R0, R1);
    double a = p->eta2 * (2 * p->w0 * p->w0 - 1), b = 2 * p->eta2 * p->w0;
    double share = multiplier ? b * (p->R0 - p->short_m) / (a + p->flex) : 0;
    for (int c = 0; c < 3; c++)
        p->off[c] = share * p->w1[c] - R1[c];
}

/* Change of the vector between the ends of a cable by newton_step. */
static void set_vector_step(const hf_model *m, const hf_workspace *w, int e, double step[3])
{
    int i = m->end_row[2 * e], j = m->end_row[2 * e + 1];
    for (int c = 0; c < 3; c++)
        step[c] = (j < w->n_moving ? w->newton_step[3 * j + c] : 0) - (i < w->n_moving ? w->newton_step[3 * i + c] : 0);
}

static void set_cable_direction(const hf_model *m, const hf_workspace *w, int e)
{
    path_cable *p = cables(w) + e;
    double y[3];
    set_vector_step(m, w, e, p->Dd);
    for (int c = 0; c < 3; c++)
        y[c] = p->Dd[c] + p->off[c];
    if (is_spring(w, e)) return;
    times_K(p, y, p->Dt);
    double a = p->eta2 * (2 * p->w0 * p->w0 - 1), turned = 2 * p->eta2 * p->w0 * dot(p->w1, p->Dt);
    bool multiplier = has_multiplier(w, e);
    p->DT = multiplier ? (p->R0 - p->short_m + turned) / (a + p->flex) : 0;
    p->Dv = multiplier ? p->flex * p->DT + p->short_m : p->R0 - a * p->DT + turned;
}

/* Sets newton_step and the D... of all cables. newton_band holds the factor. */
static void find_path_direction(const hf_model *m, hf_workspace *w, double target, bool corrected)
{
    double pull[3], *rhs = w->newton_step;
    memcpy(rhs, w->newton_force_N, 3 * (size_t)w->n_moving * sizeof *rhs);
    for (int e = 0; e < m->n_cable; e++) {
        path_cable *p = cables(w) + e;
        if (is_fixed(m, w, e) || is_spring(w, e)) continue;
        set_cable_side(p, has_multiplier(w, e), target, corrected);
        times_K(p, p->off, pull);
        hf_newton_matrix_add_pull(m, w, e, pull, rhs);
    }
    hf_joint_solve(m, w, path_block, rhs);
    for (int e = 0; e < m->n_cable; e++)
        if (!is_fixed(m, w, e)) set_cable_direction(m, w, e);
}

/* ---- step length ---- */

/* How many times the scaled direction fits between the scaled point and the boundary of the cone, inverted: <= 0
 * without end. */
static double inverse_room(const path_cable *p, double a0, const double a1[3])
{
    double l0 = p->lambda0 / p->det, l1[3], r1[3];
    for (int c = 0; c < 3; c++)
        l1[c] = p->lambda1[c] / p->det;
    double r0 = l0 * a0 - dot(l1, a1), share = (r0 + a0) / (l0 + 1);
    for (int c = 0; c < 3; c++)
        r1[c] = a1[c] - share * l1[c];
    return (sqrt(dot(r1, r1)) - r0) / p->det;
}

/* Largest part of the direction that stays in all cones. With `corrects` the second-order terms are set, too. */
static double find_room(const hf_model *m, hf_workspace *w, bool corrects)
{
    double inverse = 0;
    for (int e = 0; e < m->n_cable; e++) {
        path_cable *p = cables(w) + e;
        if (is_fixed(m, w, e) || is_spring(w, e)) continue;
        double minus[3] = {-p->Dt[0], -p->Dt[1], -p->Dt[2]}, s0, s1[3], z0, z1[3];
        unscale(p, p->Dv, p->Dd, &s0, s1);
        scale(p, p->DT, minus, &z0, z1);
        inverse = fmax(inverse, fmax(inverse_room(p, s0, s1), inverse_room(p, z0, z1)));
        if (!corrects) continue;
        p->corrector0 = s0 * z0 + dot(s1, z1);
        for (int c = 0; c < 3; c++)
            p->corrector1[c] = s0 * z1[c] + z0 * s1[c];
    }
    return inverse > 0 ? 1 / inverse : INFINITY;
}

static void move_nodes(const hf_model *m, hf_workspace *w, double part)
{
    for (int i = 0; i < w->n_moving; i++)
        for (int c = 0; c < 3; c++)
            w->position_m[c * m->n_node + i] += part * w->newton_step[3 * i + c];
}

static void move(const hf_model *m, hf_workspace *w, double part)
{
    move_nodes(m, w, part);
    for (int e = 0; e < m->n_cable; e++) {
        path_cable *p = cables(w) + e;
        if (is_fixed(m, w, e) || is_spring(w, e)) continue;
        p->v += part * p->Dv;
        p->T += part * p->DT;
        for (int c = 0; c < 3; c++)
            p->t[c] += part * p->Dt[c];
    }
}

/* ---- the path ---- */

/* The cable that is shorter than collapse_ratio, relatively the shortest, or -1. */
static int find_collapsed(const hf_model *m, const hf_form_settings *s, const hf_workspace *w)
{
    int worst = -1;
    double least = s->collapse_ratio;
    for (int e = 0; e < m->n_cable; e++) {
        const path_cable *p = cables(w) + e;
        double part = sqrt(dot(p->d, p->d)) / m->length_m[e];
        if (has_multiplier(w, e) || is_spring(w, e) || !(part < least)) continue;
        least = part;
        worst = e;
    }
    return worst;
}

/* A free node at a cable that is longer than HF_FORM_BLOWN_UP times its theoretical length, or -1. */
static int find_lost_row(const hf_model *m, const hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++) {
        const path_cable *p = cables(w) + e;
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        if (sqrt(dot(p->d, p->d)) > HF_FORM_BLOWN_UP * m->length_m[e]) return a < b ? a : b;
    }
    return -1;
}

static bool is_told_to_stop(const hf_workspace *w)
{
    return w->stop && *w->stop;
}

/* One step of the path. False when it does not move. */
static bool take_step(const hf_model *m, hf_workspace *w, double mu)
{
    for (int e = 0; e < m->n_cable; e++)
        if (!is_fixed(m, w, e) && !is_spring(w, e)) set_scaling(cables(w) + e, has_multiplier(w, e));
    if (hf_joint_factor(m, w, path_block, NULL) != HF_OK) return false;
    find_path_direction(m, w, 0, false);
    double part = fmin(1, find_room(m, w, true)), left = 1 - part;
    find_path_direction(m, w, left * left * left * mu, true);
    part = fmin(1, STEP_KEPT * find_room(m, w, false));
    if (!(part > STALLED)) return false;
    move(m, w, part);
    return true;
}

static void record_path(const hf_model *m, hf_workspace *w, const path_error *error)
{
    for (int e = 0; e < m->n_cable; e++)
        w->tension_N[e] = cables(w)[e].T;
    hf_history_add_step(m, w, error->balance * m->reference_N, error->length, error->truss_m);
}

/* Goes along the path until the errors are at most `wanted`. False when they are not after max_steps. */
static bool follow_path(const hf_model *m, hf_workspace *w, double wanted, int max_steps, int *n_step)
{
    for (bool stepped = false;; stepped = true) {
        path_error error = measure_path(m, w);
        if (stepped && w->history) record_path(m, w, &error);
        if (error.balance <= UNBALANCED * wanted && error.length <= wanted && error.gap <= wanted) return true;
        if (*n_step >= max_steps || is_told_to_stop(w) || !isfinite(error.balance)) return false;
        if (find_lost_row(m, w) >= 0) return false;
        ++*n_step;
        if (!take_step(m, w, error.mu)) return false;
    }
}

/* ---- the end: Newton's method on the taut cables; which are taut is decided anew in each step ---- */

/* Sets newton_force_N at position_m and tension_N, and per cable unit, along, across, and DT (the change of T for
 * the error of length alone). Returns the errors: lengths of taut cables, tensions left in slack ones. */
static path_error measure_end(const hf_model *m, hf_workspace *w)
{
    path_error error = {0};
    double reference = m->reference_N;
    hf_newton_matrix_set_loads(m, w, w->newton_force_N);
    for (int e = 0; e < m->n_cable; e++) {
        path_cable *p = cables(w) + e;
        if (is_fixed(m, w, e)) continue;
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        double length = hf_newton_matrix_direction(m, w->position_m, e, p->unit), pull[3];
        double T = hf_newton_matrix_tension_N(cable, length, w->tension_N[e]);
        p->DT = 0;
        p->along = has_multiplier(w, e) ? 0 : hf_law_stiffness_N_per_m(cable, length);
        if (has_multiplier(w, e)) {
            double over = length - hf_law_wanted_length_m(cable, T);
            bool is_taut = T / reference + over / m->length_m[e] > 0;
            double k = p->flex > 0 ? 1 / p->flex : STIFFENING * fmax(T, LEAST_PULL * reference) / m->length_m[e];
            p->along = is_taut ? k : 0;
            p->DT = is_taut ? k * over : -T;
            error.length = fmax(error.length, is_taut ? fabs(over) / m->length_m[e] : 0);
            error.gap = fmax(error.gap, is_taut ? -T / reference : fabs(T) / reference);
        }
        p->across = fmax(T, 0) / length;
        for (int c = 0; c < 3; c++)
            pull[c] = T * p->unit[c];
        hf_newton_matrix_add_pull(m, w, e, pull, w->newton_force_N);
    }
    error.balance = largest_force_N(m, w->newton_force_N) / reference;
    error.truss_m = hf_joint_gap_m(m, w, w->position_m, w->newton_force_N, NULL);
    return error;
}

static bool is_within(const path_error *error, const hf_form_settings *s, double part)
{
    return error->balance <= fmax(part * s->residual_tolerance, 1e-13) &&
           error->length <= fmax(part * s->length_tolerance, 1e-14) &&
           error->gap <= fmax(part * s->residual_tolerance, 1e-13) &&
           error->truss_m <= fmax(part * s->coupling.tof_m, HF_JOINT_NO_GAP_M);
}

static double largest_error(const hf_model *m, const path_error *error)
{
    return fmax(fmax(error->balance, error->length), fmax(error->gap, error->truss_m / hf_joint_mean_length_m(m)));
}

/* Moves position_m and tension_N by one Newton step. False when its matrix has no factor. */
static bool take_last_step(const hf_model *m, hf_workspace *w)
{
    double pull[3], *step = w->newton_step;
    if (hf_joint_factor(m, w, path_block, NULL) != HF_OK) return false;
    memcpy(step, w->newton_force_N, 3 * (size_t)w->n_moving * sizeof *step);
    for (int e = 0; e < m->n_cable; e++) {
        const path_cable *p = cables(w) + e;
        if (is_fixed(m, w, e)) continue;
        for (int c = 0; c < 3; c++)
            pull[c] = p->DT * p->unit[c];
        hf_newton_matrix_add_pull(m, w, e, pull, step);
    }
    hf_joint_solve(m, w, path_block, step);
    for (int e = 0; e < m->n_cable; e++) {
        const path_cable *p = cables(w) + e;
        if (is_fixed(m, w, e) || !has_multiplier(w, e)) continue;
        double longer[3];
        set_vector_step(m, w, e, longer);
        w->tension_N[e] += p->DT + p->along * dot(p->unit, longer);
    }
    move_nodes(m, w, 1);
    return true;
}

/* Tensions at the end of the path: of cables whose slack is larger than their tension, relatively, none. */
static void begin_end(const hf_model *m, hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++) {
        const path_cable *p = cables(w) + e;
        double slack = p->v - sqrt(dot(p->d, p->d));
        bool is_slack = has_multiplier(w, e) && !is_fixed(m, w, e) && p->T / m->reference_N <= slack / m->length_m[e];
        w->tension_N[e] = is_slack ? 0 : p->T;
    }
}

static void set_force_densities(const hf_model *m, hf_workspace *w)
{
    double u[3];
    for (int e = 0; e < m->n_cable; e++) {
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        double length = hf_newton_matrix_direction(m, w->position_m, e, u);
        double T = hf_newton_matrix_tension_N(cable, length, w->tension_N[e]);
        bool is_nothing = has_multiplier(w, e) && T < HF_NEWTON_NOTHING * m->reference_N;
        w->q_N_per_m[e] = is_nothing ? 0 : T / length;
        w->length_m[e] = length;
    }
}

/* Newton steps from the present point of the path, in position_m and tension_N alone, until the errors are a tenth of
 * the tolerances or fall no more. True when they are within the tolerances. */
static bool finish(const hf_model *m, const hf_form_settings *s, hf_workspace *w, int max_steps, int *n_step)
{
    begin_end(m, w);
    path_error now = measure_end(m, w);
    for (int k = 0; k < FINAL_MAX && *n_step < max_steps && !is_within(&now, s, 0.1); k++) {
        bool was_within = is_within(&now, s, 1);
        double before = largest_error(m, &now);
        memcpy(w->newton_trial_m, w->position_m, 3 * (size_t)m->n_node * sizeof(double));
        memcpy(w->newton_trial_tension_N, w->tension_N, (size_t)m->n_cable * sizeof(double));
        ++*n_step;
        if (!take_last_step(m, w)) return false;
        now = measure_end(m, w);
        hf_history_add_step(m, w, now.balance * m->reference_N, now.length, now.truss_m);
        if (!was_within || largest_error(m, &now) < before) continue;
        memcpy(w->position_m, w->newton_trial_m, 3 * (size_t)m->n_node * sizeof(double));
        memcpy(w->tension_N, w->newton_trial_tension_N, (size_t)m->n_cable * sizeof(double));
        return true;
    }
    return is_within(&now, s, 1);
}

static bool has_loaded_chain(const hf_model *m, hf_workspace *w)
{
    for (int i = 0; i < hf_form_n_chain(m); i++)
        if (hf_form_chain_is_loaded(m, w, i)) return true;
    return false;
}

hf_status hf_interior_run(const hf_model *m, const hf_form_settings *s, hf_workspace *w, int max_steps, int *n_step,
                          int *culprit)
{
    double wanted = NEAR;
    int last = *n_step + max_steps;
    *culprit = -1;
    set_start(m, w);
    for (int k = 0; k < TRIES_MAX; k++, wanted /= NEARER) {
        bool is_there = follow_path(m, w, wanted, last, n_step);
        if (is_told_to_stop(w)) return HF_INTERRUPTED;
        if ((*culprit = find_lost_row(m, w)) >= 0) return HF_SINGULAR;
        if (is_there && (*culprit = find_collapsed(m, s, w)) >= 0) return HF_COLLAPSED;
        memcpy(w->interior_position_m, w->position_m, 3 * (size_t)m->n_node * sizeof(double));
        bool is_found = finish(m, s, w, last, n_step);
        if (!is_found) memcpy(w->position_m, w->interior_position_m, 3 * (size_t)m->n_node * sizeof(double));
        set_force_densities(m, w);
        if (is_found) return HF_OK;
        if (has_loaded_chain(m, w)) return HF_STRAIGHT_CHAIN;
        if (!is_there) break;
    }
    return HF_NOT_CONVERGED;
}
