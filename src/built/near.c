/* Solves as-built nets by chord steps with the matrix H0 of the nominal net (M33), eight in the lanes:
 *
 *     load ---> look:    tensions by the elastic law, forces f out of balance, gap of the truss
 *      nominal   |
 *      shape     v
 *               settle:  converged ---> shape, tensions and result of this lane
 *                |       no longer contracting, or too many steps ---> lost, to be solved by Newton's method
 *                v
 *               step:    free nodes x <- x + H0^-1 f; on a truss also attachments, then free nodes again ---> look
 *
 * Contents: what all threads share, lanes, Newton's method, the shape in a workspace, the end of a lane. */
#include "built/near.h"

#include "base/arena.h"
#include "linalg/band.h"
#include "linalg/dot.h"
#include "solve/coupling.h"
#include "solve/joint.h"
#include "solve/loose.h"
#include "solve/schur.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Steps before a lane must contract (hf_chord_goes_on). A net that does not is solved by Newton's method, which finds
 * the same shape within the tolerance in 4 to 8 steps, each of which takes as long as a dozen chord steps. The tests of
 * near, built_batch and samples pass with 1 and 10. */
#define PATIENCE 2

/* ---- what all threads share ---- */

/* Prepares the workspace for a net: nominal shape and tensions, with supports displaced and attachments as unknowns. */
static void prepare(const hf_near *near, const hf_built_net *net, hf_workspace *w)
{
    const hf_built *b = near->built;
    const hf_model *m = &near->model;
    size_t by_cable = (size_t)m->n_cable * sizeof(double), by_node = 3 * (size_t)m->n_node * sizeof(double);
    hf_form_prepare(m, w);
    if (net->cut_m) memcpy(w->target, net->cut_m, by_cable);
    if (net->EA_N) memcpy(w->EA_N, net->EA_N, by_cable);
    if (net->support_displacement_m) memcpy(w->support_displacement_m, net->support_displacement_m, by_node);
    memcpy(w->position_m, b->position_m, by_node);
    memcpy(w->tension_N, b->tension_N, by_cable);
    w->n_moving = m->n_free + m->n_attachment;
    for (int c = 0; c < 3; c++)
        for (int at = c * m->n_node + m->n_free; at < (c + 1) * m->n_node; at++)
            w->position_m[at] += w->support_displacement_m[at];
    hf_joint_set_displacement(m, w);
}

hf_status hf_near_create(const hf_built *b, hf_workspace *w, hf_near *near)
{
    size_t n_band = HF_NEWTON_DOFS(&b->model) * (3 * (size_t)b->model.half_bandwidth + 3);
    size_t n_pull = 3 * (size_t)b->model.n_attachment;
    *near = (hf_near){.built = b, .model = b->model};
    near->model.n_variable = near->model.n_leader = near->model.n_variable_group = 0;
    near->model.variable = NULL;
    near->evaluator = (hf_evaluator){.model = &near->model, .form = &b->form, .rule = HF_RULE_TENSION};
    prepare(near, &(hf_built_net){0}, w);
    w->n_moving = b->model.n_free;
    HF_TRY(HF_ARENA_ARRAYS(&near->block, HF_ARRAY(near->band, n_band),
                           HF_ARRAY(near->answer, (n_pull + HF_CHORD_ROWS) * n_pull)));
    HF_TRY(hf_chord_create_here(&near->evaluator, w, near->answer, &near->chord));
    memcpy(near->band, w->newton_band, n_band * sizeof *near->band);
    return HF_OK;
}

void hf_near_free(hf_near *near)
{
    hf_arena_free(&near->chord.arena);
    hf_arena_free_block(near->block);
    near->block = NULL;
}

/* ---- lanes ---- */

hf_status hf_near_lanes_create(const hf_near *near, hf_near_lanes *l)
{
    size_t n = (size_t)near->model.n_cable * HF_LANES;
    *l = (hf_near_lanes){0};
    HF_TRY(hf_chord_lanes_create(&near->chord, &l->lanes));
    return HF_ARENA_ARRAYS(&l->block, HF_ARRAY(l->gap_lanes_m, 3 * (size_t)near->model.n_attachment * HF_LANES),
                           HF_ARRAY(l->cut_m, n), HF_ARRAY(l->stiffness_N_per_m, n), HF_ARRAY(l->tension_N, n));
}

void hf_near_lanes_free(hf_near_lanes *l)
{
    hf_arena_free(&l->lanes.arena);
    hf_arena_free_block(l->block);
    l->block = NULL;
}

void hf_near_load(const hf_near *near, hf_near_lanes *l, int lane, const hf_built_net *net)
{
    const hf_model *m = &near->model;
    for (int at = 0; at < 3 * m->n_node; at++)
        l->lanes.x_m[at * HF_LANES + lane] = near->built->position_m[at];
    for (int d = 0; d < 3 && net->support_displacement_m; d++)
        for (int at = d * m->n_node + m->n_free; at < (d + 1) * m->n_node; at++)
            l->lanes.x_m[at * HF_LANES + lane] += net->support_displacement_m[at];
    for (int at = 0; at < 3 * m->n_node && l->lanes.load_N; at++)
        l->lanes.load_N[at * HF_LANES + lane] = net->load_N[at];
    for (int e = 0; e < m->n_cable; e++) {
        l->cut_m[e * HF_LANES + lane] = net->cut_m[e];
        l->stiffness_N_per_m[e * HF_LANES + lane] = net->EA_N[e] / net->cut_m[e];
    }
    hf_chord_begin(&near->chord, &l->lanes, lane, &l->progress);
}

void hf_near_look(const hf_near *near, hf_near_lanes *l)
{
    near->chord.kernels->pull(&near->model, l->lanes.x_m, l->cut_m, l->stiffness_N_per_m, l->tension_N,
                              l->lanes.variable);
    hf_chord_look(&near->chord, &l->lanes, &l->progress);
}

/* Adds to the pulls on the truss the effect of the step of the free nodes. Clears the step in force_N, because it is
 * already part of the shape. */
static void follow(const hf_near *near, hf_chord_lanes *l)
{
    const hf_model *m = &near->model;
    const hf_chord *c = &near->chord;
    double *step = l->force_N + (size_t)c->matrix.width * HF_LANES;
    for (int k = 0; k < m->n_tie; k++) {
        int there = m->end_row[m->tie[k] ^ 1];
        const double *block = c->tie_block + 9 * k, *d = step + (ptrdiff_t)3 * there * HF_LANES;
        double *pull = l->pull_N + (ptrdiff_t)3 * m->tie_attachment[k] * HF_LANES;
        if (there >= m->n_free) continue;
        for (int i = 0; i < 9 * HF_LANES; i++) {
            int row = i / (3 * HF_LANES), column = i / HF_LANES % 3, lane = i % HF_LANES;
            pull[row * HF_LANES + lane] += block[3 * row + column] * d[column * HF_LANES + lane];
        }
    }
    memset(step, 0, (size_t)c->matrix.n * HF_LANES * sizeof *step);
}

/* Takes a step in two halves on a truss: the free nodes with the attachments held, then the attachments with their
 * effect on the free nodes. */
void hf_near_step(const hf_near *near, hf_near_lanes *l)
{
    const hf_chord *c = &near->chord;
    const hf_chord_kernels *k = c->kernels;
    double gap_squared[HF_LANES];
    c->matrix.solve(&c->matrix, l->lanes.force_N);
    k->step(c, &l->lanes);
    if (!c->n_pull) return;
    follow(near, &l->lanes);
    k->couple(c, &l->lanes, gap_squared);
    memcpy(l->gap_lanes_m, l->lanes.move_m, (size_t)c->n_pull * HF_LANES * sizeof *l->gap_lanes_m);
    k->multiply(c->n_pull_pad, c->n_pull, near->answer, l->gap_lanes_m, l->lanes.move_m);
    k->move(c, &l->lanes);
    c->matrix.solve(&c->matrix, l->lanes.force_N);
    k->step(c, &l->lanes);
}

/* ---- Newton's method: forces and matrix ----
Newton's method for one elastic net from the nominal shape (M34):
 *
 *     shape, tensions T ---> forces f out of balance; converged, or only rounding left: end
 *                       ---> H = sum of (k - T/l) u u' + T/l I with k = EA/l0, or 0 if slack (first step: H0)
 *                       ---> H d = f for the free nodes; on a truss (I + F S)^-1 of the gap by GMRES
 *                       ---> x <- x + d, limited to REACH; T <- max(k (l - l0 + elongation to first order), 0)
 *
 * The matrix uses the tension that the last step predicted to first order, not that of the new length. A step across a
 * cable lengthens it in second order only. Times EA this would be a large tension, and the steps would become very
 * short. A cable stays taut until a step predicts that it is slack. */

/* The tests of near, built_batch and samples also pass with other values of the constants below. In their order
 * these are 40, 0.02, 0.01, 0.001, 1e-8 and 100, 0.1, 1, 0.1, 1e-4. With REACH 0.01, nets of 525 nodes take two steps
 * more at errors of 0.1 mm. Without REACH, most of those with errors of 0.5 mm are not found. */
#define NEWTON_STEPS_MAX 40
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
    double u[3];
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
    return hf_joint_largest(m->n_free, 1, w->newton_force_N, NULL);
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
    hf_newton_matrix_move_nodes(m, w, part, w->position_m);
}

/* ---- Newton's method: the truss ---- */

/* Computes the displacements of the attachments by a gap with the matrix of the nominal net. */
static void answer_nominal(const hf_near *near, const double *gap_m, double *answer_m)
{
    int n = near->chord.n_pull;
    for (int i = 0; i < n; i++) {
        const double *row = near->answer + ((ptrdiff_t)i / HF_CHORD_ROWS * n) * HF_CHORD_ROWS + i % HF_CHORD_ROWS;
        answer_m[i] = 0;
        for (int j = 0; j < n; j++)
            answer_m[i] += row[(ptrdiff_t)j * HF_CHORD_ROWS] * gap_m[j];
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
        hf_subtract(n, h[i], v + (size_t)i * n, next);
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
    enum { MAX = KRYLOV };
    size_t n = (size_t)near->chord.n_pull;
    int n_max = n < MAX ? (int)n - 1 : MAX, j = 0;
    double *v = w->schur_work, h[MAX][MAX + 1], rotation[MAX][2], rest[MAX + 1];
    answer_nominal(near, gap_m, v);
    double whole = sqrt(hf_dot(n, v, v));
    for (size_t k = 0; k < n && whole > 0; k++)
        v[k] /= whole;
    rest[0] = whole;
    while (whole > 0 && j < n_max && fabs(rest[j]) > GAP_LEFT * whole) {
        extend(near, factor, j, w, h[j]);
        rotate(j, h[j], rotation, rest);
        j++;
    }
    memset(gap_m, 0, n * sizeof *gap_m);
    for (int i = j - 1; i >= 0; i--) {
        for (int k = i + 1; k < j; k++)
            rest[i] -= h[k][i] * rest[k];
        rest[i] /= h[i][i];
        hf_add(n, rest[i], v + (size_t)i * n, gap_m);
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
    hf_add((size_t)n, 1, w->newton_force_N, w->newton_step);
}

/* ---- Newton's method: steps ---- */

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

/* Runs Newton's method from position_m and tension_N of the workspace and adds its steps to *n_step. Returns false when
 * it does not converge. Otherwise tension_N and q_N_per_m belong to the shape, which the caller measures. */
static bool solve_newton(const hf_near *near, hf_workspace *w, int *n_step)
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
        if (!isfinite(residual_N) || k == NEWTON_STEPS_MAX) return false;
        before_N = residual_N;
        if (!solve(near, k, fmin(FLOOR_OF_RESIDUAL * residual_N, FLOOR_MAX * m->reference_N), w)) return false;
        double move_m = hf_joint_largest(w->n_moving, 1, w->newton_step, NULL);
        move(m, w, move_m > reach_m ? reach_m / move_m : 1);
        ++*n_step;
    }
}

/* ---- the shape in a workspace ---- */

/* Measures the shape and assigns positions to loose nodes. Returns false when the shape is no equilibrium within the
 * tolerances. */
static bool accept(const hf_near *near, int n_step, hf_workspace *w, hf_form_result *r)
{
    const hf_model *m = &near->model;
    const hf_form_settings *form = &near->built->form;
    if (hf_form_measure(m, form, w, r) != HF_OK) return false;
    r->iterations = n_step;
    if (m->n_attachment) {
        hf_joint_set_displacement(m, w);
        double gap_m = hf_coupling_measure(m, w, r);
        if (!(gap_m <= form->coupling.tof_m)) return false;
        hf_coupling_accept(m, w, n_step, gap_m, r);
    }
    if (r->n_slack > 0) hf_loose_settle(m, form, w, r);
    return r->status == HF_OK;
}

/* Returns `near` with the loads of a net, for functions that read its model alone. */
static hf_near load_by(const hf_near *near, const hf_built_net *net)
{
    hf_near loaded = *near;
    if (net->load_N) loaded.model.load_N = (double *)(uintptr_t)net->load_N; /* no solver writes to load_N */
    return loaded;
}

bool hf_near_find(const hf_near *near, const hf_built_net *net, hf_workspace *w, hf_form_result *r)
{
    hf_near loaded = load_by(near, net);
    int n_step = 0;
    prepare(&loaded, net, w);
    return solve_newton(&loaded, w, &n_step) && accept(&loaded, n_step, w, r);
}

/* ---- the end of a lane ---- */

/* Copies the shape of a lane into the workspace. */
static void unload(const hf_near *near, const hf_near_lanes *l, int lane, hf_workspace *w)
{
    const hf_model *m = &near->model;
    for (int i = 0; i < 3 * m->n_node; i++)
        w->position_m[i] = l->lanes.x_m[i * HF_LANES + lane];
    for (int e = 0; e < m->n_cable; e++)
        w->tension_N[e] = l->tension_N[e * HF_LANES + lane];
    for (int i = 0; i < near->chord.n_pull; i++)
        w->displacement_m[i] = l->lanes.displacement_m[i * HF_LANES + lane];
}

/* Accepts a converged lane with slack cables. The scalar code counts them and looks for loose nodes. */
static bool accept_slack(const hf_near *near, const hf_near_lanes *l, int lane, const hf_built_net *net,
                         hf_workspace *w, hf_form_result *r)
{
    const hf_model *m = &near->model;
    const hf_near loaded = load_by(near, net);
    prepare(near, net, w);
    unload(near, l, lane, w);
    for (int e = 0; e < m->n_cable; e++)
        w->q_N_per_m[e] = l->lanes.variable[e * HF_LANES + lane];
    return accept(&loaded, l->progress.steps[lane], w, r);
}

hf_near_verdict hf_near_settle(const hf_near *near, hf_near_lanes *l, int lane, const hf_built_net *net,
                               hf_workspace *w, hf_form_result *r)
{
    const hf_model *m = &near->model;
    hf_chord_progress *p = &l->progress;
    if (!(p->excess_N[lane] <= near->built->form.residual_tolerance * m->reference_N))
        return hf_chord_goes_on(lane, PATIENCE, p) ? HF_NEAR_GOES_ON : HF_NEAR_LOST;
    hf_chord_report(&near->chord, &l->lanes, lane, p, r);
    double lowest_N = fmin(p->now.lowest_N[HF_GROUP_INNER][lane], p->now.lowest_N[HF_GROUP_BOUNDARY][lane]);
    if (!(lowest_N >= HF_SLACK_RATIO * m->reference_N))
        return accept_slack(near, l, lane, net, w, r) ? HF_NEAR_FOUND : HF_NEAR_LOST;
    unload(near, l, lane, w);
    memset(w->loose, 0, (size_t)m->n_node);
    if (m->n_attachment) hf_coupling_accept(m, w, r->iterations, p->gap_m[lane], r);
    return HF_NEAR_FOUND;
}
