/* Descends to a minimum of a best fit:
 *
 *     parameters -> gradient G, Hessian H -> if H has a negative pivot: one step along it
 *       -> damped Newton steps, each accepted only if the sum of squares does not rise -> minimum
 *
 * Contents: curvature - steps */
#include "surface/fit_descend.h"

#include "linalg/dense.h"

#include <math.h>
#include <string.h>

enum { N = HF_FIT_N_PARAMETER };

#define STEPS_MAX 60
#define STEP_MOST 0.1       /* maximum step, for parameters of order one; keeps steps in their valley */
#define FALL_STEP 1e-2      /* first step, down from a ridge */
#define PIVOT_LEAST 1e-12   /* relative to the diagonal; a smaller pivot is rounding */
#define DAMPING_LEAST 1e-12 /* relative to the diagonal */
#define DAMPING_MOST 1e6
#define SETTLED 1e-13 /* converged if fall_by of a Newton step is below this share of half the sum of squares */

/* ---- curvature ---- */

/* Factors H [n][n] as L D L'. A negative pivot of row k is the curvature along x with L' x = e_k. Returns true and x
 * [n] if there is one. */
static bool find_fall(int n, const double *H, double *x)
{
    double L[N][N] = {{0}}, D[N];
    for (int k = 0; k < n; k++) {
        for (int j = 0; j <= k; j++) {
            double left = H[k * n + j];
            for (int i = 0; i < j; i++)
                left -= L[k][i] * D[i] * L[j][i];
            if (j == k)
                D[k] = fabs(left) > PIVOT_LEAST * fabs(H[k * n + k]) ? left : 0;
            else
                L[k][j] = D[j] != 0 ? left / D[j] : 0;
        }
        if (D[k] >= 0) continue;
        memset(x, 0, (size_t)n * sizeof *x);
        x[k] = 1;
        for (int j = k - 1; j >= 0; j--)
            for (int i = j + 1; i <= k; i++)
                x[j] -= L[i][j] * x[i];
        return true;
    }
    return false;
}

bool hf_fit_is_least(const hf_fit_frame *f)
{
    double G[N], H[N * N], x[N];
    hf_fit_hessian(f, G, H);
    return !find_fall(f->found->n, H, x);
}

/* ---- steps ---- */

static double largest(int n, const double *x)
{
    double most = 0;
    for (int k = 0; k < n; k++)
        most = fmax(most, fabs(x[k]));
    return most;
}

static void move(hf_fit_parameters *at, const double *step)
{
    for (int k = 0; k < at->n; k++)
        at->value[at->quantity[k]] += step[k];
}

/* Computes step [n] = -(H + damping diag H)^-1 G. Returns false if this matrix is not positive, or if the step
 * is too long. */
static bool find_step(int n, const double *H, const double *G, double damping, double *step)
{
    double A[N * N], x[N];
    int pivot[N];
    memcpy(A, H, (size_t)(n * n) * sizeof *A);
    for (int k = 0; k < n; k++) {
        A[k * n + k] += damping * fabs(H[k * n + k]);
        step[k] = -G[k];
    }
    if (find_fall(n, A, x) || hf_dense_factor(n, A, pivot) != 0) return false;
    hf_dense_solve(n, A, pivot, 1, step);
    return largest(n, step) <= STEP_MOST;
}

/* Returns half the sum of squares at other parameters, with its derivatives G and H. */
static double look(const hf_fit_frame *f, const hf_fit_parameters *at, double *G, double *H)
{
    hf_fit_frame here = hf_fit_frame_of(f->kind, 1 / (4 * f->wanted_per_m), f->n, f->position_m, f->root_weight, at);
    return hf_fit_hessian(&here, G, H);
}

/* Returns twice the decrease of half the sum of squares that a Newton step predicts. */
static double fall_by(int n, const double *G, const double *step)
{
    double fall = 0;
    for (int k = 0; k < n; k++)
        fall -= G[k] * step[k];
    return fall;
}

/* Takes a step. A step along a curved valley ends on its side, above its start. A second step from there then leads to
 * the floor of the valley. Returns false and changes nothing if this is not lower either. */
static bool take_step(const hf_fit_frame *f, hf_fit_parameters *at, const double *step, double damping, double *sum,
                      double *G, double *H)
{
    hf_fit_parameters to = *at;
    double back[N], to_G[N], to_H[N * N];
    move(&to, step);
    double next = look(f, &to, to_G, to_H);
    if (!(next <= *sum) && find_step(to.n, to_H, to_G, damping, back)) {
        move(&to, back);
        next = look(f, &to, to_G, to_H);
    }
    if (!(next <= *sum)) return false;
    *at = to;
    *sum = next;
    memcpy(G, to_G, sizeof to_G);
    memcpy(H, to_H, sizeof to_H);
    return true;
}

bool hf_fit_descend(const hf_fit_frame *f, hf_fit_parameters *at, double across_most, int *iterations)
{
    double G[N], H[N * N], step[N], damping = 0, sum = look(f, at, G, H);
    if (find_fall(at->n, H, step)) {
        double by = FALL_STEP / largest(at->n, step);
        for (int k = 0; k < at->n; k++)
            step[k] *= by;
        move(at, step);
        sum = look(f, at, G, H);
    }
    for (int n = 0; n < STEPS_MAX; n++) {
        ++*iterations;
        if (fmax(fabs(at->value[HF_FIT_SHIFT_X]), fabs(at->value[HF_FIT_SHIFT_Y])) > across_most) return false;
        if (find_step(at->n, H, G, 0, step) && fall_by(at->n, G, step) <= SETTLED * sum) {
            move(at, step);
            return true;
        }
        while (!find_step(at->n, H, G, damping, step) || !take_step(f, at, step, damping, &sum, G, H)) {
            damping = fmax(10 * damping, DAMPING_LEAST);
            if (!(damping < DAMPING_MOST)) return false;
        }
        damping /= 10;
    }
    return false;
}
