/* Finds the best fit to points near those of another fit:
 *
 *     pose of the other fit -> normal equations, factored once
 *       -> Gauss-Newton steps with this factor: turn, shift, curvature -> RMS at convergence
 *       -> if it does not converge or is not well inside the bounds: the caller uses hf_surface_fit_points
 *
 * Contents: a pose - rows of points - steps - changes of a fit - derivatives of a fit */
#include "surface/surface_near.h"

#include "base/elementary.h"
#include "linalg/dense.h"
#include "linalg/dot.h"
#include "net/target_surface.h"

#include <math.h>
#include <string.h>

#define STEPS_MAX 20     /* maximum of one fit; nets cut to 0.05 mm need two or three, rough facets up to 20 */
#define SETTLED 1e-11    /* converged if a step lowers the sum of squares by less than this share */
#define ACROSS_MOST 0.09 /* relative to the size; the bound is 0.1 in the reference */
#define FOCAL_MOST 1.5   /* ratio of fitted to target curvature, or its reciprocal; 2 in the reference */

/* ---- a pose ---- */

/* Returns the change of a pose by a parameter of the fit. A turn by an angle changes the rotation T by T' = [w] T. */
static hf_surface_motion motion_of_quantity(const hf_surface_pose *q, const double angle[3], int quantity)
{
    static const int shift_axis[HF_FIT_N_QUANTITY] = {[HF_FIT_SHIFT_X] = 0, [HF_FIT_SHIFT_Y] = 1, [HF_FIT_SHIFT_Z] = 2};
    hf_surface_motion m = {.curve = quantity == HF_FIT_CURVE ? q->wanted_per_m : 0};
    int about = hf_fit_angle_of(quantity);
    if (about >= 0) {
        const int order[3] = {about == 0, about == 1, about == 2};
        double slope[3][3];
        hf_fit_rotation(angle, order, slope);
        for (int d = 0; d < 3; d++)
            m.turn[d] = hf_dot3(slope[(d + 2) % 3], q->turn[(d + 1) % 3]);
    } else if (quantity != HF_FIT_CURVE) {
        for (int d = 0; d < 3; d++)
            m.move[d] = -q->size_m * q->turn[d][shift_axis[quantity]];
    }
    return m;
}

hf_surface_pose hf_surface_pose_of(hf_surface_kind kind, double focal_length_m, const hf_surface_fit *fit,
                                   const hf_fit_parameters *parameters)
{
    const double angle[3] = {fit->rotation_x_rad, fit->rotation_y_rad, fit->rotation_z_rad};
    hf_surface_pose q = {.n = fit->converged ? parameters->n : 0,
                         .kind = kind,
                         .center_m = {fit->center_x_m, fit->center_y_m, fit->center_z_m},
                         .shift_m = {fit->shift_x_m, fit->shift_y_m, fit->shift_z_m},
                         .curvature_per_m = 1 / (4 * fit->focal_length_m),
                         .wanted_per_m = 1 / (4 * focal_length_m),
                         .size_m = parameters->size_m,
                         .size_end = {parameters->size_end[0], parameters->size_end[1]}};
    hf_fit_rotation(angle, (const int[3]){0, 0, 0}, q.turn);
    for (int k = 0; k < q.n + parameters->n_held && q.n > 0; k++) {
        int quantity = parameters->quantity[k];
        if (k < q.n) q.free[k] = motion_of_quantity(&q, angle, quantity);
        if (k >= q.n && quantity == HF_FIT_SHIFT_X) q.held_m[0] = q.shift_m[0];
        if (k >= q.n && quantity == HF_FIT_SHIFT_Y) q.held_m[1] = q.shift_m[1];
    }
    return q;
}

hf_surface_pose hf_surface_pose_of_target(hf_surface_kind kind, double focal_length_m, int n, const double *position_m)
{
    hf_surface_pose q = {.n = HF_FIT_N_PARAMETER, .kind = kind, .curvature_per_m = 1 / (4 * focal_length_m)};
    q.wanted_per_m = q.curvature_per_m;
    for (int d = 0; d < 3; d++) { /* centre and size as in hf_surface_fit_find */
        const double *x = position_m + (size_t)d * (size_t)n;
        double low = x[0], high = x[0], sum = 0;
        for (int i = 0; i < n; i++) {
            low = fmin(low, x[i]);
            high = fmax(high, x[i]);
            sum += x[i];
        }
        q.center_m[d] = sum / n;
        q.size_m = fmax(q.size_m, (high - low) / 2);
        q.turn[d][d] = 1;
    }
    return q;
}

/* Applies a small turn and shift in the frame of the surface: p goes to E (p - center) + center + move. E is Cayley's
 * rotation (1 - [a])^-1 (1 + [a]) with a = turn/2. It agrees with the turn to second order. */
static void move_pose(hf_surface_pose *q, const double move[3], const double turn[3])
{
    double a[3] = {turn[0] / 2, turn[1] / 2, turn[2] / 2}, by = 2 / (1 + a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    double next[3][3];
    for (int c = 0; c < 3; c++) {
        double column[3] = {q->turn[0][c], q->turn[1][c], q->turn[2][c]}, once[3], twice[3];
        hf_cross(a, column, once);
        hf_cross(a, once, twice);
        for (int d = 0; d < 3; d++)
            next[d][c] = column[d] + by * (once[d] + twice[d]);
    }
    memcpy(q->turn, next, sizeof next);
    for (int c = 0; c < 3; c++)
        q->shift_m[c] -= next[0][c] * move[0] + next[1][c] * move[1] + next[2][c] * move[2];
}

/* ---- rows of points ---- */

/* Parameters of a step: shifts and turns in the frame of the surface, shifts relative to the size, turns in rad, and
 * the curvature times the size. One of the seven changes nothing: the shift along y of a cylinder, or the turn about z
 * of a paraboloid. */
enum { N = HF_FIT_N_PARAMETER, N_ALL = 7, LANES = 8, N_PRODUCT = (N + 1) * (N + 2) / 2 };

typedef struct {
    hf_surface_pose pose;
    int n;
    const double *x[3], *root_weight;
} problem;

/* Computes the weighted residuals of up to LANES points from `first` on, and before each its derivatives. Missing
 * points give 0. With the height u above the surface and w = 1/(1 + slope^2), the residual is u w. Its derivative by
 * the point is a = w (-2 c x (1 + 4 c u w), -2 c y (1 + 4 c u w), 1). Its derivative by a turn is the vector from the
 * centre, times a (vector product). */
static void find_rows(const problem *p, int first, double row[N + 1][LANES])
{
    const hf_surface_pose *q = &p->pose;
    double at[3][LANES], rho[3][LANES], root[LANES], all[N_ALL][LANES], c = q->curvature_per_m;
    double round_ = q->kind == HF_SURFACE_PARABOLOID, size = q->size_m;
    for (int k = 0; k < LANES; k++) {
        int i = first + k < p->n ? first + k : p->n - 1;
        for (int d = 0; d < 3; d++)
            at[d][k] = p->x[d][i] - q->center_m[d] - q->shift_m[d];
        root[k] = first + k >= p->n ? 0 : p->root_weight ? p->root_weight[i] : 1;
    }
    for (int d = 0; d < 3; d++)
        for (int k = 0; k < LANES; k++)
            rho[d][k] = q->turn[d][0] * at[0][k] + q->turn[d][1] * at[1][k] + q->turn[d][2] * at[2][k];
    for (int k = 0; k < LANES; k++) {
        double x = rho[0][k] + q->center_m[0], y = round_ * (rho[1][k] + q->center_m[1]);
        double square = x * x + y * y, u = rho[2][k] + q->center_m[2] - c * square, w = 1 / (1 + 4 * c * c * square);
        double bent = 4 * c * u * w, az = root[k] * w, ax = -2 * c * x * (1 + bent) * az,
               ay = -2 * c * y * (1 + bent) * az;
        all[0][k] = size * az;
        all[1][k] = size * ax;
        all[2][k] = size * ay;
        all[3][k] = rho[1][k] * az - rho[2][k] * ay;
        all[4][k] = rho[2][k] * ax - rho[0][k] * az;
        all[5][k] = rho[0][k] * ay - rho[1][k] * ax;
        all[6][k] = -square / size * (1 + 2 * bent) * az;
        row[N][k] = u * az;
    }
    for (int j = 0, to = 0; j < N_ALL; j++)
        if (j != (round_ > 0 ? 5 : 2)) memcpy(row[to++], all[j], sizeof all[j]);
}

/* Sums the products of the columns of rows over all points. If `all` is true, these are all products, the lower
 * triangle by rows; else only those with the residual, [N + 1]. Lanes are added at the end. */
static void sum_products(const problem *p, bool all, double sum[N_PRODUCT])
{
    double row[N + 1][LANES], lane[N_PRODUCT][LANES] = {0};
    for (int first = 0; first < p->n; first += LANES) {
        find_rows(p, first, row);
        for (int i = all ? 0 : N, at = 0; i <= N; i++)
            for (int j = 0; j <= i; j++, at++)
                for (int k = 0; k < LANES; k++)
                    lane[at][k] += row[i][k] * row[j][k];
    }
    for (int at = 0; at < N_PRODUCT; at++) {
        sum[at] = 0;
        for (int k = 0; k < LANES; k++)
            sum[at] += lane[at][k];
    }
}

/* ---- steps ---- */

/* Computes the factor of the normal equations at the pose. last [N + 1]: gradient and sum of squares. Returns false if
 * the matrix is singular. */
static bool take_normal(const problem *p, double factor[N * N], int pivot[N], double last[N + 1])
{
    double sum[N_PRODUCT];
    sum_products(p, true, sum);
    for (int i = 0, at = 0; i < N; i++)
        for (int j = 0; j <= i; j++, at++)
            factor[i * N + j] = factor[j * N + i] = sum[at];
    memcpy(last, sum + N_PRODUCT - N - 1, (N + 1) * sizeof *last);
    return hf_dense_factor(N, factor, pivot) == 0;
}

static hf_surface_motion motion_of(const hf_surface_pose *q, const double step[N])
{
    bool is_round = q->kind == HF_SURFACE_PARABOLOID;
    double size = q->size_m;
    hf_surface_motion m = {.move = {size * step[1], is_round ? size * step[2] : 0, size * step[0]},
                           .curve = step[N - 1] / size};
    for (int d = 0; d < 3; d++)
        m.turn[d] = d < 2 || !is_round ? step[is_round ? 3 + d : 2 + d] : 0;
    return m;
}

static void take_step(hf_surface_pose *q, const double step[N])
{
    hf_surface_motion m = motion_of(q, step);
    move_pose(q, m.move, m.turn);
    q->curvature_per_m += m.curve;
}

/* Returns true if the pose is so far inside the bounds that the reference also treats this fit as determined. */
static bool is_well_inside(const hf_surface_pose *q)
{
    double ratio = q->curvature_per_m / q->wanted_per_m;
    double across = fmax(fabs(q->shift_m[0]), q->kind == HF_SURFACE_PARABOLOID ? fabs(q->shift_m[1]) : 0);
    return across <= ACROSS_MOST * q->size_m && ratio <= FOCAL_MOST && ratio >= 1 / FOCAL_MOST;
}

bool hf_surface_pose_near(const hf_surface_pose *from, int n, const double *position_m, const double *root_weight,
                          hf_surface_pose *pose, double *half_path_rms_m)
{
    problem p = {*from, n, {position_m, position_m + n, position_m + 2 * (size_t)n}, root_weight};
    double factor[N * N], last[N + 1], step[N], weight = 0;
    int pivot[N];
    if (from->n < N || !take_normal(&p, factor, pivot, last)) return false;
    for (int i = 0; i < n; i++)
        weight += root_weight ? root_weight[i] * root_weight[i] : 1;
    for (int k = 0; k < STEPS_MAX; k++) { /* the matrix of the first pose serves all steps, because they are small */
        double sum[N_PRODUCT];
        for (int j = 0; j < N; j++)
            step[j] = -last[j];
        hf_dense_solve(N, factor, pivot, 1, step);
        double gain = -hf_dot(N, last, step);
        take_step(&p.pose, step);
        if (fabs(gain) <= SETTLED * last[N]) {
            *half_path_rms_m = sqrt((last[N] - gain) / weight);
            *pose = p.pose;
            return is_well_inside(&p.pose);
        }
        sum_products(&p, false, sum);
        memcpy(last, sum, sizeof last);
    }
    return false;
}

bool hf_surface_fit_near(const hf_surface_pose *from, int n, const double *position_m, const double *root_weight,
                         double *half_path_rms_m)
{
    hf_surface_pose pose;
    return hf_surface_pose_near(from, n, position_m, root_weight, &pose, half_path_rms_m);
}

/* ---- changes of a fit ---- */

hf_surface_pose hf_surface_pose_moved(const hf_surface_pose *pose, const double step[N])
{
    hf_surface_pose moved = *pose;
    take_step(&moved, step);
    return moved;
}

/* With rows J and roots r of the weights, the step is -(J'J)^-1 J' r change. */
double hf_surface_pose_bound(const hf_surface_pose *pose, int n, const double *position_m, const double *root_weight,
                             const double gradient[N], double change_m)
{
    problem p = {*pose, n, {position_m, position_m + n, position_m + 2 * (size_t)n}, root_weight};
    double factor[N * N], last[N + 1], row[N + 1][LANES], by[N], sum = 0;
    int pivot[N];
    if (!take_normal(&p, factor, pivot, last)) return (double)NAN;
    memcpy(by, gradient, sizeof by);
    hf_dense_solve(N, factor, pivot, 1, by);
    for (int first = 0; first < n; first += LANES) {
        find_rows(&p, first, row);
        for (int k = 0; k < LANES && first + k < n; k++) {
            double pull = 0;
            for (int j = 0; j < N; j++)
                pull += row[j][k] * by[j];
            sum += (root_weight ? root_weight[first + k] : 1) * fabs(pull);
        }
    }
    return sum * change_m;
}

/* ---- derivatives of a fit ---- */

/* Computes the rate along a motion of the derivatives of r^2/2 by a point p in the frame of the surface, and by the
 * curvature (returned). r = u w is the half-path error: u = z - c s with s = x^2 + y^2, and w = 1/(1 + 4 c^2 s). */
static double rate_of_square(const hf_surface_pose *q, const hf_surface_motion *m, const double p[3], double rate[3])
{
    const double round_ = q->kind == HF_SURFACE_PARABOLOID, c = q->curvature_per_m;
    const double s = p[0] * p[0] + round_ * p[1] * p[1], u = p[2] - c * s, w = 1 / (1 + 4 * c * c * s);
    const double ws = -4 * c * c * w * w, wc = -8 * c * s * w * w, wss = -8 * c * c * w * ws;
    const double wsc = -8 * c * w * (w + c * wc), wcc = -8 * s * w * (w + 2 * c * wc);
    const double r = u * w, rs = u * ws - c * w, rc = u * wc - s * w;
    const double rss = u * wss - 2 * c * ws, rsc = u * wsc - w - c * wc - s * ws, rcc = u * wcc - 2 * s * wc;
    const double by[3] = {2 * p[0] * rs, round_ * 2 * p[1] * rs, w};
    double arm[3], v[3], turned[3];
    for (int d = 0; d < 3; d++)
        arm[d] = p[d] - q->center_m[d];
    hf_cross(m->turn, arm, v);
    for (int d = 0; d < 3; d++)
        v[d] += m->move[d];
    const double ds = 2 * (p[0] * v[0] + round_ * p[1] * v[1]), dr = hf_dot3(by, v) + rc * m->curve;
    const double drs = rss * ds + ws * v[2] + rsc * m->curve, drc = rsc * ds + wc * v[2] + rcc * m->curve;
    const double by_rate[3] = {2 * (v[0] * rs + p[0] * drs), round_ * 2 * (v[1] * rs + p[1] * drs),
                               ws * ds + wc * m->curve};
    hf_cross(m->turn, by, turned);
    for (int d = 0; d < 3; d++)
        rate[d] = dr * by[d] + r * (by_rate[d] - turned[d]);
    return dr * rc + r * drc;
}

/* Returns the rate of a figure along a motion, from its derivatives. */
static double dot_motion(const hf_surface_motion *by, const hf_surface_motion *m)
{
    return hf_dot3(by->move, m->move) + hf_dot3(by->turn, m->turn) + by->curve * m->curve;
}

/* Computes the rates along a motion: of the sums of the derivatives, and with `by`, of those by the points, which are
 * subtracted from by [3][n]. */
static hf_surface_motion push_square(const hf_surface_pose *q, int n, const double *x, const double *root_weight,
                                     const hf_surface_motion *m, double *by)
{
    hf_surface_motion sum = {0};
    for (int i = 0; i < n; i++) {
        double p[3] = {x[i], x[n + i], x[2 * (size_t)n + (size_t)i]}, rate[3], arm[3], turn[3];
        double weight = root_weight[i] * root_weight[i];
        sum.curve += weight * rate_of_square(q, m, p, rate);
        for (int d = 0; d < 3; d++)
            arm[d] = p[d] - q->center_m[d];
        hf_cross(arm, rate, turn);
        for (int d = 0; d < 3; d++) {
            sum.move[d] += weight * rate[d];
            sum.turn[d] += weight * turn[d];
            if (by) by[d * n + i] -= weight * rate[d];
        }
    }
    return sum;
}

/* Adds to by [3][n] that the points also move the centre, their mean, and the size, which is the unit of held shifts.
 * by_move: derivatives of the figure by a shift of all points in the frame of the surface. A whole fit undoes such a
 * shift. */
static void pull_center(const hf_surface_pose *q, int n, const double by_move[3], double *by)
{
    double held[3], by_center[3];
    for (int d = 0; d < 3; d++)
        held[d] = hf_dot3(q->turn[d], q->held_m);
    for (int d = 0; d < 3; d++) /* a shift of the centre by v moves the points by v - T v; seen in the frame, T v' */
        by_center[d] = hf_dot3(q->turn[d], by_move) - by_move[d];
    for (int d = 0; d < 3; d++)
        for (int i = 0; i < n; i++)
            by[d * n + i] += by_center[d] / n;
    for (int end = 0; end < 2; end++)
        for (int d = 0; d < 3; d++)
            by[d * n + q->size_end[end] % n] +=
                (end ? -1 : 1) * hf_dot3(held, by_move) / (2 * q->size_m) * q->turn[d][q->size_end[end] / n];
}

/* At the best fit, the gradient of the sum of squares by the parameters is 0. If the points move, the parameters move
 * by - H^-1 (change of this gradient), where H is the matrix of second derivatives. */
bool hf_surface_pose_pull(const hf_surface_pose *q, int n, const double *x, const double *root_weight,
                          const hf_surface_motion *by_fit, double *by)
{
    double matrix[N * N], by_step[N];
    int pivot[N];
    hf_surface_motion part[N], all = {0};
    if (q->n == 0) return false;
    for (int k = 0; k < q->n; k++) {
        double step[N] = {0};
        step[k] = 1;
        part[k] = q->n == N ? motion_of(q, step) : q->free[k];
        by_step[k] = dot_motion(by_fit, &part[k]);
    }
    for (int k = 0; k < q->n; k++) {
        hf_surface_motion rate = push_square(q, n, x, root_weight, &part[k], NULL);
        for (int j = 0; j < q->n; j++)
            matrix[j * q->n + k] = dot_motion(&rate, &part[j]);
    }
    if (hf_dense_factor(q->n, matrix, pivot) != 0) return false;
    hf_dense_solve(q->n, matrix, pivot, 1, by_step);
    for (int k = 0; k < q->n; k++) {
        for (int d = 0; d < 3; d++) {
            all.move[d] += by_step[k] * part[k].move[d];
            all.turn[d] += by_step[k] * part[k].turn[d];
        }
        all.curve += by_step[k] * part[k].curve;
    }
    hf_surface_motion left = push_square(q, n, x, root_weight, &all, by);
    for (int d = 0; d < 3; d++)
        left.move[d] = by_fit->move[d] - left.move[d];
    if (q->n < N) pull_center(q, n, left.move, by);
    return true;
}
