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
 * Contents: what all threads share, lanes, the shape in a workspace, the end of a lane. */
#include "built/near.h"

#include "base/arena.h"
#include "solve/coupling.h"
#include "solve/joint.h"
#include "solve/loose.h"
#include "solve/schur.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* The following limits decide when a net leaves its lane and is solved by Newton's method. Newton's method finds the
 * same shape within the tolerance in 4 to 8 steps, each of which takes as long as a dozen chord steps. The tests of
 * near, built_batch and samples pass with STEPS_MAX 20 and 180, PATIENCE 1 and 10, CONTRACTION 0.3 and 0.95. */
#define STEPS_MAX 60
#define PATIENCE 2      /* steps before CONTRACTION is required */
#define CONTRACTION 0.7 /* maximum ratio of the residuals of two successive steps */

/* ---- what all threads share ---- */

static void choose_kernels(hf_near *near)
{
#define SET(isa) near->find = hf_pull_find_##isa, near->multiply = hf_pull_multiply_##isa
    switch (hf_lane_best_isa()) {
    case HF_LANE_AVX512:
        SET(avx512);
        break;
    case HF_LANE_AVX2:
        SET(avx2);
        break;
    default:
        SET(portable);
    }
#undef SET
}

void hf_near_prepare(const hf_near *near, const hf_built_net *net, hf_workspace *w)
{
    const hf_built *b = near->built;
    const hf_model *m = &near->model;
    size_t cables = (size_t)m->n_cable * sizeof(double), places = 3 * (size_t)m->n_node * sizeof(double);
    hf_form_prepare(m, w);
    if (net->cut_m) memcpy(w->target, net->cut_m, cables);
    if (net->EA_N) memcpy(w->EA_N, net->EA_N, cables);
    if (net->support_move_m) memcpy(w->support_move_m, net->support_move_m, places);
    memcpy(w->position_m, b->place_m, places);
    memcpy(w->tension_N, b->tension_N, cables);
    w->n_moving = m->n_free + m->n_attachment;
    for (int c = 0; c < 3; c++)
        for (int at = c * m->n_node + m->n_free; at < (c + 1) * m->n_node; at++)
            w->position_m[at] += w->support_move_m[at];
    hf_joint_set_displacement(m, w);
}

/* Computes (I + F S)^-1 of the nominal net, the displacement of the attachments by a gap F f - r. The workspace holds
 * the factored matrix of that net. */
static hf_status find_answer(hf_workspace *w, hf_near *near)
{
    const hf_model *m = &near->model;
    size_t n = (size_t)near->chord.n_pull;
    hf_schur schur;
    hf_status status = hf_schur_create(m, &schur);
    if (status == HF_OK) status = hf_schur_factor(m, w, hf_newton_matrix_block, &schur);
    for (size_t j = 0; j < n && status == HF_OK; j++) {
        double *column = schur.column;
        memset(column, 0, n * sizeof *column);
        column[j] = 1;
        hf_schur_solve(&schur, column);
        for (size_t i = 0; i < n; i++)
            near->answer[(i / HF_PULL_ROWS * n + j) * HF_PULL_ROWS + i % HF_PULL_ROWS] = column[i];
    }
    hf_schur_free(&schur);
    near->chord.n_mode = 0;
    return status;
}

hf_status hf_near_create(const hf_built *b, hf_workspace *w, hf_near *near)
{
    size_t n_band = HF_NEWTON_DOFS(&b->model) * (3 * (size_t)b->model.half_bandwidth + 3);
    *near = (hf_near){.built = b, .model = b->model};
    near->model.n_variable = near->model.n_leader = near->model.n_variable_group = 0;
    near->model.variable = NULL;
    near->evaluator = (hf_evaluator){.model = &near->model, .form = &b->form, .rule = HF_RULE_TENSION};
    choose_kernels(near);
    hf_near_prepare(near, &(hf_built_net){0}, w);
    w->n_moving = b->model.n_free;
    HF_TRY(hf_chord_create_here(&near->evaluator, w, &near->chord));
    HF_TRY(HF_ARENA_ARRAYS(&near->block, HF_ARRAY(near->band, n_band),
                           HF_ARRAY(near->answer, (size_t)near->chord.n_pull_pad * (size_t)near->chord.n_pull)));
    memcpy(near->band, w->newton_band, n_band * sizeof *near->band);
    return b->model.n_attachment ? find_answer(w, near) : HF_OK;
}

void hf_near_free(hf_near *near)
{
    hf_chord_free(&near->chord);
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
    hf_chord_lanes_free(&l->lanes);
    hf_arena_free_block(l->block);
    l->block = NULL;
}

void hf_near_load(const hf_near *near, hf_near_lanes *l, int lane, const hf_built_net *net)
{
    const hf_model *m = &near->model;
    const hf_chord *c = &near->chord;
    for (int at = 0; at < 3 * m->n_node; at++)
        l->lanes.x_m[at * HF_LANES + lane] = near->built->place_m[at];
    for (int d = 0; d < 3 && net->support_move_m; d++)
        for (int at = d * m->n_node + m->n_free; at < (d + 1) * m->n_node; at++)
            l->lanes.x_m[at * HF_LANES + lane] += net->support_move_m[at];
    for (int e = 0; e < m->n_cable; e++) {
        l->cut_m[e * HF_LANES + lane] = net->cut_m[e];
        l->stiffness_N_per_m[e * HF_LANES + lane] = net->EA_N[e] / net->cut_m[e];
    }
    for (int i = 0; i < c->n_pull; i++)
        l->lanes.displacement_m[i * HF_LANES + lane] = c->base_displacement_m[i];
    l->steps[lane] = 0;
    l->excess_before_N[lane] = INFINITY;
}

void hf_near_look(const hf_near *near, hf_near_lanes *l)
{
    const hf_model *m = &near->model;
    const hf_chord *c = &near->chord;
    const hf_form_settings *form = &near->built->form;
    double squared[HF_LANES], gap_squared[HF_LANES] = {0};
    double scale = c->n_pull ? form->residual_tolerance * m->reference_N / form->coupling.tof_m : 0;
    near->find(m, l->lanes.x_m, l->cut_m, l->stiffness_N_per_m, l->tension_N, l->lanes.variable);
    c->kernels->forces(c, &l->lanes, squared);
    if (c->n_pull) c->kernels->couple(c, &l->lanes, gap_squared);
    l->is_measured = false;
    for (int lane = 0; lane < HF_LANES; lane++) {
        l->residual_N[lane] = m->reference_N * sqrt(squared[lane]);
        l->gap_m[lane] = sqrt(gap_squared[lane]);
        double gap_N = scale * l->gap_m[lane];
        /* This order of the comparison keeps a NaN of the gap. */
        l->excess_N[lane] = gap_N <= l->residual_N[lane] ? l->residual_N[lane] : gap_N;
    }
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
    near->multiply(c->n_pull, near->answer, l->gap_lanes_m, l->lanes.move_m);
    k->move(c, &l->lanes);
    c->matrix.solve(&c->matrix, l->lanes.force_N);
    k->step(c, &l->lanes);
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

bool hf_near_find(const hf_near *near, const hf_built_net *net, hf_workspace *w, hf_form_result *r)
{
    hf_near loaded = *near;
    int n_step = 0;
    if (net->load_N) loaded.model.load_N = (double *)(uintptr_t)net->load_N; /* no solver writes to load_N */
    hf_near_prepare(&loaded, net, w);
    return hf_near_newton(&loaded, w, &n_step) && accept(&loaded, n_step, w, r);
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

static double lowest_N(const hf_near_lanes *l, int lane)
{
    return fmin(l->now.lowest_N[HF_GROUP_INNER][lane], l->now.lowest_N[HF_GROUP_BOUNDARY][lane]);
}

static double ratio_of(const hf_near_lanes *l, hf_group group, int lane)
{
    double high_N = l->now.highest_N[group][lane];
    return high_N > 0 ? high_N / l->now.lowest_N[group][lane] : (double)NAN;
}

/* Sets the result of a lane without slack cables. Each cable has the tension of its law, so the error of lengths is
 * 0. */
static void report(const hf_near *near, const hf_near_lanes *l, int lane, hf_workspace *w, hf_form_result *r)
{
    const hf_model *m = &near->model;
    *r = (hf_form_result){.status = HF_OK, .stop_reason = HF_STOPPED_RESIDUAL, .culprit = -1};
    hf_result_blank(r);
    r->psi_m = m->n_inner_node ? l->now.psi_m[lane] : (double)NAN;
    r->residual_N = l->residual_N[lane];
    r->tension_error = r->length_error = 0;
    r->inner_tension_ratio = ratio_of(l, HF_GROUP_INNER, lane);
    r->boundary_tension_ratio = ratio_of(l, HF_GROUP_BOUNDARY, lane);
    r->shortest_length_ratio = l->now.shortest_other[lane];
    r->iterations = l->steps[lane];
    memset(w->loose, 0, (size_t)m->n_node);
    if (m->n_attachment) hf_coupling_accept(m, w, l->steps[lane], l->gap_m[lane], r);
}

/* Accepts a converged lane with slack cables. The scalar code counts them and looks for loose nodes. */
static bool accept_slack(const hf_near *near, const hf_near_lanes *l, int lane, const hf_built_net *net,
                         hf_workspace *w, hf_form_result *r)
{
    const hf_model *m = &near->model;
    hf_near_prepare(near, net, w);
    unload(near, l, lane, w);
    for (int e = 0; e < m->n_cable; e++)
        w->q_N_per_m[e] = l->lanes.variable[e * HF_LANES + lane];
    return accept(near, l->steps[lane], w, r);
}

hf_near_verdict hf_near_settle(const hf_near *near, hf_near_lanes *l, int lane, const hf_built_net *net,
                               hf_workspace *w, hf_form_result *r)
{
    const hf_model *m = &near->model;
    double excess_N = l->excess_N[lane];
    if (excess_N <= near->built->form.residual_tolerance * m->reference_N) {
        if (!l->is_measured) near->chord.kernels->measure(&near->chord, &l->lanes, &l->now);
        l->is_measured = true;
        if (!(lowest_N(l, lane) >= HF_SLACK_RATIO * m->reference_N))
            return accept_slack(near, l, lane, net, w, r) ? HF_NEAR_FOUND : HF_NEAR_LOST;
        unload(near, l, lane, w);
        report(near, l, lane, w, r);
        return HF_NEAR_FOUND;
    }
    bool contracts = l->steps[lane] < PATIENCE || excess_N < CONTRACTION * l->excess_before_N[lane];
    if (!contracts || !isfinite(excess_N) || l->steps[lane] >= STEPS_MAX) return HF_NEAR_LOST;
    l->excess_before_N[lane] = excess_N;
    l->steps[lane]++;
    return HF_NEAR_GOES_ON;
}
