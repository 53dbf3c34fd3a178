/* Newton's method for one elastic net from the nominal shape (METHOD section 12, M34):
 *
 *     shape, tensions T ---> forces f out of balance; converged, or only rounding left: end
 *                       ---> H = sum of (k - T/l) u u' + T/l I with k = EA/l0, or 0 if slack (first step: H0)
 *                       ---> H d = f for the free nodes; on a truss (I + F S)^-1 of the gap by GMRES
 *                       ---> x <- x + d, limited to REACH; T <- max(k (l - l0 + elongation to first order), 0)
 *
 * The matrix uses the tension that the last step predicted to first order, not that of the new length. A step across a
 * cable lengthens it in second order only. Times EA this would be a large tension, and the steps would become very
 * short. A cable stays taut until a step predicts that it is slack. */
#include "built/near.h"

#include "linalg/band.h"
#include "linalg/dot.h"
#include "solve/joint.h"
#include "solve/schur.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* The tests of near, built_batch and samples also pass with other values of the five constants below. In their order
 * these are 40, 0.02, 0.01, 0.001, 1e-8 and 100, 0.1, 1, 0.1, 1e-4. With REACH 0.01, nets of 525 nodes take two steps
 * more at errors of 0.1 mm. Without REACH, most of those with errors of 0.5 mm are not found. */
#define STEPS_MAX 40
/* Maximum displacement of a node in one step, relative to the mean length of the cables. */
#define REACH 0.04
/* The minimum tension in the matrix is the smaller of two values: this fraction of the maximum force out of balance,
 * and FLOOR_MAX of the reference tension. */
#define FLOOR_OF_RESIDUAL 0.1
#define FLOOR_MAX 0.01
/* Residual relative to the reference tension, below which a step that does not halve it shows rounding. */
#define END_GAME 1e-6
/* On a truss: fraction of the gap that a linear step may leave, and the maximum number of vectors of GMRES. */
#define GAP_LEFT 1e-2
enum { KRYLOV = 12 };

/* Computes the stiffness block of cable e. set_stiffness has stored the stiffness along the cables in
 * newton_trial_tension_N, N/m, and that across them in q_N_per_m. */
static void block_of(const hf_model *m, const hf_workspace *w, int e, double block[3][3])
{
    double u[3];
    hf_newton_matrix_direction(m, w->position_m, e, u);
    hf_newton_matrix_spring(w->newton_trial_tension_N[e], w->q_N_per_m[e], u, block);
}

/* Returns whether the cable is taut in the matrix. */
static bool holds(const hf_workspace *w, int e, double over_m)
{
    return w->tension_N[e] > 0 || over_m > 0;
}

/* Sets newton_force_N to the forces out of balance by the elastic law. Sets newton_step to the same with compression in
 * cables that are taut in the matrix. Returns the maximum of the former, N. */
static double measure(const hf_model *m, hf_workspace *w)
{
    double u[3], largest = 0;
    hf_newton_matrix_set_loads(m, w, w->newton_force_N);
    memcpy(w->newton_step, w->newton_force_N, 3 * (size_t)w->n_moving * sizeof(double));
    for (int e = 0; e < m->n_cable; e++) {
        double length = hf_newton_matrix_direction(m, w->position_m, e, u);
        double over_m = length - w->target[e];
        w->length_m[e] = length;
        if (!holds(w, e, over_m)) continue;
        double tension = w->EA_N[e] / w->target[e] * over_m;
        double pull[3] = {tension * u[0], tension * u[1], tension * u[2]};
        hf_newton_matrix_add_pull(m, w, e, pull, w->newton_step);
        if (tension > 0) hf_newton_matrix_add_pull(m, w, e, pull, w->newton_force_N);
    }
    for (int i = 0; i < m->n_free; i++) {
        const double *f = w->newton_force_N + 3 * i;
        double square = f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
        if (!(square <= largest)) largest = square; /* this form keeps a NaN */
    }
    return sqrt(largest);
}

/* Sets the stiffnesses along and across each cable for block_of, with tensions of at least floor_N across. */
static void set_stiffness(const hf_model *m, hf_workspace *w, double floor_N)
{
    for (int e = 0; e < m->n_cable; e++) {
        bool taut = holds(w, e, w->length_m[e] - w->target[e]);
        w->newton_trial_tension_N[e] = taut ? w->EA_N[e] / w->target[e] : 0;
        w->q_N_per_m[e] = fmax(w->tension_N[e], floor_N) / w->length_m[e];
    }
}

static double largest_move_m(const hf_workspace *w)
{
    double largest = 0;
    for (int i = 0; i < w->n_moving; i++) {
        const double *d = w->newton_step + 3 * i;
        largest = fmax(largest, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    return sqrt(largest);
}

/* Adds `part` of the step to positions and predicts the tensions to first order. */
static void move(const hf_model *m, hf_workspace *w, double part)
{
    const double *step = w->newton_step;
    double u[3];
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        double over_m = hf_newton_matrix_direction(m, w->position_m, e, u) - w->target[e], longer_m = 0;
        for (int c = 0; c < 3; c++) {
            if (a < w->n_moving) longer_m -= u[c] * step[3 * a + c];
            if (b < w->n_moving) longer_m += u[c] * step[3 * b + c];
        }
        bool taut = holds(w, e, over_m);
        w->tension_N[e] = taut ? fmax(w->EA_N[e] / w->target[e] * (over_m + part * longer_m), 0) : 0;
    }
    for (int i = 0; i < w->n_moving; i++)
        for (int c = 0; c < 3; c++)
            w->position_m[c * m->n_node + i] += part * step[3 * i + c];
}

/* ---- the truss ---- */

/* Computes the displacements of the attachments by a gap with the matrix of the nominal net. */
static void answer_nominal(const hf_near *near, const double *gap_m, double *answer_m)
{
    int n = near->chord.n_pull;
    for (int i = 0; i < n; i++) {
        const double *row = near->answer + ((ptrdiff_t)i / HF_PULL_ROWS * n) * HF_PULL_ROWS + i % HF_PULL_ROWS;
        answer_m[i] = 0;
        for (int j = 0; j < n; j++)
            answer_m[i] += row[(ptrdiff_t)j * HF_PULL_ROWS] * gap_m[j];
    }
}

/* Solves for the displacements of the free nodes after displacements of the attachments, into newton_force_N. */
static void push_free(const hf_near *near, const double *factor, const double *move_m, hf_workspace *w)
{
    const hf_model *m = &near->model;
    int n = hf_newton_matrix_dofs(m);
    memset(w->newton_force_N, 0, (size_t)n * sizeof(double));
    hf_schur_push(m, w, block_of, move_m, w->newton_force_N);
    hf_band_back_solve(n, 3 * m->half_bandwidth + 2, 1, factor, w->newton_force_N, n);
}

/* Computes to = A (1 + F S) move_m, both [n_pull]. S is the stiffness of this net at the attachments, A the inverse for
 * the nominal net. */
static void apply(const hf_near *near, const double *factor, const double *move_m, hf_workspace *w, double *to)
{
    const hf_model *m = &near->model;
    double *pull = w->newton_step + hf_newton_matrix_dofs(m), *gap = w->coupling_work;
    push_free(near, factor, move_m, w);
    memset(pull, 0, (size_t)near->chord.n_pull * sizeof *pull);
    hf_schur_pull(m, w, block_of, w->newton_force_N, pull);
    hf_schur_hold(m, w, block_of, move_m, pull);
    hf_schur_flex(m, pull, gap);
    for (int i = 0; i < near->chord.n_pull; i++)
        gap[i] = move_m[i] - gap[i];
    answer_nominal(near, gap, to);
}

/* Applies the previous Givens rotations to column j of the Hessenberg matrix, and a new one that zeroes its last entry.
 * rest[j + 1] is then the remaining residual. */
static void rotate(int j, double *h, double rotation[][2], double *rest)
{
    for (int i = 0; i < j; i++) {
        double above = h[i], below = h[i + 1];
        h[i] = rotation[i][0] * above + rotation[i][1] * below;
        h[i + 1] = rotation[i][0] * below - rotation[i][1] * above;
    }
    double length = sqrt(h[j] * h[j] + h[j + 1] * h[j + 1]);
    rotation[j][0] = h[j] / length;
    rotation[j][1] = h[j + 1] / length;
    h[j] = length;
    rest[j + 1] = -rotation[j][1] * rest[j];
    rest[j] *= rotation[j][0];
}

/* Computes the next vector of the Krylov space of A (1 + F S), orthogonalised to the previous ones and normalised. */
static void extend(const hf_near *near, const double *factor, int j, hf_workspace *w, double *h)
{
    size_t n = (size_t)near->chord.n_pull;
    double *v = w->schur_work, *next = v + (size_t)(j + 1) * n;
    apply(near, factor, v + (size_t)j * n, w, next);
    for (int i = 0; i <= j; i++) {
        h[i] = hf_dot(n, v + (size_t)i * n, next);
        for (size_t k = 0; k < n; k++)
            next[k] -= h[i] * v[(size_t)i * n + k];
    }
    h[j + 1] = sqrt(hf_dot(n, next, next));
    for (size_t k = 0; k < n && h[j + 1] > 0; k++)
        next[k] /= h[j + 1];
}

/* Replaces the gap by the displacement of the attachments that closes it, (1 + F S)^-1 gap. It uses GMRES (Saad,
 * Schultz, SIAM J. Sci. Stat. Comput. 7, 1986) with the inverse A of the nominal net as preconditioner. A alone closes
 * only a fifth of the gap per step, because slack cables remove stiffness in a few directions.
 *
 * No division by 0 occurs. F and S are positive semidefinite, so 1 + F S is regular, as is its nominal counterpart. The
 * images of the vectors are therefore independent, and a space that ends early (h[j + 1] = 0) contains the solution. If
 * rounding breaks this, the result is NaN and Newton's method stops on it. */
static void close_gap(const hf_near *near, const double *factor, double *gap_m, hf_workspace *w)
{
    enum { MOST = KRYLOV };
    size_t n = (size_t)near->chord.n_pull;
    int most = n < MOST ? (int)n - 1 : MOST, j = 0;
    double *v = w->schur_work, h[MOST][MOST + 1], rotation[MOST][2], rest[MOST + 1];
    answer_nominal(near, gap_m, v);
    double whole = sqrt(hf_dot(n, v, v));
    for (size_t k = 0; k < n && whole > 0; k++)
        v[k] /= whole;
    rest[0] = whole;
    while (whole > 0 && j < most && fabs(rest[j]) > GAP_LEFT * whole) {
        extend(near, factor, j, w, h[j]);
        rotate(j, h[j], rotation, rest);
        j++;
    }
    memset(gap_m, 0, n * sizeof *gap_m);
    for (int i = j - 1; i >= 0; i--) {
        for (int k = i + 1; k < j; k++)
            rest[i] -= h[k][i] * rest[k];
        rest[i] /= h[i][i];
        for (size_t k = 0; k < n; k++)
            gap_m[k] += rest[i] * v[(size_t)i * n + k];
    }
}

/* Turns newton_step, the step of the free nodes with the attachments held, into the step of net and truss together. */
static void follow_truss(const hf_near *near, bool is_nominal, const double *factor, hf_workspace *w)
{
    const hf_model *m = &near->model;
    int n = hf_newton_matrix_dofs(m), n_pull = near->chord.n_pull;
    double *pull = w->newton_step + n, *gap = w->coupling_work, *move_m = w->schur_work + (KRYLOV + 1) * n_pull;
    hf_schur_pull(m, w, block_of, w->newton_step, pull);
    hf_schur_flex(m, pull, gap);
    hf_joint_set_displacement(m, w);
    for (int i = 0; i < n_pull; i++)
        move_m[i] = gap[i] - w->displacement_m[i];
    if (is_nominal) {
        answer_nominal(near, memcpy(gap, move_m, (size_t)n_pull * sizeof *gap), move_m);
    } else {
        close_gap(near, factor, move_m, w);
    }
    memcpy(pull, move_m, (size_t)n_pull * sizeof *pull);
    push_free(near, factor, pull, w);
    for (int i = 0; i < n; i++)
        w->newton_step[i] += w->newton_force_N[i];
}

/* ---- Newton ---- */

/* Turns the forces in newton_step into the step. The first step uses the matrix of the nominal net. Returns false when
 * the matrix cannot be factored. */
static bool solve(const hf_near *near, int k, double floor_N, hf_workspace *w)
{
    const hf_model *m = &near->model;
    const double *factor = k == 0 ? near->band : w->newton_band;
    int n = hf_newton_matrix_dofs(m);
    if (k > 0 || m->n_attachment) set_stiffness(m, w, floor_N);
    if (k > 0 && hf_newton_matrix_factor_blocks(m, w, block_of, NULL, NULL, NULL) != HF_OK) return false;
    hf_band_back_solve(n, 3 * m->half_bandwidth + 2, 1, factor, w->newton_step, n);
    if (m->n_attachment) follow_truss(near, k == 0, factor, w);
    return true;
}

/* Sets the tensions of the elastic law at the shape, or keeps those that the last step predicted. The latter balance
 * even where EA times the rounding of lengths does not. */
static void set_tensions(const hf_model *m, bool by_law, hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++) {
        double over_m = w->length_m[e] - w->target[e];
        if (by_law) w->tension_N[e] = over_m > 0 ? w->EA_N[e] / w->target[e] * over_m : 0;
        w->q_N_per_m[e] = w->tension_N[e] / w->length_m[e];
    }
}

bool hf_near_newton(const hf_near *near, hf_workspace *w, int *n_step)
{
    const hf_model *m = &near->model;
    const hf_form_settings *form = &near->built->form;
    double reach_m = REACH * hf_joint_mean_length_m(m), before_N = INFINITY;
    for (int k = 0;; k++) {
        double residual_N = measure(m, w), gap_m = hf_joint_gap_m(m, w, w->position_m, w->newton_force_N, NULL);
        bool on_truss = gap_m <= fmax(form->coupling.tof_m, HF_JOINT_NO_GAP_M);
        bool balances = residual_N <= form->residual_tolerance * m->reference_N;
        bool is_rounding = residual_N < END_GAME * m->reference_N && !(residual_N < before_N / 2);
        if (on_truss && (balances || is_rounding)) {
            set_tensions(m, balances, w);
            return true;
        }
        if (!isfinite(residual_N) || k == STEPS_MAX) return false;
        before_N = residual_N;
        if (!solve(near, k, fmin(FLOOR_OF_RESIDUAL * residual_N, FLOOR_MAX * m->reference_N), w)) return false;
        double move_m = largest_move_m(w);
        move(m, w, move_m > reach_m ? reach_m / move_m : 1);
        ++*n_step;
    }
}
