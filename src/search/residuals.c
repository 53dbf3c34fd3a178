/* Computes the residuals of a design and their derivatives. residuals.h describes the interface.
 *
 *     hf_residuals_find     shape -> f: of the objectives, or of psi
 *     hf_residuals_rates    rate_one:   dx/dv, dT/dv -> rows of the design itself          (for each variable)
 *                           rate_net:   rows of the objectives over an as-built net        (for each net)
 *                           close_rate: rows over all nets -> df/dv, gradient J'f          (for each variable) */
#include "search/residuals.h"

#include "linalg/dot.h"
#include "search/parallel.h"

#include <math.h>

/* Without objectives there are no rooms, because residuals and rates follow directly from positions and their rates. */
hf_status hf_residuals_create(const hf_evaluator *v, hf_residuals *r)
{
    *r = (hf_residuals){.v = v, .n_row = v->objectives ? v->objectives->n_row : 3 * v->model->n_inner_node};
    r->n_room = !v->objectives ? 0 : v->n_thread > 1 ? v->n_thread : 1;
    size_t n_at_once = v->objectives && v->objectives->nets ? HF_OBJECTIVES_AT_ONCE : 1, n_room = (size_t)r->n_room;
    size_t n_move = 3 * n_at_once * (size_t)v->model->n_node, n_rate = n_at_once * (size_t)v->model->n_cable;
    double *move_m, *rate, *value;
    HF_TRY(HF_ARENA_ARRAYS(&r->block, HF_ARRAY(r->value, r->n_row), HF_ARRAY(r->room, n_room),
                           HF_ARRAY(move_m, n_room * n_move), HF_ARRAY(rate, n_room * n_rate),
                           HF_ARRAY(value, n_room * (size_t)r->n_row)));
    for (size_t i = 0; i < n_room; i++)
        r->room[i] = (hf_residuals_room){
            {0}, HF_OK, move_m + i * n_move, rate + i * n_rate, i ? value + i * (size_t)r->n_row : r->value};
    for (size_t i = 0; i < n_room; i++)
        HF_TRY(hf_objectives_point_create(v->objectives, &r->room[i].point));
    return HF_OK;
}

void hf_residuals_free(hf_residuals *r)
{
    for (int i = 0; r->block && i < r->n_room; i++)
        hf_objectives_point_free(&r->room[i].point);
    hf_arena_free_block(r->block);
    *r = (hf_residuals){0};
}

/* What the threads share. hf_residuals_find sets only r and w. */
typedef struct {
    const hf_residuals *r;
    const hf_sensitivity *slopes;
    const hf_workspace *w;
    double *rate, *gradient;
} all_rates;

/* Linearises the objectives in room i, whichever thread does it. */
static void enter_room(void *context, int any_room, int i)
{
    const all_rates *q = context;
    hf_residuals_room *room = &q->r->room[i];
    (void)any_room;
    room->status = hf_objectives_linearise(q->r->v->objectives, i == 0, q->w, &room->point, room->value);
}

/* A feasible design has no loose nodes, so psi counts all inner nodes. */
hf_status hf_residuals_find(hf_residuals *r, const hf_workspace *w)
{
    const hf_model *m = r->v->model;
    if (r->n_room) {
        all_rates q = {.r = r, .w = w};
        hf_parallel_each(r->v->n_thread, r->n_room, enter_room, &q);
        for (int i = 0; i < r->n_room; i++)
            HF_TRY(r->room[i].status);
        return HF_OK;
    }
    double part = 1 / sqrt(m->n_inner_node);
    for (int i = 0; i < r->n_row; i++) {
        int at = i % 3 * m->n_node + m->inner_row[i / 3];
        r->value[i] = part * (w->position_m[at] - m->position_m[at]);
    }
    return HF_OK;
}

static double *rate_of(const all_rates *q, int i_class)
{
    return q->rate + (size_t)i_class * (size_t)q->r->n_row;
}

/* Computes the rows of one variable, without those of objectives over as-built nets. */
static void rate_one(void *context, int i_room, int i_class)
{
    const all_rates *q = context;
    const hf_residuals *r = q->r;
    const hf_model *m = r->v->model;
    double *rate = rate_of(q, i_class), part = 1 / sqrt(m->n_inner_node);
    if (r->v->objectives) {
        hf_residuals_room *room = &r->room[i_room];
        const hf_objectives_rate by = {room->move_m, room->tension_rate,
                                       hf_sensitivity_displacement(q->slopes, i_class, 0)};
        hf_sensitivity_spread(q->slopes, i_class, room->move_m, room->tension_rate);
        hf_objectives_push(r->v->objectives, q->w, &room->point, &by, rate);
        return;
    }
    const double *move = q->slopes->move + (size_t)i_class * q->slopes->n_dof;
    for (int i = 0; i < r->n_row; i++)
        rate[i] = part * move[3 * m->inner_row[i / 3] + i % 3];
}

/* Cuts the as-built nets of the design in room i. */
static void cut_nets(void *context, int any_room, int i)
{
    const all_rates *q = context;
    hf_residuals_room *room = &q->r->room[i];
    (void)any_room;
    room->status = q->r->v->objectives->nets->cut(room->point.nets, q->w);
}

/* Computes the rows of all objectives over one as-built net, by all variables. */
static void rate_net(void *context, int i_room, int i_net)
{
    const all_rates *q = context;
    const hf_objectives *objectives = q->r->v->objectives;
    const hf_model *m = q->r->v->model;
    hf_residuals_room *room = &q->r->room[i_room];
    const hf_workspace *shape;
    hf_objectives_rate by[HF_OBJECTIVES_AT_ONCE], by_net[HF_OBJECTIVES_AT_ONCE];
    if (room->status != HF_OK || !hf_objectives_are_over(objectives, i_net)) return;
    room->status = hf_objectives_nets_linearise(objectives, i_net, &room->point, &shape);
    for (int first = 0; first < q->slopes->n && room->status == HF_OK; first += HF_OBJECTIVES_AT_ONCE) {
        int n = q->slopes->n - first < HF_OBJECTIVES_AT_ONCE ? q->slopes->n - first : HF_OBJECTIVES_AT_ONCE;
        for (int k = 0; k < n; k++) {
            double *move = room->move_m + 3 * (size_t)k * (size_t)m->n_node;
            double *tension = room->tension_rate + (size_t)k * (size_t)m->n_cable;
            hf_sensitivity_spread(q->slopes, first + k, move, tension);
            by[k] = (hf_objectives_rate){move, tension, hf_sensitivity_displacement(q->slopes, first + k, 0)};
        }
        objectives->nets->follow(room->point.nets, n, by, by_net);
        for (int k = 0; k < n; k++)
            hf_objectives_nets_push(objectives, i_net, shape, &room->point, &by_net[k], rate_of(q, first + k));
    }
}

/* Completes the rows of one variable, and computes its gradient. */
static void close_rate(void *context, int i_room, int i_class)
{
    const all_rates *q = context;
    const hf_residuals *r = q->r;
    double *rate = rate_of(q, i_class);
    (void)i_room;
    if (r->n_room && r->v->objectives->nets)
        hf_objectives_nets_close(r->v->objectives, &r->room[0].point, r->value, rate);
    q->gradient[i_class] = hf_dot((size_t)r->n_row, rate, r->value);
}

hf_status hf_residuals_rates(const hf_residuals *r, const hf_sensitivity *slopes, const hf_workspace *w, double *rate,
                             double *gradient)
{
    all_rates q = {r, slopes, w, rate, gradient};
    const hf_objectives_nets *nets = r->v->objectives ? r->v->objectives->nets : NULL;
    hf_parallel_each(r->v->n_thread, slopes->n, rate_one, &q);
    if (nets) {
        hf_parallel_each(r->v->n_thread, r->n_room, cut_nets, &q);
        hf_parallel_each(r->v->n_thread, hf_objectives_nets_count(nets), rate_net, &q);
        for (int i = 0; i < r->n_room; i++)
            HF_TRY(r->room[i].status);
    }
    hf_parallel_each(r->v->n_thread, slopes->n, close_rate, &q);
    return HF_OK;
}
