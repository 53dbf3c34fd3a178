/* Finds the shape of minimum energy from the target positions by a primal-dual interior method (METHOD section 5).
 *
 *     start: target positions, a centred point for mu = MU_FIRST
 *         |
 *         v
 *     path: steps with mu -> 0 until the errors are at most `wanted`  <------+
 *         | collapsed, or not held: refused with the cable or row            |
 *         v                                                                  |
 *     end: decide which cables are slack, Newton steps on the taut ones      |
 *         | within the tolerances: HF_OK                                     |
 *         +-- not found: wanted / NEARER, at most TRIES_MAX times -----------+
 *
 * The net is a second-order cone programme. A cable with the vector d between its ends, |d| <= v, pulls with a force t
 * of at most T:
 *
 *     (v, d) and (T, -t) in the cone |.| <= first,   T v - t.d = 0,
 *     T = T* (law tension),   v = L + c T (laws with a multiplier; c is 0 under law length, l0/EA of an elastic cable),
 *     sum of t + loads = 0 at every free node.
 *
 * A slack cable has T = 0 and v > |d|. A taut cable has t = T d/v and v = |d|. Cables of law force_density are springs,
 * t = q d. All equations except the product T v - t.d = 0 are linear, even if a cable turns or shrinks to nothing.
 * Steps are therefore long from any start, unlike those of Newton's method on the energy. The product is set to mu
 * times the weight of the cable, and mu goes to zero.
 *
 * Directions are those of Nesterov and Todd (SIAM J. Optim. 8, 1998). Centring and second-order term are those of
 * Mehrotra (SIAM J. Optim. 2, 1992), as in Andersen, Roos, Terlaky (Math. Program. B 95, 2003). The variables v, T and
 * t of each cable are eliminated. The remaining matrix has the form of the Newton matrix. */
#include "solve/interior.h"

#include "solve/history.h"
#include "solve/joint.h"
#include "solve/newton.h"
#include "solve/path_kernel.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Brackets show other values with which the tests of solve, stress and the elastic nets pass, or which lose nets. These
 * tests include degenerate nets, and many other values lose one of them. */
#define MU_FIRST 0.1      /* first mu over reference tension and mean length [1e-3 passes, 10 loses nets] */
#define STEP_KEPT 0.995   /* part of the way to the boundary of the cones [0.9 and 0.9999 lose a net] */
#define NEAR 1e-5         /* relative errors at which the end is first tried [1e-3 and 1e-7 lose nets] */
#define LEAST_WEIGHT 1e-4 /* minimum tension in the weight of a cable, over the reference tension [1e-6 to 1e-2 pass] */
#define UNBALANCED 100.0  /* allowed ratio of balance errors to the others [1 loses a net, 1e4 passes] */
#define NEARER 30.0       /* factor between the errors of two tries [3 and 1e3 lose nets] */
#define TRIES_MAX 8       /* maximum tries [4 and 12 pass] */
#define STALLED 1e-7      /* a step below this part of its direction counts as none [1e-4 and 1e-12 pass] */
#define STANDING_MAX 3    /* steps near the end that do not halve the errors [1 and 8 pass; no bound: all are used] */
#define FINAL_MAX 12      /* maximum steps of one try at the end [4 loses nets, 60 passes] */
#define LAST_MAX 40       /* maximum steps of the last try [12 solves fewer nets of stiff cables] */
#define CLEARLY 0.1       /* part of the errors left by a later step at the end, unless last try [0.03 loses a net] */
#define FAR 1.0           /* maximum error after the first step at the end [0.1 passes; no bound: more steps] */
#define DAMPING 1.0       /* damping at an error of 1, over tension and mean length, once errors rise [0: more steps] */
#define CLEAR_FALL 0.1 /* fall of mu from which the fall of a tension shows whether the cable is slack [0 loses nets] */
#define FIRST_RANGE 10.0 /* maximum factor from the reference to an elastic cable's first tension [1 and 1e6 pass] */

/* ---- state and start ---- */

static_assert(sizeof(hf_path_cables) == HF_INTERIOR_BLOCK * sizeof(double), "HF_INTERIOR_BLOCK");

static const hf_path_kernels *const kernels_of_isa[] = {HF_LANE_EACH(&hf_path_kernels)};

static int n_block(const hf_model *m)
{
    return (m->n_cable + HF_LANES - 1) / HF_LANES;
}

static hf_path_cables *blocks(const hf_workspace *w)
{
    return (hf_path_cables *)w->interior_cable;
}

/* Returns the block of eight that contains cable e, and sets *lane to its lane. */
static hf_path_cables *block_of(const hf_workspace *w, int e, int *lane)
{
    *lane = e % HF_LANES;
    return blocks(w) + e / HF_LANES;
}

/* Returns the squared length of the vector between the ends of cable e, m^2. */
static double path_square(const hf_workspace *w, int e)
{
    int k;
    const hf_path_cables *p = block_of(w, e, &k);
    return p->d[0][k] * p->d[0][k] + p->d[1][k] * p->d[1][k] + p->d[2][k] * p->d[2][k];
}

static double path_length_m(const hf_workspace *w, int e)
{
    return sqrt(path_square(w, e));
}

static bool is_fixed(const hf_model *m, const hf_workspace *w, int e)
{
    return m->end_row[2 * e] >= w->n_moving && m->end_row[2 * e + 1] >= w->n_moving;
}

static bool has_multiplier(const hf_workspace *w, int e)
{
    return hf_law_has((hf_law)w->law[e], HF_LAW_HAS_MULTIPLIER);
}

/* Returns true if the force of the cable is a linear function of the positions. Such a cable has no cone. */
static bool is_spring(const hf_workspace *w, int e)
{
    return hf_newton_matrix_is_spring((hf_law)w->law[e]);
}

static void set_vector(const hf_model *m, const hf_workspace *w, int e)
{
    int k, a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
    hf_path_cables *p = block_of(w, e, &k);
    for (int c = 0; c < 3; c++)
        p->d[c][k] = w->position_m[c * m->n_node + b] - w->position_m[c * m->n_node + a];
}

/* Returns the first tension of a cable, N: that of its law, or for a law length the reference tension. For an elastic
 * cable it solves v = L + c T and T (v - l) = MU_FIRST times reference tension and length. The result is within a
 * factor of FIRST_RANGE of the reference tension. */
static double first_tension_N(const hf_model *m, hf_law_cable cable, double flex, double length)
{
    if (hf_law_has(cable.law, HF_LAW_GIVES_TENSION)) return cable.target;
    double reference = m->reference_N;
    if (!(flex > 0)) return reference;
    double over = length - hf_law_required_length_m(cable, 0), mu = MU_FIRST * reference * cable.length_at_target_m;
    double T = (over + sqrt(over * over + 4 * flex * mu)) / (2 * flex);
    return fmin(fmax(T, reference / FIRST_RANGE), reference * FIRST_RANGE);
}

/* In the functions below, `held` are the moving rows among fixed ones, NULL without springs to the ground. */

/* Sets a centred point for MU_FIRST at the target positions, or at spring_anchor_m with `held`. The path then reduces
 * its errors of length and balance. */
static void set_start(const hf_model *m, hf_workspace *w, const hf_newton_rows *held)
{
    double mean_m = hf_joint_mean_length_m(m);
    if (held)
        memcpy(w->position_m, w->spring_anchor_m, 3 * (size_t)m->n_node * sizeof(double));
    else
        hf_form_set_supports(m, w);
    memset(blocks(w), 0, (size_t)n_block(m) * sizeof *blocks(w));
    for (int e = 0; e < m->n_cable; e++) {
        int k;
        hf_path_cables *p = block_of(w, e, &k);
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        set_vector(m, w, e);
        double square = path_square(w, e), length = sqrt(square);
        p->has_cone[k] = !is_fixed(m, w, e) && !is_spring(w, e);
        p->has_multiplier[k] = p->has_cone[k] != 0 && has_multiplier(w, e);
        p->target[k] = cable.target;
        p->EA[k] = hf_law_has(cable.law, HF_LAW_NEEDS_EA) ? cable.EA_N : INFINITY;
        p->theoretical[k] = cable.length_at_target_m;
        p->flex[k] = has_multiplier(w, e) ? 1 / hf_law_stiffness_N_per_m(cable, INFINITY) : 0;
        if (is_spring(w, e)) {
            p->along[k] = p->across[k] = hf_law_tension_N(cable, 1);
            p->T[k] = p->along[k] * length;
        } else if (is_fixed(m, w, e)) {
            double over = has_multiplier(w, e) ? length - hf_law_required_length_m(cable, 0) : 0;
            p->T[k] = p->flex[k] > 0 ? fmax(over, 0) / p->flex[k]
                                     : hf_law_held_q_N_per_m(cable, length, w->q_N_per_m[e]) * length;
            p->v[k] = length;
        } else {
            p->T[k] = first_tension_N(m, cable, p->flex[k], length);
            p->weight[k] =
                mean_m * (has_multiplier(w, e) ? m->reference_N : fmax(p->T[k], LEAST_WEIGHT * m->reference_N));
            double over = MU_FIRST * p->weight[k] / p->T[k];
            p->v[k] = (over + sqrt(over * over + 4 * square)) / 2;
        }
        for (int c = 0; c < 3; c++)
            p->t[c][k] = is_spring(w, e) ? p->along[k] * p->d[c][k] : p->T[k] / p->v[k] * p->d[c][k];
    }
}

/* ---- errors ---- */

typedef struct {
    double balance, length, gap; /* relative to reference tension and lengths at target positions */
    double truss_m;              /* as hf_joint_gap_m */
    double mu;
} path_error;

static double largest_force_N(const hf_model *m, const double *force)
{
    return hf_joint_largest(m->n_free, 1 / m->reference_N, force, NULL) * m->reference_N;
}

/* Adds the pull of the springs at the rows to newton_force_N. A fixed row is in balance. */
static void add_springs_pull(const hf_model *m, hf_workspace *w)
{
    for (int k = 0; k < hf_newton_matrix_dofs(m); k++) {
        double spring = w->spring_N_per_m[k / 3], *force = w->newton_force_N + k;
        int at = k % 3 * m->n_node + k / 3;
        *force = isinf(spring) ? 0 : *force + spring * (w->spring_anchor_m[at] - w->position_m[at]);
    }
}

/* Measures the point of the path. Sets newton_force_N to the forces out of balance, N, and d, t of springs, gap and
 * short_m of the cables. Returns the errors and mu. */
static path_error measure_path(const hf_model *m, hf_workspace *w, const hf_newton_rows *held)
{
    path_error error = {0};
    double sum = 0, all = 0;
    for (int e = 0; e < m->n_cable; e++)
        if (!is_fixed(m, w, e)) set_vector(m, w, e);
    error.length = kernels_of_isa[hf_lane_best_isa()]->measure(n_block(m), blocks(w));
    hf_newton_matrix_set_loads(m, w, w->newton_force_N);
    for (int e = 0; e < m->n_cable; e++) {
        int k;
        const hf_path_cables *p = block_of(w, e, &k);
        if (is_fixed(m, w, e)) continue;
        if (p->has_cone[k] != 0) {
            sum += p->gap[k];
            all += p->weight[k];
        }
        double pull[3] = {p->t[0][k], p->t[1][k], p->t[2][k]};
        hf_newton_matrix_add_pull(m, w, e, pull, w->newton_force_N);
    }
    if (held) add_springs_pull(m, w);
    error.balance = largest_force_N(m, w->newton_force_N) / m->reference_N;
    error.truss_m = hf_joint_gap_m(m, w, w->position_m, w->newton_force_N, NULL);
    error.length = fmax(error.length, error.truss_m / hf_joint_mean_length_m(m));
    error.gap = error.mu = all > 0 ? sum / all : 0;
    return error;
}

/* ---- direction ---- */

static void path_block(const hf_model *m, const hf_workspace *w, int e, double block[3][3])
{
    int k;
    const hf_path_cables *p = block_of(w, e, &k);
    double unit[3] = {p->unit[0][k], p->unit[1][k], p->unit[2][k]};
    (void)m;
    hf_newton_matrix_spring(p->along[k], p->across[k], unit, block);
}

/* Sets Dd, the change of the vector between the ends of cable e by newton_step. */
static void set_vector_step(const hf_model *m, const hf_workspace *w, int e)
{
    int k, i = m->end_row[2 * e], j = m->end_row[2 * e + 1];
    hf_path_cables *p = block_of(w, e, &k);
    for (int c = 0; c < 3; c++)
        p->Dd[c][k] =
            (j < w->n_moving ? w->newton_step[3 * j + c] : 0) - (i < w->n_moving ? w->newton_step[3 * i + c] : 0);
}

/* Sets newton_step and the direction of all cables for mu = `target`; newton_band holds the factor. With `corrected` it
 * uses the second-order terms, with `corrects` it sets them. Returns the maximum part of the direction that stays in
 * all cones. */
static double find_path_direction(const hf_model *m, hf_workspace *w, const hf_newton_rows *held, double target,
                                  bool corrected, bool corrects)
{
    double *rhs = w->newton_step;
    memcpy(rhs, w->newton_force_N, 3 * (size_t)w->n_moving * sizeof *rhs);
    kernels_of_isa[hf_lane_best_isa()]->set_side(n_block(m), blocks(w), target, corrected);
    for (int e = 0; e < m->n_cable; e++) {
        int k;
        const hf_path_cables *p = block_of(w, e, &k);
        if (!(p->has_cone[k] != 0)) continue;
        double pull[3] = {p->pull[0][k], p->pull[1][k], p->pull[2][k]};
        hf_newton_matrix_add_pull(m, w, e, pull, rhs);
    }
    hf_joint_solve(m, w, path_block, held, w->newton_step);
    for (int e = 0; e < m->n_cable; e++)
        if (!is_fixed(m, w, e)) set_vector_step(m, w, e);
    double inverse = kernels_of_isa[hf_lane_best_isa()]->set_direction(n_block(m), blocks(w), corrects);
    return inverse > 0 ? 1 / inverse : INFINITY;
}

/* ---- the path ---- */

/* Returns the cable that is shorter than collapse_ratio times its length at the target positions, or -1. Of several it
 * returns the relatively shortest. */
static int find_collapsed(const hf_model *m, const hf_form_settings *s, const hf_workspace *w)
{
    int worst = -1;
    double least = s->collapse_ratio;
    for (int e = 0; e < m->n_cable; e++) {
        double part = path_length_m(w, e) / m->length_m[e];
        if (has_multiplier(w, e) || is_spring(w, e) || !(part < least)) continue;
        least = part;
        worst = e;
    }
    return worst;
}

/* Returns a free node at a cable that is longer than HF_FORM_BLOWN_UP times its length at the target positions, or
 * -1. */
static int find_lost_row(const hf_model *m, const hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        if (path_length_m(w, e) > HF_FORM_BLOWN_UP * m->length_m[e]) return a < b ? a : b;
    }
    return -1;
}

static bool is_told_to_stop(const hf_workspace *w)
{
    return w->stop && *w->stop;
}

/* Takes one step of the path. Returns false if it does not move. */
static bool take_step(const hf_model *m, hf_workspace *w, const hf_newton_rows *held, double mu)
{
    kernels_of_isa[hf_lane_best_isa()]->set_scaling(n_block(m), blocks(w));
    if (hf_joint_factor(m, w, path_block, held ? w->spring_N_per_m : NULL, held, NULL) != HF_OK) return false;
    double part = fmin(1, find_path_direction(m, w, held, 0, false, true)), left = 1 - part;
    part = fmin(1, STEP_KEPT * find_path_direction(m, w, held, left * left * left * mu, true, false));
    if (!(part > STALLED)) return false;
    hf_newton_matrix_move_nodes(m, w, part, w->position_m);
    kernels_of_isa[hf_lane_best_isa()]->move(n_block(m), blocks(w), part);
    return true;
}

static void record_path(const hf_model *m, hf_workspace *w, const path_error *error)
{
    for (int e = 0; e < m->n_cable; e++)
        w->tension_N[e] = blocks(w)[e / HF_LANES].T[e % HF_LANES];
    hf_history_add_step(m, w, error->balance * m->reference_N, error->length, error->truss_m);
}

/* Follows the path until the errors are at most `wanted`. Returns false if they are larger after max_steps, or if they
 * are near and no longer fall because of rounding. *fall becomes mu over that before the last step. */
static bool follow_path(const hf_model *m, hf_workspace *w, const hf_newton_rows *held, double wanted, int max_steps,
                        int *n_step, double *fall)
{
    double mu_before = INFINITY, least = INFINITY;
    int n_standing = 0;
    for (bool stepped = false;; stepped = true) {
        path_error error = measure_path(m, w, held);
        if (stepped && w->history && !held) record_path(m, w, &error);
        if (isfinite(mu_before)) *fall = error.mu / mu_before;
        if (error.balance <= UNBALANCED * wanted && error.length <= wanted && error.gap <= wanted) return true;
        if (*n_step >= max_steps || is_told_to_stop(w) || !isfinite(error.balance)) return false;
        if (find_lost_row(m, w) >= 0) return false;
        double largest = fmax(fmax(error.balance / UNBALANCED, error.length), error.gap);
        n_standing = largest < 0.5 * least ? 0 : n_standing + 1;
        if (n_standing == 0) least = largest;
        if (n_standing > STANDING_MAX && wanted < NEAR) return false;
        ++*n_step;
        mu_before = error.mu;
        if (!take_step(m, w, held, error.mu)) return false;
    }
}

/* ---- the end: Newton's method on the taut cables; which are taut is decided anew in each step ---- */

/* Measures the shape position_m with tension_N. Sets newton_force_N, and unit, along and across of each cable. DT
 * becomes the change of T for the error of length alone. Returns the errors: lengths of taut cables, and tensions left
 * in slack ones. */
static path_error measure_end(const hf_model *m, hf_workspace *w, const hf_newton_rows *held)
{
    path_error error = {0};
    double reference = m->reference_N;
    hf_newton_matrix_set_loads(m, w, w->newton_force_N);
    for (int e = 0; e < m->n_cable; e++) {
        int at;
        hf_path_cables *p = block_of(w, e, &at);
        p->along[at] = p->across[at] = p->DT[at] = 0;
        if (is_fixed(m, w, e)) continue;
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        double unit[3], length = hf_newton_matrix_direction(m, w->position_m, e, unit), pull[3];
        double T = hf_newton_matrix_tension_N(cable, length, w->tension_N[e]);
        p->along[at] = has_multiplier(w, e) ? 0 : hf_law_stiffness_N_per_m(cable, length);
        if (has_multiplier(w, e)) {
            double over = length - hf_law_required_length_m(cable, T);
            bool is_taut = T / reference + over / m->length_m[e] > 0;
            double k = p->flex[at] > 0 ? 1 / p->flex[at] : hf_newton_matrix_rigid_stiffness(m, e, T);
            p->along[at] = is_taut ? k : 0;
            p->DT[at] = is_taut ? k * over : -T;
            error.length = fmax(error.length, is_taut ? fabs(over) / m->length_m[e] : 0);
            error.gap = fmax(error.gap, is_taut ? -T / reference : fabs(T) / reference);
        }
        p->across[at] = fmax(T, 0) / length;
        for (int c = 0; c < 3; c++) {
            p->unit[c][at] = unit[c];
            pull[c] = T * unit[c];
        }
        hf_newton_matrix_add_pull(m, w, e, pull, w->newton_force_N);
    }
    if (held) add_springs_pull(m, w);
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
    if (!isfinite(error->balance)) return INFINITY; /* fmax ignores a NaN */
    return fmax(fmax(error->balance, error->length), fmax(error->gap, error->truss_m / hf_joint_mean_length_m(m)));
}

/* Moves position_m and tension_N by one Newton step. `error` is the error before it, which sets the damping. Returns
 * false if the matrix has no factor. */
static bool take_last_step(const hf_model *m, hf_workspace *w, const hf_newton_rows *held, double error)
{
    double pull[3], *step = w->newton_step,
                    damping = DAMPING * fmin(error, 1) * m->reference_N / hf_joint_mean_length_m(m);
    for (int i = 0; i < m->n_free && !held; i++)
        w->spring_N_per_m[i] = damping;
    if (hf_joint_factor(m, w, path_block, w->spring_N_per_m, held, NULL) != HF_OK) return false;
    memcpy(step, w->newton_force_N, 3 * (size_t)w->n_moving * sizeof *step);
    for (int e = 0; e < m->n_cable; e++) {
        int k;
        const hf_path_cables *p = block_of(w, e, &k);
        if (is_fixed(m, w, e)) continue;
        for (int c = 0; c < 3; c++)
            pull[c] = p->DT[k] * p->unit[c][k];
        hf_newton_matrix_add_pull(m, w, e, pull, step);
    }
    hf_joint_solve(m, w, path_block, held, w->newton_step);
    for (int e = 0; e < m->n_cable; e++) {
        int k;
        const hf_path_cables *p = block_of(w, e, &k);
        if (is_fixed(m, w, e) || !has_multiplier(w, e)) continue;
        set_vector_step(m, w, e);
        double longer = p->unit[0][k] * p->Dd[0][k] + p->unit[1][k] * p->Dd[1][k] + p->unit[2][k] * p->Dd[2][k];
        w->tension_N[e] += p->DT[k] + p->along[k] * longer;
    }
    hf_newton_matrix_move_nodes(m, w, 1, w->position_m);
    return true;
}

/* Sets the tensions at the end of the path, with 0 for slack cables. A cable is slack if its tension has fallen with mu
 * in the last step (Tapia's indicator, SIAM Rev. 36, 1994). If mu has hardly fallen, a cable is slack if its relative
 * slack is at least its relative tension. */
static void begin_end(const hf_model *m, hf_workspace *w, double fall)
{
    for (int e = 0; e < m->n_cable; e++) {
        int k;
        const hf_path_cables *p = block_of(w, e, &k);
        double T = p->T[k], slack = p->v[k] - path_length_m(w, e);
        bool is_small =
            fall < CLEAR_FALL ? T < sqrt(fall) * p->T_before[k] : T / m->reference_N <= slack / m->length_m[e];
        w->tension_N[e] = is_small && has_multiplier(w, e) && !is_fixed(m, w, e) ? 0 : T;
    }
}

/* Takes Newton steps from the present point of the path, in position_m and tension_N alone, until the errors are a
 * tenth of the tolerances or no longer fall. Returns true if they are within the tolerances. Otherwise restores the
 * first point, or keeps the last one if it is near and has smaller errors.
 *
 * With `impatient` the path can continue, and its next steps are worth more. The first step must then not lead far
 * away, and the others must reduce the errors clearly. Without it all steps are damped. Rounding then hides which
 * cables are slack, and an undamped step would lose a node that too few cables hold. */
static bool finish(const hf_model *m, const hf_form_settings *s, hf_workspace *w, const hf_newton_rows *held,
                   bool impatient, int max_steps, int *n_step)
{
    path_error now = measure_end(m, w, held);
    double first = largest_error(m, &now);
    bool damps = !impatient;
    hf_newton_copy(m, w->position_m, w->tension_N, w->interior_position_m, w->interior_tension_N);
    for (int k = 0; k < (impatient ? FINAL_MAX : LAST_MAX) && *n_step < max_steps && !is_within(&now, s, 0.1); k++) {
        bool was_within = is_within(&now, s, 1);
        double before = largest_error(m, &now);
        hf_newton_copy(m, w->position_m, w->tension_N, w->newton_trial_m, w->newton_trial_tension_N);
        ++*n_step;
        if (!take_last_step(m, w, held, damps ? before : 0)) break;
        now = measure_end(m, w, held);
        if (!held) hf_history_add_step(m, w, now.balance * m->reference_N, now.length, now.truss_m);
        double after = largest_error(m, &now);
        damps = damps || after > before;
        if (was_within && !(after < before)) {
            hf_newton_copy(m, w->newton_trial_m, w->newton_trial_tension_N, w->position_m, w->tension_N);
            return true;
        }
        bool is_worth_it = after < (k > 0 ? CLEARLY * before : FAR) || is_within(&now, s, 1);
        if (impatient && !is_worth_it) break;
    }
    if (is_within(&now, s, 1)) return true;
    if (!(largest_error(m, &now) < fmin(first, NEAR)))
        hf_newton_copy(m, w->interior_position_m, w->interior_tension_N, w->position_m, w->tension_N);
    return false;
}

static bool has_places(const hf_model *m, const hf_workspace *w)
{
    for (int k = 0; k < 3 * m->n_node; k++)
        if (!isfinite(w->position_m[k])) return false;
    return true;
}

static bool has_loaded_chain(const hf_model *m, hf_workspace *w)
{
    for (int i = 0; i < hf_form_n_chain(m); i++)
        if (hf_form_chain_is_loaded(m, w, i)) return true;
    return false;
}

hf_status hf_interior_run(const hf_model *m, const hf_form_settings *s, hf_workspace *w, bool is_held, int max_steps,
                          int *n_step, int *culprit)
{
    double wanted = NEAR, fall = 1;
    int last = *n_step + max_steps;
    bool is_there = true;
    hf_newton_rows rows = {0}, *held = is_held ? &rows : NULL;
    if (held) rows = hf_newton_matrix_find_rows(m, w->spring_N_per_m, w->newton_integer_work);
    *culprit = -1;
    set_start(m, w, held);
    for (int k = 0; k < TRIES_MAX && is_there; k++, wanted /= NEARER) {
        is_there = follow_path(m, w, held, wanted, last, n_step, &fall);
        if (is_told_to_stop(w)) return HF_INTERRUPTED;
        if ((*culprit = find_lost_row(m, w)) >= 0) return HF_SINGULAR;
        if (is_there && (*culprit = find_collapsed(m, s, w)) >= 0) return HF_COLLAPSED;
        bool is_rounding = k > 0 && !has_places(m, w), goes_on = is_there && k < TRIES_MAX - 1 && !is_rounding;
        if (is_rounding) /* use the point before this part of the path */
            hf_newton_copy(m, w->interior_position_m, w->interior_tension_N, w->position_m, w->tension_N);
        else
            begin_end(m, w, fall);
        bool is_found = finish(m, s, w, held, goes_on, last, n_step);
        hf_newton_set_force_densities(m, HF_LAW_HAS_MULTIPLIER, w);
        if (is_found) return HF_OK;
        if (!held && !goes_on && has_loaded_chain(m, w)) return HF_STRAIGHT_CHAIN;
        if (goes_on) hf_newton_copy(m, w->interior_position_m, w->interior_tension_N, w->position_m, w->tension_N);
    }
    return HF_NOT_CONVERGED;
}
