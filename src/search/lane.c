/* Contents: instruction sets - plan - workspace - one lane in and out - kernels */
#include "search/lane.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* ---- instruction sets ---- */

#if defined __x86_64__
static const hf_lane_kernels *const kernels_of_isa[HF_LANE_N_ISA] = {&hf_lane_kernels_portable, &hf_lane_kernels_avx2,
                                                                     &hf_lane_kernels_avx512};
#define CPU_HAS(feature) (__builtin_cpu_supports(feature) != 0)
#else
static const hf_lane_kernels *const kernels_of_isa[HF_LANE_N_ISA] = {&hf_lane_kernels_portable};
#define CPU_HAS(feature) false
#endif

bool hf_lane_has_isa(hf_lane_isa isa)
{
    switch (isa) {
    case HF_LANE_PORTABLE:
        return true;
    case HF_LANE_AVX2:
        return CPU_HAS("avx2");
    case HF_LANE_AVX512:
        return CPU_HAS("avx512f");
    }
    return false;
}

hf_lane_isa hf_lane_best_isa(void)
{
    if (hf_lane_has_isa(HF_LANE_AVX512)) return HF_LANE_AVX512;
    return hf_lane_has_isa(HF_LANE_AVX2) ? HF_LANE_AVX2 : HF_LANE_PORTABLE;
}

const char *hf_lane_isa_name(hf_lane_isa isa)
{
    switch (isa) {
    case HF_LANE_PORTABLE:
        return "portable";
    case HF_LANE_AVX2:
        return "avx2";
    case HF_LANE_AVX512:
        return "avx512";
    }
    return "unknown";
}

/* ---- plan ---- */

static void lay_out(hf_arena *a, hf_lane_plan *p)
{
    const hf_model *m = p->model;
    size_t n_block = (size_t)p->n_block, n_free = (size_t)m->n_free, n_cable = (size_t)m->n_cable;
    size_t widest = ((size_t)m->half_bandwidth + HF_LANE_BLOCK - 1) / HF_LANE_BLOCK + 1; /* tiles in a block row */
    p->first_column = hf_arena_take(a, n_block, sizeof(int));
    p->tile_0 = hf_arena_take(a, n_block, sizeof(size_t));
    p->has_entry = hf_arena_take(a, n_block * widest, 1);
    p->incidence_start = hf_arena_take(a, n_free + 1, sizeof(int));
    p->incidence = hf_arena_take(a, 2 * n_cable, sizeof(hf_lane_incidence));
    p->inverse_length = hf_arena_take(a, n_cable, sizeof(double));
}

/* The incidences are counted first. Then incidence_start[row] is the place of the row's next incidence; when all are
 * filled in, it is where the next row starts. */
static void list_incidences(hf_lane_plan *p)
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
        if (row < m->n_free) p->incidence[start[row]++] = (hf_lane_incidence){k / 2, p->n_pad + other};
    }
    memmove(start + 1, start, (size_t)m->n_free * sizeof(int));
    start[0] = 0;
}

/* Lane rows of cable e, the lower one first; 0 when one of its ends is a support. */
static int is_between_free_nodes(const hf_lane_plan *p, int e, int *low, int *high)
{
    const hf_model *m = p->model;
    int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
    *low = p->n_pad + (a < b ? a : b);
    *high = p->n_pad + (a < b ? b : a);
    return *high < p->n_pad + m->n_free;
}

/* The factor may have an entry in every column of a row from the first entry of D on: storage starts there. */
static void find_skyline(hf_lane_plan *p)
{
    int low, high;
    for (int i = 0; i < p->n_block; i++)
        p->first_column[i] = i * HF_LANE_BLOCK;
    for (int e = 0; e < p->model->n_cable; e++) {
        if (!is_between_free_nodes(p, e, &low, &high)) continue;
        int *first = &p->first_column[high / HF_LANE_BLOCK];
        if (low < *first) *first = low;
    }
    for (int i = 0; i < p->n_block; i++) {
        size_t first = (size_t)(p->first_column[i] / HF_LANE_BLOCK);
        p->tile_0[i] = p->n_tile - first; /* never negative: each block row before this one has a tile at least */
        p->n_tile += (size_t)i - first + 1;
        p->has_entry[p->n_tile - 1] = 1; /* the diagonal */
    }
    for (int e = 0; e < p->model->n_cable; e++)
        if (is_between_free_nodes(p, e, &low, &high))
            p->has_entry[p->tile_0[high / HF_LANE_BLOCK] + (size_t)(low / HF_LANE_BLOCK)] = 1;
}

hf_status hf_lane_plan_create(const hf_model *model, hf_lane_isa isa, hf_lane_plan *plan)
{
    assert(model->n_free > 0 && !model->has_strut && hf_lane_has_isa(isa));
    int n_block = (model->n_free + HF_LANE_BLOCK - 1) / HF_LANE_BLOCK;
    *plan = (hf_lane_plan){.model = model,
                           .kernels = kernels_of_isa[isa],
                           .n_pad = n_block * HF_LANE_BLOCK - model->n_free,
                           .n_block = n_block};
    hf_arena arena = {0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, plan)));
    plan->block = arena.block;
    list_incidences(plan);
    find_skyline(plan);
    for (int e = 0; e < model->n_cable; e++)
        plan->inverse_length[e] = 1 / model->length_m[e];
    return HF_OK;
}

void hf_lane_plan_free(hf_lane_plan *plan)
{
    free(plan->block);
    *plan = (hf_lane_plan){0};
}

/* ---- workspace ---- */

void hf_lane_workspace_take(hf_arena *arena, const hf_lane_plan *plan, hf_lane_workspace *w)
{
    const hf_lane_plan *p = plan;
    const hf_model *m = plan->model;
#define TAKE(type, name, count, unit, meaning) w->name = hf_arena_take(arena, (size_t)(count), sizeof(type));
    HF_LANE_FIELDS(TAKE)
#undef TAKE
}

size_t hf_lane_workspace_bytes(const hf_lane_plan *plan)
{
    hf_arena arena = {0};
    hf_lane_workspace workspace;
    hf_lane_workspace_take(&arena, plan, &workspace);
    return arena.used;
}

hf_status hf_lane_workspace_create(const hf_lane_plan *plan, hf_lane_workspace *workspace)
{
    *workspace = (hf_lane_workspace){0};
    hf_arena arena = {0};
    HF_TRY(HF_ARENA_MAKE(&arena, hf_lane_workspace_take(&arena, plan, workspace)));
    workspace->block = arena.block;
    return HF_OK;
}

void hf_lane_workspace_free(hf_lane_workspace *workspace)
{
    free(workspace->block);
    *workspace = (hf_lane_workspace){0};
}

/* ---- one lane in and out ---- */

void hf_lane_put(const hf_lane_plan *plan, const hf_workspace *from, int lane, hf_lane_workspace *w)
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

void hf_lane_get(const hf_lane_plan *plan, const hf_lane_workspace *w, int lane, hf_workspace *to)
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

void hf_lane_assemble(const hf_lane_plan *plan, hf_lane_workspace *workspace)
{
    plan->kernels->assemble(plan, workspace);
}

void hf_lane_factor(const hf_lane_plan *plan, hf_lane_workspace *workspace)
{
    plan->kernels->factor(plan, workspace);
}

void hf_lane_substitute(const hf_lane_plan *plan, hf_lane_workspace *workspace)
{
    plan->kernels->substitute(plan, workspace);
}

void hf_lane_solve(const hf_lane_plan *plan, hf_lane_workspace *workspace)
{
    plan->kernels->solve(plan, workspace);
}

void hf_lane_measure(const hf_lane_plan *plan, hf_lane_workspace *workspace, hf_lane_measures *measures)
{
    plan->kernels->measure(plan, workspace, measures);
}

void hf_lane_residual(const hf_lane_plan *plan, const hf_lane_workspace *workspace, hf_lane_measures *measures)
{
    plan->kernels->residual(plan, workspace, measures);
}

void hf_lane_psi(const hf_lane_plan *plan, const hf_lane_workspace *workspace, hf_lane_measures *measures)
{
    plan->kernels->psi(plan, workspace, measures);
}

void hf_lane_update(hf_lane_workspace *workspace)
{
    double *q = workspace->q_N_per_m;
    workspace->q_N_per_m = workspace->next_q_N_per_m;
    workspace->next_q_N_per_m = q;
}
