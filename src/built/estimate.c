/* Estimates the errors of an as-built net from measured positions, by the Gauss-Newton method:
 *
 *     errors e_k ---> shape x_k (hf_near_find or hf_built_solve) ---> linear model at x_k (built/linear)
 *      ^                                                                |
 *      |                                                                v
 *      |                                          saddle-point system (M41), damped (built/saddle)
 *      |                                                                |
 *      |   smaller misfit: k + 1                                        v
 *      +--------------------------- trial shape <--- errors e, predicted reduction of the misfit
 *          else: more damping
 *
 * Contents: making, shapes, steps, posterior samples. */
#include "built/estimate.h"

#include "base/arena.h"
#include "base/random.h"
#include "linalg/dot.h"

#include <math.h>
#include <string.h>

#define STEPS_MAX 100
#define SETTLED 1e-10 /* predicted reduction, relative to the misfit, at which it has converged */
/* Smaller misfits count as this one. Half of chi^2 is below it for positions without noise, such as those of a
 * design. */
#define MISFIT_MIN 1.0
#define NEAR_SETTLED 1e-3 /* factor of SETTLED for damped steps; the rounding of shapes damps them */
#define ENOUGH 1e-4       /* fraction of the predicted reduction that a step must reach */
#define DAMPING_MIN 0.05  /* damping up to this value is dropped instead of reduced */
#define DAMPING_MAX 1e12
#define PANEL HF_SADDLE_PANEL /* samples solved together */
#define SEED 20260000u        /* of the random signs; only statistical figures depend on it */

/* ---- making ---- */

/* Allocates all arrays. */
static hf_status allocate(hf_estimate *p)
{
    size_t n_cable = (size_t)p->built->model.n_cable, n_dof = p->linear.n_dof, n_shared = (size_t)p->prior.n_shared;
    hf_estimate_scratch *s = &p->scratch;
    return HF_ARENA_ARRAYS(&p->block, HF_ARRAY(p->cut_m, n_cable), HF_ARRAY(p->rest_m, n_dof),
                           HF_ARRAY(p->shared, n_shared), HF_ARRAY(s->cut_m, PANEL * n_cable),
                           HF_ARRAY(s->rest_m, PANEL * n_dof), HF_ARRAY(s->gap_m, PANEL * n_dof),
                           HF_ARRAY(s->shared, PANEL * n_shared), HF_ARRAY(s->trial_m, n_dof),
                           HF_ARRAY(s->move_m, PANEL * n_dof), HF_ARRAY(s->band, PANEL * (size_t)p->saddle.n_band),
                           HF_ARRAY(s->length_m, n_cable), HF_ARRAY(s->support_m, n_dof),
                           HF_ARRAY(s->strain_N, PANEL * n_cable), HF_ARRAY(s->linear, PANEL * p->linear.n_scratch),
                           HF_ARRAY(p->last.position_m, n_dof), HF_ARRAY(p->last.tension_N, n_cable));
}

hf_status hf_estimate_create(const hf_built *b, const hf_saddle_prior *prior, const double *position_m, hf_estimate *p)
{
    *p = (hf_estimate){.built = b, .prior = *prior, .position_m = position_m};
    HF_TRY(hf_built_linear_make(b, &p->linear));
    HF_TRY(hf_saddle_create(&p->linear, &p->prior, &p->saddle));
    HF_TRY(hf_workspace_create(&b->model, &p->work));
    HF_TRY(allocate(p));
    double *last_m = p->last.position_m, *last_N = p->last.tension_N;
    p->last = *b;
    p->last.position_m = memcpy(last_m, b->position_m, p->linear.n_dof * sizeof *last_m);
    p->last.tension_N = memcpy(last_N, b->tension_N, (size_t)b->model.n_cable * sizeof *last_N);
    if (b->model.n_attachment) return HF_OK;
    hf_status status = hf_near_create(b, &p->work, &p->near);
    p->has_near = status == HF_OK;
    return status == HF_NO_MEMORY ? status : HF_OK;
}

void hf_estimate_free(hf_estimate *p)
{
    hf_built_linear_free(&p->linear);
    hf_saddle_free(&p->saddle);
    hf_near_free(&p->near);
    hf_workspace_free(&p->work);
    hf_arena_free_block(p->block);
    *p = (hf_estimate){0};
}

/* ---- shapes ---- */

/* Solves a net by Newton's method from the shape solved last. This takes fewer steps than the reference hf_built_solve
 * and rarely fails. The reference solves the nets for which it fails.
 *
 * On a truss it always calls the reference. Newton's method may leave gaps of coupling.tof_m there, which are too large
 * for a measured figure. */
static hf_status solve_from_last(const hf_estimate *p, const hf_built_net *net, hf_workspace *w, hf_form_result *r)
{
    const hf_model *m = &p->built->model;
    hf_near from = p->near;
    from.built = &p->last;
    if (!p->has_near || !hf_near_find(&from, net, w, r)) HF_TRY(hf_built_solve(p->built, net, w, r));
    /* Supports stay at their nominal positions, because displacements of a net are added to these. */
    for (int c = 0; c < 3; c++)
        memcpy(p->last.position_m + c * m->n_node, w->position_m + c * m->n_node, (size_t)m->n_free * sizeof(double));
    memcpy(p->last.tension_N, w->tension_N, (size_t)m->n_cable * sizeof(double));
    return HF_OK;
}

/* Solves the net with errors cut_m [n_cable] and rest_m [n_dof] and with adjustments adjustment_m [n_cable] (NULL:
 * none). */
static hf_status solve_net(const hf_estimate *p, const double *cut_m, const double *rest_m, const double *adjustment_m,
                           hf_workspace *w, hf_form_result *r)
{
    const hf_model *m = &p->built->model;
    const hf_estimate_scratch *s = &p->scratch;
    for (int e = 0; e < m->n_cable; e++)
        s->length_m[e] = m->target[e] + cut_m[e] + (adjustment_m ? adjustment_m[e] : 0);
    for (int row = 0; row < m->n_node; row++)
        for (int c = 0; c < 3; c++)
            s->support_m[c * m->n_node + row] = row < m->n_free ? 0 : rest_m[3 * row + c];
    return solve_from_last(p, &(hf_built_net){.cut_m = s->length_m, .support_displacement_m = s->support_m}, w, r);
}

hf_status hf_estimate_shape(const hf_estimate *p, const double *adjustment_m, hf_workspace *w, hf_form_result *r)
{
    return solve_net(p, p->cut_m, p->rest_m, adjustment_m, w, r);
}

/* Returns the error of the length of cable e by numbers that cables share, m. */
static double shared_error_m(const hf_estimate *p, const double *shared, int e)
{
    double sum = 0;
    for (int k = 0; k < p->prior.n_shared; k++)
        sum += shared[k] * p->prior.shared_m[(size_t)k * (size_t)p->built->model.n_cable + (size_t)e];
    return sum;
}

double hf_estimate_own_m(const hf_estimate *p, int e)
{
    return p->cut_m[e] - shared_error_m(p, p->shared, e);
}

/* Returns half the sum of squares of all errors, each divided by its sigma. */
static double misfit_of_errors(const hf_estimate *p, const double *cut_m, const double *rest_m, const double *shared)
{
    double sum = 0, rest = p->prior.support_sigma_m;
    for (int e = 0; e < p->built->model.n_cable; e++) {
        double own = cut_m[e] - shared_error_m(p, shared, e), sigma = p->prior.sigma_m[e];
        if (sigma > 0) sum += own * own / (sigma * sigma);
    }
    for (int k = 0; k < p->prior.n_shared; k++)
        sum += shared[k] * shared[k];
    for (size_t i = 3 * (size_t)p->built->model.n_free; i < p->linear.n_dof && rest > 0; i++)
        sum += rest_m[i] * rest_m[i] / (rest * rest);
    return sum / 2;
}

/* Sets gap_m [n_dof] to measured minus present positions, and to 0 where nothing was measured. */
static void find_gap(const hf_estimate *p, double *gap_m)
{
    const hf_model *m = &p->built->model;
    for (int row = 0; row < m->n_node; row++)
        for (int c = 0; c < 3; c++) {
            int i = 3 * row + c;
            bool is_measured = p->prior.weight_per_m2[i] > 0;
            gap_m[i] = is_measured ? p->position_m[i] - p->work.position_m[c * m->n_node + row] : 0;
        }
}

/* Returns half the sum of squares of the differences gap_m - move_m, each divided by its sigma. move_m may be NULL. */
static double misfit_of_positions(const hf_estimate *p, const double *gap_m, const double *move_m)
{
    double sum = 0;
    for (size_t i = 0; i < p->linear.n_dof; i++) {
        double left = gap_m[i] - (move_m ? move_m[i] : 0);
        sum += p->prior.weight_per_m2[i] * left * left;
    }
    return sum / 2;
}

/* Solves the net with these errors and computes its differences and misfit. *misfit is INFINITY when it has no
 * shape. */
static hf_status try_errors(hf_estimate *p, const double *cut_m, const double *rest_m, const double *shared,
                            double *gap_m, double *misfit)
{
    hf_status status = solve_net(p, cut_m, rest_m, NULL, &p->work, &p->form);
    *misfit = (double)INFINITY;
    if (status != HF_OK) return status;
    find_gap(p, gap_m);
    *misfit = misfit_of_errors(p, cut_m, rest_m, shared) + misfit_of_positions(p, gap_m, NULL);
    return HF_OK;
}

/* ---- steps ---- */

/* Solves the saddle-point system for the first n right-hand sides of the scratch. */
static hf_status ask_saddle(const hf_estimate *p, int n)
{
    const hf_estimate_scratch *s = &p->scratch;
    hf_saddle_answer answer[PANEL];
    size_t n_dof = p->linear.n_dof, n_cable = (size_t)p->built->model.n_cable, n_shared = (size_t)p->prior.n_shared;
    for (size_t k = 0; k < (size_t)n; k++)
        answer[k] = (hf_saddle_answer){s->gap_m + k * n_dof, s->cut_m + k * n_cable, s->rest_m + k * n_dof,
                                       s->move_m + k * n_dof, s->shared + k * n_shared};
    return hf_saddle_solve(&p->saddle, n, answer, s->band);
}

/* Solves the linear model with damping t and writes its errors to cut_m, rest_m and shared of the scratch.
 *
 * Let e_k be the present errors, S their prior covariance and m(x) the misfit of the positions. The step minimises
 *
 *     e'S^-1 e/2 + t (e - e_k)'S^-1 (e - e_k)/2 + m(x).
 *
 * Up to a constant, the first two terms are (1 + t) d'S^-1 d/2 with d = e - e_k t/(1 + t). Division by 1 + t gives the
 * undamped system in d, with all weights of positions divided by 1 + t. *promise is the reduction of the misfit that
 * the undamped model predicts for this step. Returns HF_OK or HF_SINGULAR. */
static hf_status aim(const hf_estimate *p, double damping, double *promise)
{
    const hf_estimate_scratch *s = &p->scratch;
    size_t n_cable = (size_t)p->built->model.n_cable, n_dof = p->linear.n_dof;
    double part = 1 / (1 + damping);
    for (size_t e = 0; e < n_cable; e++)
        s->cut_m[e] = part * p->cut_m[e];
    for (size_t i = 0; i < n_dof; i++)
        s->rest_m[i] = part * p->rest_m[i];
    HF_TRY(ask_saddle(p, 1));
    hf_add(n_cable, 1 - part, p->cut_m, s->cut_m);
    hf_add(n_dof, 1 - part, p->rest_m, s->rest_m);
    hf_add((size_t)p->prior.n_shared, 1 - part, p->shared, s->shared);
    *promise =
        p->misfit - misfit_of_errors(p, s->cut_m, s->rest_m, s->shared) - misfit_of_positions(p, s->gap_m, s->move_m);
    return HF_OK;
}

/* Returns the damping after a step. `ratio` is its reduction of the misfit, divided by the predicted one. */
static double damp(double damping, double ratio)
{
    if (ratio < 0.25) return fmax(1, 10 * damping);
    if (ratio < 0.75 || damping == 0) return damping;
    return damping > DAMPING_MIN ? damping / 10 : 0;
}

hf_status hf_estimate_find(hf_estimate *p)
{
    const hf_model *m = &p->built->model;
    const hf_estimate_scratch *s = &p->scratch;
    double damping = 0, misfit, promise;
    bool is_new = true; /* the shape is newer than the linear model */
    HF_TRY(try_errors(p, p->cut_m, p->rest_m, p->shared, s->gap_m, &p->misfit));
    for (p->n_step = 0; p->n_step < STEPS_MAX && damping < DAMPING_MAX; p->n_step++) {
        if (is_new && hf_built_linear_take(&p->linear, &p->work) != HF_OK) break;
        if (hf_saddle_factor(&p->saddle, damping) != HF_OK) break;
        if (aim(p, damping, &promise) != HF_OK) break;
        p->is_settled = !(promise > (damping > 0 ? NEAR_SETTLED : 1) * SETTLED * fmax(p->misfit, MISFIT_MIN));
        if (p->is_settled) break;
        hf_status status = try_errors(p, s->cut_m, s->rest_m, s->shared, s->trial_m, &misfit);
        if (status == HF_INTERRUPTED || status == HF_NO_MEMORY) return status;
        double ratio = (p->misfit - misfit) / promise; /* -INFINITY without a shape */
        damping = damp(damping, ratio);
        is_new = ratio > ENOUGH;
        if (!is_new) continue;
        p->misfit = misfit;
        memcpy(p->cut_m, s->cut_m, (size_t)m->n_cable * sizeof *s->cut_m);
        memcpy(p->rest_m, s->rest_m, p->linear.n_dof * sizeof *s->rest_m);
        memcpy(p->shared, s->shared, (size_t)p->prior.n_shared * sizeof *s->shared);
        memcpy(s->gap_m, s->trial_m, p->linear.n_dof * sizeof *s->gap_m);
    }
    return is_new ? HF_OK : try_errors(p, p->cut_m, p->rest_m, p->shared, s->gap_m, &misfit);
}

/* ---- posterior samples ---- */

static double random_sign(hf_random *random)
{
    return hf_random_next(random) >> 63 ? 1 : -1;
}

/* Draws the errors of one sample, each as large as its sigma, with random signs. Sets own_m [n_cable] to the errors of
 * lengths (NULL: not stored), strain_N [n_cable] to their strains, and move_m [n_dof] at the supports. */
static void draw_errors(const hf_estimate *p, hf_random *random, double *own_m, double *strain_N, double *move_m)
{
    const hf_model *m = &p->built->model;
    double *shared = p->scratch.shared;
    for (int k = 0; k < p->prior.n_shared; k++)
        shared[k] = random_sign(random);
    for (int e = 0; e < m->n_cable; e++) {
        double cut_m = random_sign(random) * p->prior.sigma_m[e] + shared_error_m(p, shared, e);
        strain_N[e] = p->linear.cut_N_per_m[e] * cut_m;
        if (own_m) own_m[e] = cut_m;
    }
    for (size_t i = 3 * (size_t)m->n_free; i < p->linear.n_dof; i++)
        move_m[i] = random_sign(random) * p->prior.support_sigma_m;
}

/* Computes the displacements move_m [n][n_dof] of random errors for samples from `first` on. cause receives these
 * errors; it may be NULL. Returns n, at most PANEL. */
static int draw_displacements(const hf_estimate *p, int stream, int first, hf_random random[PANEL], double *move_m,
                              const hf_estimate_cause *cause)
{
    double *strain_N = p->scratch.strain_N;
    int n = HF_ESTIMATE_SAMPLES - first < PANEL ? HF_ESTIMATE_SAMPLES - first : PANEL;
    for (int k = 0; k < n; k++) {
        random[k] = hf_random_stream(SEED, stream, first + k);
        double *cut_m = cause ? cause->cut_m + (ptrdiff_t)(first + k) * p->built->model.n_cable : NULL;
        draw_errors(p, &random[k], cut_m, strain_N + (ptrdiff_t)k * p->built->model.n_cable,
                    move_m + (size_t)k * p->linear.n_dof);
    }
    if (cause)
        memcpy(cause->rest_m + (size_t)first * p->linear.n_dof, move_m, (size_t)n * p->linear.n_dof * sizeof *move_m);
    hf_built_linear_apply(&p->linear, NULL, n, strain_N, NULL, move_m, p->scratch.linear);
    return n;
}

hf_status hf_estimate_expect(hf_estimate *p, double *expected_m)
{
    const hf_model *m = &p->built->model;
    double *move_m = p->scratch.move_m;
    hf_random random[PANEL];
    memset(expected_m, 0, (size_t)m->n_node * sizeof *expected_m);
    for (int first = 0; first < HF_ESTIMATE_SAMPLES; first += PANEL) {
        int n = draw_displacements(p, 0, first, random, move_m, NULL);
        for (int i = 0; i < n * 3 * m->n_node; i++)
            expected_m[i / 3 % m->n_node] += move_m[i] * move_m[i] / HF_ESTIMATE_SAMPLES;
    }
    for (int row = 0; row < m->n_node; row++)
        expected_m[row] = sqrt(expected_m[row]);
    return HF_OK;
}

/* Sets gap_m [n_dof] to what a measurement with random errors finds of the displacements move_m [n_dof]. */
static void draw_gap(const hf_estimate *p, hf_random *random, const double *move_m, double *gap_m)
{
    for (size_t i = 0; i < p->linear.n_dof; i++) {
        double weight = p->prior.weight_per_m2[i], sign = random_sign(random);
        gap_m[i] = weight > 0 ? move_m[i] + sign / sqrt(weight) : 0;
    }
}

/* Let S be the prior and P the posterior variance of a cable's own error. The estimate of a unit error of this cable is
 * 1 - P/S. The positions alone have the information 1/P - 1/S, so they would give this estimate divided by 1 - P/S. */
hf_status hf_estimate_belief(hf_estimate *p, int n, const int *cable, double *part)
{
    size_t n_dof = p->linear.n_dof, n_cable = (size_t)p->built->model.n_cable;
    const hf_estimate_scratch *s = &p->scratch;
    HF_TRY(hf_built_linear_take(&p->linear, &p->work));
    HF_TRY(hf_saddle_factor(&p->saddle, 0));
    for (int k = 0; k < n; k++) {
        int e = cable[k];
        memset(s->strain_N, 0, n_cable * sizeof *s->strain_N);
        memset(s->move_m, 0, n_dof * sizeof *s->move_m);
        memset(s->cut_m, 0, n_cable * sizeof *s->cut_m);
        memset(s->rest_m, 0, n_dof * sizeof *s->rest_m);
        s->strain_N[e] = p->linear.cut_N_per_m[e];
        hf_built_linear_apply(&p->linear, NULL, 1, s->strain_N, NULL, s->move_m, s->linear);
        for (size_t i = 0; i < n_dof; i++)
            s->gap_m[i] = p->prior.weight_per_m2[i] > 0 ? s->move_m[i] : 0;
        HF_TRY(ask_saddle(p, 1));
        part[k] = s->cut_m[e] - shared_error_m(p, s->shared, e);
    }
    return HF_OK;
}

/* Subtracts the estimates of n samples from their strains, and adds the squares of the resulting changes of tension to
 * square_N [n_cable]. */
static void add_tensions(const hf_estimate *p, int n, const double *move_m, double *square_N)
{
    size_t n_cable = (size_t)p->built->model.n_cable;
    for (int k = 0; k < n; k++) {
        double *strain_N = p->scratch.strain_N + (size_t)k * n_cable;
        double *change_N = p->scratch.cut_m + (size_t)k * n_cable;
        for (size_t e = 0; e < n_cable; e++)
            strain_N[e] -= p->linear.cut_N_per_m[e] * change_N[e];
        hf_built_linear_tension(&p->linear, strain_N, move_m + (size_t)k * p->linear.n_dof, change_N);
        for (size_t e = 0; e < n_cable; e++)
            square_N[e] += change_N[e] * change_N[e];
    }
}

hf_status hf_estimate_doubt(hf_estimate *p, double *move_m, double *sigma_N, const hf_estimate_cause *cause)
{
    size_t n_dof = p->linear.n_dof, n_cable = (size_t)p->built->model.n_cable;
    const hf_estimate_scratch *s = &p->scratch;
    hf_random random[PANEL];
    memset(sigma_N, 0, n_cable * sizeof *sigma_N);
    HF_TRY(hf_built_linear_take(&p->linear, &p->work));
    HF_TRY(hf_saddle_factor(&p->saddle, 0));
    for (int first = 0; first < HF_ESTIMATE_SAMPLES; first += PANEL) {
        double *move = move_m + (size_t)first * n_dof;
        int n = draw_displacements(p, 1, first, random, move, cause);
        for (int k = 0; k < n; k++)
            draw_gap(p, &random[k], move + (size_t)k * n_dof, s->gap_m + (size_t)k * n_dof);
        memset(s->cut_m, 0, (size_t)n * n_cable * sizeof *s->cut_m);
        memset(s->rest_m, 0, (size_t)n * n_dof * sizeof *s->rest_m);
        HF_TRY(ask_saddle(p, n));
        hf_subtract((size_t)n * n_dof, 1, s->move_m, move);
        if (cause) hf_subtract((size_t)n * n_cable, 1, s->cut_m, cause->cut_m + (size_t)first * n_cable);
        if (cause) hf_subtract((size_t)n * n_dof, 1, s->rest_m, cause->rest_m + (size_t)first * n_dof);
        add_tensions(p, n, move, sigma_N);
    }
    for (size_t e = 0; e < n_cable; e++)
        sigma_N[e] = sqrt(sigma_N[e] / HF_ESTIMATE_SAMPLES);
    return HF_OK;
}

void hf_estimate_spread(const double value[HF_ESTIMATE_SAMPLES], double *rms, double *deviation)
{
    double mean = 0, square = 0;
    for (int s = 0; s < HF_ESTIMATE_SAMPLES; s++) {
        mean += value[s] / HF_ESTIMATE_SAMPLES;
        square += value[s] * value[s] / HF_ESTIMATE_SAMPLES;
    }
    *rms = sqrt(square);
    *deviation = sqrt(fmax(square - mean * mean, 0));
}
