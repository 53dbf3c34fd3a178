/* Laws of the best fit on random surfaces: cylinders and paraboloids with smooth errors, half of them their own mirror
 * image in x and y, where steps from a symmetric start can end on a ridge. HIFDM_TEST_SEED=... replays a run; the
 * number after the test's name is the trial. */
#include "laws.h"

#include "surface/surface_near.h"

enum { N_TRIAL = 40, N_NET = 4, N_START = 3, SIDE = 9, N = SIDE * SIDE, N_PARAMETER = HF_FIT_N_PARAMETER, POWER = 6 };

/* Points over 6 m by 6 m, [3][N], with errors of 0.1 to 10 mm times the polynomials to the sixth power. */
static void random_surface(struct rng *rng, hf_surface_kind kind, bool is_mirrored, double focal_length_m, double *p)
{
    double factor[POWER + 1][POWER + 1], size_m = pow(10, rng_uniform(rng, -4, -2));
    for (int i = 0; i <= POWER; i++)
        for (int j = 0; j <= POWER; j++) {
            factor[i][j] = rng_uniform(rng, -1, 1) * size_m;
            if (i + j > POWER || (is_mirrored && (i % 2 || j % 2))) factor[i][j] = 0;
        }
    for (int k = 0; k < N; k++) {
        double x = -1 + 2.0 * (k % SIDE) / (SIDE - 1), y = -1 + 2.0 * (k / SIDE) / (SIDE - 1), error = 0;
        for (int i = 0; i <= POWER; i++)
            for (int j = 0; j <= POWER; j++)
                error += factor[i][j] * pow(x, i) * pow(y, j);
        p[k] = 3 * x;
        p[N + k] = 3 * y;
        p[2 * N + k] = 9 * (x * x + (kind == HF_SURFACE_PARABOLOID ? y * y : 0)) / (4 * focal_length_m) + error;
    }
}

/* ---- another way to the least ---- */

/* Half-path errors [N] of the points against a surface of these parameters; their sum of squares. */
static double errors_at(hf_surface_kind kind, double focal_length_m, const double *p, const hf_fit_parameters *at,
                        double *error)
{
    double c = (1 + at->value[HF_FIT_CURVE]) / (4 * focal_length_m), sum = 0;
    for (int i = 0; i < N; i++) {
        double q[3];
        for (int d = 0; d < 3; d++) {
            int shift = d == 0 ? HF_FIT_SHIFT_X : d == 1 ? HF_FIT_SHIFT_Y : HF_FIT_SHIFT_Z;
            q[d] = p[d * N + i] - at->center_m[d] - at->size_m * at->value[shift];
        }
        for (int k = 0; k < 3; k++) { /* back by the turns about x, y and z */
            int a = (k + 1) % 3, b = (k + 2) % 3;
            double u = q[a], v = q[b], angle = at->value[HF_FIT_TURN_X + k];
            q[a] = cos(angle) * u + sin(angle) * v;
            q[b] = cos(angle) * v - sin(angle) * u;
        }
        double x = q[0] + at->center_m[0], y = kind == HF_SURFACE_PARABOLOID ? q[1] + at->center_m[1] : 0;
        double square = x * x + y * y;
        error[i] = (q[2] + at->center_m[2] - c * square) / (1 + 4 * c * c * square);
        sum += error[i] * error[i];
    }
    return sum;
}

/* Is it where the fit is determined (METHOD section 9)? */
static bool is_inside(const hf_fit_parameters *at)
{
    const double *v = at->value;
    return fabs(v[HF_FIT_SHIFT_X]) <= 0.1 && fabs(v[HF_FIT_SHIFT_Y]) <= 0.1 && fabs(log(1 + v[HF_FIT_CURVE])) <= log(2);
}

/* x [n] of A x = b, A [n][n] positive, by elimination. */
static void eliminate(int n, double A[N_PARAMETER][N_PARAMETER], double *x)
{
    for (int k = 0; k < n; k++)
        for (int i = k + 1; i < n; i++) {
            double by = A[i][k] / A[k][k];
            for (int j = k; j < n; j++)
                A[i][j] -= by * A[k][j];
            x[i] -= by * x[k];
        }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++)
            x[k] -= A[k][j] * x[j];
        x[k] /= A[k][k];
    }
}

/* The sum of squares below `at`, over its parameters: Levenberg's and Marquardt's steps by differences, that leave the
 * bounds never. */
static double least_below(hf_surface_kind kind, double focal_length_m, const double *p, hf_fit_parameters at)
{
    static double error[N], other[N], slope[N_PARAMETER][N];
    double damping = 1e-3, sum = errors_at(kind, focal_length_m, p, &at, error);
    for (int round = 0; round < 60 && damping < 1e12; round++) {
        for (int k = 0; k < at.n; k++) {
            hf_fit_parameters aside[2] = {at, at};
            aside[0].value[at.quantity[k]] -= 1e-5;
            aside[1].value[at.quantity[k]] += 1e-5;
            errors_at(kind, focal_length_m, p, &aside[0], other);
            errors_at(kind, focal_length_m, p, &aside[1], slope[k]);
            for (int i = 0; i < N; i++)
                slope[k][i] = (slope[k][i] - other[i]) / 2e-5;
        }
        for (bool is_lower = false; !is_lower && damping < 1e12; damping *= is_lower ? 0.1 : 10) {
            double A[N_PARAMETER][N_PARAMETER] = {{0}}, step[N_PARAMETER] = {0};
            hf_fit_parameters next = at;
            for (int k = 0; k < at.n; k++) {
                for (int i = 0; i < N; i++) {
                    step[k] -= slope[k][i] * error[i];
                    for (int j = 0; j < at.n; j++)
                        A[k][j] += slope[k][i] * slope[j][i];
                }
                A[k][k] *= 1 + damping;
            }
            eliminate(at.n, A, step);
            for (int k = 0; k < at.n; k++)
                next.value[at.quantity[k]] += step[k];
            double there = errors_at(kind, focal_length_m, p, &next, other);
            is_lower = is_inside(&next) && there < sum;
            if (!is_lower) continue;
            at = next;
            sum = errors_at(kind, focal_length_m, p, &at, error);
        }
    }
    return sum;
}

/* ---- laws ---- */

/* Over the parameters that the points determine no start nearby ends lower than the fit, within its bounds. */
START_TEST(no_start_nearby_ends_lower)
{
    struct rng rng = rng_start((uint64_t)_i);
    double p[3 * N], error[N];
    for (int i = 0; i < N_NET; i++) {
        hf_surface_kind kind = i % 2 ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER;
        double f = 6 * pow(10, rng_uniform(&rng, -0.4, 0.6));
        hf_surface_fit fit;
        hf_fit_parameters found;
        random_surface(&rng, kind, i / 2 == 0, f, p);
        ck_assert_int_eq(hf_surface_fit_find(kind, f, N, p, NULL, &fit, &found), HF_OK);
        ck_assert_int_eq(found.n_held, 0); /* errors alone hold nothing at its bound */
        if (!fit.converged) continue;
        double sum = errors_at(kind, f, p, &found, error);
        ck_assert_double_eq_tol(sqrt(sum / N), fit.half_path_rms_m, 1e-9 * fit.half_path_rms_m + 1e-15);
        for (int start = 0; start < N_START; start++) {
            hf_fit_parameters from = found;
            double by = pow(10, -1.5 - start);
            for (int k = 0; k < found.n; k++)
                from.value[found.quantity[k]] += rng_uniform(&rng, -by, by);
            if (!is_inside(&from)) continue;
            double other = least_below(kind, f, p, from);
            ck_assert_msg(sqrt(other) > (1 - 1e-6) * sqrt(sum),
                          "net %d, f %g m, %d parameters: %.17g, another start %.17g", i, f, found.n, sqrt(sum / N),
                          sqrt(other / N));
        }
    }
}
END_TEST

/* The fit from one nearby ends where the reference does, or leaves it to that. */
START_TEST(fit_from_a_mirrored_net_is_the_reference)
{
    struct rng rng = rng_start(1000 + (uint64_t)_i);
    double p[3 * N], near;
    for (int i = 0; i < N_NET; i++) {
        hf_surface_kind kind = i % 2 ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER;
        double f = 6 * pow(10, rng_uniform(&rng, -0.4, 0.6)), by = pow(10, rng_uniform(&rng, -8, -4));
        hf_surface_fit fit;
        hf_fit_parameters found;
        random_surface(&rng, kind, true, f, p);
        ck_assert_int_eq(hf_surface_fit_find(kind, f, N, p, NULL, &fit, &found), HF_OK);
        hf_surface_pose pose = hf_surface_pose_of(kind, f, &fit, &found);
        for (int k = 0; k < 3 * N; k++)
            p[k] += rng_uniform(&rng, -by, by);
        if (!hf_surface_fit_near(&pose, N, p, NULL, &near)) continue;
        ck_assert_int_eq(hf_surface_fit_points(kind, f, N, p, NULL, &fit), HF_OK);
        ck_assert_msg(fabs(near - fit.half_path_rms_m) <= 1e-9 * near, "f %g m: %.17g, from nearby %.17g", f,
                      fit.half_path_rms_m, near);
    }
}
END_TEST

Suite *suite_property_surface_fit(void)
{
    Suite *suite = suite_create("property/surface_fit");
    TCase *tests = tcase_create("surface_fit");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, no_start_nearby_ends_lower, 0, N_TRIAL);
    tcase_add_loop_test(tests, fit_from_a_mirrored_net_is_the_reference, 0, N_TRIAL);
    return suite;
}
