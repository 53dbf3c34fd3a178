/* Contents: making - shapes - steps - samples */
#include "built/estimate.h"

#include "base/arena.h"
#include "base/random.h"

#include <math.h>
#include <string.h>

#define STEPS_MAX 100
#define SETTLED 1e-10      /* of the misfit: what a step promises at the end */
#define LEAST_MISFIT 1.0   /* half of chi^2: less of it is a table without noise, as of a design that is read again */
#define NEAR_SETTLED 1e-3  /* of that, where rounding of shapes damps the steps */
#define ENOUGH 1e-4        /* of what a step promises, that it has to gain */
#define DAMPING_LEAST 0.05 /* below it there is none */
#define DAMPING_MOST 1e12
#define PANEL HF_SADDLE_DUAL_PANEL /* samples that are solved together */
#define SEED 20260000u             /* of the signs; nothing depends on it but the digits of standard deviations */

/* ---- making ---- */

/* Scratch: a step's errors, supports, numbers, gap before and after, and move; the band; of shapes
 * cut lengths and supports; answers of `linear`. Those of samples have room for PANEL. */
typedef struct {
    double *cut_m, *rest_m, *shared, *gap_m, *trial_m, *move_m, *band, *length_m, *support_m, *strain_N, *linear;
} estimate_scratch;

static size_t take(size_t *used, size_t n)
{
    size_t at = *used;
    *used += n;
    return at;
}

static size_t share_scratch(const hf_estimate *p, estimate_scratch *to)
{
    size_t n_cable = (size_t)p->built->model.n_cable, n_dof = p->linear.n_dof, used = 0;
    double *base = p->scratch;
    size_t cut = take(&used, PANEL * n_cable), rest = take(&used, PANEL * n_dof), gap = take(&used, PANEL * n_dof);
    size_t shared = take(&used, PANEL * (size_t)p->prior.n_shared);
    size_t trial = take(&used, n_dof), move = take(&used, PANEL * n_dof);
    size_t band = take(&used, PANEL * (size_t)p->saddle.n_band);
    size_t length = take(&used, n_cable), support = take(&used, n_dof);
    size_t strain = take(&used, PANEL * n_cable), linear = take(&used, PANEL * p->linear.n_scratch);
    if (base)
        *to = (estimate_scratch){base + cut,  base + rest,   base + shared,  base + gap,    base + trial, base + move,
                                 base + band, base + length, base + support, base + strain, base + linear};
    return used;
}

static void lay_out_estimate(hf_arena *arena, hf_estimate *p)
{
    estimate_scratch none;
    p->scratch = NULL;
    size_t n = share_scratch(p, &none);
    p->cut_m = hf_arena_take(arena, (size_t)p->built->model.n_cable, sizeof(double));
    p->rest_m = hf_arena_take(arena, p->linear.n_dof, sizeof(double));
    p->shared = hf_arena_take(arena, (size_t)p->prior.n_shared, sizeof(double));
    p->scratch = hf_arena_take(arena, n, sizeof(double));
    p->last.place_m = hf_arena_take(arena, p->linear.n_dof, sizeof(double));
    p->last.tension_N = hf_arena_take(arena, (size_t)p->built->model.n_cable, sizeof(double));
}

hf_status hf_estimate_create(const hf_built *b, const hf_saddle_prior *prior, const double *place_m, hf_estimate *p)
{
    hf_arena arena = {0};
    *p = (hf_estimate){.built = b, .prior = *prior, .place_m = place_m};
    HF_TRY(hf_built_linear_make(b, &p->linear));
    HF_TRY(hf_saddle_create(&p->linear, &p->prior, &p->saddle));
    HF_TRY(hf_workspace_create(&b->model, &p->work));
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out_estimate(&arena, p)));
    p->block = arena.block;
    double *last_m = p->last.place_m, *last_N = p->last.tension_N;
    p->last = *b;
    p->last.place_m = memcpy(last_m, b->place_m, p->linear.n_dof * sizeof *last_m);
    p->last.tension_N = memcpy(last_N, b->tension_N, (size_t)b->model.n_cable * sizeof *last_N);
    if (b->model.n_attachment) return HF_OK;
    hf_status status = hf_near_create(b, &p->work, &p->near);
    p->has_near = status == HF_OK;
    return status == HF_NO_MEMORY ? status : HF_OK;
}

void hf_estimate_free(hf_estimate *p)
{
    hf_arena arena = {.block = p->block};
    hf_built_linear_free(&p->linear);
    hf_saddle_free(&p->saddle);
    hf_near_free(&p->near);
    hf_workspace_free(&p->work);
    hf_arena_free(&arena);
    *p = (hf_estimate){0};
}

/* ---- shapes ---- */

/* From the last shape, by Newton's method, which takes fewer steps than the reference and rarely fails; else by that.
 * On a truss always by that: the other ends with gaps of coupling.tof_m, which are much in a figure. */
static hf_status solve_from_last(const hf_estimate *p, const hf_built_net *net, hf_workspace *w, hf_form_result *r)
{
    const hf_model *m = &p->built->model;
    hf_near from = p->near;
    from.built = &p->last;
    if (!p->has_near || !hf_near_find(&from, net, w, r)) HF_TRY(hf_built_solve(p->built, net, w, r));
    for (int c = 0; c < 3; c++) /* held places are those of the nominal net: their moves are added to it */
        memcpy(p->last.place_m + c * m->n_node, w->position_m + c * m->n_node, (size_t)m->n_free * sizeof(double));
    memcpy(p->last.tension_N, w->tension_N, (size_t)m->n_cable * sizeof(double));
    return HF_OK;
}

static hf_status solve_net(const hf_estimate *p, const double *cut_m, const double *rest_m, const double *turn_m,
                           hf_workspace *w, hf_form_result *r)
{
    const hf_model *m = &p->built->model;
    estimate_scratch s;
    share_scratch(p, &s);
    for (int e = 0; e < m->n_cable; e++)
        s.length_m[e] = m->target[e] + cut_m[e] + (turn_m ? turn_m[e] : 0);
    for (int row = 0; row < m->n_node; row++)
        for (int c = 0; c < 3; c++)
            s.support_m[c * m->n_node + row] = row < m->n_free ? 0 : rest_m[3 * row + c];
    return solve_from_last(p, &(hf_built_net){.cut_m = s.length_m, .support_move_m = s.support_m}, w, r);
}

hf_status hf_estimate_shape(const hf_estimate *p, const double *turn_m, hf_workspace *w, hf_form_result *r)
{
    return solve_net(p, p->cut_m, p->rest_m, turn_m, w, r);
}

/* What numbers that cables share make of the length of cable e. */
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

/* Half the sum of squares of errors over their sigmas. */
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

/* Measured less present places, where they are measured. */
static void find_gap(const hf_estimate *p, double *gap_m)
{
    const hf_model *m = &p->built->model;
    for (int row = 0; row < m->n_node; row++)
        for (int c = 0; c < 3; c++) {
            int i = 3 * row + c;
            bool is_measured = p->prior.weight_per_m2[i] > 0;
            gap_m[i] = is_measured ? p->place_m[i] - p->work.position_m[c * m->n_node + row] : 0;
        }
}

/* The same of the differences that a move (NULL: none) leaves of the gap. */
static double misfit_of_places(const hf_estimate *p, const double *gap_m, const double *move_m)
{
    double sum = 0;
    for (size_t i = 0; i < p->linear.n_dof; i++) {
        double left = gap_m[i] - (move_m ? move_m[i] : 0);
        sum += p->prior.weight_per_m2[i] * left * left;
    }
    return sum / 2;
}

/* Solve for these errors; *misfit is INFINITY when there is no shape. */
static hf_status try_errors(hf_estimate *p, const double *cut_m, const double *rest_m, const double *shared,
                            double *gap_m, double *misfit)
{
    hf_status status = solve_net(p, cut_m, rest_m, NULL, &p->work, &p->form);
    *misfit = (double)INFINITY;
    if (status != HF_OK) return status;
    find_gap(p, gap_m);
    *misfit = misfit_of_errors(p, cut_m, rest_m, shared) + misfit_of_places(p, gap_m, NULL);
    return HF_OK;
}

/* ---- steps ---- */

/* The first n of what the scratch has room for. */
static hf_status ask_saddle(const hf_estimate *p, const estimate_scratch *s, int n)
{
    hf_saddle_answer answer[PANEL];
    size_t n_dof = p->linear.n_dof, n_cable = (size_t)p->built->model.n_cable, n_shared = (size_t)p->prior.n_shared;
    for (size_t k = 0; k < (size_t)n; k++)
        answer[k] = (hf_saddle_answer){s->gap_m + k * n_dof, s->cut_m + k * n_cable, s->rest_m + k * n_dof,
                                       s->move_m + k * n_dof, s->shared + k * n_shared};
    return hf_saddle_solve(&p->saddle, n, answer, s->band);
}

/* The answer of the linear model, damped, into s->cut_m, s->rest_m and s->shared. Damping t pulls towards the present
 * errors e, with t times the weight with which the prior pulls to none: together with 1 + t to e t/(1 + t). Divided by
 * 1 + t this is the system of lesser weights of places, for what the errors are beyond e t/(1 + t). *promise: what the
 * undamped model promises of the misfit. HF_OK or HF_SINGULAR. */
static hf_status aim(const hf_estimate *p, const estimate_scratch *s, double damping, double *promise)
{
    int n_cable = p->built->model.n_cable, n_dof = (int)p->linear.n_dof;
    double part = 1 / (1 + damping);
    for (int e = 0; e < n_cable; e++)
        s->cut_m[e] = part * p->cut_m[e];
    for (int i = 0; i < n_dof; i++)
        s->rest_m[i] = part * p->rest_m[i];
    HF_TRY(ask_saddle(p, s, 1));
    for (int e = 0; e < n_cable; e++)
        s->cut_m[e] += (1 - part) * p->cut_m[e];
    for (int i = 0; i < n_dof; i++)
        s->rest_m[i] += (1 - part) * p->rest_m[i];
    for (int k = 0; k < p->prior.n_shared; k++)
        s->shared[k] += (1 - part) * p->shared[k];
    *promise =
        p->misfit - misfit_of_errors(p, s->cut_m, s->rest_m, s->shared) - misfit_of_places(p, s->gap_m, s->move_m);
    return HF_OK;
}

/* The damping after a step that gained this part of what was promised. */
static double damp(double damping, double ratio)
{
    if (ratio < 0.25) return fmax(1, 10 * damping);
    if (ratio < 0.75 || damping == 0) return damping;
    return damping > DAMPING_LEAST ? damping / 10 : 0;
}

hf_status hf_estimate_find(hf_estimate *p)
{
    const hf_model *m = &p->built->model;
    estimate_scratch s;
    double damping = 0, misfit, promise;
    bool is_new = true; /* the linear model is that of an earlier shape */
    share_scratch(p, &s);
    HF_TRY(try_errors(p, p->cut_m, p->rest_m, p->shared, s.gap_m, &p->misfit));
    for (p->n_step = 0; p->n_step < STEPS_MAX && damping < DAMPING_MOST; p->n_step++) {
        if (is_new && hf_built_linear_take(&p->linear, &p->work) != HF_OK) break;
        if (hf_saddle_factor(&p->saddle, damping) != HF_OK) break;
        if (aim(p, &s, damping, &promise) != HF_OK) break;
        p->is_settled = !(promise > (damping > 0 ? NEAR_SETTLED : 1) * SETTLED * fmax(p->misfit, LEAST_MISFIT));
        if (p->is_settled) break;
        hf_status status = try_errors(p, s.cut_m, s.rest_m, s.shared, s.trial_m, &misfit);
        if (status == HF_INTERRUPTED || status == HF_NO_MEMORY) return status;
        double ratio = (p->misfit - misfit) / promise; /* -infinity without a shape */
        damping = damp(damping, ratio);
        is_new = ratio > ENOUGH;
        if (!is_new) continue;
        p->misfit = misfit;
        memcpy(p->cut_m, s.cut_m, (size_t)m->n_cable * sizeof *s.cut_m);
        memcpy(p->rest_m, s.rest_m, p->linear.n_dof * sizeof *s.rest_m);
        memcpy(p->shared, s.shared, (size_t)p->prior.n_shared * sizeof *s.shared);
        memcpy(s.gap_m, s.trial_m, p->linear.n_dof * sizeof *s.gap_m);
    }
    return is_new ? HF_OK : try_errors(p, p->cut_m, p->rest_m, p->shared, s.gap_m, &misfit);
}

/* ---- samples ---- */

static double random_sign(hf_random *random)
{
    return hf_random_next(random) >> 63 ? 1 : -1;
}

/* Random errors of the sizes of the prior, of one sample: of lengths (NULL: not wanted), the strains [n_cable] that
 * these are, and moves of supports. */
static void draw_errors(const hf_estimate *p, hf_random *random, const estimate_scratch *s, double *own_m,
                        double *strain_N, double *move_m)
{
    const hf_model *m = &p->built->model;
    for (int k = 0; k < p->prior.n_shared; k++)
        s->shared[k] = random_sign(random);
    for (int e = 0; e < m->n_cable; e++) {
        double cut_m = random_sign(random) * p->prior.sigma_m[e] + shared_error_m(p, s->shared, e);
        strain_N[e] = p->linear.cut_N_per_m[e] * cut_m;
        if (own_m) own_m[e] = cut_m;
    }
    for (size_t i = 3 * (size_t)m->n_free; i < p->linear.n_dof; i++)
        move_m[i] = random_sign(random) * p->prior.support_sigma_m;
}

/* The moves [n][n_dof] of random errors from sample `first` on, by streams of random numbers, and these errors (NULL:
 * not wanted). Returns n. */
static int draw_moves(const hf_estimate *p, int stream, int first, const estimate_scratch *s, hf_random random[PANEL],
                      double *move_m, const hf_estimate_cause *cause)
{
    int n = HF_ESTIMATE_SAMPLES - first < PANEL ? HF_ESTIMATE_SAMPLES - first : PANEL;
    for (int k = 0; k < n; k++) {
        random[k] = hf_random_stream(SEED, stream, first + k);
        double *cut_m = cause ? cause->cut_m + (ptrdiff_t)(first + k) * p->built->model.n_cable : NULL;
        draw_errors(p, &random[k], s, cut_m, s->strain_N + (ptrdiff_t)k * p->built->model.n_cable,
                    move_m + (size_t)k * p->linear.n_dof);
    }
    if (cause)
        memcpy(cause->rest_m + (size_t)first * p->linear.n_dof, move_m, (size_t)n * p->linear.n_dof * sizeof *move_m);
    hf_built_linear_apply(&p->linear, n, s->strain_N, move_m, s->linear);
    return n;
}

hf_status hf_estimate_expect(hf_estimate *p, double *expected_m)
{
    const hf_model *m = &p->built->model;
    estimate_scratch s;
    hf_random random[PANEL];
    share_scratch(p, &s);
    memset(expected_m, 0, (size_t)m->n_node * sizeof *expected_m);
    for (int first = 0; first < HF_ESTIMATE_SAMPLES; first += PANEL) {
        int n = draw_moves(p, 0, first, &s, random, s.move_m, NULL);
        for (int i = 0; i < n * 3 * m->n_node; i++)
            expected_m[i / 3 % m->n_node] += s.move_m[i] * s.move_m[i] / HF_ESTIMATE_SAMPLES;
    }
    for (int row = 0; row < m->n_node; row++)
        expected_m[row] = sqrt(expected_m[row]);
    return HF_OK;
}

/* What would be measured of a shape that is moved so. */
static void draw_gap(const hf_estimate *p, hf_random *random, const double *move_m, double *gap_m)
{
    for (size_t i = 0; i < p->linear.n_dof; i++) {
        double weight = p->prior.weight_per_m2[i], sign = random_sign(random);
        gap_m[i] = weight > 0 ? move_m[i] + sign / sqrt(weight) : 0;
    }
}

/* With prior S and posterior P of independent errors the answer to a unit error of one cable has 1 - P/S of it, and
 * the information 1/P - 1/S that places alone have gives that estimate over 1 - P/S. */
hf_status hf_estimate_belief(hf_estimate *p, int n, const int *cable, double *part)
{
    size_t n_dof = p->linear.n_dof, n_cable = (size_t)p->built->model.n_cable;
    estimate_scratch s;
    share_scratch(p, &s);
    HF_TRY(hf_built_linear_take(&p->linear, &p->work));
    HF_TRY(hf_saddle_factor(&p->saddle, 0));
    for (int k = 0; k < n; k++) {
        int e = cable[k];
        memset(s.strain_N, 0, n_cable * sizeof *s.strain_N);
        memset(s.move_m, 0, n_dof * sizeof *s.move_m);
        memset(s.cut_m, 0, n_cable * sizeof *s.cut_m);
        memset(s.rest_m, 0, n_dof * sizeof *s.rest_m);
        s.strain_N[e] = p->linear.cut_N_per_m[e];
        hf_built_linear_apply(&p->linear, 1, s.strain_N, s.move_m, s.linear);
        for (size_t i = 0; i < n_dof; i++)
            s.gap_m[i] = p->prior.weight_per_m2[i] > 0 ? s.move_m[i] : 0;
        HF_TRY(ask_saddle(p, &s, 1));
        part[k] = s.cut_m[e] - shared_error_m(p, s.shared, e);
    }
    return HF_OK;
}

/* The errors of samples from `first` on, less what the estimate makes of them. */
static void take_estimates_off(const hf_estimate *p, const estimate_scratch *s, int first, int n,
                               const hf_estimate_cause *cause)
{
    size_t n_cable = (size_t)p->built->model.n_cable, n_dof = p->linear.n_dof;
    double *cut_m = cause->cut_m + (size_t)first * n_cable, *rest_m = cause->rest_m + (size_t)first * n_dof;
    for (size_t i = 0; i < (size_t)n * n_cable; i++)
        cut_m[i] -= s->cut_m[i];
    for (size_t i = 0; i < (size_t)n * n_dof; i++)
        rest_m[i] -= s->rest_m[i];
}

/* Of samples whose strains are in s->strain_N, less what the estimate makes of them. */
static void add_tensions(const hf_estimate *p, const estimate_scratch *s, int n, const double *move_m, double *square_N)
{
    size_t n_cable = (size_t)p->built->model.n_cable;
    for (int k = 0; k < n; k++) {
        double *strain_N = s->strain_N + (size_t)k * n_cable, *change_N = s->cut_m + (size_t)k * n_cable;
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
    estimate_scratch s;
    hf_random random[PANEL];
    share_scratch(p, &s);
    memset(sigma_N, 0, n_cable * sizeof *sigma_N);
    HF_TRY(hf_built_linear_take(&p->linear, &p->work));
    HF_TRY(hf_saddle_factor(&p->saddle, 0));
    for (int first = 0; first < HF_ESTIMATE_SAMPLES; first += PANEL) {
        double *move = move_m + (size_t)first * n_dof;
        int n = draw_moves(p, 1, first, &s, random, move, cause);
        for (int k = 0; k < n; k++)
            draw_gap(p, &random[k], move + (size_t)k * n_dof, s.gap_m + (size_t)k * n_dof);
        memset(s.cut_m, 0, (size_t)n * n_cable * sizeof *s.cut_m);
        memset(s.rest_m, 0, (size_t)n * n_dof * sizeof *s.rest_m);
        HF_TRY(ask_saddle(p, &s, n));
        for (size_t i = 0; i < (size_t)n * n_dof; i++)
            move[i] -= s.move_m[i];
        if (cause) take_estimates_off(p, &s, first, n, cause);
        add_tensions(p, &s, n, move, sigma_N);
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
