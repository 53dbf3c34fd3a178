/* Makes the plan and the lanes of the paper's iteration. swarm_lane.h describes the interface.
 *
 *     model -> incidences of each node -> skyline and tiles of D -> plan (shared)
 *     plan  -> lanes of a thread -> put a design into a lane -> kernels -> get the shape of a lane
 *
 * Contents: plan - lanes - one lane in and out - kernels */
#include "search/swarm_lane.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#if defined __x86_64__
static const hf_swarm_kernels *const kernels_of_isa[HF_LANE_N_ISA] = {&hf_swarm_kernels_portable,
                                                                      &hf_swarm_kernels_avx2, &hf_swarm_kernels_avx512};
#else
static const hf_swarm_kernels *const kernels_of_isa[HF_LANE_N_ISA] = {&hf_swarm_kernels_portable};
#endif

/* ---- plan ---- */

static void lay_out(hf_arena *a, hf_swarm_plan *p)
{
    const hf_model *m = p->model;
    size_t n_block = (size_t)p->n_block, n_free = (size_t)m->n_free, n_cable = (size_t)m->n_cable;
    size_t widest = ((size_t)m->half_bandwidth + HF_SWARM_BLOCK - 1) / HF_SWARM_BLOCK + 1; /* tiles in a block row */
    p->first_column = hf_arena_take(a, n_block, sizeof(int));
    p->tile_0 = hf_arena_take(a, n_block, sizeof(size_t));
    p->has_entry = hf_arena_take(a, n_block * widest, 1);
    p->incidence_start = hf_arena_take(a, n_free + 1, sizeof(int));
    p->incidence = hf_arena_take(a, 2 * n_cable, sizeof(hf_swarm_incidence));
    p->inverse_length = hf_arena_take(a, n_cable, sizeof(double));
}

/* Lists the cables at each free node, by a counting sort. incidence_start first counts the cables of each row. While
 * the list is filled, incidence_start[row] is the index of the next entry of the row. At the end it is where the next
 * row begins, so the array is shifted by one. */
static void list_incidences(hf_swarm_plan *p)
{
    const hf_model *m = p->model;
    int *start = p->incidence_start;
    for (int k = 0; k < 2 * m->n_cable; k++)
        if (m->end_row[k] < m->n_free) start[m->end_row[k]]++;
    for (int i = 0, sum = 0; i <= m->n_free; i++) {
        int count = start[i];
        start[i] = sum;
        sum += count;
    }
    for (int k = 0; k < 2 * m->n_cable; k++) {
        int row = m->end_row[k], other = m->end_row[k ^ 1];
        if (row < m->n_free) p->incidence[start[row]++] = (hf_swarm_incidence){k / 2, p->n_pad + other};
    }
    memmove(start + 1, start, (size_t)m->n_free * sizeof(int));
    start[0] = 0;
}

/* Returns the lane rows of cable e, the lower one first. Returns false if one of its ends is a support. */
static bool is_between_free_nodes(const hf_swarm_plan *p, int e, int *low, int *high)
{
    const hf_model *m = p->model;
    int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
    *low = p->n_pad + (a < b ? a : b);
    *high = p->n_pad + (a < b ? b : a);
    return *high < p->n_pad + m->n_free;
}

/* Finds the tiles of each block row. The factor may have an entry in every column from the first entry of D in the row
 * on, so storage begins there. */
static void find_skyline(hf_swarm_plan *p)
{
    int low, high;
    for (int i = 0; i < p->n_block; i++)
        p->first_column[i] = i * HF_SWARM_BLOCK;
    for (int e = 0; e < p->model->n_cable; e++) {
        if (!is_between_free_nodes(p, e, &low, &high)) continue;
        int *first = &p->first_column[high / HF_SWARM_BLOCK];
        if (low < *first) *first = low;
    }
    for (int i = 0; i < p->n_block; i++) {
        size_t first = (size_t)(p->first_column[i] / HF_SWARM_BLOCK);
        p->tile_0[i] = p->n_tile - first; /* never negative: each earlier block row has at least one tile */
        p->n_tile += (size_t)i - first + 1;
        p->has_entry[p->n_tile - 1] = 1; /* the diagonal tile has entries */
    }
    for (int e = 0; e < p->model->n_cable; e++)
        if (is_between_free_nodes(p, e, &low, &high))
            p->has_entry[p->tile_0[high / HF_SWARM_BLOCK] + (size_t)(low / HF_SWARM_BLOCK)] = 1;
}

hf_status hf_swarm_plan_create(const hf_model *m, hf_lane_isa isa, hf_swarm_plan *plan)
{
    assert(m->n_free > 0 && !m->has_strut && hf_lane_has_isa(isa));
    int n_block = (m->n_free + HF_SWARM_BLOCK - 1) / HF_SWARM_BLOCK;
    *plan = (hf_swarm_plan){
        .model = m, .kernels = kernels_of_isa[isa], .n_pad = n_block * HF_SWARM_BLOCK - m->n_free, .n_block = n_block};
    hf_arena arena = {0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, plan)));
    plan->block = arena.block;
    list_incidences(plan);
    find_skyline(plan);
    for (int e = 0; e < m->n_cable; e++)
        plan->inverse_length[e] = 1 / m->length_m[e];
    return HF_OK;
}

void hf_swarm_plan_free(hf_swarm_plan *plan)
{
    hf_arena_free_block(plan->block);
    *plan = (hf_swarm_plan){0};
}

/* ---- lanes ---- */

void hf_swarm_lanes_take(hf_arena *arena, const hf_swarm_plan *plan, hf_swarm_lanes *w)
{
    const hf_swarm_plan *p = plan;
    const hf_model *m = plan->model;
#define TAKE(type, name, count, unit, meaning) w->name = hf_arena_take(arena, (size_t)(count), sizeof(type));
    HF_SWARM_FIELDS(TAKE)
#undef TAKE
}

size_t hf_swarm_lanes_bytes(const hf_swarm_plan *plan)
{
    hf_arena arena = {0};
    hf_swarm_lanes lanes;
    hf_swarm_lanes_take(&arena, plan, &lanes);
    return arena.used;
}

hf_status hf_swarm_lanes_create(const hf_swarm_plan *plan, hf_swarm_lanes *lanes)
{
    *lanes = (hf_swarm_lanes){0};
    hf_arena arena = {0};
    HF_TRY(HF_ARENA_MAKE(&arena, hf_swarm_lanes_take(&arena, plan, lanes)));
    lanes->block = arena.block;
    return HF_OK;
}

void hf_swarm_lanes_free(hf_swarm_lanes *lanes)
{
    hf_arena_free_block(lanes->block);
    *lanes = (hf_swarm_lanes){0};
}

/* ---- one lane in and out ---- */

void hf_swarm_put(const hf_swarm_plan *plan, const hf_workspace *from, int lane, hf_swarm_lanes *w)
{
    const hf_model *m = plan->model;
    for (int e = 0; e < m->n_cable; e++) {
        w->q_N_per_m[e * HF_LANES + lane] = from->q_N_per_m[e];
        w->target[e * HF_LANES + lane] = from->target[e];
    }
    double *x = w->position_m + plan->n_pad * 3 * HF_LANES + lane;
    for (int i = m->n_free; i < m->n_node; i++)
        for (int c = 0; c < 3; c++)
            x[(3 * i + c) * HF_LANES] = from->position_m[c * m->n_node + i];
}

void hf_swarm_get(const hf_swarm_plan *plan, const hf_swarm_lanes *w, int lane, hf_workspace *to)
{
    const hf_model *m = plan->model;
    for (int e = 0; e < m->n_cable; e++) {
        to->q_N_per_m[e] = w->q_N_per_m[e * HF_LANES + lane];
        to->length_m[e] = w->length_m[e * HF_LANES + lane];
        to->tension_N[e] = to->q_N_per_m[e] * to->length_m[e];
    }
    const double *x = w->position_m + plan->n_pad * 3 * HF_LANES + lane;
    for (int i = 0; i < m->n_node; i++)
        for (int c = 0; c < 3; c++)
            to->position_m[c * m->n_node + i] = x[(3 * i + c) * HF_LANES];
}

/* ---- kernels ---- */

void hf_swarm_assemble(const hf_swarm_plan *plan, hf_swarm_lanes *lanes)
{
    plan->kernels->assemble(plan, lanes);
}

void hf_swarm_factor(const hf_swarm_plan *plan, hf_swarm_lanes *lanes)
{
    plan->kernels->factor(plan, lanes);
}

void hf_swarm_substitute(const hf_swarm_plan *plan, hf_swarm_lanes *lanes)
{
    plan->kernels->substitute(plan, lanes);
}

void hf_swarm_solve(const hf_swarm_plan *plan, hf_swarm_lanes *lanes)
{
    plan->kernels->solve(plan, lanes);
}

void hf_swarm_measure(const hf_swarm_plan *plan, hf_swarm_lanes *lanes, hf_swarm_measures *measures)
{
    plan->kernels->measure(plan, lanes, measures);
}

void hf_swarm_residual(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, hf_swarm_measures *measures)
{
    plan->kernels->residual(plan, lanes, measures);
}

void hf_swarm_psi(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, hf_swarm_measures *measures)
{
    plan->kernels->psi(plan, lanes, measures);
}

void hf_swarm_update(hf_swarm_lanes *lanes)
{
    double *q = lanes->q_N_per_m;
    lanes->q_N_per_m = lanes->next_q_N_per_m;
    lanes->next_q_N_per_m = q;
}
